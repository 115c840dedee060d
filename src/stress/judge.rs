//! Rows, and what they say of each case and technique.

use super::expect::{Expected, Surprise, Verdict};
use super::row::Row;
use super::trend::Course;
use super::{Case, Entrant};
use crate::capture::AdapterInfo;
use crate::shards::{self, MergeError, Part, PartOf};

/// How a technique did in a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Name of the case.
    pub case: &'static str,
    /// The technique.
    pub entrant: Entrant,
    /// The first value with a wrong pixel; `None` where there is none.
    pub breaks_at: Option<f64>,
    /// The first value with too many pixels excused along edges; `None` where there is none.
    pub blurred_at: Option<f64>,
    /// Most wrong pixels at one value, of how many compared.
    pub worst: (u64, u64),
    /// Flips over the whole motion.
    pub flips: Option<u64>,
    /// The failure that must show at some value, else the one that may, else to be right.
    pub expected: Expected,
    /// The failures that showed, by name, each with its first value.
    pub shown: Vec<(f64, &'static str)>,
    /// The first value at which something was unexpected.
    pub surprise: Option<(f64, Surprise)>,
    /// What became of the rows from value to value, where the case asks for it.
    pub course: Option<Course>,
    /// Of the whole.
    pub verdict: Verdict,
}

/// What was run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stress {
    /// Where.
    pub adapter: AdapterInfo,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Case by case, value by value, technique by technique.
    pub rows: Vec<Row>,
    /// Which part of a run it is; `None` of a whole one.
    pub part: Option<Part>,
}

impl Stress {
    /// Those of all parts of a run, each with its file's name, as of one run.
    pub fn merged(parts: Vec<(String, Stress)>) -> Result<Stress, MergeError> {
        let (adapter, size) = parts.first().map(|(_, of)| (of.adapter.clone(), of.size)).ok_or(MergeError::Nothing)?;
        let part = |(name, Stress { adapter, rows, part, .. }): (String, Stress)| PartOf {
            name,
            adapter: adapter.in_words(),
            part,
            rows,
        };
        let rows = shards::merged(parts.into_iter().map(part).collect())?;
        Ok(Stress { adapter, size, rows, part: None })
    }

    /// One entry a case and technique, in the order of the rows.
    pub fn summary(&self) -> Vec<Summary> {
        summary(&self.rows)
    }

    /// Is anything unexpected?
    pub fn is_unexpected(&self) -> bool {
        self.summary().iter().any(|summary| summary.verdict == Verdict::Unexpected)
    }
}

/// One entry a case and technique, in the order of the rows.
pub fn summary(rows: &[Row]) -> Vec<Summary> {
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        let is_of_row = |group: &&mut Vec<&Row>| (group[0].case, group[0].entrant) == (row.case, row.entrant);
        match groups.iter_mut().find(is_of_row) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    groups.iter().map(|group| Summary::new(group)).collect()
}

impl Summary {
    /// Of one technique's rows in one case: at least one.
    fn new(rows: &[&Row]) -> Summary {
        let wrong = |row: &&&Row| row.error.wrong() > 0;
        let mut worst = rows[0];
        let mut shown: Vec<(f64, &'static str)> = Vec::new();
        for row in rows {
            if row.error.wrong() > worst.error.wrong() {
                worst = row;
            }
            let name = row.expected.name();
            if row.verdict() == Verdict::FailsAsKnown && shown.iter().all(|(_, other)| *other != name) {
                shown.push((row.parameter.1, name));
            }
        }
        let expected = || rows.iter().map(|row| row.expected);
        let must = expected().find(|expected| matches!(expected, Expected::Fails(_)));
        let may = || expected().find(|expected| *expected != Expected::Right);
        let surprise = rows.iter().find_map(|row| Some((row.parameter.1, row.surprise()?)));
        let course = Case::named(rows[0].case).and_then(|case| case.trend?.course(rows));
        let is_off_course = course.as_ref().is_some_and(|course| !course.holds);
        Summary {
            case: rows[0].case,
            entrant: rows[0].entrant,
            breaks_at: rows.iter().find(wrong).map(|row| row.parameter.1),
            blurred_at: rows.iter().find(|row| row.is_blurred()).map(|row| row.parameter.1),
            worst: (worst.error.wrong(), worst.error.compared),
            flips: rows.iter().filter_map(|row| row.flips).reduce(|a, b| a + b),
            expected: must.or_else(may).unwrap_or(Expected::Right),
            verdict: match (surprise.is_some() || is_off_course, shown.is_empty()) {
                (true, _) => Verdict::Unexpected,
                (false, false) => Verdict::FailsAsKnown,
                (false, true) => Verdict::Holds,
            },
            shown,
            surprise,
            course,
        }
    }
}

/// Rows of stress cases with what they come to, as they are shown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StressRows {
    /// Case by case.
    pub rows: Vec<Row>,
    /// One entry a case and technique.
    pub summaries: Vec<Summary>,
}

impl StressRows {
    /// Of these rows.
    pub fn new(rows: Vec<Row>) -> StressRows {
        StressRows { summaries: summary(&rows), rows }
    }

    /// These, and `newer`: rows of a case that was run again go.
    pub fn followed_by(&self, newer: &StressRows) -> StressRows {
        let is_again = |row: &&Row| newer.rows.iter().any(|new| new.case == row.case);
        StressRows::new(self.rows.iter().filter(|row| !is_again(row)).chain(&newer.rows).cloned().collect())
    }

    /// What a case came to, technique by technique.
    pub fn of<'a>(&'a self, case: &'a Case) -> impl Iterator<Item = &'a Summary> {
        self.summaries.iter().filter(|summary| summary.case == case.name)
    }
}
