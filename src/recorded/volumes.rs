//! Shadow volumes and what casts them.

use super::corners::KnownCorners;
use super::darkening::asking_pass;
use super::ends::far_ends;
use super::objects::{built, draws, surface_corners};
use super::space::PassSpace;
use super::volume_parts::{DrawnTriangle, volume_parts};
use crate::plan::{Draw, FramePlan, LightId, Pass};
use crate::scene::{Mesh, Scene};
use glam::{DVec3, DVec4};
use std::collections::{BTreeSet, HashMap};

/// How far a direction may be off and be the same: the sine of the angle.
const REACH: f64 = 1e-3;

/// Returns the draws of shadow volumes of which the light asks the count, with their passes.
pub fn asked_volumes(plan: &FramePlan, light: LightId) -> Vec<(&Pass, &Draw)> {
    let mut volumes = draws(plan, |draw| draw.part.is_of_volume());
    volumes.retain(|(pass, _)| pass.light == Some(light) && is_asked_for(plan, pass));
    volumes
}

/// Returns the volumes of which the light asks the count, each draw in the parts that it has, in the frame's order.
pub(super) fn drawn_volumes(plan: &FramePlan, light: LightId) -> Vec<DrawnVolume<'_>> {
    let parts_of = |drawn| volume_parts(plan, [drawn]).into_iter().map(move |part| (drawn.1, corners(&part)));
    asked_volumes(plan, light).into_iter().flat_map(parts_of).collect()
}

/// Returns the corners of triangles.
pub(super) fn corners(triangles: &[DrawnTriangle]) -> Vec<[DVec4; 3]> {
    triangles.iter().map(|(_, corners)| *corners).collect()
}

/// Returns whether nine tenths of the volumes that are counted for a light, by their triangles, are of one at `position`: some
/// of their corners are carried away from it, or all lie on surfaces, as those of caps do. Others are of another light that
/// is counted with it.
pub(super) fn is_of_most_volumes(plan: &FramePlan, light: LightId, position: DVec4) -> bool {
    let volumes = drawn_volumes(plan, light);
    let corners = surface_corners(plan);
    let mut is_far = far_corners(&volumes, position).into_iter();
    let (mut own, mut others) = (0, 0);
    for (_, part) in &volumes {
        // At infinity is the end of any volume: of this light's, what lies there is straight away from it.
        let is_away = |corner: &DVec4| corner.w != 0.0 || is_straight_away(*corner, position);
        let ends = part.as_flattened().iter().zip(is_far.by_ref().take(part.len() * 3));
        let carried = ends.filter(|(corner, is_far)| *is_far && is_away(corner)).count();
        let places = finite(part.as_flattened());
        let on_surfaces = places.iter().filter(|place| corners.is_corner(**place)).count();
        match carried == 0 && on_surfaces < places.len() {
            true => others += part.len(),
            false => own += part.len(),
        }
    }
    others * 9 <= own
}

/// Returns whether a direction is against the one towards a light, but for rounding.
fn is_straight_away(corner: DVec4, light: DVec4) -> bool {
    let [corner, towards] = [corner, light].map(|place| place.truncate().normalize_or_zero());
    corner.dot(towards) < 0.0 && corner.cross(towards).length() < REACH
}

/// Returns whether what a pass counts is asked for by a later one of its light, or none of its light asks.
fn is_asked_for(plan: &FramePlan, pass: &Pass) -> bool {
    let asking = pass.light.and_then(|light| asking_pass(plan, light));
    asking.is_none_or(|asking| plan.passes[..asking].iter().any(|before| std::ptr::eq(before, pass)))
}

/// A part of a draw of shadow volumes: its triangles in view space.
pub(super) type DrawnVolume<'a> = (&'a Draw, Vec<[DVec4; 3]>);

/// Returns for each corner of these volumes, one after the other, whether it is of a far end of any of them.
pub(super) fn far_corners(volumes: &[DrawnVolume], light: DVec4) -> Vec<bool> {
    let corners = volumes.iter().flat_map(|(_, part)| part.as_flattened());
    far_ends(&corners.copied().map(Some).collect::<Vec<_>>(), light)
}

/// Returns the object that has corners at a quarter of these places or more: those of one volume.
pub(super) fn caster_of(corners: &KnownCorners, places: &[DVec3]) -> Option<usize> {
    corners.most(places).filter(|(_, count)| count * 4 >= places.len()).map(|(object, _)| object)
}

/// The objects that cast a volume of which the frame shows a caster.
pub(super) struct VolumeCasters {
    /// The one that has corners at the most places of the volume.
    pub first: usize,
    /// Others that share corners with it, so that one connected volume is of all of them: those at whose corners an edge of
    /// the volume begins and ends that is not of the first.
    pub others: BTreeSet<usize>,
}

