//! The state of the Pixel panel, and what is known of the pick now.

use crate::history::PixelHistory;
use crate::inspector::action::TourSubject;
use crate::inspector::model::Model;
use crate::inspector::model::history::is_late;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Weak};

/// The state of the panel Pixel, and what it caches of the history that it showed last.
#[derive(Debug, Default)]
pub struct PixelPanel {
    /// Events that did nothing are hidden.
    pub hides_idle: bool,
    /// For each light, the ranges of its ladder's rungs that were opened from a fold, in this history.
    pub unfolded: BTreeMap<usize, Vec<Range<usize>>>,
    /// The history that was shown last, and the number of its frame.
    shown: Weak<PixelHistory>,
    of_frame: u64,
    /// What the stop of a tour spoke of when the panel was drawn last.
    pub toured: Option<TourSubject>,
    /// The history that was checked last, and where it contradicts the GPU, in words.
    checked: Weak<PixelHistory>,
    wrong: Vec<String>,
    /// The row of the selected event has to be scrolled to.
    pub scrolls_to_selected: bool,
    /// The corner whose coordinates are shown, a vertex of the mesh; `None`: those of the pixel's point.
    pub corner: Option<u32>,
    /// The rays from the lights are listed.
    pub shows_rays: bool,
    /// How matrices and coordinates are written.
    pub conventions: Conventions,
}

/// How matrices and coordinates are written: APIs and books differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Conventions {
    /// Depth is from −1 to 1 in NDC and rows are counted from below, as in OpenGL; otherwise from 0 to 1, and from above, as
    /// in WebGPU.
    pub is_opengl: bool,
    /// Points are rows on a matrix's left, so that it is written transposed; otherwise columns on its right.
    pub has_rows: bool,
}

/// What is known of the picked pixel's history in this frame of the window.
#[derive(Debug)]
pub struct PickedHistory {
    /// The history of the picked pixel; while that is being computed, of the pixel or the frame before.
    pub history: Option<Arc<PixelHistory>>,
    /// The history belongs to the picked pixel of the shown frame.
    pub is_of_pick: bool,
    /// It does not, and has not for a while, or the frame is one of many while something is dragged.
    pub is_late: bool,
    /// Why there is no history.
    pub failed: Option<String>,
    /// Where the history contradicts the GPU, in words.
    pub wrong: Vec<String>,
}

impl PixelPanel {
    /// Returns what is known of the picked pixel's history, which is asked for: while there is none, an older one of
    /// another pixel or frame, and none where it failed. When another history comes, all rungs are folded and the
    /// selected event is scrolled to.
    pub fn picked_history(&mut self, model: &Model) -> PickedHistory {
        let reply = model.want_history();
        let history = reply.latest().filter(|_| reply.failed.is_none()).cloned();
        if reply.ready.is_some() {
            self.of_frame = model.frame.number;
        }
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
            // Beside another frame, as while something is dragged and just after, a history is not taken for its own.
            is_late: is_late(&reply) || (reply.ready.is_none() && self.of_frame != model.frame.number),
            wrong: history.as_ref().map(|_| self.wrong.clone()).unwrap_or_default(),
            failed: reply.failed,
            history,
        }
    }
}
