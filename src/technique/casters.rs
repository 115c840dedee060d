//! Which objects can darken anything.

use super::frame::Frame;
use crate::geometry::light_frame;
use crate::plan::LightId;
use glam::DVec3;

/// Objects of more triangles are taken to darken something without looking: the look is
/// triangles times vertices, and what it finds (floors, walls, rooms) is small.
const MOST_TRIANGLES_TO_LOOK_AT: usize = 256;

/// Can an object darken anything that is drawn? No, where all that receives lies on the light's side
/// of its triangles.
pub fn can_darken(frame: &Frame, index: usize, light: LightId) -> bool {
    let triangles = world_triangles(frame, index);
    let receivers = || {
        let receiving = frame.placed.iter().filter(|placed| placed.object.receives && placed.surface.is_some());
        receiving.flat_map(|placed| placed.world.iter().copied())
    };
    let light = frame.light_position(light);
    triangles.len() > MOST_TRIANGLES_TO_LOOK_AT
        || triangles.iter().any(|corners| light_frame::can_darken(*corners, light, receivers()))
}

/// The triangles of an object in world space.
pub fn world_triangles(frame: &Frame, index: usize) -> Vec<[DVec3; 3]> {
    let placed = &frame.placed[index];
    placed.object.mesh.triangles().iter().map(|corners| corners.map(|v| placed.world[v as usize])).collect()
}
