//! Two captures compared: folders with one bit flipped, passes that only one has, two techniques, and the command.

use crate::commands::{assert_fails, done, read_json, run, text};
use crate::common::{cuboid, from_above, judged, mesh, names, request, request_with, session, square};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use stencilscope::capture::disk::{read, write};
use stencilscope::capture::{Capture, Image, PixelFormat, Snapshot};
use stencilscope::difference::{
    AspectChange, AspectKind, ComparedSide, DifferenceError, PassDifference, Texel, compare,
};
use stencilscope::scene::{Light, Material, Object, Scene};
use stencilscope::session::SnapshotInterval;
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [61, 37];

fn scene() -> Scene {
    let mut scene = from_above(vec![square("caster", 2.0, 1.0), cuboid("a box", [3.0, 0.0, 0.0], [4.0, 3.9, 1.0])]);
    scene.lights.push(Light::directional(glam::DVec3::new(1.0, 2.0, 0.5)));
    scene
}

/// Flips the lowest bit of one byte of an array's data, counted from its end.
fn flip(file: &Path, from_end: usize) {
    let mut bytes = fs::read(file).expect("an array");
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let at = bytes.len() - from_end;
    assert!(at >= header, "within the data");
    bytes[at] ^= 1;
    fs::write(file, bytes).expect("written");
}

/// Indexes of the passes that name a file.
fn passes_of(manifest: &serde_json::Value, file: &str) -> Vec<usize> {
    let passes = manifest["passes"].as_array().expect("passes").iter().enumerate();
    let names = |pass: &serde_json::Value| pass.as_object().expect("a pass").values().any(|value| value == file);
    passes.filter(|(_, pass)| names(pass)).map(|(index, _)| index).collect()
}

fn first(difference: &stencilscope::difference::Difference) -> &PassDifference {
    difference.first().expect("a pass that differs")
}

/// The whole contract: whichever array of a folder has one bit flipped, the first pass that shows it is named,
/// with one texel. What no pass shows is named with its light.
#[test]
fn one_flipped_bit_in_any_array_is_found() {
    let parent = tempfile::tempdir().expect("a folder");
    let mut session = session();
    let (mut arrays, mut of_lights) = (0, 0);
    for technique in Technique::ALL {
        let capture = judged(&mut session, &scene(), technique, SIZE);
        let folder = parent.path().join(technique.name());
        write(&capture, &folder, false).expect("written");
        let good = read(&folder).expect("read");
        let manifest = read_json(&folder.join("manifest.json"));
        for file in names(&folder).iter().filter(|name| name.ends_with(".npy")) {
            let path = folder.join(file);
            let original = fs::read(&path).expect("an array");
            flip(&path, 4);
            let difference = compare(&good, &read(&folder).expect("still an array")).expect("one size");
            fs::write(&path, original).expect("mended");
            assert!(!difference.is_none(), "{file} of {}", technique.name());
            let aspects = match difference.first() {
                Some(pass) => {
                    let named = passes_of(&manifest, file);
                    assert!(pass.index[0].is_some_and(|index| named.contains(&index)), "{file}: {pass:?}");
                    if !file.contains(".map.") && !file.contains(".textures.") {
                        assert_eq!(pass.index, [named[0].into(); 2], "{file}: the first");
                    }
                    &pass.aspects
                }
                None => {
                    of_lights += 1;
                    &difference.lights.iter().find(|light| !light.aspects.is_empty()).expect("a light").aspects
                }
            };
            assert_eq!(aspects.len(), 1, "{file}");
            assert_eq!(aspects[0].pixels().map(|found| found.pixels), Some(1), "{file}");
            assert!(difference.first_place().is_some() && difference.shown(&good, &capture).is_none(), "{file}");
            arrays += 1;
        }
        assert!(compare(&good, &read(&folder).expect("mended")).expect("one size").is_none());
    }
    assert!(arrays > 60 && of_lights >= 4 * Technique::ALL.len(), "{arrays} arrays, {of_lights} of lights");
}

