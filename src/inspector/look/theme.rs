//! Colours, spacing and type of every panel, in a dark and a light theme.
//!
//! One accent means "selected" and nothing else; the same colour means the same thing in every
//! panel and in both themes. Palettes of the pictures themselves are in `palette.rs`.

use crate::plan::DrawPart;
use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, RichText, Stroke, TextStyle, Ui, vec2};
use std::sync::Arc;

/// The colours of a theme, by what they mean.
#[derive(Debug, PartialEq, Eq)]
pub struct Theme {
    /// The window's background.
    pub background: Color32,
    /// A panel's background.
    pub panel: Color32,
    /// The background of a button or card on a panel.
    pub raised: Color32,
    /// Separators and outlines.
    pub line: Color32,
    /// The outline of what can be operated: a box, a field, a button.
    pub control: Color32,
    /// Important words.
    pub text: Color32,
    /// Words that accompany them.
    pub dim: Color32,
    /// Words for what is absent, or did not change.
    pub faint: Color32,
    /// The accent, which means selected.
    pub selected: Color32,
    /// The outline of the widget with the keyboard focus, distinct from the accent.
    pub focus: Color32,
    /// A selected row.
    pub selected_row: Color32,
    /// An error message's bar.
    pub error: Color32,
    /// A test that was passed.
    pub passed: Color32,
    /// A test that failed.
    pub failed: Color32,
    /// A test whose result is fixed in advance, or that is not done.
    pub decided: Color32,
    /// Lit by a light.
    pub lit: Color32,
    /// A count goes up by one.
    pub count_up: Color32,
    /// A count goes down by one.
    pub count_down: Color32,
    /// The side of a shadow volume.
    pub side: Color32,
    /// The cap of a shadow volume near the light.
    pub light_cap: Color32,
    /// The cap of a shadow volume away from the light.
    pub dark_cap: Color32,
    /// What the stop of a tour speaks of.
    pub tour: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// Light text on a dark background.
pub const DARK: Theme = Theme {
    background: rgb(0x14161b),
    panel: rgb(0x1b1e25),
    raised: rgb(0x232730),
    line: rgb(0x2d323d),
    control: rgb(0x6b7280),
    text: rgb(0xd9dce3),
    dim: rgb(0xaab1c0),
    faint: rgb(0x939aa9),
    selected: rgb(0x5aa9e6),
    focus: rgb(0xaab1c0),
    selected_row: rgb(0x22344a),
    error: rgb(0xe0703a),
    passed: rgb(0x2fb58a),
    failed: rgb(0xe0703a),
    decided: rgb(0x8b92a1),
    lit: rgb(0xf2d16b),
    count_up: rgb(0xe0703a),
    count_down: rgb(0x56b4e9),
    side: rgb(0x1fae84),
    light_cap: rgb(0xf0e442),
    dark_cap: rgb(0x7a86ff),
    tour: rgb(0xe58fd6),
};

/// Dark text on a light background: the hues of the dark theme, darker, so that words in them can be read.
pub const LIGHT: Theme = Theme {
    background: rgb(0xe4e7ec),
    panel: rgb(0xf6f7f9),
    raised: rgb(0xffffff),
    line: rgb(0xcdd2db),
    control: rgb(0x767e8b),
    text: rgb(0x1c2029),
    dim: rgb(0x4a5160),
    faint: rgb(0x5e6675),
    selected: rgb(0x12609f),
    focus: rgb(0x4a5160),
    selected_row: rgb(0xd5e6f5),
    error: rgb(0xa84310),
    passed: rgb(0x0b6b4d),
    failed: rgb(0xa84310),
    decided: rgb(0x5a6170),
    lit: rgb(0x7a5a00),
    count_up: rgb(0xa84310),
    count_down: rgb(0x12609f),
    side: rgb(0x0b6b4d),
    light_cap: rgb(0x8a7d00),
    dark_cap: rgb(0x4450d0),
    tour: rgb(0xa02a8c),
};

/// Returns the theme that `ui` is drawn in.
pub fn of(ui: &Ui) -> &'static Theme {
    in_visuals(ui.visuals())
}

