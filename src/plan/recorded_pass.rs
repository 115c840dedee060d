//! What only a pass of another program's frame has: a viewport, debug groups, and targets with content before it begins.

use crate::geometry::Blob;
use serde::{Deserialize, Serialize};

/// Data of a pass of another program's frame that our own passes do not have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedPass {
    /// The viewport of its draws.
    pub viewport: Viewport,
    /// The program's debug groups around it, outermost first.
    pub groups: Vec<String>,
    /// Whether it takes a light's share away where its stencil test passes, instead of adding it. False where folders of
    /// earlier versions do not say it.
    #[serde(default)]
    pub darkens: bool,
    /// Depth and stencil as the pass begins; `None` where that is what the pass before left.
    #[serde(skip)]
    pub start: Option<StartContent>,
}

impl RecordedPass {
    /// The name of passes that take light away, and of their steps.
    pub const DARKENING: &'static str = "darkening";
}

/// The rectangle and the depth range of a target that clip space is mapped to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Viewport {
    /// Left, top, width and height in pixels.
    pub area: [f32; 4],
    /// The stored depths of clip depth 0 and 1, each in [0, 1], the smaller one first.
    pub depth: [f32; 2],
}

impl Viewport {
    /// Returns the viewport of a whole target of `size` pixels, with depths 0 to 1.
    pub fn whole(size: [u32; 2]) -> Viewport {
        let [width, height] = size.map(|side| side as f32);
        Viewport { area: [0.0, 0.0, width, height], depth: [0.0, 1.0] }
    }

    /// Converts a depth from 0 to 1 in normalized device coordinates to the depth that is stored, by the viewport's
    /// depth range. Does not clamp.
    pub fn stored(&self, depth: f64) -> f64 {
        let [near, far] = self.depth.map(f64::from);
        near + (far - near) * depth
    }
}

/// Content of a depth-stencil target before a pass, row by row from the top, without padding.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StartContent {
    /// Depths as stored; `None` where the target has none.
    pub depth: Option<Blob<f32>>,
    /// Stencil values, a byte a pixel; `None` where the target has none.
    pub stencil: Option<Blob<u8>>,
}
