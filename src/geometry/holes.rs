//! What a mesh with holes hides of itself.
//!
//! Let each hole have a cap, and let the mesh with all caps bound solids. A ray from outside that meets a triangle from
//! behind leaves a solid there, so it has entered it just before: through the mesh itself, which hides the triangle, or
//! through a cap. A triangle that faces away so shows, or is lit, only behind a cap; where none lies before it, what the
//! triangle darkens is dark without it. A mesh of several parts, some closed and some with holes, is one case of this.
//!
//! Whether the capped mesh bounds solids is decided by exact signs, as for closed meshes. Whether a cap lies before a
//! triangle is asked of balls around both, with a margin far above rounding: what is near a cap counts as behind it.

use super::{Caster, Connectivity, EdgeList, solid};
use crate::math::AxisBox;
use crate::scene::{Mesh, MeshBuilder};
use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;
use std::ops::Range;

/// A mesh of fewer triangles than this times its open edges is a sheet rather than a body: it is not capped.
const LEAST_TRIANGLES_AN_EDGE: usize = 4;
/// The most edges of a rim whose ears are cut one by one, which takes their number to the third.
const MOST_FILLED: usize = 256;
/// The most work that is done for one place, holes times triangles: a mesh that would need more is not capped.
const MOST_WORK: usize = 1 << 24;
/// One triangle in so many must be hidden for it to pay: a cup that is seen from above shows nearly all of it.
const LEAST_HIDDEN: usize = 8;
/// Cosine between a triangle's normal and a ray that is taken for edge-on: only what turns away by more faces away.
const EDGE_ON: f64 = 1e-4;
/// By how much more than they are balls are taken to reach: radians for what is seen from a point, else relative to the
/// mesh's size. A step of a rasteriser's grid is a hundredth of it.
const MARGIN: f64 = 1e-4;

/// A mesh with a cap on each of its holes, which then bounds solids.
#[derive(Debug)]
pub struct CappedMesh {
    /// The mesh's own vertices and triangles, then those of the caps.
    pub mesh: Mesh,
    /// The triangles of each cap.
    caps: Vec<Range<usize>>,
}

