//! Makes the file of a page.

use super::{document, html as assembled};
use crate::capture::Capture;
use crate::capture::disk::CaptureError;
use crate::plan::FramePlan;
use std::path::Path;
use std::sync::Arc;

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

/// Returns a frame as one self-contained HTML text, titled with its scene and technique.
pub fn html(capture: &Capture, plan: &Arc<FramePlan>) -> Result<String, PageError> {
    let title = format!("{}, {}", capture.scene, capture.technique);
    Ok(assembled::page(&title, &document::json(capture, plan)?))
}

/// Writes a frame as one self-contained HTML file to `path`, replacing a file there once all is written, and returns
/// its size in bytes.
pub fn write(capture: &Capture, plan: &Arc<FramePlan>, path: &Path) -> Result<u64, PageError> {
    let text = html(capture, plan)?;
    let failed = |source| PageError::Write { path: path.display().to_string(), source };
    crate::files::write_whole(path, text.as_bytes()).map_err(failed)?;
    Ok(text.len() as u64)
}
