//! What z-pass-plus begins with: how many volumes contain each point of the near plane.
//!
//! A point of the near plane is in the volume of every casting triangle that lies between it and
//! the light (Hornus, Hoberock, Lefebvre and Hart 2005, "ZP+: correct Z-pass stencil shadows").
//! So the casting triangles are drawn as the light sees them through the near rectangle, clipped to
//! what lies between: each adds 1 where it covers a point. One matrix does it: a triangle goes
//! along the light's rays onto the near plane, and from there to its pixel as the camera has it.
//!
//! Known errors: a triangle that crosses the near plane is cut there twice, by the light's view and
//! by the camera's, and the two cuts round differently, which leaves cracks along the line. A
//! light in the near plane sees the rectangle as a line; the count is left at zero then. Finite
//! extrusion is not asked about: a near-plane point beyond a volume's end counts as inside.

use super::counting::operations;
use super::drawn::VolumePlan;
use crate::geometry::near_view;
use crate::plan::{
    ColorWrite, Decision, Draw, DrawConstants, LightId, PlanView, Program, RasterState, StencilFace, ViewId,
};
use crate::technique::frame::FrameBuilder;
use crate::technique::settings::{CountOperations, VolumeSettings};
use wgpu_types::CompareFunction;

/// Adds the pass that counts, from the light through the near rectangle, the volumes around each point of the near
/// plane (z-pass-plus). Adds nothing, and records why, where no caster can count.
pub fn pass(frame: &mut FrameBuilder, light: LightId, options: &VolumeSettings, volumes: &[VolumePlan]) {
    let name = light.name();
    let position = frame.light_position(light);
    let points = frame.placed.iter().filter(|placed| placed.object.casts).flat_map(|placed| &placed.world);
    let camera = &frame.job.scene.camera;
    let matrix = near_view::through_near_rectangle(camera, camera.aspect_in(frame.job.size), position, points);
    let matrix = match matrix {
        Ok(matrix) => matrix,
        Err(because) => {
            frame.leave_out(Decision::NearPlane, &name, because);
            return;
        }
    };
    let raster = raster(options);
    let draws: Vec<_> =
        volumes.iter().flat_map(|volume| volume.casting().map(|part| volume.draw(&part, raster.clone()))).collect();
    if draws.is_empty() {
        frame.leave_out(Decision::NearPlane, &name, "nothing casts");
        return;
    }
    let origin = frame.eye();
    frame.plan.views.push(PlanView {
        name: format!("{name} through the near rectangle"),
        origin,
        eye: PlanView::at_origin(),
        clip_from_relative: matrix.as_mat4(),
    });
    let view = ViewId(frame.plan.views.len() - 1);
    let does = match options.operations {
        CountOperations::Inverting if !options.counts_in_float => "turns the bit over",
        _ => "adds 1",
    };
    let purpose = format!(
        "Counts how many shadow volumes of {name} contain each point of the near plane: every casting triangle between \
         it and the light {does}, drawn as the light sees it through the near rectangle."
    );
    if options.counts_in_float {
        let adding_one = DrawConstants { flat: [1.0, 0.0, 0.0, 0.0], ..DrawConstants::default() };
        let in_float = |draw: Draw| Draw { program: Program::Flat, constants: adding_one, ..draw };
        frame.count_pass(0, light, "near plane", &purpose, draws.into_iter().map(in_float).collect());
    } else {
        frame.stencil_pass(light, "near plane", &purpose, draws);
    }
    if let Some(pass) = frame.plan.passes.last_mut() {
        pass.view = view;
    }
}

/// Returns a raster state in which a fragment of either face increments the count, whatever its depth: in the stencil,
/// or in a float target where the settings count there.
fn raster(options: &VolumeSettings) -> RasterState {
    let count = StencilFace {
        compare: CompareFunction::Always,
        pass_op: operations(options).0,
        depth_fail_op: operations(options).0,
        ..StencilFace::IGNORE
    };
    let color = if options.counts_in_float { ColorWrite::Add } else { ColorWrite::None };
    let state =
        RasterState { depth_compare: CompareFunction::Always, depth_write: false, color, ..RasterState::surface() };
    if options.counts_in_float { state } else { state.with_stencil(count, 0).writing(options.mask()) }
}
