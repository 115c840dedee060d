//! The eye: a camera by eye point, target and up, with its projection.
//!
//! View rays of a perspective camera begin at the eye. Those of a parallel projection have one direction: they meet at
//! infinity, and the eye point only is where distances are measured from.

pub(super) mod placement;
mod projection;
mod spherical;
mod viewport;

use crate::math::angle;
use crate::math::depth::DepthCurve;
use crate::math::projection as matrices;
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
pub use projection::Projection;
use serde::{Deserialize, Serialize};
pub use spherical::Spherical;
use viewport::is_in_picture;

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
    /// Where the picture's centre is, to the right of the view's axis and above it, at distance 1.
    center: DVec2,
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
    /// A point on the view's axis, which is the centre of the picture but for an off-centre frustum; differs from `eye`.
    pub target: DVec3,
    /// Roughly up; not parallel to `target − eye`.
    pub up: DVec3,
    /// How it projects.
    #[serde(default, skip_serializing_if = "Projection::is_usual")]
    pub projection: Projection,
    /// Vertical field of view in degrees, in (0, 180); only for [`Projection::Perspective`].
    pub fov_y_degrees: f64,
    /// Distance of the near plane, > 0.
    pub near: f64,
    /// Distance of the far plane; only finite depth mappings use it.
    pub far: Option<f64>,
    /// The part of the picture that it draws into (glViewport), as shares of the picture's width and height: left, top,
    /// width, height. `None` for all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viewport: Option<[f64; 4]>,
}

/// What is changed of a scene's camera, as options and links say it; the rest stays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CameraChange {
    /// Position of the eye, world space.
    pub eye: Option<DVec3>,
    /// Position of the eye about the target, in place of `eye`.
    pub eye_spherical: Option<Spherical>,
    /// The point in the middle of the picture, world space.
    pub target: Option<DVec3>,
    /// What is up, world space.
    pub up: Option<DVec3>,
    /// The vertical field of view, degrees.
    pub fov_y_degrees: Option<f64>,
    /// The picture's edges on the near plane, metres: left, right, bottom, top of [`Projection::Frustum`].
    pub frustum: Option<[f64; 4]>,
    /// Distance of the near plane, metres.
    pub near: Option<f64>,
    /// Distance of the far plane, metres.
    pub far: Option<f64>,
    /// The part of the picture that is drawn into ([`Camera::viewport`]).
    pub viewport: Option<[f64; 4]>,
}

impl CameraChange {
    /// Returns what makes `before` see as `after` does; a far plane that was removed and another projection than
    /// [`Projection::Frustum`] are no part of it. A viewport that was removed is the whole picture's. The eye is given by its position.
    pub fn between(before: &Camera, after: &Camera) -> CameraChange {
        let changed = |after: DVec3, before: DVec3| (after != before).then_some(after);
        let number = |after: f64, before: f64| (after != before).then_some(after);
        CameraChange {
            eye: changed(after.eye, before.eye),
            eye_spherical: None,
            target: changed(after.target, before.target),
            up: changed(after.up, before.up),
            fov_y_degrees: number(after.fov_y_degrees, before.fov_y_degrees),
            frustum: after.projection.edges().filter(|_| after.projection != before.projection),
            near: number(after.near, before.near),
            far: after.far.filter(|_| after.far != before.far),
            viewport: (after.viewport != before.viewport).then(|| after.viewport.unwrap_or(Camera::WHOLE_PICTURE)),
        }
    }

    /// Changes a camera. An eye by spherical coordinates is about the target as it is then; where it is right above or
    /// below, and `up` is not given, the picture's up is the way in which the elevation grows.
    ///
    /// # Errors
    /// The camera can't be used then: the reason. It may be changed in part.
    pub fn apply_to(&self, camera: &mut Camera) -> Result<(), &'static str> {
        camera.eye = self.eye.unwrap_or(camera.eye);
        camera.target = self.target.unwrap_or(camera.target);
        camera.up = self.up.unwrap_or(camera.up);
        if let Some(place) = self.eye_spherical {
            if self.eye.is_some() {
                return Err("the eye is given twice, by its place and by r, θ and φ: leave one out");
            }
            place.check()?;
            camera.eye = place.eye_about(camera.target);
            if self.up.is_none() {
                camera.stand_up(place);
            }
        }
        if let Some([left, right, bottom, top]) = self.frustum {
            camera.projection = Projection::Frustum { left, right, bottom, top };
        }
        camera.fov_y_degrees = self.fov_y_degrees.unwrap_or(camera.fov_y_degrees);
        camera.near = self.near.unwrap_or(camera.near);
        camera.far = self.far.or(camera.far);
        if let Some(viewport) = self.viewport {
            camera.viewport = Some(viewport).filter(|viewport| *viewport != Camera::WHOLE_PICTURE);
        }
        camera.check()
    }
}

