//! OBJ models.
//!
//! [`load`] checks every line first (`text`), lets `tobj` read what is left, and cuts faces into
//! triangles (`polygon`). The whole file is one mesh, whatever groups it has: `tobj` splits it
//! at `o`, `g` and `usemtl`, and the mesh's weld joins it again, so that what is closed stays
//! closed. The parts stay known as [`Group`]s; where they lie in a picture, their corners know.

mod materials;
mod text;

use super::mesh::is_usable_uv;
use super::picture::Pictures;
use super::polygon;
use super::read_text::{quoted, read_old_text};
use super::{Group, Mesh, MeshBuilder, SceneError, Shading};
use glam::{DVec3, Vec2, Vec3};
use materials::Libraries;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use text::CleanText;

/// Loads a model as one mesh. It has corner normals if any face of the file has them; faces
/// without get their own.
///
/// # Errors
/// A missing file, a folder, a file that is not text, empty or without faces; a number that is
/// not finite, an index out of range, a face with fewer than three corners, with its line.
pub fn load(file: &Path) -> Result<Mesh, SceneError> {
    load_among(file, &mut Pictures::default())
}

/// The same of a model among others, which share what room pictures have.
pub(in crate::scene) fn load_among(file: &Path, pictures: &mut Pictures) -> Result<Mesh, SceneError> {
    let raw = read_old_text(file, "OBJ model")?;
    let folder = file.parent().unwrap_or(Path::new(""));
    parse(&raw, folder, pictures).map_err(|problem| match problem {
        ObjProblem::Line(text::LineProblem { line, reason }) => {
            SceneError::Line { file: file.to_owned(), line, reason }
        }
        ObjProblem::File(reason) => SceneError::Read { file: file.to_owned(), reason },
    })
}

/// The libraries of a model, and the pictures that they show; none of what can't be read, which loading tells.
#[must_use]
pub fn files_of(file: &Path) -> Vec<PathBuf> {
    let Ok(raw) = read_old_text(file, "OBJ model") else { return Vec::new() };
    let named = raw.lines().filter_map(|line| line.trim().strip_prefix("mtllib"));
    let libraries: Vec<PathBuf> = named.map(|name| file.with_file_name(name.trim())).collect();
    let pictures = libraries.iter().flat_map(|library| materials::pictures_of(library));
    let mut files: Vec<PathBuf> = pictures.chain(libraries.iter().cloned()).collect();
    files.sort();
    files.dedup();
    files
}

/// What is wrong with the text of a model.
#[derive(Debug, PartialEq, Eq)]
enum ObjProblem {
    Line(text::LineProblem),
    File(String),
}

/// Material libraries are looked for in `folder`.
fn parse(raw: &str, folder: &Path, pictures: &mut Pictures) -> Result<Mesh, ObjProblem> {
    let cleaned = text::clean(raw).map_err(ObjProblem::Line)?;
    if cleaned.has_normals.is_empty() {
        return Err(ObjProblem::File("has no faces: export the surface as `f` lines".to_owned()));
    }
    let known = RefCell::new(Libraries::new(pictures));
    let load_library = |name: &Path| known.borrow_mut().load(&folder.join(name), &name.to_string_lossy());
    let (models, libraries) =
        tobj::load_obj_buf(&mut cleaned.text.as_bytes(), &tobj::LoadOptions::default(), load_library)
            .map_err(|error| ObjProblem::File(format!("can't be read as OBJ: {error}; export it again")))?;
    // A library that can't be read costs colours only.
    let (libraries, mut known) = (libraries.unwrap_or_default(), known.into_inner());
    let mesh = assemble(&models, &libraries, &cleaned, &mut known).build();
    let mesh = mesh.map_err(|error| ObjProblem::File(error.to_string()))?.without(known.refusals.into_list());
    if mesh.triangles().is_empty() {
        return Err(ObjProblem::File("has no triangle with three different corners: export its surface".to_owned()));
    }
    Ok(mesh)
}

