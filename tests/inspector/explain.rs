//! The State tab, the Explain tab and the guided tours, over real frames.

use super::*;
use stencilscope::plan::LeftOut;
use stencilscope::reading::left_out::by_reason;

/// The panels over a frame of a built-in scene, with its plan.
pub fn over(name: &str, technique: Technique) -> Inspector {
    let frame = common::frame(&mut common::session(), name, common::request(technique, [160, 120]));
    let (scene, request) = frame.made().expect("a scene");
    let mut inspector = Inspector::new(Vec::new());
    inspector.open_scene(scene, RunRequest::of(scene, request.choice.clone(), request.size), Some(name.to_owned()));
    inspector.set_capture(frame.capture);
    inspector.set_plan(frame.plan);
    inspector
}

fn touring() -> Harness<'static, Seen> {
    let mut harness = harness_in(over("tori", Technique::ZFail), [1600.0, 1000.0]);
    show_tab(&mut harness, "Explain");
    harness
}

/// The state of the first draw of the volumes.
fn state_of_volumes() -> Harness<'static, Seen> {
    let mut inspector = over("tori", Technique::ZFail);
    inspector.select_draw(1, 0);
    let mut harness = harness_in(inspector, [1600.0, 1600.0]);
    show_tab(&mut harness, "State");
    harness
}

#[test]
fn the_state_of_a_volume_pass_is_reported_in_a_sentence_and_in_three_apis_words() {
    let mut harness = state_of_volumes();
    harness.get_by_label_contains("one that fails the depth test adds 1 (255 becomes 0)");
    harness.get_by_label_contains("depthFailOp: \"increment-wrap\"");
    click_button(&mut harness, "OpenGL");
    harness.get_by_label("glStencilOpSeparate(GL_BACK, GL_KEEP, GL_INCR_WRAP, GL_KEEP);");
    click_button(&mut harness, "Direct3D 12");
    harness.get_by_label("BackFace.StencilDepthFailOp = D3D12_STENCIL_OP_INCR;");
    click_button(&mut harness, "Copy state");
    harness.get_by_label_contains("clip_from_relative (camera)");
}

/// What is not there is not kept.
#[test]
fn a_pass_without_a_stencil_says_that_there_is_none() {
    let mut inspector = over("tori", Technique::ShadowMap);
    inspector.select_draw(0, 0);
    let mut harness = harness_in(inspector, [1600.0, 1600.0]);
    show_tab(&mut harness, "State");
    let [stencil, none] = ["stencil", "no buffer"].map(|words| harness.get_by_label(words).rect());
    assert!((stencil.center().y - none.center().y).abs() < 4.0, "{stencil:?}, {none:?}");
    assert!(!says(&harness, "stencil kept"));
}

/// A light that a shadow keeps away adds nothing.
#[test]
fn shading_says_what_a_shadow_keeps_away() {
    let mut inspector = over("tori", Technique::ZFail);
    let capture = Arc::clone(inspector.model.frame.capture.as_ref().expect("a capture"));
    let at = stencilscope::reading::notable_pixel::in_shadow(&capture).expect("a dark pixel");
    inspector.model.selection.pick = Some(at);
    let plan = inspector.model.frame.plan.clone().expect("a plan");
    let history = common::session().history(&plan, &capture, at).expect("a history");
    let mut harness = harness_in(inspector, TALL);
    change(&mut harness, |inspector| inspector.take_in(HistoryOf { at }, Ok(Arc::new(history))));
    click(&mut harness, "Shading");
    harness.get_by_label("From light 1: kept away by the shadow");
    harness.get_by_label("would add");
    assert!(harness.query_by_label("adds").is_none());
}

