//! The light of a frame's shadow volumes: one for all of them, or one for each caster, as game engines give each model.

use super::corners::KnownCorners;
use super::light::{LEAST_EDGES, TriangleEdges, light_of, light_of_caster, light_of_unseen};
use super::objects::{draws, surface_corners};
use super::volume_parts::{DrawnTriangle, volume_parts};
use super::volumes::{VolumeCasters, asked_volumes, corners, is_of_most_volumes};
use super::{FoundLight, LightEvidence};
use crate::capture::CapturedLight;
use crate::plan::{FramePlan, LightId};
use glam::DVec4;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Finds the position of a light from the edges of its volumes, which run away from it; `None` where too few agree. Where
/// they run away from no one light, but those of each caster from one, it is the light of the most volumes.
pub fn light(plan: &FramePlan, light: LightId) -> Option<FoundLight> {
    let found = LightsOfCasters::of(plan, light, &surface_corners(plan));
    // Programs that count volumes of several directions together have no one light.
    let is_common = |found: &FoundLight| found.position.w != 0.0 || is_of_most_volumes(plan, light, found.position);
    let common = found.common.filter(is_common);
    found.elsewhere().or(common).or_else(|| found.only())
}

/// The shadow volumes of one caster.
pub(super) struct CasterVolumes<'a> {
    /// What casts them; `None` where the frame does not draw it.
    pub casters: Option<VolumeCasters>,
    pub triangles: Vec<DrawnTriangle<'a>>,
    edges: TriangleEdges,
    /// How many of its triangles run away from the light that they tell by themselves; 0 where they tell none.
    own_sides: usize,
    /// The light that they run away from: of [`LightsOfCasters::lights`] the one with this index.
    light: Option<usize>,
}

impl<'a> CasterVolumes<'a> {
    fn new(
        casters: Option<VolumeCasters>,
        triangles: Vec<DrawnTriangle<'a>>,
        known: &KnownCorners,
    ) -> CasterVolumes<'a> {
        let edges = TriangleEdges::of(&corners(&triangles), known);
        CasterVolumes { casters, triangles, edges, own_sides: 0, light: None }
    }

    /// Returns of these lights the one along whose lines most of its triangles have an edge, the first of equal ones, and how
    /// many have; `None` where none has.
    fn best(&self, lights: &[FoundLight]) -> Option<(usize, usize)> {
        let sides = lights.iter().map(|light| self.edges.along(light.position)).enumerate();
        sides.filter(|(_, sides)| *sides > 0).min_by_key(|(index, sides)| (Reverse(*sides), *index))
    }
}

/// The volumes of which a light asks the count, those of each caster by themselves, and where it is for them.
pub(super) struct LightsOfCasters<'a> {
    /// Where it is by the volumes of all casters together.
    common: Option<FoundLight>,
    /// Where it is for one caster or more.
    lights: Vec<FoundLight>,
    casters: Vec<CasterVolumes<'a>>,
}

