//! Under the passes: the draws of the selected one, and what the frame left out.

use super::format;
use super::theme;
use crate::capture::{DrawSummary, Step};
use crate::plan::LeftOut;
use egui::{RichText, Ui, vec2};
use std::collections::BTreeMap;

/// Draws that are listed before the rest is folded away.
const LISTED: usize = 16;

/// The draws of a step: part, name and triangles; many are folded away unless `all`.
pub fn of_step(ui: &mut Ui, step: &Step, all: &mut bool) {
    // One line less is folded away for the line that says so.
    let listed = if *all || step.draws.len() <= LISTED { step.draws.len() } else { LISTED - 1 };
    for draw in &step.draws[..listed] {
        row(ui, draw);
    }
    let folded = &step.draws[listed..];
    if !folded.is_empty() {
        let triangles = folded.iter().map(|draw| draw.triangles).sum();
        let text = format!("{} more draws · {}", folded.len(), format::counted(triangles, "triangle"));
        ui.horizontal(|ui| {
            ui.add_space(34.0);
            let button = egui::Button::new(theme::note(text)).frame_when_inactive(false);
            *all |= ui.add(button).on_hover_text("List all draws of this pass").clicked();
        });
    }
}

fn row(ui: &mut Ui, draw: &DrawSummary) {
    ui.horizontal(|ui| {
        ui.set_min_height(20.0);
        ui.add_space(34.0);
        match theme::part_color(draw.part) {
            Some(color) => theme::swatch(ui, color),
            None => ui.add_space(10.0 + ui.spacing().item_spacing.x),
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add_space(8.0);
            let triangles = theme::number(format::count(draw.triangles)).color(theme::DIM);
            ui.label(triangles).on_hover_text("Triangles submitted");
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                let text = RichText::new(&draw.name).size(theme::SMALL_SIZE).color(theme::DIM);
                ui.add(egui::Label::new(text).truncate()).on_hover_text(draw.part.name());
            });
        });
    });
}

/// What the frame did without, faint, with the reason: absence is a lesson too.
pub fn left_out(ui: &mut Ui, left_out: &[LeftOut]) {
    if left_out.is_empty() {
        return;
    }
    ui.add_space(8.0);
    ui.label(theme::note("Left out"));
    ui.add_space(2.0);
    // The same decision is taken again for every light: once is enough to read.
    let mut times = BTreeMap::new();
    for entry in left_out {
        *times.entry(key(entry)).or_insert(0_u32) += 1;
    }
    for entry in left_out {
        let Some(times) = times.remove(&key(entry)) else { continue };
        let times = if times > 1 { format!(" ×{times}") } else { String::new() };
        let title = format!("{} of {}{times}", entry.what, entry.of);
        ui.horizontal(|ui| {
            ui.add_space(8.0);
            ui.vertical(|ui| {
                ui.add(egui::Label::new(RichText::new(title).size(theme::SMALL_SIZE).color(theme::DIM)).wrap());
                let reason = RichText::new(&entry.because).size(theme::SMALL_SIZE).color(theme::FAINT);
                ui.add(egui::Label::new(reason).wrap());
            });
        });
        ui.allocate_space(vec2(0.0, 6.0));
    }
}

fn key(entry: &LeftOut) -> [&str; 3] {
    [&entry.what, &entry.of, &entry.because]
}
