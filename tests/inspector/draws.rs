//! Draw by draw: selecting, stepping, asking for states that are not there, and what is shown.

use super::by_hand::with_draws;
use super::*;
use stencilscope::ask::DrawsOf;

fn at(harness: &Harness<Seen>) -> (usize, Option<usize>) {
    (harness.state().inspector.model.selection.step, harness.state().inspector.model.selection.draw)
}

/// Steps that draws were asked for of.
fn asked(harness: &Harness<Seen>) -> Vec<usize> {
    asks::<DrawsOf>(harness).into_iter().map(|ask| ask.step).collect()
}

/// How many texels of the shown stencil are 1.
fn ones(harness: &Harness<Seen>) -> u64 {
    harness.state().inspector.shown_images()[0].histogram()[1]
}

fn update(harness: &mut Harness<Seen>, capture: Capture) {
    change(harness, |inspector| inspector.model.update_capture(Arc::new(capture)));
}

#[test]
fn up_and_down_go_draw_by_draw_through_the_whole_frame() {
    let mut harness = harness(with_draws(z_fail(SIZE)));
    press(&mut harness, Key::Home);
    assert_eq!(at(&harness), (0, None));
    // Ambient has one draw, volumes two, light one; the mask stands beside the frame.
    let path = [(1, Some(0)), (1, Some(1)), (3, Some(0))];
    for expected in path {
        press(&mut harness, Key::ArrowDown);
        assert_eq!(at(&harness), expected);
    }
    press(&mut harness, Key::ArrowDown);
    assert_eq!(at(&harness), (3, Some(0)), "there is nothing after the last draw");
    for expected in [(1, Some(1)), (1, Some(0)), (0, Some(0))] {
        press(&mut harness, Key::ArrowUp);
        assert_eq!(at(&harness), expected);
    }
    press(&mut harness, Key::ArrowUp);
    assert_eq!(at(&harness), (0, Some(0)), "there is nothing before the first");
    assert_eq!(asked(&harness), [0; 0], "all states are there");
}

#[test]
fn a_whole_pass_counts_as_its_last_draw() {
    let mut harness = harness(with_draws(z_fail(SIZE)));
    click(&mut harness, "2 · volumes");
    press(&mut harness, Key::ArrowUp);
    assert_eq!(at(&harness), (1, Some(0)));
    click(&mut harness, "2 · volumes");
    assert_eq!(at(&harness), (1, None));
    press(&mut harness, Key::ArrowDown);
    assert_eq!(at(&harness), (3, Some(0)));
}

#[test]
fn left_right_home_and_end_go_by_pass_and_leave_the_draws() {
    let mut harness = harness(with_draws(z_fail(SIZE)));
    for (key, expected) in
        [(Key::ArrowRight, (3, None)), (Key::ArrowLeft, (0, None)), (Key::Home, (0, None)), (Key::End, (3, None))]
    {
        harness.state_mut().inspector.select_draw(1, 0);
        harness.run_steps(1);
        press(&mut harness, key);
        assert_eq!(at(&harness), expected, "{key:?}");
    }
}

#[test]
fn buttons_and_rows_select_draws_and_say_which() {
    let mut harness = harness(with_draws(z_fail(SIZE)));
    click(&mut harness, "2 · volumes");
    harness.get_by_label("after its 2 draws");
    click_button(&mut harness, "Previous draw");
    harness.get_by_label("draw 1 of 2");
    click_button(&mut harness, "Next draw");
    harness.get_by_label("draw 2 of 2");
    harness.get_by_label("step 2 of 3");
    click(&mut harness, "sides of box");
    assert_eq!(at(&harness), (1, Some(0)));
    click(&mut harness, "mask");
    harness.get_by_label("it draws nothing");
    harness.get_by_label("beside the frame");
}

#[test]
fn picture_pixel_and_status_bar_show_the_state_after_the_draw() {
    let mut inspector = inspector(with_draws(z_fail(SIZE)));
    inspector.model.selection.pick = Some([3, 20]);
    inspector.model.select_step(1);
    inspector.model.choose_picture(PictureKind::Stencil);
    let mut harness = harness_of(inspector);
    assert_eq!(ones(&harness), 599);
    harness.get_by_label("0000 0001");
    // The sides count the upper half only; the dark cap the rest.
    click(&mut harness, "sides of box");
    assert_eq!(ones(&harness), 299);
    harness.get_by_label("After draw 1 of step 2");
    harness.get_by_label("0000 0000");
    harness.get_by_label_contains("stencil after draw 1 of step 2");
    click(&mut harness, "dark cap of box");
    assert_eq!(ones(&harness), 599);
    harness.get_by_label("After draw 2 of step 2");
}

#[test]
fn a_draw_whose_state_is_not_there_is_asked_for_once_and_the_picture_stays() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "2 · volumes");
    click_button(&mut harness, "Stencil");
    assert_eq!(asked(&harness), [0; 0]);
    click(&mut harness, "sides of box");
    harness.run_steps(4);
    assert_eq!((asked(&harness), ones(&harness)), (vec![1], 599));
    harness.get_by_label("sides of box, being fetched");
    harness.get_by_label_contains("stencil after step 2");
    // The same frame was timed meanwhile.
    update(&mut harness, z_fail(SIZE));
    assert_eq!(asked(&harness), [1]);
    update(&mut harness, with_draws(z_fail(SIZE)));
    assert_eq!((at(&harness), ones(&harness)), ((1, Some(0)), 299));
    assert!(harness.query_by_label_contains("being fetched").is_none());
    assert_eq!(asked(&harness), [1]);
}

