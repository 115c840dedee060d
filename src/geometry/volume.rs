//! Shadow volumes of any triangle soup: sides and two caps that close exactly.
//!
//! Vertices are the caster's own, followed by the same carried to infinity away from the light:
//! one each for a point light, a single one for a directional light. Indices:
//!
//! - *light cap*: the casting triangles in the surface's own vertex order, so that their depths
//!   are bit-equal to the surface's; those that face the light first (unturned), then those that
//!   had to be turned, which are drawn with front and back operations swapped.
//! - *dark cap*: the same triangles at infinity, turned to face away from the light. With a
//!   directional light it is one point and is left out.
//! - *sides*: |m| quads an edge of multiplicity m, directed by its sign and split along a
//!   diagonal that depends only on vertex indices. With a directional light, triangles.

use super::{EdgeList, facing, multiplicities};
use crate::math::Sign;
use glam::{DVec3, DVec4};
use std::ops::Range;

/// Vertices and triangles of one caster's shadow volume for one light.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// Homogeneous world positions: the caster's, then those at infinity (`w = 0`).
    pub vertices: Vec<DVec4>,
    /// Into `vertices`, front faces outwards but for turned light-cap triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Where each part lies in `triangles`.
    pub parts: VolumeParts,
}

/// Runs of a volume's triangles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VolumeParts {
    /// Quads from the silhouette to infinity.
    pub sides: Range<usize>,
    /// Casting triangles that face the light as they are.
    pub light_cap: Range<usize>,
    /// Casting triangles that face away and count as turned, in their own vertex order.
    pub light_cap_turned: Range<usize>,
    /// At infinity.
    pub dark_cap: Range<usize>,
}

impl Volume {
    /// The volume that a caster with welded `world` positions throws away from `light`.
    #[must_use]
    pub fn new(world: &[DVec3], triangles: &[[u32; 3]], edges: &EdgeList, light: DVec4) -> Volume {
        let facing = facing(world, triangles, light);
        let infinity = Infinity { first: world.len() as u32, is_one_point: light.w == 0.0 };
        let mut out = Vec::new();
        push_sides(&mut out, edges, &multiplicities(edges, &facing), infinity);
        let sides = 0..out.len();
        out.extend(casting(triangles, &facing, Sign::Positive));
        let light_cap = sides.end..out.len();
        out.extend(casting(triangles, &facing, Sign::Negative));
        let light_cap_turned = light_cap.end..out.len();
        if !infinity.is_one_point {
            let carried = |corners: [u32; 3]| corners.map(|vertex| infinity.of(vertex));
            out.extend(casting(triangles, &facing, Sign::Positive).map(|[a, b, c]| carried([a, c, b])));
            out.extend(casting(triangles, &facing, Sign::Negative).map(carried));
        }
        let dark_cap = light_cap_turned.end..out.len();
        let parts = VolumeParts { sides, light_cap, light_cap_turned, dark_cap };
        Volume { vertices: vertices(world, light), triangles: out, parts }
    }
}

/// Where vertices at infinity are.
#[derive(Clone, Copy)]
struct Infinity {
    first: u32,
    is_one_point: bool,
}

impl Infinity {
    fn of(self, vertex: u32) -> u32 {
        if self.is_one_point { self.first } else { self.first + vertex }
    }
}

/// Near positions, then the directions in which they go away from the light: V·L.w − L.
fn vertices(world: &[DVec3], light: DVec4) -> Vec<DVec4> {
    let away = |position: DVec3| (position * light.w - light.truncate()).extend(0.0);
    let near = world.iter().map(|position| position.extend(1.0));
    if light.w == 0.0 {
        return near.chain([away(DVec3::ZERO)]).collect();
    }
    near.chain(world.iter().map(|position| away(*position))).collect()
}

fn casting<'a>(triangles: &'a [[u32; 3]], facing: &'a [Sign], sign: Sign) -> impl Iterator<Item = [u32; 3]> + 'a {
    triangles.iter().zip(facing).filter(move |(_, facing)| **facing == sign).map(|(corners, _)| *corners)
}

