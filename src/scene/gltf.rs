//! glTF 2.0 scenes (`.gltf`, `.glb`): meshes, materials, lights, the first camera, and turns.
//!
//! [`load`] reads the file's JSON and buffers (`document`), places its nodes in double precision (`nodes`) and makes one
//! object of every node with a mesh: at a pose where the node's place is one, else with its vertices in world space, as
//! those of skins always are. What the file holds and nothing here shows is a list ([`NotTaken`]), not silence.
//!
//! A scene file names one mesh of it by a JSON pointer: `model.glb#/meshes/2`, in its own space, or `model.glb#/nodes/5`, in
//! world space.

mod accessor;
mod document;
mod lights;
mod materials;
mod meshes;
mod motion;
mod nodes;

pub use document::files_of;

use super::names::Names;
use super::not_taken::{NotTaken, Refusals};
use super::picture::Pictures;
use super::placement::Surroundings;
use super::read_text::{quoted, stem};
use super::{Camera, Light, Material, Mesh, Object, SceneError, Shading};
use document::{Document, Told};
use glam::{DMat4, DVec3};
use gltf::json::{Index, mesh};
use materials::Materials;
use meshes::{Form, Meshes};
use nodes::Nodes;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// What a file says.
#[derive(Debug)]
pub struct Loaded {
    /// In the order of the file's tree.
    pub objects: Vec<Object>,
    /// The part of the file that is each object's mesh: `/meshes/2`.
    pub pointers: Vec<String>,
    /// Empty where the file has none.
    pub lights: Vec<Light>,
    /// The first of the file's.
    pub camera: Option<Camera>,
    /// What else it holds.
    pub not_taken: Vec<NotTaken>,
}

