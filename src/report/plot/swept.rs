//! A sweep's page: the median time of a frame against the value that changes, one chart a scene, a line each technique with its
//! settings. Hollow marks are values at which pixels are wrong.

use super::chart::NO_TIMES;
use super::scale::{self, LogScale};
use super::{
    Plot, PlotInk, PlotLine, PlotPoint, PlotRect, PlotText, SMALL_SIZE, SceneChart, TITLE_SIZE, TextAnchor, style_of,
};
use crate::report::{Report, ReportRow, SweepValue};

/// Width of the page, unless names need more, and height of a chart, points.
const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 400.0;
/// Space above a chart's area and below it, points.
const TOP: f64 = 44.0;
const BOTTOM: f64 = 44.0;
/// Space left and right of a chart's area, points: milliseconds on the left, frames per second and names on the right.
const LEFT: f64 = 64.0;
const RIGHT: f64 = 210.0;
/// Where numbers of frames per second begin, right of the area, points.
const FPS: f64 = 8.0;
/// Where names begin, right of the area, points.
const NAMES: f64 = 58.0;
/// Distance from a name to the next below it, points.
const NAME_HEIGHT: f64 = 13.0;

/// Returns the plot of a report that is a sweep: for each scene a chart of frame times against the sweep's values, one
/// below the other.
pub fn sweep(report: &Report) -> Plot {
    let scenes = report.scenes();
    let name = report.rows.iter().find_map(|row| Some(row.sweep.as_ref()?.name.clone())).unwrap_or_default();
    let mut plot = Plot::empty(WIDTH);
    plot.title = format!("Frame time against {name}");
    plot.summary =
        format!("{} charts: the median time of a frame against {name}, a line each technique.", scenes.len());
    let facts = format!("{} · filled: right; hollow: pixels are wrong", report.adapter.name);
    let mut top = plot.add_heading(&[facts]);
    for scene in scenes {
        plot.charts.push(chart(report, scene, &name).moved([0.0, top]));
        top += HEIGHT;
    }
    let ends = plot.charts.iter().flat_map(|chart| &chart.labels).map(|label| label.rect().max[0] + 8.0);
    plot.size = [ends.fold(WIDTH, f64::max), top];
    plot
}

/// Returns the lines of a scene's chart: for each technique with its settings the name and the indices of its rows, in
/// the order of values. Rows that are not of a sweep, or not measured, are left out.
fn lines_of(report: &Report, scene: &str) -> Vec<(String, Vec<usize>)> {
    let mut lines: Vec<(String, Vec<usize>)> = Vec::new();
    for index in report.rows_of(scene) {
        let row = &report.rows[index];
        if row.sweep.is_none() || !row.is_measured() {
            continue;
        }
        match lines.iter_mut().find(|(name, _)| *name == row.name()) {
            Some((_, rows)) => rows.push(index),
            None => lines.push((row.name(), vec![index])),
        }
    }
    lines
}

fn chart(report: &Report, scene: &str, name: &str) -> SceneChart {
    let lines_of = lines_of(report, scene);
    let rows = || lines_of.iter().flat_map(|(_, rows)| rows).map(|index| &report.rows[*index]);
    let area = PlotRect { min: [LEFT, TOP], max: [WIDTH - RIGHT, HEIGHT - BOTTOM] };
    let values = |row: &ReportRow| row.sweep.as_ref().map_or(1.0, |swept| swept.value);
    let across = LogScale::new(scale::range(rows().map(values), [1.0, 10.0]), [area.min[0], area.max[0]]);
    let up = LogScale::new(scale::range(rows().map(|row| row.frame_ms.median), NO_TIMES), [area.max[1], area.min[1]]);
    let place = |row: &ReportRow| [across.position(values(row)), up.position(row.frame_ms.median)];
    let (mut lines, mut spots, mut names) = (Vec::new(), Vec::new(), Vec::new());
    let mut values_shown: Vec<&SweepValue> = Vec::new();
    let mut texts = vec![
        PlotText::new([8.0, 10.0], scene, TITLE_SIZE, PlotInk::Text).strong(),
        PlotText::small([8.0, 28.0], "frame time, median"),
        PlotText::small([area.max[0] + FPS, 28.0], "frames a second"),
        PlotText::small([area.max[0], area.max[1] + 32.0], name).anchored(TextAnchor::End),
    ];
    for tick in up.ticks(17.0) {
        let y = up.position(tick);
        lines.push(PlotLine::grid([[area.min[0], y], [area.max[0], y]]));
        texts.push(PlotText::small([area.min[0] - 6.0, y], format!("{tick}\u{a0}ms")).anchored(TextAnchor::End));
        let fps = (1000.0 / tick * 100.0).round() / 100.0;
        texts.push(PlotText::small([area.max[0] + FPS, y], fps.to_string()));
    }
    for (caption, rows) in &lines_of {
        let style = style_of(&report.rows[rows[0]].technique);
        let points: Vec<[f64; 2]> = rows.iter().map(|index| place(&report.rows[*index])).collect();
        names.extend(points.last().map(|end| (end[1], caption.clone(), style)));
        for (index, at) in rows.iter().zip(&points) {
            let row = &report.rows[*index];
            let filled = row.wrong() == 0;
            let whisker = [at[0]; 2];
            let value = row.sweep.as_ref().map_or("", |swept| &swept.text);
            let name = format!("{} at {value}", row.summary());
            spots.push(PlotPoint { row: *index, at: *at, whisker, style, filled, name, details: row.details() });
            if let Some(swept) = row.sweep.as_ref().filter(|swept| !values_shown.contains(swept)) {
                values_shown.push(swept);
            }
        }
        if points.len() > 1 {
            lines.push(PlotLine { points, width: 1.3, ink: PlotInk::Technique(style), faint: false });
        }
    }
    // Values that were measured, as far as there is space for their texts.
    values_shown.sort_by(|a, b| a.value.total_cmp(&b.value));
    let mut free_from = f64::NEG_INFINITY;
    for swept in values_shown {
        let x = across.position(swept.value);
        lines.insert(0, PlotLine::grid([[x, area.min[1]], [x, area.max[1]]]));
        let text = PlotText::small([x, area.max[1] + 13.0], &*swept.text).anchored(TextAnchor::Middle);
        if text.rect().min[0] > free_from {
            free_from = text.rect().max[0] + 6.0;
            texts.push(text);
        }
    }
    // Names at the ends of their lines, apart.
    names.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut low = area.min[1] - NAME_HEIGHT;
    let height = area.max[1] + 4.0 - NAME_HEIGHT * names.len() as f64;
    let labels = names.into_iter().enumerate().map(|(index, (y, caption, style))| {
        low = y.min(height + NAME_HEIGHT * (index + 1) as f64).max(low + NAME_HEIGHT);
        PlotText::new([area.max[0] + NAMES, low], caption, SMALL_SIZE, PlotInk::Technique(style))
    });
    let labels = labels.collect();
    SceneChart {
        title: scene.to_owned(),
        area,
        band: PlotRect { min: [area.min[0], area.max[1]], max: area.max },
        lines,
        spots,
        texts,
        labels,
    }
}
