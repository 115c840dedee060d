//! Whether a mesh intersects itself, decided by exact signs.
//!
//! A hierarchy of boxes, traversed against itself, gives the pairs of triangles that may touch. Triangles that share an
//! edge or a corner touch there, and may nowhere else; others may not at all. Every answer is a sign of an orientation
//! determinant, in space or, for triangles in one plane, along the axis that shows them best. Whatever is left open
//! counts as an intersection: the answer "no" is a proof.

use super::perturbed::Perturbation;
use crate::math::{Sign, side_of_line, side_of_triangle};
use glam::{DVec2, DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Returns the indices of two triangles that intersect in more than the corners and edges they share, or for which that
/// is not ruled out; `None` for a mesh that does not intersect itself.
pub fn self_meeting(world: &[DVec3], triangles: &[[u32; 3]]) -> Option<[usize; 2]> {
    let corners = |triangle: usize| triangles[triangle].map(|vertex| world[vertex as usize]);
    let each = |triangle: usize| (outer_box(corners(triangle), 0.0), FlatTriangle::of(corners(triangle)).is_some());
    let (boxes, has_area): (Vec<Aabb>, Vec<bool>) = (0..triangles.len()).into_par_iter().map(each).unzip();
    let meets = |pair: [usize; 2]| meet(world, pair.map(|triangle| (triangles[triangle], has_area[triangle])));
    let search = IntersectionSearch::new(&boxes, &meets)?;
    if search.finds_any() { search.first() } else { None }
}

/// Returns whether any of these pairs of triangles intersect in more than the corners and edges they share, or that is
/// not ruled out.
pub fn any_meet(world: &[DVec3], triangles: &[[u32; 3]], pairs: &[[u32; 2]]) -> bool {
    let has_area = |of: [u32; 3]| FlatTriangle::of(of.map(|vertex| world[vertex as usize])).is_some();
    let with_area = |triangle: u32| (triangles[triangle as usize], has_area(triangles[triangle as usize]));
    pairs.par_iter().any(|pair| meet(world, pair.map(with_area)))
}

/// Returns all pairs of triangles that are not proven to meet in no more than the corners and edges they share however
/// each vertex is moved by up to `distance`; `None` where these are more than there are triangles.
pub fn unsettled_pairs(positions: &[DVec3], triangles: &[[u32; 3]], distance: f64) -> Option<Vec<[u32; 2]>> {
    let perturbation = Perturbation::by(distance);
    let corners = |triangle: usize| triangles[triangle].map(|vertex| positions[vertex as usize]);
    let boxes: Vec<Aabb> =
        (0..triangles.len()).into_par_iter().map(|triangle| outer_box(corners(triangle), distance)).collect();
    let unsettled = Mutex::new(Vec::new());
    // Stops where there are too many, as if it had found what it looks for.
    let are_too_many = |pair: [usize; 2]| {
        if stay_apart(positions, pair.map(|triangle| triangles[triangle]), perturbation) {
            return false;
        }
        let mut unsettled = unsettled.lock().unwrap_or_else(PoisonError::into_inner);
        unsettled.push(pair.map(|triangle| triangle as u32));
        unsettled.len() > triangles.len()
    };
    if IntersectionSearch::new(&boxes, &are_too_many).is_some_and(|search| search.finds_any()) {
        return None;
    }
    let mut unsettled = unsettled.into_inner().unwrap_or_else(PoisonError::into_inner);
    unsettled.sort_unstable();
    Some(unsettled)
}

/// Builds a hierarchy by the steps of `obvhs::bvh2::builder::build_bvh2`, which also reads std's clock: in a browser it
/// has none.
fn hierarchy(boxes: &[Aabb]) -> Bvh2 {
    let BvhBuildParams {
        ploc_search_distance,
        search_depth_threshold,
        sort_precision,
        reinsertion_batch_ratio,
        max_prims_per_leaf,
        collapse_traversal_cost,
        post_collapse_reinsertion_batch_ratio_multiplier,
        ..
    } = BvhBuildParams::very_fast_build();
    let indices = (0..boxes.len() as u32).collect();
    let builder = &mut PlocBuilder::with_capacity(boxes.len());
    let mut hierarchy = builder.build(ploc_search_distance, boxes, indices, sort_precision, search_depth_threshold);
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut hierarchy, reinsertion_batch_ratio, None);
    collapse(&mut hierarchy, max_prims_per_leaf.clamp(1, 255), collapse_traversal_cost);
    let again = reinsertion_batch_ratio * post_collapse_reinsertion_batch_ratio_multiplier;
    optimizer.run(&mut hierarchy, again, None);
    hierarchy
}

