//! Which triangles of surfaces can show, and which of those a light can reach.
//!
//! A surface out of view is not drawn. Of a closed one that the near plane does not cut, triangles that
//! face away from the eye are hidden by others; and a triangle that faces away from a light gets nothing
//! from it, so the light pass needs only the rest.

use super::frame::{FrameBuilder, SurfacePiece};
use super::{outside, surfaces};
use crate::geometry::{Caster, ViewVolume};
use crate::plan::{Decision, DrawMesh, LeftOut, LightId};
use glam::{DVec3, DVec4};

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
            Some(ShownTriangles::Triangles(shows)) => {
                shown_pieces.extend(subset(frame, piece, |triangle| shows[triangle as usize]))
            }
            Some(ShownTriangles::Nothing) => (),
            _ => shown_pieces.push(piece),
        }
    }
    frame.pieces = shown_pieces;
}

#[derive(Clone)]
enum ShownTriangles {
    All,
    /// Whether each triangle of the mesh may show.
    Triangles(Vec<bool>),
    Nothing,
}

fn shown(frame: &mut FrameBuilder, view: &ViewVolume, index: usize) -> ShownTriangles {
    let (eye, sees_from) = (frame.eye(), frame.eye_position());
    let placed = &frame.placed[index];
    let (object, world) = (placed.object, &placed.world);
    let relative: Vec<DVec4> = outside::outline(world).iter().map(|point| (point - eye).extend(1.0)).collect();
    if frame.common.allows(Decision::Surfaces)
        && let Some(far) = view.outside(&relative)
    {
        let because = outside::beyond(far, outside::VIEW_PLANES[far.plane]);
        frame.leave_out(Decision::Surfaces, &object.name, format!("it lies {because}"));
        return ShownTriangles::Nothing;
    }
    if !frame.common.allows(Decision::HiddenTriangles) || !view.is_beyond_near(&relative) {
        return ShownTriangles::All;
    }
    let caster = Caster { mesh: &object.mesh, pose: &object.pose, world };
    if frame.job.cache.light_facing_suffices(caster, sees_from).is_err() {
        return ShownTriangles::All;
    }
    let faces_eye = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
        let (normal, to_eye): (DVec3, DVec3) = ((b - a).cross(c - a), sees_from.truncate() - a * sees_from.w);
        normal.dot(to_eye) > -EDGE_ON * normal.length() * to_eye.length()
    };
    // Along an edge with a triangle that faces the eye, rounding may let the other win: neighbours stay.
    let mut is_neighbour = vec![false; world.len()];
    let facing = object.mesh.triangles().iter().filter(|corners| faces_eye(corners));
    facing.flatten().for_each(|vertex| is_neighbour[*vertex as usize] = true);
    let touches = |corners: &[u32; 3]| corners.iter().any(|vertex| is_neighbour[*vertex as usize]);
    let shows: Vec<bool> = object.mesh.triangles().iter().map(touches).collect();
    let hidden = shows.iter().filter(|shows| !**shows).count();
    if hidden == 0 {
        return ShownTriangles::All;
    }
    let because = "the mesh is closed and wound outwards, the eye is outside it, and the near plane does not cut it";
    frame.plan.left_out.push(LeftOut::counted(Decision::HiddenTriangles, hidden as u64, &object.name, because));
    ShownTriangles::Triangles(shows)
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
