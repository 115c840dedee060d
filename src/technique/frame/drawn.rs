//! How surfaces are drawn: a shader and its raster state.

use crate::plan::{ColorWrite, Program, RasterState, StencilFace, Visibility};
use crate::truth::{LIT, SHADOW};
use wgpu_types::{CompareFunction, StencilOperation};

/// How a pass draws visible surfaces: shader program, raster state and label.
#[derive(Debug, Clone)]
pub struct SurfaceDrawing {
    pub(super) program: Program,
    pub(super) raster: RasterState,
    /// The label that a label program writes.
    pub(super) label: u32,
}

impl SurfaceDrawing {
    /// Returns a drawing that writes the label "lit" at every visible pixel.
    pub fn lit() -> SurfaceDrawing {
        SurfaceDrawing::label(LIT.into())
    }

    /// Returns a drawing that writes the label "in shadow" at every visible pixel.
    pub fn shadow() -> SurfaceDrawing {
        SurfaceDrawing::label(SHADOW.into())
    }

    /// Returns a drawing that writes the label "in shadow" where less than half of the light arrives, "lit" elsewhere.
    pub fn lit_by(how: Visibility) -> SurfaceDrawing {
        SurfaceDrawing { program: Program::Label(how), ..SurfaceDrawing::label(LIT.into()) }
    }

    fn label(label: u32) -> SurfaceDrawing {
        let raster = RasterState::visible_surface(ColorWrite::Replace);
        SurfaceDrawing { program: Program::Label(Visibility::Everywhere), raster, label }
    }

    /// Returns this drawing limited to pixels where the stencil equals `reference`, both masked by `read_mask`; it
    /// writes no stencil.
    pub fn where_stencil(mut self, read_mask: u32, reference: u8) -> SurfaceDrawing {
        let equal = StencilFace { compare: CompareFunction::Equal, ..StencilFace::IGNORE };
        self.raster = self.raster.with_stencil(equal, reference);
        self.raster.stencil.read_mask = read_mask;
        self.raster.stencil.write_mask = 0;
        self
    }

    /// Returns a drawing that adds the light, without another shadow test, where the stencil masked by `read_mask` is
    /// 0; it increments the stencil there, so that of surfaces at one depth only the first is lit.
    pub fn light_once_where_zero(read_mask: u32) -> SurfaceDrawing {
        let once = StencilFace {
            compare: CompareFunction::Equal,
            pass_op: StencilOperation::IncrementClamp,
            ..StencilFace::IGNORE
        };
        let mut raster = RasterState::visible_surface(ColorWrite::Add).with_stencil(once, 0);
        raster.stencil.read_mask = read_mask;
        SurfaceDrawing { program: Program::Light(Visibility::Everywhere), raster, label: LIT.into() }
    }
}
