//! Shadow volumes as cheap as they may be: `auto`.
//!
//! For each light and caster, in this order:
//!
//! ```text
//! nothing behind it that receives ─┐
//! its volume misses the view       ├─► no volume
//! another caster's umbra holds it ─┘
//! another part's umbra holds a part of it ───────────────► nothing of that part
//! it holds no point of the near rectangle in its shadow ─► z-pass, without caps, to beyond all that receives
//! else ─► z-fail: a light cap if it is in view itself, a dark cap if its far end is
//! ```
//!
//! Both kinds of counting leave the same number at every surface, so they share one stencil buffer. A
//! closed caster counts with the triangles that face the light alone. Where a count could reach 256, it
//! is kept in a float. Each decision is recorded, and each can be forbidden (`leave-out`): then what it
//! would have left out is drawn, and nothing must change.

use super::casters::{self, Darkened};
use super::description::{Description, Standing};
use super::frame::{Frame, Job, Placed, StencilUse};
use super::lesson::{Lesson, cited};
use super::outside::{self, VIEW_PLANES, beyond};
use super::settings::VolumeSettings;
use super::volume::{Counting, Decides, Form};
use super::{PlanError, shown, volume};
use crate::geometry::umbra::{self, Occluder};
use crate::geometry::{ClampedEnd, Extrusion, NearClipVolume, ViewVolume, layers};
use crate::math::AxisBox;
use crate::numbers;
use crate::plan::{Decision, FramePlan, LeftOut, LightId};
use glam::{DVec3, DVec4};

/// What is said of it.
pub(super) const DESCRIPTION: Description = Description {
    summary: "Counts each volume by z-pass or z-fail, whichever is cheaper while right, and leaves out what nothing needs.",
    lesson: Lesson {
        text: "The default. Each volume is counted by z-pass or by z-fail, whichever is cheaper while right, and \
             whatever can't change the picture is left out; every decision is recorded with its reason in the \
             plan's text, in `manifest.json` and in the window. `stencilscope help leave-out` lists what it may \
             leave out. Where a ray of the light may meet more than 255 casting triangles it counts in floats.",
        formula: "at a surface, front - back faces in front of it = back - front faces behind it: volumes are closed \
             and the eye is in none, so both kinds share one buffer",
        sources: &[cited::EVERITT_KILGARD, cited::LENGYEL, cited::MCGUIRE],
    },
    plan,
    // With all that may be left out, without what a look at the frame shows to be hidden, and with nothing
    // left out.
    report_rows: &[&[], &[("occlusion", "queries")], &[("leave-out", "none")]],
    standing: Standing::Rival {
        place: 0,
        right_because: "it counts like z-fail, leaves out what nothing needs, and beyond eight bits counts in a float",
        texels: None,
    },
};

/// What eight bits hold.
const MOST_IN_STENCIL: usize = 255;

/// Plans a frame of volumes that each have the form they need.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    let settings = VolumeSettings::of_auto(&job.choice.common());
    let mut frame = Frame::new(job, StencilUse::Always)?;
    shown::leave_out_hidden(&mut frame);
    let begin = |frame: &mut Frame, light| {
        let lit = shown::lit_by(frame, light);
        if lit.is_empty() && frame.common.allows(Decision::Light) {
            return Err("every surface in view faces away from it or lies beyond its range");
        }
        frame.lit = Some(lit);
        Ok(Questions::new(frame, light))
    };
    Ok(volume::finish(frame, &settings, begin))
}

/// What a light's volumes are asked about.
struct Questions {
    light: LightId,
    position: DVec4,
    view: ViewVolume,
    near_clip: NearClipVolume,
    /// Around the eye and all that shows and receives, within the light's range.
    looked_at: AxisBox,
    /// By object: what may hold others in its umbra.
    occluders: Vec<Option<Occluder>>,
}

