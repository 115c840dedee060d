//! Why shadows are wrong, and the proof.
//!
//! ```text
//! truth, capture ─► wrong regions ─► rules ─► causes with evidence ─► fix, run again ─► proof
//! ```
//!
//! Wrong pixels are grouped into connected regions. Every [`Cause`] has a rule that looks for its evidence in numbers:
//! in the scene, in the plan as it was run, and in what the GPU left. Each cause that fits is fixed, and the frame is
//! run again (`Session::diagnose`): only a cause whose evidence holds in numbers ([`Evidence::holds`]), and whose fix
//! takes the wrong pixels away, is called proven. No rule knows how a fault was caused.

mod cause;
mod coverage;
mod error_picture;
mod evidence;
mod eye_count;
pub(crate) mod facts;
mod fix;
pub mod frame_causes;
mod json;
pub(crate) mod mesh_facts;
pub(crate) mod proof;
pub(crate) mod regions;
pub(crate) mod rules;
mod suited;
mod text;

pub use cause::Cause;
pub use coverage::{NotCompared, TruthCoverage};
pub use error_picture::wrong_pixels;
pub use evidence::{Evidence, Quantity, Threshold};
pub use fix::{Fix, FixError, ObjectChange, PlanEdit, SceneEdit};
pub use suited::TechniqueFit;

use crate::accuracy::{ErrorCounts, Finding};
use crate::numbers;
use crate::scene::Unsupported;
use crate::technique::Technique;
use glam::DVec3;
use proof::WrongCount;
use std::collections::BTreeMap;

/// The diagnosis of one frame: regions of wrong pixels, their causes, and advice.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// Name of the scene.
    pub scene: String,
    /// The technique that was asked for.
    pub technique: Technique,
    /// Its settings, defaults included.
    pub settings: BTreeMap<String, String>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Numbers of wrong pixels, summed over the lights.
    pub error: ErrorCounts,
    /// Defects of the meshes, whether they show in this frame or not.
    pub mesh_findings: Vec<MeshFinding>,
    /// Shadows and surfaces that the scene's own flags remove. The truth honours the flags, so these are not wrong
    /// pixels.
    pub flags: Vec<FlagFound>,
    /// Wrong regions, the largest first; usually at most [`Diagnosis::MOST_REGIONS`].
    pub regions: Vec<RegionFound>,
    /// The smaller regions that are not listed.
    pub rest: RemainingRegions,
    /// The best fix found; `None` where nothing is wrong or nothing helps.
    pub advice: Option<Advice>,
    /// What the scene's files ask for and neither the frame nor the truth shows.
    pub left_out_of_files: Vec<Unsupported>,
}

impl Diagnosis {
    /// The most regions that a diagnosis usually lists one by one, with causes; the others are only counted
    /// ([`Diagnosis::rest`]).
    pub const MOST_REGIONS: usize = 12;

    /// Returns words for a region without a cause: that no shadows were asked for, where shadows are missing and the
    /// technique is `none`; else that no known cause fits.
    pub fn without_cause(&self, region: &RegionFound) -> &'static str {
        let is_missing = region.kind == RegionKind::Wrong(Finding::MissingShadow);
        match self.technique {
            Technique::None if is_missing => "no shadows were asked for: the technique is none",
            _ => "no known cause fits",
        }
    }

    /// Returns whether any pixel is wrong, or darkened twice.
    pub fn is_bad(&self) -> bool {
        !self.regions.is_empty()
    }
}

/// Numbers of regions that are not listed one by one, and of their pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RemainingRegions {
    /// The number of regions.
    pub regions: usize,
    /// The number of their wrong pixels.
    pub pixels: u64,
}

/// A connected region of wrong pixels of one light, with one kind of fault, caster and receiver.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionFound {
    /// The number of pixels.
    pub pixels: u64,
    /// The way in which they are wrong.
    pub kind: RegionKind,
    /// Index of the light.
    pub light: usize,
    /// First and last column and row: left, top, right, bottom.
    pub bounds: [u32; 4],
    /// One of its pixels (column, row), as far inside as possible.
    pub at: [u32; 2],
    /// Names of the objects whose shadow is missing, or which cast it falsely, as far as is known.
    pub casters: Vec<String>,
    /// Names of the objects that are visible there.
    pub receivers: Vec<String>,
    /// Causes, the most likely first.
    pub causes: Vec<CauseFound>,
}

