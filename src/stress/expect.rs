//! What is expected of a technique at one value.
//!
//! A known [`Failure`] says at which values it shows, what its wrong pixels are, and of how many it
//! is the reason. Beyond these the technique must be right, so a known failure excuses nothing else.

use super::Entrant;
use crate::technique::{Standing, Technique};
use std::fmt;

/// A failure that is known.
#[derive(Debug, Clone, Copy)]
pub struct Failure {
    /// Whose.
    pub of: Entrant,
    /// Why it shows.
    pub because: &'static str,
    /// At which values.
    pub at: fn(f64) -> bool,
    /// How.
    pub symptom: Symptom,
    /// Must it show there? Else it may.
    pub must_show: bool,
}

/// How a failure shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symptom {
    /// Its name, such as `near-plane`.
    pub name: &'static str,
    /// What its wrong pixels are.
    pub kind: Kind,
    /// It makes at most this share of the compared pixels wrong.
    pub most: f64,
}

/// What wrong pixels are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Dark, and lit in truth.
    False,
    /// Lit, and dark in truth.
    Missing,
    /// Either.
    Either,
    /// Some of each.
    Mixed,
    /// Either, or of another surface than in truth.
    Any,
}

/// What is expected of a technique at one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Expected {
    /// No wrong pixel.
    Right,
    /// This failure shows.
    Fails(Symptom),
    /// Not promised to be right: this may show.
    MayFail(Symptom),
}

named_enum! {
    /// What came of it.
    pub enum Verdict {
        /// Nothing is wrong.
        Holds = "holds",
        /// What is wrong was known to be.
        FailsAsKnown = "fails as known",
        /// Nobody expected this.
        Unexpected = "unexpected",
    }
}

named_enum! {
    /// Why a row is not what was expected.
    pub enum Surprise {
        /// The truth has too few lit or dark pixels for the row to mean anything.
        LittleToSee = "too few lit or dark pixels to compare",
        /// Wrong pixels, where none is known.
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

impl Failure {
    /// A failure that shows at every value, anyhow.
    pub const fn new(of: Entrant, name: &'static str, because: &'static str) -> Failure {
        let symptom = Symptom { name, kind: Kind::Either, most: 1.0 };
        Failure { of, because, at: |_| true, symptom, must_show: true }
    }

    /// Another's.
    #[must_use]
    pub const fn of(self, of: Entrant) -> Failure {
        Failure { of, ..self }
    }

    /// It shows at these values only.
    pub const fn at(self, at: fn(f64) -> bool) -> Failure {
        Failure { at, ..self }
    }

    /// Its wrong pixels are false shadow.
    #[must_use]
    pub const fn is_false(self) -> Failure {
        Failure { symptom: Symptom { kind: Kind::False, ..self.symptom }, ..self }
    }

    /// Its wrong pixels are missing shadow.
    #[must_use]
    pub const fn is_missing(self) -> Failure {
        Failure { symptom: Symptom { kind: Kind::Missing, ..self.symptom }, ..self }
    }

    /// Its wrong pixels are false shadow and missing shadow, some of each.
    #[must_use]
    pub const fn is_mixed(self) -> Failure {
        Failure { symptom: Symptom { kind: Kind::Mixed, ..self.symptom }, ..self }
    }

    /// Its wrong pixels may be those of another surface.
    #[must_use]
    pub const fn is_any(self) -> Failure {
        Failure { symptom: Symptom { kind: Kind::Any, ..self.symptom }, ..self }
    }

    /// It makes at most this share of the compared pixels wrong.
    #[must_use]
    pub const fn at_most(self, most: f64) -> Failure {
        Failure { symptom: Symptom { most, ..self.symptom }, ..self }
    }

    /// It need not show.
    #[must_use]
    pub const fn perhaps(self) -> Failure {
        Failure { must_show: false, ..self }
    }

    pub(super) fn expected(&self) -> Expected {
        if self.must_show { Expected::Fails(self.symptom) } else { Expected::MayFail(self.symptom) }
    }
}

/// What texels do along a shadow's edge, for techniques that are never promised to be right.
pub fn texels(technique: Technique) -> Option<(Symptom, &'static str)> {
    let Standing::Rival { texels, .. } = technique.description().standing else { return None };
    let (most, because) = texels?;
    Some((Symptom { name: "aliasing", kind: Kind::Either, most }, because))
}

impl Expected {
    /// In JSON and tables.
    pub fn name(self) -> &'static str {
        self.symptom().map_or("right", |symptom| symptom.name)
    }

    pub(super) fn symptom(self) -> Option<Symptom> {
        match self {
            Expected::Right => None,
            Expected::Fails(symptom) | Expected::MayFail(symptom) => Some(symptom),
        }
    }
}

impl fmt::Display for Surprise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
