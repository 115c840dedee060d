//! Handles of lights and camera, in the Scene tab and over the picture.

use super::scene_view::{anatomy_by, box_scene, draft_of, farther, over, show, shown};
use super::*;
use glam::DVec4;
use stencilscope::scene::Light;

fn drag_handle(harness: &mut Harness<Seen>, name: &str, by: Vec2) {
    let at = harness.get_by_label(name).rect().center();
    drag(harness, at, by, PointerButton::Primary);
}

#[test]
fn a_dragged_light_moves_in_the_plane_of_the_view_and_the_numbers_follow() {
    let mut harness = shown();
    click(&mut harness, "Front");
    drag_handle(&mut harness, "Light 1 in the Front view", vec2(40.0, -20.0));
    let first = box_scene();
    let light = last_run(&harness).lights[0].position;
    let moved = light - first.lights[0].position;
    assert!(moved.x > 0.1 && (moved.y / moved.x - 0.5).abs() < 0.1, "{moved}");
    assert!(moved.z.abs() < 1e-9 && moved.w == 0.0, "{moved}");
    assert_eq!(last_run(&harness).camera, first.camera);
    click(&mut harness, "Scene settings");
    let shown = harness.get_by_label("light 1 position x").value().expect("a number");
    let shown: f64 = shown.parse().expect("a number");
    assert!((shown - light.x).abs() < 0.01, "{shown} is not {}", light.x);
}

#[test]
fn arrow_keys_move_what_has_the_focus_along_the_nearest_axis() {
    let mut harness = shown();
    click(&mut harness, "Top");
    farther(&mut harness, "Top view of the scene");
    focus(&mut harness, "Camera in the Top view");
    let first = box_scene().camera;
    press(&mut harness, Key::ArrowRight);
    let moved = last_run(&harness).camera.eye - first.eye;
    assert!(moved.x > 0.0 && moved.y == 0.0 && moved.z == 0.0, "{moved}");
    press(&mut harness, Key::ArrowUp);
    let moved = last_run(&harness).camera.eye - first.eye;
    assert!(moved.z < 0.0 && moved.y == 0.0, "{moved}");
    assert_eq!(last_run(&harness).camera.target, first.target);
    focus(&mut harness, "Camera target in the Top view");
    press(&mut harness, Key::ArrowLeft);
    assert!(last_run(&harness).camera.target.x < first.target.x);
}

#[test]
fn an_axis_moves_along_itself_alone() {
    let mut harness = shown();
    farther(&mut harness, "Free view of the scene");
    assert!(harness.query_by_label("Light 1 along y in the Free view").is_none(), "axes are of the chosen one");
    focus(&mut harness, "Light 1 in the Free view");
    drag_handle(&mut harness, "Light 1 along y in the Free view", vec2(15.0, -30.0));
    let moved = last_run(&harness).lights[0].position - box_scene().lights[0].position;
    assert!(moved.y > 0.05 && moved.x == 0.0 && moved.z == 0.0, "{moved}");
    focus(&mut harness, "Light 1 along x in the Free view");
    press(&mut harness, Key::ArrowUp);
    let after = last_run(&harness).lights[0].position - box_scene().lights[0].position;
    assert!(after.x > 0.0 && after.y == moved.y, "{after}");
}

/// Panels over a box under a lamp whose map has one face, with shadow maps.
fn over_a_map(settings: &[(&str, &str)]) -> (Inspector, Scene) {
    let mut scene = box_scene();
    scene.lights = vec![Light::point(DVec3::new(3.0, 6.0, 2.0))];
    let choice = common::choice(Technique::ShadowMap, settings);
    let mut inspector = over(&scene);
    inspector.set_scene(&scene, RunRequest { choice: choice.clone(), ..draft_of(&scene) });
    inspector.take_in(AnatomyOf {}, Ok(anatomy_by(&scene, &choice)));
    (inspector, scene)
}

