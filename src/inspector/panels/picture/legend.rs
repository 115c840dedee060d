//! The legend over a corner of the picture, mostly the upper right one: what its colours mean, with counts, and the
//! range of depths.

use super::error_legend;
use super::legend_entry::{bar, entry, entry_with, title};
use super::modes_legend;
use crate::inspector::action::TourSubject;
use crate::inspector::canvas::corners;
use crate::inspector::canvas::magnifier::Occupied;
use crate::inspector::look::palette;
use crate::inspector::look::texture::LightShares;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{keep_arrows, menu_button};
use crate::inspector::model::Model;
use crate::inspector::panels::tour_mark;
use crate::numbers;
use crate::reading::change::{ChangeKind, StepChange};
use crate::reading::counts;
use crate::reading::depth::DepthMeasure;
use crate::reading::format;
use crate::reading::layers::MapContent;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use egui::{Align2, Color32, CornerRadius, Id, Rect, Response, RichText, Sense, Ui, UiBuilder, pos2, vec2};

/// Width of the legend, points.
const WIDTH: f32 = 168.0;
/// Width of the button that unfolds it, points.
const BUTTON: f32 = 78.0;
/// How many stencil values are listed one by one.
const MOST_VALUES: usize = 12;
/// How many counts that eight bits would take for zero are listed one by one.
const MOST_MISREAD: usize = 4;

/// The height that a legend is taken to have before it was drawn, points.
const FIRST_HEIGHT: f32 = 160.0;
/// In which corner it lies, if that is free.
const CORNERS: [Align2; 3] = [Align2::RIGHT_TOP, Align2::LEFT_TOP, Align2::RIGHT_BOTTOM];

/// In a picture lower than this, or lower than it is itself, the legend is a button that unfolds it, points: open, it would be
/// cut.
const LEAST_HEIGHT: f32 = 150.0;
/// In a picture narrower than this it is that button, too, points: open, it would hide the half of it.
const LEAST_BESIDE: f32 = 400.0;

/// Returns the width that the legend needs over a picture of this size, points.
pub fn space_beside(rect: Rect, shown: &ShownPicture) -> f32 {
    if fits(rect, shown.kind) { width(rect, shown.kind) + 12.0 } else { 0.0 }
}

fn fits(rect: Rect, kind: PictureKind) -> bool {
    kind != PictureKind::Color && rect.width() >= LEAST_BESIDE && rect.height() >= LEAST_HEIGHT
}

fn width(rect: Rect, kind: PictureKind) -> f32 {
    if kind == PictureKind::Error { error_legend::WIDTH.min(rect.width() / 2.0 - 12.0).max(WIDTH) } else { WIDTH }
}

/// Draws the legend of `shown` into a corner of `rect` that hides no handle, the upper right one if possible, or, where the
/// picture is narrow, a button that unfolds it; `range` is that of the grey ramp for depths. Returns where it lies; draws
/// nothing for the colour picture.
pub fn ui(
    ui: &mut Ui,
    counts_findings: &mut bool,
    model: &mut Model,
    rect: Rect,
    shown: &ShownPicture,
    range: [f64; 2],
    occupied: &Occupied,
) -> Option<Rect> {
    if shown.kind == PictureKind::Color {
        return None;
    }
    let holds = model.is_dragging;
    let width = width(rect, shown.kind);
    // What its height depends on; the values of a picture matter less.
    let of = Id::unique((shown.kind.name(), model.modes.bit, *counts_findings, model.selection.step));
    let lies = place(ui, rect, width, of, (occupied, holds), |ui| match (shown.kind, model.modes.bit) {
        (PictureKind::Stencil, Some(bit)) => modes_legend::bit(ui, model, shown, bit),
        (PictureKind::Stencil, None) => stencil(ui, model, shown),
        (PictureKind::Overdraw, _) => modes_legend::overdraw(ui, model, shown),
        (PictureKind::Count, _) => signed_counts(ui, model, shown),
        (PictureKind::Map, _) if shown.is_let_through() => let_through(ui, model, shown),
        (PictureKind::Mask | PictureKind::Truth, _) => labels(ui, model, shown),
        (PictureKind::Visibility, _) => visibility(ui, model, shown),
        (PictureKind::Error, _) => error_legend::ui(ui, counts_findings, model, shown),
        _ => depth(ui, model, shown, range),
    });
    tour_mark::frame(ui, model, TourSubject::Legend, &lies);
    Some(lies.rect)
}

/// Draws the legend of what a step changed, or by how much the two `sides` of a comparison differ (their names, first the
/// compared one's), into a corner of `rect`, or a button that unfolds it, as [`ui`] does.
pub fn of_change(
    ui: &mut Ui,
    model: &Model,
    rect: Rect,
    change: &StepChange,
    sides: Option<&[String; 2]>,
    occupied: &Occupied,
) {
    let of = Id::unique(("change", change.kind == ChangeKind::Count, model.selection.step));
    place(ui, rect, WIDTH, of, (occupied, model.is_dragging), |ui| modes_legend::change(ui, change, sides));
}

