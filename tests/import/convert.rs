//! Recorded frames as plans and captures, from recordings in the repository: no RenderDoc is needed.

use super::recording;
use crate::common::random::Random;
use crate::common::{adapter, session};
use glam::{DQuat, DVec3, DVec4};
use std::sync::Arc;
use stencilscope::capture::disk::{FolderContents, read_whole, write};
use stencilscope::capture::{Capture, RecomputeDifference};
use stencilscope::diagnosis::frame_causes::FrameDiagnosis;
use stencilscope::diagnosis::{Cause, NotCompared, Proof};
use stencilscope::history::Disagreement;
use stencilscope::import::{ConvertedFrame, RawFrame, RawKind, convert, read};
use stencilscope::plan::{Blob, CountedSide, DecidedBy, FramePlan, LightId, RasterState, StartContent, lint};
use stencilscope::progress::Progress;
use stencilscope::recorded::SeenSurfaces;
use stencilscope::session::{FrameSource, RunFrame, Session};
use stencilscope::truth::{LIT, SHADOW};

/// How many pixels of a draw may differ in depth or stencil on another rasterizer: on edges, and at equal depths.
const MOST_DIFFERING: u64 = 16;

fn converted(session: &mut Session, name: &str) -> (FramePlan, Capture) {
    let frame = read(&recording(name)).expect("a recording");
    let ConvertedFrame { plan, capture, .. } = convert(&frame, name).expect("a frame");
    assert_eq!(lint::check(&plan), []);
    let capture = session.compared_with_rerun(&plan, &capture, &Progress::default()).expect("checked");
    (plan, capture)
}

fn roles(plan: &FramePlan) -> Vec<(&str, Option<usize>)> {
    plan.passes.iter().map(|pass| (pass.name.as_str(), pass.light.map(|light| light.0))).collect()
}

fn differing(capture: &Capture) -> Vec<RecomputeDifference> {
    capture.steps.iter().flat_map(|step| &step.draws).map(|draw| draw.differs.expect("checked")).collect()
}

#[test]
fn roles_and_the_counted_side_are_reported_by_the_states() {
    let mut session = session();
    for (name, side) in [("ogre", CountedSide::InFront), ("ogre-inside", CountedSide::AsNeeded)] {
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
            let is_few = differs.stencil <= MOST_DIFFERING && differs.depth <= MOST_DIFFERING;
            // The recordings are lavapipe's: another rasteriser may have other depths where corners are behind the eye.
            assert!(is_few || !adapter::draws_as_given(), "{name}: {differs:?}");
        }
    }
}

#[test]
fn a_draw_that_was_stored_wrong_is_marked_with_its_count() {
    let mut session = session();
    let frame = read(&recording("ogre")).expect("a recording");
    let ConvertedFrame { mut plan, capture, .. } = convert(&frame, "ogre").expect("a frame");
    // Its faces count the other way round: what was stored is something else.
    let volumes = plan.passes.iter_mut().find(|pass| pass.name == "volumes").expect("volumes");
    let stencil = &mut volumes.draws[0].raster.stencil;
    std::mem::swap(&mut stencil.front, &mut stencil.back);
    let capture = session.compared_with_rerun(&plan, &capture, &Progress::default()).expect("checked");
    let differs: Vec<u64> = differing(&capture).iter().map(|differs| differs.stencil).collect();
    let most = differs.iter().max().expect("draws");
    assert!(*most > 1000, "{differs:?}");
    assert_eq!(differs.iter().filter(|count| **count > MOST_DIFFERING).count(), 1, "{differs:?}");
}

#[test]
fn a_pass_changed_what_any_of_its_draws_changed() {
    let mut session = session();
    for name in ["ogre", "ogre-inside", "ogre-short"] {
        let (_, capture) = converted(&mut session, name);
        for step in &capture.steps {
            let draws = || step.draws.iter().filter_map(|draw| draw.after.as_ref());
            let is_changed = draws().any(|state| !state.changes_nothing());
            assert_eq!(step.snapshot.aspects().any(|aspect| !aspect.unchanged), is_changed, "{name}: {}", step.name);
        }
    }
}

