use crate::capture::CaptureError;
use crate::import::ImportError;

/// Why a frame is not recorded.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The device is not one that is recorded.
    #[error("this device is not recorded: make its instance with stencilscope::record::instance")]
    NotWrapped,
    /// Another frame is being recorded, or asked for.
    #[error("another frame is being recorded, or asked for: wait until it ends")]
    Busy,
    /// Nothing that can be followed is drawn.
    #[error(transparent)]
    Frame(#[from] ImportError),
    /// The folder.
    #[error(transparent)]
    Disk(#[from] CaptureError),
}
