//! The Diagnosis tab: where the frame is wrong, why, and how to fix it.
//!
//! Regions are rows; a click goes to a pixel of one and to its history, and from an earlier step to the one that decided
//! it. The causes of the selected region, their fixes and the pixels still wrong with each are in `detail.rs`, faults of
//! another program's frame in `frame_causes.rs`. The tab shows data and asks for it; the app runs what it asks for.

pub mod detail;
pub mod fields;
mod frame_causes;
mod region_row;

use crate::accuracy::Finding;
use crate::ask::{DiagnosisOf, QuestionKind, Reply};
use crate::diagnosis::{Diagnosis, RegionFound, RegionKind};
use crate::inspector::action::{Action, DialogKind, ExportKind};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::format;
use egui::{Align, Layout, RichText, ScrollArea, Ui, vec2};
pub use fields::DiagnosisPanel;
use region_row::{RegionRow, go_to};
use std::sync::Arc;

/// Width of the list of regions, points, and the largest share of the panel that it has.
const LIST_WIDTH: f32 = 320.0;
const LIST_SHARE: f32 = 0.5;
/// In a panel narrower than this, points, causes follow below their region, and all scrolls: side by side both would be cut.
const LEAST_BESIDE: f32 = 460.0;
/// In a panel narrower than this, points, the summary stands below the buttons.
const SAID_BESIDE: f32 = 380.0;
/// How much of their colour the findings of an earlier frame keep.
const STALE_OPACITY: f32 = 0.6;

/// Draws the panel Diagnosis: regions of wrong pixels, their causes, and the fixes with their proofs; the last
/// diagnosis stays visible while another runs. For another program's frame, its own list of causes.
pub fn ui(ui: &mut Ui, own: &mut DiagnosisPanel, model: &mut Model, actions: &mut Vec<Action>) {
    if model.origin().is_some() {
        return frame_causes::ui(ui, own, model);
    }
    let reply = model.answers.under_way::<DiagnosisOf>();
    let known = model.answers.last::<DiagnosisOf>().map(|(_, diagnosis)| Arc::clone(diagnosis));
    top_line(ui, model, &reply, known.as_deref());
    if let Some(error) = &reply.failed {
        ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(theme::of(ui).error)).wrap());
    }
    let Some(diagnosis) = known else { return };
    if own.follow(&diagnosis) {
        model.forget_other_fix();
    }
    if model.is_diagnosis_stale() {
        let words = "The scene was changed since: this is of the frame before. Diagnose again to know what is so now.";
        ui.add(egui::Label::new(RichText::new(words).color(theme::of(ui).failed)).wrap());
        ui.multiply_opacity(STALE_OPACITY);
    } else if reply.steps().is_some() {
        let words = "Below is what was found before, until this diagnosis is done.";
        ui.add(egui::Label::new(theme::note(words)).wrap());
        ui.multiply_opacity(STALE_OPACITY);
    }
    ui.add_space(4.0);
    let size = ui.available_size();
    let list = LIST_WIDTH.min(size.x * LIST_SHARE);
    let goes_to_top = std::mem::take(&mut own.goes_to_top);
    let scrolled = |name: &str| {
        let area = ScrollArea::vertical().id_salt(name).auto_shrink([false, false]);
        if goes_to_top { area.vertical_scroll_offset(0.0) } else { area }
    };
    if size.x < LEAST_BESIDE {
        scrolled("regions and causes").show(ui, |ui| {
            detail::advice(ui, model, &diagnosis, actions);
            regions(ui, own, model, &diagnosis, &mut |ui, model, region| {
                detail::causes(ui, model, &diagnosis, region, actions);
                ui.add_space(8.0);
            });
            detail::meshes_and_flags(ui, &diagnosis);
        });
        return;
    }
    ui.horizontal_top(|ui| {
        ui.allocate_ui_with_layout(vec2(list, size.y), Layout::top_down(Align::Min), |ui| {
            scrolled("wrong regions").show(ui, |ui| regions(ui, own, model, &diagnosis, &mut |_, _, _| ()));
        });
        ui.allocate_ui_with_layout(vec2(ui.available_width(), size.y), Layout::top_down(Align::Min), |ui| {
            let selected = diagnosis.regions.get(own.selected);
            scrolled("causes").show(ui, |ui| {
                detail::advice(ui, model, &diagnosis, actions);
                if let Some(region) = selected {
                    theme::heading(ui, &region.title());
                    detail::causes(ui, model, &diagnosis, region, actions);
                }
                detail::meshes_and_flags(ui, &diagnosis);
            });
        });
    });
}

