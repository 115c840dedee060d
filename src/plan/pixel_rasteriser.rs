//! The fragments of one pixel, computed on the CPU: a rasteriser of a single pixel, in the arithmetic of Mesa's software
//! GPU.
//!
//! It makes the log that a GPU makes of the same triangles (`gpu::Executor::log_fragments`): the same faces, and on
//! Mesa's software GPU depths that are equal to the bit for all but one pixel in some thousand. Corners go through the
//! view's matrix, are clipped (Sutherland and Hodgman 1974, "Reentrant polygon clipping"), carried into the window in
//! floats and put on the rasteriser's grid; three edges with the top-left rule say whether the centre is covered, and a
//! plane through the corners how deep. Another GPU's last bits of depth may differ, and its grid may be another. So a
//! stored frame has histories where there is no GPU.

use super::{Covering, FragmentLog, FramePlan, LoggedFragment, RasterState, Viewport};
use glam::Mat4;
use wgpu_types::{DepthBiasState, Face, FrontFace};

/// The planes of clip space as weights of x, y, z and w, in the order in which they cut: the sides, then depth 0 and 1.
const PLANES: [[f32; 4]; 6] = [
    [-1.0, 0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0, 1.0],
    [0.0, -1.0, 0.0, 1.0],
    [0.0, 1.0, 0.0, 1.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0, 1.0],
];
/// How many of them there are without those of depth.
const SIDES: usize = 4;
/// Corners farther out than so many steps of the grid are on no picture; products of two of them still fit.
const MOST_PLACE: f32 = 1e9;

impl FramePlan {
    /// Returns the fragments that triangles leave at the centre of a pixel, as a rasteriser makes them that moves
    /// corners to multiples of 1/`steps` pixel (256 for most GPUs): no test discards any. `covering` has the triangles
    /// to ask about, which [`FramePlan::covering`] finds.
    pub fn fragments(&self, pixel: [u32; 2], covering: &[Covering], steps: u32) -> FragmentLog {
        let fragment = |(index, one): (usize, &Covering)| {
            one.piece?;
            let pass = &self.passes[one.pass];
            let draw = &pass.draws[one.draw];
            // Another program's corners are in clip space already.
            let clip = match draw.program.is_recorded() {
                true => one.rasterised,
                false => one.rasterised.map(|corner| clip_position(self.views[pass.view.0].clip_from_relative, corner)),
            };
            let depths = pass.depth_stencil.as_ref().map(|target| self.attachment(target.attachment));
            let bias = depths.map_or(draw.raster.depth_bias, |depths| depths.rasteriser_bias(draw.raster.depth_bias));
            let target = PixelTarget { pixel, viewport: pass.viewport(self.size), steps: steps as f32, bias };
            let (is_front, depth) = target.fragment(clip, &draw.raster)?;
            Some(LoggedFragment { covering: index, is_front, depth })
        };
        let fragments: Vec<LoggedFragment> = covering.iter().enumerate().filter_map(fragment).collect();
        FragmentLog { counted: fragments.len() as u32, fragments }
    }
}

/// Returns a corner in clip space as a vertex shader computes it: a matrix times a vector adds its columns from the last
/// to the first, each product and each sum rounded, as Mesa's compiler orders it. Another driver's last bits may differ.
fn clip_position(clip_from_relative: Mat4, [x, y, z, w]: [f32; 4]) -> [f32; 4] {
    let sum = clip_from_relative.w_axis * w;
    let sum = clip_from_relative.z_axis * z + sum;
    let sum = clip_from_relative.y_axis * y + sum;
    (clip_from_relative.x_axis * x + sum).to_array()
}

/// A corner of a triangle, or of the part of it that is left after clipping.
#[derive(Debug, Clone, Copy)]
struct ClippedCorner {
    clip: [f32; 4],
    /// Whether clipping has made it.
    is_new: bool,
}

/// A pixel, and how triangles are carried to it.
struct PixelTarget {
    pixel: [u32; 2],
    viewport: Viewport,
    /// Into how many parts the rasteriser's grid divides a pixel.
    steps: f32,
    /// The depth bias that the rasteriser adds.
    bias: DepthBiasState,
}

impl PixelTarget {
    /// Returns whether the front of a triangle is seen at the pixel, and how deep; `None` where it leaves no fragment.
    /// The triangles into which clipping divides it form a fan: at most one of them covers the centre.
    fn fragment(&self, clip: [[f32; 4]; 3], raster: &RasterState) -> Option<(bool, f32)> {
        let corners: Vec<[f32; 3]> =
            clipped(clip, raster.unclipped_depth).into_iter().map(|corner| self.in_window(corner)).collect();
        let (first, rest) = corners.split_first()?;
        let parts = rest.windows(2).map(|pair| [*first, pair[0], pair[1]]);
        let covering = parts.filter_map(|part| Some((self.is_counterclockwise(part)?, part)));
        let (is_counterclockwise, part) = { covering }.next()?;
        let is_front = is_counterclockwise == (raster.front_face == FrontFace::Ccw);
        let is_culled = raster.cull == Some(if is_front { Face::Front } else { Face::Back });
        (!is_culled).then(|| (is_front, self.depth(part, &self.bias)))
    }

