//! Which casters lie wholly in the umbra of another.
//!
//! What a convex body darkens, `{L + s(o − L), s ≥ 1}` over its points `o`, is convex too, and whatever lies in it
//! darkens nothing that is not in it. So a caster whose bounding box's corners are all in the umbra of a convex one
//! needs no volume of its own. They must lie deep in it, so that what the one darkens is less than what the other does:
//! two casters can't each be in the umbra of the other, and each chain of them ends at one that is drawn. The same is
//! true of the parts of one mesh, such as a box in a box.

use super::{Connectivity, EdgeList};
use crate::math::{AxisBox, Plane};
use glam::{DVec3, DVec4};

/// How far inside the umbra a point must be, relative to the occluder's size, and to the distance to the light.
const MARGIN: f64 = 1e-6;

/// A convex body: a solid, or a flat sheet without thickness.
#[derive(Debug, Clone)]
pub enum ConvexBody {
    /// The planes of its faces, positive outside.
    Solid(Vec<Plane>),
    /// Its plane, and the planes through its border that are perpendicular to it, positive outside.
    Sheet(Plane, Vec<Plane>),
}

/// A convex body with its size, for testing whether others lie wholly in its umbra.
#[derive(Debug, Clone)]
pub struct ConvexOccluder {
    body: ConvexBody,
    size: f64,
}

impl ConvexOccluder {
    /// Meshes of more triangles are not tested for convexity: what hides others is mostly a wall, board or box.
    pub const MOST_TRIANGLES: usize = 64;

    /// Returns a mesh as a convex occluder; `None` where it is not convex or has too many triangles. `edges` are those
    /// of `triangles`.
    pub fn new(world: &[DVec3], triangles: &[[u32; 3]], edges: &EdgeList) -> Option<ConvexOccluder> {
        if triangles.is_empty() || triangles.len() > ConvexOccluder::MOST_TRIANGLES {
            return None;
        }
        let used = || triangles.iter().flatten().map(|vertex| world[*vertex as usize]);
        let size = AxisBox::around(used()).diagonal();
        let flatness = size * 1e-9;
        let planes: Option<Vec<Plane>> = triangles.iter().map(|corners| plane_of(world, *corners, size)).collect();
        let planes = planes?;
        let incident = |index: usize| edges.incident(index).count();
        let is_flat = used().all(|point| planes[0].at(point.extend(1.0)).abs() <= flatness);
        let body = if is_flat {
            let border = (0..edges.edges().len()).filter(|index| incident(*index) == 1);
            // Tiles of one side: no edge has more than two, and they do not overlap.
            let is_tiled = (0..edges.edges().len()).all(|index| incident(index) <= 2)
                && planes.iter().all(|plane| plane.normal.dot(planes[0].normal) > 0.0);
            let middle = used().sum::<DVec3>() / (3 * triangles.len()) as f64;
            let upright = border.map(|index| {
                let [a, b] = [edges.edges()[index].low, edges.edges()[index].high].map(|v| world[v as usize]);
                let plane = Plane::through(a, (b - a).cross(planes[0].normal));
                if plane.at(middle.extend(1.0)) > 0.0 { plane.flipped() } else { plane }
            });
            is_tiled.then(|| ConvexBody::Sheet(planes[0], upright.collect()))?
        } else {
            let middle = used().sum::<DVec3>() / (3 * triangles.len()) as f64;
            let is_flipped = |plane: &Plane| plane.at(middle.extend(1.0)) > 0.0;
            // Oriented outwards, its triangles run along each edge once either way: the surface is whole.
            let run = |(triangle, way): (usize, i32)| if is_flipped(&planes[triangle]) { -way } else { way };
            let is_closed = (0..edges.edges().len())
                .all(|index| incident(index) == 2 && edges.incident(index).map(run).sum::<i32>() == 0);
            let outwards = |plane: &Plane| if is_flipped(plane) { plane.flipped() } else { *plane };
            is_closed.then(|| ConvexBody::Solid(planes.iter().map(outwards).collect()))?
        };
        let (ConvexBody::Solid(outside) | ConvexBody::Sheet(_, outside)) = &body;
        let is_convex = outside.iter().all(|plane| used().all(|point| plane.at(point.extend(1.0)) <= flatness));
        (is_convex && !outside.is_empty()).then_some(ConvexOccluder { body, size })
    }

