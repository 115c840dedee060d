//! The draw level of the passes: which draw is selected, what is shown while its state is not
//! there, and asking for it.
//!
//! A capture need not hold the state after each draw. Selecting a draw without one asks the app for
//! those of its pass, once; until they come the picture stays as it was.

use super::action::Action;
use super::moment::Moment;
use super::state::State;
use crate::capture::Capture;

/// How far the states after the draws of a step are.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum DrawsState {
    /// Nobody has asked for any that are missing.
    #[default]
    NotAsked,
    /// Those of this step are being captured.
    Fetching(usize),
    /// Why there are none of this step, with the mend.
    Failed(usize, String),
}

impl State {
    /// What is selected.
    #[must_use]
    pub fn selected(&self) -> Moment {
        Moment { step: self.step, draw: self.draw }
    }

    /// What is shown: what is selected, or what was shown before while that is not known.
    #[must_use]
    pub fn moment(&self) -> Moment {
        let selected = self.selected();
        let is_held = self.capture.as_ref().is_none_or(|capture| selected.is_held(capture));
        if is_held { selected } else { self.stays }
    }

    /// Selects a moment; without a draw of that number, the step.
    pub fn select(&mut self, at: Moment) {
        let stays = self.moment();
        let all_draws = self.all_draws && at.step == self.step;
        self.select_step(at.step);
        self.all_draws = all_draws;
        self.stays = stays;
        let draws = self.capture.as_ref().and_then(|capture| Some(capture.steps.get(self.step)?.draws.len()));
        self.draw = at.draw.filter(|draw| draws.is_some_and(|draws| *draw < draws));
        self.playing = None;
    }

    /// Goes `by` draws on through the whole frame, or back where negative.
    pub fn draw_by(&mut self, by: isize) {
        let Some(capture) = self.capture.clone() else { return };
        let mut at = self.selected();
        for _ in 0..by.unsigned_abs() {
            let Some(next) = (if by > 0 { at.next(&capture) } else { at.previous(&capture) }) else { break };
            at = next;
        }
        if at != self.selected() {
            self.select(at);
        }
    }

    /// Asks for the states after the draws of the selected step where one is wished for, not
    /// known, and was not asked for yet.
    pub fn ask_for_draws(&mut self, actions: &mut Vec<Action>) {
        let is_asked = match &self.draws {
            DrawsState::NotAsked => false,
            DrawsState::Fetching(step) | DrawsState::Failed(step, _) => *step == self.step,
        };
        let is_missing = self.capture.as_ref().is_some_and(|capture| !self.selected().is_held(capture));
        let is_missing = is_missing || self.lacks_draw_before();
        if is_missing && !is_asked && self.scene.is_some() {
            self.draws = DrawsState::Fetching(self.step);
            actions.push(Action::CaptureDraws { step: self.step });
        }
    }

    /// The draws of a step can't be had.
    pub fn set_draws_failed(&mut self, step: usize, reason: String) {
        if self.draws == DrawsState::Fetching(step) {
            self.draws = DrawsState::Failed(step, reason);
        }
    }

    /// More is known of the shown frame: perhaps the draws that were asked for.
    pub fn note_draws_of(&mut self, capture: &Capture) {
        if let DrawsState::Fetching(step) = self.draws
            && capture.holds_draws(step)
        {
            self.draws = DrawsState::NotAsked;
        }
    }

    /// Another frame takes the place of `before`, in which `step` was selected: the draw of the
    /// same name stays selected, and its state is asked for again.
    pub fn follow_draw(&mut self, before: &Capture, step: usize, now: &Capture) {
        let name = self.draw.and_then(|draw| Some(&before.steps.get(step)?.draws.get(draw)?.name));
        let draws = now.steps.get(self.step).map_or(&[][..], |step| &step.draws);
        let same = |draw: usize| draws.get(draw).is_some_and(|draw| Some(&draw.name) == name);
        self.draw = self.draw.filter(|draw| same(*draw)).or_else(|| (0..draws.len()).find(|draw| same(*draw)));
    }
}
