//! What opens a scene, a model or a folder, and what is said where it can't be opened.

use super::*;

#[test]
fn the_dialog_opens_built_in_scenes_and_paths() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "Open…");
    harness.get_by_label("what table teaches");
    click(&mut harness, "table");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("table".to_owned())));
    assert!(harness.query_by_label("what table teaches").is_none(), "it closes");
    press_with(&mut harness, Modifiers::COMMAND, Key::O);
    harness.get_by_role(Role::TextInput).type_text("models/bunny.obj");
    harness.run_steps(2);
    click(&mut harness, "Open this");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("models/bunny.obj".to_owned())));
    harness.get_by_label("Opening models/bunny.obj …");
    change(&mut harness, |inspector| inspector.set_scene(&scene(), run_request(Technique::ZFail)));
    assert!(harness.query_by_role(Role::TextInput).is_none(), "it closes once that is open");
    show_capture(&mut harness, z_fail(SIZE));
    click(&mut harness, "Open…");
    click(&mut harness, "Browse…");
    assert_eq!(harness.state().actions.last(), Some(&Action::Browse));
    click(&mut harness, "Open…");
    click(&mut harness, "Browse captures…");
    assert_eq!(harness.state().actions.last(), Some(&Action::BrowseFolder));
}

/// A path that was mistyped is there to be corrected, with the reason beside it; one that was dropped is told of above.
#[test]
fn a_typed_path_that_can_not_be_opened_stays_in_the_dialog() {
    let mut harness = harness(z_fail(SIZE));
    let reason = "no such file: models/buny.obj";
    let refuse = |harness: &mut Harness<Seen>| {
        change(harness, |inspector| inspector.push_unopened("models/buny.obj", reason.to_owned()));
    };
    refuse(&mut harness);
    assert!(says(&harness, reason) && harness.query_by_role(Role::TextInput).is_none());
    click(&mut harness, "Open…");
    harness.get_by_role(Role::TextInput).type_text("models/buny.obj");
    harness.run_steps(2);
    click(&mut harness, "Open this");
    refuse(&mut harness);
    harness.run_steps(2);
    assert_eq!(harness.get_by_role(Role::TextInput).value().as_deref(), Some("models/buny.obj"));
    harness.get_by_label(&format!("× {reason}"));
    harness.get_by_role(Role::TextInput).type_text("x");
    harness.run_steps(2);
    assert!(harness.query_by_label(&format!("× {reason}")).is_none(), "it is corrected");
}

/// What is typed while a path is being opened is typed into the dialog, and opened in its turn.
#[test]
fn a_path_that_is_typed_right_after_another_is_not_lost() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "Open…");
    let enter = |harness: &mut Harness<Seen>, path: &str| {
        press_with(harness, Modifiers::COMMAND, Key::A);
        harness.event(Event::Text(path.to_owned()));
        harness.run_steps(1);
        press(harness, Key::Enter);
    };
    harness.run_steps(2);
    enter(&mut harness, "no/such.obj");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("no/such.obj".to_owned())));
    // The error is still to come.
    enter(&mut harness, "models/bunny.obj");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("models/bunny.obj".to_owned())));
    change(&mut harness, |inspector| inspector.push_unopened("no/such.obj", "no such file".to_owned()));
    assert!(says(&harness, "no such file") && says(&harness, "Opening models/bunny.obj …"));
    assert_eq!(harness.get_by_role(Role::TextInput).value().as_deref(), Some("models/bunny.obj"));
    // An error that comes while another path is typed leaves that as it is.
    press_with(&mut harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("models/kn".to_owned()));
    harness.run_steps(1);
    change(&mut harness, |inspector| inspector.push_unopened("models/bunny.obj", "no such model".to_owned()));
    harness.get_by_label("× no such model");
    assert_eq!(harness.get_by_role(Role::TextInput).value().as_deref(), Some("models/kn"));
}

