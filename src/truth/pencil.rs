//! A pencil: all lines through one centre, and the triangles that they meet.
//!
//! The centre is the eye, a point light, or the direction towards a directional one. Which side
//! of a triangle's edge a line passes is the sign of `det(a, b, q)` with the corners seen from
//! the centre, so each edge is one plane through the centre, computed once a triangle, and a test
//! is three dot products. Where rounding could turn a sign it is decided exactly, and where it is
//! exactly zero the line is taken as moved a little along x, by less along y and by still less
//! along z (simulation of simplicity, Edelsbrunner and Mücke 1990). So the two triangles at an edge
//! always see a line on opposite sides of it: it slips between none, and meets no two.

use super::chart::Chart;
use crate::math::{Sign, side_of_triangle, sign_of_sum};
use glam::{DVec3, DVec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use rayon::prelude::*;
use std::time::Duration;

/// Some more than the roundings of a cross and a dot product of rounded differences, in units
/// of the sum of their products' absolute values.
const EDGE_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A triangle as its pencil sees it.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Planes through the centre and the edges opposite to each corner: normal …
    edge_normals: [DVec3; 3],
    /// … and offset, which is zero where the centre is the origin.
    edge_offsets: [f64; 3],
    /// The triangle's own plane, scaled by twice its area: normal …
    pub normal: DVec3,
    /// … and what `normal · p` is for its points, relative to the pencil's origin.
    pub offset: f64,
    /// The largest sum of a corner's absolute coordinates, relative to the pencil's origin.
    size: f64,
    /// The largest sum of an edge's absolute coordinates.
    edge: f64,
    /// On which side of the triangle the centre is; exact.
    pub center_side: Sign,
    /// Which triangle of all.
    pub index: u32,
}

/// All lines through a centre.
pub struct Pencil {
    center: DVec4,
    /// What points and corners are relative to: the centre, or near the scene.
    pub origin: DVec3,
    chart: Chart,
    /// `None` where there is nothing to meet.
    hierarchy: Option<Bvh2>,
    /// In the order of the hierarchy's leaves.
    seen: Vec<Seen>,
}

impl std::fmt::Debug for Pencil {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pencil").field("center", &self.center).field("seen", &self.seen.len()).finish_non_exhaustive()
    }
}

/// Up to [`Bundle::MOST`] lines that are near each other, each by a point relative to the pencil's
/// origin.
#[derive(Debug, Default)]
pub struct Bundle {
    x: [f64; Bundle::MOST],
    y: [f64; Bundle::MOST],
    z: [f64; Bundle::MOST],
    len: usize,
}

impl Bundle {
    /// Larger ones meet more triangles that most of their lines miss.
    pub const MOST: usize = 16;

    pub fn push(&mut self, point: DVec3) {
        (self.x[self.len], self.y[self.len], self.z[self.len]) = point.into();
        self.len += 1;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn point(&self, line: usize) -> DVec3 {
        DVec3::new(self.x[line], self.y[line], self.z[line])
    }

    fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        (0..self.len).map(|line| self.point(line))
    }
}

/// What is done after a line has met a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Then {
    Continue,
    Stop,
}

impl Pencil {
    /// The lines through a homogeneous centre and what they meet of `triangles`: those that
    /// `takes_part` says so of. A triangle edge-on to the centre is met by none.
    pub fn new(center: DVec4, triangles: &[[DVec3; 3]], takes_part: impl Fn(usize) -> bool + Sync) -> Pencil {
        let (low, high) = bounds(triangles);
        let middle = low + (high - low) / 2.0;
        let reach = ((high - low).length() / 2.0).max(f64::MIN_POSITIVE);
        let is_point = center.w != 0.0;
        let origin = if is_point { center.truncate() } else { middle };
        let chart = match is_point {
            true => Chart::around_point(middle - origin, reach),
            false => Chart::across(center.truncate(), reach),
        };
        let is_met = |index: &usize| takes_part(*index) && side_of_triangle(triangles[*index], center) != Sign::Zero;
        let entries: Vec<(Aabb, usize)> = (0..triangles.len())
            .into_par_iter()
            .with_min_len(1024)
            .filter(is_met)
            .flat_map_iter(|index| {
                let [a, b, c] = triangles[index].map(|corner| corner - origin);
                let normal = (b - a).cross(c - a);
                let boxes = chart.triangle([a, b, c], normal.dot(a).abs() / normal.length());
                boxes.into_iter().flatten().map(move |area| (area, index))
            })
            .collect();
        let areas: Vec<Aabb> = entries.iter().map(|(area, _)| *area).collect();
        let build = || build_bvh2(&areas, BvhBuildParams::very_fast_build(), &mut Duration::default());
        let hierarchy = (!areas.is_empty()).then(build);
        let order = hierarchy.as_ref().map_or(&[][..], |hierarchy| &hierarchy.primitive_indices);
        let seen = |entry: &u32| {
            let index = entries[*entry as usize].1;
            Seen::new(center, origin, &triangles[index], index as u32)
        };
        let seen = order.par_iter().with_min_len(1024).map(seen).collect();
        Pencil { center, origin, chart, hierarchy, seen }
    }

