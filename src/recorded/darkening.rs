//! Modulative shadows: passes that darken a picture already lit, where shadow volumes are counted.

use crate::capture::{FrameSnapshot, Snapshot, Step};
use crate::plan::{ColorWrite, FramePlan, LightId, Pass, RasterState};
use crate::stencil_machine::stencil_passes;
use wgpu_types::CompareFunction;

/// Returns whether a pass of a light takes light away where its stencil test passes, instead of adding it: its draws blend
/// with what is stored, and the stored colours got darker on the whole. Blend states alone do not tell: the same state
/// darkens with one source colour and brightens with another. Where no colour changed, a test that fails where nothing was
/// counted is one for shadow. `steps` are those of the plan's passes.
pub fn darkens(plan: &FramePlan, steps: &[Step], index: usize) -> bool {
    let of_light = plan.passes.get(index).filter(|pass| plan.is_of_picture(pass));
    let light = of_light.and_then(|pass| pass.light);
    let Some((raster, light)) = of_light.and_then(blending).zip(light) else { return false };
    let before = index.checked_sub(1).and_then(|before| frame(steps, before));
    let (Some(before), Some(after)) = (before, frame(steps, index)) else { return false };
    let change = match after.color.unchanged {
        true => 0,
        false => brightness(after.color.image.rows()) - brightness(before.color.image.rows()),
    };
    change < 0 || (change == 0 && !passes_uncounted(plan, light, raster))
}

/// Returns whether a stencil test lets through where nothing was counted: what an equality compares with is the count of a
/// pixel without shadow; other tests are asked with what the stencil was cleared to before the light's volumes, else 0.
pub(super) fn passes_uncounted(plan: &FramePlan, light: LightId, raster: &RasterState) -> bool {
    let counts = |pass: &Pass| {
        let is_of_light = pass.light == Some(light) && plan.is_of_picture(pass);
        is_of_light && pass.draws.iter().any(|draw| draw.part.is_of_volume())
    };
    let first = plan.passes.iter().position(counts).map_or(0, |first| first + 1);
    let before = plan.passes[..first].iter().rev().filter(|pass| plan.is_of_picture(pass));
    match raster.stencil.front.compare {
        CompareFunction::Equal => true,
        CompareFunction::NotEqual => false,
        _ => {
            let cleared = before.map(|pass| pass.depth_stencil.as_ref()?.clear_stencil).find_map(|cleared| cleared);
            stencil_passes(raster, true, cleared.unwrap_or(0))
        }
    }
}

/// Returns the index of the first pass of a light that asks for its count: what is counted later is not in its shadow.
pub(super) fn asking_pass(plan: &FramePlan, light: LightId) -> Option<usize> {
    let asks = |pass: &Pass| {
        let is_of_light = pass.light == Some(light) && plan.is_of_picture(pass);
        is_of_light && pass.draws.iter().any(|draw| draw.raster.stencil.is_enabled() && !draw.part.is_of_volume())
    };
    plan.passes.iter().position(asks)
}

/// Returns the state of the first draw of a pass that tests the stencil and combines what it draws with what is stored so
/// that it may get darker. What replaces the stored colours says nothing by being darker than they were.
fn blending(pass: &Pass) -> Option<&RasterState> {
    let may_darken =
        |color: ColorWrite| matches!(color, ColorWrite::Blend | ColorWrite::Multiply | ColorWrite::Minimum);
    let testing = pass.draws.iter().filter(|draw| draw.raster.stencil.is_enabled() && !draw.part.is_of_volume());
    testing.map(|draw| &draw.raster).find(|raster| may_darken(raster.color))
}

/// Returns the picture after the step, or after the nearest one before it that has it.
fn frame(steps: &[Step], index: usize) -> Option<&FrameSnapshot> {
    steps.get(..=index)?.iter().rev().find_map(|step| match &step.snapshot {
        Snapshot::Frame(frame) => Some(frame),
        Snapshot::Map { .. } => None,
    })
}

/// Returns the sum of red, green and blue bytes, over rows of four bytes a pixel. Where the stencil test fails nothing
/// changes: a difference of sums is one over the pixels where it passes.
fn brightness<'a>(rows: impl Iterator<Item = &'a [u8]>) -> i64 {
    rows.flat_map(|row| row.chunks_exact(4))
        .map(|pixel| pixel[..3].iter().map(|byte| i64::from(*byte)).sum::<i64>())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::brightness;

    #[test]
    fn brightness_is_of_colours_without_alpha() {
        let rows: [&[u8]; 2] = [&[1, 2, 3, 255, 4, 5, 6, 0], &[10, 0, 0, 7]];
        assert_eq!(brightness(rows.into_iter()), 31);
    }
}
