//! Guided tours: stops that drive the panels and explain what is seen.
//!
//! A stop first asks for its technique or scene, and waits for the capture; then it goes to its step, picture, pixel
//! and tab. Between stops the user may do what they like: the next stop finds its place again. A stop whose frame can't
//! be made says why, and offers to try again or to go on without it. The stops are in `tours.rs`.

use crate::ask::{DiagnosisOf, RunRequest, TruthOf};
use crate::capture::Capture;
use crate::diagnosis::Diagnosis;
use crate::inspector::action::{Action, Overlay, PanelKind};
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{at_right, in_rows};
use crate::inspector::model::Model;
use crate::inspector::model::comparing::Comparison;
use crate::inspector::model::scene::OpenScene;
use crate::inspector::model::selection::TriangleKey;
use crate::inspector::model::tour_focus::TourFocus;
use crate::inspector::model::undo::{RunState, UndoHistory};
use crate::inspector::tours::{TOURS, Tour, TourMove, tour_after, tour_of};
use crate::reading::capture_point::CapturePoint;
use crate::reading::notable_pixel;
use crate::reading::picture_view::{PictureKind, TexelZoom};
use crate::technique::{Choice, Technique};
use egui::{Key, Label, Margin, RichText, Ui};
use std::collections::BTreeSet;
use std::sync::Arc;

/// In how many frames at most a stop scrolls to what it speaks of: what comes later has moved until then.
const SCROLLS: u8 = 40;

/// The tour that is running, if any, and its stop.
#[derive(Debug, Default)]
pub struct Tours {
    at: Option<TourState>,
    /// The scene that was open when the tours began: its key, and how it was run.
    before: Option<(String, RunState)>,
    /// What was looked at then.
    looked: Option<LookedAt>,
    /// After a tour: what was looked at before it, to be given back once the frame of that state is shown again.
    coming: Option<(LookedAt, RunState)>,
    /// The built-in scenes that the stops so far have named.
    named: BTreeSet<&'static str>,
}

/// What the user looked at before a tour, besides the scene and how it is run.
#[derive(Debug, Clone)]
struct LookedAt {
    /// The chosen kind of picture.
    kind: Option<PictureKind>,
    light: usize,
    /// Zoom and place in the picture.
    zoom: TexelZoom,
    center: [f64; 2],
    point: CapturePoint,
    pick: Option<[u32; 2]>,
    triangle: Option<TriangleKey>,
    overlays: BTreeSet<Overlay>,
    compare: Option<Comparison>,
    diagnosis: Option<(DiagnosisOf, Arc<Diagnosis>)>,
    undo: UndoHistory,
    /// The tabs that were shown.
    panels: Vec<PanelKind>,
}

impl LookedAt {
    fn now(model: &Model) -> LookedAt {
        let diagnosis = model.answers.last::<DiagnosisOf>();
        LookedAt {
            kind: model.view.kind,
            light: model.view.light,
            zoom: model.view.zoom,
            center: model.view.center,
            point: model.selected(),
            pick: model.selection.pick,
            triangle: model.selection.triangle,
            overlays: model.modes.overlays.clone(),
            compare: model.modes.compare,
            diagnosis: diagnosis.map(|(question, found)| (question.clone(), Arc::clone(found))),
            undo: model.undo.clone(),
            panels: model.shown_panels.clone(),
        }
    }

    /// Looks at it again, in the frame that was shown then.
    fn give_back(self, model: &mut Model) {
        if let Some((question, found)) = self.diagnosis {
            model.answers.take_in(question, Ok(found));
        }
        model.undo = self.undo;
        model.requests.panels.extend(self.panels);
        model.view.kind = self.kind;
        model.view.light = self.light;
        model.view.zoom = self.zoom;
        model.view.center = self.center;
        model.modes.overlays = self.overlays;
        model.modes.compare = self.compare;
        model.select(self.point);
        model.selection.pick = self.pick;
        model.selection.triangle = self.triangle;
    }
}

/// What the end of a tour gives back.
#[derive(Debug, Clone, PartialEq)]
enum TourEnd {
    /// Scene and settings as they were: their state.
    Before(RunState),
    /// The same, but a stop's scene is being opened, so that the scene before has to be opened after it.
    Reopened(RunState),
    /// The default settings of the technique: what was open before can't be opened again by name, or nothing was.
    Defaults,
    /// Nothing: the user has opened a scene that no stop is about.
    Nothing,
}

