//! The eye: a camera by eye point, target and up, with its projection.
//!
//! View rays of a perspective camera begin at the eye. Those of a parallel projection have one direction: they meet at
//! infinity, and the eye point only is where distances are measured from.

pub(super) mod placement;

use crate::math::angle;
use crate::math::depth::DepthCurve;
use crate::math::projection;
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
use serde::{Deserialize, Serialize};
use std::fmt;

/// How points before a camera are projected into its picture.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Projection {
    /// View rays begin at the eye; the field of view is the angle between them.
    #[default]
    Perspective,
    /// View rays are parallel and perpendicular to the picture.
    Orthographic {
        /// Distance from the picture's centre to its upper edge, metres, > 0.
        half_height: f64,
    },
    /// View rays are parallel and oblique to the picture: a plane perpendicular to the view is not distorted, and what
    /// lies behind it moves along a line of the picture. Cavalier projection with a factor of 1, cabinet with ½.
    Oblique {
        /// Distance from the picture's centre to its upper edge, metres, > 0.
        half_height: f64,
        /// Angle of the line along which things recede, degrees, from the right and counter-clockwise.
        angle_degrees: f64,
        /// How far a metre of depth moves things along that line, metres, at least 0.
        factor: f64,
    },
}

/// A view ray: `from + along · distance` for distances along the view's axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Its point at distance 0, world space, relative to the eye.
    pub from: DVec3,
    /// Its direction, world space; the part along the view's axis is 1.
    pub along: DVec3,
}

/// The view rays of a camera's picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraRays {
    world_from_view: DMat3,
    /// Distances from the picture's centre to its edges, at distance 1 of a perspective camera.
    half: DVec2,
    shear: DVec2,
    /// The distance at which an oblique projection shears nothing.
    in_place: f64,
    is_parallel: bool,
}

/// A camera in world space. View space is right-handed and looks down −z.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Position of the eye, world units (metres).
    pub eye: DVec3,
    /// The point at the centre of the picture; differs from `eye`.
    pub target: DVec3,
    /// Roughly up; not parallel to `target − eye`.
    pub up: DVec3,
    /// How it projects.
    #[serde(default, skip_serializing_if = "Projection::is_pinhole")]
    pub projection: Projection,
    /// Vertical field of view in degrees, in (0, 180); only for a perspective camera.
    pub fov_y_degrees: f64,
    /// Distance of the near plane, > 0.
    pub near: f64,
    /// Distance of the far plane; only finite depth mappings use it.
    pub far: Option<f64>,
}

/// What is changed of a scene's camera, as options and links say it; the rest stays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CameraChange {
    /// Position of the eye, world space.
    pub eye: Option<DVec3>,
    /// The point in the middle of the picture, world space.
    pub target: Option<DVec3>,
    /// What is up, world space.
    pub up: Option<DVec3>,
    /// The vertical field of view, degrees.
    pub fov_y_degrees: Option<f64>,
    /// Distance of the near plane, metres.
    pub near: Option<f64>,
    /// Distance of the far plane, metres.
    pub far: Option<f64>,
}

impl CameraChange {
    /// Returns what makes `before` see as `after` does; a far plane that was removed and another projection are no part of
    /// it.
    pub fn between(before: &Camera, after: &Camera) -> CameraChange {
        let changed = |after: DVec3, before: DVec3| (after != before).then_some(after);
        let number = |after: f64, before: f64| (after != before).then_some(after);
        CameraChange {
            eye: changed(after.eye, before.eye),
            target: changed(after.target, before.target),
            up: changed(after.up, before.up),
            fov_y_degrees: number(after.fov_y_degrees, before.fov_y_degrees),
            near: number(after.near, before.near),
            far: after.far.filter(|_| after.far != before.far),
        }
    }

    /// Changes a camera.
    ///
    /// # Errors
    /// The camera can't be used then: the reason. It is changed all the same.
    pub fn apply_to(&self, camera: &mut Camera) -> Result<(), &'static str> {
        camera.eye = self.eye.unwrap_or(camera.eye);
        camera.target = self.target.unwrap_or(camera.target);
        camera.up = self.up.unwrap_or(camera.up);
        camera.fov_y_degrees = self.fov_y_degrees.unwrap_or(camera.fov_y_degrees);
        camera.near = self.near.unwrap_or(camera.near);
        camera.far = self.far.or(camera.far);
        camera.check()
    }
}

