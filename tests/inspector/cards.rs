//! What lies over the picture's corners, and the tools above it: nothing hides or moves another.

use super::by_hand::with_truth;
use super::pictures::{self, Gallery, View};
use super::*;
use stencilscope::inspector::ThemeChoice;

const FINDINGS: [&str; 6] =
    ["false shadow", "missing shadow", "wrong surface", "edge, excused", "agrees", "not compared"];

#[test]
fn the_error_legend_says_all_meanings_in_two_rows_and_leaves_the_picture_free() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    // The handle of the light is at the upper border, and the legend would leave it free.
    click(&mut harness, "Gizmos");
    click_button(&mut harness, "Error");
    harness.run_steps(2);
    let canvas = rect(&harness, "Picture canvas");
    let rows: BTreeSet<i32> = FINDINGS.iter().map(|name| rect(&harness, name).center().y.round() as i32).collect();
    assert_eq!(rows.len(), 2, "{rows:?}");
    let all = FINDINGS.iter().fold(rect(&harness, "Error, light 1"), |all, name| all.union(rect(&harness, name)));
    assert!(canvas.contains_rect(all), "{all:?} in {canvas:?}");
    assert!(all.height() < 64.0 && all.bottom() < canvas.top() + 84.0, "{all:?}");
    assert!(all.area() < canvas.area() / 16.0, "{all:?} of {canvas:?}");
    // With counts it is larger, and says more; it stays so for other frames, and goes back.
    click_button(&mut harness, "Counts");
    assert!(rect(&harness, "5 not compared").bottom() > all.bottom());
    show_capture(&mut harness, with_truth(z_fail(SIZE)));
    harness.get_by_label("5 not compared");
    click_button(&mut harness, "Counts");
    assert!(harness.query_by_label("5 not compared").is_none());
}

/// A square in a dark colour with an outline is taken for a box to tick.
#[test]
fn the_swatches_of_findings_are_wider_than_high() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    click_button(&mut harness, "Error");
    let named = rect(&harness, "agrees");
    let picture = window_picture(&mut harness);
    let middle = [named.left() as u32 + 6, named.center().y as u32];
    let agrees = picture.at(middle).expect("within the window");
    let along = |axis: usize| {
        let like = |by: &i64| {
            let mut at = middle.map(i64::from);
            at[axis] += by;
            picture.at(at.map(|at| at as u32)) == Some(agrees)
        };
        (0..20).take_while(like).count() + (1..20).map(|by| -by).take_while(like).count()
    };
    let [wide, high] = [along(0), along(1)];
    assert!(wide > high + 2 && high > 4, "{wide} by {high}");
}

#[test]
fn the_banner_of_walking_and_the_legend_are_beside_each_other() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    click_button(&mut harness, "Error");
    click_button(&mut harness, "Counts");
    let before = rect(&harness, "Error, light 1");
    click(&mut harness, "Walk");
    let banner = rect(&harness, "Walking: Esc stops and frees the pointer");
    let words = harness.get_by_label_contains("W S A D and the mouse").rect();
    let whole = banner.union(words).expand(8.0);
    let canvas = rect(&harness, "Picture canvas");
    assert!(canvas.contains_rect(whole), "{whole:?}");
    for label in ["Error, light 1", "Counts", "0 agrees", "5 not compared"] {
        let one = rect(&harness, label);
        assert!(!whole.intersects(one) && canvas.contains_rect(one), "{label}: {one:?}, {whole:?}");
    }
    press(&mut harness, Key::Escape);
    assert_eq!(rect(&harness, "Error, light 1"), before);
}

