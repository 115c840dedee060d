//! Questions about single rays: what is visible at a point of the picture, and what its light ray hits.
//!
//! Which triangles a ray hits is decided as for the truth itself. The distance along it is not exact: it is for people,
//! and for distinguishing causes.

use super::direction_projection::OriginRay;
use super::hierarchy::SearchLimit;
use super::packet::RayPacket;
use super::shadow::{LightRays, OccludingTriangle};
use super::{TracedSurface, Tracer, TriangleSource};
use crate::math::{Sign, side_of_triangle};
use glam::{DVec3, DVec4};

/// The surface that the view ray through a point of the picture hits.
#[derive(Debug, Clone, Copy)]
pub struct SeenSurface {
    /// The object and the triangle.
    pub place: TriangleSource,
    /// Where the ray hits it, world space.
    pub point: DVec3,
    /// The triangle's corners, world space.
    pub corners: [DVec3; 3],
    surface: TracedSurface,
}

/// A casting triangle that the line through a light and a point hits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OccluderHit {
    /// The object and the triangle.
    pub place: TriangleSource,
    /// The triangle's corners, world space.
    pub corners: [DVec3; 3],
    /// Distance of the hit from the point, metres: positive towards the light, negative away from it.
    pub towards_light: f64,
    /// Whether the light is on the triangle's front side, from which its corners run counter-clockwise.
    pub faces_light: bool,
}

impl Tracer {
    /// Returns the surface at a point of the picture, in pixels (the first pixel's centre is (0.5, 0.5)); `None` for
    /// the background.
    pub fn seen_at(&self, point: [f64; 2]) -> Option<SeenSurface> {
        let [surface] = self.surfaces_at([point]);
        surface.map(|surface| SeenSurface {
            place: self.world.place(surface.triangle),
            point: surface.point,
            corners: self.world.triangles[surface.triangle],
            surface,
        })
    }

    /// Returns where the view ray through a point of the picture begins: on the near plane, world space.
    pub fn near_point(&self, point: [f64; 2]) -> DVec3 {
        self.view.eye + self.view.ray(point).at(self.view.near)
    }

    /// Returns the distance of a world position from the eye along the view's axis, metres.
    pub fn depth_of(&self, position: DVec3) -> f64 {
        (position - self.view.eye).dot(self.view.axis())
    }

    /// Returns the name of a triangle's object.
    pub fn name(&self, place: TriangleSource) -> &str {
        self.world.object_name(place.object)
    }

