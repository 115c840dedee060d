//! A triangle mesh with bit-identical positions welded.
//!
//! Shadow volumes need to know which triangles share an edge, so vertices are identified by position alone, bit for bit
//! (−0 counts as 0) and never within a tolerance: what a file splits at material seams is joined again, and what is
//! merely close stays apart. Triangles with two equal vertices have no area and no edges to share, and are dropped;
//! slivers are not. Normals and texture coordinates belong to the corners of triangles, so welding cannot blur a
//! crease, and a seam of a texture opens no mesh.

use super::{Material, MaterialTexture, Unsupported};
use foldhash::quality::FixedState;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::hash::{BuildHasher, Hash, Hasher};
use std::ops::Range;

/// A welded triangle mesh in object space. Built by [`MeshBuilder`].
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Corners by the numbers that they were given with, where some of these were joined.
    file_corners: Option<Vec<[u32; 3]>>,
    corner_normals: Option<Vec<[Vec3; 3]>>,
    corner_uvs: Option<Vec<Option<[Vec2; 3]>>>,
    groups: Vec<MeshGroup>,
    not_taken: Vec<Unsupported>,
    dropped: usize,
    hash: u64,
    normals_hash: u64,
}

/// A named run of a mesh's triangles, as a model file groups them.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshGroup {
    /// The file's name for it; empty where it has none.
    pub name: String,
    /// Its range of triangles; groups follow each other without gaps and cover the mesh.
    pub triangles: Range<usize>,
    /// Material from the file's library; `None` uses the object's material.
    pub material: Option<Material>,
    /// The texture that this material's colour is multiplied with.
    pub texture: Option<MaterialTexture>,
}

/// Beyond this coordinate, adjacent texels are one number in single precision.
const MOST_UV: f32 = 1e5;

/// Returns whether single precision distinguishes texels at these coordinates.
pub(super) fn is_usable_uv(uv: &Vec2) -> bool {
    uv.to_array().iter().all(|part| part.abs() <= MOST_UV)
}

/// Why a mesh can't be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {index} is not finite: replace NaN and infinity by numbers")]
    NotFinite {
        /// Index of the vertex, in the order the vertices were given.
        index: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {index}, but there are {count}: correct the index")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The index that was used.
        index: u32,
        /// The number of vertices.
        count: usize,
    },
    /// There are more vertices than 32-bit indices can number twice over (once near, once at infinity).
    #[error("{count} vertices are too many: at most {most} fit", most = i32::MAX)]
    TooLarge {
        /// The number of vertices that were given.
        count: usize,
    },
}

impl Mesh {
    /// Returns the distinct positions, object space.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Corners as indices into [`Mesh::positions`], counter-clockwise seen from the front.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the triangles' corners by the numbers that the mesh's file or builder gave them: vertices that it splits,
    /// as at seams of normals, have different numbers here though they are one position. As
    /// [`Mesh::triangles`] where none is split.
    pub fn file_corners(&self) -> &[[u32; 3]] {
        self.file_corners.as_deref().unwrap_or(&self.triangles)
    }

    /// Returns the object-space normals of each triangle's corners, not necessarily of unit length; `None` where the
    /// mesh was built without.
    pub fn corner_normals(&self) -> Option<&[[Vec3; 3]]> {
        self.corner_normals.as_deref()
    }

    /// Returns, for each triangle, the texture coordinates of its corners, or `None` where it has none: 0, 0 is the
    /// picture's lower left corner, 1, 1 its upper right. `None` where no triangle has any.
    pub fn corner_uvs(&self) -> Option<&[Option<[Vec2; 3]>]> {
        self.corner_uvs.as_deref()
    }

    /// Returns whether every one of these triangles, by range, has texture coordinates; false where the range goes
    /// beyond the mesh.
    pub fn has_uvs(&self, triangles: &Range<usize>) -> bool {
        let of_these = self.corner_uvs.as_ref().and_then(|uvs| uvs.get(triangles.clone()));
        of_these.is_some_and(|uvs| uvs.iter().all(Option::is_some))
    }

