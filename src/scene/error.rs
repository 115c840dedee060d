//! Why a scene can't be loaded: one line with the file, the line and the mend.

use super::MeshError;
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
}
