//! Scene files (TOML); `assets/help/scene-file.md` explains every key.
//!
//! The text becomes plain tables (`tables`) with the position of each value; those are checked and become a [`Scene`]
//! (`build`), meshes by `shape`. Every error is one line: file, line, what is wrong, how to fix it. [`save()`] goes the
//! other way.
//!
//! Objects and lights move by keys of their tables, all optional. A lamp that hangs and swings is an object and a light
//! with the same `swing`:
//!
//! ```toml
//! spin_degrees_per_second = [0, 20, 0]                                    # objects only
//! orbit = { center = [0, 1, 0], axis = [0, 1, 0], degrees_per_second = 30 }
//! swing = { pivot = [0, 5, 0], axis = [0, 0, 1], degrees = 12, period_seconds = 2.4 }
//! ```
//!
//! An orbit carries a thing along a circle without rotating it; a swing rotates it with its cord, as far as `degrees`
//! to either side, from rest at second 0.

mod build;
mod problem;
mod save;
mod shape;
mod store;
mod tables;

pub use save::{SaveError, SavedScene, save};
pub use store::{StoreError, store};

use super::model;
use super::read_text::{read_text, stem};
use crate::scene::{Scene, SceneError};
use problem::SceneFileProblem;
use std::path::{Path, PathBuf};

/// Returns the paths of the models and pictures that a scene file names, beside that file, sorted and each once; empty
/// where it can't be read, which loading reports.
pub fn models_of(path: &Path) -> Vec<PathBuf> {
    let table = read_text(path, "scene file").ok().and_then(|text| text.parse::<toml::Table>().ok());
    let objects = table.as_ref().and_then(|table| table.get("objects")?.as_array());
    let named = |object: &toml::Value| {
        let texture = object.get("material").and_then(|material| material.get("texture"));
        let names = [object.get("mesh"), texture].map(|name| name.and_then(toml::Value::as_str));
        names.map(|name| name.map(|name| path.with_file_name(model::split(name).0)))
    };
    let mut models: Vec<PathBuf> = objects.into_iter().flatten().flat_map(named).flatten().collect();
    models.sort();
    models.dedup();
    models
}

/// Loads a scene file; paths of meshes are relative to it.
///
/// # Errors
/// A file that can't be read; an unknown key, a wrong type, a value that can't be used, a mesh that can't be loaded,
/// with its line.
pub fn load(file: &Path) -> Result<Scene, SceneError> {
    let text = read_text(file, "scene file")?;
    let folder = file.parent().unwrap_or(Path::new(""));
    parse(&text, &stem(file), folder).map_err(|problem| SceneError::Line {
        file: file.to_owned(),
        line: problem.line_in(&text),
        reason: problem.reason,
    })
}

/// Returns the scene of a scene file's text. Its name is `name` unless the text gives one; models are read from
/// `folder`.
fn parse(text: &str, name: &str, folder: &Path) -> Result<Scene, SceneFileProblem> {
    let table = toml::from_str(text).map_err(|error| SceneFileProblem::of_toml(&error))?;
    build::scene(table, name, folder)
}

#[cfg(test)]
mod tests;