/// Draws the legend of two colour pictures of which only that is shown in which they differ, and so many pixels are the same,
/// into a corner of `rect`, or a button that unfolds it, as [`ui`] does; returns where it lies.
pub fn of_colors(ui: &mut Ui, model: &Model, rect: Rect, same: u64, occupied: &Occupied) -> Rect {
    let holds = model.is_dragging;
    place(ui, rect, WIDTH, Id::unique("colours"), (occupied, holds), |ui| modes_legend::differing_colors(ui, same)).rect
}

/// Draws a legend's contents on a card, or, where the picture is narrow or too low for it, under a button that unfolds it;
/// returns where it lies. `of` is another for other contents. It leaves the upper right corner where it would hide a handle;
/// while a button of the mouse is down (`holds`) it stays where it is.
fn place(
    ui: &mut Ui,
    rect: Rect,
    width: f32,
    of: Id,
    (occupied, holds): (&Occupied, bool),
    contents: impl FnOnce(&mut Ui),
) -> Response {
    // Its height is known once it was drawn.
    let id = ui.scope_id().with("place of the legend");
    let before: Option<LegendPlace> = ui.data(|data| data.get_temp(id));
    let is_cut = |height: f32| height > rect.height() - 2.0 * corners::MARGIN;
    let known = before.filter(|before| before.of == of);
    let is_small = rect.width() < LEAST_BESIDE || rect.height() < LEAST_HEIGHT;
    let is_card = !is_small && !known.is_some_and(|known| is_cut(known.height));
    let size = match is_card {
        true => vec2(width, before.map_or(FIRST_HEIGHT, |before| before.height)),
        false => vec2(BUTTON, theme::ROW_HEIGHT),
    };
    let corners: Vec<Align2> = CORNERS.into_iter().filter(|corner| !occupied.taken.contains(corner)).collect();
    let hidden = |place: Rect| occupied.kept.iter().filter(|kept| kept.intersects(place)).count() as u64;
    let stays = before.filter(|_| holds).map(|before| before.corner);
    let corner = stays.or_else(|| corners::freest(rect, size, &corners, hidden)).unwrap_or(Align2::RIGHT_TOP);
    let lies = corners::place(rect, size, corner);
    let drawn = match is_card {
        true => card(ui, lies.with_max_y(rect.bottom()), width, contents),
        false => button(ui, lies, width, contents),
    };
    let height = if is_card { drawn.rect.height() } else { before.map_or(FIRST_HEIGHT, |before| before.height) };
    ui.data_mut(|data| data.insert_temp(id, LegendPlace { corner, height, of }));
    if before.is_some_and(|before| before.height != height) || is_card && is_cut(height) {
        ui.ctx().request_repaint();
    }
    drawn
}

/// Where the legend was in the last frame, its height as a card, points, and what it was of.
#[derive(Debug, Clone, Copy)]
struct LegendPlace {
    corner: Align2,
    height: f32,
    of: Id,
}

fn button(ui: &mut Ui, corner: Rect, width: f32, contents: impl FnOnce(&mut Ui)) -> Response {
    ui.scope_builder(UiBuilder::new().max_rect(corner).id_salt("folded legend"), |ui| {
        let menu = menu_button(ui, "Legend", |ui| {
            ui.set_width(width);
            ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
            contents(ui);
        });
        menu.response.on_hover_text("What the colours mean, with counts")
    })
    .inner
}

/// Draws `contents` on a card of `width` points from the top of `corner` on, and returns where it lies; the picture
/// underneath gets no clicks through it.
fn card(ui: &mut Ui, corner: Rect, width: f32, contents: impl FnOnce(&mut Ui)) -> Response {
    // Senses clicks, so that they do not reach the picture underneath.
    let builder = UiBuilder::new().max_rect(corner).sense(Sense::CLICK | Sense::DRAG).id_salt("legend");
    ui.scope_builder(builder, |ui| {
        let frame = theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94));
        let shown = frame.show(ui, |ui| {
            ui.set_width(width - 16.0);
            ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
            contents(ui);
        });
        shown.response
    })
    .inner
}

