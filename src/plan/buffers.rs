//! Vertices, indices and pictures of draws, named by the hash of their content.

use crate::geometry::{Blob, Extruded};
use crate::scene::TextureImage;
use std::sync::Arc;

/// An indexed triangle list.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawMesh {
    /// For people: `bunny`, `volume of bunny`.
    pub name: String,
    /// Homogeneous positions relative to the origin of the pass's view; `w = 0` is at infinity.
    pub vertices: Blob<[f32; 4]>,
    /// Three a triangle, into `vertices`.
    pub indices: Blob<u32>,
    /// What shading and labels need; `None` for meshes drawn by position only.
    pub surface: Option<SurfaceData>,
    /// The vertex shader makes the vertices of these; [`DrawMesh::vertices`] are what comes of it.
    pub extruded: Option<Extruded>,
    /// The fragments that another program's shader has not discarded, where that was noted, in order: the pixel
    /// ([`DrawMesh::pixel_word`]) and the triangle. Corners are not shared then: the three of triangle `t` begin at `3t`.
    pub retained: Option<Blob<[u32; 2]>>,
}

impl DrawMesh {
    /// A mesh that is drawn by position only; see [`relative`](crate::geometry::relative) for its vertices.
    pub fn of_positions(name: impl Into<String>, vertices: Vec<[f32; 4]>, indices: Vec<u32>) -> DrawMesh {
        DrawMesh::of_blobs(name, Blob::new(vertices), Blob::new(indices))
    }

    /// The same of data that may be shared.
    pub fn of_blobs(name: impl Into<String>, vertices: Blob<[f32; 4]>, indices: Blob<u32>) -> DrawMesh {
        DrawMesh { name: name.into(), vertices, indices, surface: None, extruded: None, retained: None }
    }

    /// A mesh whose vertices a vertex shader carries away from a light.
    pub fn of_extruded(name: impl Into<String>, extruded: Extruded, indices: Blob<u32>) -> DrawMesh {
        let vertices = extruded.vertices();
        DrawMesh { extruded: Some(extruded), ..DrawMesh::of_blobs(name, vertices, indices) }
    }

    /// Column and row of a pixel in one word, as [`DrawMesh::retained`] has it.
    pub fn pixel_word([x, y]: [u32; 2]) -> u32 {
        x | y << 16
    }

    /// Is a fragment of a triangle there after the shader, as far as is known?
    pub fn keeps(&self, pixel: [u32; 2], triangle: u32) -> bool {
        let wanted = [DrawMesh::pixel_word(pixel), triangle];
        self.retained.as_ref().is_none_or(|retained| retained.data().binary_search(&wanted).is_ok())
    }

    /// How many triangles it has.
    pub fn triangles(&self) -> u32 {
        (self.indices.len() / 3) as u32
    }

    /// Hash and bytes of all its data.
    pub(super) fn blobs(&self) -> Vec<(u64, u64)> {
        fn entry<T: bytemuck::Pod>(blob: &Blob<T>) -> (u64, u64) {
            (blob.hash(), (blob.len() * size_of::<T>()) as u64)
        }
        let vertices = self.extruded.as_ref().map_or_else(|| entry(&self.vertices), |of| entry(&of.corners));
        let mut blobs = vec![vertices, entry(&self.indices)];
        blobs.extend(self.surface.iter().flat_map(|surface| [entry(&surface.normals), entry(&surface.sides)]));
        blobs.extend(self.surface.iter().filter_map(|surface| surface.uvs.as_ref()).map(entry));
        blobs.extend(self.retained.as_ref().map(entry));
        blobs
    }
}

/// Data of surfaces beside their positions.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceData {
    /// Unit world-space normal of each corner, parallel to the indices; the fourth is unused.
    pub normals: Blob<[f32; 4]>,
    /// One word a triangle, from exact signs. Bit `i`: light `i` and the eye are not on the same
    /// side of the triangle's plane (a light or eye on the plane counts as not). Bit 31: the eye
    /// sees the back.
    pub sides: Blob<u32>,
    /// Where each corner lies in a picture, parallel to the indices: 0, 0 is its lower left, 1, 1 its upper right.
    /// `None` where no part of it shows one.
    pub uvs: Option<Blob<[f32; 2]>>,
}

/// A picture on surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanTexture {
    /// Its texels and their pyramid.
    pub picture: Arc<TextureImage>,
    /// Beyond it, its last texels go on; else it repeats.
    pub clamps: bool,
}

impl PlanTexture {
    /// Bytes that all its levels take.
    pub fn bytes(&self) -> u64 {
        let half = |side: u32, level: u32| u64::from((side >> level).max(1));
        let [width, height] = self.picture.size();
        (0..self.picture.level_count()).map(|level| half(width, level) * half(height, level) * 4).sum()
    }
}
