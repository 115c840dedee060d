//! The stencil test by itself: what a pixel holds, a draw's tests, and the fragments that were pushed through them, each in
//! words. The same [`stencil_machine`] answers that a test holds against the GPU.

use crate::history::operation_name;
use crate::numbers;
use crate::plan::{ColorWrite, RasterState, StencilFace};
use crate::stencil_machine::{self, DepthStencil, IncomingFragment, TestOutcome};
use wgpu::{CompareFunction, StencilOperation};

/// Fragments that are kept; older ones go.
const MOST_PUSHED: usize = 200;

/// Every function, by name and as a sign between two numbers.
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
/// A pixel, a draw's tests, and what went through them.
#[derive(Debug)]
pub struct TestBench {
    /// The draw's tests.
    pub state: RasterState,
    /// What the pixel holds.
    pub stored: DepthStencil,
    /// Of the next fragment.
    pub depth: f32,
    /// The oldest first.
    pub pushed: Vec<TestedDraw>,
    /// How many there were, the forgotten ones too.
    count: usize,
}

/// A fragment that went through the tests.
#[derive(Debug, Clone, PartialEq)]
pub struct TestedDraw {
    /// From 1.
    pub number: usize,
    /// What became of it.
    pub words: String,
}

impl Default for TestBench {
    /// Z-fail's counting over a surface at half depth.
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
    /// Tests a fragment of one side, and keeps what comes out.
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

/// What became of a fragment, from what was tested and what came out.
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
    text +=
        &format!("; {}: stencil {} to {}", operation_name(outcome.operation), before.stencil, outcome.after.stencil);
    if outcome.after.depth != before.depth {
        text += &format!(", depth {} to {}", numbers::depth(before.depth), numbers::depth(outcome.after.depth));
    }
    text
}

fn sign(compare: CompareFunction) -> Option<&'static str> {
    COMPARES.iter().find(|(one, ..)| *one == compare).map(|(_, _, sign)| *sign).filter(|sign| !sign.is_empty())
}

/// A function's name.
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
