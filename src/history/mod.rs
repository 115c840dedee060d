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
pub use story::operation_name;
pub use verdict::{TestedCount, Verdict, VerdictEvidence, reason};
pub use why::{CountedFaces, FaceCounts, FlattenedShadow, LightDecision, LightPassResult, VolumeCount};

use crate::capture::{Capture, FrameTarget, Snapshot};
use crate::plan::{ClipPlane, CountBits, CountedSide, DrawPart, FramePlan, Visibility};
use crate::stencil_machine::DepthStencil;
use wgpu_types::StencilOperation;

/// Everything that happened to one pixel in a frame: clears, and each triangle that covers it, with its tests.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelHistory {
    /// Column and row, from the top left.
    pub pixel: [u32; 2],
    /// Whether the frame has a stencil buffer.
    pub has_stencil: bool,
    /// Whether greater depth is nearer.
    pub is_reversed: bool,
    /// How far computed depths may be from stored ones without counting as a contradiction: 0 in our own
    /// frames where the GPU has made the fragments.
    pub depth_rounding: f32,
    /// The values before the first event: zeros, or what another program's frame began with.
    pub start: PixelValues,
    /// The events in the order in which they happened.
    pub events: Vec<PixelEvent>,
    /// The values after the last event.
    pub computed: PixelValues,
    /// The values that the GPU stored by the end of the frame; `None` where the capture has no picture.
    pub captured: Option<DepthStencil>,
    /// The values that the GPU stored after each pass of the picture.
    pub captured_after: Vec<CapturedAfter>,
    /// For each light, the label byte that the technique's mask stores at this pixel; `None` where it has no mask.
    pub labels: Vec<Option<u8>>,
    /// Number of fragments that the GPU counted at this pixel.
    pub counted: u32,
    /// Number of events without a fragment that there must be: clears that the plan contains, and triangles that
    /// geometry says were culled or clipped.
    pub without_fragment: u32,
    /// For each light, the stencil bits in which its shadow volumes are counted; `None` where none are drawn.
    pub counts_in: Vec<Option<CountBits>>,
    /// For each light, whether a pass of another program takes it away where the stencil test passes, instead of adding it.
    pub darkens: Vec<bool>,
    /// For each light whether its passes replace colours where the stencil lets them, as those of other programs do that draw
    /// what is lit and what is in shadow one after the other.
    pub replaces: Vec<bool>,
    /// For each light, whether it sends out nothing: it is off, or black.
    pub is_off: Vec<bool>,
    /// Contradictions between the GPU's log of fragments and geometry.
    pub contradictions: Vec<Disagreement>,
}

/// The values that the depth, stencil and count buffers store at one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelValues {
    /// The value in the depth buffer.
    pub depth: f32,
    /// Eight bits; 0 where there is no stencil buffer.
    pub stencil: u8,
    /// The count of the volumes of the pass's light, where it is stored in a float; otherwise 0.
    pub count: f32,
}

/// The values that the GPU stored at the pixel by the end of a pass.
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
    /// Returns depth and stencil, without the float count.
    pub fn stored(self) -> DepthStencil {
        DepthStencil { depth: self.depth, stencil: self.stencil }
    }
}

/// One event of a pixel's history: a clear, or a triangle that covers it.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelEvent {
    /// Index of the pass, as in the capture.
    pub pass: usize,
    /// Name of that pass.
    pub pass_name: String,
    /// Index of the light that the pass belongs to; `None` for the scene's own passes.
    pub light: Option<usize>,
    /// Whether the pass is seen from the camera, so that depths are the picture's.
    pub is_from_camera: bool,
    /// What the pass draws into.
    pub target: FrameTarget,
    /// The clear or the triangle.
    pub kind: PixelEventKind,
    /// The pixel's values before the event.
    pub before: PixelValues,
    /// The pixel's values after it.
    pub after: PixelValues,
}

