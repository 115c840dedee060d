//! Shadow volumes counted in the stencil buffer: z-pass (Heidmann 1991), z-fail (Bilodeau, Carmack) and z-pass-plus
//! (Hornus and others 2005).
//!
//! Every caster's volume is drawn with depth and colour writes off. A volume face increments or decrements the count of
//! the pixels where it passes the depth test (z-pass: in front of the surface) or fails it (z-fail: behind it, with
//! caps so that volumes are closed there). What is left is the number of volumes that contain the surface; the light
//! pass skips pixels where it is not zero. Z-pass-plus starts z-pass from the count at the near plane instead of zero
//! ([`near_count`]).
//!
//! ```text
//! policy (same for all, or `auto`) ─► volumes_of: a VolumePlan for each caster ─► write_passes: draws, mask, light
//! ```
//!
//! Light caps are the surface's own triangles in its own vertex order, so that their depths are bit-equal and the
//! strict test is exact. Triangles that face away from the light count as flipped: they are not flipped in the buffer,
//! but drawn with front and back operations swapped. Sides that graze the surface that casts them are drawn a little
//! behind their place (`counting`).
//!
//! Where the casting triangles are chosen by topology, meshes are examined. Of closed surfaces, what can't show is not
//! drawn, nor in the light's pass what faces away from it (`shown`); and z-fail draws no volume of a caster behind
//! which nothing receives.

mod counting;
mod counting_purpose;
mod drawn;
mod extruded;
mod eye_count;
mod far_count;
mod near_count;

use super::casters::{self, DarkenedObjects};
use super::description::{ComparisonRole, ONE_ROW, TechniqueDescription};
use super::frame::{FrameBuilder, PlanRequest, StencilUse, SurfaceDrawing};
use super::lesson::{Lesson, cited};
use super::settings::{CasterRule, CountOperations, VolumeSettings};
use super::{Choice, PlanError, Technique, visible_triangles};
use crate::geometry::{Caster, Casters, Extrusion, GeometryCache, MOST_TO_SEARCH, SilhouetteBy};
use crate::plan::{
    CountBits, CountOf, CountedSide, DecidedBy, Decision, Draw, DrawMesh, DrawPart, FramePlan, LeftOut, LightId,
    MeshId, Visibility,
};
use crate::scene::Scene;
use counting::{CountedPart, FaceSelection};
pub use counting::{CountingMode, VolumeSpec};
use counting_purpose::{CountStart, CountingPurpose};
pub use drawn::VolumePlan;
use drawn::{CasterVolume, VolumeMesh};
use glam::DVec4;

