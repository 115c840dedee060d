//! The Diagnosis tab.

use super::pictures::{self, Gallery};
use super::*;
use stencilscope::accuracy::{ErrorCounts, Finding};
use stencilscope::ask::DiagnosisOf;
use stencilscope::diagnosis::{
    Advice, Cause, CauseFound, Diagnosis, Evidence, Fix, FixWithinTechnique, FrameEffect, MeshDefect, MeshFinding,
    ObjectChange, Proof, Quantity, RegionFound, RegionKind, RemainingRegions,
};
use stencilscope::session::InjectedFault;

fn cause(cause: Cause, fix: Fix, proof: Proof, left: u64) -> CauseFound {
    let evidence = Evidence {
        sentence: format!("evidence of {cause}"),
        quantities: vec![Quantity::at_least("volumes around the eye", 1.0, 1.0)],
        shown_by: 3,
        examined: 3,
    };
    CauseFound {
        cause,
        evidence,
        fix: Some(fix),
        proof,
        pixels_left: Some(left),
        whole_frame: Some(FrameEffect { before: 105, after: left + 5 }),
        staying: None,
        together_with: Vec::new(),
    }
}

/// A diagnosis by hand: two regions of z-pass, holes in a mesh.
pub fn found() -> Diagnosis {
    let region = |pixels, kind, at, causes| RegionFound {
        pixels,
        kind: RegionKind::Wrong(kind),
        light: 0,
        bounds: [2, 3, 12, 9],
        at,
        casters: vec!["box".to_owned()],
        receivers: vec!["floor".to_owned()],
        causes,
    };
    let z_fail = || Fix::technique(Technique::ZFail);
    Diagnosis {
        scene: "by hand".to_owned(),
        technique: Technique::ZPass,
        settings: Choice::new(Technique::ZPass).settings().clone(),
        size: SIZE,
        error: ErrorCounts { compared: 1200, false_shadow: 30, missing_shadow: 70, wrong_surface: 0, edge_band: 4 },
        mesh_findings: vec![MeshFinding {
            object: "box".to_owned(),
            kind: MeshDefect::Cause(Cause::OpenMesh),
            count: 3,
            at: Vec::new(),
            effect: "it has holes".to_owned(),
        }],
        flags: Vec::new(),
        regions: vec![
            region(
                70,
                Finding::MissingShadow,
                [5, 6],
                vec![
                    cause(Cause::EyeInVolume, z_fail(), Proof::Proven, 0),
                    cause(Cause::OpenMesh, Fix::setting("casters", "all"), Proof::NotIt, 70),
                ],
            ),
            region(
                30,
                Finding::FalseShadow,
                [9, 4],
                vec![cause(Cause::SplitVertices, Fix::scene(0, "box", ObjectChange::Weld), Proof::Part, 12)],
            ),
        ],
        rest: RemainingRegions { regions: 2, pixels: 5 },
        left_out_of_files: Vec::new(),
        advice: Some(Advice {
            fix: z_fail(),
            wrong_left: 0,
            swimming_left: 0,
            sentence: "To fix it, use z-fail.".to_owned(),
            staying: None,
        }),
    }
}

/// A diagnosis of the open scene as it is to be run now.
pub fn give_diagnosis(inspector: &mut Inspector, diagnosis: Diagnosis) {
    let request = inspector.draft().expect("a scene");
    inspector.take_in(DiagnosisOf { request }, Ok(Arc::new(diagnosis)));
}

fn opened(prepare: impl FnOnce(&mut Inspector)) -> Harness<'static, Seen> {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.set_scene(&scene(), run_request(Technique::ZPass));
    prepare(&mut inspector);
    let mut harness = harness_in(inspector, [1280.0, 900.0]);
    show_tab(&mut harness, "Diagnosis");
    harness
}

pub fn with_regions() -> Harness<'static, Seen> {
    opened(|inspector| give_diagnosis(inspector, found()))
}

const FIRST: &str = "1 · missing shadow of box on floor: 70 pixels, eye-in-volume (proven)";
const SECOND: &str = "2 · false shadow of box on floor: 30 pixels, split-vertices (part)";

#[test]
fn before_anything_is_diagnosed_it_says_what_it_does() {
    let mut harness = opened(|_| ());
    harness.get_by_label_contains("only what takes them away is called proven");
    click_button(&mut harness, "Diagnose");
    assert_eq!(asks::<DiagnosisOf>(&harness).len(), 1);
}

