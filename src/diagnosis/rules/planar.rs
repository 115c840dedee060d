//! Faults of flattened casters where they are drawn.

use crate::capture::{Aspect, Capture, Snapshot};
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, PixelSample, RegionSamples, SuspectedCause, amount};
use crate::diagnosis::fix::Fix;
use crate::geometry::planar::FlattenClip;
use crate::history::{FragmentOutcome, PixelEvent, TestResult, TriangleEvent};
use crate::math::Plane;
use crate::numbers;
use crate::plan::{Draw, DrawPart, FramePlan, Pass, Program};
use crate::technique::{PlanarSettings, ShadowBlend, Technique};
use crate::truth::SeenSurface;
use glam::{DVec3, DVec4};
use std::collections::BTreeSet;

pub(crate) const RULES: &[CauseRule] =
    &[double_blend, opaque_shadow, z_fighting, off_receiver, anti_shadow, false_shadow];

/// How far a surface may be off its own plane, relative to its distance from the eye.
pub(super) const OFF_PLANE: f64 = 1e-3;

/// Returns whether any pass blends planar shadows over the picture.
pub(crate) fn darkens_in_the_picture(plan: &FramePlan) -> bool {
    plan.passes.iter().any(is_blend)
}

fn is_blend(pass: &Pass) -> bool {
    let covers = |draw: &Draw| draw.part == DrawPart::PlanarShadow && draw.program == Program::Flat;
    pass.draws.iter().any(covers)
}

/// Returns the row-major indices, sorted, of the pixels that a blend pass of a light darkened by more than one
/// flattened triangle that is blended would. Pixels that were dark before can't be judged and are left out.
pub(crate) fn too_dark(plan: &FramePlan, capture: &Capture, light: usize) -> Vec<usize> {
    let mut found = BTreeSet::new();
    for (index, pass) in plan.passes.iter().enumerate() {
        let is_blend = is_blend(pass);
        let is_of_light = pass.timed && pass.light.is_some_and(|of| of.0 == light);
        if !is_blend || !is_of_light || index == 0 {
            continue;
        }
        let color = |step: usize| match &capture.steps.get(step)?.snapshot {
            Snapshot::Frame(frame) => Some(&frame.color),
            Snapshot::Map { .. } => None,
        };
        let (Some(before), Some(after)) = (color(index - 1), color(index)) else { continue };
        found.extend(darkened_below(before, after, f64::from(ShadowBlend::LEAVES).powf(1.5)));
    }
    found.into_iter().collect()
}

/// Returns the row-major indices of pixels whose brightest channel has, in linear light, less than `part` of its value
/// before. Pixels whose brightest byte was below 40 are left out: eight bits can't tell there.
fn darkened_below(before: &Aspect, after: &Aspect, part: f64) -> Vec<usize> {
    let mut found = Vec::new();
    let width = before.image.size()[0] as usize;
    for (y, (before, after)) in before.image.rows().zip(after.image.rows()).enumerate() {
        for (x, (before, after)) in before.chunks_exact(4).zip(after.chunks_exact(4)).enumerate() {
            let brightest = (0..3).max_by_key(|channel| before[*channel]).unwrap_or(0);
            // Below that, eight bits can't distinguish once from twice.
            let is_bright = before[brightest] >= 40;
            if is_bright && linear(after[brightest]) < linear(before[brightest]) * part {
                found.push(y * width + x);
            }
        }
    }
    found
}

