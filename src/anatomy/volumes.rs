//! Shadow volumes out of a plan.

use super::{PlacedObject, ShadowVolume, VolumePart};
use crate::plan::{Draw, DrawMesh, FramePlan, MeshId, Pass, ViewId};
use glam::{DVec3, DVec4};
use std::collections::{BTreeMap, BTreeSet};

/// The camera's view.
const CAMERA: ViewId = ViewId(0);

/// All volumes that the camera's passes draw, in the order of lights and casters.
pub fn of_plan(plan: &FramePlan, objects: &[PlacedObject]) -> Vec<ShadowVolume> {
    let index: BTreeMap<&str, usize> = objects.iter().enumerate().map(|(i, object)| (&*object.name, i)).collect();
    let mut found: BTreeMap<(usize, usize), (MeshId, ShadowVolume)> = BTreeMap::new();
    let mut seen = BTreeSet::new();
    for pass in plan.passes.iter().filter(|pass| pass.view == CAMERA) {
        for (light, draw) in draws_of_volumes(pass) {
            let caster = draw.caster.as_deref().and_then(|name| index.get(name).copied());
            let (Some(caster), Some(mesh)) = (caster, plan.meshes.get(draw.mesh.0)) else { continue };
            // Two passes draw one part twice.
            if !seen.insert((light, draw.mesh, draw.triangles.start, draw.triangles.end, draw.base_vertex)) {
                continue;
            }
            let origin = plan.views[pass.view.0].origin;
            let new = || (draw.mesh, ShadowVolume { light, caster, vertices: world(mesh, origin), parts: Vec::new() });
            let (of, volume) = found.entry((light, caster)).or_insert_with(new);
            if *of == draw.mesh {
                add(volume, draw, mesh);
            }
        }
    }
    found.into_values().map(|(_, volume)| volume).collect()
}

fn draws_of_volumes(pass: &Pass) -> impl Iterator<Item = (usize, &Draw)> {
    let is_of_volume = |draw: &&Draw| draw.part.is_of_volume();
    let light = pass.light.map(|light| light.0);
    pass.draws.iter().filter(is_of_volume).filter_map(move |draw| Some((light?, draw)))
}

fn world(mesh: &DrawMesh, origin: DVec3) -> Vec<DVec4> {
    let place = |vertex: &[f32; 4]| {
        let relative = DVec4::from_array(vertex.map(f64::from));
        relative + (origin * relative.w).extend(0.0)
    };
    mesh.vertices.data().iter().map(place).collect()
}

fn add(volume: &mut ShadowVolume, draw: &Draw, mesh: &DrawMesh) {
    let indices = &mesh.indices.data()[draw.triangles.start as usize * 3..draw.triangles.end as usize * 3];
    let triangles = indices.chunks_exact(3).map(|corners| {
        let [a, b, c] = [0, 1, 2].map(|corner| corners[corner] + draw.base_vertex);
        if draw.faces_inwards { [a, c, b] } else { [a, b, c] }
    });
    match volume.parts.iter_mut().find(|part| part.part == draw.part) {
        Some(part) => part.triangles.extend(triangles),
        None => volume.parts.push(VolumePart { part: draw.part, triangles: triangles.collect() }),
    }
}
