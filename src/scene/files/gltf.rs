//! glTF 2.0 scenes (`.gltf`, `.glb`): meshes, materials, lights, the first camera, and rotations.
//!
//! [`load`] reads the file's JSON and buffers (`document`), places its nodes in double precision (`nodes`) and makes
//! one object of every node with a mesh: at a pose where the node's matrix is one, else with its vertices in world
//! space, as those of skins always are. Content that is not shown is listed ([`Unsupported`]), not dropped in silence.
//!
//! A scene file names one mesh of it by a JSON pointer: `model.glb#/meshes/2`, in its own space, or
//! `model.glb#/nodes/5`, in world space.

mod accessor;
mod document;
mod lights;
mod materials;
mod meshes;
mod motion;
mod nodes;

pub use document::files_of;

use super::read_text::{quoted, stem};
use crate::scene::camera::placement::SceneBounds;
use crate::scene::names::ObjectNames;
use crate::scene::not_taken::{Unsupported, UnsupportedList};
use crate::scene::picture::ImageLoader;
use crate::scene::{Camera, Light, Material, Mesh, Motion, Object, SceneError, Shading};
use document::{GltfDocument, GltfResult};
use glam::{DMat4, DVec3};
use gltf::json::{Index, mesh};
use materials::GltfMaterials;
use meshes::{GltfMeshes, VertexTransform};
use motion::NodeRotations;
use nodes::GltfNodes;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// The most vertices of all objects together, each instance counted: each has its own position in every frame.
const MOST_VERTICES: usize = 1 << 23;

/// The content of a glTF file, as objects, lights and camera of a scene.
#[derive(Debug)]
pub struct LoadedGltf {
    /// Objects in the order of the file's tree.
    pub objects: Vec<Object>,
    /// JSON pointer of each object's mesh: `/meshes/2`.
    pub pointers: Vec<String>,
    /// Lights; empty where the file has none.
    pub lights: Vec<Light>,
    /// The first of the file's cameras.
    pub camera: Option<Camera>,
    /// Content that is not shown.
    pub not_taken: Vec<Unsupported>,
}