/// The way in which a region's pixels are wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RegionKind {
    /// Their labels differ from the truth's.
    Wrong(Finding),
    /// They are in shadow, and rightly so, but darkened by more than that.
    TooDark,
    /// They are lit, and rightly so, but more than once.
    LitTwice,
    /// They are lit, and rightly so, but a filter darkens them in part where no shadow is near.
    PartlyDark,
    /// Their share of the light is off where two faces of a map meet.
    Seam,
    /// They are right or wrong by chance: a map that follows the view gives them another label as the eye moves.
    Swims,
}

impl RegionKind {
    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            RegionKind::Wrong(finding) => finding.name(),
            RegionKind::TooDark => "too_dark",
            RegionKind::LitTwice => "lit_twice",
            RegionKind::PartlyDark => "partly_dark",
            RegionKind::Seam => "seam",
            RegionKind::Swims => "swims",
        }
    }

    /// What pixels do that a fix leaves as they are: `stay wrong`.
    pub fn of_those_left(self) -> &'static str {
        if self == RegionKind::Swims { "still swim" } else { "stay wrong" }
    }

    /// Says that a fix leaves no pixel as it is.
    fn none_left(self) -> &'static str {
        match self {
            RegionKind::Swims => "none of these pixels swims any more",
            _ => "none of these pixels is wrong any more",
        }
    }
}

/// A cause that may explain a region's wrong pixels, with its evidence, its fix and what running the frame with that
/// fix has shown.
#[derive(Debug, Clone, PartialEq)]
pub struct CauseFound {
    /// The cause.
    pub cause: Cause,
    /// What was measured, and whether it carries the cause's name.
    pub evidence: Evidence,
    /// The fix; `None` where nothing helps.
    pub fix: Option<Fix>,
    /// What running the frame with the fix has shown.
    pub proof: Proof,
    /// Number of pixels wrong with the fix: those left in the region, and new ones in its bounding box. `None` where it
    /// was not run.
    pub pixels_left: Option<u64>,
    /// What the fix does to the whole frame, as the same run has shown; `None` where only the region was drawn.
    pub whole_frame: Option<FrameEffect>,
    /// Where the fix is another technique: what fixes most of it without changing the technique.
    pub staying: Option<FixWithinTechnique>,
    /// Causes without whose fixes, applied at the same time, this one proves nothing; mostly none.
    pub together_with: Vec<Cause>,
}

/// A fix that keeps the technique, with its result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FixWithinTechnique {
    /// Changes of settings and scene.
    pub fix: Fix,
    /// Number of wrong pixels that it leaves.
    pub pixels_left: u64,
    /// What it does to the whole frame; `None` where only the region was drawn.
    pub whole_frame: Option<FrameEffect>,
}

/// How many pixels of the whole frame are wrong without a fix and with it, summed over the lights; those that a map makes
/// right or wrong by chance count too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameEffect {
    /// Without the fix.
    pub before: u64,
    /// With it.
    pub after: u64,
}

impl FrameEffect {
    /// Returns whether the frame has more wrong pixels with the fix than without it.
    pub fn is_worse(self) -> bool {
        self.after > self.before
    }

    /// Describes it in a few words: `whole frame: 709 wrong pixels without it, 0 with it`.
    pub fn words(self) -> String {
        let [before, after] = [self.before, self.after].map(numbers::count);
        let pixels = if self.before == 1 { "pixel" } else { "pixels" };
        format!("whole frame: {before} wrong {pixels} without it, {after} with it")
    }
}

named_enum! {
    /// What running the frame with a fix has shown about a suspected cause.
    pub enum Proof {
        /// The evidence holds, and no pixel of the region is wrong any more.
        Proven = "proven",
        /// Some of the region's pixels are right now; or all of them, but the evidence does not hold.
        Part = "part",
        /// None of the region's pixels is right now.
        NotIt = "not it",
        /// No fix could be run.
        NotRun = "not run",
    }
}

/// A defect of an object's mesh, found before any pixel is examined.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFinding {
    /// Name of the object.
    pub object: String,
    /// The defect.
    pub kind: MeshDefect,
    /// How often it occurs.
    pub count: usize,
    /// The first places where it occurs, world space, metres.
    pub at: Vec<DVec3>,
    /// What it does to which technique, and what to do, in a sentence.
    pub effect: String,
}

