//! The light of a frame's shadow volumes: one for all of them, or one for each caster, as game engines give each model.

use super::corners::KnownCorners;
use super::light::{light_of, light_of_caster, sides_of};
use super::objects::{draws, surface_corners};
use super::volume_parts::{DrawnTriangle, volume_parts};
use super::volumes::{asked_volumes, caster_of, corners, finite, is_of_most_volumes};
use super::{FoundLight, LightEvidence};
use crate::plan::{FramePlan, LightId};
use std::collections::BTreeMap;

/// Finds the position of a light from the edges of its volumes, which run away from it; `None` where too few agree. Where
/// they run away from no one light, but those of each caster from one, it is the light of the caster with the most edges.
pub fn light(plan: &FramePlan, light: LightId) -> Option<FoundLight> {
    let known = surface_corners(plan);
    let mut all = draws(plan, |draw| draw.part.is_of_volume());
    all.retain(|(pass, _)| pass.light == Some(light));
    let all: Vec<_> = volume_parts(plan, all).concat();
    let common = light_of(&corners(&all), &known);
    // Programs that count volumes of several directions together have no one light.
    let is_common = |found: &FoundLight| found.position.w != 0.0 || is_of_most_volumes(plan, light, found.position);
    let common = common.filter(is_common);
    let casters = volumes_of_casters(plan, light, &known);
    let shared = common.filter(|found| casters.iter().all(|one| one.is_lit_from(found)));
    shared.or_else(|| of_casters(&casters)).or(common)
}

/// The shadow volumes of one caster.
pub(super) struct CasterVolumes<'a> {
    /// Index of the object that casts them; `None` where the frame does not draw it.
    pub caster: Option<usize>,
    pub triangles: Vec<DrawnTriangle<'a>>,
    /// The light that they run away from.
    pub light: Option<FoundLight>,
}

impl CasterVolumes<'_> {
    /// Returns how many of its triangles have an edge that runs away from a light.
    fn sides(&self, light: &FoundLight) -> usize {
        sides_of(&corners(&self.triangles), light.position)
    }

    /// Returns whether its own light explains no more than twice as many of its triangles as this one.
    fn is_lit_from(&self, light: &FoundLight) -> bool {
        self.light.is_none_or(|own| self.sides(&own) <= 2 * self.sides(light))
    }
}

/// Returns the volumes of which the light asks the count, those of each caster by themselves, with its own light. `known` has
/// the corners of the frame's surfaces.
pub(super) fn volumes_of_casters<'a>(
    plan: &'a FramePlan,
    light: LightId,
    known: &KnownCorners,
) -> Vec<CasterVolumes<'a>> {
    let mut of_objects: BTreeMap<usize, Vec<DrawnTriangle>> = BTreeMap::new();
    let mut others: Vec<Vec<DrawnTriangle>> = Vec::new();
    for part in volume_parts(plan, asked_volumes(plan, light)) {
        match caster_of(known, &finite(corners(&part).as_flattened())) {
            Some(object) => of_objects.entry(object).or_default().extend(part),
            None => others.push(part),
        }
    }
    let of_objects = of_objects.into_iter().map(|(object, triangles)| (Some(object), triangles));
    let all = of_objects.chain(others.into_iter().map(|triangles| (None, triangles)));
    let with_light = |(caster, triangles): (Option<usize>, Vec<DrawnTriangle<'a>>)| {
        let light = light_of_caster(&corners(&triangles), known);
        CasterVolumes { caster, triangles, light }
    };
    let mut all: Vec<CasterVolumes> = all.map(with_light).collect();
    // A few edges may seem to run away from anywhere; models of several meshes have one light for all.
    let lights: Vec<FoundLight> = all.iter().filter_map(|one| one.light).collect();
    for one in &mut all {
        let best = lights.iter().copied().max_by_key(|light| one.sides(light));
        let is_better = |light: &FoundLight| one.light.is_none_or(|own| one.sides(&own) < one.sides(light));
        if let Some(light) = best.filter(|light| one.sides(light) * 2 > one.triangles.len() && is_better(light)) {
            one.light = Some(light);
        }
    }
    all
}

/// Returns the light of the caster with the most edges; `None` where a tenth of the triangles or more are of casters without
/// one.
fn of_casters(volumes: &[CasterVolumes]) -> Option<FoundLight> {
    let (with, without): (Vec<&CasterVolumes>, Vec<_>) = volumes.iter().partition(|one| one.light.is_some());
    let count = |volumes: &[&CasterVolumes]| volumes.iter().map(|one| one.triangles.len()).sum::<usize>();
    let edges = |found: &FoundLight| match found.evidence {
        LightEvidence::Edges { agree, of } => (agree, of),
        _ => (0, 0),
    };
    let lights = || with.iter().filter_map(|one| one.light);
    let most = lights().max_by_key(|found| edges(found).0).filter(|_| count(&without) * 9 <= count(&with))?;
    let (agree, of) = lights().map(|found| edges(&found)).fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    Some(FoundLight { evidence: LightEvidence::EdgesOfCasters { agree, of, casters: with.len() }, ..most })
}
