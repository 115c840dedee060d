//! `help` from outside: what it explains is compared with the program itself, so that no page goes stale.

use crate::commands::{assert_fails, done, folder, printed_json, read_json, run, text};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use stencilscope::diagnosis::Cause;
use stencilscope::history::operation_name;
use stencilscope::reading::bench::COMPARES;
use stencilscope::scene::{SceneError, file};
use stencilscope::technique::Technique;

/// The text of a key.
fn help(key: &str) -> String {
    let folder = folder();
    let output = run(folder.path(), &["help", key]);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), String::new()), "{key}");
    text(&output.stdout)
}

/// The part of a page under a heading, up to the next.
fn section(page: &str, heading: &str) -> String {
    let (_, after) = page.split_once(&format!("\n## {heading}\n")).unwrap_or_else(|| panic!("no heading {heading}"));
    after.split("\n## ").next().unwrap_or(after).to_owned()
}

/// Asserts that a page explains a key: it stands there as code.
#[track_caller]
fn assert_explained(section: &str, key: &str, whose: &str) {
    assert!(section.contains(&format!("`{key}`")), "`{key}` of {whose} is not explained");
}

/// Every key of a document, wherever it stands; what is in `settings` is a setting's name and no key.
fn keys_of(value: &Value, keys: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                keys.insert(key.clone());
                if key != "settings" {
                    keys_of(value, keys);
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| keys_of(value, keys)),
        _ => {}
    }
}

/// Asserts that `help json` explains every key of what a command has written.
#[track_caller]
pub fn assert_json_is_explained(command: &str, document: &Value) {
    let explained = section(&help("json"), command);
    let mut keys = BTreeSet::new();
    keys_of(document, &mut keys);
    assert!(!keys.is_empty(), "{command} has written nothing");
    keys.iter().for_each(|key| assert_explained(&explained, key, command));
}

/// The keys that a table of a scene file knows, as the error for an unknown one lists them; `None` where the key
/// `at` holds no table.
fn known_keys(folder: &Path, at: &[String]) -> Option<Vec<String>> {
    const UNKNOWN: &str = "zzzz";
    let tables = ["lights", "objects"];
    let inner = format!("{{ {UNKNOWN} = 1 }}");
    let nested = at.iter().rev().fold(inner, |inner, key| {
        let table = if tables.contains(&key.as_str()) && inner.starts_with('{') { format!("[{inner}]") } else { inner };
        format!("{{ {key} = {table} }}")
    });
    // The outermost table is the file.
    let text = nested.strip_prefix("{ ").and_then(|text| text.strip_suffix(" }")).expect("a table");
    let path = folder.join("asked.toml");
    std::fs::write(&path, text).expect("written");
    let Err(SceneError::Line { reason, .. }) = file::load(&path) else { panic!("{text} was taken") };
    let (_, list) = reason.split_once(&format!("unknown key `{UNKNOWN}`: choose one of "))?;
    Some(list.split(", ").map(str::to_owned).collect())
}

#[test]
fn every_key_that_a_scene_file_knows_is_explained() {
    let page = help("scene-file");
    let folder = folder();
    let mut open = vec![Vec::new()];
    let mut tables = 0;
    while let Some(at) = open.pop() {
        let Some(keys) = known_keys(folder.path(), &at) else { continue };
        tables += 1;
        let heading = at.last().map_or("The file", String::as_str);
        let explained = section(&page, heading);
        for key in keys {
            assert_explained(&explained, &key, heading);
            let alone = help(&key);
            let place = if at.is_empty() { "At the top:".to_owned() } else { format!("In `{heading}`:") };
            assert!(alone.contains(&place) && alone.contains(&format!("`{key}`")), "help {key}:\n{alone}");
            open.push([&at[..], &[key]].concat());
        }
    }
    // The file, camera, lights, objects, the orbit and swing of both, material, mesh and technique.
    assert_eq!(tables, 11);
}

#[test]
fn the_page_of_the_stencil_test_names_each_function_and_operation_of_the_bench() {
    let page = help("stencil-test");
    let functions = section(&page, "The functions");
    COMPARES.iter().for_each(|(_, name, _)| assert_explained(&functions, name, "the bench"));
    let operations = section(&page, "The operations");
    use wgpu::StencilOperation::*;
    for operation in
        [Keep, Zero, Replace, Invert, IncrementClamp, DecrementClamp, IncrementWrap, DecrementWrap].map(operation_name)
    {
        assert_explained(&operations, operation, "the bench");
    }
    assert!(page.contains("*Stencil test*"));
}

