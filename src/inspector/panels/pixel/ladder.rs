//! The ladder: the view ray through the picked pixel from the eye (top) to infinity, with every face of a light's
//! shadow volumes on it, what each added, and the running count.

use super::picked::{PickedHistory, PixelPanel};
use crate::capture::Capture;
use crate::history::{FragmentOutcome, Ladder, PixelHistory, Rung, VolumeCount};
use crate::inspector::look::theme;
use crate::inspector::look::widgets::explained;
use crate::inspector::model::Model;
use crate::numbers;
use crate::plan::{CountedSide, DrawPart};
use crate::reading::format;
use crate::reading::history_row::{self, named, side};
use crate::reading::ladder_layout::{CountStretch, LadderMark, PlacedMark, place, stretches};
use egui::{
    Align2, Color32, CornerRadius, FontId, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use std::ops::Range;

/// Space above the eye and below infinity, points.
const MARGIN: f32 = 12.0;
/// The least height between eye and infinity, points: less can't be read, and the panel scrolls.
pub const LEAST_HEIGHT: f32 = 120.0;
/// How far the line of the running count moves to the right for one, at most, and in all, points.
const COUNT_STEP: f32 = 10.0;
const COUNT_WIDTH: f32 = 30.0;
/// Width of a digit of the largest of these numbers, points.
const DIGIT: f32 = 8.5;

/// What the ladder is.
const WHAT: &str = "The view ray from the eye (on top) to infinity, with each face of the light's volumes that it crosses, what that face \
                    added, and the count there";
/// Space between a face's name and its distance, points.
const NAME_GAP: f32 = 8.0;

/// How many folded rungs a click opens at most, the nearest.
const OPENED_AT_ONCE: usize = 100;

/// Returns how many rungs of a light's ladder count, which are those that must be seen, as others fold; `None` where none
/// can be drawn.
pub fn rungs(picked: &PickedHistory, capture: &Capture, light: usize) -> Option<usize> {
    let history = picked.history.as_ref().filter(|_| is_shown(picked, capture))?;
    Some(
        history
            .ladder(light, &capture.depth)
            .map_or(0, |ladder| ladder.rungs.iter().filter(|rung| rung.added != 0).count()),
    )
}

/// Returns whether a ladder can be drawn: the pixel's history is known, and the frame counts volumes.
fn is_shown(picked: &PickedHistory, capture: &Capture) -> bool {
    picked.history.is_some() && capture.counts_volumes()
}

/// Draws the ladder of `light` under the history, within `height` points if possible. Draws nothing where the history
/// is not known or this light's shadow is not counted in volumes.
pub fn ui(
    ui: &mut Ui,
    own: &mut PixelPanel,
    model: &mut Model,
    picked: &PickedHistory,
    capture: &Capture,
    light: usize,
    height: f32,
) {
    let top = ui.cursor().top();
    let Some(history) = &picked.history else { return };
    if !is_shown(picked, capture) || !capture.decided_by(light).counts_volumes() {
        return;
    }
    ui.horizontal(|ui| {
        theme::heading(ui, "Ladder").on_hover_text(WHAT);
        let is_open = own.unfolded.contains_key(&light);
        if is_open && ui.small_button("Fold").on_hover_text("Fold faces again").clicked() {
            own.unfolded.remove(&light);
        }
        let of = capture.lights.get(light).and_then(|light| light.count_of);
        let counting = of.map_or_else(String::new, |of| format!(", counting {}", of.what()));
        let words = theme::note(format!("of {}{counting}", format::light(light)));
        let words = ui.add(egui::Label::new(words).wrap());
        of.map(|of| words.on_hover_text(of.meaning()));
    });
    ui.scope(|ui| {
        if picked.is_late {
            ui.set_opacity(0.4);
        }
        drawn(ui, own, model, capture, history, light, top + height);
    });
}

/// Returns sentences that say from where to where the light's volumes are counted, at which number the count starts,
/// how many faces count, and the sum.
fn direction(ladder: &Ladder) -> String {
    let way = match (ladder.side, ladder.surface) {
        (CountedSide::Behind, Some(_)) => "Counted from infinity towards the surface",
        (CountedSide::Behind, None) => "Counted from infinity, and no surface ends it",
        (CountedSide::InFront, Some(_)) => "Counted from the eye towards the surface",
        (CountedSide::InFront, None) => "Counted from the eye, and no surface ends it",
        (CountedSide::AsNeeded, _) => "Counted along the whole ray, each volume in front of the surface or behind it",
    };
    let near = ladder.start - ladder.cleared_to;
    let start = match (ladder.cleared_to, near) {
        (0, 0) => String::new(),
        (cleared, 0) => format!(", starting at {}, which the count was cleared to", signed(cleared)),
        (0, near) => format!(", starting at {}: the volumes that hold the near plane", signed(near)),
        (cleared, near) => format!(
            ", starting at {}: cleared to {}, and {} for the volumes that hold the near plane",
            signed(ladder.start),
            signed(cleared),
            signed(near)
        ),
    };
    let all = ladder.rungs.len() as u64;
    let counted = ladder.rungs.iter().filter(|rung| rung.added != 0).count();
    let faces = format::counted(all, "face");
    format!("{way}{start}. {counted} of {faces} count: {} in all{}.", signed(ladder.count), in_its_bits(ladder))
}

/// Returns a clause with what the light pass reads where the bits of the stencil store the count as another value;
/// empty where they store it as it is, and for counts in floats.
fn in_its_bits(ladder: &Ladder) -> String {
    match ladder.tested {
        VolumeCount::Stencil(byte) if ladder.bits.hold_otherwise(ladder.count, byte) => {
            format!(", in {} {byte}", ladder.bits)
        }
        VolumeCount::Stencil(_) | VolumeCount::Float(_) => String::new(),
    }
}

fn signed(value: i32) -> String {
    numbers::whole(value.into())
}

/// Returns what a face added to the count: `+1`, `−1`, or an empty text for 0.
fn added(value: i32) -> String {
    match value {
        0 => String::new(),
        1.. => format!("+{value}"),
        _ => signed(value),
    }
}

/// Positions of the columns in the ladder's rectangle.
#[derive(Clone, Copy)]
struct LadderColumns {
    ray: f32,
    name: f32,
    distance: f32,
    added: f32,
    steps: f32,
    /// How far it goes to the right at most.
    line: f32,
    count: f32,
}

impl LadderColumns {
    /// Returns the columns of a ladder in `rect`: the line of the running count has no more width than it takes, so that
    /// names have the rest.
    fn of(rect: Rect, ladder: &Ladder) -> LadderColumns {
        let count = rect.right() - 6.0;
        let running = || ladder.rungs.iter().map(|rung| rung.running).chain([0, ladder.start, ladder.count]);
        let range = running().max().unwrap_or(0).saturating_sub(running().min().unwrap_or(0));
        // Beside the line stands the longest of them, the surface's in larger digits.
        let digits = running().map(|count| signed(count).chars().count()).max().unwrap_or(1);
        let numbers = (DIGIT * digits as f32 + 6.0).max(20.0);
        // What they take more, the line has less: names keep their width.
        let line = (COUNT_STEP * range as f32).min((COUNT_WIDTH + 20.0 - numbers).max(COUNT_STEP));
        let steps = count - numbers - line;
        let added = steps - 10.0;
        let distance = added - 34.0;
        let (ray, name) = (rect.left() + 16.0, rect.left() + 32.0);
        LadderColumns { ray, name, distance, added, steps, line, count }
    }
}

/// Draws the ladder itself, down to `bottom` if possible, with rungs that do not fit folded; or says that no face is on
/// the view ray.
fn drawn(
    ui: &mut Ui,
    own: &mut PixelPanel,
    model: &mut Model,
    capture: &Capture,
    history: &PixelHistory,
    light: usize,
    bottom: f32,
) {
    let Some(ladder) = &history.ladder(light, &capture.depth) else {
        let none = format!("No volume face of {} is on this pixel's view ray.", format::light(light));
        ui.add(egui::Label::new(theme::note(none)).wrap());
        return;
    };
    ui.add(egui::Label::new(theme::note(direction(ladder))).wrap());
    let chosen = model.selected_in(history);
    let selected = chosen.and_then(|event| ladder.rungs.iter().position(|rung| rung.event == event));
    let open = own.unfolded.get(&light).map_or(&[][..], Vec::as_slice);
    let height = (bottom - ui.cursor().top() - 2.0 * MARGIN).max(LEAST_HEIGHT);
    let (placed, line) = place(ladder, capture.camera.near, selected, open, height);
    let height = placed.last().map_or(0.0, |(_, y)| *y) + 2.0 * MARGIN;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    response.widget_info(|| {
        WidgetInfo::labeled(Role::Image, true, format!("Ladder of the view ray. {}", direction(ladder)))
    });
    let columns = LadderColumns::of(rect, ladder);
    let top = rect.top() + MARGIN;
    let row = |y: f32| Rect::from_center_size(pos2(rect.center().x, top + y), vec2(rect.width(), line));
    // Rungs first, as the selected one has a background.
    for (mark, y) in &placed {
        match mark {
            LadderMark::Rung(index) => rung(ui, own, model, capture, history, &ladder.rungs[*index], row(*y)),
            LadderMark::More(from, to) => {
                if let Some(opened) = fold(ui, ladder, *from..*to, row(*y)) {
                    own.unfolded.entry(light).or_default().push(opened);
                }
            }
            _ => {}
        }
    }
    if !ui.is_rect_visible(rect) {
        return;
    }
    ray(ui, columns, top, &placed);
    for (mark, y) in &placed {
        let rect = row(*y);
        match mark {
            LadderMark::Rung(index) => paint_rung(ui, capture, history, &ladder.rungs[*index], columns, rect),
            LadderMark::More(from, to) => paint_more(ui, &ladder.rungs[*from..*to], columns, rect),
            other => paint_end(ui, capture, history, ladder, *other, columns, rect),
        }
    }
    paint_count(ui, columns, top, ladder, &stretches(ladder, &placed));
}

/// Draws a rung as a widget: a click selects its triangle in all panels. Draws nothing where its event is not in the
/// history.
fn rung(
    ui: &mut Ui,
    own: &mut PixelPanel,
    model: &mut Model,
    capture: &Capture,
    history: &PixelHistory,
    rung: &Rung,
    rect: Rect,
) {
    let Some(event) = history.events.get(rung.event) else { return };
    let response = ui.interact(rect, ui.scope_id().with(("rung", rung.event)), Sense::click());
    let is_selected = model.selection.has_event(event);
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, is_selected, name(capture, history, rung)));
    if response.hovered() {
        model.selection.point_at(event);
    }
    if response.clicked() {
        model.selection.select_event(event);
        own.scrolls_to_selected = true;
    }
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    theme::row_background(ui, rect, is_selected, &response);
    let line = history_row::line(history, event, &capture.depth);
    let order = "That is in the order of drawing; the ladder counts in the order along the ray.";
    explained(ui, response, &format!("{line}.\n\n{order}"));
}

