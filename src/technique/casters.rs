//! Which objects can darken anything.

use super::frame::{FrameBuilder, FrameObject};
use crate::geometry::{self, Caster};
use crate::numbers::counted;
use crate::plan::{Decision, LeftOut, LightId};
use glam::DVec3;
use rayon::prelude::*;

/// How many triangles one thread places, at least.
const SHARE: usize = 8 * 1024;

/// Which objects [`can_darken`] asks about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DarkenedObjects {
    /// Every receiver, the caster included.
    All,
    /// Every receiver except the caster.
    Others,
}

/// Returns whether the object `index` may cast a shadow of this light on any drawn receiver. It can't where all of them
/// lie on the light's side of each of its triangles, or in their planes.
pub fn can_darken(frame: &FrameBuilder, index: usize, light: LightId, what: DarkenedObjects) -> bool {
    let receivers = || {
        let receives = |(other, placed): &(usize, &FrameObject)| {
            let is_asked = what == DarkenedObjects::All || *other != index;
            is_asked && placed.object.receives && placed.surface.is_some()
        };
        let receiving = frame.placed.iter().enumerate().filter(receives);
        receiving.flat_map(|(_, placed)| placed.world.iter().copied())
    };
    let placed = &frame.placed[index];
    let triangles = placed.object.mesh.triangles();
    geometry::object_can_darken(&placed.world, triangles, frame.light_position(light), receivers)
}

/// Checks that the triangles of the object `index` that face a light cast the shadow of all of it alone, and returns the
/// record of that for the plan.
///
/// # Errors
/// The record of what speaks against it, or is not proven.
pub fn light_facing_suffices(frame: &mut FrameBuilder, light: LightId, index: usize) -> Result<LeftOut, LeftOut> {
    let (position, placed) = (frame.light_position(light), &frame.placed[index]);
    let object = placed.object;
    let caster = Caster { mesh: &object.mesh, pose: &object.pose, world: &placed.world };
    let name = light.name();
    match frame.job.cache.light_facing_suffices(caster, position) {
        Ok(()) => {
            let because = format!(
                "proven: the mesh is closed, consistently wound, nowhere inside out and does not meet itself, and \
                 {name} is outside it; the triangles that face the light cast the same shadow alone"
            );
            Ok(LeftOut::new(Decision::AwayTriangles, &object.name, because))
        }
        Err(doubt) => {
            let because = format!("not for {name}: {doubt}; so every triangle casts");
            Err(LeftOut::new(Decision::LightFacing, &object.name, because))
        }
    }
}

/// Returns, for each triangle of the object `index`, whether it need not cast though the mesh has holes: it faces away from
/// the light, and the mesh itself lies before it, with the plan's record of that. `None` where that is of none.
pub fn hidden_behind_no_hole(frame: &mut FrameBuilder, light: LightId, index: usize) -> Option<(Vec<bool>, LeftOut)> {
    let (position, placed) = (frame.light_position(light), &frame.placed[index]);
    let object = placed.object;
    let caster = Caster { mesh: &object.mesh, pose: &object.pose, world: &placed.world };
    let (hidden, holes) = frame.job.cache.hidden_behind_no_hole(caster, position)?;
    let count = hidden.iter().filter(|is_hidden| **is_hidden).count() as u64;
    let because = format!(
        "proven: with its {} closed the mesh bounds solids and {} is outside them, so that it reaches no triangle from \
         behind but through a hole",
        counted(holes as u64, "hole"),
        light.name(),
    );
    (count > 0).then(|| (hidden, LeftOut::behind_no_hole(count, &object.name, because)))
}

/// Returns why a caster needs no volume: nothing that receives lies behind it. `None` where something may; under
/// wrapped light also where the back of the caster itself may be lit, which otherwise is dark as it faces away.
pub fn darkens_nothing(frame: &FrameBuilder, index: usize, light: LightId) -> Option<LeftOut> {
    let is_asked = frame.common.allows(Decision::Caster) && !frame.plan.wraps_diffuse;
    if !is_asked || can_darken(frame, index, light, DarkenedObjects::All) {
        return None;
    }
    let because = format!("all that receives lies on the side of {}, or in its plane", light.name());
    Some(LeftOut::new(Decision::Caster, &frame.placed[index].object.name, because))
}

/// Adds the corners of all triangles of the object `index` in world space, in the mesh's order.
pub fn add_world_triangles(frame: &FrameBuilder, index: usize, all: &mut Vec<[DVec3; 3]>) {
    let placed = &frame.placed[index];
    let triangles = placed.object.mesh.triangles().par_iter().with_min_len(SHARE);
    all.par_extend(triangles.map(|corners| corners.map(|v| placed.world[v as usize])));
}
