//! The panels, driven by the names of their widgets, over a frame made by hand.

mod accessibility;
mod as_shown;
mod by_hand;
mod cards;
mod compared;
mod contrast;
mod counts;
mod cut_off;
mod decided_by;
mod diagnosis;
mod differing;
mod docking;
mod draws;
mod explain;
mod films;
mod follows_steps;
mod gizmos;
mod history;
mod history_by_hand;
mod history_pictures;
mod layers;
mod layout_pictures;
mod making;
mod mode_pictures;
mod never_cut;
mod one_state;
mod opening;
mod overlays;
mod picture_modes;
mod pictures;
mod random_input;
mod recorded;
mod report;
mod scene_depth;
mod scene_view;
mod settings;
mod shadow_map;
mod shell;
mod stress;
mod tour_marks;
mod truth;
mod view_menu;
mod walk;
mod window_picture;
mod written;

use crate::common;
use by_hand::{cube_map, z_fail};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use egui_wgpu::ScreenDescriptor;
use glam::DVec3;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use stencilscope::ask::{AnatomyOf, Answer, Ask, HistoryOf, PendingQuestion, Question, ReportOf, RunRequest, TruthOf};
use stencilscope::capture::{Capture, Image, PixelFormat};
use stencilscope::inspector::{Action, ExportData, ExportKind, Inspector, SceneEntry};
use stencilscope::offscreen::OffscreenPainter;
use stencilscope::picture::Picture;
use stencilscope::plan::DrawPart;
use stencilscope::progress::Progress;
use stencilscope::reading::picture_view::{PictureKind, TexelZoom};
use stencilscope::scene::{OpenSpec, Scene, open};
use stencilscope::session::{CaptureRequest, RunFrame, Session};
use stencilscope::technique::{Choice, Technique};
use window_picture::{TextureCollector, UndrawnTextures, painter, window_picture};

const SIZE: [u32; 2] = [40, 30];
/// The window that most tests look at, points.
const WINDOW: [f32; 2] = [1280.0, 800.0];
/// A window that shows all of a long panel, points.
const TALL: [f32; 2] = [1280.0, 2000.0];

/// What a test looks at: the panels, and everything they asked for.
struct Seen {
    inspector: Inspector,
    actions: Vec<Action>,
    /// What was asked that follows from the capture, where a test answers itself.
    asked: Option<Vec<PendingQuestion>>,
    /// Changes of egui's textures that no picture has drawn yet.
    textures: Rc<RefCell<UndrawnTextures>>,
    /// What pictures are drawn with, once there was one.
    painter: Option<OffscreenPainter>,
}

fn run_request(technique: Technique) -> RunRequest {
    RunRequest::of(&scene(), Choice::new(technique), SIZE)
}

fn scene() -> Scene {
    Scene { name: "by hand".to_owned(), ..common::from_above(Vec::new()) }
}

fn inspector(capture: Capture) -> Inspector {
    let entry = |name: &str| SceneEntry { name: name.to_owned(), lesson: format!("what {name} teaches") };
    let mut inspector = Inspector::new(vec![entry("tori"), entry("table")]);
    inspector.set_scene(&scene(), run_request(Technique::ZFail));
    inspector.set_capture(Arc::new(capture));
    inspector
}

/// The panels in a window of the size that most tests look at.
fn harness_of(inspector: Inspector) -> Harness<'static, Seen> {
    harness_in(inspector, WINDOW)
}

fn harness_in(inspector: Inspector, size: [f32; 2]) -> Harness<'static, Seen> {
    let textures = Rc::<RefCell<UndrawnTextures>>::default();
    let collector = TextureCollector(Rc::clone(&textures));
    let seen = Seen { inspector, actions: Vec::new(), asked: None, textures, painter: None };
    let ui = |ui: &mut egui::Ui, seen: &mut Seen| {
        for action in seen.inspector.ui(ui) {
            match action {
                // Whether the frame is timed is seen in no panel.
                Action::Ask(PendingQuestion { ask: Ask::TimingOf(_), .. }) => {}
                Action::Ask(asked) if asked.ask.kind().is_read_from_capture() => match &mut seen.asked {
                    Some(questions) => questions.push(asked),
                    None => {
                        let result = found(&seen.inspector, &asked);
                        seen.inspector.answer(asked.ticket, result, true);
                    }
                },
                action => seen.actions.push(action),
            }
        }
    };
    let mut harness =
        Harness::builder().with_size(size).with_max_steps(32).renderer(collector).build_ui_state(ui, seen);
    harness.run_steps(3);
    harness
}