impl TourEnd {
    /// Returns what the button that ends the tour says of it.
    fn words(&self) -> &'static str {
        match self {
            TourEnd::Before(_) | TourEnd::Reopened(_) => {
                "Tabs, scene, settings, picture, pick, overlays, diagnosis and undo go back to what they were before the \
                 tour"
            }
            TourEnd::Defaults => {
                "Panels and scene stay as they are, and the technique gets its default settings: what was open before \
                 the tour can't be opened again by its name"
            }
            TourEnd::Nothing => "Everything stays as it is: you have opened this scene yourself",
        }
    }
}

/// A running tour: its index, the index of its stop, and whether that stop waits for its frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TourState {
    tour: usize,
    stop: usize,
    /// The stop's moves have not been carried out yet.
    is_pending: bool,
    /// A wrong pixel is picked as soon as the truth is known.
    picks_wrong: bool,
    /// What failed while the stop's frame was waited for, and how to fix it.
    error: Option<String>,
    /// The point of the frame to which the stop went.
    point: Option<CapturePoint>,
}

impl Tours {
    /// Begins a tour.
    fn start(&mut self, model: &mut Model, tour: usize, actions: &mut Vec<Action>) {
        self.go_to_stop(model, tour, 0, actions);
    }

    /// Goes to a stop of the tour of a technique; does nothing where the technique has no tour.
    pub fn go_to_stop_of(&mut self, model: &mut Model, technique: Technique, stop: usize, actions: &mut Vec<Action>) {
        if let Some((tour, _)) = tour_of(technique) {
            self.go_to_stop(model, tour, stop, actions);
        }
    }

    fn go_to_stop(&mut self, model: &mut Model, tour: usize, stop: usize, actions: &mut Vec<Action>) {
        let Some(found) = TOURS.get(tour).filter(|found| stop < found.stops.len()) else {
            return self.end(model, actions);
        };
        if self.at.is_none() {
            self.before = model.scene.as_ref().map(|scene| (scene.key(), scene.state()));
            self.looked = Some(LookedAt::now(model));
            self.coming = None;
            self.named.clear();
        }
        self.named.extend(found.stops[..=stop].iter().filter_map(|stop| scene_of(stop.go)));
        self.at = Some(TourState { tour, stop, is_pending: true, picks_wrong: false, error: None, point: None });
        model.animation.is_running = false;
        model.tour_focus = Some(TourFocus::default());
        model.knows_tours = true;
        if let Some(scene) = scene_to_open(model, found, stop) {
            model.stop_restoring();
            model.activity.is_waiting = true;
            actions.push(Action::Open(scene.to_owned()));
            return;
        }
        run_for_stop(model, found.stops[stop].choice(found), actions);
    }

    /// Ends the tour, and gives back what it changed: the scene that was open before is open again, and is run as it
    /// was, also where a stop's scene is still being opened. Where none was, or it can't be opened by name, the technique
    /// gets its default settings back. A scene that the user opened meanwhile stays as it is: no stop was shown in it.
    pub fn end(&mut self, model: &mut Model, actions: &mut Vec<Action>) {
        let end = self.gives_back(model);
        if self.at.take().is_none() {
            return;
        }
        model.tour_focus = None;
        self.before = None;
        let looked = self.looked.take();
        if end != TourEnd::Nothing {
            model.view.kind = looked.as_ref().and_then(|looked| looked.kind);
        }
        if let TourEnd::Before(before) | TourEnd::Reopened(before) = &end {
            self.coming = looked.map(|looked| (looked, before.clone()));
        }
        match end {
            TourEnd::Before(before) => {
                let is_open = model.scene.as_ref().is_some_and(|scene| scene.source == before.source);
                if !is_open {
                    model.activity.is_waiting = true;
                } else if model.scene.as_ref().is_some_and(|scene| scene.draft == *before.request) {
                    return;
                }
                model.restore(Some(before), actions);
            }
            TourEnd::Reopened(before) => {
                model.activity.is_waiting = true;
                model.reopen(before, actions);
            }
            TourEnd::Defaults => {
                let Some(scene) = &model.scene else { return };
                let choice = Choice::new(scene.draft.choice.technique());
                if scene.draft.choice != choice {
                    model.replace_draft(RunRequest { choice, ..scene.draft.clone() }, actions);
                }
            }
            TourEnd::Nothing => {}
        }
    }

