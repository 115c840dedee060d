//! Which techniques are right for a scene: each is run on it.

use super::truth::TracedScene;
use super::{AsyncSession, CaptureRequest, SessionError, median_ms};
use crate::diagnosis::TechniqueFit;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::technique::Choice;
use std::time::Duration;

/// Frames of each technique that are timed, after one that is not.
const RUNS: usize = 3;
/// If the first frame takes as long as this, only one more is timed.
const LONG: Duration = Duration::from_millis(500);

impl AsyncSession {
    /// As [`Session::suited`](super::Session::suited).
    pub async fn suited(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        progress: &Progress,
    ) -> Result<Vec<TechniqueFit>, SessionError> {
        let traced = self.traced(scene, size, progress).await?;
        let choices = TechniqueFit::candidates();
        progress.start(choices.len());
        let mut suited = Vec::with_capacity(choices.len());
        for choice in choices {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            match self.tried_on(scene, &traced, choice).await {
                Ok(one) => suited.push(one),
                Err(SessionError::Plan(_) | SessionError::Gpu(_) | SessionError::OverBudget { .. }) => {}
                Err(error) => return Err(error),
            }
            progress.advance();
        }
        suited.sort_by(|a, b| a.wrong.cmp(&b.wrong).then(a.frame_ms.total_cmp(&b.frame_ms)));
        Ok(suited)
    }

    async fn tried_on(
        &mut self,
        scene: &Scene,
        traced: &TracedScene,
        choice: Choice,
    ) -> Result<TechniqueFit, SessionError> {
        let plan = self.plan(scene, &CaptureRequest::new(choice.clone(), traced.truth.size)).await?;
        self.check_memory_budget(&plan)?;
        let ready = self.executor.prepare_apart(&plan).await?;
        let runs = if self.executor.time(&ready, false).await? >= LONG { 1 } else { RUNS };
        let mut frames = Vec::with_capacity(runs);
        for _ in 0..runs {
            frames.push(self.executor.time(&ready, false).await?);
        }
        let mut wrong = 0;
        for (light, labels) in self.executor.labels(ready).await?.iter().enumerate() {
            if let Some(labels) = labels {
                wrong += traced.compare(&self.executor, light, labels).await.counts.wrong();
            }
        }
        let frame_ms = median_ms(&frames).unwrap_or(f64::INFINITY);
        Ok(TechniqueFit { wrong, frame_ms, choice })
    }
}
