//! The parts of legends: their title, lines and bars.

use crate::inspector::look::theme;
use crate::reading::format;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use egui::{Color32, CornerRadius, Rect, Sense, Ui, vec2};

/// Returns the legend's title, `Mask, light 1`, for a picture of counts, labels, truth or errors; the words after the
/// kind are those after ` of ` in the picture's title.
pub fn title(shown: &ShownPicture) -> String {
    let of = shown.title.split_once(" of ").map_or(shown.title.as_str(), |(_, of)| of);
    let kind = match shown.kind {
        PictureKind::Count => "Count",
        PictureKind::Mask => "Mask",
        PictureKind::Visibility => "Visibility",
        PictureKind::Truth => "Truth",
        _ => "Error",
    };
    format!("{kind}, {of}")
}

/// Draws a line of the legend: colour, value, number of pixels.
pub fn entry(ui: &mut Ui, color: Color32, name: &str, pixels: u64) -> egui::Response {
    entry_with(ui, name, pixels, |ui| theme::swatch(ui, color))
}

/// Draws a line of a legend with a swatch that the caller draws, the name, and at the right how many pixels have it.
pub fn entry_with(ui: &mut Ui, name: &str, pixels: u64, swatch: impl FnOnce(&mut Ui)) -> egui::Response {
    let line = ui.horizontal(|ui| {
        swatch(ui);
        ui.label(theme::number(name).color(theme::of(ui).text));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(theme::number(format::count(pixels)).color(theme::of(ui).dim));
        });
    });
    line.response
}

/// Draws a bar under a line of the legend, as long as the share that `texels` is of `most`, at least one point.
pub fn bar(ui: &mut Ui, texels: u64, most: u64) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 3.0), Sense::hover());
    let share = texels as f32 / most.max(1) as f32;
    let width = (rect.width() * share).max(1.0);
    ui.painter().rect_filled(rect, CornerRadius::same(1), theme::of(ui).line);
    ui.painter().rect_filled(
        Rect::from_min_size(rect.min, vec2(width, rect.height())),
        CornerRadius::same(1),
        theme::of(ui).dim,
    );
}
