//! What is expected of a technique at one value.
//!
//! A [`KnownFailure`] states at which values it shows, of what kind its wrong pixels are, and how many it explains.
//! Beyond these the technique must be right, so a known failure excuses nothing else.

use super::Entrant;
use crate::technique::{ComparisonRole, Technique};
use std::fmt;

/// A failure that is known.
#[derive(Debug, Clone, Copy)]
pub struct KnownFailure {
    /// The technique that fails.
    pub of: Entrant,
    /// The reason, in words.
    pub because: &'static str,
    /// Returns whether it shows at a value.
    pub at: fn(f64) -> bool,
    /// How it shows.
    pub symptom: FailureSymptom,
    /// True where it must show at these values; false where it may.
    pub must_show: bool,
}

/// How a failure shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FailureSymptom {
    /// Its name, such as `near-plane`.
    pub name: &'static str,
    /// The kind of its wrong pixels.
    pub kind: WrongPixelKind,
    /// The largest share of the compared pixels that it makes wrong, 0 to 1.
    pub most: f64,
}

/// Kinds of wrong pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrongPixelKind {
    /// Dark, and lit in truth.
    False,
    /// Lit, and dark in truth.
    Missing,
    /// One of both.
    Either,
    /// Some of each.
    Mixed,
    /// One of both, or another surface than in truth.
    Any,
}

/// What is expected of a technique at one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExpectedResult {
    /// No wrong pixel.
    Right,
    /// This failure shows.
    Fails(FailureSymptom),
    /// Not promised to be right: this may show.
    MayFail(FailureSymptom),
}

named_enum! {
    /// The verdict on a row or a summary.
    pub enum StressVerdict {
        /// Nothing is wrong.
        Holds = "holds",
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
        /// Pixels flicker.
        Flickers = "pixels flicker",
    }
}

impl KnownFailure {
    /// Returns a failure that shows at every value, with any kind and share of wrong pixels.
    pub const fn new(of: Entrant, name: &'static str, because: &'static str) -> KnownFailure {
        let symptom = FailureSymptom { name, kind: WrongPixelKind::Either, most: 1.0 };
        KnownFailure { of, because, at: |_| true, symptom, must_show: true }
    }

    /// Returns the same failure of another technique.
    #[must_use]
    pub const fn of(self, of: Entrant) -> KnownFailure {
        KnownFailure { of, ..self }
    }

    /// Limits it to values for which `at` is true.
    pub const fn at(self, at: fn(f64) -> bool) -> KnownFailure {
        KnownFailure { at, ..self }
    }

    /// States that its wrong pixels are false shadow.
    #[must_use]
    pub const fn is_false(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::False, ..self.symptom }, ..self }
    }

    /// States that its wrong pixels are missing shadow.
    #[must_use]
    pub const fn is_missing(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::Missing, ..self.symptom }, ..self }
    }

    /// States that its wrong pixels are false shadow and missing shadow, some of each.
    #[must_use]
    pub const fn is_mixed(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::Mixed, ..self.symptom }, ..self }
    }

    /// States that its wrong pixels may be those of another surface.
    #[must_use]
    pub const fn is_any(self) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { kind: WrongPixelKind::Any, ..self.symptom }, ..self }
    }

    /// States the largest share of the compared pixels that it makes wrong, 0 to 1.
    #[must_use]
    pub const fn at_most(self, most: f64) -> KnownFailure {
        KnownFailure { symptom: FailureSymptom { most, ..self.symptom }, ..self }
    }

    /// States that it need not show.
    #[must_use]
    pub const fn perhaps(self) -> KnownFailure {
        KnownFailure { must_show: false, ..self }
    }

    pub(super) fn expected(&self) -> ExpectedResult {
        if self.must_show { ExpectedResult::Fails(self.symptom) } else { ExpectedResult::MayFail(self.symptom) }
    }
}

/// Returns the failure of texels along a shadow's edge, for techniques that are never promised to be right.
pub fn texels(technique: Technique) -> Option<(FailureSymptom, &'static str)> {
    let ComparisonRole::Rival { texels, .. } = technique.description().standing else { return None };
    let (most, because) = texels?;
    Some((FailureSymptom { name: "aliasing", kind: WrongPixelKind::Either, most }, because))
}

impl ExpectedResult {
    /// Its name in JSON and tables.
    pub fn name(self) -> &'static str {
        self.symptom().map_or("right", |symptom| symptom.name)
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
