//! What the panels show and remember, and how it changes. No widget is drawn here.

use super::action::{Action, RunRequest};
use super::anatomy_state::AnatomyState;
use super::animation::Animation;
use super::diagnosis::DiagnosisState;
use super::dock::Panel;
use super::draw_level::DrawsState;
use super::explain::Explained;
use super::export::ExportState;
use super::history::HistoryState;
use super::memory::ThemeChoice;
use super::meshes::ObjectMesh;
use super::modes::Modes;
use super::moment::Moment;
use super::report::ReportState;
use super::scene_view::SceneView;
use super::shadow_map::MapTab;
use super::stress::StressState;
use super::texture::PictureCache;
use super::tour::TourState;
use super::truth_note::TruthState;
use super::undo::{self, Undo};
use super::view::{PictureKind, PictureView, Zoom, available, has_truth};
use super::walk::Walk;
use crate::capture::Capture;
use crate::plan::FramePlan;
use crate::plan::words::Api;
use crate::scene::Scene;
use crate::technique::{Choice, Technique};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Seconds a step is shown while playing.
pub const SECONDS_A_STEP: f64 = 0.8;
/// Screen pixels that a region is to take where the picture goes to it.
const GO_TO_PIXELS: f32 = 240.0;
/// Screen pixels a texel at most where the picture goes to a region.
const MOST_GO_TO_ZOOM: f32 = 12.0;

/// A built-in scene in the dialog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneEntry {
    /// What opens it.
    pub name: String,
    /// What it shows, in a sentence.
    pub lesson: String,
}

/// The scene that is open, and the run that the settings describe.
#[derive(Debug, Clone)]
pub struct OpenScene {
    /// For people.
    pub name: String,
    /// What opens it again: a built-in name or a path.
    pub source: Option<String>,
    /// Does anything move?
    pub animated: bool,
    /// Names of its objects.
    pub objects: Vec<String>,
    /// What the next run will be.
    pub draft: RunRequest,
    /// The settings of techniques used before, to come back to.
    pub choices: BTreeMap<Technique, Choice>,
    /// Why the draft can't be run.
    pub problem: Option<String>,
}

/// The dialog that opens a scene.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OpenDialog {
    /// The path field.
    pub path: String,
}

/// A small field above the passes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StepSearch {
    /// Ctrl-G: a step's number.
    GoTo(String),
    /// Ctrl-F: words of a pass.
    Find(String),
}

/// A place under the pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hover {
    /// Which of the shown images.
    pub image: usize,
    /// Its texel.
    pub at: [u32; 2],
}

