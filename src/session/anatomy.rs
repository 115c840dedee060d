//! The anatomy of a frame that was run: its parts as they lie in space.

use super::Session;
use crate::anatomy::{Anatomy, anatomy};
use crate::plan::FramePlan;
use crate::scene::Scene;
use crate::technique::Choice;

impl Session {
    /// Returns the parts of the frame of `plan` in space: of `scene` as it was captured, and planned as `choice` says;
    /// `None` for a frame that another program drew.
    pub fn anatomy(&mut self, scene: &Scene, choice: Option<&Choice>, plan: &FramePlan) -> Anatomy {
        anatomy(scene, choice, plan, &mut self.geometry)
    }
}
