//! `table`: a torus and four spheres over a slab, where shadow maps show their faults.

use crate::scene::{Camera, Light, Material, MeshError, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const SLAB: [f32; 3] = [0.55, 0.52, 0.47];
const TORUS: [f32; 3] = [0.79, 0.35, 0.03];
const SPHERE: [f32; 3] = [0.09, 0.40, 0.72];

/// Measures are those of the source that the scene is from: a slab 3×0.15×3 with its centre at the origin, a torus
/// (0.2, 0.5) at height 0.5, spheres of 0.2 at (±0.45, 1, ±0.45).
pub fn build() -> Result<Scene, MeshError> {
    let slab = Arc::new(shapes::cuboid([3.0, 0.15, 3.0])?);
    let torus = Arc::new(shapes::torus(0.5, 0.2, 64, 32)?);
    let sphere = Arc::new(shapes::sphere(0.2, 32, 16)?);
    let mut objects = vec![
        Object::new("slab", slab.clone(), Material::matte(SLAB)),
        Object::new("torus", torus.clone(), Material::glossy(TORUS)).at(DVec3::new(0.0, 0.5, 0.0)),
    ];
    let corners = [(-0.45, -0.45), (0.45, -0.45), (0.45, 0.45), (-0.45, 0.45)];
    objects.extend(corners.iter().enumerate().map(|(index, (x, z))| -> Object {
        Object::new(format!("sphere {}", index + 1), sphere.clone(), Material::glossy(SPHERE))
            .at(DVec3::new(*x, 1.0, *z))
    }));
    Ok(SceneBuilder::new("table")
        .ambient([0.14, 0.14, 0.15])
        .camera(Camera {
            eye: DVec3::new(-2.5, 3.5, -2.5),
            target: DVec3::new(-0.1, 0.0, -0.1),
            up: DVec3::Y,
            projection: crate::scene::Projection::Perspective,
            fov_y_degrees: 45.0,
            near: 0.05,
            far: None,
            viewport: None,
        })
        .light(Light::point(DVec3::new(2.0, 3.0, -2.0)))
        .objects(objects)
        .build())
}
