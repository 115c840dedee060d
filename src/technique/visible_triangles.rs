//! Which triangles of surfaces can show, and which of those a light can reach.
//!
//! A surface out of view is not drawn. Of a closed one that the near plane does not cut, triangles that
//! face away from the eye are hidden by others, as they are of one with holes but behind a hole; and a triangle that faces away from a light gets nothing
//! from it, so the light pass needs only the rest.

use super::frame::{FrameBuilder, SurfacePiece};
use super::{outside, surfaces};
use crate::geometry::{Caster, GeometryCache, ShownTriangles, ViewVolume};
use crate::numbers;
use crate::plan::{Decision, DrawMesh, LeftOut, LightId};
use glam::{DVec3, DVec4};
use std::sync::Arc;

/// A triangle that turns away from the eye by less than this (sine of the angle) may still be rasterised as facing it.
const EDGE_ON: f64 = 1e-4;

/// Replaces the frame's surface pieces by those with only the triangles that may show: not out of view, and not on the
/// far side of a closed mesh. Pieces without any are dropped.
pub fn leave_out_hidden(frame: &mut FrameBuilder) {
    let view = frame.view_volume();
    let mut shown_pieces = Vec::new();
    let mut reduced = vec![None; frame.placed.len()];
    for piece in std::mem::take(&mut frame.pieces) {
        let index = piece.object;
        if reduced[index].is_none() {
            reduced[index] = Some(shown(frame, &view, index));
        }
        match &reduced[index] {
            Some(InView::Triangles(shown)) => {
                shown_pieces.extend(subset(frame, piece, |triangle| shown.shows[triangle as usize]))
            }
            Some(InView::Nothing) => (),
            _ => shown_pieces.push(piece),
        }
    }
    frame.pieces = shown_pieces;
}

/// What may show of an object.
#[derive(Clone)]
enum InView {
    All,
    Triangles(Arc<ShownTriangles>),
    Nothing,
}

fn shown(frame: &mut FrameBuilder, view: &ViewVolume, index: usize) -> InView {
    let (eye, sees_from) = (frame.eye(), frame.eye_position());
    let placed = &frame.placed[index];
    let (object, world) = (placed.object, &placed.world);
    let relative: Vec<DVec4> = outside::outline(world).iter().map(|point| (point - eye).extend(1.0)).collect();
    if frame.common.allows(Decision::Surfaces)
        && let Some(far) = view.outside(&relative)
    {
        let because = outside::beyond(far, outside::VIEW_PLANES[far.plane]);
        frame.leave_out(Decision::Surfaces, &object.name, format!("it lies {because}"));
        return InView::Nothing;
    }
    if !frame.common.allows(Decision::HiddenTriangles) || !view.is_beyond_near(&relative) {
        return InView::All;
    }
    let caster = Caster { mesh: &object.mesh, pose: &object.pose, world };
    let find_out = |cache: &mut GeometryCache| shown_from(cache, caster, sees_from);
    let Some(shown) = frame.job.cache.shown(caster, sees_from, find_out).filter(|shown| shown.hidden > 0) else {
        return InView::All;
    };
    let because = match shown.holes {
        0 => "the mesh is closed and wound outwards, the eye is outside it, and the near plane does not cut it"
            .to_owned(),
        holes => format!(
            "with its {} closed the mesh is wound outwards and the eye is outside it, none of them lies before these, and \
             the near plane does not cut it",
            numbers::counted(holes as u64, "hole")
        ),
    };
    frame.plan.left_out.push(LeftOut::counted(Decision::HiddenTriangles, shown.hidden, &object.name, because));
    InView::Triangles(shown)
}

/// Returns which triangles of a mesh may show from a homogeneous place: those that face it, with their neighbours, and
/// those behind a hole. `None` for a mesh that is not proven to bound solids, its holes closed, that the place is outside
/// of.
fn shown_from(cache: &mut GeometryCache, caster: Caster, from: DVec4) -> Option<ShownTriangles> {
    let (mesh, world) = (caster.mesh, caster.world);
    let is_closed = cache.light_facing_suffices(caster, from).is_ok();
    let behind_no_hole = if is_closed { None } else { Some(cache.hidden_behind_no_hole(caster, from)?) };
    let faces = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
        let (normal, way): (DVec3, DVec3) = ((b - a).cross(c - a), from.truncate() - a * from.w);
        normal.dot(way) > -EDGE_ON * normal.length() * way.length()
    };
    // Along an edge with a triangle that faces the eye, rounding may let the other win: neighbours stay.
    let mut is_neighbour = vec![false; world.len()];
    let facing = mesh.triangles().iter().filter(|corners| faces(corners));
    facing.flatten().for_each(|vertex| is_neighbour[*vertex as usize] = true);
    let touches = |corners: &[u32; 3]| corners.iter().any(|vertex| is_neighbour[*vertex as usize]);
    let is_behind_a_hole =
        |triangle: usize| behind_no_hole.as_ref().is_some_and(|(is_behind_none, _)| !is_behind_none[triangle]);
    let may_show = |(triangle, corners): (usize, &[u32; 3])| touches(corners) || is_behind_a_hole(triangle);
    let shows: Vec<bool> = mesh.triangles().iter().enumerate().map(may_show).collect();
    let hidden = shows.iter().filter(|shows| !**shows).count() as u64;
    Some(ShownTriangles { shows, hidden, holes: behind_no_hole.map_or(0, |(_, holes)| holes) })
}

/// Returns the piece with only the triangles for which `shows` returns true, as a new mesh in the plan; the piece
/// itself where all do, `None` where none does.
fn subset(frame: &mut FrameBuilder, piece: SurfacePiece, shows: impl Fn(u32) -> bool) -> Option<SurfacePiece> {
    let triangles: Vec<u32> = piece.triangles.clone().filter(|triangle| shows(*triangle)).collect();
    if triangles.len() == piece.triangles.len() {
        return Some(piece);
    }
    if triangles.is_empty() {
        return None;
    }
    let mesh: DrawMesh = surfaces::subset(&frame.plan.meshes[piece.mesh.0], &piece.name, &triangles);
    let mesh = frame.add_mesh(mesh);
    Some(SurfacePiece { mesh, triangles: 0..triangles.len() as u32, ..piece })
}

/// Returns the pieces without the triangles that a light adds nothing to, as they face away from it or lie beyond its
/// range. Returns all pieces where diffuse light is wrapped or surfaces coincide.
pub fn lit_by(frame: &mut FrameBuilder, light: LightId) -> Vec<SurfacePiece> {
    let pieces = frame.pieces.clone();
    if !frame.common.allows(Decision::UnlitTriangles) || frame.plan.wraps_diffuse || frame.surfaces_coincide() {
        return pieces;
    }
    let total = |pieces: &[SurfacePiece]| pieces.iter().map(|piece| piece.triangles.len() as u64).sum::<u64>();
    let all = total(&pieces);
    let mut lit = Vec::new();
    for piece in pieces {
        if frame.beyond_range(light, piece.object).is_some() {
            continue;
        }
        let surface = frame.plan.meshes[piece.mesh.0].surface.as_ref();
        let Some(sides) = surface.map(|surface| surface.sides.clone()) else { continue };
        let faces_light = |triangle: u32| sides.data()[triangle as usize] & (1 << light.0) == 0;
        lit.extend(subset(frame, piece, faces_light));
    }
    let unlit = all - total(&lit);
    if unlit > 0 {
        let has_range = frame.job.scene.lights[light.0].range.is_some();
        frame.plan.left_out.push(LeftOut::unlit(unlit, light, has_range));
    }
    lit
}
