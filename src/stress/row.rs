//! One technique at one value of one case: what was measured, and whether that is as expected.

use super::expect::{
    ExpectedResult, FailureSymptom, MOST_BY_STEP, StressVerdict, UnexpectedResult, WrongPixelKind, texels,
};
use super::{Entrant, StressCase};
use crate::accuracy::ErrorCounts;
use std::collections::BTreeMap;

/// The largest share of compared pixels that the edge band may excuse; more of them hide an error.
const MOST_EXCUSED: f64 = 0.02;

/// The result of one technique at one value of one stress case.
#[derive(Debug, Clone, PartialEq)]
pub struct StressRow {
    /// Name of the case.
    pub case: &'static str,
    /// Name and value of the case's number.
    pub parameter: (&'static str, f64),
    /// The technique.
    pub entrant: Entrant,
    /// Values of all settings of the technique, by name.
    pub settings: BTreeMap<String, String>,
    /// Numbers of pixels by finding, compared with the truth and summed over lights.
    pub error: ErrorCounts,
    /// Numbers of pixels by their label in truth.
    pub seen: TruthCounts,
    /// Number of pixels that have changed since the value before and back again although the truth did not; `None`
    /// where the case is no motion, and at its first value.
    pub flips: Option<u64>,
    /// Number of wrong pixels compared with the truth of the scene to which the case converges; `None` where it
    /// converges to none.
    pub off_limit: Option<u64>,
    /// The step to which the adapter moves corners without their depth, pixels; `None` where it draws triangles as they
    /// are given.
    pub step: Option<f64>,
    /// Why the adapter can't draw this row, in words; `None` where it has drawn it.
    pub not_drawn: Option<String>,
    /// What is expected of the technique at this value on this adapter.
    pub expected: ExpectedResult,
    /// Wall time of a frame without set-up, milliseconds.
    pub frame_ms: f64,
    /// Time of planning, geometry, pipelines and uploads, milliseconds.
    pub setup_ms: f64,
}

/// Numbers of pixels by their label in truth, summed over lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub struct TruthCounts {
    /// Number of all pixels.
    pub pixels: u64,
    /// Number of lit pixels.
    pub lit: u64,
    /// Number of pixels in shadow.
    pub shadow: u64,
}

/// The least shares of all pixels that must be lit and in shadow for a row to mean anything, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastShares {
    /// Share of lit pixels.
    pub lit: f64,
    /// Share of pixels in shadow.
    pub shadow: f64,
    /// Why the shares are lower than usual; empty where they are not.
    pub because: &'static str,
}

impl LeastShares {
    /// The shares that most cases need: enough for an edge of some length between light and shadow.
    pub const USUAL: LeastShares = LeastShares { lit: 0.01, shadow: 0.002, because: "" };

    /// Returns shares where no pixel need be lit.
    pub const fn all_dark(because: &'static str) -> LeastShares {
        LeastShares { lit: 0.0, because, ..LeastShares::USUAL }
    }

    /// Returns shares where no pixel need be in shadow.
    pub const fn all_lit(because: &'static str) -> LeastShares {
        LeastShares { shadow: 0.0, because, ..LeastShares::USUAL }
    }

    /// Returns shares where no pixel need be lit or in shadow, with the reason.
    pub const fn nothing(because: &'static str) -> LeastShares {
        LeastShares { lit: 0.0, shadow: 0.0, because }
    }
}

impl StressRow {
    /// Returns how many pixels the rasteriser alone may make wrong, beside what the technique does: in proportion to the
    /// step to which it moves corners, at least one; 0 where it moves none.
    fn few(&self) -> f64 {
        self.step.map_or(0.0, |step| (step * MOST_BY_STEP * self.error.compared as f64).max(1.0))
    }

    /// Returns whether so many pixels differ along edges that excusing them hides an error.
    pub fn is_blurred(&self) -> bool {
        self.error.edge_band as f64 > MOST_EXCUSED * self.error.compared as f64
    }

