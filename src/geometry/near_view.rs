//! A light's view through the camera's near rectangle, in which every point of the near plane
//! keeps its pixel.
//!
//! With π the near plane and L the light, `M = (π·L) I − L πᵀ` carries a point along the light's
//! ray onto π; the camera's x, y and w rows do the rest. Depth only clips: 0 on the near plane, and
//! `w` just in front of a point light or beyond every caster of a directional one.

use crate::math::depth::DepthMapping;
use crate::scene::Camera;
use glam::{DMat4, DVec3, DVec4};

/// A light lies in the near plane if its distance from it is at most this, relative to its distance from the eye.
const IN_PLANE: f64 = 1e-6;
/// The near end of a point light's view, as a share of the way from the light to the near plane.
const NEAREST: f64 = 1.0 / (1 << 20) as f64;

/// Returns clip space from positions relative to the eye for the light's view through the camera's near rectangle, with
/// depth from 0 (near plane) to 1 (towards the light). `points` are those that may cast, world space; `aspect` is width
/// over height.
///
/// # Errors
/// Why there is no such view: the light lies in the near plane, or nothing lies between.
pub fn through_near_rectangle<'a>(
    camera: &Camera,
    aspect: f64,
    light: DVec4,
    points: impl Iterator<Item = &'a DVec3>,
) -> Result<DMat4, &'static str> {
    let rotation = camera.world_from_view().transpose();
    // A direction's length means nothing.
    let scale = if light.w == 0.0 { light.truncate().abs().max_element() } else { 1.0 };
    let light = (rotation * (light.truncate() / scale - camera.eye * light.w)).extend(light.w);
    let near_plane = DVec4::new(0.0, 0.0, -1.0, -camera.near);
    let height = near_plane.dot(light);
    if height.abs() <= IN_PLANE * (light.truncate().length() + camera.near * light.w) {
        return Err("the light lies in the near plane and sees it as a line");
    }
    // Divided by the height, so that what lies between plane and light has a share from 0 to 1
    // of the way, whichever side the light is on.
    let share = near_plane / height;
    let onto_plane = |row: DVec4, of_light: f64| row - share * of_light;
    // The camera's rows, whatever its depth. On the near plane w is one number: a pinhole's is its distance.
    let of_camera = camera.clip_from_view(aspect, &DepthMapping::ReversedInfinite.curve(camera.near, 0.0, 0.0));
    let [x, y] = [of_camera.row(0), of_camera.row(1)].map(|row| onto_plane(row, row.dot(light)));
    let w_there = if camera.is_parallel() { 1.0 } else { camera.near };
    let w = onto_plane(DVec4::W, light.w) * w_there;
    let depth_per_share = match light.w == 0.0 {
        true => {
            let share_of = |point: &DVec3| share.dot((rotation * (*point - camera.eye)).extend(1.0));
            let farthest = points.map(share_of).fold(0.0, f64::max);
            if farthest <= 0.0 {
                return Err("nothing that casts lies between it and the near plane");
            }
            w_there * 0.5 / farthest
        }
        false => w_there * NEAREST,
    };
    let clip_from_view = DMat4::from_cols(x, y, share * depth_per_share, w).transpose();
    Ok(clip_from_view * DMat4::from_mat3(rotation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Projection;

    fn cameras() -> [Camera; 3] {
        let oblique = Projection::Oblique { half_height: 1.5, angle_degrees: 30.0, factor: 0.5 };
        [Projection::Perspective, Projection::Orthographic { half_height: 2.0 }, oblique]
            .map(|projection| Camera { projection, ..camera() })
    }

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(1.0, 2.0, 3.0),
            target: DVec3::new(0.5, 1.0, -1.0),
            up: DVec3::Y,
            projection: Projection::Perspective,
            fov_y_degrees: 60.0,
            near: 0.5,
            far: None,
            viewport: None,
        }
    }

    /// The camera's clip space from positions relative to the eye.
    fn camera_matrix(camera: &Camera) -> DMat4 {
        let depth = match camera.is_parallel() {
            true => DepthMapping::ReversedInfinite.linear_curve(camera.near, 20.0),
            false => DepthMapping::ReversedInfinite.curve(camera.near, 0.0, 0.0),
        };
        camera.clip_from_view(1.5, &depth) * DMat4::from_mat3(camera.world_from_view().transpose())
    }

    /// Any point between the light and a point of the near plane has that point's pixel, and lies
    /// inside the depth range; beyond the plane or the light it does not.
    #[test]
    fn what_lies_between_has_the_near_points_pixel() {
        let lights = [DVec4::new(5.0, 4.0, 9.0, 1.0), DVec4::new(-3.0, 1.0, -8.0, 1.0), DVec4::new(0.3, 0.5, 0.4, 0.0)];
        for (camera, light) in cameras().into_iter().flat_map(|camera| lights.map(|light| (camera, light))) {
            let relative_from_clip = camera_matrix(&camera).inverse();
            for (x, y) in [(0.0, 0.0), (-0.9, 0.3), (0.7, -0.8)] {
                let near = relative_from_clip * DVec4::new(x, y, 1.0, 1.0);
                let near = near.truncate() / near.w;
                let towards = light.truncate() - (near + camera.eye) * light.w;
                let at = |way: f64| near + towards * way;
                let farthest = at(0.9) + camera.eye;
                let matrix = through_near_rectangle(&camera, 1.5, light, [farthest].iter()).expect("a view");
                for way in [0.01, 0.5, 0.9] {
                    let clip = matrix * at(way).extend(1.0);
                    assert!((clip.truncate() / clip.w - DVec3::new(x, y, 0.5)).truncate().length() < 1e-9, "{clip}");
                    assert!(clip.w > 0.0 && clip.z > 0.0 && clip.z < clip.w, "{light} {way} {clip}");
                }
                let behind = matrix * at(-0.1).extend(1.0);
                assert!(behind.z < 0.0, "beyond the near plane");
                if light.w == 1.0 {
                    assert!((matrix * at(1.1).extend(1.0)).w < 0.0, "beyond the light");
                }
            }
        }
    }

    #[test]
    fn a_light_in_the_near_plane_has_no_view() {
        let camera = camera();
        let forward = (camera.target - camera.eye).normalize();
        let in_plane = camera.eye + forward * camera.near + forward.cross(DVec3::Y) * 3.0;
        assert!(through_near_rectangle(&camera, 1.0, in_plane.extend(1.0), [].iter()).is_err());
        let across = through_near_rectangle(&camera, 1.0, forward.cross(DVec3::Y).extend(0.0), [].iter());
        assert!(across.is_err_and(|because| because.contains("lies in the near plane")));
        let nothing_between = through_near_rectangle(&camera, 1.0, DVec4::Y, [].iter());
        assert!(nothing_between.is_err_and(|because| because.contains("nothing that casts")));
    }
}
