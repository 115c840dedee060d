//! The session for programs without an executor of futures: a method blocks its thread until the future of that name is
//! ready. A browser has none of this, as nothing may block there.

use super::{
    AsyncSession, CaptureCost, CaptureRequest, HistoryCost, InjectedFault, MeasuredTechnique, Measurement,
    MotionFrames, RunFrame, SessionError, StressSteps,
};
use crate::anatomy::Anatomy;
use crate::ask::{Answer, Ask};
use crate::capture::{AdapterInfo, AdapterProfile, Capture, FrameTruth, Image, StepDraws, StepTests};
use crate::check::{AdapterCheck, CheckReference};
use crate::diagnosis::frame_causes::FrameDiagnosis;
use crate::diagnosis::{Diagnosis, Fix, TechniqueFit};
use crate::geometry::Topology;
use crate::history::PixelHistory;
use crate::plan::{FramePlan, LightChannel};
use crate::progress::Progress;
use crate::reading::light_rays::LightRay;
use crate::scene::builtin::Builtin;
use crate::scene::{Mesh, Scene};
use crate::stress::{Entrant, StressCase, StressRow};
use crate::technique::{Choice, Technique};
use bytemuck::TransparentWrapper;
use pollster::block_on;
use std::sync::Arc;

/// A GPU, and what is cached between runs.
///
/// Its methods block their thread while the GPU works; those of an [`AsyncSession`] are the same without that.
// A wrapper in place: what is called between the steps of a measurement gets the session that measures.
#[derive(Debug, TransparentWrapper)]
#[repr(transparent)]
pub struct Session(AsyncSession);

impl Session {
    /// Opens the GPU whose name contains `adapter` (in any case), or, with `None`, one of the fastest kind there is; an
    /// error where there is none.
    pub fn new(adapter: Option<&str>) -> Result<Session, SessionError> {
        Ok(Session(block_on(AsyncSession::new(adapter))?))
    }

    /// Limits the bytes that a frame may take: attachments, pictures of materials, and of a captured frame the
    /// snapshots that differ; meshes are not counted. At first 8 GiB.
    pub fn hold_at_most(&mut self, bytes: u64) {
        self.0.hold_at_most(bytes);
    }

    /// Limits the bytes of GPU memory of frames that are not shown: rows of a report, and fixes that are tried. `None`,
    /// as at first, allows what the GPU has. For a GPU whose memory is this program's own.
    pub fn set_memory_budget(&mut self, bytes: Option<u64>) {
        self.0.set_memory_budget(bytes);
    }

    /// Says whether what a plan computed of its meshes (edges, planes, proofs) is kept for the next, as it is at first: for
    /// one frame of millions of triangles it is memory that nothing asks for.
    pub fn hold_geometry(&mut self, holds: bool) {
        self.0.hold_geometry(holds);
    }

    /// Drops all that is cached between runs: meshes' edges and planes, buffers, pipelines, the traced scene.
    pub fn forget(&mut self) {
        self.0.forget();
    }

    /// Returns a sentence for each adapter before this one that gave no device.
    pub fn passed_over(&self) -> impl Iterator<Item = String> {
        self.0.passed_over()
    }

    /// Returns the name, backend and driver of the GPU that the session runs on.
    pub fn adapter(&self) -> &AdapterInfo {
        self.0.adapter()
    }

    /// Returns how exactly the adapter draws, measured when it is first asked for.
    ///
    /// # Errors
    /// A lost GPU.
    pub fn profile(&mut self) -> Result<AdapterProfile, SessionError> {
        block_on(self.0.profile())
    }

