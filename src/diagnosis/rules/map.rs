//! Shadow maps: compares what the texel stores with what it should store.
//!
//! The texel's own ray is followed through the truth's scene: its first hit is the depth that the map would store
//! without a bias. If the pixel is wrong with that depth as well, the texel is too coarse; else the bias is too small
//! or too large.

use super::planar::larger;
use crate::accuracy::Finding;
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::{Fix, PlanEdit};
use crate::numbers;
use crate::plan::{DrawPart, PlanMap};
use crate::technique::{MapSettings, Technique};
use crate::truth::SeenSurface;
use glam::{DMat4, DVec2, DVec3};

pub(crate) const RULES: &[CauseRule] = &[acne, peter_panning, aliasing, outside_map];

/// How a shadow map compares at a wrong surface point: the texel, the bias, and the cause that follows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapComparison {
    pub cause: Cause,
    /// Index of the object that the texel shows, or would show.
    pub caster: Option<usize>,
    /// Width of a texel at the surface, metres.
    texel: f64,
    /// How much farther from the light the receiver gets within one texel, metres.
    slope: f64,
    /// How far the receiver's plane lies behind the first surface that the texel's ray hits, metres; for peter-panning,
    /// how far the surface lies behind the caster.
    gap: f64,
    /// How far the bias moves the map's depth from the true one, metres.
    bias: f64,
    /// Distance from the middle of the map's face, 1 at its border.
    place: f64,
}

/// Compares a shadow map with the truth at a wrong surface point and returns the cause with its numbers;
/// [`Cause::OutsideMap`] where no face contains the point. `None` for other techniques, or where the light reads no
/// map.
pub(crate) fn look(facts: &FrameFacts, light: usize, kind: RegionKind, seen: &SeenSurface) -> Option<MapComparison> {
    if facts.technique() != Technique::ShadowMap {
        return None;
    }
    let map = facts.plan.lights.get(light)?.map.as_ref()?;
    map.lookup?;
    let relative = seen.point - facts.scene.camera.eye;
    let Some((face, device)) = find_face(map, relative) else {
        let caster = facts.tracer.between(light, seen).last().map(|hit| hit.place.object);
        return Some(MapComparison {
            cause: Cause::OutsideMap,
            caster,
            texel: 0.0,
            slope: 0.0,
            gap: 0.0,
            bias: 0.0,
            place: farthest(map, relative),
        });
    };
    texel_look(facts, light, kind, seen, map, face, device)
}

/// Returns the first face of a map that a point (relative to the eye) is on, and its normalized device coordinates
/// there; its depth is not checked. `None` where no face contains it.
fn find_face(map: &PlanMap, relative: DVec3) -> Option<(usize, DVec3)> {
    map.clip_from_relative.iter().enumerate().find_map(|(face, matrix)| {
        let clip = matrix.as_dmat4() * relative.extend(1.0);
        let is_on = clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w;
        is_on.then(|| (face, clip.truncate() / clip.w))
    })
}

/// Returns how far a point (relative to the eye) is from the middle of the nearest face: the larger of x and y, where 1
/// is the border. Infinite where it is behind all faces.
fn farthest(map: &PlanMap, relative: DVec3) -> f64 {
    let off = map.clip_from_relative.iter().map(|matrix| {
        let clip = matrix.as_dmat4() * relative.extend(1.0);
        if clip.w > 0.0 { clip.x.abs().max(clip.y.abs()) / clip.w } else { f64::INFINITY }
    });
    off.fold(f64::INFINITY, f64::min)
}