impl VolumeCasters {
    /// Returns what casts a volume; `None` where the frame does not draw it.
    pub fn of(volume: &[[DVec4; 3]], corners: &KnownCorners) -> Option<VolumeCasters> {
        let first = caster_of(corners, &finite(volume.as_flattened()))?;
        // Many edges end at a corner, and looking one up takes a while.
        let mut known: HashMap<[u64; 3], BTreeSet<usize>> = HashMap::new();
        let bits = |place: &DVec4| place.truncate().to_array().map(f64::to_bits);
        for place in volume.as_flattened().iter().filter(|place| place.w == 1.0) {
            known.entry(bits(place)).or_insert_with(|| corners.objects_at(place.truncate()));
        }
        let mut others = BTreeSet::new();
        for [from, to] in volume.iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]) {
            let ends = [from, to].map(|end| known.get(&bits(end)).filter(|_| end.w == 1.0));
            let [Some(of_from), Some(of_to)] = ends else { continue };
            if !(of_from.contains(&first) && of_to.contains(&first)) {
                others.extend(of_from & of_to);
            }
        }
        Some(VolumeCasters { first, others })
    }
}

/// Returns the draws of a light's shadow volumes with their passes, and where the light of each is: that of its caster where it
/// has one of its own.
pub fn volumes_with_lights<'a>(plan: &'a FramePlan, scene: &Scene, light: LightId) -> Vec<(&'a Pass, &'a Draw, DVec4)> {
    let of_light = scene.lights.get(light.0).map_or(DVec4::ZERO, |light| light.position);
    let is_one = scene.objects.iter().all(|object| !object.light_positions.contains_key(&light.0));
    let known = if is_one { KnownCorners::default() } else { caster_corners(scene) };
    let with_light = |(pass, draw): (&'a Pass, &'a Draw)| {
        let caster = known.most(&finite_places(plan, pass, draw)).map(|(object, _)| object);
        let own = caster.and_then(|caster| scene.objects[caster].light_positions.get(&light.0).copied());
        (pass, draw, own.unwrap_or(of_light))
    };
    let mut volumes = draws(plan, |draw| draw.part.is_of_volume());
    volumes.retain(|(pass, _)| pass.light == Some(light));
    volumes.into_iter().map(with_light).collect()
}

/// Returns the draws of shadow volumes with their passes, and the index of the object of `scene` that casts each: most
/// of a volume's corners that are not at infinity are its caster's.
pub fn casters<'a>(plan: &'a FramePlan, scene: &Scene) -> Vec<(&'a Pass, &'a Draw, usize)> {
    let corners = caster_corners(scene);
    let thrown = |(pass, draw)| {
        let (caster, _) = corners.most(&finite_places(plan, pass, draw))?;
        Some((pass, draw, caster))
    };
    draws(plan, |draw| draw.part.is_of_volume()).into_iter().filter_map(thrown).collect()
}

/// Returns the corners of the objects of a scene that cast.
fn caster_corners(scene: &Scene) -> KnownCorners {
    let mut corners = KnownCorners::default();
    for (index, object) in scene.objects.iter().enumerate().filter(|(_, object)| object.casts) {
        corners.add(index, &object.world_positions());
    }
    corners
}

/// Returns the vertices of a draw's mesh in view space that are not at infinity.
fn finite_places(plan: &FramePlan, pass: &Pass, draw: &Draw) -> Vec<DVec3> {
    let places: Vec<DVec4> = PassSpace::new(plan, pass).places(plan, draw).into_iter().flatten().collect();
    finite(&places)
}

/// Returns the view-space points whose w is 1, without w; leaves out those at infinity. Expects w to be 1 or 0, and does
/// not divide by it.
pub(super) fn finite(places: &[DVec4]) -> Vec<DVec3> {
    places.iter().filter(|place| place.w == 1.0).map(|place| place.truncate()).collect()
}

/// Returns the part of a volume that stops light where its caster is not visible, as a mesh in view space: the
/// triangles at its near end, or where it has none a fan over the near edges of its sides round their middle. `None`
/// where that has no triangle.
pub(super) fn near_end(volume: &[[DVec4; 3]], light: DVec4) -> Option<Mesh> {
    let places: Vec<Option<DVec4>> = volume.as_flattened().iter().copied().map(Some).collect();
    let far = far_ends(&places, light);
    let (mut cap, mut edges) = (Vec::new(), Vec::new());
    for (corners, far) in volume.iter().zip(far.as_chunks::<3>().0) {
        let near = corners.iter().zip(far).filter(|(_, is_far)| !**is_far).map(|(corner, _)| corner.truncate());
        match near.collect::<Vec<_>>().as_slice() {
            [a, b, c] => cap.push([*a, *b, *c]),
            [a, b] => edges.push([*a, *b]),
            _ => {}
        }
    }
    if !cap.is_empty() {
        return built(cap);
    }
    let middle = edges.as_flattened().iter().sum::<DVec3>() / (edges.len() as f64 * 2.0);
    built(edges.into_iter().map(|[from, to]| [from, to, middle]).collect())
}