#[test]
fn the_scene_file_that_the_page_shows_opens() {
    let page = help("scene-file");
    let toml = page.split("```toml\n").nth(1).and_then(|after| after.split("```").next()).expect("a scene file");
    let folder = folder();
    let path = folder.path().join("shown.toml");
    std::fs::write(&path, toml).expect("written");
    let scene = file::load(&path).expect("a scene");
    assert_eq!(scene.objects.iter().map(|object| object.name.as_str()).collect::<Vec<_>>(), ["ring", "floor"]);
    assert!(scene.objects[0].motion.spin_degrees_per_second.y > 0.0);
}

#[test]
fn every_key_of_a_manifest_and_every_file_is_explained() {
    let page = help("capture-folder");
    let folder = folder();
    let captures: [&[&str]; 4] = [
        &["-t", "z-fail", "--set", "counter=float", "--every", "draw"],
        &["-t", "auto", "--set", "depth=standard-finite"],
        &["-t", "shadow-map", "--set", "size=16", "--every", "draw"],
        &["-t", "planar-texture", "--set", "size=16"],
    ];
    let mut sections = [("manifest.json", BTreeSet::new()), ("A pass", BTreeSet::new()), ("A light", BTreeSet::new())];
    for options in captures {
        let capture = ["capture", "two-lights", "--size", "32x24", "--truth", "-o", "out", "--overwrite"];
        done(folder.path(), &[&capture[..], options].concat());
        let manifest = read_json(&folder.path().join("out/manifest.json"));
        let Value::Object(mut manifest) = manifest else { panic!("no object") };
        for (key, (_, keys)) in ["", "passes", "lights"].into_iter().zip(&mut sections) {
            let of_section = if key.is_empty() {
                let mut rest = manifest.clone();
                ["passes", "lights"].iter().for_each(|list| rest[*list] = Value::Null);
                Value::Object(rest)
            } else {
                manifest.remove(key).expect("a list")
            };
            keys_of(&of_section, keys);
        }
        for file in crate::common::names(&folder.path().join("out")) {
            let ending = file.split_once('.').map_or("", |(_, ending)| ending);
            let ending =
                if ending.starts_with("draw") { ending.split_once('.').map_or("", |parts| parts.1) } else { ending };
            // Maps and labels after single draws are named as those of lights.
            assert!(section(&page, "Files").contains(&format!(".{ending}`")), "{file}");
        }
    }
    for (heading, keys) in sections {
        assert!(keys.len() > 10, "{heading}: {keys:?}");
        let explained = section(&page, heading);
        keys.iter().for_each(|key| assert_explained(&explained, key, heading));
    }
}

/// Names of fields that are written only at times: the declarations have them all.
fn declared_fields(source: &str) -> Vec<String> {
    let code = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines: Vec<&str> = code.lines().map(str::trim).filter(|line| !line.starts_with("//")).collect();
    let (mut fields, mut is_written, mut is_flattened, mut renamed) = (Vec::new(), false, false, None);
    for line in lines {
        match line {
            _ if line.starts_with("#[derive(") => is_written = line.contains("Serialize"),
            // The fields of what is flattened are written in its place.
            "#[serde(flatten)]" => is_flattened = true,
            _ if is_flattened => is_flattened = false,
            _ if line.starts_with("#[serde(rename") => renamed = line.split('"').nth(1).map(str::to_owned),
            "}" => is_written = false,
            _ if is_written && line.ends_with(',') && line.contains(": ") => {
                let name = line.split(':').next().unwrap_or_default().split(' ').next_back().unwrap_or_default();
                fields.push(renamed.take().unwrap_or_else(|| name.to_owned()));
            }
            _ => {}
        }
        // Keys of `json!`, which are followed by their value.
        let pieces: Vec<&str> = line.split('"').collect();
        let keys = pieces.windows(2).skip(1).step_by(2).filter(|pair| pair[1].starts_with(": "));
        fields.extend(keys.map(|pair| pair[0].to_owned()));
    }
    fields
}

