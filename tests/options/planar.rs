//! Planar shadows without the stencil, blended twice, unclipped, and fighting with their plane.

use super::{as_bright_as, brightness, capture, over_floor, shadow_pixels, unseen, wrong};
use crate::common::{from_above, mesh, opened, session, square};
use glam::DVec3;
use stencilscope::scene::{Material, Object, shapes};
use stencilscope::technique::Technique;

/// Shadows of 40 × 40 and 20 × 20 pixels that share 10 × 20.
#[test]
fn overlapping_shadows_darken_twice_unless_the_stencil_keeps_them_from_it() {
    let mut session = session();
    let casters = vec![unseen(square("a", 0.0, 1.0), [0.0, 2.0, 0.0]), unseen(square("b", 0.0, 0.75), [1.5, 1.0, 0.0])];
    let mut scene = from_above(casters);
    scene.ambient = [1.0; 3];
    scene.lights[0].color = [0.0; 3];
    let twice = capture(&mut session, &scene, Technique::Planar, &[("blend", "twice")]);
    let pixels = brightness(&twice);
    // A floor of reflectance 0.75 in ambient light, left at 0.4 and at 0.16 of that.
    assert_eq!(as_bright_as(&pixels, 0.75 * 0.16), 200);
    assert_eq!(as_bright_as(&pixels, 0.75 * 0.4), 1600 + 400 - 2 * 200);
    assert_eq!(as_bright_as(&pixels, 0.75), 40_000 - 1800);
    assert_eq!(shadow_pixels(&twice), 1800, "labels count a pixel once");
    let once = capture(&mut session, &scene, Technique::Planar, &[]);
    assert_eq!(shadow_pixels(&once), 1800);
    assert_eq!(as_bright_as(&brightness(&once), 0.75), 40_000, "without light nothing is left to take away");
}

/// The shadow reaches from 1 to 5 along x, the floor to 3.
#[test]
fn without_the_stencil_a_shadow_runs_off_its_receiver() {
    let mut session = session();
    let scene = over_floor(3.0, vec![unseen(square("caster", 0.0, 1.0), [1.5, 2.0, 0.0])]);
    let shadow =
        |session: &mut _, stencil| shadow_pixels(&capture(session, &scene, Technique::Planar, &[("stencil", stencil)]));
    assert_eq!(shadow(&mut session, "on"), 20 * 40);
    assert_eq!(shadow(&mut session, "off"), 40 * 40);
}

/// Only what is flat by itself receives then: each facet of a torus would throw shadows over all of its plane.
#[test]
fn without_the_stencil_the_builtin_scenes_hang_shadows_over_their_edges_and_do_not_go_black() {
    let mut session = session();
    for (name, hangs_over) in [("table", true), ("rings", false)] {
        let scene = opened(name);
        let lit = capture(&mut session, &scene, Technique::None, &[]);
        let plain = brightness(&lit);
        let settings = [("stencil", "off"), ("z-fighting", "polygon-offset")];
        let shadowed = capture(&mut session, &scene, Technique::Planar, &settings);
        let labels = lit.lights[0].shadow.as_ref().expect("labels");
        let background: Vec<bool> = labels.rows().flatten().map(|label| *label == 2).collect();
        let darkened = |of: bool| {
            let pairs = plain.iter().zip(brightness(&shadowed)).zip(&background).filter(|(_, is)| **is == of);
            let (all, dark) = pairs
                .fold((0, 0), |(all, dark), ((before, after), _)| (all + 1, dark + usize::from(after < before * 0.9)));
            dark as f64 / f64::from(all)
        };
        let on_surfaces = darkened(false);
        assert!((0.01..0.5).contains(&on_surfaces), "{name}: {on_surfaces}");
        assert_eq!(darkened(true) > 0.01, hangs_over, "{name}: {}", darkened(true));
    }
}

/// What one sees of a closed room is its inside.
#[test]
fn without_the_stencil_a_room_receives_where_the_eye_is_in_it() {
    let mut session = session();
    let room = Object { casts: false, ..Object::of("room", shapes::cuboid([30.0; 3]).expect("a room")) };
    let mut scene = from_above(vec![room, unseen(square("caster", 0.0, 1.0), [0.0, 2.0, 0.0])]);
    scene.objects.remove(0);
    let settings = [("stencil", "off"), ("z-fighting", "polygon-offset")];
    let [plain, shadowed] = [Technique::None, Technique::Planar].map(|technique| {
        let settings = if technique == Technique::Planar { &settings[..] } else { &[] };
        brightness(&capture(&mut session, &scene, technique, settings))
    });
    let darkened = plain.iter().zip(&shadowed).filter(|(before, after)| **after < **before * 0.9).count();
    assert!(darkened > 400, "{darkened}");
}