#[test]
fn histories_agree_with_the_stored_bytes_and_have_ladders() {
    let (mut session, mut random) = (session(), Random::new(2));
    let parent = tempfile::tempdir().expect("a folder");
    for name in ["ogre", "ogre-inside"] {
        let (plan, capture) = converted(&mut session, name);
        let folder = parent.path().join(name);
        write(FolderContents { capture: &capture, plan: Some(&plan), scene: None }, &folder, false).expect("written");
        let RunFrame { capture, plan, source } =
            RunFrame::from_folder(read_whole(&folder).expect("read")).expect("a whole frame");
        assert!(source.is_none());
        let (mut disagreeing, mut ladders) = (Vec::new(), 0);
        for _ in 0..200 {
            let pixel = plan.size.map(|side| random.below(side));
            let history = session.history(&plan, &capture, pixel).expect("a history");
            // What is stored is lavapipe's here, too.
            let is_other =
                |one: &Disagreement| adapter::draws_as_given() || !matches!(one, Disagreement::Stored { .. });
            let found = history.disagreements();
            disagreeing.extend(found.iter().any(is_other).then_some((pixel, found)));
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

/// The script's view of a place: a camera at `eye` that looks at `target`, whose x and y are stretched as an eye of 90
/// degrees sees them.
fn seen(eye: DVec3, target: DVec3, place: DVec3) -> DVec3 {
    // OGRE turns a camera by the shortest arc from −z, and sees 45 degrees.
    let ahead = (target - eye).normalize();
    let rotation = DQuat::from_rotation_arc(DVec3::NEG_Z, ahead);
    let [right, above] = [rotation * DVec3::X, rotation * DVec3::Y];
    let stretch = 1.0 / (45.0_f64.to_radians() / 2.0).tan();
    let from = place - eye;
    DVec3::new(from.dot(right) * stretch, from.dot(above) * stretch, -from.dot(ahead))
}

#[test]
fn the_light_is_found_where_the_script_placed_it() {
    let frames = [
        ("ogre", DVec3::new(0.0, 150.0, 400.0), DVec3::new(0.0, 30.0, 0.0)),
        ("ogre-inside", DVec3::new(38.0, 14.0, 6.0), DVec3::new(-80.0, 20.0, 10.0)),
    ];
    for (name, eye, target) in frames {
        let frame = read(&recording(name)).expect("a recording");
        let ConvertedFrame { lights, capture, .. } = convert(&frame, name).expect("a frame");
        let [Some(found)] = lights[..] else { panic!("{name}: {lights:?}") };
        let expected = seen(eye, target, DVec3::new(120.0, 260.0, 90.0));
        let position = found.position.truncate();
        let angle = position.angle_between(expected).to_degrees();
        let off = (position - expected).length() / expected.length();
        println!("{name}: {:?}, {angle} degrees, {off} off", found.evidence);
        assert!(found.position.w == 1.0 && angle < 0.1 && off < 2e-3, "{name}: {position} {expected}");
        assert_eq!(capture.lights[0].position, found.position);
    }
}

#[test]
fn no_pixel_of_right_frames_is_wrong_against_rays_through_their_own_triangles() {
    let mut session = session();
    for name in ["ogre", "ogre-inside", "blender"] {
        let frame = read(&recording(name)).expect("a recording");
        let ConvertedFrame { capture, scene, .. } = convert(&frame, name).expect("a frame");
        let judged = session.judged(&scene.expect("a scene"), &capture, &Progress::default()).expect("a truth");
        let error = judged.error().expect("an error");
        println!("{name}: {error:?}");
        assert!(error.compared > 20_000, "{name}: {error:?}");
        assert_eq!(error.wrong(), 0, "{name}: {error:?}");
    }
}

pub fn frame_of(name: &str) -> RunFrame {
    let frame = read(&recording(name)).expect("a recording");
    let ConvertedFrame { plan, capture, scene, .. } = convert(&frame, name).expect("a frame");
    let source = scene.map(|scene| Arc::new(FrameSource { scene, request: None }));
    RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source }
}

/// What all draws of a pass but the last left is forgotten: they are computed anew together.
#[test]
fn draws_of_which_only_the_last_s_result_is_known_are_held_against_it_together() {
    let mut session = session();
    let (plan, whole) = converted(&mut session, "ogre");
    let mut known = whole.clone();
    for step in &mut known.steps {
        let inner = step.draws.len().saturating_sub(1);
        step.draws[..inner].iter_mut().for_each(|draw| draw.after = None);
    }
    let mut differs = |plan: &FramePlan, capture: &Capture| -> Vec<Vec<Option<RecomputeDifference>>> {
        let checked = session.compared_with_rerun(plan, capture, &Progress::default()).expect("checked");
        checked.steps.iter().map(|step| step.draws.iter().map(|draw| draw.differs).collect()).collect()
    };
    let found = differs(&plan, &known);
    let mut runs = 0;
    for (pass, whole) in found.iter().zip(&whole.steps) {
        let Some((last, inner)) = pass.split_last() else { continue };
        let of_whole = whole.draws.iter().filter_map(|draw| draw.differs).map(|differs| differs.stencil).sum::<u64>();
        assert!(last.is_none_or(|last| last.stencil <= of_whole + MOST_DIFFERING), "{last:?}");
        if last.is_some() && !inner.is_empty() {
            assert!(inner.iter().all(Option::is_none), "{inner:?}");
            runs += 1;
        }
    }
    assert!(runs > 1, "{runs}");
    let volumes = plan.passes.iter().position(|pass| pass.name == "volumes").expect("volumes");
    assert!(plan.passes[volumes].draws.len() > 1);
    // With one triangle of its largest draw the run comes to something else.
    let mut without = plan.clone();
    let inner = without.passes[volumes].draws.split_last_mut().expect("draws").1;
    let largest = inner.iter_mut().max_by_key(|draw| draw.triangles.len()).expect("a draw");
    largest.triangles.end = largest.triangles.start + 1;
    let last = |found: &[Vec<Option<RecomputeDifference>>]| found[volumes].last().copied().flatten();
    let stencil = last(&differs(&without, &known)).expect("held against").stencil;
    assert!(stencil > 10 * MOST_DIFFERING, "{stencil}");
    // What follows a pass that left nobody knows what is not held against anything, until something is known again.
    known.steps[volumes].draws.iter_mut().for_each(|draw| draw.after = None);
    let found = differs(&plan, &known);
    assert_eq!(last(&found), None);
    assert_eq!(found[volumes + 1].iter().flatten().count(), 0, "{:?}", found[volumes + 1]);
}

/// Blender draws what is lit and then what is in shadow: that the second passes adds no light.
#[test]
fn why_a_pixel_is_dark_says_what_its_label_does() {
    let (mut session, mut random) = (session(), Random::new(11));
    for (name, dark) in
        [("blender", "the light pass draws it as what is in shadow"), ("ogre", "the light pass skips it")]
    {
        let frame = frame_of(name);
        let labels = frame.capture.lights[0].shadow.as_ref().expect("labels");
        let (mut lit, mut shadows) = (0, 0);
        for _ in 0..400 {
            let pixel = frame.plan.size.map(|side| random.below(side));
            let (expected, count) = match labels.byte_at(pixel) {
                Some(LIT) => ("the light pass adds the light", &mut lit),
                Some(SHADOW) => (dark, &mut shadows),
                _ => continue,
            };
            *count += 1;
            let history = session.history(&frame.plan, &frame.capture, pixel).expect("a history");
            let why = history.why(0).expect("a light that counts").to_string();
            assert!(why.ends_with(expected), "{name} {pixel:?}: {why}");
        }
        assert!(lit > 30 && shadows > 10, "{name}: {lit} lit, {shadows} in shadow");
    }
}

/// A frame whose plan has one fault, run by us as if its program had drawn it so.
fn provoked(session: &mut Session, name: &str, change: impl Fn(&mut FramePlan)) -> RunFrame {
    let mut frame = frame_of(name);
    let mut plan = (*frame.plan).clone();
    change(&mut plan);
    let scene = frame.scene().expect("a scene").clone();
    let run = session.capture_plan(&scene, &plan).expect("a capture");
    let mut capture = Capture { steps: run.steps, ..(*frame.capture).clone() };
    capture.lights[0].shadow =
        stencilscope::recorded::labels(&plan, &capture, LightId(0), &SeenSurfaces::of(&plan, &capture));
    (frame.plan, frame.capture) = (Arc::new(plan), Arc::new(capture));
    frame
}

fn volumes(plan: &mut FramePlan) -> impl Iterator<Item = &mut RasterState> {
    let draws = plan.passes.iter_mut().flat_map(|pass| &mut pass.draws);
    draws.filter(|draw| draw.part.is_of_volume()).map(|draw| &mut draw.raster)
}

/// Lets the light's pass compare some bits of the stencil alone.
fn compare_bits(plan: &mut FramePlan, mask: u32) {
    let draws = plan.passes.iter_mut().filter(|pass| pass.name == "light").flat_map(|pass| &mut pass.draws);
    draws.for_each(|draw| draw.raster.stencil.read_mask = mask);
}

/// Leaves in the stencil what a frame before may have left.
fn leave_stencil(plan: &mut FramePlan) {
    let volumes = plan.passes.iter_mut().find(|pass| pass.name == "volumes").expect("volumes");
    volumes.depth_stencil.as_mut().expect("a target").clear_stencil = None;
    let texels = (plan.size[0] * plan.size[1]) as usize;
    let start = StartContent { depth: None, stencil: Some(Blob::new(vec![3; texels])) };
    plan.passes[0].recorded.as_mut().expect("recorded").start = Some(start);
}

#[test]
fn what_is_wrong_is_named_first_and_proven_by_a_changed_plan() {
    let mut session = session();
    let mut proven = |name: &str, cause: Cause, change: &dyn Fn(&mut FramePlan)| {
        let frame = provoked(&mut session, name, change);
        let diagnosis = session.diagnose_recorded(&frame, &Progress::default()).expect("a diagnosis");
        assert!(diagnosis.wrong() > 50, "{}: {}", cause.name(), diagnosis.to_text());
        let first = diagnosis.causes.first().expect("a cause");
        assert_eq!((first.cause, first.proof), (cause, Proof::Proven), "{}", diagnosis.to_text());
        assert!(diagnosis.to_json().expect("JSON").contains(cause.name()));
    };
    proven("ogre", Cause::FaceCulled, &|plan| volumes(plan).for_each(|raster| raster.cull = Some(wgpu::Face::Back)));
    proven("ogre", Cause::VolumesWriteDepth, &|plan| volumes(plan).for_each(|raster| raster.depth_write = true));
    proven("ogre", Cause::StencilMask, &|plan| compare_bits(plan, 0xfe));
    proven("ogre", Cause::StencilNotCleared, &leave_stencil);
    proven("ogre", Cause::Clamped, &|plan| {
        for raster in volumes(plan) {
            raster.stencil.front.pass_op = wgpu::StencilOperation::DecrementClamp;
            raster.stencil.back.pass_op = wgpu::StencilOperation::IncrementClamp;
        }
    });
    proven("own", Cause::CapFighting, &|plan| {
        let nearer = volumes(plan).filter(|raster| raster.depth_compare == wgpu::CompareFunction::Greater);
        nearer.for_each(|raster| raster.depth_compare = wgpu::CompareFunction::GreaterEqual);
    });
}

#[test]
fn causes_that_help_together_alone_are_found_together() {
    let mut session = session();
    let frame = provoked(&mut session, "ogre", |plan: &mut FramePlan| {
        leave_stencil(plan);
        compare_bits(plan, 0x80);
    });
    let diagnosis = session.diagnose_recorded(&frame, &Progress::default()).expect("a diagnosis");
    let text = diagnosis.to_text();
    let both = [Cause::StencilNotCleared, Cause::StencilMask];
    let alone = diagnosis.causes.iter().filter(|found| found.together_with.is_empty() && both.contains(&found.cause));
    assert_eq!(alone.map(|found| found.proof).collect::<Vec<_>>(), [Proof::NotIt; 2], "{text}");
    let first = diagnosis.causes.first().expect("a cause");
    let mut named = first.together_with.clone();
    named.push(first.cause);
    assert!(both.iter().all(|cause| named.contains(cause)) && named.len() == 2, "{text}");
    assert_eq!((first.proof, first.pixels_left), (Proof::Proven, 0), "{text}");
    let said = [["stencil-not-cleared", "stencil-mask"], ["stencil-mask", "stencil-not-cleared"]];
    let title = said.map(|[one, other]| format!("\n{one} and {other} (light 1), proven: 0 pixels left\n"));
    assert!(title.iter().any(|title| text.contains(title)), "{text}");
}

/// Depth that is clamped ends nothing: rays go on beyond the far plane, as the picture does.
#[test]
fn a_far_plane_that_cuts_no_surface_ends_no_ray() {
    let mut frame = read(&recording("ogre-far")).expect("a recording");
    let far = |frame: &RawFrame| convert(frame, "far").expect("a frame").capture.depth.far;
    assert!(far(&frame).is_some_and(|far| (340.0..360.0).contains(&far)));
    for event in &mut frame.events {
        if let RawKind::Draw(draw) = &mut event.kind {
            (draw.shape.depth_clip, draw.shape.depth_clamp) = (false, true);
        }
    }
    assert_eq!(far(&frame), None);
}

/// A quad that darkens where the stencil says so does it whichever way a surface faces; light that is added does not.
#[test]
fn what_is_darkened_is_compared_whichever_way_it_faces() {
    let casters = |name: &str| {
        let frame = frame_of(name);
        let scene = frame.scene().expect("a scene");
        let light = scene.lights[0].position;
        let casters = scene.objects.iter().filter(|object| object.casts);
        casters.map(|object| object.light_positions.get(&0).map(|own| *own == light)).collect::<Vec<_>>()
    };
    let darkened = casters("irrlicht-inside");
    assert!(!darkened.is_empty() && darkened.iter().all(|own| *own == Some(true)), "{darkened:?}");
    let added = casters("ogre");
    assert!(!added.is_empty() && added.iter().all(Option::is_none), "{added:?}");
}

/// Which objects are meant to cast is nothing that a frame says.
#[test]
fn what_is_taken_to_cast_nothing_is_said() {
    let mut session = session();
    let diagnosis = session.diagnose_recorded(&frame_of("ogre"), &Progress::default()).expect("a diagnosis");
    assert_eq!((diagnosis.silent.len(), diagnosis.unseen.len()), (1, 0), "{}", diagnosis.to_text());
    assert!(
        diagnosis.to_text().contains("taken to cast no shadow, as no volume begins there and no map has it: event 32")
    );
    let diagnosis = session.diagnose_recorded(&frame_of("ogre-inside"), &Progress::default()).expect("a diagnosis");
    assert!(!diagnosis.unseen.is_empty(), "{}", diagnosis.to_text());
}

#[test]
fn a_right_frame_has_no_wrong_pixel_and_says_so() {
    let mut session = session();
    let diagnosis = session.diagnose_recorded(&frame_of("ogre"), &Progress::default()).expect("a diagnosis");
    assert!(diagnosis.wrong() == 0 && diagnosis.wrong_again <= MOST_DIFFERING, "{}", diagnosis.to_text());
    let text = diagnosis.to_text();
    assert!(text.starts_with("ogre: compared 47") && text.contains("\n0 of 47"), "{text}");
    let coverage = diagnosis.coverage[0];
    let of_reasons: u64 = coverage.reasons().iter().map(|(_, pixels)| pixels).sum();
    assert_eq!((coverage.pixels, coverage.compared + of_reasons), (320 * 240, 320 * 240));
    let json = json(&diagnosis);
    assert_eq!((&json["verdict"], &json["no_verdict"]), (&"right".into(), &serde_json::Value::Null));
    assert_eq!(json["coverage"][0]["compared"], coverage.compared);
}

fn json(diagnosis: &FrameDiagnosis) -> serde_json::Value {
    serde_json::from_str(&diagnosis.to_json().expect("JSON")).expect("JSON")
}

/// Nothing is called right or wrong on the strength of a guess.
#[test]
fn of_a_frame_of_which_too_little_is_known_there_is_no_verdict() {
    let mut session = session();
    let ogre = frame_of("ogre");
    // Surfaces that another picture's depth has: none of their triangles is known.
    let mut source = (**ogre.source.as_ref().expect("a source")).clone();
    source.scene.objects.clear();
    let unknown = RunFrame { source: Some(Arc::new(source)), ..ogre.clone() };
    let mut unfound = (*ogre.capture).clone();
    unfound.lights[0].position = DVec4::ZERO;
    let no_light = RunFrame { source: None, capture: Arc::new(unfound), ..ogre.clone() };
    let without_lights = Capture { lights: Vec::new(), ..(*ogre.capture).clone() };
    let nothing = RunFrame { capture: Arc::new(without_lights), ..ogre.clone() };
    for (frame, reason, words) in [
        (&unknown, NotCompared::UnknownSurface, "most surfaces are drawn by no triangle that is known"),
        (&no_light, NotCompared::NoLight, "neither shadow volumes nor a shadow map tell where light 1 is"),
        (&nothing, NotCompared::NoLight, "nothing in this frame counts shadow volumes"),
    ] {
        let diagnosis = session.diagnose_recorded(frame, &Progress::default()).expect("a diagnosis");
        let text = diagnosis.to_text();
        let coverage = diagnosis.coverage[0];
        assert_eq!(coverage.reasons().first().map(|(because, _)| *because), Some(reason), "{text}");
        let start = "ogre: compared 0 of 76\u{a0}800 pixels; 76\u{a0}800 not: ";
        assert!(text.starts_with(start), "{text}");
        assert!(text.contains(words) && !text.contains("wrong") && text.contains("takes 1 away"), "{text}");
        let json = json(&diagnosis);
        assert_eq!((&json["verdict"], &json["regions"]), (&serde_json::Value::Null, &serde_json::json!([])));
        assert_eq!(json["coverage"][0]["not_compared"][reason.name()], coverage.reasons()[0].1);
        assert!(json["stencil_uses"].as_array().is_some_and(|uses| !uses.is_empty()), "{json}");
        assert!(json["no_verdict"].as_str().is_some_and(|said| said.contains(words)), "{json}");
    }
    let scene = unknown.scene().expect("a scene").clone();
    let error = session.judged(&scene, &unknown.capture, &Progress::default()).expect_err("nothing to judge by");
    assert!(error.to_string().contains("have a surface that no known triangle draws"), "{error}");
}

#[test]
fn a_frame_that_its_program_drew_wrong_is_found_named_and_proven() {
    let mut session = session();
    let mut diagnosis = |name| session.diagnose_recorded(&frame_of(name), &Progress::default()).expect("a diagnosis");
    let short = diagnosis("ogre-short");
    let first = short.causes.first().expect("a cause");
    assert!(short.wrong() > 500, "{}", short.to_text());
    assert_eq!((first.cause, first.proof, first.pixels_left), (Cause::FiniteExtrusion, Proof::Proven, 0));
    // Its volumes are cut by the far plane, and where OGRE left a cap out of the box's they were open besides.
    let far = diagnosis("ogre-far");
    let first = far.causes.first().expect("a cause");
    assert_eq!((first.cause, first.proof), (Cause::FarClip, Proof::Proven), "{}", far.to_text());
    assert_eq!((first.pixels_left, &first.together_with[..]), (0, &[Cause::OpenVolume][..]));
    for said in
        ["far-clip and open-volume (light 1), proven: 0 pixels left", "; 84 edges of", "depth clamping", "both caps"]
    {
        assert!(far.to_text().contains(said), "{said}: {}", far.to_text());
    }
    let alone = &far.causes[1];
    assert!(alone.cause == Cause::FarClip && alone.pixels_left * 3 < far.wrong(), "{}", far.to_text());
    // What lies beyond the far plane is in nobody's picture.
    let compared: u64 = far.lights.iter().map(|light| light.error.compared).sum();
    assert!(compared < 76_800 && far.lights.iter().all(|light| light.error.wrong_surface == 0), "{}", far.to_text());
}

/// Our light raises the count where it was added, so that no pixel is lit twice: that counts no volume.
#[test]
fn light_that_steps_where_it_is_added_is_no_volume() {
    let (plan, capture) = converted(&mut session(), "own");
    let names: Vec<&str> = plan.passes.iter().map(|pass| pass.name.as_str()).collect();
    assert_eq!(names.iter().filter(|name| **name == "volumes").count(), 1, "{names:?}");
    assert_eq!(capture.lights.len(), 1);
    let of_light = plan.passes.iter().rev().find(|pass| pass.name == "light").expect("a light pass");
    assert_eq!(of_light.recorded.as_ref().expect("recorded").groups, ["light"]);
}

/// Vulkan's clip space is wgpu's: nothing is rounded on the way.
#[test]
fn our_own_frame_on_vulkan_is_computed_anew_to_the_last_bit() {
    let (plan, capture) = converted(&mut session(), "own");
    let names: Vec<&str> = plan.passes.iter().map(|pass| pass.name.as_str()).collect();
    assert!(names.contains(&"volumes") && names.contains(&"light"), "{names:?}");
    assert!(plan.passes.iter().any(|pass| pass.recorded.as_ref().is_some_and(|of| of.groups == ["volumes"])));
    for differs in differing(&capture) {
        let is_same = differs == RecomputeDifference::default();
        assert!(is_same || !adapter::draws_as_given(), "{differs:?}");
    }
}

#[test]
fn commands_answer_from_the_folder_of_a_recorded_frame() {
    let work = crate::commands::folder();
    let run = |arguments: &[&str]| crate::commands::run(work.path(), arguments);
    let text = crate::commands::text;
    for (name, code) in [("ogre", 0), ("ogre-short", 1)] {
        let frame = frame_of(name);
        write(frame.contents(), &work.path().join(name), false).expect("written");
        let output = run(&["diagnose", name]);
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        assert_eq!(text(&output.stdout).contains("finite-extrusion (light 1), proven: 0 pixels left"), code == 1);
        let json = run(&["diagnose", name, "--json"]);
        let document: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
        let regions = document["regions"].as_array().expect("regions");
        assert_eq!(regions.len(), code as usize);
        assert!(regions.iter().all(|region| region["causes"][0]["proof"] == "proven"), "{document}");
        let history = run(&["pixel", name, "--at", "160,170"]);
        assert!(text(&history.stdout).contains("pass 2, light 1: volumes"), "{}", text(&history.stdout));
    }
    let refused = run(&["diagnose", "ogre", "--fix", "mended.toml"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("another program drew this frame"), "{}", text(&refused.stderr));
}
