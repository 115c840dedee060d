//! The Scene tab: a second camera that sees the first.

use super::pictures::{draw, inspector as inspector_over, sizes};
use super::{SIZE, Seen, asks, click, harness_of, reply, z_fail};
use crate::common;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;
use stencilscope::anatomy::{Anatomy, anatomy};
use stencilscope::ask::{AnatomyOf, HistoryOf, RunRequest};
use stencilscope::geometry::GeometryCache;
use stencilscope::inspector::Inspector;
use stencilscope::scene::shapes;
use stencilscope::scene::{Camera, Material, Object, OpenSpec, Scene, open};
use stencilscope::technique::{Choice, PlanRequest, Technique, plan};

/// A box on a floor, seen from the front.
pub fn box_scene() -> Scene {
    let eye = DVec3::new(0.0, 2.0, 8.0);
    let camera = Camera {
        eye,
        target: DVec3::Y,
        up: DVec3::Y,
        projection: stencilscope::scene::Projection::Perspective,
        fov_y_degrees: 50.0,
        near: 0.1,
        far: None,
    };
    let objects = vec![common::cuboid("box", [-1.0, 0.5, -1.0], [1.0, 1.5, 1.0])];
    Scene { name: "by hand".to_owned(), camera, ..common::from_above(objects) }
}

/// How a scene is run by z-fail.
pub fn draft_of(scene: &Scene) -> RunRequest {
    RunRequest {
        choice: Choice::new(Technique::ZFail),
        size: SIZE,
        camera: scene.camera,
        lights: scene.lights.clone(),
        time: 0.0,
        off: std::collections::BTreeSet::new(),
        objects: Default::default(),
    }
}

/// What a frame of a scene is made of, without a GPU.
pub fn anatomy_of(scene: &Scene, technique: Technique) -> Arc<Anatomy> {
    anatomy_by(scene, &Choice::new(technique))
}

fn anatomy_by(scene: &Scene, choice: &Choice) -> Arc<Anatomy> {
    let mut cache = GeometryCache::default();
    let plan = plan(PlanRequest { scene, size: SIZE, choice, cache: &mut cache }).expect("a plan");
    Arc::new(anatomy(scene, Some(choice), &plan, &mut cache))
}

/// Panels over a scene, with its anatomy.
pub fn over(scene: &Scene) -> Inspector {
    let mut inspector = Inspector::default();
    inspector.set_scene(scene, draft_of(scene));
    let mut capture = z_fail(SIZE);
    capture.camera = scene.camera;
    inspector.set_capture(Arc::new(capture));
    inspector.tell(AnatomyOf {}, Ok(anatomy_of(scene, Technique::ZFail)));
    inspector
}

pub fn shown() -> Harness<'static, Seen> {
    let mut harness = harness_of(over(&box_scene()), [1280.0, 800.0]);
    show(&mut harness);
    harness
}

pub fn show(harness: &mut Harness<Seen>) {
    harness.get_by_role_and_label(Role::Tab, "Scene").click();
    harness.run_steps(3);
}

/// Presses at a place, moves, and lets go.
pub fn drag(harness: &mut Harness<Seen>, from: Pos2, by: Vec2, button: PointerButton) {
    harness.hover_at(from);
    harness.run_steps(1);
    let event = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
    harness.event(event(from, true));
    harness.run_steps(1);
    for share in [0.5, 1.0] {
        harness.hover_at(from + by * share);
        harness.run_steps(1);
    }
    harness.event(event(from + by, false));
    harness.run_steps(2);
}

/// A view shows three times as much.
pub fn farther(harness: &mut Harness<Seen>, view: &str) {
    harness.get_by_label(view).focus();
    harness.run_steps(2);
    (0..8).for_each(|_| super::press(harness, Key::Minus));
}

/// The view's texels, so that two looks can be compared.
fn look(harness: &mut Harness<Seen>, view: &str) -> Vec<[u8; 4]> {
    // Away from everything that answers to the pointer.
    harness.hover_at(pos2(640.0, 792.0));
    harness.run_steps(3);
    let rect = harness.get_by_label(view).rect();
    let picture = harness.render().expect("a picture");
    let columns = rect.left() as u32 + 130..rect.right() as u32 - 4;
    (rect.top() as u32 + 34..rect.bottom() as u32 - 4)
        .flat_map(|y| columns.clone().map(move |x| (x, y)))
        .map(|(x, y)| picture.get_pixel(x, y).0)
        .collect()
}