/// The capture with one texel of the aspect of a step changed.
fn with_texel(capture: &Capture, step: usize, format: PixelFormat, at: [u32; 2], texel: &[u8]) -> Capture {
    let mut capture = capture.clone();
    let Snapshot::Frame(frame) = &mut capture.steps[step].snapshot else { panic!("a picture") };
    let aspect = match format {
        PixelFormat::Rgba8Srgb => &mut frame.color,
        PixelFormat::Depth32F => &mut frame.depth,
        _ => frame.stencil.as_mut().expect("a stencil"),
    };
    let mut bytes: Vec<u8> = aspect.image.rows().flatten().copied().collect();
    let start = (at[1] * SIZE[0] + at[0]) as usize * texel.len();
    bytes[start..start + texel.len()].copy_from_slice(texel);
    aspect.image = Arc::new(Image::packed(format, SIZE, bytes));
    capture
}

#[test]
fn each_aspect_reports_its_values() {
    let good = session().capture(&scene(), &request(Technique::ZFail, SIZE)).expect("a capture");
    let at = [20, 30];
    let of = |changed: &Capture| {
        let difference = compare(&good, changed).expect("one size");
        let pass = first(&difference).clone();
        assert_eq!(difference.lights.iter().map(|light| light.aspects.len()).sum::<usize>(), 0);
        (pass, difference.to_text())
    };

    let (pass, text) = of(&with_texel(&good, 3, PixelFormat::Rgba8Srgb, at, &[1, 2, 3, 255]));
    assert_eq!((pass.name.as_str(), pass.light, pass.index), ("light", Some(0), [Some(3); 2]));
    assert_eq!(pass.aspects[0].aspect, AspectKind::Color);
    assert!(
        text.contains("first difference: pass 4, light 1: light\n  color: 1 pixel\n    most at 20,30: #"),
        "{text}"
    );
    assert!(text.contains("#010203 in B"), "{text}");

    let (pass, text) = of(&with_texel(&good, 1, PixelFormat::U8, at, &[255]));
    assert_eq!((pass.name.as_str(), pass.aspects[0].aspect), ("volumes", AspectKind::Stencil));
    assert!(text.contains("pass 2, light 1: volumes") && text.contains("in A, −1 (255) in B"), "{text}");

    // One bit of a depth; then a NaN, and another NaN.
    let depth = |value: u32| with_texel(&good, 0, PixelFormat::Depth32F, at, &value.to_le_bytes());
    let Snapshot::Frame(frame) = &good.steps[0].snapshot else { panic!("a picture") };
    let stored = frame.depth.image.depth_at(at).expect("a depth").to_bits();
    let (pass, text) = of(&depth(stored ^ 1));
    let found = pass.aspects[0].pixels().expect("pixels");
    assert_eq!(
        (pass.index[0], pass.aspects[0].aspect, found.pixels, found.region.bounds),
        (Some(0), AspectKind::Depth, 1, [20, 30, 20, 30])
    );
    assert_eq!(found.largest.values, [stored, stored ^ 1].map(|bits| Texel::Float(f32::from_bits(bits))));
    for bits in [stored, stored ^ 1] {
        assert!(text.contains(&format!("{:?} (0x{bits:08x})", f32::from_bits(bits))), "{text}");
    }
    let (_, text) = of(&depth(0x7fc0_0001));
    assert!(text.contains("NaN (0x7fc00001) in B: one is no number"), "{text}");
    let difference = compare(&depth(0x7fc0_0000), &depth(0x7fc0_0001)).expect("one size");
    assert_eq!(first(&difference).aspects[0].pixels().expect("pixels").pixels, 1, "payloads are compared");
    let text = difference.to_text();
    assert!(text.contains("in bits alone"), "{text}");
    let document: serde_json::Value = serde_json::from_str(&difference.to_json().expect("JSON")).expect("JSON");
    let texel = &document["passes"][0]["aspects"][0]["largest"];
    assert_eq!((&texel["a"], &texel["by"]), (&serde_json::Value::Null, &0.0.into()));
    assert_eq!(texel["bits"], serde_json::json!(["0x7fc00000", "0x7fc00001"]));
}

