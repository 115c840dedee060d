//! Vertices that a vertex shader carries away from a light.
//!
//! Each belongs to one triangle and knows its plane: where that faces the light the vertex stays, otherwise it goes to
//! the far end (Brennan 2002, "Shadow Volume Extrusion using a Vertex Shader"). So the light may move and no vertex is
//! written anew. [`Extruded::vertices`] computes on the CPU what the shader makes of them, with the same steps in
//! single precision, for those who ask what was drawn. (A GPU that multiplies and adds in one step may decide
//! differently about a plane that contains the light to the last bits; llvmpipe does not.)

use super::{Blob, Casters, EdgeList, relative};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A vertex of a volume that a vertex shader extrudes, with the plane that decides whether it is carried away.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ExtrudedCorner {
    /// Its position before it is carried: homogeneous with w = 1, relative to the origin of the pass's view.
    pub near: [f32; 4],
    /// The plane of its triangle in the same space: unit normal and offset. It is carried where the light is not in
    /// front of the plane; zeros carry it under any light.
    pub plane: [f32; 4],
}

/// The uniform values by which a vertex shader carries vertices away from one light, in single precision.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Carry {
    /// The light's homogeneous position, relative to the origin of the pass's view.
    pub light: [f32; 4],
    /// A far vertex is `(scale · near + offset, w)`.
    pub scale: f32,
    /// See [`Carry::scale`].
    pub offset: [f32; 3],
    /// The w of far vertices: 0 at infinity, else 1.
    pub w: f32,
}

impl Carry {
    /// Returns whether a vertex with this plane is carried: the light is not in front of the plane. Computes in single
    /// precision and in the shader's order.
    pub fn carries(&self, [x, y, z, rest]: [f32; 4]) -> bool {
        let [light_x, light_y, light_z, light_w] = self.light;
        let side = x * light_x + y * light_y + z * light_z + rest * light_w;
        // What is no number is carried, as in the shader.
        !matches!(side.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater))
    }

    /// Returns the homogeneous position that a vertex (relative to the view's origin) is carried to; its own w is
    /// ignored.
    pub fn far(&self, [x, y, z, _]: [f32; 4]) -> [f32; 4] {
        let [to_x, to_y, to_z] = self.offset;
        [self.scale * x + to_x, self.scale * y + to_y, self.scale * z + to_z, self.w]
    }
}

/// The vertices of a volume that a vertex shader extrudes, and how it carries them.
#[derive(Debug, Clone, PartialEq)]
pub struct Extruded {
    /// One for each vertex.
    pub corners: Blob<ExtrudedCorner>,
    /// How they are carried away from the light.
    pub carry: Carry,
}

impl Extruded {
    /// Returns for each of these vertices (by index) whether it is carried to the far end; false for an index without a
    /// vertex.
    pub fn carried(&self, vertices: [u32; 3]) -> [bool; 3] {
        let is_carried = |corner: &ExtrudedCorner| self.carry.carries(corner.plane);
        vertices.map(|vertex| self.corners.data().get(vertex as usize).is_some_and(is_carried))
    }

    /// Returns the homogeneous positions to which the shader moves all vertices, near or far, computed when their data
    /// is first asked for.
    pub fn vertices(&self) -> Blob<[f32; 4]> {
        let Extruded { corners, carry } = self.clone();
        let place = move |corner: &ExtrudedCorner| match carry.carries(corner.plane) {
            true => carry.far(corner.near),
            false => corner.near,
        };
        let Carry { light, scale, offset: [x, y, z], w } = self.carry;
        let from = [corners.hash().to_le_bytes().to_vec(), bytemuck::bytes_of(&light).to_vec()].concat();
        let to = [scale, x, y, z, w];
        let identity = [&from, bytemuck::bytes_of(&to)].concat();
        Blob::made(&identity, corners.len(), move || corners.data().iter().map(place).collect())
    }
}

/// The triangles that a volume for a vertex shader consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExtrudedForm {
    /// Each triangle once, and a quad between the two triangles of each edge: for a closed, consistently wound mesh
    /// whose light-facing triangles cast.
    Closed,
    /// Each triangle twice, back to back, and a quad between the copies at each of its edges: for any mesh.
    Prisms(Casters),
}