/// A mesh of more triangles than this has a hierarchy of groups of near ones: one of all takes 300 bytes a triangle while
/// it is built.
const MOST_ALONE: usize = 1 << 19;
/// How many triangles make a group then.
const GROUP: usize = 8;

/// A search for pairs of triangles that intersect among those whose bounding boxes overlap, in a bounding volume
/// hierarchy.
struct IntersectionSearch<'a, M> {
    /// The box of each triangle.
    boxes: &'a [Aabb],
    /// The triangles in an order in which each group's are next to each other.
    order: Vec<u32>,
    /// How many triangles a group has; the last may have fewer.
    group: usize,
    /// The hierarchy of the groups' boxes.
    hierarchy: Bvh2,
    /// Returns whether two triangles intersect, the first in the mesh's order given first.
    meets: &'a M,
}

/// Two nodes of the hierarchy whose triangles are tested against each other.
type NodePair = [u32; 2];

impl<'a, M: Fn([usize; 2]) -> bool + Sync> IntersectionSearch<'a, M> {
    /// About how many pairs of nodes are shared among threads.
    const SHARED: usize = 1024;

    /// Builds the hierarchy of the triangles' boxes; `None` where there are no triangles.
    fn new(boxes: &'a [Aabb], meets: &'a M) -> Option<Self> {
        let group = if boxes.len() > MOST_ALONE { GROUP } else { 1 };
        (!boxes.is_empty()).then(|| IntersectionSearch::of_groups(boxes, group, meets))
    }

    /// Builds the hierarchy of groups of so many triangles that are near each other.
    fn of_groups(boxes: &'a [Aabb], group: usize, meets: &'a M) -> Self {
        if group == 1 {
            let order = (0..boxes.len() as u32).collect();
            return IntersectionSearch { boxes, order, group, hierarchy: hierarchy(boxes), meets };
        }
        let order = along_a_curve(boxes);
        let around =
            |group: &[u32]| group.iter().fold(Aabb::empty(), |all, triangle| all.union(&boxes[*triangle as usize]));
        let hierarchy = hierarchy(&order.par_chunks(group).map(around).collect::<Vec<Aabb>>());
        IntersectionSearch { boxes, order, group, hierarchy, meets }
    }

    /// Returns whether any two triangles intersect in more than a shared corner or edge. Stops at the first pair that
    /// it finds.
    fn finds_any(&self) -> bool {
        let mut pairs: Vec<NodePair> = vec![[0, 0]];
        while !pairs.is_empty() && pairs.len() < Self::SHARED {
            let mut below = Vec::with_capacity(3 * pairs.len());
            if pairs.into_iter().any(|pair| self.look(pair, &mut below)) {
                return true;
            }
            pairs = below;
        }
        pairs.into_par_iter().any(|pair| {
            let mut rest = vec![pair];
            while let Some(pair) = rest.pop() {
                if self.look(pair, &mut rest) {
                    return true;
                }
            }
            false
        })
    }

