//! Stiff and extreme cases: every technique is driven until it breaks, and the robust ones must not.
//!
//! ```text
//! Case (scenes, a parameter, known failures) ─► session ─► rows ─► Stress: verdicts, where it breaks
//!                                                                    └─► table, JSON, plot, tab
//! ```
//!
//! A case is data ([`cases`]): a scene for each value of one number, and for each technique and value what is expected:
//! to be right, or a failure by name. Without a failure a technique is expected to be right, except for those whose
//! texels may show ([`ExpectedResult::MayFail`]). A failure that is not expected is a bug; so is a known one that does
//! not show, since then the lesson or our knowledge is wrong.

pub mod cases;
mod expect;
mod json;
mod judge;
mod page;
mod plot;
mod row;
mod table;
mod trend;

pub use expect::{ExpectedResult, FailureSymptom, KnownFailure, StressVerdict, UnexpectedResult, WrongPixelKind};
pub use json::StressReadError;
pub use judge::{StressResults, StressRows, StressSummary, summary};
pub use row::{LeastShares, StressRow, TruthCounts, value_text};
pub use trend::{ExpectedTrend, TechniqueCourse};

use crate::scene::{MeshError, Scene};
use crate::technique::{Choice, ChoiceError, ComparisonRole, Technique};
use std::fmt;

/// Width and height of the pictures at which expectations were measured: at another size a failure of few pixels may
/// not show, or a larger share be wrong.
pub const MEASURED_AT: [u32; 2] = [320, 240];

/// Timed frames of each row in cases about times.
const TIMED_FRAMES: usize = 3;

/// A test scene that one number makes harder and harder, with the failures that techniques are known to have in it.
#[derive(Debug, Clone, Copy)]
pub struct StressCase {
    /// Name of the case on the command line.
    pub name: &'static str,
    /// What the case shows, in one line.
    pub lesson: &'static str,
    /// Name of the number that changes, with its unit.
    pub parameter: &'static str,
    /// Values of the number from easy to extreme; a single extreme has one.
    pub values: &'static [f64],
    /// What the number changes: the scene, a setting or the time of a motion.
    pub drives: CaseNumber,
    /// Width and height of the picture in pixels, where the case needs a size of its own; `None` for the size asked
    /// for.
    pub size: Option<[u32; 2]>,
    /// True for a case about times: every row is set up from nothing, and several frames are timed.
    pub timed: bool,
    /// Techniques with other settings that run in addition to the usual ones.
    pub also: &'static [Entrant],
    /// Usual techniques that are left out, each with the reason.
    pub without: &'static [(Technique, &'static str)],
    /// Techniques that run only up to a value, which is given with the reason.
    pub up_to: &'static [(Entrant, f64, &'static str)],
    /// The value above which a row takes many seconds and gigabytes, so that it is left out where other work waits for
    /// it and shares the memory, as in the window; `None` where no row does.
    pub heavy_above: Option<f64>,
    /// The known failures: which technique fails, at which values, how, and why; of several at one value the first
    /// counts. All other techniques are expected to be right.
    pub failures: &'static [KnownFailure],
    /// Returns the least shares of lit and dark pixels that the truth must have at a value.
    pub least: fn(f64) -> LeastShares,
    /// How results must change from value to value; `None` where nothing is expected.
    pub trend: Option<ExpectedTrend>,
}

/// What the number of a stress case changes.
#[derive(Debug, Clone, Copy)]
pub enum CaseNumber {
    /// The scene: the function builds the scene of a value.
    Scene(fn(f64) -> Result<Scene, MeshError>),
    /// The setting of this name, of the techniques that have it; the function builds the one scene.
    Setting(&'static str, fn() -> Result<Scene, MeshError>),
    /// The time of a motion: the function builds the scene at a time. Pixels that flip from one time to the next,
    /// though they do not in truth, are counted, too.
    Motion(fn(f64) -> Result<Scene, MeshError>),
}

/// A technique with the settings with which a stress case runs it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entrant {
    /// The technique.
    pub technique: Technique,
    /// Names and values of the settings that differ from the technique's defaults.
    pub settings: &'static [(&'static str, &'static str)],
}

impl Entrant {
    /// Returns a technique with its default settings.
    pub const fn of(technique: Technique) -> Entrant {
        Entrant { technique, settings: &[] }
    }

    /// Returns a technique with these settings, by name and value.
    pub const fn with(technique: Technique, settings: &'static [(&'static str, &'static str)]) -> Entrant {
        Entrant { technique, settings }
    }

    /// Returns the technique with these settings, checked, and the defaults for all others.
    pub fn choice(&self) -> Result<Choice, ChoiceError> {
        let mut choice = Choice::new(self.technique);
        self.settings.iter().try_for_each(|(key, value)| choice.set(key, value))?;
        Ok(choice)
    }

