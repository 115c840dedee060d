//! Truth and error: asked for where they are not there, counted and found where they are.

use super::by_hand::with_truth;
use super::contrast;
use super::*;
use stencilscope::capture::CapturedTruth;

fn asked(harness: &Harness<Seen>) -> usize {
    asks::<TruthOf>(harness).len()
}

fn kind(harness: &Harness<Seen>) -> Option<PictureKind> {
    harness.state().inspector.picture_kind()
}

#[test]
fn error_without_truth_asks_for_it_once_and_the_last_picture_stays() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Stencil");
    assert_eq!(asked(&harness), 0);
    click_button(&mut harness, "Error");
    harness.run_steps(4);
    assert_eq!((asked(&harness), kind(&harness)), (1, Some(PictureKind::Stencil)));
    let progress = last_asked::<TruthOf>(&harness).progress;
    progress.start(100);
    (0..43).for_each(|_| progress.advance());
    harness.run_steps(2);
    harness.get_by_label("The truth is being traced … 43 %");
    harness.get_by_label("Shown until then: stencil after step 3.");
    change(&mut harness, |inspector| inspector.model.update_capture(Arc::new(with_truth(z_fail(SIZE)))));
    assert_eq!((asked(&harness), kind(&harness)), (1, Some(PictureKind::Error)));
    assert!(harness.query_by_label_contains("being traced").is_none());
}

#[test]
fn with_truth_nothing_is_asked_for() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    for (name, expected) in [("Truth", PictureKind::Truth), ("Error", PictureKind::Error)] {
        click_button(&mut harness, name);
        assert_eq!((asked(&harness), kind(&harness)), (0, Some(expected)));
    }
}

#[test]
fn a_new_frame_asks_again_and_the_error_of_the_frame_before_stays_until_then() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!(asked(&harness), 0, "only while truth or error is shown");
    show_capture(&mut harness, with_truth(z_fail(SIZE)));
    click_button(&mut harness, "Error");
    for frame in 1..=3 {
        show_capture(&mut harness, z_fail(SIZE));
        assert_eq!((asked(&harness), kind(&harness)), (frame, Some(PictureKind::Error)));
        harness.get_by_label("Shown is that of the frame before.");
    }
    show_capture(&mut harness, z_fail([20, 10]));
    assert_eq!(kind(&harness), Some(PictureKind::Color), "of another size");
    click_button(&mut harness, "Mask");
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!((asked(&harness), kind(&harness)), (4, Some(PictureKind::Mask)));
}

#[test]
fn tracing_is_cancelled_and_asked_for_again() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    click_button(&mut harness, "Error");
    show_capture(&mut harness, z_fail(SIZE));
    click_button(&mut harness, "Cancel");
    assert!(last_asked::<TruthOf>(&harness).progress.is_cancelled());
    harness.get_by_label("The truth was not traced.");
    assert_eq!(kind(&harness), Some(PictureKind::Color), "an error that is not this frame's is not left standing");
    harness.run_steps(3);
    assert_eq!(asked(&harness), 1);
    click_button(&mut harness, "Trace it");
    assert_eq!(asked(&harness), 2);
    reply::<TruthOf>(&mut harness, Err("no GPU".to_owned()));
    harness.get_by_label("× There is no truth: no GPU");
    click_button(&mut harness, "Error");
    assert_eq!(asked(&harness), 3, "choosing it again tries again");
}

#[test]
fn a_folder_without_truth_says_so_and_one_with_truth_shows_it() {
    let mut harness = of_folder();
    click_button(&mut harness, "Truth");
    harness.get_by_label("This folder has no truth: capture it with --truth.");
    assert_eq!((asked(&harness), kind(&harness)), (0, Some(PictureKind::Color)));
    show_capture(&mut harness, with_truth(z_fail(SIZE)));
    assert_eq!(kind(&harness), Some(PictureKind::Truth));
    harness.get_by_label_contains("truth of light 1");
}

#[test]
fn the_legend_begins_with_a_sentence_and_counts_findings() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    click_button(&mut harness, "Error");
    harness.get_by_label("Error, light 1");
    harness.get_by_label("3.5\u{a0}% wrong");
    click_button(&mut harness, "Counts");
    harness.get_by_label(
        "41 of 1\u{a0}170 pixels are wrong: 40 false shadow, 1 missing; the largest patch has 40 at 18, 0.",
    );
    for text in ["0 agrees", "1\u{a0}109", "1 false shadow", "40", "2 missing shadow", "3 wrong surface", "0"] {
        harness.get_by_label(text);
    }
    for text in ["4 edge, excused", "20", "5 not compared", "30"] {
        harness.get_by_label(text);
    }
    click_button(&mut harness, "Truth");
    harness.get_by_label("Truth, light 1");
    // Of 600 in the technique's shadow 60 are lit in truth; one more is not.
    harness.get_by_label("541");
    harness.get_by_label("629");
}

