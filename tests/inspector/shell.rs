//! What surrounds the panels: undo, themes, help, export, recent files, reload, animation, layout.

use super::*;
use stencilscope::inspector::{StoredSettings, ThemeChoice};

#[test]
fn a_change_of_technique_is_taken_back_and_made_again_by_keys_and_buttons() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "shadow-map");
    click_button(&mut harness, "z-pass");
    press_with(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(last_run(&harness).choice.technique(), Technique::ShadowMap);
    click_button(&mut harness, "Undo");
    assert_eq!(last_run(&harness).choice.technique(), Technique::ZFail);
    click_button(&mut harness, "Redo");
    press_with(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(last_run(&harness).choice.technique(), Technique::ZPass);
    press_with(&mut harness, Modifiers::COMMAND, Key::Z);
    press_with(&mut harness, Modifiers::COMMAND, Key::Y);
    assert_eq!(last_run(&harness).choice.technique(), Technique::ZPass);
}

#[test]
fn a_change_of_the_scene_is_taken_back() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "Scene settings");
    set_value(&mut harness, "light 1 position x", 2.5);
    let before = scene().lights[0].position.x;
    assert_eq!(last_run(&harness).lights[0].position.x, 2.5);
    press_with(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(last_run(&harness).lights[0].position.x, before);
}

#[test]
fn undo_goes_back_to_the_scene_that_was_open_before_and_runs_it_as_it_was() {
    let mut inspector = Inspector::new(Vec::new());
    inspector.open_scene(&scene(), run_request(Technique::ZFail), Some("first".to_owned()));
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_of(inspector);
    click_button(&mut harness, "planar");
    let inspector = &mut harness.state_mut().inspector;
    inspector.open_scene(&scene(), run_request(Technique::ZPass), Some("second".to_owned()));
    harness.run_steps(2);
    press_with(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("first".to_owned())));
    // The app opens it, as a scene is opened first.
    change(&mut harness, |inspector| {
        inspector.open_scene(&scene(), run_request(Technique::ZFail), Some("first".to_owned()))
    });
    assert_eq!(last_run(&harness).choice.technique(), Technique::Planar);
}

#[test]
fn a_window_that_filled_the_screen_does_so_again_and_has_its_size() {
    let mut first = Inspector::default();
    first.model.closed.is_maximized = true;
    first.model.closed.size = Some([1500.0, 950.0]);
    let stored = serde_json::to_string(&first.remembered()).expect("JSON");
    let mut second = Inspector::default();
    second.recall(serde_json::from_str(&stored).expect("settings"));
    assert_eq!(second.model.closed, first.model.closed);
    // What was stored before there was such a thing.
    second.recall(serde_json::from_str("{}").expect("settings"));
    assert!(!second.model.closed.is_maximized && second.model.closed.size.is_none());
}

#[test]
fn the_theme_changes_by_key_and_button_and_is_remembered() {
    let mut harness = harness(z_fail(SIZE));
    assert!(harness.ctx.global_style().visuals.dark_mode);
    click_button(&mut harness, "View");
    harness.get_by_label_contains("Light theme").click();
    harness.run_steps(3);
    assert!(!harness.ctx.global_style().visuals.dark_mode);
    assert_eq!(harness.state().inspector.remembered().theme, ThemeChoice::Light);
    press_with(&mut harness, Modifiers::COMMAND, Key::L);
    assert_eq!(harness.state().inspector.remembered().theme, ThemeChoice::Dark);
}

#[test]
fn help_lists_the_keys_and_closes_again() {
    let mut harness = harness(z_fail(SIZE));
    for key in [Key::F1, Key::H, Key::Questionmark] {
        press(&mut harness, key);
        harness.get_by_label("go to a step by its number");
        harness.get_by_label("pick a pixel: its history is shown beside");
        press(&mut harness, Key::Escape);
        assert!(harness.query_by_label("go to a step by its number").is_none());
    }
    click_button(&mut harness, "Help");
    click_button(&mut harness, "Close help");
    assert!(harness.query_by_label("go to a step by its number").is_none());
}

