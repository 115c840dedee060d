//! An event of a pixel's history as the cells of a table row, and as the row's accessible name.

use crate::capture::Capture;
use crate::history::{
    FragmentOutcome, PixelEvent, PixelEventKind, PixelHistory, PixelValues, TestResult, TriangleEvent,
};
use crate::math::depth::DepthCurve;
use crate::numbers;
use crate::plan::{ClipPlane, DrawPart};
use crate::reading::steps;
use wgpu_types::StencilOperation;

/// The cells of one row of a pixel's history in the Pixel panel.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryCells {
    /// Number of the pass, from 1; `None` for a mask.
    pub number: Option<usize>,
    /// The pass in words: `pass 2`, `mask`.
    pub pass: String,
    /// The part that the fragment belongs to, for its colour.
    pub part: Option<DrawPart>,
    /// The part in words, or what is cleared.
    pub what: String,
    /// Name of the object; empty where there is none.
    pub of: String,
    /// Which side of the triangle is seen, `front` or `back`; empty for a clear.
    pub side: &'static str,
    /// The event's outcome.
    pub outcome: EventOutcome,
    /// The value before and after, or the value that did not change.
    pub change: String,
    /// Whether the event changed the value that the pixel stores.
    pub has_changed: bool,
}

/// The outcome of an event of a pixel's history, as its row shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventOutcome {
    /// The pass cleared the value.
    Cleared,
    /// The fragment was tested.
    Tested {
        /// The depth test.
        depth: TestResult,
        /// The stencil test.
        stencil: TestResult,
        /// The stencil operation; `None` without a stencil test.
        operation: Option<StencilOperation>,
    },
    /// The triangle left no fragment; the reason in a word.
    Nothing(&'static str),
}

impl HistoryCells {
    /// Returns the cells for an event of a pixel's history: a clear, other content that was written, or a triangle's
    /// fragment.
    pub fn of(history: &PixelHistory, event: &PixelEvent, capture: &Capture) -> HistoryCells {
        let (change, has_changed) = change(history, event, &capture.depth);
        let number = steps::number(capture, event.pass);
        let mut cells = HistoryCells {
            number,
            pass: number.map_or_else(|| event.pass_name.clone(), |number| format!("pass {number}")),
            part: None,
            what: String::new(),
            of: String::new(),
            side: "",
            outcome: EventOutcome::Cleared,
            change,
            has_changed,
        };
        match &event.kind {
            PixelEventKind::Put => cells.what = "other content".to_owned(),
            PixelEventKind::ClearDepth => cells.what = "clear depth".to_owned(),
            PixelEventKind::ClearStencil => cells.what = "clear stencil".to_owned(),
            PixelEventKind::ClearCount => cells.what = "clear count".to_owned(),
            PixelEventKind::Triangle(one) => {
                cells.part = Some(one.part);
                (cells.what, cells.of) = named(one);
                cells.side = side(one);
                cells.outcome = outcome(one.outcome);
            }
        }
        cells
    }

    /// Returns the row as text, for tooltips and screen readers; what is empty is left out.
    pub fn name(&self) -> String {
        let mut name = format!("{}: {}", self.pass, self.what);
        let mut add = |separator: &str, text: &str| {
            if !text.is_empty() {
                name.push_str(separator);
                name.push_str(text);
            }
        };
        add(" of ", &self.of);
        add(", ", self.side);
        match self.outcome {
            EventOutcome::Cleared => {}
            EventOutcome::Tested { depth, stencil, operation } => {
                add("; ", &format!("depth {}, stencil {}", sign(depth), sign(stencil)));
                add("; ", operation.map_or("", short));
            }
            EventOutcome::Nothing(why) => add("; ", why),
        }
        add("; ", &self.change);
        name
    }
}

/// Returns the whole event as one line of text, with `to` in place of arrows, which the font does not have.
pub fn line(history: &PixelHistory, event: &PixelEvent, curve: &DepthCurve) -> String {
    history.line(event, curve).replace('→', "to")
}

/// Returns the part of a triangle and the object it belongs to, in words: `dark cap` and `torus 2`. For a surface, and
/// a volume of another program, the first is the draw's name and the object is empty.
pub fn named(one: &TriangleEvent) -> (String, String) {
    let caster = || one.caster.clone().unwrap_or_else(|| one.draw_name.clone());
    match one.part {
        DrawPart::Surface => (one.draw_name.clone(), String::new()),
        DrawPart::Receiver => ("receiver".to_owned(), one.draw_name.clone()),
        DrawPart::PlanarShadow => ("flattened".to_owned(), caster()),
        // In another program's volumes, sides and caps can't be distinguished.
        part if part.is_of_volume() && one.caster.is_none() => (one.draw_name.clone(), String::new()),
        other => (other.name().replace('-', " "), caster()),
    }
}

