//! A draw's whole raster state in the words of WebGPU, OpenGL and Direct3D 12, and as a sentence.
//!
//! The three name the same functions; where they differ, each line is what one would write in that API. In WebGPU the
//! stencil's reference and masks apply to both faces; OpenGL and Direct3D get them for each face, equal unless another
//! program had others.

mod defaults;

pub use defaults::defaults;

use super::{ColorWrite, FaceMasks, Pass, RasterState, StencilFace};
use std::fmt;
use wgpu_types::{CompareFunction, StencilOperation};

named_enum! {
    /// The API in whose terms a raster state is written out.
    #[derive(Default)]
    pub enum RasterApi {
        /// A WebGPU pipeline descriptor.
        #[default]
        WebGpu = "WebGPU",
        /// OpenGL 4.5 calls.
        OpenGl = "OpenGL",
        /// Direct3D 12 descriptions.
        Direct3D = "Direct3D 12",
    }
}

/// Writes a raster state as lines of code for `api`, in the order depth, stencil, raster, colour.
pub fn lines(raster: &RasterState, api: RasterApi) -> Vec<String> {
    match api {
        RasterApi::WebGpu => web_gpu(raster),
        RasterApi::OpenGl => open_gl(raster),
        RasterApi::Direct3D => direct3d(raster),
    }
}

/// Describes what a fragment of a draw does, in a sentence each for depth, stencil (two where the faces differ, none
/// where it is off) and colour.
pub fn sentences(raster: &RasterState, pass: &Pass) -> Vec<String> {
    let mut said = Vec::new();
    if pass.depth_stencil.is_some() {
        let passes = match raster.depth_compare {
            CompareFunction::Always => "Every fragment passes the depth test".to_owned(),
            CompareFunction::Never => "No fragment passes the depth test".to_owned(),
            compare => {
                format!("A fragment passes the depth test where its depth is {} the stored one", relation(compare))
            }
        };
        let stores = if raster.depth_write { "and stores its depth" } else { "and leaves the stored depth as it is" };
        said.push(format!("{passes}, {stores}."));
    } else {
        said.push("There is no depth and no stencil buffer in this pass.".to_owned());
    }
    said.extend(stencil_sentences(raster));
    said.push(
        match raster.color {
            ColorWrite::None => "No colour is written.",
            ColorWrite::Replace => "Its colour takes the place of what was there.",
            ColorWrite::Add => "Its colour is added to what was there.",
            ColorWrite::Multiply => "What was there is multiplied by its colour.",
            ColorWrite::Minimum => "The smaller of both colours stays, channel by channel.",
            ColorWrite::Blend => "Its colour is blended with what was there.",
        }
        .to_owned(),
    );
    said
}

/// Describes what a fragment of a draw does to the stencil: in one sentence, in two where the faces differ, in none where it
/// is off.
pub fn stencil_sentences(raster: &RasterState) -> Vec<String> {
    if !raster.stencil.is_enabled() {
        return Vec::new();
    }
    let [front, back] = [true, false].map(|is_front| face_sentence(raster, is_front));
    if front == back {
        vec![format!("Stencil, both faces: {front}.")]
    } else {
        vec![format!("Stencil, front faces: {front}."), format!("Stencil, back faces: {back}.")]
    }
}

fn relation(compare: CompareFunction) -> &'static str {
    match compare {
        CompareFunction::Never => "never like",
        CompareFunction::Less => "less than",
        CompareFunction::Equal => "equal to",
        CompareFunction::LessEqual => "at most",
        CompareFunction::Greater => "greater than",
        CompareFunction::NotEqual => "other than",
        CompareFunction::GreaterEqual => "at least",
        CompareFunction::Always => "anything beside",
    }
}

fn face_sentence(raster: &RasterState, is_front: bool) -> String {
    let (face, masks) = raster.face(is_front);
    let test = match face.compare {
        CompareFunction::Always => "its test always passes".to_owned(),
        CompareFunction::Never => "its test never passes".to_owned(),
        compare => {
            let mask = if masks.read == 0xff { String::new() } else { format!(" (bits {:#04x})", masks.read) };
            format!("it passes where {} is {} the stored count{mask}", masks.reference, relation(compare))
        }
    };
    let acts: Vec<String> = [
        ("a fragment that fails it", face.fail_op),
        ("one that fails the depth test", face.depth_fail_op),
        ("one that passes both", face.pass_op),
    ]
    .into_iter()
    .filter(|(_, op)| *op != StencilOperation::Keep && masks.write != 0)
    .map(|(who, op)| format!("{who} {}", operation(op, masks.reference)))
    .collect();
    if acts.is_empty() { format!("{test}; nothing changes it") } else { format!("{test}; {}", acts.join("; ")) }
}