impl<'a> LightsOfCasters<'a> {
    /// Finds the light of each caster; `known` has the corners of the frame's surfaces.
    pub fn of(plan: &'a FramePlan, light: LightId, known: &KnownCorners) -> LightsOfCasters<'a> {
        let mut all = draws(plan, |draw| draw.part.is_of_volume());
        all.retain(|(pass, _)| pass.light == Some(light));
        let common = light_of(&corners(&volume_parts(plan, all).concat()), known);
        let mut of_objects: BTreeMap<usize, (BTreeSet<usize>, Vec<DrawnTriangle>)> = BTreeMap::new();
        let mut others = Vec::new();
        for part in volume_parts(plan, asked_volumes(plan, light)) {
            match VolumeCasters::of(&corners(&part), known) {
                Some(casters) => {
                    let (others, triangles) = of_objects.entry(casters.first).or_default();
                    others.extend(casters.others);
                    triangles.extend(part);
                }
                None => others.push(CasterVolumes::new(None, part, known)),
            }
        }
        let casters = of_objects.into_iter().map(|(first, (others, triangles))| {
            CasterVolumes::new(Some(VolumeCasters { first, others }), triangles, known)
        });
        let mut found = LightsOfCasters { common, lights: Vec::from_iter(common), casters: casters.collect() };
        found.look_for_others(0, known);
        let ends = found.ends_of_sides();
        others.retain(|one| {
            !corners(&one.triangles).as_flattened().iter().all(|corner| ends.is_corner(corner.truncate()))
        });
        let from = found.casters.len();
        found.casters.extend(others);
        found.look_for_others(from, known);
        found
    }

    /// Adds lights of the casters from the one with this index on, where clearly more of their volumes run away from one of
    /// their own than from any that is known; then gives each its light. A few edges seem to run away from anywhere, and tell a
    /// light only where none is known for most of the volumes.
    fn look_for_others(&mut self, from: usize, known: &KnownCorners) {
        let mut own = Vec::new();
        for (index, caster) in self.casters.iter_mut().enumerate().skip(from) {
            let triangles = corners(&caster.triangles);
            let by_side = || light_of_unseen(&triangles, known, &self.lights).filter(|_| caster.casters.is_none());
            let Some(found) = light_of_caster(&triangles, known).or_else(by_side) else { continue };
            caster.own_sides = caster.edges.along(found.position);
            own.push((index, found));
        }
        own.sort_by_key(|(_, found)| Reverse(found.evidence.edges()));
        for (index, found) in own {
            let caster = &self.casters[index];
            let best = caster.best(&self.lights).map_or(0, |(_, sides)| sides);
            let is_sure = found.evidence.edges() >= LEAST_EDGES || best * 2 < caster.triangles.len();
            if is_sure && caster.own_sides * 4 > best * 5 && self.lights.len() < CapturedLight::MOST_PLACES {
                self.lights.push(found);
            }
        }
        for caster in &mut self.casters {
            let best = caster.best(&self.lights);
            let is_enough = |(_, sides): &(usize, usize)| caster.own_sides > 0 || sides * 2 > caster.triangles.len();
            caster.light = best.filter(is_enough).map(|(light, _)| light);
        }
    }

    /// Returns where the sides of volumes begin and end that run away from their caster's light. A cap that is drawn apart from
    /// them is known by it.
    fn ends_of_sides(&self) -> KnownCorners {
        let mut ends = KnownCorners::default();
        for (index, (caster, light)) in self.lit().enumerate() {
            ends.add(index, &caster.edges.ends(light));
        }
        ends
    }

    /// Returns the casters whose volumes run away from a light, with where it is.
    pub fn lit(&self) -> impl Iterator<Item = (&CasterVolumes<'a>, DVec4)> {
        self.casters.iter().filter_map(|one| Some((one, self.lights[one.light?].position)))
    }

    /// Returns for each light how many triangles of volumes run away from it.
    fn triangles_of_lights(&self) -> Vec<usize> {
        let mut of_lights = vec![0; self.lights.len()];
        for one in &self.casters {
            one.light.into_iter().for_each(|light| of_lights[light] += one.triangles.len());
        }
        of_lights
    }

    /// Returns whether nine tenths of the volumes or more run away from a light.
    fn are_most_lit(&self) -> bool {
        let lit: usize = self.triangles_of_lights().iter().sum();
        self.casters.iter().map(|one| one.triangles.len()).sum::<usize>() * 9 <= lit * 10
    }

    /// Returns the light of the most volumes if it is elsewhere for some, and too few run away from none.
    fn elsewhere(&self) -> Option<FoundLight> {
        let mut of_lights: Vec<(usize, usize)> = self.triangles_of_lights().into_iter().enumerate().collect();
        of_lights.retain(|(_, triangles)| *triangles > 0);
        of_lights.sort_by_key(|(_, triangles)| Reverse(*triangles));
        let &[(most, _), _, ..] = of_lights.as_slice() else { return None };
        let places = of_lights.len();
        let agree = self.lit().map(|(one, light)| one.edges.along(light)).sum();
        let of = self.lit().map(|(one, _)| one.triangles.len()).sum();
        let unseen = self.lit().filter(|(one, _)| one.casters.is_none()).count();
        let casters = self.lit().count() - unseen;
        let without = self.casters.len() - casters - unseen;
        let evidence = LightEvidence::EdgesOfCasters { agree, of, places, casters, unseen, without };
        self.are_most_lit().then(|| FoundLight { position: self.lights[most].position, evidence })
    }

    /// Returns the light of the most volumes where they tell it by themselves, by as many edges as one for all needs.
    fn only(&self) -> Option<FoundLight> {
        let of_lights = self.triangles_of_lights().into_iter().enumerate();
        let found = self.lights[of_lights.max_by_key(|(_, triangles)| *triangles)?.0];
        let is_other = self.common.is_none_or(|common| common != found);
        let is_known = self.are_most_lit() && found.evidence.edges() >= LEAST_EDGES;
        (is_other && is_known).then_some(found)
    }
}
