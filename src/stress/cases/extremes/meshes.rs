//! Extremes of a mesh's topology.

use crate::math::angle;
use crate::scene::{Light, MeshError, Object, Scene, shapes};
use crate::stress::cases::stage::{cuboid, floor, scene};
use crate::stress::cases::who::*;
use crate::stress::{CaseNumber, LeastShares, StressCase};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The stress cases with extreme meshes.
pub const ALL: &[StressCase] = &[
    BOTH_SIDES,
    OPEN_MESH,
    MOBIUS,
    FINS,
    SHARED_EDGE,
    SPLIT_VERTICES,
    T_JUNCTION,
    COINCIDENT,
    INSTANCES,
    DEGENERATE,
    BESIDE_DEGENERATE,
    UNDRAWN,
];

/// Returns a scene of these casters over the usual floor, with one point light and the camera of this module's cases.
/// The floor is object 0.
fn over_floor(casters: Vec<Object>) -> Result<Scene, MeshError> {
    let mut objects = vec![floor(3.0)?];
    objects.extend(casters);
    Ok(scene([1.5, 3.0, 5.0], [0.0, 0.3, 0.0], Light::point([1.0, 4.0, 1.5]), objects))
}

const BOTH_SIDES: StressCase = StressCase {
    name: "both-sides",
    lesson: "a single sheet, seen from the side that it faces and from the other: it casts the same either way",
    parameter: "eye turned",
    values: &[0.0, 180.0],
    drives: CaseNumber::Scene(|degrees| {
        let sheet = Object::of("sheet", shapes::quad([1.0; 2])?).rotated([70.0, 30.0, 0.0]).at([0.0, 0.8, 0.0]);
        let mut scene = over_floor(vec![sheet])?;
        let (sin, cos) = angle::sin_cos(degrees.to_radians());
        scene.camera.eye = DVec3::new(1.5 * cos + 5.0 * sin, 3.0, 5.0 * cos - 1.5 * sin);
        Ok(scene)
    }),
    ..PLAIN
};

const OPEN_MESH: StressCase = StressCase {
    name: "open-mesh",
    lesson: "a box without its top: the silhouette of the faces turned to the light does not close",
    drives: CaseNumber::Scene(|_| {
        let closed = shapes::cuboid([0.8, 0.6, 0.8])?;
        let points: Vec<[f64; 3]> = closed.positions().iter().map(|point| point.to_array()).collect();
        let is_top = |corners: &&[u32; 3]| corners.iter().all(|vertex| points[*vertex as usize][1] > 0.0);
        let open: Vec<[u32; 3]> = closed.triangles().iter().filter(|corners| !is_top(corners)).copied().collect();
        over_floor(vec![Object::of("open box", shapes::triangles(&points, &open)?).at([0.0, 0.8, 0.0])])
    }),
    also: &[LIGHT_FACING, ALL_CAST],
    failures: &[fails(
        LIGHT_FACING,
        "light-facing-open",
        "light falls through the open top on faces that are turned away and do not cast",
    )
    .is_missing()
    .at_most(0.018)],
    ..PLAIN
};

const MOBIUS: StressCase = StressCase {
    name: "mobius",
    lesson: "a strip with one side: no winding is consistent, so no face is the outer one",
    drives: CaseNumber::Scene(|_| {
        let steps = 48_u32;
        let at = |step: u32, side: f64| {
            let around = f64::from(step) / f64::from(steps) * TAU;
            let twist = f64::from(step) / f64::from(steps) * PI;
            let radius = 0.6 + side * 0.25 * angle::cos(twist);
            [radius * angle::cos(around), side * 0.25 * angle::sin(twist), radius * angle::sin(around)]
        };
        let points: Vec<[f64; 3]> = (0..steps).flat_map(|step| [at(step, -1.0), at(step, 1.0)]).collect();
        let quads = (0..steps).flat_map(|step| {
            let (a, b) = (2 * step, 2 * step + 1);
            // The last step is joined to the first one's other side.
            let (c, d) = if step + 1 < steps { (a + 2, a + 3) } else { (1, 0) };
            [[a, c, d], [a, d, b]]
        });
        let strip = Object::of("strip", shapes::triangles(&points, &quads.collect::<Vec<_>>())?);
        over_floor(vec![strip.rotated([20.0, 0.0, 0.0]).at([0.0, 1.0, 0.0])])
    }),
    failures: &[NO_SELF_SHADOW.at_most(0.0006), RECEIVER_LEFT_OUT.at_most(0.0004)],
    ..PLAIN
};

