//! The ray through a pixel of the picture, and the surface that it hits.

use crate::capture::Capture;
use crate::scene::Ray;
use glam::{DVec2, DVec3};

/// Returns the view ray through the centre of a pixel (column, row; row 0 is the top), relative to the eye: add the
/// eye's position for world space. Its direction is no unit vector: the part along the view's axis is 1.
pub fn ray(capture: &Capture, at: [u32; 2]) -> Ray {
    ray_at(capture, at.map(|texel| f64::from(texel) + 0.5))
}

/// Returns the view ray through a position in pixels, relative to the eye.
pub fn ray_at(capture: &Capture, at: [f64; 2]) -> Ray {
    let [width, height] = capture.size.map(f64::from);
    let place = DVec2::new(at[0] / width * 2.0 - 1.0, 1.0 - at[1] / height * 2.0);
    capture.camera.picture_rays(capture.size).through(place)
}

/// Returns the world position of the surface at a pixel's centre at the end of the frame; `None` where there is none.
pub fn surface(capture: &Capture, at: [u32; 2]) -> Option<DVec3> {
    let frame = capture.frame_at(capture.steps.len().checked_sub(1)?)?;
    let distance = capture.depth.distance(frame.depth.image.depth_at(at)?)?;
    Some(capture.camera.eye + ray(capture, at).at(distance))
}

/// Converts a homogeneous world-space point to view space, whose camera looks along −z.
fn in_view(capture: &Capture, world: glam::DVec4) -> DVec3 {
    let camera = &capture.camera;
    camera.world_from_view().transpose() * (world.truncate() - camera.eye * world.w)
}

/// Returns the unit direction in the picture (right, down) from its middle towards a homogeneous world-space point that
/// is outside it or behind the camera; downwards for a point right ahead or behind.
pub fn way_to(capture: &Capture, world: glam::DVec4) -> [f64; 2] {
    let view = in_view(capture, world);
    // For a point right behind the eye any direction is as good.
    let way = DVec2::new(view.x, -view.y).try_normalize().unwrap_or(DVec2::Y);
    way.to_array()
}

/// Returns where a homogeneous world-space point is in the picture, in pixels from the upper left, also outside of it;
/// `None` where it is not in front of the eye.
pub fn texel_of(capture: &Capture, world: glam::DVec4) -> Option<[f64; 2]> {
    let camera = &capture.camera;
    let [width, height] = capture.size.map(f64::from);
    let view = in_view(capture, world);
    // How depth is stored does not matter here.
    let clip = camera.picture_from_view(capture.size, &capture.depth) * view.extend(1.0);
    let at = DVec2::new(clip.x, clip.y) / clip.w;
    (view.z < -1e-9).then(|| [(at.x + 1.0) / 2.0 * width, (1.0 - at.y) / 2.0 * height])
}