/// The answer to what follows from the capture.
fn found(inspector: &Inspector, asked: &PendingQuestion) -> Result<Answer, String> {
    asked.ask.read_from(inspector.model.frame.capture.as_ref().expect("a frame"), inspector.model.frame.plan.as_ref())
}

fn rect(harness: &Harness<Seen>, label: &str) -> Rect {
    harness.get_by_label(label).rect()
}

/// What was asked, in order.
fn asks<Q: Question>(harness: &Harness<Seen>) -> Vec<Q> {
    let of = |action: &Action| if let Action::Ask(asked) = action { Q::of(&asked.ask).cloned() } else { None };
    harness.state().actions.iter().filter_map(of).collect()
}

/// What was asked last of its kind.
fn last_asked<Q: Question>(harness: &Harness<Seen>) -> PendingQuestion {
    let of = |action: &Action| match action {
        Action::Ask(asked) => Q::of(&asked.ask).map(|_| asked.clone()),
        _ => None,
    };
    harness.state().actions.iter().rev().find_map(of).expect("it is asked for")
}

/// Answers what was asked last of a kind.
fn reply<Q: Question>(harness: &mut Harness<Seen>, result: Result<Q::Answer, String>) {
    let asked = last_asked::<Q>(harness);
    let result = result.map(|answer| Q::into_answer(Arc::new(answer)));
    harness.state_mut().inspector.answer(asked.ticket, result, true);
    harness.run_steps(2);
}

/// The panels over a capture folder.
fn of_folder() -> Harness<'static, Seen> {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.open_folder(None);
    harness_of(inspector)
}

fn harness(capture: Capture) -> Harness<'static, Seen> {
    harness_of(inspector(capture))
}

/// The panels over a capture of which a pixel is picked.
fn picked(capture: Capture, at: [u32; 2]) -> Harness<'static, Seen> {
    let mut inspector = inspector(capture);
    inspector.model.selection.pick = Some(at);
    harness_of(inspector)
}

/// Every run that was asked for, in order.
fn runs(harness: &Harness<Seen>) -> Vec<RunRequest> {
    let run = |action: &Action| match action {
        Action::Run(request) => Some(RunRequest::clone(request)),
        _ => None,
    };
    harness.state().actions.iter().filter_map(run).collect()
}

fn last_run(harness: &Harness<Seen>) -> RunRequest {
    runs(harness).pop().expect("a run was asked for")
}

/// Does any widget's name contain these words?
fn says(harness: &Harness<Seen>, words: &str) -> bool {
    harness.query_all_by_label_contains(words).next().is_some()
}

/// Changes what the panels look at, as the app does.
fn change(harness: &mut Harness<Seen>, change: impl FnOnce(&mut Inspector)) {
    change(&mut harness.state_mut().inspector);
    harness.run_steps(3);
}

/// Another frame is there.
fn show_capture(harness: &mut Harness<Seen>, capture: Capture) {
    change(harness, |inspector| inspector.set_capture(Arc::new(capture)));
}

fn press(harness: &mut Harness<Seen>, key: Key) {
    press_with(harness, Modifiers::NONE, key);
}

fn press_with(harness: &mut Harness<Seen>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(2);
}

/// Types a number into a field.
fn set_value(harness: &mut Harness<Seen>, label: &str, value: f64) {
    harness.get_by_role_and_label(Role::SpinButton, label).set_value_accesskit(value);
    harness.run_steps(2);
}

fn focus(harness: &mut Harness<Seen>, label: &str) {
    harness.get_by_label(label).focus();
    harness.run_steps(2);
}

fn focus_role(harness: &mut Harness<Seen>, role: Role, label: &str) {
    harness.get_by_role_and_label(role, label).focus();
    harness.run_steps(2);
}

/// Shows a panel by its tab. It has its sizes a frame after it is shown, and asks for what it shows.
fn show_tab(harness: &mut Harness<Seen>, title: &str) {
    harness.get_by_role_and_label(Role::Tab, title).click();
    harness.run_steps(4);
}

fn click(harness: &mut Harness<Seen>, label: &str) {
    harness.get_by_label(label).click();
    harness.run_steps(2);
}

/// Is the button of this name there, and not to be pressed?
fn is_disabled(harness: &Harness<Seen>, label: &str) -> bool {
    harness.get_by_role_and_label(Role::Button, label).accesskit_node().is_disabled()
}

