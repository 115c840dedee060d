//! The one place that runs things: scene and technique in, data out.
//!
//! A session owns the GPU and what is worth keeping between runs (pipelines, buffers, edge
//! lists). Commands, the window and tests all go through it.

use crate::capture::Capture;
use crate::scene::Scene;
use crate::technique::Choice;

/// What to capture.
#[derive(Debug, Clone, PartialEq)]
pub struct CaptureRequest {
    /// How shadows are made.
    pub choice: Choice,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// How often to time the frame with and without snapshots, in turn, after a warm-up;
    /// 0: not at all, and the timing is left unknown.
    pub timing_runs: usize,
    /// Brackets the frame for an attached graphics debugger.
    pub external_capture: bool,
}

/// Why nothing came out.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// No GPU.
    #[error("no usable GPU adapter: install one (Debian: mesa-vulkan-drivers)")]
    NoAdapter,
    /// The picture can't be made.
    #[error("{0}")]
    Unusable(String),
}

/// A GPU and what is kept between runs.
#[derive(Debug)]
pub struct Session {}

impl Session {
    /// Opens the GPU whose name contains `adapter` (in any case), or the best one.
    ///
    /// # Errors
    /// No usable adapter, with what to install.
    pub fn new(adapter: Option<&str>) -> Result<Session, SessionError> {
        unimplemented!("{adapter:?}")
    }

    /// Renders `scene` and keeps every attachment after every pass.
    ///
    /// # Errors
    /// A scene that the technique can't draw, a picture larger than the adapter allows, a lost GPU.
    pub fn capture(&mut self, scene: &Scene, request: &CaptureRequest) -> Result<Capture, SessionError> {
        unimplemented!("{} {request:?}", scene.name)
    }
}