const FREE: &str = "Free view of the scene";

fn anatomies(harness: &Harness<Seen>) -> usize {
    asks::<AnatomyOf>(harness).len()
}

#[test]
fn a_folder_has_no_geometry_and_says_what_to_open() {
    let mut inspector = Inspector::default();
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_of(inspector, [1280.0, 800.0]);
    show(&mut harness);
    harness.get_by_label("Opened from a folder: its geometry is not known.");
    harness.get_by_label("Open the scene instead, with Open… or by dropping its file here.");
    assert_eq!(anatomies(&harness), 0);
}

#[test]
fn geometry_is_asked_for_once_a_frame_and_only_while_it_is_shown() {
    let scene = box_scene();
    let mut inspector = Inspector::default();
    inspector.set_scene(&scene, draft_of(&scene));
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_of(inspector, [1280.0, 800.0]);
    assert_eq!(anatomies(&harness), 0);
    show(&mut harness);
    harness.get_by_label("Looking at the scene's geometry…");
    harness.run_steps(5);
    assert_eq!(anatomies(&harness), 1);
    reply::<AnatomyOf>(&mut harness, Err("out of reach: try again".to_owned()));
    harness.run_steps(2);
    harness.get_by_label("out of reach: try again");
    harness.state_mut().inspector.set_capture(Arc::new(z_fail(SIZE)));
    harness.run_steps(3);
    assert_eq!(anatomies(&harness), 2);
    harness.state_mut().inspector.tell(AnatomyOf {}, Ok(anatomy_of(&scene, Technique::ZFail)));
    harness.run_steps(2);
    harness.get_by_label(FREE);
    // Until the next frame's is there, that of the one before stays.
    harness.state_mut().inspector.set_capture(Arc::new(z_fail(SIZE)));
    harness.run_steps(3);
    harness.get_by_label("Of the frame before.");
    harness.get_by_label(FREE);
    assert_eq!(anatomies(&harness), 3);
}

#[test]
fn every_part_has_a_switch_that_shows_and_hides_it() {
    let mut harness = shown();
    // From so far away that the camera with its frustum is seen, too.
    farther(&mut harness, FREE);
    let with_objects = look(&mut harness, FREE);
    // Without the floor, which hides the far end.
    click(&mut harness, "Objects");
    let all = look(&mut harness, FREE);
    assert!(with_objects != all);
    for name in ["Sides", "Light caps", "Dark caps", "Silhouettes", "Frusta", "Near-clip volume", "Names", "Wireframe"]
    {
        click(&mut harness, name);
        let without = look(&mut harness, FREE);
        assert!(all != without, "{name} changes nothing");
        click(&mut harness, name);
        assert!(all == look(&mut harness, FREE), "{name} comes back as it was");
    }
}

#[test]
fn a_wireframe_is_hidden_by_surfaces_until_they_are_switched_off() {
    let mut harness = shown();
    ["Sides", "Light caps", "Dark caps", "Silhouettes", "Frusta"].iter().for_each(|name| click(&mut harness, name));
    let changed = |a: &[[u8; 4]], b: &[[u8; 4]]| a.iter().zip(b).filter(|(a, b)| a != b).count();
    let solid = look(&mut harness, FREE);
    click(&mut harness, "Wireframe");
    let over_surfaces = changed(&solid, &look(&mut harness, FREE));
    click(&mut harness, "Objects");
    let all_edges = look(&mut harness, FREE);
    click(&mut harness, "Wireframe");
    let seen_through = changed(&look(&mut harness, FREE), &all_edges);
    assert!(over_surfaces > 100 && seen_through > over_surfaces, "{over_surfaces} {seen_through}");
}

