//! Runs stress cases: every technique at every value, against the truth.

use super::truth::TracedScene;
use super::{AsyncSession, SessionError, median_ms, milliseconds};
use crate::accuracy::{ErrorCounts, Finding};
use crate::geometry::GeometryCache;
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::scene::{Scene, SceneError};
use crate::stress::{CaseNumber, Entrant, ExpectedTrend, StressCase, StressRow, TruthCounts};
use crate::technique::{self, Choice, PlanRequest};
use crate::truth::{LIT, SHADOW};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::Arc;
use web_time::Instant;

/// A light's labels at the value before, in a motion.
#[derive(Debug)]
pub(super) struct LabelsBefore {
    entrant: Entrant,
    light: usize,
    labels: Vec<u8>,
    truth: Vec<u8>,
    /// For each pixel, whether labels and truth differ along an edge.
    excused: Vec<bool>,
    /// For each pixel, how many more times its label has changed than its truth.
    ahead: Vec<i8>,
}

/// An error that is injected into a technique's inputs or plan, while truth and expectation stay: it must be found.
#[derive(Clone, Copy)]
pub enum InjectedFault<'a> {
    /// No error.
    None,
    /// Changes the scene, before any geometry is computed from it.
    Scene(&'a dyn Fn(&mut Scene)),
    /// Changes the settings, whatever the row says.
    Choice(&'a dyn Fn(&mut Choice)),
    /// Changes the plan.
    Plan(&'a dyn Fn(&mut FramePlan)),
}

/// The inputs of one row of the stress table: a case, a technique and a value of what the case varies.
#[derive(Debug, Clone, Copy)]
pub(super) struct StressStep<'a> {
    pub case: &'a StressCase,
    pub entrant: Entrant,
    pub value: f64,
    pub size: [u32; 2],
}

/// Returns the scene of a case at a value.
pub(super) fn scene_of(case: &StressCase, value: f64) -> Result<Scene, SessionError> {
    let named = |source| SceneError::Mesh { name: format!("{} {value}", case.name), source };
    Ok(case.scene(value).map_err(named)?)
}

impl AsyncSession {
    /// As [`Session::stress_faulty`](super::Session::stress_faulty).
    pub async fn stress_faulty(
        &mut self,
        case: &StressCase,
        entrants: &[Entrant],
        values: &[f64],
        size: [u32; 2],
        fault: InjectedFault<'_>,
        progress: &Progress,
    ) -> Result<Vec<StressRow>, SessionError> {
        let (mut rows, mut before) = (Vec::new(), Vec::new());
        for value in values {
            let scene = scene_of(case, *value)?;
            for entrant in entrants {
                if progress.is_cancelled() {
                    return Err(SessionError::Cancelled);
                }
                if case.runs(entrant, *value) {
                    let step = StressStep { case, entrant: *entrant, value: *value, size };
                    rows.push(self.stress_row(&step, &scene, &mut before, fault).await?);
                }
                progress.advance();
            }
        }
        Ok(rows)
    }

    /// Returns the ray-traced truth, at `size` pixels, of the scene to which the case converges, traced once; `None`
    /// where the case converges to none.
    async fn limit_of(&mut self, case: &StressCase, size: [u32; 2]) -> Result<Option<Arc<TracedScene>>, SessionError> {
        let Some(ExpectedTrend::ConvergesTo(limit)) = case.trend else { return Ok(None) };
        let named = |source| SceneError::Mesh { name: format!("the limit of {}", case.name), source };
        let scene = limit().map_err(named)?;
        // Cached apart from the row's own truth, so that neither is traced again for each row.
        std::mem::swap(&mut self.traced, &mut self.limit);
        let traced = self.traced(&scene, size, &Progress::default()).await;
        std::mem::swap(&mut self.traced, &mut self.limit);
        traced.map(Some)
    }

    pub(super) async fn stress_row(
        &mut self,
        step: &StressStep<'_>,
        scene: &Scene,
        before: &mut Vec<LabelsBefore>,
        fault: InjectedFault<'_>,
    ) -> Result<StressRow, SessionError> {
        let StressStep { case, entrant, value, size } = *step;
        // It has its own progress: the steps of the whole are rows.
        let traced = self.traced(scene, size, &Progress::default()).await?;
        let limit = self.limit_of(case, size).await?;
        let choice = case.choice(&entrant, value)?;
        if case.timed {
            self.executor.forget();
        }
        let (scene, used) = fault.applied(scene, &choice);
        let start = Instant::now();
        // An empty cache: the geometry that another technique has cached would cost nothing here.
        let cache = &mut GeometryCache::default();
        let mut plan = technique::plan(PlanRequest { scene: &scene, size, choice: &used, cache, map_camera: None })?;
        if let InjectedFault::Plan(change) = fault {
            change(&mut plan);
        }
        let profile = self.executor.profile().await?;
        let step = profile.exact_range().coarse_step;
        let row = StressRow {
            case: case.name,
            parameter: (case.parameter, value),
            entrant,
            settings: choice.settings().clone(),
            error: ErrorCounts::default(),
            seen: TruthCounts::default(),
            flips: None,
            off_limit: None,
            step,
            not_drawn: None,
            expected: case.expected_on(step, &entrant, value),
            frame_ms: 0.0,
            setup_ms: 0.0,
        };
        let most = profile.largest_picture;
        if size.iter().any(|side| *side > most) {
            let [width, height] = size;
            let because = format!("the picture has {width}×{height} pixels, and the adapter holds {most} along a side");
            return Ok(StressRow { not_drawn: Some(because), ..row });
        }
        let plan = self.executor.clipped(plan).await?;
        let ready = self.executor.prepare(&plan).await?;
        let setup_ms = milliseconds(start.elapsed());
        self.executor.time(&ready, false).await?;
        let mut frames = Vec::with_capacity(case.timed_frames());
        for _ in 0..case.timed_frames() {
            frames.push(self.executor.time(&ready, false).await?);
        }
        let frame_ms = median_ms(&frames).unwrap_or(f64::NAN);
        let labels = self.executor.labels(ready).await?;
        let mut error = ErrorCounts::default();
        let (mut flips, mut off_limit, mut seen) = (None, None, TruthCounts::default());
        for (light, labels) in labels.iter().enumerate().filter_map(|(light, labels)| Some((light, labels.as_ref()?))) {
            let accuracy = traced.compare(&self.executor, light, labels).await;
            error = [error, accuracy.counts].into_iter().sum();
            let count = |label: u8| traced.truth.labels[light].iter().filter(|other| **other == label).count() as u64;
            seen.pixels += u64::from(size[0]) * u64::from(size[1]);
            seen.lit += count(LIT);
            seen.shadow += count(SHADOW);
            if let Some(limit) = &limit {
                let of_limit = limit.compare(&self.executor, light, labels).await;
                off_limit = Some(off_limit.unwrap_or(0) + of_limit.counts.wrong());
            }
            if let CaseNumber::Motion(_) = case.drives {
                let mut now = LabelsBefore {
                    entrant,
                    light,
                    labels: labels.rows().flatten().copied().collect(),
                    truth: traced.truth.labels[light].clone(),
                    excused: accuracy.findings.iter().map(|finding| *finding == Finding::EdgeBand as u8).collect(),
                    ahead: vec![0; traced.truth.labels[light].len()],
                };
                let last = before.iter_mut().find(|before| before.entrant == entrant && before.light == light);
                match last {
                    Some(last) => {
                        flips = Some(flips.unwrap_or(0) + flips_between(last, &mut now, size[0] as usize));
                        *last = now;
                    }
                    None => before.push(now),
                }
            }
        }
        Ok(StressRow { error, seen, flips, off_limit, frame_ms, setup_ms, ..row })
    }
}

impl InjectedFault<'_> {
    /// Returns the scene and choice that the technique is given in place of these: with the fault's change; unchanged
    /// for a fault in the plan, or none.
    pub(super) fn applied<'a>(self, scene: &'a Scene, choice: &Choice) -> (Cow<'a, Scene>, Choice) {
        let (mut scene, mut choice) = (Cow::Borrowed(scene), choice.clone());
        match self {
            InjectedFault::Scene(change) => change(scene.to_mut()),
            InjectedFault::Choice(change) => change(&mut choice),
            InjectedFault::None | InjectedFault::Plan(_) => {}
        }
        (scene, choice)
    }
}