    /// Looks at a pair of nodes: for two leaves returns whether any of their triangles intersect; otherwise returns
    /// false and appends to `below` the pairs of children whose boxes overlap.
    fn look(&self, [one, other]: NodePair, below: &mut Vec<NodePair>) -> bool {
        let node = |index: u32| &self.hierarchy.nodes[index as usize];
        let overlap = |pair: &NodePair| node(pair[0]).aabb().intersect_aabb(node(pair[1]).aabb());
        let children = |index: u32| [node(index).first_index, node(index).first_index + 1];
        match (node(one).is_leaf(), node(other).is_leaf()) {
            (true, true) => return self.meet_in(node(one), node(other)),
            _ if one == other => {
                let [left, right] = children(one);
                below.extend([[left, left], [right, right]]);
                below.extend(Some([left, right]).filter(overlap));
            }
            (is_leaf, other_is_leaf) => {
                let is_larger = || node(one).aabb().half_area() >= node(other).aabb().half_area();
                let goes_down = !is_leaf && (other_is_leaf || is_larger());
                let pairs = match goes_down {
                    true => children(one).map(|child| [child, other]),
                    false => children(other).map(|child| [one, child]),
                };
                below.extend(pairs.iter().filter(|pair| overlap(pair)));
            }
        }
        false
    }

    fn leaf(&self, node: &Bvh2Node) -> &[u32] {
        let first = node.first_index as usize;
        &self.hierarchy.primitive_indices[first..first + node.prim_count as usize]
    }

    /// Returns the triangles of a group.
    fn members(&self, group: u32) -> &[u32] {
        let first = group as usize * self.group;
        &self.order[first..(first + self.group).min(self.order.len())]
    }

    /// Returns whether a triangle of one leaf intersects one of the other in more than shared corners and edges, or,
    /// where both are the same, another of that leaf; true also where it can't be decided.
    fn meet_in(&self, leaf: &Bvh2Node, other: &Bvh2Node) -> bool {
        let same = std::ptr::eq(leaf, other);
        let meet = |one: &u32, other: &u32| self.meet([*one.min(other), *one.max(other)].map(|index| index as usize));
        let groups = self.leaf(leaf);
        groups.iter().enumerate().any(|(at, group)| {
            let members = self.members(*group);
            let others = if same { &groups[at + 1..] } else { self.leaf(other) };
            let is_near = |one: &&u32| self.boxes[**one as usize].intersect_aabb(other.aabb());
            let is_met = |one: &u32| others.iter().any(|of| self.members(*of).iter().any(|other| meet(one, other)));
            let meets_within = |(at, one): (usize, &u32)| members[at + 1..].iter().any(|other| meet(one, other));
            members.iter().filter(is_near).any(is_met) || same && members.iter().enumerate().any(meets_within)
        })
    }

    fn meet(&self, [one, other]: [usize; 2]) -> bool {
        self.boxes[one].intersect_aabb(&self.boxes[other]) && (self.meets)([one, other])
    }

    /// Returns the first triangle in the mesh's order that intersects a later one in more than a shared corner or edge,
    /// and one that it intersects: the same pair in every run. `None` where none does.
    fn first(&self) -> Option<[usize; 2]> {
        let with = |one: usize| {
            let mut found = None;
            self.hierarchy.aabb_traverse(self.boxes[one], |hierarchy: &Bvh2, node| {
                let groups = self.leaf(&hierarchy.nodes[node as usize]).iter();
                let leaf = groups.flat_map(|group| self.members(*group)).map(|index| *index as usize);
                found = leaf.filter(|other| *other > one).map(|other| [one, other]).find(|pair| self.meet(*pair));
                found.is_none()
            });
            found
        };
        (0..self.boxes.len()).into_par_iter().with_min_len(256).find_map_first(with)
    }
}

/// Returns the indices of boxes in the order of a Z-order curve through their middles (Morton 1966), on which near ones
/// lie near each other.
fn along_a_curve(boxes: &[Aabb]) -> Vec<u32> {
    let all = boxes.par_iter().copied().reduce(Aabb::empty, |one, other| one.union(&other));
    let steps = Vec3A::splat(1023.0) / all.diagonal().max(Vec3A::splat(f32::MIN_POSITIVE));
    // Two zero bits between each two of ten.
    let spread = |bits: u32| (0..10).fold(0, |spread, bit| spread | (bits >> bit & 1) << (3 * bit));
    let code = |aabb: &Aabb| {
        let at = ((aabb.center() - all.min) * steps).to_array();
        (0..3).fold(0, |code, axis| code | spread(at[axis] as u32) << axis)
    };
    // The index decides between equals, so that the order is the same in every run.
    let mut keyed: Vec<(u32, u32)> = boxes.par_iter().enumerate().map(|(index, of)| (code(of), index as u32)).collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, index)| index).collect()
}

