//! Answers to questions about a frame that was run, or about its scene: one match arm for each question.

use super::{AsyncSession, CaptureRequest, InjectedFault, SessionError, median_ms};
use crate::ask::{Answer, Ask, CaptureOf, ChannelOf, DrawsOf, HistoryOf, MeshesOf, RaysOf, TestsOf, WallsOf, without};
use crate::capture::disk::{FolderContents, WholeFrame};
use crate::capture::{Capture, Timing};
use crate::plan::{FramePlan, LightChannel};
use crate::progress::Progress;
use crate::reading::{ObjectMesh, TestOutcomes};
use crate::scene::{Scene, TechniqueRequest};
use crate::technique::Choice;
use std::sync::Arc;

/// How many frames are timed with snapshots, and how many without.
const TIMED_FRAMES: usize = 5;

/// Bytes that a row of a report, or a fix that a diagnosis tries, may take beyond the frame that is shown, where the
/// GPU's memory is this program's own: a window that is open for hours shares the machine. A fix that is applied takes
/// as much again for its snapshots.
const MOST_OF_A_TRIAL: u64 = 128 << 20;

/// A frame that was run or recorded, with its plan and source. It never changes.
#[derive(Debug, Clone)]
pub struct RunFrame {
    /// The captured attachments.
    pub capture: Arc<Capture>,
    /// The plan that was run.
    pub plan: Arc<FramePlan>,
    /// The inputs that it was planned from, or for another program's frame what its draws reveal of them; `None` where
    /// they reveal too little.
    pub source: Option<Arc<FrameSource>>,
}

/// The scene that a frame shows, and the request that it was planned from; for another program's frame, the scene that
/// its draws reveal, without a request.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSource {
    /// The scene in the state that was captured.
    pub scene: Scene,
    /// How it was captured; `None` where another program drew it.
    pub request: Option<CaptureRequest>,
}

impl RunFrame {
    /// Returns the frame of a capture folder that has plan and scene.
    ///
    /// # Errors
    /// The folder's content, where it has a capture alone, or its technique is not known here.
    pub fn from_folder(whole: WholeFrame) -> Result<RunFrame, Box<WholeFrame>> {
        let Capture { technique, settings, size, .. } = &whole.capture;
        let choice = Choice::parse(&TechniqueRequest { name: technique.clone(), settings: settings.clone() });
        let request = choice.map(|choice| CaptureRequest::new(choice, *size));
        let is_recorded = whole.capture.origin.is_some();
        match (whole, request) {
            (WholeFrame { capture, plan: Some(plan), scene }, request) if is_recorded || request.is_ok() => {
                let request = request.ok().filter(|_| !is_recorded);
                let source = scene.map(|scene| Arc::new(FrameSource { scene, request }));
                Ok(RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source })
            }
            (whole, _) => Err(Box::new(whole)),
        }
    }

    /// Returns the scene that the frame shows.
    pub fn scene(&self) -> Result<&Scene, SessionError> {
        self.source.as_ref().map(|source| &source.scene).ok_or(SessionError::NoLights)
    }

    /// Returns the scene that the frame was planned from, and the request; an error for another program's frame, which
    /// has none.
    pub fn made(&self) -> Result<(&Scene, &CaptureRequest), SessionError> {
        let request = self.source.as_ref().and_then(|source| source.request.as_ref()).ok_or(SessionError::NoScene)?;
        Ok((self.scene()?, request))
    }

    /// Returns what a capture folder of the frame stores: the capture, the plan and, where it is known, the scene.
    pub fn contents(&self) -> FolderContents<'_> {
        let scene = self.source.as_ref().map(|source| &source.scene);
        FolderContents { capture: &self.capture, plan: Some(&self.plan), scene }
    }
}

