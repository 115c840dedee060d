//! Makes the file of a page.

use super::error::PageError;
use super::{document, html as assembled};
use crate::capture::Capture;
use crate::plan::FramePlan;
use std::path::Path;
use std::sync::Arc;

/// Returns a frame as one self-contained HTML text, titled with its scene and technique.
///
/// `live` is the frame's address in a live window, a [`ViewLink`](crate::link::ViewLink) as its query: the page then links
/// to it, with the selected step and pixel added. Without it the page has no such link.
pub fn html(capture: &Capture, plan: &Arc<FramePlan>, live: Option<&str>) -> Result<String, PageError> {
    opened_at(capture, plan, live, None, None)
}

fn opened_at(
    capture: &Capture,
    plan: &Arc<FramePlan>,
    live: Option<&str>,
    opens: Option<&str>,
    diagnosis: Option<&str>,
) -> Result<String, PageError> {
    let title = format!("{}, {}", capture.scene, capture.technique);
    let has_truth = capture.lights.iter().any(|light| light.truth.is_some());
    // Pixels are seen in the finished frame, where they are wrong if that is known.
    let view = if has_truth { "error" } else { "color" };
    let link = format!("step={}&amp;view={view}", capture.steps.len());
    let diagnosis = diagnosis.map(|diagnosis| assembled::findings(diagnosis, &link)).transpose()?;
    let document = document::json(capture, plan, live, opens)?;
    Ok(assembled::page(&title, &document, diagnosis.as_deref().unwrap_or_default()))
}

/// Writes a frame as one self-contained HTML file, as [`html`] returns it, to `path`, replacing a file there once all is
/// written, and returns its size in bytes.
pub fn write(capture: &Capture, plan: &Arc<FramePlan>, live: Option<&str>, path: &Path) -> Result<u64, PageError> {
    written(&html(capture, plan, live)?, path)
}

/// Writes a frame as [`write()`] does, without a live window, so that the page opens at the step, view and pixel that `look`
/// names as a page's fragment does: `step=3&view=stencil&pixel=10,20`. What is not of the frame is passed over. The page has
/// what a `diagnosis` found, where one is given in the form of `diagnose --json`.
///
/// # Errors
/// As of [`write()`]; or the diagnosis is no JSON.
pub fn write_at(
    capture: &Capture,
    plan: &Arc<FramePlan>,
    look: &str,
    diagnosis: Option<&str>,
    path: &Path,
) -> Result<u64, PageError> {
    written(&opened_at(capture, plan, None, Some(look), diagnosis)?, path)
}

fn written(text: &str, path: &Path) -> Result<u64, PageError> {
    let failed = |source| PageError::Write { path: path.display().to_string(), source };
    crate::files::write_whole(path, text.as_bytes()).map_err(failed)?;
    Ok(text.len() as u64)
}
