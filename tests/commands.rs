//! The program from outside: exit codes, error lines, and what it leaves behind.

mod bench;
mod pixel;

use crate::common::names;
use glam::DVec4;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use stencilscope::capture::disk;
use stencilscope::import::ShippedFrame;
use stencilscope::scene::builtin;
use stencilscope::session::RunFrame;
use tempfile::TempDir;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0.3\nf 1 2 3\n";

/// A folder that the program runs in, with some input.
pub fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &[u8]| fs::write(folder.path().join(name), text).expect("written");
    put("triangle.obj", TRIANGLE.as_bytes());
    put("empty.obj", b"");
    put("nan.obj", format!("{TRIANGLE}v 0 nan 0\nf 1 2 4\n").as_bytes());
    put("scan.obj", format!("{TRIANGLE}v 0 nan 0\nf 1 2\nf 2 3\n").as_bytes());
    put("no-faces.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    put("range.obj", format!("{TRIANGLE}f 1 2 9\n").as_bytes());
    put("binary.obj", &[0x89, b'P', b'N', b'G', 0, 0xff, 0xfe]);
    put("key.toml", b"ambiant = [0.1, 0.1, 0.1]\n[[objects]]\nmesh = \"triangle.obj\"\n");
    put("good.toml", b"[[objects]]\nmesh = \"triangle.obj\"\n[technique]\nname = \"planar\"\n");
    put("technique.toml", b"[[objects]]\nmesh = \"triangle.obj\"\n[technique]\nname = \"planer\"\n");
    fs::create_dir(folder.path().join("models")).expect("made");
    folder
}

/// The program without a display.
fn program(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stencilscope"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    // Without a folder for Wayland's display, of which its library would complain.
    command.env_remove("XDG_RUNTIME_DIR").env_remove("NODEVICE_SELECT");
    command
}

pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    program(folder, arguments).output().expect("the program runs")
}

/// Runs the program, which must succeed, and gives its standard output.
#[track_caller]
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// The JSON that the program prints.
pub fn printed_json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_slice(&run(folder, arguments).stdout).expect("JSON")
}

/// The JSON that a file holds.
pub fn read_json(file: &Path) -> Value {
    serde_json::from_slice(&fs::read(file).expect("a file")).expect("JSON")
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Without a display the same is a capture, and brackets it.
#[cfg(all(feature = "inspector", target_os = "linux"))]
#[test]
fn a_window_is_no_frame_to_bracket() {
    let output = Command::new(env!("CARGO_BIN_EXE_stencilscope"))
        .args(["view", "tori", "--external-capture"])
        .env("DISPLAY", ":nowhere")
        .output()
        .expect("the program runs");
    let line = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{line}");
    assert!(
        line.lines().count() == 1 && line.contains("--external-capture") && line.contains("leave it out"),
        "{line}"
    );
}

#[test]
fn a_headless_run_prints_nothing_but_its_own_words() {
    let folder = folder();
    let output = run(folder.path(), &["capture", "tetrahedron", "--size", "32x24", "-o", "out"]);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), String::new()));
}

/// Runs a command that must fail with `code` and one line that has all `words`, leaving nothing.
pub fn assert_fails(arguments: &[&str], code: i32, words: &[&str]) {
    let folder = folder();
    let before = names(folder.path());
    let output = run(folder.path(), arguments);
    let line = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {line}");
    assert_eq!(line.trim_end().lines().count(), 1, "{arguments:?}: {line}");
    for word in words {
        assert!(line.contains(word), "{arguments:?}: `{word}` is not in {line}");
    }
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    assert_eq!(names(folder.path()), before, "{arguments:?}");
}

