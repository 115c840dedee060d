//! The event loop: carries actions of the panels to the worker and its news to the panels.

use super::export::{self, Exported};
use super::jobs::Jobs;
use super::memory;
use super::news::{News, WindowNews};
use super::orders::Order;
use super::surface::Surface;
use super::watch::Watch;
use super::worker::{Start, Worker};
use super::{AppError, ViewRequest, no_window};
use crate::inspector::{Action, ExportData, ExportKind, Inspector, PictureKind, Remembered, SceneEntry, TruthState};
use crate::scene::{TechniqueRequest, builtin};
use crate::stress::Case;
use crate::technique::Choice;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

/// How often progress is looked at.
const WATCH: Duration = Duration::from_millis(100);

/// Shows the window until it is closed.
pub fn run(request: ViewRequest) -> Result<(), AppError> {
    let event_loop = EventLoop::<WindowNews>::with_user_event().build();
    let event_loop = event_loop.map_err(|error| no_window(&error))?;
    event_loop.set_control_flow(ControlFlow::Wait);
    let proxy = event_loop.create_proxy();
    let mut app = App::new(request, proxy)?;
    event_loop.run_app(&mut app).map_err(|error| no_window(&error))?;
    app.failure.map_or(Ok(()), Err)
}

struct App {
    ctx: egui::Context,
    inspector: Inspector,
    worker: Worker,
    proxy: EventLoopProxy<WindowNews>,
    adapter: Option<String>,
    surface: Option<Surface>,
    failure: Option<AppError>,
    /// Of the scene that is open.
    generation: u64,
    /// Of the frame that is shown.
    frame: u64,
    jobs: Jobs,
    watch: Watch,
    /// What is selected when the first capture comes.
    first_step: Option<usize>,
    first_pick: Option<[u32; 2]>,
    first_is_error: bool,
    repaint_at: Option<Instant>,
    /// As stored last.
    remembered: Remembered,
}

