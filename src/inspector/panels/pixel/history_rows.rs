//! "History" in the Pixel panel: one row for each event, in the order in which they happened.

use super::picked::{PickedHistory, PixelPanel};
use super::row_budget::HistoryRows;
use crate::capture::Capture;
use crate::history::{FragmentOutcome, PixelEvent, PixelHistory, TestResult};
use crate::inspector::action::PanelKind;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::explained;
use crate::inspector::model::Model;
use crate::plan::DrawPart;
use crate::reading::capture_point::CapturePoint;
use crate::reading::format;
use crate::reading::history_row::{EventOutcome, HistoryCells, line, short, sign};
use crate::reading::steps;
use egui::{Align2, Color32, CornerRadius, FontId, Margin, Pos2, Rect, RichText, Role, Sense, Stroke, Ui, WidgetInfo};
use egui::{pos2, vec2};

/// How many contradictions are listed.
const MOST_WRONG: usize = 3;
/// Opacity of a history that does not belong to the picked pixel.
const GREYED: f32 = 0.4;

/// Draws the heading, the rows and the selected event of the picked pixel's history, or why there is none. Returns the
/// y, in points, at which the rows end, above the selected event.
pub fn ui(
    ui: &mut Ui,
    own: &mut PixelPanel,
    model: &mut Model,
    picked: &PickedHistory,
    capture: &Capture,
    at: [u32; 2],
    rows: HistoryRows,
) -> f32 {
    heading(ui, own, model, picked, capture, at);
    if !model.can_ask() {
        let text = "A capture folder holds pictures and no geometry, so what happened between them is not known. Open \
                    the scene itself, or run `stencilscope pixel SCENE --at X,Y`.";
        ui.add(egui::Label::new(theme::note(text)).wrap());
        return ui.cursor().top();
    }
    if let Some(reason) = &picked.failed {
        let text = RichText::new(format!("× There is no history: {reason}")).color(theme::of(ui).error);
        ui.add(egui::Label::new(text).wrap());
        return ui.cursor().top();
    }
    let Some(history) = &picked.history else { return ui.cursor().top() };
    let drawn = ui.scope(|ui| {
        if picked.is_late {
            ui.set_opacity(GREYED);
        }
        wrong(ui, &picked.wrong, || history.why_disagreeing());
        let shown = shown(own, model, capture, history);
        table(ui, own, model, capture, history, &shown, rows);
        let end = ui.cursor().top();
        selected(ui, model, capture, history);
        end
    });
    drawn.inner
}

/// Width beside the title of a history from which on its agreement with the GPU is said in full, points.
const LEAST_WORDS: f32 = 204.0;
/// And from which on it is said at all.
const LEAST_SHORT_WORDS: f32 = 152.0;

/// Draws the title, the number of listed and of all events, and the switch that hides idle ones; while the history is
/// waited for and late, a note instead.
fn heading(ui: &mut Ui, own: &mut PixelPanel, model: &Model, picked: &PickedHistory, capture: &Capture, at: [u32; 2]) {
    ui.horizontal(|ui| {
        theme::heading(ui, "History");
        if !model.can_ask() || picked.failed.is_some() {
            return;
        }
        let Some(history) = picked.history.as_ref().filter(|_| !picked.is_late) else {
            let job = model.activity.job.as_ref().map_or_else(String::new, |job| format!(": {job}"));
            let text = theme::note(format!("waiting for {}, {}{job} …", at[0], at[1]));
            ui.add(egui::Label::new(text).truncate());
            return;
        };
        let all = history.events.len();
        let count = shown(own, model, capture, history).len();
        let counted = format::counted(all as u64, "event");
        let text = if count < all { format!("{count} of {counted}") } else { counted };
        let counted = ui.label(theme::note(text));
        if picked.wrong.is_empty() && history.captured.is_some() {
            let words = match ui.available_width() {
                ..LEAST_SHORT_WORDS => None,
                ..LEAST_WORDS => Some("· as stored"),
                _ => Some("· as the GPU stored it"),
            };
            let agrees = words.map_or(counted, |words| ui.label(theme::note(words)));
            agrees.on_hover_text("After every pass the events make what was captured here, bit for bit");
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let text = theme::note("Hide idle");
            let switch = ui.checkbox(&mut own.hides_idle, text);
            switch.on_hover_text(
                "Hide events that changed nothing in the picture, but for those that the stencil kept from it",
            );
        });
    });
}