    /// Gives back what was looked at before the tour that has ended, as soon as the frame of that time is shown again; never,
    /// where that can't be made or the user has gone on to another.
    fn finish(&mut self, model: &mut Model) {
        let Some((_, before)) = &self.coming else { return };
        if model.activity.is_waiting || model.is_restoring() {
            return;
        }
        let is_it = |scene: &&OpenScene| scene.source == before.source && scene.draft == *before.request;
        let Some(scene) = model.scene.as_ref().filter(is_it) else {
            self.coming = None;
            return;
        };
        // Opened again, a scene is first shown as it opens: its steps are others. Where its own frame can't be made, nothing
        // more comes.
        let is_shown = |capture: &Arc<Capture>| is_frame_of(capture, scene, &before.request.choice);
        let is_over = model.activity.job.is_none() || model.frame.capture.as_ref().is_some_and(is_shown);
        if is_over && let Some((looked, _)) = self.coming.take() {
            looked.give_back(model);
        }
    }

    /// Returns what the end of the tour gives back as things stand.
    fn gives_back(&self, model: &Model) -> TourEnd {
        let (Some(at), Some(scene)) = (&self.at, &model.scene) else { return TourEnd::Nothing };
        let waits = at.is_pending && model.activity.is_waiting;
        let is_opening = waits && TOURS.get(at.tour).is_some_and(|tour| scene_to_open(model, tour, at.stop).is_some());
        let key = scene.key();
        let is_of_tour = self.named.is_empty() || self.named.contains(key.as_str());
        match &self.before {
            Some((_, before)) if is_opening && before.source.is_some() => TourEnd::Reopened(before.clone()),
            Some((before_key, before)) if *before_key == key && !is_opening => TourEnd::Before(before.clone()),
            _ if !is_of_tour && !is_opening => TourEnd::Nothing,
            Some((_, before)) if before.source.is_some() => TourEnd::Before(before.clone()),
            _ => TourEnd::Defaults,
        }
    }

    /// Stores an error for the stop that waits for its frame, which shows it; does nothing where none waits.
    pub fn note_error(&mut self, error: &str) {
        if let Some(tour) = self.at.as_mut().filter(|tour| tour.is_pending) {
            tour.error = Some(error.to_owned());
        }
    }

    /// Returns why the stop has no frame, and gets none without the user's help; `None` where no stop waits, or while a
    /// run is awaited or a job is running.
    fn trouble(&self, model: &Model) -> Option<String> {
        let at = self
            .at
            .as_ref()
            .filter(|tour| tour.is_pending && !model.activity.is_waiting && model.activity.job.is_none())?;
        let problem = model.scene.as_ref().and_then(|scene| scene.problem.clone());
        Some(at.error.clone().or(problem).unwrap_or_else(|| "the run ended without a picture".to_owned()))
    }

    /// Carries out the moves of the waiting stop as soon as the capture of its scene and technique is shown; until then
    /// chooses its technique, if necessary. For a capture folder, which can't be run, the stop only stops waiting.
    pub fn go_on(&mut self, model: &mut Model, actions: &mut Vec<Action>) {
        let Some(at) = self.at.clone().filter(|tour| tour.is_pending && !model.activity.is_waiting) else { return };
        let Some(tour) = TOURS.get(at.tour) else { return };
        let Some(capture) = model.frame.capture.clone() else { return };
        let stop = &tour.stops[at.stop];
        let Some(scene) = &model.scene else {
            // A capture folder: there is nothing to run. The stop is shown all the same, unless its scene failed.
            if at.error.is_none() {
                self.at = Some(TourState { is_pending: false, ..at });
            }
            return;
        };
        // Where the scene or its frame could not be made, the stop says why.
        if at.error.is_some() || scene_to_open(model, tour, at.stop).is_some() {
            return;
        }
        let run = run_of(scene, stop.choice(tour));
        if scene.draft != run {
            return model.replace_draft(run, actions);
        }
        if !is_frame_of(&capture, scene, &run.choice) {
            return;
        }
        let picks_wrong = stop.go.contains(&TourMove::PickWrong);
        self.at = Some(TourState { is_pending: false, picks_wrong, ..at });
        model.modes.overlays.clear();
        model.modes.compare = None;
        // What a stop speaks of must not lie beside what is seen.
        model.view.zoom = TexelZoom::Fit;
        // A stop that names no picture shows what its step writes.
        model.view.follow_steps();
        for go in stop.go {
            do_stop(model, *go, &capture);
        }
        if let Some(at) = &mut self.at {
            at.point = Some(model.selected());
        }
    }