impl Camera {
    /// Returns a perspective camera at `eye` that looks at `target` (world space, metres) with a vertical field of view
    /// of 45 degrees, its near plane 5 cm away and no far plane. Y is up, or −z within about 8 degrees of straight down
    /// or up. That the two points differ is not checked.
    pub fn looking(eye: impl Into<DVec3>, target: impl Into<DVec3>) -> Camera {
        let (eye, target) = (eye.into(), target.into());
        let ahead = (target - eye).normalize_or_zero();
        let up = if ahead.y.abs() > 0.99 { DVec3::NEG_Z } else { DVec3::Y };
        Camera { eye, target, up, projection: Projection::Perspective, fov_y_degrees: 45.0, near: 0.05, far: None }
    }

    /// Names what makes this camera unusable, in a few words for an error line.
    ///
    /// # Errors
    /// The first rule broken: numbers that single precision can work with, an eye apart from its
    /// target, an up that is not along the view, a field of view in (0, 180), 0 < near < far, a parallel
    /// projection's half height above 0, its angle a number and its factor from 0 to 100.
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
            self.projection.check()
        }
    }

    /// Returns whether view rays are parallel.
    pub fn is_parallel(&self) -> bool {
        !self.projection.is_pinhole()
    }

    /// Returns the rotation from view space to world space, for directions.
    pub fn world_from_view(&self) -> DMat3 {
        projection::view_from_world_rotation(self.target - self.eye, self.up).transpose()
    }

    /// Returns where view rays begin, homogeneous, world space: the eye, or where they are parallel the direction
    /// towards it.
    pub fn eye_position(&self) -> DVec4 {
        self.relative_eye() + (self.eye * self.relative_eye().w).extend(0.0)
    }

    /// Returns where view rays begin, homogeneous, relative to the eye point.
    pub fn relative_eye(&self) -> DVec4 {
        match self.projection {
            Projection::Perspective => DVec4::W,
            parallel => (self.world_from_view() * parallel.shear().extend(1.0)).extend(0.0),
        }
    }

    /// Returns a point whose count is valid for all view rays: the eye, or the centre of the near plane of a parallel
    /// camera, whose rays begin there.
    pub fn counting_place(&self) -> DVec3 {
        if self.is_parallel() { self.eye + self.rays(1.0).through(DVec2::ZERO).at(self.near) } else { self.eye }
    }

    /// Returns in words where volumes are counted from ([`Camera::counting_place`]).
    pub fn counting_place_name(&self) -> &'static str {
        if self.is_parallel() { "the middle of the near plane" } else { "the eye" }
    }

    /// Returns the view rays of a picture whose width is `aspect` times its height.
    pub fn rays(&self, aspect: f64) -> CameraRays {
        let half = self.half_height();
        CameraRays {
            world_from_view: self.world_from_view(),
            half: DVec2::new(half * aspect, half),
            shear: self.projection.shear(),
            in_place: (self.target - self.eye).length(),
            is_parallel: self.is_parallel(),
        }
    }

    /// Returns half of the height that the picture shows, metres: at distance 1 of a perspective camera, at any of a
    /// parallel projection.
    pub fn half_height(&self) -> f64 {
        match self.projection {
            Projection::Perspective => angle::tan(self.fov_y_degrees.to_radians() / 2.0),
            Projection::Orthographic { half_height } | Projection::Oblique { half_height, .. } => half_height,
        }
    }

    /// Returns half of the height that the picture shows at a distance along the view's axis, metres.
    pub fn half_height_at(&self, distance: f64) -> f64 {
        self.half_height() * if self.is_parallel() { 1.0 } else { distance }
    }

    /// Returns half of the height that the picture shows at the target's distance, metres.
    pub fn half_height_at_target(&self) -> f64 {
        self.half_height_at((self.target - self.eye).length())
    }

    /// Returns clip space from view space. Depth of a parallel projection is linear in the distance, from `near` to
    /// `far`.
    pub fn clip_from_view(&self, aspect: f64, depth: &DepthCurve) -> DMat4 {
        match self.projection {
            Projection::Perspective => projection::perspective(self.fov_y_degrees, aspect, depth),
            parallel => {
                let (half, shear) = (self.half_height(), parallel.shear());
                let in_place = (self.target - self.eye).length();
                projection::parallel([half * aspect, half], shear, in_place, depth)
            }
        }
    }

    /// Returns the camera with eye and target moved to its right by a number of distances between them: it looks the same
    /// way.
    #[must_use]
    pub fn moved_aside(&self, distances: f64) -> Camera {
        let by = self.world_from_view().x_axis * (self.eye.distance(self.target) * distances);
        Camera { eye: self.eye + by, target: self.target + by, ..*self }
    }

    /// Returns the same camera elsewhere, for tests and benchmarks of what must be true from any position: eye, target
    /// and near plane are moved by up to 1.2 and 0.3 of their distance, and to between a tenth and ten times. One
    /// `seed` always gives one position.
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

