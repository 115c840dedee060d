//! The data that draws read: meshes (vertices and indices) and textures. Each is named by the hash of its content.

use super::near_triangles::TriangleBoxes;
use crate::geometry::{Blob, Extruded, SurfaceNormals};
use crate::scene::TextureImage;
use std::sync::Arc;

/// An indexed triangle list that draws refer to.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawMesh {
    /// A name for people: `bunny`, `volume of bunny`.
    pub name: String,
    /// Homogeneous positions relative to the origin of the pass's view; `w = 0` is at infinity.
    pub vertices: Blob<[f32; 4]>,
    /// Three indices a triangle, into `vertices`.
    pub indices: Blob<u32>,
    /// Normals, sides and texture coordinates for shading and labels; `None` for meshes drawn by position only.
    pub surface: Option<SurfaceData>,
    /// The input of a vertex shader that computes the vertices; [`DrawMesh::vertices`] is its result.
    pub extruded: Option<Extruded>,
    /// For another program's shader that discards fragments, those that it did not discard, where recorded: pixel
    /// ([`DrawMesh::pixel_word`]) and triangle, sorted. Corners are then not shared: triangle `t` has the corners from
    /// `3t` on.
    pub retained: Option<Blob<[u32; 2]>>,
    /// For a mesh of pieces of another mesh's triangles, the index of the triangle that each piece is of.
    pub pieces_of: Option<Blob<u32>>,
    /// For a mesh of some triangles of an object's mesh, the index there of each.
    pub source_triangles: Option<Blob<u32>>,
    /// Boxes round its triangles, by which those near a pixel are found.
    pub boxes: TriangleBoxes,
}

impl DrawMesh {
    /// Makes a mesh that is drawn by position only. Vertices are relative to the view's origin, see
    /// [`relative`](crate::geometry::relative); indices are three a triangle.
    pub fn of_positions(name: impl Into<String>, vertices: Vec<[f32; 4]>, indices: Vec<u32>) -> DrawMesh {
        DrawMesh::of_blobs(name, Blob::new(vertices), Blob::new(indices))
    }

    /// Makes a mesh that is drawn by position only from data that other meshes may share.
    pub fn of_blobs(name: impl Into<String>, vertices: Blob<[f32; 4]>, indices: Blob<u32>) -> DrawMesh {
        DrawMesh {
            name: name.into(),
            vertices,
            indices,
            surface: None,
            extruded: None,
            retained: None,
            pieces_of: None,
            source_triangles: None,
            boxes: TriangleBoxes::default(),
        }
    }

    /// Returns the index that a triangle has in the mesh of the object that it is of: its own, unless this mesh has only some
    /// of the object's triangles.
    pub fn source_triangle(&self, triangle: u32) -> u32 {
        let source = self.source_triangles.as_ref().and_then(|source| source.data().get(triangle as usize));
        source.copied().unwrap_or(triangle)
    }

    /// Makes a mesh whose vertices a vertex shader carries away from a light.
    pub fn of_extruded(name: impl Into<String>, extruded: Extruded, indices: Blob<u32>) -> DrawMesh {
        let vertices = extruded.vertices();
        DrawMesh { extruded: Some(extruded), ..DrawMesh::of_blobs(name, vertices, indices) }
    }

    /// Packs a pixel's column and row into one word, as [`DrawMesh::retained`] stores it: the row in the upper 16 bits.
    pub fn pixel_word([x, y]: [u32; 2]) -> u32 {
        x | y << 16
    }

    /// Returns whether the shader kept the fragment of `triangle` at `pixel`; true where that was not recorded.
    pub fn keeps(&self, pixel: [u32; 2], triangle: u32) -> bool {
        let wanted = [DrawMesh::pixel_word(pixel), triangle];
        self.retained.as_ref().is_none_or(|retained| retained.data().binary_search(&wanted).is_ok())
    }

    /// Returns the indices of a triangle's vertices, each with `base_vertex` added; `None` where there is none.
    pub fn corners(&self, triangle: u32, base_vertex: u32) -> Option<[u32; 3]> {
        let corners = *self.indices.data().as_chunks::<3>().0.get(triangle as usize)?;
        Some(corners.map(|corner| corner.saturating_add(base_vertex)))
    }

    /// Returns the positions of three vertices; `None` where one is missing.
    pub fn places(&self, corners: [u32; 3]) -> Option<[[f32; 4]; 3]> {
        let [a, b, c] = corners.map(|corner| self.vertices.data().get(corner as usize));
        Some([*a?, *b?, *c?])
    }

    /// Returns the index of the triangle that a piece is of; its own where the mesh has no pieces.
    pub fn whole(&self, piece: u32) -> u32 {
        let whole = self.pieces_of.as_ref().and_then(|pieces_of| pieces_of.data().get(piece as usize));
        whole.copied().unwrap_or(piece)
    }

    /// Returns the number of triangles.
    pub fn triangles(&self) -> u32 {
        (self.indices.len() / 3) as u32
    }

    /// Returns hash and size in bytes of each of the mesh's arrays on the GPU; for an extruded mesh the corners that
    /// its vertex shader reads, not the vertices that it computes.
    pub(super) fn blobs(&self) -> Vec<(u64, u64)> {
        fn entry<T: bytemuck::Pod>(blob: &Blob<T>) -> (u64, u64) {
            (blob.hash(), (blob.len() * size_of::<T>()) as u64)
        }
        let vertices = self.extruded.as_ref().map_or_else(|| entry(&self.vertices), |of| entry(&of.corners));
        let mut blobs = vec![vertices, entry(&self.indices)];
        blobs.extend(self.surface.iter().flat_map(|surface| [entry(&surface.normals.values), entry(&surface.sides)]));
        blobs.extend(self.surface.iter().filter_map(|surface| surface.uvs.as_ref()).map(entry));
        blobs.extend(self.retained.as_ref().map(entry));
        blobs
    }
}

/// Per-corner and per-triangle data with which a surface is shaded and labelled.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceData {
    /// Unit world-space normals.
    pub normals: SurfaceNormals,
    /// One word a triangle, from exact signs. Bit `i`: light `i` and the eye are not on the same
    /// side of the triangle's plane (a light or eye on the plane counts as not). Bit 31: the eye
    /// sees the back.
    pub sides: Blob<u32>,
    /// Texture coordinates of each corner, parallel to the indices: 0, 0 is the picture's lower left, 1, 1 its upper
    /// right. `None` where no surface of the mesh has a texture.
    pub uvs: Option<Blob<[f32; 2]>>,
}

/// A texture on surfaces, with how lookups outside of it are answered.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanTexture {
    /// Its texels and their mip chain.
    pub picture: Arc<TextureImage>,
    /// True clamps lookups outside of the picture to its edge; false repeats the picture.
    pub clamps: bool,
}

impl PlanTexture {
    /// Returns how many bytes all mip levels take on the GPU, at four bytes a texel.
    pub fn bytes(&self) -> u64 {
        let half = |side: u32, level: u32| u64::from((side >> level).max(1));
        let [width, height] = self.picture.size();
        (0..self.picture.level_count()).map(|level| half(width, level) * half(height, level) * 4).sum()
    }
}
