//! Before, after and what changed; comparing two steps or techniques; bits and histograms.

use super::by_hand::with_draws;
use super::*;
use stencilscope::ask::{CaptureOf, ChannelOf, DrawsOf};
use stencilscope::plan::LightChannel;

fn at_volumes() -> Harness<'static, Seen> {
    let mut harness = harness(z_fail(SIZE));
    harness.state_mut().inspector.model.select_step(1);
    change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Stencil));
    harness
}

fn first_byte(harness: &Harness<Seen>) -> Option<u8> {
    harness.state().inspector.shown_images().first()?.byte_at([0, 0])
}

#[test]
fn before_shows_what_the_step_found_and_b_goes_back() {
    let mut harness = at_volumes();
    assert_eq!(first_byte(&harness), Some(255));
    click_button(&mut harness, "Before");
    assert_eq!(first_byte(&harness), Some(0));
    harness.get_by_label_contains("stencil before step 2 · 40×30");
    press(&mut harness, Key::B);
    assert_eq!(first_byte(&harness), Some(255));
    harness.get_by_label_contains("stencil after step 2 · 40×30");
    press(&mut harness, Key::B);
    assert_eq!(first_byte(&harness), Some(0));
}

#[test]
fn nothing_comes_before_the_first_step_and_it_is_said() {
    let mut harness = at_volumes();
    press(&mut harness, Key::B);
    press(&mut harness, Key::Home);
    assert!(harness.state().inspector.shown_images().is_empty());
    harness.get_by_label_contains("Nothing comes before the first step");
    press(&mut harness, Key::ArrowRight);
    assert_eq!(first_byte(&harness), Some(0));
}

/// 599 pixels were raised by one and one lowered by one; 600 stayed.
#[test]
fn the_diff_of_counts_is_signed_and_counted() {
    let mut harness = at_volumes();
    press(&mut harness, Key::D);
    harness.get_by_label("600 pixels changed");
    for label in ["+1", "599", "−1", "1", "unchanged", "600"] {
        harness.get_by_label(label);
    }
    press(&mut harness, Key::D);
    assert!(!says(&harness, "pixels changed"));
}

/// The light adds where the count is 0: 20 columns. It does not touch depth.
#[test]
fn the_diff_of_colours_and_depths_reports_how_many_changed() {
    let mut harness = harness(z_fail(SIZE));
    press(&mut harness, Key::D);
    harness.get_by_label("600 pixels changed");
    harness.get_by_label("in their new colour");
    click_button(&mut harness, "Depth");
    harness.get_by_label("0 pixels changed");
}

#[test]
fn before_a_draw_is_after_the_one_before_it() {
    let mut harness = harness(with_draws(z_fail(SIZE)));
    harness.state_mut().inspector.model.choose_picture(PictureKind::Stencil);
    harness.state_mut().inspector.select_draw(1, 1);
    press(&mut harness, Key::D);
    // The sides counted in the upper half, the cap in the lower.
    harness.get_by_label("300 pixels changed");
    press(&mut harness, Key::B);
    harness.get_by_label_contains("stencil before draw 2 of step 2");
}

#[test]
fn a_draw_before_that_is_not_known_is_asked_for() {
    let mut harness = harness(z_fail(SIZE));
    harness.state_mut().inspector.model.choose_picture(PictureKind::Stencil);
    change(&mut harness, |inspector| inspector.select_draw(1, 1));
    assert!(!asks::<DrawsOf>(&harness).contains(&DrawsOf { step: 1 }), "the last draw is the step");
    press(&mut harness, Key::B);
    assert!(asks::<DrawsOf>(&harness).contains(&DrawsOf { step: 1 }));
    harness.get_by_label_contains("not known yet");
}

#[test]
fn pictures_without_a_before_have_no_use_of_such_buttons() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Mask");
    assert!(is_disabled(&harness, "Before"), "it keeps its place");
    press(&mut harness, Key::B);
    harness.get_by_label_contains("mask of light 1");
}

#[test]
fn two_steps_are_compared_under_a_divider_that_keys_and_mouse_move() {
    let mut harness = at_volumes();
    click_button(&mut harness, "Compare");
    harness.get_by_label_contains("600 pixels differ: 50.0 %");
    let x = |harness: &Harness<Seen>| harness.get_by_role_and_label(Role::Slider, "Compare divider").rect().center().x;
    let canvas = harness.get_by_label("Picture canvas").rect();
    assert!((x(&harness) - canvas.center().x).abs() < 1.0);
    focus_role(&mut harness, Role::Slider, "Compare divider");
    press(&mut harness, Key::ArrowRight);
    assert!((x(&harness) - canvas.center().x - canvas.width() * 0.02).abs() < 1.0, "{}", x(&harness));
    assert_eq!(harness.state().inspector.model.selection.step, 1, "the divider keeps its keys");
    let from = harness.get_by_role_and_label(Role::Slider, "Compare divider").rect().center();
    let to = from + vec2(-200.0, 0.0);
    drag(&mut harness, from, to - from, PointerButton::Primary);
    assert!((x(&harness) - to.x).abs() < 2.0, "{} is not {}", x(&harness), to.x);
}

