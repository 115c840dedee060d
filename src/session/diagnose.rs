//! Why a frame is wrong: runs it, asks the rules, and runs it again with each mend.

use super::truth::Traced;
use super::{CaptureRequest, Fault, Session, SessionError};
use crate::accuracy::{ErrorCounts, Finding};
use crate::capture::Capture;
use crate::diagnosis::facts::{Case, Facts, Sample, Suspicion};
use crate::diagnosis::mesh_facts::MeshFacts;
use crate::diagnosis::proof::{Tried, Wrong, judge, ranked};
use crate::diagnosis::regions::{self, Key, Region};
use crate::diagnosis::rules::{self, map, planar, projective};
use crate::diagnosis::{
    Advice, Cause, CauseFound, Diagnosis, FlagFound, Mend, ObjectChange, Proof, RegionFound, RegionKind, Rest,
};
use crate::geometry::light_frame;
use crate::plan::{FramePlan, Part};
use crate::progress::Progress;
use crate::scene::{Light, Object, Scene};
use crate::technique::{self, Choice, Job, Technique};
use crate::truth::Tracer;
use glam::{DVec3, DVec4};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Pixels of a region that are looked at closely.
const SAMPLES: usize = 3;
/// Objects whose flags are asked about; each costs a truth.
const MOST_FLAGS: usize = 8;
/// Objects of more triangles are taken to darken something without looking, as floors are small.
const MOST_TRIANGLES_TO_LOOK_AT: usize = 256;
/// Mends that are tried at once, for regions that none of them clears alone.
const MOST_TOGETHER: usize = 3;

/// A frame that was run.
struct Run {
    scene: Scene,
    choice: Choice,
    plan: FramePlan,
    capture: Capture,
    /// By light: a [`Finding`] a pixel.
    findings: Vec<Vec<u8>>,
    /// By light: pixels that were darkened twice.
    too_dark: Vec<Vec<usize>>,
    error: ErrorCounts,
    wrong: Wrong,
}

/// The runs of mends so far; what can't run is kept with the reason.
struct Runs<'a> {
    scene: &'a Scene,
    request: &'a CaptureRequest,
    fault: Fault<'a>,
    traced: &'a Traced,
    progress: &'a Progress,
    done: Vec<(Mend, Result<Wrong, String>)>,
}

impl Session {
    /// Says where a frame is wrong, why, and what mends it, which it proves by running that. `fault` is made in
    /// the frame and not in its truth, and nothing but that tells of it; [`Fault::None`] for scenes as they are.
    ///
    /// # Errors
    /// A scene that can't be drawn or traced, a lost GPU; [`SessionError::Cancelled`]. A mend that can't run is no
    /// error: its proof says `not run`.
    pub fn diagnose(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: Fault,
        progress: &Progress,
    ) -> Result<Diagnosis, SessionError> {
        let traced = self.traced(scene, request.size, progress)?;
        let run = self.run_mended(scene, request, fault, &Mend::default(), &traced)?;
        let meshes = self.mesh_facts(&run.scene);
        let size = request.size;
        let facts = Facts {
            scene: &run.scene,
            choice: &run.choice,
            plan: &run.plan,
            capture: &run.capture,
            tracer: &traced.tracer,
            meshes: &meshes,
        };
        let mut found = wrong_regions(&facts, &run);
        let told = found.len().min(Diagnosis::MOST_REGIONS);
        let rest = &found[told..];
        let rest = Rest { regions: rest.len(), pixels: rest.iter().map(|region| region.pixels.len() as u64).sum() };
        found.truncate(told);
        progress.start(found.len() + 1);
        let mut runs = Runs { scene, request, fault, traced: &traced, progress, done: Vec::new() };
        let mut told = Vec::new();
        for region in &found {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            let case = self.case(&facts, region)?;
            let suspicions = rules::suspicions(&facts, &case);
            let causes = self.proven(&mut runs, region, &run.wrong, suspicions)?;
            told.push(described(&facts, &case, causes, size));
            progress.advance();
        }
        let advice = self.advice(&mut runs, &told, &run)?;
        let lights: Vec<_> = run.scene.lights.iter().map(Light::homogeneous).collect();
        Ok(Diagnosis {
            scene: scene.name.clone(),
            technique: request.choice.technique(),
            settings: request.choice.settings().clone(),
            size,
            error: run.error,
            // How the mesh of what darkens nothing hangs together is no matter.
            mesh_findings: darkening(&run.scene, &lights)
                .into_iter()
                .zip(&meshes)
                .filter(|(darkens, _)| *darkens)
                .flat_map(|(_, mesh)| mesh.findings(&lights))
                .collect(),
            flags: flags(scene, &traced, progress)?,
            regions: told,
            rest,
            advice,
        })
    }

