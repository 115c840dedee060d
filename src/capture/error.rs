//! The errors of writing and reading capture folders.

use std::path::PathBuf;

/// Why a capture folder can't be written or read.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The folder exists already.
    #[error("{}: there is a capture already; replace it with --overwrite or choose another folder", folder.display())]
    Exists {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// What exists at the path is no capture folder, so it is never replaced.
    #[error("{}: it is there already and is no capture folder; choose another name", folder.display())]
    InTheWay {
        /// Path of the file or folder.
        folder: PathBuf,
    },
    /// The folder can't be created, filled or moved to its place.
    #[error("{}: can't be written ({source}); choose a folder that you may write to, with room in it", file.display())]
    Write {
        /// Path of the file or folder.
        file: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The scene can't be written beside the frame.
    #[error(transparent)]
    Store(#[from] crate::scene::file::StoreError),
    /// The scene in the folder is broken.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// A file is missing or broken.
    #[error("{}: {reason}; capture the scene again", file.display())]
    Read {
        /// Path of the file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}
