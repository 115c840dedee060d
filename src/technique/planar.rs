//! Planar shadows: casters flattened onto flat receivers.
//!
//! A pass marks each receiver's visible pixels with an even number of its own in the stencil; the
//! next draws the casters, flattened onto the receiver's plane: where the stencil has the
//! receiver's mark it goes up by one, so an odd number means shadow and no pixel can be darkened
//! twice. The light pass then skips odd pixels. Surfaces that are not flat get no shadow.
//!
//! With the stencil off, or with shadows blended twice, the older way is shown: the scene is lit
//! first, and the flattened casters darken it.

use super::PlanError;
use super::description::{ComparisonRole, TechniqueDescription};
use super::frame::{FrameBuilder, PlanRequest, StencilUse, SurfaceDrawing};
use super::lesson::{Lesson, cited};
use super::receivers::{self, FlatReceiver};
use super::settings::{PlanarSettings, ReceiverChoice, ShadowBlend};
use super::{casters, visible_triangles};
use crate::geometry::planar::{FlattenClip, FlattenedCaster, Flattener};
use crate::geometry::{Casters, facing, relative};
use crate::math::Sign;
use crate::plan::{
    Blob, ColorWrite, DecidedBy, Decision, Draw, DrawConstants, DrawMesh, DrawPart, FramePlan, LeftOut, LightId,
    Program, RasterState, StencilFace,
};
use crate::scene::{Scene, suggestion};
use std::sync::Arc;
use wgpu_types::{CompareFunction, StencilOperation};

/// Describes `planar` for commands, tables and the inspector.
pub(super) const DESCRIPTION: TechniqueDescription = TechniqueDescription {
    summary: "Casters are flattened onto the flat receivers that show most, and the stencil keeps their shadows on them.",
    lesson: Lesson {
        text: "Flat pieces of surfaces are receivers, those that cover a two-hundredth of the picture or more (`receivers` \
             chooses); other surfaces get no shadow. A pass marks \
             the pixels of a receiver in the stencil, the next draws the casters, flattened by the light onto its \
             plane, and raises marked pixels by one: odd means shadow, and no pixel is darkened twice. Each receiver \
             costs a draw for every caster: for one floor, as in scene `rings`, nothing is cheaper, for every facet of a curved \
             mesh nothing is dearer. In `tiger-cage`, where walls, floors and beds receive, it costs twice as much as z-pass, \
             which is wrong there as the eye stands in shadow, and more than z-fail, which is right; what it leaves out is \
             named with the reason in `plan.txt`, by `diagnose` (`receiver-left-out`) and in the window.",
        formula: "flattened point = (P.L) V - (P.V) L, for the receiver's plane P, the light L and the caster's point \
             V; light is added where the stencil is even",
        sources: &[cited::BLINN, cited::KILGARD],
    },
    plan,
    // The defaults, every facet a receiver, and shadows that z-fight with their plane.
    report_rows: &[&[], &[("receivers", "all")], &[("z-fighting", "none")]],
    standing: ComparisonRole::Rival {
        place: 5,
        right_because: "all that is darkened is flat, and casters are clipped to what lies between",
        texels: None,
    },
};

/// A flat receiver on which shadows show, with the stencil value that marks its pixels.
struct MarkedReceiver {
    receiver: FlatReceiver,
    mark: u8,
}

/// Plans a frame with planar shadows: casters flattened onto the planes of flat receivers. Receivers that are not flat
/// get no shadow.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let options = PlanarSettings::read(job.choice.settings());
    let stencil = if options.marks { StencilUse::Always } else { StencilUse::ToLightOnce };
    let mut frame = FrameBuilder::new(job, stencil)?;
    visible_triangles::leave_out_hidden(&mut frame);
    frame.ambient_pass();
    let choice = ReceiverChoice::read(frame.job.choice.settings());
    check_names(&choice, frame.job.scene)?;
    let receivers = receivers::all(&mut frame);
    for light in frame.light_ids() {
        frame.plan.lights[light.0].decided_by = DecidedBy::Flattened;
        frame.lit = Some(visible_triangles::lit_by(&mut frame, light));
        let marked = shown_receivers(&mut frame, &receivers, light, options, &choice);
        if options.counts() {
            counted_shadows(&mut frame, &marked, light, options);
        } else {
            blended_shadows(&mut frame, &marked, light, options);
        }
    }
    Ok(frame.finish())
}