    /// The frame with a mend made, and the plan that left it: to show before and after.
    ///
    /// # Errors
    /// A mend that can't be made, a scene that can't be drawn, a lost GPU.
    pub fn capture_mended(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: Fault,
        mend: &Mend,
    ) -> Result<(Capture, FramePlan), SessionError> {
        let (scene, _, plan) = self.plan_mended(scene, request, fault, mend)?;
        Ok((self.capture_plan(&scene, &plan)?, plan))
    }

    /// The fault first, then the mend: what is wrong stays wrong but where the mend changes it.
    fn plan_mended(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: Fault,
        mend: &Mend,
    ) -> Result<(Scene, Choice, FramePlan), SessionError> {
        let (given, mut choice) = fault.applied(scene, &request.choice);
        let mut given = given.into_owned();
        mend.apply(&mut given, &mut choice)?;
        let job = Job { scene: &given, size: request.size, choice: &choice, cache: &mut self.geometry };
        let fresh = technique::plan(job)?;
        let mut plan = fresh.clone();
        if let Fault::Plan(change) = fault {
            change(&mut plan);
        }
        mend.edit(&mut plan, &fresh);
        Ok((given, choice, plan))
    }

    fn run_mended(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: Fault,
        mend: &Mend,
        traced: &Traced,
    ) -> Result<Run, SessionError> {
        let (scene, choice, plan) = self.plan_mended(scene, request, fault, mend)?;
        let capture = self.capture_plan(&scene, &plan)?;
        let pixels = request.size[0] as usize * request.size[1] as usize;
        let (mut findings, mut too_dark, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
        let mut error = ErrorCounts::default();
        for (light, captured) in capture.lights.iter().enumerate() {
            let of_light = match &captured.shadow {
                Some(labels) => {
                    let accuracy = traced.compare(light, labels);
                    error = [error, accuracy.counts].into_iter().sum();
                    accuracy.findings
                }
                None => vec![Finding::NotCompared as u8; pixels],
            };
            let is_wrong = |byte: &u8| Finding::from_byte(*byte).is_some_and(Finding::is_wrong);
            let mut is_wrong: Vec<bool> = of_light.iter().map(is_wrong).collect();
            let dark: Vec<usize> = planar::too_dark(&plan, &capture, light);
            let dark: Vec<usize> = dark.into_iter().filter(|index| of_light[*index] == Finding::Agrees as u8).collect();
            dark.iter().for_each(|index| is_wrong[*index] = true);
            findings.push(of_light);
            too_dark.push(dark);
            wrong.push(is_wrong);
        }
        Ok(Run { scene, choice, plan, capture, findings, too_dark, error, wrong: Wrong { lights: wrong } })
    }

    fn mesh_facts(&mut self, scene: &Scene) -> Vec<MeshFacts> {
        let one = |object: &Object| {
            let edges = self.geometry.edges(&object.mesh);
            MeshFacts::new(object, &edges, &self.geometry.topology(&object.mesh))
        };
        scene.objects.iter().map(one).collect()
    }

    /// A close look at some of a region's pixels.
    fn case<'r>(&mut self, facts: &Facts, region: &'r Region) -> Result<Case<'r>, SessionError> {
        let light = region.light;
        let has_events = facts.counts_volumes(light) || facts.draws(light, Part::PlanarShadow).next().is_some();
        let mut samples = Vec::new();
        for pixel in region.samples(facts.plan.size, SAMPLES) {
            let history = match has_events {
                true => Some(self.history(facts.plan, facts.capture, pixel)?),
                false => None,
            };
            let seen = facts.tracer.seen_at(pixel.map(|n| f64::from(n) + 0.5));
            let between = seen.map_or_else(Vec::new, |seen| facts.tracer.between(light, &seen));
            samples.push(Sample { pixel, seen, between, history });
        }
        Ok(Case { region, samples })
    }

    /// Each suspicion with what its mends have shown, the most likely first.
    fn proven(
        &mut self,
        runs: &mut Runs,
        region: &Region,
        before: &Wrong,
        suspicions: Vec<Suspicion>,
    ) -> Result<Vec<CauseFound>, SessionError> {
        let size = runs.request.size;
        let mut tried = Vec::new();
        for mut suspicion in suspicions {
            let mut best: Option<(Mend, Proof, u64)> = None;
            let mut small: Option<(Mend, u64)> = None;
            for mend in std::mem::take(&mut suspicion.mends) {
                let (proof, left) = match self.run_once(runs, &mend)? {
                    Ok(after) => judge(region, before, &after, size),
                    Err(because) => {
                        suspicion.evidence.push_str(&format!(" ({mend} can't be run: {because})"));
                        continue;
                    }
                };
                if best.as_ref().is_none_or(|(_, of_best, least)| (proof, left) < (*of_best, *least)) {
                    best = Some((mend.clone(), proof, left));
                }
                if proof == Proof::Proven {
                    break;
                }
                let is_smaller = mend.technique.is_none() && proof == Proof::Part;
                if is_smaller && small.as_ref().is_none_or(|(_, least)| left < *least) {
                    small = Some((mend, left));
                }
            }
            // What another technique mends wholly, this one may mend nearly.
            if let (Some((mend, left)), Some((best, ..))) = (small, &best)
                && best.technique.is_some()
            {
                suspicion.evidence.push_str(&format!("; to {mend} leaves {left} of {}", region.pixels.len()));
            }
            let (mend, proof, left) = match best {
                Some((mend, proof, left)) => (Some(mend), proof, Some(left)),
                None => (None, Proof::NotRun, None),
            };
            tried.push(Tried { suspicion, mend, proof, left, together_with: Vec::new() });
        }
        if !tried.iter().any(|one| one.proof == Proof::Proven) {
            self.try_together(runs, region, before, &mut tried)?;
        }
        Ok(ranked(tried))
    }

    /// Several causes may be at work at once: then their mends prove something only together.
    fn try_together(
        &mut self,
        runs: &mut Runs,
        region: &Region,
        before: &Wrong,
        tried: &mut [Tried],
    ) -> Result<(), SessionError> {
        let helps = |one: &&Tried| one.proof == Proof::Part;
        let least = if tried.iter().filter(helps).count() > 1 { Proof::Part } else { Proof::NotIt };
        let mut members: Vec<usize> =
            (0..tried.len()).filter(|index| tried[*index].mend.is_some() && tried[*index].proof <= least).collect();
        members.sort_by_key(|index| (tried[*index].proof, tried[*index].left));
        members.truncate(MOST_TOGETHER);
        let mend_of = |index: &usize| tried[*index].mend.clone().unwrap_or_default();
        let mut pairs = Vec::new();
        for (at, first) in members.iter().enumerate() {
            for second in &members[at + 1..] {
                pairs.push(vec![*first, *second]);
            }
        }
        if members.len() > 2 {
            pairs.push(members.clone());
        }
        for group in pairs {
            let mends: BTreeSet<Mend> = group.iter().map(mend_of).collect();
            if mends.len() < group.len() {
                continue;
            }
            let all = mends.iter().fold(Mend::default(), |all, mend| all.and(mend));
            // What can't be run proves nothing; why, each has said of its own mend.
            let Ok(after) = self.run_once(runs, &all)? else { continue };
            let (Proof::Proven, left) = judge(region, before, &after, runs.request.size) else { continue };
            let causes: Vec<Cause> = group.iter().map(|index| tried[*index].suspicion.cause).collect();
            for index in group {
                let one = &mut tried[index];
                one.together_with = causes.iter().copied().filter(|cause| *cause != one.suspicion.cause).collect();
                let others: Vec<&str> = one.together_with.iter().map(|cause| cause.name()).collect();
                let alone = one.left.unwrap_or(0);
                one.suspicion.evidence.push_str(&format!(
                    "; mended alone it leaves {alone} wrong pixels, together with {} none",
                    others.join(" and ")
                ));
                (one.proof, one.left) = (Proof::Proven, Some(left));
            }
            return Ok(());
        }
        Ok(())
    }

    /// What a mend leaves wrong, or why it can't be run. Each is run once for all regions.
    fn run_once(&mut self, runs: &mut Runs, mend: &Mend) -> Result<Result<Wrong, String>, SessionError> {
        if runs.progress.is_cancelled() {
            return Err(SessionError::Cancelled);
        }
        if let Some((_, done)) = runs.done.iter().find(|(of, _)| of == mend) {
            return Ok(done.clone());
        }
        let done = match self.run_mended(runs.scene, runs.request, runs.fault, mend, runs.traced) {
            Ok(run) => Ok(run.wrong),
            Err(SessionError::Cancelled) => return Err(SessionError::Cancelled),
            Err(because) => Err(because.to_string()),
        };
        runs.done.push((mend.clone(), done.clone()));
        Ok(done)
    }

    /// What leaves the least wrong in the whole frame.
    fn advice(&mut self, runs: &mut Runs, regions: &[RegionFound], run: &Run) -> Result<Option<Advice>, SessionError> {
        // Whatever can't be run is no candidate: only what was run is asked below.
        let before = run.wrong.count();
        let proven = |region: &RegionFound| {
            let first = region.causes.iter().filter(|cause| cause.proof == Proof::Proven);
            let count = 1 + region.causes.first().map_or(0, |cause| cause.together_with.len());
            let mends = first.take(count).filter_map(|cause| cause.mend.clone());
            mends.fold(Mend::default(), |all, mend| all.and(&mend))
        };
        let all = regions.iter().map(proven).fold(Mend::default(), |all, mend| all.and(&mend));
        if !all.is_empty() {
            self.run_once(runs, &all)?.ok();
        }
        let is_proven = |region: &RegionFound| region.causes.first().is_some_and(|first| first.proof == Proof::Proven);
        if !regions.iter().all(is_proven) {
            // Of what no rule explains, much is right there.
            self.run_once(runs, &Mend::technique(Technique::Auto))?.ok();
        }
        // For who wants to keep the technique: all that its settings can do.
        self.run_once(runs, &Mend { technique: None, ..all })?.ok();
        let left = runs.done.iter().filter_map(|(mend, done)| Some((done.as_ref().ok()?.count(), mend.weight(), mend)));
        let helps: Vec<_> = left.filter(|(left, ..)| *left < before).collect();
        let least = |keeps: bool| {
            let asked = helps.iter().filter(|(.., mend)| !keeps || mend.technique.is_none());
            asked.min_by_key(|(left, weight, _)| (*left, *weight))
        };
        let staying = least(true).map(|(left, _, mend)| (*mend, *left));
        let technique = run.choice.technique();
        let advice =
            |(left, _, mend): &(u64, usize, &Mend)| Advice::new(mend, *left, before).or_staying(technique, staying);
        Ok(least(false).map(advice))
    }
}

