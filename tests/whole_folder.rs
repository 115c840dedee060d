//! Capture folders that hold the frame and its scene: what was asked of the run can be asked of the folder.

use crate::commands::{folder as work_folder, read_json, run, text};
use crate::common::random::Random;
use crate::common::{cuboid, from_above, request, session, square};
use glam::DVec3;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use stencilscope::capture::Capture;
use stencilscope::capture::disk::{WholeFrame, read, read_whole, write};
use stencilscope::plan::{ExactRange, FramePlan};
use stencilscope::progress::Progress;
use stencilscope::scene::{Light, Object, Scene};
use stencilscope::session::{InjectedFault, RunFrame, Session};
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [61, 37];

/// A box, and one that is seen through, over a floor, in two lights.
fn scene() -> Scene {
    let glass = Object { casts: false, ..square("glass", 2.0, 1.0) };
    let mut scene = from_above(vec![cuboid("a box", [1.0, 0.1, 0.0], [2.0, 1.1, 1.0]), glass]);
    scene.lights.push(Light::directional(DVec3::new(1.0, 2.0, 0.5)));
    scene
}

fn written(session: &mut Session, technique: Technique, folder: &Path) -> RunFrame {
    let frame = session.render(scene(), request(technique, SIZE)).expect("a frame");
    write(frame.contents(), folder, true).expect("written");
    frame
}

fn without_images(plan: &FramePlan) -> FramePlan {
    let mut plan = plan.clone();
    plan.passes.iter_mut().for_each(|pass| pass.image = None);
    plan
}

#[test]
fn plan_scene_and_settings_of_every_technique_come_back_the_same() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    for technique in Technique::ALL {
        let folder = parent.path().join(technique.name());
        let frame = written(&mut session, technique, &folder);
        let WholeFrame { mut capture, plan, scene } = read_whole(&folder).expect("read");
        capture.timing.write_ms = None;
        let (of_run, request) = frame.made().expect("a source");
        assert!(capture == *frame.capture, "{}", technique.name());
        let plan = plan.expect("a plan");
        assert!(without_images(&plan) == without_images(&frame.plan), "{}", technique.name());
        let mut scene = scene.expect("a scene");
        assert_eq!(scene.technique.take().map(|wish| wish.name).as_deref(), Some(technique.name()));
        assert!(scene == *of_run, "{}", technique.name());
        // The plan is run, and leaves what it left.
        let again = session.capture_plan(&scene, &plan).expect("a capture");
        let left = |capture: &Capture| capture.steps.iter().map(|step| step.snapshot.clone()).collect::<Vec<_>>();
        assert!(left(&again) == left(&frame.capture) && again.lights == frame.capture.lights, "{}", technique.name());
        let opened = RunFrame::from_folder(read_whole(&folder).expect("read")).expect("a whole frame");
        assert_eq!(opened.made().expect("a source").1.choice, request.choice);
    }
}

#[test]
fn histories_ladders_and_diagnoses_are_those_of_the_run() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    let mut random = Random::new(5);
    for technique in [Technique::ZPass, Technique::ZFail, Technique::Auto, Technique::ShadowMap] {
        let folder = parent.path().join(technique.name());
        let frame = written(&mut session, technique, &folder);
        let opened = RunFrame::from_folder(read_whole(&folder).expect("read")).expect("a whole frame");
        for _ in 0..40 {
            let pixel = SIZE.map(|side| random.below(side));
            let [of_run, of_folder] =
                [&frame, &opened].map(|frame| session.history(&frame.plan, &frame.capture, pixel).expect("a history"));
            assert!(of_folder.agrees(), "{:?}", of_folder.disagreements());
            assert_eq!(of_run, of_folder);
            assert_eq!(of_run.ladder(0, &frame.capture.depth), of_folder.ladder(0, &opened.capture.depth));
        }
        let mut diagnose = |frame: &RunFrame| {
            let (scene, request) = frame.made().expect("a source");
            session.diagnose(scene, request, InjectedFault::None, &Progress::default()).expect("a diagnosis")
        };
        assert!(diagnose(&frame) == diagnose(&opened), "{}", technique.name());
    }
}

