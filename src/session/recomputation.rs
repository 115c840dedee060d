//! Another program's frame compared with itself: each draw is computed again from what was stored before it.

use super::{AsyncSession, SessionError};
use crate::capture::{Capture, DrawState, FrameSnapshot, Image, RecomputeDifference, Snapshot};
use crate::gpu::SnapshotMemory;
use crate::plan::{Blob, Draw, FramePlan, MeshId, Pass, StartContent};
use crate::progress::Progress;

impl AsyncSession {
    /// As [`Session::compared_with_rerun`](super::Session::compared_with_rerun).
    pub async fn compared_with_rerun(
        &mut self,
        plan: &FramePlan,
        capture: &Capture,
        progress: &Progress,
    ) -> Result<Capture, SessionError> {
        let mut checked = capture.clone();
        progress.start(plan.passes.iter().map(|pass| pass.draws.len()).sum());
        let mut before: Option<FrameSnapshot> = None;
        for (pass, step) in plan.passes.iter().zip(&mut checked.steps) {
            let is_followed = plan.is_of_picture(pass) && pass.depth_stencil.is_some();
            for (index, (draw, summary)) in pass.draws.iter().zip(&mut step.draws).enumerate() {
                if progress.is_cancelled() {
                    return Err(SessionError::Cancelled);
                }
                progress.advance();
                let Some(DrawState { snapshot: Snapshot::Frame(after), .. }) = &summary.after else { continue };
                if is_followed {
                    let alone = alone(plan, pass, draw, index == 0, before.as_ref());
                    summary.differs = self.differs(&alone, after).await?;
                }
                before = Some(after.clone());
            }
        }
        Ok(checked)
    }

    /// Runs a frame of one draw, and returns at how many pixels stencil and depth are not `after` (depths beyond
    /// rounding, and apart from these those within); `None` where it leaves no picture.
    async fn differs(
        &mut self,
        alone: &FramePlan,
        after: &FrameSnapshot,
    ) -> Result<Option<RecomputeDifference>, SessionError> {
        let prepared = self.executor.prepare_once(alone).await?;
        let output = self.executor.capture(prepared, SnapshotMemory::Mapped, false).await?;
        let Some(Snapshot::Frame(made)) = output.steps.first().map(|step| &step.snapshot) else { return Ok(None) };
        let stencil = match (&made.stencil, &after.stencil) {
            (Some(made), Some(after)) => {
                let rows = unequal_rows(&made.image, &after.image);
                rows.flat_map(|(made, after)| made.iter().zip(after)).filter(|(made, after)| made != after).count()
            }
            _ => 0,
        };
        let mut differs = RecomputeDifference { stencil: stencil as u64, ..RecomputeDifference::default() };
        for (made, after) in unequal_rows(&made.depth.image, &after.depth.image) {
            for (made, after) in depths(made).zip(depths(after)) {
                let is_near = (made - after).abs() <= alone.attachments[0].depth_rounding();
                differs.depth += u64::from(!is_near);
                differs.rounded += u64::from(is_near && made != after);
            }
        }
        Ok(Some(differs))
    }
}

/// Returns a frame of one draw, whose depth and stencil begin with `before`; the first draw of a pass begins as the
/// pass does.
fn alone(plan: &FramePlan, pass: &Pass, draw: &Draw, is_first: bool, before: Option<&FrameSnapshot>) -> FramePlan {
    // Of lights and maps nothing is asked.
    let draw_alone = Draw { mesh: MeshId(0), pieces: None, samples_maps_of: Vec::new(), ..draw.clone() };
    let mut pass = Pass { draws: vec![draw_alone], light: None, ..pass.clone() };
    if let (Some(target), false) = (&mut pass.depth_stencil, is_first) {
        (target.clear_depth, target.clear_stencil) = (None, None);
    }
    if let Some(recorded) = &mut pass.recorded {
        let given = recorded.start.take().filter(|_| is_first).unwrap_or_default();
        let rows = |image: &Image| image.rows().collect::<Vec<_>>().concat();
        let depth = || Some(Blob::new(bytemuck::pod_collect_to_vec(&rows(&before?.depth.image))));
        let stencil = || Some(Blob::new(rows(&before?.stencil.as_ref()?.image)));
        let start = StartContent { depth: given.depth.or_else(depth), stencil: given.stencil.or_else(stencil) };
        recorded.start = Some(start).filter(|start| *start != StartContent::default());
    }
    FramePlan {
        technique: plan.technique.clone(),
        settings: plan.settings.clone(),
        attachments: plan.attachments[..1].to_vec(),
        views: plan.views.clone(),
        lights: Vec::new(),
        meshes: vec![plan.meshes[draw.mesh.0].clone()],
        textures: Vec::new(),
        passes: vec![pass],
        left_out: Vec::new(),
        ..*plan
    }
}

/// Returns the pairs of rows that are not the same bytes; rows that only one image has are left out.
fn unequal_rows<'a>(made: &'a Image, after: &'a Image) -> impl Iterator<Item = (&'a [u8], &'a [u8])> {
    made.rows().zip(after.rows()).filter(|(made, after)| made != after)
}

fn depths(row: &[u8]) -> impl Iterator<Item = f32> + '_ {
    row.as_chunks::<4>().0.iter().map(|depth| f32::from_le_bytes(*depth))
}
