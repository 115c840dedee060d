//! How the picked pixel's values ran over the steps: what each pass changed, and what it left.

use super::depth::DepthMeasure;
use super::format;
use super::palette;
use super::state::State;
use super::theme;
use crate::capture::{Aspect, Capture, FrameSnapshot, Snapshot};
use egui::{Color32, CornerRadius, RichText, Ui};

/// Draws the table; clicking a pass selects its step.
pub fn ui(ui: &mut Ui, state: &mut State, capture: &Capture, at: [u32; 2]) {
    theme::heading(ui, "Over the steps");
    let mut selected = None;
    let has_stencil =
        capture.frame_at(capture.steps.len().saturating_sub(1)).is_some_and(|last| last.stencil.is_some());
    egui::Grid::new("pixel over the steps").num_columns(4).spacing([12.0, 2.0]).min_row_height(20.0).show(ui, |ui| {
        ui.label(theme::note("pass"));
        if has_stencil {
            ui.label(theme::note("stencil"));
        }
        ui.label(theme::note("colour"));
        ui.label(theme::note("distance"));
        ui.end_row();
        for (index, step) in capture.steps.iter().enumerate() {
            if pass_cell(ui, index, &step.name, index == state.step) {
                selected = Some(index);
            }
            match &step.snapshot {
                Snapshot::Frame(frame) => aspects(ui, capture, frame, at, has_stencil),
                Snapshot::Map { .. } => {
                    ui.label(RichText::new("map only").size(theme::SMALL_SIZE).color(theme::FAINT));
                }
            }
            ui.end_row();
        }
    });
    if let Some(index) = selected {
        state.playing = None;
        state.select_step(index);
    }
}

/// Number and name of a pass; true when it is clicked.
fn pass_cell(ui: &mut Ui, index: usize, name: &str, is_selected: bool) -> bool {
    let color = if is_selected { theme::TEXT } else { theme::DIM };
    let text = RichText::new(format!("{} {name}", index + 1)).size(theme::SMALL_SIZE).color(color);
    let button = egui::Button::selectable(is_selected, text).corner_radius(CornerRadius::same(2));
    ui.add(button).on_hover_text("Go to this step").clicked()
}

fn aspects(ui: &mut Ui, capture: &Capture, frame: &FrameSnapshot, at: [u32; 2], has_stencil: bool) {
    if has_stencil {
        match frame.stencil.as_ref().and_then(|aspect| Some((aspect, aspect.image.byte_at(at)?))) {
            Some((aspect, value)) => cell(ui, aspect, Some(palette::stencil(value)), palette::signed(value)),
            None => {
                ui.label("");
            }
        }
    }
    match frame.color.image.rgba_at(at) {
        Some([red, green, blue, _]) => {
            cell(ui, &frame.color, Some(Color32::from_rgb(red, green, blue)), format!("{red} {green} {blue}"));
        }
        None => {
            ui.label("");
        }
    }
    if let Some(depth) = frame.depth.image.depth_at(at) {
        let distance = DepthMeasure::of_camera(capture).and_then(|measure| measure.value(depth));
        let text = match distance {
            Some(distance) => format::metres(distance),
            None if depth == 0.0 => "–".to_owned(),
            None => format::depth(depth),
        };
        cell(ui, &frame.depth, None, text);
    }
}

/// A value with its colour; faint where the pass did not touch the aspect.
fn cell(ui: &mut Ui, aspect: &Aspect, color: Option<Color32>, text: String) {
    let ink = if aspect.unchanged { theme::FAINT } else { theme::TEXT };
    let line = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        if let Some(color) = color {
            theme::swatch(ui, if aspect.unchanged { color.gamma_multiply(0.45) } else { color });
        }
        ui.label(theme::number(text).color(ink));
    });
    if aspect.unchanged {
        line.response.on_hover_text("Unchanged by this pass");
    }
}
