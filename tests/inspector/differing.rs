//! Where two compared pictures differ: shown alone, counted, gone through region by region, explained on both sides.

use super::contrast::words;
use super::*;
use stencilscope::ask::CaptureOf;
use stencilscope::capture::Snapshot;
use stencilscope::inspector::ThemeChoice;

/// The shadows of the shown frame are also the compared one's, but for two squares and a pixel, which it has lit.
const SQUARES: [([u32; 2], u32); 3] = [([3, 3], 5), ([20, 10], 3), ([39, 29], 1)];

fn with_squares(mut frame: Capture, label: u8) -> Capture {
    let mut labels = vec![0; (SIZE[0] * SIZE[1]) as usize];
    for ([left, top], side) in SQUARES {
        for (x, y) in (left..left + side).flat_map(|x| (top..top + side).map(move |y| (x, y))) {
            labels[(y * SIZE[0] + x) as usize] = label;
        }
    }
    frame.lights[0].shadow = Some(Arc::new(Image::packed(PixelFormat::U8, SIZE, labels)));
    frame
}

fn other_side() -> Capture {
    Capture { technique: "shadow-map".to_owned(), ..with_squares(z_fail(SIZE), 0) }
}

/// Both masks under the divider, without a pick.
fn compared(size: [f32; 2]) -> Harness<'static, Seen> {
    let mut harness = harness_in(inspector(with_squares(z_fail(SIZE), 1)), size);
    change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Mask));
    click_button(&mut harness, "Compare");
    reply::<CaptureOf>(&mut harness, Ok(other_side()));
    harness.run_steps(3);
    harness
}

fn pick(harness: &Harness<Seen>) -> Option<[u32; 2]> {
    harness.state().inspector.model.selection.pick
}

#[test]
fn the_next_difference_is_the_next_region_from_the_largest_on() {
    let mut harness = compared(WINDOW);
    assert!(says(&harness, "35 pixels differ: 2.9 % of all"));
    click_button(&mut harness, "Next difference");
    assert_eq!(pick(&harness), Some([5, 5]), "the middle of the largest");
    assert!(says(&harness, "region 1 of 3"));
    press(&mut harness, Key::N);
    assert_eq!(pick(&harness), Some([21, 11]));
    press(&mut harness, Key::N);
    assert_eq!(pick(&harness), Some([39, 29]));
    press(&mut harness, Key::N);
    assert_eq!(pick(&harness), Some([5, 5]), "from the smallest to the largest again");
    press_with(&mut harness, Modifiers::SHIFT, Key::N);
    assert_eq!(pick(&harness), Some([39, 29]), "and back");
}

/// Greys where nothing differs, the side's own colour elsewhere.
#[test]
fn the_difference_of_two_sides_is_shown_and_not_what_a_step_changed() {
    let mut harness = compared(WINDOW);
    for layout in ["Divider", "Beside", "Stacked"] {
        choose(&mut harness, "Layout of the comparison", layout);
        change(&mut harness, |inspector| inspector.model.selection.pick = None);
        let all = window_picture(&mut harness);
        click_button(&mut harness, "Diff");
        harness.remove_cursor();
        harness.run_steps(2);
        let difference = window_picture(&mut harness);
        let canvas = harness.get_by_label("Picture canvas").rect();
        let scale = (canvas.width() / SIZE[0] as f32).min(canvas.height() / SIZE[1] as f32);
        let at = |texel: [u32; 2]| {
            let place =
                canvas.center() + (vec2(texel[0] as f32 + 0.5, texel[1] as f32 + 0.5) - vec2(20.0, 15.0)) * scale;
            [place.x as u32, place.y as u32]
        };
        // The pixel is on the compared side of the divider, or is the shown side's.
        assert_eq!(difference.at(at([4, 4])), all.at(at([4, 4])), "{layout}: differs");
        let same = difference.at(at([30, 20])).expect("inside");
        assert!(same[0] == same[1] && same[1] == same[2] && same[0] < 110, "{layout}: {same:?}");
        assert_ne!(Some(same), all.at(at([30, 20])));
        click_button(&mut harness, "After");
    }
}