impl CappedMesh {
    /// Caps the holes of a mesh: with triangles between the vertices of a rim, and of a very long or twisted one around its
    /// middle. Returns `None` for a mesh without holes, and where what is capped is not proven to bound solids.
    pub fn new(mesh: &Mesh, edges: &EdgeList, connectivity: &Connectivity) -> Option<CappedMesh> {
        let open = connectivity.open_edges.count;
        let is_body = open > 0 && mesh.triangles().len() >= LEAST_TRIANGLES_AN_EDGE * open;
        if !is_body || connectivity.non_manifold_edges.count > 0 || !connectivity.is_oriented() {
            return None;
        }
        let (mut positions, mut triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
        let mut caps = Vec::new();
        let rims = rims(edges, positions.len())?;
        // The proof would be for nothing.
        if rims.len().saturating_mul(triangles.len()) > MOST_WORK {
            return None;
        }
        for rim in rims {
            let first = triangles.len();
            match filled(&rim, &positions) {
                Some(filled) => triangles.extend(filled),
                None => {
                    let middle = rim.iter().map(|vertex| positions[*vertex as usize]).sum::<DVec3>() / rim.len() as f64;
                    let tip = positions.len() as u32;
                    positions.push(middle);
                    let ends = rim.iter().zip(rim.iter().cycle().skip(1));
                    triangles.extend(ends.map(|(from, to)| [*from, *to, tip]));
                }
            }
            caps.push(first..triangles.len());
        }
        let (vertices, count) = (positions.len(), triangles.len());
        let capped = MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().ok()?;
        // A middle that is a vertex already is joined with it.
        if capped.positions().len() != vertices || capped.triangles().len() != count {
            return None;
        }
        let edges = EdgeList::new(capped.triangles(), vertices);
        let connectivity = Connectivity::new(&capped, &edges);
        solid::check(capped.positions(), capped.triangles(), &connectivity).ok()?;
        Some(CappedMesh { mesh: capped, caps })
    }

    /// Returns the number of holes.
    pub fn holes(&self) -> usize {
        self.caps.len()
    }

    /// Returns the world positions of the capped mesh's vertices, where the mesh itself is placed.
    pub fn world(&self, placed: Caster) -> Vec<DVec3> {
        let tips = &self.mesh.positions()[placed.world.len()..];
        let world_from_object = placed.pose.world_from_object();
        placed.world.iter().copied().chain(tips.iter().map(|tip| world_from_object.transform_point3(*tip))).collect()
    }

    /// Returns for each triangle of the mesh itself whether it faces away from a place and has no cap before it. The place
    /// is homogeneous, in world space, and outside the capped mesh, whose world positions are given. `None` where
    /// they are so few that it does not pay.
    pub fn hidden(&self, world: &[DVec3], place: DVec4) -> Option<Vec<bool>> {
        let own = self.caps.first().map_or(0, |cap| cap.start);
        let margin = if place.w == 0.0 { MARGIN * AxisBox::around(world.iter().copied()).diagonal() } else { MARGIN };
        let corners = |triangle: usize| self.mesh.triangles()[triangle].map(|vertex| world[vertex as usize]);
        let ball = |points: &[DVec3]| SeenBall::around(points, place, margin);
        let caps: Vec<(SeenBall, Vec<SeenBall>)> = self
            .caps
            .iter()
            .filter_map(|cap| {
                // Through a cap that faces away, rays leave.
                let entered: Vec<[DVec3; 3]> =
                    cap.clone().map(corners).filter(|corners| cosine(corners, place) > -EDGE_ON).collect();
                (!entered.is_empty())
                    .then(|| (ball(entered.as_flattened()), entered.iter().map(|corners| ball(corners)).collect()))
            })
            .collect();
        let is_hidden = |triangle: usize| {
            let corners = corners(triangle);
            let is_away = cosine(&corners, place) < -EDGE_ON;
            is_away && {
                let own = ball(&corners);
                let is_before = |(around, parts): &(SeenBall, Vec<SeenBall>)| {
                    own.may_overlap(around) && parts.iter().any(|part| own.may_overlap(part))
                };
                !caps.iter().any(is_before)
            }
        };
        let hidden: Vec<bool> = (0..own).into_par_iter().with_min_len(1024).map(is_hidden).collect();
        let count = hidden.iter().filter(|is_hidden| **is_hidden).count();
        (count * LEAST_HIDDEN >= own).then_some(hidden)
    }
}

/// Returns the vertices of each hole's rim in order, so that a cap's triangles run along its edges against the mesh's
/// own; `None` where open edges form no closed rims. Every edge of the mesh has one triangle, or two that run it either
/// way.
fn rims(edges: &EdgeList, vertex_count: usize) -> Option<Vec<Box<[u32]>>> {
    let mut next: Vec<Vec<u32>> = vec![Vec::new(); vertex_count];
    let mut starts = Vec::new();
    for (index, edge) in edges.edges().iter().enumerate() {
        let mut incident = edges.incident(index);
        let (Some((_, direction)), None) = (incident.next(), incident.next()) else { continue };
        let [from, to] = if direction > 0 { [edge.high, edge.low] } else { [edge.low, edge.high] };
        next[from as usize].push(to);
        starts.push(from);
    }
    let mut rims = Vec::new();
    for start in starts {
        let mut path = vec![start];
        while let Some(vertex) = path.last().and_then(|last| next[*last as usize].pop()) {
            // Where rims touch in a vertex, each is closed as soon as the way comes back to it.
            match path.iter().rposition(|known| *known == vertex) {
                Some(at) => {
                    rims.push(path.drain(at..).collect());
                    path.push(vertex);
                }
                None => path.push(vertex),
            }
        }
        if path != [start] {
            return None;
        }
    }
    Some(rims)
}

/// Returns triangles between the vertices of a rim that fill it, as they look along the rim's mean normal: one ear after
/// the other is cut off, the shortest cut first. `None` where no ear is left, and for a rim that is too long for that.
fn filled(rim: &[u32], positions: &[DVec3]) -> Option<Vec<[u32; 3]>> {
    if rim.len() > MOST_FILLED {
        return None;
    }
    let places: Vec<DVec3> = rim.iter().map(|vertex| positions[*vertex as usize]).collect();
    let middle = places.iter().sum::<DVec3>() / places.len() as f64;
    let ends = places.iter().zip(places.iter().cycle().skip(1));
    let normal = ends.map(|(from, to)| (from - middle).cross(to - middle)).sum::<DVec3>().try_normalize()?;
    let right = normal.any_orthonormal_vector();
    let up = normal.cross(right);
    let flat: Vec<DVec2> = places.iter().map(|place| DVec2::new(right.dot(*place), up.dot(*place))).collect();
    let is_left = |from: usize, to: usize, of: usize| (flat[to] - flat[from]).perp_dot(flat[of] - flat[from]) > 0.0;
    let mut left: Vec<usize> = (0..rim.len()).collect();
    let mut triangles = Vec::with_capacity(rim.len());
    while left.len() > 3 {
        let ear = |at: usize| [at + left.len() - 1, at, at + 1].map(|place| left[place % left.len()]);
        let length = |at: &usize| {
            let [from, _, to] = ear(*at);
            flat[from].distance_squared(flat[to])
        };
        let is_free = |at: &usize| {
            let [a, b, c] = ear(*at);
            let holds = |other: usize| !(is_left(b, a, other) || is_left(c, b, other) || is_left(a, c, other));
            is_left(a, b, c) && !left.iter().any(|other| ![a, b, c].contains(other) && holds(*other))
        };
        let free = (0..left.len()).filter(is_free);
        let cut = free.min_by(|one, other| length(one).total_cmp(&length(other)))?;
        triangles.push(ear(cut).map(|place| rim[place]));
        left.remove(cut);
    }
    triangles.push([0, 1, 2].map(|place| rim[left[place]]));
    Some(triangles)
}

/// Returns the cosine between a triangle's normal and the direction to a homogeneous place: negative where the triangle
/// faces away; 0 without an area.
fn cosine(&[a, b, c]: &[DVec3; 3], place: DVec4) -> f64 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal.dot((place.truncate() - a * place.w).normalize_or_zero())
}