/// A caster's volume for a vertex shader; it is the same for every light.
#[derive(Debug, Clone)]
pub struct ExtrudedVolume {
    /// Its vertices: three for each triangle of the mesh, or six where each is there twice.
    pub corners: Blob<ExtrudedCorner>,
    /// Vertex indices, three a triangle.
    pub indices: Blob<u32>,
    /// The range of triangles that are the quads on edges.
    pub sides: Range<usize>,
    /// The range of the mesh's triangles in its own order, front faces outwards.
    pub caps: Range<usize>,
    /// The range of the second copies, which face inwards; empty for a closed mesh.
    pub flipped_caps: Range<usize>,
}

impl ExtrudedVolume {
    /// Builds the corners and triangles of a mesh's volume for a vertex shader to extrude: sides first, then one copy
    /// of the triangles, or two. They don't depend on the light; positions are world-space ones less `origin`, in
    /// single precision.
    pub fn new(
        world: &[DVec3],
        triangles: &[[u32; 3]],
        edges: &EdgeList,
        origin: DVec3,
        form: ExtrudedForm,
    ) -> ExtrudedVolume {
        let (mut corners, mut indices) = (Vec::new(), Vec::new());
        let copies = if form == ExtrudedForm::Closed { 1 } else { 2 };
        corners.reserve(triangles.len() * 3 * copies);
        for triangle in triangles {
            let plane = plane(triangle.map(|vertex| world[vertex as usize]), origin);
            for plane in form.planes(plane).into_iter().take(copies) {
                let near = |vertex: &u32| relative::point(world[*vertex as usize], origin);
                corners.extend(triangle.iter().map(|vertex| ExtrudedCorner { near: near(vertex), plane }));
            }
        }
        match form {
            ExtrudedForm::Closed => between_neighbours(triangles, edges, &mut indices),
            ExtrudedForm::Prisms(_) => (0..triangles.len()).for_each(|triangle| around_prism(triangle, &mut indices)),
        }
        let sides = indices.len() / 3;
        let of_copy = |copy: usize| {
            let first = move |triangle: usize| ((triangle * copies + copy) * 3) as u32;
            (0..triangles.len()).flat_map(move |triangle| first(triangle)..first(triangle) + 3)
        };
        (0..copies).for_each(|copy| indices.extend(of_copy(copy)));
        let (once, all) = (sides + triangles.len(), sides + triangles.len() * copies);
        let (corners, indices) = (Blob::new(corners), Blob::new(indices));
        ExtrudedVolume { corners, indices, sides: 0..sides, caps: sides..once, flipped_caps: once..all }
    }
}

impl ExtrudedForm {
    /// Returns the planes that decide whether a triangle's two copies stay or are carried: the triangle's plane for the
    /// front, its negative for the back; zero, so that it is always carried, for a side that does not cast.
    fn planes(self, plane: [f32; 4]) -> [[f32; 4]; 2] {
        let (front, back) = (plane, plane.map(|value| -value));
        match self {
            ExtrudedForm::Closed | ExtrudedForm::Prisms(Casters::LightFacing) => [front, [0.0; 4]],
            ExtrudedForm::Prisms(Casters::LightBackFacing) => [[0.0; 4], back],
            ExtrudedForm::Prisms(Casters::All) => [front, back],
        }
    }
}

/// Returns a triangle's plane relative to `origin`: unit normal and offset; zeros where the corners are collinear.
fn plane([a, b, c]: [DVec3; 3], origin: DVec3) -> [f32; 4] {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal.extend(-normal.dot(a - origin)).as_vec4().to_array()
}

/// Adds the two triangles of a quad between the edge `p`–`q` of one triangle and the same edge of another. It faces
/// outwards where the first, running from `p` to `q`, stays and the second is carried, or the other way round.
fn quad([p, q]: [u32; 2], [p_far, q_far]: [u32; 2], out: &mut Vec<u32>) {
    out.extend([q, p, p_far, q, p_far, q_far]);
}

