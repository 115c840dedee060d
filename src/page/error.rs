//! The errors of making a page.

use crate::capture::disk::CaptureError;

/// The reason why a page could not be written.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The document has a number that JSON does not have, or memory is short.
    #[error("the frame can't be put into a page ({0}): capture it again")]
    Document(#[from] serde_json::Error),
    /// The frame can't be stored as the files of a capture folder.
    #[error("the frame can't be put into a page ({0}): capture it again")]
    Files(#[from] CaptureError),
    /// The file can't be written.
    #[error("{path}: can't be written ({source}): choose another file")]
    Write {
        /// Path of the file.
        path: String,
        /// The system's error.
        source: std::io::Error,
    },
}
