//! `spheres`: one ball in 200, 450 and 16 200 triangles, on a checkered floor beside a lamp that glows.
//!
//! The differences of flat, Gouraud and Phong shading (`shading`) are visible on them, and so are those of black and
//! blended shadows over a pattern.

use crate::scene::{Camera, Light, Material, MeshError, Object, Scene, SceneBuilder, Shading, shapes};
use glam::DVec3;
use std::sync::Arc;

const BALL: [f32; 3] = [0.72, 0.33, 0.12];
const FLOOR: [f32; 3] = [0.72, 0.70, 0.66];
/// Slices and stacks: twice the slices, times the stacks less one, are triangles.
const FINENESS: [[u32; 2]; 3] = [[10, 11], [15, 16], [90, 91]];

/// Builds the scene `spheres`: balls of radius 0.5 in a row, each of other fineness, on a checkered floor, and a small
/// one where the light is, which glows and neither casts nor receives.
pub fn build() -> Result<Scene, MeshError> {
    let lamp = DVec3::new(0.9, 2.1, 1.3);
    let floor = Material { checks: 0.5, ..Material::matte(FLOOR) };
    let mut objects = vec![Object::new("floor", Arc::new(shapes::quad([8.0, 6.0])?), floor)];
    for (index, [slices, stacks]) in FINENESS.into_iter().enumerate() {
        let ball = shapes::sphere(0.5, slices, stacks)?;
        let name = format!("ball of {}", ball.triangles().len());
        let material = Material { shading: Shading::Flat, specular: 0.35, shininess: 30.0, ..Material::matte(BALL) };
        objects.push(Object::new(name, Arc::new(ball), material).at(DVec3::new(1.3 * (index as f64 - 1.0), 0.55, 0.0)));
    }
    let glow = Material { emission: [1.0, 0.9, 0.7], ..Material::matte([0.0; 3]) };
    objects.push(Object {
        casts: false,
        receives: false,
        ..Object::new("lamp", Arc::new(shapes::sphere(0.06, 16, 9)?), glow).at(lamp)
    });
    Ok(SceneBuilder::new("spheres")
        .ambient([0.12, 0.12, 0.13])
        .camera(Camera { fov_y_degrees: 45.0, ..Camera::looking([0.3, 2.3, 5.0], [0.1, 0.85, 0.0]) })
        .light(Light { color: [1.0, 0.96, 0.9], ..Light::point(lamp) })
        .objects(objects)
        .build())
}
