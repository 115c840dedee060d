//! A frame as RenderDoc tells it: plain data, with no interpretation beyond units and orientation.
//!
//! Every API comes out the same way round: row 0 of a picture is at the top, viewport and scissor count pixels
//! from there, and "counter-clockwise" is what the eye sees on that picture. States are wgpu's, as far as wgpu has them.

use crate::capture::Image;
use crate::plan::{FaceMasks, ShaderEffect, StencilFace};
use std::ops::Range;
use std::sync::Arc;
use wgpu::{BlendComponent, CompareFunction, PolygonMode};

named_enum! {
    /// Whose calls were recorded.
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

/// One frame of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct RawFrame {
    /// Whose calls were recorded.
    pub api: RecordedApi,
    /// The GPU that replayed the frame, in the driver's words; empty where it has none.
    pub adapter: String,
    /// Who recorded it: `RenderDoc 1.24`.
    pub recorder: String,
    /// The program that drew it, where that is known.
    pub program: Option<String>,
    /// The frame's textures; a [`RawTarget`] points here.
    pub textures: Vec<RawTexture>,
    /// What each target holds before its first event: its first picture of colour or depth, each target once.
    pub before: Vec<(RawTarget, RawContents)>,
    /// What the frame does, in order.
    pub events: Vec<RawEvent>,
    /// What could not be read, in words; each once.
    pub limits: Vec<String>,
}

/// A texture, renderbuffer or swapchain image.
#[derive(Debug, Clone, PartialEq)]
pub struct RawTexture {
    /// As the program or RenderDoc calls it.
    pub name: String,
    /// What a texel is.
    pub format: RawFormat,
    /// Texels of the largest level, width and height.
    pub size: [u32; 2],
    /// Layers, or six a cube, or the depth of a volume.
    pub layers: u32,
    /// Samples a texel; 1 where it is not multisampled.
    pub samples: u32,
}

/// What a texel is.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum RawFormat {
    /// Depth in 16 bits, normalised.
    D16,
    /// Depth in 24 bits, normalised.
    D24,
    /// Depth in 24 bits, normalised, and stencil in 8.
    D24S8,
    /// Depth as a float. An OpenGL driver may keep 32 normalised bits under this name.
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
    /// Another one, by RenderDoc's name.
    Other(String),
}

impl RawFormat {
    /// The largest depth where depth is stored as an integer: 2^bits − 1.
    pub fn largest_depth(&self) -> Option<u32> {
        match self {
            RawFormat::D16 => Some(0xffff),
            RawFormat::D24 | RawFormat::D24S8 => Some(0xff_ffff),
            _ => None,
        }
    }

    /// Does a texel have depth?
    pub fn has_depth(&self) -> bool {
        self.largest_depth().is_some() || matches!(self, RawFormat::D32F | RawFormat::D32FS8)
    }

    /// Does a texel have stencil?
    pub fn has_stencil(&self) -> bool {
        matches!(self, RawFormat::D24S8 | RawFormat::D32FS8 | RawFormat::S8)
    }
}

/// A level of a layer of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RawTarget {
    /// Index into [`RawFrame::textures`].
    pub texture: usize,
    /// The level; 0 is the largest.
    pub mip: u32,
    /// The layer or face.
    pub layer: u32,
}

/// Pictures of a target: each has exactly its width times its height texels, row 0 at the top. Rows that are as they
/// were in the last picture of the target are in its memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RawContents {
    /// Depth as the buffer has it, 0 to 1; an integer divided by the largest of its format, which tells each apart.
    pub depth: Option<Arc<Image>>,
    /// Stencil.
    pub stencil: Option<Arc<Image>>,
    /// Colour for the eye: four bytes a texel. Formats of eight bits as they are; floats cut to 0 to 1 and
    /// encoded as sRGB.
    pub color: Option<Arc<Image>>,
}

impl RawContents {
    /// These, and of another what these lack.
    #[must_use]
    pub fn or(self, other: RawContents) -> RawContents {
        let RawContents { depth, stencil, color } = other;
        RawContents { depth: self.depth.or(depth), stencil: self.stencil.or(stencil), color: self.color.or(color) }
    }
}

/// One thing that the frame does.
#[derive(Debug, Clone, PartialEq)]
pub struct RawEvent {
    /// RenderDoc's number of the event.
    pub id: u32,
    /// The call, as RenderDoc writes it.
    pub name: String,
    /// Debug groups that it is in, outermost first.
    pub groups: Vec<String>,
    /// What it does.
    pub kind: RawKind,
    /// What it may draw into, in the order of the shader's outputs; of a copy: where it goes.
    pub color_targets: Vec<RawTarget>,
    /// Its depth and stencil; of a copy: where it goes.
    pub depth_target: Option<RawTarget>,
    /// What the first colour target and the depth target hold afterwards. A picture that can't be had is absent:
    /// multisampled targets, formats that are not read.
    pub after: RawContents,
}

