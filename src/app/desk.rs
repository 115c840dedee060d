//! What the window is about, without the window: the panels, the worker, and what goes between them.
//!
//! The window, the benchmark of the panels and the pictures of the README all sit at this desk: they
//! draw [`Desk::inspector`], hand its actions to [`Desk::act`] and what wakes them to [`Desk::wake`].

use super::export::{self, Exported};
use super::jobs::Jobs;
use super::memory;
use super::news::{News, Tell, WindowNews};
use super::orders::Order;
use super::readers::Readers;
use super::watch::Watch;
use super::worker::{Start, Worker};
use super::{AppError, ViewRequest};
use crate::capture::Capture;
use crate::inspector::{Action, ExportData, ExportKind, Inspector, PictureKind, Remembered, SceneEntry, TruthState};
use crate::scene::{TechniqueRequest, builtin};
use crate::stress::Case;
use crate::technique::Choice;
use std::pin::Pin;
use std::sync::Arc;

/// What the system's dialog shows: it has files or folders, not both.
#[derive(Debug, Clone, Copy)]
enum Wanted {
    /// Scenes and models.
    File,
    /// Captures.
    Folder,
}

/// The panels and the worker.
pub struct Desk {
    /// The panels.
    pub inspector: Inspector,
    worker: Worker,
    tell: Tell,
    /// Of the scene that is open.
    generation: u64,
    /// Of the frame that is shown.
    frame: u64,
    jobs: Jobs,
    readers: Readers,
    /// Files of the open scene; `None` where nothing is remembered or watched.
    watch: Option<Watch>,
    /// What is selected when the first capture comes.
    first_step: Option<usize>,
    first_pick: Option<[u32; 2]>,
    first_is_error: bool,
    /// As stored last.
    remembered: Remembered,
}

