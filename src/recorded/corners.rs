//! Which object has a corner at a place: how a shadow volume is known to be a surface's.

use super::space::neighbours;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Corners are equal where they are no farther apart than this part of their distance from the eye: a program may move
/// the corners of its volumes by a bias.
const SAME_PLACE: f64 = 1e-4;
/// How far single precision moves a corner at most, as a part of its distance from the eye.
const ROUNDED: f64 = 4e-6;

/// Returns whether two places are one but for rounding; false where one is at infinity.
pub(super) fn is_same_place(one: DVec3, other: DVec3) -> bool {
    one.is_finite() && one.distance(other) <= SAME_PLACE * one.length()
}

/// Objects by their corners, which can be looked up although they were rounded. Where some have a corner at a place but for
/// rounding, others that have one beside it are not meant: parts of a model touch each other nearly.
#[derive(Default)]
pub(super) struct KnownCorners {
    at_place: CornerGrid,
    beside_it: CornerGrid,
}

/// Objects by the cells in which they have corners.
#[derive(Default)]
struct CornerGrid(BTreeMap<[i64; 3], Vec<usize>>);

impl CornerGrid {
    fn add(&mut self, object: usize, cell: [i64; 3]) {
        let of_cell = self.0.entry(cell).or_default();
        if of_cell.last() != Some(&object) {
            of_cell.push(object);
        }
    }

    /// Returns the objects that have corners in a cell or in one that touches it, some of them more than once.
    fn around(&self, cell: [i64; 3]) -> impl Iterator<Item = usize> {
        neighbours(cell).filter_map(|cell| self.0.get(&cell)).flatten().copied()
    }
}

impl KnownCorners {
    pub(super) fn add(&mut self, object: usize, places: &[DVec3]) {
        for place in places {
            self.at_place.add(object, KnownCorners::cell(*place, ROUNDED));
            self.beside_it.add(object, KnownCorners::cell(*place, SAME_PLACE));
        }
    }

    /// Returns the grid cell of a place. Cells grow with the distance from the origin, so that places which are apart by
    /// no more than a part of that distance lie in one cell or in neighbouring ones.
    fn cell(place: DVec3, part: f64) -> [i64; 3] {
        // Steps that double with the distance, so that both of a pair take the same.
        let size = (place.length().max(f64::MIN_POSITIVE).log2().ceil()).exp2() * part;
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

    /// Returns whether any object has a corner at a place, or beside it.
    pub(super) fn is_corner(&self, place: DVec3) -> bool {
        self.beside_it.around(KnownCorners::cell(place, SAME_PLACE)).next().is_some()
    }

    /// Returns the objects that have a corner at a place, or where none has, beside it.
    pub(super) fn objects_at(&self, place: DVec3) -> BTreeSet<usize> {
        let at_place: BTreeSet<usize> = self.at_place.around(KnownCorners::cell(place, ROUNDED)).collect();
        match at_place.is_empty() {
            true => self.beside_it.around(KnownCorners::cell(place, SAME_PLACE)).collect(),
            false => at_place,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_objects_that_nearly_touch_the_one_at_a_place_has_its_corner() {
        let place = DVec3::new(-153.842, -52.016, -167.228);
        let rounded = place * (1.0 + 3e-7);
        let beside = place + DVec3::new(-0.014, 0.004, -0.005);
        let mut corners = KnownCorners::default();
        corners.add(3, &[beside]);
        // A bias, which no other corner is nearer than.
        assert_eq!(corners.objects_at(place), BTreeSet::from([3]));
        corners.add(5, &[rounded]);
        assert_eq!(corners.objects_at(place), BTreeSet::from([5]));
        assert_eq!(corners.objects_at(beside), BTreeSet::from([3]));
        assert_eq!(corners.most(&[place, beside, place]), Some((5, 2)));
    }
}
