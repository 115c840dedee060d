//! What happened to one pixel: every fragment in the order of the API, and what it did.
//!
//! ```text
//! FramePlan::covering ─► gpu's fragment log ─┐
//!        FramePlan (tests, operations) ──────┼─► stencil machine ─► PixelHistory ─► story, ladder, verdict
//!        Capture (what the GPU stored) ──────┘                          └─► disagreements
//! ```
//!
//! The log shows which triangles left a fragment, how deep, and of which side. The stencil machine takes them through
//! the tests one by one, so what was before and after each is known, which no buffer stores. The result is compared
//! with the capture after every pass, bit for bit. Triangles that cover the pixel and were culled or clipped are in the
//! list too: they explain what is missing.
//!
//! Limits: depth, stencil and float counts are followed, colours are not; a pass of a shadow map has texels of its own
//! and is not part of a pixel's history.

mod check;
mod json;
mod ladder;
mod replay;
mod story;
mod verdict;
mod why;

pub use check::Disagreement;
pub use json::PixelDocument;
pub use ladder::{Ladder, Rung};
#[cfg(feature = "program")]
pub(crate) use replay::{asks, count_of, counts_in, target_of};
pub use story::operation_name;
pub use verdict::{TestedCount, Verdict, VerdictEvidence, reason};
pub use why::{CountedFaces, FaceCounts, FlattenedShadow, LightDecision, LightPassResult, VolumeCount};

use crate::capture::{Capture, FrameTarget, Snapshot};
use crate::plan::{ClipPlane, CountBits, CountedSide, DrawPart, FramePlan, Visibility};
use crate::stencil_machine::DepthStencil;
use wgpu::StencilOperation;

/// One pixel's history.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelHistory {
    /// Column and row, from the top left.
    pub pixel: [u32; 2],
    /// Does the technique use a stencil buffer?
    pub has_stencil: bool,
    /// Is greater depth nearer?
    pub is_reversed: bool,
    /// How far the depths that the events make may be from those that were stored: 0 in our own frames.
    pub depth_rounding: f32,
    /// Before the first event: zeros, or what another program's frame began with.
    pub start: PixelValues,
    /// In the order in which they happened.
    pub events: Vec<PixelEvent>,
    /// What the events leave.
    pub computed: PixelValues,
    /// What the GPU stored by the end of the frame; `None` where the capture has no picture.
    pub captured: Option<DepthStencil>,
    /// What the GPU stored after each pass of the picture.
    pub captured_after: Vec<CapturedAfter>,
    /// What the technique says of each light here, as in its mask; `None` where it has none.
    pub labels: Vec<Option<u8>>,
    /// Fragments that the GPU counted here.
    pub counted: u32,
    /// Events without a fragment that there must be: clears that the plan asks for, and triangles
    /// that geometry says were culled or clipped.
    pub without_fragment: u32,
    /// For each light whose shadow volumes the technique counts: in which bits of the stencil.
    pub counts_in: Vec<Option<CountBits>>,
    /// Where the log and geometry contradict each other.
    pub contradictions: Vec<Disagreement>,
}

/// The values that a pixel's buffers store.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelValues {
    /// The value in the depth buffer.
    pub depth: f32,
    /// Eight bits; 0 where there is no stencil buffer.
    pub stencil: u8,
    /// The count of the volumes of the pass's light, where it is stored in a float; otherwise 0.
    pub count: f32,
}

/// What the GPU stored at the pixel by the end of a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapturedAfter {
    /// Index of the pass.
    pub pass: usize,
    /// Depth and stencil; 0 where there is no stencil buffer.
    pub stored: DepthStencil,
    /// The float count of the pass's light, where this was the last pass to add to it.
    pub count: Option<f32>,
}

impl PixelValues {
    /// Depth and stencil.
    pub fn stored(self) -> DepthStencil {
        DepthStencil { depth: self.depth, stencil: self.stencil }
    }
}

/// One thing that happened.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelEvent {
    /// Index of the pass, as in the capture.
    pub pass: usize,
    /// Name of that pass.
    pub pass_name: String,
    /// The light it belongs to.
    pub light: Option<usize>,
    /// The pass is seen from the camera: depths are the picture's.
    pub is_from_camera: bool,
    /// What the pass draws into.
    pub target: FrameTarget,
    /// What happened.
    pub kind: PixelEventKind,
    /// The pixel's values before the event.
    pub before: PixelValues,
    /// The pixel's values after it.
    pub after: PixelValues,
}

/// What can happen to a pixel.
#[derive(Debug, Clone, PartialEq)]
pub enum PixelEventKind {
    /// Something other than a draw or a clear of everything has set depth and stencil before the pass, in another
    /// program's frame: a copy, a clear of a part, a draw that is not followed.
    Put,
    /// The pass begins by clearing depth.
    ClearDepth,
    /// The pass begins by clearing the stencil.
    ClearStencil,
    /// The pass begins by clearing the float count.
    ClearCount,
    /// A triangle that covers the pixel.
    Triangle(Box<TriangleEvent>),
}

