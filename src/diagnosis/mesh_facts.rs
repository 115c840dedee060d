//! The properties of a mesh that matter for shadows.
//!
//! Edges of one triangle are sorted into those that look open only because vertices are split (another such edge lies
//! at the very same place, or within a millionth of the mesh's size) and those that are open.

use super::cause::Cause;
use super::{MeshDefect, MeshFinding};
use crate::geometry::{Edge, EdgeList, Topology, winding_number};
use crate::scene::{Mesh, Object};
use glam::{DVec3, DVec4};
use std::collections::{BTreeMap, BTreeSet, HashMap};
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
    edges: Arc<EdgeList>,
    /// What the edges of one triangle are, by their indices.
    lone: BTreeMap<usize, LoneEdge>,
}

/// What an edge of one triangle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LoneEdge {
    /// No other edge lies beside it.
    Open,
    /// Another such edge has its ends at the very same positions.
    Split,
    /// Another such edge has its ends within a small part of the mesh's size.
    Near,
}

/// A part of a mesh whose triangles are connected by edges of two triangles that agree on which side is out: how often
/// it ends, and at what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct WoundPart {
    /// Edges of one triangle, by what they are.
    pub open: usize,
    pub split: usize,
    pub near: usize,
    /// Edges of more than two triangles.
    pub non_manifold: usize,
    /// Edges of two triangles that disagree on which side is out.
    pub inconsistent: usize,
    /// Whether it ends nowhere and faces inwards.
    pub is_inside_out: bool,
}

/// Returns the number of edges in which two triangles meet, and whose corners the mesh's file splits, so that by its
/// numbers each triangle has an edge of its own.
pub(crate) fn split_edges(mesh: &Mesh) -> usize {
    let mut by_position: HashMap<[u32; 2], BTreeSet<[u32; 2]>> = HashMap::new();
    let ordered = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    for (of_mesh, of_file) in mesh.triangles().iter().zip(mesh.file_corners()) {
        for side in 0..3 {
            let edge = |corners: &[u32; 3]| ordered([corners[side], corners[(side + 1) % 3]]);
            by_position.entry(edge(of_mesh)).or_default().insert(edge(of_file));
        }
    }
    by_position.values().filter(|of_file| of_file.len() > 1).count()
}

/// How far from an edge a corner lies on it, in lengths of the edge.
const ON_EDGE: f64 = 1e-6;
/// The most edges of one triangle, and the most of their corners, that are looked through for T-junctions.
const MOST_LONE: usize = 4096;

/// Returns the corners, object space, that lie between the ends of another triangle's edge: where triangles meet in part
/// of an edge. Only edges of one triangle are looked at, the first few thousand.
pub(crate) fn t_junctions(mesh: &Mesh) -> Vec<DVec3> {
    let edges = EdgeList::new(mesh.triangles(), mesh.positions().len());
    let lone = (0..edges.edges().len()).filter(|index| edges.incident(*index).count() == 1).take(MOST_LONE);
    let lone: Vec<Edge> = lone.map(|index| edges.edges()[index]).collect();
    let corners: BTreeSet<u32> = lone.iter().flat_map(|edge| [edge.low, edge.high]).take(MOST_LONE).collect();
    let place = |corner: u32| mesh.positions()[corner as usize];
    let is_on = |corner: u32, edge: &Edge| {
        let (from, along) = (place(edge.low), place(edge.high) - place(edge.low));
        let part = (place(corner) - from).dot(along) / along.length_squared();
        let beside = (place(corner) - from - along * part).length();
        (ON_EDGE..=1.0 - ON_EDGE).contains(&part) && beside <= ON_EDGE * along.length()
    };
    let lies_on_one = |corner: &u32| lone.iter().any(|edge| is_on(*corner, edge));
    corners.into_iter().filter(lies_on_one).map(place).collect()
}

