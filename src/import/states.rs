//! Fixed-function state, normalised for every API.

use super::document::{RenderDocBlend, RenderDocBlendEquation, RenderDocDraw, RenderDocStencilFace};
use super::raw::{RawBlend, RawCull, RawDepth, RawFormat, RawShape, RawStencilFace, RawView};
use crate::plan::{FaceMasks, StencilFace};
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, CompareFunction, PolygonMode, StencilOperation};

/// The raster states of a draw in RenderDoc's document.
#[derive(Debug)]
pub struct DrawStates {
    pub view: RawView,
    pub shape: RawShape,
    pub depth: Option<RawDepth>,
    pub stencil: Option<[RawStencilFace; 2]>,
    pub blend: Option<RawBlend>,
}

/// Where the first of several samples lies in a pixel, from its left and from the edge of the row that is stored before it,
/// by their number: what Vulkan calls its standard sample locations, and Mesa's OpenGL has, too.
const FIRST_SAMPLES: [(u32, [f32; 2]); 4] =
    [(2, [0.75, 0.75]), (4, [0.375, 0.125]), (8, [0.5625, 0.3125]), (16, [0.5625, 0.5625])];

/// Reads the states of a draw into a target that is so many pixels high and has so many samples a pixel, with depth and
/// stencil of `format`.
///
/// # Errors
/// A name that is not known, in words.
pub fn read(
    draw: &RenderDocDraw,
    is_gl: bool,
    [height, samples]: [u32; 2],
    format: Option<&RawFormat>,
    has_color: bool,
) -> Result<DrawStates, String> {
    let has_depth = format.is_some_and(RawFormat::has_depth);
    let has_stencil = format.is_some_and(RawFormat::has_stencil);
    let depth = RawDepth { compare: compare(&draw.depth_compare)?, write: draw.depth_write, bounds: draw.depth_bounds };
    let stencil = [face(&draw.front)?, face(&draw.back)?];
    Ok(DrawStates {
        view: view(draw, is_gl, height, first_sample(samples)),
        shape: shape(draw, is_gl)?,
        depth: (draw.depth_test && has_depth).then_some(depth),
        stencil: (draw.stencil_test && has_stencil).then_some(stencil),
        blend: draw.blend.as_ref().filter(|_| has_color).map(blend),
    })
}

/// Returns where the first sample lies in a pixel; its middle where there is one sample, or an unusual number of them.
fn first_sample(samples: u32) -> [f32; 2] {
    FIRST_SAMPLES.iter().find(|(count, _)| *count == samples).map_or([0.5; 2], |(_, at)| *at)
}

/// Normalises viewport and scissor: OpenGL counts rows from the bottom; Vulkan from the top, with y down unless the
/// viewport's height is negative. The viewport is moved so that `sample`, a place in a pixel, comes to the pixel's middle.
fn view(draw: &RenderDocDraw, is_gl: bool, height: u32, sample: [f32; 2]) -> RawView {
    let [left, y, width, tall] = draw.viewport;
    let [low, high] = [y.min(y + tall), y.max(y + tall)];
    let scissor = draw.scissor.map(|[left, y, width, tall]| {
        let top = if is_gl { i64::from(height).saturating_sub(y.saturating_add(tall)) } else { y };
        [left, top, width, tall].map(|value| value.clamp(i32::MIN.into(), i32::MAX.into()) as i32)
    });
    let sample = if is_gl { [sample[0], 1.0 - sample[1]] } else { sample };
    let (left, top) = (left + 0.5 - sample[0], if is_gl { height as f32 - high } else { low } + 0.5 - sample[1]);
    RawView {
        viewport: [left, top, width, high - low],
        depth_range: draw.depth_range,
        scissor,
        y_up: if is_gl { draw.origin_lower_left } else { tall < 0.0 },
        z_from_minus_w: draw.negative_one_to_one,
    }
}

/// Normalises the front face: OpenGL decides it by the winding in clip space, which is reversed on the picture where
/// its y points down; Vulkan by the winding on the picture.
fn shape(draw: &RenderDocDraw, is_gl: bool) -> Result<RawShape, String> {
    let cull = match draw.cull.as_str() {
        _ if draw.discards_all => RawCull::Both,
        "NoCull" => RawCull::None,
        "Front" => RawCull::Front,
        "Back" => RawCull::Back,
        "FrontAndBack" => RawCull::Both,
        other => return Err(unknown("culling", other)),
    };
    let fill = match draw.fill.as_str() {
        "Solid" => PolygonMode::Fill,
        "Wireframe" => PolygonMode::Line,
        "Point" => PolygonMode::Point,
        other => return Err(unknown("filling", other)),
    };
    Ok(RawShape {
        cull,
        front_is_counter_clockwise: draw.front_ccw != (is_gl && !draw.origin_lower_left),
        fill,
        bias: draw.bias,
        depth_clamp: draw.depth_clamp,
        depth_clip: draw.depth_clip,
        clip_planes: draw.clip_planes,
    })
}

