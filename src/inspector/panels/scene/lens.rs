//! From world space to a view's screen: perspective, orthographic, and oblique projections.
//!
//! View space has x to the right, y up and z towards the viewer; its origin is the point in the middle of the view. The
//! oblique projections (cavalier, cabinet) draw depth at an angle, at full or half length, so that a front has its true
//! shape.

use crate::viewport::ViewportCamera;
use egui::{Pos2, Rect, Vec2, pos2};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// Distance of a perspective view's near plane, as a share of the distance to the middle.
const NEAR: f64 = 0.02;
/// How much nearer shells are drawn than the surfaces that they lie on: as a share of their distance, or of the view's
/// height.
const STEP: f64 = 3e-4;
/// A view straight down has this pitch, degrees, so that up stays up.
const MOST_PITCH: f64 = 89.9;

named_enum! {
    /// The projection of a view of the scene in space.
    pub enum LensProjection(
        /// What it does.
        meaning
    ) {
        /// Farther is smaller.
        Perspective = "perspective" ("Farther is smaller, as seen by an eye"),
        /// Depth is not seen.
        Orthographic = "orthographic" ("Lengths stay, depth is not seen"),
        /// Oblique, depth at full length.
        Cavalier = "cavalier" ("Oblique: the front keeps its shape, depth goes off at an angle at full length"),
        /// Oblique, depth at half length.
        Cabinet = "cabinet" ("Oblique: the front keeps its shape, depth goes off at an angle at half length"),
    }
}

impl LensProjection {
    /// Returns whether the projection is oblique: depth is drawn at an angle.
    pub fn is_oblique(self) -> bool {
        matches!(self, LensProjection::Cavalier | LensProjection::Cabinet)
    }
}

/// The point that a view of the scene looks at, its direction, size and projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaneView {
    /// The point in the middle, world space.
    pub center: DVec3,
    /// Metres across the shorter side of the view, at the middle's distance.
    pub height: f64,
    /// Rotation about the upright axis, degrees; 0 looks along −z.
    pub yaw: f64,
    /// Angle by which it looks down, degrees.
    pub pitch: f64,
    /// Field of view across the shorter side, degrees, in perspective.
    pub fov_y: f64,
    /// The projection.
    pub projection: LensProjection,
    /// Angle of the depth axis in an oblique projection, degrees.
    pub oblique: f64,
}

impl PaneView {
    /// Rotates the view by angles in degrees; yaw wraps around at 360, and pitch stops just before straight up and
    /// down.
    pub fn orbit(&mut self, yaw: f64, pitch: f64) {
        self.yaw = (self.yaw + yaw).rem_euclid(360.0);
        self.pitch = (self.pitch + pitch).clamp(-MOST_PITCH, MOST_PITCH);
    }

    /// Shows `factor` times as much (a factor above 1 zooms out); ignored where the view's height would leave 1e-6 to
    /// 1e9 metres.
    pub fn zoom(&mut self, factor: f64) {
        let height = self.height * factor;
        if (1e-6..1e9).contains(&height) {
            self.height = height;
        }
    }

    /// Returns the rotation from world to view space, in which the view looks along −z; pitch is limited to ±90
    /// degrees.
    pub fn rotation(&self) -> DMat3 {
        let pitch = self.pitch.clamp(-90.0, 90.0).to_radians();
        DMat3::from_rotation_x(pitch) * DMat3::from_rotation_y(-self.yaw.to_radians())
    }

    /// Returns the distance from a perspective view's eye to the middle, metres.
    pub fn distance(&self) -> f64 {
        self.height / 2.0 / (self.fov_y.to_radians() / 2.0).tan()
    }

