//! The state after every draw: the plan is run with its passes split at their draws, and the parts are joined to steps
//! again here, and only here.
//!
//! Joined steps are those of a capture without draw states: the attachments after a pass are those after its last part,
//! and an aspect is unchanged where it ended as it began, whatever happened in between. An aspect that a draw did not
//! change shares the picture of the draw before it; one that it changed shares the rows that it left alone.
//!
//! The draws of one pass can be captured later ([`AsyncSession::step_draws`]).

use super::{AsyncSession, SessionError};
use crate::capture::{Aspect, Capture, DrawState, FrameTarget, Image, PixelFormat, Snapshot, Step, StepDraws};
use crate::gpu::{ExecutorOutput, GpuError, SnapshotMemory};
use crate::plan::FramePlan;
use std::collections::BTreeMap;
use std::sync::Arc;

/// After which parts of a frame its attachments are copied back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SnapshotInterval {
    /// After every pass.
    #[default]
    Pass,
    /// After every draw, and so after every pass.
    Draw,
}

impl AsyncSession {
    /// Runs a frame with a snapshot after each of its draws, and returns it with one step for each pass, whose draws
    /// have their states.
    pub(super) async fn run_by_draw(
        &mut self,
        plan: &FramePlan,
        bracket: bool,
    ) -> Result<ExecutorOutput, SessionError> {
        Ok(join(plan, |_| true, self.run_split(&plan.split_at_draws(), bracket).await?))
    }

    /// As [`Session::step_draws`](super::Session::step_draws).
    pub async fn step_draws(
        &mut self,
        plan: &FramePlan,
        capture: &Capture,
        step: usize,
    ) -> Result<StepDraws, SessionError> {
        if step >= capture.steps.len() {
            return Err(SessionError::NoSuchStep { step, steps: capture.steps.len() });
        }
        let output = self.run_split(&plan.split_pass_at_draws(step), false).await?;
        let joined = join(plan, |pass| pass == step, output);
        let known = known_images(capture, step);
        let mut last = [const { None }; 4];
        let draws = joined.steps.into_iter().nth(step).map_or_else(Vec::new, |step| step.draws);
        let states = draws.into_iter().map(|draw| draw.after.map(|state| sharing(state, &known, &mut last)));
        Ok(StepDraws { step, states: states.collect() })
    }

    async fn run_split(&mut self, split: &FramePlan, bracket: bool) -> Result<ExecutorOutput, SessionError> {
        let run = async |session: &mut AsyncSession| {
            let prepared = session.executor.prepare(split).await?;
            session.executor.capture(prepared, SnapshotMemory::Shared, bracket).await
        };
        run(self).await.map_err(|error| match error {
            GpuError::TooLarge { .. } => SessionError::TooManyDraws(error),
            error => error.into(),
        })
    }
}

/// Returns the images of the frame before and after a step, and those of the lights' masks, counts and maps: draws may
/// have left some of them as they were.
fn known_images(capture: &Capture, step: usize) -> Vec<Arc<Image>> {
    let before = step.checked_sub(1).and_then(|before| capture.frame_at(before)).cloned().map(Snapshot::Frame);
    let snapshots = before.iter().chain([&capture.steps[step].snapshot]);
    let mut known: Vec<Arc<Image>> = snapshots.flat_map(Snapshot::aspects).map(|aspect| aspect.image.clone()).collect();
    for light in &capture.lights {
        known.extend(light.shadow.iter().chain(&light.count).cloned());
        known.extend(light.map.iter().flat_map(|map| map.faces.iter().cloned()));
    }
    known
}

/// Replaces pictures of a state by equal ones that are in memory already, or else shares equal rows with those. `last`
/// is colour, depth, stencil and the pass's own target after the draw before. The frame that was run again for it is
/// then free.
fn sharing(mut state: DrawState, known: &[Arc<Image>], last: &mut [Option<Arc<Image>>; 4]) -> DrawState {
    let [color, depth, stencil] = frame_aspects(&mut state.snapshot);
    for (aspect, last) in [color, depth, stencil, state.target.as_mut()].into_iter().zip(last) {
        let Some(aspect) = aspect else { continue };
        let mut earlier = last.iter().chain(known);
        if let Some(equal) = earlier.clone().find(|earlier| **earlier == aspect.image) {
            aspect.image = equal.clone();
        } else if let Some(shared) = earlier.find_map(|earlier| aspect.image.sharing(earlier)) {
            aspect.image = Arc::new(shared);
        }
        *last = Some(aspect.image.clone());
    }
    state
}

/// A target of a pass other than the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum OwnTarget {
    OfLight(usize, FrameTarget),
    Layer(usize, usize),
}

impl OwnTarget {
    fn of(step: &Step) -> Option<OwnTarget> {
        match &step.snapshot {
            Snapshot::Map { light, face } => Some(OwnTarget::Layer(*light, *face)),
            Snapshot::Frame(frame) => {
                let target = Some(frame.target).filter(|target| *target != FrameTarget::Picture)?;
                Some(OwnTarget::OfLight(step.light?, target))
            }
        }
    }
}

/// Returns colour, depth and stencil of a snapshot; `None` for the stencil that it lacks, and for all three of a map.
fn frame_aspects(snapshot: &mut Snapshot) -> [Option<&mut Aspect>; 3] {
    match snapshot {
        Snapshot::Frame(frame) => [Some(&mut frame.color), Some(&mut frame.depth), frame.stencil.as_mut()],
        Snapshot::Map { .. } => [None, None, None],
    }
}

/// The attachments while the parts of a frame are joined.
struct RunningState {
    /// The picture's colour, depth and stencil.
    frame: [Arc<Image>; 3],
    own: BTreeMap<OwnTarget, Arc<Image>>,
}

