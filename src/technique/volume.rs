//! Shadow volumes counted in the stencil buffer: z-pass, z-fail and z-pass-plus.
//!
//! Every caster's volume is drawn with depth and colour writes off. A volume face raises or lowers
//! the count of the pixels where it passes the depth test (z-pass: in front of the surface) or
//! fails it (z-fail: behind it, with caps so that volumes are closed there). What is left is the
//! number of volumes that contain the surface; the light pass skips where it is not zero.
//! Z-pass-plus starts z-pass from the count at the near plane instead of zero
//! ([`near_count`]).
//!
//! Light caps are the surface's own triangles in its own vertex order, so that their depths are
//! bit-equal and the strict test is exact. Triangles that face away from the light count as
//! turned: they are not turned in the buffer, but drawn with front and back operations swapped.
//! Sides are drawn a few steps of depth behind their place (`counting`).

mod counting;
mod near_count;
mod options;

use super::frame::{Drawn, Frame, Job, StencilUse};
use super::settings::ONE_ROW;
use super::{PlanError, ReportRows};
use crate::geometry::{Caster, Casters, Extruder, Extrusion, SilhouetteBy, VolumeParts, relative};
use crate::plan::{
    Blob, Draw, DrawConstants, DrawMesh, FramePlan, LightId, MeshId, Part, Program, RasterState, Visibility,
};
use crate::scene::Object;
use counting::{Counting, Step};
use options::{Options, WhoCasts};
use std::ops::Range;

/// What a report compares of z-pass and z-pass-plus: the defaults.
pub(super) const REPORT_ROWS: ReportRows = ONE_ROW;

/// Of z-fail also each way to count, cast and store depth that costs or saves something.
pub(super) const Z_FAIL_REPORT_ROWS: ReportRows = &[
    &[],
    &[("casters", "light-facing")],
    &[("casters", "by-topology")],
    &[("faces", "two-pass")],
    &[("counter", "float")],
    &[("extrusion", "finite:100")],
    &[("depth", "standard-infinite")],
    &[("depth", "standard-finite")],
];

/// Plans z-pass, z-fail or z-pass-plus.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    let counting = Counting::of(job.choice.technique());
    let options = Options::of(job.choice);
    options.check(job.scene)?;
    let stencil = if options.counts_in_float { StencilUse::ToLightOnce } else { StencilUse::Always };
    let mut frame = Frame::new(job, stencil)?;
    frame.clips_volumes = counting != Counting::Behind;
    frame.ambient_pass();
    for light in frame.light_ids() {
        let volumes = volumes(&mut frame, light, counting, &options);
        if options.counts_in_float {
            count_in_float(&mut frame, light, counting, &options, &volumes);
            continue;
        }
        if counting == Counting::InFrontPlus {
            near_count::pass(&mut frame, light, &options, &volumes);
        }
        for step in Step::all(options.two_pass) {
            let draws = volumes.iter().flat_map(|volume| volume.draws(counting, &options, *step)).collect();
            frame.stencil_pass(light, step.name(), &counting.purpose(light, *step), draws);
        }
        frame.mask_pass(light, &[Drawn::shadow(), Drawn::lit().where_stencil(0xff, 0)]);
        let purpose = "Adds the light where the count is zero, and raises the count there, so that no pixel is lit \
                       twice. Everywhere else the surface is inside a shadow volume and stays dark.";
        frame.light_pass(light, purpose, &Drawn::light_once_where_zero(0xff));
    }
    Ok(frame.finish())
}

/// The same in a float target: signed, and right beyond eight bits. It adds and takes away in one
/// draw, and stops nowhere.
fn count_in_float(frame: &mut Frame, light: LightId, counting: Counting, options: &Options, volumes: &[Volume]) {
    frame.add_count(light);
    if options.two_pass || options.clamp {
        let because = "a float target adds and takes away in one draw, and has no limits to stop at";
        frame.leave_out("two passes and clamping", &Frame::light_name(light), because);
    }
    if counting == Counting::InFrontPlus {
        near_count::pass(frame, light, options, volumes);
    }
    let draws = volumes.iter().flat_map(|volume| volume.float_draws(counting, options)).collect();
    let purpose = counting.purpose(light, Step::BothFaces);
    frame.count_pass(light, Step::BothFaces.name(), &purpose, draws);
    frame.mask_pass(light, &[Drawn::lit_by(Visibility::Count)]);
    let purpose = "Adds the light where the count is zero. Everywhere else the surface is inside a shadow volume and \
                   stays dark.";
    frame.light_pass(light, purpose, &frame.light_by(Visibility::Count));
}

/// A caster's volume, ready to be drawn.
struct Volume {
    caster: String,
    mesh: MeshId,
    parts: VolumeParts,
    /// Which of its parts count in the volume pass.
    needed: Vec<NeededPart>,
}

/// A run of a volume's triangles that counts.
struct NeededPart {
    part: Part,
    /// Its triangles face inwards: operations are swapped.
    turned: bool,
    triangles: Range<usize>,
}

impl Volume {
    fn draws(&self, counting: Counting, options: &Options, step: Step) -> Vec<Draw> {
        let draw = |part: &NeededPart| {
            let raster = counting.raster(part.part, part.turned, options, step);
            self.draw(part.part, part.turned, &part.triangles, raster)
        };
        self.needed.iter().map(draw).collect()
    }

