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

/// Returns clip space from view space for a perspective by where the picture's edges lie on the near plane, metres right
/// of the view's axis and above it: left, right, bottom, top (glFrustum). `near` is the distance of that plane. The
/// picture's middle is off the axis where they are not symmetric.
pub fn off_center([left, right, bottom, top]: [f64; 4], near: f64, depth: &DepthCurve) -> DMat4 {
    let (width, height) = (right - left, top - bottom);
    let mut clip_from_view = frustum(2.0 * near / width, 2.0 * near / height, depth);
    clip_from_view.z_axis.x = (right + left) / width;
    clip_from_view.z_axis.y = (top + bottom) / height;
    clip_from_view
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

    /// The entries of the lecture's matrix, whose z from −1 to 1 is twice ours less w, and its inverse.
    #[test]
    fn an_off_center_frustum_is_gl_frustums() {
        let ([l, r, b, t], n, f) = ([-0.3, 0.7, -0.1, 0.5], 0.25, 40.0);
        let ours = off_center([l, r, b, t], n, &DepthMapping::StandardFinite.curve(n, f, 0.0));
        let opengl = DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::Z * 2.0, DVec4::new(0.0, 0.0, -1.0, 1.0)) * ours;
        let rows = [
            [2.0 * n / (r - l), 0.0, (r + l) / (r - l), 0.0],
            [0.0, 2.0 * n / (t - b), (t + b) / (t - b), 0.0],
            [0.0, 0.0, -(f + n) / (f - n), -2.0 * f * n / (f - n)],
            [0.0, 0.0, -1.0, 0.0],
        ];
        let wanted = DMat4::from_cols_array_2d(&rows).transpose();
        assert!(opengl.abs_diff_eq(wanted, 1e-12), "{opengl}");
        let back = [
            [(r - l) / (2.0 * n), 0.0, 0.0, (r + l) / (2.0 * n)],
            [0.0, (t - b) / (2.0 * n), 0.0, (t + b) / (2.0 * n)],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, -(f - n) / (2.0 * f * n), (f + n) / (2.0 * f * n)],
        ];
        assert!(opengl.inverse().abs_diff_eq(DMat4::from_cols_array_2d(&back).transpose(), 1e-9));
        let corners = [(l, b, -1.0, -1.0), (r, t, 1.0, 1.0), (l, t, -1.0, 1.0)];
        for (x, y, across, up) in corners {
            assert!((project(ours, DVec3::new(x, y, -n)) - DVec3::new(across, up, 0.0)).length() < 1e-12);
            assert!(
                (project(ours, DVec3::new(x * f / n, y * f / n, -f)) - DVec3::new(across, up, 1.0)).length() < 1e-12
            );
        }
        // Symmetric, it is the one by the field of view.
        let half = n * angle::tan(30.0_f64.to_radians());
        let curve = DepthMapping::ReversedInfinite.curve(n, 0.0, 0.0);
        let symmetric = off_center([-1.5 * half, 1.5 * half, -half, half], n, &curve);
        assert!(symmetric.abs_diff_eq(perspective(60.0, 1.5, &curve), 1e-12));
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