    /// Returns this view as seen in a rectangle of the screen, whose shorter side shows [`PaneView::height`] metres; a
    /// rectangle without area counts as one point wide and high.
    pub fn lens(&self, rect: Rect) -> Lens {
        let length = match self.projection {
            LensProjection::Cavalier => 1.0,
            LensProjection::Cabinet => 0.5,
            LensProjection::Perspective | LensProjection::Orthographic => 0.0,
        };
        let (sine, cosine) = self.oblique.to_radians().sin_cos();
        Lens {
            rotation: self.rotation(),
            center: self.center,
            middle: rect.center(),
            size: DVec2::new(f64::from(rect.width().max(1.0)), f64::from(rect.height().max(1.0))),
            // A view for which a small window leaves no space still has a scale, so that dragging stays finite.
            scale: f64::from(rect.size().min_elem().max(1.0)) / self.height,
            shear: DVec2::new(cosine, sine) * length,
            eye: (self.projection == LensProjection::Perspective).then(|| self.distance()),
        }
    }
}

/// A view of the scene in a rectangle of the screen: maps world space to points and back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Rotation from world to view space.
    pub rotation: DMat3,
    /// The point in the middle, world space.
    pub center: DVec3,
    /// Position of that point on the screen.
    pub middle: Pos2,
    /// Width and height, points.
    pub size: DVec2,
    /// Points for each metre, at the middle's distance.
    pub scale: f64,
    /// How far right and up a metre of depth is drawn.
    pub shear: DVec2,
    /// Distance from the eye to the middle; `None` in parallel projections.
    pub eye: Option<f64>,
}

impl Lens {
    /// Returns the view-space position of a world-space point.
    pub fn view(&self, world: DVec3) -> DVec3 {
        self.rotation * (world - self.center)
    }

    /// Returns the eye, world space; in parallel projections the direction towards the viewer, with `w = 0`.
    pub fn viewer(&self) -> DVec4 {
        let world = self.rotation.transpose();
        match self.eye {
            Some(eye) => (self.center + world * DVec3::Z * eye).extend(1.0),
            None => (world * self.shear.extend(1.0)).extend(0.0),
        }
    }

    /// Returns the camera for the GPU: clip space, with reversed depth, of points relative to `origin`, all within
    /// `reach` of it.
    pub fn on_gpu(&self, origin: DVec3, reach: f64) -> ViewportCamera {
        let view = DMat4::from_mat3(self.rotation) * DMat4::from_translation(origin - self.center);
        let [x, y] = (2.0 * self.scale / self.size).to_array();
        // Depth is linear in parallel projections, and its range covers all there is.
        let range = (reach + (origin - self.center).length()).max(1e-9);
        let (clip, step) = match self.eye {
            Some(eye) => {
                let (across, ahead) = (DVec4::new(x * eye, 0.0, 0.0, 0.0), DVec4::new(0.0, 0.0, 0.0, -1.0));
                let up = DVec4::new(0.0, y * eye, 0.0, 0.0);
                (DMat4::from_cols(across, up, ahead, DVec4::new(0.0, 0.0, eye * NEAR, eye)), [STEP, 0.0])
            }
            None => {
                let depth = DVec4::new(-self.shear.x * x, -self.shear.y * y, 0.5 / range, 0.0);
                let step = STEP * self.size.y / self.scale * 0.5 / range;
                (DMat4::from_cols(DVec4::X * x, DVec4::Y * y, depth, DVec4::new(0.0, 0.0, 0.5, 1.0)), [0.0, step])
            }
        };
        let viewer = self.viewer();
        ViewportCamera {
            clip_from_stage: (clip * view).as_mat4(),
            viewer: (viewer - (origin * viewer.w).extend(0.0)).as_vec4(),
            step: DVec2::from(step).as_vec2(),
            ..bytemuck::Zeroable::zeroed()
        }
    }

    /// Returns the largest z of view space that is drawn.
    pub fn near(&self) -> f64 {
        self.eye.map_or(f64::INFINITY, |eye| eye * (1.0 - NEAR))
    }

    /// Returns where a point of view space is on the screen, in points; it must not be nearer than [`Lens::near`].
    pub fn project(&self, view: DVec3) -> Pos2 {
        let at = match self.eye {
            Some(eye) => view.truncate() * (eye / (eye - view.z)),
            None => view.truncate() - self.shear * view.z,
        };
        pos2(self.middle.x + (at.x * self.scale) as f32, self.middle.y - (at.y * self.scale) as f32)
    }

