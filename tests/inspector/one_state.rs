//! What stands side by side is of one moment: sentences, values, findings, and what undo goes back to.

use super::diagnosis::{found, with_regions};
use super::explain::over;
use super::*;
use glam::DVec3;
use stencilscope::ask::DiagnosisOf;
use stencilscope::reading::pick_ray;
use stencilscope::reading::ray_crossings::RayCrossings;

/// The first pixel whose label under the first light is this one.
fn pixel_with(capture: &Capture, label: u8) -> [u32; 2] {
    let mask = capture.lights[0].shadow.as_ref().expect("a mask");
    let rows = mask.rows().enumerate();
    let found = rows.filter_map(|(y, row)| Some([row.iter().position(|byte| *byte == label)? as u32, y as u32]));
    found.into_iter().next().expect("such a pixel")
}

#[test]
fn the_sentence_on_top_says_of_which_moment_it_speaks() {
    let mut inspector = over("tori", Technique::ZFail);
    let capture = inspector.model.frame.capture.clone().expect("a capture");
    inspector.model.selection.pick = Some(pixel_with(&capture, 0));
    let mut harness = harness_of(inspector);
    let was = "Lit by light 1: its stencil count was 0 when the light pass tested it; the pass then made it 1.";
    harness.get_by_label(was);
    change(&mut harness, |inspector| inspector.model.select_step(1));
    harness.get_by_label("Lit by light 1: its stencil count is 0.");
    change(&mut harness, |inspector| inspector.model.selection.pick = Some(pixel_with(&capture, 1)));
    assert!(says(&harness, "Dark under light 1: its stencil count is "));
    change(&mut harness, |inspector| inspector.model.select_step(0));
    assert!(says(&harness, "once the light pass tests it"));
}

#[test]
fn the_sentence_is_of_the_picked_pixel_in_the_frame_that_it_changes_to() {
    let mut harness = picked(z_fail(SIZE), [3, 4]);
    harness.get_by_label("Dark under light 1: its stencil count is 1.");
    harness.state_mut().inspector.model.selection.pick = Some([30, 4]);
    harness.run_steps(2);
    harness.get_by_label(
        "Lit by light 1: its stencil count was 0 when the light pass tested it; the pass then made it 1.",
    );
}

#[test]
fn a_diagnosis_of_a_scene_that_was_changed_since_says_so_and_fixes_nothing() {
    let mut harness = with_regions();
    assert!(!says(&harness, "The scene was changed since"));
    let fix = "Apply the fix: use z-fail";
    assert!(!is_disabled(&harness, fix));
    let mut draft = *harness.state().inspector.draft().expect("a scene");
    draft.lights[0].position.x += 1.0;
    change(&mut harness, |inspector| drop(inspector.rerun(draft)));
    assert!(says(&harness, "The scene was changed since"));
    assert!(is_disabled(&harness, fix));
    click_button(&mut harness, "Diagnose again");
    reply::<DiagnosisOf>(&mut harness, Ok(found()));
    assert!(!says(&harness, "The scene was changed since") && !is_disabled(&harness, fix));
}

#[test]
fn a_diagnosis_that_comes_after_a_further_edit_is_of_the_scene_before_it() {
    let mut harness = with_regions();
    let before = *harness.state().inspector.draft().expect("a scene");
    click_button(&mut harness, "Diagnose again");
    let mut after = before.clone();
    after.lights[0].position.x += 1.0;
    change(&mut harness, |inspector| drop(inspector.rerun(after)));
    reply::<DiagnosisOf>(&mut harness, Ok(found()));
    assert!(says(&harness, "The scene was changed since"));
    assert!(is_disabled(&harness, "Apply the fix: use z-fail"));
    change(&mut harness, |inspector| drop(inspector.rerun(before)));
    assert!(!says(&harness, "The scene was changed since"), "it is of the scene as it is again");
}

/// Types a text into a field for a number, in place of what is there.
fn set_text(harness: &mut Harness<Seen>, field: &str, text: &str) {
    let at = harness.get_by_role_and_label(Role::SpinButton, field).rect();
    mouse(harness, at.center(), PointerButton::Primary);
    press_with(harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text(text.to_owned()));
    harness.run_steps(1);
    press(harness, Key::Enter);
}