/// Refuses names of objects that a scene does not have.
fn check_names(choice: &ReceiverChoice, scene: &Scene) -> Result<(), PlanError> {
    let ReceiverChoice::Named(names) = choice else { return Ok(()) };
    let known: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    match names.iter().find(|name| !known.contains(&name.as_str())) {
        Some(name) => Err(PlanError::Unusable {
            problem: format!("receivers = named:{name} names no object of the scene: {}", suggestion(name, &known)),
        }),
        None => Ok(()),
    }
}

/// Returns the raster state of flattened casters, before a stencil test is added.
fn raster_of(options: &PlanarSettings, color: ColorWrite) -> RasterState {
    let PlanarSettings { depth_compare, depth_bias, .. } = *options;
    RasterState { depth_compare, depth_bias, depth_write: false, color, ..RasterState::surface() }
}

/// Adds the passes that mark receivers with even stencil values, raise those in shadow by 1, and add mask and light
/// where the stencil is even: no pixel is darkened twice.
fn counted_shadows(frame: &mut FrameBuilder, marked: &[MarkedReceiver], light: LightId, options: PlanarSettings) {
    mark_pass(frame, marked, light);
    let purpose = "Draws every caster, flattened onto each receiver's plane. Where the stencil still has the \
                   receiver's mark it goes up by one: overlapping triangles can't darken a pixel twice.";
    let once = StencilFace {
        compare: CompareFunction::Equal,
        pass_op: StencilOperation::IncrementClamp,
        ..StencilFace::IGNORE
    };
    let raster = |mark| raster_of(&options, ColorWrite::None).with_stencil(once, mark);
    let draws = shadow_draws(frame, marked, light, options, &|mark| (Program::Position, raster(mark)));
    if !draws.is_empty() {
        frame.stencil_pass(light, "shadows", purpose, draws);
    }
    let odd = SurfaceDrawing::shadow().where_stencil(1, 1);
    frame.mask_pass(light, &[SurfaceDrawing::lit(), odd]);
    let purpose = "Adds the light where the stencil is even: odd numbers are shadows. It makes lit numbers odd, so \
                   that no pixel is lit twice.";
    frame.light_pass(light, purpose, &SurfaceDrawing::light_once_where_zero(1));
}

/// Adds the passes that light everything and then multiply shadows over it, once for each triangle, so that overlaps
/// darken twice; limited to each receiver's marked pixels where `options.marks` is set. Adds the mask too.
fn blended_shadows(frame: &mut FrameBuilder, marked: &[MarkedReceiver], light: LightId, options: PlanarSettings) {
    let purpose = "Adds the light everywhere: shadows are blended over it afterwards.";
    frame.light_pass(light, purpose, &frame.light_everywhere());
    if options.marks {
        mark_pass(frame, marked, light);
    } else if options.blend == ShadowBlend::Once {
        let because = "without the stencil nothing keeps a pixel from being darkened twice";
        frame.leave_out(Decision::BlendOnce, light.name(), because);
    }
    let on_mark = StencilFace { compare: CompareFunction::Equal, ..StencilFace::IGNORE };
    let raster = |color, mark| match options.marks {
        true => raster_of(&options, color).with_stencil(on_mark, mark),
        false => raster_of(&options, color),
    };
    let is_opaque = options.blend == ShadowBlend::Opaque;
    let over = if is_opaque { ColorWrite::Replace } else { ColorWrite::Multiply };
    let darken = |mark| (Program::Flat, raster(over, mark));
    let draws = shadow_draws(frame, marked, light, options, &darken);
    let label = |mark| (Program::FlatLabel, raster(ColorWrite::Replace, mark));
    let labels = shadow_draws(frame, marked, light, options, &label);
    if !draws.is_empty() {
        let purpose = match is_opaque {
            true => {
                "Draws every caster, flattened onto each receiver's plane, in black over what is there: ambient light and \
                 what other lights gave are gone as well."
            }
            false => {
                "Draws every caster, flattened onto each receiver's plane, and darkens what is there: once for \
                 every triangle that covers a pixel, and what other lights gave as well."
            }
        };
        frame.blend_pass(light, "shadows", purpose, draws);
    }
    frame.mask_pass_with(light, &[SurfaceDrawing::lit()], labels);
}

