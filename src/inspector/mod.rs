//! The inspector: egui panels that show a frame and say what the user wishes.
//!
//! Panels are a function of the model (`model/mod.rs`): they read it, change what is selected in it, and return
//! [`Action`]s. They open no file, run nothing and know no GPU; what has to be found out they want of the model's
//! [`Answers`](model::Model::answers), and whoever draws the inspector answers. So they can be driven and tested
//! without a window.
//!
//! ```text
//! Inspector::ui ─ keys ─ top_bar ─ messages ─ docked panels ─ status_bar ─ dialogs ─► Actions, questions among them
//!
//! model/   what is shown: frame, scene, selection, answers     panels/  the tabs, each with what it remembers
//! canvas/  a picture: zoom, pan, pick, what lies over it       shell/   bars, dialogs, keys, walking, tours, docking
//! look/    colours, textures, small widgets                    action.rs, tours.rs
//! ```
//!
//! What a frame says, without widgets, is in [`reading`](crate::reading).

mod action;
mod canvas;
mod look;
pub mod model;
mod panels;
mod shell;
mod tours;

pub use action::{Action, DialogKind, ExportKind, LayoutPreset, Overlay, PanelKind, TourSubject};
pub use model::WindowPlace;
pub use model::diagnosed::KnownDiagnosis;
pub use model::memory::{ClosedWindow, StoredSettings, ThemeChoice};
pub use panels::picture::as_shown::{BothSides, PictureDrawing};
pub use shell::export::{ExportData, whole as whole_path};
pub use shell::open_dialog::{SceneEntry, THUMBNAIL};
pub use tours::{TOURS, Tour, TourClaim, TourMove, TourStop};

use crate::ask::{Answer, Question, QuestionKind, RunRequest};
use crate::capture::{Capture, Image};
use crate::plan::FramePlan;
use crate::reading::capture_point::CapturePoint;
use crate::reading::picture_view::{PictureKind, TexelZoom};
use crate::scene::Scene;
use crate::technique::{Choice, Technique};
use look::theme;
use model::Model;
use model::comparing::{ComparedWith, Comparison};
use panels::Panels;
use shell::dock::Dock;
use shell::export::{self, ExportDialog};
use shell::open_dialog::{self, OpenDialog};
use shell::tour::{self, Tours};
use shell::{help, keys, messages, status_bar, top_bar, view_menu, walk};
use std::sync::Arc;
use std::time::Duration;

/// All panels with their state: draws a window's contents, and returns as actions what has to be done outside.
#[derive(Debug)]
pub struct Inspector {
    /// What the panels look at, and what is selected in it.
    pub model: Model,
    panels: Panels,
    dock: Dock,
    open_dialog: OpenDialog,
    export_dialog: Option<ExportDialog>,
    tours: Tours,
    focus_before: keys::FocusBefore,
    styled: bool,
}

impl Default for Inspector {
    fn default() -> Inspector {
        Inspector::new(Vec::new())
    }
}

impl Inspector {
    /// Creates the panels with nothing open; `scenes` are the built-in scenes that the open dialog offers.
    pub fn new(scenes: Vec<SceneEntry>) -> Inspector {
        Inspector {
            model: Model::default(),
            panels: Panels::default(),
            dock: Dock::new(),
            open_dialog: OpenDialog::new(scenes),
            export_dialog: None,
            tours: Tours::default(),
            focus_before: keys::FocusBefore::default(),
            styled: false,
        }
    }

    /// Sets the frames of other programs that the open dialog offers besides the scenes, in place of earlier ones.
    pub fn offer_frames(&mut self, frames: Vec<SceneEntry>) {
        self.open_dialog.frames = frames;
    }

