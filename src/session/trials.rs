//! Trials of fixes: what each leaves wrong, which prove something alone or together, and the advice that follows.

use super::fixed_frame::FixedFrame;
use super::truth::TracedScene;
use super::{AsyncSession, CaptureRequest, InjectedFault, SessionError};
use crate::accuracy::{ErrorCounts, Finding};
use crate::capture::{Capture, Image};
use crate::diagnosis::facts::{MovedMap, SuspectedCause};
use crate::diagnosis::proof::{TriedCause, WrongCount, WrongPixels, judge, ranked};
use crate::diagnosis::regions::ConnectedRegion;
use crate::diagnosis::rules::{filter, planar, relit, swim};
use crate::diagnosis::{Advice, Cause, CauseFound, Fix, FixWithinTechnique, FrameEffect, Proof, RegionFound};
use crate::gpu::Executor;
use crate::numbers;
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::technique::Technique;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The most fixes that are tried at once, for regions that none of them clears alone.
const MOST_TOGETHER: usize = 3;

/// The wrong pixels of a frame, found by comparing its labels with the truth.
pub(super) struct JudgedFrame {
    /// For each light, a [`Finding`] for each pixel.
    pub findings: Vec<Vec<u8>>,
    /// For each light, the numbers of pixels that were darkened twice.
    pub too_dark: Vec<Vec<usize>>,
    /// For each light, the numbers of pixels that it lights more than once.
    pub lit_twice: Vec<Vec<usize>>,
    /// For each light, the numbers of lit pixels that its filter darkens in part.
    pub partly_dark: Vec<Vec<usize>>,
    /// For each light, the numbers of pixels whose share of the light is off where faces of its map meet.
    pub seamed: Vec<Vec<usize>>,
    pub error: ErrorCounts,
    pub wrong: WrongPixels,
}

/// The same frame drawn otherwise, to be held against it.
#[derive(Clone, Copy, Default)]
pub(super) struct OtherFrames<'a> {
    /// With maps fitted to views beside this one.
    pub moved: &'a [MovedMap],
    /// With light passes that light each pixel once; `None` where the frame's own do.
    pub guarded: Option<&'a Capture>,
}

/// The runs of fixes so far; for a fix that can't run, the reason.
pub(super) struct TrialRuns<'a> {
    pub scene: &'a Scene,
    pub request: &'a CaptureRequest,
    pub fault: InjectedFault<'a>,
    pub traced: &'a TracedScene,
    pub progress: &'a Progress,
    pub done: Vec<Trial>,
}

/// The run of a fix.
pub(super) struct Trial {
    fix: Fix,
    /// The part of the picture that was drawn (left, top, columns, rows), outside of which no pixel counts as wrong;
    /// `None` for all of it.
    window: Option<[u32; 4]>,
    /// The pixels that are wrong with it, or why it can't be run.
    left: Result<WrongPixels, String>,
}

/// What the run of a fix has shown about one region.
#[derive(Debug, Clone)]
struct RegionTrial {
    fix: Fix,
    proof: Proof,
    /// Pixels that are wrong with it, in the region and newly in its bounding box.
    left: u64,
    /// `None` where only the region was drawn.
    whole_frame: Option<FrameEffect>,
}

impl RegionTrial {
    fn is_worse(&self) -> bool {
        self.whole_frame.is_some_and(FrameEffect::is_worse)
    }

    /// Returns the sort key of a trial, the best first: of two that show the same, that which harms no other region.
    fn rank(&self) -> (Proof, bool, u64) {
        (self.proof, self.is_worse(), self.left)
    }
}

impl AsyncSession {
    /// Captures the frame with light passes that light each pixel once; `None` where the plan's own do.
    pub(super) async fn guarded(&mut self, scene: &Scene, plan: &FramePlan) -> Result<Option<Capture>, SessionError> {
        match relit::guarded(plan) {
            Some(guarded) => Ok(Some(self.capture_plan(scene, &guarded).await?)),
            None => Ok(None),
        }
    }

