//! Rounding to the GPU's `f32`, after subtracting an origin in `f64`.
//!
//! A scene moved far from the world's origin keeps its precision near the eye, and a vertex at
//! infinity is a direction, which no origin changes.

use glam::{DVec3, DVec4};

/// Rounds a position to single precision, as a world of floats has it.
pub fn rounded(position: DVec3) -> DVec3 {
    position.as_vec3().as_dvec3()
}

/// Returns a point relative to `origin` in single precision, with w = 1.
pub fn point(position: DVec3, origin: DVec3) -> [f32; 4] {
    homogeneous(position.extend(1.0), origin)
}

/// Returns a homogeneous point relative to `origin` in single precision: `(xyz − w·origin, w)`.
pub fn homogeneous(position: DVec4, origin: DVec3) -> [f32; 4] {
    let relative = position.truncate() - origin * position.w;
    [relative.x as f32, relative.y as f32, relative.z as f32, position.w as f32]
}
