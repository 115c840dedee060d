//! Surfaces in one plane that a light pass lights each.

use crate::capture::{Capture, FrameTarget, Snapshot};
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause, amount, listed};
use crate::diagnosis::fix::Fix;
use crate::plan::{ColorWrite, DrawPart, FramePlan, Pass};
use std::collections::BTreeSet;
use wgpu_types::{CompareFunction, StencilOperation};

pub(crate) const RULES: &[CauseRule] = &[double_lighting];

/// Returns the plan with light passes that raise the stencil where they add light, so that each pixel is lit once; `None`
/// where all that test the stencil do so already.
pub(crate) fn guarded(plan: &FramePlan) -> Option<FramePlan> {
    let is_unguarded = |pass: &Pass| {
        let tests = |compare| compare == CompareFunction::Equal;
        let leaves = pass.draws.iter().any(|draw| {
            let face = draw.raster.face(true).0;
            tests(face.compare) && face.pass_op == StencilOperation::Keep && draw.raster.color == ColorWrite::Add
        });
        pass.timed && pass.light.is_some() && leaves
    };
    if !plan.passes.iter().any(is_unguarded) {
        return None;
    }
    let mut guarded = plan.clone();
    for draw in guarded.passes.iter_mut().filter(|pass| is_unguarded(pass)).flat_map(|pass| &mut pass.draws) {
        draw.raster.stencil.write_mask = 0xff;
        draw.raster.stencil.front.pass_op = StencilOperation::IncrementClamp;
        draw.raster.stencil.back.pass_op = StencilOperation::IncrementClamp;
    }
    Some(guarded)
}

/// Returns the row-major indices, ascending, of the pixels that a light's pass leaves brighter in one frame than in the
/// same frame with guarded light passes.
pub(crate) fn lit_twice(plan: &FramePlan, capture: &Capture, guarded: &Capture, light: usize) -> Vec<usize> {
    let lights = |(_, pass): &(usize, &Pass)| {
        let adds = pass.draws.iter().any(|draw| draw.raster.color == ColorWrite::Add);
        pass.timed && pass.light.is_some_and(|of| of.0 == light) && adds
    };
    let mut found = BTreeSet::new();
    for (index, _) in plan.passes.iter().enumerate().filter(lights) {
        let color = |capture: &Capture, step: usize| match &capture.steps.get(step)?.snapshot {
            Snapshot::Frame(frame) => Some(frame.color.clone()),
            Snapshot::Map { .. } => None,
        };
        let Some(before) = index.checked_sub(1) else { continue };
        // What an earlier light has lit twice is no fault of this one.
        let rise = |capture: &Capture| Some([color(capture, before)?, color(capture, index)?]);
        let (Some([before, after]), Some([guarded_before, guarded_after])) = (rise(capture), rise(guarded)) else {
            continue;
        };
        let width = after.image.size()[0] as usize;
        let rows = before.image.rows().zip(after.image.rows());
        let guarded_rows = guarded_before.image.rows().zip(guarded_after.image.rows());
        for (y, ((before, after), (guarded_before, guarded_after))) in rows.zip(guarded_rows).enumerate() {
            for x in 0..width {
                let is_brighter = (x * 4..x * 4 + 3).any(|byte| {
                    before[byte] <= guarded_before[byte].saturating_add(1)
                        && after[byte] > guarded_after[byte].saturating_add(1)
                });
                if is_brighter {
                    found.insert(y * width + x);
                }
            }
        }
    }
    found.into_iter().collect()
}

fn double_lighting(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if case.region.key.kind != RegionKind::LitTwice {
        return None;
    }
    let light = case.light();
    let (surfaces, shown_by) = case.shown(|sample| {
        let lit = sample.history.as_ref()?.triangles().filter(|(event, one)| {
            let is_lit = one.lights.is_some() && one.outcome.passed() && one.part == DrawPart::Surface;
            is_lit && event.light == Some(light) && event.target == FrameTarget::Picture
        });
        let names: Vec<String> = lit.map(|(_, one)| one.draw_name.clone()).collect();
        (names.len() > 1).then_some(names)
    })?;
    let depth = facts.capture.depth.mapping.name();
    let sentence = format!(
        "{} pass the light's tests at this pixel, those of {}: their depths are equal ({depth}), and no count rises after \
         the first",
        amount(surfaces.len() as u64, "triangle"),
        listed(&surfaces.iter().cloned().collect::<BTreeSet<_>>())
    );
    let twice = Quantity::at_least("triangles that add the light to the pixel", surfaces.len() as f64, 2.0);
    let evidence = case.evidence(sentence, shown_by, [twice]);
    Some(SuspectedCause::new(Cause::DoubleLighting, evidence, vec![Fix::setting("relight", "guarded")]))
}