    /// Runs the frame with a fix, within a window where one is given, and returns which pixels are still wrong, at the
    /// picture's own size. Only labels are captured, except for techniques that darken the picture or lit surfaces in
    /// part, of which the whole picture is; `None` where that would be a larger picture, which does not show what is
    /// too dark, and what swims.
    async fn run_fixed(
        &mut self,
        runs: &TrialRuns<'_>,
        fix: &Fix,
        window: Option<[u32; 4]>,
    ) -> Result<Option<WrongPixels>, SessionError> {
        let FixedFrame { scene, choice, drawn: mut plan, .. } =
            self.plan_fixed(runs.scene, runs.request, runs.fault, fix, None).await?;
        self.check_memory_budget(&plan)?;
        let cameras = swim::cameras(&scene, &choice);
        let may_be_off = planar::darkens_in_the_picture(&plan) || filter::may_darken_in_part(&plan);
        if may_be_off || !cameras.is_empty() || relit::guarded(&plan).is_some() {
            if fix.larger.is_some() {
                return Ok(None);
            }
            let capture = self.capture_plan(&scene, &plan).await?;
            let moved = self.moved_maps(runs.scene, runs.request, runs.fault, fix, &cameras).await?;
            let guarded = self.guarded(&scene, &plan).await?;
            let other = OtherFrames { moved: &moved, guarded: guarded.as_ref() };
            return Ok(Some(
                judged(&self.executor, &plan, runs.traced, &labels_of(&capture), Some(&capture), other).await.wrong,
            ));
        }
        if let Some(window) = window {
            plan.draw_only(window.map(|side| side.saturating_mul(fix.larger.unwrap_or(1))));
        }
        let ready = match window {
            Some(_) => self.executor.prepare_trial(&plan).await?,
            None => self.executor.prepare_once(&plan).await?,
        };
        let mut labels = self.executor.labels(ready).await?;
        if let Some(times) = fix.larger {
            // Take the labels at the centres of the picture's own pixels.
            labels.iter_mut().flatten().for_each(|image| *image = Arc::new(image.every(times)));
        }
        if let Some(window) = window {
            let of_lights = labels.iter_mut().zip(&runs.traced.truth.labels);
            let drawn = of_lights.filter_map(|(labels, truth)| Some((labels.as_mut()?, truth)));
            drawn.for_each(|(labels, truth)| *labels = Arc::new(within(labels, window, truth)));
        }
        Ok(Some(judged(&self.executor, &plan, runs.traced, &labels, None, OtherFrames::default()).await.wrong))
    }

    pub(super) fn check_memory_budget(&self, plan: &FramePlan) -> Result<(), SessionError> {
        let needed = plan.bytes();
        match self.memory_budget {
            Some(most) if needed > most => Err(SessionError::OverBudget { needed, most }),
            _ => Ok(()),
        }
    }

    /// Runs the frame with each suspected cause's fixes, and with some of them together where none alone removes the
    /// fault. Returns each cause with its result, the most likely first.
    pub(super) async fn proven(
        &mut self,
        runs: &mut TrialRuns<'_>,
        region: &ConnectedRegion,
        before: &WrongPixels,
        suspicions: Vec<SuspectedCause>,
    ) -> Result<Vec<CauseFound>, SessionError> {
        let size = runs.request.size;
        let mut tried = Vec::new();
        for mut suspicion in suspicions {
            let mut best: Option<RegionTrial> = None;
            let mut small: Option<RegionTrial> = None;
            for fix in std::mem::take(&mut suspicion.fixes) {
                let trial = match self.run_once(runs, &fix, Some(region)).await? {
                    Ok(after) => {
                        let (proof, left) = judge(region, before, &after, size);
                        // A larger picture was drawn only where the region is.
                        let whole_frame = fix.larger.is_none().then(|| before.effect(&after));
                        RegionTrial { fix, proof, left, whole_frame }
                    }
                    Err(because) => {
                        suspicion.evidence.sentence.push_str(&format!(" ({fix} can't be run: {because})"));
                        continue;
                    }
                };
                let is_better =
                    |least: &Option<RegionTrial>| least.as_ref().is_none_or(|least| trial.rank() < least.rank());
                let is_settled = trial.proof == Proof::Proven && !trial.is_worse();
                if trial.fix.technique.is_none() && trial.proof == Proof::Part && is_better(&small) {
                    small = Some(trial.clone());
                }
                if is_better(&best) {
                    best = Some(trial);
                }
                if is_settled {
                    break;
                }
            }
            // Where another technique fixes the region wholly, this one may fix it nearly.
            let is_other = best.as_ref().is_some_and(|best| best.fix.technique.is_some());
            let is_less = |trial: &RegionTrial| trial.left < region.pixels.len() as u64;
            let staying = small.filter(|small| is_other && is_less(small)).map(|small| {
                let RegionTrial { fix, left, whole_frame, .. } = small;
                FixWithinTechnique { fix, pixels_left: left, whole_frame }
            });
            let proof = best.as_ref().map_or(Proof::NotRun, |best| suspicion.evidence.proof(best.proof));
            let (left, whole_frame) =
                (best.as_ref().map(|best| best.left), best.as_ref().and_then(|best| best.whole_frame));
            let fix = best.map(|best| best.fix);
            tried.push(TriedCause { suspicion, fix, proof, left, whole_frame, staying, together_with: Vec::new() });
        }
        if !tried.iter().any(|one| one.proof == Proof::Proven) {
            self.try_together(runs, region, before, &mut tried).await?;
        }
        Ok(ranked(tried))
    }

