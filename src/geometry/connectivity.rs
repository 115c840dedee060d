//! How the triangles of a mesh are connected by their edges: what is open, torn or flipped, and which parts there are.
//!
//! This is all that is asked before a light's shadow is made: whether simpler ways would do. What a person wants to
//! know of a model besides is [`Topology`](super::Topology).

use super::EdgeList;
use crate::scene::Mesh;
use glam::DVec3;

/// The most places that are listed of each kind.
pub(super) const MOST_PLACES: usize = 64;

/// How often a defect of a mesh was found, and where.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FoundPlaces {
    /// How often it was found.
    pub count: usize,
    /// The first places, object space: at most 64.
    pub places: Vec<DVec3>,
}

impl FoundPlaces {
    pub(super) fn add(&mut self, place: DVec3) {
        self.count += 1;
        if self.places.len() < MOST_PLACES {
            self.places.push(place);
        }
    }
}

/// How the triangles of a mesh are connected: its components and the edges that are not shared by two consistently
/// wound triangles. Places are the midpoints of edges.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Connectivity {
    /// Number of connected components: triangles that are connected by edges.
    pub components: usize,
    /// Edges of only one triangle.
    pub open_edges: FoundPlaces,
    /// Edges of more than two triangles.
    pub non_manifold_edges: FoundPlaces,
    /// Edges of two triangles that both run along it in the same direction.
    pub inconsistent_edges: FoundPlaces,
    /// For each triangle, the index of its component, in the order of their first triangles.
    component_of: Vec<u32>,
}

impl Connectivity {
    /// Counts the mesh's open edges (of one triangle), inconsistent edges (of two that run the same way) and
    /// non-manifold edges (of more), each with the middles of the first, and numbers the components of triangles joined
    /// by edges.
    pub fn new(mesh: &Mesh, edges: &EdgeList) -> Connectivity {
        let positions = mesh.positions();
        let mut connectivity = Connectivity::default();
        let mut sets = DisjointSets::new(mesh.triangles().len());
        for (index, edge) in edges.edges().iter().enumerate() {
            let middle = || (positions[edge.low as usize] + positions[edge.high as usize]) / 2.0;
            let (mut count, mut balance, mut first) = (0, 0, 0);
            for (triangle, direction) in edges.incident(index) {
                if count == 0 {
                    first = triangle;
                } else {
                    sets.join(first, triangle);
                }
                (count, balance) = (count + 1, balance + direction);
            }
            match (count, balance) {
                (1, _) => connectivity.open_edges.add(middle()),
                (2, 0) => {}
                (2, _) => connectivity.inconsistent_edges.add(middle()),
                _ => connectivity.non_manifold_edges.add(middle()),
            }
        }
        (connectivity.component_of, connectivity.components) = sets.numbered();
        connectivity
    }

    /// Returns whether every edge joins exactly two triangles; their winding may still disagree
    /// ([`Connectivity::is_oriented`]).
    pub fn is_closed(&self) -> bool {
        self.open_edges.count == 0 && self.non_manifold_edges.count == 0
    }

    /// Returns whether the two triangles at every edge that joins two are wound alike, so that they agree on which side
    /// is out.
    pub fn is_oriented(&self) -> bool {
        self.inconsistent_edges.count == 0
    }

    /// Returns the index of the component that a triangle belongs to; components are in the order of their first
    /// triangles.
    pub fn component_of(&self, triangle: usize) -> usize {
        self.component_of[triangle] as usize
    }
}

/// Disjoint sets (union-find) of triangles, or of anything that has indices.
pub(super) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    pub(super) fn new(count: usize) -> DisjointSets {
        DisjointSets { parent: (0..count as u32).collect() }
    }

    fn root(&mut self, mut member: usize) -> usize {
        while self.parent[member] as usize != member {
            // Halves the way for whoever comes next.
            self.parent[member] = self.parent[self.parent[member] as usize];
            member = self.parent[member] as usize;
        }
        member
    }

    /// Joins the sets of two members; nothing changes where they are in one set already. The set's root is its smallest
    /// member.
    pub(super) fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.root(one), self.root(other));
        self.parent[one.max(other)] = one.min(other) as u32;
    }

    /// Returns for each member the index of its set, and how many sets there are; sets are in the order of their first
    /// members.
    pub(super) fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut numbers = Vec::with_capacity(self.parent.len());
        let mut count = 0;
        for member in 0..self.parent.len() {
            let root = self.root(member);
            let number = if root == member { count } else { numbers[root] };
            count += u32::from(root == member);
            numbers.push(number);
        }
        (numbers, count as usize)
    }
}
