//! What is expected of a technique at one value.
//!
//! A [`KnownFailure`] states at which values it shows, of what kind its wrong pixels are, and how many it explains.
//! Beyond these the technique must be right, so a known failure excuses nothing else.

use super::Entrant;
use crate::accuracy::USUAL_STEP;
use crate::technique::{ComparisonRole, Technique};
use std::fmt;

/// The largest share of the compared pixels that a rasteriser makes wrong which moves corners by a pixel without their
/// depth: in proportion, the smaller its step.
pub(super) const MOST_BY_STEP: f64 = 1.0 / 128.0;

/// Name of what such a rasteriser makes wrong.
const PRECISION: &str = "rasteriser-precision";

/// Failures by rounding: which pixels they make wrong, and how many, depends on the rasteriser's step. Volumes that are
/// extruded by next to nothing are thinner than depth's rounding.
const BY_ROUNDING: [&str; 5] =
    ["f32-limit", "depth-bits", "near-plane-rounding", "near-plane-crack", "finite-extrusion"];

/// A failure that a technique is known to have in a stress case: at which values, how it shows, and why.
#[derive(Debug, Clone, Copy)]
pub struct KnownFailure {
    /// The technique that fails.
    pub of: Entrant,
    /// The reason of the failure, in words.
    pub because: &'static str,
    /// Returns whether the failure shows at a value.
    pub at: fn(f64) -> bool,
    /// How the failure shows.
    pub symptom: FailureSymptom,
    /// True where the failure must show at these values; false where it may.
    pub must_show: bool,
}

/// How a failure shows: its name, and the kind and share of its wrong pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FailureSymptom {
    /// Name of the failure, such as `near-plane`.
    pub name: &'static str,
    /// The kind of its wrong pixels.
    pub kind: WrongPixelKind,
    /// The largest share of the compared pixels that the failure makes wrong, 0 to 1.
    pub most: f64,
    /// Whether pixels flip in a motion that they stand still in.
    pub flickers: bool,
}

/// The kinds of wrong pixels that a failure causes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrongPixelKind {
    /// False shadow: pixels that are dark, and lit in truth.
    False,
    /// Missing shadow: pixels that are lit, and in shadow in truth.
    Missing,
    /// False shadow or missing shadow, or both.
    Either,
    /// Both false shadow and missing shadow, some of each.
    Mixed,
    /// False shadow, missing shadow, or pixels that show another surface than in truth.
    Any,
}

/// What a stress case expects of a technique at one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExpectedResult {
    /// The technique has no wrong pixel.
    Right,
    /// The technique must fail with this symptom.
    Fails(FailureSymptom),
    /// The technique may fail with this symptom: it is not promised to be right.
    MayFail(FailureSymptom),
}

named_enum! {
    /// The verdict on a row, or on all rows of a technique in a case.
    pub enum StressVerdict {
        /// There is no wrong pixel beyond what is excused along edges.
        Holds = "holds",
        /// The adapter can't hold what is to be drawn.
        NotDrawn = "not drawn",
        /// The wrong pixels are those of a known failure.
        FailsAsKnown = "fails as known",
        /// The result is not as expected.
        Unexpected = "unexpected",
    }
}

named_enum! {
    /// Why a row is not what was expected.
    pub enum UnexpectedResult {
        /// The truth has too few lit or dark pixels for the row to mean anything.
        LittleToSee = "too few lit or dark pixels to compare",
        /// There are wrong pixels, where no failure is known.
        Wrong = "wrong where it must be right",
        /// The known failure does not show.
        NotShown = "right where it is known to fail",
        /// Wrong pixels of another kind than the known failure's.
        OtherKind = "wrong in another way than known",
        /// More wrong pixels than the known failure explains.
        TooMany = "more wrong than known",
        /// So many pixels differ along edges that excusing them hides an error.
        TooManyExcused = "too many pixels excused along edges",
        /// Pixels flip from one time of the motion to the next and back, which they do not in truth.
        Flickers = "pixels flicker",
    }
}

impl KnownFailure {
    /// Returns a failure that shows at every value, with any kind and share of wrong pixels.
    pub const fn new(of: Entrant, name: &'static str, because: &'static str) -> KnownFailure {
        let symptom = FailureSymptom { name, kind: WrongPixelKind::Either, most: 1.0, flickers: false };
        KnownFailure { of, because, at: |_| true, symptom, must_show: true }
    }