/// The frustum of a lamp's own map: what is dragged becomes the numbers of `light-frustum`, and what is then outside is named.
#[test]
fn a_map_s_planes_and_corners_are_dragged_and_become_the_setting() {
    let given = |harness: &Harness<Seen>| last_run(harness).choice.given_frustum().expect("numbers");
    let (inspector, _) = over_a_map(&[("light-frustum", "60:2:9")]);
    let mut harness = harness_of(inspector);
    show(&mut harness);
    farther(&mut harness, "Free view of the scene");
    drag_handle(&mut harness, "Light 1 map far plane in the Free view", vec2(-12.0, 20.0));
    let [fov, near, far] = given(&harness);
    assert!(fov == 60.0 && near == 2.0 && (far - 9.0).abs() > 0.1, "{far}");
    drag_handle(&mut harness, "Light 1 map near plane in the Free view", vec2(0.0, 12.0));
    let [fov, moved, same] = given(&harness);
    assert!(fov == 60.0 && (moved - near).abs() > 0.05 && same == far, "{moved}");
    // A corner out from the axis widens it, and back narrows it: each by its own key, too.
    let corner = "Light 1 map corner 2 in the Free view";
    let (at, middle) = (
        harness.get_by_label(corner).rect().center(),
        harness.get_by_label("Light 1 map far plane in the Free view").rect().center(),
    );
    drag_handle(&mut harness, corner, (at - middle).normalized() * 15.0);
    let [wide, ..] = given(&harness);
    assert!(wide > 60.5, "{wide}");
    let (at, middle) = (
        harness.get_by_label(corner).rect().center(),
        harness.get_by_label("Light 1 map far plane in the Free view").rect().center(),
    );
    drag_handle(&mut harness, corner, (middle - at).normalized() * 25.0);
    assert!(given(&harness)[0] < wide);
    focus(&mut harness, "Light 1 map far plane in the Free view");
    let before = given(&harness)[2];
    press(&mut harness, Key::ArrowDown);
    assert!((given(&harness)[2] - before).abs() > 1e-4, "keys move it, too");
    // A fitted map has handles as well, and becomes one of numbers.
    let (inspector, _) = over_a_map(&[]);
    let mut harness = harness_of(inspector);
    show(&mut harness);
    farther(&mut harness, "Free view of the scene");
    drag_handle(&mut harness, "Light 1 map near plane in the Free view", vec2(0.0, 14.0));
    let [fov, near, far] = given(&harness);
    assert!(fov > 1.0 && near > 0.0 && far > near, "{fov}:{near}:{far}");
    // Without frusta there are none.
    click(&mut harness, "Frusta");
    assert!(harness.query_by_label("Light 1 map near plane in the Free view").is_none());
}

/// A caster that lies beyond a plane of every map of a light is not in it; one that a plane cuts is.
#[test]
fn a_caster_outside_a_map_is_known_to_be() {
    for (value, is_outside) in [("60:2:9", false), ("60:0.1:2", true), ("60:5.2:9", false), ("60:8:9", true)] {
        let (_, scene) = over_a_map(&[]);
        let anatomy = anatomy_by(&scene, &common::choice(Technique::ShadowMap, &[("light-frustum", value)]));
        let object = anatomy.objects.iter().find(|object| object.name == "box").expect("a box");
        let map = anatomy.frusta.iter().find(|frustum| frustum.of != stencilscope::anatomy::ViewOf::Camera);
        assert_eq!(map.expect("a map").holds_none_of(&object.positions), is_outside, "{value}");
    }
}

#[test]
fn a_direction_is_rotated_and_stays_one() {
    let mut scene = box_scene();
    scene.lights[0] = Light::directional(DVec3::new(0.0, 2.0, 0.0));
    let mut harness = harness_of(over(&scene));
    show(&mut harness);
    click(&mut harness, "Front");
    drag_handle(&mut harness, "Light 1 in the Front view", vec2(60.0, 0.0));
    let towards = last_run(&harness).lights[0].position;
    assert!(towards.w == 0.0 && towards.x > 0.1 && towards.z.abs() < 1e-9, "{towards}");
    assert!((towards.length() - 2.0).abs() < 1e-9, "its length means nothing and stays: {towards}");
}

/// Nothing is run or answered meanwhile: the handle goes over the picture that is there.
#[test]
fn a_dragged_light_s_handle_is_under_the_pointer_in_the_next_frame() {
    let mut harness = shown();
    let name = "Light 1 in the Free view";
    let from = harness.get_by_label(name).rect().center();
    press_left(&mut harness, from);
    for (index, by) in [vec2(12.0, 4.0), vec2(30.0, 16.0), vec2(34.0, 40.0)].into_iter().enumerate() {
        harness.hover_at(from + by);
        harness.step();
        // What is drawn is from before this frame's move, so the handle is seen there in the next.
        harness.step();
        let at = harness.get_by_label(name).rect().center();
        assert!((at - from - by).length() < 2.0, "{at} is not {}", from + by);
        assert_eq!(runs(&harness).len(), index + 1, "each move asks for a run");
    }
}

