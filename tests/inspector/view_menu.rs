//! The menu View: layouts in one press, the size of everything, and the theme.

use super::*;
use egui::accesskit::Toggled;
use stencilscope::ask::CaptureOf;
use stencilscope::inspector::{LayoutPreset, PanelKind, StoredSettings};

/// Usual windows, points, and what a window of 1280 by 800 pixels has in large type.
const WINDOWS: [[f32; 2]; 4] = [[1280.0, 800.0], [1440.0, 900.0], [1000.0, 700.0], [914.0, 571.0]];

fn choose_view(harness: &mut Harness<Seen>, entry: &str) {
    // In a narrow window all tools are a menu.
    if harness.query_by_role_and_label(Role::Button, "View").is_none() {
        click_button(harness, "More");
    }
    click_button(harness, "View");
    click_button(harness, entry);
    harness.run_steps(4);
}

fn panel(harness: &Harness<Seen>, name: &str) -> Option<Rect> {
    harness.query_by_role_and_label(Role::TabPanel, name).map(|panel| panel.rect())
}

#[track_caller]
fn assert_nothing_is_cut(harness: &mut Harness<Seen>, context: &str) {
    let found = never_cut::cut(harness, &mut BTreeSet::new());
    assert!(found.is_empty(), "{context}: {found:#?}");
}

#[test]
fn picture_and_scene_stand_side_by_side_in_any_usual_window() {
    for size in WINDOWS {
        let mut compared = inspector(z_fail(SIZE));
        compared.compare_with(Technique::Planar);
        let mut harness = harness_in(compared, size);
        choose_view(&mut harness, "Picture | Scene");
        assert!(harness.state().inspector.model.modes.compare.is_none(), "there is no space for two pictures");
        let [picture, scene, pixel] = ["Picture", "Scene", "Pixel"].map(|name| panel(&harness, name).expect("a panel"));
        assert!((picture.width() - scene.width()).abs() < 4.0 && scene.left() > picture.right(), "{picture}, {scene}");
        assert!(picture.width() > 0.3 * size[0] && pixel.height() > 0.8 * size[1], "{size:?}: {picture}, {pixel}");
        assert_nothing_is_cut(&mut harness, &format!("{size:?}"));
        choose_view(&mut harness, "Reset layout");
        assert!(panel(&harness, "Scene").is_none(), "{size:?}");
        assert_eq!(harness.state().inspector.remembered().layout, None);
    }
}

#[test]
fn teach_is_large_and_is_remembered_until_the_layout_is_reset() {
    let mut harness = harness(z_fail(SIZE));
    choose_view(&mut harness, "Teach");
    assert!((harness.ctx.zoom_factor() - 1.4).abs() < 1e-6);
    for name in ["Picture", "Pixel", "Passes"] {
        assert!(panel(&harness, name).is_some(), "{name}");
    }
    let stored = serde_json::to_string(&harness.state().inspector.remembered()).expect("text");
    let mut again = inspector(z_fail(SIZE));
    again.recall(serde_json::from_str::<StoredSettings>(&stored).expect("settings"));
    let mut again = harness_of(again);
    assert!((again.ctx.zoom_factor() - 1.4).abs() < 1e-6);
    assert!(panel(&again, "Passes").is_some_and(|passes| passes.left() > 600.0), "beside the picture");
    choose_view(&mut again, "Reset layout");
    assert_eq!(again.ctx.zoom_factor(), 1.0);
    assert_eq!(again.state().inspector.remembered().zoom, None);
    // A size that a stored file can't mean.
    for zoom in ["0.0", "-3", "400"] {
        let mut inspector = inspector(z_fail(SIZE));
        inspector.recall(serde_json::from_str(&format!("{{\"zoom\":{zoom}}}")).expect("settings"));
        assert_eq!(harness_of(inspector).ctx.zoom_factor(), 1.0, "{zoom}");
    }
}

/// In large type the window has fewer points, and the picked pixel needs as many as ever.
#[test]
fn the_picked_pixel_has_its_width_beside_two_pictures_in_large_type() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.selection.pick = Some([3, 4]);
    let mut harness = harness_in(inspector, WINDOWS[3]);
    choose_view(&mut harness, "Compare two");
    let pixel = panel(&harness, "Pixel").expect("a panel");
    assert!(pixel.width() > 320.0, "{pixel}");
    assert_nothing_is_cut(&mut harness, "large type");
}

