//! The open scene, and the run that the settings describe.

use super::comparing::ComparedWith;
use super::looking::StepPhase;
use super::{Model, undo};
use crate::ask::{ObjectChanges, ReportOf, RunRequest};
use crate::inspector::action::Action;
use crate::reading::picture_view::TexelZoom;
use crate::scene::{Light, Mesh, Object, Pose, Scene};
use crate::technique::{Choice, Technique};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The scene that is open, with the draft of its next run.
#[derive(Debug, Clone)]
pub struct OpenScene {
    /// Its name, as shown.
    pub name: String,
    /// What opens it again: a built-in name or a path.
    pub source: Option<String>,
    /// Does anything in it move?
    pub animated: bool,
    /// Names of its objects.
    pub objects: Vec<String>,
    /// Its objects, as loaded.
    pub loaded: Vec<Object>,
    /// The middle of each object's bounding box, object space.
    pub middles: Vec<DVec3>,
    /// Index of the object that is edited in the settings; added objects come after those of the scene.
    pub edited: usize,
    /// The next run.
    pub draft: RunRequest,
    /// The run that the scene was opened with.
    pub opened: RunRequest,
    /// For each light of the draft its index among those that the scene was opened with; `None`: it was added.
    pub lights_opened: Vec<Option<usize>>,
    /// The last settings of each technique, used when it is chosen again.
    pub choices: BTreeMap<Technique, Choice>,
    /// The fix that was applied last.
    pub applied: Option<AppliedFix>,
    /// Why the draft can't be run.
    pub problem: Option<String>,
}

/// A fix that a diagnosis has found and that was applied: technique and settings before it and with it.
#[derive(Debug, Clone, PartialEq)]
pub struct AppliedFix {
    /// Without the fix.
    pub before: Choice,
    /// With it.
    pub after: Choice,
}

impl OpenScene {
    /// Returns the scene's key: the source that opens it, or its name where nothing opens it.
    pub fn key(&self) -> String {
        self.source.clone().unwrap_or_else(|| self.name.clone())
    }

    /// Returns how the scene is to be run next, to be restored by [`Model::restore`].
    pub fn state(&self) -> undo::RunState {
        undo::RunState {
            source: self.source.clone(),
            request: Arc::new(self.draft.clone()),
            lights_opened: self.lights_opened.clone(),
        }
    }

    /// Returns the draft's light of this index as it was when the scene was opened; `None` where it was added since, or
    /// there is no such light.
    pub fn light_opened(&self, index: usize) -> Option<&Light> {
        self.opened.lights.get(self.lights_opened.get(index).copied()??)
    }

    /// Returns the object of an index, in its pose in the draft; added objects come after those of the scene, and
    /// objects switched off are returned too. `None` where there is none.
    pub fn object(&self, index: usize) -> Option<Object> {
        self.placed(index).map(|(object, pose)| Object { pose, ..object.clone() })
    }

    /// Returns the object of an index as it was loaded or added, and its pose in the draft; `None` where there is none.
    pub fn placed(&self, index: usize) -> Option<(&Object, Pose)> {
        let changes = &self.draft.objects;
        match self.loaded.get(index) {
            Some(object) => Some((object, changes.moved.get(&index).copied().unwrap_or(object.pose))),
            None => changes.added.get(index - self.loaded.len()).map(|object| (object, object.pose)),
        }
    }

    /// Returns how many objects the scene has, including those that were added and those that are switched off.
    pub fn object_count(&self) -> usize {
        self.loaded.len() + self.draft.objects.added.len()
    }

    /// Returns the middle of an object of the draft, object space.
    pub fn middle_of(&self, index: usize, object: &Object) -> DVec3 {
        self.middles.get(index).copied().unwrap_or_else(|| middle(&object.mesh))
    }

