//! Where a volume may end: beyond everything that its shadow can be seen on (Lloyd, Wendt, Govindaraju and Manocha
//! 2004, "CC Shadow Volumes", clamp volumes so).
//!
//! A count in front of surfaces runs along straight lines from the eye to them. A box around both contains all of these
//! lines, so nothing beyond one of its sides is counted; and once a light's rays have carried all of a caster beyond
//! that side, they never come back. So they are carried onto a plane a little outside of it.
//!
//! Casters that touch end on one plane, or not at all: where they share an edge, their volumes share a side's edge, and
//! two that end in different places round differently.

use super::connectivity::DisjointSets;
use super::relative;
use crate::math::AxisBox;
use foldhash::fast::RandomState;
use glam::{DVec3, DVec4};
use std::collections::HashMap;

/// How far outside of the box's side the end lies, relative to the size of the box around everything: more than
/// rounding to `f32` can move it.
const ROUNDING: f64 = 1e-4;
/// An upper bound for the relative error of a position in single precision.
const SINGLE_PRECISION: f64 = 1e-6;
/// How far a vertex may be carried, relative to the size of the box around everything; farther, it may as well go to
/// infinity.
const MOST_REACH: f64 = 100.0;

/// The far end of a shadow volume: an axis-aligned plane in world space, beyond all that is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClampedEnd {
    /// The axis that the plane is perpendicular to: 0, 1, 2 for x, y, z.
    axis: usize,
    /// Where on that axis, metres.
    at: f64,
    /// Whether all that is looked at has higher values on the axis than `at`; otherwise lower ones.
    is_below: bool,
}

impl ClampedEnd {
    /// Returns the nearest end for the volumes of `casters` under a homogeneous `light` that lies outside of
    /// `looked_at`, a box around the eye and all surfaces that their shadows may fall on; world space. `None` where the
    /// light's rays through the casters leave the box by no common side.
    pub fn beyond(looked_at: AxisBox, casters: &[AxisBox], light: DVec4) -> Option<ClampedEnd> {
        let size = casters.iter().fold(looked_at, |all, caster| all.joined(*caster)).diagonal();
        let corners: Vec<DVec3> = casters.iter().flat_map(AxisBox::corners).collect();
        let end = |(axis, is_below): (usize, bool)| {
            let outwards = if is_below { -1.0 } else { 1.0 };
            let side = if is_below { looked_at.low[axis] } else { looked_at.high[axis] };
            let end = ClampedEnd { axis, at: side + outwards * ROUNDING * size, is_below };
            // Not a number, where that overflows, is no reach either.
            let farthest = |farthest: f64, corner: &DVec3| {
                let reach = end.carry(*corner, light).distance(*corner);
                let leaves = outwards * along(*corner, light)[axis] > 0.0 && reach <= MOST_REACH * size;
                leaves.then_some(farthest.max(reach))
            };
            Some((corners.iter().try_fold(0.0, farthest)?, end))
        };
        let sides = [0, 1, 2].into_iter().flat_map(|axis| [(axis, true), (axis, false)]);
        sides.filter_map(end).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, end)| end)
    }

    /// Returns where a caster's vertex is carried: along the light's ray onto the plane. A vertex beyond the plane
    /// stays.
    pub fn carry(&self, position: DVec3, light: DVec4) -> DVec3 {
        let along = along(position, light);
        let way = (self.at - position[self.axis]) / along[self.axis];
        if way > 0.0 { position + along * way } else { position }
    }

    /// Returns whether all of a caster's box lies beyond the plane, so that its shadow falls on nothing that is looked
    /// at.
    pub fn is_passed_by(&self, caster: AxisBox) -> bool {
        if self.is_below { caster.high[self.axis] <= self.at } else { caster.low[self.axis] >= self.at }
    }

    /// Returns the axis that the plane is perpendicular to (0, 1, 2 for x, y, z), and its coordinate on that axis in
    /// metres.
    pub fn place(&self) -> (usize, f64) {
        (self.axis, self.at)
    }

    /// Returns whether all that is looked at has higher values on that axis than the plane; otherwise lower ones.
    pub fn is_below(&self) -> bool {
        self.is_below
    }
}

