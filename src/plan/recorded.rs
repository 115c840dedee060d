//! What only the frames of other programs need: a viewport, targets that hold something before a pass begins,
//! depths stored in 16 or 24 bits, shaders of which no more is known than where their vertices land.

use super::{Attachment, Blob, Draw, DrawMesh, Pass, Program};
use serde::{Deserialize, Serialize};
use wgpu::TextureFormat;

named_enum! {
    /// May a shader do it?
    pub enum ShaderEffect {
        /// It can't.
        No = "no",
        /// It may, for some fragments.
        Yes = "yes",
        /// It could not be read.
        Unknown = "unknown",
    }
}

/// What a pass of another program's frame has beside what ours have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedPass {
    /// Where its draws land.
    pub viewport: Viewport,
    /// The program's debug groups that it is in, outermost first.
    pub groups: Vec<String>,
    /// What its depth and stencil hold as it begins, where that is not what the pass before left.
    #[serde(skip)]
    pub start: Option<StartContent>,
}

/// Where clip space lands in a target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Viewport {
    /// Left, top, width and height in pixels.
    pub area: [f32; 4],
    /// The stored depths of clip depth 0 and 1, each in [0, 1], the smaller one first.
    pub depth: [f32; 2],
}

impl Viewport {
    /// All of a target, and all depths.
    pub fn whole(size: [u32; 2]) -> Viewport {
        let [width, height] = size.map(|side| side as f32);
        Viewport { area: [0.0, 0.0, width, height], depth: [0.0, 1.0] }
    }

    /// The stored depth of a clip depth.
    pub fn stored(&self, depth: f64) -> f64 {
        let [near, far] = self.depth.map(f64::from);
        near + (far - near) * depth
    }
}

/// What a depth-stencil target holds, row by row from the top, without padding.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StartContent {
    /// As stored.
    pub depth: Option<Blob<f32>>,
    /// Eight bits.
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

    /// The format that the GPU is given: depths of 16 and 24 bits can't be copied everywhere, so they are kept as the
    /// floats next to them, of which each is another.
    pub fn stored_format(&self) -> TextureFormat {
        match self.format {
            TextureFormat::Depth16Unorm | TextureFormat::Depth24Plus => TextureFormat::Depth32Float,
            TextureFormat::Depth24PlusStencil8 => TextureFormat::Depth32FloatStencil8,
            format => format,
        }
    }

    /// How far a depth that is computed anew may be from the one that was stored: sixteen steps of its format, or of 24
    /// bits. OpenGL's clip space begins at −w, and a corner's depth is rounded once more on its way to ours.
    pub fn depth_rounding(&self) -> f32 {
        16.0 / self.depth_steps().unwrap_or(0xff_ffff) as f32
    }

    /// A depth as it is stored: the nearest that the format has.
    pub fn stored_depth(&self, depth: f32) -> f32 {
        match self.depth_steps() {
            Some(steps) => (depth * steps as f32).round_ties_even() / steps as f32,
            None => depth,
        }
    }
}

impl Program {
    /// Is it another program's shader? Vertices are in clip space then, and go through as they are.
    pub fn is_recorded(self) -> bool {
        matches!(self, Program::Recorded { .. })
    }
}

impl Pass {
    /// Where its draws land in a target of that size.
    pub fn viewport(&self, size: [u32; 2]) -> Viewport {
        self.recorded.as_ref().map_or_else(|| Viewport::whole(size), |recorded| recorded.viewport)
    }
}

impl Draw {
    /// May its shader discard fragments without it being known which? `mesh` is the draw's.
    pub fn discards_unknown(&self, mesh: &DrawMesh) -> bool {
        matches!(self.program, Program::Recorded { may_discard: ShaderEffect::Yes | ShaderEffect::Unknown, .. })
            && mesh.retained.is_none()
    }
}