#[test]
fn counts_of_two_sides_in_one_place_are_subtracted() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Stencil");
    click_button(&mut harness, "Compare");
    let other = Capture { technique: "z-pass".to_owned(), ..z_fail(SIZE) };
    choose(&mut harness, "Compare with", "technique z-pass");
    reply::<CaptureOf>(&mut harness, Ok(other));
    click_button(&mut harness, "Diff");
    harness.run_steps(2);
    for layout in ["Divider", "Beside", "Stacked"] {
        choose(&mut harness, "Layout of the comparison", layout);
        harness.get_by_label("Difference");
        assert!(says(&harness, "0 pixels differ") && says(&harness, "z-fail minus z-pass"), "{layout}");
        assert!(harness.query_by_label("Compare divider").is_none(), "{layout}: it is one picture");
        assert!(harness.query_by_label("Compared canvas").is_none(), "{layout}: it is one picture");
        let data = harness.state_mut().inspector.export(ExportKind::AsShown);
        assert!(matches!(data, Some(ExportData::AsShown(_))), "{layout}: as shown, one picture");
    }
    // Of colours both sides are seen, and that they are a difference.
    change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Color));
    harness.get_by_label_contains("Difference · z-fail");
    harness.get_by_label_contains("Difference · z-pass");
    harness.get_by_label_contains("each side in its own colours where they differ, outlined");
    choose(&mut harness, "Layout of the comparison", "Divider");
    harness.get_by_label("Compare divider");
}

/// The line is taken hold of anywhere, not by its handle alone, and the picture stays where it is.
#[test]
fn the_divider_is_dragged_by_its_line() {
    let mut harness = compared(WINDOW);
    let at = |harness: &Harness<Seen>| harness.state().inspector.model.modes.compare.expect("a comparison").at;
    let canvas = harness.get_by_label("Picture canvas").rect();
    assert_eq!(at(&harness), 0.5);
    drag(&mut harness, pos2(canvas.center().x, canvas.bottom() - 40.0), vec2(-100.0, 0.0), PointerButton::Primary);
    assert!((0.5 - at(&harness) - 100.0 / canvas.width()).abs() < 0.02, "{}", at(&harness));
    assert_eq!(harness.state().inspector.model.view.zoom, TexelZoom::Fit);
}

/// Of counts each side has a legend of its own; in a low window it would be cut.
#[test]
fn a_legend_that_its_picture_has_no_height_for_is_a_button() {
    let mut harness = compared([1280.0, 900.0]);
    click_button(&mut harness, "Stencil");
    choose(&mut harness, "Layout of the comparison", "Stacked");
    let buttons = |harness: &Harness<Seen>| harness.query_all_by_role_and_label(Role::Button, "Legend").count();
    assert_eq!(buttons(&harness), 0);
    harness.set_size(vec2(1280.0, 520.0));
    harness.run_steps(4);
    assert_eq!(buttons(&harness), 2);
}

/// Side by side, two pictures stay where they are when a pixel is picked.
#[test]
fn a_pick_moves_no_picture_that_is_beside_another() {
    let mut harness = compared(WINDOW);
    choose(&mut harness, "Layout of the comparison", "Beside");
    let place = |harness: &Harness<Seen>| harness.get_by_label("Picture canvas").rect();
    let before = place(&harness);
    for pick in [[5, 5], [30, 20], [39, 29]] {
        change(&mut harness, |inspector| inspector.model.selection.pick = Some(pick));
        assert_eq!(place(&harness), before, "{pick:?}");
    }
}

