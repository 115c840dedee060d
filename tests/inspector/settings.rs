//! Settings by their widgets: a word or a number, what has no effect, and the meshes.

use super::*;
use stencilscope::ask::MeshesOf;
use stencilscope::geometry::{Connectivity, EdgeList, Topology};
use stencilscope::reading::ObjectMesh;
use stencilscope::scene::{Mesh, Projection, Spherical};

fn settings_of(technique: &str) -> Harness<'static, Seen> {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    if technique != "z-fail" {
        click_button(&mut harness, technique);
    }
    click(&mut harness, "Scene settings");
    harness
}

fn last_run<'a>(harness: &'a Harness<Seen>) -> &'a RunRequest {
    let Some(Action::Run(request)) = harness.state().actions.last() else { panic!("a run") };
    request
}

fn set(harness: &Harness<Seen>, key: &str) -> Option<String> {
    match harness.state().actions.last() {
        Some(Action::Run(request)) => request.choice.settings().get(key).cloned(),
        _ => None,
    }
}

fn is_off(harness: &Harness<Seen>, key: &str) -> bool {
    harness.get_by_role_and_label(Role::ComboBox, key).accesskit_node().is_disabled()
}

#[test]
fn a_filter_is_chosen_its_number_changed_and_taken_back() {
    let mut harness = settings_of("shadow-map");
    assert!(harness.query_by_label("filter pcf").is_none(), "no number where none is asked for");
    choose(&mut harness, "filter", "pcf");
    assert_eq!(set(&harness, "filter").as_deref(), Some("pcf:3"));
    set_value(&mut harness, "filter pcf", 5.0);
    assert_eq!(set(&harness, "filter").as_deref(), Some("pcf:5"));
    choose(&mut harness, "filter", "none");
    assert_eq!(set(&harness, "filter").as_deref(), Some("none"));
    assert!(harness.query_by_label("filter pcf").is_none());
}

#[test]
fn receivers_are_chosen_by_share_number_or_names() {
    let mut harness = settings_of("planar");
    choose(&mut harness, "receivers", "largest");
    assert_eq!(set(&harness, "receivers").as_deref(), Some("largest:3"));
    set_value(&mut harness, "receivers largest", 5.0);
    assert_eq!(set(&harness, "receivers").as_deref(), Some("largest:5"));
    choose(&mut harness, "receivers", "share");
    set_value(&mut harness, "receivers share", 2.0);
    assert_eq!(set(&harness, "receivers").as_deref(), Some("share:2"));
    choose(&mut harness, "receivers", "named");
    assert_eq!(set(&harness, "receivers").as_deref(), Some("named:floor"));
    harness.get_by_label("receivers named");
    choose(&mut harness, "receivers", "all");
    assert_eq!(set(&harness, "receivers").as_deref(), Some("all"));
    assert!(harness.query_by_label("receivers named").is_none());
}

#[test]
fn an_extrusion_has_a_fraction() {
    let mut harness = settings_of("z-fail");
    choose(&mut harness, "extrusion", "finite");
    assert_eq!(set(&harness, "extrusion").as_deref(), Some("finite:3"));
    set_value(&mut harness, "extrusion finite", 2.5);
    assert_eq!(set(&harness, "extrusion").as_deref(), Some("finite:2.5"));
}

#[test]
fn what_another_setting_switches_off_is_dimmed_and_says_why() {
    let mut harness = settings_of("planar");
    assert!(!is_off(&harness, "blend"));
    choose(&mut harness, "stencil", "off");
    assert!(is_off(&harness, "blend"));
    harness.get_by_role_and_label(Role::ComboBox, "blend").hover();
    harness.run_steps(8);
    harness.get_by_label_contains("without the stencil nothing keeps a pixel from being darkened twice");
    choose(&mut harness, "stencil", "on");
    assert!(!is_off(&harness, "blend"));
}

