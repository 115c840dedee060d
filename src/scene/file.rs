//! Scene files (TOML), as described in `commands.md`.
//!
//! The text becomes plain tables (`tables`) that know where each value stands; those are
//! checked and become a [`Scene`] (`build`), meshes by `shape`. Whatever is wrong ends as one
//! line: file, line, what, mend.

mod build;
mod problem;
mod shape;
mod tables;

use super::open::stem;
use super::read_text::read_text;
use super::{Scene, SceneError};
use problem::Problem;
use std::path::Path;

/// Loads a scene file; meshes are looked for relative to it.
///
/// # Errors
/// A file that can't be read; an unknown key, a wrong type, a value that can't be used, a mesh
/// that can't be loaded, with its line.
pub fn load(file: &Path) -> Result<Scene, SceneError> {
    let text = read_text(file, "scene file")?;
    let folder = file.parent().unwrap_or(Path::new(""));
    parse(&text, &stem(file), folder).map_err(|problem| SceneError::Line {
        file: file.to_owned(),
        line: problem.line_in(&text),
        reason: problem.reason,
    })
}

/// `name` is the scene's unless the text gives one.
fn parse(text: &str, name: &str, folder: &Path) -> Result<Scene, Problem> {
    let table = toml::from_str(text).map_err(|error| Problem::of_toml(&error))?;
    build::scene(table, name, folder)
}

#[cfg(test)]
mod tests;