fn operation(op: StencilOperation, reference: u8) -> String {
    match op {
        StencilOperation::Keep => "keeps the count".to_owned(),
        StencilOperation::Zero => "sets it to 0".to_owned(),
        StencilOperation::Replace => format!("sets it to {reference}"),
        StencilOperation::Invert => "inverts its bits".to_owned(),
        StencilOperation::IncrementClamp => "adds 1, up to 255".to_owned(),
        StencilOperation::DecrementClamp => "takes 1 away, down to 0".to_owned(),
        StencilOperation::IncrementWrap => "adds 1 (255 becomes 0)".to_owned(),
        StencilOperation::DecrementWrap => "takes 1 away (0 becomes 255)".to_owned(),
    }
}

/// Returns a name in camel case as lower-case words joined by `between`: `DecrementWrap` as `decrement-wrap`.
pub(crate) fn spelled(name: impl fmt::Debug, between: char) -> String {
    let mut words = String::new();
    for letter in format!("{name:?}").chars() {
        if letter.is_uppercase() && !words.is_empty() {
            words.push(between);
        }
        words.extend(letter.to_lowercase());
    }
    words
}

fn web_gpu(raster: &RasterState) -> Vec<String> {
    let compare = |compare: CompareFunction| format!("\"{}\"", spelled(compare, '-'));
    let operation = |operation: StencilOperation| format!("\"{}\"", spelled(operation, '-'));
    let stencil = &raster.stencil;
    let face = |name: &str, face: &StencilFace| {
        format!(
            "{name}: {{ compare: {}, failOp: {}, depthFailOp: {}, passOp: {} }},",
            compare(face.compare),
            operation(face.fail_op),
            operation(face.depth_fail_op),
            operation(face.pass_op)
        )
    };
    let mut lines = vec![
        format!("depthCompare: {},", compare(raster.depth_compare)),
        format!("depthWriteEnabled: {},", raster.depth_write),
        format!("depthBias: {},", raster.depth_bias.constant),
        format!("depthBiasSlopeScale: {},", raster.depth_bias.slope_scale),
        face("stencilFront", &stencil.front),
        face("stencilBack", &stencil.back),
        format!("stencilReadMask: {:#04x},", stencil.read_mask & 0xff),
        format!("stencilWriteMask: {:#04x},", stencil.write_mask & 0xff),
        format!("pass.setStencilReference({});", raster.stencil_reference),
        format!("cullMode: \"{}\",", raster.cull.map_or("none".to_owned(), |face| format!("{face:?}").to_lowercase())),
        format!("frontFace: \"{}\",", spelled(raster.front_face, '-')),
        format!("unclippedDepth: {},", raster.unclipped_depth),
    ];
    let blend = |src: &str, dst: &str, op: &str| {
        format!("blend: {{ color: {{ srcFactor: \"{src}\", dstFactor: \"{dst}\", operation: \"{op}\" }} }},")
    };
    lines.push(match raster.color {
        ColorWrite::None => "writeMask: 0,".to_owned(),
        ColorWrite::Replace => "blend: undefined,".to_owned(),
        ColorWrite::Add => blend("one", "one", "add"),
        ColorWrite::Multiply => blend("dst", "zero", "add"),
        ColorWrite::Minimum => blend("one", "one", "min"),
        ColorWrite::Blend => "blend: another program's,".to_owned(),
    });
    lines
}

/// Returns a stencil operation's names in OpenGL and Direct3D, in this order and without prefix: `INCR_WRAP` and
/// `INCR`.
fn operation_in(op: StencilOperation) -> [&'static str; 2] {
    match op {
        StencilOperation::IncrementClamp => ["INCR", "INCR_SAT"],
        StencilOperation::DecrementClamp => ["DECR", "DECR_SAT"],
        StencilOperation::IncrementWrap => ["INCR_WRAP", "INCR"],
        StencilOperation::DecrementWrap => ["DECR_WRAP", "DECR"],
        StencilOperation::Keep => ["KEEP"; 2],
        StencilOperation::Zero => ["ZERO"; 2],
        StencilOperation::Replace => ["REPLACE"; 2],
        StencilOperation::Invert => ["INVERT"; 2],
    }
}

