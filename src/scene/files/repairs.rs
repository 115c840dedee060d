//! What of a model's vertices, faces and normals can't be used, and is left out or replaced.

use crate::scene::not_taken::UnsupportedList;
use glam::DVec3;

/// Numbers of what a mesh lacks of its file's geometry, in any format.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Vertices with a coordinate that is NaN or infinite, of which no face uses any.
    pub unused_vertices: usize,
    /// Faces with fewer than three corners.
    pub short_faces: usize,
    /// Faces with a normal's index that names none.
    pub faces_without_normals: usize,
    /// Normals with a component that is NaN or infinite.
    pub broken_normals: usize,
}

impl Repairs {
    /// Records in `refusals` each number that is not 0, with what is done in its place.
    pub fn record(&self, refusals: &mut UnsupportedList) {
        let kinds = [
            (self.unused_vertices, ["vertex that is not finite", "vertices that are not finite"], "no face uses them"),
            (
                self.short_faces,
                ["face of fewer than three corners", "faces of fewer than three corners"],
                "a surface needs three",
            ),
            (
                self.faces_without_normals,
                ["face's normals", "faces' normals"],
                "the file does not have them (vn): computed ones are used",
            ),
            (
                self.broken_normals,
                ["normal that is not finite", "normals that are not finite"],
                "computed ones are used",
            ),
        ];
        for (count, [one, many], because) in kinds.into_iter().filter(|(count, ..)| *count > 0) {
            refusals.refuse(format!("{count} {}", if count == 1 { one } else { many }), because);
        }
    }
}

/// Sets positions that are not finite and of which no corner uses any to 0, and returns their number; the mesh's builder
/// drops them, as it does all unused ones. The error is the first index of one that a corner uses. `corners` gives the
/// corners' indices, all in range, and is called only where some position is not finite.
pub fn clear_unused<C: Iterator<Item = usize>>(
    positions: &mut [DVec3],
    corners: impl FnOnce() -> C,
) -> Result<usize, usize> {
    let broken: Vec<usize> = (0..positions.len()).filter(|index| !positions[*index].is_finite()).collect();
    if broken.is_empty() {
        return Ok(0);
    }
    if let Some(used) = corners().filter(|index| !positions[*index].is_finite()).min() {
        return Err(used);
    }
    broken.iter().for_each(|index| positions[*index] = DVec3::ZERO);
    Ok(broken.len())
}
