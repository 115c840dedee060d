//! `glass`: coloured panes and a solid ball, and a wall and a floor that catch their shadows.
//!
//! A projective shadow texture is a picture of the casters as the light sees them: it stores the panes' colours,
//! overlaps included. Every technique that only decides whether something is between takes a pane for solid.

use crate::scene::{Camera, Light, Material, MeshError, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const FLOOR: [f32; 3] = [0.58, 0.56, 0.52];
const WALL: [f32; 3] = [0.62, 0.62, 0.62];
const BALL: [f32; 3] = [0.30, 0.32, 0.36];
const WOOD: [f32; 3] = [0.33, 0.20, 0.11];

/// Panes on the floor: colour, position, and rotation.
const PANES: [(&str, [f32; 3], [f64; 2], f64); 3] = [
    ("red pane", [0.80, 0.10, 0.06], [-1.6, 0.5], 8.0),
    ("yellow pane", [0.90, 0.72, 0.05], [-0.55, -0.1], 8.0),
    ("blue pane", [0.07, 0.33, 0.82], [0.5, 0.4], 8.0),
];
const PANE_SIZE: [f64; 3] = [0.95, 1.3, 0.04];
/// How much of the light from behind a pane it blocks.
const PANE_OPACITY: f32 = 0.4;

/// Builds the scene. The wall is at z = −1.8; the light stands in front to the left, so that the casters fit one cone
/// and their shadows fall to the right, where the eye sees them.
pub fn build() -> Result<Scene, MeshError> {
    let floor = Arc::new(shapes::quad([15.0, 6.0])?);
    let wall = Arc::new(shapes::parallelogram(DVec3::new(-7.5, 0.0, -1.8), [DVec3::X * 15.0, DVec3::Y * 3.4])?);
    let ball = Arc::new(shapes::sphere(0.32, 48, 24)?);
    let stand = Arc::new(shapes::cylinder(0.3, 0.5, 48)?);
    let mut objects = vec![
        Object::new("floor", floor.clone(), Material::matte(FLOOR)).at(DVec3::new(0.0, 0.0, 1.2)),
        Object::new("wall", wall, Material::matte(WALL)),
        Object::new("stand", stand.clone(), Material::matte(WOOD)).at(DVec3::new(1.6, 0.25, -0.2)),
        Object::new("ball", ball.clone(), Material::glossy(BALL)).at(DVec3::new(1.6, 0.81, -0.2)),
    ];
    let pane = Arc::new(shapes::cuboid(PANE_SIZE)?);
    objects.extend(PANES.iter().map(|(name, color, [x, z], degrees)| {
        let glass =
            Material { color: *color, specular: 0.4, shininess: 60.0, opacity: PANE_OPACITY, ..Material::default() };
        // Slightly above the floor, so that no other surface is in the floor's plane.
        let mut object = Object::new(*name, pane.clone(), glass).at(DVec3::new(*x, PANE_SIZE[1] / 2.0 + 0.005, *z));
        object.pose.rotate_degrees.y = *degrees;
        object
    }));
    Ok(SceneBuilder::new("glass")
        .ambient([0.15, 0.15, 0.16])
        .camera(Camera { fov_y_degrees: 39.0, ..Camera::looking([2.7, 2.9, 4.8], [0.4, 0.72, -0.6]) })
        .light(Light { color: [1.0, 0.96, 0.9], ..Light::point(DVec3::new(-2.1, 2.0, 3.2)) })
        .objects(objects)
        .build())
}
