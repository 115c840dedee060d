//! What closes a volume at infinity.
//!
//! Carried there, the casting triangles become cones of directions from the light. Near the light they open to
//! half-spaces, and single precision turns such a cone inside out. But all that counts is how often a surface at
//! infinity winds around each direction, and two surfaces with one border differ by whole spheres alone. So the border,
//! the far edges of the sides, is joined to one direction that the light looks along: a fan, whose triangles are few
//! and well-shaped. Then as many spheres are added, as octahedra, as it lacks: none where a side of the caster's
//! bounding box has the light outside and the fan's direction goes in through it, for then neither surface contains the
//! opposite direction. Elsewhere both are counted along one direction, by exact signs.

use super::{Facings, SilhouetteEdge};
use crate::math::{AxisBox, Sign, side_of_triangle};
use glam::{DVec3, DVec4};

/// The apex direction points to the box's middle only if it enters through a side at this sine or more.
const STEEP: f64 = 0.25;
/// Directions to count along, none of them special; the next is tried where one lies on a cone's border.
const PROBES: [DVec3; 4] = [
    DVec3::new(0.2719, -0.8461, 0.4583),
    DVec3::new(-0.7713, 0.3329, 0.5424),
    DVec3::new(0.1373, 0.5591, -0.8177),
    DVec3::new(0.9011, 0.4127, 0.1319),
];
/// Directions of an octahedron's corners.
const AXES: [DVec3; 6] = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
/// The octahedron's triangles by their corners, facing outwards.
const OCTAHEDRON: [[u32; 3]; 8] =
    [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];

/// The dark cap of an infinite volume under a point light: a fan of triangles at infinity around one direction, and
/// whole spheres that correct the count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapFan {
    /// The direction in which the fan's triangles meet.
    pub apex: DVec3,
    /// How many spheres at infinity are added; negative where they are taken away.
    pub spheres: i32,
}

impl CapFan {
    /// Makes the fan for a caster under a point light at `light`, from the silhouette of its casting triangles; `None`
    /// where every probe direction lies on a cone's border.
    pub fn new(
        world: &[DVec3],
        triangles: &[[u32; 3]],
        facings: &Facings,
        silhouette: &[SilhouetteEdge],
        light: DVec3,
    ) -> Option<CapFan> {
        let AxisBox { low, high } = AxisBox::around(world.iter().copied());
        if let Some(apex) = into_box(low, high, light) {
            return Some(CapFan { apex, spheres: 0 });
        }
        let ends = |edge: &SilhouetteEdge| {
            let [p, q] = [edge.edge.low, edge.edge.high].map(|vertex| world[vertex as usize]);
            // The way that the far cap runs along its border, so that a fan's triangle faces outwards.
            if edge.multiplicity > 0 { [q, p] } else { [p, q] }
        };
        let area = |edge: &SilhouetteEdge| {
            let [from, to] = ends(edge).map(|end| end - light);
            from.cross(to) * f64::from(edge.multiplicity.unsigned_abs())
        };
        let apex = silhouette.iter().map(area).sum::<DVec3>().try_normalize().unwrap_or(DVec3::NEG_Y);
        let far = light + apex * (high - low).length();
        let casting = || triangles.iter().zip(facings.signs()).filter(|(_, sign)| **sign != 0);
        let spheres_along = |probe: &DVec3| -> Option<i32> {
            let containment =
                |corners: &[u32; 3]| containment(light, corners.map(|vertex| world[vertex as usize]), *probe);
            let caps = casting().map(|(corners, _)| containment(corners).map(i32::abs)).sum::<Option<i32>>()?;
            let of_fan = |edge: &SilhouetteEdge| {
                let [from, to] = ends(edge);
                Some(self::containment(light, [from, to, far], *probe)? * edge.multiplicity.abs())
            };
            Some(caps - silhouette.iter().map(of_fan).sum::<Option<i32>>()?)
        };
        PROBES.iter().find_map(spheres_along).map(|spheres| CapFan { apex, spheres })
    }

    /// Returns the total number of triangles of the octahedra that stand for whole spheres at infinity: eight for each
    /// sphere that is added or taken away.
    pub fn sphere_triangles(&self) -> usize {
        OCTAHEDRON.len() * self.spheres.unsigned_abs() as usize
    }

    /// Returns the fan's vertices as directions (w = 0): its apex, then the six corners of an octahedron that stands
    /// for a sphere; no octahedron where no sphere is needed.
    pub fn vertices(&self) -> impl Iterator<Item = DVec4> + use<> {
        let axes = if self.spheres == 0 { &AXES[..0] } else { &AXES[..] };
        std::iter::once(self.apex).chain(axes.iter().copied()).map(|direction| direction.extend(0.0))
    }

