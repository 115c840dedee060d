//! A diagnosis in words: where, which objects, why, the fix and how sure that is; last what to do.
//!
//! Regions and lights count from 1, pixels from 0 as in `pixel --at`.

use super::{
    Cause, CauseFound, Diagnosis, Fix, FixWithinTechnique, FlagFound, MeshFinding, Proof, RegionFound, RegionKind,
    TechniqueFit,
};
use crate::accuracy::Finding;
use crate::numbers;
use crate::technique::Technique;
use std::collections::BTreeSet;

/// The most places of a mesh finding that the text lists.
const MOST_PLACES: usize = 8;

impl Diagnosis {
    /// Returns the whole diagnosis as text, for a reader who does not know its terms. `suited` has the measured result
    /// of each candidate technique; empty where none was measured.
    pub fn to_text(&self, suited: &[TechniqueFit]) -> String {
        let mut out = self.heading();
        let mut explained = BTreeSet::new();
        for (index, region) in self.regions.iter().enumerate() {
            out += &format!("\n{}. {}\n", index + 1, region.place());
            let like = self.regions[..index].iter().position(|earlier| is_like(earlier, region));
            out += &like.map_or_else(|| self.causes(region, &mut explained), |like| as_before(region, like));
        }
        if self.rest.regions > 0 {
            let regions = counted(self.rest.regions as u64, "smaller region", "smaller regions");
            out += &format!("\nand {regions} of {}\n", pixels(self.rest.pixels));
        }
        if !self.mesh_findings.is_empty() {
            out += "\nmeshes, whether it shows here or not\n";
            self.mesh_findings.iter().for_each(|found| out += &mesh(found));
        }
        if !self.flags.is_empty() {
            out += "\nby the scene's own wish, so not wrong\n";
            self.flags.iter().for_each(|found| out += &flag(found));
        }
        out += &techniques(suited);
        out + &format!("\nwhat to do: {}\n", self.what_to_do(suited))
    }

    fn heading(&self) -> String {
        let [width, height] = self.size;
        let error = &self.error;
        let name = format!("{}, {}, {width}x{height}", self.scene, self.technique.name());
        let compared = numbers::count(error.compared);
        let excused = numbers::count(error.edge_band);
        let beside = [
            (RegionKind::TooDark, "darkened by more than their shadow"),
            (RegionKind::LitTwice, "lit more than once"),
            (RegionKind::PartlyDark, "lit, and darkened in part by the filter"),
            (RegionKind::Seam, "off by a share of the light where faces of a map meet"),
            (RegionKind::Swims, "right or wrong by chance, as the map swims"),
        ];
        let beside = beside.map(|(kind, what)| {
            let of_kind = self.regions.iter().filter(|region| region.kind == kind);
            let count: u64 = of_kind.map(|region| region.pixels).sum();
            if count > 0 { format!("; {} {what}", pixels(count)) } else { String::new() }
        });
        let beside = beside.concat();
        if error.compared == 0 && error.wrong() == 0 && beside.is_empty() {
            return format!("{name}: nothing was compared: no pixel shows a surface that faces a light\n");
        }
        if error.wrong() == 0 {
            return format!(
                "{name}: none of {compared} compared pixels is wrong{beside}; {excused} at edges excused\n"
            );
        }
        let kinds = [
            (error.missing_shadow, "lit that should be dark"),
            (error.false_shadow, "dark that should be lit"),
            (error.wrong_surface, "of another surface"),
        ];
        let kinds = kinds.iter().filter(|(count, _)| *count > 0);
        let kinds: Vec<String> = kinds.map(|(count, what)| format!("{} {what}", numbers::count(*count))).collect();
        format!(
            "{name}: {} of {compared} compared pixels are wrong ({}){beside}; {excused} at edges excused\n",
            numbers::count(error.wrong()),
            kinds.join(", "),
        )
    }

