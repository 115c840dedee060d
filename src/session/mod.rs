//! The one place that runs things: scene and technique in, data out.
//!
//! A session owns the GPU and the caches between runs (pipelines, buffers, edge lists). Commands, the window and tests
//! all go through it. What it does is written once, async, in [`AsyncSession`]; [`Session`] blocks on that.

mod anatomy;
mod answer;
#[cfg(not(target_family = "wasm"))]
mod blocking;
mod check;
mod counts;
mod diagnose;
mod diagnose_recorded;
mod draws;
mod fixed_frame;
mod history;
mod measure;
mod rays;
mod recomputation;
mod reference;
mod report;
mod step_tests;
mod stress;
mod stress_steps;
mod suited;
mod sweep;
mod trials;
mod truth;
mod volumes;

pub use crate::gpu::GpuError;
#[cfg(feature = "inspector")]
pub(crate) use crate::gpu::MEMORY_HINTS;
pub use answer::{FrameSource, RunFrame};
#[cfg(not(target_family = "wasm"))]
pub use blocking::Session;
pub use draws::SnapshotInterval;
pub use history::HistoryCost;
pub use measure::{MeasuredTechnique, Measurement, MotionFrames, MovingPart};
pub use report::report_rows;
pub use stress::InjectedFault;
pub use stress_steps::StressSteps;
pub use sweep::{Sweep, SweepBlock};
pub use truth::{TruthCost, truth_cost};
pub use volumes::{VolumeCost, volume_cost};

use crate::capture::{AdapterInfo, AdapterProfile, Capture, CapturedLight, CapturedMap, StoredQuantity, Timing};
use crate::diagnosis::TruthCoverage;
use crate::geometry::{GeometryCache, Topology};
use crate::gpu::{Executor, ExecutorOutput, GpuContext, Prepared, SnapshotMemory};
use crate::plan::{FramePlan, LeftOut};
use crate::scene::{Mesh, Object, Scene, WallCache};
use crate::technique::{self, Choice, ChoiceError, PlanError, PlanRequest};
use crate::truth::TruthError;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use web_time::Instant;

/// The inputs of a capture.
#[derive(Debug, Clone, PartialEq)]
pub struct CaptureRequest {
    /// Technique and settings.
    pub choice: Choice,
    /// Width and height in pixels, each at least 1.
    pub size: [u32; 2],
    /// How often to time the frame with and without snapshots, in turn, after a warm-up; 0: not at all, and the timing
    /// is left unknown.
    pub timing_runs: usize,
    /// How often to take a snapshot.
    pub every: SnapshotInterval,
    /// Brackets the frame for an attached graphics debugger.
    pub external_capture: bool,
}

impl CaptureRequest {
    /// Returns a request of an untimed capture with a snapshot after every pass.
    pub fn new(choice: Choice, size: [u32; 2]) -> CaptureRequest {
        CaptureRequest { choice, size, timing_runs: 0, every: SnapshotInterval::Pass, external_capture: false }
    }
}

/// Why a session has no answer.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The settings of a capture are not those of its technique.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// The scene can't be drawn.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The GPU is missing, too small or failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// All draws of the frame, or of one of its passes, are too many to store the state after each.
    #[error("{0}; or take fewer snapshots (--every pass)")]
    TooManyDraws(GpuError),
    /// No ray can be followed through the scene.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// The picture does not have this pixel.
    #[error("pixel {},{} is outside the picture of {}x{}: choose one from 0,0 to {},{}", pixel[0], pixel[1], size[0], size[1], size[0].saturating_sub(1), size[1].saturating_sub(1))]
    NoSuchPixel {
        /// Column and row of the pixel.
        pixel: [u32; 2],
        /// Width and height of the picture.
        size: [u32; 2],
    },
    /// The frame does not have this step.
    #[error("there is no step {}: choose one from 1 to {steps}", step + 1)]
    NoSuchStep {
        /// Index of the step.
        step: usize,
        /// The number of steps.
        steps: usize,
    },
    /// The question has no answer, for the reason given in words.
    #[error("{0}")]
    Unanswered(String),
    /// The question is about a frame that is no longer shown.
    #[error("another picture came meanwhile: diagnose again when it is the one you want")]
    OtherFrame,
    /// There is no frame to ask about.
    #[error("the open scene was not rendered: fix what the error says, then ask again")]
    NoFrame,
    /// The answer needs lights that were not found.
    #[error("another program drew this frame, and neither shadow volumes nor a shadow map tell where its light is")]
    NoLights,
    /// Nothing of a frame may be called right or wrong.
    #[error("another program drew this frame, and too little of it can be compared: {} ({})", .0.why_too_little(), .0.in_words())]
    TooLittleCompared(TruthCoverage),
    /// The answer needs a scene.
    #[error("another program drew this frame, and there is no scene that it could be drawn from anew")]
    NoScene,
    /// The fragments of a step can't be counted.
    #[error("step {} draws no triangles into the picture: select one that does", step + 1)]
    NoTests {
        /// Index of the step.
        step: usize,
    },
    /// It would take more than the [memory budget](Session::set_memory_budget).
    #[error("it takes {} MiB, and no more than {} MiB are tried here: `stencilscope diagnose` tries it", needed >> 20, most >> 20)]
    OverBudget {
        /// Bytes of GPU memory that it needs.
        needed: u64,
        /// Bytes of GPU memory that it may take.
        most: u64,
    },
    /// A fix can't be applied.
    #[error(transparent)]
    Fix(#[from] crate::diagnosis::FixError),
    /// A scene that code builds is broken.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl SessionError {
    /// Returns whether there is no GPU to run on: something to install, not to correct.
    pub fn is_missing_adapter(&self) -> bool {
        matches!(self, SessionError::Gpu(GpuError::NoAdapter { .. } | GpuError::NoDevice { .. }))
    }
}

