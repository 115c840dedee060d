//! Everything at the picked pixel: one sentence, then numbers, then how they came about.

use super::palette::{label_color, label_name, signed_stencil, stencil_color};
use super::{State, theme};
use crate::capture::{Capture, FrameSnapshot, Snapshot, Step};
use egui::{Color32, Grid, RichText, Ui};

pub(super) fn ui(ui: &mut Ui, state: &mut State) {
    let (Some(capture), Some(at)) = (state.capture.clone(), state.pick) else {
        ui.label("No pixel is picked.");
        ui.label(theme::dim("Right-click the picture to read a pixel. Then arrow keys move it, texel by texel."));
        return;
    };
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for light in 0..capture.lights.len() {
            sentence(ui, &capture, light, at);
        }
        if let Some(frame) = capture.frame_at(state.step) {
            numbers(ui, &capture, frame, at);
        }
        lights(ui, &capture, at);
        story(ui, state, &capture, at);
    });
}

fn sentence(ui: &mut Ui, capture: &Capture, light: usize, at: [u32; 2]) {
    let Some((headline, reason)) = explain(capture, light, at) else { return };
    egui::Frame::new().fill(theme::RAISED).corner_radius(4).inner_margin(theme::SPACE * 2.0).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new(headline).strong());
        ui.label(theme::dim(reason));
    });
    ui.add_space(theme::SPACE);
}

/// Why a light reaches the pixel or not, by what the technique's own buffers say.
fn explain(capture: &Capture, light: usize, at: [u32; 2]) -> Option<(String, String)> {
    let label = capture.lights[light].shadow.as_ref()?.byte_at(at)?;
    let name = format!("light {}", light + 1);
    let stencil = |pass: &str| {
        let step = capture.steps.iter().find(|step| step.light == Some(light) && step.name == pass)?;
        let Snapshot::Frame(frame) = &step.snapshot else { return None };
        frame.stencil.as_ref()?.image.byte_at(at)
    };
    let (count, mark) = (stencil("volumes"), stencil("shadows"));
    let reason = match (label, count, mark) {
        (2, ..) => "No surface is here: the light pass draws nothing.".to_owned(),
        (3, ..) => "The light is on the other side of this triangle's plane: it shades itself.".to_owned(),
        (1, Some(count), _) => {
            format!("Its count is {} after the volume pass, so the light pass skips it.", signed_stencil(count))
        }
        (0, Some(0), _) => "No shadow volume contains it: its count is 0 after the volume pass.".to_owned(),
        (0, Some(_), _) => "Its object does not receive shadows, so nothing asks for its count.".to_owned(),
        (1, _, Some(mark)) => {
            format!(
                "The shadow raised its receiver's mark from {} to {mark}, and odd means dark.",
                mark.wrapping_sub(1)
            )
        }
        (0, _, Some(0)) => "No flat receiver is here, and planar shadows fall on nothing else.".to_owned(),
        (0, _, Some(mark)) => format!("Its receiver's mark is still {mark}: no flattened caster covers it."),
        (1, ..) => format!("The map of {name} holds something nearer to the light in this direction."),
        _ if capture.lights[light].map.is_some() => {
            format!("The map of {name} holds nothing nearer to the light in this direction.")
        }
        _ => "Nothing asked whether something stands between.".to_owned(),
    };
    let headline = match label {
        0 => format!("Lit by {name}."),
        1 => format!("Dark under {name}."),
        2 => "Background.".to_owned(),
        _ => format!("Turned away from {name}."),
    };
    Some((headline, reason))
}

