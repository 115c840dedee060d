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
//! Sides that hug the surface they are thrown by are drawn a little behind their place (`counting`).

mod counting;
mod near_count;
mod settings;

use super::auto::Questions;
use super::casters::{self, Darkened};
use super::description::{Description, ONE_ROW, Standing};
use super::frame::{Drawn, Frame, Job, StencilUse};
use super::{Choice, PlanError, Technique, shown};
use crate::geometry::{
    Caster, Casters, DarkCap, Extruder, Extrusion, Fan, GeometryCache, SilhouetteBy, VolumeOf, VolumeParts, relative,
};
use crate::plan::{
    Blob, DecidedBy, Decision, Draw, DrawConstants, DrawMesh, FramePlan, LeftOut, LightId, MeshId, Part, Program,
    RasterState, Side, Visibility,
};
use crate::scene::Object;
pub use counting::Counting;
use counting::Step;
use glam::{DVec3, DVec4};
pub use settings::{SETTINGS, VolumeSettings, WhoCasts};
use std::ops::Range;

/// What is said of z-pass.
pub(super) const Z_PASS: Description = Description {
    summary: "Counts the shadow volumes that the view ray is inside of when it reaches the surface, from the eye on.",
    plan,
    settings: &SETTINGS,
    report_rows: ONE_ROW,
    standing: Standing::Rival {
        place: 2,
        right_because: "the near plane cuts no volume, and the eye is in none",
        texels: None,
    },
};
/// What is said of z-fail.
pub(super) const Z_FAIL: Description = Description {
    summary: "Counts the same volumes from infinity back to the surface, so the eye may be inside one.",
    // Also each way to count, cast and store depth that costs or saves something.
    report_rows: &[
        &[],
        &[("casters", "light-facing")],
        &[("casters", "by-topology")],
        &[("faces", "two-pass")],
        &[("counter", "float")],
        &[("extrusion", "finite:100")],
        &[("depth", "standard-infinite")],
        &[("depth", "standard-finite")],
    ],
    standing: Standing::Rival {
        place: 1,
        right_because: "volumes are closed and counted from infinity, so neither eye nor near plane matters",
        texels: None,
    },
    ..Z_PASS
};
/// What is said of z-pass-plus.
pub(super) const Z_PASS_PLUS: Description = Description {
    summary: "Counts the near plane's volumes from the light first, then as z-pass: the eye may be inside one.",
    standing: Standing::Rival {
        place: 3,
        right_because: "what the near plane begins with is counted too, so the eye may be in a volume",
        texels: None,
    },
    ..Z_PASS
};

/// How a volume is counted, and which caps that takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    pub counting: Counting,
    pub light_cap: bool,
    pub dark_cap: bool,
}

/// Plans z-pass, z-fail, z-pass-plus or the mixture of them that is cheapest.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    let technique = job.choice.technique();
    let options = VolumeSettings::of(job.choice).unwrap_or_else(|| VolumeSettings::read(job.choice.settings()));
    options.check(job.scene)?;
    let stencil = if options.counts_in_float { StencilUse::ToLightOnce } else { StencilUse::Always };
    let mut frame = Frame::new(job, stencil)?;
    frame.clips_volumes = matches!(technique, Technique::ZPass | Technique::ZPassPlus);
    if technique == Technique::Auto {
        shown::leave_out_hidden(&mut frame);
    }
    frame.ambient_pass();
    let misses = frame.cut_to_ranges();
    for light in frame.light_ids() {
        if misses[light.0] {
            frame.leave_out(Decision::Light, light.name(), "its light ends before it reaches the view");
            frame.mask_pass(light, &[Drawn::lit()]);
            continue;
        }
        if technique == Technique::Auto {
            let lit = shown::lit_by(&mut frame, light);
            if lit.is_empty() && frame.common.allows(Decision::Light) {
                let because = "every surface in view faces away from it or lies beyond its range";
                frame.leave_out(Decision::Light, light.name(), because);
                frame.mask_pass(light, &[Drawn::lit()]);
                continue;
            }
            frame.lit = Some(lit);
        }
        let (volumes, may_overflow) = volumes(&mut frame, light, &options);
        let counting = Counting::of(technique);
        let side = counted_by(&volumes, counting).map_or(Side::AsNeeded, Counting::side);
        frame.plan.lights[light.0].decided_by = DecidedBy::StencilCount { side };
        if options.counts_in_float || may_overflow {
            frame.plan.lights[light.0].decided_by = DecidedBy::FloatCount { side };
            count_in_float(&mut frame, light, counting, &options, &volumes);
            continue;
        }
        if counting == Counting::InFrontPlus {
            near_count::pass(&mut frame, light, &options, &volumes);
        }
        let counted = counted_by(&volumes, counting);
        for step in Step::all(options.two_pass) {
            let draws: Vec<Draw> = volumes.iter().flat_map(|volume| volume.draws(&options, *step)).collect();
            if draws.is_empty() && technique == Technique::Auto {
                frame.leave_out(Decision::VolumePass, light.name(), "no caster's volume is needed");
                continue;
            }
            frame.stencil_pass(light, step.name(), &counting::purpose(counted, light, *step), draws);
        }
        frame.mask_pass(light, &[Drawn::shadow(), Drawn::lit().where_stencil(0xff, 0)]);
        let purpose = "Adds the light where the count is zero, and raises the count there, so that no pixel is lit \
                       twice. Everywhere else the surface is inside a shadow volume and stays dark.";
        frame.light_pass(light, purpose, &Drawn::light_once_where_zero(0xff));
    }
    Ok(frame.finish())
}

