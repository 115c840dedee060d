//! Answers to questions about a frame that was run, or about the scene that it is of: one arm a question.

use super::{CaptureRequest, Fault, Session, SessionError, median_ms};
use crate::ask::{Answer, Ask, CaptureOf, DrawsOf, HistoryOf, TestsOf, WallsOf, without};
use crate::capture::{Capture, Timing};
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::reading::{ObjectMesh, TestOutcomes};
use crate::scene::Scene;
use std::sync::Arc;

/// Frames that are timed, each with and without snapshots.
const TIMED_FRAMES: usize = 5;

/// Bytes that a row of a report, or a mend that a diagnosis tries, may take beyond the frame that is shown, where
/// the GPU's memory is this program's own: a window that is open for hours shares the machine. A mend that is
/// applied takes as much again for its snapshots.
const MOST_OF_A_TRIAL: u64 = 128 << 20;

/// A frame that was run. It never changes.
#[derive(Debug, Clone)]
pub struct RunFrame {
    /// The scene at the moment that was captured.
    pub scene: Scene,
    /// How it was captured.
    pub request: CaptureRequest,
    /// What was seen.
    pub capture: Arc<Capture>,
    /// What was run.
    pub plan: Arc<FramePlan>,
}

impl Session {
    /// Answers a question about `frame`, or about `scene` as it was opened. What takes many turns, a report or stress
    /// cases, is made by who can let other work come between.
    ///
    /// # Errors
    /// There is no frame; what is asked for can't be drawn, traced or found; [`SessionError::Cancelled`].
    pub fn answer(
        &mut self,
        ask: &Ask,
        scene: &Scene,
        frame: Option<&RunFrame>,
        progress: &Progress,
    ) -> Result<Answer, SessionError> {
        let of_frame = || frame.ok_or(SessionError::NoFrame);
        Ok(match ask {
            Ask::WallsOf(WallsOf { off, time }) => {
                Answer::WallsOf(Arc::new(self.walls.walls(&without(scene, off).at(*time))))
            }
            Ask::MeshesOf(_) => {
                let mesh = |(object, topology)| ObjectMesh { object, topology };
                Answer::MeshesOf(Arc::new(self.topologies(scene).into_iter().map(mesh).collect()))
            }
            Ask::CaptureOf(CaptureOf { request }) => {
                let scene = request.applied_to(scene).at(request.time);
                let request = CaptureRequest::new(request.choice.clone(), request.size);
                Answer::CaptureOf(Arc::new(self.capture(&scene, &request)?))
            }
            Ask::DrawsOf(DrawsOf { step }) => {
                let RunFrame { plan, capture, .. } = of_frame()?;
                Answer::DrawsOf(Arc::new(self.step_draws(plan, capture, *step)?))
            }
            Ask::HistoryOf(HistoryOf { at }) => {
                let RunFrame { plan, capture, .. } = of_frame()?;
                Answer::HistoryOf(Arc::new(self.history(plan, capture, *at)?))
            }
            Ask::AnatomyOf(_) => {
                let RunFrame { scene, request, plan, .. } = of_frame()?;
                Answer::AnatomyOf(Arc::new(self.anatomy(scene, &request.choice, plan)))
            }
            Ask::TestsOf(TestsOf { step, draw }) => {
                let tests = self.step_tests(&of_frame()?.plan, *step, *draw)?;
                Answer::TestsOf(Arc::new(TestOutcomes::new(tests)))
            }
            Ask::TruthOf(_) => {
                let RunFrame { scene, capture, .. } = of_frame()?;
                Answer::TruthOf(Arc::new(self.truth(scene, capture, progress)?))
            }
            Ask::DiagnosisOf(_) => {
                let frame = of_frame()?;
                self.make_room(&frame.plan);
                Answer::DiagnosisOf(Arc::new(self.diagnose(&frame.scene, &frame.request, Fault::None, progress)?))
            }
            Ask::TimingOf(_) => {
                let RunFrame { scene, request, capture, .. } = of_frame()?;
                let cost = self.capture_cost(scene, request, TIMED_FRAMES)?;
                let (frame_ms, captured_ms) = (median_ms(&cost.frames), median_ms(&cost.captured));
                Answer::TimingOf(Arc::new(Timing { frame_ms, captured_ms, ..capture.timing }))
            }
            Ask::ReadersOf(_) => {
                let RunFrame { capture, plan, .. } = of_frame()?;
                ask.read_from(capture, Some(plan)).map_err(SessionError::Unanswered)?
            }
            Ask::ReportOf(_) | Ask::StressOf(_) => {
                return Err(SessionError::Unanswered(
                    "it takes many turns, between which other work may come".to_owned(),
                ));
            }
        })
    }

    /// Lets no more be tried than there is room for beside the frame of a plan that is shown.
    pub fn make_room(&mut self, plan: &FramePlan) {
        let shares_memory = self.adapter().kind == "cpu";
        self.set_room(shares_memory.then(|| plan.bytes() + MOST_OF_A_TRIAL));
    }
}