/// Which objects can darken anything: those that cast, but for floors and the like, of which all that receives lies
/// on the light's side or in their own plane.
fn darkening(scene: &Scene, lights: &[DVec4]) -> Vec<bool> {
    let places: Vec<Vec<DVec3>> = scene.objects.iter().map(Object::world_positions).collect();
    let receiving = || {
        let receives = scene.objects.iter().zip(&places).filter(|(object, _)| object.receives && object.visible);
        receives.flat_map(|(_, places)| places.iter().copied())
    };
    let darkens = |(object, places): (&Object, &Vec<DVec3>)| {
        let triangles = object.mesh.triangles();
        let on_any = |corners: &[u32; 3]| {
            let corners = corners.map(|corner| places[corner as usize]);
            lights.iter().any(|light| light_frame::can_darken(corners, *light, receiving()))
        };
        object.casts && (triangles.len() > MOST_TRIANGLES_TO_LOOK_AT || triangles.iter().any(on_any))
    };
    scene.objects.iter().zip(&places).map(darkens).collect()
}

/// All wrong regions, the largest first; what is merely too dark comes after what is wrong.
fn wrong_regions(facts: &Facts, run: &Run) -> Vec<Region> {
    let size = facts.plan.size;
    let mut found = Vec::new();
    for (light, findings) in run.findings.iter().enumerate() {
        let key = |(index, byte): (usize, &u8)| {
            let finding = Finding::from_byte(*byte).filter(|finding| finding.is_wrong())?;
            Some(key_of(facts, light, RegionKind::Wrong(finding), crate::accuracy::place(index, size)))
        };
        let keys: Vec<Option<Key>> = findings.par_iter().enumerate().map(key).collect();
        found.extend(regions::find(light, keys, size));
        let mut keys = vec![None; findings.len()];
        for index in &run.too_dark[light] {
            keys[*index] = Some(Key { kind: RegionKind::TooDark, caster: None, receiver: None, hint: None });
        }
        found.extend(regions::find(light, keys, size));
    }
    found.sort_by_key(|region| {
        (region.key.kind == RegionKind::TooDark, std::cmp::Reverse(region.pixels.len()), region.light, region.pixels[0])
    });
    found
}

