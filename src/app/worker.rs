//! The thread that owns the session: opens what is asked for, renders, and tells the window.
//!
//! Of all orders that wait, only the newest counts ([`Waiting`]); what was asked for a scene or a
//! frame that is shown no more is dropped. Long work (truth, report) is asked to stop by the
//! window, through its [`Progress`](crate::progress::Progress). A report gives way to what is asked
//! of the shown frame, stress cases give way to everything, row by row. Once a frame was captured and
//! no order has come for a while, the same frame is timed, so that neither the first picture nor a
//! dragged light waits for the clock; then memory that nothing uses is given back.
//!
//! ```text
//! worker.rs   orders, opening and running     worker/done.rs    what is asked of a captured frame
//!                                             worker/stress.rs  stress cases, run and opened
//! ```

mod done;
mod stress;

use super::export::Exported;
use super::news::News;
use super::orders::{Inbox, Order, Waiting};
use super::{AppError, ViewSource, allocator};
use crate::capture::disk;
use crate::inspector::{ObjectMesh, RunRequest};
use crate::scene::file::store;
use crate::scene::{OpenSpec, Scene, WallCache};
use crate::session::{CaptureRequest, Every, Session, SessionError};
use crate::technique::Choice;
use done::Done;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};
use stress::Brought;

/// A frame that takes longer to capture is not timed: the next order would wait for it.
const LONGEST_TIMED: Duration = Duration::from_millis(250);
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
    /// What opens it again.
    pub name: OpenSpec,
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
            bench.begin(start.source, start.name, start.time);
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
    /// What opened it; `None` for a stress case.
    spec: Option<OpenSpec>,
    generation: u64,
    /// How the next scene is rendered, unless it says otherwise.
    choice: Choice,
    size: [u32; 2],
    /// What the open scene says otherwise, if it is a stress case.
    brought: Brought,
    every: Every,
    /// How many frames were captured.
    frames: u64,
    /// Of the scene that is walked through.
    walls: WallCache,
    /// The frame that the window shows; `None` for a folder's.
    last: Option<Done>,
    tell: Box<dyn Fn(News) + Send>,
}

impl Bench {
    fn new(adapter: Option<String>, capture: &CaptureRequest, tell: Box<dyn Fn(News) + Send>) -> Bench {
        let CaptureRequest { choice, size, every, .. } = capture.clone();
        let brought = Brought::default();
        Bench {
            adapter,
            session: None,
            scene: None,
            spec: None,
            generation: 0,
            choice,
            size,
            brought,
            every,
            frames: 0,
            walls: WallCache::default(),
            last: None,
            tell,
        }
    }

    /// The first thing to show.
    fn begin(&mut self, source: ViewSource, name: OpenSpec, time: f64) {
        match source {
            ViewSource::Capture(capture) => {
                (self.tell)(News::OpenedFolder { capture: Arc::new(*capture), source: name.name })
            }
            ViewSource::Scene(scene) => {
                self.spec = Some(name);
                let done = self.show_scene(scene, time, Brought::default());
                self.finish(done);
            }
        }
    }