/// Draws a warning that says why there are contradictions between a history and the GPU, the first few and how many more;
/// nothing where there is none.
fn wrong(ui: &mut Ui, wrong: &[String], why: impl Fn() -> String) {
    if wrong.is_empty() {
        return;
    }
    let frame = theme::card(ui).stroke(Stroke::new(1.0, theme::of(ui).error)).inner_margin(Margin::same(8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let title = RichText::new(format!("× {}", why())).color(theme::of(ui).error);
        ui.add(egui::Label::new(title).wrap());
        for one in wrong.iter().take(MOST_WRONG) {
            ui.add(egui::Label::new(theme::note(one.as_str()).color(theme::of(ui).text)).wrap());
        }
        if wrong.len() > MOST_WRONG {
            ui.label(theme::note(format!("and {} more", wrong.len() - MOST_WRONG)));
        }
    });
    ui.add_space(4.0);
}

/// Returns the indices of the events that are listed: all, or, where idle ones are hidden, those that did something to the
/// picture, those that the stencil kept from it, as it decides there, and those of the selected triangle.
fn shown(own: &PixelPanel, model: &Model, capture: &Capture, history: &PixelHistory) -> Vec<usize> {
    let is_shown = |event: &PixelEvent| {
        let counts = steps::number(capture, event.pass).is_some() && (event.does_something() || is_decided(event));
        !own.hides_idle || counts || model.selection.has_event(event)
    };
    history.events.iter().enumerate().filter(|(_, event)| is_shown(event)).map(|(index, _)| index).collect()
}

/// Returns whether the stencil test keeps a surface out of the picture.
fn is_decided(event: &PixelEvent) -> bool {
    let fails =
        |outcome: &FragmentOutcome| matches!(outcome, FragmentOutcome::Tested { stencil: TestResult::Failed, .. });
    event.triangle().is_some_and(|one| one.part == DrawPart::Surface && fails(&one.outcome))
}

