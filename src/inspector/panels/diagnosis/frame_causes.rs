//! What is wrong in another program's frame: one paragraph for each fault, with its evidence, its proof and the shadow
//! without it, and the wrong regions.

use super::fields::{DiagnosisPanel, FrameRegion};
use super::region_row::{RegionRow, go_to};
use crate::ask::{FaultsOf, QuestionKind, TruthOf};
use crate::capture::Capture;
use crate::diagnosis::Proof;
use crate::diagnosis::frame_causes::{FrameCauseFound, FrameDiagnosis};
use crate::inspector::action::PanelKind;
use crate::inspector::look::{findings, theme};
use crate::inspector::model::Model;
use crate::inspector::model::comparing::{ComparedWith, Comparison};
use crate::reading::format;
use crate::reading::picture_view::{PictureKind, has_truth};
use egui::{RichText, ScrollArea, Ui};
use std::sync::Arc;

/// How many regions are listed, the largest first.
const MOST_REGIONS: usize = 12;

/// Draws the panel Diagnosis for another program's frame: a button that starts or cancels the diagnosis, an error, and
/// once it is known each cause with its evidence and its proof.
pub fn ui(ui: &mut Ui, own: &mut DiagnosisPanel, model: &mut Model) {
    let reply = model.answers.under_way::<FaultsOf>();
    ui.horizontal(|ui| match reply.steps() {
        Some(_) => {
            if ui.button("Cancel").clicked() {
                model.answers.cancel(QuestionKind::FaultsOf);
            }
            let words = "following rays, and running the frame with one thing changed";
            ui.add(egui::Label::new(theme::note(words)).wrap());
        }
        None => {
            if ui.button("Diagnose").on_hover_text("Say where this frame is wrong and why, and prove it").clicked() {
                model.answers.start(FaultsOf {});
            }
            super::save(ui, model, reply.ready.is_some());
            let words = "Follows rays through the frame's own triangles, and runs the frame again without what may be \
                         wrong in it: only what takes the wrong pixels away is called proven.";
            ui.add(egui::Label::new(theme::note(words)).wrap());
        }
    });
    if let Some(error) = &reply.failed {
        ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(theme::of(ui).error)).wrap());
    }
    let Some(known) = reply.ready else { return };
    ScrollArea::vertical().id_salt("faults").auto_shrink([false, false]).show(ui, |ui| {
        found(ui, model, &known);
        regions(ui, own, model, &known);
    });
}

/// Draws a row for each wrong region, the largest first: a click goes to a pixel of it in the error picture. All of them
/// are known with the truth, which is asked for.
fn regions(ui: &mut Ui, own: &mut DiagnosisPanel, model: &mut Model, diagnosis: &FrameDiagnosis) {
    let Some(capture) = model.frame.capture.clone().filter(|_| diagnosis.wrong() > 0) else { return };
    if !has_truth(&capture) {
        model.answers.want(TruthOf {});
    }
    let regions = own.frame_regions(model.frame.number, &capture, diagnosis);
    ui.add_space(8.0);
    theme::heading(ui, "Where it is wrong");
    for (index, FrameRegion { light, region }) in regions.iter().enumerate().take(MOST_REGIONS) {
        let kind = region.kind.name().replace('_', " ");
        let of = if diagnosis.lights.len() > 1 { format!(" of {}", format::light(*light)) } else { String::new() };
        let row = RegionRow {
            title: format!("{} · {kind}{of}", index + 1),
            pixels: region.pixels,
            because: because(diagnosis, &capture, *light, region.at),
            color: findings::style(region.kind).color,
        };
        if row.ui(ui, own.selected == index && model.selection.pick == Some(region.at)) {
            own.selected = index;
            go_to(model, *light, region.at, region.bounds);
        }
    }
    let rest = &regions[regions.len().min(MOST_REGIONS)..];
    if !rest.is_empty() {
        let pixels = format::counted(rest.iter().map(|one| one.region.pixels).sum(), "pixel");
        ui.label(theme::note(format!("and {} smaller of {pixels}", format::count(rest.len() as u64))));
    }
}

