//! Which object has a corner at a place: how a shadow volume is known to be a surface's.

use super::space::neighbours;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Corners are equal where they are no farther apart than this part of their distance from the eye.
const SAME_PLACE: f64 = 1e-4;

/// Returns whether two places are one but for rounding; false where one is at infinity.
pub(super) fn is_same_place(one: DVec3, other: DVec3) -> bool {
    one.is_finite() && one.distance(other) <= SAME_PLACE * one.length()
}

/// Objects by their corners, which can be looked up although they were rounded.
#[derive(Default)]
pub(super) struct KnownCorners(BTreeMap<[i64; 3], Vec<usize>>);

impl KnownCorners {
    pub(super) fn add(&mut self, object: usize, places: &[DVec3]) {
        for place in places {
            let of_cell = self.0.entry(KnownCorners::cell(*place)).or_default();
            if of_cell.last() != Some(&object) {
                of_cell.push(object);
            }
        }
    }

    /// Returns the grid cell of a place. Cells grow with the distance from the origin, so that equal places, which are
    /// rounded, lie in one cell or in neighbouring ones.
    fn cell(place: DVec3) -> [i64; 3] {
        // Steps that double with the distance, so that both of a pair take the same.
        let size = (place.length().max(f64::MIN_POSITIVE).log2().ceil()).exp2() * SAME_PLACE;
        (place / size).to_array().map(|value| value.round() as i64)
    }

    /// Returns the object that has corners at most of these places, and at how many; the last of equal ones. `None`
    /// where no place is a corner of any.
    pub(super) fn most(&self, places: &[DVec3]) -> Option<(usize, usize)> {
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        for object in places.iter().flat_map(|place| self.objects_at(*place)) {
            *counts.entry(object).or_default() += 1;
        }
        counts.into_iter().max_by_key(|(_, count)| *count)
    }

    /// Returns whether any object has a corner at a place.
    pub(super) fn is_corner(&self, place: DVec3) -> bool {
        neighbours(KnownCorners::cell(place)).any(|cell| self.0.contains_key(&cell))
    }

    /// Returns the objects that have a corner at a place.
    pub(super) fn objects_at(&self, place: DVec3) -> BTreeSet<usize> {
        neighbours(KnownCorners::cell(place)).filter_map(|cell| self.0.get(&cell)).flatten().copied().collect()
    }
}