#[test]
fn the_free_view_turns_moves_and_scales_and_reset_shows_all_again() {
    let mut harness = shown();
    let first = look(&mut harness, FREE);
    let middle = harness.get_by_label(FREE).rect().center() + egui::vec2(90.0, 120.0);
    let mut seen = vec![first.clone()];
    let by = egui::vec2(60.0, 25.0);
    drag(&mut harness, middle, by, PointerButton::Primary);
    seen.push(look(&mut harness, FREE));
    drag(&mut harness, middle, by, PointerButton::Secondary);
    seen.push(look(&mut harness, FREE));
    harness.hover_at(middle);
    harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 60.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(8);
    seen.push(look(&mut harness, FREE));
    harness.get_by_label(FREE).focus();
    harness.run_steps(2);
    let step = harness.state().inspector.step();
    for key in [Key::ArrowLeft, Key::ArrowUp, Key::Plus] {
        harness.key_press(key);
        harness.run_steps(2);
        seen.push(look(&mut harness, FREE));
    }
    assert_eq!(harness.state().inspector.step(), step, "the view keeps its keys");
    for (index, pair) in seen.windows(2).enumerate() {
        assert!(pair[0] != pair[1], "move {index} changes nothing");
    }
    click(&mut harness, "Reset");
    assert!(look(&mut harness, FREE) == first);
    click(&mut harness, "See from the camera");
    assert!(look(&mut harness, FREE) != first);
}

#[test]
fn four_views_have_a_projection_each() {
    let mut harness = shown();
    click(&mut harness, "Four views");
    for name in ["Top", "Free", "Front", "Right"] {
        harness.get_by_label(&format!("{name} view of the scene"));
        let label = format!("Projection of the {name} view");
        let combo = harness.get_by_label(&label);
        let expected = if name == "Free" { "perspective" } else { "orthographic" };
        assert_eq!(combo.value().as_deref(), Some(expected), "{name}");
    }
    let front = "Front view of the scene";
    let orthographic = look(&mut harness, front);
    harness.get_by_label("Projection of the Front view").click();
    harness.run_steps(2);
    harness.get_all_by_label("cavalier").last().expect("a choice").click();
    harness.run_steps(2);
    let cavalier = look(&mut harness, front);
    assert!(orthographic != cavalier);
    harness.get_by_label("Angle of the Front view").set_value_accesskit(30.0);
    harness.run_steps(2);
    assert!(cavalier != look(&mut harness, front));
    super::click_button(&mut harness, "Right");
    assert!(harness.query_by_label(front).is_none());
}

#[test]
fn one_caster_can_be_looked_at_alone() {
    let scene = box_scene();
    // The floor, too.
    let mut choice = Choice::new(Technique::ZFail);
    choice.set("casters", "all").expect("a setting");
    let mut inspector = over(&scene);
    inspector.tell(AnatomyOf {}, Ok(anatomy_by(&scene, &choice)));
    let mut harness = harness_of(inspector, [1280.0, 800.0]);
    show(&mut harness);
    harness.get_by_label("Without the volumes of what holds everything (floor): choose it to see them.");
    let all = look(&mut harness, FREE);
    harness.get_by_label("Caster shown").click();
    harness.run_steps(2);
    harness.get_all_by_label("floor").last().expect("a choice").click();
    harness.run_steps(2);
    assert!(all != look(&mut harness, FREE));
}

/// A ball over a floor.
pub fn ball_scene(around: u32, rings: u32) -> Scene {
    let ball = shapes::sphere(1.0, around, rings).expect("a ball");
    let mut ball = Object::new("ball", Arc::new(ball), Material::default());
    ball.pose.translate.y = 1.2;
    let mut scene = box_scene();
    scene.objects.retain(|object| object.name != "box");
    scene.objects.push(ball);
    scene
}

/// A ball of 69 696 triangles looks as one of 3 968.
#[test]
fn a_large_mesh_looks_as_a_small_one_of_its_shape() {
    let mut looks = Vec::new();
    for (around, rings) in [(64, 32), (264, 133)] {
        let mut harness = harness_of(over(&ball_scene(around, rings)), [1296.0, 816.0]);
        show(&mut harness);
        looks.push(look(&mut harness, FREE));
        for name in ["Sides", "Light caps", "Dark caps", "Silhouettes", "Frusta"] {
            click(&mut harness, name);
        }
        looks.push(look(&mut harness, FREE));
        click(&mut harness, "Objects");
        looks.push(look(&mut harness, FREE));
    }
    let unlike = |one: usize, other: usize| {
        let far = |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 24);
        looks[one].iter().zip(&looks[other]).filter(far).count()
    };
    let (all, alone, ball) = (unlike(0, 3), unlike(1, 4), unlike(4, 5));
    println!("{all} texels differ, without volumes {alone}; objects take {ball}");
    assert!(ball > 5_000 && alone < 400 && all < 4_000, "{all}, {alone} of {ball}");
}