/// Describes `z-pass` for commands, tables and the inspector.
pub(super) const Z_PASS: TechniqueDescription = TechniqueDescription {
    summary: "Counts the shadow volumes that the view ray is inside of when it reaches the surface, from the eye on.",
    lesson: Lesson {
        text: "Volume faces in front of the surface are counted, up when the view ray enters and down when it \
             leaves. Right unless the eye is inside a volume, or the near plane cuts one: then faces are missing, \
             and the count is off for every pixel behind.",
        formula: "count = front faces - back faces, of those that pass the depth test; light is added where it is 0",
        sources: &[cited::CROW, cited::HEIDMANN],
    },
    plan,
    report_rows: ONE_ROW,
    standing: ComparisonRole::Rival {
        place: 2,
        right_because: "the near plane cuts no volume, and the eye is in none",
        texels: None,
    },
};
/// Describes `z-fail` for commands, tables and the inspector.
pub(super) const Z_FAIL: TechniqueDescription = TechniqueDescription {
    summary: "Counts the same volumes from infinity back to the surface, so the eye may be inside one.",
    lesson: Lesson {
        text: "Faces behind the surface are counted, from infinity back, so volumes must be closed by caps at both \
             ends. Takes any mesh: open, self-intersecting, inconsistently wound. Every triangle is turned \
             towards the light by one exact sign, and each edge bounds the shadow as often as the turned \
             triangles around it do not cancel, so volumes always close. Light caps are drawn in the surface's \
             own vertex order, so that their depths are bit-equal to the surface's. Parallel lines of sight all end \
             at one point at infinity, so of an orthographic or oblique camera dark caps there are not drawn: the \
             count begins at the number of casting triangles that the light's own ray along them meets. Eight bits count to 255: \
             where a multiple of 256 volumes contain a surface it reads as lit, and `counter=float` counts on.",
        formula: "count = back faces - front faces, of those that fail the depth test; light is added where it is 0",
        sources: &[cited::BILODEAU, cited::CARMACK, cited::EVERITT_KILGARD],
    },
    // Also each way to count, cast and store depth that costs or saves something.
    report_rows: &[
        &[],
        &[("casters", "all")],
        &[("casters", "light-facing")],
        &[("extruded-by", "vertex-shader")],
        &[("faces", "two-pass")],
        &[("counter", "float")],
        &[("extrusion", "finite:100")],
        &[("depth", "standard-infinite")],
        &[("depth", "standard-finite")],
    ],
    standing: ComparisonRole::Rival {
        place: 1,
        right_because: "volumes are closed and counted from infinity, so neither eye nor near plane matters",
        texels: None,
    },
    ..Z_PASS
};
/// Describes `z-pass-plus` for commands, tables and the inspector.
pub(super) const Z_PASS_PLUS: TechniqueDescription = TechniqueDescription {
    summary: "Counts the near plane's volumes from the light first, then as z-pass: the eye may be inside one.",
    lesson: Lesson {
        text: "The near plane's own count is drawn first, seen from the light through the near plane; then it \
             counts as z-pass does. No caps, and the eye may be inside a volume. Cracks show where a caster \
             crosses the near plane, and rounding where that plane is nearer than a millimetre.",
        formula: "count = volumes that hold the pixel's point of the near plane + front faces - back faces, of those \
             that pass the depth test",
        sources: &[cited::HORNUS],
    },
    standing: ComparisonRole::Rival {
        place: 3,
        right_because: "what the near plane begins with is counted too, so the eye may be in a volume",
        texels: None,
    },
    ..Z_PASS
};

/// Decides how the shadow volumes of one light are counted: all alike, or each as `auto` finds cheapest.
pub trait VolumePolicy {
    /// Returns the counting mode that a light without any volume is described with.
    fn usual(&self) -> CountingMode;

    /// Returns whether the counting pass is kept in the plan where it would draw nothing.
    fn keeps_empty_pass(&self) -> bool {
        true
    }

    /// Returns a decision for each of these casters (indices into [`FrameBuilder::placed`]), in the same order.
    fn forms(&self, frame: &FrameBuilder, casters: &[usize]) -> Vec<VolumeDecision>;

    /// Returns, for each triangle of a caster, whether another part of the caster contains it in its umbra, so that it
    /// needs no volume, and the plan's record of that. Unless a policy overrides this: empty and `None`, all are
    /// needed.
    fn in_umbra_of_parts(&self, _frame: &mut FrameBuilder, _caster: usize) -> (Vec<bool>, Option<LeftOut>) {
        (Vec::new(), None)
    }

    /// Returns whether a count of these volumes could reach 256. A policy that counts in eight bits in any case never
    /// looks, and returns false.
    fn may_overflow(&self, _frame: &FrameBuilder, _volumes: &[VolumePlan]) -> bool {
        false
    }
}

/// A policy's decision about one caster's volume.
#[derive(Debug, Clone)]
pub struct VolumeDecision {
    /// How the volume is made and counted; `None` where the caster needs none.
    pub form: Option<VolumeSpec>,
    /// Records for the plan: the parts that are not needed, or why the whole volume is not.
    pub left_out: Vec<LeftOut>,
}

