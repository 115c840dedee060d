//! What decides a light's shadow, in the panels: where volumes are counted there are a ladder, a sum and a legend of
//! counts, whatever the technique is called; elsewhere the sentence says what decided instead.

use super::*;
use stencilscope::ask::RaysOf;
use stencilscope::plan::{CountOf, CountedSide, DecidedBy};
use stencilscope::reading::format;
use stencilscope::truth::SHADOW;

const SIZE: [u32; 2] = [64, 36];

/// The panels over a frame, with the history of a pixel that is in shadow, if there is one: in as many volumes as any.
fn panels(session: &mut Session, scene: &Scene, request: &CaptureRequest) -> (Harness<'static, Seen>, Capture) {
    let (capture, plan) = session.capture_with_plan(scene, request).expect("a frame");
    let labels = capture.lights[0].shadow.clone().expect("labels");
    let counted = capture.steps.iter().position(|step| step.name == "volumes").and_then(|step| capture.frame_at(step));
    let counts = counted.and_then(|frame| frame.stencil.as_ref());
    let depth = |at: &[u32; 2]| counts.and_then(|counts| counts.image.byte_at(*at));
    let in_shadow = common::pixels(SIZE).filter(|at| labels.byte_at(*at) == Some(SHADOW));
    let dark = in_shadow.max_by_key(depth).unwrap_or([32, 30]);
    let history = session.history(&plan, &capture, dark).expect("a history");
    let mut inspector = Inspector::new(Vec::new());
    inspector.set_scene(scene, RunRequest::of(scene, request.choice.clone(), SIZE));
    inspector.set_capture(Arc::new(capture.clone()));
    inspector.model.selection.pick = Some(dark);
    let mut harness = harness_in(inspector, TALL);
    change(&mut harness, |inspector| inspector.take_in(HistoryOf { at: dark }, Ok(Arc::new(history))));
    (harness, capture)
}

/// The legend of the stencil picture, if there is one.
fn stencil_legend(harness: &mut Harness<Seen>, capture: &Capture) -> Option<&'static str> {
    capture.frame_at(capture.steps.len() - 1)?.stencil.as_ref()?;
    click_button(harness, "Stencil");
    ["Stencil count", "Stencil value"].into_iter().find(|title| says(harness, title))
}

#[test]
fn every_technique_has_ladder_sum_and_legend_or_says_what_decided() {
    let mut session = common::session();
    let scene = common::opened("tori");
    for technique in Technique::ALL {
        let request = common::request(technique, SIZE);
        let (mut harness, capture) = panels(&mut session, &scene, &request);
        let side = capture.lights[0].decided_by.counted_side();
        let name = technique.name();
        assert_eq!(says(&harness, "Ladder"), side.is_some(), "{name}: a ladder");
        assert_eq!(says(&harness, "its stencil count is "), side.is_some(), "{name}: a sum");
        let legend = stencil_legend(&mut harness, &capture);
        let (expected_side, expected_legend, reason) = match technique {
            Technique::ZPass | Technique::ZPassPlus => {
                (Some(CountedSide::InFront), Some("Stencil count"), "volume face")
            }
            Technique::ZFail => (Some(CountedSide::Behind), Some("Stencil count"), "volume face"),
            // The eye is in the shadow of no caster of this scene.
            Technique::Auto => (Some(CountedSide::InFront), Some("Stencil count"), "volume face"),
            Technique::Planar => (None, Some("Stencil value"), "flattened"),
            Technique::PlanarTexture => (None, None, "The texture of this flat receiver"),
            Technique::ShadowMap => (None, None, "the caster is nearer, so the light pass adds nothing"),
            Technique::Projective => (None, None, "The silhouette of another object falls here"),
            // Where it has lit, so that it lights nothing twice.
            Technique::RayTraced => {
                (None, Some("Stencil value"), "The technique's mask says that something lies between")
            }
            Technique::None => (None, None, "No shadow of this light is made in this frame"),
        };
        assert_eq!((side, legend), (expected_side, expected_legend), "{name}");
        assert!(says(&harness, reason), "{name}: {reason}");
        // Two tori, proven closed, over a floor that is not: the label says which kinds of casters count.
        let counting = capture.lights[0].count_of.map(CountOf::what);
        assert_eq!(counting.is_some(), side.is_some(), "{name}");
        if let Some(counting) = counting {
            assert!(says(&harness, &format!("of light 1, counting {counting}")), "{name}: the ladder");
            assert!(harness.query_by_label(&format!("of {counting}")).is_some(), "{name}: the legend");
        }
    }
}