/// The times of a machine that others use too are no ground to fail: they are printed, and a drag must not
/// take a second.
#[test]
fn a_drag_over_a_built_in_scene_is_quick() {
    let scene = open(&OpenSpec::new("tori")).expect("a built-in scene");
    let mut harness = harness_of(over(&scene), [1280.0, 800.0]);
    show(&mut harness);
    let middle = harness.get_by_label(FREE).rect().center();
    let still = time(&mut harness, middle, 0.0);
    let pressed =
        Event::PointerButton { pos: middle, button: PointerButton::Primary, pressed: true, modifiers: Modifiers::NONE };
    harness.event(pressed);
    harness.step();
    let dragged = time(&mut harness, middle, 3.0);
    println!("a frame of the Scene tab over tori: {still:?} still, {dragged:?} while it is dragged");
    assert!(dragged.as_secs_f64() < 1.0);
}

/// Of a frame while the pointer moves.
fn time(harness: &mut Harness<Seen>, from: Pos2, by: f32) -> std::time::Duration {
    const FRAMES: u32 = 20;
    let start = std::time::Instant::now();
    for frame in 0..FRAMES {
        harness.hover_at(from + egui::vec2(by * frame as f32, 0.0));
        harness.step();
    }
    start.elapsed() / FRAMES
}

/// A real frame of a built-in scene with its anatomy.
fn harness_over(name: &str, technique: Technique, pick: [u32; 2], size: [f32; 2]) -> Harness<'static, Seen> {
    let scene = open(&OpenSpec::new(name)).expect("a built-in scene");
    let mut session = common::session();
    let request = common::request(technique, [640, 360]);
    let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
    let anatomy = session.anatomy(&scene, Some(&request.choice), &plan);
    let history = session.history(&plan, &capture, pick).expect("a history");
    let mut inspector = inspector_over(&scene, &request, &Arc::new(capture), pick);
    inspector.tell(AnatomyOf {}, Ok(Arc::new(anatomy)));
    inspector.tell(HistoryOf { at: pick }, Ok(Arc::new(history)));
    harness_of(inspector, size)
}

type View = (&'static str, fn(&mut Harness<Seen>));

/// `INSPECTOR_PICTURES=FOLDER cargo test pictures_of_the_scene` writes them.
#[test]
fn pictures_of_the_scene_tab_can_be_drawn() {
    let folder = std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from);
    let size = if folder.is_some() { [1280, 800] } else { sizes(false)[0] };
    let views: [View; 4] = [
        ("free", |_| ()),
        ("four", |harness| click(harness, "Four views")),
        ("camera", |harness| click(harness, "See from the camera")),
        ("near", |harness| {
            click(harness, "Near-clip volume");
            click(harness, "Names");
            click(harness, "Dark caps");
        }),
    ];
    let scenes = [
        ("tori", Technique::ZFail, [344, 71]),
        ("rings", Technique::ZFail, [320, 200]),
        ("inside", Technique::ZPassPlus, [320, 250]),
        ("tiger-cage", Technique::ShadowMap, [320, 250]),
        ("tori", Technique::PlanarTexture, [344, 71]),
        ("two-lights", Technique::Projective, [320, 200]),
    ];
    for (name, technique, pick) in scenes {
        for (view, act) in &views {
            // Without a folder one look at each is enough.
            if folder.is_none() && *view != "four" {
                continue;
            }
            let mut harness = harness_over(name, technique, pick, size.map(|side| (side + 16) as f32));
            show(&mut harness);
            act(&mut harness);
            harness.run_steps(2);
            draw(&mut harness, folder.as_deref(), &format!("scene-{name}-{}-{view}", technique.name()), size);
        }
    }
}
