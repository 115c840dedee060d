//! The Report tab: what every technique costs on the open scene, and how often it is wrong.
//!
//! It shows data and asks for it; the app measures.

pub mod plot;
pub mod row;
pub mod table;

use crate::ask::{QuestionKind, Reply, ReportOf, RunRequest};
use crate::inspector::action::{Action, DialogKind, ExportKind, TourSubject};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::panels::tour_mark;
use crate::reading::format;
use crate::report::MeasuredReport;
use crate::report::plot::{Plot, PlotPage, layout};
use crate::technique::Choice;
use egui::{Align, Layout, RichText, ScrollArea, Ui, vec2};
use std::sync::{Arc, Weak};

/// From this width on, in points, plot and table are side by side.
const SIDE_BY_SIDE: f32 = 600.0;
/// Width of the table beside the plot, points.
const TABLE_WIDTH: std::ops::RangeInclusive<f32> = 296.0..=480.0;
/// In a panel narrower than this, points, what is said stands below the buttons.
const SAID_BESIDE: f32 = 380.0;
/// Height of the plot above the table, points.
const STACKED_PLOT_HEIGHT: f32 = 240.0;

/// From so many finished steps on, the time that the rest takes is shown.
const LEAST_STEPS: usize = 8;

/// The state of the tab Report: its plot, laid out once for each report and size.
#[derive(Debug, Default)]
pub struct ReportPanel {
    plot: Option<(Weak<MeasuredReport>, PlotPage, Arc<Plot>)>,
    /// How the open scene was to be run when measuring began.
    of: Option<RunRequest>,
}

/// What is said of a report of the scene before it was changed.
const OUTDATED: &str = "! Of the scene before it was changed: measure again.";

impl ReportPanel {
    /// Returns whether what was measured is run otherwise by now, but for technique and settings, which a report chooses
    /// itself.
    fn is_of_another_scene(&self, model: &Model) -> bool {
        let now = model.scene.as_ref().map(|scene| &scene.draft);
        let is_same =
            |(of, now): (&RunRequest, &RunRequest)| RunRequest { choice: now.choice.clone(), ..of.clone() } == *now;
        !self.of.as_ref().zip(now).is_none_or(is_same)
    }

    /// Returns the plot of a report on a page, cached for the last report and page.
    fn plot(&mut self, measured: &Arc<MeasuredReport>, page: PlotPage) -> Arc<Plot> {
        match &self.plot {
            Some((of, laid_out, plot)) if std::ptr::eq(of.as_ptr(), Arc::as_ptr(measured)) && *laid_out == page => {
                Arc::clone(plot)
            }
            _ => {
                let plot = Arc::new(layout(&measured.report, &page));
                self.plot = Some((Arc::downgrade(measured), page, Arc::clone(&plot)));
                plot
            }
        }
    }
}

/// Draws the panel Report: a plot and a table of every technique's errors and times, side by side where the panel is
/// wide. The last report stays visible while another is measured; without rows, only the buttons.
pub fn ui(ui: &mut Ui, own: &mut ReportPanel, model: &mut Model, actions: &mut Vec<Action>) {
    let reply = model.answers.under_way::<ReportOf>();
    let measured = model.answers.last::<ReportOf>().map(|(_, measured)| Arc::clone(measured));
    let mut top = |ui: &mut Ui| {
        top_line(ui, own, model, &reply, measured.as_deref());
        if let Some(error) = &reply.failed {
            ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(theme::of(ui).error)).wrap());
        }
    };
    let Some(measured) = measured.as_ref().filter(|measured| !measured.report.rows.is_empty()) else {
        ScrollArea::vertical().id_salt("report words").show(ui, top);
        return;
    };
    top(ui);
    let size = ui.available_size();
    if size.x >= SIDE_BY_SIDE {
        let table = (size.x * 0.42).clamp(*TABLE_WIDTH.start(), *TABLE_WIDTH.end());
        let plot = vec2(size.x - table - ui.spacing().item_spacing.x, size.y);
        ui.horizontal_top(|ui| {
            ui.allocate_ui_with_layout(plot, Layout::top_down(Align::Min), |ui| {
                ScrollArea::vertical()
                    .id_salt("report plot")
                    .show(ui, |ui| plot_of(ui, own, model, measured, plot.y, actions));
            });
            ui.allocate_ui_with_layout(vec2(table, size.y), Layout::top_down(Align::Min), |ui| {
                let scroll = ScrollArea::vertical().id_salt("report table").auto_shrink([false, false]);
                scroll.show(ui, |ui| table::ui(ui, model, &measured.report, actions));
            });
        });
    } else {
        ScrollArea::both().id_salt("report").auto_shrink([false, false]).show(ui, |ui| {
            plot_of(ui, own, model, measured, STACKED_PLOT_HEIGHT, actions);
            table::ui(ui, model, &measured.report, actions);
        });
    }
}

fn plot_of(
    ui: &mut Ui,
    own: &mut ReportPanel,
    model: &Model,
    measured: &Arc<MeasuredReport>,
    height: f32,
    actions: &mut Vec<Action>,
) {
    let width = f64::from(ui.available_width().floor());
    // A little less than the space: a scroll bar would ask for another width.
    let height = Some(f64::from((height - 2.0).floor()));
    let page = PlotPage { width, height, most_columns: 4, compact: true };
    plot::ui(ui, model, &measured.report, &own.plot(measured, page), actions);
}

