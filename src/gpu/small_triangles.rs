//! Which triangles a rasteriser need not be given, as they cover no pixel's middle.
//!
//! Of a million triangles in a small picture most lie between the middles of pixels: they leave no fragment, whatever
//! tests and shaders a draw has, and their vertices cost as much as others'. So a picture that is replaced soon is drawn
//! without them (Wihlidal 2016, "Optimizing the graphics pipeline with compute"), and is the same to the last bit.
//! What counts a frame's cost, or is looked at draw by draw, is given all triangles.
//!
//! A triangle is left out only where its corners are sure to lie within the view, and no middle of a pixel lies in it or
//! nearer to it than its corners may be moved: by single precision on the way to the window, and to the rasteriser's
//! grid; or where all of them are sure to lie beyond one side of the view, as most do for a face of a cube map.

use crate::last_used::LastUsed;
use crate::plan::{Blob, Draw, DrawMesh, DrawPart, DrawPieces, FramePlan, MeshId, NormalsPer, SurfaceData};
use crate::plan::{SurfaceNormals, Viewport};
use glam::{DVec2, DVec4, Mat4};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Draws of fewer triangles are drawn as they are.
const FEWEST: u32 = 4096;
/// How many vertices or triangles one thread takes at once, at least.
const SHARE: usize = 16 * 1024;
/// How far a vertex shader and the way to the window may be off, as a part of the numbers that they add up: four times
/// what seven roundings to 24 bits sum to.
const ROUNDING: f64 = 1.0 / (1 << 19) as f64;
/// How many middles of pixels are looked at one by one; a triangle over more is drawn.
const MOST_MIDDLES: f32 = 4.0;

/// Which triangles of the newest plan's draws cover a pixel's middle.
#[derive(Debug, Default)]
pub(super) struct SmallTriangles {
    places: LastUsed<PlacesKey, Arc<Vec<Place>>>,
    covering: LastUsed<CoveringKey, Arc<Vec<u32>>>,
}

/// Hash and number of the vertices, the bits of the view's matrix, and those of the viewport's area.
type PlacesKey = (u64, usize, [u32; 16], [u32; 4]);

/// The places, the hash of the indices, the first triangle and the end of the triangles, and what is added to indices.
type CoveringKey = (PlacesKey, u64, [u32; 3]);

/// Where a vertex lies in the window.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Pixels, from the upper left corner of the target.
    at: [f32; 2],
    /// How far the rasteriser may see it from there along either axis, pixels; infinite where it may be clipped.
    doubt: f32,
    /// Beyond which sides of the view it is sure to lie: left, right, bottom, top, a bit each.
    beyond: u8,
}

impl SmallTriangles {
    /// Returns the plan with what the rasteriser is given of large draws: those of their triangles that may cover a pixel's
    /// middle, where corners are moved by at most `step` pixels. `None` where that is all of each.
    pub fn left_out_of(&mut self, plan: &FramePlan, step: f64) -> Option<FramePlan> {
        self.places.next_plan();
        self.covering.next_plan();
        let mut made = BTreeMap::new();
        let mut thinned: Option<FramePlan> = None;
        for (pass_index, pass) in plan.passes.iter().enumerate() {
            let Some(target) = pass.targets().next() else { continue };
            let viewport = pass.viewport(plan.attachment(target).size);
            let clip_from_relative = plan.views[pass.view.0].clip_from_relative;
            for (draw_index, draw) in pass.draws.iter().enumerate() {
                let mesh = &plan.meshes[draw.mesh.0];
                if !is_large(draw, mesh) {
                    continue;
                }
                let covering = self.covering(draw, mesh, clip_from_relative, &viewport, step);
                let triangles = covering.len() as u32;
                if triangles > draw.triangles.len() as u32 / 4 * 3 {
                    continue;
                }
                let thinned = thinned.get_or_insert_with(|| plan.clone());
                let of = (draw.mesh, draw.base_vertex, Arc::as_ptr(&covering));
                let mesh = *made.entry(of).or_insert_with(|| {
                    thinned.meshes.push(some_of(mesh, draw.base_vertex, &covering));
                    MeshId(thinned.meshes.len() - 1)
                });
                thinned.passes[pass_index].draws[draw_index].pieces =
                    Some(DrawPieces { mesh, triangles: 0..triangles, is_cut_in_depth: false });
            }
        }
        thinned
    }