    /// Picks the wrong pixel that the stop is about, once the truth is known: which pixel is wrong is not known before.
    fn pick_wrong(&mut self, model: &mut Model) {
        let Some(at) = self.at.as_mut().filter(|at| at.picks_wrong && !at.is_pending) else { return };
        let Some(capture) = &model.frame.capture else { return };
        if capture.lights.iter().any(|light| light.truth.is_some()) {
            at.picks_wrong = false;
            model.selection.pick = notable_pixel::wrong(capture);
        }
    }
}

/// Returns the built-in scene that a stop, or the last stop before it that names one, is about; `None` where none is
/// named.
fn scene_at(tour: &Tour, stop: usize) -> Option<&'static str> {
    tour.stops[..=stop].iter().rev().find_map(|stop| scene_of(stop.go))
}

/// Returns the built-in scene that a stop needs; `None` where that scene is open or none is named. A file's scene of the
/// same name is another scene.
fn scene_to_open(model: &Model, tour: &Tour, stop: usize) -> Option<&'static str> {
    let is_open = |scene: &str| model.scene.as_ref().is_some_and(|open| open.key() == scene);
    scene_at(tour, stop).filter(|scene| !is_open(scene))
}

/// Returns whether a capture is of this scene by this technique with these settings: a frame of other settings would
/// show something else than the stop says.
fn is_frame_of(capture: &Capture, scene: &OpenScene, choice: &Choice) -> bool {
    capture.scene == scene.name
        && capture.technique == choice.technique().name()
        && capture.settings == *choice.settings()
}

/// Returns how a stop runs the open scene: as it was opened, so that the text is true of it whatever was moved, in the
/// picture's present size.
fn run_of(scene: &OpenScene, choice: Choice) -> RunRequest {
    RunRequest { choice, size: scene.draft.size, ..scene.opened.clone() }
}

/// Runs the open scene as a stop needs it; where it is run so already, is not what is shown and no run is awaited, runs
/// it again.
fn run_for_stop(model: &mut Model, choice: Choice, actions: &mut Vec<Action>) {
    let Some(scene) = &model.scene else { return };
    let run = run_of(scene, choice);
    let is_shown = model.frame.capture.as_ref().is_some_and(|capture| is_frame_of(capture, scene, &run.choice));
    if scene.draft != run || (!is_shown && !model.activity.is_waiting) {
        model.replace_draft(run, actions);
    }
}

fn do_stop(model: &mut Model, go: TourMove, capture: &Capture) {
    let with = |word: &str| capture.steps.iter().position(|step| step.name.contains(word));
    match go {
        TourMove::Scene(_) | TourMove::Technique(_) | TourMove::Set(..) => {}
        TourMove::First => model.select_step(0),
        TourMove::Last => model.select_step(usize::MAX),
        TourMove::Step(word) => {
            if let Some(step) = with(word) {
                model.select_step(step);
            }
        }
        TourMove::Picture(kind) => model.choose_picture(kind),
        TourMove::Panel(panel) => model.requests.panels.push(panel),
        TourMove::Mark(subject) => {
            let focus = model.tour_focus.get_or_insert_default();
            (focus.subject, focus.scrolls) = (Some(subject), SCROLLS);
        }
        TourMove::VolumeOf(caster) => model.tour_focus.get_or_insert_default().volume_of = Some(caster),
        TourMove::Over(overlay) => {
            model.modes.overlays.insert(overlay);
        }
        TourMove::PickShadow => model.selection.pick = notable_pixel::in_shadow(capture).or(model.selection.pick),
        TourMove::PickLit => model.selection.pick = notable_pixel::lit(capture).or(model.selection.pick),
        // Picked once the truth is known; until then none is, so that no other pixel is taken for it.
        TourMove::PickWrong => model.selection.pick = None,
    }
}

