//! To come.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {}
