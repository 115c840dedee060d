//! No shadows: every light reaches every surface that faces it.

use super::PlanError;
use super::frame::{Frame, Job, LabelLayer};
use crate::plan::{ColorWrite, FramePlan, RasterState};

/// Plans a frame without shadows.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    let mut frame = Frame::new(job, false)?;
    frame.ambient_pass();
    for light in frame.light_ids() {
        frame.mask_pass(light, &[LabelLayer::lit()]);
        let purpose = "Adds the light everywhere: nothing asks whether something stands between.";
        frame.light_pass(light, purpose, &RasterState::visible_surface(ColorWrite::Add), false);
    }
    Ok(frame.finish())
}
