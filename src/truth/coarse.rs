//! Rays and triangles in single precision, which decides most pairs: sixteen rays or four triangles at a time.

use super::direction_projection::DirectionProjection;
use super::packet::RayPacket;
use super::tree::ProjectedRect;
use glam::{DVec3, Vec3A, Vec4};

/// An upper bound for the relative rounding error of an edge's value in single precision: more than twice 13 roundings
/// of half a unit each, in units of the product of the absolute sums.
const ROUNDING: f32 = 16.0 * f32::EPSILON;
/// The least rounding error that is assumed, as numbers near it lose digits.
const LEAST: f32 = f32::MIN_POSITIVE;
/// Positions of this size or more are scaled to 1.
const SMALLEST: f32 = 1e-30;

/// The edge planes of four triangles, in single precision for SIMD.
#[derive(Debug, Clone, Copy)]
pub struct TriangleEdges4 {
    /// By edge and axis, for each of the four triangles.
    normals: [[Vec4; 3]; 3],
    offsets: [Vec4; 3],
    /// The rounding error of an edge's value, for each unit of the position's span …
    rounding: Vec4,
    /// … and the part of it that does not depend on the position.
    least_rounding: Vec4,
}

/// A packet's ray targets relative to the ray origin, in single precision for SIMD.
pub struct PacketOrigin {
    /// Positions by axis; where the projection is centred they are scaled, which changes no ray's direction.
    places: [[Vec4; RayPacket::MOST / 4]; 3],
    /// The largest sum of a position's absolute coordinates.
    span: f32,
    /// The largest coordinate of a position before it was scaled.
    pub largest: f64,
    /// The rectangle of the projection that the rays cross; `None` where that is not clearly on one face.
    pub area: Option<ProjectedRect>,
}

impl PacketOrigin {
    /// Computes the rays' positions for tests in single precision; places of a packet that has fewer rays than it can
    /// hold repeat the first.
    pub fn new(projection: &DirectionProjection, packet: &RayPacket) -> PacketOrigin {
        let points = packet.points();
        let base = packet.base(projection.origin());
        // What is left over is as the first line.
        let mut places = [[0.0_f32; RayPacket::MOST]; 3];
        for index in 0..RayPacket::MOST {
            let place = points[if index < points.len() { index } else { 0 }] - base;
            (places[0][index], places[1][index], places[2][index]) = (place.x as f32, place.y as f32, place.z as f32);
        }
        let places = places.map(|axis| std::array::from_fn(|four| Vec4::from_slice(&axis[four * 4..])));
        if projection.is_centered() {
            return PacketOrigin::centered(projection, places, packet.is_endless());
        }
        let mut span = Vec4::ZERO;
        for four in 0..RayPacket::MOST / 4 {
            let [x, y, z] = places.map(|axis: [Vec4; 4]| axis[four].abs());
            span = span.max(x + y + z);
        }
        PacketOrigin { places, span: span.max_element(), largest: f64::INFINITY, area: None }
    }

    /// Scales positions so that their largest coordinate is 1 (they lie on a cube around the centre), and notes the
    /// largest distance and, where all are on one face, the area that they cover.
    fn centered(
        projection: &DirectionProjection,
        mut places: [[Vec4; RayPacket::MOST / 4]; 3],
        is_endless: bool,
    ) -> PacketOrigin {
        let (mut low, mut high) = ([Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]);
        let (mut span, mut end) = (Vec4::ONE, Vec4::ZERO);
        for four in 0..RayPacket::MOST / 4 {
            let [x, y, z] = places.map(|axis| axis[four].abs());
            let largest = x.max(y).max(z);
            end = end.max(largest);
            let scale = largest.max(Vec4::splat(SMALLEST)).recip();
            span = span.max((x + y + z) * scale);
            for axis in 0..3 {
                let place = places[axis][four] * scale;
                places[axis][four] = place;
                (low[axis], high[axis]) = (low[axis].min(place), high[axis].max(place));
            }
        }
        let low = Vec3A::from_array(low.map(Vec4::min_element));
        let high = Vec3A::from_array(high.map(Vec4::max_element));
        let largest = end.max_element();
        let area = projection.on_one_face(low, high, if is_endless { f32::INFINITY } else { largest });
        // It is rounded by far less than that.
        let largest = f64::from(largest) * (1.0 + f64::from(ROUNDING));
        PacketOrigin { places, span: span.max_element(), largest, area }
    }