    /// Returns why this row is not what was expected; `None` where it is, and where it is not drawn. Too little to see
    /// comes before all else. A failure that must show and does not is a surprise; one that only may is not.
    pub fn surprise(&self) -> Option<UnexpectedResult> {
        if self.not_drawn.is_some() {
            return None;
        }
        if self.is_little_to_see() {
            return Some(UnexpectedResult::LittleToSee);
        }
        let error = &self.error;
        let is_blurred = self.is_blurred();
        let shows = error.wrong() > 0 || is_blurred;
        let Some(FailureSymptom { kind, most, .. }) = self.expected.symptom() else {
            return match (error.wrong(), self.flips) {
                (1.., _) => Some(UnexpectedResult::Wrong),
                _ if is_blurred => Some(UnexpectedResult::TooManyExcused),
                (_, Some(1..)) => Some(UnexpectedResult::Flickers),
                _ => None,
            };
        };
        let others = match kind {
            WrongPixelKind::False => error.missing_shadow,
            WrongPixelKind::Missing => error.false_shadow,
            WrongPixelKind::Either | WrongPixelKind::Mixed | WrongPixelKind::Any => 0,
        };
        let few = self.few();
        // A coarse step excuses wider edges, and makes some of them flicker: beyond that, both are no better than wrong.
        if self.expected.is_by_precision() {
            if error.edge_band as f64 > 2.0 * (MOST_EXCUSED * error.compared as f64 + few) {
                return Some(UnexpectedResult::TooManyExcused);
            }
            if self.flips.is_some_and(|flips| flips as f64 > few) {
                return Some(UnexpectedResult::Flickers);
            }
        }
        let is_one_sided = error.false_shadow == 0 || error.missing_shadow == 0;
        // Texels show in these techniques, beside their known failures.
        let blur = texels(self.entrant.technique).map_or(0.0, |(symptom, _)| symptom.most);
        if !shows && matches!(self.expected, ExpectedResult::Fails(_)) {
            Some(UnexpectedResult::NotShown)
        } else if (error.wrong_surface as f64 > few && kind != WrongPixelKind::Any)
            || others as f64 > blur * error.compared as f64 + few
            || kind == WrongPixelKind::Mixed && is_one_sided && shows
        {
            Some(UnexpectedResult::OtherKind)
        } else if error.wrong() as f64 > most * error.compared as f64 + few {
            Some(UnexpectedResult::TooMany)
        } else {
            None
        }
    }

    /// Returns the verdict on the row: not drawn where the adapter can't hold it; unexpected where it has a surprise; fails
    /// as known where a failure must show, any pixel is wrong, or pixels flip as a known failure makes them; else holds.
    pub fn verdict(&self) -> StressVerdict {
        if self.not_drawn.is_some() {
            return StressVerdict::NotDrawn;
        }
        let flickers = self.expected.symptom().is_some_and(|symptom| symptom.flickers) && self.flips > Some(0);
        match (self.surprise(), self.expected, self.error.wrong()) {
            (Some(_), ..) => StressVerdict::Unexpected,
            (None, ExpectedResult::Fails(_), _) | (None, _, 1..) => StressVerdict::FailsAsKnown,
            (None, ..) if flickers => StressVerdict::FailsAsKnown,
            _ => StressVerdict::Holds,
        }
    }

    /// Returns whether the truth has too few lit or dark pixels. Then a row can't be wrong, and must not pass as right.
    fn is_little_to_see(&self) -> bool {
        let Some(case) = StressCase::named(self.case) else { return false };
        let least = (case.least)(self.parameter.1);
        let pixels = self.seen.pixels as f64;
        let is_asked = least != LeastShares::nothing(least.because);
        let is_less = |count: u64, share: f64| (count as f64) < share * pixels;
        is_asked
            && (self.seen.pixels == 0 || is_less(self.seen.lit, least.lit) || is_less(self.seen.shadow, least.shadow))
    }
}

/// Returns a parameter's value as text, rounded to six digits: in powers of ten below 1e-3 and from 1e5 on, `0` for 0.
pub fn value_text(value: f64) -> String {
    // Steps of a motion are sums of tenths: digits beyond six are their rounding.
    let rounded = if value == 0.0 { 0.0 } else { format!("{value:.5e}").parse().unwrap_or(value) };
    match rounded {
        0.0 => "0".to_owned(),
        far if !(1e-3..1e5).contains(&far.abs()) => format!("{far:e}"),
        near => near.to_string(),
    }
}
