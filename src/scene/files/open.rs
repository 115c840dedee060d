//! A scene by whatever names it: a built-in name, a scene file or a model.

use super::file;
use super::model::{self, ModelFormat};
use crate::scene::builtin::{self, Builtin};
use crate::scene::suggestion::nearest;
use crate::scene::{Scene, SceneError, UpAxis};
use std::path::{Path, PathBuf};

/// What to open, and how a bare model is completed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenSpec {
    /// A built-in name, or the path of a scene file (`.toml`), a glTF file (`.gltf`, `.glb`) or a model (`.obj`, `.ply`).
    pub name: String,
    /// Puts a floor under a bare model, and under what a glTF file shows without camera and lights; other scenes are taken as
    /// they are.
    pub floor: bool,
    /// Which axis of a bare model is up; the others say so themselves.
    pub up: UpAxis,
}

impl OpenSpec {
    /// `name` with a floor under it if it is a model, whose y axis is up.
    pub fn new(name: impl Into<String>) -> OpenSpec {
        OpenSpec { name: name.into(), floor: true, up: UpAxis::Y }
    }
}

/// The files that a scene is made of: none for a built-in one, a model, or a scene file with its models, and their
/// libraries and pictures.
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

/// What kind of file a scene is in, by its name's ending.
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

/// Does this path end as those of files that scenes are read from?
pub fn is_scene_file(path: &Path) -> bool {
    SceneFileKind::of(path).is_some()
}

/// Does this name a bare model, whose up axis is anybody's guess? A glTF file's is y.
pub fn is_model(name: &str) -> bool {
    let format = ModelFormat::of(Path::new(name)).filter(|_| Builtin::named(name).is_none());
    matches!(format, Some(ModelFormat::Obj | ModelFormat::Ply))
}

/// Opens a scene. The result is at time 0.
///
/// # Errors
/// An unknown name, with the nearest one; a file that is missing or broken, with the line where
/// there is one, and the mend.
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
    if path.is_dir() {
        return SceneError::Read {
            file: path.to_owned(),
            reason: "is a folder: name a scene file (.toml) or a model (.obj, .ply, .gltf, .glb) in it".to_owned(),
        };
    }
    if path.is_file() {
        let reason = "is of no kind that can be opened: give a scene file (.toml) or a model (.obj, .ply, .gltf, .glb)"
            .to_owned();
        return SceneError::Read { file: path.to_owned(), reason };
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
