//! What only the frames of other programs need: a viewport, targets with content before a pass begins, depths stored in
//! 16 or 24 bits, and shaders of which only the vertices' clip positions are known.

use super::{Attachment, Blob, Draw, DrawMesh, Pass, Program};
use serde::{Deserialize, Serialize};
use wgpu::TextureFormat;

named_enum! {
    /// Whether a shader has an effect, such as discarding fragments.
    pub enum ShaderEffect {
        /// It never has it.
        No = "no",
        /// It may have it, for some fragments.
        Yes = "yes",
        /// The shader could not be read.
        Unknown = "unknown",
    }
}

/// Further data of a pass of another program's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedPass {
    /// The viewport of its draws.
    pub viewport: Viewport,
    /// The program's debug groups around it, outermost first.
    pub groups: Vec<String>,
    /// Content of its depth and stencil as it begins, where that is not what the pass before left.
    #[serde(skip)]
    pub start: Option<StartContent>,
}

/// The rectangle and depth range of a target that clip space is mapped to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Viewport {
    /// Left, top, width and height in pixels.
    pub area: [f32; 4],
    /// The stored depths of clip depth 0 and 1, each in [0, 1], the smaller one first.
    pub depth: [f32; 2],
}

impl Viewport {
    /// The viewport of a whole target, with all depths.
    pub fn whole(size: [u32; 2]) -> Viewport {
        let [width, height] = size.map(|side| side as f32);
        Viewport { area: [0.0, 0.0, width, height], depth: [0.0, 1.0] }
    }

    /// Returns the depth that a clip depth is stored as.
    pub fn stored(&self, depth: f64) -> f64 {
        let [near, far] = self.depth.map(f64::from);
        near + (far - near) * depth
    }
}

/// Content of a depth-stencil target, row by row from the top, without padding.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StartContent {
    /// Depths as stored; `None` where the target has none.
    pub depth: Option<Blob<f32>>,
    /// Stencil values, a byte a pixel; `None` where the target has none.
    pub stencil: Option<Blob<u8>>,
}

impl Attachment {
    /// The largest depth as an integer, where the format stores depths as integers: 2^bits − 1.
    pub fn depth_steps(&self) -> Option<u32> {
        match self.format {
            TextureFormat::Depth16Unorm => Some(0xffff),
            TextureFormat::Depth24Plus | TextureFormat::Depth24PlusStencil8 => Some(0xff_ffff),
            _ => None,
        }
    }

    /// The format that the attachment gets on the GPU. Depths of 16 and 24 bits can't be copied everywhere, so each is
    /// stored as the nearest float; no two of them share one.
    pub fn stored_format(&self) -> TextureFormat {
        match self.format {
            TextureFormat::Depth16Unorm | TextureFormat::Depth24Plus => TextureFormat::Depth32Float,
            TextureFormat::Depth24PlusStencil8 => TextureFormat::Depth32FloatStencil8,
            format => format,
        }
    }

    /// How far a recomputed depth may be from the one that was stored: sixteen steps of its format, or of 24 bits.
    /// OpenGL's clip space begins at −w, and a corner's depth is rounded once more on its way to ours.
    pub fn depth_rounding(&self) -> f32 {
        16.0 / self.depth_steps().unwrap_or(0xff_ffff) as f32
    }

    /// Rounds a depth to the nearest that the format can store.
    pub fn stored_depth(&self, depth: f32) -> f32 {
        match self.depth_steps() {
            Some(steps) => (depth * steps as f32).round_ties_even() / steps as f32,
            None => depth,
        }
    }
}

impl Program {
    /// Returns whether it is another program's shader. Its vertices are in clip space, and go through unchanged.
    pub fn is_recorded(self) -> bool {
        matches!(self, Program::Recorded { .. })
    }
}

impl Pass {
    /// Returns the viewport of its draws in a target of that size.
    pub fn viewport(&self, size: [u32; 2]) -> Viewport {
        self.recorded.as_ref().map_or_else(|| Viewport::whole(size), |recorded| recorded.viewport)
    }
}

impl Draw {
    /// Returns whether the draw's shader may discard fragments and no record says which. `mesh` is the draw's.
    pub fn discards_unknown(&self, mesh: &DrawMesh) -> bool {
        matches!(self.program, Program::Recorded { may_discard: ShaderEffect::Yes | ShaderEffect::Unknown, .. })
            && mesh.retained.is_none()
    }
}
