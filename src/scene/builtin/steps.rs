//! `steps`: two flights of stairs, balls and a wall, each of which shadows the others.
//!
//! Every step is a flat receiver, and the balls have no flat surface: flattening casters onto planes takes a pass over
//! all of them for each step, and leaves the balls without shadows.

use crate::scene::{Camera, Light, Material, MeshError, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const FLOOR: [f32; 3] = [0.50, 0.48, 0.45];
const STONE: [f32; 3] = [0.60, 0.55, 0.47];
const BRICK: [f32; 3] = [0.48, 0.20, 0.12];

/// Balls on the floor and on steps; orange and yellow are partly in the shadow of a flight.
const BALLS: [(&str, [f32; 3], [f64; 3]); 5] = [
    ("blue ball", [0.09, 0.40, 0.78], [0.62, 0.60, 0.45]),
    ("green ball", [0.02, 0.36, 0.20], [1.37, 1.20, -0.5]),
    ("orange ball", [0.78, 0.35, 0.02], [-0.35, 0.30, -0.78]),
    ("yellow ball", [0.85, 0.68, 0.06], [1.75, 0.30, 1.62]),
    ("purple ball", [0.60, 0.19, 0.38], [-0.75, 0.30, 1.2]),
];
const BALL_RADIUS: f64 = 0.3;

/// Builds the scene `steps`: two flights of stairs, a wall and balls on a floor at height 0; the larger flight climbs
/// to the right up to the wall.
pub fn build() -> Result<Scene, MeshError> {
    let floor = Arc::new(shapes::quad([9.0, 8.0])?);
    let flight = Arc::new(shapes::stairs(8, 0.2, 0.32, 2.4)?);
    let small_flight = Arc::new(shapes::stairs(5, 0.22, 0.2, 0.8)?);
    let wall = Arc::new(shapes::cuboid([0.3, 2.9, 5.4])?);
    let ball = Arc::new(shapes::sphere(BALL_RADIUS, 48, 24)?);
    let mut small =
        Object::new("small flight", small_flight.clone(), Material::matte(STONE)).at(DVec3::new(-1.75, 0.0, -1.35));
    small.pose.rotate_degrees.y = -18.0;
    let mut objects = vec![
        Object::new("floor", floor.clone(), Material::matte(FLOOR)),
        Object::new("flight", flight.clone(), Material::matte(STONE)),
        small,
        Object::new("wall", wall.clone(), Material::matte(BRICK)).at(DVec3::new(2.76, 1.4, 0.0)),
    ];
    objects.extend(BALLS.iter().map(|(name, color, place)| {
        Object::new(*name, ball.clone(), Material::glossy(*color)).at(DVec3::from_array(*place))
    }));
    Ok(SceneBuilder::new("steps")
        .ambient([0.14, 0.14, 0.15])
        .camera(Camera { fov_y_degrees: 38.0, ..Camera::looking([-4.0, 3.3, 4.5], [0.55, 0.62, -0.05]) })
        .light(Light { color: [1.0, 0.95, 0.86], ..Light::point(DVec3::new(-3.4, 3.8, -2.6)) })
        .objects(objects)
        .build())
}
