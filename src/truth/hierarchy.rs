//! A hierarchy of triangles as they are seen from one ray origin, and which of them rays from there hit.
//!
//! The origin is the eye, a point light, or the direction towards a directional one. Which side of a triangle's edge a
//! ray passes is the sign of `det(a, b, q)` with the corners seen from the origin, so each edge is one plane through
//! the origin, computed once for a triangle, and a test is three dot products. Where rounding could change a sign it is
//! decided exactly, and where it is exactly zero the ray is taken as moved a little along x, by less along y and by
//! still less along z (simulation of simplicity, Edelsbrunner and Mücke 1990). So the two triangles at an edge always
//! see a ray on opposite sides of it: it slips between none, and hits no two.

use super::coarse::{PacketOrigin, TriangleEdges4};
use super::direction_projection::{DirectionProjection, NEAREST, OriginRay};
use super::packet::RayPacket;
use super::tree::{ProjectedRect, RectTree, set_bits};
use crate::math::{Sign, side_of_triangle, sign_of_sum};
use glam::{DVec3, DVec4};
use rayon::prelude::*;

/// An upper bound for the relative rounding error of a cross and a dot product of rounded differences.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A triangle in a hierarchy that rays may hit.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Index of the triangle among all triangles.
    pub index: u32,
    /// The side of the triangle that the ray origin is on; exact.
    pub center_side: Sign,
}

/// A triangle's plane, scaled by twice its area.
#[derive(Debug, Clone, Copy)]
pub struct ScaledPlane {
    pub normal: DVec3,
    /// The value of `normal · p` for its points, relative to the hierarchy's origin.
    pub offset: f64,
}

/// What a search for hits need not look for any more; set by its callback while it runs.
#[derive(Debug, Clone, Copy)]
pub struct SearchLimit {
    /// Bits of the rays for which nothing more has to be found.
    pub lines: u32,
    /// For view rays, the distance beyond which nothing has to be found, in multiples of their directions.
    pub distance: f64,
}

impl SearchLimit {
    /// The limit of a search that leaves nothing out.
    pub const NOTHING: SearchLimit = SearchLimit { lines: 0, distance: f64::INFINITY };
}

/// The planes through the ray origin and each edge of a triangle, in double precision.
#[derive(Debug, Clone, Copy)]
struct EdgePlanes {
    /// Normals of the planes of the edges opposite to each corner …
    normals: [DVec3; 3],
    /// … and offset, which is zero where the centre is the origin.
    offsets: [f64; 3],
    /// The most that the products sum up to which make an edge's value, for each unit of the place's span …
    products: f64,
    /// … and what is added to that span.
    size: f64,
}

/// Number of triangles that are projected in one task.
const PART: usize = 4096;

/// The kind of rays: view rays have no end, light rays end at a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayKind {
    Eye,
    Light,
}

/// A bounding hierarchy of triangles for rays that all begin at one origin, the eye or a light: triangles are sorted by
/// where they are in a projection around it.
pub struct RayOriginHierarchy {
    center: DVec4,
    /// The position that points and corners are relative to: the ray origin, or near the scene.
    pub origin: DVec3,
    projection: DirectionProjection,
    tree: RectTree,
    /// Edge planes of the triangles, in the tree's order.
    fours: Vec<TriangleEdges4>,
    hit: Vec<Hit>,
    corners: Vec<[DVec3; 3]>,
}

impl std::fmt::Debug for RayOriginHierarchy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pencil").field("center", &self.center).field("fours", &self.fours.len()).finish_non_exhaustive()
    }
}

