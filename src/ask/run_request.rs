//! How the open scene is to be run: all that can be changed of it without opening another.

use crate::scene::{Camera, Light, Object, Pose, Scene};
use crate::technique::Choice;
use std::collections::{BTreeMap, BTreeSet};

/// How many objects may be added to a scene: each is planned, drawn and casts.
const MOST_ADDED: usize = 200;

/// How a scene is to be run; its objects are those of the scene, with changes.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRequest {
    /// The technique and its settings.
    pub choice: Choice,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// The camera.
    pub camera: Camera,
    /// All lights, with their positions at the scene's start.
    pub lights: Vec<Light>,
    /// The time in an animated scene, seconds.
    pub time: f64,
    /// Objects that are switched off, by index: neither drawn nor casting.
    pub off: BTreeSet<usize>,
    /// Changes of the objects.
    pub objects: ObjectChanges,
}

/// The user's changes to a scene's objects since it was opened.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectChanges {
    /// Poses of moved objects at the scene's start, by index; they replace the loaded ones.
    pub moved: BTreeMap<usize, Pose>,
    /// Added objects. Their indices come after those of the scene.
    pub added: Vec<Object>,
}

impl ObjectChanges {
    /// Returns a copy of the opened scene with the moved objects' poses replaced and the added objects appended; a
    /// moved index without an object is ignored.
    pub fn applied_to(&self, loaded: &Scene) -> Scene {
        let mut scene = loaded.clone();
        for (index, pose) in &self.moved {
            if let Some(object) = scene.objects.get_mut(*index) {
                object.pose = *pose;
            }
        }
        scene.objects.extend(self.added.iter().cloned());
        scene
    }

    /// Checks that not too many objects were added and that all moved and added poses can be used. The error says in a
    /// few words what can't be run, and how to fix it.
    fn check(&self) -> Result<(), String> {
        if self.added.len() > MOST_ADDED {
            return Err(format!("no more than {MOST_ADDED} objects can be added: delete some"));
        }
        let mut poses = self.moved.values().chain(self.added.iter().map(|object| &object.pose));
        poses.try_for_each(|pose| pose.check().map_err(str::to_owned))
    }
}

impl RunRequest {
    /// Returns the request that runs a scene unchanged, at time 0.
    pub fn of(scene: &Scene, choice: Choice, size: [u32; 2]) -> RunRequest {
        RunRequest {
            choice,
            size,
            camera: scene.camera,
            lights: scene.lights.clone(),
            time: 0.0,
            off: BTreeSet::new(),
            objects: ObjectChanges::default(),
        }
    }

    /// Checks that a scene can be run so: usable camera, lights and objects' poses, not too many added objects, at
    /// least one pixel each way, and a finite time.
    ///
    /// # Errors
    /// A camera or light that can't be used, a picture without pixels: in a few words, with how to fix it.
    pub fn check(&self) -> Result<(), String> {
        self.camera.check()?;
        for (index, light) in self.lights.iter().enumerate() {
            light.check().map_err(|reason| format!("light {}: {reason}", index + 1))?;
        }
        self.objects.check()?;
        if self.size.contains(&0) {
            return Err("the picture needs at least one pixel each way".to_owned());
        }
        if !self.time.is_finite() {
            return Err("the time must be a finite number of seconds".to_owned());
        }
        Ok(())
    }

    /// Returns whether another request is the same in everything but the time, which may differ or be equal.
    pub fn is_same_but_for_time(&self, other: &RunRequest) -> bool {
        let RunRequest { choice, size, camera, lights, time: _, off, objects } = other;
        let own = (&self.choice, &self.size, &self.camera, &self.lights, &self.off, &self.objects);
        own == (choice, size, camera, lights, off, objects)
    }

    /// Returns the opened scene with this camera, these lights and the changed and added objects, without those that
    /// are switched off; it is at its start: the request's time is not applied.
    pub fn applied_to(&self, loaded: &Scene) -> Scene {
        let scene = without(self.objects.applied_to(loaded), &self.off);
        Scene { camera: self.camera, lights: self.lights.clone(), ..scene }
    }
}

/// A run request carried over to a scene that was loaded again.
#[derive(Debug, Clone, PartialEq)]
pub struct CarriedOver {
    /// The new request.
    pub request: RunRequest,
    /// The changes that could not be carried over, each in a few words.
    pub dropped: Vec<String>,
}

