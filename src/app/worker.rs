//! The thread that owns the session: opens what is asked for, renders, and tells the window.
//!
//! Of all orders that wait, only the newest counts ([`Waiting`]); what was asked for a scene or a
//! frame that is shown no more is dropped. Long work (truth, report) is asked to stop by the
//! window, through its [`Progress`](crate::progress::Progress). Once a frame was captured and no
//! order has come for a while, the same frame is timed, so that neither the first picture nor a
//! dragged light waits for the clock.

use super::news::News;
use super::orders::{Measure, Order, StressRun, Waiting};
use super::{AppError, ViewSource};
use crate::capture::{Capture, disk};
use crate::inspector::{ObjectMesh, RunRequest};
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::report::Report;
use crate::scene::{OpenSpec, Scene};
use crate::session::{CaptureRequest, Every, Measurement, Session, SessionError, median_ms, report_rows};
use crate::stress::{Case, Entrant};
use crate::technique::Choice;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Frames that are timed, each with and without snapshots.
const TIMED_FRAMES: usize = 5;
/// A frame that takes longer to capture is not timed: the next order would wait for it.
const LONGEST_TIMED: Duration = Duration::from_millis(250);
/// Pictures of stress cases, but for those with a size of their own.
const STRESS_SIZE: [u32; 2] = [320, 240];
/// How long nothing is asked for before the clock runs.
const IDLE: Duration = Duration::from_millis(400);

/// The way to the worker.
#[derive(Debug)]
pub struct Worker {
    orders: Sender<Order>,
}

/// What a worker starts with.
#[derive(Debug)]
pub struct Start {
    /// What to open first.
    pub source: ViewSource,
    /// How to render it.
    pub capture: CaptureRequest,
    /// The moment of an animated scene, seconds.
    pub time: f64,
    /// Part of the name of the GPU to use.
    pub adapter: Option<String>,
}

impl Worker {
    /// Starts the thread; `tell` carries its news.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(start: Start, tell: impl Fn(News) + Send + 'static) -> Result<Worker, AppError> {
        let (orders, waiting) = channel();
        let run = move || {
            let mut bench = Bench::new(start.adapter, &start.capture, Box::new(tell));
            bench.begin(start.source, start.time);
            bench.obey_all(&waiting);
        };
        let builder = thread::Builder::new().name("stencilscope worker".to_owned());
        builder.spawn(run).map_err(AppError::NoThread)?;
        Ok(Worker { orders })
    }

    /// Gives an order; false if the worker is gone.
    #[must_use]
    pub fn order(&self, order: Order) -> bool {
        self.orders.send(order).is_ok()
    }
}

/// Everything the thread works with.
struct Bench {
    adapter: Option<String>,
    session: Option<Session>,
    scene: Option<Box<Scene>>,
    generation: u64,
    /// How the next scene is rendered, unless it says otherwise.
    choice: Choice,
    size: [u32; 2],
    every: Every,
    /// How many frames were captured.
    frames: u64,
    /// The frame that the window shows; `None` for a folder's.
    last: Option<Done>,
    tell: Box<dyn Fn(News) + Send>,
}

/// A frame that was captured: it may be timed and judged, and asked about its pixels.
struct Done {
    frame: u64,
    scene: Scene,
    request: CaptureRequest,
    capture: Arc<Capture>,
    plan: FramePlan,
    wants_timing: bool,
}

impl Bench {
    fn new(adapter: Option<String>, capture: &CaptureRequest, tell: Box<dyn Fn(News) + Send>) -> Bench {
        let CaptureRequest { choice, size, every, .. } = capture.clone();
        Bench { adapter, session: None, scene: None, generation: 0, choice, size, every, frames: 0, last: None, tell }
    }

    /// The first thing to show.
    fn begin(&mut self, source: ViewSource, time: f64) {
        match source {
            ViewSource::Capture(capture) => (self.tell)(News::OpenedFolder(Arc::new(*capture))),
            ViewSource::Scene(scene) => {
                let done = self.show_scene(scene, time);
                self.finish(done);
            }
        }
    }

