//! Scenes made in the window: what is added, moved and deleted is how the scene is run next, and can be undone.

use super::*;
use stencilscope::ask::MeshesOf;
use stencilscope::math::depth::DepthMapping;
use stencilscope::scene::{Light, Object, Pose, Projection, SceneBuilder, UpAxis, model_scene, shapes};

/// A floor and a box, seen from two metres away.
fn scene() -> Scene {
    SceneBuilder::new("a box")
        .object(Object::of("floor", shapes::quad([8.0; 2]).expect("a quad")))
        .object(Object::of("box", shapes::cuboid([1.0; 3]).expect("a box")).at([3.0, 1.0, 0.0]))
        .light(Light::point([0.0, 4.0, 0.0]))
        .seen_from([0.0, 0.5, 2.0], [0.0, 0.5, 0.0])
        .build()
}

/// The settings of a scene that was opened.
fn settings_of(scene: &Scene, source: &str) -> Harness<'static, Seen> {
    let mut inspector = Inspector::new(Vec::new());
    let request = RunRequest::of(scene, Choice::new(Technique::ZFail), SIZE);
    inspector.open_scene(scene, request, Some(source.to_owned()));
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    let mut harness = harness_in(inspector, [1280.0, 3000.0]);
    click(&mut harness, "Scene settings");
    harness
}

/// With all that makes and changes objects unfolded.
fn making(scene: &Scene) -> Harness<'static, Seen> {
    let mut harness = settings_of(scene, "a box");
    click(&mut harness, "Add, move or delete lights and objects");
    harness.run_steps(12);
    harness
}

fn opened() -> Harness<'static, Seen> {
    making(&scene())
}

fn undo(harness: &mut Harness<Seen>) {
    press_with(harness, Modifiers::COMMAND, Key::Z);
}

/// Chooses the object that is edited: its entry may lie below what is seen of the list.
fn choose_object(harness: &mut Harness<Seen>, name: &str) {
    click_role(harness, Role::ComboBox, "Object");
    harness.run_steps(1);
    harness.get_all_by_role_and_label(Role::Button, name).last().expect("an entry").click_accesskit();
    harness.run_steps(3);
}

#[test]
fn what_an_object_shows_is_reported_with_how_it_lies() {
    let pattern = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/pattern.toml");
    let scene = common::opened(&pattern.display().to_string());
    let edited = |name: &str| {
        let mut harness = making(&scene);
        choose_object(&mut harness, name);
        harness
    };
    edited("floor").get_by_label("shows tiles.png, 64×64, 1.2 m along X and Z");
    edited("crate").get_by_label("shows crate.png, 32×32, as its corners say");
    assert!(edited("ring").query_by_label_contains("shows ").is_none());
}

#[test]
fn shapes_are_added_where_the_eye_looks_under_names_of_their_own() {
    let mut harness = opened();
    click_button(&mut harness, "torus");
    let added = last_run(&harness).objects.added;
    assert_eq!((added[0].name.as_str(), added[0].pose.translate), ("torus", DVec3::new(0.0, 0.5, 0.0)));
    assert!(added[0].casts && added[0].receives && added[0].visible);
    let high =
        added[0].world_positions().iter().map(|point| point.distance(added[0].pose.translate)).fold(0.0, f64::max);
    assert!((0.1..0.5).contains(&high), "{high} m of the two metres to it");
    // The scene has a box already.
    click_button(&mut harness, "sphere");
    harness.get_all_by_role_and_label(Role::Button, "box").next().expect("the button that adds").click();
    harness.run_steps(2);
    let names: Vec<String> = last_run(&harness).objects.added.into_iter().map(|object| object.name).collect();
    assert_eq!(names, ["torus", "sphere", "box 2"]);
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!(last_run(&harness).objects.added.len(), 1);
}

