//! What is said of a technique beside its plan: one constant for each, in the technique's own file.

use super::PlanError;
use super::frame::PlanRequest;
use super::lesson::Lesson;
use crate::plan::FramePlan;

/// Rows of a technique in a report: the settings that each changes.
pub type ReportRows = &'static [&'static [(&'static str, &'static str)]];

/// A report has one row of the technique, with its defaults.
pub(super) const ONE_ROW: ReportRows = &[&[]];

/// A technique, as commands, tables and the inspector know it.
#[derive(Debug, Clone, Copy)]
pub struct TechniqueDescription {
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// What a learner should know about it.
    pub lesson: Lesson,
    /// Makes a frame's plan.
    pub(super) plan: fn(PlanRequest) -> Result<FramePlan, PlanError>,
    /// The settings that a report compares by default.
    pub report_rows: ReportRows,
    /// Its part where techniques are compared.
    pub standing: ComparisonRole,
}

/// The part of a technique where techniques are compared.
#[derive(Debug, Clone, Copy)]
pub enum ComparisonRole {
    /// It makes shadows on the GPU, and runs in every stress case that does not say otherwise.
    Rival {
        /// Its place in tables of stress cases, from 0.
        place: usize,
        /// Why it is expected to be right where no failure of it is known.
        right_because: &'static str,
        /// For a technique that is never promised to be right: the share of pixels that texels may make wrong along a
        /// shadow's edge, and why.
        texels: Option<(f64, &'static str)>,
    },
    /// It is compared with no other.
    Apart {
        /// Why it is not compared, in words.
        because: &'static str,
    },
}