#[test]
fn where_nothing_is_wrong_there_is_nowhere_to_go() {
    let mut capture = with_truth(z_fail(SIZE));
    let truth = capture.lights[0].truth.as_mut().expect("a truth");
    truth.error = stencilscope::accuracy::ErrorCounts { compared: 1170, edge_band: 12, ..Default::default() };
    truth.worst = None;
    let mut harness = harness(capture);
    click_button(&mut harness, "Error");
    harness.get_by_label("none wrong");
    click_button(&mut harness, "Counts");
    harness.get_by_label("No pixel of 1\u{a0}170 is wrong; 12 at edges are excused.");
    assert!(harness.query_by_label("Go to the largest").is_none());
}

#[test]
fn mouse_and_keys_go_to_the_largest_patch() {
    for by_key in [false, true] {
        let mut harness = harness(with_truth(z_fail(SIZE)));
        click_button(&mut harness, "Error");
        if by_key {
            focus_role(&mut harness, Role::Button, "Go to the largest");
            press(&mut harness, Key::Enter);
        } else {
            click_button(&mut harness, "Go to the largest");
        }
        assert_eq!(harness.state().inspector.model.selection.pick, Some([18, 0]));
        assert_eq!(harness.state().inspector.model.view.zoom, TexelZoom::Pixels(12.0));
    }
}

#[test]
fn the_read_out_says_technique_truth_and_what_follows() {
    for (at, sentence, shadow, lit) in [
        ([18, 3], "False shadow: dark here, but the light reaches it.", 1, 1),
        ([30, 10], "Missing shadow: lit here, but something lies between.", 1, 1),
        ([19, 25], "They differ, but the truth changes within this pixel: excused.", 1, 1),
        ([3, 3], "Truth and technique agree.", 2, 0),
    ] {
        let harness = picked(with_truth(z_fail(SIZE)), at);
        harness.get_by_label(sentence);
        harness.get_by_role_and_label(Role::Label, "truth");
        assert_eq!(harness.query_all_by_label("shadow").count(), shadow);
        assert_eq!(harness.query_all_by_label("lit").count(), lit);
    }
}

#[test]
fn several_lights_are_judged_one_by_one() {
    let mut capture = with_truth(z_fail(SIZE));
    let mut second = capture.lights[0].clone();
    let truth: &mut CapturedTruth = second.truth.as_mut().expect("a truth");
    truth.error = stencilscope::accuracy::ErrorCounts { compared: 7, ..Default::default() };
    truth.worst = None;
    capture.lights.push(second);
    let mut harness = harness(capture);
    click_button(&mut harness, "Error");
    harness.get_by_label("Error, light 1");
    click_button(&mut harness, "Counts");
    choose(&mut harness, "Light of the picture", "light 2");
    harness.get_by_label("Error, light 2");
    // The counts stay.
    harness.get_by_label("No pixel of 7 is wrong.");
}

/// In a window of a thousand points a technique's long name leaves the truth no space beside it.
#[test]
fn the_truth_of_a_light_stays_in_its_panel() {
    let mut capture = Capture { technique: "planar-texture".to_owned(), ..with_truth(z_fail(SIZE)) };
    capture.lights[0].visibility = None;
    for size in [[1000.0, 700.0], [1280.0, 800.0]] {
        let mut inspector = inspector(capture.clone());
        inspector.model.selection.pick = Some([3, 4]);
        let mut harness = harness_in(inspector, size);
        harness.run_steps(3);
        let panel = harness.get_by_role_and_label(Role::TabPanel, "Pixel").rect();
        let words = contrast::words(&harness);
        let row = words.iter().filter(|word| ["truth", "shadow", "lit"].contains(&word.text.trim()));
        let row: Vec<_> = row.filter(|word| panel.contains(word.place.left_center())).collect();
        assert!(row.iter().any(|word| word.text.trim() == "truth"), "{size:?}");
        assert!(row.iter().all(|word| word.place.right() <= panel.right()), "{size:?}: {panel:?}");
    }
}
