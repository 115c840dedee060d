//! The panels over another program's frame.

use super::*;
use stencilscope::accuracy::Finding;
use stencilscope::capture::RecomputeDifference;
use stencilscope::diagnosis::Cause;
use stencilscope::import::{ConvertedFrame, SHIPPED, ShippedFrame, convert, read};
use stencilscope::inspector::PanelKind;
use stencilscope::plan::{FramePlan, Program, ShaderEffect};
use stencilscope::session::FrameSource;

/// A surface of `ogre` in the shadow of the torus.
const DARK: [u32; 2] = [60, 140];

/// A recording of the repository, compared with its own rerun.
pub fn frame(session: &mut Session, name: &str) -> RunFrame {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/recordings").join(name);
    let ConvertedFrame { plan, capture, scene, .. } =
        convert(&read(&folder).expect("a recording"), name).expect("a frame");
    let capture = session.compared_with_rerun(&plan, &capture, &Progress::default()).expect("checked");
    let source = scene.map(|scene| Arc::new(FrameSource { scene, request: None }));
    RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source }
}

pub fn inspector(frame: &RunFrame) -> Inspector {
    let mut inspector = Inspector::new(Vec::new());
    inspector.open_folder(Some("ogre"));
    inspector.set_capture(Arc::clone(&frame.capture));
    inspector.set_plan(Arc::clone(&frame.plan));
    inspector
}

/// Answers all that is asked, as the worker does, until nothing is.
pub fn answer_all(harness: &mut Harness<Seen>, session: &mut Session, frame: &RunFrame) {
    for _ in 0..8 {
        harness.run_steps(2);
        let actions = std::mem::take(&mut harness.state_mut().actions);
        for action in actions {
            let Action::Ask(asked) = action else { continue };
            let result = session.answer(&asked.ask, None, Some(frame), &Progress::default());
            let result = result.map_err(|error| error.to_string());
            harness.state_mut().inspector.answer(asked.ticket, result, true);
        }
    }
}

fn changed(frame: &RunFrame, change: impl FnOnce(&mut FramePlan, &mut Capture)) -> RunFrame {
    let (mut plan, mut capture) = (FramePlan::clone(&frame.plan), Capture::clone(&frame.capture));
    change(&mut plan, &mut capture);
    RunFrame { plan: Arc::new(plan), capture: Arc::new(capture), source: frame.source.clone() }
}

#[test]
fn it_says_who_drew_the_frame_and_what_can_not_be_done_with_it() {
    let mut session = common::session();
    let ogre = frame(&mut session, "ogre");
    let mut harness = harness_of(inspector(&ogre));
    harness.get_by_label("OpenGL · depth D24S8 · recorded by RenderDoc 1.24");
    harness.get_by_label("drawn by another program: its technique can't be changed");
    harness.get_by_label_contains("no technique can be measured on it");
    for gone in ["Measure", "Walk", "Gizmos"] {
        assert!(harness.query_by_role_and_label(Role::Button, gone).is_none(), "{gone}");
    }
    click(&mut harness, "Scene settings");
    harness.get_by_label_contains("its lights, camera and technique can't be changed");
    click(&mut harness, "Diagnosis");
    harness.get_by_label_contains("Follows rays through the frame's own triangles");
    harness.get_by_role_and_label(Role::Button, "Diagnose");
    click(&mut harness, "Shadow map");
    harness.get_by_label_contains("This frame has no shadow map");
    click(&mut harness, "State");
    harness.get_by_label("viewport");
    harness.get_by_label_contains("its matrices are not known");
}

