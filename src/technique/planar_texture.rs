//! Receiver textures: each flat receiver gets a picture of the light that arrives on it.
//!
//! The frustum from the light to a receiver is mapped to a box whose x and y are the receiver's own (Heckbert and Herf
//! 1997), so drawing the casters through it leaves their shadow in the receiver's texture; what is beyond the light or
//! behind the receiver is clipped. The light pass reads the texture. Ambient light has a pass of its own. Surfaces that
//! are not flat get no shadow, and edges are as coarse as the texture.

use super::PlanError;
use super::description::{ComparisonRole, TechniqueDescription};
use super::frame::{FrameBuilder, PlanRequest, StencilUse, SurfacePiece};
use super::lesson::{Lesson, cited};
use super::receivers::{self, FlatReceiver, MOST_TEXTURES};
use super::settings::TextureSettings;
use super::silhouettes::{self, LayerPass};
use super::surfaces;
use crate::geometry::ReceiverParallelogram;
use crate::math::Plane;
use crate::plan::{DecidedBy, Decision, FramePlan, LeftOut, LightId, Visibility};
use glam::{DMat4, DVec4};
use std::collections::HashSet;

/// Describes `planar-texture` for commands, tables and the inspector.
pub(super) const DESCRIPTION: TechniqueDescription = TechniqueDescription {
    summary: "Draws the casters into textures of the largest flat receivers, through the box that the light's pyramid becomes.",
    lesson: Lesson {
        text: "Each of the 64 largest flat receivers has a texture of the light that arrives on it: the pyramid from the light \
             to the receiver becomes a box, and the casters are drawn through it. Translucent casters tint what they let \
             through. Edges are as coarse as the texture, and surfaces that are not flat get no shadow.",
        formula: "what is at L + q(c + u a + v b - L), with the light L and the receiver's corner c and sides a and b, \
             falls on the texture at (u, v), whatever q",
        sources: &[cited::HECKBERT_HERF],
    },
    plan,
    // Sizes of textures.
    report_rows: &[
        &[("size", "64")],
        &[("size", "256")],
        &[("size", "256"), ("redraw", "changed")],
        &[("size", "1024")],
    ],
    standing: ComparisonRole::Rival {
        place: 6,
        right_because: "all that is darkened is flat, and no edge of a shadow is blurred by texels",
        texels: Some((0.005, "a receiver of several metres has 256 texels a side: each is larger than a pixel")),
    },
};

/// Plans a frame in which each flat receiver has a texture of the light that arrives on it; surfaces that are not flat,
/// or not among the largest receivers, are lit without shadows.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let mut frame = FrameBuilder::new(job, StencilUse::ToLightOnce)?;
    let mut receivers = receivers::all(&mut frame);
    let left = receivers.split_off(receivers.len().min(MOST_TEXTURES));
    let because = "the 64 largest are kept: every one costs a texture, and a draw for each caster";
    receivers::leave_out(&mut frame, &left, "the frame", because);
    frame.pieces = split_at(&mut frame, &receivers);
    for light in frame.light_ids() {
        add_textures(&mut frame, &receivers, light);
    }
    frame.ambient_pass();
    for light in frame.light_ids() {
        let (how, purpose) = match frame.plan.lights[light.0].map {
            Some(_) => (
                Visibility::ReceiverTexture,
                "Adds the light as far as the receiver's texture lets it through. Surfaces that are not flat have none, \
                 and are lit as if nothing stood between.",
            ),
            None => {
                (Visibility::Everywhere, "Adds the light everywhere: no flat receiver has a shadow of it that shows.")
            }
        };
        frame.mask_and_light_passes(light, how, purpose);
    }
    Ok(frame.finish())
}

/// Takes the frame's pieces and returns them split, each receiver as a piece with a mesh and the layer of its own, so
/// that it reads its own texture. Triangles of no receiver stay together, without a layer.
fn split_at(frame: &mut FrameBuilder, receivers: &[FlatReceiver]) -> Vec<SurfacePiece> {
    let mut split = Vec::new();
    for piece in std::mem::take(&mut frame.pieces) {
        let count = frame.placed[piece.object].object.mesh.triangles().len();
        let mut layer_of = vec![None; count];
        for (layer, receiver) in receivers.iter().enumerate().filter(|(_, receiver)| receiver.object == piece.object) {
            receiver.receiver.triangles.iter().for_each(|triangle| layer_of[*triangle as usize] = Some(layer as u32));
        }
        let mut layers: Vec<Option<u32>> = piece.triangles.clone().map(|t| layer_of[t as usize]).collect();
        layers.sort_unstable();
        layers.dedup();
        for layer in layers {
            let own: Vec<u32> = piece.triangles.clone().filter(|t| layer_of[*t as usize] == layer).collect();
            let name = layer.map_or_else(|| piece.name.clone(), |layer| receivers[layer as usize].name.clone());
            let mesh = surfaces::subset(&frame.plan.meshes[piece.mesh.0], &name, &own);
            let mesh = frame.add_mesh(mesh);
            split.push(SurfacePiece { name, mesh, triangles: 0..own.len() as u32, layer, ..piece.clone() });
        }
    }
    split
}

