//! The shown picture beside another one: of another step, technique or setting.

use super::Model;
use crate::ask::{CaptureOf, FaultsOf, RunRequest};
use crate::capture::{Capture, Image};
use crate::diagnosis::Cause;
use crate::numbers::percent;
use crate::plan::LightId;
use crate::reading::both_sides::{Counterpart, counterpart, same_step};
use crate::reading::format;
use crate::reading::picture_view::{PictureKind, ShownPicture, has_truth};
use crate::reading::steps;
use crate::technique::{Choice, SettingSpec, SettingValues, Technique};
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
    /// How both are shown.
    pub layout: SidesLayout,
}

named_enum! {
    /// How the two pictures of a comparison are shown, in the order of their buttons.
    #[derive(Default)]
    pub enum SidesLayout(
        /// The explanation on its button.
        explanation
    ) {
        /// In one place, with a divider between.
        #[default]
        Divider = "Divider" ("Both in one place, under a divider that is dragged"),
        /// Whole, side by side; one over the other where the panel is too narrow for that.
        Beside = "Beside" ("Both whole, side by side, with the same pixel picked in both"),
        /// Whole, one over the other.
        Stacked = "Stacked" ("Both whole, one over the other, with the same pixel picked in both"),
    }
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
    /// The same step of the frame as it was before the fix that was applied last.
    BeforeFix,
    /// The same step of the frame as it was before the last change, which Undo takes back.
    BeforeChange,
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
    /// Returns whether both pictures are shown whole, each in a place of its own.
    pub fn has_two_places(&self) -> bool {
        self.layout != SidesLayout::Divider
    }

    /// Compares step `step` with the one before it, or the first step with the second.
    pub fn new(step: usize) -> Comparison {
        Comparison {
            with: ComparedWith::Step(step.checked_sub(1).unwrap_or(1)),
            at: 0.5,
            flipped: false,
            layout: SidesLayout::Divider,
        }
    }
}

/// The frame that the compared picture is of.
#[derive(Debug, Clone)]
pub struct FrameBeside {
    /// Its capture.
    pub capture: Arc<Capture>,
    /// The scene's time in it, seconds; `None` where nothing moves.
    pub time: Option<f64>,
    /// It is of an earlier state of the scene than it is to be run in now.
    pub is_behind: bool,
}

