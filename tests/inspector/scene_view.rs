//! The Scene tab: a second camera that sees the first.

use super::pictures::{self, Gallery, View};
use super::*;
use stencilscope::anatomy::{Anatomy, anatomy};
use stencilscope::geometry::GeometryCache;
use stencilscope::scene::{Camera, Material, Object, shapes};
use stencilscope::technique::{PlanRequest, plan};

/// A box on a floor, seen from the front.
pub fn box_scene() -> Scene {
    let camera = Camera { fov_y_degrees: 50.0, near: 0.1, ..Camera::looking([0.0, 2.0, 8.0], [0.0, 1.0, 0.0]) };
    let objects = vec![common::cuboid("box", [-1.0, 0.5, -1.0], [1.0, 1.5, 1.0])];
    Scene { name: "by hand".to_owned(), camera, ..common::from_above(objects) }
}

/// How a scene is run by z-fail.
pub fn draft_of(scene: &Scene) -> RunRequest {
    RunRequest::of(scene, Choice::new(Technique::ZFail), SIZE)
}

/// What a frame of a scene is made of, without a GPU.
pub fn anatomy_of(scene: &Scene, technique: Technique) -> Arc<Anatomy> {
    anatomy_by(scene, &Choice::new(technique))
}

/// What a frame of a scene is made of with a technique's settings.
pub fn anatomy_by(scene: &Scene, choice: &Choice) -> Arc<Anatomy> {
    let mut cache = GeometryCache::default();
    let plan = plan(PlanRequest { scene, size: SIZE, choice, cache: &mut cache, map_camera: None }).expect("a plan");
    Arc::new(anatomy(scene, Some(choice), &plan, &mut cache))
}

/// Panels over a scene, with its anatomy.
pub fn over(scene: &Scene) -> Inspector {
    let mut inspector = Inspector::default();
    inspector.set_scene(scene, draft_of(scene));
    let mut capture = z_fail(SIZE);
    capture.camera = scene.camera;
    inspector.set_capture(Arc::new(capture));
    inspector.take_in(AnatomyOf {}, Ok(anatomy_of(scene, Technique::ZFail)));
    inspector
}

pub fn shown() -> Harness<'static, Seen> {
    let mut harness = harness_of(over(&box_scene()));
    show(&mut harness);
    harness
}

pub fn show(harness: &mut Harness<Seen>) {
    show_tab(harness, "Scene");
}

/// A view shows three times as much.
pub fn farther(harness: &mut Harness<Seen>, view: &str) {
    focus(harness, view);
    (0..8).for_each(|_| press(harness, Key::Minus));
}