impl CameraRays {
    /// Returns the ray, relative to the eye, through a point of the picture, given by x and y from −1 to 1, right and
    /// up. Along it, distance 1 is one metre of depth along the view axis.
    #[inline]
    pub fn through(&self, at: DVec2) -> Ray {
        let place = at * self.half;
        if !self.is_parallel {
            return Ray { from: DVec3::ZERO, along: self.world_from_view * place.extend(-1.0) };
        }
        let (from, along) = ((place + self.shear * self.in_place).extend(0.0), (-self.shear).extend(-1.0));
        Ray { from: self.world_from_view * from, along: self.world_from_view * along }
    }

    /// Returns the unit direction, world space, in which the camera looks, away from the eye. Distances of rays are
    /// measured along it; the rays of an oblique view are not parallel to it.
    pub fn axis(&self) -> DVec3 {
        -self.world_from_view.z_axis
    }
}

impl Ray {
    /// Returns the point at a distance along the view's axis, relative to the eye.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.from + self.along * distance
    }
}

impl Projection {
    /// The names of the projections, in the order in which they are offered.
    pub const NAMES: [&str; 3] = ["perspective", "orthographic", "oblique"];
    /// The usual angle of an oblique projection, degrees.
    pub const USUAL_ANGLE: f64 = 45.0;
    /// The depth factor of a cabinet projection.
    pub const CABINET: f64 = 0.5;
    /// The depth factor of a cavalier projection.
    pub const CAVALIER: f64 = 1.0;

    /// Returns whether it is the perspective projection.
    pub fn is_pinhole(&self) -> bool {
        *self == Projection::Perspective
    }

    /// Returns its name: one of [`Projection::NAMES`].
    pub fn name(self) -> &'static str {
        match self {
            Projection::Perspective => "perspective",
            Projection::Orthographic { .. } => "orthographic",
            Projection::Oblique { .. } => "oblique",
        }
    }

    /// Returns how far to the right and up in the picture a metre of depth moves things, metres.
    pub fn shear(self) -> DVec2 {
        match self {
            Projection::Oblique { angle_degrees, factor, .. } => angle::direction(angle_degrees.to_radians()) * factor,
            Projection::Perspective | Projection::Orthographic { .. } => DVec2::ZERO,
        }
    }

    /// Checks the projection's own numbers: half height from 1e-30 to 1e30, angle within ±360 degrees, factor from 0 to
    /// 100. The error says what must be.
    fn check(self) -> Result<(), &'static str> {
        let is_usable = |half_height: f64| (1e-30..=1e30).contains(&half_height);
        match self {
            Projection::Perspective => Ok(()),
            Projection::Orthographic { half_height } | Projection::Oblique { half_height, .. }
                if !is_usable(half_height) =>
            {
                Err("the half height of a parallel projection must be from 1e-30 to 1e30 metres")
            }
            Projection::Oblique { angle_degrees, .. } if !(-360.0..=360.0).contains(&angle_degrees) => {
                Err("the angle of an oblique projection must be from -360 to 360 degrees")
            }
            Projection::Oblique { factor, .. } if !(0.0..=100.0).contains(&factor) => {
                Err("the depth factor of an oblique projection must be from 0 to 100")
            }
            Projection::Orthographic { .. } | Projection::Oblique { .. } => Ok(()),
        }
    }
}