/// Converts an sRGB byte to linear light, 0 to 1.
fn linear(byte: u8) -> f64 {
    let value = f64::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Returns whether flattened casters are drawn in black over the lit picture (`blend` is opaque).
fn is_opaque(facts: &FrameFacts) -> bool {
    settings(facts).is_some_and(|settings| settings.blend == ShadowBlend::Opaque)
}

fn opaque_shadow(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if !case.is_too_dark() || !is_opaque(facts) {
        return None;
    }
    let light = case.light();
    let (name, shown_by) = case.shown(|sample| {
        let over = flattened(sample, light).find(|(_, one)| one.outcome.passed());
        over.map(|(_, one)| one.draw_name.clone())
    })?;
    let of_draws = facts.draws(light, DrawPart::PlanarShadow).filter(|draw| draw.program == Program::Flat);
    let left = of_draws.filter(|draw| draw.name == name).map(|draw| draw.constants.flat[0]).next()?;
    let ambient = facts.plan.ambient.iter().copied().fold(0.0, f32::max);
    let sentence = format!("the {name} leaves {left} of what is below it, and the ambient light there is {ambient}");
    let quantities = [Quantity::at_most("the share of the picture that a flattened triangle leaves", left.into(), 0.0)];
    let evidence = case.evidence(sentence, shown_by, quantities);
    Some(SuspectedCause::new(Cause::OpaqueShadow, evidence, vec![once()]))
}

/// Returns the fix that lets flattened triangles darken each pixel once, by the stencil.
fn once() -> Fix {
    let mut fix = Fix::setting("blend", "once");
    fix.settings.insert("stencil".to_owned(), "on".to_owned());
    fix
}

fn double_blend(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if !case.is_too_dark() || is_opaque(facts) {
        return None;
    }
    let light = case.light();
    let (count, shown_by) = case.shown(|sample| {
        let passing = flattened(sample, light).filter(|(_, one)| one.outcome.passed()).count();
        (passing > 1).then_some(passing)
    })?;
    let sentence = format!("{count} flattened triangles cover this pixel, and each darkens it");
    let twice = Quantity::at_least("flattened triangles that darken the pixel", count as f64, 2.0);
    let fixes = vec![Fix::setting("blend", "once"), once()];
    Some(SuspectedCause::new(Cause::DoubleBlend, case.evidence(sentence, shown_by, [twice]), fixes))
}

/// Returns the events at a sample, with their triangles, of a light's flattened shadows drawn into the picture; those
/// of the pass that writes labels are left out.
fn flattened(sample: &PixelSample, light: usize) -> impl Iterator<Item = (&PixelEvent, &TriangleEvent)> {
    let all = sample.history.iter().flat_map(|history| history.triangles());
    // The pass that writes labels draws the same triangles again.
    all.filter(move |(event, one)| {
        event.light == Some(light)
            && one.part == DrawPart::PlanarShadow
            && event.target == crate::capture::FrameTarget::Picture
    })
}

/// The distance of a visible surface point from the plane of a flattened triangle.
#[derive(Clone, Copy)]
struct PlaneDistance {
    /// Metres, never negative.
    metres: f64,
    /// The distance up to which a point counts as in the plane, metres.
    tolerance: f64,
}

impl PlaneDistance {
    /// Measures the distance of a point from the plane of a flattened triangle, whose homogeneous corners are relative to
    /// the eye; `None` where the triangle defines no plane, and nothing lies in it or off it.
    fn of(corners: [[f32; 4]; 3], eye: DVec3, point: DVec3) -> Option<PlaneDistance> {
        let metres = Plane::through_homogeneous(corners, eye)?.at(point.extend(1.0)).abs();
        Some(PlaneDistance { metres, tolerance: OFF_PLANE * (point - eye).length() })
    }

    fn is_off(self) -> bool {
        self.metres > self.tolerance
    }
}

fn off_receiver(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if !case.is_false() || settings(facts).is_none_or(|settings| settings.marks) {
        return None;
    }
    let light = case.light();
    let ((name, off), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        // What defines no plane is neither on it nor off it.
        let distance = |one: &TriangleEvent| PlaneDistance::of(one.corners, facts.scene.camera.eye, seen.point);
        let passing = flattened(sample, light).filter(|(_, one)| one.outcome.passed());
        let passing = passing.filter_map(|(_, one)| Some((one.draw_name.clone(), distance(one)?)));
        let passing: Vec<(String, PlaneDistance)> = passing.collect();
        let are_off = passing.iter().all(|(_, distance)| distance.is_off());
        passing.into_iter().next().filter(|_| are_off)
    })?;
    let sentence = format!(
        "the {name} darkens a surface that lies {} off the plane it is flattened onto",
        numbers::metres(off.metres)
    );
    let beside = Quantity::more_than("the surface's distance from that plane, in metres", off.metres, off.tolerance);
    let evidence = case.evidence(sentence, shown_by, [beside]);
    Some(SuspectedCause::new(Cause::OffReceiver, evidence, vec![Fix::setting("stencil", "on")]))
}

