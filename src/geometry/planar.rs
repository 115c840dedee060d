//! Planar receivers of a mesh, and casters flattened onto them.
//!
//! A receiver is a maximal edge-connected set of coplanar triangles. Coplanarity is decided in
//! the object's own space, before any rounding by its transform, within 1e-9 of its size.
//!
//! A caster's point throws a shadow on a plane only if it lies between plane and light; so each
//! casting triangle is clipped to that slab before it is projected. What is beyond the light
//! would give an anti-shadow, what is below the plane a false one.

use super::EdgeList;
use crate::math::Plane;
use crate::math::clip::{clip_planes, visible};
use crate::scene::Pose;
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::hash::{DefaultHasher, Hash, Hasher};

/// A vertex counts as on a plane up to this distance, relative to the mesh's size.
const COPLANAR: f64 = 1e-9;

/// A flat piece of a mesh: connected triangles in one plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Receiver {
    /// Its plane in world space; the normal may point to either side.
    pub plane: Plane,
    /// Indices into the mesh's triangles, ascending.
    pub triangles: Vec<u32>,
    /// Its area in square metres.
    pub area: f64,
}

/// Two triangles belong to one curved surface where one turns from the other by less: the cosine of 50 degrees. The eighth
/// side of a column turns by 45, a cube's side by 90.
const CURVED: f64 = 0.642_787_609_686_539_3;

impl Receiver {
    /// Returns which part of the picture, 0 to 1, this piece covers, as far as it is in view; what stands before it is not
    /// asked about. `clip_from_world` places a point in clip space, whose near plane is `near`, positive inside.
    pub fn picture_share(
        &self,
        world: &[DVec3],
        triangles: &[[u32; 3]],
        near: DVec4,
        clip_from_world: impl Fn(DVec3) -> DVec4,
    ) -> f64 {
        let planes = clip_planes(near, 1.0);
        let share = |triangle: &u32| {
            let seen = visible(&planes, triangles[*triangle as usize].map(|v| clip_from_world(world[v as usize])));
            let places: Vec<DVec2> = seen.iter().map(|corner| corner.truncate().truncate() / corner.w).collect();
            let fan = places.windows(2).skip(1).map(|pair| (pair[0] - places[0]).perp_dot(pair[1] - places[0]));
            // The picture is 2 by 2, and a triangle is half of what its sides span.
            fan.sum::<f64>().abs() / 8.0
        };
        self.triangles.iter().map(share).sum()
    }
}

/// Returns for each flat piece of a mesh whether it is a facet of a curved surface: at half of the edges of its outline or
/// more, the surface goes on in another piece and turns by less than 50 degrees.
pub fn facets(pieces: &[Receiver], count: usize, edges: &EdgeList) -> Vec<bool> {
    let mut piece_of = vec![None; count];
    for (index, piece) in pieces.iter().enumerate() {
        piece.triangles.iter().for_each(|triangle| piece_of[*triangle as usize] = Some(index));
    }
    // Of each piece's outline, all edges and those at which the surface goes on.
    let mut outlines = vec![[0_u32; 2]; pieces.len()];
    let normal = |piece: usize| pieces[piece].plane.normal;
    for edge in 0..edges.edges().len() {
        let meeting = || edges.incident(edge).filter_map(|(triangle, _)| piece_of[triangle]);
        for piece in meeting() {
            let mut others = meeting().filter(|other| *other != piece).peekable();
            let is_inner = others.peek().is_none() && meeting().count() > 1;
            let goes_on = others.any(|other| normal(other).dot(normal(piece)).abs() > CURVED);
            outlines[piece][0] += u32::from(!is_inner);
            outlines[piece][1] += u32::from(goes_on);
        }
    }
    outlines.into_iter().map(|[all, smooth]| smooth > 0 && 2 * smooth >= all).collect()
}

/// Returns the flat pieces of a mesh with vertices `world`; `object` are its vertices in object space, by which it is
/// decided what is coplanar. Triangles without area belong to none.
pub fn receivers(object: &[DVec3], world: &[DVec3], triangles: &[[u32; 3]], edges: &EdgeList) -> Vec<Receiver> {
    let edges_of = edges_of_triangles(triangles.len(), edges);
    let mut walk = EdgeTraversal { edges, edges_of, taken: vec![false; triangles.len()] };
    let size = extent(object);
    let mut found = Vec::new();
    for seed in 0..triangles.len() {
        let Some(plane) = plane_of(object, triangles[seed]).filter(|_| !walk.taken[seed]) else { continue };
        let coplanar = |triangle: u32| {
            let corners = triangles[triangle as usize].map(|v| plane.at(object[v as usize].extend(1.0)));
            corners.iter().all(|distance| distance.abs() <= COPLANAR * size)
        };
        let members = walk.from(seed as u32, coplanar);
        found.extend(receiver(world, triangles, members));
    }
    found
}

