//! Opens a scene by any name: a built-in name, a scene file or a model.

use super::file;
use super::model::{self, ModelFormat};
use crate::files::{is_file, is_folder};
use crate::scene::builtin::{self, Builtin};
use crate::scene::suggestion::nearest;
use crate::scene::{Scene, SceneError, UpAxis};
use std::path::{Path, PathBuf};

/// The name or path of a scene to open, and how a bare model is completed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenSpec {
    /// A built-in name, or the path of a scene file (`.toml`), a glTF file (`.gltf`, `.glb`) or a model (`.obj`, `.ply`).
    pub name: String,
    /// Adds a floor under a bare model, and under what a glTF file shows without camera and lights; other scenes are
    /// not changed.
    pub floor: bool,
    /// Which axis of a bare model is up; other scenes define that themselves.
    pub up: UpAxis,
}

impl OpenSpec {
    /// Returns a spec of `name`, with a floor under it if it is a model, whose y axis is up.
    pub fn new(name: impl Into<String>) -> OpenSpec {
        OpenSpec { name: name.into(), floor: true, up: UpAxis::Y }
    }
}

/// Returns the files that a scene consists of: none for a built-in one; otherwise its own path first, the models that a
/// scene file names, and their libraries, buffers and pictures. A file may be listed twice.
pub fn files_of(spec: &OpenSpec) -> Vec<PathBuf> {
    if Builtin::named(&spec.name).is_some() {
        return Vec::new();
    }
    let path = PathBuf::from(&spec.name);
    let named =
        if SceneFileKind::of(&path) == Some(SceneFileKind::SceneFile) { file::models_of(&path) } else { Vec::new() };
    let files: Vec<PathBuf> = std::iter::once(path).chain(named).collect();
    let of_models: Vec<PathBuf> = files.iter().flat_map(|file| model::files_of(file)).collect();
    files.into_iter().chain(of_models).collect()
}

/// The kind of file that a scene is in, by its name's ending.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SceneFileKind {
    SceneFile,
    Model(ModelFormat),
}

impl SceneFileKind {
    fn of(path: &Path) -> Option<SceneFileKind> {
        let is_scene_file = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        if is_scene_file { Some(SceneFileKind::SceneFile) } else { ModelFormat::of(path).map(SceneFileKind::Model) }
    }
}

/// Returns whether this path has the ending of a file that scenes are read from.
pub fn is_scene_file(path: &Path) -> bool {
    SceneFileKind::of(path).is_some()
}

/// Returns whether this names a bare model (`.obj`, `.ply`), whose up axis is not defined; false for a built-in scene,
/// a scene file, and a glTF file, whose up axis is y.
pub fn is_model(name: &str) -> bool {
    let format = ModelFormat::of(Path::new(name)).filter(|_| Builtin::named(name).is_none());
    matches!(format, Some(ModelFormat::Obj | ModelFormat::Ply))
}

/// Opens a scene. The result is at time 0.
///
/// # Errors
/// An unknown name, with the nearest one; a file that is missing or broken, with the line where there is one, and how
/// to fix it.
pub fn open(spec: &OpenSpec) -> Result<Scene, SceneError> {
    if let Some(builtin) = Builtin::named(&spec.name) {
        return builtin.scene();
    }
    let path = Path::new(&spec.name);
    match SceneFileKind::of(path) {
        Some(SceneFileKind::SceneFile) => file::load(path),
        Some(SceneFileKind::Model(_)) => model::scene(path, spec.floor, spec.up),
        None => Err(unknown(&spec.name)),
    }
}

fn unknown(name: &str) -> SceneError {
    let path = Path::new(name);
    if is_folder(path) {
        return SceneError::Read {
            file: path.to_owned(),
            reason: "is a folder: name a scene file (.toml) or a model (.obj, .ply, .gltf, .glb) in it".to_owned(),
        };
    }
    if is_file(path) {
        let reason = "is of no kind that can be opened: give a scene file (.toml) or a model (.obj, .ply, .gltf, .glb)"
            .to_owned();
        return SceneError::Read { file: path.to_owned(), reason };
    }
    if path.components().count() > 1 {
        return SceneError::Read { file: path.to_owned(), reason: "no such file or folder: check the path".to_owned() };
    }
    let names: Vec<&str> = builtin::ALL.iter().map(|builtin| builtin.name).collect();
    let hint = match nearest(name, &names) {
        Some(near) => format!("did you mean `{near}`?"),
        None => {
            format!("choose one of {}, a scene file (.toml) or a model (.obj, .ply, .gltf, .glb)", names.join(", "))
        }
    };
    SceneError::Unknown { name: name.escape_debug().to_string(), hint }
}
