//! Planar shadows: casters flattened onto every flat receiver.
//!
//! A pass marks each receiver's visible pixels with an even number of its own in the stencil; the
//! next draws the casters, flattened onto the receiver's plane, without a depth test: where the
//! stencil has the receiver's mark it goes up by one, so an odd number means shadow and no pixel
//! can be darkened twice. The light pass then skips odd pixels. Surfaces that are not flat get no
//! shadow.

use super::frame::{Drawn, Frame, Job, StencilUse};
use super::settings::ONE_ROW;
use super::{PlanError, ReportRows};
use crate::geometry::{planar, relative};
use crate::math::{Sign, side_of_triangle};
use crate::plan::{
    Blob, ColorWrite, Draw, DrawConstants, DrawMesh, FramePlan, LightId, Part, Program, RasterState, StencilFace,
};
use wgpu::{CompareFunction, StencilOperation};

/// The largest are served; each costs a draw a caster. (Marks are even and shadows one more, so a
/// byte would hold 127.)
const MOST_RECEIVERS: usize = 64;

/// A receiver that can show shadows: where it is, and its mark.
struct Marked {
    object: usize,
    receiver: planar::Receiver,
    mark: u8,
}

/// What a report compares: the defaults.
pub(super) const REPORT_ROWS: ReportRows = ONE_ROW;

/// Plans planar shadows.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    let mut frame = Frame::new(job, StencilUse::Always)?;
    frame.ambient_pass();
    let receivers = all_receivers(&mut frame);
    for light in frame.light_ids() {
        let marked = marked_receivers(&mut frame, &receivers, light);
        if marked.is_empty() {
            frame.leave_out("planar shadows", &Frame::light_name(light), "no flat receiver shows its lit side");
        } else {
            let draws = mark_draws(&mut frame, &marked);
            let purpose = "Marks the visible pixels of each flat receiver with an even number of its own, so that no \
                           shadow can leave its receiver.";
            frame.stencil_pass(light, "receivers", purpose, draws);
            shadow_pass(&mut frame, &marked, light);
        }
        let odd = Drawn::shadow().where_stencil(1, 1);
        frame.mask_pass(light, &[Drawn::lit(), odd]);
        let purpose = "Adds the light where the stencil is even: odd numbers are shadows. It makes lit numbers odd, so \
                       that no pixel is lit twice.";
        frame.light_pass(light, purpose, &Drawn::light_once_where_zero(1));
    }
    Ok(frame.finish())
}

/// The receivers of every object that is drawn and receives, with the object's index.
fn all_receivers(frame: &mut Frame) -> Vec<(usize, planar::Receiver)> {
    let mut all = Vec::new();
    for (index, placed) in frame.placed.iter().enumerate() {
        if !placed.object.receives || placed.surface.is_none() {
            continue;
        }
        let mesh = &placed.object.mesh;
        let edges = frame.job.cache.edges(mesh);
        let found = planar::receivers(mesh.positions(), &placed.world, mesh.triangles(), &edges);
        all.extend(found.into_iter().map(|receiver| (index, receiver)));
    }
    all
}

/// The largest receivers whose lit side the eye sees: any other shows no shadow of this light.
fn marked_receivers(frame: &mut Frame, all: &[(usize, planar::Receiver)], light: LightId) -> Vec<Marked> {
    let (eye, light_position) = (frame.eye().extend(1.0), frame.light_position(light));
    let shows_lit_side = |(object, receiver): &&(usize, planar::Receiver)| {
        let placed = &frame.placed[*object];
        receiver.triangles.iter().any(|triangle| {
            let corners = placed.object.mesh.triangles()[*triangle as usize].map(|v| placed.world[v as usize]);
            let side = side_of_triangle(corners, eye);
            side != Sign::Zero && side == side_of_triangle(corners, light_position)
        })
    };
    let mut shown: Vec<_> = all.iter().filter(shows_lit_side).collect();
    shown.sort_by(|a, b| b.1.area.total_cmp(&a.1.area));
    let name = Frame::light_name(light);
    if shown.len() < all.len() {
        let because = "light and eye are on different sides of them, so shading alone darkens them";
        frame.leave_out(&format!("{} flat receivers", all.len() - shown.len()), &name, because);
    }
    if shown.len() > MOST_RECEIVERS {
        let because = "the 64 largest are kept: every one costs a draw for each caster";
        frame.leave_out(&format!("{} small flat receivers", shown.len() - MOST_RECEIVERS), &name, because);
    }
    let mark = |index: usize| (index as u8 + 1) * 2;
    let marked = shown.into_iter().take(MOST_RECEIVERS).enumerate();
    marked
        .map(|(index, (object, receiver))| Marked { object: *object, receiver: receiver.clone(), mark: mark(index) })
        .collect()
}

