//! A history as text that a student can follow: pass by pass, a line an event.

use super::{FragmentOutcome, PixelEvent, PixelEventKind, PixelHistory, PixelValues, TestResult, TriangleEvent};
use crate::math::depth::DepthCurve;
use crate::numbers;
use crate::plan::DrawPart;
use std::fmt::Write;
use wgpu_types::StencilOperation;

/// Returns the name of a stencil operation in JSON and text, such as `increment-wrap`.
pub fn operation_name(operation: StencilOperation) -> &'static str {
    match operation {
        StencilOperation::Keep => "keep",
        StencilOperation::Zero => "zero",
        StencilOperation::Replace => "replace",
        StencilOperation::Invert => "invert",
        StencilOperation::IncrementClamp => "increment-clamp",
        StencilOperation::DecrementClamp => "decrement-clamp",
        StencilOperation::IncrementWrap => "increment-wrap",
        StencilOperation::DecrementWrap => "decrement-wrap",
    }
}

impl PixelHistory {
    /// Returns the whole history as lines of text; passes (all of the plan), lights and triangles count from 1. `curve` is
    /// the capture's depth curve, which turns depths into metres.
    pub fn story(&self, curve: &DepthCurve) -> String {
        self.story_with(curve, "", |pass| Some(pass + 1))
    }

    /// Returns the history as lines of text: the result, why each light does or does not arrive, then `reasons` (each
    /// ended by a newline), then every event by pass. `number` returns the number of the pass of an index, `None` for one
    /// that is only named. Ends with a warning for each disagreement with the GPU.
    pub fn story_with(&self, curve: &DepthCurve, reasons: &str, number: impl Fn(usize) -> Option<usize>) -> String {
        let mut text = format!("pixel {},{}: {}\n", self.pixel[0], self.pixel[1], self.result(curve, &number));
        let lights: std::collections::BTreeSet<usize> = self.events.iter().filter_map(|event| event.light).collect();
        for light in lights {
            if let Some(why) = self.why(light) {
                // Writing to a string can't fail.
                let _ = writeln!(text, "  {}: {why}", numbers::light(light));
            }
        }
        text += reasons;
        let mut pass = None;
        for event in &self.events {
            if pass.replace(event.pass) != Some(event.pass) {
                let of = event.light.map_or_else(String::new, |light| format!("{}: ", numbers::light(light)));
                let pass = number(event.pass).map_or_else(String::new, |number| format!("pass {number}, "));
                let _ = writeln!(text, "\n{pass}{of}{}", event.pass_name);
            }
            let _ = writeln!(text, "  {}", self.line(event, curve));
        }
        let disagreements = self.disagreements();
        if !disagreements.is_empty() {
            let _ = writeln!(text, "\n!! {}", self.why_disagreeing());
        }
        for disagreement in disagreements {
            let _ = writeln!(text, "  {disagreement}");
        }
        text
    }

    /// Returns words for the pixel's final depth (with its distance) and stencil, with the pass that changed that last, and for
    /// whether the GPU stored the same; `not captured` where nothing was captured there.
    fn result(&self, curve: &DepthCurve, number: &impl Fn(usize) -> Option<usize>) -> String {
        let PixelValues { depth, stencil, .. } = self.computed;
        let surface = match curve.distance(depth) {
            Some(distance) => format!(
                "a surface {} away (depth {})",
                numbers::length(distance, curve.unit.name()),
                numbers::depth(depth)
            ),
            None if !curve.tells_distances() && depth != curve.mapping.clear_depth() => {
                format!("a surface, how far away is not known: all depths are stored as {}", numbers::depth(depth))
            }
            None => format!("no surface (depth {})", numbers::depth(depth)),
        };
        // Lights are decided by the stencil that their pass tested, which it may change.
        let changed = |event: &&PixelEvent| event.before.stencil != event.after.stencil;
        let since = self.events.iter().rfind(changed).map_or_else(String::new, |event| match number(event.pass) {
            Some(number) => format!(" since pass {number}, {}", event.pass_name),
            None => format!(" since {}", event.pass_name),
        });
        let stencil =
            if self.has_stencil { format!(", stencil {}{since}", numbers::signed(stencil)) } else { String::new() };
        let agrees = match (self.agrees(), self.captured) {
            (true, Some(_)) => "as the GPU stored it",
            (true, None) => "not captured",
            (false, _) => "NOT as the GPU stored it",
        };
        format!("{surface}{stencil}, {agrees}")
    }

    /// Returns an event in a few words that are the same on every machine, for lists that tests compare: `volumes: side
    /// of box, back, fails depth, stencil 0 to 1`.
    pub fn brief(&self, event: &PixelEvent) -> String {
        let change = match event {
            PixelEvent { before, after, .. } if before.count != after.count => {
                format!(", count {} to {}", before.count, after.count)
            }
            PixelEvent { before, after, .. } if before.stencil != after.stencil => {
                format!(", stencil {} to {}", before.stencil, after.stencil)
            }
            PixelEvent { before, after, .. } if before.depth != after.depth => ", stores depth".to_owned(),
            _ => String::new(),
        };
        let pass = &event.pass_name;
        match &event.kind {
            PixelEventKind::Put => format!("{pass}: other content"),
            PixelEventKind::ClearDepth => format!("{pass}: clear depth"),
            PixelEventKind::ClearStencil => format!("{pass}: clear stencil"),
            PixelEventKind::ClearCount => format!("{pass}: clear count"),
            PixelEventKind::Triangle(one) => {
                let side = if one.shows_outside() { "front" } else { "back" };
                let outcome = match one.outcome {
                    FragmentOutcome::Tested { stencil: TestResult::Failed, .. } => "fails stencil",
                    FragmentOutcome::Tested { depth: TestResult::Failed, .. } => "fails depth",
                    FragmentOutcome::Tested { .. } => "passes",
                    FragmentOutcome::Discarded(_) => "discarded",
                    FragmentOutcome::Culled => "culled",
                    FragmentOutcome::Clipped(_) => "clipped",
                };
                format!("{pass}: {}, {side}, {outcome}{change}", triangle_name(one))
            }
        }
    }

