//! `rings`: a plane and three tori, one on it, one beyond the light and one under the plane.
//!
//! Flattened onto the plane without clipping, the torus beyond the light gives an anti-shadow and
//! the one under the plane a false shadow: neither is there in truth.

use super::{camera, glossy, matte, placed, shapes};
use crate::scene::{Light, MeshError, Scene};
use glam::DVec3;
use std::sync::Arc;

const PLANE: [f32; 3] = [0.55, 0.52, 0.47];
const BLUE: [f32; 3] = [0.09, 0.40, 0.78];
const ORANGE: [f32; 3] = [0.78, 0.35, 0.02];
const PURPLE: [f32; 3] = [0.60, 0.19, 0.38];

/// Figures from the source that founded the scene.
pub fn build() -> Result<Scene, MeshError> {
    let torus = Arc::new(shapes::torus(0.5, 0.2, 64, 32)?);
    let plane = Arc::new(shapes::quad([8.0, 8.0])?);
    Ok(Scene {
        name: "rings".to_owned(),
        ambient: [0.14, 0.14, 0.15],
        camera: camera([-4.0, 6.0, -4.0], [0.0; 3], 50.0),
        lights: vec![Light::point(DVec3::new(1.0, 2.0, -1.0))],
        objects: vec![
            placed("plane", &plane, matte(PLANE), DVec3::ZERO),
            placed("torus on the plane", &torus, glossy(BLUE), DVec3::new(0.0, 0.5, 0.0)),
            placed("torus beyond the light", &torus, glossy(ORANGE), DVec3::new(1.0, 3.0, -1.0)),
            placed("torus under the plane", &torus, glossy(PURPLE), DVec3::new(0.0, -4.0, 0.0)),
        ],
        technique: None,
    })
}
