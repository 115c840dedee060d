//! Faults of single precision and of subpixel snapping.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::Fix;
use crate::math::side_of_triangle;
use crate::numbers;
use crate::plan::DrawPart;
use crate::scene::Object;
use glam::{DVec3, DVec4};
use rayon::prelude::*;
use std::collections::HashMap;

pub(crate) const RULES: &[CauseRule] = &[f32_limit, subpixel_edges];

/// The relative rounding error of single precision (24 bits): half a unit in the last place.
const ROUNDING: f64 = 6e-8;
/// Rounding is the cause where it moves a shadow's edge by this many pixels or more.
const PIXELS: f64 = 0.5;

/// Edges of at least this many pixels rarely have sides so narrow that snapping tilts them far.
const SHORT_EDGE: f64 = 2.0;
/// Factors by which the picture is enlarged to show whether corners of sides were snapped away; odd, so that each
/// pixel's centre stays the centre of one.
const LARGER: [u32; 3] = [3, 5, 15];
/// The largest side, in pixels, of a picture that every GPU can draw.
const MOST_SIDE: u32 = 8192;

/// Looks for errors of rounding to single precision: light that grazes a surface and, only where volumes are counted,
/// sides through a pixel's centre, in this order. There is no fix, so the numbers must convince.
fn f32_limit(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    // Only techniques that count volumes have sides that pass near a pixel, or faces that it can miss.
    let looks: &[CauseRule] =
        if facts.counts_volumes(case.light()) { &[grazed, side_through_middle] } else { &[grazed] };
    looks.iter().find_map(|look| look(facts, case))
}

/// Looks for light that grazes a surface: rounding positions then moves a shadow's edge by the rounding over the sine
/// of the light's height, times a lever for casters near a point light. `None` for techniques other than volumes and
/// planar shadows, or where the edge moves less than `PIXELS` pixels.
fn grazed(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let is_geometric = facts.counts_volumes(light) || facts.draws(light, DrawPart::PlanarShadow).next().is_some();
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
        let nearest = sample.between.last().map_or(distance, |hit| distance - hit.towards_light);
        let lever = if distance.is_finite() { distance / nearest.max(f64::MIN_POSITIVE) } else { 1.0 };
        let moved = rounding * lever / sine.max(f64::MIN_POSITIVE);
        let pixels = moved / facts.pixel_width(facts.tracer.depth_of(seen.point));
        let height = sine.min(1.0).asin().to_degrees();
        (pixels >= PIXELS).then(|| (facts.tracer.name(seen.place).to_owned(), height, rounding, pixels))
    })?;
    let sentence = format!(
        "the light stands {}° over the plane of {name}: rounding positions to 24 bits, {} here, moves a shadow's edge \
         by {} pixels",
        numbers::digits(height),
        numbers::metres(rounding),
        numbers::digits(moved)
    );
    let far = Quantity::at_least("how far rounding moves the shadow's edge, in pixels", moved, PIXELS);
    Some(SuspectedCause::new(Cause::F32Limit, case.evidence(sentence, shown_by, [far]), Vec::new()))
}

/// How many roundings there are between a corner and the depths that are compared: position, place in the picture, the
/// side's depth and the surface's.
const ROUNDINGS: f64 = 4.0;

/// Looks for a volume's side that passes the surface at a pixel's centre within rounding, so that it is counted or not
/// by chance. `None` unless every sample shows it: a whole region has another cause.
fn side_through_middle(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let ((name, at, pixels, rounding), shown_by) = case.shown(|sample| {
        let seen = sample.seen?.point;
        let width = facts.pixel_width(facts.tracer.depth_of(seen));
        let nearest = |(name, ..): (String, i32, i32)| {
            let side = nearest_side(facts, facts.object(&name)?.1, seen, facts.tracer.light_position(light))?;
            Some((name, side.metres / width, side.rounding / width))
        };
        let sides = sample.miscounted(facts, light).into_iter().filter_map(nearest);
        let (name, pixels, rounding) = sides.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((name, sample.pixel, pixels, rounding))
    })?;
    let words = if pixels < 1e-6 { "less than 1e-6".to_owned() } else { numbers::digits(pixels) };
    let [column, row] = at;
    let sentence = format!(
        "a side of {name}'s volume passes {words} pixels, measured across the light, from the middle of pixel \
         {column},{row}, and rounding positions to 24 bits moves it by {} each time",
        numbers::digits(rounding)
    );
    let near =
        Quantity::at_most("the side's distance from the pixel's middle, in pixels", pixels, ROUNDINGS * rounding);
    // By chance one pixel of many is at such a place: a whole wrong region has another cause.
    let is_everywhere = shown_by == case.samples.len();
    let evidence = case.evidence(sentence, shown_by, [near]);
    is_everywhere.then(|| SuspectedCause::new(Cause::F32Limit, evidence, Vec::new()))
}

/// The distance of a volume's side from a point.
#[derive(Clone, Copy)]
struct NearSide {
    /// Distance at right angles to the light's direction, metres.
    metres: f64,
    /// How far rounding a corner once moves the side there, metres.
    rounding: f64,
}

