//! What is drawn over the picture: chosen in a menu, asked for once, listed with its colours.

use super::*;
use stencilscope::ask::TestsOf;
use stencilscope::capture::StepTests;
use stencilscope::inspector::Overlay;
use stencilscope::reading::TestOutcomes;

fn turn_on(harness: &mut Harness<Seen>, names: &[&str]) {
    press(harness, Key::O);
    harness.run_steps(2);
    for name in names {
        click_role(harness, Role::CheckBox, name);
    }
    press(harness, Key::Escape);
}

/// Ten pixels passed, twenty failed the depth test, in one row both, one is not known.
fn tests() -> StepTests {
    let count = |counts: &dyn Fn(u32) -> u8| {
        let bytes: Vec<u8> = (0..SIZE[0] * SIZE[1]).map(counts).collect();
        Arc::new(Image::packed(PixelFormat::U8, SIZE, bytes))
    };
    StepTests {
        step: 1,
        draw: None,
        fragments: count(&|at| match at {
            0..30 => 1,
            30..71 => 2,
            _ => 0,
        }),
        depth_passes: count(&|at| match at {
            0..10 | 30..71 => 1,
            _ => 0,
        }),
        stencil: count(&|at| if at == 70 { 2 } else { 0 }),
    }
}

#[test]
fn tests_of_the_step_are_asked_once_and_listed_with_their_pixels() {
    let mut harness = harness(z_fail(SIZE));
    harness.state_mut().inspector.model.select_step(1);
    turn_on(&mut harness, &["Depth and stencil tests"]);
    harness.get_by_label("Overlay 1");
    assert_eq!(asks::<TestsOf>(&harness), [TestsOf { step: 1, draw: None }]);
    harness.get_by_label("Counting fragments …");
    reply::<TestsOf>(&mut harness, Ok(TestOutcomes::new(tests())));
    harness.run_steps(2);
    harness.get_by_label("Tests of step 2");
    for (name, pixels) in [("passed", "10"), ("depth failed", "20"), ("mixed", "40"), ("? several", "1")] {
        harness.get_by_label(name);
        assert!(harness.query_all_by_label(pixels).next().is_some(), "{name}: {pixels}");
    }
    assert!(harness.query_all_by_label_contains("their number does not tell which").next().is_some());
    change(&mut harness, |inspector| inspector.model.select_step(3));
    assert!(asks::<TestsOf>(&harness).contains(&TestsOf { step: 3, draw: None }));
    reply::<TestsOf>(&mut harness, Err("no room: make it smaller".to_owned()));
    harness.run_steps(2);
    harness.get_by_label("no room: make it smaller");
}

#[test]
fn overdraw_is_a_picture_of_how_many_fragments_came() {
    let mut harness = harness(z_fail(SIZE));
    harness.state_mut().inspector.model.select_step(1);
    harness.run_steps(1);
    click_button(&mut harness, "Overdraw");
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Stencil));
    harness.get_by_label("Counting fragments …");
    reply::<TestsOf>(&mut harness, Ok(TestOutcomes::new(tests())));
    harness.run_steps(2);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Overdraw));
    harness.get_by_label("Fragments a pixel");
    harness.get_by_label("112 in all");
    harness.get_by_label_contains("overdraw after step 2");
    change(&mut harness, |inspector| inspector.model.select_step(2));
    assert!(is_disabled(&harness, "Overdraw"), "a step without draws");
}

#[test]
fn a_folder_says_that_it_has_no_geometry() {
    let mut harness = of_folder();
    turn_on(&mut harness, &["Silhouettes"]);
    harness.get_by_label_contains("Open the scene instead");
    assert!(asks::<AnatomyOf>(&harness).is_empty() && asks::<TestsOf>(&harness).is_empty());
}

#[test]
fn the_menu_opens_by_mouse_too_and_overlays_go_off_again() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "Overlay");
    click_role(&mut harness, Role::CheckBox, "Wireframe of volumes");
    harness.get_by_label("Overlay 1");
    click_role(&mut harness, Role::CheckBox, "Wireframe of volumes");
    assert!(!says(&harness, "Overlay 1"));
}

