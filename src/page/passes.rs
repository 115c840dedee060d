//! The passes of a plan in the form that the page's history needs: what follows from programs and states is computed
//! here, so that the page need not know them.

use super::arrays::{ArrayIndex, ArrayLayout, ArrayWord, PageArrays};
use crate::capture::FrameTarget;
use crate::history;
use crate::plan::{
    Draw, DrawPart, FaceMasks, FramePlan, Pass, RasterState, RasterisedTriangles, StartContent, StencilFace, Visibility,
};
use serde::Serialize;

/// A pass of the plan as the page's document has it.
#[derive(Debug, Serialize)]
pub struct PagePass<'a> {
    name: &'a str,
    light: Option<usize>,
    view: usize,
    /// It draws into the picture, or tests against its depth and stencil.
    is_of_picture: bool,
    has_depth: bool,
    target: FrameTarget,
    /// The viewport: left, top, width and height in pixels.
    area: [f32; 4],
    /// The stored depths of clip depth 0 and 1.
    range: [f32; 2],
    scissor: Option<[u32; 4]>,
    /// What its depth and stencil contain as it begins, where that differs from what the previous pass left.
    start: Option<PageStart>,
    clear_depth: Option<f32>,
    clear_stencil: Option<u8>,
    clear_count: Option<f32>,
    /// The largest stored depth, where depths are integers.
    depth_steps: Option<u32>,
    draws: Vec<PageDraw<'a>>,
}

#[derive(Debug, Serialize)]
struct PageStart {
    depth: Option<ArrayIndex>,
    stencil: Option<ArrayIndex>,
}

#[derive(Debug, Serialize)]
struct PageDraw<'a> {
    name: &'a str,
    caster: Option<&'a str>,
    part: DrawPart,
    /// For caps that a vertex shader extrudes, one byte for each triangle: 1 in the dark cap, 0 in the light cap.
    is_dark: Option<ArrayIndex>,
    mesh: usize,
    /// Index of the first triangle and of the one after the last.
    triangles: [u32; 2],
    base_vertex: u32,
    /// Triangles are drawn from the last to the first.
    is_reverse: bool,
    faces_inwards: bool,
    raster: &'a RasterState,
    /// The stencil state of front faces and of back faces.
    sides: [PageStencilFace<'a>; 2],
    tests_stencil: bool,
    /// Its shader discards what is nearer than the near plane, and what is beyond the far plane.
    discards: [bool; 2],
    /// What decides how much light arrives, where it adds the light.
    lights: Option<Visibility>,
    /// What front and back faces add to a float count.
    adds: [f32; 2],
}

#[derive(Debug, Serialize)]
struct PageStencilFace<'a> {
    #[serde(flatten)]
    face: &'a StencilFace,
    #[serde(flatten)]
    masks: FaceMasks,
}

/// Returns the passes of a plan for the page's document; their meshes and pictures are added to `arrays`.
pub fn passes<'a>(plan: &'a FramePlan, arrays: &mut PageArrays) -> Vec<PagePass<'a>> {
    plan.passes.iter().map(|pass| entry(plan, pass, arrays)).collect()
}

fn entry<'a>(plan: &'a FramePlan, pass: &'a Pass, arrays: &mut PageArrays) -> PagePass<'a> {
    let viewport = pass.viewport(plan.size);
    let target = pass.depth_stencil.as_ref();
    let clear_count = pass.color.as_ref().filter(|_| plan.counts_in_float(pass)).and_then(|color| color.clear);
    let start = pass.recorded.as_ref().and_then(|recorded| recorded.start.as_ref());
    PagePass {
        name: &pass.name,
        light: pass.light.map(|light| light.0),
        view: pass.view.0,
        is_of_picture: plan.is_of_picture(pass),
        has_depth: target.is_some(),
        target: history::target_of(plan, pass),
        area: viewport.area,
        range: viewport.depth,
        scissor: pass.scissor,
        start: start.map(|start| store_start(start, plan.size[0], arrays)),
        clear_depth: target.and_then(|target| target.clear_depth),
        clear_stencil: target.and_then(|target| target.clear_stencil),
        clear_count: clear_count.map(|clear| clear[0] as f32),
        depth_steps: target.and_then(|target| plan.attachment(target.attachment).depth_steps()),
        draws: pass.draws.iter().map(|one| draw(plan, one, arrays)).collect(),
    }
}

fn store_start(StartContent { depth, stencil }: &StartContent, width: u32, arrays: &mut PageArrays) -> PageStart {
    let mut add = |word, bytes: &[u8]| arrays.add(ArrayLayout { word, lanes: 1, width: width as usize }, bytes);
    let depth = depth.as_ref().map(|depth| add(ArrayWord::F32, depth.bytes()));
    PageStart { depth, stencil: stencil.as_ref().map(|stencil| add(ArrayWord::U8, stencil.bytes())) }
}

fn draw<'a>(plan: &FramePlan, draw: &'a Draw, arrays: &mut PageArrays) -> PageDraw<'a> {
    let side = |is_front| {
        let (face, masks) = draw.raster.face(is_front);
        PageStencilFace { face, masks }
    };
    let RasterisedTriangles { mesh, triangles, base_vertex } = draw.rasterised();
    PageDraw {
        name: &draw.name,
        caster: draw.caster.as_deref(),
        part: draw.part,
        is_dark: (draw.part == DrawPart::Caps).then(|| dark_caps(plan, draw, arrays)),
        mesh: mesh.0,
        triangles: [triangles.start, triangles.end],
        base_vertex,
        is_reverse: draw.program.runs_in_reverse(),
        faces_inwards: draw.faces_inwards,
        raster: &draw.raster,
        sides: [true, false].map(side),
        tests_stencil: draw.raster.stencil.is_enabled(),
        // Any depths outside the range, one on either side.
        discards: [-1.0, 2.0].map(|depth| draw.program.discards(depth).is_some()),
        lights: history::asks(draw),
        adds: [true, false].map(|is_front| history::count_of(draw, is_front)),
    }
}

/// Adds a byte for each triangle of a draw, 1 where it is in the dark cap and otherwise 0, and returns the array's
/// index.
fn dark_caps(plan: &FramePlan, draw: &Draw, arrays: &mut PageArrays) -> ArrayIndex {
    let mesh = &plan.meshes[draw.mesh.0];
    let RasterisedTriangles { mesh: pieces, triangles, .. } = draw.rasterised();
    let whole = |piece| plan.meshes[pieces.0].whole(piece);
    let is_dark = |piece| u8::from(draw.part_of(mesh, whole(piece)) == DrawPart::DarkCap);
    let dark: Vec<u8> = triangles.map(is_dark).collect();
    arrays.add(ArrayLayout { word: ArrayWord::U8, lanes: 1, width: 0 }, &dark)
}
