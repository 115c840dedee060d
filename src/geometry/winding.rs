//! How often a mesh winds around a point, by exact signs.
//!
//! The signed crossings of a ray with the triangles sum to the winding number: a triangle crossed from behind (the ray
//! leaves the inside) adds 1. Rays run along an axis, so that "is it crossed?" is a question in two dimensions. Where a
//! ray hits an edge or a corner, it is taken to lie a little farther along the second axis, and less along the third
//! (simulation of simplicity, Edelsbrunner and Mücke 1990): then every ray passes every edge on one side, the same for
//! both its triangles, and no case is undecided but a point on the surface itself.

use crate::math::{Sign, side_of_line, side_of_triangle};
use glam::{DVec2, DVec3};

/// A triangle that a line crosses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossing {
    /// Index of the triangle.
    pub triangle: usize,
    /// 1 where its front looks along the axis, −1 where its back does.
    pub direction: i32,
}

/// Returns the triangles that the line (both ways) through `point` parallel to the coordinate `axis` (0, 1, 2) crosses,
/// in the mesh's order. Exact, and consistent at shared edges and corners: each is crossed in one triangle only.
/// Edge-on triangles are never crossed.
pub fn crossings(world: &[DVec3], triangles: &[[u32; 3]], point: DVec3, axis: usize) -> Vec<Crossing> {
    let flat = |p: DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    let at = flat(point);
    let crosses = |(triangle, corners): (usize, &[u32; 3])| {
        let [a, b, c] = corners.map(|vertex| flat(world[vertex as usize]));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if at.cmplt(low).any() || at.cmpgt(high).any() {
            return None;
        }
        let first = side(a, b, at);
        (first != Sign::Zero && side(b, c, at) == first && side(c, a, at) == first)
            .then(|| Crossing { triangle, direction: first.value() })
    };
    triangles.iter().enumerate().filter_map(crosses).collect()
}

/// Returns on which side of the line from `a` to `b` the point lies: positive to the left. On the line it counts as
/// moved a little aside, always the same way, so that it is zero only where `a` equals `b`.
fn side(a: DVec2, b: DVec2, point: DVec2) -> Sign {
    // The side of (x + e, y + e²) is that of (x, y) + e (a.y − b.y) + e² (b.x − a.x).
    side_of_line([a, b], point).or_else(|| Sign::between(b.y, a.y)).or_else(|| Sign::between(a.x, b.x))
}

/// Returns how often closed `triangles` wind around `point`, exactly: 0 outside, 1 inside a body that is wound
/// outwards, −1 inside one wound inwards. `None` where the point may be on the surface.
pub fn winding_number(world: &[DVec3], triangles: &[[u32; 3]], point: DVec3) -> Option<i32> {
    let corners = |triangle: usize| triangles[triangle].map(|vertex| world[vertex as usize]);
    // On the surface: in the plane of a triangle in whose bounds it lies.
    let may_be_on = |triangle: usize| {
        let [a, b, c] = corners(triangle);
        point.cmpge(a.min(b).min(c)).all()
            && point.cmple(a.max(b).max(c)).all()
            && side_of_triangle([a, b, c], point.extend(1.0)) == Sign::Zero
    };
    if (0..triangles.len()).any(may_be_on) {
        return None;
    }
    let ahead = |crossing: &Crossing| {
        // The point is behind a triangle that the ray leaves through its front.
        side_of_triangle(corners(crossing.triangle), point.extend(1.0)).value() == -crossing.direction
    };
    let crossings = crossings(world, triangles, point, 0);
    Some(crossings.iter().filter(|crossing| ahead(crossing)).map(|crossing| crossing.direction).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box between two corners with its outside out.
    fn cube(low: f64, high: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let at = |i: usize, axis: usize| if i >> axis & 1 == 0 { low } else { high };
        let points = (0..8).map(|i| DVec3::new(at(i, 0), at(i, 1), at(i, 2))).collect();
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        (points, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
    }

    #[test]
    fn points_in_line_with_edges_and_corners_are_decided() {
        let (world, triangles) = cube(0.0, 2.0);
        // Every point of a lattice: rays along x run through corners, edges and diagonals.
        for x in -1..=5 {
            for y in -1..=5 {
                for z in -1..=5 {
                    let point = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) / 2.0;
                    let inside = point.cmpgt(DVec3::ZERO).all() && point.cmplt(DVec3::splat(2.0)).all();
                    let outside = point.cmplt(DVec3::ZERO).any() || point.cmpgt(DVec3::splat(2.0)).any();
                    let expected = if inside || outside { Some(i32::from(inside)) } else { None };
                    assert_eq!(winding_number(&world, &triangles, point), expected, "{point}");
                }
            }
        }
    }

    #[test]
    fn shells_add_and_turned_ones_take_away() {
        let (mut world, mut triangles) = cube(0.0, 9.0);
        let (inner, flipped) = cube(3.0, 6.0);
        triangles.extend(flipped.iter().map(|&[a, b, c]| [a + 8, c + 8, b + 8]));
        world.extend(inner);
        assert_eq!(winding_number(&world, &triangles, DVec3::splat(1.0)), Some(1));
        assert_eq!(winding_number(&world, &triangles, DVec3::splat(4.5)), Some(0));
        triangles.truncate(12);
        let flipped: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(winding_number(&world, &flipped, DVec3::splat(4.5)), Some(-1));
    }
}
