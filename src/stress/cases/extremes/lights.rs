//! Extremes of where the light is, and of how many there are.

use super::ulps;
use crate::math::angle;
use crate::scene::{Light, MeshError, Object, Scene, shapes};
use crate::stress::cases::stage::{cuboid, floor, scene, still_life};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, KnownFailure, LeastShares, StressCase};
use glam::DVec3;
use std::f64::consts::TAU;

/// The stress cases with extreme lights.
pub const ALL: &[StressCase] = &[
    LIGHT_AT_SHEET,
    FLIPPED_SHEET,
    LAMP_AT_CEILING,
    LIGHT_IN_NEAR_PLANE,
    LIGHT_INSIDE_MESH,
    LIGHT_IN_TORUS_HOLE,
    LIGHT_IN_FACE_PLANE,
    LIGHT_ON_VERTEX,
    CASTER_AROUND_LIGHT,
    SUN_ALONG_RECEIVER,
    LIGHT_COUNT,
];

// Planar shadows fail here before the specification allows it, which is within 1e-5 degrees of a receiver's plane: the
// sheet is the caster. Its shadow's corners lie a thousand kilometres away, and are drawn as places on the floor, not
// as directions.
const LIGHT_AT_SHEET: StressCase = StressCase {
    name: "light-at-sheet",
    lesson: "the light is so near a sheet that its map's near plane passes it: the map sees through it",
    parameter: "distance in caster's sizes",
    values: &[1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7],
    drives: CaseNumber::Scene(|distance| {
        let sheet = Object::of("sheet", shapes::quad([0.8; 2])?).at([0.0, 1.0, 0.0]);
        let light = Light::point([0.1, 1.0 + 0.8 * distance, 0.15]);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], light, vec![floor(3.0)?, sheet]))
    }),
    least: |_| LeastShares { lit: 0.005, because: "only the sheet's top is lit", ..LeastShares::USUAL },
    also: &[BY_VERTEX_SHADER],
    failures: &[
        FACING_IN_F32.at(|distance| distance < 5e-6).at_most(0.1),
        NEARER_THAN_MAP.at(|distance| distance < 5e-7).at_most(0.99),
        FAR_CORNERS,
        ONE_MATRIX.at_most(0.99),
        NO_FIT,
    ],
    ..PLAIN
};

const NEARER_THAN_MAP: KnownFailure =
    fails(MAP, "map-near-plane", "it begins at a millionth of the scene: what is nearer to the light is not in it")
        .is_missing();

const FAR_CORNERS: KnownFailure =
    fails(PLANAR, "f32-limit", "a shadow of a thousand kilometres has corners that 24 bits can't place to a pixel")
        .at(|distance| distance < 5e-6)
        .is_missing()
        .at_most(0.004)
        .perhaps();

const ONE_MATRIX: KnownFailure = fails(
    TEXTURE,
    "f32-limit",
    "the sheet is thrown by one matrix, in which 24 bits no longer tell its height from the light's",
)
.at(|distance| distance < 5e-6)
.is_missing();

const FLIPPED_SHEET: StressCase = StressCase {
    name: "turned-sheet",
    lesson: "the same with the sheet turned: no coordinate of its corners or of the light is alike",
    drives: CaseNumber::Scene(|distance| {
        let sheet = Object::of("sheet", shapes::quad([0.8; 2])?).rotated([30.0, 0.0, 0.0]).at([0.0, 1.0, 0.0]);
        let over = angle::rotation(DVec3::X, 30.0_f64.to_radians()) * DVec3::new(0.1, 0.8 * distance, 0.15);
        let light = Light::point(DVec3::Y + over);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], light, vec![floor(3.0)?, sheet]))
    }),
    least: |_| LeastShares::USUAL,
    failures: &[
        // It computes that the light is in the sheet's plane, and then nothing casts.
        FACING_IN_F32.at(|distance| distance < 5e-7).is_missing().at_most(0.66),
        FACING_IN_F32.at(|distance| distance < 5e-6).at_most(0.03),
        NEARER_THAN_MAP.at(|distance| distance < 5e-7).at_most(0.62),
        NEARER_THAN_MAP.at(|distance| distance < 5e-6).at_most(0.1),
        fails(MAP, "aliasing", "the sheet's edge is a few texels from where the map begins")
            .at(|distance| distance < 5e-4)
            .is_missing()
            .at_most(0.007)
            .perhaps(),
        FAR_CORNERS,
        ONE_MATRIX.at_most(0.62),
        NO_FIT,
    ],
    ..LIGHT_AT_SHEET
};

