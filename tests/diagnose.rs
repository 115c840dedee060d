//! The command `diagnose`: what it says in text, JSON and pictures, and the fixed scene that it writes.

use crate::commands::{assert_fails, run, text};
use crate::common::names;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use stencilscope::diagnosis::Cause;

const SMALL: [&str; 2] = ["--size", "160x120"];

fn diagnose(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = run(folder, &[&["diagnose"], &SMALL[..], arguments].concat());
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// An eye within the shadow of a board over the floor.
fn shaded(folder: &Path) {
    fs::write(
        folder.join("shaded.toml"),
        "[camera]\neye = [0.0, 1.0, 3.0]\ntarget = [0.0, 0.5, 0.0]\nnear = 0.05\n\
         [[lights]]\nkind = \"directional\"\ntowards = [0.0, 1.0, 1.0]\n\
         [[objects]]\nname = \"floor\"\nmesh = { shape = \"quad\", size = [20.0, 20.0] }\n\
         [[objects]]\nname = \"board\"\nmesh = { shape = \"box\", size = [2.0, 0.1, 2.0] }\ntranslate = [0.0, 3.0, 5.0]\n\
         [[objects]]\nname = \"ball\"\nmesh = { shape = \"sphere\", radius = 0.4, segments = [24, 12] }\ntranslate = [0.0, 0.6, 0.0]\n",
    )
    .expect("written");
}

#[test]
fn a_right_frame_needs_nothing() {
    let folder = crate::commands::folder();
    let (code, printed, error) = diagnose(folder.path(), &["tori", "-t", "z-fail", "--fix", "right.toml"]);
    assert_eq!((code, error.as_str()), (Some(0), ""), "{printed}");
    for words in [
        "tori, z-fail, 160x120: none of ",
        "right, the fastest first: ",
        "what to do: nothing: the shadows are right\n",
    ] {
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    assert!(printed.ends_with("right.toml: not written, as nothing is wrong\n"), "{printed}");
    assert!(!folder.path().join("right.toml").exists());
}

#[test]
fn the_text_says_what_is_wrong_why_and_what_to_do() {
    let folder = crate::commands::folder();
    shaded(folder.path());
    let (code, printed, error) = diagnose(folder.path(), &["shaded.toml", "-t", "z-pass"]);
    assert_eq!(code, Some(1), "{printed}");
    assert!(error.contains("eye-in-volume"), "{error}");
    assert_eq!(error.lines().count(), 1);
    for words in ["\n1. ", "   eye-in-volume (proven): ", "`-t z-fail`", "\n   as 1: eye-in-volume: "] {
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    // What a cause is, is said once.
    assert_eq!(printed.matches(Cause::EyeInVolume.meaning()).count(), 1, "{printed}");
}

/// What `--json` says, and the exit code.
fn document(folder: &Path, arguments: &[&str]) -> (Option<i32>, serde_json::Value) {
    let (code, printed, error) = diagnose(folder, &[arguments, &["--no-techniques", "--json"]].concat());
    (code, serde_json::from_str(&printed).unwrap_or_else(|_| panic!("no JSON:\n{printed}\n{error}")))
}

/// The first cause of each region, largest first.
fn first_causes(document: &serde_json::Value) -> Vec<&str> {
    let regions = document["regions"].as_array().expect("regions");
    regions.iter().map(|region| region["causes"][0]["cause"].as_str().unwrap_or("none")).collect()
}

/// The light stands in the hole of a torus: no point of it is on a line through the light to the plane's wrong pixels.
#[test]
fn a_triangle_across_the_lights_height_is_an_anti_shadow() {
    let folder = crate::commands::folder();
    let (code, found) = document(folder.path(), &["rings", "-t", "planar", "--set", "clip=off", "--light", "0,0.5,0"]);
    assert_eq!((code, first_causes(&found).first()), (Some(1), Some(&"anti-shadow")));
    assert!(!first_causes(&found).contains(&"none"), "{found}");
    let first = &found["regions"][0]["causes"][0];
    assert_eq!((&first["proof"], &first["mend"]["settings"]["clip"]), (&"proven".into(), &"on".into()));
    assert_eq!(
        (&found["advice"]["mend"]["settings"]["clip"], &found["advice"]["wrong_left"]),
        (&"on".into(), &0.into())
    );
}

/// A technique without shadows is no riddle, and a far plane before the floor is named, though its depth is clamped.
#[test]
fn what_was_not_asked_for_or_not_drawn_is_reported_as_such() {
    let folder = crate::commands::folder();
    let (code, printed, _) = diagnose(folder.path(), &["tori", "-t", "none", "--no-techniques"]);
    assert_eq!(code, Some(1), "{printed}");
    assert!(printed.contains("   no shadows were asked for: the technique is none\n"), "{printed}");
    let (_, found) = document(folder.path(), &["tori", "-t", "none"]);
    assert_ne!(found["advice"]["mend"]["technique"], serde_json::Value::Null);
    let clamped = ["tori", "-t", "z-fail", "--set", "depth=standard-finite-clamp", "--far", "3"];
    let (code, found) = document(folder.path(), &clamped);
    assert_eq!((code, first_causes(&found).first()), (Some(1), Some(&"far-clip")));
    assert!(!first_causes(&found).contains(&"none"), "{found}");
    let first = &found["regions"][0]["causes"][0];
    assert_eq!((&first["proof"], &first["mend"]["settings"]["depth"]), (&"proven".into(), &"reversed-infinite".into()));
}

/// The edges of a floor are edges of one triangle, but nothing lies behind it; those of a sheet over it matter.
#[test]
fn a_floor_is_no_open_mesh_and_a_sheet_over_it_is() {
    let folder = crate::commands::folder();
    let sheet = "[[objects]]\nname = \"sheet\"\nmesh = { shape = \"quad\", size = [0.5, 0.5] }\n";
    shaded(folder.path());
    let scene = fs::read_to_string(folder.path().join("shaded.toml")).expect("read");
    fs::write(folder.path().join("raised.toml"), format!("{scene}{sheet}translate = [0.0, 1.5, 0.0]\n"))
        .expect("written");
    fs::write(folder.path().join("lying.toml"), format!("{scene}{sheet}")).expect("written");
    for (file, open) in [("raised.toml", &[("sheet", "open-mesh", 4)][..]), ("lying.toml", &[])] {
        let (_, found) = document(folder.path(), &[file, "-t", "z-fail"]);
        let of_meshes = found["mesh_findings"].as_array().expect("findings").iter();
        let of_meshes = of_meshes.map(|one| {
            let word = |key: &str| one[key].as_str().expect("a word");
            (word("object"), word("cause"), one["count"].as_u64().expect("a count"))
        });
        let of_flat: Vec<_> = of_meshes.filter(|(object, ..)| ["floor", "sheet"].contains(object)).collect();
        assert_eq!(of_flat, open, "{file}");
    }
}

/// The remedy for holes in a mesh is the rule that looks for them: it leaves closed meshes their smaller volumes.
#[test]
fn what_mends_an_open_mesh_is_to_go_by_topology() {
    let folder = crate::commands::folder();
    let arguments = ["teapot-like", "-t", "z-fail", "--set", "casters=light-facing"];
    let (_, found) = document(folder.path(), &arguments);
    let causes = found["regions"].as_array().expect("regions").iter().map(|region| &region["causes"][0]);
    let open: Vec<_> = causes.filter(|cause| cause["cause"] == "open-mesh").collect();
    assert!(!open.is_empty(), "{found}");
    for cause in open {
        let mend = &cause["mend"]["settings"]["casters"];
        assert_eq!((&cause["proof"], mend), (&"proven".into(), &"by-topology".into()), "{cause}");
    }
}

/// A map is blamed for what its settings can fix, and all of the picture is right by z-fail.
#[test]
fn maps_are_reported_how_to_stay_maps() {
    let folder = crate::commands::folder();
    let (code, found) = document(folder.path(), &["steps", "-t", "shadow-map", "--set", "size=128"]);
    let advice = &found["advice"];
    assert_eq!((code, &advice["mend"]["technique"], &advice["wrong_left"]), (Some(1), &"z-fail".into(), &0.into()));
    let causes = found["regions"].as_array().expect("regions").iter();
    let causes: Vec<&serde_json::Value> =
        causes.flat_map(|region| region["causes"].as_array().expect("causes")).collect();
    let fixes_of = |name: &str| -> Vec<&serde_json::Value> {
        causes.iter().filter(|cause| cause["cause"] == name).map(|cause| &cause["mend"]["settings"]).collect()
    };
    for cause in ["aliasing", "peter-panning"] {
        let sets_something = |settings: &serde_json::Value| settings.as_object().is_some_and(|some| !some.is_empty());
        assert!(fixes_of(cause).into_iter().any(sets_something), "{cause}: {found}");
    }
    // What a bias is blamed for is consistent with the numbers in its own evidence.
    let metres = |words: &str| -> Option<f64> { words.split(' ').next()?.parse().ok() };
    let evidence = causes.iter().filter_map(|cause| cause["evidence"].as_str());
    let blamed = evidence.filter_map(|words| words.split_once("the bias moves the caster "));
    let numbers: Vec<(f64, f64)> = blamed
        .filter_map(|(_, words)| Some((metres(words)?, metres(words.split_once("surface is only ")?.1)?)))
        .collect();
    assert!(!numbers.is_empty(), "{found}");
    assert!(numbers.iter().all(|(bias, gap)| bias >= gap && *gap > 1e-9), "{numbers:?}");
}

/// A floor, and two sheets under the sun that are wound the other way round.
const SHEETS: &str = r#"
[camera]
eye=[2.5,3.5,5]
target=[0,0.5,0]
[[lights]]
kind="directional"
towards=[1,2,0.6]
[[objects]]
name="floor"
mesh={shape="quad",size=[10,10]}
[[objects]]
name="up"
mesh={shape="quad",size=[1.2,1.2]}
translate=[-1,1.2,0]
[[objects]]
name="down"
mesh={shape="quad",size=[1.2,1.2]}
rotate_degrees=[180,0,0]
translate=[1,1.2,0]
"#;

/// A box on a floor, and a smaller one on it.
const STACK: &str = r#"
[camera]
eye=[2.5,2.5,4]
target=[0,0.5,0]
[[lights]]
kind="directional"
towards=[1,2,0.6]
[[objects]]
name="floor"
mesh={shape="quad",size=[8,8]}
[[objects]]
name="big"
mesh={shape="box",size=[1.5,0.6,1.5]}
translate=[0,0.3,0]
[[objects]]
name="small"
mesh={shape="box",size=[0.6,0.6,0.6]}
translate=[0,0.9,0]
"#;

/// Each cause that is proven in any region, with its fix's settings and what that leaves wrong.
fn proven(document: &serde_json::Value) -> BTreeMap<String, Vec<(serde_json::Value, u64)>> {
    let mut found: BTreeMap<String, Vec<(serde_json::Value, u64)>> = BTreeMap::new();
    let regions = document["regions"].as_array().expect("regions");
    for cause in regions.iter().flat_map(|region| region["causes"].as_array().expect("causes")) {
        assert!(cause["evidence_holds"].is_boolean() && cause["measured"].is_array(), "{cause}");
        if cause["proof"] == "proven" {
            assert_eq!(cause["evidence_holds"], true, "{cause}");
            let left = cause["pixels_left"].as_u64().expect("a number");
            let name = cause["cause"].as_str().expect("a name").to_owned();
            found.entry(name).or_default().push((cause["mend"]["settings"].clone(), left));
        }
    }
    found
}

/// Whichever side the map leaves out, one of two sheets has no other, and no bias is to blame.
#[test]
fn a_sheet_whose_faces_the_map_leaves_out_is_reported_as_that() {
    let folder = crate::commands::folder();
    fs::write(folder.path().join("sheets.toml"), SHEETS).expect("written");
    for (side, sheet) in [("front", "up"), ("back", "down")] {
        let cull = format!("cull={side}");
        let (code, found) = document(folder.path(), &["sheets.toml", "-t", "shadow-map", "--set", &cull]);
        assert_eq!(code, Some(1), "{found}");
        let first = &found["regions"][0];
        assert_eq!(first["casters"], serde_json::json!([sheet]), "{found}");
        let cause = &first["causes"][0];
        assert_eq!((&cause["cause"], &cause["proof"]), (&"map-faces-culled".into(), &"proven".into()), "{found}");
        assert_eq!((&cause["mend"]["settings"]["cull"], &cause["pixels_left"]), (&"none".into(), &0.into()));
        let evidence = cause["evidence"].as_str().expect("a sentence");
        let words = format!("leaves out {side} faces, 2 of the 2 triangles of {sheet}");
        assert!(evidence.contains(&words), "{evidence}");
        let proven = proven(&found);
        assert!(!proven.contains_key("peter-panning"), "{proven:?}");
        assert_eq!(
            (&found["advice"]["mend"]["settings"]["cull"], &found["advice"]["wrong_left"]),
            (&"none".into(), &0.into())
        );
    }
}

/// The three famous faults of maps, each by a setting of the same scene. Coarse texels slope farther and are biased
/// farther, so that they show all three.
#[test]
fn boxes_on_each_other_show_acne_peter_panning_and_stairs() {
    let folder = crate::commands::folder();
    fs::write(folder.path().join("stack.toml"), STACK).expect("written");
    let faults: [(&[&str], &str); 3] = [
        (&["bias-constant=0", "bias-slope=0"], "acne"),
        (&["bias-slope=200"], "peter-panning"),
        (&["size=32"], "aliasing"),
    ];
    for (settings, cause) in faults {
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let arguments: Vec<&str> = ["stack.toml", "-t", "shadow-map"].into_iter().chain(set).collect();
        let (code, found) = document(folder.path(), &arguments);
        assert_eq!(code, Some(1), "{found}");
        let proven = proven(&found);
        assert!(proven.get(cause).is_some_and(|fixes| fixes.iter().all(|(_, left)| *left == 0)), "{proven:?}");
        // Where the boxes touch, outlines run through texels whatever the bias.
        let may_be: &[&str] = match cause {
            "acne" => &["acne", "aliasing"],
            "peter-panning" => &["peter-panning"],
            _ => &["acne", "aliasing", "peter-panning"],
        };
        assert!(proven.keys().all(|cause| may_be.contains(&cause.as_str())), "{proven:?}");
    }
}

/// The names that scripts rely on.
#[test]
fn the_document_has_the_names_of_the_contract() {
    let folder = crate::commands::folder();
    shaded(folder.path());
    let (code, printed, _) = diagnose(folder.path(), &["shaded.toml", "-t", "z-pass", "--no-techniques", "--json"]);
    assert_eq!(code, Some(1));
    let document: serde_json::Value = serde_json::from_str(&printed).expect("JSON alone");
    assert_eq!(
        (&document["schema"], &document["scene"], &document["technique"]),
        (&1.into(), &"shaded".into(), &"z-pass".into())
    );
    assert!(document["settings"].is_object() && document["mesh_findings"].is_array());
    for key in ["compared", "false_shadow", "missing_shadow", "wrong_surface", "edge_band"] {
        assert!(document["error"][key].is_u64(), "{key}");
    }
    let region = &document["regions"][0];
    assert!(region["pixels"].as_u64().is_some_and(|pixels| pixels > 100));
    assert!(["false_shadow", "missing_shadow"].contains(&region["kind"].as_str().expect("a kind")));
    assert_eq!((region["light"].as_u64(), region["box"].as_array().map(Vec::len)), (Some(0), Some(4)));
    assert!(region["at"].is_array() && region["casters"].is_array() && region["receivers"].is_array());
    let cause = &region["causes"][0];
    assert_eq!((&cause["cause"], &cause["mend"]["technique"]), (&"eye-in-volume".into(), &"z-fail".into()));
    assert_eq!((&cause["proof"], &cause["pixels_left"]), (&"proven".into(), &0.into()));
    assert!(cause["evidence"].as_str().is_some_and(|evidence| !evidence.is_empty()));
    assert_eq!(document["suited"], serde_json::json!([]));
    crate::help::assert_json_is_explained("diagnose", &document);
}

#[test]
fn a_mesh_with_holes_is_reported_of_before_any_pixel() {
    let folder = crate::commands::folder();
    let (_, printed, _) = diagnose(folder.path(), &["triangle.obj", "-t", "z-fail", "--no-techniques", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    let found = document["mesh_findings"].as_array().expect("findings");
    let open = found.iter().find(|one| one["object"] == "triangle").expect("the triangle");
    assert_eq!((&open["cause"], &open["count"]), (&"open-mesh".into(), &3.into()));
    assert_eq!(open["at"].as_array().map(Vec::len), Some(3));
    crate::help::assert_json_is_explained("diagnose", &document);
    let (code, printed, _) = diagnose(folder.path(), &["triangle.obj", "-t", "z-fail", "--no-techniques"]);
    assert_eq!(code, Some(0));
    assert!(printed.contains("triangle: open-mesh (3): ") && printed.contains("\n     at ("), "{printed}");
}

#[test]
fn a_folder_has_pictures_text_and_document_and_is_replaced_only_on_request() {
    let folder = crate::commands::folder();
    shaded(folder.path());
    let arguments = ["shaded.toml", "-t", "z-pass", "--no-techniques", "-o", "why"];
    let (code, printed, error) = diagnose(folder.path(), &arguments);
    assert_eq!(code, Some(1), "{error}");
    assert!(printed.ends_with("why: regions.png, mended.png, diagnosis.txt, diagnosis.json\n"), "{printed}");
    let why = folder.path().join("why");
    assert_eq!(names(&why), ["diagnosis.json", "diagnosis.txt", "mended.png", "regions.png"]);
    assert!(printed.starts_with(&fs::read_to_string(why.join("diagnosis.txt")).expect("text")));
    let colors = |name: &str| {
        let file = fs::File::open(why.join(name)).expect("a picture");
        let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!([info.width, info.height], [160, 120]);
        let wrong: [[u8; 3]; 2] = [[0xe6, 0x9f, 0x00], [0xcc, 0x79, 0xa7]];
        pixels.chunks_exact(3).filter(|pixel| wrong.iter().any(|color| color == pixel)).count()
    };
    assert!(colors("regions.png") > 100);
    assert_eq!(colors("mended.png"), 0, "the fix leaves nothing wrong");

    let again = diagnose(folder.path(), &arguments);
    assert!(again.0 == Some(2) && again.2.contains("--overwrite"), "{}", again.2);
    assert_eq!(diagnose(folder.path(), &[&arguments[..], &["--overwrite"]].concat()).0, Some(1));
    assert!(!names(folder.path()).iter().any(|name| name.starts_with('.')));
    assert!(diagnose(folder.path(), &["tori", "-o", "models/.."]).2.contains("holds no diagnosis"));
}

#[test]
fn the_fixed_scene_opens_again_and_is_right() {
    let folder = crate::commands::folder();
    shaded(folder.path());
    // From a file, from a built-in scene with meshes of its own, from a model.
    let model = fs::canonicalize("assets/models/knot.obj").expect("a model");
    let model = model.to_str().expect("a path");
    let cases: [(&[&str], &str); 3] = [
        (&["shaded.toml", "-t", "z-pass"], "use z-fail"),
        (&["tori", "-t", "shadow-map", "--set", "bias-slope=0", "--set", "bias-constant=0"], ""),
        (&[model, "-t", "none"], ""),
    ];
    for (index, (arguments, fix)) in cases.into_iter().enumerate() {
        let file = format!("fixed-{index}.toml");
        let (code, printed, error) = diagnose(folder.path(), &[arguments, &["--fix", &file]].concat());
        assert_eq!(code, Some(1), "{error}");
        let last = printed.lines().last().expect("a line");
        assert!(last.starts_with(&format!("{file}: written so that it says: {fix}")), "{printed}");
        assert!(last.contains("opened again, 0 of "), "{printed}");
        let (code, printed, error) = diagnose(folder.path(), &[&file, "--no-techniques"]);
        assert_eq!(code, Some(0), "{printed}{error}");
    }
    let fixed = fs::read_to_string(folder.path().join("fixed-2.toml")).expect("a scene file");
    assert!(fixed.contains("knot.obj\"") && !names(folder.path()).contains(&"fixed-2-knot.obj".to_owned()), "{fixed}");
    assert!(names(folder.path()).iter().any(|name| name.starts_with("fixed-1-") && name.ends_with(".obj")));
    let again = diagnose(folder.path(), &["shaded.toml", "-t", "z-pass", "--fix", "fixed-0.toml"]);
    assert!(again.0 == Some(2) && again.2.contains("is there already"), "{}", again.2);
}

#[test]
fn what_can_not_be_diagnosed_is_refused_in_one_line_with_the_fix() {
    let cases: &[(&[&str], &[&str])] = &[
        (&["tory"], &["did you mean `tori`?"]),
        (&["tori", "-t", "z-fial"], &["did you mean `z-fail`?"]),
        (&["tori", "--every", "draw"], &["leave it out"]),
        (&["tori", "--external-capture"], &["leave it out"]),
        (&["tori", "--fix", "out.obj"], &["ends in .toml"]),
        (&["good.toml", "--fix", "good.toml"], &["is the scene itself"]),
        (&["tori", "--fix", "good.toml"], &["is there already", "--overwrite"]),
        (&["tori", "--fix", "missing/a.toml"], &["missing/a.toml"]),
        (&["tori", "-o", "good.toml"], &["holds no diagnosis"]),
        (&["tori", "--json", "models"], &["models"]),
        (&[], &["<SCENE>"]),
    ];
    for (arguments, words) in cases {
        assert_fails(&[&["diagnose"], *arguments].concat(), 2, words);
    }
    assert_fails(&["diagnose", "tori", "--adapter", "no such gpu"], 3, &["mesa-vulkan-drivers"]);
}

/// A model beside the fixed scene is never replaced: it may be what the scene is made of.
#[test]
fn a_fixed_scene_replaces_no_model() {
    let folder = crate::commands::folder();
    let path = |name: &str| folder.path().join(name);
    let fixed = ["tori", "-t", "z-fail", "--set", "extrusion=finite:1", "--fix", "mended.toml", "--overwrite"];
    let (code, printed, error) = diagnose(folder.path(), &fixed);
    assert_eq!(code, Some(1), "{printed}{error}");
    let is_model = |name: &String| name.starts_with("mended-") && name.ends_with(".obj");
    let models: Vec<String> = names(folder.path()).into_iter().filter(is_model).collect();
    assert!(!models.is_empty(), "{printed}");
    // Written again with the same models, it is there as before.
    assert_eq!(diagnose(folder.path(), &fixed).0, Some(1));
    let mine = "# somebody's work\nv 0 0 0\n";
    fs::write(path(&models[0]), mine).expect("written");
    let before = fs::read_to_string(path("mended.toml")).expect("a scene file");
    let (code, _, error) = diagnose(folder.path(), &fixed);
    assert!(code == Some(2) && error.contains(&models[0]) && error.contains("choose another name"), "{error}");
    assert_eq!(fs::read_to_string(path(&models[0])).expect("a model"), mine);
    assert_eq!(fs::read_to_string(path("mended.toml")).expect("a scene file"), before);
}