    /// Returns an event as a line of text without a newline: for a triangle its part and object, number (from 1), side,
    /// distance, and what became of it.
    pub fn line(&self, event: &PixelEvent, curve: &DepthCurve) -> String {
        match &event.kind {
            PixelEventKind::Put => format!(
                "a copy, a clear of a part or a draw that is not followed has left depth {} and stencil {}",
                numbers::depth(event.after.depth),
                event.after.stencil
            ),
            PixelEventKind::ClearDepth => format!("clear depth to {}", numbers::depth(event.after.depth)),
            PixelEventKind::ClearStencil => format!("clear stencil to {}", event.after.stencil),
            PixelEventKind::ClearCount => format!("clear count to {}", numbers::count_in_float(event.after.count)),
            PixelEventKind::Triangle(one) => {
                let name = triangle_name(one);
                let side = if one.shows_outside() { "front" } else { "back" };
                let distance = match curve.distance(one.depth).filter(|_| event.is_from_camera) {
                    Some(distance) if distance >= 0.0 => {
                        format!(", at {}", numbers::length(distance, curve.unit.name()))
                    }
                    Some(_) if curve.is_linear => ", before the eye".to_owned(),
                    Some(_) => ", beyond the far plane".to_owned(),
                    None if !curve.tells_distances() => String::new(),
                    None if event.is_from_camera && curve.is_linear => ", where depth ends or beyond".to_owned(),
                    None if event.is_from_camera => ", at infinity".to_owned(),
                    None => String::new(),
                };
                let triangle = one.source_triangle + 1;
                format!("{name}, triangle {triangle}, {side}{distance}: {}", self.what_became(event, one))
            }
        }
    }

    /// Returns words, ended by a comma, for where a face lies relative to the depth stored before it: in front of, on,
    /// or behind the surface, or that there is none.
    fn place(&self, event: &PixelEvent, one: &TriangleEvent) -> &'static str {
        let [face, surface] =
            [one.depth, event.before.depth].map(|depth| if self.is_reversed { -depth } else { depth });
        // As far away as depth goes.
        let is_cleared = event.before.depth == if self.is_reversed { 0.0 } else { 1.0 };
        match face.total_cmp(&surface) {
            _ if is_cleared => "where no surface is, ",
            std::cmp::Ordering::Less => "in front of the surface, ",
            std::cmp::Ordering::Equal => "on the surface, ",
            std::cmp::Ordering::Greater => "behind the surface, ",
        }
    }

    fn what_became(&self, event: &PixelEvent, one: &TriangleEvent) -> String {
        let FragmentOutcome::Tested { stencil, depth, operation } = one.outcome else {
            return one.outcome.note().unwrap_or_default().to_owned();
        };
        let place = if event.is_of_volume() && event.is_from_camera { self.place(event, one) } else { "" };
        let tests = match (stencil, depth) {
            (TestResult::Failed, _) => "fails the stencil test",
            (_, TestResult::Failed) => "fails the depth test",
            (TestResult::Passed, TestResult::Passed) => "passes stencil and depth test",
            (TestResult::Passed, _) => "passes the stencil test",
            (_, TestResult::Passed) => "passes the depth test",
            _ => "no test stops it",
        };
        let mut text = format!("{place}{tests}");
        let [before, after] = [event.before, event.after];
        if before.depth != after.depth {
            text.push_str(", and its depth is stored");
        }
        if let Some(operation) = operation.filter(|operation| *operation != StencilOperation::Keep) {
            let (name, after_value) = (operation_name(operation), numbers::signed(after.stencil));
            let _ = if before.stencil == after.stencil {
                write!(text, "; {name}: stencil stays {after_value}")
            } else {
                write!(text, "; {name}: stencil {} → {after_value}", numbers::signed(before.stencil))
            };
        }
        if before.count != after.count {
            let _ = write!(
                text,
                "; count {} → {}",
                numbers::count_in_float(before.count),
                numbers::count_in_float(after.count)
            );
        }
        text
    }
}

/// Returns words for the part and the object of a triangle: `side of torus 2`; the draw's name for a surface, or where
/// no caster is known.
fn triangle_name(one: &TriangleEvent) -> String {
    match one.part {
        DrawPart::Surface => one.draw_name.clone(),
        DrawPart::Receiver => format!("receiver {}", one.draw_name),
        DrawPart::PlanarShadow => format!("flattened {}", one.draw_name),
        other => match &one.caster {
            Some(caster) => format!("{} of {caster}", other.name().replace('-', " ")),
            // In another program's volumes, sides and caps are not distinguished.
            None => format!("volume {}", one.draw_name),
        },
    }
}
