//! A check as text, to read and to paste into a report: first version, adapter and profile, then a table of labels and
//! one of times, then in words whatever is wrong, and the sum of it.

use super::{AdapterCheck, CheckedRow, CheckedScene, LONG_FRAME_MS, ReferenceRow, RowVerdict, SIZE, TIMED_FRAMES};
use crate::diagnosis::Cause;
use crate::numbers::{count, counted, milliseconds};
use crate::technique::Technique;
use std::collections::BTreeMap;

/// The most histories that are listed one by one.
const MOST_LISTED: usize = 10;
/// What explains the signs of the table of labels.
const LEGEND: &str = "Labels, as wrong + excused pixels. = the reference's, pixel for pixel; ~ other labels, but no more \
                      of them wrong; ! more wrong, see below; ? no reference; - not drawn.";

impl AdapterCheck {
    /// Returns the check as plain text, of lines that a report can hold.
    pub fn to_text(&self) -> String {
        let [width, height] = SIZE;
        let mut text = format!(
            "stencilscope {} check\nadapter    {}\nsystem     {}, {}\ncompared   with {}, stencilscope {}, at {width}x{height}\n",
            env!("CARGO_PKG_VERSION"),
            self.adapter.in_words(),
            std::env::consts::OS,
            std::env::consts::ARCH,
            self.reference_adapter.in_words(),
            self.reference_program,
        );
        text += "\nProfile\n";
        self.profile.sentences().iter().for_each(|line| text += &format!("  {line}\n"));
        text += &format!("\n{LEGEND}\n\n{}", aligned(&self.label_table()));
        text += &format!(
            "\nMilliseconds a frame, on the wall clock / by the GPU's timestamps: median of {TIMED_FRAMES}, over {LONG_FRAME_MS} the \
             first alone.\n\n{}",
            aligned(&self.time_table())
        );
        text + "\n" + &self.findings() + &self.summary_text()
    }

    /// Returns the techniques of all rows, in the order of the first scene's.
    fn techniques(&self) -> Vec<Technique> {
        let mut techniques = Vec::new();
        self.rows().for_each(|(_, row)| {
            if !techniques.contains(&row.technique) {
                techniques.push(row.technique);
            }
        });
        techniques
    }

    /// Returns a table of scenes down and techniques across, with a cell of each row after the first ones of a scene.
    fn table(
        &self,
        head: &[&str],
        first: impl Fn(&CheckedScene) -> Vec<String>,
        cell: impl Fn(&CheckedRow) -> String,
    ) -> Vec<Vec<String>> {
        let techniques = self.techniques();
        let head = head.iter().copied().chain(techniques.iter().map(|technique| technique.name()));
        let line = |scene: &CheckedScene| {
            let row = |technique| scene.rows.iter().find(|row| row.technique == technique);
            let cells = techniques.iter().map(|technique| row(*technique).map_or_else(String::new, &cell));
            first(scene).into_iter().chain(cells).collect()
        };
        std::iter::once(head.map(str::to_owned).collect()).chain(self.scenes.iter().map(line)).collect()
    }

    fn label_table(&self) -> Vec<Vec<String>> {
        let first = |scene: &CheckedScene| {
            let truth = match scene.is_truth_equal() {
                Some(true) => "=",
                Some(false) => "!",
                None => "?",
            };
            let histories = scene.histories.as_ref();
            let agree = histories.map_or("-".to_owned(), |all| format!("{}/{}", all.agreeing(), all.pixels));
            vec![scene.scene.clone(), truth.to_owned(), agree]
        };
        self.table(&["scene", "truth", "histories"], first, label_cell)
    }

    fn time_table(&self) -> Vec<Vec<String>> {
        let cell = |row: &CheckedRow| match &row.drawn {
            Ok(drawn) => {
                let gpu = drawn.gpu_ms.map_or("-".to_owned(), milliseconds);
                format!("{}/{gpu}", milliseconds(drawn.frame_ms))
            }
            Err(_) => "-".to_owned(),
        };
        self.table(&["scene"], |scene| vec![scene.scene.clone()], cell)
    }

