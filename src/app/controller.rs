//! The logic of the window without the window: the panels, the worker, and the messages between them.
//!
//! The window, the benchmark of the panels and the pictures of the README all draw [`Controller::inspector`], pass its
//! actions to [`Controller::act`] and its events to [`Controller::wake`].

use super::export;
use super::memory;
use super::news::{Exported, News, Notify, WindowNews};
use super::queue::Order;
use super::reader::{NoReader, ReadRequest, ReaderThread};
use super::watch::Watch;
use super::worker::{Worker, WorkerStart};
use super::{AppError, ViewRequest};
use crate::ask::{FilmOf, FilmSubject, PendingQuestion, QuestionKind};
use crate::capture::Capture;
use crate::import::SHIPPED;
use crate::inspector::{Action, ExportData, Inspector, SceneEntry, StoredSettings};
use crate::reading::picture_view::PictureKind;
use crate::scene::{TechniqueRequest, builtin};
use crate::session::RunFrame;
use crate::stress::StressCase;
use crate::technique::Choice;
use std::path::Path;
use std::pin::Pin;
use std::sync::Arc;

/// What the system's dialog shows: files or folders, never both.
#[derive(Debug, Clone, Copy)]
enum DialogFilter {
    /// Files of scenes and models.
    File,
    /// Folders of captures.
    Folder,
}

/// Joins the panels, the worker, the reader thread and the file watch: hands the panels' actions on as orders, and
/// shows in the panels what comes back.
pub struct Controller {
    /// The panels.
    pub inspector: Inspector,
    worker: Worker,
    notify: Notify,
    /// Number of the scene that is open.
    scene: u64,
    /// Number of the frame that is shown.
    frame: u64,
    /// That frame; `None` for a folder that contains only a capture.
    run: Option<RunFrame>,
    reader: ReaderThread,
    /// Watches the files of the open scene; `None` where nothing is stored or watched.
    watch: Option<Watch>,
    /// Index of the step that is selected when the first capture comes.
    first_step: Option<usize>,
    first_pick: Option<[u32; 2]>,
    first_is_error: bool,
    /// The settings as they were stored last.
    remembered: StoredSettings,
}

impl Drop for Controller {
    /// Cancels long work: the program ends.
    fn drop(&mut self) {
        self.inspector.model.answers.make_way();
        self.inspector.model.cancel(QuestionKind::FilmOf);
    }
}

impl Controller {
    /// Opens what is asked for. `notify` wakes the event loop that draws. Where `remembers` is true, the settings of
    /// the previous run are loaded, and those of this run are stored.
    pub fn new(request: ViewRequest, notify: Notify, remembers: bool) -> Result<Controller, AppError> {
        let start = WorkerStart {
            source: request.source,
            name: request.name,
            capture: request.capture,
            time: request.time,
            adapter: request.adapter,
        };
        let to_window = Arc::clone(&notify);
        let worker = Worker::start(start, move |news| to_window(WindowNews::Worker(news)))?;
        let entry = |name: &str, lesson: &str| SceneEntry { name: name.to_owned(), lesson: lesson.to_owned() };
        let scenes = builtin::ALL.iter().map(|builtin| entry(builtin.name, builtin.lesson)).collect();
        let mut inspector = Inspector::new(scenes);
        inspector.offer_frames(SHIPPED.iter().map(|shipped| entry(shipped.name, shipped.lesson)).collect());
        if remembers {
            inspector.recall(memory::load());
        }
        let remembered = inspector.remembered();
        inspector.set_job(Some("starting".to_owned()));
        let watch = if remembers { Some(Watch::start(Arc::clone(&notify)).map_err(AppError::NoThread)?) } else { None };
        Ok(Controller {
            inspector,
            worker,
            notify,
            scene: 0,
            frame: 0,
            run: None,
            reader: ReaderThread::default(),
            watch,
            first_step: request.step,
            first_pick: request.pick,
            first_is_error: request.truth,
            remembered,
        })
    }

    /// Returns whether a question is being answered: its progress changes without news from the worker.
    pub fn is_answering(&self) -> bool {
        self.inspector.model.answers.is_waiting()
    }

    /// Handles an event that woke the window; repaint requests and assistive technology's events are ignored, as only
    /// the window can handle them. A path that the open dialog gave is opened, a file that changed is only noted in the
    /// panels, and an answer read from the capture also begins the question that waits for the reader.
    pub fn wake(&mut self, news: WindowNews) {
        match news {
            WindowNews::Worker(news) => self.hear(news),
            WindowNews::Chosen(path) => self.act(Action::Open(path)),
            WindowNews::ChosenExport(path) => self.inspector.set_export_path(path),
            WindowNews::Exported(exported) => self.end_export(exported),
            WindowNews::Read { ticket, result } => {
                self.inspector.answer(ticket, result, true);
                let next = self.reader.go_on(&self.notify);
                self.say_if_failed(next);
            }
            WindowNews::FileChanged(file) => self.inspector.model.activity.changed_file = Some(file),
            WindowNews::Repaint(_) | WindowNews::Access(_) => {}
        }
    }