/// Returns the nearest side of an object's volume that passes the point `seen` within its rounding error; `None` where
/// none does.
fn nearest_side(facts: &FrameFacts, object: &Object, seen: DVec3, light: DVec4) -> Option<NearSide> {
    let to_light = light.truncate() - seen * light.w;
    let towards = to_light.normalize_or_zero();
    let reach = if light.w == 0.0 { f64::INFINITY } else { to_light.length() };
    let world = object.world_positions();
    let eye = facts.scene.camera.eye;
    let near = |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|index| world[index as usize]);
        let [from, to] = [a, b].map(|corner| (corner - seen).dot(towards));
        // The part of the edge that is between the point and the light.
        let crossing = |height: f64| ((height - from) / (to - from)).clamp(0.0, 1.0);
        let ends = match (from <= to, from == to) {
            (_, true) => [0.0, 1.0],
            (true, _) => [crossing(0.0), crossing(reach)],
            (false, _) => [crossing(reach), crossing(0.0)],
        };
        let tiny = 1e-9 * (from.abs() + to.abs());
        let thrown = |part: f64| {
            let away = a.lerp(b, part) - seen;
            let above = away.dot(towards);
            let lever = if reach.is_finite() { reach / (reach - above) } else { 1.0 };
            (above >= -tiny && above < reach).then_some(((away - towards * above) * lever, lever))
        };
        // Points just short of the light's own height cast no shadow any more.
        let shorter = ends.map(|end| end + (0.5 - end) * 1e-9);
        let ((start, lever), (end, other)) = (thrown(shorter[0])?, thrown(shorter[1])?);
        let along = end - start;
        let part = (-start.dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let farthest = a.distance(eye).max(b.distance(eye)).max(seen.distance(eye));
        let rounding = ROUNDING * farthest * (lever + part * (other - lever));
        let metres = (start + along * part).length();
        (metres <= ROUNDINGS * rounding).then_some(NearSide { metres, rounding })
    };
    let triangles = object.mesh.triangles();
    let edges_of = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let low_first = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let edges = triangles.par_iter().flat_map_iter(|corners| edges_of(*corners)).map(low_first);
    let found: HashMap<[u32; 2], NearSide> = edges.filter_map(|edge| Some((edge, near(edge)?))).collect();
    if found.is_empty() {
        return None;
    }
    // For each edge, how many more of its triangles, oriented towards the light, run along it one way than the other:
    // where both numbers are equal, the lit sheet continues and has no side there.
    let mut bounds: HashMap<[u32; 2], i32> = HashMap::new();
    for corners in triangles {
        for edge in edges_of(*corners).into_iter().filter(|edge| found.contains_key(&low_first(*edge))) {
            let side = side_of_triangle(corners.map(|index| world[index as usize]), light).value();
            *bounds.entry(low_first(edge)).or_default() += if edge[0] < edge[1] { side } else { -side };
        }
    }
    let sides = found.into_iter().filter(|(edge, _)| bounds.get(edge).is_some_and(|times| *times != 0));
    sides.map(|(_, side)| side).min_by(|a, b| a.metres.total_cmp(&b.metres))
}

/// Looks for miscounted casters whose median edge is two pixels long or less: as corners snap to a part of a pixel,
/// narrow sides tilt. The fixes are larger pictures. `None` where no volumes are counted.
fn subpixel_edges(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    if !facts.counts_volumes(light) {
        return None;
    }
    let ((name, edge), shown_by) = case.shown(|sample| {
        let (name, ..) = sample.miscounted(facts, light).into_iter().next()?;
        let (index, _) = facts.object(&name)?;
        let edge = usual_edge(facts, index)?;
        (edge <= SHORT_EDGE).then_some((name, edge))
    })?;
    let sentence = format!(
        "half of the edges of {name} are shorter than {} pixels from here, and corners snap to multiples of {} pixels",
        numbers::digits(edge),
        numbers::digits(facts.step)
    );
    let short =
        Quantity::at_most("the length that half of the caster's edges are shorter than, in pixels", edge, SHORT_EDGE);
    Some(SuspectedCause::new(Cause::SubpixelEdges, case.evidence(sentence, shown_by, [short]), larger_pictures(facts)))
}

/// Returns fixes that draw the picture larger, as far as every GPU can: what snapping of corners does to a pixel is then
/// gone.
pub(super) fn larger_pictures(facts: &FrameFacts) -> Vec<Fix> {
    let fits = |times: &u32| facts.plan.size.iter().all(|side| side * times <= MOST_SIDE);
    LARGER.into_iter().filter(fits).map(Fix::larger).collect()
}

/// Returns the median length of the edges of an object (its index in the scene) in pixels, as at the depth of its nearest
/// corner. `None` without edges, or where a corner is at or behind the eye.
fn usual_edge(facts: &FrameFacts, object: usize) -> Option<f64> {
    let world = facts.scene.objects.get(object)?.world_positions();
    let nearest = world.iter().map(|point| facts.tracer.depth_of(*point)).fold(f64::INFINITY, f64::min);
    let mut lengths = facts.meshes.get(object)?.edge_lengths();
    let middle = lengths.len() / 2;
    let (_, median, _) = (middle < lengths.len()).then(|| lengths.select_nth_unstable_by(middle, f64::total_cmp))?;
    (nearest > 0.0).then(|| *median / facts.pixel_width(nearest))
}
