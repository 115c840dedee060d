//! Errors as bars under the top bar: text with its mend, until dismissed.

use super::state::State;
use super::theme;
use egui::{CornerRadius, Margin, RichText, Stroke, Ui};

/// Draws a bar for each error.
pub fn ui(ui: &mut Ui, state: &mut State) {
    if state.errors.is_empty() {
        return;
    }
    let frame = egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 4));
    egui::Panel::top("messages").frame(frame).show(ui, |ui| {
        let mut dismissed = None;
        for (index, error) in state.errors.iter().enumerate() {
            if bar(ui, error) {
                dismissed = Some(index);
            }
        }
        if let Some(index) = dismissed {
            state.errors.remove(index);
        }
    });
}

/// One error; true when it is dismissed.
fn bar(ui: &mut Ui, error: &str) -> bool {
    let frame = egui::Frame::new()
        .stroke(Stroke::new(1.0, theme::of(ui).error))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::symmetric(8, 4));
    let contents = |ui: &mut Ui| {
        let dismiss = ui.button("Dismiss").on_hover_text("Hide this message");
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.label(RichText::new("× Error").color(theme::of(ui).error));
            ui.add(egui::Label::new(error).wrap());
        });
        dismiss.clicked()
    };
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    frame
        .show(ui, |ui| ui.allocate_ui_with_layout(egui::vec2(ui.available_width(), 24.0), layout, contents).inner)
        .inner
}