#[test]
fn without_gizmos_there_are_no_handles() {
    let mut harness = shown();
    harness.get_by_label("Light 1 in the Free view");
    // The other of that name is the picture's, which is not shown.
    click(&mut harness, "Gizmos");
    assert!(harness.query_by_label("Light 1 in the Free view").is_none());
}

#[test]
fn a_light_in_view_is_dragged_over_the_picture() {
    let mut scene = box_scene();
    scene.lights = vec![Light::point(DVec3::new(0.5, 1.5, 1.0)), Light::point(DVec3::new(0.0, 1.0, 20.0))];
    let mut harness = harness_of(over(&scene));
    let before = harness.get_by_label("Light 1 in the picture").rect().center();
    drag_handle(&mut harness, "Light 1 in the picture", vec2(50.0, 0.0));
    let request = last_run(&harness);
    assert_eq!(request.lights[1], draft_of(&scene).lights[1]);
    let moved = request.lights[0].position - scene.lights[0].position;
    let ahead = (scene.camera.target - scene.camera.eye).normalize();
    assert!(moved.x > 0.05 && moved.truncate().dot(ahead).abs() < 1e-9, "parallel to the picture: {moved}");
    let after = harness.get_by_label("Light 1 in the picture").rect().center();
    assert!((after - before - vec2(50.0, 0.0)).length() < 2.0, "it stays under the pointer: {before} to {after}");
    focus(&mut harness, "Light 1 in the picture");
    let before: DVec4 = last_run(&harness).lights[0].position;
    press(&mut harness, Key::ArrowUp);
    assert!(last_run(&harness).lights[0].position.y > before.y);
}

#[test]
fn a_light_out_of_view_has_its_handle_at_the_border_and_comes_in_by_it() {
    let mut scene = box_scene();
    scene.lights = vec![Light::point(DVec3::new(40.0, 1.5, 1.0))];
    let mut harness = harness_of(over(&scene));
    let handle = harness.get_by_label("Light 1 in the picture").rect().center();
    let canvas = harness.get_by_label("Picture canvas").rect();
    assert!(canvas.contains(handle) && canvas.right() - handle.x < 60.0, "{handle} in {canvas}");
    drag_handle(&mut harness, "Light 1 in the picture", vec2(-50.0, 0.0));
    assert!(last_run(&harness).lights[0].position.x < 40.0);
    click(&mut harness, "Gizmos");
    assert!(harness.query_by_label("Light 1 in the picture").is_none());
}

#[test]
fn a_light_behind_the_eye_has_its_handle_at_the_border_on_its_side_and_follows_the_hand() {
    let mut scene = box_scene();
    let ahead = (scene.camera.target - scene.camera.eye).normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let behind = scene.camera.eye - ahead * 3.0;
    scene.lights = vec![Light::point(behind - right), Light::point(behind)];
    let harness = harness_of(over(&scene));
    let handle = harness.get_by_label("Light 1 in the picture").rect().center();
    let canvas = harness.get_by_label("Picture canvas").rect();
    assert!(canvas.contains(handle) && handle.x - canvas.left() < canvas.right() - handle.x, "{handle} in {canvas}");
    let other = harness.get_by_label("Light 2 in the picture").rect().center();
    assert!(canvas.contains(other), "right behind the eye it has one too: {other}");
    // Along the border, in a plane that faces the camera, by as much as at the target: not by the little that a point of
    // the picture is so near the eye. Up is up, though the light is behind the eye.
    let texel = (canvas.width() / SIZE[0] as f32).min(canvas.height() / SIZE[1] as f32);
    let target = (scene.camera.target - scene.camera.eye).length();
    let point_at_target =
        2.0 * (scene.camera.fov_y_degrees.to_radians() / 2.0).tan() * target / f64::from(SIZE[1]) / f64::from(texel);
    for by in [60.0, -40.0] {
        let mut harness = harness_of(over(&scene));
        drag_handle(&mut harness, "Light 1 in the picture", vec2(0.0, by));
        let moved = (last_run(&harness).lights[0].position - scene.lights[0].position).truncate();
        let expected = right.cross(ahead) * -f64::from(by) * point_at_target;
        assert!((moved - expected).length() < 0.02 * expected.length(), "{by}: by {moved}, not {expected}");
        assert_eq!(last_run(&harness).lights[1], draft_of(&scene).lights[1]);
    }
}

