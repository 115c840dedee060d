//! Walking: keys, mouse, walls, and how it begins and ends.

use super::pictures::Gallery;
use super::scene_view::{box_scene, draft_of, over};
use super::*;
use stencilscope::ask::{WallsOf, without};
use stencilscope::scene::{Swing, WallCache};

const BANNER: &str = "Walking: Esc stops and frees the pointer";

fn walking() -> Harness<'static, Seen> {
    let mut harness = harness_of(over(&box_scene()));
    answer(&mut harness);
    click(&mut harness, "Walk");
    harness.get_by_label(BANNER);
    answer_walls(&mut harness, &box_scene());
    harness
}

/// The walls that were asked for last, as the app makes them.
fn answer_walls(harness: &mut Harness<Seen>, scene: &Scene) {
    let WallsOf { off, time, .. } = walls_asked(harness).pop().expect("walls are asked for");
    let scene = without(scene.clone(), &off).advanced(time);
    reply::<WallsOf>(harness, Ok(WallCache::default().walls(&scene)));
}

fn walls_asked(harness: &Harness<Seen>) -> Vec<WallsOf> {
    asks::<WallsOf>(harness)
}

/// The frame that was asked for is shown.
fn answer(harness: &mut Harness<Seen>) {
    let camera = harness.state().inspector.draft().expect("a draft").camera;
    let mut capture = z_fail(SIZE);
    capture.camera = camera;
    harness.state_mut().inspector.set_capture(Arc::new(capture));
    harness.run_steps(1);
}

#[test]
fn one_walks_ahead_while_w_is_held_a_frame_at_a_time() {
    let mut harness = walking();
    harness.key_down(Key::W);
    harness.run_steps(4);
    assert_eq!(runs(&harness).len(), 1, "nothing queues up while a frame is waited for");
    let eye = |harness: &Harness<Seen>| last_run(harness).camera.eye;
    let first = eye(&harness);
    assert!(first.z < 8.0 && first.x == 0.0 && first.y == 2.0, "{first}");
    answer(&mut harness);
    harness.run_steps(2);
    assert_eq!(runs(&harness).len(), 2);
    assert!(eye(&harness).z < first.z);
    harness.key_up(Key::W);
    harness.run_steps(1);
    answer(&mut harness);
    harness.run_steps(3);
    assert_eq!(runs(&harness).len(), 2, "no key is held");
}

#[test]
fn the_mouse_looks_around() {
    let mut harness = walking();
    harness.event(Event::MouseMoved(vec2(100.0, 30.0)));
    harness.run_steps(2);
    let camera = last_run(&harness).camera;
    let ahead = (camera.target - camera.eye).normalize();
    let before = box_scene().camera;
    assert_eq!(camera.eye, before.eye);
    assert!(ahead.x > 0.15, "to the right: {ahead}");
    assert!(ahead.y < (before.target - before.eye).normalize().y, "and down: {ahead}");
}

#[test]
fn p_goes_through_techniques_and_i_through_sizes_of_the_map() {
    let mut harness = walking();
    let mut names = Vec::new();
    for _ in 0..6 {
        press(&mut harness, Key::P);
        names.push(last_run(&harness).choice.technique());
    }
    use Technique::{None, Planar, Projective, ShadowMap, ZFail, ZPass};
    assert_eq!(names, [ShadowMap, None, Planar, Projective, ZPass, ZFail]);
    let before = runs(&harness).len();
    press(&mut harness, Key::I);
    assert_eq!(runs(&harness).len(), before, "z-fail has no map");
    let because = "I does nothing: z-fail has neither map nor texture. P goes to one that has";
    harness.get_by_label(because);
    press(&mut harness, Key::P);
    assert!(harness.query_by_label(because).is_none(), "the next key that does something takes its place");
    let size = |harness: &Harness<Seen>| last_run(harness).choice.settings()["size"].clone();
    let sizes: Vec<String> = (0..5)
        .map(|_| {
            press(&mut harness, Key::I);
            size(&harness)
        })
        .collect();
    assert_eq!(sizes.iter().collect::<BTreeSet<_>>().len(), 5, "{sizes:?}");
    assert!(sizes.contains(&"4096".to_owned()) && sizes.contains(&"256".to_owned()));
}