impl Questions {
    fn new(frame: &mut Frame, light: LightId) -> Questions {
        let position = frame.light_position(light);
        let [width, height] = frame.job.size.map(f64::from);
        let view = ViewVolume::new(&frame.job.scene.camera, width / height);
        let near_clip = view.near_clip(relative(position, frame.eye()));
        let looked_at = looked_at(frame, light, &view);
        let asks = frame.common.allows(Decision::Umbra);
        let (placed, cache) = (&frame.placed, &mut frame.job.cache);
        let mut occluder = |index: usize| {
            let placed = &placed[index];
            let mesh = &placed.object.mesh;
            let may = asks && placed.object.casts && mesh.triangles().len() <= Occluder::MOST_TRIANGLES;
            may.then(|| Occluder::new(&placed.world, mesh.triangles(), &cache.edges(mesh))).flatten()
        };
        let occluders = (0..placed.len()).map(&mut occluder).collect();
        Questions { light, position, view, near_clip, looked_at, occluders }
    }

    /// A caster whose umbra holds all of another.
    fn holder(&self, frame: &Frame, index: usize) -> Option<usize> {
        let world = &frame.placed[index].world;
        let corners = AxisBox::around(world.iter().copied()).corners();
        let holds = |occluder: &Option<Occluder>| {
            occluder.as_ref().is_some_and(|occluder| occluder.darkens_all(&corners, self.position))
        };
        (0..self.occluders.len()).find(|other| *other != index && holds(&self.occluders[*other]))
    }

    /// How far a volume must reach that is counted in front of surfaces.
    fn extrusion(&self, frame: &mut Frame, index: usize) -> Extrusion {
        if !frame.common.allows(Decision::BeyondReceivers) {
            return Extrusion::Infinite;
        }
        let placed = &frame.placed[index];
        let (object, caster) = (placed.object, AxisBox::around(placed.world.iter().copied()));
        let Some(end) = ClampedEnd::beyond(self.looked_at, caster, self.position) else { return Extrusion::Infinite };
        let (axis, at) = end.place();
        let axis = ["x", "y", "z"][axis];
        let because = format!(
            "it ends at {axis} = {}: the eye and all that shows and receives have a {} {axis}, so nothing beyond is counted",
            numbers::metres(at),
            if end.is_below() { "higher" } else { "lower" },
        );
        frame.leave_out(Decision::BeyondReceivers, &object.name, because);
        Extrusion::Clamped(end)
    }
}

/// The box around the eye, the near rectangle, and all that shows, receives and is within a light's range.
fn looked_at(frame: &Frame, light: LightId, view: &ViewVolume) -> AxisBox {
    let eye = frame.eye();
    let from = [eye].into_iter().chain(view.near_rectangle().map(|corner| eye + corner));
    let shows = |index: usize| frame.pieces.iter().any(|piece| piece.object == index);
    let receives = |(index, placed): &(usize, &Placed)| placed.object.receives && shows(*index);
    let receiving = frame.placed.iter().enumerate().filter(receives);
    let receiving = AxisBox::around(receiving.flat_map(|(_, placed)| placed.world.iter().copied()));
    let reached = match frame.reached(light) {
        Some(reach) => receiving.common(reach),
        None => receiving,
    };
    let is_empty = reached.low.cmpgt(reached.high).any();
    let corners = (!is_empty).then(|| reached.corners());
    AxisBox::around(from.chain(corners.into_iter().flatten()))
}

impl Decides for Questions {
    fn usual(&self) -> Counting {
        Counting::Behind
    }

    fn keeps_empty_pass(&self) -> bool {
        false
    }

