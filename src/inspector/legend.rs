//! The legend over the picture's upper right corner: what its colours mean, with counts, and the
//! range of depths.

use super::depth::DepthMeasure;
use super::format;
use super::palette;
use super::picture;
use super::state::State;
use super::theme;
use super::view::{PictureKind, Shown};
use egui::{Color32, CornerRadius, Rect, RichText, Sense, Ui, UiBuilder, pos2, vec2};

/// Width of the legend, points.
const WIDTH: f32 = 168.0;
/// Stencil values that are listed one by one.
const MOST_VALUES: usize = 12;

/// What the legend takes of a picture of this size, points.
#[must_use]
pub fn room(rect: Rect) -> f32 {
    if fits(rect) { WIDTH + 12.0 } else { 0.0 }
}

fn fits(rect: Rect) -> bool {
    rect.width() >= WIDTH * 2.0
}

/// Draws the legend of `shown`; `range` is that of the grey ramp.
pub fn ui(ui: &mut Ui, state: &mut State, rect: Rect, shown: &Shown, range: [f64; 2]) {
    if shown.kind == PictureKind::Color || !fits(rect) {
        return;
    }
    let corner = Rect::from_min_size(pos2(rect.right() - WIDTH - 12.0, rect.top() + 12.0), vec2(WIDTH, rect.height()));
    // Senses clicks, so that they do not reach the picture underneath.
    let builder = UiBuilder::new().max_rect(corner).sense(Sense::click_and_drag()).id_salt("legend");
    ui.scope_builder(builder, |ui| {
        let frame = theme::card().fill(theme::PANEL.gamma_multiply(0.94));
        frame.show(ui, |ui| {
            ui.set_width(WIDTH - 16.0);
            ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
            match shown.kind {
                PictureKind::Stencil => stencil(ui, state, shown),
                PictureKind::Mask => labels(ui, state, shown),
                _ => depth(ui, state, shown, range),
            }
        });
    });
}

fn stencil(ui: &mut Ui, state: &mut State, shown: &Shown) {
    let histogram = state.cache.histogram(&shown.images[0]);
    let counts =
        state.capture.as_ref().is_some_and(|capture| matches!(capture.technique.as_str(), "z-pass" | "z-fail"));
    theme::heading(ui, if counts { "Stencil count" } else { "Stencil value" });
    // 0, 1, 2 … and then −1, −2 …: the order in which people think of them.
    let values = (0..=127).chain((128..=255).rev()).filter(|value| histogram[usize::from(*value)] > 0);
    let values: Vec<u8> = values.collect();
    for value in values.iter().take(MOST_VALUES) {
        entry(ui, palette::stencil(*value), &palette::signed(*value), histogram[usize::from(*value)]);
    }
    if values.len() > MOST_VALUES {
        let pixels: u64 = values[MOST_VALUES..].iter().map(|value| histogram[usize::from(*value)]).sum();
        let more = values.len() - MOST_VALUES;
        ui.label(theme::note(format!("{more} more values · {}", format::count(pixels))));
    }
}

fn labels(ui: &mut Ui, state: &mut State, shown: &Shown) {
    let histogram = state.cache.histogram(&shown.images[0]);
    let title = shown.title.strip_prefix("mask of ").unwrap_or(&shown.title);
    theme::heading(ui, &format!("Mask, {title}"));
    for (value, label) in palette::LABELS.iter().enumerate() {
        let text = format!("{value} {}", label.name);
        entry(ui, label.color, &text, histogram[value]).on_hover_text(label.meaning);
    }
    let others: u64 = histogram[palette::LABELS.len()..].iter().sum();
    if others > 0 {
        ui.label(theme::note(format!("other values · {}", format::count(others))));
    }
}

/// A line of the legend: colour, value, how many.
fn entry(ui: &mut Ui, color: Color32, name: &str, pixels: u64) -> egui::Response {
    let line = ui.horizontal(|ui| {
        theme::swatch(ui, color);
        ui.label(theme::number(name).color(theme::TEXT));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(theme::number(format::count(pixels)).color(theme::DIM));
        });
    });
    line.response
}

/// The grey ramp with its ends and handles.
fn depth(ui: &mut Ui, state: &mut State, shown: &Shown, range: [f64; 2]) {
    let is_raw = shown.measure == DepthMeasure::Raw;
    theme::heading(ui, if is_raw { "Depth as stored" } else { "Distance" });
    ramp(ui, is_raw);
    let unit = |value: f64| if is_raw { format::digits(value) } else { format::metres(value) };
    ui.horizontal(|ui| {
        ui.label(theme::number(unit(range[0])).color(theme::TEXT));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(theme::number(unit(range[1])).color(theme::TEXT));
        });
    });
    let full = picture::full_range(state, shown);
    if full[1] > full[0] {
        handles(ui, state, range, full);
    }
    ui.horizontal(|ui| {
        let is_fitted = state.view.depth_range.is_none();
        let fit = ui.add_enabled(!is_fitted, egui::Button::new("Autofit").small());
        if fit.on_hover_text("From the nearest to the farthest surface").clicked() {
            state.view.depth_range = None;
        }
        theme::swatch(ui, palette::NO_SURFACE);
        ui.label(RichText::new("no surface").size(theme::SMALL_SIZE).color(theme::DIM));
    });
}

fn handles(ui: &mut Ui, state: &mut State, range: [f64; 2], full: [f64; 2]) {
    ui.spacing_mut().slider_width = ui.available_width();
    // Where the user's range came from another picture, the handles still reach its ends.
    let [mut low, mut high] = range;
    let limits = full[0].min(low)..=full[1].max(high);
    let slider = egui::RangeSlider::new(&mut low, &mut high, limits).show_value(false).smart_aim(false);
    if ui.add(slider).accessible_name("Depth range").changed() {
        state.view.depth_range = Some([low, high]);
    }
}

/// Near is light; a stored depth is small where it is far.
fn ramp(ui: &mut Ui, is_raw: bool) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 8.0), Sense::hover());
    let steps = 48;
    let width = rect.width() / steps as f32;
    for step in 0..steps {
        let place = step as f32 / (steps - 1) as f32;
        let left = rect.left() + step as f32 * width;
        let slice = Rect::from_min_max(pos2(left, rect.top()), pos2(left + width + 0.5, rect.bottom()));
        let color = palette::near_far(if is_raw { 1.0 - place } else { place });
        ui.painter().rect_filled(slice, CornerRadius::ZERO, color);
    }
}
