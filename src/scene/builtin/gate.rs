//! `gate`: 300 closed boxes, each inside the last, so that up to 300 shadow volumes overlap.
//!
//! A closed box counts one: behind all of them the count is 300, which eight bits store as 44, still a shadow. Behind
//! exactly 256 it is one that they store as 0: a bright frame inside the shadow, where no light can be. The sizes leave
//! space between the 250th, the 256th and the last box, so that all three counts are wide enough to be seen.

use crate::scene::{Camera, Light, Material, Mesh, MeshError, Object, Pose, Scene, SceneBuilder, shapes};
use glam::DVec3;
use std::sync::Arc;

const FLOOR: [f32; 3] = [0.55, 0.52, 0.47];
const WALL: [f32; 3] = [0.44, 0.47, 0.53];
const GATE: [f32; 3] = [0.62, 0.23, 0.10];

/// Size of the outermost box, metres.
const SIZE: [f64; 3] = [1.7, 2.6, 0.5];
/// Numbers of boxes, and from which to which size relative to the outermost, from outside to inside.
const GROUPS: [(u32, f64, f64); 3] = [(250, 1.0, 0.85), (6, 0.8, 0.79), (44, 0.6, 0.55)];

/// Builds the scene `gate`: a caster of nested boxes above a floor, at height 0, before a wall at z = −1.6, with a
/// point light.
pub fn build() -> Result<Scene, MeshError> {
    let floor = shapes::quad([14.0, 10.0])?;
    let wall = shapes::parallelogram(DVec3::new(-7.0, 0.0, -1.6), [DVec3::X * 14.0, DVec3::Y * 5.0])?;
    let boxes = Object::new("nested boxes", Arc::new(nested_boxes()?), Material::matte(GATE));
    let upright = Pose { translate: DVec3::new(-0.9, 1.34, 0.5), ..Pose::default() };
    Ok(SceneBuilder::new("gate")
        .ambient([0.15, 0.15, 0.16])
        .camera(Camera { fov_y_degrees: 38.0, ..Camera::looking([1.9, 2.0, 6.6], [0.3, 1.25, -0.6]) })
        .light(Light { color: [1.0, 0.95, 0.87], ..Light::point(DVec3::new(-3.6, 2.9, 3.8)) })
        .objects([
            Object {
                pose: Pose { translate: DVec3::new(0.0, 0.0, 3.4), ..Pose::default() },
                ..Object::new("floor", Arc::new(floor), Material::matte(FLOOR))
            },
            Object::new("wall", Arc::new(wall), Material::matte(WALL)),
            Object { pose: upright, ..boxes },
        ])
        .build())
}

/// Returns one mesh of 300 boxes inside each other, the outermost first: one caster of 300 closed shells.
fn nested_boxes() -> Result<Mesh, MeshError> {
    let sizes = GROUPS.iter().flat_map(|(count, outer, inner)| {
        let step = (outer - inner) / f64::from(count - 1);
        (0..*count).map(move |index| outer - step * f64::from(index))
    });
    let boxes = sizes.map(|scale| shapes::cuboid(SIZE.map(|n| n * scale))).collect::<Result<Vec<Mesh>, _>>()?;
    shapes::joined(boxes.iter().map(|one| (one, DVec3::ZERO)))
}
