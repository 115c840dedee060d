//! The work beside the window that owns the session: opens scenes and folders, renders, answers, and reports to the window.
//!
//! Of all waiting orders of one kind, only the newest is carried out ([`OrderQueue`]); orders about a scene or a frame
//! that is no longer shown are dropped. The window asks long work to stop through its
//! [`Progress`](crate::progress::Progress). A report is interrupted by questions about the shown frame, stress cases by
//! everything, after each row. Once no order has come for a while, the questions that wait for that are answered (the
//! frame is timed, so that neither the first picture nor a dragged light waits for the clock); then unused memory is
//! returned to the system. While a slow frame is being changed, previews of a quarter of its pixels are shown, of a very
//! slow one of a sixteenth.
//!
//! ```text
//! worker.rs   orders, opening and running     worker/turns.rs   work in many parts: a report, stress cases
//! worker/film.rs   a film, one picture at a time
//! ```

mod film;
mod turns;

use super::news::{Exported, News};
use super::queue::{Inbox, Order, OrderQueue};
use super::task::{self, ChannelReceiver, ChannelSender, Task, channel};
use super::{AppError, ViewSource, allocator, why_no_capture};
use crate::ask::{AnswerLifetime, Ask, CarriedOver, PendingQuestion, QuestionKind, RunRequest};
use crate::capture::disk::{self, WholeFrame};
use crate::import::ShippedFrame;
use crate::progress::Progress;
use crate::scene::file::store;
use crate::scene::{OpenSpec, Scene};
use crate::session::{AsyncSession, CaptureRequest, RunFrame, SessionError, SnapshotInterval};
use crate::stress::{CaseNumber, Entrant, StressCase};
use crate::technique::{Choice, ChoiceError};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;
use web_time::Instant;

/// A frame that takes longer to capture is not timed: the next order would wait for it.
const LONGEST_TIMED: Duration = Duration::from_millis(250);
/// How long no order comes before the frame is timed.
const IDLE: Duration = Duration::from_millis(400);
/// How long no order comes before the whole frame follows its preview.
const REST: Duration = Duration::from_millis(100);
/// A frame that takes so many times as long as a slow one is previewed in a sixteenth of its pixels instead of a quarter.
const VERY_SLOW: u32 = 25;
/// How long the program's end waits for the worker's.
const LONGEST_END: Duration = Duration::from_secs(2);

/// The window's connection to the worker.
#[derive(Debug)]
pub struct Worker {
    /// `None` once it is to end.
    orders: Option<ChannelSender<Order>>,
    task: Task,
}

impl Drop for Worker {
    /// Waits for the thread's end: an incomplete film is deleted, and the GPU is given back before the program ends, since
    /// drivers crash that are still used while they are unloaded (NVIDIA's does).
    fn drop(&mut self) {
        self.orders = None;
        // It ends, or it is too busy and no longer waited for.
        self.task.wait(LONGEST_END);
    }
}

/// What a worker starts with: the source to show first and how to render.
#[derive(Debug)]
pub struct WorkerStart {
    /// The scene or capture to open first.
    pub source: ViewSource,
    /// How to open it again.
    pub name: OpenSpec,
    /// How to render it.
    pub capture: CaptureRequest,
    /// The time in an animated scene, seconds.
    pub time: f64,
    /// Part of the name of the GPU to use.
    pub adapter: Option<String>,
    /// A frame that takes longer to capture is shown as a preview of fewer pixels while it is being changed.
    pub slow_from: Duration,
}

impl Worker {
    /// Starts the worker, which shows the source and then carries out orders; `notify` receives its news, natively on
    /// the worker's thread.
    pub fn start(start: WorkerStart, notify: impl Fn(News) + Send + 'static) -> Result<Worker, AppError> {
        let (orders, waiting) = channel();
        let work = async move || {
            let mut work = WorkerState::new(start.adapter, &start.capture, start.slow_from, Box::new(notify));
            work.begin(start.source, start.name, start.time).await;
            work.obey_all(waiting).await;
        };
        let task = task::start("stencilscope worker", work).map_err(AppError::NoThread)?;
        Ok(Worker { orders: Some(orders), task })
    }

