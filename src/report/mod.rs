//! What a technique costs and how often it is wrong: the report's rows, and every format that they are written in.
//!
//! ```text
//! rows ──► Report ──► JSON, CSV, text table, Markdown, page
//!             └─────► plot::Plot (a layout in points) ──► SVG ──► PNG
//!                                                     └─► the inspector's Report tab
//! ```
//!
//! Nothing here measures, opens a file or knows a GPU: a report is data, and so is its plot.

mod csv;
mod page;
pub mod plot;
#[cfg(feature = "formats")]
mod svg;
mod table;

#[cfg(test)]
pub(crate) mod tests;

pub use page::PageOrigin;

use crate::accuracy::{ErrorCounts, VisibilityError};
use crate::capture::AdapterInfo;
use crate::numbers;
use crate::shards::{self, MergeError, ResultsFile, ShardPart};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the JSON format.
const SCHEMA: u32 = 1;

/// The measured error and run time of techniques with their settings in scenes, one row each, on one machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ReportDocument", into = "ReportDocument")]
pub struct Report {
    /// The adapter that it was measured on.
    pub adapter: AdapterInfo,
    /// One row for each scene, technique and choice of settings, in the order in which they are listed.
    pub rows: Vec<ReportRow>,
    /// Which part of a run it is; `None` for a whole run.
    pub part: Option<ShardPart>,
}

/// A report, and the names of the rows that were left out because they exceed the memory budget.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredReport {
    /// The report with the rows that were measured.
    pub report: Report,
    /// Names of rows that are left out, since they would take too much of this machine's memory: `shadow-map 4096`.
    pub left_out: Vec<String>,
    /// All is measured; otherwise rows are missing, or their times are those of fewer frames than were asked for.
    pub is_whole: bool,
}

/// The error and times of one scene rendered by one technique with one choice of settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReportRow {
    /// Name of the scene.
    pub scene: String,
    /// Name of the technique.
    pub technique: String,
    /// Value of every setting of the technique, by the setting's name.
    pub settings: BTreeMap<String, String>,
    /// What distinguishes this row from others of its technique: `1024`, `1024, slope 0`; may be empty.
    #[serde(default)]
    pub label: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The sweep's value at which it was measured; `None` in a report without a sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepValue>,
    /// Numbers of pixels by finding, compared with the truth and summed over lights.
    #[serde(flatten)]
    pub error: ErrorCounts,
    /// Share of the compared pixels that are wrong, 0 to 1; 0 where nothing was compared.
    pub wrong_fraction: f64,
    /// Number of pixels, background included, whose colour differs from the ray-traced picture in the same shading;
    /// each counts once, however many lights there are. `None` in reports from before it was measured.
    #[serde(default)]
    pub wrong_color: Option<u64>,
    /// How far the share of the lights that arrives is from the truth's, over all lights together; `None` for
    /// techniques that know no shares.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visibility_error: Option<VisibilityError>,
    /// Wall times of a frame without set-up, milliseconds.
    pub frame_ms: FrameTimes,
    /// Frame times including set-up, where the scene moves and every frame is set up again; `None` where it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving: Option<MotionCost>,
    /// GPU time of a frame in milliseconds; `None` where the hardware can't measure it.
    pub gpu_ms: Option<f64>,
    /// Time of planning, geometry, pipelines and uploads of this row alone, milliseconds; opening the scene and the
    /// GPU, which all rows share, is not in it.
    pub setup_ms: f64,
    /// Number of triangles submitted in a frame.
    pub triangles: u64,
    /// GPU memory of buffers and attachments, bytes.
    pub bytes: u64,
    /// True for rows on the Pareto front: no other row of the scene is at least as fast and at least as right, and one
    /// of the two more. See [`Report::mark_pareto`].
    pub pareto: bool,
}

/// Times of a frame of a moving scene, which is set up again for every frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MotionCost {
    /// Median time of setting it up (silhouettes, proofs, uploads), milliseconds.
    pub setup_ms: f64,
    /// Median time of setting up and drawing a frame, milliseconds.
    pub total_ms: f64,
    /// The share of set-up in the time of all frames together, 0 to 1.
    pub setup_share: f64,
}

/// One value of the number that a sweep changes, such as the number of lights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepValue {
    /// Name of what changes: `size`, `lights`, `casters`, `triangles` or `map-size`.
    pub name: String,
    /// The value as a number; for picture sizes the number of pixels.
    pub value: f64,
    /// The value as it is shown: `1280×720`.
    pub text: String,
}

/// Median and range of the wall times of repeated frames of one row, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrameTimes {
    /// The median time, milliseconds.
    pub median: f64,
    /// The shortest time, milliseconds.
    pub min: f64,
    /// The longest time, milliseconds.
    pub max: f64,
    /// The number of frames that were timed.
    pub runs: u32,
}

