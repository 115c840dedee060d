//! The report as text: a table for the terminal, and one in Markdown.

use super::{MotionCost, Report, ReportRow};
use crate::numbers::{count, mebibytes, per_hundred};

/// The spaces between two columns.
const GAP: &str = "  ";
/// Columns of the terminal that a table stays below.
const MOST_COLUMNS: usize = 140;
/// Lengths in characters to which names of techniques and labels are cut: the first that keeps the table narrow enough
/// is used.
const LONGEST_NAMES: [usize; 4] = [24, 18, 13, 8];

/// One column of a table: its heading, and the function that writes its text for a row.
struct ReportColumn {
    heading: String,
    is_number: bool,
    cells: Vec<String>,
}

impl ReportColumn {
    fn words(heading: &str, cells: impl Iterator<Item = String>) -> ReportColumn {
        ReportColumn { heading: heading.to_owned(), is_number: false, cells: cells.collect() }
    }

    fn numbers(heading: &str, cells: impl Iterator<Item = String>) -> ReportColumn {
        ReportColumn { heading: heading.to_owned(), is_number: true, cells: cells.collect() }
    }

    fn width(&self) -> usize {
        self.cells.iter().map(|cell| width(cell)).chain([width(&self.heading)]).max().unwrap_or(0)
    }

    fn padded(&self, text: &str, column_width: usize) -> String {
        let space = " ".repeat(column_width.saturating_sub(width(text)));
        if self.is_number { space + text } else { text.to_owned() + &space }
    }
}

/// Returns the columns that a terminal gives the text: every character that we write is one wide.
fn width(text: &str) -> usize {
    text.chars().count()
}

/// Returns a report as a table: the adapter, a block for each scene with numbers right-aligned, and what the columns mean;
/// `Nothing was measured.` without rows. With `is_narrow`, names are shortened where the table is wider than a terminal, and
/// no two rows look alike for that.
pub fn text(report: &Report, is_narrow: bool) -> String {
    if report.rows.is_empty() {
        return "Nothing was measured.\n".to_owned();
    }
    let adapter = &report.adapter;
    let mut text = format!("{} · {} · {}\n", adapter.name, adapter.driver, adapter.kind);
    let columns = if is_narrow { terminal_columns(&report.rows) } else { columns_with_names(&report.rows, usize::MAX) };
    let widths: Vec<usize> = columns.iter().map(ReportColumn::width).collect();
    let line = |cell: &dyn Fn(&ReportColumn) -> String| {
        let cells = columns.iter().zip(&widths).map(|(column, width)| column.padded(&cell(column), *width));
        format!("{}\n", cells.collect::<Vec<_>>().join(GAP).trim_end())
    };
    for scene in report.scenes() {
        let rows = report.rows_of(scene);
        text += &format!("\n{scene} · {}\n", sizes(rows.iter().map(|index| report.rows[*index].size)));
        text += &line(&|column| column.heading.clone());
        for index in rows {
            text += &line(&|column| column.cells[index].clone());
        }
    }
    text += "\n* nothing else of the scene is both at least as fast and at least as right (Pareto front)\n";
    if report.rows.iter().any(|row| row.visibility_error.is_some()) {
        text += "light: by how much the share of the light that arrives differs from the truth's, mean over the pixels compared\n";
    }
    text + "wrong: false shadow + missing shadow + wrong surface, % of the pixels compared\n\
            colour: pixels unlike those of the ray-traced picture, background included; frame: median, then fastest to slowest\n"
}

