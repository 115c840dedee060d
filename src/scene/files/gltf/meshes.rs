//! Meshes: the primitives of one become the parts of one, so that a closed mesh stays closed.

use super::document::{GltfDocument, GltfResult};
use super::materials::{GltfMaterials, GltfTexture, PrimitiveMaterial};
use super::named;
use crate::scene::files::polygon;
use crate::scene::files::read_text::quoted;
use crate::scene::files::repairs::Repairs;
use crate::scene::mesh::is_usable_uv;
use crate::scene::not_taken::UnsupportedList;
use crate::scene::{Mesh, MeshBuilder, MeshGroup, Shading};
use foldhash::fast::RandomState;
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, accessor::Accessor, mesh};
use std::collections::HashMap;

/// Sets of joints that may move a vertex, four joints a set.
const MOST_JOINT_SETS: u32 = 4;

/// The transform of a mesh's vertices.
#[derive(Debug, Clone, Copy)]
pub enum VertexTransform<'a> {
    /// None: the object's pose places them.
    AsFile,
    /// Into world space.
    Placed(&'a DMat4),
    /// Into world space by their joints: the matrix of each.
    Skinned(&'a [DMat4]),
}

/// Reads meshes of a glTF file, with their materials.
#[derive(Debug)]
pub struct GltfMeshes<'a> {
    document: &'a GltfDocument,
    materials: GltfMaterials<'a>,
}

impl<'a> GltfMeshes<'a> {
    /// Returns a reader of this file.
    pub fn new(document: &'a GltfDocument, materials: GltfMaterials<'a>) -> GltfMeshes<'a> {
        GltfMeshes { document, materials }
    }

    /// Returns a mesh of the file with all its primitives of triangles, in the space that `form` says; it may have no
    /// triangle. Points, lines and morph targets are left out and recorded in the mesh.
    ///
    /// # Errors
    /// Accessors that don't fit; an index beyond the vertices; a position that is not finite.
    pub fn mesh(&mut self, index: Index<mesh::Mesh>, form: VertexTransform) -> GltfResult<Mesh> {
        let given = self.document.root.get(index).ok_or_else(|| format!("mesh {} is missing", index.value()))?;
        let name = named(given.name.as_deref(), || format!("mesh {}", index.value()));
        let mut refusals = UnsupportedList::default();
        let (mut parts, mut repairs) = (Vec::new(), Repairs::default());
        for (at, primitive) in given.primitives.iter().enumerate() {
            let of = format!("{} (primitive {at})", quoted(&name));
            let Checked::Valid(mode) = primitive.mode else { continue };
            if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                refusals.refuse(format!("points or lines of {of}"), "only triangles are drawn");
                continue;
            }
            if primitive.targets.is_some() {
                refusals.refuse(format!("morph targets of {of}"), "the base shape is shown");
            }
            let look = self.materials.look(primitive.material, &mut refusals);
            let part = PrimitiveVertices::read(self.document, primitive, mode, &look, form);
            let part = part.map_err(|why| format!("{of}: {why}"))?;
            repairs.broken_normals += part.broken_normals;
            parts.push((part, look));
        }
        repairs.record(&mut refusals);
        let mesh = assemble(&parts, &name, &mut refusals).build();
        Ok(mesh.map_err(|error| format!("{}: {error}", quoted(&name)))?.without(refusals.into_list()))
    }
}

/// A primitive's vertices and triangles.
struct PrimitiveVertices {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// A normal for each vertex; zero stands for the triangle's own.
    normals: Option<Vec<Vec3>>,
    /// The number of normals that are not finite in the file.
    broken_normals: usize,
    /// Texture coordinates of each vertex, in its material's picture.
    uvs: Option<Vec<Vec2>>,
    has_colors: bool,
}