impl RunRequest {
    /// Returns this request of `before` for what the scene's file contains now: changes of objects apply to those with
    /// the same name, and changes of lights are dropped where the file added or deleted lights as well.
    pub fn carried_over(&self, before: &Scene, after: &Scene) -> CarriedOver {
        let mut dropped = Vec::new();
        let names = |scene: &Scene| scene.objects.iter().map(|object| object.name.clone()).collect::<Vec<_>>();
        let (names_before, names_after) = (names(before), names(after));
        // Objects of one name are matched in order.
        let place = |index: usize| {
            let Some(name) = names_before.get(index) else {
                return Ok(index - names_before.len() + names_after.len());
            };
            let earlier = names_before[..index].iter().filter(|other| *other == name).count();
            let mut same = names_after.iter().enumerate().filter(|(_, other)| *other == name);
            same.nth(earlier).map(|(index, _)| index).ok_or(name)
        };
        let mut note = |name: &String| {
            let words = format!("what was set of {name}, which is not in it any longer");
            if !dropped.contains(&words) {
                dropped.push(words);
            }
        };
        let mut off = BTreeSet::new();
        for index in &self.off {
            match place(*index) {
                Ok(index) => off.extend([index]),
                Err(name) => note(name),
            }
        }
        let mut moved = BTreeMap::new();
        for (index, pose) in &self.objects.moved {
            match place(*index) {
                Ok(index) => moved.extend([(index, *pose)]),
                Err(name) => note(name),
            }
        }
        let objects = ObjectChanges { moved, added: self.objects.added.clone() };
        let lights = carried_lights(&self.lights, &before.lights, &after.lights).unwrap_or_else(|| {
            dropped.push("what was set of its lights, of which it has another number by now".to_owned());
            after.lights.clone()
        });
        CarriedOver { request: RunRequest { lights, off, objects, ..self.clone() }, dropped }
    }
}

/// Returns the lights of a request for a scene that was loaded again; `None` where both the user and the file changed
/// which lights there are, so that they can't be matched.
fn carried_lights(own: &[Light], before: &[Light], after: &[Light]) -> Option<Vec<Light>> {
    if own == before {
        return Some(after.to_vec());
    }
    if before == after {
        return Some(own.to_vec());
    }
    let is_as_many = own.len() == before.len() && before.len() == after.len();
    let one = |((own, before), after): ((&Light, &Light), &Light)| if own == before { after } else { own }.clone();
    is_as_many.then(|| own.iter().zip(before).zip(after).map(one).collect())
}

/// Returns a scene without the objects of these indices, so that later objects get smaller indices; an index without an
/// object is ignored.
pub fn without(mut scene: Scene, off: &BTreeSet<usize>) -> Scene {
    let mut index = 0;
    scene.objects.retain(|_| {
        index += 1;
        !off.contains(&(index - 1))
    });
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, shapes};
    use glam::DVec3;
    use std::sync::Arc;

    fn scene(names: &[&str], heights: &[f64]) -> Scene {
        let mesh = Arc::new(shapes::cuboid([1.0; 3]).expect("a box"));
        let object = |name: &&str| Object::new(*name, Arc::clone(&mesh), Material::default());
        let lights = heights.iter().map(|height| Light::point([0.0, *height, 0.0])).collect();
        let mut scene = crate::scene::SceneBuilder::new("a test").objects(names.iter().map(object)).build();
        scene.lights = lights;
        scene
    }

    fn run(scene: &Scene) -> RunRequest {
        RunRequest::of(scene, Choice::new(crate::technique::Technique::ZFail), [8, 8])
    }

    fn at(x: f64) -> Pose {
        Pose { translate: DVec3::X * x, ..Pose::default() }
    }

    #[test]
    fn what_was_set_of_objects_follows_their_names() {
        let before = scene(&["floor", "box", "box", "lid"], &[1.0]);
        let after = scene(&["box", "wall", "floor", "box"], &[1.0]);
        let mut draft = run(&before);
        draft.objects.added.push(before.objects[1].clone());
        draft.objects.moved = BTreeMap::from([(0, at(1.0)), (2, at(2.0)), (3, at(3.0))]);
        draft.off = BTreeSet::from([1, 3, 4]);
        let CarriedOver { request, dropped } = draft.carried_over(&before, &after);
        assert_eq!(request.objects.moved, BTreeMap::from([(2, at(1.0)), (3, at(2.0))]));
        assert_eq!(request.objects.added, draft.objects.added);
        assert_eq!(request.off, BTreeSet::from([0, 4]), "the first box, and the one that was added");
        assert_eq!(dropped, ["what was set of lid, which is not in it any longer"]);
    }

    #[test]
    fn lights_set_here_stay_and_others_are_the_file_s() {
        let before = scene(&[], &[1.0, 2.0]);
        let mut draft = run(&before);
        draft.lights[1].position.x = 7.0;
        let CarriedOver { request, dropped } = draft.carried_over(&before, &scene(&[], &[5.0, 6.0]));
        assert_eq!(request.lights.iter().map(|light| light.position.y).collect::<Vec<_>>(), [5.0, 2.0]);
        assert_eq!((request.lights[1].position.x, dropped.len()), (7.0, 0));
        draft.lights.push(Light::point([0.0, 9.0, 0.0]));
        assert_eq!(draft.carried_over(&before, &before).request.lights, draft.lights);
        let other = scene(&[], &[3.0]);
        let CarriedOver { request, dropped } = draft.carried_over(&before, &other);
        assert_eq!((request.lights, dropped.len()), (other.lights, 1));
    }
}