    /// Tries fixes in pairs, and all together, for one region, and records in `tried` those that only together prove
    /// their causes; where several causes are at work at once, their fixes prove something only so.
    async fn try_together(
        &mut self,
        runs: &mut TrialRuns<'_>,
        region: &ConnectedRegion,
        before: &WrongPixels,
        tried: &mut [TriedCause],
    ) -> Result<(), SessionError> {
        let helps = |one: &&TriedCause| one.proof == Proof::Part;
        let least = if tried.iter().filter(helps).count() > 1 { Proof::Part } else { Proof::NotIt };
        // What takes all pixels away by itself, without evidence that holds, needs no other fix.
        let may_join = |one: &TriedCause| {
            one.fix.is_some() && one.proof <= least && one.left != Some(0) && one.suspicion.evidence.numbers_hold()
        };
        let mut members: Vec<usize> = (0..tried.len()).filter(|index| may_join(&tried[*index])).collect();
        members.sort_by_key(|index| (tried[*index].proof, tried[*index].left));
        members.truncate(MOST_TOGETHER);
        let fix_of = |index: &usize| tried[*index].fix.clone().unwrap_or_default();
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
            let fixes: BTreeSet<Fix> = group.iter().map(fix_of).collect();
            if fixes.len() < group.len() {
                continue;
            }
            let all = fixes.iter().fold(Fix::default(), |all, fix| all.and(fix));
            // What can't be run proves nothing; each fix has recorded the reason.
            let Ok(after) = self.run_once(runs, &all, Some(region)).await? else { continue };
            let (Proof::Proven, left) = judge(region, before, &after, runs.request.size) else { continue };
            let causes: Vec<Cause> = group.iter().map(|index| tried[*index].suspicion.cause).collect();
            for index in group {
                let one = &mut tried[index];
                one.together_with = causes.iter().copied().filter(|cause| *cause != one.suspicion.cause).collect();
                let others: Vec<&str> = one.together_with.iter().map(|cause| cause.name()).collect();
                let alone = one.left.unwrap_or(0);
                let they = region.key.kind.of_those_left();
                one.suspicion.evidence.sentence.push_str(&format!(
                    "; fixed alone, {} {they}, together with {} none",
                    numbers::counted(alone, "pixel"),
                    others.join(" and ")
                ));
                (one.proof, one.left) = (Proof::Proven, Some(left));
            }
            return Ok(());
        }
        Ok(())
    }

    /// Returns which pixels a fix leaves wrong, or, as text, why it can't be run: those of a region, or without one, of
    /// the whole picture. Each fix is run once for all regions, except that larger pictures are drawn only where the
    /// region is, as they take the longest.
    async fn run_once(
        &mut self,
        runs: &mut TrialRuns<'_>,
        fix: &Fix,
        region: Option<&ConnectedRegion>,
    ) -> Result<Result<WrongPixels, String>, SessionError> {
        if runs.progress.is_cancelled() {
            return Err(SessionError::Cancelled);
        }
        let window = region.filter(|_| fix.larger.is_some()).map(ConnectedRegion::window);
        if let Some(trial) = runs.done.iter().find(|trial| trial.fix == *fix && trial.window == window) {
            return Ok(trial.left.clone());
        }
        let left = match self.run_fixed(runs, fix, window).await {
            Ok(Some(wrong)) => Ok(wrong),
            Ok(None) => return Box::pin(self.run_once(runs, &Fix { larger: None, ..fix.clone() }, None)).await,
            Err(SessionError::Cancelled) => return Err(SessionError::Cancelled),
            Err(because) => Err(because.to_string()),
        };
        runs.done.push(Trial { fix: fix.clone(), window, left: left.clone() });
        Ok(left)
    }

    /// Returns the fix that leaves the fewest wrong pixels in the whole frame, and the best one that stays with the
    /// technique; `None` where none leaves fewer than before.
    pub(super) async fn advice(
        &mut self,
        runs: &mut TrialRuns<'_>,
        regions: &[RegionFound],
        before: &WrongPixels,
        technique: Technique,
    ) -> Result<Option<Advice>, SessionError> {
        // A fix that can't be run is no candidate: only those that were run are compared below.
        let now = before.count();
        let proven = |region: &RegionFound| {
            let first = region.causes.iter().filter(|cause| cause.proof == Proof::Proven);
            let count = 1 + region.causes.first().map_or(0, |cause| cause.together_with.len());
            let fixes = first.take(count).filter_map(|cause| cause.fix.clone());
            fixes.fold(Fix::default(), |all, fix| all.and(&fix))
        };
        let all = regions.iter().map(proven).fold(Fix::default(), |all, fix| all.and(&fix));
        if !all.is_empty() {
            self.run_once(runs, &all, None).await?.ok();
        }
        let is_proven = |region: &RegionFound| region.causes.first().is_some_and(|first| first.proof == Proof::Proven);
        if !regions.iter().all(is_proven) {
            // Pixels that no rule explains are often right there.
            self.run_once(runs, &Fix::technique(Technique::Auto), None).await?.ok();
        }
        // Larger pictures were drawn only where the regions are.
        let in_part = regions.iter().flat_map(|region| &region.causes).filter(|cause| cause.proof == Proof::Part);
        let larger = in_part.filter_map(|cause| cause.fix.as_ref()).filter(|fix| fix.larger.is_some());
        for fix in larger.collect::<BTreeSet<_>>() {
            self.run_once(runs, fix, None).await?.ok();
        }
        // For readers who want to stay with the technique: all that its settings can do.
        self.run_once(runs, &Fix { technique: None, ..all }, None).await?.ok();
        let of_whole = runs.done.iter().filter(|trial| trial.window.is_none());
        let left =
            of_whole.filter_map(|Trial { fix, left, .. }| Some((left.as_ref().ok()?.count(), fix.weight(), fix)));
        let helps: Vec<_> = left.filter(|(left, ..)| left.all() < now.all()).collect();
        let least = |keeps: bool| {
            let asked = helps.iter().filter(|(.., fix)| !keeps || fix.technique.is_none());
            asked.min_by_key(|(left, weight, _)| (left.all(), *weight))
        };
        let staying = least(true).map(|(left, _, fix)| (*fix, *left));
        let advice = |(left, _, fix): &(WrongCount, usize, &Fix)| {
            Advice::new(fix, *left, now).or_staying(technique, staying, now)
        };
        Ok(least(false).map(advice))
    }
}

