//! What is wrong in another program's frame: one paragraph for each fault, with its evidence and its proof.

use crate::ask::{FaultsOf, QuestionKind};
use crate::diagnosis::Proof;
use crate::diagnosis::frame_causes::FrameDiagnosis;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::format;
use crate::reading::picture_view::PictureKind;
use egui::{RichText, ScrollArea, Ui};

/// Draws the panel Diagnosis for another program's frame: a button that starts or cancels the diagnosis, an error, and
/// once it is known each cause with its evidence and its proof.
pub fn ui(ui: &mut Ui, model: &mut Model) {
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
        found(ui, &known);
        regions(ui, model, &known);
    });
}

/// Draws, for each light, a button that goes to its largest wrong region in the error picture.
fn regions(ui: &mut Ui, model: &mut Model, diagnosis: &FrameDiagnosis) {
    for (light, found) in diagnosis.lights.iter().enumerate() {
        let Some(worst) = &found.worst else { continue };
        let [x, y] = worst.at;
        let pixels = format::counted(worst.pixels, "pixel");
        let kind = worst.kind.name().replace('_', " ");
        let words = format!("Go to the largest region of {}: {pixels} of {kind} at {x}, {y}", format::light(light));
        ui.add_space(4.0);
        let button = ui.add(egui::Button::new(words).wrap());
        if button.on_hover_text("Pick a pixel of it in the error picture, and show it large").clicked() {
            let [left, top, right, bottom] = worst.bounds;
            model.view.light = light;
            model.choose_picture(PictureKind::Error);
            model.go_to(worst.at, (right - left).max(bottom - top) + 1);
        }
    }
}

fn found(ui: &mut Ui, diagnosis: &FrameDiagnosis) {
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
    for cause in diagnosis.causes.iter().filter(|cause| cause.proof != Proof::NotIt) {
        ui.add_space(4.0);
        ui.add(egui::Label::new(RichText::new(cause.title()).strong()).wrap());
        ui.add(egui::Label::new(format!("{}.", cause.evidence.sentence)).wrap());
        ui.add(egui::Label::new(theme::note(cause.meaning())).wrap());
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