/// A kind of defect of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MeshDefect {
    /// It breaks techniques in a known way.
    Cause(Cause),
    /// Triangles whose corners lie on a line.
    FlatTriangles,
    /// Triangles that loading left out, because two of their corners were equal.
    DroppedTriangles,
    /// Triangles with the same corners as another.
    DuplicateTriangles,
    /// Triangles a thousand times longer than high.
    Slivers,
}

impl MeshDefect {
    /// Its name in JSON and text.
    pub fn name(self) -> &'static str {
        match self {
            MeshDefect::Cause(cause) => cause.name(),
            MeshDefect::FlatTriangles => "flat-triangles",
            MeshDefect::DroppedTriangles => "dropped-triangles",
            MeshDefect::DuplicateTriangles => "duplicate-triangles",
            MeshDefect::Slivers => "slivers",
        }
    }

    /// Returns how often a mesh has it, in words: `open-mesh (16)`, `3 flat triangles`.
    pub fn counted(self, count: usize) -> String {
        let count = numbers::count(count as u64);
        match self {
            MeshDefect::Cause(cause) => format!("{} ({count})", cause.name()),
            other => format!("{count} {}", other.name().replace('-', " ")),
        }
    }
}

/// A flag of an object in the scene that removes a shadow or a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct FlagFound {
    /// Name of the object.
    pub object: String,
    /// [`Cause::NotReceiving`], [`Cause::NotCasting`] or [`Cause::Undrawn`].
    pub cause: Cause,
    /// Pixels of the truth that would change if it were set, summed over the lights.
    pub pixels: u64,
    /// One of these pixels; `None` where there is none.
    pub at: Option<[u32; 2]>,
    /// Sets the flag.
    pub fix: Fix,
}

/// The advice for the whole frame: the fix, its result, and a sentence.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// All changes, to be applied at once.
    pub fix: Fix,
    /// Wrong pixels that were left when it was run, summed over the lights.
    pub wrong_left: u64,
    /// Pixels that a map that follows the view still made right or wrong by chance, summed over the lights.
    pub swimming_left: u64,
    /// The advice in a sentence.
    pub sentence: String,
    /// Where another technique is advised: what to change without changing the technique.
    pub staying: Option<FixWithinTechnique>,
}

impl Advice {
    /// Makes the advice to apply `fix`, which leaves so many pixels wrong, of so many `now`.
    pub(crate) fn new(fix: &Fix, left: WrongCount, now: WrongCount) -> Advice {
        let of = match now.swimming {
            0 => numbers::count(now.wrong),
            swimming => format!("{} and {}", numbers::count(now.wrong), numbers::count(swimming)),
        };
        let sentence = format!("To fix it, {fix}: {}, of {of} now.", outcome(left, now));
        Advice { fix: fix.clone(), wrong_left: left.wrong, swimming_left: left.swimming, sentence, staying: None }
    }

    /// Returns the fixes that it offers: its own, and the one that stays with the technique.
    pub fn fixes(&self) -> impl Iterator<Item = &Fix> {
        std::iter::once(&self.fix).chain(self.staying.as_ref().map(|staying| &staying.fix))
    }

    /// Where another technique is advised, adds what to change without changing the technique, and how many pixels that
    /// leaves wrong.
    pub(crate) fn or_staying(
        mut self,
        technique: Technique,
        staying: Option<(&Fix, WrongCount)>,
        now: WrongCount,
    ) -> Advice {
        if let (Some(_), Some((fix, left))) = (self.fix.technique, staying) {
            self.sentence += &format!(" To stay with {}, {fix}: {}.", technique.name(), outcome(left, now));
            self.staying = Some(FixWithinTechnique {
                fix: fix.clone(),
                pixels_left: left.wrong,
                whole_frame: Some(FrameEffect { before: now.all(), after: left.all() }),
            });
        }
        self
    }
}

/// Returns words for how many pixels a fix leaves wrong, and where some swim `now`, how many of them.
fn outcome(left: WrongCount, now: WrongCount) -> String {
    let wrong = match left.wrong {
        0 => "then no pixel is wrong".to_owned(),
        1 => "then 1 pixel is wrong".to_owned(),
        left => format!("then {} pixels are wrong", numbers::count(left)),
    };
    match (now.swimming, left.swimming) {
        (0, _) => wrong,
        (_, 0) => format!("{wrong} and none swims"),
        (_, 1) => format!("{wrong} and 1 swims"),
        (_, left) => format!("{wrong} and {} swim", numbers::count(left)),
    }
}
