//! Shadow maps: biases, culling and filtering.

use super::{brightness, capture, shadow_pixels, unseen, wrong};
use crate::common::{cuboid, from_above, session, square, under};
use glam::DVec3;
use stencilscope::scene::{Light, Scene};
use stencilscope::technique::Technique;

const NO_BIAS: [(&str, &str); 3] = [("bias-constant", "0"), ("bias-slope", "0"), ("size", "256")];

/// A tilted plate that darkens itself where nothing prevents it.
fn plate() -> Scene {
    let mut plate = square("plate", 0.0, 3.0);
    plate.pose.rotate_degrees.z = 30.0;
    plate.pose.translate.y = 2.5;
    under(Light::point(DVec3::new(-2.0, 9.0, 0.5)), vec![plate])
}

#[test]
fn each_bias_takes_most_of_the_acne_away() {
    let mut session = session();
    let scene = plate();
    let mut acne = |settings: &[(&str, &str)]| {
        wrong(&mut session, &scene, Technique::ShadowMap, &[&NO_BIAS[..], settings].concat())[0]
    };
    let bare = acne(&[]);
    assert!(bare > 1000, "{bare}");
    for settings in [
        &[("bias-slope", "2.0")][..],
        &[("bias-constant", "500000")],
        &[("bias-normal", "1.5")],
        &[("bias-receiver-plane", "on"), ("bias-constant", "64")],
    ] {
        let left = acne(settings);
        assert!(left * 10 < bare, "{settings:?}: {left} of {bare}");
    }
}

/// Without its front faces a closed caster can't darken its own lit side; an open one that faces the
/// light is gone.
#[test]
fn culling_front_faces_saves_closed_casters_and_loses_open_ones() {
    let mut session = session();
    let mut tilted = cuboid("box", [-2.0, -0.3, -2.0], [2.0, 0.3, 2.0]);
    tilted.pose.rotate_degrees.z = 30.0;
    tilted.pose.translate.y = 2.0;
    let closed = Scene { lights: plate().lights, ..from_above(vec![tilted]) };
    let settings = |cull| [&NO_BIAS[..], &[("cull", cull)]].concat();
    let mut errors = |scene: &Scene, cull| wrong(&mut session, scene, Technique::ShadowMap, &settings(cull));
    assert!(errors(&closed, "none")[0] > 300);
    assert!(errors(&closed, "front")[0] < 20);
    // But for its diagonal, where errors are excused.
    let open = from_above(vec![unseen(square("caster", 0.0, 1.0), [0.0, 2.0, 0.0])]);
    assert_eq!(errors(&open, "front"), [0, 1600 - 40]);
    assert_eq!(errors(&open, "back")[1], 0);
}

/// The middle of a filtered edge is where the plain one is; around it, it is grey.
#[test]
fn filtering_turns_an_edge_grey_and_leaves_it_where_it_is() {
    let mut session = session();
    let mut scene = from_above(vec![unseen(square("caster", 0.0, 1.0), [0.0, 2.0, 0.0])]);
    scene.ambient = [0.0; 3];
    let mut levels = |filter| {
        let found = capture(&mut session, &scene, Technique::ShadowMap, &[("size", "128"), ("filter", filter)]);
        let shades = brightness(&found);
        let row = &shades[100 * 200..101 * 200];
        // Along the middle row light falls off with the angle only, but for the shadow.
        let grey = (70..100).filter(|x| row[*x] > 0.02 && row[*x] < 0.6).count();
        (grey, shadow_pixels(&found))
    };
    let (plain, plain_shadow) = levels("none");
    assert_eq!((plain, plain_shadow), (0, 1600));
    assert_eq!(levels("pcf:1"), (0, 1600));
    let (soft, soft_shadow) = levels("pcf:5");
    assert!(soft >= 1 && soft_shadow.abs_diff(1600) < 170, "{soft} {soft_shadow}");
}