impl AsyncSession {
    /// As [`Session::answer`](super::Session::answer).
    pub async fn answer(
        &mut self,
        ask: &Ask,
        scene: Option<&Scene>,
        frame: Option<&RunFrame>,
        progress: &Progress,
    ) -> Result<Answer, SessionError> {
        let of_frame = || frame.ok_or(SessionError::NoFrame);
        let of_scene = || scene.ok_or(SessionError::NoScene);
        Ok(match ask {
            Ask::WallsOf(WallsOf { off, objects, time }) => {
                let scene = without(objects.applied_to(of_scene()?), off).advanced(*time);
                Answer::WallsOf(Arc::new(self.walls.walls(&scene)))
            }
            Ask::MeshesOf(MeshesOf { added }) => {
                let mesh = |(object, topology)| ObjectMesh { object, topology };
                let mut meshes: Vec<ObjectMesh> = self.topologies(of_scene()?).into_iter().map(mesh).collect();
                meshes.extend(added.iter().map(|(name, of)| mesh((name.clone(), self.topology(of)))));
                Answer::MeshesOf(Arc::new(meshes))
            }
            Ask::CaptureOf(CaptureOf { request, is_judged, draws_of }) => {
                let scene = request.applied_to(of_scene()?).advanced(request.time);
                let request = CaptureRequest::new(request.choice.clone(), request.size);
                let frame = self.render(scene, request).await?;
                let RunFrame { mut capture, plan, .. } = frame.clone();
                if let Some(step) = draws_of {
                    capture = Arc::new(capture.with_draws(&self.step_draws(&plan, &capture, *step).await?));
                }
                if *is_judged {
                    // As a rule the one that the shown frame was held against.
                    capture = Arc::new(self.judged(frame.scene()?, &capture, progress).await?);
                }
                Answer::CaptureOf(capture)
            }
            Ask::ChannelOf(ChannelOf { channel }) => {
                let frame = of_frame()?;
                Answer::ChannelOf(Arc::new(self.capture_channel(frame, *channel).await?))
            }
            Ask::DrawsOf(DrawsOf { step }) => {
                let RunFrame { plan, capture, .. } = of_frame()?;
                Answer::DrawsOf(Arc::new(self.step_draws(plan, capture, *step).await?))
            }
            Ask::HistoryOf(HistoryOf { at }) => {
                let RunFrame { plan, capture, .. } = of_frame()?;
                Answer::HistoryOf(Arc::new(self.history(plan, capture, *at).await?))
            }
            Ask::RaysOf(RaysOf { at }) => Answer::RaysOf(Arc::new(self.light_rays(of_frame()?, *at)?)),
            Ask::AnatomyOf(_) => {
                let frame = of_frame()?;
                let choice = frame.made().ok().map(|(_, request)| &request.choice);
                Answer::AnatomyOf(Arc::new(self.anatomy(frame.scene()?, choice, &frame.plan)))
            }
            Ask::TestsOf(TestsOf { step, draw }) => {
                let tests = self.step_tests(&of_frame()?.plan, *step, *draw).await?;
                Answer::TestsOf(Arc::new(TestOutcomes::new(tests)))
            }
            Ask::TruthOf(_) => {
                let frame = of_frame()?;
                Answer::TruthOf(Arc::new(self.truth(frame.scene()?, &frame.capture, progress).await?))
            }
            Ask::DiagnosisOf(_) => {
                let frame = of_frame()?;
                self.free_memory_for(&frame.plan);
                let (scene, request) = frame.made()?;
                Answer::DiagnosisOf(Arc::new(self.diagnose(scene, request, InjectedFault::None, progress).await?))
            }
            Ask::FaultsOf(_) => Answer::FaultsOf(Arc::new(self.diagnose_recorded(of_frame()?, progress).await?)),
            Ask::TimingOf(_) => {
                let frame = of_frame()?;
                let (scene, request) = frame.made()?;
                let cost = self.capture_cost(scene, request, TIMED_FRAMES).await?;
                let (frame_ms, captured_ms) = (median_ms(&cost.frames), median_ms(&cost.captured));
                Answer::TimingOf(Arc::new(Timing { frame_ms, captured_ms, ..frame.capture.timing }))
            }
            Ask::ReadersOf(_) => {
                let RunFrame { capture, plan, .. } = of_frame()?;
                ask.read_from(capture, Some(plan)).map_err(SessionError::Unanswered)?
            }
            Ask::ReportOf(_) | Ask::FilmOf(_) | Ask::StressOf(_) => {
                return Err(SessionError::Unanswered(
                    "it takes many turns, between which other work may come".to_owned(),
                ));
            }
        })
    }

    /// As [`Session::capture_channel`](super::Session::capture_channel).
    pub async fn capture_channel(&mut self, frame: &RunFrame, channel: LightChannel) -> Result<Capture, SessionError> {
        let (scene, _) = frame.made()?;
        self.capture_plan(scene, &frame.plan.in_channel(channel)).await
    }

    /// As [`Session::free_memory_for`](super::Session::free_memory_for).
    pub fn free_memory_for(&mut self, plan: &FramePlan) {
        let shares_memory = self.adapter().kind == "cpu";
        self.set_memory_budget(shares_memory.then(|| plan.bytes() + MOST_OF_A_TRIAL));
    }
}
