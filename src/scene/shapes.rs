//! Shapes by their parameters, as meshes.
//!
//! Closed shapes are watertight and face outward: corners run counter-clockwise seen from outside. Poles and seams are
//! shared vertices, not equal ones. Round shapes are surfaces of revolution of profiles: a line in the half-plane
//! (radius, height), followed so that the solid is on its left, rotated around the y axis.

use crate::math::angle;
use crate::scene::{Mesh, MeshBuilder, MeshError};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Returns a level rectangle around the origin that faces up, `size` along x and z.
pub fn quad(size: [f64; 2]) -> Result<Mesh, MeshError> {
    let [x, z] = size.map(|n| n / 2.0);
    triangles(&[[-x, 0.0, z], [x, 0.0, z], [x, 0.0, -z], [-x, 0.0, -z]], &[[0, 1, 2], [0, 2, 3]])
}

/// Returns a closed box around the origin.
pub fn cuboid(size: [f64; 3]) -> Result<Mesh, MeshError> {
    cuboid_builder(size).build()
}

/// Returns a box of width, height and depth around the origin whose triangles face inwards: a room.
pub fn room(size: [f64; 3]) -> Result<Mesh, MeshError> {
    let mut builder = cuboid_builder(size);
    builder.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    builder.build()
}

/// Returns a closed ball around the origin, `around` segments along the equator and `rings` from pole to pole.
pub fn sphere(radius: f64, around: u32, rings: u32) -> Result<Mesh, MeshError> {
    let latitude = |ring: u32| PI * (f64::from(ring) / f64::from(rings) - 0.5);
    let between = (1..rings).map(latitude).map(|angle| angle::direction(angle) * radius);
    let mut profile = vec![DVec2::new(0.0, -radius)];
    profile.extend(between);
    profile.push(DVec2::new(0.0, radius));
    revolve(&profile, false, around)
}

/// Returns a closed ring around the y axis: its tube's radius is `minor`, and the tube's middle runs `major` from the
/// axis.
pub fn torus(major: f64, minor: f64, around: u32, along_tube: u32) -> Result<Mesh, MeshError> {
    let angle = |step: u32| TAU * f64::from(step) / f64::from(along_tube);
    let profile: Vec<DVec2> =
        (0..along_tube).map(|step| DVec2::new(major, 0.0) + angle::direction(angle(step)) * minor).collect();
    revolve(&profile, true, around)
}

