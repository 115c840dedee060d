//! The edges of a mesh, each with the triangles that use it.
//!
//! Half-edges are counted into one bucket for each lower vertex, then each small bucket is sorted by its upper vertex:
//! linear in the number of triangles, and the same list whatever the order in which triangles name their edges. Any
//! number of triangles may share an edge. Built once for a mesh; a new light only sums signs over it.
//!
//! Nearly every edge has one triangle or two: those are stored beside the edge, so that a new light reads 8 bytes an
//! edge. Edges of more triangles are stored apart. A new light looks closely only where triangles face different ways:
//! for every 32 edges it is known which runs of triangles they touch, and where all of those face alike and each edge
//! is run once either way, nothing is unbalanced.

use super::facing::{Facings, MIXED, RUN};
use rayon::prelude::*;
use std::ops::Range;

/// An edge between two vertices, `low < high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Edge {
    /// The smaller vertex index.
    pub low: u32,
    /// The larger vertex index.
    pub high: u32,
}

/// All edges of a mesh, sorted by (low, high), with the triangles at each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EdgeList {
    edges: Vec<Edge>,
    /// The two triangles at each edge; two that stand for no triangle where there are more than two.
    pairs: Vec<[Incident; 2]>,
    /// Edges of more than two triangles, in the order of edges.
    fans: Vec<NonManifoldEdge>,
    fan_incidents: Vec<Incident>,
    none: Incident,
    neighbourhoods: Vec<Neighbourhood>,
}

/// The number of edges that are skipped together where all triangles around face the same way.
const BLOCK: usize = 32;
/// How many blocks one thread looks at, at least.
const SHARE: usize = 1024;
/// The most runs of triangles that a block's edges may touch for the block to be skipped.
const MOST_RUNS: usize = 8;

/// The runs of triangles that the edges of a block touch, repeated to fill the array; `None` where they are too many,
/// or where some edge is not shared by two triangles in opposite directions.
type Neighbourhood = Option<[u32; MOST_RUNS]>;

/// An edge of more than two triangles, which are `fan_incidents[start..end]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct NonManifoldEdge {
    edge: u32,
    start: u32,
    end: u32,
}

/// A triangle's use of an edge: twice the triangle's index, plus 1 where it runs from high to low. The index after the
/// last triangle stands for none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Incident(u32);

impl Incident {
    fn triangle(self) -> usize {
        (self.0 >> 1) as usize
    }

    fn direction(self) -> i32 {
        1 - 2 * (self.0 & 1) as i32
    }

    /// Returns what its triangle adds to the edge's multiplicity (−1, 0 or 1): its facing times its direction along the
    /// edge. `signs_and_none` has each triangle's facing, and then one entry for "no triangle".
    fn of(self, signs_and_none: &[i8]) -> i32 {
        i32::from(signs_and_none[self.triangle()]) * self.direction()
    }
}

impl EdgeList {
    /// Builds the list of the edges of `triangles`, each once, sorted by (low, high), with all triangles at each.
    /// Corners must be less than `vertex_count`.
    pub fn new(triangles: &[[u32; 3]], vertex_count: usize) -> EdgeList {
        let mut buckets = buckets_by_low_vertex(triangles, vertex_count);
        let none = Incident(triangles.len() as u32 * 2);
        let mut list = EdgeList {
            edges: Vec::with_capacity(triangles.len() * 3 / 2 + 16),
            pairs: Vec::with_capacity(triangles.len() * 3 / 2 + 16),
            fans: Vec::new(),
            fan_incidents: Vec::new(),
            none,
            neighbourhoods: Vec::new(),
        };
        for low in 0..vertex_count {
            let bucket = &mut buckets.half_edges[buckets.start[low] as usize..buckets.start[low + 1] as usize];
            bucket.sort_unstable();
            for run in bucket.chunk_by(|a, b| a.0 == b.0) {
                list.edges.push(Edge { low: low as u32, high: run[0].0 });
                let pair = match *run {
                    [(_, one)] => [one, none],
                    [(_, one), (_, other)] => [one, other],
                    _ => list.add_fan(run),
                };
                list.pairs.push(pair);
            }
        }
        list.neighbourhoods =
            list.pairs.par_chunks(BLOCK).with_min_len(SHARE).map(|pairs| neighbourhood(pairs, none)).collect();
        list
    }

    fn add_fan(&mut self, run: &[(u32, Incident)]) -> [Incident; 2] {
        let start = self.fan_incidents.len() as u32;
        self.fan_incidents.extend(run.iter().map(|(_, incident)| *incident));
        let end = self.fan_incidents.len() as u32;
        self.fans.push(NonManifoldEdge { edge: self.edges.len() as u32 - 1, start, end });
        [self.none; 2]
    }

