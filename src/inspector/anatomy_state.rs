//! What the shown frame is made of in space: asked for once a frame, while something shows it.
//!
//! While that of a new frame is waited for, that of the frame before stays.

use crate::anatomy::Anatomy;
use std::sync::Arc;

/// How far the anatomy of the shown frame is.
#[derive(Debug, Default)]
pub struct AnatomyState {
    /// Something that is shown needs it; set anew each frame.
    wanted: bool,
    asked: bool,
    known: Option<Arc<Anatomy>>,
    is_of_frame: bool,
    failed: Option<String>,
}

impl AnatomyState {
    /// Something that is drawn now needs it. The anatomy, of the frame before while that of this one is not
    /// there; `None` while there is none.
    pub fn want(&mut self) -> Option<Arc<Anatomy>> {
        self.wanted = true;
        self.known.clone()
    }

    /// Is it of the frame that is shown?
    #[must_use]
    pub fn is_of_frame(&self) -> bool {
        self.is_of_frame
    }

    /// Why there is none, with the mend.
    #[must_use]
    pub fn failed(&self) -> Option<&str> {
        self.failed.as_deref()
    }

    /// True once a frame, if something needed it since this was last asked.
    pub fn ask(&mut self) -> bool {
        let asks = std::mem::take(&mut self.wanted) && !self.asked;
        self.asked |= asks;
        asks
    }

    /// Another frame is shown.
    pub fn forget_frame(&mut self) {
        *self = AnatomyState { known: self.known.take(), ..AnatomyState::default() };
    }

    /// Another scene is open, or none.
    pub fn forget(&mut self) {
        *self = AnatomyState::default();
    }

    /// The answer.
    pub fn answer(&mut self, anatomy: Result<Arc<Anatomy>, String>) {
        match anatomy {
            Ok(anatomy) => *self = AnatomyState { known: Some(anatomy), is_of_frame: true, failed: None, ..*self },
            Err(reason) => *self = AnatomyState { known: None, is_of_frame: false, failed: Some(reason), ..*self },
        }
        self.asked = true;
    }
}
