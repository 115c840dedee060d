//! In place of glTF scenes, in a build of the library without its program: none is read, and it is said why.

use super::picture::Pictures;
use super::{Camera, Light, Mesh, NotTaken, Object, SceneError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a file says: never made.
#[derive(Debug)]
pub struct Loaded {
    pub objects: Vec<Object>,
    pub lights: Vec<Light>,
    pub camera: Option<Camera>,
    pub not_taken: Vec<NotTaken>,
}

/// A file that was opened: never made.
#[derive(Debug)]
pub(in crate::scene) struct Opened;

fn left_out(file: &Path) -> SceneError {
    let reason = "is glTF, which is read with the feature `program`: switch that on, or convert it to OBJ".to_owned();
    SceneError::Read { file: file.to_owned(), reason }
}

/// Refuses.
///
/// # Errors
/// Always.
pub fn load(file: &Path) -> Result<Loaded, SceneError> {
    Err(left_out(file))
}

/// Refuses.
///
/// # Errors
/// Always.
pub(in crate::scene) fn load_mesh(
    file: &Path,
    _: Option<&str>,
    _: &mut Pictures,
    _: &mut Option<Opened>,
) -> Result<Mesh, SceneError> {
    Err(left_out(file))
}

/// None.
pub fn files_of(_: &Path) -> Vec<PathBuf> {
    Vec::new()
}

/// None.
pub fn named_meshes(_: &Path) -> Vec<(Arc<Mesh>, String)> {
    Vec::new()
}
