//! The scene of a frame, which can be traced: its surfaces and what casts in its lights.
//!
//! Casters are known by the volumes and maps: a surface casts if a volume of some light begins at its corners, or if it is
//! drawn into a map whose view is known. A volume that begins at none is of a caster out of view: its near end casts,
//! unseen, or where it has none, a fan over its near edges. So does a draw into a map alone.

use super::corners::KnownCorners;
use super::darkening::asking_pass;
use super::lights::LightsOfCasters;
use super::objects::{built, corners_of, draws, objects};
use super::space::triangles;
use super::volumes::{self, VolumeCasters, caster_of, drawn_volumes, far_corners, near_end};
use super::{FoundLight, LightEvidence};
use crate::plan::{Draw, FramePlan, LightId, Pass};
use crate::scene::{Camera, Light, Mesh, Object, Scene, SceneBuilder};
use glam::{DMat3, DMat4, DVec3, DVec4};
use std::collections::BTreeMap;

/// Returns the scene that a frame shows, seen by `camera`, in `lights`. Objects are named by their draws; where each caster has
/// a light of its own, they have it.
pub fn scene(plan: &FramePlan, camera: Camera, name: &str, lights: &[FoundLight]) -> Scene {
    let has_volumes = !draws(plan, |draw| draw.part.is_of_volume()).is_empty();
    let of_maps = drawn_into_maps(plan);
    let is_known = has_volumes || !of_maps.is_empty();
    let mut objects = objects(plan);
    objects.iter_mut().for_each(|object| object.casts = !is_known);
    let mut corners = corners_of(&objects);
    let mut unseen = UnseenCasters::default();
    for (index, found) in lights.iter().enumerate() {
        let mut casters = CastersOfLight { index, corners: &corners, objects: &mut objects, unseen: &mut unseen };
        match found.evidence {
            LightEvidence::EdgesOfCasters { .. } => casters.by_own_light(plan),
            LightEvidence::Edges { .. } | LightEvidence::Map { .. } => casters.by_light(plan, found.position),
        }
    }
    for (draw, triangles) in of_maps {
        match caster_of(&corners, triangles.as_flattened()) {
            Some(object) => objects.get_mut(object).into_iter().for_each(|object| object.casts = true),
            None => {
                let before = unseen.objects.len();
                unseen.add(draw, built(triangles), None);
                if let Some(object) = unseen.objects.get(before) {
                    // Another face may have it, too, a little off.
                    corners.add(objects.len() + before, object.mesh.positions());
                }
            }
        }
    }
    let lights = lights.iter().map(|found| Light { position: found.position, ..Light::point(DVec3::ZERO) });
    let builder = SceneBuilder::new(name).camera(camera).lights(lights);
    builder.objects(objects).objects(unseen.objects).build()
}

/// Returns where the light with an index is for objects that have it elsewhere, by their names.
pub fn lights_of_casters(scene: &Scene, light: usize) -> BTreeMap<String, DVec4> {
    let own = scene.objects.iter().map(|object| (&object.name, object.light_positions.get(&light)));
    own.filter_map(|(name, position)| Some((name.clone(), *position?))).collect()
}

/// What casts in the light with an index, by its volumes.
struct CastersOfLight<'a> {
    index: usize,
    corners: &'a KnownCorners,
    objects: &'a mut [Object],
    unseen: &'a mut UnseenCasters,
}

impl CastersOfLight<'_> {
    /// Marks and adds what casts the volumes of a light in one place. A pass that darkens ignores on which side of a surface the
    /// light is, and rays may not let that decide: for this they know the light as that of each caster.
    fn by_light(&mut self, plan: &FramePlan, position: DVec4) {
        let asking = asking_pass(plan, LightId(self.index)).and_then(|index| plan.passes[index].recorded.as_ref());
        let own = asking.filter(|recorded| recorded.darkens).map(|_| position);
        let volumes = drawn_volumes(plan, LightId(self.index));
        // An end that is drawn apart from the sides is known as far by what lies before it.
        let mut is_far = far_corners(&volumes, position).into_iter();
        for (draw, part) in &volumes {
            let far = is_far.by_ref().take(part.len() * 3).filter(|is_far| *is_far).count();
            // Most of a volume's finite corners are its caster's: those of a finite far end are not.
            match VolumeCasters::of(part, self.corners) {
                Some(VolumeCasters { first, others }) => {
                    for object in others.into_iter().chain([first]) {
                        self.objects[object].casts = true;
                        self.objects[object].light_positions.extend(own.map(|position| (self.index, position)));
                    }
                }
                None if far == part.len() * 3 => {}
                None => {
                    if let Some(object) = self.unseen.add(draw, near_end(part, position), own) {
                        object.light_positions.extend(own.map(|position| (self.index, position)));
                    }
                }
            }
        }
    }

    /// Marks and adds what casts the volumes of a light that is elsewhere for each, with where it is for it.
    fn by_own_light(&mut self, plan: &FramePlan) {
        let found = LightsOfCasters::of(plan, LightId(self.index), self.corners);
        for (volumes, position) in found.lit() {
            let Some(casters) = &volumes.casters else {
                let mesh = near_end(&volumes::corners(&volumes.triangles), position);
                if let Some(object) = self.unseen.add(volumes.triangles[0].0, mesh, Some(position)) {
                    object.casts = true;
                    object.light_positions.insert(self.index, position);
                }
                continue;
            };
            // What has a volume of which it is the first has its light by that.
            self.objects[casters.first].light_positions.insert(self.index, position);
            for object in casters.others.iter().chain([&casters.first]) {
                self.objects[*object].casts = true;
                self.objects[*object].light_positions.entry(self.index).or_insert(position);
            }
        }
    }
}