/// Without a dialog of the system a path can still be typed, where that is said.
#[test]
fn where_there_is_no_file_chooser_the_dialog_says_so_and_takes_a_path() {
    let mut harness = harness(z_fail(SIZE));
    let reason = "this system has no file chooser: type the path here";
    click(&mut harness, "Open…");
    click(&mut harness, "Browse…");
    change(&mut harness, |inspector| inspector.push_no_chooser(reason.to_owned()));
    harness.get_by_label(&format!("× {reason}"));
    harness.get_by_role(Role::TextInput).type_text("models/bunny.obj");
    harness.run_steps(2);
    click(&mut harness, "Open this");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("models/bunny.obj".to_owned())));
    press(&mut harness, Key::Escape);
    // An export's place is typed in its own dialog.
    click_button(&mut harness, "Export");
    click_button(&mut harness, "Page (HTML)…");
    click_button(&mut harness, "Browse…");
    change(&mut harness, |inspector| inspector.push_no_chooser(reason.to_owned()));
    harness.get_by_label(&format!("× {reason}"));
    harness.get_by_role_and_label(Role::Button, "Save");
}

/// The first answer is one about a shadow, of the light with whose pass the frame ends.
#[test]
fn the_first_pick_is_in_the_shadow_of_the_light_that_is_looked_at() {
    let mut session = common::session();
    for name in ["two-lights", "tori", "gate"] {
        let frame = common::frame(&mut session, name, common::request(Technique::Auto, [320, 240]));
        let mut inspector = inspector((*frame.capture).clone());
        inspector.model.take_first_look();
        let at = inspector.model.selection.pick.expect("a pick");
        let light = inspector.model.light_in_question(&frame.capture, at);
        let mask = frame.capture.lights[light].shadow.as_ref().expect("a mask");
        assert_eq!(mask.byte_at(at), Some(stencilscope::truth::SHADOW), "{name}");
    }
}

#[test]
fn a_dropped_file_is_opened() {
    let mut harness = harness(z_fail(SIZE));
    harness.input_mut().dropped_files.push(Arc::new(Dropped(PathBuf::from("dropped.obj"))));
    harness.run_steps(1);
    assert_eq!(harness.state().actions, [Action::Open("dropped.obj".to_owned())]);
}

#[test]
fn an_error_stays_until_dismissed_and_so_does_the_picture() {
    let mut harness = harness(z_fail(SIZE));
    change(&mut harness, |inspector| {
        inspector.model.push_error("nothing.obj: no such file: check the path".to_owned())
    });
    harness.get_by_label("nothing.obj: no such file: check the path");
    harness.get_by_label("step 3 of 3");
    click(&mut harness, "Dismiss");
    assert!(harness.state().inspector.model.activity.messages.is_empty());
    assert!(harness.query_by_label_contains("no such file").is_none());
}

#[test]
fn what_went_otherwise_is_a_warning_and_no_error() {
    let mut harness = harness(z_fail(SIZE));
    change(&mut harness, |inspector| {
        inspector.model.push_warning("a card gave no device; using another".to_owned());
    });
    harness.get_by_label("! Warning");
    harness.get_by_label("a card gave no device; using another");
    assert!(harness.query_by_label("× Error").is_none());
}

#[test]
fn why_a_scene_could_not_be_opened_goes_once_one_is_and_other_errors_stay() {
    let mut harness = harness(z_fail(SIZE));
    let inspector = &mut harness.state_mut().inspector;
    inspector.push_failure("nothing.obj: no such file: check the path".to_owned());
    inspector.model.push_error("out.png can't be written: choose another place".to_owned());
    harness.run_steps(2);
    harness.get_by_label("nothing.obj: no such file: check the path");
    show_capture(&mut harness, z_fail(SIZE));
    assert!(harness.query_by_label_contains("no such file").is_none());
    harness.get_by_label("out.png can't be written: choose another place");
}

#[test]
fn with_nothing_open_it_says_what_to_do() {
    let harness = harness_of(Inspector::default());
    harness.get_by_label("Nothing is open yet.");
    harness.get_by_label_contains("Press Open…");
    harness.get_by_label_contains("Open a scene, a model or a capture folder");
}
