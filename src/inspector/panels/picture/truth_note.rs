//! The note over the picture while truth or error is chosen and not known: how far the tracing is, or why there is
//! none.

use crate::ask::{QuestionKind, TruthOf};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::panels::picture::legend;
use crate::reading::picture_view::{ShownPicture, has_truth};
use egui::{Rect, RichText, Sense, Ui, UiBuilder, pos2, vec2};

/// Width of the note, points.
const WIDTH: f32 = 264.0;

/// Draws a note about the truth that is awaited into the upper left corner of `rect`; `shown` is the picture that is
/// shown meanwhile. Draws nothing where no truth is wanted or it is known.
pub fn ui(ui: &mut Ui, model: &mut Model, rect: Rect, shown: &ShownPicture) {
    let is_known = model.frame.capture.as_ref().is_some_and(|capture| has_truth(capture));
    if !model.view.wants_truth() || is_known {
        return;
    }
    let width = WIDTH.min(rect.width() - 24.0 - legend::space_beside(rect, shown)).max(96.0);
    let place = Rect::from_min_size(pos2(rect.left() + 12.0, rect.top() + 12.0), vec2(width, rect.height()));
    // Senses clicks, so that they do not reach the picture underneath.
    let builder = UiBuilder::new().max_rect(place).sense(Sense::CLICK | Sense::DRAG).id_salt("truth note");
    ui.scope_builder(builder, |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.set_width(width - 16.0);
            contents(ui, model, shown);
        });
    });
}

fn contents(ui: &mut Ui, model: &mut Model, shown: &ShownPicture) {
    if !model.can_ask() {
        ui.add(egui::Label::new("This folder has no truth: capture it with --truth.").wrap());
        return;
    }
    let reply = model.answers.of(TruthOf {});
    if let Some(reason) = reply.failed {
        let text = format!("× There is no truth: {reason}");
        ui.add(egui::Label::new(RichText::new(text).color(theme::of(ui).error)).wrap());
        ask_again(ui, model, "Try again");
    } else if reply.is_cancelled {
        theme::heading(ui, "The truth was not traced.");
        ask_again(ui, model, "Trace it");
    } else {
        // Where it has not been asked for yet, it will be before this frame ends.
        let (done, of) = reply.steps().unwrap_or_default();
        tracing(ui, model, shown, done as f32 / of.max(1) as f32);
    }
}

fn tracing(ui: &mut Ui, model: &mut Model, shown: &ShownPicture, share: f32) {
    theme::heading(ui, &format!("The truth is being traced … {:.0} %", share * 100.0));
    ui.horizontal(|ui| {
        if ui.button("Cancel").on_hover_text("Stop tracing the truth").clicked() {
            model.cancel(QuestionKind::TruthOf);
        }
        let bar = egui::ProgressBar::new(share).desired_width(ui.available_width()).desired_height(8.0);
        ui.add(bar).accessible_name("Tracing");
    });
    let meanwhile = if shown.is_older {
        "Shown is that of the frame before.".to_owned()
    } else {
        format!("Shown until then: {}.", shown.title)
    };
    ui.add(egui::Label::new(theme::note(meanwhile)).wrap());
}

fn ask_again(ui: &mut Ui, model: &mut Model, words: &str) {
    if ui.button(words).on_hover_text("Trace the truth of this frame").clicked() {
        model.answers.try_again(QuestionKind::TruthOf);
    }
}