impl App {
    fn new(request: ViewRequest, proxy: EventLoopProxy<WindowNews>) -> Result<App, AppError> {
        let start = Start {
            source: request.source,
            name: request.name,
            capture: request.capture,
            time: request.time,
            adapter: request.adapter.clone(),
        };
        // A loop that has ended takes no news, and needs none.
        let to_window = proxy.clone();
        let tell = move |news| drop(to_window.send_event(WindowNews::Worker(news)));
        let worker = Worker::start(start, tell)?;
        let scene = |builtin: &builtin::Builtin| SceneEntry {
            name: builtin.name.to_owned(),
            lesson: builtin.lesson.to_owned(),
        };
        let mut inspector = Inspector::new(builtin::ALL.iter().map(scene).collect());
        inspector.recall(memory::load());
        let remembered = inspector.remembered();
        inspector.set_job(Some("starting".to_owned()));
        let watch = Watch::start(proxy.clone()).map_err(AppError::NoThread)?;
        Ok(App {
            ctx: context(&proxy),
            inspector,
            worker,
            proxy,
            adapter: request.adapter,
            surface: None,
            failure: None,
            generation: 0,
            frame: 0,
            jobs: Jobs::default(),
            watch,
            first_step: request.step,
            first_pick: request.pick,
            first_is_error: request.truth,
            repaint_at: None,
            remembered,
        })
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Busy(job) => self.inspector.set_job(Some(job)),
            News::Idle => self.inspector.set_job(None),
            News::Opened { generation, scene, source, files, request } => {
                self.watch.look_at(files);
                self.generation = generation;
                self.inspector.open_scene(&scene, *request, source);
                self.remember();
            }
            News::Meshes { generation, meshes } if generation == self.generation => self.inspector.set_meshes(meshes),
            News::OpenedFolder(capture) => {
                self.jobs.stop_judging();
                self.inspector.set_job(None);
                self.inspector.clear_scene();
                self.show(capture);
            }
            News::Captured { frame, capture, plan } => {
                self.frame = frame;
                self.jobs.stop_judging();
                self.show(capture);
                self.inspector.set_plan(plan);
            }
            News::Exported(exported) => self.end_export(exported),
            News::Timed { frame, capture } | News::Draws { frame, capture } if frame == self.frame => {
                self.inspector.update_capture(capture);
            }
            News::NoDraws { frame, step, reason } if frame == self.frame => {
                self.inspector.set_draws_failed(step, reason);
            }
            News::Judged { frame, capture } if frame == self.frame => {
                self.jobs.stop_judging();
                self.inspector.update_capture(capture);
            }
            News::NotJudged { frame, reason } if frame == self.frame => {
                self.jobs.stop_judging();
                self.inspector.set_truth(TruthState::Failed(reason));
            }
            News::History { frame, at, history } if frame == self.frame => self.inspector.set_history(at, history),
            News::Anatomy { frame, anatomy } if frame == self.frame => self.inspector.set_anatomy(anatomy),
            // Of a scene or frame that is shown no more.
            News::Meshes { .. } | News::Timed { .. } | News::Judged { .. } | News::NotJudged { .. } => {}
            News::Draws { .. } | News::NoDraws { .. } | News::History { .. } | News::Anatomy { .. } => {}
            News::Measured { job, result } => self.jobs.end_measuring(job, result, &mut self.inspector),
            News::Diagnosed { job, result } => self.jobs.end_diagnosing(job, result, &mut self.inspector),
            News::Stressed { job, rows } => self.jobs.add_stress(job, rows, &mut self.inspector),
            News::StressEnded { job, error } => self.jobs.end_stress(job, error, &mut self.inspector),
            News::Failed(reason) => self.inspector.push_error(reason),
        }
        self.redraw();
    }

    fn show(&mut self, capture: std::sync::Arc<crate::capture::Capture>) {
        if let Some(surface) = &mut self.surface {
            surface.set_title(title(&capture));
        }
        self.inspector.set_capture(capture);
        if let Some(step) = self.first_step.take() {
            self.inspector.select_step(step);
        }
        if std::mem::take(&mut self.first_is_error) {
            self.inspector.set_picture_kind(PictureKind::Error);
        }
        if let Some(pick) = self.first_pick.take() {
            self.inspector.pick(pick);
        }
    }

    fn act(&mut self, action: Action) {
        let order = match action {
            Action::Open(name) => {
                self.jobs.make_way(&mut self.inspector);
                Order::Open(name)
            }
            Action::Run(request) => {
                self.jobs.make_way(&mut self.inspector);
                Order::Run { generation: self.generation, request }
            }
            Action::Browse => return self.browse(),
            Action::BrowseExport { kind, path } => return self.browse_export(kind, path),
            Action::Reload => {
                let Some(request) = self.inspector.draft() else { return };
                self.jobs.make_way(&mut self.inspector);
                Order::Reload { request }
            }
            Action::Export { kind, path, replace } => match self.inspector.export(kind) {
                Some(ExportData::Scene(request)) => {
                    Order::SaveScene { generation: self.generation, request, path, replace }
                }
                Some(data) => {
                    if let Err(error) = export::start(data, path, replace, self.proxy.clone()) {
                        self.inspector.end_export(Err(format!("nothing can be written now: {error}; try again")));
                    }
                    return self.redraw();
                }
                None => {
                    self.inspector.end_export(Err("there is nothing to export any longer".to_owned()));
                    return self.redraw();
                }
            },
            Action::CaptureDraws { step } => {
                self.jobs.pause_judging(&mut self.inspector);
                Order::Draws { frame: self.frame, step }
            }
            Action::Judge => Order::Judge { frame: self.frame, progress: self.jobs.judge() },
            Action::CancelJudge => {
                self.jobs.stop_judging();
                self.inspector.set_truth(TruthState::Cancelled);
                return self.redraw();
            }
            Action::History { at } => Order::History { frame: self.frame, at },
            Action::Anatomy => Order::Anatomy { frame: self.frame },
            Action::RunReport => match self.jobs.measure(self.generation, &mut self.inspector) {
                Some(measure) => Order::Measure(measure),
                None => return self.redraw(),
            },
            Action::CancelReport => {
                self.jobs.stop_measuring(None, &mut self.inspector);
                return self.redraw();
            }
            Action::Diagnose => {
                let (job, progress) = self.jobs.diagnose(&mut self.inspector);
                Order::Diagnose { frame: self.frame, job, progress }
            }
            Action::CancelDiagnosis => {
                self.jobs.stop_diagnosing(None, &mut self.inspector);
                return self.redraw();
            }
            Action::RunStress { cases } => Order::Stress(Box::new(self.jobs.stress(&cases, &mut self.inspector))),
            Action::CancelStress => {
                self.jobs.stop_stress(&mut self.inspector);
                return self.redraw();
            }
            Action::OpenStress { case, value, entrant } => {
                let Some(case) = Case::named(case) else { return };
                self.jobs.make_way(&mut self.inspector);
                Order::OpenCase { case, value, entrant }
            }
            Action::OpenReportRow { technique, settings } => {
                return self.open_report_row(TechniqueRequest { name: technique, settings });
            }
        };
        if !self.worker.order(order) {
            let lost = "the worker thread is gone: close the window and start again";
            self.inspector.push_error(lost.to_owned());
        }
        self.redraw();
    }

    /// Makes shadows as a row of the report did.
    fn open_report_row(&mut self, row: TechniqueRequest) {
        match Choice::parse(&row) {
            Ok(choice) => self.inspector.choose(choice).into_iter().for_each(|action| self.act(action)),
            Err(error) => self.inspector.push_error(error.to_string()),
        }
    }

    /// Asks for a file in the system's dialog, beside the window.
    fn browse(&mut self) {
        let dialog = rfd::AsyncFileDialog::new().set_title("Open a scene or a model");
        let dialog = dialog.add_filter("scenes and models", &["toml", "obj"]).pick_file();
        let proxy = self.proxy.clone();
        let wait = move || {
            if let Some(file) = pollster::block_on(dialog) {
                drop(proxy.send_event(WindowNews::Chosen(file.path().display().to_string())));
            }
        };
        if let Err(error) = std::thread::Builder::new().name("file dialog".to_owned()).spawn(wait) {
            self.inspector.push_error(format!("the file dialog can't be opened: {error}; type the path instead"));
        }
    }

    /// Asks with the system's dialog where to export to, beside the window.
    fn browse_export(&mut self, kind: ExportKind, path: String) {
        let dialog = rfd::AsyncFileDialog::new().set_title("Export");
        let name = std::path::Path::new(&path).file_name().map(|name| name.to_string_lossy().into_owned());
        let dialog = dialog.set_file_name(name.unwrap_or_default());
        let proxy = self.proxy.clone();
        let wait = move || {
            // A capture is a folder: its place is chosen like that of a file that is not there yet.
            let _ = kind;
            if let Some(file) = pollster::block_on(dialog.save_file()) {
                drop(proxy.send_event(WindowNews::ChosenExport(file.path().display().to_string())));
            }
        };
        if let Err(error) = std::thread::Builder::new().name("file dialog".to_owned()).spawn(wait) {
            self.inspector.push_error(format!("the file dialog can't be opened: {error}; type the path instead"));
        }
    }

    fn end_export(&mut self, exported: Exported) {
        match exported {
            Exported::Done(what) => self.inspector.end_export(Ok(what)),
            Exported::Taken(path) => self.inspector.ask_to_replace(path),
            Exported::Failed(reason) => self.inspector.end_export(Err(reason)),
        }
        self.redraw();
    }

    /// Remembers what was changed since; a failure is told, and the window goes on.
    fn remember(&mut self) {
        let now = self.inspector.remembered();
        if now != self.remembered {
            if let Err(reason) = memory::store(&now) {
                self.inspector.push_error(reason);
            }
            self.remembered = now;
        }
    }

    fn redraw(&self) {
        if let Some(surface) = &self.surface {
            surface.request_redraw();
        }
    }

    fn draw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(surface) = &mut self.surface else { return };
        let mut actions = Vec::new();
        let is_watching = self.jobs.watch(&mut self.inspector);
        surface.draw(event_loop, &self.ctx, |ui| {
            actions.extend(self.inspector.ui(ui));
            if is_watching {
                ui.ctx().request_repaint_after(WATCH);
            }
        });
        if let Some(reason) = surface.take_grab_failure() {
            let words =
                format!("the pointer can't be held in the window ({reason}): walking turns until it meets an edge");
            self.inspector.push_error(words);
        }
        for action in actions {
            self.act(action);
        }
    }
}

