//! What only a pass of another program's frame has: a viewport, debug groups, and targets with content before it begins.

use crate::geometry::Blob;
use glam::DVec4;
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

    /// Converts a clip-space position of this viewport to the clip space of its whole target of `size` pixels and of all
    /// depths.
    pub fn clip_of_target(&self, size: [u32; 2], clip: DVec4) -> DVec4 {
        let [left, top, width, height] = self.area.map(f64::from);
        let [columns, rows] = size.map(f64::from);
        let [near, far] = self.depth.map(f64::from);
        DVec4::new(
            clip.x * width / columns + clip.w * ((2.0 * left + width) / columns - 1.0),
            clip.y * height / rows - clip.w * ((2.0 * top + height) / rows - 1.0),
            near * clip.w + (far - near) * clip.z,
            clip.w,
        )
    }

    /// Converts a clip-space position of the whole target of `size` pixels and of all depths to this viewport's: the
    /// inverse of [`Viewport::clip_of_target`]. An empty depth range has depth 0.
    pub fn clip_from_target(&self, size: [u32; 2], clip: DVec4) -> DVec4 {
        let [left, top, width, height] = self.area.map(f64::from);
        let [columns, rows] = size.map(f64::from);
        let [near, far] = self.depth.map(f64::from);
        DVec4::new(
            (clip.x - clip.w * ((2.0 * left + width) / columns - 1.0)) * columns / width,
            (clip.y + clip.w * ((2.0 * top + height) / rows - 1.0)) * rows / height,
            if far > near { (clip.z - near * clip.w) / (far - near) } else { 0.0 },
            clip.w,
        )
    }

    /// Returns why there is no such viewport; `None` where WebGPU takes it: an area of finite numbers that is not empty, and
    /// depths from 0 to 1, the first not the greater.
    pub(super) fn problem(&self) -> Option<&'static str> {
        let Viewport { area, depth: [near, far] } = self;
        let is_area =
            area.iter().all(|value| value.is_finite() && value.abs() <= 32768.0) && area[2] > 0.0 && area[3] > 0.0;
        let is_range = (0.0..=1.0).contains(near) && (*near..=1.0).contains(far);
        (!is_area || !is_range).then_some("its viewport can't be")
    }

    /// Converts a stored depth to one from 0 to 1 in normalized device coordinates: the inverse of [`Viewport::stored`].
    /// An empty depth range has depth 0.
    pub fn device(&self, stored: f32) -> f32 {
        let [near, far] = self.depth;
        if far > near { (stored - near) / (far - near) } else { 0.0 }
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