#[test]
fn broken_input_is_refused_in_one_line_with_the_fix() {
    let cases: &[(&str, &[&str])] = &[
        ("missing.obj", &["missing.obj", "no such file", "check the path"]),
        ("empty.obj", &["empty.obj", "is empty"]),
        ("nan.obj", &["nan.obj:5", "vertex 4 is not finite", "replace NaN and infinity by numbers"]),
        ("no-faces.obj", &["no-faces.obj", "no faces", "export"]),
        ("range.obj", &["range.obj:5", "index 9 is out of range", "there are 3"]),
        ("models", &["models", "is a folder"]),
        ("binary.obj", &["binary.obj", "not a text file"]),
        ("key.toml", &["key.toml:1", "unknown key `ambiant`", "did you mean `ambient`?"]),
        ("missing.toml", &["missing.toml", "no such file"]),
        ("technique.toml", &["planer", "did you mean `planar`?"]),
        ("no/folder", &["no/folder", "no such file or folder", "check the path"]),
        ("tory", &["tory", "did you mean `tori`?"]),
        ("nothing-like-it", &["choose one of tori, rings"]),
    ];
    for (scene, words) in cases {
        assert_fails(&["capture", scene, "-o", "out"], 2, words);
    }
}

#[test]
fn broken_usage_is_refused_in_one_line_with_the_fix() {
    let cases: &[(&[&str], &[&str])] = &[
        (&["--size", "0x0"], &["0x0", "from 1 to 16384"]),
        (&["--size", "100000x100000"], &["100000x100000", "from 1 to 16384"]),
        (&["--size", "12"], &["WIDTHxHEIGHT"]),
        (&["--eye", "1,2"], &["three numbers"]),
        (&["--eye", "1,2,nan"], &["finite"]),
        (&["--eye", "-1,-2,-3", "--target", "-1,-2,-3"], &["eye equals its target"]),
        (&["--fov", "180"], &["field of view"]),
        (&["--near", "-1"], &["near plane"]),
        (&["--sun", "0,0,0"], &["direction"]),
        (&["-t", "z-fial"], &["did you mean `z-fail`?"]),
        (&["--set", "leave-out=capes"], &["`leave-out`", "choose all, none, or some of light, caster"]),
        (&["-t", "z-pass", "-t", "z-fail"], &["multiple times"]),
        (&["-t", "z-fail", "--set", "fases=two-sided"], &["did you mean `faces`?"]),
        (&["-t", "z-fail", "--set", "faces=three"], &["three"]),
        (&["-t", "z-fail", "--set", "faces"], &["KEY=VALUE"]),
        (&["--every", "frame"], &["`pass` or `draw`"]),
        (&["--plot", "a.svg"], &["--plot"]),
        (&["--bogus"], &["--bogus"]),
    ];
    for (options, words) in cases {
        assert_fails(&[&["capture", "tori", "-o", "out"], *options].concat(), 2, words);
    }
    assert_fails(&["capture", "tori"], 2, &["--output"]);
    assert_fails(&["captur", "tori"], 2, &["did you mean `capture`?"]);
    let commands = "Commands are view, capture, animate, page, pixel";
    let nothing = ["no command and no scene is called `wibble`", commands, "`stencilscope scenes` lists scenes"];
    assert_fails(&["wibble"], 2, &nothing);
    assert_fails(&["wibble", "tori", "--size", "16x9"], 2, &nothing);
    assert_fails(&["ogr"], 2, &["did you mean `ogre`?", commands]);
    assert_fails(&["tory"], 2, &["did you mean `tori`?"]);
    assert_fails(&["missing.obj"], 2, &["missing.obj", "no such file"]);
    assert_fails(&["pixel", "tori"], 2, &["--at"]);
    assert_fails(&["pixel", "tori", "--at", "3,3", "--every", "draw"], 2, &["--every draw", "leave it out"]);
    assert_fails(&["pixel", "tori", "--at", "3"], 2, &["give X,Y"]);
    assert_fails(
        &["pixel", "tori", "--size", "16x9", "--at", "1,1", "--at", "16,0"],
        2,
        &["pixel 16,0", "0,0 to 15,8"],
    );
    assert_fails(&["pixel", "tori", "--at", "1,1", "--json", "models"], 2, &["models", "can't be written"]);
    assert_fails(&["bench", "nothing"], 2, &["choose capture"]);
    assert_fails(&["bench", "--every", "draw"], 2, &["--every draw", "leave it out"]);
    assert_fails(&["bench", "--external-capture"], 2, &["--external-capture", "leave it out"]);
}

