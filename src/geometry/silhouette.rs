//! Which way triangles face a light, and how often each edge bounds the shadow.

use super::EdgeList;
use crate::math::{Sign, side_of_triangle};
use glam::{DVec3, DVec4};

/// The one facing of each triangle: the exact sign of the light's side. Caps and edges both read
/// it, so a volume can't open. Zero: edge-on, the triangle casts nothing.
#[must_use]
pub fn facing(world: &[DVec3], triangles: &[[u32; 3]], light: DVec4) -> Vec<Sign> {
    triangles.iter().map(|corners| side_of_triangle(corners.map(|i| world[i as usize]), light)).collect()
}

/// How often each edge bounds the shadow when every triangle is turned towards the light: the
/// sum over its triangles of +1 where the turned triangle runs from low to high and −1 where it
/// runs back. 0: inside the lit sheet, no side. Right for any triangle soup (techniques.md,
/// section 5): the sides and caps that follow from it always close.
#[must_use]
pub fn multiplicities(edges: &EdgeList, facing: &[Sign]) -> Vec<i32> {
    (0..edges.edges().len())
        .map(|edge| edges.incident(edge).map(|(triangle, direction)| direction * facing[triangle].value()).sum())
        .collect()
}
