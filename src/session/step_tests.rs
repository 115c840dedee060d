//! Results of the tests for the fragments of a step: a frame is data, so a changed frame counts them.
//!
//! The frame is run up to the step. Then the step's draws are run twice, each time over a cleared stencil in which
//! every fragment that passes counts up: with their own depth test, and with none. The first run leaves how many pass
//! the depth test, the second how many there are; depth is written the first time only, so both test against the step's
//! own depth. The stencil test is off meanwhile: what its own test would decide follows from the stencil before the
//! step, as long as the step does not change the bits that it tests. Where it does, and there is more than one
//! fragment, the verdict is unknown.

use super::{AsyncSession, SessionError};
use crate::capture::{Image, PixelFormat, Snapshot, StencilVerdict, StepTests};
use crate::gpu::SnapshotMemory;
use crate::plan::{AttachmentRole, Draw, FramePlan, Pass, RasterState, StencilFace};
use crate::stencil_machine::{DepthStencil, IncomingFragment, test};
use std::sync::Arc;
use wgpu::{CompareFunction, Face, StencilOperation};

impl AsyncSession {
    /// As [`Session::step_tests`](super::Session::step_tests).
    pub async fn step_tests(
        &mut self,
        plan: &FramePlan,
        step: usize,
        draw: Option<usize>,
    ) -> Result<StepTests, SessionError> {
        let (counting, draws) = counting_plan(plan, step, draw).ok_or(SessionError::NoTests { step })?;
        let prepared = self.executor.prepare(&counting).await?;
        let output = self.executor.capture(prepared, SnapshotMemory::Mapped, false).await?;
        let stencils: Vec<Arc<Image>> = output
            .steps
            .iter()
            .filter_map(|step| match &step.snapshot {
                Snapshot::Frame(frame) => frame.stencil.as_ref().map(|aspect| aspect.image.clone()),
                Snapshot::Map { .. } => None,
            })
            .collect();
        let [.., depth_passes, fragments] = &stencils[..] else { return Err(SessionError::NoTests { step }) };
        let cleared = clears_stencil(&plan.passes[step]).filter(|_| draw.is_none_or(|draw| draw == 0));
        let start = plan.passes[step].recorded.as_ref().and_then(|recorded| recorded.start.as_ref()?.stencil.as_ref());
        let start_stencil = start.filter(|_| draw.is_none_or(|draw| draw == 0));
        let before = match (cleared, stencils.len().checked_sub(3).map(|index| &stencils[index])) {
            (None, _) if let Some(start_stencil) = start_stencil => {
                Arc::new(Image::packed(PixelFormat::U8, plan.size, start_stencil.data().to_vec()))
            }
            (None, Some(before)) => before.clone(),
            (cleared, _) => Arc::new(Image::uniform(PixelFormat::U8, plan.size, &[cleared.unwrap_or(0)])),
        };
        let stencil = Arc::new(verdicts(&draws, &before, fragments));
        let [fragments, depth_passes] = [fragments, depth_passes].map(Arc::clone);
        Ok(StepTests { step, draw, fragments, depth_passes, stencil })
    }
}

fn clears_stencil(pass: &Pass) -> Option<u8> {
    pass.depth_stencil.as_ref().and_then(|target| target.clear_stencil)
}

/// Returns the frame that counts, with the draws whose fragments it counts.
fn counting_plan(plan: &FramePlan, step: usize, draw: Option<usize>) -> Option<(FramePlan, Vec<Draw>)> {
    let pass = plan.passes.get(step)?;
    let target = pass.depth_stencil.as_ref()?;
    let first = draw.unwrap_or(0);
    let end = draw.map_or(pass.draws.len(), |draw| draw + 1);
    let counted = pass.draws.get(first..end).filter(|draws| !draws.is_empty())?.to_vec();
    let mut passes = plan.passes[..step].to_vec();
    if first > 0 {
        passes.push(Pass { draws: pass.draws[..first].to_vec(), ..pass.clone() });
    }
    let mut counting = pass.clone();
    if let Some(target) = &mut counting.depth_stencil {
        target.clear_stencil = Some(0);
        target.clear_depth = target.clear_depth.filter(|_| first == 0);
    }
    if let Some(color) = &mut counting.color {
        color.clear = color.clear.filter(|_| first == 0);
    }
    counting.draws.clone_from(&counted);
    counting.draws.iter_mut().for_each(|draw| count_up(&mut draw.raster));
    if let Some(recorded) = counting.recorded.as_mut() {
        recorded.start = recorded.start.take().filter(|_| first == 0);
        // Counting begins at 0.
        recorded.start.iter_mut().for_each(|start| start.stencil = None);
    }
    let mut again = counting.clone();
    again.recorded.iter_mut().for_each(|recorded| recorded.start = None);
    if let Some(target) = &mut again.depth_stencil {
        target.clear_depth = None;
    }
    if let Some(color) = &mut again.color {
        color.clear = None;
    }
    for draw in &mut again.draws {
        draw.raster.depth_compare = CompareFunction::Always;
        draw.raster.depth_write = false;
    }
    passes.extend([counting, again]);
    let mut counting = FramePlan { passes, ..plan.clone() };
    let attachment = counting.attachments.get_mut(target.attachment.0)?;
    if attachment.role != AttachmentRole::DepthStencil {
        return None;
    }
    // The same depth format, with a stencil added.
    attachment.format = match attachment.depth_steps() {
        Some(0xffff) => return None,
        Some(_) => wgpu::TextureFormat::Depth24PlusStencil8,
        None => wgpu::TextureFormat::Depth32FloatStencil8,
    };
    counting.lights.iter_mut().filter_map(|light| light.map.as_mut()).for_each(|map| map.is_cached = false);
    Some((counting, counted))
}

