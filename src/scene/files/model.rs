//! Models: the reader for each file name's ending.
//!
//! glTF and PLY are read only in builds with the feature of the program; others report that.

use super::model_scene::{self, UpAxis};
use super::obj;
use super::read_text::stem;
#[cfg(feature = "formats")]
use super::{gltf, ply};
use crate::scene::picture::ImageLoader;
use crate::scene::{Mesh, Scene, SceneError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The format of a model's file: OBJ, PLY or glTF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelFormat {
    Obj,
    Ply,
    /// A scene of its own: its up axis is defined, and it may have lights and a camera.
    Gltf,
}

impl ModelFormat {
    /// Returns the format by the file name's ending, in any case: `obj`, `ply`, `gltf` or `glb`; `None` for any other.
    /// The file is not read.
    pub fn of(file: &Path) -> Option<ModelFormat> {
        let ending = file.extension()?.to_ascii_lowercase();
        match ending.to_str()? {
            "obj" => Some(ModelFormat::Obj),
            "ply" => Some(ModelFormat::Ply),
            "gltf" | "glb" => Some(ModelFormat::Gltf),
            _ => None,
        }
    }
}

/// Splits `model.glb#/meshes/2` into file and pointer; a name whose part before the `#` is not a glTF file's is all
/// file, without a pointer.
pub fn split(name: &str) -> (&str, Option<&str>) {
    match name.rsplit_once('#') {
        Some((file, pointer)) if ModelFormat::of(Path::new(file)) == Some(ModelFormat::Gltf) => (file, Some(pointer)),
        _ => (name, None),
    }
}

/// Reads the meshes that a scene file names. Their pictures and the scene file's own are read once and share one budget
/// of texels, beyond which reading fails. A glTF file stays open for consecutive meshes of it; after another one it is
/// opened anew.
#[derive(Debug, Default)]
pub struct ModelReader {
    pub pictures: ImageLoader,
    #[cfg(feature = "formats")]
    gltf: Option<gltf::OpenedGltf>,
}

impl ModelReader {
    /// Reads the mesh in a file; in a glTF file the one that `pointer` names. A file without a known ending is read as
    /// OBJ. Pictures, and the last glTF file, are shared with later calls.
    #[cfg_attr(not(feature = "formats"), expect(unused_variables, reason = "only glTF files have pointers"))]
    pub fn mesh(&mut self, file: &Path, pointer: Option<&str>) -> Result<Mesh, SceneError> {
        match ModelFormat::of(file) {
            #[cfg(feature = "formats")]
            Some(ModelFormat::Gltf) => gltf::load_mesh(file, pointer, &mut self.pictures, &mut self.gltf),
            _ => of_one_mesh(file, &mut self.pictures),
        }
    }
}

/// Reads a PLY or OBJ file as one mesh; one with any other ending is read as OBJ.
fn of_one_mesh(file: &Path, pictures: &mut ImageLoader) -> Result<Mesh, SceneError> {
    match ModelFormat::of(file) {
        #[cfg(feature = "formats")]
        Some(ModelFormat::Ply) => ply::load(file),
        #[cfg(not(feature = "formats"))]
        Some(format @ (ModelFormat::Ply | ModelFormat::Gltf)) => Err(left_out(file, format)),
        _ => obj::load_among(file, pictures),
    }
}

/// Returns the scene of a model: completed by light, camera and, with `floor`, a floor where its file has none. `up` is
/// not used for glTF files.
pub fn scene(file: &Path, floor: bool, up: UpAxis) -> Result<Scene, SceneError> {
    let scene = match ModelFormat::of(file) {
        #[cfg(feature = "formats")]
        Some(ModelFormat::Gltf) => model_scene::gltf_scene(&stem(file), gltf::load(file)?, floor),
        _ => model_scene::model_scene(&stem(file), of_one_mesh(file, &mut ImageLoader::default())?, floor, up),
    };
    scene.map_err(|error| error.in_file(file))
}

/// Returns the other files that a model consists of (libraries, buffers, pictures); empty where it has none or can't be
/// read, which loading reports.
pub fn files_of(file: &Path) -> Vec<PathBuf> {
    match ModelFormat::of(file) {
        Some(ModelFormat::Obj) => obj::files_of(file),
        #[cfg(feature = "formats")]
        Some(ModelFormat::Gltf) => gltf::files_of(file),
        _ => Vec::new(),
    }
}

/// Returns the meshes of a file as its scene has them, each with the name that a scene file gives it where the file is
/// named `called`; empty for other formats and files that can't be read.
pub fn named_meshes(file: &Path, called: &str) -> Vec<(Arc<Mesh>, String)> {
    match ModelFormat::of(file) {
        #[cfg(feature = "formats")]
        Some(ModelFormat::Gltf) => {
            let named = |(mesh, pointer)| (mesh, format!("{called}#{pointer}"));
            gltf::named_meshes(file).into_iter().map(named).collect()
        }
        Some(_) => {
            let mesh = of_one_mesh(file, &mut ImageLoader::default()).ok();
            mesh.map(|mesh| (Arc::new(mesh), called.to_owned())).into_iter().collect()
        }
        None => Vec::new(),
    }
}

#[cfg(not(feature = "formats"))]
fn left_out(file: &Path, format: ModelFormat) -> SceneError {
    let name = if format == ModelFormat::Ply { "PLY" } else { "glTF" };
    let reason = format!("is {name}, which is read with the feature `formats`: switch that on, or convert it to OBJ");
    SceneError::Read { file: file.to_owned(), reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_gltf_file_has_a_pointer() {
        assert_eq!(split("a#b.glb#/meshes/2"), ("a#b.glb", Some("/meshes/2")));
        assert_eq!(split("a.GLTF#/nodes/0"), ("a.GLTF", Some("/nodes/0")));
        assert_eq!(split("a#b.obj"), ("a#b.obj", None));
        assert_eq!(split("a#b.ply#/meshes/2"), ("a#b.ply#/meshes/2", None));
        assert_eq!(split("a.glb"), ("a.glb", None));
    }
}
