//! The surfaces of a frame as the objects of a scene, which can be traced.
//!
//! What casts is told by the volumes: a surface casts if a volume of some light begins at its corners. A volume that
//! begins at none is of a caster out of view: its near end casts, unseen, or where it has none, a fan over its near edges.

use super::space::{Space, triangles};
use crate::plan::{Draw, FramePlan, Part, Pass};
use crate::scene::{Camera, Light, Material, Mesh, MeshBuilder, Object, Scene, SceneBuilder};
use glam::{DVec3, DVec4};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Corners are the same where they are no farther apart, in parts of their distance from the eye.
const SAME_PLACE: f64 = 1e-4;

/// The scene that a frame is of, seen by `camera`, in `lights`. Objects are named by their draws.
#[must_use]
pub fn scene(plan: &FramePlan, camera: Camera, name: &str, lights: Vec<DVec4>) -> Scene {
    let surfaces = draws(plan, |draw| draw.part == Part::Surface && draw.raster.depth_write);
    let volumes = draws(plan, |draw| draw.part.is_of_volume());
    let mut objects: Vec<(Object, Corners)> = Vec::new();
    for (pass, draw) in surfaces {
        let space = Space::new(plan, pass);
        let places = space.places(plan, draw);
        let Some(mesh) = mesh(plan, draw, &places, |corners| corners.iter().all(|corner| corner.w == 1.0)) else {
            continue;
        };
        // What is drawn again, for light or ambient, is one object.
        if objects.iter().any(|(known, _)| known.mesh.content_hash() == mesh.content_hash()) {
            continue;
        }
        let corners = Corners::new(mesh.positions());
        let object =
            Object { casts: volumes.is_empty(), ..Object::new(draw.name.clone(), Arc::new(mesh), Material::default()) };
        objects.push((object, corners));
    }
    let mut unseen = Vec::new();
    for (pass, draw) in volumes {
        let places = Space::new(plan, pass).places(plan, draw);
        let finite = finite(&places);
        // Most of a volume's finite corners are its caster's: those of a finite far end are not.
        let most = objects
            .iter_mut()
            .map(|(object, corners)| (corners.count(&finite), object))
            .max_by_key(|(count, _)| *count);
        match most {
            Some((count, object)) if count * 4 >= finite.len() && count > 0 => object.casts = true,
            _ => unseen.extend(
                near_end(plan, draw, &places).map(|mesh| Object::of(format!("caster of {}", draw.name), mesh).unseen()),
            ),
        }
    }
    let lights = lights.into_iter().map(|position| Light { position, ..Light::point(DVec3::ZERO) });
    let builder = SceneBuilder::new(name).camera(camera).lights(lights);
    builder.objects(objects.into_iter().map(|(object, _)| object)).objects(unseen).build()
}

/// The draws of shadow volumes with their passes, and the index of the object of `scene` that throws each: most of a
/// volume's corners that are not at infinity are its caster's.
#[must_use]
pub fn casters<'a>(plan: &'a FramePlan, scene: &Scene) -> Vec<(&'a Pass, &'a Draw, usize)> {
    let casting = scene.objects.iter().enumerate().filter(|(_, object)| object.casts);
    let casting: Vec<(usize, Corners)> =
        casting.map(|(index, object)| (index, Corners::new(&object.world_positions()))).collect();
    let thrown = |(pass, draw)| {
        let finite = finite(&Space::new(plan, pass).places(plan, draw));
        let most = casting.iter().max_by_key(|(_, corners)| corners.count(&finite));
        most.map(|(index, _)| (pass, draw, *index))
    };
    draws(plan, |draw| draw.part.is_of_volume()).into_iter().filter_map(thrown).collect()
}

/// Places that are not at infinity.
fn finite(places: &[Option<DVec4>]) -> Vec<DVec3> {
    places.iter().flatten().filter(|place| place.w == 1.0).map(|place| place.truncate()).collect()
}

/// Draws of the picture, with their passes.
fn draws(plan: &FramePlan, is_meant: impl Fn(&Draw) -> bool) -> Vec<(&Pass, &Draw)> {
    let picture = plan.passes.iter().filter(|pass| plan.is_of_picture(pass));
    picture
        .flat_map(|pass| pass.draws.iter().map(move |draw| (pass, draw)))
        .filter(|(_, draw)| is_meant(draw))
        .collect()
}

/// The triangles of a draw that are meant; `None` where there are none.
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

/// What of a volume stops light where its caster is not seen: a finite volume itself, the near cap of an infinite one,
/// or a fan over the edges of its sides.
fn near_end(plan: &FramePlan, draw: &Draw, places: &[Option<DVec4>]) -> Option<Mesh> {
    if let Some(cap) = mesh(plan, draw, places, |corners| corners.iter().all(|corner| corner.w == 1.0)) {
        return Some(cap);
    }
    let edge = |corners: [DVec4; 3]| {
        let near: Vec<DVec3> =
            corners.iter().filter(|corner| corner.w == 1.0).map(|corner| corner.truncate()).collect();
        <[DVec3; 2]>::try_from(near).ok()
    };
    let edges: Vec<[DVec3; 2]> = triangles(plan, draw, places).filter_map(|(_, corners)| edge(corners)).collect();
    let middle = edges.as_flattened().iter().sum::<DVec3>() / (edges.len() as f64 * 2.0);
    built(edges.into_iter().map(|[from, to]| [from, to, middle]).collect())
}

/// Places of a mesh's corners, to be found again though they were rounded on the way.
struct Corners(BTreeSet<[i64; 3]>);

impl Corners {
    fn new(places: &[DVec3]) -> Corners {
        Corners(places.iter().map(|place| Corners::cell(*place)).collect())
    }

    /// A cell as large as places may be apart at its distance.
    fn cell(place: DVec3) -> [i64; 3] {
        // Steps that double with the distance, so that both of a pair take the same.
        let size = (place.length().max(f64::MIN_POSITIVE).log2().ceil()).exp2() * SAME_PLACE;
        (place / size).to_array().map(|value| value.round() as i64)
    }

    fn count(&self, places: &[DVec3]) -> usize {
        let is_near = |place: &&DVec3| {
            let [x, y, z] = Corners::cell(**place);
            let around = [-1, 0, 1];
            around
                .iter()
                .any(|dx| around.iter().any(|dy| around.iter().any(|dz| self.0.contains(&[x + dx, y + dy, z + dz]))))
        };
        places.iter().filter(is_near).count()
    }
}