#[test]
fn the_keys_of_the_help_stand_in_one_column_flush_left() {
    let mut harness = harness(z_fail(SIZE));
    press(&mut harness, Key::F1);
    harness.run_steps(2);
    // Keys of three sections, short and long.
    let [short, long, drag] = ["Ctrl-G", "N, Shift-N", "Left drag"].map(|key| harness.get_by_label(key).rect());
    for other in [long, drag] {
        assert!((short.left() - other.left()).abs() < 0.5, "{short:?}, {other:?}");
    }
    assert!(short.width() < long.width() && long.width() < 120.0, "as wide as their words: {short:?}, {long:?}");
    let does =
        ["go to a step by its number", "move the picture"].map(|words| harness.get_by_label(words).rect().left());
    assert!((does[0] - does[1]).abs() < 0.5 && does[0] > long.right(), "{does:?}");
}

#[test]
fn the_shown_picture_is_exported_where_it_is_wished_and_a_taken_place_is_asked_about() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Stencil");
    press_with(&mut harness, Modifiers::COMMAND, Key::S);
    harness.get_by_label("Export: Shown picture (PNG)");
    click_button(&mut harness, "Save");
    let asked = |harness: &Harness<Seen>| match harness.state().actions.last() {
        Some(Action::Export { kind, path, replace }) => (*kind, path.clone(), *replace),
        other => panic!("an export, not {other:?}"),
    };
    let (kind, path, replace) = asked(&harness);
    assert_eq!((kind, replace), (ExportKind::Picture, false));
    assert!(path.ends_with(".png") && path.contains("stencil"), "{path}");
    change(&mut harness, |inspector| inspector.ask_to_replace(path));
    harness.get_by_label("× Something of this name is there already.");
    click_button(&mut harness, "Replace it");
    assert!(asked(&harness).2);
    change(&mut harness, |inspector| inspector.end_export(Ok("wrote it".to_owned())));
    assert!(harness.query_by_label("Replace it").is_none());
    harness.get_by_label("wrote it");
}

#[test]
fn an_export_that_fails_says_so_in_its_dialog() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Export");
    click_button(&mut harness, "Capture folder…");
    change(&mut harness, |inspector| inspector.end_export(Err("no room: choose another place".to_owned())));
    harness.get_by_label("× no room: choose another place");
    click_button(&mut harness, "Browse…");
    assert!(matches!(harness.state().actions.last(), Some(Action::BrowseExport { .. })));
    change(&mut harness, |inspector| inspector.set_export_path("elsewhere".to_owned()));
    click_button(&mut harness, "Save");
    let asked = Action::Export { kind: ExportKind::Capture, path: "elsewhere".to_owned(), replace: false };
    assert_eq!(harness.state().actions.last(), Some(&asked));
}

#[test]
fn what_is_exported_is_what_is_shown() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.choose_picture(PictureKind::Stencil);
    inspector.model.select_step(1);
    let Some(ExportData::Picture(picture)) = inspector.export(ExportKind::Picture) else { panic!("a picture") };
    assert_eq!(picture.size(), SIZE);
    // Column 3 is in shadow, its count 1: the design's blue.
    assert_eq!(picture.at([3, 4]), Some([0x56, 0xb4, 0xe9]));
    let Some(ExportData::Data(images)) = inspector.export(ExportKind::Data) else { panic!("values") };
    assert_eq!(images[0].byte_at([3, 4]), Some(1));
    assert!(matches!(inspector.export(ExportKind::Capture), Some(ExportData::Capture(_))));
    assert!(matches!(inspector.export(ExportKind::Scene), Some(ExportData::Scene(_))));
    inspector.open_folder(None);
    assert!(inspector.export(ExportKind::Scene).is_none(), "a capture folder has no scene");
}

