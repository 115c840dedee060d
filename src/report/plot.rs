//! The plot's layout as data: where every mark, line and text goes, in points, y downwards.
//!
//! One small chart a scene, all on the same axes. Across: the median frame time, log. Up: wrong pixels of those
//! compared, log; as zero has no place on a log axis, rows without a wrong pixel have a band of their own below it, in
//! lanes so that they do not cover each other. SVG, PNG and the inspector draw the same layout; each gives [`PlotInk`]s
//! its own colours.
//!
//! ```text
//! plot.rs    what a layout consists of; charts in rows on a page
//! around.rs  heading, legend, notes           chart.rs   one scene's chart
//! scale.rs   log scales and their ticks       labels.rs  texts beside points, apart
//! axes.rs    area, band, grid and ticks       marks.rs   shape and colour of each technique
//! swept.rs   a sweep's page: time against its value, a line each
//! ```

mod around;
pub(crate) mod axes;
mod chart;
pub(crate) mod labels;
mod marks;
pub(crate) mod scale;
mod swept;

#[cfg(test)]
mod tests;

pub use marks::{MarkShape, STYLES, TechniqueStyle, UNKNOWN, style_of};
pub use swept::sweep;

use super::Report;
use around::{heading, legend, notes, summary};
use chart::ChartFrame;

/// Size of texts in points; titles are larger.
pub const TEXT_SIZE: f64 = 12.0;
/// Size of titles in points.
pub const TITLE_SIZE: f64 = 14.0;
/// Size of axis numbers and labels in points.
pub const SMALL_SIZE: f64 = 11.0;
/// Radius of a mark in points.
pub const RADIUS: f64 = 4.6;
/// Half of the side of the square around a mark that texts leave free, points: a ring around a mark lies in it.
pub const CLEAR: f64 = 9.0;

/// The title of a report's plot.
const TITLE: &str = "Wrong pixels against frame time";
/// The least width of a readable chart, points.
const LEAST_CHART_WIDTH: f64 = 300.0;
/// The least height of a readable chart, points.
const LEAST_CHART_HEIGHT: f64 = 150.0;
/// The least height of a chart where charts are below each other and the plot is scrolled anyway, points.
const LEAST_STACKED_HEIGHT: f64 = 210.0;
/// The preferred height of a chart, points.
const CHART_HEIGHT: f64 = 330.0;
/// Gap between charts, points.
const GAP: f64 = 20.0;
/// Height of a line of text, points.
const LINE: f64 = 18.0;

/// The page that a plot is laid out for: its size, and how many charts are side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlotPage {
    /// Width in points.
    pub width: f64,
    /// Height in points that the charts fill, unless they would be too low; `None` gives charts their preferred height.
    pub height: Option<f64>,
    /// The largest number of charts side by side.
    pub most_columns: usize,
    /// True leaves out title, adapter and legend, and makes margins small: for a plot beside a table that has them.
    pub compact: bool,
}

impl PlotPage {
    /// The page for files: a sheet of paper, or a picture in a web page.
    pub const PAPER: PlotPage = PlotPage { width: 760.0, height: None, most_columns: 2, compact: false };
}

/// An axis-aligned rectangle in points, y downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlotRect {
    /// Upper left corner.
    pub min: [f64; 2],
    /// Lower right corner.
    pub max: [f64; 2],
}

impl PlotRect {
    /// Returns whether the two share more than an edge.
    pub fn overlaps(&self, other: &PlotRect) -> bool {
        (0..2).all(|axis| self.min[axis] < other.max[axis] && other.min[axis] < self.max[axis])
    }

    /// Returns whether it contains all of `other`.
    pub fn holds(&self, other: &PlotRect) -> bool {
        (0..2).all(|axis| self.min[axis] <= other.min[axis] && other.max[axis] <= self.max[axis])
    }

    /// Returns the width in points.
    pub fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    /// Returns the height in points.
    pub fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }
}

/// The meaning of a mark, line or text, which decides its colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlotInk {
    /// Important text.
    Text,
    /// Text that matters less.
    Dim,
    /// Grid lines.
    Grid,
    /// The Pareto front.
    Front,
    /// A technique's mark or line.
    Technique(&'static TechniqueStyle),
}

/// Which part of a text is at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextAnchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// A line of text at a position of the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotText {
    /// Position in points: across as `anchor` states; down the middle of the line.
    pub at: [f64; 2],
    /// The characters.
    pub text: String,
    /// Size in points.
    pub size: f64,
    /// Which part of the text is at `at`.
    pub anchor: TextAnchor,
    /// Its meaning.
    pub ink: PlotInk,
    /// True for titles.
    pub strong: bool,
}