#[test]
fn a_layout_shows_the_selected_pass_where_the_list_is_low() {
    let mut capture = z_fail(SIZE);
    let step = capture.steps[0].clone();
    capture.steps.splice(0..0, vec![step; 30]);
    let mut inspector = inspector(capture);
    inspector.model.select_step(2);
    let mut harness = harness_of(inspector);
    harness.run_steps(3);
    change(&mut harness, |inspector| inspector.model.select_step(20));
    choose_view(&mut harness, "Compare two");
    harness.run_steps(6);
    let row = harness.get_by_role_and_label(Role::TreeItem, "21 · ambient").rect();
    let passes = panel(&harness, "Passes").expect("a panel");
    assert!(passes.contains_rect(row), "{row} in {passes}");
}

#[test]
fn everything_grows_and_shrinks_by_menu_and_stays_within_what_can_be_read() {
    let mut harness = harness(z_fail(SIZE));
    let press_entry = |harness: &mut Harness<Seen>, entry: &str| {
        click_button(harness, "View");
        harness.get_by_label_contains(entry).click();
        harness.run_steps(4);
        harness.ctx.zoom_factor()
    };
    for (entry, zoom) in [("Larger", 1.1), ("Larger", 1.2), ("Smaller", 1.1), ("Usual size", 1.0), ("Smaller", 0.9)] {
        let found = press_entry(&mut harness, entry);
        assert!((found - zoom).abs() < 1e-6, "{entry}: {found} is not {zoom}");
    }
    for _ in 0..6 {
        press_entry(&mut harness, "Smaller");
    }
    assert_eq!(harness.ctx.zoom_factor(), 0.5, "smaller, nothing can be read");
}

#[test]
fn compare_two_asks_for_another_technique_and_shows_both_whole() {
    for size in WINDOWS {
        let mut harness = harness_in(inspector(z_fail(SIZE)), size);
        choose_view(&mut harness, "Compare two");
        assert_eq!(asks::<CaptureOf>(&harness)[0].request.choice.technique(), Technique::ShadowMap);
        let picture = harness.get_by_label("Picture canvas").rect();
        assert!(picture.width() < 0.5 * size[0], "{size:?}: {picture}");
        harness.get_by_label_contains("Capturing shadow-map");
        assert_nothing_is_cut(&mut harness, &format!("{size:?}"));
    }
}

/// For a class the passes are a list, not a line of it, and their controls one row.
#[test]
fn teach_shows_several_passes_under_one_row_of_controls() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), [1920.0, 1080.0]);
    choose_view(&mut harness, "Teach");
    harness.run_steps(3);
    let panel = panel(&harness, "Passes").expect("a panel");
    let names = ["Previous step", "Next step", "Previous draw", "Next draw"];
    let tops = names.map(|name| harness.get_by_role_and_label(Role::Button, name).rect().top());
    assert!(tops.iter().all(|top| (top - tops[0]).abs() < 1.0), "{tops:?}");
    let rows = harness.query_all_by_role(Role::TreeItem).map(|row| row.rect());
    let rows = rows.filter(|row| row.height() > 40.0 && panel.contains_rect(*row)).count();
    assert!(rows >= 2, "{rows} passes in {panel}");
}

/// In a small window the layout for teaching is less large, so that tools stay in sight, and few rows are over the pictures.
#[test]
fn teach_is_less_large_in_a_small_window() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), [1000.0, 700.0]);
    choose_view(&mut harness, "Teach");
    let zoom = harness.ctx.zoom_factor();
    assert!((zoom - 1.1).abs() < 1e-6, "{zoom}");
    harness.get_by_role_and_label(Role::Button, "View");
    click_button(&mut harness, "Compare");
    harness.run_steps(4);
    let [panel, canvas] = [panel(&harness, "Picture").expect("a panel"), rect(&harness, "Picture canvas")];
    let tools = canvas.top() - panel.top();
    assert!(tools < 76.0, "two rows of tools: {tools}");
    assert!(canvas.width() * zoom > 600.0, "{canvas}");
    assert_nothing_is_cut(&mut harness, "with a comparison");
}