/// Returns the theme that goes with egui's own colours.
pub fn in_visuals(visuals: &egui::Visuals) -> &'static Theme {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

impl Theme {
    /// Returns the colour of a part of a shadow volume; `None` for parts that have no colour of their own.
    pub fn part(&self, part: DrawPart) -> Option<Color32> {
        match part {
            DrawPart::Side => Some(self.side),
            DrawPart::LightCap | DrawPart::Caps => Some(self.light_cap),
            DrawPart::DarkCap => Some(self.dark_cap),
            DrawPart::Surface | DrawPart::Receiver | DrawPart::PlanarShadow | DrawPart::Map => None,
        }
    }
}

/// Height of a row of text and small widgets, in points.
pub const ROW_HEIGHT: f32 = 24.0;
/// Height of a pass with its thumbnail, in points.
pub const PASS_ROW_HEIGHT: f32 = 44.0;
/// How much of its colour something that can't be operated keeps: it recedes, and its words can be read.
const DISABLED_ALPHA: f32 = 0.65;
/// Size of words, in points.
pub const TEXT_SIZE: f32 = 12.5;
/// Size of numbers and side notes, in points.
pub const SMALL_SIZE: f32 = 11.5;

/// Sets colours, spacing and fonts of the inspector in `ctx`, for egui's dark and light theme; which of the two is in
/// use does not change.
pub fn apply(ctx: &egui::Context) {
    for (egui_theme, theme) in [(egui::Theme::Dark, &DARK), (egui::Theme::Light, &LIGHT)] {
        ctx.style_mut_of(egui_theme, |style| apply_style(style, theme));
    }
}

