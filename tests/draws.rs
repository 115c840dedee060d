//! The state after each draw: what it is, what it shares, and how it lies in a capture folder.

use crate::commands::read_json;
use crate::common::{cuboid, from_above, names, opened, request, session, square};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use stencilscope::ask::{Ask, CaptureOf, Question, RunRequest};
use stencilscope::capture::disk::{CaptureError, read, write};
use stencilscope::capture::{Capture, DrawState, FrameSnapshot, Image, Snapshot};
use stencilscope::progress::Progress;
use stencilscope::scene::{Light, Scene};
use stencilscope::session::{CaptureRequest, Session, SnapshotInterval};
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [64, 48];

fn by_draw(technique: Technique) -> CaptureRequest {
    CaptureRequest { every: SnapshotInterval::Draw, ..request(technique, SIZE) }
}

/// Something for every technique: a closed and an open caster, a point light and a sun.
fn scene() -> Scene {
    let mut scene = from_above(vec![cuboid("box", [-1.0, 1.0, -1.0], [1.0, 2.0, 0.5]), square("sheet", 0.5, 2.0)]);
    scene.lights.push(Light::directional(glam::DVec3::new(1.0, 2.0, 0.5)));
    scene
}

/// What a capture has without what a clock says.
fn untimed(mut capture: Capture) -> Capture {
    capture.timing = Default::default();
    capture.steps.iter_mut().for_each(|step| step.gpu_ms = None);
    capture
}

/// The capture without times and without the states after draws.
fn without_draws(capture: Capture) -> Capture {
    let mut capture = untimed(capture);
    capture.steps.iter_mut().flat_map(|step| &mut step.draws).for_each(|draw| draw.after = None);
    capture
}

fn state(capture: &Capture, step: usize, draw: usize) -> &DrawState {
    capture.steps[step].draws[draw].after.as_ref().expect("a state")
}

fn frame(state: &DrawState) -> &FrameSnapshot {
    match &state.snapshot {
        Snapshot::Frame(frame) => frame,
        Snapshot::Map { .. } => panic!("a map"),
    }
}

fn stencil(state: &DrawState) -> &Arc<Image> {
    &frame(state).stencil.as_ref().expect("a stencil").image
}

/// What the window compares with is stepped draw by draw, as a capture of every draw is.
#[test]
fn another_frame_is_captured_with_the_draws_of_a_pass() {
    let mut session = session();
    let scene = scene();
    let choice = request(Technique::ZPass, SIZE).choice;
    let whole = session.capture(&scene, &by_draw(Technique::ZPass)).expect("a capture");
    let mut answer = |(is_judged, draws_of): (bool, Option<usize>)| {
        let request = Box::new(RunRequest::of(&scene, choice.clone(), SIZE));
        let ask = Ask::CaptureOf(CaptureOf { request, is_judged, draws_of });
        let answer = session.answer(&ask, Some(&scene), None, &Progress::default()).expect("an answer");
        CaptureOf::answer(&answer).expect("a capture").as_ref().clone()
    };
    let step = whole.steps.iter().position(|step| step.draws.len() > 2).expect("a pass of some draws");
    let asked = [(false, None), (false, Some(step)), (true, None)];
    let [plain, with_draws, judged] = asked.map(&mut answer);
    assert!(plain.error().is_none() && judged.error().is_some_and(|error| error.compared > 0));
    assert!(plain.steps.iter().flat_map(|step| &step.draws).all(|draw| draw.after.is_none()));
    for draw in 0..whole.steps[step].draws.len() {
        let [found, expected] = [&with_draws, &whole].map(|capture| stencil(state(capture, step, draw)));
        assert!(found.rows().eq(expected.rows()), "draw {draw}");
    }
    assert_eq!(without_draws(with_draws), untimed(plain));
}

