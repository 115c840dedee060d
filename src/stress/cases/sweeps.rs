//! Sweeps: how the error grows with one number.

use super::stage::{carried, cuboid, enlarged, floor, lamp, mesh, moved, object, scene, still_life, unseen};
use super::who::*;
use crate::scene::builtin::shapes;
use crate::scene::{Light, MeshError, Object};
use crate::stress::{Case, Drives};
use crate::technique::Technique;
use glam::DVec3;

/// All of them.
pub const ALL: &[Case] = &[
    NEAR_FAR,
    WORLD_OFFSET,
    WORLD_SCALE,
    LIGHT_CLOSE,
    LIGHT_FAR,
    GRAZING,
    SLIVER,
    NESTED,
    THIN_GAP,
    FINE_GRID,
    TRIANGLE_COUNT,
    MAP_SIZE,
    NEAR_PLANE,
    LIGHT_ORBIT,
];

// Two deviations from the specification's table. `near-far` and shadow maps: the map's near plane is
// fitted to what casts and not to the eye, so it is right here; its bias fails in `grazing`.
// `light-close` and shadow maps: what the map misses of the box's top, its bottom makes up for; the
// map's near plane shows in `light-at-sheet`. `light-far` and shadow maps: what fails is none of their
// usual failures, but the map's depth.

const NEAR_FAR: Case = Case {
    name: "near-far",
    lesson: "the near plane comes to the eye while far stays: depth that is not reversed runs out of bits",
    parameter: "far / near",
    values: &[1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9],
    drives: Drives::Scene(|ratio| {
        let mut scene = still_life()?;
        scene.camera.far = Some(20.0);
        scene.camera.near = 20.0 / ratio;
        Ok(scene)
    }),
    also: &[TO_INFINITY, FAR_CLIP, FAR_CLAMP],
    failures: &[
        fails(FAR_CLIP, "far-clip", "the far plane cuts dark caps away, so volumes are open behind the surface"),
        fails(FAR_CLAMP, "far-clip", "nothing is cut away, but surfaces and what is behind them round to one depth"),
        fails(TO_INFINITY, "depth-bits", "near 1 a float has 24 bits, and the far half of the scene shares one depth"),
        TEXELS_OF_TEXTURE,
    ],
    ..PLAIN
};

const WORLD_OFFSET: Case = Case {
    name: "world-offset",
    lesson: "the whole scene far from the origin: who rounds before the eye is subtracted loses it",
    parameter: "offset in metres",
    values: &[0.0, 1e2, 1e4, 1e5, 1e6, 1e7, 1e8],
    drives: Drives::Scene(|offset| Ok(carried(still_life()?, DVec3::new(1.0, 0.5, -0.25) * offset))),
    failures: &[TEXELS_OF_TEXTURE],
    ..PLAIN
};

const WORLD_SCALE: Case = Case {
    name: "world-scale",
    lesson: "the same scene as a grain of sand and as a continent: absolute tolerances show",
    parameter: "scale",
    values: &[1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6],
    drives: Drives::Scene(|factor| Ok(enlarged(still_life()?, factor))),
    failures: &[TEXELS_OF_TEXTURE],
    ..PLAIN
};

const LIGHT_CLOSE: Case = Case {
    name: "light-close",
    lesson: "the light comes to the caster's face: its volume opens to a half-space",
    parameter: "distance in caster's sizes",
    values: &[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7],
    drives: Drives::Scene(|distance| {
        let mut scene = still_life()?;
        scene.lights = vec![lamp(0.1, 1.1 + 0.8 * distance, 0.15)];
        Ok(scene)
    }),
    also: &[FINITE],
    failures: &[
        fails(FINITE, "finite-extrusion", "a vertex is carried by its distance to the light, which is next to nothing"),
        TEXELS_OF_TEXTURE,
        TEXELS_OF_SILHOUETTE,
    ],
    ..PLAIN
};

const LIGHT_FAR: Case = Case {
    name: "light-far",
    lesson: "a lamp goes away until it is a sun: one formula serves both",
    parameter: "distance in scene's sizes",
    values: &[1e1, 1e2, 1e3, 1e5, 1e7, 1e9],
    drives: Drives::Scene(|distance| {
        let mut scene = still_life()?;
        scene.lights = vec![Light::point(DVec3::new(0.2, 1.0, 0.4).normalize() * (6.0 * distance))];
        Ok(scene)
    }),
    failures: &[
        fails(MAP, "depth-bits", "seen from far away, all that casts is within a few steps of the map's depth"),
        TEXELS_OF_TEXTURE,
    ],
    ..PLAIN
};

