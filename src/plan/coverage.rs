//! Which triangles of a frame lie over one pixel, from geometry alone.
//!
//! A first sieve passes only triangles that are not wholly on one side of a small square round the pixel's centre: four
//! planes through the eye, so it is valid for corners behind the eye and at infinity too, and for boxes of them
//! (`near_triangles`). The rest is examined in `f64`: seen from the eye, three signed areas say whether the centre is
//! inside (Olano and Greer 1997, "Triangle scan conversion using 2D homogeneous coordinates"), and weigh the corners'
//! depths.
//!
//! A rasterizer rounds corners to parts of a pixel, so near an edge only the GPU can decide. This module says which
//! triangles the GPU must be asked about, which it must cover the pixel with, and which leave no fragment: triangles
//! that are culled, or clipped away at the near or far plane.

use super::near_triangles::PixelSieve;
use super::{ClipPlane, Draw, DrawPart, FramePlan, MeshId, Pass, RasterisedTriangles, ViewId, Viewport};
use glam::{DMat4, DVec2, DVec3, DVec4, Mat4};
use std::collections::BTreeMap;
use std::ops::Range;

/// A triangle is looked at if it reaches within this many pixels of the pixel's centre along either axis.
const DOUBT: f64 = 1.0;
/// The centre is surely covered if it is this many pixels inside of every edge, however corners are rounded.
const SAFE: f64 = 1.0 / 16.0;
/// Depths this near to 0 and 1 may be clipped or not, by rounding.
const SAFE_DEPTH: f64 = 1e-6;

/// A triangle of a draw that covers a pixel's centre, or may.
#[derive(Debug, Clone, PartialEq)]
pub struct Covering {
    /// Index of the pass in the plan.
    pub pass: usize,
    /// Index of the draw in its pass.
    pub draw: usize,
    /// Index among the draw's triangles, in the order in which they are drawn.
    pub primitive: u32,
    /// Index in the triangle list of the draw's mesh; several pieces of one triangle have the same.
    pub triangle: u32,
    /// Index of what the rasteriser is given, the triangle itself or a piece of it, in the triangle list of its mesh;
    /// `None` for a triangle of which it is given nothing here, as it is cut off at an end of depth.
    pub piece: Option<u32>,
    /// The draw's part; for caps that a vertex shader extrudes, which cap this triangle is.
    pub part: DrawPart,
    /// Corners as the draw's mesh has them: homogeneous, relative to the origin of the pass's view.
    pub corners: [[f32; 4]; 3],
    /// Corners of what the rasteriser is given: the triangle itself, or a piece of it; where that is nothing, the
    /// triangle's own.
    pub rasterised: [[f32; 4]; 3],
    /// Whether it leaves a fragment at the pixel, as far as geometry alone can say.
    pub coverage: Coverage,
}

/// Whether a triangle leaves a fragment at a pixel, as far as geometry alone can say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coverage {
    /// It leaves a fragment there.
    Sure,
    /// The pixel's centre is too near to an edge, or the triangle too thin, to decide.
    Doubtful,
    /// It covers the pixel, but the draw culls the side that is seen.
    Culled(VisibleFace),
    /// It covers the pixel, but is clipped there: nearer than the near plane or beyond the far plane.
    Clipped(VisibleFace, ClipPlane),
}

/// The side of a triangle that is seen at a pixel, and its depth there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleFace {
    /// Whether the front is seen, as the draw's front-face order defines it.
    pub is_front: bool,
    /// The depth at the pixel's centre as it would be stored; outside 0 to 1 where it is clipped.
    pub depth: f32,
}

/// A fragment that the GPU, or the CPU's rasteriser, made of a triangle at the pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoggedFragment {
    /// Index of its triangle in the list of [`Covering`]s that was asked about.
    pub covering: usize,
    /// Whether the triangle's front is seen.
    pub is_front: bool,
    /// Depth as the depth test sees it, bias included; not clamped.
    pub depth: f32,
}

