//! Writes a scene to a file: the scene file, and the models and pictures that it needs beside it.

use super::save::{SaveError, SavedScene, save};
use crate::files::{exists, from_beside, read_plain, remove, write_whole};
use crate::scene::Scene;
use crate::scene::files::model;
use crate::scene::files::read_text::stem;
use std::io;
use std::path::{Path, PathBuf};

/// Why a scene can't be written to its file.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file's name does not end as those of scene files.
    #[error("`{0}` can't be a scene file: give it a name that ends in .toml")]
    NoSceneFile(String),
    /// There is a different model or picture of that name already.
    #[error("`{0}` is another file, and stays as it is: choose another name for the scene")]
    ModelInTheWay(String),
    /// The scene can't be written as text.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// A file can't be written.
    #[error("`{file}` can't be written ({source}): choose another place")]
    Write {
        /// Name of the scene file or a model.
        file: String,
        /// The system's error.
        source: io::Error,
    },
}

/// Writes `scene` to `file`, which must end in `.toml` and is replaced, with its models and pictures beside it. Meshes
/// unchanged since `source` was opened are named there and not written again.
pub fn store(scene: &Scene, source: Option<&Path>, file: &Path) -> Result<(), StoreError> {
    if file.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("toml")) {
        return Err(StoreError::NoSceneFile(file.display().to_string().escape_debug().to_string()));
    }
    // A mesh that was changed is not in its file any more, and is written.
    let known = source.map(|path| model::named_meshes(path, &from_beside(file, path))).unwrap_or_default();
    write_files(&save(scene, &stem(file), known)?, file)
}

/// Writes models and pictures first, so that the scene file is never there without them. One with the same content
/// stays; another of that name is an error, and nothing is written. Where writing fails, files that were new are
/// removed.
fn write_files(saved: &SavedScene, file: &Path) -> Result<(), StoreError> {
    let mut models: Vec<(PathBuf, &[u8])> =
        saved.files.iter().map(|(name, bytes)| (file.with_file_name(name), bytes.as_slice())).collect();
    // A model with the same content stays; another may be somebody's work, or the one that the scene was opened from.
    models.retain(|(file, bytes)| !read_plain(file, bytes.len() as u64).is_ok_and(|there| there == *bytes));
    if let Some((taken, _)) = models.iter().find(|(file, _)| exists(file)) {
        return Err(StoreError::ModelInTheWay(taken.display().to_string().escape_debug().to_string()));
    }
    let all = models.iter().map(|(file, bytes)| (file.as_path(), *bytes)).chain([(file, saved.toml.as_bytes())]);
    let mut written: Vec<&Path> = Vec::new();
    for (file, bytes) in all {
        let is_new = !exists(file);
        if let Err(source) = write_whole(file, bytes) {
            // The first failure is the error that is returned.
            written.iter().for_each(|file| drop(remove(file)));
            return Err(StoreError::Write { file: file.display().to_string().escape_debug().to_string(), source });
        }
        written.extend(is_new.then_some(file));
    }
    Ok(())
}
