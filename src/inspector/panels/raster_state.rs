//! The State tab: the whole state of the selected draw, in a sentence, in the terms of three APIs, and the matrices
//! with the names of their spaces. Values that are an API's defaults are pale, and say so.

use crate::inspector::action::TourSubject;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::panels::tour_mark;
use crate::plan::words::{self, RasterApi};
use crate::plan::{Draw, FramePlan, Pass};
use crate::reading::format;
use crate::reading::steps;
use egui::{Label, Ui};

/// The state of the tab State.
#[derive(Debug, Default)]
pub struct RasterStatePanel {
    /// The API in whose terms the state is shown.
    api: RasterApi,
}

/// Draws the tab State: attachments, raster state and matrices of the selected draw, or of the pass's last draw where
/// none is selected. Without a plan, what the capture's plan text says; without a capture, a hint.
pub fn ui(ui: &mut Ui, own: &mut RasterStatePanel, model: &mut Model) {
    let Some(capture) = model.frame.capture.clone() else {
        ui.add(Label::new(theme::note("Open a scene: the state of its passes is shown here.")).wrap());
        return;
    };
    let step = model.selection.step;
    let plan = model.frame.plan.clone();
    let Some(pass) = plan.as_ref().and_then(|plan| plan.passes.get(step)) else {
        return from_text(ui, &capture.plan_text, step);
    };
    let Some(plan) = plan.as_ref() else { return };
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        theme::heading(ui, &steps::title(&capture, step));
        attachments(ui, plan, pass);
        let draw = model.selection.draw.and_then(|draw| pass.draws.get(draw)).or_else(|| pass.draws.last());
        match draw {
            Some(draw) => of_draw(ui, own, model, pass, draw),
            None => {
                ui.add(Label::new(theme::note("This pass draws nothing: it has no raster model.")).wrap());
            }
        }
        ui.add_space(12.0);
        matrices(ui, model, plan, pass, &capture);
        ui.add_space(16.0);
    });
}

/// Draws from where a pass is seen, its attachments with what they contain at its start (cleared or stored before), and
/// its viewport and scissor where it has them.
fn attachments(ui: &mut Ui, plan: &FramePlan, pass: &Pass) {
    let name = |id: crate::plan::AttachmentId| plan.attachments.get(id.0).map_or("?", |attachment| &attachment.name);
    let loaded = || "kept".to_owned();
    egui::Grid::new("pass attachments").num_columns(2).spacing([12.0, 4.0]).min_row_height(0.0).show(ui, |ui| {
        let mut row = |what: &str, text: String| {
            ui.label(theme::note(what));
            ui.add(Label::new(text).wrap());
            ui.end_row();
        };
        row("seen from", plan.views.get(pass.view.0).map_or_else(|| "?".to_owned(), |view| view.name.clone()));
        if let Some(color) = &pass.color {
            let load = color.clear.map_or_else(loaded, |_| "cleared".to_owned());
            row("colour", format!("{load} at the start{}", of_name(name(color.attachment))));
        }
        if let Some(target) = &pass.depth_stencil {
            let depth = target.clear_depth.map_or_else(loaded, |value| format!("cleared to {value}"));
            let stencil = target.clear_stencil.map_or_else(loaded, |value| format!("cleared to {value}"));
            let format = plan.attachments.get(target.attachment.0).map(|attachment| attachment.format);
            let of = of_name(name(target.attachment));
            row("depth", format!("{depth} at the start{of}"));
            let has_stencil = format.is_some_and(|format| format.has_stencil_aspect());
            row("stencil", if has_stencil { format!("{stencil} at the start{of}") } else { "no buffer".to_owned() });
        }
        if let Some(viewport) = pass.own_viewport() {
            let [left, top, width, height] = viewport.area;
            let [near, far] = viewport.depth;
            row("viewport", format!("{width}×{height} pixels from {left}, {top}; depths {near} to {far}"));
        }
        if let Some([left, top, columns, rows]) = pass.scissor {
            row("scissor", format!("{columns}×{rows} pixels from {left}, {top}"));
        }
    });
    ui.add_space(8.0);
}

/// Returns a clause with the name of an attachment; empty where that says no more than the name of its row.
fn of_name(name: &str) -> String {
    if ["color", "depth", "depth and stencil"].contains(&name) { String::new() } else { format!(": {name}") }
}

