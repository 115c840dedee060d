//! One scene's chart: axes, lines and marks of its rows.

use super::axes::{Axes, BREAK, NONE_WRONG, Tick};
use super::labels::{self, LabelObstacles, LabelRequest};
use super::scale::{self, LogScale};
use super::{
    PlotInk, PlotLine, PlotPoint, PlotRect, PlotText, RADIUS, SMALL_SIZE, SceneChart, TEXT_SIZE, style_of, text_width,
};
use crate::report::{Report, ReportRow};
use std::collections::BTreeMap;

/// Space above the area for title and caption of the vertical axis, points; in one line where compact.
const TOP: f64 = 40.0;
const COMPACT_TOP: f64 = 24.0;
/// Space below the band for ticks and caption of the horizontal axis, points; ticks only where compact.
const BOTTOM: f64 = 38.0;
const COMPACT_BOTTOM: f64 = 22.0;
/// Space right of the area, points: half of the last tick's text.
const RIGHT: f64 = 22.0;
/// Height of a lane of the band, points.
const LANE: f64 = 18.0;
/// The range of the horizontal axis where no row has a position on it, milliseconds.
pub(super) const NO_TIMES: [f64; 2] = [1.0, 100.0];

/// The size and axes that all charts of a plot share, in points relative to a chart's upper left corner.
#[derive(Debug)]
pub struct ChartFrame {
    /// Width and height in points.
    pub size: [f64; 2],
    axes: Axes,
    /// The horizontal scale, milliseconds.
    across: LogScale,
    lanes: usize,
    compact: bool,
}

impl ChartFrame {
    /// Returns the axes that charts of all these scenes share, so that they can be compared, in charts of `size`
    /// points; `compact` leaves less space above and below.
    pub fn new(report: &Report, scenes: &[(&str, Vec<usize>)], size: [f64; 2], compact: bool) -> ChartFrame {
        let [top, below] = if compact { [COMPACT_TOP, COMPACT_BOTTOM] } else { [TOP, BOTTOM] };
        let rows = || scenes.iter().flat_map(|(_, rows)| rows).map(|index| &report.rows[*index]);
        let times = rows().flat_map(|row| [row.frame_ms.median, row.frame_ms.min, row.frame_ms.max]);
        let times = scale::range(times, NO_TIMES);
        let height = size[1] - top - below - BREAK;
        // At most 55 % of the chart's height is for rows without a wrong pixel.
        let most_lanes = ((height * 0.55 / LANE) as usize).max(1);
        // The widest texts that the axis may have.
        let left = 8.0 + text_width(NONE_WRONG, SMALL_SIZE).max(text_width("0.00001 %", SMALL_SIZE)) + 6.0;
        let [x0, x1] = [left, size[0] - RIGHT];
        let across = LogScale::new(times, [x0, x1]);
        let lanes = scenes.iter().map(|(_, rows)| {
            let band = band_rows(report, rows);
            lanes(&band, &captions(report, rows), &across, [x0, x1], most_lanes)
                .values()
                .max()
                .map_or(1, |last| last + 1)
        });
        let lanes = lanes.max().unwrap_or(1);
        // A tick of a second or more has another digit and a space.
        let apart = if times[1] < 1000.0 { 39.0 } else { text_width("1\u{a0}000\u{a0}ms", SMALL_SIZE) + 5.0 };
        let x_ticks = Tick::along(&across, across.ticks(apart), "ms");
        let outer = PlotRect { min: [x0, top], max: [x1, size[1] - below] };
        let percents = rows().map(|row| row.wrong_fraction * 100.0);
        let axes = Axes::new(outer, lanes, LANE, percents, 17.0, x_ticks);
        ChartFrame { size, axes, across, lanes, compact }
    }

    fn texts(&self, title: &str) -> Vec<PlotText> {
        let mut texts = if self.compact {
            let words = "wrong pixels against frame time";
            let after = 8.0 + text_width(title, TEXT_SIZE) + 10.0;
            let fits = after + text_width(words, SMALL_SIZE) <= self.size[0];
            let caption = fits.then(|| PlotText::small([after, 9.0], words));
            let title = PlotText::new([8.0, 9.0], title, TEXT_SIZE, PlotInk::Text).strong();
            [title].into_iter().chain(caption).collect()
        } else {
            self.axes.captions(title, "frame time, median")
        };
        texts.extend(self.axes.tick_texts());
        texts
    }