    /// Returns what the mesh's file asks for and is not supported; empty for a mesh that is not from a file.
    pub fn not_taken(&self) -> &[Unsupported] {
        &self.not_taken
    }

    /// Returns the same mesh, with this list of what is not supported of its file.
    pub(super) fn without(self, not_taken: Vec<Unsupported>) -> Mesh {
        Mesh { not_taken, ..self }
    }

    /// Returns the mesh's groups, in order of their triangles: at least one, unless the mesh has no triangle.
    pub fn groups(&self) -> &[MeshGroup] {
        &self.groups
    }

    /// Returns the number of triangles that were left out because two of their corners coincide.
    pub fn dropped_triangles(&self) -> usize {
        self.dropped
    }

    /// Returns the hash of positions and triangles: what was computed from one mesh is valid for any other with the
    /// same hash. Stable within a process only.
    pub fn content_hash(&self) -> u64 {
        self.hash
    }

    /// Returns the hash of the corners' own normals, which [`Mesh::content_hash`] does not cover. Stable within a
    /// process only.
    pub fn normals_hash(&self) -> u64 {
        self.normals_hash
    }

    /// Returns the same mesh with bit-identical positions joined to one vertex each, and without triangles that two
    /// equal corners then have. Every mesh is so already except those of [`MeshBuilder::build_unwelded`].
    pub fn welded(&self) -> Result<Mesh, MeshError> {
        let builder = MeshBuilder {
            positions: self.positions.clone(),
            triangles: self.triangles.clone(),
            corner_normals: self.corner_normals.clone().unwrap_or_default(),
            corner_uvs: self.corner_uvs.clone().unwrap_or_default(),
            groups: self.groups.clone(),
        };
        Ok(Mesh { dropped: self.dropped, not_taken: self.not_taken.clone(), ..builder.build()? })
    }

    /// Returns the smallest and largest corner of the bounding box; `None` without vertices.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(low, high), p| (low.min(*p), high.max(*p))))
    }
}

/// Collects vertices and triangles, then welds and checks them.
#[derive(Debug, Clone, Default)]
pub struct MeshBuilder {
    /// Object-space positions, duplicates allowed.
    pub positions: Vec<DVec3>,
    /// Indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// One entry for each triangle, or empty when there are no normals.
    pub corner_normals: Vec<[Vec3; 3]>,
    /// One entry for each triangle, or empty where no triangle has texture coordinates.
    pub corner_uvs: Vec<Option<[Vec2; 3]>>,
    /// Groups in order and without gaps; empty for one unnamed group.
    pub groups: Vec<MeshGroup>,
}

impl MeshBuilder {
    /// Welds bit-identical positions, drops unused vertices and triangles without area by index.
    pub fn build(self) -> Result<Mesh, MeshError> {
        self.build_with(false)
    }

    /// Builds the mesh without welding, as a renderer that trusts a file's indices has it: for showing what that does
    /// to shadows. Scenes and models never are.
    pub fn build_unwelded(self) -> Result<Mesh, MeshError> {
        self.build_with(true)
    }