fn z_fighting(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let ((name, shadow, surface, off), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let fails =
            |outcome: FragmentOutcome| matches!(outcome, FragmentOutcome::Tested { depth: TestResult::Failed, .. });
        let failing = flattened(sample, light).filter(|(_, one)| fails(one.outcome));
        let mut measured = failing.filter_map(|(event, one)| {
            let off = PlaneDistance::of(one.corners, facts.scene.camera.eye, seen.point)?;
            Some((one.draw_name.clone(), one.depth, event.before.depth, off))
        });
        measured.find(|(.., off)| !off.is_off())
    })?;
    let steps = (i64::from(shadow.to_bits()) - i64::from(surface.to_bits())).unsigned_abs();
    let sentence = format!(
        "the {name} lies in the surface's plane, but its depth is {} here and the surface's {}: {} behind it",
        numbers::depth(shadow),
        numbers::depth(surface),
        amount(steps, "step")
    );
    let fixes = vec![Fix::setting("z-fighting", "depth-off"), Fix::setting("z-fighting", "polygon-offset")];
    let in_plane =
        Quantity::at_most("the surface's distance from the shadow's plane, in metres", off.metres, off.tolerance);
    Some(SuspectedCause::new(Cause::ZFighting, case.evidence(sentence, shown_by, [in_plane]), fixes))
}

/// Returns the cause that a single pixel of planar shadows suggests: an anti-shadow where a caster on the light's line
/// is beyond the light, else a false shadow where one is below the surface. `None` where neither is, or shadows are
/// clipped.
pub(crate) fn hint(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> Option<Cause> {
    if !is_unclipped(facts) {
        return None;
    }
    let (beyond, below) = on_the_line(facts, light, seen);
    match (beyond.is_empty(), below.is_empty()) {
        (false, _) => Some(Cause::AntiShadow),
        (true, false) => Some(Cause::FalseShadow),
        (true, true) => None,
    }
}

/// Names of casters, each with a distance in metres.
type CasterDistances = Vec<(String, f64)>;

/// Returns the casters on the line from a light through a surface point: those beyond the light with their distance
/// from it, and those below the surface (not in its plane) with their distance from the point, metres. Those between
/// are left out.
fn on_the_line(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> (CasterDistances, CasterDistances) {
    let distance = facts.tracer.light_distance(light, seen.point);
    let plane =
        Plane::through(seen.point, (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]));
    let off = |point: DVec3| plane.at(point.extend(1.0)).abs();
    let towards = facts.tracer.towards(light, seen.point);
    let (mut beyond, mut below) = (Vec::new(), Vec::new());
    // What is not divided by a negative w never comes back through the light.
    let comes_back = settings(facts).is_none_or(|settings| settings.clip != FlattenClip::Undivided);
    for hit in facts.tracer.along(light, seen.point) {
        let name = facts.tracer.name(hit.place).to_owned();
        let is_flat = off(seen.point + towards * hit.towards_light) <= OFF_PLANE * 1e-3;
        if hit.towards_light > distance {
            if comes_back {
                beyond.push((name, hit.towards_light - distance));
            }
        } else if hit.towards_light < 0.0 && !is_flat {
            below.push((name, -hit.towards_light));
        }
    }
    (beyond, below)
}

/// Returns the first caster with a triangle that reaches past a point light's height over the surface's plane and whose
/// corners, flattened one by one, cover the point: its name, and how many metres it reaches under and over that height.
/// `None` without one, or for a directional light.
fn spans_the_light(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> Option<(String, f64, f64)> {
    let position = facts.tracer.light_position(light);
    if position.w == 0.0 {
        return None;
    }
    let source = position.truncate() / position.w;
    let normal = (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]).normalize_or_zero();
    let over_plane = |point: DVec3| normal.dot(point - seen.corners[0]);
    let light_height = over_plane(source);
    let flipped = if light_height < 0.0 { -1.0 } else { 1.0 };
    let over_light = |point: &DVec3| flipped * (over_plane(*point) - light_height);
    // On the line of light and corner, where it intersects the plane; a corner level with the light goes to infinity.
    let flattened = |point: &DVec3| {
        let under = light_height - over_plane(*point);
        let away = *point - source;
        if under == 0.0 { away.extend(0.0) } else { (source + away * (light_height / under)).extend(1.0) }
    };
    for object in facts.scene.objects.iter().filter(|object| object.casts) {
        let world = object.world_positions();
        for triangle in object.mesh.triangles() {
            let corners = triangle.map(|vertex| world[vertex as usize]);
            let heights = corners.each_ref().map(over_light);
            let (under, over) =
                heights.iter().fold((0.0f64, 0.0f64), |(low, high), height| (low.min(*height), high.max(*height)));
            let reaches_past = over > 0.0 && heights.iter().any(|height| *height <= 0.0);
            let spans = reaches_past && holds(corners.each_ref().map(flattened), seen.point, normal);
            if spans {
                return Some((object.name.clone(), -under, over));
            }
        }
    }
    None
}

/// Returns whether a triangle of homogeneous corners (`w >= 0`) in the plane with this normal contains `point`; its
/// edges count, and either winding does.
fn holds(corners: [DVec4; 3], point: DVec3, normal: DVec3) -> bool {
    let from_point = corners.map(|corner| corner.truncate() - point * corner.w);
    let side = |from: usize, to: usize| normal.dot(from_point[from].cross(from_point[to]));
    let sides = [side(0, 1), side(1, 2), side(2, 0)];
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}

/// Returns the settings of planar shadows; `None` for another technique.
pub(super) fn settings(facts: &FrameFacts) -> Option<PlanarSettings> {
    (facts.technique() == Technique::Planar).then(|| PlanarSettings::read(facts.choice.settings()))
}

/// Returns whether casters are flattened without clipping (`clip` is off).
fn is_unclipped(facts: &FrameFacts) -> bool {
    settings(facts).is_some_and(|settings| settings.clip != FlattenClip::BetweenPlaneAndLight)
}

fn is_flattened_unclipped(facts: &FrameFacts, case: &RegionSamples) -> bool {
    is_unclipped(facts) && case.is_false()
}

fn anti_shadow(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if !is_flattened_unclipped(facts, case) {
        return None;
    }
    let light = case.light();
    let ((sentence, beyond), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let beyond = on_the_line(facts, light, &seen).0.into_iter().next().map(|(name, far)| {
            let words = numbers::metres(far);
            let sentence = format!(
                "nothing lies between light and surface, but {name} lies on their line, {words} beyond the light"
            );
            (sentence, far)
        });
        beyond.or_else(|| {
            let (name, under, over) = spans_the_light(facts, light, &seen)?;
            let sentence = format!(
                "nothing lies between light and surface, but a triangle of {name} reaches from {} under the light's \
                 height to {} over it, and its corners, flattened one by one, span the surface",
                numbers::metres(under),
                numbers::metres(over)
            );
            Some((sentence, over))
        })
    })?;
    let beyond = Quantity::more_than("how far the caster reaches beyond the light, in metres", beyond, 0.0);
    let evidence = case.evidence(sentence, shown_by, [beyond]);
    Some(SuspectedCause::new(Cause::AntiShadow, evidence, vec![Fix::setting("clip", "on")]))
}