    /// Returns all edges, sorted by (low, high).
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Returns the triangles at the edge with this index (ascending), each with +1 where it runs from low to high and
    /// −1 where it runs back.
    pub fn incident(&self, index: usize) -> impl Iterator<Item = (usize, i32)> {
        let fan = self.fans.binary_search_by_key(&(index as u32), |fan| fan.edge).map(|fan| self.fans[fan]);
        let incidents = fan.map_or(&self.pairs[index][..], |fan| self.of_fan(fan));
        let used = incidents.iter().filter(|incident| **incident != self.none);
        used.map(|incident| (incident.triangle(), incident.direction()))
    }

    fn of_fan(&self, fan: NonManifoldEdge) -> &[Incident] {
        &self.fan_incidents[fan.start as usize..fan.end as usize]
    }

    /// Calls `visit` with the index and multiplicity of each edge in these blocks whose triangles' signed facings do
    /// not cancel, in the order of edges.
    pub(super) fn for_each_unbalanced(
        &self,
        blocks: Range<usize>,
        facings: &Facings,
        mut visit: impl FnMut(usize, i32),
    ) {
        let (signs, runs) = (facings.signs_and_none(), facings.runs());
        let first = |block: usize| (block * BLOCK) as u32;
        let mut fans = self.fans[self.fans.partition_point(|fan| fan.edge < first(blocks.start))..].iter().peekable();
        for block in blocks {
            if let Some(touched) = &self.neighbourhoods[block] {
                let sign = runs[touched[0] as usize];
                if sign != MIXED && touched.iter().all(|run| runs[*run as usize] == sign) {
                    continue;
                }
            }
            let edges = block * BLOCK..self.pairs.len().min((block + 1) * BLOCK);
            for (index, [one, other]) in edges.clone().zip(&self.pairs[edges]) {
                let mut sum = one.of(signs) + other.of(signs);
                if *one == self.none
                    && let Some(fan) = fans.next_if(|fan| fan.edge as usize == index)
                {
                    sum = self.of_fan(*fan).iter().map(|incident| incident.of(signs)).sum();
                }
                if sum != 0 {
                    visit(index, sum);
                }
            }
        }
    }

    /// Returns how many blocks the edges are divided into for [`EdgeList::for_each_unbalanced`]; the last may be
    /// shorter.
    pub(super) fn blocks(&self) -> usize {
        self.neighbourhoods.len()
    }
}

fn neighbourhood(pairs: &[[Incident; 2]], none: Incident) -> Neighbourhood {
    let mut touched = [u32::MAX; MOST_RUNS];
    let mut count = 0;
    for pair in pairs {
        if pair.contains(&none) || pair[0].direction() == pair[1].direction() {
            return None;
        }
        for run in pair.map(|incident| (incident.triangle() / RUN) as u32) {
            if !touched[..count].contains(&run) {
                *touched.get_mut(count)? = run;
                count += 1;
            }
        }
    }
    let first = touched[0];
    touched[count..].fill(first);
    Some(touched)
}

struct Buckets {
    /// Bucket of vertex `v` is `half_edges[start[v]..start[v + 1]]`.
    start: Vec<u32>,
    half_edges: Vec<(u32, Incident)>,
}

fn buckets_by_low_vertex(triangles: &[[u32; 3]], vertex_count: usize) -> Buckets {
    // Counted two places on, so that filling a bucket moves its start to where it belongs.
    let mut start = vec![0; vertex_count + 2];
    for_each_half_edge(triangles, |low, _, _| start[low as usize + 2] += 1);
    for vertex in 0..vertex_count {
        start[vertex + 2] += start[vertex + 1];
    }
    let mut half_edges = vec![(0, Incident(0)); triangles.len() * 3];
    for_each_half_edge(triangles, |low, high, incident| {
        let next = &mut start[low as usize + 1];
        half_edges[*next as usize] = (high, incident);
        *next += 1;
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
    use crate::math::Sign;

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

    /// A strip of triangles, long enough for many blocks, with a fin on one edge.
    #[test]
    fn any_part_of_the_list_finds_its_unbalanced_edges() {
        let count = 500;
        let mut triangles: Vec<[u32; 3]> =
            (0..count).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
        triangles.push([100, 101, count + 2]);
        let list = EdgeList::new(&triangles, count as usize + 3);
        let signs = (0..triangles.len()).map(|i| if i < 300 { Sign::Positive } else { Sign::Negative });
        let facings = Facings::from_signs(signs);
        let unbalanced = |blocks| {
            let mut found = Vec::new();
            list.for_each_unbalanced(blocks, &facings, |edge, sum| found.push((edge, sum)));
            found
        };
        let of_edge = |index| list.incident(index).map(|(t, d)| d * i32::from(facings.signs()[t])).sum::<i32>();
        let expected = (0..list.edges().len()).map(|index| (index, of_edge(index))).filter(|(_, sum)| *sum != 0);
        let expected: Vec<(usize, i32)> = expected.collect();
        for middle in 0..=list.blocks() {
            assert_eq!([unbalanced(0..middle), unbalanced(middle..list.blocks())].concat(), expected);
        }
    }
}
