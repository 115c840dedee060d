//! Takes the fragments of a log through the tests of their draws.

use super::{
    Disagreement, FragmentOutcome, PixelEvent, PixelEventKind, PixelHistory, PixelValues, TestResult, TriangleEvent,
    captured_after,
};
use crate::capture::{Capture, FrameTarget};
use crate::plan::{
    AttachmentRole, ColorWrite, CountBits, Coverage, Covering, Draw, DrawPart, FragmentLog, FramePlan, LightId, Pass,
    Program, RasterState, StartContent, ViewId, Visibility, VisibleFace,
};
use crate::stencil_machine::{self, IncomingFragment};
use wgpu_types::CompareFunction;

/// The values of a new texture, which wgpu clears to zero.
const NEW: PixelValues = PixelValues { depth: 0.0, stencil: 0, count: 0.0 };

/// The bits of a pixel's parts to which most rasterisers move corners, where a capture does not tell its own.
const USUAL_BITS: u32 = 8;
/// The most bits of such parts that a profile tells.
const MOST_BITS: u32 = 9;
/// How far depths may be off on a rasteriser that moves corners without their depth, as far as was seen.
const COARSE_ROUNDING: f32 = 4e-6;

impl PixelHistory {
    /// Computes the history of `pixel` without a GPU, from the plan of a frame and its `capture`: a rasteriser on the CPU
    /// makes the fragments ([`FramePlan::fragments`]), with the grid that the capture's profile tells, or 1/256 pixel.
    /// As the last bits of depths are each GPU's own, those within [`depth_rounding`](PixelHistory::depth_rounding)
    /// don't count as a contradiction.
    pub fn without_gpu(plan: &FramePlan, capture: &Capture, pixel: [u32; 2]) -> PixelHistory {
        let covering = plan.covering(pixel);
        let bits = capture.profile.map_or(USUAL_BITS, |profile| profile.subpixel_bits.min(MOST_BITS));
        let log = plan.fragments(pixel, &covering, 1 << bits);
        let history = PixelHistory::new(plan, capture, pixel, &covering, &log);
        let target = first_with_depth(plan).and_then(|index| plan.passes[index].depth_stencil.as_ref());
        let of_target = target.map_or(0.0, |target| plan.attachment(target.attachment).depth_rounding());
        let is_coarse = capture.profile.is_some_and(|profile| profile.exact_range().coarse_step.is_some());
        let depth_rounding = if is_coarse { COARSE_ROUNDING.max(of_target) } else { of_target };
        PixelHistory { depth_rounding, ..history }
    }

    /// Replays the events of `pixel` on the CPU from the plan of a frame and its `capture`. `covering` has the
    /// triangles over the pixel, and `log` the fragments that the GPU made of them.
    pub fn new(
        plan: &FramePlan,
        capture: &Capture,
        pixel: [u32; 2],
        covering: &[Covering],
        log: &FragmentLog,
    ) -> PixelHistory {
        let start = start_of(plan, pixel);
        let mut replay = HistoryReplay { plan, pixel, values: start, events: Vec::new(), contradictions: Vec::new() };
        let is_hidden = |one: &&Covering| matches!(one.coverage, Coverage::Culled(_) | Coverage::Clipped(..));
        let hidden = covering.iter().filter(is_hidden).count() as u32;
        let mut fragments = log.fragments.iter().peekable();
        let mut covering = covering.iter().enumerate().peekable();
        for (index, pass) in plan.passes.iter().enumerate().filter(|(_, pass)| plan.is_of_picture(pass)) {
            replay.clear(index, pass);
            while let Some((id, one)) = covering.next_if(|(_, one)| one.pass == index) {
                let mut has_fragment = false;
                while let Some(fragment) = fragments.next_if(|fragment| fragment.covering == id) {
                    has_fragment = true;
                    replay.test(pass, one, fragment.is_front, fragment.depth);
                }
                replay.compare(pass, one, has_fragment);
            }
        }
        let captured_after = captured_after(plan, capture, pixel);
        PixelHistory {
            pixel,
            has_stencil: plan.attachments.iter().any(|attachment| {
                attachment.role == AttachmentRole::DepthStencil && attachment.format.has_stencil_aspect()
            }),
            is_reversed: plan.depth.mapping.is_reversed(),
            start,
            depth_rounding: rounding(plan),
            computed: replay.values,
            events: replay.events,
            captured: captured_after.last().map(|captured| captured.stored),
            captured_after,
            labels: capture.lights.iter().map(|light| light.shadow.as_ref()?.byte_at(pixel)).collect(),
            counted: log.counted,
            without_fragment: clears(plan) + hidden,
            counts_in: counts_in(plan),
            darkens: darkens(plan),
            replaces: replaces(plan),
            is_off: plan.lights.iter().map(|light| light.color == [0.0; 3]).collect(),
            contradictions: replay.contradictions,
        }
    }
}

