//! What can go wrong with a capture folder.

use std::path::PathBuf;

/// Why a capture folder can't be written or read.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The folder is there already.
    #[error("{}: there is a capture already; replace it with --overwrite or choose another folder", folder.display())]
    Exists {
        /// Which folder.
        folder: PathBuf,
    },
    /// What is there is no capture folder, so it is never replaced.
    #[error("{}: it is there already and is no capture folder; choose another name", folder.display())]
    InTheWay {
        /// Which file or folder.
        folder: PathBuf,
    },
    /// The folder can't be made, filled or put in its place.
    #[error("{}: can't be written ({source}); choose a folder that you may write to, with room in it", file.display())]
    Write {
        /// Which file or folder.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The scene can't be put beside the frame.
    #[error(transparent)]
    Store(#[from] crate::scene::file::StoreError),
    /// The scene in the folder is broken.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// A file is missing or broken.
    #[error("{}: {reason}; capture the scene again", file.display())]
    Read {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}