    /// Returns which of a draw's triangles may cover a pixel's middle, by their indices in its mesh.
    fn covering(
        &mut self,
        draw: &Draw,
        mesh: &DrawMesh,
        clip_from_relative: Mat4,
        viewport: &Viewport,
        step: f64,
    ) -> Arc<Vec<u32>> {
        let matrix = clip_from_relative.to_cols_array().map(f32::to_bits);
        let of_places = (mesh.vertices.hash(), mesh.vertices.len(), matrix, viewport.area.map(f32::to_bits));
        let triangles = draw.triangles.clone();
        let key = (of_places, mesh.indices.hash(), [triangles.start, triangles.end, draw.base_vertex]);
        if let Some(known) = self.covering.get(&key) {
            return known;
        }
        let window = Window::new(clip_from_relative, viewport, step);
        let vertices = mesh.vertices.data();
        let place = || vertices.par_iter().with_min_len(SHARE).map(|vertex| window.place(*vertex)).collect();
        let places = self.places.get_or_make(of_places, || Arc::new(place()));
        let covers = |triangle: &u32| {
            let corners = mesh.corners(*triangle, draw.base_vertex);
            corners.is_none_or(|corners| may_cover(corners.map(|vertex| places[vertex as usize])))
        };
        let find = || Arc::new(triangles.into_par_iter().with_min_len(SHARE).filter(covers).collect());
        self.covering.get_or_make(key, find)
    }
}

/// Returns whether a draw has many triangles, of which many may be small, at places that are known here. Sides of volumes
/// are long.
fn is_large(draw: &Draw, mesh: &DrawMesh) -> bool {
    let is_known = mesh.extruded.is_none() && mesh.retained.is_none() && !draw.program.is_recorded();
    is_known && draw.pieces.is_none() && draw.part != DrawPart::Side && draw.triangles.len() as u32 >= FEWEST
}

/// How vertices are carried into a window.
struct Window {
    /// The rows of the view's matrix.
    rows: [DVec4; 4],
    corner: DVec2,
    size: DVec2,
    /// How far the rasteriser moves corners, pixels.
    step: f64,
}

impl Window {
    fn new(clip_from_relative: Mat4, viewport: &Viewport, step: f64) -> Window {
        let clip = clip_from_relative.as_dmat4();
        let [left, top, width, height] = viewport.area.map(f64::from);
        Window {
            rows: [0, 1, 2, 3].map(|row| clip.row(row)),
            corner: DVec2::new(left, top),
            size: DVec2::new(width, height),
            step,
        }
    }

    fn place(&self, vertex: [f32; 4]) -> Place {
        let vertex = DVec4::from_array(vertex.map(f64::from));
        let [x, y, z, w] = self.rows.map(|row| row.dot(vertex));
        // How large the numbers are that were added up.
        let [x_terms, y_terms, _, w_terms] = self.rows.map(|row| row.abs().dot(vertex.abs()));
        let is_within = x.abs() <= w && y.abs() <= w && (0.0..=w).contains(&z) && w > 0.0;
        if !is_within || w_terms * ROUNDING > w / 16.0 {
            let sides = [(-x, x_terms), (x, x_terms), (-y, y_terms), (y, y_terms)];
            let is_beyond = |(along, terms): (f64, f64)| along - w > (terms + w_terms) * ROUNDING;
            let beyond = (0..4).filter(|side| is_beyond(sides[*side])).fold(0, |all, side| all | 1 << side);
            return Place { at: [0.0; 2], doubt: f32::INFINITY, beyond };
        }
        let place = self.corner + self.size * DVec2::new(1.0 + x / w, 1.0 - y / w) / 2.0;
        let each = DVec2::new(x_terms, y_terms) + w_terms;
        let rounded = (self.size * each).max_element() / w + (self.corner.abs() + self.size).max_element();
        Place { at: place.as_vec2().to_array(), doubt: (self.step + rounded * ROUNDING) as f32, beyond: 0 }
    }
}

