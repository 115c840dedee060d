//! No shadows: every light reaches every surface that faces it.

use super::PlanError;
use super::description::{ComparisonRole, ONE_ROW, TechniqueDescription};
use super::frame::{FrameBuilder, PlanRequest, StencilUse};
use super::lesson::Lesson;
use crate::plan::{FramePlan, Visibility};

/// Describes `none` for commands, tables and the inspector.
pub(super) const DESCRIPTION: TechniqueDescription = TechniqueDescription {
    summary: "Every light reaches every surface that faces it: the picture to compare others with.",
    lesson: Lesson {
        text: "The picture to compare others with: everything that should be dark is wrong.",
        formula: "colour = ambient + the sum of what each light gives",
        sources: &[],
    },
    plan,
    report_rows: ONE_ROW,
    standing: ComparisonRole::Apart { because: "there is nothing to darken" },
};

/// Plans a frame without shadows: every light reaches every surface that faces it and is within its range.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let mut frame = FrameBuilder::new(job, StencilUse::ToLightOnce)?;
    frame.ambient_pass();
    for light in frame.light_ids() {
        let purpose = "Adds the light everywhere: nothing asks whether something stands between.";
        frame.mask_and_light_passes(light, Visibility::Everywhere, purpose);
    }
    Ok(frame.finish())
}
