//! `stencilscope pixel`: histories as text and as JSON, of scenes, of folders and of other programs.

use super::*;

/// Passes have the numbers that they have in the window: a mask has none.
#[test]
fn pixel_numbers_passes_without_masks() {
    let folder = folder();
    let output = run(folder.path(), &["pixel", "two-lights", "--size", "64x48", "-t", "z-fail", "--at", "32,40"]);
    let story = text(&output.stdout);
    let heads = story.lines().filter(|line| line.starts_with("pass ")).filter_map(|line| line[5..].split(',').next());
    let numbers: Vec<usize> = heads.map(|number| number.parse().expect("a number")).collect();
    assert_eq!(numbers, (1..=5).collect::<Vec<usize>>(), "ambient, and of each light volumes and light\n{story}");
    assert!(story.contains("pass 4, light 2: volumes"), "{story}");
}

/// The names and values that scripts rely on.
#[test]
fn pixel_reports_its_history_as_text_and_as_json() {
    let folder = folder();
    let arguments = ["pixel", "tetrahedron", "--size", "320x240", "-t", "z-fail", "--at", "160,120"];
    let output = run(folder.path(), &arguments);
    let story = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for words in ["pixel 160,120: a surface 3.395 m away", "as the GPU stored it", "pass 2, light 1: volumes", "0 → 1"]
    {
        assert!(story.contains(words), "`{words}` is not in\n{story}");
    }
    // The light's pass changes what it has tested: the headline says since when the stencil is so.
    let lit = text(
        &run(folder.path(), &["pixel", "tetrahedron", "--size", "320x240", "-t", "z-fail", "--at", "100,140"]).stdout,
    );
    let headline = lit.lines().find(|line| line.starts_with("pixel ")).expect("a headline").to_owned();
    assert!(headline.contains(", stencil 1 since pass 3, light, "), "{headline}");
    assert!(lit.contains("count 0, so the light pass adds the light"), "{lit}");
    let json = |more: &[&str]| printed_json(folder.path(), &[&arguments, more].concat());
    let one = json(&["--json"]);
    assert_eq!(one["pixel"], serde_json::json!([160, 120]));
    assert_eq!((&one["agrees"], &one["final"]), (&true.into(), &one["captured"]));
    assert!(one["milliseconds"].as_f64().is_some_and(|ms| ms > 0.0));
    let events = one["events"].as_array().expect("events");
    assert_eq!((&events[0]["name"], &events[0]["primitive"]), (&"clear depth".into(), &Value::Null));
    let side = events.iter().find(|event| event["part"] == "side").expect("a side");
    let expected = serde_json::json!({
        "pass": 1, "draw": 0, "name": "volumes", "caster": "tetrahedron", "part": "side", "front_facing": false,
        "depth_test": "fail", "stencil_test": "pass", "operation": "increment-wrap", "stencil_before": 0,
        "stencil_after": 1, "note": null,
    });
    for (key, value) in expected.as_object().expect("an object") {
        assert_eq!(&side[key], value, "{key}");
    }
    assert!(side["primitive"].is_u64() && side["triangle"].is_u64() && side["depth"].is_f64());
    crate::help::assert_json_is_explained("pixel", &one);
    let two = json(&["--at", "0,0", "--json"]);
    assert_eq!(two.as_array().map(Vec::len), Some(2), "several pixels are a list");
    run(folder.path(), &[&arguments[..], &["--json", "history.json"]].concat());
    let written = fs::read_to_string(folder.path().join("history.json")).expect("a file");
    assert!(written.contains("increment-wrap"));
}

/// A folder's histories need no GPU: they are the same, but for the last bits of depths that other rasterisers round
/// otherwise.
#[test]
fn pixels_of_a_folder_have_their_histories_without_an_adapter() {
    let folder = folder();
    done(folder.path(), &["capture", "tori", "-t", "z-fail", "--size", "96x72", "-o", "out"]);
    let pixel = ["pixel", "out", "--at", "48,40", "--at", "20,50", "--at", "60,30"];
    let without = |arguments: &[&str]| {
        let mut command = program(folder.path(), arguments);
        command.env("VK_DRIVER_FILES", "missing.json").env("VK_ICD_FILENAMES", "missing.json");
        let output = command.output().expect("the program runs");
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let steps = |json: &str| -> Vec<Value> {
        let pixels: Vec<Value> = serde_json::from_str(json).expect("JSON");
        assert!(pixels.iter().all(|pixel| pixel["agrees"] == true), "{json}");
        let events = pixels.iter().flat_map(|pixel| pixel["events"].as_array().expect("events").clone());
        let keys = ["pass", "draw", "triangle", "front_facing", "depth_test", "stencil_test", "stencil_after", "note"];
        events.map(|event| keys.map(|key| event[key].clone()).into()).collect()
    };
    let json = [&pixel[..], &["--json"]].concat();
    let with_gpu = steps(&done(folder.path(), &json));
    assert!(with_gpu.len() >= 20, "{}", with_gpu.len());
    assert_eq!(steps(&without(&json)), with_gpu);
    assert!(without(&pixel).contains("No GPU could be used: the program's own rasteriser made the fragments."));
    assert!(!done(folder.path(), &pixel).contains("No GPU"));
}

/// The unit of another program's frame is not known.
#[test]
fn a_recorded_frame_reports_distances_in_units() {
    let folder = folder();
    let coordinates = ["pixel", "ogre", "--at", "200,150", "--coordinates"];
    assert_fails(&coordinates, 2, &["another program's is a guess", "leave it out"]);
    let output = run(folder.path(), &["pixel", "ogre", "--at", "200,150"]);
    let story = text(&output.stdout);
    assert!(output.status.success() && story.contains(" units away (depth"), "{story}");
    assert!(!story.contains(" m:") && !story.contains(" m away"), "{story}");
}