#[test]
fn passes_are_those_of_a_capture_without_draws_and_end_as_their_last_draw() {
    let mut session = session();
    let scene = scene();
    for technique in Technique::ALL {
        let whole = session.capture(&scene, &request(technique, SIZE)).expect("a capture");
        let split = session.capture(&scene, &by_draw(technique)).expect("a capture");
        assert!(without_draws(split.clone()) == without_draws(whole), "{technique:?}");
        let with_draws = split.steps.iter().filter(|step| !step.draws.is_empty()).count();
        assert!(with_draws >= 2, "{technique:?}: surfaces are drawn more than once");
        for (index, step) in split.steps.iter().enumerate() {
            assert!(split.holds_draws(index), "{technique:?} {}", step.name);
            let Some(last) = step.draws.len().checked_sub(1).map(|last| state(&split, index, last)) else { continue };
            match (&step.snapshot, &last.snapshot) {
                (Snapshot::Frame(after), Snapshot::Frame(frame)) => {
                    assert!(Arc::ptr_eq(&after.color.image, &frame.color.image), "{technique:?} {}", step.name);
                    assert!(Arc::ptr_eq(&after.depth.image, &frame.depth.image), "{technique:?} {}", step.name);
                    let [after, frame] =
                        [after, frame].map(|frame| frame.stencil.as_ref().map(|stencil| &stencil.image));
                    assert_eq!(after, frame);
                }
                (Snapshot::Map { light, face }, Snapshot::Map { .. }) => {
                    let map = split.lights[*light].map.as_ref().expect("a map");
                    assert!(Arc::ptr_eq(&map.faces[*face], &last.target.as_ref().expect("a face").image));
                }
                other => panic!("{other:?}"),
            }
        }
        let masks = split.steps.iter().filter(|step| step.name.contains("mask"));
        for last in masks.filter_map(|step| Some((step.light?, step.draws.last()?.after.as_ref()?))) {
            let labels = split.lights[last.0].shadow.as_ref().expect("labels");
            assert!(Arc::ptr_eq(labels, &last.1.target.as_ref().expect("labels").image), "{technique:?}");
        }
    }
}

/// For a closed tetrahedron and for tori that shade each other: after k draws of the volumes the
/// stencil is what a plan leaves that has only those k.
#[test]
fn the_stencil_after_a_draw_is_what_a_plan_with_only_the_draws_so_far_leaves() {
    let mut session = session();
    for name in ["tetrahedron", "tori"] {
        let scene = opened(name);
        let split = session.capture(&scene, &by_draw(Technique::ZFail)).expect("a capture");
        let plan = session.plan(&scene, &request(Technique::ZFail, SIZE)).expect("a plan");
        let volumes = plan.passes.iter().position(|pass| pass.name == "volumes").expect("volumes");
        let draws = plan.passes[volumes].draws.len();
        assert!(draws >= 2, "sides and caps");
        let mut distinct = 0;
        for count in 1..=draws {
            let mut only = plan.clone();
            only.passes[volumes].draws.truncate(count);
            let left = session.capture_plan(&scene, &only).expect("a capture");
            let expected = &left.frame_at(volumes).and_then(|frame| frame.stencil.as_ref()).expect("a stencil").image;
            let found = state(&split, volumes, count - 1);
            assert_eq!(stencil(found), expected, "{name}, {count} draws");
            assert!(frame(found).color.unchanged && frame(found).depth.unchanged);
            distinct += usize::from(!found.changes_nothing());
        }
        assert!(distinct >= 1, "{name}");
    }
}

#[test]
fn a_draw_that_changes_nothing_shares_everything_with_the_draw_before() {
    // The second sheet lies hidden below the floor: its ambient draw writes no pixel.
    let scene = from_above(vec![square("hidden", -1.0, 1.0), square("seen", 1.0, 1.0)]);
    let capture = session().capture(&scene, &by_draw(Technique::None)).expect("a capture");
    let [floor, hidden, seen] = [0, 1, 2].map(|draw| state(&capture, 0, draw));
    assert_eq!([floor, hidden, seen].map(DrawState::changes_nothing), [false, true, false]);
    for (before, after) in floor.aspects().zip(hidden.aspects()) {
        assert!(Arc::ptr_eq(&before.image, &after.image));
    }
    // It is as grey as the floor, but nearer.
    assert_eq!((frame(seen).color.unchanged, frame(seen).depth.unchanged), (true, false));
}

#[test]
fn counts_in_floats_grow_draw_by_draw_to_what_the_light_holds() {
    let mut session = session();
    let scene = scene();
    let mut request = by_draw(Technique::ZFail);
    request.choice.set("counter", "float").expect("a setting");
    let capture = session.capture(&scene, &request).expect("a capture");
    let mut last = [None, None];
    for (step, light) in capture.steps.iter().filter_map(|step| Some((step, step.light?))) {
        let targets = step.draws.iter().filter_map(|draw| draw.after.as_ref()?.target.as_ref());
        let is_count = step.name.contains("volumes");
        targets.filter(|_| is_count).for_each(|target| last[light] = Some(target.image.clone()));
    }
    for (light, last) in capture.lights.iter().zip(last) {
        assert!(Arc::ptr_eq(light.count.as_ref().expect("a count"), &last.expect("draws")));
    }
}

