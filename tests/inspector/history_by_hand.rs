//! Histories of pixels of z-fail by hand: every event known.

use super::*;
use stencilscope::capture::FrameTarget;
use stencilscope::history::{
    CapturedAfter, FragmentOutcome, PixelEvent, PixelEventKind, PixelHistory, PixelValues, TestResult, TriangleEvent,
};
use stencilscope::plan::{ClipPlane, CountBits, Visibility};
use stencilscope::stencil_machine::DepthStencil;
use wgpu::StencilOperation;

/// A face of the one volume: its part, whether its outside is seen, its distance in metres.
pub type Face = (DrawPart, bool, f32);

/// Five faces over the pixel: two before the surface, three behind it, of which one is left.
pub const FACES: [Face; 5] = [
    (DrawPart::Side, true, 2.0),
    (DrawPart::Side, false, 3.0),
    (DrawPart::Side, true, 8.0),
    (DrawPart::Side, false, 10.0),
    (DrawPart::DarkCap, false, 40.0),
];

/// Near plane of the capture, metres.
const NEAR: f32 = 0.1;

struct Making {
    events: Vec<PixelEvent>,
    values: PixelValues,
    after: Vec<CapturedAfter>,
}

impl Making {
    fn push(&mut self, pass: usize, kind: PixelEventKind, after: PixelValues) {
        let pass_name = ["ambient", "volumes", "mask", "light"][pass].to_owned();
        let light = (pass > 0).then_some(0);
        let before = std::mem::replace(&mut self.values, after);
        let target = if pass == 2 { FrameTarget::Labels } else { FrameTarget::Picture };
        self.events.push(PixelEvent { pass, pass_name, light, is_from_camera: true, target, kind, before, after });
    }

    fn end_pass(&mut self, pass: usize) {
        let stored = DepthStencil { depth: self.values.depth, stencil: self.values.stencil };
        self.after.push(CapturedAfter { pass, stored, count: None });
    }
}

fn triangle(
    name: &str,
    part: DrawPart,
    primitive: u32,
    is_front: bool,
    depth: f32,
    outcome: FragmentOutcome,
) -> TriangleEvent {
    TriangleEvent {
        draw: usize::from(part == DrawPart::DarkCap),
        draw_name: name.to_owned(),
        caster: (part != DrawPart::Surface).then(|| "box".to_owned()),
        part,
        primitive,
        triangle: primitive,
        source_triangle: primitive,
        piece: Some(primitive),
        corners: [[-0.1, -0.1, -NEAR / depth, 1.0], [0.1, -0.1, -NEAR / depth, 1.0], [0.0, 0.1, -NEAR / depth, 1.0]],
        // Triangles of a dark cap face into the volume.
        is_front: is_front != (part == DrawPart::DarkCap),
        faces_inwards: part == DrawPart::DarkCap,
        lights: (part == DrawPart::Surface).then_some(Visibility::Everywhere),
        depth,
        outcome,
        may_discard: false,
    }
}

/// The history of pixel `at`: a floor, faces of a volume (sides before dark caps), and the passes
/// that read the count. Two clears, a floor in three passes, and as many events more as faces.
pub fn history(at: [u32; 2], faces: &[Face]) -> PixelHistory {
    let surface = NEAR / (1.0 + at[0] as f32);
    let values = PixelValues { depth: 0.0, stencil: 0, count: 0.0 };
    let mut making = Making { events: Vec::new(), values, after: Vec::new() };
    making.push(0, PixelEventKind::ClearDepth, values);
    making.push(0, PixelEventKind::ClearStencil, values);
    let outcome = FragmentOutcome::Tested { stencil: TestResult::Always, depth: TestResult::Passed, operation: None };
    let floor =
        |outcome| PixelEventKind::Triangle(Box::new(triangle("floor", DrawPart::Surface, 0, true, surface, outcome)));
    making.push(0, floor(outcome), PixelValues { depth: surface, ..values });
    making.end_pass(0);
    for (index, (part, is_front, distance)) in faces.iter().enumerate() {
        let depth = NEAR / distance;
        if *distance < NEAR {
            let one = triangle(
                "sides of box",
                *part,
                index as u32,
                *is_front,
                depth,
                FragmentOutcome::Clipped(ClipPlane::Near),
            );
            making.push(1, PixelEventKind::Triangle(Box::new(one)), making.values);
            continue;
        }
        let passes = depth > surface;
        let (operation, stencil) = match (passes, is_front) {
            (true, _) => (StencilOperation::Keep, making.values.stencil),
            (false, true) => (StencilOperation::DecrementWrap, making.values.stencil.wrapping_sub(1)),
            (false, false) => (StencilOperation::IncrementWrap, making.values.stencil.wrapping_add(1)),
        };
        let test = if passes { TestResult::Passed } else { TestResult::Failed };
        let outcome = FragmentOutcome::Tested { stencil: TestResult::Always, depth: test, operation: Some(operation) };
        let name = if *part == DrawPart::Side { "sides of box" } else { "dark cap of box" };
        let one = triangle(name, *part, index as u32, *is_front, depth, outcome);
        making.push(1, PixelEventKind::Triangle(Box::new(one)), PixelValues { stencil, ..making.values });
    }
    making.end_pass(1);
    for pass in [2, 3] {
        let is_lit = making.values.stencil == 0;
        let stencil = if is_lit { TestResult::Passed } else { TestResult::Failed };
        let depth = if is_lit { TestResult::Passed } else { TestResult::NotReached };
        let outcome = FragmentOutcome::Tested { stencil, depth, operation: Some(StencilOperation::Keep) };
        making.push(pass, floor(outcome), making.values);
        making.end_pass(pass);
    }
    PixelHistory {
        pixel: at,
        has_stencil: true,
        is_reversed: true,
        depth_rounding: 0.0,
        start: PixelValues { depth: 0.0, stencil: 0, count: 0.0 },
        computed: making.values,
        captured: making.after.last().map(|after| after.stored),
        captured_after: making.after,
        counted: faces.iter().filter(|(_, _, distance)| *distance >= NEAR).count() as u32 + 3,
        labels: Vec::new(),
        darkens: Vec::new(),
        replaces: Vec::new(),
        is_off: Vec::new(),
        counts_in: vec![Some(CountBits::EIGHT)],
        without_fragment: 2 + faces.iter().filter(|(_, _, distance)| *distance < NEAR).count() as u32,
        contradictions: Vec::new(),
        events: making.events,
    }
}