#[test]
fn fields_that_are_written_only_at_times_are_explained_too() {
    let page = help("json");
    let source = |file: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(file)).expect("a source file")
    };
    // Rows flatten these counts.
    let accuracy = source("accuracy.rs");
    let error_counts = declared_fields(&accuracy[..accuracy.find("impl ErrorCounts").expect("its methods")]);
    assert_eq!(error_counts.len(), 5, "{error_counts:?}");
    for (command, files) in [
        ("pixel", &["history/json.rs"][..]),
        ("report", &["report/mod.rs"]),
        ("stress", &["stress/json.rs"]),
        ("diagnose", &["diagnosis/json.rs"]),
        ("diff", &["difference/json.rs"]),
        ("check", &["check/json.rs"]),
    ] {
        let mut fields: Vec<String> = files.iter().flat_map(|file| declared_fields(&source(file))).collect();
        assert!(fields.len() > 8, "{command}: {fields:?}");
        if ["report", "stress", "check"].contains(&command) {
            fields.extend(error_counts.iter().cloned());
        }
        let explained = section(&page, command);
        fields.iter().for_each(|field| assert_explained(&explained, field, command));
    }
    let sample = "#[derive(Debug, Serialize)]\nstruct A {\n    pub a: u8,\n    #[serde(rename = \"c\")]\n    b: u8,\n    #[serde(flatten)]\n    f: F,\n}\njson!({\"d\": x, \"e\": [1]})";
    assert_eq!(declared_fields(sample), ["a", "c", "d", "e"]);
}

#[test]
fn the_list_of_scenes_is_explained() {
    let folder = folder();
    assert_json_is_explained("scenes", &printed_json(folder.path(), &["scenes", "--json"]));
}

#[test]
fn a_setting_is_explained_with_its_values_and_a_technique_with_its_settings() {
    let size = help("size");
    for words in ["shadow-map: texels", "`1024` unless set", "planar-texture: texels", "from 1 to 4096", "stairs"] {
        assert!(size.contains(words), "`{words}` is not in\n{size}");
    }
    let z_fail = help("z-fail");
    for words in ["# z-fail", "closed by caps", "- `faces`: ", "two-sided, two-pass", "`two-sided` unless set"] {
        assert!(z_fail.contains(words), "`{words}` is not in\n{z_fail}");
    }
    let decisions = help("leave-out");
    for decision in stencilscope::plan::Decision::NAMES {
        assert_explained(section_of_decisions(&decisions), decision, "leave-out");
    }
    assert!(help("causes").contains("- `eye-in-volume`: "));
    let capture = help("capture");
    assert!(capture.contains("--overwrite"), "commands have help too");
    assert!(help("near").contains("- `near`: distance of the near plane"), "and keys of scene files");
    let both = help("size");
    assert!(both.contains("shadow-map: texels") && both.contains("In `mesh`:"), "a setting and a key:\n{both}");
    assert!(help("inside").contains("built-in scene") && help("ogre").contains("recorded frame"));
}