/// The kinds of events in a pixel's history.
#[derive(Debug, Clone, PartialEq)]
pub enum PixelEventKind {
    /// In another program's frame, something other than a draw or a full clear has set depth and stencil before the
    /// pass: a copy, a clear of a part, or a draw that is not replayed.
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

/// A triangle that covers the pixel, with the outcome of its tests.
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
    /// The index that this triangle of a surface has in its object's mesh, of which the drawn one may have only some;
    /// `triangle` for what is no object's own.
    pub source_triangle: u32,
    /// Index of what the rasteriser is given, the triangle itself or a piece of it, in the triangle list of its mesh;
    /// `None` for a triangle of which it is given nothing here, as it is cut off at an end of depth.
    pub piece: Option<u32>,
    /// Corners, homogeneous and relative to the origin of the pass's view.
    pub corners: [[f32; 4]; 3],
    /// Whether the triangle's front is seen.
    pub is_front: bool,
    /// Whether its front faces into the volume that it bounds.
    pub faces_inwards: bool,
    /// For a draw that adds light, what its shader reads to find how much arrives; `None` for other draws.
    pub lights: Option<Visibility>,
    /// The depth that the depth test sees; outside 0 to 1 where the triangle was clipped.
    pub depth: f32,
    /// Whether it left a fragment, and the results of its tests.
    pub outcome: FragmentOutcome,
    /// True where the shader of another program may have discarded the fragment, which is taken to be there.
    pub may_discard: bool,
}

/// Whether a triangle left a fragment at the pixel, and how the tests went.
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
    /// The shader discarded its fragment: beyond this plane, or with `None` for reasons of another program's shader.
    Discarded(Option<ClipPlane>),
    /// The draw culls the side of the triangle that is seen.
    Culled,
    /// It was clipped at this plane.
    Clipped(ClipPlane),
}

/// The result of a depth or stencil test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TestResult {
    /// It passed.
    Passed,
    /// It failed.
    Failed,
    /// It passed whatever the values, as the test is off or its function is `Always`.
    Always,
    /// It was not done, as the test before it failed.
    NotReached,
}

impl TestResult {
    /// Returns whether the test let the fragment through (also where it is off or always passes); `None` where it was
    /// not done.
    pub fn passed(self) -> Option<bool> {
        match self {
            TestResult::Passed | TestResult::Always => Some(true),
            TestResult::Failed => Some(false),
            TestResult::NotReached => None,
        }
    }
}

impl TriangleEvent {
    /// Returns whether the outside of the volume or surface that the triangle belongs to is seen. A triangle that faces
    /// into its volume shows the outside by its back, and counts the other way round.
    pub fn shows_outside(&self) -> bool {
        self.is_front != self.faces_inwards
    }
}

impl FragmentOutcome {
    /// Returns whether the fragment passed all tests and reached the colour target.
    pub fn passed(self) -> bool {
        matches!(self, FragmentOutcome::Tested { depth, .. } if depth.passed() == Some(true))
    }
}

impl PixelEvent {
    /// Returns the event's triangle; `None` for a clear, and for content that was set from outside.
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

    /// Returns the stencil operation that ran; `None` where no fragment was tested against a stencil.
    fn operation(&self) -> Option<StencilOperation> {
        match self.triangle()?.outcome {
            FragmentOutcome::Tested { operation, .. } => operation,
            _ => None,
        }
    }

    /// Returns whether the event changed the pixel's depth, stencil or count, or is a triangle other than a volume's
    /// face that passed all tests, and so reached the colour.
    pub fn does_something(&self) -> bool {
        let has_passed = self.triangle().is_some_and(|one| one.outcome.passed());
        self.before != self.after || (has_passed && !self.is_of_volume())
    }

    /// Returns what a triangle was to add to the count, also where the count stopped at 0 or 255: 1 or −1 for
    /// operations that count (1 also for inverting), 0 for keep, zero and replace. Without a stencil operation it is
    /// the change, as in [`PixelEvent::counted`]; of a clear, or content set from outside, too: leave those out of
    /// sums.
    pub fn step(&self) -> i32 {
        match self.operation() {
            None => self.counted(),
            Some(operation) => step_of(operation).unwrap_or(0),
        }
    }

    /// Returns whether the event is a triangle of a shadow volume (side or cap), whatever became of it.
    pub fn is_of_volume(&self) -> bool {
        self.triangle().is_some_and(|one| one.part.is_of_volume())
    }
}

/// Returns what a stencil operation adds to a count: 1 also for inverting, whose parity is stored. `None` for other
/// operations.
fn step_of(operation: StencilOperation) -> Option<i32> {
    use StencilOperation::{DecrementClamp, DecrementWrap, IncrementClamp, IncrementWrap, Invert};
    match operation {
        IncrementClamp | IncrementWrap | Invert => Some(1),
        DecrementClamp | DecrementWrap => Some(-1),
        _ => None,
    }
}