    fn place(&self, row: &ReportRow, lane: Option<&usize>) -> [f64; 2] {
        let y = self.axes.height(row.wrong_fraction * 100.0, lane.copied().unwrap_or_default());
        [self.across.position(row.frame_ms.median), y]
    }
}

/// Returns the chart of these `rows` (indices) of the report, `corner` being its upper left corner on the page: marks,
/// whiskers, the front, labels and grid.
pub fn chart(report: &Report, title: &str, rows: &[usize], frame: &ChartFrame, corner: [f64; 2]) -> SceneChart {
    let captions = captions(report, rows);
    let Axes { area, band, .. } = frame.axes;
    let sides = [area.min[0], area.max[0]];
    let lanes = lanes(&band_rows(report, rows), &captions, &frame.across, sides, frame.lanes);
    let place = |index: usize| frame.place(&report.rows[index], lanes.get(&index));
    let mut spots: Vec<PlotPoint> = rows.iter().map(|index| spot(report, *index, place(*index), frame)).collect();
    // Height in the band has no meaning, so a line between two of its rows would mislead.
    let is_apart = |pair: &&[usize]| pair.iter().any(|index| report.rows[*index].wrong_fraction > 0.0);
    let chains = chains(report, rows);
    let joins = chains.iter().flat_map(|chain| chain.windows(2)).filter(is_apart).map(|pair| PlotLine {
        points: pair.iter().map(|index| place(*index)).collect(),
        width: 1.2,
        ink: PlotInk::Technique(style_of(&report.rows[pair[0]].technique)),
        faint: true,
    });
    let mut over_grid: Vec<PlotLine> = joins.collect();
    over_grid.extend(front(report, rows, &place));
    let obstacles = LabelObstacles {
        marks: spots.iter().map(|spot| spot.at).collect(),
        whiskers: spots.iter().map(|spot| spot.whisker.map(|x| [x, spot.at[1]])).collect(),
        segments: segments(&over_grid).collect(),
    };
    let (labels, leaders) = label(report, &spots, &captions, frame, &obstacles);
    over_grid.extend(leaders);
    spots.sort_by_key(|spot| spot.filled);
    let mut lines = frame.axes.grid();
    lines.extend(over_grid);
    let title = title.to_owned();
    SceneChart { texts: frame.texts(&title), title, area, band, lines, spots, labels }.moved(corner)
}

/// Returns the rows without a wrong pixel, those on the Pareto front first, then by median time: the first are nearest
/// to the chart's area.
fn band_rows<'a>(report: &'a Report, rows: &[usize]) -> Vec<(usize, &'a ReportRow)> {
    let rows = rows.iter().map(|index| (*index, &report.rows[*index]));
    let mut rows: Vec<_> = rows.filter(|(_, row)| row.wrong_fraction == 0.0).collect();
    rows.sort_by(|(_, a), (_, b)| b.pareto.cmp(&a.pareto).then(a.frame_ms.median.total_cmp(&b.frame_ms.median)));
    rows
}

/// Returns for each row of the band, by its index, the first lane in which its mark and label are clear of earlier
/// ones; where all `most` lanes are taken, one in turn, so that texts may overlap.
fn lanes(
    rows: &[(usize, &ReportRow)],
    captions: &BTreeMap<usize, MarkCaption>,
    across: &LogScale,
    [left, right]: [f64; 2],
    most: usize,
) -> BTreeMap<usize, usize> {
    let mut taken: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut found = BTreeMap::new();
    for (order, (index, row)) in rows.iter().enumerate() {
        let x = across.position(row.frame_ms.median);
        let whiskers = whiskers(row, x, across);
        let reach =
            |whisker: f64| captions.get(index).map_or(0.0, |caption| labels::reach(&caption.text, whisker)) + 4.0;
        let [left_reach, right_reach] = whiskers.map(reach);
        let own = whiskers.map(|whisker| whisker.max(RADIUS) + 4.0);
        let span = if x + right_reach <= right || x - left_reach < left {
            [x - own[0], x + right_reach]
        } else {
            [x - left_reach, x + own[1]]
        };
        let is_free = |lane: &Vec<[f64; 2]>| lane.iter().all(|other| span[1] <= other[0] || other[1] <= span[0]);
        let lane = taken.iter().position(is_free).unwrap_or_else(|| {
            if taken.len() < most {
                taken.push(Vec::new());
                taken.len() - 1
            } else {
                order % most
            }
        });
        taken[lane].push(span);
        found.insert(*index, lane);
    }
    found
}