/// Why a report can't be read from JSON, or its plot can't be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The text is not JSON, or not a report's.
    #[error("the report can't be read or written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The JSON was written by a version with another format.
    #[error("a report of schema {found} can't be read: make it again, this version knows schema {SCHEMA}")]
    Schema {
        /// The format version that the file names.
        found: u32,
    },
    /// The plot's SVG can't be rendered, or is too large.
    #[error("the plot can't be drawn as pixels: {0}; save it as .svg instead")]
    #[cfg(feature = "formats")]
    Svg(#[from] crate::picture::svg::SvgError),
    /// The PNG encoder failed.
    #[error("the plot can't be written as PNG: {0}; save it as .svg instead")]
    Png(#[from] png::EncodingError),
}

/// The JSON file of a report: its format version beside its content.
#[derive(Serialize, Deserialize)]
struct ReportDocument {
    schema: u32,
    adapter: AdapterInfo,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shard: Option<ShardPart>,
    rows: Vec<ReportRow>,
}

impl From<Report> for ReportDocument {
    fn from(report: Report) -> ReportDocument {
        ReportDocument { schema: SCHEMA, adapter: report.adapter, shard: report.part, rows: report.rows }
    }
}

impl TryFrom<ReportDocument> for Report {
    type Error = ReportError;

    fn try_from(document: ReportDocument) -> Result<Report, ReportError> {
        match document.schema {
            SCHEMA => Ok(Report { adapter: document.adapter, rows: document.rows, part: document.shard }),
            found => Err(ReportError::Schema { found }),
        }
    }
}

impl Report {
    /// Returns a report of these rows, computing what follows from them and replacing what they had:
    /// [`ReportRow::wrong_fraction`] and [`ReportRow::pareto`]. It is not part of a run.
    pub fn new(adapter: AdapterInfo, rows: Vec<ReportRow>) -> Report {
        let mut report = Report { adapter, rows, part: None };
        for row in &mut report.rows {
            row.wrong_fraction = row.error.wrong_fraction();
        }
        report.mark_pareto();
        report
    }

    /// Merges the reports of all parts of a run, each with its file's name, to one with the rows in the order of the
    /// whole run. Fails where a part is missing, twice there, or of another run or machine.
    pub fn merged(parts: Vec<(String, Report)>) -> Result<Report, MergeError> {
        let adapter = parts.first().map(|(_, report)| report.adapter.clone()).ok_or(MergeError::Nothing)?;
        let part = |(name, Report { adapter, rows, part }): (String, Report)| ResultsFile {
            name,
            adapter: adapter.in_words(),
            part,
            rows,
        };
        Ok(Report::new(adapter, shards::merged(parts.into_iter().map(part).collect())?))
    }

    /// Marks the rows that no other row of their scene beats: one beats another where it is at
    /// least as fast (median) and at least as right, and one of the two more. Of equal rows all
    /// are marked; a row without a usable time or error is neither marked nor beats.
    pub fn mark_pareto(&mut self) {
        let marks: Vec<bool> = self
            .rows
            .iter()
            .map(|row| row.is_measured() && !self.rows.iter().any(|other| other.is_beside(row) && beats(other, row)))
            .collect();
        for (row, mark) in self.rows.iter_mut().zip(marks) {
            row.pareto = mark;
        }
    }

    /// Returns whether any of the report's rows is of a sweep.
    pub fn is_swept(&self) -> bool {
        self.rows.iter().any(|row| row.sweep.is_some())
    }

    /// Returns the indices of a scene's rows in the report's order; of a sweep, grouped by technique with its settings,
    /// so that each one's values follow each other. Empty for an unknown scene.
    pub fn rows_of(&self, scene: &str) -> Vec<usize> {
        let mut rows: Vec<usize> = (0..self.rows.len()).filter(|index| self.rows[*index].scene == scene).collect();
        let names: Vec<String> = rows.iter().map(|index| self.rows[*index].name()).collect();
        let first = |index: usize| names.iter().position(|name| *name == self.rows[index].name());
        if self.is_swept() {
            rows.sort_by_key(|index| first(*index));
        }
        rows
    }

    /// Returns the names of the scenes, in the order in which they first appear.
    pub fn scenes(&self) -> Vec<&str> {
        let mut scenes: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !scenes.contains(&row.scene.as_str()) {
                scenes.push(&row.scene);
            }
        }
        scenes
    }

    /// Returns the report as indented JSON.
    pub fn to_json(&self) -> Result<String, ReportError> {
        Ok(serde_json::to_string_pretty(self)?)
    }

    /// Reads a report from JSON.
    pub fn from_json(text: &str) -> Result<Report, ReportError> {
        Ok(serde_json::from_str(text)?)
    }

    /// Returns the report as CSV (RFC 4180): a heading line, then one line for each row.
    pub fn to_csv(&self) -> String {
        csv::csv(self)
    }

    /// Returns the report as a text table with whole names, however wide.
    pub fn to_table(&self) -> String {
        table::text(self, false)
    }

    /// Returns the report as a table for a terminal: as [`Report::to_table`] does, with names shortened where it would be 140
    /// columns wide or more.
    pub fn to_narrow_table(&self) -> String {
        table::text(self, true)
    }

    /// Returns the report as a Markdown table.
    pub fn to_markdown(&self) -> String {
        table::markdown(self)
    }

    /// Returns the plot for paper, as SVG.
    #[cfg(feature = "formats")]
    pub fn to_svg(&self) -> String {
        svg::svg(&if self.is_swept() { plot::sweep(self) } else { plot::layout(self, &plot::PlotPage::PAPER) })
    }

    /// Returns the plot for paper, as PNG with two pixels a point.
    #[cfg(feature = "formats")]
    pub fn to_png(&self) -> Result<Vec<u8>, ReportError> {
        Ok(crate::picture::svg::picture(&self.to_svg(), 2.0)?.to_png()?)
    }
}

