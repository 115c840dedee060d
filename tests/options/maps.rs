//! Shadow maps: biases, culling and filtering.

use super::{brightness, capture, shadow_pixels, unseen, wrong};
use crate::common::{cuboid, from_above, session, square, under};
use glam::DVec3;
use stencilscope::capture::Capture;
use stencilscope::scene::{Light, Scene};
use stencilscope::technique::Technique;
use stencilscope::truth::Tracer;

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

/// The share of the pixels of a picture that a technique labels as shadow: of those whose surface point, by a ray, lies in
/// `is_there` of an object of this name.
fn dark_share(found: &Capture, tracer: &Tracer, name: &str, is_there: &dyn Fn(DVec3) -> bool) -> f64 {
    let mask = found.lights[0].shadow.as_ref().expect("labels");
    let (mut dark, mut all) = (0_u32, 0_u32);
    for [x, y] in (0..found.size[1]).flat_map(|y| (0..found.size[0]).map(move |x| [x, y])) {
        let Some(seen) = tracer.seen_at([x, y].map(|at| f64::from(at) + 0.5)) else { continue };
        if tracer.name(seen.place) == name && is_there(seen.point) {
            all += 1;
            dark += u32::from(mask.byte_at([x, y]) == Some(1));
        }
    }
    assert!(all > 100, "{name}: {all} pixels");
    f64::from(dark) / f64::from(all)
}

/// What the scene of three heights says of itself: without a bias floor and boards are striped; with one, each board's shadow
/// stays just while the bias is shorter than the way from the board to the floor along the light.
#[test]
fn a_bias_takes_away_the_shadows_of_what_is_nearer_to_its_receiver_than_it_is_long() {
    let mut session = session();
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/heights.toml");
    let scene =
        stencilscope::scene::open(&stencilscope::scene::OpenSpec::new(file.to_string_lossy())).expect("a scene");
    let size = [480, 360];
    let tracer = Tracer::new(&scene, size).expect("a tracer");
    let boards = [("low", 0.2, -2.0), ("middle", 0.8, 0.0), ("high", 3.2, 2.0)];
    // A board's shadow is moved by 3 / 4 of its height towards −X; a few texels of its edge are left out.
    let is_in = |(_, height, z): (&str, f64, f64), point: DVec3, margin: f64| {
        let [across, along] = [point.x - (1.0 - 0.75 * height), point.z - z];
        across.abs() < 0.35 + margin && along.abs() < 0.7 + margin
    };
    let is_free = |point: DVec3| boards.iter().all(|board| !is_in(*board, point, 0.05)) && point.x.abs() < 3.9;
    let mut gone = Vec::new();
    for slope in ["0", "2", "80", "300"] {
        let settings = [("bias-slope", slope), ("bias-constant", "0")];
        let request = crate::common::request_with(Technique::ShadowMap, &settings, size);
        let found = session.capture(&scene, &request).expect("a capture");
        let map = found.lights[0].map.as_ref().expect("a map");
        let clip = map.clip_from_light[0] * map.light_from_world;
        // How much depth changes from texel to texel on a level plane, in metres along the light.
        let texels = f64::from(map.faces[0].size()[0]);
        let [by_x, by_z] = [DVec3::X, DVec3::Z].map(|way| clip.transform_vector3(way));
        let planes = glam::DMat2::from_cols(by_x.truncate(), by_z.truncate()).transpose().inverse();
        let slopes = (planes * glam::DVec2::new(by_x.z, by_z.z)).abs() * 2.0 / texels;
        let metre = clip.row(2).truncate().length();
        let bias = slope.parse::<f64>().expect("a number") * slopes.max_element() / metre;
        for board @ (name, height, _) in boards {
            let dark = dark_share(&found, &tracer, "floor", &|point| is_in(board, point, -0.04));
            let ratio = bias / (height / 0.8);
            assert!(!(0.8..1.25).contains(&ratio), "{name} at {slope}: {bias} m says nothing");
            if ratio > 1.0 {
                assert!(dark < 0.02, "{name}, a bias of {bias} m: {dark} of its shadow is dark");
                gone.push((slope, name));
            } else {
                assert!(dark > 0.98, "{name}, a bias of {bias} m: {dark} of its shadow is dark");
            }
            let striped = dark_share(&found, &tracer, name, &|_| true);
            assert_eq!(striped > 0.05, slope == "0", "{name} at {slope}: {striped} of it darkens itself");
        }
        let striped = dark_share(&found, &tracer, "floor", &is_free);
        assert_eq!(striped > 0.05, slope == "0", "the floor at {slope}: {striped}");
    }
    assert_eq!(gone, [("80", "low"), ("300", "low"), ("300", "middle")]);
}
