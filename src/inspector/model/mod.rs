//! What the panels show: the frame, the scene and how it is to be run, what is selected, what is known.
//!
//! Panels read it. What they may change of it, the selection, the picture that is looked at and the next run, they
//! change through its methods; what only one of them needs is stored in the panel itself. No widget is drawn here.
//!
//! ```text
//! frame.rs     the capture that is shown, and all that is known of it by now     scene.rs   the open scene, its next run
//! selection.rs step, draw, pixel, triangle                                       looking.rs which picture, and how
//! history.rs   the picked pixel's history while it is being computed             undo.rs    undo and redo
//! comparing.rs the picture beside another one
//! animation.rs, walk.rs  the scene's time, and walking                           memory.rs  from one run to the next
//! tour_focus.rs what a running tour speaks of
//! ```

pub mod animation;
pub mod comparing;
pub mod diagnosed;
pub mod differing;
pub mod frame;
pub mod history;
pub mod looking;
pub mod memory;
pub mod scene;
pub mod selection;
pub mod tour_focus;
pub mod undo;
pub mod walk;

use crate::ask::{Answers, QuestionKind, ReportOf, TruthOf};
use crate::inspector::action::{DialogKind, LayoutPreset, PanelKind};
use crate::inspector::look::texture::PictureCache;
use crate::reading::picture_view::{PictureKind, PictureView, available, has_truth};
use crate::report::MeasuredReport;
use animation::Animation;
use frame::ShownFrame;
use looking::ViewModes;
use memory::{ClosedWindow, ThemeChoice};
use scene::OpenScene;
use selection::Selection;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use tour_focus::TourFocus;
use undo::UndoHistory;
use walk::WalkState;

/// The state that more than one panel reads.
#[derive(Debug, Default)]
pub struct Model {
    /// The frame that is shown.
    pub frame: ShownFrame,
    /// The open scene with its settings; `None` for a capture folder.
    pub scene: Option<OpenScene>,
    /// How many scenes were opened: what is stored for one can't be used for the next.
    pub scenes_opened: u64,
    /// Questions about frame and scene, with their answers.
    pub answers: Answers,
    /// What is selected.
    pub selection: Selection,
    /// A button of the mouse is down: what it changes will go on changing.
    pub is_dragging: bool,
    /// The picture panel's picture.
    pub view: PictureView,
    /// How that picture is looked at.
    pub modes: ViewModes,
    /// The jobs that are running, and their messages.
    pub activity: Activity,
    /// What one panel asks of another.
    pub requests: Requests,
    /// The dialog that is open.
    pub dialog: Option<DialogKind>,
    /// What the window is in.
    pub place: WindowPlace,
    /// How the window was closed last: whoever opens and closes it says so.
    pub closed: ClosedWindow,
    /// The list of tours was opened once: until then its button is marked.
    pub knows_tours: bool,
    /// A CPU draws the window, so that a frame takes time from what it shows: what moves by itself moves seldom.
    pub is_drawn_slowly: bool,
    /// Dark or light.
    pub theme: ThemeChoice,
    /// Which of the layouts of the menu View the panels have; `None` where the user has arranged them, or a stored layout came
    /// back.
    pub layout: Option<LayoutPreset>,
    /// How much larger than usual everything is, where that is known: from the first frame on.
    pub zoom: Option<f32>,
    /// The sources that were opened, the last first.
    pub recent: Vec<String>,
    /// Reports that were measured of scenes that were open before, by the scene's name.
    reports: BTreeMap<String, (ReportOf, Arc<MeasuredReport>)>,
    /// Changes that can be taken back.
    pub undo: UndoHistory,
    /// The run to restore once the scene is open that undo, redo or the end of a tour asked for, and how many scenes were
    /// opened before.
    restoring: Option<(undo::RunState, u64)>,
    /// The scene's animation.
    pub animation: Animation,
    /// What the running tour speaks of; `None` while there is none.
    pub tour_focus: Option<TourFocus>,
    /// The tabs that were drawn in the last frame.
    pub shown_panels: Vec<PanelKind>,
    /// Walking through the scene.
    pub walk: WalkState,
    /// Textures and facts of images.
    pub textures: PictureCache,
}

/// What the window is in: what else there is beside the panels depends on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WindowPlace {
    /// A desktop: there are files, and paths to them.
    #[default]
    Desktop,
    /// The page of a browser: files are dropped on it, exports are downloads, and its address can be shared.
    Page,
}

/// The jobs that are running, and the messages to show.
#[derive(Debug, Default)]
pub struct Activity {
    /// What is being done, in a few words.
    pub job: Option<String>,
    /// A run was asked for, and its capture has not come yet.
    pub is_waiting: bool,
    /// Messages that the user has not dismissed yet, the latest last.
    pub messages: Vec<Message>,
    /// The errors among them that say why a scene could not be opened or run.
    failures: BTreeSet<String>,
    /// Name of the open file, which changed: it can be loaded again.
    pub changed_file: Option<String>,
    /// The names of files that are being written, and of those that were written meanwhile.
    pub exporting: Vec<String>,
    /// How many of them are written.
    pub written: usize,
    /// What was exported last, once that is no message any more.
    pub exported: Option<String>,
}

