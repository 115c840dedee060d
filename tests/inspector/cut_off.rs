//! No words are cut off at a panel's edge, and what belongs together stands together.

use super::explain::over;
use super::history::{DARK, answer};
use super::history_by_hand::{FACES, history};
use super::*;
use stencilscope::ask::CaptureOf;
use stencilscope::plan::CountOf;

#[test]
fn what_a_ladder_counts_is_read_to_its_end() {
    let mut capture = z_fail(SIZE);
    capture.lights[0].count_of = Some(CountOf::Mixed);
    let mut harness = picked(capture, DARK);
    answer(&mut harness, history(DARK, &FACES));
    for words in ["of light 1, counting", "Counted from"] {
        let right = harness.query_all_by_label_contains(words).map(|label| label.rect().right()).fold(0.0, f32::max);
        assert!(right > 0.0 && right <= 1280.0, "{words}: {right}");
    }
}

#[test]
fn what_a_pass_draws_into_stands_line_under_line() {
    let mut harness = harness_in(over("tori", Technique::ZFail), [1440.0, 900.0]);
    show_tab(&mut harness, "State");
    let top = |label: &str| harness.get_by_label(label).rect().top();
    let by = top("colour") - top("seen from");
    assert!((12.0..=22.0).contains(&by), "{by}");
}

#[test]
fn a_reason_stands_once_under_all_that_was_left_out_for_it() {
    let inspector = over("tori", Technique::Auto);
    let left = inspector.model.frame.capture.as_ref().expect("a capture").left_out.clone();
    let of_first = left.iter().filter(|one| one.because == left[0].because).count();
    assert!(of_first > 1, "one reason for several rings");
    let mut harness = harness_in(inspector, [1600.0, 3000.0]);
    harness.run_steps(2);
    let before = harness.query_all_by_label(&left[0].because).count();
    show_tab(&mut harness, "Explain");
    assert_eq!(harness.query_all_by_label(&left[0].because).count(), before + 1);
}

#[test]
fn what_a_button_does_is_reported_beside_it_and_not_below_it() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), [1024.0, 800.0]);
    for (tab, button, words) in
        [("Report", "Measure", "Measures every technique"), ("Diagnosis", "Diagnose", "Follows rays through the scene")]
    {
        show_tab(&mut harness, tab);
        let button = harness.get_by_role_and_label(Role::Button, button).rect();
        let words = harness.get_by_label_contains(words).rect();
        assert!(words.height() > 20.0, "it takes two lines here");
        assert!(words.left() >= button.right(), "{tab}: {words:?} beside {button:?}");
    }
}

#[test]
fn a_picture_of_the_whole_frame_is_compared_with_another_technique_first() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Mask");
    click_button(&mut harness, "Compare");
    harness.run_steps(2);
    let asked = asks::<CaptureOf>(&harness);
    assert_eq!(asked.len(), 1);
    assert_eq!(asked[0].request.choice.technique(), Technique::ShadowMap);
}

/// What led to the answer comes before numbers, which picture and status bar say as well: of one order in every window.
#[test]
fn the_ladder_is_in_view_and_the_values_are_below_it() {
    for size in [[1000.0, 700.0], [1280.0, 800.0], [1440.0, 900.0], [1920.0, 1080.0]] {
        let mut inspector = inspector(z_fail(SIZE));
        inspector.model.selection.pick = Some(DARK);
        let mut harness = harness_in(inspector, size);
        answer(&mut harness, history(DARK, &FACES));
        harness.run_steps(4);
        let ladder = harness.get_by_label_contains("Ladder of the view ray").rect();
        assert!(ladder.bottom() < size[1] - 24.0, "{size:?}: {ladder}");
        let values = harness.get_by_label_contains("After step").rect();
        assert!(values.top() > ladder.bottom(), "{size:?}: {values}");
        assert!(size[1] < 1000.0 || values.bottom() < size[1] - 24.0, "where there is space both are seen: {values}");
    }
}
