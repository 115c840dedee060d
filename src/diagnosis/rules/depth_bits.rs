//! Depths of so few bits, or stored in so narrow a range, that places that are apart are stored alike.
//!
//! Flooring keeps the order of depths, so it can change a depth test only where it makes two different depths equal: a
//! triangle and the surface that it is tested against lie within one step. A map's depths are floored when they are
//! stored, and not when they are compared, so there the two lie within one step as well.

use super::map_comparison;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, PixelSample, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::Fix;
use crate::history::TriangleEvent;
use crate::math::depth::DepthCurve;
use crate::math::{DepthBits, Plane};
use crate::numbers;
use crate::truth::SeenSurface;

pub(crate) const RULES: &[CauseRule] = &[depth_precision, depth_range];

/// Distances below this part of the distance from the eye are rounding of 32-bit floats.
const ROUNDING: f64 = 1e-6;

/// Two places that a depth test could not tell apart.
struct EqualDepths {
    /// What was measured, in a sentence without its stop.
    sentence: String,
    /// How far the two are apart, in steps of depth.
    steps: f64,
}

fn depth_precision(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let curve = facts.plan.depth;
    let bits = curve.bits?;
    let in_view = |sample: &PixelSample| {
        let seen = sample.seen?;
        nothing_stored(facts, curve, bits, &seen).or_else(|| {
            let history = sample.history.as_ref()?;
            let tested = history.triangles().filter(|(event, one)| {
                let is_of_light = event.light.is_none_or(|light| light == case.light());
                is_of_light && event.is_from_camera && one.depth == event.before.depth
            });
            let mut measured = tested.filter_map(|(_, one)| equal_depths(facts, curve, bits, &seen, one));
            measured.next()
        })
    };
    let in_map = |sample: &PixelSample| {
        let seen = sample.seen?;
        let [steps, step] = map_comparison::steps_apart(facts, case.light(), case.region.key.kind, &seen, bits)?;
        let sentence = format!(
            "the light's map has depths of {bits} bits: the surface and what its texel stores are {} apart, and a step is \
             {} there",
            in_steps(steps),
            numbers::metres(step)
        );
        (steps <= 1.0).then_some(EqualDepths { sentence, steps })
    };
    let (found, shown_by) = case.shown(|sample| in_view(sample).or_else(|| in_map(sample)))?;
    let apart = Quantity::at_most("steps of depth between what was compared", found.steps, 1.0);
    let more = ["24", "32"].into_iter().filter(|more| *more != bits.to_string());
    let fixes = more.map(|more| Fix::setting("depth-bits", more)).collect();
    Some(SuspectedCause::new(Cause::DepthPrecision, case.evidence(found.sentence, shown_by, [apart]), fixes))
}

/// Depths that the viewport's range puts so near each other that a float can't tell them apart.
fn depth_range(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let curve = facts.plan.depth;
    let range = curve.range.filter(|_| curve.bits.is_none())?;
    let [near, far] = range.stored;
    let equal = |sample: &PixelSample| {
        let (seen, history) = (sample.seen?, sample.history.as_ref()?);
        let tested = history.triangles().filter(|(event, one)| {
            let is_of_light = event.light.is_none_or(|light| light == case.light());
            is_of_light && event.is_from_camera && one.depth == event.before.depth
        });
        let mut measured = tested.filter_map(|(_, one)| {
            let [here, there, away] = apart(facts, &seen, one)?;
            let step = f64::from(one.depth.next_up() - one.depth);
            let steps = (curve.depth(there) - curve.depth(here)).abs() / step;
            let sentence = format!(
                "a triangle of {} lies {} {} the surface here, and both have the depth {}: the depth range {near} to {far} \
                 stores {}",
                one.draw_name,
                numbers::metres(away.abs()),
                if away < 0.0 { "before" } else { "behind" },
                numbers::depth(one.depth),
                if near == far { "all depths as one" } else { "them less than a float's step apart" }
            );
            (steps <= 1.0).then_some(EqualDepths { sentence, steps })
        });
        measured.next()
    };
    let (found, shown_by) = case.shown(equal)?;
    let apart = Quantity::at_most("steps of depth between what was compared", found.steps, 1.0);
    let fixes = vec![Fix::setting("depth-range", "0,1")];
    Some(SuspectedCause::new(Cause::DepthPrecision, case.evidence(found.sentence, shown_by, [apart]), fixes))
}

/// Measures how far from a surface a triangle lies along the view's ray through it, of which all depths are equal; `None`
/// where that is rounding of floats, or more than a step.
fn equal_depths(
    facts: &FrameFacts,
    curve: DepthCurve,
    bits: DepthBits,
    seen: &SeenSurface,
    one: &TriangleEvent,
) -> Option<EqualDepths> {
    let [here, there, away] = apart(facts, seen, one)?;
    let steps = (curve.depth(there) - curve.depth(here)).abs() * f64::from(bits.steps());
    let sentence = format!(
        "a triangle of {} lies {} {} the surface here, and both have the depth {} of {}: one step is {}",
        one.draw_name,
        numbers::metres(away.abs()),
        if away < 0.0 { "before" } else { "behind" },
        numbers::count((f64::from(one.depth) * f64::from(bits.steps())).round() as u64),
        numbers::count(bits.steps().into()),
        numbers::metres(step_at(curve, here, bits))
    );
    (steps <= 1.0).then_some(EqualDepths { sentence, steps })
}

/// Returns the distances along the view's axis of a surface and of a triangle where the view's ray through the surface meets
/// it, and how much farther that is along the ray, negative for nearer, metres; `None` where that is rounding of floats.
fn apart(facts: &FrameFacts, seen: &SeenSurface, one: &TriangleEvent) -> Option<[f64; 3]> {
    let plane = Plane::through_homogeneous(one.corners, facts.scene.camera.eye)?;
    let from_eye = facts.scene.camera.eye_position();
    let along = match from_eye.w {
        0.0 => -from_eye.truncate().normalize_or_zero(),
        _ => (seen.point - facts.eye()).normalize_or_zero(),
    };
    let away = -plane.at(seen.point.extend(1.0)) / plane.normal.dot(along);
    let place = |metres: f64| facts.tracer.depth_of(seen.point + along * metres);
    let [here, there] = [0.0, away].map(place);
    (away.is_finite() && away.abs() > ROUNDING * here.abs()).then_some([here, there, away])
}

/// Returns evidence where a surface is so far away that its reversed depth is stored as if nothing were drawn; else `None`.
fn nothing_stored(facts: &FrameFacts, curve: DepthCurve, bits: DepthBits, seen: &SeenSurface) -> Option<EqualDepths> {
    let away = facts.tracer.depth_of(seen.point);
    let steps = curve.depth(away) * f64::from(bits.steps());
    let sentence = format!(
        "{} lies {} away, where depth is {}: less than one is stored as if nothing were drawn",
        facts.tracer.name(seen.place),
        numbers::metres(away),
        in_steps(steps)
    );
    (curve.mapping.is_reversed() && steps < 1.0).then_some(EqualDepths { sentence, steps })
}

fn in_steps(steps: f64) -> String {
    format!("{} of a step", numbers::digits(steps))
}

/// Returns how many metres one step of depth is long at a distance along the view.
fn step_at(curve: DepthCurve, distance: f64, bits: DepthBits) -> f64 {
    let slope = if curve.is_linear { curve.scale } else { curve.scale / (distance * distance) };
    1.0 / (slope.abs() * f64::from(bits.steps()))
}
