//! Rows, and the summary of each case and technique.

use super::expect::{ExpectedResult, StressVerdict, UnexpectedResult};
use super::row::StressRow;
use super::trend::TechniqueCourse;
use super::{Entrant, StressCase};
use crate::capture::AdapterInfo;
use crate::shards::{self, MergeError, ResultsFile, ShardPart};

/// The results of one technique at all values of one stress case, summed up.
#[derive(Debug, Clone, PartialEq)]
pub struct StressSummary {
    /// Name of the case.
    pub case: &'static str,
    /// The technique.
    pub entrant: Entrant,
    /// The first value with a wrong pixel; `None` where no value has one.
    pub breaks_at: Option<f64>,
    /// The first value at which so many pixels are excused along edges that this hides an error; `None` where there is
    /// none.
    pub blurred_at: Option<f64>,
    /// The most wrong pixels at one value, and how many pixels were compared there.
    pub worst: (u64, u64),
    /// Number of flips of pixels over the whole motion; `None` where the case is no motion.
    pub flips: Option<u64>,
    /// The failure that must show at some value, else the one that may, else that the technique is right.
    pub expected: ExpectedResult,
    /// The failures that showed, by name, each with the first value at which it did.
    pub shown: Vec<(f64, &'static str)>,
    /// The first value with an unexpected result, and why it is unexpected.
    pub surprise: Option<(f64, UnexpectedResult)>,
    /// The first value at which the adapter can't draw, and why, in words; `None` where it draws all.
    pub not_drawn: Option<(f64, String)>,
    /// How the rows change from value to value; `None` where the case expects no trend, or they are too few.
    pub course: Option<TechniqueCourse>,
    /// The verdict on all values together.
    pub verdict: StressVerdict,
}

/// The results of a run of stress cases.
#[derive(Debug, Clone, PartialEq)]
pub struct StressResults {
    /// The adapter that it ran on.
    pub adapter: AdapterInfo,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Rows by case, then value, then technique.
    pub rows: Vec<StressRow>,
    /// Which part of a run it is; `None` for a whole run.
    pub part: Option<ShardPart>,
}

impl StressResults {
    /// Merges the results of all parts of a run, each with its file's name, to those of the whole run in its order.
    /// Fails where parts are missing, twice there, or of different runs or machines.
    pub fn merged(parts: Vec<(String, StressResults)>) -> Result<StressResults, MergeError> {
        let (adapter, size) = parts.first().map(|(_, of)| (of.adapter.clone(), of.size)).ok_or(MergeError::Nothing)?;
        let part = |(name, StressResults { adapter, rows, part, .. }): (String, StressResults)| ResultsFile {
            name,
            adapter: adapter.in_words(),
            part,
            rows,
        };
        let rows = shards::merged(parts.into_iter().map(part).collect())?;
        Ok(StressResults { adapter, size, rows, part: None })
    }

    /// Returns one entry for each case and technique (with its settings), in the order in which they first appear in
    /// the rows.
    pub fn summary(&self) -> Vec<StressSummary> {
        summary(&self.rows)
    }

    /// Returns whether any result is unexpected.
    pub fn is_unexpected(&self) -> bool {
        self.summary().iter().any(|summary| summary.verdict == StressVerdict::Unexpected)
    }
}

/// Returns one entry for each case and technique (with its settings), in the order in which they first appear in the
/// rows.
pub fn summary(rows: &[StressRow]) -> Vec<StressSummary> {
    let mut groups: Vec<Vec<&StressRow>> = Vec::new();
    for row in rows {
        let is_of_row = |group: &&mut Vec<&StressRow>| (group[0].case, group[0].entrant) == (row.case, row.entrant);
        match groups.iter_mut().find(is_of_row) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    groups.iter().map(|group| StressSummary::new(group)).collect()
}

impl StressSummary {
    /// Returns the summary of one technique's rows in one case, in the order of values: where it first breaks, its
    /// worst row, and whether all is as expected. There must be at least one row.
    fn new(rows: &[&StressRow]) -> StressSummary {
        let wrong = |row: &&&StressRow| row.error.wrong() > 0;
        let mut worst = rows.iter().copied().find(|row| row.not_drawn.is_none()).unwrap_or(rows[0]);
        let mut shown: Vec<(f64, &'static str)> = Vec::new();
        for row in rows {
            if row.error.wrong() > worst.error.wrong() {
                worst = row;
            }
            let name = row.expected.name();
            if row.verdict() == StressVerdict::FailsAsKnown && shown.iter().all(|(_, other)| *other != name) {
                shown.push((row.parameter.1, name));
            }
        }
        let expected = || rows.iter().map(|row| row.expected);
        let must = expected().find(|expected| matches!(expected, ExpectedResult::Fails(_)));
        let may = || expected().find(|expected| *expected != ExpectedResult::Right);
        let surprise = rows.iter().find_map(|row| Some((row.parameter.1, row.surprise()?)));
        let not_drawn = rows.iter().find_map(|row| Some((row.parameter.1, row.not_drawn.clone()?)));
        let drawn: Vec<&StressRow> = rows.iter().copied().filter(|row| row.not_drawn.is_none()).collect();
        let course = StressCase::named(rows[0].case).and_then(|case| case.trend?.course(&drawn));
        let is_off_course = course.as_ref().is_some_and(|course| !course.holds);
        StressSummary {
            case: rows[0].case,
            entrant: rows[0].entrant,
            breaks_at: rows.iter().find(wrong).map(|row| row.parameter.1),
            blurred_at: rows.iter().find(|row| row.is_blurred()).map(|row| row.parameter.1),
            worst: (worst.error.wrong(), worst.error.compared),
            flips: rows.iter().filter_map(|row| row.flips).reduce(|a, b| a + b),
            expected: must.or_else(may).unwrap_or(ExpectedResult::Right),
            verdict: match (surprise.is_some() || is_off_course, shown.is_empty()) {
                (true, _) => StressVerdict::Unexpected,
                _ if drawn.is_empty() => StressVerdict::NotDrawn,
                (false, false) => StressVerdict::FailsAsKnown,
                (false, true) => StressVerdict::Holds,
            },
            shown,
            surprise,
            not_drawn,
            course,
        }
    }
}

/// Rows of stress cases with their summaries, as the window shows them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StressRows {
    /// The rows, case by case.
    pub rows: Vec<StressRow>,
    /// One entry for each case and technique.
    pub summaries: Vec<StressSummary>,
}

impl StressRows {
    /// Returns these rows with their summaries.
    pub fn new(rows: Vec<StressRow>) -> StressRows {
        StressRows { summaries: summary(&rows), rows }
    }

    /// Returns these rows without those of cases that are in `newer`, followed by the `newer` ones; summaries are
    /// computed anew.
    pub fn followed_by(&self, newer: &StressRows) -> StressRows {
        let is_again = |row: &&StressRow| newer.rows.iter().any(|new| new.case == row.case);
        StressRows::new(self.rows.iter().filter(|row| !is_again(row)).chain(&newer.rows).cloned().collect())
    }

    /// Returns the summaries of a case, technique by technique.
    pub fn of<'a>(&'a self, case: &'a StressCase) -> impl Iterator<Item = &'a StressSummary> {
        self.summaries.iter().filter(|summary| summary.case == case.name)
    }
}