/// Who stands between is said first where no volume is counted too, and is right: without them the pixel is lit.
#[test]
fn maps_and_rays_name_whose_shadow_it_is() {
    let mut session = common::session();
    let scene = common::opened("tori");
    for technique in [Technique::ShadowMap, Technique::RayTraced, Technique::PlanarTexture, Technique::Projective] {
        let frame = session.render(scene.clone(), common::request(technique, SIZE)).expect("a frame");
        let (mut harness, capture) = panels(&mut session, &scene, &common::request(technique, SIZE));
        let name = technique.name();
        assert!(!says(&harness, "In the shadow of "), "{name}: nothing is said before it is known");
        let RaysOf { at } = asks::<RaysOf>(&harness)[0];
        let rays = session.light_rays(&frame, at).expect("rays");
        reply::<RaysOf>(&mut harness, Ok(rays.clone()));
        let said: Vec<String> = (harness.query_all_by_label_contains("In the shadow of "))
            .filter_map(|node| node.accesskit_node().label().or(node.accesskit_node().value()))
            .collect();
        let said = said.first().unwrap_or_else(|| panic!("{name}: whose shadow it is"));
        let mut without = scene.clone();
        let named = without.objects.iter_mut().filter(|object| said.contains(&object.name));
        assert!(named.map(|object| object.casts = false).count() > 0, "{name}: {said}");
        let at = harness.state().inspector.model.selection.pick.expect("a pixel");
        let truth = |session: &mut Session, scene: &Scene| {
            let truth = session.truth(scene, &capture, &Progress::default()).expect("a truth");
            truth.lights[0].as_ref().expect("a light").labels.byte_at(at)
        };
        assert_eq!(truth(&mut session, &scene), Some(SHADOW), "{name}: {at:?}");
        assert_eq!(truth(&mut session, &without), Some(0), "{name}: {said}, and nobody else");
        // The answer names the triangle, before anything is unfolded.
        harness.get_by_label(&format!("By its ray: {}.", rays[0].words()));
        // The section lists every triangle, with its distances.
        click(&mut harness, "Rays");
        harness.run_steps(8);
        for occluder in &rays[0].occluders {
            for words in [format::count(occluder.triangle as u64 + 1), format::metres(occluder.from_surface)] {
                assert!(harness.query_all_by_label(&words).count() > 0, "{name}: {words} of {occluder:?}");
            }
        }
        assert!(says(&harness, &rays[0].words()), "{name}");
    }
}

#[test]
fn a_pixel_whose_volumes_count_on_both_sides_has_one_ladder_of_them_all() {
    let mut session = common::session();
    // The eye is in the shadow of the roof, and a part of the slab is too.
    let slab = common::cuboid("slab", [0.5, 3.0, -0.5], [2.0, 3.1, 0.5]);
    let roof = common::cuboid("roof", [-6.0, 12.0, -1.0], [-2.0, 12.5, 1.0]);
    let mut scene = common::from_above(vec![slab, roof]);
    scene.lights[0].position = glam::DVec4::new(-12.0, 20.0, 0.2, 1.0);
    let request = common::request(Technique::Auto, SIZE);
    let (harness, capture) = panels(&mut session, &scene, &request);
    assert_eq!(capture.lights[0].decided_by, DecidedBy::StencilCount { side: CountedSide::AsNeeded });
    for text in ["on either side of the surface", "Counted along the whole ray", "its stencil count is 2."] {
        assert!(says(&harness, text), "{text}");
    }
}

#[test]
fn a_light_that_nothing_is_drawn_for_is_decided_by_nothing() {
    let mut session = common::session();
    let mut scene = common::from_above(Vec::new());
    scene.lights[0].position.y = -4.0;
    let request = common::request(Technique::Auto, SIZE);
    let (harness, capture) = panels(&mut session, &scene, &request);
    assert_eq!(capture.lights[0].decided_by, DecidedBy::Nothing);
    assert!(!says(&harness, "Ladder"));
}
