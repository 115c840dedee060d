//! A pencil: all lines through one centre, and the triangles that they meet.
//!
//! The centre is the eye, a point light, or the direction towards a directional one. Which side
//! of a triangle's edge a line passes is the sign of `det(a, b, q)` with the corners seen from
//! the centre, so each edge is one plane through the centre, computed once a triangle, and a test
//! is three dot products. Where rounding could turn a sign it is decided exactly, and where it is
//! exactly zero the line is taken as moved a little along x, by less along y and by still less
//! along z (simulation of simplicity, Edelsbrunner and Mücke 1990). So the two triangles at an edge
//! always see a line on opposite sides of it: it slips between none, and meets no two.

use super::chart::{Chart, Line, NEAREST};
use crate::math::{Sign, side_of_triangle, sign_of_sum};
use glam::{DVec3, DVec4, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use rayon::prelude::*;
use std::time::Duration;

/// Some more than the roundings of a cross and a dot product of rounded differences, in units
/// of the sum of their products' absolute values.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The same for single precision, which sorts out most lines that pass a triangle by.
const COARSE_ROUNDING: f32 = 64.0 * f32::EPSILON;

/// A triangle as its pencil sees it.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Planes through the centre and the edges opposite to each corner: normal …
    edge_normals: [DVec3; 3],
    /// … and offset, which is zero where the centre is the origin.
    edge_offsets: [f64; 3],
    is_centered: bool,
    /// What rounding may move an edge's value by, for each unit of the place's span.
    edge_rounding: f64,
    /// The triangle's own plane, scaled by twice its area: normal …
    pub normal: DVec3,
    /// … and what `normal · p` is for its points, relative to the pencil's origin.
    pub offset: f64,
    /// What rounding may move a height by, for each unit of its spread.
    height_rounding: f64,
    /// The largest sum of a corner's absolute coordinates, relative to the pencil's origin.
    size: f64,
    /// On which side of the triangle the centre is; exact.
    pub center_side: Sign,
    /// Which triangle of all.
    pub index: u32,
}

/// Whose lines they are: an eye's go on without end, a light's end at a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    Eye,
    Light,
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
    /// Parallel to `seen`.
    coarse: Vec<Coarse>,
}

impl std::fmt::Debug for Pencil {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pencil").field("center", &self.center).field("seen", &self.seen.len()).finish_non_exhaustive()
    }
}

/// Up to [`Bundle::MOST`] lines that are near each other.
#[derive(Debug)]
pub struct Bundle {
    lines: [Line; Bundle::MOST],
    len: usize,
}

impl Bundle {
    /// Larger ones meet more triangles that most of their lines miss.
    pub const MOST: usize = 16;

    pub fn new() -> Bundle {
        Bundle { lines: [Line::Along(DVec3::ZERO); Bundle::MOST], len: 0 }
    }