impl ComparedWith {
    /// Returns the key of the setting that is another on the compared side; `None` where it is no single one.
    pub fn key(self) -> Option<&'static str> {
        if let ComparedWith::Setting { key, .. } = self { Some(key) } else { None }
    }

    /// Returns the value that the setting has on the compared side; of all settings together, that they are the defaults.
    pub fn value(self) -> &'static str {
        if let ComparedWith::Setting { value, .. } = self { value } else { "default" }
    }

    /// Returns whether the compared picture is of a frame that is captured besides the shown one.
    pub fn is_of_another_frame(self) -> bool {
        match self {
            ComparedWith::Technique(_)
            | ComparedWith::Setting { .. }
            | ComparedWith::Defaults
            | ComparedWith::BeforeFix
            | ComparedWith::BeforeChange => true,
            ComparedWith::Step(_) | ComparedWith::Fixed { .. } => false,
        }
    }

    /// Returns whether the comparison means something in a scene that is opened with this technique and its settings, or
    /// opened again (`is_again`): another technique or setting does, a step of the frame before only in the same scene.
    pub fn stays_for(self, choice: &Choice, is_again: bool) -> bool {
        match self {
            ComparedWith::Technique(technique) => technique != choice.technique(),
            ComparedWith::Setting { key, value } => {
                let mut other = choice.clone();
                other.set(key, value).is_ok() && other != *choice
            }
            ComparedWith::Defaults => *choice != Choice::new(choice.technique()),
            ComparedWith::Step(_) | ComparedWith::BeforeChange => is_again,
            // A scene that is opened has no fix yet.
            ComparedWith::Fixed { .. } | ComparedWith::BeforeFix => false,
        }
    }

    /// Describes the compared picture in a few words: the step's number and title, the technique's name, the setting with
    /// its value.
    pub fn words(self, capture: &Capture) -> String {
        match self {
            ComparedWith::Step(step) => step_words(capture, step),
            ComparedWith::Technique(technique) => technique.name().to_owned(),
            ComparedWith::Setting { key, value } => format!("{key} {value}"),
            ComparedWith::Defaults => "default settings".to_owned(),
            ComparedWith::BeforeFix => "before the fix".to_owned(),
            ComparedWith::BeforeChange => "before the change".to_owned(),
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

/// Numbers that a setting is compared at.
const NUMBERS: [&str; 16] =
    ["0", "0.25", "0.5", "1", "2", "4", "8", "16", "32", "64", "128", "256", "512", "1024", "2048", "4096"];

/// Returns none, and up to four numbers beside the present value of a setting, as far as they are known by name: half of it
/// and twice it, a quarter and four times.
fn numbers_beside(now: &str) -> Vec<&'static str> {
    let now: f64 = now.parse().unwrap_or(0.0);
    let value = |number: &&str| number.parse::<f64>().unwrap_or(0.0);
    let is_beside =
        |number: &f64| *number == 0.0 || (now / 4.0..=now * 4.0).contains(number) || now == 0.0 && *number <= 4.0;
    NUMBERS.into_iter().filter(|number| is_beside(&value(number)) && value(number) != now).collect()
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
            ComparedWith::BeforeFix => {
                let applied = scene.applied.as_ref().ok_or("No fix is applied: choose another side.")?;
                applied.before.clone()
            }
            ComparedWith::BeforeChange => {
                let before = self.before_last_change().ok_or("Nothing is changed: choose another side.")?;
                return Ok(RunRequest { time: scene.draft.time, ..before.clone() });
            }
            ComparedWith::Defaults | ComparedWith::Step(_) | ComparedWith::Fixed { .. } => {
                Choice::new(current.technique())
            }
        };
        Ok(RunRequest { choice, ..scene.draft.clone() })
    }

    /// Returns the default settings where the open scene is run with others, and other values of its settings, setting by
    /// setting, to compare with: first numbers, some beside the present one, then all words. Settings without an effect now
    /// are left out. Empty where no scene is open.
    pub fn settings_to_compare(&self) -> Vec<ComparedWith> {
        let Some(scene) = &self.scene else { return Vec::new() };
        let choice = &scene.draft.choice;
        let mut specs: Vec<&SettingSpec> = choice.technique().settings().iter().collect();
        specs.retain(|spec| choice.without_effect(spec.key).is_none());
        specs.sort_by_key(|spec| !matches!(spec.values, SettingValues::Integer(..) | SettingValues::Number(..)));
        let is_changed = *choice != Choice::new(choice.technique());
        let others = specs.into_iter().flat_map(|spec| {
            let now = choice.settings().get(spec.key).map_or("", String::as_str);
            let words: Vec<&'static str> = match spec.values {
                SettingValues::OneOf(words) | SettingValues::WordOrFrustum(words) => words.to_vec(),
                SettingValues::WordOr { words, .. } => words.to_vec(),
                SettingValues::Integer(..) | SettingValues::Number(..) => numbers_beside(now),
                SettingValues::SomeOf(_) | SettingValues::DepthRange | SettingValues::Receivers(_) => Vec::new(),
            };
            let is_another = move |value: &&str| *value != now && choice.clone().set(spec.key, value).is_ok();
            let others = words.into_iter().filter(is_another);
            others.map(|value| ComparedWith::Setting { key: spec.key, value })
        });
        is_changed.then_some(ComparedWith::Defaults).into_iter().chain(others).collect()
    }

    /// Returns the capture that the compared picture is of: the shown one for a step, another one for a technique or
    /// settings, which is asked for. While that is captured, the one of an earlier moment of the scene stays, if there is
    /// one in the same technique and settings ([`FrameBeside::is_behind`]).
    ///
    /// # Errors
    /// There is none, or none yet, in a sentence.
    pub fn compared_frame(&self, capture: &Arc<Capture>) -> Result<FrameBeside, String> {
        let with = self.modes.compare.ok_or("Nothing is compared.")?.with;
        if let ComparedWith::Step(_) | ComparedWith::Fixed { .. } = with {
            return Ok(FrameBeside { capture: Arc::clone(capture), time: self.frame.time, is_behind: false });
        }
        let words = with.words(capture);
        let request = Box::new(self.request_of(with)?);
        let known = self.answers.current::<CaptureOf>();
        let draws_of = match known.filter(|(of, _)| of.request == request) {
            // Its steps are known, so the one is, too, whose draws are wanted.
            Some((_, other)) if self.selection.draw.is_some() => Some(same_step(capture, self.selection.step, other)),
            Some((of, _)) => of.draws_of,
            None => None,
        };
        let is_judged = has_truth(capture);
        let reply = self.answers.want(CaptureOf { request: request.clone(), is_judged, draws_of });
        if let Some(reason) = reply.failed.filter(|_| draws_of.is_none()) {
            return Err(format!("{words} can't be shown: {reason}"));
        }
        let is_like = |of: &&CaptureOf| of.request.choice == request.choice && of.request.size == request.size;
        match (reply.ready, known.filter(|(of, _)| is_like(of))) {
            (Some(other), _) => Ok(FrameBeside { capture: other, time: self.time_of(&request), is_behind: false }),
            (None, Some((of, other))) => {
                let is_behind = of.request != request;
                Ok(FrameBeside { capture: Arc::clone(other), time: self.time_of(&of.request), is_behind })
            }
            (None, None) => Err(format!("Capturing {words} …")),
        }
    }

    /// Returns whether the compared picture is still to be captured as the scene is to be run now, and asks for it, also
    /// where it is not seen; false where nothing is compared, or it can't be.
    pub fn is_comparison_behind(&self) -> bool {
        let with = self.modes.compare.map(|compare| compare.with);
        let Some(Ok(request)) = with.filter(|with| with.is_of_another_frame()).map(|with| self.request_of(with)) else {
            return false;
        };
        let request = Box::new(request);
        let is_known = self.answers.current::<CaptureOf>().is_some_and(|(of, _)| of.request == request);
        !is_known && self.answers.want(CaptureOf { request, is_judged: false, draws_of: None }).failed.is_none()
    }

    /// Returns whether the shown frame and the one that it is compared with are both of the scene as it is to be run now.
    pub fn is_of_one_moment(&self, other: &FrameBeside) -> bool {
        !other.is_behind && !self.activity.is_waiting
    }

    fn time_of(&self, request: &RunRequest) -> Option<f64> {
        self.is_animated().then_some(request.time)
    }

    /// Returns the comparison to begin with: with the frame before a fix that is in use, or with the step before, or, for a
    /// picture of the whole frame, which no step changes, with another technique.
    pub fn first_comparison(&self) -> Comparison {
        if self.fix_in_use().is_some() {
            return self.other_technique();
        }
        let shown = self.frame.capture.as_ref().and_then(|capture| self.shown(capture));
        match shown {
            Some(shown) if !shown.kind.has_phases() && shown.kind != PictureKind::Overdraw => self.other_technique(),
            _ => self.with_step_before(),
        }
    }

    /// Returns the comparison with the last step before that is part of the frame, as a mask beside it changes nothing.
    fn with_step_before(&self) -> Comparison {
        let compare = Comparison::new(self.selection.step);
        let is_part =
            |step: &usize| self.frame.capture.as_ref().is_some_and(|capture| !steps::is_beside(capture, *step));
        match (0..self.selection.step).rev().find(is_part) {
            Some(step) => Comparison { with: ComparedWith::Step(step), ..compare },
            None => compare,
        }
    }

    /// Returns the comparison with the frame before a fix that is in use, else with another technique; with another step where
    /// no scene is open.
    pub fn other_technique(&self) -> Comparison {
        let compare = Comparison::new(self.selection.step);
        if self.fix_in_use().is_some() {
            return Comparison { with: ComparedWith::BeforeFix, ..compare };
        }
        let Some(scene) = &self.scene else { return compare };
        // `auto` counts as z-fail does: both pictures would be the same.
        let is_right = matches!(scene.draft.choice.technique(), Technique::ZFail | Technique::Auto);
        let other = if is_right { Technique::ShadowMap } else { Technique::ZFail };
        Comparison { with: ComparedWith::Technique(other), ..compare }
    }

    /// Returns the point of `other`, the capture that the shown one is compared with, whose picture is compared, and what
    /// it lacks to be the same moment.
    pub fn compared_point(&self, capture: &Capture, other: &Capture) -> Counterpart {
        let same = |point| Counterpart { point, lacks: None };
        match self.modes.compare.map(|compare| compare.with) {
            Some(ComparedWith::Step(step)) => same(step.into()),
            None | Some(ComparedWith::Fixed { .. }) => same(self.shown_point()),
            Some(_) => counterpart(capture, self.shown_point(), other),
        }
    }

    /// Returns the picture that the shown one is compared with: of another step, or of the same step of another
    /// technique or other settings, whose capture is asked for. It has the kind, number and size of images of `shown`, or,
    /// where the compared side has no such picture, is its colour in the same size ([`Model::lacks_kind`]).
    ///
    /// # Errors
    /// There is none, in a sentence.
    pub fn shown_compared(&self, capture: &Arc<Capture>, shown: &ShownPicture) -> Result<ShownPicture, String> {
        let compare = self.modes.compare.ok_or("Nothing is compared.")?;
        let found = match compare.with {
            ComparedWith::Step(step) if step >= capture.steps.len() => {
                return Err(format!("This frame has no step {}: choose another.", step + 1));
            }
            ComparedWith::Step(step) => {
                let as_color = || self.view.shown_as(capture, step.into(), PictureKind::Color);
                self.view.shown_as(capture, step.into(), shown.kind).or_else(as_color)
            }
            ComparedWith::Technique(_)
            | ComparedWith::Setting { .. }
            | ComparedWith::Defaults
            | ComparedWith::BeforeFix
            | ComparedWith::BeforeChange => {
                let other = self.compared_frame(capture)?.capture;
                if shown.kind.needs_truth() && !has_truth(&other) {
                    return Err(format!("Holding {} against the truth …", compare.with.words(capture)));
                }
                let at = self.compared_point(capture, &other).point;
                let as_color = || self.view.shown_as(&other, at, PictureKind::Color);
                self.view.shown_as(&other, at, shown.kind).or_else(as_color)
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
        let words = compare.with.words(capture);
        let what = kind_in_words(shown.kind, capture);
        let is_like = |found: &ShownPicture| {
            let size = |shown: &ShownPicture| shown.images.first().map(|image| image.size());
            (found.images.len(), size(found)) == (shown.images.len(), size(shown))
        };
        match found {
            Some(found) if is_like(&found) => Ok(found),
            Some(found) if found.kind == shown.kind => Err(format!("The {what} of {words} has another size.")),
            _ => Err(format!("{words} has no {what}: choose another kind of picture above.")),
        }
    }

    /// Returns, where the compared side has no picture of the shown kind and shows its colour in place of it, what it
    /// lacks, in a few words.
    pub fn lacks_kind(&self, capture: &Capture, shown: &ShownPicture, compared: &ShownPicture) -> Option<String> {
        let lacks = compared.kind != shown.kind;
        lacks.then(|| format!("no {}: its colour", kind_in_words(shown.kind, capture)))
    }

    /// Returns both pictures of the comparison, first the compared one, where they are of one kind, size and moment, so that
    /// their values can be held against each other.
    ///
    /// # Errors
    /// They can't, or not yet: why, in a sentence.
    pub fn pair_to_compare(&self, capture: &Arc<Capture>, shown: &ShownPicture) -> Result<[Arc<Image>; 2], String> {
        if self.frame.is_preview {
            return Err(ONCE_WHOLE.to_owned());
        }
        let other = self.shown_compared(capture, shown)?;
        if !self.is_of_one_moment(&self.compared_frame(capture)?) {
            return Err("counted once both are of one moment".to_owned());
        }
        if other.kind != shown.kind || other.images[0].format() != shown.images[0].format() {
            return Err("Pictures of different kinds: nothing to count.".to_owned());
        }
        Ok([other.images[0].clone(), shown.images[0].clone()])
    }

    /// Returns whether of a comparison one picture is shown, by how much counts or depths of its sides differ, and not its two
    /// sides.
    pub fn subtracts(&self, capture: &Arc<Capture>, shown: &ShownPicture) -> bool {
        let has_numbers = shown.kind.has_phases() && shown.kind != PictureKind::Color;
        self.modes.shows_difference() && has_numbers && self.pair_to_compare(capture, shown).is_ok()
    }

    /// Returns the comparison with the compared frame and its picture, where both sides show one moment of the scene;
    /// `None` where nothing is compared, or the compared picture can't be shown or not yet.
    pub fn both_compared(
        &self,
        capture: &Arc<Capture>,
        shown: &ShownPicture,
    ) -> Option<(Comparison, FrameBeside, ShownPicture)> {
        let other = self.compared_frame(capture).ok().filter(|other| self.is_of_one_moment(other))?;
        Some((self.modes.compare?, other, self.shown_compared(capture, shown).ok()?))
    }

    /// Returns both sides of a comparison of two frames, from left to right as they are shown: the shown capture and the
    /// one that it is compared with, and how both are run. `None` where nothing is compared, the compared side is of the
    /// same frame or of the scene as it was before a change, or its frame is not known for this moment.
    pub fn both_frames(&self) -> Option<([Arc<Capture>; 2], [RunRequest; 2])> {
        let compare = self.modes.compare.filter(|compare| compare.with.is_of_another_frame())?;
        if !self.compares_one_scene() {
            return None;
        }
        let capture = self.frame.capture.as_ref().filter(|_| !self.frame.is_preview)?;
        let other = self.compared_frame(capture).ok().filter(|other| self.is_of_one_moment(other))?.capture;
        let requests = [self.request_of(compare.with).ok()?, self.scene.as_ref()?.draft.clone()];
        let (mut frames, mut requests) = ([other, Arc::clone(capture)], requests);
        if compare.flipped {
            frames.reverse();
            requests.reverse();
        }
        Some((frames, requests))
    }

    /// Returns whether both sides of the comparison show one scene, and not what it was before a change of its lights, camera
    /// or objects.
    pub fn compares_one_scene(&self) -> bool {
        let is_before = self.modes.compare.is_some_and(|compare| compare.with == ComparedWith::BeforeChange);
        let sides = self.before_last_change().zip(self.scene.as_ref()).filter(|_| is_before);
        sides.is_none_or(|(before, scene)| {
            let draft = &scene.draft;
            RunRequest { choice: draft.choice.clone(), time: draft.time, ..before.clone() } == *draft
        })
    }

    /// Returns the mask of a light that another program's frame has without a cause, as its diagnosis has found it;
    /// `None` where no diagnosis of the shown frame has it.
    pub fn fixed_mask(&self, index: usize, cause: Cause, light: usize) -> Option<Arc<Image>> {
        let (_, diagnosis) = self.answers.current::<FaultsOf>()?;
        let found = diagnosis.causes.get(index).filter(|one| one.cause == cause && one.light == LightId(light))?;
        found.mask.clone()
    }
}

/// What is said in place of what a preview does not tell.
pub const ONCE_WHOLE: &str = "known once the frame is whole";

/// Returns what a kind of picture is called within a sentence.
fn kind_in_words(kind: PictureKind, capture: &Capture) -> String {
    kind.label(capture)[0].to_lowercase()
}

/// Returns a sentence that says how many of `all` pixels, or of a map texels, differ, and their share.
pub fn sentence(differing: u64, all: u64, kind: PictureKind) -> String {
    let unit = if kind == PictureKind::Map { "texel" } else { "pixel" };
    if differing == 0 {
        return format!("No {unit} differs.");
    }
    let share = differing as f64 / all.max(1) as f64;
    let verb = if differing == 1 { "differs" } else { "differ" };
    // A share of a few of them must not round to zero.
    let share = if share < 1e-3 { percent(share) } else { format!("{:.1} %", share * 100.0) };
    format!("{} {verb}: {share} of all", format::counted(differing, unit))
}
