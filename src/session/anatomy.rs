//! What a frame is made of in space, of a plan that was run.

use super::Session;
use crate::anatomy::{Anatomy, anatomy};
use crate::plan::FramePlan;
use crate::scene::Scene;
use crate::technique::Choice;

impl Session {
    /// What the frame of `plan` is made of: of `scene` at its moment, made as `choice` says; without one another
    /// program drew it.
    pub fn anatomy(&mut self, scene: &Scene, choice: Option<&Choice>, plan: &FramePlan) -> Anatomy {
        anatomy(scene, choice, plan, &mut self.geometry)
    }
}
