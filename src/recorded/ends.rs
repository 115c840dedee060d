//! Which corners of a shadow volume are its far end: those that were carried away from the light.

use super::space::neighbours;
use glam::{DVec3, DVec4};
use std::collections::BTreeMap;

/// Returns for each place whether it is at infinity, or lies behind another on the same ray from a light at `position`
/// (homogeneous), within tolerances. False for `None`.
pub fn far_ends(places: &[Option<DVec4>], position: DVec4) -> Vec<bool> {
    /// Places are on one ray where their directions differ by no more than this, as a part of their length.
    const SAME: f64 = 1e-4;
    let is_point = position.w != 0.0;
    let size = places.iter().flatten().map(|place| place.truncate().length()).fold(0.0, f64::max) * SAME;
    let ray = |place: &DVec4| {
        let from = if is_point { position.truncate() / position.w } else { DVec3::ZERO };
        let away = place.truncate() - from;
        let along = if is_point { away.length() } else { -away.dot(position.truncate().normalize_or_zero()) };
        let across = match is_point {
            true => away / (along * SAME),
            false => (away + position.truncate().normalize_or_zero() * along) / size,
        };
        (across, along)
    };
    let cell = |across: DVec3| across.to_array().map(|value| value.round() as i64);
    let mut nearest: BTreeMap<[i64; 3], f64> = BTreeMap::new();
    for (across, along) in places.iter().flatten().filter(|place| place.w != 0.0).map(ray) {
        let known = nearest.entry(cell(across)).or_insert(along);
        *known = known.min(along);
    }
    let is_far = |place: &Option<DVec4>| {
        let Some(place) = place else { return false };
        let (across, along) = ray(place);
        let known = neighbours(cell(across)).filter_map(|cell| nearest.get(&cell));
        place.w == 0.0 || known.into_iter().any(|nearest| *nearest < along - along.abs() * 1e-3)
    };
    places.iter().map(is_far).collect()
}