/// The log of the fragments at a pixel, in the order in which their triangles were drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FragmentLog {
    /// The fragments that fitted into the log.
    pub fragments: Vec<LoggedFragment>,
    /// The number of fragments that there were, logged or not.
    pub counted: u32,
}

impl FramePlan {
    /// Returns whether a pass draws into the picture, or tests against its depth and stencil: all passes but those of
    /// shadow maps and textures.
    pub fn is_of_picture(&self, pass: &Pass) -> bool {
        let is_map = |id| matches!(self.attachment(id).role, super::AttachmentRole::Map(_));
        let color = pass.color.iter().map(|target| target.attachment);
        let depth = pass.depth_stencil.iter().map(|target| target.attachment);
        !color.chain(depth).any(is_map)
    }

    /// Returns whether the colour target of a pass is a light's float count; false without a colour target.
    pub fn counts_in_float(&self, pass: &Pass) -> bool {
        let role = pass.color.as_ref().map(|target| self.attachment(target.attachment).role);
        matches!(role, Some(super::AttachmentRole::Count(_)))
    }

    /// Returns every triangle that covers the centre of `pixel` or comes within a pixel of it, in the order in which
    /// the GPU draws them. Looks at all passes of the picture (not of maps) whose scissor contains the pixel; culled
    /// and clipped triangles are listed as such.
    pub fn covering(&self, pixel: [u32; 2]) -> Vec<Covering> {
        let mut search = CoverageSearch { plan: self, pixel, found: BTreeMap::new() };
        let mut covering = Vec::new();
        let passes = self.passes.iter().enumerate();
        for (pass_index, pass) in passes.filter(|(_, pass)| self.is_of_picture(pass) && pass.reaches(pixel)) {
            let viewport = pass.viewport(self.size);
            for (draw_index, draw) in pass.draws.iter().enumerate() {
                search.add(pass_index, pass.view, &viewport, draw_index, draw, &mut covering);
            }
        }
        covering
    }
}

/// The key of a search result: mesh, view, viewport, and range of triangles with base vertex. Draws with the same key
/// share the result.
type SearchedMesh = (MeshId, ViewId, [u32; 4], [u32; 3]);

struct CoverageSearch<'a> {
    plan: &'a FramePlan,
    pixel: [u32; 2],
    found: BTreeMap<SearchedMesh, Vec<u32>>,
}

