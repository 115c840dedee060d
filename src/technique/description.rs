//! What is said of a technique beside its plan: one constant for each, in the technique's own file.

use super::PlanError;
use super::frame::PlanRequest;
use super::lesson::Lesson;
use crate::plan::FramePlan;

/// The rows that a technique has in a report: for each row, the (key, value) pairs of the settings that it changes.
pub type ReportRows = &'static [&'static [(&'static str, &'static str)]];

/// A single row with every setting at its default.
pub(super) const ONE_ROW: ReportRows = &[&[]];

/// The description of a technique: its help texts, the function that plans it, and its part in reports and stress
/// tables.
#[derive(Debug, Clone, Copy)]
pub struct TechniqueDescription {
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// The help text: explanation, formula and sources.
    pub lesson: Lesson,
    /// The function that plans a frame with this technique.
    pub(super) plan: fn(PlanRequest) -> Result<FramePlan, PlanError>,
    /// The settings that a report compares by default.
    pub report_rows: ReportRows,
    /// Whether stress tables compare it, and in which place.
    pub standing: ComparisonRole,
}

/// Whether stress tables compare a technique with others.
#[derive(Debug, Clone, Copy)]
pub enum ComparisonRole {
    /// It makes shadows on the GPU, and runs in every stress case that does not list techniques.
    Rival {
        /// Its place in tables of stress cases, from 0.
        place: usize,
        /// Why it is expected to be right where no failure of it is known.
        right_because: &'static str,
        /// For a technique with texels, which is never promised to be exact: the share of pixels (0 to 1) that they may
        /// make wrong along shadow edges, and why.
        texels: Option<(f64, &'static str)>,
    },
    /// It is compared with no other technique.
    Apart {
        /// Why it is not compared, in words.
        because: &'static str,
    },
}
