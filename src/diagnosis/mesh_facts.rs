//! The properties of a mesh that matter for shadows.
//!
//! Edges of one triangle are sorted into those that look open only because vertices are split (another such edge lies
//! at the very same place, or within a millionth of the mesh's size) and those that are open.

use super::cause::Cause;
use super::{MeshDefect, MeshFinding};
use crate::geometry::{EdgeList, Topology, winding_number};
use crate::scene::{Mesh, Object};
use glam::{DVec3, DVec4};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Vertices nearer to each other than this, relative to the mesh's size, look like one vertex.
const NEAR: f64 = 1e-6;
/// Triangles that are this many times longer than high count as slivers.
const SLIVER: f64 = 1000.0;
/// The most places that a finding lists.
const MOST_PLACES: usize = 16;

/// Defects of one object's mesh that matter for shadows; places are in world space.
#[derive(Debug, Clone)]
pub(crate) struct MeshFacts {
    pub name: String,
    /// Middles of open edges beside which no other edge lies.
    pub open: Vec<DVec3>,
    /// Middles of open edges along which another open edge lies, bit for bit: the vertices are split.
    pub split: Vec<DVec3>,
    /// Middles of open edges along which another open edge lies within a millionth of the mesh's size.
    pub near: Vec<DVec3>,
    pub non_manifold: (usize, Vec<DVec3>),
    pub inconsistent: (usize, Vec<DVec3>),
    pub flat: (usize, Vec<DVec3>),
    pub dropped: usize,
    pub duplicates: Vec<DVec3>,
    pub slivers: Vec<DVec3>,
    /// Whether it is closed and consistently wound, but with its inside out.
    pub is_inside_out: bool,
    world: Arc<[DVec3]>,
    triangles: Arc<[[u32; 3]]>,
}

impl MeshFacts {
    /// Measures an object's mesh for defects: open, split, near, non-manifold and inconsistent edges, flat and dropped
    /// triangles, duplicates, slivers and whether a whole mesh is inside out. Places are in world space.
    pub fn new(object: &Object, edges: &EdgeList, topology: &Topology) -> MeshFacts {
        let mesh = &object.mesh;
        let world = object.world_positions();
        let [open, split, near] = sort_open_edges(mesh, &world, edges);
        let is_whole = open.is_empty() && topology.is_oriented() && topology.connectivity.non_manifold_edges.count == 0;
        let matrix = object.pose.world_from_object();
        let placed = |found: &crate::geometry::FoundPlaces| {
            (found.count, found.places.iter().map(|place| matrix.transform_point3(*place)).collect::<Vec<_>>())
        };
        let corners = |of: &[u32; 3]| of.map(|vertex| world[vertex as usize]);
        let middle = |of: &[u32; 3]| corners(of).iter().sum::<DVec3>() / 3.0;
        let volume: f64 = mesh
            .triangles()
            .iter()
            .map(corners)
            .map(|[a, b, c]| (a - world[0]).dot((b - world[0]).cross(c - world[0])))
            .sum();
        MeshFacts {
            name: object.name.clone(),
            is_inside_out: is_whole && !mesh.triangles().is_empty() && volume < 0.0,
            open,
            split,
            near,
            non_manifold: placed(&topology.connectivity.non_manifold_edges),
            inconsistent: placed(&topology.connectivity.inconsistent_edges),
            flat: placed(&topology.flat_triangles),
            dropped: topology.dropped_triangles,
            duplicates: duplicates(mesh).into_iter().map(|triangle| middle(&mesh.triangles()[triangle])).collect(),
            slivers: mesh.triangles().iter().filter(|of| is_sliver(corners(of))).map(middle).collect(),
            triangles: mesh.triangles().into(),
            world: world.into(),
        }
    }

    /// Returns the winding number of the mesh around a point light; `None` where that is 0, or the mesh has holes.
    pub fn winding_around(&self, light: DVec4) -> Option<i32> {
        let is_closed = self.open.is_empty() && self.non_manifold.0 == 0;
        let asks = light.w != 0.0 && is_closed && !self.triangles.is_empty();
        asks.then(|| winding_number(&self.world, &self.triangles, light.truncate() / light.w))
            .flatten()
            .filter(|winding| *winding != 0)
    }

