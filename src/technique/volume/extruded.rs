//! A caster's volume that a vertex shader carries away from the light (Brennan 2002).
//!
//! Its mesh contains what any light could need, and stays as it is while the light moves: every triangle, and at every
//! edge a quad that is empty until the triangles beside it face different ways. A mesh that is proven closed is drawn
//! as it is: triangles that face the light are its light cap, and the others, carried away, its dark cap. Of anything
//! else each triangle is a prism of its own.
//!
//! Facing is decided in single precision: where the light grazes a triangle, the decision may be wrong. Its volume is
//! closed all the same, and the error is that of an edge beside its place. Sides that graze their surface are no range
//! of their own here, so nothing separates their depths from it.

use super::counting::CountedPart;
use super::drawn::{CasterVolume, CastingTriangles, VolumeMesh};
use crate::geometry::{Caster, Casters, Extruded, ExtrudedForm, ExtrudedVolume, Extruder, Extrusion};
use crate::plan::{Decision, DrawMesh, DrawPart, LeftOut, LightId};
use crate::scene::Scene;
use crate::technique::frame::FrameBuilder;
use crate::technique::settings::VolumeSettings;

/// Returns whether the settings ask for volumes that a vertex shader extrudes and it can: not infinite ones under
/// parallel view rays.
pub fn can_serve(options: &VolumeSettings, scene: &Scene) -> bool {
    let ends_in_a_point = scene.camera.is_parallel() && options.extrusion == Extrusion::Infinite;
    options.by_vertex_shader && !ends_in_a_point
}

/// Returns whether a vertex shader extrudes the volumes of a light, and the plan's record where the settings ask for
/// that but it can't; `None` where they don't ask, or it can.
pub fn serves(frame: &FrameBuilder, light: LightId, options: &VolumeSettings) -> (bool, Option<LeftOut>) {
    let can = can_serve(options, frame.job.scene);
    let because = "lines of sight are parallel and all end in one point at infinity: what is to be counted there, \
                   and that no side is seen edge-on, is found on the CPU";
    let cannot = options.by_vertex_shader && !can;
    (can, cannot.then(|| LeftOut::new(Decision::VertexExtrusion, light.name(), because)))
}

/// Makes the volume of a caster that the vertex shader extrudes away from the light. Either cap that is needed brings
/// both, and no number is added to the start of the count.
pub fn make(frame: &mut FrameBuilder, of: &CasterVolume) -> VolumeMesh {
    let CasterVolume { light, index, casters, form, .. } = *of;
    let (position, eye) = (frame.light_position(light), frame.eye());
    let placed = &frame.placed[index];
    let caster = Caster { mesh: &placed.object.mesh, pose: &placed.object.pose, world: &placed.world };
    let cache = &mut *frame.job.cache;
    let connectivity = cache.connectivity(caster.mesh);
    let is_closed = connectivity.is_closed() && connectivity.is_oriented() && casters == Casters::LightFacing;
    let of = if is_closed { ExtrudedForm::Closed } else { ExtrudedForm::Prisms(casters) };
    let ExtrudedVolume { corners, indices, sides, caps, flipped_caps } = cache.extruded(caster, eye, of);
    let carry = Extruder::new(&placed.world, position, form.extrusion).carry_from(eye);
    let name = format!("volume of {}", placed.object.name);
    let mut needed = vec![CountedPart::new(DrawPart::Side, false, &sides)];
    if form.light_cap || form.dark_cap {
        let runs = [(false, &caps), (true, &flipped_caps)];
        needed.extend(runs.map(|(flipped, triangles)| CountedPart::new(DrawPart::Caps, flipped, triangles)));
    }
    VolumeMesh {
        mesh: DrawMesh::of_extruded(name, Extruded { corners, carry }, indices),
        casting: CastingTriangles::Picked(casters),
        needed,
        begins_with: 0,
        left_out: Vec::new(),
    }
}
