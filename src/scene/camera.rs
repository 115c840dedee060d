//! The eye: a pinhole camera by eye point, target and up.

use glam::DVec3;

/// A pinhole camera in world space. View space is right-handed and looks down −z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where the eye is, world units (metres).
    pub eye: DVec3,
    /// The point in the middle of the picture; differs from `eye`.
    pub target: DVec3,
    /// Roughly up; not parallel to `target − eye`.
    pub up: DVec3,
    /// Vertical field of view in degrees, in (0, 180).
    pub fov_y_degrees: f64,
    /// Distance of the near plane, > 0.
    pub near: f64,
    /// Distance of the far plane; only finite depth mappings look at it.
    pub far: Option<f64>,
}

impl Camera {
    /// An eye that looks at a target with a field of view of 45 degrees, its near plane 5 cm away and no far
    /// plane. Y is up, or −z where it looks straight down or up.
    #[must_use]
    pub fn looking(eye: impl Into<DVec3>, target: impl Into<DVec3>) -> Camera {
        let (eye, target) = (eye.into(), target.into());
        let ahead = (target - eye).normalize_or_zero();
        let up = if ahead.y.abs() > 0.99 { DVec3::NEG_Z } else { DVec3::Y };
        Camera { eye, target, up, fov_y_degrees: 45.0, near: 0.05, far: None }
    }

    /// Names what makes this camera unusable, in a few words for an error line.
    ///
    /// # Errors
    /// The first rule broken: numbers that single precision can work with, an eye apart from its
    /// target, an up that is not along the view, a field of view in (0, 180), 0 < near < far.
    pub fn check(&self) -> Result<(), &'static str> {
        let vectors = [self.eye, self.target, self.up];
        let forward = self.target - self.eye;
        let sideways = forward.normalize_or_zero().cross(self.up.normalize_or_zero());
        if !vectors.iter().all(|vector| vector.abs().max_element() <= 1e30) {
            Err("the camera's eye, target and up must be numbers up to 1e30")
        } else if forward.length() == 0.0 {
            Err("the camera's eye equals its target: move one of them")
        } else if sideways.length() < 1e-9 {
            Err("the camera's up is zero or along the view: choose another up")
        } else if !(0.001..180.0).contains(&self.fov_y_degrees) {
            Err("the field of view must be between 0.001 and 180 degrees")
        } else if !(1e-30..=1e30).contains(&self.near) {
            Err("the near plane must be at a distance from 1e-30 to 1e30")
        } else if self.far.is_some_and(|far| !(far > self.near && far.is_finite())) {
            Err("the far plane must be farther than the near plane")
        } else {
            Ok(())
        }
    }

    /// The same camera somewhere else, for tests and benchmarks of what must hold from any place: eye,
    /// target and near plane are moved by up to 1.2 and 0.3 of their distance, and to between a tenth and ten
    /// times. One `seed` always gives one place.
    #[must_use]
    pub fn anywhere(&self, seed: u64) -> Camera {
        // Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators".
        let mut state = seed;
        let mut unit = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        let distance = (self.eye - self.target).length();
        let mut within =
            |reach: f64| DVec3::new(unit(), unit(), unit()).map(|one| (2.0 * one - 1.0) * reach * distance);
        let (target, eye) = (self.target + within(0.3), self.target + within(1.2));
        Camera { eye, target, near: self.near * 10_f64.powf(2.0 * unit() - 1.0), ..*self }
    }
}