/// The view's texels, so that two looks can be compared.
fn look(harness: &mut Harness<Seen>, view: &str) -> Vec<[u8; 3]> {
    // Away from everything that answers to the pointer.
    harness.hover_at(pos2(640.0, 792.0));
    harness.run_steps(3);
    let rect = harness.get_by_label(view).rect();
    let picture = window_picture(harness);
    let columns = rect.left() as u32 + 130..rect.right() as u32 - 4;
    (rect.top() as u32 + 34..rect.bottom() as u32 - 4)
        .flat_map(|y| columns.clone().map(move |x| (x, y)))
        .map(|(x, y)| picture.at([x, y]).expect("within the window"))
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
    let mut harness = harness_of(inspector);
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
    let mut harness = harness_of(inspector);
    assert_eq!(anatomies(&harness), 0);
    show(&mut harness);
    harness.get_by_label("Looking at the scene's geometry…");
    harness.run_steps(5);
    assert_eq!(anatomies(&harness), 1);
    reply::<AnatomyOf>(&mut harness, Err("out of reach: try again".to_owned()));
    harness.run_steps(2);
    harness.get_by_label("out of reach: try again");
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!(anatomies(&harness), 2);
    change(&mut harness, |inspector| inspector.take_in(AnatomyOf {}, Ok(anatomy_of(&scene, Technique::ZFail))));
    harness.get_by_label(FREE);
    // Until the next frame's is there, that of the one before stays.
    show_capture(&mut harness, z_fail(SIZE));
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
    for name in [
        "Sides",
        "Light caps",
        "Dark caps",
        "Silhouettes",
        "Frusta",
        "Near-clip volume",
        "Names",
        "Wireframe",
        "Normals",
    ] {
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
    let changed = |a: &[[u8; 3]], b: &[[u8; 3]]| a.iter().zip(b).filter(|(a, b)| a != b).count();
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
    let middle = harness.get_by_label(FREE).rect().center() + vec2(90.0, 120.0);
    let mut seen = vec![first.clone()];
    let by = vec2(60.0, 25.0);
    drag(&mut harness, middle, by, PointerButton::Primary);
    seen.push(look(&mut harness, FREE));
    drag(&mut harness, middle, by, PointerButton::Secondary);
    seen.push(look(&mut harness, FREE));
    harness.hover_at(middle);
    wheel(&mut harness, 60.0);
    harness.run_steps(5);
    seen.push(look(&mut harness, FREE));
    focus(&mut harness, FREE);
    let step = harness.state().inspector.model.selection.step;
    for key in [Key::ArrowLeft, Key::ArrowUp, Key::Plus] {
        press(&mut harness, key);
        seen.push(look(&mut harness, FREE));
    }
    assert_eq!(harness.state().inspector.model.selection.step, step, "the view keeps its keys");
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
    choose(&mut harness, "Projection of the Front view", "cavalier");
    let cavalier = look(&mut harness, front);
    assert!(orthographic != cavalier);
    set_value(&mut harness, "Angle of the Front view", 30.0);
    assert!(cavalier != look(&mut harness, front));
    click_button(&mut harness, "Right");
    assert!(harness.query_by_label(front).is_none());
}

#[test]
fn one_caster_can_be_looked_at_alone() {
    let scene = box_scene();
    // The floor, too.
    let mut choice = Choice::new(Technique::ZFail);
    choice.set("casters", "all").expect("a setting");
    let mut inspector = over(&scene);
    inspector.take_in(AnatomyOf {}, Ok(anatomy_by(&scene, &choice)));
    let mut harness = harness_of(inspector);
    show(&mut harness);
    harness.get_by_label("Without the volumes of what holds everything (floor): choose it to see them.");
    let all = look(&mut harness, FREE);
    choose(&mut harness, "Caster shown", "floor");
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
        let mut harness = harness_in(over(&ball_scene(around, rings)), [1296.0, 816.0]);
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
        let far = |(a, b): &(&[u8; 3], &[u8; 3])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 24);
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
    let mut harness = harness_of(over(&scene));
    show(&mut harness);
    let middle = harness.get_by_label(FREE).rect().center();
    let still = time(&mut harness, middle, 0.0);
    harness.event(button_event(middle, PointerButton::Primary, true));
    harness.step();
    let dragged = time(&mut harness, middle, 3.0);
    println!("a frame of the Scene tab over tori: {still:?} still, {dragged:?} while it is dragged");
    assert!(dragged.as_secs_f64() < 1.0);
}

/// The average time of a frame while the pointer moves.
fn time(harness: &mut Harness<Seen>, from: Pos2, by: f32) -> std::time::Duration {
    const FRAMES: u32 = 20;
    let start = std::time::Instant::now();
    for frame in 0..FRAMES {
        harness.hover_at(from + vec2(by * frame as f32, 0.0));
        harness.step();
    }
    start.elapsed() / FRAMES
}

/// The panels over a frame with its anatomy, and the history of a pixel.
fn looked_at(session: &mut Session, frame: &RunFrame, pick: [u32; 2]) -> Inspector {
    let history = session.history(&frame.plan, &frame.capture, pick).expect("a history");
    let mut inspector = pictures::inspector(frame, pick);
    inspector.take_in(AnatomyOf {}, Ok(pictures::anatomy(session, frame)));
    inspector.take_in(HistoryOf { at: pick }, Ok(Arc::new(history)));
    inspector
}