    /// Draws all panels for one frame, handles keys, dropped files, animation and playing, and returns the actions that
    /// the user asked for and the questions that have to be answered.
    pub fn ui(&mut self, ui: &mut egui::Ui) -> Vec<Action> {
        self.style(ui);
        self.zoom(ui.ctx());
        let mut actions = Vec::new();
        let Inspector { model, panels, dock, open_dialog, export_dialog, tours, focus_before, .. } = self;
        let now = ui.input(|input| input.time);
        model.textures.tick();
        model.selection.begin_frame();
        model.answers.tick(now);
        take_dropped_files(ui.ctx(), &mut actions);
        let was_dragging = std::mem::replace(&mut model.is_dragging, ui.input(|input| input.pointer.any_down()));
        if was_dragging && !model.is_dragging && model.frame.is_preview {
            actions.push(Action::CompletePreview);
        }
        model.undo.hold(model.is_dragging || model.walk.is_on());
        model.finish_restoring(&mut actions);
        if !walk::handle(ui.ctx(), model, &mut actions) {
            keys::handle(ui.ctx(), focus_before, model, &mut actions);
        }
        if let Some(seconds) = model.play(now) {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(seconds));
        }
        top_bar::ui(ui, model, &mut actions);
        messages::ui(ui, model, &mut actions);
        status_bar::ui(ui, model);
        tour::ui(ui, tours, model, &mut actions);
        dock.ui(ui, panels, model, &mut actions);
        // Where the picture is not shown, or several are, no menu opens and no pick moves when one is one day.
        model.requests.overlay_menu = false;
        model.requests.differing_regions = 0;
        open_dialog::ui(ui.ctx(), open_dialog, model, &mut actions);
        export::ui(ui.ctx(), export_dialog, model, &mut actions);
        help::ui(ui.ctx(), model);
        if let Some(preset) = model.requests.layout.take() {
            // In points of the size that it comes with.
            let zoom = ui.ctx().zoom_factor();
            let larger = model.requests.zoom.unwrap_or(zoom) / zoom;
            dock.arrange(preset, ui.ctx().content_rect().width() / larger);
        }
        model.animate(now, &mut actions);
        let [now_pointed, was_pointed] = model.selection.pointed;
        if now_pointed != was_pointed {
            // Panels that were drawn before the row mark it, or no longer do, in another frame.
            ui.ctx().request_repaint();
        }
        *focus_before = keys::remember(ui.ctx());
        self.ask(ui.ctx(), &mut actions);
        actions
    }

    /// Applies the inspector's style in the first frame, and the chosen theme whenever egui's is another.
    fn style(&mut self, ui: &mut egui::Ui) {
        if !self.styled {
            theme::apply(ui.ctx());
        }
        let theme = self.model.theme.in_egui();
        if !std::mem::replace(&mut self.styled, true) || ui.ctx().theme() != theme {
            ui.ctx().set_theme(theme);
            ui.reset_style();
        }
    }

    /// Sets how large everything is, where that is asked for, and notes how large it is: egui has keys for it, too.
    fn zoom(&mut self, ctx: &egui::Context) {
        let wanted = self.model.requests.zoom.take();
        wanted.into_iter().for_each(|zoom| ctx.set_zoom_factor(zoom));
        self.model.zoom = Some(wanted.unwrap_or_else(|| ctx.zoom_factor()));
    }

    /// Adds, as actions, the questions that this frame's panels want and whose answers are not known: also truth,
    /// states after draws, test results, a channel of the light and history where the picture needs them.
    fn ask(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let model = &mut self.model;
        model.want_truth();
        let _ = (model.want_draws(), model.want_tests_shown(), model.want_channel());
        if let Some(seconds) = model.want_history_until() {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds));
        }
        actions.extend(model.answers.take_asked().into_iter().map(Action::Ask));
    }

    /// Takes the answer to the question with this ticket, or the reason why there is none and what would help. An
    /// answer to a question that was dropped is ignored. `is_last`: no further answer to it comes.
    pub fn answer(&mut self, ticket: u64, result: Result<Answer, String>, is_last: bool) {
        let failure = result.as_ref().err().cloned();
        match (self.model.answers.answer(ticket, result, is_last), failure) {
            (Some(QuestionKind::FilmOf), Some(reason)) => self.model.push_error(reason),
            (Some(QuestionKind::TruthOf), Some(_)) => self.model.view.older_truth = None,
            (Some(kind), None) => self.model.take_in(kind),
            _ => {}
        }
    }

    /// Stores the answer to a question that was not asked through an action, or the reason why there is none, and adds
    /// an answer to the shown frame where it belongs there.
    pub fn take_in<Q: Question>(&mut self, question: Q, result: Result<Arc<Q::Answer>, String>) {
        let is_known = result.is_ok();
        self.model.answers.take_in(question, result);
        if is_known {
            self.model.take_in(Q::KIND);
        }
    }

    /// Another scene is open, to be run as `draft` says.
    pub fn set_scene(&mut self, scene: &Scene, draft: RunRequest) {
        self.open_scene(scene, draft, None);
    }

    /// Shows that another scene is open, to be run as `draft` says; nothing is run. `source` opens it again: a built-in
    /// name or a path, `None` where it can't be.
    pub fn open_scene(&mut self, scene: &Scene, draft: RunRequest, source: Option<String>) {
        self.model.set_scene(Some((scene, draft)), source);
        self.model.activity.forget_export();
        self.close_open_dialog();
        self.panels.follow(&self.model);
    }

    /// Returns whether what `source` opens is another scene than the open one, or nothing is open by name.
    pub fn is_other_scene(&self, source: Option<&str>) -> bool {
        let open = self.model.scene.as_ref().and_then(|scene| scene.source.as_deref());
        open.is_none() || open != source
    }

    /// Returns how the open scene is to be run next; `None` where no scene is open, as with a capture folder.
    pub fn draft(&self) -> Option<Box<RunRequest>> {
        self.model.scene.as_ref().map(|scene| Box::new(scene.draft.clone()))
    }

    /// Sets the plan that was run for the shown capture, so that questions that need the plan can be asked.
    pub fn set_plan(&mut self, plan: Arc<FramePlan>) {
        self.model.frame.plan = Some(plan);
        self.model.answers.know_plan();
    }

    /// Returns the settings to store until the window is opened again: theme, size of everything, recent sources, layout,
    /// and the window's size.
    pub fn remembered(&self) -> StoredSettings {
        let Model { theme, closed, knows_tours, zoom, .. } = self.model;
        let zoom = self.model.requests.zoom.or(zoom).filter(|zoom| *zoom != 1.0);
        let (recent, layout) = (self.model.recent.clone(), self.dock.layout());
        StoredSettings { theme, zoom, recent, closed, knows_tours, layout }
    }

    /// Restores stored settings; of the layout only where one is stored.
    pub fn recall(&mut self, remembered: StoredSettings) {
        self.model.theme = remembered.theme;
        self.model.requests.zoom = {
            let [least, most] = [*view_menu::ZOOMS.start(), *view_menu::ZOOMS.end()];
            // Keys go further than the menu, as far as egui does.
            remembered.zoom.filter(|zoom| (0.2..=5.0).contains(zoom)).map(|zoom| zoom.clamp(least, most))
        };
        self.model.recent = remembered.recent;
        self.model.closed = remembered.closed;
        self.model.knows_tours = remembered.knows_tours;
        if let Some(layout) = remembered.layout {
            self.dock.restore(layout);
        }
    }

    /// Compares the shown picture with that of the same frame rendered with another technique, under a divider;
    /// replaces a comparison that is shown.
    pub fn compare_with(&mut self, technique: Technique) {
        let compare =
            Comparison { with: ComparedWith::Technique(technique), ..Comparison::new(self.model.selection.step) };
        self.model.modes.compare = Some(compare);
    }

    /// Replaces the open scene's draft and returns the actions that run it; none where no scene is open, or the draft
    /// can't be run (the reason is then shown).
    pub fn rerun(&mut self, draft: RunRequest) -> Vec<Action> {
        let mut actions = Vec::new();
        self.model.replace_draft(draft, &mut actions);
        actions
    }

    /// Returns how many stops the tour of a technique has.
    pub fn stops_of(technique: Technique) -> usize {
        tour::stops_of(technique)
    }

    /// Goes to the stop of this index in the tour of a technique; returns the actions that it needs.
    pub fn go_to_stop(&mut self, technique: Technique, stop: usize) -> Vec<Action> {
        let mut actions = Vec::new();
        self.tours.go_to_stop_of(&mut self.model, technique, stop, &mut actions);
        actions
    }

    /// Ends the tour that is running, and returns the actions that give back what it changed; none where none is running.
    pub fn end_tour(&mut self) -> Vec<Action> {
        let mut actions = Vec::new();
        self.tours.end(&mut self.model, &mut actions);
        actions
    }

    /// Returns what an export of `kind` writes now; `None` where there is nothing of it.
    pub fn export(&mut self, kind: ExportKind) -> Option<ExportData> {
        export::data(&mut self.panels.picture, &mut self.model, kind)
    }

    /// Sets the path in the export dialog; does nothing where that dialog is not open.
    pub fn set_export_path(&mut self, path: String) {
        if let Some(dialog) = &mut self.export_dialog {
            dialog.path = path;
        }
    }

    /// Shows in the export dialog that something exists at `path`, and asks whether to replace it; does nothing where
    /// the dialog is not open.
    pub fn ask_to_replace(&mut self, path: String) {
        if let Some(dialog) = &mut self.export_dialog {
            dialog.taken = Some(path);
        }
    }

    /// Closes the export dialog, as an export has begun.
    pub fn begin_export(&mut self) {
        self.export_dialog = None;
        if matches!(self.model.dialog, Some(DialogKind::Export(_))) {
            self.model.dialog = None;
        }
    }

    /// An export into a file of this name was begun beside the window: closes the dialog, and says what is written.
    pub fn begin_writing(&mut self, name: String) {
        self.begin_export();
        self.model.activity.exporting.push(name);
    }

    /// Shows how an export that was begun beside the window ended: what was written, or why it failed and what would help.
    /// A dialog that is open meanwhile is about another one.
    pub fn end_writing(&mut self, result: Result<String, String>) {
        let activity = &mut self.model.activity;
        activity.written += 1;
        // They end in any order: which of several has ended is not known.
        if activity.written >= activity.exporting.len() {
            activity.exporting.clear();
            activity.written = 0;
        }
        match result {
            Ok(done) => activity.note_export(done),
            Err(reason) => self.model.push_error(reason),
        }
    }

    /// Shows how an export ended: what was written, and closes its dialog; or why it failed and what would help, in the
    /// dialog if it is open, otherwise as an error.
    pub fn end_export(&mut self, result: Result<String, String>) {
        match (result, &mut self.export_dialog) {
            (Ok(done), _) => {
                self.model.activity.note_export(done);
                self.begin_export();
            }
            (Err(reason), Some(dialog)) => dialog.error = Some(reason),
            (Err(reason), None) => self.model.push_error(reason),
        }
    }

    /// What is open can't be run again: a capture folder, which `source` opens, where anything does by name.
    pub fn open_folder(&mut self, source: Option<&str>) {
        if let Some(source) = source {
            self.model.note_recent(source);
        }
        self.model.set_scene(None, None);
        self.close_open_dialog();
        self.panels.follow(&self.model);
    }

    /// Closes the dialog that opens scenes where it waits for what was typed there, which is open now.
    fn close_open_dialog(&mut self) {
        if self.open_dialog.end_waiting() && self.model.dialog == Some(DialogKind::Open) {
            self.model.dialog = None;
        }
    }

    /// Shows a capture of a new frame; the selected step and pixel stay where they mean the same. Frees what is cached
    /// for pictures that are no longer used.
    pub fn set_capture(&mut self, capture: Arc<Capture>) {
        self.model.set_capture(capture);
        self.panels.follow(&self.model);
        self.model.textures.forget_unused();
    }

    /// Shows the capture of a preview, which the whole frame will replace once nothing changes any more.
    pub fn set_preview(&mut self, capture: Arc<Capture>) {
        self.model.set_preview(capture);
        self.panels.follow(&self.model);
        self.model.textures.forget_unused();
    }

    /// Returns the index of the event of the selected triangle in the history of the picked pixel; `None` where the
    /// history is not known, or no triangle that is in it is selected.
    pub fn selected_event(&self) -> Option<usize> {
        let history = self.model.history_of_frame()?;
        self.model.selected_in(&history)
    }

    /// Sets the technique and settings of the open scene, and returns the actions that run it; none where no scene is
    /// open.
    pub fn choose(&mut self, choice: Choice) -> Vec<Action> {
        let mut actions = Vec::new();
        self.model.choose(choice, &mut actions);
        actions
    }

    /// Sets what is being done, in a few words; `None` when nothing is, and then a run that failed is no longer waited
    /// for.
    pub fn set_job(&mut self, job: Option<String>) {
        // Nothing is done: what failed is not waited for.
        self.model.activity.is_waiting &= job.is_some();
        self.model.activity.job = job;
    }

    /// Shows why a scene could not be opened or its frame not be captured, until one succeeds or the message is
    /// dismissed. A tour that waits for it shows it too.
    pub fn push_failure(&mut self, error: String) {
        self.tours.note_error(&error);
        self.model.push_failure(error);
    }

    /// Shows why a source could not be opened: in the open dialog, with its path, where it was typed there, otherwise as
    /// [`Inspector::push_failure`] does.
    pub fn push_unopened(&mut self, source: &str, error: String) {
        if self.open_dialog.take_back(source, &error) {
            self.tours.note_error(&error);
            self.model.dialog = Some(DialogKind::Open);
        } else {
            self.push_failure(error);
        }
    }

    /// Selects a draw of a step, by their indices; the whole step where it has no such draw, and the last step where
    /// there is no such step.
    pub fn select_draw(&mut self, step: usize, draw: usize) {
        self.model.select(CapturePoint { step, draw: Some(draw) });
    }

    /// Shows that the system has no dialog that chooses files, in the dialog that asked for it, where a path can be typed.
    pub fn push_no_chooser(&mut self, reason: String) {
        match &mut self.export_dialog {
            Some(dialog) => dialog.error = Some(reason),
            None => {
                self.open_dialog.refuse(reason);
                self.model.dialog = Some(DialogKind::Open);
            }
        }
    }

    /// Returns the images of the picture that is shown (several for a map of several faces); empty where none is shown.
    pub fn shown_images(&self) -> Vec<Arc<Image>> {
        let shown = |capture: &Arc<Capture>| self.model.shown(capture);
        self.model.frame.capture.as_ref().and_then(shown).map_or_else(Vec::new, |shown| shown.images)
    }

    /// Returns the texel that a pixel reads of the map shown in the shadow map tab: index of the face, column and row;
    /// with a filter, the middle texel. `None` where it reads none, or the tab was not shown for this frame yet.
    pub fn map_texel_of(&self, pixel: [u32; 2]) -> Option<(usize, [u32; 2])> {
        let readers = self.panels.shadow_map.readers(&self.model)?;
        readers.texel_of(pixel).map(|texel| (texel.face, texel.at))
    }

    /// Returns the depth that the shadow map in its tab is compared with at a pixel; `None` as for its texel.
    pub fn map_depth_of(&self, pixel: [u32; 2]) -> Option<f64> {
        self.panels.shadow_map.readers(&self.model)?.depth_of(pixel)
    }

    /// Returns the kind of picture that is shown; `None` where there is no capture, or it has no picture at the shown
    /// point.
    pub fn picture_kind(&self) -> Option<PictureKind> {
        let capture = self.model.frame.capture.as_ref()?;
        self.model.shown(capture).map(|shown| shown.kind)
    }

    /// Sets the size in which texels are shown, and the point of the picture, in texels, that is in the middle of the
    /// panel.
    pub fn set_zoom(&mut self, zoom: TexelZoom, center: [f64; 2]) {
        self.model.view.zoom = zoom;
        self.model.view.center = center;
    }
}

/// Adds an action that opens the file dropped onto the window in this frame; of several, only the last.
fn take_dropped_files(ctx: &egui::Context, actions: &mut Vec<Action>) {
    let dropped = ctx.input(|input| input.raw.dropped_files.last().map(|file| file.path().display().to_string()));
    actions.extend(dropped.map(Action::Open));
}