const GRAZING: Case = Case {
    name: "grazing",
    lesson: "the light sinks towards the floor's plane: shadows grow without end, and a bias without limit",
    parameter: "degrees above the floor",
    values: &[10.0, 3.0, 1.0, 1e-1, 1e-2, 1e-3, 1e-4],
    drives: Drives::Scene(|degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut scene = still_life()?;
        scene.lights = vec![Light::directional(DVec3::new(0.8 * cos, sin, 0.6 * cos))];
        scene.objects[1].pose.translate.y = 0.3;
        Ok(scene)
    }),
    also: &[UNBIASED, DETACHED],
    failures: &[
        fails(MAP, "acne", "a texel of the map spans metres of the floor, and its bias is no longer enough"),
        fails(
            UNBIASED,
            "acne",
            "without a bias every surface is as deep as its own texels, and half of them are nearer",
        ),
        fails(DETACHED, "peter-panning", "a bias that large carries the shadow away from what throws it"),
        TEXELS_OF_TEXTURE,
        TEXELS_OF_SILHOUETTE,
    ],
    ..PLAIN
};

const SLIVER: Case = Case {
    name: "sliver",
    lesson: "triangles thinner and thinner: signs from exact arithmetic do not care",
    parameter: "aspect ratio",
    values: &[1.0, 1e1, 1e2, 1e4, 1e6, 1e8],
    drives: Drives::Scene(|aspect| {
        // A fan whose triangles share a line, each thin, all together a square metre.
        let thin = 1.0 / aspect;
        let points = [[-0.7, 0.0, -0.5], [0.7, 0.0, -0.5], [0.7, 0.0, -0.5 + thin], [-0.7, 0.0, 0.5], [0.7, 0.0, 0.5]];
        let fan = object("fan", mesh(&points, &[[0, 2, 1], [0, 3, 2], [2, 3, 4]])?);
        let caster = moved(fan, [0.0, 1.0, 0.0]);
        Ok(scene([0.5, 3.5, 4.5], [0.0, 0.3, 0.0], lamp(0.3, 4.0, 0.8), vec![floor(3.0)?, caster]))
    }),
    failures: &[TEXELS_OF_TEXTURE],
    ..PLAIN
};

const NESTED: Case = Case {
    name: "nested",
    lesson: "more and more volumes over the same pixels: eight bits read 256 as none",
    parameter: "volumes",
    values: &[1.0, 2.0, 100.0, 255.0, 256.0, 257.0, 512.0, 600.0],
    drives: Drives::Scene(|count| {
        let panes = (0..count as u32).map(|index| {
            let height = 0.5 + f64::from(index) * 0.002;
            Ok(unseen(moved(object(&format!("pane {}", index + 1), shapes::quad([0.8; 2])?), [0.0, height, 0.0])))
        });
        let mut objects = vec![floor(3.0)?];
        objects.extend(panes.collect::<Result<Vec<Object>, MeshError>>()?);
        Ok(scene([0.5, 3.5, 4.5], [0.0, 0.3, 0.0], lamp(0.1, 8.0, 0.2), objects))
    }),
    also: &[IN_FLOAT, CLAMPED, CLAMPED_IN_TURN],
    without: &[(Technique::Projective, "a silhouette of each of 600 casters does not fit into one texture array")],
    failures: &[
        fails(Z_FAIL, "wrap-256", "a count of 256 reads 0 in eight bits"),
        fails(Z_PASS, "wrap-256", "a count of 256 reads 0 in eight bits"),
        fails(Z_PASS_PLUS, "wrap-256", "a count of 256 reads 0 in eight bits"),
        fails(
            CLAMPED,
            "clamp",
            "what takes away first stops at 0, and what adds later is left: so wrap is the default",
        ),
        fails(CLAMPED_IN_TURN, "clamp", "what adds comes first, so it fails only where more than 255 are added"),
        TEXELS_OF_TEXTURE,
    ],
    ..PLAIN
};

const THIN_GAP: Case = Case {
    name: "thin-gap",
    lesson: "a slit of light between two boards closes: tolerant welding would close it first",
    parameter: "width in metres",
    values: &[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6],
    drives: Drives::Scene(|width| {
        let board = |name, side: f64| cuboid(name, [side * (0.8 + width / 2.0), 1.0, 0.0], [1.6, 0.1, 1.6]);
        let objects = vec![floor(3.0)?, unseen(board("left", -1.0)?), unseen(board("right", 1.0)?)];
        Ok(scene([0.0, 3.0, 4.0], [0.0, 0.0, 0.0], lamp(0.0, 3.0, 0.0), objects))
    }),
    failures: &[TEXELS_OF_MAP, TEXELS_OF_TEXTURE],
    ..PLAIN
};