#[test]
fn lights_are_added_and_deleted() {
    let mut harness = opened();
    click_button(&mut harness, "point light");
    click_button(&mut harness, "sun");
    let lights = last_run(&harness).lights;
    assert_eq!((lights.len(), lights[1].is_directional(), lights[2].is_directional()), (3, false, true));
    assert_eq!(lights[1].position.truncate(), DVec3::new(0.0, 2.5, 0.0), "above what the eye looks at");
    click_button(&mut harness, "Delete light 1");
    assert_eq!(last_run(&harness).lights, lights[1..]);
    undo(&mut harness);
    assert_eq!(last_run(&harness).lights, lights);
    for _ in 0..3 {
        click_button(&mut harness, "Delete light 1");
    }
    assert!(last_run(&harness).lights.is_empty());
}

#[test]
fn objects_of_the_scene_and_new_ones_are_moved_rotated_and_scaled() {
    let mut harness = opened();
    choose_object(&mut harness, "floor");
    set_value(&mut harness, "object position y", -0.5);
    set_value(&mut harness, "object turn z", 10.0);
    let run = last_run(&harness);
    let pose = run.objects.moved[&0];
    assert_eq!((pose.translate.y, pose.rotate_degrees.z, pose.scale), (-0.5, 10.0, DVec3::ONE));
    assert_eq!(run.applied_to(&scene()).objects[0].pose, pose);
    set_value(&mut harness, "object scale x", 0.0);
    assert_eq!(last_run(&harness).objects.moved[&0].scale, DVec3::ONE, "it would be flat");
    set_value(&mut harness, "object turn z", 0.0);
    set_value(&mut harness, "object position y", 0.0);
    assert!(last_run(&harness).objects.moved.is_empty(), "it is where it was loaded");
    click_button(&mut harness, "cylinder");
    set_value(&mut harness, "object scale y", 2.0);
    assert_eq!(last_run(&harness).objects.added[0].pose.scale.y, 2.0);
    click_button(&mut harness, "Z is up");
    let rotated = last_run(&harness).objects.added[0].pose;
    let up = rotated.world_from_object().transform_vector3(DVec3::Z).normalize();
    assert!(up.distance(DVec3::Y) < 1e-12, "{up}");
}

#[test]
fn a_deleted_object_is_gone_and_those_after_it_keep_what_was_changed() {
    let mut harness = opened();
    for name in ["torus", "sphere", "cylinder"] {
        click_button(&mut harness, name);
    }
    let delete = |harness: &mut Harness<Seen>, name: &str| {
        choose_object(harness, name);
        click_button(harness, "Delete");
    };
    delete(&mut harness, "torus");
    let names = |harness: &Harness<Seen>| -> Vec<String> {
        last_run(harness).applied_to(&scene()).objects.into_iter().map(|object| object.name).collect()
    };
    assert_eq!(names(&harness), ["floor", "box", "sphere", "cylinder"]);
    delete(&mut harness, "floor");
    assert_eq!(names(&harness), ["box", "sphere", "cylinder"]);
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!(names(&harness), ["floor", "box", "torus", "sphere", "cylinder"]);
}

#[test]
fn the_eye_turns_to_an_object_and_sees_all_of_it() {
    let mut harness = opened();
    choose_object(&mut harness, "box");
    click_button(&mut harness, "Look at it");
    let camera = last_run(&harness).camera;
    assert_eq!(camera.target, DVec3::new(3.0, 1.0, 0.0));
    let away = (camera.eye - camera.target).normalize();
    assert!(away.distance(DVec3::Z) < 1e-12, "from where it looked before: {away}");
    let half = (camera.fov_y_degrees / 2.0).to_radians().tan();
    for corner in scene().objects[1].world_positions() {
        let from_eye = corner - camera.eye;
        let share = from_eye.y.abs().max(from_eye.x.abs()) / -from_eye.z / half;
        assert!(share < 0.9 && -from_eye.z > camera.near, "{corner}: {share}");
    }
    // So it is where the view's axis is out of the picture.
    choose(&mut harness, "Projection", "frustum");
    let Projection::Frustum { right, .. } = last_run(&harness).camera.projection else { panic!("a frustum") };
    set_value(&mut harness, "Frustum left", right / 4.0);
    click_button(&mut harness, "Look at it");
    let camera = last_run(&harness).camera;
    assert!(camera.center().x > 0.0);
    let depth = DepthMapping::ReversedInfinite.curve(camera.near, 0.0, 0.0);
    let clip_from_view = camera.clip_from_view(1.0, &depth);
    for corner in scene().objects[1].world_positions() {
        let seen = clip_from_view * (camera.world_from_view().transpose() * (corner - camera.eye)).extend(1.0);
        assert!(seen.x.abs().max(seen.y.abs()) < 0.95 * seen.w && seen.z < seen.w, "{corner}: {seen}");
    }
}

