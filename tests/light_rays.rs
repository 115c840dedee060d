//! What keeps a light away, by rays: object, triangle and distance are those of the scene's own numbers.

use crate::commands::{folder, run, text};
use crate::common::{from_above, square};
use glam::DVec3;
use stencilscope::reading::light_rays::RayFollower;
use stencilscope::scene::{Light, Object, Scene};
use stencilscope::testing::PixelLabel;
use stencilscope::truth::Tracer;

/// Two boards over each other, one metre and two below a lamp that is 4 m above the floor.
fn boards() -> Scene {
    let mut scene = from_above(vec![square("low", 2.0, 1.0), square("high", 3.0, 0.25)]);
    for object in scene.objects.iter_mut().filter(|object| object.name != "floor") {
        // Hidden, or they hid the floor where the eye looks down on it.
        object.visible = false;
    }
    scene.lights.push(Light::directional([0.0, 1.0, 0.0]));
    scene
}

/// The floor's point at a pixel's centre: an eye 10 m above it sees 20 m across in 200 pixels.
fn floor_at(tracer: &Tracer, [x, y]: [u32; 2]) -> DVec3 {
    let [across, down] = [x, y].map(|at| ((f64::from(at) + 0.5) / 10.0 - 10.0).abs());
    let seen = tracer.seen_at([x, y].map(|at| f64::from(at) + 0.5)).expect("the floor").point;
    // Which way the picture's up is does not matter here.
    assert!(seen.abs().abs_diff_eq(DVec3::new(across, 0.0, down), 1e-9), "{seen}");
    seen
}

#[test]
fn a_ray_names_what_it_meets_and_how_far_that_is() {
    let scene = boards();
    let tracer = Tracer::new(&scene, [200, 200]).expect("a tracer");
    let follower = RayFollower::new(&scene, [200, 200]).expect("a scene");
    let lamp = DVec3::new(0.0, 4.0, 0.0);
    for pixel in [[95, 103], [112, 91], [104, 115]] {
        let rays = follower.at(pixel);
        let [of_lamp, of_sun] = &rays[..] else { panic!("two lights: {rays:?}") };
        let point = floor_at(&tracer, pixel);
        let way = lamp.distance(point);
        // A board at height h of a lamp at 4 m is met at h / 4 of the way.
        let names: Vec<&str> = of_lamp.occluders.iter().map(|one| one.object.as_str()).collect();
        let at_high = (point / 4.0).abs().max_element();
        let expected: &[&str] = if at_high < 0.25 { &["low", "high"] } else { &["low"] };
        assert_eq!((names.as_slice(), of_lamp.label), (expected, PixelLabel::Shadow), "{pixel:?}");
        for (occluder, height) in of_lamp.occluders.iter().zip([2.0, 3.0]) {
            let from_surface = way * height / 4.0;
            assert!((occluder.from_surface - from_surface).abs() < 1e-9, "{pixel:?}: {occluder:?}, {from_surface}");
            assert!((occluder.from_light.expect("a lamp") - (way - from_surface)).abs() < 1e-9, "{occluder:?}");
            // The triangle is the one whose corners surround where the ray goes through it.
            let met = point + (lamp - point) * (height / 4.0);
            let object = scene.objects.iter().find(|object| object.name == occluder.object).expect("an object");
            let corners = object.mesh.triangles()[occluder.triangle].map(|v| object.world_positions()[v as usize]);
            let [a, b, c] = corners;
            let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).cross(met - from).y);
            assert!(sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0), "{occluder:?}");
        }
        let is_under = point.abs().max_element() < 1.0;
        assert_eq!(of_sun.label == PixelLabel::Shadow, is_under, "{pixel:?}");
        assert!(of_sun.occluders.iter().all(|one| one.from_light.is_none()));
        let words = of_lamp.text();
        assert!(words.contains("kept away by triangle ") && words.contains(" of low, "), "{words}");
        assert_eq!(words.contains("1 more triangle behind it"), at_high < 0.25, "{words}");
    }
    // Beyond the boards' shadows, which reach to 2 m.
    let free = follower.at([150, 60]);
    assert!(free.iter().all(|ray| ray.label == PixelLabel::Lit && ray.occluders.is_empty()), "{free:?}");
    assert!(free[0].text().contains("nothing is between it and the surface"));
}

#[test]
fn a_surface_that_faces_away_or_receives_nothing_says_so_and_the_background_has_no_ray() {
    let mut scene = from_above(vec![square("board", 2.0, 1.0)]);
    scene.objects[0].receives = false;
    scene.objects[1].visible = false;
    let of = |scene: &Scene, at| RayFollower::new(scene, [200, 200]).expect("a scene").at(at);
    let [ray] = &of(&scene, [100, 104])[..] else { panic!("one light") };
    assert_eq!((ray.label, ray.occluders.len()), (PixelLabel::Lit, 1), "{ray:?}");
    assert!(ray.text().contains("receives no shadow, though triangle"), "{}", ray.text());
    scene.lights[0] = Light::point([0.0, -4.0, 0.0]);
    assert!(of(&scene, [100, 104])[0].text().contains("faces away"));
    scene.objects.retain(|object: &Object| object.name != "floor");
    assert!(of(&scene, [100, 104]).is_empty());
}

#[test]
fn pixel_names_what_keeps_the_light_away_under_every_technique() {
    let work = folder();
    for technique in ["ray-traced", "z-fail", "shadow-map"] {
        let printed = |more: &[&str]| {
            let of = ["pixel", "tori", "-t", technique, "--size", "160x120", "--at", "80,60", "--at", "60,100"];
            text(&run(work.path(), &[&of[..], more].concat()).stdout)
        };
        let words = printed(&[]);
        assert_eq!(words.matches(", by its ray: ").count(), 2, "{technique}: {words}");
        let json: serde_json::Value = serde_json::from_str(&printed(&["--json"])).expect("JSON");
        for of_pixel in json.as_array().expect("two pixels") {
            let ray = &of_pixel["rays"][0];
            let shown = &of_pixel["shading"]["lights"][0]["label"];
            assert_eq!(&ray["label"], shown, "{technique}: {ray}");
            let count = ray["occluders"].as_array().map_or(0, Vec::len);
            assert_eq!(count > 0, ray["label"] == "in shadow" || (ray["label"] == "faces away" && count > 0));
        }
        crate::help::assert_json_is_explained("pixel", &json);
    }
}