/// Appends, for each edge that two triangles run along in opposite ways, the two triangles of a quad between their
/// corners; edges without such a pair give none.
fn between_neighbours(triangles: &[[u32; 3]], edges: &EdgeList, out: &mut Vec<u32>) {
    for (index, edge) in edges.edges().iter().enumerate() {
        let corner = |triangle: usize, vertex: u32| {
            let at = triangles[triangle].iter().position(|corner| *corner == vertex).unwrap_or_default();
            (triangle * 3 + at) as u32
        };
        let mut forth = None;
        let mut back = None;
        for (triangle, direction) in edges.incident(index) {
            *(if direction > 0 { &mut forth } else { &mut back }) = Some(triangle);
        }
        let (Some(forth), Some(back)) = (forth, back) else { continue };
        let ends = |triangle| [corner(triangle, edge.low), corner(triangle, edge.high)];
        quad(ends(forth), ends(back), out);
    }
}

/// Adds, for each edge of a triangle, a quad between the triangle's two copies.
fn around_prism(triangle: usize, out: &mut Vec<u32>) {
    let first = triangle as u32 * 6;
    for (p, q) in [(0, 1), (1, 2), (2, 0)] {
        quad([first + p, first + q], [first + 3 + p, first + 3 + q], out);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Extruder, Extrusion};
    use super::*;
    use crate::math::{Sign, side_of_triangle};
    use crate::scene::shapes;
    use glam::DVec4;
    use std::collections::BTreeMap;

    const SUN_FROM_ABOVE: Carry = Carry { light: [0.0, 1.0, 0.0, 0.0], scale: 0.0, offset: [0.0, -1.0, 0.0], w: 0.0 };

    #[test]
    fn what_faces_the_light_stays_and_the_rest_is_carried() {
        let corner = |plane| ExtrudedCorner { near: [1.0, 2.0, 3.0, 1.0], plane };
        let planes = [[0.0, 1.0, 0.0, -2.0], [0.0, -1.0, 0.0, 2.0], [1.0, 0.0, 0.0, 5.0], [0.0; 4], [f32::NAN; 4]];
        let extruded = Extruded { corners: Blob::new(planes.map(corner).to_vec()), carry: SUN_FROM_ABOVE };
        let [near, far] = [[1.0, 2.0, 3.0, 1.0], [0.0, -1.0, 0.0, 0.0]];
        assert_eq!(extruded.vertices().data(), [near, far, far, far, far]);
    }

    #[test]
    fn a_light_that_moves_is_another_set_of_vertices_of_the_same_corners() {
        let corners = Blob::new(vec![ExtrudedCorner { near: [0.0; 4], plane: [0.0; 4] }]);
        let at =
            |x| Extruded { corners: corners.clone(), carry: Carry { light: [x, 1.0, 0.0, 1.0], ..SUN_FROM_ABOVE } };
        assert_ne!(at(0.0).vertices(), at(1.0).vertices());
        assert_eq!(at(0.0).vertices(), at(0.0).vertices());
        assert_eq!(at(0.0).corners.hash(), at(1.0).corners.hash());
    }

    /// Returns the carried triangles counter-clockwise seen from outside: sides, caps, and flipped caps reversed.
    fn carried(volume: &ExtrudedVolume, carry: Carry) -> Vec<[[u32; 4]; 3]> {
        let extruded = Extruded { corners: volume.corners.clone(), carry };
        let vertices = extruded.vertices();
        let bits = |index: u32| vertices.data()[index as usize].map(|value| (value + 0.0).to_bits());
        let triangles = volume.indices.data().as_chunks::<3>().0;
        let outwards = |(at, [a, b, c]): (usize, &[u32; 3])| {
            if volume.flipped_caps.contains(&at) { [*a, *c, *b].map(bits) } else { [*a, *b, *c].map(bits) }
        };
        triangles.iter().enumerate().map(outwards).collect()
    }

    /// Whatever the light decides, each edge is run as often back as forth.
    #[test]
    fn volumes_close_wherever_the_light_is() {
        let ball = shapes::sphere(1.0, 12, 8).expect("a ball");
        let (world, triangles) = (ball.positions(), ball.triangles());
        let edges = EdgeList::new(triangles, world.len());
        let sheet = &triangles[..triangles.len() / 3];
        let of_sheet = EdgeList::new(sheet, world.len());
        let eye = DVec3::new(0.3, 0.2, 7.0);
        let prisms = [Casters::All, Casters::LightFacing, Casters::LightBackFacing].map(ExtrudedForm::Prisms);
        let all = [ExtrudedForm::Closed].into_iter().chain(prisms).map(|form| (form, triangles, &edges));
        for (form, triangles, edges) in all.chain(prisms.map(|form| (form, sheet, &of_sheet))) {
            let volume = ExtrudedVolume::new(world, triangles, edges, eye, form);
            let mut edges_seen = 0;
            let lights = [[3.0, 4.0, 5.0, 1.0], [0.2, 0.1, 0.3, 1.0], [1.0, 0.0, 0.0, 1.0], [0.3, 2.0, 1.0, 0.0]];
            for light in lights.map(DVec4::from_array) {
                for extrusion in [Extrusion::Infinite, Extrusion::Finite(3.0)] {
                    let carry = Extruder::new(world, light, extrusion).carry_from(eye);
                    let mut sums: BTreeMap<_, i32> = BTreeMap::new();
                    for [a, b, c] in carried(&volume, carry) {
                        for (from, to) in [(a, b), (b, c), (c, a)] {
                            *sums.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
                        }
                    }
                    let open = sums.iter().filter(|((from, to), sum)| from != to && **sum != 0).count();
                    assert!(open == 0, "{form:?} {light} {extrusion:?}: {open} of {}", sums.len());
                    edges_seen += sums.len();
                }
            }
            assert!(edges_seen > 400, "{form:?}: {edges_seen}");
        }
    }

    /// Away from where single precision can't decide, what stays is what faces the light, or of backs what faces away.
    #[test]
    fn what_stays_is_what_casts() {
        let ball = shapes::sphere(1.0, 12, 8).expect("a ball");
        let (world, triangles) = (ball.positions(), ball.triangles());
        let edges = EdgeList::new(triangles, world.len());
        let light = DVec4::new(3.1, 4.3, -2.2, 1.0);
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let carry = Extruder::new(world, light, Extrusion::Infinite).carry_from(eye);
        let faces =
            |triangle: &[u32; 3]| side_of_triangle(triangle.map(|v| world[v as usize]), light) == Sign::Positive;
        for (casters, [front, back]) in [
            (Casters::All, [true, true]),
            (Casters::LightFacing, [true, false]),
            (Casters::LightBackFacing, [false, true]),
        ] {
            let volume = ExtrudedVolume::new(world, triangles, &edges, eye, ExtrudedForm::Prisms(casters));
            let stays = |copy: &[ExtrudedCorner]| copy.iter().filter(|corner| !carry.carries(corner.plane)).count();
            for (triangle, copies) in triangles.iter().zip(volume.corners.data().chunks(6)) {
                let [one, other] = [&copies[..3], &copies[3..]].map(stays);
                let faces = faces(triangle);
                assert_eq!([one == 3, other == 3], [faces && front, !faces && back]);
                assert!(one % 3 == 0 && other % 3 == 0);
            }
        }
    }

    /// As the CPU carries them, but for rounding.
    #[test]
    fn vertices_go_where_the_extruder_takes_them() {
        let world = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 1.0), DVec3::ZERO];
        let eye = DVec3::new(3.0, -2.0, 9.0);
        for light in [DVec4::new(0.0, 6.0, 1.0, 1.0), DVec4::new(3.0, 6.0, 1.0, 0.0)] {
            for extrusion in [Extrusion::Infinite, Extrusion::Finite(2.5), Extrusion::FromOrigin(2.5)] {
                let extruder = Extruder::new(&world, light, extrusion);
                let carry = extruder.carry_from(eye);
                for place in world {
                    let expected = relative::homogeneous(extruder.carry(place), eye);
                    let far = carry.far(relative::point(place, eye));
                    let near = far.iter().zip(expected).all(|(far, expected)| (far - expected).abs() < 1e-5);
                    assert!(near, "{extrusion:?} of {light}: {far:?} {expected:?}");
                }
            }
        }
    }
}
