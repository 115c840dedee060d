//! Colours, spacing and type of every panel (dark theme).
//!
//! One accent means "selected" and nothing else; the same colour means the same thing in every
//! panel. Palettes of the pictures themselves are in `palette.rs`.

use crate::plan::Part;
use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, RichText, Stroke, TextStyle, Ui, vec2};

/// Behind everything.
pub const BACKGROUND: Color32 = Color32::from_rgb(0x14, 0x16, 0x1b);
/// A panel.
pub const PANEL: Color32 = Color32::from_rgb(0x1b, 0x1e, 0x25);
/// A button or card on a panel.
pub const RAISED: Color32 = Color32::from_rgb(0x23, 0x27, 0x30);
/// Separators and outlines.
pub const LINE: Color32 = Color32::from_rgb(0x2d, 0x32, 0x3d);
/// Words that matter.
pub const TEXT: Color32 = Color32::from_rgb(0xd9, 0xdc, 0xe3);
/// Words beside them.
pub const DIM: Color32 = Color32::from_rgb(0x8b, 0x92, 0xa1);
/// What is not there, or did not change.
pub const FAINT: Color32 = Color32::from_rgb(0x5d, 0x64, 0x73);
/// The accent: selected.
pub const SELECTED: Color32 = Color32::from_rgb(0x5a, 0xa9, 0xe6);
/// The outline of what has the keyboard, apart from the accent.
pub const FOCUS: Color32 = Color32::from_rgb(0x8b, 0x92, 0xa1);
/// A selected row.
pub const SELECTED_ROW: Color32 = Color32::from_rgb(0x22, 0x34, 0x4a);
/// An error message's bar.
pub const ERROR: Color32 = Color32::from_rgb(0xe0, 0x70, 0x3a);

/// A test that was passed.
pub const PASSED: Color32 = Color32::from_rgb(0x2f, 0xb5, 0x8a);
/// A test that failed.
pub const FAILED: Color32 = Color32::from_rgb(0xe0, 0x70, 0x3a);
/// A test that was decided in advance, or not asked.
pub const DECIDED: Color32 = Color32::from_rgb(0x7b, 0x82, 0x90);
/// The light reaches it.
pub const LIT: Color32 = Color32::from_rgb(0xf2, 0xd1, 0x6b);
/// A count goes up by one.
pub const COUNT_UP: Color32 = Color32::from_rgb(0xe0, 0x70, 0x3a);
/// A count goes down by one.
pub const COUNT_DOWN: Color32 = Color32::from_rgb(0x56, 0xb4, 0xe9);

/// Height of a row of text and small widgets, in points.
pub const ROW_HEIGHT: f32 = 24.0;
/// Height of a pass with its thumbnail, in points.
pub const PASS_ROW_HEIGHT: f32 = 44.0;
/// Size of words, in points.
pub const TEXT_SIZE: f32 = 12.5;
/// Size of numbers and side notes, in points.
pub const SMALL_SIZE: f32 = 11.5;

/// The colour of a part of a shadow volume; `None` for what has none of its own.
#[must_use]
pub fn part_color(part: Part) -> Option<Color32> {
    match part {
        Part::Side => Some(Color32::from_rgb(0x1f, 0xae, 0x84)),
        Part::LightCap => Some(Color32::from_rgb(0xf0, 0xe4, 0x42)),
        Part::DarkCap => Some(Color32::from_rgb(0x7a, 0x86, 0xff)),
        Part::Surface | Part::Receiver | Part::PlanarShadow | Part::Map => None,
    }
}

/// Gives `ctx` the colours, spacing and type of the inspector.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.style_mut_of(egui::Theme::Dark, |style| {
        style.text_styles = [
            (TextStyle::Body, FontId::proportional(TEXT_SIZE)),
            (TextStyle::Button, FontId::proportional(TEXT_SIZE)),
            (TextStyle::Heading, FontId::proportional(TEXT_SIZE)),
            (TextStyle::Small, FontId::proportional(SMALL_SIZE)),
            (TextStyle::Monospace, FontId::monospace(SMALL_SIZE)),
        ]
        .into();
        style.animation_time = 0.0;
        apply_spacing(&mut style.spacing);
        apply_colors(&mut style.visuals);
    });
}

fn apply_spacing(spacing: &mut egui::style::Spacing) {
    spacing.item_spacing = vec2(8.0, 4.0);
    spacing.button_padding = vec2(8.0, 2.0);
    spacing.interact_size.y = ROW_HEIGHT;
    spacing.window_margin = Margin::same(12);
    spacing.menu_margin = Margin::same(4);
    spacing.slider_rail_height = 4.0;
    spacing.scroll = egui::style::ScrollStyle::thin();
}

