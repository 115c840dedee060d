//! Docking: wherever a tab is dropped, every panel stays, under its own name, large enough to be used.

use super::*;
use crate::common::random::Random;
use stencilscope::capture::Origin;
use stencilscope::inspector::{PanelKind, StoredSettings, WindowPlace};

/// The least width and height that a panel may be given by hand or by a drop, points.
const LEAST: [f32; 2] = [96.0, 48.0];

fn titles() -> Vec<String> {
    let mut titles: Vec<String> = PanelKind::ALL.iter().map(|panel| panel.title().to_owned()).collect();
    titles.sort_unstable();
    titles
}

/// Titles and places of all tabs, those that are scrolled away too.
fn tabs(harness: &Harness<Seen>) -> Vec<(String, Rect)> {
    of_role(harness, Role::Tab)
}

/// Names and places of the panels that are shown.
fn shown(harness: &Harness<Seen>) -> Vec<(String, Rect)> {
    of_role(harness, Role::TabPanel)
}

fn of_role(harness: &Harness<Seen>, role: Role) -> Vec<(String, Rect)> {
    let name = |node: &egui_kittest::Node| node.accesskit_node().label().unwrap_or_default();
    harness.query_all_by_role(role).map(|node| (name(&node), node.rect())).collect()
}

pub fn drag_tab(harness: &mut Harness<Seen>, from: Pos2, to: Pos2) {
    harness.drag_at(from);
    harness.run_steps(2);
    harness.hover_at(from + (to - from) * 0.5);
    harness.run_steps(2);
    harness.hover_at(to);
    harness.run_steps(3);
    harness.drop_at(to);
    harness.run_steps(4);
}

#[track_caller]
fn assert_usable(harness: &Harness<Seen>, context: &str) {
    let mut names: Vec<String> = tabs(harness).into_iter().map(|(name, _)| name).collect();
    names.sort_unstable();
    assert_eq!(names, titles(), "{context}");
    let window = harness.ctx.content_rect();
    let panels = shown(harness);
    assert!(!panels.is_empty(), "{context}");
    for (name, place) in &panels {
        let is_large = place.width() >= LEAST[0] && place.height() >= LEAST[1];
        assert!(is_large && window.contains_rect(*place), "{name} is at {place} of {window}: {context}");
    }
    for (index, (name, place)) in panels.iter().enumerate() {
        let others = panels[..index].iter().filter(|(_, other)| place.shrink(1.0).intersects(other.shrink(1.0)));
        assert_eq!(others.count(), 0, "{name} lies over another: {context}");
    }
}

#[test]
fn a_dropped_panel_shares_the_place_where_it_is_dropped() {
    let mut harness = harness(z_fail(SIZE));
    let place = |harness: &Harness<Seen>, name: &str| {
        shown(harness).into_iter().find(|(of, _)| of == name).map(|(_, place)| place).expect("it is shown")
    };
    let before = place(&harness, "Pixel");
    let from = harness.get_by_role_and_label(Role::Tab, "State").rect().center();
    // Into the lower half of the group it is of.
    drag_tab(&mut harness, from, pos2(before.center().x, before.bottom() - before.height() / 4.0));
    assert_usable(&harness, "State below Pixel");
    let [pixel, state] = ["Pixel", "State"].map(|name| place(&harness, name));
    assert!(state.top() > pixel.bottom() && (state.height() - pixel.height()).abs() < 4.0, "{pixel}, {state}");
    // To the left edge of the window.
    let from = harness.get_by_role_and_label(Role::Tab, "Report").rect().center();
    let passes = place(&harness, "Passes");
    drag_tab(&mut harness, from, pos2(passes.left() + 2.0, passes.center().y));
    assert_usable(&harness, "Report beside Passes");
    assert!(place(&harness, "Report").width() > 120.0, "{}", place(&harness, "Report"));
}

