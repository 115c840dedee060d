//! Triangles at whose outline no volume begins. Volumes are of the triangles that face the light, or of those that face
//! away from it: of a closed mesh either have the same outline, and of one with holes light goes through the others.

use super::corners::KnownCorners;
use super::volume_parts::CornerGroups;
use super::volumes::drawn_volumes;
use crate::math::{Sign, side_of_triangle};
use crate::plan::{FramePlan, LightId};
use crate::scene::{Object, Scene};
use glam::{DVec3, DVec4};
use std::collections::BTreeMap;

/// Triangles on one side, towards a light or away from it, whose volume is not drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct UncastTriangles {
    /// Where the light is for them: homogeneous, in the eye's space.
    pub light: DVec4,
    /// The edges of their outlines in the eye's space, counter-clockwise as the light sees them.
    pub outline: Vec<[DVec3; 2]>,
    /// At how many of these edges no volume begins.
    pub without_volume: usize,
}

/// Finds the triangles of the casters of a light whose volume is not drawn, though that of those on the other side may be.
/// Each outline that is connected is whole, also where volumes begin at some of its edges. `scene` is of the frame.
pub fn uncast_triangles(plan: &FramePlan, scene: &Scene, light: LightId) -> Vec<UncastTriangles> {
    let mut begun = KnownCorners::default();
    for (_, triangles) in drawn_volumes(plan, light) {
        for [a, b, c] in triangles {
            for [from, to] in [[a, b], [b, c], [c, a]].into_iter().filter(|ends| ends.iter().all(|end| end.w == 1.0)) {
                begun.add(0, &[(from + to).truncate() / 2.0]);
            }
        }
    }
    let of_light = scene.lights.get(light.0).map_or(DVec4::ZERO, |light| light.position);
    let mut of_places: BTreeMap<[u64; 4], (DVec4, Vec<&Object>)> = BTreeMap::new();
    for object in scene.objects.iter().filter(|object| object.casts && object.visible) {
        let position = *object.light_positions.get(&light.0).unwrap_or(&of_light);
        of_places.entry(position.to_array().map(f64::to_bits)).or_insert((position, Vec::new())).1.push(object);
    }
    let mut uncast = Vec::new();
    for (position, casters) in of_places.into_values() {
        for side in [Sign::Positive, Sign::Negative] {
            let is_begun = |[from, to]: &[DVec3; 2]| begun.is_corner((from + to) / 2.0);
            let (mut outline, mut without_volume) = (Vec::new(), 0);
            for part in connected(&outline_of(&casters, position, side)) {
                let missing = part.iter().filter(|edge| !is_begun(edge)).count();
                if missing > 0 {
                    without_volume += missing;
                    outline.extend(part);
                }
            }
            if without_volume > 0 {
                uncast.push(UncastTriangles { light: position, outline, without_volume });
            }
        }
    }
    uncast
}

/// Returns the edges that more triangles on one side of a light run along one way than the other, counter-clockwise as the
/// light sees them. Corners at bit-equal places are one, also those of several objects.
fn outline_of(objects: &[&Object], light: DVec4, side: Sign) -> Vec<[DVec3; 2]> {
    let mut sums: BTreeMap<[[u64; 3]; 2], (i32, [DVec3; 2])> = BTreeMap::new();
    for object in objects {
        let places = object.world_positions();
        let triangles = object.mesh.triangles().iter().map(|triangle| triangle.map(|corner| places[corner as usize]));
        for [a, b, c] in triangles.filter(|triangle| side_of_triangle(*triangle, light) == side) {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let [one, other] = [from, to].map(place_bits);
                let low_first = one < other;
                let ends = if low_first { [from, to] } else { [to, from] };
                let (sum, _) = sums.entry([one.min(other), one.max(other)]).or_insert((0, ends));
                *sum += if low_first == (side == Sign::Positive) { 1 } else { -1 };
            }
        }
    }
    let edge = |(sum, [low, high]): (i32, [DVec3; 2])| {
        std::iter::repeat_n(if sum > 0 { [low, high] } else { [high, low] }, sum.unsigned_abs() as usize)
    };
    sums.into_values().flat_map(edge).collect()
}

/// Returns edges in the parts that share no corner.
fn connected(edges: &[[DVec3; 2]]) -> Vec<Vec<[DVec3; 2]>> {
    let mut numbers: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut groups = CornerGroups::default();
    for ends in edges {
        let [from, to] = ends.map(|end| *numbers.entry(place_bits(end)).or_insert_with(|| groups.add()));
        groups.join(from, to);
    }
    let mut parts: BTreeMap<usize, Vec<[DVec3; 2]>> = BTreeMap::new();
    for edge in edges {
        parts.entry(groups.group(numbers[&place_bits(edge[0])])).or_default().push(*edge);
    }
    parts.into_values().collect()
}

/// Returns the bits of a place; −0 is 0.
fn place_bits(place: DVec3) -> [u64; 3] {
    place.to_array().map(|value| (value + 0.0).to_bits())
}
