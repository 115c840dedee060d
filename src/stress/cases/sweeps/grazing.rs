//! Light at grazing angles.

use crate::math::angle;
use crate::scene::{Light, MeshError, Object, Scene, shapes};
use crate::stress::cases::stage::{floor, scene, still_life};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, KnownFailure, StressCase};
use glam::DVec3;

/// The sweep in which a directional light sinks towards the floor's plane, from 10 degrees to 1e-4.
pub const GRAZING: StressCase = StressCase {
    name: "grazing",
    lesson: "the light sinks towards the floor's plane: shadows grow without end, and a bias without limit",
    parameter: "degrees above the floor",
    values: &[10.0, 3.0, 1.0, 1e-1, 1e-2, 1e-3, 1e-4],
    drives: CaseNumber::Scene(|degrees| {
        let (sin, cos) = angle::sin_cos(degrees.to_radians());
        let mut scene = still_life()?;
        scene.lights = vec![Light::directional(DVec3::new(0.8 * cos, sin, 0.6 * cos))];
        scene.objects[1].pose.translate.y = 0.3;
        Ok(scene)
    }),
    also: &[UNBIASED, DETACHED, BY_VERTEX_SHADER],
    failures: &[
        fails(MAP, "acne", "a texel of the map spans metres of the floor, and its bias is no longer enough")
            .at(|degrees| (5e-4..=0.1).contains(&degrees))
            .is_false()
            .at_most(0.03),
        fails(MAP, "peter-panning", "a bias that grows with the slope carries the shadow away altogether")
            .at(|degrees| degrees < 5e-4)
            .is_missing()
            .at_most(0.03),
        ACNE.at(|degrees| degrees > 5e-4).is_false(),
        ACNE.is_mixed(),
        fails(DETACHED, "peter-panning", "a bias that large carries the shadow away from what throws it").at_most(0.03),
        BETWEEN.at(|degrees| degrees <= 0.1).at_most(0.36),
    ],
    ..PLAIN
};

const ACNE: KnownFailure =
    fails(UNBIASED, "acne", "without a bias every surface is as deep as its own texels, and half of them are nearer")
        .at_most(0.06);

/// The sweep in which the sun sinks towards a floor with a board just over it that is not drawn, so that the shadow's
/// edge falls where light grazes.
pub const GRAZING_EDGE: StressCase = StressCase {
    name: "grazing-edge",
    lesson: "the sun sinks towards a floor with a board just over it: the shadow's edge falls where light grazes",
    parameter: "degrees above the floor",
    values: &[10.0, 1.0, 1e-1, 3e-2, 1e-2, 1e-3, 3e-4, 1e-4],
    drives: CaseNumber::Scene(|degrees| beside_a_board(degrees, Object::unseen)),
    failures: &of_volumes::<4, 19>(
        [
            SUNK.at(|degrees| degrees < 2e-4).at_most(0.043),
            SUNK.at(|degrees| degrees < 5e-4).at_most(0.009),
            SUNK.at_most(0.004),
            SINKING,
        ],
        [SPREAD, SPREAD.of(TEXTURE), SPREAD.of(SILHOUETTE)],
    ),
    ..PLAIN
};

/// Returns a scene with a board whose shadow begins two metres from it at any height of the sun: the lower the sun (in
/// degrees over the floor), the lower the board. `form` changes the board.
fn beside_a_board(degrees: f64, form: fn(Object) -> Object) -> Result<Scene, MeshError> {
    let slope = angle::tan(degrees.to_radians());
    let board = form(Object::of("board", shapes::quad([2.0, 1.0])?).at([0.0, 2.0 * slope, 1.5]));
    let sun = Light::directional(DVec3::new(0.0, slope, 1.0));
    Ok(scene([0.3, 2.0, 4.0], [0.0; 3], sun, vec![floor(3.0)?, board]))
}

/// The same sweep as [`GRAZING_EDGE`] with the board drawn, whose depth is as near to the floor's as the light is low.
pub const GRAZING_BOARD: StressCase = StressCase {
    name: "grazing-board",
    lesson: "the same with the board in view: it has a depth of its own, as near to the floor's as the light is low",
    drives: CaseNumber::Scene(|degrees| beside_a_board(degrees, |board| board)),
    failures: &of_volumes::<5, 23>(
        [
            SUNK.at(|degrees| degrees < 2e-4).at_most(0.2),
            SUNK.at(|degrees| degrees < 5e-4).at_most(0.048),
            SUNK.at_most(0.018),
            SINKING.at(|degrees| degrees < 0.05).at_most(0.0012),
            SINKING,
        ],
        [
            fails(MAP, "acne", "a texel of the map spans metres of the board, and its bias is no longer enough")
                .at(|degrees| degrees < 5e-3)
                .is_mixed()
                .at_most(0.2),
            SPREAD.of(TEXTURE),
            SPREAD.of(SILHOUETTE),
        ],
    ),
    ..GRAZING_EDGE
};

/// Returns the failures `alike` once for each of z-fail, auto, z-pass and z-pass-plus, followed by the `others`. `ALL`
/// must be `4 * N + 3`.
const fn of_volumes<const N: usize, const ALL: usize>(
    alike: [KnownFailure; N],
    others: [KnownFailure; 3],
) -> [KnownFailure; ALL] {
    let volumes = [Z_FAIL, AUTO, Z_PASS, Z_PASS_PLUS];
    let mut all = [others[0]; ALL];
    let mut index = 0;
    while index < 4 * N {
        all[index] = alike[index % N].of(volumes[index / N]);
        index += 1;
    }
    while index < ALL {
        all[index] = others[index - 4 * N];
        index += 1;
    }
    all
}

/// Texels whose image on the floor is spread over metres: under the lowest light it is kilometres long.
const SPREAD: KnownFailure = fails(MAP, "aliasing", "what lies within a texel of the edge is metres of the floor")
    .at(|degrees| degrees < 5e-4)
    .at_most(0.02)
    .perhaps();

/// It shows sooner than the specification allows, which is within 1e-5 degrees. Seen from here, a step of depth on the
/// floor is 2e-7 m of height. Under a light of a thousandth of a degree that moves the shadow's edge by a centimetre:
/// half a pixel of 240 rows, two of 720. No volume can be more exact than the depth that it is compared with.
const SUNK: KnownFailure = fails(Z_FAIL, "f32-limit", "a step of depth moves the shadow's edge by more than a pixel")
    .at(|degrees| degrees < 5e-3)
    .is_mixed();

/// The failure [`SUNK`] where the light is higher: it is a small part of a pixel and shows in larger pictures only.
const SINKING: KnownFailure =
    fails(Z_FAIL, "f32-limit", "several steps of depth, as sides and floor round apart, are part of a pixel")
        .at(|degrees| degrees < 0.2)
        .at_most(0.0001)
        .perhaps();