/// Draws a fold of the ladder as a widget; where it is clicked, returns the first of its rungs, as many as are opened
/// at once.
fn fold(ui: &mut Ui, ladder: &Ladder, rungs: Range<usize>, rect: Rect) -> Option<Range<usize>> {
    let response = ui.interact(rect, ui.scope_id().with(("fold", rungs.start)), Sense::click());
    let opened = rungs.start..rungs.end.min(rungs.start + OPENED_AT_ONCE);
    let hover = format!("Open {}", format::counted(opened.len() as u64, "face"));
    let name = folded(&ladder.rungs[rungs]);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    theme::row_background(ui, rect, false, &response);
    response.on_hover_text(hover).clicked().then_some(opened)
}

/// Describes folded rungs in words: how many, and what they add in sum, or that none is counted.
fn folded(rungs: &[Rung]) -> String {
    let counting = rungs.iter().filter(|rung| rung.added != 0).count();
    let sum: i32 = rungs.iter().map(|rung| rung.added).sum();
    match (counting, sum) {
        (0, _) => format!("+{} more, not counted", rungs.len()),
        (_, 0) => format!("+{} more, adding 0", rungs.len()),
        _ => format!("+{} more, adding {}", rungs.len(), added(sum)),
    }
}

/// Describes a rung in words for assistive technology: part, object, triangle (counted from 1), side, distance, what it
/// added, and the running count. Empty where its event drew no triangle.
fn name(capture: &Capture, history: &PixelHistory, rung: &Rung) -> String {
    let Some(one) = history.events.get(rung.event).and_then(|event| event.triangle()) else { return String::new() };
    let (part, of) = named(one);
    let counted = if rung.added == 0 { "not counted".to_owned() } else { added(rung.added) };
    let (triangle, side) = (one.source_triangle + 1, side(one));
    let [distance, running] = [numbers::length(rung.distance, capture.depth.unit.name()), signed(rung.running)];
    format!("rung: {part} of {of}, triangle {triangle}, {side}, at {distance}: {counted}, count {running}")
}

