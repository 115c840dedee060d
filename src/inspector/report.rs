//! The Report tab: what every technique costs on the open scene, and how often it is wrong.
//!
//! It shows data and asks for it; measuring is the app's.

use super::action::Action;
use super::export::{ExportDialog, ExportKind};
use super::state::State;
use super::{format, report_plot, report_table, theme};
use crate::report::plot::{Page, Plot, layout};
use crate::report::{Report, Row};
use egui::{Align, Layout, RichText, ScrollArea, Ui, vec2};
use std::sync::Arc;

/// From this width on, in points, plot and table are side by side.
const SIDE_BY_SIDE: f32 = 600.0;
/// Width of the table beside the plot, points.
const TABLE_WIDTH: std::ops::RangeInclusive<f32> = 296.0..=480.0;
/// Height of the plot above the table, points.
const STACKED_PLOT_HEIGHT: f32 = 240.0;

/// What the tab shows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReportView {
    /// The rows so far, or all.
    pub report: Option<Report>,
    /// What has no row, since it would take too much of this machine's memory: `shadow-map 4096`.
    pub left_out: Vec<String>,
    /// How far measuring is; `None` while nothing is measured.
    pub running: Option<ReportProgress>,
    /// Why measuring failed, with its mend.
    pub error: Option<String>,
}

/// How far measuring is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReportProgress {
    /// Steps that are done.
    pub done: usize,
    /// Steps in all.
    pub of: usize,
    /// What is being measured: `shadow-map 1024`.
    pub what: String,
}

/// The view with its plot, laid out once for each size.
#[derive(Debug, Default)]
pub struct ReportState {
    view: ReportView,
    plot: Option<(Page, Arc<Plot>)>,
}

impl ReportState {
    /// Shows something else.
    pub fn show(&mut self, view: ReportView) {
        if view.report != self.view.report {
            self.plot = None;
        }
        self.view = view;
    }

    /// What is shown.
    pub fn view(&self) -> &ReportView {
        &self.view
    }

    /// Is there nothing to show but an invitation?
    pub fn is_empty(&self) -> bool {
        self.rows().is_empty() && self.view.running.is_none()
    }

    /// What was measured; `None` while that is nothing, or not yet all.
    pub fn measured(&self) -> Option<&Report> {
        let report = self.view.report.as_ref().filter(|_| self.view.running.is_none());
        report.filter(|report| !report.rows.is_empty())
    }

    fn rows(&self) -> &[Row] {
        self.view.report.as_ref().map_or(&[], |report| &report.rows)
    }

    /// The plot on a page.
    fn plot(&mut self, page: Page) -> Option<Arc<Plot>> {
        let report = self.view.report.as_ref()?;
        match &self.plot {
            Some((laid_out, plot)) if *laid_out == page => Some(Arc::clone(plot)),
            _ => {
                let plot = Arc::new(layout(report, &page));
                self.plot = Some((page, Arc::clone(&plot)));
                Some(plot)
            }
        }
    }
}

/// Draws the panel.
pub fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    top_line(ui, state, actions);
    if let Some(error) = &state.report.view.error {
        ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(theme::of(ui).error)).wrap());
    }
    if state.report.rows().is_empty() {
        return;
    }
    let size = ui.available_size();
    if size.x >= SIDE_BY_SIDE {
        let table = (size.x * 0.42).clamp(*TABLE_WIDTH.start(), *TABLE_WIDTH.end());
        let plot = vec2(size.x - table - ui.spacing().item_spacing.x, size.y);
        ui.horizontal_top(|ui| {
            ui.allocate_ui_with_layout(plot, Layout::top_down(Align::Min), |ui| {
                ScrollArea::vertical().id_salt("report plot").show(ui, |ui| plot_of(ui, state, plot.y, actions));
            });
            ui.allocate_ui_with_layout(vec2(table, size.y), Layout::top_down(Align::Min), |ui| {
                let scroll = ScrollArea::vertical().id_salt("report table").auto_shrink([false, false]);
                scroll.show(ui, |ui| report_table::ui(ui, state, actions));
            });
        });
    } else {
        ScrollArea::both().id_salt("report").auto_shrink([false, false]).show(ui, |ui| {
            plot_of(ui, state, STACKED_PLOT_HEIGHT, actions);
            report_table::ui(ui, state, actions);
        });
    }
}

