//! Counts of fragments by their outcome, compared with the history of single pixels.

use crate::common;
use stencilscope::capture::StepTests;
use stencilscope::history::{FragmentOutcome, PixelHistory};
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [160, 90];

/// Fragments of a step, or of one of its draws, that a history knows: all, those that failed the stencil
/// test, those that failed the depth test, those that passed both.
fn counted(history: &PixelHistory, step: usize, draw: Option<usize>) -> [u8; 4] {
    let mut counts = [0; 4];
    for (event, triangle) in history.triangles() {
        let FragmentOutcome::Tested { stencil, depth, .. } = triangle.outcome else { continue };
        if event.pass != step || draw.is_some_and(|draw| draw != triangle.draw) {
            continue;
        }
        counts[0] += 1;
        let sort = match (stencil.passed(), depth.passed()) {
            (Some(false), _) => 1,
            (_, Some(false)) => 2,
            _ => 3,
        };
        counts[sort] += 1;
    }
    counts
}

/// Every third pixel each way, each step that draws into the picture, and each of its draws: all that is
/// known agrees exactly. Returns how many fragments failed the depth test, the stencil test, how many
/// verdicts were unknown.
fn agrees(scene: &str, technique: Technique) -> [u64; 3] {
    let mut session = common::session();
    let scene = common::opened(scene);
    let request = common::request(technique, SIZE);
    let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
    let mut asked: Vec<StepTests> = Vec::new();
    for (step, pass) in plan.passes.iter().enumerate() {
        for draw in std::iter::once(None).chain((0..pass.draws.len()).map(Some)) {
            asked.extend(session.step_tests(&plan, step, draw).ok());
        }
    }
    assert!(!asked.is_empty());
    let mut seen = [0; 3];
    for y in (0..SIZE[1]).step_by(9) {
        for x in (0..SIZE[0]).step_by(11) {
            let history = session.history(&plan, &capture, [x, y]).expect("a history");
            assert!(history.agrees(), "{x}, {y}");
            for tests in &asked {
                let found = tests.at([x, y]).expect("a pixel");
                let expected = counted(&history, tests.step, tests.draw);
                let place = format!("{x}, {y}: step {} draw {:?}", tests.step, tests.draw);
                assert_eq!(found.fragments, expected[0], "{place}");
                let known = [found.stencil_failed, found.depth_failed, found.passed];
                for (found, expected) in known.into_iter().zip(&expected[1..]) {
                    assert!(found.is_none_or(|found| found == *expected), "{place}: {found:?} is not {expected}");
                }
                seen[0] += u64::from(found.depth_failed.unwrap_or(0));
                seen[1] += u64::from(found.stencil_failed.unwrap_or(0));
                seen[2] += u64::from(found.passed.is_none());
            }
        }
    }
    seen
}

#[test]
fn counts_of_z_fail_on_tori_are_those_of_histories() {
    let [depth_failed, stencil_failed, unknown] = agrees("tori", Technique::ZFail);
    assert!(depth_failed > 100 && stencil_failed > 20, "{depth_failed} {stencil_failed} {unknown}");
}

#[test]
fn counts_of_z_pass_and_shadow_maps_are_those_of_histories() {
    for technique in [Technique::ZPass, Technique::ShadowMap] {
        let [depth_failed, stencil_failed, unknown] = agrees("tori", technique);
        assert!(depth_failed > 50, "{technique:?}: {depth_failed} {stencil_failed} {unknown}");
        // A shadow map asks no stencil; z-pass stops the light where its count is not 0.
        assert_eq!(stencil_failed > 20, technique == Technique::ZPass, "{stencil_failed}");
    }
}

#[test]
fn a_step_that_draws_nothing_into_the_picture_says_so() {
    let mut session = common::session();
    let scene = common::opened("tori");
    let plan = session.plan(&scene, &common::request(Technique::ShadowMap, SIZE)).expect("a plan");
    let map = plan.passes.iter().position(|pass| pass.view.0 != 0).expect("a map pass");
    let error = session.step_tests(&plan, map, None).expect_err("no pixels of the picture");
    assert!(error.to_string().contains("select one that does"), "{error}");
}