/// A name of the file as people and other files can have it: in one line, and not too long.
fn named(given: Option<&str>, otherwise: impl FnOnce() -> String) -> String {
    const MOST: usize = 80;
    let plain: String =
        given.unwrap_or_default().chars().take(MOST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if plain.trim().is_empty() { otherwise() } else { plain.trim().to_owned() }
}

/// Reads a file.
///
/// # Errors
/// A file that can't be read, that breaks the format's rules, that needs what is not done or has nothing to show.
pub fn load(file: &Path) -> Result<Loaded, SceneError> {
    let document = Document::open(file)?;
    read(&document, file).map_err(|reason| SceneError::Read { file: file.to_owned(), reason })
}

/// One mesh of a file among others, which share what room pictures have; the file's only one without a pointer.
///
/// # Errors
/// As [`load`]; a pointer to nothing.
pub(in crate::scene) fn load_mesh(
    file: &Path,
    pointer: Option<&str>,
    pictures: &mut Pictures,
) -> Result<Mesh, SceneError> {
    let document = Document::open(file)?;
    let told = |reason: String| SceneError::Read { file: file.to_owned(), reason };
    let root = &document.root;
    let no_such = || {
        let (meshes, nodes) = (root.meshes.len(), root.nodes.len());
        let pointer = pointer.map_or_else(|| "a bare name".to_owned(), quoted);
        told(format!(
            "has {meshes} meshes and {nodes} nodes, and {pointer} names none: write #/meshes/0 or #/nodes/0 behind the file"
        ))
    };
    let number = |pointer: &str, kind: &str| pointer.strip_prefix(kind)?.parse::<u32>().ok();
    let mut meshes = Meshes::new(&document, Materials::new(&document, pictures));
    match pointer {
        None if root.meshes.len() == 1 => meshes.mesh(Index::new(0), Form::AsFile).map_err(told),
        None => Err(no_such()),
        Some(pointer) => match (number(pointer, "/meshes/"), number(pointer, "/nodes/")) {
            (Some(mesh), _) if (mesh as usize) < root.meshes.len() => {
                meshes.mesh(Index::new(mesh), Form::AsFile).map_err(told)
            }
            (_, Some(node)) if (node as usize) < root.nodes.len() => {
                let nodes = Nodes::new(root).map_err(told)?;
                let mesh = root.nodes[node as usize].mesh.ok_or_else(no_such)?;
                in_world(&document, &nodes, &mut meshes, node as usize, mesh).map_err(told)
            }
            _ => Err(no_such()),
        },
    }
}

fn read(document: &Document, file: &Path) -> Told<Loaded> {
    let root = &document.root;
    let nodes = Nodes::new(root)?;
    let mut refusals = Refusals::default();
    let mut pictures = Pictures::default();
    let mut meshes = Meshes::new(document, Materials::new(document, &mut pictures));
    let turns = motion::turns(document, &nodes, &mut refusals);
    let mut known: BTreeMap<usize, Arc<Mesh>> = BTreeMap::new();
    let (mut names, mut objects, mut pointers) = (Names::default(), Vec::new(), Vec::new());
    for node in nodes.shown.iter().copied() {
        let given = &root.nodes[node];
        let Some(index) = given.mesh else { continue };
        let of_mesh = root.get(index).and_then(|mesh| mesh.name.as_deref());
        let name = named(given.name.as_deref().or(of_mesh), || format!("node {node}"));
        let world = &nodes.world[node];
        if given.skin.is_none() && world.determinant() == 0.0 {
            refusals.refuse(quoted(&name), "its scale is zero: it is flat");
            continue;
        }
        let pose = if given.skin.is_none() { nodes::pose_of(world) } else { None };
        let (mesh, pointer) = match (pose, known.get(&index.value())) {
            (Some(_), Some(mesh)) => (Arc::clone(mesh), format!("/meshes/{}", index.value())),
            (Some(_), None) => {
                let mesh = Arc::new(meshes.mesh(index, Form::AsFile)?);
                known.insert(index.value(), Arc::clone(&mesh));
                (mesh, format!("/meshes/{}", index.value()))
            }
            (None, _) => (Arc::new(in_world(document, &nodes, &mut meshes, node, index)?), format!("/nodes/{node}")),
        };
        if mesh.triangles().is_empty() {
            refusals.refuse(quoted(&name), "it has no triangle with three different corners");
            continue;
        }
        if given.skin.is_some() {
            refusals.refuse(format!("the bones of {}", quoted(&name)), "it stands as they do at rest");
        }
        let shading = if mesh.corner_normals().is_some() { Shading::Phong } else { Shading::Flat };
        let material = Material { shading, ..Material::default() };
        let mut object = Object::new(names.take_like(&name), mesh, material);
        object.pose = pose.unwrap_or_default();
        match motion::motion_of(&turns, &nodes, node, pose.as_ref()) {
            // What stands in world space can't be turned by its pose.
            Ok(motion) if pose.is_some() || motion.is_still() => object.motion = motion,
            Ok(_) => refusals.refuse(
                format!("the turn of {}", quoted(&name)),
                "it is skinned, sheared or mirrored: it stands as at the start",
            ),
            Err(why) => refusals.refuse(format!("the turn of {}", quoted(&name)), why),
        }
        objects.push(object);
        pointers.push(pointer);
    }
    let points: Vec<DVec3> = objects.iter().flat_map(Object::world_positions).collect();
    let around = Surroundings::of(&points).ok_or("has no triangles to show: export a model with a surface")?;
    if !points.iter().all(|point| point.is_finite()) {
        return Err("has corners where numbers end: scale it down".to_owned());
    }
    let camera = lights::camera(root, &nodes, &around, &mut refusals);
    let mut lights = lights::lights(root, &nodes, &around, &mut refusals);
    for light in &mut lights {
        match motion::motion_of(&turns, &nodes, light.node, None) {
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
    Ok(Loaded { objects, pointers, lights, camera, not_taken: refusals.into_list() })
}

/// The mesh of a node in world space: with its skin, or where the node is.
fn in_world(
    document: &Document,
    nodes: &Nodes,
    meshes: &mut Meshes,
    node: usize,
    index: Index<mesh::Mesh>,
) -> Told<Mesh> {
    let root = &document.root;
    let Some(skin) = root.nodes[node].skin.and_then(|skin| root.get(skin)) else {
        return meshes.mesh(index, Form::Placed(&nodes.world[node]));
    };
    let inverse = match skin.inverse_bind_matrices {
        Some(index) => document.numbers::<16>(index)?,
        None => Vec::new(),
    };
    if skin.inverse_bind_matrices.is_some() && inverse.len() < skin.joints.len() {
        return Err("a skin has fewer matrices than joints: export the file again".to_owned());
    }
    let of_joint = |(at, joint): (usize, &Index<gltf::json::Node>)| {
        let world = nodes.world.get(joint.value()).copied().unwrap_or(DMat4::IDENTITY);
        inverse.get(at).map_or(world, |inverse| world * DMat4::from_cols_array(inverse))
    };
    let joints: Vec<DMat4> = skin.joints.iter().enumerate().map(of_joint).collect();
    meshes.mesh(index, Form::Skinned(&joints))
}

/// The meshes of a file as its scene has them, each with the pointer that names it.
pub fn named_meshes(file: &Path) -> Vec<(Arc<Mesh>, String)> {
    let Ok(loaded) = load(file) else { return Vec::new() };
    let all = loaded.pointers.into_iter().zip(loaded.objects.into_iter().map(|object| object.mesh));
    all.collect::<BTreeMap<String, Arc<Mesh>>>().into_iter().map(|(pointer, mesh)| (mesh, pointer)).collect()
}