fn click_role(harness: &mut Harness<Seen>, role: Role, label: &str) {
    harness.get_by_role_and_label(role, label).click();
    harness.run_steps(2);
}

fn click_button(harness: &mut Harness<Seen>, label: &str) {
    click_role(harness, Role::Button, label);
}

/// The middle of a texel on the screen while the whole picture fits.
fn place_of(harness: &Harness<Seen>, texel: [u32; 2], size: [u32; 2]) -> Pos2 {
    let canvas = harness.get_by_label("Picture canvas").rect();
    let scale = (canvas.width() / size[0] as f32).min(canvas.height() / size[1] as f32);
    let whole = vec2(size[0] as f32, size[1] as f32);
    canvas.center() + (vec2(texel[0] as f32 + 0.5, texel[1] as f32 + 0.5) - whole / 2.0) * scale
}

fn button_event(pos: Pos2, button: PointerButton, pressed: bool) -> Event {
    Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE }
}

fn mouse(harness: &mut Harness<Seen>, at: Pos2, button: PointerButton) {
    harness.hover_at(at);
    harness.run_steps(1);
    for pressed in [true, false] {
        harness.event(button_event(at, button, pressed));
    }
    harness.run_steps(3);
}

/// Picks a texel with the right button while the whole picture fits.
fn pick_by_mouse(harness: &mut Harness<Seen>, texel: [u32; 2], size: [u32; 2]) {
    let at = place_of(harness, texel, size);
    mouse(harness, at, PointerButton::Secondary);
}

/// Presses the left button at a place, so that moves drag from there.
fn press_left(harness: &mut Harness<Seen>, at: Pos2) {
    harness.hover_at(at);
    harness.run_steps(1);
    harness.event(button_event(at, PointerButton::Primary, true));
    harness.run_steps(1);
}

/// Presses at a place, moves, and lets go.
fn drag(harness: &mut Harness<Seen>, from: Pos2, by: Vec2, button: PointerButton) {
    harness.hover_at(from);
    harness.run_steps(1);
    harness.event(button_event(from, button, true));
    harness.run_steps(1);
    for share in [0.5, 1.0] {
        harness.hover_at(from + by * share);
        harness.run_steps(1);
    }
    harness.event(button_event(from + by, button, false));
    harness.run_steps(2);
}

/// Turns the wheel where the pointer is, by points.
fn wheel(harness: &mut Harness<Seen>, by: f32) {
    harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, by),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(3);
}

/// Chooses an entry of a list that unfolds.
fn choose(harness: &mut Harness<Seen>, list: &str, entry: &str) {
    click_role(harness, Role::ComboBox, list);
    harness.get_all_by_role_and_label(Role::Button, entry).last().expect("an entry").click();
    harness.run_steps(3);
}

#[test]
fn it_opens_at_the_last_step_and_keys_walk_pass_by_pass() {
    let mut harness = harness(z_fail(SIZE));
    assert_eq!(harness.state().inspector.model.selection.step, 3);
    harness.get_by_label("step 3 of 3");
    press(&mut harness, Key::ArrowLeft);
    assert_eq!(harness.state().inspector.model.selection.step, 1, "the mask is no step of the frame");
    press(&mut harness, Key::Home);
    harness.get_by_label("step 1 of 3");
    press(&mut harness, Key::ArrowLeft);
    assert_eq!(harness.state().inspector.model.selection.step, 0, "there is nothing before the first step");
    press(&mut harness, Key::ArrowRight);
    harness.get_by_label("step 2 of 3");
    press(&mut harness, Key::End);
    press(&mut harness, Key::ArrowRight);
    assert_eq!(harness.state().inspector.model.selection.step, 3);
}

#[test]
fn buttons_scrubber_and_tree_select_steps() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "Previous step");
    assert_eq!(harness.state().inspector.model.selection.step, 1);
    click(&mut harness, "Next step");
    assert_eq!(harness.state().inspector.model.selection.step, 3);
    click(&mut harness, "2 · volumes");
    assert_eq!(harness.state().inspector.model.selection.step, 1);
    harness.get_by_label("Why volumes is there.");
    harness.get_by_label("sides of box");
    harness.get_by_label("Step scrubber").set_value_accesskit(1.0);
    harness.run_steps(2);
    assert_eq!(harness.state().inspector.model.selection.step, 0);
}