impl RayOriginHierarchy {
    /// Builds the hierarchy of the triangles whose index `takes_part` accepts, around a homogeneous ray origin
    /// `center`. Triangles that are edge-on to the origin are left out, as no ray hits them.
    pub fn new(
        ray_kind: RayKind,
        center: DVec4,
        triangles: &[[DVec3; 3]],
        takes_part: impl Fn(usize) -> bool + Sync,
    ) -> RayOriginHierarchy {
        let (low, high) = bounds(triangles, &takes_part);
        let middle = low + (high - low) / 2.0;
        let reach = ((high - low).length() / 2.0).max(f64::MIN_POSITIVE);
        let projection = match ray_kind {
            RayKind::Eye => DirectionProjection::of_eye(center, middle, reach),
            RayKind::Light => DirectionProjection::of_light(center, middle, reach),
        };
        // A list for each part, not for each triangle.
        let parts: Vec<Vec<(ProjectedRect, Hit)>> = (0..triangles.len().div_ceil(PART))
            .into_par_iter()
            .map(|part| {
                let mut rects_of_part = Vec::with_capacity(PART);
                for index in (part * PART..triangles.len()).take(PART).filter(|index| takes_part(*index)) {
                    let corners = triangles[index];
                    let Some((center_side, is_near)) = side_of(center, &corners) else { continue };
                    let hit = Hit { index: index as u32, center_side };
                    projection.for_each_area(corners, is_near, |area| rects_of_part.push((area, hit)));
                }
                rects_of_part
            })
            .collect();
        let areas: Vec<ProjectedRect> = parts.iter().flatten().map(|(area, _)| *area).collect();
        let hit: Vec<Hit> = parts.iter().flatten().map(|(_, hit)| *hit).collect();
        let (tree, order) = RectTree::new(&areas);
        let nothing = (Hit { index: 0, center_side: Sign::Zero }, [DVec3::ZERO; 3]);
        let in_order = |place: &Option<u32>| {
            place.map_or(nothing, |place| (hit[place as usize], triangles[hit[place as usize].index as usize]))
        };
        let (hit, corners): (Vec<Hit>, Vec<[DVec3; 3]>) = order.par_iter().with_min_len(PART).map(in_order).unzip();
        let four = |corners: &[[DVec3; 3]]| TriangleEdges4::new(&projection, corners);
        let fours = corners.par_chunks(RectTree::WIDTH).with_min_len(256).map(four).collect();
        RayOriginHierarchy { center, origin: projection.origin(), projection, tree, fours, hit, corners }
    }

    /// Calls `meets` with each triangle that rays of the packet hit, and a bit mask of these rays. Triangles come in no
    /// particular order, some perhaps twice, some beyond the ray's end or behind its origin. `meets` returns what does
    /// not have to be found any more.
    pub fn for_each_hit(&self, packet: &RayPacket, mut meets: impl FnMut(&Hit, &[DVec3; 3], u32) -> SearchLimit) {
        let core = PacketOrigin::new(&self.projection, packet);
        let mut left = (1_u32 << packet.len()) - 1;
        let mut follow = |area: &ProjectedRect| {
            self.tree.for_each_hit(*area, |index, found, depth| {
                let four = &self.fours[index];
                for lane in set_bits(found) {
                    let (near, sure) = core.near(four, lane);
                    let place = index * RectTree::WIDTH + lane;
                    let open = near & !sure & left;
                    let mut lines = sure & left;
                    if open != 0 {
                        lines |= self.hits_of(&self.corners[place], packet, open);
                    }
                    if lines != 0 {
                        let settled = meets(&self.hit[place], &self.corners[place], lines);
                        left &= !settled.lines;
                        if settled.distance < f64::INFINITY {
                            *depth = depth.min(self.projection.depth(settled.distance * core.largest));
                        }
                    }
                }
                left != 0
            });
        };
        match core.area {
            Some(area) => follow(&area),
            None => self.projection.packet(packet.lines()).iter().flatten().for_each(follow),
        }
    }

