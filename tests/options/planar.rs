//! Planar shadows without the stencil, blended twice, unclipped, and fighting with their plane.

use super::{as_bright_as, brightness, capture, over_floor, shadow_pixels, unseen, wrong};
use crate::commands::{assert_fails, done, folder};
use crate::common::{choice, cuboid, from_above, judged_by, mesh, opened, request_with, session, square};
use glam::DVec3;
use std::collections::BTreeSet;
use stencilscope::geometry::GeometryCache;
use stencilscope::plan::{Decision, DrawPart, FramePlan};
use stencilscope::scene::{Material, Object, Scene, shapes};
use stencilscope::technique::{self, PlanRequest, Technique};

fn planned(scene: &Scene, settings: &[(&str, &str)]) -> FramePlan {
    let choice = choice(Technique::Planar, settings);
    let cache = &mut GeometryCache::default();
    technique::plan(PlanRequest { scene, size: [1280, 720], choice: &choice, cache, map_camera: None }).expect("a plan")
}

/// The objects whose flat pieces are marked, each as often as it has some.
fn receiving(plan: &FramePlan) -> Vec<String> {
    let draws = plan.passes.iter().flat_map(|pass| &pass.draws).filter(|draw| draw.part == DrawPart::Receiver);
    draws.filter_map(|draw| draw.caster.clone()).collect()
}

/// Triangles of the passes that are a part of the frame.
fn triangles(plan: &FramePlan) -> usize {
    let draws = plan.passes.iter().filter(|pass| pass.timed).flat_map(|pass| &pass.draws);
    draws.map(|draw| draw.triangles.len()).sum()
}

/// As in the source of `rings`: one plane. With every facet of its tori a receiver it took 309 612 triangles.
#[test]
fn what_a_student_would_name_receives_and_facets_are_left_out_with_the_reason() {
    let rings = planned(&opened("rings"), &[]);
    assert_eq!(receiving(&rings), ["plane"]);
    assert!(triangles(&rings) <= 309_612 / 6, "{}", triangles(&rings));
    for torus in ["torus on the plane", "torus beyond the light", "torus under the plane"] {
        let left = rings.left_out.iter().find(|left| left.names(Decision::SmallReceivers, torus)).expect("its facets");
        assert!(left.count.is_some_and(|count| count > 500), "{left}");
        assert!(
            left.because.contains("0.5\u{a0}% of the picture or more; the largest of these covers 0.0"),
            "{left:?}"
        );
    }
    let all = planned(&opened("rings"), &[("receivers", "all")]);
    assert_eq!(receiving(&all).len(), 127, "as many as the stencil can mark");
    let left = all.left_out.iter().filter(|left| left.decision == Some(Decision::SmallReceivers));
    assert!(left.clone().count() > 0 && left.clone().all(|left| left.because.contains("marks for 127")));
    // Doors and bars are out of a student's reach; walls, floor and beds are not.
    let cage = planned(&opened("tiger-cage"), &[]);
    let (received, all_objects) = (receiving(&cage), opened("tiger-cage").objects.len());
    let left: BTreeSet<&str> = cage.left_out.iter().filter_map(|left| left.name.as_deref()).collect();
    assert!(received.iter().any(|name| name == "floor") && (10..100).contains(&received.len()), "{received:?}");
    assert!(left.iter().any(|name| name.starts_with("bars")) && left.len() < all_objects, "{left:?}");
}

#[test]
fn receivers_are_chosen_by_share_by_number_by_name_or_not_at_all() {
    let boxes = [[-3.0, 0.0], [0.0, 0.0], [3.0, 0.0]]
        .map(|[x, z]| cuboid(&format!("box {x}"), [x - 0.5, 0.0, z - 0.5], [x + 0.5, 1.0 + x.abs() / 10.0, z + 0.5]));
    let scene = from_above(boxes.to_vec());
    let of = |value: &str| receiving(&planned(&scene, &[("receivers", value)]));
    assert_eq!(of("largest:1"), ["floor"]);
    assert_eq!(of("named:box 3"), of("all").into_iter().filter(|name| name == "box 3").collect::<Vec<_>>());
    assert_eq!(of("named:box 3, floor").len(), of("named:box 3").len() + 1);
    assert_eq!(of("share:0"), of("all"));
    assert_eq!(of("share:50"), ["floor"], "a box's top is a five hundredth of the picture");
    assert_eq!(of("largest:126"), of("all"));
    for wrong in ["share:101", "share:NaN", "largest:0", "largest:1.5", "named:", "named:a,,b", "every"] {
        assert_fails(
            &["capture", "rings", "-t", "planar", "--set", &format!("receivers={wrong}"), "-o", "x"],
            2,
            &["share:P", "largest:N", "named:NAME", "all"],
        );
    }
    assert_fails(
        &["capture", "rings", "-t", "planar", "--set", "receivers=named:plan", "-o", "x"],
        2,
        &["named:plan names no object of the scene", "`plane`"],
    );
}

