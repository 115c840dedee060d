//! The terms of shading that are reported for a pixel, compared with the picture that the GPU made of them.

use crate::commands::{assert_fails, done, folder, printed_json, run, text};
use crate::common::shade::{shaded, srgb};
use crate::common::{choice, labels, last_frame, opened};
use std::f64::consts::FRAC_1_SQRT_2;
use stencilscope::reading::shading::{LightTerms, SurfaceShading};
use stencilscope::scene::{Light, Material, Object, Projection, Scene, SceneBuilder, Shading, shapes};
use stencilscope::technique::Technique;
use stencilscope::testing::{PixelLabel, Rendered};

const SIZE: [u32; 2] = [96, 72];

fn rendered(scene: &Scene, technique: Technique, settings: &[(&str, &str)]) -> Rendered {
    Rendered::new(scene, choice(technique, settings), SIZE).expect("a frame")
}

/// Every pixel that was looked at has the colour that its terms add up to.
#[track_caller]
fn assert_terms_make_the_picture(frame: &mut Rendered, what: &str) {
    let mut compared = 0;
    for [x, y] in (2..SIZE[1]).step_by(5).flat_map(|y| (2..SIZE[0]).step_by(7).map(move |x| [x, y])) {
        let Some(found) = shaded(frame, [x, y]) else { continue };
        let stored = last_frame(frame.capture()).color.image.rgba_at([x, y]).expect("a pixel");
        let arriving = found.lights.iter().filter(|light| light.label == Some(PixelLabel::Lit));
        let lights: Vec<[f64; 3]> = arriving.map(|light| light.adds).collect();
        for channel in 0..3 {
            let sum = found.unlit[channel] + lights.iter().map(|adds| adds[channel]).sum::<f64>();
            // Each pass rounds what it leaves to eight bits of sRGB, where dark steps are wide for the next.
            let most = 1.1 + 2.0 * lights.len() as f64;
            let (stored, expected) = (f64::from(stored[channel]), srgb(sum));
            assert!((stored - expected).abs() <= most, "{what}, {x},{y}: {stored} is not {expected}: {found:?}");
        }
        let sum = [0, 1, 2].map(|channel| found.unlit[channel] + lights.iter().map(|adds| adds[channel]).sum::<f64>());
        let total = found.total.expect("nothing is blended over it");
        assert!(
            (0..3).all(|channel| (total[channel] - sum[channel]).abs() < 1e-9),
            "{what}, {x},{y}: {total:?} {sum:?}"
        );
        let channels = found.channels.expect("nothing is blended over it");
        let [ambient, emissive] = [channels.ambient, channels.emissive];
        assert!(
            (0..3).all(|channel| ambient[channel] + emissive[channel] == found.unlit[channel]),
            "{what}: {found:?}"
        );
        // Each part by the formula: what arrives times the surface's colour, or times the highlight.
        let of_lights = |part: &dyn Fn(&LightTerms, usize) -> f64, channel: usize| {
            let arriving = found.lights.iter().filter(|light| light.label == Some(PixelLabel::Lit));
            arriving.map(|light| light.color[channel] * light.fading * part(light, channel)).sum::<f64>()
        };
        for channel in 0..3 {
            let diffuse = of_lights(&|light, channel| found.color[channel] * light.diffuse, channel);
            let specular = of_lights(&|light, _| light.highlight, channel);
            assert!((channels.diffuse[channel] - diffuse).abs() < 1e-12, "{what}: {channels:?}, {diffuse}");
            assert!((channels.specular[channel] - specular).abs() < 1e-12, "{what}: {channels:?}, {specular}");
        }
        compared += 1;
    }
    assert!(compared > 60, "{what}: {compared}");
}