/// Casters that the picture does not show, each once.
#[derive(Default)]
struct UnseenCasters {
    objects: Vec<Object>,
    /// The index of each by the hash of its mesh, and the bits of where its own light is.
    known: BTreeMap<(u64, Option<[u64; 4]>), usize>,
}

impl UnseenCasters {
    /// Adds what a draw shows of a caster, with the light at a position if that is its own, unless that is known already, and
    /// returns it; `None` where it shows nothing.
    fn add(&mut self, draw: &Draw, mesh: Option<Mesh>, own: Option<DVec4>) -> Option<&mut Object> {
        let mesh = mesh?;
        let key = (mesh.content_hash(), own.map(|position| position.to_array().map(f64::to_bits)));
        let index = *self.known.entry(key).or_insert(self.objects.len());
        if index == self.objects.len() {
            self.objects.push(Object::of(format!("caster of {}", draw.name), mesh).unseen());
        }
        self.objects.get_mut(index)
    }
}

/// Returns the draws into shadow maps whose view is known, each with its triangles in the eye's space.
fn drawn_into_maps(plan: &FramePlan) -> Vec<(&Draw, Vec<[DVec3; 3]>)> {
    let view = |pass: &Pass| {
        let (light, target) = (pass.light?, pass.depth_stencil.as_ref()?);
        let map = plan.lights.get(light.0)?.map.as_ref().filter(|map| map.attachment == target.attachment)?;
        let is_known = plan.lights[light.0].relative_position != [0.0; 4];
        let clip_from_eye = map.clip_from_light.get(target.layer as usize).filter(|_| is_known)?;
        Some((EyeFromMap::new(clip_from_eye)?, plan.attachments.get(map.attachment.0)?.size))
    };
    let passes = plan.passes.iter().filter_map(|pass| Some((pass, view(pass)?)));
    let draws = passes.flat_map(|(pass, view)| pass.draws.iter().map(move |draw| (pass, draw, view)));
    let in_eye_space = |(pass, draw, (eye_from_map, size)): (&Pass, _, (EyeFromMap, [u32; 2]))| {
        let draw: &Draw = draw;
        let place = |vertex: &[f32; 4]| {
            let clip = pass.viewport(size).clip_of_target(size, DVec4::from_array(vertex.map(f64::from)));
            Some(eye_from_map.place(clip).extend(1.0)).filter(|place| place.is_finite())
        };
        let places: Vec<Option<DVec4>> = plan.meshes[draw.mesh.0].vertices.data().iter().map(place).collect();
        let corners = triangles(plan, draw, &places).map(|(_, corners)| corners.map(|corner| corner.truncate()));
        let corners: Vec<[DVec3; 3]> = corners.collect();
        (draw, corners)
    };
    draws.map(|(pass, draw, view)| in_eye_space((pass, draw, view))).collect()
}

/// The conversion from a shadow map's clip space to the eye's space, by x, y and w. Of these w is the distance itself, while
/// depth barely changes far from a near plane. A parallel map, whose w is the same everywhere, has its depth instead.
#[derive(Debug, Clone, Copy)]
struct EyeFromMap {
    eye_from_rows: DMat3,
    /// What the rows have at the eye.
    origin: DVec3,
    is_parallel: bool,
}

impl EyeFromMap {
    /// Returns the inverse of a map's view; `None` where it has none, as for a view that is not known.
    fn new(clip_from_eye: &DMat4) -> Option<EyeFromMap> {
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_eye.row(row));
        let is_parallel = w.truncate().length() < 1e-6 * x.truncate().length();
        let rows = [x, y, if is_parallel { z } else { w }];
        let eye_from_rows = DMat3::from_cols(rows[0].truncate(), rows[1].truncate(), rows[2].truncate());
        let eye_from_rows = eye_from_rows.transpose().inverse();
        let is_known = eye_from_rows.is_finite();
        is_known.then_some(EyeFromMap { eye_from_rows, origin: DVec3::from_array(rows.map(|row| row.w)), is_parallel })
    }

    fn place(&self, clip: DVec4) -> DVec3 {
        self.eye_from_rows * (DVec3::new(clip.x, clip.y, if self.is_parallel { clip.z } else { clip.w }) - self.origin)
    }
}
