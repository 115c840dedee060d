//! The table for people, a line a case and technique; and one in Markdown, a row a case.

use super::{MEASURED_AT, StressCase, StressResults, StressSummary, StressVerdict, TechniqueCourse, value_text};
use crate::numbers;
use crate::technique::Technique;
use std::fmt;

impl StressResults {
    /// Returns the results as plain text: under each case's name and lesson one line for each technique (right, or
    /// where it breaks, and whether that was known); at the end the number of each verdict.
    pub fn to_table(&self) -> String {
        let summaries = self.summary();
        let width = summaries.iter().map(|summary| summary.entrant.to_string().len()).max().unwrap_or(0);
        let mut text = String::new();
        let mut case = "";
        for summary in &summaries {
            if summary.case != case {
                case = summary.case;
                let lesson = StressCase::named(case).map_or("", |case| case.lesson);
                text.push_str(&format!("\n{case}: {lesson}\n"));
            }
            text.push_str(&line(summary, width));
        }
        let count = |verdict| summaries.iter().filter(|summary| summary.verdict == verdict).count();
        let not_drawn = match count(StressVerdict::NotDrawn) {
            0 => String::new(),
            count => format!(", {count} not drawn"),
        };
        text.push_str(&format!(
            "\n{} hold, {} fail as known, {} unexpected{not_drawn}\n",
            count(StressVerdict::Holds),
            count(StressVerdict::FailsAsKnown),
            count(StressVerdict::Unexpected)
        ));
        if let Some(note) = self.size_note() {
            text.push_str(&format!("{note}\n"));
        }
        text
    }

    /// Returns a table of cases down and the usual techniques across: a dot where one is right, else where it breaks
    /// and the name of the failure. Variants are in the last column.
    pub fn to_markdown(&self) -> String {
        let summaries = self.summary();
        let mut names: Vec<&str> = summaries.iter().map(|summary| summary.case).collect();
        names.dedup();
        let rivals = Technique::rivals();
        let mut text = "| case | parameter |".to_owned();
        rivals.iter().for_each(|technique| text.push_str(&format!(" {} |", technique.name())));
        text.push_str(" other forms |\n|---|---|");
        rivals.iter().for_each(|_| text.push_str("---|"));
        text.push_str("---|\n");
        for name in names {
            let of_case = || summaries.iter().filter(|summary| summary.case == name);
            let cells = rivals.iter().map(|technique| {
                let usual = of_case().find(|s| s.entrant.technique == *technique && s.entrant.settings.is_empty());
                usual.map_or(String::new(), cell)
            });
            let others = of_case().filter(|summary| !summary.entrant.settings.is_empty());
            let others: Vec<String> = others.map(|one| format!("{}: {}", one.entrant, cell(one))).collect();
            let cells: Vec<String> = cells.chain([others.join("; ")]).collect();
            text.push_str(&format!("| {name} | {} | {} |\n", range(name), cells.join(" | ")));
        }
        if let Some(note) = self.size_note() {
            text.push_str(&format!("\n{note}\n"));
        }
        text
    }

    /// Returns a note where the pictures have another size than that at which expectations were measured; `None` where
    /// they have not.
    fn size_note(&self) -> Option<String> {
        let [width, height] = MEASURED_AT;
        (self.size != MEASURED_AT).then(|| {
            format!(
                "expectations are measured at {width}x{height}: at other sizes a failure may not show, or show more"
            )
        })
    }
}

/// Returns a case's parameter with its first and last value: `metres 10 → 1000`; empty for an unknown case, or one of
/// fewer than two values.
fn range(case: &str) -> String {
    let Some(case) = StressCase::named(case) else { return String::new() };
    match case.values {
        [] | [_] => String::new(),
        [first, .., last] => format!("{} {} → {}", case.parameter, value_text(*first), value_text(*last)),
    }
}

impl StressSummary {
    /// Returns in words at which value the technique first has a wrong pixel, and first too many excused ones; `no
    /// wrong pixel` where it has none.
    pub fn found_text(&self) -> String {
        let breaks = self.breaks_at.map(|at| format!("breaks at {}", value_text(at)));
        let blurred = self.blurred_at.filter(|at| self.breaks_at != Some(*at));
        let blurred = blurred.map(|at| format!("too many pixels excused along edges at {}", value_text(at)));
        match (breaks, blurred) {
            (None, None) => "no wrong pixel".to_owned(),
            (Some(text), None) => text,
            (None, Some(blurred)) => format!("no wrong pixel, but {blurred}"),
            (Some(text), Some(blurred)) => format!("{text}, {blurred}"),
        }
    }

    /// Returns the verdict in words, with the first surprise and its value, else with the known failures that have
    /// shown; and at which value first the adapter could not draw, and why.
    pub fn verdict_text(&self) -> String {
        let shown: Vec<&str> = self.shown.iter().map(|(_, name)| *name).collect();
        let verdict = match (self.surprise, &shown[..]) {
            (Some((at, surprise)), _) => format!("{}, at {}: {surprise}", self.verdict.name(), value_text(at)),
            (None, []) => self.verdict.name().to_owned(),
            (None, names) => format!("{} ({})", self.verdict.name(), names.join(", ")),
        };
        match &self.not_drawn {
            None => verdict,
            Some((at, because)) if self.verdict == StressVerdict::NotDrawn => {
                format!("{verdict}, at {}: {because}", value_text(*at))
            }
            Some((at, because)) => format!("{verdict}, but at {} not drawn: {because}", value_text(*at)),
        }
    }
}

impl fmt::Display for TechniqueCourse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = if self.holds { "" } else { "not as it must be: " };
        write!(f, "{word}{}", self.text)
    }
}

fn cell(summary: &StressSummary) -> String {
    let mark = if summary.verdict == StressVerdict::Unexpected { " (!)" } else { "" };
    let is_sweep = StressCase::named(summary.case).is_some_and(|case| case.values.len() > 1);
    let part = |(at, name): (f64, &str)| {
        let blur = if summary.blurred_at == Some(at) { " (too many excused)" } else { "" };
        if is_sweep { format!("{} {name}{blur}", value_text(at)) } else { format!("{name}{blur}") }
    };
    let surprise = summary.surprise.map(|(at, surprise)| part((at, &surprise.to_string())));
    let not_drawn = summary.not_drawn.as_ref().map(|(at, _)| part((*at, StressVerdict::NotDrawn.name())));
    let parts: Vec<String> = summary.shown.iter().copied().map(part).chain(surprise).chain(not_drawn).collect();
    if parts.is_empty() { format!("·{mark}") } else { format!("{}{mark}", parts.join(", ")) }
}

fn line(summary: &StressSummary, width: usize) -> String {
    let mark = if summary.verdict == StressVerdict::Unexpected { "!!" } else { "  " };
    let found = match summary.breaks_at {
        None if summary.verdict == StressVerdict::NotDrawn => "nothing to compare".to_owned(),
        None => summary.found_text(),
        Some(_) => {
            let (worst, compared) = summary.worst;
            let [worst, compared] = [worst, compared].map(numbers::count);
            format!("{}, at most {worst} of {compared} wrong", summary.found_text())
        }
    };
    let flips = summary.flips.map_or_else(String::new, |flips| format!(", {flips} flips"));
    let verdict = summary.verdict_text();
    let course = summary.course.as_ref().map_or_else(String::new, |course| format!("      {:width$}  {course}\n", ""));
    format!("{mark}  {:width$}  {verdict}: {found}{flips}\n{course}", summary.entrant.to_string())
}