    /// Returns the same failure (name, reason, symptom, values) for another technique.
    #[must_use]
    pub const fn of(self, of: Entrant) -> KnownFailure {
        KnownFailure { of, ..self }
    }

    /// Returns the failure limited to values for which `at` is true.
    pub const fn at(self, at: fn(f64) -> bool) -> KnownFailure {
        KnownFailure { at, ..self }
    }

    /// Returns the failure with wrong pixels that are false shadow.
    #[must_use]
    pub const fn is_false(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::False, ..self.symptom }, ..self }
    }

    /// Returns the failure with wrong pixels that are missing shadow.
    #[must_use]
    pub const fn is_missing(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::Missing, ..self.symptom }, ..self }
    }

    /// Returns the failure with wrong pixels that are false shadow and missing shadow, some of each.
    #[must_use]
    pub const fn is_mixed(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::Mixed, ..self.symptom }, ..self }
    }

    /// Returns the failure with wrong pixels of any kind, those that show another surface included.
    #[must_use]
    pub const fn is_any(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::Any, ..self.symptom }, ..self }
    }

    /// Returns the failure with this largest share of the compared pixels that it makes wrong, 0 to 1.
    #[must_use]
    pub const fn at_most(self, most: f64) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { most, ..self.symptom }, ..self }
    }

    /// Returns the failure with pixels that flip from one time of a motion to the next and back, beside wrong ones.
    #[must_use]
    pub const fn flickers(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { flickers: true, ..self.symptom }, ..self }
    }

    /// Returns the failure as one that may show but need not: the technique may be right as well.
    #[must_use]
    pub const fn perhaps(self) -> KnownFailure {
        KnownFailure { must_show: false, ..self }
    }

    pub(super) fn expected(&self) -> ExpectedResult {
        if self.must_show { ExpectedResult::Fails(self.symptom) } else { ExpectedResult::MayFail(self.symptom) }
    }
}

/// Returns the symptom (aliasing) and the reason of the failure that texels along shadow edges may always cause; `None`
/// for a technique that has no texels, or is not compared in stress cases.
pub fn texels(technique: Technique) -> Option<(FailureSymptom, &'static str)> {
    let ComparisonRole::Rival { texels, .. } = technique.description().standing else { return None };
    let (most, because) = texels?;
    Some((FailureSymptom { name: "aliasing", kind: WrongPixelKind::Either, most, flickers: false }, because))
}

impl ExpectedResult {
    /// Returns the result's name in JSON and tables: `right`, or that of the failure, whether it must show or only may.
    pub fn name(self) -> &'static str {
        self.symptom().map_or("right", |symptom| symptom.name)
    }

    /// Returns what is expected on an adapter that moves corners to multiples of `step` pixels without their depth; the
    /// same for `None`. There, what must be right may be wrong in a few pixels (`StressRow::few`); failures by rounding show
    /// in other pixels than where their shares were measured, in more of them the coarser the step, or in none; and as
    /// triangles are then computed in double precision, what a vertex shader computes wrongly need not show.
    pub(super) fn on(self, step: Option<f64>, entrant: &Entrant) -> ExpectedResult {
        let Some(step) = step else { return self };
        match self {
            ExpectedResult::Right => ExpectedResult::MayFail(FailureSymptom {
                name: PRECISION,
                kind: WrongPixelKind::Any,
                most: 0.0,
                flickers: false,
            }),
            ExpectedResult::Fails(symptom) | ExpectedResult::MayFail(symptom)
                if BY_ROUNDING.contains(&symptom.name) =>
            {
                let most = (symptom.most * step / USUAL_STEP).min(1.0);
                ExpectedResult::MayFail(FailureSymptom { kind: WrongPixelKind::Any, most, ..symptom })
            }
            ExpectedResult::Fails(symptom) if entrant.is_extruded() => ExpectedResult::MayFail(symptom),
            other => other,
        }
    }

    /// Returns whether the rasteriser's step is all that may make pixels wrong.
    pub(super) fn is_by_precision(self) -> bool {
        self.name() == PRECISION
    }

    pub(super) fn symptom(self) -> Option<FailureSymptom> {
        match self {
            ExpectedResult::Right => None,
            ExpectedResult::Fails(symptom) | ExpectedResult::MayFail(symptom) => Some(symptom),
        }
    }
}

impl fmt::Display for UnexpectedResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
