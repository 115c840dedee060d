//! Refinement of meshes: more triangles of the same shape.

use super::mesh::{Mesh, MeshBuilder, MeshError, MeshGroup};
use glam::{DVec3, Vec2, Vec3};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

impl Mesh {
    /// Returns the mesh with at least `least` triangles: its longest edge is halved, and each triangle beside it, until
    /// there are enough. A closed mesh stays closed, and no position moves.
    pub fn refined(&self, least: usize) -> Result<Mesh, MeshError> {
        let mut making = Refinement::of(self);
        while making.triangles.len() < least && making.split_longest() {}
        making.build(self)
    }
}

/// An edge that waits to be halved, the longest first; of equal ones the oldest.
#[derive(Debug, Clone, Copy)]
struct WaitingEdge {
    length_squared: f64,
    edge: [u32; 2],
}

impl PartialEq for WaitingEdge {
    fn eq(&self, other: &WaitingEdge) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for WaitingEdge {}

impl PartialOrd for WaitingEdge {
    fn partial_cmp(&self, other: &WaitingEdge) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for WaitingEdge {
    fn cmp(&self, other: &WaitingEdge) -> Ordering {
        self.length_squared.total_cmp(&other.length_squared).then(other.edge.cmp(&self.edge))
    }
}

#[derive(Debug, Clone, Copy)]
struct RefinedTriangle {
    corners: [u32; 3],
    normals: Option<[Vec3; 3]>,
    uvs: Option<[Vec2; 3]>,
    group: usize,
}

struct Refinement {
    positions: Vec<DVec3>,
    triangles: Vec<RefinedTriangle>,
    /// The triangles on either side of an edge.
    beside: HashMap<[u32; 2], Vec<u32>>,
    waiting: BinaryHeap<WaitingEdge>,
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Returns the corners with one of them replaced.
fn with<T: Copy>(mut corners: [T; 3], at: usize, by: T) -> [T; 3] {
    corners[at] = by;
    corners
}

impl Refinement {
    fn of(mesh: &Mesh) -> Refinement {
        let group = |index: usize| mesh.groups().iter().position(|group| group.triangles.contains(&index)).unwrap_or(0);
        let triangles = mesh.triangles().iter().enumerate().map(|(index, corners)| RefinedTriangle {
            corners: *corners,
            normals: mesh.corner_normals().map(|normals| normals[index]),
            uvs: mesh.corner_uvs().and_then(|uvs| uvs[index]),
            group: group(index),
        });
        let mut making = Refinement {
            positions: mesh.positions().to_vec(),
            triangles: triangles.collect(),
            beside: HashMap::new(),
            waiting: BinaryHeap::new(),
        };
        for index in 0..making.triangles.len() as u32 {
            let [a, b, c] = making.triangles[index as usize].corners;
            [[a, b], [b, c], [c, a]].into_iter().for_each(|[a, b]| making.add(edge(a, b), index));
        }
        making
    }

    fn add(&mut self, edge: [u32; 2], triangle: u32) {
        let beside = self.beside.entry(edge).or_default();
        if beside.is_empty() {
            let [a, b] = edge.map(|end| self.positions[end as usize]);
            self.waiting.push(WaitingEdge { length_squared: a.distance_squared(b), edge });
        }
        beside.push(triangle);
    }

    /// Halves the longest edge that waits, and with it its triangles, and returns true; also true where that edge no
    /// longer exists or can't be halved. `false` where no edge waits.
    fn split_longest(&mut self) -> bool {
        let Some(WaitingEdge { edge: [u, v], .. }) = self.waiting.pop() else { return false };
        let Some(beside) = self.beside.remove(&[u, v]) else { return true };
        let [a, b] = [u, v].map(|end| self.positions[end as usize]);
        let middle = a.midpoint(b);
        if !middle.is_finite() || middle == a || middle == b {
            // No number is between the two ends.
            return true;
        }
        let m = self.positions.len() as u32;
        self.positions.push(middle);
        for index in beside {
            let whole = self.triangles[index as usize];
            let Some(at) = (0..3).find(|at| edge(whole.corners[*at], whole.corners[(at + 1) % 3]) == [u, v]) else {
                continue;
            };
            let [i, j] = [at, (at + 1) % 3];
            let k = (at + 2) % 3;
            let normal = whole.normals.map(|normals| (normals[i] + normals[j]) * 0.5);
            let uv = whole.uvs.map(|uvs| (uvs[i] + uvs[j]) * 0.5);
            let half = |replaced: usize| RefinedTriangle {
                corners: with(whole.corners, replaced, m),
                normals: whole.normals.zip(normal).map(|(normals, normal)| with(normals, replaced, normal)),
                uvs: whole.uvs.zip(uv).map(|(uvs, uv)| with(uvs, replaced, uv)),
                group: whole.group,
            };
            let new = self.triangles.len() as u32;
            self.triangles[index as usize] = half(j);
            self.triangles.push(half(i));
            let [ci, cj, ck] = [i, j, k].map(|corner| whole.corners[corner]);
            // The old triangle keeps the edge from k to i; that from j to k is the new one's.
            if let Some(moved) = self.beside.get_mut(&edge(cj, ck)) {
                moved.iter_mut().filter(|beside| **beside == index).for_each(|beside| *beside = new);
            }
            self.add(edge(ci, m), index);
            self.add(edge(m, ck), index);
            self.add(edge(m, cj), new);
            self.add(edge(m, ck), new);
        }
        true
    }