#[test]
fn a_light_that_is_pulled_into_the_picture_comes_to_the_pointer_before_the_camera() {
    let mut scene = box_scene();
    let ahead = (scene.camera.target - scene.camera.eye).normalize();
    for place in [scene.camera.eye - ahead * 3.0, scene.camera.eye + DVec3::X * 2.0, DVec3::new(60.0, 1.0, 0.0)] {
        scene.lights = vec![Light::point(place)];
        let mut harness = harness_of(over(&scene));
        let canvas = harness.get_by_label("Picture canvas").rect();
        let from = harness.get_by_label("Light 1 in the picture").rect().center();
        let to = canvas.center() + vec2(30.0, -40.0);
        drag(&mut harness, from, to - from, PointerButton::Primary);
        let handle = harness.get_by_label("Light 1 in the picture").rect().center();
        assert!((handle - to).length() < 3.0, "{place}: it is at {handle} and not at {to}");
        let light = last_run(&harness).lights[0].position.truncate();
        assert!((light - scene.camera.eye).dot(ahead) > 0.5, "{place}: before the eye, at {light}");
    }
}

/// Where it was grabbed beside its middle it stays grabbed, and a little into the picture is enough.
#[test]
fn a_light_that_is_pulled_in_does_not_jump_to_the_pointer() {
    let mut scene = box_scene();
    let ahead = (scene.camera.target - scene.camera.eye).normalize();
    scene.lights = vec![Light::point(scene.camera.eye - ahead * 3.0)];
    let mut harness = harness_of(over(&scene));
    let name = "Light 1 in the picture";
    let canvas = harness.get_by_label("Picture canvas").rect();
    let from = harness.get_by_label(name).rect().center();
    let inwards = (canvas.center() - from).normalized();
    let beside = vec2(6.0, -5.0);
    press_left(&mut harness, from + beside);
    let mut before = from;
    for by in [8.0, 16.0, 24.0, 32.0, 48.0, 64.0] {
        harness.hover_at(from + beside + inwards * by);
        harness.run_steps(2);
        let at = harness.get_by_label(name).rect().center();
        assert!((at - before).length() < 26.0, "after {by} points it jumps from {before} to {at}");
        before = at;
    }
    assert!((before - from - inwards * 64.0).length() < 3.0, "{before}, and it was pulled from {from}");
}

/// The window is given a bare mesh: it has a shadow on a floor, and its light is to be had and moved in both tabs.
#[test]
fn a_dropped_model_has_a_shadow_and_a_light_that_moves() {
    let path = "assets/models/knot.obj";
    let mut harness = harness_of(Inspector::default());
    harness.input_mut().dropped_files.push(Arc::new(Dropped(PathBuf::from(path))));
    harness.run_steps(1);
    assert_eq!(harness.state().actions.last(), Some(&Action::Open(path.to_owned())));
    let mut session = common::session();
    let frame = common::frame(&mut session, path, common::request(Technique::Auto, [160, 90]));
    let scene = frame.scene().expect("a scene").clone();
    let floor = scene.objects.last().expect("a floor").mesh.positions()[0].y;
    let draft = RunRequest::of(&scene, Choice::new(Technique::Auto), [160, 90]);
    let anatomy = pictures::anatomy(&mut session, &frame);
    change(&mut harness, |inspector| {
        inspector.open_scene(&scene, draft, Some(path.to_owned()));
        inspector.set_capture(Arc::clone(&frame.capture));
        inspector.set_plan(Arc::clone(&frame.plan));
        inspector.take_in(AnatomyOf {}, Ok(anatomy));
    });
    let labels = frame.capture.lights[0].shadow.clone().expect("labels");
    let extent = (scene.camera.target - scene.camera.eye).length();
    let on_floor = common::pixels([160, 90])
        .filter(|at| labels.byte_at(*at) == Some(1))
        .filter_map(|at| stencilscope::reading::pick_ray::surface(&frame.capture, at))
        .filter(|at| (at.y - floor).abs() < 1e-3 * extent);
    assert!(on_floor.count() > 200, "a shadow on the floor is seen");
    let before = scene.lights[0].position;
    drag_handle(&mut harness, "Light 1 in the picture", vec2(-80.0, 0.0));
    let moved = (last_run(&harness).lights[0].position - before).truncate().length();
    assert!(moved > 0.05 * extent, "by {moved}, and the camera is {extent} away");
    show(&mut harness);
    let view = harness.get_by_label("Free view of the scene").rect();
    let handle = harness.get_by_label("Light 1 in the Free view").rect();
    assert!(view.contains_rect(handle));
    drag_handle(&mut harness, "Light 1 in the Free view", vec2(60.0, 0.0));
    let after = last_run(&harness).lights[0].position;
    assert!((after - before).truncate().length() > 0.05 * extent, "{after}");
}