    /// Shows news of the worker in the panels. An opened scene's or folder's files become those that are watched (none
    /// for a folder without a scene), and for a scene the window's settings are stored; a captured frame is shown, and
    /// the first one applies the requested step, error picture and pick.
    pub fn hear(&mut self, news: News) {
        match news {
            News::Busy(job) => self.inspector.set_job(Some(job)),
            News::Idle => self.inspector.set_job(None),
            News::Opened { scene_number, scene, source, files, request } => {
                if let Some(watch) = &self.watch {
                    watch.look_at(files);
                }
                self.scene = scene_number;
                self.inspector.open_scene(&scene, *request, source);
                self.remember();
            }
            News::OpenedFolder { capture, source } => {
                if let Some(watch) = &self.watch {
                    watch.look_at(Vec::new());
                }
                self.inspector.set_job(None);
                self.run = None;
                self.inspector.open_folder(Some(&source));
                self.show(capture);
            }
            News::Captured { frame, run } => {
                self.frame = frame;
                self.show(Arc::clone(&run.capture));
                self.inspector.set_plan(Arc::clone(&run.plan));
                self.run = Some(run);
            }
            News::Answered { ticket, result } => self.inspector.answer(ticket, result, true),
            News::AnsweredPart { ticket, answer } => self.inspector.answer(ticket, Ok(answer), false),
            News::AnswerEnded { ticket } => self.inspector.model.answers.end(ticket),
            News::Exported(exported) => self.end_export(exported),
            News::Warned(what) => self.inspector.model.push_warning(what),
            News::Failed(reason) => self.inspector.push_failure(reason),
        }
    }

    fn say_if_failed(&mut self, begun: Result<(), NoReader>) {
        if let Err(NoReader { ticket, why }) = begun {
            let reason = format!("no pixel can be linked with its texel now: {why}; run the frame again");
            self.inspector.answer(ticket, Err(reason.clone()), true);
            self.inspector.model.push_error(reason);
        }
    }

    fn show(&mut self, capture: Arc<Capture>) {
        self.inspector.set_capture(capture);
        if let Some(step) = self.first_step.take() {
            self.inspector.model.select_step(step);
        }
        if std::mem::take(&mut self.first_is_error) {
            self.inspector.model.choose_picture(PictureKind::Error);
        }
        if let Some(pick) = self.first_pick.take() {
            self.inspector.model.selection.pick = Some(pick);
        }
    }

    /// Carries out an action of the panels: most become an order to the worker; dialogs, exports and questions that are
    /// answered from the capture run on threads of their own. Opening, running and reloading stop long work first.
    /// Failures are shown in the panels.
    pub fn act(&mut self, action: Action) {
        let order = match action {
            Action::Open(name) => {
                self.inspector.model.answers.make_way();
                Order::Open(name)
            }
            Action::Run(request) => {
                self.inspector.model.answers.make_way();
                Order::Run { scene: self.scene, request }
            }
            Action::Ask(asked) if asked.ask.kind().is_read_from_capture() => return self.read(asked),
            Action::Ask(asked) => Order::Answer { scene: self.scene, frame: self.frame, asked },
            Action::Browse => return self.browse(DialogFilter::File),
            Action::BrowseFolder => return self.browse(DialogFilter::Folder),
            Action::BrowseExport { path } => return self.browse_export(&path),
            Action::Reload => {
                let Some(request) = self.inspector.draft() else { return };
                self.inspector.model.answers.make_way();
                Order::Reload { request }
            }
            Action::Export { kind, path, replace } => match self.inspector.export(kind) {
                Some(ExportData::Scene(request)) => Order::SaveScene { scene: self.scene, request, path, replace },
                Some(ExportData::Film(subject)) => return self.film(subject, path, replace),
                Some(data) => {
                    let data = match (data, &self.run) {
                        // With all answers that are known by now.
                        (ExportData::Capture(capture), Some(run)) => {
                            export::ExportContent::Frame(Box::new(RunFrame { capture, ..run.clone() }))
                        }
                        (ExportData::Page(capture), Some(run)) => {
                            export::ExportContent::Page(Box::new(RunFrame { capture, ..run.clone() }))
                        }
                        (data, _) => export::ExportContent::Panels(data),
                    };
                    if let Err(error) = export::start(data, path, replace, Arc::clone(&self.notify)) {
                        self.inspector.end_export(Err(format!("nothing can be written now: {error}; try again")));
                    }
                    return;
                }
                None => {
                    self.inspector.end_export(Err("there is nothing to export any longer".to_owned()));
                    return;
                }
            },
            Action::OpenStress { case, value, entrant } => {
                let Some(case) = StressCase::named(case) else { return };
                self.inspector.model.answers.make_way();
                Order::OpenCase { case, value, entrant }
            }
            Action::OpenReportRow { technique, settings } => {
                return self.open_report_row(TechniqueRequest { name: technique, settings });
            }
        };
        if !self.worker.order(order) {
            let lost = "the worker thread is gone: close the window and start again";
            self.inspector.model.push_error(lost.to_owned());
        }
    }