const LAMP_AT_CEILING: StressCase = StressCase {
    name: "lamp-at-ceiling",
    lesson: "inside a room, a lamp just under its ceiling: the room casts too, and is around eye and lamp",
    parameter: "metres below the ceiling",
    values: LIGHT_AT_SHEET.values,
    drives: CaseNumber::Scene(|distance| {
        let room = cuboid("room", [0.0, 1.5, 0.0], [6.0, 3.0, 6.0])?;
        let ring = Object::of("ring", shapes::torus(0.6, 0.25, 32, 16)?).at([0.0, 1.0, 0.0]);
        Ok(scene([1.5, 2.0, 2.8], [0.0, 0.6, 0.0], Light::point([0.3, 3.0 - distance, 0.2]), vec![room, ring]))
    }),
    ..PLAIN
};

const LIGHT_IN_NEAR_PLANE: StressCase = StressCase {
    name: "light-in-near-plane",
    lesson: "the light lies in the near plane and sees it as a line: who counts there from the light sees nothing",
    parameter: "ulps",
    values: &[-1.0, 0.0, 1.0],
    drives: CaseNumber::Scene(|steps| {
        // The eye at z = 4 has its near plane at z = 3; a board between it and the light crosses it.
        let board = Object::of("board", shapes::quad([0.6; 2])?).at([0.5, 2.0, 3.0]);
        let light = Light::point([1.0, 3.0, ulps(3.0, steps)]);
        let objects = vec![floor(3.0)?, cuboid("box", [0.0, 0.4, 0.0], [0.8; 3])?, board];
        let mut scene = scene([0.0, 1.0, 4.0], [0.0, 1.0, 0.0], light, objects);
        scene.camera.near = 1.0;
        Ok(scene)
    }),
    failures: &[
        // The board's volume contains the eye and is left once more than entered: −1 lights what the box alone darkens,
        // as that counts one.
        CUT_BY_NEAR.is_mixed().at_most(0.99),
        fails(
            Z_PASS_PLUS,
            "light-in-near-plane",
            "the light sees the near rectangle as a line, so what the eye is inside of is not counted",
        )
        .is_mixed()
        .at_most(0.99),
    ],
    ..PLAIN
};

const LIGHT_INSIDE_MESH: StressCase = StressCase {
    name: "light-inside-mesh",
    lesson: "the light is inside a closed mesh: all outside is dark, though no outer face is turned to the light",
    drives: CaseNumber::Scene(|_| {
        let mut scene = still_life()?;
        scene.lights = vec![Light::point([0.1, 0.85, 0.05])];
        Ok(scene)
    }),
    also: &[LIGHT_FACING, ALL_CAST, BY_VERTEX_SHADER],
    least: |_| LeastShares::all_dark("outside the mesh all is dark"),
    failures: &[
        CUT_BY_NEAR.is_missing().at_most(0.999),
        NO_FIT,
        fails(LIGHT_FACING, "light-facing-inside", "from inside, no outer face is turned to the light: nothing casts")
            .is_missing()
            .at_most(0.999),
    ],
    ..PLAIN
};

const LIGHT_IN_TORUS_HOLE: StressCase = StressCase {
    name: "light-in-torus-hole",
    lesson: "the light is in a ring's hole: outside the mesh, with the mesh all around",
    drives: CaseNumber::Scene(|_| {
        let ring = Object::of("ring", shapes::torus(0.7, 0.2, 24, 12)?).at([0.0, 0.8, 0.0]);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([0.05, 0.85, 0.0]), vec![floor(3.0)?, ring]))
    }),
    also: &[LIGHT_FACING],
    failures: &[NO_FIT],
    ..PLAIN
};

