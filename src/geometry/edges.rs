//! The edges of a mesh, each with the triangles that use it.
//!
//! Half-edges are counted into one bucket a lower vertex, then each small bucket is sorted by its
//! upper vertex: linear in the number of triangles, and the same list whatever the order in which
//! triangles name their edges. Any number of triangles may share an edge. Built once a mesh; a
//! new light only sums signs over it.

/// An edge between two vertices, `low < high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Edge {
    /// The smaller vertex index.
    pub low: u32,
    /// The larger vertex index.
    pub high: u32,
}

/// All edges of a mesh, ordered by (low, high), with their incident triangles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EdgeList {
    edges: Vec<Edge>,
    /// Edge `i` has the incidents `first[i]..first[i + 1]`.
    first: Vec<u32>,
    incidents: Vec<Incident>,
}

/// A triangle's use of an edge: twice the triangle's index, plus one where it runs from high to
/// low. Ordered by triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Incident(u32);

impl EdgeList {
    /// The edges of `triangles` over `vertex_count` vertices.
    #[must_use]
    pub fn new(triangles: &[[u32; 3]], vertex_count: usize) -> EdgeList {
        let mut buckets = buckets_by_low_vertex(triangles, vertex_count);
        let mut list = EdgeList {
            edges: Vec::with_capacity(triangles.len() * 3 / 2),
            first: Vec::with_capacity(triangles.len() * 3 / 2 + 1),
            incidents: Vec::with_capacity(triangles.len() * 3),
        };
        for low in 0..vertex_count {
            let bucket = &mut buckets.half_edges[buckets.start[low]..buckets.start[low + 1]];
            bucket.sort_unstable();
            for &(high, incident) in bucket.iter() {
                let edge = Edge { low: low as u32, high };
                if list.edges.last() != Some(&edge) {
                    list.edges.push(edge);
                    list.first.push(list.incidents.len() as u32);
                }
                list.incidents.push(incident);
            }
        }
        list.first.push(list.incidents.len() as u32);
        list
    }

    /// In order of (low, high).
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The triangles that use edge `index`, each with +1 where it runs from low to high and −1
    /// where it runs back.
    pub fn incident(&self, index: usize) -> impl ExactSizeIterator<Item = (usize, i32)> {
        let range = self.first[index] as usize..self.first[index + 1] as usize;
        self.incidents[range].iter().map(|incident| {
            let direction = if incident.0 & 1 == 0 { 1 } else { -1 };
            ((incident.0 >> 1) as usize, direction)
        })
    }
}

struct Buckets {
    /// Bucket of vertex `v` is `half_edges[start[v]..start[v + 1]]`.
    start: Vec<usize>,
    half_edges: Vec<(u32, Incident)>,
}

fn buckets_by_low_vertex(triangles: &[[u32; 3]], vertex_count: usize) -> Buckets {
    let mut start = vec![0; vertex_count + 1];
    for_each_half_edge(triangles, |low, _, _| start[low as usize + 1] += 1);
    for vertex in 0..vertex_count {
        start[vertex + 1] += start[vertex];
    }
    let mut next = start.clone();
    let mut half_edges = vec![(0, Incident(0)); triangles.len() * 3];
    for_each_half_edge(triangles, |low, high, incident| {
        half_edges[next[low as usize]] = (high, incident);
        next[low as usize] += 1;
    });
    Buckets { start, half_edges }
}

fn for_each_half_edge(triangles: &[[u32; 3]], mut visit: impl FnMut(u32, u32, Incident)) {
    for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let backwards = u32::from(from > to);
            visit(from.min(to), from.max(to), Incident(triangle as u32 * 2 + backwards));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_has_six_edges_each_run_once_either_way() {
        let list = EdgeList::new(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], 4);
        assert_eq!(list.edges().len(), 6);
        for index in 0..6 {
            let directions: Vec<i32> = list.incident(index).map(|(_, direction)| direction).collect();
            assert_eq!(directions.iter().sum::<i32>(), 0);
            assert_eq!(directions.len(), 2);
        }
    }

    #[test]
    fn three_fins_share_one_edge() {
        let list = EdgeList::new(&[[0, 1, 2], [0, 1, 3], [1, 0, 4]], 5);
        let shared = list.edges().iter().position(|edge| *edge == Edge { low: 0, high: 1 }).expect("the edge");
        assert_eq!(list.incident(shared).collect::<Vec<_>>(), [(0, 1), (1, 1), (2, -1)]);
        assert_eq!(list.edges().len(), 7);
    }
}