    /// Returns the triangles of its octahedra as vertex indices, all octahedra on the same vertices, flipped where
    /// their number is negative; `first` is the index of the octahedron's first corner. Empty where it has none.
    pub fn sphere_indices(&self, first: u32) -> impl Iterator<Item = [u32; 3]> + use<> {
        let is_flipped = self.spheres < 0;
        let side = move |[a, b, c]: [u32; 3]| {
            [first + a, first + if is_flipped { c } else { b }, first + if is_flipped { b } else { c }]
        };
        (0..self.spheres.unsigned_abs()).flat_map(move |_| OCTAHEDRON.map(side))
    }
}

/// Returns a direction from a light towards the box from `low` to `high`: the inward axis of the side that it is
/// farthest outside of, or the unit direction to the box's middle where that is nearly as steep. `None` where the light
/// is inside or on it.
fn into_box(low: DVec3, high: DVec3, light: DVec3) -> Option<DVec3> {
    let above = [(DVec3::X, light.x - high.x), (DVec3::Y, light.y - high.y), (DVec3::Z, light.z - high.z)];
    let below = [(DVec3::NEG_X, low.x - light.x), (DVec3::NEG_Y, low.y - light.y), (DVec3::NEG_Z, low.z - light.z)];
    // The side that the light is farthest outside of.
    let (outward, outside) = above.into_iter().chain(below).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let to_middle = ((low + high) / 2.0 - light).normalize_or_zero();
    let is_steep = -to_middle.dot(outward) > STEEP;
    (outside > 0.0).then_some(if is_steep { to_middle } else { -outward })
}

/// Returns 1 or −1, by the triangle's winding as seen from the light, where the cone from the light through the
/// triangle strictly contains a direction; 0 where it does not, or the triangle is edge-on; `None` where the direction
/// is on the cone's border.
fn containment(light: DVec3, [a, b, c]: [DVec3; 3], direction: DVec3) -> Option<i32> {
    let turn = side_of_triangle([light, a, b], c.extend(1.0));
    let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| side_of_triangle([light, p, q], direction.extend(0.0)));
    if turn == Sign::Zero || sides.iter().any(|side| *side != turn && *side != Sign::Zero) {
        return Some(0);
    }
    (!sides.contains(&Sign::Zero)).then(|| turn.value())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_octahedron_faces_outwards_and_closes() {
        for [a, b, c] in OCTAHEDRON {
            let [a, b, c] = [a, b, c].map(|corner| AXES[corner as usize]);
            assert!(a.cross(b).dot(c) > 0.0);
        }
        let mut edges: Vec<[u32; 2]> = OCTAHEDRON.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]).collect();
        let reversed: Vec<[u32; 2]> = edges.iter().map(|[a, b]| [*b, *a]).collect();
        edges.sort_unstable();
        assert!(reversed.iter().all(|edge| edges.binary_search(edge).is_ok()));
    }

    #[test]
    fn a_light_outside_the_box_looks_into_it() {
        let looks = |light: DVec3| into_box(DVec3::ZERO, DVec3::ONE, light);
        assert_eq!(looks(DVec3::splat(0.5)), None);
        assert_eq!(looks(DVec3::new(0.5, 1.0, 0.5)), None);
        assert_eq!(looks(DVec3::new(0.5, 1.0_f64.next_up(), 0.5)), Some(DVec3::NEG_Y));
        // Toward the middle, where that goes in steeply enough; a wide box is entered straight.
        assert_eq!(looks(DVec3::new(0.5, 9.5, 0.5)), Some(DVec3::NEG_Y));
        assert_eq!(
            into_box(DVec3::NEG_ONE, DVec3::new(9.0, 1.0, 9.0), DVec3::new(-0.5, 1.1, -0.5)),
            Some(DVec3::NEG_Y)
        );
    }

    #[test]
    fn a_cone_holds_what_is_in_it_and_not_what_is_opposite() {
        let triangle = [DVec3::new(1.0, 0.0, -1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(-1.0, -1.0, -1.0)];
        let containment = |direction: DVec3| containment(DVec3::ZERO, triangle, direction);
        assert_eq!(containment(DVec3::NEG_Z).map(i32::abs), Some(1));
        assert_eq!(containment(DVec3::Z), Some(0));
        assert_eq!(containment(DVec3::X), Some(0));
        assert_eq!(containment(DVec3::new(-1.0, 0.3, -1.0)), None, "on its border");
        let [a, b, c] = triangle;
        assert_eq!(
            super::containment(DVec3::ZERO, [a, c, b], DVec3::NEG_Z),
            containment(DVec3::NEG_Z).map(|containment| -containment)
        );
    }
}
