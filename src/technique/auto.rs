//! Shadow volumes as cheap as they may be: `auto`.
//!
//! For each light and caster, in this order:
//!
//! ```text
//! nothing behind it that receives ─┐
//! its volume misses the view       ├─► no volume
//! another caster's umbra holds it ─┘
//! another part's umbra holds a part of it ───────────────► nothing of that part
//! it holds no point of the near rectangle in its shadow ─► z-pass, without caps, to beyond what is looked at
//! else ─► z-fail: a light cap if it is in view itself, a dark cap if its far end is
//! ```
//!
//! Then of each of z-pass's: it lies beyond what is looked at, or misses the view so far ─► no volume.
//!
//! Both kinds of counting leave the same number at every surface, so they share one stencil buffer. A
//! closed caster counts with the triangles that face the light alone. Where a count could reach 256, it
//! is kept in a float. Each decision is recorded, and each can be forbidden (`leave-out`): then what it
//! would have left out is drawn, and nothing must change but single pixels at a shadow's very edge, where other
//! triangles or other far corners draw that edge.

use super::casters;
use super::description::{ComparisonRole, TechniqueDescription};
use super::frame::{FrameBuilder, FrameObject, PlanRequest, StencilUse};
use super::lesson::{Lesson, cited};
use super::outside::{self, VIEW_PLANES, beyond};
use super::settings::VolumeSettings;
use super::volume::{CountingMode, VolumeDecision, VolumePlan, VolumePolicy, VolumeSpec};
use super::{PlanError, visible_triangles, volume};
use crate::geometry::umbra::{self, ConvexOccluder};
use crate::geometry::{
    ClampedEnd, Extruder, Extrusion, NearClipVolume, ViewVolume, layers, silhouette_bound, touching,
};
use crate::math::AxisBox;
use crate::numbers;
use crate::plan::{Decision, FramePlan, LeftOut, LightId};
use glam::{DVec3, DVec4};

/// Describes `auto` for commands, tables and the inspector.
pub(super) const DESCRIPTION: TechniqueDescription = TechniqueDescription {
    summary: "Counts each volume by z-pass or z-fail, whichever draws less while right, and leaves out what nothing needs.",
    lesson: Lesson {
        text: "The default. Each volume is counted by z-pass or by z-fail, whichever draws less while right, and \
             whatever can't change the picture is left out, and a volume that is counted in front ends, where it can, \
             just beyond the last surface in view; every decision is recorded with its reason in the \
             plan's text, in `manifest.json` and in the window. `stencilscope help leave-out` lists what it may \
             leave out. All that is saved is drawing: what it takes to decide is set-up, which `report` counts apart, and \
             which is paid anew where scene or eye move. Where a ray of the light may meet more than 255 casting triangles it counts in floats.",
        formula: "at a surface, front - back faces in front of it = back - front faces behind it: volumes are closed \
             and the eye is in none, so both kinds share one buffer; a volume that is counted in front may end, open, \
             beyond the last surface in view",
        sources: &[cited::EVERITT_KILGARD, cited::LENGYEL, cited::LLOYD, cited::MCGUIRE],
    },
    plan,
    // With everything that may be left out; also leaving out what occlusion queries show to be hidden; and with nothing
    // left out.
    report_rows: &[&[], &[("occlusion", "queries")], &[("leave-out", "none")]],
    standing: ComparisonRole::Rival {
        place: 0,
        right_because: "it counts like z-fail, leaves out what nothing needs, and beyond eight bits counts in a float",
        texels: None,
    },
};

/// The largest count that an 8-bit stencil buffer holds.
const MOST_IN_STENCIL: usize = 255;

/// Plans a frame in which each shadow volume is counted by z-pass or z-fail, whichever draws less while right, and what
/// provably changes no pixel is left out.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let settings = VolumeSettings::of_auto(&job.choice.common());
    let mut frame = FrameBuilder::new(job, StencilUse::Always)?;
    visible_triangles::leave_out_hidden(&mut frame);
    let begin = |frame: &mut FrameBuilder, light| {
        let lit = visible_triangles::lit_by(frame, light);
        if lit.is_empty() && frame.common.allows(Decision::Light) {
            return Err("every surface in view faces away from it or lies beyond its range");
        }
        frame.lit = Some(lit);
        Ok(AutoPolicy::new(frame, light))
    };
    Ok(volume::finish(frame, &settings, begin))
}