/// State of all panels.
#[derive(Debug, Default)]
pub struct State {
    /// What is looked at.
    pub capture: Option<Arc<Capture>>,
    /// Memory of its pictures, bytes.
    pub capture_bytes: u64,
    /// What was run; `None` for a capture folder.
    pub plan: Option<Arc<FramePlan>>,
    /// A run was asked for whose capture is not there yet.
    pub is_waiting: bool,
    /// What can be changed; `None` for a capture folder.
    pub scene: Option<OpenScene>,
    /// How its meshes hang together; `None` while that is not known.
    pub meshes: Option<Vec<ObjectMesh>>,
    /// Built-in scenes.
    pub scenes: Vec<SceneEntry>,
    /// Index of the selected step.
    pub step: usize,
    /// Index of the selected draw of that step; `None`: the step as a whole.
    pub draw: Option<usize>,
    /// What is shown while the state after the selected draw is not there.
    pub stays: Moment,
    /// How far the states after draws are that were asked for.
    pub draws: DrawsState,
    /// While playing: the time of the next step, in egui's seconds.
    pub playing: Option<f64>,
    /// The picture panel.
    pub view: PictureView,
    /// How the picture is looked at.
    pub modes: Modes,
    /// The Shadow map tab.
    pub map_tab: MapTab,
    /// The picked pixel of the picture.
    pub pick: Option<[u32; 2]>,
    /// The picked texel of the shown map.
    pub map_pick: Option<[u32; 2]>,
    /// What the pointer is over.
    pub hover: Option<Hover>,
    /// How far the truth of the shown frame is.
    pub truth: TruthState,
    /// What happened to the picked pixel.
    pub history: HistoryState,
    /// What the shown frame is made of in space.
    pub anatomy: AnatomyState,
    /// The Scene tab.
    pub scene_view: SceneView,
    /// Lights in view are handles over the picture.
    pub picture_gizmos: bool,
    /// The picture's own widget, once it was drawn.
    pub picture_widget: Option<egui::Id>,
    /// Walking through the scene.
    pub walk: Walk,
    /// The Report tab.
    pub report: ReportState,
    /// The Diagnosis tab.
    pub diagnosis: DiagnosisState,
    /// The stress cases and what they came to.
    pub stress: StressState,
    /// Errors that were not dismissed yet.
    pub errors: Vec<String>,
    /// What is being done.
    pub job: Option<String>,
    /// The dialog, while it is open.
    pub dialog: Option<OpenDialog>,
    /// The search field, while it is open.
    pub search: Option<StepSearch>,
    /// The search field has just been opened and wants the focus.
    pub search_wants_focus: bool,
    /// All draws of the selected pass are listed, however many.
    pub all_draws: bool,
    /// The selected row has to be scrolled to.
    pub scroll_to_step: bool,
    /// Widgets of the pass tree: they leave the stepping keys alone.
    pub tree_widgets: Vec<egui::Id>,
    /// Changes that can be taken back.
    pub undo: Undo,
    /// How the scene is to be run that was asked for by taking a change back.
    pub restoring: Option<undo::Moment>,
    /// The scene's animation.
    pub animation: Animation,
    /// Export of what is shown.
    pub export: ExportState,
    /// The panels go to their first places.
    pub resets_layout: bool,
    /// The list of keys is shown.
    pub help_is_open: bool,
    /// Dark or light.
    pub theme: ThemeChoice,
    /// What was opened, the last first.
    pub recent: Vec<String>,
    /// The file that is open changed: it can be loaded again.
    pub changed_file: Option<String>,
    /// The tour that one is on.
    pub tour: Option<TourState>,
    /// A tour to begin.
    pub wants_tour: Option<usize>,
    /// Tabs to show.
    pub wants_panel: Vec<Panel>,
    /// What the Explain tab tells, kept while it is the same.
    pub explained: Explained,
    /// In whose words the State tab tells.
    pub api: Api,
    /// Textures and facts of images.
    pub cache: PictureCache,
}