/// A frame whose light was not found is neither right nor wrong.
#[test]
fn a_frame_without_a_verdict_says_why_and_ends_with_a_code_of_its_own() {
    let folder = folder();
    let output = run(folder.path(), &["diagnose", "ogre"]);
    assert!(output.status.success() && text(&output.stdout).contains("\n0 of 47"), "{}", text(&output.stdout));
    let copy = folder.path().join("unlit");
    let frame = ShippedFrame::named("ogre").and_then(|frame| frame.open().ok()).expect("a frame");
    let whole = RunFrame::from_folder(frame).expect("plan and capture");
    let mut capture = (*whole.capture).clone();
    capture.lights[0].position = DVec4::ZERO;
    let unlit = RunFrame { source: None, capture: Arc::new(capture), ..whole };
    disk::write(unlit.contents(), &copy, false).expect("written");
    let output = run(folder.path(), &["diagnose", "unlit"]);
    let said = text(&output.stderr);
    assert_eq!((output.status.code(), said.lines().count()), (Some(4), 1), "{said}");
    assert!(said.contains("no verdict: ") && said.contains("where light 1 is"), "{said}");
    assert!(text(&output.stdout).contains("compared 0 of 76\u{a0}800 pixels"), "{}", text(&output.stdout));
    let json = run(folder.path(), &["diagnose", "unlit", "--json"]);
    let document: Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!((json.status.code(), &document["verdict"]), (Some(4), &Value::Null));
}

#[test]
fn a_model_with_z_up_is_rotated_and_nothing_else_is() {
    let folder = folder();
    let height = |more: &[&str]| {
        let arguments = [&["capture", "triangle.obj", "--size", "32x24", "-o", "out", "--overwrite"], more].concat();
        done(folder.path(), &arguments);
        let scene = stencilscope::scene::file::load(&folder.path().join("out/scene.toml")).expect("a scene");
        let heights = scene.objects[0].world_positions().into_iter().map(|at| at.y);
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| [low.min(y), high.max(y)])
    };
    let [low, high] = height(&["--z-up"]);
    assert_ne!(height(&[]), [low, high]);
    assert_fails(&["capture", "tori", "--z-up", "-o", "out"], 2, &["--z-up", "`tori`", "leave it out"]);
}

