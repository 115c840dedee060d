//! Extremes of where the eye and the near plane are.

use super::ulps;
use crate::scene::{Light, MeshError, Object, Scene, shapes};
use crate::stress::cases::stage::{cuboid, floor, scene, still_life};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, LeastShares, StressCase};
use glam::DVec3;

/// The stress cases with an extreme eye: its position or near plane.
pub const ALL: &[StressCase] =
    &[EYE_IN_VOLUME, EYE_ON_SIDE_PLANE, LIGHT_BEHIND_EYE, SKY_BEHIND_VOLUME, SUN_ALONG_VIEW, ONE_PIXEL, WIDE, TALL];

const EYE_IN_VOLUME: StressCase = StressCase {
    name: "eye-in-volume",
    lesson: "a roof over the eye: whoever counts from the eye on begins with a count that is not zero",
    drives: CaseNumber::Scene(|_| under_a_roof()),
    also: &[EYE_COUNT],
    failures: &[CUT_BY_NEAR.is_mixed().at_most(0.999)],
    ..PLAIN
};

/// Returns the scene of a box on a floor, and a roof whose shadow contains the eye.
pub fn under_a_roof() -> Result<Scene, MeshError> {
    let roof = Object::of("roof", shapes::quad([2.5; 2])?).at([1.3, 4.0, 3.2]);
    let objects = vec![floor(3.0)?, roof, cuboid("box", [0.0, 0.5, 0.0], [0.6; 3])?];
    Ok(scene([1.5, 2.0, 3.5], [0.0, 0.3, 0.0], Light::point([1.2, 6.0, 3.0]), objects))
}

const EYE_ON_SIDE_PLANE: StressCase = StressCase {
    name: "eye-on-side-plane",
    lesson: "the eye lies in a volume's side, to the last bit: it is seen as a line, and cut by the near plane",
    parameter: "ulps",
    values: &[-1.0, 0.0, 1.0],
    drives: CaseNumber::Scene(|steps| {
        // The light at height 4 carries the edge at x = 1, height 2, to x = 1.5 at the eye's height.
        let board = Object::of("board", shapes::quad([1.0, 2.0])?).at([0.5, 2.0, 0.0]);
        let eye = [ulps(1.5, steps), 1.0, 1.0];
        Ok(scene(eye, [-0.5, 0.0, -1.0], Light::point([0.0, 4.0, 0.0]), vec![floor(3.0)?, board]))
    }),
    failures: &[CUT_BY_NEAR.is_mixed().at_most(0.999)],
    ..PLAIN
};

const LIGHT_BEHIND_EYE: StressCase = StressCase {
    name: "light-behind-eye",
    lesson: "the light is behind the eye, and a caster between eye and near plane: it is not drawn, but casts",
    drives: CaseNumber::Scene(|_| {
        let board = Object::of("board", shapes::quad([0.3; 2])?).rotated([90.0, 0.0, 0.0]).at([0.1, 1.1, 3.5]);
        let wall = Object::of("wall", shapes::quad([6.0, 4.0])?).rotated([90.0, 0.0, 0.0]).at([0.0, 1.0, -2.0]);
        let mut scene =
            scene([0.0, 1.0, 4.0], [0.0, 1.0, 0.0], Light::point([0.2, 1.4, 8.0]), vec![floor(3.0)?, wall, board]);
        scene.camera.near = 1.0;
        Ok(scene)
    }),
    failures: &[CUT_BY_NEAR.is_mixed().at_most(0.3), BETWEEN.at_most(0.75)],
    ..PLAIN
};

const SKY_BEHIND_VOLUME: StressCase = StressCase {
    name: "sky-behind-volume",
    lesson: "pixels that show no surface lie behind volumes too: they are neither lit nor dark",
    drives: CaseNumber::Scene(|_| {
        let mut scene = still_life()?;
        scene.camera.target = scene.camera.eye + DVec3::new(-1.2, -0.55, -4.0);
        Ok(scene)
    }),
    also: &[TO_INFINITY],
    ..PLAIN
};

const SUN_ALONG_VIEW: StressCase = StressCase {
    name: "sun-along-view",
    lesson: "the sun shines along the view: every volume is seen from its end, every side edge-on in the middle",
    drives: CaseNumber::Scene(|_| {
        let mut scene = still_life()?;
        scene.lights = vec![Light::directional(scene.camera.eye - scene.camera.target)];
        Ok(scene)
    }),
    least: |_| LeastShares::all_lit("no shadow is seen from where the light comes"),
    ..PLAIN
};

const ONE_PIXEL: StressCase = StressCase {
    name: "one-pixel",
    lesson: "a picture of one pixel has neighbours on no side: it is dark, then lit",
    parameter: "lit",
    values: &[0.0, 1.0],
    drives: CaseNumber::Scene(|lit| {
        let mut scene = still_life()?;
        scene.camera.target = if lit > 0.0 { DVec3::new(2.0, 0.0, 1.0) } else { BOX_SHADOW };
        Ok(scene)
    }),
    size: Some([1, 1]),
    least: |lit| if lit > 0.0 { LeastShares::all_lit(ONLY_PIXEL) } else { LeastShares::all_dark(ONLY_PIXEL) },
    ..PLAIN
};

const ONLY_PIXEL: &str = "it is the only pixel";

/// The centre of the shadow on the still life's floor.
const BOX_SHADOW: DVec3 = DVec3::new(-0.25, 0.0, -0.375);

const WIDE: StressCase = StressCase {
    name: "wide-picture",
    lesson: "16384 × 1 pixels: the widest that there is, across a shadow's edges",
    drives: CaseNumber::Scene(|_| {
        let mut scene = still_life()?;
        scene.camera.target = BOX_SHADOW;
        // The picture is as high as one pixel; across, that is 60 degrees.
        scene.camera.fov_y_degrees = 0.004;
        Ok(scene)
    }),
    size: Some([16_384, 1]),
    ..PLAIN
};

const TALL: StressCase = StressCase {
    name: "tall-picture",
    lesson: "1 × 16384 pixels: one column, each pixel a sliver, across a shadow's edges",
    drives: CaseNumber::Scene(|_| {
        let mut scene = still_life()?;
        scene.camera.target = BOX_SHADOW;
        Ok(scene)
    }),
    size: Some([1, 16_384]),
    ..PLAIN
};
