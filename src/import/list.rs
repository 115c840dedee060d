//! A frame's events and states as a table, for readers who want to see what was recorded.

use super::raw::{RawCull, RawDraw, RawEvent, RawFormat, RawFrame, RawKind, RawStencilFace};
use crate::plan::ShaderEffect;
use crate::plan::words::spelled;
use std::fmt::Write;
use wgpu_types::StencilOperation;

/// Returns a heading with totals, then a line for each event (number, what it does, triangles, states, targets), then
/// its limits.
pub fn list(frame: &RawFrame) -> String {
    let program = frame.program.as_ref().map_or_else(String::new, |program| format!("{program}, "));
    let RawFrame { adapter, recorder, events, .. } = frame;
    let draws: Vec<&RawDraw> = events.iter().filter_map(|event| drawn(&event.kind)).collect();
    let triangles: usize = draws.iter().map(|draw| draw.triangles.len()).sum();
    let mut text = format!("{program}{}, {adapter}, {recorder}\n", frame.api.name());
    let counts = [events.len(), draws.len(), triangles];
    // Writing to a string can't fail.
    let _ = writeln!(text, "{} events, {} draws, {} triangles\n", counts[0], counts[1], counts[2]);
    let rows: Vec<[String; 5]> = events.iter().map(|event| row(frame, event)).collect();
    let headings = ["event", "what", "triangles", "states", "targets"].map(str::to_owned);
    let rows: Vec<[String; 5]> = std::iter::once(headings).chain(rows).collect();
    let widths: [usize; 5] =
        std::array::from_fn(|at| rows.iter().map(|row| row[at].chars().count()).max().unwrap_or_default());
    for [id, what, triangles, states, targets] in &rows {
        let [a, b, c, d, _] = widths;
        let line = format!("{id:>a$}  {what:b$}  {triangles:>c$}  {states:d$}  {targets}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    let limits: String = frame.limits.iter().map(|limit| format!("\nlimit: {limit}")).collect();
    if limits.is_empty() { text } else { format!("{text}{limits}\n") }
}

fn drawn(kind: &RawKind) -> Option<&RawDraw> {
    match kind {
        RawKind::Draw(draw) => Some(draw),
        _ => None,
    }
}

fn row(frame: &RawFrame, event: &RawEvent) -> [String; 5] {
    /// The most characters of a call's name that are shown.
    const SHOWN: usize = 48;
    let name: String = event.groups.iter().map(|group| format!("{group} / ")).chain([event.name.clone()]).collect();
    let name = name.chars().filter(|c| !c.is_control()).take(SHOWN).collect();
    let draw = drawn(&event.kind);
    let triangles = draw.map_or_else(String::new, |draw| draw.triangles.len().to_string());
    let targets = event.color_targets.iter().take(1).chain(&event.depth_target);
    let targets: Vec<String> = targets.map(|target| target_name(frame, *target)).collect();
    [event.id.to_string(), name, triangles, draw.map_or_else(String::new, states), targets.join(", ")]
}

fn target_name(frame: &RawFrame, target: super::raw::RawTarget) -> String {
    let texture = &frame.textures[target.texture];
    let format = match &texture.format {
        RawFormat::Other(name) => name.clone(),
        known => format!("{known:?}"),
    };
    let layer = if texture.layers > 1 { format!(" layer {}", target.layer) } else { String::new() };
    let [width, height] = texture.size.map(|side| (side >> target.mip).max(1));
    format!("{}{layer} {width}x{height} {format}", texture.name)
}

fn states(draw: &RawDraw) -> String {
    let mut words = Vec::new();
    if draw.shape.cull != RawCull::None {
        words.push(format!("cull {}", draw.shape.cull.name()));
    }
    if let Some(depth) = &draw.depth {
        words.push(format!("depth {}{}", spelled(depth.compare, '-'), if depth.write { " write" } else { "" }));
    }
    if let Some([front, back]) = &draw.stencil {
        let (front, back) = (face(front), face(back));
        words.push(match front == back {
            true => format!("stencil {front}"),
            false => format!("stencil front {front}, back {back}"),
        });
    }
    if let Some(blend) = &draw.blend {
        words.extend(blend.equations.is_some().then(|| "blend".to_owned()));
        words.extend((blend.write == [false; 4]).then(|| "no colour".to_owned()));
    }
    words.extend((draw.fragment.may_discard != ShaderEffect::No).then(|| "may discard".to_owned()));
    if draw.samples > 1 {
        words.push(format!("{} samples", draw.samples));
    }
    words.join("; ")
}

/// Returns a stencil face as text: its test and reference, masks other than 0xff, and operations other than keep.
fn face(RawStencilFace { face, masks }: &RawStencilFace) -> String {
    let mut text = format!("{} {}", spelled(face.compare, '-'), masks.reference);
    let masks = [("compares", masks.read), ("writes", masks.write)];
    for (what, mask) in masks.into_iter().filter(|(_, mask)| *mask != 0xff) {
        let _ = write!(text, " {what} {mask:#04x}");
    }
    let operations = [("fail", face.fail_op), ("depth-fail", face.depth_fail_op), ("pass", face.pass_op)];
    for (when, operation) in operations.into_iter().filter(|(_, operation)| *operation != StencilOperation::Keep) {
        let _ = write!(text, " {when} {}", spelled(operation, '-'));
    }
    text
}