fn open_gl(raster: &RasterState) -> Vec<String> {
    let compare = |compare: CompareFunction| {
        let name = match compare {
            CompareFunction::LessEqual => "LEQUAL",
            CompareFunction::GreaterEqual => "GEQUAL",
            CompareFunction::NotEqual => "NOTEQUAL",
            other => return format!("GL_{}", format!("{other:?}").to_uppercase()),
        };
        format!("GL_{name}")
    };
    let operation = |op| format!("GL_{}", operation_in(op)[0]);
    let on = |is_on: bool, what: &str| format!("{}({what});", if is_on { "glEnable" } else { "glDisable" });
    let stencil = &raster.stencil;
    let mut lines = vec![
        "glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);".to_owned(),
        "glEnable(GL_DEPTH_TEST);".to_owned(),
        format!("glDepthFunc({});", compare(raster.depth_compare)),
        format!("glDepthMask({});", if raster.depth_write { "GL_TRUE" } else { "GL_FALSE" }),
    ];
    let has_bias = raster.depth_bias != wgpu_types::DepthBiasState::default();
    lines.push(on(has_bias, "GL_POLYGON_OFFSET_FILL"));
    if has_bias {
        lines.push(format!("glPolygonOffset({}, {});", raster.depth_bias.slope_scale, raster.depth_bias.constant));
    }
    lines.push(on(raster.unclipped_depth, "GL_DEPTH_CLAMP"));
    lines.push(on(stencil.is_enabled(), "GL_STENCIL_TEST"));
    if stencil.is_enabled() {
        for (name, is_front) in [("GL_FRONT", true), ("GL_BACK", false)] {
            let (face, FaceMasks { reference, read, write }) = raster.face(is_front);
            lines.push(format!("glStencilFuncSeparate({name}, {}, {reference}, {read:#04x});", compare(face.compare)));
            if raster.back.is_some() {
                lines.push(format!("glStencilMaskSeparate({name}, {write:#04x});"));
            }
            let ops = [face.fail_op, face.depth_fail_op, face.pass_op].map(operation);
            lines.push(format!("glStencilOpSeparate({name}, {}, {}, {});", ops[0], ops[1], ops[2]));
        }
        if raster.back.is_none() {
            lines.push(format!("glStencilMask({:#04x});", stencil.write_mask & 0xff));
        }
    }
    lines.push(on(raster.cull.is_some(), "GL_CULL_FACE"));
    if let Some(face) = raster.cull {
        lines.push(format!("glCullFace(GL_{});", format!("{face:?}").to_uppercase()));
    }
    lines.push(format!("glFrontFace(GL_{});", format!("{:?}", raster.front_face).to_uppercase()));
    match raster.color {
        ColorWrite::None => lines.push("glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);".to_owned()),
        ColorWrite::Replace => lines.push("glDisable(GL_BLEND);".to_owned()),
        ColorWrite::Add => {
            lines.extend(["glEnable(GL_BLEND);".to_owned(), "glBlendFunc(GL_ONE, GL_ONE);".to_owned()]);
        }
        ColorWrite::Multiply => {
            lines.extend(["glEnable(GL_BLEND);".to_owned(), "glBlendFunc(GL_DST_COLOR, GL_ZERO);".to_owned()]);
        }
        ColorWrite::Minimum => {
            lines.extend(["glEnable(GL_BLEND);".to_owned(), "glBlendEquation(GL_MIN);".to_owned()]);
        }
        ColorWrite::Blend => lines.push("glEnable(GL_BLEND);".to_owned()),
    }
    lines
}

