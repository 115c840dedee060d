//! The tree of a file's nodes, and their matrices.

use super::document::GltfResult;
use crate::scene::Pose;
use glam::{DMat4, DQuat, DVec3};
use gltf::json::{Index, Root, scene};

/// How far a pose may differ from the matrix that it is made from, as a part of its longest axis: the rounding of
/// single precision.
const BESIDE: f64 = 1e-6;

/// All nodes of a glTF file, with their matrices, and which are shown.
#[derive(Debug)]
pub struct GltfNodes {
    /// World space from the node's own, for each node.
    pub world: Vec<DMat4>,
    /// Parent of each node.
    pub parents: Vec<Option<usize>>,
    /// All nodes, each before its children.
    pub all: Vec<usize>,
    /// Nodes of the scene that is shown, each before its children.
    pub shown: Vec<usize>,
}

impl GltfNodes {
    /// Returns the nodes of the file, all placed in world space; shown are those of its default scene, else of its
    /// first scene, else all.
    ///
    /// # Errors
    /// Nodes that form no tree; numbers that are not finite.
    pub fn new(root: &Root) -> GltfResult<GltfNodes> {
        let count = root.nodes.len();
        let mut parents = vec![None; count];
        for (parent, node) in root.nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                let place = parents
                    .get_mut(child.value())
                    .ok_or("a node has a child that is missing: export the file again")?;
                if place.replace(parent).is_some() {
                    return Err(format!("node {} is a child of two nodes: export the file again", child.value()));
                }
            }
        }
        let roots: Vec<usize> = (0..count).filter(|node| parents[*node].is_none()).collect();
        let all = below(root, &roots);
        if all.len() < count {
            return Err("its nodes form a circle: export the file again".to_owned());
        }
        let mut world = vec![DMat4::IDENTITY; count];
        for node in all.iter().copied() {
            let above = parents[node].map_or(DMat4::IDENTITY, |parent| world[parent]);
            world[node] = above * local(&root.nodes[node]);
            if !world[node].is_finite() {
                return Err(format!("node {node} is at no place that numbers tell: export the file again"));
            }
        }
        let scene = root.scene.or((!root.scenes.is_empty()).then(|| Index::new(0)));
        let shown = match scene.and_then(|scene| root.get(scene)) {
            Some(scene) => below(root, &scene.nodes.iter().map(Index::value).collect::<Vec<_>>()),
            None => all.clone(),
        };
        Ok(GltfNodes { world, parents, all, shown })
    }
}

/// Returns these nodes and all below them, each once and after its parent; a missing node is left out.
fn below(root: &Root, from: &[usize]) -> Vec<usize> {
    let mut is_visited = vec![false; root.nodes.len()];
    let mut waiting: Vec<usize> = from.iter().rev().copied().collect();
    let mut found = Vec::new();
    while let Some(node) = waiting.pop() {
        let Some(known) = root.nodes.get(node).filter(|_| !std::mem::replace(&mut is_visited[node], true)) else {
            continue;
        };
        found.push(node);
        waiting.extend(known.children.iter().flatten().rev().map(Index::value));
    }
    found
}

/// Returns the transform from a node's own space to its parent's: its matrix, or else its scale, rotation and
/// translation.
fn local(node: &scene::Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let triple =
        |given: Option<[f32; 3]>, default: DVec3| given.map_or(default, |of| DVec3::from_array(of.map(f64::from)));
    let rotation = rotation_of(node);
    DMat4::from_scale_rotation_translation(
        triple(node.scale, DVec3::ONE),
        rotation,
        triple(node.translation, DVec3::ZERO),
    )
}

/// Returns the node's rotation, normalised.
pub fn rotation_of(node: &scene::Node) -> DQuat {
    node.rotation.map_or(DQuat::IDENTITY, |given| unit(given.0.map(f64::from)))
}

/// Returns the quaternion (x, y, z, w) scaled to unit length; one of zero, tiny or no finite length becomes no
/// rotation.
pub fn unit(given: [f64; 4]) -> DQuat {
    let turn = DQuat::from_array(given);
    let length = turn.length();
    if length.is_normal() { turn / length } else { DQuat::IDENTITY }
}

/// Returns the pose whose matrix is `world`; `None` where no pose has it: it mirrors, shears, or has no volume.
pub fn pose_of(world: &DMat4) -> Option<Pose> {
    if world.determinant() <= 0.0 {
        return None;
    }
    let (scale, rotation, translate) = world.to_scale_rotation_translation();
    let pose = Pose::of(scale, rotation, translate);
    let again = pose.world_from_object();
    let longest = scale.abs().max_element();
    let is_near = (0..3).all(|axis| (again.col(axis) - world.col(axis)).abs().max_element() <= BESIDE * longest);
    (is_near && pose.check().is_ok()).then_some(pose)
}