const LIGHT_IN_FACE_PLANE: StressCase = StressCase {
    name: "light-in-face-plane",
    lesson: "the light lies in the plane of a box's top, and a last bit above and below: which way does it face?",
    parameter: "ulps",
    values: &[-1.0, 0.0, 1.0],
    drives: CaseNumber::Scene(|steps| {
        let objects = vec![floor(3.0)?, cuboid("box", [0.0, 0.75, 0.0], [0.5; 3])?];
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([1.5, ulps(1.0, steps), 0.25]), objects))
    }),
    also: &[LIGHT_FACING, BY_VERTEX_SHADER],
    failures: &[FACING_IN_F32.at(|step| step > 0.0).is_false().at_most(0.01)],
    ..PLAIN
};

const LIGHT_ON_VERTEX: StressCase = StressCase {
    name: "light-on-vertex",
    lesson: "the light is on a corner of the box: the three faces there are edge-on and cast nothing, the others do",
    drives: CaseNumber::Scene(|_| {
        let objects = vec![floor(3.0)?, cuboid("box", [0.0, 0.75, 0.0], [0.5; 3])?];
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([0.25, 1.0, 0.25]), objects))
    }),
    failures: &[NO_FIT],
    ..PLAIN
};

const CASTER_AROUND_LIGHT: StressCase = StressCase {
    name: "caster-around-light",
    lesson: "a lamp shade around the light, open above and below: it is on every side, and behind the light too",
    drives: CaseNumber::Scene(|_| {
        let rim = |height: f64| (0..24).map(move |step| (f64::from(step) / 24.0 * TAU, height));
        let points: Vec<[f64; 3]> = rim(0.7)
            .chain(rim(1.1))
            .map(|(angle, height)| [0.5 * angle::cos(angle), height, 0.5 * angle::sin(angle)])
            .collect();
        let sides = (0..24_u32).flat_map(|a| {
            let b = (a + 1) % 24;
            [[a, a + 24, b + 24], [a, b + 24, b]]
        });
        let shade = Object::of("shade", shapes::triangles(&points, &sides.collect::<Vec<_>>())?);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([0.05, 0.95, 0.0]), vec![floor(3.0)?, shade]))
    }),
    also: &[LIGHT_FACING],
    failures: &[
        NO_FIT,
        fails(
            LIGHT_FACING,
            "light-facing-open",
            "the shade has only outer faces, and none of them is turned to the light",
        )
        .is_missing()
        .at_most(0.69),
    ],
    ..PLAIN
};

const SUN_ALONG_RECEIVER: StressCase = StressCase {
    name: "sun-along-receiver",
    lesson: "the sun shines level: the floor is edge-on and in no light, the wall behind the box has its shadow",
    drives: CaseNumber::Scene(|_| {
        let wall = Object::of("wall", shapes::quad([6.0, 3.0])?).rotated([90.0, 0.0, 0.0]).at([0.0, 1.5, -2.0]);
        let objects = vec![floor(3.0)?, wall, cuboid("box", [0.0, 0.8, 0.0], [0.8, 0.6, 0.8])?];
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::directional(DVec3::new(0.2, 0.0, 1.0)), objects))
    }),
    failures: &[BETWEEN.at_most(0.12)],
    ..PLAIN
};

const LIGHT_COUNT: StressCase = StressCase {
    name: "light-count",
    lesson: "none, one and sixteen lights: none must find in the stencil what another left there",
    parameter: "lights",
    values: &[0.0, 1.0, 16.0],
    drives: CaseNumber::Scene(ring_of_lights),
    least: |lights| {
        if lights == 0.0 { LeastShares::nothing("without a light nothing is lit or dark") } else { LeastShares::USUAL }
    },
    ..PLAIN
};

fn ring_of_lights(count: f64) -> Result<Scene, MeshError> {
    let mut scene = still_life()?;
    let place = |index: u32| {
        let (sin, cos) = angle::sin_cos(f64::from(index) / 16.0 * TAU);
        if index % 4 == 3 {
            Light::directional(DVec3::new(cos, 1.5, sin))
        } else {
            Light::point([2.0 * cos, 3.0 + 0.1 * f64::from(index), 2.0 * sin])
        }
    };
    scene.lights = (0..count as u32).map(place).collect();
    Ok(scene)
}