/// Returns how many stops the tour of a technique has.
pub fn stops_of(technique: Technique) -> usize {
    tour_of(technique).map_or(0, |(_, tour)| tour.stops.len())
}

fn scene_of(go: &[TourMove]) -> Option<&'static str> {
    go.iter().find_map(|go| if let TourMove::Scene(name) = go { Some(*name) } else { None })
}

/// Begins a tour that a panel asked for, carries out its stop's moves, and draws the stop over the status bar while a
/// tour is running.
pub fn ui(ui: &mut Ui, own: &mut Tours, model: &mut Model, actions: &mut Vec<Action>) {
    if let Some(tour) = model.requests.tour.take() {
        own.start(model, tour, actions);
    }
    own.go_on(model, actions);
    own.pick_wrong(model);
    own.finish(model);
    let Some(at) = own.at.clone() else { return };
    let Some(tour) = TOURS.get(at.tour) else { return };
    let trouble = own.trouble(model);
    let end = own.gives_back(model);
    let has_left = at.point.is_some_and(|point| point != model.selected());
    let frame = egui::Frame::new().fill(theme::of(ui).raised).inner_margin(Margin::symmetric(12, 8));
    let mut to = None;
    egui::Panel::bottom("tour").frame(frame).show(ui, |ui| {
        // A dialog or a menu has the keys for itself.
        let ctx = ui.ctx();
        let has_keys = model.dialog.is_none() && !ctx.text_edit_focused() && !egui::Popup::is_any_open(ctx);
        let awaits_truth = at.picks_wrong && model.answers.under_way::<TruthOf>().running.is_some();
        to = stop(ui, tour, &at, trouble.as_deref(), &end, StopKeys { has_keys, has_left, awaits_truth });
    });
    match to {
        None => {}
        Some(TourStep::End) => own.end(model, actions),
        Some(TourStep::To(tour, stop)) => {
            own.go_to_stop(model, tour, stop, actions);
            own.go_on(model, actions);
        }
    }
}

/// What a button says that leads back to the step that a stop is about.
const HAS_LEFT: &str = "Another step is shown than the one that the text is about";

/// What is said while a stop speaks of wrong pixels that are not known yet.
const AWAITS_TRUTH: &str = "The rays are still being traced: hatching and picked pixel come with them.";

/// How a stop stands to what the user does.
#[derive(Debug, Clone, Copy)]
struct StopKeys {
    /// No dialog, menu or text field takes the keys.
    has_keys: bool,
    /// The user has gone on to another step of the frame.
    has_left: bool,
    /// It speaks of wrong pixels, and the truth is being traced.
    awaits_truth: bool,
}

/// Where the user goes from a stop.
enum TourStep {
    /// To a stop of a tour, by their indices.
    To(usize, usize),
    /// Out of the tour.
    End,
}

/// What stands over a stop's text, and stays together where that takes several rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum TourGroup {
    Title,
    Place,
}

impl TourGroup {
    const ALL: [TourGroup; 2] = [TourGroup::Title, TourGroup::Place];
}

