//! Shadow volumes, taken from the draws of a plan.

use super::{PlacedObject, ShadowVolume, VolumePart};
use crate::plan::{Draw, DrawMesh, DrawPart, FramePlan, MeshId, Pass, ViewId};
use crate::recorded::{self, PassSpace};
use crate::scene::Scene;
use glam::{DVec3, DVec4};
use std::collections::{BTreeMap, BTreeSet};

/// The view of the camera.
const CAMERA: ViewId = ViewId(0);

/// Returns the volumes that passes of the camera's view draw, one for each light and caster, sorted by light, then
/// caster. A part that is drawn twice is there once; draws without a known caster, or of a second mesh for the same
/// light and caster, are left out.
pub fn of_plan(plan: &FramePlan, objects: &[PlacedObject]) -> Vec<ShadowVolume> {
    let index: BTreeMap<&str, usize> = objects.iter().enumerate().map(|(i, object)| (&*object.name, i)).collect();
    let mut found: BTreeMap<(usize, usize), (MeshId, ShadowVolume)> = BTreeMap::new();
    let mut seen = BTreeSet::new();
    for pass in plan.passes.iter().filter(|pass| pass.view == CAMERA) {
        for (light, draw) in draws_of_volumes(pass) {
            let caster = draw.caster.as_deref().and_then(|name| index.get(name).copied());
            let (Some(caster), Some(mesh)) = (caster, plan.meshes.get(draw.mesh.0)) else { continue };
            // Two passes draw the same part.
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

/// Returns the volumes that another program's frame draws, one for each draw whose pass has a light, in the view space
/// of its assumed eye. Equal volumes are there once; triangles with a corner that is not finite are left out.
pub fn recorded(plan: &FramePlan, scene: &Scene) -> Vec<ShadowVolume> {
    let mut found = Vec::new();
    for (pass, draw, caster) in recorded::casters(plan, scene) {
        let (Some(light), Some(mesh)) = (pass.light, plan.meshes.get(draw.mesh.0)) else { continue };
        let places = PassSpace::new(plan, pass).places(plan, draw);
        let is_place = |corner: &u32| places.get(*corner as usize).is_some_and(Option::is_some);
        let triangles = corners(draw, mesh).filter(|corners| corners.iter().all(is_place)).collect();
        let volume = ShadowVolume {
            light: light.0,
            caster,
            vertices: places.iter().map(|place| place.unwrap_or_default()).collect(),
            parts: vec![VolumePart { part: draw.part, triangles }],
        };
        // Two passes draw the same volume.
        if !found.contains(&volume) {
            found.push(volume);
        }
    }
    found
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
    let triangles = corners(draw, mesh);
    let Some(extruded) = &mesh.extruded else { return add_part(volume, draw.part, triangles) };
    // The positions that its vertex shader computed.
    let vertices = mesh.vertices.data();
    let of = |triangle: &[u32; 3]| match extruded.carried(*triangle) {
        // All points at infinity of a directional light's volume are one point.
        _ if has_equal_corners(vertices, *triangle) => None,
        [true, true, true] if draw.part == DrawPart::Caps => Some(DrawPart::DarkCap),
        [false, false, false] if draw.part == DrawPart::Caps => Some(DrawPart::LightCap),
        // Its triangles face the same way: it has no area.
        [true, true, true] | [false, false, false] => None,
        _ => Some(draw.part),
    };
    let triangles: Vec<_> = triangles.filter_map(|triangle| Some((of(&triangle)?, triangle))).collect();
    for part in [DrawPart::Side, DrawPart::LightCap, DrawPart::DarkCap] {
        let mut of_part = triangles.iter().filter(|(of, _)| *of == part).map(|(_, triangle)| *triangle).peekable();
        if of_part.peek().is_some() {
            add_part(volume, part, of_part);
        }
    }
}

fn has_equal_corners(vertices: &[[f32; 4]], triangle: [u32; 3]) -> bool {
    let [a, b, c] = triangle.map(|corner| vertices.get(corner as usize));
    a == b || b == c || c == a
}

fn add_part(volume: &mut ShadowVolume, part: DrawPart, triangles: impl Iterator<Item = [u32; 3]>) {
    match volume.parts.iter_mut().find(|one| one.part == part) {
        Some(one) => one.triangles.extend(triangles),
        None => volume.parts.push(VolumePart { part, triangles: triangles.collect() }),
    }
}

/// Returns the triangles of a draw as vertex indices (its base vertex added), counter-clockwise seen from outside:
/// flipped where the draw faces inwards. Empty where the mesh lacks a part of its range.
fn corners(draw: &Draw, mesh: &DrawMesh) -> impl Iterator<Item = [u32; 3]> {
    let range = draw.triangles.start as usize..draw.triangles.end as usize;
    let triangles = mesh.indices.data().as_chunks::<3>().0.get(range).unwrap_or_default();
    triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(|corner| corner + draw.base_vertex);
        if draw.faces_inwards { [a, c, b] } else { [a, b, c] }
    })
}
