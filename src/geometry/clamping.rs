//! Where a volume may end: beyond all that its shadow is looked at (Lloyd, Wendt, Govindaraju and Manocha 2004, "CC
//! Shadow Volumes", clamp volumes so).
//!
//! A count in front of surfaces runs along straight lines from the eye to them. A box around both holds all of these
//! lines, so of what lies beyond one of its sides nothing is counted; and once a light's rays have carried all of a
//! caster beyond that side, they never come back. So they are carried onto a plane a little outside of it.
//!
//! Casters that touch end on one plane, or not at all: where they share an edge, their volumes share a side's edge, and
//! two that end in different places round apart.

use super::connectivity::Sets;
use crate::math::AxisBox;
use glam::{DVec3, DVec4};

/// How far outside of the side the end lies, in parts of the box around all: more than `f32` can move it.
const ROUNDING: f64 = 1e-4;
/// A vertex that would be carried farther, in parts of the box around all, may as well go to infinity.
const MOST_REACH: f64 = 100.0;

/// The end of a volume: a plane across an axis of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClampedEnd {
    /// 0, 1, 2: x, y, z.
    axis: usize,
    /// Where on that axis, metres.
    at: f64,
    /// All that is looked at has higher values than `at`, not lower.
    is_below: bool,
}

impl ClampedEnd {
    /// The nearest end of the volumes of `casters` under a `light`, homogeneous, that is outside of `looked_at`, which
    /// holds all surfaces that their shadows may fall on, and the eye; world space. `None` where rays leave by no side.
    #[must_use]
    pub fn beyond(looked_at: AxisBox, casters: &[AxisBox], light: DVec4) -> Option<ClampedEnd> {
        let size = casters.iter().fold(looked_at, |all, caster| all.joined(*caster)).diagonal();
        let corners: Vec<DVec3> = casters.iter().flat_map(AxisBox::corners).collect();
        let end = |(axis, is_below): (usize, bool)| {
            let outwards = if is_below { -1.0 } else { 1.0 };
            let side = if is_below { looked_at.low[axis] } else { looked_at.high[axis] };
            let end = ClampedEnd { axis, at: side + outwards * ROUNDING * size, is_below };
            let mut farthest = 0.0_f64;
            let leaves = |corner: &DVec3| {
                let reach = end.carry(*corner, light).distance(*corner);
                farthest = farthest.max(reach);
                // Not a number, where that overflows, is no reach either.
                outwards * along(*corner, light)[axis] > 0.0 && reach <= MOST_REACH * size
            };
            corners.iter().all(leaves).then_some((farthest, end))
        };
        let sides = [0, 1, 2].into_iter().flat_map(|axis| [(axis, true), (axis, false)]);
        sides.filter_map(end).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, end)| end)
    }

    /// Where a vertex of that caster goes: along the light's ray onto the plane. What is beyond it stays.
    #[must_use]
    pub fn carry(&self, position: DVec3, light: DVec4) -> DVec3 {
        let along = along(position, light);
        let way = (self.at - position[self.axis]) / along[self.axis];
        if way > 0.0 { position + along * way } else { position }
    }

    /// The axis that it lies across, 0, 1 or 2 for x, y or z, and where on it, metres.
    #[must_use]
    pub fn place(&self) -> (usize, f64) {
        (self.axis, self.at)
    }

    /// Has all that is looked at higher values on that axis, not lower?
    #[must_use]
    pub fn is_below(&self) -> bool {
        self.is_below
    }
}

/// Casters that touch, by their boxes: for each the number of its group, and how many groups there are. What is
/// nearer than rounding beside `looked_at` touches.
#[must_use]
pub fn touching(casters: &[AxisBox], looked_at: AxisBox) -> (Vec<u32>, usize) {
    let gap = DVec3::splat(ROUNDING * casters.iter().fold(looked_at, |all, caster| all.joined(*caster)).diagonal());
    let grown = |of: &AxisBox| AxisBox { low: of.low - gap, high: of.high + gap };
    let mut by_start: Vec<usize> = (0..casters.len()).collect();
    by_start.sort_by(|a, b| casters[*a].low.x.total_cmp(&casters[*b].low.x));
    let mut sets = Sets::new(casters.len());
    for (place, one) in by_start.iter().enumerate() {
        let reach = grown(&casters[*one]);
        let beside = by_start[place + 1..].iter().take_while(|other| casters[**other].low.x <= reach.high.x);
        beside.filter(|other| !reach.common(casters[**other]).is_empty()).for_each(|other| sets.join(*one, *other));
    }
    sets.numbered()
}

/// The way of the light's ray through a place, of any length.
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

    /// Alone, the higher one leaves by the nearer wall; together they end below the floor, and with one around the lamp
    /// nowhere.
    #[test]
    fn several_casters_leave_by_one_side() {
        let [low, high] = [[-0.5, 0.0], [1.0, 2.0]].map(|[from, to]| around([-0.5, from, -0.5], [0.5, to, 0.5]));
        let lamp = lamp(-1.5, 2.1, 0.0);
        let axis = |casters: &[AxisBox]| ClampedEnd::beyond(room(), casters, lamp).map(|end| end.place().0);
        assert_eq!((axis(&[high]), axis(&[low])), (Some(0), Some(1)));
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
        let along = |x: f64, y: f64| around([x, y, 0.0], [x + 1.0, y + 1.0, 1.0]);
        let casters = [along(3.0, 0.0), along(0.0, 0.0), along(9.0, 0.0), along(2.0, 1.0), along(1.0, 1.0 + 1e-6)];
        let room = around([-4.0; 3], [12.0; 3]);
        assert_eq!(touching(&casters, room), (vec![0, 0, 1, 0, 0], 2));
        assert_eq!(touching(&[along(0.0, 0.0), along(0.0, 1.1)], room), (vec![0, 1], 2));
        assert_eq!(touching(&[], room), (vec![], 0));
    }
}