    pub fn push(&mut self, line: Line) {
        self.lines[self.len] = line;
        self.len += 1;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    fn lines(&self) -> impl Iterator<Item = Line> + Clone {
        self.lines[..self.len].iter().copied()
    }
}

/// The edges of a triangle in single precision.
#[derive(Debug, Clone, Copy)]
struct Coarse {
    normals: [Vec3A; 3],
    offsets: [f32; 3],
    /// What rounding may move an edge's value by, for each unit of the place's span …
    rounding: f32,
    /// … and for none.
    least_rounding: f32,
}

/// A bundle's places relative to a pencil's origin, and a box around its lines where they cross
/// the chart.
struct Core {
    places: [DVec3; Bundle::MOST],
    x: [f32; Bundle::MOST],
    y: [f32; Bundle::MOST],
    z: [f32; Bundle::MOST],
    /// The largest sum of a place's absolute coordinates.
    span: f32,
    middle: Vec3A,
    half: Vec3A,
    /// The same for the box; it carries the rounding of the places that it was moved from.
    charted_span: f32,
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
    pub fn new(
        whose: Whose,
        center: DVec4,
        triangles: &[[DVec3; 3]],
        takes_part: impl Fn(usize) -> bool + Sync,
    ) -> Pencil {
        let (low, high) = bounds(triangles, &takes_part);
        let middle = low + (high - low) / 2.0;
        let reach = ((high - low).length() / 2.0).max(f64::MIN_POSITIVE);
        let chart = match whose {
            Whose::Eye => Chart::of_eye(center, middle, reach),
            Whose::Light => Chart::of_light(center, middle, reach),
        };
        let is_met = |index: &usize| takes_part(*index) && side_of_triangle(triangles[*index], center) != Sign::Zero;
        let entries: Vec<(Aabb, usize)> = (0..triangles.len())
            .into_par_iter()
            .with_min_len(1024)
            .filter(is_met)
            .flat_map_iter(|index| {
                let boxes = chart.triangle(triangles[index], is_near(center, &triangles[index]));
                boxes.into_iter().flatten().map(move |area| (area, index))
            })
            .collect();
        let areas: Vec<Aabb> = entries.iter().map(|(area, _)| *area).collect();
        let build = || build_bvh2(&areas, BvhBuildParams::very_fast_build(), &mut Duration::default());
        let hierarchy = (!areas.is_empty()).then(build);
        let order = hierarchy.as_ref().map_or(&[][..], |hierarchy| &hierarchy.primitive_indices);
        let seen = |entry: &u32| {
            let index = entries[*entry as usize].1;
            Seen::new(center, &chart, &triangles[index], index as u32)
        };
        let seen: Vec<Seen> = order.par_iter().with_min_len(1024).map(seen).collect();
        let coarse = seen.par_iter().with_min_len(1024).map(Seen::coarse).collect();
        Pencil { center, origin: chart.origin(), chart, hierarchy, seen, coarse }
    }