/// Returns the bounding box of a triangle in `f32`, larger on every side by `distance` and one step of `f32`, so that it
/// certainly contains the triangle however its corners are moved so far.
fn outer_box([a, b, c]: [DVec3; 3], distance: f64) -> Aabb {
    let round = |p: DVec3, towards: fn(f32) -> f32| Vec3A::from_array(p.to_array().map(|x| towards(x as f32)));
    let (low, high) = (a.min(b).min(c) - distance, a.max(b).max(c) + distance);
    Aabb { min: round(low, f32::next_down), max: round(high, f32::next_up) }
}

/// Two triangles by what they share, with their corners' positions.
enum Neighbours {
    /// No corner.
    Apart([DVec3; 3], [DVec3; 3]),
    /// Corner 0 of both.
    AtCorner([DVec3; 3], [DVec3; 3]),
    /// The edge between the first two; the others are the tips.
    AtEdge([DVec3; 2], DVec3, DVec3),
    /// All corners.
    Same,
}

impl Neighbours {
    fn of(positions: &[DVec3], [one, other]: [[u32; 3]; 2]) -> Neighbours {
        let at = |corners: [u32; 3]| corners.map(|vertex| positions[vertex as usize]);
        let shared = [0, 1, 2].map(|corner| other.contains(&one[corner]));
        let rotated = |corners: [u32; 3], first: usize| [0, 1, 2].map(|step| corners[(first + step) % 3]);
        match shared.iter().filter(|is_shared| **is_shared).count() {
            0 => Neighbours::Apart(at(one), at(other)),
            1 => {
                let corner = shared.iter().position(|is_shared| *is_shared).unwrap_or_default();
                let apex = other.iter().position(|vertex| *vertex == one[corner]).unwrap_or_default();
                Neighbours::AtCorner(at(rotated(one, corner)), at(rotated(other, apex)))
            }
            2 => {
                let opposite = |corners: [u32; 3], than: [u32; 3]| {
                    corners.iter().position(|vertex| !than.contains(vertex)).unwrap_or_default()
                };
                let [tip, from, to] = at(rotated(one, opposite(one, other)));
                let [other_tip, ..] = at(rotated(other, opposite(other, one)));
                Neighbours::AtEdge([from, to], tip, other_tip)
            }
            _ => Neighbours::Same,
        }
    }
}

/// Returns whether two triangles intersect in more than the corners and edges they share; each comes with whether its
/// corners are not collinear. True where that can't be decided.
fn meet(world: &[DVec3], [(one, one_has_area), (other, other_has_area)]: [([u32; 3], bool); 2]) -> bool {
    let have_area = one_has_area && other_has_area;
    match Neighbours::of(world, [one, other]) {
        Neighbours::Apart(one, other) => !have_area || meet_apart(one, other),
        Neighbours::AtCorner(one, other) => !have_area || meet_at_corner(one, other),
        Neighbours::AtEdge(edge, tip, other_tip) => meet_at_edge(edge, tip, other_tip),
        Neighbours::Same => true,
    }
}

/// Returns whether two triangles are proven to meet in no more than the corners and edges they share while their
/// corners move.
fn stay_apart(positions: &[DVec3], pair: [[u32; 3]; 2], perturbation: Perturbation) -> bool {
    match Neighbours::of(positions, pair) {
        Neighbours::Apart(one, other) => perturbation.keeps_apart(one, other),
        Neighbours::AtCorner(one, other) => perturbation.keeps_apart_at_corner(one, other),
        Neighbours::AtEdge(edge, tip, other_tip) => perturbation.keeps_apart_at_edge(edge, tip, other_tip),
        Neighbours::Same => false,
    }
}

