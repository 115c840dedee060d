//! The parts that scenes of cases are built from.

use crate::scene::{Light, MeshError, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;

/// Ambient light, so that shadows are dark and not black.
const AMBIENT: [f32; 3] = [0.12; 3];

/// Returns a scene with one light, seen from `eye` towards `target` with a field of view of 45 degrees.
pub fn scene(eye: [f64; 3], target: [f64; 3], light: Light, objects: Vec<Object>) -> Scene {
    SceneBuilder::new("stress").ambient(AMBIENT).light(light).objects(objects).seen_from(eye, target).build()
}

/// Returns a level square around the origin at height 0, which extends `half` metres each way.
pub fn floor(half: f64) -> Result<Object, MeshError> {
    Ok(Object::of("floor", shapes::quad([2.0 * half; 2])?))
}

/// Returns a closed box of this name, of `size` in metres around `center`.
pub fn cuboid(name: &str, center: [f64; 3], size: [f64; 3]) -> Result<Object, MeshError> {
    Ok(Object::of(name, shapes::cuboid(size)?).at(center))
}

/// Returns the scene moved by a vector: objects, eye, target and point lights. Directional lights stay.
pub fn carried(mut scene: Scene, by: DVec3) -> Scene {
    scene.camera.eye += by;
    scene.camera.target += by;
    scene.objects.iter_mut().for_each(|object| object.pose.translate += by);
    for light in scene.lights.iter_mut().filter(|light| !light.is_directional()) {
        light.position += by.extend(0.0);
    }
    scene
}

/// Returns the scene scaled about the origin: objects, eye, target, near and far planes and the places of point lights.
/// Directional lights and ranges of lights stay.
pub fn enlarged(mut scene: Scene, factor: f64) -> Scene {
    scene.camera.eye *= factor;
    scene.camera.target *= factor;
    scene.camera.near *= factor;
    scene.camera.far = scene.camera.far.map(|far| far * factor);
    for object in &mut scene.objects {
        object.pose.translate *= factor;
        object.pose.scale *= factor;
    }
    for light in scene.lights.iter_mut().filter(|light| !light.is_directional()) {
        light.position = (light.position.truncate() * factor).extend(1.0);
    }
    scene
}

/// Returns the easiest scene for all shadows: a box that floats over a floor, under a lamp.
pub fn still_life() -> Result<Scene, MeshError> {
    let objects = vec![floor(3.0)?, cuboid("box", [0.0, 0.8, 0.0], [0.8, 0.6, 0.8])?];
    Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([1.0, 4.0, 1.5]), objects))
}
