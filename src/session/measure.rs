//! Error against run time: several techniques on one scene, timed in turn.

use super::{Session, SessionError, median, milliseconds};
use crate::accuracy::ErrorCounts;
use crate::gpu::GpuError;
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::technique::{self, Choice, Job};
use std::time::{Duration, Instant};

/// What to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Techniques with their settings.
    pub choices: Vec<Choice>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Frames of each that are timed, after a warm-up.
    pub runs: usize,
}

/// How one technique did.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Technique and settings.
    pub choice: Choice,
    /// Errors, summed over lights.
    pub error: ErrorCounts,
    /// Wall times of frames without capture: recording, submitting, waiting.
    pub frames: Vec<Duration>,
    /// Median of the GPU's time for the frame's passes, measured in frames of their own between
    /// the others; `None` where the hardware can't measure it.
    pub gpu_ms: Option<f64>,
    /// Planning, geometry, pipelines and uploads of this technique.
    pub setup_ms: f64,
    /// Submitted in a frame.
    pub triangles: u64,
    /// GPU memory of attachments, vertices and indices.
    pub bytes: u64,
}

impl Session {
    /// Measures every choice on one scene. Frames are timed in turn, so that whatever slows the
    /// machine down for a while slows all alike.
    ///
    /// # Errors
    /// A scene that can't be drawn or traced, a lost GPU; [`SessionError::Cancelled`].
    pub fn measure(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        progress: &Progress,
    ) -> Result<Vec<Measured>, SessionError> {
        self.measure_between(scene, what, progress, &mut |_| ())
    }

    /// The same, with `between` called while the truth is traced and between any two steps after it:
    /// what it does is in no measured time.
    ///
    /// # Errors
    /// As [`Session::measure`].
    pub fn measure_between(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        progress: &Progress,
        between: &mut dyn FnMut(&mut Session),
    ) -> Result<Vec<Measured>, SessionError> {
        let traced = self.traced_between(scene, what.size, progress, between)?;
        let mut go_on = |session: &mut Session| {
            between(session);
            if progress.is_cancelled() { Err(SessionError::Cancelled) } else { Ok(()) }
        };
        progress.start(what.choices.len() * (what.runs + 2));
        let plans = self.plans(scene, what)?;
        check_memory(&plans)?;
        let mut prepared = Vec::with_capacity(plans.len());
        let mut setups = Vec::with_capacity(plans.len());
        for (plan, planned) in &plans {
            go_on(self)?;
            self.executor.forget();
            let start = Instant::now();
            let ready = self.executor.prepare(plan)?;
            setups.push(milliseconds(start.elapsed() + *planned));
            self.executor.time(&ready, false)?;
            prepared.push(ready);
            progress.advance();
        }
        let mut frames = vec![Vec::with_capacity(what.runs); plans.len()];
        let mut gpu: Vec<Vec<f64>> = vec![Vec::with_capacity(what.runs); plans.len()];
        for _ in 0..what.runs {
            for ((ready, frames), gpu) in prepared.iter().zip(&mut frames).zip(&mut gpu) {
                go_on(self)?;
                frames.push(self.executor.time(ready, false)?);
                gpu.extend(self.executor.gpu_ms(ready)?);
                progress.advance();
            }
        }
        let mut measured = Vec::with_capacity(plans.len());
        let timed = frames.into_iter().zip(gpu.into_iter().map(median)).zip(setups);
        for (((choice, (plan, _)), ready), ((frames, gpu_ms), setup_ms)) in
            what.choices.iter().zip(&plans).zip(prepared).zip(timed)
        {
            go_on(self)?;
            let labels = self.executor.labels(ready)?;
            let labels = labels.iter().enumerate();
            let error = labels.filter_map(|(light, labels)| Some(traced.compare(light, labels.as_ref()?).counts)).sum();
            let (triangles, bytes) = (plan.triangles(), plan.bytes());
            measured.push(Measured { choice: choice.clone(), error, frames, gpu_ms, setup_ms, triangles, bytes });
            progress.advance();
        }
        Ok(measured)
    }

    /// The plan of every choice, and how long it took to make. Nothing is kept from one to the
    /// next, so that none is set up at another's cost.
    fn plans(&mut self, scene: &Scene, what: &Measurement) -> Result<Vec<(FramePlan, Duration)>, SessionError> {
        let plan = |choice: &Choice| {
            let start = Instant::now();
            let cache = &mut crate::geometry::GeometryCache::default();
            let plan = technique::plan(Job { scene, size: what.size, choice, cache })?;
            let plan = self.without_unseen(plan)?;
            Ok((plan, start.elapsed()))
        };
        what.choices.iter().map(plan).collect()
    }
}

/// All rows stay on the GPU while they are timed in turn.
fn check_memory(plans: &[(FramePlan, Duration)]) -> Result<(), SessionError> {
    let needed: u64 = plans.iter().map(|(plan, _)| plan.bytes()).sum();
    if needed <= GpuError::MOST_BYTES {
        return Ok(());
    }
    let [needed, most] = [needed, GpuError::MOST_BYTES].map(|bytes| format!("{} MiB", bytes >> 20));
    Err(GpuError::TooLarge { what: "the report, whose frames are timed in turn,".to_owned(), needed, most }.into())
}