/// Groups casters that touch: those that share a vertex position in single precision relative to `origin`. Each caster
/// is its box and its vertices, world space; the groups list indices into `casters`, in the order of their first
/// members.
pub fn touching(casters: &[(AxisBox, &[DVec3])], origin: DVec3) -> Vec<Vec<usize>> {
    let grown = |(around, _): &(AxisBox, &[DVec3])| {
        let farthest = around.corners().map(|corner| corner.distance(origin)).into_iter().fold(0.0, f64::max);
        let rounding = DVec3::splat(SINGLE_PRECISION * farthest);
        AxisBox { low: around.low - rounding, high: around.high + rounding }
    };
    let grown: Vec<AxisBox> = casters.iter().map(grown).collect();
    let is_beside = |one: &usize| {
        grown.iter().enumerate().any(|(other, around)| other != *one && !around.common(grown[*one]).is_empty())
    };
    let mut sets = DisjointSets::new(casters.len());
    let mut first_at: HashMap<[u32; 3], usize, RandomState> = HashMap::default();
    for one in (0..casters.len()).filter(is_beside) {
        for vertex in casters[one].1 {
            let [x, y, z, _] = relative::point(*vertex, origin);
            // Zero has two signs.
            let place = [x, y, z].map(|part| (part + 0.0).to_bits());
            sets.join(*first_at.entry(place).or_insert(one), one);
        }
    }
    let (group_of, count) = sets.numbered();
    let mut groups = vec![Vec::new(); count];
    group_of.iter().enumerate().for_each(|(caster, group)| groups[*group as usize].push(caster));
    groups
}