#[test]
fn epsilon_waits_for_its_mapping_and_reports_how_small_it_is() {
    let mut harness = settings_of("z-fail");
    let epsilon = |harness: &Harness<Seen>| harness.get_by_role_and_label(Role::SpinButton, "epsilon").rect();
    assert!(harness.get_by_role_and_label(Role::SpinButton, "epsilon").accesskit_node().is_disabled());
    assert!(epsilon(&harness).is_positive());
    choose(&mut harness, "depth", "standard-infinite-epsilon");
    let node = harness.get_by_role_and_label(Role::SpinButton, "epsilon");
    assert!(!node.accesskit_node().is_disabled());
    assert_eq!(node.accesskit_node().value().as_deref(), Some("2.4e-7"));
}

#[test]
fn a_setting_says_on_hover_what_it_does() {
    let mut harness = settings_of("z-fail");
    harness.get_by_role_and_label(Role::ComboBox, "operations").hover();
    harness.run_steps(8);
    harness.get_by_label_contains("What a face does: steps that wrap round the ends of the count");
}

#[test]
fn settings_are_in_groups_and_each_value_says_on_hover_what_it_does() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    click(&mut harness, "Scene settings");
    let top = |label: &str| harness.get_by_label(label).rect().top();
    let [casters, counting, left_out] = ["Casters", "In the stencil", "Left out"].map(top);
    let row = |key: &str| harness.get_by_role_and_label(Role::ComboBox, key).rect().top();
    assert!(casters < row("caps") && row("caps") < counting && counting < row("operations"));
    assert!(row("operations") < row("world") && row("world") < left_out);
    click_role(&mut harness, Role::ComboBox, "operations");
    harness.get_all_by_role_and_label(Role::Button, "invert").last().expect("an entry").hover();
    harness.run_steps(40);
    harness.get_by_label_contains("two volumes over one surface read as none");
}

fn object(name: &str, mesh: &Mesh) -> ObjectMesh {
    let edges = EdgeList::new(mesh.triangles(), mesh.positions().len());
    ObjectMesh {
        object: name.to_owned(),
        topology: Arc::new(Topology::new(mesh, Arc::new(Connectivity::new(mesh, &edges)))),
    }
}

#[test]
fn each_mesh_has_a_line_and_says_what_it_means() {
    let mut inspector = inspector(z_fail(SIZE));
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let flipped = common::mesh(&corners, &[[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    inspector.take_in(
        MeshesOf { added: Vec::new() },
        Ok(Arc::new(vec![
            object("box", &common::cuboid("box", [0.0; 3], [1.0; 3]).mesh),
            object("floor", &common::square("floor", 0.0, 1.0).mesh),
            object("turned", &flipped),
        ])),
    );
    let mut harness = harness_in(inspector, TALL);
    click(&mut harness, "Scene settings");
    harness.get_by_label("closed");
    harness.get_by_label("closed, 3 inconsistently wound edges");
    harness.get_by_label("4 open edges").hover();
    harness.run_steps(8);
    harness.get_by_label_contains("Under light-facing, triangles that face away and have nothing before them");
}

#[test]
fn meshes_of_another_scene_are_not_known_yet() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.take_in(
        MeshesOf { added: Vec::new() },
        Ok(Arc::new(vec![object("floor", &common::square("floor", 0.0, 1.0).mesh)])),
    );
    inspector.set_scene(&scene(), run_request(Technique::ZFail));
    let mut harness = harness_in(inspector, [1280.0, 1200.0]);
    click(&mut harness, "Scene settings");
    harness.get_by_label("They are looked at once the first frame is captured.");
}

#[test]
fn what_was_changed_is_marked_and_goes_back_by_itself() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    click(&mut harness, "Scene settings");
    assert!(harness.query_by_label_contains("Reset ").is_none(), "nothing was changed");
    let place = harness.get_by_role_and_label(Role::SpinButton, "Field of view").rect();
    set_value(&mut harness, "Field of view", 70.0);
    assert_eq!(harness.get_by_role_and_label(Role::SpinButton, "Field of view").rect(), place, "nothing moves for it");
    click_button(&mut harness, "Reset field of view");
    assert_eq!(last_run(&harness).camera, scene().camera);
    assert!(harness.query_by_label_contains("Reset ").is_none());
}

/// A parallel camera shows the target as large as the pinhole did, and has numbers of its own.
#[test]
fn a_parallel_projection_is_chosen_and_taken_back() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    click(&mut harness, "Scene settings");
    let field_of_view = |harness: &Harness<Seen>| {
        harness.get_by_role_and_label(Role::SpinButton, "Field of view").accesskit_node().is_disabled()
    };
    assert!(!field_of_view(&harness) && harness.query_by_label("Half height").is_none());
    choose(&mut harness, "Projection", "orthographic");
    let half_height = scene().camera.half_height_at_target();
    assert_eq!(last_run(&harness).camera.projection, Projection::Orthographic { half_height });
    assert!(field_of_view(&harness), "it has no effect");
    choose(&mut harness, "Projection", "oblique");
    set_value(&mut harness, "Half height", 3.0);
    set_value(&mut harness, "Oblique angle", 30.0);
    set_value(&mut harness, "Oblique depth factor", 1.0);
    let cavalier = Projection::Oblique { half_height: 3.0, angle_degrees: 30.0, factor: 1.0 };
    assert_eq!(last_run(&harness).camera.projection, cavalier);
    click_button(&mut harness, "Reset camera projection");
    assert_eq!(last_run(&harness).camera, scene().camera);
    assert!(harness.query_by_label_contains("Reset ").is_none());
}