/// The policy of `auto` for one light: how each caster's volume is counted, from geometry that is computed once.
struct AutoPolicy {
    light: LightId,
    position: DVec4,
    view: ViewVolume,
    near_clip: NearClipVolume,
    /// World-space box around the eye and every drawn receiver within the light's range.
    looked_at: AxisBox,
    /// For each object, world-space points whose convex hull contains it; `boxes` has the boxes around them.
    outlines: Vec<Vec<DVec3>>,
    boxes: Vec<AxisBox>,
    /// For each object, itself as a convex occluder; `None` where it is not one, or umbras are not asked about.
    occluders: Vec<Option<ConvexOccluder>>,
}

/// Points whose convex hull contains a shadow volume; homogeneous, relative to the eye.
struct VolumeHull {
    /// First the points around the caster, then the same points carried away from the light.
    points: Vec<DVec4>,
}

impl VolumeHull {
    fn of(outline: &[DVec3], extruder: &Extruder, eye: DVec3) -> VolumeHull {
        let near = outline.iter().map(|point| relative(point.extend(1.0), eye));
        let far = outline.iter().map(|point| relative(extruder.carry(*point), eye));
        VolumeHull { points: near.chain(far).collect() }
    }

    fn near(&self) -> &[DVec4] {
        &self.points[..self.points.len() / 2]
    }

    fn far(&self) -> &[DVec4] {
        &self.points[self.points.len() / 2..]
    }
}

impl AutoPolicy {
    fn new(frame: &mut FrameBuilder, light: LightId) -> AutoPolicy {
        let position = frame.light_position(light);
        let view = frame.view_volume();
        let near_clip = view.near_clip(relative(position, frame.eye()));
        let outline = |placed: &FrameObject| outside::outline(&placed.world).into_owned();
        let outlines: Vec<Vec<DVec3>> = frame.placed.iter().map(outline).collect();
        let boxes: Vec<AxisBox> = outlines.iter().map(|points| AxisBox::around(points.iter().copied())).collect();
        let looked_at = looked_at(frame, light, &view, &boxes);
        let asks = frame.common.allows(Decision::Umbra);
        let (placed, cache) = (&frame.placed, &mut frame.job.cache);
        let mut occluder = |index: usize| {
            let placed = &placed[index];
            let mesh = &placed.object.mesh;
            let may = asks && placed.object.casts && mesh.triangles().len() <= ConvexOccluder::MOST_TRIANGLES;
            may.then(|| ConvexOccluder::new(&placed.world, mesh.triangles(), &cache.edges(mesh))).flatten()
        };
        let occluders = (0..placed.len()).map(&mut occluder).collect();
        AutoPolicy { light, position, view, near_clip, looked_at, outlines, boxes, occluders }
    }

    /// Returns the index of the first other object that is convex and whose umbra contains all of the box around the
    /// object `index`; `None` where there is none.
    fn umbra_caster(&self, index: usize) -> Option<usize> {
        let corners = self.boxes[index].corners();
        let holds = |occluder: &Option<ConvexOccluder>| {
            occluder.as_ref().is_some_and(|occluder| occluder.darkens_all(&corners, self.position))
        };
        (0..self.occluders.len()).find(|other| *other != index && holds(&self.occluders[*other]))
    }

    /// Returns points whose convex hull contains the volume of the caster `index` with this extrusion, relative to the
    /// eye.
    fn hull(&self, frame: &FrameBuilder, index: usize, extrusion: Extrusion) -> VolumeHull {
        let outline = &self.outlines[index];
        VolumeHull::of(outline, &Extruder::new(outline, self.position, extrusion), frame.eye())
    }

    /// Returns in words by how many metres a volume lies outside a plane of the view; `None` where it may reach into
    /// view.
    fn beside_view(&self, hull: &VolumeHull) -> Option<String> {
        self.view.outside(&hull.points).map(|outside| beyond(outside, VIEW_PLANES[outside.plane]))
    }

