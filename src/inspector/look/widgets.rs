//! Small widgets that several panels are made of.

use super::theme;
use egui::{Align2, CornerRadius, Response, RichText, Stroke, Ui, pos2, vec2};

/// Buttons side by side in one frame, of which one is chosen: label and explanation of each.
/// Returns the one that was clicked.
pub fn segments(ui: &mut Ui, labels: &[(&str, &str)], chosen: Option<usize>) -> Option<usize> {
    let mut clicked = None;
    let frame = egui::Frame::new()
        .fill(theme::of(ui).raised)
        .stroke(Stroke::new(1.0, theme::of(ui).line))
        .corner_radius(CornerRadius::same(4));
    frame.show(ui, |ui| {
        // Laid out left to right whatever surrounds them.
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            for (index, (label, explanation)) in labels.iter().enumerate() {
                let is_chosen = chosen == Some(index);
                let color = if is_chosen { theme::of(ui).text } else { theme::of(ui).dim };
                let fill = if is_chosen { theme::of(ui).selected_row } else { theme::of(ui).raised };
                let text = RichText::new(*label).color(color);
                let button = egui::Button::selectable(is_chosen, text)
                    .fill(fill)
                    .stroke(Stroke::NONE)
                    .corner_radius(CornerRadius::same(3))
                    .min_size(vec2(0.0, theme::ROW_HEIGHT - 2.0));
                if ui.add(button).on_hover_text(*explanation).clicked() {
                    clicked = Some(index);
                }
            }
        });
    });
    clicked
}

/// A widget of the pass tree keeps the arrows: they step, and do not move the focus.
pub fn keep_arrows(ui: &Ui, response: &Response) {
    if response.has_focus() {
        let arrows =
            egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..egui::EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    }
}

/// Words on a plate of the ground's colour, so that they can be read over anything.
pub fn plate(
    painter: &egui::Painter,
    at: egui::Pos2,
    align: Align2,
    text: &str,
    is_number: bool,
    colors: &theme::Theme,
) {
    let font =
        if is_number { theme::number_font(theme::SMALL_SIZE) } else { egui::FontId::proportional(theme::SMALL_SIZE) };
    let galley = painter.layout_no_wrap(text.to_owned(), font, colors.text);
    let place = align.anchor_size(pos2(at.x.round(), at.y.round()), galley.size());
    painter.rect_filled(place.expand2(vec2(3.0, 0.0)), CornerRadius::same(2), colors.background.gamma_multiply(0.8));
    painter.galley(place.min, galley, colors.text);
}
