//! The shown picture beside another one: of another step, technique or setting.

use super::Model;
use super::selection::same_step;
use crate::ask::{CaptureOf, FaultsOf, Reply, RunRequest};
use crate::capture::{Capture, Image};
use crate::diagnosis::Cause;
use crate::numbers::percent;
use crate::plan::LightId;
use crate::reading::capture_point::CapturePoint;
use crate::reading::format;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::reading::steps;
use crate::technique::{Choice, SettingValues, Technique};
use std::sync::Arc;

/// How far a key press moves the divider, as a share of the panel's width.
pub const NUDGE: f32 = 0.02;

/// A comparison of the shown picture with another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// The picture that is shown beside it.
    pub with: ComparedWith,
    /// Where the divider is: 0 at the left, 1 at the right.
    pub at: f32,
    /// The current picture is on the left, the compared one on the right.
    pub flipped: bool,
    /// Both are shown whole, side by side; otherwise they share a place, with a divider between.
    pub is_beside: bool,
}

/// The picture that the shown one is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparedWith {
    /// Another step of the frame, by index.
    Step(usize),
    /// The same step of another technique.
    Technique(Technique),
    /// The same step of the same technique with one setting at another value.
    Setting {
        /// The setting's key.
        key: &'static str,
        /// The value.
        value: &'static str,
    },
    /// The same step of the same technique with its default settings.
    Defaults,
    /// The mask that another program's frame has without a cause of wrong pixels, as its diagnosis has found it.
    Fixed {
        /// Which of the causes that the diagnosis has found, by index: one name may be there twice.
        index: usize,
        /// The cause that is removed.
        cause: Cause,
        /// The first cause that is removed with it, if any.
        together_with: Option<Cause>,
        /// How many more are.
        more: usize,
        /// The light.
        light: usize,
    },
}

impl Comparison {
    /// Compares step `step` with the one before it, or the first step with the second.
    pub fn new(step: usize) -> Comparison {
        Comparison {
            with: ComparedWith::Step(step.checked_sub(1).unwrap_or(1)),
            at: 0.5,
            flipped: false,
            is_beside: false,
        }
    }
}

impl ComparedWith {
    /// Describes the compared picture in a few words: the step's number and title, the technique's name, the setting with
    /// its value.
    pub fn words(self, capture: &Capture) -> String {
        match self {
            ComparedWith::Step(step) => step_words(capture, step),
            ComparedWith::Technique(technique) => technique.name().to_owned(),
            ComparedWith::Setting { key, value } => format!("{key} {value}"),
            ComparedWith::Defaults => "default settings".to_owned(),
            ComparedWith::Fixed { cause, together_with: None, .. } => format!("without {cause}"),
            ComparedWith::Fixed { cause, together_with: Some(other), more: 0, .. } => {
                format!("without {cause} and {other}")
            }
            ComparedWith::Fixed { cause, together_with: Some(other), more, .. } => {
                format!("without {cause}, {other} and {}", format::counted(more as u64, "more cause"))
            }
        }
    }
}

/// Describes a step in words: `step 2 · volumes`, or, as a mask has no number, `the mask of light 1`.
pub fn step_words(capture: &Capture, step: usize) -> String {
    match steps::number(capture, step) {
        Some(_) => format!("step {}", steps::title(capture, step)),
        None => steps::words(capture, step),
    }
}

impl Model {
    /// Returns the request that captures what is compared, with all else as in the draft: another technique in its last
    /// settings, or the same with other settings.
    ///
    /// # Errors
    /// No scene is open, its draft can't be run, or the technique has no such setting: a sentence.
    fn request_of(&self, with: ComparedWith) -> Result<RunRequest, String> {
        let scene = self.scene.as_ref().filter(|scene| scene.problem.is_none());
        let scene = scene.ok_or("A folder holds one technique only: choose a step.")?;
        let current = &scene.draft.choice;
        let choice = match with {
            ComparedWith::Technique(technique) => {
                let remembered = scene.choices.get(&technique).cloned();
                remembered.unwrap_or_else(|| Choice::new(technique))
            }
            ComparedWith::Setting { key, value } => {
                let mut choice = current.clone();
                choice.set(key, value).map_err(|error| format!("{error}."))?;
                choice
            }
            ComparedWith::Defaults | ComparedWith::Step(_) | ComparedWith::Fixed { .. } => {
                Choice::new(current.technique())
            }
        };
        Ok(RunRequest { choice, ..scene.draft.clone() })
    }

    /// Returns the other values of the settings that have words for values, and the default settings where the open scene
    /// is run with others, to compare with. Empty where no scene is open.
    pub fn settings_to_compare(&self) -> Vec<ComparedWith> {
        let Some(scene) = &self.scene else { return Vec::new() };
        let choice = &scene.draft.choice;
        let specs = choice.technique().settings();
        let is_changed = *choice != Choice::new(choice.technique());
        let others = specs.iter().flat_map(|spec| {
            let now = choice.settings().get(spec.key);
            let words: &[&str] = if let SettingValues::OneOf(words) = spec.values { words } else { &[] };
            let others = words.iter().filter(move |word| now.is_none_or(|now| now != *word));
            others.map(|value| ComparedWith::Setting { key: spec.key, value })
        });
        is_changed.then_some(ComparedWith::Defaults).into_iter().chain(others).collect()
    }

