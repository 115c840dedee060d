//! `rings`: a plane and three tori, one on it, one beyond the light and one under the plane.
//!
//! Flattened onto the plane without clipping, the torus beyond the light gives an anti-shadow and the one under the
//! plane a false shadow: neither exists in truth.

use crate::scene::{Camera, Light, Material, MeshError, Motion, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const PLANE: [f32; 3] = [0.55, 0.52, 0.47];
const BLUE: [f32; 3] = [0.09, 0.40, 0.78];
const ORANGE: [f32; 3] = [0.78, 0.35, 0.02];
const PURPLE: [f32; 3] = [0.60, 0.19, 0.38];

/// Builds the scene `rings`: a plane at height 0 and three tori that rotate: one that dips into the plane, one beyond
/// the light, and one under the plane. Its measures are those of the source that the scene is from.
pub fn build() -> Result<Scene, MeshError> {
    let torus = Arc::new(shapes::torus(0.5, 0.2, 64, 32)?);
    let turning = |name: &str, color, at: [f64; 3]| {
        let mut object = Object::new(name, torus.clone(), Material::glossy(color)).at(DVec3::from_array(at));
        object.motion = Motion { spin_degrees_per_second: DVec3::new(20.0, 0.0, 0.0), ..Motion::default() };
        object
    };
    let plane = Arc::new(shapes::quad([8.0, 8.0])?);
    Ok(SceneBuilder::new("rings")
        .ambient([0.14, 0.14, 0.15])
        .camera(Camera { fov_y_degrees: 45.0, ..Camera::looking([-4.0, 6.0, -4.0], [0.0; 3]) })
        .light(Light::point(DVec3::new(1.0, 2.0, -1.0)))
        .objects([
            Object::new("plane", plane.clone(), Material::matte(PLANE)),
            turning("torus on the plane", BLUE, [0.0, 0.5, 0.0]),
            turning("torus beyond the light", ORANGE, [1.0, 3.0, -1.0]),
            turning("torus under the plane", PURPLE, [0.0, -4.0, 0.0]),
        ])
        .build())
}
