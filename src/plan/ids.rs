//! Indices into the lists of a plan, each a type of its own, so that none is taken for another.

use serde::{Deserialize, Serialize};

/// Index into [`FramePlan::attachments`](super::FramePlan::attachments).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AttachmentId(pub usize);

/// Index into [`FramePlan::views`](super::FramePlan::views).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ViewId(pub usize);

/// Index of a light, in the scene and in [`FramePlan::lights`](super::FramePlan::lights) alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LightId(pub usize);

impl LightId {
    /// Shown to people, counted from 1: `light 1`.
    pub fn name(self) -> String {
        crate::numbers::light(self.0)
    }
}

/// Index into [`FramePlan::meshes`](super::FramePlan::meshes).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MeshId(pub usize);

/// Index into [`FramePlan::textures`](super::FramePlan::textures).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TextureId(pub usize);