    /// Obeys orders until the window is gone, and times what was captured in between.
    fn obey_all(&mut self, orders: &Receiver<Order>) {
        let mut waiting = Waiting::default();
        loop {
            orders.try_iter().for_each(|order| waiting.add(order));
            match waiting.next() {
                Some(Order::Stress(run)) => {
                    // Case by case: what is asked for in between does not wait for all of them.
                    self.stress(run).into_iter().for_each(|rest| waiting.put_back(rest));
                    continue;
                }
                Some(order) => {
                    self.obey(order);
                    continue;
                }
                None => {}
            }
            let next = if self.last.as_ref().is_some_and(|done| done.wants_timing) {
                orders.recv_timeout(IDLE)
            } else {
                orders.recv().map_err(|_| RecvTimeoutError::Disconnected)
            };
            match next {
                Ok(order) => waiting.add(order),
                Err(RecvTimeoutError::Timeout) => self.time(),
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn obey(&mut self, order: Order) {
        let done = match order {
            Order::Open(name) => self.open(&name),
            Order::Run { generation, request } if generation == self.generation => self.run(&request),
            Order::OpenCase { case, value, entrant } => self.open_case(case, value, entrant),
            Order::Draws { frame, step } => return self.fill_draws(frame, step),
            Order::Judge { frame, progress } => return self.judge(frame, &progress),
            Order::History { frame, at } => return self.history(frame, at),
            Order::Measure(what) if what.generation == self.generation => return self.measure(what),
            // Of a scene that is open no more.
            Order::Run { .. } | Order::Measure(_) => return,
            // Obeyed by the loop, case by case.
            Order::Stress(_) => return,
        };
        self.finish(done);
    }

    fn open(&mut self, name: &str) -> Result<(), String> {
        (self.tell)(News::Busy(format!("opening {name}")));
        let path = Path::new(name);
        if path.is_dir() {
            let capture = disk::read(path).map_err(|error| error.to_string())?;
            self.scene = None;
            self.last = None;
            self.generation += 1;
            (self.tell)(News::OpenedFolder(Arc::new(capture)));
            return Ok(());
        }
        let scene = crate::scene::open(&OpenSpec::new(name)).map_err(|error| error.to_string())?;
        if let Some(wish) = &scene.technique {
            self.choice = Choice::parse(wish).map_err(|error| format!("{name}: {error}"))?;
        }
        self.show_scene(Box::new(scene), 0.0)
    }

    /// Opens a stress case's scene at a value, with its shadows made as `entrant` says.
    fn open_case(&mut self, case: &'static Case, value: f64, entrant: Option<Entrant>) -> Result<(), String> {
        (self.tell)(News::Busy(format!("opening {}", case.name)));
        let mut scene = case.scene(value).map_err(|error| format!("{} at {value}: {error}", case.name))?;
        scene.name = format!("{} {value}", case.name);
        if let Some(entrant) = entrant {
            self.choice = case.choice(&entrant, value).map_err(|error| format!("{}: {error}", case.name))?;
        }
        self.size = case.size.unwrap_or(self.size);
        self.show_scene(Box::new(scene), 0.0)
    }

    /// Runs the first of some stress cases, and gives back the others.
    fn stress(&mut self, mut run: StressRun) -> Option<StressRun> {
        if run.progress.is_cancelled() || run.cases.is_empty() {
            return None;
        }
        let case = run.cases.remove(0);
        (self.tell)(News::Busy(format!("stress: {}", case.name)));
        let rows = self.session().and_then(|session| session.stress(&[case], &[], STRESS_SIZE, &run.progress));
        (self.tell)(News::Idle);
        let error = match rows {
            Ok(rows) => {
                (self.tell)(News::Stressed { job: run.job, rows });
                None
            }
            // The window knows: it has asked for it.
            Err(SessionError::Cancelled) => return None,
            Err(error) => Some(error.to_string()),
        };
        if error.is_some() || run.cases.is_empty() {
            (self.tell)(News::StressEnded { job: run.job, error });
            return None;
        }
        Some(run)
    }

    /// The session, opened on first use.
    fn session(&mut self) -> Result<&mut Session, SessionError> {
        match &mut self.session {
            Some(session) => Ok(session),
            none => {
                (self.tell)(News::Busy("starting the GPU".to_owned()));
                Ok(none.insert(Session::new(self.adapter.as_deref())?))
            }
        }
    }

    fn show_scene(&mut self, scene: Box<Scene>, time: f64) -> Result<(), String> {
        let request = RunRequest {
            choice: self.choice.clone(),
            size: self.size,
            camera: scene.camera,
            lights: scene.lights.clone(),
            time,
        };
        self.generation += 1;
        self.scene = Some(scene.clone());
        self.last = None;
        (self.tell)(News::Opened { generation: self.generation, scene, request: Box::new(request.clone()) });
        let done = self.run(&request);
        self.look_at_meshes();
        done
    }

    /// Tells how the open scene's meshes hang together: after the first frame, which must not wait.
    fn look_at_meshes(&mut self) {
        let (Some(session), Some(scene)) = (&mut self.session, &self.scene) else { return };
        (self.tell)(News::Busy("looking at meshes".to_owned()));
        let mesh = |(object, topology)| ObjectMesh { object, topology };
        let meshes = session.topologies(scene).into_iter().map(mesh).collect();
        (self.tell)(News::Meshes { generation: self.generation, meshes });
    }

    fn run(&mut self, request: &RunRequest) -> Result<(), String> {
        let Some(loaded) = &self.scene else { return Ok(()) };
        let mut scene = Scene::clone(loaded);
        scene.camera = request.camera;
        scene.lights.clone_from(&request.lights);
        let scene = scene.at(request.time);
        self.choice = request.choice.clone();
        self.size = request.size;
        self.capture(scene, request).map_err(|error| error.to_string())
    }

    fn capture(&mut self, scene: Scene, request: &RunRequest) -> Result<(), SessionError> {
        let request = CaptureRequest { every: self.every, ..CaptureRequest::new(request.choice.clone(), request.size) };
        self.session()?;
        (self.tell)(News::Busy(format!("capturing {}", request.choice.technique().name())));
        let start = Instant::now();
        let (capture, plan) = self.session()?.capture_with_plan(&scene, &request)?;
        let capture = Arc::new(capture);
        let wants_timing = start.elapsed() <= LONGEST_TIMED;
        self.frames += 1;
        (self.tell)(News::Captured { frame: self.frames, capture: Arc::clone(&capture) });
        self.last = Some(Done { frame: self.frames, scene, request, capture, plan, wants_timing });
        Ok(())
    }

    /// Tells that the work is over, and of an error.
    fn finish(&self, done: Result<(), String>) {
        if let Err(reason) = done {
            (self.tell)(News::Failed(reason));
        }
        (self.tell)(News::Idle);
    }

    fn time(&mut self) {
        let (Some(session), Some(done)) = (&mut self.session, &mut self.last) else { return };
        done.wants_timing = false;
        // The frame has just run, so this can fail only where the GPU is lost: the next run says so.
        if let Ok(cost) = session.capture_cost(&done.scene, &done.request, TIMED_FRAMES) {
            let mut capture = Capture::clone(&done.capture);
            capture.timing.frame_ms = median_ms(&cost.frames);
            capture.timing.captured_ms = median_ms(&cost.captured);
            done.capture = Arc::new(capture);
            (self.tell)(News::Timed { frame: done.frame, capture: Arc::clone(&done.capture) });
        }
    }

    /// Adds the states after the draws of a step to the frame that was captured last, if it is the
    /// one that is meant.
    fn fill_draws(&mut self, frame: u64, step: usize) {
        let (Some(session), Some(done)) = (&mut self.session, &mut self.last) else {
            let reason = "the open scene was not rendered: mend what the error says".to_owned();
            return (self.tell)(News::NoDraws { frame, step, reason });
        };
        if done.frame != frame {
            return;
        }
        let name = done.capture.steps.get(step).map_or("the pass", |step| step.name.as_str());
        (self.tell)(News::Busy(format!("capturing the draws of {name}")));
        let mut capture = Capture::clone(&done.capture);
        (self.tell)(match session.fill_draws(&done.plan, &mut capture, step) {
            Ok(()) => {
                done.capture = Arc::new(capture);
                News::Draws { frame, capture: Arc::clone(&done.capture) }
            }
            Err(error) => News::NoDraws { frame, step, reason: error.to_string() },
        });
        (self.tell)(News::Idle);
    }

    /// Adds the truth to the frame that was captured last, if it is the one that is meant.
    fn judge(&mut self, frame: u64, progress: &Progress) {
        let is_meant = |done: &&mut Done| done.frame == frame && !progress.is_cancelled();
        let (Some(session), Some(done)) = (&mut self.session, self.last.as_mut().filter(is_meant)) else { return };
        (self.tell)(News::Busy("tracing the truth".to_owned()));
        let mut capture = Capture::clone(&done.capture);
        match session.judge(&done.scene, &mut capture, progress) {
            Ok(()) => {
                done.capture = Arc::new(capture);
                (self.tell)(News::Judged { frame, capture: Arc::clone(&done.capture) });
            }
            // The window knows: it has asked for it.
            Err(SessionError::Cancelled) => {}
            Err(error) => (self.tell)(News::NotJudged { frame, reason: error.to_string() }),
        }
        (self.tell)(News::Idle);
    }

    /// Tells the history of a pixel of the frame that was captured last, if it is the one that is
    /// meant: so quick that nothing has to say it is being done.
    fn history(&mut self, frame: u64, at: [u32; 2]) {
        let meant = self.last.as_ref().filter(|done| done.frame == frame);
        let history = match (&mut self.session, meant) {
            (Some(session), Some(done)) => {
                let history = session.history(&done.plan, &done.capture, at);
                history.map(Arc::new).map_err(|error| error.to_string())
            }
            _ => Err("the frame that is shown is of a scene that is open no more: mend what the error says".to_owned()),
        };
        (self.tell)(News::History { frame, at, history });
    }

    /// Measures the open scene as it was captured last.
    fn measure(&mut self, what: Measure) {
        if what.progress.is_cancelled() {
            return;
        }
        (self.tell)(News::Busy("measuring every technique".to_owned()));
        let result = match (&mut self.session, &self.last) {
            (Some(session), Some(done)) => {
                let size = done.request.size;
                let measurement = Measurement { choices: what.choices, size, runs: what.runs };
                let measured = session.measure(&done.scene, &measurement, &what.progress);
                measured.map_err(|error| error.to_string()).map(|measured| {
                    Report::new(session.adapter().clone(), report_rows(&done.scene.name, size, &measured))
                })
            }
            _ => Err("the open scene was not rendered: mend what the error says, then measure again".to_owned()),
        };
        // Where it was cancelled, the window has asked for it.
        if !what.progress.is_cancelled() {
            (self.tell)(News::Measured { job: what.job, result });
        }
        (self.tell)(News::Idle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Technique;

    const PATIENCE: Duration = Duration::from_secs(60);

    /// A worker over a small built-in scene, its first frame, and the news after it.
    fn started() -> (Worker, u64, Receiver<News>) {
        let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
        let start = Start {
            source: ViewSource::Scene(Box::new(scene)),
            capture: CaptureRequest::new(Choice::new(Technique::Planar), [64, 36]),
            time: 0.0,
            adapter: None,
        };
        let (tell, news) = channel();
        let worker = Worker::start(start, move |news| drop(tell.send(news))).expect("a thread");
        let frame = wait(&news, |news| if let News::Captured { frame, .. } = news { Some(frame) } else { None });
        (worker, frame, news)
    }

    fn wait<T>(news: &Receiver<News>, mut is_it: impl FnMut(News) -> Option<T>) -> T {
        loop {
            if let Some(found) = is_it(news.recv_timeout(PATIENCE).expect("news")) {
                return found;
            }
        }
    }

    fn judge(worker: &Worker, frame: u64, progress: &Progress) {
        assert!(worker.order(Order::Judge { frame, progress: progress.clone() }));
    }

    #[test]
    fn stress_cases_run_one_by_one_and_give_way_to_what_is_asked_in_between() {
        let (worker, frame, news) = started();
        let cases = ["one-pixel", "no-receiver"].map(|name| Case::named(name).expect("a case")).to_vec();
        let run = StressRun { job: 5, cases, progress: Progress::default() };
        assert!(worker.order(Order::Stress(run)));
        let mut heard = Vec::new();
        let error = wait(&news, |news| {
            match news {
                News::Stressed { job: 5, rows } => heard.push(rows[0].case),
                News::StressEnded { job: 5, error } => return Some(error),
                _ => {}
            }
            None
        });
        assert_eq!((heard, error), (vec!["one-pixel", "no-receiver"], None));
        let cancelled = StressRun {
            job: 6,
            cases: vec![Case::named("tall-picture").expect("a case")],
            progress: Progress::default(),
        };
        cancelled.progress.cancel();
        assert!(worker.order(Order::Stress(cancelled)));
        judge(&worker, frame, &Progress::default());
        wait(&news, |news| {
            assert!(!matches!(news, News::Stressed { .. }), "it was cancelled");
            matches!(news, News::Judged { .. }).then_some(())
        });
    }

    #[test]
    fn a_stress_case_is_opened_as_a_scene_with_the_technique_that_breaks() {
        let (worker, _frame, news) = started();
        let case = Case::named("nested").expect("a case");
        let entrant = case.entrants().into_iter().find(|entrant| !entrant.settings.is_empty());
        assert!(worker.order(Order::OpenCase { case, value: 2.0, entrant }));
        let scene = wait(&news, |news| if let News::Opened { scene, .. } = news { Some(scene) } else { None });
        assert_eq!(scene.name, "nested 2");
        let capture = wait(&news, |news| if let News::Captured { capture, .. } = news { Some(capture) } else { None });
        assert_eq!(capture.technique, "z-fail");
        assert_eq!(capture.settings.get("counter").map(String::as_str), Some("float"));
    }

    #[test]
    fn after_the_first_frame_the_meshes_are_told() {
        let (_worker, _frame, news) = started();
        let meshes = wait(&news, |news| if let News::Meshes { meshes, .. } = news { Some(meshes) } else { None });
        let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
        let names = |of: &[ObjectMesh]| of.iter().map(|mesh| mesh.object.clone()).collect::<Vec<_>>();
        assert_eq!(names(&meshes), scene.objects.iter().map(|object| object.name.clone()).collect::<Vec<_>>());
    }

    #[test]
    fn the_last_frame_is_judged_and_keeps_its_truth_when_it_is_timed() {
        let (tell, news) = channel();
        let request = CaptureRequest::new(Choice::new(Technique::Planar), [64, 36]);
        let mut bench = Bench::new(None, &request, Box::new(move |news| drop(tell.send(news))));
        let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
        bench.begin(ViewSource::Scene(Box::new(scene)), 0.0);
        bench.judge(1, &Progress::default());
        bench.time();
        let heard: Vec<News> = news.try_iter().collect();
        let judged =
            heard.iter().find_map(|news| if let News::Judged { capture, .. } = news { Some(capture) } else { None });
        let judged = judged.expect("a truth");
        assert!(judged.lights.iter().all(|light| light.truth.is_some()));
        let Some(News::Timed { frame: 1, capture }) = heard.last() else { panic!("a time") };
        assert!(capture.timing.frame_ms.is_some() && capture.error() == judged.error());
    }

    #[test]
    fn the_draws_of_a_pass_are_filled_in_and_stale_wishes_for_them_are_dropped() {
        let (worker, frame, news) = started();
        assert!(worker.order(Order::Draws { frame: frame + 1, step: 0 }));
        // The order before is obeyed or replaced first: of both only one is answered.
        assert!(worker.order(Order::Draws { frame, step: 1 }));
        let filled = wait(&news, |news| if let News::Draws { capture, .. } = news { Some(capture) } else { None });
        assert!(filled.holds_draws(1) && !filled.holds_draws(0));
        judge(&worker, frame, &Progress::default());
        let judged = wait(&news, |news| if let News::Judged { capture, .. } = news { Some(capture) } else { None });
        assert!(judged.holds_draws(1), "what was filled in stays");
    }

    #[test]
    fn a_frame_that_is_shown_no_more_and_a_cancelled_truth_are_passed_over() {
        let (worker, frame, news) = started();
        let cancelled = Progress::default();
        cancelled.cancel();
        judge(&worker, frame + 1, &Progress::default());
        judge(&worker, frame, &cancelled);
        assert!(worker.order(Order::Open("no such scene".to_owned())));
        let is_judged = wait(&news, |news| match news {
            News::Judged { .. } => Some(true),
            News::Failed(_) => Some(false),
            _ => None,
        });
        assert!(!is_judged);
        judge(&worker, frame, &Progress::default());
        wait(&news, |news| if let News::Judged { .. } = news { Some(()) } else { None });
    }

    #[test]
    fn a_pixel_of_the_last_frame_tells_its_history_and_of_another_frame_why_not() {
        let (worker, frame, news) = started();
        let ask = |frame, at| {
            assert!(worker.order(Order::History { frame, at }));
            wait(&news, |news| match news {
                News::History { frame, at, history } => Some((frame, at, history)),
                _ => None,
            })
        };
        let (of, at, history) = ask(frame, [32, 20]);
        let history = history.expect("a history");
        assert_eq!((of, at, history.pixel), (frame, [32, 20], [32, 20]));
        assert!(history.agrees() && !history.events.is_empty());
        let (.., outside) = ask(frame, [64, 0]);
        assert!(outside.expect_err("no such pixel").contains("outside the picture"));
        assert!(ask(frame + 1, [0, 0]).2.is_err());
    }

    #[test]
    fn the_open_scene_is_measured_in_the_size_that_is_shown() {
        let (worker, _, news) = started();
        let measure = |generation, job| {
            let choices = [Technique::ZFail, Technique::Planar].map(Choice::new).to_vec();
            Order::Measure(Measure { generation, job, choices, runs: 1, progress: Progress::default() })
        };
        assert!(worker.order(measure(1, 7)));
        let (job, result) =
            wait(&news, |news| if let News::Measured { job, result } = news { Some((job, result)) } else { None });
        let report = result.expect("a report");
        let rows: Vec<_> = report.rows.iter().map(|row| (row.technique.as_str(), row.size)).collect();
        assert_eq!((job, rows), (7, vec![("z-fail", [64, 36]), ("planar", [64, 36])]));
    }
}