    /// Returns a line for everything that is not as on the reference adapter, and for what could not be drawn; those that
    /// nothing known explains begin with `!!`.
    fn findings(&self) -> String {
        let mut lines = Vec::new();
        for scene in &self.scenes {
            if let (Some(false), Some(reference)) = (scene.is_truth_equal(), scene.reference_truth) {
                let what = format!("{} is not the reference's {reference}: other scene or arithmetic", scene.truth);
                lines.push(finding(true, &scene.scene, "truth", &what));
            }
            for row in &scene.rows {
                let verdict = row.verdict();
                if matches!(verdict, RowVerdict::Wrong { .. } | RowVerdict::Failed | RowVerdict::NotDrawn) {
                    let is_unexplained = verdict.is_unexplained();
                    lines.push(finding(is_unexplained, &scene.scene, row.technique.name(), &row.in_words()));
                }
            }
        }
        let disagreeing = self.scenes.iter().filter_map(|scene| Some((scene, scene.histories.as_ref()?)));
        let disagreeing = disagreeing.flat_map(|(scene, all)| all.disagreements.iter().map(move |one| (scene, one)));
        let disagreeing: Vec<String> = disagreeing
            .map(|(scene, one)| {
                let [x, y] = one.pixel;
                finding(true, &scene.scene, "history", &format!("pixel {x},{y}: {}", one.reason))
            })
            .collect();
        lines.extend(disagreeing.iter().take(MOST_LISTED).cloned());
        if let Some(more) = disagreeing.len().checked_sub(MOST_LISTED).filter(|more| *more > 0) {
            lines.push(format!("!! and {more} more histories: `--json` has them all\n"));
        }
        if lines.is_empty() { String::new() } else { lines.concat() + "\n" }
    }

    fn summary_text(&self) -> String {
        let rows: Vec<&CheckedRow> = self.rows().map(|(_, row)| row).collect();
        let of = |is: fn(RowVerdict) -> bool| rows.iter().filter(|row| is(row.verdict())).count();
        let histories = self.scenes.iter().filter_map(|scene| scene.histories.as_ref());
        let (agree, all) = histories.fold((0, 0), |(agree, all), one| (agree + one.agreeing(), all + one.pixels));
        let mut text = format!(
            "{}: {} equal, {} no more wrong, {} wrong, {} not drawn; {agree} of {all} histories agree.\n",
            counted(rows.len() as u64, "row"),
            of(|verdict| verdict == RowVerdict::Equal),
            of(|verdict| verdict == RowVerdict::NoMoreWrong),
            of(|verdict| matches!(verdict, RowVerdict::Wrong { .. })),
            of(|verdict| matches!(verdict, RowVerdict::NotDrawn | RowVerdict::Failed)),
        );
        let limits = self.known_limits();
        if !limits.is_empty() {
            text += &format!("Pixels that are wrong on the reference adapter, by cause: {limits}.\n");
        }
        let unexplained = self.unexplained();
        text += &match unexplained.is_none() {
            true => "Nothing is unexplained.\n".to_owned(),
            false => format!("Unexplained: {}; see the lines marked `!!`.\n", unexplained.in_words()),
        };
        text
    }

    /// Returns the causes of what is wrong on the reference adapter, in these scenes, with how many pixels each explains
    /// there, and how many have no proven cause.
    fn known_limits(&self) -> String {
        let mut causes: BTreeMap<Cause, u64> = BTreeMap::new();
        let references = self.rows().filter_map(|(_, row)| row.reference.as_ref());
        for (cause, pixels) in references.flat_map(|reference| &reference.causes) {
            *causes.entry(*cause).or_default() += pixels;
        }
        let words = |(cause, pixels): (Cause, u64)| format!("{} {}", cause.name(), count(pixels));
        let unproven: u64 = self.rows().filter_map(|(_, row)| row.reference.as_ref()).map(ReferenceRow::unproven).sum();
        let unproven = (unproven > 0).then(|| format!("{} with no proven cause", count(unproven)));
        causes.into_iter().map(words).chain(unproven).collect::<Vec<_>>().join(", ")
    }
}

