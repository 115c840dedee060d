//! Shadow maps that answer wrongly: texels that are too coarse, biases that are too small or too large, faces that the
//! map leaves out, surfaces beyond its border. Each rule reads the comparison at the region's samples.

use super::map_comparison::{MapComparison, look};
use super::texels::larger;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause, amount};
use crate::diagnosis::fix::{Fix, PlanEdit};
use crate::geometry::light_frame::LightFrustum;
use crate::math::{Sign, side_of_triangle};
use crate::numbers;
use crate::plan::DrawPart;
use crate::technique::{MapSettings, Technique};
use wgpu_types::Face;

pub(crate) const RULES: &[CauseRule] = &[acne, peter_panning, map_faces_culled, aliasing, outside_map];

/// Biases that are enough for nearly any surface: constant and slope.
const USUAL_BIAS: (i32, f64) = (16, 2.0);

/// Returns the map comparison at the first sample whose cause is `cause`, and at how many samples it is; `None` where
/// it is at none.
fn shown(facts: &FrameFacts, case: &RegionSamples, cause: Cause) -> Option<(MapComparison, usize)> {
    case.shown(|sample| {
        let look = look(facts, case.light(), case.region.key.kind, &sample.seen?)?;
        (look.cause == cause).then_some(look)
    })
}

/// Returns a fix that sets `bias-constant` and `bias-slope`.
fn bias(constant: i32, slope: f64) -> Fix {
    let mut fix = Fix::setting("bias-slope", &format!("{slope}"));
    fix.settings.insert("bias-constant".to_owned(), constant.to_string());
    fix
}

fn acne(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (look, shown_by) = shown(facts, case, Cause::Acne)?;
    let sentence = format!(
        "a texel is {} wide here, over which the surface gets {} farther from the light: what the texel shows lies {} \
         before the surface here, and the bias is {}",
        numbers::metres(look.texel),
        numbers::metres(look.slope),
        numbers::metres(look.gap.max(0.0)),
        numbers::metres(look.bias.max(0.0))
    );
    let enough = Quantity::less_than("the bias, in metres", look.bias, look.gap + look.rounding);
    let steps = [USUAL_BIAS, (64, 4.0), (256, 8.0)];
    let MapSettings { bias_constant: constant, bias_slope: slope, .. } = facts.map();
    let more = steps.into_iter().filter(|(c, s)| *c > constant || *s > slope);
    let mut fixes: Vec<Fix> = more.map(|(c, s)| bias(c.max(constant), s.max(slope))).collect();
    // Back faces stand behind the surface that the light sees, where there are some: an open caster would lose its shadow. They
    // are tried before more than the usual bias, which takes shadows off what casts them.
    let casters = facts.draws(case.light(), DrawPart::Map).filter_map(|draw| facts.object(draw.caster.as_deref()?));
    if facts.map().cull.is_none() && { casters }.all(|(index, _)| facts.meshes[index].is_closed()) {
        let is_less_than_usual = constant < USUAL_BIAS.0 || slope < USUAL_BIAS.1;
        fixes.insert(usize::from(is_less_than_usual), Fix::setting("cull", "front"));
    }
    fixes.push(Fix::technique(Technique::ZFail));
    Some(SuspectedCause::new(Cause::Acne, case.evidence(sentence, shown_by, [enough]), fixes))
}

fn peter_panning(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (look, shown_by) = shown(facts, case, Cause::PeterPanning)?;
    let MapSettings { bias_constant: constant, bias_slope: slope, bias_normal: normal, cull, .. } = facts.map();
    let sentence = match normal {
        texels if texels > 0.0 => format!(
            "the surface is looked up {} of {} along its normal, and the caster is only {} before it",
            texels,
            numbers::metres(look.texel),
            numbers::metres(look.gap)
        ),
        _ if look.bias.is_infinite() => format!(
            "the bias moves the caster past all depths of the map, and the surface is {} behind it",
            numbers::metres(look.gap)
        ),
        _ => format!(
            "the bias moves the caster {} away from the light, and the surface is only {} behind it; a texel is {} wide",
            numbers::metres(look.bias),
            numbers::metres(look.gap),
            numbers::metres(look.texel)
        ),
    };
    let too_much = Quantity::at_least("the bias, in metres", look.bias, look.gap - look.rounding);
    let steps = [USUAL_BIAS, (16, 1.0), (4, 0.5)];
    let less = steps.into_iter().filter(|(c, s)| *c < constant || *s < slope);
    let mut fixes: Vec<Fix> = less.map(|(c, s)| bias(c.min(constant), s.min(slope))).collect();
    if normal != 0.0 {
        fixes = vec![Fix::setting("bias-normal", "0")];
    }
    // Where the faces that the light sees are left out, those that are kept may touch the surface.
    if cull.is_some() {
        fixes.push(Fix::setting("cull", "none"));
    }
    // A slope bias and a normal offset are so many texels' slopes or widths: with smaller texels they are less. The
    // sentence says so, as this remedy is no other bias.
    fixes.extend(larger(facts.texels(), 8192.0));
    let grows =
        if slope > 0.0 || normal > 0.0 { "; it grows with the texel, so a larger map has less of it" } else { "" };
    let sentence = sentence + grows;
    Some(SuspectedCause::new(Cause::PeterPanning, case.evidence(sentence, shown_by, [too_much]), fixes))
}