fn extent(positions: &[DVec3]) -> f64 {
    let low = positions.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let high = positions.iter().copied().reduce(DVec3::max).unwrap_or_default();
    (high - low).max_element()
}

fn plane_of(positions: &[DVec3], corners: [u32; 3]) -> Option<Plane> {
    let [a, b, c] = corners.map(|v| positions[v as usize]);
    let normal = (b - a).cross(c - a);
    (normal.length() > 0.0 && normal.is_finite()).then(|| Plane::through(a, normal))
}

/// Returns for each of `count` triangles the indices of its edges in the list, ascending.
fn edges_of_triangles(count: usize, edges: &EdgeList) -> Vec<Vec<u32>> {
    let mut of_triangle = vec![Vec::with_capacity(3); count];
    for edge in 0..edges.edges().len() {
        edges.incident(edge).for_each(|(triangle, _)| of_triangle[triangle].push(edge as u32));
    }
    of_triangle
}

/// A traversal of triangles over the edges they share.
struct EdgeTraversal<'a> {
    edges: &'a EdgeList,
    edges_of: Vec<Vec<u32>>,
    taken: Vec<bool>,
}

impl EdgeTraversal<'_> {
    /// Returns `seed` and the triangles that are connected with it by edges through triangles for which `belongs` is
    /// true, ascending, and marks them as taken. Triangles taken before are left out; `belongs` is not asked about
    /// `seed`.
    fn from(&mut self, seed: u32, belongs: impl Fn(u32) -> bool) -> Vec<u32> {
        let mut members = vec![seed];
        let mut waiting = vec![seed];
        self.taken[seed as usize] = true;
        while let Some(triangle) = waiting.pop() {
            for &edge in &self.edges_of[triangle as usize] {
                for (next, _) in self.edges.incident(edge as usize) {
                    if !self.taken[next] && belongs(next as u32) {
                        self.taken[next] = true;
                        members.push(next as u32);
                        waiting.push(next as u32);
                    }
                }
            }
        }
        members.sort_unstable();
        members
    }
}

/// Makes a receiver of these triangles: its plane has their area-weighted normal and goes through the mean of their
/// corners. `None` where they have no area.
fn receiver(world: &[DVec3], triangles: &[[u32; 3]], members: Vec<u32>) -> Option<Receiver> {
    let corners = members.iter().map(|t| triangles[*t as usize].map(|v| world[v as usize]));
    let twice_areas: Vec<DVec3> = corners.clone().map(|[a, b, c]| (b - a).cross(c - a)).collect();
    // Coplanar triangles may wind either way: turn them all like the first.
    let first = *twice_areas.first()?;
    let normal: DVec3 = twice_areas.iter().map(|n| if n.dot(first) < 0.0 { -*n } else { *n }).sum();
    if normal.length() == 0.0 || !normal.is_finite() {
        return None;
    }
    let middle = corners.flatten().sum::<DVec3>() / (3 * members.len()) as f64;
    let area = twice_areas.iter().map(|n| n.length() / 2.0).sum();
    Some(Receiver { plane: Plane::through(middle, normal), triangles: members, area })
}

/// Which part of a caster is flattened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FlattenClip {
    /// Only what lies between the plane and the light.
    BetweenPlaneAndLight,
    /// All of it: what lies beyond the light gives an anti-shadow, what lies below the plane a false shadow.
    Off,
    /// All of it, with w as the shadow matrix makes it: negative beyond the light, where a GPU clips.
    Undivided,
}

/// What a flattened caster depends on; its key in the cache.
#[derive(Debug, Clone, Copy)]
pub struct FlattenedCaster {
    /// Hash of the caster's mesh.
    pub mesh: u64,
    /// Where the caster is placed.
    pub pose: Pose,
    /// The plane that it is flattened onto.
    pub plane: Plane,
    /// Homogeneous world position of the light.
    pub light: DVec4,
    /// Which part of it is flattened.
    pub clip: FlattenClip,
    /// Whether only the triangles are flattened that face the light.
    pub faces_light: bool,
    /// Index of the receiver's first triangle, where the receiver is a part of the caster; otherwise `None`.
    pub own: Option<u32>,
}

