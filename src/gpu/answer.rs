//! What a frame is judged by, where no more of its run is stored: the labels of its lights, and the finished picture.

use super::GpuError;
use super::collect::{SnapshotMemory, SnapshotStorage, after};
use super::prepared::Prepared;
use super::readback::{TargetChange, color_change};
use crate::capture::{Image, PixelFormat};
use crate::plan::{AttachmentRole, FramePlan, LightId, Pass};
use std::sync::Arc;

/// The label masks and the finished picture of a frame, as [`Executor::answer`](super::Executor::answer) returns them.
#[derive(Debug)]
pub struct LabelsAndPicture {
    /// The label mask of each light, by its index; `None` for a light whose labels no pass writes.
    pub labels: Vec<Option<Arc<Image>>>,
    /// The picture after the last pass that changes it.
    pub picture: Arc<Image>,
}

/// Returns the light whose label mask is the pass's colour target; `None` where its target is another or it has none.
pub(super) fn labelled(plan: &FramePlan, pass: &Pass) -> Option<LightId> {
    match plan.attachment(pass.color.as_ref()?.attachment).role {
        AttachmentRole::Labels(light) => Some(light),
        _ => None,
    }
}

/// Returns the index of the last pass that changes the picture; `None` where no pass does.
pub(super) fn last_of_picture(plan: &FramePlan) -> Option<usize> {
    let is_picture = |pass: &Pass| {
        let color = pass.color.as_ref();
        color.is_some_and(|target| plan.attachment(target.attachment).role == AttachmentRole::Color)
    };
    plan.passes.iter().rposition(|pass| is_picture(pass) && color_change(plan, pass) != TargetChange::Unchanged)
}

/// Returns the label mask of each light, read back from the GPU after the passes have run; `None` for a light whose
/// mask no pass writes.
pub(super) fn labels(prepared: &Prepared) -> Result<Vec<Option<Arc<Image>>>, GpuError> {
    let plan = prepared.plan;
    let mut storage = SnapshotStorage { memory: SnapshotMemory::Mapped, budget: prepared.budget };
    let mut labels = vec![None; plan.lights.len()];
    for (index, pass) in plan.passes.iter().enumerate() {
        if let Some(light) = labelled(plan, pass) {
            let staged = prepared.staged(index)?;
            let left = after(&color_change(plan, pass), &staged.color, PixelFormat::U8, plan.size)?;
            storage.keep(&mut labels[light.0], left)?;
        }
    }
    Ok(labels)
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