#[test]
fn the_draws_of_one_pass_are_filled_in_later_and_are_the_same() {
    let mut session = session();
    let scene = scene();
    for technique in [Technique::ZFail, Technique::ShadowMap, Technique::PlanarTexture] {
        let all = session.capture(&scene, &by_draw(technique)).expect("a capture");
        let plain = session.capture(&scene, &request(technique, SIZE)).expect("a capture");
        let plan = session.plan(&scene, &request(technique, SIZE)).expect("a plan");
        let mut filled = plain.clone();
        for step in (0..all.steps.len()).rev() {
            assert_eq!(filled.holds_draws(step), filled.steps[step].draws.is_empty());
            filled = filled.with_draws(&session.step_draws(&plan, &plain, step).expect("draws"));
            assert!(filled.steps[step].draws == all.steps[step].draws, "{technique:?} {}", all.steps[step].name);
        }
        let [added, both] = [filled.bytes() - plain.bytes(), all.bytes()];
        assert!(added <= both, "as much is shared: {added} bytes beside the passes, {both} with them");
        assert!(without_draws(filled) == without_draws(plain));
    }
}

#[test]
fn draws_that_are_added_twice_change_nothing_and_beyond_the_last_pass_there_are_none() {
    let mut session = session();
    let scene = scene();
    let request = request(Technique::ZFail, SIZE);
    let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
    let draws = session.step_draws(&plan, &capture, 1).expect("draws");
    let once = capture.with_draws(&draws);
    let twice = once.with_draws(&draws);
    assert!(twice == once && Arc::ptr_eq(stencil(state(&twice, 1, 0)), stencil(state(&once, 1, 0))));
    assert!(session.step_draws(&plan, &capture, 99).is_err());
}

#[test]
fn the_unsplit_frame_is_what_is_timed() {
    let request = CaptureRequest { timing_runs: 1, ..by_draw(Technique::ZFail) };
    let capture = session().capture(&scene(), &request).expect("a capture");
    assert!(capture.timing.frame_ms.is_some() && capture.timing.captured_ms.is_some());
    assert!(capture.timing.setup_ms.is_some());
}

#[test]
fn a_pass_takes_as_long_as_its_draws_together_or_nobody_knows() {
    let mut session = session();
    let capture = session.capture(&scene(), &by_draw(Technique::ZFail)).expect("a capture");
    let plain = session.capture(&scene(), &request(Technique::ZFail, SIZE)).expect("a capture");
    for (step, plain) in capture.steps.iter().zip(&plain.steps) {
        assert_eq!(step.gpu_ms.is_some(), plain.gpu_ms.is_some(), "{}", step.name);
    }
}

/// 66 objects, each over the one before, whose copies take more memory than what each of them changes.
fn many_sheets(half: f64) -> Scene {
    let sheets = (0..65).map(|index| square(&format!("sheet {index}"), 0.1 + 0.02 * f64::from(index), half));
    from_above(sheets.collect())
}

#[test]
fn what_draws_leave_alone_takes_no_memory() {
    let request = CaptureRequest { size: [640, 480], ..by_draw(Technique::None) };
    let mut session = session();
    let draws = |capture: &Capture| capture.steps.iter().map(|step| step.draws.len() as u64).sum::<u64>();
    session.hold_at_most(u64::MAX);
    let whole = session.capture(&many_sheets(0.05), &request).expect("a capture");
    // Colour and depth after each.
    let copies = draws(&whole) * 640 * 480 * 8;
    session.hold_at_most(copies / 2);
    let capture = session.capture(&many_sheets(0.05), &request).expect("it fits");
    assert!(untimed(capture.clone()) == untimed(whole) && draws(&capture) >= 65);
    assert!(capture.bytes() < copies / 2, "{} of {copies}", capture.bytes());
}