#[test]
fn a_folder_of_schema_1_opens_as_it_did() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    let folder = parent.path().join("old");
    let frame = written(&mut session, Technique::ZFail, &folder);
    for name in ["frame.json", "scene.toml"] {
        fs::remove_file(folder.join(name)).expect("removed");
    }
    let manifest = folder.join("manifest.json");
    let old = fs::read_to_string(&manifest).expect("text").replace("\"schema\": 2", "\"schema\": 1");
    fs::write(&manifest, old).expect("written");
    let whole = read_whole(&folder).expect("read");
    assert!(whole.plan.is_none() && whole.scene.is_none() && whole.capture.steps == frame.capture.steps);
    assert!(RunFrame::from_folder(whole).is_err());
}

/// Numbers of a text, one after the other, replaced by others that lie.
fn lies(text: &str, random: &mut Random) -> String {
    const VALUES: [&str; 9] = ["0", "1", "7", "255", "4294967295", "18446744073709551615", "-1", "1e30", "0.5"];
    let starts: Vec<usize> = text
        .char_indices()
        .filter(|(at, c)| c.is_ascii_digit() && *at > 0 && b":[,-".contains(&text.as_bytes()[at - 1]))
        .map(|(at, _)| at)
        .collect();
    let at = starts[random.below(starts.len() as u32) as usize];
    let end = text[at..].find(|c: char| !(c.is_ascii_digit() || ".e-+".contains(c))).map_or(text.len(), |end| at + end);
    format!("{}{}{}", &text[..at], VALUES[random.below(VALUES.len() as u32) as usize], &text[end..])
}

#[test]
fn a_frame_that_lies_is_refused_or_can_be_asked_about() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    let mut random = Random::new(11);
    let (mut refused, mut read) = (0, 0);
    let exact = ExactRange { far: 0.0, behind_eye: false, infinity: false, coarse_step: Some(1.0 / 256.0) };
    let techniques = [Technique::ZFail, Technique::ShadowMap, Technique::Projective, Technique::RayTraced];
    let with_pieces = [Technique::ZFail, Technique::ShadowMap].map(|technique| (technique, true));
    for (technique, has_pieces) in techniques.map(|technique| (technique, false)).into_iter().chain(with_pieces) {
        let folder = parent.path().join(technique.name());
        let mut frame = written(&mut session, technique, &folder);
        if has_pieces {
            frame.plan = Arc::new(frame.plan.as_ref().clone().clipped(&exact));
            write(frame.contents(), &folder, true).expect("written");
            assert!(fs::read_to_string(folder.join("frame.json")).expect("text").contains("pieces_of"));
        }
        let file = folder.join("frame.json");
        let text = fs::read_to_string(&file).expect("text");
        for _ in 0..150 {
            fs::write(&file, lies(&text, &mut random)).expect("written");
            match read_whole(&folder) {
                Err(error) => {
                    let error = error.to_string();
                    assert!(error.contains("frame.json") && !error.contains('\n'), "{error}");
                    refused += 1;
                }
                Ok(whole) => {
                    let plan = whole.plan.expect("a plan");
                    // Whatever it says: an answer or an error.
                    drop(session.history(&plan, &frame.capture, [30, 20]));
                    drop(plan.to_string());
                    read += 1;
                }
            }
        }
    }
    assert!(refused > 50 && read > 50, "{refused} refused, {read} read");
}

