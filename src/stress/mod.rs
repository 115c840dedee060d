//! Stiff and extreme cases: every technique is driven until it breaks, and the robust ones must not.
//!
//! ```text
//! Case (scenes, a parameter, who is known to fail) ─► session ─► rows ─► Stress: verdicts, where it breaks
//!                                                                          └─► table, JSON, plot, tab
//! ```
//!
//! A case is data ([`cases`]): a scene for each value of one number, and for each technique what is
//! expected of it: to be right, or a failure by name. What is not said is expected to be right. A
//! failure that nobody expected is a bug; so is a known one that does not show, since then the lesson
//! or our knowledge is wrong.

pub mod cases;
mod json;
mod plot;
mod table;

pub use table::value_text;

use crate::accuracy::ErrorCounts;
use crate::capture::AdapterInfo;
use crate::scene::{MeshError, Scene};
use crate::technique::{Choice, ChoiceError, Technique};
use std::collections::BTreeMap;
use std::fmt;

/// Timed frames of each row where times are the point.
const TIMED_FRAMES: usize = 3;

/// A scene that one number makes harder and harder.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// On the command line.
    pub name: &'static str,
    /// What it shows, in one line.
    pub lesson: &'static str,
    /// The number that changes, with its unit.
    pub parameter: &'static str,
    /// From easy to extreme; a single extreme has one.
    pub values: &'static [f64],
    /// What the number changes.
    pub drives: Drives,
    /// Width and height of the picture, where these are the point.
    pub size: Option<[u32; 2]>,
    /// Its times are the point: every row is set up from nothing, and several frames are timed.
    pub timed: bool,
    /// Forms of techniques that run beside the usual ones.
    pub also: &'static [Entrant],
    /// Usual techniques that are left out, with the reason.
    pub without: &'static [(Technique, &'static str)],
    /// Who fails, how, and why; everyone else is expected to be right.
    pub failures: &'static [Failure],
}

/// What a case's number changes.
#[derive(Debug, Clone, Copy)]
pub enum Drives {
    /// The scene.
    Scene(fn(f64) -> Result<Scene, MeshError>),
    /// A setting, of the techniques that have it, in one scene.
    Setting(&'static str, fn() -> Result<Scene, MeshError>),
    /// The moments of a motion: what flips from one to the next, though it does not in truth, is
    /// counted too.
    Motion(fn(f64) -> Result<Scene, MeshError>),
}

/// A technique in one form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entrant {
    /// The technique.
    pub technique: Technique,
    /// Settings that are not its defaults.
    pub settings: &'static [(&'static str, &'static str)],
}

/// A failure that is known.
#[derive(Debug, Clone, Copy)]
pub struct Failure {
    /// Whose.
    pub of: Entrant,
    /// Its name, such as `near-plane`.
    pub name: &'static str,
    /// Why it must show.
    pub because: &'static str,
}

/// What is expected of a technique.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// No wrong pixel.
    Right,
    /// A failure of this name, at some value at least.
    Fails(&'static str),
}

/// What came of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Verdict {
    /// Nothing is wrong.
    Holds,
    /// What is wrong was known to be.
    FailsAsKnown,
    /// Nobody expected this.
    Unexpected,
}

impl Entrant {
    /// A technique with its defaults.
    #[must_use]
    pub const fn of(technique: Technique) -> Entrant {
        Entrant { technique, settings: &[] }
    }

    /// A technique with other settings.
    #[must_use]
    pub const fn with(technique: Technique, settings: &'static [(&'static str, &'static str)]) -> Entrant {
        Entrant { technique, settings }
    }

    /// As the session wants it.
    ///
    /// # Errors
    /// A setting that does not exist: a bug of the case.
    pub fn choice(&self) -> Result<Choice, ChoiceError> {
        let mut choice = Choice::new(self.technique);
        self.settings.iter().try_for_each(|(key, value)| choice.set(key, value))?;
        Ok(choice)
    }
}