#[test]
fn what_an_api_has_unless_reported_otherwise_is_marked_and_what_was_set_is_not() {
    let mut harness = state_of_volumes();
    for (api, defaults, set) in [
        (
            "WebGPU",
            &["cullMode: \"none\",", "stencilReadMask: 0xff,", "pass.setStencilReference(0);"][..],
            &["depthCompare: \"greater\",", "depthWriteEnabled: false,", "writeMask: 0,"][..],
        ),
        (
            "OpenGL",
            &["glDisable(GL_CULL_FACE);", "glStencilFuncSeparate(GL_BACK, GL_ALWAYS, 0, 0xff);"],
            &["glDepthMask(GL_FALSE);", "glStencilOpSeparate(GL_BACK, GL_KEEP, GL_INCR_WRAP, GL_KEEP);"],
        ),
        (
            "Direct3D 12",
            &["DepthBias = 0;", "BackFace.StencilPassOp = D3D12_STENCIL_OP_KEEP;"],
            &["StencilEnable = TRUE;", "CullMode = D3D12_CULL_MODE_NONE;"],
        ),
    ] {
        click_button(&mut harness, api);
        harness.run_steps(2);
        for line in defaults {
            harness.get_by_label(&format!("{line} // default"));
        }
        for line in set {
            harness.get_by_label(line);
        }
        harness.get_by_label_contains(&format!("lines differ from what {api} has by default"));
        let count = harness.query_all_by_label_contains(" // default").count();
        assert!(count > 3, "{api}: {count} defaults");
    }
}

#[test]
fn a_capture_folder_reports_the_state_as_its_plan_has_it() {
    let mut inspector = over("tori", Technique::ZFail);
    let capture = Arc::clone(inspector.model.frame.capture.as_ref().expect("a capture"));
    inspector.open_folder(None);
    inspector.set_capture(capture);
    inspector.model.select_step(1);
    let mut harness = harness_in(inspector, [1600.0, 1200.0]);
    show_tab(&mut harness, "State");
    harness.get_by_label("As the capture's plan tells it");
    harness.get_by_label_contains("depth fail IncrementWrap");
}

#[test]
fn each_pass_is_explained_with_the_scenes_own_numbers() {
    let mut inspector = over("rings", Technique::ZFail);
    inspector.model.selection.pick = Some([80, 60]);
    let mut harness = harness_in(inspector, [1600.0, 1600.0]);
    show_tab(&mut harness, "Explain");
    press(&mut harness, Key::Home);
    harness.get_by_label("stored depth = offset + scale / distance along the view");
    harness.get_by_label_contains("pixel 80, 60: 0 + ");
    press(&mut harness, Key::ArrowRight);
    harness.get_by_label_contains("count = back faces behind the surface − front faces behind it");
    harness.get_by_label_contains("pixels have a count other than 0");
    harness.get_by_label_contains("sides, between each silhouette edge");
    assert!(harness.query_all_by_label("Left out").count() > 0);
    press(&mut harness, Key::ArrowRight);
    harness.get_by_label("light is added where count = 0");
    show_tab(&mut harness, "Passes");
    click(&mut harness, "mask");
    assert!(harness.query_all_by_label_contains(" in shadow, ").count() > 0);
}

#[test]
fn what_was_left_out_stands_there_with_its_reason() {
    let inspector = over("tori", Technique::Auto);
    let left_out = inspector.model.frame.capture.as_ref().expect("a capture").left_out.clone();
    let mut harness = harness_in(inspector, [1600.0, 3000.0]);
    show_tab(&mut harness, "Explain");
    let reasons = by_reason(&left_out);
    assert!(!reasons.is_empty(), "auto leaves something out");
    for reason in &reasons {
        assert!(harness.query_all_by_label(reason.because).count() > 0, "{}", reason.because);
        for thing in reason.things.iter().take(4) {
            assert!(harness.query_all_by_label(&thing.title).count() > 0, "{}", thing.title);
        }
    }
    // Triangles of several objects are one line, whose tooltip has each.
    let sum = reasons.iter().flat_map(|reason| &reason.things).find(|thing| thing.each.len() > 1).expect("a sum");
    harness.query_all_by_label(&sum.title).last().expect("a line").hover();
    harness.run_steps(8);
    for each in &sum.each {
        assert!(says(&harness, each), "{each}");
    }
}