#[test]
fn a_place_that_can_not_be_written_to_is_refused() {
    // Root may write anywhere but below a file.
    assert_fails(
        &["capture", "tori", "--size", "16x16", "-o", "triangle.obj/out"],
        2,
        &["triangle.obj", "can't be written"],
    );
    assert_fails(&["capture", "tori", "-o", "models/.."], 2, &["no capture folder"]);
    let folder = folder();
    fs::write(folder.path().join("models/thesis.txt"), "years of work").expect("written");
    let output = run(folder.path(), &["capture", "tori", "-o", "models", "--overwrite"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("no capture folder"));
    assert_eq!(names(&folder.path().join("models")), ["thesis.txt"]);
}

#[test]
fn without_an_adapter_it_says_what_to_install() {
    assert_fails(
        &["capture", "tori", "-o", "out", "--adapter", "no such gpu"],
        3,
        &["no such gpu", "mesa-vulkan-drivers"],
    );
    let folder = folder();
    let mut command = program(folder.path(), &["capture", "tori", "-o", "out"]);
    let output = command.env("VK_DRIVER_FILES", "missing.json").env("VK_ICD_FILENAMES", "missing.json").output();
    let output = output.expect("the program runs");
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("mesa-vulkan-drivers"));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn captures_are_written_and_replaced_only_on_request() {
    let folder = folder();
    let capture = ["capture", "triangle.obj", "--size", "48x32", "-o", "out"];
    assert!(done(folder.path(), &capture).starts_with("out: triangle, auto, 48x32"));
    let manifest = || read_json(&folder.path().join("out/manifest.json"));
    assert_eq!(manifest()["technique"], "auto");
    let is_timed = |key: &str| manifest()["timing"][key].as_f64().is_some_and(|ms| ms > 0.0);
    let keys = ["write_ms", "setup_ms", "frame_ms", "captured_ms"];
    assert_eq!(keys.map(is_timed), [true, true, false, false], "a frame that is not timed runs once");
    assert!(manifest()["timing"]["frame_ms"].is_null());
    done(folder.path(), &[&capture[..], &["--overwrite", "--timing"]].concat());
    assert_eq!(keys.map(is_timed), [true; 4]);
    let again = run(folder.path(), &capture);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("--overwrite"));
    let options =
        ["-t", "planar", "--overwrite", "--eye", "-3,2,4", "--target", "0,0,0", "--sun", "-1,2,1", "--no-floor"];
    done(folder.path(), &[&capture[..], &options[..]].concat());
    let manifest = manifest();
    assert_eq!(manifest["technique"], "planar");
    assert_eq!(manifest["camera"]["eye"], serde_json::json!([-3.0, 2.0, 4.0]));
    assert_eq!(manifest["lights"][0]["towards"], serde_json::json!([-1.0, 2.0, 1.0]));
    assert!(!names(folder.path()).iter().any(|name| name.starts_with('.')));
}

#[test]
fn every_draw_is_captured_on_request() {
    let folder = folder();
    let capture = ["capture", "triangle.obj", "--size", "48x32", "-o", "out", "--every", "draw"];
    done(folder.path(), &capture);
    let manifest = read_json(&folder.path().join("out/manifest.json"));
    for pass in manifest["passes"].as_array().expect("passes") {
        let captured = pass["draws_captured"].as_array().expect("draws").len();
        assert_eq!(captured as u64, pass["draws"].as_u64().expect("a number"), "{}", pass["name"]);
        for draw in pass["draws_captured"].as_array().expect("draws") {
            assert!(draw["name"].is_string() && draw["part"].is_string());
            for key in ["color", "depth", "stencil"] {
                let file = draw[key].as_str().expect("a file");
                assert!(folder.path().join("out").join(file).is_file(), "{file}");
            }
        }
    }
}

#[test]
fn a_scene_file_chooses_its_technique_and_the_command_line_another() {
    let folder = folder();
    for (options, technique) in [(&[][..], "planar"), (&["-t", "z-pass"][..], "z-pass")] {
        let capture = ["capture", "good.toml", "--size", "16x16", "-o", "out", "--overwrite"];
        let printed = done(folder.path(), &[&capture[..], options].concat());
        assert!(printed.contains(technique), "{printed}");
    }
}

#[test]
fn view_without_a_display_says_so_and_captures() {
    let folder = folder();
    for arguments in [
        &["--size", "32x24"][..],
        &["view", "triangle.obj", "--size", "32x24"][..],
        &["triangle.obj", "--size", "32x24"][..],
    ] {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("capturing into ./stencilscope-out"), "{}", text(&output.stderr));
        assert!(folder.path().join("stencilscope-out/manifest.json").is_file());
    }
}

#[test]
fn shells_complete_commands_and_options() {
    let folder = folder();
    for (shell, completer) in
        [("bash", "complete -F"), ("zsh", "#compdef stencilscope"), ("fish", "complete -c stencilscope")]
    {
        let script = text(&run(folder.path(), &["completions", shell]).stdout);
        for words in [completer, "diagnose", "technique", "completions"] {
            assert!(script.contains(words), "{shell} has no {words}");
        }
    }
    assert_fails(&["completions", "basic"], 2, &["basic", "bash"]);
}

