//! The inspector: egui panels that show a capture and say what the user wishes.
//!
//! Panels are a function of state: they read data (capture, scene, technique) and return
//! [`Action`]s. They open no file, run nothing and know no GPU; the app does that and hands back
//! data. So they can be driven and tested without a window.
//!
//! ```text
//! Inspector::ui ─ keys ─ top_bar ─ messages ─ docked panels ─ status_bar ─ open_dialog
//!                                             passes │ settings │ picture │ pixel │ report │ diagnosis │ stress
//! state.rs     what is remembered, and its rules   view.rs       which picture is shown
//! depth.rs     what a stored depth means           placement.rs  where it is on the screen
//! coloring.rs  what a texel means                  texture.rs    pictures as textures, cached
//! layers.rs    maps, textures and silhouettes      counts.rs     counts beyond eight bits
//! findings.rs  the error picture's hatching        truth_note.rs while there is no truth
//! modes.rs     before, after, compare          overlays.rs    what is drawn over it
//! change.rs    what a step changed             shadow_map.rs  the map, linked with the picture
//! map_readers.rs  texels and their readers     fragments.rs   points and normals as the shader has them
//! moment.rs    after a step, or after a draw       draw_level.rs selecting and fetching draws
//! scene_view/  a second camera that sees the first
//! keys.rs      the table of keys, for help.rs    undo.rs, memory.rs, export.rs, animation.rs: as they say
//! as_shown.rs  overlays in a file, filled by raster.rs
//! history.rs   the pick's history, asked for       history_rows.rs, ladder.rs, outline.rs show it
//! ```

mod action;
mod anatomy_state;
mod animation;
mod as_shown;
mod canvas;
mod change;
mod coloring;
mod compare;
mod counts;
mod depth;
mod diagnosis;
mod diagnosis_detail;
mod divider;
mod dock;
mod draw_level;
mod draws;
mod error_legend;
mod explain;
mod explain_facts;
mod export;
mod face_grid;
mod findings;
mod format;
mod fragments;
mod help;
mod history;
mod history_row;
mod history_rows;
mod keys;
mod ladder;
mod ladder_layout;
mod layers;
mod legend;
mod magnifier;
mod map_readers;
mod memory;
mod meshes;
mod messages;
mod modes;
mod modes_bar;
mod modes_legend;
mod moment;
mod object_ids;
mod open_dialog;
mod outline;
mod overlay_lines;
mod overlays;
mod palette;
mod passes;
mod pick_ray;
mod picture;
mod picture_gizmos;
mod pixel;
mod pixel_room;
mod pixel_run;
mod placement;
mod projected;
mod raster;
mod raster_state;
mod report;
mod report_plot;
mod report_table;
mod scene_view;
mod settings;
mod settings_scene;
mod shadow_map;
mod state;
mod status_bar;
mod stress;
mod tests_state;
mod texture;
mod theme;
mod top_bar;
mod tour;
mod tour_stops;
mod transport;
mod truth_note;
mod undo;
mod verdict;
mod view;
mod walk;

pub use action::{Action, RunRequest};
pub use as_shown::Drawing;
pub use diagnosis::{DiagnosisProgress, DiagnosisView};
pub use dock::Panel;
pub use draw_level::DrawsState;
pub use export::{ExportData, ExportKind};
pub use map_readers::{MapReaders, MapReadersFound, MapReadersJob};
pub use memory::{Remembered, ThemeChoice};
pub use meshes::ObjectMesh;
pub use overlays::Overlay;
pub use report::{ReportProgress, ReportView};
pub use state::SceneEntry;
pub use stress::StressProgress;
pub use truth_note::TruthState;
pub use view::{PictureKind, Zoom};

use crate::anatomy::Anatomy;
use crate::capture::{Capture, StepTests};
use crate::history::PixelHistory;
use crate::plan::FramePlan;
use crate::scene::{Scene, Walls};
use crate::technique::{Choice, Technique};
use compare::{Compare, With};
use state::State;
use std::sync::Arc;
use std::time::Duration;