/// Returns the picture sizes that occur, each once, in order of appearance, separated by commas: `1280×720, 640×480`.
pub(super) fn sizes(sizes: impl Iterator<Item = [u32; 2]>) -> String {
    let mut names: Vec<String> = Vec::new();
    for [width, height] in sizes {
        let name = format!("{width}×{height}");
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join(", ")
}

fn terminal_columns(rows: &[ReportRow]) -> Vec<ReportColumn> {
    let whole = |columns: &Vec<ReportColumn>| columns.iter().map(|column| column.width() + width(GAP)).sum::<usize>();
    let [first, shorter @ ..] = LONGEST_NAMES;
    let widest = columns_with_names(rows, first);
    shorter.into_iter().fold(widest, |columns, longest| {
        if whole(&columns) < MOST_COLUMNS { columns } else { columns_with_names(rows, longest) }
    })
}

fn columns_with_names(rows: &[ReportRow], longest: usize) -> Vec<ReportColumn> {
    let words = |heading, cell: &dyn Fn(&ReportRow) -> String| ReportColumn::words(heading, rows.iter().map(cell));
    let numbers = |heading, cell: &dyn Fn(&ReportRow) -> String| ReportColumn::numbers(heading, rows.iter().map(cell));
    let decimals = decimals(rows);
    let times = |ms: f64| milliseconds(ms, decimals);
    let spread = |ms: f64| milliseconds(ms, decimals - 1);
    let mut columns = vec![
        words("", &|row| if row.pareto { "*".to_owned() } else { String::new() }),
        ReportColumn::words("technique", apart(rows.iter().map(|row| &*row.technique).collect(), longest).into_iter()),
        ReportColumn::words("settings", apart(rows.iter().map(|row| &*row.label).collect(), longest).into_iter()),
        numbers("wrong px", &wrong),
        numbers("%", &wrong_percent),
        numbers("false", &|row| count(row.error.false_shadow)),
        numbers("missing", &|row| count(row.error.missing_shadow)),
        numbers("colour", &wrong_color),
        numbers("frame ms", &|row| times(row.frame_ms.median)),
        numbers("min–max", &|row| format!("{}–{}", spread(row.frame_ms.min), spread(row.frame_ms.max))),
        numbers("GPU ms", &|row| row.gpu_ms.map_or_else(|| "-".to_owned(), times)),
        numbers("set-up ms", &|row| milliseconds(row.setup_ms, 1)),
        numbers("triangles", &|row| count(row.triangles)),
        numbers("MiB", &|row| mebibytes(row.bytes)),
    ];
    if rows.iter().any(|row| row.moving.is_some()) {
        let of = |part: fn(&MotionCost) -> f64| move |row: &ReportRow| row.moving.as_ref().map_or(f64::NAN, part);
        let (setup, total) = (of(|moving| moving.setup_ms), of(|moving| moving.total_ms));
        columns.insert(10, numbers("+ set-up", &|row| times(setup(row))));
        columns.insert(11, numbers("total", &|row| times(total(row))));
        columns.insert(12, numbers("fps", &fps));
        // The spread means little over frames of a motion.
        columns.remove(9);
    }
    if rows.iter().any(|row| row.visibility_error.is_some()) {
        columns.insert(8, numbers("light %", &light_percent));
    }
    if let Some(name) = swept_name(rows) {
        columns.insert(3, numbers(heading(name), &swept_text));
        let frame = columns.iter().position(|column| column.heading == "frame ms").unwrap_or(columns.len() - 1);
        columns.insert(frame + 1, numbers("fps", &fps));
    }
    columns
}

/// Returns the name of the number that a sweep changes; `None` without a sweep.
fn swept_name(rows: &[ReportRow]) -> Option<&str> {
    rows.iter().find_map(|row| Some(&*row.sweep.as_ref()?.name))
}

/// Returns the heading of the column of a sweep's values, different from those of the other columns.
fn heading(swept: &str) -> &str {
    if swept == "triangles" { "of casters" } else { swept }
}

fn swept_text(row: &ReportRow) -> String {
    row.sweep.as_ref().map_or_else(String::new, |swept| swept.text.clone())
}

/// Returns the frames per second as text: one decimal below 100, none from there on; `-` where they are infinite or no
/// number.
fn fps(row: &ReportRow) -> String {
    match row.fps() {
        fps if !fps.is_finite() => "-".to_owned(),
        fps if fps < 100.0 => format!("{fps:.1}"),
        fps => format!("{fps:.0}"),
    }
}

/// Returns the text, cut to `longest` characters with `…` as the last of them where it is longer.
fn shortened(text: &str, longest: usize) -> String {
    if width(text) <= longest {
        return text.to_owned();
    }
    text.chars().take(longest - 1).chain(['…']).collect()
}

/// Returns names cut to `longest` characters as [`shortened`] does; where names that differ would look alike, they are cut in
/// their middle, and, if that does not help, not at all.
fn apart(names: Vec<&str>, longest: usize) -> Vec<String> {
    let is_alike =
        |cut: &dyn Fn(&str) -> String, name: &str| names.iter().any(|other| *other != name && cut(other) == cut(name));
    let at_end = |name: &str| shortened(name, longest);
    let in_middle = |name: &str| {
        if width(name) <= longest {
            return name.to_owned();
        }
        let (first, last) = ((longest - 1) / 2, longest / 2);
        let start: String = name.chars().take(first).collect();
        start + "…" + &name.chars().skip(width(name) - last).collect::<String>()
    };
    let cut = |name: &&str| match (is_alike(&at_end, name), is_alike(&in_middle, name)) {
        (false, _) => at_end(name),
        (true, false) => in_middle(name),
        (true, true) => (*name).to_owned(),
    };
    names.iter().map(cut).collect()
}

/// Returns the number of wrong pixels as text; a dash where nothing was compared, so that 0 always means "none".
fn wrong(row: &ReportRow) -> String {
    if row.error.compared == 0 { "-".to_owned() } else { count(row.wrong()) }
}

/// Returns the number of pixels of a wrong colour as text; a dash where that was not measured.
fn wrong_color(row: &ReportRow) -> String {
    row.wrong_color.map_or_else(|| "-".to_owned(), count)
}

/// Returns the mean error of the share of light that arrives, in percent; a dash where the technique knows no shares.
fn light_percent(row: &ReportRow) -> String {
    row.visibility_error.map_or_else(|| "-".to_owned(), |error| per_hundred(error.mean()))
}

fn wrong_percent(row: &ReportRow) -> String {
    if row.error.compared == 0 { "-".to_owned() } else { per_hundred(row.wrong_fraction) }
}

/// Returns how many digits after the point all times get, so that points align: 3 where the shortest median frame is
/// below 0.2 ms and the longest below a second, else 2. Frames that were not timed (0) don't count. Spreads use one
/// less, so it is never 0.
fn decimals(rows: &[ReportRow]) -> usize {
    let times = || rows.iter().map(|row| row.frame_ms.median).filter(|ms| *ms > 0.0);
    let (shortest, longest) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
    if shortest < 0.2 && longest < 1000.0 { 3 } else { 2 }
}

fn milliseconds(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "-".to_owned() }
}

