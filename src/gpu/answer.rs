//! What a frame is judged by, where no more of its run is stored: labels and visibility of its lights, and the finished
//! picture.

use super::GpuError;
use super::collect::{SnapshotMemory, SnapshotStorage, after};
use super::prepared::Prepared;
use super::readback::{TargetChange, color_change};
use crate::capture::{FrameTarget, Image, LightTargets, PixelFormat};
use crate::plan::{AttachmentRole, FramePlan, LightId, Pass};
use std::sync::Arc;

/// What a frame is judged by, as [`Executor::answer`](super::Executor::answer) returns it.
#[derive(Debug)]
pub struct FrameAnswer {
    /// For each light, by its index, its labels, and its visibility where the technique knows shares.
    pub of_lights: Vec<LightTargets>,
    /// The picture after the last pass that changes it.
    pub picture: Arc<Image>,
}

/// Returns the light, and which of its targets a pass draws into; `None` where the pass's colour target is another or
/// it has none.
pub(super) fn target_of_light(plan: &FramePlan, pass: &Pass) -> Option<(FrameTarget, LightId)> {
    FrameTarget::of(plan.attachment(pass.color.as_ref()?.attachment).role)
}

/// Returns the index of the last pass that changes the picture; `None` where no pass does.
pub(super) fn last_of_picture(plan: &FramePlan) -> Option<usize> {
    let is_picture = |pass: &Pass| {
        let color = pass.color.as_ref();
        color.is_some_and(|target| plan.attachment(target.attachment).role == AttachmentRole::Color)
    };
    plan.passes.iter().rposition(|pass| is_picture(pass) && color_change(plan, pass) != TargetChange::Unchanged)
}

/// Returns what passes have left in those targets of each light that are `wanted`, read back from the GPU.
pub(super) fn of_lights(prepared: &Prepared, wanted: &[FrameTarget]) -> Result<Vec<LightTargets>, GpuError> {
    let plan = prepared.plan;
    let mut storage = SnapshotStorage { memory: SnapshotMemory::Mapped, budget: prepared.budget };
    let mut of_lights = vec![LightTargets::default(); plan.lights.len()];
    for (index, pass) in plan.passes.iter().enumerate() {
        let Some((target, light)) = target_of_light(plan, pass).filter(|(target, _)| wanted.contains(target)) else {
            continue;
        };
        let staged = prepared.staged(index)?;
        let left = after(&color_change(plan, pass), &staged.color, target.format(), plan.size)?;
        if let Some(known) = of_lights[light.0].get_mut(target) {
            storage.keep(known, left)?;
        }
    }
    Ok(of_lights)
}

/// Returns the finished picture (sRGB), read back from the GPU after the passes have run; all zero where no pass draws
/// into it.
pub(super) fn picture(prepared: &Prepared) -> Result<Arc<Image>, GpuError> {
    let (plan, format) = (prepared.plan, PixelFormat::Rgba8Srgb);
    let left = match last_of_picture(plan) {
        Some(index) => {
            let change = color_change(plan, &plan.passes[index]);
            after(&change, &prepared.staged(index)?.color, format, plan.size)?
        }
        None => None,
    };
    // wgpu clears new textures to zero.
    Ok(left.unwrap_or_else(|| Arc::new(Image::uniform(format, plan.size, &[0; 4]))))
}