/// A ball as it is seen from a place: around a direction and by an angle from a point, around a position and by a radius
/// along a direction.
#[derive(Debug, Clone, Copy)]
struct SeenBall {
    at: DVec3,
    reach: f64,
}

impl SeenBall {
    /// Returns a ball that contains these points, as seen from a homogeneous place, larger by `margin`.
    fn around(points: &[DVec3], place: DVec4, margin: f64) -> SeenBall {
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let radius = points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
        if place.w == 0.0 {
            let along = place.truncate().normalize();
            return SeenBall { at: middle - along * middle.dot(along), reach: radius + margin };
        }
        let way = middle - place.truncate() / place.w;
        let sine = radius / way.length();
        // Around the place itself it is seen everywhere.
        let angle = if sine < 1.0 { sine.asin() } else { f64::INFINITY };
        SeenBall { at: way.normalize_or_zero(), reach: angle + margin }
    }

    /// Returns whether one may lie before the other; false is certain. The distance of two directions is less than the
    /// angle between them.
    fn may_overlap(&self, other: &SeenBall) -> bool {
        let reach = self.reach + other.reach;
        self.at.distance_squared(other.at) <= reach * reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Sign, side_of_triangle};
    use crate::scene::{Object, Pose, shapes};
    use std::sync::Arc;

    fn capped(mesh: &Mesh) -> Option<CappedMesh> {
        let edges = EdgeList::new(mesh.triangles(), mesh.positions().len());
        CappedMesh::new(mesh, &edges, &Connectivity::new(mesh, &edges))
    }

    /// The mesh without the triangles with these indices.
    fn without(mesh: &Mesh, removed: &[usize]) -> Mesh {
        let kept = mesh.triangles().iter().enumerate().filter(|(index, _)| !removed.contains(index));
        let triangles = kept.map(|(_, corners)| *corners).collect();
        let builder = MeshBuilder { positions: mesh.positions().to_vec(), triangles, ..MeshBuilder::default() };
        builder.build().expect("a mesh")
    }

    fn ball() -> Mesh {
        shapes::sphere(1.0, 32, 16).expect("a ball")
    }

