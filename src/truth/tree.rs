//! Rectangles of a projection in trees, four to a node: those that another rectangle overlaps are found four at a time.
//!
//! Rectangles are sorted along a space-filling curve, four in a row make a node, and four nodes in a row one of the
//! next level (a linear hierarchy: Lauterbach et al. 2009), so that building takes little more than a sort. A node of
//! large and small rectangles alike would be overlapped by rays far from most of them: rectangles of each size make a
//! tree of their own.

use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Rectangles in one tree differ in size by up to this power of two.
const CLASS_BITS: u32 = 8;
/// The most trees; the last one has all smaller rectangles.
const MOST_CLASSES: u32 = 8;
/// Bits of the space-filling curve (Morton code) along each axis.
const CURVE_BITS: u32 = 20;
/// More levels of four than 32-bit indices can reach.
const MOST_LEVELS: usize = 17;

/// A rectangle in a projection, with a depth.
#[derive(Debug, Clone, Copy)]
pub struct ProjectedRect {
    pub low: Vec2,
    pub high: Vec2,
    /// For triangles the least depth, for rays the largest.
    pub depth: f32,
}

/// A node of the tree: four rectangles.
#[derive(Debug, Clone, Copy)]
struct RectNode {
    low: [Vec4; 2],
    high: [Vec4; 2],
    depth: Vec4,
    /// Index of the first of the four nodes below.
    first: u32,
}

/// Trees of rectangles for overlap queries, one for each class of sizes.
#[derive(Debug, Default)]
pub struct RectTree {
    /// All nodes, leaves first.
    nodes: Vec<RectNode>,
    /// Number of leaves.
    leaves: usize,
    /// The root of each tree.
    tops: Vec<u32>,
}

impl RectTree {
    /// Number of rectangles in a node.
    pub const WIDTH: usize = 4;

    /// Builds the trees; also returns the order of rectangles in their leaves, as indices into `areas`. `None` fills up
    /// the last leaf of each class of sizes.
    pub fn new(areas: &[ProjectedRect]) -> (RectTree, Vec<Option<u32>>) {
        let keys = keys(areas);
        let classes = keys.chunk_by(|(one, _), (other, _)| class(*one) == class(*other));
        let mut order = Vec::with_capacity(keys.len() + RectTree::WIDTH * MOST_CLASSES as usize);
        let mut counts = Vec::new();
        for class in classes {
            let leaves = class.len().div_ceil(RectTree::WIDTH);
            let end = order.len() + leaves * RectTree::WIDTH;
            order.extend(class.iter().map(|(_, index)| Some(*index)));
            order.resize(end, None);
            counts.push(leaves);
        }
        let leaf = |four: &[Option<u32>]| RectNode::new(four.iter().flatten().map(|index| areas[*index as usize]), 0);
        let nodes: Vec<RectNode> = order.par_chunks(RectTree::WIDTH).with_min_len(1024).map(leaf).collect();
        let mut tree = RectTree { leaves: nodes.len(), nodes, tops: Vec::new() };
        let mut first = 0;
        for count in counts {
            tree.stack_up(first, count);
            first += count;
        }
        (tree, order)
    }

    /// Appends the nodes above `count` nodes from `first` on, up to one root, and records that root.
    fn stack_up(&mut self, mut first: usize, mut count: usize) {
        while count > 1 {
            let next = self.nodes.len();
            for below in (first..first + count).step_by(RectTree::WIDTH) {
                let four = &self.nodes[below..(below + RectTree::WIDTH).min(first + count)];
                let node = RectNode::new(four.iter().map(RectNode::area), below as u32);
                self.nodes.push(node);
            }
            (first, count) = (next, self.nodes.len() - next);
        }
        self.tops.push(first as u32);
    }