/// Draws the button that starts measuring, or, while it runs, the progress with the time left and a button that cancels
/// it. It can't be started without a scene.
fn top_line(
    ui: &mut Ui,
    own: &mut ReportPanel,
    model: &mut Model,
    reply: &Reply<MeasuredReport>,
    measured: Option<&MeasuredReport>,
) {
    let can_run = model.scene.is_some();
    let is_narrow = ui.available_width() < SAID_BESIDE;
    let is_new = measured.is_none_or(|measured| measured.report.rows.is_empty());
    let said = match model.origin().filter(|_| is_new) {
        Some(_) => "Another program drew this frame: no technique can be measured on it.".to_owned(),
        None => explanation(measured.filter(|_| !is_new), can_run),
    };
    let said = if is_new || !own.is_of_another_scene(model) { said } else { format!("{OUTDATED} {said}") };
    ui.horizontal(|ui| match &reply.running {
        Some(progress) => {
            if ui.button("Cancel").on_hover_text("Stop measuring; the rows so far stay").clicked() {
                model.answers.cancel(QuestionKind::ReportOf);
            }
            let choices = model.answers.asked::<ReportOf>().map_or(&[][..], |ask| &ask.choices);
            // The truth comes first, with steps of its own.
            let what = progress.item().and_then(|item| choices.get(item));
            let what = what.map_or_else(|| "the truth".to_owned(), Choice::short_name);
            let (done, of) = progress.steps();
            // The total is known before the first step: each is measured `runs` times, and warmed up once.
            let to_do = model.answers.asked::<ReportOf>().map_or(0, |ask| ask.choices.len() * (ask.runs + 1));
            let of = if of == 0 { to_do } else { of };
            let share = done as f32 / of.max(1) as f32;
            let width = ui.available_width().min(180.0);
            let bar = egui::ProgressBar::new(share).desired_width(width).desired_height(8.0);
            ui.add(bar).accessible_name("Measuring");
            let count = |value: usize| format::count(value as u64);
            let left = time_left(reply.waits_for, done, of);
            let words = format!("{} of {} · measuring {what}{left}", count(done), count(of));
            ui.add(egui::Label::new(theme::note(words)).wrap());
        }
        None => {
            let words = if is_new { "Measure" } else { "Measure again" };
            let measure = |ui: &mut Ui, model: &mut Model| {
                let button = ui.add_enabled(can_run, egui::Button::new(words));
                let button = button.on_hover_text("Measure every technique on the open scene; this takes a while");
                tour_mark::frame(ui, model, TourSubject::Measure, &button);
                button.on_disabled_hover_text("Open a scene first: its techniques are measured").clicked()
            };
            if model.origin().is_none() && measure(ui, model) {
                match ReportOf::grid() {
                    Ok(question) => {
                        own.of = model.scene.as_ref().map(|scene| scene.draft.clone());
                        model.answers.start(question);
                    }
                    Err(error) => model.push_error(error.to_string()),
                }
            }
            let is_whole = measured.is_some_and(|measured| measured.is_whole);
            if !is_new && is_whole && ui.button("Save…").on_hover_text("Write the rows or the plot to a file").clicked()
            {
                model.dialog = Some(DialogKind::Export(ExportKind::Report));
            }
            if !is_narrow {
                ui.add(egui::Label::new(theme::note(&said)).wrap());
            }
        }
    });
    if is_narrow && reply.running.is_none() {
        ui.add(egui::Label::new(theme::note(said)).wrap());
    }
}

/// Returns how long the rest takes, in seconds, or minutes from 90 s on, if it goes on as fast as so far; empty where
/// too few steps are done, no time has passed, or `done` exceeds `of`.
fn time_left(seconds: f64, done: usize, of: usize) -> String {
    if done < LEAST_STEPS || seconds <= 0.0 || done > of {
        return String::new();
    }
    let left = seconds / done as f64 * (of - done) as f64;
    let left = if left < 90.0 { format!("{left:.0} s") } else { format!("{:.0} min", left / 60.0) };
    format!(" · about {left} left")
}

fn explanation(measured: Option<&MeasuredReport>, can_run: bool) -> String {
    match measured {
        Some(MeasuredReport { report, is_whole: false, .. }) => {
            let rows = format::counted(report.rows.len() as u64, "row");
            format!("! Stopped at {rows}, timed by few frames each: measure again for all of them.")
        }
        Some(MeasuredReport { report, left_out, .. }) => {
            let rows = format::counted(report.rows.len() as u64, "row");
            let adapter = &report.adapter.name;
            let without = match &left_out[..] {
                [] => String::new(),
                left_out => {
                    let names = left_out.join(", ");
                    format!(" · without {names}: too much memory for a window, `stencilscope report` measures all")
                }
            };
            format!("{rows} on {adapter} · filled: no other row is both faster and more right{without}")
        }
        None if can_run => {
            "Measures every technique on this scene: how many pixels are wrong against a ray-traced truth, \
             and how many milliseconds a frame takes."
                .to_owned()
        }
        None => "Open a scene to measure what each technique costs on it, and how often it is wrong.".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_the_time_it_took() {
        assert_eq!(time_left(20.0, 10, 40), " · about 60 s left");
        assert_eq!(time_left(20.0, 10, 190), " · about 6 min left");
        assert_eq!(time_left(20.0, 2, 40), "", "too early to tell");
        assert_eq!(time_left(0.0, 10, 40), "", "not known how long it took");
    }
}