impl super::UnexplainedCounts {
    /// Returns the numbers that are not 0, in words: `2 rows, 1 history`.
    pub fn in_words(self) -> String {
        let histories = |n: u64| if n == 1 { "1 history".to_owned() } else { format!("{} histories", count(n)) };
        let parts = [
            (self.truths, counted(self.truths as u64, "truth")),
            (self.rows, counted(self.rows as u64, "row")),
            (self.histories, histories(self.histories as u64)),
        ];
        parts.into_iter().filter(|(n, _)| *n > 0).map(|(_, words)| words).collect::<Vec<_>>().join(", ")
    }
}

fn finding(is_unexplained: bool, scene: &str, what: &str, words: &str) -> String {
    let mark = if is_unexplained { "!!" } else { "  " };
    format!("{mark} {scene} {what}: {words}\n")
}

fn label_cell(row: &CheckedRow) -> String {
    let Ok(drawn) = &row.drawn else { return "-".to_owned() };
    let sign = match row.verdict() {
        RowVerdict::Equal => "=",
        RowVerdict::NoMoreWrong => "~",
        RowVerdict::Wrong { .. } => "!",
        RowVerdict::NoReference => "?",
        RowVerdict::NotDrawn | RowVerdict::Failed => "-",
    };
    format!("{sign}{}+{}", drawn.error.wrong(), drawn.error.edge_band)
}

/// Returns a table whose columns are as wide as their widest cell: the first to the left, the others to the right.
fn aligned(table: &[Vec<String>]) -> String {
    let columns = table.first().map_or(0, Vec::len);
    let width = |column: usize| table.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |line: &Vec<String>| {
        let cells = line.iter().zip(&widths).enumerate().map(|(column, (cell, width))| match column {
            0 => format!("{cell:width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ") + "\n"
    };
    table.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::super::HistoryDisagreement;
    use super::super::row::tests::{hash, row};
    use super::super::tests::check;
    use super::*;

    #[test]
    fn it_begins_with_version_and_adapter_and_its_columns_are_aligned() {
        let text = check(vec![row((0, &[]), Some((0, &[])), true)]).to_text();
        let start =
            format!("stencilscope {} check\nadapter    a card, a driver 1.0 (cpu)\n", env!("CARGO_PKG_VERSION"));
        assert!(text.starts_with(&start), "{text}");
        assert!(text.contains("\nscene  truth  histories  z-fail\ntori       =      50/50    =0+3\n"), "{text}");
        assert!(text.contains("\nscene   z-fail\ntori   4.2/3.5\n"), "{text}");
        assert!(text.contains("\n1 row: 1 equal, 0 no more wrong, 0 wrong, 0 not drawn; 50 of 50 histories"));
        assert!(text.ends_with("Nothing is unexplained.\n"), "{text}");
    }

    #[test]
    fn what_is_unexplained_is_marked_and_what_is_explained_is_not() {
        let reference = Some((8, &[(Cause::Acne, 8)][..]));
        let mut one = check(vec![row((9, &[(Cause::Acne, 9)]), reference, false)]);
        let text = one.to_text();
        assert!(text.contains("\n   tori z-fail: wrong: 9 pixels, 8 on the reference adapter; 9 by acne\n"), "{text}");
        assert!(text.contains("on the reference adapter, by cause: acne 8.\n") && !text.contains("!!"), "{text}");
        one.scenes[0].rows = vec![row((9, &[]), reference, false)];
        one.scenes[0].reference_truth = Some(hash(8));
        let disagreements = (0..12).map(|x| HistoryDisagreement { pixel: [x, 0], reason: "a reason".to_owned() });
        one.scenes[0].histories.as_mut().expect("histories").disagreements = disagreements.collect();
        let text = one.to_text();
        for words in [
            "\n!! tori truth: ",
            "\n!! tori z-fail: wrong: 9 pixels, 8 on the reference adapter; 1 unexplained\n",
            "\n!! tori history: pixel 9,0: a reason\n!! and 2 more histories",
            "38/50    !9+3\n",
            "\nUnexplained: 1 truth, 1 row, 12 histories; ",
        ] {
            assert!(text.contains(words), "`{words}` is not in\n{text}");
        }
    }

    #[test]
    fn what_can_not_be_drawn_says_why() {
        let failed = CheckedRow { drawn: Err("too large".to_owned()), ..row((0, &[]), Some((0, &[])), true) };
        let text = check(vec![failed]).to_text();
        assert!(text.contains("\n!! tori z-fail: failed: too large\n"), "{text}");
    }
}
