//! The frustum of a light's own map as handles: what is dragged becomes the numbers of `light-frustum`.
//!
//! A lamp's map looks from the lamp, so that its corners make an angle; a sun's is a box around the middle of what casts, whose
//! two ends are as far from that: both move when one is dragged.

use crate::anatomy::{Anatomy, Frustum, ViewOf};
use crate::technique::{Choice, WIDEST_LIGHT_FRUSTUM};
use glam::DVec3;

/// The least share by which a far plane is farther than the near one.
const LEAST_DEPTH: f64 = 0.01;
/// What a frustum's numbers may be, as [`crate::technique::SettingValues`] says.
const LEAST: f64 = 1e-6;
const MOST: f64 = 1e9;
/// The distance at which a sun's near plane is said to lie where no number is given: only the distance between the planes counts.
const SUN_NEAR: f64 = 1.0;

/// A part of a map's frustum that a handle moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MapPart {
    /// The near plane, along the map's axis.
    Near,
    /// The far plane.
    Far,
    /// A corner of the far plane, which widens the map on all sides: right top, left top, left bottom, right bottom.
    Corner(usize),
}

impl MapPart {
    /// All of them.
    pub const ALL: [MapPart; 6] =
        [MapPart::Near, MapPart::Far, MapPart::Corner(0), MapPart::Corner(1), MapPart::Corner(2), MapPart::Corner(3)];

    /// Returns its name for the user: `near plane`, `far plane`, `corner 1`.
    pub fn name(self) -> String {
        match self {
            MapPart::Near => "near plane".to_owned(),
            MapPart::Far => "far plane".to_owned(),
            MapPart::Corner(index) => format!("corner {}", index + 1),
        }
    }

    /// Returns to which sides of the axis it lies: right and up, each −1, 0 or 1.
    fn sides(self) -> [f64; 2] {
        match self {
            MapPart::Near | MapPart::Far => [0.0; 2],
            MapPart::Corner(index) => [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][index % 4],
        }
    }
}

/// The frustum of a light's map, which has one face, with the numbers that the draft gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapHandles {
    /// Index of the light.
    pub light: usize,
    /// A lamp's place; of a sun, the middle between the planes.
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    ahead: DVec3,
    /// Field of view in degrees or, of a sun, width in metres; near and far.
    numbers: [f64; 3],
    is_sun: bool,
}

impl MapHandles {
    /// Returns the frusta of all lights' maps that have one face, of a choice that has such maps; with the numbers of the
    /// choice where it gives them, so that handles are where the next frame has them. `reach` is how far a frustum without an
    /// end is drawn.
    pub fn all(anatomy: &Anatomy, choice: &Choice, reach: f64) -> Vec<MapHandles> {
        if !choice.has_light_frustum() {
            return Vec::new();
        }
        let lights = anatomy.lights.iter().enumerate();
        let of_light = |light: usize| {
            let mut faces = anatomy.frusta.iter().filter(
                move |frustum| matches!(frustum.of, ViewOf::Map { light: of, caster: None, .. } if of == light),
            );
            faces.next().filter(|frustum| faces.next().is_none() && !frustum.ends_at_light())
        };
        let found = lights.filter_map(|(light, placed)| {
            let lamp = (placed.position.w != 0.0).then(|| placed.position.truncate() / placed.position.w);
            MapHandles::of(light, lamp, of_light(light)?, reach, choice.given_frustum())
        });
        found.collect()
    }