/// Draws the line of the view ray, from the first to the last placed mark.
fn ray(ui: &Ui, columns: LadderColumns, top: f32, placed: &[PlacedMark]) {
    let [Some(first), Some(last)] = [placed.first(), placed.last()] else { return };
    let stroke = Stroke::new(1.5, theme::of(ui).faint);
    ui.painter().vline(columns.ray, top + first.1..=top + last.1, stroke);
}

fn paint_rung(ui: &Ui, capture: &Capture, history: &PixelHistory, rung: &Rung, columns: LadderColumns, rect: Rect) {
    let Some(one) = history.events.get(rung.event).and_then(|event| event.triangle()) else { return };
    let (painter, y) = (ui.painter(), rect.center().y);
    let counts = rung.added != 0;
    let bar = Rect::from_center_size(pos2(columns.ray, y), vec2(20.0, 6.0));
    let color = theme::of(ui).part(one.part).unwrap_or(theme::of(ui).dim);
    if counts {
        painter.rect_filled(bar, CornerRadius::same(1), color);
    } else {
        painter.rect(
            bar,
            CornerRadius::same(1),
            theme::of(ui).panel,
            Stroke::new(1.0, theme::of(ui).faint),
            StrokeKind::Inside,
        );
    }
    let (part, of) = named(one);
    let ink = if counts { theme::of(ui).text } else { theme::of(ui).faint };
    let what = format!("{part}, {}", side(one));
    // Which part it is, the bar's colour says too. The side says why it counts up or down, and whose it is, nothing else.
    let choices = match of.is_empty() {
        true => vec![[what.as_str(), ""], [&part, ""]],
        // That it is a cap is worth more than its side, which the sign of what it adds says too.
        false if one.part != DrawPart::Side => vec![[what.as_str(), &of], [&part, &of], [&of, ""]],
        false => vec![[what.as_str(), &of], [side(one), &of], [&of, ""]],
    };
    let names = |width: f32| theme::two_inks_that_fit(ui, pos2(columns.name, y), width, &choices, ink);
    let number = theme::number_font(theme::SMALL_SIZE);
    let ink = if counts { theme::of(ui).dim } else { theme::of(ui).faint };
    let is_clipped =
        matches!(one.outcome, FragmentOutcome::Clipped(_) | FragmentOutcome::Discarded(_) | FragmentOutcome::Culled);
    let distance = if is_clipped { "clipped".to_owned() } else { short(capture, rung.distance) };
    let at = painter.text(pos2(columns.distance, y), Align2::RIGHT_CENTER, distance, number.clone(), ink);
    // What a short distance leaves free is the names'.
    names(at.left() - NAME_GAP - columns.name);
    if !counts {
        return;
    }
    let color = if rung.added > 0 { theme::of(ui).count_up } else { theme::of(ui).count_down };
    painter.text(pos2(columns.added, y), Align2::RIGHT_CENTER, added(rung.added), number.clone(), color);
    // An arrow up or down beside the sign.
    let (tip, base) = if rung.added > 0 { (-3.5, 3.0) } else { (3.5, -3.0) };
    let x = columns.added - 24.0;
    let triangle = [vec2(0.0, tip), vec2(3.5, base), vec2(-3.5, base)].map(|corner| pos2(x, y) + corner);
    painter.add(Shape::convex_polygon(triangle.to_vec(), color, Stroke::NONE));
    painter.text(pos2(columns.count, y), Align2::RIGHT_CENTER, signed(rung.running), number, theme::of(ui).text);
}