    fn build_with(self, keeps_apart: bool) -> Result<Mesh, MeshError> {
        self.check()?;
        // A closed surface has half as many vertices as triangles.
        let distinct = self.positions.len().min(self.triangles.len() / 2 + 2);
        let mut welder = Welder::new(&self.positions, keeps_apart, distinct);
        let mut triangles = Vec::with_capacity(self.triangles.len());
        let mut file_corners = Vec::with_capacity(self.triangles.len());
        let mut corner_normals = Vec::with_capacity(self.corner_normals.len());
        let mut corner_uvs = Vec::with_capacity(self.corner_uvs.len());
        // How many triangles remain before each old triangle: where a group's ends move to.
        let mut kept_before = Vec::with_capacity(self.triangles.len() + 1);
        for (old, corners) in self.triangles.iter().enumerate() {
            kept_before.push(triangles.len());
            let [a, b, c] = corners.map(|index| self.positions[index as usize] + 0.0).map(bits);
            if a == b || b == c || c == a {
                continue;
            }
            triangles.push(corners.map(|index| welder.weld(index)));
            file_corners.push(*corners);
            corner_normals.extend(self.corner_normals.get(old));
            corner_uvs.extend(self.corner_uvs.get(old));
        }
        kept_before.push(triangles.len());
        let groups = self.groups_after(&kept_before);
        let hash_of = |parts: &[&[u8]]| {
            let mut hasher = FixedState::default().build_hasher();
            parts.iter().for_each(|part| part.hash(&mut hasher));
            hasher.finish()
        };
        let shape = [bytemuck::cast_slice(&welder.positions), bytemuck::cast_slice::<[u32; 3], u8>(&triangles)];
        Ok(Mesh {
            hash: hash_of(&shape),
            normals_hash: hash_of(&[bytemuck::cast_slice(&corner_normals)]),
            dropped: self.triangles.len() - triangles.len(),
            file_corners: welder.has_joined.then_some(file_corners),
            corner_normals: (!corner_normals.is_empty()).then_some(corner_normals),
            corner_uvs: corner_uvs.iter().any(Option::is_some).then_some(corner_uvs),
            not_taken: Vec::new(),
            positions: welder.positions,
            triangles,
            groups,
        })
    }

    fn check(&self) -> Result<(), MeshError> {
        let count = self.positions.len();
        if count > i32::MAX as usize {
            return Err(MeshError::TooLarge { count });
        }
        if let Some(index) = self.positions.iter().position(|position| !position.is_finite()) {
            return Err(MeshError::NotFinite { index });
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|index| **index as usize >= count) {
                return Err(MeshError::IndexOutOfRange { triangle, index, count });
            }
        }
        Ok(())
    }

    fn groups_after(&self, kept_before: &[usize]) -> Vec<MeshGroup> {
        let all = MeshGroup { name: String::new(), triangles: 0..self.triangles.len(), material: None, texture: None };
        let given = if self.groups.is_empty() { std::slice::from_ref(&all) } else { &self.groups };
        let moved = given.iter().map(|group| MeshGroup {
            triangles: kept_before[group.triangles.start]..kept_before[group.triangles.end],
            ..group.clone()
        });
        moved.filter(|group| !group.triangles.is_empty()).collect()
    }
}

/// Gives every distinct position one index, in the order of first use.
struct Welder<'a> {
    given: &'a [DVec3],
    /// For each given vertex, the one that stands for all that are welded with it.
    representative: Vec<u32>,
    /// For each representative, its index among `positions`; `None` for other vertices, and before its first use.
    welded_index: Vec<Option<u32>>,
    positions: Vec<DVec3>,
    /// For each of `positions`, the given vertex that was used there first.
    first_used: Vec<u32>,
    /// Whether two given vertices that are used were welded.
    has_joined: bool,
}

impl Welder<'_> {
    /// Prepares to weld these vertices, and allocates once for so many `distinct` positions; with `keeps_apart`, each
    /// vertex stays one of its own.
    fn new(given: &[DVec3], keeps_apart: bool, distinct: usize) -> Welder<'_> {
        Welder {
            given,
            representative: if keeps_apart { (0..given.len() as u32).collect() } else { representatives(given) },
            welded_index: vec![None; given.len()],
            positions: Vec::with_capacity(distinct),
            first_used: Vec::with_capacity(distinct),
            has_joined: false,
        }
    }

    fn weld(&mut self, given: u32) -> u32 {
        let slot = &mut self.welded_index[self.representative[given as usize] as usize];
        let index = *slot.get_or_insert(self.positions.len() as u32);
        match self.first_used.get(index as usize) {
            Some(first) => self.has_joined |= *first != given,
            None => {
                self.positions.push(self.given[given as usize] + 0.0); // −0 + 0 = 0: the two zeros are one place
                self.first_used.push(given);
            }
        }
        index
    }
}