#[test]
fn v_lays_silhouettes_and_volumes_over_the_picture_and_speed_and_walls_are_reported() {
    let mut harness = walking();
    let mut seen = Vec::new();
    for _ in 0..4 {
        press(&mut harness, Key::V);
        let kind = harness.state().inspector.picture_kind().expect("a picture");
        seen.push((kind, harness.query_by_label("Overlay 1").is_some()));
    }
    let color = PictureKind::Color;
    assert_eq!(seen, [(color, true), (color, true), (PictureKind::Mask, false), (color, false)]);
    assert!(says(&harness, "walls stop (C) · 2.0 m/s"));
    press(&mut harness, Key::C);
    press(&mut harness, Key::Period);
    assert!(says(&harness, "through walls (C) · 3.0 m/s"));
    press(&mut harness, Key::Comma);
    press(&mut harness, Key::C);
    assert!(says(&harness, "walls stop (C) · 2.0 m/s"));
}

#[test]
fn l_makes_the_lamp_swing_and_stops_it() {
    let mut scene = box_scene();
    let swing = Swing { pivot: DVec3::Y * 6.0, axis: DVec3::Z, degrees: 20.0, period_seconds: 2.0 };
    scene.lights[0].motion.swing = Some(swing);
    let mut harness = harness_of(over(&scene));
    answer(&mut harness);
    click(&mut harness, "Walk");
    answer_walls(&mut harness, &scene);
    press(&mut harness, Key::L);
    assert!(last_run(&harness).time > 0.0);
    harness.key_down(Key::S);
    answer(&mut harness);
    harness.run_steps(3);
    answer(&mut harness);
    harness.run_steps(3);
    let last = last_run(&harness);
    assert!(last.camera.eye.z > 8.0 && last.time > 0.1, "one walks while it swings: {last:?}");
    harness.key_up(Key::S);
    press(&mut harness, Key::L);
    answer(&mut harness);
    let before = runs(&harness).len();
    harness.run_steps(4);
    assert_eq!(runs(&harness).len(), before);
}

#[test]
fn l_says_where_nothing_swings() {
    let mut harness = walking();
    let before = runs(&harness).len();
    press(&mut harness, Key::L);
    harness.get_by_label("L does nothing: nothing moves in this scene");
    assert_eq!(runs(&harness).len(), before);
}

#[test]
fn escape_stops_and_so_does_the_button() {
    let mut harness = walking();
    press(&mut harness, Key::Escape);
    assert!(harness.query_by_label(BANNER).is_none());
    harness.key_down(Key::W);
    harness.run_steps(3);
    assert!(runs(&harness).is_empty());
    harness.key_up(Key::W);
    click(&mut harness, "Walk");
    harness.get_by_label(BANNER);
    click(&mut harness, "Walk");
    assert!(harness.query_by_label(BANNER).is_none());
}

#[test]
fn tab_over_the_picture_begins_and_elsewhere_these_keys_do_nothing_of_it() {
    let mut harness = harness_of(over(&box_scene()));
    answer(&mut harness);
    for key in [Key::P, Key::W, Key::C, Key::I, Key::V, Key::L] {
        press(&mut harness, key);
    }
    assert!(runs(&harness).is_empty());
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Color));
    press(&mut harness, Key::Tab);
    assert!(harness.query_by_label(BANNER).is_none(), "away from the picture it goes from widget to widget");
    press(&mut harness, Key::Escape);
    let at = place_of(&harness, [20, 15], SIZE);
    mouse(&mut harness, at, PointerButton::Primary);
    press(&mut harness, Key::Tab);
    harness.get_by_label(BANNER);
    let step = harness.state().inspector.model.selection.step;
    press(&mut harness, Key::Home);
    assert_eq!(harness.state().inspector.model.selection.step, step, "only the keys of walking act");
    press(&mut harness, Key::Tab);
    assert_eq!(harness.ctx.memory(egui::Memory::focused), None, "nor does Tab go on to a button");
    harness.get_by_label(BANNER);
}