/// Draws a stop's text over its buttons, of which the last says what `end` gives back, and `trouble` with a button to try
/// again. Returns where the user goes; `None` to stay.
fn stop(
    ui: &mut Ui,
    tour: &Tour,
    at: &TourState,
    trouble: Option<&str>,
    end: &TourEnd,
    keys: StopKeys,
) -> Option<TourStep> {
    let stop = &tour.stops[at.stop];
    let count = tour.stops.len();
    let is_last = at.stop + 1 == count;
    let mut to = None;
    in_rows(ui, "tour", theme::ROW_HEIGHT, &TourGroup::ALL, |ui, group| match group {
        // In the colour of the frame around what the stop speaks of.
        TourGroup::Title => {
            ui.horizontal(|ui| {
                theme::swatch(ui, theme::of(ui).tour);
                theme::heading(ui, stop.title);
            });
        }
        TourGroup::Place => {
            ui.horizontal(|ui| {
                if keys.has_left && ui.small_button("Back to this step").on_hover_text(HAS_LEFT).clicked() {
                    to = Some(TourStep::To(at.tour, at.stop));
                }
                ui.label(theme::note(format!("tour of {}, stop {} of {count}", tour.technique.name(), at.stop + 1)));
            });
        }
    });
    if let Some(reason) = trouble {
        let text = RichText::new(format!("× This stop's frame can't be made: {reason}"));
        ui.add(Label::new(text.color(theme::of(ui).error)).wrap());
        ui.horizontal_wrapped(|ui| {
            if ui.button("Try this stop again").clicked() {
                to = Some(TourStep::To(at.tour, at.stop));
            }
            let skip = if is_last { "Skip it and end the tour" } else { "Skip this stop" };
            if ui.button(skip).clicked() {
                to = Some(if is_last { TourStep::End } else { TourStep::To(at.tour, at.stop + 1) });
            }
            ui.label(theme::note("What it would show:"));
        });
    }
    let is_awaited = at.is_pending && trouble.is_none();
    let text = if is_awaited { "The frame is being made …" } else { stop.text };
    let ink = if trouble.is_some() { theme::of(ui).dim } else { theme::of(ui).text };
    ui.add(Label::new(RichText::new(text).color(ink)).wrap());
    if keys.awaits_truth && !at.is_pending {
        ui.label(theme::note(AWAITS_TRUTH));
    }
    buttons(ui, tour, at, end, keys.has_keys).or(to)
}

/// Draws the buttons of a stop along the lower edge, where they keep their places however long its text is.
fn buttons(ui: &mut Ui, tour: &Tour, at: &TourState, end: &TourEnd, has_keys: bool) -> Option<TourStep> {
    let is_last = at.stop + 1 == tour.stops.len();
    let mut to = None;
    // What a presenter's remote sends.
    let pressed = |ui: &Ui, key| has_keys && ui.input(|input| input.key_pressed(key));
    ui.horizontal(|ui| {
        let goes_back = at.stop > 0 && pressed(ui, Key::PageUp);
        let before = ui.add_enabled(at.stop > 0, egui::Button::new("Stop before"));
        let before = before.on_hover_text("Page Up").on_disabled_hover_text("This is the first stop");
        if before.clicked() || goes_back {
            to = at.stop.checked_sub(1).map(|stop| TourStep::To(at.tour, stop));
        }
        match tour_after(at.tour).filter(|_| is_last) {
            Some((index, after)) => {
                let button = ui.button(format!("Tour of {}", after.technique.name()));
                if button.on_hover_text(after.promise).clicked() {
                    to = Some(TourStep::To(index, 0));
                }
            }
            None => {
                let goes_on = !is_last && pressed(ui, Key::PageDown);
                let next = ui.add_enabled(!is_last, egui::Button::new("Next stop"));
                let next = next.on_hover_text("Page Down");
                if next.on_disabled_hover_text("This is the last stop of the last tour").clicked() || goes_on {
                    to = Some(TourStep::To(at.tour, at.stop + 1));
                }
            }
        }
        at_right(ui, "end of the tour", |ui| {
            if ui.button("End tour").on_hover_text(end.words()).clicked() {
                to = Some(TourStep::End);
            }
        });
    });
    to
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::Builtin;

    #[test]
    fn every_technique_has_a_tour_whose_scenes_exist() {
        for technique in Technique::ALL {
            assert!(TOURS.iter().any(|tour| tour.technique == technique), "{}", technique.name());
        }
        for tour in &TOURS {
            assert!(tour.stops.len() >= 3, "{}", tour.technique.name());
            for stop in tour.stops {
                let set = |choice: Choice| {
                    let all = stop.go.iter().all(|go| match go {
                        TourMove::Set(key, value) => choice.settings().get(*key).is_some_and(|now| now == value),
                        _ => true,
                    });
                    assert!(all, "{}: a setting that does not exist", stop.title);
                };
                set(stop.choice(tour));
            }
            for scene in tour.stops.iter().filter_map(|stop| scene_of(stop.go)) {
                assert!(Builtin::named(scene).is_some(), "{scene}");
            }
        }
    }

    #[test]
    fn texts_have_only_letters_that_the_face_has() {
        for stop in TOURS.iter().flat_map(|tour| tour.stops) {
            assert!(!stop.text.contains('→') && !stop.text.is_empty(), "{}", stop.title);
        }
    }
}