    /// Calls `meets` with each triangle that a line of the bundle meets and the line's number, in
    /// no particular order, perhaps more than once: between centre and point, or anywhere on the
    /// point's side of the centre where `endless`.
    pub fn for_each_meeting(
        &self,
        triangles: &[[DVec3; 3]],
        bundle: &Bundle,
        endless: bool,
        mut meets: impl FnMut(&Seen, usize) -> Then,
    ) {
        let Some(hierarchy) = &self.hierarchy else { return };
        let core = self.core(bundle);
        for area in self.chart.bundle(bundle.points(), endless).into_iter().flatten() {
            let mut goes_on = true;
            hierarchy.aabb_traverse(area, |hierarchy, node| {
                let node = &hierarchy.nodes[node as usize];
                let leaf = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                for seen in self.seen[leaf].iter().filter(|seen| !core.misses(seen, self.center)) {
                    let (sure, unsure) = self.sides(seen, bundle, core.span);
                    for line in lines(sure | unsure) {
                        let is_met = sure >> line & 1 == 1 || self.is_met(triangles, seen, bundle.point(line));
                        goes_on = goes_on && (!is_met || meets(seen, line) == Then::Continue);
                    }
                }
                goes_on
            });
            if !goes_on {
                return;
            }
        }
    }

    fn core(&self, bundle: &Bundle) -> Core {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let charted = bundle.points().map(|point| self.chart.on_chart(point));
        let (low, high) = charted.fold(empty, |(low, high), point| (low.min(point), high.max(point)));
        let span = bundle.points().map(|point| point.abs().element_sum()).fold(0.0, f64::max);
        Core { middle: (low + high) / 2.0, half: (high - low) / 2.0, span }
    }

    /// Which lines pass all edges of a triangle on the same side, and of which rounding leaves it
    /// open: a bit each.
    fn sides(&self, seen: &Seen, bundle: &Bundle, span: f64) -> (u32, u32) {
        let rounding = seen.edge_rounding(self.center, span);
        let mut low = [f64::INFINITY; Bundle::MOST];
        let mut high = [f64::NEG_INFINITY; Bundle::MOST];
        for (normal, offset) in seen.edge_normals.iter().zip(seen.edge_offsets) {
            for line in 0..Bundle::MOST {
                let value = normal.x * bundle.x[line] + normal.y * bundle.y[line] + normal.z * bundle.z[line] + offset;
                low[line] = if value < low[line] { value } else { low[line] };
                high[line] = if value > high[line] { value } else { high[line] };
            }
        }
        let (mut sure, mut unsure) = (0, 0);
        for line in 0..bundle.len {
            let is_sure = low[line] > rounding || high[line] < -rounding;
            let is_apart = low[line] < -rounding && high[line] > rounding;
            sure |= u32::from(is_sure) << line;
            unsure |= u32::from(!is_sure && !is_apart) << line;
        }
        (sure, unsure)
    }

    /// Does a line pass all three edges on the same side? Exact.
    fn is_met(&self, triangles: &[[DVec3; 3]], seen: &Seen, point: DVec3) -> bool {
        let corners = &triangles[seen.index as usize];
        let side = |from: usize, to: usize| self.exact_side(corners[from], corners[to], point);
        let first = side(0, 1);
        first != Sign::Zero && side(1, 2) == first && side(2, 0) == first
    }

