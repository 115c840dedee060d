//! Stress cases row by row, so that other work may come in between.

use super::stress::{InjectedFault, LabelsBefore, StressStep, scene_of};
use super::{AsyncSession, SessionError};
use crate::progress::Progress;
use crate::scene::Scene;
use crate::shards::{Shard, ShardPart};
use crate::stress::{Entrant, StressCase, StressRow};
use crate::technique::Technique;
use std::collections::VecDeque;

/// The rest of a run of stress cases: the rows that are still to be computed, and what a motion carries from one value
/// to the next.
#[derive(Debug)]
pub struct StressSteps {
    /// The rows that are left, each with the index of its case and of its value.
    left: VecDeque<([usize; 2], StressStep<'static>)>,
    /// Indices of case and value of the scene.
    place: Option<[usize; 2]>,
    scene: Option<Scene>,
    before: Vec<LabelsBefore>,
}

impl StressSteps {
    /// Returns the steps of all values of `cases` in order, with pictures of `size` pixels except for cases that have a
    /// size of their own; of the techniques in `only`, or of all where that is empty. Rows that a case does not run are
    /// left out.
    pub fn new(cases: &[&'static StressCase], only: &[Technique], size: [u32; 2]) -> StressSteps {
        let mut left = VecDeque::new();
        for (case_index, case) in cases.iter().enumerate() {
            let is_asked = |technique: Technique| only.is_empty() || only.contains(&technique);
            let entrants: Vec<_> = case.entrants().into_iter().filter(|entrant| is_asked(entrant.technique)).collect();
            for (value_index, value) in case.values.iter().enumerate() {
                let step = |entrant| StressStep { case, entrant, value: *value, size: case.size.unwrap_or(size) };
                let running = entrants.iter().filter(|entrant| case.runs(entrant, *value));
                left.extend(running.map(|entrant| ([case_index, value_index], step(*entrant))));
            }
        }
        StressSteps { left, place: None, scene: None, before: Vec::new() }
    }

    /// Leaves out the rows that take many seconds and gigabytes: for callers that have other work between two rows.
    #[must_use]
    pub fn without_heavy(mut self) -> StressSteps {
        self.left.retain(|(_, step)| step.case.is_light(step.value));
        self
    }

    /// Returns the steps of one shard of the run, with what it is a part of: each entrant of each case, with all of its
    /// values, is in one shard.
    pub fn of(mut self, shard: Shard) -> (StressSteps, ShardPart) {
        let name = |StressStep { case, entrant, value, size: [width, height] }: &StressStep| {
            format!("{} · {entrant} · {value} · {width}×{height}", case.name)
        };
        let names: Vec<String> = self.left.iter().map(|(_, step)| name(step)).collect();
        let mut pieces: Vec<(usize, Entrant)> = Vec::new();
        let mut places = Vec::new();
        let mut place = 0;
        self.left.retain(|([case, _], step)| {
            let piece = (*case, step.entrant);
            let known = pieces.iter().position(|known| *known == piece);
            let number = known.unwrap_or_else(|| {
                pieces.push(piece);
                pieces.len() - 1
            });
            let is_ours = shard.has(number);
            places.extend(is_ours.then_some(place));
            place += 1;
            is_ours
        });
        let how = format!("stencilscope {} stress", env!("CARGO_PKG_VERSION"));
        (self, ShardPart::new(shard, places, how, names))
    }

    /// Returns the number of rows that are still to be computed.
    pub fn left(&self) -> usize {
        self.left.len()
    }

    /// Returns the index and name of the next row's case; `None` where all rows are computed.
    pub fn next_case(&self) -> Option<(usize, &'static str)> {
        self.left.front().map(|([case, _], step)| (*case, step.case.name))
    }
}

impl AsyncSession {
    /// As [`Session::stress`](super::Session::stress).
    pub async fn stress(
        &mut self,
        cases: &[&'static StressCase],
        only: &[Technique],
        size: [u32; 2],
        progress: &Progress,
    ) -> Result<Vec<StressRow>, SessionError> {
        self.stress_rows(StressSteps::new(cases, only, size), progress).await
    }

    /// As [`Session::stress_rows`](super::Session::stress_rows).
    pub async fn stress_rows(
        &mut self,
        mut steps: StressSteps,
        progress: &Progress,
    ) -> Result<Vec<StressRow>, SessionError> {
        progress.start(steps.left());
        let mut rows = Vec::with_capacity(steps.left());
        while !progress.is_cancelled() {
            let Some(row) = self.stress_step(&mut steps).await? else { return Ok(rows) };
            rows.push(row);
            progress.advance();
        }
        Err(SessionError::Cancelled)
    }

    /// As [`Session::stress_step`](super::Session::stress_step).
    pub async fn stress_step(&mut self, steps: &mut StressSteps) -> Result<Option<StressRow>, SessionError> {
        let Some((place, step)) = steps.left.pop_front() else { return Ok(None) };
        if steps.place.is_none_or(|[case, _]| case != place[0]) {
            steps.before.clear();
        }
        let scene = match steps.scene.take().filter(|_| steps.place == Some(place)) {
            Some(scene) => scene,
            None => scene_of(step.case, step.value)?,
        };
        steps.place = Some(place);
        let row = self.stress_row(&step, &scene, &mut steps.before, InjectedFault::None).await?;
        steps.scene = Some(scene);
        Ok(Some(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Progress;
    use crate::session::{CaptureRequest, Session};
    use crate::technique::Choice;

    const SIZE: [u32; 2] = [40, 30];

    #[test]
    fn heavy_rows_can_be_left_out() {
        let case = StressCase::named("triangle-count").expect("a case");
        let most = case.heavy_above.expect("a limit");
        let values = |steps: StressSteps| -> Vec<f64> { steps.left.iter().map(|(_, step)| step.value).collect() };
        let all = values(StressSteps::new(&[case], &[], SIZE));
        let light = values(StressSteps::new(&[case], &[], SIZE).without_heavy());
        assert!(all.iter().any(|value| *value > most));
        assert_eq!(light, all.into_iter().filter(|value| *value <= most).collect::<Vec<_>>());
        let other = StressCase::named("map-size").expect("a case");
        assert_eq!(
            StressSteps::new(&[other], &[], SIZE).without_heavy().left(),
            StressSteps::new(&[other], &[], SIZE).left()
        );
    }

    #[test]
    fn what_comes_between_two_rows_changes_none_of_them() {
        let mut session = Session::new(None).expect("the reference adapter");
        let cases = ["near-plane", "eye-in-volume", "map-size"].map(|name| StressCase::named(name).expect("a case"));
        let only = [Technique::ZFail, Technique::ZPass, Technique::ShadowMap];
        let progress = Progress::default();
        let whole = session.stress(&cases, &only, SIZE, &progress).expect("rows");
        let mut steps = StressSteps::new(&cases, &only, SIZE);
        assert_eq!((steps.left(), steps.next_case()), (whole.len(), Some((0, "near-plane"))));
        assert_eq!(progress.steps(), (whole.len(), whole.len()));
        let between = StressCase::named("nested").expect("a case").scene(2.0).expect("a scene");
        let request = CaptureRequest::new(Choice::new(Technique::ZFail), SIZE);
        for expected in &whole {
            let row = session.stress_step(&mut steps).expect("a row").expect("one is left");
            assert_eq!((row.case, row.parameter, row.entrant), (expected.case, expected.parameter, expected.entrant));
            assert_eq!((row.error, row.flips), (expected.error, expected.flips));
            let capture = session.capture(&between, &request).expect("a capture");
            session.truth(&between, &capture, &Progress::default()).expect("a truth");
        }
        assert_eq!((steps.left(), steps.next_case()), (0, None));
        assert_eq!(session.stress_step(&mut steps).expect("the end"), None);
        assert!(whole.iter().any(|row| row.flips.is_some()), "a motion is among them");
        progress.cancel();
        assert!(matches!(session.stress(&cases, &only, SIZE, &progress), Err(SessionError::Cancelled)));
    }
}
