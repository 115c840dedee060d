//! A frame as RenderDoc reports it: plain data, with no interpretation beyond units and orientation.
//!
//! All APIs are normalised: row 0 of a picture is at the top, viewport and scissor count pixels from there, and
//! "counter-clockwise" is as seen on that picture. States are wgpu's, as far as wgpu has them.

use crate::capture::Image;
use crate::plan::{FaceMasks, ShaderEffect, StencilFace};
use std::ops::Range;
use std::sync::Arc;
use wgpu_types::{BlendComponent, CompareFunction, PolygonMode};

named_enum! {
    /// The graphics API whose calls were recorded.
    pub enum RecordedApi {
        /// Vulkan, of any version.
        Vulkan = "Vulkan",
        /// OpenGL, core profile.
        OpenGl = "OpenGL",
        /// OpenGL ES.
        Gles = "OpenGLES",
        /// wgpu, recorded from within the program.
        Wgpu = "wgpu",
    }
}

/// One frame of another program, as RenderDoc or our recorder describes it, before conversion to a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct RawFrame {
    /// The graphics API whose calls were recorded.
    pub api: RecordedApi,
    /// The GPU that replayed the frame, in the driver's words; empty where it has none.
    pub adapter: String,
    /// The program that recorded it: `RenderDoc 1.24`.
    pub recorder: String,
    /// The program that drew it, where that is known.
    pub program: Option<String>,
    /// The frame's textures; a [`RawTarget`] has an index into these.
    pub textures: Vec<RawTexture>,
    /// Content of each target before the frame's first event: its first picture of colour or depth, each target once.
    pub before: Vec<(RawTarget, RawContents)>,
    /// The frame's events, in order.
    pub events: Vec<RawEvent>,
    /// What could not be read, or not recorded as the program draws it, in words; each once.
    pub limits: Vec<String>,
}

impl RawFrame {
    /// Returns the width and height of a target in texels, of its mip level.
    pub fn size_of(&self, target: RawTarget) -> [u32; 2] {
        self.textures[target.texture].size.map(|side| (side >> target.mip.min(31)).max(1))
    }
}

/// A texture, renderbuffer or swapchain image.
#[derive(Debug, Clone, PartialEq)]
pub struct RawTexture {
    /// Name given by the program or by RenderDoc.
    pub name: String,
    /// Format of its texels.
    pub format: RawFormat,
    /// Texels of the largest mip level, width and height.
    pub size: [u32; 2],
    /// Number of layers; six for each cube; the depth of a 3D texture.
    pub layers: u32,
    /// Samples a texel; 1 where it is not multisampled.
    pub samples: u32,
}

/// The format of a texture's texels, as far as it matters for depth, stencil and colour.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum RawFormat {
    /// Depth in 16 bits, normalised.
    D16,
    /// Depth in 24 bits, normalised.
    D24,
    /// Depth in 24 bits, normalised, and stencil in 8.
    D24S8,
    /// Depth in 32 bits, normalised; read as a float, in which neighbouring values may become equal.
    D32,
    /// Depth as a float.
    D32F,
    /// Depth as a float, and stencil in 8 bits.
    D32FS8,
    /// Stencil in 8 bits.
    S8,
    /// Colour: three bytes.
    Rgb8,
    /// Colour: four bytes.
    Rgba8,
    /// Colour: four bytes, sRGB.
    Rgba8Srgb,
    /// Colour: four bytes, blue first.
    Bgra8,
    /// Colour: four bytes, blue first, sRGB.
    Bgra8Srgb,
    /// Colour: four halves.
    Rgba16F,
    /// Colour: three small floats in 32 bits.
    R11G11B10F,
    /// Colour: ten bits each, and two of alpha.
    Rgb10A2,
    /// Another format, by RenderDoc's name.
    Other(String),
}

impl RawFormat {
    /// Returns the integer that stands for depth 1 (2^bits − 1); `None` where depth is a float, or there is none.
    pub fn largest_depth(&self) -> Option<u32> {
        match self {
            RawFormat::D16 => Some(0xffff),
            RawFormat::D24 | RawFormat::D24S8 => Some(0xff_ffff),
            RawFormat::D32 => Some(u32::MAX),
            _ => None,
        }
    }

    /// Returns whether a texel has depth.
    pub fn has_depth(&self) -> bool {
        self.largest_depth().is_some() || matches!(self, RawFormat::D32F | RawFormat::D32FS8)
    }