/// Returns the direction of the light's ray through a point, of any length.
fn along(position: DVec3, light: DVec4) -> DVec3 {
    position * light.w - light.truncate()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(low: [f64; 3], high: [f64; 3]) -> AxisBox {
        AxisBox::around([low, high].map(DVec3::from_array))
    }

    /// A floor of eight metres with the eye three metres above it.
    fn room() -> AxisBox {
        around([-4.0, 0.0, -4.0], [4.0, 3.0, 6.0])
    }

    fn lamp(x: f64, y: f64, z: f64) -> DVec4 {
        DVec4::new(x, y, z, 1.0)
    }

    const STANDING: [[f64; 3]; 2] = [[-0.5, 0.0, -0.5], [0.5, 1.0, 0.5]];

    fn standing() -> AxisBox {
        around(STANDING[0], STANDING[1])
    }

    #[test]
    fn a_volume_ends_a_little_below_the_floor_that_its_caster_stands_on() {
        for light in [lamp(0.3, 5.0, 0.2), DVec4::new(0.3, 5.0, 0.2, 0.0)] {
            let end = ClampedEnd::beyond(room(), &[standing()], light).expect("an end");
            assert_eq!((end.place().0, end.is_below()), (1, true));
            assert!((-0.003..-0.0005).contains(&end.at), "{end:?}");
        }
    }

    /// Every point of it, and all that lies farther on, is outside of the box, and stays there in single precision.
    #[test]
    fn what_is_carried_there_has_left_the_box() {
        let lights = [[0.3, 5.0, 0.2, 1.0], [0.3, 1.2, 0.2, 1.0], [-3.0, 0.9, 0.0, 1.0], [9.0, 0.5, 2.0, 1.0]];
        let others = [[0.0, -2.0, 0.0, 1.0], [1e4, 1e4, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [3e5, 1.0, 1.0, 0.0]];
        let tiny = [[1.0, 1e-320, 0.0, 0.0], [1e-300, 1.0, 1e-320, 0.0]];
        let casters = [
            standing(),
            around([-0.5, 1e-9, -0.5], [0.5, 2e-9, 0.5]),
            around([-2.0, 0.1, -1.0], [-1.5, 0.2, 8.0]),
            around([-0.5, -1.0, -0.5], [0.5, 0.7, 0.5]),
        ];
        let mut seen = 0;
        for offset in [DVec3::ZERO, DVec3::splat(1e5)] {
            let moved = |of: AxisBox| AxisBox { low: of.low + offset, high: of.high + offset };
            let looked_at = moved(room());
            let lights = lights.iter().chain(&others).chain(&tiny).map(|light| DVec4::from_array(*light));
            for (light, caster) in lights.flat_map(|light| casters.map(|caster| (light, moved(caster)))) {
                let light = light + (offset * light.w).extend(0.0);
                let Some(end) = ClampedEnd::beyond(looked_at, &[caster], light) else { continue };
                seen += 1;
                for (corner, way) in
                    caster.corners().into_iter().flat_map(|corner| [0.0, 1.0, 1e3].map(|way| (corner, way)))
                {
                    let far = end.carry(corner, light);
                    assert!(far.is_finite(), "{light} {caster:?} {end:?}: {far}");
                    let place = far + along(corner, light).normalize() * way;
                    let side = if end.is_below { looked_at.low } else { looked_at.high }[end.axis];
                    let beyond = if end.is_below { side - place[end.axis] } else { place[end.axis] - side };
                    // Seen from the far side of the box.
                    let rounding = (place - looked_at.high).length().max((place - looked_at.low).length()) * 6e-8;
                    assert!(beyond > rounding, "{light} {caster:?} {end:?}: {place}, {beyond} beyond");
                    // It is carried away from the light.
                    assert!((far - corner).dot(along(corner, light)) >= 0.0, "{light} {caster:?} {end:?}: {far}");
                }
            }
        }
        assert!(seen >= 40, "{seen}");
    }

    #[test]
    fn rays_that_leave_by_no_side_go_on_to_infinity() {
        let caster = [standing()];
        assert_eq!(ClampedEnd::beyond(room(), &caster, lamp(0.1, 0.5, 0.0)), None, "the lamp is in it");
        let at_its_height = ClampedEnd::beyond(room(), &caster, lamp(0.0, 1.0, 0.0));
        assert_eq!(at_its_height, None, "its top is carried along the floor");
        let grazing = ClampedEnd::beyond(room(), &caster, lamp(0.0, 1.0 + 1e-6, 0.0));
        assert_eq!(grazing, None, "too far off to end anywhere near");
    }

    #[test]
    fn of_several_sides_the_nearest_is_taken() {
        let caster = around([-0.5, 1.0, -0.5], [0.5, 2.0, 0.5]);
        let end = ClampedEnd::beyond(room(), &[caster], lamp(-1.5, 2.1, 0.0)).expect("an end");
        assert_eq!((end.place().0, end.is_below()), (0, false));
    }

    /// Alone, the lower one ends below the floor, and the higher one behind a wall; both behind the wall, as that is
    /// nearer to all; and with one around the lamp nowhere.
    #[test]
    fn several_casters_leave_by_one_side() {
        let [low, high] = [[-0.5, 0.0], [1.0, 2.0]].map(|[from, to]| around([-0.5, from, -0.5], [0.5, to, 0.5]));
        let lamp = lamp(-1.5, 2.1, 0.0);
        let axis = |casters: &[AxisBox]| ClampedEnd::beyond(room(), casters, lamp).map(|end| end.place().0);
        assert_eq!((axis(&[high]), axis(&[low]), axis(&[low, high])), (Some(0), Some(1), Some(0)));
        let both = ClampedEnd::beyond(room(), &[low, high], lamp).expect("an end");
        for caster in [low, high] {
            caster.corners().into_iter().for_each(|corner| {
                let far = both.carry(corner, lamp)[both.axis];
                assert!(if both.is_below { far <= both.at } else { far >= both.at }, "{both:?}: {far}");
            });
        }
        assert_eq!(axis(&[low, high, around([-2.0, 1.0, -1.0], [-1.0, 3.0, 1.0])]), None);
    }

    #[test]
    fn casters_that_touch_are_one_group_through_others_too() {
        let cubes = |of: &[[f64; 2]]| -> Vec<AxisBox> {
            of.iter().map(|[x, y]| around([*x, *y, 0.0], [x + 1.0, y + 1.0, 1.0])).collect()
        };
        let groups = |of: &[[f64; 2]], origin: DVec3| {
            let corners: Vec<_> = cubes(of).into_iter().map(|cube| (cube, cube.corners())).collect();
            let casters: Vec<(AxisBox, &[DVec3])> =
                corners.iter().map(|(cube, corners)| (*cube, &corners[..])).collect();
            touching(&casters, origin)
        };
        let chain = [[3.0, 0.0], [0.0, 0.0], [9.0, 0.0], [2.0, 1.0], [1.0, 1.0]];
        assert_eq!(groups(&chain, DVec3::ZERO), [vec![0, 1, 3, 4], vec![2]]);
        // Beside each other with no vertex in common, and one in the other.
        assert_eq!(groups(&[[0.0, 0.0], [1.0, 0.5]], DVec3::ZERO), [[0], [1]]);
        assert_eq!(groups(&[[0.0, 0.0], [0.5, 0.5]], DVec3::ZERO), [[0], [1]]);
        // What single precision can't distinguish is drawn at one place.
        let near = [[0.0, 0.0], [1.0 + 1e-9, 0.0]];
        assert_eq!(groups(&near, DVec3::splat(90.0)), [[0, 1]]);
        assert_eq!(groups(&near, DVec3::new(1.0, 0.0, 0.0)), [[0], [1]]);
        assert_eq!(groups(&[], DVec3::ZERO), Vec::<Vec<usize>>::new());
    }
}
