//! Errors and warnings as bars under the top bar: text with how to fix it, until dismissed.

use crate::inspector::action::Action;
use crate::inspector::look::theme;
use crate::inspector::model::{Message, Model, Severity};
use egui::{CornerRadius, Margin, RichText, Stroke, Ui};

/// The largest share of the window's height for messages; more are scrolled to.
const MOST_HEIGHT: f32 = 0.25;

/// Draws the offer to load a changed file again, and a bar for each message, the last one first, which can be dismissed
/// one by one or all at once; nothing where there is neither.
pub fn ui(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    if let Some(file) = model.activity.changed_file.clone() {
        reload(ui, model, &file, actions);
    }
    if model.activity.messages.is_empty() {
        return;
    }
    let frame = egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 4));
    egui::Panel::top("messages").frame(frame).show(ui, |ui| {
        if model.activity.messages.len() > 1 && ui.button("Dismiss all").on_hover_text("Hide all messages").clicked() {
            model.activity.messages.clear();
        }
        let most = ui.ctx().content_rect().height() * MOST_HEIGHT;
        let mut dismissed = None;
        egui::ScrollArea::vertical().max_height(most).auto_shrink([false, true]).show(ui, |ui| {
            // The last one first: it belongs to the latest action.
            for (index, message) in model.activity.messages.iter().enumerate().rev() {
                if bar(ui, message) {
                    dismissed = Some(index);
                }
            }
        });
        if let Some(index) = dismissed {
            model.activity.messages.remove(index);
        }
    });
}

fn reload(ui: &mut Ui, model: &mut Model, file: &str, actions: &mut Vec<Action>) {
    let frame = egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 4));
    egui::Panel::top("reload").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(format!("{file} changed on disk."));
            if ui
                .button("Load it again")
                .on_hover_text("The file's scene, with all that was set here and still has a place in it")
                .clicked()
            {
                actions.push(Action::Reload);
                model.activity.changed_file = None;
            }
            if ui.button("Not now").on_hover_text("Go on with the scene as it is").clicked() {
                model.activity.changed_file = None;
            }
        });
    });
}

/// Draws one message; returns true when it is dismissed.
fn bar(ui: &mut Ui, message: &Message) -> bool {
    let (word, color) = match message.severity {
        Severity::Error => ("× Error", theme::of(ui).error),
        Severity::Warning => ("! Warning", theme::of(ui).dim),
    };
    let frame = egui::Frame::new()
        .stroke(Stroke::new(1.0, color))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::symmetric(8, 4));
    let contents = |ui: &mut Ui| {
        let dismiss = ui.button("Dismiss").on_hover_text("Hide this message");
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.label(RichText::new(word).color(color));
            ui.add(egui::Label::new(&message.text).wrap());
        });
        dismiss.clicked()
    };
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    frame
        .show(ui, |ui| ui.allocate_ui_with_layout(egui::vec2(ui.available_width(), 24.0), layout, contents).inner)
        .inner
}