    /// Returns two bit masks of the packet's rays for one triangle: those that may hit it (they do not clearly pass two
    /// edges on different sides), and those that surely do.
    pub fn near(&self, four: &TriangleEdges4, lane: usize) -> (u32, u32) {
        let rounding = Vec4::splat(four.rounding[lane] * self.span + four.least_rounding[lane]);
        let normals = four.normals.map(|axes| axes.map(|axis| Vec4::splat(axis[lane])));
        let offsets = four.offsets.map(|offset| Vec4::splat(offset[lane]));
        let (mut misses, mut sure) = (0, 0);
        let [xs, ys, zs] = &self.places;
        for four in 0..RayPacket::MOST / 4 {
            let value = |edge: usize| {
                let [x, y, z] = normals[edge];
                x * xs[four] + y * ys[four] + z * zs[four] + offsets[edge]
            };
            let (a, b, c) = (value(0), value(1), value(2));
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            misses |= (low.cmplt(-rounding) & high.cmpgt(rounding)).bitmask() << (4 * four);
            sure |= (low.cmpgt(rounding) | high.cmplt(-rounding)).bitmask() << (4 * four);
        }
        (!misses, sure)
    }
}

impl TriangleEdges4 {
    /// Computes the edge planes of up to four triangles and their error bounds; positions are subtracted in double
    /// precision, the rest is in single.
    pub fn new(projection: &DirectionProjection, triangles: &[[DVec3; 3]]) -> TriangleEdges4 {
        let (mut levers, mut sides, mut places) = ([Vec3x4::ZERO; 3], [Vec3x4::ZERO; 3], [Vec3x4::ZERO; 3]);
        for (lane, &[a, b, c]) in triangles.iter().enumerate() {
            for (edge, (p, q)) in [(b, c), (c, a), (a, b)].into_iter().enumerate() {
                levers[edge].set(lane, projection.lever(p));
                sides[edge].set(lane, q - p);
                if !projection.is_centered() {
                    places[edge].set(lane, p - projection.origin());
                }
            }
        }
        let normals: [Vec3x4; 3] = std::array::from_fn(|edge| levers[edge].cross(sides[edge]));
        let offsets = std::array::from_fn(|edge| -normals[edge].dot(places[edge]));
        let largest = |of: [Vec3x4; 3]| of[0].span().max(of[1].span()).max(of[2].span());
        let (lever, side) = (largest(levers), largest(sides));
        // Where single precision ends, nothing is sorted out: what is infinite or not a number decides nothing.
        let is_small = lever.min(side).cmplt(Vec4::splat(SMALLEST));
        let rounding = Vec4::select(is_small, Vec4::INFINITY, (lever * side * ROUNDING).max(Vec4::splat(LEAST)));
        let least_rounding = if projection.is_centered() { Vec4::ZERO } else { rounding * largest(places) };
        TriangleEdges4 { normals: normals.map(|normal| normal.0), offsets, rounding, least_rounding }
    }
}

/// Four vectors, stored by axis.
#[derive(Clone, Copy)]
struct Vec3x4([Vec4; 3]);

impl Vec3x4 {
    const ZERO: Vec3x4 = Vec3x4([Vec4::ZERO; 3]);

    fn set(&mut self, lane: usize, vector: DVec3) {
        for axis in 0..3 {
            self.0[axis][lane] = vector[axis] as f32;
        }
    }

    fn cross(self, other: Vec3x4) -> Vec3x4 {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        Vec3x4([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    }

    fn dot(self, other: Vec3x4) -> Vec4 {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        ax * bx + ay * by + az * bz
    }

    /// Returns for each of the four vectors the sum of its absolute coordinates.
    fn span(self) -> Vec4 {
        let [x, y, z] = self.0.map(Vec4::abs);
        x + y + z
    }
}