#[test]
fn a_number_without_end_or_without_measure_is_refused_and_the_last_one_stays() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    show_tab(&mut harness, "Scene settings");
    let before = harness.state().inspector.draft();
    let place = "light 1 position x";
    for (field, text, why) in [
        (place, "1e400", "1e400 is not from −1e7 to 1e7: "),
        (place, "1e38", "1e38 is not from −1e7 to 1e7: "),
        (place, "-1e400", "-1e400 is not from −1e7 to 1e7: "),
        (place, "left", "\"left\" is no number: "),
        ("Field of view", "1e38", "1e38 is not from 1 to 179: "),
        ("light 1 intensity", "-1", "-1 is not from 0 to 1000: "),
        ("extrusion finite", "1e400", "1e400 is not from "),
    ] {
        if field.starts_with("extrusion") {
            choose(&mut harness, "extrusion", "finite");
        }
        let draft = harness.state().inspector.draft();
        set_text(&mut harness, field, text);
        let at = harness.get_by_role_and_label(Role::SpinButton, field).rect();
        assert_eq!(harness.state().inspector.draft(), draft, "{field}: {text}");
        let said = harness.get_by_label_contains(why).rect();
        assert!((said.center() - at.center()).length() < 200.0, "{field}: it is said beside the field, not at {said}");
    }
    assert_eq!(runs(&harness).len(), 1, "the extrusion was chosen");
    change(&mut harness, |inspector| drop(inspector.rerun(*before.expect("a scene"))));
    set_text(&mut harness, "light 1 position y", "up");
    assert!(says(&harness, " stays"));
    let beside = harness.get_by_label("Picture canvas").rect().center();
    mouse(&mut harness, beside, PointerButton::Middle);
    assert!(!says(&harness, " stays"), "it is not said to one who is elsewhere");
    set_text(&mut harness, "light 1 position y", "up");
    // A frame of the harness is a quarter of a second.
    harness.run_steps(36);
    assert!(!says(&harness, " stays"), "it is not said forever");
}