    /// Returns whether a texel has stencil that can be read; false for [`RawFormat::Other`], whatever its name says.
    pub fn has_stencil(&self) -> bool {
        matches!(self, RawFormat::D24S8 | RawFormat::D32FS8 | RawFormat::S8)
    }
}

/// A mip level of a layer of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RawTarget {
    /// Index into [`RawFrame::textures`].
    pub texture: usize,
    /// The mip level; 0 is the largest.
    pub mip: u32,
    /// The layer or face.
    pub layer: u32,
}

/// Pictures of a target: each has exactly its width times its height texels, row 0 at the top; of several
/// samples a pixel the first. Rows that are equal to
/// those of the target's last picture share its memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RawContents {
    /// Depth as stored, 0 to 1; an integer is divided by the largest of its format, so that no two become equal.
    pub depth: Option<Arc<Image>>,
    /// Stencil values, a byte a texel.
    pub stencil: Option<Arc<Image>>,
    /// Displayable colour: four bytes a texel. Formats of eight bits are unchanged; floats are clamped to 0 to 1 and
    /// encoded as sRGB.
    pub color: Option<Arc<Image>>,
}

impl RawContents {
    /// Returns these pictures, each that is missing taken from `other`.
    #[must_use]
    pub fn or(self, other: RawContents) -> RawContents {
        let RawContents { depth, stencil, color } = other;
        RawContents { depth: self.depth.or(depth), stencil: self.stencil.or(stencil), color: self.color.or(color) }
    }
}

/// One event of the frame: a draw, a clear, a copy …
#[derive(Debug, Clone, PartialEq)]
pub struct RawEvent {
    /// RenderDoc's number of the event.
    pub id: u32,
    /// The call, as RenderDoc writes it.
    pub name: String,
    /// Debug groups around it, outermost first.
    pub groups: Vec<String>,
    /// What it does.
    pub kind: RawKind,
    /// Colour targets in the order of the shader's outputs; for a copy its destination.
    pub color_targets: Vec<RawTarget>,
    /// Depth-stencil target; for a copy its destination.
    pub depth_target: Option<RawTarget>,
    /// Content of the first colour target and the depth target afterwards. A picture that can't be read is absent:
    /// formats that are not read, multisampled targets of older recordings.
    pub after: RawContents,
}

/// The kind of an event: a draw, a clear, a copy, the begin or end of a pass, compute work, or a presentation.
#[derive(Debug, Clone, PartialEq)]
pub enum RawKind {
    /// Draws triangles, or something else that has none.
    Draw(Box<RawDraw>),
    /// Clears targets, within scissor and write masks.
    Clear {
        /// Whether colour is cleared.
        color: bool,
        /// Whether depth is cleared.
        depth: bool,
        /// Whether stencil is cleared.
        stencil: bool,
    },
    /// A render pass begins: its targets are loaded or cleared.
    BeginPass,
    /// A render pass ends.
    EndPass,
    /// Copies, resolves or blits into a target, or generates its mip chain.
    Copy,
    /// Compute work.
    Compute,
    /// The picture is presented.
    Present,
}

/// A draw call of an imported frame: geometry, raster states and shader effects.
#[derive(Debug, Clone, PartialEq)]
pub struct RawDraw {
    /// How the vertices form primitives after the last vertex stage.
    pub topology: RawTopology,
    /// Clip-space positions after the last vertex stage, of all instances; NaN and infinity are possible.
    pub positions: Vec<[f32; 4]>,
    /// Indices into `positions`, all of them valid, in the order drawn. Strips and fans are split into triangles, each
    /// with the winding that the API gives it. Empty for points and lines.
    pub triangles: Vec<[u32; 3]>,
    /// The triangles of each instance, one range after the other.
    pub instances: Vec<Range<usize>>,
    /// Viewport, scissor and the conventions of clip space.
    pub view: RawView,
    /// Culling, filling, depth bias and depth clipping.
    pub shape: RawShape,
    /// The depth test; absent where it is off or there is no depth: then all fragments pass, and none writes depth.
    pub depth: Option<RawDepth>,
    /// The stencil test, `[front, back]`; absent where it is off or there is no stencil.
    pub stencil: Option<[RawStencilFace; 2]>,
    /// How the first colour target is written; absent where there is none.
    pub blend: Option<RawBlend>,
    /// Effects of the fragment shader.
    pub fragment: RawFragment,
    /// The fragments that its shader did not discard, where they were recorded: column and row of the pixel, and the
    /// triangle.
    pub retained: Option<Vec<([u16; 2], u32)>>,
    /// Samples a pixel of the targets.
    pub samples: u32,
    /// The textures that the fragment shader may sample, as indices into [`RawFrame::textures`]; `None` where that was not
    /// recorded.
    pub sampled: Option<Vec<usize>>,
}