#[test]
fn a_difference_that_goes_on_is_reported_as_carried() {
    let mut session = session();
    let [good, other] = ["all", "light-facing"].map(|casters| {
        let request = request_with(Technique::ZFail, &[("casters", casters)], SIZE);
        // A square that faces away from the light casts only among all.
        let corners = [[-1.0, 2.0, -1.0], [-1.0, 2.0, 1.0], [1.0, 2.0, 1.0], [1.0, 2.0, -1.0]];
        let flipped = mesh(&corners, &[[0, 2, 1], [0, 3, 2]]);
        let scene = from_above(vec![Object::new("turned", flipped, Material::default())]);
        session.capture(&scene, &request).expect("a capture")
    });
    let difference = compare(&good, &other).expect("one size");
    let volumes = first(&difference);
    assert_eq!((volumes.name.as_str(), volumes.light), ("volumes", Some(0)));
    let mask = difference.passes.iter().find(|pass| pass.name == "mask").expect("a mask");
    assert!(mask.aspects.iter().any(|aspect| aspect.aspect == AspectKind::Stencil && aspect.carried));
    assert!(mask.aspects.iter().any(|aspect| aspect.aspect == AspectKind::Labels && !aspect.carried));
    let light = &difference.lights[0];
    let changed: u64 = light.labels.values().sum();
    let labels = light.aspects.iter().find(|aspect| aspect.aspect == AspectKind::Labels).expect("labels");
    assert_eq!(Some(changed), labels.pixels().map(|found| found.pixels));
    assert!(light.labels.contains_key(&[1, 0]), "{:?}", light.labels);
    let text = difference.to_text();
    assert!(text.contains("setting casters: all in A, light-facing in B\n"), "{text}");
    assert!(text.contains("as before") && text.contains("in shadow in A, lit in B"), "{text}");
}

#[test]
fn passes_of_one_frame_alone_are_named() {
    let mut session = session();
    let [volumes, map] = [Technique::ZFail, Technique::ShadowMap]
        .map(|technique| session.capture(&scene(), &request(technique, SIZE)).expect("a capture"));
    let difference = compare(&volumes, &map).expect("one size");
    let alone = |side: ComparedSide| -> Vec<&str> {
        difference.passes.iter().filter(|pass| pass.only_in() == Some(side)).map(|pass| pass.name.as_str()).collect()
    };
    assert!(alone(ComparedSide::A).contains(&"volumes") && !alone(ComparedSide::B).is_empty(), "{difference:?}");
    assert!(alone(ComparedSide::B).iter().all(|name| name.contains("map")), "{:?}", alone(ComparedSide::B));
    let of_both = difference.passes.iter().filter(|pass| pass.only_in().is_none());
    assert!(of_both.clone().any(|pass| pass.name == "light"));
    let stencil = of_both.flat_map(|pass| &pass.aspects).find(|aspect| aspect.aspect == AspectKind::Stencil);
    assert_eq!(stencil.map(|aspect| aspect.found), Some(AspectChange::OnlyIn(ComparedSide::A)));
    let text = difference.to_text();
    assert!(text.contains("technique: z-fail in A, shadow-map in B\n") && text.contains("only in B"), "{text}");
    // The comparison in the opposite direction.
    let reversed = compare(&map, &volumes).expect("one size");
    assert_eq!(reversed.passes.len(), difference.passes.len());
    assert_eq!(reversed.lights[0].labels.values().sum::<u64>(), difference.lights[0].labels.values().sum::<u64>());
}

#[test]
fn a_pass_that_is_left_out_is_the_first_difference() {
    let good = session().capture(&scene(), &request(Technique::ZFail, SIZE)).expect("a capture");
    let mut shorter = good.clone();
    shorter.steps.remove(2);
    let difference = compare(&good, &shorter).expect("one size");
    assert_eq!((first(&difference).only_in(), first(&difference).index), (Some(ComparedSide::A), [Some(2), None]));
    assert!(difference.to_text().contains("first difference: pass 3 in A alone, light 1: mask\n"));
    assert_eq!(difference.passes.last().map(|pass| pass.index), Some([Some(6), Some(5)]));
    assert!(difference.first_in_pixels().is_none() && difference.shown(&good, &shorter).is_none());
}

#[test]
fn the_draw_that_differs_is_named() {
    let mut session = session();
    let mut request = request(Technique::ZFail, SIZE);
    request.every = SnapshotInterval::Draw;
    let capture = session.capture(&scene(), &request).expect("a capture");
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("out");
    write(&capture, &folder, false).expect("written");
    let files = names(&folder);
    let file = files.iter().find(|name| name.starts_with("001-volumes.draw") && name.ends_with("stencil.npy"));
    let file = file.expect("a draw's stencil");
    flip(&folder.join(file), 1);
    let difference = compare(&capture, &read(&folder).expect("read")).expect("one size");
    let pass = first(&difference);
    assert_eq!((pass.name.as_str(), pass.aspects.len()), ("volumes", 0), "the pass ends as it did");
    let index: usize = file["001-volumes.draw".len()..][..3].parse().expect("a number");
    assert_eq!(pass.draws[0].index, [index; 2]);
    assert!(difference.to_text().contains(&format!("first draw that differs: {}: ", index + 1)));
}