    /// Sends an order; returns false if the worker has ended.
    pub fn order(&self, order: Order) -> bool {
        self.orders.as_ref().is_some_and(|orders| orders.send(order))
    }
}

/// The state of the worker.
struct WorkerState {
    adapter: Option<String>,
    session: Option<AsyncSession>,
    open: Option<Box<Scene>>,
    /// How the open scene was opened; `None` for a stress case.
    spec: Option<OpenSpec>,
    /// How many scenes were opened.
    scenes: u64,
    /// How the next scene is rendered, unless it says otherwise.
    choice: Choice,
    size: [u32; 2],
    /// What the open scene overrides, if it is a stress case.
    brought: StressOverrides,
    every: SnapshotInterval,
    /// How many frames were captured.
    frames: u64,
    /// The frame that the window shows; `None` for a folder's.
    last: Option<RunFrame>,
    /// How long it took to capture the last whole frame.
    took: Duration,
    /// From which time on that is slow.
    slow_from: Duration,
    /// What was shown as a preview, and is to be run whole once it is at rest.
    previewed: Option<RunRequest>,
    /// The film that is being written.
    film: Option<film::FilmRun>,
    /// Stress cases that are being run.
    stress: Option<turns::StressRun>,
    notify: Box<dyn Fn(News) + Send>,
}

/// What a stress case sets in place of the user's choices, which are valid again when another scene is opened. What the
/// user changes meanwhile becomes a choice.
#[derive(Debug, Default)]
struct StressOverrides {
    /// Technique and settings.
    choice: Option<Choice>,
    /// Width and height of the picture, pixels.
    size: Option<[u32; 2]>,
}

impl WorkerState {
    fn new(
        adapter: Option<String>,
        capture: &CaptureRequest,
        slow_from: Duration,
        notify: Box<dyn Fn(News) + Send>,
    ) -> WorkerState {
        let CaptureRequest { choice, size, every, .. } = capture.clone();
        WorkerState {
            adapter,
            session: None,
            open: None,
            spec: None,
            scenes: 0,
            choice,
            size,
            brought: StressOverrides::default(),
            every,
            frames: 0,
            last: None,
            took: Duration::ZERO,
            slow_from,
            previewed: None,
            film: None,
            stress: None,
            notify,
        }
    }

    /// Shows the scene or capture that the window was started with, and reports that the worker is idle, with an error
    /// where a scene failed.
    async fn begin(&mut self, source: ViewSource, name: OpenSpec, time: f64) {
        match source {
            ViewSource::Folder(whole) => {
                self.show_folder(*whole, &name.name).await;
                self.finish(Ok(()));
            }
            ViewSource::Scene(scene) => {
                self.spec = Some(name);
                let done = self.show_scene(scene, time, StressOverrides::default()).await;
                self.finish(done);
            }
        }
    }