struct HistoryReplay<'a> {
    plan: &'a FramePlan,
    pixel: [u32; 2],
    values: PixelValues,
    events: Vec<PixelEvent>,
    contradictions: Vec<Disagreement>,
}

impl HistoryReplay<'_> {
    fn push(&mut self, index: usize, kind: PixelEventKind, after: PixelValues) {
        let pass = &self.plan.passes[index];
        self.events.push(PixelEvent {
            pass: index,
            pass_name: pass.name.clone(),
            light: pass.light.map(|light| light.0),
            is_from_camera: pass.view == ViewId(0),
            target: target_of(self.plan, pass),
            kind,
            before: self.values,
            after,
        });
        self.values = after;
    }

    /// Appends the events that a pass begins with, and changes the pixel's current values accordingly: content set from
    /// outside (not that of the frame's own start), then clears of depth, stencil and a float count.
    fn clear(&mut self, index: usize, pass: &Pass) {
        // The frame's own start is no event.
        if let Some(start) = start_content(pass).filter(|_| first_with_depth(self.plan) != Some(index)) {
            let written = values_of(start, self.plan, self.pixel, self.values);
            self.push(index, PixelEventKind::Put, written);
        }
        if let Some(target) = &pass.depth_stencil {
            if let Some(depth) = target.clear_depth {
                self.push(index, PixelEventKind::ClearDepth, PixelValues { depth, ..self.values });
            }
            if let Some(stencil) = target.clear_stencil {
                self.push(index, PixelEventKind::ClearStencil, PixelValues { stencil, ..self.values });
            }
        }
        if let Some(clear) =
            pass.color.as_ref().and_then(|target| target.clear).filter(|_| self.plan.counts_in_float(pass))
        {
            self.push(index, PixelEventKind::ClearCount, PixelValues { count: clear[0] as f32, ..self.values });
        }
    }

    fn test(&mut self, pass: &Pass, one: &Covering, is_front: bool, depth: f32) {
        let draw = &pass.draws[one.draw];
        let viewport = pass.viewport(self.plan.size);
        let is_ranged = pass.own_viewport().is_some();
        let clip = draw.program.discards(if is_ranged { viewport.device(depth) } else { depth });
        if clip.is_some() || !self.plan.meshes[draw.mesh.0].keeps(self.pixel, one.triangle) {
            self.push(
                one.pass,
                triangle(self.plan, draw, one, VisibleFace { is_front, depth }, FragmentOutcome::Discarded(clip)),
                self.values,
            );
            return;
        }
        let target = pass.depth_stencil.as_ref().map(|target| self.plan.attachment(target.attachment));
        let depth = depth + target.map_or(0.0, |target| target.shader_bias(draw.raster.depth_bias));
        let [near, far] = viewport.depth;
        let depth = if draw.raster.unclipped_depth { depth.clamp(near, far) } else { depth };
        let depth = target.map_or(depth, |target| target.stored_depth(depth));
        let tested = stencil_machine::test(
            &draw.raster,
            IncomingFragment { depth, front_facing: is_front },
            self.values.stored(),
        );
        let (side, _) = draw.raster.face(is_front);
        let has_test = draw.raster.stencil.is_enabled();
        let outcome = FragmentOutcome::Tested {
            stencil: test_of(Some(tested.stencil_passed), side.compare),
            depth: test_of(tested.depth_passed, draw.raster.depth_compare),
            operation: has_test.then_some(tested.operation),
        };
        let added = if tested.passed() && self.plan.counts_in_float(pass) { count_of(draw, is_front) } else { 0.0 };
        let after =
            PixelValues { depth: tested.after.depth, stencil: tested.after.stencil, count: self.values.count + added };
        self.push(one.pass, triangle(self.plan, draw, one, VisibleFace { is_front, depth }, outcome), after);
    }

    /// Compares what geometry says of a triangle with whether the GPU made a fragment of it: appends the event of a
    /// culled or clipped triangle, or a contradiction where they disagree. Does nothing for a triangle that surely
    /// covers the pixel and has a fragment, or is doubtful.
    fn compare(&mut self, pass: &Pass, one: &Covering, has_fragment: bool) {
        let draw = &pass.draws[one.draw];
        let (face, outcome) = match (one.coverage, has_fragment) {
            (Coverage::Doubtful, _) | (Coverage::Sure, true) => return,
            (Coverage::Culled(face), false) => (face, FragmentOutcome::Culled),
            (Coverage::Clipped(face, clip), false) => (face, FragmentOutcome::Clipped(clip)),
            (coverage, _) => {
                let (pass, draw, primitive) = (one.pass, draw.name.clone(), one.primitive);
                let is_missing = coverage == Coverage::Sure;
                self.contradictions.push(Disagreement::Geometry { pass, draw, primitive, is_missing });
                return;
            }
        };
        self.push(one.pass, triangle(self.plan, draw, one, face, outcome), self.values);
    }
}

