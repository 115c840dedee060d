//! What single precision can't tell.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{Case, Facts, Rule, Suspicion};
use crate::numbers;
use crate::plan::Part;

pub(crate) const RULES: &[Rule] = &[f32_limit];

/// Half a unit in the last place of 24 bits, as a part of the number.
const ROUNDING: f64 = 6e-8;
/// Edges that rounding moves by so many pixels are wrong without an excuse.
const PIXELS: f64 = 0.5;

/// Positions are rounded when they go to the GPU; where light grazes, that moves a shadow's edge by the
/// rounding over the tangent of the light's height, for a lamp farther the nearer the caster is to it.
fn f32_limit(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let light = case.light();
    let is_geometric = facts.counts_volumes(light) || facts.draws(light, Part::PlanarShadow).next().is_some();
    if !is_geometric {
        return None;
    }
    let ((name, height, rounding, moved), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let towards = facts.tracer.towards(light, seen.point);
        let normal = (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]).normalize_or_zero();
        let sine = normal.dot(towards).abs();
        let depth = (seen.point - facts.scene.camera.eye).length();
        let rounding = ROUNDING * depth;
        let distance = facts.tracer.light_distance(light, seen.point);
        let nearest = sample.between.last().map_or(distance, |met| distance - met.towards_light);
        let lever = if distance.is_finite() { distance / nearest.max(f64::MIN_POSITIVE) } else { 1.0 };
        let moved = rounding * lever / sine.max(f64::MIN_POSITIVE);
        let pixels = moved / facts.pixel_width(facts.tracer.depth_of(seen.point));
        let height = sine.min(1.0).asin().to_degrees();
        (pixels >= PIXELS).then(|| (facts.tracer.name(seen.place).to_owned(), height, rounding, pixels))
    })?;
    let evidence = format!(
        "the light stands {}° over the plane of {name}: rounding positions to 24 bits, {} here, moves a shadow's edge \
         by {} pixels",
        numbers::digits(height),
        numbers::metres(rounding),
        numbers::digits(moved)
    );
    Suspicion::new(Cause::F32Limit, evidence, Vec::new(), shown_by)
}
