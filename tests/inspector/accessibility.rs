//! Every panel, menu and dialog for someone who sees or points at nothing: each widget that can be
//! operated has a name of its own, and Tab comes to it.

use super::diagnosis::{found, give_diagnosis};
use super::stress::rows;
use super::*;
use crate::common::report::one_scene;
use egui::accesskit::{self, NodeId};
use egui_kittest::Node;
use stencilscope::ask::StressOf;
use stencilscope::inspector::PanelKind;
use stencilscope::report::MeasuredReport;
use stencilscope::stress::StressRows;

const TORI: [u32; 2] = [64, 48];
/// More widgets than are shown at a time.
const MOST_TABS: usize = 600;

/// What opens a menu or a dialog.
type Opens<'a> = &'a dyn Fn(&mut Harness<Seen>);

/// Tabs that are shown together: every one is shown once.
const ARRANGEMENTS: [&[&str]; 3] = [
    &["Passes", "Picture", "Pixel", "Report"],
    &["Scene settings", "Scene", "State", "Diagnosis"],
    &["Shadow map", "Explain", "Stress"],
];

/// The panels over a real frame, with everything that can be known of it.
pub fn known(technique: Technique) -> Inspector {
    let mut session = common::session();
    let mut frame = common::frame(&mut session, "tori", common::request(technique, TORI));
    let judged = session.judged(frame.scene().expect("a scene"), &frame.capture, &Progress::default());
    frame.capture = Arc::new(judged.expect("a truth"));
    let pick = [TORI[0] / 2, TORI[1] * 2 / 3];
    let history = session.history(&frame.plan, &frame.capture, pick).expect("a history");
    let mut inspector = pictures::inspector(&frame, pick);
    inspector.set_plan(frame.plan.clone());
    inspector.take_in(HistoryOf { at: pick }, Ok(Arc::new(history)));
    inspector.take_in(AnatomyOf {}, Ok(pictures::anatomy(&mut session, &frame)));
    let measured = MeasuredReport { report: one_scene(), left_out: Vec::new(), is_whole: true };
    inspector.take_in(ReportOf::grid().expect("a grid"), Ok(Arc::new(measured)));
    give_diagnosis(&mut inspector, found());
    let nested = StressRows::new(rows("nested", |_, _| 0));
    inspector.take_in(StressOf { cases: Vec::new() }, Ok(Arc::new(nested)));
    inspector
}

fn nodes<'a>(harness: &'a Harness<Seen>) -> impl Iterator<Item = Node<'a>> {
    harness.root().children_recursive()
}

fn id_of(node: &Node) -> NodeId {
    node.accesskit_node().locate().0
}

fn name_of(node: &Node) -> String {
    node.accesskit_node().label().unwrap_or_default()
}

/// The docking library's own: bars that tabs stand on, and the lines between tiles; and egui's scroll bars. They
/// have no names; what they do by mouse is done by the keys of tabs, and by what has the focus.
fn is_of_library(node: &Node) -> bool {
    const TAB_BAR: f32 = 28.0;
    const HANDLE: f32 = 6.5;
    let size = node.rect().size();
    match node.accesskit_node().role() {
        Role::ScrollBar => true,
        Role::Unknown => size.min_elem() <= HANDLE || (size.y == TAB_BAR && size.x > 200.0),
        _ => false,
    }
}

/// Can it be pressed, dragged, typed into or chosen?
fn is_operable(node: &Node) -> bool {
    let whole = node;
    let node = node.accesskit_node();
    let acts = [accesskit::Action::Click, accesskit::Action::Focus, accesskit::Action::SetValue]
        .into_iter()
        .any(|action| node.data().supports_action(action));
    acts && node.role() != Role::Label && !node.is_disabled() && !node.is_hidden() && !is_of_library(whole)
}

fn in_words(node: &Node) -> String {
    format!("{:?} “{}” at {:?}", node.accesskit_node().role(), name_of(node), node.rect())
}

/// Widgets without a name.
fn unnamed(harness: &Harness<Seen>) -> Vec<String> {
    nodes(harness)
        .filter(|node| is_operable(node) && name_of(node).trim().is_empty())
        .map(|node| in_words(&node))
        .collect()
}

/// Buttons, fields and the like that role and name don't distinguish.
fn ambiguous(harness: &Harness<Seen>) -> Vec<String> {
    let mut seen = BTreeMap::<String, usize>::new();
    for node in nodes(harness).filter(is_operable) {
        let role = node.accesskit_node().role();
        if matches!(role, Role::Button | Role::CheckBox | Role::Slider | Role::SpinButton | Role::TextInput | Role::Tab)
        {
            *seen.entry(format!("{role:?} “{}”", name_of(&node))).or_default() += 1;
        }
    }
    seen.into_iter().filter(|(_, count)| *count > 1).map(|(name, count)| format!("{count} × {name}")).collect()
}

