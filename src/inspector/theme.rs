//! Colours, spacing and type, in one place.

use crate::plan::Part;
use egui::{Color32, FontFamily, FontId, Margin, RichText, Stroke, TextStyle, Ui};

pub(super) const BACKGROUND: Color32 = Color32::from_rgb(0x14, 0x16, 0x1b);
pub(super) const PANEL: Color32 = Color32::from_rgb(0x1b, 0x1e, 0x25);
pub(super) const RAISED: Color32 = Color32::from_rgb(0x23, 0x27, 0x30);
pub(super) const LINE: Color32 = Color32::from_rgb(0x2d, 0x32, 0x3d);
pub(super) const TEXT: Color32 = Color32::from_rgb(0xd9, 0xdc, 0xe3);
pub(super) const DIM: Color32 = Color32::from_rgb(0x8b, 0x92, 0xa1);
pub(super) const FAINT: Color32 = Color32::from_rgb(0x74, 0x7c, 0x8c);
pub(super) const SELECTED: Color32 = Color32::from_rgb(0x5a, 0xa9, 0xe6);
pub(super) const SELECTED_ROW: Color32 = Color32::from_rgb(0x22, 0x34, 0x4a);
pub(super) const FAILED: Color32 = Color32::from_rgb(0xe0, 0x70, 0x3a);

/// All spaces are multiples of it, in points.
pub(super) const SPACE: f32 = 4.0;
pub(super) const ROW: f32 = 24.0;
pub(super) const PASS_ROW: f32 = 44.0;
const SIZE: f32 = 12.5;
const SMALL_SIZE: f32 = 11.5;

/// The colour of a part of the frame's geometry, the same everywhere.
pub(super) fn part_color(part: Part) -> Color32 {
    match part {
        Part::Side => Color32::from_rgb(0x1f, 0xae, 0x84),
        Part::LightCap => Color32::from_rgb(0xf0, 0xe4, 0x42),
        Part::DarkCap => Color32::from_rgb(0x7a, 0x86, 0xff),
        Part::PlanarShadow => Color32::from_rgb(0x46, 0x55, 0x7d),
        Part::Receiver => Color32::from_rgb(0xf2, 0xd1, 0x6b),
        Part::Surface | Part::Map => DIM,
    }
}

/// Gives a context the inspector's look.
pub fn install(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        let font = |size, family| FontId::new(size, family);
        style.text_styles = [
            (TextStyle::Body, font(SIZE, FontFamily::Proportional)),
            (TextStyle::Button, font(SIZE, FontFamily::Proportional)),
            (TextStyle::Heading, font(SIZE, FontFamily::Proportional)),
            (TextStyle::Monospace, font(SMALL_SIZE, FontFamily::Monospace)),
            (TextStyle::Small, font(SMALL_SIZE, FontFamily::Proportional)),
        ]
        .into();
        style.spacing.item_spacing = egui::vec2(SPACE * 2.0, SPACE);
        style.spacing.button_padding = egui::vec2(SPACE * 2.0, SPACE);
        style.spacing.interact_size = egui::vec2(ROW, ROW);
        style.animation_time = 0.0;
        let visuals = &mut style.visuals;
        *visuals = egui::Visuals::dark();
        visuals.panel_fill = PANEL;
        visuals.window_fill = PANEL;
        visuals.window_stroke = Stroke::new(1.0, LINE);
        visuals.extreme_bg_color = BACKGROUND;
        visuals.faint_bg_color = RAISED;
        visuals.hyperlink_color = SELECTED;
        visuals.selection.bg_fill = SELECTED_ROW;
        visuals.selection.stroke = Stroke::new(1.0, SELECTED);
        visuals.weak_text_color = Some(DIM);
        let widgets = &mut visuals.widgets;
        widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
        widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
        for widget in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active, &mut widgets.open] {
            widget.fg_stroke = Stroke::new(1.0, TEXT);
            widget.bg_fill = RAISED;
            widget.weak_bg_fill = RAISED;
            widget.bg_stroke = Stroke::new(1.0, LINE);
            widget.expansion = 0.0;
        }
        widgets.hovered.bg_stroke = Stroke::new(1.0, DIM);
    });
}

/// Of the top, message and status bars.
pub(super) fn bar_frame() -> egui::Frame {
    egui::Frame::new().fill(PANEL).inner_margin(Margin::symmetric(SPACE as i8 * 2, SPACE as i8))
}

/// A heading by weight, not by size.
pub(super) fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(SPACE);
    ui.label(RichText::new(text).strong().color(TEXT));
}

/// A value: monospaced.
pub(super) fn number(text: impl Into<String>) -> RichText {
    RichText::new(text).monospace().color(TEXT)
}

/// Words that stand back.
pub(super) fn dim(text: impl Into<String>) -> RichText {
    RichText::new(text).small().color(DIM)
}

/// Words that stand further back.
pub(super) fn faint(text: impl Into<String>) -> RichText {
    RichText::new(text).small().color(FAINT)
}

/// A square of a meaning's colour beside its name.
pub(super) fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(SPACE * 2.5, SPACE * 2.5), egui::Sense::hover());
    ui.painter().rect(rect, 2.0, color, Stroke::new(1.0, LINE), egui::StrokeKind::Inside);
}

/// A whole number with thin spaces between thousands.
pub(super) fn thousands(value: u64) -> String {
    let digits = value.to_string();
    let mut out = String::with_capacity(digits.len() * 2);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index) % 3 == 0 {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    out
}

/// A number with about four significant digits.
pub(super) fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_and_short() {
        assert_eq!(thousands(0), "0");
        assert_eq!(thousands(1234567).replace('\u{2009}', " "), "1 234 567");
        assert_eq!(short(13.482), "13.48");
        assert_eq!(short(0.0037086), "0.003709");
        assert_eq!(short(1.1e-6), "1.10e-6");
        assert_eq!(short(256_525.0), "256525");
    }
}