/// Returns the first cause without which a light's wrong pixel has another label, with its proof.
fn because(diagnosis: &FrameDiagnosis, capture: &Capture, light: usize, at: [u32; 2]) -> String {
    let drawn = capture.lights.get(light).and_then(|light| light.shadow.as_ref()?.byte_at(at));
    let explains = |found: &&FrameCauseFound| {
        let is_meant = found.light.0 == light && found.proof != Proof::NotIt && !found.is_beside_wrong_pixels();
        is_meant && found.mask.as_ref().is_some_and(|mask| mask.byte_at(at) != drawn)
    };
    let found = diagnosis.causes.iter().find(explains);
    found.map_or_else(|| "no known cause fits".to_owned(), |found| format!("{} ({})", found.cause, found.proof.name()))
}

/// Draws a button that shows the light's mask beside the one that it would have without the cause, under a divider;
/// nothing where the frame has no mask to compare with.
fn compare_button(ui: &mut Ui, model: &mut Model, index: usize, found: &FrameCauseFound) {
    let light = found.light.0;
    let has_mask = |capture: &Arc<Capture>| capture.lights.get(light).is_some_and(|light| light.shadow.is_some());
    let Some(capture) = model.frame.capture.as_ref().filter(|capture| found.mask.is_some() && has_mask(capture)) else {
        return;
    };
    let with = ComparedWith::Fixed {
        index,
        cause: found.cause,
        together_with: found.together_with.first().copied(),
        more: found.together_with.len().saturating_sub(1),
        light,
    };
    let words = format!("Compare with the shadow {}", with.words(capture));
    let button = ui.add(egui::Button::new(words).wrap());
    if button.on_hover_text("The mask as it was drawn, and as the run without it has it, under a divider").clicked() {
        model.view.light = light;
        model.choose_picture(PictureKind::Mask);
        model.modes.compare = Some(Comparison { with, ..Comparison::new(model.selection.step) });
        model.requests.panels.push(PanelKind::Picture);
    }
}

fn found(ui: &mut Ui, model: &mut Model, diagnosis: &FrameDiagnosis) {
    let compared: u64 = diagnosis.lights.iter().map(|light| light.error.compared).sum();
    let [wrong, compared] = [diagnosis.wrong(), compared].map(format::count);
    ui.add_space(4.0);
    match &diagnosis.no_verdict {
        Some(because) => {
            theme::heading(ui, "No verdict");
            ui.add(egui::Label::new(format!("Nothing is called right or wrong here: {because}.")).wrap());
        }
        None => {
            theme::heading(ui, &format!("{wrong} of {compared} compared pixels are wrong"));
        }
    }
    let acne = diagnosis.lights.iter().map(|light| light.acne).sum::<u64>();
    if acne > 0 {
        let words = format!("About {} pixels are drawn dark that a map lights", format::count(acne));
        ui.add(egui::Label::new(RichText::new(words).strong()).wrap());
    }
    let said = match diagnosis.coverage.as_slice() {
        [one] => vec![format!("{}.", format::capitalized(&one.in_words()))],
        _ => diagnosis.of_lights(),
    };
    for line in said {
        ui.add(egui::Label::new(theme::note(line)).wrap());
    }
    for said in &diagnosis.stencil_uses {
        ui.add(egui::Label::new(theme::note(said.as_str())).wrap());
    }
    for (index, cause) in diagnosis.causes.iter().enumerate().filter(|(_, cause)| cause.proof != Proof::NotIt) {
        ui.add_space(4.0);
        ui.add(egui::Label::new(RichText::new(cause.title()).strong()).wrap());
        ui.add(egui::Label::new(format!("{}.", cause.evidence.sentence)).wrap());
        ui.add(egui::Label::new(theme::note(cause.meaning())).wrap());
        compare_button(ui, model, index, cause);
    }
    for (names, what) in [
        (&diagnosis.silent, "Taken to cast no shadow, as no volume begins there and no map has it"),
        (&diagnosis.unseen, "Out of view, and known by its volume or its map alone"),
    ] {
        if !names.is_empty() {
            ui.add_space(4.0);
            ui.add(egui::Label::new(theme::note(format!("{what}: {}.", names.join(", ")))).wrap());
        }
    }
}
