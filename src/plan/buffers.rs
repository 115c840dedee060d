//! Vertices, indices and pictures of draws, named by the hash of their content.

use crate::scene::Picture;
use foldhash::quality::FixedState;
use std::hash::{BuildHasher, Hasher};
use std::sync::Arc;

/// Shared data with its hash: the executor uploads equal data once and keeps it while it is used.
#[derive(Debug, Clone)]
pub struct Blob<T> {
    data: Arc<[T]>,
    hash: u64,
}

impl<T: bytemuck::Pod> Blob<T> {
    /// Hashes `data`.
    #[must_use]
    pub fn new(data: Vec<T>) -> Blob<T> {
        let mut hasher = FixedState::default().build_hasher();
        hasher.write(bytemuck::cast_slice(&data));
        Blob { hash: hasher.finish(), data: data.into() }
    }

    /// The values.
    #[must_use]
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// The same as bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.data)
    }

    /// Of the bytes. Stable within a process only.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.hash
    }
}

impl<T> PartialEq for Blob<T> {
    fn eq(&self, other: &Blob<T>) -> bool {
        self.hash == other.hash && self.data.len() == other.data.len()
    }
}

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
}

impl DrawMesh {
    /// A mesh that is drawn by position only; see [`relative`](crate::geometry::relative) for its vertices.
    #[must_use]
    pub fn of_positions(name: impl Into<String>, vertices: Vec<[f32; 4]>, indices: Vec<u32>) -> DrawMesh {
        DrawMesh { name: name.into(), vertices: Blob::new(vertices), indices: Blob::new(indices), surface: None }
    }

    /// How many triangles it has.
    #[must_use]
    pub fn triangles(&self) -> u32 {
        (self.indices.data().len() / 3) as u32
    }

    /// Hash and bytes of all its data.
    pub(super) fn blobs(&self) -> Vec<(u64, u64)> {
        fn entry<T: bytemuck::Pod>(blob: &Blob<T>) -> (u64, u64) {
            (blob.hash(), blob.bytes().len() as u64)
        }
        let mut blobs = vec![entry(&self.vertices), entry(&self.indices)];
        blobs.extend(self.surface.iter().flat_map(|surface| [entry(&surface.normals), entry(&surface.sides)]));
        blobs.extend(self.surface.iter().filter_map(|surface| surface.uvs.as_ref()).map(entry));
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
    pub picture: Arc<Picture>,
    /// Beyond it, its last texels go on; else it repeats.
    pub clamps: bool,
}

impl PlanTexture {
    /// Bytes that all its levels take.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let half = |side: u32, level: u32| u64::from((side >> level).max(1));
        let [width, height] = self.picture.size();
        (0..self.picture.level_count()).map(|level| half(width, level) * half(height, level) * 4).sum()
    }
}
