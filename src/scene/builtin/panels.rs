//! `panels`: a box room, open towards the eye, with four slanted panels in it.
//!
//! Its five walls and the panels are nine parallelograms, each an object of its own: the receivers
//! that textures of Heckbert and Herf (1997) are made for. The light is in the plane of the opening.

use crate::scene::{Camera, Light, Material, MeshError, Object, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

/// A parallelogram: a corner and two edges; its lit side is where their cross product points.
struct Panel {
    name: &'static str,
    color: [f32; 3],
    corner: [f64; 3],
    edges: [[f64; 3]; 2],
    casts: bool,
}

/// Nothing is behind the room's walls: as casters they could only shadow themselves.
const fn wall(name: &'static str, color: [f32; 3], corner: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Panel {
    Panel { name, color, corner, edges: [x, y], casts: false }
}

const fn panel(name: &'static str, color: [f32; 3], corner: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Panel {
    Panel { name, color, corner, edges: [x, y], casts: true }
}

const PLASTER: [f32; 3] = [0.42, 0.44, 0.48];
const BACK: [f32; 3] = [0.50, 0.52, 0.56];
const FLOOR: [f32; 3] = [0.46, 0.42, 0.37];

/// x and y in ±100, z from −320 to −520.
const PARALLELOGRAMS: [Panel; 9] = [
    wall("floor", FLOOR, [-100.0, -100.0, -320.0], [200.0, 0.0, 0.0], [0.0, 0.0, -200.0]),
    wall("ceiling", PLASTER, [-100.0, 100.0, -520.0], [200.0, 0.0, 0.0], [0.0, 0.0, 200.0]),
    wall("left wall", PLASTER, [-100.0, -100.0, -320.0], [0.0, 0.0, -200.0], [0.0, 200.0, 0.0]),
    wall("right wall", PLASTER, [100.0, -100.0, -520.0], [0.0, 0.0, 200.0], [0.0, 200.0, 0.0]),
    wall("back wall", BACK, [-100.0, -100.0, -520.0], [200.0, 0.0, 0.0], [0.0, 200.0, 0.0]),
    panel("blue panel", [0.09, 0.40, 0.78], [-76.0, -8.0, -470.0], [62.0, 12.0, 14.0], [-10.0, 58.0, 22.0]),
    panel("orange panel", [0.78, 0.35, 0.02], [10.0, 8.0, -452.0], [58.0, -12.0, -26.0], [14.0, 50.0, -14.0]),
    panel("green panel", [0.02, 0.40, 0.22], [-62.0, -78.0, -410.0], [58.0, 16.0, -18.0], [8.0, 30.0, -44.0]),
    panel("purple panel", [0.60, 0.19, 0.38], [14.0, -72.0, -440.0], [60.0, -8.0, 22.0], [-16.0, 56.0, -10.0]),
];

/// Builds the scene `panels`: a box that is open towards the eye, with four slanted panels in it, nine parallelograms
/// in all, and a point light. Its measures are those of the source that the scene is from.
pub fn build() -> Result<Scene, MeshError> {
    let objects = PARALLELOGRAMS.iter().map(Panel::object).collect::<Result<Vec<Object>, _>>()?;
    Ok(SceneBuilder::new("panels")
        .ambient([0.12, 0.12, 0.13])
        .camera(Camera { near: 5.0, fov_y_degrees: 62.0, ..Camera::looking([0.0, 4.0, -250.0], [0.0, -6.0, -420.0]) })
        .light(Light { color: [1.0, 0.95, 0.87], ..Light::point(DVec3::new(70.0, 70.0, -320.0)) })
        .objects(objects)
        .build())
}

impl Panel {
    fn object(&self) -> Result<Object, MeshError> {
        let mesh = shapes::parallelogram(DVec3::from_array(self.corner), self.edges.map(DVec3::from_array))?;
        Ok(Object { casts: self.casts, ..Object::new(self.name, Arc::new(mesh), Material::matte(self.color)) })
    }
}
