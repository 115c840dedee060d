//! The data of a page, as JSON: the plan, what was captured after each step and draw, and the palette. Arrays are
//! referred to by their index.

use super::arrays::{ArrayIndex, ArrayLayout, ArrayWord, PageArray, PageArrays};
use super::clip::{self, PageMesh};
use super::passes::{self, PagePass};
use super::reads::{self, PageReads};
use crate::capture::{
    AdapterInfo, Capture, DrawSummary, FrameSnapshot, FrameTarget, Image, Origin, PixelFormat, Snapshot,
};
use crate::history;
use crate::math::depth::DepthCurve;
use crate::picture::colors;
use crate::plan::{Attachment, AttachmentRole, CountOf, DecidedBy, DrawPart, FramePlan, LeftOut};
use crate::reading::depth::DepthMeasure;
use crate::reading::{layers, steps};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;

#[derive(Serialize)]
struct PageDocument<'a> {
    schema: u32,
    program: String,
    scene: &'a str,
    technique: &'a str,
    settings: &'a BTreeMap<String, String>,
    size: [u32; 2],
    adapter: &'a AdapterInfo,
    near: f64,
    depth: &'a DepthCurve,
    clear_depth: f32,
    is_reversed: bool,
    origin: Option<&'a Origin>,
    depth_rounding: f32,
    has_stencil: bool,
    passes: Vec<PagePass<'a>>,
    meshes: Vec<Option<PageMesh>>,
    steps: Vec<PageStep<'a>>,
    lights: Vec<PageLight>,
    left_out: &'a [LeftOut],
    palette: PagePalette,
    arrays: Vec<PageArray>,
}

#[derive(Serialize)]
struct PageStep<'a> {
    name: &'a str,
    /// Counted from 1; null for a step that is not part of the frame.
    number: Option<usize>,
    purpose: &'a str,
    light: Option<usize>,
    after: PageState,
    draws: Vec<PageStepDraw<'a>>,
}

#[derive(Serialize)]
struct PageStepDraw<'a> {
    name: &'a str,
    part: DrawPart,
    triangles: u64,
    /// The state after it; null where it was not captured.
    after: Option<PageState>,
    /// Number of pixels at which another program's draw leaves another result when it is run again.
    differs: Option<u64>,
}

/// What is captured after a step or a draw.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
enum PageState {
    Frame { target: FrameTarget, color: ArrayIndex, depth: ArrayIndex, stencil: Option<ArrayIndex> },
    Map { light: usize, face: usize },
}

#[derive(Serialize)]
struct PageLight {
    name: String,
    decided_by: DecidedBy,
    counts: Option<&'static str>,
    /// Bits of the stencil in which its volumes are counted.
    bits: Option<u32>,
    /// The sentences for a pixel that is lit, and for one in shadow, where its history gives no reason.
    reasons: [&'static str; 2],
    mask: Option<ArrayIndex>,
    count: Option<ArrayIndex>,
    truth: Option<ArrayIndex>,
    findings: Option<ArrayIndex>,
    faces: Vec<PageMapFace>,
    reads: Option<PageReads>,
}

#[derive(Serialize)]
struct PageMapFace {
    name: String,
    size: [u32; 2],
    is_color: bool,
    image: ArrayIndex,
    /// `distance = scale / (depth − offset)`, or `(depth − offset) · scale` where it is linear.
    measure: Option<PageMeasure>,
}

#[derive(Serialize)]
struct PageMeasure {
    scale: f64,
    offset: f64,
    is_linear: bool,
}

/// The colours that the page draws pictures with.
#[derive(Serialize)]
struct PagePalette {
    stencil: Vec<colors::Rgb>,
    labels: Vec<colors::Rgb>,
    findings: Vec<colors::Rgb>,
    linear: Vec<u8>,
}

/// Returns the page's JSON document of a frame: its plan, passes, meshes, lights, colours, and the arrays of its
/// pictures.
pub fn json(capture: &Capture, plan: &Arc<FramePlan>) -> serde_json::Result<String> {
    let mut arrays = PageArrays::default();
    let document = PageDocument {
        schema: 1,
        program: format!("stencilscope {}", env!("CARGO_PKG_VERSION")),
        scene: &capture.scene,
        technique: &capture.technique,
        settings: &capture.settings,
        size: capture.size,
        adapter: &capture.adapter,
        near: capture.camera.near,
        depth: &capture.depth,
        is_reversed: capture.depth.mapping.is_reversed(),
        clear_depth: capture.depth.mapping.clear_depth(),
        origin: capture.origin.as_ref(),
        depth_rounding: depth_rounding(plan),
        steps: (0..capture.steps.len()).map(|index| step(capture, index, &mut arrays)).collect(),
        lights: (0..capture.lights.len()).map(|light| light_entry(capture, plan, light, &mut arrays)).collect(),
        meshes: clip::meshes(plan, &mut arrays),
        passes: passes::passes(plan, &mut arrays),
        has_stencil: has_stencil(plan),
        left_out: &capture.left_out,
        palette: PagePalette {
            stencil: (0..=255).map(colors::stencil).collect(),
            labels: (0..4).map(colors::label).collect(),
            findings: (0..6).map(colors::finding).collect(),
            linear: (0..=255).map(|byte| colors::linear([byte; 3])[0]).collect(),
        },
        arrays: arrays.into_entries(),
    };
    serde_json::to_string(&document)
}

fn has_stencil(plan: &FramePlan) -> bool {
    let is_stencil = |attachment: &Attachment| {
        attachment.role == AttachmentRole::DepthStencil && attachment.format.has_stencil_aspect()
    };
    plan.attachments.iter().any(is_stencil)
}

/// Returns how far depths computed in the browser may differ from the stored ones, as the GPU rounds elsewhere.
fn depth_rounding(plan: &FramePlan) -> f32 {
    let pass = plan.passes.iter().filter(|pass| plan.is_of_picture(pass)).find_map(|pass| pass.depth_stencil.as_ref());
    pass.map_or(0.0, |target| plan.attachment(target.attachment).depth_rounding())
}

fn step<'a>(capture: &'a Capture, index: usize, arrays: &mut PageArrays) -> PageStep<'a> {
    let step = &capture.steps[index];
    let draw = |draw: &'a DrawSummary| PageStepDraw {
        name: &draw.name,
        part: draw.part,
        triangles: draw.triangles,
        after: draw.after.as_ref().map(|after| state(&after.snapshot, arrays)),
        differs: draw.differs.map(|differs| differs.depth + differs.stencil),
    };
    let draws = step.draws.iter().map(draw).collect();
    PageStep {
        name: &step.name,
        number: steps::number(capture, index),
        purpose: &step.purpose,
        light: step.light,
        after: state(&step.snapshot, arrays),
        draws,
    }
}