#[test]
fn tools_of_one_kind_of_picture_move_no_others_and_not_the_picture() {
    let mut harness = harness(with_truth(z_fail(SIZE)));
    change(&mut harness, |inspector| inspector.model.select_step(1));
    let fixed = ["Compare", "Overlay", "Fit", "1:1", "Walk", "Picture canvas"];
    let places = |harness: &Harness<Seen>| fixed.map(|label| rect(harness, label));
    let before = places(&harness);
    let phases = rect(&harness, "Before");
    for kind in ["Stencil", "Depth", "Mask", "Error", "Colour"] {
        click_button(&mut harness, kind);
        assert_eq!(places(&harness), before, "{kind}");
        assert!(harness.query_by_label("Before").is_none_or(|found| found.rect() == phases), "{kind}");
    }
    change(&mut harness, |inspector| inspector.set_zoom(TexelZoom::Pixels(3.0), [20.0, 15.0]));
    harness.get_by_label_contains("×30 at 300 %");
    assert_eq!(places(&harness), before, "zoomed");
    click_button(&mut harness, "Compare");
    let with = rect(&harness, "Compare with");
    assert_eq!(places(&harness), before, "comparing");
    click_button(&mut harness, "Stencil");
    assert_eq!((places(&harness), rect(&harness, "Compare with")), (before, with), "comparing counts");
    press(&mut harness, Key::O);
    harness.run_steps(2);
    click_role(&mut harness, Role::CheckBox, "Receivers");
    press(&mut harness, Key::Escape);
    assert_eq!(rect(&harness, "Overlay 1"), before[1], "the menu's button keeps its width");
}

#[test]
fn of_several_faces_none_is_compared_and_the_buttons_keep_their_place() {
    let mut harness = harness_of(inspector(cube_map()));
    press(&mut harness, Key::Home);
    let buttons = |harness: &Harness<Seen>| ["Compare", "Overlay", "All"].map(|label| rect(harness, label));
    let one = buttons(&harness);
    click_button(&mut harness, "All");
    assert_eq!(buttons(&harness), one);
    let is_disabled = |harness: &Harness<Seen>, label| harness.get_by_label(label).accesskit_node().is_disabled();
    assert!(is_disabled(&harness, "Compare") && is_disabled(&harness, "Overlay"));
    press(&mut harness, Key::O);
    harness.run_steps(2);
    assert!(harness.query_by_role_and_label(Role::CheckBox, "Receivers").is_none());
}

#[test]
fn the_magnifier_has_a_grid_over_counts_of_zero_in_both_themes() {
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        let mut inspector = inspector(z_fail(SIZE));
        inspector.model.select_step(1);
        inspector.model.choose_picture(PictureKind::Stencil);
        inspector.model.theme = theme;
        inspector.model.selection.pick = Some([30, 15]);
        let mut harness = harness_of(inspector);
        let canvas = rect(&harness, "Picture canvas");
        let picture = window_picture(&mut harness);
        let corner = canvas.left_bottom() + vec2(12.0, -12.0 - 5.0 * 26.0);
        let contrast = |x: f32, y: f32| {
            let [red, green, blue] = picture.at([x as u32, y as u32]).expect("within the window");
            let light = |byte: u8| (f64::from(byte) / 255.0).powf(2.2);
            let light = 0.2126 * light(red) + 0.7152 * light(green) + 0.0722 * light(blue);
            // To a count of zero, 0x14171d.
            (light + 0.05) / (0.0085 + 0.05)
        };
        // Above the numbers of the second row of cells.
        let along: Vec<bool> = (4..178).map(|x| contrast(corner.x + x as f32, corner.y + 26.0 + 4.0) > 1.5).collect();
        let lines = along.windows(2).filter(|pair| !pair[0] && pair[1]).count();
        assert_eq!(lines, 6, "{theme:?}: between seven cells");
        assert!(along.iter().filter(|is_line| **is_line).count() <= 12, "they are thin");
    }
}