#[test]
fn what_can_not_be_run_says_why() {
    let mut request = RunRequest { objects: Default::default(), ..run_request(Technique::ZFail) };
    let mesh = Arc::new(shapes::cuboid([1.0; 3]).expect("a box"));
    request.objects.added.push(Object::of("a", mesh.clone()).scaled([1.0, 0.0, 1.0]));
    assert!(request.check().expect_err("flat").contains("must not be zero"));
    request.objects.added = vec![Object::of("a", mesh.clone()).at([f64::NAN, 0.0, 0.0])];
    assert!(request.check().expect_err("nowhere").contains("finite numbers"));
    request.objects.added = vec![Object::of("a", mesh); 201];
    assert!(request.check().expect_err("too many").contains("delete some"));
}

#[test]
fn lights_go_back_to_what_they_were_opened_with_though_others_were_added_and_deleted() {
    let mut scene = scene();
    scene.lights.push(Light::point([5.0, 6.0, 7.0]));
    let mut harness = making(&scene);
    set_value(&mut harness, "light 2 intensity", 3.0);
    click_button(&mut harness, "point light");
    click_button(&mut harness, "Delete light 1");
    assert_eq!(last_run(&harness).lights.len(), 2);
    assert!(harness.query_by_label_contains("Reset light 2").is_none(), "the one that was added is as it is");
    click_button(&mut harness, "Reset light 1 intensity");
    assert_eq!(last_run(&harness).lights[0], scene.lights[1]);
    for _ in 0..3 {
        undo(&mut harness);
    }
    assert_eq!(last_run(&harness).lights.len(), 2);
    click_button(&mut harness, "Reset light 2 intensity");
    assert_eq!(last_run(&harness).lights, scene.lights);
}

#[test]
fn meshes_of_objects_that_are_added_are_asked_for_with_the_scene_s() {
    let mut harness = opened();
    click_button(&mut harness, "torus");
    harness.run_steps(2);
    let asked = asks::<MeshesOf>(&harness);
    let last = asked.last().expect("meshes are asked for");
    assert_eq!(last.added.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["torus"]);
    set_value(&mut harness, "object position x", 0.7);
    assert_eq!(asks::<MeshesOf>(&harness).len(), asked.len(), "where it is changes nothing of its mesh");
}

#[test]
fn a_far_plane_is_set_and_taken_away() {
    let mut harness = opened();
    click(&mut harness, "Has a far plane");
    let far = last_run(&harness).camera.far.expect("a far plane");
    assert!(far > last_run(&harness).camera.near);
    set_value(&mut harness, "Far plane", 25.0);
    assert_eq!(last_run(&harness).camera.far, Some(25.0));
    click_button(&mut harness, "Reset far plane");
    assert_eq!(last_run(&harness).camera.far, None);
}

