//! What scenes of cases are put together from.

use crate::scene::builtin::shapes;
use crate::scene::{Camera, Light, Material, Mesh, MeshBuilder, MeshError, Object, Pose, Scene};
use glam::DVec3;
use std::sync::Arc;

/// Ambient light, so that shadows are dark and not black.
const AMBIENT: [f32; 3] = [0.12; 3];

/// A scene with one light, seen by an eye with a field of view of 45 degrees.
pub fn scene(eye: [f64; 3], target: [f64; 3], light: Light, objects: Vec<Object>) -> Scene {
    let [eye, target] = [eye, target].map(DVec3::from_array);
    let ahead = (target - eye).normalize_or_zero();
    let up = if ahead.y.abs() > 0.99 { DVec3::NEG_Z } else { DVec3::Y };
    Scene {
        name: "stress".to_owned(),
        ambient: AMBIENT,
        camera: Camera { eye, target, up, fov_y_degrees: 45.0, near: 0.05, far: None },
        lights: vec![light],
        objects,
        technique: None,
    }
}

/// A point light.
pub fn lamp(x: f64, y: f64, z: f64) -> Light {
    Light::point(DVec3::new(x, y, z))
}

/// A level square around the origin, `half` each way, at height 0.
pub fn floor(half: f64) -> Result<Object, MeshError> {
    Ok(object("floor", shapes::quad([2.0 * half; 2])?))
}

/// A closed box of `size` around `center`.
pub fn cuboid(name: &str, center: [f64; 3], size: [f64; 3]) -> Result<Object, MeshError> {
    Ok(moved(object(name, shapes::cuboid(size)?), center))
}

/// A dull object of a mesh.
pub fn object(name: &str, mesh: Mesh) -> Object {
    Object::new(name, Arc::new(mesh), Material::default())
}

/// The same object elsewhere.
pub fn moved(object: Object, to: [f64; 3]) -> Object {
    let translate = DVec3::from_array(to);
    Object { pose: Pose { translate, ..object.pose }, ..object }
}

/// It casts, but is not drawn, so that the whole shadow shows.
pub fn unseen(object: Object) -> Object {
    Object { visible: false, ..object }
}

/// A mesh of points and triangles.
pub fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Mesh, MeshError> {
    let positions = points.iter().map(|point| DVec3::from_array(*point)).collect();
    MeshBuilder { positions, triangles: triangles.to_vec(), ..MeshBuilder::default() }.build()
}

/// The scene carried elsewhere, eye and lights with it.
pub fn carried(mut scene: Scene, by: DVec3) -> Scene {
    scene.camera.eye += by;
    scene.camera.target += by;
    scene.objects.iter_mut().for_each(|object| object.pose.translate += by);
    for light in scene.lights.iter_mut().filter(|light| !light.is_directional()) {
        light.position += by.extend(0.0);
    }
    scene
}

/// The scene made larger about the origin, eye and lights with it.
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

/// A box that floats over a floor, under a lamp: the easiest of all shadows.
pub fn still_life() -> Result<Scene, MeshError> {
    let objects = vec![floor(3.0)?, cuboid("box", [0.0, 0.8, 0.0], [0.8, 0.6, 0.8])?];
    Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], lamp(1.0, 4.0, 1.5), objects))
}

/// The same object turned about the fixed x, then y, then z axis.
pub fn turned(object: Object, rotate_degrees: [f64; 3]) -> Object {
    let rotate_degrees = DVec3::from_array(rotate_degrees);
    Object { pose: Pose { rotate_degrees, ..object.pose }, ..object }
}

/// The same object stretched; negative factors mirror.
pub fn scaled(object: Object, scale: [f64; 3]) -> Object {
    Object { pose: Pose { scale: DVec3::from_array(scale), ..object.pose }, ..object }
}
