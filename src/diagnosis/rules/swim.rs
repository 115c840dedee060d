//! Maps that follow the view and are not snapped to their texels: while the eye moves, texels move over the world by
//! parts of themselves, and with them the steps of every shadow's edge, though nothing in the scene moves.
//!
//! The frame is compared with frames from the same eye whose maps are fitted to what an eye a little to its right sees.
//! Their truth is the same: where they differ, the pixel is right by chance.

use super::frustum::fitted;
use super::map_comparison::{TEXEL_ROUNDING, find_face};
use crate::capture::Image;
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, MovedMap, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::Fix;
use crate::geometry::light_frame::LightFrustum;
use crate::numbers;
use crate::plan::FramePlan;
use crate::scene::{Camera, Scene};
use crate::technique::{Choice, MapSettings, Technique};
use crate::truth::Tracer;
use glam::{DVec2, DVec3, Vec4Swizzles};
use rayon::prelude::*;
use std::sync::Arc;

pub(crate) const RULES: &[CauseRule] = &[map_swims];

/// How far to its right the eye stands in the frames that a frame is compared with, in distances to its target: two, as
/// in one of them texels may happen to have moved by whole ones.
const MOVED: [f64; 2] = [1.0 / 400.0, 1.0 / 250.0];

/// Returns the cameras whose views maps are fitted to in the frames that a frame is compared with; none where no map
/// follows the view.
pub(crate) fn cameras(scene: &Scene, choice: &Choice) -> Vec<Camera> {
    let frustum = MapSettings::read(choice.settings()).frustum;
    if choice.technique() != Technique::ShadowMap || !matches!(frustum, LightFrustum::View { .. }) {
        return Vec::new();
    }
    MOVED.iter().map(|by| scene.camera.moved_aside(*by)).collect()
}

/// Returns the indices of pixels, row-major, whose label of a light is another one where its map is fitted to the view
/// from a moved eye, as its texels have moved by parts of themselves.
pub(crate) fn swimming(
    plan: &FramePlan,
    labels: &[Option<Arc<Image>>],
    moved: &[MovedMap],
    tracer: &Tracer,
    light: usize,
) -> Vec<usize> {
    let bytes = |labels: &[Option<Arc<Image>>]| -> Option<Vec<u8>> {
        Some(labels.get(light)?.as_ref()?.rows().flatten().copied().collect())
    };
    let Some(still) = bytes(labels) else { return Vec::new() };
    let others: Vec<(&FramePlan, Vec<u8>)> =
        moved.iter().filter_map(|one| Some((&one.plan, bytes(&one.labels)?))).collect();
    let swims = |index: &usize| {
        let differing = || others.iter().filter(|(_, other)| other[*index] != still[*index]);
        if differing().next().is_none() {
            return false;
        }
        let [x, y] = crate::accuracy::place(*index, plan.size);
        let seen = tracer.seen_at([f64::from(x) + 0.5, f64::from(y) + 0.5]);
        seen.is_some_and(|seen| {
            let part = |other: &FramePlan| part_moved(plan, other, light, seen.point);
            differing().any(|(other, _)| part(other).is_some_and(|part| part > TEXEL_ROUNDING))
        })
    };
    (0..still.len()).into_par_iter().filter(swims).collect()
}

/// Returns where a point of the world lies in a light's map, in texels, and how wide a texel is there, metres; `None`
/// outside the map.
fn texel_at(plan: &FramePlan, light: usize, point: DVec3) -> Option<(DVec2, f64)> {
    let map = plan.lights.get(light)?.map.as_ref()?;
    let relative = point - plan.views.first()?.origin;
    let matrix = map.clip_from_relative[find_face(map, relative)?].as_dmat4();
    let size = f64::from(plan.attachment(map.attachment).size[0]);
    let clip = matrix * relative.extend(1.0);
    let place = (clip.xy() / clip.w * DVec2::new(0.5, -0.5) + 0.5) * size;
    Some((place, 2.0 * clip.w / (matrix.row(0).truncate().length() * size)))
}

/// Returns the part of a texel, 0 to 0.5, by which the texels of a light's map moved at a point of the world from one
/// frame to another, whole ones aside; `None` outside of one of the maps.
fn part_moved(from: &FramePlan, to: &FramePlan, light: usize, point: DVec3) -> Option<f64> {
    let [from, to] = [from, to].map(|plan| texel_at(plan, light, point));
    let by = to?.0 - from?.0;
    Some((by - by.round()).abs().max_element())
}

fn map_swims(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if case.region.key.kind != RegionKind::Swims {
        return None;
    }
    let ((part, texel, moved), shown_by) = case.shown(|sample| {
        let point = sample.seen?.point;
        let (_, texel) = texel_at(facts.plan, case.light(), point)?;
        let part = |one: &MovedMap| Some((part_moved(facts.plan, &one.plan, case.light(), point)?, texel, one.moved));
        facts.moved.iter().filter_map(part).max_by(|one, other| one.0.total_cmp(&other.0))
    })?;
    let sentence = format!(
        "while the eye moves by {}, the texels of the map, {} wide here, move by {} of one over the surface, and the steps \
         of the shadow's edge with them",
        numbers::metres(moved),
        numbers::metres(texel),
        numbers::digits(part)
    );
    let between = Quantity::more_than("the part of a texel by which the map's texels move here", part, TEXEL_ROUNDING);
    let fixes = vec![Fix::setting("light-frustum", "view-snapped"), fitted()];
    Some(SuspectedCause::new(Cause::MapSwims, case.evidence(sentence, shown_by, [between]), fixes))
}