fn table(
    ui: &mut Ui,
    own: &mut PixelPanel,
    model: &mut Model,
    capture: &Capture,
    history: &PixelHistory,
    shown: &[usize],
    HistoryRows { height: row_height, most }: HistoryRows,
) {
    if shown.is_empty() {
        let none = history.events.is_empty();
        let text = if none { "Nothing was drawn or cleared here." } else { "No event changed anything here." };
        ui.label(theme::note(text));
        return;
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    head(ui, history.has_stencil);
    // Half a row below the others says that there are more.
    let height = row_height * if shown.len() > most { most as f32 + 0.5 } else { shown.len() as f32 };
    let area = egui::ScrollArea::vertical().id_salt("history rows").auto_shrink([false, true]);
    // It must not shrink inside the panel's own scroll area.
    let mut area = area.max_height(height).min_scrolled_height(height);
    let selected = || model.selected_in(history).and_then(|event| shown.iter().position(|one| *one == event));
    if let Some(place) = own.scrolls_to_selected.then(selected).flatten() {
        let first = place.saturating_sub(most / 2).min(shown.len().saturating_sub(most));
        area = area.vertical_scroll_offset(row_height * first as f32);
    }
    own.scrolls_to_selected = false;
    let point = model.shown_point();
    let is_later = |place: usize| shown.get(place).is_some_and(|event| is_after(&history.events[*event], point));
    area.show_rows(ui, row_height, shown.len(), |ui, rows| {
        for place in rows {
            let event = &history.events[shown[place]];
            let top = ui.cursor().top();
            row(ui, model, capture, history, event, is_later(place), row_height);
            if is_later(place) && !place.checked_sub(1).is_some_and(is_later) {
                now(ui, top);
            }
        }
    });
    ui.add_space(4.0);
}

/// Returns whether an event comes after a point of the frame: it has not happened in the picture that is shown.
fn is_after(event: &PixelEvent, point: CapturePoint) -> bool {
    let is_later_draw = |shown| event.triangle().is_some_and(|one| one.draw > shown);
    event.pass > point.step || (event.pass == point.step && point.draw.is_some_and(is_later_draw))
}

/// Draws the line between what has happened up to the shown step and what comes later, at `y` points.
fn now(ui: &Ui, y: f32) {
    let (area, color) = (ui.max_rect(), theme::of(ui).selected);
    ui.painter().hline(area.x_range(), y, Stroke::new(1.0, color));
    let tip = [vec2(0.0, -3.5), vec2(5.0, 0.0), vec2(0.0, 3.5)].map(|corner| pos2(area.left(), y) + corner);
    ui.painter().add(egui::Shape::convex_polygon(tip.to_vec(), color, Stroke::NONE));
}

/// Width of a row, points, below which its columns stand closer.
const NARROW: f32 = 264.0;

/// Width of a row, points, from which on each test has a column wide enough for its name and for the word *always*.
const WORDED: f32 = 372.0;

/// Positions of the columns.
struct HistoryColumns {
    pass: f32,
    what: f32,
    what_width: f32,
    side: f32,
    depth: f32,
    stencil: Option<f32>,
    /// Both tests have names above them, and a test that always passes is a word; otherwise signs.
    are_worded: bool,
    operation: f32,
    change: f32,
}

impl HistoryColumns {
    /// Returns where the columns of a row begin, in points; the column for the stencil test exists only where there is
    /// a stencil. Where space is short the tests give it to the face: which caster's it is, nothing else says.
    fn of(row: Rect, has_stencil: bool) -> HistoryColumns {
        let is_narrow = row.width() < NARROW;
        let are_worded = !has_stencil || row.width() >= WORDED;
        let change = row.right() - 6.0;
        let operation = change - if is_narrow { 76.0 } else { 80.0 };
        let stencil = operation - if are_worded { 42.0 } else { 19.0 };
        let depth = match (has_stencil, are_worded) {
            (true, true) => stencil - 37.0,
            (true, false) => stencil - 18.0,
            (false, _) => change - 100.0,
        };
        let side = depth - 32.0;
        let what = row.left() + if is_narrow { 28.0 } else { 36.0 };
        HistoryColumns {
            pass: row.left() + if is_narrow { 14.0 } else { 20.0 },
            what,
            what_width: side - what - 4.0,
            side,
            depth,
            stencil: has_stencil.then_some(stencil),
            are_worded,
            operation,
            change,
        }
    }
}

fn head(ui: &mut Ui, has_stencil: bool) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    response.widget_info(|| {
        WidgetInfo::labeled(
            Role::ColumnHeader,
            true,
            "Columns: pass, face, side, depth test, stencil test, operation, change",
        )
    });
    let columns = HistoryColumns::of(rect, has_stencil);
    let write = |x: f32, align: Align2, text: &str| {
        let font = FontId::proportional(theme::SMALL_SIZE);
        ui.painter().text(pos2(x, rect.center().y), align, text, font, theme::of(ui).faint);
    };
    write(columns.pass, Align2::RIGHT_CENTER, "#");
    write(columns.what, Align2::LEFT_CENTER, "face");
    write(columns.side, Align2::LEFT_CENTER, "side");
    write(columns.depth, Align2::LEFT_CENTER, if columns.are_worded { "depth" } else { "tests" });
    if let Some(stencil) = columns.stencil {
        write(stencil, Align2::LEFT_CENTER, if columns.are_worded { "stencil" } else { "" });
        write(columns.operation, Align2::LEFT_CENTER, "op");
    }
    write(columns.change, Align2::RIGHT_CENTER, "change");
    let line = Stroke::new(1.0, theme::of(ui).line);
    ui.painter().hline(rect.x_range(), rect.bottom() - 0.5, line);
    let which = match has_stencil {
        true => "Left the depth test, right the stencil test, which is made first",
        false => "The depth test",
    };
    response.on_hover_text(format!(
        "{which}. A tick: passed; a cross: failed; a ring or \"always\": nothing can fail it; -: not reached. A letter \
         stands for a face where its word has no space: S a side, L a light cap, D a dark cap"
    ));
}

/// Opacity of what happens after the shown step.
const LATER: f32 = 0.75;

