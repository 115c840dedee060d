//! The thread that owns the session: opens what is asked for, renders, and tells the window.
//!
//! Of all orders that wait, only the newest counts; a run that was asked for before another
//! scene was opened is dropped. Once a frame was captured and no order has come for a while, the
//! same frame is timed, so that neither the first picture nor a dragged light waits for the clock.

use super::news::News;
use super::{AppError, ViewSource};
use crate::capture::{Capture, disk};
use crate::inspector::RunRequest;
use crate::scene::{OpenSpec, Scene};
use crate::session::{CaptureRequest, Session, SessionError, median_ms};
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
/// How long nothing is asked for before the clock runs.
const IDLE: Duration = Duration::from_millis(400);

/// What the window asks for.
#[derive(Debug)]
pub enum Order {
    /// A built-in scene, or the path of a scene file, model or capture folder.
    Open(String),
    /// The open scene again, changed.
    Run {
        /// The scene that is meant.
        generation: u64,
        /// The change.
        request: Box<RunRequest>,
    },
}

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
            let first = bench.begin(start.source, start.time);
            bench.obey_all(first, &waiting);
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
    tell: Box<dyn Fn(News) + Send>,
}

/// A frame that was captured and may be timed.
struct Done {
    scene: Scene,
    request: CaptureRequest,
    capture: Arc<Capture>,
    took: Duration,
}

impl Bench {
    fn new(adapter: Option<String>, capture: &CaptureRequest, tell: Box<dyn Fn(News) + Send>) -> Bench {
        let (choice, size) = (capture.choice.clone(), capture.size);
        Bench { adapter, session: None, scene: None, generation: 0, choice, size, tell }
    }

    /// The first thing to show.
    fn begin(&mut self, source: ViewSource, time: f64) -> Option<Done> {
        match source {
            ViewSource::Capture(capture) => {
                (self.tell)(News::OpenedFolder(Arc::new(*capture)));
                None
            }
            ViewSource::Scene(scene) => {
                let done = self.show_scene(scene, time);
                self.finish(done)
            }
        }
    }