#[test]
fn wherever_tabs_are_dropped_and_borders_are_dragged_every_panel_stays_and_can_be_used() {
    for seed in 0..8 {
        let mut random = Random::new(seed);
        let mut harness = harness(z_fail(SIZE));
        let window = harness.ctx.content_rect();
        for turn in 0..25 {
            let mut within = |rect: Rect| {
                let [x, y] = [random.unit(), random.unit()].map(|unit| unit as f32);
                rect.lerp_inside(vec2(x, y))
            };
            let to = within(window.shrink(1.0));
            let panels = shown(&harness);
            let in_view: Vec<(String, Rect)> =
                tabs(&harness).into_iter().filter(|(_, place)| window.contains_rect(*place)).collect();
            let context = if turn % 5 == 3 {
                // A whole group, by the end of its bar of tabs.
                let (name, place) = &panels[random.below(panels.len() as u32) as usize];
                drag_tab(&mut harness, place.right_top() + vec2(-4.0, -14.0), to);
                format!("seed {seed}, turn {turn}: the group of {name} to {to}")
            } else if turn % 5 == 4 {
                // A border: between a panel and what is beside or below it.
                let (name, place) = &panels[random.below(panels.len() as u32) as usize];
                let border = if turn % 2 == 0 { place.right_center() } else { place.center_bottom() } + vec2(0.5, 0.5);
                drag_tab(&mut harness, border, to);
                format!("seed {seed}, turn {turn}: a border of {name} to {to}")
            } else {
                let (name, place) = &in_view[random.below(in_view.len() as u32) as usize];
                drag_tab(&mut harness, place.center(), to);
                format!("seed {seed}, turn {turn}: {name} to {to}")
            };
            assert_usable(&harness, &context);
        }
        // A small window for a while changes nothing for good, and the next run finds all where it was.
        let before = (harness.state().inspector.remembered(), shown(&harness));
        harness.set_size(vec2(560.0, 420.0));
        harness.run_steps(3);
        harness.set_size(window.size());
        harness.run_steps(3);
        assert_eq!((harness.state().inspector.remembered(), shown(&harness)), before, "seed {seed}");
        let mut again = inspector(z_fail(SIZE));
        again.recall(before.0);
        let mut places = [shown(&harness_of(again)), before.1];
        places.iter_mut().for_each(|places| places.sort_by(|a, b| a.0.cmp(&b.0)));
        let names = |places: &[(String, Rect)]| places.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&places[0]), names(&places[1]), "seed {seed}");
        for ((name, place), (_, expected)) in places[0].iter().zip(&places[1]) {
            assert!((place.center() - expected.center()).length() < 1.5, "seed {seed}: {name}: {place}, {expected}");
        }
    }
}

/// As a program before this one stored it: a panel a point wide, and a group in a tab.
#[test]
fn a_layout_that_was_broken_before_is_fixed_when_it_is_opened() {
    let pane = |panel: &str| serde_json::json!({ "Pane": panel });
    let tabs = |children: &[u64]| serde_json::json!({ "Container": { "Tabs": { "children": children, "active": children[0] } } });
    let row = |children: &[u64], shares: serde_json::Value| {
        serde_json::json!({ "Container": { "Linear": {
            "children": children, "dir": "Horizontal", "shares": { "shares": shares } } } })
    };
    let stored = serde_json::json!({
        "id": 1, "root": 20, "height": null, "width": null,
        "tiles": { "next_tile_id": 40, "invisible": [], "tiles": {
            "1": pane("Passes"), "2": pane("Settings"), "3": pane("Picture"), "4": pane("Scene"),
            "5": pane("ShadowMap"), "6": pane("Pixel"), "7": pane("State"), "8": pane("Explain"),
            "9": pane("Report"), "10": pane("Diagnosis"), "11": pane("Stress"),
            "20": row(&[21, 22, 23], serde_json::json!({ "21": 264.0, "22": 700.0, "23": 1.0 })),
            "21": tabs(&[1, 2]), "22": tabs(&[30, 5, 6]), "23": tabs(&[7, 8, 9, 10, 11]),
            "30": row(&[31, 32], serde_json::json!({})), "31": tabs(&[3]), "32": tabs(&[4]),
        } }
    });
    let mut inspector: Inspector = inspector(z_fail(SIZE));
    inspector.recall(StoredSettings { layout: Some(stored), ..StoredSettings::default() });
    let harness = harness_of(inspector);
    assert!(harness.state().inspector.remembered().layout.is_some(), "it is taken");
    assert_usable(&harness, "mended");
}

#[test]
fn the_window_of_keys_stands_still() {
    for size in [[1280.0, 800.0], [1920.0, 1080.0], [640.0, 400.0]] {
        let mut harness = harness_in(inspector(z_fail(SIZE)), size);
        press(&mut harness, Key::F1);
        let close = |harness: &Harness<Seen>| harness.get_by_role_and_label(Role::Button, "Close help").rect();
        let first = close(&harness);
        for _ in 0..40 {
            harness.run_steps(1);
            assert_eq!(close(&harness), first, "{size:?}");
        }
        assert!(harness.ctx.content_rect().contains_rect(first), "{first} of {size:?}");
    }
}

#[test]
fn in_a_wide_window_the_scene_is_beside_the_picture_until_the_user_arranges_panels() {
    let panels = |harness: &Harness<Seen>| {
        let is_there = |name| harness.query_by_role_and_label(Role::TabPanel, name).is_some();
        [is_there("Picture"), is_there("Scene"), is_there("Shadow map")]
    };
    let mut harness = harness_in(inspector(z_fail(SIZE)), [2560.0, 1440.0]);
    assert_eq!(panels(&harness), [true, true, false]);
    let [picture, pixel] =
        ["Picture", "Pixel"].map(|name| harness.get_by_role_and_label(Role::TabPanel, name).rect().width());
    assert!(picture > 800.0 && (pixel - 332.0).abs() < 8.0, "{picture}, {pixel}");
    harness.set_size(vec2(1440.0, 900.0));
    harness.run_steps(3);
    assert_eq!(panels(&harness), [true, false, false]);
}