/// Returns which side of a triangle is seen, `front` (the outside) or `back`.
pub fn side(one: &TriangleEvent) -> &'static str {
    if one.shows_outside() { "front" } else { "back" }
}

fn outcome(outcome: FragmentOutcome) -> EventOutcome {
    match outcome {
        FragmentOutcome::Tested { stencil, depth, operation } => EventOutcome::Tested { depth, stencil, operation },
        FragmentOutcome::Culled => EventOutcome::Nothing("culled"),
        FragmentOutcome::Clipped(ClipPlane::Near) => EventOutcome::Nothing("clipped at near"),
        FragmentOutcome::Clipped(ClipPlane::Far) => EventOutcome::Nothing("clipped at far"),
        FragmentOutcome::Discarded(Some(ClipPlane::Near)) => EventOutcome::Nothing("discarded before near"),
        FragmentOutcome::Discarded(Some(ClipPlane::Far)) => EventOutcome::Nothing("discarded beyond far"),
        FragmentOutcome::Discarded(None) => EventOutcome::Nothing("discarded by the shader"),
    }
}

/// Returns the sign for a test's result: ✓ passed, ✗ failed, `always` where it can't fail, `-` where it was not
/// reached.
pub fn sign(test: TestResult) -> &'static str {
    match test {
        TestResult::Passed => "✓",
        TestResult::Failed => "✗",
        TestResult::Always => "always",
        TestResult::NotReached => "-",
    }
}

/// Returns a stencil operation in a few letters, such as `+1`. Wrapping and clamping look the same; [`line()`]
/// distinguishes them.
pub fn short(operation: StencilOperation) -> &'static str {
    match operation {
        StencilOperation::Keep => "keep",
        StencilOperation::Zero => "zero",
        StencilOperation::Replace => "set",
        StencilOperation::Invert => "invert",
        StencilOperation::IncrementClamp | StencilOperation::IncrementWrap => "+1",
        StencilOperation::DecrementClamp | StencilOperation::DecrementWrap => "−1",
    }
}

/// Returns a stencil value read as a signed byte, such as `−1` for 255.
pub fn signed(value: u8) -> String {
    numbers::signed(value).split(' ').next().unwrap_or_default().to_owned()
}

/// Returns a float count, negative ones with a minus sign (`−1.5`), others without a sign.
fn float(value: f32) -> String {
    if value < 0.0 { format!("−{}", -value) } else { value.to_string() }
}

/// Returns the event's change of the pixel as text, such as `0 → 1`, and whether anything changed. For a clear its
/// value; for a triangle the stencil, else the float count, else the distance, whichever changed first in this order,
/// else the unchanged stencil (empty where there is none).
fn change(history: &PixelHistory, event: &PixelEvent, curve: &DepthCurve) -> (String, bool) {
    let PixelValues { depth, stencil, count } = event.before;
    let after = event.after;
    match event.kind {
        PixelEventKind::ClearDepth => {
            return (format!("→ {}", numbers::digits(f64::from(after.depth))), depth != after.depth);
        }
        PixelEventKind::Put | PixelEventKind::ClearStencil => {
            return (format!("→ {}", signed(after.stencil)), stencil != after.stencil);
        }
        PixelEventKind::ClearCount => return (format!("→ {}", float(after.count)), count != after.count),
        PixelEventKind::Triangle(_) => {}
    }
    if stencil != after.stencil {
        (format!("{} → {}", signed(stencil), signed(after.stencil)), true)
    } else if count != after.count {
        (format!("{} → {}", float(count), float(after.count)), true)
    } else if depth != after.depth {
        let distance = curve
            .distance(after.depth)
            .map_or_else(|| "∞".to_owned(), |distance| numbers::length(distance, curve.unit.letter()));
        (format!("→ {distance}"), true)
    } else if history.has_stencil {
        (signed(stencil), false)
    } else {
        (String::new(), false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_below_zero_is_read_with_its_sign_alone() {
        assert_eq!([0, 1, 127, 128, 255].map(signed), ["0", "1", "127", "−128", "−1"]);
        assert_eq!(float(-2.0), "−2");
    }

    #[test]
    fn no_two_outcomes_of_a_test_have_the_same_sign() {
        let signs = [TestResult::Passed, TestResult::Failed, TestResult::Always, TestResult::NotReached].map(sign);
        assert_eq!(signs.iter().collect::<std::collections::BTreeSet<_>>().len(), signs.len());
    }
}
