//! The fixed-function state of a draw, hashable, built of wgpu's plain value types.

use serde::{Deserialize, Serialize};
use wgpu::{CompareFunction, DepthBiasState, StencilOperation};

/// Tests of one face of the stencil buffer.
pub type StencilFace = wgpu::StencilFaceState;

/// The whole raster state of a draw. Surfaces are never culled unless it says so.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct RasterState {
    /// A fragment passes when `compare(fragment depth, stored depth)` holds.
    pub depth_compare: CompareFunction,
    /// Depths beyond near and far are clamped instead of clipped.
    pub unclipped_depth: bool,
    /// Passing fragments store their depth.
    pub depth_write: bool,
    /// Added to depth before the test.
    pub depth_bias: DepthBiasState,
    /// Functions and operations of each face and the masks; off where
    /// [`wgpu::StencilState::is_enabled`] says so.
    pub stencil: wgpu::StencilState,
    /// The reference of both faces.
    pub stencil_reference: u8,
    /// Faces that are thrown away.
    pub cull: Option<wgpu::Face>,
    /// What passing fragments do to the colour target.
    pub color: ColorWrite,
}

/// What passing fragments do to the colour target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ColorWrite {
    /// Nothing.
    None,
    /// Overwrite it.
    Replace,
    /// Add to it.
    Add,
    /// Multiply with it.
    Multiply,
    /// Keep the smaller of both, channel by channel.
    Minimum,
}

impl RasterState {
    /// Draws surfaces first: nearest wins, both sides, reversed depth.
    #[must_use]
    pub fn surface() -> RasterState {
        RasterState {
            depth_compare: CompareFunction::Greater,
            unclipped_depth: false,
            depth_write: true,
            depth_bias: DepthBiasState::default(),
            stencil: wgpu::StencilState::default(),
            stencil_reference: 0,
            cull: None,
            color: ColorWrite::Replace,
        }
    }

    /// Draws again exactly where a surface is already visible, without changing depth.
    #[must_use]
    pub fn visible_surface(color: ColorWrite) -> RasterState {
        RasterState { depth_compare: CompareFunction::Equal, depth_write: false, color, ..RasterState::surface() }
    }

    /// The same, with both faces of the stencil test as given and masks 0xff.
    #[must_use]
    pub fn with_stencil(self, face: StencilFace, reference: u8) -> RasterState {
        self.with_faces(face, face, reference)
    }

    /// The same, with the two faces of the stencil test as given and masks 0xff.
    #[must_use]
    pub fn with_faces(mut self, front: StencilFace, back: StencilFace, reference: u8) -> RasterState {
        self.stencil = wgpu::StencilState { front, back, read_mask: 0xff, write_mask: 0xff };
        self.stencil_reference = reference;
        self
    }

    /// Turned round for depth where greater is farther: tests and biases change sign.
    #[must_use]
    pub fn for_standard_depth(mut self) -> RasterState {
        self.depth_compare = match self.depth_compare {
            CompareFunction::Greater => CompareFunction::Less,
            CompareFunction::GreaterEqual => CompareFunction::LessEqual,
            CompareFunction::Less => CompareFunction::Greater,
            CompareFunction::LessEqual => CompareFunction::GreaterEqual,
            other => other,
        };
        self.depth_bias.constant = -self.depth_bias.constant;
        self.depth_bias.slope_scale = -self.depth_bias.slope_scale;
        self.depth_bias.clamp = -self.depth_bias.clamp;
        self
    }

    /// Does a fragment that fails a test leave everything as it was?
    #[must_use]
    pub fn acts_only_where_it_passes(&self) -> bool {
        let keeps = |face: &StencilFace| [face.fail_op, face.depth_fail_op] == [StencilOperation::Keep; 2];
        self.stencil.write_mask == 0 || (keeps(&self.stencil.front) && keeps(&self.stencil.back))
    }

    /// Can a draw with this state change the stored stencil?
    #[must_use]
    pub fn writes_stencil(&self) -> bool {
        let writes = |face: &StencilFace| {
            [face.fail_op, face.depth_fail_op, face.pass_op].iter().any(|op| *op != StencilOperation::Keep)
        };
        self.stencil.write_mask != 0 && (writes(&self.stencil.front) || writes(&self.stencil.back))
    }
}