#[test]
fn flipping_swaps_the_sides_and_off_is_off() {
    let mut harness = at_volumes();
    click_button(&mut harness, "Compare");
    let divided = window_picture(&mut harness);
    press(&mut harness, Key::X);
    let flipped = window_picture(&mut harness);
    assert_ne!(divided, flipped);
    choose(&mut harness, "Layout of the comparison", "Flip the sides");
    assert!(!harness.state().inspector.model.modes.compare.expect("a comparison").flipped, "back again");
    assert_eq!(harness.query_all_by_label("Compare divider").count(), 1);
    click_button(&mut harness, "Compare");
    assert!(harness.query_by_label("Compare divider").is_none());
}

fn asked(harness: &Harness<Seen>) -> Vec<RunRequest> {
    asks::<CaptureOf>(harness).into_iter().map(|ask| *ask.request).collect()
}

#[test]
fn another_technique_is_asked_for_once_and_shown_at_the_pass_of_the_same_name() {
    let mut harness = at_volumes();
    click_button(&mut harness, "Compare");
    choose(&mut harness, "Compare with", "technique z-pass");
    let requests = asked(&harness);
    assert_eq!(requests.len(), 1);
    assert_eq!(requests[0].choice.technique(), Technique::ZPass);
    harness.get_by_label_contains("Capturing z-pass");
    let mut other = z_fail(SIZE);
    other.technique = "z-pass".to_owned();
    reply::<CaptureOf>(&mut harness, Ok(other.clone()));
    harness.run_steps(3);
    harness.get_by_label_contains("No pixel differs");
    // The step of the frame that is shown has another name: the other's last step is shown.
    change(&mut harness, |inspector| inspector.model.select_step(3));
    harness.get_by_label_contains("No pixel differs");
    // What comes after may differ.
    change(&mut harness, |inspector| inspector.model.select_step(1));
    harness.get_by_label_contains("No pixel differs after this step.");
    assert_eq!(asked(&harness).len(), 1);
}

#[test]
fn a_technique_that_failed_says_why_and_one_without_such_a_picture_too() {
    let mut harness = at_volumes();
    click_button(&mut harness, "Compare");
    choose(&mut harness, "Compare with", "technique shadow-map");
    reply::<CaptureOf>(&mut harness, Err("no room: make it smaller".to_owned()));
    harness.run_steps(2);
    harness.get_by_label_contains("shadow-map can't be shown: no room: make it smaller");
    let mut again = harness;
    choose(&mut again, "Compare with", "technique projective");
    let mut other = cube_map();
    for step in &mut other.steps {
        if let stencilscope::capture::Snapshot::Frame(frame) = &mut step.snapshot {
            frame.stencil = None;
        }
    }
    reply::<CaptureOf>(&mut again, Ok(other));
    again.run_steps(2);
    again.get_by_label_contains("Pictures of different kinds: nothing to count.");
    choose(&mut again, "Layout of the comparison", "Beside");
    again.get_by_label_contains("(no stencil: its colour)");
}

#[test]
fn a_bit_is_a_plane_of_two_inks_with_their_counts() {
    let mut harness = at_volumes();
    choose(&mut harness, "Bits of the stencil", "Bit 1");
    // Only the pixel of 255 has bit 1.
    for label in ["Bit 1 of the stencil", "1 set", "1", "0 not set", "1\u{a0}199"] {
        harness.get_by_label(label);
    }
}

#[test]
fn the_depth_legend_has_a_histogram_that_reports_its_bars() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Depth");
    let bars = harness.get_by_role(Role::Image);
    let name = bars.accesskit_node().label().unwrap_or_default();
    // 39 columns of 30 over 48 bars.
    assert_eq!(name, "Histogram of depths, 30 pixels at most");
}

#[test]
fn a_channel_of_the_light_is_asked_for_and_shown_alone() {
    let mut harness = harness(z_fail(SIZE));
    choose(&mut harness, "Light in the picture", "specular");
    assert_eq!(asks::<ChannelOf>(&harness), [ChannelOf { channel: LightChannel::Specular }]);
    harness.get_by_label("Capturing specular light …");
    let whole = harness.state().inspector.shown_images();
    let mut alone = z_fail(SIZE);
    let last = alone.steps.len() - 1;
    if let stencilscope::capture::Snapshot::Frame(frame) = &mut alone.steps[last].snapshot {
        frame.color.image = Arc::new(Image::uniform(PixelFormat::Rgba8Srgb, SIZE, &[9, 8, 7, 255]));
    }
    reply::<ChannelOf>(&mut harness, Ok(alone));
    harness.get_by_label_contains("specular light of the colour");
    let shown = harness.state().inspector.shown_images();
    assert_eq!(shown[0].rgba_at([1, 1]), Some([9, 8, 7, 255]));
    assert_ne!(shown, whole);
    assert!(harness.query_by_label("Capturing specular light …").is_none());
    // What is compared, or changed, is the whole.
    click_button(&mut harness, "Compare");
    assert_eq!(harness.state().inspector.shown_images(), whole);
    click_button(&mut harness, "Compare");
    choose(&mut harness, "Light in the picture", "all light");
    assert_eq!(harness.state().inspector.shown_images(), whole);
}