/// A room without a roof, 4 metres each way, with the eye in its middle; the wall to the right is the third object.
fn room() -> Scene {
    let room = [
        common::square("ground", 0.0, 2.0),
        common::cuboid("left", [-2.2, 0.0, -2.0], [-2.0, 3.0, 2.0]),
        common::cuboid("right", [2.0, 0.0, -2.0], [2.2, 3.0, 2.0]),
        common::cuboid("far", [-2.0, 0.0, -2.2], [2.0, 3.0, -2.0]),
        common::cuboid("near", [-2.0, 0.0, 2.0], [2.0, 3.0, 2.2]),
    ];
    let mut scene = Scene { objects: room.to_vec(), ..box_scene() };
    scene.camera.eye = DVec3::new(0.0, 1.5, 0.0);
    scene.camera.target = DVec3::new(0.0, 1.5, -1.0);
    scene
}

/// Begins to walk where nothing was captured yet.
fn begin_in(scene: &Scene) -> Harness<'static, Seen> {
    let mut inspector = Inspector::default();
    inspector.set_scene(scene, draft_of(scene));
    let mut harness = harness_of(inspector);
    answer(&mut harness);
    click(&mut harness, "Walk");
    harness
}

fn walking_in(scene: &Scene) -> Harness<'static, Seen> {
    let mut harness = begin_in(scene);
    for _ in 0..14 {
        press(&mut harness, Key::Period);
    }
    harness
}

/// Where the walker is once a key was held down for some frames.
fn go(harness: &mut Harness<Seen>, key: Key) -> DVec3 {
    harness.key_down(key);
    for _ in 0..3 {
        harness.run_steps(1);
        answer(harness);
    }
    harness.key_up(key);
    harness.run_steps(1);
    eye_of(harness)
}

#[test]
fn walls_hold_at_any_speed() {
    let mut harness = walking_in(&room());
    assert_eq!(go(&mut harness, Key::W), room().camera.eye, "nobody walks before the walls are known");
    answer_walls(&mut harness, &room());
    for key in [Key::W, Key::D, Key::S, Key::A] {
        let eye = go(&mut harness, key);
        assert!(eye.x.abs() < 1.76 && eye.z.abs() < 1.76, "{key:?}: {eye}");
        assert!(eye.x.abs() > 1.7 || eye.z.abs() > 1.7, "it is a wall that stops: {key:?}: {eye}");
    }
    assert_eq!(walls_asked(&harness).len(), 1, "the camera moves no walls");
    press(&mut harness, Key::C);
    assert!(go(&mut harness, Key::D).x > 2.2, "without walls one goes through");
}

#[test]
fn a_wall_that_is_switched_off_stops_nobody_and_one_that_is_back_does() {
    let scene = room();
    let mut harness = walking_in(&scene);
    answer_walls(&mut harness, &scene);
    assert!(go(&mut harness, Key::D).x < 1.76);
    let switch = |harness: &mut Harness<Seen>, off: &[usize]| {
        let mut draft = *harness.state().inspector.draft().expect("a draft");
        draft.off = off.iter().copied().collect();
        draft.camera = scene.camera;
        let actions = harness.state_mut().inspector.rerun(draft);
        harness.state_mut().actions.extend(actions);
        harness.run_steps(1);
        answer_walls(harness, &scene);
        answer(harness);
    };
    switch(&mut harness, &[2]);
    assert_eq!(walls_asked(&harness).len(), 2);
    assert!(go(&mut harness, Key::D).x > 2.5, "the wall to the right is gone");
    switch(&mut harness, &[]);
    assert!(go(&mut harness, Key::D).x < 1.76, "and is there again");
}

#[test]
fn walls_are_asked_for_anew_when_they_move_or_the_file_is_loaded_again() {
    let mut scene = room();
    scene.objects[2].motion.swing =
        Some(Swing { pivot: DVec3::X * 9.0, axis: DVec3::Y, degrees: 80.0, period_seconds: 4.0 });
    let mut harness = walking_in(&scene);
    answer_walls(&mut harness, &scene);
    let before = walls_asked(&harness).len();
    press(&mut harness, Key::L);
    answer(&mut harness);
    let asked = walls_asked(&harness);
    assert!(asked.len() > before && asked[asked.len() - 1].time > 0.0, "the animation has begun");
    press(&mut harness, Key::L);
    answer(&mut harness);
    let before = walls_asked(&harness).len();
    let draft = *harness.state().inspector.draft().expect("a draft");
    change(&mut harness, |inspector| inspector.set_scene(&scene, draft));
    assert_eq!(walls_asked(&harness).len(), before + 1, "another file has other walls");
}

