//! Two pictures side by side under one divider: two steps of a frame, or two techniques at one step.
//!
//! The frame of another technique is asked of the app, and kept until camera, lights, size or time
//! change. It follows the selected step to the pass of the same name and light, else it shows its last.

use super::action::{Action, RunRequest};
use super::format;
use super::state::{State, same_step};
use super::view::Shown;
use crate::capture::Capture;
use crate::numbers::percent;
use crate::technique::{Choice, Technique};
use std::sync::Arc;

/// What the divider moves by a key press, in shares of the panel.
pub const NUDGE: f32 = 0.02;

/// A comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compare {
    /// What is shown beside the picture.
    pub with: With,
    /// Where the divider is: 0 at the left, 1 at the right.
    pub at: f32,
    /// The current picture is on the left, the compared one on the right.
    pub flipped: bool,
}

/// What is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum With {
    /// Another step of the frame, by index.
    Step(usize),
    /// The same step of another technique.
    Technique(Technique),
}

/// The frame of another technique.
#[derive(Debug, Default)]
pub struct Compared {
    asked: Option<RunRequest>,
    known: Option<(RunRequest, Result<Arc<Capture>, String>)>,
}

impl Compared {
    /// Nothing is known any longer.
    pub fn forget(&mut self) {
        *self = Compared::default();
    }

    /// The answer to `request`; one that was not asked last is dropped.
    pub fn answer(&mut self, request: &RunRequest, result: Result<Arc<Capture>, String>) {
        if self.asked.take_if(|asked| asked == request).is_some() {
            self.known = Some((request.clone(), result));
        }
    }

    fn of(&self, request: &RunRequest) -> Option<&Result<Arc<Capture>, String>> {
        self.known.as_ref().filter(|(of, _)| of == request).map(|(_, result)| result)
    }
}

impl Compare {
    /// Beside step `step`: the one before it, or the one after the first.
    #[must_use]
    pub fn new(step: usize) -> Compare {
        Compare { with: With::Step(step.checked_sub(1).unwrap_or(1)), at: 0.5, flipped: false }
    }
}

impl With {
    /// In a few words.
    #[must_use]
    pub fn words(self, capture: &Capture) -> String {
        match self {
            With::Step(step) => step_words(capture, step),
            With::Technique(technique) => technique.name().to_owned(),
        }
    }
}

/// `step 2 · volumes`.
#[must_use]
pub fn step_words(capture: &Capture, step: usize) -> String {
    let name = capture.steps.get(step).map_or("", |step| step.name.as_str());
    format!("step {} · {name}", step + 1)
}

impl State {
    /// The run that captures another technique as the shown frame was.
    fn request_of(&self, technique: Technique) -> Option<RunRequest> {
        let scene = self.scene.as_ref().filter(|scene| scene.problem.is_none())?;
        let remembered = scene.choices.get(&technique).cloned();
        let choice = remembered.unwrap_or_else(|| Choice::new(technique));
        Some(RunRequest { choice, ..scene.draft.clone() })
    }

    /// Asks for the frame of another technique where one is compared with and not known.
    pub fn ask_for_compared(&mut self, actions: &mut Vec<Action>) {
        let Some(Compare { with: With::Technique(technique), .. }) = self.modes.compare else { return };
        let Some(request) = self.request_of(technique).filter(|_| self.capture.is_some()) else { return };
        let compared = &mut self.modes.compared;
        if compared.of(&request).is_none() && compared.asked.as_ref() != Some(&request) {
            compared.asked = Some(request.clone());
            actions.push(Action::Compare(Box::new(request)));
        }
    }

    /// The picture that is compared with the shown one.
    ///
    /// # Errors
    /// There is none, in a sentence.
    pub fn shown_compared(&self, capture: &Capture, shown: &Shown) -> Result<Shown, String> {
        let compare = self.modes.compare.ok_or("Nothing is compared.")?;
        let found = match compare.with {
            With::Step(step) if step >= capture.steps.len() => {
                return Err(format!("This frame has no step {}: choose another.", step + 1));
            }
            With::Step(step) => self.view.shown(capture, step),
            With::Technique(technique) => {
                let request = self.request_of(technique).ok_or("A folder holds one technique only: choose a step.")?;
                let other = match self.modes.compared.of(&request) {
                    Some(Ok(other)) => other,
                    Some(Err(reason)) => return Err(format!("{} can't be shown: {reason}", technique.name())),
                    None => return Err(format!("Capturing {} …", technique.name())),
                };
                self.view.shown(other, same_step(capture, self.step, other))
            }
        };
        let what = format!("{} has no such picture", compare.with.words(capture));
        let found = found.filter(|found| found.kind == shown.kind && found.images.len() == shown.images.len());
        let found = found.ok_or_else(|| format!("{what}: choose another kind above."))?;
        let is_like = found.images.first().map(|image| image.size()) == shown.images.first().map(|image| image.size());
        if is_like { Ok(found) } else { Err(format!("{what} of this size.")) }
    }
}

/// How many texels differ, in a sentence.
#[must_use]
pub fn sentence(texels: Option<u64>, all: u64) -> String {
    match texels {
        None => "Pictures of different kinds: nothing to count.".to_owned(),
        Some(0) => "No texel differs.".to_owned(),
        Some(texels) => {
            let share = texels as f64 / all.max(1) as f64;
            let verb = if texels == 1 { "differs" } else { "differ" };
            // A few of many are not none.
            let share = if share < 1e-3 { percent(share) } else { format!("{:.1} %", share * 100.0) };
            format!("{} {verb}: {share}", format::counted(texels, "texel"))
        }
    }
}