impl RunningState {
    /// Returns the state before the first pass: all zeros, as wgpu clears new textures.
    fn new(size: [u32; 2]) -> RunningState {
        let zero = |format: PixelFormat| Arc::new(Image::uniform(format, size, &vec![0; format.texel_bytes()]));
        let frame = [PixelFormat::Rgba8Srgb, PixelFormat::Depth32F, PixelFormat::U8].map(zero);
        RunningState { frame, own: BTreeMap::new() }
    }

    /// Advances by one part of a pass: takes over the aspects that it changed, and sets those that it did not change in
    /// `snapshot` to the shared images.
    fn go_on(&mut self, snapshot: &mut Snapshot) {
        for (now, aspect) in self.frame.iter_mut().zip(frame_aspects(snapshot)) {
            match aspect {
                Some(aspect) if aspect.unchanged => aspect.image = now.clone(),
                Some(aspect) => *now = aspect.image.clone(),
                None => {}
            }
        }
    }

    /// Advances a pass's own target (a map layer, counts or labels) by one part; returns its content, shared and marked
    /// unchanged where it equals the one before.
    fn go_on_with(&mut self, target: OwnTarget, image: Arc<Image>) -> Aspect {
        match self.own.get(&target) {
            Some(now) if *now == image => Aspect { image: now.clone(), unchanged: true },
            _ => {
                self.own.insert(target, image.clone());
                Aspect { image, unchanged: false }
            }
        }
    }

    /// Ends a pass that began at `before`, and completes its snapshot: an aspect with the same content as then is that
    /// image, and is marked unchanged.
    fn end(&mut self, before: &[Arc<Image>; 3], snapshot: &mut Snapshot) {
        for ((now, before), aspect) in self.frame.iter_mut().zip(before).zip(frame_aspects(snapshot)) {
            if !Arc::ptr_eq(now, before) && now == before {
                now.clone_from(before);
            }
            if let Some(aspect) = aspect {
                *aspect = Aspect { image: now.clone(), unchanged: Arc::ptr_eq(now, before) };
            }
        }
    }
}

/// Joins the parts of the passes that were split at their draws to one step each, with the state after each draw.
/// `plan` is the frame before it was split; it may have more passes than were run.
fn join(plan: &FramePlan, is_split: impl Fn(usize) -> bool, output: ExecutorOutput) -> ExecutorOutput {
    let mut now = RunningState::new(plan.size);
    let mut parts = output.steps.into_iter().zip(output.targets).peekable();
    let mut joined = ExecutorOutput { steps: Vec::new(), targets: Vec::new(), ..output };
    for (index, pass) in plan.passes.iter().enumerate() {
        if parts.peek().is_none() {
            break;
        }
        let count = if is_split(index) { pass.draws.len().max(1) } else { 1 };
        let before = now.frame.clone();
        let mut whole: Option<Step> = None;
        let mut target_after = None;
        for (mut part, target) in parts.by_ref().take(count) {
            now.go_on(&mut part.snapshot);
            let target = OwnTarget::of(&part).zip(target).map(|(own, image)| now.go_on_with(own, image));
            target_after = target.as_ref().map(|aspect| aspect.image.clone());
            if let ([draw], true) = (&mut part.draws[..], is_split(index)) {
                draw.after = Some(DrawState { snapshot: part.snapshot.clone(), target });
            }
            whole = Some(match whole {
                None => part,
                Some(mut whole) => {
                    whole.draws.append(&mut part.draws);
                    whole.gpu_ms = whole.gpu_ms.zip(part.gpu_ms).map(|(sum, more)| sum + more);
                    Step { snapshot: part.snapshot, ..whole }
                }
            });
        }
        let Some(mut whole) = whole else { break };
        now.end(&before, &mut whole.snapshot);
        if let Some(DrawState { snapshot, .. }) = whole.draws.last_mut().and_then(|draw| draw.after.as_mut()) {
            // Its pictures are the step's; whether it changed them is still its own.
            for (aspect, now) in frame_aspects(snapshot).into_iter().zip(&now.frame) {
                aspect.into_iter().for_each(|aspect| aspect.image.clone_from(now));
            }
        }
        joined.steps.push(whole);
        joined.targets.push(target_after);
    }
    for (target, image) in now.own {
        let place = match target {
            OwnTarget::OfLight(light, target) => joined.of_lights[light].get_mut(target).and_then(Option::as_mut),
            OwnTarget::Layer(light, face) => joined.maps[light].as_mut().and_then(|faces| faces.get_mut(face)),
        };
        place.into_iter().for_each(|place| place.clone_from(&image));
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::OpenSpec;
    use crate::session::{CaptureRequest, Session};
    use crate::technique::{Choice, Technique};

    #[test]
    fn draws_of_other_passes_go_only_where_there_is_no_room_for_all() {
        let scene = crate::scene::open(&OpenSpec::new("tetrahedron")).expect("a built-in scene");
        let request = CaptureRequest::new(Choice::new(Technique::ZFail), [32, 24]);
        let request = CaptureRequest { every: SnapshotInterval::Draw, ..request };
        let capture = Session::new(None).and_then(|mut session| session.capture(&scene, &request)).expect("draws");
        let states = capture.steps[1].draws.iter().map(|draw| draw.after.clone()).collect();
        let draws = StepDraws { step: 1, states };
        assert_eq!(capture.with_draws_in(&draws, capture.bytes()), capture);
        let less = capture.with_draws_in(&draws, capture.bytes() - 1);
        for (index, step) in less.steps.iter().enumerate() {
            assert_eq!(less.holds_draws(index), index == 1 || step.draws.is_empty(), "{}", step.name);
        }
        assert_eq!(less.steps[1], capture.steps[1]);
    }
}
