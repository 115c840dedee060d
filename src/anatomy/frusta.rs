//! What the camera and the lights' maps see, and what lies between the near rectangle and a light.

use super::{Frustum, NearClip, ViewOf};
use crate::geometry::{NearClipVolume, ViewVolume};
use crate::math::projection;
use crate::plan::FramePlan;
use crate::scene::{Camera, Light, Scene};
use glam::{DMat4, DVec2, DVec3, DVec4};

/// The corners of a view: right top, left top, left bottom, right bottom.
const CORNERS: [DVec2; 4] = [DVec2::ONE, DVec2::new(-1.0, 1.0), DVec2::NEG_ONE, DVec2::new(1.0, -1.0)];

/// The camera's frustum, then those of the faces of maps that are drawn and hold depths.
pub fn all(scene: &Scene, plan: &FramePlan, aspect: f64) -> Vec<Frustum> {
    let mut frusta = vec![of_camera(&scene.camera, aspect, plan.depth.far)];
    for (light, of) in plan.lights.iter().enumerate() {
        let Some((map, lookup)) = of.map.as_ref().and_then(|map| Some((map, map.lookup?))) else { continue };
        let is_reversed = lookup.clear_depth == 0.0;
        for (face, clip_from_light) in map.clip_from_light.iter().enumerate() {
            if map.faces.get(face).is_some_and(Option::is_some) {
                let clip_from_world = *clip_from_light * map.light_from_world;
                frusta.extend(of_matrix(clip_from_world, is_reversed, ViewOf::Map { light, face }));
            }
        }
    }
    frusta
}

fn of_camera(camera: &Camera, aspect: f64, far: Option<f64>) -> Frustum {
    let rays = rays(camera, aspect);
    let at = |ray: DVec3, distance: f64| (camera.eye + ray * distance).extend(1.0);
    Frustum {
        of: ViewOf::Camera,
        near: rays.map(|ray| at(ray, camera.near)),
        far: rays.map(|ray| far.map_or(ray.extend(0.0), |far| at(ray, far))),
    }
}

/// From the eye to the corners of the picture at distance 1.
fn rays(camera: &Camera, aspect: f64) -> [DVec3; 4] {
    let world_from_view = projection::view_from_world_rotation(camera.target - camera.eye, camera.up).transpose();
    let up = (camera.fov_y_degrees.to_radians() / 2.0).tan();
    CORNERS.map(|corner| world_from_view * DVec3::new(corner.x * up * aspect, corner.y * up, -1.0))
}

/// `None` where the matrix has no inverse, or sees no frustum.
fn of_matrix(clip_from_world: DMat4, is_reversed: bool, of: ViewOf) -> Option<Frustum> {
    let world_from_clip = clip_from_world.inverse();
    let corner = |at: DVec2, depth: f64| {
        let point = world_from_clip * DVec4::new(at.x, at.y, depth, 1.0);
        // A depth without an end is a direction, but for rounding.
        let is_far = point.w.abs() <= 1e-12 * point.truncate().length();
        if is_far { point.truncate().extend(0.0) } else { point / point.w }
    };
    let [near, far] = if is_reversed { [1.0, 0.0] } else { [0.0, 1.0] };
    let frustum = Frustum { of, near: CORNERS.map(|at| corner(at, near)), far: CORNERS.map(|at| corner(at, far)) };
    frustum.near.iter().chain(&frustum.far).all(|corner| corner.is_finite()).then_some(frustum)
}

/// The near-clip volume of a light; `None` where the light lies in the near plane.
pub fn near_clip(camera: &Camera, aspect: f64, light: &Light) -> Option<NearClip> {
    let position = light.homogeneous();
    let relative = (position.truncate() - camera.eye * position.w).extend(position.w);
    match ViewVolume::new(camera, aspect).near_clip(relative) {
        NearClipVolume::Slab(_) => None,
        NearClipVolume::Planes(_) => {
            let rectangle = rays(camera, aspect).map(|ray| camera.eye + ray * camera.near);
            Some(NearClip { rectangle, apex: position })
        }
    }
}
