//! From a pixel and its stored depth back to the surface: its point, and its plane as far as depths show it.

use super::{Capture, Image};
use crate::math::depth::DepthCurve;
use crate::scene::{CameraRays, Ray};
use glam::{DVec2, DVec3, DVec4};

/// Converts a pixel and its stored depth to a world position.
#[derive(Debug)]
pub struct PixelUnprojection {
    depth: DepthCurve,
    rays: CameraRays,
    /// The eye's world position, metres.
    pub eye: DVec3,
    /// Where all view rays meet: homogeneous, world space.
    meeting: DVec4,
    size: [f64; 2],
}

impl PixelUnprojection {
    /// Returns the unprojection of a capture's camera.
    pub fn new(capture: &Capture) -> PixelUnprojection {
        let camera = &capture.camera;
        PixelUnprojection {
            depth: capture.depth,
            rays: camera.picture_rays(capture.size),
            eye: camera.eye,
            meeting: camera.eye_position(),
            size: capture.size.map(f64::from),
        }
    }

    /// Returns the world position of a surface with this stored depth at the centre of a pixel (column, row); `None`
    /// where the depth is at infinity or nothing was drawn.
    pub fn at(&self, [x, y]: [u32; 2], depth: f32) -> Option<DVec3> {
        let distance = self.depth.distance(depth).filter(|distance| distance.is_finite())?;
        Some(self.eye + self.ray([f64::from(x) + 0.5, f64::from(y) + 0.5]).at(distance))
    }

    /// Returns the view ray, relative to the eye, through a position in pixels from the upper left.
    pub fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        let [width, height] = self.size;
        self.rays.through(DVec2::new(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height))
    }

    /// Returns a unit normal (world space) of the surface at `world`, which a pixel shows, guessed from stored depths: of the
    /// plane through the pixel's point and the horizontal and vertical neighbours that lie on it, as far as depths show
    /// that. Points towards the eye where there are none.
    pub fn guessed_normal(&self, depth: &Image, [x, y]: [u32; 2], world: DVec3) -> DVec3 {
        let depth_at = |step: i64, axis: usize| {
            let place = |along: usize, at: u32| if along == axis { i64::from(at) + step } else { i64::from(at) };
            depth.depth_at([u32::try_from(place(0, x)).ok()?, u32::try_from(place(1, y)).ok()?])
        };
        let own = depth.depth_at([x, y]);
        // In the picture depth is linear on a plane: of both neighbours the one is on this plane from which the next but one
        // goes on straight.
        let bend = |side: i64, axis: usize| {
            let depths = [own, depth_at(side, axis), depth_at(2 * side, axis)].map(|depth| depth.map(f64::from));
            let [own, next, last] = depths;
            Some((own? - 2.0 * next? + last?).abs())
        };
        let along = |axis: usize| {
            let point = |side: i64| {
                let at = if axis == 0 {
                    [x.checked_add_signed(side as i32)?, y]
                } else {
                    [x, y.checked_add_signed(side as i32)?]
                };
                Some((side, self.at(at, depth_at(side, axis)?)?))
            };
            let sides = [point(-1), point(1)].into_iter().flatten();
            let straightest = sides.min_by(|(a, one), (b, other)| {
                let bends = [bend(*a, axis), bend(*b, axis)].map(|bend| bend.unwrap_or(f64::INFINITY));
                bends[0].total_cmp(&bends[1]).then(world.distance(*one).total_cmp(&world.distance(*other)))
            });
            straightest.map(|(side, point)| (point - world) * side as f64)
        };
        let (across, down) = (along(0), along(1));
        let meeting = self.meeting;
        let to_eye = (meeting.truncate() - world * meeting.w).normalize_or(DVec3::Y);
        let normal = across.zip(down).and_then(|(across, down)| across.cross(down).try_normalize());
        normal.map_or(to_eye, |normal| if normal.dot(to_eye) < 0.0 { -normal } else { normal })
    }
}