fn row(
    ui: &mut Ui,
    model: &mut Model,
    capture: &Capture,
    history: &PixelHistory,
    event: &PixelEvent,
    is_later: bool,
    height: f32,
) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    let cells = HistoryCells::of(history, event, capture);
    let is_selected = model.selection.has_event(event);
    let later = if is_later { ", after the shown step" } else { "" };
    response.widget_info(|| WidgetInfo::selected(Role::Row, true, is_selected, format!("{}{later}", cells.name())));
    if response.hovered() {
        model.selection.point_at(event);
    }
    if response.clicked() {
        model.selection.select_event(event);
    }
    if response.double_clicked() {
        go_to(model, event);
    }
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    if ui.is_rect_visible(rect) {
        theme::row_background(ui, rect, is_selected, &response);
        let ink = if event.does_something() { theme::of(ui).text } else { theme::of(ui).dim };
        let opacity = ui.opacity();
        if is_later {
            ui.multiply_opacity(LATER);
        }
        paint(ui, rect, &cells, history.has_stencil, ink);
        ui.set_opacity(opacity);
    }
    response.context_menu(|ui| {
        if ui.button("Go to this step").clicked() {
            go_to(model, event);
            ui.close();
        }
        let can = can_show_in_scene(model, event);
        let button = ui.add_enabled(can, egui::Button::new(IN_SCENE));
        if button.on_disabled_hover_text("Only triangles that the camera draws, of an open scene, are there").clicked()
        {
            show_in_scene(model, event);
            ui.close();
        }
    });
    let line = line(history, event, &capture.depth);
    // A pass beside the frame has no number: its name is all.
    let pass = if cells.pass == event.pass_name { cells.pass } else { format!("{}, {}", cells.pass, event.pass_name) };
    let when = if is_later { " It comes after the shown step." } else { "" };
    explained(ui, response, &format!("{pass}: {line}.{when} Double-click to go there."));
}

/// Text in the menu of a row, and for the selected event.
const IN_SCENE: &str = "Show the triangle in the Scene tab";

fn can_show_in_scene(model: &Model, event: &PixelEvent) -> bool {
    model.can_ask() && event.is_from_camera && event.triangle().is_some()
}

fn show_in_scene(model: &mut Model, event: &PixelEvent) {
    model.selection.select_event(event);
    model.requests.triangle_in_scene = true;
    model.requests.panels.push(PanelKind::Scene);
}

/// Returns the point of the frame after the draw of an event; a clear comes before all draws of its step.
fn point_of(event: &PixelEvent) -> CapturePoint {
    CapturePoint { step: event.pass, draw: event.triangle().map(|one| one.draw) }
}

fn go_to(model: &mut Model, event: &PixelEvent) {
    model.select(point_of(event));
}

