//! How a case's rows change from value to value, where that is the lesson.

use super::{ExpectedResult, StressRow, value_text};
use crate::numbers;
use crate::scene::{MeshError, Scene};

/// How the results of a stress case must change from value to value.
#[derive(Debug, Clone, Copy)]
pub enum ExpectedTrend {
    /// The pictures converge to the truth of another scene, which the function builds.
    ConvergesTo(fn() -> Result<Scene, MeshError>),
    /// The number of pixels that differ from the truth, those excused along edges included, falls as the case's number
    /// grows.
    Falls,
    /// Pixels stand still in the motion, but for those of failures that flicker: some of these must flip.
    StandsStill,
    /// Times grow, at most by this factor where the case's number grows tenfold.
    Grows(f64),
}

/// How the results of one technique change from value to value, and whether that is as expected.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct TechniqueCourse {
    /// The change in words and numbers.
    pub text: String,
    /// True where the change is as expected.
    pub holds: bool,
}

/// Rises of the error by no more pixels than this are ignored: they may come from texels that happen to lie well at the
/// size before. So are as few flips: points on the border of two texels go with the rounding of one frame or another.
const NOISE: u64 = 3;
/// The least value whose times are compared: below it, times are those of a frame and not of its triangles.
const LEAST_TIMED: f64 = 1e4;

impl ExpectedTrend {
    /// Returns how one technique's rows changed, in the order of their values; `None` where they are too few to decide.
    pub fn course(&self, rows: &[&StressRow]) -> Option<TechniqueCourse> {
        match self {
            ExpectedTrend::ConvergesTo(_) => converges(rows),
            ExpectedTrend::Falls => falls(rows),
            ExpectedTrend::StandsStill => stands_still(rows),
            ExpectedTrend::Grows(most) => grows(rows, *most),
        }
    }
}

/// Returns one technique's course towards the limit scene of [`ExpectedTrend::ConvergesTo`]: the numbers of wrong
/// pixels against that scene's truth. It holds where they never rise, begin above 0 and end at 0, or where the
/// technique isn't expected to be right at the last value. `None` where fewer than two rows have such a number.
fn converges(rows: &[&StressRow]) -> Option<TechniqueCourse> {
    let off: Vec<u64> = rows.iter().filter_map(|row| row.off_limit).collect();
    let [first, .., last] = off[..] else { return None };
    let is_promised = rows.last().is_some_and(|row| row.expected == ExpectedResult::Right);
    let is_falling = off.windows(2).all(|pair| pair[1] <= pair[0]);
    let counts: Vec<String> = off.iter().map(|count| numbers::count(*count)).collect();
    let text = format!("{} pixels differ from the limit", counts.join(", "));
    Some(TechniqueCourse { text, holds: !is_promised || (is_falling && first > 0 && last == 0) })
}

/// Returns the course of one technique's rows towards the truth: it holds where the number of pixels that differ,
/// excused or not, does not rise (but for noise) and ends below a quarter of the first. `None` for fewer than two rows.
fn falls(rows: &[&StressRow]) -> Option<TechniqueCourse> {
    let errors: Vec<(f64, u64)> =
        rows.iter().map(|row| (row.parameter.1, row.error.wrong() + row.error.edge_band)).collect();
    let [(_, first), .., (_, last)] = errors[..] else { return None };
    let holds = errors.windows(2).all(|pair| pair[1].1 <= pair[0].1 + NOISE) && 4 * last < first;
    let product = |(value, error): &(f64, u64)| {
        let [error, product] = [*error, (*error as f64 * value) as u64].map(numbers::count);
        format!("{} × {error} = {product}", value_text(*value))
    };
    let products: Vec<String> = errors.iter().map(product).collect();
    Some(TechniqueCourse { text: format!("size × error: {}", products.join(", ")), holds })
}

/// Returns the course of one technique's rows through a motion that changes nothing in truth: it holds where pixels flip
/// (but for noise) if, and only if, a known failure of the technique flickers. `None` for fewer than two rows.
fn stands_still(rows: &[&StressRow]) -> Option<TechniqueCourse> {
    let flips: u64 = rows.iter().map(|row| row.flips).reduce(|all, more| Some(all.unwrap_or(0) + more?))??;
    let flickers = rows.iter().any(|row| row.expected.symptom().is_some_and(|symptom| symptom.flickers));
    let text = format!("{} flips over {} steps", numbers::count(flips), rows.len() - 1);
    Some(TechniqueCourse { text, holds: (flips > NOISE) == flickers })
}

fn grows(rows: &[&StressRow], most: f64) -> Option<TechniqueCourse> {
    let [_, _, ..] = rows else { return None };
    let times = |of: fn(&StressRow) -> f64| -> Vec<f64> {
        rows.windows(2).map(|pair| growth([pair[0], pair[1]], of)).collect()
    };
    let [setup, frame] = [times(|row| row.setup_ms), times(|row| row.frame_ms)];
    let list = |factors: &[f64]| factors.iter().map(|factor| format!("{factor:.1}")).collect::<Vec<_>>().join(", ");
    let text = format!("per ten times as many: setup × {}; frame × {}", list(&setup), list(&frame));
    let timed: Vec<&StressRow> = rows.iter().copied().filter(|row| row.parameter.1 >= LEAST_TIMED).collect();
    let holds = match timed[..] {
        [first, .., last] => [|row: &StressRow| row.setup_ms, |row: &StressRow| row.frame_ms]
            .into_iter()
            .all(|of| growth([first, last], of) <= most),
        _ => true,
    };
    Some(TechniqueCourse { text, holds })
}

/// Returns the factor by which `of` grows for ten times the number.
fn growth([from, to]: [&StressRow; 2], of: fn(&StressRow) -> f64) -> f64 {
    (of(to) / of(from)).powf(1.0 / (to.parameter.1 / from.parameter.1).log10())
}
