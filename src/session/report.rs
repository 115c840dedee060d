//! Measurements as rows of a report.

use super::{MeasuredTechnique, Measurement, median_ms, milliseconds};
use crate::report::{FrameTimes, MotionCost, ReportRow};
use crate::technique::Choice;
use std::collections::BTreeSet;
use std::time::Duration;

/// Returns rows of one scene, in the order measured, labelled by what distinguishes them `among` all choices of the
/// run; [`Report::new`](crate::report::Report::new) fills in what depends on the other rows.
pub fn report_rows(
    scene: &str,
    what: &Measurement,
    measured: &[MeasuredTechnique],
    among: &[Choice],
) -> Vec<ReportRow> {
    let row = |one: &MeasuredTechnique| {
        let frames: Vec<f64> = one.frames.iter().copied().map(milliseconds).collect();
        ReportRow {
            scene: scene.to_owned(),
            technique: one.choice.technique().name().to_owned(),
            settings: one.choice.settings().clone(),
            label: label(&one.choice, among),
            size: what.size,
            sweep: None,
            error: one.error,
            wrong_fraction: 0.0,
            wrong_color: Some(one.wrong_color),
            visibility_error: one.visibility,
            frame_ms: FrameTimes {
                median: median_ms(&one.frames).unwrap_or(f64::NAN),
                min: frames.iter().copied().fold(f64::NAN, f64::min),
                max: frames.iter().copied().fold(f64::NAN, f64::max),
                runs: frames.len() as u32,
            },
            moving: moving(one),
            gpu_ms: one.gpu_ms,
            setup_ms: one.setup_ms,
            triangles: one.triangles,
            bytes: one.bytes,
            pareto: false,
        }
    };
    measured.iter().map(row).collect()
}

/// Returns the median times of a frame of a moving scene, with the share of its set-up; `None` where nothing moves.
fn moving(one: &MeasuredTechnique) -> Option<MotionCost> {
    let ms = |all: &[Duration]| median_ms(all);
    let totals: Vec<Duration> = one.setups.iter().zip(&one.frames).map(|(setup, frame)| *setup + *frame).collect();
    let (setup_ms, total_ms) = (ms(&one.setups)?, ms(&totals)?);
    let all = |times: &[Duration]| times.iter().sum::<Duration>().as_secs_f64();
    Some(MotionCost { setup_ms, total_ms, setup_share: all(&one.setups) / all(&totals) })
}

/// Returns what distinguishes a choice from others of its technique in `among`: its size, and its other settings that
/// differ between them and are not the default, separated by commas; empty where nothing does.
fn label(one: &Choice, among: &[Choice]) -> String {
    let technique = one.technique();
    let peers = among.iter().filter(|other| other.technique() == technique);
    let differing: BTreeSet<&String> = peers
        .flat_map(|other| other.settings().iter().filter(|(key, value)| one.settings().get(*key) != Some(value)))
        .map(|(key, _)| key)
        .collect();
    let varies = |key: &str| differing.iter().any(|other| *other == key);
    let words = technique.settings().iter().filter_map(|spec| {
        let value = one.settings().get(spec.key)?;
        match spec.key {
            "size" if varies("size") => Some(value.clone()),
            key if varies(key) && value != spec.default => Some(format!("{key} {value}")),
            _ => None,
        }
    });
    words.collect::<Vec<_>>().join(", ")
}
