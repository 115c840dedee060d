//! Shadow volumes counted in the stencil buffer: z-pass and z-fail.
//!
//! Every caster's volume is drawn with depth and colour writes off. A volume face raises or lowers
//! the count of the pixels where it passes the depth test (z-pass: in front of the surface) or
//! fails it (z-fail: behind it, with caps so that volumes are closed there). What is left is the
//! number of volumes that contain the surface; the light pass skips where it is not zero.
//!
//! Light caps are the surface's own triangles in its own vertex order, so that their depths are
//! bit-equal and the strict test is exact. Triangles that face away from the light count as
//! turned: they are not turned in the buffer, but drawn with front and back operations swapped.

use super::frame::{Drawn, Frame, Job, StencilUse};
use super::settings::ONE_ROW;
use super::{PlanError, ReportRows, Technique};
use crate::geometry::{Volume, VolumeParts, relative};
use crate::plan::{
    Blob, ColorWrite, Draw, DrawConstants, DrawMesh, FramePlan, LightId, MeshId, Part, Program, RasterState,
    StencilFace,
};
use crate::scene::Object;
use std::ops::Range;
use wgpu::{CompareFunction, StencilOperation};

/// Where a volume face counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Counting {
    /// In front of the surface.
    ZPass,
    /// Behind the surface.
    ZFail,
}

/// What a report compares: the defaults.
pub(super) const REPORT_ROWS: ReportRows = ONE_ROW;

/// Plans z-pass or z-fail.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    let counting = if job.choice.technique() == Technique::ZPass { Counting::ZPass } else { Counting::ZFail };
    let mut frame = Frame::new(job, StencilUse::Always)?;
    frame.ambient_pass();
    for light in frame.light_ids() {
        let draws = volume_draws(&mut frame, light, counting);
        frame.stencil_pass(light, "volumes", &counting.purpose(light), draws);
        frame.mask_pass(light, &[Drawn::shadow(), Drawn::lit().where_stencil(0xff, 0)]);
        let purpose = "Adds the light where the count is zero, and raises the count there, so that no pixel is lit \
                       twice. Everywhere else the surface is inside a shadow volume and stays dark.";
        frame.light_pass(light, purpose, &Drawn::light_once_where_zero(0xff));
    }
    Ok(frame.finish())
}

impl Counting {
    fn purpose(self, light: LightId) -> String {
        let light = Frame::light_name(light);
        match self {
            Counting::ZPass => format!(
                "Counts the shadow volumes of {light} in front of each surface: a front face nearer than the surface \
                 adds 1, a back face nearer than it takes 1 away. What is left contains the surface, if the eye \
                 itself is in none."
            ),
            Counting::ZFail => format!(
                "Counts the shadow volumes of {light} behind each surface: a back face hidden by the surface adds 1, a \
                 hidden front face takes 1 away. What is left contains the surface, wherever the eye is."
            ),
        }
    }

    /// The volume pass' state for triangles that face outwards (`turned`: inwards).
    fn raster(self, turned: bool) -> RasterState {
        let (nearer, farther) = match self {
            Counting::ZPass => (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap),
            Counting::ZFail => (StencilOperation::DecrementWrap, StencilOperation::IncrementWrap),
        };
        let (front, back) = if turned { (farther, nearer) } else { (nearer, farther) };
        let state = RasterState { depth_write: false, color: ColorWrite::None, ..RasterState::surface() };
        state.with_faces(self.face(front), self.face(back), 0)
    }

    fn face(self, operation: StencilOperation) -> StencilFace {
        let keep = StencilFace { compare: CompareFunction::Always, ..StencilFace::IGNORE };
        match self {
            Counting::ZPass => StencilFace { pass_op: operation, ..keep },
            Counting::ZFail => StencilFace { depth_fail_op: operation, ..keep },
        }
    }
}

fn volume_draws(frame: &mut Frame, light: LightId, counting: Counting) -> Vec<Draw> {
    let mut draws = Vec::new();
    for index in 0..frame.placed.len() {
        let placed = &frame.placed[index];
        let object = placed.object;
        if !object.casts || object.mesh.triangles().is_empty() {
            continue;
        }
        let edges = frame.job.cache.edges(&object.mesh);
        let volume = Volume::new(&placed.world, object.mesh.triangles(), &edges, frame.light_position(light));
        let mut needed = needed_parts(frame, light, counting, &volume.parts, object);
        needed.retain(|part| !part.triangles.is_empty());
        if needed.is_empty() {
            frame.leave_out("volume", &object.name, "every triangle is edge-on to the light");
            continue;
        }
        let mesh = add_volume_mesh(frame, &object.name, &volume);
        draws.extend(needed.iter().map(|part| volume_draw(&object.name, mesh, part, counting)));
    }
    draws
}

/// A run of a volume's triangles that counts.
struct NeededPart {
    part: Part,
    /// Its triangles face inwards: operations are swapped.
    turned: bool,
    triangles: Range<usize>,
}

fn needed_parts(
    frame: &mut Frame,
    light: LightId,
    counting: Counting,
    parts: &VolumeParts,
    caster: &Object,
) -> Vec<NeededPart> {
    let part = |part, turned, triangles: &Range<usize>| NeededPart { part, turned, triangles: triangles.clone() };
    let sides = part(Part::Side, false, &parts.sides);
    let light_caps =
        [part(Part::LightCap, false, &parts.light_cap), part(Part::LightCap, true, &parts.light_cap_turned)];
    let mut needed = vec![sides];
    match counting {
        Counting::ZPass if caster.visible => {
            let because = "z-pass counts in front of surfaces, and a drawn caster's cap is never in front of itself";
            frame.leave_out("caps", &caster.name, because);
        }
        // The view ray enters the volume of an undrawn caster through its light cap.
        Counting::ZPass => needed.extend(light_caps),
        Counting::ZFail => {
            needed.extend(light_caps);
            needed.push(part(Part::DarkCap, false, &parts.dark_cap));
            if frame.light_position(light).w == 0.0 {
                let because = "a directional light's volume closes in one point at infinity";
                frame.leave_out("dark cap", &caster.name, because);
            }
        }
    }
    needed
}

fn add_volume_mesh(frame: &mut Frame, caster: &str, volume: &Volume) -> MeshId {
    let eye = frame.eye();
    let vertices = volume.vertices.iter().map(|vertex| relative::homogeneous(*vertex, eye)).collect();
    frame.add_mesh(DrawMesh {
        name: format!("volume of {caster}"),
        vertices: Blob::new(vertices),
        indices: Blob::new(volume.triangles.as_flattened().to_vec()),
        surface: None,
    })
}

fn volume_draw(caster: &str, mesh: MeshId, part: &NeededPart, counting: Counting) -> Draw {
    let what = match (part.part, part.turned) {
        (Part::Side, _) => "sides",
        (Part::LightCap, false) => "light cap",
        (Part::LightCap, true) => "turned light cap",
        _ => "dark cap",
    };
    Draw {
        name: format!("{what} of {caster}"),
        caster: Some(caster.to_owned()),
        part: part.part,
        program: Program::Position,
        raster: counting.raster(part.turned),
        mesh,
        triangles: part.triangles.start as u32..part.triangles.end as u32,
        constants: DrawConstants::default(),
    }
}