/// What one wrong pixel tells by itself.
fn key_of(facts: &Facts, light: usize, kind: RegionKind, pixel: [u32; 2]) -> Key {
    let seen = facts.tracer.seen_at(pixel.map(|n| f64::from(n) + 0.5));
    let receiver = seen.map(|seen| seen.place.object);
    let plain = Key { kind, caster: None, receiver, hint: None };
    let Some(seen) = seen else { return plain };
    if let Some(look) = map::look(facts, light, kind, &seen) {
        return Key { caster: look.caster, hint: Some(look.cause), ..plain };
    }
    if let Some((cause, caster, _)) = projective::look(facts, light, kind, &seen) {
        return Key { caster, hint: Some(cause), ..plain };
    }
    match kind {
        RegionKind::Wrong(Finding::MissingShadow) => {
            let between = facts.tracer.between(light, &seen);
            Key { caster: between.first().map(|met| met.place.object), ..plain }
        }
        RegionKind::Wrong(Finding::FalseShadow) => Key { hint: planar::hint(facts, light, &seen), ..plain },
        _ => plain,
    }
}

fn described(facts: &Facts, case: &Case, causes: Vec<CauseFound>, size: [u32; 2]) -> RegionFound {
    let region = case.region;
    let light = region.light;
    let name = |object: usize| facts.tracer.object_name(object).to_owned();
    let mut casters: BTreeSet<String> = region.key.caster.map(name).into_iter().collect();
    if casters.is_empty() {
        for sample in &case.samples {
            casters.extend(sample.miscounted(facts, light).into_iter().map(|(name, ..)| name));
            let flattened = sample.history.iter().flat_map(|history| history.triangles());
            let flattened = flattened.filter(|(event, one)| {
                event.light == Some(light) && one.part == Part::PlanarShadow && one.fate.passed()
            });
            casters.extend(flattened.filter_map(|(_, one)| one.caster.clone()));
        }
    }
    RegionFound {
        pixels: region.pixels.len() as u64,
        kind: region.key.kind,
        light,
        bounds: region.bounds,
        at: case.samples.first().map_or(crate::accuracy::place(region.pixels[0], size), |sample| sample.pixel),
        casters: casters.into_iter().collect(),
        receivers: region.key.receiver.map(name).into_iter().collect(),
        causes,
    }
}

