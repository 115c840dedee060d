//! The results as a page in Markdown that stands alone: the command that writes it, the plot, the table, how to read
//! it, and what each case is.

use super::{StressCase, StressResults, StressVerdict};
use crate::numbers;
use crate::report::PageOrigin;

/// The section that explains the table.
const READING: &str = "A case is a scene with one number, from easy to extreme. A technique is expected to be right, or to fail in a way \
that has a name; a failure that nobody expected is unexpected, and so is a known one that does not show. The table says at which \
value each technique first has a wrong pixel, and what that failure is called. A dot: it has none. Empty: it was not run, for a \
reason that the case tells. *Other forms* are techniques with other settings.";

impl StressResults {
    /// Returns the results as a Markdown page: command, plot, machine, totals, how to read them, the table, and each
    /// case's lesson.
    pub fn to_page(&self, origin: PageOrigin) -> String {
        let opening = origin.opening("Driven to the extreme", "Share of wrong pixels against the number of each sweep");
        let [width, height] = self.size;
        let summaries = self.summary();
        let count =
            |verdict| numbers::count(summaries.iter().filter(|summary| summary.verdict == verdict).count() as u64);
        let mut names: Vec<&str> = summaries.iter().map(|summary| summary.case).collect();
        names.dedup();
        let lessons = names
            .iter()
            .filter_map(|name| StressCase::named(name))
            .map(|case| format!("- `{}`: {}\n", case.name, case.lesson));
        format!(
            "{opening}on {}, {} ({}); pictures of {width}×{height}. Of {} cases by techniques {} hold, {} fail as known, and {} \
             are unexpected.\n\n{READING}\n\n{}\n## Cases\n\n{}",
            self.adapter.name,
            self.adapter.driver,
            self.adapter.kind,
            numbers::count(summaries.len() as u64),
            count(StressVerdict::Holds),
            count(StressVerdict::FailsAsKnown),
            count(StressVerdict::Unexpected),
            self.to_markdown(),
            lessons.collect::<String>(),
        )
    }
}