/// Returns a closed regular tetrahedron around the origin with its corners `radius` away, one of them up.
pub fn tetrahedron(radius: f64) -> Result<Mesh, MeshError> {
    let base_radius = radius * 8f64.sqrt() / 3.0;
    let base = (0..3).map(|corner| {
        let (sin, cos) = angle::sin_cos(TAU * f64::from(corner) / 3.0);
        [base_radius * sin, -radius / 3.0, base_radius * cos]
    });
    let mut positions: Vec<[f64; 3]> = base.collect();
    positions.push([0.0, radius, 0.0]);
    triangles(&positions, &[[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
}

/// Returns a closed upright cylinder around the origin, from −`height`/2 to `height`/2, with `around` segments.
pub fn cylinder(radius: f64, height: f64, around: u32) -> Result<Mesh, MeshError> {
    let half = height / 2.0;
    let profile = [[0.0, -half], [radius, -half], [radius, half], [0.0, half]].map(DVec2::from_array);
    revolve(&profile, false, around)
}

/// Returns a surface of revolution: a profile of (radius, height) points rotated around the y axis in `around` steps;
/// `closed` joins its last point to the first. Points on the axis are poles. The surface faces right of the profile.
pub fn revolve(profile: &[DVec2], closed: bool, around: u32) -> Result<Mesh, MeshError> {
    let mut builder = MeshBuilder::default();
    let rings: Vec<VertexRing> =
        profile.iter().map(|point| VertexRing::new(*point, around, &mut builder.positions)).collect();
    let next = rings.iter().cycle().skip(1);
    let bands = rings.len() - usize::from(!closed && !rings.is_empty());
    for (low, high) in rings.iter().zip(next).take(bands) {
        for step in 0..around {
            let [a, b] = [low.vertex(step), low.vertex(step + 1)];
            let [d, c] = [high.vertex(step), high.vertex(step + 1)];
            let halves = [(!low.is_pole()).then_some([a, b, c]), (!high.is_pole()).then_some([a, c, d])];
            builder.triangles.extend(halves.into_iter().flatten());
        }
    }
    builder.build()
}

/// Returns a parallelogram with a corner at `corner` and these two edges; it faces along their cross product.
pub fn parallelogram(corner: DVec3, edges: [DVec3; 2]) -> Result<Mesh, MeshError> {
    let [x, y] = edges;
    let mut builder = MeshBuilder::default();
    add_quad(&mut builder, [corner, corner + x, corner + x + y, corner + y]);
    builder.build()
}

/// Returns closed solid stairs: from the origin `steps` up and along x, each `rise` high and `run` deep, and `width`
/// wide with the origin's z in the middle.
pub fn stairs(steps: u32, rise: f64, run: f64, width: f64) -> Result<Mesh, MeshError> {
    let tread = |step: u32, x: u32| [f64::from(x) * run, f64::from(step + 1) * rise];
    let treads = (0..steps).flat_map(|step| [tread(step, step), tread(step, step + 1)]);
    let mut outline = vec![[f64::from(steps) * run, 0.0], [0.0, 0.0]];
    outline.extend(treads);
    let mut builder = MeshBuilder::default();
    let on_side = |[x, y]: [f64; 2], side: f64| DVec3::new(x, y, side * width / 2.0);
    for (index, from) in outline.iter().enumerate() {
        let to = outline[(index + 1) % outline.len()];
        add_quad(&mut builder, [on_side(*from, 1.0), on_side(to, 1.0), on_side(to, -1.0), on_side(*from, -1.0)]);
    }
    // The lowest corner at the back sees the whole outline, which runs clockwise seen from +z.
    for pair in outline[1..].windows(2) {
        add_triangle(&mut builder, [outline[0], pair[1], pair[0]].map(|point| on_side(point, 1.0)));
        add_triangle(&mut builder, [outline[0], pair[0], pair[1]].map(|point| on_side(point, -1.0)));
    }
    builder.build()
}

/// Returns a closed upright plate with openings: its faces are cut into a grid by the lines at `xs` and `ys`, both
/// rising, and the cells that `is_open(column, row)` names are left out. `thickness` along z, the origin's z in the
/// middle.
pub fn plate(
    xs: &[f64],
    ys: &[f64],
    thickness: f64,
    is_open: impl Fn(usize, usize) -> bool,
) -> Result<Mesh, MeshError> {
    let corner = |x: usize, y: usize, side: f64| DVec3::new(xs[x], ys[y], side * thickness / 2.0);
    let [columns, rows] = [xs, ys].map(|lines| lines.len().saturating_sub(1));
    let is_solid = |column: Option<usize>, row: Option<usize>| {
        column.zip(row).is_some_and(|(x, y)| x < columns && y < rows && !is_open(x, y))
    };
    let mut builder = MeshBuilder::default();
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        if is_open(x, y) {
            continue;
        }
        let around = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        add_quad(&mut builder, around.map(|(x, y)| corner(x, y, 1.0)));
        add_quad(&mut builder, [0, 3, 2, 1].map(|at| corner(around[at].0, around[at].1, -1.0)));
        // Below, right, above, left: where no solid follows, the plate has an edge.
        let neighbours =
            [(Some(x), y.checked_sub(1)), (Some(x + 1), Some(y)), (Some(x), Some(y + 1)), (x.checked_sub(1), Some(y))];
        for (side, (column, row)) in neighbours.into_iter().enumerate() {
            let [from, to] = [around[side], around[(side + 1) % 4]];
            if !is_solid(column, row) {
                let along = [(from, 1.0), (from, -1.0), (to, -1.0), (to, 1.0)];
                add_quad(&mut builder, along.map(|((x, y), side)| corner(x, y, side)));
            }
        }
    }
    builder.build()
}

/// Returns a tube around a path in a plane of constant z, with its radius at each point; both ends are open. It has
/// `around` segments, of which the first faces +z; the path needs two points at least.
pub fn tube(path: &[(DVec3, f64)], around: u32) -> Result<Mesh, MeshError> {
    let mut builder = MeshBuilder::default();
    for (index, (point, radius)) in path.iter().enumerate() {
        let before = path[index.saturating_sub(1)].0;
        let after = path[(index + 1).min(path.len() - 1)].0;
        let outward = (after - before).normalize_or_zero().cross(DVec3::Z);
        builder.positions.extend((0..around).map(|step| {
            let (sin, cos) = angle::sin_cos(TAU * f64::from(step) / f64::from(around));
            *point + (DVec3::Z * cos + outward * sin) * *radius
        }));
    }
    let vertex = |ring: u32, step: u32| ring * around + step % around;
    for (ring, step) in (1..path.len() as u32).flat_map(|ring| (0..around).map(move |step| (ring, step))) {
        let [a, b] = [vertex(ring - 1, step), vertex(ring - 1, step + 1)];
        let [c, d] = [vertex(ring, step + 1), vertex(ring, step)];
        builder.triangles.extend([[a, b, c], [a, c, d]]);
    }
    builder.build()
}

/// Returns several meshes as one, each moved by an offset. Bit-equal vertices are joined; normals, texture coordinates
/// and groups are dropped.
pub fn joined<'a>(parts: impl IntoIterator<Item = (&'a Mesh, DVec3)>) -> Result<Mesh, MeshError> {
    let mut builder = MeshBuilder::default();
    for (mesh, offset) in parts {
        let first = builder.positions.len() as u32;
        builder.positions.extend(mesh.positions().iter().map(|position| *position + offset));
        builder.triangles.extend(mesh.triangles().iter().map(|corners| corners.map(|vertex| first + vertex)));
    }
    builder.build()
}