/// A [`Session`] whose methods are futures: for a browser, and for programs that have an executor of their own.
///
/// In a browser a future gives way while it waits for the GPU, and every few milliseconds while it computes. Natively
/// it holds up its thread until it is ready, which it is when it is first polled, and stays on that thread. A future
/// that is dropped half-way leaves the session usable.
#[derive(Debug)]
pub struct AsyncSession {
    executor: Executor,
    geometry: GeometryCache,
    traced: Option<Arc<truth::TracedScene>>,
    /// The truth of the scene to which a stress case converges.
    limit: Option<Arc<truth::TracedScene>>,
    /// The frame's scene whose rays were asked for last.
    followed: Option<rays::FollowedScene>,
    memory_budget: Option<u64>,
    /// Whether what a plan computed of its meshes is kept for the next.
    holds_geometry: bool,
    walls: WallCache,
}

/// Times of a frame, with and without snapshots.
#[derive(Debug, Clone, PartialEq)]
pub struct CaptureCost {
    /// Frames without snapshots.
    pub frames: Vec<Duration>,
    /// Frames with a snapshot after every pass, all in memory; empty where they don't [fit](Session::hold_at_most).
    pub captured: Vec<Duration>,
    /// Bytes that a captured frame copies.
    pub snapshot_bytes: u64,
}

impl AsyncSession {
    /// As [`Session::new`].
    pub async fn new(adapter: Option<&str>) -> Result<AsyncSession, SessionError> {
        let context = GpuContext::new(adapter).await?;
        Ok(AsyncSession {
            executor: Executor::new(context),
            geometry: GeometryCache::default(),
            traced: None,
            limit: None,
            followed: None,
            memory_budget: None,
            holds_geometry: true,
            walls: WallCache::default(),
        })
    }

    /// As [`Session::hold_at_most`].
    pub fn hold_at_most(&mut self, bytes: u64) {
        self.executor.hold_at_most(bytes);
    }

    /// As [`Session::set_memory_budget`].
    pub fn set_memory_budget(&mut self, bytes: Option<u64>) {
        self.memory_budget = bytes;
    }

    /// As [`Session::hold_geometry`].
    pub fn hold_geometry(&mut self, holds: bool) {
        self.holds_geometry = holds;
    }

    /// As [`Session::forget`].
    pub fn forget(&mut self) {
        self.executor.forget();
        self.geometry = GeometryCache::default();
        self.traced = None;
        self.limit = None;
        self.followed = None;
    }

    /// As [`Session::passed_over`].
    pub fn passed_over(&self) -> impl Iterator<Item = String> {
        self.executor.context().passed_over.iter().map(|error| format!("{error}; using {}", self.adapter().name))
    }

    /// As [`Session::adapter`].
    pub fn adapter(&self) -> &AdapterInfo {
        &self.executor.context().info
    }

    /// As [`Session::profile`].
    pub async fn profile(&mut self) -> Result<AdapterProfile, SessionError> {
        Ok(self.executor.profile().await?)
    }