    fn causes(&self, region: &RegionFound, explained: &mut BTreeSet<Cause>) -> String {
        let mut out = String::new();
        let is_listed = |cause: &&CauseFound| cause.proof != Proof::NotIt;
        for found in region.causes.iter().filter(is_listed) {
            let staying =
                found.staying.as_ref().map_or_else(String::new, |FixWithinTechnique { fix, pixels_left, .. }| {
                    format!("; to {fix} leaves {} of {}", numbers::count(*pixels_left), numbers::count(region.pixels))
                });
            out += &format!("   {} ({}): {}{staying}\n", found.cause, found.proof.name(), found.evidence.sentence);
            if explained.insert(found.cause) {
                out += &format!("     {}\n", found.cause.meaning());
            }
            out += &format!("     {}\n", proof(found, region));
        }
        let ruled_out: Vec<&str> =
            region.causes.iter().filter(|cause| !is_listed(cause)).map(|found| found.cause.name()).collect();
        if !ruled_out.is_empty() {
            out += &format!("   ruled out by running their fixes: {}\n", ruled_out.join(", "));
        }
        if region.causes.is_empty() {
            let [x, y] = region.at;
            out += &match self.technique {
                Technique::None => format!("   {}\n", self.without_cause(region)),
                _ => format!(
                    "   {}; `pixel SCENE --at {x},{y}` tells how a pixel came about\n",
                    self.without_cause(region)
                ),
            };
        }
        out
    }

    /// Returns the advice that ends the diagnosis: the best fix found, its command-line options, and the best technique
    /// that has no wrong pixel. `suited` has the measured result of each candidate technique; empty where none was
    /// measured.
    pub fn what_to_do(&self, suited: &[TechniqueFit]) -> String {
        if !self.is_bad() {
            return "nothing: the shadows are right".to_owned();
        }
        let better = TechniqueFit::best(suited).filter(|_| !self.is_fixed());
        let better = better.map(|best| format!("`-t {}` has no wrong pixel here", best.name().replace(' ', " --set ")));
        match (&self.advice, better) {
            (Some(advice), better) => {
                let options = advice.fix.options();
                let run =
                    if options.is_empty() { String::new() } else { format!(" As options: `{}`.", options.join(" ")) };
                let better = better.map_or_else(String::new, |better| format!(" {better}."));
                format!("{}{run}{better}", advice.sentence)
            }
            (None, Some(better)) => format!("no single change fixes it, but {better}"),
            (None, None) => {
                "nothing that was tried helps; `pixel SCENE --at X,Y` tells how a pixel came about".to_owned()
            }
        }
    }
}

impl RegionFound {
    /// Returns a line that says what is wrong with which objects, at how many pixels, in which columns and rows
    /// (counted from 0), at which pixel for example, and for which light.
    pub fn place(&self) -> String {
        let [left, top, right, bottom] = self.bounds;
        let [x, y] = self.at;
        format!(
            "{}: {}, columns {left} to {right}, rows {top} to {bottom}, such as {x},{y}; {}",
            self.title(),
            pixels(self.pixels),
            numbers::light(self.light),
        )
    }

    /// Returns words for what is wrong with which objects: `missing shadow of bunny on floor`. Objects that are not
    /// known are left out, and a wrong surface names no caster.
    pub fn title(&self) -> String {
        let casters = names(&self.casters);
        let on = names(&self.receivers).map_or_else(String::new, |receivers| format!(" on {receivers}"));
        let of = casters.map_or_else(String::new, |casters| format!(" of {casters}"));
        match self.kind {
            RegionKind::Wrong(Finding::MissingShadow) => format!("missing shadow{of}{on}"),
            RegionKind::Wrong(Finding::FalseShadow) => format!("false shadow{of}{on}"),
            RegionKind::Wrong(_) => format!("wrong surface{on}"),
            RegionKind::TooDark => format!("shadow{of}{on} darker than it should be"),
            RegionKind::LitTwice => format!("light{on} added more than once"),
            RegionKind::PartlyDark => format!("light{on} darkened in part"),
            RegionKind::Seam => format!("light{on} broken off where faces of the map meet"),
            RegionKind::Swims => "edges of shadows that crawl as the eye moves".to_owned(),
        }
    }
}

impl RegionFound {
    /// Returns words for the pixels that are wrong here with a fix: `12 pixels stay wrong`, or, where more are than before,
    /// as others become wrong: `144 pixels are wrong here with it, 130 without`.
    pub fn left_words(&self, left: u64) -> String {
        match left > self.pixels {
            true => format!("{} are wrong here with it, {} without", pixels(left), numbers::count(self.pixels)),
            false => format!("{} {}", pixels(left), self.kind.of_those_left()),
        }
    }
}

impl Fix {
    /// Returns the changes that can be written on a command line as options: `-t z-fail`, `--set bias-slope=2`.
    pub fn options(&self) -> Vec<String> {
        let technique = self.technique.map(|technique| format!("-t {}", technique.name()));
        let settings = self.settings.iter().map(|(key, value)| format!("--set {key}={value}"));
        technique.into_iter().chain(settings).collect()
    }
}