    /// Calls `meets` with the index of each leaf that has rectangles overlapping `area`, a bit mask of these, and the
    /// depth of `area`, which it may reduce. Ends where it returns false. Near leaves come roughly first.
    pub fn for_each_hit(&self, mut area: ProjectedRect, mut meets: impl FnMut(usize, u32, &mut f32) -> bool) {
        let mut stack = [0; MOST_LEVELS * (RectTree::WIDTH - 1) + 1];
        for top in &self.tops {
            stack[0] = *top;
            let mut count = 1;
            while count > 0 {
                count -= 1;
                let index = stack[count] as usize;
                let node = &self.nodes[index];
                let mut hit = node.hit(&area);
                if index >= self.leaves {
                    // The first of them is looked at first.
                    while hit != 0 {
                        let lane = hit.ilog2();
                        hit ^= 1 << lane;
                        stack[count] = node.first + lane;
                        count += 1;
                    }
                } else if hit != 0 && !meets(index, hit, &mut area.depth) {
                    return;
                }
            }
        }
    }
}

impl RectNode {
    /// Makes a node of up to four rectangles; nothing overlaps the empty places.
    fn new(areas: impl Iterator<Item = ProjectedRect>, first: u32) -> RectNode {
        let mut node =
            RectNode { low: [Vec4::INFINITY; 2], high: [Vec4::NEG_INFINITY; 2], depth: Vec4::INFINITY, first };
        for (lane, area) in areas.enumerate() {
            for axis in 0..2 {
                // A rectangle that overflowed is still found, and an empty lane never is.
                node.low[axis][lane] = area.low[axis].min(f32::MAX);
                node.high[axis][lane] = area.high[axis].max(-f32::MAX);
            }
            node.depth[lane] = area.depth;
        }
        node
    }

    /// Returns the box around all four rectangles.
    fn area(&self) -> ProjectedRect {
        let least = |axis: [Vec4; 2]| Vec2::new(axis[0].min_element(), axis[1].min_element());
        let most = |axis: [Vec4; 2]| Vec2::new(axis[0].max_element(), axis[1].max_element());
        ProjectedRect { low: least(self.low), high: most(self.high), depth: self.depth.min_element() }
    }

    /// Returns a bit mask of the node's rectangles that overlap or touch `area` and are not deeper than its depth.
    fn hit(&self, area: &ProjectedRect) -> u32 {
        let along_x = self.low[0].cmple(Vec4::splat(area.high.x)) & self.high[0].cmpge(Vec4::splat(area.low.x));
        let along_y = self.low[1].cmple(Vec4::splat(area.high.y)) & self.high[1].cmpge(Vec4::splat(area.low.y));
        (along_x & along_y & self.depth.cmple(Vec4::splat(area.depth))).bitmask()
    }
}

/// Returns the rectangles' sort keys (class and position along the curve) with their indices, sorted.
fn keys(areas: &[ProjectedRect]) -> Vec<(u64, u32)> {
    let place = |area: &ProjectedRect| ((area.low + area.high) / 2.0).extend(area.depth);
    let (low, high) = areas
        .iter()
        .map(place)
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), place| (low.min(place), high.max(place)));
    let size = (high - low).max_element().max(f32::MIN_POSITIVE);
    let scale = ((1 << CURVE_BITS) - 1) as f32 / size;
    let key = |(index, area): (usize, &ProjectedRect)| {
        let at = (place(area) - low) * scale;
        let curve = spread(at.x as u64) | spread(at.y as u64) << 1 | spread(at.z as u64) << 2;
        let part = ((area.high - area.low).max_element() / size).clamp(f32::MIN_POSITIVE, 1.0);
        // The exponent of the size: 127 for 1.
        let class = (127_u32.saturating_sub(part.to_bits() >> 23) / CLASS_BITS).min(MOST_CLASSES - 1);
        (u64::from(class) << (3 * CURVE_BITS) | curve, index as u32)
    };
    let mut keys: Vec<(u64, u32)> = areas.iter().enumerate().map(key).collect();
    keys.par_sort_unstable();
    keys
}

fn class(key: u64) -> u64 {
    key >> (3 * CURVE_BITS)
}

/// Inserts two zeros before each of the lowest 21 bits, for interleaving three numbers; higher bits are dropped.
fn spread(bits: u64) -> u64 {
    let mut bits = bits & 0x1f_ffff;
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

/// Returns the indices of the bits that are set, ascending.
pub fn set_bits(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (bit < u32::BITS).then_some(bit as usize)
    })
}
