//! Undo and redo: what was run, in which scene, step by step.
//!
//! A step is a whole [`RunRequest`] with what it belongs to, so that nothing can be undone in part. All changes while a
//! mouse button is down (a dragged number, a dragged light) are one step; the advancing time of an animation is not a
//! step.

use crate::ask::RunRequest;
use crate::reading::format;
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::sync::Arc;

/// How many steps are stored.
const MOST: usize = 200;

/// How a scene was run, as undo and redo restore it.
#[derive(Debug, Clone, PartialEq)]
pub struct RunState {
    /// The source that opens the scene: a built-in name or a path; `None` where it can't be opened again by name.
    pub source: Option<String>,
    /// The run.
    pub request: Arc<RunRequest>,
    /// For each light its index among those that the scene was opened with; `None`: it was added.
    pub lights_opened: Vec<Option<usize>>,
}

/// The runs that can be restored by undo and redo: at most 200 in the past.
#[derive(Debug, Clone, Default)]
pub struct UndoHistory {
    past: Vec<RunState>,
    now: Option<RunState>,
    future: Vec<RunState>,
    /// A mouse button is down, or the user walks: all changes belong to one step.
    is_paused: bool,
    /// The present step has begun.
    has_begun: bool,
}

impl RunState {
    /// Returns in a few words what differs in a later state: `light 1`, `technique z-pass`, `setting bias`, `scene tori`,
    /// `blue ball`; `names` has those of the scene's objects.
    fn change_to(&self, later: &RunState, names: &[String]) -> String {
        let (before, after) = (&self.request, &later.request);
        let mut parts = Vec::new();
        if self.source != later.source {
            return later.source.as_ref().map_or_else(|| "the scene".to_owned(), |source| format!("scene {source}"));
        }
        if before.choice.technique() != after.choice.technique() {
            parts.push(format!("technique {}", after.choice.technique().name()));
        } else {
            let settings = after.choice.settings().iter();
            let changed = settings.filter(|(key, value)| before.choice.settings().get(*key) != Some(value));
            parts.extend(changed.map(|(key, value)| format!("{key} {value}")));
        }
        match before.lights.len().cmp(&after.lights.len()) {
            Ordering::Less => parts.push("an added light".to_owned()),
            Ordering::Greater => parts.push("a deleted light".to_owned()),
            Ordering::Equal => {
                let pairs = before.lights.iter().zip(&after.lights).enumerate();
                parts.extend(pairs.filter(|(_, (a, b))| a != b).map(|(index, _)| format::light(index)));
            }
        }
        let rest = [(before.camera != after.camera, "the camera"), (before.size != after.size, "the picture's size")];
        let (moved, will_move) = (&before.objects.moved, &after.objects.moved);
        let is_changed = |index: &usize| {
            before.off.contains(index) != after.off.contains(index) || moved.get(index) != will_move.get(index)
        };
        let touched: BTreeSet<usize> = [&before.off, &after.off]
            .into_iter()
            .flatten()
            .chain(moved.keys())
            .chain(will_move.keys())
            .copied()
            .collect();
        let name = |index: usize| {
            let added = || Some(after.objects.added.get(index.checked_sub(names.len())?)?.name.clone());
            names.get(index).cloned().or_else(added).unwrap_or_else(|| "an object".to_owned())
        };
        parts.extend(touched.into_iter().filter(is_changed).map(name));
        let added = [&before.objects.added, &after.objects.added];
        match added[0].len().cmp(&added[1].len()) {
            Ordering::Less => parts.push("an added object".to_owned()),
            Ordering::Greater => parts.push("a deleted object".to_owned()),
            Ordering::Equal => {
                let pairs = added[0].iter().zip(added[1]);
                parts.extend(pairs.filter(|(one, other)| one != other).map(|(_, object)| object.name.clone()));
            }
        }
        parts.extend(rest.into_iter().filter(|(differs, _)| *differs).map(|(_, what)| what.to_owned()));
        if parts.is_empty() { "a setting".to_owned() } else { parts.join(", ") }
    }
}

impl UndoHistory {
    /// Sets whether all changes from now on belong to one step, as while a mouse button is down; ends that step when
    /// false.
    pub fn hold(&mut self, is_paused: bool) {
        self.has_begun &= is_paused;
        self.is_paused = is_paused;
    }

    /// Records how the scene is run now. A change makes a step that can be undone, and clears what could be redone; one
    /// of the time alone does not, nor a further one while changes belong to one step. Of more than 200 steps the
    /// oldest is dropped.
    pub fn note(&mut self, state: RunState) {
        let is_other =
            |before: &RunState| before.source != state.source || !before.request.is_same_but_for_time(&state.request);
        let is_step = self.now.as_ref().is_some_and(is_other);
        let Some(before) = self.now.replace(state).filter(|_| is_step) else { return };
        self.future.clear();
        if self.has_begun {
            return;
        }
        self.has_begun = self.is_paused;
        if self.past.len() == MOST {
            self.past.remove(0);
        }
        self.past.push(before);
    }

    /// Returns whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Returns whether there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Returns in a few words what undo takes back, of objects their `names`; `None` where there is nothing.
    pub fn undoes(&self, names: &[String]) -> Option<String> {
        Some(self.past.last()?.change_to(self.now.as_ref()?, names))
    }

    /// Returns in a few words what redo makes again, of objects their `names`; `None` where there is nothing.
    pub fn redoes(&self, names: &[String]) -> Option<String> {
        Some(self.now.as_ref()?.change_to(self.future.last()?, names))
    }

    /// Returns how the scene was run before the step that undo takes back; `None` where there is none.
    pub fn before(&self) -> Option<&RunState> {
        self.past.last()
    }