impl VolumeDecision {
    /// Returns the decision that a caster needs no volume, with the record that says why.
    pub fn nothing(left_out: LeftOut) -> VolumeDecision {
        VolumeDecision { form: None, left_out: vec![left_out] }
    }
}

/// The policy of z-pass, z-fail and z-pass-plus: counts every caster's volume in the same way.
struct UniformPolicy {
    light: LightId,
    counting: CountingMode,
    extrusion: Extrusion,
    /// Whether a caster behind which nothing receives gets no volume.
    only_what_darkens: bool,
}

impl VolumePolicy for UniformPolicy {
    fn usual(&self) -> CountingMode {
        self.counting
    }

    fn forms(&self, frame: &FrameBuilder, casters: &[usize]) -> Vec<VolumeDecision> {
        let UniformPolicy { light, counting, extrusion, only_what_darkens } = *self;
        let form = |caster: &usize| {
            let idle = only_what_darkens.then(|| casters::darkens_nothing(frame, *caster, light)).flatten();
            if let Some(left_out) = idle {
                return VolumeDecision::nothing(left_out);
            }
            let caster = frame.placed[*caster].object;
            // In z-pass the view ray enters the volume of an undrawn caster through its light cap.
            let light_cap = counting == CountingMode::Behind || !caster.visible;
            let because = "z-pass counts in front of surfaces, and a drawn caster's cap is never in front of itself";
            let left_out = (!light_cap).then(|| LeftOut::new(Decision::Caps, &caster.name, because));
            // A finite volume ends in front of whatever lies beyond it.
            let dark_cap = counting == CountingMode::Behind || extrusion != Extrusion::Infinite;
            let form = VolumeSpec { counting, extrusion, light_cap, dark_cap };
            VolumeDecision { form: Some(form), left_out: left_out.into_iter().collect() }
        };
        casters.iter().map(form).collect()
    }
}

/// Plans a frame with shadow volumes that are all counted one way: z-pass, z-fail or z-pass-plus, as the choice's
/// technique says. Fails too where its silhouette search would take minutes.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let counting = CountingMode::of(job.choice.technique());
    let settings = VolumeSettings::read(job.choice.settings());
    check(&settings, job.scene)?;
    let stencil = if settings.counts_in_float { StencilUse::ToLightOnce } else { StencilUse::Always };
    let mut frame = FrameBuilder::new(job, stencil)?;
    frame.clips_volumes = counting != CountingMode::Behind;
    // A mesh that is proven closed to choose its casting triangles also hides its own far side.
    let looks = settings.casters == CasterRule::ByTopology;
    if looks {
        visible_triangles::leave_out_hidden(&mut frame);
    }
    let extrusion = settings.extrusion;
    // Z-pass is wrong where the eye is in a volume, even in a floor's.
    let only_what_darkens = looks && counting == CountingMode::Behind && settings.volumes_count_right();
    let begin = |frame: &mut FrameBuilder, light| {
        frame.lit = looks.then(|| visible_triangles::lit_by(frame, light));
        Ok(UniformPolicy { light, counting, extrusion, only_what_darkens })
    };
    Ok(finish(frame, &settings, begin))
}

/// Fails for `silhouette = edge-list` where a casting object has so many triangles that the quadratic search would take
/// minutes, unless a vertex shader extrudes volumes.
fn check(settings: &VolumeSettings, scene: &Scene) -> Result<(), PlanError> {
    let searches = settings.silhouette == SilhouetteBy::Search && !extruded::can_serve(settings, scene);
    let too_large = |triangles: usize| searches && triangles > MOST_TO_SEARCH;
    let casting = scene.objects.iter().filter(|object| object.casts);
    match casting.map(|object| (object, object.mesh.triangles().len())).find(|(_, count)| too_large(*count)) {
        None => Ok(()),
        Some((object, count)) => Err(PlanError::Unusable {
            problem: format!(
                "silhouette = edge-list searches all edges for each one, and {} has {count} triangles: choose \
                 silhouette = adjacency, or a caster of at most {MOST_TO_SEARCH}",
                object.name
            ),
        }),
    }
}