fn stencil(ui: &mut Ui, model: &mut Model, shown: &ShownPicture) {
    let histogram = model.textures.histogram(&shown.images[0]);
    let are_counts = model.frame.capture.as_ref().is_some_and(|capture| capture.counts_volumes());
    theme::heading(ui, if are_counts { "Stencil count" } else { "Stencil value" });
    if let Some(of) = model.frame.capture.as_ref().and_then(|capture| capture.count_of()) {
        ui.label(theme::note(format!("of {}", of.what()))).on_hover_text(of.meaning());
    }
    // 0, 1, 2 … and then −1, −2 …: the order in which people think of them.
    let values = (0..=127).chain((128..=255).rev()).map(|value: u8| (value, histogram[usize::from(value)]));
    let (listed, rest) = most_frequent(values.filter(|(_, pixels)| *pixels > 0).collect(), MOST_VALUES);
    let most = listed.iter().map(|(_, pixels)| *pixels).max().unwrap_or(0);
    for (value, pixels) in listed {
        entry(ui, palette::stencil(value), &numbers::signed(value), pixels);
        bar(ui, pixels, most);
    }
    more_values(ui, &rest);
}

/// Values, each with the number of pixels that have it.
type ValueCounts<V> = Vec<(V, u64)>;

/// Returns the `most` values with the most pixels, and the others; both in the order given.
fn most_frequent<V>(values: ValueCounts<V>, most: usize) -> (ValueCounts<V>, ValueCounts<V>) {
    let mut by_pixels: Vec<usize> = (0..values.len()).collect();
    by_pixels.sort_by_key(|index| std::cmp::Reverse(values[*index].1));
    let listed: std::collections::BTreeSet<usize> = by_pixels.into_iter().take(most).collect();
    let (listed, rest): (Vec<_>, Vec<_>) =
        values.into_iter().enumerate().partition(|(index, _)| listed.contains(index));
    let value = |(_, value): (usize, (V, u64))| value;
    (listed.into_iter().map(value).collect(), rest.into_iter().map(value).collect())
}

fn more_values<V>(ui: &mut Ui, rest: &[(V, u64)]) {
    if !rest.is_empty() {
        let pixels = format::count(rest.iter().map(|(_, pixels)| pixels).sum());
        let more = format::counted(rest.len() as u64, "more value");
        ui.label(theme::note(format!("{more} · {pixels}")))
            .on_hover_text("Those above have the most pixels; any other shows its number in the picture, when large");
    }
}

/// Draws the legend of float counts: the most frequent values, from 0 upwards and then from −1 downwards, and apart
/// from them those that eight bits would take for zero (multiples of 256).
fn signed_counts(ui: &mut Ui, model: &mut Model, shown: &ShownPicture) {
    let tally = model.textures.tally(&shown.images[0]);
    theme::heading(ui, &title(shown));
    let in_order = tally.range(0..).chain(tally.range(..0).rev()).map(|(count, pixels)| (*count as f32, *pixels));
    let (misread, read): (Vec<_>, Vec<_>) = in_order.partition(|(count, _)| numbers::reads_zero_in_eight_bits(*count));
    let list = |ui: &mut Ui, values, most| {
        let (listed, rest) = most_frequent(values, most);
        for (count, pixels) in listed {
            let hover = format!("In eight bits it would read {}", counts::in_eight_bits(count));
            entry(ui, palette::count(count), &numbers::count_in_float(count), pixels).on_hover_text(hover);
        }
        more_values(ui, &rest);
    };
    list(ui, read, MOST_VALUES);
    if !misread.is_empty() {
        ui.add_space(4.0);
        ui.label(theme::note("would read 0 in eight bits"))
            .on_hover_text("Multiples of 256: a stencil buffer would take these pixels for lit");
        list(ui, misread, MOST_MISREAD);
    }
}

/// Draws the legend of a picture of the light that is let through or arrives: how many texels of all shown images are
/// white (all of it), black (none), or in between.
fn let_through(ui: &mut Ui, model: &mut Model, shown: &ShownPicture) {
    let content = model.frame.capture.as_ref().and_then(|capture| MapContent::of_capture(capture));
    let arrives = content == Some(MapContent::Textures);
    theme::heading(ui, if arrives { "Light that arrives" } else { "Light let through" });
    let mut total = LightShares::default();
    for image in &shown.images {
        let shares = model.textures.shares(image);
        total.all += shares.all;
        total.none += shares.none;
        total.part += shares.part;
    }
    entry(ui, Color32::WHITE, "all of it", total.all).on_hover_text("White: nothing is in the light's way");
    entry(ui, Color32::BLACK, "none of it", total.none).on_hover_text("Black: an opaque caster is in its way");
    let part = "A colour: so much of the light's red, green and blue comes through a translucent caster. Stored are \
                linear shares; they are encoded for the screen";
    let line = entry_with(ui, "a part", total.part, |ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
        let third = rect.width() / 3.0;
        for (place, color) in [Color32::RED, Color32::GREEN, Color32::BLUE].into_iter().enumerate() {
            let corner = pos2(rect.left() + place as f32 * third, rect.top());
            let slice = Rect::from_min_size(corner, vec2(third, rect.height()));
            ui.painter().rect_filled(slice, CornerRadius::ZERO, color.lerp_to_gamma(Color32::GRAY, 0.4));
        }
        let outline = egui::Stroke::new(1.0, theme::of(ui).faint);
        ui.painter().rect_stroke(rect, CornerRadius::same(2), outline, egui::StrokeKind::Inside);
    });
    line.on_hover_text(part);
    if let [layer] = &shown.layers[..]
        && let Some(note) = layer.note
    {
        ui.add(egui::Label::new(theme::note(note)).wrap());
    }
}

