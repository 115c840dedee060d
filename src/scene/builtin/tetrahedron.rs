//! `tetrahedron`: a rotating tetrahedron in a shaft, the smallest caster that is closed.
//!
//! Four triangles and six edges: its silhouette has three or four of them, so that every side and cap of its shadow
//! volume can be distinguished in the pictures and named in the plan.

use crate::scene::{Camera, Light, Material, MeshError, Motion, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const SHAFT: [f32; 3] = [0.30, 0.33, 0.40];
const ORANGE: [f32; 3] = [0.78, 0.35, 0.02];

/// Measures are those of the source that the scene is from: a tetrahedron at (0, 0, −6) in the box ±2, ±2, ±10, a light
/// at (1, 1, −4). The source's has the corners (0, 0, 0), (1, 0, 0), (0, 1, 0) and (0, 0, 1); this one is regular, its
/// corners 1 from its centre, so that all sides look alike as it rotates.
pub fn build() -> Result<Scene, MeshError> {
    let shaft = Object::new("shaft", Arc::new(shapes::room([4.0, 4.0, 20.0])?), Material::matte(SHAFT));
    let tetrahedron = Arc::new(shapes::tetrahedron(1.0)?);
    let mut turning =
        Object::new("tetrahedron", tetrahedron.clone(), Material::matte(ORANGE)).at(DVec3::new(0.0, 0.0, -6.0));
    turning.pose.rotate_degrees = DVec3::new(14.0, 25.0, -9.0);
    turning.motion = Motion { spin_degrees_per_second: DVec3::new(50.0, 50.0, 0.0), ..Motion::default() };
    Ok(SceneBuilder::new("tetrahedron")
        .ambient([0.11, 0.11, 0.125])
        .camera(Camera { fov_y_degrees: 52.0, ..Camera::looking([0.9, 0.5, -2.4], [-0.35, -0.3, -6.5]) })
        .light(Light { color: [1.0, 0.95, 0.87], ..Light::point(DVec3::new(1.0, 1.0, -4.0)) })
        .objects([Object { casts: false, ..shaft }, turning])
        .build())
}
