//! Modulative shadows: passes that darken a picture already lit, where shadow volumes are counted.

use crate::capture::{FrameSnapshot, Snapshot, Step};
use crate::plan::{ColorWrite, FramePlan, Pass};

/// Returns whether a pass of a light takes light away where its stencil test passes, instead of adding it: its draws blend
/// with what is stored, and the stored colours got darker on the whole. Blend states alone do not tell: the same state
/// darkens with one source colour and brightens with another. False where the colours are not known. `steps` are those
/// of the plan's passes.
pub fn darkens(plan: &FramePlan, steps: &[Step], index: usize) -> bool {
    let Some(pass) = plan.passes.get(index) else { return false };
    let is_of_light = pass.light.is_some() && plan.is_of_picture(pass);
    let (Some(before), Some(after)) =
        (index.checked_sub(1).and_then(|before| frame(steps, before)), frame(steps, index))
    else {
        return false;
    };
    let change = || brightness(after.color.image.rows()) - brightness(before.color.image.rows());
    is_of_light && blends_where_tested(pass) && !after.color.unchanged && change() < 0
}

/// Returns whether a draw of the pass tests the stencil, and what it draws is combined with what is stored so that it may
/// get darker. What replaces the stored colours says nothing by being darker than they were.
fn blends_where_tested(pass: &Pass) -> bool {
    let may_darken =
        |color: ColorWrite| matches!(color, ColorWrite::Blend | ColorWrite::Multiply | ColorWrite::Minimum);
    pass.draws
        .iter()
        .filter(|draw| draw.raster.stencil.is_enabled() && !draw.part.is_of_volume())
        .any(|draw| may_darken(draw.raster.color))
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