/// Returns a mesh of these points and triangles, as indices into the points; without normals.
pub fn triangles(points: &[[f64; 3]], indices: &[[u32; 3]]) -> Result<Mesh, MeshError> {
    let positions = points.iter().map(|point| DVec3::from_array(*point)).collect();
    MeshBuilder { positions, triangles: indices.to_vec(), ..MeshBuilder::default() }.build()
}

/// Adds a quad with corners counter-clockwise; equal ones are welded when the mesh is built.
fn add_quad(builder: &mut MeshBuilder, [a, b, c, d]: [DVec3; 4]) {
    add_triangle(builder, [a, b, c]);
    add_triangle(builder, [a, c, d]);
}

fn add_triangle(builder: &mut MeshBuilder, corners: [DVec3; 3]) {
    let first = builder.positions.len() as u32;
    builder.positions.extend(corners);
    builder.triangles.push([first, first + 1, first + 2]);
}

fn cuboid_builder(size: [f64; 3]) -> MeshBuilder {
    let half = DVec3::from_array(size) / 2.0;
    // Bit 0, 1 and 2 of a corner's number: on the high side in x, y and z.
    let side = |corner: u32, axis: u32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let positions = (0..8).map(|corner| half * DVec3::new(side(corner, 0), side(corner, 1), side(corner, 2)));
    let faces = [[0, 4, 6, 2], [5, 1, 3, 7], [0, 1, 5, 4], [6, 7, 3, 2], [1, 0, 2, 3], [4, 5, 7, 6]];
    MeshBuilder {
        positions: positions.collect(),
        triangles: faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..MeshBuilder::default()
    }
}

/// The vertices of one profile point at all steps around the axis.
struct VertexRing {
    first: u32,
    count: u32,
}

impl VertexRing {
    fn new(point: DVec2, around: u32, positions: &mut Vec<DVec3>) -> VertexRing {
        let count = if point.x == 0.0 { 1 } else { around };
        let first = positions.len() as u32;
        positions.extend((0..count).map(|step| {
            let (sin, cos) = angle::sin_cos(TAU * f64::from(step) / f64::from(around));
            DVec3::new(point.x * sin, point.y, point.x * cos)
        }));
        VertexRing { first, count }
    }

    fn is_pole(&self) -> bool {
        self.count == 1
    }

    fn vertex(&self, step: u32) -> u32 {
        self.first + step % self.count
    }
}