/// Adds all passes of a frame with shadow volumes, and returns the plan. `begin` returns the policy for a light's
/// volumes, or why the light needs no passes at all.
pub fn finish<D: VolumePolicy>(
    mut frame: FrameBuilder,
    settings: &VolumeSettings,
    begin: impl Fn(&mut FrameBuilder, LightId) -> Result<D, &'static str>,
) -> FramePlan {
    frame.ambient_pass();
    let misses = frame.cut_to_ranges();
    for light in frame.light_ids() {
        let decides = match misses[light.0] {
            true => Err("its light ends before it reaches the view"),
            false => begin(&mut frame, light),
        };
        match decides {
            Ok(decides) => add_light(&mut frame, light, settings, &decides),
            Err(because) => {
                frame.leave_out(Decision::Light, light.name(), because);
                frame.mask_pass(light, &[SurfaceDrawing::lit()]);
            }
        }
    }
    frame.finish()
}

/// Makes the volumes of a light and adds them to the plan: meshes, records, and the passes that count them, label and
/// light.
fn add_light(frame: &mut FrameBuilder, light: LightId, settings: &VolumeSettings, decides: &impl VolumePolicy) {
    let LightVolumes { volumes, meshes, left_out } = volumes_of(frame, light, settings, decides);
    frame.plan.meshes.extend(meshes);
    frame.plan.left_out.extend(left_out);
    write_passes(frame, light, settings, decides, &volumes);
}

/// The volumes of one light, with their meshes and records, before they are added to the plan.
struct LightVolumes {
    volumes: Vec<VolumePlan>,
    /// The mesh of each volume; they are added to the plan after the meshes that it has.
    meshes: Vec<DrawMesh>,
    left_out: Vec<LeftOut>,
}

/// Returns every volume that a light needs, with its mesh and the records of what is left out; casters without
/// triangles get none. Nothing is added to the plan, but geometry is cached.
fn volumes_of(
    frame: &mut FrameBuilder,
    light: LightId,
    settings: &VolumeSettings,
    decides: &impl VolumePolicy,
) -> LightVolumes {
    let (by_vertex_shader, cannot) = extruded::serves(frame, light, settings);
    let mut all = LightVolumes { volumes: Vec::new(), meshes: Vec::new(), left_out: cannot.into_iter().collect() };
    let placed = frame.placed.iter().enumerate();
    let casting = placed.filter(|(_, placed)| placed.object.casts && !placed.object.mesh.triangles().is_empty());
    let casters: Vec<usize> = casting.map(|(index, _)| index).collect();
    let decisions = decides.forms(frame, &casters);
    debug_assert_eq!(decisions.len(), casters.len());
    for (index, VolumeDecision { form, left_out }) in casters.into_iter().zip(decisions) {
        all.left_out.extend(left_out);
        let Some(form) = form else { continue };
        let (casters, because) = casters_of(frame, light, index, settings, by_vertex_shader);
        let (mut hidden, because_hidden) = decides.in_umbra_of_parts(frame, index);
        let looks = looks_behind_holes(settings, casters, by_vertex_shader);
        match looks.then(|| casters::hidden_behind_no_hole(frame, light, index)).flatten() {
            Some((of_itself, because)) => {
                hidden.resize(of_itself.len(), false);
                hidden.iter_mut().zip(of_itself).for_each(|(is_hidden, of_itself)| *is_hidden |= of_itself);
                all.left_out.push(because);
            }
            None => all.left_out.extend(because),
        }
        all.left_out.extend(because_hidden);
        let of = CasterVolume { light, index, casters, hidden: &hidden, form };
        let made = match by_vertex_shader && hidden.is_empty() && !form.ends_on_plane() {
            true => Ok(extruded::make(frame, &of)),
            false => drawn::make(frame, &of, settings),
        };
        let VolumeMesh { mesh, casting, needed, begins_with, left_out } = match made {
            Ok(made) => made,
            Err(left_out) => {
                all.left_out.push(left_out);
                continue;
            }
        };
        all.left_out.extend(left_out);
        let is_drawn = |part: &CountedPart| match part.part {
            DrawPart::LightCap => settings.caps[0],
            DrawPart::DarkCap => settings.caps[1],
            DrawPart::Caps => settings.caps != [false; 2],
            _ => true,
        };
        let (needed, lacking): (Vec<_>, Vec<_>) =
            needed.into_iter().filter(|part| !part.triangles.is_empty()).partition(is_drawn);
        let lacks_caps =
            [DrawPart::LightCap, DrawPart::DarkCap].map(|cap| lacking.iter().any(|part| part.part.includes(cap)));
        let is_body = settings.casters == CasterRule::ByTopology && casters == Casters::LightFacing;
        all.volumes.push(VolumePlan {
            object: index,
            caster: frame.placed[index].object.name.clone(),
            counting: form.counting,
            is_body,
            is_wound_backwards: settings.keeps_mirrored_winding
                && frame.placed[index].object.pose.is_mirrored()
                && !frame.job.scene.camera.is_parallel(),
            darkens_nothing: !is_body && !casters::can_darken(frame, index, light, DarkenedObjects::All),
            mesh: MeshId(frame.plan.meshes.len() + all.meshes.len()),
            casting,
            needed,
            lacks_caps,
            begins_with,
        });
        all.meshes.push(mesh);
    }
    all
}

