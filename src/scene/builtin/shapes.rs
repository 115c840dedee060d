//! Shapes by their parameters, as meshes.
//!
//! Closed shapes are watertight and face outward: corners run counter-clockwise seen from
//! outside. Poles and seams are shared vertices, not equal ones. Round shapes are turned
//! profiles: a line in the half-plane (radius, height), followed so that the solid is on its
//! left, carried around the y axis.

use crate::scene::{Mesh, MeshBuilder, MeshError};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A level rectangle around the origin that faces up, `size` along x and z.
///
/// # Errors
/// As [`MeshBuilder::build`], for sizes that are not finite; so for all shapes.
pub fn quad(size: [f64; 2]) -> Result<Mesh, MeshError> {
    let [x, z] = size.map(|n| n / 2.0);
    triangles(vec![[-x, 0.0, z], [x, 0.0, z], [x, 0.0, -z], [-x, 0.0, -z]], vec![[0, 1, 2], [0, 2, 3]])
}

/// A closed box around the origin.
///
/// # Errors
/// As [`quad`].
pub fn cuboid(size: [f64; 3]) -> Result<Mesh, MeshError> {
    cuboid_builder(size).build()
}

/// A box around the origin seen from inside: a room.
///
/// # Errors
/// As [`quad`].
pub fn room(size: [f64; 3]) -> Result<Mesh, MeshError> {
    let mut builder = cuboid_builder(size);
    builder.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    builder.build()
}

/// A closed ball around the origin, `around` segments along the equator and `rings` from pole to pole.
///
/// # Errors
/// As [`quad`].
pub fn sphere(radius: f64, around: u32, rings: u32) -> Result<Mesh, MeshError> {
    let latitude = |ring: u32| PI * (f64::from(ring) / f64::from(rings) - 0.5);
    let between = (1..rings).map(latitude).map(|angle| DVec2::from_angle(angle) * radius);
    let mut profile = vec![DVec2::new(0.0, -radius)];
    profile.extend(between);
    profile.push(DVec2::new(0.0, radius));
    revolve(&profile, false, around)
}

/// A closed ring around the y axis: its tube's radius is `minor`, and the tube's middle runs
/// `major` from the axis.
///
/// # Errors
/// As [`quad`].
pub fn torus(major: f64, minor: f64, around: u32, along_tube: u32) -> Result<Mesh, MeshError> {
    let angle = |step: u32| TAU * f64::from(step) / f64::from(along_tube);
    let profile: Vec<DVec2> =
        (0..along_tube).map(|step| DVec2::new(major, 0.0) + DVec2::from_angle(angle(step)) * minor).collect();
    revolve(&profile, true, around)
}

/// A closed regular tetrahedron around the origin with its corners `radius` away, one of them up.
///
/// # Errors
/// As [`quad`].
pub fn tetrahedron(radius: f64) -> Result<Mesh, MeshError> {
    let base_radius = radius * 8f64.sqrt() / 3.0;
    let base = (0..3).map(|corner| {
        let (sin, cos) = (TAU * f64::from(corner) / 3.0).sin_cos();
        [base_radius * sin, -radius / 3.0, base_radius * cos]
    });
    let mut positions: Vec<[f64; 3]> = base.collect();
    positions.push([0.0, radius, 0.0]);
    triangles(positions, vec![[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
}

/// A closed upright cylinder around the origin.
///
/// # Errors
/// As [`quad`].
pub fn cylinder(radius: f64, height: f64, around: u32) -> Result<Mesh, MeshError> {
    let half = height / 2.0;
    let profile = [[0.0, -half], [radius, -half], [radius, half], [0.0, half]].map(DVec2::from_array);
    revolve(&profile, false, around)
}

/// A profile of (radius, height) points turned around the y axis in `around` steps; `closed`
/// joins its last point to the first. Points on the axis are poles. The surface faces right of
/// the profile.
///
/// # Errors
/// As [`quad`].
pub fn revolve(profile: &[DVec2], closed: bool, around: u32) -> Result<Mesh, MeshError> {
    let mut builder = MeshBuilder::default();
    let rings: Vec<Ring> = profile.iter().map(|point| Ring::new(*point, around, &mut builder.positions)).collect();
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

/// Points and triangles as given.
///
/// # Errors
/// As [`MeshBuilder::build`].
pub fn triangles(points: Vec<[f64; 3]>, indices: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
    let positions = points.into_iter().map(DVec3::from_array).collect();
    MeshBuilder { positions, triangles: indices, ..MeshBuilder::default() }.build()
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

/// The vertices of one profile point on its way around the axis.
struct Ring {
    first: u32,
    count: u32,
}

impl Ring {
    fn new(point: DVec2, around: u32, positions: &mut Vec<DVec3>) -> Ring {
        let count = if point.x == 0.0 { 1 } else { around };
        let first = positions.len() as u32;
        positions.extend((0..count).map(|step| {
            let (sin, cos) = (TAU * f64::from(step) / f64::from(around)).sin_cos();
            DVec3::new(point.x * sin, point.y, point.x * cos)
        }));
        Ring { first, count }
    }

    fn is_pole(&self) -> bool {
        self.count == 1
    }

    fn vertex(&self, step: u32) -> u32 {
        self.first + step % self.count
    }
}
