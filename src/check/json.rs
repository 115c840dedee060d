//! A check as JSON; `assets/help/json.md` says what each field means.

use super::{AdapterCheck, CheckedRow, CheckedScene, LabelsHash, RowVerdict, SIZE};
use crate::accuracy::ErrorCounts;
use crate::capture::{AdapterInfo, AdapterProfile};
use crate::diagnosis::Cause;
use crate::technique::Technique;
use serde::Serialize;
use std::collections::BTreeMap;

/// Version of the format.
const SCHEMA: u32 = 1;

impl AdapterCheck {
    /// Returns the check as JSON.
    ///
    /// # Errors
    /// None that a check can have: only maps with other keys than texts have some.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let rows = || self.rows().map(|(_, row)| row.verdict());
        let count = |is: fn(&RowVerdict) -> bool| rows().filter(is).count();
        let unexplained = self.unexplained();
        let document = CheckDocument {
            schema: SCHEMA,
            program: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")),
            adapter: &self.adapter,
            system: [std::env::consts::OS, std::env::consts::ARCH],
            profile: ProfileEntry {
                measured: &self.profile,
                far: AdapterProfile::FAR,
                subpixel: self.profile.subpixel(),
                far_limit: self.profile.far_limit(),
            },
            compared_with: ReferenceOrigin {
                program: format!("{} {}", env!("CARGO_PKG_NAME"), self.reference_program),
                adapter: &self.reference_adapter,
            },
            size: SIZE,
            scenes: self.scenes.iter().map(CheckedSceneEntry::new).collect(),
            summary: SummaryEntry {
                rows: rows().count(),
                equal: count(|verdict| *verdict == RowVerdict::Equal),
                no_more_wrong: count(|verdict| *verdict == RowVerdict::NoMoreWrong),
                wrong: count(|verdict| matches!(verdict, RowVerdict::Wrong { .. })),
                unexplained_truths: unexplained.truths,
                unexplained_rows: unexplained.rows,
                unexplained_histories: unexplained.histories,
                is_as_it_should_be: unexplained.is_none(),
            },
        };
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}

#[derive(Debug, Serialize)]
struct CheckDocument<'a> {
    schema: u32,
    program: &'static str,
    adapter: &'a AdapterInfo,
    system: [&'static str; 2],
    profile: ProfileEntry<'a>,
    compared_with: ReferenceOrigin<'a>,
    size: [u32; 2],
    scenes: Vec<CheckedSceneEntry<'a>>,
    summary: SummaryEntry,
}

#[derive(Debug, Serialize)]
struct ProfileEntry<'a> {
    #[serde(flatten)]
    measured: &'a AdapterProfile,
    far: [f64; 4],
    subpixel: f64,
    far_limit: f64,
}

#[derive(Debug, Serialize)]
struct ReferenceOrigin<'a> {
    program: String,
    adapter: &'a AdapterInfo,
}

#[derive(Debug, Serialize)]
struct CheckedSceneEntry<'a> {
    scene: &'a str,
    truth: TruthEntry,
    histories: Option<HistoriesEntry<'a>>,
    rows: Vec<RowEntry<'a>>,
}

#[derive(Debug, Serialize)]
struct TruthEntry {
    labels: LabelsHash,
    reference: Option<LabelsHash>,
    is_equal: Option<bool>,
}

#[derive(Debug, Serialize)]
struct HistoriesEntry<'a> {
    pixels: usize,
    agree: usize,
    disagreements: Vec<DisagreementEntry<'a>>,
}

#[derive(Debug, Serialize)]
struct DisagreementEntry<'a> {
    pixel: [u32; 2],
    reason: &'a str,
}

#[derive(Debug, Serialize)]
struct RowEntry<'a> {
    technique: Technique,
    verdict: &'static str,
    text: String,
    unexplained: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    not_drawn: Option<&'a str>,
    #[serde(flatten)]
    drawn: Option<DrawnEntry<'a>>,
    reference: Option<ReferenceEntry>,
}

#[derive(Debug, Serialize)]
struct DrawnEntry<'a> {
    labels: LabelsHash,
    wrong: u64,
    #[serde(flatten)]
    error: ErrorCounts,
    causes: Vec<CauseEntry>,
    #[serde(skip_serializing_if = "Option::is_none")]
    undiagnosed: Option<&'a str>,
    frame_ms: f64,
    timed_frames: usize,
    gpu_ms: Option<f64>,
}

#[derive(Debug, Serialize)]
struct ReferenceEntry {
    labels: LabelsHash,
    wrong: u64,
    edge_band: u64,
    causes: Vec<CauseEntry>,
}

#[derive(Debug, Serialize)]
struct CauseEntry {
    cause: Cause,
    pixels: u64,
}

#[derive(Debug, Serialize)]
struct SummaryEntry {
    rows: usize,
    equal: usize,
    no_more_wrong: usize,
    wrong: usize,
    unexplained_truths: usize,
    unexplained_rows: usize,
    unexplained_histories: usize,
    is_as_it_should_be: bool,
}

fn causes(causes: &BTreeMap<Cause, u64>) -> Vec<CauseEntry> {
    causes.iter().map(|(cause, pixels)| CauseEntry { cause: *cause, pixels: *pixels }).collect()
}

impl<'a> CheckedSceneEntry<'a> {
    fn new(scene: &'a CheckedScene) -> CheckedSceneEntry<'a> {
        let histories = scene.histories.as_ref().map(|all| {
            let disagreements = all.disagreements.iter();
            let disagreements = disagreements.map(|one| DisagreementEntry { pixel: one.pixel, reason: &one.reason });
            HistoriesEntry { pixels: all.pixels, agree: all.agreeing(), disagreements: disagreements.collect() }
        });
        CheckedSceneEntry {
            scene: &scene.scene,
            truth: TruthEntry {
                labels: scene.truth,
                reference: scene.reference_truth,
                is_equal: scene.is_truth_equal(),
            },
            histories,
            rows: scene.rows.iter().map(RowEntry::new).collect(),
        }
    }
}

impl<'a> RowEntry<'a> {
    fn new(row: &'a CheckedRow) -> RowEntry<'a> {
        let verdict = row.verdict();
        let drawn = row.drawn.as_ref().ok().map(|drawn| DrawnEntry {
            labels: drawn.labels,
            wrong: drawn.error.wrong(),
            error: drawn.error,
            causes: causes(&drawn.causes),
            undiagnosed: drawn.undiagnosed.as_deref(),
            frame_ms: drawn.frame_ms,
            timed_frames: drawn.timed_frames,
            gpu_ms: drawn.gpu_ms,
        });
        RowEntry {
            technique: row.technique,
            verdict: verdict.name(),
            text: row.in_words(),
            unexplained: if let RowVerdict::Wrong { unexplained } = verdict { unexplained } else { 0 },
            not_drawn: row.drawn.as_ref().err().map(String::as_str),
            drawn,
            reference: row.reference.as_ref().map(|reference| ReferenceEntry {
                labels: reference.labels,
                wrong: reference.wrong,
                edge_band: reference.edge_band,
                causes: causes(&reference.causes),
            }),
        }
    }
}
