//! The results as JSON: rows, and one entry a case and technique.
//!
//! A row and its summary have the same `case` and `entrant`: the technique with the settings that the case gives it, as
//! in the table. `settings` are all of a row's, including the one that the number drives, and of a summary only those
//! that the entrant changes. In a summary `worst` is the most wrong pixels at one value and `compared` how many were
//! compared there; a row's `compared` is its own. `frame_ms` is the median of `timed_frames` frames, and
//! `setup_from_nothing` says that no pipeline of an earlier row was used; geometry never is.
//!
//! A part of a run, which `shard` describes, has only its rows, and summaries of these.
//!
//! `surprise` says in words why a row is unexpected, and a summary's is that of the first such row, whose value is
//! `surprise_at`; both are null where nothing is. A summary's `course` says how the rows of a case change from value to
//! value, where that is the case's lesson: `text`, and whether it `holds`; one that does not makes the summary
//! unexpected without a surprise. `breaks_at` is the first value with a wrong pixel, `too_many_excused_at` the first at
//! which so many pixels differ along edges that excusing them hides an error: a known failure may show by that alone.
//! Of a row's pixels, summed over lights, `lit` and `shadow` are the numbers in truth. Expectations are those of
//! pictures of `measured_at` pixels: at another `size` a failure may not show, or show more.

use super::{
    MEASURED_AT, StressCase, StressResults, StressRow, StressSummary, StressVerdict, TechniqueCourse, TruthCounts,
    UnexpectedResult,
};
use crate::accuracy::ErrorCounts;
use crate::capture::AdapterInfo;
use crate::shards::ShardPart;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the format.
const SCHEMA: u32 = 1;

/// Why JSON can't be read as results of stress cases.
#[derive(Debug, thiserror::Error)]
pub enum StressReadError {
    /// The text is not JSON, or fields are missing.
    #[error("the rows can't be read: {0}")]
    Json(#[from] serde_json::Error),
    /// The JSON was written by a version with another format.
    #[error("rows of schema {found} can't be read: make them again, this version knows schema {SCHEMA}")]
    Schema {
        /// The format version that the file names.
        found: u32,
    },
    /// The JSON has a case or a technique with settings that this version does not know.
    #[error("this version has no stress case `{case}` with `{entrant}`: make the rows again")]
    Unknown {
        /// Name of the case.
        case: String,
        /// Name of the technique, with its settings.
        entrant: String,
    },
}

impl StressResults {
    /// Returns the results as JSON; `assets/help/json.md` says what each field means.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let document = Document {
            schema: SCHEMA,
            adapter: self.adapter.clone(),
            size: self.size,
            measured_at: MEASURED_AT,
            shard: self.part.clone(),
            rows: self.rows.iter().map(RowEntry::new).collect(),
            summary: self.summary().iter().map(SummaryEntry::new).collect(),
        };
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }

    /// Reads what [`StressResults::to_json`] writes; the summary is not read but follows from the rows.
    pub fn from_json(text: &str) -> Result<StressResults, StressReadError> {
        let Document { schema, adapter, size, shard: part, rows, .. } = serde_json::from_str(text)?;
        if schema != SCHEMA {
            return Err(StressReadError::Schema { found: schema });
        }
        let rows = rows.into_iter().map(RowEntry::into_row).collect::<Result<_, _>>()?;
        Ok(StressResults { adapter, size, rows, part })
    }
}

/// The JSON file of stress results: its format version beside its rows. What follows from the rows is computed again
/// when it is read.
#[derive(Serialize, Deserialize)]
struct Document {
    schema: u32,
    adapter: AdapterInfo,
    size: [u32; 2],
    #[serde(skip_deserializing)]
    measured_at: [u32; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    shard: Option<ShardPart>,
    rows: Vec<RowEntry>,
    #[serde(skip_deserializing)]
    summary: Vec<SummaryEntry>,
}

#[derive(Serialize, Deserialize)]
struct Parameter {
    #[serde(skip_deserializing)]
    name: &'static str,
    value: f64,
}

#[derive(Serialize, Deserialize)]
struct RowEntry {
    case: String,
    parameter: Parameter,
    #[serde(skip_deserializing)]
    technique: &'static str,
    entrant: String,
    settings: BTreeMap<String, String>,
    #[serde(flatten)]
    error: ErrorCounts,
    #[serde(flatten)]
    seen: TruthCounts,
    #[serde(skip_serializing_if = "Option::is_none")]
    flips: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    off_limit: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    not_drawn: Option<String>,
    #[serde(skip_deserializing)]
    expected: &'static str,
    #[serde(skip_deserializing)]
    verdict: &'static str,
    #[serde(skip_deserializing)]
    surprise: Option<UnexpectedResult>,
    frame_ms: f64,
    #[serde(skip_deserializing)]
    timed_frames: usize,
    setup_ms: f64,
    #[serde(skip_deserializing)]
    setup_from_nothing: bool,
}

impl RowEntry {
    fn new(row: &StressRow) -> RowEntry {
        let case = StressCase::named(row.case);
        RowEntry {
            case: row.case.to_owned(),
            parameter: Parameter { name: row.parameter.0, value: row.parameter.1 },
            technique: row.entrant.technique.name(),
            entrant: row.entrant.to_string(),
            settings: row.settings.clone(),
            error: row.error,
            seen: row.seen,
            flips: row.flips,
            off_limit: row.off_limit,
            step: row.step,
            not_drawn: row.not_drawn.clone(),
            expected: row.expected.name(),
            verdict: row.verdict().name(),
            surprise: row.surprise(),
            frame_ms: row.frame_ms,
            timed_frames: case.map_or(1, StressCase::timed_frames),
            setup_ms: row.setup_ms,
            setup_from_nothing: case.is_some_and(|case| case.timed),
        }
    }

