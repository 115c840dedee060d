//! OBJ models.
//!
//! [`load`] reads and checks every line (`text`), lets `tobj` read the material libraries, and cuts faces into
//! triangles (`polygon`). The whole file is one mesh, whatever groups it has, so that a closed one stays closed. The
//! parts between `o`, `g` and `usemtl` are stored as [`MeshGroup`]s; texture coordinates belong to corners.

mod materials;
mod text;

use super::polygon;
use super::read_text::{quoted, read_old_text};
use super::repairs::{Repairs, clear_unused};
use crate::scene::mesh::is_usable_uv;
use crate::scene::picture::ImageLoader;
use crate::scene::{FileProblem, Mesh, MeshBuilder, MeshGroup, SceneError, Shading};
use glam::{DVec3, Vec2, Vec3};
use materials::{MaterialLibraries, ObjTexture};
use std::path::{Path, PathBuf};
use text::{ObjContents, ObjCorner, ObjStatement};

/// Loads a model as one mesh. It has corner normals if any face of the file has them; faces
/// without get their own. Faces with fewer than three corners, and vertices that are not finite
/// and that no face uses, are left out and listed ([`Mesh::not_taken`]).
///
/// # Errors
/// A missing file, a folder, a file that is not text, empty or without faces; with its line a word
/// that is no number, a vertex that is not finite and that a face uses, a vertex's index out of range.
pub fn load(file: &Path) -> Result<Mesh, SceneError> {
    load_among(file, &mut ImageLoader::default())
}

/// Loads a model among others, which share the budget for pictures.
pub(in crate::scene) fn load_among(file: &Path, pictures: &mut ImageLoader) -> Result<Mesh, SceneError> {
    let raw = read_old_text(file, "OBJ model")?;
    let folder = file.parent().unwrap_or(Path::new(""));
    parse(&raw, folder, pictures).map_err(|problem| problem.of(file))
}

/// Returns the libraries that a model names, and the pictures that they show, sorted and each once; empty where it
/// can't be read, which loading reports.
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

/// Parses an OBJ text as one mesh. Material libraries are read from `folder`; what is not supported is recorded in the
/// mesh. A text without faces, or whose triangles all have equal corners, is an error.
fn parse(raw: &str, folder: &Path, pictures: &mut ImageLoader) -> Result<Mesh, FileProblem> {
    let mut contents =
        text::read(raw).map_err(|text::ObjLineProblem { line, reason }| FileProblem::Line(line, reason))?;
    if contents.arities.is_empty() {
        return Err(FileProblem::File(
            "has no faces of three corners or more: export the surface as `f` lines".to_owned(),
        ));
    }
    let repairs = repair(&mut contents).map_err(|vertex| {
        let reason =
            format!("vertex {} is not finite, and a face uses it: replace NaN and infinity by numbers", vertex + 1);
        FileProblem::Line(text::line_of_vertex(raw, vertex), reason)
    })?;
    let mut libraries = MaterialLibraries::new(pictures);
    let faces = assemble(&contents, folder, &mut libraries);
    let builder = MeshBuilder { positions: std::mem::take(&mut contents.positions), ..faces };
    drop(contents);
    let mesh = builder.build().map_err(|error| FileProblem::File(error.to_string()))?;
    if mesh.triangles().is_empty() {
        return Err(FileProblem::no_triangles());
    }
    repairs.record(&mut libraries.refusals);
    Ok(mesh.without(libraries.refusals.into_list()))
}

/// Makes all numbers finite that can be without changing a surface, and returns what was repaired and left out; the error
/// is the index of the first vertex that is not finite and that a face uses.
fn repair(contents: &mut ObjContents) -> Result<Repairs, usize> {
    let corners = contents.corners.iter().map(|corner| corner.vertex as usize);
    let unused_vertices = clear_unused(&mut contents.positions, || corners)?;
    let mut broken_normals = 0;
    for normal in contents.normals.iter_mut().filter(|normal| !normal.is_finite()) {
        // Zero stands for the triangle's own.
        *normal = Vec3::ZERO;
        broken_normals += 1;
    }
    let faces_without_normals = contents.faces().filter(|face| contents.lacks_normals(face)).count();
    Ok(Repairs { unused_vertices, short_faces: contents.short_faces, faces_without_normals, broken_normals })
}