/// Two below the light a square throws one twice as large; two beyond it an anti-shadow as large.
#[test]
fn without_clipping_what_is_beyond_the_light_throws_an_anti_shadow() {
    let mut session = session();
    let scene = from_above(vec![unseen(square("caster", 0.0, 1.0), [0.0, 8.0, 0.0])]);
    assert_eq!(wrong(&mut session, &scene, Technique::Planar, &[]), [0, 0]);
    // From 4 beyond the light to 4 below it: its own size. What lies on the floor's diagonal, where
    // the visible triangle changes, is excused.
    assert_eq!(wrong(&mut session, &scene, Technique::Planar, &[("clip", "off")]), [400 - 20, 0]);
}

/// A square of half-width 1.5 at 2 under the floor, seen from a light 4 above: scaled by 4 / 6.
#[test]
fn without_clipping_what_is_below_the_plane_throws_a_false_shadow() {
    let mut session = session();
    let scene = from_above(vec![unseen(square("caster", 0.0, 1.5), [0.0, -2.0, 0.0])]);
    assert_eq!(wrong(&mut session, &scene, Technique::Planar, &[]), [0, 0]);
    assert_eq!(wrong(&mut session, &scene, Technique::Planar, &[("clip", "off")]), [400 - 20, 0]);
}

/// On a tilted floor the flattened caster and the floor round apart.
#[test]
fn a_shadow_tested_against_its_own_plane_fights_with_it() {
    let mut session = session();
    let mut scene = from_above(vec![unseen(square("caster", 0.0, 1.0), [0.3, 3.0, 0.2])]);
    scene.objects[0].pose.rotate_degrees = DVec3::new(17.0, 0.0, 11.0);
    let mut missing = |way| wrong(&mut session, &scene, Technique::Planar, &[("z-fighting", way)]);
    assert_eq!(missing("depth-off"), [0, 0]);
    assert_eq!(missing("polygon-offset"), [0, 0]);
    let [false_shadow, fighting] = missing("none");
    assert!(false_shadow == 0 && fighting > 500, "{fighting}");
}

#[test]
fn cached_casters_give_the_same_frame_and_moved_ones_are_flattened_again() {
    let mut session = session();
    let mut scene = from_above(vec![square("caster", 2.0, 1.0)]);
    for x in [0.0, 0.0, 1.0] {
        scene.objects[1].pose.translate.x = x;
        let [cached, made] =
            ["on", "off"].map(|cache| capture(&mut session, &scene, Technique::Planar, &[("cache", cache)]));
        assert_eq!(cached.lights[0].shadow, made.lights[0].shadow);
        let frames = cached.steps.iter().zip(&made.steps).filter(|(cached, made)| cached.snapshot == made.snapshot);
        assert_eq!((frames.count(), made.steps.len()), (cached.steps.len(), cached.steps.len()));
    }
}

/// Quads that lie in one plane neither darken themselves nor each other, whatever rounding makes of
/// the plane: two pieces of one object, and two objects, at heights that are not exact.
#[test]
fn what_lies_in_one_plane_with_a_receiver_does_not_darken_it() {
    let mut session = session();
    let pieces = |y: f64| {
        let at = |x: f64| [[x, y, -1.0], [x, y, 1.0], [x + 2.0, y, 1.0], [x + 2.0, y, -1.0]];
        let corners = [at(-2.5), at(0.5)].concat();
        let quads = mesh(&corners, &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
        Object::new("pieces", quads, Material::default())
    };
    for y in [0.1, 0.123, 1.1] {
        for objects in [vec![pieces(y)], vec![square("rug", y, 2.0), square("poster", y, 1.0)]] {
            let mut scene = from_above([objects, vec![unseen(square("caster", 0.0, 0.3), [0.3, 2.5, 0.2])]].concat());
            scene.objects.remove(0);
            for (technique, settings) in [
                (Technique::Planar, &[][..]),
                (Technique::Planar, &[("cache", "off")]),
                (Technique::PlanarTexture, &[("size", "1024")]),
            ] {
                assert_eq!(wrong(&mut session, &scene, technique, settings), [0, 0], "{technique:?} {settings:?} {y}");
            }
        }
    }
}