/// Returns the x coordinates of the whisker's ends, from the fastest to the slowest frame, around the median at `x`.
fn whiskers(row: &ReportRow, x: f64, across: &LogScale) -> [f64; 2] {
    let length = |ms: f64| if ms.is_finite() { (across.position(ms) - x).abs() } else { 0.0 };
    [length(row.frame_ms.min), length(row.frame_ms.max)]
}

fn spot(report: &Report, index: usize, at: [f64; 2], frame: &ChartFrame) -> PlotPoint {
    let row = &report.rows[index];
    let [left, right] = whiskers(row, at[0], &frame.across);
    PlotPoint {
        row: index,
        at,
        whisker: [at[0] - left, at[0] + right],
        style: style_of(&row.technique),
        filled: row.pareto,
        name: row.summary(),
        details: row.details(),
    }
}

/// The text beside a row's mark.
#[derive(Debug)]
struct MarkCaption {
    text: String,
    /// True where no other mark's text in the chart names the technique.
    names_technique: bool,
}

/// Returns a text for each row: the row of a technique that is on the front and fastest has its full name; the others
/// have their label, which says what distinguishes them, or the name where that is empty.
fn captions(report: &Report, rows: &[usize]) -> BTreeMap<usize, MarkCaption> {
    let caption = |index: &usize| {
        let row = &report.rows[*index];
        let of_technique = || rows.iter().filter(|other| report.rows[**other].technique == row.technique);
        // The fastest of the front, or else of all.
        let namer = of_technique().min_by(|a, b| {
            let [a, b] = [&report.rows[**a], &report.rows[**b]];
            b.pareto.cmp(&a.pareto).then(a.frame_ms.median.total_cmp(&b.frame_ms.median))
        });
        let names_technique = namer == Some(index);
        let text = if names_technique || row.label.is_empty() { row.name() } else { row.label.clone() };
        (*index, MarkCaption { text, names_technique })
    };
    rows.iter().map(caption).collect()
}

/// Groups each technique's rows into chains whose settings differ in one number only, sorted by that number. Where
/// several numbers vary, uses the one that gives the longest chain. Leaves out chains of one row.
fn chains(report: &Report, rows: &[usize]) -> Vec<Vec<usize>> {
    let mut techniques: Vec<&str> = rows.iter().map(|index| report.rows[*index].technique.as_str()).collect();
    techniques.sort_unstable();
    techniques.dedup();
    let of =
        |technique: &str| rows.iter().copied().filter(|index| report.rows[*index].technique == technique).collect();
    techniques.into_iter().flat_map(|technique| chains_of(report, of(technique))).collect()
}

/// All settings but the number that varies.
type OtherSettings<'a> = Vec<(&'a String, &'a String)>;

fn chains_of(report: &Report, rows: Vec<usize>) -> Vec<Vec<usize>> {
    let mut keys: Vec<&String> = rows.iter().flat_map(|index| report.rows[*index].settings.keys()).collect();
    keys.sort_unstable();
    keys.dedup();
    let along = |key: &String| {
        let mut groups: BTreeMap<OtherSettings, Vec<(f64, usize)>> = BTreeMap::new();
        for index in &rows {
            let settings = &report.rows[*index].settings;
            let value = settings.get(key).and_then(|value| value.parse::<f64>().ok());
            let others = settings.iter().filter(|(other, _)| *other != key).collect();
            if let Some(value) = value.filter(|value| value.is_finite()) {
                groups.entry(others).or_default().push((value, *index));
            }
        }
        let chains = groups.into_values().map(|mut chain| {
            chain.sort_by(|a, b| a.0.total_cmp(&b.0));
            chain.dedup_by_key(|(value, _)| value.to_bits());
            chain.into_iter().map(|(_, index)| index).collect::<Vec<_>>()
        });
        chains.filter(|chain| chain.len() > 1).collect::<Vec<_>>()
    };
    let longest = |chains: &Vec<Vec<usize>>| chains.iter().map(Vec::len).max().unwrap_or(0);
    // Of equal ones the first key counts.
    keys.into_iter().map(along).rev().max_by_key(longest).unwrap_or_default()
}

