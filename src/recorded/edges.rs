//! Where shadow volumes are open: edges that their triangles do not run along as often one way as the other.

use crate::plan::{Draw, FramePlan};
use std::collections::{BTreeMap, BTreeSet};

/// A corner, by the bits of its position.
type CornerBits = [u32; 4];

/// Open edges of some draws together. A volume that is drawn twice, once for each face, counts once.
#[derive(Debug, Clone, Default)]
pub struct OpenEdges {
    /// Both ends of each edge, and how many more triangles run along it this way than the other.
    edges: Vec<([CornerBits; 2], u32)>,
}

impl OpenEdges {
    /// Finds the open edges of draws: those that their triangles, taken together, don't run along equally often both
    /// ways. Vertices at bit-equal positions are one, and a triangle that is drawn again counts once.
    pub fn of<'a>(plan: &FramePlan, draws: impl Iterator<Item = &'a Draw>) -> OpenEdges {
        let mut seen: BTreeSet<[CornerBits; 3]> = BTreeSet::new();
        let mut sums: BTreeMap<[CornerBits; 2], i64> = BTreeMap::new();
        for draw in draws {
            let mesh = &plan.meshes[draw.mesh.0];
            let range = draw.triangles.start as usize..draw.triangles.end as usize;
            for corners in mesh.indices.data().as_chunks::<3>().0.get(range).unwrap_or_default() {
                let at = |corner: u32| {
                    let vertex = mesh.vertices.data().get((corner + draw.base_vertex) as usize)?;
                    // −0 is 0.
                    Some(vertex.map(|value| (value + 0.0).to_bits()))
                };
                let [Some(a), Some(b), Some(c)] = corners.map(at) else { continue };
                if !seen.insert([a, b, c]) {
                    continue;
                }
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *sums.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
                }
            }
        }
        let open = sums.into_iter().filter(|([from, to], sum)| from != to && *sum != 0);
        let edge = |([low, high], sum): ([CornerBits; 2], i64)| {
            (if sum > 0 { [low, high] } else { [high, low] }, sum.unsigned_abs() as u32)
        };
        OpenEdges { edges: open.map(edge).collect() }
    }

    /// Returns the number of open edges.
    pub fn count(&self) -> usize {
        self.edges.len()
    }

    /// Returns triangles that close the edges: for each connected run of open edges a fan round the mean of their
    /// starts, as often as each edge is open.
    pub fn caps(&self) -> Vec<[[f32; 4]; 3]> {
        let mut root: BTreeMap<CornerBits, CornerBits> = BTreeMap::new();
        fn find(root: &BTreeMap<CornerBits, CornerBits>, corner: CornerBits) -> CornerBits {
            let mut at = corner;
            while let Some(next) = root.get(&at).filter(|next| **next != at) {
                at = *next;
            }
            at
        }
        for ([from, to], _) in &self.edges {
            let (a, b) = (find(&root, *from), find(&root, *to));
            root.insert(a, b);
            root.entry(b).or_insert(b);
        }
        let place = |corner: CornerBits| corner.map(f32::from_bits);
        let mut middles: BTreeMap<CornerBits, [f64; 4]> = BTreeMap::new();
        for ([from, _], _) in &self.edges {
            let middle = middles.entry(find(&root, *from)).or_default();
            middle.iter_mut().zip(place(*from)).for_each(|(sum, value)| *sum += f64::from(value));
        }
        let mut caps = Vec::new();
        for ([from, to], times) in &self.edges {
            let middle = middles[&find(&root, *from)].map(|value| value as f32);
            caps.extend(std::iter::repeat_n([place(*to), place(*from), middle], *times as usize));
        }
        caps
    }
}