/// A new frustum shows what the camera did; its edges are numbers of their own, and the field of view has no effect.
#[test]
fn a_frustum_is_chosen_moved_off_centre_and_taken_back() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    click(&mut harness, "Scene settings");
    assert!(harness.query_by_label("Frustum left").is_none());
    choose(&mut harness, "Projection", "frustum");
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let symmetric = scene().camera.to_frustum(aspect);
    assert_eq!(last_run(&harness).camera.projection, symmetric);
    assert!(harness.get_by_role_and_label(Role::SpinButton, "Field of view").accesskit_node().is_disabled());
    let Projection::Frustum { left, bottom, top, .. } = symmetric else { panic!("a frustum") };
    set_value(&mut harness, "Frustum right", 0.25);
    let moved = Projection::Frustum { left, right: 0.25, bottom, top };
    assert_eq!(last_run(&harness).camera.projection, moved);
    let gallery = pictures::Gallery::open();
    if gallery.folder.is_some() {
        gallery.draw(&mut harness, "frustum", TALL.map(|side| side as u32 - 2 * pictures::MARGIN));
    }
    click_button(&mut harness, "Reset camera projection");
    assert_eq!(last_run(&harness).camera, scene().camera);
}

/// A part of the picture is chosen by where it begins and how large it is; all of it is no viewport.
#[test]
fn a_viewport_is_chosen_and_taken_back() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    click(&mut harness, "Scene settings");
    set_value(&mut harness, "Viewport width", 0.5);
    set_value(&mut harness, "Viewport left", 0.25);
    set_value(&mut harness, "Viewport height", 0.75);
    assert_eq!(last_run(&harness).camera.viewport, Some([0.25, 0.0, 0.5, 0.75]));
    // It ends at the picture's edge.
    set_value(&mut harness, "Viewport left", 0.9);
    assert_eq!(last_run(&harness).camera.viewport, Some([0.5, 0.0, 0.5, 0.75]));
    click_button(&mut harness, "Reset viewport across");
    click_button(&mut harness, "Reset viewport down");
    assert_eq!(last_run(&harness).camera, scene().camera);
}

/// The eye goes round its target by angles, and its place follows.
#[test]
fn the_eye_is_moved_by_r_theta_and_phi() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    click(&mut harness, "Scene settings");
    // Down from right above, then round, then nearer.
    let before = Spherical::of(&scene().camera);
    assert!((before.phi_degrees - 90.0).abs() < 1e-9, "{before:?}");
    set_value(&mut harness, "camera φ", 30.0);
    set_value(&mut harness, "camera θ", 60.0);
    set_value(&mut harness, "camera r", before.r / 2.0);
    let camera = last_run(&harness).camera;
    let wanted = Spherical { r: before.r / 2.0, theta_degrees: 60.0, phi_degrees: 30.0 };
    assert!((camera.eye - wanted.eye_about(camera.target)).length() < 1e-9, "{camera:?}");
    assert_eq!(camera.target, scene().camera.target);
    click_button(&mut harness, "Reset camera eye");
    assert_eq!(last_run(&harness).camera, scene().camera);
    assert!(harness.query_by_label_contains("Reset ").is_none());
}