#[test]
fn a_frame_whose_draws_change_too_much_is_refused_with_a_fix() {
    let mut session = session();
    session.hold_at_most(32 << 20);
    let request = CaptureRequest { size: [640, 480], ..by_draw(Technique::None) };
    let Err(error) = session.capture(&many_sheets(50.0), &request) else { panic!("it is too large") };
    let error = error.to_string();
    assert!(error.contains("at least 3") && error.contains("32 MiB fit"), "{error}");
    assert!(error.contains("--every pass") && !error.contains('\n'), "{error}");
    // The same, pass by pass, does.
    let request = CaptureRequest { every: SnapshotInterval::Pass, ..request };
    assert!(session.capture(&many_sheets(50.0), &request).is_ok());
}

/// A frame that is only timed copies nothing: it is not refused for the copies that it could make.
#[test]
fn a_frame_whose_snapshots_do_not_fit_at_once_is_timed_without_them() {
    let mut session = session();
    let request = request(Technique::ZFail, [640, 480]);
    let scene = many_sheets(0.5);
    let cost = session.capture_cost(&scene, &request, 1).expect("timed");
    assert!(cost.captured.len() == 1 && cost.snapshot_bytes > 0);
    // Enough memory for the attachments, but not for copies beside them.
    session.hold_at_most(cost.snapshot_bytes);
    let less = session.capture_cost(&scene, &request, 1).expect("timed");
    assert!(less.captured.is_empty() && less.frames.len() == 1);
    assert_eq!(less.snapshot_bytes, cost.snapshot_bytes);
}

/// A capture in a folder of its own.
fn written(capture: &Capture, parent: &Path, name: &str) -> std::path::PathBuf {
    let folder = parent.join(name);
    write(capture, &folder, false).expect("written");
    folder
}

#[test]
fn a_folder_with_draws_is_read_back_the_same_for_every_technique() {
    let mut session = session();
    let parent = tempfile::tempdir().expect("a folder");
    let scene = scene();
    for technique in Technique::ALL {
        for counter in ["stencil", "float"] {
            let mut request = by_draw(technique);
            if request.choice.set("counter", counter).is_err() && counter == "float" {
                continue;
            }
            let capture = session.capture(&scene, &request).expect("a capture");
            let folder = written(&capture, parent.path(), &format!("{}-{counter}", technique.name()));
            let mut back = read(&folder).expect("read");
            back.timing.write_ms = None;
            assert!(back == capture, "{technique:?} {counter}");
            assert_eq!(back.bytes() > 0, capture.bytes() > 0);
        }
    }
}

#[test]
fn a_folder_with_draws_has_all_files_of_one_without_and_those_of_draws_beside_them() {
    let mut session = session();
    let parent = tempfile::tempdir().expect("a folder");
    let scene = opened("tetrahedron");
    let plain = session.capture(&scene, &request(Technique::ZFail, SIZE)).expect("a capture");
    let split = session.capture(&scene, &by_draw(Technique::ZFail)).expect("a capture");
    let [plain, split_folder] = [(&plain, "plain"), (&split, "split")].map(|(c, name)| written(c, parent.path(), name));
    let [plain_names, split_names] = [&plain, &split_folder].map(|folder| BTreeSet::from_iter(names(folder)));
    assert!(plain_names.is_subset(&split_names));
    for name in plain_names.iter().filter(|name| name.as_str() != "manifest.json") {
        assert_eq!(fs::read(plain.join(name)).expect("a file"), fs::read(split_folder.join(name)).expect("a file"));
    }
    assert!(split_names.len() > plain_names.len());
    assert!(split_names.difference(&plain_names).all(|name| name.contains(".draw0")), "{split_names:?}");
    let passes = read_json(&split_folder.join("manifest.json"))["passes"].clone();
    let volumes = passes.as_array().expect("passes").iter().find(|pass| pass["name"] == "volumes").expect("volumes");
    let draws = volumes["draws_captured"].as_array().expect("draws");
    assert_eq!(draws.len() as u64, volumes["draws"].as_u64().expect("a number"));
    let first = &draws[0];
    assert_eq!((&first["caster"], &first["part"]), (&volumes["caster"], &"side".into()));
    let index = volumes["index"].as_u64().expect("a number");
    assert_eq!(first["stencil"], format!("{index:03}-volumes.draw000.stencil.npy"));
    assert_eq!(first["unchanged"], serde_json::json!(["color", "depth"]));
    assert_eq!(first["color"], volumes["color"], "named again");
    assert_eq!(draws[draws.len() - 1]["stencil"], volumes["stencil"], "named again");
    assert!(read_json(&plain.join("manifest.json"))["passes"][0].get("draws_captured").is_none());
}