/// A caption that takes two lines has them; an answer too.
#[test]
fn no_word_over_two_pictures_is_cut() {
    for size in [[1440.0, 900.0], [1280.0, 800.0], [1000.0, 700.0]] {
        for layout in ["Beside", "Stacked"] {
            let mut harness = compared(size);
            change(&mut harness, |inspector| inspector.model.theme = ThemeChoice::Light);
            choose(&mut harness, "Layout of the comparison", layout);
            press(&mut harness, Key::N);
            let canvases = ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect());
            assert!((canvases[0].size() - canvases[1].size()).length() < 2.0, "{layout}: {canvases:?}");
            let heads = canvases.map(|canvas| canvas.with_min_y(canvas.top() - 90.0).with_max_y(canvas.top() + 1.0));
            let said = words(&harness);
            for (head, name) in heads.into_iter().zip(["shadow-map", "z-fail"]) {
                let within: Vec<_> = said.iter().filter(|word| head.contains_rect(word.place)).collect();
                assert!(within.iter().any(|word| word.text.starts_with(name)), "{layout} at {size:?}: {name}");
                assert!(within.iter().any(|word| word.text.contains("light 1")), "{layout} at {size:?}: the answer");
                assert!(within.iter().all(|word| !word.text.contains('…')), "{layout} at {size:?}");
                for (index, one) in within.iter().enumerate() {
                    let over = within[index + 1..].iter().find(|other| other.place.shrink(1.0).intersects(one.place));
                    assert!(
                        over.is_none(),
                        "{layout} at {size:?}: {} over {:?}",
                        one.text,
                        over.map(|over| &over.text)
                    );
                }
            }
        }
    }
}

/// Without a pick there is no answer, and no space for one.
#[test]
fn what_is_not_said_takes_no_space() {
    let mut harness = compared(WINDOW);
    choose(&mut harness, "Layout of the comparison", "Stacked");
    let top = |harness: &Harness<Seen>| harness.get_by_label("Compared canvas").rect().top();
    let before = top(&harness);
    press(&mut harness, Key::N);
    assert!(top(&harness) > before + 10.0, "{before}");
}

#[test]
fn two_pictures_lie_one_over_the_other_where_that_is_wished() {
    let mut harness = compared(WINDOW);
    choose(&mut harness, "Layout of the comparison", "Stacked");
    let [other, own] = ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect());
    assert!(other.bottom() <= own.top() && (other.left() - own.left()).abs() < 1.0, "{other}, {own}");
    assert!((other.height() - own.height()).abs() < 2.0);
    press(&mut harness, Key::X);
    let [other, own] = ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect());
    assert!(own.bottom() <= other.top(), "flipped");
    choose(&mut harness, "Layout of the comparison", "Beside");
    let [other, own] = ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect());
    assert!(own.right() <= other.left() + 1.0, "{own}, {other}");
}

/// Each answer stands under the name of its side, in the order in which the pictures stand; whose values follow is said.
#[test]
fn the_pixel_tab_answers_for_both_sides() {
    let mut harness = compared(WINDOW);
    press(&mut harness, Key::N);
    let panel = harness.get_by_role_and_label(Role::TabPanel, "Pixel").rect();
    let tops = |harness: &Harness<Seen>, words: &str| -> Vec<f32> {
        let nodes = harness.query_all_by_label_contains(words).map(|node| node.rect());
        nodes.filter(|place| panel.contains_rect(*place)).map(|place| place.top()).collect()
    };
    let [own, dark, other, lit] =
        ["z-fail", "Dark under light 1", "shadow-map", "Lit by light 1"].map(|words| tops(&harness, words));
    assert!(other[0] < lit[0] && lit[0] < own[0] && own[0] < dark[0], "{own:?} {dark:?} {other:?} {lit:?}");
    let below = tops(&harness, "Below: the values of z-fail");
    assert!(below.len() == 1 && below[0] > dark[0], "{below:?}");
    press(&mut harness, Key::X);
    let [dark, lit] = ["Dark under light 1", "Lit by light 1"].map(|words| tops(&harness, words));
    assert!(dark[0] < lit[0], "flipped: {dark:?} {lit:?}");
    click_button(&mut harness, "Compare");
    assert!(tops(&harness, "Lit by light 1").is_empty(), "one frame has one answer");
}