/// Returns whether two regions have the same causes in the same order, with the same fixes and proofs; evidence and
/// numbers may differ. False where the first has no cause.
fn is_like(one: &RegionFound, other: &RegionFound) -> bool {
    let said = |region: &RegionFound| -> Vec<(Cause, Option<Fix>, Proof)> {
        region.causes.iter().map(|found| (found.cause, found.fix.clone(), found.proof)).collect()
    };
    !one.causes.is_empty() && said(one) == said(other)
}

/// Returns a line that refers to an earlier region for the causes, with this region's own evidence for the first of
/// them. `like` counts from 0, the text from 1.
fn as_before(region: &RegionFound, like: usize) -> String {
    let first = region.causes.first();
    let evidence = first.map_or_else(String::new, |found| format!(": {}: {}", found.cause, found.evidence.sentence));
    format!("   as {}{evidence}\n", like + 1)
}

/// Returns words for a cause's fix, with its command-line options where it has any, and for what running it has shown.
fn proof(
    CauseFound { evidence, fix, proof, pixels_left, whole_frame, .. }: &CauseFound,
    region: &RegionFound,
) -> String {
    let kind = region.kind;
    let Some(fix) = fix else { return "no fix to run".to_owned() };
    let options = fix.options();
    let options = if options.is_empty() { String::new() } else { format!(" (`{}`)", options.join(" ")) };
    let left = pixels_left.unwrap_or(0);
    let outcome = match proof {
        Proof::Proven => kind.none_left().to_owned(),
        Proof::Part if left == 0 => {
            let why_not =
                evidence.why_not().map_or_else(String::new, |why_not| format!(", which proves nothing: {why_not}"));
            format!("{}{why_not}", kind.none_left())
        }
        Proof::Part | Proof::NotIt if left > region.pixels => region.left_words(left),
        Proof::Part | Proof::NotIt => format!("{} of these {}", pixels(left), kind.of_those_left()),
        Proof::NotRun => "not run".to_owned(),
    };
    let worse = whole_frame.filter(|effect| effect.is_worse());
    let worse = worse.map_or_else(String::new, |effect| format!(", but the frame is worse: {}", effect.words()));
    format!("to fix it: {fix}{options}; run so, {outcome}{worse}")
}

fn mesh(MeshFinding { object, kind, count, at, effect }: &MeshFinding) -> String {
    let place = |point: &glam::DVec3| {
        let [x, y, z] = point.to_array().map(numbers::digits);
        format!("({x}, {y}, {z})")
    };
    let mut places: Vec<String> = at.iter().take(MOST_PLACES).map(place).collect();
    if at.len() > MOST_PLACES || (!at.is_empty() && *count > at.len()) {
        places.push("…".to_owned());
    }
    let places = if places.is_empty() { String::new() } else { format!("\n     at {}", places.join(" ")) };
    format!("   {object}: {}: {effect}{places}\n", kind.counted(*count))
}

fn flag(FlagFound { object, cause, pixels: changed, at, fix }: &FlagFound) -> String {
    let at = at.map_or_else(String::new, |[x, y]| format!(", such as {x},{y}"));
    format!("   {object}: {cause}: {} would change{at}; to do so, {fix}\n", pixels(*changed))
}

fn techniques(suited: &[TechniqueFit]) -> String {
    if suited.is_empty() {
        return String::new();
    }
    let right = suited.iter().filter(|one| one.wrong == 0);
    let right: Vec<String> =
        right.map(|one| format!("{} ({} ms)", one.name(), numbers::milliseconds(one.frame_ms))).collect();
    let wrong = suited.iter().filter(|one| one.wrong > 0);
    let wrong: Vec<String> = wrong.map(|one| format!("{} ({})", one.name(), numbers::count(one.wrong))).collect();
    let mut out = "\ntechniques on this scene, seen from here\n".to_owned();
    let list = |names: &[String]| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    out += &format!("   right, the fastest first: {}\n", list(&right));
    if !wrong.is_empty() {
        out += &format!("   with wrong pixels: {}\n", list(&wrong));
    }
    out
}

fn names(names: &[String]) -> Option<String> {
    match names {
        [] => None,
        [one] => Some(one.clone()),
        [first @ .., last] => Some(format!("{} and {last}", first.join(", "))),
    }
}

fn pixels(count: u64) -> String {
    counted(count, "pixel", "pixels")
}

fn counted(count: u64, one: &str, more: &str) -> String {
    format!("{} {}", numbers::count(count), if count == 1 { one } else { more })
}
