//! The plot: how the share of wrong pixels grows with a sweep's number, one chart a sweep.
//!
//! Across: the number, from easy on the left to extreme on the right, log where it spans decades. Up: wrong pixels of
//! those compared, log. Zero has no place there: it has a band below, with a lane for each entrant, so that lines
//! without an error do not cover each other. The first wrong value, where the line leaves the band, has a filled mark.

use super::{CaseNumber, Entrant, StressCase, StressResults, StressRow, value_text};
use crate::numbers;
use crate::report::plot::axes::{Axes, Tick};
use crate::report::plot::labels::{self, LabelObstacles, LabelRequest};
use crate::report::plot::scale::LogScale;
use crate::report::plot::{
    LegendKey, Plot, PlotInk, PlotLine, PlotPoint, PlotRect, PlotText, SMALL_SIZE, SceneChart, TEXT_SIZE, style_of,
    text_width,
};

/// Width of the page and of its two charts, and height of a chart, points.
const PAGE: f64 = 900.0;
const CHART: [f64; 2] = [440.0, 300.0];
/// Space around a chart's area: title and caption above, ticks and parameter below, points.
const TOP: f64 = 40.0;
const BOTTOM: f64 = 38.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 20.0;
/// Height of a lane of the band, points.
const LANE: f64 = 9.0;
/// The least number of values that a sweep has.
const LEAST_VALUES: usize = 6;
/// The least ratio of the ends of a logarithmic scale.
const LEAST_DECADES: f64 = 20.0;
/// The largest number of values for which a sweep's chart has a mark at each; with more, only where a technique breaks.
const MOST_MARKS: usize = 16;
/// The largest number of values of a sweep that is no motion; a case with more is a collection of scenes and has no
/// chart.
const MOST_VALUES: usize = 100;

impl StressResults {
    /// Returns a plot with a chart for each sweep that was run and for each motion, two a line; cases with too few or
    /// too many values are left out. Says so where there is none.
    pub fn to_plot(&self) -> Plot {
        let mut cases: Vec<&'static StressCase> =
            self.rows.iter().filter_map(|row| StressCase::named(row.case)).collect();
        cases.dedup_by_key(|case| case.name);
        let is_motion = |case: &StressCase| matches!(case.drives, CaseNumber::Motion(_));
        cases.retain(|case| is_motion(case) || (LEAST_VALUES..=MOST_VALUES).contains(&case.values.len()));
        let mut plot = Plot::empty(PAGE);
        plot.title = "Wrong pixels where a scene is driven to its extreme".to_owned();
        plot.summary = format!("{} sweeps: the share of wrong pixels against one number each.", cases.len());
        let [width, height] = self.size;
        let facts = format!("{} · {width} × {height}; filled: the first value with a wrong pixel", self.adapter.name);
        plot.add_heading(&[facts]);
        self.legend(&mut plot, 58.0);
        for (index, case) in cases.iter().enumerate() {
            let corner = [(index % 2) as f64 * (PAGE - CHART[0]), 74.0 + (index / 2) as f64 * (CHART[1] + 14.0)];
            plot.charts.push(self.chart(case).moved(corner));
        }
        if cases.is_empty() {
            plot.texts.push(PlotText::new([8.0, 84.0], "No sweep was run.", TEXT_SIZE, PlotInk::Dim));
        }
        plot.size = [PAGE, 90.0 + cases.len().div_ceil(2) as f64 * (CHART[1] + 14.0)];
        plot
    }