fn mark_draws(frame: &mut Frame, marked: &[Marked]) -> Vec<Draw> {
    let mut draws = Vec::new();
    for one in marked {
        let placed = &frame.placed[one.object];
        let Some(surface) = placed.surface else { continue };
        let corners = one.receiver.triangles.iter().flat_map(|t| placed.object.mesh.triangles()[*t as usize]).collect();
        let name = one.name(frame);
        let caster = Some(placed.object.name.clone());
        let vertices = frame.plan.meshes[surface.0].vertices.clone();
        let mesh =
            frame.add_mesh(DrawMesh { name: name.clone(), vertices, indices: Blob::new(corners), surface: None });
        let replace =
            StencilFace { compare: CompareFunction::Always, pass_op: StencilOperation::Replace, ..StencilFace::IGNORE };
        draws.push(Draw {
            name,
            caster,
            part: Part::Receiver,
            program: Program::Position,
            raster: RasterState::visible_surface(ColorWrite::None).with_stencil(replace, one.mark),
            mesh,
            triangles: 0..one.receiver.triangles.len() as u32,
            constants: DrawConstants::default(),
        });
    }
    draws
}

impl Marked {
    fn name(&self, frame: &Frame) -> String {
        let object = &frame.placed[self.object].object.name;
        format!("{object}, flat piece {}", self.mark / 2)
    }
}

fn shadow_pass(frame: &mut Frame, marked: &[Marked], light: LightId) {
    let mut draws = Vec::new();
    for one in marked {
        for caster in 0..frame.placed.len() {
            if frame.placed[caster].object.casts {
                draws.extend(shadow_draw(frame, one, caster, light));
            }
        }
    }
    if draws.is_empty() {
        frame.leave_out(
            "planar shadows",
            &Frame::light_name(light),
            "no caster is between the light and a flat receiver",
        );
        return;
    }
    let purpose = "Draws every caster, flattened onto each receiver's plane. Where the stencil still has the \
                   receiver's mark it goes up by one: overlapping triangles can't darken a pixel twice.";
    frame.stencil_pass(light, "shadows", purpose, draws);
}

/// A caster flattened onto one receiver; `None` where no part of it is between plane and light.
fn shadow_draw(frame: &mut Frame, one: &Marked, caster: usize, light: LightId) -> Option<Draw> {
    let placed = &frame.placed[caster];
    let mesh = &placed.object.mesh;
    let mut flattener = planar::Flattener::new(one.receiver.plane, frame.light_position(light))?;
    let own = one.receiver.triangles.iter().filter(|_| caster == one.object);
    let on_plane: Vec<u32> = own.flat_map(|triangle| mesh.triangles()[*triangle as usize]).collect();
    flattener.add(&placed.world, mesh.triangles(), &on_plane);
    let triangles = flattener.finish();
    if triangles.is_empty() {
        return None;
    }
    let eye = frame.eye();
    let vertices = triangles.as_flattened().iter().map(|vertex| relative::homogeneous(*vertex, eye)).collect();
    let count = triangles.len() as u32;
    let name = format!("shadow of {} on {}", placed.object.name, one.name(frame));
    let caster = Some(placed.object.name.clone());
    let mesh = frame.add_mesh(DrawMesh {
        name: name.clone(),
        vertices: Blob::new(vertices),
        indices: Blob::new((0..count * 3).collect()),
        surface: None,
    });
    Some(Draw {
        name,
        caster,
        part: Part::PlanarShadow,
        program: Program::Position,
        raster: darken_once(one.mark),
        mesh,
        triangles: 0..count,
        constants: DrawConstants::default(),
    })
}

fn darken_once(mark: u8) -> RasterState {
    let once = StencilFace {
        compare: CompareFunction::Equal,
        pass_op: StencilOperation::IncrementClamp,
        ..StencilFace::IGNORE
    };
    let anywhere = RasterState {
        depth_compare: CompareFunction::Always,
        depth_write: false,
        color: ColorWrite::None,
        ..RasterState::surface()
    };
    anywhere.with_stencil(once, mark)
}