    /// Returns whether all of these points (world space) are safely inside its umbra; false without points.
    pub fn darkens_all(&self, points: &[DVec3], light: DVec4) -> bool {
        !points.is_empty() && points.iter().all(|point| self.darkens(*point, light))
    }

    fn darkens(&self, point: DVec3, light: DVec4) -> bool {
        // To a lamp the way ends at 1; to a sun it has unit length and no end.
        let way = light.truncate() - point * light.w;
        let way = if light.w == 0.0 { way.normalize_or_zero() } else { way / light.w };
        let (end, margin) = match light.w == 0.0 {
            true => (f64::INFINITY, MARGIN * self.size),
            false => (1.0 - MARGIN, MARGIN * (self.size / way.length()).max(1.0)),
        };
        let slope = |plane: &Plane| plane.normal.dot(way);
        let at = |plane: &Plane| plane.at(point.extend(1.0));
        match &self.body {
            ConvexBody::Solid(planes) => {
                // What follows asks about a slightly smaller body, which a light on a face is outside of.
                let lamp = (light.truncate() / light.w).extend(1.0);
                if light.w != 0.0 && planes.iter().all(|plane| plane.at(lamp) <= MARGIN * self.size) {
                    return false;
                }
                let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
                for plane in planes {
                    let (slope, height) = (slope(plane), at(plane) + MARGIN * self.size);
                    match slope {
                        slope if slope < 0.0 => enters = enters.max(height / -slope),
                        slope if slope > 0.0 => leaves = leaves.min(-height / slope),
                        _ if height > 0.0 => return false,
                        _ => (),
                    }
                }
                // Deep in the body itself it is as dark.
                let is_inside = planes.iter().all(|plane| at(plane) < -MARGIN * self.size);
                (is_inside || enters > margin) && enters < leaves && leaves < end
            }
            ConvexBody::Sheet(plane, border) => {
                let meets = -at(plane) / slope(plane);
                let hit = (point + way * meets).extend(1.0);
                let is_inside = border.iter().all(|plane| plane.at(hit) < -MARGIN * self.size);
                meets.is_finite() && meets > margin && meets < end && is_inside
            }
        }
    }
}

/// Meshes of more triangles are not asked for parts in the umbra of others, as each plan would test all of them.
const MOST_TRIANGLES_OF_PARTS: usize = 65_536;
/// The most parts, the largest, that are tested as occluders of other parts.
const MOST_HOLDERS: usize = 8;

/// Returns, for each triangle of a mesh, whether its connected component lies wholly in the umbra of another, convex
/// component; empty where none does. Only the largest convex components are tried, and very large meshes are not
/// examined.
pub fn in_umbra_of_parts(
    world: &[DVec3],
    triangles: &[[u32; 3]],
    connectivity: &Connectivity,
    light: DVec4,
) -> Vec<bool> {
    if connectivity.components < 2 || triangles.len() > MOST_TRIANGLES_OF_PARTS {
        return Vec::new();
    }
    let mut parts: Vec<Vec<[u32; 3]>> = vec![Vec::new(); connectivity.components];
    for (index, corners) in triangles.iter().enumerate() {
        parts[connectivity.component_of(index)].push(*corners);
    }
    let used = |part: &Vec<[u32; 3]>| AxisBox::around(part.iter().flatten().map(|vertex| world[*vertex as usize]));
    let bounds: Vec<AxisBox> = parts.iter().map(used).collect();
    let size = |part: &usize| bounds[*part].diagonal();
    let may_hold = |part: &usize| parts[*part].len() <= ConvexOccluder::MOST_TRIANGLES;
    let mut largest: Vec<usize> = (0..parts.len()).filter(may_hold).collect();
    if largest.is_empty() {
        return Vec::new();
    }
    largest.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let umbra_of = |part: usize| {
        let (vertices, triangles) = alone(world, &parts[part]);
        let edges = EdgeList::new(&triangles, vertices.len());
        Some((part, ConvexOccluder::new(&vertices, &triangles, &edges)?))
    };
    let holders: Vec<(usize, ConvexOccluder)> = largest.into_iter().take(MOST_HOLDERS).filter_map(umbra_of).collect();
    let is_in_umbra = |(part, bounds): (usize, &AxisBox)| {
        let corners = bounds.corners();
        holders.iter().any(|(other, umbra_of)| *other != part && umbra_of.darkens_all(&corners, light))
    };
    let in_umbra: Vec<bool> = bounds.iter().enumerate().map(is_in_umbra).collect();
    if !in_umbra.contains(&true) {
        return Vec::new();
    }
    (0..triangles.len()).map(|index| in_umbra[connectivity.component_of(index)]).collect()
}

