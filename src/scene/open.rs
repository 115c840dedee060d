//! A scene by whatever names it: a built-in name, a scene file or a model.

use super::builtin::{self, Builtin};
use super::read_text::stem;
use super::suggestion::nearest;
use super::{Scene, SceneError, UpAxis, file, model_scene, obj};
use std::path::{Path, PathBuf};

/// What to open, and how a bare model is completed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenSpec {
    /// A built-in name, or the path of a scene file (`.toml`) or a model (`.obj`).
    pub name: String,
    /// Puts a floor under a bare model; scene files and built-in scenes are taken as they are.
    pub floor: bool,
    /// Which axis of a bare model is up; the others say so themselves.
    pub up: UpAxis,
}

impl OpenSpec {
    /// `name` with a floor under it if it is a model, whose y axis is up.
    #[must_use]
    pub fn new(name: impl Into<String>) -> OpenSpec {
        OpenSpec { name: name.into(), floor: true, up: UpAxis::Y }
    }
}

/// The files that a scene is made of: none for a built-in one, a model, or a scene file with its models, and their
/// libraries and pictures.
#[must_use]
pub fn files_of(spec: &OpenSpec) -> Vec<PathBuf> {
    if Builtin::named(&spec.name).is_some() {
        return Vec::new();
    }
    let path = PathBuf::from(&spec.name);
    let is_scene_file = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    let named = if is_scene_file { file::models_of(&path) } else { Vec::new() };
    let files: Vec<PathBuf> = std::iter::once(path).chain(named).collect();
    let is_model = |file: &&PathBuf| file.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("obj"));
    let of_models: Vec<PathBuf> = files.iter().filter(is_model).flat_map(|model| obj::files_of(model)).collect();
    files.into_iter().chain(of_models).collect()
}

/// Does this name a bare model?
#[must_use]
pub fn is_model(name: &str) -> bool {
    let extension = Path::new(name).extension();
    Builtin::named(name).is_none() && extension.is_some_and(|kind| kind.eq_ignore_ascii_case("obj"))
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
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    match extension.as_deref().and_then(|extension| extension.to_str()) {
        Some("toml") => file::load(path),
        Some("obj") => {
            model_scene(&stem(path), obj::load(path)?, spec.floor, spec.up).map_err(|error| error.in_file(path))
        }
        _ => Err(unknown(&spec.name)),
    }
}

fn unknown(name: &str) -> SceneError {
    let path = Path::new(name);
    if path.is_dir() {
        return SceneError::Read {
            file: path.to_owned(),
            reason: "is a folder: name a scene file (.toml) or a model (.obj) in it".to_owned(),
        };
    }
    if path.is_file() {
        let reason = "is of no kind that can be opened: give a scene file (.toml) or a model (.obj)".to_owned();
        return SceneError::Read { file: path.to_owned(), reason };
    }
    let names: Vec<&str> = builtin::ALL.iter().map(|builtin| builtin.name).collect();
    let hint = match nearest(name, &names) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("choose one of {}, a scene file (.toml) or a model (.obj)", names.join(", ")),
    };
    SceneError::Unknown { name: name.escape_debug().to_string(), hint }
}
