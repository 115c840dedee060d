//! Receiver textures and projected silhouettes.

use super::{SIZE, as_bright_as, brightness, capture, over_floor, shadow_pixels, unseen, wrong};
use crate::common::{from_above, label_counts, opened, session, square};
use glam::DVec3;
use stencilscope::capture::Snapshot;
use stencilscope::scene::{Light, Scene};
use stencilscope::technique::Technique;

const FINE: [(&str, &str); 1] = [("size", "1024")];

/// Neither what is beyond the light nor what is behind the receiver is in the frustum between.
#[test]
fn a_receivers_texture_shows_what_is_between_it_and_the_light_only() {
    let mut session = session();
    let casters = [("between", 2.0), ("beyond", 8.0), ("behind", -2.0)];
    let casters = casters.map(|(name, y)| unseen(square(name, 0.0, 1.0), [0.0, y, 0.0]));
    let scene = over_floor(12.0, casters.to_vec());
    let found = capture(&mut session, &scene, Technique::PlanarTexture, &FINE);
    assert_eq!(label_counts(&found), [38_400, 1600, 0, 0]);
    let texture = &found.lights[0].map.as_ref().expect("a texture").faces;
    assert_eq!((texture.len(), texture[0].size()), (1, [1024, 1024]));
    // The shadow is a sixth of the floor's width: 4 of 24 units.
    let dark = texture[0].rows().flat_map(|row| row.chunks_exact(4)).filter(|texel| texel[3] == 0).count();
    assert!(dark.abs_diff(1024 * 1024 / 36) < 2 * 1024, "{dark}");
}

/// The floor is the slanted one of four corners that are no rectangle, in one piece.
#[test]
fn a_parallelogram_has_its_own_edges_and_suns_a_sheared_box() {
    let mut session = session();
    for light in [Light::point(DVec3::new(0.5, 5.0, 0.25)), Light::directional(DVec3::new(0.3, 1.0, -0.2))] {
        let corners = [[-8.0, 0.5, -6.0], [-5.0, -0.5, 7.0], [8.0, 0.0, 6.5], [5.0, 1.0, -6.5]];
        let floor = crate::common::mesh(&corners, &[[0, 1, 2], [0, 2, 3]]);
        let mut scene = over_floor(1.0, vec![unseen(square("caster", 0.0, 1.0), [0.3, 3.0, 0.2])]);
        scene.objects[0] = stencilscope::scene::Object::new("floor", floor, Default::default());
        scene.lights = vec![light.clone()];
        assert_eq!(wrong(&mut session, &scene, Technique::PlanarTexture, &FINE), [0, 0], "{light:?}");
        assert!(shadow_pixels(&capture(&mut session, &scene, Technique::PlanarTexture, &FINE)) > 300);
    }
}

#[test]
fn a_receivers_texture_errs_less_the_larger_it_is() {
    let mut session = session();
    let scene = opened("panels");
    let mut errors = |size| {
        let [false_shadow, missing] = wrong(&mut session, &scene, Technique::PlanarTexture, &[("size", size)]);
        false_shadow + missing
    };
    let [coarse, middle, fine] = [errors("16"), errors("64"), errors("1024")];
    assert!(coarse > 3 * middle && middle > 3 * fine && fine < 5, "{coarse} {middle} {fine}");
}

/// No depths are compared: what is nearer to the light than the caster is darkened like what is
/// behind it. A square of half-width 0.2 three up, seen from seven above: 6 × 6 pixels, but for its
/// diagonal, where errors are excused.
#[test]
fn a_silhouette_darkens_what_is_before_its_caster() {
    let mut session = session();
    let mut before = square("before", 3.0, 0.2);
    before.casts = false;
    let scene = from_above(vec![unseen(square("caster", 0.0, 1.0), [0.0, 2.0, 0.0]), before]);
    for passes in ["single", "multi"] {
        assert_eq!(wrong(&mut session, &scene, Technique::Projective, &[("passes", passes)]), [36 - 6, 0]);
    }
}

/// The light stands between a caster and a wall, half as far from the caster: on the wall, 20 pixels
/// a unit, a square of half-width 0.5 would be one of half-width 1 (whose diagonal is excused).
#[test]
fn a_silhouette_falls_backwards_only_where_that_is_not_prevented() {
    let mut session = session();
    let mut upright = square("wall", 0.0, 20.0);
    upright.pose.rotate_degrees.z = -90.0;
    upright.pose.translate.x = -4.0;
    let mut caster = unseen(square("caster", 0.0, 0.5), [2.0, 0.0, 0.0]);
    caster.pose.rotate_degrees.z = 90.0;
    let mut scene: Scene = over_floor(1.0, vec![caster, upright]);
    scene.objects.remove(0);
    scene.lights = vec![Light::point(DVec3::ZERO)];
    scene.camera.eye = DVec3::new(1.0, 0.0, 0.0);
    scene.camera.target = DVec3::new(-1.0, 0.0, 0.0);
    scene.camera.up = DVec3::Y;
    // The caster is not left out as one with nothing behind it: a second wall stands there.
    let mut behind = square("behind", 0.0, 20.0);
    behind.pose.rotate_degrees.z = 90.0;
    behind.pose.translate.x = 9.0;
    scene.objects.push(behind);
    assert_eq!(wrong(&mut session, &scene, Technique::Projective, &[]), [0, 0]);
    assert_eq!(wrong(&mut session, &scene, Technique::Projective, &[("reverse", "on")]), [1600 - 40, 0]);
}