/// A side that lacks the kind shows its colour, and says so.
#[test]
fn a_side_without_the_kind_of_picture_shows_its_colour() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Stencil");
    click_button(&mut harness, "Compare");
    let mut other = other_side();
    for step in &mut other.steps {
        if let Snapshot::Frame(frame) = &mut step.snapshot {
            frame.stencil = None;
        }
    }
    choose(&mut harness, "Compare with", "technique shadow-map");
    reply::<CaptureOf>(&mut harness, Ok(other));
    for layout in ["Beside", "Stacked"] {
        choose(&mut harness, "Layout of the comparison", layout);
        harness.get_by_label("Compared canvas");
        harness.get_by_label("shadow-map · step 3 (no stencil: its colour)");
    }
    choose(&mut harness, "Layout of the comparison", "Divider");
    harness.get_by_label("Compare divider");
    assert!(says(&harness, "Pictures of different kinds: nothing to count."));
}

/// The dialog names the sides in the order in which they stand, as the file's name does.
#[test]
fn the_sides_of_an_export_are_named_in_their_order() {
    let mut harness = compared(WINDOW);
    choose(&mut harness, "Layout of the comparison", "Beside");
    for (names, file) in
        [("shadow-map and z-fail", "shadow-map-beside-z-fail"), ("z-fail and shadow-map", "z-fail-beside-shadow-map")]
    {
        press_with(&mut harness, Modifiers::COMMAND, Key::S);
        harness.get_by_label(&format!("Carries both sides, each over its name: {names}."));
        let path = harness.get_by_role(Role::TextInput).value().expect("a path");
        assert!(path.contains(file), "{path}");
        press(&mut harness, Key::Escape);
        press(&mut harness, Key::X);
    }
}

/// Between two pictures is a line, over their whole height.
#[test]
fn a_line_divides_two_pictures() {
    let mut harness = compared(WINDOW);
    for layout in ["Beside", "Stacked"] {
        choose(&mut harness, "Layout of the comparison", layout);
        harness.remove_cursor();
        harness.run_steps(2);
        let [other, own] = ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect());
        let picture = window_picture(&mut harness);
        let at = |place: Pos2| picture.at([place.x as u32, place.y as u32]).expect("inside");
        for share in [0.1, 0.5, 0.9] {
            let across: Vec<[u8; 3]> = match layout {
                "Beside" => {
                    let y = own.top() + share * own.height();
                    (other.right() as u32..=own.left() as u32).map(|x| at(pos2(x as f32, y))).collect()
                }
                _ => {
                    let x = own.left() + share * own.width();
                    let bottom = own.top() - 60.0;
                    (bottom as u32..own.top() as u32).map(|y| at(pos2(x, y as f32))).collect()
                }
            };
            let light = across.iter().map(|color| color[0]).max().unwrap_or(0);
            assert!(light > 80, "{layout} at {share}: {across:?}");
        }
    }
}

/// A press of N that finds no single picture is not kept for a later one.
#[test]
fn a_press_that_found_nothing_to_go_to_moves_no_pick_later() {
    let mut harness = compared(WINDOW);
    show_tab(&mut harness, "Scene");
    press(&mut harness, Key::N);
    show_tab(&mut harness, "Picture");
    harness.run_steps(3);
    assert_eq!(pick(&harness), None);
    press(&mut harness, Key::N);
    assert_eq!(pick(&harness), Some([5, 5]));
}

/// What is marked in the window as too small to be seen is marked in a file, on both sides.
#[test]
fn specks_are_marked_in_exported_pictures_of_both_sides() {
    let mut harness = compared(WINDOW);
    choose(&mut harness, "Layout of the comparison", "Beside");
    click_button(&mut harness, "Diff");
    let mut picture = |kind| match harness.state_mut().inspector.export(kind) {
        Some(ExportData::BothSides(both)) => both.finish().expect("captions"),
        other => panic!("both sides, not {other:?}"),
    };
    let [plain, shown] = [ExportKind::Picture, ExportKind::AsShown].map(&mut picture);
    let changed = |left: u32| {
        let near = (15..30).flat_map(|x| (5..18).map(move |y| [left + x, y]));
        near.filter(|at| plain.at(*at) != shown.at(*at)).count()
    };
    assert!(changed(0) > 5 && changed(SIZE[0] + 8) > 5, "{} {}", changed(0), changed(SIZE[0] + 8));
}