/// How all of these are counted, `usual` if there are none; `None` where each has its own way.
fn counted_by(volumes: &[Volume], usual: Counting) -> Option<Counting> {
    let first = volumes.first().map_or(usual, |volume| volume.counting);
    volumes.iter().all(|volume| volume.counting == first).then_some(first)
}

/// The same in a float target: signed, and right beyond eight bits. It adds and takes away in one
/// draw, and stops nowhere.
fn count_in_float(frame: &mut Frame, light: LightId, counting: Counting, options: &VolumeSettings, volumes: &[Volume]) {
    frame.add_count(light);
    if options.two_pass || options.clamp {
        let because = "a float target adds and takes away in one draw, and has no limits to stop at";
        frame.leave_out(Decision::TwoPasses, light.name(), because);
    }
    if counting == Counting::InFrontPlus {
        near_count::pass(frame, light, options, volumes);
    }
    let draws = volumes.iter().flat_map(|volume| volume.float_draws(options)).collect();
    let purpose = counting::purpose(counted_by(volumes, counting), light, Step::BothFaces);
    frame.count_pass(light, Step::BothFaces.name(), &purpose, draws);
    frame.mask_pass(light, &[Drawn::lit_by(Visibility::Count)]);
    let purpose = "Adds the light where the count is zero. Everywhere else the surface is inside a shadow volume and \
                   stays dark.";
    frame.light_pass(light, purpose, &frame.light_by(Visibility::Count));
}

/// A caster's volume, ready to be drawn.
struct Volume {
    caster: String,
    counting: Counting,
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
    /// Sides that the surface they are thrown by is too near to.
    hugs: bool,
    /// What is added to its indices.
    base_vertex: u32,
    triangles: Range<usize>,
}

impl NeededPart {
    fn new(part: Part, turned: bool, triangles: &Range<usize>) -> NeededPart {
        NeededPart { part, turned, hugs: false, base_vertex: 0, triangles: triangles.clone() }
    }
}

impl Volume {
    /// The casting triangles themselves.
    fn casting(&self) -> impl Iterator<Item = NeededPart> {
        let runs = [(false, &self.parts.light_cap), (true, &self.parts.light_cap_turned)];
        let parts = runs.map(|(turned, triangles)| NeededPart::new(Part::LightCap, turned, triangles));
        parts.into_iter().filter(|part| !part.triangles.is_empty())
    }

    /// The same in world space: `object` is the caster's index.
    fn casting_triangles(&self, frame: &Frame, object: usize) -> impl Iterator<Item = [DVec3; 3]> {
        let world = &frame.placed[object].world;
        let corners = frame.plan.meshes[self.mesh.0].indices.data();
        let casting = self.parts.light_cap.start * 3..self.parts.light_cap_turned.end * 3;
        corners[casting].chunks_exact(3).map(|corners| [0, 1, 2].map(|corner| world[corners[corner] as usize]))
    }

    fn draws(&self, options: &VolumeSettings, step: Step) -> Vec<Draw> {
        self.needed.iter().map(|part| self.draw(part, self.counting.raster(part, options, step))).collect()
    }