    fn into_row(self) -> Result<StressRow, StressReadError> {
        let value = self.parameter.value;
        let known = StressCase::named(&self.case).and_then(|known| {
            let entrant = known.entrants().into_iter().find(|one| one.to_string() == self.entrant)?;
            Some((known, entrant))
        });
        let (case, entrant) = known.ok_or(StressReadError::Unknown { case: self.case, entrant: self.entrant })?;
        Ok(StressRow {
            case: case.name,
            parameter: (case.parameter, value),
            entrant,
            settings: self.settings,
            error: self.error,
            seen: self.seen,
            flips: self.flips,
            off_limit: self.off_limit,
            step: self.step,
            not_drawn: self.not_drawn,
            expected: case.expected_on(self.step, &entrant, value),
            frame_ms: self.frame_ms,
            setup_ms: self.setup_ms,
        })
    }
}

#[derive(Serialize)]
struct SummaryEntry {
    case: &'static str,
    technique: &'static str,
    entrant: String,
    settings: BTreeMap<&'static str, &'static str>,
    breaks_at: Option<f64>,
    too_many_excused_at: Option<f64>,
    worst: u64,
    compared: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    flips: Option<u64>,
    expected: &'static str,
    because: &'static str,
    verdict: StressVerdict,
    #[serde(skip_serializing_if = "Option::is_none")]
    not_drawn: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    not_drawn_at: Option<f64>,
    surprise: Option<UnexpectedResult>,
    surprise_at: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    course: Option<TechniqueCourse>,
}

impl SummaryEntry {
    fn new(summary: &StressSummary) -> SummaryEntry {
        SummaryEntry {
            case: summary.case,
            technique: summary.entrant.technique.name(),
            entrant: summary.entrant.to_string(),
            settings: summary.entrant.settings.iter().copied().collect(),
            breaks_at: summary.breaks_at,
            too_many_excused_at: summary.blurred_at,
            worst: summary.worst.0,
            compared: summary.worst.1,
            flips: summary.flips,
            expected: summary.expected.name(),
            because: StressCase::named(summary.case).map_or("", |case| case.because(&summary.entrant)),
            verdict: summary.verdict,
            not_drawn: summary.not_drawn.as_ref().map(|(_, because)| because.clone()),
            not_drawn_at: summary.not_drawn.as_ref().map(|(at, _)| *at),
            surprise: summary.surprise.map(|(_, surprise)| surprise),
            surprise_at: summary.surprise.map(|(at, _)| at),
            course: summary.course.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::ErrorCounts;

    #[test]
    fn every_row_has_one_summary_by_case_and_entrant() {
        let cases = ["nested", "triangle-count"].map(|name| StressCase::named(name).expect("a case"));
        let row = |case: &'static StressCase, entrant: crate::stress::Entrant, value: f64| StressRow {
            case: case.name,
            parameter: (case.parameter, value),
            entrant,
            settings: case.choice(&entrant, value).expect("a choice").settings().clone(),
            error: ErrorCounts::default(),
            seen: TruthCounts::default(),
            flips: None,
            off_limit: None,
            step: None,
            not_drawn: None,
            expected: case.expected_at(&entrant, value),
            frame_ms: 1.0,
            setup_ms: 1.0,
        };
        let entrants = cases.iter().flat_map(|case| case.entrants().into_iter().map(move |entrant| (*case, entrant)));
        let of_case = |(case, entrant): (&'static StressCase, _)| case.values.iter().map(move |v| (case, entrant, *v));
        let rows = entrants.flat_map(of_case).map(|(case, entrant, value)| row(case, entrant, value)).collect();
        let adapter = AdapterInfo { name: "none".to_owned(), driver: "1".to_owned(), kind: "cpu".to_owned() };
        let stress = StressResults { adapter, size: [1, 1], rows, part: None };
        let json = stress.to_json().expect("JSON");
        assert!(StressResults::from_json(&json).expect("what was written") == stress, "not what was written");
        let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        let [rows, summary] = ["rows", "summary"].map(|key| json[key].as_array().expect("a list"));
        for row in rows {
            let is_of = |entry: &&serde_json::Value| ["case", "entrant"].iter().all(|key| entry[key] == row[key]);
            assert_eq!(summary.iter().filter(is_of).count(), 1, "{row}");
            let is_timed = row["case"] == "triangle-count";
            assert_eq!(row["timed_frames"], if is_timed { 3 } else { 1 });
            assert_eq!(row["setup_from_nothing"], is_timed);
            assert_eq!(row["surprise"].is_string(), row["verdict"] == "unexpected", "{row}");
        }
        for entry in summary {
            assert_eq!(entry["course"]["holds"].is_boolean(), entry["case"] == "triangle-count", "{entry}");
            assert_eq!(entry["surprise"].is_string(), entry["surprise_at"].is_number(), "{entry}");
        }
        assert_eq!(json["measured_at"], serde_json::json!([320, 240]));
        assert!(rows.iter().any(|row| row["entrant"] == "z-fail operations=clamp"));
    }
}