#[test]
fn a_long_list_of_what_was_left_out_is_folded() {
    let mut inspector = over("tori", Technique::Auto);
    let mut capture = Capture::clone(inspector.model.frame.capture.as_ref().expect("a capture"));
    let left = capture.left_out.first().cloned().expect("auto leaves something out");
    let names: Vec<String> = (0..20).map(|index| format!("post {index:02}")).collect();
    capture.left_out = names.iter().map(|name| LeftOut { decision: None, of: name.clone(), ..left.clone() }).collect();
    inspector.set_capture(Arc::new(capture));
    let mut harness = harness_in(inspector, [1600.0, 3000.0]);
    show_tab(&mut harness, "Explain");
    let listed = |harness: &Harness<Seen>| names.iter().filter(|name| says(harness, name)).count();
    // In the list of passes too.
    assert_eq!(listed(&harness), 4);
    assert_eq!(harness.query_all_by_label(&left.because).count(), 2, "the reason stands once in each");
    harness.get_all_by_label("16 more for this reason").last().expect("a fold").click();
    harness.run_steps(2);
    assert_eq!(listed(&harness), names.len());
}

#[test]
fn a_tour_drives_the_panels_stop_by_stop() {
    let mut harness = touring();
    let kind = harness.state().inspector.model.view.kind;
    change(&mut harness, |inspector| inspector.set_zoom(TexelZoom::Pixels(4.0), [100.0, 20.0]));
    click_button(&mut harness, "Tour of z-fail");
    harness.run_steps(3);
    harness.get_by_label("What every pixel shows");
    assert_eq!(harness.state().inspector.model.view.zoom, TexelZoom::Fit, "what it speaks of is seen");
    assert_eq!(harness.state().inspector.model.selection.step, 0);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Depth));
    click_button(&mut harness, "Next stop");
    harness.run_steps(3);
    assert_eq!(harness.state().inspector.model.selection.step, 1);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Stencil));
    click_button(&mut harness, "Next stop");
    harness.run_steps(3);
    harness.get_by_label("What a cap is");
    harness.get_by_label_contains("the scene's geometry");
    click_button(&mut harness, "Next stop");
    harness.run_steps(3);
    harness.get_by_label("Who failed the depth test");
    harness.get_by_label("Picture canvas");
    click_button(&mut harness, "Next stop");
    harness.run_steps(3);
    harness.get_by_label_contains("The State tab has the whole state");
    harness.get_by_role_and_label(Role::Button, "OpenGL");
    click_button(&mut harness, "Next stop");
    harness.run_steps(3);
    let inspector = &harness.state().inspector;
    let [x, y] = inspector.model.selection.pick.expect("a pixel");
    let shadow = inspector.model.frame.capture.as_ref().expect("a capture").lights[0].shadow.clone().expect("labels");
    assert_eq!(shadow.byte_at([x, y]), Some(1), "it picks a pixel in shadow");
    click_button(&mut harness, "Stop before");
    harness.get_by_label("The same in the API's words");
    change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Depth));
    click_button(&mut harness, "End tour");
    assert!(harness.query_by_label("Next stop").is_none());
    let view = &harness.state().inspector.model.view;
    assert_eq!(view.kind, kind, "the kind of picture is the one before the tour");
    assert_eq!((view.zoom, view.center), (TexelZoom::Pixels(4.0), [100.0, 20.0]), "and so is the zoom");
}

/// What the user looked at before a tour is there again after it, also where another scene was open meanwhile.
#[test]
fn a_tour_gives_back_pick_overlays_and_undo() {
    let mut inspector = over("tori", Technique::ZFail);
    let mut moved = *inspector.draft().expect("a draft");
    moved.lights[0].position.y += 0.25;
    drop(inspector.rerun(moved));
    inspector.set_capture(Arc::clone(inspector.model.frame.capture.as_ref().expect("a capture")));
    inspector.model.selection.pick = Some([81, 62]);
    inspector.model.modes.overlays.insert(stencilscope::inspector::Overlay::Names);
    let mut harness = harness_in(inspector, [1600.0, 1000.0]);
    let undoes = harness.state().inspector.model.undoes();
    assert!(undoes.is_some());
    click_button(&mut harness, "Tours");
    click_button(&mut harness, "Begin the tour of z-fail");
    harness.run_steps(3);
    let next = |harness: &Harness<Seen>| harness.get_by_role_and_label(Role::Button, "Next stop").rect();
    let place = next(&harness);
    let capture = Arc::clone(harness.state().inspector.model.frame.capture.as_ref().expect("a capture"));
    show_capture(&mut harness, Capture::clone(&capture));
    for _ in 0..3 {
        click_button(&mut harness, "Next stop");
        harness.run_steps(3);
        assert_eq!(next(&harness), place, "the button stays under the pointer");
    }
    assert!(!harness.state().inspector.model.modes.overlays.contains(&stencilscope::inspector::Overlay::Names));
    click_button(&mut harness, "End tour");
    show_capture(&mut harness, Capture::clone(&capture));
    let model = &harness.state().inspector.model;
    assert_eq!(model.selection.pick, Some([81, 62]));
    assert!(model.modes.overlays.iter().eq([&stencilscope::inspector::Overlay::Names]));
    assert_eq!(model.undoes(), undoes);
}