    /// Decides how the volume of the caster `index` is counted if it extends to infinity (z-pass, or z-fail with which
    /// caps); no volume, with the reason, where the caster can darken nothing, lies beyond the light's range or in
    /// another's umbra, or the volume lies outside the view. It leaves out only what the settings allow.
    fn without_end(&self, frame: &FrameBuilder, index: usize) -> VolumeDecision {
        let object = frame.placed[index].object;
        let allowed = |decision: Decision| frame.common.allows(decision);
        let left_out = |why: Decision, because: String| LeftOut::new(why, &object.name, because);
        let no_volume = |why: Decision, because: String| VolumeDecision::nothing(left_out(why, because));
        let light = self.light.name();
        if let Some(left_out) = casters::darkens_nothing(frame, index, self.light) {
            return VolumeDecision::nothing(left_out);
        }
        if allowed(Decision::Caster)
            && let Some(distance) = frame.beyond_range(self.light, index)
        {
            let because = format!("it lies {} beyond the range of {light}", numbers::metres(distance));
            return no_volume(Decision::Caster, because);
        }
        let extrusion = Extrusion::Infinite;
        let hull = self.hull(frame, index, extrusion);
        if allowed(Decision::View)
            && let Some(beside) = self.beside_view(&hull)
        {
            return no_volume(Decision::View, format!("it lies {beside}"));
        }
        if let Some(other) = self.umbra_caster(index) {
            let because = format!("{} holds all of it in its umbra", frame.placed[other].object.name);
            return no_volume(Decision::Umbra, because);
        }
        if let Some(outside) = self.near_clip.outside(hull.near()).filter(|_| allowed(Decision::Caps)) {
            let plane = self.near_clip.name(outside.plane);
            let because = format!("it lies {}: z-pass counts it", beyond(outside, plane));
            // A caster that is not drawn has no surface where its volume begins.
            let form =
                VolumeSpec { counting: CountingMode::InFront, extrusion, light_cap: !object.visible, dark_cap: false };
            return VolumeDecision { form: Some(form), left_out: vec![left_out(Decision::Caps, because)] };
        }
        let mut form = VolumeSpec { counting: CountingMode::Behind, extrusion, light_cap: true, dark_cap: true };
        let mut not_needed = Vec::new();
        if let Some(outside) = self.view.outside(hull.near()).filter(|_| allowed(Decision::LightCap)) {
            let because = format!("the caster lies {}", beyond(outside, VIEW_PLANES[outside.plane]));
            not_needed.push(left_out(Decision::LightCap, because));
            form.light_cap = false;
        }
        let directions: Vec<DVec3> = hull.far().iter().map(|point| point.truncate()).collect();
        let far_end = self.view.outside_at_infinity(&directions);
        if let Some(outside) = far_end.filter(|_| self.position.w != 0.0 && allowed(Decision::DarkCap)) {
            let because = format!("at infinity it lies outside {}", VIEW_PLANES[outside.plane]);
            not_needed.push(left_out(Decision::DarkCap, because));
            form.dark_cap = false;
        }
        VolumeDecision { form: Some(form), left_out: not_needed }
    }

    /// Ends volumes on a plane beyond the eye and all receivers in view. Volumes of casters that touch end on one
    /// plane, and only where all of them are counted in front of surfaces.
    fn end_volumes(&self, frame: &FrameBuilder, casters: &[usize], decided: &mut [VolumeDecision]) {
        let with_volume: Vec<usize> = (0..casters.len()).filter(|place| decided[*place].form.is_some()).collect();
        let caster = |place: &usize| (self.boxes[casters[*place]], &*frame.placed[casters[*place]].world);
        for group in touching(&with_volume.iter().map(caster).collect::<Vec<_>>(), frame.eye()) {
            let places: Vec<usize> = group.into_iter().map(|member| with_volume[member]).collect();
            let is_in_front = |form: VolumeSpec| form.counting == CountingMode::InFront;
            if !places.iter().all(|place| decided[*place].form.is_some_and(is_in_front)) {
                continue;
            }
            let boxes: Vec<AxisBox> = places.iter().map(|place| self.boxes[casters[*place]]).collect();
            if let Some(end) = ClampedEnd::beyond(self.looked_at, &boxes, self.position) {
                places.into_iter().for_each(|place| self.end_at(end, frame, casters[place], &mut decided[place]));
            }
        }
    }

