//! The Stress tab: every case with its lesson, the results of each technique in it, and its scene at any value, to be
//! opened.
//!
//! It shows data and asks for it; the app runs the cases.

use crate::ask::{QuestionKind, Reply, StressOf};
use crate::inspector::action::Action;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::format;
use crate::stress::{StressCase, StressRows, StressSummary, StressVerdict, cases, value_text};
use egui::{Align, Layout, RichText, Role, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};
use std::sync::Arc;

/// Width of the list of cases, points.
const LIST_WIDTH: f32 = 232.0;
/// Height of a row of the list and of the table, points.
const ROW: f32 = 24.0;
/// How many values are offered to be opened; where there are more, so many spread evenly.
const MOST_VALUES: usize = 12;
/// Where the table's columns with findings and verdict begin, points from its left.
const COLUMNS: [f32; 2] = [196.0, 330.0];

/// The state of the tab Stress: the selected case.
#[derive(Debug, Default)]
pub struct StressPanel {
    /// Index of the selected case.
    selected: usize,
}

/// Returns the worst verdict of a case; `None` where it was not run.
fn verdict(rows: &StressRows, case: &StressCase) -> Option<StressVerdict> {
    rows.of(case).map(|summary| summary.verdict).max()
}

/// Draws the panel Stress: the list of all cases with their verdicts, and the selected case's lesson and results.
/// Results of the last run stay visible while another runs.
pub fn ui(ui: &mut Ui, own: &mut StressPanel, model: &mut Model, actions: &mut Vec<Action>) {
    let all: Vec<&'static StressCase> = cases::all().collect();
    let selected = own.selected.min(all.len().saturating_sub(1));
    let Some(case) = all.get(selected).copied() else { return };
    let reply = model.answers.under_way::<StressOf>();
    let rows = model.answers.last::<StressOf>().map(|(_, rows)| Arc::clone(rows)).unwrap_or_default();
    top_line(ui, model, &rows, &reply, case, &all);
    if let Some(error) = &reply.failed {
        ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(theme::of(ui).error)).wrap());
    }
    let size = ui.available_size();
    ui.horizontal_top(|ui| {
        ui.allocate_ui_with_layout(vec2(LIST_WIDTH, size.y), Layout::top_down(Align::Min), |ui| {
            let scroll = ScrollArea::vertical().id_salt("stress cases").auto_shrink([false, false]);
            // All rows are drawn, so that the keyboard reaches those that are scrolled out of view.
            scroll.show(ui, |ui| {
                for (index, case) in all.iter().enumerate() {
                    list_row(ui, own, &rows, case, index);
                }
            });
        });
        ui.allocate_ui_with_layout(vec2(ui.available_width(), size.y), Layout::top_down(Align::Min), |ui| {
            let scroll = ScrollArea::vertical().id_salt("stress case").auto_shrink([false, false]);
            scroll.show(ui, |ui| detail(ui, &rows, case, actions));
        });
    });
}

