//! Two pictures side by side: of two techniques, settings or steps, with one pick and one view.

use super::*;
use stencilscope::ask::CaptureOf;
use stencilscope::inspector::DialogKind;

/// Two pictures side by side, the other one of another technique, in which the pixel at 3, 4 is lit.
fn side_by_side() -> Harness<'static, Seen> {
    let mut harness = picked(z_fail(SIZE), [3, 4]);
    click_button(&mut harness, "Compare");
    choose(&mut harness, "Compare with", "technique z-pass");
    let mut other = z_fail(SIZE);
    other.technique = "z-pass".to_owned();
    let mask = Image::uniform(PixelFormat::U8, SIZE, &[0]);
    other.lights[0].shadow = Some(Arc::new(mask));
    reply::<CaptureOf>(&mut harness, Ok(other));
    click_button(&mut harness, "Two");
    harness.run_steps(3);
    harness
}

/// Chooses an entry of a list that is longer than it is high.
fn compare_with(harness: &mut Harness<Seen>, entry: &str) {
    click_role(harness, Role::ComboBox, "Compare with");
    harness.get_all_by_role_and_label(Role::Button, entry).last().expect("an entry").click_accesskit();
    harness.run_steps(3);
    // Only a click of the mouse closes the list.
    press(harness, Key::Escape);
}

fn canvases(harness: &Harness<Seen>) -> [Rect; 2] {
    ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect())
}

#[test]
fn both_pictures_are_whole_and_as_large_and_each_says_what_it_makes_of_the_pick() {
    let mut harness = side_by_side();
    let [other, own] = canvases(&harness);
    assert!((other.width() - own.width()).abs() < 1.0 && (other.height() - own.height()).abs() < 1.0);
    assert!(own.left() >= other.right() - 1.0, "{other}, {own}");
    assert!(harness.query_by_label("Compare divider").is_none());
    let said = |harness: &Harness<Seen>, words: &str, within: Rect| {
        let nodes = harness.query_all_by_label_contains(words);
        nodes
            .filter(|node| node.rect().left() >= within.left() - 1.0 && node.rect().right() <= within.right() + 1.0)
            .count()
    };
    assert_eq!(said(&harness, "Lit by light 1", other), 1);
    assert!(said(&harness, "Dark under light 1: its stencil count is 1.", own) >= 1);
    press(&mut harness, Key::X);
    let [other, own] = canvases(&harness);
    assert!(other.left() >= own.right() - 1.0, "flipped: {own}, {other}");
    click_button(&mut harness, "Two");
    harness.get_by_label("Compare divider");
    assert!(harness.query_by_label("Compared canvas").is_none());
}

/// Beside a picture from before the volumes the count is still to come.
#[test]
fn each_side_says_of_which_moment_it_speaks() {
    let mut harness = side_by_side();
    change(&mut harness, |inspector| inspector.model.select_step(0));
    harness.run_steps(2);
    let [_, own] = canvases(&harness);
    let titles = harness.query_all_by_label_contains("Dark under light 1: its stencil count is ");
    let beside: Vec<String> = titles
        .filter(|node| node.rect().left() >= own.left() - 1.0 && node.rect().right() <= own.right() + 1.0)
        .filter_map(|node| node.value())
        .collect();
    assert!(
        !beside.is_empty() && beside.iter().all(|title| title.ends_with("once the light pass tests it.")),
        "{beside:?}"
    );
}

/// An export is of the moment at which it was asked for.
#[test]
fn a_running_animation_stops_when_its_moment_is_exported() {
    let mut harness = side_by_side();
    change(&mut harness, |inspector| inspector.model.animation.is_running = true);
    change(&mut harness, |inspector| inspector.model.dialog = Some(DialogKind::Export(ExportKind::Page)));
    harness.run_steps(2);
    assert!(!harness.state().inspector.model.animation.is_running);
}

#[test]
fn a_pick_and_a_zoom_in_one_are_those_of_the_other() {
    let mut harness = side_by_side();
    let [other, _] = canvases(&harness);
    let scale = (other.width() / SIZE[0] as f32).min(other.height() / SIZE[1] as f32);
    let at = other.center() + (vec2(10.5, 20.5) - vec2(20.0, 15.0)) * scale;
    mouse(&mut harness, at, PointerButton::Secondary);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([10, 20]));
    assert_eq!(harness.state().inspector.model.selection.hover.map(|hover| hover.at), Some([10, 20]));
    let before = window_picture(&mut harness);
    wheel(&mut harness, 200.0);
    harness.run_steps(8);
    assert!(matches!(harness.state().inspector.model.view.zoom, TexelZoom::Pixels(pixels) if pixels > scale));
    let after = window_picture(&mut harness);
    // Both are drawn anew: a place in each looks different.
    for canvas in canvases(&harness) {
        let differs = |x: u32, y: u32| before.at([x, y]) != after.at([x, y]);
        let [left, right] = [canvas.left() as u32 + 2, canvas.right() as u32 - 2];
        let [top, bottom] = [canvas.top() as u32 + 2, canvas.bottom() as u32 - 2];
        assert!((top..bottom).any(|y| (left..right).any(|x| differs(x, y))), "{canvas}");
    }
}

#[test]
fn a_setting_is_compared_with_another_value_of_it_and_with_the_defaults() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Compare");
    compare_with(&mut harness, "caps none");
    let choice = |harness: &Harness<Seen>| asks::<CaptureOf>(harness).pop().expect("it is asked for").request.choice;
    let mut expected = Choice::new(Technique::ZFail);
    expected.set("caps", "none").expect("a setting");
    assert_eq!(choice(&harness), expected);
    harness.get_by_label_contains("Capturing caps none");
    // The defaults are offered where others are in use.
    change(&mut harness, |inspector| drop(inspector.choose(expected.clone())));
    change(&mut harness, |inspector| inspector.set_capture(Arc::new(z_fail(SIZE))));
    compare_with(&mut harness, "default settings");
    assert_eq!(choice(&harness), Choice::new(Technique::ZFail));
    // A technique that has no such setting says so.
    compare_with(&mut harness, "caps light");
    change(&mut harness, |inspector| drop(inspector.choose(Choice::new(Technique::ShadowMap))));
    change(&mut harness, |inspector| inspector.set_capture(Arc::new(z_fail(SIZE))));
    harness.get_by_label_contains("shadow-map has no setting `caps`");
}