/// All panels and what they remember.
#[derive(Debug)]
pub struct Inspector {
    state: State,
    dock: dock::Dock,
    styled: bool,
}

impl Default for Inspector {
    fn default() -> Inspector {
        Inspector::new(Vec::new())
    }
}

impl Inspector {
    /// With nothing open; `scenes` are the built-in ones that its dialog offers.
    #[must_use]
    pub fn new(scenes: Vec<SceneEntry>) -> Inspector {
        let state = State { scenes, ..State::default() };
        Inspector { state, dock: dock::Dock::new(), styled: false }
    }

    /// Draws everything and returns what the user wishes.
    pub fn ui(&mut self, ui: &mut egui::Ui) -> Vec<Action> {
        if !self.styled {
            theme::apply(ui.ctx());
        }
        if !std::mem::replace(&mut self.styled, true) || ui.ctx().theme() != self.state.theme.in_egui() {
            ui.ctx().set_theme(self.state.theme.in_egui());
            ui.reset_style();
        }
        let mut actions = Vec::new();
        self.state.cache.tick();
        take_dropped_files(ui.ctx(), &mut actions);
        self.state.undo.hold(ui.input(|input| input.pointer.any_down()) || self.state.walk.is_on());
        self.state.finish_restoring(&mut actions);
        if !walk::handle(ui.ctx(), &mut self.state, &mut actions) {
            keys::handle(ui.ctx(), &mut self.state, &mut actions);
        }
        self.play(ui.ctx());
        top_bar::ui(ui, &mut self.state, &mut actions);
        messages::ui(ui, &mut self.state, &mut actions);
        status_bar::ui(ui, &self.state);
        tour::ui(ui, &mut self.state, &mut actions);
        self.dock.ui(ui, &mut self.state, &mut actions);
        open_dialog::ui(ui.ctx(), &mut self.state, &mut actions);
        export::ui(ui.ctx(), &mut self.state, &mut actions);
        help::ui(ui.ctx(), &mut self.state);
        if std::mem::take(&mut self.state.resets_layout) {
            self.dock = dock::Dock::new();
        }
        self.state.animate(ui.ctx(), &mut actions);
        self.state.ask_for_truth(&mut actions);
        self.state.ask_for_draws(&mut actions);
        self.state.ask_for_compared(&mut actions);
        self.state.ask_for_tests(&mut actions);
        self.state.ask_for_history(ui.ctx(), &mut actions);
        self.state.ask_for_anatomy(&mut actions);
        self.state.ask_for_map_readers(&mut actions);
        actions
    }