    /// Returns a bit mask of those rays, of the set bits of `lines`, that hit a triangle: in double precision, or
    /// exactly where that can't decide.
    #[cold]
    fn hits_of(&self, corners: &[DVec3; 3], packet: &RayPacket, lines: u32) -> u32 {
        let edges = EdgePlanes::new(&self.projection, corners);
        let is_hit = |line: &usize| {
            let line = packet.line(*line);
            edges.is_hit(line.from(self.origin)).unwrap_or_else(|| self.is_hit(corners, line))
        };
        set_bits(lines).filter(is_hit).fold(0, |hit, line| hit | 1 << line)
    }

    /// Returns whether a ray passes all edges of a triangle on the same side, decided exactly, so that of two triangles
    /// at an edge it hits just one. False where the first edge points at the ray origin.
    fn is_hit(&self, corners: &[DVec3; 3], line: OriginRay) -> bool {
        let side = |from: usize, to: usize| self.exact_side(corners[from], corners[to], line);
        let first = side(0, 1);
        first != Sign::Zero && side(1, 2) == first && side(2, 0) == first
    }

    /// Returns the exact side on which a ray's line passes the edge from `a` to `b`; zero only where the edge itself
    /// points at the ray origin.
    fn exact_side(&self, a: DVec3, b: DVec3, line: OriginRay) -> Sign {
        let center = self.center.truncate();
        let along = |axis: DVec3| side_of_triangle([center, a, b], axis.extend(0.0));
        let through = match line {
            OriginRay::To(point) | OriginRay::Through(point) if self.center.w == 0.0 => {
                return side_of_triangle([point, a, b], self.center).or_else(|| first_sign_of_cross(a, b, center));
            }
            OriginRay::To(point) | OriginRay::Through(point) => side_of_triangle([center, a, b], point.extend(1.0)),
            OriginRay::Along(direction) => along(direction),
        };
        through.or_else(|| along(DVec3::X)).or_else(|| along(DVec3::Y)).or_else(|| along(DVec3::Z))
    }
}

/// Returns the exact sign of the first component of `(a − b) × d` that is not zero: how `d · ((a − p) × (b − p))`
/// changes as `p` moves along x, y or z.
fn first_sign_of_cross(a: DVec3, b: DVec3, d: DVec3) -> Sign {
    let component = |i: usize, j: usize| sign_of_sum(&[(a[i], d[j]), (-b[i], d[j]), (-a[j], d[i]), (b[j], d[i])]);
    component(1, 2).or_else(|| component(2, 0)).or_else(|| component(0, 1))
}

impl EdgePlanes {
    fn new(projection: &DirectionProjection, &[a, b, c]: &[DVec3; 3]) -> EdgePlanes {
        let (lever, origin) = (|corner| projection.lever(corner), projection.origin());
        // Planes through the origin and an edge: differences of near corners are exact where products of far ones would
        // lose digits.
        let edges = [(b, c), (c, a), (a, b)];
        let normals = edges.map(|(p, q)| lever(p).cross(q - p));
        let products = largest_span([b - a, c - b, a - c]) * largest_span([lever(a), lever(b), lever(c)]);
        if projection.is_centered() {
            return EdgePlanes { normals, offsets: [0.0; 3], products, size: 0.0 };
        }
        let offset = |i: usize| -normals[i].dot(edges[i].0 - origin);
        let size = largest_span([a - origin, b - origin, c - origin]);
        EdgePlanes { normals, offsets: [offset(0), offset(1), offset(2)], products, size }
    }

    /// Returns whether a ray (to `place`, relative to the hierarchy's origin) passes all edges on the same side, in
    /// double precision; `None` where rounding leaves it open.
    fn is_hit(&self, place: DVec3) -> Option<bool> {
        let rounding = ROUNDING * self.products * (place.abs().element_sum() + self.size);
        let value = |i: usize| self.normals[i].dot(place) + self.offsets[i];
        let (a, b, c) = (value(0), value(1), value(2));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if low < -rounding && high > rounding {
            return Some(false);
        }
        (low > rounding || high < -rounding).then_some(true)
    }
}

