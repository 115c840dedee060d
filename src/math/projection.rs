//! Cameras as matrices: view rotation, perspective and parallel projection.

use super::angle;
use super::depth::DepthCurve;
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// Returns clip space from view space for a perspective. `aspect` is width over height.
pub fn perspective(fov_y_degrees: f64, aspect: f64, depth: &DepthCurve) -> DMat4 {
    let focal = 1.0 / angle::tan(fov_y_degrees.to_radians() / 2.0);
    frustum(focal / aspect, focal, depth)
}

/// Returns clip space from view space for a perspective by focal lengths: a point at distance 1 and offset `1 / focal`
/// is at the picture's edge.
pub fn frustum(focal_x: f64, focal_y: f64, depth: &DepthCurve) -> DMat4 {
    let z_row = depth.z_row();
    DMat4::from_cols(
        DVec4::new(focal_x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, focal_y, 0.0, 0.0),
        DVec4::new(0.0, 0.0, z_row.x, -1.0),
        DVec4::new(0.0, 0.0, z_row.y, 0.0),
    )
}

/// Returns clip space from view space for a parallel projection of pictures whose edges are `half` from the centre. A
/// point a metre behind the distance `in_place` is moved by `shear`. Depth must be linear.
pub fn parallel(half: [f64; 2], shear: DVec2, in_place: f64, depth: &DepthCurve) -> DMat4 {
    let z_row = depth.z_row();
    let half = DVec2::from_array(half);
    let (receding, back) = (-shear / half, -shear * in_place / half);
    DMat4::from_cols(
        DVec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
        DVec4::new(receding.x, receding.y, z_row.x, 0.0),
        DVec4::new(back.x, back.y, z_row.y, 1.0),
    )
}

/// Returns clip space from a box in view space, looking down −z: x and y in ±`half`, and linear depth from `near` to
/// `far` (distances along −z): from 1 to 0 where it is reversed, else from 0 to 1.
pub fn orthographic(half: [f64; 2], near: f64, far: f64, is_reversed: bool) -> DMat4 {
    let depth = if is_reversed { far - near } else { near - far };
    let end = if is_reversed { far } else { near };
    DMat4::from_cols(
        DVec4::new(1.0 / half[0], 0.0, 0.0, 0.0),
        DVec4::new(0.0, 1.0 / half[1], 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0 / depth, 0.0),
        DVec4::new(0.0, 0.0, end / depth, 1.0),
    )
}

/// Returns a rotation from world directions into view space looking along `forward`; neither argument is zero, nor are
/// they parallel.
pub fn view_from_world_rotation(forward: DVec3, up: DVec3) -> DMat3 {
    let back = -forward.normalize();
    let right = up.cross(back).normalize();
    DMat3::from_cols(right, back.cross(right), back).transpose()
}

/// Returns a direction that is not parallel to `direction`: an up vector for a view along it.
pub fn some_up_for(direction: DVec3) -> DVec3 {
    if direction.y.abs() > 0.9 * direction.length() { DVec3::Z } else { DVec3::Y }
}

#[cfg(test)]
mod tests {
    use super::super::depth::DepthMapping;
    use super::*;

    fn project(clip_from_view: DMat4, point: DVec3) -> DVec3 {
        let clip = clip_from_view * point.extend(1.0);
        clip.truncate() / clip.w
    }

    #[test]
    fn perspective_fills_the_picture_with_its_field_of_view() {
        for mapping in DepthMapping::ALL {
            let curve = mapping.curve(0.25, 100.0, 1e-6);
            let clip_from_view = perspective(90.0, 2.0, &curve);
            let corner = project(clip_from_view, DVec3::new(6.0, 3.0, -3.0));
            assert!((corner - DVec3::new(1.0, 1.0, curve.depth(3.0))).length() < 1e-12);
        }
    }

    #[test]
    fn a_vertex_at_infinity_has_depth_zero_exactly_where_depth_is_reversed() {
        let curve = DepthMapping::ReversedInfinite.curve(0.25, 0.0, 0.0);
        assert_eq!((perspective(90.0, 2.0, &curve) * DVec4::new(0.1, 0.2, -1.0, 0.0)).z, 0.0);
    }

    #[test]
    fn orthographic_maps_its_box_to_clip_space() {
        for (is_reversed, near, far) in [(true, 1.0, 0.0), (false, 0.0, 1.0)] {
            let clip_from_view = orthographic([2.0, 3.0], 1.0, 5.0, is_reversed);
            let corner = project(clip_from_view, DVec3::new(2.0, -3.0, -1.0));
            assert!((corner - DVec3::new(1.0, -1.0, near)).length() < 1e-12);
            assert!((project(clip_from_view, DVec3::new(0.0, 0.0, -5.0)) - DVec3::Z * far).length() < 1e-12);
        }
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
