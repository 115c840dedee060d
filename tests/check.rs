//! `check` from outside: what it says of this machine's adapter, and that whatever is unexplained fails.

use crate::commands::{assert_fails, done, folder, printed_json, run, text};
use crate::common::session;
use crate::help::assert_json_is_explained;
use serde_json::Value;
use std::fs;
use std::path::Path;
use stencilscope::check::{CheckReference, HISTORIES, LabelsHash};
use stencilscope::scene::builtin;
use stencilscope::technique::Technique;

/// The smallest scene.
const SCENE: &str = "tetrahedron";

/// What the adapter of this machine draws of a scene, to compare it with itself: whichever it is, it is equal.
fn own_reference(folder: &Path, scene: &str) -> CheckReference {
    done(folder, &["check", "--scene", scene, "--write-reference", "own.json"]);
    CheckReference::from_json(&fs::read_to_string(folder.join("own.json")).expect("a file")).expect("a reference")
}

/// Runs the check of one scene against a reference; returns the exit code and what it printed.
fn checked(folder: &Path, scene: &str, reference: &CheckReference) -> (Option<i32>, String, String) {
    fs::write(folder.join("changed.json"), reference.to_json().expect("JSON")).expect("written");
    let output = run(folder, &["check", "--scene", scene, "--reference", "changed.json"]);
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn the_shipped_reference_has_every_scene_by_every_technique() {
    let reference = CheckReference::shipped().expect("it reads");
    let names: Vec<&str> = reference.scenes.iter().map(|scene| scene.scene.as_str()).collect();
    assert_eq!(names, builtin::ALL.iter().map(|builtin| builtin.name).collect::<Vec<_>>());
    for scene in &reference.scenes {
        let techniques: Vec<Technique> = scene.rows.iter().map(|row| row.technique).collect();
        assert_eq!(techniques, Technique::rivals(), "{}", scene.scene);
    }
}

#[test]
fn an_adapter_is_equal_to_itself_and_its_text_begins_with_version_and_adapter() {
    let folder = folder();
    let reference = own_reference(folder.path(), SCENE);
    let (code, printed, errors) = checked(folder.path(), SCENE, &reference);
    assert_eq!((code, errors), (Some(0), String::new()), "{printed}");
    let adapter = session().adapter().in_words();
    let start = format!("stencilscope {} check\nadapter    {adapter}\n", env!("CARGO_PKG_VERSION"));
    assert!(printed.starts_with(&start), "{printed}");
    let rows = Technique::rivals().len();
    let sum = format!("\n{rows} rows: {rows} equal, 0 no more wrong, 0 wrong, 0 not drawn; 50 of 50 histories");
    assert!(printed.contains(&sum) && printed.ends_with("Nothing is unexplained.\n"), "{printed}");
    assert!(printed.contains("corners snap to 1/"), "{printed}");
}

/// Truths take no GPU: every system has the shipped ones.
#[test]
fn truths_are_those_that_come_with_the_program_and_every_key_is_explained() {
    let folder = folder();
    let document = printed_json(folder.path(), &["check", "--scene", SCENE, "--json"]);
    assert_json_is_explained("check", &document);
    assert_eq!(document["schema"], 1);
    let scene = &document["scenes"][0];
    assert_eq!((&scene["scene"], &scene["truth"]["is_equal"]), (&Value::from(SCENE), &Value::from(true)));
    assert_eq!(scene["histories"]["pixels"], HISTORIES);
    let rows = scene["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), Technique::rivals().len());
    for row in rows {
        assert!(row["frame_ms"].as_f64().is_some_and(|ms| ms > 0.0), "{row}");
        assert!(row["compared"].as_u64() > Some(1000) && row["reference"]["labels"].is_string(), "{row}");
    }
}

#[test]
fn another_truth_and_other_labels_are_reported_and_only_the_truth_is_unexplained() {
    let folder = folder();
    let mut reference = own_reference(folder.path(), SCENE);
    let other: LabelsHash = "0123456789abcdef".parse().expect("a hash");
    reference.scenes[0].rows[0].labels = other;
    let (code, printed, _) = checked(folder.path(), SCENE, &reference);
    assert_eq!(code, Some(0), "labels may differ where none is wrong: {printed}");
    assert!(printed.contains(" 1 no more wrong, 0 wrong"), "{printed}");
    reference.scenes[0].truth = other;
    let (code, printed, errors) = checked(folder.path(), SCENE, &reference);
    assert_eq!((code, errors.lines().count()), (Some(1), 1), "{printed}");
    assert!(printed.contains("\n!! tetrahedron truth: ") && errors.contains("1 truth"), "{printed}{errors}");
}

/// In `inside`, z-pass is wrong for a reason that a diagnosis proves.
#[test]
fn what_is_wrong_beyond_the_reference_is_diagnosed_and_a_proven_cause_explains_it() {
    let folder = folder();
    let mut reference = own_reference(folder.path(), "inside");
    let row = reference.scenes[0].rows.iter_mut().find(|row| row.technique == Technique::ZPass).expect("a row");
    assert!(row.wrong > 100 && !row.causes.is_empty(), "{row:?}");
    let (wrong, unproven) = (row.wrong, row.unproven());
    (row.wrong, row.labels) = (unproven, "0123456789abcdef".parse().expect("a hash"));
    row.causes.clear();
    let (code, printed, _) = checked(folder.path(), "inside", &reference);
    let line = printed.lines().find(|line| line.contains("inside z-pass: ")).expect("it is reported");
    assert!(line.starts_with("   inside z-pass: wrong: ") && line.contains(" by "), "{line}");
    assert!(
        line.replace('\u{a0}', "").contains(&format!("{unproven} on the reference adapter")) && wrong > unproven,
        "{line}"
    );
    assert_eq!(code, Some(0), "{printed}");
}

/// Some pixels of a map are wrong for a reason that no diagnosis proves: the reference excuses them, and once its number
/// is smaller they are unexplained.
#[test]
fn a_smaller_number_in_the_reference_is_reported_and_fails() {
    let folder = folder();
    let mut reference = own_reference(folder.path(), "inside");
    let row = reference.scenes[0].rows.iter_mut().find(|row| row.technique == Technique::ShadowMap).expect("a row");
    let wrong = row.wrong;
    (row.wrong, row.labels) = (0, "0123456789abcdef".parse().expect("a hash"));
    row.causes.clear();
    let (code, printed, errors) = checked(folder.path(), "inside", &reference);
    let line = printed.lines().find(|line| line.starts_with("!! ")).expect("it is marked").replace('\u{a0}', "");
    let start = format!("!! inside shadow-map: wrong: {wrong} pixels, 0 on the reference adapter; ");
    assert!(line.starts_with(&start) && line.ends_with(" unexplained"), "{line}");
    assert!(code == Some(1) && errors.contains("1 row"), "{printed}{errors}");
}

#[test]
fn broken_usage_is_refused_in_one_line_with_the_fix() {
    assert_fails(&["check", "--scene", "torii"], 2, &["torii", "did you mean `tori`?"]);
    assert_fails(&["check", "--adapter", "no such card"], 3, &["no such card"]);
    assert_fails(&["check", "--reference", "missing.json"], 2, &["missing.json", "no such file"]);
    assert_fails(&["check", "--reference", "good.toml"], 2, &["good.toml", "can't be read"]);
    assert_fails(&["check", "--json=models"], 2, &["models"]);
    assert_fails(&["check", "--json", "--write-reference", "a.json"], 2, &["--write-reference"]);
}
