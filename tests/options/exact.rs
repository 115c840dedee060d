//! Shapes whose shadows are known in closed form, by every technique that can be exact and with
//! every option that must not change them.

use super::{capture, over_floor, shadow_pixels, unseen};
use crate::common::{cuboid, mesh, session};
use glam::DVec3;
use std::sync::Arc;
use stencilscope::scene::shapes;
use stencilscope::scene::{Light, Material, Object, Scene};
use stencilscope::technique::Technique;

/// Each technique with options that leave labels alone; textures fine enough for ten pixels a unit.
const EXACT: &[(Technique, &[(&str, &str)])] = &[
    (Technique::Planar, &[]),
    (Technique::Planar, &[("blend", "twice")]),
    (Technique::Planar, &[("cache", "off")]),
    (Technique::PlanarTexture, &[("size", "1024")]),
    (Technique::ZPass, &[]),
    (Technique::ZPass, &[("faces", "two-pass")]),
    (Technique::ZPass, &[("counter", "float")]),
    (Technique::ZPassPlus, &[]),
    (Technique::ZFail, &[]),
    (Technique::ZFail, &[("faces", "two-pass")]),
    (Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass")]),
    (Technique::ZFail, &[("counter", "float")]),
    (Technique::ZFail, &[("silhouette", "edge-list")]),
    (Technique::ZFail, &[("casters", "all")]),
    (Technique::ZFail, &[("extrusion", "finite:1000")]),
    (Technique::ShadowMap, &[]),
    (Technique::ShadowMap, &[("bias-receiver-plane", "on")]),
    (Technique::Projective, &[]),
    (Technique::Projective, &[("passes", "multi")]),
    (Technique::RayTraced, &[]),
];

fn assert_shadow(scene: &Scene, expected: std::ops::RangeInclusive<u64>) {
    let mut session = session();
    for (technique, settings) in EXACT {
        let found = shadow_pixels(&capture(&mut session, scene, *technique, settings));
        assert!(expected.contains(&found), "{technique:?} {settings:?}: {found}");
    }
}

/// Legs of 1.01 halfway to the light: of 2.02 on the floor, which is the centres of pixels whose
/// columns and rows from the corner add up to 19 at most.
#[test]
fn a_single_triangle() {
    let triangle = mesh(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.01], [1.01, 0.0, 0.0]], &[[0, 1, 2]]);
    let caster = unseen(Object::new("triangle", triangle, Material::default()), [0.0, 2.0, 0.0]);
    assert_shadow(&over_floor(12.0, vec![caster]), 210..=210);
}

/// Its upper face, halfway to the light, throws more than its lower one: half-width 2.
#[test]
fn a_cube() {
    let cube = unseen(cuboid("cube", [-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]), [0.0, 1.0, 0.0]);
    assert_shadow(&over_floor(12.0, vec![cube]), 1600..=1600);
}

/// Three boxes in each other, whose upper faces reach 2, 1.5 and 1 up: the largest hides the others' shadow.
/// Each is closed and counts one; twice where both of its sides cast.
#[test]
fn nested_boxes() {
    let boxes = [(1.0, 2.0), (0.8, 1.5), (0.6, 1.0)]
        .map(|(half, top)| unseen(cuboid("box", [-half, -0.2, -half], [half, 0.0, half]), [0.0, top, 0.0]));
    let scene = over_floor(12.0, boxes.to_vec());
    assert_shadow(&scene, 1600..=1600);
    for (casters, each) in [("by-topology", 1.0), ("all", 2.0)] {
        let settings = [("counter", "float"), ("casters", casters)];
        let found = capture(&mut session(), &scene, Technique::ZFail, &settings);
        let count = found.lights[0].count.as_ref().expect("a count");
        let how_often = |wanted: f32| {
            let texels = count.rows().flat_map(bytemuck::pod_collect_to_vec::<u8, f32>);
            texels.filter(|found| *found == wanted * each).count()
        };
        // Half-widths of the shadows: 2, 0.8 · 4 / 2.5 = 1.28 and 0.6 · 4 / 3 = 0.8.
        let expected = [40 * 40 - 26 * 26, 26 * 26 - 16 * 16, 16 * 16];
        assert_eq!([1.0, 2.0, 3.0].map(how_often), expected, "{casters}");
    }
}

/// A ring of 96 corners under a sun overhead: the area between two polygons.
#[test]
fn a_torus() {
    let torus = shapes::torus(4.0, 1.5, 96, 48).expect("a torus");
    let torus = unseen(Object::new("torus", Arc::new(torus), Material::default()), [0.0, 3.0, 0.0]);
    let mut scene = over_floor(12.0, vec![torus]);
    scene.lights = vec![Light::directional(DVec3::Y)];
    let polygon = |radius: f64| 48.0 * radius * radius * (std::f64::consts::TAU / 96.0).sin();
    let expected = (polygon(5.5) - polygon(2.5)) * 100.0;
    // Half of the pixels that the two edges cross may be off.
    assert_shadow(&scene, (expected - 40.0) as u64..=(expected + 40.0) as u64);
}