fn texel_look(
    facts: &FrameFacts,
    light: usize,
    kind: RegionKind,
    seen: &SeenSurface,
    map: &PlanMap,
    face: usize,
    device: DVec3,
) -> Option<MapComparison> {
    let image = facts.capture.lights.get(light)?.map.as_ref()?.faces.get(face)?.clone();
    let size = f64::from(image.size()[0]);
    let texel =
        ((device.truncate() * DVec2::new(0.5, -0.5) + 0.5) * size).floor().clamp(DVec2::ZERO, DVec2::splat(size - 1.0));
    let stored = f64::from(image.depth_at([texel.x as u32, texel.y as u32])?);
    let clip_from_world: DMat4 = *map.clip_from_light.get(face)? * map.light_from_world;
    let world_from_clip = clip_from_world.inverse();
    let center = ((texel + 0.5) / size - 0.5) * DVec2::new(2.0, -2.0);
    let unproject = |x: f64, y: f64, z: f64| world_from_clip.project_point3(DVec3::new(x, y, z));
    let target = unproject(center.x, center.y, device.z);
    let beside = unproject(center.x + 2.0 / size, center.y, device.z);
    let width = (beside - target).length();
    let origin_side = facts.tracer.light_distance(light, target);
    let drawn = |name: &str| facts.draws(light, DrawPart::Map).any(|draw| draw.caster.as_deref() == Some(name));
    // Hits in order, from the light on.
    let mut hits = facts.tracer.along(light, target);
    hits.retain(|hit| hit.towards_light < origin_side && drawn(facts.tracer.name(hit.place)));
    let first = hits.last();
    let towards = facts.tracer.towards(light, target);
    let normal = (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]).normalize_or_zero();
    let cosine = normal.dot(towards).abs().max(1e-9);
    let slope = width * (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
    // Where the texel's ray hits the receiver's plane, towards the light from the target.
    let receiver = normal.dot(seen.point - target) / normal.dot(towards);
    let is_reversed = map.lookup.is_some_and(|lookup| lookup.clear_depth == 0.0);
    let clear = map.lookup.map_or(0.0, |lookup| f64::from(lookup.clear_depth));
    let height_of = |z: f64| facts.tracer.towards(light, target).dot(unproject(center.x, center.y, z) - target);
    let bias = first.filter(|_| stored != clear).map_or(0.0, |first| first.towards_light - height_of(stored));
    let gap = first.map_or(0.0, |first| first.towards_light - receiver);
    let filter = map.lookup.map_or(1, |lookup| lookup.filter_width).max(1);
    let cause = match (kind, first) {
        (RegionKind::Wrong(Finding::FalseShadow), Some(first)) => {
            let is_own = first.place.object == seen.place.object;
            let reach = (slope + width) * 1.5 * f64::from(filter) + 1e-6 * origin_side.min(1e6);
            if is_own && gap.abs() <= reach { Cause::Acne } else { Cause::Aliasing }
        }
        (RegionKind::Wrong(Finding::MissingShadow), Some(first)) => {
            let point = seen.point;
            let unbiased = clip_from_world.project_point3(target + towards * first.towards_light).z;
            let here = clip_from_world.project_point3(point).z;
            let is_nearer = if is_reversed { unbiased > here } else { unbiased < here };
            if is_nearer { Cause::PeterPanning } else { Cause::Aliasing }
        }
        _ => Cause::Aliasing,
    };
    // A missing shadow was looked up at the target, which the bias has to pass.
    let gap = match (cause, first) {
        (Cause::PeterPanning, Some(first)) => first.towards_light,
        _ => gap,
    };
    Some(MapComparison {
        cause,
        caster: first.map(|first| first.place.object),
        texel: width,
        slope,
        gap,
        bias,
        place: device.truncate().abs().max_element(),
    })
}

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
    let evidence = format!(
        "a texel is {} wide here, over which the surface gets {} farther from the light; the bias is {}",
        numbers::metres(look.texel),
        numbers::metres(look.slope),
        numbers::metres(look.bias.max(0.0))
    );
    let steps = [(16, 2.0), (64, 4.0), (256, 8.0)];
    let MapSettings { bias_constant: constant, bias_slope: slope, .. } = facts.map();
    let more = steps.into_iter().filter(|(c, s)| *c > constant || *s > slope);
    let mut fixes: Vec<Fix> = more.map(|(c, s)| bias(c.max(constant), s.max(slope))).collect();
    fixes.push(Fix::technique(Technique::ZFail));
    SuspectedCause::new(Cause::Acne, evidence, fixes, shown_by)
}

fn peter_panning(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (look, shown_by) = shown(facts, case, Cause::PeterPanning)?;
    let evidence = match facts.map().bias_normal {
        texels if texels > 0.0 => format!(
            "the surface is looked up {} of {} along its normal, and the caster is only {} before it",
            texels,
            numbers::metres(look.texel),
            numbers::metres(look.gap)
        ),
        _ => format!(
            "the bias moves the caster {} away from the light, and the surface is only {} behind it",
            numbers::metres(look.bias),
            numbers::metres(look.gap)
        ),
    };
    let steps = [(16, 2.0), (16, 1.0), (4, 0.5)];
    let MapSettings { bias_constant: constant, bias_slope: slope, .. } = facts.map();
    let less = steps.into_iter().filter(|(c, s)| *c < constant || *s < slope);
    let mut fixes: Vec<Fix> = less.map(|(c, s)| bias(c.min(constant), s.min(slope))).collect();
    if facts.map().bias_normal != 0.0 {
        fixes = vec![Fix::setting("bias-normal", "0")];
    }
    fixes.push(Fix::technique(Technique::ZFail));
    SuspectedCause::new(Cause::PeterPanning, evidence, fixes, shown_by)
}

fn aliasing(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ((look, pixels), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let look = look(facts, case.light(), case.region.key.kind, &seen)?;
        let pixels = look.texel / facts.pixel_width(facts.tracer.depth_of(seen.point));
        (look.cause == Cause::Aliasing).then_some((look, pixels))
    })?;
    let evidence = format!(
        "a texel is {} wide here, {} pixels of the picture, and the outline of the shadow runs through it",
        numbers::metres(look.texel),
        numbers::digits(pixels)
    );
    SuspectedCause::new(Cause::Aliasing, evidence, larger(facts.texels(), 8192.0), shown_by)
}

fn outside_map(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (look, shown_by) = shown(facts, case, Cause::OutsideMap).filter(|_| case.is_missing())?;
    let place = match look.place.is_finite() {
        true => format!("{} times as far from the map's middle as its border", numbers::digits(look.place)),
        false => "behind what the map looks at".to_owned(),
    };
    let evidence = format!("the surface lies {place}, where nothing is looked up");
    let fixes = vec![Fix::plan(PlanEdit::Refit), Fix::technique(Technique::ZFail)];
    SuspectedCause::new(Cause::OutsideMap, evidence, fixes, shown_by)
}