/// Opened again after a tour, a scene is first shown by another technique: what was looked at comes back with its own frame.
#[test]
fn what_a_tour_gives_back_waits_for_its_own_frame() {
    let mut inspector = over("tori", Technique::ZFail);
    let [own, draft] = [(); 2].map(|()| inspector.draft().map(|draft| *draft).expect("a draft"));
    let before = Arc::clone(inspector.model.frame.capture.as_ref().expect("a capture"));
    inspector.model.selection.pick = Some([81, 62]);
    inspector.model.select_step(1);
    let selected = inspector.model.selected();
    let mut harness = harness_in(inspector, [1600.0, 1000.0]);
    click_button(&mut harness, "Tours");
    click_button(&mut harness, "Begin the tour of planar");
    let rings = over("rings", Technique::Planar);
    let scene = common::opened("rings");
    let request = *rings.draft().expect("a draft");
    let capture = Arc::clone(rings.model.frame.capture.as_ref().expect("a capture"));
    change(&mut harness, |inspector| {
        inspector.open_scene(&scene, request, Some("rings".to_owned()));
        inspector.set_capture(capture);
        inspector.model.selection.pick = Some([5, 6]);
    });
    harness.get_by_label_contains("A floor that catches shadows");
    click_button(&mut harness, "End tour");
    let planar = Choice::new(Technique::Planar);
    let frame = common::frame(&mut common::session(), "tori", common::request(Technique::Planar, [160, 120]));
    let scene = common::opened("tori");
    change(&mut harness, |inspector| {
        inspector.open_scene(&scene, RunRequest { choice: planar, ..draft }, Some("tori".to_owned()));
        inspector.set_capture(frame.capture);
        inspector.set_job(Some("capturing tori".to_owned()));
    });
    harness.run_steps(3);
    assert_eq!(*harness.state().inspector.draft().expect("a draft"), own, "its own run is asked for");
    assert_ne!(harness.state().inspector.model.selection.pick, Some([81, 62]), "of another frame");
    show_capture(&mut harness, Capture::clone(&before));
    let model = &harness.state().inspector.model;
    assert_eq!((model.selection.pick, model.selected()), (Some([81, 62]), selected));
}

/// The worker says why, and that it is done.
fn fail(harness: &mut Harness<Seen>, reason: &str) {
    harness.state_mut().inspector.push_failure(reason.to_owned());
    change(harness, |inspector| inspector.set_job(None));
}

#[test]
fn a_stop_whose_frame_can_not_be_made_says_why_and_is_tried_again_or_skipped() {
    let mut harness = touring();
    click_button(&mut harness, "Tour of planar");
    harness.get_by_label("The frame is being made …");
    // Its scene can't be opened.
    fail(&mut harness, "no memory: close another program");
    harness.get_by_label("× This stop's frame can't be made: no memory: close another program");
    assert!(harness.query_by_label("The frame is being made …").is_none());
    let before = harness.state().actions.len();
    harness.run_steps(5);
    assert_eq!(harness.state().actions.len(), before, "nothing is tried by itself, and not in another scene");
    let opened = harness.state().actions[before - 1].clone();
    click_button(&mut harness, "Try this stop again");
    assert_eq!(harness.state().actions[before..], [opened]);
    harness.get_by_label("The frame is being made …");
    let scene = common::opened("rings");
    let shown = over("rings", Technique::Planar);
    let draft = *shown.draft().expect("a draft");
    harness.state_mut().inspector.open_scene(&scene, draft, Some("rings".to_owned()));
    // Its frame can't be made either.
    fail(&mut harness, "the picture is too large: make it smaller");
    harness.get_by_label("× This stop's frame can't be made: the picture is too large: make it smaller");
    harness.get_by_label_contains("stop 1 of");
    let before = harness.state().actions.len();
    click_button(&mut harness, "Skip this stop");
    harness.get_by_label_contains("stop 2 of");
    let asked = &harness.state().actions[before..];
    assert!(matches!(asked, [Action::Run(_)]), "the next stop tries again: {asked:?}");
    change(&mut harness, |inspector| {
        inspector.set_capture(Arc::clone(shown.model.frame.capture.as_ref().expect("a capture")))
    });
    assert!(harness.query_by_label_contains("can't be made").is_none());
    assert!(harness.query_by_label("The frame is being made …").is_none(), "the tour went on");
}