#[test]
fn the_terms_of_a_pixel_add_up_to_its_colour() {
    for shading in ["as-given", "flat", "gouraud", "phong"] {
        for diffuse in ["lambert", "wrapped"] {
            let settings = [("shading", shading), ("diffuse", diffuse)];
            for name in ["spheres", "two-lights"] {
                // A count of wrapped light is another matter where a surface faces away: none is asked here.
                let technique = if diffuse == "wrapped" { Technique::None } else { Technique::ZFail };
                let mut frame = rendered(&opened(name), technique, &settings);
                if diffuse == "lambert" {
                    assert_terms_make_the_picture(&mut frame, &format!("{name} {settings:?}"));
                } else {
                    assert_wrapped(&mut frame, &format!("{name} {settings:?}"));
                }
            }
        }
    }
    // A range, and a checkerboard.
    assert_terms_make_the_picture(&mut rendered(&opened("tiger-cage"), Technique::ZFail, &[]), "tiger-cage");
    let board = Material { checks: 0.5, specular: 0.6, shininess: 2.0, ..Material::default() };
    for shading in Shading::ALL {
        let board = Object {
            material: Material { shading, ..board },
            ..Object::of("board", shapes::quad([8.0; 2]).expect("a board"))
        };
        let scene = SceneBuilder::new("checks")
            .object(board)
            .light(Light::point([1.0, 3.0, 0.5]))
            .seen_from([0.3, 4.0, 3.0], [0.0; 3])
            .build();
        assert_terms_make_the_picture(&mut rendered(&scene, Technique::ZFail, &[]), "checks");
        // Parallel view rays have highlights elsewhere.
        let mut scene = scene;
        scene.camera.projection = Projection::Orthographic { half_height: 2.0 };
        assert_terms_make_the_picture(&mut rendered(&scene, Technique::ZFail, &[]), "checks, parallel");
    }
}

/// Wrapped light is added where a surface faces away too.
#[track_caller]
fn assert_wrapped(frame: &mut Rendered, what: &str) {
    let mut away = 0;
    for [x, y] in (2..SIZE[1]).step_by(5).flat_map(|y| (2..SIZE[0]).step_by(7).map(move |x| [x, y])) {
        let Some(found) = shaded(frame, [x, y]) else { continue };
        let stored = last_frame(frame.capture()).color.image.rgba_at([x, y]).expect("a pixel");
        away += u32::from(found.lights.iter().any(|light| light.cosine < 0.0 && light.diffuse > 0.0));
        for channel in 0..3 {
            let sum = found.unlit[channel] + found.lights.iter().map(|light| light.adds[channel]).sum::<f64>();
            let most = 1.1 + 2.0 * found.lights.len() as f64;
            let (stored, expected) = (f64::from(stored[channel]), srgb(sum));
            assert!((stored - expected).abs() <= most, "{what}, {x},{y}: {stored} is not {expected}: {found:?}");
        }
    }
    assert!(away > 0, "{what}: light reaches round nothing");
}

#[test]
fn a_light_at_45_degrees_has_the_cosine_of_45_degrees() {
    let scene = SceneBuilder::new("a floor")
        .ambient([0.25; 3])
        .object(Object {
            material: Material::matte([0.5, 1.0, 0.0]),
            ..Object::of("floor", shapes::quad([8.0; 2]).expect("a floor"))
        })
        .light(Light { intensity: 0.5, ..Light::directional([1.0, 1.0, 0.0]) })
        .seen_from([0.0, 5.0, 0.0], [0.0; 3])
        .build();
    let mut frame = rendered(&scene, Technique::ZFail, &[]);
    let found = shaded(&mut frame, [48, 36]).expect("a surface");
    let near = |found: [f64; 3], expected: [f64; 3]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} is not {expected:?}");
    };
    assert_eq!((found.surface.as_str(), found.shading, found.diffuse), ("floor", "flat", "lambert"));
    near(found.normal, [0.0, 1.0, 0.0]);
    near(found.unlit, [0.125, 0.25, 0.0]);
    let light = &found.lights[0];
    near([light.cosine, light.diffuse, light.highlight], [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0]);
    near(light.adds, [0.25 * FRAC_1_SQRT_2, 0.5 * FRAC_1_SQRT_2, 0.0]);
    assert_eq!((light.label, light.fading, light.is_turned_away), (Some(PixelLabel::Lit), 1.0, false));
    let line = "light 1: cosine N·L 0.7071; (0.5, 0.5, 0.5) × fading 1 × ((0.5, 1, 0) × diffuse 0.7071 + highlight 0) = \
                (0.1768, 0.3536, 0); it arrives";
    assert!(found.text().contains(line), "{}", found.text());
    let channels = found.channels.expect("nothing is blended");
    near(channels.ambient, [0.125, 0.25, 0.0]);
    near(channels.diffuse, [0.25 * FRAC_1_SQRT_2, 0.5 * FRAC_1_SQRT_2, 0.0]);
    assert_eq!((channels.emissive, channels.specular), ([0.0; 3], [0.0; 3]));
    let line =
        "which is ambient (0.125, 0.25, 0) + emissive (0, 0, 0) + diffuse (0.1768, 0.3536, 0) + specular (0, 0, 0)";
    assert!(found.text().contains(line), "{}", found.text());
}