fn paint(ui: &Ui, rect: Rect, cells: &HistoryCells, has_stencil: bool, ink: Color32) {
    let columns = HistoryColumns::of(rect, has_stencil);
    let painter = ui.painter();
    let middle = rect.center().y;
    let number = theme::number_font(theme::SMALL_SIZE);
    let words = FontId::proportional(theme::SMALL_SIZE);
    let number_of_pass = cells.number.map_or_else(|| "–".to_owned(), |number| number.to_string());
    painter.text(pos2(columns.pass, middle), Align2::RIGHT_CENTER, number_of_pass, number.clone(), theme::of(ui).dim);
    let mut swatch = None;
    if let Some(color) = cells.part.and_then(|part| theme::of(ui).part(part)) {
        // In the middle between the number and the face.
        let center = pos2((columns.pass + columns.what) / 2.0, middle);
        swatch = Some((center, color));
        painter.rect_filled(Rect::from_center_size(center, vec2(8.0, 8.0)), CornerRadius::same(2), color);
    }
    // More than the first of both words has to be visible.
    let what = if cells.part == Some(DrawPart::PlanarShadow) { "flat" } else { cells.what.as_str() };
    let has_sign = cells.part.is_some_and(|part| theme::of(ui).part(part).is_some());
    let width = match &cells.outcome {
        // The columns beside it are empty.
        EventOutcome::Cleared => columns.operation - columns.what,
        _ => columns.what_width,
    };
    // Which part it is, its colour says too; which caster's, nothing else.
    let choices = [[what, cells.of.as_str()], [cells.of.as_str(), ""]];
    let choices = if has_sign && !cells.of.is_empty() { &choices[..] } else { &choices[..1] };
    let drawn = theme::two_inks_that_fit(ui, pos2(columns.what, middle), width, choices, ink);
    // Where the part has no space in words, its first letter stands for it.
    if let Some(((center, color), letter)) = swatch.zip(what.chars().next()).filter(|_| drawn > 0) {
        painter.rect_filled(Rect::from_center_size(center, vec2(12.0, 13.0)), CornerRadius::same(2), color);
        let letter = letter.to_ascii_uppercase();
        painter.text(center, Align2::CENTER_CENTER, letter, number.clone(), theme::of(ui).background);
    }
    painter.text(pos2(columns.side, middle), Align2::LEFT_CENTER, cells.side, words.clone(), theme::of(ui).dim);
    match cells.outcome {
        EventOutcome::Cleared => {}
        EventOutcome::Nothing(why) => {
            painter.text(pos2(columns.depth, middle), Align2::LEFT_CENTER, why, words, theme::of(ui).faint);
        }
        EventOutcome::Tested { depth, stencil, operation } => {
            test(ui, pos2(columns.depth, middle), depth, columns.are_worded);
            if let Some(x) = columns.stencil {
                test(ui, pos2(x, middle), stencil, columns.are_worded);
                let (text, color) = match operation {
                    None => ("", theme::of(ui).faint),
                    Some(wgpu_types::StencilOperation::Keep) => {
                        (short(wgpu_types::StencilOperation::Keep), theme::of(ui).faint)
                    }
                    Some(other) => (short(other), ink),
                };
                painter.text(pos2(columns.operation, middle), Align2::LEFT_CENTER, text, number.clone(), color);
            }
        }
    }
    let color = if cells.has_changed { theme::of(ui).text } else { theme::of(ui).faint };
    painter.text(pos2(columns.change, middle), Align2::RIGHT_CENTER, &cells.change, number, color);
}

/// Draws a test's result with its left end at `at`: a tick where it passed, a cross where it failed, a dash where it was
/// not reached, and where it always passes a word, or a ring where there is no space for it.
fn test(ui: &Ui, at: Pos2, test: TestResult, is_worded: bool) {
    let painter = ui.painter();
    let mark = |points: &[(f32, f32)], color: Color32| {
        let points = points.iter().map(|(x, y)| at + vec2(*x + 2.0, *y)).collect();
        painter.line(points, Stroke::new(1.7, color));
    };
    match test {
        TestResult::Passed => mark(&[(0.0, 0.5), (3.0, 3.5), (9.0, -3.5)], theme::of(ui).passed),
        TestResult::Failed => {
            mark(&[(0.5, -3.5), (7.5, 3.5)], theme::of(ui).failed);
            mark(&[(0.5, 3.5), (7.5, -3.5)], theme::of(ui).failed);
        }
        TestResult::Always if !is_worded => {
            painter.circle_stroke(at + vec2(6.0, 0.0), 3.5, Stroke::new(1.2, theme::of(ui).decided));
        }
        TestResult::Always | TestResult::NotReached => {
            let font = FontId::proportional(theme::SMALL_SIZE);
            painter.text(at, Align2::LEFT_CENTER, sign(test), font, theme::of(ui).decided);
        }
    }
}

/// Draws the event of the selected triangle in full, with buttons that go to its step and to the triangle in the scene;
/// nothing where the history has no such event.
fn selected(ui: &mut Ui, model: &mut Model, capture: &Capture, history: &PixelHistory) {
    let Some(event) = model.selected_in(history).and_then(|index| history.events.get(index)) else { return };
    theme::card(ui).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.add(egui::Label::new(theme::note(line(history, event, &capture.depth)).color(theme::of(ui).text)).wrap());
        let text = theme::note(format!("Go to {}, {}", point_of(event).words(capture), event.pass_name));
        if point_of(event) != model.selected() && ui.button(text).clicked() {
            go_to(model, event);
        }
        if can_show_in_scene(model, event) && ui.button(theme::note(IN_SCENE)).clicked() {
            show_in_scene(model, event);
        }
    });
}