/// A triangle that covers the pixel, and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleEvent {
    /// Index of the draw in its pass.
    pub draw: usize,
    /// Name of the draw.
    pub draw_name: String,
    /// Name of the object that it shows, or that casts the shadow it belongs to.
    pub caster: Option<String>,
    /// Which part of the object or of its shadow.
    pub part: DrawPart,
    /// Index among the draw's triangles in the order in which they are drawn.
    pub primitive: u32,
    /// Index in the mesh's triangle list.
    pub triangle: u32,
    /// Corners, homogeneous and relative to the origin of the pass's view.
    pub corners: [[f32; 4]; 3],
    /// The triangle's front is visible.
    pub is_front: bool,
    /// It faces into the volume that it bounds.
    pub faces_inwards: bool,
    /// Whom its shader asks how much of the light arrives, where it adds the light; of another program's surfaces nobody.
    pub lights: Option<Visibility>,
    /// The depth that the depth test sees; outside 0 to 1 where the triangle was clipped.
    pub depth: f32,
    /// What became of it.
    pub outcome: FragmentOutcome,
}

/// What became of a triangle at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FragmentOutcome {
    /// The triangle left a fragment, which went through the tests.
    Tested {
        /// The stencil test.
        stencil: TestResult,
        /// The depth test.
        depth: TestResult,
        /// The operation that ran on the stencil; `None` where the draw tests no stencil.
        operation: Option<StencilOperation>,
    },
    /// The shader discarded its fragment: on that side of the depths that are drawn, or of another program for reasons of
    /// its own.
    Discarded(Option<ClipPlane>),
    /// The draw shows only the other side of triangles.
    Culled,
    /// It lies before the near or behind the far plane.
    Clipped(ClipPlane),
}

/// How a test went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TestResult {
    /// It passed.
    Passed,
    /// It failed.
    Failed,
    /// It passed whatever the values, as its function is `Always` or it is off.
    Always,
    /// The test before it failed.
    NotReached,
}

impl TestResult {
    /// Did it let the fragment through? `None` where it was not asked.
    pub fn passed(self) -> Option<bool> {
        match self {
            TestResult::Passed | TestResult::Always => Some(true),
            TestResult::Failed => Some(false),
            TestResult::NotReached => None,
        }
    }
}

impl TriangleEvent {
    /// Is the outside of what it belongs to seen? What faces into its volume shows it from behind, and
    /// counts the other way round.
    pub fn shows_outside(&self) -> bool {
        self.is_front != self.faces_inwards
    }
}

impl FragmentOutcome {
    /// Did the fragment pass all tests, and reach the colour target?
    pub fn passed(self) -> bool {
        matches!(self, FragmentOutcome::Tested { depth, .. } if depth.passed() == Some(true))
    }
}

impl PixelEvent {
    /// The triangle, where it was one.
    pub fn triangle(&self) -> Option<&TriangleEvent> {
        match &self.kind {
            PixelEventKind::Triangle(triangle) => Some(triangle),
            _ => None,
        }
    }

    /// Returns how much it added to the count of shadow volumes, in the stencil or in a float: a step that wraps at the
    /// end of the bits that are written counts as one, and so does an inverted bit.
    pub fn counted(&self) -> i32 {
        let in_float = (self.after.count - self.before.count) as i32;
        let in_stencil = match self.operation().and_then(step_of) {
            _ if self.after.stencil == self.before.stencil => 0,
            Some(step) => step,
            None => i32::from(self.after.stencil.wrapping_sub(self.before.stencil) as i8),
        };
        in_stencil + in_float
    }

    /// What was done to the stencil, where a fragment was tested against one.
    fn operation(&self) -> Option<StencilOperation> {
        match self.triangle()?.outcome {
            FragmentOutcome::Tested { operation, .. } => operation,
            _ => None,
        }
    }

    /// Returns whether it changed a value of the pixel, or reached its colour: faces of shadow volumes have none.
    pub fn does_something(&self) -> bool {
        let has_passed = self.triangle().is_some_and(|one| one.outcome.passed());
        self.before != self.after || (has_passed && !self.is_of_volume())
    }

    /// What it was to add to the count: also where the count stopped at 0 or 255 and did not change.
    pub fn step(&self) -> i32 {
        match self.operation() {
            None => self.counted(),
            Some(operation) => step_of(operation).unwrap_or(0),
        }
    }

    /// It is a face of a shadow volume.
    pub fn is_of_volume(&self) -> bool {
        self.triangle().is_some_and(|one| one.part.is_of_volume())
    }
}

/// Returns what an operation adds to a count; one that inverts bits adds as well, and parity is what is stored of the
/// sum.
fn step_of(operation: StencilOperation) -> Option<i32> {
    use StencilOperation::{DecrementClamp, DecrementWrap, IncrementClamp, IncrementWrap, Invert};
    match operation {
        IncrementClamp | IncrementWrap | Invert => Some(1),
        DecrementClamp | DecrementWrap => Some(-1),
        _ => None,
    }
}

