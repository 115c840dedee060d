//! The pieces of a mesh's triangles that a rasteriser draws exactly: clipped to the picture, and put on its grid.
//!
//! Triangles end a quarter of a pixel outside of the outermost pixels' middles, so that pieces cover the same pixels. All
//! triangles of a view, the camera's or a map's, are clipped at the same planes, so that neighbours keep the very same
//! corners.
//!
//! A rasteriser that moves corners to its grid, and takes each one's depth along, tilts the triangle's plane of depth.
//! There, corners are put on the grid beforehand, each with the depth that the plane has at that place: nothing is moved
//! any more. Triangles narrower than a pixel are left their corners' depths: their planes say little of where they lie.

use super::{Blob, DrawMesh, SurfaceData, SurfaceNormals};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
use std::ops::Range;

/// How far inside of the picture's border triangles end, in pixels: no pixel's middle lies there.
const INSIDE: f64 = 0.25;
/// How many times farther than the far plane, or nearer than the near one, depth may be that is not clipped there.
const UNCLIPPED: f64 = 1e3;

/// Which pieces a mesh's triangles were cut into.
pub(super) struct PieceRanges {
    /// For each triangle of the original mesh, and its end, its first piece.
    pub starts: Vec<u32>,
    /// Whether some are cut at the ends of depth.
    pub is_cut_in_depth: bool,
}

/// A corner of a polygon that is being clipped.
#[derive(Clone, Copy)]
struct Corner {
    clip: DVec4,
    /// Homogeneous, relative to the view's origin.
    place: DVec4,
    /// Its parts of the triangle's own corners.
    weights: DVec3,
    /// The vertex of the mesh that it is; `None` for one that clipping made.
    vertex: Option<u32>,
}

/// The planes of a view that triangles are clipped at: what is inside has no negative product with any of them.
pub(super) struct ViewPlanes {
    /// The four at the picture's border.
    sides: [DVec4; 4],
    /// The nearest and the farthest depth.
    ends: [DVec4; 2],
    /// Whether what lies beyond these ends is drawn all the same, at any depth beyond.
    is_unclipped: bool,
}

/// The bits of the planes at the ends of depth.
const ENDS: u8 = 0b11_0000;

/// The arrays of a mesh that is being made.
#[derive(Default)]
struct MeshArrays {
    vertices: Vec<[f32; 4]>,
    indices: Vec<u32>,
    normals: Vec<[[f32; 3]; 3]>,
    uvs: Vec<[f32; 2]>,
    sides: Vec<u32>,
    /// The triangle that each piece is of.
    pieces_of: Vec<u32>,
}

impl ViewPlanes {
    pub fn new(size: [u32; 2], is_reversed: bool, is_unclipped: bool) -> ViewPlanes {
        let border = 1.0 - 2.0 * INSIDE / DVec2::from_array(size.map(|side| f64::from(side.max(1))));
        // The near plane itself; the far one is left to the rasteriser.
        let (near, far) = (DVec4::new(0.0, 0.0, 1.0, 0.0), DVec4::new(0.0, 0.0, -1.0, 2.0));
        let [front, back] = match (is_unclipped, is_reversed) {
            (true, _) => [1.0, -1.0].map(|sign| DVec4::new(0.0, 0.0, sign, UNCLIPPED)),
            (false, false) => [near, far],
            (false, true) => [DVec4::new(0.0, 0.0, -1.0, 1.0), DVec4::new(0.0, 0.0, 1.0, 1.0)],
        };
        let sides = [
            DVec4::new(1.0, 0.0, 0.0, border.x),
            DVec4::new(-1.0, 0.0, 0.0, border.x),
            DVec4::new(0.0, 1.0, 0.0, border.y),
            DVec4::new(0.0, -1.0, 0.0, border.y),
        ];
        ViewPlanes { sides, ends: [front, back], is_unclipped }
    }