#[test]
fn arrays_that_lie_are_refused_by_name() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    let folder = parent.path().join("out");
    written(&mut session, Technique::ZFail, &folder);
    let refused = |file: &str, bytes: &[u8], words: &str| {
        let whole = fs::read(folder.join(file)).expect("bytes");
        fs::write(folder.join(file), bytes).expect("broken on purpose");
        let error = read_whole(&folder).expect_err("an error").to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
        // The pictures alone need no frame.
        assert!(file.ends_with(".toml") || read(&folder).is_ok());
        fs::write(folder.join(file), whole).expect("mended");
    };
    let bytes = fs::read(folder.join("mesh000.vertices.npy")).expect("bytes");
    refused("mesh000.vertices.npy", &bytes[..bytes.len() - 16], "mesh000.vertices.npy: it is cut off");
    refused("mesh000.vertices.npy", b"", "mesh000.vertices.npy: no NumPy array");
    refused("mesh000.indices.npy", &bytes, "mesh000.indices.npy: ");
    // The last mesh is drawn, whatever was clipped.
    let files = crate::common::names(&folder);
    let of_last = files.iter().rfind(|name| name.ends_with(".indices.npy")).expect("indices");
    let mut indices = fs::read(folder.join(of_last)).expect("bytes");
    let last = indices.len() - 4;
    indices[last..].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(of_last, &indices, "an index of its mesh is out of range");
    let text = fs::read_to_string(folder.join("frame.json")).expect("text");
    refused("frame.json", text.replacen("mesh000.vertices", "../vertices", 1).as_bytes(), "outside its folder");
    for bits in ["0", "25", "32", "64"] {
        let of_bits = format!("\"depth_bits\": {bits}, \"layers\":");
        let lying = text.replacen("\"layers\":", &of_bits, 1);
        assert_ne!(lying, text);
        refused("frame.json", lying.as_bytes(), &format!("depths of {bits} bits"));
    }
    refused("frame.json", b"{", "frame.json: EOF");
    refused("scene.toml", b"name = 3", "scene.toml");
}

#[test]
fn pixel_and_diagnose_take_a_folder_that_lies_elsewhere() {
    let work = work_folder();
    let made =
        run(work.path(), &["capture", "tori", "-t", "z-fail", "--size", "80x60", "-o", "one", "--every", "draw"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let moved = tempfile::tempdir().expect("a folder");
    fs::rename(work.path().join("one"), moved.path().join("two")).expect("moved");
    let place = moved.path().join("two").display().to_string();
    let at = ["--at", "40,30", "--at", "20,45", "--json"];
    let of_scene = run(work.path(), &[&["pixel", "tori", "-t", "z-fail", "--size", "80x60"], &at[..]].concat());
    let of_folder = run(work.path(), &[&["pixel", &place], &at[..]].concat());
    assert!(of_folder.status.success(), "{}", text(&of_folder.stderr));
    let untimed = |output: &[u8]| {
        let mut pixels: serde_json::Value = serde_json::from_slice(output).expect("JSON");
        pixels.as_array_mut().expect("a list").iter_mut().for_each(|pixel| pixel["milliseconds"] = 0.into());
        pixels
    };
    assert_eq!(untimed(&of_scene.stdout), untimed(&of_folder.stdout));
    let diagnosis = |subject: &[&str]| run(work.path(), &[&["diagnose", "--no-techniques"], subject].concat());
    let [of_scene, of_folder] = [&["tori", "-t", "z-fail", "--size", "80x60"][..], &[&place]].map(diagnosis);
    assert_eq!(text(&of_scene.stdout), text(&of_folder.stdout));
    assert_eq!(of_scene.status.code(), of_folder.status.code());
    let refused = run(work.path(), &["pixel", &place, "--at", "1,1", "-t", "z-pass"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("leave its options out"), "{}", text(&refused.stderr));
}

#[test]
fn what_two_meshes_share_is_one_file() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    let folder = parent.path().join("out");
    let frame = written(&mut session, Technique::ZFail, &folder);
    let entry = read_json(&folder.join("frame.json"));
    let meshes = entry["meshes"].as_array().expect("meshes");
    for (a, of_a) in frame.plan.meshes.iter().zip(meshes) {
        for (b, of_b) in frame.plan.meshes.iter().zip(meshes) {
            assert_eq!(a.vertices == b.vertices, of_a["vertices"] == of_b["vertices"]);
            assert_eq!(a.indices == b.indices, of_a["indices"] == of_b["indices"]);
        }
    }
}
