//! What is written to files, and what is said meanwhile: diagnoses, pages, the mark around the pick.

use super::diagnosis::{found, give_diagnosis, with_regions};
use super::*;
use stencilscope::inspector::{DialogKind, KnownDiagnosis};

fn page(harness: &mut Harness<Seen>) -> Option<KnownDiagnosis> {
    match harness.state_mut().inspector.export(ExportKind::Page) {
        Some(ExportData::Page { diagnosis, .. }) => diagnosis,
        other => panic!("a page, not {other:?}"),
    }
}

#[test]
fn a_diagnosis_is_saved_from_its_tab_as_text_and_as_json() {
    let mut harness = with_regions();
    click_button(&mut harness, "Save…");
    harness.get_by_label("Export: Diagnosis (text or JSON)");
    click_button(&mut harness, "Save");
    let Some(Action::Export { kind: ExportKind::Diagnosis, path, replace: false }) = harness.state().actions.last()
    else {
        panic!("an export: {:?}", harness.state().actions.last())
    };
    assert_eq!(path, "by-hand-z-pass-diagnosis.txt");
    let Some(ExportData::Diagnosis(written)) = harness.state_mut().inspector.export(ExportKind::Diagnosis) else {
        panic!("a diagnosis")
    };
    let text = written.to_text();
    assert!(text.starts_with("by hand, z-pass, 40x30: 100 of 1\u{a0}200 compared pixels are wrong"), "{text}");
    assert!(text.contains("eye-in-volume (proven)"), "{text}");
    let json: serde_json::Value = serde_json::from_str(&written.to_json().expect("JSON")).expect("JSON");
    assert_eq!((&json["schema"], json["regions"].as_array().map(Vec::len)), (&1.into(), Some(2)));
}

#[test]
fn before_anything_is_diagnosed_there_is_nothing_to_save() {
    let mut harness = harness(z_fail(SIZE));
    show_tab(&mut harness, "Diagnosis");
    assert!(harness.query_by_label("Save…").is_none());
    assert!(harness.state_mut().inspector.export(ExportKind::Diagnosis).is_none());
    click_button(&mut harness, "Export");
    assert!(is_disabled(&harness, "Diagnosis (text or JSON)…"));
}

/// A page has the diagnosis of its own frame, and of no other, and the dialog says which it is.
#[test]
fn a_page_carries_the_diagnosis_of_what_it_shows() {
    let mut harness = with_regions();
    show_capture(&mut harness, z_fail(SIZE));
    assert!(page(&mut harness).is_some());
    let open = |harness: &mut Harness<Seen>| {
        change(harness, |inspector| inspector.model.dialog = Some(DialogKind::Export(ExportKind::Page)));
    };
    open(&mut harness);
    harness.get_by_label_contains("Carries the diagnosis: each wrong region with its cause");
    press(&mut harness, Key::Escape);
    change(&mut harness, |inspector| drop(inspector.choose(Choice::new(Technique::ShadowMap))));
    show_capture(&mut harness, z_fail(SIZE));
    assert!(page(&mut harness).is_none());
    open(&mut harness);
    harness.get_by_label_contains("The diagnosis is not of the frame as it is shown");
}

#[test]
fn a_scene_file_says_which_model_it_needs() {
    let mut harness = harness(z_fail(SIZE));
    let mut open = |source: &str| {
        let request = run_request(Technique::ZFail);
        let source = source.to_owned();
        change(&mut harness, |inspector| {
            inspector.open_scene(&scene(), request, Some(source));
            inspector.model.dialog = Some(DialogKind::Export(ExportKind::Scene));
        });
        harness.run_steps(2);
        let says_so = says(&harness, "Names the model ring.obj by its place");
        press(&mut harness, Key::Escape);
        says_so
    };
    assert!(open("models/ring.obj"));
    assert!(!open("models/ring.toml") && !open("tori"));
}

/// Writing goes on beside the window: its dialog is closed, and the bar at the bottom says what is written.
#[test]
fn while_a_file_is_written_the_window_goes_on_and_says_so() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Export");
    click_button(&mut harness, "Page (HTML)…");
    change(&mut harness, |inspector| inspector.begin_writing("tori.html".to_owned()));
    harness.get_by_label("writing tori.html …");
    assert!(harness.query_by_label("Export: Page (HTML)").is_none());
    press(&mut harness, Key::ArrowLeft);
    assert_ne!(harness.state().inspector.model.selection.step, 3, "keys act");
    let canvas = |harness: &Harness<Seen>| harness.query_all_by_role(Role::Canvas).next().expect("a picture").rect();
    let picture = canvas(&harness);
    change(&mut harness, |inspector| inspector.end_writing(Ok("wrote /there/tori.html".to_owned())));
    assert!(!says(&harness, "writing "));
    let place = harness.get_by_label("wrote /there/tori.html").rect();
    let window = harness.ctx.content_rect();
    let from_below = window.bottom() - place.bottom();
    assert!(
        (0.0..40.0).contains(&from_below),
        "over the bar at the bottom, where it hides nothing that is read: {place}"
    );
    assert_eq!(canvas(&harness), picture, "nothing moves");
    // After a while it is in the bar at the bottom.
    click(&mut harness, "Dismiss");
    let place = harness.get_by_label("wrote /there/tori.html").rect();
    assert!(place.bottom() > window.bottom() - 40.0, "{place}");
    change(&mut harness, |inspector| inspector.begin_writing("other.html".to_owned()));
    change(&mut harness, |inspector| inspector.end_writing(Err("no room: choose another place".to_owned())));
    assert!(says(&harness, "no room: choose another place"), "with no dialog open, it is an error of the window");
}