/// Changes a state so that every fragment that passes the depth test counts up in the stencil, and nothing else does.
fn count_up(raster: &mut RasterState) {
    let face = StencilFace {
        compare: CompareFunction::Always,
        fail_op: StencilOperation::Keep,
        depth_fail_op: StencilOperation::Keep,
        pass_op: StencilOperation::IncrementClamp,
    };
    *raster = raster.clone().with_stencil(face, 0);
}

/// Returns a [`StencilVerdict`] for each pixel, from the stencil before the draws.
fn verdicts(draws: &[Draw], before: &Image, fragments: &Image) -> Image {
    let rules = rules(draws);
    let verdict = |(stored, fragments): (&u8, &u8)| {
        let rule = rules[usize::from(*stored)];
        let verdict = match rule {
            StencilRule { verdict, lasts: true } => verdict,
            // The first fragment is tested against what was stored before.
            StencilRule { verdict, lasts: false } if *fragments <= 1 => verdict,
            StencilRule { .. } => StencilVerdict::Unknown,
        };
        verdict as u8
    };
    let rows = before.rows().zip(fragments.rows());
    let bytes: Vec<u8> = rows.flat_map(|(before, fragments)| before.iter().zip(fragments).map(verdict)).collect();
    Image::packed(PixelFormat::U8, before.size(), bytes)
}

/// The stencil test's result for one stored value.
#[derive(Debug, Clone, Copy)]
struct StencilRule {
    verdict: StencilVerdict,
    /// True where the fragments leave the tested bits as they were.
    lasts: bool,
}

/// Returns a rule for each stored value. Faces that are culled are ignored.
fn rules(draws: &[Draw]) -> [StencilRule; 256] {
    std::array::from_fn(|stored| {
        let mut rule: Option<StencilRule> = None;
        for (raster, front_facing) in draws.iter().flat_map(|draw| seen_faces(&draw.raster)) {
            let one = rule_of(raster, front_facing, stored as u8);
            rule = Some(match rule {
                None => one,
                Some(all) if all.verdict == one.verdict => StencilRule { lasts: all.lasts && one.lasts, ..all },
                // The test treats faces or draws differently, and which of them the fragment is of is not known.
                Some(_) => StencilRule { verdict: StencilVerdict::Unknown, lasts: true },
            });
        }
        rule.unwrap_or(StencilRule { verdict: StencilVerdict::Passes, lasts: true })
    })
}

fn seen_faces(raster: &RasterState) -> impl Iterator<Item = (&RasterState, bool)> {
    let faces = [(Face::Front, true), (Face::Back, false)];
    faces.into_iter().filter(|(face, _)| raster.cull != Some(*face)).map(move |(_, is_front)| (raster, is_front))
}

fn rule_of(raster: &RasterState, front_facing: bool, stencil: u8) -> StencilRule {
    if !raster.stencil.is_enabled() {
        return StencilRule { verdict: StencilVerdict::Passes, lasts: true };
    }
    let stored = DepthStencil { depth: 0.0, stencil };
    let passes = test(raster, IncomingFragment { depth: 0.0, front_facing }, stored).stencil_passed;
    let (face, masks) = raster.face(front_facing);
    let operations = if passes { vec![face.depth_fail_op, face.pass_op] } else { vec![face.fail_op] };
    let keeps = operations.iter().all(|operation| *operation == StencilOperation::Keep);
    let is_apart = masks.write & masks.read == 0;
    let is_always = face.compare == CompareFunction::Always;
    let verdict = if passes { StencilVerdict::Passes } else { StencilVerdict::Fails };
    StencilRule { verdict, lasts: keeps || is_apart || is_always }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster(compare: CompareFunction, pass_op: StencilOperation) -> RasterState {
        let face =
            StencilFace { compare, fail_op: StencilOperation::Keep, depth_fail_op: StencilOperation::Keep, pass_op };
        RasterState::surface().with_stencil(face, 0)
    }

    #[test]
    fn what_a_step_tests_and_does_not_write_is_known() {
        let rule = |raster: &RasterState, stored| rule_of(raster, true, stored);
        let reads = raster(CompareFunction::Equal, StencilOperation::Keep);
        assert_eq!(rule(&reads, 0).verdict, StencilVerdict::Passes);
        assert_eq!(rule(&reads, 3).verdict, StencilVerdict::Fails);
        assert!(rule(&reads, 0).lasts && rule(&reads, 3).lasts);
        let marks = raster(CompareFunction::Equal, StencilOperation::IncrementClamp);
        assert!(!rule(&marks, 0).lasts, "a second fragment meets another value");
        assert!(rule(&marks, 3).lasts, "who fails changes nothing");
        let counts = raster(CompareFunction::Always, StencilOperation::IncrementWrap);
        assert!(rule(&counts, 7).lasts && rule(&counts, 7).verdict == StencilVerdict::Passes);
    }
}