/// The stop before it has the same scene and technique, and other settings: its frame is another.
#[test]
fn a_stop_whose_settings_can_not_be_run_does_not_speak_of_the_frame_before() {
    let mut harness = harness_in(over("table", Technique::ShadowMap), [1600.0, 1000.0]);
    let technique = Technique::ShadowMap;
    change(&mut harness, |inspector| drop(inspector.go_to_stop(technique, 2)));
    harness.get_by_label_contains("The Shadow map tab marks the texel");
    let mut asked = Vec::new();
    change(&mut harness, |inspector| asked = inspector.go_to_stop(technique, 3));
    let [Action::Run(request)] = &asked[..] else { panic!("a run: {asked:?}") };
    assert_eq!(request.choice.settings()["bias-slope"], "0");
    fail(&mut harness, "no memory: close another program");
    harness.get_by_label("× This stop's frame can't be made: no memory: close another program");
    harness.run_steps(4);
    assert!(says(&harness, "This stop's frame can't be made"), "the frame that is shown is the one before");
    let before = harness.state().actions.len();
    click_button(&mut harness, "Try this stop again");
    let tried = runs(&harness).pop().expect("a run");
    assert!(harness.state().actions.len() > before && tried.choice == request.choice);
    let settings = [("bias-constant", "0"), ("bias-slope", "0")];
    let request = common::request_with(technique, &settings, [160, 120]);
    let frame = common::frame(&mut common::session(), "table", request);
    show_capture(&mut harness, Capture::clone(&frame.capture));
    assert!(!says(&harness, "can't be made") && !says(&harness, "The frame is being made"));
}

#[test]
fn a_tour_asks_for_its_scene_and_waits_for_its_technique() {
    let mut harness = touring();
    click_button(&mut harness, "Tour of planar");
    assert_eq!(harness.state().actions.last(), Some(&Action::Open("rings".to_owned())));
    harness.get_by_label("The frame is being made …");
    // As the app does: the scene is opened with the technique of before, and captured.
    let mut opened = over("rings", Technique::ZFail);
    let capture = Arc::clone(opened.model.frame.capture.as_ref().expect("a capture"));
    let draft = *opened.draft().expect("a draft");
    let rings = common::opened("rings");
    let inspector = &mut harness.state_mut().inspector;
    inspector.open_scene(&rings, draft, Some("rings".to_owned()));
    inspector.set_capture(capture);
    harness.run_steps(3);
    let Some(Action::Run(request)) = harness.state().actions.last() else { panic!("a run") };
    assert_eq!(request.choice.technique(), Technique::Planar);
    harness.get_by_label("The frame is being made …");
    opened = over("rings", Technique::Planar);
    change(&mut harness, |inspector| {
        inspector.set_capture(Arc::clone(opened.model.frame.capture.as_ref().expect("a capture")))
    });
    harness.get_by_label_contains("Planar shadows know one kind of receiver");
    let inspector = &harness.state().inspector;
    assert_eq!(
        inspector.model.frame.capture.as_ref().expect("a capture").steps[inspector.model.selection.step].name,
        "receivers"
    );
}

#[test]
fn who_has_picked_nothing_is_offered_the_tour_of_the_technique() {
    let mut harness = harness_in(over("tori", Technique::ZFail), [1600.0, 1000.0]);
    harness.get_by_label("Counting behind the surface: right for any camera: 9 stops with z-fail.");
    click_button(&mut harness, "Take the tour");
    harness.run_steps(3);
    harness.get_by_label("tour of z-fail, stop 1 of 9");
    let mut picked = over("tori", Technique::ZFail);
    picked.model.selection.pick = Some([80, 60]);
    assert!(harness_in(picked, [1600.0, 1000.0]).query_by_label("Take the tour").is_none());
}