#[test]
fn in_the_scene_tab_a_light_out_of_view_has_its_handle_at_the_border() {
    let mut scene = box_scene();
    scene.lights = vec![Light::point(DVec3::new(500.0, 3.0, 0.0))];
    let mut harness = harness_of(over(&scene));
    show(&mut harness);
    let view = harness.get_by_label("Free view of the scene").rect();
    let from = harness.get_by_label("Light 1 in the Free view").rect().center();
    assert!(view.contains(from), "{from} in {view}");
    let to = view.center() + vec2(20.0, -60.0);
    drag(&mut harness, from, to - from, PointerButton::Primary);
    let handle = harness.get_by_label("Light 1 in the Free view").rect().center();
    assert!((handle - to).length() < 3.0, "it is at {handle} and not at {to}");
}

/// In the corner where a view's name and the choice of its projection stand, the handle lies over them.
#[test]
fn a_handle_under_the_name_of_a_view_can_be_had() {
    let mut scene = box_scene();
    scene.lights = vec![Light::point(DVec3::new(-500.0, 500.0, 0.0))];
    let mut harness = harness_of(over(&scene));
    show(&mut harness);
    click(&mut harness, "Front");
    let view = harness.get_by_label("Front view of the scene").rect();
    let choice = harness.get_by_role_and_label(Role::ComboBox, "Projection of the Front view").rect();
    let from = harness.get_by_label("Light 1 in the Front view").rect().center();
    assert!(from.y < choice.bottom() && from.x < choice.right(), "{from} beside {choice}");
    drag(&mut harness, from, view.center() - from, PointerButton::Primary);
    let handle = harness.get_by_label("Light 1 in the Front view").rect().center();
    assert!((handle - view.center()).length() < 3.0, "it is at {handle}");
}

#[test]
fn the_scene_tab_opens_with_light_camera_and_model_in_view() {
    let mut scene = box_scene();
    scene.lights = vec![Light::point(DVec3::new(11.0, 9.0, 3.0))];
    let mut harness = harness_of(over(&scene));
    show(&mut harness);
    let view = harness.get_by_label("Free view of the scene").rect().shrink(12.0);
    for name in ["Light 1 in the Free view", "Camera in the Free view"] {
        let handle = harness.get_by_label(name).rect().center();
        assert!(view.contains(handle), "{name}: {handle} in {view}");
        harness.hover_at(handle);
        harness.run_steps(4);
        assert!(harness.query_by_label_contains("out of view").is_none(), "{name} is no arrow");
    }
}

#[test]
fn objects_are_dragged_in_the_scene_tab_where_that_is_wished() {
    let mut harness = shown();
    click(&mut harness, "Front");
    let name = box_scene().objects[0].name.clone();
    let handle = format!("{name} in the Front view");
    assert!(harness.query_by_label(&handle).is_none(), "objects stay where they are unless they are to be moved");
    click(&mut harness, "Move objects");
    let before = harness.get_by_label(&handle).rect().center();
    let target = "Camera target in the Front view";
    assert!(harness.query_by_label(target).is_none(), "the camera looks at its middle");
    drag_handle(&mut harness, &handle, vec2(30.0, -20.0));
    let pose = last_run(&harness).objects.moved[&0];
    let moved = pose.translate - box_scene().objects[0].pose.translate;
    assert!(moved.x > 0.05 && moved.y > 0.02 && moved.z.abs() < 1e-9, "{moved}");
    let after = harness.get_by_label(&handle).rect().center();
    assert!((after - before - vec2(30.0, -20.0)).length() < 2.0, "it stays under the pointer: {before} to {after}");
    press_with(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(last_run(&harness).objects.moved.is_empty());
    // By its name, which is larger than the square.
    let grab = harness.get_by_label(&handle).rect();
    drag(&mut harness, grab.right_bottom() - vec2(6.0, 6.0), vec2(20.0, 0.0), PointerButton::Primary);
    assert!(last_run(&harness).objects.moved[&0].translate.x > 0.02 && grab.width() > 20.0, "{grab}");
}