impl PixelHistory {
    /// What a light's count was cleared to, where it was.
    pub(crate) fn cleared_to(&self, light: usize) -> i32 {
        let clears = self.events.iter().rev().filter(|event| event.light == Some(light));
        let mut cleared = clears.filter_map(|event| match event.kind {
            PixelEventKind::ClearStencil => Some(i32::from(event.after.stencil)),
            PixelEventKind::ClearCount => Some(event.after.count as i32),
            _ => None,
        });
        cleared.next().unwrap_or(0)
    }

    /// Returns whether the events make what the GPU stored, after every pass and bit for bit, and are complete and in
    /// order. If not, it is the GPU's rounding or a bug of ours; [`PixelHistory::disagreements`] says where.
    pub fn agrees(&self) -> bool {
        self.disagreements().is_empty()
    }

    /// The triangles with their events, in order.
    pub fn triangles(&self) -> impl Iterator<Item = (&PixelEvent, &TriangleEvent)> {
        self.events.iter().filter_map(|event| Some((event, event.triangle()?)))
    }

    /// Returns the pixel's values when the light pass tested it: after the last face of the light's volumes, or where
    /// there is none, when the light's last pass began; where that pass does not draw the pixel, when its labels were
    /// drawn.
    fn tested_count(&self, light: usize) -> PixelValues {
        let of_light = || self.events.iter().filter(|event| event.light == Some(light));
        let last = of_light().rfind(|event| event.is_of_volume());
        let tests = |event: &&PixelEvent| {
            event.triangle().is_some_and(|one| one.lights.is_some() || event.target == FrameTarget::Labels)
        };
        let tested = || of_light().filter(tests).min_by_key(|event| event.target == FrameTarget::Labels);
        last.map(|event| event.after).or_else(|| tested().map(|event| event.before)).unwrap_or(self.computed)
    }

    /// Returns on which side of the visible surface a light's volume faces count here. `None` where no face here shows
    /// it: what was clipped or culled counts nowhere.
    pub fn counted_side(&self, light: usize) -> Option<CountedSide> {
        let is_behind = |event: &PixelEvent| {
            let depth = event.triangle()?.depth;
            let is_behind = if self.is_reversed { depth <= event.before.depth } else { depth >= event.before.depth };
            Some((event.step() != 0, is_behind))
        };
        let is_tested = |event: &&PixelEvent| {
            event.triangle().is_some_and(|one| matches!(one.outcome, FragmentOutcome::Tested { .. }))
        };
        let faces = self.events.iter().filter(|event| event.light == Some(light) && event.is_from_camera);
        let faces = faces.filter(is_tested);
        let seen: Vec<(bool, bool)> = faces.filter(|event| event.is_of_volume()).filter_map(is_behind).collect();
        // Where none has counted, those that lie here are on the side that does not.
        let counting = |side: bool| seen.iter().any(|(counts, is_behind)| *counts && *is_behind == side);
        match (counting(false), counting(true), seen.first()?) {
            (true, true, _) => Some(CountedSide::AsNeeded),
            (true, false, _) | (false, false, (_, true)) => Some(CountedSide::InFront),
            (false, true, _) | (false, false, (_, false)) => Some(CountedSide::Behind),
        }
    }

    /// Returns whether an event of a pass changes a value of the pixel, or reaches its colour.
    pub fn is_touched_by(&self, pass: usize) -> bool {
        self.events.iter().filter(|event| event.pass == pass).any(PixelEvent::does_something)
    }
}

/// What the GPU stored at a pixel after each pass of the picture.
fn captured_after(plan: &FramePlan, capture: &Capture, pixel: [u32; 2]) -> Vec<CapturedAfter> {
    let frame = |index: usize| match &capture.steps.get(index)?.snapshot {
        Snapshot::Frame(frame) => Some((index, frame)),
        Snapshot::Map { .. } => None,
    };
    let mut after = Vec::new();
    for (pass, frame) in (0..plan.passes.len()).filter_map(frame) {
        let stencil = frame.stencil.as_ref().and_then(|stencil| stencil.image.byte_at(pixel)).unwrap_or(0);
        let Some(depth) = frame.depth.image.depth_at(pixel) else { continue };
        let counts = |index: usize| frame_counts(plan, capture, index);
        let light =
            counts(pass).filter(|light| !(pass + 1..plan.passes.len()).any(|later| counts(later) == Some(*light)));
        let count = light.and_then(|light| capture.lights.get(light)?.count.as_ref()?.count_at(pixel));
        after.push(CapturedAfter { pass, stored: DepthStencil { depth, stencil }, count });
    }
    after
}

/// Returns the light to whose float count a pass adds.
fn frame_counts(plan: &FramePlan, capture: &Capture, pass: usize) -> Option<usize> {
    match &capture.steps.get(pass)?.snapshot {
        Snapshot::Frame(frame) if frame.target == FrameTarget::Count => plan.passes[pass].light.map(|light| light.0),
        _ => None,
    }
}