/// Returns a builder with all of the mesh but the positions: faces in order as triangles, in groups as the statements
/// between them say. It has normals or texture coordinates where at least one whole face has them.
fn assemble(contents: &ObjContents, folder: &Path, libraries: &mut MaterialLibraries) -> MeshBuilder {
    let is_smooth = contents.faces().any(|face| face.iter().all(|corner| contents.normal_of(corner).is_some()));
    let has_uvs = contents.faces().any(|face| face.iter().all(|corner| contents.place_of(corner).is_some()));
    let mut assembly = ObjAssembly {
        contents,
        folder,
        libraries,
        is_smooth,
        has_uvs,
        builder: MeshBuilder::default(),
        part: ObjGroup::default(),
        corners: Vec::new(),
    };
    let mut statements = contents.statements.iter().peekable();
    for (at, face) in contents.faces().enumerate() {
        while let Some((_, statement)) = statements.next_if(|(before, _)| *before <= at) {
            assembly.state(statement);
        }
        assembly.add(face);
    }
    statements.for_each(|(_, statement)| assembly.state(statement));
    assembly.end_part();
    assembly.builder
}

struct ObjAssembly<'a, 'b> {
    contents: &'a ObjContents,
    folder: &'a Path,
    libraries: &'a mut MaterialLibraries<'b>,
    /// Whether any face has normals, and any has texture coordinates.
    is_smooth: bool,
    has_uvs: bool,
    builder: MeshBuilder,
    part: ObjGroup,
    /// Buffer for the positions of a face's corners.
    corners: Vec<DVec3>,
}

/// The group that faces are added to.
#[derive(Default)]
struct ObjGroup {
    name: String,
    /// Index in the libraries.
    material: Option<usize>,
    map: Option<ObjTexture>,
    /// Index of its first triangle.
    start: usize,
    /// True where some triangle has no texture coordinates.
    is_unplaced: bool,
}

impl ObjAssembly<'_, '_> {
    fn state(&mut self, statement: &ObjStatement) {
        match statement {
            ObjStatement::Name(name) => {
                self.end_part();
                self.part.name.clone_from(name);
            }
            ObjStatement::Material(name) => {
                let material = self.libraries.find(name);
                if material != self.part.material {
                    self.end_part();
                }
                self.part.material = material;
                self.part.map = self.libraries.map(name).filter(|_| material.is_some()).cloned();
            }
            ObjStatement::Library(name) => self.libraries.load(&self.folder.join(name), name),
        }
    }

    fn add(&mut self, face: &[ObjCorner]) {
        let contents = self.contents;
        let position = |corner: &ObjCorner| contents.positions[corner.vertex as usize];
        let has_normals = face.iter().all(|corner| contents.normal_of(corner).is_some());
        let is_placed = face.iter().all(|corner| contents.place_of(corner).is_some());
        let map = self.part.map.as_ref();
        self.corners.clear();
        self.corners.extend(face.iter().map(position));
        polygon::triangulate(&self.corners, |triangle| {
            let corners = triangle.map(|corner| &face[corner]);
            self.builder.triangles.push(corners.map(|corner| corner.vertex));
            if self.is_smooth {
                let own = || polygon::normal(corners.map(position));
                let given = |corner: &ObjCorner| contents.normal_of(corner).filter(|_| has_normals);
                let normals = corners.map(|corner| given(corner).unwrap_or_else(own));
                self.builder.corner_normals.push(normals);
            }
            if self.has_uvs {
                let place = |uv: Vec2| map.map_or(uv, |map| map.place(uv));
                let uvs = corners.map(|corner| contents.place_of(corner).map_or(Vec2::NAN, place));
                let uvs = Some(uvs).filter(|uvs| is_placed && uvs.iter().all(is_usable_uv));
                self.part.is_unplaced |= uvs.is_none();
                self.builder.corner_uvs.push(uvs);
            }
        });
    }

    /// Makes the triangles since the last group a group with the current name and material, if there are any, and
    /// begins the next; name and material still apply. Records a texture that can't be placed.
    fn end_part(&mut self) {
        let triangles = self.part.start..self.builder.triangles.len();
        let from = self.part.material.map(|material| self.libraries.material(material));
        let is_unplaced = self.part.is_unplaced || !self.has_uvs;
        if !triangles.is_empty() {
            let map = self.part.map.as_ref();
            let shown = map.filter(|_| !is_unplaced);
            let shading = if self.is_smooth { Shading::Phong } else { Shading::Flat };
            self.builder.groups.push(MeshGroup {
                name: self.part.name.clone(),
                triangles: triangles.clone(),
                material: from.map(|from| materials::material(from, shading, shown.is_some())),
                texture: shown.map(|map| map.texture.clone()),
            });
            let unplaced = from.filter(|_| map.is_some() && is_unplaced).map(|from| quoted(&from.name));
            if let Some(material) = unplaced {
                let what = format!("map_Kd of {material}");
                let because = "faces have no texture coordinates (vt) that can be used: export them too";
                self.libraries.refusals.refuse(what, because);
            }
        }
        (self.part.start, self.part.is_unplaced) = (triangles.end, false);
    }
}

#[cfg(test)]
mod tests;