/// The room, with a walker who has weight and begins at this height.
fn falling_from(eye: DVec3, scene: &mut Scene) -> Harness<'static, Seen> {
    scene.camera.target += eye - scene.camera.eye;
    scene.camera.eye = eye;
    let mut harness = begin_in(scene);
    answer_walls(&mut harness, scene);
    harness.run_steps(1);
    assert!(runs(&harness).is_empty(), "one floats at first");
    press(&mut harness, Key::G);
    harness
}

fn eye_of(harness: &Harness<Seen>) -> DVec3 {
    harness.state().inspector.draft().expect("a draft").camera.eye
}

#[test]
fn g_makes_one_fall_land_and_walk_on_the_ground_and_float_again() {
    let mut harness = falling_from(DVec3::new(0.0, 2.6, 0.0), &mut room());
    harness.get_by_label_contains("falling (G)");
    let mut heights = vec![eye_of(&harness).y];
    while runs(&harness).len() > heights.len() - 1 && heights.len() < 200 {
        answer(&mut harness);
        heights.push(eye_of(&harness).y);
    }
    assert!(heights.windows(2).all(|pair| pair[1] <= pair[0]), "{heights:?}");
    assert!((3..100).contains(&heights.len()), "no key is held, and one comes to rest: {heights:?}");
    assert!((eye_of(&harness).y - 1.7).abs() < 1e-9, "{}", eye_of(&harness));
    harness.get_by_label_contains("on the ground (G)");
    for _ in 0..8 {
        press(&mut harness, Key::Period);
    }
    let eye = go(&mut harness, Key::D);
    assert!((eye.y - 1.7).abs() < 1e-9 && eye.x > 1.7 && eye.x < 1.76, "the wall stops: {eye}");
    press(&mut harness, Key::C);
    harness.get_by_label_contains("through walls (C)");
    press(&mut harness, Key::G);
    harness.get_by_label_contains("floating (G)");
}

#[test]
fn who_falls_off_the_world_is_set_back_and_reported() {
    let ground = common::square("ground", 0.0, 2.0);
    let mut scene = Scene { objects: vec![ground], ..room() };
    let mut harness = falling_from(DVec3::new(1.5, 1.7, 0.0), &mut scene);
    for _ in 0..2 {
        press(&mut harness, Key::Period);
    }
    let restore_waiting = "Nothing is below: back where you stood last";
    harness.key_down(Key::D);
    let mut lowest = 1.7;
    for _ in 0..400 {
        harness.run_steps(1);
        answer(&mut harness);
        lowest = f64::min(lowest, eye_of(&harness).y);
        if harness.query_by_label(restore_waiting).is_some() {
            break;
        }
    }
    harness.key_up(Key::D);
    harness.get_by_label(restore_waiting);
    assert!(lowest < -1.0, "{lowest}");
    let eye = eye_of(&harness);
    assert!(eye.x > 1.5 && eye.x < 2.2 && (eye.y - 1.7).abs() < 0.1, "{eye}");
    // Over nothing there is no place to return to but the first.
    let start = DVec3::new(9.0, 5.0, 0.0);
    let mut harness = falling_from(start, &mut scene);
    let floats = "Nothing to land on is below: back where you began, and you float (G)";
    for _ in 0..400 {
        answer(&mut harness);
        if harness.query_by_label(floats).is_some() {
            break;
        }
    }
    harness.get_by_label(floats);
    assert_eq!(eye_of(&harness), start);
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of_walking` writes it.
#[test]
fn pictures_of_walking_can_be_drawn() {
    let gallery = Gallery::open();
    let mut harness = harness_in(over(&box_scene()), [1296.0, 816.0]);
    answer(&mut harness);
    gallery.draw(&mut harness, "walk-before", [1280, 800]);
    click(&mut harness, "Walk");
    gallery.draw(&mut harness, "walk", [1280, 800]);
}