fn state(snapshot: &Snapshot, arrays: &mut PageArrays) -> PageState {
    match snapshot {
        Snapshot::Map { light, face } => PageState::Map { light: *light, face: *face },
        Snapshot::Frame(FrameSnapshot { color, depth, stencil, target }) => PageState::Frame {
            target: *target,
            color: image(&color.image, arrays),
            depth: image(&depth.image, arrays),
            stencil: stencil.as_ref().map(|stencil| image(&stencil.image, arrays)),
        },
    }
}

fn light_entry(capture: &Capture, plan: &Arc<FramePlan>, light: usize, arrays: &mut PageArrays) -> PageLight {
    let of = &capture.lights[light];
    let faces = of.map.iter().flat_map(|map| &map.faces).zip(layers::layers(capture, light)).enumerate();
    let faces = faces.map(|(index, (face, layer))| PageMapFace {
        name: layer.full_name,
        size: face.size(),
        is_color: face.format() == PixelFormat::Rgba8,
        image: image(face, arrays),
        measure: DepthMeasure::of_map(capture, light, index).and_then(measure),
    });
    PageLight {
        name: crate::numbers::light(light),
        decided_by: of.decided_by,
        counts: of.count_of.map(CountOf::what),
        bits: history::counts_in(plan).get(light).copied().flatten().map(|bits| bits.modulus().unsigned_abs().ilog2()),
        reasons: [false, true].map(|is_dark| history::reason(of.decided_by, is_dark)),
        faces: faces.collect(),
        mask: of.shadow.as_ref().map(|labels| image(labels, arrays)),
        count: of.count.as_ref().map(|count| image(count, arrays)),
        truth: of.truth.as_ref().map(|truth| image(&truth.labels, arrays)),
        findings: of.truth.as_ref().map(|truth| image(&truth.findings, arrays)),
        reads: reads::reads(capture, plan, light, arrays),
    }
}

fn measure(measure: DepthMeasure) -> Option<PageMeasure> {
    match measure {
        DepthMeasure::Raw => None,
        DepthMeasure::Perspective { scale, offset, .. } => Some(PageMeasure { scale, offset, is_linear: false }),
        DepthMeasure::Parallel { near, length, .. } => {
            Some(PageMeasure { scale: length, offset: near, is_linear: true })
        }
    }
}

fn image(image: &Image, arrays: &mut PageArrays) -> ArrayIndex {
    let (word, lanes) = match image.format() {
        PixelFormat::Rgba8Srgb | PixelFormat::Rgba8 => (ArrayWord::U8, 4),
        PixelFormat::Depth32F | PixelFormat::Value32F => (ArrayWord::F32, 1),
        PixelFormat::U8 => (ArrayWord::U8, 1),
    };
    let bytes: Vec<u8> = image.rows().flatten().copied().collect();
    arrays.add(ArrayLayout { word, lanes, width: image.size()[0] as usize }, &bytes)
}