    /// Carries out orders until the window is closed; orders that wait then are dropped. When none has come for
    /// [`IDLE`], answers the questions that wait for quiet, and then gives freed memory back, once until the next
    /// order.
    async fn obey_all(&mut self, orders: ChannelReceiver<Order>) {
        let mut inbox = Inbox { orders, queue: OrderQueue::default(), is_closed: false };
        let mut is_tidy = false;
        loop {
            if let Some(order) = inbox.next_now() {
                if inbox.is_closed {
                    return;
                }
                is_tidy = false;
                self.obey(order, &mut inbox).await;
                task::give_way().await;
                continue;
            }
            let forever = is_tidy && inbox.queue.is_empty() && self.previewed.is_none();
            let quiet = if self.previewed.is_some() { REST } else { IDLE };
            match inbox.orders.recv((!forever).then_some(quiet)).await {
                Ok(order) => inbox.queue.add(order),
                Err(RecvTimeoutError::Timeout) if self.previewed.is_some() => self.complete_preview().await,
                Err(RecvTimeoutError::Timeout) => match inbox.queue.next() {
                    Some(order) => {
                        is_tidy = false;
                        self.obey(order, &mut inbox).await;
                    }
                    None => {
                        allocator::give_back();
                        is_tidy = true;
                    }
                },
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    async fn obey(&mut self, order: Order, inbox: &mut Inbox) {
        let done = match order {
            Order::Open(source) => match self.open(&source).await {
                Ok(()) => Ok(()),
                Err(reason) => {
                    (self.notify)(News::NotOpened { source, reason });
                    Ok(())
                }
            },
            Order::Reload { request } => self.reload(&request).await,
            Order::SaveScene { scene, request, path, replace } => {
                return self.save_scene(scene, &request, &path, replace);
            }
            Order::Run { scene, request, is_moving } if scene == self.scenes => match is_moving {
                true if self.took > self.slow_from => self.preview(&request).await,
                _ => self.run(&request).await,
            },
            Order::OpenCase { case, value, entrant } => self.open_case(case, value, entrant).await,
            Order::CompletePreview => return self.complete_preview().await,
            Order::Answer { scene, frame, asked } => return self.answer_in_turn([scene, frame], asked, inbox).await,
            // The order is for a scene that is no longer open.
            Order::Run { .. } => return,
        };
        self.finish(done);
    }

    /// Answers a question. Stress cases, films and reports are answered in parts, with other orders in between. A
    /// question that was cancelled is not answered; what its stress run or film has begun is dropped.
    async fn answer_in_turn(&mut self, of: [u64; 2], asked: PendingQuestion, inbox: &mut Inbox) {
        if asked.progress.is_cancelled() {
            match asked.ask.kind() {
                QuestionKind::StressOf => self.end_stress(),
                QuestionKind::FilmOf => self.film = None,
                _ => {}
            }
            return;
        }
        // What takes long is of the frame that is meant, not of its preview, which would stay until it ends.
        if asked.ask.kind().is_started_by_hand() {
            self.complete_preview().await;
        }
        match asked.ask {
            Ask::StressOf(_) => self.stress_turn(of, asked, inbox).await,
            Ask::FilmOf(_) => self.film_turn(of, asked, inbox).await,
            Ask::ReportOf(_) => self.report(of, asked, inbox).await,
            _ => self.answer(of, &asked).await,
        }
    }

    /// Answers a question and reports the answer or the error. Ignores a question about another scene or frame than the
    /// one shown, except a diagnosis, which reports that as an error; a question that was cancelled meanwhile gets no
    /// answer.
    async fn answer(&mut self, of: [u64; 2], asked: &PendingQuestion) {
        if asked.ask.kind() != QuestionKind::DiagnosisOf && !self.is_meant(of, asked) {
            return;
        }
        let (doing, starts) = (asked.ask.doing(), self.session.is_none());
        if let Some(doing) = &doing {
            (self.notify)(News::Busy(doing.clone()));
        }
        let result = self.found(of, asked).await.map_err(|error| error.to_string());
        // Where it was cancelled, the window knows: it has asked for it.
        if !asked.progress.is_cancelled() {
            (self.notify)(News::Answered { ticket: asked.ticket, result });
        }
        if doing.is_some() || starts {
            (self.notify)(News::Idle);
        }
    }

    /// Returns whether a question is about the frame or the scene that is shown now, as its kind requires; true for a
    /// kind that always holds, and, for one about a frame, where there is no frame yet.
    fn is_meant(&self, [scene, frame]: [u64; 2], asked: &PendingQuestion) -> bool {
        match asked.ask.kind().holds() {
            AnswerLifetime::Frame => self.last.is_none() || frame == self.frames,
            AnswerLifetime::Scene => scene == self.scenes,
            AnswerLifetime::Always => true,
        }
    }

    /// Computes the answer to a question. An error where a diagnosis is of another scene or frame, where a question
    /// about a frame is asked while there is none, and, for the timing, where the last capture took longer than 250 ms.
    async fn found(&mut self, of: [u64; 2], asked: &PendingQuestion) -> Result<crate::ask::Answer, SessionError> {
        let kind = asked.ask.kind();
        if kind == QuestionKind::DiagnosisOf && (of[1] != self.frames || !self.is_meant(of, asked)) {
            return Err(SessionError::OtherFrame);
        }
        if kind.holds() == AnswerLifetime::Frame && self.last.is_none() {
            return Err(SessionError::NoFrame);
        }
        if kind.waits_for_quiet() && self.took > LONGEST_TIMED {
            let reason = "the frame takes so long that what is asked next would wait for the clock";
            return Err(SessionError::Unanswered(reason.to_owned()));
        }
        let (open, last) = (self.open.take(), self.last.take());
        let result = match self.session().await {
            Ok(session) => session.answer(&asked.ask, open.as_deref(), last.as_ref(), &asked.progress).await,
            Err(error) => Err(error),
        };
        (self.open, self.last) = (open, last);
        result
    }

    async fn open(&mut self, name: &str) -> Result<(), String> {
        (self.notify)(News::Busy(format!("opening {name}")));
        let path = Path::new(name);
        if crate::files::is_folder(path) {
            if let Some(why) = why_no_capture(path) {
                return Err(why);
            }
            self.show_folder(disk::read_whole(path).map_err(|error| error.to_string())?, name).await;
            return Ok(());
        }
        if let Some(shipped) = ShippedFrame::named(name) {
            self.show_folder(shipped.open().map_err(|error| error.to_string())?, name).await;
            return Ok(());
        }
        let spec = OpenSpec::new(name);
        let scene = crate::scene::open(&spec).map_err(|error| error.to_string())?;
        // Settings for one scene are not valid for the next: the technique stays, with its default settings.
        self.choice = match &scene.technique {
            Some(wish) => Choice::parse(wish).map_err(|error| format!("{name}: {error}"))?,
            None => Choice::new(self.choice.technique()),
        };
        self.spec = Some(spec);
        self.show_scene(Box::new(scene), 0.0, StressOverrides::default()).await
    }

    /// Shows the content of a capture folder. With a plan and a scene it becomes the open scene; with only a plan, its
    /// frame is shown and no scene is open; without a plan, only the capture is shown. Another program's frame is
    /// compared with its rerun first.
    async fn show_folder(&mut self, whole: WholeFrame, folder: &str) {
        self.scenes += 1;
        self.previewed = None;
        let name = folder.to_owned();
        let whole = self.checked(whole).await;
        let frame = match RunFrame::from_folder(whole) {
            Ok(frame) => frame,
            Err(whole) => {
                (self.open, self.last, self.spec) = (None, None, None);
                return (self.notify)(News::OpenedFolder { capture: Arc::new(whole.capture), source: name });
            }
        };
        let Ok((scene, request)) = frame.made() else {
            (self.open, self.spec) = (None, None);
            (self.notify)(News::OpenedFolder { capture: Arc::clone(&frame.capture), source: name });
            return self.show(frame, Duration::ZERO);
        };
        let spec = OpenSpec::new(disk::scene_file(Path::new(folder)).display().to_string());
        let request = Box::new(RunRequest::of(scene, request.choice.clone(), request.size));
        let scene = Box::new(scene.clone());
        self.brought = StressOverrides::default();
        self.take_over(&request);
        let (scene_number, files) = (self.scenes, crate::scene::files_of(&spec));
        (self.open, self.spec) = (Some(scene.clone()), Some(spec));
        (self.notify)(News::Opened { scene_number, scene, source: Some(name), files, request });
        self.show(frame, Duration::ZERO);
    }

    /// Compares another program's frame with its rerun, and returns it with the differences. Returns a frame as it is
    /// where it was drawn by this program, was compared before, has no plan, or can't be run here.
    async fn checked(&mut self, whole: WholeFrame) -> WholeFrame {
        let is_checked = whole.capture.steps.iter().flat_map(|step| &step.draws).any(|draw| draw.differs.is_some());
        let is_meant = whole.capture.origin.is_some() && !is_checked;
        let Some(plan) = whole.plan.as_ref().filter(|_| is_meant) else { return whole };
        let checked = match self.session().await {
            Ok(session) => session.compared_with_rerun(plan, &whole.capture, &Progress::default()).await,
            Err(error) => Err(error),
        };
        match checked {
            Ok(capture) => WholeFrame { capture, ..whole },
            // What was stored can be looked at without a GPU.
            Err(_) => whole,
        }
    }

    /// Counts and reports a frame that was run, and makes it the last one. `took` is how long its capture took, which
    /// decides whether it can be timed.
    fn show(&mut self, frame: RunFrame, took: Duration) {
        self.took = took;
        self.previewed = None;
        self.frames += 1;
        (self.notify)(News::Captured { frame: self.frames, run: frame.clone() });
        self.last = Some(frame);
    }

    /// Loads the open scene from its file again, and runs it as before: its changes stay where they can be applied to
    /// what the file has now, and the others are reported.
    async fn reload(&mut self, request: &RunRequest) -> Result<(), String> {
        let Some(spec) = self.spec.clone() else { return Ok(()) };
        (self.notify)(News::Busy(format!("opening {}", spec.name)));
        let mut scene = crate::scene::open(&spec).map_err(|error| error.to_string())?;
        scene.camera = request.camera;
        self.choice = request.choice.clone();
        self.size = request.size;
        self.brought = StressOverrides::default();
        let Some(before) = self.open.take() else {
            return self.show_scene(Box::new(scene), request.time, StressOverrides::default()).await;
        };
        let CarriedOver { request, dropped } = request.carried_over(&before, &scene);
        let name = spec.name;
        let dropped_news = dropped.into_iter().map(|what| News::Warned(format!("{name} was loaded without {what}")));
        dropped_news.for_each(&self.notify);
        self.open_as(Box::new(scene), &request).await
    }

    /// Writes the open scene as the request changes it, at its start and with its motions, with the technique in use,
    /// and reports how that ended. Fails where another scene than number `number` is open, or `path` may not be
    /// written.
    fn save_scene(&mut self, number: u64, request: &RunRequest, path: &str, replace: bool) {
        let file = Path::new(path);
        let of_this = self.open.as_ref().filter(|_| number == self.scenes);
        let news = match (of_this, super::export::check(file, replace)) {
            (None, _) => Exported::Failed("another scene is open by now: export it again".to_owned()),
            (_, Some(problem)) => problem,
            (Some(loaded), None) => {
                let mut scene = request.applied_to(loaded);
                let choice = &request.choice;
                scene.technique = Some(choice.to_request());
                let source = self.spec.as_ref().map(|spec| Path::new(&spec.name));
                match store(&scene, source, file) {
                    Ok(()) => Exported::Done(format!("wrote {}", crate::inspector::whole_path(file))),
                    Err(error) => Exported::Failed(error.to_string()),
                }
            }
        };
        (self.notify)(News::Exported(news));
    }

    /// Returns the GPU session, which is opened and reported as busy on first use.
    async fn session(&mut self) -> Result<&mut AsyncSession, SessionError> {
        match &mut self.session {
            Some(session) => Ok(session),
            none => {
                (self.notify)(News::Busy("starting the GPU".to_owned()));
                let session = AsyncSession::new(self.adapter.as_deref()).await?;
                session.passed_over().for_each(|warning| (self.notify)(News::Warned(warning)));
                Ok(none.insert(session))
            }
        }
    }

    async fn show_scene(&mut self, scene: Box<Scene>, time: f64, brought: StressOverrides) -> Result<(), String> {
        self.brought = brought;
        let choice = self.brought.choice.clone().unwrap_or_else(|| self.choice.clone());
        let size = self.brought.size.unwrap_or(self.size);
        let request = RunRequest { time, ..RunRequest::of(&scene, choice, size) };
        self.open_as(scene, &request).await
    }

    /// Makes a scene the open one, with the next number, reports it with its source and files, and runs it as the
    /// request says. The last frame is dropped.
    async fn open_as(&mut self, scene: Box<Scene>, request: &RunRequest) -> Result<(), String> {
        self.scenes += 1;
        self.previewed = None;
        let source = self.spec.as_ref().map(|spec| spec.name.clone());
        let files = self.spec.as_ref().map_or_else(Vec::new, crate::scene::files_of);
        self.open = Some(scene.clone());
        self.last = None;
        (self.notify)(News::Opened {
            scene_number: self.scenes,
            scene,
            source,
            files,
            request: Box::new(request.clone()),
        });
        self.run(request).await
    }

    /// Opens a stress case's scene at a value and at time 0, with the technique of `entrant` or, where that is `None`,
    /// the one in use with the case's value applied. A scene opened so has no source: it can't be reloaded.
    async fn open_case(
        &mut self,
        case: &'static StressCase,
        value: f64,
        entrant: Option<Entrant>,
    ) -> Result<(), String> {
        (self.notify)(News::Busy(format!("opening {}", case.name)));
        let mut scene = case.scene(value).map_err(|error| format!("{} at {value}: {error}", case.name))?;
        scene.name = format!("{} {value}", case.name);
        let choice = match entrant {
            Some(entrant) => case.choice(&entrant, value).map(Some),
            None => driven(case, value, &self.choice),
        };
        let choice = choice.map_err(|error| format!("{}: {error}", case.name))?;
        self.spec = None;
        self.show_scene(Box::new(scene), 0.0, StressOverrides { choice, size: case.size }).await
    }

    /// Makes the technique and the size of a run request those of scenes opened later; a value that equals what the
    /// open scene or stress case overrides is not stored, and one that differs ends the override.
    fn take_over(&mut self, request: &RunRequest) {
        if self.brought.choice.as_ref() != Some(&request.choice) {
            self.brought.choice = None;
            self.choice = request.choice.clone();
        }
        if self.brought.size != Some(request.size) {
            self.brought.size = None;
            self.size = request.size;
        }
    }

    async fn run(&mut self, request: &RunRequest) -> Result<(), String> {
        self.previewed = None;
        let Some(open) = &self.open else { return Ok(()) };
        let scene = request.applied_to(open).advanced(request.time);
        self.take_over(request);
        self.capture(scene, request).await.map_err(|error| error.to_string())
    }

    /// Shows the open scene as a request says in fewer pixels; the whole frame follows once no order comes for a moment.
    async fn preview(&mut self, request: &RunRequest) -> Result<(), String> {
        // Where this one fails, the whole frame of an earlier state is not what is meant.
        self.previewed = None;
        let Some(open) = &self.open else { return Ok(()) };
        let scene = request.applied_to(open).advanced(request.time);
        self.take_over(request);
        let pixels = pixels_of_preview(self.took, self.slow_from);
        let size = request.size.map(|side| side.div_ceil(pixels));
        let of_preview = CaptureRequest::new(request.choice.clone(), size);
        let session = self.session().await.map_err(|error| error.to_string())?;
        let frame = session.preview(scene, of_preview).await.map_err(|error| error.to_string())?;
        self.frames += 1;
        let capture = Arc::new(frame.capture.enlarged(request.size));
        (self.notify)(News::Previewed { frame: self.frames, plan: Arc::clone(&frame.plan), capture });
        self.last = Some(frame);
        self.previewed = Some(request.clone());
        Ok(())
    }

    /// Runs what was shown as a preview whole.
    async fn complete_preview(&mut self) {
        if let Some(request) = self.previewed.take() {
            let done = self.run(&request).await;
            self.finish(done);
        }
    }

    async fn capture(&mut self, scene: Scene, request: &RunRequest) -> Result<(), SessionError> {
        let request = CaptureRequest { every: self.every, ..CaptureRequest::new(request.choice.clone(), request.size) };
        self.session().await?;
        (self.notify)(News::Busy(format!("capturing {}", request.choice.technique().name())));
        let start = Instant::now();
        let frame = self.session().await?.render(scene, request).await?;
        self.show(frame, start.elapsed());
        Ok(())
    }

    /// Reports the error, if there was one, and then that the worker is idle.
    fn finish(&self, done: Result<(), String>) {
        if let Err(reason) = done {
            (self.notify)(News::Failed(reason));
        }
        (self.notify)(News::Idle);
    }
}

/// Returns how many pixels of a frame, on each side, one of its preview stands for, by how long the whole frame takes.
fn pixels_of_preview(took: Duration, slow_from: Duration) -> u32 {
    if took > VERY_SLOW * slow_from { 4 } else { 2 }
}

/// Returns, where a case drives a setting, `chosen` with the setting at that value, or the case's first
/// technique that has it; `None` where the case drives the scene.
fn driven(case: &StressCase, value: f64, chosen: &Choice) -> Result<Option<Choice>, ChoiceError> {
    let CaseNumber::Setting(key, _) = case.drives else { return Ok(None) };
    if chosen.settings().contains_key(key) {
        let mut choice = chosen.clone();
        choice.set(key, &value.to_string())?;
        return Ok(Some(choice));
    }
    let choices = case.entrants().into_iter().map(|entrant| case.choice(&entrant, value));
    choices.collect::<Result<Vec<_>, _>>().map(|all| all.into_iter().find(|choice| choice.settings().contains_key(key)))
}

#[cfg(test)]
mod tests;
