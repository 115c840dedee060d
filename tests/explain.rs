//! What Explain says of a step, compared with plan, labels and counts of the frame.

use crate::common::{opened, request, request_with, session};
use std::sync::Arc;
use stencilscope::capture::{Capture, Snapshot, Step};
use stencilscope::plan::CountOf;
use stencilscope::reading::explain_facts::{ExplainContext, ExplainFact, facts};
use stencilscope::reading::map_decision::MapDecision;
use stencilscope::scene::Scene;
use stencilscope::scene::builtin;
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [160, 120];

fn of_step(scene: &Scene, capture: &Capture, step: usize, pick: Option<[u32; 2]>) -> Vec<ExplainFact> {
    facts(&ExplainContext { capture, step, lights: &scene.lights, pick, history: None, map: None })
}

fn named(capture: &Capture, name: &str) -> usize {
    capture.steps.iter().position(|step| step.name == name).expect("a step of the name")
}

/// The light pass says of a pixel that light is added exactly where the technique's own label says lit.
#[test]
fn what_the_light_pass_says_of_a_pixel_is_what_its_label_says() {
    let mut session = session();
    let (mut lit, mut dark) = (0, 0);
    for technique in Technique::ALL {
        for builtin in builtin::ALL {
            if ["tiger-cage", "teapot-like"].contains(&builtin.name) {
                continue;
            }
            let scene = builtin.scene().expect("a scene");
            let capture = session.capture(&scene, &request(technique, SIZE)).expect("a capture");
            let is_light = |step: &Step| step.name == "light" && matches!(step.snapshot, Snapshot::Frame(_));
            for (index, step) in capture.steps.iter().enumerate().filter(|(_, step)| is_light(step)) {
                let labels = capture.lights[step.light.expect("a light")].shadow.as_ref().expect("labels");
                for at in (0..SIZE[1]).step_by(7).flat_map(|y| (0..SIZE[0]).step_by(9).map(move |x| [x, y])) {
                    let lines = of_step(&scene, &capture, index, Some(at)).into_iter().flat_map(|fact| fact.here);
                    let lines =
                        lines.filter(|line| line.starts_with(&format!("pixel {}, {}: its stencil", at[0], at[1])));
                    for line in lines {
                        let is_lit = line.ends_with("so light is added");
                        // Of what faces away or is background the stencil does not decide.
                        match labels.byte_at(at) {
                            Some(0) => assert!(is_lit, "{technique:?}, {}: {line}", scene.name),
                            Some(1) => assert!(!is_lit, "{technique:?}, {}: {line}", scene.name),
                            _ => {}
                        }
                        *if is_lit { &mut lit } else { &mut dark } += 1;
                    }
                }
            }
        }
    }
    assert!(lit > 1000 && dark > 1000, "{lit} lit, {dark} dark");
}

/// Shadows that are blended over the picture come after the light, which asks nothing, whatever an earlier light marked.
#[test]
fn light_that_asks_no_stencil_is_not_said_to() {
    let mut session = session();
    let scene = opened("two-lights");
    let request = request_with(Technique::Planar, &[("blend", "twice")], SIZE);
    let capture = session.capture(&scene, &request).expect("a capture");
    for (index, _) in capture.steps.iter().enumerate().filter(|(_, step)| step.name == "light") {
        let fact = of_step(&scene, &capture, index, Some([80, 60])).remove(0);
        assert_eq!(fact.formula, "light is added where the technique lets it through");
    }
}

/// A box under a point light: one cap of the faces that the light sees, sides along its outline, a fan at infinity.
#[test]
fn a_box_has_the_parts_of_the_textbooks_volume() {
    let mut scene = crate::common::from_above(vec![crate::common::cuboid("box", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0])]);
    scene.objects[0].casts = false;
    let mut session = session();
    let mut card_lines = |scene: &Scene, settings: &[(&str, &str)]| {
        let request = request_with(Technique::ZFail, settings, SIZE);
        let capture = session.capture(scene, &request).expect("a capture");
        let lines: Vec<String> =
            of_step(scene, &capture, named(&capture, "volumes"), None).into_iter().flat_map(|fact| fact.here).collect();
        lines.join("\n")
    };
    let point = card_lines(&scene, &[]);
    // The top's two triangles face the light; four edges of two triangles each.
    for line in [
        "the same edge at the far end: 8",
        "light caps, the casting triangles themselves: 2",
        "fans over the silhouettes at infinity: 4",
        "the highest count is 1",
        CountOf::Bodies.meaning(),
    ] {
        assert!(point.contains(line), "{line}: {point}");
    }
    let all = card_lines(&scene, &[("casters", "all")]);
    for line in ["the casting triangles themselves: 12", "the highest count is 2", CountOf::Surfaces.meaning()] {
        assert!(all.contains(line), "{line}: {all}");
    }
    let finite = card_lines(&scene, &[("extrusion", "finite:100")]);
    assert!(finite.contains("dark caps, the casting triangles carried to the far end: 2"), "{finite}");
    scene.lights = vec![stencilscope::scene::Light::directional([0.1, 1.0, 0.2])];
    let sun = card_lines(&scene, &[]);
    assert!(sun.contains("meet in one point at infinity, so it needs none: 0"), "{sun}");
}

#[test]
fn the_lights_formula_is_the_one_in_use() {
    let mut session = session();
    let mut scene = opened("rings");
    let mut formula_line = |scene: &Scene, settings: &[(&str, &str)]| {
        let request = request_with(Technique::ZFail, settings, SIZE);
        let capture = session.capture(scene, &request).expect("a capture");
        of_step(scene, &capture, named(&capture, "light"), None).remove(0).here.remove(0)
    };
    assert!(formula_line(&scene, &[]).ends_with("× (material × cosine of its angle + highlight)"));
    let wrapped = formula_line(&scene, &[("diffuse", "wrapped")]);
    assert!(wrapped.contains("material × (1 + cosine of its angle) / 2 + highlight"), "{wrapped}");
    scene.lights[0].range = Some(30.0);
    assert!(formula_line(&scene, &[]).ends_with("× what is left at its distance"));
}

/// The Shadow map tab may show one light while the pixel is explained under another: its texel is no reason there.
#[test]
fn what_one_lights_map_stores_is_no_reason_under_another() {
    use stencilscope::history::Verdict;
    use stencilscope::reading::map_readers::MapReaders;
    let mut session = session();
    let scene = opened("two-lights");
    let (capture, plan) = session.capture_with_plan(&scene, &request(Technique::ShadowMap, SIZE)).expect("a capture");
    let readers = MapReaders::new(&capture, Some(&Arc::new(plan)), 0).expect("readers");
    let mut agreeing = 0;
    for at in (0..SIZE[1]).step_by(11).flat_map(|y| (0..SIZE[0]).step_by(13).map(move |x| [x, y])) {
        let Some(decision) = MapDecision::of(&capture, &readers, 0, at) else { continue };
        let by_map = |light| Verdict::of(&capture, light, at).with_texels(decision.light, || decision.sentence());
        assert_eq!(by_map(1), Verdict::of(&capture, 1, at));
        agreeing += usize::from(by_map(0).reason() == decision.sentence());
    }
    assert!(agreeing > 20, "{agreeing}");
}