fn push_sides(out: &mut Vec<[u32; 3]>, edges: &EdgeList, multiplicities: &[i32], infinity: Infinity) {
    for (edge, &multiplicity) in edges.edges().iter().zip(multiplicities) {
        // The turned triangle runs from `low` to `high` where the multiplicity is positive; the
        // side beside it must run back along the edge for the volume to close.
        let (p, q) = (edge.low, edge.high);
        let (p_away, q_away) = (infinity.of(p), infinity.of(q));
        let quad = match (multiplicity > 0, infinity.is_one_point) {
            (true, true) => [Some([q, p, p_away]), None],
            (false, true) => [Some([p, q, p_away]), None],
            // Both directions are split along the diagonal from p to q's infinity.
            (true, false) => [Some([q, p, q_away]), Some([p, p_away, q_away])],
            (false, false) => [Some([p, q, q_away]), Some([p, q_away, p_away])],
        };
        for _ in 0..multiplicity.unsigned_abs() {
            out.extend(quad.iter().flatten());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// Every edge of a closed surface is run equally often either way. Turned light-cap triangles
    /// count as turned.
    fn assert_closed(volume: &Volume) {
        let mut balance = BTreeMap::new();
        for (index, &[a, b, c]) in volume.triangles.iter().enumerate() {
            let corners = if volume.parts.light_cap_turned.contains(&index) { [a, c, b] } else { [a, b, c] };
            for side in 0..3 {
                let (from, to) = (corners[side], corners[(side + 1) % 3]);
                if from != to {
                    *balance.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
                }
            }
        }
        assert!(balance.values().all(|sum| *sum == 0), "{balance:?}");
    }

    fn soup(seed: u64, triangles: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut state = seed;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        let world = (0..12).map(|_| DVec3::new(next(7) as f64, next(7) as f64, next(7) as f64)).collect();
        let corners = |start: u64, step: u64, jump: u64| [start, start + step, start + step + jump];
        let list = (0..triangles).map(|_| corners(next(12), 1 + next(5), 1 + next(5)).map(|i| (i % 12) as u32));
        (world, list.collect())
    }

    #[test]
    fn volumes_of_random_soups_close() {
        for seed in 0..300 {
            let (world, triangles) = soup(seed, 1 + seed as usize % 20);
            let edges = EdgeList::new(&triangles, world.len());
            assert_closed(&Volume::new(&world, &triangles, &edges, DVec4::new(3.0, 20.0, 2.0, 1.0)));
            assert_closed(&Volume::new(&world, &triangles, &edges, DVec4::new(1.0, 2.0, 2.0, 1.0)));
        }
    }

    /// Seen from the light, one triangle has three sides, and all parts face outwards.
    #[test]
    fn a_single_triangle_turned_away_casts_like_one_turned_towards() {
        let world = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for (corners, is_turned) in [([0, 1, 2], false), ([0, 2, 1], true)] {
            let edges = EdgeList::new(&[corners], 3);
            let volume = Volume::new(&world, &[corners], &edges, DVec4::new(0.2, 0.2, 4.0, 1.0));
            assert_eq!(volume.parts.sides.len(), 6);
            assert_eq!(volume.parts.light_cap.len(), usize::from(!is_turned));
            assert_eq!(volume.parts.light_cap_turned.len(), usize::from(is_turned));
            assert_eq!(volume.parts.dark_cap.len(), 1);
            assert_closed(&volume);
            let inside = DVec3::new(0.3, 0.3, -1.0);
            for index in volume.parts.sides.clone() {
                let [a, b, c] = volume.triangles[index].map(|v| volume.vertices[v as usize]);
                let matrix = glam::DMat4::from_cols(a, b, c, inside.extend(1.0));
                assert!(matrix.determinant() > 0.0, "the inside is behind every side");
            }
        }
    }

    #[test]
    fn a_directional_light_needs_no_dark_cap_and_half_the_sides() {
        let world = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let edges = EdgeList::new(&[[0, 1, 2]], 3);
        let volume = Volume::new(&world, &[[0, 1, 2]], &edges, DVec4::new(0.0, 0.0, 1.0, 0.0));
        assert_eq!(volume.parts.sides.len(), 3);
        assert!(volume.parts.dark_cap.is_empty());
        assert_eq!(volume.vertices.len(), 4);
    }
}
