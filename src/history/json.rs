//! `pixel --json`; `assets/help/json.md` says what each field means. Names are a contract with scripts.

use super::{FragmentOutcome, PixelEvent, PixelEventKind, PixelHistory, TestResult, operation_name};
use crate::plan::ClipPlane;
use serde::Serialize;

/// A pixel's history, to be serialised as JSON for `pixel --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PixelDocument {
    pixel: [u32; 2],
    events: Vec<PixelEventEntry>,
    #[serde(rename = "final")]
    computed: StoredEntry,
    captured: Option<StoredEntry>,
    agrees: bool,
    /// What is wrong, where something is.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    disagreements: Vec<String>,
    /// Why each light does or does not arrive; null where the technique leaves no events that show it.
    why: Vec<Option<String>>,
    milliseconds: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct StoredEntry {
    stencil: Option<u8>,
    depth: f32,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct PixelEventEntry {
    pass: usize,
    draw: Option<usize>,
    name: String,
    light: Option<usize>,
    caster: Option<String>,
    part: Option<&'static str>,
    primitive: Option<u32>,
    /// Index in the mesh's triangle list, from 0.
    triangle: Option<u32>,
    source_triangle: Option<u32>,
    front_facing: Option<bool>,
    depth: Option<f32>,
    depth_test: Option<&'static str>,
    stencil_test: Option<&'static str>,
    operation: Option<&'static str>,
    stencil_before: Option<u8>,
    stencil_after: Option<u8>,
    depth_before: f32,
    depth_after: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    count_before: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    count_after: Option<f32>,
    note: Option<String>,
}

impl PixelDocument {
    /// Makes the document of a history, with its events, final values, disagreements and, for each light, why it does
    /// or does not arrive. `milliseconds` is how long the history took to compute.
    pub fn new(history: &PixelHistory, milliseconds: f64) -> PixelDocument {
        let stored = |depth, stencil| StoredEntry { stencil: history.has_stencil.then_some(stencil), depth };
        let disagreements: Vec<String> = history.disagreements().iter().map(ToString::to_string).collect();
        PixelDocument {
            pixel: history.pixel,
            events: history.events.iter().map(|event| entry(history, event)).collect(),
            computed: stored(history.computed.depth, history.computed.stencil),
            captured: history.captured.map(|captured| stored(captured.depth, captured.stencil)),
            agrees: disagreements.is_empty(),
            disagreements,
            why: (0..history.labels.len()).map(|light| history.why(light).map(|why| why.to_string())).collect(),
            milliseconds,
        }
    }
}

fn entry(history: &PixelHistory, event: &PixelEvent) -> PixelEventEntry {
    let one = event.triangle();
    let counts = event.before.count != event.after.count || event.kind == PixelEventKind::ClearCount;
    let tests = match one.map(|one| one.outcome) {
        Some(FragmentOutcome::Tested { stencil, depth, operation }) => Some((stencil, depth, operation)),
        _ => None,
    };
    let stencil = |value| history.has_stencil.then_some(value);
    let operation = tests.and_then(|(_, _, operation)| operation);
    PixelEventEntry {
        pass: event.pass,
        draw: one.map(|one| one.draw),
        name: match &event.kind {
            PixelEventKind::Put => "other content".to_owned(),
            PixelEventKind::ClearDepth => "clear depth".to_owned(),
            PixelEventKind::ClearStencil => "clear stencil".to_owned(),
            PixelEventKind::ClearCount => "clear count".to_owned(),
            PixelEventKind::Triangle(_) => event.pass_name.clone(),
        },
        light: event.light,
        caster: one.and_then(|one| one.caster.clone()),
        part: one.map(|one| one.part.name()),
        primitive: one.map(|one| one.primitive),
        triangle: one.map(|one| one.triangle),
        source_triangle: one.map(|one| one.source_triangle),
        front_facing: one.map(|one| one.is_front),
        depth: one.map(|one| one.depth),
        depth_test: tests.and_then(|(_, depth, _)| word(depth)),
        // Without a stencil test there is nothing that could pass or fail.
        stencil_test: tests.filter(|_| operation.is_some()).and_then(|(stencil, ..)| word(stencil)),
        operation: operation.map(operation_name),
        stencil_before: stencil(event.before.stencil),
        stencil_after: stencil(event.after.stencil),
        depth_before: event.before.depth,
        depth_after: event.after.depth,
        count_before: counts.then_some(event.before.count),
        count_after: counts.then_some(event.after.count),
        note: one.and_then(|one| one.outcome.note()).map(str::to_owned),
    }
}

fn word(test: TestResult) -> Option<&'static str> {
    test.passed().map(|passed| if passed { "pass" } else { "fail" })
}

impl FragmentOutcome {
    /// Returns a sentence on why a triangle left no fragment; `None` where it left one.
    pub fn note(self) -> Option<&'static str> {
        match self {
            FragmentOutcome::Tested { .. } => None,
            FragmentOutcome::Culled => Some("culled: the draw shows only the other side of triangles"),
            FragmentOutcome::Clipped(ClipPlane::Near) => Some("clipped: it is nearer than the near plane"),
            FragmentOutcome::Clipped(ClipPlane::Far) => Some("clipped: it is beyond the far plane"),
            FragmentOutcome::Discarded(Some(ClipPlane::Near)) => {
                Some("discarded by the shader: it is nearer than the near plane")
            }
            FragmentOutcome::Discarded(Some(ClipPlane::Far)) => {
                Some("discarded by the shader: it is beyond the far plane")
            }
            FragmentOutcome::Discarded(None) => Some("discarded by the shader"),
        }
    }
}
