//! The frusta of the camera and of the lights' maps, and the volume between the near rectangle and a light.

use super::{Frustum, NearClip, PlacedObject, ViewOf};
use crate::geometry::{NearClipVolume, ViewVolume};
use crate::plan::{FramePlan, LightId, PlanMap, Program, ViewId, Visibility};
use crate::scene::{Camera, Light, Ray, Scene};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// The corners of a view: right top, left top, left bottom, right bottom.
const CORNERS: [DVec2; 4] = [DVec2::ONE, DVec2::new(-1.0, 1.0), DVec2::NEG_ONE, DVec2::new(1.0, -1.0)];

/// Returns the camera's frustum, then one for each face of a light's map that is drawn: of depths or of a receiver's
/// texture. A projected silhouette gives two. Left out are faces without a view, and frusta that would not be finite.
pub fn all(scene: &Scene, plan: &FramePlan, objects: &[PlacedObject], aspect: f64) -> Vec<Frustum> {
    let mut frusta = vec![of_camera(&scene.camera, aspect, plan.depth.far)];
    for (light, position) in scene.lights.iter().map(Light::homogeneous).enumerate() {
        let Some(map) = plan.lights.get(light).and_then(|light| light.map.as_ref()) else { continue };
        let how = reading(plan, light);
        for (face, view) in map.faces.iter().enumerate() {
            let (Some(view), Some(clip_from_light)) = (view, map.clip_from_light.get(face)) else { continue };
            let clip_from_world = *clip_from_light * map.light_from_world;
            let of = |caster| ViewOf::Map { light, face, caster };
            match how {
                Some(Visibility::ReceiverTexture) => {
                    frusta.extend(of_receiver(clip_from_world, position, of(None)));
                }
                Some(Visibility::Projected) => {
                    let caster = caster_of(plan, *view, objects);
                    let Some(places) = caster.map(|caster| &objects[caster].positions) else { continue };
                    frusta.extend(of_projector(clip_from_world, position, places, of(caster)).into_iter().flatten());
                }
                _ => frusta.extend(of_matrix(clip_from_world, is_reversed(map), of(None))),
            }
        }
    }
    frusta
}

/// Returns whether a depth map is cleared to 0, as its depth is reversed.
fn is_reversed(map: &PlanMap) -> bool {
    map.lookup.is_some_and(|lookup| lookup.clear_depth == 0.0)
}

/// Returns how the first draw that reads a map in this light's passes (shading or labels) uses it; `None` where no draw
/// reads one.
fn reading(plan: &FramePlan, light: usize) -> Option<Visibility> {
    let passes = plan.passes.iter().filter(|pass| pass.light == Some(LightId(light)));
    passes.flat_map(|pass| &pass.draws).find_map(|draw| match draw.program {
        Program::Light(how) | Program::Label(how) | Program::Arriving(how) if how.reads_map() => Some(how),
        _ => None,
    })
}

/// Returns the index of the object named by the first draw of the view's first pass; `None` where there is no such
/// pass, draw or object.
fn caster_of(plan: &FramePlan, view: ViewId, objects: &[PlacedObject]) -> Option<usize> {
    let pass = plan.passes.iter().find(|pass| pass.view == view)?;
    let name = pass.draws.first()?.caster.as_deref()?;
    objects.iter().position(|object| object.name == name)
}

/// Returns the frustum from a receiver's rectangle (`near`, clip depth 0) to the light: all four `far` corners are the
/// light's homogeneous position. `None` where a corner is not finite.
fn of_receiver(clip_from_world: DMat4, light: DVec4, of: ViewOf) -> Option<Frustum> {
    let world_from_clip = clip_from_world.inverse();
    let near = CORNERS.map(|at| {
        let point = world_from_clip * DVec4::new(at.x, at.y, 0.0, 1.0);
        point / point.w
    });
    near.iter().all(|corner| corner.is_finite()).then_some(Frustum { of, near, far: [light; 4] })
}