#[test]
fn scenes_lists_names_first_and_as_json() {
    let folder = folder();
    let output = run(folder.path(), &["scenes"]);
    let lines = text(&output.stdout);
    let first_words: Vec<&str> = lines.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(first_words[..2], ["tori", "rings"]);
    done(folder.path(), &["scenes", "--json", "list.json"]);
    assert_eq!(read_json(&folder.path().join("list.json"))["scenes"][0]["name"], "tori");
    assert_fails(&["scenes", "--json", "missing/list.json"], 2, &["missing/list.json", "choose another file"]);
}

#[test]
fn a_word_that_no_picture_s_name_has_is_wrong_usage_and_the_names_are_reported() {
    let folder = folder();
    let output = run(folder.path(), &["pictures", "-o", "shots", "--only", "sunset"]);
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    for name in ["`sunset`", "inspector", "light-theme", "tour"] {
        assert!(message.contains(name), "`{name}` is not in {message}");
    }
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(!folder.path().join("shots").exists(), "no empty folder is left behind");
}

#[test]
fn pictures_of_the_window_are_taken_without_a_display() {
    let folder = folder();
    done(folder.path(), &["pictures", "-o", "shots", "--only", "state"]);
    let file = fs::read(folder.path().join("shots/state.png")).expect("a picture");
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a header");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut bytes).expect("a picture");
    let colors: std::collections::BTreeSet<&[u8]> = bytes.chunks_exact(3).collect();
    assert!(colors.len() > 100, "the panels are drawn: {} colours", colors.len());
    let names = names(&folder.path().join("shots"));
    assert_eq!(names.len(), 1, "no other picture is taken: {names:?}");
}

/// The thumbnails that the window ships are those that the command draws.
#[test]
fn thumbnails_show_the_built_in_scenes_as_they_are() {
    let folder = folder();
    done(folder.path(), &["pictures", "-o", "shots", "--only", "thumbnails"]);
    let read = |path: &Path| {
        let file = fs::read(path).expect("a picture");
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a header");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut bytes).expect("a picture");
        ([info.width, info.height], bytes)
    };
    let (size, drawn) = read(&folder.path().join("shots/thumbnails.png"));
    let (shipped_size, shipped) = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/pictures/thumbnails.png"));
    assert_eq!((size, drawn.len()), (shipped_size, shipped.len()), "draw them again");
    let of_scene = drawn.len() / builtin::ALL.len();
    for (scene, (drawn, shipped)) in
        builtin::ALL.iter().zip(drawn.chunks_exact(of_scene).zip(shipped.chunks_exact(of_scene)))
    {
        let apart: u64 = drawn.iter().zip(shipped).map(|(one, other)| u64::from(one.abs_diff(*other))).sum();
        assert!(apart < drawn.len() as u64, "{}: draw them again", scene.name);
    }
}