/// The mark around the picked pixel is in a picture as it is shown, on both sides of a comparison; the plain one has values.
#[test]
fn the_pick_is_marked_in_a_picture_with_overlays() {
    let mut harness = picked(z_fail([200, 150]), [60, 70]);
    let picture = |harness: &mut Harness<Seen>, kind| match harness.state_mut().inspector.export(kind) {
        Some(ExportData::Picture(picture)) => picture,
        Some(ExportData::AsShown(drawing)) => drawing.finish(),
        other => panic!("a picture, not {other:?}"),
    };
    let [plain, shown] = [ExportKind::Picture, ExportKind::AsShown].map(|kind| picture(&mut harness, kind));
    let ring: Vec<[u32; 2]> = common::pixels([40, 40]).map(|[x, y]| [x + 40, y + 50]).collect();
    let changed = ring.iter().filter(|at| plain.at(**at) != shown.at(**at)).count();
    assert!(changed > 60, "{changed}");
    let light = ring.iter().filter(|at| shown.at(**at).is_some_and(|color| color[0] > 120)).count();
    assert!(light > 30, "{light}");
    assert_eq!(plain.at([60, 70]), shown.at([60, 70]), "not the pixel itself");
}

/// What is below the picture is as high for one tab as for the other; it grows once there is something to show.
#[test]
fn tabs_below_the_picture_are_as_high_as_each_other() {
    let mut harness = harness(z_fail(SIZE));
    let height = |harness: &mut Harness<Seen>, tab: &str| {
        show_tab(harness, tab);
        harness.get_by_role_and_label(Role::TabPanel, tab).rect().height()
    };
    let empty = ["Report", "Diagnosis", "Report"].map(|tab| height(&mut harness, tab));
    assert!(empty[0] == empty[1] && empty[1] == empty[2], "{empty:?}");
    change(&mut harness, |inspector| give_diagnosis(inspector, found()));
    let full = ["Diagnosis", "Report", "Stress", "Report"].map(|tab| height(&mut harness, tab));
    assert!(full[0] > empty[0] + 100.0 && full.iter().all(|one| *one == full[0]), "{full:?}");
}

/// Where a file goes is said whole, as what is too long for the dialog has its beginning and its end.
#[test]
fn the_dialog_says_in_which_folder_a_file_will_be() {
    let mut harness = harness(z_fail(SIZE));
    change(&mut harness, |inspector| inspector.model.dialog = Some(DialogKind::Export(ExportKind::Page)));
    let here = std::env::current_dir().expect("a folder").display().to_string();
    harness.get_by_label(&format!("in {here}"));
    let long = format!("/{}end", "some-folder/".repeat(30));
    change(&mut harness, |inspector| inspector.set_export_path(format!("{long}/a.html")));
    let place = harness.get_by_label(&format!("in {long}")).rect();
    assert!(place.width() < 500.0, "{place}");
    let shown = contrast::words(&harness).into_iter().find(|word| word.text.starts_with("in /some-folder"));
    let shown = shown.expect("the folder").text;
    assert!(shown.contains('…') && shown.ends_with("/end"), "{shown}");
}

/// A technique with its usual settings has no table of settings in a scene file.
#[test]
fn a_scene_file_has_no_empty_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.toml");
    for (settings, has_table) in [(&[][..], false), (&[("casters", "all")][..], true)] {
        let mut fixed = scene();
        let settings = settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        fixed.technique = Some(stencilscope::scene::TechniqueRequest { name: "z-fail".to_owned(), settings });
        stencilscope::scene::file::store(&fixed, None, &file).expect("stored");
        let text = std::fs::read_to_string(&file).expect("a file");
        assert!(text.contains("[technique]"), "{text}");
        assert_eq!(text.contains("[technique.settings]"), has_table, "{text}");
    }
}

/// Whoever types at once changes the name, and not the folder or the ending.
#[test]
fn the_name_without_its_ending_is_selected_first() {
    let mut harness = harness(z_fail(SIZE));
    change(&mut harness, |inspector| inspector.model.dialog = Some(DialogKind::Export(ExportKind::Page)));
    harness.run_steps(3);
    let path = |harness: &Harness<Seen>| harness.get_by_role(Role::TextInput).accesskit_node().value().expect("a path");
    let before = path(&harness);
    assert!(before.ends_with(".html"), "{before}");
    harness.event(Event::Text("mine".to_owned()));
    harness.run_steps(3);
    assert_eq!(path(&harness), "mine.html");
    // Back in the field after a click elsewhere, what was typed stays.
    let field = harness.ctx.memory(egui::Memory::focused).expect("the field");
    harness.ctx.memory_mut(|memory| memory.surrender_focus(field));
    harness.run_steps(3);
    harness.event(Event::Text("2".to_owned()));
    harness.run_steps(3);
    assert_eq!(path(&harness), "mine2.html");
}