#[test]
fn a_light_in_the_tree_selects_its_last_pass() {
    let mut harness = harness(z_fail(SIZE));
    press(&mut harness, Key::Home);
    click_role(&mut harness, Role::TreeItem, "Light 1 · point");
    assert_eq!(harness.state().inspector.model.selection.step, 3);
}

#[test]
fn many_errors_leave_space_for_the_picture_and_go_at_once() {
    let mut harness = harness(z_fail(SIZE));
    for index in 0..60 {
        harness.state_mut().inspector.model.push_error(format!("{index}.obj: no faces: choose another file"));
    }
    harness.run_steps(4);
    assert!(harness.get_by_label("Picture canvas").rect().height() > 200.0);
    click_button(&mut harness, "Dismiss all");
    assert!(harness.state().inspector.model.activity.messages.is_empty());
}

#[test]
fn space_plays_to_the_end_and_stops() {
    let mut harness = harness(z_fail(SIZE));
    press(&mut harness, Key::Space);
    assert!(harness.state().inspector.model.selection.playing.is_some());
    assert_eq!(harness.state().inspector.model.selection.step, 0, "at the end it starts again");
    // A frame of the harness is a quarter of a second.
    harness.run_steps(14);
    assert_eq!(harness.state().inspector.model.selection.step, 3);
    assert!(harness.state().inspector.model.selection.playing.is_none());
}

#[test]
fn control_g_goes_to_a_number_and_control_f_finds_a_pass() {
    let mut harness = harness(z_fail(SIZE));
    press_with(&mut harness, Modifiers::COMMAND, Key::G);
    harness.get_by_label("Go to step").type_text("2");
    harness.run_steps(2);
    press(&mut harness, Key::Enter);
    assert_eq!(harness.state().inspector.model.selection.step, 1);
    press_with(&mut harness, Modifiers::COMMAND, Key::F);
    harness.get_by_label("Find a pass").type_text("mask");
    harness.run_steps(2);
    assert!(harness.query_by_label("2 · volumes").is_none(), "passes without the word are hidden");
    press(&mut harness, Key::ArrowLeft);
    assert_eq!(harness.state().inspector.model.selection.step, 1, "a text field keeps its keys");
    press(&mut harness, Key::Enter);
    assert_eq!(harness.state().inspector.model.selection.step, 2);
}

#[test]
fn a_right_click_picks_and_arrows_step_all_the_same() {
    let mut harness = harness(z_fail(SIZE));
    harness.get_by_label("No pixel is picked.");
    pick_by_mouse(&mut harness, [12, 7], SIZE);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([12, 7]));
    press(&mut harness, Key::ArrowLeft);
    assert_eq!(
        (harness.state().inspector.model.selection.step, harness.state().inspector.model.selection.pick),
        (1, Some([12, 7]))
    );
    for (modifiers, key, expected) in [
        (Modifiers::SHIFT, Key::ArrowRight, [13, 7]),
        (Modifiers::SHIFT, Key::ArrowUp, [13, 6]),
        (Modifiers::COMMAND | Modifiers::SHIFT, Key::ArrowDown, [13, 16]),
    ] {
        press_with(&mut harness, modifiers, key);
        assert_eq!(
            (harness.state().inspector.model.selection.step, harness.state().inspector.model.selection.pick),
            (1, Some(expected))
        );
    }
    harness.get_by_label("13, 16");
    press(&mut harness, Key::Escape);
    assert_eq!(harness.state().inspector.model.selection.pick, None);
}

/// A click that closes a menu is meant for the menu.
#[test]
fn a_click_picks_unless_it_closes_a_menu() {
    let mut harness = harness(z_fail(SIZE));
    let click_at = |harness: &mut Harness<Seen>, texel: [u32; 2]| {
        let at = place_of(harness, texel, SIZE);
        mouse(harness, at, PointerButton::Primary);
        harness.run_steps(3);
        harness.state().inspector.model.selection.pick
    };
    assert_eq!(click_at(&mut harness, [12, 7]), Some([12, 7]));
    click_button(&mut harness, "View");
    assert_eq!(click_at(&mut harness, [20, 9]), Some([12, 7]), "it closed the menu");
    assert_eq!(click_at(&mut harness, [20, 9]), Some([20, 9]));
}

#[test]
fn the_read_out_says_why_a_pixel_is_dark_and_how_its_values_ran() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.selection.pick = Some([3, 4]);
    inspector.model.select_step(1);
    let harness = harness_of(inspector);
    harness.get_by_label("Dark under light 1: its stencil count is 1.");
    harness.get_by_label("0000 0001");
    harness.get_by_label("shadow");
    assert_eq!(harness.query_all_by_label("4.000 m").count(), 5, "now, and after each step");
    assert!(harness.query_all_by_label("20 20 24").count() >= 4, "a row for each step");
}

