//! The table for people: a line a case and technique.

use super::{Stress, Summary, Verdict};
use crate::numbers;

impl Stress {
    /// Case by case: who holds, who breaks where, and whether that was known.
    #[must_use]
    pub fn to_table(&self) -> String {
        let summaries = self.summary();
        let width = summaries.iter().map(|summary| summary.entrant.to_string().len()).max().unwrap_or(0);
        let mut text = String::new();
        let mut case = "";
        for summary in &summaries {
            if summary.case != case {
                case = summary.case;
                let lesson = super::Case::named(case).map_or("", |case| case.lesson);
                text.push_str(&format!("\n{case}: {lesson}\n"));
            }
            text.push_str(&line(summary, width));
        }
        let count = |verdict| summaries.iter().filter(|summary| summary.verdict == verdict).count();
        text.push_str(&format!(
            "\n{} hold, {} fail as known, {} unexpected\n",
            count(Verdict::Holds),
            count(Verdict::FailsAsKnown),
            count(Verdict::Unexpected)
        ));
        text
    }
}

fn line(summary: &Summary, width: usize) -> String {
    let mark = if summary.verdict == Verdict::Unexpected { "!!" } else { "  " };
    let found = match summary.breaks_at {
        None => "no wrong pixel".to_owned(),
        Some(value) => {
            let (worst, compared) = summary.worst;
            let [worst, compared] = [worst, compared].map(numbers::count);
            format!("breaks at {value}, at most {worst} of {compared} wrong")
        }
    };
    let flips = summary.flips.map_or_else(String::new, |flips| format!(", {flips} flips"));
    let (verdict, expected) = (summary.verdict.name(), summary.expected.name());
    let verdict =
        if summary.verdict == Verdict::Holds { verdict.to_owned() } else { format!("{verdict} ({expected})") };
    format!("{mark}  {:width$}  {verdict}: {found}{flips}\n", summary.entrant.to_string())
}