fn direct3d(raster: &RasterState) -> Vec<String> {
    let compare = |compare: CompareFunction| format!("D3D12_COMPARISON_FUNC_{}", spelled(compare, '_').to_uppercase());
    let operation = |op| format!("D3D12_STENCIL_OP_{}", operation_in(op)[1]);
    let truth = |is: bool| if is { "TRUE" } else { "FALSE" };
    let stencil = &raster.stencil;
    let mask = if raster.depth_write { "ALL" } else { "ZERO" };
    let mut lines = vec![
        format!("DepthFunc = {};", compare(raster.depth_compare)),
        format!("DepthWriteMask = D3D12_DEPTH_WRITE_MASK_{mask};"),
        format!("DepthBias = {};", raster.depth_bias.constant),
        format!("SlopeScaledDepthBias = {:?};", raster.depth_bias.slope_scale),
        format!("DepthClipEnable = {};", truth(!raster.unclipped_depth)),
        format!("StencilEnable = {};", truth(stencil.is_enabled())),
    ];
    if stencil.is_enabled() {
        for (name, face) in [("FrontFace", &stencil.front), ("BackFace", &stencil.back)] {
            lines.push(format!("{name}.StencilFunc = {};", compare(face.compare)));
            lines.push(format!("{name}.StencilFailOp = {};", operation(face.fail_op)));
            lines.push(format!("{name}.StencilDepthFailOp = {};", operation(face.depth_fail_op)));
            lines.push(format!("{name}.StencilPassOp = {};", operation(face.pass_op)));
        }
        lines.push(format!("StencilReadMask = {:#04x};", stencil.read_mask & 0xff));
        lines.push(format!("StencilWriteMask = {:#04x};", stencil.write_mask & 0xff));
        lines.push(format!("list->OMSetStencilRef({});", raster.stencil_reference));
    }
    let cull = raster.cull.map_or("NONE".to_owned(), |face| format!("{face:?}").to_uppercase());
    lines.push(format!("CullMode = D3D12_CULL_MODE_{cull};"));
    lines.push(format!("FrontCounterClockwise = {};", truth(raster.front_face == wgpu_types::FrontFace::Ccw)));
    let blend = |src: &str, dst: &str, op: &str| {
        [
            "BlendEnable = TRUE;".to_owned(),
            format!("SrcBlend = D3D12_BLEND_{src};"),
            format!("DestBlend = D3D12_BLEND_{dst};"),
            format!("BlendOp = D3D12_BLEND_OP_{op};"),
        ]
    };
    match raster.color {
        ColorWrite::None => lines.push("RenderTargetWriteMask = 0;".to_owned()),
        ColorWrite::Replace => lines.push("BlendEnable = FALSE;".to_owned()),
        ColorWrite::Add => lines.extend(blend("ONE", "ONE", "ADD")),
        ColorWrite::Multiply => lines.extend(blend("DEST_COLOR", "ZERO", "ADD")),
        ColorWrite::Minimum => lines.extend(blend("ONE", "ONE", "MIN")),
        ColorWrite::Blend => lines.push("BlendEnable = TRUE;".to_owned()),
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The state of z-fail's volumes: a hidden back face adds 1, a hidden front face subtracts 1.
    fn z_fail() -> RasterState {
        let face = |depth_fail_op| StencilFace {
            compare: CompareFunction::Always,
            fail_op: StencilOperation::Keep,
            depth_fail_op,
            pass_op: StencilOperation::Keep,
        };
        let state = RasterState { depth_write: false, color: ColorWrite::None, ..RasterState::surface() };
        state.with_faces(face(StencilOperation::DecrementWrap), face(StencilOperation::IncrementWrap), 0)
    }

    fn has(api: RasterApi, line: &str) {
        let lines = lines(&z_fail(), api);
        assert!(lines.iter().any(|one| one == line), "{line} is missing in {lines:#?}");
    }

    #[test]
    fn each_api_is_reported_the_same_in_its_own_words() {
        has(RasterApi::WebGpu, "depthCompare: \"greater\",");
        has(
            RasterApi::WebGpu,
            "stencilBack: { compare: \"always\", failOp: \"keep\", depthFailOp: \"increment-wrap\", passOp: \"keep\" },",
        );
        has(RasterApi::OpenGl, "glDepthMask(GL_FALSE);");
        has(RasterApi::OpenGl, "glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_DECR_WRAP, GL_KEEP);");
        has(RasterApi::OpenGl, "glStencilFuncSeparate(GL_BACK, GL_ALWAYS, 0, 0xff);");
        has(RasterApi::Direct3D, "BackFace.StencilDepthFailOp = D3D12_STENCIL_OP_INCR;");
        has(RasterApi::Direct3D, "DepthFunc = D3D12_COMPARISON_FUNC_GREATER;");
        has(RasterApi::Direct3D, "list->OMSetStencilRef(0);");
    }

    #[test]
    fn comparisons_of_two_words_are_spelled_as_each_api_spells_them() {
        let state = RasterState { depth_compare: CompareFunction::LessEqual, ..RasterState::surface() };
        let first =
            |api: RasterApi| lines(&state, api).into_iter().find(|line| line.contains("epth")).unwrap_or_default();
        assert_eq!(first(RasterApi::WebGpu), "depthCompare: \"less-equal\",");
        assert_eq!(lines(&state, RasterApi::OpenGl)[2], "glDepthFunc(GL_LEQUAL);");
        assert_eq!(first(RasterApi::Direct3D), "DepthFunc = D3D12_COMPARISON_FUNC_LESS_EQUAL;");
    }

    #[test]
    fn faces_that_do_the_same_are_reported_once() {
        let face = face_sentence(&z_fail(), false);
        assert_eq!(face, "its test always passes; one that fails the depth test adds 1 (255 becomes 0)");
        let light = RasterState::visible_surface(ColorWrite::Add)
            .with_stencil(StencilFace { compare: CompareFunction::Equal, ..StencilFace::IGNORE }, 0);
        assert_eq!(face_sentence(&light, true), "it passes where 0 is equal to the stored count; nothing changes it");
    }
}
