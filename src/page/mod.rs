//! One HTML file of a frame: it opens in a browser, from disk, and makes no network requests.
//!
//! ```text
//! Capture, FramePlan ─► document (JSON) ─┐
//!        pictures, triangles ─► arrays ──┼─► html ─► one file
//!        assets/page/*.{html,css,js} ────┘
//! ```
//!
//! The file contains what was captured, each array once, and the triangles in clip space, as the GPU has them
//! (`clip.rs`). A pixel's history is computed in the browser, by modules that are named after those they mirror
//! (`coverage.js`, `stencil_machine.js`, `history.js`, `ladder.js`, `why.js`), and compared with what was stored. The
//! same frame gives the same bytes: no times are stored.

mod arrays;
mod clip;
mod document;
mod html;
mod passes;
mod reads;

pub use html::{PageAsset, STYLE, TEMPLATE, modules, script};

use crate::capture::Capture;
use crate::plan::FramePlan;
use std::path::Path;
use std::sync::Arc;

/// The reason why a page could not be written.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The document has a number that JSON does not have, or memory is short.
    #[error("the frame can't be put into a page ({0}): capture it again")]
    Document(#[from] serde_json::Error),
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
    Ok(html::page(&title, &document::json(capture, plan)?))
}

/// Writes a frame as one self-contained HTML file to `path`, replacing a file there once all is written, and returns
/// its size in bytes.
pub fn write(capture: &Capture, plan: &Arc<FramePlan>, path: &Path) -> Result<u64, PageError> {
    let text = html(capture, plan)?;
    let failed = |source| PageError::Write { path: path.display().to_string(), source };
    crate::files::write_whole(path, text.as_bytes()).map_err(failed)?;
    Ok(text.len() as u64)
}