    /// Returns which optional features the GPU was asked for, in plain words: none until a plan needs one.
    pub fn features(&self) -> Vec<&'static str> {
        self.0.features()
    }

    /// Returns the frame as data, without running it; but with `occlusion=queries` it runs once to find the draws that
    /// show nothing, which are left out.
    pub fn plan(&mut self, scene: &Scene, request: &CaptureRequest) -> Result<FramePlan, SessionError> {
        block_on(self.0.plan(scene, request))
    }

    /// Returns the name of each object with the topology of its mesh, in the scene's order; cached by mesh.
    pub fn topologies(&mut self, scene: &Scene) -> Vec<(String, Arc<Topology>)> {
        self.0.topologies(scene)
    }

    /// Returns the topology of a mesh: whether it is closed, manifold and consistently wound.
    pub fn topology(&mut self, mesh: &Arc<Mesh>) -> Arc<Topology> {
        self.0.topology(mesh)
    }

    /// Renders `scene` and returns every attachment after every pass, or after every draw. Only the frame with a
    /// snapshot after every pass is timed.
    pub fn capture(&mut self, scene: &Scene, request: &CaptureRequest) -> Result<Capture, SessionError> {
        block_on(self.0.capture(scene, request))
    }

    /// Renders a scene, and returns capture, plan and source: all that questions can be asked about.
    pub fn render(&mut self, scene: Scene, request: CaptureRequest) -> Result<RunFrame, SessionError> {
        block_on(self.0.render(scene, request))
    }

    /// Renders a scene that is shown for a moment, as while a light is dragged: what [`Session::render`] returns with a
    /// snapshot after every pass, sooner. The times of its passes are less than the frame's, as triangles are left out that
    /// cover no pixel.
    pub fn preview(&mut self, scene: Scene, request: CaptureRequest) -> Result<RunFrame, SessionError> {
        block_on(self.0.preview(scene, request))
    }

    /// Renders `scene` and returns the capture with the plan that was run, which [`Session::history`] needs.
    pub fn capture_with_plan(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
    ) -> Result<(Capture, FramePlan), SessionError> {
        block_on(self.0.capture_with_plan(scene, request))
    }

    /// Runs a finished plan, such as a good one with one thing changed, and returns its capture with a snapshot after
    /// each pass, untimed. `scene` gives the camera and lights of the capture.
    pub fn capture_plan(&mut self, scene: &Scene, plan: &FramePlan) -> Result<Capture, SessionError> {
        block_on(self.0.capture_plan(scene, plan))
    }

    /// Times the frame with and without snapshots, in turn, after a warm-up of each.
    pub fn capture_cost(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        runs: usize,
    ) -> Result<CaptureCost, SessionError> {
        block_on(self.0.capture_cost(scene, request, runs))
    }

    /// Runs the frame and returns the states after the draws of one step of `capture`, which is the capture of `plan`;
    /// images equal to known ones are shared.
    pub fn step_draws(&mut self, plan: &FramePlan, capture: &Capture, step: usize) -> Result<StepDraws, SessionError> {
        block_on(self.0.step_draws(plan, capture, step))
    }

    /// Captures a frame of our own with one channel of its light alone: all four, added in linear light, are the whole.
    pub fn capture_channel(&mut self, frame: &RunFrame, channel: LightChannel) -> Result<Capture, SessionError> {
        block_on(self.0.capture_channel(frame, channel))
    }

    /// Follows the ray from each light to the surface at a pixel of a frame of our own; none where no surface is there. The
    /// scene is prepared for it once for all pixels.
    pub fn light_rays(&mut self, frame: &RunFrame, pixel: [u32; 2]) -> Result<Vec<LightRay>, SessionError> {
        self.0.light_rays(frame, pixel)
    }

    /// Returns everything that happened to `pixel` in the frame of `plan`, of which `capture` is the result.
    pub fn history(
        &mut self,
        plan: &FramePlan,
        capture: &Capture,
        pixel: [u32; 2],
    ) -> Result<PixelHistory, SessionError> {
        block_on(self.0.history(plan, capture, pixel))
    }

    /// Times the histories of `count` pixels, spread evenly over the picture, after a first one, which is timed apart.
    pub fn history_cost(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        count: usize,
    ) -> Result<HistoryCost, SessionError> {
        block_on(self.0.history_cost(scene, request, count))
    }

    /// Returns the test results of the fragments of a step of `plan`, or of one of its draws.
    pub fn step_tests(
        &mut self,
        plan: &FramePlan,
        step: usize,
        draw: Option<usize>,
    ) -> Result<StepTests, SessionError> {
        block_on(self.0.step_tests(plan, step, draw))
    }

    /// Returns the ground truth of a capture of `scene`, and how the technique differs from it, for each light (`None`
    /// for one without a mask); also the signed counts of volumes where the technique counts in the stencil.
    pub fn truth(&mut self, scene: &Scene, capture: &Capture, progress: &Progress) -> Result<FrameTruth, SessionError> {
        block_on(self.0.truth(scene, capture, progress))
    }

    /// Returns a copy of the capture of `scene` with its truth added.
    pub fn judged(&mut self, scene: &Scene, capture: &Capture, progress: &Progress) -> Result<Capture, SessionError> {
        block_on(self.0.judged(scene, capture, progress))
    }

    /// Returns the signed count of each light's volumes where the technique counts them in the stencil: the same frame
    /// is run again with a float target. `None` for each light of a technique that counts nothing, or on an adapter
    /// that can't blend floats.
    pub fn counts(&mut self, scene: &Scene, capture: &Capture) -> Result<Vec<Option<Arc<Image>>>, SessionError> {
        block_on(self.0.counts(scene, capture))
    }

    /// Returns the parts of the frame of `plan` in space: of `scene` as it was captured, and planned as `choice` says;
    /// `None` for a frame that another program drew.
    pub fn anatomy(&mut self, scene: &Scene, choice: Option<&Choice>, plan: &FramePlan) -> Anatomy {
        self.0.anatomy(scene, choice, plan)
    }

    /// Renders the frame with the fault and then the fix applied, and returns its capture and plan: to show before and
    /// after.
    pub fn capture_fixed(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault,
        fix: &Fix,
    ) -> Result<(Capture, FramePlan), SessionError> {
        block_on(self.0.capture_fixed(scene, request, fault, fix))
    }

    /// Says where a frame is wrong, why, and what fixes it, and proves each fix by running the frame with it. `fault`
    /// is injected into the frame and not into its truth, and no rule reads it; [`InjectedFault::None`] for scenes as
    /// they are.
    ///
    /// # Errors
    /// A scene that can't be drawn or traced, a lost GPU; [`SessionError::Cancelled`]. A fix that can't run is no
    /// error: its proof says `not run`.
    pub fn diagnose(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault,
        progress: &Progress,
    ) -> Result<Diagnosis, SessionError> {
        block_on(self.0.diagnose(scene, request, fault, progress))
    }

    /// Says where another program's frame is wrong and why, and proves it by running its plan with one thing changed.
    ///
    /// # Errors
    /// A plan that can't run; [`SessionError::Cancelled`]. Where its lights were not found there is no verdict, and no error.
    pub fn diagnose_recorded(&mut self, frame: &RunFrame, progress: &Progress) -> Result<FrameDiagnosis, SessionError> {
        block_on(self.0.diagnose_recorded(frame, progress))
    }

    /// Computes each draw of another program's frame again, from what was stored before it, and returns the capture
    /// with the number of pixels at which depth or stencil differ from what was stored. Draws without a stored state,
    /// or beside the picture, are passed over.
    pub fn compared_with_rerun(
        &mut self,
        plan: &FramePlan,
        capture: &Capture,
        progress: &Progress,
    ) -> Result<Capture, SessionError> {
        block_on(self.0.compared_with_rerun(plan, capture, progress))
    }

    /// Answers a question about `frame`, or about `scene` as it was opened, if there is one. A report and stress cases
    /// take many steps: callers run those themselves, so that other work can come between.
    pub fn answer(
        &mut self,
        ask: &Ask,
        scene: Option<&Scene>,
        frame: Option<&RunFrame>,
        progress: &Progress,
    ) -> Result<Answer, SessionError> {
        block_on(self.0.answer(ask, scene, frame, progress))
    }

    /// Limits the memory of trials to what is free beside the frame of `plan`, which is shown.
    pub fn free_memory_for(&mut self, plan: &FramePlan) {
        self.0.free_memory_for(plan);
    }

    /// Measures every choice on one scene. Frames are timed in turn, so that whatever slows the machine down for a
    /// while slows all alike. Not all are in memory at once: the larger ones are set up again for each of their frames,
    /// outside its time. Choices that exceed the [memory budget](Session::set_memory_budget) are left out.
    pub fn measure(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        progress: &Progress,
    ) -> Result<Vec<MeasuredTechnique>, SessionError> {
        block_on(self.0.measure(scene, what, progress))
    }

    /// Measures every choice on one scene, with `between` called between parts of the truth's tracing and between any two steps
    /// after it, with what is measured so far, at first by one frame each: the time of these calls is in no measured time.
    pub fn measure_between(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        progress: &Progress,
        between: &mut dyn FnMut(&mut Session, &[MeasuredTechnique]),
    ) -> Result<Vec<MeasuredTechnique>, SessionError> {
        let between = &mut async |session: &mut AsyncSession, so_far: &[MeasuredTechnique]| {
            between(Session::wrap_mut(session), so_far);
        };
        block_on(self.0.measure_between(scene, what, progress, between))
    }

    /// Measures every choice on a scene that moves: what a frame must set up again is timed beside it, and what stays
    /// valid from frame to frame is cached, by each choice for itself. Errors are those of all frames together.
    pub fn measure_moving(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        motion: MotionFrames,
        progress: &Progress,
    ) -> Result<Vec<MeasuredTechnique>, SessionError> {
        block_on(self.0.measure_moving(scene, what, motion, progress))
    }

    /// Runs every candidate on a scene, and returns all of them, those with the fewest wrong pixels first, of equal
    /// ones the fastest. Those that can't draw the scene, or need too much memory, are left out.
    pub fn suited(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        progress: &Progress,
    ) -> Result<Vec<TechniqueFit>, SessionError> {
        block_on(self.0.suited(scene, size, progress))
    }

    /// Runs values of a case with `fault` in them, judged like any others: shows whether it would be found. Rows are in
    /// order of values, then entrants; those that the case does not run are left out.
    pub fn stress_faulty(
        &mut self,
        case: &StressCase,
        entrants: &[Entrant],
        values: &[f64],
        size: [u32; 2],
        fault: InjectedFault,
        progress: &Progress,
    ) -> Result<Vec<StressRow>, SessionError> {
        block_on(self.0.stress_faulty(case, entrants, values, size, fault, progress))
    }

    /// Runs `cases` with pictures of `size` pixels, except those that have a size of their own; with `only`, no other
    /// techniques.
    ///
    /// # Errors
    /// A case that can't be drawn or traced, which is a bug of the case; a lost GPU; [`SessionError::Cancelled`].
    pub fn stress(
        &mut self,
        cases: &[&'static StressCase],
        only: &[Technique],
        size: [u32; 2],
        progress: &Progress,
    ) -> Result<Vec<StressRow>, SessionError> {
        block_on(self.0.stress(cases, only, size, progress))
    }

    /// Computes the rows of `steps` that are left, and returns them in order; an error, and no rows, where it is
    /// cancelled.
    pub fn stress_rows(&mut self, steps: StressSteps, progress: &Progress) -> Result<Vec<StressRow>, SessionError> {
        block_on(self.0.stress_rows(steps, progress))
    }

    /// Computes and returns the next row, and removes it from `steps`; `None` at the end. Other work of the session
    /// between two rows changes none of them.
    pub fn stress_step(&mut self, steps: &mut StressSteps) -> Result<Option<StressRow>, SessionError> {
        block_on(self.0.stress_step(steps))
    }

    /// Draws scenes by every technique with its defaults, and compares labels with the truth and the reference, and
    /// histories with what the GPU stored. What is wrong beyond the reference is diagnosed. A row that can't be drawn,
    /// or not be diagnosed, and a history that can't be computed, say why and end nothing.
    ///
    /// # Errors
    /// A scene that can't be built or traced; a GPU whose profile can't be measured; [`SessionError::Cancelled`].
    pub fn check(
        &mut self,
        scenes: &[&Builtin],
        reference: &CheckReference,
        progress: &Progress,
    ) -> Result<AdapterCheck, SessionError> {
        block_on(self.0.check(scenes, reference, progress))
    }
}
