//! The history of the picked pixel: when it is asked for, what is shown until the answer comes, and
//! which of its triangles is selected.
//!
//! An answer takes a few milliseconds. For as long as [`PATIENCE`] what was known of the pixel
//! before stays as it is, so that a dragged pick does not flicker; after that it is greyed.

use super::verdict::Verdict;
use crate::history::{Event, PixelHistory};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// How long an answer may take before what is shown is greyed, seconds.
const PATIENCE: f64 = 0.12;

/// What is known of the picked pixel's history.
#[derive(Debug, Default)]
pub struct HistoryState {
    /// The last answer; of the pixel or frame before while another is waited for.
    known: Option<Known>,
    /// Why there is no answer, with the mend.
    failed: Option<String>,
    /// The pixel of this frame that was asked about last.
    asked: Option<[u32; 2]>,
    /// When that was, in egui's seconds.
    asked_at: f64,
    /// The answer is waited for longer than [`PATIENCE`].
    is_late: bool,
    /// Events that did nothing are hidden.
    pub hides_idle: bool,
    /// The selected triangle.
    selected: Option<TriangleKey>,
    /// Its row has to be scrolled to.
    pub scroll_to_selected: bool,
    /// Rungs of each light's ladder that were opened from a fold: of this pixel of this frame.
    pub unfolded: BTreeMap<usize, Vec<Range<usize>>>,
    /// The sentence on top as it was last said with a history.
    pub sentence: Option<Verdict>,
}

/// A history with what is looked up in it every frame.
#[derive(Debug)]
struct Known {
    history: Arc<PixelHistory>,
    /// It is of the frame that is shown.
    is_of_frame: bool,
    /// Where it contradicts the GPU, in words.
    wrong: Vec<String>,
}

/// A triangle of a frame: pass, draw, primitive.
type TriangleKey = [usize; 3];

fn key(event: &Event) -> Option<TriangleKey> {
    event.triangle().map(|one| [event.pass, one.draw, one.primitive as usize])
}

impl HistoryState {
    /// Takes note that `at` is picked; true where it has to be asked for.
    pub fn ask(&mut self, ctx: &egui::Context, at: [u32; 2]) -> bool {
        let now = ctx.input(|input| input.time);
        let is_new = self.asked != Some(at);
        if is_new {
            // A pick that is dragged on is waited for since it began to move.
            if self.asked.is_none() || !self.is_waiting() {
                self.asked_at = now;
            }
            self.asked = Some(at);
            self.failed = None;
        }
        let waits_for = now - self.asked_at;
        self.is_late = self.is_waiting() && waits_for >= PATIENCE;
        if self.is_waiting() && !self.is_late {
            ctx.request_repaint_after(Duration::from_secs_f64((PATIENCE - waits_for).max(0.001)));
        }
        is_new
    }

    /// Takes the answer about `at`, which is still picked.
    pub fn answer(&mut self, at: [u32; 2], history: Result<Arc<PixelHistory>, String>) {
        match history {
            Ok(history) if history.pixel == at => {
                let wrong = history.disagreements().iter().map(ToString::to_string).collect();
                if self.of(at).is_none() {
                    self.unfolded.clear();
                }
                self.known = Some(Known { history, is_of_frame: true, wrong });
                self.failed = None;
            }
            Ok(_) => return,
            Err(reason) => {
                self.known = None;
                self.failed = Some(reason);
            }
        }
        self.asked = Some(at);
        self.is_late = false;
        self.scroll_to_selected = true;
    }

    /// What is shown has no history: a capture folder.
    pub fn close(&mut self) {
        *self = HistoryState { hides_idle: self.hides_idle, ..HistoryState::default() };
    }

    /// Another frame is shown: what is known is of the one before.
    pub fn forget_frame(&mut self) {
        self.asked = None;
        self.failed = None;
        self.is_late = false;
        if let Some(known) = &mut self.known {
            known.is_of_frame = false;
        }
    }

    /// The history of pixel `at` of the shown frame.
    #[must_use]
    pub fn of(&self, at: [u32; 2]) -> Option<&Arc<PixelHistory>> {
        let known = self.known.as_ref().filter(|known| known.is_of_frame)?;
        (known.history.pixel == at).then_some(&known.history)
    }

    /// The same, or that of the pixel that was picked just before, of the same frame.
    #[must_use]
    pub fn of_frame(&self, at: [u32; 2]) -> Option<&Arc<PixelHistory>> {
        let known = self.known.as_ref().filter(|known| known.is_of_frame)?;
        (known.history.pixel == at || !self.is_late).then_some(&known.history)
    }

    /// The last history, whatever it is of.
    #[must_use]
    pub fn last(&self) -> Option<&Arc<PixelHistory>> {
        self.known.as_ref().map(|known| &known.history)
    }

    /// Why there is none.
    #[must_use]
    pub fn failed(&self) -> Option<&str> {
        self.failed.as_deref()
    }

    /// Where the last history contradicts the GPU.
    #[must_use]
    pub fn wrong(&self) -> &[String] {
        self.known.as_ref().map_or(&[], |known| &known.wrong)
    }

    /// What is shown is of another pixel or frame, and has been for a while.
    #[must_use]
    pub fn is_late(&self) -> bool {
        self.is_late
    }

    /// What is shown is of another pixel or frame.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        match self.asked {
            Some(at) => self.failed.is_none() && self.of(at).is_none(),
            None => self.known.is_some(),
        }
    }

    /// Selects the triangle of an event, or nothing where it has none.
    pub fn select(&mut self, event: &Event) {
        self.selected = key(event);
    }

    /// Is the event that of the selected triangle?
    #[must_use]
    pub fn is_selected(&self, event: &Event) -> bool {
        self.selected.is_some() && key(event) == self.selected
    }

    /// Index of the event of the selected triangle.
    #[must_use]
    pub fn selected_in(&self, history: &PixelHistory) -> Option<usize> {
        history.events.iter().position(|event| self.is_selected(event))
    }
}