/// Adds the passes that count a light's volumes, then the mask and light passes that test the count. Counts in a float
/// target where the settings say so, or 255 could be exceeded and the policy looks at that.
fn write_passes(
    frame: &mut FrameBuilder,
    light: LightId,
    settings: &VolumeSettings,
    decides: &impl VolumePolicy,
    volumes: &[VolumePlan],
) {
    let may_overflow = decides.may_overflow(frame, volumes);
    if may_overflow {
        let because = "a ray of it may meet more than 255 casting triangles: a float counts them";
        frame.leave_out(Decision::EightBits, light.name(), because);
    }
    let in_float = settings.counts_in_float || may_overflow;
    let usual = decides.usual();
    let by = counted_by(volumes, usual);
    let side = by.map_or(CountedSide::AsNeeded, CountingMode::side);
    let of_light = &mut frame.plan.lights[light.0];
    of_light.decided_by = if in_float { DecidedBy::FloatCount { side } } else { DecidedBy::StencilCount { side } };
    of_light.count_of = what_counts(volumes);
    if in_float {
        frame.add_count(light);
        if settings.two_pass || settings.operations != CountOperations::Wrapping {
            let because = "a float target adds and takes away in one draw, and has no limits to stop at";
            frame.leave_out(Decision::TwoPasses, light.name(), because);
        }
    }
    if usual == CountingMode::InFrontPlus {
        near_count::pass(frame, light, settings, volumes);
    }
    let (begins_at, start) = begin(frame, light, settings, volumes);
    let camera = &frame.job.scene.camera;
    let counts = CountingPurpose {
        by,
        light,
        options: settings,
        start,
        chooses_side: frame.job.choice.technique() == Technique::Auto,
        place: camera.counting_place_name(),
        is_parallel: camera.is_parallel(),
        lacks: [0, 1].map(|cap| volumes.iter().any(|volume| volume.lacks_caps[cap])),
    };
    if in_float {
        count_in_float(frame, &counts, begins_at, volumes);
    } else {
        count_in_stencil(frame, &counts, begins_at, volumes, decides.keeps_empty_pass());
    }
}