impl State {
    /// How many steps there are.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.capture.as_ref().map_or(0, |capture| capture.steps.len())
    }

    /// Shows another capture. The step stays where it means the same, and so does the pick
    /// where it still lies inside.
    pub fn set_capture(&mut self, capture: Arc<Capture>) {
        self.is_waiting = false;
        let step = self.step;
        self.step = match &self.capture {
            Some(before) => same_step(before, step, &capture),
            None => capture.steps.len().saturating_sub(1),
        };
        if let Some(before) = self.capture.clone() {
            self.follow_draw(&before, step, &capture);
        }
        self.stays = self.step.into();
        self.draws = DrawsState::NotAsked;
        match &self.capture {
            Some(before) => self.view.keep_truth_of(before, &capture),
            None => self.view.forget_older_truth(),
        }
        self.truth = TruthState::NotAsked;
        self.history.forget_frame();
        self.modes.forget_frame();
        self.map_tab.forget_frame();
        self.view.tests = None;
        self.anatomy.forget_frame();
        let [width, height] = capture.size;
        self.pick = self.pick.filter(|[x, y]| *x < width && *y < height);
        self.hover = None;
        self.playing = None;
        self.scroll_to_step = true;
        self.view.follow(&capture, self.step);
        self.capture_bytes = capture.bytes();
        self.capture = Some(capture);
        self.explained.forget();
        self.cache.forget_unused();
    }

    /// Shows the same frame, of which more is known: how long it takes, its truth, or its draws.
    pub fn update_capture(&mut self, capture: Arc<Capture>) {
        if has_truth(&capture) {
            self.view.forget_older_truth();
            self.truth = TruthState::NotAsked;
        }
        self.explained.forget();
        self.note_draws_of(&capture);
        self.capture_bytes = capture.bytes();
        self.capture = Some(capture);
        self.cache.forget_unused();
    }

    /// The user wishes to see `kind`. Wishing again for what was not traced tries again.
    pub fn choose_picture(&mut self, kind: PictureKind) {
        if kind.needs_truth() && matches!(self.truth, TruthState::Cancelled | TruthState::Failed(_)) {
            self.truth = TruthState::NotAsked;
        }
        self.view.choose(kind);
    }

    /// Asks for the truth where it is wished for, not known, and was not asked for yet.
    pub fn ask_for_truth(&mut self, actions: &mut Vec<Action>) {
        let can_ask = self.truth == TruthState::NotAsked && self.scene.is_some() && self.view.kind.needs_truth();
        let is_missing =
            |capture: &Arc<Capture>| !has_truth(capture) && available(capture, self.moment()).contains(&self.view.kind);
        if can_ask && self.capture.as_ref().is_some_and(is_missing) {
            self.truth = TruthState::Running { done: 0, of: 0 };
            actions.push(Action::Judge);
        }
    }

    /// Asks what happened to the picked pixel, where that was not asked yet.
    pub fn ask_for_history(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let Some(at) = self.pick.filter(|_| self.scene.is_some() && self.capture.is_some()) else { return };
        if self.history.ask(ctx, at) {
            actions.push(Action::History { at });
        }
    }

    /// Asks what the frame is made of in space, where something shows that and it was not asked yet.
    pub fn ask_for_anatomy(&mut self, actions: &mut Vec<Action>) {
        if self.scene.is_some() && self.capture.is_some() && self.anatomy.ask() {
            actions.push(Action::Anatomy);
        }
    }

    /// Asks which texel each pixel reads, where the tab that shows it is open.
    pub fn ask_for_map_readers(&mut self, actions: &mut Vec<Action>) {
        if self.capture.is_some() && self.map_tab.ask_for_readers() {
            actions.push(Action::MapReaders);
        }
    }

    /// Tells how far the truth of the shown frame is.
    pub fn set_truth(&mut self, truth: TruthState) {
        if matches!(truth, TruthState::Cancelled | TruthState::Failed(_)) {
            self.view.forget_older_truth();
        }
        self.truth = truth;
    }

    /// Picks a pixel and brings it to the middle, large enough that `side` texels around it take
    /// a good part of the panel.
    pub fn go_to(&mut self, at: [u32; 2], side: u32) {
        self.pick = Some(at);
        let fitting = (GO_TO_PIXELS / side.max(1) as f32).clamp(1.0, MOST_GO_TO_ZOOM);
        self.view.zoom = match self.view.zoom {
            Zoom::Fit => Zoom::Pixels(fitting),
            Zoom::Pixels(pixels) => Zoom::Pixels(pixels.max(1.0)),
        };
        self.view.center = at.map(|v| f64::from(v) + 0.5);
    }

    /// Another scene is open; `None` for a capture folder, which can't be run again.
    pub fn set_scene(&mut self, scene: Option<(&Scene, RunRequest)>, source: Option<String>) {
        self.meshes = None;
        self.plan = None;
        self.changed_file = None;
        self.animation = Animation::default();
        if let Some(source) = &source {
            self.note_recent(source);
        }
        self.diagnosis.forget();
        self.modes.forget_scene();
        self.anatomy.forget();
        self.scene_view.forget();
        self.walk.forget_walls();
        if scene.is_none() {
            self.history.close();
        }
        self.scene = scene.map(|(scene, draft)| OpenScene {
            name: scene.name.clone(),
            source,
            animated: scene.is_animated(),
            objects: scene.objects.iter().map(|object| object.name.clone()).collect(),
            choices: BTreeMap::from([(draft.choice.technique(), draft.choice.clone())]),
            problem: draft.check().err(),
            draft,
        });
        self.is_waiting = self.scene.is_some();
        self.note_for_undo();
    }

    /// How the scene is run now is a step that can be taken back.
    fn note_for_undo(&mut self) {
        if let Some(scene) = self.scene.as_ref().filter(|_| self.restoring.is_none()) {
            self.undo.note(undo::Moment { source: scene.source.clone(), request: scene.draft.clone() });
        }
    }

    /// Takes the last change back.
    pub fn undo(&mut self, actions: &mut Vec<Action>) {
        let before = self.undo.undo();
        self.restore(before, actions);
    }

    /// Makes it again.
    pub fn redo(&mut self, actions: &mut Vec<Action>) {
        let after = self.undo.redo();
        self.restore(after, actions);
    }

    fn restore(&mut self, moment: Option<undo::Moment>, actions: &mut Vec<Action>) {
        let Some(moment) = moment else { return };
        self.animation.is_running = false;
        match &mut self.scene {
            Some(scene) if scene.source == moment.source => {
                scene.draft = moment.request;
                self.run_draft(actions);
            }
            _ => {
                // Another scene was open then: it is opened first.
                actions.extend(moment.source.clone().map(Action::Open));
                self.restoring = moment.source.is_some().then_some(moment);
            }
        }
    }

    /// Runs the scene that was opened by taking a change back as it was run then.
    pub fn finish_restoring(&mut self, actions: &mut Vec<Action>) {
        let is_open =
            |moment: &mut undo::Moment| self.scene.as_ref().is_some_and(|scene| scene.source == moment.source);
        if let Some(moment) = self.restoring.take_if(is_open)
            && let Some(scene) = &mut self.scene
        {
            scene.choices.insert(moment.request.choice.technique(), moment.request.choice.clone());
            scene.draft = moment.request;
            self.run_draft(actions);
        }
    }

    /// Selects a step; the last one if there are fewer.
    pub fn select_step(&mut self, step: usize) {
        let Some(capture) = self.capture.clone() else { return };
        self.step = step.min(capture.steps.len().saturating_sub(1));
        self.draw = None;
        if !matches!(self.draws, DrawsState::Fetching(_)) {
            self.draws = DrawsState::NotAsked;
        }
        self.all_draws = false;
        self.scroll_to_step = true;
        self.view.follow(&capture, self.step);
    }

    /// Goes `by` steps on, or back where negative.
    pub fn step_by(&mut self, by: isize) {
        self.select_step(self.step.saturating_add_signed(by));
    }

    /// Starts to play at time `now`, from the start if the end is reached; or stops.
    pub fn toggle_play(&mut self, now: f64) {
        if self.playing.take().is_none() && self.steps() > 1 {
            if self.step + 1 >= self.steps() {
                self.select_step(0);
            }
            self.playing = Some(now + SECONDS_A_STEP);
        }
    }

    /// Goes on if it is time to; seconds until the next step while playing.
    pub fn play(&mut self, now: f64) -> Option<f64> {
        if now >= self.playing? {
            self.step_by(1);
            let at_end = self.step + 1 >= self.steps();
            self.playing = (!at_end).then_some(now + SECONDS_A_STEP);
        }
        self.playing.map(|next| (next - now).max(0.0))
    }

    /// Chooses a technique, with the settings it had when it was last chosen, and runs it.
    pub fn choose_technique(&mut self, technique: Technique, actions: &mut Vec<Action>) {
        let Some(scene) = &mut self.scene else { return };
        if scene.draft.choice.technique() != technique {
            scene.choices.insert(scene.draft.choice.technique(), scene.draft.choice.clone());
            let remembered = scene.choices.get(&technique);
            scene.draft.choice = remembered.cloned().unwrap_or_else(|| Choice::new(technique));
            self.run_draft(actions);
        }
    }

    /// Makes shadows as `choice` says, and runs it.
    pub fn choose(&mut self, choice: Choice, actions: &mut Vec<Action>) {
        let Some(scene) = &mut self.scene else { return };
        scene.choices.insert(scene.draft.choice.technique(), scene.draft.choice.clone());
        scene.draft.choice = choice;
        self.run_draft(actions);
    }

    /// Asks for a run of the draft, or notes why it can't be run.
    pub fn run_draft(&mut self, actions: &mut Vec<Action>) {
        if let Some(scene) = &mut self.scene {
            scene.problem = scene.draft.check().err();
            if scene.problem.is_none() {
                actions.push(Action::Run(Box::new(scene.draft.clone())));
                self.is_waiting = true;
                self.note_for_undo();
            }
        }
    }

    /// The pick of the picture that is shown: of the map, or of the frame.
    pub fn shown_pick(&mut self, kind: PictureKind) -> &mut Option<[u32; 2]> {
        if kind == PictureKind::Map { &mut self.map_pick } else { &mut self.pick }
    }
}

/// The step of `now` that means what step `index` of `before` meant: the last stays the last,
/// a pass of the same name and light is the same.
#[must_use]
pub fn same_step(before: &Capture, index: usize, now: &Capture) -> usize {
    let last = now.steps.len().saturating_sub(1);
    let Some(step) = before.steps.get(index).filter(|_| index + 1 < before.steps.len()) else { return last };
    let is_same = |candidate: &crate::capture::Step| candidate.name == step.name && candidate.light == step.light;
    if now.steps.get(index).is_some_and(is_same) {
        return index;
    }
    now.steps.iter().position(is_same).unwrap_or(index.min(last))
}