    /// Changes `decided` so that the caster's volume ends at a plane; to no volume, with the reason, where the caster
    /// lies beyond the plane or the shortened volume outside the view.
    fn end_at(&self, end: ClampedEnd, frame: &FrameBuilder, index: usize, decided: &mut VolumeDecision) {
        let name = &frame.placed[index].object.name;
        let (axis, at) = end.place();
        let (axis, at) = (["x", "y", "z"][axis], numbers::signed_metres(at));
        let looked_at = format!(
            "the eye and all that shows and receives{} have a {} {axis}",
            match frame.reached(self.light) {
                Some(_) => format!(" within the range of {}", self.light.name()),
                None => String::new(),
            },
            if end.is_below() { "higher" } else { "lower" },
        );
        let allowed = |decision: Decision| frame.common.allows(decision);
        if allowed(Decision::Caster) && end.is_passed_by(self.boxes[index]) {
            let because = format!("it lies beyond {axis} = {at}: {looked_at}");
            *decided = VolumeDecision::nothing(LeftOut::new(Decision::Caster, name, because));
            return;
        }
        let extrusion = Extrusion::Clamped(end);
        if allowed(Decision::View)
            && let Some(beside) = self.beside_view(&self.hull(frame, index, extrusion))
        {
            let because = format!("it needs to reach to {axis} = {at}, as {looked_at}, and so far it lies {beside}");
            *decided = VolumeDecision::nothing(LeftOut::new(Decision::View, name, because));
            return;
        }
        let because = format!("it ends at {axis} = {at}: {looked_at}, so nothing beyond is counted");
        decided.left_out.push(LeftOut::new(Decision::BeyondReceivers, name, because));
        if let Some(form) = &mut decided.form {
            form.extrusion = extrusion;
        }
    }
}

/// Returns the world-space box around the eye, the near rectangle, and every drawn receiver within a light's range.
/// `boxes` has the box around each object.
fn looked_at(frame: &FrameBuilder, light: LightId, view: &ViewVolume, boxes: &[AxisBox]) -> AxisBox {
    let eye = frame.eye();
    let from = [eye].into_iter().chain(view.near_rectangle().map(|corner| eye + corner));
    let shown = frame.pieces.iter().map(|piece| piece.object);
    let receiving = shown.filter(|index| frame.placed[*index].object.receives);
    let receiving = receiving.fold(AxisBox::around([]), |all, index| all.joined(boxes[index]));
    let reached = frame.reached(light).map_or(receiving, |reach| receiving.common(reach));
    AxisBox::around(from).joined(reached)
}

impl VolumePolicy for AutoPolicy {
    fn usual(&self) -> CountingMode {
        CountingMode::Behind
    }

    fn keeps_empty_pass(&self) -> bool {
        false
    }

    fn forms(&self, frame: &FrameBuilder, casters: &[usize]) -> Vec<VolumeDecision> {
        let mut decided: Vec<VolumeDecision> = casters.iter().map(|index| self.without_end(frame, *index)).collect();
        if frame.common.allows(Decision::BeyondReceivers) {
            self.end_volumes(frame, casters, &mut decided);
        }
        decided
    }

    fn in_umbra_of_parts(&self, frame: &mut FrameBuilder, index: usize) -> (Vec<bool>, Option<LeftOut>) {
        if !frame.common.allows(Decision::Umbra) {
            return (Vec::new(), None);
        }
        let placed = &frame.placed[index];
        let mesh = &placed.object.mesh;
        let connectivity = frame.job.cache.connectivity(mesh);
        let in_umbra = umbra::in_umbra_of_parts(&placed.world, mesh.triangles(), &connectivity, self.position);
        let count = in_umbra.iter().filter(|is_in_umbra| **is_in_umbra).count() as u64;
        let because = "another part of it holds them in its umbra";
        let left_out = LeftOut::counted(Decision::Umbra, count, &placed.object.name, because);
        let is_needed = !in_umbra.is_empty();
        (in_umbra, is_needed.then_some(left_out))
    }

    fn may_overflow(&self, frame: &FrameBuilder, volumes: &[VolumePlan]) -> bool {
        let boxes: Vec<AxisBox> = volumes.iter().map(|volume| self.boxes[volume.object]).collect();
        let silhouettes: Option<Vec<_>> = volumes.iter().map(|volume| volume.silhouette(frame)).collect();
        let is_within = silhouettes.is_some_and(|silhouettes| {
            silhouette_bound::is_within(silhouettes.into_iter().flatten(), &boxes, self.position, MOST_IN_STENCIL)
        });
        let casting = || volumes.iter().map(|volume| volume.casting_triangles(frame, self.position));
        !is_within && layers::may_exceed(casting(), self.position, MOST_IN_STENCIL)
    }
}

fn relative(position: DVec4, eye: DVec3) -> DVec4 {
    (position.truncate() - eye * position.w).extend(position.w)
}