impl MeshFacts {
    /// Measures an object's mesh for defects: open, split, near, non-manifold and inconsistent edges, flat and dropped
    /// triangles, duplicates, slivers and whether a whole mesh is inside out. Places are in world space.
    pub fn new(object: &Object, edges: Arc<EdgeList>, topology: &Topology) -> MeshFacts {
        let mesh = &object.mesh;
        let world = object.world_positions();
        let lone = lone_edges(mesh, &edges);
        let middles = |kind: LoneEdge| -> Vec<DVec3> {
            let of_kind = lone.iter().filter(|(_, one)| **one == kind);
            of_kind
                .map(|(edge, _)| edges.edges()[*edge])
                .map(|edge| (world[edge.low as usize] + world[edge.high as usize]) / 2.0)
                .collect()
        };
        let [open, split, near] = [LoneEdge::Open, LoneEdge::Split, LoneEdge::Near].map(middles);
        let is_whole = open.is_empty() && topology.is_oriented() && topology.connectivity.non_manifold_edges.count == 0;
        let matrix = object.pose.world_from_object();
        let placed = |found: &crate::geometry::FoundPlaces| {
            (found.count, found.places.iter().map(|place| matrix.transform_point3(*place)).collect::<Vec<_>>())
        };
        let corners = |of: &[u32; 3]| of.map(|vertex| world[vertex as usize]);
        let middle = |of: &[u32; 3]| corners(of).iter().sum::<DVec3>() / 3.0;
        let volume = six_times_volume(&world, mesh.triangles().iter());
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
            edges,
            lone,
        }
    }

    /// Returns the part of the mesh around a triangle within which triangles agree on which side is out; `None` where
    /// the mesh has no such triangle.
    pub fn part_around(&self, triangle: usize) -> Option<WoundPart> {
        self.triangles.get(triangle)?;
        let mut part = WoundPart::default();
        let mut members = BTreeSet::from([triangle]);
        let mut waiting = vec![triangle];
        while let Some(triangle) = waiting.pop() {
            let [a, b, c] = self.triangles[triangle];
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let edge = Edge { low: from.min(to), high: from.max(to) };
                let Ok(index) = self.edges.edges().binary_search(&edge) else { continue };
                let incident: Vec<(usize, i32)> = self.edges.incident(index).collect();
                match (&incident[..], self.lone.get(&index)) {
                    ([_], Some(LoneEdge::Open)) => part.open += 1,
                    ([_], Some(LoneEdge::Split)) => part.split += 1,
                    ([_], Some(LoneEdge::Near)) => part.near += 1,
                    ([(one, way), (other, other_way)], _) if way != other_way => {
                        for next in [*one, *other] {
                            if members.insert(next) {
                                waiting.push(next);
                            }
                        }
                    }
                    ([_, _], _) => part.inconsistent += 1,
                    _ => part.non_manifold += 1,
                }
            }
        }
        let ends_nowhere = part == WoundPart::default();
        let triangles = members.iter().map(|triangle| &self.triangles[*triangle]);
        part.is_inside_out = ends_nowhere && six_times_volume(&self.world, triangles) < 0.0;
        Some(part)
    }

    /// Returns the length of each edge in metres, each edge once.
    pub fn edge_lengths(&self) -> Vec<f64> {
        let length = |edge: &Edge| self.world[edge.low as usize].distance(self.world[edge.high as usize]);
        self.edges.edges().iter().map(length).collect()
    }

    /// Returns how often the whole mesh ends, and at what.
    pub fn whole(&self) -> WoundPart {
        WoundPart {
            open: self.open.len(),
            split: self.split.len(),
            near: self.near.len(),
            non_manifold: self.non_manifold.0,
            inconsistent: self.inconsistent.0,
            is_inside_out: self.is_inside_out,
        }
    }

    /// Returns whether every edge has two triangles that are wound alike: back faces then stand behind all front faces.
    pub fn is_closed(&self) -> bool {
        let is_whole = self.open.is_empty() && self.split.is_empty() && self.near.is_empty();
        is_whole && self.non_manifold.0 == 0 && self.inconsistent.0 == 0 && !self.is_inside_out
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
        let only_facing = "right where all its triangles cast (casters = all, or by-topology, the default); with casters = light-facing";
        report(
            MeshDefect::Cause(Cause::OpenMesh),
            self.open.len(),
            &self.open,
            &format!(
                "the mesh has holes: {only_facing} it casts less than its shadow, or streaks, where edges are found as textbooks \
                 do"
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

/// Returns six times the volume that triangles enclose, negative where they face inwards; 0 without any.
fn six_times_volume<'t>(world: &[DVec3], triangles: impl Iterator<Item = &'t [u32; 3]>) -> f64 {
    let from_first = |vertex: u32| world[vertex as usize] - world[0];
    triangles.map(|corners| corners.map(from_first)).map(|[a, b, c]| a.dot(b.cross(c))).sum()
}

/// Returns what each edge of one triangle is, by its index.
fn lone_edges(mesh: &Mesh, edges: &EdgeList) -> BTreeMap<usize, LoneEdge> {
    let positions = mesh.positions();
    let indices: Vec<usize> = (0..edges.edges().len()).filter(|edge| edges.incident(*edge).count() == 1).collect();
    let lone: Vec<[u32; 2]> =
        indices.iter().map(|edge| [edges.edges()[*edge].low, edges.edges()[*edge].high]).collect();
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
    let mut sorted = BTreeMap::new();
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
        let kind = match least {
            0.0 => LoneEdge::Split,
            apart if apart <= near => LoneEdge::Near,
            _ => LoneEdge::Open,
        };
        sorted.insert(indices[index], kind);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::GeometryCache;
    use crate::scene::MeshBuilder;

    fn facts(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> MeshFacts {
        let mesh = MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().expect("a mesh");
        let mut cache = GeometryCache::default();
        let (edges, topology) = (cache.edges(&mesh), cache.topology(&mesh));
        MeshFacts::new(&Object::of("mesh", mesh), edges, &topology)
    }

    /// What lies elsewhere on a mesh is no evidence about a triangle.
    #[test]
    fn a_part_of_a_mesh_ends_only_where_it_ends() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        // Two triangles that agree; then, apart from them, two that disagree.
        let quad =
            |left: f64| [at(left, 0.0, 0.0), at(left + 1.0, 0.0, 0.0), at(left + 1.0, 1.0, 0.0), at(left, 1.0, 0.0)];
        let positions = [quad(0.0), quad(5.0)].concat();
        let facts = facts(positions, vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 7, 6]]);
        let open = WoundPart { open: 4, ..WoundPart::default() };
        assert_eq!(facts.part_around(0), Some(open));
        assert_eq!(facts.part_around(3), Some(WoundPart { open: 2, inconsistent: 1, ..WoundPart::default() }));
        assert_eq!(facts.part_around(4), None);
        assert_eq!(facts.whole(), WoundPart { open: 8, inconsistent: 1, ..WoundPart::default() });
    }

    #[test]
    fn a_closed_part_may_face_inwards() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let outwards = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let inwards = outwards.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
        let is_inside_out = |triangles| facts(corners.clone(), triangles).part_around(0).map(|part| part.is_inside_out);
        assert_eq!(is_inside_out(outwards), Some(false));
        assert_eq!(is_inside_out(inwards), Some(true));
    }

    /// The first edge of each triangle says nothing about the others.
    #[test]
    fn every_edge_has_its_length_once() {
        let corners = vec![DVec3::ZERO, DVec3::X * 8.0, DVec3::new(8.0, 1.0, 0.0), DVec3::Y];
        let mut lengths = facts(corners, vec![[0, 1, 2], [2, 3, 0]]).edge_lengths();
        lengths.sort_by(f64::total_cmp);
        assert_eq!(lengths, [1.0, 1.0, 8.0, 8.0, 65.0f64.sqrt()]);
    }
}
