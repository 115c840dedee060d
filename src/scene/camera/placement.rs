//! Where light and camera are placed when neither is given.
//!
//! The eye looks from the front, a quarter round and a little from above, so near that the objects fill a good part of
//! the picture's height. The light stands above and to the other side in front, so that lit parts, shadowed ones and
//! those that face away all show and the shadow falls to where the eye sees the floor.

use crate::math::angle;
use crate::scene::{Camera, Light};
use glam::DVec3;

/// Direction from the scene's centre towards the eye.
const TOWARDS_EYE: DVec3 = DVec3::new(0.42, 0.44, 0.8);
/// Direction from the scene's centre towards the light.
const TOWARDS_LIGHT: DVec3 = DVec3::new(0.9, 1.15, 0.12);
/// Distance of the light, in sums of the bounding box's extents.
const LIGHT_DISTANCE: f64 = 1.25;
/// The part of the picture's height that the objects fill.
const HEIGHT_FILLED: f64 = 0.62;
/// How much wider than that height they may be.
const WIDTH_OVER_HEIGHT: f64 = 1.35;
/// Distance of the near plane, in distances from the eye to its target.
const NEAR: f64 = 0.01;
const FOV_Y_DEGREES: f64 = 45.0;

/// The axis-aligned bounding box of a scene's objects, from which camera and light are placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneBounds {
    low: DVec3,
    high: DVec3,
}

/// A unit cube around the origin.
impl Default for SceneBounds {
    fn default() -> SceneBounds {
        SceneBounds { low: DVec3::splat(-0.5), high: DVec3::splat(0.5) }
    }
}

impl SceneBounds {
    /// Returns the axis-aligned bounding box of these points, in their space; `None` where there are none, or where the
    /// sum of its extents isn't finite.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a DVec3>) -> Option<SceneBounds> {
        let mut points = points.into_iter();
        let first = *points.next()?;
        let (low, high) = points.fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)));
        (high - low).element_sum().is_finite().then_some(SceneBounds { low, high })
    }

    /// Returns the sum of the bounding box's three extents, the unit of every distance here; 1 where the points are all
    /// in one place.
    pub fn extent(&self) -> f64 {
        let sum = (self.high - self.low).element_sum();
        if sum > 0.0 { sum } else { 1.0 }
    }

    /// Returns the lowest height.
    pub fn lowest(&self) -> f64 {
        self.low.y
    }

    /// Returns whether the vertical line through the origin meets the bounding box, its border included.
    pub fn surrounds_origin(&self) -> bool {
        self.low.x <= 0.0 && 0.0 <= self.high.x && self.low.z <= 0.0 && 0.0 <= self.high.z
    }

    /// Returns the centre of the bounding box.
    pub fn middle(&self) -> DVec3 {
        self.low / 2.0 + self.high / 2.0
    }

    /// Returns a white point light above in front, at a distance in proportion to the box's extent.
    pub fn light(&self) -> Light {
        let towards_light = TOWARDS_LIGHT.normalize();
        Light::point(self.middle() + towards_light * LIGHT_DISTANCE * self.extent())
    }

    /// Returns a perspective camera that looks at the box's middle from above in front and has all of `points` in view,
    /// in a picture wider than high, without a far plane.
    pub fn camera<'a>(&self, points: impl IntoIterator<Item = &'a DVec3>) -> Camera {
        let back = TOWARDS_EYE.normalize();
        let right = DVec3::Y.cross(back).normalize();
        let up = back.cross(right);
        let target = self.middle();
        let half_height = angle::tan((FOV_Y_DEGREES / 2.0).to_radians()) * HEIGHT_FILLED;
        let half_width = half_height * WIDTH_OVER_HEIGHT;
        let distance_for = |point: &DVec3| {
            let offset = *point - target;
            let sideways = (offset.dot(right).abs() / half_width).max(offset.dot(up).abs() / half_height);
            offset.dot(back) + sideways
        };
        let nearest = 0.1 * self.extent();
        let distance = points.into_iter().map(distance_for).fold(nearest, f64::max);
        Camera {
            eye: target + back * distance,
            target,
            up: DVec3::Y,
            projection: crate::scene::Projection::Perspective,
            fov_y_degrees: FOV_Y_DEGREES,
            near: distance * NEAR,
            far: None,
            viewport: None,
        }
    }
}
