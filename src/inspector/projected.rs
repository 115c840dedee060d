//! World positions in the picture: clipped before they are projected, as in [`super::outline`].

use super::outline;
use crate::capture::Capture;
use crate::math::projection;
use glam::{DMat4, DVec2, DVec4};

/// How far outside the picture's edges lines are cut, where the picture ends at 1.
const GUARD: f64 = 1.2;

/// From the world to the texels of a capture's picture.
#[derive(Debug, Clone)]
pub struct Projector {
    clip_from_world: DMat4,
    planes: [DVec4; 5],
    half: DVec2,
}

impl Projector {
    /// Of the camera of a capture.
    #[must_use]
    pub fn new(capture: &Capture) -> Projector {
        let [width, height] = capture.size.map(f64::from);
        let camera = &capture.camera;
        let clip_from_view = projection::perspective(camera.fov_y_degrees, width / height, &capture.depth);
        let rotation = projection::view_from_world_rotation(camera.target - camera.eye, camera.up);
        let clip_from_world = clip_from_view * DMat4::from_mat3(rotation) * DMat4::from_translation(-camera.eye);
        let [x, y] = [DVec4::X, DVec4::Y];
        let sides = [x, -x, y, -y].map(|side| side + DVec4::W * GUARD);
        let near = outline::near_plane(capture);
        Projector {
            clip_from_world,
            planes: [near, sides[0], sides[1], sides[2], sides[3]],
            half: DVec2::new(width, height) / 2.0,
        }
    }

    /// What is seen of a segment between homogeneous positions, in texels.
    #[must_use]
    pub fn segment(&self, ends: [DVec4; 2]) -> Option<[DVec2; 2]> {
        let [mut from, mut to] = ends.map(|end| self.clip_from_world * end);
        for plane in self.planes {
            let [a, b] = [plane.dot(from), plane.dot(to)];
            if a < 0.0 && b < 0.0 {
                return None;
            }
            if a < 0.0 {
                from = from.lerp(to, a / (a - b));
            } else if b < 0.0 {
                to = from.lerp(to, a / (a - b));
            }
        }
        let is_before = from.w > 0.0 && to.w > 0.0;
        is_before.then(|| [from, to].map(|end| self.place(end)))
    }

    /// What is seen of a triangle: a convex polygon in texels, with 1 over the distance along the view
    /// at each corner. Empty where nothing is.
    #[must_use]
    pub fn polygon(&self, corners: [DVec4; 3]) -> Vec<(DVec2, f64)> {
        let corners = corners.map(|corner| self.clip_from_world * corner);
        let is_beyond = |plane: &DVec4, corner: &DVec4| plane.dot(*corner) < 0.0;
        // Most triangles are seen whole or not at all.
        if self.planes.iter().any(|plane| corners.iter().all(|corner| is_beyond(plane, corner))) {
            return Vec::new();
        }
        let crossed = self.planes.into_iter().filter(|plane| corners.iter().any(|corner| is_beyond(plane, corner)));
        let clipped = crossed.fold(corners.to_vec(), |polygon, plane| outline::clip(&polygon, plane));
        clipped.into_iter().filter(|corner| corner.w > 0.0).map(|corner| (self.place(corner), 1.0 / corner.w)).collect()
    }

    fn place(&self, clip: DVec4) -> DVec2 {
        DVec2::new(clip.x / clip.w + 1.0, 1.0 - clip.y / clip.w) * self.half
    }
}