fn face(face: &RenderDocStencilFace) -> Result<RawStencilFace, String> {
    Ok(RawStencilFace {
        face: StencilFace {
            compare: compare(&face.compare)?,
            fail_op: operation(&face.fail)?,
            depth_fail_op: operation(&face.depth_fail)?,
            pass_op: operation(&face.pass)?,
        },
        masks: FaceMasks {
            reference: face.reference.min(255) as u8,
            read: face.compare_mask as u8,
            write: face.write_mask as u8,
        },
    })
}

fn blend(blend: &RenderDocBlend) -> RawBlend {
    RawBlend {
        equations: blend.enabled.then(|| [equation(&blend.color), equation(&blend.alpha)]),
        write: [1, 2, 4, 8].map(|bit| blend.write_mask & bit != 0),
    }
}

/// Returns a blend equation in wgpu's terms (factors one for minimum and maximum, which ignore them); `None` where wgpu
/// has no equivalent.
fn equation(RenderDocBlendEquation { source, target, operation }: &RenderDocBlendEquation) -> Option<BlendComponent> {
    let operation = match operation.as_str() {
        "Add" => BlendOperation::Add,
        "Subtract" => BlendOperation::Subtract,
        "ReversedSubtract" => BlendOperation::ReverseSubtract,
        // These two operations ignore the factors.
        "Minimum" => return Some(BlendComponent { operation: BlendOperation::Min, ..BlendComponent::REPLACE }),
        "Maximum" => return Some(BlendComponent { operation: BlendOperation::Max, ..BlendComponent::REPLACE }),
        _ => return None,
    };
    Some(BlendComponent { src_factor: factor(source)?, dst_factor: factor(target)?, operation })
}

fn factor(name: &str) -> Option<BlendFactor> {
    Some(match name {
        "Zero" => BlendFactor::Zero,
        "One" => BlendFactor::One,
        "SrcCol" => BlendFactor::Src,
        "InvSrcCol" => BlendFactor::OneMinusSrc,
        "SrcAlpha" => BlendFactor::SrcAlpha,
        "InvSrcAlpha" => BlendFactor::OneMinusSrcAlpha,
        "DstCol" => BlendFactor::Dst,
        "InvDstCol" => BlendFactor::OneMinusDst,
        "DstAlpha" => BlendFactor::DstAlpha,
        "InvDstAlpha" => BlendFactor::OneMinusDstAlpha,
        "SrcAlphaSat" => BlendFactor::SrcAlphaSaturated,
        "FactorRGB" => BlendFactor::Constant,
        "InvFactorRGB" => BlendFactor::OneMinusConstant,
        "Src1Col" => BlendFactor::Src1,
        "InvSrc1Col" => BlendFactor::OneMinusSrc1,
        "Src1Alpha" => BlendFactor::Src1Alpha,
        "InvSrc1Alpha" => BlendFactor::OneMinusSrc1Alpha,
        _ => return None,
    })
}

fn compare(name: &str) -> Result<CompareFunction, String> {
    Ok(match name {
        "Never" => CompareFunction::Never,
        "Less" => CompareFunction::Less,
        "LessEqual" => CompareFunction::LessEqual,
        "Equal" => CompareFunction::Equal,
        "GreaterEqual" => CompareFunction::GreaterEqual,
        "Greater" => CompareFunction::Greater,
        "NotEqual" => CompareFunction::NotEqual,
        "AlwaysTrue" => CompareFunction::Always,
        other => return Err(unknown("comparison", other)),
    })
}

fn operation(name: &str) -> Result<StencilOperation, String> {
    Ok(match name {
        "Keep" => StencilOperation::Keep,
        "Zero" => StencilOperation::Zero,
        "Replace" => StencilOperation::Replace,
        "IncSat" => StencilOperation::IncrementClamp,
        "DecSat" => StencilOperation::DecrementClamp,
        "Invert" => StencilOperation::Invert,
        "IncWrap" => StencilOperation::IncrementWrap,
        "DecWrap" => StencilOperation::DecrementWrap,
        other => return Err(unknown("stencil operation", other)),
    })
}