/// Returns the Pareto front of these rows as a staircase line from left to right; `None` where fewer than two rows are
/// on it.
fn front(report: &Report, rows: &[usize], place: &dyn Fn(usize) -> [f64; 2]) -> Option<PlotLine> {
    let mut on_front: Vec<[f64; 2]> =
        rows.iter().filter(|index| report.rows[**index].pareto).map(|index| place(*index)).collect();
    on_front.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut points: Vec<[f64; 2]> = Vec::new();
    for at in on_front {
        if let Some(last) = points.last().copied().filter(|last| last[0] != at[0] && last[1] != at[1]) {
            points.push([at[0], last[1]]);
        }
        points.push(at);
    }
    (points.len() > 1).then_some(PlotLine { points, width: 1.6, ink: PlotInk::Front, faint: false })
}

fn segments(lines: &[PlotLine]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    lines.iter().flat_map(|line| line.points.windows(2).map(|pair| [pair[0], pair[1]]))
}

/// Places texts beside marks, and lines to those that are far away. Names of techniques are placed first, then rows on
/// the front; empty texts are left out, and so are those without a free place, those that name a technique only where there is none at all.
fn label(
    report: &Report,
    spots: &[PlotPoint],
    captions: &BTreeMap<usize, MarkCaption>,
    frame: &ChartFrame,
    obstacles: &LabelObstacles,
) -> (Vec<PlotText>, Vec<PlotLine>) {
    let with_caption = spots.iter().filter_map(|spot| Some((spot, captions.get(&spot.row)?)));
    let mut ordered: Vec<(&PlotPoint, &MarkCaption)> =
        with_caption.filter(|(_, caption)| !caption.text.is_empty()).collect();
    ordered.sort_by_key(|(spot, caption)| (!caption.names_technique, !spot.filled));
    let wishes: Vec<LabelRequest> = ordered
        .iter()
        .map(|(spot, caption)| {
            let Axes { area, band, .. } = frame.axes;
            // In the band of the right ones the name of a wrong one would say that it is right.
            let own = if report.rows[spot.row].wrong_fraction == 0.0 { band } else { area };
            LabelRequest {
                at: spot.at,
                whiskers: spot.whisker.map(|x| (x - spot.at[0]).abs()),
                text: caption.text.clone(),
                ink: PlotInk::Technique(spot.style),
                area: own,
                must: caption.names_technique,
            }
        })
        .collect();
    labels::words_and_leaders(&wishes, obstacles)
}

impl SceneChart {
    /// Returns the chart moved by this vector (right, down), points.
    pub(crate) fn moved(self, [right, down]: [f64; 2]) -> SceneChart {
        let to = |[x, y]: [f64; 2]| [x + right, y + down];
        let rect = |rect: PlotRect| PlotRect { min: to(rect.min), max: to(rect.max) };
        let text = |text: PlotText| PlotText { at: to(text.at), ..text };
        let line = |line: PlotLine| PlotLine { points: line.points.into_iter().map(to).collect(), ..line };
        let spot = |spot: PlotPoint| PlotPoint { at: to(spot.at), whisker: spot.whisker.map(|x| x + right), ..spot };
        SceneChart {
            title: self.title,
            area: rect(self.area),
            band: rect(self.band),
            lines: self.lines.into_iter().map(line).collect(),
            spots: self.spots.into_iter().map(spot).collect(),
            texts: self.texts.into_iter().map(text).collect(),
            labels: self.labels.into_iter().map(text).collect(),
        }
    }
}