    #[test]
    fn bodies_with_holes_are_capped_and_others_are_not() {
        assert!(capped(&ball()).is_none(), "it has no hole");
        assert_eq!(capped(&without(&ball(), &[40])).map(|capped| capped.holes()), Some(1));
        // Two triangles that touch in a corner, two that share an edge, and one apart.
        let holed = without(&ball(), &[0, 2, 300, 301, 700]);
        assert_eq!(capped(&holed).map(|capped| capped.holes()), Some(4));
        assert!(capped(&without(&shapes::torus(1.0, 0.4, 24, 12).expect("a torus"), &[5, 6, 7])).is_some());
        let sheet = shapes::triangles(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], &[[0, 1, 2]]).expect("a triangle");
        assert!(capped(&sheet).is_none());
        // Inside out, and a body that meets itself.
        let turned = ball().triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
        let builder =
            MeshBuilder { positions: ball().positions().to_vec(), triangles: turned, ..MeshBuilder::default() };
        assert!(capped(&without(&builder.build().expect("a mesh"), &[40])).is_none());
        let two = shapes::joined([(&ball(), DVec3::ZERO), (&ball(), DVec3::X * 0.7)]).expect("two balls");
        assert!(capped(&without(&two, &[40])).is_none());
    }

    /// Whatever a hidden triangle darkens, another triangle of the mesh darkens.
    #[test]
    fn every_ray_to_a_hidden_triangle_meets_another_before() {
        let ring = shapes::torus(1.0, 0.4, 40, 20).expect("a torus");
        let two = shapes::joined([(&ball(), DVec3::ZERO), (&ring, DVec3::X * 3.0)]).expect("a ball and a ring");
        let meshes = [
            without(&ball(), &(100..130).collect::<Vec<_>>()),
            without(&ring, &[3, 4, 5, 99, 100, 101, 102, 500, 501, 700]),
            without(&two, &[50, 51, 300, 400]),
        ];
        let pose =
            Pose { rotate_degrees: DVec3::new(20.0, 50.0, -70.0), scale: DVec3::new(1.0, 2.0, 0.7), ..Pose::default() };
        let mut hidden_in_all = 0;
        for mesh in meshes.map(Arc::new) {
            let object = Object { pose, ..Object::of("it", mesh.clone()) };
            let world = object.world_positions();
            let capped = capped(&mesh).expect("a body with holes");
            let all = capped.world(Caster { mesh: &mesh, pose: &pose, world: &world });
            for place in [
                DVec4::new(3.0, 4.0, 5.0, 1.0),
                DVec4::new(-6.0, 0.5, 1.0, 1.0),
                DVec4::new(1.0, -9.0, 2.0, 1.0),
                DVec4::new(0.2, 1.0, 0.3, 0.0),
                DVec4::new(-1.0, 0.1, -0.4, 0.0),
            ] {
                let hidden = capped.hidden(&all, place).expect("not too much");
                let facing = |corners: &[u32; 3]| side_of_triangle(corners.map(|v| world[v as usize]), place);
                let away = mesh.triangles().iter().filter(|corners| facing(corners) == Sign::Negative).count();
                let count = hidden.iter().filter(|is_hidden| **is_hidden).count();
                assert!(count > away / 2, "{count} of {away} from {place}");
                hidden_in_all += count;
                for (corners, _) in mesh.triangles().iter().zip(&hidden).filter(|(_, is_hidden)| **is_hidden) {
                    let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
                    // Within the triangle: its edges may be seen, where they are the mesh's outline.
                    let middle = (a + b + c) / 3.0;
                    for point in [middle, a.lerp(middle, 0.02), b.lerp(middle, 0.02), c.lerp(middle, 0.02)] {
                        assert!(is_covered(&mesh, &world, &hidden, place, point), "{point} from {place}");
                    }
                }
            }
        }
        assert!(hidden_in_all > 2000);
    }

    /// Returns whether the ray from a place to a point meets a triangle that is not hidden before it gets there.
    fn is_covered(mesh: &Mesh, world: &[DVec3], hidden: &[bool], place: DVec4, point: DVec3) -> bool {
        let origin = if place.w == 0.0 { point + place.truncate() * 100.0 } else { place.truncate() };
        let way = point - origin;
        mesh.triangles().iter().zip(hidden).filter(|(_, is_hidden)| !**is_hidden).any(|(corners, _)| {
            let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
            let normal = (b - a).cross(c - a);
            let at = normal.dot(a - origin) / normal.dot(way);
            let hit = origin + way * at;
            let inside =
                |from: DVec3, to: DVec3| normal.dot((to - from).cross(hit - from)) >= -1e-9 * normal.length_squared();
            at > 0.0 && at < 1.0 - 1e-9 && inside(a, b) && inside(b, c) && inside(c, a)
        })
    }
}
