//! What rounding to 24 bits affects: the middle of a seam, and the ends of very long edges.

use crate::math::angle;
use crate::scene::{Camera, Light, MeshError, Object, Scene, shapes};
use crate::stress::cases::stage::{floor, scene};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, KnownFailure, StressCase};
use crate::technique::Technique;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A hole in a seam between sides: each seam is rounded by itself, and by chance a tenth of them have one.
const HOLE: KnownFailure = fails(
    Z_FAIL,
    "f32-limit",
    "two sides meet the floor in the middle of a pixel, as near as positions are rounded: each is counted or not by chance",
)
.at(|pixels| pixels <= 1e-4)
.at_most(0.001);

/// The sweep in which the seams of two touching sheets' shadows come nearer to the centres of pixels, where rounding
/// leaves holes. Techniques with texels are left out.
pub const SEAM: StressCase = StressCase {
    name: "seam",
    lesson: "two sheets that touch, turned and raised in a hundred ways, and seams of their shadows that come to the middles \
             of pixels: the seam is dark on both sides, and rounding leaves holes in it",
    parameter: "pixels from the middle",
    values: &[0.1, 0.01, 1e-3, 1e-4, 1e-5, 0.0],
    drives: CaseNumber::Scene(seams),
    without: &[
        (Technique::ShadowMap, "a texel is wider than a seam: `map-size` shows that"),
        (Technique::PlanarTexture, "a texel is wider than a seam"),
        (Technique::Projective, "a texel is wider than a seam"),
    ],
    // Sides that end below the floor are shorter, and their far corners round less.
    failures: &[HOLE, HOLE.of(AUTO).at(|pixels| pixels <= 1e-5), HOLE.of(Z_PASS), HOLE.of(Z_PASS_PLUS)],
    ..PLAIN
};

fn seams(pixels: f64) -> Result<Scene, MeshError> {
    const SIZE: DVec2 = DVec2::new(320.0, 240.0);
    let (eye, target, lamp) = ([0.3, 3.1, 4.2], [0.0; 3], DVec3::new(1.3, 6.1, 0.7));
    let camera = Camera::looking(eye, target);
    let rays = camera.rays(SIZE.x / SIZE.y);
    let mut sheets = [Vec::new(), Vec::new()];
    let places = (0..20).flat_map(|column| {
        (0..11).map(move |row| DVec2::new(20.5, 70.5) + DVec2::new(column as f64, row as f64) * 14.0)
    });
    for (index, middle) in places.enumerate() {
        // Spread evenly, and no two alike.
        let [turn, height, tilt] =
            [0.754_877_666, 0.569_840_291, 0.618_033_989].map(|step: f64| (step * index as f64).fract());
        let along = DVec3::new(angle::cos(turn * PI), 0.0, angle::sin(turn * PI));
        let across = along.cross(DVec3::Y);
        let way = rays.through((middle / SIZE * 2.0 - 1.0) * DVec2::new(1.0, -1.0)).along;
        let width = 2.0 * camera.half_height_at(-camera.eye.y / way.y) / SIZE.y;
        let seen = camera.eye - way * (camera.eye.y / way.y) + across * (pixels * width);
        // Between the visible point and the lamp, so that the shadow falls there.
        let raised = |on_floor: DVec3, part: f64| on_floor.lerp(lamp, part);
        let part = 0.03 + 0.27 * height;
        let seam = [raised(seen - along * 0.03, part + 0.02 * tilt), raised(seen + along * 0.03, part)];
        let [first, second] = [1.0, -1.0].map(|side| raised(seen + across * (side * 0.04), part));
        sheets[0].extend([seam[0], seam[1], first]);
        sheets[1].extend([seam[1], seam[0], second]);
    }
    let object = |(name, points): (&str, Vec<DVec3>)| {
        let points: Vec<[f64; 3]> = points.into_iter().map(Into::into).collect();
        let triangles: Vec<[u32; 3]> =
            (0..points.len() as u32 / 3).map(|first| [0, 1, 2].map(|corner| first * 3 + corner)).collect();
        Ok(Object::of(name, shapes::triangles(&points, &triangles)?).unseen())
    };
    let objects = ["left", "right"].into_iter().zip(sheets).map(object);
    let objects = std::iter::once(floor(9.0)).chain(objects).collect::<Result<_, MeshError>>()?;
    Ok(scene(eye, target, Light::point(lamp), objects))
}

/// The sweep in which strips over a floor get longer, from 10 metres to ten thousand kilometres. A GPU that cuts them at the
/// picture's border rounds by their length; cut before it sees them, they are right. Techniques with texels are left out.
pub const LONG_EDGE: StressCase = StressCase {
    name: "long-edge",
    lesson: "strips over a floor under a near lamp, longer and longer: cut where the picture ends, before a GPU rounds by \
             their length",
    parameter: "metres",
    values: &[10.0, 1e3, 1e4, 1e6, 1e7],
    drives: CaseNumber::Scene(|metres| {
        let half = metres / 2.0;
        let strip = |index: u32| {
            let front = -2.0 + 0.5 * f64::from(index);
            [[-half, front], [half, front], [half, front + 0.2], [-half, front + 0.2]].map(|[x, z]| [x, 1.0, z])
        };
        let points: Vec<[f64; 3]> = (0..8).flat_map(strip).collect();
        let triangles: Vec<[u32; 3]> = (0..8)
            .flat_map(|index| [[0, 1, 2], [0, 2, 3]].map(|corners| corners.map(|corner| 4 * index + corner)))
            .collect();
        let strips = Object::of("strips", shapes::triangles(&points, &triangles)?);
        Ok(scene([0.0, 3.0, 6.0], [0.0; 3], Light::point([0.3, 1.5, 0.1]), vec![floor(1.2 * half.max(10.0))?, strips]))
    }),
    without: &[
        (Technique::ShadowMap, "no map has texels for a strip of kilometres"),
        (Technique::PlanarTexture, "no texture has texels for a strip of kilometres"),
        (Technique::Projective, "no silhouette has texels for a strip of kilometres"),
    ],
    ..PLAIN
};