const FINS: StressCase = StressCase {
    name: "fins",
    lesson: "three fins on one edge: it has three triangles, and two of them can't cancel for the third",
    drives: CaseNumber::Scene(|_| {
        let fin = |index: u32| {
            let (sin, cos) = angle::sin_cos(f64::from(index) / 3.0 * TAU + 0.3);
            [[0.5 * cos, 0.3, 0.5 * sin], [0.5 * cos, -0.3, 0.5 * sin]]
        };
        let mut points = vec![[0.0, 0.3, 0.0], [0.0, -0.3, 0.0]];
        points.extend((0..3).flat_map(fin));
        let quads = (0..3).flat_map(|index| {
            let (top, bottom) = (2 + 2 * index, 3 + 2 * index);
            [[0, 1, bottom], [0, bottom, top]]
        });
        over_floor(vec![
            Object::of("fins", shapes::triangles(&points, &quads.collect::<Vec<_>>())?).at([0.0, 0.8, 0.0]),
        ])
    }),
    also: &[LIGHT_FACING],
    failures: &[fails(LIGHT_FACING, "light-facing-open", "fins that show the light their other side do not cast")
        .is_missing()
        .at_most(0.009)],
    ..PLAIN
};

const SHARED_EDGE: StressCase = StressCase {
    name: "shared-edge",
    lesson: "two cubes that meet in an edge: four triangles share it, and it may be silhouette twice or not at all",
    drives: CaseNumber::Scene(|_| {
        let cube = shapes::cuboid([0.5; 3])?;
        let pair = shapes::joined([(&cube, DVec3::ZERO), (&cube, DVec3::new(0.5, 0.5, 0.0))])?;
        over_floor(vec![Object::of("cubes", pair).at([-0.25, 0.5, 0.0])])
    }),
    also: &[LIGHT_FACING],
    failures: &[NO_SELF_SHADOW, RECEIVER_LEFT_OUT.at_most(0.002)],
    ..PLAIN
};

