//! What is wrong in another program's frame, and the proof: its own plan with one thing changed.
//!
//! ```text
//! FramePlan ─► suspicions: what its states and volumes say, in numbers, each with a changed plan
//!           ─► run again (`Session::diagnose_recorded`) ─► how many pixels are still wrong ─► proof
//! ```
//!
//! No rule looks at the program: what is known is what was drawn. The rules for shadow volumes are in `volumes.rs`, those
//! for shadow maps in `maps.rs`, whose changed plans `map_changes.rs` makes.

mod map_changes;
mod maps;
mod volumes;

pub use map_changes::{kept_faces, with_caster_in_map};

use super::evidence::Evidence;
use super::json::quantity;
use super::{Cause, Proof, TruthCoverage};
use crate::accuracy::{ErrorCounts, WrongRegion};
use crate::capture::{Capture, Image};
use crate::numbers;
use crate::plan::words;
use crate::plan::{FramePlan, LightId};
use crate::recorded::SeenSurfaces;
use crate::scene::Scene;
use serde_json::json;
use std::sync::Arc;

/// A rule that looks for one cause in another program's frame.
struct FrameRule {
    cause: Cause,
    /// What the cause is and what to do, in the other program's terms; `None` where [`Cause::meaning`] applies.
    meaning: Option<&'static str>,
    /// Causes whose fixes are contained in this one's: it is the cause only where it takes more away than they do.
    includes: &'static [Cause],
    /// Looks for evidence in the draws of a light: returns it in numbers, with the plan in which only this is changed.
    look: fn(&RecordedLight) -> Option<FrameFinding>,
}

/// Evidence of a cause, with the plan in which only this is changed.
struct FrameFinding {
    evidence: Evidence,
    fixed: FramePlan,
}

/// A light of another program's frame, of which causes are looked for.
#[derive(Debug, Clone, Copy)]
pub struct RecordedLight<'a> {
    /// The frame's draws.
    pub plan: &'a FramePlan,
    /// What they left.
    pub capture: &'a Capture,
    /// What it shows and what casts.
    pub scene: &'a Scene,
    /// The light.
    pub light: LightId,
    /// Its wrong pixels (column, row), but for those that are wrong only by the size of the shadow map's texels.
    pub wrong: &'a [[u32; 2]],
    /// The surfaces that its pixels show.
    pub seen: &'a SeenSurfaces,
}

/// Returns the rules for the causes that can be seen in raster states, volumes and maps. Other causes can't be found, as
/// scene and settings of the program are not known.
fn rules() -> impl Iterator<Item = &'static FrameRule> {
    volumes::RULES.iter().chain(&maps::RULES)
}

fn meaning(cause: Cause) -> &'static str {
    rules().find(|rule| rule.cause == cause).and_then(|rule| rule.meaning).unwrap_or(cause.meaning())
}

/// A cause that the data of another program's frame suggest.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSuspicion {
    /// The suspected cause.
    pub cause: Cause,
    /// The evidence, in numbers.
    pub evidence: Evidence,
    /// Causes whose fixes are contained in this one's.
    pub includes: &'static [Cause],
    /// The frame's plan with the cause removed.
    pub fixed: FramePlan,
}

/// A suspected cause, with the result of running the frame without it.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameCauseFound {
    /// The cause.
    pub cause: Cause,
    /// The light whose shadows it is about.
    pub light: LightId,
    /// The evidence, in numbers.
    pub evidence: Evidence,
    /// What the run without the cause has shown.
    pub proof: Proof,
    /// Number of the light's pixels that are still wrong without the cause; of acne, those that still need a bias.
    pub pixels_left: u64,
    /// Causes that were removed together with it; empty where it was tried alone.
    pub together_with: Vec<Cause>,
    /// The light's labels in the run without the cause, as in [`CapturedLight::shadow`](crate::capture::CapturedLight);
    /// `None` where that run has none.
    pub mask: Option<Arc<Image>>,
}

impl FrameCauseFound {
    /// Returns cause, light and proof in a line: `far-clip (light 1), part: 10 pixels left`.
    pub fn title(&self) -> String {
        let (names, light, proof) = (self.names(), self.light.name(), self.proof.name());
        format!("{names} ({light}), {proof}: {} pixels left", numbers::count(self.pixels_left))
    }