    /// Returns where a point of world space is on the screen; `None` behind the eye.
    pub fn place(&self, world: DVec3) -> Option<Pos2> {
        let view = self.view(world);
        (view.z <= self.near()).then(|| self.project(view))
    }

    /// Returns where a point of world space is on the screen; for one behind the eye, a position far out on its side of
    /// the view.
    pub fn towards(&self, world: DVec3) -> Pos2 {
        self.place(world).unwrap_or_else(|| {
            let view = self.view(world);
            let way = DVec2::new(view.x, -view.y).try_normalize().unwrap_or(DVec2::Y) * self.size.length();
            self.middle + Vec2::new(way.x as f32, way.y as f32)
        })
    }

    /// Returns both ends of a line in world space on the screen, clipped where it goes behind the eye; `None` where all
    /// of it is behind. It may leave the rectangle.
    pub fn line(&self, ends: [DVec3; 2]) -> Option<[Pos2; 2]> {
        let [a, b] = ends.map(|end| self.view(end));
        let near = self.near();
        let cut = |from: DVec3, to: DVec3| from.lerp(to, (near - from.z) / (to.z - from.z));
        let [a, b] = match [a.z <= near, b.z <= near] {
            [true, true] => [a, b],
            [true, false] => [a, cut(a, b)],
            [false, true] => [cut(b, a), b],
            [false, false] => return None,
        };
        Some([self.project(a), self.project(b)])
    }

    /// Returns the move in the plane parallel to the view that moves a point `at` by so much on the screen.
    pub fn moved(&self, at: DVec3, by: Vec2) -> DVec3 {
        let away = self.eye.map_or(1.0, |eye| ((eye - self.view(at).z) / eye).max(NEAR));
        let view = DVec3::new(f64::from(by.x), -f64::from(by.y), 0.0) / self.scale * away;
        self.rotation.transpose() * view
    }