/// Returns a report as Markdown tables, each with a note on what bold means: one for each scene, below its name where
/// there are several. Empty without rows.
pub fn markdown(report: &Report) -> String {
    let scenes = report.scenes();
    let note = "\nBold: nothing else is both at least as fast and at least as right (Pareto front).\n";
    let blocks = scenes.iter().map(|scene| {
        let heading = if scenes.len() > 1 { format!("**{}**\n\n", escaped(scene)) } else { String::new() };
        heading + &markdown_of(report, scene) + note
    });
    blocks.collect::<Vec<_>>().join("\n")
}

/// Returns the Markdown table of one scene: rows on the Pareto front in bold, and of a sweep with columns for value and
/// frames per second.
pub(super) fn markdown_of(report: &Report, scene: &str) -> String {
    let decimals = decimals(&report.rows);
    let swept = swept_name(&report.rows);
    let name = |name| format!(" {name} |");
    let [of_value, of_fps] =
        [swept.map(heading).map(name).unwrap_or_default(), swept.map(|_| name("fps")).unwrap_or_default()];
    let rule = if swept.is_some() { "--:|" } else { "" };
    let mut text = format!(
        "| technique | settings |{of_value} wrong pixels | % of compared | wrong colour | frame ms |{of_fps} set-up ms | triangles | MiB |\n\
         |---|---|{rule}--:|--:|--:|--:|{rule}--:|--:|--:|\n"
    );
    for row in report.rows_of(scene).into_iter().map(|index| &report.rows[index]) {
        let strong = |cell: String| if row.pareto { format!("**{cell}**") } else { cell };
        let mut cells = vec![
            strong(escaped(&row.technique)),
            escaped(&row.label),
            wrong(row),
            wrong_percent(row),
            wrong_color(row),
            milliseconds(row.frame_ms.median, decimals),
            milliseconds(row.setup_ms, 1),
            count(row.triangles),
            mebibytes(row.bytes),
        ];
        if swept.is_some() {
            cells.insert(2, swept_text(row));
            cells.insert(7, fps(row));
        }
        text += &format!("| {} |\n", cells.join(" | "));
    }
    text
}