fn focused(harness: &Harness<Seen>) -> Option<NodeId> {
    nodes(harness).find(|node| node.accesskit_node().is_focused()).map(|node| id_of(&node))
}

/// What can be clicked, but Tab does not come to it.
fn unreachable(harness: &mut Harness<Seen>) -> Vec<String> {
    let mut reached = BTreeSet::new();
    for _ in 0..MOST_TABS {
        harness.key_press(Key::Tab);
        harness.run_steps(1);
        match focused(harness) {
            Some(id) if !reached.insert(id.0) => break,
            _ => {}
        }
    }
    let is_missed = |node: &Node| {
        let clicks = node.accesskit_node().data().supports_action(accesskit::Action::Click);
        clicks && is_operable(node) && !reached.contains(&id_of(node).0)
    };
    nodes(harness).filter(is_missed).map(|node| in_words(&node)).collect()
}

fn show(harness: &mut Harness<Seen>, tabs: &[&str]) {
    for tab in tabs {
        show_tab(harness, tab);
    }
    harness.remove_cursor();
    harness.run_steps(3);
}

#[test]
fn every_widget_of_every_panel_has_a_name_of_its_own_and_tab_comes_to_it() {
    let mut wrong = Vec::new();
    for technique in [Technique::ZFail, Technique::ShadowMap] {
        for tabs in ARRANGEMENTS {
            let mut harness = harness_of(known(technique));
            show(&mut harness, tabs);
            let mut found = |what: &str, list: Vec<String>| {
                wrong.extend(list.into_iter().map(|one| format!("{technique:?} {tabs:?} {what}: {one}")));
            };
            found("no name", unnamed(&harness));
            found("same name", ambiguous(&harness));
            found("not reached by Tab", unreachable(&mut harness));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_menus_and_dialogs_hold_has_names() {
    let dialogs: [(&str, Opens); 9] = [
        ("open", &|harness| click_button(harness, "Open…")),
        ("export", &|harness| {
            press_with(harness, Modifiers::COMMAND, Key::S);
        }),
        ("help", &|harness| click_button(harness, "Help")),
        ("export menu", &|harness| click_button(harness, "Export")),
        ("recent", &|harness| click_button(harness, "What is open: tori")),
        ("overlays", &|harness| press(harness, Key::O)),
        ("go to", &|harness| {
            press_with(harness, Modifiers::COMMAND, Key::G);
        }),
        ("find", &|harness| {
            press_with(harness, Modifiers::COMMAND, Key::F);
        }),
        ("compare", &|harness| {
            change(harness, |inspector| inspector.compare_with(Technique::ShadowMap));
        }),
    ];
    let mut wrong = Vec::new();
    for (name, open) in dialogs {
        let mut harness = harness_of(known(Technique::ZFail));
        let before = nodes(&harness).count();
        open(&mut harness);
        harness.run_steps(3);
        assert_ne!(nodes(&harness).count(), before, "{name} is open");
        wrong.extend(unnamed(&harness).into_iter().map(|one| format!("{name}: no name: {one}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn tab_goes_on_from_the_picture_and_shift_tab_goes_back() {
    let mut harness = harness(z_fail(SIZE));
    focus(&mut harness, "Picture canvas");
    let picture = focused(&harness);
    for modifiers in [Modifiers::NONE, Modifiers::SHIFT] {
        press_with(&mut harness, modifiers, Key::Tab);
        assert!(harness.query_by_label_contains("Walking:").is_none(), "the pointer is elsewhere");
        assert_eq!(focused(&harness) == picture, modifiers == Modifiers::SHIFT);
    }
}

/// Moves the focus to a widget, as Tab does.
fn focus_on(harness: &mut Harness<Seen>, role: Role, label: &str) -> NodeId {
    harness.get_by_role_and_label(role, label).focus();
    harness.run_steps(2);
    focused(harness).expect("the focus")
}

#[test]
fn arrows_step_whatever_button_has_the_focus_and_leave_it_there() {
    let mut harness = harness(z_fail(SIZE));
    for (role, label) in [(Role::Canvas, "Picture canvas"), (Role::Button, "Depth"), (Role::Tab, "Explain")] {
        press(&mut harness, Key::End);
        let before = focus_on(&mut harness, role, label);
        press(&mut harness, Key::ArrowLeft);
        assert_eq!((harness.state().inspector.model.selection.step, focused(&harness)), (1, Some(before)), "{label}");
    }
}

#[test]
fn what_arrows_move_itself_keeps_them() {
    let mut harness = harness(cube_map());
    show(&mut harness, &["Shadow map"]);
    focus_on(&mut harness, Role::Canvas, "Shadow map canvas");
    press(&mut harness, Key::ArrowLeft);
    assert_eq!(harness.state().inspector.model.selection.step, 3, "the texel moves");
    harness.get_by_role_and_label(Role::Button, "Clear");
}

#[test]
fn space_plays_and_t_animates_while_the_picture_has_the_focus_and_space_presses_a_button() {
    let mut harness = harness(z_fail(SIZE));
    focus_on(&mut harness, Role::Canvas, "Picture canvas");
    press(&mut harness, Key::Space);
    assert!(harness.state().inspector.model.selection.playing.is_some());
    press(&mut harness, Key::Space);
    assert!(harness.state().inspector.model.selection.playing.is_none());
    focus_on(&mut harness, Role::Button, "Depth");
    press(&mut harness, Key::Space);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Depth));
    assert!(harness.state().inspector.model.selection.playing.is_none());
}

#[test]
fn escape_leaves_a_field_or_a_button_before_it_takes_the_pick_away() {
    let mut harness = picked(z_fail(SIZE), [3, 4]);
    focus_on(&mut harness, Role::Button, "Depth");
    press(&mut harness, Key::Escape);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([3, 4]));
    press_with(&mut harness, Modifiers::COMMAND, Key::F);
    press(&mut harness, Key::Escape);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([3, 4]));
    press(&mut harness, Key::Escape);
    assert_eq!(harness.state().inspector.model.selection.pick, None);
}

#[test]
fn tab_goes_from_left_to_right_in_every_row_of_tools() {
    let mut harness = harness(z_fail(SIZE));
    for row in [&["Undo", "Redo", "Export", "Tours", "View", "Help"][..], &["Walk", "Gizmos", "1:1", "Fit", "Compare"]]
    {
        let there: Vec<&str> = row.iter().copied().filter(|label| !is_disabled(&harness, label)).collect();
        focus_on(&mut harness, Role::Button, there[0]);
        for label in &there[1..] {
            press(&mut harness, Key::Tab);
            let expected = id_of(&harness.get_by_role_and_label(Role::Button, label));
            assert_eq!(focused(&harness), Some(expected), "{label}");
        }
    }
}

/// The names of the widgets that can't be pressed now, and say nothing when the pointer is over them.
fn silent(harness: &mut Harness<Seen>) -> (BTreeSet<String>, usize) {
    // What is scrolled away is under no pointer.
    let seen: Vec<(Rect, Rect)> = harness.ctx.viewport(|viewport| {
        let widgets = viewport.prev_pass.widgets.layers().flat_map(|(_, widgets)| widgets);
        widgets.map(|widget| (widget.rect, widget.interact_rect)).collect()
    });
    let is_seen = |rect: Rect| seen.iter().any(|(of, seen)| *of == rect && seen.contains(rect.center()));
    let disabled: Vec<(String, Rect)> = nodes(harness)
        .filter(|node| node.accesskit_node().is_disabled() && node.accesskit_node().bounding_box().is_some())
        .filter(|node| {
            let role = node.accesskit_node().role();
            [Role::Button, Role::CheckBox, Role::ComboBox, Role::SpinButton].contains(&role)
        })
        .map(|node| (name_of(&node), node.rect()))
        .filter(|(_, rect)| is_seen(*rect))
        .collect();
    let count = disabled.len();
    let mut silent = BTreeSet::new();
    for (name, rect) in disabled {
        harness.remove_cursor();
        harness.run_steps(2);
        let before = nodes(harness).count();
        harness.hover_at(rect.center());
        harness.run_steps(5);
        if nodes(harness).count() <= before {
            silent.insert(name);
        }
    }
    (silent, count)
}

#[test]
fn whatever_can_not_be_pressed_says_why() {
    let mut found = BTreeSet::new();
    let mut looked_at = 0;
    let mut unlabelled = z_fail(SIZE);
    unlabelled.lights[0].shadow = None;
    let mut of_folder = inspector(unlabelled.clone());
    of_folder.open_folder(None);
    of_folder.set_capture(Arc::new(unlabelled.clone()));
    for inspector in [Inspector::default(), of_folder, inspector(unlabelled), known(Technique::ZFail)] {
        let mut harness = harness_in(inspector, [1440.0, 900.0]);
        for panel in PanelKind::ALL {
            show_tab(&mut harness, panel.title());
            let (silent, count) = silent(&mut harness);
            found.extend(silent.into_iter().map(|name| format!("{}: {name}", panel.title())));
            looked_at += count;
        }
        change(&mut harness, |inspector| drop(inspector.go_to_stop(Technique::RayTraced, 0)));
        found.extend(silent(&mut harness).0);
    }
    assert!(looked_at > 30, "{looked_at} were looked at");
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn a_greyed_kind_of_picture_says_why_it_is_not_there() {
    let mut capture = z_fail(SIZE);
    capture.lights[0].shadow = None;
    let mut harness = harness_of(inspector(capture));
    assert!(is_disabled(&harness, "Error"));
    harness.get_by_role_and_label(Role::Button, "Error").hover();
    harness.run_steps(8);
    harness.get_by_label("This frame says of no light where it is blocked");
}