    /// Obeys orders until the window is gone, and times what was captured in between.
    fn obey_all(&mut self, orders: &Receiver<Order>) {
        let mut inbox = Inbox { orders, waiting: Waiting::default() };
        let mut is_tidy = false;
        loop {
            let order = inbox.next();
            is_tidy &= order.is_none();
            match order {
                Some(Order::Stress(run)) => {
                    // Row by row: what is asked for in between does not wait for all of them.
                    self.stress(run).into_iter().for_each(|rest| inbox.waiting.put_back(rest));
                    continue;
                }
                Some(Order::Measure(what)) => {
                    self.measure(what, &mut inbox);
                    continue;
                }
                Some(order) => {
                    self.obey(order);
                    continue;
                }
                None => {}
            }
            let wants_timing = self.last.as_ref().is_some_and(|done| done.wants_timing);
            let next = if wants_timing || !is_tidy {
                orders.recv_timeout(IDLE)
            } else {
                orders.recv().map_err(|_| RecvTimeoutError::Disconnected)
            };
            match next {
                Ok(order) => inbox.waiting.add(order),
                Err(RecvTimeoutError::Timeout) if wants_timing => self.time(),
                Err(RecvTimeoutError::Timeout) => {
                    allocator::give_back();
                    is_tidy = true;
                }
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn obey(&mut self, order: Order) {
        let done = match order {
            Order::Open(name) => self.open(&name),
            Order::Reload { request } => self.reload(&request),
            Order::SaveScene { generation, request, path, replace } => {
                return self.save_scene(generation, &request, &path, replace);
            }
            Order::Run { generation, request } if generation == self.generation => self.run(&request),
            Order::OpenCase { case, value, entrant } => self.open_case(case, value, entrant),
            Order::Draws { frame, step } => return self.fill_draws(frame, step),
            Order::Compare { generation, request } => return self.compare(generation, request),
            Order::Tests { frame, step, draw } => return self.tests(frame, step, draw),
            Order::Diagnose { frame, job, progress } => return self.diagnose(frame, job, &progress),
            Order::Judge { frame, progress } => return self.judge(frame, &progress),
            Order::History { frame, at } => return self.history(frame, at),
            Order::Anatomy { frame } => return self.anatomy(frame),
            Order::Walls { generation, request } => return self.walls(generation, &request),
            // Of a scene that is open no more.
            Order::Run { .. } => return,
            // Obeyed by the loop, as others come in between.
            Order::Measure(_) | Order::Stress(_) => return,
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
            self.spec = None;
            (self.tell)(News::OpenedFolder { capture: Arc::new(capture), source: name.to_owned() });
            return Ok(());
        }
        let spec = OpenSpec::new(name);
        let scene = crate::scene::open(&spec).map_err(|error| error.to_string())?;
        if let Some(wish) = &scene.technique {
            self.choice = Choice::parse(wish).map_err(|error| format!("{name}: {error}"))?;
        }
        self.spec = Some(spec);
        self.show_scene(Box::new(scene), 0.0, Brought::default())
    }

    /// The open scene from its file again: its objects and lights are the file's, camera and technique stay.
    fn reload(&mut self, request: &RunRequest) -> Result<(), String> {
        let Some(spec) = self.spec.clone() else { return Ok(()) };
        (self.tell)(News::Busy(format!("opening {}", spec.name)));
        let mut scene = crate::scene::open(&spec).map_err(|error| error.to_string())?;
        scene.camera = request.camera;
        self.choice = request.choice.clone();
        self.size = request.size;
        self.show_scene(Box::new(scene), request.time, Brought::default())
    }

    /// Writes the scene, changed as it is run, with its motions.
    fn save_scene(&mut self, generation: u64, request: &RunRequest, path: &str, replace: bool) {
        let file = Path::new(path);
        let of_this = self.scene.as_ref().filter(|_| generation == self.generation);
        let news = match (of_this, super::export::check(file, replace)) {
            (None, _) => Exported::Failed("another scene is open by now: export it again".to_owned()),
            (_, Some(problem)) => problem,
            (Some(loaded), None) => {
                let mut scene = changed(loaded, request);
                let choice = &request.choice;
                scene.technique = Some(choice.to_request());
                let source = self.spec.as_ref().map(|spec| Path::new(&spec.name));
                match store(&scene, source, file) {
                    Ok(()) => Exported::Done(format!("wrote {path}")),
                    Err(error) => Exported::Failed(error.to_string()),
                }
            }
        };
        (self.tell)(News::Exported(news));
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

    fn show_scene(&mut self, scene: Box<Scene>, time: f64, brought: Brought) -> Result<(), String> {
        self.brought = brought;
        let request = RunRequest {
            choice: self.brought.choice.clone().unwrap_or_else(|| self.choice.clone()),
            size: self.brought.size.unwrap_or(self.size),
            camera: scene.camera,
            lights: scene.lights.clone(),
            time,
            off: std::collections::BTreeSet::new(),
        };
        self.generation += 1;
        let source = self.spec.as_ref().map(|spec| spec.name.clone());
        let files = self.spec.as_ref().map_or_else(Vec::new, crate::scene::files_of);
        self.scene = Some(scene.clone());
        self.last = None;
        (self.tell)(News::Opened {
            generation: self.generation,
            scene,
            source,
            files,
            request: Box::new(request.clone()),
        });
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

    /// The open scene at the moment of a request.
    fn scene_of(&self, request: &RunRequest) -> Option<Scene> {
        Some(changed(self.scene.as_ref()?, request).at(request.time))
    }

    /// Captures the open scene beside the frame that is shown, which stays.
    fn compare(&mut self, generation: u64, request: Box<RunRequest>) {
        let Some(scene) = self.scene_of(&request).filter(|_| generation == self.generation) else { return };
        (self.tell)(News::Busy(format!("capturing {} to compare", request.choice.technique().name())));
        let what = CaptureRequest::new(request.choice.clone(), request.size);
        let result = self.session().and_then(|session| session.capture(&scene, &what));
        let result = result.map(Arc::new).map_err(|error| error.to_string());
        (self.tell)(News::Compared { generation, request, result });
        (self.tell)(News::Idle);
    }

    /// Tells what can't be walked through.
    fn walls(&mut self, generation: u64, request: &RunRequest) {
        let Some(scene) = self.scene_of(request).filter(|_| generation == self.generation) else { return };
        let walls = Arc::new(self.walls.walls(&scene));
        (self.tell)(News::Walls { generation, walls });
    }

    fn run(&mut self, request: &RunRequest) -> Result<(), String> {
        let Some(scene) = self.scene_of(request) else { return Ok(()) };
        self.take_over(request);
        self.capture(scene, request).map_err(|error| error.to_string())
    }

    fn capture(&mut self, scene: Scene, request: &RunRequest) -> Result<(), SessionError> {
        let request = CaptureRequest { every: self.every, ..CaptureRequest::new(request.choice.clone(), request.size) };
        self.session()?;
        (self.tell)(News::Busy(format!("capturing {}", request.choice.technique().name())));
        let start = Instant::now();
        let (capture, plan) = self.session()?.capture_with_plan(&scene, &request)?;
        let (capture, plan) = (Arc::new(capture), Arc::new(plan));
        let wants_timing = start.elapsed() <= LONGEST_TIMED;
        self.frames += 1;
        (self.tell)(News::Captured { frame: self.frames, capture: Arc::clone(&capture), plan: Arc::clone(&plan) });
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
}

/// The scene with what the panels change: camera, lights, and which objects are there.
fn changed(loaded: &Scene, request: &RunRequest) -> Scene {
    let mut scene = loaded.clone();
    scene.camera = request.camera;
    scene.lights.clone_from(&request.lights);
    let mut index = 0;
    scene.objects.retain(|_| {
        index += 1;
        !request.off.contains(&(index - 1))
    });
    scene
}

#[cfg(test)]
mod tests;
