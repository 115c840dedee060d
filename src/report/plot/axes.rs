//! Axes of a chart of wrong pixels: its area and band, ticks along both, and the lines and texts that follow.

use super::scale::{self, LogScale};
use super::{PlotInk, PlotLine, PlotRect, PlotText, TITLE_SIZE, TextAnchor};
use crate::numbers;

/// Gap between area and band that no line of the axis crosses, points.
pub(crate) const BREAK: f64 = 7.0;
/// Distance between the band's edges and its lanes, points.
const BAND_EDGE: f64 = 3.0;
/// The range of the vertical axis where no row has a position on it, per cent.
const NO_ERRORS: [f64; 2] = [0.01, 10.0];
/// The tick text of the band for rows without a wrong pixel.
pub(crate) const NONE_WRONG: &str = "none wrong";

/// A tick on an axis: its position and text.
#[derive(Debug)]
pub(crate) struct Tick {
    /// Position along the axis, points.
    pub at: f64,
    /// Its text.
    pub text: String,
}

impl Tick {
    /// Returns ticks at these `values`, in order: their positions on the scale, and their numbers with `unit` after a
    /// no-break space.
    pub fn along(scale: &LogScale, values: impl IntoIterator<Item = f64>, unit: &str) -> Vec<Tick> {
        let tick = |value| Tick { at: scale.position(value), text: format!("{}\u{a0}{unit}", number(value)) };
        values.into_iter().map(tick).collect()
    }
}

/// Returns a tick's number as text: as it is from 1e-5 to below 1000, with separated thousands to below 1e7 (cut to
/// whole numbers), else in scientific notation.
fn number(value: f64) -> String {
    match value {
        1e-5..1e3 => value.to_string(),
        1e3..1e7 => numbers::count(value as u64),
        _ => format!("{value:e}"),
    }
}

/// The axes of a chart, in points relative to the chart's upper left corner.
#[derive(Debug)]
pub(crate) struct Axes {
    /// Area of points with wrong pixels.
    pub area: PlotRect,
    /// Area of points without a wrong pixel.
    pub band: PlotRect,
    /// Height of a lane of the band, points.
    lane_height: f64,
    /// The vertical scale, per cent of wrong pixels.
    up: LogScale,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
}

impl Axes {
    /// Returns axes within `outer` that contain all positive `percents`, with vertical ticks at least `apart` points
    /// from one to the next and none above 100 per cent. Below is a band of `lanes` for rows with 0.
    pub fn new(
        outer: PlotRect,
        lanes: usize,
        lane_height: f64,
        percents: impl Iterator<Item = f64>,
        apart: f64,
        x_ticks: Vec<Tick>,
    ) -> Axes {
        let band_top = outer.max[1] - lanes as f64 * lane_height - 2.0 * BAND_EDGE;
        let band = PlotRect { min: [outer.min[0], band_top], max: outer.max };
        let area = PlotRect { min: outer.min, max: [outer.max[0], band_top - BREAK] };
        let up = LogScale::new(scale::range(percents, NO_ERRORS), [area.max[1], area.min[1]]);
        // The scale may continue above the largest value.
        let y_ticks = Tick::along(&up, up.ticks(apart).into_iter().filter(|percent| *percent <= 100.0), "%");
        Axes { area, band, lane_height, up, x_ticks, y_ticks }
    }

    /// Returns the y coordinate of a percentage of wrong pixels on the logarithmic axis; where it is 0, the middle of
    /// the band's `lane`, which counts from 0 at the top.
    pub fn height(&self, percent: f64, lane: usize) -> f64 {
        if percent > 0.0 {
            self.up.position(percent)
        } else {
            self.band.min[1] + BAND_EDGE + (lane as f64 + 0.5) * self.lane_height
        }
    }

    /// Returns a grid line for each tick: one through the area for a vertical tick, two for a horizontal one (area and
    /// band).
    pub fn grid(&self) -> Vec<PlotLine> {
        let [left, right] = [self.area.min[0], self.area.max[0]];
        let level = self.y_ticks.iter().map(|tick| PlotLine::grid([[left, tick.at], [right, tick.at]]));
        let upright = self.x_ticks.iter().flat_map(|tick| {
            [&self.area, &self.band].map(|rect| PlotLine::grid([[tick.at, rect.min[1]], [tick.at, rect.max[1]]]))
        });
        level.chain(upright).collect()
    }

    /// Returns the texts of the chart's title and of the captions of both axes.
    pub fn captions(&self, title: &str, across: &str) -> Vec<PlotText> {
        vec![
            PlotText::new([8.0, 10.0], title, TITLE_SIZE, PlotInk::Text).strong(),
            PlotText::small([8.0, 27.0], "wrong pixels, of those compared"),
            PlotText::small([self.area.max[0], self.band.max[1] + 28.0], across).anchored(TextAnchor::End),
        ]
    }

    /// Returns the texts of all ticks, and that of the band for rows without a wrong pixel.
    pub fn tick_texts(&self) -> impl Iterator<Item = PlotText> {
        let beside = |y, text: &str| PlotText::small([self.area.min[0] - 6.0, y], text).anchored(TextAnchor::End);
        let none = beside((self.band.min[1] + self.band.max[1]) / 2.0, NONE_WRONG);
        let below =
            |tick: &Tick| PlotText::small([tick.at, self.band.max[1] + 11.0], &*tick.text).anchored(TextAnchor::Middle);
        let level = self.y_ticks.iter().map(move |tick| beside(tick.at, &tick.text));
        level.chain([none]).chain(self.x_ticks.iter().map(below))
    }
}
