//! The anatomy of a frame that was run: its parts as they lie in space.

use super::AsyncSession;
use crate::anatomy::{Anatomy, anatomy};
use crate::plan::FramePlan;
use crate::scene::Scene;
use crate::technique::Choice;

impl AsyncSession {
    /// As [`Session::anatomy`](super::Session::anatomy).
    pub fn anatomy(&mut self, scene: &Scene, choice: Option<&Choice>, plan: &FramePlan) -> Anatomy {
        anatomy(scene, choice, plan, &mut self.geometry)
    }
}
