//! The topology of each object's mesh (closed, open, non-manifold), in a line, and how that affects which technique.

use crate::geometry::Topology;
use crate::reading::format;
use crate::scene::{MaterialTexture, Object};
use std::sync::Arc;

/// An object of the open scene with its mesh's topology.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectMesh {
    /// The object's name.
    pub object: String,
    /// The topology of its mesh.
    pub topology: Arc<Topology>,
}

/// Returns a line for each texture on an object: its name, its size, and how it is mapped; the same line once where
/// groups in sequence have it. Empty without textures.
pub fn pictures(object: &Object) -> Vec<String> {
    let line = |texture: &MaterialTexture| {
        let [width, height] = texture.picture.size();
        let lies =
            texture.side.map_or_else(|| "as its corners say".to_owned(), |side| format!("{side} m along X and Z"));
        let clamps = if texture.clamps { ", clamped" } else { "" };
        format!("shows {}, {width}×{height}, {lies}{clamps}", texture.picture.name())
    };
    let mut lines: Vec<String> =
        object.mesh.groups().iter().filter_map(|group| object.texture_of(group)).map(line).collect();
    lines.dedup();
    lines
}

/// Returns whether a mesh has none of the defects that [`line()`] lists.
pub fn is_whole(topology: &Topology) -> bool {
    findings(topology).is_empty()
}

/// Returns the mesh's defects with their counts as text, separated by commas, after `closed` where the mesh is closed;
/// empty where it is neither closed nor has defects.
pub fn line(topology: &Topology) -> String {
    let mut parts: Vec<String> = findings(topology).into_iter().map(|(text, _)| text).collect();
    if topology.is_closed() {
        parts.insert(0, "closed".to_owned());
    }
    parts.join(", ")
}

/// Returns paragraphs separated by blank lines: first what a closed, consistently wound mesh allows, where it is one,
/// then for each defect which techniques it affects, and how. Empty where there is nothing to say.
pub fn effects(topology: &Topology) -> String {
    let mut paragraphs: Vec<&str> = findings(topology).into_iter().map(|(_, effect)| effect).collect();
    if topology.is_closed() && topology.is_oriented() {
        paragraphs.insert(
            0,
            "Closed and consistently wound: under casters = by-topology the triangles that face the light may do for \
             the whole volume, and a shadow map may cull either side.",
        );
    }
    paragraphs.join("\n\n")
}

/// Returns each kind of defect that a mesh has, as text with its count, and its effect on techniques; empty where it
/// has none.
fn findings(topology: &Topology) -> Vec<(String, &'static str)> {
    let edges = |count: usize, kind: &str| format::counted(count as u64, &format!("{kind} edge"));
    let all = [
        (
            topology.connectivity.open_edges.count,
            edges(topology.connectivity.open_edges.count, "open"),
            "Open edges end the surface. Volumes under casters = all are right all the same, and by-topology falls back \
             on them. Under light-facing, triangles that face away and have nothing before them cast nothing; under \
             light-back-facing, those that face the light. A shadow map that culls loses them likewise.",
        ),
        (
            topology.connectivity.non_manifold_edges.count,
            edges(topology.connectivity.non_manifold_edges.count, "non-manifold"),
            "Non-manifold edges join more than two triangles. Volumes count each edge as often as its triangles \
             demand, so casters = all is right, and by-topology falls back on it. Under light-facing what lies \
             double counts double.",
        ),
        (
            topology.connectivity.inconsistent_edges.count,
            edges(topology.connectivity.inconsistent_edges.count, "inconsistently wound"),
            "Neighbours disagree on which side is out. Volumes under casters = all do not care. Under light-facing, or \
             in a shadow map that culls, the turned triangles are taken for the other side and go missing.",
        ),
        (
            topology.split_vertices.count,
            format::counted(topology.split_vertices.count as u64, "split vertex pair"),
            "Vertices that nearly coincide leave slits: the edges between them are open, though nobody sees it. No \
             technique fixes that; by-topology takes the mesh for open.",
        ),
        (
            topology.flat_triangles.count,
            format::counted(topology.flat_triangles.count as u64, "flat triangle"),
            "Triangles without area cast nothing and are seen by nobody.",
        ),
        (
            topology.dropped_triangles,
            format!("{} left out", format::counted(topology.dropped_triangles as u64, "triangle")),
            "Triangles with two equal corners were left out when the mesh was loaded.",
        ),
    ];
    all.into_iter().filter(|(count, ..)| *count > 0).map(|(_, text, effect)| (text, effect)).collect()
}