/// Over a picture that fills its panel, a handle at the border lies where the legend mostly is.
#[test]
fn the_legend_leaves_a_light_s_handle_free() {
    let mut scene = scene();
    scene.lights = vec![stencilscope::scene::Light::point(DVec3::new(7.0, 4.0, 0.0))];
    let mut inspector = inspector(z_fail(SIZE));
    inspector.set_scene(&scene, RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE));
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    inspector.model.select_step(1);
    inspector.model.choose_picture(PictureKind::Stencil);
    inspector.set_zoom(TexelZoom::Pixels(80.0), [20.0, 15.0]);
    let mut harness = harness_of(inspector);
    harness.run_steps(3);
    let [canvas, legend] = ["Picture canvas", "Stencil count"].map(|label| rect(&harness, label));
    let handle = rect(&harness, "Light 1 in the picture");
    let corner = canvas.right_top() - handle.center();
    assert!(corner.x < 150.0 && corner.y > -150.0, "the handle is in the corner: {corner}");
    assert!(legend.center().x < canvas.center().x, "{legend}");
    // Without handles it is where it is in other windows.
    click(&mut harness, "Gizmos");
    harness.run_steps(3);
    assert!(rect(&harness, "Stencil count").center().x > canvas.center().x);
}

#[test]
fn the_whole_ladder_is_visible_in_windows_that_are_not_high() {
    let history = history_by_hand::history([3, 4], &history_by_hand::FACES);
    for height in [800.0, 900.0, 1000.0, 1080.0] {
        let mut inspector = inspector(with_truth(z_fail(SIZE)));
        inspector.model.selection.pick = Some([3, 4]);
        let mut harness = harness_in(inspector, [1280.0, height]);
        change(&mut harness, |inspector| inspector.take_in(HistoryOf { at: [3, 4] }, Ok(Arc::new(history.clone()))));
        let ladder = harness.get_by_label_contains("Ladder of the view ray").rect();
        // Down to the status bar.
        assert!(ladder.height() >= 120.0 && ladder.bottom() <= height - 24.0, "{ladder:?} in {height}");
        let rows = harness.query_all_by_role(Role::Row).count();
        assert!(rows >= 4, "{rows} events are seen in {height}");
        assert!(rect(&harness, "0000 0001").right() < 1280.0 - 8.0, "values are not cut off");
    }
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of_cards` writes them.
#[test]
fn pictures_of_cards_can_be_drawn() {
    let gallery = Gallery::open();
    let mut session = common::session();
    let mut frame = common::frame(&mut session, "inside", common::request(Technique::ZPass, [640, 360]));
    let judged = session.judged(frame.scene().expect("a scene"), &frame.capture, &Progress::default());
    frame.capture = Arc::new(judged.expect("a truth"));
    let anatomy = pictures::anatomy(&mut session, &frame);
    let pick = [330, 225];
    let history = Arc::new(session.history(&frame.plan, &frame.capture, pick).expect("a history"));
    let views: [(&str, View); 5] = [
        ("error", |_| ()),
        ("error-counts", |harness| click_button(harness, "Counts")),
        ("error-walking", |harness| click(harness, "Walk")),
        ("stencil", |harness| {
            harness.state_mut().inspector.model.select_step(1);
            harness.state_mut().inspector.model.choose_picture(PictureKind::Stencil);
        }),
        ("help", |harness| press(harness, Key::F1)),
    ];
    let sizes: &[[u32; 2]] = if gallery.folder.is_some() { &[[1280, 800], [1920, 1080]] } else { gallery.sizes() };
    for (name, view) in views {
        for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
            let inspector = || {
                let mut inspector = pictures::inspector(&frame, pick);
                inspector.take_in(AnatomyOf {}, Ok(anatomy.clone()));
                inspector.model.choose_picture(PictureKind::Error);
                inspector.model.theme = theme;
                inspector
            };
            gallery.show(&format!("cards-{name}-{theme:?}").to_lowercase(), sizes, inspector, |harness| {
                harness.state_mut().inspector.take_in(HistoryOf { at: pick }, Ok(history.clone()));
                view(harness);
                harness.run_steps(1);
            });
        }
    }
}