#[test]
fn a_count_below_zero_is_shown_with_its_sign() {
    let harness = picked(z_fail(SIZE), [0, 0]);
    harness.get_by_label("Dark under light 1: its stencil count is −1 (255).");
    harness.get_by_label("1111 1111");
}

#[test]
fn every_label_has_its_own_sentence() {
    let mut with_background = inspector(z_fail(SIZE));
    with_background.model.selection.pick = Some([39, 4]);
    harness_of(with_background).get_by_label("Background: no surface is at this pixel.");
    let mut lit = inspector(z_fail(SIZE));
    lit.model.selection.pick = Some([30, 4]);
    harness_of(lit).get_by_label(
        "Lit by light 1: its stencil count was 0 when the light pass tested it; the pass then made it 1.",
    );
}

#[test]
fn only_pictures_that_exist_have_a_button_and_the_legend_counts_pixels() {
    let mut harness = harness(z_fail(SIZE));
    assert!(harness.query_by_role_and_label(Role::Button, "Shadow map").is_none());
    press(&mut harness, Key::Home);
    press(&mut harness, Key::ArrowRight);
    click_button(&mut harness, "Stencil");
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Stencil));
    harness.get_by_label("Stencil count");
    harness.get_by_label("−1 (255)");
    // 20 columns of 30, less the corner.
    harness.get_by_label("599");
    harness.get_by_label("600");
    click_button(&mut harness, "Mask");
    harness.get_by_label("3 faces away");
    click_button(&mut harness, "Depth");
    harness.get_by_label("Distance");
    harness.get_by_label("1.000 m");
    harness.get_by_label("39.000 m");
    click_button(&mut harness, "Raw");
    harness.get_by_label("Depth as stored");
}

#[test]
fn the_depth_range_is_set_by_handles_and_fitted_again() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Depth");
    let ends = |harness: &Harness<Seen>| ["1.000 m", "39.000 m"].map(|end| harness.query_by_label(end).is_some());
    assert_eq!(ends(&harness), [true, true]);
    let slider = harness.get_all_by_label("Depth range").next().expect("a slider").rect();
    let from = pos2(slider.right() - 4.0, slider.center().y);
    drag(&mut harness, from, slider.center() - from, PointerButton::Primary);
    assert_eq!(ends(&harness), [true, false], "the far end was dragged");
    click_button(&mut harness, "Autofit");
    assert_eq!(ends(&harness), [true, true]);
}

#[test]
fn a_map_pass_shows_its_face_and_leaving_it_shows_what_was_shown_before() {
    let mut harness = harness(cube_map());
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Color));
    press(&mut harness, Key::Home);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Map));
    harness.get_by_label_contains("shadow map of light 1, face −x");
    assert!(is_disabled(&harness, "Colour"), "nothing is drawn yet, and nothing moves for it");
    click_button(&mut harness, "All");
    click(&mut harness, "Face −y");
    harness.get_by_label_contains("shadow map of light 1, face −y");
    press(&mut harness, Key::End);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Color));
}

#[test]
fn the_wheel_zooms_at_the_pointer_and_the_buttons_go_back() {
    let mut harness = harness(z_fail(SIZE));
    let at = place_of(&harness, [10, 10], SIZE);
    harness.hover_at(at);
    harness.run_steps(2);
    wheel(&mut harness, 400.0);
    harness.run_steps(9);
    assert!(matches!(harness.state().inspector.model.view.zoom, TexelZoom::Pixels(pixels) if pixels > 30.0));
    mouse(&mut harness, at, PointerButton::Secondary);
    assert_eq!(
        harness.state().inspector.model.selection.pick,
        Some([10, 10]),
        "the texel under the pointer stayed there"
    );
    click_button(&mut harness, "1:1");
    assert_eq!(harness.state().inspector.model.view.zoom, TexelZoom::Pixels(1.0));
    click_button(&mut harness, "Fit");
    assert_eq!(harness.state().inspector.model.view.zoom, TexelZoom::Fit);
}

