//! What geometry is worth keeping between plans: edge lists, by the mesh's content.

use super::EdgeList;
use crate::scene::Mesh;
use std::collections::HashMap;
use std::sync::Arc;

/// Edge lists kept at once; a scene of more meshes starts over.
const MOST_KEPT: usize = 256;

/// Edge lists of the meshes planned so far. Planning with a full or an empty cache gives the same
/// plan.
#[derive(Debug, Default)]
pub struct GeometryCache {
    edges: HashMap<u64, Arc<EdgeList>>,
}

impl GeometryCache {
    /// The edges of `mesh`, built on first use.
    pub fn edges(&mut self, mesh: &Mesh) -> Arc<EdgeList> {
        if self.edges.len() >= MOST_KEPT && !self.edges.contains_key(&mesh.content_hash()) {
            self.edges.clear();
        }
        let build = || Arc::new(EdgeList::new(mesh.triangles(), mesh.positions().len()));
        self.edges.entry(mesh.content_hash()).or_insert_with(build).clone()
    }
}