#[test]
fn a_tab_is_drawn_once_more_when_it_is_shown_as_it_knows_its_width_by_then() {
    let mut harness = harness_of(inspector(z_fail(SIZE)));
    harness.get_by_role_and_label(Role::Tab, "Explain").click();
    harness.step();
    let delay = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert_eq!(delay, std::time::Duration::ZERO);
}

/// On a phone the picture is as wide as the window, and all else is in tabs below it.
#[test]
fn a_narrow_window_has_its_panels_below_the_picture() {
    for size in [[390.0, 844.0], [360.0, 640.0], [600.0, 800.0]] {
        let mut harness = harness_in(inspector(z_fail(SIZE)), size);
        harness.run_steps(2);
        assert_usable(&harness, &format!("{size:?}"));
        let panels = shown(&harness);
        let names: Vec<&str> = panels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["Picture", "Passes"], "{size:?}");
        assert!(panels.iter().all(|(_, place)| place.width() >= size[0] - 20.0), "{size:?}");
        assert!(panels[0].1.height() >= 0.4 * size[1], "{size:?}");
    }
    let mut harness = harness_in(inspector(z_fail(SIZE)), [390.0, 844.0]);
    let below = |harness: &Harness<Seen>| shown(harness).pop().map(|(name, _)| name);
    // What is picked is said at once, and does not keep another tab away.
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([3, 4]));
    assert_eq!(below(&harness).as_deref(), Some("Pixel"));
    show_tab(&mut harness, "Passes");
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([4, 4]));
    assert_eq!(below(&harness).as_deref(), Some("Passes"));
    // A wider window is as it always was, also as the user has arranged it before.
    harness.set_size(vec2(1280.0, 800.0));
    harness.run_steps(4);
    assert_eq!(shown(&harness).len(), 4);
    let tab = |harness: &Harness<Seen>, title: &str| {
        tabs(harness).into_iter().find(|(name, _)| name == title).expect("a tab").1.center()
    };
    let (from, to) = (tab(&harness, "Stress"), tab(&harness, "Passes"));
    drag_tab(&mut harness, from, to);
    let arranged = harness.state().inspector.remembered();
    let places = tabs(&harness);
    harness.set_size(vec2(390.0, 844.0));
    harness.run_steps(4);
    assert_eq!(shown(&harness).len(), 2);
    assert_eq!(harness.state().inspector.remembered(), arranged, "what is stored is the wider one's");
    harness.set_size(vec2(1280.0, 800.0));
    harness.run_steps(4);
    assert_eq!(tabs(&harness), places);
}

/// No tool over the picture and none in the bar above is cut off at the window's edge, whatever is shown.
#[test]
fn tools_that_find_no_space_wrap_or_become_a_list() {
    for (size, place) in [
        ([390.0, 844.0], WindowPlace::Page),
        ([740.0, 600.0], WindowPlace::Page),
        ([800.0, 600.0], WindowPlace::Page),
        ([1000.0, 700.0], WindowPlace::Desktop),
        ([1280.0, 800.0], WindowPlace::Desktop),
    ] {
        let mut harness = harness_in(inspector(z_fail(SIZE)), size);
        change(&mut harness, |inspector| inspector.model.place = place);
        harness.run_steps(2);
        click(&mut harness, "Compare");
        change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Stencil));
        change(&mut harness, |inspector| inspector.set_zoom(TexelZoom::Pixels(3.0), [20.0, 15.0]));
        let panel = harness.get_by_role_and_label(Role::TabPanel, "Picture").rect();
        for tool in [
            "Compare",
            "Overlay",
            "Before",
            "After",
            "Diff",
            "Bits of the stencil",
            "Compare with",
            "Layout of the comparison",
            "Fit",
            "Walk",
        ] {
            let place = rect(&harness, tool);
            assert!(panel.contains_rect(place), "{tool} is at {place} of {panel}");
        }
        assert_tools(&mut harness, size[0] >= 792.0);
    }
    // What stands in the bar in place of the techniques gives way.
    for width in [390.0, 740.0, 800.0, 900.0] {
        let mut recorded = z_fail(SIZE);
        recorded.origin = Some(Origin {
            program: None,
            api: "OpenGL".to_owned(),
            depth_format: "D24S8".to_owned(),
            recorder: "RenderDoc".to_owned(),
            limits: Vec::new(),
        });
        let mut inspector = inspector(recorded);
        inspector.model.scene = None;
        assert_tools(&mut harness_in(inspector, [width, 700.0]), width >= 792.0);
    }
}

/// All tools in the bar at the top lie in the window, in a menu unless it is wide.
#[track_caller]
fn assert_tools(harness: &mut Harness<Seen>, is_wide: bool) {
    harness.run_steps(2);
    assert_eq!(harness.query_by_label("Help").is_some(), is_wide);
    let window = harness.ctx.content_rect();
    if !is_wide {
        assert!(window.contains_rect(rect(harness, "More")));
        click_button(harness, "More");
    }
    for tool in ["Undo", "Redo", "Export", "View", "Help"] {
        let place = rect(harness, tool);
        assert!(window.contains_rect(place), "{tool} is at {place} of {window}");
    }
}