/// Returns for each position the index of the first that is equal to it. Their hashes are sorted, on all cores: a hash
/// table costs a cache miss for each of millions of positions, and one thread fills it.
fn representatives(positions: &[DVec3]) -> Vec<u32> {
    let place = |index: u32| bits(positions[index as usize] + 0.0);
    let hasher = FixedState::default();
    // Half of a hash and, below it, an index.
    let keyed = |index: u32| hasher.hash_one(place(index)) & !u64::from(u32::MAX) | u64::from(index);
    let mut sorted: Vec<u64> = (0..positions.len() as u32).into_par_iter().map(keyed).collect();
    sorted.par_sort_unstable();
    let mut representatives: Vec<u32> = (0..positions.len() as u32).collect();
    for same_hash in sorted.chunk_by_mut(|one, other| one >> 32 == other >> 32).filter(|run| run.len() > 1) {
        // A stable sort leaves the lowest index first among equal positions.
        same_hash.sort_by_key(|key| place(*key as u32));
        for equal in same_hash.chunk_by(|one, other| place(*one as u32) == place(*other as u32)) {
            equal.iter().for_each(|key| representatives[*key as u32 as usize] = equal[0] as u32);
        }
    }
    representatives
}

fn bits(position: DVec3) -> [u64; 3] {
    position.to_array().map(f64::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    fn builder(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> MeshBuilder {
        MeshBuilder { positions, triangles, ..MeshBuilder::default() }
    }

    /// Positions from few coordinates are often equal, also with zeros of both signs.
    #[test]
    fn equal_positions_are_welded_in_the_order_of_first_use() {
        let mut state = 7_u32;
        let mut below = |most: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % most
        };
        for count in [3, 20, 90] {
            for _ in 0..50 {
                let mut coordinate = || [-1.0, -0.0, 0.0, 1.0][below(4) as usize];
                let positions: Vec<DVec3> =
                    (0..count).map(|_| DVec3::new(coordinate(), coordinate(), coordinate())).collect();
                let triangles: Vec<[u32; 3]> = (0..2 * count).map(|_| [0; 3].map(|_| below(count))).collect();
                let (mut places, mut index_of) = (Vec::new(), HashMap::new());
                let (mut kept, mut of_file) = (Vec::new(), Vec::new());
                for corners in &triangles {
                    let [a, b, c] = corners.map(|corner| positions[corner as usize]);
                    if a == b || b == c || c == a {
                        continue;
                    }
                    of_file.push(*corners);
                    kept.push(corners.map(|corner| {
                        let place = bits(positions[corner as usize] + 0.0);
                        *index_of.entry(place).or_insert_with(|| {
                            places.push(place);
                            places.len() as u32 - 1
                        })
                    }));
                }
                let mesh = builder(positions, triangles).build().expect("a mesh");
                assert_eq!(mesh.triangles(), kept);
                assert_eq!(mesh.positions().iter().copied().map(bits).collect::<Vec<_>>(), places);
                assert_eq!(mesh.file_corners(), if mesh.file_corners.is_some() { of_file } else { kept });
            }
        }
    }

    /// The corners of the file are stored only where two vertices that triangles use became one.
    #[test]
    fn corners_of_the_file_are_stored_where_used_vertices_were_welded() {
        let [a, b, c] = [DVec3::X, DVec3::Y, DVec3::Z];
        let has_joined = |builder: MeshBuilder| builder.build().expect("a mesh").file_corners.is_some();
        assert!(!has_joined(builder(vec![a, b, c, a], vec![[0, 1, 2]])), "the last vertex is not used");
        assert!(!has_joined(builder(vec![a, a, b, c], vec![[1, 2, 3]])), "the first vertex is not used");
        assert!(has_joined(builder(vec![a, b, c, a], vec![[0, 1, 2], [3, 2, 1]])));
        let apart = builder(vec![a, b, c, a], vec![[0, 1, 2], [3, 2, 1]]).build_unwelded().expect("a mesh");
        assert_eq!((apart.positions().len(), apart.file_corners.is_some()), (4, false));
    }
}