/// A red pane of opacity one half lets half of the red through and none of the green.
#[test]
fn light_through_a_translucent_caster_takes_its_colour() {
    let mut session = session();
    let mut pane = unseen(square("pane", 0.0, 1.0), [0.0, 2.0, 0.0]);
    pane.material.opacity = 0.5;
    pane.material.color = [0.8, 0.0, 0.0];
    let mut scene = over_floor(12.0, vec![pane]);
    scene.ambient = [0.0; 3];
    scene.lights = vec![Light::directional(DVec3::Y)];
    let full = 0.75;
    for (technique, settings) in [(Technique::Projective, &[][..]), (Technique::PlanarTexture, &FINE[..])] {
        let found = capture(&mut session, &scene, technique, settings);
        let pixels = brightness(&found);
        assert_eq!(as_bright_as(&pixels, full / 2.0), 400, "{technique:?}");
        assert_eq!(as_bright_as(&pixels, full), 40_000 - 400);
        assert_eq!(shadow_pixels(&found), 400, "labels count it as opaque");
        let frame = found.frame_at(found.steps.len() - 1).expect("a frame");
        assert_eq!(frame.color.image.rgba_at([100, 100]).expect("a pixel")[1], 0, "no green");
    }
}

/// An opaque square under a translucent one keeps all light away, whichever is drawn first.
#[test]
fn an_opaque_caster_stays_opaque_beside_a_translucent_one() {
    let mut session = session();
    let opaque = unseen(square("opaque", 0.0, 0.5), [0.0, 1.0, 0.0]);
    let mut pane = unseen(square("pane", 0.0, 1.0), [0.0, 2.0, 0.0]);
    pane.material.opacity = 0.2;
    for casters in [vec![opaque.clone(), pane.clone()], vec![pane, opaque]] {
        let mut scene = over_floor(12.0, casters);
        scene.ambient = [0.0; 3];
        scene.lights = vec![Light::directional(DVec3::Y)];
        for (technique, settings) in [(Technique::Projective, &[][..]), (Technique::PlanarTexture, &FINE[..])] {
            let pixels = brightness(&capture(&mut session, &scene, technique, settings));
            assert_eq!(as_bright_as(&pixels, 0.0), 100, "{technique:?}");
            assert_eq!(as_bright_as(&pixels, 0.75 * 0.8), 400 - 100, "{technique:?}");
        }
    }
}

/// However small its picture, a silhouette ends at its frame.
#[test]
fn a_picture_of_one_texel_darkens_its_own_frame_only() {
    let mut session = session();
    let scene = over_floor(12.0, vec![unseen(square("caster", 0.0, 1.0), [0.0, 2.0, 0.0])]);
    for size in ["1", "16", "49"] {
        let shadow = shadow_pixels(&capture(&mut session, &scene, Technique::Projective, &[("size", size)]));
        assert!((1500..1800).contains(&shadow), "{size}: {shadow}");
    }
}

/// One light, no ambient: darkening afterwards is the same picture but for rounding.
#[test]
fn single_and_multi_pass_agree_where_there_is_one_light_only() {
    let mut session = session();
    let mut scene = from_above(vec![
        unseen(square("a", 0.0, 1.0), [0.0, 2.0, 0.0]),
        unseen(square("b", 0.0, 0.75), [1.5, 1.0, 0.0]),
    ]);
    scene.ambient = [0.0; 3];
    let mut tilted = square("tilted", 0.0, 2.0);
    tilted.pose.translate = DVec3::new(-5.0, 2.0, 0.0);
    tilted.pose.rotate_degrees.z = 80.0;
    scene.objects.push(tilted);
    for diffuse in ["lambert", "wrapped"] {
        let [single, multi] = ["single", "multi"].map(|passes| {
            capture(&mut session, &scene, Technique::Projective, &[("passes", passes), ("diffuse", diffuse)])
        });
        assert_eq!(single.lights[0].shadow, multi.lights[0].shadow);
        let pairs = brightness(&single).into_iter().zip(brightness(&multi));
        assert_eq!(pairs.filter(|(a, b)| (a - b).abs() > 0.01).count(), 0, "{diffuse}");
    }
    // With a second light the silhouettes of the first darken it too.
    scene.lights.push(Light::point(DVec3::new(3.0, 4.0, 0.0)));
    let [single, multi] = ["single", "multi"].map(|passes| {
        brightness(&capture(&mut session, &scene, Technique::Projective, &[("passes", passes)]))
            .into_iter()
            .sum::<f64>()
    });
    assert!(multi < single * 0.999, "{multi} {single}");
}

/// A caster around the light can't be fitted: it is said, and casts nothing.
#[test]
fn a_caster_that_reaches_behind_the_light_is_said_to_cast_nothing() {
    let mut session = session();
    let around = unseen(crate::common::cuboid("around", [-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]), [0.0, 4.0, 0.0]);
    let found = capture(&mut session, &from_above(vec![around]), Technique::Projective, &[]);
    assert_eq!(label_counts(&found), [u64::from(SIZE[0] * SIZE[1]), 0, 0, 0]);
    assert!(
        found.left_out.iter().any(|left| left.what.contains("around") && left.because.contains("behind the light"))
    );
    assert!(found.steps.iter().all(|step| !matches!(step.snapshot, Snapshot::Map { .. })));
}
