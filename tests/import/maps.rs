//! Shadow maps of other programs: the light that their draws tell, what pixels read, and what is wrong with them.

use super::convert::frame_of;
use super::shared::recording;
use crate::common::random::Random;
use crate::common::session;
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::sync::Arc;
use stencilscope::capture::{Capture, MapProjection};
use stencilscope::diagnosis::frame_causes::{FrameDiagnosis, kept_faces};
use stencilscope::diagnosis::{Cause, NotCompared, Proof};
use stencilscope::import::{ConvertedFrame, convert, read};
use stencilscope::plan::{Blob, FramePlan, LightId, Pass, StartContent};
use stencilscope::progress::Progress;
use stencilscope::reading::map_decision::MapDecision;
use stencilscope::reading::map_readers::MapReaders;
use stencilscope::recorded::{self, FoundLight, LightEvidence, MapReading, SeenSurfaces};
use stencilscope::session::{FrameSource, RunFrame, Session};
use stencilscope::truth::Tracer;

/// The script's light, and its camera as (eye, target).
const LIGHT: DVec3 = DVec3::new(8.0, 18.0, 12.0);
const CAMERA: [DVec3; 2] = [DVec3::new(5.0, 12.0, 26.0), DVec3::new(0.0, 2.0, 0.0)];

/// Returns a direction as pygfx's camera sees it, stretched as an eye of 90 degrees sees it.
fn seen(direction: DVec3, [width, height]: [u32; 2]) -> DVec3 {
    let ahead = (CAMERA[1] - CAMERA[0]).normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let above = right.cross(ahead);
    // pygfx's 60 degrees are those of a square that is as wide as the picture is on the mean of its sides.
    let aspect = f64::from(width) / f64::from(height);
    let stretch = (1.0 + aspect) / 2.0 / 30.0_f64.to_radians().tan();
    DVec3::new(direction.dot(right) * stretch, direction.dot(above) * stretch, -direction.dot(ahead))
}

#[test]
fn the_light_of_a_map_is_found_where_the_script_placed_it() {
    for name in ["pygfx", "pygfx-acne"] {
        let ConvertedFrame { lights, capture, .. } =
            convert(&read(&recording(name)).expect("a recording"), name).expect("a frame");
        let [Some(found)] = lights[..] else { panic!("{name}: {lights:?}") };
        let angle = found.position.truncate().angle_between(seen(LIGHT, capture.size)).to_degrees();
        let LightEvidence::Map { agree, of, residual } = found.evidence else { panic!("{:?}", found.evidence) };
        println!("{name}: {agree} of {of} draws, {residual} texels, {angle} degrees");
        assert!(found.position.w == 0.0 && angle < 0.01 && residual < 0.05, "{name}: {found:?}, {angle}");
        assert_eq!((agree, of), (4, 4));
    }
}

/// Texel and both depths of random pixels are those that the light's matrix and rays through the triangles give.
#[test]
fn pixels_read_the_texels_that_hold_what_the_map_stores() {
    let RunFrame { capture, plan, source } = frame_of("pygfx");
    let tracer = Tracer::new(&source.expect("a scene").scene, capture.size).expect("a tracer");
    let readers = MapReaders::new(&capture, Some(&plan), 0).expect("readers");
    let map = capture.lights[0].map.as_ref().expect("a map");
    let mut random = Random::new(52);
    let (mut held, mut dark) = (0, 0);
    while held < 200 {
        let pixel = capture.size.map(|side| random.below(side));
        let Some(seen) = tracer.seen_at(pixel.map(|at| f64::from(at) + 0.5)) else { continue };
        let clip: DVec4 = map.clip_from_light[0] * seen.point.extend(1.0);
        let [width, height] = map.faces[0].size().map(f64::from);
        let place = [(clip.x / clip.w * 0.5 + 0.5) * width, (0.5 - clip.y / clip.w * 0.5) * height];
        let is_in = (0.0..width).contains(&place[0]) && (0.0..height).contains(&place[1]);
        let found = MapDecision::of(&capture, &readers, 0, pixel);
        // At the border of a texel, or of the map, either may be right.
        if place.iter().any(|at| (at - at.round()).abs() < 0.01) {
            continue;
        }
        assert_eq!(found.is_some(), is_in, "{pixel:?} at {place:?}");
        let Some(found) = found else { continue };
        let texel = place.map(|at| at.floor() as u32);
        assert_eq!(found.middle.texel.at, texel, "{pixel:?}");
        assert_eq!(Some(found.middle.stored), map.faces[0].depth_at(texel));
        // Its own depth is that of its plane at the texel's middle: no further off than the plane is steep.
        assert!((f64::from(found.middle.depth) - clip.z / clip.w).abs() < 2e-3, "{pixel:?}: {found:?}");
        assert!(found.gpu_says.is_none() && found.sentence().contains("by the map"), "{}", found.sentence());
        held += 1;
        dark += usize::from(!found.middle.is_lit);
    }
    assert!((2..150).contains(&dark), "{dark}");
}

