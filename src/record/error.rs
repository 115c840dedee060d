use crate::capture::CaptureError;
use crate::import::ImportError;

/// The reason why a frame was not recorded.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The device was not created by an instance that [`super::instance`] returns.
    #[error("this device is not recorded: make its instance with stencilscope::record::instance")]
    NotWrapped,
    /// Another frame is being recorded, or has been requested.
    #[error("another frame is being recorded, or asked for: wait until it ends")]
    Busy,
    /// The frame draws nothing that can be followed.
    #[error(transparent)]
    Frame(#[from] ImportError),
    /// The folder can't be written.
    #[error(transparent)]
    Disk(#[from] CaptureError),
}