/// Help whose lines are joined, so that a sentence is one text wherever it is broken.
fn joined(key: &str) -> String {
    help(key).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Sentences that were wrong once: what is said now, and what must not be said again.
#[test]
fn what_help_once_said_wrongly_it_says_rightly() {
    for (key, says) in [
        ("extrusion", "of it volumes are K times the diagonal of the caster's bounding box long"),
        ("auto", "whichever draws less while right"),
        ("auto", "what it takes to decide is set-up, which `report` counts apart"),
        ("filter", "is no penumbra, which is nothing at the caster and widens with the distance from it"),
        ("opacity", "`projective` and `planar-texture` let the rest of the light through"),
        ("planar", "the flat receivers that show most"),
        ("planar", "In `tiger-cage`, where walls, floors and beds receive, it costs twice as much as z-pass"),
        ("planar-texture", "textures of the largest flat receivers"),
        ("silhouette", "keeps a stack of directed edges"),
        ("silhouette", "unless its reverse is there, which is taken away instead"),
        (
            "z-fighting",
            "Layers hide it: where several triangles of a caster cover a pixel it is enough that one of them wins",
        ),
    ] {
        assert!(joined(key).contains(says), "{key}: `{says}` is not in\n{}", joined(key));
    }
    for (key, never) in [
        ("auto", "whichever is cheaper"),
        ("filter", "look right"),
        ("opacity", "Only the technique"),
        ("planar", "every flat"),
        ("planar-texture", "every flat"),
        ("silhouette", "searches all edges for each edge"),
    ] {
        assert!(!joined(key).contains(never), "{key}: `{never}` is in\n{}", joined(key));
    }
}

/// Every cause has a page of its own, also where a setting has its name, and so has every matrix.
#[test]
fn causes_and_matrices_have_pages() {
    for cause in Cause::ALL {
        let page = joined(cause.name());
        assert!(page.contains(&format!("# {cause} (cause)")) && page.contains(cause.meaning()), "{cause}:\n{page}");
    }
    let both = help("z-fighting");
    assert!(both.contains("A setting (`--set z-fighting=VALUE`") && both.contains("# z-fighting (cause)"), "{both}");
    for (matrix, formula) in [
        ("eye_from_world", "p' = R (p - E)"),
        ("eye from world", "p' = R (p - E)"),
        ("clip_from_eye", "w' = -z"),
        ("window from NDC", "x' = (x + 1) W / 2"),
        ("light_from_world", "p' = R (p - L)"),
        ("clip_from_light", "column = (x / w + 1) N / 2"),
        ("bias_matrix", "t = (w - y) / 2"),
        ("shadow matrix", "M = (P . L) I - L P^T"),
        ("clip_from_eye", "third row is twice this one less the fourth"),
        ("window_from_ndc", "- Segal and Akeley (1997)"),
    ] {
        assert!(joined(matrix).contains(formula), "{matrix}");
    }
    let folder = folder();
    let unknown = run(folder.path(), &["help", "light_from_wold"]);
    assert!(text(&unknown.stderr).contains("did you mean `light_from_world`?"), "{}", text(&unknown.stderr));
}

/// Words that are no setting say where they are seen, by which formula, and whose it is.
#[test]
fn words_have_pages_with_window_command_and_source() {
    for (key, says) in [
        ("umbra", &["All lights here are points or suns", "w b / a wide", "Cook, Porter and Carpenter (1984)"][..]),
        ("penumbra", &["no technique makes a penumbra", "the seen share of the light's area"]),
        (
            "channels",
            &["`capture --channels`", "the window", "`emission`", "specular the sum of V L s max(0, N . H)^n"],
        ),
        (
            "vanishing-points",
            &["`pixel --coordinates`", "*Vanishing points*", "clip.w = 0", "Carlbom and Paciorek (1978)"],
        ),
        ("normals", &["in Scene, *Normals*", "`pixel` says", "n = (b - a) x (c - a)", "Gouraud (1971)"]),
        ("rays", &["who keeps the light away", "tab Pixel, *Rays*", "Appel (1968)"]),
        ("ambient-diffuse", &["s D + V ((1 - s) D + H)", "Lambert (1760)", "no shadow takes away"]),
    ] {
        let page = joined(key);
        for words in says {
            assert!(page.contains(words), "{key}: `{words}` is not in\n{page}");
        }
    }
}

#[test]
fn help_says_formula_and_source_and_every_command_leads_to_it() {
    let bias = help("bias-normal");
    for words in ["Formula:", "k t sin a along the normal", "- Holbert (2011), \"Saying Goodbye to Shadow Acne\""] {
        assert!(bias.contains(words), "`{words}` is not in\n{bias}");
    }
    assert!(help("z-pass-plus").contains("- Hornus, Hoberock, Lefebvre and Hart (2005), \"ZP+"));
    assert!(help("counter").contains("no publication is known"));
    let folder = folder();
    let commands = ["view", "capture", "animate", "pixel", "diagnose", "diff", "report"];
    let calls: Vec<Vec<&str>> =
        commands.into_iter().map(|command| vec![command, "--help"]).chain([vec!["--help"]]).collect();
    for call in calls {
        let said = done(folder.path(), &call);
        let words: BTreeSet<&str> = said.split([' ', ',', ':', '\n']).collect();
        let settings = Technique::ALL.into_iter().flat_map(|of| of.settings()).map(|spec| spec.key);
        let names = Technique::ALL.into_iter().map(Technique::name).chain(settings);
        for name in names.chain(["tori", "tiger-cage", "ogre", "ogre-inside", "ogre-short"]) {
            assert!(words.contains(name), "{call:?} does not name {name}");
        }
        assert!(said.contains("`stencilscope help KEY`"), "{call:?}");
    }
}

/// The table below the list of values, which names every decision as well.
fn section_of_decisions(page: &str) -> &str {
    page.split_once("| decision |").expect("a table").1
}

#[test]
fn what_is_not_known_is_refused_with_the_nearest_name() {
    assert_fails(&["help", "z-fial"], 2, &["nothing is called `z-fial`", "did you mean `z-fail`?"]);
    assert_fails(&["help", "scene-fil"], 2, &["did you mean `scene-file`?"]);
    assert_fails(&["help", "capure"], 2, &["did you mean `capture`?"]);
    assert_fails(&["help", "fov_y_degree"], 2, &["did you mean `fov_y_degrees`?"]);
    assert_fails(&["help", "ogre-insid"], 2, &["did you mean `ogre-inside`?"]);
    assert_fails(&["help", "zzzz"], 2, &["`stencilscope help` lists what there is"]);
}