#[test]
fn choosing_a_technique_asks_for_a_run_and_remembers_settings() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "shadow-map");
    let Some(Action::Run(request)) = harness.state().actions.last() else { panic!("a run") };
    assert_eq!(request.choice, Choice::new(Technique::ShadowMap));
    click(&mut harness, "Scene settings");
    let size = harness.get_by_role_and_label(Role::SpinButton, "size");
    size.set_value_accesskit(256.0);
    harness.run_steps(2);
    let set = |actions: &[Action]| match actions.last() {
        Some(Action::Run(request)) => request.choice.settings().get("size").cloned(),
        _ => None,
    };
    assert_eq!(set(&harness.state().actions).as_deref(), Some("256"));
    click_button(&mut harness, "z-pass");
    click_button(&mut harness, "shadow-map");
    assert_eq!(set(&harness.state().actions).as_deref(), Some("256"), "as it was set before");
}

#[test]
fn lights_camera_and_size_by_number_ask_for_a_run() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "Scene settings");
    for (name, value) in [("light 1 position x", 2.5), ("camera eye y", 12.0), ("Picture width", 64.0)] {
        set_value(&mut harness, name, value);
    }
    let Some(Action::Run(request)) = harness.state().actions.last() else { panic!("a run") };
    assert_eq!(request.lights[0].position.x, 2.5);
    assert_eq!(request.camera.eye.y, 12.0);
    assert_eq!(request.size, [64, 30]);
}

#[test]
fn what_cannot_be_run_is_said_and_not_run() {
    let mut harness = harness(z_fail(SIZE));
    click(&mut harness, "Scene settings");
    // Where the target is: the eye of the scene looks straight down from 10 above.
    set_value(&mut harness, "camera eye y", 0.0);
    assert!(!harness.state().actions.iter().any(|action| matches!(action, Action::Run(_))));
    harness.get_by_label_contains("the camera's eye equals its target");
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("not read by the panels".to_owned())
    }
}

#[test]
fn a_capture_folder_is_looked_at_but_not_run() {
    let mut harness = of_folder();
    harness.get_by_label("technique z-fail");
    click(&mut harness, "Scene settings");
    harness.get_by_label_contains("This is a capture folder");
    press(&mut harness, Key::Home);
    show_tab(&mut harness, "Passes");
    harness.get_by_label("step 1 of 3");
}

#[test]
fn the_smallest_capture_and_an_empty_one_are_shown() {
    let mut one = inspector(z_fail([1, 1]));
    one.model.selection.pick = Some([0, 0]);
    let mut harness = harness_of(one);
    for kind in ["Stencil", "Depth", "Mask", "Colour"] {
        click_button(&mut harness, kind);
    }
    let mut empty = z_fail([1, 1]);
    empty.steps.clear();
    empty.lights.clear();
    show_capture(&mut harness, empty);
    press(&mut harness, Key::ArrowRight);
    harness.get_by_label("This capture has no passes.");
}

#[test]
fn a_map_larger_than_the_gpus_textures_is_shown() {
    let mut capture = cube_map();
    let map = capture.lights[0].map.as_mut().expect("a map");
    map.faces[1] = Arc::new(Image::uniform(PixelFormat::Depth32F, [16_384, 16_384], &0.5_f32.to_le_bytes()));
    let mut inspector = inspector(capture);
    inspector.model.select_step(0);
    let harness = harness_in(inspector, [640.0, 400.0]);
    harness.get_by_label_contains("16384×16384");
}

#[test]
fn nothing_is_redrawn_while_nothing_changes() {
    let mut harness = picked(z_fail(SIZE), [3, 4]);
    harness.run_steps(4);
    harness.step();
    let delay = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(delay > std::time::Duration::from_secs(60), "{delay:?}");
}

#[test]
fn another_capture_keeps_the_step_that_means_the_same() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.select_step(1);
    inspector.model.selection.pick = Some([30, 20]);
    let mut other = z_fail([20, 10]);
    other.steps.insert(0, other.steps[0].clone());
    inspector.set_capture(Arc::new(other));
    assert_eq!(inspector.model.selection.step, 2, "volumes");
    assert_eq!(inspector.model.selection.pick, None, "outside the smaller picture");
}

#[test]
fn key_presses_that_come_in_one_frame_all_count() {
    let mut harness = harness(z_fail(SIZE));
    for _ in 0..2 {
        for pressed in [true, false] {
            let (key, modifiers) = (Key::ArrowLeft, Modifiers::NONE);
            let event = Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
            harness.input_mut().events.push(event);
        }
    }
    harness.run_steps(2);
    assert_eq!(harness.state().inspector.model.selection.step, 0);
}