impl FlattenedCaster {
    /// Returns a hash of all fields, for the cache: equal for equal values. It may differ between versions of the
    /// program.
    pub fn key(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        // Debug text prints every number in full.
        format!("{self:?}").hash(&mut hasher);
        hasher.finish()
    }
}

/// Flattens casting triangles onto planes, one plane at a time.
#[derive(Debug)]
pub struct Flattener {
    plane: Plane,
    light: DVec4,
    clip: FlattenClip,
    /// The light's height over the plane (point light), or its direction's component along the normal (directional);
    /// positive.
    light_height: f64,
    /// Homogeneous world positions of the shadow triangles so far.
    triangles: Vec<[DVec4; 3]>,
}

impl Flattener {
    /// Makes a flattener onto `plane`, oriented towards the light; `None` where the light lies in the plane.
    pub fn new(plane: Plane, light: DVec4, clip: FlattenClip) -> Option<Flattener> {
        let plane = if plane.at(light) < 0.0 { plane.flipped() } else { plane };
        let light_height = plane.at(light);
        (light_height > 0.0).then(|| Flattener { plane, light, clip, light_height, triangles: Vec::new() })
    }

    /// Returns the plane that it flattens onto, its normal towards the light.
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// Appends the flattened triangles of a mesh (vertices in world space). The vertices with the indices `on_plane`
    /// count as exactly on the plane. With clipping, what does not lie between plane and light adds nothing; without,
    /// only triangles in the plane are left out.
    pub fn add(&mut self, world: &[DVec3], triangles: &[[u32; 3]], on_plane: &[u32]) {
        let mut heights: Vec<f64> = world.iter().map(|position| self.plane.height(*position)).collect();
        on_plane.iter().for_each(|vertex| heights[*vertex as usize] = 0.0);
        if self.clip == FlattenClip::BetweenPlaneAndLight && heights.iter().all(|height| *height <= 0.0) {
            return;
        }
        for corners in triangles {
            let corners = corners.map(|vertex| (world[vertex as usize], heights[vertex as usize]));
            match self.clip {
                FlattenClip::BetweenPlaneAndLight if corners.iter().any(|(_, height)| *height > 0.0) => {
                    self.add_triangle(corners);
                }
                FlattenClip::BetweenPlaneAndLight => {}
                _ if corners.iter().all(|(_, height)| *height == 0.0) => {}
                FlattenClip::Undivided => {
                    self.triangles.push(corners.map(|(point, height)| self.shadow(point, height)));
                }
                FlattenClip::Off => self.triangles.push(corners.map(|(point, height)| self.projected(point, height))),
            }
        }
    }

    /// Appends the shadow of one triangle, clipped to what lies between the plane and a point light (only above the
    /// plane for a directional one), as a fan of triangles. Each corner comes with its height over the plane.
    fn add_triangle(&mut self, corners: [(DVec3, f64); 3]) {
        let mut polygon = clip(&corners, 0.0, |h| h);
        if self.light.w != 0.0 {
            polygon = clip(&polygon, self.light_height, |h| self.light_height - h);
        }
        let shadows: Vec<DVec4> = polygon.iter().map(|(point, h)| self.shadow(*point, *h)).collect();
        for pair in shadows.windows(2).skip(1) {
            self.triangles.push([shadows[0], pair[0], pair[1]]);
        }
    }

    /// Returns the shadow of a point: `V − L (P·V) / (P·L)`, Blinn's `(P·L) V − (P·V) L` (1988) without its scale. w is
    /// 1 on the plane and exactly 0 for a corner that was clipped level with the light.
    fn shadow(&self, point: DVec3, height: f64) -> DVec4 {
        point.extend(1.0) - self.light * (height / self.light_height)
    }

    /// Returns the flattened point divided by w (w is 1): a point beyond the light is carried back through it onto the
    /// plane. A point level with the light stays a direction, w 0.
    fn projected(&self, point: DVec3, height: f64) -> DVec4 {
        let shadow = self.shadow(point, height);
        if shadow.w == 0.0 { shadow } else { shadow / shadow.w }
    }

