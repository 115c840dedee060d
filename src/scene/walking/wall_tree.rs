//! Triangles in a tree of boxes, so that a few near a place are found among many.
//!
//! Each box is halved at the median of its triangles along its longest axis, so a tree of `n` triangles is about `log2
//! n` deep whatever their sizes.
//!
//! `obvhs`, by which meshes are compared with each other, is no substitute: its builder (PLOC) pairs the two nearest
//! boxes, and where tens of thousands of triangles lie in one place it takes minutes. A walk must not wait for a model
//! like that.

use crate::math::AxisBox;
use glam::DVec3;

/// Most triangles of a box that is not halved.
const FEW: usize = 4;
/// The deepest that halving a list by its median can get.
const DEEPEST: usize = 64;

/// The corners of a triangle that can't be walked through, world space.
pub type Wall = [DVec3; 3];

/// A tree of triangles by their position.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WallTree {
    /// The first node is the root; a node's lower half follows it.
    nodes: Vec<Node>,
    triangles: Vec<Wall>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    low: DVec3,
    high: DVec3,
    holds: Holds,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Holds {
    /// A leaf: triangles from one index to another.
    Triangles(u32, u32),
    /// An inner node: its children are the next node, and this.
    Nodes(u32),
}

impl WallTree {
    /// Returns a tree of these triangles; one with a corner that is not finite is left out.
    pub fn new(triangles: impl IntoIterator<Item = Wall>) -> WallTree {
        let finite = |corners: &Wall| corners.iter().all(|corner| corner.is_finite());
        let mut tree = WallTree { nodes: Vec::new(), triangles: triangles.into_iter().filter(finite).collect() };
        if !tree.triangles.is_empty() {
            let mut triangles = std::mem::take(&mut tree.triangles);
            tree.grow(&mut triangles, 0);
            tree.triangles = triangles;
        }
        tree
    }

    /// Returns whether the tree has no triangle.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Returns the lowest height that a triangle reaches; `None` where there is none.
    pub fn lowest(&self) -> Option<f64> {
        self.nodes.first().map(|root| root.low.y)
    }

    /// Adds the node of a run of the triangles that begins at index `first`, with those below it; sorts the run so that
    /// each half is a run of its own.
    fn grow(&mut self, triangles: &mut [Wall], first: usize) {
        let AxisBox { low, high } = AxisBox::around(triangles.iter().flatten().copied());
        let index = self.nodes.len();
        let count = triangles.len();
        self.nodes.push(Node { low, high, holds: Holds::Triangles(first as u32, (first + count) as u32) });
        if count <= FEW {
            return;
        }
        let AxisBox { low, high } = AxisBox::around(triangles.iter().map(middle));
        let size = high - low;
        let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
        let half = count / 2;
        triangles.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        let (lower, upper) = triangles.split_at_mut(half);
        self.grow(lower, first);
        self.nodes[index].holds = Holds::Nodes(self.nodes.len() as u32);
        self.grow(upper, first + half);
    }

    /// Visits triangles whose own box overlaps the box between two corners, until `visit` returns true; returns whether
    /// it did.
    pub fn any_near(&self, low: DVec3, high: DVec3, mut visit: impl FnMut(&Wall) -> bool) -> bool {
        let meets = |a: DVec3, b: DVec3| a.cmple(high).all() && b.cmpge(low).all();
        let mut waiting = [0_u32; DEEPEST];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let index = waiting[count];
            let node = &self.nodes[index as usize];
            if !meets(node.low, node.high) {
                continue;
            }
            match node.holds {
                Holds::Nodes(upper) => {
                    waiting[count] = upper;
                    waiting[count + 1] = index + 1;
                    count += 2;
                }
                Holds::Triangles(from, to) => {
                    for wall in &self.triangles[from as usize..to as usize] {
                        let [a, b, c] = *wall;
                        if meets(a.min(b).min(c), a.max(b).max(c)) && visit(wall) {
                            return true;
                        }
                    }
                }
            }
        }
        false
    }
}

/// Returns three times the centre of a triangle.
fn middle([a, b, c]: &Wall) -> DVec3 {
    *a + *b + *c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_meets_a_box_is_found_once_and_nothing_else() {
        let mut state = 3_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut point = |size: f64| DVec3::new(unit(), unit(), unit()) * size;
        for count in [0, 1, 5, 700] {
            let triangles: Vec<Wall> = (0..count)
                .map(|_| {
                    let at = point(8.0);
                    [at, at + point(1.0), at + point(1.0)]
                })
                .collect();
            let tree = WallTree::new(triangles.iter().copied());
            for _ in 0..60 {
                let (from, to) = (point(8.0), point(8.0));
                let (low, high) = (from.min(to), from.max(to));
                let mut found = Vec::new();
                assert!(!tree.any_near(low, high, |wall| {
                    found.push(*wall);
                    false
                }));
                let meets =
                    |[a, b, c]: &&Wall| a.min(*b).min(*c).cmple(high).all() && a.max(*b).max(*c).cmpge(low).all();
                let expected = triangles.iter().filter(meets).count();
                assert_eq!(found.len(), expected, "{count}");
                assert!(found.iter().all(|wall| triangles.contains(wall)));
            }
        }
    }

    #[test]
    fn triangles_that_all_lie_in_one_place_are_halved_too() {
        let tree = WallTree::new([[DVec3::ONE; 3]; 5_000]);
        let mut count = 0;
        tree.any_near(DVec3::ZERO, DVec3::ONE * 2.0, |_| {
            count += 1;
            false
        });
        assert_eq!(count, 5_000);
        assert!(tree.any_near(DVec3::ONE, DVec3::ONE, |_| true));
    }
}