#[test]
fn the_diff_is_exported_as_it_is_shown() {
    let mut harness = harness(z_fail(SIZE));
    press(&mut harness, Key::Home);
    press(&mut harness, Key::ArrowRight);
    click_button(&mut harness, "Stencil");
    press(&mut harness, Key::D);
    let picture = |harness: &mut Harness<Seen>| match harness.state_mut().inspector.export(ExportKind::Picture) {
        Some(ExportData::Picture(picture)) => picture,
        other => panic!("a picture, not {other:?}"),
    };
    let diff = picture(&mut harness);
    // Column 3 went up by 1: the design's vermilion. Column 30 did not change: a dim grey.
    assert_eq!(diff.at([3, 4]), Some([0xe0, 0x70, 0x3a]));
    let ground = diff.at([30, 4]).expect("a pixel");
    assert!(ground[0] == ground[1] && ground[1] == ground[2], "{ground:?}");
    press(&mut harness, Key::D);
    let counts = picture(&mut harness);
    assert_ne!(counts.at([3, 4]), diff.at([3, 4]));
}

#[test]
fn what_was_opened_before_is_offered_and_opens() {
    let mut inspector = Inspector::new(Vec::new());
    for source in ["models/a.obj", "tori"] {
        inspector.open_scene(&scene(), run_request(Technique::ZFail), Some(source.to_owned()));
    }
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_of(inspector);
    click_button(&mut harness, "What is open: by hand");
    click_button(&mut harness, "models/a.obj");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("models/a.obj".to_owned())));
}

#[test]
fn files_that_were_opened_before_are_listed_where_one_opens() {
    let entry = SceneEntry { name: "tori".to_owned(), lesson: "a lesson".to_owned() };
    let mut inspector = Inspector::new(vec![entry]);
    for source in ["a.toml", "models/b.obj", "tori", "c.toml", "d.toml", "/far/e.toml"] {
        inspector.open_scene(&scene(), run_request(Technique::ZFail), Some(source.to_owned()));
    }
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_of(inspector);
    click_button(&mut harness, "Open…");
    harness.get_by_label("Opened before");
    assert!(harness.query_by_role_and_label(Role::Button, "a.toml").is_none(), "only the last ones");
    assert_eq!(harness.query_all_by_role_and_label(Role::Button, "tori").count(), 1, "it is a built-in scene");
    for name in ["b.obj", "c.toml", "d.toml", "e.toml", "Open this", "Browse…", "Cancel"] {
        let place = harness.get_by_role_and_label(Role::Button, name).rect();
        assert!(harness.ctx.content_rect().contains_rect(place), "{name}: {place}");
    }
    click_button(&mut harness, "b.obj");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("models/b.obj".to_owned())));
}

#[test]
fn a_changed_file_is_offered_for_reload_once() {
    let mut harness = harness(z_fail(SIZE));
    change(&mut harness, |inspector| inspector.model.activity.changed_file = Some("a.obj".to_owned()));
    harness.get_by_label("a.obj changed on disk.");
    click_button(&mut harness, "Load it again");
    assert_eq!(harness.state().actions.last(), Some(&Action::Reload));
    assert!(harness.query_by_label("a.obj changed on disk.").is_none());
    change(&mut harness, |inspector| inspector.model.activity.changed_file = Some("a.obj".to_owned()));
    click_button(&mut harness, "Not now");
    assert!(harness.query_by_label("a.obj changed on disk.").is_none());
}

fn moving() -> Scene {
    Scene { objects: common::opened("tori").objects, ..scene() }
}

#[test]
fn an_animation_runs_a_capture_at_a_time_and_steps_by_hand() {
    let mut inspector = Inspector::new(Vec::new());
    inspector.open_scene(&moving(), run_request(Technique::ZFail), Some("tori".to_owned()));
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_of(inspector);
    press(&mut harness, Key::Period);
    assert_eq!(runs(&harness).len(), 1);
    assert!((last_run(&harness).time - 1.0 / 30.0).abs() < 1e-9);
    harness.state_mut().inspector.set_capture(Arc::new(z_fail(SIZE)));
    press(&mut harness, Key::T);
    harness.run_steps(4);
    assert_eq!(runs(&harness).len(), 2, "the next moment waits for the capture of this one");
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!(runs(&harness).len(), 3);
    let time = last_run(&harness).time;
    click(&mut harness, "Scene settings");
    click_button(&mut harness, "Stop animation");
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!(runs(&harness).len(), 3);
    click_button(&mut harness, "Step");
    assert!(last_run(&harness).time > time);
    click_button(&mut harness, "To the start");
    assert_eq!(last_run(&harness).time, 0.0);
    click_button(&mut harness, "Run animation");
    show_capture(&mut harness, z_fail(SIZE));
    assert!(last_run(&harness).time > 0.0);
}

