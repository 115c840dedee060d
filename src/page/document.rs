//! The data of a page, as JSON: the files of its capture folder, packed, and the names, numbers and colours that its
//! pictures need before a question is asked.

use super::arrays::PageFile;
use super::error::PageError;
use crate::capture::disk::{self, FolderContents};
use crate::capture::{Capture, Timing};
use crate::picture::colors;
use crate::plan::{DecidedBy, FramePlan};
use crate::reading::depth::DepthMeasure;
use crate::reading::{layers, steps};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
struct PageDocument<'a> {
    schema: u32,
    clear_depth: f32,
    is_reversed: bool,
    /// For each pass its number, from 1; null for a pass that is not part of the frame.
    numbers: Vec<Option<usize>>,
    lights: Vec<PageLight>,
    palette: PagePalette,
    /// The frame's address in a live window; absent where the page has no link to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<&'a str>,
    /// What the page shows at first, as its fragment has it; absent where it begins with the first pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    opens: Option<&'a str>,
    /// The files of the capture folder, by name.
    files: BTreeMap<String, PageFile>,
}

#[derive(Serialize)]
struct PageLight {
    name: String,
    faces: Vec<PageMapFace>,
}

#[derive(Serialize)]
struct PageMapFace {
    name: String,
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

/// Returns the page's JSON document of a frame, with its address in a live window where there is one, and what it opens
/// at, if that is not the first pass.
pub fn json(capture: &Capture, plan: &FramePlan, live: Option<&str>, opens: Option<&str>) -> Result<String, PageError> {
    let mapping = capture.depth.mapping;
    let document = PageDocument {
        schema: 2,
        clear_depth: mapping.clear_depth(),
        is_reversed: mapping.is_reversed(),
        numbers: (0..capture.steps.len()).map(|index| steps::number(capture, index)).collect(),
        lights: (0..capture.lights.len()).map(|light| light_entry(capture, light)).collect(),
        palette: PagePalette {
            stencil: (0..=255).map(colors::stencil).collect(),
            labels: (0..4).map(colors::label).collect(),
            findings: (0..6).map(colors::finding).collect(),
            linear: (0..=255).map(|byte| colors::linear([byte; 3])[0]).collect(),
        },
        live,
        opens,
        files: files(capture, plan)?,
    };
    Ok(serde_json::to_string(&document)?)
}

/// Returns the files of the frame without what differs from run to run, the same times among it, and without the plan
/// as text.
fn files(capture: &Capture, plan: &FramePlan) -> Result<BTreeMap<String, PageFile>, PageError> {
    let mut timeless = Capture { timing: Timing::default(), plan_text: String::new(), ..capture.clone() };
    for step in &mut timeless.steps {
        step.gpu_ms = None;
    }
    // Only where a shadow map is read is it asked how surfaces are shaded.
    let reads_map = (0..capture.lights.len()).any(|light| capture.decided_by(light) == DecidedBy::Map);
    let plan = if reads_map { plan } else { &plan.without_shading() };
    let contents = FolderContents { capture: &timeless, plan: Some(plan), scene: None };
    let mut files = BTreeMap::new();
    disk::write_each(contents, &mut |name, bytes| drop(files.insert(name, PageFile::pack(&bytes))))?;
    Ok(files)
}

fn light_entry(capture: &Capture, light: usize) -> PageLight {
    let face = |(index, layer): (usize, layers::MapLayer)| PageMapFace {
        name: layer.full_name,
        measure: DepthMeasure::of_map(capture, light, index).and_then(measure),
    };
    PageLight {
        name: crate::numbers::light(light),
        faces: layers::layers(capture, light).into_iter().enumerate().map(face).collect(),
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