    /// Returns the move in world space along `axis`, of unit length, that moves the point `at` by about `by` points on
    /// the screen; zero where the axis is seen from its end, or begins or ends behind the eye.
    pub fn moved_along(&self, at: DVec3, axis: DVec3, by: Vec2) -> DVec3 {
        let step = 8.0 / self.scale;
        let Some([from, to]) = self.line([at, at + axis * step]) else { return DVec3::ZERO };
        let on_screen = to - from;
        if on_screen.length_sq() < 0.25 {
            return DVec3::ZERO;
        }
        axis * (step * f64::from(by.dot(on_screen) / on_screen.length_sq()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    const RECT: Rect = Rect { min: pos2(100.0, 50.0), max: pos2(500.0, 250.0) };

    fn pane(projection: LensProjection) -> PaneView {
        let center = DVec3::new(1.0, 2.0, 3.0);
        PaneView { center, height: 10.0, yaw: 0.0, pitch: 0.0, fov_y: 40.0, projection, oblique: 30.0 }
    }

    fn is_near(found: Pos2, expected: [f32; 2]) {
        assert!((found - pos2(expected[0], expected[1])).length() < 1e-3, "{found:?}, not {expected:?}");
    }

    #[test]
    fn the_middle_plane_is_drawn_to_scale_in_every_projection() {
        for projection in LensProjection::ALL {
            let lens = pane(projection).lens(RECT);
            is_near(lens.place(DVec3::new(1.0, 2.0, 3.0)).expect("seen"), [300.0, 150.0]);
            is_near(lens.place(DVec3::new(2.0, 3.0, 3.0)).expect("seen"), [320.0, 130.0]);
        }
    }

    #[test]
    fn depth_is_smaller_unseen_or_at_an_angle() {
        let behind = DVec3::new(2.0, 2.0, 1.0);
        let place = |projection| pane(projection).lens(RECT).place(behind).expect("seen");
        is_near(place(LensProjection::Orthographic), [320.0, 150.0]);
        let (sine, cosine) = 30.0_f32.to_radians().sin_cos();
        is_near(place(LensProjection::Cavalier), [320.0 + 40.0 * cosine, 150.0 - 40.0 * sine]);
        is_near(place(LensProjection::Cabinet), [320.0 + 20.0 * cosine, 150.0 - 20.0 * sine]);
        let eye = pane(LensProjection::Perspective).distance() as f32;
        is_near(place(LensProjection::Perspective), [300.0 + 20.0 * eye / (eye + 2.0), 150.0]);
    }

    #[test]
    fn from_the_top_x_is_right_and_z_is_down_and_from_the_right_z_is_left() {
        let top = PaneView { pitch: 90.0, ..pane(LensProjection::Orthographic) }.lens(RECT);
        is_near(top.place(DVec3::new(2.0, 7.0, 4.0)).expect("seen"), [320.0, 170.0]);
        let right = PaneView { yaw: 90.0, ..pane(LensProjection::Orthographic) }.lens(RECT);
        is_near(right.place(DVec3::new(9.0, 3.0, 4.0)).expect("seen"), [280.0, 130.0]);
    }

    #[test]
    fn a_move_on_the_screen_is_a_move_in_the_world_at_any_depth() {
        for projection in LensProjection::ALL {
            let lens = PaneView { yaw: 33.0, pitch: 21.0, ..pane(projection) }.lens(RECT);
            let at = DVec3::new(2.0, 1.0, 0.5);
            let by = vec2(17.0, -9.0);
            let from = lens.place(at).expect("seen");
            is_near(lens.place(at + lens.moved(at, by)).expect("seen"), (from + by).into());
            let along = lens.moved_along(at, DVec3::X, by);
            assert_eq!([along.y, along.z], [0.0; 2]);
            assert!(along.x > 0.0, "{projection:?}");
        }
    }

    #[test]
    fn points_towards_the_viewer_are_at_the_same_place_of_the_screen() {
        for projection in LensProjection::ALL {
            let lens = PaneView { yaw: 33.0, pitch: 21.0, ..pane(projection) }.lens(RECT);
            let at = DVec3::new(2.0, 1.0, 0.5);
            let viewer = lens.viewer();
            let towards = (viewer.truncate() - at * viewer.w).normalize();
            let [here, there] = [at, at + towards].map(|at| lens.place(at).expect("seen"));
            assert!((here - there).length() < 1e-3, "{projection:?}");
        }
    }

    #[test]
    fn the_gpu_puts_a_place_where_the_lens_does_and_what_is_nearer_before_what_is_not() {
        for projection in LensProjection::ALL {
            let lens = PaneView { yaw: 33.0, pitch: 21.0, ..pane(projection) }.lens(RECT);
            let origin = DVec3::new(0.5, 0.25, -0.75);
            let clip = lens.on_gpu(origin, 9.0).clip_from_stage.as_dmat4();
            let towards = lens.rotation.transpose() * DVec3::Z;
            let mut depths = Vec::new();
            for at in [DVec3::new(1.5, 1.0, 2.0), DVec3::new(1.5, 1.0, 2.0) + towards * 3.0, lens.center] {
                let at_clip = clip * (at - origin).extend(1.0);
                let on_screen = at_clip.truncate() / at_clip.w;
                let found = RECT.center() + vec2(on_screen.x as f32, -on_screen.y as f32) * RECT.size() / 2.0;
                assert!((found - lens.place(at).expect("seen")).length() < 1e-2, "{projection:?}");
                depths.push(on_screen.z);
            }
            assert!(depths[0] < depths[1] && depths.iter().all(|depth| (0.0..1.0).contains(depth)), "{depths:?}");
        }
    }

    #[test]
    fn a_line_is_cut_where_it_goes_behind_the_eye() {
        let lens = pane(LensProjection::Perspective).lens(RECT);
        let behind = DVec3::new(1.0, 3.0, 40.0);
        assert_eq!(lens.place(behind), None);
        assert_eq!(lens.line([behind, behind]), None);
        let cut = lens.line([DVec3::new(1.0, 2.0, 3.0), behind]).expect("a part is seen");
        assert!(cut.iter().all(|at| at.is_finite()));
    }
}
