//! The picture *Auto*: it shows what each step writes, and masks are no steps of the frame.

use super::*;

fn kind(harness: &Harness<Seen>) -> PictureKind {
    harness.state().inspector.picture_kind().expect("a picture")
}

/// What *Auto* shows of every step of the frame, from the first on.
fn shown_at_steps(harness: &mut Harness<Seen>, steps: usize) -> Vec<(usize, PictureKind)> {
    press(harness, Key::Home);
    let mut shown = Vec::new();
    for _ in 0..steps {
        shown.push((harness.state().inspector.model.selection.step, kind(harness)));
        press(harness, Key::ArrowRight);
    }
    shown
}

#[test]
fn each_step_shows_what_it_writes_and_a_mask_is_none_of_them() {
    let mut harness = harness(z_fail(SIZE));
    let of_z_fail = [(0, PictureKind::Color), (1, PictureKind::Stencil), (3, PictureKind::Color)];
    assert_eq!(shown_at_steps(&mut harness, 3), of_z_fail);
    harness.state_mut().inspector.set_capture(Arc::new(cube_map()));
    let of_map = [(0, PictureKind::Map), (1, PictureKind::Map), (2, PictureKind::Color), (3, PictureKind::Color)];
    assert_eq!(shown_at_steps(&mut harness, 4), of_map);
    harness.get_by_label("step 4 of 4");
}

#[test]
fn no_two_steps_show_the_same_picture() {
    let mut harness = harness(z_fail(SIZE));
    press(&mut harness, Key::Home);
    let mut before = harness.state().inspector.shown_images();
    for _ in 1..3 {
        press(&mut harness, Key::ArrowRight);
        let now = harness.state().inspector.shown_images();
        assert_ne!(before, now, "a step that looks inert teaches nothing");
        before = now;
    }
}

#[test]
fn a_step_that_the_next_frame_does_not_have_gives_way_to_the_whole_frame() {
    let mut harness = harness(z_fail(SIZE));
    harness.state_mut().inspector.model.select_step(1);
    show_capture(&mut harness, cube_map());
    assert_eq!(
        (harness.state().inspector.model.selection.step, kind(&harness)),
        (3, PictureKind::Color),
        "no map pass instead"
    );
}

#[test]
fn a_mask_is_looked_at_by_its_row_and_stepped_away_from() {
    let mut harness = harness(z_fail(SIZE));
    harness.get_by_label("3 · light");
    click(&mut harness, "mask");
    assert_eq!((harness.state().inspector.model.selection.step, kind(&harness)), (2, PictureKind::Mask));
    harness.get_by_label("beside the frame");
    press(&mut harness, Key::ArrowRight);
    assert_eq!(harness.state().inspector.model.selection.step, 3);
}

#[test]
fn a_kind_that_was_chosen_stays_until_auto_is_chosen_again() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Depth");
    assert_eq!(shown_at_steps(&mut harness, 3).iter().filter(|(_, kind)| *kind == PictureKind::Depth).count(), 3);
    press(&mut harness, Key::Home);
    press(&mut harness, Key::ArrowRight);
    click_button(&mut harness, "Auto");
    assert_eq!(kind(&harness), PictureKind::Stencil);
}

#[test]
fn before_and_after_a_step_are_of_one_kind() {
    let mut harness = harness(z_fail(SIZE));
    change(&mut harness, |inspector| inspector.model.select_step(1));
    click_button(&mut harness, "Before");
    assert_eq!(kind(&harness), PictureKind::Stencil);
    harness.get_by_label_contains("stencil before step 2");
    click_button(&mut harness, "Diff");
    harness.get_by_label("600 pixels changed");
}

#[test]
fn buttons_keep_their_place_from_step_to_step_and_from_technique_to_technique() {
    let mut harness = harness(z_fail(SIZE));
    let place = |harness: &Harness<Seen>, label: &str| harness.get_by_role_and_label(Role::Button, label).rect();
    let labels = ["Auto", "Colour", "Stencil", "Depth", "Mask", "Truth", "Error", "Overdraw"];
    let first: Vec<Rect> = labels.iter().map(|label| place(&harness, label)).collect();
    let check = |harness: &mut Harness<Seen>, steps: usize| {
        press(harness, Key::Home);
        for step in 0..steps {
            let now: Vec<Rect> = labels.iter().map(|label| place(harness, label)).collect();
            assert_eq!(now, first, "step {step}");
            press(harness, Key::ArrowRight);
        }
    };
    check(&mut harness, 3);
    harness.state_mut().inspector.set_capture(Arc::new(cube_map()));
    check(&mut harness, 4);
    harness.state_mut().inspector.set_capture(Arc::new(by_hand::counted_in_floats()));
    check(&mut harness, 3);
}
