//! The near plane through casters and volumes.

use crate::scene::{Light, Mesh, MeshError, Object, shapes};
use crate::stress::cases::extremes::under_a_roof;
use crate::stress::cases::stage::{floor, scene};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, KnownFailure, StressCase};
use crate::technique::Technique;

/// Fifty distances of the near plane, from before the box to behind it, metres.
const NEAR_STEPS: [f64; 50] = {
    let mut steps = [0.0; 50];
    let mut index = 0;
    while index < steps.len() {
        steps[index] = 0.5 + index as f64 * 0.04;
        index += 1;
    }
    steps
};

/// The sweep in which the near plane moves through an undrawn caster and its volume, as a motion. Techniques that don't
/// know the near plane are left out.
pub const NEAR_PLANE: StressCase = StressCase {
    name: "near-plane",
    lesson: "the near plane moves through a caster and its volume: what it cuts away z-pass does not count",
    parameter: "near in metres",
    values: &NEAR_STEPS,
    drives: CaseNumber::Motion(|near| {
        let roof = Object::of("roof", corrugated()?).at([0.0, 1.0, 1.2]).unseen();
        let mut scene = scene([0.0, 1.2, 3.0], [0.0, 0.6, 0.0], Light::point([0.2, 2.6, 2.2]), vec![floor(3.0)?, roof]);
        scene.camera.near = near;
        Ok(scene)
    }),
    without: &[
        (Technique::ShadowMap, "it does not know the near plane"),
        (Technique::Planar, "it does not know the near plane"),
        (Technique::PlanarTexture, "it does not know the near plane"),
        (Technique::Projective, "it does not know the near plane"),
    ],
    also: &[EYE_COUNT],
    failures: &[
        CUT_BY_NEAR.at(|near| near > ROOF_BEGINS && near < 1.6).at_most(0.42),
        CUT_BY_NEAR.at(|near| near > ROOF_BEGINS).is_mixed().at_most(0.9),
        CUT_BY_NEAR.at(|near| near > ROOF_BEGINS && near < 1.6).at_most(0.42).of(EYE_COUNT),
        CUT_BY_NEAR.at(|near| near > ROOF_BEGINS).is_mixed().at_most(0.9).of(EYE_COUNT),
        CRACK.at(|near| near > ROOF_BEGINS && near < ROOF_ENDS),
        // The floor casts too, and the plane cuts it from 2 metres on: along one line, so it need not show.
        CRACK.at(|near| near > ROOF_ENDS).perhaps(),
    ],
    ..PLAIN
};

/// Approximate nearest and farthest depth of the roof, metres.
const ROOF_BEGINS: f64 = 1.44;
const ROOF_ENDS: f64 = 2.16;

const CRACK: KnownFailure = fails(
    Z_PASS_PLUS,
    "near-plane-crack",
    "the light's view and the camera's cut a caster along one line, and round it apart",
)
.at_most(0.0007);

/// Returns a sheet 1.2 metres wide in 160 folds along z: a plane across them cuts it along a long zigzag line, and
/// cracks are single pixels of it.
fn corrugated() -> Result<Mesh, MeshError> {
    let (folds, parts) = (160, 8);
    let at = |fold: u32, part: u32| {
        let x = f64::from(fold) / f64::from(folds) - 0.5;
        [1.2 * x, if fold.is_multiple_of(2) { -0.1 } else { 0.1 }, 0.4 - 0.8 * f64::from(part) / f64::from(parts)]
    };
    let points: Vec<[f64; 3]> = (0..=folds).flat_map(|fold| (0..=parts).map(move |part| at(fold, part))).collect();
    let quads = (0..folds).flat_map(|fold| (0..parts).map(move |part| fold * (parts + 1) + part));
    let triangles = quads.flat_map(|a| {
        let b = a + parts + 1;
        [[a, b, b + 1], [a, b + 1, a + 1]]
    });
    shapes::triangles(&points, &triangles.collect::<Vec<_>>())
}

/// The sweep in which the eye stands in a roof's shadow and the near plane comes nearer to it, from 0.1 to 1e-6 metres.
pub const NEAR_IN_VOLUME: StressCase = StressCase {
    name: "near-in-volume",
    lesson: "the eye is in a roof's shadow, and the near plane comes to it: what is counted there gets small",
    parameter: "near in metres",
    values: &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6],
    drives: CaseNumber::Scene(|near| {
        let mut scene = under_a_roof()?;
        scene.camera.near = near;
        Ok(scene)
    }),
    also: &[EYE_COUNT],
    failures: &[
        CUT_BY_NEAR.is_mixed().at_most(0.999),
        ROUNDED.at(|near| near < 5e-6).at_most(0.18),
        ROUNDED.at(|near| near < 5e-5).at_most(0.03),
        ROUNDED.at(|near| near < 5e-4).at_most(0.006),
    ],
    ..PLAIN
};

/// Rounding in the light's view through the near rectangle: wrong pixels are ten times as many where the plane is ten
/// times as near.
const ROUNDED: KnownFailure = fails(
    Z_PASS_PLUS,
    "near-plane-rounding",
    "the smaller the near rectangle, the fewer bits tell the light's view where volumes cut it",
)
.is_mixed();
