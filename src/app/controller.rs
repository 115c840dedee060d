//! The logic of the window without the window: the panels, the worker, and the messages between them.
//!
//! The window, the benchmark of the panels and the pictures of the README all draw [`Controller::inspector`], pass its
//! actions to [`Controller::act`] and its events to [`Controller::wake`].

use super::export;
use super::news::{Exported, News, Notify, WindowNews};
use super::queue::Order;
use super::reader::{NoReader, ReadRequest, Reader};
use super::worker::{Worker, WorkerStart};
use super::{AppError, ViewRequest};
use crate::ask::{FilmOf, FilmSubject, PendingQuestion, QuestionKind};
use crate::capture::Capture;
use crate::files::is_folder;
use crate::import::{SHIPPED, ShippedFrame};
use crate::inspector::{Action, ExportData, Inspector, SceneEntry, StoredSettings, whole_path};
use crate::link::ViewLink;
use crate::reading::picture_view::PictureKind;
use crate::scene::TechniqueRequest;
use crate::scene::builtin::{self, Builtin};
use crate::session::RunFrame;
use crate::stress::StressCase;
use crate::technique::Choice;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// What a dialog for opening shows: files or folders, never both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DialogFilter {
    /// Files of scenes and models.
    File,
    /// Folders of captures.
    Folder,
}

/// What is around the panels: a desktop, the page of a browser, or nothing.
pub trait Surroundings {
    /// Returns the settings that an earlier run stored; the default ones where there are none.
    fn load_settings(&mut self) -> StoredSettings {
        StoredSettings::default()
    }

    /// Stores the settings for later runs.
    ///
    /// # Errors
    /// They can't be stored: the reason, and how to fix it.
    fn store_settings(&mut self, _settings: &StoredSettings) -> Result<(), String> {
        Ok(())
    }

    /// Reports later changes of these files, and of no others, as `WindowNews::FileChanged`.
    fn watch(&mut self, _files: Vec<PathBuf>) {}

    /// Asks the user for something to open: the chosen path comes as `WindowNews::Chosen`, nothing where the dialog is
    /// cancelled.
    ///
    /// # Errors
    /// There can be no dialog: the reason, and what to do instead.
    fn browse(&mut self, _wanted: DialogFilter) -> Result<(), String> {
        Ok(())
    }

    /// Hands a link to what is shown to the user; what was done is reported as an export.
    ///
    /// # Errors
    /// There is no address to link to: the reason.
    fn share(&mut self, _link: &ViewLink) -> Result<(), String> {
        Err("only the window in a browser has an address that can be shared".to_owned())
    }

    /// Asks the user where to export to, with the file name of `path` suggested: the chosen path comes as
    /// `WindowNews::ChosenExport`, nothing where the dialog is cancelled.
    ///
    /// # Errors
    /// There can be no dialog: the reason, and what to do instead.
    fn browse_export(&mut self, _path: &str) -> Result<(), String> {
        Ok(())
    }
}

/// A frame that takes longer to capture is followed by previews while it is changed: with what the window takes to draw
/// itself, ten pictures a second.
const SLOW_FROM: Duration = Duration::from_millis(40);