impl Activity {
    /// Removes the errors about opening and running a scene, after one was opened or run; other errors stay.
    pub fn succeeded(&mut self) {
        let failures = std::mem::take(&mut self.failures);
        self.messages.retain(|message| !failures.contains(&message.text));
    }

    /// Shows what was written, and where, in place of what was written before.
    pub fn note_export(&mut self, done: String) {
        self.forget_export();
        self.messages.push(Message { severity: Severity::Done, text: done });
    }

    /// Forgets what was written: it was of a scene that is no longer open.
    pub fn forget_export(&mut self) {
        self.exported = None;
        self.messages.retain(|message| message.severity != Severity::Done);
    }

    /// Removes a message; what was written is shown in the bar at the bottom from now on. Panics where there is no such
    /// message.
    pub fn dismiss(&mut self, index: usize) {
        let Message { severity, text } = self.messages.remove(index);
        if severity == Severity::Done {
            self.exported = Some(text);
        }
    }
}

/// What is shown above the panels until the user dismisses it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Whether what was asked for failed.
    pub severity: Severity,
    /// What happened, and what to do.
    pub text: String,
}

/// How bad a message is, or that it is good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// What was asked for failed.
    Error,
    /// It was done, otherwise than asked.
    Warning,
    /// It was done: a file was written.
    Done,
}

/// What one panel asks of another: done in the same or the next frame.
#[derive(Debug, Default)]
pub struct Requests {
    /// Tabs to show.
    pub panels: Vec<PanelKind>,
    /// A tour to begin, by its index.
    pub tour: Option<usize>,
    /// The Scene tab is to bring the selected triangle to the middle.
    pub triangle_in_scene: bool,
    /// The Shadow map tab is to bring the texel that the picked pixel reads in this light's map to the middle.
    pub texel_under: Option<usize>,
    /// The pick is to go so many regions on through those in which both sides of the comparison differ, or back where it is
    /// negative; 0: it stays.
    pub differing_regions: isize,
    /// The menu of overlays is to open.
    pub overlay_menu: bool,
    /// The search field of the passes that is to open.
    pub search: Option<StepSearch>,
    /// The layout that the panels are to take.
    pub layout: Option<LayoutPreset>,
    /// How much larger than usual everything is to be.
    pub zoom: Option<f32>,
}

/// The search field above the passes, with the text typed so far.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StepSearch {
    /// Ctrl-G: a step's number.
    GoTo(String),
    /// Ctrl-F: words in the name of a pass.
    Find(String),
}

impl Model {
    /// Chooses the kind of picture. A kind that needs the truth allows a trace that failed or was cancelled to be tried
    /// again.
    pub fn choose_picture(&mut self, kind: PictureKind) {
        if kind.needs_truth() {
            self.answers.try_again(QuestionKind::TruthOf);
        }
        self.view.choose(kind);
    }

    /// Returns the kind of picture at the shown point of the frame; `None` without a capture or a picture.
    pub fn kind(&self) -> Option<PictureKind> {
        self.view.kind_at(self.frame.capture.as_ref()?, self.shown_point())
    }

    /// Asks for the truth where the capture does not contain it yet, and a chosen kind of picture needs it and is available
    /// at the shown point, or a pixel is picked in a frame that was diagnosed: the diagnosis has found which are wrong.
    pub fn want_truth(&self) {
        let Some(capture) = self.frame.capture.as_ref().filter(|capture| !has_truth(capture)) else { return };
        let is_available = |kind: PictureKind| available(capture, self.shown_point()).contains(&kind);
        let is_shown = self.view.wants_truth() && self.view.kind.is_some_and(is_available);
        if is_shown || (self.selection.pick.is_some() && self.diagnosis_of_frame().is_some()) {
            self.answers.want(TruthOf {});
        }
    }

    /// Shows why a scene could not be opened or run, until one succeeds or the message is dismissed.
    pub fn push_failure(&mut self, error: String) {
        self.activity.failures.insert(error.clone());
        self.push_error(error);
    }

    /// Shows an error with its remedy until it is dismissed, once if it is shown already; errors shown before stay.
    /// Also stops the animation and a pending undo or redo, so that what failed is not tried again automatically.
    pub fn push_error(&mut self, error: String) {
        // What failed is not tried again automatically.
        self.restoring = None;
        self.animation.is_running = false;
        self.push_message(Severity::Error, error);
    }

    /// Shows what went otherwise than asked, until it is dismissed, once if it is shown already; work goes on.
    pub fn push_warning(&mut self, warning: String) {
        self.push_message(Severity::Warning, warning);
    }

    fn push_message(&mut self, severity: Severity, text: String) {
        let message = Message { severity, text };
        if !self.activity.messages.contains(&message) {
            self.activity.messages.push(message);
        }
    }
}