/// Over a real frame: lines and tints change the picture, and what is on is listed.
#[test]
fn lines_receivers_and_names_come_from_the_frames_anatomy() {
    let mut session = common::session();
    let frame = common::frame(&mut session, "tori", common::request(Technique::ZFail, [320, 180]));
    let anatomy = pictures::anatomy(&mut session, &frame);
    let mut harness = harness_of(pictures::inspector(&frame, [10, 10]));
    let plain = window_picture(&mut harness);
    turn_on(&mut harness, &["Silhouettes", "Wireframe of volumes", "Receivers", "Casters' names"]);
    assert_eq!(asks::<AnatomyOf>(&harness).len(), 1);
    harness.get_by_label("Looking at the geometry …");
    change(&mut harness, |inspector| inspector.take_in(AnatomyOf {}, Ok(anatomy)));
    for text in [
        "silhouette edge; thick, ±2: counted twice, as the triangles on both of its sides cast",
        "side",
        "light cap",
        "dark cap",
        "receives shadows",
    ] {
        assert!(says(&harness, text), "{text}");
    }
    let over = window_picture(&mut harness);
    let differing = plain.pixels().iter().zip(over.pixels()).filter(|(a, b)| a != b).count();
    assert!(differing > 20_000, "{differing} pixels");
}

#[test]
fn a_menu_asked_for_while_the_picture_is_hidden_does_not_open_with_it_later() {
    let mut harness = harness_of(inspector(z_fail(SIZE)));
    show_tab(&mut harness, "Scene");
    press(&mut harness, Key::O);
    show_tab(&mut harness, "Picture");
    assert!(harness.query_by_label("Wireframe of volumes").is_none());
    press(&mut harness, Key::O);
    harness.run_steps(2);
    harness.get_by_label("Wireframe of volumes");
}

/// The scene is seen from straight above: upright lines meet in the middle.
#[test]
fn vanishing_points_are_drawn_and_counted_without_a_question() {
    let mut capture = z_fail(SIZE);
    capture.camera = scene().camera;
    let mut harness = harness(capture);
    let before = window_picture(&mut harness);
    turn_on(&mut harness, &["Vanishing points"]);
    harness.get_by_label_contains("1-point perspective: lines along y meet in a point");
    harness.get_by_label("along y: meet");
    harness.get_by_label("along x: stay parallel");
    assert_eq!(asks::<AnatomyOf>(&harness), []);
    let canvas = harness.get_by_label("Picture canvas").rect();
    let after = window_picture(&mut harness);
    // The ring around the point.
    let ring = canvas.center() + vec2(5.0, 0.0);
    let at = [ring.x as u32, ring.y as u32];
    assert_ne!(before.at(at), after.at(at));
}

/// What is drawn over one of two pictures of one scene is drawn over both, and no name lies over another.
#[test]
fn both_pictures_of_a_comparison_have_the_names_of_casters() {
    let mut session = common::session();
    let frame = common::frame(&mut session, "tori", common::request(Technique::ZFail, [320, 180]));
    let anatomy = pictures::anatomy(&mut session, &frame);
    let mut harness = harness_in(pictures::inspector(&frame, [10, 10]), [1600.0, 900.0]);
    change(&mut harness, |inspector| {
        inspector.model.modes.overlays.extend([Overlay::Names, Overlay::Silhouettes]);
    });
    change(&mut harness, |inspector| inspector.take_in(AnatomyOf {}, Ok(anatomy)));
    click_button(&mut harness, "Compare");
    choose(&mut harness, "Layout of the comparison", "Beside");
    harness.run_steps(3);
    let sides = ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect());
    let names = contrast::words(&harness).into_iter().filter(|word| word.text.ends_with(" torus"));
    let names: Vec<(String, Rect)> = names.map(|word| (word.text, word.place)).collect();
    let of = |side: Rect| -> BTreeSet<&String> {
        names.iter().filter(|(_, place)| side.contains_rect(*place)).map(|(name, _)| name).collect()
    };
    assert!(of(sides[0]).len() >= 3 && of(sides[0]) == of(sides[1]), "{names:?}");
    for (index, (name, place)) in names.iter().enumerate() {
        for (other_name, other) in &names[index + 1..] {
            assert!(!place.intersects(*other), "{name} over {other_name}");
        }
    }
}