fn side(plane: [DVec3; 3], point: DVec3) -> Sign {
    side_of_triangle(plane, point.extend(1.0))
}

fn opposite(one: Sign, other: Sign) -> bool {
    one.value() * other.value() < 0
}

/// A triangle projected along a coordinate axis in whose direction it has an area.
struct FlatTriangle {
    axis: usize,
    corners: [DVec2; 3],
    /// The orientation of its projected corners.
    turn: Sign,
}

impl FlatTriangle {
    /// Projects a triangle along the first coordinate axis along which it keeps an area, exactly decided; `None` where
    /// the corners are collinear.
    fn of(triangle: [DVec3; 3]) -> Option<FlatTriangle> {
        (0..3).find_map(|axis| {
            let corners = triangle.map(|corner| flat(corner, axis));
            let turn = side_of_line([corners[0], corners[1]], corners[2]);
            (turn != Sign::Zero).then_some(FlatTriangle { axis, corners, turn })
        })
    }

    fn flat(&self, point: DVec3) -> DVec2 {
        flat(point, self.axis)
    }

    /// Returns 1 where the point is on the inner side of the edge that begins at `corner`, −1 on the outer side, 0 on
    /// its line.
    fn inside_of(&self, corner: usize, point: DVec2) -> i32 {
        let edge = [self.corners[corner], self.corners[(corner + 1) % 3]];
        side_of_line(edge, point).value() * self.turn.value()
    }

    /// Returns whether some edge's line has the triangle on one side and all of `points` strictly on the other.
    fn keeps_out(&self, points: &[DVec2]) -> bool {
        (0..3).any(|corner| points.iter().all(|point| self.inside_of(corner, *point) < 0))
    }

    /// Returns whether the direction from corner 0 to `point` is strictly outside the wedge of the two edges there.
    fn wedge_keeps_out(&self, point: DVec2) -> bool {
        self.inside_of(0, point) < 0 || self.inside_of(2, point) < 0
    }
}

fn flat(point: DVec3, axis: usize) -> DVec2 {
    DVec2::new(point[(axis + 1) % 3], point[(axis + 2) % 3])
}

/// Returns whether the triangles (from, to, tip) and (from, to, other_tip) intersect in more than their edge, which
/// they do only where they are folded onto each other.
fn meet_at_edge([from, to]: [DVec3; 2], tip: DVec3, other_tip: DVec3) -> bool {
    if side([from, to, tip], other_tip) != Sign::Zero {
        return false;
    }
    let Some(flat) = FlatTriangle::of([from, to, tip]) else { return true };
    flat.inside_of(0, flat.flat(other_tip)) >= 0
}

/// Returns whether two triangles that share their corner 0 (and no other) intersect in more than that point, exactly. A
/// triangle without area counts as intersecting where the other's plane does not settle it.
fn meet_at_corner(one: [DVec3; 3], other: [DVec3; 3]) -> bool {
    let same_side = |signs: [Sign; 2]| signs[0] != Sign::Zero && signs[0] == signs[1];
    let of_other = [side(one, other[1]), side(one, other[2])];
    if same_side(of_other) {
        return false;
    }
    let of_one = [side(other, one[1]), side(other, one[2])];
    if same_side(of_one) {
        return false;
    }
    let (Some(flat_one), Some(flat_other)) = (FlatTriangle::of(one), FlatTriangle::of(other)) else { return true };
    match of_other {
        [Sign::Zero, Sign::Zero] => !wedges_are_apart(&flat_one, [other[1], other[2]]),
        // One edge of the other lies in this plane; all else of it is on one side.
        [Sign::Zero, _] => !flat_one.wedge_keeps_out(flat_one.flat(other[1])),
        [_, Sign::Zero] => !flat_one.wedge_keeps_out(flat_one.flat(other[2])),
        _ => match of_one {
            [Sign::Zero, _] => !flat_other.wedge_keeps_out(flat_other.flat(one[1])),
            [_, Sign::Zero] => !flat_other.wedge_keeps_out(flat_other.flat(one[2])),
            // Both cross the line that their planes share, each on one side of the corner. With
            // A = |a c d| and C = |a b c| for corners v a b and v c d, those sides are the same where
            // A and C have different signs.
            [a_to_other, _] => {
                let a_c_d = a_to_other;
                let a_b_c = of_other[0];
                opposite(a_c_d, a_b_c)
            }
        },
    }
}

