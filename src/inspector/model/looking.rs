//! How the picture is looked at: before or after a step, what the step changed, beside another picture, one bit of it,
//! and what is drawn over it.

use super::Model;
use super::selection::same_step;
use crate::ask::{CaptureOf, FaultsOf, Reply, RunRequest, TestsOf};
use crate::capture::{Capture, CapturedLight, Image};
use crate::diagnosis::Cause;
use crate::inspector::action::Overlay;
use crate::inspector::look::coloring::{ColorMapping, Coloring};
use crate::inspector::look::texture::PictureCache;
use crate::numbers::percent;
use crate::plan::LightId;
use crate::reading::capture_point::CapturePoint;
use crate::reading::counts;
use crate::reading::format;
use crate::reading::outcomes::TestOutcomes;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::reading::steps;
use crate::technique::{Choice, Technique};
use std::collections::BTreeSet;
use std::sync::Arc;

/// How far a key press moves the divider, as a share of the panel's width.
pub const NUDGE: f32 = 0.02;

named_enum! {
    /// Which side of the selected step or draw is shown, in the order of their buttons.
    #[derive(Default)]
    pub enum StepPhase(
        /// The explanation on its button.
        explanation
    ) {
        /// The state before it.
        Before = "Before" ("As it was before the selected step or draw (B goes there and back)"),
        /// The state after it.
        #[default]
        After = "After" ("As the selected step or draw left it"),
        /// What it changed.
        Diff = "Diff" ("What the selected step or draw changed (D)"),
    }
}

/// Why there is no state before the selected one to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoStepBefore {
    /// It is the first step.
    First,
    /// The state after the previous draw is being captured, or can't be captured.
    NotKnown,
}

impl NoStepBefore {
    /// Returns the reason in a sentence, with what to do.
    pub fn sentence(self) -> &'static str {
        match self {
            NoStepBefore::First => {
                "Nothing comes before the first step: its buffers start cleared. Select a later one."
            }
            NoStepBefore::NotKnown => {
                "The state before this draw is not known yet; a folder has it where it was captured with --every draw."
            }
        }
    }
}

/// A comparison of the shown picture with another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// The picture that is shown beside it.
    pub with: ComparedWith,
    /// Where the divider is: 0 at the left, 1 at the right.
    pub at: f32,
    /// The current picture is on the left, the compared one on the right.
    pub flipped: bool,
}

/// The picture that the shown one is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparedWith {
    /// Another step of the frame, by index.
    Step(usize),
    /// The same step of another technique.
    Technique(Technique),
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
        Comparison { with: ComparedWith::Step(step.checked_sub(1).unwrap_or(1)), at: 0.5, flipped: false }
    }
}

