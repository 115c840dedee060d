//! What single precision and parts of a pixel can't tell.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{Case, Facts, Rule, Suspicion};
use crate::diagnosis::mend::Mend;
use crate::math::side_of_triangle;
use crate::numbers;
use crate::plan::Part;
use crate::scene::Object;
use glam::{DVec3, DVec4};
use rayon::prelude::*;

pub(crate) const RULES: &[Rule] = &[f32_limit, side_through_middle, subpixel_edges];

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

/// Roundings between a corner and the depths that are compared: of its position, its place in the picture, the side's
/// depth there and the surface's.
const ROUNDINGS: f64 = 4.0;

/// A side that meets the surface in the very middle of a pixel, as near as positions are rounded, is counted or not by
/// chance. Where a shadow ends there, the truth's edge excuses that; where another shadow begins, a hole is left in both.
fn side_through_middle(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let light = case.light();
    if !facts.counts_volumes(light) {
        return None;
    }
    let ((name, at, pixels, rounding), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let depth = facts.tracer.depth_of(seen.point);
        let width = facts.pixel_width(depth);
        let casting = facts.scene.objects.iter().filter(|object| object.casts);
        let rounding = ROUNDING * depth;
        let nearest = |object: &Object| {
            let most = ROUNDINGS * rounding;
            let side = nearest_side(object, seen.point, facts.tracer.light_position(light), most)?;
            Some((object.name.clone(), side.metres / width, rounding * side.lever / width))
        };
        let (name, pixels, rounding) = casting.filter_map(nearest).min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((name, sample.pixel, pixels, rounding))
    })?;
    let [column, row] = at;
    let near = if pixels < 1e-6 { "less than 1e-6".to_owned() } else { numbers::digits(pixels) };
    let evidence = format!(
        "a side of {name}'s volume passes {near} pixels from the middle of pixel {column},{row}, and rounding positions to 24 \
         bits moves it by {} each time",
        numbers::digits(rounding)
    );
    Suspicion::new(Cause::F32Limit, evidence, Vec::new(), shown_by)
}

/// How near a side of a volume passes.
struct NearSide {
    /// Square to the light's way.
    metres: f64,
    /// How much farther the side moves there than its edge does.
    lever: f64,
}

/// The side of an object's volume that passes a point that is seen nearer than so many metres, times its lever.
fn nearest_side(object: &Object, seen: DVec3, light: DVec4, most: f64) -> Option<NearSide> {
    let to_light = light.truncate() - seen * light.w;
    let (towards, reach) = (to_light.normalize_or_zero(), to_light.length());
    let world = object.world_positions();
    // Along the light's way onto the plane through the point that is square to it; what is not between throws nothing.
    let thrown = |corner: u32| {
        let away = world[corner as usize] - seen;
        let above = away.dot(towards);
        let lever = if light.w == 0.0 { 1.0 } else { reach / (reach - above) };
        (above > 0.0 && lever > 0.0 && lever.is_finite()).then_some(((away - towards * above) * lever, lever))
    };
    let near = |[a, b]: [u32; 2]| {
        let ((from, lever), (to, other)) = (thrown(a)?, thrown(b)?);
        let along = to - from;
        let part = (-from.dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let side = NearSide { metres: (from + along * part).length(), lever: lever.max(other) };
        (side.metres <= most * side.lever).then_some(side)
    };
    let triangles = object.mesh.triangles();
    let edges_of = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    // An edge is none of a side's where the triangles around it, turned towards the light, run along it to and fro alike.
    let has_side = |[low, high]: [u32; 2]| {
        let along = |corners: &[u32; 3]| {
            let towards_high = edges_of(*corners)
                .iter()
                .fold(0, |sum, edge| sum + i32::from(*edge == [low, high]) - i32::from(*edge == [high, low]));
            let turned = || side_of_triangle(corners.map(|index| world[index as usize]), light).value();
            if towards_high == 0 { 0 } else { towards_high * turned() }
        };
        triangles.iter().map(along).sum::<i32>() != 0
    };
    let found =
        triangles.par_iter().flat_map_iter(|corners| edges_of(*corners)).filter_map(|edge| Some((edge, near(edge)?)));
    let found: Vec<([u32; 2], NearSide)> = found.collect();
    let sides = found.into_iter().filter(|(edge, _)| has_side(*edge)).map(|(_, side)| side);
    sides.min_by(|a, b| a.metres.total_cmp(&b.metres))
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