#[test]
fn a_capture_with_truth_reports_errors_in_text_manifest_and_arrays() {
    let folder = folder();
    let capture = ["capture", "triangle.obj", "--size", "80x60", "-o", "out", "--truth"];
    for (technique, is_right) in [("none", false), ("z-fail", true)] {
        let printed = done(folder.path(), &[&capture[..], &["-t", technique, "--overwrite"][..]].concat());
        let manifest = read_json(&folder.path().join("out/manifest.json"));
        let light = &manifest["lights"][0];
        let count = |key: &str| light["error"][key].as_u64().expect(key);
        let missing = count("missing_shadow");
        assert_eq!((missing == 0, count("false_shadow"), count("wrong_surface")), (is_right, 0, 0));
        assert!(count("compared") > 1000 && light["error"]["edge_band"].is_u64());
        assert!(printed.contains(&format!("wrong pixels: {missing} of {}", count("compared"))));
        let read = |key: &str| {
            let file = folder.path().join("out").join(light[key].as_str().expect(key));
            let bytes = fs::read(file).expect("an array");
            // NumPy's format, version 1: magic, two bytes of version, two of the header's length, the header, the bytes.
            // `.ci/frames` has NumPy itself read arrays.
            assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
            let data = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
            let header = std::str::from_utf8(&bytes[10..data]).expect("text");
            for words in ["'descr': '|u1'", "'fortran_order': False", "'shape': (60, 80, )"] {
                assert!(header.contains(words), "{header}");
            }
            bytes[data..].to_vec()
        };
        let [truth, shadow, findings] = ["truth", "shadow", "error_picture"].map(read);
        let differing =
            truth.iter().zip(&shadow).filter(|(truth, shadow)| **truth == 1 && **shadow == 0).count() as u64;
        assert!(differing >= missing && differing <= missing + count("edge_band"));
        assert_eq!(findings.iter().filter(|finding| **finding == 2).count() as u64, missing);
        assert_eq!(light["findings"][2], "missing_shadow");
        if !is_right {
            let pixels = light["worst_region"]["pixels"].as_u64().expect("a region");
            assert!(pixels > missing / 2 && pixels <= missing, "{pixels} of {missing}");
        }
    }
}

#[test]
fn help_and_version_are_results() {
    let folder = folder();
    for (argument, word) in [("--help", "capture"), ("--version", "stencilscope")] {
        let output = run(folder.path(), &[argument]);
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), String::new()));
        assert!(text(&output.stdout).contains(word));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = folder();
    let mut child = program(folder.path(), &["scenes"]).stdout(Stdio::piped()).spawn().expect("the program runs");
    drop(child.stdout.take());
    assert!(child.wait().expect("an end").success());
    let full = fs::File::options().write(true).open("/dev/full").expect("a device that is full");
    let output = program(folder.path(), &["scenes"]).stdout(full).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(text(&output.stderr).lines().count(), 1);
}

/// One line on standard error where something of the scene's files is left out, and none where nothing is; standard output
/// has results alone.
#[test]
fn what_is_left_out_of_files_is_said_in_one_line() {
    let folder = folder();
    let what = "scan.obj: left out: 1 vertex that is not finite, 2 faces of fewer than three corners; ";
    let size = ["--size", "32x24"];
    let said = |arguments: &[&str]| {
        let output = run(folder.path(), &[arguments, &size].concat());
        assert!(!text(&output.stdout).contains("left out:"), "{}", text(&output.stdout));
        (text(&output.stderr), output)
    };
    let plan = Path::new("out").join("plan.txt").display().to_string();
    assert_eq!(said(&["capture", "scan.obj", "-o", "out"]).0, format!("stencilscope: {what}see {plan}\n"));
    let written = fs::read_to_string(folder.path().join(&plan)).expect("a plan");
    assert!(written.contains("left out: 1 vertex that is not finite of scan: no face uses them\n"), "{written}");
    let elsewhere = format!("stencilscope: {what}plan.txt of a capture says why\n");
    assert_eq!(said(&["pixel", "scan.obj", "--at", "10,10"]).0, elsewhere);
    assert_eq!(said(&["report", "scan.obj", "-t", "none", "--runs", "1"]).0, elsewhere);
    let (line, output) = said(&["diagnose", "scan.obj", "--json", "--no-techniques"]);
    assert!(line.starts_with(&elsewhere), "{line}");
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let first = serde_json::json!({"what": "1 vertex that is not finite", "because": "no face uses them"});
    assert_eq!((json["left_out_of_files"].as_array().map(Vec::len), &json["left_out_of_files"][0]), (Some(2), &first));
    for whole in ["triangle.obj", "tori"] {
        assert_eq!(said(&["capture", whole, "-t", "none", "-o", whole.trim_end_matches(".obj")]).0, "", "{whole}");
    }
}
