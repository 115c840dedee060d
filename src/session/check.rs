//! Draws every built-in scene by every technique, to say whether the adapter draws as it should.

use super::diagnose::DiagnosisExtent;
use super::history::spread;
use super::truth::TracedScene;
use super::{AsyncSession, CaptureRequest, InjectedFault, SessionError, median, median_ms, milliseconds};
use crate::check::{
    AdapterCheck, CheckReference, CheckedHistories, CheckedRow, CheckedScene, DrawnRow, HISTORIES, HistoryDisagreement,
    LONG_FRAME_MS, LONGEST_DIAGNOSED_MS, LabelsHash, ReferenceScene, SIZE, TIMED_FRAMES, proven_causes,
};
use crate::diagnosis::Diagnosis;
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::builtin::Builtin;
use crate::technique::{Choice, Technique};
use std::collections::BTreeMap;

/// The most regions of a row that are diagnosed where it is compared with a reference.
const MOST_CHECKED_REGIONS: usize = 200;
/// How much more memory, bytes, a frame may take that is drawn to try a fix there: a software rasteriser needs minutes
/// for the largest maps. A picture 15 times as large takes less.
const MOST_OF_A_TRIAL: u64 = 3 << 26;

/// The technique whose histories are compared with the GPU: its counts go up and down, and nothing ends them early.
const HISTORIES_OF: Technique = Technique::ZFail;

impl AsyncSession {
    /// As [`Session::check`](super::Session::check).
    pub async fn check(
        &mut self,
        scenes: &[&Builtin],
        reference: &CheckReference,
        progress: &Progress,
    ) -> Result<AdapterCheck, SessionError> {
        progress.start(scenes.len() * (1 + Technique::rivals().len() + HISTORIES));
        let profile = self.profile().await?;
        let mut checked = Vec::with_capacity(scenes.len());
        for builtin in scenes {
            let scene = builtin.scene()?;
            let reference = reference.scene(builtin.name);
            checked.push(self.checked_scene(builtin.name, &scene, reference, progress).await?);
        }
        Ok(AdapterCheck {
            adapter: self.adapter().clone(),
            profile,
            reference_adapter: reference.adapter.clone(),
            reference_program: reference.program.clone(),
            scenes: checked,
        })
    }

    async fn checked_scene(
        &mut self,
        name: &str,
        scene: &Scene,
        reference: Option<&ReferenceScene>,
        progress: &Progress,
    ) -> Result<CheckedScene, SessionError> {
        // It has its own progress: the steps of the whole are truths, rows and histories.
        let traced = self.traced(scene, SIZE, &Progress::default()).await?;
        progress.advance();
        let (mut rows, mut histories) = (Vec::new(), None);
        for technique in Technique::rivals() {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            let reference = reference.and_then(|reference| reference.row(technique)).cloned();
            let request = CaptureRequest::new(Choice::new(technique), SIZE);
            let drawn = match self.drawn_row(scene, &request, &traced).await {
                Ok((drawn, plan)) => {
                    if technique == HISTORIES_OF {
                        histories = Some(self.checked_histories(scene, &plan, progress).await?);
                    }
                    Ok(drawn)
                }
                Err(error) => Err(in_words(error)?),
            };
            let mut row = CheckedRow { technique, drawn, reference };
            if row.is_beyond() {
                self.diagnose_row(&mut row, name, scene, &request).await?;
            }
            rows.push(row);
            progress.advance();
        }
        if histories.is_none() {
            (0..HISTORIES).for_each(|_| progress.advance());
        }
        let truth = traced.truth.labels.iter().map(|labels| Some([labels.as_slice()]));
        Ok(CheckedScene {
            scene: name.to_owned(),
            truth: LabelsHash::of(truth),
            reference_truth: reference.map(|reference| reference.truth),
            histories,
            rows,
        })
    }