    /// Sets the pose of the object of an index in the draft; at its loaded pose it no longer counts as moved. Does
    /// nothing where there is no such object; nothing is run.
    pub fn place(&mut self, index: usize, pose: Pose) {
        let (changes, count) = (&mut self.draft.objects, self.loaded.len());
        match self.loaded.get(index) {
            // At its loaded pose it counts as not moved.
            Some(object) if object.pose == pose => drop(changes.moved.remove(&index)),
            Some(_) => drop(changes.moved.insert(index, pose)),
            None => changes.added.get_mut(index - count).into_iter().for_each(|object| object.pose = pose),
        }
    }

    /// Adds a light at the end of the draft's lights; nothing is run.
    pub fn add_light(&mut self, light: Light) {
        self.draft.lights.push(light);
        self.lights_opened.push(None);
    }

    /// Deletes the draft's light of this index; nothing is run. Panics where there is none.
    pub fn delete_light(&mut self, index: usize) {
        self.draft.lights.remove(index);
        // A scene that was run again may have more lights than were opened.
        if index < self.lights_opened.len() {
            self.lights_opened.remove(index);
        }
    }

    /// Returns whether lights, moved, added and switched-off objects of the draft are those that the scene was opened
    /// with; camera, technique and time may differ.
    fn is_as_opened(&self) -> bool {
        let RunRequest { lights, off, objects, .. } = &self.draft;
        (lights, off, objects) == (&self.opened.lights, &self.opened.off, &self.opened.objects)
    }
}

impl Model {
    /// Makes another scene the open one, or none for a capture folder, which can't be run again. Its source becomes the
    /// first of the recent ones; answers about the scene before and the plan are dropped, and the comparison where it means
    /// nothing in this one; a report of the scene before is stored for when it is opened again, and undo goes on across
    /// scenes.
    pub fn set_scene(&mut self, scene: Option<(&Scene, RunRequest)>, source: Option<String>) {
        let before = self.scene.take();
        let key = scene.as_ref().map(|(scene, _)| source.clone().unwrap_or_else(|| scene.name.clone()));
        let known = before.as_ref().filter(|before| Some(before.key()) == key).map(|before| &before.lights_opened);
        if before.as_ref().is_some_and(|before| Some(before.key()) != key) {
            // Where one looked in the scene before means nothing in this one.
            self.view.zoom = TexelZoom::Fit;
            // A new scene is shown after its step, not before it.
            self.modes.phase = StepPhase::After;
        }
        if let (Some(before), Some((question, report))) = (&before, self.answers.current::<ReportOf>()) {
            // A report of a scene that was changed, or is loaded again, would have another scene's numbers.
            if before.is_as_opened() && Some(before.key()) != key {
                self.reports.insert(before.key(), (question.clone(), Arc::clone(report)));
            } else {
                self.reports.remove(&before.key());
            }
        }
        self.frame.plan = None;
        self.activity.succeeded();
        self.activity.changed_file = None;
        self.animation = Default::default();
        if let Some(source) = &source {
            self.note_recent(source);
        }
        self.answers.new_scene(scene.is_some());
        let is_again = before.as_ref().is_some_and(|before| Some(before.key()) == key);
        let stays =
            |with: ComparedWith| scene.as_ref().is_some_and(|(_, draft)| with.stays_for(&draft.choice, is_again));
        self.modes.compare = self.modes.compare.filter(|compare| stays(compare.with));
        self.view.older_truth = None;
        if scene.is_none() {
            self.selection.triangle = None;
        }
        self.scenes_opened += 1;
        self.scene = scene.map(|(scene, draft)| OpenScene {
            name: scene.name.clone(),
            source,
            animated: scene.is_animated(),
            objects: scene.objects.iter().map(|object| object.name.clone()).collect(),
            loaded: scene.objects.clone(),
            middles: scene.objects.iter().map(|object| middle(&object.mesh)).collect(),
            edited: 0,
            choices: BTreeMap::from([(draft.choice.technique(), draft.choice.clone())]),
            applied: None,
            problem: draft.check().err(),
            // A scene that is loaded again is run with the same changes, and compared with what its file contains now.
            opened: RunRequest {
                lights: scene.lights.clone(),
                off: BTreeSet::new(),
                objects: ObjectChanges::default(),
                ..draft.clone()
            },
            lights_opened: lights_opened(&draft.lights, &scene.lights, known.map(Vec::as_slice)),
            draft,
        });
        self.activity.is_waiting = self.scene.is_some();
        if let Some((before, scene)) = before.as_ref().zip(self.scene.as_ref())
            && before.key() == scene.key()
        {
            // A scene that is loaded again may be another one by now, with other object indices.
            self.reports.remove(&scene.key());
            if before.objects != scene.objects {
                self.undo = Default::default();
            }
        }
        if let Some((question, report)) = self.scene.as_ref().and_then(|scene| self.reports.get(&scene.key())) {
            self.answers.take_in(question.clone(), Ok(Arc::clone(report)));
        }
        if let Some(state) = self.scene.as_ref().map(OpenScene::state) {
            self.note_for_undo(state);
        }
    }

