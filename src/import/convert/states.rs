//! A draw's states in wgpu's terms, its vertices in wgpu's clip space, and its purpose.
//!
//! wgpu's clip space has y up and z from 0 to w, and its viewport has the smaller depth first: y and z are reversed
//! where the program's are not so. A triangle's winding is recorded as it is seen on the picture, so that stays.

use super::stage::DrawTarget;
use crate::import::raw::{RawBlend, RawCull, RawDepth, RawDraw, RawStencilFace};
use crate::plan::{ColorWrite, CountedSide, RasterState, Viewport};
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, CompareFunction, PolygonMode, StencilOperation};

named_enum! {
    /// The purpose of a run of draws, as its states suggest.
    pub enum DrawRole(
        /// One sentence that explains it to a learner.
        purpose
    ) {
        /// Draws surfaces: depth is written.
        Surfaces = "surfaces" ("Surfaces are drawn, and the nearest leave their depth."),
        /// Counts in the stencil, as shadow volumes do.
        Counts = "volumes" ("Faces add to the stencil or take away from it, as those of shadow volumes do."),
        /// Marks the stencil with a value.
        Marks = "marks" ("The stencil is set to a value where these draws show."),
        /// Draws where the stencil test passes, as a light's pass does.
        Tests = "light" (
            "Draws pass only where the stencil test lets them: this is what a light adds where no shadow is."
        ),
        /// Darkens the picture where the stencil test passes, as a pass of modulative shadows does.
        Darkens = "darkening" (
            "Draws pass only where the stencil test lets them: the picture is lit already, and this takes light away where \
             shadow is."
        ),
        /// Fills a depth map.
        FillsMap = "map" ("Depth alone is drawn into a picture of its own: a shadow map."),
        /// Draws over what is stored.
        Overlays = "overlay" ("Colours are drawn over what is there; no depth is left."),
    }
}

/// Returns the purpose of a draw, derived from its target and states: filling a map, counting volumes (but not a draw
/// that tests the stencil and writes colour), testing, marking, drawing surfaces (writes depth) or overlays. In a stencil
/// that `is_empty` what draws colours and takes away down to 0 counts nothing: such states are left from an earlier draw.
pub(super) fn role(draw: &RawDraw, place: DrawTarget, is_empty: bool) -> DrawRole {
    if matches!(place, DrawTarget::Map(..)) {
        return DrawRole::FillsMap;
    }
    let faces = draw.stencil.as_ref().map_or(&[][..], |faces| &faces[..]);
    let operations = |RawStencilFace { face, .. }: &RawStencilFace| [face.fail_op, face.depth_fail_op, face.pass_op];
    let writing = faces.iter().filter(|face| face.masks.write != 0).flat_map(operations);
    let writes: Vec<StencilOperation> = writing.filter(|op| *op != StencilOperation::Keep).collect();
    let draws = draw.blend.as_ref().is_some_and(|blend| blend.write.contains(&true));
    let is_left_over = is_empty && draws && writes.iter().all(|op| *op == StencilOperation::DecrementClamp);
    let writes = if is_left_over { Vec::new() } else { writes };
    let counts = writes.iter().any(|operation| counts(*operation));
    let tests = |compare: CompareFunction| !matches!(compare, CompareFunction::Always | CompareFunction::Never);
    let tests = faces.iter().any(|face| tests(face.face.compare));
    // A draw that writes colour where a test passes, and counts there so that nothing is drawn twice, is light and no
    // volume.
    let counts = counts && !(tests && draws);
    let writes_depth = draw.depth.is_some_and(|depth| depth.write);
    match (counts, tests, writes.is_empty()) {
        (true, ..) => DrawRole::Counts,
        (false, true, _) => DrawRole::Tests,
        (false, false, false) => DrawRole::Marks,
        (false, false, true) if writes_depth => DrawRole::Surfaces,
        (false, false, true) => DrawRole::Overlays,
    }
}

/// Returns whether a stencil operation increments or decrements, wrapping or clamping; inverting does not count.
fn counts(operation: StencilOperation) -> bool {
    matches!(
        operation,
        StencilOperation::IncrementClamp
            | StencilOperation::IncrementWrap
            | StencilOperation::DecrementClamp
            | StencilOperation::DecrementWrap
    )
}

/// Returns the sides of the surface on which a raster state counts in the stencil: behind it (on depth failure), in
/// front of it (on pass), both in this order, or none.
pub(super) fn counted_sides(raster: &RasterState) -> Vec<CountedSide> {
    let faces = [&raster.stencil.front, &raster.stencil.back];
    let behind = faces.iter().any(|face| counts(face.depth_fail_op)).then_some(CountedSide::Behind);
    let in_front = faces.iter().any(|face| counts(face.pass_op)).then_some(CountedSide::InFront);
    behind.into_iter().chain(in_front).collect()
}

