//! Shadow maps whose frustum has given planes: a caster before the near one or behind the far one has no part in the
//! map.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, PixelSample, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::Fix;
use crate::geometry::light_frame::LightFrustum;
use crate::numbers;
use crate::plan::PlanMap;
use glam::{DMat4, DVec3};

pub(crate) const RULES: &[CauseRule] = &[near_plane, far_plane];

/// Returns the fix that fits the map to what casts.
pub(super) fn fitted() -> Fix {
    Fix::setting("light-frustum", "casters")
}

/// A caster between light and surface, and where it stands in the light's view.
struct ClippedCaster {
    name: String,
    /// Distance from the map's camera along its axis, metres.
    distance: f64,
}

/// Returns where a point is between the planes of a map's face, 0 at the near one and 1 at the far one; `None` where it
/// is outside the face's sides or behind its camera.
fn part_of_depth(map: &PlanMap, face: &DMat4, is_reversed: bool, point: DVec3) -> Option<f64> {
    let clip = *face * map.light_from_world * point.extend(1.0);
    let is_within = clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w;
    is_within.then(|| if is_reversed { 1.0 - clip.z / clip.w } else { clip.z / clip.w })
}

/// Returns the casters of a sample that a plane clips away: all drawn ones between light and surface, where each of
/// them is on the side of it that `is_beyond` says. Empty without any.
fn clipped(
    facts: &FrameFacts,
    light: usize,
    sample: &PixelSample,
    [near, far]: [f64; 2],
    is_beyond: impl Fn(f64) -> bool,
) -> Vec<ClippedCaster> {
    let (Some(seen), Some(map)) = (sample.seen, facts.plan.lights.get(light).and_then(|light| light.map.as_ref()))
    else {
        return Vec::new();
    };
    let is_reversed = facts.plan.depth.mapping.is_reversed();
    let towards = facts.tracer.towards(light, seen.point);
    let is_parallel = facts.tracer.light_position(light).w == 0.0;
    let caster = |hit: &crate::truth::OccluderHit| {
        let point = seen.point + towards * hit.towards_light;
        let part = map.clip_from_light.iter().find_map(|face| part_of_depth(map, face, is_reversed, point))?;
        // Depth of a perspective map is 1 / distance, but for two numbers that the planes are at 0 and 1.
        let distance = if is_parallel { near + part * (far - near) } else { near * far / (far - part * (far - near)) };
        let name = facts.tracer.name(hit.place).to_owned();
        is_beyond(part).then_some(ClippedCaster { name, distance })
    };
    let all: Option<Vec<ClippedCaster>> = sample.between.iter().map(caster).collect();
    all.unwrap_or_default()
}

fn near_plane(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let before: PlaneBreach = ("begins", |part| part < 0.0, Quantity::less_than);
    beyond_plane(facts, case, Cause::MapNearPlane, before)
}

fn far_plane(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let behind: PlaneBreach = ("ends", |part| part > 1.0, Quantity::more_than);
    beyond_plane(facts, case, Cause::MapFarPlane, behind)
}

/// What the map does at a plane, whether a part of its depth is on the far side of that, and the comparison that says so
/// of a distance.
type PlaneBreach = (&'static str, fn(f64) -> bool, fn(&'static str, f64, f64) -> Quantity);

/// Suspects the near or the far plane of a frustum that settings give where it clips all casters of samples away.
fn beyond_plane(
    facts: &FrameFacts,
    case: &RegionSamples,
    cause: Cause,
    (does, is_beyond, compare): PlaneBreach,
) -> Option<SuspectedCause> {
    let LightFrustum::Given { near, far, .. } = facts.map().frustum else { return None };
    if !case.is_missing() {
        return None;
    }
    let (ClippedCaster { name, distance }, shown_by) =
        case.shown(|sample| clipped(facts, case.light(), sample, [near, far], is_beyond).pop())?;
    let plane = if cause == Cause::MapNearPlane { near } else { far };
    let sentence = format!(
        "{name} is {} from where the map looks from, and the map {does} at {}",
        numbers::metres(distance),
        numbers::metres(plane)
    );
    let clips =
        compare("the caster's distance from where the map looks from, along its axis, in metres", distance, plane);
    Some(SuspectedCause::new(cause, case.evidence(sentence, shown_by, [clips]), vec![fitted()]))
}
