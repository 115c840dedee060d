//! Recorded frames as plans and captures, from recordings in the repository: no RenderDoc is needed.

use super::recording;
use crate::common::random::Random;
use crate::common::session;
use stencilscope::capture::disk::{Contents, read_whole, write};
use stencilscope::capture::{Capture, Differs};
use stencilscope::import::{convert, read};
use stencilscope::plan::{DecidedBy, FramePlan, Side, lint};
use stencilscope::progress::Progress;
use stencilscope::session::{RunFrame, Session};

/// As a draw's depth and stencil may differ on another rasterizer: pixels on edges and at depths that are equal.
const MOST_DIFFERING: u64 = 16;

fn converted(session: &mut Session, name: &str) -> (FramePlan, Capture) {
    let frame = read(&recording(name)).expect("a recording");
    let (plan, capture) = convert(&frame, name).expect("a frame");
    assert_eq!(lint::check(&plan), []);
    let capture = session.held_against_itself(&plan, &capture, &Progress::default()).expect("checked");
    (plan, capture)
}

fn roles(plan: &FramePlan) -> Vec<(&str, Option<usize>)> {
    plan.passes.iter().map(|pass| (pass.name.as_str(), pass.light.map(|light| light.0))).collect()
}

fn differing(capture: &Capture) -> Vec<Differs> {
    capture.steps.iter().flat_map(|step| &step.draws).map(|draw| draw.differs.expect("checked")).collect()
}

#[test]
fn roles_and_the_counted_side_are_told_by_the_states() {
    let mut session = session();
    for (name, side) in [("ogre", Side::InFront), ("ogre-inside", Side::AsNeeded)] {
        let (plan, capture) = converted(&mut session, name);
        assert_eq!(roles(&plan), [("surfaces", None), ("volumes", Some(0)), ("light", Some(0))], "{name}");
        assert_eq!(capture.decided_by(0), DecidedBy::StencilCount { side }, "{name}");
        assert_eq!(plan.attachments[0].format, wgpu::TextureFormat::Depth24PlusStencil8);
    }
}

#[test]
fn every_draw_makes_what_was_stored_but_at_a_few_pixels() {
    let mut session = session();
    for name in ["ogre", "ogre-inside"] {
        let (_, capture) = converted(&mut session, name);
        let differing = differing(&capture);
        assert!(differing.len() >= 9, "{name}");
        for differs in differing {
            assert!(differs.stencil <= MOST_DIFFERING && differs.depth <= MOST_DIFFERING, "{name}: {differs:?}");
        }
    }
}

#[test]
fn a_draw_that_was_stored_wrong_is_marked_with_its_count() {
    let mut session = session();
    let frame = read(&recording("ogre")).expect("a recording");
    let (mut plan, capture) = convert(&frame, "ogre").expect("a frame");
    // Its faces count the other way round: what was stored is something else.
    let volumes = plan.passes.iter_mut().find(|pass| pass.name == "volumes").expect("volumes");
    let stencil = &mut volumes.draws[0].raster.stencil;
    std::mem::swap(&mut stencil.front, &mut stencil.back);
    let capture = session.held_against_itself(&plan, &capture, &Progress::default()).expect("checked");
    let differs: Vec<u64> = differing(&capture).iter().map(|differs| differs.stencil).collect();
    let most = differs.iter().max().expect("draws");
    assert!(*most > 1000, "{differs:?}");
    assert_eq!(differs.iter().filter(|count| **count > MOST_DIFFERING).count(), 1, "{differs:?}");
}

#[test]
fn histories_agree_with_the_stored_bytes_and_have_ladders() {
    let (mut session, mut random) = (session(), Random::new(2));
    let parent = tempfile::tempdir().expect("a folder");
    for name in ["ogre", "ogre-inside"] {
        let (plan, capture) = converted(&mut session, name);
        let folder = parent.path().join(name);
        write(Contents { capture: &capture, plan: Some(&plan), scene: None }, &folder, false).expect("written");
        let RunFrame { capture, plan, source } =
            RunFrame::from_folder(read_whole(&folder).expect("read")).expect("a whole frame");
        assert!(source.is_none());
        let (mut disagreeing, mut ladders) = (Vec::new(), 0);
        for _ in 0..200 {
            let pixel = plan.size.map(|side| random.below(side));
            let history = session.history(&plan, &capture, pixel).expect("a history");
            disagreeing.extend((!history.agrees()).then(|| (pixel, history.disagreements())));
            ladders += usize::from(history.ladder(0, &capture.depth).is_some());
        }
        // A pixel on an edge may be one of those that its draw is marked for.
        assert!(disagreeing.len() <= 1, "{name}: {disagreeing:?}");
        assert!(ladders > 20, "{name}: {ladders}");
    }
}

#[test]
fn how_the_eye_sees_is_found_from_the_vertices() {
    let mut session = session();
    let (_, capture) = converted(&mut session, "ogre");
    // The script's camera: near plane at 1, no far plane that OGRE's shadows would be cut at.
    let near = capture.depth.scale / (0.0 - capture.depth.offset);
    assert!((near - 1.0).abs() < 1e-3, "{:?}", capture.depth);
}