#[test]
fn pixel_reports_the_cosine_and_explains_each_key() {
    let folder = folder();
    let mut frame = rendered(&opened("spheres"), Technique::ZFail, &[("shading", "gouraud")]);
    let [x, y] = frame.first_labelled(0, PixelLabel::Lit).expect("light");
    let found = shaded(&mut frame, [x, y]).expect("a surface");
    let at = format!("{x},{y}");
    let arguments = ["pixel", "spheres", "-t", "z-fail", "--set", "shading=gouraud", "--size", "96x72", "--at", &at];
    let printed = text(&run(folder.path(), &arguments).stdout);
    assert!(printed.contains(&found.text()), "{}\nis not in\n{printed}", found.text());
    let document = printed_json(folder.path(), &[&arguments[..], &["--json"]].concat());
    assert_eq!(document["shading"]["lights"][0]["cosine"].as_f64(), Some(found.lights[0].cosine));
    assert!(document["shading"]["lights"][0]["corner_cosines"].is_array());
    crate::help::assert_json_is_explained("pixel", &document);
    let nothing = ["pixel", "triangle.obj", "--no-floor", "-t", "z-fail", "--size", "96x72", "--at", "0,0", "--json"];
    assert!(printed_json(folder.path(), &nothing)["shading"].is_null());
}

/// The pixels of which the sum of all light is known, with what the picture has there in sRGB.
fn totals(frame: &mut Rendered, what: &str) -> Vec<([u32; 2], SurfaceShading)> {
    let mut found = Vec::new();
    let passes = frame.plan().passes.iter().filter(|pass| pass.timed && pass.color.is_some()).count();
    for at in (2..SIZE[1]).step_by(3).flat_map(|y| (2..SIZE[0]).step_by(5).map(move |x| [x, y])) {
        let Some(shading) = shaded(frame, at) else { continue };
        let Some(total) = shading.total else { continue };
        let stored = last_frame(frame.capture()).color.image.rgba_at(at).expect("a pixel");
        for channel in 0..3 {
            let (stored, expected) = (f64::from(stored[channel]), srgb(total[channel]));
            let most = 1.1 + 2.0 * passes as f64;
            assert!((stored - expected).abs() <= most, "{what}, {at:?}: {stored} is not {expected}: {shading:?}");
        }
        found.push((at, shading));
    }
    assert!(found.len() > 60, "{what}: {}", found.len());
    found
}

/// A pane colours what it lets through, and the sum says so: red arrives, and less of blue.
#[test]
fn the_total_under_a_tinted_caster_has_the_colour_that_it_lets_through() {
    for technique in [Technique::Projective, Technique::PlanarTexture] {
        let mut frame = rendered(&opened("glass"), technique, &[]);
        let found = totals(&mut frame, technique.name());
        let tinted = found.iter().filter(|(_, shading)| {
            let (channels, light) = (shading.channels.expect("channels"), &shading.lights[0]);
            let share = |channel: usize| {
                channels.diffuse[channel]
                    / (light.adds[channel] - light.color[channel] * light.fading * light.highlight)
            };
            let (red, blue) = (share(0), share(2));
            (0.05..0.95).contains(&red) && (red - blue).abs() > 0.1
        });
        let tinted = tinted.count();
        assert!(tinted > 5, "{}: {tinted} of {} are tinted", technique.name(), found.len());
    }
}

