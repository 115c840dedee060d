//! Which objects can darken anything.

use super::frame::{Frame, Placed};
use crate::geometry::light_frame;
use crate::plan::LightId;
use glam::DVec3;

/// Objects of more triangles are taken to darken something without looking: the look is
/// triangles times vertices, and what it finds (floors, walls, rooms) is small.
const MOST_TRIANGLES_TO_LOOK_AT: usize = 256;

/// What an object may darken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Darkened {
    /// Anything, itself included.
    All,
    /// Other objects only.
    Others,
}

/// Can an object darken any of these that is drawn? No, where all that receives lies on the light's
/// side of its triangles.
pub fn can_darken(frame: &Frame, index: usize, light: LightId, what: Darkened) -> bool {
    let triangles = world_triangles(frame, index);
    let receivers = || {
        let receives = |(other, placed): &(usize, &Placed)| {
            let is_asked = what == Darkened::All || *other != index;
            is_asked && placed.object.receives && placed.surface.is_some()
        };
        let receiving = frame.placed.iter().enumerate().filter(receives);
        receiving.flat_map(|(_, placed)| placed.world.iter().copied())
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
