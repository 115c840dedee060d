//! The stencil test by itself: a pixel's stored depth and stencil, a draw's tests, and the fragments that were sent
//! through them, each described in words. It uses [`stencil_machine`], the same code that tests compare with the GPU.

use crate::capture::Capture;
use crate::history::operation_name;
use crate::numbers;
use crate::plan::{ColorWrite, RasterState, StencilFace};
use crate::stencil_machine::{self, DepthStencil, IncomingFragment, TestOutcome};
use wgpu_types::{CompareFunction, StencilOperation};

/// The most tested fragments that are listed; older ones are dropped.
const MOST_PUSHED: usize = 200;

/// Every compare function with its name and the comparison sign between two numbers; the sign is empty for never and
/// always.
pub const COMPARES: [(CompareFunction, &str, &str); 8] = [
    (CompareFunction::Never, "never", ""),
    (CompareFunction::Less, "less", "<"),
    (CompareFunction::Equal, "equal", "="),
    (CompareFunction::LessEqual, "less-equal", "≤"),
    (CompareFunction::Greater, "greater", ">"),
    (CompareFunction::NotEqual, "not-equal", "≠"),
    (CompareFunction::GreaterEqual, "greater-equal", "≥"),
    (CompareFunction::Always, "always", ""),
];
/// A single pixel on which a user tries depth and stencil tests: the raster state, the stored values, and the fragments
/// tested so far.
#[derive(Debug)]
pub struct TestBench {
    /// The depth and stencil tests.
    pub state: RasterState,
    /// The depth and stencil that the pixel stores.
    pub stored: DepthStencil,
    /// Depth of the next fragment.
    pub depth: f32,
    /// The tested fragments, the oldest first.
    pub pushed: Vec<TestedDraw>,
    /// How many fragments were tested, the dropped ones too.
    count: usize,
}

/// A fragment that was tested, with its outcome in words.
#[derive(Debug, Clone, PartialEq)]
pub struct TestedDraw {
    /// The fragment's number, counted from 1.
    pub number: usize,
    /// The outcome of its tests, in words.
    pub words: String,
}

impl Default for TestBench {
    /// The settings of z-fail counting, over a surface at half depth.
    fn default() -> TestBench {
        let face = |operation| StencilFace {
            compare: CompareFunction::Always,
            depth_fail_op: operation,
            ..StencilFace::IGNORE
        };
        let state = RasterState { depth_write: false, color: ColorWrite::None, ..RasterState::surface() };
        let [front, back] = [StencilOperation::DecrementWrap, StencilOperation::IncrementWrap].map(face);
        TestBench {
            state: state.with_faces(front, back, 0),
            stored: DepthStencil { depth: 0.5, stencil: 0 },
            depth: 0.25,
            pushed: Vec::new(),
            count: 0,
        }
    }
}

impl TestBench {
    /// Begins anew with these tests, and with what a pixel stores, if that is given.
    pub fn begin(&mut self, state: RasterState, stored: Option<DepthStencil>) {
        let stored = stored.unwrap_or(self.stored);
        *self = TestBench { state, stored, depth: self.depth, pushed: Vec::new(), count: 0 };
    }

    /// Tests a fragment of [`TestBench::depth`], updates the pixel's stored depth and stencil, and adds the fragment to
    /// the list. `front_facing` selects the stencil face.
    pub fn push(&mut self, front_facing: bool) {
        let fragment = IncomingFragment { depth: self.depth, front_facing };
        let before = self.stored;
        let outcome = stencil_machine::test(&self.state, fragment, before);
        self.stored = outcome.after;
        self.count += 1;
        let words = words(&self.state, fragment, before, &outcome);
        self.pushed.push(TestedDraw { number: self.count, words });
        if self.pushed.len() > MOST_PUSHED {
            self.pushed.remove(0);
        }
    }
}

/// Returns what a pixel (column, row) holds before a step; `None` where that is not known.
pub fn held_before(capture: &Capture, step: usize, at: [u32; 2]) -> Option<DepthStencil> {
    let frame = capture.frame_at(step.checked_sub(1)?)?;
    let stencil = frame.stencil.as_ref().and_then(|stencil| stencil.image.byte_at(at)).unwrap_or(0);
    Some(DepthStencil { depth: frame.depth.image.depth_at(at)?, stencil })
}

/// Describes how a fragment was tested: its face and depth, the stencil test with the masked values, the depth test
/// where it took place, the stencil operation with the values before and after, and the depth where it changed.
fn words(state: &RasterState, fragment: IncomingFragment, before: DepthStencil, outcome: &TestOutcome) -> String {
    let (face, masks) = state.face(fragment.front_facing);
    let side = if fragment.front_facing { "front" } else { "back" };
    let verb = |passes: bool| if passes { "passes" } else { "fails" };
    let stencil = match sign(face.compare) {
        Some(sign) => format!("{} {sign} {}", masks.reference & masks.read, before.stencil & masks.read),
        None => name(face.compare).to_owned(),
    };
    let mut text = format!(
        "{side} face at {}: the stencil test ({stencil}) {}",
        numbers::depth(fragment.depth),
        verb(outcome.stencil_passed)
    );
    if let Some(passed) = outcome.depth_passed {
        let depth = match sign(state.depth_compare) {
            Some(sign) => format!("{} {sign} {}", numbers::depth(fragment.depth), numbers::depth(before.depth)),
            None => name(state.depth_compare).to_owned(),
        };
        text += &format!(", the depth test ({depth}) {}", verb(passed));
    }
    let [from, to] = [before.stencil, outcome.after.stencil].map(numbers::signed);
    text += &format!("; {}: stencil {from} to {to}", operation_name(outcome.operation));
    if outcome.after.depth != before.depth {
        text += &format!(", depth {} to {}", numbers::depth(before.depth), numbers::depth(outcome.after.depth));
    }
    text
}

fn sign(compare: CompareFunction) -> Option<&'static str> {
    COMPARES.iter().find(|(one, ..)| *one == compare).map(|(_, _, sign)| *sign).filter(|sign| !sign.is_empty())
}

/// Returns a compare function's name, such as `less-equal`; empty for one that is not in the list of all.
pub fn name(compare: CompareFunction) -> &'static str {
    COMPARES.iter().find(|(one, ..)| *one == compare).map_or("", |(_, name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A front face at 0.75 lies before the surface at 0.5, reversed; at 0.25 behind it.
    #[test]
    fn what_is_said_is_what_the_machine_did() {
        let mut bench = TestBench::default();
        bench.push(false);
        assert_eq!(bench.stored, DepthStencil { depth: 0.5, stencil: 1 });
        let said = &bench.pushed[0].words;
        assert_eq!(
            said,
            "back face at 0.25: the stencil test (always) passes, the depth test (0.25 > 0.5) fails; increment-wrap: \
             stencil 0 to 1"
        );
        bench.depth = 0.75;
        bench.push(true);
        assert!(bench.pushed[1].words.ends_with("the depth test (0.75 > 0.5) passes; keep: stencil 1 to 1"));
        bench.state.stencil.front.compare = CompareFunction::Less;
        bench.state.stencil_reference = 7;
        bench.push(true);
        assert!(bench.pushed[2].words.contains("the stencil test (7 < 1) fails; keep"), "{}", bench.pushed[2].words);
    }

    #[test]
    fn old_fragments_are_forgotten_and_numbers_go_on() {
        let mut bench = TestBench::default();
        (0..300).for_each(|_| bench.push(false));
        assert_eq!((bench.pushed.len(), bench.pushed[0].number, bench.stored.stencil), (MOST_PUSHED, 101, 44));
    }
}
