//! The fixed-function state of a draw, hashable, built of wgpu's plain value types.

use serde::{Deserialize, Serialize};
use wgpu_types::{CompareFunction, DepthBiasState, StencilOperation};

/// The stencil test and operations of one face.
pub type StencilFace = wgpu_types::StencilFaceState;

/// The raster state of a draw: depth, stencil, culling and colour.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct RasterState {
    /// A fragment passes when `compare(fragment depth, stored depth)` is true.
    pub depth_compare: CompareFunction,
    /// Whether depths beyond near and far are clamped instead of clipped.
    pub unclipped_depth: bool,
    /// Whether fragments that pass store their depth.
    pub depth_write: bool,
    /// The depth bias (polygon offset) that is added before the test.
    pub depth_bias: DepthBiasState,
    /// Functions, operations and masks of each face; off where [`wgpu_types::StencilState::is_enabled`] is false.
    pub stencil: wgpu_types::StencilState,
    /// The stencil reference value of both faces, unless `back` has another.
    pub stencil_reference: u8,
    /// Reference and masks of back faces where they differ from the front's, as OpenGL and Vulkan allow; WebGPU needs a
    /// second draw for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back: Option<FaceMasks>,
    /// Which way round a triangle's corners run on the screen where its front is seen.
    pub front_face: wgpu_types::FrontFace,
    /// The faces that are culled; `None` for neither.
    pub cull: Option<wgpu_types::Face>,
    /// The blend operation: what passing fragments do to the colour target.
    pub color: ColorWrite,
}

/// The reference value and the masks of a face's stencil test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct FaceMasks {
    /// The value that stored values are compared with and replaced by.
    pub reference: u8,
    /// Mask of the bits that are compared.
    pub read: u8,
    /// Mask of the bits that may change.
    pub write: u8,
}

/// The blend operation: what passing fragments do to the colour target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ColorWrite {
    /// They leave it as it is.
    None,
    /// They overwrite it.
    Replace,
    /// They are added to it.
    Add,
    /// They are multiplied with it.
    Multiply,
    /// The smaller of both is stored, channel by channel.
    Minimum,
    /// They are blended with it in a way of another program that has no name here.
    Blend,
}

impl RasterState {
    /// Returns the state in which surfaces are drawn first: the nearest fragment wins (reversed depth), both sides are
    /// drawn.
    pub fn surface() -> RasterState {
        RasterState {
            depth_compare: CompareFunction::Greater,
            unclipped_depth: false,
            depth_write: true,
            depth_bias: DepthBiasState::default(),
            stencil: wgpu_types::StencilState::default(),
            stencil_reference: 0,
            back: None,
            front_face: wgpu_types::FrontFace::Ccw,
            cull: None,
            color: ColorWrite::Replace,
        }
    }

    /// Returns the state that draws a surface again exactly where it is visible (depth equal), without changing depth.
    pub fn visible_surface(color: ColorWrite) -> RasterState {
        RasterState { depth_compare: CompareFunction::Equal, depth_write: false, color, ..RasterState::surface() }
    }

    /// Returns this state with `face` as the stencil test of both faces, and all mask bits set.
    #[must_use]
    pub fn with_stencil(self, face: StencilFace, reference: u8) -> RasterState {
        self.with_faces(face, face, reference)
    }

    /// Returns this state with these stencil tests of front and back faces, one reference, and all bits of both masks
    /// set; other masks of back faces are dropped.
    #[must_use]
    pub fn with_faces(mut self, front: StencilFace, back: StencilFace, reference: u8) -> RasterState {
        self.stencil = wgpu_types::StencilState { front, back, read_mask: 0xff, write_mask: 0xff };
        self.stencil_reference = reference;
        self.back = None;
        self
    }

    /// Returns this state with both the read and the write mask of the stencil set to `mask`. Masks of back faces that
    /// differ ([`RasterState::back`]) stay.
    #[must_use]
    pub fn writing(mut self, mask: u8) -> RasterState {
        (self.stencil.read_mask, self.stencil.write_mask) = (mask.into(), mask.into());
        self
    }

    /// Returns this state, meant for reversed depth, for depth where greater is farther: less and greater are
    /// exchanged, and the signs of all biases. Applied twice it is as before.
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
        // Subtracted, as the negative of 0 is written with a sign.
        self.depth_bias.slope_scale = 0.0 - self.depth_bias.slope_scale;
        self.depth_bias.clamp = 0.0 - self.depth_bias.clamp;
        self
    }

    /// Returns the stencil test of front or back faces with its reference and masks: those of both faces, unless back
    /// faces have their own.
    pub fn face(&self, is_front: bool) -> (&StencilFace, FaceMasks) {
        let wgpu_types::StencilState { front, back, read_mask, write_mask } = &self.stencil;
        let shared = FaceMasks { reference: self.stencil_reference, read: *read_mask as u8, write: *write_mask as u8 };
        if is_front { (front, shared) } else { (back, self.back.unwrap_or(shared)) }
    }

    /// Returns states that together do the same and need no [`RasterState::back`]: this one where there is none, else
    /// one for each face that is not culled, which culls the other.
    pub fn by_face(&self) -> Vec<RasterState> {
        let Some(back) = self.back else {
            return vec![RasterState { back: None, ..self.clone() }];
        };
        let mut of_back = RasterState { back: None, stencil_reference: back.reference, ..self.clone() };
        of_back.stencil.read_mask = back.read.into();
        of_back.stencil.write_mask = back.write.into();
        let alone =
            [(wgpu_types::Face::Front, RasterState { back: None, ..self.clone() }), (wgpu_types::Face::Back, of_back)];
        let shown = alone.into_iter().filter(|(face, _)| self.cull != Some(*face));
        let other =
            |face| if face == wgpu_types::Face::Front { wgpu_types::Face::Back } else { wgpu_types::Face::Front };
        shown.map(|(face, state)| RasterState { cull: Some(other(face)), ..state }).collect()
    }

    /// Returns whether a fragment that fails the stencil or the depth test leaves the stencil as it is, for both faces
    /// (a write mask of 0 counts).
    pub fn acts_only_where_it_passes(&self) -> bool {
        let keeps = |(face, masks): (&StencilFace, FaceMasks)| {
            masks.write == 0 || [face.fail_op, face.depth_fail_op] == [StencilOperation::Keep; 2]
        };
        keeps(self.face(true)) && keeps(self.face(false))
    }

    /// Returns whether a draw with this state may change the stencil: a face has a write mask and an operation other
    /// than keep. Culled faces count too.
    pub fn writes_stencil(&self) -> bool {
        let writes = |(face, masks): (&StencilFace, FaceMasks)| {
            masks.write != 0
                && [face.fail_op, face.depth_fail_op, face.pass_op].iter().any(|op| *op != StencilOperation::Keep)
        };
        writes(self.face(true)) || writes(self.face(false))
    }
}