#[test]
fn conditions_count_and_what_was_asked_does_not() {
    let good = session().capture(&scene(), &request(Technique::ZFail, SIZE)).expect("a capture");
    let mut asked = good.clone();
    asked.settings.insert("operations".to_owned(), "clamp".to_owned());
    asked.adapter.name = "another".to_owned();
    asked.plan_text = asked.plan_text.replacen("pass", "step", 1);
    let difference = compare(&good, &asked).expect("one size");
    assert!(difference.is_none() && difference.first_place().is_none());
    assert_eq!(difference.asked.len(), 2);
    assert!(difference.to_text().ends_with("the same: all 7 passes, every pixel\n"), "{}", difference.to_text());
    let mut planned = good.clone();
    planned.plan_text = planned.plan_text.replacen("\nlight", "\nlamp", 1) + "one line more\n";
    let difference = compare(&good, &planned).expect("one size");
    assert!(difference.is_none() && difference.asked[0].what.starts_with("plan, from line "), "{difference:?}");
    let mut seen = good.clone();
    seen.camera.eye.x += 1e-9;
    seen.lights[1].position.x = 2.0;
    let difference = compare(&good, &seen).expect("one size");
    assert!(!difference.is_none());
    assert_eq!(
        difference.conditions.iter().map(|note| note.what.as_str()).collect::<Vec<_>>(),
        ["camera's eye", "light 2"]
    );
    assert_eq!(difference.first_place().as_deref(), Some("camera's eye"));
    let mut smaller = good.clone();
    smaller.size = [60, 37];
    assert_eq!(compare(&good, &smaller), Err(DifferenceError::Sizes { sizes: [SIZE, [60, 37]] }));
}

/// The program, from outside.
#[test]
fn the_command_reports_in_every_form_and_by_its_exit_code() {
    let folder = crate::commands::folder();
    let capture = |name: &str, technique: &str| {
        done(folder.path(), &["capture", "triangle.obj", "--size", "48x32", "-o", name, "-t", technique]);
    };
    capture("a", "z-fail");
    capture("b", "z-fail");
    let same = run(folder.path(), &["diff", "a", "b"]);
    assert_eq!((same.status.code(), text(&same.stderr)), (Some(0), String::new()));
    assert!(text(&same.stdout).contains("A  a: triangle, z-fail, 48x32, 4 passes\nB  b: "), "{}", text(&same.stdout));
    assert!(text(&same.stdout).ends_with("the same: all 4 passes, every pixel\n"), "{}", text(&same.stdout));

    flip(&folder.path().join("b/001-volumes.stencil.npy"), 100);
    let differs = run(folder.path(), &["diff", "a", "b", "-o", "where.png"]);
    assert_eq!(differs.status.code(), Some(1));
    assert_eq!(text(&differs.stderr), "stencilscope: they differ, first in pass 2, light 1: volumes\n");
    let printed = text(&differs.stdout);
    for words in [
        "first difference: pass 2, light 1: volumes\n  stencil: 1 pixel\n",
        "most at 44,29: ",
        "where.png: stencil of A",
    ] {
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    let picture = fs::File::open(folder.path().join("where.png")).expect("a picture");
    let reader = png::Decoder::new(std::io::BufReader::new(picture)).read_info().expect("a PNG");
    assert_eq!([reader.info().width, reader.info().height], [3 * 48 + 4 * 8, 32 + 2 * 8]);

    let output = run(folder.path(), &["diff", "a", "b", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&document["equal"], &document["schema"]), (&false.into(), &1.into()));
    assert_eq!(document["first"], serde_json::json!({"name": "volumes", "light": 0, "index": [1, 1]}));
    let aspect = &document["passes"][1]["aspects"][0];
    assert_eq!((&aspect["aspect"], &aspect["pixels"]), (&"stencil".into(), &1.into()));
    assert_eq!(aspect["region"]["box"], serde_json::json!([44, 29, 44, 29]));
    crate::help::assert_json_is_explained("diff", &document);
    let output = run(folder.path(), &["diff", "a", "b", "--json", "d.json"]);
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(1), String::new()));
    assert_eq!(read_json(&folder.path().join("d.json")), document);
}