/// Joins the panels, the worker, the reader and what is around the window: hands the panels' actions on as orders, and
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
    reader: Reader,
    surroundings: Box<dyn Surroundings>,
    /// Index of the step that is selected when the first capture comes.
    first_step: Option<usize>,
    first_pick: Option<[u32; 2]>,
    first_is_error: bool,
    /// A scene was opened, and no frame of it was shown yet.
    is_new_scene: bool,
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
    /// Opens what is asked for. `notify` wakes the event loop that draws. Settings of the previous run are loaded, and
    /// those of this run are stored.
    pub fn new(
        request: ViewRequest,
        notify: Notify,
        mut surroundings: Box<dyn Surroundings>,
    ) -> Result<Controller, AppError> {
        let start = WorkerStart {
            source: request.source,
            name: request.name,
            capture: request.capture,
            time: request.time,
            adapter: request.adapter,
            slow_from: SLOW_FROM,
        };
        let to_window = Arc::clone(&notify);
        let worker = Worker::start(start, move |news| to_window(WindowNews::Worker(news)))?;
        let entry = |name: &str, lesson: &str| SceneEntry { name: name.to_owned(), lesson: lesson.to_owned() };
        let scenes = builtin::ALL.iter().map(|builtin| entry(builtin.name, builtin.lesson)).collect();
        let mut inspector = Inspector::new(scenes);
        inspector.offer_frames(SHIPPED.iter().map(|shipped| entry(shipped.name, shipped.lesson)).collect());
        inspector.recall(surroundings.load_settings());
        let remembered = inspector.remembered();
        inspector.set_job(Some("starting".to_owned()));
        Ok(Controller {
            inspector,
            worker,
            notify,
            scene: 0,
            frame: 0,
            run: None,
            reader: Reader::default(),
            surroundings,
            first_step: request.step,
            first_pick: request.pick,
            first_is_error: request.truth,
            is_new_scene: true,
            remembered,
        })
    }

    /// Handles an event that woke the window. A path that the open dialog gave is opened, a file that changed is only
    /// noted in the panels, and an answer read from the capture also begins the question that waits for the reader.
    pub fn wake(&mut self, news: WindowNews) {
        match news {
            WindowNews::Worker(news) => self.hear(news),
            WindowNews::Chosen(path) => self.act(Action::Open(path)),
            WindowNews::ChosenExport(path) => self.inspector.set_export_path(path),
            WindowNews::NoChooser(reason) => self.inspector.push_no_chooser(reason),
            WindowNews::Exported(exported) => self.end_writing(exported),
            WindowNews::Read { ticket, result } => {
                self.inspector.answer(ticket, result, true);
                let next = self.reader.go_on(&self.notify);
                self.say_if_failed(next);
            }
            WindowNews::FileChanged(file) => self.inspector.model.activity.changed_file = Some(file),
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
                self.surroundings.watch(files);
                self.scene = scene_number;
                self.is_new_scene = self.inspector.is_other_scene(source.as_deref());
                self.inspector.open_scene(&scene, *request, source);
                self.remember();
            }
            News::OpenedFolder { capture, source } => {
                self.surroundings.watch(Vec::new());
                self.inspector.set_job(None);
                self.run = None;
                self.is_new_scene = true;
                self.inspector.open_folder(Some(&source));
                self.show(capture);
            }
            News::Captured { frame, run } => {
                self.frame = frame;
                self.show(Arc::clone(&run.capture));
                self.inspector.set_plan(Arc::clone(&run.plan));
                self.run = Some(run);
            }
            News::Previewed { frame, plan, capture } => {
                self.frame = frame;
                self.run = None;
                self.inspector.set_preview(capture);
                self.inspector.set_plan(plan);
            }
            News::Answered { ticket, result } => self.inspector.answer(ticket, result, true),
            News::AnsweredPart { ticket, answer } => self.inspector.answer(ticket, Ok(answer), false),
            News::AnswerEnded { ticket } => self.inspector.model.answers.end(ticket),
            News::Exported(exported) => self.end_export(exported),
            News::Warned(what) => self.inspector.model.push_warning(what),
            News::Failed(reason) => self.inspector.push_failure(reason),
            News::NotOpened { source, reason } => self.inspector.push_unopened(&source, reason),
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
        let first_look = std::mem::take(&mut self.is_new_scene);
        if let Some(pick) = self.first_pick.take() {
            self.inspector.model.selection.pick = Some(pick);
        } else if first_look {
            self.inspector.model.take_first_look();
        }
    }

    /// Carries out an action of the panels: most become an order to the worker; dialogs, exports and questions that are
    /// answered from the capture run beside the window. Opening, running and reloading stop long work first.
    /// Failures are shown in the panels.
    pub fn act(&mut self, action: Action) {
        let order = match action {
            Action::Open(name) => {
                self.inspector.model.answers.make_way();
                Order::Open(name)
            }
            Action::Run(request) => {
                self.inspector.model.answers.make_way();
                Order::Run { scene: self.scene, request, is_moving: self.inspector.model.is_dragging }
            }
            Action::CompletePreview => Order::CompletePreview,
            Action::Ask(asked) if asked.ask.kind().is_read_from_capture() => return self.read(asked),
            Action::Ask(asked) => Order::Answer { scene: self.scene, frame: self.frame, asked },
            Action::Browse => return self.show_if_refused(|around| around.browse(DialogFilter::File)),
            Action::BrowseFolder => return self.show_if_refused(|around| around.browse(DialogFilter::Folder)),
            Action::Share => return self.share(),
            Action::BrowseExport { path } => return self.show_if_refused(|around| around.browse_export(&path)),
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
                        (ExportData::Page { capture, look, diagnosis }, Some(run)) => {
                            let run = Box::new(RunFrame { capture, ..run.clone() });
                            export::ExportContent::Page { run, look, diagnosis }
                        }
                        (data, _) => export::ExportContent::Panels(data),
                    };
                    return self.write(data, path, replace);
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
            let lost = "the worker is gone: close the window and start again";
            self.inspector.model.push_error(lost.to_owned());
        }
    }

    /// Writes an export beside the window, where it may be written; otherwise shows why not, or asks whether to replace what
    /// is there, and starts nothing.
    fn write(&mut self, data: export::ExportContent, path: String, replace: bool) {
        if let Some(problem) = export::refused(&data, &path, replace) {
            return self.end_export(problem);
        }
        let name =
            Path::new(&path).file_name().map_or_else(|| path.clone(), |name| name.to_string_lossy().into_owned());
        self.inspector.begin_writing(name);
        if let Err(error) = export::start(data, path, replace, Arc::clone(&self.notify)) {
            self.inspector.end_writing(Err(format!("nothing can be written now: {error}; try again")));
        }
    }

    /// Asks the worker for a film, where it may be written; otherwise shows why not, or asks whether to replace the
    /// file, and starts nothing.
    fn film(&mut self, subject: FilmSubject, path: String, replace: bool) {
        match export::check(Path::new(&path), replace) {
            Some(problem) => self.end_export(problem),
            None => {
                self.inspector.begin_export();
                // What is said in the end names the folder, too.
                let path = whole_path(Path::new(&path));
                let pick = self.inspector.model.selection.pick;
                self.inspector.model.answers.start(FilmOf { subject, path, pick });
            }
        }
    }

    /// Answers a question from the shown capture, beside the window. Does nothing where no capture is shown.
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

    /// Shares a link to what is open, with the selected step and pixel; shows what the link does not carry, or why there is
    /// none.
    fn share(&mut self) {
        let model = &self.inspector.model;
        let source = match &model.scene {
            Some(scene) => scene.source.clone(),
            None => model.recent.first().cloned(),
        };
        // A folder may have any name.
        let source = source.filter(|source| !is_folder(Path::new(source)));
        let builtin = source.as_deref().and_then(Builtin::named).map(Builtin::scene);
        let linked = match (&source, builtin, &model.scene) {
            (Some(name), Some(Ok(scene)), Some(open)) => {
                let link = ViewLink::of_run(name, &scene, &open.draft);
                let lacks = link.lacks(&scene, &open.draft);
                Some((link, lacks))
            }
            (Some(name), _, None) if ShippedFrame::named(name).is_some() => {
                Some((ViewLink { scene: Some(name.clone()), ..ViewLink::default() }, None))
            }
            _ => None,
        };
        let Some((link, lacks)) = linked else {
            let reason = "only scenes and frames that the program brings have a link: export the scene or the capture, \
                          and send the file";
            return self.inspector.model.push_error(reason.to_owned());
        };
        let link = ViewLink {
            step: model.frame.capture.is_some().then_some(model.selection.step),
            pixel: model.selection.pick,
            truth: model.view.wants_truth(),
            ..link
        };
        self.show_if_refused(|around| around.share(&link));
        if let Some(lacks) = lacks {
            let warning = format!("the link opens the scene without {lacks}: export the scene for that");
            self.inspector.model.push_warning(warning);
        }
    }

    fn show_if_refused(&mut self, ask: impl FnOnce(&mut dyn Surroundings) -> Result<(), String>) {
        if let Err(reason) = ask(&mut *self.surroundings) {
            self.inspector.model.push_error(reason);
        }
    }

    /// Shows how an export ended that was begun with [`Controller::write`].
    fn end_writing(&mut self, exported: Exported) {
        match exported {
            Exported::Done(what) => self.inspector.end_writing(Ok(what)),
            Exported::Failed(reason) => self.inspector.end_writing(Err(reason)),
            // Something was put there meanwhile.
            Exported::Taken(path) => {
                self.inspector
                    .end_writing(Err(format!("something of the name {path} is there already: export it again")));
            }
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

    /// Stores the window's settings if they have changed since the last time. A failure is shown in the panels, and not
    /// tried again until they change.
    pub fn remember(&mut self) {
        let now = self.inspector.remembered();
        if now != self.remembered {
            self.show_if_refused(|around| around.store_settings(&now));
            self.remembered = now;
        }
    }
}
