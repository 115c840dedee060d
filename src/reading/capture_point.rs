//! A point of the frame, after a step or after one of its draws, and what a capture stores of it.
//!
//! The state after the last draw of a step is the state after the step, so it is always known. When going through the
//! frame draw by draw, a point without a selected draw counts as the last draw of its step, and a step without draws is
//! one stop. Masks, which are not part of the frame, are passed over ([`steps`]).

use crate::capture::{Capture, DrawState, DrawSummary, FrameSnapshot, FrameTarget, Image, Snapshot};
use crate::reading::steps;
use std::sync::Arc;

/// A point in time within a captured frame: after a step, or after one of its draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CapturePoint {
    /// Index of the step in [`Capture::steps`].
    pub step: usize,
    /// Index of the draw; `None` means after the whole step.
    pub draw: Option<usize>,
}

impl From<usize> for CapturePoint {
    fn from(step: usize) -> CapturePoint {
        CapturePoint { step, draw: None }
    }
}

impl CapturePoint {
    /// Returns the point in words: `step 2`, `draw 3 of step 2`, `the mask of light 1`.
    pub fn words(self, capture: &Capture) -> String {
        let step = steps::words(capture, self.step);
        self.draw.map_or_else(|| step.clone(), |draw| format!("draw {} of {step}", draw + 1))
    }

    /// Returns whether the capture has the state at this point: always for a step as a whole and for its last (or no)
    /// draw, otherwise where the state after the draw was captured.
    pub fn is_known(self, capture: &Capture) -> bool {
        let Some(index) = self.draw else { return true };
        let draws = draws(capture, self.step);
        index + 1 >= draws.len() || draws[index].after.is_some()
    }

    /// Returns the state after the draw; `None` for a whole step, or where the draw's was not captured.
    fn state(self, capture: &Capture) -> Option<&DrawState> {
        draws(capture, self.step).get(self.draw?)?.after.as_ref()
    }

    /// Returns colour, depth and stencil after the draw, or, where the draw's are not known or it draws a map, after
    /// the step; `None` where the step has none yet.
    pub fn frame(self, capture: &Capture) -> Option<&FrameSnapshot> {
        match self.state(capture).map(|state| &state.snapshot) {
            Some(Snapshot::Frame(frame)) => Some(frame),
            Some(Snapshot::Map { .. }) | None => capture.frame_at(self.step),
        }
    }

    /// Returns the index of the light whose labels the draw writes, and the labels after it; `None` if it writes none.
    pub fn labels(self, capture: &Capture) -> Option<(usize, &Arc<Image>)> {
        self.own(capture, FrameTarget::Labels)
    }

    /// Returns the index of the light whose float count the draw changes, and the count after it; `None` if it changes
    /// none.
    pub fn count(self, capture: &Capture) -> Option<(usize, &Arc<Image>)> {
        self.own(capture, FrameTarget::Count)
    }

    /// Returns the index of the light whose visibility the draw writes, and the visibility after it; `None` if it writes
    /// none.
    pub fn visibility(self, capture: &Capture) -> Option<(usize, &Arc<Image>)> {
        self.own(capture, FrameTarget::Visibility)
    }

    fn own(self, capture: &Capture, target: FrameTarget) -> Option<(usize, &Arc<Image>)> {
        let state = self.state(capture)?;
        let is_it = matches!(&state.snapshot, Snapshot::Frame(frame) if frame.target == target);
        let light = capture.steps.get(self.step)?.light?;
        state.target.as_ref().filter(|_| is_it).map(|aspect| (light, &aspect.image))
    }

    /// Returns the layer of a light's map that the draw draws into: index of the light, index of the layer, and its
    /// texels after the draw; `None` where it draws into no map, or its state is not known.
    pub fn layer(self, capture: &Capture) -> Option<(usize, usize, &Arc<Image>)> {
        let state = self.state(capture)?;
        match &state.snapshot {
            Snapshot::Map { light, face } => Some((*light, *face, &state.target.as_ref()?.image)),
            Snapshot::Frame(_) => None,
        }
    }

    /// Returns the point one draw later in the frame: the next draw of the step, or the first of the next numbered step
    /// (the step itself where it has none); `None` at the end. From a step as a whole, it goes on with the next step.
    pub fn next(self, capture: &Capture) -> Option<CapturePoint> {
        let following = self.draw.map(|draw| draw + 1).filter(|draw| *draw < draws(capture, self.step).len());
        let in_step = following.map(|draw| CapturePoint { draw: Some(draw), ..self });
        in_step.or_else(|| {
            let step = steps::next(capture, self.step)?;
            Some(CapturePoint { step, draw: (!draws(capture, step).is_empty()).then_some(0) })
        })
    }

    /// Returns the point one draw earlier in the frame: the draw before, or the last of the numbered step before (the
    /// step itself where it has none); `None` at the start. A step as a whole counts as its last draw.
    pub fn previous(self, capture: &Capture) -> Option<CapturePoint> {
        let last = |step: usize| draws(capture, step).len().checked_sub(1);
        match self.draw.or_else(|| last(self.step)).and_then(|draw| draw.checked_sub(1)) {
            Some(draw) => Some(CapturePoint { draw: Some(draw), ..self }),
            None => steps::previous(capture, self.step).map(|step| CapturePoint { step, draw: last(step) }),
        }
    }
}

fn draws(capture: &Capture, step: usize) -> &[DrawSummary] {
    capture.steps.get(step).map_or(&[], |step| &step.draws)
}