    /// Obeys orders until the window is gone, and times what was captured in between.
    fn obey_all(&mut self, mut untimed: Option<Done>, waiting: &Receiver<Order>) {
        loop {
            let next = if untimed.is_some() {
                waiting.recv_timeout(IDLE)
            } else {
                waiting.recv().map_err(|_| RecvTimeoutError::Disconnected)
            };
            match next {
                Ok(first) => {
                    let order = waiting.try_iter().fold(first, newest);
                    untimed = self.obey(order);
                }
                Err(RecvTimeoutError::Timeout) => {
                    if let Some(done) = untimed.take() {
                        self.time(&done);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn obey(&mut self, order: Order) -> Option<Done> {
        let done = match order {
            Order::Open(name) => self.open(&name),
            Order::Run { generation, request } if generation == self.generation => self.run(&request),
            // Of a scene that is open no more.
            Order::Run { .. } => return None,
        };
        self.finish(done)
    }

    fn open(&mut self, name: &str) -> Result<Option<Done>, String> {
        (self.tell)(News::Busy(format!("opening {name}")));
        let path = Path::new(name);
        if path.is_dir() {
            let capture = disk::read(path).map_err(|error| error.to_string())?;
            self.scene = None;
            self.generation += 1;
            (self.tell)(News::OpenedFolder(Arc::new(capture)));
            return Ok(None);
        }
        let scene = crate::scene::open(&OpenSpec::new(name)).map_err(|error| error.to_string())?;
        if let Some(wish) = &scene.technique {
            self.choice = Choice::parse(wish).map_err(|error| format!("{name}: {error}"))?;
        }
        self.show_scene(Box::new(scene), 0.0)
    }

    fn show_scene(&mut self, scene: Box<Scene>, time: f64) -> Result<Option<Done>, String> {
        let request = RunRequest {
            choice: self.choice.clone(),
            size: self.size,
            camera: scene.camera,
            lights: scene.lights.clone(),
            time,
        };
        self.generation += 1;
        self.scene = Some(scene.clone());
        (self.tell)(News::Opened { generation: self.generation, scene, request: Box::new(request.clone()) });
        self.run(&request)
    }

    fn run(&mut self, request: &RunRequest) -> Result<Option<Done>, String> {
        let Some(loaded) = &self.scene else { return Ok(None) };
        let mut scene = Scene::clone(loaded);
        scene.camera = request.camera;
        scene.lights.clone_from(&request.lights);
        let scene = scene.at(request.time);
        self.choice = request.choice.clone();
        self.size = request.size;
        self.capture(scene, request).map(Some).map_err(|error| error.to_string())
    }

    fn capture(&mut self, scene: Scene, request: &RunRequest) -> Result<Done, SessionError> {
        let request = CaptureRequest {
            choice: request.choice.clone(),
            size: request.size,
            timing_runs: 0,
            external_capture: false,
        };
        let session = match &mut self.session {
            Some(session) => session,
            none => {
                (self.tell)(News::Busy("starting the GPU".to_owned()));
                none.insert(Session::new(self.adapter.as_deref())?)
            }
        };
        (self.tell)(News::Busy(format!("capturing {}", request.choice.technique().name())));
        let start = Instant::now();
        let capture = Arc::new(session.capture(&scene, &request)?);
        let took = start.elapsed();
        (self.tell)(News::Captured(Arc::clone(&capture)));
        Ok(Done { scene, request, capture, took })
    }

    /// Tells that the work is over, and of an error; gives back what may be timed.
    fn finish(&mut self, done: Result<Option<Done>, String>) -> Option<Done> {
        let done = done.unwrap_or_else(|reason| {
            (self.tell)(News::Failed(reason));
            None
        });
        (self.tell)(News::Idle);
        done.filter(|done| done.took <= LONGEST_TIMED)
    }

    fn time(&mut self, done: &Done) {
        let Some(session) = &mut self.session else { return };
        // The frame has just run, so this can fail only where the GPU is lost: the next run says so.
        if let Ok(cost) = session.capture_cost(&done.scene, &done.request, TIMED_FRAMES) {
            let mut capture = Capture::clone(&done.capture);
            capture.timing.frame_ms = median_ms(&cost.frames);
            capture.timing.captured_ms = median_ms(&cost.captured);
            (self.tell)(News::Captured(Arc::new(capture)));
        }
    }
}

/// Which of two orders in a row counts: opening wins over the runs around it, as those before
/// are of the old scene and those after were made before the window knew the new one.
fn newest(earlier: Order, later: Order) -> Order {
    match (&earlier, &later) {
        (Order::Open(_), Order::Run { .. }) => earlier,
        _ => later,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Technique;

    fn run(width: u32) -> Order {
        let request = RunRequest {
            choice: Choice::new(Technique::ZFail),
            size: [width, 1],
            camera: crate::scene::Camera {
                eye: glam::DVec3::ZERO,
                target: glam::DVec3::X,
                up: glam::DVec3::Y,
                fov_y_degrees: 45.0,
                near: 0.1,
                far: None,
            },
            lights: Vec::new(),
            time: 0.0,
        };
        Order::Run { generation: 1, request: Box::new(request) }
    }

    #[test]
    fn of_waiting_runs_the_newest_counts() {
        let order = [run(2), run(3)].into_iter().fold(run(1), newest);
        assert!(matches!(order, Order::Run { request, .. } if request.size[0] == 3));
    }

    #[test]
    fn opening_is_not_lost_to_a_run_of_the_scene_before() {
        let order = [Order::Open("table".to_owned()), run(2)].into_iter().fold(run(1), newest);
        assert!(matches!(order, Order::Open(name) if name == "table"));
    }
}
