//! The geometry of a frame in space: objects, shadow volumes, silhouettes, frusta. Data for views that look at a frame
//! from outside.
//!
//! Volumes are taken from the frame's plan, so that what is shown is what is drawn; silhouettes come from the same
//! geometry, and exist whatever the technique. Everything is in world space; corners are homogeneous, and `w = 0` lies
//! at infinity.
//!
//! ```text
//! mod.rs      the data                                  volumes.rs   volumes out of a plan
//! make.rs     computes it from a scene and a plan       frusta.rs    frusta of camera and maps, near-clip volume
//! ```

mod frusta;
mod make;
mod volumes;

pub use make::{anatomy, recorded_places};

use crate::geometry::{Blob, Edge, NormalsPer, SilhouetteEdge, SurfaceNormals};
use crate::plan::DrawPart;
use crate::scene::{Camera, Mesh};
use glam::{DVec3, DVec4, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The geometry of a frame in world space: objects, lights, shadow volumes, silhouettes and frusta. Of another
/// program's frame it is in the view space of an assumed eye.
#[derive(Debug, Clone, PartialEq)]
pub struct Anatomy {
    /// Name of the technique.
    pub technique: String,
    /// The camera that the frame is seen by.
    pub camera: Camera,
    /// Its field of view is not known, and assumed to be 90 degrees, as another program drew the frame. Everything is
    /// in its view space then.
    pub is_view_assumed: bool,
    /// Width over height of the picture.
    pub aspect: f64,
    /// The objects, in the scene's order.
    pub objects: Vec<PlacedObject>,
    /// The lights, in the scene's order.
    pub lights: Vec<PlacedLight>,
    /// The shadow volumes that the frame draws: at most one for each light and caster.
    pub volumes: Vec<ShadowVolume>,
    /// The silhouettes, one for each light and caster.
    pub silhouettes: Vec<Silhouette>,
    /// The camera's first, then those of the lights' maps. A receiver's texture is seen from its rectangle to the
    /// light; a projected silhouette has two: from its rectangle to the light, and from there on.
    pub frusta: Vec<Frustum>,
    /// The near-clip volume of each light; `None` where the light lies in the near plane.
    pub near_clips: Vec<Option<NearClip>>,
}

/// An object of the scene with its vertices in world space.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedObject {
    /// Unique within its scene.
    pub name: String,
    /// It casts shadows.
    pub casts: bool,
    /// It receives shadows.
    pub receives: bool,
    /// It is drawn.
    pub visible: bool,
    /// Linear RGB of its material.
    pub color: [f32; 3],
    /// The mesh, whose triangles refer to `positions`.
    pub mesh: Arc<Mesh>,
    /// The welded vertices, world space.
    pub positions: Vec<DVec3>,
    /// Edges worth drawing: creases, borders, and where more than two triangles meet.
    pub edges: Vec<Edge>,
    /// Its surfaces as the frame shades them, with their normals; empty where another program drew the frame.
    pub surfaces: Vec<PlacedSurface>,
}

/// A surface that the frame shades.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSurface {
    /// Homogeneous positions relative to the eye, metres.
    pub vertices: Blob<[f32; 4]>,
    /// Three indices a triangle, into `vertices`.
    pub indices: Blob<u32>,
    /// Unit normals, world space.
    pub normals: SurfaceNormals,
}

impl PlacedSurface {
    /// Returns the normals that the surface is shaded by, each once with its place in world space, metres: at the middle of a
    /// triangle of a flat one, at the vertices of a smooth one, at the corners where they differ from triangle to triangle.
    pub fn normals(&self, eye: DVec3) -> Vec<(DVec3, DVec3)> {
        let place = |vertex: u32| {
            let [x, y, z, _] = self.vertices.data().get(vertex as usize)?.map(f64::from);
            Some(eye + DVec3::new(x, y, z))
        };
        let direction = |index: usize| Some(Vec3::from(*self.normals.values.data().get(index)?).as_dvec3());
        let triangles = self.indices.data().as_chunks::<3>().0;
        let found: Vec<Option<(DVec3, DVec3)>> = match self.normals.per {
            NormalsPer::Triangle => {
                let middle = |corners: &[u32; 3]| {
                    let [a, b, c] = corners.map(place);
                    Some((a? + b? + c?) / 3.0)
                };
                triangles
                    .iter()
                    .enumerate()
                    .map(|(index, corners)| Some((middle(corners)?, direction(index)?)))
                    .collect()
            }
            NormalsPer::Vertex => {
                let used: BTreeSet<u32> = self.indices.data().iter().copied().collect();
                used.into_iter().map(|vertex| Some((place(vertex)?, direction(vertex as usize)?))).collect()
            }
            NormalsPer::Corner => {
                let corners = self.indices.data().iter().enumerate();
                corners.map(|(index, vertex)| Some((place(*vertex)?, direction(index)?))).collect()
            }
        };
        found.into_iter().flatten().collect()
    }
}