const FINE_GRID: Case = Case {
    name: "fine-grid",
    lesson: "bars thinner than pixels: each technique samples the same points, but a map samples its own",
    parameter: "bar in pixels",
    values: &[10.0, 5.0, 2.0, 1.0, 0.5, 0.1],
    drives: Drives::Scene(|pixels| {
        // A pixel of 240 rows is about 0.02 m of the floor. A map of 1024 texels is finer than
        // that, and what it blurs lies within the edge band: the coarse one shows what maps do.
        let pitch = 0.04 * pixels;
        let count = (2.4 / pitch).ceil() as u32;
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for bar in 0..count {
            let left = (f64::from(bar) - f64::from(count) / 2.0) * pitch;
            let first = bar * 4;
            for [x, z] in [[left, 0.5], [left + pitch / 2.0, 0.5], [left + pitch / 2.0, -0.5], [left, -0.5]] {
                points.push([x, 0.0, z]);
            }
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        let grid = unseen(moved(object("grid", mesh(&points, &triangles)?), [0.0, 1.0, 0.0]));
        Ok(scene([0.0, 4.0, 3.0], [0.0, 0.0, 0.0], lamp(0.2, 5.0, 0.4), vec![floor(2.5)?, grid]))
    }),
    also: &[COARSE],
    failures: &[
        fails(COARSE, "aliasing", "a bar is thinner than a texel: the map has it, or has not"),
        TEXELS_OF_TEXTURE,
        TEXELS_OF_SILHOUETTE,
    ],
    ..PLAIN
};

const TRIANGLE_COUNT: Case = Case {
    name: "triangle-count",
    lesson: "the caster gets a million triangles: what grows, and how fast",
    parameter: "triangles",
    values: &[1e2, 1e3, 1e4, 1e5, 3e5, 1e6],
    drives: Drives::Scene(|triangles| {
        let rings = (triangles / 4.0).sqrt().round() as u32;
        let ball = moved(object("ball", shapes::sphere(0.6, 2 * rings, rings)?), [0.0, 1.0, 0.0]);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], lamp(1.0, 4.0, 1.5), vec![floor(3.0)?, ball]))
    }),
    timed: true,
    without: &[
        (Technique::Planar, "a ball's triangles are receivers by the thousand: not what it is for"),
        (Technique::PlanarTexture, "a ball's triangles are receivers by the thousand: not what it is for"),
    ],
    failures: &[TEXELS_OF_MAP],
    ..PLAIN
};

const MAP_SIZE: Case = Case {
    name: "map-size",
    lesson: "more texels: the error falls, and never to nothing",
    parameter: "texels a side",
    values: &[64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0, 4096.0],
    drives: Drives::Setting("size", still_life),
    without: &[
        (Technique::ZFail, "it has no map"),
        (Technique::ZPass, "it has no map"),
        (Technique::ZPassPlus, "it has no map"),
        (Technique::Planar, "it has no map"),
    ],
    failures: &[TEXELS_OF_MAP, TEXELS_OF_TEXTURE, TEXELS_OF_SILHOUETTE],
    ..PLAIN
};

/// Fifty places of the near plane, from before the box to behind it.
const NEAR_STEPS: [f64; 50] = {
    let mut steps = [0.0; 50];
    let mut index = 0;
    while index < steps.len() {
        steps[index] = 0.5 + index as f64 * 0.04;
        index += 1;
    }
    steps
};

const NEAR_PLANE: Case = Case {
    name: "near-plane",
    lesson: "the near plane moves through a caster and its volume: what it cuts away z-pass does not count",
    parameter: "near in metres",
    values: &NEAR_STEPS,
    drives: Drives::Motion(|near| {
        let objects = vec![floor(3.0)?, cuboid("box", [0.1, 1.1, 1.2], [0.5, 0.4, 0.5])?];
        let mut scene = scene([0.0, 1.2, 3.0], [0.0, 0.6, 0.0], lamp(0.2, 2.6, 2.2), objects);
        scene.camera.near = near;
        Ok(scene)
    }),
    without: &[
        (Technique::ShadowMap, "it does not know the near plane"),
        (Technique::Planar, "it does not know the near plane"),
        (Technique::PlanarTexture, "it does not know the near plane"),
        (Technique::Projective, "it does not know the near plane"),
    ],
    failures: &[
        CUT_BY_NEAR,
        fails(
            Z_PASS_PLUS,
            "near-plane-crack",
            "the light's view and the camera's cut a caster along one line, and round it apart",
        ),
    ],
    ..PLAIN
};

/// A thousand steps of the light, each far less than a pixel of its shadow.
const ORBIT_STEPS: [f64; 1000] = {
    let mut steps = [0.0; 1000];
    let mut index = 0;
    while index < steps.len() {
        steps[index] = index as f64 * 0.02;
        index += 1;
    }
    steps
};

const LIGHT_ORBIT: Case = Case {
    name: "light-orbit",
    lesson: "the light turns by fiftieths of a degree: no pixel may flicker that does not in truth",
    parameter: "degrees",
    values: &ORBIT_STEPS,
    drives: Drives::Motion(|degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let torus = moved(object("torus", shapes::torus(0.5, 0.2, 24, 12)?), [0.0, 0.9, 0.0]);
        let light = lamp(1.5 * cos, 3.5, 1.5 * sin);
        Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], light, vec![floor(3.0)?, torus]))
    }),
    without: &[
        (Technique::ZPass, "z-fail stands for the volumes: a thousand frames each"),
        (Technique::ZPassPlus, "z-fail stands for the volumes: a thousand frames each"),
        (Technique::ShadowMap, "its texels swim with the light: not promised to stand still"),
        (Technique::Planar, "a torus is no flat receiver"),
        (Technique::PlanarTexture, "its texels swim with the light: not promised to stand still"),
        (Technique::Projective, "its texels swim with the light: not promised to stand still"),
    ],
    ..PLAIN
};