#[test]
fn without_a_scene_nothing_can_be_diagnosed() {
    let mut harness = harness_of(Inspector::default());
    click(&mut harness, "Diagnosis");
    harness.get_by_label_contains("Open a scene to find out");
    click_button(&mut harness, "Diagnose");
    assert!(harness.state().actions.is_empty());
}

#[test]
fn while_it_runs_it_can_be_stopped_and_errors_are_shown() {
    let mut harness = opened(|_| ());
    click_button(&mut harness, "Diagnose");
    let progress = last_asked::<DiagnosisOf>(&harness).progress;
    harness.get_by_label("Diagnosing");
    assert!(harness.query_by_role_and_label(Role::Button, "Diagnose").is_none());
    click_button(&mut harness, "Cancel");
    assert!(progress.is_cancelled());
    click_button(&mut harness, "Diagnose");
    reply::<DiagnosisOf>(&mut harness, Err("the scene is too large: scale it down".to_owned()));
    harness.get_by_label("× the scene is too large: scale it down");
}

#[test]
fn a_region_goes_to_its_pixel_its_history_and_the_step_that_decided() {
    let mut harness = with_regions();
    harness.get_by_label_contains("by hand, z-pass: 100 of 1\u{a0}200 compared pixels are wrong");
    harness.get_by_label("and 2 smaller of 5 pixels");
    let picked = |harness: &Harness<Seen>| {
        let selection = &harness.state().inspector.model.selection;
        (selection.pick, selection.step)
    };
    // Where the light was drawn already, the step stays: it is wrong there in colour, too.
    let last = picked(&harness).1;
    assert!(last > 1);
    click_role(&mut harness, Role::Row, FIRST);
    assert_eq!(picked(&harness), (Some([5, 6]), last));
    change(&mut harness, |inspector| inspector.model.select_step(0));
    click_role(&mut harness, Role::Row, FIRST);
    assert_eq!(picked(&harness), (Some([5, 6]), 1), "after the volumes");
    assert!(asks::<HistoryOf>(&harness).contains(&HistoryOf { at: [5, 6] }));
    assert!(!asks::<TruthOf>(&harness).is_empty(), "the error picture is wished for");
    // By keyboard alike.
    focus_role(&mut harness, Role::Row, SECOND);
    press(&mut harness, Key::Enter);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([9, 4]));
    harness.get_by_label("evidence of split-vertices");
    harness.get_by_label("12 pixels stay wrong");
    harness.get_by_label("To fix it in the scene: weld the vertices of box");
}

#[test]
fn causes_have_their_evidence_proof_and_meaning() {
    let harness = with_regions();
    for words in ["eye-in-volume", "proven", "evidence of eye-in-volume", "not it", "Apply the fix: use z-fail"] {
        harness.get_by_label(words);
    }
    harness.get_by_label(Cause::EyeInVolume.meaning());
    harness.get_by_label("box: open-mesh (3): it has holes");
}

#[test]
fn a_fix_is_applied_and_shown_before_and_after() {
    let mut harness = with_regions();
    harness.state_mut().actions.clear();
    click_button(&mut harness, "Apply the fix: use z-fail");
    let technique = |harness: &Harness<Seen>| match harness.state().actions.last() {
        Some(Action::Run(request)) => request.choice.technique(),
        other => panic!("{other:?}"),
    };
    assert_eq!(technique(&harness), Technique::ZFail);
    harness.get_by_label("shown: after, with the fix");
    harness.get_by_label_contains("(not as it is shown now)");
    click_button(&mut harness, "Show before");
    assert_eq!(technique(&harness), Technique::ZPass);
    harness.get_by_label("shown: before, without the fix");
    click_button(&mut harness, "Show after");
    assert_eq!(technique(&harness), Technique::ZFail);
}

#[test]
fn to_look_at_before_and_after_adds_nothing_to_undo() {
    let mut harness = opened(|inspector| {
        inspector.open_scene(&scene(), run_request(Technique::ZPass), Some("by hand".to_owned()));
        inspector.set_capture(Arc::new(z_fail(SIZE)));
        give_diagnosis(inspector, found());
    });
    click_button(&mut harness, "Apply the fix: use z-fail");
    for words in ["Show before", "Show after", "Show before", "Show after"] {
        click_button(&mut harness, words);
    }
    assert_eq!(last_run(&harness).choice.technique(), Technique::ZFail);
    for _ in 0..2 {
        press_with(&mut harness, Modifiers::COMMAND, Key::Z);
        assert_eq!(last_run(&harness).choice.technique(), Technique::ZPass, "the fix was the only change");
    }
}