impl PrimitiveVertices {
    /// Reads a primitive's triangles and the vertices that they use, transformed by `form`; vertices that no triangle
    /// uses are left out, since primitives may share accessors.
    fn read(
        document: &GltfDocument,
        primitive: &Primitive,
        mode: Mode,
        look: &PrimitiveMaterial,
        form: VertexTransform,
    ) -> GltfResult<PrimitiveVertices> {
        let accessor = |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let vectors = |semantic: Semantic| accessor(semantic).map(|index| document.numbers::<3>(index)).transpose();
        let all = vectors(Semantic::Positions)?.ok_or("has no positions: export the file again")?;
        let all = all.as_chunks::<3>().0;
        let all_normals = vectors(Semantic::Normals)?;
        let all_normals = all_normals.as_ref().map(|normals| normals.as_chunks::<3>().0);
        if all_normals.is_some_and(|normals| normals.len() != all.len()) {
            return Err("has another number of normals than of vertices: export the file again".to_owned());
        }
        let indices = match primitive.indices {
            Some(index) => document.indices(index)?,
            None => (0..u32::try_from(all.len()).map_err(|_| "has too many vertices: split it")?).collect(),
        };
        // A mesh that is placed in world space counts as a part of the scene.
        if matches!(form, VertexTransform::AsFile) {
            document.take(indices.len() as u64)?;
        }
        let mut triangles = triangles(mode, &indices);
        let used = used(&mut triangles);
        if let Some(index) = used.iter().find(|index| **index >= all.len()) {
            return Err(format!("uses vertex {index} of {}: export the file again", all.len()));
        }
        let vector = |numbers: &[[f64; 3]], index: &usize| DVec3::from_array(numbers[*index]);
        let mut positions: Vec<DVec3> = used.iter().map(|index| vector(all, index)).collect();
        let mut normals: Option<Vec<DVec3>> =
            all_normals.map(|normals| used.iter().map(|index| vector(normals, index)).collect());
        // Counted before a transform makes zero of them.
        let broken_normals = normals.iter().flatten().filter(|normal| !normal.is_finite()).count();
        let is_mirrored = match form {
            VertexTransform::AsFile => false,
            VertexTransform::Placed(world) => {
                let turn = DMat3::from_mat4(*world);
                let of_normals = turn.inverse().transpose();
                positions.iter_mut().for_each(|position| *position = world.transform_point3(*position));
                normals.iter_mut().flatten().for_each(|normal| *normal = (of_normals * *normal).normalize_or_zero());
                turn.determinant() < 0.0
            }
            VertexTransform::Skinned(joints) => {
                let matrices = skin(document, &accessor, joints, &used, all.len())?;
                for (position, matrix) in positions.iter_mut().zip(&matrices) {
                    *position = matrix.transform_point3(*position);
                }
                for (normal, matrix) in normals.iter_mut().flatten().zip(&matrices) {
                    let of_normals = DMat3::from_mat4(*matrix).inverse().transpose();
                    *normal = (of_normals * *normal).normalize_or_zero();
                }
                let is_mirror = |matrix: &&DMat4| DMat3::from_mat4(**matrix).determinant() < 0.0;
                2 * matrices.iter().filter(is_mirror).count() > matrices.len()
            }
        };
        if is_mirrored {
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let map = look.map.as_ref();
        let uvs = map.and_then(|map| uvs(document, accessor(Semantic::TexCoords(map.set))?, map, &used));
        let finite = |normal: &DVec3| if normal.is_finite() { normal.as_vec3() } else { Vec3::ZERO };
        Ok(PrimitiveVertices {
            positions,
            triangles,
            normals: normals.map(|normals| normals.iter().map(finite).collect()),
            broken_normals,
            uvs,
            has_colors: accessor(Semantic::Colors(0)).is_some(),
        })
    }
}

/// Returns the vertices that triangles use, in the order of first use; the triangles' indices become positions in that
/// list.
fn used(triangles: &mut [[u32; 3]]) -> Vec<usize> {
    let mut places: HashMap<u32, u32, RandomState> = HashMap::default();
    let mut used = Vec::new();
    for corner in triangles.iter_mut().flatten() {
        let next = used.len() as u32;
        let place = *places.entry(*corner).or_insert(next);
        if place == next {
            used.push(*corner as usize);
        }
        *corner = place;
    }
    used
}

/// Returns the vertices' texture coordinates; `None` where they can't be used.
fn uvs(document: &GltfDocument, index: Index<Accessor>, map: &GltfTexture, used: &[usize]) -> Option<Vec<Vec2>> {
    let numbers = document.numbers::<2>(index).ok()?;
    let all = numbers.as_chunks::<2>().0;
    let placed = |index: &usize| all.get(*index).map(|[u, v]| map.place(Vec2::new(*u as f32, *v as f32)));
    let uvs: Vec<Vec2> = used.iter().map(placed).collect::<Option<_>>()?;
    uvs.iter().all(is_usable_uv).then_some(uvs)
}

/// Returns for each vertex in `used` the matrix that its joints move it by, their weighted mean; the identity where all
/// weights are 0 or there are no joints.
fn skin(
    document: &GltfDocument,
    accessor: &dyn Fn(Semantic) -> Option<Index<Accessor>>,
    joints: &[DMat4],
    used: &[usize],
    count: usize,
) -> GltfResult<Vec<DMat4>> {
    let mut matrices = vec![DMat4::ZERO; used.len()];
    let mut sums = vec![0.0; used.len()];
    for set in 0..MOST_JOINT_SETS {
        let (Some(of), Some(weights)) = (accessor(Semantic::Joints(set)), accessor(Semantic::Weights(set))) else {
            break;
        };
        let (of, weights) = (document.numbers::<4>(of)?, document.numbers::<4>(weights)?);
        let (of, weights) = (of.as_chunks::<4>().0, weights.as_chunks::<4>().0);
        if of.len() != count || weights.len() != count {
            return Err("has another number of joints than of vertices: export the file again".to_owned());
        }
        for (at, vertex) in used.iter().enumerate() {
            let pairs = of[*vertex].iter().zip(&weights[*vertex]);
            for (joint, weight) in pairs.filter(|(_, weight)| **weight != 0.0) {
                let joint =
                    joints.get(*joint as usize).ok_or("hangs on a joint that its skin lacks: export the file again")?;
                matrices[at] += *joint * *weight;
                sums[at] += weight;
            }
        }
    }
    // Weights stored in bytes sum to nearly one.
    for (matrix, sum) in matrices.iter_mut().zip(sums) {
        *matrix = if sum > 0.0 { *matrix * (1.0 / sum) } else { DMat4::IDENTITY };
    }
    Ok(matrices)
}

/// Returns the corners of a list, strip or fan of triangles, all with the same winding; indices that complete no
/// triangle are left out.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => polygon::strip(indices.len()).map(|of| of.map(|corner| indices[corner])).collect(),
        Mode::TriangleFan => {
            let first = indices.first().copied().unwrap_or(0);
            indices.get(1..).unwrap_or_default().windows(2).map(|of| [of[0], of[1], first]).collect()
        }
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}