#[test]
fn a_picked_pixel_has_its_history() {
    let mut session = common::session();
    let ogre = frame(&mut session, "ogre");
    let mut harness = harness_in(inspector(&ogre), TALL);
    pick_by_mouse(&mut harness, DARK, ogre.capture.size);
    answer_all(&mut harness, &mut session, &ogre);
    assert_eq!(harness.state().inspector.model.selection.pick, Some(DARK));
    harness.get_by_label_contains("Dark under light 1");
    harness.get_by_label_contains("so the light pass skips it");
    let names = harness.query_all_by_label_contains("side of").count() + harness.query_all_by_label("side").count();
    assert!(names <= 1, "but for the column's title: which part of a volume a face is, is not known");
    let depth = ogre.capture.depth;
    let stored = ogre.capture.frame_at(ogre.capture.steps.len() - 1).and_then(|frame| frame.depth.image.depth_at(DARK));
    let away = depth.distance(stored.expect("a depth")).expect("a surface");
    let distance = format!("{} units", stencilscope::reading::format::digits(away));
    assert!(
        harness.query_all_by_label_contains(&distance).count() > 0,
        "the distance, in a unit that nobody knows: {distance}"
    );
    let in_metres: Vec<String> = (harness.query_all_by_label_contains(" m"))
        .flat_map(|node| [node.accesskit_node().label(), node.accesskit_node().value()])
        .flatten()
        .filter(|words| words.ends_with(" m") || words.contains(" m,") || words.contains(" m:"))
        .collect();
    assert!(in_metres.is_empty(), "nothing is told in metres: {in_metres:?}");
    let rows = harness.query_all_by_role(Role::Row).count();
    assert!(rows >= 3, "{rows} rows");
    assert!(harness.query_by_label_contains("holds pictures and no geometry").is_none());
}

#[test]
fn draws_that_make_something_else_are_marked() {
    let mut session = common::session();
    let ogre = frame(&mut session, "ogre");
    let ogre = changed(&ogre, |plan, capture| {
        capture.steps.iter_mut().flat_map(|step| &mut step.draws).for_each(|draw| draw.differs = None);
        capture.steps[1].draws[1].differs = Some(RecomputeDifference { depth: 0, stencil: 1234, rounded: 5 });
        let program = Program::Recorded { may_discard: ShaderEffect::Yes, writes_depth: ShaderEffect::Unknown };
        plan.passes[1].draws[1].program = program;
    });
    let name = ogre.capture.steps[1].draws[1].name.clone();
    let mut harness = harness_of(inspector(&ogre));
    click(&mut harness, "2 · volumes");
    let row = harness.get_by_label(&format!("{name}, differs")).rect();
    harness.hover_at(row.center());
    harness.run_steps(8);
    harness.get_by_label_contains("another stencil at 1\u{a0}234 pixels and another depth at 0 pixels");
    harness.get_by_label_contains("Its shader may discard fragments, which is not followed");
    harness.get_by_label_contains("Its shader could not be read: it may write its own depth");
    let others = harness.query_all_by_label_contains(", differs").count();
    assert_eq!(others, 1);
}

#[test]
fn debug_groups_are_levels_that_fold() {
    let mut session = common::session();
    let ogre = frame(&mut session, "ogre");
    let ogre = changed(&ogre, |plan, _| {
        let groups: [&[&str]; 3] = [&["frame"], &["frame", "shadows"], &["frame", "shadows"]];
        for (pass, groups) in plan.passes.iter_mut().zip(groups) {
            let recorded = pass.recorded.as_mut().expect("recorded");
            recorded.groups = groups.iter().map(|name| (*name).to_owned()).collect();
        }
    });
    let mut harness = harness_of(inspector(&ogre));
    let left = |harness: &Harness<Seen>, label: &str| harness.get_by_label(label).rect().left();
    assert!(left(&harness, "Debug group frame") < left(&harness, "Debug group shadows"));
    assert!(left(&harness, "1 · surfaces") < left(&harness, "2 · volumes"));
    assert!(harness.query_by_label("Light 1 · point").is_none());
    click(&mut harness, "Debug group shadows");
    assert!(harness.query_by_label("2 · volumes").is_none());
    harness.get_by_label("1 · surfaces");
    // Stepping to a pass shows it.
    press(&mut harness, Key::Home);
    press(&mut harness, Key::ArrowRight);
    harness.get_by_label("2 · volumes");
    click(&mut harness, "Debug group frame");
    assert!(harness.query_by_label("1 · surfaces").is_none());
    click(&mut harness, "Debug group frame");
    harness.get_by_label("1 · surfaces");
}