/// Returns the receivers that the eye sees from the light's side and that `choice` keeps, each with an even stencil mark.
/// The others show no shadow of this light, which is recorded in the plan.
fn shown_receivers(
    frame: &mut FrameBuilder,
    all: &[FlatReceiver],
    light: LightId,
    options: PlanarSettings,
    choice: &ReceiverChoice,
) -> Vec<MarkedReceiver> {
    let mut shown: Vec<_> = all.iter().filter(|receiver| receiver.shows_lit_side(frame, light)).collect();
    let name = light.name();
    if shown.is_empty() {
        frame.leave_out(Decision::PlanarShadows, &name, "no flat receiver shows its lit side");
    } else if shown.len() < all.len() {
        let because = "light and eye are on different sides of them, so shading alone darkens them";
        let count = (all.len() - shown.len()) as u64;
        frame.plan.left_out.push(LeftOut::counted(Decision::DarkReceivers, count, &name, because));
    }
    if !options.marks {
        receivers::leave_out_unmarked(frame, &mut shown, &name);
    }
    receivers::choose(frame, &mut shown, choice, &name);
    // Marks are even, and a shadow on a mark is one more: a byte has space for those that are chosen.
    let mark = |index: usize| (index as u8 + 1) * 2;
    let marked = shown.into_iter().enumerate();
    marked.map(|(index, receiver)| MarkedReceiver { receiver: receiver.clone(), mark: mark(index) }).collect()
}

fn mark_pass(frame: &mut FrameBuilder, marked: &[MarkedReceiver], light: LightId) {
    let mut draws = Vec::new();
    for one in marked {
        let FlatReceiver { object, receiver, name } = &one.receiver;
        let placed = &frame.placed[*object];
        let Some(surface) = placed.surface else { continue };
        let corners = receiver.triangles.iter().flat_map(|t| placed.object.mesh.triangles()[*t as usize]).collect();
        let caster = Some(placed.object.name.clone());
        let vertices = frame.plan.meshes[surface.0].vertices.clone();
        let mesh = frame.add_mesh(DrawMesh::of_blobs(name.as_str(), vertices, Blob::new(corners)));
        let replace =
            StencilFace { compare: CompareFunction::Always, pass_op: StencilOperation::Replace, ..StencilFace::IGNORE };
        draws.push(Draw {
            name: name.clone(),
            caster,
            part: DrawPart::Receiver,
            program: Program::Position,
            raster: RasterState::visible_surface(ColorWrite::None).with_stencil(replace, one.mark),
            mesh,
            triangles: 0..receiver.triangles.len() as u32,
            base_vertex: 0,
            pieces: None,
            faces_inwards: false,
            constants: DrawConstants::default(),
            samples_maps_of: Vec::new(),
        });
    }
    if !draws.is_empty() {
        let purpose = "Marks the visible pixels of each flat receiver with an even number of its own, so that no \
                       shadow can leave its receiver.";
        frame.stencil_pass(light, "receivers", purpose, draws);
    }
}

/// Returns a draw for every caster flattened onto every marked receiver, without those of which no part is flattened;
/// records in the plan where none is left. `look` returns program and raster state for a receiver's mark.
fn shadow_draws(
    frame: &mut FrameBuilder,
    marked: &[MarkedReceiver],
    light: LightId,
    options: PlanarSettings,
    look: &dyn Fn(u8) -> (Program, RasterState),
) -> Vec<Draw> {
    let casters: Vec<usize> = (0..frame.placed.len()).filter(|index| frame.placed[*index].object.casts).collect();
    let casting: Vec<(usize, Casters)> =
        casters.into_iter().map(|index| (index, casting_triangles(frame, index, light, options))).collect();
    let mut draws = Vec::new();
    for one in marked {
        for &caster in &casting {
            let (program, raster) = look(one.mark);
            draws.extend(shadow_draw(frame, one, caster, light, options).map(|draw| Draw { program, raster, ..draw }));
        }
    }
    if draws.is_empty() && !marked.is_empty() {
        let because = "no caster is between the light and a flat receiver";
        frame.leave_out(Decision::PlanarShadows, light.name(), because);
    }
    draws
}