impl Desk {
    /// Opens what is asked for. `tell` wakes whoever draws. What was remembered of the run before is recalled, and
    /// this one's kept, where `remembers` says so.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(request: ViewRequest, tell: Tell, remembers: bool) -> Result<Desk, AppError> {
        let start = Start {
            source: request.source,
            name: request.name,
            capture: request.capture,
            time: request.time,
            adapter: request.adapter,
        };
        let to_window = Arc::clone(&tell);
        let worker = Worker::start(start, move |news| to_window(WindowNews::Worker(news)))?;
        let scene = |builtin: &builtin::Builtin| SceneEntry {
            name: builtin.name.to_owned(),
            lesson: builtin.lesson.to_owned(),
        };
        let mut inspector = Inspector::new(builtin::ALL.iter().map(scene).collect());
        if remembers {
            inspector.recall(memory::load());
        }
        let remembered = inspector.remembered();
        inspector.set_job(Some("starting".to_owned()));
        let watch = if remembers { Some(Watch::start(Arc::clone(&tell)).map_err(AppError::NoThread)?) } else { None };
        Ok(Desk {
            inspector,
            worker,
            tell,
            generation: 0,
            frame: 0,
            jobs: Jobs::default(),
            readers: Readers::default(),
            watch,
            first_step: request.step,
            first_pick: request.pick,
            first_is_error: request.truth,
            remembered,
        })
    }

    /// Tells the panels how far long work is; true while there is any.
    pub fn watch_jobs(&mut self) -> bool {
        self.jobs.watch(&mut self.inspector)
    }

    /// Takes in what woke the window, but for what is the window's own.
    pub fn wake(&mut self, news: WindowNews) {
        match news {
            WindowNews::Worker(news) => self.hear(news),
            WindowNews::Chosen(path) => self.act(Action::Open(path)),
            WindowNews::ChosenExport(path) => self.inspector.set_export_path(path),
            WindowNews::Exported(exported) => self.end_export(exported),
            WindowNews::MapReaders(found) => {
                self.inspector.set_map_readers(found);
                let next = self.readers.go_on(&self.tell);
                self.say_if_failed(next);
            }
            WindowNews::FileChanged(file) => self.inspector.offer_reload(file),
            WindowNews::Repaint(_) | WindowNews::Access(_) => {}
        }
    }

    /// Takes in what the worker tells.
    pub fn hear(&mut self, news: News) {
        match news {
            News::Busy(job) => self.inspector.set_job(Some(job)),
            News::Idle => self.inspector.set_job(None),
            News::Opened { generation, scene, source, files, request } => {
                if let Some(watch) = &self.watch {
                    watch.look_at(files);
                }
                self.generation = generation;
                self.inspector.open_scene(&scene, *request, source);
                self.remember();
            }
            News::Meshes { generation, meshes } if generation == self.generation => self.inspector.set_meshes(meshes),
            News::OpenedFolder { capture, source } => {
                if let Some(watch) = &self.watch {
                    watch.look_at(Vec::new());
                }
                self.jobs.stop_judging();
                self.inspector.set_job(None);
                self.inspector.open_folder(&source);
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
            News::Compared { generation, request, result } if generation == self.generation => {
                self.inspector.set_compared(&request, result);
            }
            News::Tests { frame, step, draw, result } if frame == self.frame => {
                self.inspector.set_tests(step, draw, result);
            }
            News::Walls { generation, walls } if generation == self.generation => self.inspector.set_walls(walls),
            // Of a scene or frame that is shown no more.
            News::Walls { .. } => {}
            News::Tests { .. } | News::Compared { .. } => {}
            News::Meshes { .. } | News::Timed { .. } | News::Judged { .. } | News::NotJudged { .. } => {}
            News::Draws { .. } | News::NoDraws { .. } | News::History { .. } | News::Anatomy { .. } => {}
            News::Measured { job, result, left_out } => {
                self.jobs.end_measuring(job, result, &left_out, &mut self.inspector);
            }
            News::Diagnosed { job, result } => self.jobs.end_diagnosing(job, result, &mut self.inspector),
            News::Stressed { job, rows } => self.jobs.add_stress(job, rows, &mut self.inspector),
            News::StressEnded { job, error } => self.jobs.end_stress(job, error, &mut self.inspector),
            News::Failed(reason) => self.inspector.push_failure(reason),
        }
    }

    fn say_if_failed(&mut self, begun: std::io::Result<()>) {
        if let Err(error) = begun {
            self.inspector
                .push_error(format!("no pixel can be linked with its texel now: {error}; open the tab again"));
        }
    }

    /// Is anything found out of which nobody says that it is?
    pub fn is_finding(&self) -> bool {
        self.readers.is_running()
    }

    fn show(&mut self, capture: Arc<Capture>) {
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

    /// Does what the panels wish.
    pub fn act(&mut self, action: Action) {
        let order = match action {
            Action::Open(name) => {
                self.jobs.make_way(&mut self.inspector);
                Order::Open(name)
            }
            Action::Run(request) => {
                self.jobs.make_way(&mut self.inspector);
                Order::Run { generation: self.generation, request }
            }
            Action::Compare(request) => {
                self.jobs.pause_judging(&mut self.inspector);
                Order::Compare { generation: self.generation, request }
            }
            Action::Tests { step, draw } => Order::Tests { frame: self.frame, step, draw },
            Action::Anatomy => Order::Anatomy { frame: self.frame },
            Action::MapReaders => {
                let Some(job) = self.inspector.map_readers_job() else { return };
                let begun = self.readers.find(job, &self.tell);
                return self.say_if_failed(begun);
            }
            Action::Walls(request) => {
                // No step is made before they are known.
                self.jobs.make_way(&mut self.inspector);
                Order::Walls { generation: self.generation, request }
            }
            Action::Browse => return self.browse(Wanted::File),
            Action::BrowseFolder => return self.browse(Wanted::Folder),
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
                    if let Err(error) = export::start(data, path, replace, Arc::clone(&self.tell)) {
                        self.inspector.end_export(Err(format!("nothing can be written now: {error}; try again")));
                    }
                    return;
                }
                None => {
                    self.inspector.end_export(Err("there is nothing to export any longer".to_owned()));
                    return;
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
                return;
            }
            Action::History { at } => Order::History { frame: self.frame, at },
            Action::RunReport => match self.jobs.measure(self.generation, &mut self.inspector) {
                Some(measure) => Order::Measure(measure),
                None => return,
            },
            Action::CancelReport => {
                self.jobs.stop_measuring(None, &mut self.inspector);
                return;
            }
            Action::Diagnose => {
                let (job, progress) = self.jobs.diagnose(&mut self.inspector);
                Order::Diagnose { frame: self.frame, job, progress }
            }
            Action::CancelDiagnosis => {
                self.jobs.stop_diagnosing(None, &mut self.inspector);
                return;
            }
            Action::RunStress { cases } => Order::Stress(Box::new(self.jobs.stress(&cases, &mut self.inspector))),
            Action::CancelStress => {
                self.jobs.stop_stress(&mut self.inspector);
                return;
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
    }

    /// Makes shadows as a row of the report did.
    fn open_report_row(&mut self, row: TechniqueRequest) {
        match Choice::parse(&row) {
            Ok(choice) => self.inspector.choose(choice).into_iter().for_each(|action| self.act(action)),
            Err(error) => self.inspector.push_error(error.to_string()),
        }
    }

    /// Asks for a file or folder in the system's dialog, beside the window.
    fn browse(&mut self, wanted: Wanted) {
        let dialog = rfd::AsyncFileDialog::new();
        // Made here, as some systems give dialogs to the first thread only.
        let dialog: Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match wanted {
            Wanted::File => {
                let dialog = dialog.set_title("Open a scene or a model");
                Box::pin(dialog.add_filter("scenes and models", &["toml", "obj"]).pick_file())
            }
            Wanted::Folder => Box::pin(dialog.set_title("Open a capture folder").pick_folder()),
        };
        let tell = Arc::clone(&self.tell);
        let wait = move || {
            if let Some(chosen) = pollster::block_on(dialog) {
                tell(WindowNews::Chosen(chosen.path().display().to_string()));
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
        let tell = Arc::clone(&self.tell);
        let wait = move || {
            // A capture is a folder: its place is chosen like that of a file that is not there yet.
            let _ = kind;
            if let Some(file) = pollster::block_on(dialog.save_file()) {
                tell(WindowNews::ChosenExport(file.path().display().to_string()));
            }
        };
        if let Err(error) = std::thread::Builder::new().name("file dialog".to_owned()).spawn(wait) {
            self.inspector.push_error(format!("the file dialog can't be opened: {error}; type the path instead"));
        }
    }

    /// An export ended.
    pub fn end_export(&mut self, exported: Exported) {
        match exported {
            Exported::Done(what) => self.inspector.end_export(Ok(what)),
            Exported::Taken(path) => self.inspector.ask_to_replace(path),
            Exported::Failed(reason) => self.inspector.end_export(Err(reason)),
        }
    }

    /// Remembers what was changed since; a failure is told, and the window goes on.
    pub fn remember(&mut self) {
        let now = self.inspector.remembered();
        if self.watch.is_some() && now != self.remembered {
            if let Err(reason) = memory::store(&now) {
                self.inspector.push_error(reason);
            }
            self.remembered = now;
        }
    }
}