    fn float_draws(&self, options: &VolumeSettings) -> Vec<Draw> {
        let draw = |part: &NeededPart| {
            let (raster, count) = self.counting.float_raster(part, options);
            let constants = DrawConstants { count, ..DrawConstants::default() };
            Draw { program: Program::Count, constants, ..self.draw(part, raster) }
        };
        self.needed.iter().map(draw).collect()
    }

    fn draw(&self, part: &NeededPart, raster: RasterState) -> Draw {
        let what = match (part.part, part.turned) {
            (Part::Side, _) if part.hugs => "hugging sides",
            (Part::Side, _) => "sides",
            (Part::LightCap, false) => "light cap",
            (Part::LightCap, true) => "turned light cap",
            // What faces the light faces inwards at the far end.
            (_, false) if part.base_vertex != 0 => "turned dark cap",
            (_, _) => "dark cap",
        };
        Draw {
            name: format!("{what} of {}", self.caster),
            caster: Some(self.caster.clone()),
            part: part.part,
            program: Program::Position,
            raster,
            mesh: self.mesh,
            triangles: part.triangles.start as u32..part.triangles.end as u32,
            base_vertex: part.base_vertex,
            faces_inwards: part.turned,
            constants: DrawConstants::default(),
        }
    }
}

/// All volumes of a light, and whether they may count beyond eight bits although nobody asked for that.
fn volumes(frame: &mut Frame, light: LightId, options: &VolumeSettings) -> (Vec<Volume>, bool) {
    let technique = frame.job.choice.technique();
    let counting = Counting::of(technique);
    let questions = (technique == Technique::Auto).then(|| Questions::new(frame, light));
    let (mut volumes, mut counted) = (Vec::new(), Vec::new());
    for index in 0..frame.placed.len() {
        let object = frame.placed[index].object;
        if !object.casts || object.mesh.triangles().is_empty() {
            continue;
        }
        let form = match &questions {
            Some(questions) => questions.form(frame, index),
            None => Ok(fixed_form(frame, counting, options, object)),
        };
        let form = match form {
            Ok(form) => form,
            Err(left_out) => {
                frame.plan.left_out.push(left_out);
                continue;
            }
        };
        let casters = who_casts(frame, light, index, options);
        let held = questions.as_ref().map(|questions| questions.held_by_parts(frame, index)).unwrap_or_default();
        let (mesh, parts) = make(frame, light, index, (casters, &held), options);
        if parts.light_cap_turned.end == 0 {
            let because = match casters {
                Casters::All => "every triangle is edge-on to the light",
                Casters::LightFacing => "no triangle faces the light",
                Casters::LightBackFacing => "no triangle faces away from the light",
            };
            frame.leave_out(Decision::NothingCasts, &object.name, because);
            continue;
        }
        // A bias of sides that hug it is a few steps, and rounding may be more.
        if !parts.hugging_sides.is_empty() && !casters::can_darken(frame, index, light, Darkened::All) {
            let because = "the light grazes it, so that depth can't tell it from its sides, and nothing is behind it";
            frame.leave_out(Decision::Caster, &object.name, because);
            continue;
        }
        let mut needed = needed_parts(frame, form, &parts, object);
        needed.retain(|part| !part.triangles.is_empty());
        let mesh = frame.add_mesh(mesh);
        volumes.push(Volume { caster: object.name.clone(), counting: form.counting, mesh, parts, needed });
        counted.push(index);
    }
    let casting = || volumes.iter().zip(&counted).flat_map(|(volume, index)| volume.casting_triangles(frame, *index));
    let may_overflow = questions.is_some_and(|questions| questions.may_overflow(&casting().collect::<Vec<_>>()));
    if may_overflow {
        let because = "a ray of it may meet more than 255 casting triangles: a float counts them";
        frame.leave_out(Decision::EightBits, light.name(), because);
    }
    (volumes, may_overflow)
}

/// What a technique gives every caster.
fn fixed_form(frame: &mut Frame, counting: Counting, options: &VolumeSettings, caster: &Object) -> Form {
    // In z-pass the view ray enters the volume of an undrawn caster through its light cap.
    let light_cap = counting == Counting::Behind || !caster.visible;
    if !light_cap {
        let because = "z-pass counts in front of surfaces, and a drawn caster's cap is never in front of itself";
        frame.leave_out(Decision::Caps, &caster.name, because);
    }
    // A finite volume ends in front of whatever lies beyond it.
    Form { counting, light_cap, dark_cap: counting == Counting::Behind || options.extrusion != Extrusion::Infinite }
}

