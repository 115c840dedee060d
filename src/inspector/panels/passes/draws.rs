//! Under the passes: the draws of the selected one, and what the frame left out.

use super::fields::PassesPanel;
use super::{debug_groups, thumbnail};
use crate::ask::Reply;
use crate::capture::{Capture, DrawState, DrawSummary, StepDraws};
use crate::inspector::look::{left_out, theme};
use crate::inspector::model::Model;
use crate::plan::LeftOut;
use crate::reading::capture_point::CapturePoint;
use crate::reading::format;
use crate::reading::written::WrittenAspects;
use egui::{CornerRadius, Rect, RichText, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2};
use std::sync::Arc;

/// How many draws are listed before the rest is folded away.
const LISTED: usize = 16;
/// Height of a draw, points.
const HEIGHT: f32 = 24.0;
/// Where a draw's thumbnail is, points from the row's corners.
const THUMBNAIL: [f32; 2] = [12.0, 3.0];
/// Width of the thumbnail, points.
const THUMBNAIL_WIDTH: f32 = 32.0;
/// Where a draw's colour swatch is, points from the row's left.
const INDENT: f32 = THUMBNAIL[0] + THUMBNAIL_WIDTH + 8.0;

/// Draws the list of draws of the selected step: part, name and triangles, and a thumbnail where the state after each
/// is known. A long list is folded until it is opened, or one of its draws is selected.
pub fn of_step(ui: &mut Ui, own: &mut PassesPanel, model: &mut Model, capture: &Arc<Capture>) {
    let draws = &capture.steps[model.selection.step].draws;
    // When draws are folded, the line that says so replaces one of them.
    let short = if draws.len() <= LISTED { draws.len() } else { LISTED - 1 };
    if model.selection.draw.is_some_and(|draw| draw >= short) {
        own.all_draws = Some(model.selection.step);
    }
    let listed = if own.all_draws == Some(model.selection.step) { draws.len() } else { short };
    let fetched = model.want_draws();
    for draw in 0..listed {
        row(ui, model, capture, &fetched, draw);
        if model.selection.draw == Some(draw) {
            note(ui, model, capture, &fetched);
        }
    }
    let folded = &draws[listed..];
    if !folded.is_empty() {
        let triangles = folded.iter().map(|draw| draw.triangles).sum();
        let text = format!("{} more draws · {}", folded.len(), format::counted(triangles, "triangle"));
        ui.horizontal(|ui| {
            ui.add_space(INDENT);
            let button = egui::Button::new(theme::note(text)).frame_when_inactive(false);
            if ui.add(button).on_hover_text("List all draws of this pass").clicked() {
                own.all_draws = Some(model.selection.step);
            }
        });
    }
}

/// Draws the row of one draw of the selected step, which a click selects, and says while it is selected and its state
/// is being fetched.
fn row(ui: &mut Ui, model: &mut Model, capture: &Arc<Capture>, fetched: &Reply<StepDraws>, index: usize) {
    let draw = &capture.steps[model.selection.step].draws[index];
    let is_selected = model.selection.draw == Some(index);
    let is_missing = is_selected && !model.selected().is_known(capture);
    let is_fetched = is_missing && model.can_ask() && fetched.failed.is_none();
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    let mark = debug_groups::mark(draw);
    let name = match &mark {
        _ if is_fetched => format!("{}, being fetched", draw.name),
        Some(_) => format!("{}, differs", draw.name),
        None => draw.name.clone(),
    };
    response.widget_info(|| WidgetInfo::selected(Role::TreeItem, true, is_selected, &name));
    if is_selected && model.selection.wants_scroll {
        response.scroll_to_me(None);
    }
    if response.clicked() {
        model.select(CapturePoint { step: model.selection.step, draw: Some(index) });
        model.selection.wants_scroll = false;
    }
    if !ui.is_rect_visible(rect) {
        return;
    }
    thumbnail::paint_row_background(ui, rect, is_selected, response.hovered(), response.has_focus());
    if capture.holds_draws(model.selection.step) {
        paint_change(ui, model, capture, index, rect);
    }
    let right = if is_fetched { "fetching …".to_owned() } else { format::count(draw.triangles) };
    paint_words(ui, draw, is_selected, mark.as_deref(), &right, rect);
    let changes = if changes_nothing(draw) { "\nIt changed nothing" } else { "" };
    let recorded = debug_groups::explained(model, draw, index);
    let part = if draw.part.is_of_volume() && draw.caster.is_none() { "volume" } else { draw.part.name() };
    let triangles = format::counted(draw.triangles, "triangle");
    response.on_hover_text(format!("{part}: {}, {triangles}{changes}{recorded}", draw.name));
}

