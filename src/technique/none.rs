//! No shadows: every light reaches every surface that faces it.

use super::frame::{Drawn, Frame, Job, StencilUse};
use super::settings::ONE_ROW;
use super::{PlanError, ReportRows};
use crate::plan::FramePlan;

/// What a report compares: the defaults.
pub(super) const REPORT_ROWS: ReportRows = ONE_ROW;

/// Plans a frame without shadows.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    let mut frame = Frame::new(job, StencilUse::ToLightOnce)?;
    frame.ambient_pass();
    for light in frame.light_ids() {
        frame.mask_pass(light, &[Drawn::lit()]);
        let purpose = "Adds the light everywhere: nothing asks whether something stands between.";
        frame.light_pass(light, purpose, &frame.light_everywhere());
    }
    Ok(frame.finish())
}