/// Returns one mesh of all parts, in order, each a group with its material. Where some parts have normals, triangles of
/// the others get those of their planes. Records in `refusals` what is not shown.
fn assemble(
    parts: &[(PrimitiveVertices, PrimitiveMaterial)],
    name: &str,
    refusals: &mut UnsupportedList,
) -> MeshBuilder {
    let is_smooth = parts.iter().any(|(part, _)| part.normals.is_some());
    let has_uvs = parts.iter().any(|(part, _)| part.uvs.is_some());
    let mut builder = MeshBuilder::default();
    for (part, look) in parts {
        let (start, first) = (builder.triangles.len(), builder.positions.len() as u32);
        builder.triangles.extend(part.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
        if is_smooth {
            let normals = part.triangles.iter().map(|corners| match &part.normals {
                Some(normals) => corners.map(|corner| normals[corner as usize]),
                None => [polygon::normal(corners.map(|corner| part.positions[corner as usize])); 3],
            });
            builder.corner_normals.extend(normals);
        }
        if has_uvs {
            let of = |corners: &[u32; 3]| part.uvs.as_ref().map(|uvs| corners.map(|corner| uvs[corner as usize]));
            builder.corner_uvs.extend(part.triangles.iter().map(of));
        }
        builder.positions.extend(&part.positions);
        if part.has_colors {
            refusals.refuse(format!("vertex colours of {}", quoted(name)), "a surface has its material's colour");
        }
        let map = look.map.as_ref().filter(|_| part.uvs.is_some());
        if look.map.is_some() && map.is_none() {
            let what = format!("baseColorTexture of {}", quoted(&look.name));
            refusals.refuse(what, "vertices have no texture coordinates that can be used: export them too");
        }
        let shading = if part.normals.is_some() { Shading::Phong } else { Shading::Flat };
        builder.groups.push(MeshGroup {
            name: look.name.clone(),
            triangles: start..builder.triangles.len(),
            material: look.material.map(|material| crate::scene::Material { shading, ..material }),
            texture: map.map(|map| map.texture.clone()),
        });
    }
    builder
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_one_winding() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4]), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(Mode::TriangleFan, &[0, 1, 2, 3]), [[1, 2, 0], [2, 3, 0]]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 2, 1, 3, 4]), [[0, 1, 2], [2, 1, 3]]);
        for mode in [Mode::TriangleStrip, Mode::TriangleFan, Mode::Triangles] {
            assert!(triangles(mode, &[]).is_empty() && triangles(mode, &[7]).is_empty());
        }
    }
}