/// Draws the legend of which share of a light arrives, and how far it is from the truth where that is known.
fn visibility(ui: &mut Ui, model: &mut Model, shown: &ShownPicture) {
    theme::heading(ui, &title(shown));
    let shares = model.textures.shares(&shown.images[0]);
    entry(ui, Color32::WHITE, "1 all", shares.all).on_hover_text("White: the surface is lit");
    entry(ui, Color32::GRAY, "a share", shares.part)
        .on_hover_text("Grey: a soft edge, or texels of the shadow that a filter mixes in");
    entry(ui, Color32::BLACK, "0 none", shares.none)
        .on_hover_text("Black: in shadow, facing away, or no surface at all");
    let capture = model.frame.capture.as_ref();
    let light = capture.and_then(|capture| model.view.light_with(capture, |light| light.visibility.is_some()));
    let truth = capture.zip(light).and_then(|(capture, light)| capture.lights[light].truth.as_ref());
    if let Some(truth) = truth.and_then(|truth| truth.visibility.as_ref()) {
        ui.add_space(4.0);
        ui.add(egui::Label::new(theme::note(truth.error.in_words())).wrap());
    }
}

fn labels(ui: &mut Ui, model: &mut Model, shown: &ShownPicture) {
    let histogram = model.textures.histogram(&shown.images[0]);
    theme::heading(ui, &title(shown));
    for (value, label) in palette::LABELS.iter().enumerate() {
        let text = format!("{value} {}", label.name);
        entry(ui, label.color, &text, histogram[value]).on_hover_text(label.meaning);
    }
    let others: u64 = histogram[palette::LABELS.len()..].iter().sum();
    if others > 0 {
        ui.label(theme::note(format!("other values · {}", format::count(others))));
    }
}

/// Draws the legend of a depth picture: a histogram, the grey ramp with the values at its ends and handles to move
/// them, and a button that fits it again.
fn depth(ui: &mut Ui, model: &mut Model, shown: &ShownPicture, range: [f64; 2]) {
    let is_raw = shown.measure == DepthMeasure::Raw;
    theme::heading(ui, if is_raw { "Depth as stored" } else { "Distance" });
    let full = model.full_range(shown);
    if full[1] > full[0] {
        modes_legend::depth_bars(ui, model, shown, range, full);
    }
    ramp(ui, is_raw);
    let curve = model.frame.capture.as_ref().map(|capture| capture.depth);
    let unit = |value: f64| match curve {
        Some(curve) if !is_raw => format::length(value, curve.unit.name()),
        _ => format::digits(value),
    };
    ui.horizontal(|ui| {
        ui.label(theme::number(unit(range[0])).color(theme::of(ui).text));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(theme::number(unit(range[1])).color(theme::of(ui).text));
        });
    });
    if full[1] > full[0] {
        handles(ui, model, range, full);
    }
    ui.horizontal(|ui| {
        let is_fitted = model.view.depth_range.is_none();
        let fit = ui.add_enabled(!is_fitted, egui::Button::new("Autofit").small());
        let fit = fit.on_disabled_hover_text("The range goes from the nearest to the farthest surface already");
        if fit.on_hover_text("From the nearest to the farthest surface").clicked() {
            model.view.depth_range = None;
        }
        theme::swatch(ui, palette::NO_SURFACE);
        ui.label(RichText::new("no surface").size(theme::SMALL_SIZE).color(theme::of(ui).dim));
    });
}

fn handles(ui: &mut Ui, model: &mut Model, range: [f64; 2], full: [f64; 2]) {
    ui.spacing_mut().slider_width = ui.available_width();
    // The user's range may have been set over another picture: the handles reach its ends too.
    let [mut low, mut high] = range;
    let limits = full[0].min(low)..=full[1].max(high);
    let slider = egui::RangeSlider::new(&mut low, &mut high, limits).show_value(false).smart_aim(false);
    let slider = ui.add(slider).accessible_name("Depth range");
    keep_arrows(ui, &slider);
    if slider.changed() {
        model.view.depth_range = Some([low, high]);
    }
}

/// Draws the grey ramp from the smallest value at the left to the largest: near is light. A raw stored depth is small
/// where it is far, so that its ramp runs the other way.
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
