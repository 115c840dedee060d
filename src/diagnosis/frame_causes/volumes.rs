//! What is wrong with the shadow volumes of another program's frame, by the states and the triangles of the draws that
//! count them.

use super::{FrameFinding, FrameRule, RecordedLight};
use crate::diagnosis::Cause;
use crate::diagnosis::evidence::{Evidence, Quantity};
use crate::diagnosis::eye_count::missed_at_eye;
use crate::numbers;
use crate::plan::{Blob, Draw, DrawMesh, FramePlan, MeshId, Pass, RasterState};
use crate::recorded::{
    OpenEdges, PassSpace, UncastTriangles, asked_volumes, far_ends, uncast_triangles, volumes_with_lights,
};
use glam::{DVec3, DVec4};
use wgpu_types::{Face, FrontFace, StencilOperation as Operation};

/// The rules for the causes that can be seen in the raster states and the triangles of shadow volumes.
pub(super) const RULES: [FrameRule; 12] = [
    FrameRule {
        cause: Cause::FarClip,
        meaning: Some(
            "The far plane cuts shadow volumes away that z-fail counts. Use a projection to infinity, or depth \
             clamping (GL_DEPTH_CLAMP, depthClampEnable) for the volumes.",
        ),
        includes: &[],
        look: |light| light.clipped(true),
    },
    FrameRule {
        cause: Cause::NearPlaneCut,
        meaning: Some(
            "The near plane cuts shadow volumes open that z-pass counts. Count from behind with z-fail and closed \
             volumes; depth clamping saves what lies in front of the eye.",
        ),
        includes: &[],
        look: |light| light.clipped(false),
    },
    FrameRule {
        cause: Cause::FiniteExtrusion,
        meaning: Some("The shadow volumes end before they reach the surface. Extrude them to infinity (w = 0)."),
        includes: &[Cause::FarClip, Cause::NearPlaneCut],
        look: |light| light.finite(),
    },
    FrameRule { cause: Cause::FaceCulled, meaning: None, includes: &[], look: |light| light.culled() },
    FrameRule {
        cause: Cause::Clamped,
        meaning: Some(
            "The stencil operations stop at 0 and 255. Use those that wrap (GL_INCR_WRAP, INCREMENT_AND_WRAP): \
             then the order of faces does not matter.",
        ),
        includes: &[],
        look: |light| light.clamped(),
    },
    FrameRule { cause: Cause::VolumesWriteDepth, meaning: None, includes: &[], look: |light| light.writes_depth() },
    FrameRule { cause: Cause::StencilNotCleared, meaning: None, includes: &[], look: |light| light.not_cleared() },
    FrameRule { cause: Cause::StencilMask, meaning: None, includes: &[], look: |light| light.mask_hides() },
    FrameRule {
        cause: Cause::CapFighting,
        meaning: Some(
            "A volume's cap lies on the surface that throws the shadow. Z-fail must count it: let only nearer \
             fragments pass the depth test of the volumes (less, not less or equal), and move them back by some steps of \
             depth (glPolygonOffset, depthBias) where their shader or their corners are not the surface's own.",
        ),
        includes: &[],
        look: |light| light.equal_depth_passes().or_else(|| light.caps_round_apart()),
    },
    FrameRule { cause: Cause::OpenVolume, meaning: None, includes: &[], look: |light| light.open() },
    FrameRule { cause: Cause::EyeInVolume, meaning: None, includes: &[], look: |light| light.around_eye() },
    FrameRule {
        cause: Cause::OpenMesh,
        meaning: Some(
            "The mesh has holes, and its volumes are of the triangles on one side alone: of those that face the light, or of \
             those that face away from it. Light goes through the others. Draw volumes of both, or close the mesh.",
        ),
        includes: &[],
        look: |light| light.one_sided(),
    },
];

/// How many steps of depth a volume is moved away from the eye, so that what rounds apart does not matter.
const AWAY: i32 = 16;