/// Returns a name of the file's as it can be shown and written to other files: in one line, at most 80 characters,
/// trimmed. `otherwise` gives one where it has none or it is blank.
fn named(given: Option<&str>, otherwise: impl FnOnce() -> String) -> String {
    const MOST: usize = 80;
    let plain: String =
        given.unwrap_or_default().chars().take(MOST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if plain.trim().is_empty() { otherwise() } else { plain.trim().to_owned() }
}

/// Reads a glTF file (.gltf or .glb) with its buffers and pictures.
pub fn load(file: &Path) -> Result<LoadedGltf, SceneError> {
    let document = GltfDocument::open(file)?;
    read(&document, file).map_err(|reason| SceneError::Read { file: file.to_owned(), reason })
}

/// A file that was opened for one of its meshes, and may be read again for another.
#[derive(Debug)]
pub(in crate::scene) struct OpenedGltf {
    document: GltfDocument,
    nodes: GltfNodes,
}

/// Reads one mesh of a file among others, which share the budget for pictures; the file's only mesh without a pointer.
/// `last` is the file that was opened last.
pub(in crate::scene) fn load_mesh(
    file: &Path,
    pointer: Option<&str>,
    pictures: &mut ImageLoader,
    last: &mut Option<OpenedGltf>,
) -> Result<Mesh, SceneError> {
    let failed = |reason: String| SceneError::Read { file: file.to_owned(), reason };
    let opened = match last.take().filter(|opened| opened.document.file == file) {
        Some(opened) => opened,
        None => {
            let document = GltfDocument::open(file)?;
            let nodes = GltfNodes::new(&document.root).map_err(failed)?;
            OpenedGltf { document, nodes }
        }
    };
    let OpenedGltf { document, nodes } = last.insert(opened);
    mesh_at(document, nodes, pointer, pictures).map_err(failed)
}

fn mesh_at(
    document: &GltfDocument,
    nodes: &GltfNodes,
    pointer: Option<&str>,
    pictures: &mut ImageLoader,
) -> GltfResult<Mesh> {
    let root = &document.root;
    let no_such = || {
        let (meshes, nodes) = (root.meshes.len(), root.nodes.len());
        let pointer = pointer.map_or_else(|| "a bare name".to_owned(), quoted);
        format!("has {meshes} meshes and {nodes} nodes, and {pointer} names none: write #/meshes/0 behind the file")
    };
    let number = |pointer: &str, kind: &str| pointer.strip_prefix(kind)?.parse::<u32>().ok();
    let mut meshes = GltfMeshes::new(document, GltfMaterials::new(document, pictures));
    let mesh = match pointer {
        None if root.meshes.len() == 1 => meshes.mesh(Index::new(0), VertexTransform::AsFile)?,
        None => return Err(no_such()),
        Some(pointer) => match (number(pointer, "/meshes/"), number(pointer, "/nodes/")) {
            (Some(mesh), _) if (mesh as usize) < root.meshes.len() => {
                meshes.mesh(Index::new(mesh), VertexTransform::AsFile)?
            }
            (_, Some(node)) if (node as usize) < root.nodes.len() => {
                let node = node as usize;
                let mesh = root.nodes[node].mesh.ok_or_else(|| format!("has no mesh at node {node}: name another"))?;
                if is_flat(document, nodes, node) {
                    return Err(format!("has a scale of zero at node {node}: it is flat"));
                }
                in_world(document, nodes, &mut meshes, node, mesh)?
            }
            _ => return Err(no_such()),
        },
    };
    match (mesh.triangles().is_empty(), mesh.not_taken().first()) {
        (false, _) => Ok(mesh),
        (true, Some(Unsupported { what, because })) => Err(format!("has no triangles there ({what}: {because})")),
        (true, None) => Err("has no triangle with three different corners there: name another mesh".to_owned()),
    }
}

/// Returns whether a node without a skin has no volume.
fn is_flat(document: &GltfDocument, nodes: &GltfNodes, node: usize) -> bool {
    document.root.nodes[node].skin.is_none() && nodes.world[node].determinant() == 0.0
}

fn read(document: &GltfDocument, file: &Path) -> GltfResult<LoadedGltf> {
    let root = &document.root;
    let nodes = GltfNodes::new(root)?;
    let mut refusals = UnsupportedList::default();
    let mut pictures = ImageLoader::default();
    let mut meshes = GltfMeshes::new(document, GltfMaterials::new(document, &mut pictures));
    let turns = NodeRotations::new(document, &nodes, &mut refusals);
    let mut known: BTreeMap<usize, Arc<Mesh>> = BTreeMap::new();
    let mut vertices = 0;
    let (mut names, mut objects, mut pointers) = (ObjectNames::default(), Vec::new(), Vec::new());
    for node in nodes.shown.iter().copied() {
        let given = &root.nodes[node];
        let Some(index) = given.mesh else { continue };
        let of_mesh = root.get(index).and_then(|mesh| mesh.name.as_deref());
        let name = named(given.name.as_deref().or(of_mesh), || format!("node {node}"));
        if is_flat(document, &nodes, node) {
            refusals.refuse(quoted(&name), "its scale is zero: it is flat");
            continue;
        }
        let pose = if given.skin.is_none() { nodes::pose_of(&nodes.world[node]) } else { None };
        let (mesh, pointer) = match (pose, known.get(&index.value())) {
            (Some(_), Some(mesh)) => (Arc::clone(mesh), format!("/meshes/{}", index.value())),
            (Some(_), None) => {
                let mesh = Arc::new(meshes.mesh(index, VertexTransform::AsFile)?);
                known.insert(index.value(), Arc::clone(&mesh));
                (mesh, format!("/meshes/{}", index.value()))
            }
            (None, _) => (Arc::new(in_world(document, &nodes, &mut meshes, node, index)?), format!("/nodes/{node}")),
        };
        if mesh.triangles().is_empty() {
            let failed = mesh.not_taken().first().map(|one| format!("{}: {}", one.what, one.because));
            let because = failed.unwrap_or_else(|| "it has no triangle with three different corners".to_owned());
            refusals.refuse(quoted(&name), because);
            continue;
        }
        vertices += mesh.positions().len();
        if vertices > MOST_VERTICES {
            return Err(format!("has more than {MOST_VERTICES} vertices, those of all its instances: leave some out"));
        }
        if given.skin.is_some() {
            refusals.refuse(format!("the bones of {}", quoted(&name)), "it stands as they do at rest");
        }
        let shading = if mesh.corner_normals().is_some() { Shading::Phong } else { Shading::Flat };
        let material = Material { shading, ..Material::default() };
        let mut object = Object::new(names.take_like(&name), mesh, material);
        object.pose = pose.unwrap_or_default();
        let motion = match &pose {
            Some(pose) => turns.of_object(&nodes, node, pose),
            // A mesh in world space can't be rotated by its pose.
            None if turns.moves(node) => {
                Err("it is skinned, sheared or mirrored: it stands as at the start".to_owned())
            }
            None => Ok(Motion::default()),
        };
        match motion {
            Ok(motion) => object.motion = motion,
            Err(why) => refusals.refuse(format!("the turn of {}", quoted(&name)), why),
        }
        objects.push(object);
        pointers.push(pointer);
    }
    let points: Vec<DVec3> = objects.iter().flat_map(Object::world_positions).collect();
    let around = SceneBounds::of(&points).ok_or("has no triangles to show: export a model with a surface")?;
    if !points.iter().all(|point| point.is_finite()) {
        return Err("has corners where numbers end: scale it down".to_owned());
    }
    let camera = lights::camera(root, &nodes, &around, &mut refusals);
    if let Some(eye) = camera.as_ref().filter(|eye| turns.moves(eye.node)) {
        refusals.refuse(format!("the turn of the camera on node {}", eye.node), "the eye stands as at the start");
    }
    let mut lights = lights::lights(root, &nodes, &around, &mut refusals);
    for light in &mut lights {
        match turns.of_light(light.node) {
            Ok(motion) => light.it.motion = motion,
            Err(why) => refusals.refuse(format!("the turn of the light on node {}", light.node), why),
        }
    }
    let scenes = root.scenes.len();
    if scenes > 1 {
        refusals.refuse(format!("{} other scenes of {}", scenes - 1, quoted(&stem(file))), "one is shown");
    }
    for extension in root.extensions_used.iter().filter(|name| !document::is_done(name)) {
        refusals.refuse(quoted(extension), "this extension is not done");
    }
    let lights = lights.into_iter().map(|light| light.it).collect();
    Ok(LoadedGltf { objects, pointers, lights, camera: camera.map(|eye| eye.it), not_taken: refusals.into_list() })
}

/// Returns the mesh of a node in world space: moved by the joints of its skin, if it has one, otherwise by the node's
/// matrix.
fn in_world(
    document: &GltfDocument,
    nodes: &GltfNodes,
    meshes: &mut GltfMeshes,
    node: usize,
    index: Index<mesh::Mesh>,
) -> GltfResult<Mesh> {
    let root = &document.root;
    let Some(skin) = root.nodes[node].skin.and_then(|skin| root.get(skin)) else {
        return meshes.mesh(index, VertexTransform::Placed(&nodes.world[node]));
    };
    let inverse = match skin.inverse_bind_matrices {
        Some(index) => document.numbers::<16>(index)?,
        None => Rc::default(),
    };
    let inverse = inverse.as_chunks::<16>().0;
    if skin.inverse_bind_matrices.is_some() && inverse.len() < skin.joints.len() {
        return Err("a skin has fewer matrices than joints: export the file again".to_owned());
    }
    let of_joint = |(at, joint): (usize, &Index<gltf::json::Node>)| {
        let world = nodes.world.get(joint.value()).copied().unwrap_or(DMat4::IDENTITY);
        inverse.get(at).map_or(world, |inverse| world * DMat4::from_cols_array(inverse))
    };
    let joints: Vec<DMat4> = skin.joints.iter().enumerate().map(of_joint).collect();
    meshes.mesh(index, VertexTransform::Skinned(&joints))
}

/// Returns the meshes of a glTF file as its scene has them, each once with the pointer that names it, sorted by
/// pointer; empty where the file can't be read.
pub fn named_meshes(file: &Path) -> Vec<(Arc<Mesh>, String)> {
    let Ok(loaded) = load(file) else { return Vec::new() };
    let all = loaded.pointers.into_iter().zip(loaded.objects.into_iter().map(|object| object.mesh));
    all.collect::<BTreeMap<String, Arc<Mesh>>>().into_iter().map(|(pointer, mesh)| (mesh, pointer)).collect()
}