/// A polyline of the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotLine {
    /// The polyline's vertices in points, two or more.
    pub points: Vec<[f64; 2]>,
    /// Thickness in points.
    pub width: f64,
    /// Its meaning.
    pub ink: PlotInk,
    /// True for a line that marks must stand out from.
    pub faint: bool,
}

/// The mark of a report's row in a chart, with its whisker and texts.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotPoint {
    /// Index of the row in [`Report::rows`].
    pub row: usize,
    /// The mark's centre in points.
    pub at: [f64; 2],
    /// The x coordinates in points of the whisker's ends: the fastest and the slowest frame.
    pub whisker: [f64; 2],
    /// Shape and colour of the technique's mark.
    pub style: &'static TechniqueStyle,
    /// True for a row on the Pareto front, whose mark is filled; others are hollow.
    pub filled: bool,
    /// Text for screen readers: `shadow-map 1024: 0.12 % wrong, 3.1 ms`.
    pub name: String,
    /// Text of the tooltip, several lines.
    pub details: String,
}

/// The chart of one scene: wrong pixels upwards, frame time across.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneChart {
    /// The scene's name.
    pub title: String,
    /// The rectangle of the marks of rows with wrong pixels.
    pub area: PlotRect,
    /// The rectangle below it, for the marks of rows without a wrong pixel.
    pub band: PlotRect,
    /// Grid, joined settings, front: to be drawn in this order, below marks.
    pub lines: Vec<PlotLine>,
    /// The rows' marks, those on the Pareto front last.
    pub spots: Vec<PlotPoint>,
    /// Texts of title and axes.
    pub texts: Vec<PlotText>,
    /// The texts beside marks; no two overlap, and none covers a mark with a ring around it, or a whisker.
    pub labels: Vec<PlotText>,
}

/// A mark in the legend, which stands for a technique and no row.
#[derive(Debug, Clone, PartialEq)]
pub struct LegendKey {
    /// The mark's centre in points.
    pub at: [f64; 2],
    /// Shape and colour of the technique's mark.
    pub style: &'static TechniqueStyle,
    /// True where it is filled, as the marks of rows on the Pareto front are.
    pub filled: bool,
}

/// A plot laid out in points, ready to be drawn: charts, legend and texts.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Width and height in points.
    pub size: [f64; 2],
    /// Its title.
    pub title: String,
    /// A sentence that describes it, for screen readers.
    pub summary: String,
    /// One chart for each scene.
    pub charts: Vec<SceneChart>,
    /// Texts of heading, legend and notes.
    pub texts: Vec<PlotText>,
    /// Marks of the legend.
    pub keys: Vec<LegendKey>,
    /// Lines of the legend.
    pub lines: Vec<PlotLine>,
}

/// Estimates the width of a text in points: that of Helvetica and similar faces, and a little more than most faces
/// need. Texts that are laid out with it don't overlap in whichever face they are drawn.
pub fn text_width(text: &str, size: f64) -> f64 {
    let width = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '|' | '.' | ',' | ':' | ';' | '\'' | '!' => 0.28,
        ' ' | '\u{a0}' | 't' | 'f' | 'r' | '-' | '(' | ')' | '/' | '·' => 0.34,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '…' => 0.86,
        'A'..='Z' => 0.68,
        c if c.is_ascii() => 0.56,
        '–' | '×' | '−' => 0.6,
        _ => 1.0,
    };
    text.chars().map(width).sum::<f64>() * size
}

impl PlotText {
    /// Returns a small text in a dim colour.
    pub(crate) fn small(at: [f64; 2], text: impl Into<String>) -> PlotText {
        PlotText::new(at, text, SMALL_SIZE, PlotInk::Dim)
    }

    /// Returns a line of text.
    pub(crate) fn new(at: [f64; 2], text: impl Into<String>, size: f64, ink: PlotInk) -> PlotText {
        PlotText { at, text: text.into(), size, anchor: TextAnchor::Start, ink, strong: false }
    }

    pub(crate) fn anchored(self, anchor: TextAnchor) -> PlotText {
        PlotText { anchor, ..self }
    }

    pub(crate) fn strong(self) -> PlotText {
        PlotText { strong: true, ..self }
    }

    /// Returns the rectangle that the text covers, by [`text_width`].
    pub fn rect(&self) -> PlotRect {
        let width = text_width(&self.text, self.size);
        let left = match self.anchor {
            TextAnchor::Start => self.at[0],
            TextAnchor::Middle => self.at[0] - width / 2.0,
            TextAnchor::End => self.at[0] - width,
        };
        let half = self.size * 0.6;
        PlotRect { min: [left, self.at[1] - half], max: [left + width, self.at[1] + half] }
    }
}

