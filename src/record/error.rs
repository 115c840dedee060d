use crate::capture::CaptureError;
use crate::import::ImportError;
use crate::session::SessionError;

/// Why a frame is not recorded.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The device is not one that is recorded.
    #[error("this device is not recorded: make its instance with stencilscope::record::instance")]
    NotWrapped,
    /// Another frame is.
    #[error("another frame is being recorded: wait until it ends")]
    Busy,
    /// Nothing that can be followed is drawn.
    #[error(transparent)]
    Frame(#[from] ImportError),
    /// Its draws can't be computed anew.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The folder.
    #[error(transparent)]
    Disk(#[from] CaptureError),
}