/// A share of the diffuse light arrives whatever stands between: shadows are brighter by it, and nothing else changes.
#[test]
fn a_share_of_diffuse_light_belongs_to_the_ambient_light() {
    for technique in [
        Technique::ZFail,
        Technique::ZPass,
        Technique::Auto,
        Technique::ShadowMap,
        Technique::Planar,
        Technique::PlanarTexture,
        Technique::Projective,
        Technique::RayTraced,
    ] {
        for name in ["spheres", "two-lights"] {
            let what = format!("{name}, {}", technique.name());
            let mut without = rendered(&opened(name), technique, &[]);
            let mut with = rendered(&opened(name), technique, &[("ambient-diffuse", "0.25")]);
            assert_eq!(labels(without.capture()), labels(with.capture()), "{what}: no label changes");
            assert_eq!(with.plan().passes.len(), without.plan().passes.len() + with.plan().lights.len(), "{what}");
            let mut brighter = 0;
            for (at, shading) in totals(&mut with, &what) {
                let before = shaded(&mut without, at).and_then(|shading| shading.total).expect("a sum");
                let blocked = |light: &&LightTerms| light.label == Some(PixelLabel::Shadow) && !light.is_turned_away;
                let blocked = shading.lights.iter().filter(blocked);
                let more: f64 =
                    blocked.map(|light| 0.25 * light.color[0] * light.fading * shading.color[0] * light.diffuse).sum();
                let gained = shading.total.expect("a sum")[0] - before[0];
                let whole =
                    matches!(technique, Technique::Projective | Technique::PlanarTexture | Technique::ShadowMap);
                assert!(whole || (gained - more).abs() < 1e-5, "{what}, {at:?}: {gained} more, not {more}");
                brighter += u32::from(gained > 0.01);
            }
            // Planar shadows fall on the flat receivers alone.
            assert!(brighter > 3 || name == "spheres", "{what}: {brighter} are brighter");
        }
    }
    let scene = opened("two-lights");
    let mut frame = rendered(&scene, Technique::ZFail, &[("ambient-diffuse", "0.25")]);
    let at = frame.first_labelled(0, PixelLabel::Shadow).expect("a shadow");
    let text = shaded(&mut frame, at).expect("a surface").text();
    assert!(text.contains("this is in shadow, and 0.25 of the diffuse light is added all the same"), "{text}");
    // What the light pass did is not the ambient share's doing.
    let curve = frame.capture().depth;
    let story = frame.at(at).history().story(&curve);
    assert!(story.contains("so the light pass skips it"), "{story}");
}

/// Two floors in one plane: each light is added once there, of the share, too.
#[test]
fn surfaces_in_one_plane_have_the_share_once() {
    let floor = |name: &str| Object {
        material: Material::matte([0.5; 3]),
        ..Object::of(name, shapes::quad([8.0; 2]).expect("a floor"))
    };
    let scene = |objects: Vec<Object>| {
        let scene = SceneBuilder::new("floors").objects(objects).light(Light::point([1.0, 3.0, 0.5]));
        scene.seen_from([0.3, 4.0, 3.0], [0.0; 3]).build()
    };
    let mut pictures = Vec::new();
    for technique in [Technique::None, Technique::ZFail, Technique::Planar, Technique::RayTraced] {
        for objects in [vec![floor("one")], vec![floor("one"), floor("other")]] {
            let frame = rendered(&scene(objects), technique, &[("ambient-diffuse", "0.5")]);
            let rows = last_frame(frame.capture()).color.image.rows().map(<[u8]>::to_vec).collect::<Vec<_>>();
            pictures.push(rows);
        }
        let [.., one, two] = &pictures[..] else { panic!("two pictures") };
        assert!(one == two, "{}", technique.name());
    }
}