#[test]
fn undo_takes_a_refused_change_back_before_another_and_says_what_it_takes_back() {
    let mut harness = harness(z_fail(SIZE));
    show_tab(&mut harness, "Scene settings");
    set_value(&mut harness, "light 1 position x", 2.5);
    // Where the target is: it can't be run.
    set_value(&mut harness, "camera eye y", 0.0);
    harness.get_by_label_contains("the camera's eye equals its target");
    let says_undo = |harness: &mut Harness<Seen>, words: &str| {
        let at = harness.get_by_role_and_label(Role::Button, "Undo").rect().center();
        harness.hover_at(at);
        harness.run_steps(4);
        says(harness, words)
    };
    assert!(says_undo(&mut harness, "Undo what can't be run"));
    press_with(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(last_run(&harness).lights[0].position.x, 2.5, "the last good change stays");
    assert!(!says(&harness, "the camera's eye equals its target"));
    assert!(says_undo(&mut harness, "Undo light 1"));
    press_with(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_ne!(last_run(&harness).lights[0].position.x, 2.5);
}

#[test]
fn an_exported_page_opens_at_what_is_shown() {
    let mut harness = picked(z_fail(SIZE), [3, 4]);
    change(&mut harness, |inspector| {
        inspector.model.select_step(1);
        inspector.model.choose_picture(PictureKind::Stencil);
    });
    let data = harness.state_mut().inspector.export(ExportKind::Page);
    let Some(ExportData::Page { look, .. }) = data else { panic!("a page") };
    assert_eq!(look, "step=2&view=stencil&pixel=3,4");
    // Of a scene that moves, its title has the moment.
    change(&mut harness, |inspector| inspector.model.frame.time = Some(1.5));
    let data = harness.state_mut().inspector.export(ExportKind::Page);
    let Some(ExportData::Page { look, .. }) = data else { panic!("a page") };
    assert_eq!(look, "step=2&view=stencil&pixel=3,4&time=1.50");
}

#[test]
fn the_first_words_say_whose_shadow_a_pixel_lies_in() {
    let mut session = common::session();
    for (scene, technique) in [("tori", Technique::ZFail), ("tori", Technique::ZPass), ("rings", Technique::Planar)] {
        let frame = common::frame(&mut session, scene, common::request(technique, [160, 120]));
        let pick = pixel_with(&frame.capture, 1);
        let history = session.history(&frame.plan, &frame.capture, pick).expect("a history");
        let mut inspector = pictures::inspector(&frame, pick);
        inspector.take_in(HistoryOf { at: pick }, Ok(Arc::new(history)));
        let harness = harness_of(inspector);
        let casters = frame.scene().expect("a scene").objects.iter().filter(|object| object.casts);
        let names: Vec<String> = casters.map(|object| object.name.clone()).collect();
        let told = harness.get_by_label_contains("In the shadow of ").value().expect("words");
        assert!(names.iter().any(|name| told.contains(name)), "{scene}, {}: {told}", technique.name());
    }
}

/// While a light is dragged, a preview is shown: it says so, the pick stays, and nothing is asked about its pixels.
#[test]
fn a_preview_says_so_and_is_asked_nothing_about_its_pixels() {
    let mut harness = picked(z_fail(SIZE), [3, 4]);
    let before = asks::<HistoryOf>(&harness).len();
    assert!(before > 0);
    let small = z_fail([SIZE[0] / 2, SIZE[1] / 2]);
    change(&mut harness, |inspector| inspector.set_preview(Arc::new(small.enlarged(SIZE))));
    assert_eq!(asks::<HistoryOf>(&harness).len(), before);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([3, 4]));
    harness.get_by_label_contains("preview of ");
    harness.get_by_label_contains("in the preview");
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!(asks::<HistoryOf>(&harness).len(), before + 1);
    assert!(!says(&harness, "preview: "));
}

/// What is let go is run whole at once; nothing is asked for while it is dragged, nor where a whole picture is shown.
#[test]
fn a_preview_is_completed_when_the_button_is_let_go() {
    let mut harness = picked(z_fail(SIZE), [3, 4]);
    let completed = |harness: &Harness<Seen>| {
        harness.state().actions.iter().filter(|action| **action == Action::CompletePreview).count()
    };
    let status = |harness: &Harness<Seen>| harness.ctx.content_rect().left_bottom() + vec2(8.0, -4.0);
    let at = status(&harness);
    mouse(&mut harness, at, PointerButton::Primary);
    assert_eq!(completed(&harness), 0);
    let small = z_fail([SIZE[0] / 2, SIZE[1] / 2]);
    press_left(&mut harness, at);
    change(&mut harness, |inspector| inspector.set_preview(Arc::new(small.enlarged(SIZE))));
    assert_eq!(completed(&harness), 0);
    harness.event(button_event(at, PointerButton::Primary, false));
    harness.run_steps(3);
    assert_eq!(completed(&harness), 1);
}

/// What z-fail counts lies behind the surface: there are the marks of the faces that count, on the pick's view ray.
#[test]
fn scene_marks_what_the_view_ray_counts() {
    let mut session = common::session();
    for (technique, is_behind) in [(Technique::ZFail, true), (Technique::ZPass, false)] {
        let frame = common::frame(&mut session, "tori", common::request(technique, [160, 120]));
        let capture = &frame.capture;
        let pick = pixel_with(capture, 1);
        let history = session.history(&frame.plan, capture, pick).expect("a history");
        let ladder = history.ladder(0, &capture.depth).expect("a ladder");
        let crossings = RayCrossings::of(&ladder, capture, pick, 2.0);
        let surface = pick_ray::surface(capture, pick).expect("a surface");
        let away = |place: DVec3| place.distance(capture.camera.eye);
        assert_eq!(crossings.end.is_some(), is_behind, "{technique:?}");
        assert_eq!(crossings.faces.iter().map(|face| face.added).sum::<i32>(), ladder.count - ladder.start);
        assert!(!crossings.faces.is_empty());
        for face in &crossings.faces {
            let texel = pick_ray::texel_of(capture, face.place.extend(1.0)).expect("before the eye");
            let off = [0, 1].map(|axis| (texel[axis] - f64::from(pick[axis]) - 0.5).abs());
            assert!(off[0].max(off[1]) < 1e-6, "{technique:?}: {face:?} is not on the ray, {off:?}");
            assert_eq!(away(face.place) > away(surface), is_behind, "{technique:?}: {face:?}");
        }
        let at_infinity: Vec<_> = crossings.faces.iter().filter(|face| face.is_at_infinity).collect();
        assert_eq!(at_infinity.len(), usize::from(is_behind), "{technique:?}");
        assert_eq!(at_infinity.first().map(|face| face.place), crossings.end);
    }
}