fn false_shadow(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if !is_flattened_unclipped(facts, case) {
        return None;
    }
    let ((name, far), shown_by) = case.shown(|sample| {
        let (beyond, below) = on_the_line(facts, case.light(), &sample.seen?);
        below.into_iter().next().filter(|_| beyond.is_empty())
    })?;
    let sentence = format!(
        "nothing lies between light and surface, but {name} lies on their line, {} under the surface",
        numbers::metres(far)
    );
    let under = Quantity::more_than("how far the caster lies under the surface, in metres", far, 0.0);
    let evidence = case.evidence(sentence, shown_by, [under]);
    Some(SuspectedCause::new(Cause::FalseShadow, evidence, vec![Fix::setting("clip", "on")]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three corners on a line have no plane: a surface is not in it, and is not off it.
    #[test]
    fn a_triangle_without_area_has_no_distance() {
        let eye = DVec3::new(0.0, 2.0, 0.0);
        let point = DVec3::new(0.5, 0.0, 0.0);
        let corner = |x: f32, z: f32| [x, -2.0, z, 1.0];
        let flat = PlaneDistance::of([corner(0.0, 0.0), corner(1.0, 0.0), corner(3.0, 0.0)], eye, point);
        assert!(flat.is_none());
        let floor = [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)];
        let off = |up: f64| PlaneDistance::of(floor, eye, point + DVec3::Y * up).map(PlaneDistance::is_off);
        assert_eq!((off(0.0), off(0.1)), (Some(false), Some(true)));
    }
}
