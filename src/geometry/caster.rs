//! What casts a shadow: a mesh at its place.

use crate::scene::{Mesh, Pose};
use glam::DVec3;

/// A mesh with its pose and its vertices in world space.
#[derive(Debug, Clone, Copy)]
pub struct Caster<'a> {
    /// Its triangles.
    pub mesh: &'a Mesh,
    /// Where the mesh is placed.
    pub pose: &'a Pose,
    /// World positions of the mesh's vertices.
    pub world: &'a [DVec3],
}