#[test]
fn a_model_with_z_up_is_rotated_and_stands_on_its_floor_before_the_camera() {
    let (scene, mut harness) = settings_over(UpAxis::Y, |_| {});
    click_button(&mut harness, "z up");
    let run = last_run(&harness);
    let rotated = run.applied_to(&scene);
    let ends = |object: &Object| {
        let heights = object.world_positions().into_iter().map(|at| at.y);
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| [low.min(y), high.max(y)])
    };
    let [low, high] = ends(&rotated.objects[0]);
    assert!((high - low - 6.0).abs() < 1e-9, "its z axis is up");
    let gap = |scene: &Scene| ends(&scene.objects[0])[0] - ends(&scene.objects[1])[1];
    assert!((gap(&rotated) - gap(&scene)).abs() < 1e-9 && gap(&scene) > 0.0, "as near above the floor as before");
    assert!((run.camera.target.y - (low + high) / 2.0).abs() < 1e-9 && run.lights[0].position.y > high);
    click_button(&mut harness, "y up");
    assert_eq!(last_run(&harness), RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE));
}

/// The settings over a model's scene, opened with an axis up.
fn settings_over(up: UpAxis, change: impl FnOnce(&mut Scene)) -> (Scene, Harness<'static, Seen>) {
    let mesh = shapes::cuboid([1.0, 2.0, 6.0]).expect("a box");
    let mut scene = model_scene("tower", mesh, true, up).expect("a model's scene");
    change(&mut scene);
    let harness = settings_of(&scene, "tower.obj");
    (scene, harness)
}

#[test]
fn rotating_a_model_leaves_a_light_and_a_camera_where_they_were_placed_by_hand() {
    let lamp = DVec3::new(9.0, 8.0, 7.0);
    let (scene, mut harness) = settings_over(UpAxis::Y, |scene| scene.lights[0].position = lamp.extend(1.0));
    click_button(&mut harness, "z up");
    let run = last_run(&harness);
    assert_eq!(run.lights[0].position, lamp.extend(1.0), "the light was put there");
    assert_ne!(run.camera, scene.camera, "the camera was not");
    let (scene, mut harness) = settings_over(UpAxis::Y, |scene| scene.camera.eye += DVec3::Y);
    click_button(&mut harness, "z up");
    let run = last_run(&harness);
    assert_eq!(run.camera, scene.camera);
    assert_ne!(run.lights, scene.lights);
    // A field of view of one's own is no place.
    let (scene, mut harness) = settings_over(UpAxis::Y, |scene| scene.camera.fov_y_degrees = 70.0);
    click_button(&mut harness, "z up");
    let camera = last_run(&harness).camera;
    assert!(camera.fov_y_degrees == 70.0 && camera.eye != scene.camera.eye, "{camera:?}");
}

#[test]
fn a_floor_that_was_moved_stays_when_the_model_is_rotated() {
    let (scene, mut harness) = settings_over(UpAxis::Y, |_| {});
    let floor = Pose { translate: DVec3::Y * -3.0, ..scene.objects[1].pose };
    let mut draft = harness.state().inspector.draft().expect("a draft").as_ref().clone();
    draft.objects.moved.insert(1, floor);
    let actions = harness.state_mut().inspector.rerun(draft);
    harness.state_mut().actions.extend(actions);
    harness.run_steps(1);
    click_button(&mut harness, "z up");
    assert_eq!(last_run(&harness).objects.moved[&1], floor);
}

#[test]
fn a_model_that_was_opened_with_z_up_is_rotated_back_to_what_it_is_with_y_up() {
    let (z_up, mut harness) = settings_over(UpAxis::Z, |_| {});
    let (y_up, _) = settings_over(UpAxis::Y, |_| {});
    click_button(&mut harness, "y up");
    let rotated = last_run(&harness).applied_to(&z_up);
    assert_eq!((rotated.camera, &rotated.lights), (y_up.camera, &y_up.lights));
    let heights = |scene: &Scene| {
        let of = |object: &Object| object.world_positions().iter().map(|at| at.y).fold(f64::INFINITY, f64::min);
        scene.objects.iter().map(of).collect::<Vec<f64>>()
    };
    assert!(heights(&rotated).iter().zip(heights(&y_up)).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", heights(&rotated));
    click_button(&mut harness, "z up");
    assert_eq!(last_run(&harness).applied_to(&z_up).camera, z_up.camera);
}