#[test]
fn truth_is_asked_for_and_the_wrong_pixels_are_counted() {
    let mut session = common::session();
    let ogre = frame(&mut session, "ogre");
    for (lies, words) in [(false, "none wrong"), (true, "wrong")] {
        // A stored picture that calls the shadow of every caster light.
        let frame = changed(&ogre, |_, capture| {
            if lies {
                let labels = capture.lights[0].shadow.take().expect("labels");
                let bytes = labels.rows().flatten().map(|label| if *label == 1 { 0 } else { *label });
                let bytes: Vec<u8> = bytes.collect();
                let lit = Image::packed(labels.format(), capture.size, bytes);
                capture.lights[0].shadow = Some(Arc::new(lit));
            }
        });
        let mut harness = harness_of(inspector(&frame));
        click_button(&mut harness, "Error");
        answer_all(&mut harness, &mut session, &frame);
        assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Error));
        let shown = harness.get_all_by_label_contains(words).next();
        assert!(shown.is_some());
        let error = harness
            .state()
            .inspector
            .model
            .frame
            .capture
            .as_ref()
            .and_then(|capture| capture.error())
            .expect("an error");
        assert_eq!(error.wrong() > 1000, lies, "{error:?}");
    }
}

#[test]
fn the_scene_tab_has_volumes_surfaces_and_the_found_light() {
    let mut session = common::session();
    for name in ["ogre", "ogre-inside"] {
        let frame = frame(&mut session, name);
        let scene = &frame.source.as_ref().expect("a scene").scene;
        let anatomy = session.anatomy(scene, None, &frame.plan);
        assert!(anatomy.is_view_assumed && anatomy.frusta.len() == 1);
        assert_eq!(anatomy.lights[0].position, frame.capture.lights[0].position);
        assert!(anatomy.volumes.len() >= 3, "{name}: {}", anatomy.volumes.len());
        for volume in &anatomy.volumes {
            assert!(anatomy.objects[volume.caster].casts, "{name}");
            // What does not begin at the caster is at infinity, on the way from the light.
            let far = volume.vertices.iter().filter(|corner| corner.w == 0.0).count();
            assert!(far > 0, "{name}: a volume without end");
        }
        let casters: BTreeSet<usize> = anatomy.volumes.iter().map(|volume| volume.caster).collect();
        assert!(casters.len() >= 3, "{name}: {casters:?}");
        let mut harness = harness_of(inspector(&frame));
        harness.get_by_role_and_label(Role::Tab, "Scene").click();
        answer_all(&mut harness, &mut session, &frame);
        harness.get_by_label("Free view of the scene");
        harness.get_by_label_contains("90° is assumed");
        assert!(harness.query_by_label("Gizmos").is_none());
    }
}

#[test]
fn without_a_found_light_scene_and_truth_say_why() {
    let mut session = common::session();
    let ogre = RunFrame { source: None, ..frame(&mut session, "ogre") };
    let mut harness = harness_of(inspector(&ogre));
    click_button(&mut harness, "Error");
    answer_all(&mut harness, &mut session, &ogre);
    harness.get_by_label_contains("neither shadow volumes nor a shadow map tell where its light is");
    click_button(&mut harness, "Colour");
    harness.get_by_role_and_label(Role::Tab, "Scene").click();
    answer_all(&mut harness, &mut session, &ogre);
    harness.get_by_label_contains("neither shadow volumes nor a shadow map tell where its light is");
}