impl PixelHistory {
    /// Returns the value that a light's count (stencil or float) was last cleared to at this pixel; 0 where none of the
    /// light's passes cleared it.
    pub(crate) fn cleared_to(&self, light: usize) -> i32 {
        let clears = self.events.iter().rev().filter(|event| event.light == Some(light));
        let mut cleared = clears.filter_map(|event| match event.kind {
            PixelEventKind::ClearStencil => Some(i32::from(event.after.stencil)),
            PixelEventKind::ClearCount => Some(event.after.count as i32),
            _ => None,
        });
        cleared.next().unwrap_or(0)
    }

    /// Returns whether the events make what the GPU stored, after every pass and bit for bit but for
    /// [`depth_rounding`](PixelHistory::depth_rounding), and are complete and in order. If not, it is the GPU's
    /// rounding, a fragment that a shader [may have discarded](PixelHistory::unknown_discard) or a bug of ours;
    /// [`PixelHistory::disagreements`] says where.
    pub fn agrees(&self) -> bool {
        self.disagreements().is_empty()
    }

    /// Returns the first triangle that changed the pixel with a fragment that its shader may have discarded, where nothing
    /// else disagrees than what the GPU stored after it: that may differ for this alone.
    pub fn unknown_discard(&self) -> Option<&TriangleEvent> {
        let mut changes = self.triangles().filter(|(event, one)| one.may_discard && event.after != event.before);
        let (event, one) = changes.next()?;
        let is_after = |one: &Disagreement| matches!(one, Disagreement::Stored { pass, .. } if *pass >= event.pass);
        self.disagreements().iter().all(is_after).then_some(one)
    }

    /// Says why the events don't make what the GPU stored.
    pub fn why_disagreeing(&self) -> String {
        match self.unknown_discard() {
            Some(one) => format!(
                "The GPU stored something else: the shader of {} may have discarded its fragment, which is taken to be there",
                one.draw_name
            ),
            None => {
                "This history is wrong, by the GPU's rounding or a bug of stencilscope: please report it".to_owned()
            }
        }
    }

    /// Returns the events in which a triangle covers the pixel, not clears, in the order in which they happened, each
    /// with its triangle.
    pub fn triangles(&self) -> impl Iterator<Item = (&PixelEvent, &TriangleEvent)> {
        self.events.iter().filter_map(|event| Some((event, event.triangle()?)))
    }

    /// Returns the pixel's values when the light pass tested it: after the last face of the light's volumes, or where
    /// there is none, when the light's last pass began; where that pass does not draw the pixel, when its labels were
    /// drawn.
    fn tested_count(&self, light: usize) -> PixelValues {
        let of_light = || self.events.iter().filter(|event| event.light == Some(light));
        let last = of_light().rfind(|event| event.is_of_volume());
        let tests =
            |event: &&PixelEvent| event.triangle().is_some_and(|one| one.lights.is_some() || event.target.is_beside());
        let tested = || of_light().filter(tests).min_by_key(|event| event.target.is_beside());
        last.map(|event| event.after).or_else(|| tested().map(|event| event.before)).unwrap_or(self.computed)
    }

    /// Returns on which side of the visible surface a light's volume faces count at this pixel; as needed where they
    /// count on both. Where faces were tested but none counted, the side where they are not. `None` where no face was
    /// tested: what was clipped or culled counts nowhere.
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

    /// Returns whether any event of the pass changes a value of the pixel, or reaches its colour.
    pub fn is_touched_by(&self, pass: usize) -> bool {
        self.events.iter().filter(|event| event.pass == pass).any(PixelEvent::does_something)
    }
}

/// Returns the values that the GPU stored at a pixel after each pass that has a snapshot of the picture; passes into
/// maps are left out. The count is there only after the last pass that adds to it.
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
        let count = light.and_then(|light| capture.lights.get(light)?.count.as_ref()?.value_at(pixel));
        after.push(CapturedAfter { pass, stored: DepthStencil { depth, stencil }, count });
    }
    after
}

/// Returns the index of the light to whose float count a pass adds; `None` for other passes.
fn frame_counts(plan: &FramePlan, capture: &Capture, pass: usize) -> Option<usize> {
    match &capture.steps.get(pass)?.snapshot {
        Snapshot::Frame(frame) if frame.target == FrameTarget::Count => plan.passes[pass].light.map(|light| light.0),
        _ => None,
    }
}
