//! How the open scene is to be run: all that can be changed of it without opening another.

use crate::scene::{Camera, Light, Scene};
use crate::technique::Choice;
use std::collections::BTreeSet;

/// How a scene is to be run; its objects are those of the scene.
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
}

impl RunRequest {
    /// A scene as it is, at time 0.
    #[must_use]
    pub fn of(scene: &Scene, choice: Choice, size: [u32; 2]) -> RunRequest {
        RunRequest { choice, size, camera: scene.camera, lights: scene.lights.clone(), time: 0.0, off: BTreeSet::new() }
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
        if self.size.contains(&0) {
            return Err("the picture needs at least one pixel each way".to_owned());
        }
        if !self.time.is_finite() {
            return Err("the time must be a finite number of seconds".to_owned());
        }
        Ok(())
    }

    /// The scene with this camera, these lights, and without what is switched off; still at its start.
    #[must_use]
    pub fn applied_to(&self, loaded: &Scene) -> Scene {
        Scene { camera: self.camera, lights: self.lights.clone(), ..without(loaded, &self.off) }
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
