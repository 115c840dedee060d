//! Whose shadow a pixel lies in, where no volumes are counted: what the ray from its surface to the light meets.

use crate::capture::Capture;
use crate::inspector::model::Model;
use crate::inspector::model::scene::OpenScene;
use crate::reading::pick_ray;
use crate::scene::Object;
use glam::DVec3;
use std::rc::Rc;

/// The ray begins this share of the distance from the eye away from the surface, whose place is rounded.
const AWAY: f64 = 1e-4;

/// The objects that keep a light from a pixel, found once for each pixel, frame and light.
#[derive(Debug, Default)]
pub struct Blockers {
    known: Option<(BlockersKey, Rc<[String]>)>,
}

/// Number of the frame, pixel, index of the light.
type BlockersKey = (u64, [u32; 2], usize);

impl Blockers {
    /// Returns the names of the casters between a pixel's surface and a light, the nearest to the surface first. Empty
    /// where there are none, no scene is open, or a run is awaited: the scene is another one by then than the frame's.
    pub fn of(&mut self, model: &Model, capture: &Capture, light: usize, at: [u32; 2]) -> Rc<[String]> {
        let Some(scene) = model.scene.as_ref().filter(|_| !model.activity.is_waiting) else { return Rc::default() };
        let key = (model.frame.number, at, light);
        match &self.known {
            Some((of, names)) if *of == key => Rc::clone(names),
            _ => {
                let names: Rc<[String]> = blockers(scene, capture, light, at).into();
                self.known = Some((key, Rc::clone(&names)));
                names
            }
        }
    }
}

fn blockers(scene: &OpenScene, capture: &Capture, light: usize, at: [u32; 2]) -> Vec<String> {
    let Some(surface) = pick_ray::surface(capture, at) else { return Vec::new() };
    let Some(position) = capture.lights.get(light).map(|light| light.position) else { return Vec::new() };
    let is_directional = position.w == 0.0;
    let way = match is_directional {
        true => position.truncate().normalize_or_zero(),
        false => position.truncate() / position.w - surface,
    };
    let start = AWAY * surface.distance(capture.camera.eye) / way.length().max(f64::MIN_POSITIVE);
    let end = if is_directional { f64::INFINITY } else { 1.0 };
    let mut found: Vec<(f64, String)> = (0..scene.object_count())
        .filter(|index| !scene.draft.off.contains(index))
        .filter_map(|index| scene.object(index))
        .filter(|object| object.casts)
        .filter_map(|object| Some((nearest_hit(&object, scene.draft.time, surface, way, start..end)?, object.name)))
        .collect();
    found.sort_by(|one, other| one.0.total_cmp(&other.0));
    found.into_iter().map(|(_, name)| name).collect()
}

/// Returns how many times `way` from `origin`, world space, an object is met first within `range`, at a time in seconds;
/// `None` where it is not met.
fn nearest_hit(object: &Object, time: f64, origin: DVec3, way: DVec3, range: std::ops::Range<f64>) -> Option<f64> {
    let pose = object.motion.apply(&object.pose, time);
    // The mesh stays where it is, and the ray comes to it.
    let object_from_world = pose.world_from_object().inverse();
    let (origin, way) = (object_from_world.transform_point3(origin), object_from_world.transform_vector3(way));
    let places = object.mesh.positions();
    let hits = object.mesh.triangles().iter().filter_map(|triangle| {
        let corners = triangle.map(|corner| places.get(corner as usize).copied());
        let [Some(a), Some(b), Some(c)] = corners else { return None };
        hit(origin, way, [a, b, c]).filter(|times| range.contains(times))
    });
    hits.reduce(f64::min)
}

/// Returns how many times `way` from `origin` a ray meets a triangle, from either side; `None` where it passes it, or runs
/// along its plane (Möller and Trumbore 1997).
fn hit(origin: DVec3, way: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = way.cross(ac);
    let volume = ab.dot(across);
    if volume == 0.0 {
        return None;
    }
    let from = origin - a;
    let u = from.dot(across) / volume;
    let around = from.cross(ab);
    let v = way.dot(around) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| ac.dot(around) / volume)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Pose, shapes};

    #[test]
    fn a_moved_and_stretched_box_is_met_where_it_is() {
        let cube = Object::of("box", shapes::cuboid([1.0; 3]).expect("a box"));
        let pose = Pose { translate: DVec3::Y * 4.0, scale: DVec3::new(1.0, 2.0, 1.0), ..Pose::default() };
        let cube = Object { pose, ..cube };
        let met = |from: DVec3, range| nearest_hit(&cube, 0.0, from, DVec3::Y * 2.0, range);
        // Its lower face is at 3, so 1.5 times two metres away; its upper one at 5.
        assert_eq!(met(DVec3::new(0.1, 0.0, 0.2), 0.0..f64::INFINITY), Some(1.5));
        assert_eq!(met(DVec3::new(0.1, 0.0, 0.2), 2.0..f64::INFINITY), Some(2.5));
        assert_eq!(met(DVec3::new(0.1, 0.0, 0.2), 0.0..1.0), None, "the light is nearer");
        assert_eq!(met(DVec3::new(0.6, 0.0, 0.2), 0.0..f64::INFINITY), None, "beside it");
        assert_eq!(met(DVec3::new(0.1, 7.0, 0.2), 0.0..f64::INFINITY), None, "behind it");
    }
}
