//! How the picture is looked at: before or after a step, what the step changed, beside another picture,
//! one bit of it, and what is drawn over it.

use super::action::Action;
use super::change::ChangeCache;
use super::compare::{Compare, Compared};
use super::moment::Moment;
use super::overlays::Overlays;
use super::state::State;
use super::tests_state::TestsState;
use super::view::{PictureKind, Shown};
use crate::capture::{Capture, StepTests};
use std::sync::Arc;

/// Which side of the selected step or draw is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Phase {
    /// As it was before.
    Before,
    /// As it is now.
    #[default]
    After,
    /// What changed.
    Diff,
}

impl Phase {
    /// In the order of their buttons.
    pub const ALL: [Phase; 3] = [Phase::Before, Phase::After, Phase::Diff];
    /// Labels and explanations of the buttons.
    pub const LABELS: [(&'static str, &'static str); 3] = [
        ("Before", "As it was before the selected step or draw (B goes there and back)"),
        ("After", "As the selected step or draw left it"),
        ("Diff", "What the selected step or draw changed (D)"),
    ];
}

/// Why there is nothing to show of the time before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoBefore {
    /// It is the first step.
    First,
    /// The state after the draw before is being captured, or can't be had.
    NotKnown,
}

impl NoBefore {
    /// In a sentence, with what to do.
    #[must_use]
    pub fn sentence(self) -> &'static str {
        match self {
            NoBefore::First => "Nothing comes before the first step: its buffers start cleared. Select a later one.",
            NoBefore::NotKnown => {
                "The state before this draw is not known yet; a folder has it where it was captured with --every draw."
            }
        }
    }
}

/// How the picture is looked at.
#[derive(Debug, Default)]
pub struct Modes {
    /// Before, after, or what changed.
    pub phase: Phase,
    /// The one bit of the stencil that is shown; `None`: all.
    pub bit: Option<u8>,
    /// What is shown beside it.
    pub compare: Option<Compare>,
    /// Where the divider was last: 0 at the picture's left border, 1 at its right one.
    pub seam: Option<f32>,
    /// Captures of other techniques to compare with.
    pub compared: Compared,
    /// What is drawn over it.
    pub overlays: Overlays,
    /// How the fragments of the selected step fared.
    pub tests: TestsState,
    /// What changed, made once.
    pub changes: ChangeCache,
    /// The legend of the error picture counts, and does not only say what colours mean.
    pub counts_findings: bool,
}

impl Modes {
    /// Another frame is shown.
    pub fn forget_frame(&mut self) {
        self.changes.forget();
        self.overlays.forget_frame();
        self.tests.forget();
    }

    /// Another scene is open, or none.
    pub fn forget_scene(&mut self) {
        self.compared.forget();
        self.compare = None;
    }
}

/// Has this kind of picture a state before and after each step?
#[must_use]
pub fn has_phases(kind: PictureKind) -> bool {
    matches!(kind, PictureKind::Color | PictureKind::Stencil | PictureKind::Depth)
}

/// What came before a moment.
///
/// # Errors
/// There is nothing, or it is not known.
pub fn before(capture: &Capture, at: Moment) -> Result<Moment, NoBefore> {
    match at.draw.and_then(|draw| draw.checked_sub(1)) {
        Some(draw) => {
            let before = Moment { draw: Some(draw), ..at };
            if before.is_held(capture) { Ok(before) } else { Err(NoBefore::NotKnown) }
        }
        None => at.step.checked_sub(1).map(Moment::from).ok_or(NoBefore::First),
    }
}

impl State {
    /// The picture that is shown: of the selected moment, or of the one before it.
    #[must_use]
    pub fn shown(&self, capture: &Capture) -> Option<Shown> {
        let now = self.view.shown(capture, self.moment());
        match self.modes.phase {
            Phase::Before => match now {
                Some(now) if !has_phases(now.kind) => Some(now),
                _ => self.shown_before(capture).ok(),
            },
            Phase::After | Phase::Diff => now,
        }
    }

    /// The picture before the selected moment.
    ///
    /// # Errors
    /// There is nothing before it, or it is not known.
    pub fn shown_before(&self, capture: &Capture) -> Result<Shown, NoBefore> {
        let at = self.moment();
        let mut shown = self.view.shown(capture, before(capture, at)?).ok_or(NoBefore::First)?;
        let of = shown.title.split(" after ").next().unwrap_or_default().to_owned();
        shown.title = format!("{of} before {}", at.words());
        Ok(shown)
    }

    /// Does something that is shown need the state before the selected draw, which is not known?
    #[must_use]
    pub fn lacks_draw_before(&self) -> bool {
        let lacks = |capture: &Capture| before(capture, self.selected()) == Err(NoBefore::NotKnown);
        self.modes.phase != Phase::After && self.capture.as_ref().is_some_and(|capture| lacks(capture))
    }

    /// Asks how the fragments of the selected step fared, where something shows it and nobody knows.
    pub fn ask_for_tests(&mut self, actions: &mut Vec<Action>) {
        if self.scene.is_none() || self.capture.is_none() {
            return;
        }
        if self.view.kind == PictureKind::Overdraw {
            self.modes.tests.want(self.selected());
        }
        if let Some(Moment { step, draw }) = self.modes.tests.ask() {
            actions.push(Action::Tests { step, draw });
        }
    }

    /// How the fragments of a moment fared, or why nobody knows.
    pub fn set_tests(&mut self, at: Moment, result: Result<Arc<StepTests>, String>) {
        self.modes.tests.answer(at, result);
        self.view.tests = self.modes.tests.of(at).map(|known| known.tests.clone()).or(self.view.tests.take());
    }
}
