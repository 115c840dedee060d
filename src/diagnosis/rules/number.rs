//! What single precision and parts of a pixel can't tell.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{Case, Facts, Rule, Suspicion};
use crate::diagnosis::mend::Mend;
use crate::numbers;
use crate::plan::Part;
use crate::scene::Object;

pub(crate) const RULES: &[Rule] = &[f32_limit, subpixel_edges];

/// Half a unit in the last place of 24 bits, as a part of the number.
const ROUNDING: f64 = 6e-8;
/// Edges that rounding moves by so many pixels are wrong without an excuse.
const PIXELS: f64 = 0.5;

/// Edges as long as this many pixels have sides that no snapping tilts far.
const SHORT_EDGE: f64 = 1.0;
/// Times as large as pictures are drawn that show whether corners of sides were snapped away. Odd, so that the middle of
/// each pixel stays the middle of one.
const LARGER: [u32; 3] = [3, 5, 15];
/// Pixels along a side of the largest picture that every GPU draws.
const MOST_SIDE: u32 = 8192;

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

/// Corners snap to 1/256 of a pixel. Where a caster's edges are fractions of one, so do those of its volume's sides, narrow
/// strips that reach far: their depth tilts, and they meet a surface beside their place.
fn subpixel_edges(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let light = case.light();
    if !facts.counts_volumes(light) {
        return None;
    }
    let ((name, edge), shown_by) = case.shown(|sample| {
        let (name, ..) = sample.miscounted(facts, light).into_iter().next()?;
        let (_, object) = facts.object(&name)?;
        let edge = usual_edge(facts, object)?;
        (edge <= SHORT_EDGE).then_some((name, edge))
    })?;
    let evidence = format!(
        "half of the edges of {name} are shorter than {} pixels from here, and corners snap to 1/256 of a pixel",
        numbers::digits(edge)
    );
    let fits = |times: &u32| facts.plan.size.iter().all(|side| side * times <= MOST_SIDE);
    let mends = LARGER.into_iter().filter(fits).map(Mend::larger).collect();
    Suspicion::new(Cause::SubpixelEdges, evidence, mends, shown_by)
}

/// The median length of an object's edges, in pixels where its nearest corner is.
fn usual_edge(facts: &Facts, object: &Object) -> Option<f64> {
    let world = object.world_positions();
    let nearest = world.iter().map(|point| facts.tracer.depth_of(*point)).fold(f64::INFINITY, f64::min);
    let corners = object.mesh.triangles().iter();
    let mut lengths: Vec<f64> = corners.map(|[a, b, _]| world[*a as usize].distance(world[*b as usize])).collect();
    let middle = lengths.len() / 2;
    let (_, median, _) = (middle < lengths.len()).then(|| lengths.select_nth_unstable_by(middle, f64::total_cmp))?;
    (nearest > 0.0).then(|| *median / facts.pixel_width(nearest))
}