/// A light of the scene: its position or direction in world space, its colour and its range.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedLight {
    /// World space, homogeneous: `w = 1` a point, `w = 0` the direction towards the light.
    pub position: DVec4,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Distance in metres at which it has faded to nothing.
    pub range: Option<f64>,
}

/// The shadow volume of one caster and one light as the GPU draws it: homogeneous vertices, and the parts that are
/// drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct ShadowVolume {
    /// Index of the light.
    pub light: usize,
    /// Index of the object that casts it.
    pub caster: usize,
    /// Homogeneous corners, rounded as the GPU has them.
    pub vertices: Vec<DVec4>,
    /// The parts that are drawn: sides, light cap, dark cap.
    pub parts: Vec<VolumePart>,
}

/// One part of a shadow volume.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VolumePart {
    /// [`DrawPart::Side`], [`DrawPart::LightCap`] or [`DrawPart::DarkCap`].
    pub part: DrawPart,
    /// Indices of vertices, counter-clockwise seen from outside the volume.
    pub triangles: Vec<[u32; 3]>,
}

/// The edges of a caster that bound its shadow.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// Index of the light.
    pub light: usize,
    /// Index of the object; edges name its positions.
    pub caster: usize,
    /// The edges with their multiplicities.
    pub edges: Vec<SilhouetteEdge>,
}

/// What a frustum is the view of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewOf {
    /// The camera's.
    Camera,
    /// A face of a light's map.
    Map {
        /// Index of the light.
        light: usize,
        /// Index of the face.
        face: usize,
        /// Index of the object whose silhouette is projected; `None` where the map shows several objects.
        caster: Option<usize>,
    },
}

/// A frustum by its eight corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frustum {
    /// The view that it belongs to.
    pub of: ViewOf,
    /// World space: right top, left top, left bottom, right bottom.
    pub near: [DVec4; 4],
    /// World space, in the same order; directions where there is no far plane, or all the light where it ends there.
    pub far: [DVec4; 4],
}

/// The space between the near rectangle and a light: what casts within it may put the eye in shadow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearClip {
    /// Corners of the near rectangle, in order round it.
    pub rectangle: [DVec3; 4],
    /// The light: a point, or a direction.
    pub apex: DVec4,
}

impl Frustum {
    /// Returns whether all of these points lie beyond one of its planes, so that nothing between them is in it.
    pub fn holds_none_of(&self, points: &[DVec3]) -> bool {
        let at = |corner: DVec4| corner.truncate() / corner.w;
        let near = self.near.map(at);
        let middle = near.iter().sum::<DVec3>() / 4.0;
        let way = |corner: usize| match self.far[corner] {
            end if end.w == 0.0 => end.truncate().normalize_or_zero(),
            end => at(end) - near[corner],
        };
        let inside = middle + [0, 1, 2, 3].map(way).iter().sum::<DVec3>() / 8.0;
        let side = |corner: usize| (near[corner], (near[(corner + 1) % 4] - near[corner]).cross(way(corner)));
        let across = (near[1] - near[0]).cross(near[2] - near[0]);
        let far = (self.far[0].w != 0.0).then(|| (at(self.far[0]), across));
        let planes = [0, 1, 2, 3].map(side).into_iter().chain([(near[0], across)]).chain(far);
        planes.into_iter().any(|(from, normal)| {
            let normal = normal.normalize_or_zero() * normal.dot(inside - from).signum();
            let slack = 1e-9 * (inside - from).length();
            !points.is_empty() && points.iter().all(|point| normal.dot(*point - from) < -slack)
        })
    }

    /// Returns whether the frustum's far end is a single point: the light.
    pub fn ends_at_light(&self) -> bool {
        self.far.iter().all(|corner| *corner == self.far[0])
    }
}
