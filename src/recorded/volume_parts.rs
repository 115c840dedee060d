//! The parts of shadow volumes that do not touch each other: one draw may have the volumes of many casters, and the volume
//! of one caster many draws.

use super::space::{PassSpace, triangles};
use crate::plan::{Draw, FramePlan, Pass};
use glam::DVec4;
use std::collections::BTreeMap;

/// A triangle of a draw, as homogeneous places of view space.
pub(super) type DrawnTriangle<'a> = (&'a Draw, [DVec4; 3]);

/// Returns the triangles of draws of the picture in parts that share no corner that is not at infinity: corners at bit-equal
/// places are one.
pub(super) fn volume_parts<'a>(
    plan: &FramePlan,
    draws: impl IntoIterator<Item = (&'a Pass, &'a Draw)>,
) -> Vec<Vec<DrawnTriangle<'a>>> {
    let mut all: Vec<DrawnTriangle> = Vec::new();
    for (pass, draw) in draws {
        let places = PassSpace::new(plan, pass).places(plan, draw);
        all.extend(triangles(plan, draw, &places).map(|(_, corners)| (draw, corners)));
    }
    let mut number: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut groups = CornerGroups::default();
    let mut group_of = |(_, corners): &DrawnTriangle| {
        let mut joined: Option<usize> = None;
        // All volumes of a directional light share the point at infinity.
        for corner in corners.iter().filter(|corner| corner.w != 0.0) {
            let corner = *number.entry(corner.truncate().to_array().map(f64::to_bits)).or_insert_with(|| groups.add());
            joined = Some(joined.map_or(corner, |other| groups.join(other, corner)));
        }
        joined
    };
    let corners: Vec<Option<usize>> = all.iter().map(&mut group_of).collect();
    let mut parts: BTreeMap<usize, Vec<DrawnTriangle>> = BTreeMap::new();
    for (triangle, corner) in all.into_iter().zip(corners) {
        // A triangle at infinity closes volumes, and is no caster's.
        if let Some(corner) = corner {
            parts.entry(groups.group(corner)).or_default().push(triangle);
        }
    }
    parts.into_values().collect()
}

/// Groups of corners that triangles join (Galler and Fischer 1964).
#[derive(Default)]
pub(super) struct CornerGroups {
    /// For each corner another one of its group; the first of a group has itself.
    towards: Vec<usize>,
}

impl CornerGroups {
    /// Adds a corner in a group of its own, and returns its number.
    pub fn add(&mut self) -> usize {
        self.towards.push(self.towards.len());
        self.towards.len() - 1
    }

    /// Returns the first corner of a corner's group.
    pub fn group(&mut self, mut corner: usize) -> usize {
        while self.towards[corner] != corner {
            self.towards[corner] = self.towards[self.towards[corner]];
            corner = self.towards[corner];
        }
        corner
    }

    /// Joins the groups of two corners, and returns the first corner of the group.
    pub fn join(&mut self, one: usize, other: usize) -> usize {
        let (one, other) = (self.group(one), self.group(other));
        let (first, second) = (one.min(other), one.max(other));
        self.towards[second] = first;
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_that_are_joined_by_turns_are_of_one_group() {
        let mut groups = CornerGroups::default();
        let [a, b, c, d, e] = [(); 5].map(|()| groups.add());
        groups.join(d, e);
        groups.join(a, b);
        groups.join(b, d);
        assert_eq!([a, b, d, e].map(|corner| groups.group(corner)), [a; 4]);
        assert_eq!(groups.group(c), c);
    }
}
