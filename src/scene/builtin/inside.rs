//! `inside`: under a pergola, in the shadow of one of its slats.
//!
//! The eye is in the shadow volume of the slat above it, and the near plane, 0.8 away, cuts those of both neighbours:
//! z-pass begins to count too late in different ways across the picture. Z-fail counts from the other end and does not
//! depend on where the eye is.

use crate::scene::{Camera, Light, Material, MeshError, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const GRAVEL: [f32; 3] = [0.58, 0.54, 0.46];
const WOOD: [f32; 3] = [0.40, 0.24, 0.13];
const STONE: [f32; 3] = [0.52, 0.52, 0.50];
const LEAVES: [f32; 3] = [0.06, 0.30, 0.10];
const CLAY: [f32; 3] = [0.62, 0.23, 0.10];
const GLAZE: [f32; 3] = [0.07, 0.33, 0.70];

/// Slats are counted from the left; the eye is under the middle one.
const SLATS: i32 = 11;
const SLAT_SPACING: f64 = 0.5;
const SLAT_HEIGHT: f64 = 2.6;
/// Direction towards the sun. At the eye's height a slat's shadow is a quarter metre left of the slat.
const SUN: DVec3 = DVec3::new(0.25, 1.0, 0.12);
const EYE: [f64; 3] = [-0.25, 1.6, 4.0];

/// Builds the scene `inside`, with the eye under slats that run away from it, along z. The ground is at height 0.
pub fn build() -> Result<Scene, MeshError> {
    let ground = Arc::new(shapes::quad([30.0, 30.0])?);
    let slat = Arc::new(shapes::cuboid([0.22, 0.16, 9.0])?);
    let beam = Arc::new(shapes::cuboid([5.6, 0.2, 0.2])?);
    let post = Arc::new(shapes::cuboid([0.22, 2.4, 0.22])?);
    let wall = Arc::new(shapes::cuboid([9.0, 1.1, 0.4])?);
    let bush = Arc::new(shapes::sphere(0.55, 48, 24)?);
    let pot = Arc::new(shapes::cylinder(0.38, 0.5, 48)?);
    let ring = Arc::new(shapes::torus(0.55, 0.2, 64, 28)?);
    let mut objects = vec![Object::new("ground", ground.clone(), Material::matte(GRAVEL))];
    objects.extend((0..SLATS).map(|index| {
        let x = f64::from(index - SLATS / 2) * SLAT_SPACING;
        Object::new(format!("slat {}", index + 1), slat.clone(), Material::matte(WOOD)).at(DVec3::new(
            x,
            SLAT_HEIGHT,
            1.5,
        ))
    }));
    for (name, z) in [("far", -2.4), ("near", 5.4)] {
        objects.push(
            Object::new(format!("{name} beam"), beam.clone(), Material::matte(WOOD)).at(DVec3::new(0.0, 2.42, z)),
        );
        for (side, x) in [("left", -2.6), ("right", 2.6)] {
            objects.push(
                Object::new(format!("{name} {side} post"), post.clone(), Material::matte(WOOD))
                    .at(DVec3::new(x, 1.16, z)),
            );
        }
    }
    objects.push(Object::new("wall", wall.clone(), Material::matte(STONE)).at(DVec3::new(0.0, 0.5, -6.0)));
    for (side, x) in [("left", -1.7), ("right", 1.6)] {
        objects
            .push(Object::new(format!("{side} pot"), pot.clone(), Material::matte(CLAY)).at(DVec3::new(x, 0.26, -1.3)));
        objects.push(
            Object::new(format!("{side} bush"), bush.clone(), Material::glossy(LEAVES)).at(DVec3::new(x, 0.9, -1.3)),
        );
    }
    objects.push(Object::new("ring", ring.clone(), Material::glossy(GLAZE)).at(DVec3::new(0.1, 0.76, -0.4)));
    if let Some(ring) = objects.last_mut() {
        ring.pose.rotate_degrees = DVec3::new(90.0, 20.0, 0.0);
    }
    Ok(SceneBuilder::new("inside")
        .ambient([0.16, 0.17, 0.20])
        .camera(Camera { near: 0.8, fov_y_degrees: 60.0, ..Camera::looking(EYE, [0.1, 0.95, -2.0]) })
        .light(Light { color: [1.0, 0.93, 0.80], ..Light::directional(SUN) })
        .objects(objects)
        .build())
}
