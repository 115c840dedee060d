//! How the open scene is to be run: all that can be changed of it without opening another.

use crate::scene::{Camera, Light, Object, Pose, Scene};
use crate::technique::Choice;
use std::collections::{BTreeMap, BTreeSet};

/// Objects that a scene may get in addition: each is planned, drawn and casts.
const MOST_ADDED: usize = 200;

/// How a scene is to be run; its objects are those of the scene, but for what is changed of them.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRequest {
    /// How shadows are made.
    pub choice: Choice,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// The eye.
    pub camera: Camera,
    /// All lights, where they are at the scene's start.
    pub lights: Vec<Light>,
    /// The moment of an animated scene, seconds.
    pub time: f64,
    /// Objects that are switched off, by index: neither drawn nor casting.
    pub off: BTreeSet<usize>,
    /// What is changed of them.
    pub objects: ObjectChanges,
}

/// What is changed of a scene's objects.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectChanges {
    /// Where objects of the scene are at its start, by index, in place of where they were loaded.
    pub moved: BTreeMap<usize, Pose>,
    /// Objects that are new. Their indexes come after those of the scene.
    pub added: Vec<Object>,
}

impl ObjectChanges {
    /// The scene with these changes.
    #[must_use]
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

    /// Names what can't be run, in a few words with the mend.
    fn check(&self) -> Result<(), String> {
        if self.added.len() > MOST_ADDED {
            return Err(format!("no more than {MOST_ADDED} objects can be added: delete some"));
        }
        let mut poses = self.moved.values().chain(self.added.iter().map(|object| &object.pose));
        poses.try_for_each(|pose| pose.check().map_err(str::to_owned))
    }
}

impl RunRequest {
    /// A scene as it is, at time 0.
    #[must_use]
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

    /// Names what can't be run, in a few words with the mend.
    ///
    /// # Errors
    /// A camera or light that can't be used, a picture without pixels.
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

    /// The scene with this camera, these lights, its objects changed, and without what is switched off; still at its
    /// start.
    #[must_use]
    pub fn applied_to(&self, loaded: &Scene) -> Scene {
        let scene = without(&self.objects.applied_to(loaded), &self.off);
        Scene { camera: self.camera, lights: self.lights.clone(), ..scene }
    }
}

/// A scene without some of its objects, by index.
#[must_use]
pub fn without(scene: &Scene, off: &BTreeSet<usize>) -> Scene {
    let mut scene = scene.clone();
    let mut index = 0;
    scene.objects.retain(|_| {
        index += 1;
        !off.contains(&(index - 1))
    });
    scene
}