/// Two lamps over a white floor are more than a picture holds; shadows that are blended have no sum.
#[test]
fn what_is_more_than_one_saturates_and_pixel_says_so() {
    let lamp = |red: f32| Light { color: [red, 0.3, 0.3], ..Light::directional([0.0, 1.0, 0.0]) };
    let white = Material { color: [1.0; 3], ..Material::default() };
    let floor = Object { material: white, ..Object::of("floor", shapes::quad([8.0; 2]).expect("a floor")) };
    let scene = SceneBuilder::new("bright").ambient([0.1; 3]).object(floor).light(lamp(0.8)).light(lamp(0.5));
    let scene = scene.seen_from([0.3, 4.0, 3.0], [0.0; 3]).build();
    let mut frame = rendered(&scene, Technique::ZFail, &[]);
    let found = shaded(&mut frame, [48, 40]).expect("the floor");
    let total = found.total.expect("a sum");
    assert!((total[0] - 1.4).abs() < 1e-6 && (total[1] - 0.7).abs() < 1e-6, "{total:?}");
    let words = found.total_words();
    assert_eq!(words, "(1.4, 0.7, 0.7): red saturates, as a picture has no more than 1");
    assert!(found.text().contains(&format!("together {words}\n")), "{}", found.text());
    let stored = last_frame(frame.capture()).color.image.rgba_at([48, 40]).expect("a pixel");
    assert!(stored[0] == 255 && stored[1] < 255, "{stored:?}");
    let mut blended = rendered(&opened("panels"), Technique::Planar, &[("blend", "twice")]);
    let found = shaded(&mut blended, [48, 40]).expect("a surface");
    assert_eq!(found.total, None);
    assert!(found.text().contains("together not a sum: a pass blends its shadow over the lit picture"));
}

#[test]
fn a_light_that_is_off_adds_nothing_and_keeps_its_place() {
    let whole = opened("two-lights");
    let mut off = whole.clone();
    off.lights[0].is_on = false;
    let mut alone = whole.clone();
    alone.lights.remove(0);
    let picture = |scene: &Scene| {
        let frame = rendered(scene, Technique::ZFail, &[]);
        let rows = last_frame(frame.capture()).color.image.rows().map(<[u8]>::to_vec);
        (frame.capture().lights.len(), rows.collect::<Vec<_>>())
    };
    let [(count, without), (_, removed), (_, both)] = [&off, &alone, &whole].map(picture);
    assert_eq!(count, 2, "numbers of lights stay");
    assert!(without == removed && without != both);
    let folder = folder();
    let pixel = ["pixel", "two-lights", "-t", "z-fail", "--size", "96x72", "--at", "48,40", "--json"];
    let document = printed_json(folder.path(), &[&pixel[..], &["--off", "1"]].concat());
    let color = |light: usize| document["shading"]["lights"][light]["color"].clone();
    assert_eq!(color(0), serde_json::json!([0.0, 0.0, 0.0]));
    assert_ne!(color(1), color(0));
    // Light 2 reaches this pixel, where light 1 is in shadow.
    let story = ["pixel", "two-lights", "-t", "z-fail", "--size", "640x360", "--at", "300,200"];
    let adds = |more: &[&str]| {
        let story = done(folder.path(), &[&story[..], more].concat());
        let line = story.lines().find(|line| line.starts_with("  light 2: ")).map(str::to_owned);
        line.and_then(|line| line.split_once(", so ").map(|(_, end)| end.to_owned()))
    };
    assert_eq!(adds(&[]).as_deref(), Some("the light pass adds the light"));
    assert_eq!(adds(&["--off", "2"]).as_deref(), Some("the light pass would add the light, but it is off, or black"));
    assert_fails(&["capture", "two-lights", "--off", "3", "-o", "out"], 2, &["--off 3", "lights 1 to 2"]);
    assert_fails(&["capture", "two-lights", "--off", "0", "-o", "out"], 2, &["--off"]);
}