/// Joins the parts of a file.
fn assemble(
    models: &[tobj::Model],
    libraries: &[tobj::Material],
    cleaned: &CleanText,
    known: &mut Libraries,
) -> MeshBuilder {
    let is_smooth = cleaned.has_normals.contains(&true);
    let has_uvs = cleaned.uvs.iter().any(Option::is_some);
    let shading = if is_smooth { Shading::Phong } else { Shading::Flat };
    let mut builder = MeshBuilder::default();
    // Faces stay in the file's order.
    let mut told = cleaned.has_normals.iter().zip(&cleaned.uvs);
    for model in models {
        let start = builder.triangles.len();
        let first_vertex = builder.positions.len() as u32;
        let positions: Vec<DVec3> = model.mesh.positions.as_chunks().0.iter().map(|p| DVec3::from_array(*p)).collect();
        let from = model.mesh.material_id.and_then(|id| libraries.get(id));
        let map = from.and_then(|from| known.map(&from.name)).cloned();
        let mut is_placed = true;
        for face in Faces::of(&model.mesh) {
            let (has_normals, uvs) = told.next().map_or((false, None), |(has, uvs)| (*has, uvs.as_ref()));
            // `tobj` makes up normals where a face has none.
            let normals = face.normals.filter(|_| has_normals);
            let uvs = uvs.filter(|uvs| uvs.len() == face.vertices.len());
            let corners: Vec<DVec3> = face.vertices.iter().map(|index| positions[*index as usize]).collect();
            for triangle in polygon::triangulate(&corners) {
                builder.triangles.push(triangle.map(|corner| first_vertex + face.vertices[corner]));
                if is_smooth {
                    let given = normals.map(|indices| triangle.map(|corner| normal(&model.mesh, indices[corner])));
                    builder
                        .corner_normals
                        .push(given.unwrap_or_else(|| [polygon::normal(triangle.map(|i| corners[i])); 3]));
                }
                if has_uvs {
                    let place = |uv: Vec2| map.as_ref().map_or(uv, |map| map.place(uv));
                    let placed = uvs.map(|uvs| triangle.map(|corner| place(uvs[corner])));
                    let placed = placed.filter(|placed| placed.iter().all(is_usable_uv));
                    is_placed &= placed.is_some();
                    builder.corner_uvs.push(placed);
                } else {
                    is_placed = false;
                }
            }
        }
        builder.positions.extend(positions);
        let name = if model.name == "unnamed_object" { String::new() } else { model.name.clone() };
        let is_unplaced = map.is_some() && !is_placed;
        if let Some(from) = from.filter(|_| is_unplaced) {
            let what = format!("map_Kd of {}", quoted(&from.name));
            known.refusals.refuse(what, "faces have no texture coordinates (vt) that can be used: export them too");
        }
        builder.groups.push(Group {
            name,
            triangles: start..builder.triangles.len(),
            material: from.map(|from| materials::material(from, shading, map.is_some() && !is_unplaced)),
            texture: map.filter(|_| !is_unplaced).map(|map| map.texture),
        });
    }
    builder
}

fn normal(mesh: &tobj::Mesh, index: u32) -> Vec3 {
    let [x, y, z] = mesh.normals.as_chunks::<3>().0[index as usize];
    DVec3::new(x, y, z).as_vec3()
}

/// The faces of a part, one after the other.
struct Faces<'a> {
    vertices: &'a [u32],
    /// Parallel to `vertices`, or empty.
    normals: &'a [u32],
    /// Corners of each face; empty: three each.
    arities: &'a [u32],
}

/// Corners of one face.
struct Face<'a> {
    vertices: &'a [u32],
    normals: Option<&'a [u32]>,
}

impl<'a> Faces<'a> {
    fn of(mesh: &'a tobj::Mesh) -> Faces<'a> {
        Faces { vertices: &mesh.indices, normals: &mesh.normal_indices, arities: &mesh.face_arities }
    }
}

impl<'a> Iterator for Faces<'a> {
    type Item = Face<'a>;

    fn next(&mut self) -> Option<Face<'a>> {
        let arity = self.arities.split_off_first().map_or(3, |arity| *arity as usize);
        let vertices = self.vertices.split_off(..arity)?;
        Some(Face { vertices, normals: self.normals.split_off(..arity) })
    }
}

#[cfg(test)]
mod tests;