const SPLIT_VERTICES: StressCase = StressCase {
    name: "split-vertices",
    lesson: "a cube with corners of its own for every triangle, as files have them: welded, it is closed again",
    drives: CaseNumber::Scene(|_| {
        let cube = shapes::cuboid([0.8, 0.6, 0.8])?;
        let corner = |vertex: &u32| cube.positions()[*vertex as usize].to_array();
        let points: Vec<[f64; 3]> = cube.triangles().as_flattened().iter().map(corner).collect();
        let triangles: Vec<[u32; 3]> = (0..points.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        over_floor(vec![Object::of("cube", shapes::triangles(&points, &triangles)?).at([0.0, 0.8, 0.0])])
    }),
    also: &[LIGHT_FACING, SHARED_CORNERS],
    failures: &[fails(
        SHARED_CORNERS,
        "split-vertices",
        "no two triangles share a corner by number, so that no edge has a side and the volume is its caps",
    )
    .is_mixed()
    .at_most(0.08)],
    ..PLAIN
};

const T_JUNCTION: StressCase = StressCase {
    name: "t-junction",
    lesson: "a wall whose one half has a corner in the middle of the other's edge: the edges are three, and none shared",
    drives: CaseNumber::Scene(|_| {
        let points = [
            [-0.6, -0.4, 0.0],
            [0.0, -0.4, 0.0],
            [0.0, 0.4, 0.0],
            [-0.6, 0.4, 0.0],
            [0.0, 0.1, 0.0],
            [0.6, -0.4, 0.0],
            [0.6, 0.1, 0.0],
            [0.6, 0.4, 0.0],
        ];
        let triangles = [[0, 1, 2], [0, 2, 3], [1, 5, 6], [1, 6, 4], [4, 6, 7], [4, 7, 2]];
        over_floor(vec![
            Object::of("wall", shapes::triangles(&points, &triangles)?).rotated([-20.0, 0.0, 0.0]).at([0.0, 0.8, 0.0]),
        ])
    }),
    also: &[SHARED_CORNERS],
    failures: &[fails(
        SHARED_CORNERS,
        "t-junction",
        "edges of one triangle, at the wall's border and where a corner lies on another's edge, have no side",
    )
    .is_mixed()
    .at_most(0.09)],
    ..PLAIN
};

const COINCIDENT: StressCase = StressCase {
    name: "coincident",
    lesson: "the same triangle twice, and then with its other side: two volumes fill the same space",
    parameter: "turned",
    values: &[0.0, 1.0],
    drives: CaseNumber::Scene(|rotated| {
        let points = [[-0.6, 0.0, 0.4], [0.6, 0.0, 0.4], [0.0, 0.3, -0.6]];
        let second = if rotated == 0.0 { [0, 1, 2] } else { [0, 2, 1] };
        over_floor(vec![Object::of("pair", shapes::triangles(&points, &[[0, 1, 2], second])?).at([0.0, 0.8, 0.0])])
    }),
    ..PLAIN
};

const INSTANCES: StressCase = StressCase {
    name: "instances",
    lesson: "one mesh mirrored and stretched: mirroring turns every triangle inside out",
    drives: CaseNumber::Scene(|_| {
        let place = |at: [f64; 3], scale: [f64; 3]| -> Result<Object, MeshError> {
            let name = format!("cylinder at {}", at[0]);
            Ok(Object::of(&name, shapes::cylinder(0.3, 0.8, 16)?).at(at).scaled(scale))
        };
        let casters = [
            place([-1.2, 0.8, 0.0], [-1.0, 1.0, 1.0])?,
            place([0.0, 0.8, 0.0], [1.5, -0.3, 0.7])?,
            place([1.2, 0.8, 0.0], [-0.4, -1.2, -1.1])?,
        ];
        over_floor(casters.to_vec())
    }),
    also: &[LIGHT_FACING, ALL_CAST, UNFLIPPED],
    failures: &[fails(UNFLIPPED, "mirrored", "a mirrored volume takes away what it should add, and counts stop at 0")
        .is_missing()
        .at_most(0.04)],
    ..PLAIN
};

const DEGENERATE: StressCase = StressCase {
    name: "degenerate",
    lesson: "a mesh of nothing but a triangle without area: it casts nothing, and nothing breaks",
    parameter: "corners alike",
    values: &[0.0, 2.0, 3.0],
    drives: CaseNumber::Scene(|alike| over_floor(vec![line(alike)?])),
    least: |_| LeastShares::all_lit("nothing casts"),
    ..PLAIN
};

const BESIDE_DEGENERATE: StressCase = StressCase {
    name: "beside-degenerate",
    lesson: "a triangle without area beside a box: the box's shadow is whole",
    parameter: "corners alike",
    values: DEGENERATE.values,
    drives: CaseNumber::Scene(|alike| over_floor(vec![line(alike)?, cuboid("box", [-1.0, 0.6, 0.0], [0.4; 3])?])),
    ..PLAIN
};

/// Returns an object of one triangle without area: its corners lie in a line where `alike` is 0; two of them are the
/// same vertex where it is 2, all three for any other number.
fn line(alike: f64) -> Result<Object, MeshError> {
    let points = [[-0.5, 0.0, 0.0], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
    let triangle = match alike as u32 {
        0 => [0, 1, 2],
        2 => [0, 1, 1],
        _ => [1, 1, 1],
    };
    Ok(Object::of("line", shapes::triangles(&points, &[triangle])?).at([0.0, 0.8, 0.0]))
}

const UNDRAWN: StressCase = StressCase {
    name: "undrawn",
    lesson: "a caster that is not drawn: its light cap lies on no surface, so it must be tested like any other face",
    drives: CaseNumber::Scene(|_| {
        let hidden = cuboid("box", [0.0, 0.8, 0.0], [0.8, 0.6, 0.8])?;
        over_floor(vec![hidden.unseen()])
    }),
    also: &[CAPS_NEVER],
    failures: &[fails(
        CAPS_NEVER,
        "light-caps-never",
        "a cap in front of a surface passes the test, but is counted as if it were behind",
    )
    .is_mixed()
    .at_most(0.08)],
    ..PLAIN
};