    /// Returns the name of the object with this index.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn object_name(&self, object: usize) -> &str {
        self.world.object_name(object)
    }

    /// Returns the casting triangles between a light and a seen surface, the nearest to the surface first. There are
    /// some exactly where the truth is in shadow, except on objects that receive no shadows.
    ///
    /// # Panics
    /// If there is no such light.
    pub fn between(&self, light: usize, seen: &SeenSurface) -> Vec<OccluderHit> {
        self.between_in_plane(light, seen, seen.point)
    }

    /// Returns the casting triangles between a light and a point in the plane of a seen surface, which may lie outside of
    /// its triangle, the nearest to the point first: those that shadow the point as if the surface reached so far.
    ///
    /// # Panics
    /// If there is no such light.
    pub fn between_in_plane(&self, light: usize, seen: &SeenSurface, point: DVec3) -> Vec<OccluderHit> {
        let moved = point - seen.point;
        let surface = TracedSurface { point, offset: seen.surface.offset + moved, ..seen.surface };
        let of_rays = |rays: &LightRays| {
            let mut found = Vec::new();
            let mut packet = RayPacket::new(OriginRay::To);
            packet.push(point);
            rays.hierarchy.for_each_hit(&packet, |hit, corners, _| {
                let mut occluder = OccludingTriangle::new(rays.hierarchy.origin, hit, corners);
                if self.lies_between(rays, &mut occluder, &surface) {
                    found.push(hit.index as usize);
                }
                SearchLimit::NOTHING
            });
            self.hits(rays, point, found)
        };
        nearest_first(self.lights[light].rays().flat_map(of_rays).collect())
    }

    /// Returns the casting triangles strictly between a light and any world position, the nearest to the position
    /// first.
    ///
    /// # Panics
    /// If there is no such light.
    pub fn between_points(&self, light: usize, point: DVec3) -> Vec<OccluderHit> {
        let between = |rays: &LightRays| {
            let farthest = rays.distance(point);
            let mut all = self.along_rays(rays, point);
            all.retain(|hit| hit.towards_light > 0.0 && hit.towards_light < farthest);
            all
        };
        nearest_first(self.lights[light].rays().flat_map(between).collect())
    }

    /// Returns the casting triangles that the whole line through a light and a world position hits: between the two,
    /// behind the position, and beyond the light; ordered by their distance towards the light.
    ///
    /// # Panics
    /// If there is no such light.
    pub fn along(&self, light: usize, point: DVec3) -> Vec<OccluderHit> {
        nearest_first(self.lights[light].rays().flat_map(|rays| self.along_rays(rays, point)).collect())
    }

    fn along_rays(&self, rays: &LightRays, point: DVec3) -> Vec<OccluderHit> {
        let (away, distance) = (-rays.towards(point), rays.distance(point));
        let reach = 4.0 * (self.world.reach(point) + if distance.is_finite() { distance } else { 0.0 });
        let mut ends = vec![point + away * reach];
        if rays.position.w != 0.0 {
            ends.push(rays.position.truncate() - away * reach);
        }
        let mut found = Vec::new();
        for end in ends {
            let mut packet = RayPacket::new(OriginRay::To);
            packet.push(end);
            rays.hierarchy.for_each_hit(&packet, |hit, _, _| {
                found.push(hit.index as usize);
                SearchLimit::NOTHING
            });
        }
        self.hits(rays, point, found)
    }

    /// Returns the distance of a light from a world position, metres; infinite for a directional light.
    ///
    /// # Panics
    /// If there is no such light.
    pub fn light_distance(&self, light: usize, point: DVec3) -> f64 {
        self.lights[light].own.distance(point)
    }

    /// Returns the unit direction from a world position to a light; zero where the position is the light's own.
    ///
    /// # Panics
    /// If there is no such light.
    pub fn towards(&self, light: usize, point: DVec3) -> DVec3 {
        self.lights[light].own.towards(point)
    }

    /// Returns the homogeneous world position of a light; w is 0 for a directional one.
    ///
    /// # Panics
    /// If there is no such light.
    pub fn light_position(&self, light: usize) -> DVec4 {
        self.lights[light].own.position
    }

    /// Returns these triangles as hits of the line through a light's position and a point, where it has a distance.
    fn hits(&self, rays: &LightRays, point: DVec3, mut triangles: Vec<usize>) -> Vec<OccluderHit> {
        let towards = rays.towards(point);
        triangles.sort_unstable();
        triangles.dedup();
        let hit = |triangle: usize| {
            let corners = self.world.triangles[triangle];
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a);
            OccluderHit {
                place: self.world.place(triangle),
                corners,
                towards_light: normal.dot(a - point) / normal.dot(towards),
                faces_light: side_of_triangle(corners, rays.position) == Sign::Positive,
            }
        };
        triangles.into_iter().map(hit).filter(|hit| hit.towards_light.is_finite()).collect()
    }
}

fn nearest_first(mut hits: Vec<OccluderHit>) -> Vec<OccluderHit> {
    hits.sort_by(|a, b| a.towards_light.total_cmp(&b.towards_light));
    hits
}

impl LightRays {
    /// Returns the distance of the light from a world position, metres; infinite for a directional light.
    fn distance(&self, point: DVec3) -> f64 {
        if self.position.w == 0.0 { f64::INFINITY } else { (self.position.truncate() - point).length() }
    }

    /// Returns the unit direction from a world position to the light; zero where the position is the light's own.
    fn towards(&self, point: DVec3) -> DVec3 {
        (self.position.truncate() - point * self.position.w).normalize_or_zero()
    }
}