/// Draws the button that starts the diagnosis with a summary, or, while one is running, its progress and a button that
/// cancels it. It can't be started without a scene and a capture.
fn top_line(ui: &mut Ui, model: &mut Model, reply: &Reply<Diagnosis>, known: Option<&Diagnosis>) {
    let can_run = model.scene.is_some() && model.frame.capture.is_some();
    let is_narrow = ui.available_width() < SAID_BESIDE;
    ui.horizontal(|ui| match reply.steps() {
        Some((done, of)) => {
            if ui.button("Cancel").on_hover_text("Stop diagnosing; what was found before stays").clicked() {
                model.answers.cancel(QuestionKind::DiagnosisOf);
            }
            let bar = egui::ProgressBar::new(done as f32 / of.max(1) as f32);
            let width = ui.available_width().min(180.0);
            ui.add(bar.desired_width(width).desired_height(8.0)).accessible_name("Diagnosing");
            ui.add(egui::Label::new(theme::note("following rays, and running what may fix it")).wrap());
        }
        None => {
            let is_new = known.is_none();
            let words = if is_new { "Diagnose" } else { "Diagnose again" };
            let button = ui.add_enabled(can_run, egui::Button::new(words));
            let button = button.on_disabled_hover_text("Open a scene first: its frame is diagnosed");
            if button.on_hover_text("Say where this frame is wrong, why, and how to fix it").clicked() {
                model.start_diagnosis();
            }
            save(ui, model, !is_new);
            if !is_narrow {
                ui.add(egui::Label::new(theme::note(summary(model, known, can_run))).wrap());
            }
        }
    });
    // Beside the buttons it would be a column of single words.
    if is_narrow && reply.steps().is_none() {
        ui.add(egui::Label::new(theme::note(summary(model, known, can_run))).wrap());
    }
}

/// Draws, where a diagnosis is known, the button that writes it to a file.
fn save(ui: &mut Ui, model: &mut Model, is_known: bool) {
    if is_known && ui.button("Save…").on_hover_text("Write what was found to a file, as text or JSON").clicked() {
        model.dialog = Some(DialogKind::Export(ExportKind::Diagnosis));
    }
}

/// Returns a sentence: how many compared pixels are wrong in the known diagnosis, and whether it is of what is shown
/// now; without one, what diagnosing does or that a scene must be opened.
fn summary(model: &Model, known: Option<&Diagnosis>, can_run: bool) -> String {
    match known {
        Some(diagnosis) => {
            let error = &diagnosis.error;
            let of = format!("{}, {}", diagnosis.scene, diagnosis.technique.name());
            let compared = format::count(error.compared);
            let earlier = if model.is_diagnosed_as_shown(diagnosis) { "" } else { " (not as it is shown now)" };
            match error.wrong() {
                0 if error.compared == 0 => format!("{of}{earlier}: nothing was compared"),
                0 => format!("{of}{earlier}: none of {compared} compared pixels is wrong"),
                wrong => format!("{of}{earlier}: {} of {compared} compared pixels are wrong", format::count(wrong)),
            }
        }
        None if can_run => {
            "Follows rays through the scene, groups wrong pixels, and runs what may fix them: only what \
                            takes them away is called proven."
                .to_owned()
        }
        None => "Open a scene to find out why its shadows are wrong.".to_owned(),
    }
}

/// Draws a row for each region, with what `below` draws under that of the selected one.
fn regions(
    ui: &mut Ui,
    own: &mut DiagnosisPanel,
    model: &mut Model,
    diagnosis: &Diagnosis,
    below: &mut dyn FnMut(&mut Ui, &mut Model, &RegionFound),
) {
    if diagnosis.regions.is_empty() {
        ui.label(theme::note("No pixel is wrong."));
    }
    for (index, region) in diagnosis.regions.iter().enumerate() {
        region_row(ui, own, model, diagnosis, region, index);
        if own.selected == index {
            below(ui, model, region);
        }
    }
    if diagnosis.rest.regions > 0 {
        let pixels = format::counted(diagnosis.rest.pixels, "pixel");
        ui.label(theme::note(format!("and {} smaller of {pixels}", format::count(diagnosis.rest.regions as u64))));
    }
}

fn region_row(
    ui: &mut Ui,
    own: &mut DiagnosisPanel,
    model: &mut Model,
    diagnosis: &Diagnosis,
    region: &RegionFound,
    index: usize,
) {
    let row = RegionRow {
        title: format!("{} · {}", index + 1, region.title()),
        pixels: region.pixels,
        because: because(diagnosis, region),
        color: color(region.kind),
    };
    if row.ui(ui, own.selected == index) {
        own.selected = index;
        go_to(model, region.light, region.at, region.bounds);
    }
}

/// Returns a region's most likely cause and how certain it is; where it has none, why.
fn because(diagnosis: &Diagnosis, region: &RegionFound) -> String {
    let none = || diagnosis.without_cause(region).to_owned();
    region.causes.first().map_or_else(none, |found| format!("{} ({})", found.cause, found.proof.name()))
}

/// Returns the colour that this kind of region has in the error picture; a region that is too dark has the false
/// shadow's, one that is too bright the missing shadow's.
fn color(kind: RegionKind) -> egui::Color32 {
    let finding = match kind {
        RegionKind::Wrong(finding) => finding,
        RegionKind::LitTwice => Finding::MissingShadow,
        RegionKind::TooDark | RegionKind::PartlyDark | RegionKind::Seam | RegionKind::Swims => Finding::FalseShadow,
    };
    crate::inspector::look::findings::style(finding).color
}