/// What an event does.
#[derive(Debug, Clone, PartialEq)]
pub enum RawKind {
    /// Draws triangles, or something else that has none.
    Draw(Box<RawDraw>),
    /// Clears targets, within scissor and write masks.
    Clear {
        /// Colour is cleared.
        color: bool,
        /// Depth is cleared.
        depth: bool,
        /// Stencil is cleared.
        stencil: bool,
    },
    /// A render pass begins: its targets are loaded or cleared.
    BeginPass,
    /// A render pass ends.
    EndPass,
    /// Copies, resolves or blits into a target, or makes its smaller levels.
    Copy,
    /// Compute work.
    Compute,
    /// The picture is shown.
    Present,
}

/// A draw call.
#[derive(Debug, Clone, PartialEq)]
pub struct RawDraw {
    /// What the last vertex stage put together.
    pub topology: RawTopology,
    /// Clip-space positions after the last vertex stage, of all instances; NaN and infinity as they come.
    pub positions: Vec<[f32; 4]>,
    /// Indices into `positions`, all of them within, in the order drawn. Strips and fans are taken apart, each triangle with the winding
    /// that the API gives it. Empty for points and lines.
    pub triangles: Vec<[u32; 3]>,
    /// The triangles of each instance, one range after the other.
    pub instances: Vec<Range<usize>>,
    /// Where the pixels are, and what a clip-space position means.
    pub view: RawView,
    /// Which triangles make fragments, and how deep they are.
    pub shape: RawShape,
    /// The depth test; absent where it is off or nothing holds depth: then all pass, and nothing is written.
    pub depth: Option<RawDepth>,
    /// The stencil test, `[front, back]`; absent where it is off or nothing holds stencil.
    pub stencil: Option<[RawStencilFace; 2]>,
    /// How the first colour target is written; absent where there is none.
    pub blend: Option<RawBlend>,
    /// What the fragment shader may do.
    pub fragment: RawFragment,
    /// The fragments that it has not discarded, where they were noted: column and row of the pixel, and the triangle.
    pub retained: Option<Vec<([u16; 2], u32)>>,
    /// Samples of the targets.
    pub samples: u32,
}

named_enum! {
    /// How vertices make primitives.
    pub enum RawTopology {
        /// Points.
        Points = "points",
        /// Lines of any kind.
        Lines = "lines",
        /// Three corners a triangle.
        TriangleList = "triangle-list",
        /// Each corner makes a triangle with the two before it.
        TriangleStrip = "triangle-strip",
        /// Each corner makes a triangle with the one before it and the first.
        TriangleFan = "triangle-fan",
        /// As a list, with a corner across each edge.
        TriangleListAdjacency = "triangle-list-adjacency",
        /// As a strip, with a corner across each edge.
        TriangleStripAdjacency = "triangle-strip-adjacency",
        /// Patches, or unknown.
        Other = "other",
    }
}

/// Where clip space lands.
///
/// A corner (x, y, z, w) is at column `left + (1 + x/w)·width/2` and row `top + (1 − y/w)·height/2`, or
/// `top + (1 + y/w)·height/2` where `y_up` is false. Its depth is `near + (far − near)·d`, d = z/w or (z/w + 1)/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawView {
    /// Left, top, width and height in pixels, from the top left of the picture; neither side is negative.
    pub viewport: [f32; 4],
    /// The depths of near and far; near may be the larger one.
    pub depth_range: [f32; 2],
    /// Left, top, width and height in pixels of what may be drawn; absent where all may.
    pub scissor: Option<[i32; 4]>,
    /// Does y point up on the picture?
    pub y_up: bool,
    /// Does clip space begin at −w, not at 0?
    pub z_from_minus_w: bool,
}

named_enum! {
    /// Which faces are left out.
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

/// Which triangles make fragments, and how deep they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawShape {
    /// Which faces are left out.
    pub cull: RawCull,
    /// Are triangles that turn counter-clockwise, as seen on the picture, front faces?
    pub front_is_counter_clockwise: bool,
    /// How a triangle is filled.
    pub fill: PolygonMode,
    /// Depth bias: in units of the smallest step, per slope, and the limit of both (0: none).
    pub bias: [f32; 3],
    /// Is depth brought into the depth range?
    pub depth_clamp: bool,
    /// Is cut off what lies before near or behind far?
    pub depth_clip: bool,
    /// Does the program cut by planes of its own (`gl_ClipDistance`)?
    pub clip_planes: bool,
}

/// A depth test that is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawDepth {
    /// Passes where the fragment's depth compares so with the stored one.
    pub compare: CompareFunction,
    /// Is the depth of what passes stored?
    pub write: bool,
    /// Is the stored depth also held against bounds (which are not told)?
    pub bounds: bool,
}

/// A stencil test that is on, for one side of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawStencilFace {
    /// How `reference & read` must compare with `stored & read`, and what becomes of the stored value.
    pub face: StencilFace,
    /// The reference, and the masks.
    pub masks: FaceMasks,
}

/// How the first colour target is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawBlend {
    /// Blending of `[colour, alpha]`, each absent where wgpu has no word for it; all absent where the fragment's colour
    /// replaces what is there.
    pub equations: Option<[Option<BlendComponent>; 2]>,
    /// Red, green, blue and alpha: which are written.
    pub write: [bool; 4],
}

/// What the fragment shader may do, as its text or code says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawFragment {
    /// It drops fragments (`discard`, alpha to coverage, a sample mask of its own).
    pub may_discard: ShaderEffect,
    /// It makes a depth of its own.
    pub writes_depth: ShaderEffect,
}