impl fmt::Display for Entrant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.technique.name())?;
        self.settings.iter().try_for_each(|(key, value)| write!(f, " {key}={value}"))
    }
}

/// Techniques that run in every case unless it says otherwise. The ray-traced one is right by
/// definition, and none asks nothing.
pub const USUAL: [Technique; 7] = [
    Technique::ZFail,
    Technique::ZPass,
    Technique::ZPassPlus,
    Technique::ShadowMap,
    Technique::Planar,
    Technique::PlanarTexture,
    Technique::Projective,
];

/// Why a technique is expected to be right where no failure of it is known.
#[must_use]
pub const fn right_because(technique: Technique) -> &'static str {
    match technique {
        Technique::ZFail => "volumes are closed and counted from infinity, so neither eye nor near plane matters",
        Technique::ZPass => "the near plane cuts no volume, and the eye is in none",
        Technique::ZPassPlus => "what the near plane begins with is counted too, so the eye may be in a volume",
        Technique::ShadowMap => "its texels are finer than pixels here, and its bias is enough",
        Technique::Planar => "all that is darkened is flat, and casters are clipped to what lies between",
        Technique::PlanarTexture => "all that is darkened is flat, and no edge of a shadow is blurred by texels",
        Technique::Projective => "nothing darkens itself here, or stands between light and caster",
        Technique::RayTraced => "it is the truth",
        Technique::None => "there is nothing to darken",
    }
}

impl Case {
    /// The case of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Case> {
        cases::all().find(|case| case.name == name)
    }

    /// Who runs, in the order of the table.
    #[must_use]
    pub fn entrants(&self) -> Vec<Entrant> {
        let is_left_out = |technique: &Technique| self.without.iter().any(|(without, _)| without == technique);
        let usual = USUAL.into_iter().filter(|technique| !is_left_out(technique)).map(Entrant::of);
        usual.chain(self.also.iter().copied()).collect()
    }

    /// The scene of a value.
    ///
    /// # Errors
    /// A broken mesh: a bug of the case.
    pub fn scene(&self, value: f64) -> Result<Scene, MeshError> {
        match self.drives {
            Drives::Scene(scene) | Drives::Motion(scene) => scene(value),
            Drives::Setting(_, scene) => scene(),
        }
    }

    /// A technique as this case runs it at a value.
    ///
    /// # Errors
    /// A setting that does not exist: a bug of the case.
    pub fn choice(&self, entrant: &Entrant, value: f64) -> Result<Choice, ChoiceError> {
        let mut choice = entrant.choice()?;
        if let Drives::Setting(key, _) = self.drives
            && choice.settings().contains_key(key)
        {
            choice.set(key, &value.to_string())?;
        }
        Ok(choice)
    }

    /// How many frames of a row are timed, after a warm-up.
    #[must_use]
    pub fn timed_frames(&self) -> usize {
        if self.timed { TIMED_FRAMES } else { 1 }
    }

    /// Why that is expected of a technique, in one line.
    #[must_use]
    pub fn because(&self, entrant: &Entrant) -> &'static str {
        let failure = self.failures.iter().find(|failure| failure.of == *entrant);
        failure.map_or(right_because(entrant.technique), |failure| failure.because)
    }

    /// What is expected of a technique.
    #[must_use]
    pub fn expected(&self, entrant: &Entrant) -> Expected {
        let failure = self.failures.iter().find(|failure| failure.of == *entrant);
        failure.map_or(Expected::Right, |failure| Expected::Fails(failure.name))
    }
}

impl Expected {
    /// In JSON and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Expected::Right => "right",
            Expected::Fails(name) => name,
        }
    }

    /// Of one value: a technique that is known to fail need not do so at every one.
    #[must_use]
    pub fn judge(self, wrong: u64) -> Verdict {
        match (self, wrong) {
            (_, 0) => Verdict::Holds,
            (Expected::Right, _) => Verdict::Unexpected,
            (Expected::Fails(_), _) => Verdict::FailsAsKnown,
        }
    }
}