/// Distances have a unit that nobody knows, whose name is long.
#[test]
fn nothing_in_the_tabs_of_another_program_s_frame_is_cut_off_or_lies_over_something_else() {
    let mut session = common::session();
    let ogre = frame(&mut session, "ogre");
    let mut wrong = Vec::new();
    for size in [[1280.0, 800.0], [1920.0, 1080.0], [1000.0, 700.0]] {
        let mut inspector = inspector(&ogre);
        inspector.model.selection.pick = Some(DARK);
        let mut harness = harness_in(inspector, size);
        let mut seen = BTreeSet::new();
        for panel in PanelKind::ALL {
            show_tab(&mut harness, panel.title());
            answer_all(&mut harness, &mut session, &ogre);
            harness.remove_cursor();
            harness.run_steps(2);
            let found = never_cut::cut(&mut harness, &mut seen);
            wrong.extend(found.into_iter().map(|one| format!("{size:?} {}: {one}", panel.title())));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn frames_that_come_with_the_program_are_offered_and_open() {
    let entry =
        |shipped: &ShippedFrame| SceneEntry { name: shipped.name.to_owned(), lesson: shipped.lesson.to_owned() };
    let mut inspector = Inspector::new(Vec::new());
    inspector.offer_frames(SHIPPED.iter().map(entry).collect());
    let mut harness = harness_of(inspector);
    click_button(&mut harness, "Open…");
    harness.get_by_label("A frame of another program");
    for shipped in SHIPPED {
        harness.get_by_label(shipped.lesson);
        let whole = shipped.open().expect("a frame");
        assert!(whole.plan.is_some() && whole.scene.is_some(), "{}", shipped.name);
    }
    click_button(&mut harness, "ogre-short");
    assert!(harness.state().actions.contains(&Action::Open("ogre-short".to_owned())));
}

#[test]
fn a_frame_with_volumes_that_end_too_early_shows_where_shadow_is_missing() {
    let mut session = common::session();
    let short = frame(&mut session, "ogre-short");
    let mut inspector = inspector(&short);
    inspector.model.choose_picture(PictureKind::Error);
    let mut harness = harness_of(inspector);
    answer_all(&mut harness, &mut session, &short);
    let error =
        harness.state().inspector.model.frame.capture.as_ref().and_then(|capture| capture.error()).expect("an error");
    assert!(error.missing_shadow > 300 && error.missing_shadow == error.wrong(), "{error:?}");
    click_button(&mut harness, "Go to the largest");
    answer_all(&mut harness, &mut session, &short);
    harness.get_by_label_contains("Lit by light 1");
    harness.get_by_label_contains("so the light pass adds the light");
    harness.get_by_label("History");
}

#[test]
fn a_diagnosis_names_the_fault_with_its_proof() {
    let mut session = common::session();
    let short = frame(&mut session, "ogre-short");
    let mut harness = harness_in(inspector(&short), TALL);
    click(&mut harness, "Diagnosis");
    click_button(&mut harness, "Diagnose");
    answer_all(&mut harness, &mut session, &short);
    harness.get_by_label_contains("compared pixels are wrong");
    harness.get_by_label("finite-extrusion (light 1), proven: 0 pixels left");
    harness.get_by_label_contains("no corner of the volumes is at infinity");
    harness.get_by_label_contains("Extrude them to infinity");
    // Its regions, as for a frame of this program: a click goes to a pixel of one.
    answer_all(&mut harness, &mut session, &short);
    click_role(&mut harness, Role::Row, "1 · missing shadow: 512 pixels, finite-extrusion (proven)");
    let model = &harness.state().inspector.model;
    let truth = model.frame.capture.as_ref().expect("a capture").lights[0].truth.clone().expect("it is asked for");
    let at = model.selection.pick.expect("a pixel");
    assert_eq!(truth.findings.byte_at(at), Some(Finding::MissingShadow as u8));
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Error));
    // The shadow that it would have, beside the one that it has.
    click_button(&mut harness, "Compare with the shadow without finite-extrusion");
    harness.run_steps(3);
    let inspector = &harness.state().inspector;
    assert_eq!(inspector.picture_kind(), Some(PictureKind::Mask));
    let fixed = inspector.model.fixed_mask(0, Cause::FiniteExtrusion, 0).expect("it was run");
    let missing = common::pixels(short.capture.size)
        .filter(|at| truth.findings.byte_at(*at) == Some(Finding::MissingShadow as u8))
        .collect::<Vec<_>>();
    assert!(missing.len() > 300 && missing.iter().all(|at| fixed.byte_at(*at) == Some(1)));
    let drawn = short.capture.lights[0].shadow.clone().expect("labels");
    let differing = common::pixels(short.capture.size).filter(|at| drawn.byte_at(*at) != fixed.byte_at(*at)).count();
    let count = stencilscope::reading::format::counted(differing as u64, "pixel");
    harness.get_by_label_contains(&format!("{count} differ"));
}