/// Returns the labels within a window (left, top, columns, rows), and the true ones outside, where nothing was drawn.
fn within(labels: &Image, [left, top, columns, rows]: [u32; 4], truth: &[u8]) -> Image {
    let mut all = truth.to_vec();
    let drawn = left as usize..(left + columns) as usize;
    let by_row = all.chunks_exact_mut(labels.size()[0] as usize).zip(labels.rows());
    for (all, labels) in by_row.skip(top as usize).take(rows as usize) {
        all[drawn.clone()].copy_from_slice(&labels[drawn.clone()]);
    }
    Image::packed(labels.format(), labels.size(), all)
}

pub(super) fn labels_of(capture: &Capture) -> Vec<Option<Arc<Image>>> {
    capture.lights.iter().map(|light| light.shadow.clone()).collect()
}

/// Compares labels with the truth, light by light; with the capture, pixels that agree but were darkened twice in the
/// picture, or in part by a filter, or lit twice, count as wrong too. Lights without labels are not compared. Pixels swim
/// that have another label in one of the other frames.
pub(super) async fn judged(
    executor: &Executor,
    plan: &FramePlan,
    traced: &TracedScene,
    labels: &[Option<Arc<Image>>],
    capture: Option<&Capture>,
    OtherFrames { moved, guarded }: OtherFrames<'_>,
) -> JudgedFrame {
    let pixels = traced.truth.size.iter().map(|side| *side as usize).product();
    let (mut findings, mut too_dark, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    let (mut partly_dark, mut seamed, mut relit) = (Vec::new(), Vec::new(), Vec::new());
    let mut error = ErrorCounts::default();
    for (light, labels) in labels.iter().enumerate() {
        let of_light = match labels {
            Some(labels) => {
                let accuracy = traced.compare(executor, light, labels).await;
                error = [error, accuracy.counts].into_iter().sum();
                accuracy.findings
            }
            None => vec![Finding::NotCompared as u8; pixels],
        };
        let is_wrong = |byte: &u8| Finding::from_byte(*byte).is_some_and(Finding::is_wrong);
        let mut is_wrong: Vec<bool> = of_light.iter().map(is_wrong).collect();
        executor.yield_now().await;
        let dark = capture.map_or_else(Vec::new, |capture| planar::too_dark(plan, capture, light));
        let dark: Vec<usize> = dark.into_iter().filter(|index| of_light[*index] == Finding::Agrees as u8).collect();
        executor.yield_now().await;
        let in_part = capture.map_or_else(Vec::new, |capture| {
            filter::darkened_in_part(plan, capture, &traced.tracer, light, &traced.truth.labels[light])
        });
        executor.yield_now().await;
        let mut at_seam = capture.map_or_else(Vec::new, |capture| {
            filter::broken_at_a_seam(plan, capture, &traced.tracer, light, &traced.truth.labels[light])
        });
        at_seam.retain(|index| in_part.binary_search(index).is_err());
        let twice = capture
            .zip(guarded)
            .map_or_else(Vec::new, |(capture, guarded)| relit::lit_twice(plan, capture, guarded, light));
        dark.iter().chain(&in_part).chain(&at_seam).chain(&twice).for_each(|index| is_wrong[*index] = true);
        findings.push(of_light);
        too_dark.push(dark);
        partly_dark.push(in_part);
        seamed.push(at_seam);
        relit.push(twice);
        wrong.push(is_wrong);
    }
    let swimming = |light: usize| {
        let mut swims = vec![false; pixels];
        swim::swimming(plan, labels, moved, &traced.tracer, light).into_iter().for_each(|index| swims[index] = true);
        swims
    };
    let swimming = (0..labels.len()).map(swimming).collect();
    let wrong = WrongPixels { lights: wrong, swimming };
    JudgedFrame { findings, too_dark, lit_twice: relit, partly_dark, seamed, error, wrong }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::Builtin;
    use crate::technique::Choice;
    use pollster::block_on;

    /// Parts of a picture have the labels of the whole, the second also with maps that the first has cached, and those
    /// of a capture, which runs all passes.
    #[test]
    fn labels_of_a_window_are_those_of_the_whole_picture() {
        let mut session = block_on(AsyncSession::new(None)).expect("the reference adapter");
        let scene = Builtin::named("two-lights").expect("a scene").scene().expect("a scene");
        let mut dark = 0;
        for technique in Technique::rivals() {
            let request = CaptureRequest::new(Choice::new(technique), [120, 90]);
            let plan = block_on(session.plan(&scene, &request)).expect("a plan");
            let whole = labels_of(&block_on(session.capture_plan(&scene, &plan)).expect("a capture"));
            for window in [[10, 20, 50, 40], [60, 30, 45, 55]] {
                let mut part = plan.clone();
                part.draw_only(window);
                let ready = block_on(session.executor.prepare_trial(&part)).expect("prepared");
                let labels = block_on(session.executor.labels(ready)).expect("labels");
                for (part, whole) in labels.iter().zip(&whole) {
                    let [part, whole] = [part, whole].map(|labels| labels.as_ref().expect("labels"));
                    let [left, top, columns, rows] = window;
                    for y in top..top + rows {
                        let drawn = left as usize..(left + columns) as usize;
                        assert_eq!(part.row(y)[drawn.clone()], whole.row(y)[drawn.clone()], "{technique:?}, row {y}");
                        dark += whole.row(y)[drawn].iter().filter(|label| **label == 1).count();
                    }
                }
            }
        }
        assert!(dark > 1000, "{dark}");
    }
}
