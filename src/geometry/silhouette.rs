//! Which way triangles face a light, and how often each edge bounds the shadow.

use super::{Edge, EdgeList, Facings};
use crate::math::{Sign, side_of_triangle};
use crate::scene::Mesh;
use glam::{DVec3, DVec4};
use rayon::prelude::*;
use std::ops::Range;

/// Number of blocks of edges that one thread takes at once; fewer are not worth another thread.
const SHARE: usize = 4 * 1024;
/// The most triangles for [`silhouette_by_search`]: beyond, the quadratic search takes seconds.
pub const MOST_TO_SEARCH: usize = 20_000;

/// An edge that bounds a shadow, and how many sides the volume has there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct SilhouetteEdge {
    /// The edge.
    pub edge: Edge,
    /// How many more casting triangles, turned towards the light, run from low to high than back; never 0.
    pub multiplicity: i32,
}

/// Returns for each triangle on which side a homogeneous `light` is, by exact signs; zero is edge-on, and casts
/// nothing. The plain computation that [`super::CasterPlanes`] must agree with.
pub fn facing(world: &[DVec3], triangles: &[[u32; 3]], light: DVec4) -> Vec<Sign> {
    triangles.iter().map(|corners| side_of_triangle(corners.map(|i| world[i as usize]), light)).collect()
}

/// Finds the edges that bound the shadow when every casting triangle is turned towards the light, sorted by (low,
/// high): those where the triangles that run from low to high and those that run back do not cancel. Right for any
/// triangle soup: sides and caps made from it always close.
pub fn silhouette(edges: &EdgeList, facings: &Facings, out: &mut Vec<SilhouetteEdge>) {
    out.clear();
    let found = |blocks: Range<usize>, out: &mut Vec<SilhouetteEdge>| {
        edges.for_each_unbalanced(blocks, facings, |index, multiplicity| {
            out.push(SilhouetteEdge { edge: edges.edges()[index], multiplicity });
        });
    };
    let count = edges.blocks();
    if count <= 2 * SHARE {
        return found(0..count, out);
    }
    let share = |index: usize| {
        let mut part = Vec::new();
        found(index * SHARE..count.min((index + 1) * SHARE), &mut part);
        part
    };
    let parts: Vec<Vec<SilhouetteEdge>> = (0..count.div_ceil(SHARE)).into_par_iter().map(share).collect();
    parts.iter().for_each(|part| out.extend_from_slice(part));
}

/// Finds the same edges without an edge list: each side of each casting triangle is pushed on a stack of directed edges,
/// unless its reverse is found there and removed. The search is quadratic in the number of triangles; it is here for its lesson.
pub fn silhouette_by_search(triangles: &[[u32; 3]], facings: &Facings, out: &mut Vec<SilhouetteEdge>) {
    let mut list: Vec<[u32; 2]> = Vec::new();
    for (&[a, b, c], sign) in triangles.iter().zip(facings.signs()) {
        let oriented = match sign {
            1 => [a, b, c],
            -1 => [a, c, b],
            _ => continue,
        };
        for side in 0..3 {
            let (from, to) = (oriented[side], oriented[(side + 1) % 3]);
            match list.iter().position(|other| *other == [to, from]) {
                Some(reverse) => {
                    list.swap_remove(reverse);
                }
                None => list.push([from, to]),
            }
        }
    }
    out.clear();
    out.extend(list.iter().map(|&[from, to]| SilhouetteEdge {
        edge: Edge { low: from.min(to), high: from.max(to) },
        multiplicity: if from < to { 1 } else { -1 },
    }));
    out.sort_unstable();
    out.dedup_by(|next, last| {
        let is_same = next.edge == last.edge;
        last.multiplicity += if is_same { next.multiplicity } else { 0 };
        is_same
    });
}

/// Finds the edges that bound the shadow between triangles that share two corners by the numbers that the mesh's file
/// gives them. An edge of one triangle alone is none, though it bounds the shadow: where corners are split, and at
/// T-junctions, sides are missing.
pub fn silhouette_of_shared_corners(mesh: &Mesh, facings: &Facings, out: &mut Vec<SilhouetteEdge>) {
    let corners = mesh.file_corners();
    let count = corners.as_flattened().iter().max().map_or(0, |last| *last as usize + 1);
    let edges = EdgeList::new(corners, count);
    let mut welded = vec![0; count];
    for (of_file, of_mesh) in corners.as_flattened().iter().zip(mesh.triangles().as_flattened()) {
        welded[*of_file as usize] = *of_mesh;
    }
    out.clear();
    edges.for_each_unbalanced(0..edges.blocks(), facings, |index, multiplicity| {
        if edges.incident(index).count() < 2 {
            return;
        }
        let Edge { low, high } = edges.edges()[index];
        let [from, to] = [low, high].map(|corner| welded[corner as usize]);
        let multiplicity = if from < to { multiplicity } else { -multiplicity };
        out.push(SilhouetteEdge { edge: Edge { low: from.min(to), high: from.max(to) }, multiplicity });
    });
    // Two edges of the file may be one in space.
    out.sort_unstable();
    out.dedup_by(|next, last| {
        let is_same = next.edge == last.edge;
        last.multiplicity += if is_same { next.multiplicity } else { 0 };
        is_same
    });
    out.retain(|edge| edge.multiplicity != 0);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fins, doubled and turned triangles among few vertices.
    #[test]
    fn searching_and_adjacency_find_the_same_edges() {
        let mut state = 5u64;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        for round in 0..400 {
            let vertex_count = 4 + round % 9;
            let triangles: Vec<[u32; 3]> = (0..1 + round * 2 % 61)
                .map(|_| {
                    let start = next(vertex_count);
                    let step = 1 + next(vertex_count - 2);
                    let jump = 1 + next(vertex_count - 1 - step);
                    [start, start + step, start + step + jump].map(|v| (v % vertex_count) as u32)
                })
                .collect();
            let signs = [Sign::Negative, Sign::Zero, Sign::Positive];
            let facings = Facings::from_signs(triangles.iter().map(|_| signs[next(3) as usize]));
            let edges = EdgeList::new(&triangles, vertex_count as usize);
            let (mut by_adjacency, mut by_search) = (Vec::new(), Vec::new());
            silhouette(&edges, &facings, &mut by_adjacency);
            silhouette_by_search(&triangles, &facings, &mut by_search);
            assert_eq!(by_adjacency, by_search, "{round}");
        }
    }
}
