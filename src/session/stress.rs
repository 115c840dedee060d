//! Runs stress cases: every technique at every value, against the truth.

use super::{Session, SessionError, StressSteps, median_ms, milliseconds};
use crate::accuracy::{ErrorCounts, Finding};
use crate::geometry::GeometryCache;
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::scene::{Scene, SceneError};
use crate::stress::{Case, Drives, Entrant, Row};
use crate::technique::{self, Job, Technique};
use std::time::Instant;

/// What a light's pixels said at the value before, in a motion.
#[derive(Debug)]
pub(super) struct Before {
    entrant: Entrant,
    light: usize,
    labels: Vec<u8>,
    truth: Vec<u8>,
    findings: Vec<u8>,
}

/// What a row is of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step<'a> {
    pub case: &'a Case,
    pub entrant: Entrant,
    pub value: f64,
    pub size: [u32; 2],
}

/// The scene of a case at a value.
pub(super) fn scene_of(case: &Case, value: f64) -> Result<Scene, SessionError> {
    let named = |source| SceneError::Mesh { name: format!("{} {value}", case.name), source };
    Ok(case.scene(value).map_err(named)?)
}

impl Session {
    /// Runs `cases` with pictures of `size` pixels, but for those that have a size of their own; with `only`, no other techniques.
    ///
    /// # Errors
    /// A case that can't be drawn or traced, which is a bug of the case; a lost GPU;
    /// [`SessionError::Cancelled`].
    pub fn stress(
        &mut self,
        cases: &[&'static Case],
        only: &[Technique],
        size: [u32; 2],
        progress: &Progress,
    ) -> Result<Vec<Row>, SessionError> {
        let mut steps = StressSteps::new(cases, only, size);
        progress.start(steps.left());
        let mut rows = Vec::with_capacity(steps.left());
        while !progress.is_cancelled() {
            let Some(row) = self.stress_step(&mut steps)? else { return Ok(rows) };
            rows.push(row);
            progress.advance();
        }
        Err(SessionError::Cancelled)
    }

    /// One technique at one value of a case, with its plan changed by `change` before it runs: shows
    /// that a plan which is wrong is judged so.
    ///
    /// # Errors
    /// As [`Session::stress`].
    pub fn stress_changed(
        &mut self,
        case: &Case,
        entrant: Entrant,
        value: f64,
        size: [u32; 2],
        change: impl FnOnce(&mut FramePlan),
    ) -> Result<Row, SessionError> {
        let scene = scene_of(case, value)?;
        self.stress_row(&Step { case, entrant, value, size }, &scene, &mut Vec::new(), change)
    }

    pub(super) fn stress_row(
        &mut self,
        step: &Step,
        scene: &Scene,
        before: &mut Vec<Before>,
        change: impl FnOnce(&mut FramePlan),
    ) -> Result<Row, SessionError> {
        let Step { case, entrant, value, size } = *step;
        // Its own progress: the steps of the whole are rows.
        let traced = self.traced(scene, size, &Progress::default())?;
        let choice = case.choice(&entrant, value)?;
        if case.timed {
            self.executor.forget();
        }
        let start = Instant::now();
        // Geometry that another technique has found out would be had for nothing.
        let cache = &mut GeometryCache::default();
        let mut plan = technique::plan(Job { scene, size, choice: &choice, cache })?;
        change(&mut plan);
        let ready = self.executor.prepare(&plan)?;
        let setup_ms = milliseconds(start.elapsed());
        self.executor.time(&ready, false)?;
        let frames = (0..case.timed_frames()).map(|_| self.executor.time(&ready, false));
        let frame_ms = median_ms(&frames.collect::<Result<Vec<_>, _>>()?).unwrap_or(f64::NAN);
        let output = self.executor.capture(ready, false)?;
        let mut error = ErrorCounts::default();
        let mut flips = None;
        for (light, labels) in
            output.labels.iter().enumerate().filter_map(|(light, labels)| Some((light, labels.as_ref()?)))
        {
            let accuracy = traced.compare(light, labels);
            error = [error, accuracy.counts].into_iter().sum();
            if let Drives::Motion(_) = case.drives {
                let now = Before {
                    entrant,
                    light,
                    labels: labels.rows().flatten().copied().collect(),
                    truth: traced.truth.labels[light].clone(),
                    findings: accuracy.findings,
                };
                let last = before.iter_mut().find(|before| before.entrant == entrant && before.light == light);
                match last {
                    Some(last) => {
                        flips = Some(flips.unwrap_or(0) + isolated_flips(last, &now, size[0] as usize));
                        *last = now;
                    }
                    None => before.push(now),
                }
            }
        }
        Ok(Row {
            case: case.name,
            parameter: (case.parameter, value),
            entrant,
            settings: choice.settings().clone(),
            error,
            flips,
            expected: case.expected(&entrant),
            frame_ms,
            setup_ms,
        })
    }
}

/// Pixels whose label changed though the truth's did not, and none beside them changed; those that
/// the truth excuses at an edge are left out.
fn isolated_flips(last: &Before, now: &Before, width: usize) -> u64 {
    let changed = |at: usize| last.labels[at] != now.labels[at];
    let excused = |findings: &[u8], at: usize| findings[at] == Finding::EdgeBand as u8;
    let (count, height) = (now.labels.len(), now.labels.len() / width.max(1));
    let is_isolated = |at: &usize| {
        let (x, y) = (at % width, at / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        let mut around =
            rows.flat_map(|row| (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |column| row * width + column));
        !around.any(|other| other != *at && changed(other))
    };
    let flipped = (0..count).filter(|at| changed(*at) && last.truth[*at] == now.truth[*at]);
    let flipped = flipped.filter(|at| !excused(&last.findings, *at) && !excused(&now.findings, *at));
    flipped.filter(is_isolated).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn before(labels: &[u8], truth: &[u8]) -> Before {
        let entrant = Entrant::of(Technique::ZFail);
        Before { entrant, light: 0, labels: labels.to_vec(), truth: truth.to_vec(), findings: vec![0; labels.len()] }
    }

    #[test]
    fn a_flip_counts_where_the_truth_stands_still_and_nothing_beside_it_moves() {
        let still = [0; 9];
        let mut flipped = [0; 9];
        flipped[4] = 1;
        let flips = |labels: &[u8], truth: &[u8]| isolated_flips(&before(&still, &still), &before(labels, truth), 3);
        assert_eq!(flips(&still, &still), 0);
        assert_eq!(flips(&flipped, &still), 1);
        assert_eq!(flips(&flipped, &flipped), 0, "the truth shows it");
        flipped[5] = 1;
        assert_eq!(flips(&flipped, &still), 0, "an edge that moves is not isolated");
    }

    #[test]
    fn an_excused_pixel_does_not_count() {
        let mut now = before(&[0, 0, 1], &[0; 3]);
        now.findings[2] = Finding::EdgeBand as u8;
        assert_eq!(isolated_flips(&before(&[0; 3], &[0; 3]), &now, 3), 0);
    }
}