/// Which of a caster's triangles cast a volume's shadow, as `choice` says; all, where its technique has no volumes.
#[must_use]
pub fn casting(choice: &Choice, cache: &mut GeometryCache, caster: Caster, light: DVec4) -> Casters {
    let who = VolumeSettings::of(choice).map_or(WhoCasts::Always(Casters::All), |settings| settings.casters);
    match who {
        WhoCasts::Always(casters) => casters,
        WhoCasts::ByTopology if cache.light_facing_suffices(caster, light).is_ok() => Casters::LightFacing,
        WhoCasts::ByTopology => Casters::All,
    }
}

/// Which triangles of an object cast; for `by-topology`, with what decided it.
fn who_casts(frame: &mut Frame, light: LightId, index: usize, options: &VolumeSettings) -> Casters {
    let WhoCasts::ByTopology = options.casters else { return options.casters.fixed() };
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
            frame.leave_out(Decision::AwayTriangles, &object.name, because);
            Casters::LightFacing
        }
        Err(doubt) => {
            let because = format!("not for {name}: {doubt}; so every triangle casts");
            frame.leave_out(Decision::LightFacing, &object.name, because);
            Casters::All
        }
    }
}

fn make(
    frame: &mut Frame,
    light: LightId,
    index: usize,
    (casters, held): (Casters, &[bool]),
    options: &VolumeSettings,
) -> (DrawMesh, VolumeParts) {
    let (position, eye) = (frame.light_position(light), frame.eye());
    let placed = &frame.placed[index];
    let caster = Caster { mesh: &placed.object.mesh, pose: &placed.object.pose, world: &placed.world };
    let extruder = Extruder::new(&placed.world, position, options.extrusion);
    let mut indices = Vec::new();
    let (is_drawn, by) = (placed.object.visible, options.silhouette);
    let volume = VolumeOf { caster, is_drawn, light: position, casters, held, by, extruder: &extruder };
    let parts = frame.job.cache.volume_indices(&volume, &mut indices);
    let fan = if let DarkCap::Fan(_, fan) = parts.dark_cap { Some(fan) } else { None };
    let vertices = extruder.vertices(&placed.world).chain(fan.iter().flat_map(Fan::vertices));
    let vertices = vertices.map(|vertex| relative::homogeneous(vertex, eye)).collect();
    let mesh = DrawMesh {
        name: format!("volume of {}", placed.object.name),
        vertices: Blob::new(vertices),
        indices: Blob::new(indices),
        surface: None,
    };
    (mesh, parts)
}

fn needed_parts(frame: &mut Frame, form: Form, parts: &VolumeParts, caster: &Object) -> Vec<NeededPart> {
    let run = NeededPart::new;
    let hugging = NeededPart { hugs: true, ..run(Part::Side, false, &parts.hugging_sides) };
    let mut needed = vec![run(Part::Side, false, &parts.sides), hugging];
    if form.light_cap {
        needed.push(run(Part::LightCap, false, &parts.light_cap));
        needed.push(run(Part::LightCap, true, &parts.light_cap_turned));
    }
    if !form.dark_cap {
        return needed;
    }
    match &parts.dark_cap {
        DarkCap::None => {
            let because = "a directional light's volume closes in one point at infinity";
            frame.leave_out(Decision::DarkCap, &caster.name, because);
        }
        DarkCap::Fan(triangles, _) => {
            needed.push(run(Part::DarkCap, false, triangles));
            let cap = parts.light_cap.len() + parts.light_cap_turned.len();
            if triangles.len() < cap {
                let because = format!(
                    "at infinity only its outline matters: {} triangles close what {cap} would",
                    triangles.len()
                );
                let inner = (cap - triangles.len()) as u64;
                frame.plan.left_out.push(LeftOut::counted(Decision::InnerDarkCap, inner, &caster.name, because));
            }
        }
        DarkCap::Carried(base) => {
            let carried = |part: NeededPart| NeededPart { base_vertex: *base, ..part };
            needed.push(carried(run(Part::DarkCap, true, &parts.light_cap)));
            needed.push(carried(run(Part::DarkCap, false, &parts.light_cap_turned)));
        }
    }
    needed
}