/// Returns a distance in few digits with the letter of the capture's unit: two decimals from 0.1 to below 100, none
/// from there to below 10 000, otherwise (also below 0) as a general length; `∞` where it is not finite.
fn short(capture: &Capture, distance: f64) -> String {
    let unit = capture.depth.unit.letter();
    match distance {
        _ if !distance.is_finite() => "∞".to_owned(),
        ..0.1 => numbers::length(distance, unit),
        ..100.0 => format!("{distance:.2} {unit}"),
        100.0..10_000.0 => format!("{distance:.0} {unit}"),
        _ => numbers::length(distance, unit),
    }
}

fn paint_more(ui: &Ui, rungs: &[Rung], columns: LadderColumns, rect: Rect) {
    let (painter, y) = (ui.painter(), rect.center().y);
    for offset in [-4.0, 0.0, 4.0] {
        painter.circle_filled(pos2(columns.ray, y + offset), 1.5, theme::of(ui).dim);
    }
    let font = FontId::proportional(theme::SMALL_SIZE);
    painter.text(pos2(columns.name, y), Align2::LEFT_CENTER, folded(rungs), font, theme::of(ui).dim);
}

/// Draws the mark and words of eye, near plane, surface or infinity on the ladder, with its distance and the count
/// there where it has them; nothing for rungs.
fn paint_end(
    ui: &Ui,
    capture: &Capture,
    history: &PixelHistory,
    ladder: &Ladder,
    mark: LadderMark,
    columns: LadderColumns,
    rect: Rect,
) {
    let (painter, y) = (ui.painter(), rect.center().y);
    let number = |x: f32, text: String, color: Color32| {
        painter.text(pos2(x, y), Align2::RIGHT_CENTER, text, theme::number_font(theme::SMALL_SIZE), color)
    };
    // What a distance leaves free is the words'.
    let words = |choices: &[[&str; 2]], distance: Option<f64>, color: Color32| {
        let right = distance
            .map_or(columns.distance, |away| number(columns.distance, short(capture, away), color).left() - NAME_GAP);
        theme::two_inks_that_fit(ui, pos2(columns.name, y), right - columns.name, choices, color);
    };
    match mark {
        LadderMark::Eye => {
            painter.circle_filled(pos2(columns.ray, y), 4.0, theme::of(ui).text);
            words(&[["eye", ""]], None, theme::of(ui).dim);
        }
        LadderMark::Near => {
            let [from, to] = [columns.ray - 14.0, columns.ray + 14.0].map(|x| pos2(x, y));
            painter.extend(Shape::dashed_line(&[from, to], Stroke::new(1.5, theme::of(ui).dim), 4.0, 3.0));
            let choices = [["near plane", ""], ["near", ""]];
            words(&choices, Some(capture.camera.near), theme::of(ui).dim);
            if ladder.start != 0 && !ladder.is_from_infinity() {
                number(columns.count, signed(ladder.start), theme::of(ui).text);
            }
        }
        LadderMark::Surface => {
            let bar = Rect::from_center_size(pos2(columns.ray, y), vec2(26.0, 7.0));
            painter.rect_filled(bar, CornerRadius::same(1), theme::of(ui).text);
            let of = surface_name(history).unwrap_or("");
            let choices = [["surface", of], if of.is_empty() { ["surface", ""] } else { [of, ""] }];
            words(&choices, ladder.surface, theme::of(ui).text);
            // The count that the light pass tests.
            let count = match ladder.tested {
                VolumeCount::Stencil(byte) if ladder.bits.hold_otherwise(ladder.count, byte) => byte.to_string(),
                _ => signed(ladder.count),
            };
            let size = theme::TEXT_SIZE;
            let ink = if ladder.tested.is_zero() { theme::of(ui).lit } else { theme::of(ui).text };
            painter.text(pos2(columns.count, y), Align2::RIGHT_CENTER, count, theme::number_font(size), ink);
        }
        LadderMark::Infinity => {
            painter.text(
                pos2(columns.ray, y + 7.0),
                Align2::CENTER_CENTER,
                "∞",
                theme::number_font(15.0),
                theme::of(ui).dim,
            );
            words(&[["infinity", ""]], None, theme::of(ui).dim);
            if ladder.start != 0 && ladder.is_from_infinity() {
                number(columns.count, signed(ladder.start), theme::of(ui).text);
            }
        }
        LadderMark::Rung(_) | LadderMark::More(..) => {}
    }
}