impl Camera {
    /// The viewport that is all of the picture, which a camera without one has.
    pub const WHOLE_PICTURE: [f64; 4] = [0.0, 0.0, 1.0, 1.0];

    /// Returns a perspective camera at `eye` that looks at `target` (world space, metres) with a vertical field of view
    /// of 45 degrees, its near plane 5 cm away and no far plane. Y is up, or −z within about 8 degrees of straight down
    /// or up. That the two points differ is not checked.
    pub fn looking(eye: impl Into<DVec3>, target: impl Into<DVec3>) -> Camera {
        let (eye, target) = (eye.into(), target.into());
        let ahead = (target - eye).normalize_or_zero();
        let up = if ahead.y.abs() > 0.99 { DVec3::NEG_Z } else { DVec3::Y };
        let projection = Projection::Perspective;
        Camera { eye, target, up, projection, fov_y_degrees: 45.0, near: 0.05, far: None, viewport: None }
    }

    /// Names what makes this camera unusable, in a few words for an error line.
    ///
    /// # Errors
    /// The first rule broken: numbers that single precision can work with, an eye apart from its
    /// target, an up that is not along the view, a field of view in (0, 180), 0 < near < far, a frustum's left edge
    /// before its right one and its lower before its upper one, a parallel projection's half height above 0, its angle a
    /// number and its factor from 0 to 100, a viewport within the picture.
    pub fn check(&self) -> Result<(), &'static str> {
        let vectors = [self.eye, self.target, self.up];
        let forward = self.target - self.eye;
        if !vectors.iter().all(|vector| vector.abs().max_element() <= 1e30) {
            Err("the camera's eye, target and up must be numbers up to 1e30")
        } else if forward.length() == 0.0 {
            Err("the camera's eye equals its target: move one of them")
        } else if self.up_is_along_view() {
            Err("the camera's up is zero or along the view: choose another up")
        } else if !(0.001..180.0).contains(&self.fov_y_degrees) {
            Err("the field of view must be between 0.001 and 180 degrees")
        } else if !(1e-30..=1e30).contains(&self.near) {
            Err("the near plane must be at a distance from 1e-30 to 1e30")
        } else if self.far.is_some_and(|far| !(far > self.near && far.is_finite())) {
            Err("the far plane must be farther than the near plane")
        } else if !self.viewport.is_none_or(is_in_picture) {
            Err(
                "a viewport's left, top, width and height are shares of the picture: from 0 to 1, wider and higher than 0, \
                 within it",
            )
        } else {
            self.projection.check()
        }
    }

    /// Gives a camera whose up is along its view another: right above and below its target, where `place` is, a camera that
    /// is not rolled has up where the elevation grows.
    pub(super) fn stand_up(&mut self, place: Spherical) {
        if self.up_is_along_view() {
            self.up = place.up();
        }
    }

    fn up_is_along_view(&self) -> bool {
        let forward = (self.target - self.eye).normalize_or_zero();
        forward.cross(self.up.normalize_or_zero()).length() < 1e-9
    }

    /// Returns whether view rays are parallel.
    pub fn is_parallel(&self) -> bool {
        !self.projection.is_pinhole()
    }

    /// Returns the rotation from view space to world space, for directions.
    pub fn world_from_view(&self) -> DMat3 {
        matrices::view_from_world_rotation(self.target - self.eye, self.up).transpose()
    }

    /// Returns where view rays begin, homogeneous, world space: the eye, or where they are parallel the direction
    /// towards it.
    pub fn eye_position(&self) -> DVec4 {
        self.relative_eye() + (self.eye * self.relative_eye().w).extend(0.0)
    }

    /// Returns where view rays begin, homogeneous, relative to the eye point.
    pub fn relative_eye(&self) -> DVec4 {
        match self.is_parallel() {
            false => DVec4::W,
            true => (self.world_from_view() * self.projection.shear().extend(1.0)).extend(0.0),
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

    /// Returns the view rays of a picture whose width is `aspect` times its height: of the viewport, where there is one.
    pub fn rays(&self, aspect: f64) -> CameraRays {
        CameraRays {
            world_from_view: self.world_from_view(),
            center: self.center(),
            half: self.half_size(aspect),
            shear: self.projection.shear(),
            in_place: (self.target - self.eye).length(),
            is_parallel: self.is_parallel(),
        }
    }

    /// Returns where the middle of the picture is, metres to the right of the view's axis and above it: at distance 1 of
    /// an off-centre frustum; zero for other projections.
    pub fn center(&self) -> DVec2 {
        match self.projection {
            Projection::Frustum { left, right, bottom, top } => {
                DVec2::new(left + right, bottom + top) / 2.0 / self.near
            }
            _ => DVec2::ZERO,
        }
    }

    /// Returns half of the width and of the height that a picture shows whose width is `aspect` times its height, metres:
    /// at distance 1 of a perspective camera, at any of a parallel projection. A frustum's do not depend on `aspect`.
    pub fn half_size(&self, aspect: f64) -> DVec2 {
        let half = self.half_height();
        match self.projection {
            Projection::Frustum { left, right, .. } => DVec2::new((right - left) / 2.0 / self.near, half),
            _ => DVec2::new(half * aspect, half),
        }
    }

    /// Returns half of the height that the picture shows, metres: at distance 1 of a perspective camera, at any of a
    /// parallel projection.
    pub fn half_height(&self) -> f64 {
        match self.projection {
            Projection::Perspective => angle::tan(self.fov_y_degrees.to_radians() / 2.0),
            Projection::Frustum { bottom, top, .. } => (top - bottom) / 2.0 / self.near,
            Projection::Orthographic { half_height } | Projection::Oblique { half_height, .. } => half_height,
        }
    }

    /// Returns half of the height that the picture shows at a distance along the view's axis, metres.
    pub fn half_height_at(&self, distance: f64) -> f64 {
        self.half_height() * if self.is_parallel() { 1.0 } else { distance }
    }

    /// Returns the width of a pixel of a picture of `size` pixels at a distance along the view's axis, metres; its height
    /// where that is more, as in a stretched picture.
    pub fn pixel_width_at(&self, distance: f64, size: [u32; 2]) -> f64 {
        let [_, _, width, height] = self.viewport_in(size);
        let down = 2.0 * self.half_height_at(distance) / f64::from(height);
        match self.projection {
            Projection::Frustum { left, right, .. } => {
                down.max((right - left) / self.near * distance / f64::from(width))
            }
            _ => down,
        }
    }

    /// Returns half of the height that the picture shows at the target's distance, metres.
    pub fn half_height_at_target(&self) -> f64 {
        self.half_height_at((self.target - self.eye).length())
    }

    /// Returns clip space from view space. Depth of a parallel projection is linear in the distance, from `near` to
    /// `far`.
    pub fn clip_from_view(&self, aspect: f64, depth: &DepthCurve) -> DMat4 {
        match self.projection {
            Projection::Perspective => matrices::perspective(self.fov_y_degrees, aspect, depth),
            Projection::Frustum { left, right, bottom, top } => {
                matrices::off_center([left, right, bottom, top], self.near, depth)
            }
            parallel => {
                let (half, shear) = (self.half_height(), parallel.shear());
                let in_place = (self.target - self.eye).length();
                matrices::parallel([half * aspect, half], shear, in_place, depth)
            }
        }
    }

    /// Returns the frustum that shows what this camera does in a picture whose width is `aspect` times its height; of a
    /// parallel one, what it shows at the target's distance.
    pub fn to_frustum(&self, aspect: f64) -> Projection {
        let by = if self.is_parallel() { 1.0 / (self.target - self.eye).length() } else { 1.0 } * self.near;
        let (half, center) = (self.half_size(aspect) * by, self.center() * by);
        let ([left, bottom], [right, top]) = ((center - half).to_array(), (center + half).to_array());
        Projection::Frustum { left, right, bottom, top }
    }

    /// Returns the camera with its near plane elsewhere and the same picture: a frustum's edges move with the plane.
    #[must_use]
    pub fn with_near(&self, near: f64) -> Camera {
        let by = near / self.near;
        let projection = match self.projection {
            Projection::Frustum { left, right, bottom, top } => {
                Projection::Frustum { left: left * by, right: right * by, bottom: bottom * by, top: top * by }
            }
            other => other,
        };
        Camera { near, projection, ..*self }
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
        Camera { eye, target, ..self.with_near(self.near * 10_f64.powf(2.0 * unit() - 1.0)) }
    }
}

impl CameraRays {
    /// Returns half of the width and of the height of what they show ([`Camera::half_size`]).
    pub fn half_size(&self) -> DVec2 {
        self.half
    }

    /// Returns the ray, relative to the eye, through a point of the picture, given by x and y from −1 to 1, right and
    /// up. Along it, distance 1 is one metre of depth along the view axis.
    #[inline]
    pub fn through(&self, at: DVec2) -> Ray {
        let place = self.center + at * self.half;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::depth::DepthMapping;

    const OFF_CENTER: Projection = Projection::Frustum { left: -0.1, right: 0.5, bottom: 0.05, top: 0.45 };

    fn cameras() -> [Camera; 5] {
        let camera = Camera::looking([3.0, 2.0, 5.0], [0.5, -0.3, 0.2]);
        let oblique = |angle_degrees, factor| Projection::Oblique { half_height: 1.7, angle_degrees, factor };
        [
            Projection::Perspective,
            OFF_CENTER,
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
        for camera in cameras().into_iter().filter(|camera| camera.projection != OFF_CENTER) {
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
        let frustum = |[left, right, bottom, top]: [f64; 4]| Projection::Frustum { left, right, bottom, top };
        for projection in [
            frustum([1.0, 1.0, -1.0, 1.0]),
            frustum([-1.0, 1.0, 1.0, -1.0]),
            frustum([-1.0, f64::NAN, -1.0, 1.0]),
            frustum([-1.0, f64::INFINITY, -1.0, 1.0]),
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

    /// A viewport's own corners are at the edges of its pixels in the picture, and the picture's rays go where its matrix does.
    #[test]
    fn a_viewport_is_a_part_of_a_picture_whose_projection_goes_on_beside_it() {
        let size = [101, 67];
        for camera in cameras() {
            let whole = Camera { viewport: None, ..camera };
            assert_eq!(whole.viewport_in(size), [0, 0, 101, 67]);
            assert_eq!(whole.picture_rays(size), whole.rays(101.0 / 67.0));
            let camera = Camera { viewport: Some([0.213, 0.118, 0.55, 0.703]), ..camera };
            let curve = curve(&camera);
            let [left, top, columns, rows] = camera.viewport_in(size).map(f64::from);
            assert_eq!([left, top, columns, rows], [22.0, 8.0, 55.0, 47.0]);
            let to_view = camera.world_from_view().transpose();
            for (at, pixel) in [
                (DVec2::new(-1.0, 1.0), [left, top]),
                (DVec2::new(1.0, -1.0), [left + columns, top + rows]),
                (DVec2::ZERO, [left + columns / 2.0, top + rows / 2.0]),
            ] {
                let own = camera.rays(camera.aspect_in(size)).through(at).at(3.0);
                let clip = camera.picture_from_view(size, &curve) * (to_view * own).extend(1.0);
                let place = DVec2::new(clip.x, clip.y) / clip.w;
                let found = (place * DVec2::new(0.5, -0.5) + 0.5) * DVec2::new(101.0, 67.0);
                assert!((found - DVec2::from_array(pixel)).length() < 1e-9, "{camera:?}: {found} for {pixel:?}");
                let seen = camera.picture_rays(size).through(place).at(3.0);
                assert!((seen - own).length() < 1e-9, "{camera:?}: {seen} for {own}");
            }
        }
        let camera = cameras()[0];
        let at = |viewport| Camera { viewport: Some(viewport), ..camera };
        assert_eq!(at([0.999, 0.0, 0.001, 1.0]).viewport_in([10, 10]), [9, 0, 1, 10], "one pixel at least");
        for problem in [[0.0, 0.0, 0.0, 1.0], [0.5, 0.0, 0.6, 1.0], [-0.1, 0.0, 0.5, 1.0], [0.0, f64::NAN, 1.0, 1.0]] {
            assert!(at(problem).check().is_err(), "{problem:?}");
        }
    }

    /// A frustum's view rays meet the near plane within its edges, wherever that plane is moved with its picture.
    #[test]
    fn a_frustum_sees_its_rectangle_and_keeps_it_as_the_near_plane_moves() {
        let [_, camera, ..] = cameras();
        let [left, right, bottom, top] = camera.projection.edges().expect("edges");
        let to_view = camera.world_from_view().transpose();
        for (at, wanted) in [(DVec2::new(-1.0, -1.0), [left, bottom]), (DVec2::ONE, [right, top])] {
            for moved in [camera, camera.with_near(camera.near * 3.0)] {
                let seen = to_view * moved.rays(7.0).through(at).at(camera.near);
                assert!((seen.truncate() - DVec2::from_array(wanted)).length() < 1e-15, "{seen}");
            }
        }
        let wide = camera.pixel_width_at(2.0, [60, 60]);
        assert!(
            (wide - (right - left) / camera.near * 2.0 / 60.0).abs() < 1e-12,
            "a stretched pixel is as wide as it is"
        );
    }
}