    /// As [`Session::features`].
    pub fn features(&self) -> Vec<&'static str> {
        self.executor.features()
    }

    /// As [`Session::plan`].
    pub async fn plan(&mut self, scene: &Scene, request: &CaptureRequest) -> Result<FramePlan, SessionError> {
        let job = PlanRequest {
            scene,
            size: request.size,
            choice: &request.choice,
            cache: &mut self.geometry,
            map_camera: None,
        };
        let plan = technique::plan(job)?;
        self.drawable(plan, &request.choice).await
    }

    /// Returns the plan with what the adapter does not draw exactly clipped away, and without the draws that show
    /// nothing, for which it runs once, where the settings ask for that.
    async fn drawable(&mut self, plan: FramePlan, choice: &Choice) -> Result<FramePlan, SessionError> {
        let plan = self.executor.clipped(plan).await?;
        if !choice.common().asks_what_shows {
            return Ok(plan);
        }
        let prepared = self.executor.prepare(&plan).await?;
        let samples = self.executor.samples(&prepared).await?;
        drop(prepared);
        Ok(plan.without_unseen(&samples))
    }

    /// As [`Session::topologies`].
    pub fn topologies(&mut self, scene: &Scene) -> Vec<(String, Arc<Topology>)> {
        let one = |object: &Object| (object.name.clone(), self.topology(&object.mesh));
        scene.objects.iter().map(one).collect()
    }

    /// As [`Session::topology`].
    pub fn topology(&mut self, mesh: &Arc<Mesh>) -> Arc<Topology> {
        self.geometry.topology(mesh)
    }

    /// As [`Session::capture`].
    pub async fn capture(&mut self, scene: &Scene, request: &CaptureRequest) -> Result<Capture, SessionError> {
        Ok(self.capture_with_plan(scene, request).await?.0)
    }

    /// As [`Session::render`].
    pub async fn render(&mut self, scene: Scene, request: CaptureRequest) -> Result<RunFrame, SessionError> {
        let (capture, plan) = self.capture_with_plan(&scene, &request).await?;
        let source = Some(Arc::new(FrameSource { scene, request: Some(request) }));
        Ok(RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source })
    }

    /// As [`Session::preview`].
    pub async fn preview(&mut self, scene: Scene, request: CaptureRequest) -> Result<RunFrame, SessionError> {
        let start = Instant::now();
        let plan = self.plan(&scene, &request).await?;
        let drawn = self.executor.without_small_triangles(&plan).await?;
        let prepared = self.executor.prepare(drawn.as_ref().unwrap_or(&plan)).await?;
        let timing = Timing { setup_ms: Some(milliseconds(start.elapsed())), ..Timing::default() };
        let output = self.executor.capture(prepared, SnapshotMemory::Mapped, false).await?;
        let capture = self.assemble(&scene, &plan, output, timing);
        let source = Some(Arc::new(FrameSource { scene, request: Some(request) }));
        Ok(RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source })
    }

    /// As [`Session::capture_with_plan`].
    pub async fn capture_with_plan(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
    ) -> Result<(Capture, FramePlan), SessionError> {
        let start = Instant::now();
        let plan = self.plan(scene, request).await?;
        if !self.holds_geometry {
            self.geometry = GeometryCache::default();
        }
        let prepared = self.executor.prepare(&plan).await?;
        let setup = start.elapsed();
        let mut timing = Timing { setup_ms: Some(milliseconds(setup)), ..Timing::default() };
        if request.timing_runs > 0 {
            let cost = self.cost_of(&prepared, request.timing_runs).await?;
            timing.frame_ms = median_ms(&cost.frames);
            timing.captured_ms = median_ms(&cost.captured);
        }
        let output = match request.every {
            SnapshotInterval::Pass => {
                self.executor.capture(prepared, SnapshotMemory::Mapped, request.external_capture).await?
            }
            SnapshotInterval::Draw => {
                drop(prepared);
                self.run_by_draw(&plan, request.external_capture).await?
            }
        };
        Ok((self.assemble(scene, &plan, output, timing), plan))
    }

    /// As [`Session::capture_plan`].
    pub async fn capture_plan(&mut self, scene: &Scene, plan: &FramePlan) -> Result<Capture, SessionError> {
        let prepared = self.executor.prepare(plan).await?;
        let output = self.executor.capture(prepared, SnapshotMemory::Mapped, false).await?;
        Ok(self.assemble(scene, plan, output, Timing::default()))
    }

    /// As [`Session::capture_cost`].
    pub async fn capture_cost(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        runs: usize,
    ) -> Result<CaptureCost, SessionError> {
        let plan = self.plan(scene, request).await?;
        let prepared = self.executor.prepare(&plan).await?;
        self.cost_of(&prepared, runs).await
    }

    async fn cost_of(&self, prepared: &Prepared<'_>, runs: usize) -> Result<CaptureCost, SessionError> {
        let snapshot_bytes = prepared.snapshot_bytes();
        let mut cost = CaptureCost { frames: Vec::new(), captured: Vec::new(), snapshot_bytes };
        let holds_all = prepared.holds_all_snapshots();
        let captured = async || match holds_all {
            true => self.executor.time(prepared, true).await.map(Some),
            false => Ok(None),
        };
        self.executor.time(prepared, false).await?;
        captured().await?;
        for _ in 0..runs {
            cost.frames.push(self.executor.time(prepared, false).await?);
            cost.captured.extend(captured().await?);
        }
        Ok(cost)
    }

    fn assemble(&self, scene: &Scene, plan: &FramePlan, output: ExecutorOutput, timing: Timing) -> Capture {
        let cached = plan.passes.iter().zip(&output.from_cache).filter(|(_, is_cached)| **is_cached);
        let left_out = plan.left_out.iter().cloned().chain(cached.map(|(pass, _)| LeftOut::cached(pass))).collect();
        let lights = scene.lights.iter().zip(&plan.lights).zip(output.of_lights.into_iter().zip(output.maps));
        let lights = lights.map(|((light, planned), (of_light, faces))| CapturedLight {
            position: light.position,
            of_casters: BTreeMap::new(),
            decided_by: planned.decided_by,
            count_of: planned.count_of,
            shadow: of_light.labels,
            count: of_light.count,
            visibility: of_light.visibility,
            map: faces.zip(planned.map.as_ref()).map(|(faces, map)| CapturedMap {
                faces,
                layer_names: map.layer_names.clone(),
                light_from_world: map.light_from_world,
                clip_from_light: map.clip_from_light.clone(),
                quantity: StoredQuantity::Depth,
            }),
            truth: None,
        });
        Capture {
            scene: scene.name.clone(),
            technique: plan.technique.clone(),
            settings: plan.settings.clone(),
            size: plan.size,
            adapter: self.adapter().clone(),
            profile: self.executor.measured_profile(),
            camera: scene.camera,
            depth: plan.depth,
            steps: output.steps,
            lights: lights.collect(),
            left_out,
            timing,
            plan_text: plan.to_string(),
            origin: None,
        }
    }
}

