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
    /// The reference of both faces, unless `back` has another.
    pub stencil_reference: u8,
    /// What back faces have in place of the front's reference and masks, as OpenGL and Vulkan may; WebGPU draws them
    /// in a draw of their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back: Option<FaceMasks>,
    /// Which way round a triangle's corners run on the screen where its front is seen.
    pub front_face: wgpu::FrontFace,
    /// Faces that are thrown away.
    pub cull: Option<wgpu::Face>,
    /// What passing fragments do to the colour target.
    pub color: ColorWrite,
}

/// The reference and the masks of a face's stencil test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct FaceMasks {
    /// What stored values are compared with, and replaced by.
    pub reference: u8,
    /// Bits that are compared.
    pub read: u8,
    /// Bits that may change.
    pub write: u8,
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
    /// Blend with it in another way, of another program.
    Blend,
}

impl RasterState {
    /// Draws surfaces first: nearest wins, both sides, reversed depth.
    pub fn surface() -> RasterState {
        RasterState {
            depth_compare: CompareFunction::Greater,
            unclipped_depth: false,
            depth_write: true,
            depth_bias: DepthBiasState::default(),
            stencil: wgpu::StencilState::default(),
            stencil_reference: 0,
            back: None,
            front_face: wgpu::FrontFace::Ccw,
            cull: None,
            color: ColorWrite::Replace,
        }
    }

    /// Draws again exactly where a surface is already visible, without changing depth.
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
        self.back = None;
        self
    }

    /// The same, with these bits of the stencil written and no others, and only they are tested.
    #[must_use]
    pub fn writing(mut self, mask: u8) -> RasterState {
        (self.stencil.read_mask, self.stencil.write_mask) = (mask.into(), mask.into());
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

    /// The tests and operations of a face, and its reference and masks.
    pub fn face(&self, is_front: bool) -> (&StencilFace, FaceMasks) {
        let wgpu::StencilState { front, back, read_mask, write_mask } = &self.stencil;
        let shared = FaceMasks { reference: self.stencil_reference, read: *read_mask as u8, write: *write_mask as u8 };
        if is_front { (front, shared) } else { (back, self.back.unwrap_or(shared)) }
    }

    /// As states whose reference and masks hold for both faces: itself, or one of each face.
    pub fn by_face(&self) -> Vec<RasterState> {
        let Some(back) = self.back else {
            return vec![RasterState { back: None, ..self.clone() }];
        };
        let mut of_back = RasterState { back: None, stencil_reference: back.reference, ..self.clone() };
        of_back.stencil.read_mask = back.read.into();
        of_back.stencil.write_mask = back.write.into();
        let alone = [(wgpu::Face::Front, RasterState { back: None, ..self.clone() }), (wgpu::Face::Back, of_back)];
        let shown = alone.into_iter().filter(|(face, _)| self.cull != Some(*face));
        let other = |face| if face == wgpu::Face::Front { wgpu::Face::Back } else { wgpu::Face::Front };
        shown.map(|(face, state)| RasterState { cull: Some(other(face)), ..state }).collect()
    }

    /// Does a fragment that fails a test leave everything as it was?
    pub fn acts_only_where_it_passes(&self) -> bool {
        let keeps = |(face, masks): (&StencilFace, FaceMasks)| {
            masks.write == 0 || [face.fail_op, face.depth_fail_op] == [StencilOperation::Keep; 2]
        };
        keeps(self.face(true)) && keeps(self.face(false))
    }

    /// Can a draw with this state change the stored stencil?
    pub fn writes_stencil(&self) -> bool {
        let writes = |(face, masks): (&StencilFace, FaceMasks)| {
            masks.write != 0
                && [face.fail_op, face.depth_fail_op, face.pass_op].iter().any(|op| *op != StencilOperation::Keep)
        };
        writes(self.face(true)) || writes(self.face(false))
    }
}