    /// Returns the shadow matrix, `(P·L) I − L Pᵀ` of Blinn (1988): it carries a homogeneous world position to its shadow, whose
    /// w is the light's height over the plane less the point's (of a directional light, the light's alone).
    pub fn matrix(&self) -> DMat4 {
        let plane = self.plane.normal.extend(self.plane.offset);
        let columns = plane.to_array().map(|of_plane| self.light * of_plane);
        DMat4::from_diagonal(DVec4::splat(self.light_height))
            - DMat4::from_cols(columns[0], columns[1], columns[2], columns[3])
    }

    /// Returns the triangles of the shadow: homogeneous world positions, with w ≥ 0 but of what is beyond the light and
    /// not divided.
    pub fn finish(self) -> Vec<[DVec4; 3]> {
        self.triangles
    }
}

/// Clips a polygon (Sutherland and Hodgman 1974) to the part where `inside(height) ≥ 0`. New corners have the height
/// `limit` exactly, whatever their position rounds to.
fn clip(polygon: &[(DVec3, f64)], limit: f64, inside: impl Fn(f64) -> f64) -> Vec<(DVec3, f64)> {
    let mut clipped = Vec::with_capacity(polygon.len() + 1);
    for (index, &(point, height)) in polygon.iter().enumerate() {
        let (next_point, next_height) = polygon[(index + 1) % polygon.len()];
        let (here, there) = (inside(height), inside(next_height));
        if here >= 0.0 {
            clipped.push((point, height));
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            let t = here / (here - there);
            clipped.push((point + (next_point - point) * t, limit));
        }
    }
    clipped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::clip::near_plane;
    use crate::math::depth::DepthMapping;
    use crate::math::projection;
    use crate::scene::{Mesh, shapes};

    #[test]
    fn a_box_has_six_receivers_of_two_triangles() {
        let world: Vec<DVec3> =
            (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2) * 2.0)).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let edges = EdgeList::new(&triangles, 8);
        let found = receivers(&world, &world, &triangles, &edges);
        assert_eq!(found.len(), 6);
        assert!(found.iter().all(|receiver| receiver.triangles.len() == 2));
        assert!((found.iter().map(|receiver| receiver.area).sum::<f64>() - 10.0).abs() < 1e-12);
    }

    /// A wall across half of the picture, one that reaches behind the eye, and one that is behind it.
    #[test]
    fn a_piece_covers_the_part_of_the_picture_that_it_is_seen_in() {
        let depth = DepthMapping::ReversedInfinite.curve(0.1, 0.0, 0.0);
        let clip_from_view = projection::perspective(90.0, 1.0, &depth);
        let share = |corners: [[f64; 3]; 4]| {
            let world = corners.map(DVec3::from_array);
            let triangles = [[0, 1, 2], [0, 2, 3]];
            let found = receivers(&world, &world, &triangles, &EdgeList::new(&triangles, 4));
            let clip = |point: DVec3| clip_from_view * point.extend(1.0);
            found[0].picture_share(&world, &triangles, near_plane(&depth), clip)
        };
        let wall = |z: f64| [[0.0, -9.0, z], [9.0, -9.0, z], [9.0, 9.0, z], [0.0, 9.0, z]];
        assert!((share(wall(-3.0)) - 0.5).abs() < 1e-12);
        assert_eq!(share(wall(3.0)), 0.0);
        assert!(
            (share([[-1.0, -1.0, -2.0], [1.0, -1.0, -2.0], [1.0, 1.0, -2.0], [-1.0, 1.0, -2.0]]) - 0.25).abs() < 1e-12
        );
        // A floor from behind the eye to a line in the middle of the lower half.
        let floor = [[-99.0, -1.0, 5.0], [99.0, -1.0, 5.0], [99.0, -1.0, -2.0], [-99.0, -1.0, -2.0]];
        assert!((share(floor) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn sides_of_a_box_are_no_facets_and_those_of_a_column_of_eight_are() {
        let facets = |mesh: &Mesh| {
            let edges = EdgeList::new(mesh.triangles(), mesh.positions().len());
            let found = receivers(mesh.positions(), mesh.positions(), mesh.triangles(), &edges);
            let facets = facets(&found, mesh.triangles().len(), &edges);
            [facets.iter().filter(|is| **is).count(), found.len()]
        };
        assert_eq!(facets(&shapes::cuboid([1.0, 2.0, 3.0]).expect("a box")), [0, 6]);
        assert_eq!(facets(&shapes::quad([1.0; 2]).expect("a quad")), [0, 1]);
        assert_eq!(facets(&shapes::cylinder(0.2, 3.0, 8).expect("a column")), [8, 10]);
        let torus = facets(&shapes::torus(0.5, 0.2, 32, 16).expect("a ring"));
        assert_eq!(torus[0], torus[1]);
    }

    fn shadow_area(corners: [DVec3; 3], light: DVec4) -> f64 {
        let mut flattener =
            Flattener::new(Plane::through(DVec3::ZERO, DVec3::Y), light, FlattenClip::BetweenPlaneAndLight)
                .expect("a light above");
        flattener.add(&corners, &[[0, 1, 2]], &[]);
        let area = |[a, b, c]: [DVec4; 3]| {
            let [a, b, c] = [a, b, c].map(|v| v.truncate() / v.w);
            (b - a).cross(c - a).length() / 2.0
        };
        flattener.finish().into_iter().map(area).sum()
    }

    const LIGHT: DVec4 = DVec4::new(0.0, 4.0, 0.0, 1.0);

    /// A shadow lies on the plane, and on the line through light and point: the definition.
    #[test]
    fn a_shadow_is_where_the_ray_from_the_light_meets_the_plane() {
        let plane = Plane::through(DVec3::new(0.3, -1.0, 2.0), DVec3::new(0.2, 1.0, -0.1));
        for light in [DVec4::new(3.0, 7.0, -2.0, 1.0), DVec4::new(0.4, 1.0, 0.3, 0.0)] {
            let flattener = Flattener::new(plane, light, FlattenClip::BetweenPlaneAndLight).expect("a light above");
            for point in [DVec3::new(0.0, 1.0, 0.0), DVec3::new(-4.0, 2.0, 5.0), DVec3::new(1.0, 0.5, 1.0)] {
                let shadow = flattener.shadow(point, plane.at(point.extend(1.0)));
                assert!(shadow.w > 0.0);
                let shadow = shadow.truncate() / shadow.w;
                assert!(plane.at(shadow.extend(1.0)).abs() < 1e-9);
                let ray = if light.w == 0.0 { light.truncate() } else { light.truncate() - point };
                assert!((shadow - point).cross(ray).length() < 1e-9 * ray.length());
                assert!((shadow - point).dot(ray) < 0.0, "the shadow is beyond the point, away from the light");
            }
        }
    }

    #[test]
    fn a_level_triangle_halfway_up_throws_four_times_its_area() {
        let corners = [DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, 2.0, 0.0), DVec3::new(0.0, 2.0, 1.0)];
        assert!((shadow_area(corners, LIGHT) - 2.0).abs() < 1e-12);
        assert!((shadow_area(corners, DVec4::new(1.0, 1.0, 0.0, 0.0)) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn nothing_beyond_the_light_or_below_the_plane_throws_a_shadow() {
        for y in [-1.0, 5.0] {
            let corners = [DVec3::new(0.0, y, 0.0), DVec3::new(1.0, y, 0.0), DVec3::new(0.0, y, 1.0)];
            assert_eq!(shadow_area(corners, LIGHT), 0.0);
        }
    }

    #[test]
    fn a_triangle_that_reaches_past_the_light_throws_a_shadow_to_infinity() {
        let corners = [DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 1.0, 0.0), DVec3::new(1.0, 6.0, 0.5)];
        let mut flattener =
            Flattener::new(Plane::through(DVec3::ZERO, DVec3::Y), LIGHT, FlattenClip::BetweenPlaneAndLight)
                .expect("a light above");
        flattener.add(&corners, &[[0, 1, 2]], &[]);
        let corners: Vec<DVec4> = flattener.finish().into_iter().flatten().collect();
        assert!(corners.iter().all(|corner| corner.w >= 0.0));
        assert!(corners.iter().any(|corner| corner.w == 0.0), "cut level with the light: at infinity exactly");
    }

    #[test]
    fn a_triangle_through_the_plane_throws_only_its_upper_part() {
        let corners = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 1.0)];
        // Above the plane: between the level edge (shadow scaled by 4/3) and the cut at x = 1/2.
        let (cut, top) = (0.5, 4.0 / 3.0);
        let expected = (cut + top) / 2.0 * (top - cut);
        assert!((shadow_area(corners, LIGHT) - expected).abs() < 1e-12);
    }
}
