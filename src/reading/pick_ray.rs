//! The ray through a pixel of the picture, and the surface that it meets.

use crate::capture::Capture;
use crate::math::projection;
use glam::DVec3;

/// From the eye through the middle of a pixel, world space; its part along the view is 1.
#[must_use]
pub fn ray(capture: &Capture, at: [u32; 2]) -> DVec3 {
    ray_at(capture, at.map(|texel| f64::from(texel) + 0.5))
}

/// The ray through any position in texels.
#[must_use]
pub fn ray_at(capture: &Capture, at: [f64; 2]) -> DVec3 {
    let camera = &capture.camera;
    let [width, height] = capture.size.map(f64::from);
    let up = (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let view = DVec3::new((at[0] / width * 2.0 - 1.0) * up * width / height, (1.0 - at[1] / height * 2.0) * up, -1.0);
    projection::view_from_world_rotation(camera.target - camera.eye, camera.up).transpose() * view
}

/// The surface at a pixel by the end of the frame, world space; `None` where there is none.
#[must_use]
pub fn surface(capture: &Capture, at: [u32; 2]) -> Option<DVec3> {
    let frame = capture.frame_at(capture.steps.len().checked_sub(1)?)?;
    let distance = capture.depth.distance(frame.depth.image.depth_at(at)?)?;
    Some(capture.camera.eye + ray(capture, at) * distance)
}

/// A homogeneous point of the world in view space, the view along −z.
fn in_view(capture: &Capture, world: glam::DVec4) -> DVec3 {
    let camera = &capture.camera;
    let rotation = projection::view_from_world_rotation(camera.target - camera.eye, camera.up);
    rotation * (world.truncate() - camera.eye * world.w)
}

/// Which way out of the picture a point is that is not before the eye: right and down, of length 1.
#[must_use]
pub fn way_to(capture: &Capture, world: glam::DVec4) -> [f64; 2] {
    let view = in_view(capture, world);
    // Right behind the eye any way is as good.
    let way = glam::DVec2::new(view.x, -view.y).try_normalize().unwrap_or(glam::DVec2::Y);
    way.to_array()
}

/// Where a homogeneous point of the world is in the picture, texels; `None` where it is not before the eye.
#[must_use]
pub fn texel_of(capture: &Capture, world: glam::DVec4) -> Option<[f64; 2]> {
    let camera = &capture.camera;
    let [width, height] = capture.size.map(f64::from);
    let view = in_view(capture, world);
    let up = (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let at = (view.truncate() / -view.z) / glam::DVec2::new(up * width / height, up);
    (view.z < -1e-9).then(|| [(at.x + 1.0) / 2.0 * width, (1.0 - at.y) / 2.0 * height])
}
