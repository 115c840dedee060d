//! Cameras as matrices: view rotation and reversed-infinite perspective.
//!
//! Depth is reversed and infinite: `z = near / distance`, 1 at the near plane, 0 at infinity. A
//! vertex at infinity gets depth 0 exactly, nothing is clipped at far, and `f32` is finest where
//! it is needed (Reed 2015, "Depth Precision Visualized").

use glam::{DMat3, DMat4, DVec3, DVec4};

/// Clip space from view space: perspective with reversed-infinite depth.
/// `aspect` is width over height, `near` the distance of the near plane.
#[must_use]
pub fn reversed_infinite(fov_y_degrees: f64, aspect: f64, near: f64) -> DMat4 {
    let focal = 1.0 / (fov_y_degrees.to_radians() / 2.0).tan();
    frustum(focal / aspect, focal, near)
}

/// The same by focal lengths: a point at distance 1 and offset `1 / focal` is at the picture's edge.
#[must_use]
pub fn frustum(focal_x: f64, focal_y: f64, near: f64) -> DMat4 {
    DMat4::from_cols(
        DVec4::new(focal_x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, focal_y, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 0.0, -1.0),
        DVec4::new(0.0, 0.0, near, 0.0),
    )
}

/// Clip space from a box in view space, looking down −z: x and y in ±`half`, depth 1 at
/// `near`, 0 at `far` (distances along −z).
#[must_use]
pub fn reversed_orthographic(half: [f64; 2], near: f64, far: f64) -> DMat4 {
    let depth = far - near;
    DMat4::from_cols(
        DVec4::new(1.0 / half[0], 0.0, 0.0, 0.0),
        DVec4::new(0.0, 1.0 / half[1], 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0 / depth, 0.0),
        DVec4::new(0.0, 0.0, far / depth, 1.0),
    )
}

/// Rotates world directions into view space looking along `forward`; neither argument is zero,
/// nor are they parallel.
#[must_use]
pub fn view_from_world_rotation(forward: DVec3, up: DVec3) -> DMat3 {
    let back = -forward.normalize();
    let right = up.cross(back).normalize();
    DMat3::from_cols(right, back.cross(right), back).transpose()
}

/// A direction that is not parallel to `direction`: up for whatever looks along it.
#[must_use]
pub fn some_up_for(direction: DVec3) -> DVec3 {
    if direction.y.abs() > 0.9 * direction.length() { DVec3::Z } else { DVec3::Y }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(clip_from_view: DMat4, point: DVec3) -> DVec3 {
        let clip = clip_from_view * point.extend(1.0);
        clip.truncate() / clip.w
    }

    #[test]
    fn reversed_infinite_maps_near_to_one_and_infinity_to_zero() {
        let clip_from_view = reversed_infinite(90.0, 2.0, 0.25);
        assert!((project(clip_from_view, DVec3::new(0.0, 0.0, -0.25)).z - 1.0).abs() < 1e-15);
        assert!((project(clip_from_view, DVec3::new(0.0, 0.0, -1000.0)).z - 0.25 / 1000.0).abs() < 1e-15);
        assert_eq!((clip_from_view * DVec4::new(0.1, 0.2, -1.0, 0.0)).z, 0.0);
        let corner = project(clip_from_view, DVec3::new(6.0, 3.0, -3.0));
        assert!((corner.x - 1.0).abs() < 1e-12 && (corner.y - 1.0).abs() < 1e-12);
    }

    #[test]
    fn reversed_orthographic_maps_its_box_to_clip_space() {
        let clip_from_view = reversed_orthographic([2.0, 3.0], 1.0, 5.0);
        assert!((project(clip_from_view, DVec3::new(2.0, -3.0, -1.0)) - DVec3::new(1.0, -1.0, 1.0)).length() < 1e-12);
        assert!((project(clip_from_view, DVec3::new(0.0, 0.0, -5.0)) - DVec3::ZERO).length() < 1e-12);
    }

    #[test]
    fn the_view_rotation_is_a_rotation_that_looks_down_minus_z() {
        let forward = DVec3::new(1.0, -2.0, 0.5);
        let view_from_world = view_from_world_rotation(forward, DVec3::Y);
        assert!((view_from_world.determinant() - 1.0).abs() < 1e-12);
        let seen = view_from_world * forward.normalize();
        assert!((seen - DVec3::NEG_Z).length() < 1e-12);
        assert!((view_from_world * DVec3::Y).y > 0.0);
    }
}