/// Counts pixels whose label has changed there and back although the truth did not.
///
/// A label may change a step before the truth or after it: then it is one change ahead or behind for that time. Two
/// ahead is a flicker. A change does not count where the truth changes beside the pixel: an edge touches it then.
/// Excused pixels along edges count too, since a flicker can hide there, but only alone: an edge that lies along a row
/// of pixels moves all of them at once.
fn flips_between(last: &LabelsBefore, now: &mut LabelsBefore, width: usize) -> u64 {
    let (count, height) = (now.labels.len(), now.labels.len() / width.max(1));
    let moves = |at: usize| last.truth[at] != now.truth[at];
    let around = |at: usize| {
        let (x, y) = (at % width, at / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        rows.flat_map(move |row| (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |column| row * width + column))
    };
    let is_touched = |at: usize| around(at).any(moves);
    let mut flips = BTreeSet::new();
    for at in 0..count {
        let (label_moves, truth_moves) = (last.labels[at] != now.labels[at], moves(at));
        let counts = label_moves && (truth_moves || !is_touched(at));
        let ahead = (last.ahead[at] + i8::from(counts) - i8::from(truth_moves)).max(-1);
        let is_flip = ahead == 2;
        if is_flip {
            flips.insert(at);
        }
        now.ahead[at] = if is_flip { 0 } else { ahead };
    }
    let is_excused = |at: usize| last.excused[at] || now.excused[at];
    let is_alone = |at: usize| !around(at).any(|other| other != at && flips.contains(&other));
    flips.iter().filter(|at| !is_excused(**at) || is_alone(**at)).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Technique;

    /// Three by three pixels that do not change.
    fn nine_pixels() -> LabelsBefore {
        LabelsBefore {
            entrant: Entrant::of(Technique::ZFail),
            light: 0,
            labels: vec![0; 9],
            truth: vec![0; 9],
            excused: vec![false; 9],
            ahead: vec![0; 9],
        }
    }

    /// Returns the flips of the middle of three by three pixels, step by step; the others do not change, except a
    /// corner of the truth.
    fn flips(labels: &[u8], truth: &[u8], corner: &[u8]) -> Vec<u64> {
        let at = |step: usize| {
            let mut now = nine_pixels();
            (now.labels[4], now.truth[4], now.truth[8]) = (labels[step], truth[step], corner[step]);
            now
        };
        let mut last = at(0);
        let mut next = |step| {
            let mut now = at(step);
            let flips = flips_between(&last, &mut now, 3);
            last = now;
            flips
        };
        (1..labels.len()).map(&mut next).collect()
    }

    #[test]
    fn a_change_there_and_back_is_a_flip_unless_the_truth_changes_too() {
        let still = [0; 5];
        assert_eq!(flips(&[0, 1, 0, 1, 0], &still, &still), [0, 1, 0, 1]);
        assert_eq!(flips(&[0, 1, 1, 0, 0], &still, &still), [0, 0, 1, 0], "however long it takes");
        assert_eq!(flips(&[0, 1, 0, 0, 0], &[0, 1, 0, 0, 0], &still), [0; 4], "the truth does so");
        assert_eq!(flips(&[0, 1, 1, 1, 1], &[0, 0, 1, 1, 1], &still), [0; 4], "a step early");
        assert_eq!(flips(&[0, 0, 1, 1, 1], &[0, 1, 1, 1, 1], &still), [0; 4], "a step late");
        assert_eq!(flips(&[0, 1, 0, 1, 1], &[0, 0, 0, 1, 1], &still), [0, 1, 0, 0], "a flicker before it comes");
        assert_eq!(flips(&[0, 1, 0, 0, 0], &still, &[0, 1, 0, 0, 0]), [0; 4], "an edge touches it and goes");
    }

    /// Returns the flips where these of three by three pixels change there and back.
    fn flips_of(pixels: &[usize], is_excused: bool) -> u64 {
        let at = |label: u8| {
            let mut now = nine_pixels();
            pixels.iter().for_each(|pixel| now.labels[*pixel] = label);
            pixels.iter().for_each(|pixel| now.excused[*pixel] = is_excused && label == 1);
            now
        };
        let [before, mut there, mut back] = [0, 1, 0].map(at);
        assert_eq!(flips_between(&before, &mut there, 3), 0);
        flips_between(&there, &mut back, 3)
    }

    #[test]
    fn an_excused_pixel_flickers_only_alone() {
        assert_eq!((flips_of(&[4], true), flips_of(&[4], false)), (1, 1));
        assert_eq!((flips_of(&[3, 4, 5], true), flips_of(&[3, 4, 5], false)), (0, 3), "a row");
        assert_eq!((flips_of(&[0, 4, 8], true), flips_of(&[0, 4, 8], false)), (0, 3), "corners touch");
        assert_eq!((flips_of(&[0, 2, 6, 8], true), flips_of(&[2, 3], true)), (4, 2), "apart");
    }
}