named_enum! {
    /// How vertices form primitives.
    pub enum RawTopology {
        /// Points.
        Points = "points",
        /// Lines of any kind.
        Lines = "lines",
        /// Three corners a triangle.
        TriangleList = "triangle-list",
        /// Each corner forms a triangle with the two before it.
        TriangleStrip = "triangle-strip",
        /// Each corner forms a triangle with the one before it and the first.
        TriangleFan = "triangle-fan",
        /// A list with an adjacent corner across each edge.
        TriangleListAdjacency = "triangle-list-adjacency",
        /// A strip with an adjacent corner across each edge.
        TriangleStripAdjacency = "triangle-strip-adjacency",
        /// Patches, or unknown.
        Other = "other",
    }
}

/// How clip space is mapped to pixels and depths.
///
/// A corner (x, y, z, w) is at column `left + (1 + x/w)·width/2` and row `top + (1 − y/w)·height/2`, or `top + (1 +
/// y/w)·height/2` where `y_up` is false. Its depth is `near + (far − near)·d`, d = z/w or (z/w + 1)/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawView {
    /// Left, top, width and height in pixels, from the top left of the picture; neither side is negative. Where a pixel has
    /// several samples, it is moved by a part of a pixel, so that the first of them lies in the pixel's middle.
    pub viewport: [f32; 4],
    /// The depths of near and far; near may be the larger one.
    pub depth_range: [f32; 2],
    /// Scissor rectangle: left, top, width and height in pixels; absent where there is none.
    pub scissor: Option<[i32; 4]>,
    /// True where y points up on the picture.
    pub y_up: bool,
    /// True where clip space has z from −w to w instead of from 0.
    pub z_from_minus_w: bool,
}

named_enum! {
    /// Which faces are culled.
    pub enum RawCull {
        /// None.
        None = "none",
        /// Front faces.
        Front = "front",
        /// Back faces.
        Back = "back",
        /// Both; also where rasterisation is off.
        Both = "both",
    }
}

/// Which triangles make fragments, and with which depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawShape {
    /// Which faces are culled.
    pub cull: RawCull,
    /// True where triangles that are counter-clockwise on the picture are front faces.
    pub front_is_counter_clockwise: bool,
    /// How a triangle is filled.
    pub fill: PolygonMode,
    /// Depth bias: in units of the smallest step, per slope, and the limit of both (0: none).
    pub bias: [f32; 3],
    /// True where depth is clamped to the depth range.
    pub depth_clamp: bool,
    /// True where triangles are clipped at near and far.
    pub depth_clip: bool,
    /// True where the program clips by planes of its own (`gl_ClipDistance`).
    pub clip_planes: bool,
}

/// The depth test of a draw that has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawDepth {
    /// The fragment passes where its depth compares so with the stored one.
    pub compare: CompareFunction,
    /// True where fragments that pass store their depth.
    pub write: bool,
    /// True where the stored depth is also compared with bounds (which are not recorded).
    pub bounds: bool,
}

/// A stencil test that is on, for one side of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawStencilFace {
    /// How `reference & read` must compare with `stored & read`, and which operations change the stored value.
    pub face: StencilFace,
    /// The reference, and the masks.
    pub masks: FaceMasks,
}

/// The blend state of the first colour target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawBlend {
    /// Blending of `[colour, alpha]`, each absent where wgpu has no equivalent; all absent where the fragment's colour
    /// replaces what is stored.
    pub equations: Option<[Option<BlendComponent>; 2]>,
    /// Whether red, green, blue and alpha are written.
    pub write: [bool; 4],
}

/// Effects of the fragment shader, from its text or code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawFragment {
    /// Whether it discards fragments (`discard`, alpha to coverage, a sample mask of its own).
    pub may_discard: ShaderEffect,
    /// Whether it writes a depth of its own.
    pub writes_depth: ShaderEffect,
}