#[test]
fn faces_of_maps_and_labels_have_files_until_the_lights_own_say_the_same() {
    let mut session = session();
    let parent = tempfile::tempdir().expect("a folder");
    let mut scene = scene();
    scene.lights.drain(..1);
    let capture = session.capture(&scene, &by_draw(Technique::ShadowMap)).expect("a capture");
    let folder = written(&capture, parent.path(), "out");
    let passes = read_json(&folder.join("manifest.json"))["passes"].clone();
    let of = |name: &str| {
        let found = passes.as_array().expect("passes").iter().find(|pass| pass[name].is_string());
        found.expect("a pass").clone()
    };
    let map = of("map");
    let draws = map["draws_captured"].as_array().expect("draws");
    assert!(draws.len() >= 2);
    assert!(draws[0]["map"].as_str().is_some_and(|file| file.ends_with(".draw000.map.npy")));
    assert!(draws[0].get("map_face").is_none(), "a face alone");
    let last = &draws[draws.len() - 1];
    assert_eq!((&last["map"], &last["map_face"]), (&map["map"], &map["map_face"]));
    let mask = of("labels");
    let draws = mask["draws_captured"].as_array().expect("draws");
    assert!(draws[0]["labels"].as_str().is_some_and(|file| file.ends_with(".draw000.labels.npy")));
    assert_eq!(draws[draws.len() - 1]["labels"], mask["labels"]);
}

#[test]
fn broken_states_of_draws_are_refused_with_a_reason() {
    let mut session = session();
    let parent = tempfile::tempdir().expect("a folder");
    let capture = session.capture(&scene(), &by_draw(Technique::ShadowMap)).expect("a capture");
    let folder = written(&capture, parent.path(), "out");
    let whole = read_json(&folder.join("manifest.json"));
    let map = whole["passes"].as_array().expect("passes").iter().position(|pass| pass["map"].is_string());
    let map = map.expect("a map pass");
    let frame = whole["passes"].as_array().expect("passes").len() - 1;
    let refused = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut changed = whole.clone();
        change(&mut changed["passes"]);
        assert_ne!(changed, whole);
        fs::write(folder.join("manifest.json"), changed.to_string()).expect("written");
        match read(&folder).expect_err("broken") {
            CaptureError::Read { reason, .. } => reason,
            other => panic!("{other}"),
        }
    };
    let removed = |pass: usize, key: &'static str| {
        move |passes: &mut serde_json::Value| {
            let draw = passes[pass]["draws_captured"][0].as_object_mut().expect("a draw");
            draw.remove(key);
        }
    };
    assert!(refused(&removed(frame, "depth")).contains("lacks its depth"));
    assert!(refused(&removed(map, "map")).contains("lacks its map"));
    let put = |pass: usize, key: &'static str, value: serde_json::Value| {
        move |passes: &mut serde_json::Value| passes[pass]["draws_captured"][0][key] = value.clone()
    };
    assert!(refused(&put(map, "map_face", 99.into())).contains("not its pass's"));
    assert!(refused(&put(frame, "color", "../secret.png".into())).contains("outside its folder"));
    assert!(refused(&put(frame, "labels", "light0.shadow.npy".into())).contains("other pictures than its pass"));
    let fewer = |passes: &mut serde_json::Value| {
        passes[map]["draws_captured"].as_array_mut().expect("draws").pop();
    };
    assert!(refused(&fewer).contains("more or fewer draws"));
}

/// Draws that were filled in one pass only are written for that pass only.
#[test]
fn a_folder_may_hold_the_draws_of_some_passes() {
    let mut session: Session = session();
    let parent = tempfile::tempdir().expect("a folder");
    let (scene, request) = (scene(), request(Technique::ZFail, SIZE));
    let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
    let capture = capture.with_draws(&session.step_draws(&plan, &capture, 1).expect("draws"));
    let folder = written(&capture, parent.path(), "out");
    let mut back = read(&folder).expect("read");
    back.timing.write_ms = None;
    assert!(back == capture && back.holds_draws(1) && !back.holds_draws(0));
}