/// Returns the text with the characters escaped that would end a Markdown table cell.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::super::tests::{adapter, row};
    use super::*;

    fn report() -> Report {
        let mut timed = row("tori", "z-fail", "", 0, 6.25);
        timed.gpu_ms = Some(5.5);
        let mut empty = row("table", "none", "", 0, 2.0);
        (empty.error.compared, empty.wrong_color) = (0, None);
        Report::new(adapter(), vec![timed, row("tori", "shadow-map", "1024", 20, 8.0), empty])
    }

    #[test]
    fn the_table_is_aligned_and_grouped_by_scene() {
        let expected = "\
hand · 1 · cpu

tori · 100×10
   technique   settings  wrong px    %  false  missing  colour  frame ms  min–max  GPU ms  set-up ms  triangles  MiB
*  z-fail                       0    0      0        0       0      6.25  6.2–6.5    5.50       12.5      5 000  2.0
   shadow-map  1024            20  2.0     20        0      20      8.00  7.9–8.3       -       12.5      5 000  2.0

table · 100×10
   technique   settings  wrong px    %  false  missing  colour  frame ms  min–max  GPU ms  set-up ms  triangles  MiB
   none                         -    -      0        0       -      2.00  1.9–2.3       -       12.5      5 000  2.0
";
        let text = text(&report(), false).replace('\u{a0}', " ");
        assert!(text.starts_with(expected), "{text}");
    }

    #[test]
    fn the_longest_names_and_numbers_stay_below_140_columns() {
        let mut long = row("tori", "a-technique-with-a-very-long-name", "4096, slope 2, constant 16, pcf 5", 0, 1234.5);
        long.error.compared = 3840 * 2160;
        long.error.false_shadow = 2_000_000;
        long.error.missing_shadow = 2_000_000;
        long.wrong_color = Some(4_000_000);
        long.triangles = 120_000_000;
        long.gpu_ms = Some(1234.5);
        long.bytes = 1 << 34;
        let report = Report::new(adapter(), vec![long, row("tori", "none", "", 1, 0.1)]);
        assert!(text(&report, false).contains("4096, slope 2, constant 16, pcf 5"), "whole where it is no terminal");
        let text = text(&report, true);
        let widest = text.lines().map(width).max();
        assert!(widest < Some(MOST_COLUMNS), "{widest:?}\n{text}");
    }

    #[test]
    fn shortened_names_stay_apart() {
        let names = vec!["casters=all", "casters=light-facing", "casters=light-back-facing", "", "casters=all"];
        for longest in LONGEST_NAMES {
            let cut = apart(names.clone(), longest);
            for (index, one) in cut.iter().enumerate() {
                let alike = (0..index).filter(|other| cut[*other] == *one && names[*other] != names[index]);
                assert_eq!(alike.count(), 0, "{longest}: {cut:?}");
            }
        }
        assert_eq!(
            apart(vec!["casters=all", "shadow"], 8),
            ["casters…", "shadow"],
            "cut at its end where that will do"
        );
        assert_eq!(apart(vec!["casters=all", "casters=none"], 8)[..], ["cas…=all", "cas…none"]);
    }

    #[test]
    fn nothing_measured_is_said() {
        assert_eq!(text(&Report::new(adapter(), Vec::new()), true), "Nothing was measured.\n");
    }

    #[test]
    fn markdown_marks_the_front_in_bold_and_keeps_cells_apart() {
        let text = markdown(&Report::new(adapter(), vec![row("tori", "z-fail", "a|b", 0, 6.25)]));
        assert!(text.contains("| **z-fail** | a\\|b | 0 | 0 | 0 | 6.25 | 12.5 | 5\u{a0}000 | 2.0 |\n"), "{text}");
    }
}