    /// Calls `meets` with each triangle that a line of the bundle meets and the line's number, in
    /// no particular order, perhaps more than once; some lie on a line's other side of the centre or
    /// beyond its end.
    pub fn for_each_meeting(
        &self,
        triangles: &[[DVec3; 3]],
        bundle: &Bundle,
        mut meets: impl FnMut(&Seen, usize) -> Then,
    ) {
        let Some(hierarchy) = &self.hierarchy else { return };
        let core = self.core(bundle);
        for area in self.chart.bundle(bundle.lines()).into_iter().flatten() {
            let mut goes_on = true;
            hierarchy.aabb_traverse(area, |hierarchy, node| {
                let node = &hierarchy.nodes[node as usize];
                let leaf = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                for index in leaf.filter(|index| !core.misses(&self.coarse[*index])) {
                    let seen = &self.seen[index];
                    for line in set_bits(core.near(&self.coarse[index], bundle.len)) {
                        let is_met = seen.is_met(core.places[line]);
                        let is_met = is_met.unwrap_or_else(|| self.is_met(triangles, seen, bundle.lines[line]));
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
        let mut core = Core {
            places: [DVec3::ZERO; Bundle::MOST],
            x: [0.0; Bundle::MOST],
            y: [0.0; Bundle::MOST],
            z: [0.0; Bundle::MOST],
            span: 0.0,
            middle: Vec3A::ZERO,
            half: Vec3A::ZERO,
            charted_span: 0.0,
        };
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (index, line) in bundle.lines().enumerate() {
            let place = line.from(self.origin);
            core.places[index] = place;
            let coarse = place.as_vec3a();
            (core.x[index], core.y[index], core.z[index]) = coarse.into();
            core.span = core.span.max(coarse.abs().element_sum());
            let charted = self.chart.on_chart(line);
            (low, high) = (low.min(charted), high.max(charted));
        }
        core.middle = ((low + high) / 2.0).as_vec3a();
        core.half = ((high - low) / 2.0).as_vec3a();
        core.charted_span = core.middle.abs().element_sum() + core.half.element_sum();
        if !self.chart.is_centered() {
            core.charted_span += core.span;
        }
        core
    }

    /// Does a line pass all three edges on the same side? Exact.
    fn is_met(&self, triangles: &[[DVec3; 3]], seen: &Seen, line: Line) -> bool {
        let corners = &triangles[seen.index as usize];
        let side = |from: usize, to: usize| self.exact_side(corners[from], corners[to], line);
        let first = side(0, 1);
        first != Sign::Zero && side(1, 2) == first && side(2, 0) == first
    }

    /// The exact side on which a line passes the edge from `a` to `b`; zero only where the edge
    /// itself points at the centre.
    fn exact_side(&self, a: DVec3, b: DVec3, line: Line) -> Sign {
        let center = self.center.truncate();
        let along = |axis: DVec3| side_of_triangle([center, a, b], axis.extend(0.0));
        let through = match line {
            Line::To(point) | Line::Through(point) if self.center.w == 0.0 => {
                return side_of_triangle([point, a, b], self.center).or_else(|| first_sign_of_cross(a, b, center));
            }
            Line::To(point) | Line::Through(point) => side_of_triangle([center, a, b], point.extend(1.0)),
            Line::Along(direction) => along(direction),
        };
        through.or_else(|| along(DVec3::X)).or_else(|| along(DVec3::Y)).or_else(|| along(DVec3::Z))
    }
}

impl Core {
    /// Do all lines pass some edge of the triangle on one side, and some edge on the other?
    fn misses(&self, coarse: &Coarse) -> bool {
        let rounding = coarse.rounding_at(self.charted_span);
        let (mut left, mut right) = (false, false);
        for (normal, offset) in coarse.normals.iter().zip(coarse.offsets) {
            let value = normal.dot(self.middle) + offset;
            let spread = normal.abs().dot(self.half) + rounding;
            left |= value < -spread;
            right |= value > spread;
        }
        left && right
    }

    /// Which of the first `count` lines do not clearly pass two edges on different sides: a bit each.
    fn near(&self, coarse: &Coarse, count: usize) -> u32 {
        let rounding = coarse.rounding_at(self.span);
        let mut low = [f32::INFINITY; Bundle::MOST];
        let mut high = [f32::NEG_INFINITY; Bundle::MOST];
        for (normal, offset) in coarse.normals.iter().zip(coarse.offsets) {
            for line in 0..Bundle::MOST {
                let value = normal.x * self.x[line] + normal.y * self.y[line] + normal.z * self.z[line] + offset;
                low[line] = if value < low[line] { value } else { low[line] };
                high[line] = if value > high[line] { value } else { high[line] };
            }
        }
        let is_near = |line: &usize| !(low[*line] < -rounding && high[*line] > rounding);
        (0..count).filter(is_near).fold(0, |bits, line| bits | 1 << line)
    }
}

impl Coarse {
    /// More than what rounding may have moved an edge's value by, for a place of that span.
    fn rounding_at(&self, span: f32) -> f32 {
        self.rounding * span + self.least_rounding
    }
}

/// Which bits are set.
fn set_bits(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (bit < u32::BITS).then_some(bit as usize)
    })
}

/// The exact sign of the first component of `(a − b) × d` that is not zero: how
/// `d · ((a − p) × (b − p))` changes as `p` moves along x, y or z.
fn first_sign_of_cross(a: DVec3, b: DVec3, d: DVec3) -> Sign {
    let component = |i: usize, j: usize| sign_of_sum(&[(a[i], d[j]), (-b[i], d[j]), (-a[j], d[i]), (b[j], d[i])]);
    component(1, 2).or_else(|| component(2, 0)).or_else(|| component(0, 1))
}

impl Seen {
    fn new(center: DVec4, chart: &Chart, corners: &[DVec3; 3], index: u32) -> Seen {
        let [a, b, c] = *corners;
        let (towards, origin) = (center.truncate(), chart.origin());
        // From the centre to a corner; a lever that is the same for all where the centre is at infinity.
        let lever = |corner: DVec3| if center.w == 0.0 { -towards } else { corner - towards };
        // Planes through the centre and an edge: differences of near corners keep what products of
        // far ones would lose.
        let edges = [(b, c), (c, a), (a, b)];
        let edge_normals = edges.map(|(p, q)| lever(p).cross(q - p));
        let offset = |i: usize| if chart.is_centered() { 0.0 } else { -edge_normals[i].dot(edges[i].0 - origin) };
        let span = |vector: DVec3| vector.abs().element_sum();
        let largest = |of: [DVec3; 3]| span(of[0]).max(span(of[1])).max(span(of[2]));
        let normal = (b - a).cross(c - a);
        let edge = largest([b - a, c - b, a - c]);
        Seen {
            edge_normals,
            edge_offsets: [offset(0), offset(1), offset(2)],
            is_centered: chart.is_centered(),
            edge_rounding: ROUNDING * edge * largest([lever(a), lever(b), lever(c)]),
            normal,
            offset: normal.dot(a - origin),
            height_rounding: ROUNDING * edge * edge,
            size: largest([a - origin, b - origin, c - origin]),
            center_side: side_of_triangle(*corners, center),
            index,
        }
    }

    fn coarse(&self) -> Coarse {
        let rounding = (self.edge_rounding / ROUNDING) as f32 * COARSE_ROUNDING;
        // Where single precision ends, nothing is sorted out: what is not a number decides nothing.
        let least_rounding = if self.is_centered { 0.0 } else { rounding * self.size as f32 };
        Coarse {
            normals: self.edge_normals.map(|normal| normal.as_vec3a()),
            offsets: self.edge_offsets.map(|offset| offset as f32),
            rounding,
            least_rounding: least_rounding + f32::MIN_POSITIVE,
        }
    }

    /// Does a line pass all edges on the same side? `None` where rounding leaves it open.
    fn is_met(&self, place: DVec3) -> Option<bool> {
        let span = place.abs().element_sum();
        let rounding = self.edge_rounding * if self.is_centered { span } else { span + self.size };
        let value = |i: usize| self.edge_normals[i].dot(place) + self.edge_offsets[i];
        let (a, b, c) = (value(0), value(1), value(2));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if low < -rounding && high > rounding {
            return Some(false);
        }
        (low > rounding || high < -rounding).then_some(true)
    }

    /// How far above the triangle's plane a place is, times twice its area, and more than what
    /// rounding may have moved that by.
    pub fn height(&self, place: DVec3) -> (f64, f64) {
        let spread = self.size + place.abs().element_sum();
        (self.normal.dot(place) - self.offset, self.height_rounding * spread)
    }

    /// More than what rounding may have moved a point of the triangle's plane off it, where the
    /// plane was computed from here.
    pub fn plane_rounding(&self) -> f64 {
        ROUNDING * self.size
    }
}

/// Is a centre so near to a triangle's plane that the triangle may be seen anywhere around it?
fn is_near(center: DVec4, corners: &[DVec3; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| corner - center.truncate());
    let normal = (b - a).cross(c - a);
    let span = |vector: DVec3| vector.abs().element_sum();
    let size = span(a).max(span(b)).max(span(c));
    let edge = span(b - a).max(span(c - a));
    normal.dot(a).abs() <= size * (NEAREST * normal.length() + ROUNDING * edge * edge)
}

/// The box around the triangles that take part.
fn bounds(triangles: &[[DVec3; 3]], takes_part: impl Fn(usize) -> bool) -> (DVec3, DVec3) {
    let taking_part = triangles.iter().enumerate().filter(|(index, _)| takes_part(*index));
    let mut corners = taking_part.flat_map(|(_, corners)| *corners);
    let first = corners.next().unwrap_or(DVec3::ZERO);
    corners.fold((first, first), |(low, high), corner| (low.min(corner), high.max(corner)))
}
