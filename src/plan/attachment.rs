//! A picture that passes draw into: its format, and how its depths are stored.

use super::ids::LightId;
use serde::{Deserialize, Serialize};
use wgpu_types::TextureFormat;

/// A texture that passes draw into: the picture, depth and stencil, a shadow map, a count, labels, or a light's
/// visibility.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Attachment {
    /// Shown to people: `color`, `depth and stencil`, `light 0 map`, `light 0 labels`.
    pub name: String,
    /// What it is for, which decides how it is read back and shown.
    pub role: AttachmentRole,
    /// The GPU format of its texels.
    pub format: TextureFormat,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Number of layers: 1, or the faces of a shadow map. In memory there are
    /// [`FramePlan::stored_layers`](super::FramePlan::stored_layers).
    pub layers: u32,
}

/// What an attachment is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum AttachmentRole {
    /// The picture's colour.
    Color,
    /// The picture's depth, and stencil where the format has it.
    DepthStencil,
    /// A light's shadow map: depth, or the colour of what casters let through.
    Map(LightId),
    /// How many shadow volumes of a light contain each pixel's surface, signed.
    Count(LightId),
    /// The technique's labels of a light, one byte a pixel: 0 lit, 1 in shadow, 2 background, 3 faces away from the
    /// light or is beyond its range.
    Labels(LightId),
    /// Which share of a light arrives at each pixel's surface, 0 to 1.
    Visibility(LightId),
}

impl Attachment {
    /// Returns the largest integer depth, 2^bits − 1, of a format that stores depths as integers; `None` for other
    /// formats.
    pub fn depth_steps(&self) -> Option<u32> {
        match self.format {
            TextureFormat::Depth16Unorm => Some(0xffff),
            TextureFormat::Depth24Plus | TextureFormat::Depth24PlusStencil8 => Some(0xff_ffff),
            _ => None,
        }
    }

    /// Returns the format that the attachment gets on the GPU. Depths of 16 and 24 bits can't be copied everywhere, so
    /// they are stored as floats; no two of them share one.
    pub fn stored_format(&self) -> TextureFormat {
        match self.format {
            TextureFormat::Depth16Unorm | TextureFormat::Depth24Plus => TextureFormat::Depth32Float,
            TextureFormat::Depth24PlusStencil8 => TextureFormat::Depth32FloatStencil8,
            format => format,
        }
    }

    /// Returns how far a recomputed depth may be from the stored one: sixteen steps of its format, or of 24 bits.
    /// OpenGL's clip space begins at −w, and a corner's depth is rounded once more on its way to ours.
    pub fn depth_rounding(&self) -> f32 {
        16.0 / self.depth_steps().unwrap_or(0xff_ffff) as f32
    }

    /// Rounds a depth to the nearest that the format can store, half to even; unchanged where the format stores floats.
    /// Does not clamp to 0 to 1.
    pub fn stored_depth(&self, depth: f32) -> f32 {
        match self.depth_steps() {
            Some(steps) => (depth * steps as f32).round_ties_even() / steps as f32,
            None => depth,
        }
    }
}
