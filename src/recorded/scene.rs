//! The surfaces of a frame as the objects of a scene, which can be traced.
//!
//! Casters are known by the volumes and maps: a surface casts if a volume of some light begins at its corners, or if it is
//! drawn into a map whose view is known. A volume that begins at none is of a caster out of view: its near end casts,
//! unseen, or where it has none, a fan over its near edges. So does a draw into a map alone.

use super::corners::KnownCorners;
use super::darkening::asking_pass;
use super::ends::far_ends;
use super::space::{PassSpace, triangles};
use super::volume_parts::volume_parts;
use crate::plan::{ColorWrite, Draw, DrawPart, FramePlan, LightId, Pass};
use crate::scene::{Camera, Light, Material, Mesh, MeshBuilder, Object, Scene, SceneBuilder};
use glam::{DMat3, DMat4, DVec3, DVec4};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use wgpu_types::CompareFunction;

/// How far a direction may be off and be the same: the sine of the angle.
const REACH: f64 = 1e-3;

/// Returns the scene that a frame shows, seen by `camera`, in `lights`. Objects are named by their draws.
pub fn scene(plan: &FramePlan, camera: Camera, name: &str, lights: Vec<DVec4>) -> Scene {
    let mut volumes = draws(plan, |draw| draw.part.is_of_volume());
    let is_known = !volumes.is_empty();
    volumes.retain(|(pass, _)| is_asked_for(plan, pass));
    let of_maps = drawn_into_maps(plan);
    let mut objects = objects(plan);
    let is_known = is_known || !of_maps.is_empty();
    objects.iter_mut().for_each(|object| object.casts = !is_known);
    let mut corners = corners_of(&objects);
    let mut unseen = UnseenCasters::default();
    for (light, volumes) in volumes_of_lights(plan, volumes) {
        let position = lights.get(light).copied();
        // An end that is drawn apart from the sides is known as far by what lies before it.
        let mut is_far = position.map_or_else(Vec::new, |light| far_corners(&volumes, light)).into_iter();
        for (draw, part) in &volumes {
            let is_all_far = is_far.by_ref().take(part.len() * 3).filter(|is_far| *is_far).count() == part.len() * 3;
            // Most of a volume's finite corners are its caster's: those of a finite far end are not.
            match caster_of(&corners, &finite(part.as_flattened())) {
                Some(object) => objects[object].casts = true,
                None if is_all_far => {}
                None => unseen.add(draw, position.and_then(|light| near_end(part, light))),
            }
        }
    }
    for (draw, triangles) in of_maps {
        match caster_of(&corners, triangles.as_flattened()) {
            Some(object) => objects.get_mut(object).into_iter().for_each(|object| object.casts = true),
            None => {
                let before = unseen.objects.len();
                unseen.add(draw, built(triangles));
                if let Some(object) = unseen.objects.get(before) {
                    // Another face may have it, too, a little off.
                    corners.add(objects.len() + before, object.mesh.positions());
                }
            }
        }
    }
    let lights = lights.into_iter().map(|position| Light { position, ..Light::point(DVec3::ZERO) });
    let builder = SceneBuilder::new(name).camera(camera).lights(lights);
    builder.objects(objects).objects(unseen.objects).build()
}

/// Casters that the picture does not show, each once.
#[derive(Default)]
struct UnseenCasters {
    objects: Vec<Object>,
    known: BTreeSet<u64>,
}

impl UnseenCasters {
    /// Adds what a draw shows of a caster, unless that is known already.
    fn add(&mut self, draw: &Draw, mesh: Option<Mesh>) {
        if let Some(mesh) = mesh.filter(|mesh| self.known.insert(mesh.content_hash())) {
            self.objects.push(Object::of(format!("caster of {}", draw.name), mesh).unseen());
        }
    }
}

/// Returns whether nine tenths of the volumes that are counted for a light, by their triangles, are of one at `position`: some
/// of their corners are carried away from it, or all lie on surfaces, as those of caps do. Others are of another light that
/// is counted with it.
pub(super) fn is_of_most_volumes(plan: &FramePlan, light: LightId, position: DVec4) -> bool {
    let mut volumes = draws(plan, |draw| draw.part.is_of_volume());
    volumes.retain(|(pass, _)| pass.light == Some(light) && is_asked_for(plan, pass));
    let volumes = volumes_of_lights(plan, volumes).remove(&light.0).unwrap_or_default();
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
type DrawnVolume<'a> = (&'a Draw, Vec<[DVec4; 3]>);

/// Returns the parts of the volumes that are counted for each light, by its index, in the frame's order.
fn volumes_of_lights<'a>(plan: &FramePlan, volumes: Vec<(&Pass, &'a Draw)>) -> BTreeMap<usize, Vec<DrawnVolume<'a>>> {
    let mut of_lights: BTreeMap<usize, Vec<DrawnVolume>> = BTreeMap::new();
    for (pass, draw) in volumes {
        let Some(light) = pass.light else { continue };
        let places = PassSpace::new(plan, pass).places(plan, draw);
        let parts = volume_parts(plan, draw, &places).into_iter().map(|part| (draw, part));
        of_lights.entry(light.0).or_default().extend(parts);
    }
    of_lights
}

/// Returns for each corner of these volumes, one after the other, whether it is of a far end of any of them.
fn far_corners(volumes: &[DrawnVolume], light: DVec4) -> Vec<bool> {
    let corners = volumes.iter().flat_map(|(_, part)| part.as_flattened());
    far_ends(&corners.copied().map(Some).collect::<Vec<_>>(), light)
}