    fn play(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|input| input.time);
        if let Some(seconds) = self.state.play(now) {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds));
        }
    }

    /// Another scene is open, to be run as `draft` says.
    pub fn set_scene(&mut self, scene: &Scene, draft: RunRequest) {
        self.open_scene(scene, draft, None);
    }

    /// The same, and what opens the scene again: a built-in name or a path.
    pub fn open_scene(&mut self, scene: &Scene, draft: RunRequest, source: Option<String>) {
        self.state.set_scene(Some((scene, draft)), source);
    }

    /// How the open scene is to be run now.
    #[must_use]
    pub fn draft(&self) -> Option<Box<RunRequest>> {
        self.state.scene.as_ref().map(|scene| Box::new(scene.draft.clone()))
    }

    /// What was run for the capture that is shown.
    pub fn set_plan(&mut self, plan: Arc<FramePlan>) {
        self.state.plan = Some(plan);
    }

    /// The file of the open scene, or one that it is made of, changed.
    pub fn offer_reload(&mut self, file: String) {
        self.state.changed_file = Some(file);
    }

    /// What is to be remembered until the window is opened again.
    #[must_use]
    pub fn remembered(&self) -> Remembered {
        let layout = self.dock.layout();
        Remembered { theme: self.state.theme, recent: self.state.recent.clone(), layout }
    }

    /// Looks as it did when this was remembered.
    pub fn recall(&mut self, remembered: Remembered) {
        self.state.theme = remembered.theme;
        self.state.recent = remembered.recent;
        if let Some(layout) = remembered.layout {
            self.dock.restore(layout);
        }
    }

    /// Shows a tab.
    pub fn show_panel(&mut self, panel: Panel) {
        self.state.wants_panel.push(panel);
    }

    /// Lays an overlay over the picture.
    pub fn lay_over(&mut self, overlay: Overlay) {
        self.state.modes.overlays.on.insert(overlay);
    }

    /// Shows the same frame made with another technique beside the picture, under a divider.
    pub fn compare_with(&mut self, technique: Technique) {
        let compare = Compare { with: With::Technique(technique), ..Compare::new(self.state.step) };
        self.state.modes.compare = Some(compare);
    }

    /// Dark or light.
    pub fn set_theme(&mut self, theme: ThemeChoice) {
        self.state.theme = theme;
    }

    /// Runs the open scene like this; what has to be done for it.
    #[must_use]
    pub fn rerun(&mut self, draft: RunRequest) -> Vec<Action> {
        let mut actions = Vec::new();
        if let Some(scene) = &mut self.state.scene {
            scene.draft = draft;
        }
        self.state.run_draft(&mut actions);
        actions
    }

    /// How many stops the tour of a technique has.
    #[must_use]
    pub fn stops_of(technique: Technique) -> usize {
        tour::stops_of(technique)
    }

    /// Goes to a stop of the tour of a technique; what has to be done for it.
    #[must_use]
    pub fn go_to_stop(&mut self, technique: Technique, stop: usize) -> Vec<Action> {
        let mut actions = Vec::new();
        self.state.go_to_stop_of(technique, stop, &mut actions);
        actions
    }

    /// What an export of `kind` writes now; `None` where there is nothing of it.
    #[must_use]
    pub fn export(&mut self, kind: ExportKind) -> Option<ExportData> {
        export::data(&mut self.state, kind)
    }

    /// The place of an export was chosen.
    pub fn set_export_path(&mut self, path: String) {
        if let Some(dialog) = &mut self.state.export.dialog {
            dialog.path = path;
        }
    }

    /// There is something at the place of an export: it is replaced only where that is wished.
    pub fn ask_to_replace(&mut self, path: String) {
        if let Some(dialog) = &mut self.state.export.dialog {
            dialog.taken = Some(path);
        }
    }

    /// An export is done, in words, or failed, with the mend.
    pub fn end_export(&mut self, result: Result<String, String>) {
        match (result, &mut self.state.export.dialog) {
            (Ok(done), _) => {
                self.state.export.done = Some(done);
                self.state.export.dialog = None;
            }
            (Err(reason), Some(dialog)) => dialog.error = Some(reason),
            (Err(reason), None) => self.push_error(reason),
        }
    }

    /// Tells how the meshes of the open scene hang together.
    pub fn set_meshes(&mut self, meshes: Vec<ObjectMesh>) {
        self.state.meshes = Some(meshes);
    }

    /// What is open can't be run again: a capture folder.
    pub fn open_folder(&mut self, source: &str) {
        self.state.note_recent(source);
        self.clear_scene();
    }

    /// The same, of a folder that can't be opened by name again.
    pub fn clear_scene(&mut self) {
        self.state.set_scene(None, None);
    }

    /// Shows a capture; the selected step and pixel stay where they mean the same.
    pub fn set_capture(&mut self, capture: Arc<Capture>) {
        self.state.set_capture(capture);
    }

    /// Shows the same frame, of which more is known: how long it takes, its truth, or its draws. What
    /// is selected stays, and playing goes on.
    pub fn update_capture(&mut self, capture: Arc<Capture>) {
        self.state.update_capture(capture);
    }

    /// Tells how far the truth of the shown frame is.
    pub fn set_truth(&mut self, truth: TruthState) {
        self.state.set_truth(truth);
    }

    /// Tells how the fragments of a step, or of one of its draws, fared in the tests; or why nobody knows.
    pub fn set_tests(&mut self, step: usize, draw: Option<usize>, result: Result<Arc<StepTests>, String>) {
        self.state.set_tests(moment::Moment { step, draw }, result);
    }

    /// The frame of another technique, captured as `request` says, to compare the shown one with; or why
    /// there is none.
    pub fn set_compared(&mut self, request: &RunRequest, result: Result<Arc<Capture>, String>) {
        self.state.modes.compared.answer(request, result);
    }

    /// Tells why there are no states after the draws of a step of the shown frame.
    pub fn set_draws_failed(&mut self, step: usize, reason: String) {
        self.state.set_draws_failed(step, reason);
    }

    /// Tells what happened to pixel `at` of the shown frame, or why that can't be told. An answer
    /// about another pixel than the picked one is dropped.
    pub fn set_history(&mut self, at: [u32; 2], history: Result<Arc<PixelHistory>, String>) {
        // One that was on its way when a folder was opened is of what was open before.
        if self.state.pick == Some(at) && self.state.scene.is_some() {
            self.state.history.answer(at, history);
        }
    }

    /// Tells what the shown frame is made of in space, or why that can't be told.
    pub fn set_anatomy(&mut self, anatomy: Result<Arc<Anatomy>, String>) {
        // One that was on its way when a folder was opened is of what was open before.
        if self.state.scene.is_some() {
            self.state.anatomy.answer(anatomy);
        }
    }

    /// What [`Action::MapReaders`] asks for; `None` while nothing is shown.
    #[must_use]
    pub fn map_readers_job(&self) -> Option<MapReadersJob> {
        Some(self.state.map_tab.readers_job(self.state.capture.clone()?, self.state.plan.clone()))
    }

    /// Tells which texel each pixel reads. An answer to what was asked for before is dropped.
    pub fn set_map_readers(&mut self, found: MapReadersFound) {
        self.state.map_tab.set_readers(found);
    }

    /// Tells what can't be walked through in the open scene.
    pub fn set_walls(&mut self, walls: Arc<Walls>) {
        self.state.walk.set_walls(walls);
    }

    /// Index of the selected event in the history of the picked pixel.
    #[must_use]
    pub fn selected_event(&self) -> Option<usize> {
        self.state.history.selected_in(self.state.history.of(self.state.pick?)?)
    }

    /// Makes shadows of the open scene as `choice` says; what has to be done for it.
    #[must_use]
    pub fn choose(&mut self, choice: Choice) -> Vec<Action> {
        let mut actions = Vec::new();
        self.state.choose(choice, &mut actions);
        actions
    }

    /// The capture that is shown.
    #[must_use]
    pub fn capture(&self) -> Option<&Arc<Capture>> {
        self.state.capture.as_ref()
    }

    /// What is being done, in a few words; `None` when nothing is.
    pub fn set_job(&mut self, job: Option<String>) {
        // Nothing is done: what failed is not waited for.
        self.state.is_waiting &= job.is_some();
        self.state.job = job;
    }

    /// Is anything being done?
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.state.job.is_some()
    }

    /// Shows a report, how far its measuring is, or why there is none.
    pub fn set_report(&mut self, report: ReportView) {
        self.state.report.show(report);
    }

    /// What the Report tab shows.
    #[must_use]
    pub fn report(&self) -> &ReportView {
        self.state.report.view()
    }

    /// Shows a diagnosis, how far it is, or why there is none.
    pub fn set_diagnosis(&mut self, diagnosis: DiagnosisView) {
        self.state.diagnosis.show(diagnosis);
    }

    /// What the Diagnosis tab shows.
    #[must_use]
    pub fn diagnosis(&self) -> &DiagnosisView {
        self.state.diagnosis.view()
    }

    /// Adds the rows of a stress case that was run; those of the same case before go.
    pub fn add_stress(&mut self, rows: Vec<crate::stress::Row>) {
        self.state.stress.add(rows);
    }

    /// Tells how far running stress cases is, or that none run; and why it failed, with the mend.
    pub fn set_stress(&mut self, running: Option<StressProgress>, error: Option<String>) {
        self.state.stress.show(running, error);
    }

    /// The rows of all stress cases that were run.
    #[must_use]
    pub fn stress(&self) -> &[crate::stress::Row] {
        self.state.stress.rows()
    }

    /// A scene could not be opened, or its frame not be made: a tour that waits for it says so.
    pub fn push_failure(&mut self, error: String) {
        self.state.note_tour_error(&error);
        self.push_error(error);
    }

    /// Shows an error with its mend until it is dismissed; what was shown before stays.
    pub fn push_error(&mut self, error: String) {
        // What failed is tried no further by itself.
        self.state.restoring = None;
        self.state.animation.is_running = false;
        if !self.state.errors.contains(&error) {
            self.state.errors.push(error);
        }
    }

    /// The errors that are shown.
    #[must_use]
    pub fn errors(&self) -> &[String] {
        &self.state.errors
    }

    /// Index of the selected step.
    #[must_use]
    pub fn step(&self) -> usize {
        self.state.step
    }

    /// Selects a step; the last one if there are fewer.
    pub fn select_step(&mut self, step: usize) {
        self.state.select_step(step);
    }

    /// Index of the selected draw of that step; `None`: the step as a whole.
    #[must_use]
    pub fn draw(&self) -> Option<usize> {
        self.state.draw
    }

    /// Selects a draw of a step; the whole step if it has fewer.
    pub fn select_draw(&mut self, step: usize, draw: usize) {
        self.state.select(moment::Moment { step, draw: Some(draw) });
    }

    /// The pictures that are shown; none where nothing is drawn yet.
    #[must_use]
    pub fn shown_images(&self) -> Vec<Arc<crate::capture::Image>> {
        let shown = |capture: &Arc<Capture>| self.state.shown(capture);
        self.state.capture.as_ref().and_then(shown).map_or_else(Vec::new, |shown| shown.images)
    }

    /// The picked pixel of the picture.
    #[must_use]
    pub fn picked(&self) -> Option<[u32; 2]> {
        self.state.pick
    }

    /// The texel that a pixel reads of the shadow map in its tab: index of the face, column and row. `None`
    /// where it reads none, or the tab was not shown for this frame yet.
    #[must_use]
    pub fn map_texel_of(&self, pixel: [u32; 2]) -> Option<(usize, [u32; 2])> {
        self.state.map_tab.texel_of(pixel).map(|texel| (texel.face, texel.at))
    }

    /// The depth that the shadow map in its tab is compared with at a pixel; `None` as for its texel.
    #[must_use]
    pub fn map_depth_of(&self, pixel: [u32; 2]) -> Option<f64> {
        self.state.map_tab.depth_of(pixel)
    }

    /// Picks a pixel.
    pub fn pick(&mut self, at: [u32; 2]) {
        self.state.pick = Some(at);
    }

    /// The kind of picture that is shown.
    #[must_use]
    pub fn picture_kind(&self) -> Option<PictureKind> {
        let capture = self.state.capture.as_ref()?;
        self.state.shown(capture).map(|shown| shown.kind)
    }

    /// Wishes for a kind of picture.
    pub fn set_picture_kind(&mut self, kind: PictureKind) {
        self.state.choose_picture(kind);
    }

    /// How large texels are shown.
    #[must_use]
    pub fn zoom(&self) -> Zoom {
        self.state.view.zoom
    }

    /// Shows texels in a size, `center` (in texels) in the middle.
    pub fn set_zoom(&mut self, zoom: Zoom, center: [f64; 2]) {
        self.state.view.zoom = zoom;
        self.state.view.center = center;
    }

    /// Is the scene playing?
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.state.playing.is_some()
    }
}

/// A dropped file is opened; of several the last one, as only one scene is open at a time.
fn take_dropped_files(ctx: &egui::Context, actions: &mut Vec<Action>) {
    let dropped = ctx.input(|input| input.raw.dropped_files.last().map(|file| file.path().display().to_string()));
    actions.extend(dropped.map(Action::Open));
}