#[test]
fn what_is_only_looked_at_is_not_changed() {
    let mut scene = scene();
    scene.lights[0].color = [1.0, 0.95, 0.85];
    let mut inspector = inspector(z_fail(SIZE));
    let request = RunRequest { lights: scene.lights.clone(), ..run_request(Technique::ZFail) };
    inspector.set_scene(&scene, request.clone());
    let mut harness = harness_in(inspector, TALL);
    click(&mut harness, "Scene settings");
    harness.run_steps(3);
    assert_eq!(harness.state().inspector.draft().as_deref(), Some(&request));
    assert!(harness.query_by_label("Reset light 1 colour").is_none());
}

#[test]
fn a_setting_of_the_technique_goes_back_to_its_default() {
    let mut inspector = inspector(z_fail(SIZE));
    let mut choice = Choice::new(Technique::ZFail);
    choice.set("casters", "light-facing").expect("a setting");
    assert!(!inspector.choose(choice).is_empty());
    let mut harness = harness_in(inspector, TALL);
    harness.get_by_label("z-fail, changed: casters light-facing");
    click(&mut harness, "Scene settings");
    click_button(&mut harness, "Reset casters");
    assert_eq!(last_run(&harness).choice, Choice::new(Technique::ZFail));
}

#[test]
fn a_light_is_switched_off_and_on_again() {
    let mut harness = settings_of("z-fail");
    let before = harness.state().inspector.draft().expect("a draft").lights.clone();
    // Below the technique's settings.
    harness.get_by_label("light 1 is on").scroll_to_me();
    harness.run_steps(3);
    click(&mut harness, "light 1 is on");
    let off = last_run(&harness).lights.clone();
    assert_eq!(off.iter().map(|light| light.is_on).collect::<Vec<_>>(), [false]);
    assert_eq!(off[0].emitted(), [0.0; 3]);
    click(&mut harness, "light 1 is on");
    assert_eq!(last_run(&harness).lights, before, "as bright as it was");
}

/// A number that is written otherwise is no other number.
#[test]
fn a_value_that_equals_its_default_has_nothing_to_be_reset() {
    let mut inspector = inspector(z_fail(SIZE));
    let mut request = run_request(Technique::ShadowMap);
    let default = request.choice.settings()["bias-slope"].clone();
    let number: f64 = default.parse().expect("a number");
    request.choice.set("bias-slope", &format!("{number:.3}")).expect("the same number");
    assert_ne!(request.choice.settings()["bias-slope"], default);
    inspector.set_scene(&scene(), request);
    let mut harness = harness_in(inspector, TALL);
    click(&mut harness, "Scene settings");
    assert!(harness.query_by_label_contains("Reset ").is_none());
    set_value(&mut harness, "bias-slope", 7.0);
    harness.get_by_label("Reset bias-slope");
}

/// A field shows some of its number's digits, and keeps them all while nothing is typed.
#[test]
fn a_field_that_is_left_without_typing_changes_nothing() {
    let mut inspector = inspector(z_fail(SIZE));
    let mut request = run_request(Technique::ZFail);
    request.camera.eye.x = 1.0 / 3.0;
    inspector.set_scene(&scene(), request.clone());
    let mut harness = harness_in(inspector, TALL);
    click(&mut harness, "Scene settings");
    let before = harness.state().actions.len();
    focus_role(&mut harness, Role::SpinButton, "camera eye x");
    press(&mut harness, Key::Enter);
    harness.run_steps(3);
    assert!(runs(&harness).is_empty(), "{:?}", &harness.state().actions[before..]);
    assert!(harness.query_by_label_contains("Reset camera").is_none());
    focus_role(&mut harness, Role::SpinButton, "camera eye x");
    harness.event(Event::Text("2.5".to_owned()));
    press(&mut harness, Key::Enter);
    harness.run_steps(3);
    assert_eq!(last_run(&harness).camera.eye.x, 2.5);
}