    /// Returns the names of the causes that were removed: `near-plane-cut and eye-in-volume`.
    pub fn names(&self) -> String {
        let all = std::iter::once(&self.cause).chain(&self.together_with);
        all.map(|cause| cause.name()).collect::<Vec<_>>().join(" and ")
    }

    /// Returns whether it is about other pixels than the wrong ones: those that the program draws dark although its map lights
    /// them, or would be dark if a surface were in the map.
    pub fn is_beside_wrong_pixels(&self) -> bool {
        matches!(self.cause, Cause::Acne | Cause::NotInMap)
    }

    /// Returns sentences, in one paragraph, that explain the cause and what to do, then the same for each cause that
    /// was removed together with it.
    pub fn meaning(&self) -> String {
        let all = std::iter::once(&self.cause).chain(&self.together_with);
        all.map(|cause| meaning(*cause)).collect::<Vec<_>>().join(" ")
    }
}

/// How wrong the shadows of one light are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LightError {
    /// Its error counts.
    pub error: ErrorCounts,
    /// Its largest wrong region.
    pub worst: Option<WrongRegion>,
    /// How many of the wrong pixels are wrong only by the size of the shadow map's texels: the faces that it keeps make the
    /// pixel right, and the middle of its texel what the map says. 0 for a light without a map.
    pub within_texel: u64,
    /// About how many pixels that the map lights are drawn darker than others beside them, as their texel stores their own
    /// surface as nearer, and the program's bias is too small: as many of all such pixels as of those that were examined.
    /// They are not among the wrong pixels, which are the map's own.
    pub acne: u64,
}

impl LightError {
    /// Returns the number of wrong pixels that are not wrong only by the size of texels.
    pub fn beyond_texels(&self) -> u64 {
        self.error.wrong() - self.within_texel
    }
}

/// The diagnosis of another program's frame: wrong pixels and their causes.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameDiagnosis {
    /// Name of the frame.
    pub scene: String,
    /// How much of it was compared, for each light; one for the picture where no light is known. A light of which
    /// [too little](TruthCoverage::is_too_little) was compared is called neither right nor wrong.
    pub coverage: Vec<TruthCoverage>,
    /// Why nothing is called right or wrong, in a sentence without a stop: there are no lights and no causes here then.
    /// `None` where enough was compared of a light.
    pub no_verdict: Option<String>,
    /// What the frame does with its stencil, a sentence for each kind of draw; only where there is no verdict.
    pub stencil_uses: Vec<String>,
    /// How wrong the shadows of each light are.
    pub lights: Vec<LightError>,
    /// Causes, the proven ones first.
    pub causes: Vec<FrameCauseFound>,
    /// Number of wrong pixels when the frame is run again unchanged; it should equal [`FrameDiagnosis::wrong`].
    pub wrong_again: u64,
    /// Names of surfaces at which no volume begins and which are in no map, and are assumed to cast no shadow.
    pub silent: Vec<String>,
    /// Names of casters that the picture does not show.
    pub unseen: Vec<String>,
}

impl FrameDiagnosis {
    /// Returns the number of wrong pixels of all lights.
    pub fn wrong(&self) -> u64 {
        self.lights.iter().map(|light| light.error.wrong()).sum()
    }

    /// Returns the number of pixels that are wrong, or drawn dark although their map lights them.
    pub fn wrong_or_dark(&self) -> u64 {
        self.wrong() + self.lights.iter().map(|light| light.acne).sum::<u64>()
    }

    /// Returns the first cause that is proven of a wrong or dark pixel.
    pub fn proven(&self) -> Option<&FrameCauseFound> {
        // What is not in the map may be meant to cast no shadow.
        self.causes.iter().find(|found| found.proof == Proof::Proven && found.cause != Cause::NotInMap)
    }