fn add_textures(frame: &mut FrameBuilder, receivers: &[FlatReceiver], light: LightId) {
    let light_position = frame.light_position(light);
    let shapes: Vec<Option<DMat4>> =
        receivers.iter().map(|receiver| clip_from_world(frame, receiver, light_position)).collect();
    let mut passes = Vec::new();
    for (layer, (receiver, shape)) in receivers.iter().zip(&shapes).enumerate() {
        if shape.is_none() {
            let because = "the light lies in its plane";
            frame.plan.left_out.push(LeftOut::named(Decision::Texture, &receiver.name, light.name(), because));
            continue;
        }
        if !receiver.shows_lit_side(frame, light) {
            let because = "light and eye are on different sides of it, so shading alone darkens it";
            frame.plan.left_out.push(LeftOut::named(Decision::Texture, &receiver.name, light.name(), because));
            continue;
        }
        let towards_light = receiver.receiver.plane;
        let towards_light =
            if towards_light.at(light_position) < 0.0 { towards_light.flipped() } else { towards_light };
        let mut draws = Vec::new();
        for caster in 0..frame.placed.len() {
            let triangles = caster_triangles(frame, receiver, towards_light, caster);
            draws.extend(silhouettes::draws(frame, caster, &triangles));
        }
        if draws.is_empty() {
            let because = "no caster is between it and the light";
            frame.plan.left_out.push(LeftOut::named(Decision::Texture, &receiver.name, light.name(), because));
            continue;
        }
        passes.push(LayerPass { layer, name: format!("texture of {}", receiver.name), draws });
    }
    if passes.is_empty() {
        frame.leave_out(Decision::Textures, light.name(), "no flat receiver has a shadow that shows");
        return;
    }
    let purpose = "Draws the casters between this receiver and the light through the box that the light's pyramid \
                   over the receiver becomes: their picture is the shadow on it.";
    let settings = TextureSettings::of_receivers(frame.job.choice.settings());
    let shapes = shapes.into_iter().map(|shape| shape.unwrap_or(DMat4::IDENTITY)).collect();
    let names = receivers.iter().map(|receiver| receiver.name.clone()).collect();
    silhouettes::add_map(frame, light, &settings, names, shapes, passes, purpose);
    frame.plan.lights[light.0].decided_by = DecidedBy::ReceiverTextures;
}

fn clip_from_world(frame: &FrameBuilder, receiver: &FlatReceiver, light: DVec4) -> Option<DMat4> {
    let placed = &frame.placed[receiver.object];
    ReceiverParallelogram::around(&receiver.receiver, &placed.world, placed.object.mesh.triangles())
        .clip_from_world(light)
}

/// Returns the indices of a caster's triangles that are drawn into a receiver's texture: those with a corner above the
/// receiver's plane on the light's side. Corners of the receiver itself count as on the plane. Empty where the object
/// does not cast.
fn caster_triangles(frame: &FrameBuilder, receiver: &FlatReceiver, towards_light: Plane, caster: usize) -> Vec<u32> {
    let placed = &frame.placed[caster];
    let triangles = placed.object.mesh.triangles();
    let own = if caster == receiver.object { &receiver.receiver.triangles[..] } else { &[] };
    let on_plane: HashSet<u32> = own.iter().flat_map(|triangle| triangles[*triangle as usize]).collect();
    let is_above =
        |vertex: &u32| !on_plane.contains(vertex) && towards_light.height(placed.world[*vertex as usize]) > 0.0;
    if !placed.object.casts {
        return Vec::new();
    }
    let above: Vec<bool> = (0..placed.world.len() as u32).map(|vertex| is_above(&vertex)).collect();
    let reaches_above = |triangle: &u32| triangles[*triangle as usize].iter().any(|vertex| above[*vertex as usize]);
    (0..triangles.len() as u32).filter(reaches_above).collect()
}