/// Returns the name of the draw of the last surface that changed the pixel's depth, which is the visible one; `None`
/// where no surface did.
fn surface_name(history: &PixelHistory) -> Option<&str> {
    let wrote = history
        .triangles()
        .filter(|(event, one)| one.part == DrawPart::Surface && event.before.depth != event.after.depth);
    wrote.last().map(|(_, one)| one.draw_name.as_str())
}

/// Draws the running count as a step line, further right where it is higher, with a line for 0, and an arrow at its end
/// in the direction of counting.
fn paint_count(ui: &Ui, columns: LadderColumns, top: f32, ladder: &Ladder, stretches: &[CountStretch]) {
    let counts = || stretches.iter().map(|one| one.count).chain([0]);
    let (Some(least), Some(most)) = (counts().min(), counts().max()) else { return };
    let step = columns.line / (most - least).max(1) as f32;
    let x = |count: i32| columns.steps + 4.0 + (count - least) as f32 * step;
    let painter = ui.painter();
    if let (Some(first), Some(last)) = (stretches.first(), stretches.last()) {
        let (low, high) = (first.top.min(last.top), first.bottom.max(last.bottom));
        painter.vline(x(0), top + low..=top + high, Stroke::new(1.0, theme::of(ui).line));
    }
    let along = stretches.iter().flat_map(|one| {
        let ends = if ladder.is_from_infinity() { [one.bottom, one.top] } else { [one.top, one.bottom] };
        ends.map(|y| pos2(x(one.count), top + y))
    });
    let along: Vec<_> = along.collect();
    if let [.., before, last] = along[..] {
        let back = if before.y > last.y { 6.0 } else { -6.0 };
        let tip = [vec2(-3.5, back), vec2(0.0, 0.0), vec2(3.5, back)].map(|corner| last + corner);
        painter.line(tip.to_vec(), Stroke::new(1.5, theme::of(ui).text));
    }
    painter.line(along, Stroke::new(1.5, theme::of(ui).text));
}