    /// Returns all planes, the ends last.
    fn all(&self) -> impl Iterator<Item = (usize, &DVec4)> {
        self.sides.iter().chain(&self.ends).enumerate()
    }

    /// Returns the bits of planes beyond which nothing is drawn.
    fn dropping(&self) -> u8 {
        if self.is_unclipped { !ENDS } else { u8::MAX }
    }

    /// Returns a bit for each plane that a corner lies outside of.
    fn outside(&self, clip: DVec4) -> u8 {
        let bit = |(index, plane): (usize, &DVec4)| u8::from(plane.dot(clip) < 0.0) << index;
        self.all().map(bit).sum()
    }

    /// Returns what is left of a triangle within the planes that it crosses, by their bits. What lies beyond the ends of
    /// depth and is drawn all the same, up to infinity, comes as further pieces, flattened onto those ends, each marked
    /// with `true`: its depth is clamped anyway.
    fn pieces(&self, triangle: Vec<Corner>, crossed: u8, relative_from_clip: &DMat4) -> Vec<(Vec<Corner>, bool)> {
        let mut within = triangle;
        let mut pieces = Vec::new();
        for (_, plane) in self.all().filter(|(index, _)| crossed & 1 << index != 0) {
            let (inside, outside) = split(&within, *plane);
            within = inside;
            // A corner at infinity that the view looks towards has no place in the picture.
            let has_places = outside.iter().all(|corner| corner.clip.w > 0.0);
            if self.is_unclipped && self.ends.contains(plane) && has_places {
                let flat = |corner: Corner| {
                    let clip = corner.clip.with_z(-plane.w / plane.z * corner.clip.w);
                    Corner { clip, place: *relative_from_clip * clip, vertex: None, ..corner }
                };
                pieces.push((outside.into_iter().map(flat).collect(), true));
            }
        }
        pieces.push((within, false));
        pieces
    }

    /// Clips triangles of a mesh, puts their corners on a grid where one is given, and returns the mesh of their pieces, and
    /// which are whose; `None` where all stay as they are.
    pub fn clipped(
        &self,
        mesh: &DrawMesh,
        base_vertex: u32,
        triangles: Range<u32>,
        clip_from_relative: &DMat4,
        grid: Option<&Grid>,
    ) -> Option<(DrawMesh, PieceRanges)> {
        let vertices = mesh.vertices.data();
        let clip: Vec<DVec4> =
            vertices.iter().map(|v| *clip_from_relative * DVec4::from_array(v.map(f64::from))).collect();
        let outside: Vec<u8> = clip.iter().map(|clip| self.outside(*clip)).collect();
        let is_inside = |triangle| {
            let corners = mesh.corners(triangle, base_vertex);
            corners.is_none_or(|corners| corners.iter().all(|vertex| outside[*vertex as usize] == 0))
        };
        if grid.is_none() && triangles.clone().all(is_inside) {
            return None;
        }
        let relative_from_clip = clip_from_relative.inverse();
        let kept = if grid.is_none() { vertices.to_vec() } else { Vec::new() };
        let mut arrays = MeshArrays { vertices: kept, ..MeshArrays::default() };
        let mut starts = vec![0; triangles.start as usize];
        let mut is_cut_in_depth = false;
        for triangle in triangles {
            starts.push((arrays.indices.len() / 3) as u32);
            let Some(of) = mesh.corners(triangle, base_vertex) else { continue };
            let bits = of.map(|vertex| outside[vertex as usize]);
            let (beyond, crossed) = (bits[0] & bits[1] & bits[2], bits[0] | bits[1] | bits[2]);
            is_cut_in_depth |= beyond & !ENDS == 0 && crossed & ENDS != 0 && !self.is_unclipped;
            if beyond & self.dropping() != 0 {
                continue;
            }
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            let corner = |(vertex, weights): (&u32, DVec3)| Corner {
                clip: clip[*vertex as usize],
                place: DVec4::from_array(vertices[*vertex as usize].map(f64::from)),
                weights,
                vertex: Some(*vertex),
            };
            let polygon: Vec<Corner> = of.iter().zip(axes).map(corner).collect();
            let own_plane = grid.and_then(|_| depth_plane(of.map(|vertex| clip[vertex as usize])));
            for (mut polygon, is_flat) in self.pieces(polygon, crossed, &relative_from_clip) {
                if let Some(grid) = grid {
                    let plane = own_plane.filter(|plane| !is_flat && !grid.is_narrow(&polygon, *plane));
                    polygon.iter_mut().for_each(|corner| grid.snap(corner, plane));
                }
                arrays.add(mesh, triangle, &polygon);
            }
        }
        starts.push((arrays.indices.len() / 3) as u32);
        Some((arrays.build(mesh), PieceRanges { starts, is_cut_in_depth }))
    }
}