    /// Returns what was compared of each of several lights, a line each without a stop; empty for one light.
    pub fn of_lights(&self) -> Vec<String> {
        let line = |(index, one): (usize, &TruthCoverage)| {
            let verdict = match one.is_too_little() {
                true => format!("; no verdict: {}", one.why_too_little()),
                false => String::new(),
            };
            format!("{}: {}{verdict}", LightId(index).name(), one.in_words())
        };
        if self.coverage.len() < 2 { Vec::new() } else { self.coverage.iter().enumerate().map(line).collect() }
    }

    /// Returns the diagnosis as text for people: how much was compared, the wrong pixels, each light's largest region, whether a second run
    /// agrees, and the causes with their proofs.
    pub fn to_text(&self) -> String {
        let mut text = match self.coverage.as_slice() {
            [one] => format!("{}: {}\n", self.scene, one.in_words()),
            _ => format!("{}: {}\n", self.scene, numbers::counted(self.coverage.len() as u64, "light")),
        };
        self.of_lights().iter().for_each(|said| text += &format!("{said}\n"));
        if let Some(because) = &self.no_verdict {
            text += &format!("no verdict: {because}\n");
            self.stencil_uses.iter().for_each(|said| text += &format!("  {said}\n"));
            return text;
        }
        let error: ErrorCounts = self.lights.iter().map(|light| light.error).sum();
        text += &format!(
            "{} of {} pixels wrong against rays through its own triangles ({} false shadow, {} missing shadow); {} at \
             edges excused\n",
            numbers::count(error.wrong()),
            numbers::count(error.compared),
            error.false_shadow,
            error.missing_shadow,
            error.edge_band
        );
        for (index, light) in self.lights.iter().enumerate().filter(|(_, light)| light.acne > 0) {
            let (name, pixels) = (LightId(index).name(), numbers::count(light.acne));
            text += &format!("{name}: about {pixels} pixels are drawn dark that its map lights\n");
        }
        for (index, light) in self.lights.iter().enumerate() {
            let Some(worst) = &light.worst else { continue };
            let [left, top, right, bottom] = worst.bounds;
            let beside = match light.within_texel {
                0 => String::new(),
                pixels => format!(", {} of them only by the size of the map's texels", numbers::count(pixels)),
            };
            text += &format!(
                "{}: {} wrong{beside}; the largest region: {} pixels of {} from {left},{top} to {right},{bottom}\n",
                LightId(index).name(),
                numbers::count(light.error.wrong()),
                numbers::count(worst.pixels),
                worst.kind.name().replace('_', " "),
            );
        }
        if self.wrong_again != self.wrong() {
            text += &format!("run again as it is, {} pixels are wrong\n", numbers::count(self.wrong_again));
        }
        let (helping, others): (Vec<_>, Vec<_>) = self.causes.iter().partition(|found| found.proof != Proof::NotIt);
        for found in &helping {
            text += &format!("\n{}\n  {}\n  {}\n", found.title(), found.evidence.sentence, found.meaning());
        }
        let is_joined = |one: &FrameCauseFound| {
            helping.iter().any(|found| found.light == one.light && found.together_with.contains(&one.cause))
        };
        let names: Vec<&str> =
            others.iter().filter(|found| !is_joined(found)).map(|found| found.cause.name()).collect();
        if self.wrong() > 0 && !names.is_empty() {
            text += &format!("\ntried, and not it: {}\n", names.join(", "));
        }
        let explains = |found: &FrameCauseFound| found.proof != Proof::NotIt && !found.is_beside_wrong_pixels();
        let beyond_texels = self.lights.iter().map(LightError::beyond_texels).sum::<u64>();
        if beyond_texels > 0 && !self.causes.iter().any(explains) {
            text += "no known cause fits\n";
        }
        let said = |text: &mut String, names: &[String], what: &str| {
            if !names.is_empty() {
                *text += &format!("\n{what}: {}\n", names.join(", "));
            }
        };
        said(&mut text, &self.silent, "taken to cast no shadow, as no volume begins there and no map has it");
        said(&mut text, &self.unseen, "out of view, and known by its volume or its map alone");
        text
    }