/// Adds the passes that count volumes in the stencil, the first beginning at `begins_at`, then the mask and light
/// passes that test it. Passes without draws are left out, unless the count begins elsewhere or `keeps_empty_pass` is
/// true.
fn count_in_stencil(
    frame: &mut FrameBuilder,
    counts: &CountingPurpose,
    begins_at: u32,
    volumes: &[VolumePlan],
    keeps_empty_pass: bool,
) {
    let (light, settings) = (counts.light, counts.options);
    for (index, step) in FaceSelection::all(settings).iter().enumerate() {
        let draws: Vec<Draw> = volumes.iter().flat_map(|volume| volume.draws(settings, *step)).collect();
        if draws.is_empty() && begins_at == 0 && !keeps_empty_pass {
            frame.leave_out(Decision::VolumePass, light.name(), "no caster's volume is needed");
            continue;
        }
        let start = if index == 0 { begins_at as u8 & settings.mask() } else { 0 };
        frame.stencil_pass_from(start, light, step.name(), &counts.purpose(*step), draws);
    }
    let mask = settings.mask().into();
    frame.mask_pass(light, &[SurfaceDrawing::shadow(), SurfaceDrawing::lit().where_stencil(mask, 0)]);
    let in_bits = match CountBits::of_mask(mask) {
        CountBits::EIGHT => String::new(),
        bits => format!(" in {bits}"),
    };
    let (guard, drawing) = match settings.relights {
        false => {
            (", and raises the count there, so that no pixel is lit twice", SurfaceDrawing::light_once_where_zero(mask))
        }
        true => (
            ", and leaves it so: surfaces that lie in one plane are lit each",
            SurfaceDrawing::light_once_where_zero(mask).where_stencil(mask, 0),
        ),
    };
    let purpose = format!(
        "Adds the light where the count is zero{in_bits}{guard}. Everywhere else the surface is inside a shadow volume and \
         stays dark."
    );
    frame.light_pass(light, &purpose, &drawing);
}

/// Adds the pass that counts volumes in the light's float target, signed and without a limit, beginning at `begins_at`,
/// then the mask and light passes that test it.
fn count_in_float(frame: &mut FrameBuilder, counts: &CountingPurpose, begins_at: u32, volumes: &[VolumePlan]) {
    let (light, step) = (counts.light, FaceSelection::BothFaces);
    let draws = volumes.iter().flat_map(|volume| volume.float_draws(counts.options)).collect();
    frame.count_pass(begins_at, light, step.name(), &counts.purpose(step), draws);
    frame.mask_pass(light, &[SurfaceDrawing::lit_by(Visibility::Count)]);
    let purpose = "Adds the light where the count is zero. Everywhere else the surface is inside a shadow volume and \
                   stays dark.";
    frame.light_pass(light, purpose, &frame.light_by(Visibility::Count));
}

/// Returns the number that a light's count begins at, not masked to the stencil's bits, and the reason for the pass's
/// text. It is the number of volumes around the eye where the settings ask for that; else the volumes' own sum, with
/// `None` where the count's bits of it are 0.
fn begin(
    frame: &FrameBuilder,
    light: LightId,
    settings: &VolumeSettings,
    volumes: &[VolumePlan],
) -> (u32, Option<CountStart>) {
    let in_bits = |start: u32| if settings.counts_in_float { start } else { start & u32::from(settings.mask()) };
    if settings.starts_at_eye {
        let start = eye_count::at(frame, light, volumes);
        return (start, Some(CountStart::Eye(in_bits(start))));
    }
    let start = volumes.iter().map(|volume| volume.begins_with).sum();
    (start, Some(in_bits(start)).filter(|in_bits| *in_bits != 0).map(CountStart::FarEnd))
}

/// Returns whether a count of these volumes counts bodies, surfaces or both; surfaces that darken nothing don't matter,
/// unless all do. `None` if there are no volumes.
fn what_counts(volumes: &[VolumePlan]) -> Option<CountOf> {
    let bodies = volumes.iter().filter(|volume| volume.is_body).count();
    let others = volumes.iter().filter(|volume| !volume.is_body && !volume.darkens_nothing).count();
    // Where nothing is darkened at all, all that casts is counted.
    let all = if bodies + others == 0 { volumes.len() } else { bodies + others };
    match all {
        0 => None,
        all if bodies == all => Some(CountOf::Bodies),
        _ if bodies == 0 => Some(CountOf::Surfaces),
        _ => Some(CountOf::Mixed),
    }
}