/// Its name with all its numbers.
impl fmt::Display for Projection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Projection::Perspective => f.write_str("perspective"),
            Projection::Orthographic { half_height } => write!(f, "orthographic, half height {half_height}"),
            Projection::Oblique { half_height, angle_degrees, factor } => {
                write!(f, "oblique, half height {half_height}, angle {angle_degrees}, factor {factor}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::depth::DepthMapping;

    fn cameras() -> [Camera; 4] {
        let camera = Camera::looking([3.0, 2.0, 5.0], [0.5, -0.3, 0.2]);
        let oblique = |angle_degrees, factor| Projection::Oblique { half_height: 1.7, angle_degrees, factor };
        [
            Projection::Perspective,
            Projection::Orthographic { half_height: 2.5 },
            oblique(45.0, Projection::CABINET),
            oblique(120.0, Projection::CAVALIER),
        ]
        .map(|projection| Camera { projection, ..camera })
    }

    fn curve(camera: &Camera) -> DepthCurve {
        match camera.is_parallel() {
            true => DepthMapping::ReversedInfinite.linear_curve(0.5, 20.0),
            false => DepthMapping::ReversedInfinite.curve(0.5, 0.0, 0.0),
        }
    }

    /// The two descriptions of a camera agree: the matrix projects a point of a view ray to the ray's place in the
    /// picture.
    #[test]
    fn lines_of_sight_are_the_matrixs() {
        for camera in cameras() {
            let curve = curve(&camera);
            let clip_from_relative =
                camera.clip_from_view(1.5, &curve) * DMat4::from_mat3(camera.world_from_view().transpose());
            for at in [DVec2::ZERO, DVec2::new(-0.8, 0.3), DVec2::new(1.0, -1.0)] {
                let Ray { from, along } = camera.rays(1.5).through(at);
                for distance in [0.5, 3.0, 17.0] {
                    let clip = clip_from_relative * (from + along * distance).extend(1.0);
                    let place = clip.truncate() / clip.w;
                    assert!((place - at.extend(curve.depth(distance))).length() < 1e-12, "{camera:?}: {place}");
                }
                let eye = camera.relative_eye();
                let beside = (from * eye.w - along * (1.0 - eye.w)).cross(eye.truncate());
                assert!(beside.length() < 1e-12, "lines of sight meet in the eye");
            }
        }
    }

    #[test]
    fn the_target_is_in_the_middle_and_what_lies_behind_moves_along_the_angle() {
        for camera in cameras() {
            let curve = curve(&camera);
            let clip_from_view = camera.clip_from_view(1.0, &curve);
            let view = |world: DVec3| camera.world_from_view().transpose() * (world - camera.eye);
            let clip = clip_from_view * view(camera.target).extend(1.0);
            assert!(clip.truncate().truncate().length() < 1e-12 * clip.w.abs(), "{camera:?}");
            let Projection::Oblique { half_height, angle_degrees, factor } = camera.projection else { continue };
            let behind = camera.target + (camera.target - camera.eye).normalize();
            let clip = clip_from_view * view(behind).extend(1.0);
            let moved = DVec2::new(clip.x, clip.y) * half_height;
            assert!((moved - DVec2::from_angle(angle_degrees.to_radians()) * factor).length() < 1e-12);
        }
    }

    #[test]
    fn numbers_that_make_no_picture_are_refused() {
        let [pinhole, ..] = cameras();
        let oblique = |half_height, angle_degrees, factor| Projection::Oblique { half_height, angle_degrees, factor };
        for projection in [
            Projection::Orthographic { half_height: 0.0 },
            Projection::Orthographic { half_height: f64::NAN },
            oblique(-1.0, 45.0, 1.0),
            oblique(1.0, f64::INFINITY, 1.0),
            oblique(1.0, 45.0, -0.5),
            oblique(1.0, 45.0, f64::NAN),
        ] {
            let camera = Camera { projection, ..pinhole };
            assert!(camera.check().is_err(), "{projection:?}");
        }
        assert!(cameras().iter().all(|camera| camera.check().is_ok()));
    }
}