/// The grid that a rasteriser moves corners to.
pub(super) struct Grid {
    /// Steps across half of the picture.
    half: DVec2,
    /// The length of a step, pixels.
    step: f64,
    relative_from_clip: DMat4,
    is_unclipped: bool,
}

impl Grid {
    pub fn new(size: [u32; 2], step: f64, clip_from_relative: &DMat4, is_unclipped: bool) -> Grid {
        let half = DVec2::from_array(size.map(f64::from)) / (2.0 * step);
        Grid { half, step, relative_from_clip: clip_from_relative.inverse(), is_unclipped }
    }

    /// Returns whether a polygon is less than a pixel wide along the slope of its depth. A step beside such a polygon, its
    /// plane may lie before or behind all of its corners, and before what it should be hidden by.
    fn is_narrow(&self, polygon: &[Corner], plane: DVec3) -> bool {
        let depths = polygon.iter().map(|corner| corner.clip.z / corner.clip.w);
        let [low, high] = depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
        let each_pixel = (plane.truncate() / self.half).length() / self.step;
        high - low < each_pixel
    }

    /// Moves a corner before the eye to the nearest place of the grid, and to the depth that the triangle's plane has
    /// there; with no plane it keeps its depth. Depths between the near and the far plane stay between them, or the
    /// rasteriser would clip what it should not.
    fn snap(&self, corner: &mut Corner, plane: Option<DVec3>) {
        // Its own vertex is not among those of the clipped mesh.
        corner.vertex = None;
        let device = corner.clip.truncate() / corner.clip.w;
        if !device.is_finite() {
            return;
        }
        let place = ((device.truncate() + 1.0) * self.half).round() / self.half - 1.0;
        let depth = plane.map_or(device.z, |plane| plane.dot(place.extend(1.0)));
        let is_between = !self.is_unclipped && (0.0..=1.0).contains(&device.z);
        let depth = if is_between { depth.clamp(0.0, 1.0) } else { depth };
        corner.clip = place.extend(depth).extend(1.0) * corner.clip.w;
        corner.place = self.relative_from_clip * corner.clip;
    }
}

/// Returns the depth of a triangle's plane over the picture, for x, y and 1 of normalized device coordinates, from its
/// corners in clip space; `None` for a triangle seen edge-on.
pub(crate) fn depth_plane(corners: [DVec4; 3]) -> Option<DVec3> {
    let places = corners.map(|corner| DVec3::new(corner.x, corner.y, corner.w));
    let matrix = DMat3::from_cols(places[0], places[1], places[2]).transpose();
    let plane = matrix.inverse() * DVec3::from_array(corners.map(|corner| corner.z));
    (matrix.determinant() != 0.0 && plane.is_finite()).then_some(plane)
}