    /// Returns how the scene was run after the step that redo makes again; `None` where there is none.
    pub fn after(&self) -> Option<&RunState> {
        self.future.last()
    }

    /// Returns how the scene was run last.
    pub fn now(&self) -> Option<&RunState> {
        self.now.as_ref()
    }

    /// Goes one step back, and returns the state to restore; `None`, and nothing changes, where there is none.
    pub fn undo(&mut self) -> Option<RunState> {
        let before = self.past.pop()?;
        // What a drag that is under way changes from here on is a step of its own.
        self.has_begun = false;
        self.future.extend(self.now.replace(before.clone()));
        Some(before)
    }

    /// Goes one step forward again, and returns the state to restore; `None`, and nothing changes, where there is none.
    pub fn redo(&mut self) -> Option<RunState> {
        let after = self.future.pop()?;
        self.has_begun = false;
        self.past.extend(self.now.replace(after.clone()));
        Some(after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ask::ObjectChanges;
    use crate::scene::Camera;
    use crate::technique::{Choice, Technique};
    use glam::DVec3;

    fn state(width: u32, time: f64) -> RunState {
        let camera = Camera {
            eye: DVec3::Y,
            target: DVec3::ZERO,
            up: DVec3::X,
            projection: crate::scene::Projection::Perspective,
            fov_y_degrees: 45.0,
            near: 0.1,
            far: None,
            viewport: None,
        };
        let choice = Choice::new(Technique::ZFail);
        let (off, objects) = (BTreeSet::new(), ObjectChanges::default());
        let request = RunRequest { choice, size: [width, 1], camera, lights: Vec::new(), time, off, objects };
        RunState { source: Some("tori".to_owned()), request: Arc::new(request), lights_opened: Vec::new() }
    }

    fn widths(undo: &mut UndoHistory) -> Vec<u32> {
        std::iter::from_fn(|| undo.undo()).map(|state| state.request.size[0]).collect()
    }

    #[test]
    fn undo_within_a_drag_loses_nothing_and_each_step_has_a_name() {
        let mut undo = UndoHistory::default();
        undo.note(state(1, 0.0));
        undo.note(state(2, 0.0));
        undo.hold(true);
        undo.note(state(3, 0.0));
        assert_eq!(undo.undoes(&[]).as_deref(), Some("the picture's size"));
        assert_eq!(undo.undo(), Some(state(2, 0.0)));
        assert_eq!(undo.redoes(&[]).as_deref(), Some("the picture's size"));
        // The button is still down, and the drag goes on.
        undo.note(state(4, 0.0));
        undo.hold(false);
        assert_eq!(undo.undo(), Some(state(2, 0.0)), "the state that the drag went on from");
        assert_eq!(undo.undo(), Some(state(1, 0.0)));
    }

    #[test]
    fn of_objects_a_step_has_the_names() {
        let names = ["floor", "red ball", "blue ball"].map(str::to_owned);
        let with = |change: fn(&mut RunRequest)| {
            let mut changed = state(1, 0.0);
            change(Arc::make_mut(&mut changed.request));
            state(1, 0.0).change_to(&changed, &names)
        };
        assert_eq!(with(|run| run.objects.moved.extend([(2, crate::scene::Pose::default())])), "blue ball");
        assert_eq!(with(|run| run.off.extend([1])), "red ball");
        assert_eq!(with(|run| run.off.extend([0, 1])), "floor, red ball");
        let object = || {
            let mesh = crate::scene::shapes::cuboid([1.0; 3]).expect("a box");
            crate::scene::Object::of("new box", Arc::new(mesh))
        };
        let mut one = state(1, 0.0);
        Arc::make_mut(&mut one.request).objects.added.push(object());
        assert_eq!(state(1, 0.0).change_to(&one, &names), "an added object");
        assert_eq!(one.change_to(&state(1, 0.0), &names), "a deleted object");
        let mut off = one.clone();
        Arc::make_mut(&mut off.request).off.extend([3]);
        assert_eq!(one.change_to(&off, &names), "new box");
    }

    #[test]
    fn steps_go_back_and_forth_and_a_change_forgets_what_was_undone() {
        let mut undo = UndoHistory::default();
        (1..=3).for_each(|width| undo.note(state(width, 0.0)));
        assert_eq!(undo.undo(), Some(state(2, 0.0)));
        assert_eq!(undo.redo(), Some(state(3, 0.0)));
        assert_eq!(undo.redo(), None);
        undo.undo();
        undo.note(state(9, 0.0));
        assert!(!undo.can_redo());
        assert_eq!(widths(&mut undo), [2, 1]);
    }

    #[test]
    fn what_is_dragged_is_one_step() {
        let mut undo = UndoHistory::default();
        undo.note(state(1, 0.0));
        undo.hold(true);
        (2..=5).for_each(|width| undo.note(state(width, 0.0)));
        undo.hold(false);
        undo.note(state(6, 0.0));
        assert_eq!(widths(&mut undo), [5, 1]);
    }

    #[test]
    fn a_running_animation_is_no_step_and_neither_is_the_same_again() {
        let mut undo = UndoHistory::default();
        undo.note(state(1, 0.0));
        undo.note(state(1, 0.5));
        undo.note(state(1, 0.5));
        assert!(!undo.can_undo());
        undo.note(state(2, 0.5));
        assert_eq!(undo.undo(), Some(state(1, 0.5)), "at the moment where it was left");
    }

    #[test]
    fn only_so_many_steps_are_kept() {
        let mut undo = UndoHistory::default();
        (0..500).for_each(|width| undo.note(state(width, 0.0)));
        assert_eq!(widths(&mut undo).len(), MOST);
    }
}