/// What the truth would be with each flag set.
fn flags(scene: &Scene, traced: &Traced, progress: &Progress) -> Result<Vec<FlagFound>, SessionError> {
    let mut found = Vec::new();
    let mut asked = 0;
    for (index, object) in scene.objects.iter().enumerate() {
        let flags = [
            (object.receives, Cause::NotReceiving, ObjectChange::Receives),
            (object.casts, Cause::NotCasting, ObjectChange::Casts),
            (object.visible, Cause::Undrawn, ObjectChange::Visible),
        ];
        for (_, cause, change) in flags.into_iter().filter(|(is_set, ..)| !is_set) {
            if asked == MOST_FLAGS {
                return Ok(found);
            }
            asked += 1;
            let mut with = scene.clone();
            let object = &mut with.objects[index];
            match change {
                ObjectChange::Receives => object.receives = true,
                ObjectChange::Casts => object.casts = true,
                ObjectChange::Visible => object.visible = true,
                ObjectChange::Weld => {}
            }
            let silent = Progress::default();
            let truth = Tracer::new(&with, traced.truth.size)?.trace(&silent).ok_or(SessionError::Cancelled)?;
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            let differs = |(a, b): (&Vec<u8>, &Vec<u8>)| -> Vec<usize> {
                (0..a.len()).filter(|pixel| a[*pixel] != b[*pixel]).collect()
            };
            let changed: Vec<Vec<usize>> = traced.truth.labels.iter().zip(&truth.labels).map(differs).collect();
            let pixels = changed.iter().map(|pixels| pixels.len() as u64).sum();
            let at = changed.iter().flatten().next();
            if pixels > 0 {
                found.push(FlagFound {
                    object: scene.objects[index].name.clone(),
                    cause,
                    pixels,
                    at: at.map(|pixel| crate::accuracy::place(*pixel, traced.truth.size)),
                    mend: Mend::scene(index, &scene.objects[index].name, change),
                });
            }
        }
    }
    Ok(found)
}
