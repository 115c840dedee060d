//! A scene around a bare model: floor, light and camera from its bounds.

#[cfg(feature = "formats")]
use super::gltf;
use crate::scene::camera::placement::SceneBounds;
use crate::scene::names::ObjectNames;
use crate::scene::{Material, Mesh, MeshBuilder, Object, Scene, SceneError, Shading};
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;

/// Half the floor's width, in sums of the model's three extents.
const FLOOR_REACH: f64 = 5.0;
/// The floor's distance below the model, in the same unit: enough to distinguish their depths.
const FLOOR_GAP: f64 = 0.01;
/// Positions become `f32` beyond this file, and products of three of them must stay finite.
const MOST_EXTENT: f64 = 1e12;
const LEAST_EXTENT: f64 = 1e-12;

const TERRACOTTA: [f32; 3] = [0.62, 0.23, 0.12];
const WARM_GREY: [f32; 3] = [0.60, 0.57, 0.52];
const AMBIENT: [f32; 3] = [0.13, 0.13, 0.14];

/// Which axis of a model is up. Many programs have z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UpAxis {
    /// Y, as in this program.
    #[default]
    Y,
    /// Z: the model is rotated.
    Z,
}

/// Completes a model to a scene: a point light, a camera and, with `floor`, a level square that casts and receives like
/// any object. A model whose z axis is up is rotated first.
pub fn model_scene(name: &str, mesh: Mesh, floor: bool, up: UpAxis) -> Result<Scene, SceneError> {
    let shading = if mesh.corner_normals().is_some() { Shading::Phong } else { Shading::Flat };
    let material = Material { color: TERRACOTTA, specular: 0.12, shininess: 24.0, shading, ..Material::default() };
    let mut model = Object::new(name, Arc::new(mesh), material);
    if up == UpAxis::Z {
        model.pose = model.pose.with_z_up();
    }
    completed(name, vec![model], floor)
}

/// Returns the scene of a glTF file. Without lights or a camera it gets them; one that has neither is a bare model, and
/// only that gets a floor, where `floor` is true.
#[cfg(feature = "formats")]
pub(super) fn gltf_scene(name: &str, loaded: gltf::LoadedGltf, floor: bool) -> Result<Scene, SceneError> {
    let gltf::LoadedGltf { objects, lights, camera, not_taken, .. } = loaded;
    let is_bare = lights.is_empty() && camera.is_none();
    let scene = completed(name, objects, floor && is_bare)?;
    Ok(Scene {
        camera: camera.unwrap_or(scene.camera),
        lights: if lights.is_empty() { scene.lights } else { lights },
        not_taken,
        ..scene
    })
}

/// Returns a scene of these objects with a light, a camera and, with `floor`, a floor under them as the last object. An
/// error where they have no finite size, or are too large or too small.
fn completed(name: &str, mut objects: Vec<Object>, floor: bool) -> Result<Scene, SceneError> {
    let unusable = |reason: &str| SceneError::Read { file: PathBuf::from(name), reason: reason.to_owned() };
    let positions: Vec<DVec3> = objects.iter().flat_map(Object::world_positions).collect();
    let surroundings = SceneBounds::of(&positions)
        .ok_or_else(|| unusable("has no surface whose size is known: give a model with triangles"))?;
    if surroundings.extent() > MOST_EXTENT {
        return Err(unusable("is too large: scale it down"));
    }
    if surroundings.extent() < LEAST_EXTENT {
        return Err(unusable("is too small: scale it up"));
    }
    if floor {
        let mut names = ObjectNames::default();
        for object in &objects {
            names.take(&object.name);
        }
        objects.push(Object { name: names.take_like("floor"), ..floor_under(&surroundings)? });
    }
    Ok(Scene {
        name: name.to_owned(),
        ambient: AMBIENT,
        camera: surroundings.camera(&positions),
        lights: vec![surroundings.light()],
        objects,
        technique: None,
        not_taken: Vec::new(),
    })
}

/// Returns a square floor a little below the model, facing up. Its middle is under the model's own origin, as a model's
/// author sees it, or under the middle of its bounds where the origin lies outside them, as in scans, parts of
/// assemblies and places on a map: there the model's shadow would miss it.
fn floor_under(model: &SceneBounds) -> Result<Object, SceneError> {
    let DVec3 { x, z, .. } = if model.surrounds_origin() { DVec3::ZERO } else { model.middle() };
    let half = FLOOR_REACH * model.extent();
    let y = model.lowest() - FLOOR_GAP * model.extent();
    let corners = [[x - half, y, z + half], [x + half, y, z + half], [x + half, y, z - half], [x - half, y, z - half]];
    let builder = MeshBuilder {
        positions: corners.map(DVec3::from_array).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshBuilder::default()
    };
    let mesh = builder.build().map_err(|source| SceneError::Mesh { name: "floor".to_owned(), source })?;
    Ok(Object::new("floor", Arc::new(mesh), Material { color: WARM_GREY, ..Material::default() }))
}
