//! A frame pass by pass and a light going round, from the Export menu: what is asked for, how far it is, how it ends.

use super::*;
use stencilscope::ask::{FilmOf, FilmSubject, Filmed};

/// As the app does where a film is to be exported.
fn started() -> Harness<'static, Seen> {
    let mut harness = harness(z_fail(SIZE));
    let inspector = &mut harness.state_mut().inspector;
    let Some(ExportData::Film(subject)) = inspector.export(ExportKind::Steps) else { panic!("a film") };
    inspector.model.answers.start(FilmOf { subject, path: "a.png".to_owned(), pick: None });
    harness.run_steps(2);
    harness
}

#[track_caller]
fn is_offered(harness: &mut Harness<Seen>, name: &str) -> bool {
    click_button(harness, "Export");
    let is_offered = !harness.get_by_role_and_label(Role::Button, name).accesskit_node().is_disabled();
    press(harness, Key::Escape);
    is_offered
}

const STEPS: &str = "Frame pass by pass (animated PNG)…";
const ROUND: &str = "Light going round (animated PNG)…";

#[test]
fn the_menu_asks_for_a_place_and_then_for_the_file() {
    for (name, kind, file) in [
        (STEPS, ExportKind::Steps, "by-hand-z-fail-passes.png"),
        (ROUND, ExportKind::LightRound, "by-hand-z-fail-light-1-round.png"),
    ] {
        let mut harness = harness(z_fail(SIZE));
        click_button(&mut harness, "Export");
        click_button(&mut harness, name);
        click_button(&mut harness, "Save");
        let wish = Action::Export { kind, path: file.to_owned(), replace: false };
        assert_eq!(harness.state().actions.last(), Some(&wish));
    }
}

#[test]
fn the_film_is_of_the_frame_that_is_shown_and_of_the_scene_as_it_is_run() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "shadow-map");
    let inspector = &mut harness.state_mut().inspector;
    let capture = inspector.model.frame.capture.as_ref().cloned().expect("a frame");
    let Some(ExportData::Film(FilmSubject::Steps(shown))) = inspector.export(ExportKind::Steps) else {
        panic!("steps")
    };
    let [shown] = &shown[..] else { panic!("one frame") };
    assert_eq!(shown.technique, "z-fail", "the next frame is not there yet");
    assert!(Arc::ptr_eq(shown, &capture));
    let draft = inspector.draft();
    let Some(ExportData::Film(FilmSubject::LightRound { sides, light: 0 })) = inspector.export(ExportKind::LightRound)
    else {
        panic!("a light")
    };
    assert_eq!(Some(sides), draft.map(|draft| vec![*draft]));
}

#[test]
fn progress_stands_in_the_status_bar_and_the_rest_of_the_window_goes_on() {
    let mut harness = started();
    harness.get_by_label("animation begins");
    let asked = last_asked::<FilmOf>(&harness);
    asked.progress.start(4);
    asked.progress.advance();
    harness.run_steps(2);
    harness.get_by_label("animation: 1 of 4 pictures");
    assert_eq!([is_offered(&mut harness, STEPS), is_offered(&mut harness, ROUND)], [false; 2], "one at a time");
    click_button(&mut harness, "z-pass");
    assert!(matches!(harness.state().actions.last(), Some(Action::Run(_))));
    assert!(!asked.progress.is_cancelled(), "another picture does not stop it");
    reply::<FilmOf>(&mut harness, Ok(Filmed { pictures: 4, bytes: 91_400 }));
    harness.get_by_label("wrote a.png (4 pictures, 91.4 kB)");
    assert!(harness.query_by_label("animation: 1 of 4 pictures").is_none());
    assert!(is_offered(&mut harness, STEPS));
    assert_eq!(asks::<FilmOf>(&harness).len(), 1);
}

#[test]
fn it_is_cancelled_where_it_says_how_far_it_is() {
    let mut harness = started();
    click_button(&mut harness, "Cancel");
    assert!(last_asked::<FilmOf>(&harness).progress.is_cancelled());
    assert!(harness.query_by_label("animation begins").is_none());
    assert!(is_offered(&mut harness, STEPS) && harness.state().inspector.model.activity.messages.is_empty());
}

#[test]
fn one_that_fails_says_why() {
    let mut harness = started();
    reply::<FilmOf>(&mut harness, Err("a.png: can't be written (no room): choose another file".to_owned()));
    harness.get_by_label("a.png: can't be written (no room): choose another file");
    assert!(is_offered(&mut harness, STEPS));
}

#[test]
fn without_a_scene_no_light_goes_round_and_the_menu_says_why() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.open_folder(None);
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    assert!(inspector.export(ExportKind::LightRound).is_none());
    let mut harness = harness_of(inspector);
    assert_eq!([is_offered(&mut harness, STEPS), is_offered(&mut harness, ROUND)], [true, false]);
    click_button(&mut harness, "Export");
    harness.get_by_role_and_label(Role::Button, ROUND).hover();
    harness.run_steps(40);
    harness.get_by_label("There is no scene with a light that could go round: open one");
}