fn unknown(what: &str, name: &str) -> String {
    format!("there is no {what} `{name}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(viewport: [f32; 4], origin_lower_left: bool) -> RenderDocDraw {
        let face = r#"{"fail": "Keep", "depth_fail": "DecWrap", "pass": "Keep", "compare": "Less", "reference": 300,
            "compare_mask": 4294967295, "write_mask": 15}"#;
        let text = format!(
            r#"{{"stencil_test": true, "depth_test": true, "depth_write": true, "depth_bounds": false, "depth_clamp": false,
            "depth_clip": true, "bias": [0, 0, 0], "alpha_to_coverage": false, "discards_all": false,
            "negative_one_to_one": true, "origin_lower_left": {origin_lower_left}, "clip_planes": false, "front": {face},
            "back": {face}, "depth_compare": "Less", "cull": "Back", "front_ccw": true, "fill": "Solid",
            "viewport": {viewport:?}, "depth_range": [0, 1], "scissor": [1, 2, 3, 4], "instances": [], "why": ""}}"#
        );
        serde_json::from_str(&text).expect("a draw")
    }

    #[test]
    fn rows_count_from_the_top() {
        let gl = read(&draw([10.0, 20.0, 30.0, 40.0], true), true, [100, 1], None, false).expect("states");
        assert_eq!(
            (gl.view.viewport, gl.view.scissor, gl.view.y_up),
            ([10.0, 40.0, 30.0, 40.0], Some([1, 94, 3, 4]), true)
        );
        let vulkan = read(&draw([10.0, 60.0, 30.0, -40.0], false), false, [100, 1], None, false).expect("states");
        assert_eq!((vulkan.view.viewport, vulkan.view.y_up), ([10.0, 20.0, 30.0, 40.0], true));
        assert_eq!(vulkan.view.scissor, Some([1, 2, 3, 4]));
        let down = read(&draw([10.0, 20.0, 30.0, 40.0], false), false, [100, 1], None, false).expect("states");
        assert_eq!((down.view.viewport, down.view.y_up), ([10.0, 20.0, 30.0, 40.0], false));
    }

    /// A sample that lies left of and above a pixel's middle comes to it by a move to the right and down.
    #[test]
    fn the_first_of_several_samples_comes_to_the_middle_of_its_pixel() {
        let viewport = |is_gl: bool, samples: u32| {
            let draw = draw([10.0, 20.0, 30.0, 40.0], is_gl);
            read(&draw, is_gl, [100, samples], None, false).expect("states").view.viewport
        };
        assert_eq!(viewport(false, 4), [10.125, 20.375, 30.0, 40.0]);
        assert_eq!(viewport(true, 4), [10.125, 39.625, 30.0, 40.0]);
        assert_eq!([viewport(true, 1), viewport(true, 3)], [[10.0, 40.0, 30.0, 40.0]; 2]);
    }

    #[test]
    fn a_front_face_turns_as_the_picture_shows_it() {
        let turns = |is_gl, lower| {
            let states = read(&draw([0.0; 4], lower), is_gl, [1, 1], None, false).expect("states");
            states.shape.front_is_counter_clockwise
        };
        assert_eq!([turns(true, true), turns(true, false), turns(false, false)], [true, false, true]);
    }

    #[test]
    fn tests_of_what_is_not_there_are_off_and_values_have_eight_bits() {
        let draw = draw([0.0; 4], true);
        let none = read(&draw, true, [1, 1], None, false).expect("states");
        assert!(none.depth.is_none() && none.stencil.is_none() && none.blend.is_none());
        let depth_only = read(&draw, true, [1, 1], Some(&RawFormat::D24), false).expect("states");
        assert!(depth_only.depth.is_some() && depth_only.stencil.is_none());
        let both = read(&draw, true, [1, 1], Some(&RawFormat::D24S8), false).expect("states");
        let [front, _] = both.stencil.expect("a stencil test");
        assert_eq!(front.masks, FaceMasks { reference: 255, read: 255, write: 15 });
    }

    #[test]
    fn a_name_that_is_not_known_is_refused() {
        let mut draw = draw([0.0; 4], true);
        draw.front.pass = "IncTwice".to_owned();
        assert_eq!(
            read(&draw, true, [1, 1], None, false).expect_err("a name"),
            "there is no stencil operation `IncTwice`"
        );
    }
}