    /// Chooses a technique, with the settings that it had when it was last chosen (or its defaults), and runs it; does
    /// nothing where it is chosen already, or no scene is open.
    pub fn choose_technique(&mut self, technique: Technique, actions: &mut Vec<Action>) {
        let Some(scene) = &mut self.scene else { return };
        if scene.draft.choice.technique() != technique {
            let remembered = scene.choices.get(&technique).cloned();
            self.choose(remembered.unwrap_or_else(|| Choice::new(technique)), actions);
        }
    }

    /// Sets the technique and its settings in the draft, and runs the scene; the settings so far are remembered for
    /// their technique. Does nothing where no scene is open.
    pub fn choose(&mut self, choice: Choice, actions: &mut Vec<Action>) {
        let Some(scene) = &mut self.scene else { return };
        scene.choices.insert(scene.draft.choice.technique(), scene.draft.choice.clone());
        scene.draft.choice = choice;
        self.run_draft(actions);
    }

    /// Chooses as [`Model::choose`] does, but goes one step back or forth in what undo knows where that is the same: who looks
    /// at both in turns adds no step each time. The scene's time stays.
    pub fn switch_to(&mut self, choice: Choice, actions: &mut Vec<Action>) {
        let Some(scene) = &self.scene else { return };
        let wanted = RunRequest { choice: choice.clone(), ..scene.draft.clone() };
        let is_wanted = |state: Option<&undo::RunState>| {
            state.is_some_and(|state| state.source == scene.source && state.request.is_same_but_for_time(&wanted))
        };
        let [is_before, is_after] = [self.undo.before(), self.undo.after()].map(is_wanted);
        // The last change is what such a comparison is with.
        let compares = self.modes.compare.is_some_and(|compare| compare.with == ComparedWith::BeforeChange);
        match scene.problem.is_none() && !compares {
            true if is_before => drop(self.undo.undo()),
            true if is_after => drop(self.undo.redo()),
            _ => {}
        }
        self.choose(choice, actions);
    }

    /// Runs the open scene with a fix, and remembers how it was before; does nothing where no scene is open.
    pub fn apply(&mut self, fix: AppliedFix, actions: &mut Vec<Action>) {
        self.choose(fix.after.clone(), actions);
        // What would be compared with itself is compared with what it was.
        if let Some(compare) = &mut self.modes.compare
            && compare.with == ComparedWith::Technique(fix.after.technique())
        {
            compare.with = ComparedWith::BeforeFix;
        }
        if let Some(scene) = &mut self.scene {
            scene.applied = Some(fix);
        }
    }

    /// Returns the fix with which the scene is to be run next; `None` where it is run otherwise.
    pub fn fix_in_use(&self) -> Option<&AppliedFix> {
        let scene = self.scene.as_ref()?;
        scene.applied.as_ref().filter(|fix| fix.after == scene.draft.choice)
    }

