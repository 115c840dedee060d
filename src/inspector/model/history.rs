//! The history of the picked pixel: known, being computed, or still that of the pixel picked before.
//!
//! An answer takes a few milliseconds. For as long as [`PATIENCE`] the history of the pixel picked before stays on the
//! screen, so that a dragged pick does not flicker; after that it is greyed.

use super::Model;
use crate::ask::{HistoryOf, Reply};
use crate::history::PixelHistory;
use std::sync::Arc;

/// How long an answer may take before what is shown is greyed, seconds.
pub const PATIENCE: f64 = 0.12;

impl Model {
    /// Asks for the history of the picked pixel; nothing where no pixel is picked, or the capture contains only
    /// pictures.
    pub fn want_history(&self) -> Reply<PixelHistory> {
        match self.selection.pick.filter(|_| self.can_ask() && self.frame.capture.is_some()) {
            Some(at) => self.answers.want(HistoryOf { at }),
            None => Reply::default(),
        }
    }

    /// Asks for the history of the picked pixel, and returns the seconds until the answer is late ([`PATIENCE`]);
    /// `None` where it is known, failed, is late already, or no pixel is picked.
    pub fn want_history_until(&self) -> Option<f64> {
        let reply = self.want_history();
        let is_waited_for = self.selection.pick.is_some() && reply.ready.is_none() && reply.failed.is_none();
        (is_waited_for && self.can_ask() && !is_late(&reply)).then(|| (PATIENCE - reply.waits_for).max(0.001))
    }

    /// Asks for and returns the history of the picked pixel; while that is not known and not late, the last one of the
    /// same frame, which may be of another pixel. `None` otherwise, and where no pixel is picked.
    pub fn history_of_frame(&self) -> Option<Arc<PixelHistory>> {
        // The last one is of a pixel that is picked no more.
        self.selection.pick?;
        let reply = self.want_history();
        let is_late = is_late(&reply);
        let before = || self.answers.current::<HistoryOf>().map(|(_, history)| Arc::clone(history));
        reply.ready.or_else(|| before().filter(|_| !is_late))
    }

    /// Returns the index of the first event in `history` that belongs to the selected triangle; `None` where no
    /// triangle is selected, or it has no event there.
    pub fn selected_in(&self, history: &PixelHistory) -> Option<usize> {
        history.events.iter().position(|event| self.selection.has_event(event))
    }
}

/// Returns whether the shown history is of another pixel or frame, and has been for longer than [`PATIENCE`].
pub fn is_late(reply: &Reply<PixelHistory>) -> bool {
    reply.ready.is_none() && reply.waits_for >= PATIENCE
}
