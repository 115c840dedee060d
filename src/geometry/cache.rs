//! What geometry is worth keeping between plans: edge lists, by the mesh's content.

use super::EdgeList;
use super::planar::Flattened;
use crate::scene::Mesh;
use glam::DVec4;
use std::collections::HashMap;
use std::sync::Arc;

/// Edge lists kept at once; a scene of more meshes starts over.
const MOST_KEPT: usize = 256;

/// Edge lists of the meshes planned so far. Planning with a full or an empty cache gives the same
/// plan.
#[derive(Debug, Default)]
pub struct GeometryCache {
    edges: HashMap<u64, Arc<EdgeList>>,
    /// By their keys, with whether the newest plan has asked for them.
    flattened: HashMap<u64, (Arc<Vec<[DVec4; 3]>>, bool)>,
}

impl GeometryCache {
    /// Forgets flattened casters that the last plan did not ask for.
    pub fn next_plan(&mut self) {
        self.flattened.retain(|_, (_, used)| std::mem::take(used));
    }

    /// A flattened caster: made again only if plane, caster or light changed.
    pub fn flattened(&mut self, what: &Flattened, make: impl FnOnce() -> Vec<[DVec4; 3]>) -> Arc<Vec<[DVec4; 3]>> {
        let (triangles, used) = self.flattened.entry(what.key()).or_insert_with(|| (Arc::new(make()), true));
        *used = true;
        triangles.clone()
    }

    /// The edges of `mesh`, built on first use.
    pub fn edges(&mut self, mesh: &Mesh) -> Arc<EdgeList> {
        if self.edges.len() >= MOST_KEPT && !self.edges.contains_key(&mesh.content_hash()) {
            self.edges.clear();
        }
        let build = || Arc::new(EdgeList::new(mesh.triangles(), mesh.positions().len()));
        self.edges.entry(mesh.content_hash()).or_insert_with(build).clone()
    }
}