/// A viewport as wide as the picture can't begin later, and its field says why.
#[test]
fn a_field_that_snaps_back_says_why() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    click(&mut harness, "Scene settings");
    focus_role(&mut harness, Role::SpinButton, "Viewport left");
    harness.event(Event::Text("0.5".to_owned()));
    press(&mut harness, Key::Enter);
    harness.run_steps(3);
    assert!(says(&harness, "make it smaller first"));
    assert!(runs(&harness).is_empty());
}

/// Beside a viewport nothing is drawn: that is no background of the scene.
#[test]
fn a_pixel_beside_the_viewport_is_said_to_be_there() {
    let mut inspector = inspector(z_fail(SIZE));
    let mut request = run_request(Technique::ZFail);
    request.camera.viewport = Some([0.5, 0.0, 0.5, 1.0]);
    inspector.set_scene(&scene(), request);
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    inspector.model.selection.pick = Some([3, 4]);
    let mut harness = harness_of(inspector);
    harness.get_by_label("Outside the viewport.");
    harness.get_by_label_contains("20×30 pixels from 20, 0");
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([25, 4]));
    assert!(!says(&harness, "Outside the viewport."));
}

/// Long numbers of a place go on in another row: none is cut off in a narrow window.
#[test]
fn long_coordinates_of_the_eye_are_all_in_the_panel() {
    let mut inspector = inspector(z_fail(SIZE));
    let mut request = run_request(Technique::ZFail);
    request.camera.eye = DVec3::new(-123.456, -1234.56, -98.765);
    inspector.set_scene(&scene(), request);
    let mut harness = harness_in(inspector, [1000.0, 2000.0]);
    click(&mut harness, "Scene settings");
    let panel = harness.get_by_role_and_label(Role::TabPanel, "Scene settings").rect();
    for name in ["camera eye x", "camera eye y", "camera eye z", "camera r", "camera θ", "camera φ"] {
        let field = harness.get_by_role_and_label(Role::SpinButton, name).rect();
        assert!(panel.contains_rect(field), "{name}: {field} in {panel}");
    }
}

/// Three numbers of hundreds with decimals are wider than a column: the third is in a line of its own, above the next row.
#[test]
fn long_coordinates_keep_their_rows_apart() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), TALL);
    show_tab(&mut harness, "Scene settings");
    let mut request = *harness.state().inspector.draft().expect("a scene");
    request.camera.eye = DVec3::new(516.833, 217.634, -268.034);
    request.camera.target = DVec3::new(500.0, 200.0, -300.096);
    change(&mut harness, |inspector| drop(inspector.rerun(request)));
    harness.run_steps(4);
    let rect = |name: &str| harness.get_by_role_and_label(Role::SpinButton, name).rect();
    let rows = ["camera eye", "camera target", "camera up"]
        .map(|name| ["x", "y", "z"].map(|at| rect(&format!("{name} {at}"))));
    for [above, below] in rows.array_windows::<2>() {
        for (one, other) in above.iter().flat_map(|one| below.iter().map(move |other| (one, other))) {
            assert!(one.bottom() <= other.top(), "{one} over {other}");
        }
    }
}

/// A light is moved more often than one of a technique's two dozen settings is changed.
#[test]
fn lights_stand_before_the_settings_of_the_technique() {
    for technique in ["z-fail", "shadow-map"] {
        let harness = settings_of(technique);
        let settings = rect(&harness, &format!("Settings of {technique}"));
        assert!(rect(&harness, "Light 1").bottom() < settings.top(), "{technique}");
        assert!(rect(&harness, "light 1 position x").bottom() < 800.0, "in view without scrolling");
    }
}

/// As everywhere else, and a hyphen is taken all the same.
#[test]
fn a_coordinate_below_zero_has_a_minus_sign() {
    let mut harness = settings_of("z-fail");
    set_value(&mut harness, "light 1 position x", -2.5);
    assert_eq!(last_run(&harness).lights[0].position.x, -2.5);
    let shown = || contrast::words(&harness).into_iter().map(|word| word.text).collect::<Vec<_>>();
    assert!(shown().iter().any(|text| text.starts_with("−2.5")), "{:?}", shown());
    assert!(!shown().iter().any(|text| text.starts_with("-2.5")));
}