    /// Draws a row, times it, and compares its labels with the truth. Returns the plan that was run, too.
    async fn drawn_row(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        traced: &TracedScene,
    ) -> Result<(DrawnRow, FramePlan), SessionError> {
        let plan = self.plan(scene, request).await?;
        let ready = self.executor.prepare_apart(&plan).await?;
        let first = self.executor.time(&ready, false).await?;
        let (mut frames, mut on_gpu) = (vec![first], Vec::new());
        if milliseconds(first) < LONG_FRAME_MS {
            // Work that only a first frame does is not timed.
            frames.clear();
            for _ in 0..TIMED_FRAMES {
                frames.push(self.executor.time(&ready, false).await?);
            }
            for _ in 0..TIMED_FRAMES {
                on_gpu.extend(self.executor.gpu_ms(&ready).await?);
            }
        }
        let labels = self.executor.labels(ready).await?;
        let mut errors = Vec::new();
        for (light, labels) in labels.iter().enumerate() {
            if let Some(labels) = labels {
                errors.push(traced.compare(&self.executor, light, labels).await.counts);
            }
        }
        let drawn = DrawnRow {
            labels: LabelsHash::of(labels.iter().map(|labels| labels.as_ref().map(|labels| labels.rows()))),
            error: errors.into_iter().sum(),
            frame_ms: median_ms(&frames).unwrap_or(f64::NAN),
            timed_frames: frames.len(),
            gpu_ms: median(on_gpu),
            causes: BTreeMap::new(),
            undiagnosed: None,
        };
        Ok((drawn, plan))
    }

    /// Finds the causes of a row's wrong pixels, unless it is too slow for that.
    async fn diagnose_row(
        &mut self,
        row: &mut CheckedRow,
        name: &str,
        scene: &Scene,
        request: &CaptureRequest,
    ) -> Result<(), SessionError> {
        let Ok(drawn) = &mut row.drawn else { return Ok(()) };
        // What a reference is made of takes the time that it needs.
        if row.reference.is_some() && drawn.frame_ms > LONGEST_DIAGNOSED_MS {
            let [width, height] = request.size;
            let technique = row.technique.name();
            drawn.undiagnosed = Some(format!(
                "a frame takes too long; `stencilscope diagnose {} -t {technique} --size {width}x{height}` tries it",
                name
            ));
            return Ok(());
        }
        // What a reference is made of is the largest regions' causes, whatever they take; beside one, a single pixel
        // among many small regions may be what is new.
        let has_reference = row.reference.is_some();
        let most_regions = if has_reference { MOST_CHECKED_REGIONS } else { Diagnosis::MOST_REGIONS };
        let extent = DiagnosisExtent { most_regions, has_advice: false };
        let budget = self.memory_budget;
        if has_reference {
            let most = self.plan(scene, request).await?.bytes() + MOST_OF_A_TRIAL;
            self.set_memory_budget(Some(budget.map_or(most, |budget| budget.min(most))));
        }
        let found = self.diagnose_as_far(scene, request, InjectedFault::None, extent, &Progress::default()).await;
        self.set_memory_budget(budget);
        match found {
            Ok(diagnosis) => drawn.causes = proven_causes(&diagnosis),
            Err(error) => drawn.undiagnosed = Some(in_words(error)?),
        }
        Ok(())
    }

    /// Compares histories of pixels that are spread over the picture with what the GPU counted and stored.
    async fn checked_histories(
        &mut self,
        scene: &Scene,
        plan: &FramePlan,
        progress: &Progress,
    ) -> Result<CheckedHistories, SessionError> {
        let capture = match self.capture_plan(scene, plan).await {
            Ok(capture) => capture,
            Err(error) => {
                (0..HISTORIES).for_each(|_| progress.advance());
                let failed = HistoryDisagreement { pixel: spread(0, plan.size), reason: in_words(error)? };
                return Ok(CheckedHistories { pixels: HISTORIES, disagreements: vec![failed] });
            }
        };
        let mut disagreements = Vec::new();
        for index in 0..HISTORIES {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            let pixel = spread(index, plan.size);
            let reason = match self.history(plan, &capture, pixel).await {
                Ok(history) => history.disagreements().first().map(ToString::to_string),
                Err(error) => Some(in_words(error)?),
            };
            disagreements.extend(reason.map(|reason| HistoryDisagreement { pixel, reason }));
            progress.advance();
        }
        Ok(CheckedHistories { pixels: HISTORIES, disagreements })
    }
}

/// Returns why something can't be drawn or answered, for the row that it is about; an error that ends the whole check
/// stays one.
fn in_words(error: SessionError) -> Result<String, SessionError> {
    match error {
        SessionError::Cancelled => Err(error),
        error => Ok(error.to_string()),
    }
}