    /// Forgets the fix that was applied last, unless the scene is to be run with it: another diagnosis is of another frame.
    pub fn forget_other_fix(&mut self) {
        if let Some(scene) = &mut self.scene {
            scene.applied.take_if(|fix| fix.after != scene.draft.choice);
        }
    }

    /// Replaces the whole draft, and runs it; does nothing where no scene is open.
    pub fn replace_draft(&mut self, draft: RunRequest, actions: &mut Vec<Action>) {
        let Some(scene) = &mut self.scene else { return };
        scene.lights_opened = lights_opened(&draft.lights, &scene.opened.lights, Some(&scene.lights_opened));
        scene.draft = draft;
        self.run_draft(actions);
    }

    /// Adds the action that runs the draft, and records the run for undo; where the draft can't be run, only stores the
    /// reason in [`OpenScene::problem`]. Does nothing where no scene is open.
    pub fn run_draft(&mut self, actions: &mut Vec<Action>) {
        if let Some(scene) = &mut self.scene {
            scene.problem = scene.draft.check().err();
            if scene.problem.is_none() {
                let state = scene.state();
                actions.push(Action::Run(Arc::clone(&state.request)));
                self.activity.is_waiting = true;
                self.note_for_undo(state);
            }
        }
    }

    /// Records a run of the open scene in the undo history, unless it belongs to an undo or redo that is still opening
    /// another scene.
    fn note_for_undo(&mut self, state: undo::RunState) {
        if self.restoring.is_none() {
            self.undo.note(state);
        }
    }

    /// Returns in a few words what undo takes back: the last change, or one that can't be run; `None` where there is
    /// nothing.
    pub fn undoes(&self) -> Option<String> {
        match self.refused() {
            Some(_) => Some("what can't be run".to_owned()),
            None => self.undo.undoes(self.object_names()),
        }
    }

    /// Returns in a few words what redo makes again; `None` where there is nothing.
    pub fn redoes(&self) -> Option<String> {
        self.undo.redoes(self.object_names())
    }

    /// Returns the names of the open scene's objects; empty where none is open.
    pub fn object_names(&self) -> &[String] {
        self.scene.as_ref().map_or(&[], |scene| &scene.objects)
    }

    /// Returns how the open scene was run before its last change, which Undo takes back; `None` where there is none, it changed
    /// the picture's size or the number of lights, so that there is nothing to hold against each other, or the draft can't be
    /// run; and for a scene that nothing opens by name, which can't be distinguished from another.
    pub fn before_last_change(&self) -> Option<&RunRequest> {
        let scene = self.scene.as_ref().filter(|scene| scene.problem.is_none() && scene.source.is_some())?;
        let before = self.undo.before().filter(|before| before.source == scene.source)?;
        let sides = |request: &RunRequest| (request.size, request.lights.len());
        Some(&*before.request).filter(|before| sides(before) == sides(&scene.draft))
    }

    /// Returns the run before a draft that can't be run; `None` while the draft can be.
    fn refused(&self) -> Option<&undo::RunState> {
        let scene = self.scene.as_ref().filter(|scene| scene.problem.is_some())?;
        self.undo.now().filter(|now| now.source == scene.source)
    }

    /// Undoes the last change and runs the scene as it was before; where another scene was open then, opens it first. A
    /// draft that can't be run is the last change, though it made no step. Does nothing where nothing can be undone.
    pub fn take_back(&mut self, actions: &mut Vec<Action>) {
        let before = self.refused().cloned().or_else(|| self.undo.undo());
        self.restore(before, actions);
    }

    /// Redoes the change that was undone last and runs the scene so; where another scene was open then, opens it first.
    /// Does nothing where nothing can be redone.
    pub fn make_again(&mut self, actions: &mut Vec<Action>) {
        let after = self.undo.redo();
        self.restore(after, actions);
    }

