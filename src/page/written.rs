//! Makes the file of a page.

use super::error::PageError;
use super::{document, html as assembled};
use crate::capture::Capture;
use crate::plan::FramePlan;
use std::path::Path;
use std::sync::Arc;

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