/// Returns which triangles of the object `index` are flattened: those that face the light where they are proven to suffice,
/// which the plan records, or all. Where each layer shows, as shadows are blended, and where casters are not clipped, all.
fn casting_triangles(frame: &mut FrameBuilder, index: usize, light: LightId, options: PlanarSettings) -> Casters {
    let shows_no_layer = options.counts() || options.blend == ShadowBlend::Opaque;
    let is_clipped = options.clip == FlattenClip::BetweenPlaneAndLight;
    let may_choose = shows_no_layer && is_clipped && frame.common.allows(Decision::AwayTriangles);
    if !may_choose {
        return Casters::All;
    }
    let (casters, record) = match casters::light_facing_suffices(frame, light, index) {
        Ok(proof) => (Casters::LightFacing, proof),
        Err(doubt) => (Casters::All, doubt),
    };
    frame.plan.left_out.push(record);
    casters
}

/// Returns the draw of one caster flattened onto one receiver, adding its mesh to the plan; `None` where nothing of the
/// caster is flattened. The flattened triangles are cached where the options say so.
fn shadow_draw(
    frame: &mut FrameBuilder,
    one: &MarkedReceiver,
    (caster, casters): (usize, Casters),
    light: LightId,
    options: PlanarSettings,
) -> Option<Draw> {
    let light_position = frame.light_position(light);
    let (placed, receiver) = (&frame.placed[caster], &one.receiver.receiver);
    let mesh = &placed.object.mesh;
    let is_own = caster == one.receiver.object;
    let flattened = FlattenedCaster {
        mesh: mesh.content_hash(),
        pose: placed.object.pose,
        plane: receiver.plane,
        light: light_position,
        clip: options.clip,
        faces_light: casters == Casters::LightFacing,
        own: receiver.triangles.first().copied().filter(|_| is_own),
    };
    let flatten = || {
        let own = receiver.triangles.iter().filter(|_| is_own);
        let on_plane: Vec<u32> = own.flat_map(|triangle| mesh.triangles()[*triangle as usize]).collect();
        Flattener::new(receiver.plane, light_position, options.clip).map_or_else(Vec::new, |mut flattener| {
            match casters {
                Casters::LightFacing => {
                    let signs = facing(&placed.world, mesh.triangles(), light_position);
                    let facing = mesh.triangles().iter().zip(signs).filter(|(_, sign)| *sign == Sign::Positive);
                    let triangles: Vec<[u32; 3]> = facing.map(|(corners, _)| *corners).collect();
                    flattener.add(&placed.world, &triangles, &on_plane);
                }
                _ => flattener.add(&placed.world, mesh.triangles(), &on_plane),
            }
            flattener.finish()
        })
    };
    let triangles = match options.keeps {
        true => frame.job.cache.flattened(&flattened, flatten),
        false => Arc::new(flatten()),
    };
    if triangles.is_empty() {
        return None;
    }
    let left = if options.blend == ShadowBlend::Opaque { 0.0 } else { ShadowBlend::LEAVES };
    let eye = frame.eye();
    let vertices = triangles.as_flattened().iter().map(|vertex| relative::homogeneous(*vertex, eye)).collect();
    let count = triangles.len() as u32;
    let name = format!("shadow of {} on {}", frame.placed[caster].object.name, one.receiver.name);
    let caster = Some(frame.placed[caster].object.name.clone());
    let mesh = frame.add_mesh(DrawMesh::of_positions(name.as_str(), vertices, (0..count * 3).collect()));
    Some(Draw {
        name,
        caster,
        part: DrawPart::PlanarShadow,
        program: Program::Position,
        raster: raster_of(&options, ColorWrite::None),
        mesh,
        triangles: 0..count,
        base_vertex: 0,
        pieces: None,
        faces_inwards: false,
        constants: DrawConstants { label: 1, flat: [left, left, left, 1.0], ..DrawConstants::default() },
        samples_maps_of: Vec::new(),
    })
}