/// Returns whether a triangle may cover a pixel's middle.
fn may_cover(corners: [Place; 3]) -> bool {
    let [a, b, c] = corners;
    if a.beyond & b.beyond & c.beyond != 0 {
        return false;
    }
    let doubt = a.doubt.max(b.doubt).max(c.doubt);
    // The first and the last pixel whose middle lies between, along an axis.
    let between = |axis: usize| {
        let [a, b, c] = [a, b, c].map(|corner| corner.at[axis] - 0.5);
        [(a.min(b).min(c) - doubt).ceil(), (a.max(b).max(c) + doubt).floor()]
    };
    let [[left, right], [top, bottom]] = [between(0), between(1)];
    if left > right || top > bottom {
        return false;
    }
    // Also true for what may be clipped.
    if (right - left + 1.0) * (bottom - top + 1.0) > MOST_MIDDLES {
        return true;
    }
    let corners = corners.map(|corner| DVec2::new(corner.at[0].into(), corner.at[1].into()));
    let [a, b, c] = corners;
    let area = (b - a).perp_dot(c - a);
    let edges = [(a, b), (b, c), (c, a)];
    // A corner may be moved along both axes at once.
    let reach = 1.5 * f64::from(doubt);
    let is_outside = |middle: DVec2| {
        edges.iter().any(|(from, to)| {
            let along = *to - *from;
            along.perp_dot(middle - *from) * area.signum() < -reach * along.abs().element_sum()
        })
    };
    let rows = (top as i32)..=(bottom as i32);
    let mut middles = rows.flat_map(|row| ((left as i32)..=(right as i32)).map(move |column| [column, row]));
    area == 0.0 || middles.any(|[column, row]| !is_outside(DVec2::new(column.into(), row.into()) + 0.5))
}