    /// Returns x and y in pixels and the depth of a corner, rounded as floats are on their way: of a corner that
    /// clipping has made, products and sums are rounded one by one.
    fn in_window(&self, ClippedCorner { clip: [x, y, z, w], is_new }: ClippedCorner) -> [f32; 3] {
        let Viewport { area: [left, top, width, height], depth: [near, far] } = self.viewport;
        let inverse = 1.0 / w;
        let moved = |value: f32, scale: f32, offset: f32| match is_new {
            true => value * inverse * scale + offset,
            false => (value * inverse).mul_add(scale, offset),
        };
        [
            moved(x, width / 2.0, left + width / 2.0),
            moved(y, -height / 2.0, top + height / 2.0),
            moved(z, far - near, near),
        ]
    }

    /// Returns whether a triangle that covers the pixel's centre is seen counterclockwise; `None` where it does not
    /// cover it or has no area. Rows count downwards.
    fn is_counterclockwise(&self, corners: [[f32; 3]; 3]) -> Option<bool> {
        let on_grid = |place: f32| ((place - 0.5) * self.steps).round_ties_even();
        let corners = corners.map(|[x, y, _]| [on_grid(x), on_grid(y)]);
        // Also false for what is no number. Nothing beyond is left by clipping, but where w is nearly 0.
        if !corners.iter().flatten().all(|place| place.abs() < MOST_PLACE) {
            return None;
        }
        let [a, b, c] = corners.map(|place| place.map(|place| place as i64));
        let [x, y] = self.pixel.map(|place| i64::from(place) * self.steps as i64);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area == 0 {
            return None;
        }
        // A centre on an edge belongs to the triangle whose top or left edge that is.
        let is_inside = |from: [i64; 2], to: [i64; 2]| {
            let [along_x, along_y] = [to[0] - from[0], to[1] - from[1]];
            let side = along_x * (y - from[1]) - along_y * (x - from[0]);
            side > 0 || (side == 0 && (along_y < 0 || (along_y == 0 && along_x > 0)))
        };
        let (second, third) = if area < 0 { (c, b) } else { (b, c) };
        let covers = is_inside(a, second) && is_inside(second, third) && is_inside(third, a);
        covers.then_some(area < 0)
    }

    /// Returns the depth of the plane through a triangle's corners at the pixel's centre, with the draw's bias: units of
    /// the last place of its largest depth, and of its slope.
    fn depth(&self, [a, b, c]: [[f32; 3]; 3], bias: &DepthBiasState) -> f32 {
        let [x, y] = self.pixel.map(|place| place as f32);
        let [from_b, to_c] = [[0, 1, 2].map(|axis| a[axis] - b[axis]), [0, 1, 2].map(|axis| c[axis] - a[axis])];
        let inverse = 1.0 / (from_b[0] * to_c[1] - from_b[1] * to_c[0]);
        let along_x = from_b[2] * (to_c[1] * inverse) - to_c[2] * (from_b[1] * inverse);
        let along_y = to_c[2] * (from_b[0] * inverse) - from_b[2] * (to_c[0] * inverse);
        let largest = a[2].max(b[2]).max(c[2]);
        let last_place = if largest > 0.0 { f64::from(largest).log2().floor() - 23.0 } else { f64::NEG_INFINITY };
        let offset =
            last_place.exp2() as f32 * bias.constant as f32 + along_x.abs().max(along_y.abs()) * bias.slope_scale;
        let offset = match bias.clamp {
            most if most > 0.0 => offset.min(most),
            least if least < 0.0 => offset.max(least),
            _ => offset,
        };
        let back = along_x * (a[0] - 0.5) + along_y * (a[1] - 0.5);
        along_y.mul_add(y, along_x.mul_add(x, (a[2] + offset) - back))
    }
}

/// Returns how far a corner is inside of a plane.
fn inside_of(plane: &[f32; 4], corner: &[f32; 4]) -> f32 {
    plane.iter().zip(corner).fold(0.0, |sum, (weight, value)| sum + weight * value)
}

/// Returns the part of a triangle within clip space's box, as corners in order; with unclipped depth only its sides cut.
fn clipped(triangle: [[f32; 4]; 3], is_unclipped: bool) -> Vec<ClippedCorner> {
    let mut corners: Vec<ClippedCorner> = triangle.map(|clip| ClippedCorner { clip, is_new: false }).into();
    let planes = if is_unclipped { &PLANES[..SIDES] } else { &PLANES[..] };
    for plane in planes.iter().filter(|plane| triangle.iter().any(|corner| inside_of(plane, corner) < 0.0)) {
        let distances: Vec<f32> = corners.iter().map(|corner| inside_of(plane, &corner.clip)).collect();
        let mut left = Vec::with_capacity(corners.len() + 1);
        for (at, corner) in corners.iter().enumerate() {
            let next = (at + 1) % corners.len();
            let (here, there) = (distances[at], distances[next]);
            left.extend((here >= 0.0).then_some(*corner));
            if (here >= 0.0) != (there >= 0.0) {
                left.push(crossing([corner, &corners[next]], [here, there]));
            }
        }
        corners = left;
    }
    corners
}

/// Returns the corner where an edge goes through a plane, made from the end that is nearer to it.
fn crossing(ends: [&ClippedCorner; 2], distances: [f32; 2]) -> ClippedCorner {
    let is_second_nearer = distances[0].abs() > distances[1].abs();
    let [start, end] = if is_second_nearer { [ends[1], ends[0]] } else { ends };
    let from_start = if is_second_nearer { distances[1] } else { -distances[0] };
    let share = from_start / (distances[1] - distances[0]);
    let between = |lane: usize| start.clip[lane] + share * (end.clip[lane] - start.clip[lane]);
    ClippedCorner { clip: [0, 1, 2, 3].map(between), is_new: true }
}