/// Splits a convex polygon into the part inside of a plane and that outside. An edge is cut from its inner end to its
/// outer one, whichever way it runs: two triangles that share it get the same bits.
fn split(polygon: &[Corner], plane: DVec4) -> (Vec<Corner>, Vec<Corner>) {
    let (mut inside, mut outside) = (Vec::with_capacity(polygon.len() + 1), Vec::new());
    for (index, one) in polygon.iter().enumerate() {
        let next = &polygon[(index + 1) % polygon.len()];
        let [here, there] = [one, next].map(|corner| plane.dot(corner.clip));
        if here >= 0.0 {
            inside.push(*one);
        } else {
            outside.push(*one);
        }
        if (here >= 0.0) != (there >= 0.0) {
            let (inner, outer, from, to) =
                if here >= 0.0 { (one, next, here, there) } else { (next, one, there, here) };
            let part = from / (from - to);
            let between = Corner {
                clip: inner.clip * (1.0 - part) + outer.clip * part,
                place: inner.place * (1.0 - part) + outer.place * part,
                weights: inner.weights * (1.0 - part) + outer.weights * part,
                vertex: None,
            };
            inside.push(between);
            outside.push(between);
        }
    }
    (inside, outside)
}

impl MeshArrays {
    /// Adds what is left of a triangle as a fan.
    fn add(&mut self, mesh: &DrawMesh, triangle: u32, polygon: &[Corner]) {
        if polygon.len() < 3 {
            return;
        }
        let written: Vec<u32> =
            polygon.iter().map(|corner| corner.vertex.unwrap_or_else(|| self.vertex(corner))).collect();
        for at in 1..polygon.len() - 1 {
            let fan = [0, at, at + 1];
            self.indices.extend(fan.map(|corner| written[corner]));
            self.pieces_of.push(triangle);
            if let Some(surface) = &mesh.surface {
                self.add_surface(mesh, surface, triangle, fan.map(|corner| polygon[corner].weights));
            }
        }
    }

    fn vertex(&mut self, corner: &Corner) -> u32 {
        let place = corner.place;
        // On the grid, depth may come to lie a little beyond that of infinity: `w` is negative there, and the corner is
        // before the eye all the same. A negative scale would put it behind.
        let scale = if place.w == 0.0 { place.truncate().length() } else { place.w.abs() };
        let scale = if scale == 0.0 { 1.0 } else { scale };
        self.vertices.push((place / scale).as_vec4().to_array());
        self.vertices.len() as u32 - 1
    }

    /// Adds normals, texture coordinates and sides of a piece of a triangle, whose corners are parts of the triangle's
    /// own: as the rasteriser interpolates them there.
    fn add_surface(&mut self, mesh: &DrawMesh, surface: &SurfaceData, triangle: u32, corners: [DVec3; 3]) {
        let first = 3 * triangle as usize;
        let own = mesh.corners(triangle, 0).and_then(|corners| surface.normals.of_triangle(triangle as usize, corners));
        let own = own.unwrap_or_default();
        self.normals.push(corners.map(|weights| mixed(&own, weights)));
        for weights in corners {
            if let Some(uvs) = &surface.uvs {
                self.uvs.push(mixed(&uvs.data()[first..first + 3], weights));
            }
        }
        self.sides.push(surface.sides.data()[triangle as usize]);
    }

    fn build(self, mesh: &DrawMesh) -> DrawMesh {
        let surface = mesh.surface.as_ref().map(|surface| SurfaceData {
            normals: SurfaceNormals::new(&self.indices, self.vertices.len(), |piece| self.normals[piece]),
            sides: Blob::new(self.sides),
            uvs: surface.uvs.as_ref().map(|_| Blob::new(self.uvs)),
        });
        let blobs = (Blob::new(self.vertices), Blob::new(self.indices));
        let pieces_of = Some(Blob::new(self.pieces_of));
        DrawMesh { surface, pieces_of, ..DrawMesh::of_blobs(format!("pieces of {}", mesh.name), blobs.0, blobs.1) }
    }
}

