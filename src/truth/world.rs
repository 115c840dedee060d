//! All triangles of a scene in world space, and what they belong to.

use super::TruthError;
use crate::math::{Sign, side_of_triangle};
use crate::scene::{Object, Scene};
use glam::DVec3;

/// The largest coordinate relative to the eye: beyond it, products of coordinates overflow.
const FARTHEST: f64 = 1e30;

/// Which object a triangle belongs to, and which of its triangles it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TriangleSource {
    /// Index of its object in the scene.
    pub object: usize,
    /// Its index in the object's mesh.
    pub triangle: usize,
}

/// All triangles of a scene in one list, with their objects.
#[derive(Debug)]
pub struct TracedTriangles {
    /// The corners of each triangle, world space.
    pub triangles: Vec<[DVec3; 3]>,
    /// Index of the object of each triangle.
    owners: Vec<u32>,
    /// Index of each object's first triangle in the list.
    firsts: Vec<usize>,
    objects: Vec<Object>,
    /// Smallest and largest coordinates of all corners.
    bounds: [DVec3; 2],
}

impl TracedTriangles {
    /// Collects the triangles of all objects of a scene in world space, object by object. Fails where a corner is too
    /// far from the eye to be traced.
    pub fn new(scene: &Scene) -> Result<TracedTriangles, TruthError> {
        let bounds = [scene.camera.eye; 2];
        let mut world = TracedTriangles {
            triangles: Vec::new(),
            owners: Vec::new(),
            firsts: Vec::new(),
            objects: scene.objects.clone(),
            bounds,
        };
        for (index, object) in scene.objects.iter().enumerate() {
            let positions = object.world_positions();
            let is_usable = |position: &DVec3| (*position - scene.camera.eye).abs().max_element() <= FARTHEST;
            if !positions.iter().all(is_usable) {
                return Err(TruthError {
                    problem: format!(
                        "{} is too large or too far from the eye: move it nearer or scale it down",
                        object.name
                    ),
                });
            }
            let [low, high] = &mut world.bounds;
            positions.iter().for_each(|position| (*low, *high) = (low.min(*position), high.max(*position)));
            let (triangles, all) = (object.mesh.triangles(), &mut world.triangles);
            world.firsts.push(all.len());
            world.owners.resize(all.len() + triangles.len(), index as u32);
            all.extend(triangles.iter().map(|corners| corners.map(|vertex| positions[vertex as usize])));
        }
        Ok(world)
    }

    /// Returns the object, and the triangle in its mesh, that the triangle with this index in the list is.
    pub fn place(&self, index: usize) -> TriangleSource {
        let object = self.owners[index] as usize;
        TriangleSource { object, triangle: index - self.firsts[object] }
    }

    pub fn object_name(&self, object: usize) -> &str {
        &self.objects[object].name
    }

    /// Returns an upper bound for the distance of any corner from a point along any axis.
    pub fn reach(&self, point: DVec3) -> f64 {
        let [low, high] = self.bounds;
        (point - low).abs().max((high - point).abs()).max_element().max(f64::MIN_POSITIVE)
    }

    pub fn object(&self, index: usize) -> &Object {
        &self.objects[self.owners[index] as usize]
    }

    /// Returns whether two triangles (by index) belong to one object and lie in one plane, decided exactly by their
    /// positions in object space, as placing the object rounds.
    pub fn share_plane(&self, one: usize, other: usize) -> bool {
        let (one, other) = (self.place(one), self.place(other));
        if one.object != other.object {
            return false;
        }
        let mesh = &self.objects[one.object].mesh;
        let corners = |triangle: usize| mesh.triangles()[triangle].map(|vertex| mesh.positions()[vertex as usize]);
        let plane = corners(one.triangle);
        corners(other.triangle).iter().all(|corner| side_of_triangle(plane, corner.extend(1.0)) == Sign::Zero)
    }
}
