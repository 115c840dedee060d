//! Why a scene can't be loaded: one line with the file, the line and the mend.

use super::MeshError;
use std::path::Path;
use std::path::PathBuf;

/// Why a scene can't be loaded.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A mesh made by code is broken.
    #[error("{name}: {source}")]
    Mesh {
        /// Of the mesh.
        name: String,
        /// What is wrong with it.
        source: MeshError,
    },
    /// The file can't be read.
    #[error("{}: {reason}", file.display())]
    Read {
        /// Which file.
        file: PathBuf,
        /// What is wrong and how to mend it.
        reason: String,
    },
    /// A line of the file is wrong.
    #[error("{}:{line}: {reason}", file.display())]
    Line {
        /// Which file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong and how to mend it.
        reason: String,
    },
    /// Neither a built-in scene nor a file that can be one.
    #[error("no scene is called `{name}`: {hint}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The nearest name, or what there is.
        hint: String,
    },
}

/// What is wrong with a file, by one who reads its text and does not know its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum FileProblem {
    /// With a line, counted from 1: what is wrong with it and how to mend it.
    Line(usize, String),
    /// With all of it.
    File(String),
}

impl FileProblem {
    /// A model of which nothing is left to show.
    pub fn no_triangles() -> FileProblem {
        FileProblem::File("has no triangle with three different corners: export its surface".to_owned())
    }

    /// In this file.
    pub fn of(self, file: &Path) -> SceneError {
        let file = file.to_owned();
        match self {
            FileProblem::Line(line, reason) => SceneError::Line { file, line, reason },
            FileProblem::File(reason) => SceneError::Read { file, reason },
        }
    }
}

impl SceneError {
    /// The same, of this file: what a part of a scene only knows by its name.
    #[must_use]
    pub(super) fn in_file(self, file: &Path) -> SceneError {
        match self {
            SceneError::Read { reason, .. } => SceneError::Read { file: file.to_owned(), reason },
            other => other,
        }
    }
}