    /// Asks the worker for a film, where it may be written; otherwise shows why not, or asks whether to replace the
    /// file, and starts nothing.
    fn film(&mut self, subject: FilmSubject, path: String, replace: bool) {
        match export::check(Path::new(&path), replace) {
            Some(problem) => self.end_export(problem),
            None => {
                self.inspector.begin_export();
                self.inspector.model.answers.start(FilmOf { subject, path });
            }
        }
    }

    /// Answers a question from the shown capture, on the reader thread. Does nothing where no capture is shown.
    fn read(&mut self, asked: PendingQuestion) {
        let Some(capture) = self.inspector.model.frame.capture.as_ref().cloned() else { return };
        let reading = ReadRequest { asked, capture, plan: self.inspector.model.frame.plan.as_ref().cloned() };
        let begun = self.reader.read(reading, &self.notify);
        self.say_if_failed(begun);
    }

    /// Renders the open scene with the technique and settings of a row of the report; shows an error where they can't
    /// be parsed.
    fn open_report_row(&mut self, row: TechniqueRequest) {
        match Choice::parse(&row) {
            Ok(choice) => self.inspector.choose(choice).into_iter().for_each(|action| self.act(action)),
            Err(error) => self.inspector.model.push_error(error.to_string()),
        }
    }

    /// Asks for a scene or model file, or for a capture folder, in the system's dialog on a thread of its own: the
    /// chosen path comes as `WindowNews::Chosen`, nothing where the dialog is cancelled, and an error is shown where no
    /// thread can be started.
    fn browse(&mut self, wanted: DialogFilter) {
        let dialog = rfd::AsyncFileDialog::new();
        // Created here, as some systems allow dialogs on the main thread only.
        let dialog: Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match wanted {
            DialogFilter::File => {
                let dialog = dialog.set_title("Open a scene or a model");
                Box::pin(dialog.add_filter("scenes and models", &["toml", "obj", "ply", "gltf", "glb"]).pick_file())
            }
            DialogFilter::Folder => Box::pin(dialog.set_title("Open a capture folder").pick_folder()),
        };
        let notify = Arc::clone(&self.notify);
        let wait = move || {
            if let Some(chosen) = pollster::block_on(dialog) {
                notify(WindowNews::Chosen(chosen.path().display().to_string()));
            }
        };
        if let Err(error) = std::thread::Builder::new().name("file dialog".to_owned()).spawn(wait) {
            self.inspector.model.push_error(format!("the file dialog can't be opened: {error}; type the path instead"));
        }
    }

    /// Asks with the system's save dialog where to export to, on a thread of its own, with the file name of `path`
    /// suggested. The chosen path comes as `WindowNews::ChosenExport`; nothing comes where the dialog is cancelled.
    fn browse_export(&mut self, path: &str) {
        let dialog = rfd::AsyncFileDialog::new().set_title("Export");
        let name = Path::new(path).file_name().map(|name| name.to_string_lossy().into_owned());
        let dialog = dialog.set_file_name(name.unwrap_or_default());
        let notify = Arc::clone(&self.notify);
        let wait = move || {
            // A capture is a folder: its path is chosen like that of a new file.
            if let Some(file) = pollster::block_on(dialog.save_file()) {
                notify(WindowNews::ChosenExport(file.path().display().to_string()));
            }
        };
        if let Err(error) = std::thread::Builder::new().name("file dialog".to_owned()).spawn(wait) {
            self.inspector.model.push_error(format!("the file dialog can't be opened: {error}; type the path instead"));
        }
    }

    /// Shows how an export ended: its result, its failure, or, where the path is taken, the question whether to replace
    /// the file.
    pub fn end_export(&mut self, exported: Exported) {
        match exported {
            Exported::Done(what) => self.inspector.end_export(Ok(what)),
            Exported::Taken(path) => self.inspector.ask_to_replace(path),
            Exported::Failed(reason) => self.inspector.end_export(Err(reason)),
        }
    }

    /// Stores the window's settings if they have changed since the last time; does nothing where nothing is watched (a
    /// run without a window). A failure is shown in the panels, and not tried again until they change.
    pub fn remember(&mut self) {
        let now = self.inspector.remembered();
        if self.watch.is_some() && now != self.remembered {
            if let Err(reason) = memory::store(&now) {
                self.inspector.model.push_error(reason);
            }
            self.remembered = now;
        }
    }
}