    /// Returns the capture that the compared picture is of: the shown one for a step, another one for a technique or
    /// settings, which is asked for.
    ///
    /// # Errors
    /// There is none, or none yet, in a sentence.
    pub fn compared_capture(&self, capture: &Arc<Capture>) -> Result<Arc<Capture>, String> {
        let with = self.modes.compare.ok_or("Nothing is compared.")?.with;
        if let ComparedWith::Step(_) | ComparedWith::Fixed { .. } = with {
            return Ok(Arc::clone(capture));
        }
        let words = with.words(capture);
        match self.answers.want(CaptureOf { request: Box::new(self.request_of(with)?) }) {
            Reply { ready: Some(other), .. } => Ok(other),
            Reply { failed: Some(reason), .. } => Err(format!("{words} can't be shown: {reason}")),
            _ => Err(format!("Capturing {words} …")),
        }
    }

    /// Returns the comparison to begin with: with the step before, or, for a picture of the whole frame, which no step
    /// changes, with another technique.
    pub fn first_comparison(&self) -> Comparison {
        let shown = self.frame.capture.as_ref().and_then(|capture| self.shown(capture));
        match shown {
            Some(shown) if !shown.kind.has_phases() && shown.kind != PictureKind::Overdraw => self.other_technique(),
            _ => Comparison::new(self.selection.step),
        }
    }

    /// Returns the comparison with another technique; with another step where no scene is open.
    pub fn other_technique(&self) -> Comparison {
        let compare = Comparison::new(self.selection.step);
        let Some(scene) = &self.scene else { return compare };
        let is_fail = scene.draft.choice.technique() == Technique::ZFail;
        let other = if is_fail { Technique::ShadowMap } else { Technique::ZFail };
        Comparison { with: ComparedWith::Technique(other), ..compare }
    }

    /// Returns the point of `other`, the capture that the shown one is compared with, whose picture is compared.
    pub fn compared_point(&self, capture: &Capture, other: &Capture) -> CapturePoint {
        match self.modes.compare.map(|compare| compare.with) {
            Some(ComparedWith::Step(step)) => step.into(),
            None | Some(ComparedWith::Fixed { .. }) => self.shown_point(),
            Some(_) => same_step(capture, self.selection.step, other).into(),
        }
    }

    /// Returns the picture that the shown one is compared with: of another step, or of the same step of another
    /// technique or other settings, whose capture is asked for. It has the kind, number and size of images of `shown`.
    ///
    /// # Errors
    /// There is none, in a sentence.
    pub fn shown_compared(&self, capture: &Arc<Capture>, shown: &ShownPicture) -> Result<ShownPicture, String> {
        let compare = self.modes.compare.ok_or("Nothing is compared.")?;
        let found = match compare.with {
            ComparedWith::Step(step) if step >= capture.steps.len() => {
                return Err(format!("This frame has no step {}: choose another.", step + 1));
            }
            ComparedWith::Step(step) => self.view.shown_as(capture, step.into(), shown.kind),
            ComparedWith::Technique(_) | ComparedWith::Setting { .. } | ComparedWith::Defaults => {
                let other = self.compared_capture(capture)?;
                self.view.shown_as(&other, self.compared_point(capture, &other), shown.kind)
            }
            ComparedWith::Fixed { index, cause, light, .. } => {
                let mask = self.fixed_mask(index, cause, light).ok_or("It is not known any more: diagnose again.")?;
                if self.view.light_with(capture, |light| light.shadow.is_some()) != Some(light) {
                    return Err(format!("It is known of {} alone: choose that above.", format::light(light)));
                }
                let title = format!("{} {}", shown.title, compare.with.words(capture));
                let is_mask = shown.kind == PictureKind::Mask;
                is_mask.then(|| ShownPicture { images: vec![mask], title, ..shown.clone() })
            }
        };
        let what = format!("{} has no such picture", compare.with.words(capture));
        let found = found.filter(|found| found.kind == shown.kind && found.images.len() == shown.images.len());
        let found = found.ok_or_else(|| format!("{what}: choose another kind above."))?;
        let is_like = found.images.first().map(|image| image.size()) == shown.images.first().map(|image| image.size());
        if is_like { Ok(found) } else { Err(format!("{what} of this size.")) }
    }

    /// Returns the mask of a light that another program's frame has without a cause, as its diagnosis has found it;
    /// `None` where no diagnosis of the shown frame has it.
    pub fn fixed_mask(&self, index: usize, cause: Cause, light: usize) -> Option<Arc<Image>> {
        let (_, diagnosis) = self.answers.current::<FaultsOf>()?;
        let found = diagnosis.causes.get(index).filter(|one| one.cause == cause && one.light == LightId(light))?;
        found.mask.clone()
    }
}

/// Returns a sentence that says how many of `all` texels differ, and their share; `None` for pictures of different
/// kinds, which can't be counted.
pub fn sentence(texels: Option<u64>, all: u64) -> String {
    match texels {
        None => "Pictures of different kinds: nothing to count.".to_owned(),
        Some(0) => "No texel differs.".to_owned(),
        Some(texels) => {
            let share = texels as f64 / all.max(1) as f64;
            let verb = if texels == 1 { "differs" } else { "differ" };
            // A share of a few texels must not round to zero.
            let share = if share < 1e-3 { percent(share) } else { format!("{:.1} %", share * 100.0) };
            format!("{} {verb}: {share}", format::counted(texels, "texel"))
        }
    }
}