impl ApplicationHandler<WindowNews> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.surface.is_some() {
            return;
        }
        match Surface::new(event_loop, &self.ctx, self.proxy.clone(), self.adapter.as_deref()) {
            Ok(mut surface) => {
                if let Some(capture) = self.inspector.capture() {
                    surface.set_title(title(capture));
                }
                surface.request_redraw();
                self.surface = Some(surface);
            }
            Err(error) => {
                self.failure = Some(error);
                event_loop.exit();
            }
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, news: WindowNews) {
        match news {
            WindowNews::Worker(news) => self.hear(news),
            WindowNews::Chosen(path) => self.act(Action::Open(path)),
            WindowNews::ChosenExport(path) => {
                self.inspector.set_export_path(path);
                self.redraw();
            }
            WindowNews::Exported(exported) => self.end_export(exported),
            WindowNews::FileChanged(file) => {
                self.inspector.offer_reload(file);
                self.redraw();
            }
            WindowNews::Repaint(at) => {
                let at = self.repaint_at.map_or(at, |earlier| earlier.min(at));
                self.repaint_at = Some(at);
                event_loop.set_control_flow(ControlFlow::WaitUntil(at));
            }
            WindowNews::Access(event) => {
                if let Some(surface) = &mut self.surface {
                    surface.on_access(event.window_event);
                }
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => {
                self.remember();
                event_loop.exit();
            }
            WindowEvent::RedrawRequested => self.draw(event_loop),
            event => {
                if let Some(surface) = &mut self.surface {
                    surface.on_event(&event);
                }
            }
        }
    }

    fn device_event(&mut self, _event_loop: &ActiveEventLoop, _device: DeviceId, event: DeviceEvent) {
        if let (DeviceEvent::MouseMotion { delta }, Some(surface)) = (event, &mut self.surface) {
            surface.on_mouse_motion(delta);
        }
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, _cause: StartCause) {
        if self.repaint_at.is_some_and(|at| at <= Instant::now()) {
            self.repaint_at = None;
            event_loop.set_control_flow(ControlFlow::Wait);
            self.redraw();
        }
    }

    fn exiting(&mut self, _event_loop: &ActiveEventLoop) {
        // The window goes before the loop that it came from.
        self.surface = None;
    }
}

/// An egui context that wakes the loop when it wants to be drawn.
fn context(proxy: &EventLoopProxy<WindowNews>) -> egui::Context {
    let ctx = egui::Context::default();
    let proxy = proxy.clone();
    ctx.set_request_repaint_callback(move |info| {
        // "Never" is a delay too long to add.
        if info.delay < Duration::from_secs(3600) {
            drop(proxy.send_event(WindowNews::Repaint(Instant::now() + info.delay)));
        }
    });
    ctx
}

fn title(capture: &crate::capture::Capture) -> String {
    format!("{} · {} — stencilscope", capture.scene, capture.technique)
}