/// The left-out facets of a torus darken nothing less than they would; the flat box does, and `all` gives it back.
#[test]
fn the_triangles_that_face_the_light_throw_the_whole_shadow() {
    let mut session = session();
    for (name, settings) in [("rings", &[][..]), ("tetrahedron", &[]), ("steps", &[("receivers", "all")])] {
        let scene = opened(name);
        let mut of = |more: &[(&str, &str)]| {
            let request = request_with(Technique::Planar, &[settings, more].concat(), [320, 180]);
            judged_by(&mut session, &scene, &request).error().expect("an error")
        };
        let (half, whole) = (of(&[]), of(&[("leave-out", "none")]));
        assert_eq!([half.false_shadow, half.missing_shadow], [whole.false_shadow, whole.missing_shadow], "{name}");
        let [half, whole] = [&[][..], &[("leave-out", "none")]].map(|more| planned(&scene, &[settings, more].concat()));
        assert!(triangles(&half) < triangles(&whole), "{name}");
    }
}

/// Both, with what the pass before left: the surface, its mark, the flattened torus, the mask and the light.
#[test]
fn a_history_on_the_plane_of_rings_fits_a_blackboard() {
    let folder = folder();
    for at in ["300,200", "345,190", "230,230", "400,250"] {
        let story = done(folder.path(), &["pixel", "rings", "-t", "planar", "--size", "640x360", "--at", at]);
        let (_, history) = story.split_once("pass 1").expect("a history");
        let lines = history.lines().filter(|line| line.starts_with("  ")).count();
        assert!((5..=12).contains(&lines), "{at}: {lines}\n{story}");
    }
}

/// Both sides of closed casters win where one side alone loses; the rounding of a standard depth shows whatever covers it.
#[test]
fn layers_hide_most_of_the_fight_of_rings_and_standard_depth_shows_it() {
    let mut session = session();
    let mut scene = opened("rings");
    (scene.camera.near, scene.camera.far) = (0.1, Some(1000.0));
    let mut missing = |more: &[(&str, &str)]| {
        let request = request_with(Technique::Planar, &[&[("z-fighting", "none")], more].concat(), [640, 360]);
        judged_by(&mut session, &scene, &request).error().expect("an error").missing_shadow
    };
    let standard = ("depth", "standard-finite");
    let [layered, plain] = [&[("leave-out", "none")][..], &[]].map(&mut missing);
    let [layered_standard, plain_standard] = [&[("leave-out", "none"), standard][..], &[standard]].map(&mut missing);
    assert!(4 * layered < plain && 4 * plain < plain_standard, "{layered} {plain} {plain_standard}");
    assert!(4 * layered < layered_standard, "{layered} {layered_standard}");
}

/// Each pane and the ball have two sides, which leave 0.4 * 0.4; where their shadows overlap there are four layers.
#[test]
fn glass_shows_fewer_layers_beside_more() {
    let mut session = session();
    let scene = opened("glass");
    let lit = brightness(&capture(&mut session, &scene, Technique::None, &[]));
    let twice = brightness(&capture(&mut session, &scene, Technique::Planar, &[("blend", "twice")]));
    let share = |layers: i32| {
        let left = 0.4_f64.powi(layers);
        let pairs = lit.iter().zip(&twice).filter(|(lit, _)| **lit > 0.1);
        pairs.filter(|(lit, dark)| (*dark / *lit - left).abs() < 0.2 * left).count()
    };
    assert!(share(2) > 500 && share(4) > 100, "{} {}", share(2), share(4));
}

/// In the light of a lamp and an ambient light: of the floor one keeps the light off, one leaves 0.4 and one nothing.
#[test]
fn opaque_shadows_take_all_light_away_and_once_only_their_own() {
    let mut session = session();
    let mut scene = from_above(vec![unseen(square("caster", 0.0, 1.0), [0.0, 2.0, 0.0])]);
    scene.ambient = [0.4; 3];
    let mut of = |blend| {
        let capture = capture(&mut session, &scene, Technique::Planar, &[("blend", blend)]);
        assert_eq!(shadow_pixels(&capture), 1600, "{blend}");
        brightness(&capture)
    };
    let [once, twice, opaque] = ["once", "twice", "opaque"].map(&mut of);
    assert_eq!(as_bright_as(&once, 0.75 * 0.4), 1600, "ambient light alone");
    assert_eq!(as_bright_as(&opaque, 0.0), 1600, "nothing");
    let between = |pixel: &(&f64, &f64)| *pixel.0 > 0.01 && *pixel.0 < *pixel.1 * 0.9;
    let lit = capture(&mut session, &scene, Technique::None, &[]);
    assert_eq!(twice.iter().zip(&brightness(&lit)).filter(between).count(), 1600);
}

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

/// Undivided, what is beyond the light has w < 0, which a GPU clips; a caster from under the light to over it keeps the
/// shadow of its lower part.
#[test]
fn a_gpu_that_clips_a_negative_w_shows_no_anti_shadow() {
    let mut session = session();
    let scene = from_above(vec![unseen(square("caster", 0.0, 1.0), [0.0, 8.0, 0.0])]);
    assert_eq!(wrong(&mut session, &scene, Technique::Planar, &[("clip", "gpu")]), [0, 0]);
    let below = from_above(vec![unseen(square("caster", 0.0, 1.5), [0.0, -2.0, 0.0])]);
    assert_eq!(wrong(&mut session, &below, Technique::Planar, &[("clip", "gpu")]), [400 - 20, 0]);
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