fn numbers(ui: &mut Ui, capture: &Capture, frame: &FrameSnapshot, at: [u32; 2]) {
    Grid::new("pixel numbers").num_columns(2).spacing([theme::SPACE * 4.0, theme::SPACE]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(theme::dim(name));
            ui.label(theme::number(value));
            ui.end_row();
        };
        row("pixel", format!("{}, {}", at[0], at[1]));
        if let Some(depth) = frame.depth.image.depth_at(at) {
            for (name, value) in depth_rows(depth, capture.camera.near) {
                row(name, value);
            }
        }
        if let Some(stencil) = frame.stencil.as_ref().and_then(|aspect| aspect.image.byte_at(at)) {
            row("stencil", signed_stencil(stencil));
            row("stencil bits", format!("{:04b} {:04b}", stencil >> 4, stencil & 15));
        }
        if let Some([r, g, b, _]) = frame.color.image.rgba_at(at) {
            ui.label(theme::dim("colour"));
            ui.horizontal(|ui| {
                theme::swatch(ui, Color32::from_rgb(r, g, b));
                ui.label(theme::number(format!("{r} {g} {b}")));
            });
            ui.end_row();
        }
    });
}

/// Stored depth, the distance along the view axis that it stands for, and how far apart two
/// neighbouring values are there.
fn depth_rows(depth: f32, near: f64) -> Vec<(&'static str, String)> {
    let stored = ("depth", format!("{depth}"));
    if depth <= 0.0 {
        return vec![stored, ("distance", "infinite".to_owned())];
    }
    let distance = near / f64::from(depth);
    let next = near / f64::from(depth.next_down());
    vec![
        stored,
        ("distance", format!("{} m", theme::short(distance))),
        ("one step", format!("{:.1e} m", next - distance)),
    ]
}

fn lights(ui: &mut Ui, capture: &Capture, at: [u32; 2]) {
    let labels: Vec<(usize, u8)> = capture
        .lights
        .iter()
        .enumerate()
        .filter_map(|(index, light)| Some((index, light.shadow.as_ref()?.byte_at(at)?)))
        .collect();
    if labels.is_empty() {
        return;
    }
    theme::heading(ui, "Lights");
    for (index, label) in labels {
        ui.horizontal(|ui| {
            ui.label(theme::dim(format!("light {}", index + 1)));
            theme::swatch(ui, label_color(label));
            ui.label(theme::number(label_name(label)));
        });
    }
}

/// One row a step: what it left at the pixel. What it did not change is faint.
fn story(ui: &mut Ui, state: &mut State, capture: &Capture, at: [u32; 2]) {
    theme::heading(ui, "Step by step");
    let columns = ["pass", "stencil", "distance", "colour"];
    Grid::new("story").num_columns(columns.len()).striped(true).spacing([theme::SPACE * 3.0, 0.0]).show(ui, |ui| {
        for column in columns {
            ui.label(theme::faint(column));
        }
        ui.end_row();
        for (index, step) in capture.steps.iter().enumerate() {
            let name = format!("{} {}", index + 1, step.name);
            if ui.add(egui::Button::selectable(state.step == index, theme::number(name)).frame(false)).clicked() {
                state.go_to_step(index);
            }
            story_cells(ui, capture, step, at);
            ui.end_row();
        }
    });
}

fn story_cells(ui: &mut Ui, capture: &Capture, step: &Step, at: [u32; 2]) {
    let Snapshot::Frame(frame) = &step.snapshot else {
        for _ in 0..3 {
            ui.label(theme::faint("-"));
        }
        return;
    };
    let text = |value: String, unchanged: bool| {
        RichText::new(value).monospace().color(if unchanged { theme::FAINT } else { theme::TEXT })
    };
    ui.horizontal(|ui| match &frame.stencil {
        Some(aspect) => {
            let value = aspect.image.byte_at(at).unwrap_or(0);
            theme::swatch(ui, stencil_color(value));
            ui.label(text(signed_stencil(value), aspect.unchanged));
        }
        None => {
            ui.label(theme::faint("-"));
        }
    });
    let depth = frame.depth.image.depth_at(at).unwrap_or(0.0);
    let distance =
        if depth > 0.0 { theme::short(capture.camera.near / f64::from(depth)) } else { "infinite".to_owned() };
    ui.label(text(distance, frame.depth.unchanged));
    let [r, g, b, _] = frame.color.image.rgba_at(at).unwrap_or_default();
    ui.horizontal(|ui| {
        theme::swatch(ui, Color32::from_rgb(r, g, b));
        ui.label(text(format!("{r} {g} {b}"), frame.color.unchanged));
    });
}