fn apply_colors(visuals: &mut egui::Visuals) {
    visuals.panel_fill = PANEL;
    visuals.window_fill = PANEL;
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.extreme_bg_color = BACKGROUND;
    visuals.faint_bg_color = RAISED;
    visuals.weak_text_color = Some(DIM);
    visuals.hyperlink_color = SELECTED;
    visuals.error_fg_color = ERROR;
    visuals.selection.bg_fill = SELECTED_ROW;
    visuals.selection.stroke = Stroke::new(1.0, SELECTED);
    visuals.window_shadow = egui::Shadow::NONE;
    visuals.slider_trailing_fill = true;
    visuals.window_corner_radius = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    let states = [
        (&mut widgets.noninteractive, PANEL, LINE, TEXT),
        (&mut widgets.inactive, RAISED, LINE, TEXT),
        (&mut widgets.hovered, LINE, FAINT, TEXT),
        (&mut widgets.active, SELECTED_ROW, SELECTED, TEXT),
        (&mut widgets.open, RAISED, FAINT, TEXT),
    ];
    for (widget, fill, outline, text) in states {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, outline);
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
}

/// A number or an address: the monospaced face.
#[must_use]
pub fn number(text: impl Into<String>) -> RichText {
    RichText::new(text).font(number_font(SMALL_SIZE))
}

/// The monospaced face in a size, in points.
#[must_use]
pub fn number_font(size: f32) -> FontId {
    FontId::new(size, FontFamily::Monospace)
}

/// A side note.
#[must_use]
pub fn note(text: impl Into<String>) -> RichText {
    RichText::new(text).size(SMALL_SIZE).color(DIM)
}

/// A heading: told apart by weight, not by size. The bundled face has one weight, so its
/// strokes are thickened by drawing the text twice, half a point apart.
pub fn heading(ui: &mut Ui, text: &str) -> egui::Response {
    let response = ui.label(RichText::new(text).color(TEXT));
    let galley = ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(TEXT_SIZE), TEXT);
    // Only where it is on one line: a wrapped heading stays as it is.
    if galley.size().x <= response.rect.width() + 1.0 {
        ui.painter().galley(response.rect.min + vec2(0.4, 0.0), galley, TEXT);
    }
    response
}

/// One line of text, cut off with an ellipsis where there is no room.
pub fn line(ui: &Ui, at: egui::Pos2, room: f32, text: &str, style: TextStyle, color: Color32) {
    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), style.resolve(ui.style()), color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(8.0));
    let galley = ui.painter().layout_job(job);
    ui.painter().galley(at, galley, color);
}

/// Two words on one line, the second dim, cut off with an ellipsis; `at` is its left end, half way up.
pub fn two_inks(ui: &Ui, at: egui::Pos2, room: f32, words: [&str; 2], color: Color32) {
    let mut job = egui::text::LayoutJob::default();
    let format = |color| egui::TextFormat::simple(FontId::proportional(SMALL_SIZE), color);
    job.append(words[0], 0.0, format(color));
    if !words[1].is_empty() {
        job.append(words[1], 4.0, format(DIM));
    }
    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(8.0));
    let galley = ui.painter().layout_job(job);
    ui.painter().galley(at - vec2(0.0, galley.size().y / 2.0), galley, color);
}

/// What is behind a row that can be clicked: the accent where it is selected.
pub fn row_background(ui: &Ui, rect: egui::Rect, is_selected: bool, response: &egui::Response) {
    let painter = ui.painter();
    if is_selected {
        painter.rect_filled(rect, CornerRadius::ZERO, SELECTED_ROW);
        let bar = egui::Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
        painter.rect_filled(bar, CornerRadius::ZERO, SELECTED);
    } else if response.hovered() {
        painter.rect_filled(rect, CornerRadius::ZERO, RAISED);
    }
    if response.has_focus() {
        painter.rect_stroke(rect, CornerRadius::ZERO, Stroke::new(1.0, FOCUS), egui::StrokeKind::Inside);
    }
}

/// A card on a panel.
pub fn card() -> egui::Frame {
    egui::Frame::new()
        .fill(RAISED)
        .stroke(Stroke::new(1.0, LINE))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::same(8))
}

/// A frame around the contents of a docked panel.
pub fn panel_frame() -> egui::Frame {
    egui::Frame::new().fill(PANEL).inner_margin(Margin::same(8))
}

/// A small square of colour, as in legends.
pub fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), egui::Sense::hover());
    ui.painter().rect(rect, CornerRadius::same(2), color, Stroke::new(1.0, FAINT), egui::StrokeKind::Inside);
}
