//! The camera's rays.

use crate::scene::{Camera, CameraRays, Ray};
use glam::{DVec2, DVec3};

/// The view rays of a camera through points of its picture.
#[derive(Debug, Clone, Copy)]
pub struct PictureRays {
    pub near: f64,
    /// Distance at which rays end: infinite, unless a far plane is part of the question.
    pub far: f64,
    /// The world position that rays are relative to.
    pub eye: DVec3,
    pub is_parallel: bool,
    rays: CameraRays,
    /// What is drawn of the picture, in pixels: left, top, columns, rows.
    viewport: [f64; 4],
    size: [f64; 2],
}

impl PictureRays {
    /// Returns the view rays of a camera through a picture of `size` pixels; they begin at the near plane and have no
    /// end, even if the camera has a far plane.
    pub fn new(camera: &Camera, size: [u32; 2]) -> PictureRays {
        PictureRays {
            rays: camera.picture_rays(size),
            viewport: camera.viewport_in(size).map(f64::from),
            near: camera.near,
            far: f64::INFINITY,
            eye: camera.eye,
            is_parallel: camera.is_parallel(),
            size: size.map(f64::from),
        }
    }

    /// Returns whether a point of the picture, in pixels, is drawn: whether it is in the camera's viewport.
    pub fn is_drawn(&self, [x, y]: [f64; 2]) -> bool {
        let [left, top, columns, rows] = self.viewport;
        (left..left + columns).contains(&x) && (top..top + rows).contains(&y)
    }

    /// Returns the view ray through a point of the picture in pixels; the first pixel has its centre at (0.5, 0.5).
    pub fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        self.ray_through([self.across(x), self.down(y)])
    }

    /// Converts a point's x from pixels, 0 at the picture's left edge, to normalized device coordinates: −1 at the left
    /// edge, 1 at the right.
    pub fn across(&self, x: f64) -> f64 {
        x / self.size[0] * 2.0 - 1.0
    }

    /// Converts a point's y from pixels, 0 at the picture's upper edge, to normalized device coordinates: 1 at the
    /// upper edge, −1 at the lower.
    pub fn down(&self, y: f64) -> f64 {
        1.0 - y / self.size[1] * 2.0
    }

    /// Returns the view ray through a point in normalized device coordinates ([`PictureRays::across`],
    /// [`PictureRays::down`]).
    pub fn ray_through(&self, [x, y]: [f64; 2]) -> Ray {
        self.rays.through(DVec2::new(x, y))
    }

    /// Returns the world direction of the view's axis.
    pub fn axis(&self) -> DVec3 {
        self.rays.axis()
    }
}