/// A tab behind an arrow is not found.
#[test]
fn no_tab_of_teach_is_hidden() {
    for size in [[1280.0, 800.0], [1440.0, 900.0], [1920.0, 1080.0], [1000.0, 700.0]] {
        let mut harness = harness_in(inspector(z_fail(SIZE)), size);
        choose_view(&mut harness, "Teach");
        harness.run_steps(4);
        let panels: Vec<Rect> = harness.query_all_by_role(Role::TabPanel).map(|panel| panel.rect()).collect();
        let tabs: Vec<Rect> = harness.query_all_by_role(Role::Tab).map(|tab| tab.rect()).collect();
        assert_eq!(tabs.len(), PanelKind::ALL.len());
        for tab in tabs {
            let is_over = |panel: &&Rect| {
                (tab.bottom() - panel.top()).abs() < 12.0 && panel.x_range().expand(1.0).contains(tab.left())
            };
            // A tab at the border of two groups is the right one's.
            let over = panels.iter().filter(is_over).max_by(|one, other| one.left().total_cmp(&other.left()));
            let panel = over.unwrap_or_else(|| panic!("{size:?}: {tab} is over none of {panels:?}"));
            assert!(tab.right() <= panel.right() + 1.0, "{size:?}: {tab} over {panel}");
        }
    }
}

#[test]
fn the_layout_in_use_is_marked_until_the_user_changes_it() {
    let mut harness = harness(z_fail(SIZE));
    let marked = |harness: &mut Harness<Seen>| {
        click_button(harness, "View");
        let all = LayoutPreset::ALL.into_iter();
        let marked: Vec<&str> = all
            .map(LayoutPreset::name)
            .filter(|name| {
                let entry = harness.get_by_role_and_label(Role::Button, name);
                entry.accesskit_node().toggled() == Some(Toggled::True)
            })
            .collect();
        press(harness, Key::Escape);
        marked
    };
    assert_eq!(marked(&mut harness), ["Reset layout"]);
    choose_view(&mut harness, "Compare two");
    assert_eq!(marked(&mut harness), ["Compare two"]);
    // It comes back after the window was narrow.
    let wide = harness.ctx.content_rect().size();
    for size in [vec2(560.0, 700.0), wide] {
        harness.set_size(size);
        harness.run_steps(4);
    }
    assert_eq!(marked(&mut harness), ["Compare two"]);
    let [tab, picture] = [(Role::Tab, "Stress"), (Role::TabPanel, "Picture")]
        .map(|(role, name)| harness.get_by_role_and_label(role, name).rect().center());
    docking::drag_tab(&mut harness, tab, picture);
    assert_eq!(marked(&mut harness), [""; 0]);
}

/// `auto` and z-fail count the same.
#[test]
fn two_pictures_of_auto_are_not_the_same() {
    let mut harness = harness(z_fail(SIZE));
    let with = |harness: &mut Harness<Seen>, technique| {
        change(harness, |inspector| {
            inspector.model.modes.compare = None;
            drop(inspector.choose(Choice::new(technique)));
        });
        choose_view(harness, "Compare two");
        format!("{:?}", harness.state().inspector.model.modes.compare.expect("a comparison").with)
    };
    change(&mut harness, |inspector| inspector.set_scene(&scene(), run_request(Technique::Auto)));
    assert_eq!(with(&mut harness, Technique::Auto), "Technique(ShadowMap)");
    assert_eq!(with(&mut harness, Technique::ZPass), "Technique(ZFail)");
}

/// Under the entry it would hide the next one.
#[test]
fn what_an_entry_means_stands_beside_its_list() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "View");
    let entries: Vec<Rect> =
        LayoutPreset::ALL.map(|preset| harness.get_by_role_and_label(Role::Button, preset.name()).rect()).to_vec();
    harness.hover_at(entries[1].center());
    harness.run_steps(12);
    let words = contrast::words(&harness);
    let meaning = LayoutPreset::ALL[1].explanation();
    let shown: Vec<_> = words.iter().filter(|word| meaning.starts_with(word.text.trim_end())).collect();
    assert!(!shown.is_empty(), "{meaning}");
    for word in shown {
        assert!(entries.iter().all(|entry| !entry.intersects(word.place)), "{} at {}", word.text, word.place);
    }
}

#[test]
fn the_same_layout_is_the_same_whatever_was_before() {
    for size in WINDOWS {
        let mut harness = harness_in(inspector(z_fail(SIZE)), size);
        let mut places = || {
            choose_view(&mut harness, "Teach");
            harness.run_steps(4);
            ["Picture", "Pixel", "Passes"].map(|name| panel(&harness, name).expect("a panel"))
        };
        let first = places();
        assert_eq!(places(), first, "{size:?}");
    }
}