/// Returns how far computed depths may be from those stored in another program's frame, by its depth format; 0 for our
/// own frames.
fn rounding(plan: &FramePlan) -> f32 {
    let first = first_with_depth(plan).map(|index| &plan.passes[index]).filter(|pass| pass.recorded.is_some());
    let target = first.and_then(|pass| Some(plan.attachment(pass.depth_stencil.as_ref()?.attachment)));
    target.map_or(0.0, |target| target.depth_rounding())
}

/// Returns the values of a pixel of the picture before the frame's first pass.
fn start_of(plan: &FramePlan, pixel: [u32; 2]) -> PixelValues {
    let first = first_with_depth(plan).and_then(|index| start_content(&plan.passes[index]));
    first.map_or(NEW, |start| values_of(start, plan, pixel, NEW))
}

/// Returns the index of the first pass into the picture that has a depth-stencil attachment; `None` where there is
/// none.
fn first_with_depth(plan: &FramePlan) -> Option<usize> {
    plan.passes.iter().position(|pass| plan.is_of_picture(pass) && pass.depth_stencil.is_some())
}

fn start_content(pass: &Pass) -> Option<&StartContent> {
    pass.recorded.as_ref()?.start.as_ref()
}

/// Returns the depth and stencil that `start` sets at a pixel; those of `values` where it sets none. The count is
/// always that of `values`.
fn values_of(start: &StartContent, plan: &FramePlan, [x, y]: [u32; 2], values: PixelValues) -> PixelValues {
    let index = y as usize * plan.size[0] as usize + x as usize;
    let depth = start.depth.as_ref().and_then(|depth| depth.data().get(index).copied());
    let stencil = start.stencil.as_ref().and_then(|stencil| stencil.data().get(index).copied());
    PixelValues { depth: depth.unwrap_or(values.depth), stencil: stencil.unwrap_or(values.stencil), ..values }
}

/// Returns what a pass draws into, by the role of its colour target: a light's labels, a light's count, or else the
/// picture. The picture also for a pass without a colour target, such as one that counts in the stencil, and for passes
/// of maps. Which light it is, the pass says.
fn target_of(plan: &FramePlan, pass: &Pass) -> FrameTarget {
    let role = pass.color.as_ref().map(|target| plan.attachment(target.attachment).role);
    role.and_then(FrameTarget::of).map_or(FrameTarget::Picture, |(target, _)| target)
}

/// Returns for each light the stencil bits that its first volume draw may write, whether or not it covers this pixel;
/// `None` for a light without volume draws.
fn counts_in(plan: &FramePlan) -> Vec<Option<CountBits>> {
    let counts = |light: usize| {
        let passes = plan.passes.iter().filter(|pass| pass.light == Some(LightId(light)));
        let mut draws = passes.flat_map(|pass| &pass.draws).filter(|draw| draw.part.is_of_volume());
        draws.next().map(|draw| CountBits::of_mask(draw.raster.stencil.write_mask))
    };
    (0..plan.lights.len()).map(counts).collect()
}