/// Returns the median of durations in milliseconds (the mean of the middle two); `None` for none.
pub fn median_ms(durations: &[Duration]) -> Option<f64> {
    median(durations.iter().copied().map(milliseconds).collect())
}

/// Returns the median of numbers (the mean of the middle two); `None` for none.
fn median(mut sorted: Vec<f64>) -> Option<f64> {
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    let upper = *sorted.get(middle)?;
    Some(if sorted.len() % 2 == 1 { upper } else { (sorted[middle - 1] + upper) / 2.0 })
}

pub(crate) fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Draw;
    use crate::scene::{Light, OpenSpec, shapes};
    use crate::technique::Technique;
    use pollster::block_on;

    #[test]
    fn a_preview_is_given_few_of_many_triangles_and_all_where_they_are_large() {
        let mut session = block_on(AsyncSession::new(None)).expect("a GPU");
        let mut drawn = |around: u32, size: [u32; 2]| {
            let ring = Object::of("ring", shapes::torus(1.0, 0.4, around, around / 2).expect("a ring"));
            let mut scene = crate::scene::open(&OpenSpec::new("tori")).expect("a built-in scene");
            (scene.objects, scene.lights) = (vec![ring], vec![Light::point([0.5, 3.0, 1.0])]);
            let request = CaptureRequest::new(Choice::new(Technique::ShadowMap), size);
            let plan = block_on(session.plan(&scene, &request)).expect("a plan");
            let given = block_on(session.executor.without_small_triangles(&plan)).expect("a GPU");
            let count = |plan: &FramePlan, of: fn(&Draw) -> usize| {
                let ambient = plan.passes.iter().find(|pass| pass.name == "ambient");
                ambient.map_or(0, |pass| pass.draws.iter().map(of).sum::<usize>())
            };
            let all = count(&plan, |draw| draw.triangles.len());
            (all, given.map(|given| count(&given, |draw| draw.rasterised().triangles.len())))
        };
        let (all, given) = drawn(400, [64, 48]);
        assert!(given.is_some_and(|given| given > 100 && given < all / 8), "{given:?} of {all}");
        assert_eq!(drawn(48, [640, 480]).1, None, "few and large");
    }
}