    /// Returns the diagnosis as JSON in the form of `diagnose --json` of a scene: with one region for each light that
    /// has wrong pixels, no casters, receivers or fixes.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let error: ErrorCounts = self.lights.iter().map(|light| light.error).sum();
        let cause = |found: &FrameCauseFound| {
            json!({
                "cause": found.cause.name(),
                "light": found.light.0,
                "meaning": found.meaning(),
                "evidence": found.evidence.sentence,
                "evidence_holds": found.evidence.holds(),
                "measured": found.evidence.quantities.iter().map(quantity).collect::<Vec<_>>(),
                "mend": null,
                "proof": found.proof.name(),
                "pixels_left": found.pixels_left,
                "together_with": found.together_with,
            })
        };
        let region = |(index, light): (usize, &LightError)| {
            let (error, worst) = (light.error, light.worst.as_ref()?);
            let is_of_region = |found: &&FrameCauseFound| found.light.0 == index && !found.is_beside_wrong_pixels();
            let of_light = self.causes.iter().filter(is_of_region);
            Some(json!({
                "pixels": error.wrong(),
                "within_texel": light.within_texel,
                "kind": worst.kind.name(),
                "light": index,
                "box": worst.bounds,
                "at": worst.at,
                "casters": [],
                "receivers": [],
                "causes": of_light.map(cause).collect::<Vec<_>>(),
            }))
        };
        let verdict = match self.wrong_or_dark() {
            _ if self.no_verdict.is_some() => None,
            0 => Some("right"),
            _ => Some("wrong"),
        };
        let coverage = |one: &TruthCoverage| {
            let reasons = one.reasons().into_iter().map(|(because, pixels)| (because.name().to_owned(), json!(pixels)));
            json!({
                "pixels": one.pixels,
                "compared": one.compared,
                "not_compared": reasons.collect::<serde_json::Map<_, _>>(),
                "is_enough": !one.is_too_little(),
            })
        };
        let document = json!({
            "schema": 1,
            "scene": self.scene,
            "verdict": verdict,
            "no_verdict": self.no_verdict,
            "coverage": self.coverage.iter().map(coverage).collect::<Vec<_>>(),
            "stencil_uses": self.stencil_uses,
            "technique": "recorded",
            "settings": {},
            "error": error,
            "mesh_findings": [],
            "acne": self.lights.iter().map(|light| light.acne).collect::<Vec<_>>(),
            "findings": self.causes.iter().filter(|found| found.is_beside_wrong_pixels()).map(cause).collect::<Vec<_>>(),
            "regions": self.lights.iter().enumerate().filter_map(region).collect::<Vec<_>>(),
        });
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}

/// Returns what a frame does with its stencil, what marks and what tests: a sentence for each stencil state of draws into
/// its picture, with how many draws have it.
pub fn stencil_uses(plan: &FramePlan) -> Vec<String> {
    let mut uses: Vec<(Vec<String>, usize)> = Vec::new();
    for pass in plan.passes.iter().filter(|pass| plan.is_of_picture(pass)) {
        for draw in pass.draws.iter().filter(|draw| draw.raster.stencil.is_enabled()) {
            let said = words::stencil_sentences(&draw.raster);
            match uses.iter_mut().find(|(known, _)| *known == said) {
                Some((_, count)) => *count += 1,
                None => uses.push((said, 1)),
            }
        }
    }
    if uses.is_empty() {
        return vec!["no draw that is followed uses the stencil".to_owned()];
    }
    uses.into_iter()
        .map(|(said, count)| format!("{}: {}", numbers::counted(count as u64, "draw"), said.join(" ")))
        .collect()
}

/// Returns the causes of a light's wrong pixels for which states, volumes and maps give evidence.
pub fn suspicions(light: &RecordedLight) -> Vec<FrameSuspicion> {
    rules().filter_map(|rule| suspicion(rule.cause, light)).collect()
}

/// Looks for evidence of one cause in a light's passes, and returns it with the plan in which that is corrected. `None`
/// without evidence, or where no rule looks for this cause.
pub fn suspicion(cause: Cause, light: &RecordedLight) -> Option<FrameSuspicion> {
    let rule = rules().find(|rule| rule.cause == cause)?;
    let FrameFinding { evidence, fixed } = (rule.look)(light)?;
    Some(FrameSuspicion { cause, evidence, includes: rule.includes, fixed })
}
