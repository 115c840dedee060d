//! `frame.json`, as the script writes it: names and numbers, not yet checked.

use serde::Deserialize;

/// The version of the document's format that the script for RenderDoc writes; others are refused.
pub const FORMAT: u32 = 1;

/// The whole document that the script writes of a frame.
#[derive(Debug, Deserialize)]
pub struct RenderDocDocument {
    pub format: u32,
    pub recorder: String,
    pub api: String,
    pub adapter: String,
    pub textures: Vec<RenderDocTexture>,
    pub before: Vec<RenderDocStart>,
    pub events: Vec<RenderDocEvent>,
    pub limits: Vec<String>,
    pub blobs: Vec<RenderDocBlob>,
}

/// Where a byte string of RenderDoc's document is stored.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub enum RenderDocBlob {
    /// Offset in `data.bin`, number of compressed bytes there, number of bytes.
    Stored([u64; 3]),
    /// Other byte strings, one after the other.
    Joined { pieces: Vec<usize> },
}

/// A texture, renderbuffer or swapchain image of the document.
#[derive(Debug, Deserialize)]
pub struct RenderDocTexture {
    pub name: String,
    pub format: String,
    pub size: [u32; 2],
    pub layers: u32,
    pub mips: u32,
    pub samples: u32,
}

/// A mip level and layer of a texture that is drawn into.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct RenderDocTarget {
    pub texture: usize,
    pub mip: u32,
    pub layer: u32,
}

/// The content of a target as the frame begins.
#[derive(Debug, Deserialize)]
pub struct RenderDocStart {
    pub target: RenderDocTarget,
    pub contents: Option<usize>,
}

/// An event of the frame: a draw, a clear, or another call.
#[derive(Debug, Deserialize)]
pub struct RenderDocEvent {
    pub id: u32,
    pub name: String,
    pub groups: Vec<String>,
    pub kind: String,
    pub colors: Vec<Option<RenderDocTarget>>,
    pub depth: Option<RenderDocTarget>,
    pub color_after: Option<usize>,
    pub depth_after: Option<usize>,
    /// What each layer of the depth target's texture holds afterwards, from the target's own on, where the event may change
    /// any of them: the target has all layers. Empty otherwise, and in recordings of earlier versions.
    #[serde(default)]
    pub layers_after: Vec<Option<usize>>,
    /// Whether colour is cleared; whether depth or stencil is.
    pub clears: [bool; 2],
    pub draw: Option<RenderDocDraw>,
}

/// The geometry and the states of a draw.
#[derive(Debug, Deserialize)]
pub struct RenderDocDraw {
    pub stencil_test: bool,
    pub depth_test: bool,
    pub depth_write: bool,
    pub depth_bounds: bool,
    pub depth_clamp: bool,
    pub depth_clip: bool,
    pub bias: [f32; 3],
    pub alpha_to_coverage: bool,
    pub discards_all: bool,
    pub negative_one_to_one: bool,
    pub origin_lower_left: bool,
    pub clip_planes: bool,
    pub front: RenderDocStencilFace,
    pub back: RenderDocStencilFace,
    pub depth_compare: String,
    pub cull: String,
    pub front_ccw: bool,
    pub fill: String,
    pub viewport: [f32; 4],
    pub depth_range: [f32; 2],
    pub scissor: Option<[i64; 4]>,
    pub instances: Vec<RenderDocInstance>,
    /// Why there are no instances, in words.
    pub why: String,
    pub blend: Option<RenderDocBlend>,
    pub shader: Option<RenderDocShader>,
    /// Where in each vertex the layer of the target is that its triangle is drawn into, in bytes; none where vertices have
    /// no layer, and in recordings of earlier versions.
    #[serde(default)]
    pub layer_at: Option<u64>,
    /// The textures that the fragment shader may sample; none in recordings of earlier versions, which do not say.
    #[serde(default)]
    pub samples: Option<Vec<usize>>,
}

/// The stencil state of one side of triangles.
#[derive(Debug, Deserialize)]
pub struct RenderDocStencilFace {
    pub fail: String,
    pub depth_fail: String,
    pub pass: String,
    pub compare: String,
    pub reference: u32,
    pub compare_mask: u32,
    pub write_mask: u32,
}

/// The vertices of one instance of a draw after the vertex shader.
#[derive(Debug, Deserialize)]
pub struct RenderDocInstance {
    pub topology: String,
    pub count: u64,
    pub vertices: usize,
    pub stride: u64,
    pub indices: Option<usize>,
    pub index_stride: u64,
    pub base_vertex: i64,
    pub restart: Option<u32>,
}

/// The blend state of the first colour target.
#[derive(Debug, Deserialize)]
pub struct RenderDocBlend {
    pub enabled: bool,
    pub color: RenderDocBlendEquation,
    pub alpha: RenderDocBlendEquation,
    pub write_mask: u32,
    pub logic: bool,
}

/// The blend factors and operation of colour or alpha.
#[derive(Debug, Deserialize)]
pub struct RenderDocBlendEquation {
    pub source: String,
    pub target: String,
    pub operation: String,
}

/// The fragment shader of a draw.
#[derive(Debug, Deserialize)]
pub struct RenderDocShader {
    pub encoding: String,
    pub bytes: usize,
}