impl CoverageSearch<'_> {
    fn add(
        &mut self,
        pass: usize,
        view: ViewId,
        viewport: &Viewport,
        draw_index: usize,
        draw: &Draw,
        covering: &mut Vec<Covering>,
    ) {
        let square = PixelSquare::new(self.pixel, viewport);
        // Nothing is drawn outside of the viewport.
        if square.inside < -DOUBT {
            return;
        }
        // Another program's vertices are in clip space.
        let matrix = (!draw.program.is_recorded()).then(|| self.plan.views[view.0].clip_from_relative);
        let is_reverse = draw.program.runs_in_reverse();
        let own = draw.own_triangles();
        let is_cut = draw.pieces.as_ref().is_some_and(|pieces| pieces.is_cut_in_depth);
        // Of what was cut off at an end of depth there is no piece: the triangle itself says that it is clipped there.
        let cut = is_cut.then(|| (own.clone(), true));
        let mut found: Vec<Covering> = Vec::new();
        for (triangles, is_cut_off) in std::iter::once((draw.rasterised(), false)).chain(cut) {
            let near = self.near(&triangles, view, viewport, &square, matrix);
            let known = found.len();
            let look = |piece: &u32| {
                let [mesh, whole] = [&triangles, &own].map(|triangles| &self.plan.meshes[triangles.mesh.0]);
                let triangle = mesh.whole(*piece);
                let rasterised = mesh.places(mesh.corners(*piece, triangles.base_vertex)?)?;
                let corners = whole.places(whole.corners(triangle, own.base_vertex)?)?;
                let coverage = self.plan.coverage(draw, viewport, square.look(matrix, rasterised)?);
                let Range { start, end } = own.triangles;
                let primitive = if is_reverse { end - 1 - triangle } else { triangle - start };
                let piece = (!is_cut_off).then_some(*piece);
                let part = draw.part_of(whole, triangle);
                Some(Covering {
                    pass,
                    draw: draw_index,
                    primitive,
                    triangle,
                    piece,
                    part,
                    corners,
                    rasterised,
                    coverage,
                })
            };
            if is_reverse {
                found.extend(near.iter().rev().filter_map(look));
            } else {
                found.extend(near.iter().filter_map(look));
            }
            // Where a piece is near, it says what becomes of the triangle.
            let cut_off = found.split_off(known);
            let has_piece = |one: &Covering| found[..known].iter().any(|other| other.primitive == one.primitive);
            let is_meant = |one: &Covering| matches!(one.coverage, Coverage::Clipped(..)) && !has_piece(one);
            let meant: Vec<Covering> = cut_off.into_iter().filter(|one| !is_cut_off || is_meant(one)).collect();
            found.extend(meant);
        }
        found.sort_by_key(|one| one.primitive);
        covering.append(&mut found);
    }

    /// Returns which of these triangles are near the pixel, by their indices in the mesh.
    fn near(
        &mut self,
        of: &RasterisedTriangles,
        view: ViewId,
        viewport: &Viewport,
        square: &PixelSquare,
        matrix: Option<Mat4>,
    ) -> Vec<u32> {
        let RasterisedTriangles { mesh: id, triangles, base_vertex } = of;
        let mesh = &self.plan.meshes[id.0];
        let area = viewport.area.map(f32::to_bits);
        let searched = (*id, view, area, [triangles.start, triangles.end, *base_vertex]);
        let find = || {
            let sieve = square.sieve(matrix.unwrap_or(Mat4::IDENTITY));
            mesh.boxes.near(&mesh.vertices, &mesh.indices, triangles, *base_vertex, &sieve)
        };
        self.found.entry(searched).or_insert_with(find).clone()
    }
}

impl FramePlan {
    fn coverage(&self, draw: &Draw, viewport: &Viewport, seen: CenterCoverage) -> Coverage {
        let CenterCoverage::Inside { runs_counterclockwise, depth, is_safe } = seen else { return Coverage::Doubtful };
        let is_front = runs_counterclockwise == (draw.raster.front_face == wgpu_types::FrontFace::Ccw);
        let face = VisibleFace { is_front, depth: viewport.stored(depth) as f32 };
        let is_culled = match draw.raster.cull {
            Some(wgpu_types::Face::Front) => face.is_front,
            Some(wgpu_types::Face::Back) => !face.is_front,
            None => false,
        };
        let is_reversed = self.depth.mapping.is_reversed();
        let outside = [(depth < -SAFE_DEPTH, !is_reversed), (depth > 1.0 + SAFE_DEPTH, is_reversed)];
        let clip = outside.into_iter().find(|(is_outside, _)| *is_outside && !draw.raster.unclipped_depth);
        let is_between = (SAFE_DEPTH..=1.0 - SAFE_DEPTH).contains(&depth);
        match clip {
            _ if !is_safe => Coverage::Doubtful,
            Some((_, is_near)) => Coverage::Clipped(face, if is_near { ClipPlane::Near } else { ClipPlane::Far }),
            None if is_culled => Coverage::Culled(face),
            None if is_between || draw.raster.unclipped_depth => Coverage::Sure,
            None => Coverage::Doubtful,
        }
    }
}

/// The square around a pixel's centre, in normalized device coordinates.
struct PixelSquare {
    center: DVec2,
    /// Half of a pixel's width and height.
    half_pixel: DVec2,
    /// How many pixels the centre lies inside of the viewport; negative outside.
    inside: f64,
}

