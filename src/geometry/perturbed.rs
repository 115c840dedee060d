//! Whether triangles stay apart while every corner moves a little, whichever way it moves.
//!
//! A rigid motion rounds each corner to another place, so that no exact sign of world positions holds at the next pose.
//! What holds for all places within a small distance of the mesh's own does: a determinant moves by no more than the
//! sums of products of the lengths of its columns with that distance (it is linear in each), and a sign whose
//! determinant is larger can't change. Every answer "yes" is a proof; what such signs don't decide is "not proven".

use glam::{DVec2, DVec3};

/// A bound for the rounding of a determinant's terms, relative to the product of the lengths of its columns.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Every corner may move by up to a distance, each in a direction of its own.
#[derive(Debug, Clone, Copy)]
pub struct Perturbation {
    /// By how much the difference of two corners may change: twice the distance, and what rounds the difference.
    change: f64,
}

impl Perturbation {
    /// Makes the perturbation of corners that move by up to `distance` each.
    pub fn by(distance: f64) -> Perturbation {
        Perturbation { change: 2.0 * distance * (1.0 + 1e-3) }
    }

    /// Returns whether a triangle keeps an area seen along one coordinate axis.
    pub fn keeps_area(&self, [a, b, c]: [DVec3; 3]) -> bool {
        (0..3).any(|axis| self.turn(flat(b - a, axis), flat(c - a, axis)) != 0)
    }

    /// Returns whether two triangles without a common corner stay apart.
    pub fn keeps_apart(&self, one: [DVec3; 3], other: [DVec3; 3]) -> bool {
        let edges = |[a, b, c]: [DVec3; 3]| [b - a, c - b, a - c];
        let (of_one, of_other) = (edges(one), edges(other));
        let normal = |edges: [DVec3; 3]| edges[0].cross(edges[1]);
        let apart = |along: DVec3| self.leads_from(one, other, along) || self.leads_from(other, one, along);
        let middles = other.iter().sum::<DVec3>() - one.iter().sum::<DVec3>();
        // Two convex bodies are parted by a plane along a face of one, or along an edge of each (Gottschalk, Lin and
        // Manocha 1996, "OBBTree"); where they lie in one plane, by one that stands on it along an edge.
        [middles, normal(of_one), normal(of_other)].into_iter().any(apart)
            || of_one.iter().any(|edge| of_other.iter().any(|of_other| apart(edge.cross(*of_other))))
            || [of_one, of_other].into_iter().any(|edges| edges.iter().any(|edge| apart(edge.cross(normal(edges)))))
    }

    /// Returns whether two triangles that share their corner 0, and no other, stay apart beside it.
    pub fn keeps_apart_at_corner(&self, one: [DVec3; 3], other: [DVec3; 3]) -> bool {
        let [[a, b], [c, d]] = [one, other].map(|[corner, p, q]| [p - corner, q - corner]);
        let middle = |p: DVec3, q: DVec3| p.normalize_or_zero() + q.normalize_or_zero();
        let between = middle(a, b) - middle(c, d);
        let is_parted = [a, b].iter().all(|way| self.is_along(between, *way) > 0)
            && [c, d].iter().all(|way| self.is_along(between, *way) < 0);
        if is_parted {
            return true;
        }
        let of_other = [self.side(a, b, c), self.side(a, b, d)];
        let of_one = [self.side(c, d, a), self.side(c, d, b)];
        if of_other[0] * of_other[1] > 0 || of_one[0] * of_one[1] > 0 {
            return true;
        }
        // Both cross the line that their planes share: on different sides of the corner where these signs are equal
        // (as in `intersection::meet_at_corner`).
        let crosses = of_other[0] * of_other[1] < 0 && of_one[0] * of_one[1] < 0;
        crosses && of_one[0] * of_other[0] > 0 || (0..3).any(|axis| self.wedges_are_apart([a, b], [c, d], axis))
    }

    /// Returns whether the triangles (from, to, tip) and (from, to, other_tip) meet nowhere but in their edge: they are
    /// not folded onto each other.
    pub fn keeps_apart_at_edge(&self, [from, to]: [DVec3; 2], tip: DVec3, other_tip: DVec3) -> bool {
        let (edge, tip, other_tip) = (to - from, tip - from, other_tip - from);
        let faces_apart = |axis: usize| {
            let [edge, tip, other_tip] = [edge, tip, other_tip].map(|way| flat(way, axis));
            self.turn(edge, tip) * self.turn(edge, other_tip) < 0
        };
        self.side(edge, tip, other_tip) != 0 || (0..3).any(faces_apart)
    }

    /// Returns whether all of `other` lies farther along a direction than all of `one`.
    fn leads_from(&self, one: [DVec3; 3], other: [DVec3; 3], along: DVec3) -> bool {
        let (from, along) = (one[0], along.normalize_or_zero());
        let places = |corners: [DVec3; 3]| corners.map(|corner| along.dot(corner - from));
        let [a, b, c] = places(one);
        let [d, e, f] = places(other);
        let reach = one.iter().chain(&other).map(|corner| (*corner - from).abs().max_element()).fold(0.0, f64::max);
        d.min(e).min(f) - a.max(b).max(c) > self.change * (1.0 + 1e-6) + 3.0 * ROUNDING * reach + f64::MIN_POSITIVE
    }

    /// Returns 1 where a difference of corners surely leads along a direction, −1 where against it, else 0.
    fn is_along(&self, direction: DVec3, way: DVec3) -> i32 {
        let change = self.change * (1.0 + 1e-6) + ROUNDING * way.length();
        firm(direction.normalize_or_zero().dot(way), change)
    }

    /// Returns the sign of the determinant of three differences of corners; 0 where it may change.
    fn side(&self, x: DVec3, y: DVec3, z: DVec3) -> i32 {
        let (by, [a, b, c]) = (self.change, [x, y, z].map(DVec3::length));
        let changes = by * (a * b + b * c + c * a + by * (a + b + c + by));
        firm(x.dot(y.cross(z)), changes * (1.0 + 1e-6) + ROUNDING * (a * b * c))
    }

    /// Returns 1 where `y` is surely to the left of `x`, −1 to the right, 0 where that may change.
    fn turn(&self, x: DVec2, y: DVec2) -> i32 {
        let (by, a, b) = (self.change, x.length(), y.length());
        firm(x.perp_dot(y), by * (a + b + by) * (1.0 + 1e-6) + ROUNDING * (a * b))
    }

    /// Returns whether two wedges with a common apex have only that in common as seen along an axis, and so in space:
    /// all ends of each are outside the other.
    fn wedges_are_apart(&self, one: [DVec3; 2], other: [DVec3; 2], axis: usize) -> bool {
        let [one, other] = [one, other].map(|ways| ways.map(|way| flat(way, axis)));
        let keeps_out = |[a, b]: [DVec2; 2], ways: [DVec2; 2]| {
            let turn = self.turn(a, b);
            ways.iter().all(|way| turn * self.turn(a, *way) < 0 || turn * self.turn(*way, b) < 0)
        };
        keeps_out(one, other) && keeps_out(other, one)
    }
}

/// Returns the sign of a value that may be off by less than `bound`; 0 where it may be either, or overflowed.
fn firm(value: f64, bound: f64) -> i32 {
    let is_firm = value.is_finite() && value.abs() > bound + f64::MIN_POSITIVE;
    if is_firm { value.signum() as i32 } else { 0 }
}

fn flat(way: DVec3, axis: usize) -> DVec2 {
    DVec2::new(way[(axis + 1) % 3], way[(axis + 2) % 3])
}