    /// Adds each technique's mark and name, once and in the order of the rows, in one line at the y coordinate `y`,
    /// points.
    fn legend(&self, plot: &mut Plot, y: f64) {
        let mut names: Vec<&str> = Vec::new();
        for row in &self.rows {
            let name = row.entrant.technique.name();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let mut x = 14.0;
        for name in names {
            let style = style_of(name);
            plot.keys.push(LegendKey { at: [x, y], style, filled: false });
            plot.texts.push(PlotText::new([x + 10.0, y], name, SMALL_SIZE, PlotInk::Technique(style)));
            x += 26.0 + text_width(name, SMALL_SIZE);
        }
    }

    fn chart(&self, case: &StressCase) -> SceneChart {
        let rows = || self.rows.iter().filter(|row| row.case == case.name);
        let mut entrants: Vec<Entrant> = Vec::new();
        for row in rows() {
            if !entrants.contains(&row.entrant) {
                entrants.push(row.entrant);
            }
        }
        let [left, right] = [LEFT, CHART[0] - RIGHT];
        let across = Across::new(case.values, [left + 10.0, right - 10.0]);
        let tick = |value| Tick { at: across.position(value), text: value_text(value) };
        let x_ticks = across.ticks().into_iter().map(tick).collect();
        let outer = PlotRect { min: [left, TOP], max: [right, CHART[1] - BOTTOM] };
        let percent = |row: &StressRow| row.error.wrong_fraction() * 100.0;
        let axes = Axes::new(outer, entrants.len(), LANE, rows().map(percent), 22.0, x_ticks);
        let place = |row: &StressRow, lane| [across.position(row.parameter.1), axes.height(percent(row), lane)];
        let mut lines = axes.grid();
        let (mut spots, mut wishes, mut segments) = (Vec::new(), Vec::new(), Vec::new());
        for (lane, entrant) in entrants.iter().enumerate() {
            let style = style_of(entrant.technique.name());
            let of_entrant: Vec<&StressRow> = rows().filter(|row| row.entrant == *entrant).collect();
            let points: Vec<[f64; 2]> = of_entrant.iter().map(|row| place(row, lane)).collect();
            segments.extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
            if points.len() > 1 {
                let ink = PlotInk::Technique(style);
                lines.push(PlotLine { points: points.clone(), width: 1.3, ink, faint: false });
            }
            let breaks = of_entrant.iter().position(|row| row.error.wrong() > 0);
            for (index, (row, at)) in of_entrant.iter().zip(&points).enumerate() {
                let is_break = breaks == Some(index);
                if is_break || of_entrant.len() <= MOST_MARKS {
                    spots.push(spot(row, *at, is_break));
                }
            }
            let labelled = breaks.or((!entrant.settings.is_empty()).then_some(0));
            wishes.extend(labelled.and_then(|index| points.get(index)).map(|at| LabelRequest {
                at: *at,
                whiskers: [0.0; 2],
                text: caption(entrant),
                ink: PlotInk::Technique(style),
                area: if breaks.is_some() { axes.area } else { axes.band },
                must: breaks.is_some(),
            }));
        }
        // Those that must be shown and need most space first.
        wishes.sort_by_key(|wish: &LabelRequest| std::cmp::Reverse((wish.must, wish.text.len())));
        let obstacles =
            LabelObstacles { marks: spots.iter().map(|spot| spot.at).collect(), whiskers: Vec::new(), segments };
        let (labels, leaders) = labels::words_and_leaders(&wishes, &obstacles);
        lines.extend(leaders);
        spots.sort_by_key(|spot| spot.filled);
        let texts = axes.captions(case.name, case.parameter).into_iter().chain(axes.tick_texts()).collect();
        SceneChart { title: case.name.to_owned(), area: axes.area, band: axes.band, lines, spots, texts, labels }
    }
}

/// Returns a technique's name, or what distinguishes a variant: shape and colour are the technique's.
fn caption(entrant: &Entrant) -> String {
    let settings: Vec<String> = entrant.settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
    if settings.is_empty() { entrant.technique.name().to_owned() } else { settings.join(" ") }
}

fn spot(row: &StressRow, at: [f64; 2], filled: bool) -> PlotPoint {
    let value = value_text(row.parameter.1);
    let name = format!("{} at {value}: {} wrong", row.entrant, numbers::count(row.error.wrong()));
    let details = format!("{name}\nof {} compared", numbers::count(row.error.compared));
    let style = style_of(row.entrant.technique.name());
    PlotPoint { row: 0, at, whisker: [at[0]; 2], style, filled, name, details }
}

/// The horizontal scale of a chart: from a case's number to points.
enum Across {
    /// A logarithmic scale, where the values span decades.
    Log {
        /// Scale of the values.
        scale: LogScale,
        /// The lowest value above zero, where zero occurs: zero is placed a decade below it.
        above_zero: Option<f64>,
    },
    /// A linear scale, where the values do not span decades.
    Even {
        /// First and last value.
        values: [f64; 2],
        /// First and last position in points.
        points: [f64; 2],
    },
}

impl Across {
    fn new(values: &[f64], points: [f64; 2]) -> Across {
        let ends = [values.first(), values.last()].map(|end| end.copied().unwrap_or(0.0));
        let positive = || values.iter().copied().filter(|value| *value > 0.0);
        let [low, high] = [positive().fold(f64::INFINITY, f64::min), positive().fold(0.0, f64::max)];
        // A motion's steps are even, wherever they begin.
        if high / low < LEAST_DECADES || values.len() > MOST_MARKS {
            return Across::Even { values: ends, points };
        }
        let above_zero = (positive().count() < values.len()).then_some(low);
        let low = if above_zero.is_some() { low / 10.0 } else { low };
        let points = if ends[0] > ends[1] { [points[1], points[0]] } else { points };
        Across::Log { scale: LogScale::new([low, high], points), above_zero }
    }

    fn position(&self, value: f64) -> f64 {
        match self {
            Across::Log { scale, .. } => scale.position(value),
            Across::Even { values: [first, last], points: [start, end] } => {
                let span = if last == first { 1.0 } else { last - first };
                start + (value - first) / span * (end - start)
            }
        }
    }

    fn ticks(&self) -> Vec<f64> {
        match self {
            Across::Log { scale, above_zero: None } => scale.ticks(46.0),
            Across::Log { scale, above_zero: Some(low) } => {
                let ticks = scale.ticks(46.0).into_iter().filter(|tick| tick >= low);
                [0.0].into_iter().chain(ticks).collect()
            }
            Across::Even { values: [first, last], .. } => {
                (0..=4).map(|quarter| first + (last - first) * f64::from(quarter) / 4.0).collect()
            }
        }
    }
}
