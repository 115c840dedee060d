//! The surfaces of a frame as objects in the eye's space.

use super::corners::KnownCorners;
use super::space::{PassSpace, triangles};
use crate::plan::{ColorWrite, Draw, DrawPart, FramePlan, Pass};
use crate::scene::{Camera, Material, Mesh, MeshBuilder, Object, Scene, SceneBuilder};
use glam::{DVec3, DVec4};
use std::sync::Arc;
use wgpu_types::CompareFunction;

/// Returns the surfaces that a frame draws, each once, in the eye's space and named by their draws. All cast.
pub(super) fn objects(plan: &FramePlan) -> Vec<Object> {
    let mut objects: Vec<Object> = Vec::new();
    let area = |pass: &Pass| pass.viewport(plan.size).area;
    // What is drawn into another part of the picture than the volumes is seen by another eye, as a model in a game's status bar.
    let counted = draws(plan, |draw| draw.part.is_of_volume()).first().map(|(pass, _)| area(pass));
    let mut surfaces = draws(plan, is_surface);
    surfaces.retain(|(pass, _)| counted.is_none_or(|counted| counted == area(pass)));
    for (pass, draw) in surfaces {
        let places = PassSpace::new(plan, pass).places(plan, draw);
        let mesh = mesh(plan, draw, &places, |corners| corners.iter().all(|corner| corner.w == 1.0));
        // A surface that is drawn again, for light or ambient, is one object.
        let is_known = |mesh: &Mesh| objects.iter().any(|one| one.mesh.content_hash() == mesh.content_hash());
        let Some(mesh) = mesh.filter(|mesh| !is_known(mesh)) else { continue };
        objects.push(Object::new(draw.name.clone(), Arc::new(mesh), Material::default()));
    }
    objects
}

/// Returns the corners of the surfaces that a frame draws.
pub(super) fn surface_corners(plan: &FramePlan) -> KnownCorners {
    corners_of(&objects(plan))
}

pub(super) fn corners_of(objects: &[Object]) -> KnownCorners {
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

/// Returns the draws in passes of the picture for which `is_meant` is true, with their passes, in the frame's order.
pub(super) fn draws(plan: &FramePlan, is_meant: impl Fn(&Draw) -> bool) -> Vec<(&Pass, &Draw)> {
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

/// Builds a mesh of triangles; `None` where there is none.
pub(super) fn built(triangles: Vec<[DVec3; 3]>) -> Option<Mesh> {
    let indices = (0..triangles.len() as u32).map(|index| [index * 3, index * 3 + 1, index * 3 + 2]);
    let builder = MeshBuilder {
        positions: triangles.as_flattened().to_vec(),
        triangles: indices.collect(),
        ..MeshBuilder::default()
    };
    builder.build().ok().filter(|mesh| !mesh.triangles().is_empty())
}