impl ComparedWith {
    /// Describes the compared picture in a few words: the step's number and title, or the technique's name.
    pub fn words(self, capture: &Capture) -> String {
        match self {
            ComparedWith::Step(step) => step_words(capture, step),
            ComparedWith::Technique(technique) => technique.name().to_owned(),
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

/// How the picture is looked at: phase, bit, comparison and overlays.
#[derive(Debug, Default)]
pub struct ViewModes {
    /// Whether the state before, the state after, or the change is shown.
    pub phase: StepPhase,
    /// The one bit of the stencil that is shown; `None`: all bits.
    pub bit: Option<u8>,
    /// The comparison; `None` while nothing is compared.
    pub compare: Option<Comparison>,
    /// The overlays that are drawn over the picture.
    pub overlays: BTreeSet<Overlay>,
}

/// Returns whether this kind of picture has a state before and after each step: colour, stencil and depth do.
pub fn has_phases(kind: PictureKind) -> bool {
    matches!(kind, PictureKind::Color | PictureKind::Stencil | PictureKind::Depth)
}

/// Returns the point of the frame before this one: the draw before it in the same step, otherwise (for a step or its
/// first draw) the step before as a whole.
///
/// # Errors
/// There is none, or its state is not known.
pub fn before(capture: &Capture, at: CapturePoint) -> Result<CapturePoint, NoStepBefore> {
    match at.draw.and_then(|draw| draw.checked_sub(1)) {
        Some(draw) => {
            let before = CapturePoint { draw: Some(draw), ..at };
            if before.is_known(capture) { Ok(before) } else { Err(NoStepBefore::NotKnown) }
        }
        None => at.step.checked_sub(1).map(CapturePoint::from).ok_or(NoStepBefore::First),
    }
}

impl Model {
    /// Returns the picture that is shown: of the shown point of the frame, or, in the mode for the state before, of the
    /// one before it, unless its kind has no phases. `None` where there is no such picture, or no state before.
    pub fn shown(&self, capture: &Capture) -> Option<ShownPicture> {
        let now = self.view.shown(capture, self.shown_point());
        match self.modes.phase {
            StepPhase::Before => match now {
                Some(now) if !has_phases(now.kind) => Some(now),
                _ => self.shown_before(capture).ok(),
            },
            StepPhase::After | StepPhase::Diff => now,
        }
    }

    /// Returns the picture of the same kind at the point before the shown one, with a title that says so.
    ///
    /// # Errors
    /// There is nothing before it, or it is not known.
    pub fn shown_before(&self, capture: &Capture) -> Result<ShownPicture, NoStepBefore> {
        let at = self.shown_point();
        let before = before(capture, at)?;
        let kind = self.view.kind_at(capture, at).ok_or(NoStepBefore::First)?;
        let mut shown = self.view.shown_as(capture, before, kind).ok_or(NoStepBefore::First)?;
        let of = shown.title.split(" after ").next().unwrap_or_default().to_owned();
        shown.title = format!("{of} before {}", at.words(capture));
        Ok(shown)
    }

    /// Does something that is shown need the state before the selected draw, while that is not known?
    pub fn lacks_draw_before(&self) -> bool {
        let lacks = |capture: &Capture| before(capture, self.selected()) == Err(NoStepBefore::NotKnown);
        self.modes.phase != StepPhase::After && self.frame.capture.as_ref().is_some_and(|capture| lacks(capture))
    }

    /// Returns the request that captures the open scene with another technique, in its last settings, and all else as
    /// in the draft; `None` where no scene is open, or its draft can't be run.
    fn request_of(&self, technique: Technique) -> Option<RunRequest> {
        let scene = self.scene.as_ref().filter(|scene| scene.problem.is_none())?;
        let remembered = scene.choices.get(&technique).cloned();
        let choice = remembered.unwrap_or_else(|| Choice::new(technique));
        Some(RunRequest { choice, ..scene.draft.clone() })
    }

    /// Returns the comparison to begin with: with the step before, or, for a picture of the whole frame, which no step
    /// changes, with another technique.
    pub fn first_comparison(&self) -> Comparison {
        let compare = Comparison::new(self.selection.step);
        let shown = self.frame.capture.as_ref().and_then(|capture| self.shown(capture));
        match (&self.scene, shown) {
            (Some(scene), Some(shown)) if !has_phases(shown.kind) && shown.kind != PictureKind::Overdraw => {
                let is_fail = scene.draft.choice.technique() == Technique::ZFail;
                let other = if is_fail { Technique::ShadowMap } else { Technique::ZFail };
                Comparison { with: ComparedWith::Technique(other), ..compare }
            }
            _ => compare,
        }
    }

    /// Returns the picture that the shown one is compared with: of another step, or of the same step of another
    /// technique, whose capture is asked for. It has the kind, number and size of images of `shown`.
    ///
    /// # Errors
    /// There is none, in a sentence.
    pub fn shown_compared(&self, capture: &Capture, shown: &ShownPicture) -> Result<ShownPicture, String> {
        let compare = self.modes.compare.ok_or("Nothing is compared.")?;
        let found = match compare.with {
            ComparedWith::Step(step) if step >= capture.steps.len() => {
                return Err(format!("This frame has no step {}: choose another.", step + 1));
            }
            ComparedWith::Step(step) => self.view.shown_as(capture, step.into(), shown.kind),
            ComparedWith::Technique(technique) => {
                let request = self.request_of(technique).ok_or("A folder holds one technique only: choose a step.")?;
                match self.answers.want(CaptureOf { request: Box::new(request) }) {
                    Reply { ready: Some(other), .. } => {
                        let step = same_step(capture, self.selection.step, &other);
                        self.view.shown_as(&other, step.into(), shown.kind)
                    }
                    Reply { failed: Some(reason), .. } => {
                        return Err(format!("{} can't be shown: {reason}", technique.name()));
                    }
                    _ => return Err(format!("Capturing {} …", technique.name())),
                }
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

    /// Asks for the results of the tests on the fragments of the selected step or draw.
    pub fn want_tests(&self) -> Reply<TestOutcomes> {
        let CapturePoint { step, draw } = self.selected();
        self.answers.want(TestsOf { step, draw })
    }

    /// Asks for the results of the tests on the selected step's or draw's fragments where the chosen kind of picture is
    /// overdraw; `None`, and nothing is asked, for other kinds.
    pub fn want_tests_shown(&self) -> Option<Reply<TestOutcomes>> {
        (self.view.kind == Some(PictureKind::Overdraw)).then(|| self.want_tests())
    }

    /// Returns the index of the light whose float counts are shown, and these counts: where a picture of counts is
    /// shown, that light's, else those known after the shown step. `None` where there are none.
    pub fn counts_to_show<'a>(&self, capture: &'a Capture) -> Option<(usize, &'a Arc<Image>)> {
        let at = self.shown_point();
        if self.view.shown(capture, at).is_some_and(|shown| shown.kind == PictureKind::Count) {
            let light = self.view.light_with(capture, |light: &CapturedLight| light.count.is_some())?;
            let drawn = at.count(capture).filter(|(of, _)| *of == light);
            return drawn.or_else(|| Some((light, capture.lights.get(light)?.count.as_ref()?)));
        }
        at.count(capture).or_else(|| counts::known_after(capture, at.step))
    }
}

impl Model {
    /// Returns the colouring of `shown`, with the range of depths that the user set or that its images have; where one
    /// bit is chosen, a stencil picture shows that bit.
    pub fn shown_coloring(&mut self, shown: &ShownPicture) -> ColorMapping {
        let range = self.shown_range(shown);
        let coloring = match (Coloring::of_shown(shown, range), self.modes.bit) {
            (Coloring::Stencil, Some(bit)) => Coloring::Bit(bit),
            (coloring, _) => coloring,
        };
        ColorMapping { coloring, range }
    }

    /// Returns the grey ramp's ends: as set by the user, or those of all shown pictures.
    fn shown_range(&mut self, shown: &ShownPicture) -> [f64; 2] {
        self.view.depth_range.unwrap_or_else(|| self.full_range(shown))
    }

    /// Returns the smallest and largest depth of all shown pictures; `[0, 1]` where there is none.
    pub fn full_range(&mut self, shown: &ShownPicture) -> [f64; 2] {
        full_range(&mut self.textures, shown)
    }
}

/// Returns the smallest and largest finite depth of all images of `shown`; `[0, 1]` where it is not a picture of
/// depths, or has none.
pub fn full_range(textures: &mut PictureCache, shown: &ShownPicture) -> [f64; 2] {
    if !matches!(Coloring::of_shown(shown, [0.0, 1.0]), Coloring::Depth(_)) {
        return [0.0, 1.0];
    }
    let ranges = shown.images.iter().filter_map(|image| textures.depth_range(image, shown.measure));
    ranges.reduce(|[low, high], [l, h]| [low.min(l), high.max(h)]).unwrap_or([0.0, 1.0])
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
