//! What the panel remembers, and what is told of the pick now.

use crate::history::{PixelHistory, Verdict};
use crate::inspector::model::Model;
use crate::inspector::model::history::is_late;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Weak};

/// The panel.
#[derive(Debug, Default)]
pub struct PixelPanel {
    /// Events that did nothing are hidden.
    pub hides_idle: bool,
    /// Rungs of each light's ladder that were opened from a fold: of this history.
    pub unfolded: BTreeMap<usize, Vec<Range<usize>>>,
    /// The history that was told last.
    shown: Weak<PixelHistory>,
    /// The history that was checked last, and where it contradicts the GPU, in words.
    checked: Weak<PixelHistory>,
    wrong: Vec<String>,
    /// The row of the selected event has to be scrolled to.
    pub scrolls_to_selected: bool,
    /// The corner whose coordinates are shown, a vertex of the mesh; `None`: those of the pixel's point.
    pub corner: Option<u32>,
    /// The sentence on top as it was last said with a history.
    pub sentence: Option<Verdict>,
}

/// What is known of the picked pixel's history in this frame of the window.
#[derive(Debug)]
pub struct PickedHistory {
    /// Of the pixel; of the one before, or of the frame before, while that is on its way.
    pub history: Option<Arc<PixelHistory>>,
    /// It is of the picked pixel of the shown frame.
    pub is_of_pick: bool,
    /// It is not, and has not been for a while.
    pub is_late: bool,
    /// Why there is none.
    pub failed: Option<String>,
    /// Where it contradicts the GPU, in words.
    pub wrong: Vec<String>,
}

impl PixelPanel {
    /// What is told of the pick now; of another history than before nothing is unfolded.
    pub fn picked_history(&mut self, model: &Model) -> PickedHistory {
        let reply = model.want_history();
        let history = reply.latest().filter(|_| reply.failed.is_none()).cloned();
        if let Some(history) = &reply.ready
            && !std::ptr::eq(self.shown.as_ptr(), Arc::as_ptr(history))
        {
            self.shown = Arc::downgrade(history);
            self.unfolded.clear();
            self.scrolls_to_selected = true;
        }
        if let Some(history) = &history
            && !std::ptr::eq(self.checked.as_ptr(), Arc::as_ptr(history))
        {
            self.checked = Arc::downgrade(history);
            self.wrong = history.disagreements().into_iter().map(|one| one.to_string()).collect();
        }
        PickedHistory {
            is_of_pick: reply.ready.is_some(),
            is_late: is_late(&reply),
            wrong: history.as_ref().map(|_| self.wrong.clone()).unwrap_or_default(),
            failed: reply.failed,
            history,
        }
    }
}
