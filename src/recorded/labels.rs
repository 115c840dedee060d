//! The labels of another program's frame: lit is what the stencil test of the light's pass lets through, or in shadow
//! where that pass darkens the picture.

use crate::capture::{Capture, Image, PixelFormat, Snapshot};
use crate::plan::{FramePlan, LightId, Pass};
use crate::stencil_machine::stencil_passes;
use crate::truth::{BACKGROUND, LIT, SHADOW};
use std::sync::Arc;

/// Returns a byte a pixel, as techniques label them: lit, in shadow, or background where no surface was drawn. `None`
/// where no pass of the light tests the stencil.
pub fn labels(plan: &FramePlan, capture: &Capture, light: LightId) -> Option<Arc<Image>> {
    let asks = |pass: &Pass| {
        let is_of_light = pass.light == Some(light) && plan.is_of_picture(pass);
        is_of_light && pass.draws.iter().any(|draw| draw.raster.stencil.is_enabled() && !draw.part.is_of_volume())
    };
    let index = plan.passes.iter().position(asks)?;
    let raster = &plan.passes[index].draws.iter().find(|draw| draw.raster.stencil.is_enabled())?.raster;
    // The stencil that it tests is what the pass before left: where it sets its own, nothing was counted.
    let pass = &plan.passes[index];
    let is_set = pass.depth_stencil.as_ref().is_some_and(|target| target.clear_stencil.is_some())
        || pass
            .recorded
            .as_ref()
            .is_some_and(|recorded| recorded.start.as_ref().is_some_and(|start| start.stencil.is_some()));
    let before = capture.frame_at(index.checked_sub(1).filter(|_| !is_set)?)?;
    let Snapshot::Frame(after) = &capture.steps.get(index)?.snapshot else { return None };
    let stencil = &before.stencil.as_ref()?.image;
    let darkens = pass.recorded.as_ref().is_some_and(|recorded| recorded.darkens);
    let clear = plan.depth.mapping.clear_depth().to_le_bytes();
    let rows = stencil.rows().zip(after.depth.image.rows());
    let label = |(stencil, depth): (&u8, &[u8])| match depth == clear {
        true => BACKGROUND,
        false if stencil_passes(raster, true, *stencil) != darkens => LIT,
        false => SHADOW,
    };
    let labels: Vec<u8> =
        rows.flat_map(|(stencil, depth)| stencil.iter().zip(depth.chunks_exact(4)).map(label)).collect();
    Some(Arc::new(Image::packed(PixelFormat::U8, plan.size, labels)))
}