fn map_faces_culled(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (look, shown_by) = shown(facts, case, Cause::MapFacesCulled)?;
    let MapSettings { bias_constant: constant, bias_slope: slope, cull, .. } = facts.map();
    let cull = cull?;
    let object = facts.scene.objects.get(look.caster?)?;
    let (world, light) = (object.world_positions(), facts.tracer.light_position(case.light()));
    let culled = if cull == Face::Front { Sign::Positive } else { Sign::Negative };
    let triangles = object.mesh.triangles();
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| world[vertex as usize]);
    let of_caster = triangles.iter().filter(|triangle| side_of_triangle(corners(triangle), light) == culled).count();
    let side = if cull == Face::Front { "front" } else { "back" };
    let sentence = format!(
        "the map leaves out {side} faces, {of_caster} of the {} of {}: {} between light and surface, and no other face \
         of any caster",
        amount(triangles.len() as u64, "triangle"),
        object.name,
        match look.left_out {
            1 => "1 of them lies".to_owned(),
            count => format!("{count} faces so left out lie"),
        }
    );
    let quantities = [
        Quantity::at_least("triangles between light and surface that the map leaves out", look.left_out as f64, 1.0),
        Quantity::at_most("triangles between light and surface that the map keeps", look.kept as f64, 0.0),
    ];
    let (usual, usual_slope) = USUAL_BIAS;
    let mut fixes = vec![Fix::setting("cull", "none")];
    // Faces that the light sees need a bias, which a map without them may do without.
    if constant < usual || slope < usual_slope {
        fixes.push(Fix::setting("cull", "none").and(&bias(constant.max(usual), slope.max(usual_slope))));
    }
    Some(SuspectedCause::new(Cause::MapFacesCulled, case.evidence(sentence, shown_by, quantities), fixes))
}

fn aliasing(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ((look, pixels), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let look = look(facts, case.light(), case.region.key.kind, &seen)?;
        let pixels = look.texel / facts.pixel_width(facts.tracer.depth_of(seen.point));
        (look.cause == Cause::Aliasing).then_some((look, pixels))
    })?;
    let sentence = format!(
        "a texel is {} wide here, {} pixels of the picture, and the outline of the shadow runs through it",
        numbers::metres(look.texel),
        numbers::digits(pixels)
    );
    let runs_through =
        Quantity::at_least("of nine points of the texel, those where the truth is another", look.unlike as f64, 1.0);
    let fixes = larger(facts.texels(), 8192.0);
    Some(SuspectedCause::new(Cause::Aliasing, case.evidence(sentence, shown_by, [runs_through]), fixes))
}

fn outside_map(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (look, shown_by) = shown(facts, case, Cause::OutsideMap).filter(|_| case.is_missing())?;
    let place = match look.place.is_finite() {
        true => format!("{} times as far from the map's middle as its border", numbers::digits(look.place)),
        false => "behind what the map looks at".to_owned(),
    };
    let sentence = format!("the surface lies {place}, where nothing is looked up");
    let beyond = Quantity::more_than("the distance from the map's middle, where its border is at 1", look.place, 1.0);
    // A frustum that settings give is wrong by the settings, a fitted one by what became of the plan.
    let is_fitted = facts.map().frustum == LightFrustum::Casters;
    let fit = if is_fitted { Fix::plan(PlanEdit::Refit) } else { super::frustum::fitted() };
    let fixes = vec![fit, Fix::technique(Technique::ZFail)];
    Some(SuspectedCause::new(Cause::OutsideMap, case.evidence(sentence, shown_by, [beyond]), fixes))
}