impl Verdict {
    /// In JSON and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::FailsAsKnown => "fails as known",
            Verdict::Unexpected => "unexpected",
        }
    }
}

/// One technique at one value of one case.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the case.
    pub case: &'static str,
    /// Name and value of its number.
    pub parameter: (&'static str, f64),
    /// The technique.
    pub entrant: Entrant,
    /// All settings.
    pub settings: BTreeMap<String, String>,
    /// Against the truth, summed over lights.
    pub error: ErrorCounts,
    /// Pixels that changed since the value before although the truth did not, and none beside them
    /// did; `None` where the case is no motion, and at its first value.
    pub flips: Option<u64>,
    /// What is expected of the technique in this case.
    pub expected: Expected,
    /// Wall time of a frame, ms: the median of [`Case::timed_frames`].
    pub frame_ms: f64,
    /// Planning, geometry, pipelines and uploads, ms. No geometry is kept from row to row; pipelines
    /// are, but not where times are the point.
    pub setup_ms: f64,
}

/// How a technique did in a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Name of the case.
    pub case: &'static str,
    /// The technique.
    pub entrant: Entrant,
    /// The first value with a wrong pixel; `None` where there is none.
    pub breaks_at: Option<f64>,
    /// Most wrong pixels at one value, of how many compared.
    pub worst: (u64, u64),
    /// Isolated flips over the whole motion.
    pub flips: Option<u64>,
    /// What is expected.
    pub expected: Expected,
    /// Of the whole.
    pub verdict: Verdict,
}

/// What was run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stress {
    /// Where.
    pub adapter: AdapterInfo,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Case by case, value by value, technique by technique.
    pub rows: Vec<Row>,
}

impl Stress {
    /// One entry a case and technique, in the order of the rows.
    #[must_use]
    pub fn summary(&self) -> Vec<Summary> {
        summary(&self.rows)
    }

    /// Is anything unexpected?
    #[must_use]
    pub fn is_unexpected(&self) -> bool {
        self.summary().iter().any(|summary| summary.verdict == Verdict::Unexpected)
    }
}

/// One entry a case and technique, in the order of the rows.
#[must_use]
pub fn summary(rows: &[Row]) -> Vec<Summary> {
    let mut summaries: Vec<Summary> = Vec::new();
    for row in rows {
        let of_row = |summary: &&mut Summary| summary.case == row.case && summary.entrant == row.entrant;
        let wrong = row.error.wrong();
        let known = summaries.iter_mut().find(of_row);
        let Some(summary) = known else {
            summaries.push(Summary {
                case: row.case,
                entrant: row.entrant,
                breaks_at: (wrong > 0).then_some(row.parameter.1),
                worst: (wrong, row.error.compared),
                flips: row.flips,
                expected: row.expected,
                verdict: Verdict::Holds,
            });
            continue;
        };
        if wrong > 0 {
            summary.breaks_at = summary.breaks_at.or(Some(row.parameter.1));
        }
        if wrong > summary.worst.0 {
            summary.worst = (wrong, row.error.compared);
        }
        summary.flips = match (summary.flips, row.flips) {
            (None, None) => None,
            (a, b) => Some(a.unwrap_or(0) + b.unwrap_or(0)),
        };
    }
    summaries.iter_mut().for_each(|summary| summary.verdict = summary.judged());
    summaries
}

impl Summary {
    fn judged(&self) -> Verdict {
        let flips = self.flips.unwrap_or(0);
        match (self.expected, self.breaks_at) {
            (Expected::Right, None) if flips == 0 => Verdict::Holds,
            (Expected::Fails(_), Some(_)) => Verdict::FailsAsKnown,
            _ => Verdict::Unexpected,
        }
    }
}