/// Returns for each light whether one of its passes is known to take it away where the stencil test passes.
fn darkens(plan: &FramePlan) -> Vec<bool> {
    let does = |pass: &Pass| pass.recorded.as_ref().is_some_and(|recorded| recorded.darkens);
    let of_light = |light: usize| plan.passes.iter().any(|pass| pass.light == Some(LightId(light)) && does(pass));
    (0..plan.lights.len()).map(of_light).collect()
}

/// Returns for each light whether a draw of another program's passes of it replaces colours where the stencil lets it.
fn replaces(plan: &FramePlan) -> Vec<bool> {
    let does = |draw: &Draw| {
        let RasterState { color, stencil, .. } = &draw.raster;
        *color == ColorWrite::Replace && stencil.is_enabled() && matches!(draw.program, Program::Recorded { .. })
    };
    let of_light = |light: usize| {
        let passes = plan.passes.iter().filter(|pass| pass.light == Some(LightId(light)));
        passes.flat_map(|pass| &pass.draws).any(does)
    };
    (0..plan.lights.len()).map(of_light).collect()
}

/// Returns how many events without a triangle every pixel's history has: clears of depth, stencil and float counts in
/// passes of the picture, and content set before such a pass, other than the first with depth.
fn clears(plan: &FramePlan) -> u32 {
    let of_pass = |pass: &Pass| {
        let target = pass.depth_stencil.as_ref();
        let depth = target.and_then(|target| target.clear_depth).is_some();
        let stencil = target.and_then(|target| target.clear_stencil).is_some();
        let count =
            pass.color.as_ref().filter(|_| plan.counts_in_float(pass)).and_then(|target| target.clear).is_some();
        u32::from(depth) + u32::from(stencil) + u32::from(count)
    };
    let first = first_with_depth(plan);
    let passes = || plan.passes.iter().enumerate().filter(|(_, pass)| plan.is_of_picture(pass));
    let written =
        passes().filter(|(index, pass)| start_content(pass).is_some() && first != Some(*index)).count() as u32;
    written + passes().map(|(_, pass)| of_pass(pass)).sum::<u32>()
}

fn triangle(
    plan: &FramePlan,
    draw: &Draw,
    one: &Covering,
    face: VisibleFace,
    outcome: FragmentOutcome,
) -> PixelEventKind {
    PixelEventKind::Triangle(Box::new(TriangleEvent {
        draw: one.draw,
        draw_name: draw.name.clone(),
        caster: draw.caster.clone(),
        part: one.part,
        primitive: one.primitive,
        triangle: one.triangle,
        source_triangle: plan.meshes[draw.mesh.0].source_triangle(one.triangle),
        piece: one.piece,
        corners: one.corners,
        is_front: face.is_front,
        faces_inwards: draw.faces_inwards,
        lights: asks(draw),
        depth: face.depth,
        outcome,
        may_discard: draw.discards_unknown(&plan.meshes[draw.mesh.0]),
    }))
}

/// Returns what the shader of a draw that adds light reads to find how much arrives; for surfaces of another program
/// [`Visibility::Everywhere`], as that is not known; `None` for other draws.
fn asks(draw: &Draw) -> Option<Visibility> {
    match draw.program {
        Program::Light(visibility) => Some(visibility),
        // Whatever else another program's shader asks is not known.
        Program::Recorded { .. } if draw.part == DrawPart::Surface => Some(Visibility::Everywhere),
        _ => None,
    }
}

fn test_of(passed: Option<bool>, function: CompareFunction) -> TestResult {
    match passed {
        None => TestResult::NotReached,
        Some(true) if function == CompareFunction::Always => TestResult::Always,
        Some(true) => TestResult::Passed,
        Some(false) => TestResult::Failed,
    }
}

/// Returns what a fragment of a draw adds to a float count: the draw's constant, negative for the back faces of
/// volumes; 0 for a draw that writes no colour or does not count.
fn count_of(draw: &Draw, is_front: bool) -> f32 {
    match (draw.raster.color, draw.program) {
        (ColorWrite::None, _) => 0.0,
        (_, Program::Count) if is_front => draw.constants.count,
        (_, Program::Count) => -draw.constants.count,
        (_, Program::Flat) => draw.constants.flat[0],
        _ => 0.0,
    }
}