    fn form(&self, frame: &mut Frame, index: usize) -> Result<Form, LeftOut> {
        let object = frame.placed[index].object;
        let common = frame.common;
        let allowed = |decision: Decision| common.allows(decision);
        let no_volume = |why: Decision, because: String| Err(LeftOut::new(why, &object.name, because));
        if allowed(Decision::Caster) && !casters::can_darken(frame, index, self.light, Darkened::All) {
            let light = self.light.name();
            return no_volume(
                Decision::Caster,
                format!("all that receives lies on the side of {light}, or in its plane"),
            );
        }
        if allowed(Decision::Caster)
            && let Some(distance) = frame.beyond_range(self.light, index)
        {
            let light = self.light.name();
            return no_volume(
                Decision::Caster,
                format!("it lies {} beyond the range of {light}", numbers::metres(distance)),
            );
        }
        let eye = frame.eye();
        let near: Vec<DVec4> =
            outside::outline(&frame.placed[index].world).map(|point| (point - eye).extend(1.0)).collect();
        let light = relative(self.position, eye);
        let carried = |point: &DVec4| (point.truncate() * light.w - light.truncate()).extend(0.0);
        let far: Vec<DVec4> = near.iter().map(carried).collect();
        let whole: Vec<DVec4> = near.iter().chain(&far).copied().collect();
        if allowed(Decision::View)
            && let Some(outside) = self.view.outside(&whole)
        {
            return no_volume(Decision::View, format!("it lies {}", beyond(outside, VIEW_PLANES[outside.plane])));
        }
        if let Some(other) = self.holder(frame, index) {
            return no_volume(
                Decision::Umbra,
                format!("{} holds all of it in its umbra", frame.placed[other].object.name),
            );
        }
        if let Some(outside) = self.near_clip.outside(&near).filter(|_| allowed(Decision::Caps)) {
            let plane = format!("plane {} of the near-clip volume", outside.plane + 1);
            let because = format!("it lies {}: z-pass counts it", beyond(outside, &plane));
            frame.leave_out(Decision::Caps, &object.name, because);
            // What is not drawn has no surface where its volume begins.
            let extrusion = self.extrusion(frame, index);
            return Ok(Form { counting: Counting::InFront, extrusion, light_cap: !object.visible, dark_cap: false });
        }
        let extrusion = Extrusion::Infinite;
        let mut form = Form { counting: Counting::Behind, extrusion, light_cap: true, dark_cap: true };
        if let Some(outside) = self.view.outside(&near).filter(|_| allowed(Decision::LightCap)) {
            let because = format!("the caster lies {}", beyond(outside, VIEW_PLANES[outside.plane]));
            frame.leave_out(Decision::LightCap, &object.name, because);
            form.light_cap = false;
        }
        let directions: Vec<DVec3> = far.iter().map(|point| point.truncate()).collect();
        let far_end = self.view.outside_at_infinity(&directions);
        if let Some(outside) = far_end.filter(|_| light.w != 0.0 && allowed(Decision::DarkCap)) {
            let because = format!("at infinity it lies outside {}", VIEW_PLANES[outside.plane]);
            frame.leave_out(Decision::DarkCap, &object.name, because);
            form.dark_cap = false;
        }
        Ok(form)
    }

    fn held_by_parts(&self, frame: &mut Frame, index: usize) -> Vec<bool> {
        if !frame.common.allows(Decision::Umbra) {
            return Vec::new();
        }
        let placed = &frame.placed[index];
        let mesh = &placed.object.mesh;
        let connectivity = frame.job.cache.connectivity(mesh);
        let held = umbra::held_by_parts(&placed.world, mesh.triangles(), &connectivity, self.position);
        if !held.is_empty() {
            let count = held.iter().filter(|is_held| **is_held).count();
            let because = "another part of it holds them in its umbra";
            frame.plan.left_out.push(LeftOut::counted(Decision::Umbra, count as u64, &placed.object.name, because));
        }
        held
    }

    fn may_overflow(&self, casting: &mut dyn Iterator<Item = [DVec3; 3]>) -> bool {
        layers::may_exceed(casting.collect(), self.position, MOST_IN_STENCIL)
    }
}

fn relative(position: DVec4, eye: DVec3) -> DVec4 {
    (position.truncate() - eye * position.w).extend(position.w)
}