    /// The exact side on which a line passes the edge from `a` to `b`; zero only where the edge
    /// itself points at the centre.
    fn exact_side(&self, a: DVec3, b: DVec3, point: DVec3) -> Sign {
        if self.center.w == 0.0 {
            let towards = self.center.truncate();
            let through = side_of_triangle([self.origin + point, a, b], self.center);
            return through.or_else(|| first_sign_of_cross(a, b, towards));
        }
        let through = side_of_triangle([self.origin, a, b], point.extend(0.0));
        let along = |axis: DVec3| side_of_triangle([self.origin, a, b], axis.extend(0.0));
        through.or_else(|| along(DVec3::X)).or_else(|| along(DVec3::Y)).or_else(|| along(DVec3::Z))
    }
}

/// A box around a bundle's lines where they cross the chart.
struct Core {
    middle: DVec3,
    half: DVec3,
    /// The largest sum of a point's absolute coordinates.
    span: f64,
}

impl Core {
    /// Do all lines pass some edge of the triangle on one side, and some edge on the other?
    fn misses(&self, seen: &Seen, center: DVec4) -> bool {
        let rounding = seen.edge_rounding(center, self.middle.abs().element_sum() + self.half.element_sum());
        let (mut left, mut right) = (false, false);
        for (normal, offset) in seen.edge_normals.iter().zip(seen.edge_offsets) {
            let value = normal.dot(self.middle) + offset;
            let spread = normal.abs().dot(self.half) + rounding;
            left |= value < -spread;
            right |= value > spread;
        }
        left && right
    }
}

/// The lines whose bits are set.
fn lines(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let line = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (line < u32::BITS).then_some(line as usize)
    })
}

/// The exact sign of the first component of `(a − b) × d` that is not zero: how
/// `d · ((a − p) × (b − p))` changes as `p` moves along x, y or z.
fn first_sign_of_cross(a: DVec3, b: DVec3, d: DVec3) -> Sign {
    let component = |i: usize, j: usize| sign_of_sum(&[(a[i], d[j]), (-b[i], d[j]), (-a[j], d[i]), (b[j], d[i])]);
    component(1, 2).or_else(|| component(2, 0)).or_else(|| component(0, 1))
}

impl Seen {
    fn new(center: DVec4, origin: DVec3, corners: &[DVec3; 3], index: u32) -> Seen {
        let [a, b, c] = *corners;
        let towards = center.truncate();
        // Through the centre and an edge: differences of near corners keep what products of far
        // ones would lose.
        let normal_of =
            |p: DVec3, q: DVec3| if center.w == 0.0 { (p - q).cross(towards) } else { (p - origin).cross(q - p) };
        let edges = [(b, c), (c, a), (a, b)];
        let edge_normals = edges.map(|(p, q)| normal_of(p, q));
        let offset_of = |i: usize| if center.w == 0.0 { -edge_normals[i].dot(edges[i].0 - origin) } else { 0.0 };
        let span = |vector: DVec3| vector.abs().element_sum();
        let normal = (b - a).cross(c - a);
        Seen {
            edge_normals,
            edge_offsets: [offset_of(0), offset_of(1), offset_of(2)],
            normal,
            offset: normal.dot(a - origin),
            size: span(a - origin).max(span(b - origin)).max(span(c - origin)),
            edge: span(b - a).max(span(c - b)).max(span(a - c)),
            center_side: side_of_triangle(*corners, center),
            index,
        }
    }

    /// More than what rounding may have moved an edge's value by, for a point of that span (sum of
    /// absolute coordinates).
    fn edge_rounding(&self, center: DVec4, span: f64) -> f64 {
        let spread = if center.w == 0.0 { self.size + span } else { self.size * span };
        EDGE_ROUNDING * self.edge * spread
    }

    /// How far above the triangle's plane a point is, times twice its area, and more than what
    /// rounding may have moved that by.
    pub fn height(&self, point: DVec3) -> (f64, f64) {
        let spread = self.size + point.abs().element_sum();
        (self.normal.dot(point) - self.offset, EDGE_ROUNDING * self.edge * self.edge * spread)
    }
}

fn bounds(triangles: &[[DVec3; 3]]) -> (DVec3, DVec3) {
    let first = triangles.first().map_or(DVec3::ZERO, |corners| corners[0]);
    let corners = triangles.iter().flatten();
    corners.fold((first, first), |(low, high), corner| (low.min(*corner), high.max(*corner)))
}
