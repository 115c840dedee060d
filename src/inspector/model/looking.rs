//! How the picture is looked at: before or after a step, what the step changed, one bit of it, and what is drawn over it.

use super::Model;
use super::comparing::Comparison;
use crate::ask::{ChannelOf, Reply, TestsOf};
use crate::capture::{Capture, CapturedLight, Image};
use crate::inspector::action::Overlay;
use crate::inspector::look::coloring::{ColorMapping, Coloring};
use crate::inspector::look::texture::PictureCache;
use crate::plan::LightChannel;
use crate::reading::capture_point::CapturePoint;
use crate::reading::counts;
use crate::reading::outcomes::TestOutcomes;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use std::collections::BTreeSet;
use std::sync::Arc;

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
        /// What it changed; of a comparison, where its two sides differ.
        Diff = "Diff" ("What the selected step or draw changed, or, while comparing, where the two sides differ (D)"),
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

/// How the picture is looked at: phase, bit, comparison and overlays.
#[derive(Debug, Default)]
pub struct ViewModes {
    /// Whether the state before, the state after, or the change is shown.
    pub phase: StepPhase,
    /// The one bit of the stencil that is shown; `None`: all bits.
    pub bit: Option<u8>,
    /// The comparison; `None` while nothing is compared.
    pub compare: Option<Comparison>,
    /// The one channel of the light that the colour picture shows; `None`: all together.
    pub channel: Option<LightChannel>,
    /// The overlays that are drawn over the picture.
    pub overlays: BTreeSet<Overlay>,
    /// A picture that is exported with overlays has no legend.
    pub exports_no_legend: bool,
}

impl ViewModes {
    /// Returns whether what the step changed is shown, in place of what it left.
    pub fn shows_change(&self) -> bool {
        self.phase == StepPhase::Diff && self.compare.is_none()
    }

    /// Returns whether of a comparison only that is shown in which its two sides differ.
    pub fn shows_difference(&self) -> bool {
        self.phase == StepPhase::Diff && self.compare.is_some()
    }
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
        let now = self.view.shown(capture, self.shown_point()).map(|shown| self.in_channel(shown));
        match self.modes.phase {
            StepPhase::Before => match now {
                Some(now) if !now.kind.has_phases() => Some(now),
                _ => self.shown_before(capture).ok(),
            },
            StepPhase::After | StepPhase::Diff => now,
        }
    }

    /// Returns the channel of the light that is chosen and can be shown: of the colour after a step, which is not compared,
    /// of a frame of our own. `None` where all are shown together.
    pub fn channel(&self) -> Option<LightChannel> {
        let is_alone = self.modes.phase == StepPhase::After && self.modes.compare.is_none();
        self.modes.channel.filter(|_| is_alone && self.scene.is_some() && self.kind() == Some(PictureKind::Color))
    }

    /// Asks for the frame with the chosen channel alone; an empty reply, and nothing is asked, where all are shown together.
    pub fn want_channel(&self) -> Reply<Capture> {
        self.channel().map_or_else(Reply::default, |channel| self.answers.want(ChannelOf { channel }))
    }

    /// Returns the picture in the chosen channel of the light, as soon as that is known, or as it is.
    fn in_channel(&self, shown: ShownPicture) -> ShownPicture {
        let Some(channel) = self.channel() else { return shown };
        let Some(capture) = self.answers.of(ChannelOf { channel }).ready else { return shown };
        let found = self.view.shown_as(&capture, self.shown_point().step.into(), PictureKind::Color);
        let title = format!("{} light of the {}", channel.name(), shown.title);
        found.map(|found| ShownPicture { title, ..found }).unwrap_or(shown)
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
        let needs_it = self.modes.phase == StepPhase::Before || self.modes.shows_change();
        needs_it && self.frame.capture.as_ref().is_some_and(|capture| lacks(capture))
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