/// Returns the object that has corners at a quarter of these places or more: those of one volume.
fn caster_of(corners: &KnownCorners, places: &[DVec3]) -> Option<usize> {
    corners.most(places).filter(|(_, count)| count * 4 >= places.len()).map(|(object, _)| object)
}

/// Returns the corners of the surfaces that a frame draws.
pub(super) fn surface_corners(plan: &FramePlan) -> KnownCorners {
    corners_of(&objects(plan))
}

fn corners_of(objects: &[Object]) -> KnownCorners {
    let mut corners = KnownCorners::default();
    for (index, object) in objects.iter().enumerate() {
        corners.add(index, object.mesh.positions());
    }
    corners
}

/// Returns the surfaces of a frame alone, seen by `camera`, without lights.
pub(super) fn surfaces(plan: &FramePlan, camera: Camera) -> Scene {
    SceneBuilder::new("surfaces").camera(camera).objects(objects(plan)).build()
}

/// Returns whether a draw is of a surface: what blends where the stencil lets it lies over surfaces that are drawn already,
/// though it may write depth.
fn is_surface(draw: &Draw) -> bool {
    let raster = &draw.raster;
    let blends = !matches!(raster.color, ColorWrite::Replace | ColorWrite::None);
    let is_over = blends && raster.stencil.is_enabled() && draw.raster.stencil.front.compare != CompareFunction::Always;
    draw.part == DrawPart::Surface && raster.depth_write && !is_over
}

/// Returns the surfaces that a frame draws, each once, in the eye's space and named by their draws. All cast.
fn objects(plan: &FramePlan) -> Vec<Object> {
    let mut objects: Vec<Object> = Vec::new();
    for (pass, draw) in draws(plan, is_surface) {
        let places = PassSpace::new(plan, pass).places(plan, draw);
        let mesh = mesh(plan, draw, &places, |corners| corners.iter().all(|corner| corner.w == 1.0));
        // A surface that is drawn again, for light or ambient, is one object.
        let is_known = |mesh: &Mesh| objects.iter().any(|one| one.mesh.content_hash() == mesh.content_hash());
        let Some(mesh) = mesh.filter(|mesh| !is_known(mesh)) else { continue };
        objects.push(Object::new(draw.name.clone(), Arc::new(mesh), Material::default()));
    }
    objects
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

/// Returns the draws of shadow volumes with their passes, and the index of the object of `scene` that casts each: most
/// of a volume's corners that are not at infinity are its caster's.
pub fn casters<'a>(plan: &'a FramePlan, scene: &Scene) -> Vec<(&'a Pass, &'a Draw, usize)> {
    let mut corners = KnownCorners::default();
    for (index, object) in scene.objects.iter().enumerate().filter(|(_, object)| object.casts) {
        corners.add(index, &object.world_positions());
    }
    let thrown = |(pass, draw)| {
        let places: Vec<DVec4> = PassSpace::new(plan, pass).places(plan, draw).into_iter().flatten().collect();
        let (caster, _) = corners.most(&finite(&places))?;
        Some((pass, draw, caster))
    };
    draws(plan, |draw| draw.part.is_of_volume()).into_iter().filter_map(thrown).collect()
}

/// Returns the view-space points whose w is 1, without w; leaves out those at infinity. Expects w to be 1 or 0, and does
/// not divide by it.
fn finite(places: &[DVec4]) -> Vec<DVec3> {
    places.iter().filter(|place| place.w == 1.0).map(|place| place.truncate()).collect()
}

/// Returns the draws in passes of the picture for which `is_meant` is true, with their passes, in the frame's order.
fn draws(plan: &FramePlan, is_meant: impl Fn(&Draw) -> bool) -> Vec<(&Pass, &Draw)> {
    let picture = plan.passes.iter().filter(|pass| plan.is_of_picture(pass));
    picture
        .flat_map(|pass| pass.draws.iter().map(move |draw| (pass, draw)))
        .filter(|(_, draw)| is_meant(draw))
        .collect()
}

/// Builds a mesh, in view space, from the triangles of a draw for which `is_meant` is true. `places` has the vertices
/// as homogeneous view-space points, w 1 or 0; w is dropped, so `is_meant` should refuse points at infinity. `None`
/// where no triangle is left.
fn mesh(
    plan: &FramePlan,
    draw: &Draw,
    places: &[Option<DVec4>],
    is_meant: impl Fn(&[DVec4; 3]) -> bool,
) -> Option<Mesh> {
    let chosen: Vec<[DVec4; 3]> =
        triangles(plan, draw, places).map(|(_, corners)| corners).filter(|corners| is_meant(corners)).collect();
    built(chosen.iter().map(|corners| corners.map(|corner| corner.truncate())).collect())
}

fn built(triangles: Vec<[DVec3; 3]>) -> Option<Mesh> {
    let indices = (0..triangles.len() as u32).map(|index| [index * 3, index * 3 + 1, index * 3 + 2]);
    let builder = MeshBuilder {
        positions: triangles.as_flattened().to_vec(),
        triangles: indices.collect(),
        ..MeshBuilder::default()
    };
    builder.build().ok().filter(|mesh| !mesh.triangles().is_empty())
}

/// Returns the part of a volume that stops light where its caster is not visible, as a mesh in view space: the
/// triangles at its near end, or where it has none a fan over the near edges of its sides round their middle. `None`
/// where that has no triangle.
fn near_end(volume: &[[DVec4; 3]], light: DVec4) -> Option<Mesh> {
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
