//! The report's rows as a table: the plot's positions as numbers. A row is a button.

use super::{plot, row};
use crate::inspector::action::Action;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::numbers;
use crate::reading::format;
use crate::report::plot::{style_of, text_width};
use crate::report::{Report, ReportRow};
use egui::{Align2, Pos2, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

/// Width of the sign before a name, points.
const SIGN_WIDTH: f32 = 30.0;
/// The largest width of the names, points.
const WIDEST_NAME: f32 = 200.0;
/// Space after the last column, points.
const RIGHT_EDGE: f32 = 8.0;

/// Space before the numbers of a column, points.
const COLUMN_GAP: f32 = 18.0;

/// A column of numbers.
struct TableColumn {
    heading: &'static str,
    /// Columns with a lower rank are given space first.
    rank: usize,
    cell: fn(&ReportRow) -> String,
}

const COLUMNS: [TableColumn; 7] = [
    TableColumn { heading: "wrong", rank: 2, cell: |row| format::count(row.wrong()) },
    TableColumn { heading: "%", rank: 0, cell: |row| numbers::per_hundred(row.wrong_fraction) },
    TableColumn {
        heading: "colour",
        rank: 3,
        cell: |row| row.wrong_color.map_or_else(|| "-".to_owned(), format::count),
    },
    TableColumn { heading: "ms", rank: 1, cell: |row| numbers::milliseconds(row.frame_ms.median) },
    TableColumn { heading: "set-up ms", rank: 4, cell: |row| numbers::milliseconds(row.setup_ms) },
    TableColumn { heading: "triangles", rank: 5, cell: |row| format::count(row.triangles) },
    TableColumn { heading: "MiB", rank: 6, cell: |row| numbers::mebibytes(row.bytes) },
];

/// A column with the width that its heading and its numbers take, with the gap before them, points.
type SizedColumn = (&'static TableColumn, f32);

/// Draws the report's table in the available width, one section with headings for each scene; a click on a row adds the
/// action that renders so.
pub fn ui(ui: &mut Ui, model: &Model, report: &Report, actions: &mut Vec<Action>) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let columns = columns(ui, &report.rows);
    let scenes = report.scenes();
    for scene in &scenes {
        headings(ui, if scenes.len() > 1 { scene } else { "technique" }, &columns);
        for row in report.rows.iter().filter(|row| row.scene == *scene) {
            table_row(ui, model, row, &columns, actions);
        }
        ui.add_space(8.0);
    }
}

/// Returns the columns that fit into the available width beside the names, in their usual order; less important ones are
/// left out first, error and time never.
fn columns(ui: &Ui, rows: &[ReportRow]) -> Vec<SizedColumn> {
    let name = |row: &ReportRow| text_width(&row.name(), f64::from(theme::TEXT_SIZE)) as f32;
    let names = SIGN_WIDTH + rows.iter().map(name).fold(0.0, f32::max).min(WIDEST_NAME);
    let all = COLUMNS.iter().map(|column| (column, column_width(ui, rows, column)));
    let all: Vec<SizedColumn> = all.collect();
    let taken = |rank: usize| {
        all.iter().filter(|(other, _)| other.rank <= rank).fold(names + RIGHT_EDGE, |sum, (_, width)| sum + width)
    };
    let width = ui.available_width();
    all.iter().copied().filter(|(column, _)| column.rank < 2 || taken(column.rank) <= width).collect()
}

fn column_width(ui: &Ui, rows: &[ReportRow], column: &TableColumn) -> f32 {
    let of = |text: String, font| ui.painter().layout_no_wrap(text, font, theme::of(ui).text).size().x;
    let heading = of(column.heading.to_owned(), egui::FontId::proportional(theme::SMALL_SIZE));
    let cells = rows.iter().map(|row| of((column.cell)(row), theme::number_font(theme::SMALL_SIZE)));
    cells.fold(heading, f32::max).ceil() + COLUMN_GAP
}

fn headings(ui: &mut Ui, name: &str, columns: &[SizedColumn]) {
    let size = vec2(ui.available_width(), theme::ROW_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::RowHeader, true, name));
    let font = egui::FontId::proportional(theme::SMALL_SIZE);
    let painter = ui.painter();
    painter.text(rect.left_center() + vec2(8.0, 0.0), Align2::LEFT_CENTER, name, font.clone(), theme::of(ui).dim);
    for (column, at) in places(columns, rect) {
        painter.text(at, Align2::RIGHT_CENTER, column.heading, font.clone(), theme::of(ui).dim);
    }
}

/// Returns each column, from right to left, with the right end of its cell in a row, at half height.
fn places(columns: &[SizedColumn], row: Rect) -> impl Iterator<Item = (&'static TableColumn, Pos2)> {
    let mut right = row.right() - RIGHT_EDGE;
    columns.iter().copied().rev().map(move |(column, width)| {
        let at = pos2(right, row.center().y);
        right -= width;
        (column, at)
    })
}

fn table_row(ui: &mut Ui, model: &Model, row: &ReportRow, columns: &[SizedColumn], actions: &mut Vec<Action>) {
    let size = vec2(ui.available_width(), theme::ROW_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let is_current = row::is_current(model, row);
    response.widget_info(|| WidgetInfo::selected(Role::Row, true, is_current, row.summary()));
    if response.clicked() {
        actions.push(row::open_row(row));
    }
    // Chosen in the plot, it is found in the table.
    if response.gained_focus() || plot::takes_chosen(ui, row) {
        response.scroll_to_me(None);
    }
    if ui.is_rect_visible(rect) {
        theme::row_background(ui, rect, is_current, &response);
        plot::key(ui, plot::sign_at(rect), style_of(&row.technique), row.pareto);
        name(ui, rect, row, columns);
        let font = theme::number_font(theme::SMALL_SIZE);
        for (column, at) in places(columns, rect) {
            ui.painter().text(at, Align2::RIGHT_CENTER, (column.cell)(row), font.clone(), theme::of(ui).text);
        }
    }
    response.on_hover_text(row.details());
}

/// Draws a row's technique, and its label dim beside it, cut off with an ellipsis where the columns of numbers begin.
fn name(ui: &Ui, rect: Rect, row: &ReportRow, columns: &[SizedColumn]) {
    let numbers: f32 = columns.iter().map(|(_, width)| width).sum();
    let width = (rect.width() - numbers - SIGN_WIDTH - RIGHT_EDGE).max(40.0);
    let mut job = egui::text::LayoutJob::default();
    let part = |color| egui::TextFormat::simple(TextStyle::Body.resolve(ui.style()), color);
    job.append(&row.technique, 0.0, part(theme::of(ui).text));
    if !row.label.is_empty() {
        job.append(&row.label, 6.0, part(theme::of(ui).dim));
    }
    job.wrap = egui::text::TextWrapping::truncate_at_width(width);
    let galley = ui.painter().layout_job(job);
    let at = pos2(rect.left() + SIGN_WIDTH, rect.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, theme::of(ui).text);
}
