//! Why a scene can't be loaded: one line with the file, the line and how to fix it.

use super::MeshError;
use std::path::Path;
use std::path::PathBuf;

/// Why a scene can't be loaded.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A mesh that code builds is broken.
    #[error("{name}: {source}")]
    Mesh {
        /// Name of the mesh.
        name: String,
        /// The error of the mesh.
        source: MeshError,
    },
    /// The file can't be read.
    #[error("{}: {reason}", file.display())]
    Read {
        /// Path of the file.
        file: PathBuf,
        /// What is wrong and how to fix it.
        reason: String,
    },
    /// A line of the file is wrong.
    #[error("{}:{line}: {reason}", file.display())]
    Line {
        /// Path of the file.
        file: PathBuf,
        /// Number of the line, counted from 1.
        line: usize,
        /// What is wrong and how to fix it.
        reason: String,
    },
    /// The name is neither a built-in scene nor a file that can be one.
    #[error("no scene is called `{name}`: {hint}")]
    Unknown {
        /// The name that was asked for.
        name: String,
        /// The nearest name, or all names.
        hint: String,
    },
}

/// What is wrong with a file, from a reader that knows its text and not its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum FileProblem {
    /// A line, counted from 1, is wrong: what is wrong with it and how to fix it.
    Line(usize, String),
    /// The whole file is wrong: what is wrong with it.
    File(String),
}

impl FileProblem {
    /// Returns the problem of a model of which no triangle is left to show.
    pub fn no_triangles() -> FileProblem {
        FileProblem::File("has no triangle with three different corners: export its surface".to_owned())
    }

    /// Returns the problem as the error for this file.
    pub fn of(self, file: &Path) -> SceneError {
        let file = file.to_owned();
        match self {
            FileProblem::Line(line, reason) => SceneError::Line { file, line, reason },
            FileProblem::File(reason) => SceneError::Read { file, reason },
        }
    }
}

impl SceneError {
    /// Returns a read error for this file, in place of the name that a part of a scene has; other errors are returned
    /// as they are.
    #[must_use]
    pub(super) fn in_file(self, file: &Path) -> SceneError {
        match self {
            SceneError::Read { reason, .. } => SceneError::Read { file: file.to_owned(), reason },
            other => other,
        }
    }
}