#[test]
fn the_last_draw_of_a_pass_is_known_without_asking() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "2 · volumes");
    click_button(&mut harness, "Stencil");
    click(&mut harness, "dark cap of box");
    press(&mut harness, Key::ArrowDown);
    assert_eq!((at(&harness), asked(&harness)), ((3, Some(0)), vec![]));
}

#[test]
fn another_frame_keeps_the_draw_and_asks_for_its_state() {
    let mut harness = harness(with_draws(z_fail(SIZE)));
    change(&mut harness, |inspector| inspector.select_draw(1, 0));
    let mut other = z_fail([20, 10]);
    other.steps[1].draws.swap(0, 1);
    let dark_cap_first = Arc::new(other.clone());
    change(&mut harness, |inspector| inspector.set_capture(dark_cap_first));
    assert_eq!((at(&harness), asked(&harness)), ((1, Some(1)), vec![]), "sides are last now");
    change(&mut harness, |inspector| inspector.select_draw(1, 0));
    assert_eq!(asked(&harness), [1]);
    show_capture(&mut harness, other);
    assert_eq!((at(&harness), asked(&harness)), ((1, Some(0)), vec![1, 1]));
}

#[test]
fn why_there_are_no_states_is_said_and_selecting_again_asks_again() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "2 · volumes");
    click(&mut harness, "sides of box");
    reply::<DrawsOf>(&mut harness, Err("the GPU is lost".to_owned()));
    harness.run_steps(3);
    harness.get_by_label("× The state after this draw is not known: the GPU is lost");
    assert_eq!(asked(&harness), [1]);
    click(&mut harness, "sides of box");
    assert_eq!(asked(&harness), [1, 1]);
}

#[test]
fn a_folder_without_draws_says_why_and_how() {
    let mut harness = of_folder();
    click(&mut harness, "2 · volumes");
    click(&mut harness, "sides of box");
    harness.get_by_label_contains("capture it with --every draw");
    assert_eq!(asked(&harness), [0; 0]);
    show_capture(&mut harness, with_draws(z_fail(SIZE)));
    assert!(harness.query_by_label_contains("--every draw").is_none());
    assert_eq!(at(&harness), (1, Some(0)));
}

#[test]
fn stepping_reaches_draws_that_are_folded_away() {
    let mut capture = z_fail(SIZE);
    let draw = capture.steps[1].draws[0].clone();
    capture.steps[1].draws = (0..40)
        .map(|index| stencilscope::capture::DrawSummary { name: format!("volume {index}"), ..draw.clone() })
        .collect();
    let mut harness = harness(capture);
    click(&mut harness, "2 · volumes");
    harness.get_by_label_contains("25 more draws");
    assert!(harness.query_by_label("volume 38").is_none());
    click_button(&mut harness, "Previous draw");
    assert_eq!(at(&harness), (1, Some(38)));
    harness.get_by_label("volume 38, being fetched");
}

#[test]
fn a_map_pass_shows_the_face_after_the_draw() {
    let capture = with_draws(cube_map());
    let mut harness = harness(capture);
    press(&mut harness, Key::Home);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Map));
    let depth = |harness: &Harness<Seen>| harness.state().inspector.shown_images()[0].depth_at([3, 3]);
    assert_eq!(depth(&harness), Some(0.25));
    change(&mut harness, |inspector| inspector.select_draw(0, 0));
    assert_eq!(depth(&harness), Some(0.125));
    harness.get_by_label_contains("shadow map of light 1, face −x after draw 1 of step 1");
}

#[test]
fn sides_that_graze_their_caster_are_called_so() {
    let request = common::request(Technique::Auto, [64, 36]);
    let frame = common::frame(&mut common::session(), "tori", request);
    let names: Vec<&str> = frame.capture.steps[1].draws.iter().map(|draw| draw.name.as_str()).collect();
    assert!(names.contains(&"grazing sides of blue torus"), "{names:?}");
}

/// What a program calls its draws often differs at the end alone.
#[test]
fn names_that_begin_alike_stay_apart_where_they_do_not_fit() {
    let mut capture = with_draws(z_fail(SIZE));
    let names = ["carriage/left/front/axle/wheel/outer/rim_001", "carriage/left/front/axle/wheel/outer/rim_002"];
    for (draw, name) in capture.steps[1].draws.iter_mut().zip(names) {
        draw.name = name.to_owned();
    }
    capture.steps[1].name = "shadow volumes with both caps, front to back, of wheel 7".to_owned();
    capture.steps[3].name = "shadows of carriage/left/front/axle/wheel/outer/rim_003".to_owned();
    let mut harness = harness(capture);
    harness.state_mut().inspector.select_draw(1, 0);
    harness.run_steps(2);
    let words: Vec<String> = never_cut::words(&harness).into_iter().map(|word| word.text).collect();
    for [begin, end] in [["carr", "rim_001"], ["carr", "rim_002"], ["3 · shad", "rim_003"]] {
        let is_drawn = |text: &String| text.starts_with(begin) && text.contains('…') && text.ends_with(end);
        assert!(words.iter().any(is_drawn), "{end}: {words:?}");
    }
    assert!(words.iter().any(|text| text == "wheel 7"), "the caster is whole where it fits: {words:?}");
}