    fn of(
        light: usize,
        lamp: Option<DVec3>,
        frustum: &Frustum,
        reach: f64,
        given: Option<[f64; 3]>,
    ) -> Option<MapHandles> {
        let near = frustum.near.map(|corner| corner.truncate() / corner.w);
        let far = [0, 1, 2, 3].map(|index: usize| match frustum.far[index] {
            direction if direction.w == 0.0 => near[index] + direction.truncate().normalize_or_zero() * reach,
            corner => corner.truncate() / corner.w,
        });
        let middle = |corners: [DVec3; 4]| corners.iter().sum::<DVec3>() / 4.0;
        let (near_middle, far_middle) = (middle(near), middle(far));
        let right = (near[0] - near[1]).try_normalize()?;
        let up = (near[1] - near[2]).try_normalize()?;
        let axis = right.cross(up).try_normalize()?;
        let ahead = axis * axis.dot(far_middle - near_middle).signum();
        let along = |point: DVec3, from: DVec3| (point - from).dot(ahead);
        let fitted = match lamp {
            Some(lamp) => {
                let [near_at, far_at] = [near_middle, far_middle].map(|point| along(point, lamp));
                let slope = near.map(|corner| {
                    let aside = corner - lamp;
                    aside.dot(right).abs().max(aside.dot(up).abs()) / near_at
                });
                let slope = slope.into_iter().fold(0.0, f64::max);
                [(2.0 * slope.atan().to_degrees()).min(WIDEST_LIGHT_FRUSTUM), near_at, far_at]
            }
            None => {
                let width = near[0].distance(near[1]).max(near[1].distance(near[2]));
                [width, SUN_NEAR, SUN_NEAR + along(far_middle, near_middle)]
            }
        };
        let numbers = given.unwrap_or(fitted);
        let origin = lamp.unwrap_or((near_middle + far_middle) / 2.0);
        let is_usable = numbers.iter().all(|number| number.is_finite() && *number > 0.0) && numbers[1] < numbers[2];
        is_usable.then_some(MapHandles { light, origin, right, up, ahead, numbers, is_sun: lamp.is_none() })
    }

    /// Returns where a part's handle is, world space.
    pub fn place(&self, part: MapPart) -> DVec3 {
        let [_, near, far] = self.numbers;
        let distance = if part == MapPart::Near { near } else { far };
        let along = if self.is_sun { distance - (near + far) / 2.0 } else { distance };
        let [right, up] = part.sides();
        self.origin + self.ahead * along + (self.right * right + self.up * up) * self.half()
    }

    /// Half of the width of the far plane, metres.
    fn half(&self) -> f64 {
        let [fov, _, far] = self.numbers;
        if self.is_sun { fov / 2.0 } else { far * (fov.to_radians() / 2.0).tan() }
    }

    /// Returns the value of `light-frustum` after a part's handle was moved by `by`, world space: the far plane stays beyond the
    /// near one, and a lamp's corners make no more than the widest angle.
    pub fn moved(&self, part: MapPart, by: DVec3) -> String {
        let [mut fov, mut near, mut far] = self.numbers;
        let along = self.ahead.dot(by);
        match part {
            MapPart::Near | MapPart::Far if self.is_sun => {
                let outwards = if part == MapPart::Near { -along } else { along };
                far = near + (far - near + 2.0 * outwards).max(LEAST_DEPTH * near);
            }
            MapPart::Near => near = (near + along).clamp(LEAST, far / (1.0 + LEAST_DEPTH)),
            MapPart::Far => far = (far + along).max(near * (1.0 + LEAST_DEPTH)),
            MapPart::Corner(_) => {
                let [right, up] = part.sides();
                let half = self.half() + (self.right * right + self.up * up).dot(by) / 2.0;
                fov = match self.is_sun {
                    true => (2.0 * half).max(LEAST_DEPTH * fov),
                    false => 2.0 * (half / far).atan().to_degrees(),
                };
                fov = fov.max(LEAST_DEPTH);
            }
        }
        let most = if self.is_sun { MOST } else { WIDEST_LIGHT_FRUSTUM };
        [fov.clamp(LEAST, most), near.clamp(LEAST, MOST / 2.0), far.clamp(2.0 * LEAST, MOST)].map(written).join(":")
    }
}