    /// Returns whether a vertex shader makes its volumes.
    pub(super) fn is_extruded(&self) -> bool {
        self.settings.contains(&("extruded-by", "vertex-shader"))
    }
}

impl fmt::Display for Entrant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.technique.name())?;
        self.settings.iter().try_for_each(|(key, value)| write!(f, " {key}={value}"))
    }
}

/// Returns the reason why a technique is expected to be right where no failure of it is known; for one that stress
/// cases don't compare, why not.
pub fn right_because(technique: Technique) -> &'static str {
    match technique.description().standing {
        ComparisonRole::Rival { right_because, .. } => right_because,
        ComparisonRole::Apart { because } => because,
    }
}

impl StressCase {
    /// Returns the stress case of that name; `None` where there is none.
    pub fn named(name: &str) -> Option<&'static StressCase> {
        cases::all().find(|case| case.name == name)
    }

    /// Returns whether a row at this value is quick and small enough to share a machine with other work.
    pub fn is_light(&self, value: f64) -> bool {
        self.heavy_above.is_none_or(|most| value <= most)
    }

    /// Returns the values for which [`is_light`](Self::is_light) is true: rows there are quick and small.
    pub fn light_values(&self) -> Vec<f64> {
        self.values.iter().copied().filter(|value| self.is_light(*value)).collect()
    }

    /// Returns the techniques that the case runs: the usual ones with their defaults, without those in
    /// [`StressCase::without`], then those of [`StressCase::also`].
    pub fn entrants(&self) -> Vec<Entrant> {
        let is_left_out = |technique: &Technique| self.without.iter().any(|(without, _)| without == technique);
        let usual = Technique::rivals().into_iter().filter(|technique| !is_left_out(technique)).map(Entrant::of);
        usual.chain(self.also.iter().copied()).collect()
    }

    /// Returns the case's scene at a value; the same one at every value where the case varies a setting.
    pub fn scene(&self, value: f64) -> Result<Scene, MeshError> {
        match self.drives {
            CaseNumber::Scene(scene) | CaseNumber::Motion(scene) => scene(value),
            CaseNumber::Setting(_, scene) => scene(),
        }
    }

    /// Returns a technique as this case runs it at a value: where the case varies a setting that the technique has,
    /// that setting has the value.
    pub fn choice(&self, entrant: &Entrant, value: f64) -> Result<Choice, ChoiceError> {
        let mut choice = entrant.choice()?;
        if let CaseNumber::Setting(key, _) = self.drives
            && choice.settings().contains_key(key)
        {
            choice.set(key, &value.to_string())?;
        }
        Ok(choice)
    }

    /// Returns how many frames of each row are timed, after a warm-up.
    pub fn timed_frames(&self) -> usize {
        if self.timed { TIMED_FRAMES } else { 1 }
    }

    /// Returns whether the case runs a technique at a value.
    pub fn runs(&self, entrant: &Entrant, value: f64) -> bool {
        self.up_to.iter().all(|(other, last, _)| other != entrant || value <= *last)
    }

    /// Returns the reason in one line why a technique fails in this case (that of its first known failure, at whatever
    /// value, or of its texels), else why it is expected to be right.
    pub fn because(&self, entrant: &Entrant) -> &'static str {
        let failure = self.failures.iter().find(|failure| failure.of == *entrant);
        let texels = || expect::texels(entrant.technique).map(|(_, because)| because);
        failure.map(|failure| failure.because).or_else(texels).unwrap_or(right_because(entrant.technique))
    }

    /// Returns what is expected of a technique at a value: its first known failure that applies there; else, for a
    /// technique with texels, that it may alias; else that it is right.
    pub fn expected_at(&self, entrant: &Entrant, value: f64) -> ExpectedResult {
        let failure = self.failures.iter().find(|failure| failure.of == *entrant && (failure.at)(value));
        match (failure, expect::texels(entrant.technique)) {
            (Some(failure), _) => failure.expected(),
            (None, Some((symptom, _))) => ExpectedResult::MayFail(symptom),
            (None, None) => ExpectedResult::Right,
        }
    }

    /// Returns what is expected of a technique at a value on an adapter that moves corners to multiples of `step` pixels
    /// without their depth; `None`: on one that does not.
    pub fn expected_on(&self, step: Option<f64>, entrant: &Entrant, value: f64) -> ExpectedResult {
        self.expected_at(entrant, value).on(step, entrant)
    }

    /// Returns what is expected of a technique over all values: the first failure that must show, else the first that
    /// may, else that it is right.
    pub fn expected(&self, entrant: &Entrant) -> ExpectedResult {
        let at = || self.values.iter().map(|value| self.expected_at(entrant, *value));
        let must = at().find(|expected| matches!(expected, ExpectedResult::Fails(_)));
        must.or_else(|| at().find(|expected| *expected != ExpectedResult::Right)).unwrap_or(ExpectedResult::Right)
    }
}