/// Whether a pixel's centre lies inside a triangle.
enum CenterCoverage {
    /// It is inside, with the triangle's depth there in clip space.
    Inside { runs_counterclockwise: bool, depth: f64, is_safe: bool },
    /// It is not inside, but not surely more than [`DOUBT`] pixels away.
    Near,
}

impl PixelSquare {
    fn new(pixel: [u32; 2], viewport: &Viewport) -> PixelSquare {
        let [left, top, width, height] = viewport.area.map(f64::from);
        let size = DVec2::new(width, height);
        let center = (DVec2::new(f64::from(pixel[0]), f64::from(pixel[1])) + 0.5 - DVec2::new(left, top)) / size;
        let inside = (center.min(1.0 - center) * size).min_element();
        PixelSquare { center: DVec2::new(center.x * 2.0 - 1.0, 1.0 - center.y * 2.0), half_pixel: 1.0 / size, inside }
    }

    /// Returns the planes right of, left of, above and below the square, for corners that `clip_from_relative` is to be
    /// applied to.
    fn sieve(&self, clip_from_relative: Mat4) -> PixelSieve {
        let clip = clip_from_relative.as_dmat4();
        let reach = self.half_pixel * (2.0 * DOUBT);
        let [x, y, w] = [clip.row(0), clip.row(1), clip.row(3)];
        let planes = [
            x - w * (self.center.x + reach.x),
            w * (self.center.x - reach.x) - x,
            y - w * (self.center.y + reach.y),
            w * (self.center.y - reach.y) - y,
        ];
        PixelSieve::new(DMat4::from_cols(planes[0], planes[1], planes[2], planes[3]).transpose())
    }

    /// Classifies the pixel's centre against a triangle: inside, with depth and winding, or near. Returns `None` where
    /// the lines through its edges show that it is outside by more than [`DOUBT`] pixels; `Near` may so be farther off.
    /// `corners` are multiplied by `clip_from_relative`, or are in clip space where that is `None`.
    fn look(&self, clip_from_relative: Option<Mat4>, corners: [[f32; 4]; 3]) -> Option<CenterCoverage> {
        let corners = corners.map(|corner| DVec4::from_array(corner.map(f64::from)));
        let clip = clip_from_relative.map_or(corners, |matrix| corners.map(|corner| matrix.as_dmat4() * corner));
        // The centre becomes the axis: a corner on the ray through it has x = y = 0.
        let seen = clip.map(|corner| {
            let offset = (corner.truncate().truncate() - self.center * corner.w) / (2.0 * self.half_pixel);
            DVec3::new(offset.x, offset.y, corner.w)
        });
        let edges = [seen[1].cross(seen[2]), seen[2].cross(seen[0]), seen[0].cross(seen[1])];
        // Pixels from the centre to the line of each edge, positive on one side.
        let distances = edges.map(|edge| edge.z / edge.truncate().length());
        let (least, most) = (
            distances.into_iter().fold(f64::INFINITY, f64::min),
            distances.into_iter().fold(f64::NEG_INFINITY, f64::max),
        );
        if least < -DOUBT && most > DOUBT {
            return None;
        }
        let weights = DVec3::new(edges[0].z, edges[1].z, edges[2].z);
        let sum = weights.element_sum();
        let interpolated = |values: [f64; 3]| weights.dot(DVec3::from_array(values)) / sum;
        let w = interpolated(clip.map(|corner| corner.w));
        let is_inside = (least > 0.0 || most < 0.0) && w > 0.0;
        if !is_inside {
            return Some(CenterCoverage::Near);
        }
        let depth = interpolated(clip.map(|corner| corner.z)) / w;
        let is_safe = (least > SAFE || most < -SAFE) && self.inside > SAFE;
        Some(CenterCoverage::Inside { runs_counterclockwise: sum > 0.0, depth, is_safe })
    }
}