#[test]
fn objects_are_switched_off_and_on() {
    let mut inspector = Inspector::new(Vec::new());
    let scene = moving();
    inspector.open_scene(&scene, run_request(Technique::ZFail), None);
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_in(inspector, [1280.0, 3000.0]);
    click(&mut harness, "Scene settings");
    let name = scene.objects[1].name.clone();
    click_role(&mut harness, Role::CheckBox, &name);
    assert_eq!(last_run(&harness).off, BTreeSet::from([1]));
    click_role(&mut harness, Role::CheckBox, &name);
    assert_eq!(last_run(&harness).off, BTreeSet::new());
}

#[test]
fn a_moved_layout_is_remembered_and_a_broken_one_is_not_taken() {
    let mut harness = harness(z_fail(SIZE));
    assert_eq!(harness.state().inspector.remembered().layout, None, "nothing was moved");
    let from = harness.get_by_role_and_label(Role::Tab, "Report").rect().center();
    let to = harness.get_by_role_and_label(Role::Tab, "Pixel").rect().center();
    docking::drag_tab(&mut harness, from, to);
    let moved = harness.get_by_role_and_label(Role::Tab, "Report").rect();
    assert!(moved.center().distance(from) > 100.0, "it was dragged to the other tabs");
    let remembered = harness.state().inspector.remembered();
    assert!(remembered.layout.is_some());
    click_button(&mut harness, "View");
    click_button(&mut harness, "Reset layout");
    harness.run_steps(2);
    let reset = harness.get_by_role_and_label(Role::Tab, "Report").rect();
    assert!(reset.center().distance(from) < 2.0, "{reset:?} is where it was at first");
    assert_eq!(harness.state().inspector.remembered().layout, None);
    let stored = serde_json::to_string(&remembered).expect("text");
    let mut again = inspector(z_fail(SIZE));
    again.recall(serde_json::from_str::<StoredSettings>(&stored).expect("a memory"));
    let again = harness_of(again);
    let found = again.get_by_role_and_label(Role::Tab, "Report").rect();
    assert!(found.center().distance(moved.center()) < 60.0, "{found:?} is where it was: {moved:?}");
    let mut broken = inspector(z_fail(SIZE));
    let layout = Some(serde_json::json!({ "root": 1, "tiles": {} }));
    broken.recall(StoredSettings { layout, ..StoredSettings::default() });
    harness_of(broken).get_by_role_and_label(Role::Tab, "Report");
}

#[test]
fn in_a_narrow_window_the_techniques_are_a_menu() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), [800.0, 600.0]);
    assert!(harness.query_by_role_and_label(Role::Button, "shadow-map").is_none());
    let menu = harness.get_by_role_and_label(Role::ComboBox, "Technique").rect();
    let undo = harness.get_by_role_and_label(Role::Button, "Undo").rect();
    assert!(menu.right() < undo.left(), "{menu:?} leaves room for {undo:?}");
    click_role(&mut harness, Role::ComboBox, "Technique");
    harness.run_steps(1);
    harness.get_by_role_and_label(Role::Button, "shadow-map").click_accesskit();
    harness.run_steps(3);
    assert_eq!(last_run(&harness).choice.technique(), Technique::ShadowMap);
}

#[test]
fn the_techniques_stay_where_they_are_whatever_is_open() {
    let place = |name: &str| {
        let mut inspector = inspector(z_fail(SIZE));
        inspector.set_scene(&Scene { name: name.to_owned(), ..scene() }, run_request(Technique::ZFail));
        let harness = harness_of(inspector);
        harness.get_by_label(&format!("What is open: {name}"));
        harness.get_by_role_and_label(Role::Button, "z-fail").rect()
    };
    assert_eq!(place("b"), place("the prison block with its hundred and twenty cells.obj"));
}