#[test]
fn the_command_compares_techniques_and_settings_of_a_scene() {
    let folder = crate::commands::folder();
    let diff = |options: &[&str]| {
        let output = run(folder.path(), &[&["diff", "triangle.obj", "--size", "48x32"], options].concat());
        (output.status.code(), text(&output.stdout) + &text(&output.stderr))
    };
    let (code, printed) = diff(&["-t", "z-pass", "-t", "z-fail"]);
    assert!(printed.starts_with("A  triangle, z-pass, 48x32, 4 passes\nB  triangle, z-fail, 48x32"), "{printed}");
    assert_eq!(code, Some(i32::from(!printed.contains("the same: all"))), "{printed}");
    let (code, printed) = diff(&["-t", "z-fail", "--set-b", "faces=two-pass"]);
    assert!(printed.contains("setting faces: two-sided in A, two-pass in B\n"), "{printed}");
    assert_eq!(code, Some(1), "another number of passes: {printed}");
    let (code, printed) = diff(&["-t", "z-fail", "--set-b", "silhouette=edge-list"]);
    assert_eq!(code, Some(0), "{printed}");
    let (code, printed) = diff(&["-t", "none", "-t", "z-fail", "-o", "p.png"]);
    assert_eq!(code, Some(1));
    assert!(printed.contains("p.png: ") && folder.path().join("p.png").is_file(), "{printed}");
}

#[test]
fn what_can_not_be_compared_is_refused_in_one_line_with_the_fix() {
    let cases: &[(&[&str], &[&str])] = &[
        (&["tori"], &["both are auto", "--set-b"]),
        (&["tori", "-t", "z-fail", "-t", "z-fail"], &["both are z-fail", "--set-b KEY=VALUE"]),
        (&["tori", "-t", "z-fail", "-t", "z-fial"], &["did you mean `z-fail`?"]),
        (&["tori", "-t", "none", "-t", "z-fail", "-t", "z-pass"], &["3 techniques", "name two"]),
        (&["tori", "rings"], &["`tori` is no capture folder", "name two folders"]),
        (&["models", "models"], &["`models` is no capture folder", "manifest.json"]),
        (&["models", "models", "-t", "z-fail"], &["cannot be used with"]),
        (&["models", "models", "--size", "64x64"], &["cannot be used with"]),
        (&["tori", "-t", "none", "--set-b", "fases=two-sided"], &["fases"]),
        (&["tori", "-t", "none", "-t", "z-fail", "-o", "a.jpg"], &["ends in .png"]),
        (&["tori", "-t", "none", "-t", "z-fail", "-o", "missing/a.png"], &["missing/a.png"]),
        (&["tori", "-t", "none", "-t", "z-fail", "--every", "frame"], &["`pass` or `draw`"]),
        (&[], &["<A>"]),
    ];
    for (arguments, words) in cases {
        assert_fails(&[&["diff"], *arguments].concat(), 2, words);
    }
    let folder = crate::commands::folder();
    let capture = |name: &str, size: &str| {
        done(folder.path(), &["capture", "triangle.obj", "--size", size, "-o", name]);
    };
    capture("a", "48x32");
    capture("b", "32x32");
    let refused = |arguments: &[&str], words: &str| {
        let output = run(folder.path(), &[&["diff"], arguments].concat());
        let line = text(&output.stderr);
        assert_eq!((output.status.code(), line.trim_end().lines().count()), (Some(2), 1), "{line}");
        assert!(line.contains(words), "{line}");
    };
    refused(&["a", "b"], "48x32 and 32x32 pixels: capture both with one --size");
    refused(&["a"], "`a` is a capture folder: name the other one too");
    refused(&["a", "triangle.obj"], "`triangle.obj` is no capture folder (it is a file): name two folders");
    refused(&["a", "nowhere"], "`nowhere` is no capture folder (there is no such folder)");
    fs::write(folder.path().join("b/manifest.json"), "{").expect("broken on purpose");
    refused(&["a", "b"], "b/manifest.json");
    fs::remove_file(folder.path().join("a/light0.shadow.npy")).expect("broken on purpose");
    refused(&["a", "a"], "a/light0.shadow.npy");
}