/// Returns the counting mode that all of these volumes share, `usual` if there are none; `None` where they differ.
fn counted_by(volumes: &[VolumePlan], usual: CountingMode) -> Option<CountingMode> {
    let first = volumes.first().map_or(usual, |volume| volume.counting);
    volumes.iter().all(|volume| volume.counting == first).then_some(first)
}

/// Which triangles of a caster cast its shadow volume.
#[derive(Debug, Clone)]
pub struct CasterTriangles {
    /// By which side the light is on.
    pub casters: Casters,
    /// For each triangle, whether it does not cast though `casters` includes it; empty where all of those cast.
    pub hidden: Vec<bool>,
}

impl From<Casters> for CasterTriangles {
    /// All of these cast.
    fn from(casters: Casters) -> CasterTriangles {
        CasterTriangles { casters, hidden: Vec::new() }
    }
}

impl CasterTriangles {
    /// Returns whether this triangle casts, of which the light is on the front side or not.
    pub fn casts(&self, triangle: usize, faces_light: bool) -> bool {
        let is_included = match self.casters {
            Casters::LightFacing => faces_light,
            Casters::LightBackFacing => !faces_light,
            Casters::All => true,
        };
        is_included && !self.hidden.get(triangle).is_some_and(|is_hidden| *is_hidden)
    }
}

/// Returns which triangles of a caster cast its shadow volume with this choice; all of them for a technique without
/// volumes. By topology, only light-facing ones where these are proven to suffice for this light, and of a mesh with holes
/// those that it does not hide from the light itself. What `auto` leaves out besides, in another part's umbra, is included.
pub fn casting(
    choice: &Choice,
    scene: &Scene,
    cache: &mut GeometryCache,
    caster: Caster,
    light: DVec4,
) -> CasterTriangles {
    let Some(settings) = choice.volumes() else { return Casters::All.into() };
    let casters = match settings.casters {
        CasterRule::Always(casters) => casters,
        CasterRule::ByTopology if cache.light_facing_suffices(caster, light).is_ok() => Casters::LightFacing,
        CasterRule::ByTopology => Casters::All,
    };
    let looks = looks_behind_holes(&settings, casters, extruded::can_serve(&settings, scene));
    let hidden = looks.then(|| cache.hidden_behind_no_hole(caster, light)).flatten();
    CasterTriangles { casters, hidden: hidden.map_or_else(Vec::new, |(hidden, _)| hidden) }
}

/// Returns whether triangles that a mesh with holes hides from the light itself are left out of its volume.
fn looks_behind_holes(settings: &VolumeSettings, casters: Casters, by_vertex_shader: bool) -> bool {
    settings.casters == CasterRule::ByTopology && casters == Casters::All && !by_vertex_shader
}

/// Returns which triangles of the object `index` cast; for `casters = by-topology` also the plan's record of what was
/// proven or why not (no record where a vertex shader extrudes and it was proven).
fn casters_of(
    frame: &mut FrameBuilder,
    light: LightId,
    index: usize,
    options: &VolumeSettings,
    by_vertex_shader: bool,
) -> (Casters, Option<LeftOut>) {
    if let CasterRule::Always(casters) = options.casters {
        return (casters, None);
    }
    match casters::light_facing_suffices(frame, light, index) {
        // A vertex shader makes the others the dark cap.
        Ok(_) if by_vertex_shader => (Casters::LightFacing, None),
        Ok(proof) => (Casters::LightFacing, Some(proof)),
        Err(doubt) => (Casters::All, Some(doubt)),
    }
}