    fn build(mut self, of: &Mesh) -> Result<Mesh, MeshError> {
        self.triangles.sort_by_key(|triangle| triangle.group);
        let mut begin = 0;
        let groups = of.groups().iter().enumerate().map(|(index, group)| {
            let end = begin + self.triangles[begin..].partition_point(|triangle| triangle.group <= index);
            let triangles = std::mem::replace(&mut begin, end)..end;
            MeshGroup { triangles, ..group.clone() }
        });
        MeshBuilder {
            groups: groups.collect(),
            positions: self.positions,
            corner_normals: self.triangles.iter().filter_map(|triangle| triangle.normals).collect(),
            corner_uvs: match of.corner_uvs() {
                Some(_) => self.triangles.iter().map(|triangle| triangle.uvs).collect(),
                None => Vec::new(),
            },
            triangles: self.triangles.into_iter().map(|triangle| triangle.corners).collect(),
        }
        .build()
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes;
    use super::*;

    fn area(mesh: &Mesh) -> f64 {
        let of = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| mesh.positions()[corner as usize]);
            (b - a).cross(c - a).length() / 2.0
        };
        mesh.triangles().iter().map(of).sum()
    }

    /// Returns whether each edge occurs once in each direction.
    fn is_closed(mesh: &Mesh) -> bool {
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in mesh.triangles() {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry(edge(*from, *to)).or_default() += if from < to { 1 } else { -1 };
            }
        }
        edges.values().all(|balance| *balance == 0)
    }

    #[test]
    fn a_finer_mesh_has_the_same_shape_and_stays_closed() {
        for mesh in [shapes::torus(1.0, 0.3, 12, 8), shapes::cuboid([1.0, 2.0, 3.0]), shapes::tetrahedron(1.0)] {
            let mesh = mesh.expect("a mesh");
            for least in [mesh.triangles().len() + 1, 1000, 20_001] {
                let finer = mesh.refined(least).expect("a mesh");
                assert!((least..least + 2).contains(&finer.triangles().len()), "{}", finer.triangles().len());
                assert!(is_closed(&mesh) && is_closed(&finer));
                assert!((area(&finer) / area(&mesh) - 1.0).abs() < 1e-9);
                assert_eq!(finer.bounds(), mesh.bounds());
                assert_eq!(finer.corner_normals().is_some(), mesh.corner_normals().is_some());
            }
            assert_eq!(mesh.refined(1).expect("a mesh").triangles().len(), mesh.triangles().len());
        }
    }

    #[test]
    fn groups_stay_with_their_triangles_and_what_is_open_stays_open() {
        let quad = shapes::quad([2.0, 2.0]).expect("a mesh");
        let groups = [0..1, 1..2].map(|triangles| MeshGroup { triangles, ..quad.groups()[0].clone() });
        let two = MeshBuilder {
            positions: quad.positions().to_vec(),
            triangles: quad.triangles().to_vec(),
            groups: groups.to_vec(),
            ..MeshBuilder::default()
        };
        let finer = two.build().and_then(|mesh| mesh.refined(64)).expect("a mesh");
        let [one, other] = finer.groups() else { panic!("{:?}", finer.groups()) };
        assert_eq!((one.triangles.start, one.triangles.end, other.triangles.end), (0, other.triangles.start, 64));
        assert!(one.triangles.len() == 32 && !is_closed(&finer));
        assert!((area(&finer) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn a_mesh_without_triangles_stays_as_it_is() {
        let none = MeshBuilder::default().build().expect("a mesh");
        assert_eq!(none.refined(10).expect("a mesh").triangles().len(), 0);
    }
}