    /// Runs the scene as a state says; where another scene is open, asks for the state's scene, which is then run so.
    /// Does nothing without a state.
    pub fn restore(&mut self, state: Option<undo::RunState>, actions: &mut Vec<Action>) {
        let Some(state) = state else { return };
        self.animation.is_running = false;
        match &mut self.scene {
            Some(scene) if scene.source == state.source => {
                scene.draft = Arc::unwrap_or_clone(state.request);
                scene.lights_opened = state.lights_opened;
                self.run_draft(actions);
            }
            // Another scene was open then: it is opened first.
            _ => self.reopen(state, actions),
        }
    }

    /// Opens the scene of a state, also where it is open already but another one is being opened, and then runs it as the
    /// state says. Does nothing where it can't be opened by name.
    pub fn reopen(&mut self, state: undo::RunState, actions: &mut Vec<Action>) {
        actions.extend(state.source.clone().map(Action::Open));
        self.restoring = state.source.is_some().then_some((state, self.scenes_opened));
    }

    /// Runs the scene that undo or redo asked to open, with the settings of that time; does nothing until that scene is
    /// open, or where nothing is restored.
    pub fn finish_restoring(&mut self, actions: &mut Vec<Action>) {
        let is_open = |(state, before): &mut (undo::RunState, u64)| {
            // It may have been open before, with another one to come first.
            let is_since = self.scenes_opened > *before;
            is_since && self.scene.as_ref().is_some_and(|scene| scene.source == state.source)
        };
        if let Some((state, _)) = self.restoring.take_if(is_open)
            && let Some(scene) = &mut self.scene
        {
            scene.choices.insert(state.request.choice.technique(), state.request.choice.clone());
            scene.draft = Arc::unwrap_or_clone(state.request);
            scene.lights_opened = state.lights_opened;
            self.run_draft(actions);
        }
    }

    /// Returns whether a scene is being opened that is then run as undo, redo or the end of a tour asked for.
    pub fn is_restoring(&self) -> bool {
        self.restoring.is_some()
    }

    /// Cancels a pending undo or redo that has to open another scene first.
    pub fn stop_restoring(&mut self) {
        self.restoring = None;
    }
}

/// Returns, for each light of `draft`, its index among the lights that the scene was loaded with, or `None` for one
/// that was added. `before` is the value for the same scene before it was loaded again; without it and with another
/// number of lights, all count as added.
fn lights_opened(draft: &[Light], loaded: &[Light], before: Option<&[Option<usize>]>) -> Vec<Option<usize>> {
    let in_order = || (0..draft.len()).map(Some).collect();
    match before.filter(|known| known.len() == draft.len()) {
        _ if draft == loaded => in_order(),
        Some(known) => known.iter().map(|place| place.filter(|place| *place < loaded.len())).collect(),
        None if draft.len() == loaded.len() => in_order(),
        None => vec![None; draft.len()],
    }
}

/// Returns the middle of a mesh's bounding box, object space; the origin for a mesh without vertices.
fn middle(mesh: &Mesh) -> DVec3 {
    let all = || mesh.positions().iter().copied();
    let (low, high) = (all().reduce(DVec3::min), all().reduce(DVec3::max));
    low.zip(high).map_or(DVec3::ZERO, |(low, high)| low / 2.0 + high / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_is_the_one_that_it_was_opened_as() {
        let lights = [1.0, 2.0, 3.0].map(|x| Light::point([x, 1.0, 0.0]));
        let added = Light::point([9.0; 3]);
        assert_eq!(lights_opened(&lights, &lights, Some(&[None, None, None])), [Some(0), Some(1), Some(2)]);
        // The first was deleted and one added.
        let draft = [lights[1].clone(), lights[2].clone(), added.clone()];
        let known = [Some(1), Some(2), None];
        assert_eq!(lights_opened(&draft, &lights, Some(&known)), known);
        assert_eq!(lights_opened(&draft, &lights[..2], Some(&known)), [Some(1), None, None], "its file has fewer now");
        // Moved lights, in a scene without an earlier value.
        assert_eq!(lights_opened(&draft, &lights, None), [Some(0), Some(1), Some(2)]);
        assert_eq!(lights_opened(&draft[..1], &lights, None), [None]);
    }
}
