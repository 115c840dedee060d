//! The parts around the charts: heading, legend, notes.

use super::{
    LINE, LegendKey, Plot, PlotInk, PlotLine, PlotText, SMALL_SIZE, STYLES, TEXT_SIZE, TechniqueStyle, style_of,
    text_width,
};
use crate::report::{Report, ReportRow, table};

/// Returns a sentence on what the plot shows, for screen readers: the number of rows, the scenes, and the rows on the
/// Pareto front.
pub fn summary(report: &Report) -> String {
    let (rows, scenes) = (report.rows.len(), report.scenes());
    let front: Vec<String> = report.rows.iter().filter(|row| row.pareto).map(ReportRow::summary).collect();
    format!(
        "Wrong pixels against frame time of {rows} runs, scenes: {}. On the Pareto front: {}.",
        if scenes.is_empty() { "none".to_owned() } else { scenes.join(", ") },
        if front.is_empty() { "none".to_owned() } else { front.join("; ") },
    )
}

/// Adds the title and the adapter that it was measured on; returns the y coordinate in points where the charts begin.
pub fn heading(plot: &mut Plot, report: &Report) -> f64 {
    let adapter = &report.adapter;
    let sizes = table::sizes(report.rows.iter().map(|row| row.size));
    let facts = [adapter.name.as_str(), adapter.driver.as_str(), sizes.as_str()];
    let facts: Vec<&str> = facts.into_iter().filter(|fact| !fact.is_empty()).collect();
    let lines = wrapped(&facts.join(" · "), plot.size[0] - 16.0);
    plot.add_heading(&lines) + 4.0
}

/// Returns the text in lines at most `width` points wide, broken at spaces; a longer word has a line of its own and
/// exceeds that.
fn wrapped(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), TEXT_SIZE) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Returns the legend as a plot `width` points wide: the mark of each technique that has a measured row, and what
/// filled marks, lines and whiskers mean. Empty where nothing was measured.
pub fn legend(report: &Report, width: f64) -> Plot {
    let mut legend = Plot::empty(width);
    let mut used: Vec<(&'static TechniqueStyle, &str)> = Vec::new();
    for row in report.rows.iter().filter(|row| row.is_measured()) {
        let entry = (style_of(&row.technique), row.technique.as_str());
        if !used.contains(&entry) {
            used.push(entry);
        }
    }
    if used.is_empty() {
        return legend;
    }
    used.sort_by_key(|(style, _)| STYLES.iter().position(|other| other == *style).unwrap_or(STYLES.len()));
    let mut flow = LegendFlow { legend: &mut legend, at: [8.0, LINE / 2.0], width };
    for (style, name) in used {
        flow.add(name, PlotInk::Technique(style), &|legend, at| {
            legend.keys.push(LegendKey { at: [at[0] + 6.0, at[1]], style, filled: true });
        });
    }
    flow.next_line();
    flow.add("Pareto front, filled: none is faster and more right", PlotInk::Dim, &|legend, [x, y]| {
        let points = vec![[x, y - 4.0], [x + 7.0, y - 4.0], [x + 7.0, y + 4.0], [x + 13.0, y + 4.0]];
        legend.lines.push(PlotLine { points, width: 1.5, ink: PlotInk::Front, faint: false });
    });
    flow.add("fastest to slowest frame", PlotInk::Dim, &|legend, [x, y]| {
        let points = vec![[x, y], [x + 13.0, y]];
        legend.lines.push(PlotLine { points, width: 1.0, ink: PlotInk::Dim, faint: false });
    });
    let bottom = flow.at[1] + LINE / 2.0;
    legend.size[1] = bottom;
    legend
}

/// Places the legend's entries one after another, and begins a new line where one is full.
struct LegendFlow<'a> {
    legend: &'a mut Plot,
    at: [f64; 2],
    width: f64,
}

impl LegendFlow<'_> {
    /// Adds an entry to the legend: a sign about 14 points wide, which `sign` draws at a position, then its text.
    /// Begins a new line first where the entry would exceed the width.
    fn add(&mut self, words: &str, ink: PlotInk, sign: &dyn Fn(&mut Plot, [f64; 2])) {
        let taken = 18.0 + text_width(words, SMALL_SIZE) + 14.0;
        if self.at[0] > 8.0 && self.at[0] + taken > self.width {
            self.next_line();
        }
        sign(self.legend, self.at);
        self.legend.texts.push(PlotText::new([self.at[0] + 18.0, self.at[1]], words, SMALL_SIZE, ink));
        self.at[0] += taken;
    }

    fn next_line(&mut self) {
        self.at = [8.0, self.at[1] + LINE];
    }
}

/// Returns lines, at most `width` points wide, about rows that are not drawn, with the reason, and about those that
/// took 0 ms and are drawn at the left edge. Empty where there are none.
pub fn notes(report: &Report, width: f64) -> Vec<String> {
    let mut notes = Vec::new();
    for row in &report.rows {
        if let Some(problem) = row.problem() {
            notes.push(format!("Not drawn: {} in {}: {problem}.", row.name(), row.scene));
        } else if row.frame_ms.median == 0.0 {
            notes.push(format!("At the left edge: {} in {} took 0 ms.", row.name(), row.scene));
        }
    }
    notes.iter().flat_map(|note| wrapped(note, width - 16.0)).collect()
}