    fn float_draws(&self, counting: Counting, options: &Options) -> Vec<Draw> {
        let draw = |part: &NeededPart| {
            let (raster, count) = counting.float_raster(part.part, part.turned, options);
            let constants = DrawConstants { count, ..DrawConstants::default() };
            let draw = self.draw(part.part, part.turned, &part.triangles, raster);
            Draw { program: Program::Count, constants, ..draw }
        };
        self.needed.iter().map(draw).collect()
    }

    fn draw(&self, part: Part, turned: bool, triangles: &Range<usize>, raster: RasterState) -> Draw {
        let what = match (part, turned) {
            (Part::Side, _) => "sides",
            (Part::LightCap, false) => "light cap",
            (Part::LightCap, true) => "turned light cap",
            // What faces the light faces inwards at the far end.
            (_, true) => "dark cap",
            (_, false) => "turned dark cap",
        };
        Draw {
            name: format!("{what} of {}", self.caster),
            caster: Some(self.caster.clone()),
            part,
            program: Program::Position,
            raster,
            mesh: self.mesh,
            triangles: triangles.start as u32..triangles.end as u32,
            base_vertex: self.parts.dark_cap_base.filter(|_| part == Part::DarkCap).unwrap_or(0),
            faces_inwards: turned,
            constants: DrawConstants::default(),
        }
    }
}

fn volumes(frame: &mut Frame, light: LightId, counting: Counting, options: &Options) -> Vec<Volume> {
    let mut volumes = Vec::new();
    for index in 0..frame.placed.len() {
        let object = frame.placed[index].object;
        if !object.casts || object.mesh.triangles().is_empty() {
            continue;
        }
        let casters = who_casts(frame, light, index, options);
        let (mesh, parts) = make(frame, light, index, casters, options);
        if parts.light_cap_turned.end == 0 {
            let because = match casters {
                Casters::All => "every triangle is edge-on to the light",
                Casters::LightFacing => "no triangle faces the light",
                Casters::LightBackFacing => "no triangle faces away from the light",
            };
            frame.leave_out("volume", &object.name, because);
            continue;
        }
        let mut needed = needed_parts(frame, counting, options, &parts, object);
        needed.retain(|part| !part.triangles.is_empty());
        let mesh = frame.add_mesh(mesh);
        volumes.push(Volume { caster: object.name.clone(), mesh, parts, needed });
    }
    volumes
}

/// Which triangles of an object cast; for `by-topology`, with what decided it.
fn who_casts(frame: &mut Frame, light: LightId, index: usize, options: &Options) -> Casters {
    let WhoCasts::ByTopology = options.casters else { return options.casters.fixed() };
    let (position, placed) = (frame.light_position(light), &frame.placed[index]);
    let object = placed.object;
    let caster = Caster { mesh: &object.mesh, pose: &object.pose, world: &placed.world };
    let name = Frame::light_name(light);
    match frame.job.cache.light_facing_suffices(caster, position) {
        Ok(()) => {
            let because = format!(
                "proven: the mesh is closed, consistently wound, nowhere inside out and does not meet itself, and \
                 {name} is outside it; the triangles that face the light cast the same shadow alone"
            );
            frame.leave_out("triangles that face away", &object.name, &because);
            Casters::LightFacing
        }
        Err(doubt) => {
            let because = format!("not for {name}: {doubt}; so every triangle casts");
            frame.leave_out("choice of light-facing triangles", &object.name, &because);
            Casters::All
        }
    }
}

fn make(
    frame: &mut Frame,
    light: LightId,
    index: usize,
    casters: Casters,
    options: &Options,
) -> (DrawMesh, VolumeParts) {
    let (position, eye) = (frame.light_position(light), frame.eye());
    let placed = &frame.placed[index];
    let caster = Caster { mesh: &placed.object.mesh, pose: &placed.object.pose, world: &placed.world };
    let extruder = Extruder::new(&placed.world, position, options.extrusion);
    let mut indices = Vec::new();
    let cache = &mut frame.job.cache;
    let parts = cache.volume_indices(caster, position, casters, options.silhouette, &extruder, &mut indices);
    let vertices = extruder.vertices(&placed.world).map(|vertex| relative::homogeneous(vertex, eye)).collect();
    let mesh = DrawMesh {
        name: format!("volume of {}", placed.object.name),
        vertices: Blob::new(vertices),
        indices: Blob::new(indices),
        surface: None,
    };
    (mesh, parts)
}

fn needed_parts(
    frame: &mut Frame,
    counting: Counting,
    options: &Options,
    parts: &VolumeParts,
    caster: &Object,
) -> Vec<NeededPart> {
    let part = |part, turned, triangles: &Range<usize>| NeededPart { part, turned, triangles: triangles.clone() };
    let light_caps =
        [part(Part::LightCap, false, &parts.light_cap), part(Part::LightCap, true, &parts.light_cap_turned)];
    let mut needed = vec![part(Part::Side, false, &parts.sides)];
    if counting == Counting::Behind || !caster.visible {
        // In z-pass the view ray enters the volume of an undrawn caster through its light cap.
        needed.extend(light_caps);
    } else {
        let because = "z-pass counts in front of surfaces, and a drawn caster's cap is never in front of itself";
        frame.leave_out("caps", &caster.name, because);
    }
    // A finite volume ends in front of whatever lies beyond it.
    if counting == Counting::Behind || options.extrusion != Extrusion::Infinite {
        if parts.dark_cap_base.is_some() {
            needed.push(part(Part::DarkCap, true, &parts.light_cap));
            needed.push(part(Part::DarkCap, false, &parts.light_cap_turned));
        } else {
            let because = "a directional light's volume closes in one point at infinity";
            frame.leave_out("dark cap", &caster.name, because);
        }
    }
    needed
}