/// Returns the sum of three corners' values by their weights; exactly a corner's own where the others weigh nothing.
fn mixed<const N: usize>(values: &[[f32; N]], weights: DVec3) -> [f32; N] {
    let own = weights.to_array().iter().position(|weight| *weight == 1.0);
    own.map_or_else(
        || {
            std::array::from_fn(|at| {
                let each = DVec3::new(values[0][at].into(), values[1][at].into(), values[2][at].into());
                weights.dot(each) as f32
            })
        },
        |corner| values[corner],
    )
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Two triangles that share an edge, which runs out of the picture and behind the eye.
    pub fn strip() -> DrawMesh {
        let vertices =
            vec![[0.1, 0.2, -2.0, 1.0], [0.9, -0.3, 1.5, 1.0], [-40.0, 0.1, -3.0, 1.0], [3.0, 50.0, -1.0, 0.0]];
        DrawMesh::of_positions("strip", vertices, vec![0, 1, 2, 1, 0, 3])
    }

    pub fn looking() -> DMat4 {
        // Reversed depth without a far plane: z = near, w = distance.
        DMat4::from_cols_array_2d(&[
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, 0.1, 0.0],
        ])
    }

    #[test]
    fn what_is_left_lies_in_the_view_and_neighbours_share_its_corners() {
        let (mesh, planes) = (strip(), ViewPlanes::new([64, 48], true, false));
        let (clipped, PieceRanges { starts, .. }) =
            planes.clipped(&mesh, 0, 0..2, &looking(), None).expect("a clipped mesh");
        assert_eq!((starts.len(), starts[2]), (3, clipped.triangles()));
        let vertices = clipped.vertices.data();
        let used = |triangles: Range<u32>| -> std::collections::BTreeSet<[u32; 4]> {
            let corners = triangles.filter_map(|triangle| clipped.corners(triangle, 0)).flatten();
            corners.map(|vertex| vertices[vertex as usize].map(f32::to_bits)).collect()
        };
        let all = used(0..starts[2]);
        for bits in &all {
            let clip = looking() * DVec4::from_array(bits.map(|bits| f64::from(f32::from_bits(bits))));
            let least = planes.all().map(|(_, plane)| plane.dot(clip)).fold(f64::INFINITY, f64::min);
            assert!(least > -1e-5 && clip.w > 0.0, "{clip}");
        }
        // The edge from vertex 0 ends at one place for both.
        let both: Vec<_> = used(0..starts[1]).intersection(&used(starts[1]..starts[2])).copied().collect();
        assert_eq!(both.len(), 2, "{both:?}");
    }

    /// A volume's side reaches to infinity across a parallel view, where depth is clamped: what is left of it covers all
    /// that it covered, and has an end.
    #[test]
    fn what_lies_beyond_the_ends_of_depth_is_kept_where_depth_is_clamped() {
        let vertices = vec![[0.0, -0.5, -1.0, 1.0], [0.0, 0.5, -1.0, 1.0], [1e-6, 0.0, -1.0, 0.0]];
        let side = DrawMesh::of_positions("side", vertices, vec![0, 1, 2]);
        let clip = DMat4::from_diagonal(DVec4::new(1.0, 1.0, -0.1, 1.0));
        let area = |is_unclipped| {
            let planes = ViewPlanes::new([64, 48], false, is_unclipped);
            let (clipped, PieceRanges { starts, .. }) =
                planes.clipped(&side, 0, 0..1, &clip, None).expect("a clipped mesh");
            let place = |vertex: u32| {
                let [x, y, z, w] = clipped.vertices.data()[vertex as usize].map(f64::from);
                assert!(w > 0.0 && (clip * DVec4::new(x, y, z, w)).z.abs() <= 1.01 * UNCLIPPED * w, "{z} {w}");
                DVec2::new(x, y) / w
            };
            let of = |triangle: u32| {
                let [a, b, c] = clipped.corners(triangle, 0).expect("a triangle").map(place);
                (b - a).perp_dot(c - a).abs() / 2.0
            };
            (0..starts[1]).map(of).sum::<f64>()
        };
        // From its edge to the picture's border, a quarter of a pixel inside; clipped, next to nothing.
        assert!((area(true) - 0.5 * (1.0 - 0.5 / 64.0) * 2.0).abs() < 1e-3, "{}", area(true));
        assert!(area(false) < 1e-4, "{}", area(false));
    }

    /// Corners at infinity come to lie beyond it on the grid, and beyond the ends of clamped depth: all stay before the
    /// eye.
    #[test]
    fn what_lies_at_infinity_stays_before_the_eye() {
        let vertices =
            vec![[0.1, 0.2, -2.0, 1.0], [0.3, -0.3, -3.0, 1.0], [0.4, 0.1, -1.0, 0.0], [-0.2, -0.4, -1.0, 0.0]];
        let side = DrawMesh::of_positions("side", vertices, vec![0, 1, 2, 0, 2, 3]);
        // Standard depth from 0.1 to 1000: infinity is just beyond the far plane.
        let [along, apart] = [1000.0 / (0.1 - 1000.0), 0.1 * 1000.0 / (0.1 - 1000.0)];
        let clip = DMat4::from_cols_array_2d(&[
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, along, -1.0],
            [0.0, 0.0, apart, 0.0],
        ]);
        for is_unclipped in [false, true] {
            let planes = ViewPlanes::new([64, 48], false, is_unclipped);
            let grid = Grid::new([64, 48], 1.0 / 16.0, &clip, is_unclipped);
            let (clipped, _) = planes.clipped(&side, 0, 0..2, &clip, Some(&grid)).expect("a clipped mesh");
            let places = clipped.vertices.data().iter().map(|place| place.map(f64::from));
            let before = places.map(|place| (clip * DVec4::from_array(place)).w);
            assert!(before.clone().count() > 3 && before.clone().all(|w| w > 0.0), "{:?}", before.collect::<Vec<_>>());
        }
    }

    /// Corners lie on the grid, each in its triangle's plane of depth, and neighbours at the same places.
    #[test]
    fn on_a_coarse_grid_no_corner_is_moved_any_more() {
        let (mesh, size) = (strip(), [64, 48]);
        let grid = Grid::new(size, 1.0 / 16.0, &looking(), false);
        let planes = ViewPlanes::new(size, true, false);
        let (clipped, PieceRanges { starts, .. }) =
            planes.clipped(&mesh, 0, 0..2, &looking(), Some(&grid)).expect("a clipped mesh");
        let place = |vertex: u32| {
            let clip = looking() * DVec4::from_array(clipped.vertices.data()[vertex as usize].map(f64::from));
            let steps = (clip.truncate().truncate() / clip.w + 1.0) * DVec2::new(32.0, 24.0) * 16.0;
            assert!((steps - steps.round()).abs().max_element() < 1e-3, "{steps}");
            (steps.round(), clip.z / clip.w)
        };
        let mut places: [Vec<DVec2>; 2] = [Vec::new(), Vec::new()];
        for (triangle, places) in places.iter_mut().enumerate() {
            let of = mesh.corners(triangle as u32, 0).expect("a triangle");
            let plane =
                depth_plane(of.map(|v| looking() * DVec4::from_array(mesh.vertices.data()[v as usize].map(f64::from))));
            for vertex in
                (starts[triangle]..starts[triangle + 1]).filter_map(|piece| clipped.corners(piece, 0)).flatten()
            {
                let (at, depth) = place(vertex);
                let device = at / (DVec2::new(32.0, 24.0) * 16.0) - 1.0;
                let expected = plane.expect("a plane").dot(device.extend(1.0)).clamp(0.0, 1.0);
                assert!((depth - expected).abs() < 1e-5, "{depth} is not {expected}");
                places.push(at);
            }
        }
        assert!(places[0].iter().filter(|at| places[1].contains(at)).count() > 1, "{places:?}");
    }
}