fn of_draw(ui: &mut Ui, own: &mut RasterStatePanel, model: &mut Model, pass: &Pass, draw: &Draw) {
    let which = if model.selection.draw.is_some() { "The selected draw" } else { "Its last draw" };
    theme::heading(ui, &format!("{which}: {}", draw.name));
    for sentence in words::sentences(&draw.raster, pass) {
        ui.add(Label::new(sentence).wrap());
    }
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        let labels = RasterApi::ALL.map(|api| (api.name(), "The same state in these words"));
        let chosen = RasterApi::ALL.iter().position(|api| *api == own.api);
        if let Some(index) = crate::inspector::look::widgets::segments(ui, &labels, chosen) {
            own.api = RasterApi::ALL[index];
        }
    });
    let lines = words::lines(&draw.raster, own.api);
    let is_default = |line: &String| words::defaults(own.api).contains(&line.as_str());
    let card = theme::card(ui).show(ui, |ui| {
        ui.set_width(ui.available_width());
        for line in &lines {
            // Said in words too: paler alone would convey it only by colour.
            let text = if is_default(line) {
                theme::number(format!("{line} // default")).color(theme::of(ui).faint)
            } else {
                theme::number(line.as_str()).color(theme::of(ui).text)
            };
            ui.add(Label::new(text).wrap().selectable(true));
        }
    });
    tour_mark::frame(ui, model, TourSubject::State, &card.response);
    let set = lines.iter().filter(|line| !is_default(line)).count();
    let differ = if set == 1 { "1 line differs" } else { &format!("{set} lines differ") };
    let note = format!("{differ} from what {} has by default.", own.api.name());
    ui.add(Label::new(theme::note(note)).wrap());
    if ui.button("Copy state").on_hover_text("To the clipboard, in these words").clicked() {
        ui.ctx().copy_text(lines.join("\n"));
    }
}

/// Draws the matrices from world to clip space, each with the names of its spaces, for the camera and, where it has a
/// map, the pass's or the chosen light. For another program's frame only says that they are not known.
fn matrices(ui: &mut Ui, model: &Model, plan: &FramePlan, pass: &Pass, capture: &crate::capture::Capture) {
    let Some(view) = plan.views.get(pass.view.0) else { return };
    theme::heading(ui, "Matrices");
    if pass.recorded.is_some() {
        let words =
            "Another program drew this frame: its vertices are in clip space already, and its matrices are not known.";
        ui.add(Label::new(theme::note(words)).wrap());
        return;
    }
    let origin = view.origin;
    let from = format!(
        "relative = world − ({}, {}, {}), in f64: what is near stays exact however far it is from the world's origin.",
        format::digits(origin.x),
        format::digits(origin.y),
        format::digits(origin.z)
    );
    ui.add(Label::new(theme::note(from)).wrap());
    matrix(ui, &format!("clip_from_relative ({})", view.name), &view.clip_from_relative.to_cols_array());
    let light = pass.light.map_or(model.view.light, |light| light.0);
    if let Some(map) = capture.lights.get(light).and_then(|light| light.map.as_ref()) {
        matrix(ui, "light_from_world", &map.light_from_world.to_cols_array().map(|value| value as f32));
        let face = match model.view.face {
            crate::reading::picture_view::FaceChoice::One(face) => face,
            crate::reading::picture_view::FaceChoice::Grid => 0,
        };
        if let Some(clip) = map.clip_from_light.get(face) {
            matrix(ui, &format!("clip_from_light, layer {face}"), &clip.to_cols_array().map(|value| value as f32));
        }
    }
}

/// Draws a matrix with its name, as four rows of four, each column as wide as its longest number: in a narrow panel
/// there is no space for more. `columns` is column-major.
fn matrix(ui: &mut Ui, name: &str, columns: &[f32; 16]) {
    ui.label(theme::note(name));
    let words: Vec<String> = columns.iter().map(|value| format!("{value:.4}")).collect();
    let width = |column: usize| words[column * 4..][..4].iter().map(String::len).max().unwrap_or(0);
    let cell = |row: usize, column: usize| format!("{:>1$}", words[column * 4 + row], width(column));
    let rows: Vec<String> =
        (0..4).map(|row| (0..4).map(|column| cell(row, column)).collect::<Vec<_>>().join(" ")).collect();
    ui.add(Label::new(theme::number(rows.join("\n"))).extend().selectable(true));
    ui.add_space(4.0);
}

/// Draws the part of the plan's text that is about the pass of index `step`, for captures without a plan, with a button
/// that copies it; says so where there is none.
fn from_text(ui: &mut Ui, text: &str, step: usize) {
    let start = format!("pass {step}: ");
    let lines: Vec<&str> = text
        .lines()
        .skip_while(|line| !line.starts_with(&start))
        .enumerate()
        .take_while(|(index, line)| *index == 0 || line.starts_with(' '))
        .map(|(_, line)| line)
        .collect();
    if lines.is_empty() {
        ui.add(Label::new(theme::note("The capture does not tell the state of this step.")).wrap());
        return;
    }
    egui::ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        theme::heading(ui, "As the capture's plan tells it");
        ui.add(Label::new(theme::number(lines.join("\n"))).extend().selectable(true));
        if ui.button("Copy state").on_hover_text("To the clipboard").clicked() {
            ui.ctx().copy_text(lines.join("\n"));
        }
    });
}