/// Of a floor that shadows itself, some pixels would be dark without a bias, and the words say so.
#[test]
fn a_pixel_that_only_a_bias_lights_is_said_to_be() {
    let RunFrame { capture, plan, .. } = frame_of("pygfx-acne");
    let readers = MapReaders::new(&capture, Some(&plan), 0).expect("readers");
    let decisions = (60..160).filter_map(|x| MapDecision::of(&capture, &readers, 0, [x, 150]));
    let (needing, others): (Vec<_>, Vec<_>) = decisions.partition(|one| one.needs_bias);
    assert!(needing.len() > 20 && others.len() > 20, "{} and {}", needing.len(), others.len());
    assert!(needing.iter().all(|one| one.middle.is_lit && one.sentence().contains("without a bias it would be dark")));
    assert!(others.iter().all(|one| !one.sentence().contains("bias")));
}

/// Which faces a map keeps follows from the states of its draws, whichever way its view turns them: one recording's script culls
/// front faces, the other's back faces.
#[test]
fn the_faces_that_a_map_keeps_are_known() {
    for (name, kept) in [("pygfx", Some(false)), ("pygfx-acne", Some(true))] {
        let RunFrame { capture, mut plan, .. } = frame_of(name);
        assert_eq!(kept_faces(&plan, &capture, LightId(0)), kept, "{name}");
        let changed = Arc::make_mut(&mut plan);
        let into_map = changed.lights[0].map.as_ref().expect("a map").attachment;
        let is_into_map = |pass: &&mut Pass| pass.depth_stencil.as_ref().is_some_and(|to| to.attachment == into_map);
        let draw = changed.passes.iter_mut().filter(is_into_map).flat_map(|pass| &mut pass.draws).next();
        draw.expect("a draw into the map").raster.cull = None;
        assert_eq!(kept_faces(&plan, &capture, LightId(0)), None, "{name}: draws differ");
    }
}

#[test]
fn the_middle_of_a_texel_is_found_on_the_plane_that_a_pixel_shows() {
    let RunFrame { capture, plan, .. } = frame_of("pygfx");
    let seen = SeenSurfaces::of(&plan, &capture);
    let reading = MapReading::new(&capture, LightId(0), &seen).expect("a map");
    let projection = MapProjection::recorded(&capture, 0).expect("a map");
    let depth = &capture.frame_at(capture.steps.len() - 1).expect("a frame").depth.image;
    let mut random = Random::new(53);
    let mut held = 0;
    while held < 200 {
        let pixel = capture.size.map(|side| random.below(side));
        let (Some(middle), Some((world, plane))) = (reading.texel_point(pixel, DVec2::ZERO), seen.at(pixel, depth))
        else {
            continue;
        };
        held += 1;
        assert!((middle - world).dot(plane).abs() <= 1e-9 * world.length(), "{pixel:?}: {middle} is not on the plane");
        let [own, found] = [world, middle].map(|point| {
            let (face, clip) = projection.place(point, plane).expect("a face");
            (face, projection.texel(clip))
        });
        assert_eq!(own.0, found.0, "{pixel:?}");
        assert!((own.1.floor() + 0.5).distance(found.1) < 1e-6, "{pixel:?}: {own:?} and {found:?}");
    }
}

fn diagnosis(session: &mut Session, frame: &RunFrame) -> FrameDiagnosis {
    session.diagnose_recorded(frame, &Progress::default()).expect("a diagnosis")
}

#[test]
fn a_map_without_a_fault_is_wrong_only_by_the_size_of_its_texels() {
    let found = diagnosis(&mut session(), &frame_of("pygfx"));
    let [light] = &found.lights[..] else { panic!("{}", found.to_text()) };
    assert!(light.error.compared > 20_000 && light.error.wrong() < 20, "{}", found.to_text());
    assert!(light.beyond_texels() == 0 && light.acne == 0, "{}", found.to_text());
    // Nine tenths of all that has a surface and faces the light.
    let coverage = &found.coverage[0];
    let uncounted =
        |(because, _): &&(NotCompared, u64)| matches!(because, NotCompared::NoSurface | NotCompared::FacesAway);
    let reasons = coverage.reasons();
    let others: u64 = reasons.iter().filter(uncounted).map(|(_, pixels)| pixels).sum();
    assert!(coverage.compared * 10 > 9 * (coverage.pixels - others), "{}", coverage.in_words());
}

#[test]
fn acne_is_seen_in_what_the_program_drew() {
    let found = diagnosis(&mut session(), &frame_of("pygfx-acne"));
    let first = found.causes.first().expect("a cause");
    assert_eq!((first.cause, first.evidence.holds()), (Cause::Acne, true), "{}", found.to_text());
    // With a bias in the draws nearly none is left.
    assert!(found.lights[0].acne > 8_000 && first.pixels_left * 100 < found.lights[0].acne, "{}", found.to_text());
    assert!(found.to_text().contains("pixels are drawn dark that its map lights"));
    let json: serde_json::Value = serde_json::from_str(&found.to_json().expect("JSON")).expect("JSON");
    assert_eq!((&json["verdict"], &json["findings"][0]["cause"]), (&"wrong".into(), &"acne".into()));
}