/// Returns whether two wedges in one plane with a common apex have only the apex in common: all ends of each are
/// strictly outside the other. False where the second has no area. `other` has the ends of the second.
fn wedges_are_apart(one: &FlatTriangle, other: [DVec3; 2]) -> bool {
    let apex = one.corners[0];
    let [c, d] = other.map(|point| one.flat(point));
    let turn = side_of_line([apex, c], d);
    let other = FlatTriangle { axis: one.axis, corners: [apex, c, d], turn };
    // Wedges that overlap do so up to an edge of one in the other.
    let [_, a, b] = one.corners;
    turn != Sign::Zero
        && [c, d].iter().all(|p| one.wedge_keeps_out(*p))
        && [a, b].iter().all(|p| other.wedge_keeps_out(*p))
}

/// Returns whether two triangles that share no corner intersect or touch, exactly. One without area counts as
/// intersecting where the other's plane does not settle it.
fn meet_apart(one: [DVec3; 3], other: [DVec3; 3]) -> bool {
    let one_side = |signs: [Sign; 3]| signs[0] != Sign::Zero && signs[0] == signs[1] && signs[1] == signs[2];
    let of_other = other.map(|corner| side(one, corner));
    if one_side(of_other) {
        return false;
    }
    let of_one = one.map(|corner| side(other, corner));
    if one_side(of_one) {
        return false;
    }
    let (Some(flat_one), Some(flat_other)) = (FlatTriangle::of(one), FlatTriangle::of(other)) else { return true };
    if of_other == [Sign::Zero; 3] {
        return !flat_one.keeps_out(&other.map(|corner| flat_one.flat(corner)))
            && !flat_along(other, flat_one.axis).keeps_out(&flat_one.corners);
    }
    let pierces = |plane: [DVec3; 3], flat: &FlatTriangle, points: [DVec3; 3], sides: [Sign; 3]| {
        (0..3).any(|i| {
            let next = (i + 1) % 3;
            segment_meets(plane, flat, [points[i], points[next]], [sides[i], sides[next]])
        })
    };
    pierces(one, &flat_one, other, of_other) || pierces(other, &flat_other, one, of_one)
}

/// Projects a triangle along the given coordinate axis, without checking that it keeps an area then.
fn flat_along(triangle: [DVec3; 3], axis: usize) -> FlatTriangle {
    let corners = triangle.map(|corner| flat(corner, axis));
    FlatTriangle { axis, corners, turn: side_of_line([corners[0], corners[1]], corners[2]) }
}

/// Returns whether a segment intersects a closed triangle. `sides` has the side of the triangle's plane that each end
/// is on.
fn segment_meets(triangle: [DVec3; 3], flat: &FlatTriangle, [from, to]: [DVec3; 2], sides: [Sign; 2]) -> bool {
    if sides[0] == sides[1] {
        // In the plane: apart if an edge of the triangle keeps both ends out, or the segment's line
        // all corners.
        let ends = [flat.flat(from), flat.flat(to)];
        let line = flat.corners.map(|corner| side_of_line(ends, corner));
        let is_beside = line[0] != Sign::Zero && line[0] == line[1] && line[1] == line[2];
        return sides[0] == Sign::Zero && !is_beside && !flat.keeps_out(&ends);
    }
    let [a, b, c] = triangle;
    let passes = [[a, b], [b, c], [c, a]].map(|[p, q]| side([from, p, q], to));
    !passes.iter().any(|one| passes.iter().any(|other| opposite(*one, *other)))
}

#[cfg(test)]
mod tests;
