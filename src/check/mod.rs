//! Whether an adapter draws as it should: every built-in scene by every technique, compared with the truth and with what
//! comes with the program.
//!
//! ```text
//! Session::check ──► AdapterCheck ──┬─► text, JSON
//! assets/check.json ► CheckReference ┘
//! ```
//!
//! No two rasterisers set exactly the same pixels, and none needs to: a label may differ where an edge passes within the
//! step that corners snap to. So labels that are the reference adapter's pixel for pixel are `equal`; others are right
//! too while no more of them are wrong than there; and what is wrong beyond that is diagnosed. Only wrong pixels without
//! a proven cause are unexplained. Nothing here knows a GPU, and no adapter's name decides anything.

mod hash;
mod json;
mod reference;
mod reference_row;
mod row;
mod text;

pub use hash::{LabelsHash, LabelsHashError};
pub use reference::{CheckReference, CheckReferenceError, ReferenceScene};
pub use reference_row::ReferenceRow;
pub use row::{CheckedRow, DrawnRow, RowVerdict, proven_causes};

use crate::capture::{AdapterInfo, AdapterProfile};

/// Width and height of the pictures that are compared, pixels.
pub const SIZE: [u32; 2] = [320, 240];
/// How many pixels of each scene have their history compared with what the GPU stored.
pub const HISTORIES: usize = 50;
/// How many frames of each row are timed, after one that is not.
pub const TIMED_FRAMES: usize = 3;
/// If the first frame of a row takes as long as this, milliseconds, it alone is timed: a software rasteriser would spend
/// minutes on the slowest rows.
pub const LONG_FRAME_MS: f64 = 100.0;
/// Rows whose frame takes longer than this, milliseconds, are not diagnosed: each fix that is tried draws it again.
pub const LONGEST_DIAGNOSED_MS: f64 = 20_000.0;

/// How an adapter draws, beside the reference adapter.
#[derive(Debug, Clone, PartialEq)]
pub struct AdapterCheck {
    /// The adapter that is checked.
    pub adapter: AdapterInfo,
    /// How exactly it draws, measured.
    pub profile: AdapterProfile,
    /// The adapter that it is compared with.
    pub reference_adapter: AdapterInfo,
    /// Version of the program that drew there: `0.1.0`.
    pub reference_program: String,
    /// One entry for each scene.
    pub scenes: Vec<CheckedScene>,
}

/// A scene by all techniques.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedScene {
    /// Name of the built-in scene.
    pub scene: String,
    /// Hash of the ray-traced truth's labels.
    pub truth: LabelsHash,
    /// The same as the reference has it; `None` where it lacks the scene. It depends on no adapter: where they differ,
    /// the scene or the arithmetic is not the same on this system, or the reference is out of date.
    pub reference_truth: Option<LabelsHash>,
    /// Histories of pixels by z-fail; `None` where z-fail can't draw the scene.
    pub histories: Option<CheckedHistories>,
    /// One entry for each technique.
    pub rows: Vec<CheckedRow>,
}

/// Histories of some of a frame's pixels, compared with what the GPU counted and stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckedHistories {
    /// How many pixels were examined.
    pub pixels: usize,
    /// Those whose history contradicts the GPU.
    pub disagreements: Vec<HistoryDisagreement>,
}

/// A pixel whose history contradicts what the GPU counted or stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryDisagreement {
    /// Column and row.
    pub pixel: [u32; 2],
    /// The first contradiction, in words.
    pub reason: String,
}

/// Numbers of what no known cause explains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UnexplainedCounts {
    /// Scenes whose truth is not the reference's.
    pub truths: usize,
    /// Rows with wrong pixels, beyond the reference's own number, that have no proven cause; and those that can't be
    /// drawn here.
    pub rows: usize,
    /// Histories that contradict the GPU.
    pub histories: usize,
}

impl UnexplainedCounts {
    /// Returns whether there is nothing unexplained.
    pub fn is_none(self) -> bool {
        self == UnexplainedCounts::default()
    }
}

impl CheckedHistories {
    /// Returns how many of them agree with the GPU.
    pub fn agreeing(&self) -> usize {
        self.pixels - self.disagreements.len()
    }
}

impl CheckedScene {
    /// Returns whether the truth is the reference's; `None` where there is none.
    pub fn is_truth_equal(&self) -> Option<bool> {
        self.reference_truth.map(|reference| reference == self.truth)
    }
}

impl AdapterCheck {
    /// Returns all rows, each with its scene.
    pub fn rows(&self) -> impl Iterator<Item = (&CheckedScene, &CheckedRow)> {
        self.scenes.iter().flat_map(|scene| scene.rows.iter().map(move |row| (scene, row)))
    }

    /// Counts what no known cause explains.
    pub fn unexplained(&self) -> UnexplainedCounts {
        let histories = self.scenes.iter().filter_map(|scene| scene.histories.as_ref());
        UnexplainedCounts {
            truths: self.scenes.iter().filter(|scene| scene.is_truth_equal() == Some(false)).count(),
            rows: self.rows().filter(|(_, row)| row.verdict().is_unexplained()).count(),
            histories: histories.map(|histories| histories.disagreements.len()).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::row::tests::{hash, row};
    use super::*;

    fn adapter(name: &str) -> AdapterInfo {
        AdapterInfo { name: name.to_owned(), driver: "a driver 1.0".to_owned(), kind: "cpu".to_owned() }
    }

    /// A check of one scene, whose rows are these.
    pub(in crate::check) fn check(rows: Vec<CheckedRow>) -> AdapterCheck {
        let histories = CheckedHistories { pixels: HISTORIES, disagreements: Vec::new() };
        let scene = CheckedScene {
            scene: "tori".to_owned(),
            truth: hash(7),
            reference_truth: Some(hash(7)),
            histories: Some(histories),
            rows,
        };
        let profile = AdapterProfile {
            subpixel_bits: 8,
            depth_error: 6e-6,
            far_edge_error: [0.0, 0.004, 0.037, 0.39],
            behind_eye_error: 4e-7,
            draws_infinity: true,
            repeats_depth: true,
            largest_picture: 8192,
        };
        AdapterCheck {
            adapter: adapter("a card"),
            profile,
            reference_adapter: adapter("another"),
            reference_program: "0.1.0".to_owned(),
            scenes: vec![scene],
        }
    }

    #[test]
    fn truths_rows_and_histories_are_counted_apart() {
        let mut one = check(vec![row((0, &[]), Some((0, &[])), true), row((2, &[]), Some((0, &[])), false)]);
        assert_eq!(one.unexplained(), UnexplainedCounts { rows: 1, ..UnexplainedCounts::default() });
        one.scenes[0].rows.pop();
        assert!(one.unexplained().is_none());
        one.scenes[0].reference_truth = Some(hash(8));
        let disagreement = HistoryDisagreement { pixel: [3, 4], reason: "a reason".to_owned() };
        one.scenes[0].histories.as_mut().expect("histories").disagreements.push(disagreement);
        assert_eq!(one.unexplained(), UnexplainedCounts { truths: 1, rows: 0, histories: 1 });
        one.scenes[0].reference_truth = None;
        assert_eq!(one.unexplained().truths, 0, "there is nothing to compare with");
    }
}