#[test]
fn to_show_before_and_after_leaves_the_scenes_time() {
    let mut harness = with_regions();
    click_button(&mut harness, "Apply the fix: use z-fail");
    change(&mut harness, |inspector| inspector.model.scene.as_mut().expect("a scene").draft.time = 3.0);
    for words in ["Show before", "Show after"] {
        click_button(&mut harness, words);
        assert_eq!(last_run(&harness).time, 3.0, "{words}");
    }
}

#[test]
fn another_scene_forgets_what_was_found() {
    let mut harness = with_regions();
    let mut other = scene();
    other.name = "another".to_owned();
    click_button(&mut harness, "Before");
    change(&mut harness, |inspector| inspector.set_scene(&other, run_request(Technique::ZFail)));
    assert_eq!(harness.state().inspector.model.modes.phase.name(), "After", "not as it was before its last step");
    assert!(harness.state().inspector.model.answers.last::<DiagnosisOf>().is_none());
    assert!(harness.query_by_role_and_label(Role::Row, FIRST).is_none());
}

#[test]
fn a_right_frame_says_so_and_small_windows_hold_it() {
    let right = Diagnosis {
        regions: Vec::new(),
        rest: RemainingRegions::default(),
        advice: None,
        error: ErrorCounts { compared: 1200, ..ErrorCounts::default() },
        ..found()
    };
    let harness = opened(|inspector| give_diagnosis(inspector, right));
    harness.get_by_label("No pixel is wrong.");
    harness.get_by_label_contains("none of 1\u{a0}200 compared pixels is wrong");
    for size in [[1920.0, 1080.0], [700.0, 500.0], [320.0, 240.0]] {
        let mut inspector = inspector(z_fail(SIZE));
        give_diagnosis(&mut inspector, found());
        harness_in(inspector, size);
    }
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of` writes them.
#[test]
fn pictures_of_a_diagnosis_can_be_drawn() {
    let gallery = Gallery::open();
    let size = if gallery.folder.is_some() { [1280, 720] } else { [160, 90] };
    let mut session = common::session();
    for technique in [Technique::ZPass, Technique::Planar] {
        let mut frame = common::frame(&mut session, "assets/scenes/shade.toml", common::request(technique, size));
        let (scene, request) = frame.made().expect("a scene");
        let progress = Progress::default();
        let judged = session.judged(scene, &frame.capture, &progress).expect("a truth");
        let diagnosis = session.diagnose(scene, request, InjectedFault::None, &progress).expect("a diagnosis");
        assert!(diagnosis.is_bad(), "{}", technique.name());
        frame.capture = Arc::new(judged);
        let inspector = || {
            let mut inspector = pictures::inspector(&frame, diagnosis.regions[0].at);
            give_diagnosis(&mut inspector, diagnosis.clone());
            inspector
        };
        gallery.show(&format!("diagnosis-{}", technique.name()), gallery.sizes(), inspector, |harness| {
            show_tab(harness, "Diagnosis");
            let first = harness.query_all_by_role(Role::Row).find(|row| {
                row.rect().width() > 0.0 && {
                    let label = row.accesskit_node().label().unwrap_or_default();
                    label.starts_with("1 · ")
                }
            });
            first.expect("the first region").click();
            harness.run_steps(1);
        });
    }
}

#[test]
fn who_stays_with_a_technique_has_a_button_for_what_it_can_do_first() {
    let bias = Fix::setting("bias-slope", "4");
    let whole_frame = Some(FrameEffect { before: 100, after: 3 });
    let staying = Some(FixWithinTechnique { fix: bias.clone(), pixels_left: 1, whole_frame });
    let mut diagnosis = found();
    diagnosis.technique = Technique::ShadowMap;
    let acne = cause(Cause::Acne, Fix::technique(Technique::ZFail), Proof::Proven, 0);
    diagnosis.regions[0].causes = vec![CauseFound { staying: staying.clone(), ..acne }];
    let advice = diagnosis.advice.as_mut().expect("advice");
    advice.fix = advice.fix.and(&Fix::setting("caps", "both"));
    let mut inspector = inspector(z_fail(SIZE));
    inspector.set_scene(&scene(), run_request(Technique::ShadowMap));
    give_diagnosis(&mut inspector, diagnosis);
    let mut harness = harness_in(inspector, [1280.0, 1400.0]);
    show_tab(&mut harness, "Diagnosis");
    let words = "Stay with shadow-map, 1 pixel left here: set bias-slope = 4";
    let stay = harness.get_by_role_and_label(Role::Button, words).rect();
    harness.get_by_label("Whole frame: 100 wrong pixels without it, 3 with it");
    let change = harness.get_by_role_and_label(Role::Button, "Apply the fix: use z-fail").rect();
    assert!(stay.top() < change.top());
    harness.get_by_role_and_label(Role::Button, "Apply all: use z-fail, set caps = both");
    click_button(&mut harness, words);
    let Some(Action::Run(request)) = harness.state().actions.last() else { panic!("a run") };
    assert_eq!(request.choice.technique(), Technique::ShadowMap);
    assert_eq!(request.choice.settings()["bias-slope"], "4");
}

/// A region's proof says nothing of the rest of the frame.
#[test]
fn a_fix_that_makes_the_whole_frame_worse_says_so() {
    let mut diagnosis = found();
    diagnosis.advice = None;
    diagnosis.regions[0].causes[0].whole_frame = Some(FrameEffect { before: 105, after: 1900 });
    let harness = opened(|inspector| give_diagnosis(inspector, diagnosis));
    harness.get_by_role_and_label(Role::Button, "Apply the fix all the same: use z-fail");
    harness.get_by_label("× Worse elsewhere: whole frame: 105 wrong pixels without it, 1\u{a0}900 with it");
    assert!(harness.query_by_role_and_label(Role::Button, "Apply the fix: use z-fail").is_none());
}

#[test]
fn one_fix_has_one_button_and_the_cause_that_asks_for_it_says_what_it_does() {
    let harness = with_regions();
    let buttons = harness.query_all_by_role(Role::Button).filter_map(|node| node.accesskit_node().label());
    let of_fix: Vec<String> = buttons.filter(|label| label.ends_with(": use z-fail")).collect();
    assert_eq!(of_fix, ["Apply the fix: use z-fail"]);
    // The remedy is named once, with what it does.
    harness.get_by_label("Its fix is offered above.");
    harness.get_by_label("Whole frame: 105 wrong pixels without it, 0 with it");
    assert_eq!(harness.query_all_by_label_contains("use z-fail").count(), 1);
}

/// What was found stays true when another technique is chosen since, and its remedies are for what was diagnosed.
#[test]
fn a_technique_that_was_chosen_since_is_neither_before_nor_after() {
    let mut diagnosis = found();
    diagnosis.regions[0].causes[1].proof = Proof::Part;
    let mut harness = opened(|inspector| give_diagnosis(inspector, diagnosis));
    click_button(&mut harness, "Apply the fix: use z-fail");
    click_button(&mut harness, "shadow-map");
    harness.get_by_label("shown: shadow-map, chosen since");
    harness.get_by_label("Whole frame: 105 wrong pixels without it, 0 with it");
    for words in ["Show before", "Show after"] {
        harness.get_by_role_and_label(Role::Button, words);
    }
    harness.get_by_role_and_label(Role::Button, "Apply the fix: set casters = all").click_accesskit();
    harness.run_steps(2);
    let request = last_run(&harness);
    assert_eq!((request.choice.technique(), request.choice.settings()["casters"].as_str()), (Technique::ZPass, "all"));
}

#[test]
fn a_remedy_that_leaves_more_than_there_were_says_so() {
    let mut diagnosis = found();
    diagnosis.regions[0].causes[1].pixels_left = Some(144);
    let harness = opened(|inspector| give_diagnosis(inspector, diagnosis));
    harness.get_by_label("144 pixels are wrong here with it, 70 without");
}

#[test]
fn another_diagnosis_is_read_from_its_beginning() {
    let many = |pixels: u64| {
        let mut diagnosis = found();
        let region = diagnosis.regions[1].clone();
        diagnosis.regions = (0..30).map(|at| RegionFound { pixels: pixels - at, ..region.clone() }).collect();
        diagnosis
    };
    let mut harness = opened(|inspector| give_diagnosis(inspector, many(500)));
    let first = |harness: &Harness<Seen>| {
        let rows = harness.query_all_by_role(Role::Row);
        rows.filter(|row| row.accesskit_node().label().is_some_and(|label| label.starts_with("1 · ")))
            .map(|row| row.rect())
            .next()
            .expect("the first region")
    };
    let at_top = first(&harness);
    harness.hover_at(at_top.center());
    wheel(&mut harness, -400.0);
    harness.run_steps(20);
    assert!(first(&harness).top() < at_top.top() - 100.0, "it is scrolled");
    change(&mut harness, |inspector| give_diagnosis(inspector, many(700)));
    assert_eq!(first(&harness).top(), at_top.top());
}

/// After a diagnosis the Pixel panel asks for the truth, and says it with the cause.
#[test]
fn a_pixel_of_a_frame_that_was_diagnosed_says_the_truth_and_why_it_is_wrong() {
    let mut diagnosis = found();
    diagnosis.technique = Technique::ZFail;
    diagnosis.settings = Choice::new(Technique::ZFail).settings().clone();
    diagnosis.regions[1].bounds = [18, 0, 19, 19];
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.selection.pick = Some([18, 4]);
    let mut harness = harness_of(inspector);
    assert!(asks::<TruthOf>(&harness).is_empty());
    change(&mut harness, |inspector| give_diagnosis(inspector, diagnosis));
    assert_eq!(asks::<TruthOf>(&harness).len(), 1);
    change(&mut harness, |inspector| {
        inspector.model.update_capture(Arc::new(by_hand::with_truth(z_fail(SIZE))));
    });
    harness.get_by_label("× Wrong: by ray tracing it is lit.");
    harness.get_by_label("Why: split-vertices (part).");
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([3, 4]));
    harness.get_by_label("Right: ray tracing says the same.");
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([18, 4]));
    click(&mut harness, "Open the diagnosis");
    harness.get_by_role_and_label(Role::Button, "Diagnose again");
}

#[test]
fn a_long_title_goes_on_in_a_second_line() {
    let mut diagnosis = found();
    diagnosis.regions[1].casters = vec!["the orange torus at the back of the room".to_owned()];
    diagnosis.regions[1].receivers = vec!["the red torus by the window".to_owned()];
    let harness = opened(|inspector| give_diagnosis(inspector, diagnosis));
    let short = harness.get_by_role_and_label(Role::Row, FIRST).rect().height();
    let long = harness.query_all_by_role(Role::Row).map(|row| row.rect().height()).fold(0.0, f32::max);
    assert!(long > short + 8.0, "{long} over {short}");
}

/// What a fix has changed is seen beside what was before, without a search for it.
#[test]
fn after_a_fix_the_frame_is_compared_with_the_one_before_it() {
    let mut harness = with_regions();
    click_button(&mut harness, "Apply the fix: use z-fail");
    show_capture(&mut harness, z_fail(SIZE));
    click_button(&mut harness, "Compare");
    let asked = asks::<stencilscope::ask::CaptureOf>(&harness).pop().expect("it is asked for");
    assert_eq!(asked.request.choice.technique(), Technique::ZPass);
    assert!(says(&harness, "before the fix"));
    // Another technique that is chosen since has its own default.
    click_button(&mut harness, "Compare");
    click_button(&mut harness, "shadow-map");
    show_capture(&mut harness, z_fail(SIZE));
    click_button(&mut harness, "Compare");
    assert!(!says(&harness, "Capturing before the fix"));
}

/// In a narrow panel causes stand below their region, and nothing is cut.
#[test]
fn in_a_narrow_panel_causes_stand_below_their_region() {
    let mut harness = harness_in(Inspector::new(Vec::new()), [960.0, 900.0]);
    change(&mut harness, |inspector| {
        inspector.set_scene(&scene(), run_request(Technique::ZPass));
        inspector.set_capture(Arc::new(z_fail(SIZE)));
        give_diagnosis(inspector, found());
    });
    show_tab(&mut harness, "Diagnosis");
    harness.run_steps(2);
    let panel = harness.get_by_role_and_label(Role::TabPanel, "Diagnosis").rect();
    let row = harness.get_by_role_and_label(Role::Row, FIRST).rect();
    assert!(row.width() > 0.9 * panel.width(), "{row} of {panel}");
    let fix = harness.get_by_role_and_label(Role::Button, "Apply the fix: use z-fail").rect();
    assert!(fix.bottom() < row.top() && fix.left() < panel.center().x, "the advice: {fix}, {row}");
    let second = harness.get_by_role_and_label(Role::Row, SECOND).rect();
    assert!(second.top() > row.bottom() + 40.0, "its causes are between: {row}, {second}");
}
