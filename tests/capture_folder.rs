//! Capture folders of real frames, and hostile ones. (What holds for any capture is tested beside the code.)

use crate::commands::read_json;
use crate::common::{cuboid, from_above, names, request, session, square};
use glam::DVec3;
use std::fs;
use stencilscope::capture::Capture;
use stencilscope::capture::disk::{read, write};
use stencilscope::scene::Light;
use stencilscope::technique::Technique;

fn captures() -> Vec<Capture> {
    let mut session = session();
    let mut scene = from_above(vec![square("caster", 2.0, 1.0), cuboid("a box", [3.0, 0.0, 0.0], [4.0, 3.9, 1.0])]);
    scene.lights.push(Light::directional(DVec3::new(1.0, 2.0, 0.5)));
    let captures = Technique::ALL.map(|technique| {
        let mut capture = session.capture(&scene, &request(technique, [61, 37])).expect("a capture");
        capture.timing.frame_ms = Some(1.5);
        capture
    });
    captures.to_vec()
}

/// The time that writing took is known only afterwards.
fn without_write_time(mut capture: Capture) -> Capture {
    capture.timing.write_ms = None;
    capture
}

#[test]
fn every_technique_is_written_and_read_back_the_same() {
    let parent = tempfile::tempdir().expect("a folder");
    for capture in captures() {
        let folder = parent.path().join(&capture.technique);
        write(&capture, &folder, false).expect("written");
        assert!(without_write_time(read(&folder).expect("read")) == capture, "{}", capture.technique);
        assert_eq!(names(parent.path()).iter().filter(|name| name.starts_with('.')).count(), 0);
    }
}

#[test]
fn files_are_named_by_pass_and_shared_where_nothing_changed() {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("out");
    let capture = captures().into_iter().find(|capture| capture.technique == "z-fail").expect("z-fail");
    write(&capture, &folder, false).expect("written");
    let expected = [
        "000-ambient.color.png",
        "000-ambient.depth.npy",
        "000-ambient.stencil.npy",
        "001-volumes.stencil.npy",
        "003-light.color.png",
        "003-light.stencil.npy",
        "004-volumes.stencil.npy",
        "006-light.color.png",
        "006-light.stencil.npy",
        "light0.shadow.npy",
        "light1.shadow.npy",
        "manifest.json",
        "plan.txt",
    ];
    assert_eq!(names(&folder), expected);
    let manifest = read_json(&folder.join("manifest.json"));
    assert_eq!(manifest["passes"][0]["unchanged"], serde_json::json!(["stencil"]));
    assert_eq!(manifest["passes"][1]["unchanged"], serde_json::json!(["color", "depth"]));
    assert_eq!(manifest["passes"][1]["color"], "000-ambient.color.png");
    assert_eq!(manifest["passes"][2]["labels"], "light0.shadow.npy");
    assert_eq!(manifest["lights"][1]["kind"], "directional");
    assert_eq!(manifest["lights"][1]["towards"], serde_json::json!([1.0, 2.0, 0.5]));
    assert!(manifest["lights"][1].get("position").is_none());
    assert_eq!(manifest["camera"]["far"], serde_json::Value::Null);
}

#[test]
fn a_broken_folder_is_an_error_that_names_the_file() {
    let parent = tempfile::tempdir().expect("a folder");
    let has_map = |capture: &Capture| capture.technique == "shadow-map";
    let capture = captures().into_iter().find(has_map).expect("a capture");
    let broken = |file: &str, contents: &[u8]| {
        let folder = parent.path().join("out");
        write(&capture, &folder, true).expect("written");
        fs::write(folder.join(file), contents).expect("broken on purpose");
        let error = read(&folder).expect_err("an error").to_string();
        assert!(error.contains(file) && !error.contains('\n'), "{error}");
    };
    broken("manifest.json", b"{");
    broken("manifest.json", &[0xff, 0xfe]);
    broken("light0.shadow.npy", b"");
    broken("light0.shadow.npy", b"\x93NUMPY\x01\x00");
    broken("light0.map.npy", b"not an array");
    let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (4000000000, 4000000000), }\n";
    let mut huge = b"\x93NUMPY\x01\x00".to_vec();
    huge.extend((header.len() as u16).to_le_bytes());
    huge.extend(header.as_bytes());
    broken("light0.shadow.npy", &huge);
    let manifest = fs::read_to_string(parent.path().join("out/manifest.json")).expect("text");
    broken("manifest.json", manifest.replace("light0.shadow.npy", "../light0.shadow.npy").as_bytes());
    assert!(read(&parent.path().join("nowhere")).is_err());
}