/// Returns the two frusta of a projected silhouette: from the rectangle that it fills where the caster is nearest to
/// the light, one back to the light, and one onwards without an end. `None` where the matrix sees no such rectangle.
fn of_projector(clip_from_world: DMat4, light: DVec4, caster: &[DVec3], of: ViewOf) -> Option<[Frustum; 2]> {
    let [right, up, distance] = [0, 1, 3].map(|row| clip_from_world.row(row));
    // All is at one depth there, so that the matrix has no inverse: the distance is chosen here.
    let nearest = |row: DVec4| caster.iter().map(|point| row.dot(point.extend(1.0))).fold(f64::INFINITY, f64::min);
    let is_parallel = light.w == 0.0;
    let ahead = if is_parallel { (-light.truncate().normalize_or_zero()).extend(0.0) } else { distance };
    let away = nearest(ahead);
    let scale = if is_parallel { 1.0 } else { away };
    let world_from_rows = DMat3::from_cols(right.truncate(), up.truncate(), ahead.truncate()).transpose().inverse();
    let near = CORNERS.map(|at| {
        let rows = DVec3::new(at.x * scale - right.w, at.y * scale - up.w, away - ahead.w);
        (world_from_rows * rows).extend(1.0)
    });
    let onwards = |corner: DVec4| (corner * light.w - light).truncate().extend(0.0);
    let is_usable = near.iter().all(|corner| corner.is_finite() && onwards(*corner).length() > 0.0);
    let to = |far: [DVec4; 4]| Frustum { of, near, far };
    is_usable.then(|| [to([light; 4]), to(near.map(onwards))])
}

/// Returns the camera's view frustum, world space, up to `far` metres; where that is `None`, without an end.
pub fn of_camera(camera: &Camera, aspect: f64, far: Option<f64>) -> Frustum {
    let rays = CORNERS.map(|corner| camera.rays(aspect).through(corner));
    let at = |ray: Ray, distance: f64| (camera.eye + ray.at(distance)).extend(1.0);
    Frustum {
        of: ViewOf::Camera,
        near: rays.map(|ray| at(ray, camera.near)),
        far: rays.map(|ray| far.map_or(ray.along.extend(0.0), |far| at(ray, far))),
    }
}

/// Returns the frustum that a matrix maps to clip space, in world space; corners at infinity are directions (w 0).
/// `is_reversed` is true where the near plane has depth 1. `None` where a corner is not finite, as without an inverse.
fn of_matrix(clip_from_world: DMat4, is_reversed: bool, of: ViewOf) -> Option<Frustum> {
    let world_from_clip = clip_from_world.inverse();
    let corner = |at: DVec2, depth: f64| {
        let point = world_from_clip * DVec4::new(at.x, at.y, depth, 1.0);
        // A point at infinity is a direction, but for rounding.
        let is_far = point.w.abs() <= 1e-12 * point.truncate().length();
        if is_far { point.truncate().extend(0.0) } else { point / point.w }
    };
    let [near, far] = if is_reversed { [1.0, 0.0] } else { [0.0, 1.0] };
    let frustum = Frustum { of, near: CORNERS.map(|at| corner(at, near)), far: CORNERS.map(|at| corner(at, far)) };
    frustum.near.iter().chain(&frustum.far).all(|corner| corner.is_finite()).then_some(frustum)
}

/// Returns the near-clip volume of a light: the camera's near rectangle in world space, and the light as its apex.
/// `None` where the light lies in the near plane, within rounding.
pub fn near_clip(camera: &Camera, aspect: f64, light: &Light) -> Option<NearClip> {
    let position = light.homogeneous();
    let relative = (position.truncate() - camera.eye * position.w).extend(position.w);
    match ViewVolume::new(camera, aspect).near_clip(relative) {
        NearClipVolume::Slab(_) => None,
        NearClipVolume::Planes(_) => {
            let rectangle = of_camera(camera, aspect, None).near.map(|corner| corner.truncate());
            Some(NearClip { rectangle, apex: position })
        }
    }
}
