//! Normals of surfaces, stored once for what shares them.

use super::Blob;
use rayon::prelude::*;

/// How many triangles one thread asks about, at least.
const SHARE: usize = 16 * 1024;

/// Normals of a mesh's corners, each stored once for what shares it: three floats for each triangle of a faceted mesh or
/// each vertex of a smooth one, in place of nine a triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceNormals {
    /// The normals, world space.
    pub values: Blob<[f32; 3]>,
    /// What each of them belongs to.
    pub per: NormalsPer,
}

/// What a normal belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum NormalsPer {
    /// A corner of a triangle: they are parallel to the indices.
    Corner = 0,
    /// A vertex: the corners that are there share it.
    Vertex = 1,
    /// A triangle: its corners share it.
    Triangle = 2,
}

impl SurfaceNormals {
    /// Stores the normals of a mesh's corners in the smallest form that has them bit for bit. `indices` are three a
    /// triangle, of so many `vertices`; `of_triangle` returns the normals of a triangle's corners, and is asked more than
    /// once, by several threads.
    pub fn new(
        indices: &[u32],
        vertices: usize,
        of_triangle: impl Fn(usize) -> [[f32; 3]; 3] + Sync,
    ) -> SurfaceNormals {
        let triangles = indices.as_chunks::<3>().0;
        let bits = |normal: [f32; 3]| normal.map(f32::to_bits);
        let shared = |triangle: usize| {
            let [a, b, c] = of_triangle(triangle);
            (bits(a) == bits(b) && bits(b) == bits(c)).then_some(a)
        };
        let each = (0..triangles.len()).into_par_iter().with_min_len(SHARE);
        if let Some(values) = each.map(shared).collect::<Option<Vec<_>>>() {
            return SurfaceNormals { values: Blob::new(values), per: NormalsPer::Triangle };
        }
        let is_smaller = vertices < indices.len() && indices.iter().all(|vertex| (*vertex as usize) < vertices);
        let mut of_vertices: Vec<Option<[f32; 3]>> = vec![None; if is_smaller { vertices } else { 0 }];
        let is_shared = is_smaller
            && triangles.iter().enumerate().all(|(triangle, corners)| {
                corners.iter().zip(of_triangle(triangle)).all(|(vertex, normal)| {
                    let known = of_vertices[*vertex as usize].get_or_insert(normal);
                    bits(*known) == bits(normal)
                })
            });
        if is_shared {
            let values = of_vertices.into_iter().map(Option::unwrap_or_default).collect();
            return SurfaceNormals { values: Blob::new(values), per: NormalsPer::Vertex };
        }
        let values = (0..triangles.len()).flat_map(of_triangle).collect();
        SurfaceNormals { values: Blob::new(values), per: NormalsPer::Corner }
    }

    /// Returns the normals of the corners of a triangle with these indices; `None` where one is missing.
    pub fn of_triangle(&self, triangle: usize, corners: [u32; 3]) -> Option<[[f32; 3]; 3]> {
        let values = self.values.data();
        let [a, b, c] = match self.per {
            NormalsPer::Corner => [0, 1, 2].map(|corner| triangle * 3 + corner),
            NormalsPer::Vertex => corners.map(|vertex| vertex as usize),
            NormalsPer::Triangle => [triangle; 3],
        };
        Some([*values.get(a)?, *values.get(b)?, *values.get(c)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_stored_once_for_what_shares_them() {
        let indices = [0, 1, 2, 2, 1, 3];
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let forms = [
            ([[x; 3], [y; 3]], NormalsPer::Triangle, 2),
            ([[x, y, z], [z, y, x]], NormalsPer::Vertex, 5),
            ([[x, y, z], [x, y, z]], NormalsPer::Corner, 6),
        ];
        for (corners, per, count) in forms {
            // The last vertex is of no triangle.
            let normals = SurfaceNormals::new(&indices, 5, |triangle| corners[triangle]);
            assert_eq!((normals.per, normals.values.len()), (per, count));
            let of = |triangle: usize, at: [u32; 3]| normals.of_triangle(triangle, at);
            assert_eq!([of(0, [0, 1, 2]), of(1, [2, 1, 3])], corners.map(Some));
            assert_eq!(of(9, [9; 3]), None);
        }
    }

    /// Zero has two signs, and both are kept.
    #[test]
    fn normals_are_the_same_to_the_last_bit() {
        let corners = [[[0.0, 1.0, 0.0], [-0.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];
        let normals = SurfaceNormals::new(&[0, 1, 2], 3, |triangle| corners[triangle]);
        assert_eq!(normals.per, NormalsPer::Corner, "as many vertices as corners share nothing");
        assert!(normals.values.data()[1][0].is_sign_negative());
    }

    /// A few triangles of a large mesh do not store a normal for each of its vertices, and what lies beyond them is no error.
    #[test]
    fn vertices_that_are_more_than_corners_or_missing_have_no_normals_of_their_own() {
        let corners = [[[1.0; 3], [2.0; 3], [3.0; 3]]; 2];
        for (indices, vertices) in [([0, 1, 2, 0, 1, 2], 1_000_000), ([0, 1, 9, 0, 1, 9], 5)] {
            let normals = SurfaceNormals::new(&indices, vertices, |triangle| corners[triangle]);
            assert_eq!((normals.per, normals.values.len()), (NormalsPer::Corner, 6));
        }
    }
}