/// Returns a number with four decimals, or six significant digits where it is small, without zeros at the end.
fn written(number: f64) -> String {
    let text = if number < 0.1 { format!("{number:.9}") } else { format!("{number:.4}") };
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec4;

    fn corners(distance: f64, half: f64) -> [DVec4; 4] {
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]
            .map(|[x, y]: [f64; 2]| DVec3::new(x * half, y * half, -distance).extend(1.0))
    }

    fn handles(lamp: Option<DVec3>, half: [f64; 2], given: Option<[f64; 3]>) -> MapHandles {
        let of = ViewOf::Map { light: 0, face: 0, caster: None };
        let frustum = Frustum { of, near: corners(2.0, half[0]), far: corners(6.0, half[1]) };
        MapHandles::of(0, lamp, &frustum, 10.0, given).expect("a frustum")
    }

    #[test]
    fn a_lamp_s_planes_and_corners_are_where_they_are_drawn_and_become_numbers() {
        let lamp = handles(Some(DVec3::ZERO), [2.0, 6.0], None);
        assert!(lamp.place(MapPart::Near).distance(DVec3::Z * -2.0) < 1e-12);
        assert!(lamp.place(MapPart::Far).distance(DVec3::Z * -6.0) < 1e-12);
        for (index, corner) in corners(6.0, 6.0).into_iter().enumerate() {
            assert!(lamp.place(MapPart::Corner(index)).distance(corner.truncate()) < 1e-9);
        }
        assert_eq!(lamp.moved(MapPart::Near, DVec3::Z), "90:1:6");
        assert_eq!(lamp.moved(MapPart::Far, DVec3::new(5.0, 0.0, -3.0)), "90:2:9");
        // From a half of 6 to one of 6·tan 30°.
        let by = 6.0 * (1.0 / 3f64.sqrt() - 1.0);
        assert_eq!(lamp.moved(MapPart::Corner(0), DVec3::new(by, by, 0.0)), "60:2:6");
        assert_eq!(lamp.moved(MapPart::Corner(2), DVec3::new(-by, -by, 0.0)), "60:2:6");
        // Never beyond each other, and never wider than a map can be.
        assert_eq!(lamp.moved(MapPart::Near, DVec3::Z * -50.0), "90:5.9406:6");
        assert_eq!(lamp.moved(MapPart::Far, DVec3::Z * 50.0), "90:2:2.02");
        assert_eq!(lamp.moved(MapPart::Corner(1), DVec3::new(-1e9, 1e9, 0.0)), format!("{WIDEST_LIGHT_FRUSTUM}:2:6"));
        let given = handles(Some(DVec3::ZERO), [2.0, 6.0], Some([60.0, 1.0, 9.0]));
        assert!(given.place(MapPart::Far).distance(DVec3::Z * -9.0) < 1e-12, "the draft's own");
    }

    #[test]
    fn a_sun_s_box_grows_at_both_ends_around_what_casts() {
        let sun = handles(None, [3.0, 3.0], None);
        assert!(sun.place(MapPart::Near).distance(DVec3::Z * -2.0) < 1e-12);
        assert!(sun.place(MapPart::Corner(3)).distance(DVec3::new(3.0, -3.0, -6.0)) < 1e-12);
        assert_eq!(sun.moved(MapPart::Near, DVec3::Z), "6:1:7");
        assert_eq!(sun.moved(MapPart::Far, DVec3::Z * -1.0), "6:1:7");
        assert_eq!(sun.moved(MapPart::Corner(0), DVec3::new(1.0, 1.0, 0.0)), "8:1:5");
        assert_eq!(sun.moved(MapPart::Far, DVec3::Z * 90.0), "6:1:1.01");
    }

    #[test]
    fn a_frustum_without_an_end_has_handles_where_it_is_drawn() {
        let of = ViewOf::Map { light: 0, face: 0, caster: None };
        let near = corners(1.0, 1.0);
        let far = near.map(|corner| corner.truncate().extend(0.0));
        let lamp =
            MapHandles::of(0, Some(DVec3::ZERO), &Frustum { of, near, far }, 3f64.sqrt(), None).expect("a frustum");
        assert!(lamp.place(MapPart::Far).distance(DVec3::Z * -2.0) < 1e-9, "{:?}", lamp.place(MapPart::Far));
    }
}