/// Returns which face a draw culls (`None`: neither), if its triangles can be drawn again as they are.
///
/// # Errors
/// Why they can't, in words.
pub(super) fn drawable(draw: &RawDraw) -> Result<Option<wgpu_types::Face>, &'static str> {
    if draw.triangles.is_empty() {
        return Err("it draws points, lines or nothing");
    }
    let [left, top, width, height] = draw.view.viewport;
    if ![left, top, width, height].iter().all(|value| value.is_finite() && value.abs() <= 16384.0)
        || width * height <= 0.0
    {
        return Err("its viewport is empty, or larger than can be");
    }
    if !draw.shape.bias.iter().chain(&draw.view.depth_range).all(|value| value.is_finite()) {
        return Err("its depth bias or depth range is no number");
    }
    if draw.shape.fill != PolygonMode::Fill {
        return Err("its triangles are not filled");
    }
    match draw.shape.cull {
        RawCull::None => Ok(None),
        RawCull::Front => Ok(Some(wgpu_types::Face::Front)),
        RawCull::Back => Ok(Some(wgpu_types::Face::Back)),
        RawCull::Both => Err("it culls both faces"),
    }
}

/// Returns a draw's vertices converted to wgpu's clip space: y up, z from 0 to w, and z mirrored where the depth range
/// is reversed.
pub(super) fn vertices(draw: &RawDraw) -> Vec<[f32; 4]> {
    let is_reversed = draw.view.depth_range[0] > draw.view.depth_range[1];
    let place = |[x, y, z, w]: &[f32; 4]| {
        let y = if draw.view.y_up { *y } else { -y };
        let z = if draw.view.z_from_minus_w { 0.5 * z + 0.5 * w } else { *z };
        [*x, y, if is_reversed { w - z } else { z }, *w]
    };
    draw.positions.iter().map(place).collect()
}

/// Returns the viewport in wgpu's terms, its depth range ascending and clamped to 0 to 1.
pub(super) fn viewport(draw: &RawDraw) -> Viewport {
    let [near, far] = draw.view.depth_range;
    Viewport { area: draw.view.viewport, depth: [near.min(far).clamp(0.0, 1.0), near.max(far).clamp(0.0, 1.0)] }
}

/// Returns the scissor (left, top, columns, rows) within a part of its target, in texels of that part; `None` where all of
/// the part may be drawn. It may have no columns or rows.
pub(super) fn scissor(draw: &RawDraw, part: [u32; 4]) -> Option<[u32; 4]> {
    let [left, top, columns, rows] = draw.view.scissor?.map(i64::from);
    let [first_column, first_row, width, height] = part.map(i64::from);
    let [left, top] = [left - first_column, top - first_row];
    let clamp = |value: i64, most: i64| value.clamp(0, most);
    let [from_x, from_y] = [clamp(left, width), clamp(top, height)];
    let [to_x, to_y] = [clamp(left + columns, width).max(from_x), clamp(top + rows, height).max(from_y)];
    let area = [from_x, from_y, to_x - from_x, to_y - from_y].map(|value| value as u32);
    (area != [0, 0, part[2], part[3]]).then_some(area)
}

/// Returns the raster state of a recorded draw that culls `cull`. Without a depth test everything passes and depth is
/// not written; stencil states are left out where the target has no stencil.
pub(super) fn raster(draw: &RawDraw, cull: Option<wgpu_types::Face>, has_stencil: bool) -> RasterState {
    let shape = &draw.shape;
    let [constant, slope_scale, clamp] = shape.bias;
    let (depth_compare, depth_write) = match draw.depth {
        Some(RawDepth { compare, write, .. }) => (compare, write),
        None => (CompareFunction::Always, false),
    };
    let front_face =
        if shape.front_is_counter_clockwise { wgpu_types::FrontFace::Ccw } else { wgpu_types::FrontFace::Cw };
    let state = RasterState {
        depth_compare,
        unclipped_depth: shape.depth_clamp || !shape.depth_clip,
        depth_write,
        depth_bias: wgpu_types::DepthBiasState { constant: constant.round() as i32, slope_scale, clamp },
        cull,
        front_face,
        color: draw.blend.as_ref().map_or(ColorWrite::None, color),
        ..RasterState::surface()
    };
    let Some([front, back]) = draw.stencil.filter(|_| has_stencil) else { return state };
    let mut state = state.with_faces(front.face, back.face, front.masks.reference);
    state.stencil.read_mask = front.masks.read.into();
    state.stencil.write_mask = front.masks.write.into();
    state.back = Some(back.masks).filter(|of_back| *of_back != front.masks);
    state
}

fn color(blend: &RawBlend) -> ColorWrite {
    if blend.write == [false; 4] {
        return ColorWrite::None;
    }
    let Some([equation, _]) = blend.equations else { return ColorWrite::Replace };
    let Some(BlendComponent { src_factor, dst_factor, operation }) = equation else { return ColorWrite::Blend };
    match (src_factor, dst_factor, operation) {
        (BlendFactor::One, BlendFactor::Zero, BlendOperation::Add) => ColorWrite::Replace,
        (BlendFactor::One, BlendFactor::One, BlendOperation::Add) => ColorWrite::Add,
        (BlendFactor::Dst, BlendFactor::Zero, BlendOperation::Add)
        | (BlendFactor::Zero, BlendFactor::Src, BlendOperation::Add) => ColorWrite::Multiply,
        (_, _, BlendOperation::Min) => ColorWrite::Minimum,
        _ => ColorWrite::Blend,
    }
}

#[cfg(test)]
mod tests {
    use super::DrawRole;
    use crate::plan::RecordedPass;

    #[test]
    fn darkening_passes_are_known_by_their_name() {
        assert_eq!(DrawRole::Darkens.name(), RecordedPass::DARKENING);
    }
}