fn apply_style(style: &mut egui::Style, theme: &Theme) {
    style.text_styles = [
        (TextStyle::Body, FontId::proportional(TEXT_SIZE)),
        (TextStyle::Button, FontId::proportional(TEXT_SIZE)),
        (TextStyle::Heading, FontId::proportional(TEXT_SIZE)),
        (TextStyle::Small, FontId::proportional(SMALL_SIZE)),
        (TextStyle::Monospace, FontId::monospace(SMALL_SIZE)),
    ]
    .into();
    style.animation_time = 0.0;
    // As numbers are written elsewhere; what is typed may have a hyphen.
    style.number_formatter = egui::style::NumberFormatter::new(|value, decimals| {
        egui::emath::format_with_decimals_in_range(value, decimals).replace('-', "−")
    });
    apply_spacing(&mut style.spacing);
    apply_colors(&mut style.visuals, theme);
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

fn apply_colors(visuals: &mut egui::Visuals, theme: &Theme) {
    visuals.disabled_alpha = DISABLED_ALPHA;
    visuals.panel_fill = theme.panel;
    visuals.window_fill = theme.panel;
    visuals.window_stroke = Stroke::new(1.0, theme.line);
    visuals.extreme_bg_color = theme.background;
    visuals.faint_bg_color = theme.raised;
    visuals.weak_text_color = Some(theme.dim);
    visuals.hyperlink_color = theme.selected;
    visuals.error_fg_color = theme.error;
    visuals.selection.bg_fill = theme.selected_row;
    visuals.selection.stroke = Stroke::new(1.0, theme.selected);
    visuals.window_shadow = egui::Shadow::NONE;
    visuals.slider_trailing_fill = true;
    visuals.window_corner_radius = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    let states = [
        (&mut widgets.noninteractive, theme.panel, theme.line, theme.text),
        (&mut widgets.inactive, theme.raised, theme.control, theme.text),
        (&mut widgets.hovered, theme.line, theme.faint, theme.text),
        (&mut widgets.active, theme.selected_row, theme.selected, theme.text),
        (&mut widgets.open, theme.raised, theme.faint, theme.text),
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

/// Outlines the boxes to tick of a menu, in which egui outlines nothing: an empty one would not be seen.
pub fn outline_boxes(ui: &mut Ui) {
    let theme = of(ui);
    let widgets = &mut ui.visuals_mut().widgets;
    for (widget, outline) in [
        (&mut widgets.inactive, theme.control),
        (&mut widgets.hovered, theme.faint),
        (&mut widgets.active, theme.selected),
    ] {
        widget.bg_stroke = Stroke::new(1.0, outline);
    }
}

/// Returns text in the monospaced face, for numbers and addresses.
pub fn number(text: impl Into<String>) -> RichText {
    RichText::new(text).font(number_font(SMALL_SIZE))
}

/// Returns the font id of the monospaced face at a size in points.
pub fn number_font(size: f32) -> FontId {
    FontId::new(size, FontFamily::Monospace)
}

/// Returns the word on a switch of a toolbar, bright while the switch is on and dim while it is off.
pub fn switch_word(ui: &Ui, word: &str, is_on: bool) -> RichText {
    RichText::new(word).color(if is_on { of(ui).text } else { of(ui).dim })
}

/// Returns the text of a side note.
pub fn note(text: impl Into<String>) -> RichText {
    RichText::new(text).size(SMALL_SIZE).weak()
}

/// Draws a heading: it stands out by weight, not by size. The bundled face has one weight, so its strokes are thickened
/// by drawing the text twice, half a point apart.
pub fn heading(ui: &mut Ui, text: &str) -> egui::Response {
    let response = ui.label(RichText::new(text).color(of(ui).text));
    let galley = ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(TEXT_SIZE), of(ui).text);
    // Only where it is on one line: a wrapped heading stays as it is.
    if galley.size().x <= response.rect.width() + 1.0 {
        ui.painter().galley(response.rect.min + vec2(0.4, 0.0), galley, of(ui).text);
    }
    response
}

/// Draws one line of text with its upper left corner at `at`, in `width` points (at least 8). Where it does not fit, an
/// ellipsis takes the place of its end. Names of passes, draws and debug groups are drawn by [`name_line`].
pub fn line(ui: &Ui, at: egui::Pos2, width: f32, text: &str, style: TextStyle, color: Color32) {
    ui.painter().galley(at, laid(ui, text, width, &style.resolve(ui.style())), color);
}

/// Draws a name as [`line`] draws a text; but where it does not fit, an ellipsis takes the place of its middle, so that
/// names that begin alike stay apart. Of a name such as `dark cap of torus 2` it takes the place of the end of `dark cap
/// of`, if `torus 2`, which tells lines apart, then fits whole.
pub fn name_line(ui: &Ui, at: egui::Pos2, width: f32, name: &str, style: TextStyle, color: Color32) {
    let font = style.resolve(ui.style());
    let split = |place: usize| [&name[..place + " of".len()], &name[place + " of ".len()..]];
    let fits = |[_, caster]: &[&str; 2]| width_of(ui, caster, &font) <= width - LEAST_HEAD - WORD_GAP;
    let of_caster = name.find(" of ").map(split).filter(|words| width_of(ui, name, &font) > width && fits(words));
    for (place, galley) in two_parts(ui, width, of_caster.unwrap_or([name, ""]), &font) {
        ui.painter().galley(at + vec2(place, 0.0), galley, color);
    }
}

/// Returns one line of text as it is drawn in `width` points (at least 8), in the colour that is given then, with an
/// ellipsis where its end does not fit.
fn laid(ui: &Ui, text: &str, width: f32, font: &FontId) -> Arc<egui::Galley> {
    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font.clone(), Color32::PLACEHOLDER);
    job.wrap = egui::text::TextWrapping::truncate_at_width(width.max(8.0));
    ui.painter().layout_job(job)
}

/// Returns the width of a whole text on one line, points.
fn width_of(ui: &Ui, text: &str, font: &FontId) -> f32 {
    laid(ui, text, f32::INFINITY, font).size().x
}

/// Returns two texts as they are drawn one after the other on one line, in `width` points, each with its place from the
/// left; an empty second one is left out. Where both do not fit, an ellipsis takes the place of the first one's end, so
/// that the second, the caster, can be read; where the last one alone does not, of its middle.
fn two_parts(ui: &Ui, width: f32, [first, second]: [&str; 2], font: &FontId) -> Vec<(f32, Arc<egui::Galley>)> {
    let whole = |text: &str, width: f32| laid(ui, &elided(ui, text, font, width.max(8.0)), f32::INFINITY, font);
    if second.is_empty() {
        return vec![(0.0, whole(first, width))];
    }
    let second = whole(second, width - LEAST_HEAD - WORD_GAP);
    let first = laid(ui, first, width - second.size().x - WORD_GAP, font);
    let place = first.size().x + WORD_GAP;
    vec![(0.0, first), (place, second)]
}

/// Space between two parts of a line that are drawn one after the other, and the least width of the first, points.
const WORD_GAP: f32 = 4.0;
const LEAST_HEAD: f32 = 24.0;

/// Returns a text that fits into `width` points, in a font, with an ellipsis for what does not in its middle: of a path its
/// beginning stays and, longer, its end, which names the file; and names that begin alike stay apart.
pub fn elided(ui: &Ui, text: &str, font: &FontId, width: f32) -> String {
    let fits = |text: &str| width_of(ui, text, font) <= width;
    if fits(text) {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let with = |kept: &usize| {
        let (first, last) = (kept / 3, kept - kept / 3);
        letters[..first].iter().chain(&['…']).chain(&letters[letters.len() - last..]).collect::<String>()
    };
    let kept: Vec<usize> = (0..letters.len()).collect();
    with(&kept.partition_point(|kept| fits(&with(kept))).saturating_sub(1))
}

/// Draws two texts on one line, the first in `color` and the second dim, in `width` points; `at` is the left end, at half
/// height. Where both do not fit, an ellipsis takes the place of the first one's end, so that the second, the caster, can
/// be read; where the last one alone does not, of its middle. An empty second text is left out.
pub fn two_inks(ui: &Ui, at: egui::Pos2, width: f32, words: [&str; 2], color: Color32) {
    let parts = two_parts(ui, width, words, &FontId::proportional(SMALL_SIZE));
    for ((place, galley), ink) in parts.into_iter().zip([color, of(ui).dim]) {
        ui.painter().galley(at + vec2(place, -galley.size().y / 2.0), galley, ink);
    }
}

/// Draws the first of `choices` that fits whole into `width` points, each two texts as [`two_inks`] draws them; the last one
/// where none does. Returns its index.
pub fn two_inks_that_fit(ui: &Ui, at: egui::Pos2, width: f32, choices: &[[&str; 2]], color: Color32) -> usize {
    let font = FontId::proportional(SMALL_SIZE);
    let needed = |text: &str, gap: f32| if text.is_empty() { 0.0 } else { gap + width_of(ui, text, &font) };
    let fits = |[first, second]: &&[&str; 2]| needed(first, 0.0) + needed(second, WORD_GAP) <= width;
    let chosen = choices.iter().position(|choice| fits(&choice)).unwrap_or(choices.len().saturating_sub(1));
    if let Some(words) = choices.get(chosen) {
        two_inks(ui, at, width, *words, color);
    }
    chosen
}

/// Draws the background of a row that can be clicked: the accent and a bar where it is selected, a lighter one where it
/// is under the pointer, nothing otherwise; and an outline while it has the focus.
pub fn row_background(ui: &Ui, rect: egui::Rect, is_selected: bool, response: &egui::Response) {
    let painter = ui.painter();
    if is_selected {
        painter.rect_filled(rect, CornerRadius::ZERO, of(ui).selected_row);
        let bar = egui::Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
        painter.rect_filled(bar, CornerRadius::ZERO, of(ui).selected);
    } else if response.hovered() {
        painter.rect_filled(rect, CornerRadius::ZERO, of(ui).raised);
    }
    if response.has_focus() {
        painter.rect_stroke(rect, CornerRadius::ZERO, Stroke::new(1.0, of(ui).focus), egui::StrokeKind::Inside);
    }
}

/// Returns the frame of a card on a panel.
pub fn card(ui: &Ui) -> egui::Frame {
    egui::Frame::new()
        .fill(of(ui).raised)
        .stroke(Stroke::new(1.0, of(ui).line))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::same(8))
}

/// Returns the frame of a dialog over everything.
pub fn dialog(ctx: &egui::Context) -> egui::Frame {
    egui::Frame::window(&ctx.global_style()).corner_radius(CornerRadius::same(4)).inner_margin(Margin::same(16))
}

/// Draws a square of colour with an outline, 10 points a side, as in legends.
pub fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), egui::Sense::hover());
    ui.painter().rect(rect, CornerRadius::same(2), color, Stroke::new(1.0, of(ui).faint), egui::StrokeKind::Inside);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast ratio of two colours by WCAG 2.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let light = |color: Color32| {
            let [red, green, blue, _] = color.to_array().map(|byte| {
                let share = f64::from(byte) / 255.0;
                if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
            });
            0.2126 * red + 0.7152 * green + 0.0722 * blue + 0.05
        };
        let (a, b) = (light(a), light(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn words_can_be_read_on_every_ground_of_both_themes() {
        for (name, theme) in [("dark", &DARK), ("light", &LIGHT)] {
            let inks = [
                ("text", theme.text),
                ("dim", theme.dim),
                ("faint", theme.faint),
                ("error", theme.error),
                ("passed", theme.passed),
                ("failed", theme.failed),
                ("lit", theme.lit),
                ("count up", theme.count_up),
                ("count down", theme.count_down),
                ("decided", theme.decided),
                ("selected", theme.selected),
            ];
            for (ground_name, ground) in [("panel", theme.panel), ("raised", theme.raised)] {
                for (ink_name, ink) in inks {
                    let found = contrast(ink, ground);
                    assert!(found >= 4.5, "{name}: {ink_name} on {ground_name}: {found:.2}");
                }
                let disabled = contrast(ground.lerp_to_gamma(theme.text, DISABLED_ALPHA), ground);
                assert!(disabled >= 4.5, "{name}: what can't be pressed on {ground_name}: {disabled:.2}");
            }
            assert!(contrast(theme.text, theme.selected_row) >= 4.5, "{name}: text on a selected row");
        }
    }

    #[test]
    fn what_can_be_operated_is_outlined_on_every_ground_of_both_themes() {
        for (name, theme) in [("dark", &DARK), ("light", &LIGHT)] {
            let mut visuals = egui::Visuals::default();
            apply_colors(&mut visuals, theme);
            for ground in [theme.background, theme.panel, theme.raised] {
                for state in [visuals.widgets.inactive, visuals.widgets.hovered, visuals.widgets.active] {
                    let found = contrast(state.bg_stroke.color, ground);
                    assert!(found >= 3.0, "{name}: an outline on {ground:?}: {found:.2}");
                }
                assert!(contrast(theme.focus, ground) >= 3.0, "{name}: the focus on {ground:?}");
            }
        }
    }

    #[test]
    fn parts_of_a_volume_can_be_distinguished_from_the_ground_of_both_themes() {
        for theme in [&DARK, &LIGHT] {
            for ink in [theme.side, theme.light_cap, theme.dark_cap] {
                assert!(contrast(ink, theme.panel) >= 3.0);
            }
        }
    }
}