fn plot_of(ui: &mut Ui, state: &mut State, height: f32, actions: &mut Vec<Action>) {
    let width = f64::from(ui.available_width().floor());
    // A little less than there is: a scroll bar would ask for another width.
    let height = Some(f64::from((height - 2.0).floor()));
    let page = Page { width, height, most_columns: 4, compact: true };
    if let Some(plot) = state.report.plot(page) {
        report_plot::ui(ui, state, &plot, actions);
    }
}

/// What can be done, and how far it is.
fn top_line(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let can_run = state.scene.is_some();
    ui.horizontal_wrapped(|ui| match &state.report.view.running {
        Some(progress) => {
            if ui.button("Cancel").on_hover_text("Stop measuring; the rows so far stay").clicked() {
                actions.push(Action::CancelReport);
            }
            let share = progress.done as f32 / progress.of.max(1) as f32;
            let width = ui.available_width().min(180.0);
            let bar = egui::ProgressBar::new(share).desired_width(width).desired_height(8.0);
            ui.add(bar).accessible_name("Measuring");
            let count = |value: usize| format::count(value as u64);
            ui.label(theme::note(format!("{} of {} · {}", count(progress.done), count(progress.of), progress.what)));
        }
        None => {
            let is_new = state.report.rows().is_empty();
            let words = if is_new { "Measure" } else { "Measure again" };
            let button = ui.add_enabled(can_run, egui::Button::new(words));
            if button.on_hover_text("Measure every technique on the open scene; this takes a while").clicked() {
                actions.push(Action::RunReport);
            }
            if !is_new && ui.button("Save…").on_hover_text("Write the rows or the plot to a file").clicked() {
                state.export.dialog = ExportDialog::new(ExportKind::Report, state);
            }
            ui.add(egui::Label::new(theme::note(explanation(state, can_run, is_new))).wrap());
        }
    });
}

fn explanation(state: &State, can_run: bool, is_new: bool) -> String {
    match &state.report.view.report {
        Some(report) if !is_new => {
            let rows = format::counted(report.rows.len() as u64, "row");
            let adapter = &report.adapter.name;
            let without = match &state.report.view.left_out[..] {
                [] => String::new(),
                left_out => {
                    let names = left_out.join(", ");
                    format!(" · without {names}: too much memory for a window, `stencilscope report` measures all")
                }
            };
            format!("{rows} on {adapter} · filled: no other row is both faster and more right{without}")
        }
        _ if can_run => {
            "Measures every technique on this scene: how many pixels are wrong against a ray-traced truth, \
                         and how many milliseconds a frame takes."
                .to_owned()
        }
        _ => "Open a scene to measure what each technique costs on it, and how often it is wrong.".to_owned(),
    }
}

/// Is the row what is shown now: same scene, technique and settings?
pub fn is_current(state: &State, row: &Row) -> bool {
    let (scene, technique, settings) = match (&state.scene, &state.capture) {
        (Some(open), _) => {
            let choice = &open.draft.choice;
            (open.name.as_str(), choice.technique().name(), choice.settings())
        }
        (None, Some(capture)) => (capture.scene.as_str(), capture.technique.as_str(), &capture.settings),
        (None, None) => return false,
    };
    let has_settings = || row.settings.iter().all(|(key, value)| settings.get(key) == Some(value));
    row.scene == scene && row.technique == technique && has_settings()
}

/// Asks to render as a row was.
pub fn open_row(row: &Row) -> Action {
    Action::OpenReportRow { technique: row.technique.clone(), settings: row.settings.clone() }
}