impl plot::Plot {
    /// Returns the plot for paper, as SVG.
    #[cfg(feature = "formats")]
    pub fn to_svg(&self) -> String {
        svg::svg(self)
    }

    /// Returns the plot for paper, as PNG with two pixels a point.
    #[cfg(feature = "formats")]
    pub fn to_png(&self) -> Result<Vec<u8>, ReportError> {
        Ok(crate::picture::svg::picture(&self.to_svg(), 2.0)?.to_png()?)
    }
}

/// Returns whether `one` is measured, at least as fast and at least as right as `other`, and better in one of the two.
fn beats(one: &ReportRow, other: &ReportRow) -> bool {
    let (time, error) = (one.cost_ms(), one.wrong_fraction);
    let (other_time, other_error) = (other.cost_ms(), other.wrong_fraction);
    one.is_measured() && time <= other_time && error <= other_error && (time < other_time || error < other_error)
}

impl ReportRow {
    /// Returns whether both rows are of the same scene and the same value of a sweep, so that they can be compared.
    pub fn is_beside(&self, other: &ReportRow) -> bool {
        self.scene == other.scene && self.sweep == other.sweep
    }

    /// Returns the median frame time in milliseconds, including set-up where the scene moves.
    pub fn cost_ms(&self) -> f64 {
        self.moving.map_or(self.frame_ms.median, |moving| moving.total_ms)
    }

    /// Returns frames per second, from [`ReportRow::cost_ms`].
    pub fn fps(&self) -> f64 {
        1000.0 / self.cost_ms()
    }

    /// Returns the number of wrong pixels of all kinds.
    pub fn wrong(&self) -> u64 {
        self.error.wrong()
    }

    /// Returns whether the row can be ranked and drawn: a pixel was compared, and error and time are finite and not
    /// negative. A time of 0 counts as measured; [`ReportRow::problem`] says what is missing.
    pub fn is_measured(&self) -> bool {
        self.problem().is_none()
    }

    /// Returns why the row can't be ranked or drawn, in a few words: no pixel was compared, or error or time is
    /// negative or no finite number. `None` where it can.
    pub fn problem(&self) -> Option<&'static str> {
        if self.error.compared == 0 {
            return Some("no pixel was compared");
        }
        let is_usable = |value: f64| value.is_finite() && value >= 0.0;
        if !is_usable(self.wrong_fraction) {
            return Some("its error is no number");
        }
        (!is_usable(self.frame_ms.median)).then_some("its time is no number")
    }

    /// Returns the technique's name and the row's label: `shadow-map 1024`.
    pub fn name(&self) -> String {
        if self.label.is_empty() { self.technique.clone() } else { format!("{} {}", self.technique, self.label) }
    }

    /// Returns the row in a few words: `shadow-map 1024: 0.12 % wrong, 3.1 ms`.
    pub fn summary(&self) -> String {
        let wrong = match self.wrong_fraction {
            0.0 => "none wrong".to_owned(),
            fraction => format!("{} wrong", numbers::percent(fraction)),
        };
        format!("{}: {wrong}, {} ms", self.name(), numbers::milliseconds(self.frame_ms.median))
    }

    /// Returns the row's results in a few lines: wrong pixels by kind, wrong colours, times, triangles and memory.
    pub fn details(&self) -> String {
        let count = numbers::count;
        let times = self.frame_ms;
        let ms = numbers::milliseconds;
        let mut lines = vec![
            self.summary(),
            format!(
                "{} wrong of {}: {} false shadow, {} missing shadow, {} wrong surface",
                count(self.wrong()),
                count(self.error.compared),
                count(self.error.false_shadow),
                count(self.error.missing_shadow),
                count(self.error.wrong_surface),
            ),
            format!(
                "{} of another colour, background included",
                self.wrong_color.map_or_else(|| "?".to_owned(), count)
            ),
            format!(
                "{} to {} ms in {} frames, set-up {} ms",
                ms(times.min),
                ms(times.max),
                times.runs,
                ms(self.setup_ms)
            ),
            format!("{} triangles, {} MiB", count(self.triangles), numbers::mebibytes(self.bytes)),
        ];
        lines.extend(self.visibility_error.map(|error| error.in_words()));
        if self.pareto {
            lines.push("Nothing here is both faster and more right.".to_owned());
        }
        lines.join("\n")
    }
}