/// Returns a mesh of these triangles of another, which has its vertices.
fn some_of(mesh: &DrawMesh, base_vertex: u32, triangles: &[u32]) -> DrawMesh {
    fn pick<T: bytemuck::Pod + Send + Sync, const N: usize>(blob: &Blob<T>, triangles: &[u32]) -> Vec<T> {
        let all = blob.data().as_chunks::<N>().0;
        let of = triangles.par_iter().with_min_len(SHARE).map(|triangle| all[*triangle as usize]);
        of.collect::<Vec<[T; N]>>().into_flattened()
    }
    let normals = |normals: &SurfaceNormals| SurfaceNormals {
        values: match normals.per {
            NormalsPer::Vertex => normals.values.clone(),
            NormalsPer::Triangle => Blob::new(pick::<_, 1>(&normals.values, triangles)),
            NormalsPer::Corner => Blob::new(pick::<_, 3>(&normals.values, triangles)),
        },
        per: normals.per,
    };
    let indices = pick::<_, 3>(&mesh.indices, triangles).into_iter().map(|vertex| vertex + base_vertex).collect();
    DrawMesh {
        surface: mesh.surface.as_ref().map(|surface| SurfaceData {
            normals: normals(&surface.normals),
            sides: Blob::new(pick::<_, 1>(&surface.sides, triangles)),
            uvs: surface.uvs.as_ref().map(|uvs| Blob::new(pick::<_, 3>(uvs, triangles))),
        }),
        pieces_of: Some(Blob::new(triangles.to_vec())),
        ..DrawMesh::of_blobs(format!("pieces of {}", mesh.name), mesh.vertices.clone(), Blob::new(indices))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    /// A view of one metre to each side, drawn into 100 by 50 pixels.
    fn window() -> Window {
        Window::new(Mat4::IDENTITY, &Viewport::whole([100, 50]), 1.0 / 256.0)
    }

    fn covers(pixels: [[f32; 2]; 3]) -> bool {
        let vertex = |[x, y]: [f32; 2]| window().place([x / 50.0 - 1.0, 1.0 - y / 25.0, 0.5, 1.0]);
        may_cover(pixels.map(vertex))
    }

    #[test]
    fn a_triangle_between_the_middles_of_pixels_is_left_out_and_one_that_may_touch_one_is_not() {
        assert!(!covers([[10.6, 10.6], [11.4, 10.6], [10.6, 11.4]]), "between four middles");
        assert!(covers([[10.6, 10.6], [11.4, 10.6], [11.6, 11.6]]), "round one of them");
        assert!(!covers([[10.6, 10.4], [80.0, 10.4], [80.0, 9.6]]), "between two rows");
        assert!(covers([[10.6, 10.498], [80.0, 10.498], [80.0, 9.6]]), "nearer than a step");
        assert!(!covers([[10.0, 10.0], [11.0, 10.0], [11.0, 11.0]].map(|[x, y]| [x + 0.45, y - 0.45])));
        assert!(covers([[10.0, 10.0], [11.0, 11.0], [12.0, 12.0]]), "no area, through a middle");
        let slope = |off: f32| covers([[10.0, 10.0 - off], [11.0, 11.0 - off], [11.0, 10.0 - off]]);
        assert!(slope(0.0) && slope(0.005) && !slope(0.02), "its long edge is so far beside a middle");
    }

    /// Also where some corners are behind the eye: beyond a side is a half of space.
    #[test]
    fn what_lies_beyond_one_side_is_left_out_and_what_lies_beyond_several_is_not() {
        let covers = |corners: [[f32; 4]; 3]| may_cover(corners.map(|corner| window().place(corner)));
        let right = [[1.5, 0.2, 0.5, 1.0], [2.0, -0.4, 0.5, 1.0], [1.5, -3.0, 0.5, 1.0]];
        assert!(!covers(right));
        assert!(!covers(right.map(|[x, y, z, w]| [-x, y, z, w])), "left");
        for side in [1.0, -1.0] {
            assert!(!covers(right.map(|[x, y, z, w]| [y, side * x, z, w])), "above or below");
        }
        assert!(!covers([right[0], right[1], [0.5, 0.0, 0.5, -1.0]]), "one of them behind the eye");
        assert!(covers([right[0], right[1], [0.9, 0.0, 0.5, 1.0]]), "one of them within");
        assert!(covers([right[0], [-1.5, 0.0, 0.5, 1.0], [0.0, 4.0, 0.5, 1.0]]), "round the view");
        let hardly = 1.0 + f32::EPSILON;
        assert!(covers(right.map(|[_, y, z, w]| [hardly, y, z, w])), "nearer to the side than numbers round");
    }

    #[test]
    fn what_may_be_clipped_and_what_is_not_known_is_drawn() {
        for vertex in [[0.0, 0.0, 0.5, -1.0], [1.1, 0.0, 0.5, 1.0], [0.0, 0.0, 1.5, 1.0], [0.0, 0.0, 0.0, 0.0]] {
            let [b, c] = [[0.001, 0.001, 0.5, 1.0], [0.002, 0.001, 0.5, 1.0]];
            assert!(may_cover([vertex, b, c].map(|vertex| window().place(vertex))), "{vertex:?}");
        }
        let nearly_none =
            Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::new(0.0, 0.0, 5e-8, 1.0), Vec4::new(0.0, 0.0, 0.0, -1e7));
        let window = Window::new(nearly_none, &Viewport::whole([100, 50]), 0.0);
        let place = window.place([0.0, 0.0, 1e7 + 1.0, 1.0]);
        assert_eq!(place.doubt, f32::INFINITY, "numbers that all but cancel say little");
    }
}
