//! Extremes of receivers: where they lie, and whether there are any.

use crate::scene::{Light, Object, shapes};
use crate::stress::cases::stage::{cuboid, floor, scene, still_life};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, LeastShares, StressCase};

/// The stress cases with extreme receivers.
pub const ALL: &[StressCase] =
    &[COPLANAR, ACROSS_LIGHT, THROUGH_FLOOR, BEHIND_PROJECTOR, SHELF_BETWEEN, ROUND_RECEIVER, NO_CASTER, NO_RECEIVER];

const COPLANAR: StressCase = StressCase {
    name: "coplanar",
    lesson: "a tile lies in the floor's plane, to the last bit: it darkens nothing, and does not fight",
    drives: CaseNumber::Scene(|_| {
        let tile = Object::of("tile", shapes::quad([1.3; 2])?).at([0.2, 0.0, 0.3]);
        let objects = vec![floor(3.0)?, tile, cuboid("box", [0.0, 1.0, 0.0], [0.5; 3])?];
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([1.0, 4.0, 1.5]), objects))
    }),
    ..PLAIN
};

const ACROSS_LIGHT: StressCase = StressCase {
    name: "across-light",
    lesson: "a wall reaches from below the light to above it: what is above must not be thrown on the floor",
    drives: CaseNumber::Scene(|_| {
        let wall = Object::of("wall", shapes::quad([1.0, 2.0])?).rotated([90.0, 0.0, 0.0]).at([0.0, 1.5, -0.3]);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([0.3, 1.7, 0.8]), vec![floor(3.0)?, wall]))
    }),
    also: &[UNCLIPPED],
    failures: &[fails(UNCLIPPED, "anti-shadow", "what is above the light is thrown through it, upside down")
        .is_mixed()
        .at_most(0.56)],
    ..PLAIN
};

const THROUGH_FLOOR: StressCase = StressCase {
    name: "through-floor",
    lesson: "a box stands in the floor, half of it below: what is below must not be thrown up on it",
    drives: CaseNumber::Scene(|_| {
        let objects = vec![floor(3.0)?, cuboid("box", [0.0, -0.4, 0.0], [0.6, 1.6, 0.6])?];
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([1.6, 1.5, 0.6]), objects))
    }),
    also: &[UNCLIPPED],
    failures: &[
        BETWEEN,
        fails(UNCLIPPED, "false-shadow", "what is below the floor is thrown up on it").is_false().at_most(0.065),
    ],
    ..PLAIN
};

const BEHIND_PROJECTOR: StressCase = StressCase {
    name: "behind-projector",
    lesson: "a wall behind the light: a slide's picture has a mirror image there unless q ≤ 0 is left out",
    drives: CaseNumber::Scene(|_| {
        let wall = Object::of("wall", shapes::quad([6.0, 3.0])?).rotated([90.0, 0.0, 0.0]).at([0.0, 1.5, -2.0]);
        let board = Object::of("board", shapes::quad([0.5; 2])?).rotated([90.0, 0.0, 0.0]).at([0.1, 1.3, 1.5]);
        Ok(scene([1.0, 3.0, 4.5], [0.0, 0.8, -1.0], Light::point([0.0, 1.2, 0.5]), vec![floor(3.0)?, wall, board]))
    }),
    also: &[REVERSED],
    least: |_| LeastShares::all_lit("the slide's shadow falls beyond the floor"),
    failures: &[fails(REVERSED, "reverse-projection", "behind the light, where q is negative, the slide shows again")
        .is_false()
        .at_most(0.08)],
    ..PLAIN
};

const SHELF_BETWEEN: StressCase = StressCase {
    name: "shelf-between",
    lesson: "a shelf stands between the light and a caster that is smaller: who compares no depth darkens the shelf",
    drives: CaseNumber::Scene(|_| {
        let shelf = Object::of("shelf", shapes::quad([1.2; 2])?).at([0.0, 1.4, 0.0]);
        let objects = vec![floor(3.0)?, shelf, cuboid("box", [0.1, 0.6, 0.1], [0.4; 3])?];
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([0.4, 4.0, 0.6]), objects))
    }),
    failures: &[BETWEEN.at_most(0.005), RECEIVER_LEFT_OUT],
    ..PLAIN
};

const ROUND_RECEIVER: StressCase = StressCase {
    name: "round-receiver",
    lesson: "a ring under a board: it is not flat, and it darkens itself",
    drives: CaseNumber::Scene(|_| {
        let ring = Object::of("ring", shapes::torus(0.6, 0.25, 32, 16)?).at([0.0, 0.5, 0.0]);
        let board = Object::of("board", shapes::quad([0.5, 0.9])?).at([0.4, 1.6, 0.0]);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([2.5, 3.0, 0.5]), vec![floor(3.0)?, ring, board]))
    }),
    also: &[LIGHT_FACING, ALL_CAST],
    failures: &[NOT_PLANAR, NOT_PLANAR_TEXTURE, BETWEEN.at_most(0.003)],
    ..PLAIN
};

const NO_CASTER: StressCase = StressCase {
    name: "no-caster",
    lesson: "nothing casts, and nothing is there to cast: all is lit",
    parameter: "objects",
    values: &[2.0, 0.0],
    drives: CaseNumber::Scene(|objects| {
        let mut scene = still_life()?;
        scene.objects.truncate(objects as usize);
        scene.objects.iter_mut().for_each(|object| object.casts = false);
        Ok(scene)
    }),
    least: |objects| match objects {
        0.0 => LeastShares::nothing("there is no surface"),
        _ => LeastShares::all_lit("nothing casts"),
    },
    ..PLAIN
};

const NO_RECEIVER: StressCase = StressCase {
    name: "no-receiver",
    lesson: "no surface receives, and none is drawn: volumes are counted and nobody asks",
    parameter: "drawn",
    values: &[1.0, 0.0],
    drives: CaseNumber::Scene(|drawn| {
        let mut scene = still_life()?;
        let apart = |object: &mut Object| {
            object.receives = false;
            object.visible = drawn > 0.0;
        };
        scene.objects.iter_mut().for_each(apart);
        Ok(scene)
    }),
    least: |drawn| match drawn {
        0.0 => LeastShares::nothing("no surface is drawn"),
        _ => LeastShares::all_lit("what does not receive is lit"),
    },
    ..PLAIN
};
