//! The default state of each API, in lines as [`super::lines`] writes them: a line that is not among them was set.

use super::RasterApi;

/// Lines for the defaults of a WebGPU pipeline descriptor. It has no default for depthCompare and depthWriteEnabled:
/// where there is a depth format, both are required.
const WEB_GPU: &[&str] = &[
    "depthBias: 0,",
    "depthBiasSlopeScale: 0,",
    "stencilFront: { compare: \"always\", failOp: \"keep\", depthFailOp: \"keep\", passOp: \"keep\" },",
    "stencilBack: { compare: \"always\", failOp: \"keep\", depthFailOp: \"keep\", passOp: \"keep\" },",
    "stencilReadMask: 0xff,",
    "stencilWriteMask: 0xff,",
    "pass.setStencilReference(0);",
    "cullMode: \"none\",",
    "frontFace: \"ccw\",",
    "unclippedDepth: false,",
    "blend: undefined,",
];

/// Lines for the state of a new OpenGL context.
const OPEN_GL: &[&str] = &[
    "glDepthFunc(GL_LESS);",
    "glDepthMask(GL_TRUE);",
    "glDisable(GL_POLYGON_OFFSET_FILL);",
    "glDisable(GL_DEPTH_CLAMP);",
    "glDisable(GL_STENCIL_TEST);",
    "glStencilFuncSeparate(GL_FRONT, GL_ALWAYS, 0, 0xff);",
    "glStencilFuncSeparate(GL_BACK, GL_ALWAYS, 0, 0xff);",
    "glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_KEEP);",
    "glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_KEEP);",
    "glStencilMaskSeparate(GL_FRONT, 0xff);",
    "glStencilMaskSeparate(GL_BACK, 0xff);",
    "glStencilMask(0xff);",
    "glDisable(GL_CULL_FACE);",
    "glCullFace(GL_BACK);",
    "glFrontFace(GL_CCW);",
    "glDisable(GL_BLEND);",
];

/// Lines for the values of `D3D12_DEFAULT` in `d3dx12.h`, and of a command list that was just reset.
const DIRECT_3D: &[&str] = &[
    "DepthFunc = D3D12_COMPARISON_FUNC_LESS;",
    "DepthWriteMask = D3D12_DEPTH_WRITE_MASK_ALL;",
    "DepthBias = 0;",
    "SlopeScaledDepthBias = 0.0;",
    "DepthClipEnable = TRUE;",
    "StencilEnable = FALSE;",
    "FrontFace.StencilFunc = D3D12_COMPARISON_FUNC_ALWAYS;",
    "FrontFace.StencilFailOp = D3D12_STENCIL_OP_KEEP;",
    "FrontFace.StencilDepthFailOp = D3D12_STENCIL_OP_KEEP;",
    "FrontFace.StencilPassOp = D3D12_STENCIL_OP_KEEP;",
    "BackFace.StencilFunc = D3D12_COMPARISON_FUNC_ALWAYS;",
    "BackFace.StencilFailOp = D3D12_STENCIL_OP_KEEP;",
    "BackFace.StencilDepthFailOp = D3D12_STENCIL_OP_KEEP;",
    "BackFace.StencilPassOp = D3D12_STENCIL_OP_KEEP;",
    "StencilReadMask = 0xff;",
    "StencilWriteMask = 0xff;",
    "list->OMSetStencilRef(0);",
    "CullMode = D3D12_CULL_MODE_BACK;",
    "FrontCounterClockwise = FALSE;",
    "BlendEnable = FALSE;",
];

/// Returns the lines of [`lines`](super::lines) that state the API's defaults, and so need not be written in code.
pub fn defaults(api: RasterApi) -> &'static [&'static str] {
    match api {
        RasterApi::WebGpu => WEB_GPU,
        RasterApi::OpenGl => OPEN_GL,
        RasterApi::Direct3D => DIRECT_3D,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FaceMasks, RasterState, StencilFace, lines};
    use super::*;
    use crate::plan::ColorWrite;
    use wgpu_types::{CompareFunction, Face, FrontFace, StencilOperation};

    /// All states between which a default can change.
    fn states() -> Vec<RasterState> {
        let surface = RasterState { depth_compare: CompareFunction::Less, ..RasterState::surface() };
        let marks = StencilFace { pass_op: StencilOperation::Replace, ..StencilFace::IGNORE };
        let masks = FaceMasks { reference: 0, read: 0xff, write: 0xff };
        let flipped = RasterState { front_face: FrontFace::Cw, cull: Some(Face::Back), ..surface.clone() };
        let [front, back] = [[marks, StencilFace::IGNORE], [StencilFace::IGNORE, marks]]
            .map(|[front, back]| surface.clone().with_faces(front, back, 0));
        let apart = RasterState { back: Some(masks), ..front.clone() };
        let blends = RasterState { color: ColorWrite::Add, ..surface.clone() };
        vec![surface, flipped, front, back, apart, blends]
    }

    #[test]
    fn each_default_is_a_line_that_is_written_and_its_opposite_is_none() {
        for api in RasterApi::ALL {
            let written: Vec<String> = states().iter().flat_map(|state| lines(state, api)).collect();
            for line in defaults(api) {
                assert!(written.iter().any(|one| one == line), "{}: {line} is never written", api.name());
            }
            let opposite = RasterState {
                depth_compare: CompareFunction::Greater,
                unclipped_depth: true,
                depth_write: false,
                depth_bias: wgpu_types::DepthBiasState { constant: 3, slope_scale: 2.0, clamp: 0.0 },
                front_face: if api == RasterApi::Direct3D { FrontFace::Ccw } else { FrontFace::Cw },
                cull: Some(Face::Front),
                color: ColorWrite::Multiply,
                ..RasterState::surface()
            };
            let face = StencilFace {
                compare: CompareFunction::Equal,
                fail_op: StencilOperation::Zero,
                depth_fail_op: StencilOperation::Invert,
                pass_op: StencilOperation::Replace,
            };
            let mut opposite = opposite.with_faces(face, face, 7);
            (opposite.stencil.read_mask, opposite.stencil.write_mask) = (0x0f, 0x70);
            for line in lines(&opposite, api) {
                assert!(!defaults(api).contains(&line.as_str()), "{}: {line}", api.name());
            }
        }
    }
}