impl ScaledPlane {
    /// Computes a triangle's plane relative to the hierarchy's origin.
    pub fn new(origin: DVec3, &[a, b, c]: &[DVec3; 3]) -> ScaledPlane {
        let normal = (b - a).cross(c - a);
        ScaledPlane { normal, offset: normal.dot(a - origin) }
    }

    /// Returns the height of a point over the plane, times twice the triangle's area.
    pub fn height(&self, place: DVec3) -> f64 {
        self.normal.dot(place) - self.offset
    }
}

/// Bounds the rounding error of a point's scaled height over a triangle's plane, so that the sign of a larger height is
/// certain.
#[derive(Debug, Clone, Copy)]
pub struct PlaneRounding {
    /// The error of a height for each unit of span.
    height: f64,
    /// The largest sum of a corner's absolute coordinates, relative to the hierarchy's origin.
    size: f64,
}

impl PlaneRounding {
    /// Computes the rounding bounds of a triangle's plane relative to the hierarchy's origin.
    pub fn new(origin: DVec3, &[a, b, c]: &[DVec3; 3]) -> PlaneRounding {
        let edge = largest_span([b - a, c - b, a - c]);
        PlaneRounding { height: ROUNDING * edge * edge, size: largest_span([a - origin, b - origin, c - origin]) }
    }

    /// Returns an upper bound for the rounding error of a point's scaled height over the plane.
    pub fn of_height(&self, place: DVec3) -> f64 {
        self.height * (self.size + place.abs().element_sum())
    }
}

/// Returns an upper bound for how far rounding may move a point on a triangle's plane off it, where the plane was
/// computed relative to `origin`.
pub fn point_rounding(origin: DVec3, corners: &[DVec3; 3]) -> f64 {
    ROUNDING * largest_span(corners.map(|corner| corner - origin))
}

fn largest_span(of: [DVec3; 3]) -> f64 {
    let [a, b, c] = of.map(|vector| vector.abs().element_sum());
    a.max(b).max(c)
}

/// Returns the exact side of a triangle that a ray origin is on, and whether it is so near to the plane that the
/// triangle's projection may be anywhere. `None` where it is in the plane.
pub(super) fn side_of(center: DVec4, corners: &[DVec3; 3]) -> Option<(Sign, bool)> {
    // Edges of the corners as they are: what they are relative to a far centre is rounded by more than an edge's own units.
    let [u, v] = [corners[1] - corners[0], corners[2] - corners[0]];
    let normal = u.cross(v);
    let span = |vector: DVec3| vector.abs().element_sum();
    let edge = span(u).max(span(v));
    let relative = corners.map(|corner| corner - center.truncate());
    let height = normal.dot(relative[0]);
    if height.abs() > largest_span(relative) * (NEAREST * span(normal) + ROUNDING * edge * edge) && center.w != 0.0 {
        return Some((if height < 0.0 { Sign::Positive } else { Sign::Negative }, false));
    }
    let side = side_of_triangle(*corners, center);
    (side != Sign::Zero).then_some((side, true))
}

/// Returns the lowest and highest corner of the box around the triangles for which `takes_part` (asked by index) is
/// true; both zero where there is none.
fn bounds(triangles: &[[DVec3; 3]], takes_part: impl Fn(usize) -> bool + Sync) -> (DVec3, DVec3) {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let part = |(part, corners): (usize, &[[DVec3; 3]])| {
        let taking_part = (part * PART..).zip(corners).filter(|(index, _)| takes_part(*index));
        taking_part
            .fold(nothing, |(low, high), (_, [a, b, c])| (low.min(a.min(*b).min(*c)), high.max(a.max(*b).max(*c))))
    };
    let (low, high) = triangles
        .par_chunks(PART)
        .enumerate()
        .map(part)
        .reduce(|| nothing, |(low, high), other| (low.min(other.0), high.max(other.1)));
    if low.x <= high.x { (low, high) } else { (DVec3::ZERO, DVec3::ZERO) }
}