    /// Returns the mesh's defects, with their effects on techniques. `lights` are homogeneous world positions.
    pub fn findings(&self, lights: &[DVec4]) -> Vec<MeshFinding> {
        let mut found = Vec::new();
        let mut report = |kind: MeshDefect, count: usize, at: &[DVec3], effect: &str| {
            if count > 0 {
                let at = at.iter().take(MOST_PLACES).copied().collect();
                found.push(MeshFinding { object: self.name.clone(), kind, count, at, effect: effect.to_owned() });
            }
        };
        let only_facing = "right with casters = all, which volumes cast with by default; with casters = light-facing";
        report(
            MeshDefect::Cause(Cause::OpenMesh),
            self.open.len(),
            &self.open,
            &format!(
                "the mesh has holes: {only_facing} it casts less than its shadow, and as a textbook has it, streaks"
            ),
        );
        report(
            MeshDefect::Cause(Cause::NonManifold),
            self.non_manifold.0,
            &self.non_manifold.1,
            &format!("edges of more than two triangles: {only_facing} silhouettes may not close"),
        );
        report(
            MeshDefect::Cause(Cause::InconsistentWinding),
            self.inconsistent.0 + usize::from(self.is_inside_out),
            &self.inconsistent.1,
            &format!("triangles disagree on which side is out, or face inwards: {only_facing} the wrong ones cast"),
        );
        report(
            MeshDefect::Cause(Cause::SplitVertices),
            self.split.len(),
            &self.split,
            "equal positions under different indices: welded, the mesh is whole along these edges",
        );
        report(
            MeshDefect::Cause(Cause::NearVertices),
            self.near.len(),
            &self.near,
            &format!("edges a hair apart: {only_facing} the mesh counts as open there. Welding would move the surface"),
        );
        let inside = lights.iter().filter(|light| self.winding_around(**light).is_some());
        let inside: Vec<DVec3> = inside.map(|light| light.truncate() / light.w).collect();
        report(
            MeshDefect::Cause(Cause::LightInside),
            inside.len(),
            &inside,
            &format!("a light is inside: {only_facing} nothing that should cast faces it"),
        );
        report(
            MeshDefect::FlatTriangles,
            self.flat.0,
            &self.flat.1,
            "triangles without area cast nothing, and are no harm",
        );
        report(
            MeshDefect::DroppedTriangles,
            self.dropped,
            &[],
            "triangles with two equal corners were left out, and are no harm",
        );
        report(
            MeshDefect::DuplicateTriangles,
            self.duplicates.len(),
            &self.duplicates,
            "the same triangle more than once: volumes count it as often, and reach the 255 of eight bits sooner",
        );
        report(
            MeshDefect::Slivers,
            self.slivers.len(),
            &self.slivers,
            "triangles a thousand times longer than high: volumes are right with them, maps and textures may lose them",
        );
        found
    }
}

/// Returns the world-space middles of the edges that have one triangle, in three lists: open; split (another such edge
/// has its ends at the same positions); near (another's ends are within a small part of the mesh's size).
fn sort_open_edges(mesh: &Mesh, world: &[DVec3], edges: &EdgeList) -> [Vec<DVec3>; 3] {
    let positions = mesh.positions();
    let lone: Vec<[u32; 2]> = (0..edges.edges().len())
        .filter(|edge| edges.incident(*edge).count() == 1)
        .map(|edge| [edges.edges()[edge].low, edges.edges()[edge].high])
        .collect();
    let size = mesh.bounds().map_or(0.0, |(low, high)| (high - low).length());
    let near = (size * NEAR).max(f64::MIN_POSITIVE);
    let middle = |[a, b]: [u32; 2]| (positions[a as usize] + positions[b as usize]) / 2.0;
    let cell = |point: DVec3| (point / (4.0 * near)).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (index, edge) in lone.iter().enumerate() {
        cells.entry(cell(middle(*edge))).or_default().push(index);
    }
    // The largest distance of ends, in whichever direction the edges match better.
    let apart = |[a, b]: [u32; 2], [c, d]: [u32; 2]| {
        let far = |p: u32, q: u32| positions[p as usize].distance(positions[q as usize]);
        far(a, c).max(far(b, d)).min(far(a, d).max(far(b, c)))
    };
    let mut sorted = [Vec::new(), Vec::new(), Vec::new()];
    for (index, edge) in lone.iter().enumerate() {
        let [low, high] = [middle(*edge) - near, middle(*edge) + near].map(cell);
        let mut least = f64::INFINITY;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let others = cells.get(&[x, y, z]).into_iter().flatten().filter(|other| **other != index);
                    least = others.map(|other| apart(*edge, lone[*other])).fold(least, f64::min);
                }
            }
        }
        let which = if least == 0.0 { 1 } else { usize::from(least <= near) * 2 };
        sorted[which].push((world[edge[0] as usize] + world[edge[1] as usize]) / 2.0);
    }
    sorted
}

/// Returns the indices of triangles that have the same vertex indices, in any order, as an earlier one; the first of
/// each is left out.
fn duplicates(mesh: &Mesh) -> Vec<usize> {
    let mut seen = BTreeMap::new();
    let mut found = Vec::new();
    for (index, corners) in mesh.triangles().iter().enumerate() {
        let mut key = *corners;
        key.sort_unstable();
        if seen.insert(key, index).is_some() {
            found.push(index);
        }
    }
    found
}

fn is_sliver([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let twice_area = (b - a).cross(c - a).length();
    twice_area > 0.0 && longest * longest > SLIVER * twice_area
}