fn changes_nothing(draw: &DrawSummary) -> bool {
    draw.after.as_ref().is_some_and(DrawState::changes_nothing)
}

/// Draws a thumbnail of the picture that the draw wrote to, with a `=` over it where the draw changed nothing.
fn paint_change(ui: &Ui, model: &mut Model, capture: &Capture, index: usize, row: Rect) {
    let size = vec2(THUMBNAIL_WIDTH, HEIGHT - 2.0 * THUMBNAIL[1]);
    let place = Rect::from_min_size(row.min + vec2(THUMBNAIL[0], THUMBNAIL[1]), size);
    let written = WrittenAspects::by_draw(capture, model.selection.step, index);
    let colored = thumbnail::colored(model, written);
    thumbnail::paint_thumbnail(ui, model, colored, place);
    if changes_nothing(&capture.steps[model.selection.step].draws[index]) {
        let font = TextStyle::Monospace.resolve(ui.style());
        ui.painter().text(place.center(), egui::Align2::CENTER_CENTER, "=", font, theme::of(ui).faint);
    }
}

/// Draws the swatch of the part of a volume (if it has a colour), the draw's name, and at the right `mark` and `right`,
/// its number of triangles; dimmer where the draw is not selected or changed nothing.
fn paint_words(ui: &Ui, draw: &DrawSummary, is_selected: bool, mark: Option<&str>, right: &str, row: Rect) {
    let left = row.left() + INDENT;
    if let Some(color) = theme::of(ui).part(draw.part) {
        let swatch = Rect::from_center_size(pos2(left + 5.0, row.center().y), vec2(10.0, 10.0));
        let outline = Stroke::new(1.0, theme::of(ui).faint);
        ui.painter().rect(swatch, CornerRadius::same(2), color, outline, StrokeKind::Inside);
    }
    let left = left + 18.0;
    let at = pos2(row.right() - 8.0, row.center().y);
    let font = TextStyle::Monospace.resolve(ui.style());
    let mut right = ui.painter().text(at, egui::Align2::RIGHT_CENTER, right, font.clone(), theme::of(ui).dim);
    if let Some(mark) = mark {
        let at = pos2(right.left() - 8.0, at.y);
        right = ui.painter().text(at, egui::Align2::RIGHT_CENTER, mark, font, theme::of(ui).error);
    }
    let color = match (is_selected, changes_nothing(draw)) {
        (true, _) => theme::of(ui).text,
        (false, true) => theme::of(ui).faint,
        (false, false) => theme::of(ui).dim,
    };
    let width = right.left() - left - 8.0;
    theme::name_line(ui, pos2(left, row.center().y - 7.0), width, &draw.name, TextStyle::Small, color);
}

/// Draws, under the selected draw, why the state after it can't be shown: the folder has none, or fetching it failed.
/// Draws nothing while it is still being fetched.
fn note(ui: &mut Ui, model: &Model, capture: &Capture, fetched: &Reply<StepDraws>) {
    if model.selected().is_known(capture) {
        return;
    }
    let (text, color) = match &fetched.failed {
        _ if !model.can_ask() => {
            let text = "This folder has no states after draws, so draws can't be stepped through: capture it with \
                        --every draw.";
            (text.to_owned(), theme::of(ui).text)
        }
        Some(reason) => (format!("× The state after this draw is not known: {reason}"), theme::of(ui).error),
        // The row already shows this, so that nothing moves when the state comes.
        None => return,
    };
    ui.horizontal(|ui| {
        ui.add_space(INDENT);
        ui.add(egui::Label::new(RichText::new(text).size(theme::SMALL_SIZE).color(color)).wrap());
    });
    ui.add_space(4.0);
}

/// Draws what the frame left out, grouped by reason, faint; draws nothing, not even a heading, where nothing was left
/// out.
pub fn left_out(ui: &mut Ui, all: &[LeftOut]) {
    if all.is_empty() {
        return;
    }
    ui.add_space(8.0);
    ui.label(theme::note("Left out"));
    ui.add_space(2.0);
    let dim = theme::of(ui).dim;
    ui.indent("left out", |ui| {
        left_out::ui(ui, all, |title| RichText::new(title).size(theme::SMALL_SIZE).color(dim));
    });
}