impl PlotLine {
    /// Returns a grid line.
    pub(crate) fn grid(points: [[f64; 2]; 2]) -> PlotLine {
        PlotLine { points: points.to_vec(), width: 1.0, ink: PlotInk::Grid, faint: false }
    }
}

/// Returns the plot of `report`, laid out for `page`.
pub fn layout(report: &Report, page: &PlotPage) -> Plot {
    let width = page.width.max(LEAST_CHART_WIDTH);
    let scenes: Vec<(&str, Vec<usize>)> = report
        .scenes()
        .into_iter()
        .map(|scene| {
            let is_drawn = |index: &usize| report.rows[*index].scene == scene && report.rows[*index].is_measured();
            (scene, (0..report.rows.len()).filter(is_drawn).collect())
        })
        .collect();
    let mut plot = Plot { title: TITLE.to_owned(), summary: summary(report), ..Plot::empty(width) };
    let top = if page.compact { 0.0 } else { heading(&mut plot, report) };
    let legend = if page.compact { Plot::empty(width) } else { legend(report, width) };
    let notes = notes(report, width);
    let around_legend = if page.compact { 0.0 } else { 8.0 };
    let below = legend.size[1] + notes.len() as f64 * LINE + 2.0 * around_legend;
    let columns = columns(width, page.most_columns, scenes.len());
    let chart_width = (width - GAP * (columns - 1) as f64) / columns as f64;
    let rows = scenes.len().div_ceil(columns);
    let gaps = rows.saturating_sub(1) as f64 * GAP / 2.0;
    let height = page.height.map_or(CHART_HEIGHT, |height| (height - top - below - gaps) / rows.max(1) as f64);
    let least = if rows > 1 { LEAST_STACKED_HEIGHT } else { LEAST_CHART_HEIGHT };
    let frame = ChartFrame::new(report, &scenes, [chart_width, height.max(least)], page.compact);
    let mut bottom = top;
    for (index, (scene, rows)) in scenes.iter().enumerate() {
        let column = index % columns;
        let corner =
            [column as f64 * (chart_width + GAP), top + (index / columns) as f64 * (frame.size[1] + GAP / 2.0)];
        plot.charts.push(chart::chart(report, scene, rows, &frame, corner));
        bottom = corner[1] + frame.size[1];
    }
    if scenes.is_empty() {
        plot.texts.push(PlotText::new([8.0, bottom + LINE], "Nothing was measured.", TEXT_SIZE, PlotInk::Dim));
        bottom += 2.0 * LINE;
    }
    plot.add(legend, bottom + around_legend);
    plot.size[1] += around_legend;
    let notes_top = plot.size[1];
    for (index, note) in notes.into_iter().enumerate() {
        let at = [8.0, notes_top + (index as f64 + 0.5) * LINE];
        plot.texts.push(PlotText::small(at, note));
        plot.size[1] = at[1] + LINE / 2.0;
    }
    plot
}

/// Returns how many charts are placed side by side: those that fit, but no more than make the lines of charts equally
/// long.
fn columns(width: f64, most: usize, charts: usize) -> usize {
    let fit = ((width + GAP) / (LEAST_CHART_WIDTH + GAP)).floor() as usize;
    fit.min(most).min(charts).max(1)
}

impl Plot {
    /// Returns a plot with no content, and no height yet.
    pub(crate) fn empty(width: f64) -> Plot {
        Plot {
            size: [width, 0.0],
            title: String::new(),
            summary: String::new(),
            charts: Vec::new(),
            texts: Vec::new(),
            keys: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Adds the title and, in lines below it, what was measured; returns the position below them.
    pub(crate) fn add_heading(&mut self, facts: &[String]) -> f64 {
        self.texts.push(PlotText::new([8.0, 18.0], self.title.clone(), TITLE_SIZE + 2.0, PlotInk::Text).strong());
        let mut y = 38.0;
        for line in facts {
            self.texts.push(PlotText::new([8.0, y], line, TEXT_SIZE, PlotInk::Dim));
            y += LINE;
        }
        y
    }

    /// Adds everything of another plot, moved down by `top` points.
    fn add(&mut self, part: Plot, top: f64) {
        let down = |[x, y]: [f64; 2]| [x, y + top];
        self.texts.extend(part.texts.into_iter().map(|text| PlotText { at: down(text.at), ..text }));
        self.keys.extend(part.keys.into_iter().map(|key| LegendKey { at: down(key.at), ..key }));
        let lines = part.lines.into_iter();
        self.lines.extend(lines.map(|line| PlotLine { points: line.points.into_iter().map(down).collect(), ..line }));
        self.size[1] = top + part.size[1];
    }
}
