//! Another program's frame compared with itself: each draw is computed again from what was stored before it, and draws of
//! which only what the last left is known together.

use super::{AsyncSession, SessionError};
use crate::capture::{Capture, DrawState, FrameSnapshot, Image, RecomputeDifference, Snapshot};
use crate::gpu::SnapshotMemory;
use crate::plan::{Blob, Draw, FramePlan, MeshId, Pass, StartContent};
use crate::progress::Progress;
use std::ops::Range;

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
        let mut before = StoredBefore::Start;
        for (pass, step) in plan.passes.iter().zip(&mut checked.steps) {
            let is_followed = plan.is_of_picture(pass) && pass.depth_stencil.is_some();
            let mut first = 0;
            for (index, summary) in step.draws.iter_mut().enumerate().take(pass.draws.len()) {
                if progress.is_cancelled() {
                    return Err(SessionError::Cancelled);
                }
                progress.advance();
                summary.differs = None;
                let Some(DrawState { snapshot: Snapshot::Frame(after), .. }) = &summary.after else { continue };
                let is_by_itself = first == 0 && begins_by_itself(plan, pass);
                if let (true, Some(stored)) = (is_followed, before.snapshot().or(is_by_itself.then_some(None))) {
                    let alone = alone(plan, pass, first..index + 1, stored);
                    summary.differs = self.differs(&alone, after).await?;
                }
                before = StoredBefore::Known(Box::new(after.clone()));
                first = index + 1;
            }
            // What is drawn elsewhere changes neither depth nor stencil.
            if is_followed && first < pass.draws.len() {
                before = StoredBefore::Unknown;
            }
        }
        Ok(checked)
    }

    /// Runs a frame of one draw or a run of them, and returns at how many pixels stencil and depth are not `after` (depths beyond
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

/// What was stored before a draw.
enum StoredBefore {
    /// Nothing is drawn yet: the first pass says what it begins with.
    Start,
    Known(Box<FrameSnapshot>),
    /// What the draws before it left was not recorded.
    Unknown,
}

impl StoredBefore {
    /// Returns what was stored, `Some(None)` at the frame's start; `None` where it is not known.
    fn snapshot(&self) -> Option<Option<&FrameSnapshot>> {
        match self {
            StoredBefore::Start => Some(None),
            StoredBefore::Known(snapshot) => Some(Some(snapshot)),
            StoredBefore::Unknown => None,
        }
    }
}

/// Returns whether a pass begins with depth and stencil that do not turn on what was stored before it.
fn begins_by_itself(plan: &FramePlan, pass: &Pass) -> bool {
    let Some(target) = &pass.depth_stencil else { return false };
    let start = pass.recorded.as_ref().and_then(|recorded| recorded.start.as_ref());
    let has_depth = target.clear_depth.is_some() || start.is_some_and(|start| start.depth.is_some());
    let has_stencil = target.clear_stencil.is_some() || start.is_some_and(|start| start.stencil.is_some());
    let format = plan.attachments[target.attachment.0].format;
    has_depth && (has_stencil || !format.has_stencil_aspect())
}

/// Returns a frame of these draws of a pass, whose depth and stencil begin with `before`; the first draw of a pass begins as
/// the pass does.
fn alone(plan: &FramePlan, pass: &Pass, draws: Range<usize>, before: Option<&FrameSnapshot>) -> FramePlan {
    let is_first = draws.start == 0;
    let draws = &pass.draws[draws];
    // Of lights and maps nothing is asked.
    let alone = |(mesh, draw): (usize, &Draw)| Draw {
        mesh: MeshId(mesh),
        pieces: None,
        samples_maps_of: Vec::new(),
        ..draw.clone()
    };
    let mut pass = Pass { draws: draws.iter().enumerate().map(alone).collect(), light: None, ..pass.clone() };
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
        meshes: draws.iter().map(|draw| plan.meshes[draw.mesh.0].clone()).collect(),
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