fn counts(operation: Operation) -> bool {
    use Operation::{DecrementClamp, DecrementWrap, IncrementClamp, IncrementWrap};
    matches!(operation, IncrementClamp | IncrementWrap | DecrementClamp | DecrementWrap)
}

/// Returns two flags: whether a raster state counts in the stencil behind the surface (on depth failure), and whether
/// it does in front of it (on pass), for front or back faces.
fn sides(raster: &RasterState) -> [bool; 2] {
    let faces = [&raster.stencil.front, &raster.stencil.back];
    [faces.iter().any(|face| counts(face.depth_fail_op)), faces.iter().any(|face| counts(face.pass_op))]
}

impl RecordedLight<'_> {
    fn is_of_light(&self, pass: &Pass) -> bool {
        pass.light == Some(self.light) && self.plan.is_of_picture(pass)
    }

    fn draws(&self) -> impl Iterator<Item = (&Pass, &Draw)> {
        let passes = self.plan.passes.iter().filter(|pass| self.is_of_light(pass));
        passes
            .flat_map(|pass| pass.draws.iter().map(move |draw| (pass, draw)))
            .filter(|(_, draw)| draw.part.is_of_volume())
    }

    /// Returns the plan with the raster states of the counting draws changed.
    fn with_states(&self, change: impl Fn(&mut RasterState)) -> FramePlan {
        let mut plan = self.plan.clone();
        for pass in plan.passes.iter_mut().filter(|pass| pass.light == Some(self.light)) {
            pass.draws.iter_mut().filter(|draw| draw.part.is_of_volume()).for_each(|draw| change(&mut draw.raster));
        }
        plan
    }

    fn clipped(&self, is_far: bool) -> Option<FrameFinding> {
        // Counted behind the surface, cuts at the far end lose faces; counted in front of it, those at the near end.
        let is_meant = |raster: &RasterState| sides(raster)[usize::from(!is_far)] && !raster.unclipped_depth;
        let is_reversed = self.plan.depth.mapping.is_reversed();
        let is_cut = |[_, _, z, w]: &[f32; 4]| if is_far != is_reversed { z > w } else { *z < 0.0 };
        let draws: Vec<&Draw> = self.draws().map(|(_, draw)| draw).filter(|draw| is_meant(&draw.raster)).collect();
        let of_draw =
            |draw: &&Draw| self.plan.meshes[draw.mesh.0].vertices.data().iter().filter(|at| is_cut(at)).count();
        let cut: usize = draws.iter().map(of_draw).sum();
        if cut == 0 {
            return None;
        }
        let plane = if is_far { "far" } else { "near" };
        let sentence = format!(
            "{} corners of the volumes lie beyond the {plane} plane, and depth clamping is off",
            numbers::count(cut as u64)
        );
        let unclipped = |raster: &mut RasterState| raster.unclipped_depth |= is_meant(raster);
        let corners = Quantity::at_least("corners of volumes beyond the plane", cut as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, corners), fixed: self.with_states(unclipped) })
    }

    /// Looks for volumes around the eye that are counted in front of the surface; returns the evidence and a plan whose
    /// count begins with them. `None` where there are none, or where what the count begins with is not one number.
    fn around_eye(&self) -> Option<FrameFinding> {
        let draws: Vec<&Draw> =
            self.draws().map(|(_, draw)| draw).filter(|draw| sides(&draw.raster) == [false, true]).collect();
        let missed = missed_at_eye(self.plan, &draws);
        let first = self
            .plan
            .passes
            .iter()
            .position(|pass| self.is_of_light(pass) && pass.draws.iter().any(|draw| draw.part.is_of_volume()))?;
        let before = self.plan.passes[..=first].iter().rev().filter(|pass| self.plan.is_of_picture(pass));
        let cleared = before.filter_map(|pass| pass.depth_stencil.as_ref()?.clear_stencil).next()?;
        if missed == 0 {
            return None;
        }
        let mut plan = self.plan.clone();
        plan.passes[first].depth_stencil.as_mut()?.clear_stencil = Some(cleared.wrapping_add(missed as u8));
        let volumes = u64::from(missed.unsigned_abs());
        let sentence = format!(
            "the eye is in {} that {} counted in front of the surface",
            numbers::counted(volumes, "volume"),
            if volumes == 1 { "is" } else { "are" }
        );
        let volumes = Quantity::at_least("volumes around the eye", volumes as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, volumes), fixed: plan })
    }

    fn finite(&self) -> Option<FrameFinding> {
        let mut plan = self.with_states(|raster| raster.unclipped_depth = true);
        let (mut moved, mut all) = (0, 0);
        for (pass, draw, position) in volumes_with_lights(self.plan, self.scene, self.light) {
            let space = PassSpace::new(self.plan, pass);
            let places = space.places(self.plan, draw);
            if places.iter().flatten().any(|place| place.w == 0.0) {
                return None;
            }
            let far = far_ends(&places, position);
            all += places.len();
            moved += far.iter().filter(|far| **far).count();
            let mut vertices = self.plan.meshes[draw.mesh.0].vertices.data().to_vec();
            for ((vertex, place), _) in vertices.iter_mut().zip(&places).zip(&far).filter(|(_, far)| **far) {
                let Some(place) = place else { continue };
                let away = place.truncate() * position.w - position.truncate();
                *vertex = space.clip(away.extend(0.0));
            }
            plan.meshes[draw.mesh.0].vertices = Blob::new(vertices);
        }
        if moved == 0 {
            return None;
        }
        let far_ends = Quantity::at_least("corners that are a far end at a finite distance", moved as f64, 1.0);
        let [moved, all] = [moved, all].map(|count| numbers::count(count as u64));
        let sentence =
            format!("no corner of the volumes is at infinity: {moved} of {all} are a far end at a finite distance");
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, far_ends), fixed: plan })
    }

    fn culled(&self) -> Option<FrameFinding> {
        let is_one_sided = |raster: &RasterState| {
            let ops = |face: &crate::plan::StencilFace| [face.depth_fail_op, face.pass_op].into_iter().any(counts);
            raster.cull.is_some() && ops(&raster.stencil.front) && ops(&raster.stencil.back)
        };
        let culled = self.draws().filter(|(_, draw)| is_one_sided(&draw.raster)).count();
        // Volumes that are drawn once for each side are whole.
        let sides: Vec<_> = self.draws().filter_map(|(_, draw)| draw.raster.cull).collect();
        let is_whole = sides.contains(&Face::Front) && sides.contains(&Face::Back);
        if culled == 0 || is_whole {
            return None;
        }
        let sentence = format!("{culled} draws of volumes count on both faces, and cull one of them");
        let draws = Quantity::at_least("draws that cull a face that counts", culled as f64, 1.0);
        let fixed = self.with_states(|raster| raster.cull = None);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, draws), fixed })
    }

    fn clamped(&self) -> Option<FrameFinding> {
        let wrapped = |operation: &mut Operation| {
            *operation = match *operation {
                Operation::IncrementClamp => Operation::IncrementWrap,
                Operation::DecrementClamp => Operation::DecrementWrap,
                other => other,
            }
        };
        let is_clamped =
            |operation: Operation| matches!(operation, Operation::IncrementClamp | Operation::DecrementClamp);
        let clamps = |raster: &RasterState| {
            let faces = [&raster.stencil.front, &raster.stencil.back];
            faces.iter().any(|face| is_clamped(face.depth_fail_op) || is_clamped(face.pass_op))
        };
        let draws = self.draws().filter(|(_, draw)| clamps(&draw.raster)).count();
        if draws == 0 {
            return None;
        }
        let plan = self.with_states(|raster| {
            for face in [&mut raster.stencil.front, &mut raster.stencil.back] {
                wrapped(&mut face.depth_fail_op);
                wrapped(&mut face.pass_op);
            }
        });
        let sentence = format!("{draws} draws of volumes count with operations that stop");
        let draws = Quantity::at_least("draws whose operations stop", draws as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, draws), fixed: plan })
    }

    fn writes_depth(&self) -> Option<FrameFinding> {
        let draws = self.draws().filter(|(_, draw)| draw.raster.depth_write).count();
        (draws > 0).then(|| {
            let writing = Quantity::at_least("draws of volumes that write depth", draws as f64, 1.0);
            let evidence = Evidence::of_frame(format!("{draws} draws of volumes write depth"), writing);
            FrameFinding { evidence, fixed: self.with_states(|raster| raster.depth_write = false) }
        })
    }

    fn not_cleared(&self) -> Option<FrameFinding> {
        let index = self.plan.passes.iter().position(|pass| self.is_of_light(pass))?;
        let upto = self.plan.passes.iter().take(index + 1).filter(|pass| self.plan.is_of_picture(pass));
        let is_cleared = |pass: &Pass| pass.depth_stencil.as_ref().is_some_and(|target| target.clear_stencil.is_some());
        let counts_before = |pass: &Pass| pass.draws.iter().any(|draw| draw.raster.writes_stencil());
        let (mut is_clean, mut holds, mut before) = (false, 0, 0);
        for pass in upto {
            let start = pass.recorded.as_ref().and_then(|recorded| recorded.start.as_ref()?.stencil.as_ref());
            if let Some(start) = start {
                holds = start.data().iter().filter(|value| **value != 0).count();
                is_clean = holds == 0;
            }
            if is_cleared(pass) {
                (is_clean, holds, before) = (true, 0, 0);
            }
            if counts_before(pass) && !self.is_of_light(pass) {
                is_clean = false;
                before += pass.draws.iter().filter(|draw| draw.raster.writes_stencil()).count();
            }
        }
        if is_clean {
            return None;
        }
        let mut plan = self.plan.clone();
        let pass = &mut plan.passes[index];
        if let Some(recorded) = &mut pass.recorded {
            recorded.start.iter_mut().for_each(|start| start.stencil = None);
        }
        pass.depth_stencil.iter_mut().for_each(|target| target.clear_stencil = Some(0));
        let sentence = format!(
            "nothing clears the stencil before the light's volumes; {} pixels held another value than 0 as the frame began",
            numbers::count(holds as u64)
        );
        let left = Quantity::at_least(
            "pixels that held another value than 0, and draws that wrote the stencil before",
            (holds + before) as f64,
            1.0,
        );
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, left), fixed: plan })
    }

    fn mask_hides(&self) -> Option<FrameFinding> {
        let written = self.draws().fold(0, |all, (_, draw)| {
            [true, false].iter().fold(all, |all, is_front| all | draw.raster.face(*is_front).1.write)
        });
        let asks = |draw: &Draw| draw.raster.stencil.is_enabled() && !draw.part.is_of_volume();
        let passes = || self.plan.passes.iter().filter(|pass| self.is_of_light(pass));
        let asking = passes().flat_map(|pass| &pass.draws).find(|draw| asks(draw))?;
        let read = asking.raster.face(true).1.read;
        if written & !read == 0 {
            return None;
        }
        let mut plan = self.plan.clone();
        for pass in plan.passes.iter_mut().filter(|pass| pass.light == Some(self.light)) {
            for draw in pass.draws.iter_mut().filter(|draw| asks(draw)) {
                draw.raster.stencil.read_mask = 0xff;
                draw.raster.back = None;
            }
        }
        let sentence = format!("volumes count in the bits {written:#04x}, and the light's test compares {read:#04x}");
        let hidden = f64::from((written & !read).count_ones());
        let bits = Quantity::at_least("bits that are counted in and not compared", hidden, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, bits), fixed: plan })
    }

    /// Looks for volume draws that count behind the surface with a less-or-equal or greater-or-equal depth test, so
    /// that equal depth passes; returns the evidence and the plan with the strict test in them. `None` where there is
    /// none.
    fn equal_depth_passes(&self) -> Option<FrameFinding> {
        use wgpu_types::CompareFunction::{Greater, GreaterEqual, Less, LessEqual};
        let is_meant =
            |raster: &RasterState| sides(raster)[0] && matches!(raster.depth_compare, LessEqual | GreaterEqual);
        let draws = self.draws().filter(|(_, draw)| is_meant(&draw.raster)).count();
        if draws == 0 {
            return None;
        }
        let plan = self.with_states(|raster| {
            if is_meant(raster) {
                raster.depth_compare = if raster.depth_compare == LessEqual { Less } else { Greater };
            }
        });
        let sentence =
            format!("{draws} draws of volumes that are counted behind the surface pass where they are as deep as it");
        let draws = Quantity::at_least("draws that pass at equal depth", draws as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, draws), fixed: plan })
    }

    /// Looks for wrong pixels at which a volume that is counted behind the surface has the surface's own depth, but for
    /// rounding; returns the evidence and a plan whose volumes are that much farther away. `None` where there is none.
    fn caps_round_apart(&self) -> Option<FrameFinding> {
        /// More pixels are not examined.
        const MOST: usize = 256;
        /// Parts of a pixel that corners are moved to, on most GPUs.
        const GRID: u32 = 256;
        let last = self.plan.passes.iter().rposition(|pass| {
            self.is_of_light(pass) && pass.draws.iter().any(|draw| draw.part.is_of_volume() && sides(&draw.raster)[0])
        })?;
        let depth = &self.capture.frame_at(last)?.depth.image;
        let near = self.plan.attachments.first()?.depth_rounding();
        let is_shown = |pixel: &[u32; 2]| {
            let mut covering = self.plan.covering(*pixel);
            covering.retain(|one| {
                let pass = &self.plan.passes[one.pass];
                self.is_of_light(pass) && one.part.is_of_volume() && sides(&pass.draws[one.draw].raster)[0]
            });
            let fragments = self.plan.fragments(*pixel, &covering, GRID).fragments;
            depth.depth_at(*pixel).is_some_and(|stored| fragments.iter().any(|one| (one.depth - stored).abs() <= near))
        };
        let examined: Vec<&[u32; 2]> = self.wrong.iter().step_by(self.wrong.len().div_ceil(MOST).max(1)).collect();
        let shown = examined.iter().filter(|pixel| is_shown(pixel)).count();
        if shown == 0 {
            return None;
        }
        let fixed = self.with_states(|raster| {
            if sides(raster)[0] {
                let away = if self.plan.depth.mapping.is_reversed() { -AWAY } else { AWAY };
                raster.depth_bias.constant = raster.depth_bias.constant.saturating_add(away);
            }
        });
        let sentence = format!(
            "at {} of {} wrong pixels that were examined a volume that is counted behind the surface is as deep as it, but for \
             rounding",
            numbers::count(shown as u64),
            numbers::count(examined.len() as u64)
        );
        let pixels = Quantity::at_least("wrong pixels with a volume as deep as the surface", shown as f64, 1.0);
        let evidence = Evidence { sentence, quantities: vec![pixels], shown_by: shown, examined: examined.len() };
        Some(FrameFinding { evidence, fixed })
    }

    /// Looks for open edges in the volumes that are counted behind the surface; returns the evidence and a plan with
    /// one more draw, appended to the first such draw's pass, whose caps close them. `None` where no cap is missing.
    fn open(&self) -> Option<FrameFinding> {
        let draws = || self.draws().filter(|(_, draw)| sides(&draw.raster)[0]);
        let open = OpenEdges::of(self.plan, draws().map(|(_, draw)| draw));
        let caps = open.caps();
        let triangles = caps.len() as u32;
        let (pass, draw) = draws().next().filter(|_| triangles > 0)?;
        let mut plan = self.plan.clone();
        let mesh = MeshId(plan.meshes.len());
        let indices = (0..triangles * 3).collect();
        plan.meshes.push(DrawMesh::of_positions("caps", caps.as_flattened().to_vec(), indices));
        let raster = RasterState { cull: None, ..draw.raster.clone() };
        let cap = draw.of_other_mesh("caps", mesh, triangles, raster);
        let index = self.plan.passes.iter().position(|one| std::ptr::eq(one, pass))?;
        plan.passes[index].draws.push(cap);
        let sentence = format!(
            "{} edges of the volumes that are counted behind the surface are of one triangle",
            numbers::count(open.count() as u64)
        );
        let edges = Quantity::at_least("edges of one triangle", open.count() as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, edges), fixed: plan })
    }

    /// Looks for triangles of casters at whose outline no volume begins, where they are counted in front of the surface, as z-pass does;
    /// returns the evidence and a plan with one more draw for each state of theirs, of the sides that are not drawn. `None`
    /// where none is missing.
    fn one_sided(&self) -> Option<FrameFinding> {
        let uncast = uncast_triangles(self.plan, self.scene, self.light);
        let missing: usize = uncast.iter().map(|one| one.without_volume).sum();
        let mut counted = asked_volumes(self.plan, self.light);
        counted.retain(|(_, draw)| sides(&draw.raster) == [false, true]);
        let (last, _) = counted.last().filter(|_| missing > 0)?;
        let index = self.plan.passes.iter().position(|pass| std::ptr::eq(pass, *last))?;
        let space = PassSpace::new(self.plan, last);
        let mut states: Vec<&Draw> = Vec::new();
        for (_, draw) in &counted {
            if !states.iter().any(|other| other.raster == draw.raster) {
                states.push(draw);
            }
        }
        let is_counted_up = states.iter().any(|draw| counts_up_outside(&draw.raster));
        let corners: Vec<[f32; 4]> =
            uncast.iter().flat_map(|one| sides_of(one, is_counted_up)).map(|at| space.clip(at)).collect();
        let triangles = corners.len() as u32 / 3;
        let mesh = MeshId(self.plan.meshes.len());
        let draws: Vec<Draw> =
            states.iter().map(|draw| draw.of_other_mesh("sides", mesh, triangles, draw.raster.clone())).collect();
        let mut plan = self.plan.clone();
        plan.meshes.push(DrawMesh::of_positions("sides", corners, (0..triangles * 3).collect()));
        plan.passes[index].draws.extend(draws);
        let outlines: usize = uncast.iter().map(|one| one.outline.len()).sum();
        let sentence = format!(
            "of meshes with holes no volume begins at {} of {} edges in the outline of the triangles that face the light, or of \
             those that face away from it",
            numbers::count(missing as u64),
            numbers::count(outlines as u64)
        );
        let edges = Quantity::at_least("edges of outlines at which no volume begins", missing as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, edges), fixed: plan })
    }
}

/// Returns whether faces that are seen counter-clockwise are counted up in front of the surface.
fn counts_up_outside(raster: &RasterState) -> bool {
    let (face, stencil) = match raster.front_face {
        FrontFace::Ccw => (Face::Front, &raster.stencil.front),
        FrontFace::Cw => (Face::Back, &raster.stencil.back),
    };
    raster.cull != Some(face) && matches!(stencil.pass_op, Operation::IncrementClamp | Operation::IncrementWrap)
}

/// Returns the corners of the sides of a volume that runs to infinity, three for each triangle: seen from outside they are
/// counter-clockwise, or else clockwise.
fn sides_of(uncast: &UncastTriangles, counter_clockwise: bool) -> Vec<DVec4> {
    let light = uncast.light;
    let far = |near: DVec3| (near * light.w - light.truncate()).extend(0.0);
    let side = |[from, to]: &[DVec3; 2]| {
        let [from, to] = if counter_clockwise { [*from, *to] } else { [*to, *from] };
        [from.extend(1.0), far(from), far(to), from.extend(1.0), far(to), to.extend(1.0)]
    };
    uncast.outline.iter().flat_map(side).collect()
}