/// Returns the vertices that a part uses, in their order and each once, and its triangles as indices into them.
fn alone(world: &[DVec3], part: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut used: Vec<u32> = part.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let own = |vertex: u32| used.binary_search(&vertex).unwrap_or_default() as u32;
    let triangles = part.iter().map(|corners| corners.map(own)).collect();
    (used.iter().map(|vertex| world[*vertex as usize]).collect(), triangles)
}

fn plane_of(world: &[DVec3], corners: [u32; 3], size: f64) -> Option<Plane> {
    let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
    let normal = (b - a).cross(c - a);
    (normal.length() > 1e-9 * size * size).then(|| Plane::through(a, normal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shapes;

    fn occluder(mesh: &crate::scene::Mesh, offset: DVec3) -> Option<ConvexOccluder> {
        let world: Vec<DVec3> = mesh.positions().iter().map(|point| *point + offset).collect();
        ConvexOccluder::new(&world, mesh.triangles(), &EdgeList::new(mesh.triangles(), world.len()))
    }

    const LAMP: DVec4 = DVec4::new(0.0, 4.0, 0.0, 1.0);
    const SUN: DVec4 = DVec4::new(0.0, 3.0, 0.0, 0.0);

    #[test]
    fn a_part_holds_those_that_lie_in_it_or_behind_it() {
        let in_umbra = |inner: f64, offset: [f64; 3], light: DVec4| {
            let [outer, inner] = [2.0, inner].map(|size| shapes::cuboid([size; 3]).expect("a box"));
            let both = shapes::joined([(&outer, DVec3::ZERO), (&inner, DVec3::from_array(offset))]).expect("two boxes");
            let connectivity = Connectivity::new(&both, &EdgeList::new(both.triangles(), both.positions().len()));
            in_umbra_of_parts(both.positions(), both.triangles(), &connectivity, light)
        };
        let inner_alone: Vec<bool> = (0..24).map(|triangle| triangle >= 12).collect();
        for light in [LAMP, SUN, DVec4::new(5.0, 2.0, 1.0, 1.0), DVec4::new(1e9, 4e8, 1e8, 1.0)] {
            assert_eq!(in_umbra(1.0, [0.1, 0.2, 0.0], light), inner_alone, "{light}");
            assert_eq!(in_umbra(1.0, [4.0, 0.0, 3.0], light), Vec::<bool>::new(), "{light}");
            assert!(in_umbra(2.0, [0.0; 3], light).is_empty(), "in its faces");
            assert!(in_umbra(2.0 - 1e-9, [0.0; 3], light).is_empty(), "too near to its faces");
        }
        assert_eq!(in_umbra(1.0, [0.0, -3.0, 0.0], SUN), inner_alone);
        assert!(in_umbra(1.0, [0.6, -3.0, 0.0], SUN).is_empty(), "its side shows");
        assert!(in_umbra(1.0, [0.0, 9.0, 0.0], LAMP).is_empty(), "beyond the light");
        // A lamp in the outer box, on its face, or a hair off it: nothing is proven.
        for height in [0.9, 1.0 - 1e-6, 1.0 - 1e-9, 1.0, 1.0 + 1e-9] {
            let lamp = DVec4::new(0.3, height, 0.2, 1.0);
            assert!(in_umbra(1.0, [0.0, -0.2, 0.0], lamp).is_empty(), "{height}");
            let cube = occluder(&shapes::cuboid([2.0; 3]).expect("a box"), DVec3::ZERO).expect("convex");
            assert!(!cube.darkens_all(&[DVec3::ZERO], lamp), "{height}");
            assert!(!cube.darkens_all(&[DVec3::new(0.3, -3.0, 0.2)], lamp) || height > 1.0, "{height}");
        }
        assert_eq!(in_umbra(1.0, [0.0, -0.2, 0.0], DVec4::new(0.3, 1.001, 0.2, 1.0)), inner_alone);
    }

    #[test]
    fn a_box_and_a_board_hold_what_is_behind_them() {
        let cube = occluder(&shapes::cuboid([2.0; 3]).expect("a box"), DVec3::ZERO).expect("convex");
        let board = occluder(&shapes::quad([2.0; 2]).expect("a quad"), DVec3::ZERO).expect("convex");
        for (body, low) in [(&cube, -1.0), (&board, 0.0)] {
            for light in [LAMP, SUN] {
                let is_dark = |point: [f64; 3]| body.darkens_all(&[DVec3::from_array(point)], light);
                assert!(is_dark([0.0, low - 0.01, 0.0]));
                assert!(is_dark([0.99, low - 2.0, 0.99]));
                assert!(!is_dark([0.0, 3.0, 0.0]), "before it");
                assert!(!is_dark([0.0, low, 0.0]), "on it");
                assert!(!is_dark([0.0, -low + 0.001, 0.0]), "before it, near");
                assert!(!body.darkens_all(&[], light));
            }
            assert!(!body.darkens_all(&[DVec3::new(1.01, low - 0.5, 0.0)], SUN));
        }
        // The lamp's umbra widens: at 1 below the board it reaches 1.25.
        assert!(board.darkens_all(&[DVec3::new(1.24, -1.0, 0.0)], LAMP));
        assert!(!board.darkens_all(&[DVec3::new(1.26, -1.0, 0.0)], LAMP));
        assert!(!cube.darkens_all(&[DVec3::new(0.0, 9.0, 0.0)], DVec4::new(0.0, 0.0, 0.0, 1.0)), "a light inside");
    }

    #[test]
    fn at_the_border_it_errs_to_the_safe_side() {
        for offset in [DVec3::ZERO, DVec3::splat(1e6)] {
            let board = occluder(&shapes::quad([2.0; 2]).expect("a quad"), offset).expect("convex");
            for off in [-1e-9, 0.0, 1e-9] {
                assert!(!board.darkens_all(&[offset + DVec3::new(1.0 + off, -1.0, 0.0)], SUN), "{off}");
                assert!(!board.darkens_all(&[offset + DVec3::new(0.0, off, 0.0)], SUN), "{off}");
            }
        }
    }

    #[test]
    fn what_is_not_convex_or_not_whole_is_no_occluder() {
        assert!(occluder(&shapes::torus(1.0, 0.3, 4, 3).expect("a torus"), DVec3::ZERO).is_none());
        let of = |points: &[[f64; 3]], triangles: &[[u32; 3]]| {
            let world: Vec<DVec3> = points.iter().map(|point| DVec3::from_array(*point)).collect();
            ConvexOccluder::new(&world, triangles, &EdgeList::new(triangles, world.len()))
        };
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, -1.0], [0.0, 0.0, -1.0], [0.3, 0.0, -0.3]];
        assert!(of(&corners, &[[0, 1, 2], [0, 2, 3]]).is_some());
        assert!(of(&corners, &[[0, 1, 4], [0, 4, 3]]).is_none(), "a dent");
        assert!(of(&corners, &[[0, 1, 4], [1, 2, 4], [2, 3, 4]]).is_none(), "a piece is missing");
        let tetrahedron = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert!(of(&tetrahedron, &sides).is_some());
        assert!(of(&tetrahedron, &sides[..3]).is_none(), "it is open");
        let doubled = [sides[0], sides[0], sides[1], sides[1]];
        assert!(of(&tetrahedron, &doubled).is_none(), "two sides, each twice");
    }

    /// Of two boards at one place, or two that cross, neither is in the umbra of the other.
    #[test]
    fn two_casters_never_hold_each_other() {
        let mesh = shapes::quad([2.0; 2]).expect("a quad");
        let [one, other] = [DVec3::ZERO, DVec3::new(0.0, 1e-12, 0.0)].map(|at| (occluder(&mesh, at), at));
        let points = |at: DVec3| mesh.positions().iter().map(|point| *point + at).collect::<Vec<_>>();
        assert!(!one.0.expect("convex").darkens_all(&points(other.1), LAMP));
        assert!(!other.0.expect("convex").darkens_all(&points(one.1), LAMP));
    }
}
