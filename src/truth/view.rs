//! The camera's rays.

use crate::math::projection::view_from_world_rotation;
use crate::scene::Camera;
use glam::{DMat3, DVec3};

/// The rays through a picture's points.
#[derive(Debug, Clone, Copy)]
pub struct View {
    pub near: f64,
    /// Where rays end: infinite, but where a far plane is part of what is asked.
    pub far: f64,
    world_from_view: DMat3,
    size: [f64; 2],
    /// Half the picture's width and height at distance 1.
    half: [f64; 2],
}

impl View {
    pub fn new(camera: &Camera, size: [u32; 2]) -> View {
        let size = size.map(f64::from);
        let half_height = (camera.fov_y_degrees.to_radians() / 2.0).tan();
        View {
            near: camera.near,
            far: f64::INFINITY,
            world_from_view: view_from_world_rotation(camera.target - camera.eye, camera.up).transpose(),
            size,
            half: [half_height * size[0] / size[1], half_height],
        }
    }

    /// World direction from the eye through a point of the picture, 1 long along the view's axis.
    /// The picture's first pixel has its centre at (0.5, 0.5).
    pub fn direction(&self, [x, y]: [f64; 2]) -> DVec3 {
        let across = (x / self.size[0] * 2.0 - 1.0) * self.half[0];
        let up = (1.0 - y / self.size[1] * 2.0) * self.half[1];
        self.world_from_view * DVec3::new(across, up, -1.0)
    }

    /// World direction of the view's axis.
    pub fn axis(&self) -> DVec3 {
        -self.world_from_view.z_axis
    }
}