/// A frame whose plan has one fault, run by us as if its program had drawn it so.
fn provoked(session: &mut Session, change: impl Fn(&mut FramePlan)) -> RunFrame {
    let frame = frame_of("pygfx");
    let mut plan = (*frame.plan).clone();
    change(&mut plan);
    let scene = frame.scene().expect("a scene").clone();
    let run = session.capture_plan(&scene, &plan).expect("a capture");
    let mut capture = Capture { steps: run.steps, ..(*frame.capture).clone() };
    capture.lights[0].map.clone_from(&run.lights[0].map);
    let shadow = recorded::labels(&plan, &capture, LightId(0), &SeenSurfaces::of(&plan, &capture));
    capture.lights[0].shadow = shadow;
    // What is in the map tells what casts.
    let evidence = LightEvidence::Map { agree: 0, of: 0, residual: 0.0 };
    let light = FoundLight { position: capture.lights[0].position, evidence };
    let scene = recorded::scene(&plan, capture.camera, "provoked", &[light]);
    let source = Some(Arc::new(FrameSource { scene, request: None }));
    RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source }
}

fn map_passes(plan: &mut FramePlan) -> impl Iterator<Item = &mut Pass> {
    let map = plan.lights[0].map.as_ref().expect("a map").attachment;
    plan.passes.iter_mut().filter(move |pass| pass.depth_stencil.as_ref().is_some_and(|one| one.attachment == map))
}

/// Gives the map another view: `changed` is multiplied to its clip space.
fn view(plan: &mut FramePlan, changed: DMat4) {
    let meshes: Vec<usize> = map_passes(plan).flat_map(|pass| &pass.draws).map(|draw| draw.mesh.0).collect();
    for mesh in meshes {
        let vertices = plan.meshes[mesh].vertices.data().iter();
        let moved = vertices.map(|at| (changed * DVec4::from_array(at.map(f64::from))).as_vec4().to_array());
        plan.meshes[mesh].vertices = Blob::new(moved.collect());
    }
    let map = plan.lights[0].map.as_mut().expect("a map");
    map.clip_from_light.iter_mut().for_each(|clip| *clip = changed * *clip);
}

#[test]
fn what_is_wrong_with_a_map_is_named_first_and_proven_by_a_changed_plan() {
    let mut session = session();
    let mut proven = |cause: Cause, change: &dyn Fn(&mut FramePlan)| {
        let frame = provoked(&mut session, change);
        let found = diagnosis(&mut session, &frame);
        let first = found.causes.first().expect("a cause");
        println!("{}", found.to_text());
        assert_eq!((first.cause, first.proof), (cause, Proof::Proven), "{}", found.to_text());
        assert!(found.lights[0].beyond_texels() > 20 || cause == Cause::NotInMap, "{}", found.to_text());
    };
    proven(Cause::MapFarPlane, &|plan| view(plan, DMat4::from_diagonal(DVec4::new(1.0, 1.0, 4.2, 1.0))));
    proven(Cause::MapNearPlane, &|plan| {
        let mut changed = DMat4::IDENTITY;
        changed.w_axis.z = -0.27;
        view(plan, changed);
    });
    proven(Cause::OutsideMap, &|plan| view(plan, DMat4::from_diagonal(DVec4::new(3.0, 3.0, 1.0, 1.0))));
    proven(Cause::PeterPanning, &|plan| {
        let draws = map_passes(plan).flat_map(|pass| &mut pass.draws);
        draws.for_each(|draw| draw.raster.depth_bias.constant = 600_000);
    });
    proven(Cause::MapNotCleared, &|plan| {
        let texels = plan.attachments[1].size.map(|side| side as usize).into_iter().product();
        let depth = (0..texels).map(|at: usize| if at.is_multiple_of(3) { 0.1 } else { 1.0 }).collect();
        let pass = map_passes(plan).next().expect("a pass");
        pass.depth_stencil.as_mut().expect("a target").clear_depth = None;
        let start = StartContent { depth: Some(Blob::new(depth)), stencil: None };
        pass.recorded.as_mut().expect("recorded").start = Some(start);
    });
    proven(Cause::NotInMap, &|plan| {
        let pass = map_passes(plan).next().expect("a pass");
        // The last is the ball, above the floor.
        pass.draws.pop();
    });
}

/// Irrlicht darkens what the stencil counts, by z-pass, with the eye in a volume.
#[test]
fn a_pass_that_darkens_is_read_as_shadow() {
    let frame = frame_of("irrlicht-inside");
    assert!(frame.plan.passes.iter().any(|pass| pass.name == "darkening"), "{}", frame.plan);
    let found = diagnosis(&mut session(), &frame);
    let first = found.causes.first().expect("a cause");
    assert_eq!(first.cause, Cause::EyeInVolume, "{}", found.to_text());
    assert!(found.wrong() > 10_000 && first.pixels_left < 100, "{}", found.to_text());
}