/// Faces of volumes that count are often at one place of the view: at infinity, or one behind the other.
#[test]
fn what_faces_add_on_the_picked_ray_is_written_side_by_side() {
    let mut session = common::session();
    for (name, pick) in [("tori", [322, 92]), ("tori", [344, 71]), ("rings", [320, 200])] {
        let frame = common::frame(&mut session, name, common::request(Technique::ZFail, [640, 360]));
        let mut harness = harness_in(looked_at(&mut session, &frame, pick), WINDOW);
        show(&mut harness);
        for act in ["Four views", "See from the camera"] {
            click(&mut harness, act);
            harness.run_steps(3);
            let is_label = |word: &contrast::InkedWord| {
                let number = word.text.trim_end_matches(" at ∞");
                number.starts_with(['+', '−']) && number.len() < 6
            };
            let panel = harness.get_by_role_and_label(Role::TabPanel, "Scene").rect();
            let labels: Vec<contrast::InkedWord> = contrast::words(&harness).into_iter().filter(is_label).collect();
            let labels: Vec<_> = labels.into_iter().filter(|word| panel.contains_rect(word.place)).collect();
            assert!(labels.len() > 1, "{name} at {pick:?}, {act}");
            for (index, one) in labels.iter().enumerate() {
                for other in &labels[index + 1..] {
                    let is_over = one.place.intersects(other.place);
                    assert!(!is_over, "{name} at {pick:?}, {act}: {} over {}, {}", one.text, other.text, one.place);
                }
            }
        }
    }
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of_the_scene` writes them.
#[test]
fn pictures_of_the_scene_tab_can_be_drawn() {
    let gallery = Gallery::open();
    let mut session = common::session();
    let views: [(&str, View); 5] = [
        ("free", |_| ()),
        ("four", |harness| click(harness, "Four views")),
        ("camera", |harness| click(harness, "See from the camera")),
        ("normals", |harness| click(harness, "Normals")),
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
        ("table", Technique::ShadowMap, [320, 250]),
        ("tori", Technique::PlanarTexture, [344, 71]),
        ("two-lights", Technique::Projective, [320, 200]),
    ];
    for (name, technique, pick) in scenes {
        let frame = common::frame(&mut session, name, common::request(technique, [640, 360]));
        for (view, act) in &views {
            // Without a folder one look at each is enough.
            if gallery.folder.is_none() && *view != "four" {
                continue;
            }
            let name = format!("scene-{name}-{}-{view}", technique.name());
            let inspector = || looked_at(&mut session, &frame, pick);
            gallery.show(&name, &gallery.sizes()[..1], inspector, |harness| {
                show(harness);
                act(harness);
            });
        }
    }
}

/// The row under the pointer is found in the scene, without a click.
#[test]
fn the_face_of_a_rung_under_the_pointer_is_outlined() {
    let mut session = common::session();
    let frame = common::frame(&mut session, "tori", common::request(Technique::ZFail, [640, 360]));
    let mut harness = harness_in(looked_at(&mut session, &frame, [322, 92]), WINDOW);
    show(&mut harness);
    let plain = look(&mut harness, FREE);
    let rungs = harness.query_all_by_label_contains("rung: ");
    let counting = rungs.filter(|rung| !rung.accesskit_node().label().unwrap_or_default().contains("not counted"));
    let at = counting.map(|rung| rung.rect().center()).next().expect("a rung");
    harness.hover_at(at);
    harness.run_steps(4);
    let pointed = harness.state().inspector.model.selection.pointed;
    assert!(pointed[0].is_some() && pointed[0] == pointed[1], "{pointed:?}");
    assert_eq!(harness.state().inspector.selected_event(), None);
    let rect = harness.get_by_label(FREE).rect();
    let outlined = window_picture(&mut harness);
    let columns = rect.left() as u32 + 130..rect.right() as u32 - 4;
    let after = (rect.top() as u32 + 34..rect.bottom() as u32 - 4)
        .flat_map(|y| columns.clone().map(move |x| (x, y)))
        .map(|(x, y)| outlined.at([x, y]).expect("within the window"));
    let changed = after.zip(&plain).filter(|(after, before)| after != *before).count();
    assert!(changed > 50, "{changed} pixels");
    // The frame in which the pointer leaves asks for another.
    harness.hover_at(pos2(640.0, 792.0));
    harness.run_steps(2);
    assert_eq!(harness.state().inspector.model.selection.pointed, [None; 2]);
    assert_eq!(look(&mut harness, FREE), plain, "without the pointer all is as before");
}
