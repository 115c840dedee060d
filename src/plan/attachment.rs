//! A picture that passes draw into: its format, and how its depths are stored.

use super::ids::LightId;
use crate::math::DepthBits;
use serde::{Deserialize, Serialize};
use wgpu_types::{DepthBiasState, TextureFormat};

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
    /// To how many bits passes floor the depths that they test and write ([`DepthBits::floored`]); `None` where depths are stored
    /// as the format stores them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth_bits: Option<DepthBits>,
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
    /// Returns the largest integer depth, 2^bits − 1, where depths are floored to bits or the format stores them as
    /// integers; else `None`.
    pub fn depth_steps(&self) -> Option<u32> {
        self.integer_bits().map(DepthBits::steps)
    }

    /// Returns the bits of the integers that depths are stored as: those that passes floor to, else the format's.
    fn integer_bits(&self) -> Option<DepthBits> {
        self.depth_bits.or(match self.format {
            TextureFormat::Depth16Unorm => Some(DepthBits::SIXTEEN),
            TextureFormat::Depth24Plus | TextureFormat::Depth24PlusStencil8 => Some(DepthBits::TWENTY_FOUR),
            _ => None,
        })
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
        16.0 / self.integer_bits().unwrap_or(DepthBits::TWENTY_FOUR).steps() as f32
    }

    /// Returns a depth as it is stored: floored and clamped to 0 to 1 where passes floor it, rounded to the nearest that
    /// the format can store, half to even and not clamped, where that stores integers; else unchanged.
    pub fn stored_depth(&self, depth: f32) -> f32 {
        match (self.depth_bits, self.depth_steps()) {
            (Some(bits), _) => bits.floored(depth),
            (None, Some(steps)) => (depth * steps as f32).round_ties_even() / steps as f32,
            (None, None) => depth,
        }
    }

    /// Returns the part of a draw's depth bias that the rasteriser adds. A constant is in the smallest steps of depth: of
    /// depths that passes floor, the rasteriser would add steps of a float.
    pub fn rasteriser_bias(&self, bias: DepthBiasState) -> DepthBiasState {
        if self.depth_bits.is_some() { DepthBiasState { constant: 0, ..bias } } else { bias }
    }

    /// Returns the part of a draw's depth bias, as a depth, that is added before depths are floored; 0 where they are not.
    pub fn shader_bias(&self, bias: DepthBiasState) -> f32 {
        self.depth_bits.map_or(0.0, |bits| bias.constant as f32 / (bits.steps() + 1) as f32)
    }
}
