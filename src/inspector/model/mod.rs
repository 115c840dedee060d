//! What the panels show: the frame, the scene and how it is to be run, what is selected, what is known.
//!
//! Panels read it. What they may change of it, the selection, the picture that is looked at and the next run, they change
//! through its methods; what only one of them needs to remember is its own. No widget is drawn here.
//!
//! ```text
//! frame.rs     the capture that is shown, and all that is known of it by now     scene.rs   the open scene and its next run
//! selection.rs step, draw, pixel, triangle                                       looking.rs which picture, and how
//! history.rs   the picked pixel's history while it is on its way                 undo.rs    changes that can be taken back
//! animation.rs, walk.rs  time and eye that move by themselves                    memory.rs  from one run to the next
//! ```

pub mod animation;
pub mod frame;
pub mod history;
pub mod looking;
pub mod memory;
pub mod scene;
pub mod selection;
pub mod undo;
pub mod walk;

use crate::ask::{Answers, QuestionKind, ReportOf, TruthOf};
use crate::inspector::action::{DialogKind, PanelKind};
use crate::inspector::look::texture::PictureCache;
use crate::reading::shown::{PictureKind, PictureView, available, has_truth};
use crate::report::MeasuredReport;
use animation::Animation;
use frame::ShownFrame;
use looking::ViewModes;
use memory::ThemeChoice;
use scene::OpenScene;
use selection::Selection;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use undo::UndoHistory;
use walk::WalkState;

/// All that more than one panel looks at.
#[derive(Debug, Default)]
pub struct Model {
    /// What is looked at.
    pub frame: ShownFrame,
    /// What can be changed; `None` for a capture folder.
    pub scene: Option<OpenScene>,
    /// How many scenes were opened: what is remembered of one is of no use for the next.
    pub scenes_opened: u64,
    /// What was asked of frame and scene.
    pub answers: Answers,
    /// What is selected.
    pub selection: Selection,
    /// The picture panel's picture.
    pub view: PictureView,
    /// How it is looked at.
    pub modes: ViewModes,
    /// What goes on.
    pub activity: Activity,
    /// What one panel wishes of another.
    pub requests: Requests,
    /// The dialog that is open.
    pub dialog: Option<DialogKind>,
    /// Dark or light.
    pub theme: ThemeChoice,
    /// What was opened, the last first.
    pub recent: Vec<String>,
    /// What was measured of scenes that were open before, by name.
    reports: BTreeMap<String, (ReportOf, Arc<MeasuredReport>)>,
    /// Changes that can be taken back.
    pub undo: UndoHistory,
    /// How the scene is to be run that was asked for by taking a change back.
    restoring: Option<undo::RunState>,
    /// The scene's animation.
    pub animation: Animation,
    /// Walking through the scene.
    pub walk: WalkState,
    /// Textures and facts of images.
    pub textures: PictureCache,
}

/// What goes on, and what has to be said.
#[derive(Debug, Default)]
pub struct Activity {
    /// What is being done, in a few words.
    pub job: Option<String>,
    /// A run was asked for whose capture is not there yet.
    pub is_waiting: bool,
    /// Errors that were not dismissed yet.
    pub errors: Vec<String>,
    /// Those of them that say why a scene could not be opened or run.
    failures: BTreeSet<String>,
    /// The file that is open changed: it can be loaded again.
    pub changed_file: Option<String>,
    /// What was exported last.
    pub exported: Option<String>,
}

impl Activity {
    /// A scene was opened or run: that it could not be before is past.
    pub fn succeeded(&mut self) {
        let failures = std::mem::take(&mut self.failures);
        self.errors.retain(|error| !failures.contains(error));
    }
}

/// What one panel wishes of another: done in the same or the next frame.
#[derive(Debug, Default)]
pub struct Requests {
    /// Tabs to show.
    pub panels: Vec<PanelKind>,
    /// A tour to begin, by its index.
    pub tour: Option<usize>,
    /// The Scene tab brings the selected triangle to the middle.
    pub triangle_in_scene: bool,
    /// The Shadow map tab brings the texel that the picked pixel reads to the middle: of this light's map.
    pub texel_under: Option<usize>,
    /// The menu of overlays opens.
    pub overlay_menu: bool,
    /// The search field of the passes opens.
    pub search: Option<StepSearch>,
    /// The panels go to their first places.
    pub first_layout: bool,
}

/// The field above the passes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StepSearch {
    /// Ctrl-G: a step's number.
    GoTo(String),
    /// Ctrl-F: words of a pass.
    Find(String),
}

impl Model {
    /// The user wishes to see `kind`. Wishing again for what was not traced tries again.
    pub fn choose_picture(&mut self, kind: PictureKind) {
        if kind.needs_truth() {
            self.answers.try_again(QuestionKind::TruthOf);
        }
        self.view.choose(kind);
    }

    /// The kind of picture that is shown at the selected moment.
    pub fn kind(&self) -> Option<PictureKind> {
        self.view.kind_at(self.frame.capture.as_ref()?, self.moment())
    }

    /// Wants the truth where its picture is wished for and it is not known.
    pub fn want_truth(&self) {
        let is_missing = self.frame.capture.as_ref().is_some_and(|capture| {
            let kinds = available(capture, self.moment());
            !has_truth(capture) && self.view.kind.is_some_and(|kind| kinds.contains(&kind))
        });
        if self.view.wants_truth() && is_missing {
            self.answers.want(TruthOf {});
        }
    }

    /// Shows why a scene could not be opened or run, until one is.
    pub fn push_failure(&mut self, error: String) {
        self.activity.failures.insert(error.clone());
        self.push_error(error);
    }

    /// Shows an error with its mend until it is dismissed; what was shown before stays.
    pub fn push_error(&mut self, error: String) {
        // What failed is tried no further by itself.
        self.restoring = None;
        self.animation.is_running = false;
        if !self.activity.errors.contains(&error) {
            self.activity.errors.push(error);
        }
    }
}
