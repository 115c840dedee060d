//! What a person asks of the app.

use super::Setup;
use std::path::PathBuf;

/// Something only the app can do.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Capture the scene again with these settings. Newer ones replace those still waiting.
    Run(Box<Setup>),
    /// Open a built-in scene, a scene file, a model or a capture folder.
    Open(PathBuf),
    /// Show the system's file dialog, then open what it gives.
    Browse,
}
