//! `two-lights`: a warm lamp and a cool sun, and shadows of both that cross.
//!
//! Where one is blocked the other's colour stays, where both are only the ambient light does. Each
//! light has its own volumes, its own labels and its own light pass; between them the stencil is
//! cleared.

use crate::scene::{Camera, Light, Material, MeshError, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const SLAB: [f32; 3] = [0.62, 0.62, 0.62];
const CHALK: [f32; 3] = [0.70, 0.70, 0.68];
const RED: [f32; 3] = [0.66, 0.10, 0.05];

const WARM: [f32; 3] = [1.0, 0.60, 0.24];
const COOL: [f32; 3] = [0.30, 0.52, 1.0];

/// Builds the scene `two-lights`: columns, a ball and a ring on a slab, whose top is at height 0, under a point and a
/// directional light.
pub fn build() -> Result<Scene, MeshError> {
    let slab = Arc::new(shapes::cuboid([6.4, 0.2, 5.0])?);
    let column = Arc::new(shapes::cylinder(0.24, 1.7, 48)?);
    let ball = Arc::new(shapes::sphere(0.42, 56, 28)?);
    let ring = Arc::new(shapes::torus(0.5, 0.15, 64, 28)?);
    let mut objects = vec![Object::new("slab", slab.clone(), Material::matte(SLAB)).at(DVec3::new(0.0, -0.1, 0.0))];
    for (index, [x, z]) in [[-1.5, -0.9], [0.0, -1.15], [1.5, -0.9]].into_iter().enumerate() {
        // A little into the slab, so that no light slips through underneath.
        let place = DVec3::new(x, 0.84, z);
        objects.push(Object::new(format!("column {}", index + 1), column.clone(), Material::glossy(CHALK)).at(place));
    }
    objects.push(Object::new("ball", ball.clone(), Material::glossy(RED)).at(DVec3::new(-0.55, 0.42, 0.35)));
    let mut ring = Object::new("ring", ring.clone(), Material::glossy(CHALK)).at(DVec3::new(0.85, 0.62, 0.15));
    ring.pose.rotate_degrees = DVec3::new(78.0, 35.0, 0.0);
    objects.push(ring);
    Ok(SceneBuilder::new("two-lights")
        .ambient([0.09, 0.09, 0.10])
        .camera(Camera { fov_y_degrees: 42.0, ..Camera::looking([0.5, 3.7, 5.2], [0.0, 0.25, 0.1]) })
        .lights([
            Light { color: WARM, ..Light::point(DVec3::new(-2.6, 2.7, -2.3)) },
            Light { color: COOL, intensity: 0.9, ..Light::directional(DVec3::new(0.75, 1.0, -0.62)) },
        ])
        .objects(objects)
        .build())
}
