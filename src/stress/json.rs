//! The machine-readable form: rows, and one entry a case and technique.

use super::{Case, Row, Stress, Summary};
use crate::capture::AdapterInfo;
use serde::Serialize;
use std::collections::BTreeMap;

/// Version of the form.
const SCHEMA: u32 = 1;

impl Stress {
    /// As `spec/commands.md` has it.
    ///
    /// # Errors
    /// Numbers that JSON can't hold.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let rows = self.rows.iter().map(RowEntry::new).collect();
        let summary = self.summary().iter().map(SummaryEntry::new).collect();
        let document = Document { schema: SCHEMA, adapter: &self.adapter, size: self.size, rows, summary };
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}

#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    adapter: &'a AdapterInfo,
    size: [u32; 2],
    rows: Vec<RowEntry<'a>>,
    summary: Vec<SummaryEntry>,
}

#[derive(Serialize)]
struct Parameter {
    name: &'static str,
    value: f64,
}

#[derive(Serialize)]
struct RowEntry<'a> {
    case: &'static str,
    parameter: Parameter,
    technique: &'static str,
    settings: &'a BTreeMap<String, String>,
    compared: u64,
    false_shadow: u64,
    missing_shadow: u64,
    wrong_surface: u64,
    edge_band: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    flips: Option<u64>,
    expected: &'static str,
    verdict: &'static str,
    frame_ms: f64,
    setup_ms: f64,
}

impl<'a> RowEntry<'a> {
    fn new(row: &'a Row) -> RowEntry<'a> {
        RowEntry {
            case: row.case,
            parameter: Parameter { name: row.parameter.0, value: row.parameter.1 },
            technique: row.entrant.technique.name(),
            settings: &row.settings,
            compared: row.error.compared,
            false_shadow: row.error.false_shadow,
            missing_shadow: row.error.missing_shadow,
            wrong_surface: row.error.wrong_surface,
            edge_band: row.error.edge_band,
            flips: row.flips,
            expected: row.expected.name(),
            verdict: row.verdict().name(),
            frame_ms: row.frame_ms,
            setup_ms: row.setup_ms,
        }
    }
}

#[derive(Serialize)]
struct SummaryEntry {
    case: &'static str,
    technique: &'static str,
    settings: BTreeMap<&'static str, &'static str>,
    breaks_at: Option<f64>,
    worst: u64,
    compared: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    flips: Option<u64>,
    expected: &'static str,
    because: &'static str,
    verdict: &'static str,
}

impl SummaryEntry {
    fn new(summary: &Summary) -> SummaryEntry {
        SummaryEntry {
            case: summary.case,
            technique: summary.entrant.technique.name(),
            settings: summary.entrant.settings.iter().copied().collect(),
            breaks_at: summary.breaks_at,
            worst: summary.worst.0,
            compared: summary.worst.1,
            flips: summary.flips,
            expected: summary.expected.name(),
            because: Case::named(summary.case).map_or("", |case| case.because(&summary.entrant)),
            verdict: summary.verdict.name(),
        }
    }
}