/// Draws the buttons that run the selected case or all, with how many results are unexpected; or, while cases run, the
/// progress and a button that cancels.
fn top_line(
    ui: &mut Ui,
    model: &mut Model,
    rows: &StressRows,
    reply: &Reply<StressRows>,
    case: &StressCase,
    all: &[&'static StressCase],
) {
    ui.horizontal_wrapped(|ui| match reply.steps() {
        Some((rows, all)) => {
            if ui.button("Cancel").on_hover_text("Stop; the cases that are done stay").clicked() {
                model.answers.cancel(QuestionKind::StressOf);
            }
            let share = rows as f32 / all.max(1) as f32;
            let bar = egui::ProgressBar::new(share).desired_width(ui.available_width().min(180.0)).desired_height(8.0);
            ui.add(bar).accessible_name("Running stress cases");
            let of_rows = match all {
                0 => String::new(),
                _ => format!(" · {} of {} rows", format::count(rows as u64), format::count(all as u64)),
            };
            let cases = model.answers.asked::<StressOf>().map_or(&[][..], |ask| &ask.cases);
            let (done, of) = (reply.parts, cases.len());
            let what = cases.get(done).copied().unwrap_or_default();
            ui.label(theme::note(format!("{done} of {of} · {what}{of_rows}")));
        }
        None => {
            let one = ui.button(format!("Run {}", case.name));
            if one.on_hover_text("Run the selected case: every technique at every value").clicked() {
                model.answers.start(StressOf { cases: vec![case.name] });
            }
            if ui.button("Run all").on_hover_text("Run every case; this takes minutes").clicked() {
                model.answers.start(StressOf { cases: all.iter().map(|case| case.name).collect() });
            }
            let unexpected = rows.summaries.iter().filter(|one| one.verdict == StressVerdict::Unexpected).count();
            let ran = all.iter().filter(|case| verdict(rows, case).is_some()).count();
            let text = match (ran, unexpected) {
                (0, _) => "Each case drives one number from easy to extreme, and says who must hold and who must fail."
                    .to_owned(),
                (_, 0) => format!("{ran} of {} cases were run, and nothing was unexpected", all.len()),
                _ => format!("{ran} of {} cases were run, {unexpected} results unexpected", all.len()),
            };
            ui.add(egui::Label::new(theme::note(text)).wrap());
        }
    });
    ui.add_space(4.0);
}

/// Returns a word for a verdict, and its colour; an empty word for `None`, a case that was not run.
fn mark(ui: &Ui, verdict: Option<StressVerdict>) -> (&'static str, egui::Color32) {
    match verdict {
        None => ("", theme::of(ui).faint),
        Some(StressVerdict::Holds) => ("holds", theme::of(ui).passed),
        Some(StressVerdict::NotDrawn) => ("not drawn", theme::of(ui).dim),
        Some(StressVerdict::FailsAsKnown) => ("as known", theme::of(ui).dim),
        Some(StressVerdict::Unexpected) => ("unexpected", theme::of(ui).error),
    }
}

fn list_row(ui: &mut Ui, own: &mut StressPanel, rows: &StressRows, case: &StressCase, index: usize) {
    let is_selected = own.selected == index;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let (word, color) = mark(ui, verdict(rows, case));
    let name = if word.is_empty() { case.name.to_owned() } else { format!("{}: {word}", case.name) };
    response.widget_info(|| WidgetInfo::selected(Role::Row, true, is_selected, &name));
    if response.clicked() {
        own.selected = index;
    }
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    theme::row_background(ui, rect, is_selected, &response);
    let font = TextStyle::Small.resolve(ui.style());
    let at = pos2(rect.right() - 8.0, rect.center().y);
    let verdict = ui.painter().text(at, egui::Align2::RIGHT_CENTER, word, font, color);
    let left = rect.left() + 8.0;
    let width = verdict.left() - left - 8.0;
    theme::line(ui, pos2(left, rect.center().y - 8.0), width, case.name, TextStyle::Body, theme::of(ui).text);
    response.on_hover_text(case.lesson);
}

/// Draws the selected case: its lesson, buttons that open its scene at some values, and the results of each technique,
/// or what is expected of each where the case was not run.
fn detail(ui: &mut Ui, rows: &StressRows, case: &'static StressCase, actions: &mut Vec<Action>) {
    theme::heading(ui, case.name);
    ui.add(egui::Label::new(theme::note(case.lesson).color(theme::of(ui).text)).wrap());
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::note(format!("Open at {}:", if case.parameter.is_empty() { "value" } else { case.parameter })));
        for value in offered(&case.light_values()) {
            let button = ui.button(theme::number(value_text(value)));
            if button.on_hover_text("Open this scene in the window").clicked() {
                actions.push(Action::OpenStress { case: case.name, value, entrant: None });
            }
        }
    });
    if let Some(most) = case.heavy_above {
        let (most, name) = (value_text(most), case.name);
        let text = format!(
            "Runs and opens up to {most} here: with more, a row takes seconds and gigabytes. `stencilscope stress --case {name}` runs all."
        );
        ui.add(egui::Label::new(theme::note(text)).wrap());
    }
    ui.add_space(4.0);
    if rows.of(case).next().is_none() {
        for entrant in case.entrants() {
            let expected = case.expected(&entrant).name();
            ui.label(theme::note(format!("{entrant}: expected {expected}")));
        }
        return;
    }
    for summary in rows.of(case) {
        table_row(ui, case, summary, actions);
    }
}

/// Returns all values where they are few, otherwise an evenly spread choice of them, first and last included.
fn offered(values: &[f64]) -> Vec<f64> {
    if values.len() <= MOST_VALUES {
        return values.to_vec();
    }
    let last = values.len() - 1;
    (0..MOST_VALUES).filter_map(|index| values.get(index * last / (MOST_VALUES - 1)).copied()).collect()
}

/// Draws a technique's row of a stress case; a click opens the case with that technique at the value with the
/// unexpected result, else where it breaks or is blurred, else at the last value that is not heavy.
fn table_row(ui: &mut Ui, case: &'static StressCase, summary: &StressSummary, actions: &mut Vec<Action>) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let (found, verdict, expected) = (summary.found_text(), summary.verdict_text(), summary.expected.name());
    let name = format!("{}: {found}, {verdict}", summary.entrant);
    response.widget_info(|| WidgetInfo::labeled(Role::Row, true, &name));
    theme::row_background(ui, rect, false, &response);
    let (_, color) = mark(ui, Some(summary.verdict));
    let y = rect.center().y - 7.0;
    let [second, third] = COLUMNS.map(|column| rect.left() + column);
    let technique = summary.entrant.to_string();
    theme::line(ui, pos2(rect.left() + 8.0, y), COLUMNS[0] - 16.0, &technique, TextStyle::Small, theme::of(ui).text);
    theme::line(ui, pos2(second, y), third - second - 8.0, &found, TextStyle::Small, theme::of(ui).dim);
    theme::line(ui, pos2(third, y), rect.right() - third - 8.0, &verdict, TextStyle::Small, color);
    let (wrong, compared) = summary.worst;
    let [wrong, compared] = [wrong, compared].map(format::count);
    let because = case.because(&summary.entrant);
    let hover = format!(
        "Expected: {expected}, as {because}. At most {wrong} of {compared} compared pixels are wrong. Click to open it there."
    );
    if response.on_hover_text(hover).clicked() {
        let surprise = summary.surprise.map(|(at, _)| at);
        let breaks = surprise.or(summary.breaks_at).or(summary.blurred_at);
        let value = breaks.or(case.light_values().last().copied()).unwrap_or_default();
        actions.push(Action::OpenStress { case: case.name, value, entrant: Some(summary.entrant) });
    }
    if let Some(course) = &summary.course {
        let color = if course.holds { theme::of(ui).dim } else { theme::of(ui).error };
        ui.add(egui::Label::new(theme::note(course.to_string()).color(color)).wrap());
    }
}
