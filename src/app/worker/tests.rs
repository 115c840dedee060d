//! The worker by its orders and news.

mod cases;
mod films;

use super::*;
use crate::ask::{
    AnatomyOf, Answer, DiagnosisOf, DrawsOf, FilmOf, FilmSubject, HistoryOf, MeshesOf, ObjectChanges, Question,
    ReportOf, StressOf, TimingOf, TruthOf, WallsOf,
};
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::report::MeasuredReport;
use crate::scene::{Light, WallCache};
use crate::stress::StressCase;
use crate::technique::Technique;
use std::collections::BTreeSet;
use std::sync::mpsc::{Receiver, channel};

const PATIENCE: Duration = Duration::from_secs(60);

/// A worker over a small built-in scene, its first frame, and the news after it.
fn started() -> (Worker, u64, Receiver<News>) {
    let (worker, news) = over(table(), OpenSpec::new("table"), Technique::Planar);
    let frame = first_frame(&news);
    (worker, frame, news)
}

fn first_frame(news: &Receiver<News>) -> u64 {
    wait(news, |news| if let News::Captured { frame, .. } = news { Some(frame) } else { None })
}

fn table() -> Scene {
    crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene")
}

/// A worker over a scene as it was opened, and its news.
fn over(scene: Scene, name: OpenSpec, technique: Technique) -> (Worker, Receiver<News>) {
    over_from(scene, name, technique, Duration::MAX)
}

/// The same, where a frame is slow from so long a time on.
fn over_from(scene: Scene, name: OpenSpec, technique: Technique, slow_from: Duration) -> (Worker, Receiver<News>) {
    let start = WorkerStart {
        source: ViewSource::Scene(Box::new(scene)),
        name,
        capture: CaptureRequest::new(Choice::new(technique), [64, 36]),
        time: 0.0,
        adapter: None,
        slow_from,
    };
    let (notify, news) = channel();
    let worker = Worker::start(start, move |news| drop(notify.send(news))).expect("a thread");
    (worker, news)
}

/// The casters of the next frame by z-fail, and its plan.
fn casters_of_z_fail(news: &Receiver<News>) -> (BTreeSet<String>, Arc<FramePlan>) {
    let plan = wait(news, |news| match news {
        News::Captured { run, .. } if run.plan.technique == "z-fail" => Some(run.plan),
        _ => None,
    });
    let casters = plan.passes.iter().flat_map(|pass| &pass.draws).filter_map(|draw| draw.caster.clone()).collect();
    (casters, plan)
}

fn wait<T>(news: &Receiver<News>, mut is_it: impl FnMut(News) -> Option<T>) -> T {
    loop {
        let news = news.recv_timeout(PATIENCE).expect("news");
        if let News::Failed(reason) | News::NotOpened { reason, .. } = &news {
            // What else fails is a test's own matter; without an adapter, each would wait until its patience ends.
            assert!(!reason.contains("no usable GPU adapter"), "{reason}");
        }
        if let Some(found) = is_it(news) {
            return found;
        }
    }
}

/// Asks a question of the scene that was opened first.
fn ask(worker: &Worker, frame: u64, ticket: u64, ask: impl Into<Ask>) -> Progress {
    ask_of(worker, [1, frame], ticket, ask)
}

fn ask_of(worker: &Worker, [scene, frame]: [u64; 2], ticket: u64, ask: impl Into<Ask>) -> Progress {
    let progress = Progress::default();
    let asked = PendingQuestion { ticket, ask: ask.into(), progress: progress.clone() };
    assert!(worker.order(Order::Answer { scene, frame, asked }));
    progress
}

/// The answer to the question of this ticket.
fn answer<Q: Question>(news: &Receiver<News>, of: u64) -> Result<Arc<Q::Answer>, String> {
    wait(news, |news| match news {
        News::Answered { ticket, result } if ticket == of => {
            Some(result.map(|answer| Q::answer(&answer).expect("of its kind").clone()))
        }
        _ => None,
    })
}

fn history(x: u32, y: u32) -> HistoryOf {
    HistoryOf { at: [x, y] }
}

fn case(name: &str) -> &'static StressCase {
    StressCase::named(name).expect("a case")
}

fn wait_until_busy(news: &Receiver<News>, with: &str) {
    wait(news, |news| matches!(news, News::Busy(what) if what == with).then_some(()));
}

/// Technique, settings and size of the next frame.
fn captured(news: &Receiver<News>) -> (String, std::collections::BTreeMap<String, String>, [u32; 2]) {
    let capture = wait(news, |news| if let News::Captured { run, .. } = news { Some(run.capture) } else { None });
    (capture.technique.clone(), capture.settings.clone(), capture.size)
}

#[test]
fn a_pixel_is_answered_while_a_report_is_measured() {
    let (worker, frame, news) = started();
    let choices = [Technique::ZFail, Technique::Planar].map(Choice::new).to_vec();
    let progress = ask(&worker, frame, 1, ReportOf { choices, runs: 1_000 });
    wait_until_busy(&news, "measuring every technique");
    for y in 0..20 {
        ask(&worker, frame, 2, DrawsOf { step: 1 });
        (0..20).for_each(|x| drop(ask(&worker, frame, 10 + u64::from(x + 20 * y), history(x, y))));
    }
    let mut has_draws = false;
    wait(&news, |news| {
        assert!(!matches!(news, News::Answered { ticket: 1, .. }), "the answer comes first");
        has_draws |=
            matches!(&news, News::Answered { ticket: 2, result: Ok(Answer::DrawsOf(draws)) } if draws.step == 1);
        matches!(news, News::Answered { ticket: 409, result: Ok(_) }).then_some(())
    });
    assert!(has_draws);
    progress.cancel();
    ask(&worker, frame, 3, TruthOf {});
    assert!(answer::<TruthOf>(&news, 3).is_ok());
}

#[test]
fn rows_of_a_report_come_as_they_are_measured() {
    let (worker, frame, news) = started();
    let choices = [Technique::ZFail, Technique::Planar, Technique::ZPass].map(Choice::new).to_vec();
    ask(&worker, frame, 4, ReportOf { choices, runs: 3 });
    let first = wait(&news, |news| match news {
        News::AnsweredPart { ticket: 4, answer: Answer::ReportOf(so_far) } => Some(so_far),
        News::Answered { ticket: 4, .. } => panic!("all rows come at once"),
        _ => None,
    });
    let [row] = &first.report.rows[..] else { panic!("{} rows after the first", first.report.rows.len()) };
    assert!(!first.is_whole && row.technique == "z-fail" && row.frame_ms.runs == 1 && row.frame_ms.median > 0.0);
    let all = answer::<ReportOf>(&news, 4).expect("a report");
    let runs: Vec<_> = all.report.rows.iter().map(|row| row.frame_ms.runs).collect();
    assert!(all.is_whole);
    assert_eq!(runs, [3; 3], "what stood in for them is not among them");
}

#[test]
fn a_report_of_a_scene_that_is_open_no_more_says_so() {
    let (worker, frame, news) = started();
    let question = ReportOf { choices: vec![Choice::new(Technique::Planar)], runs: 1 };
    ask_of(&worker, [0, frame], 3, question);
    assert!(answer::<ReportOf>(&news, 3).expect_err("another scene").contains("measure again"));
}

/// Opens the built-in table: its generation and first run.
fn wait_for_request(worker: &Worker, news: &Receiver<News>) -> (u64, RunRequest) {
    assert!(worker.order(Order::Open("table".to_owned())));
    let opened = wait(news, |news| match news {
        News::Opened { scene_number, request, .. } => Some((scene_number, *request)),
        _ => None,
    });
    captured(news);
    opened
}

#[test]
fn what_was_set_for_one_scene_is_not_set_for_the_next() {
    let (worker, _, news) = started();
    let (scene, mut request) = wait_for_request(&worker, &news);
    request.choice = Choice::new(Technique::ZFail);
    request.choice.set("casters", "light-facing").expect("a setting");
    assert!(worker.order(Order::Run { scene, request: Arc::new(request), is_moving: false }));
    assert_eq!(captured(&news).1["casters"], "light-facing");
    assert!(worker.order(Order::Open("tori".to_owned())));
    let (technique, settings, _) = captured(&news);
    assert_eq!((technique.as_str(), settings["casters"].as_str()), ("z-fail", "by-topology"), "the technique stays");
}

#[test]
fn meshes_are_reported_object_by_object() {
    let (worker, frame, news) = started();
    ask(&worker, frame, 1, MeshesOf { added: Vec::new() });
    let meshes = answer::<MeshesOf>(&news, 1).expect("meshes");
    let scene = table();
    let names = scene.objects.iter().map(|object| object.name.clone());
    assert_eq!(meshes.iter().map(|mesh| mesh.object.clone()).collect::<Vec<_>>(), names.collect::<Vec<_>>());
}

#[test]
fn the_last_frame_is_judged_and_timed_when_nothing_else_is_asked() {
    let (worker, frame, news) = started();
    ask(&worker, frame, 1, TimingOf {});
    ask(&worker, frame, 2, TruthOf {});
    let mut truth = None;
    let timing = wait(&news, |news| match news {
        News::Answered { ticket: 2, result: Ok(Answer::TruthOf(found)) } => {
            truth = Some(found);
            None
        }
        News::Answered { ticket: 1, result } => Some(result),
        _ => None,
    });
    assert!(truth.expect("the truth comes first").lights.iter().all(Option::is_some));
    match timing {
        Ok(answer) => assert!(matches!(answer, Answer::TimingOf(timing) if timing.frame_ms.is_some())),
        // On a machine that is busy with other work.
        Err(reason) => assert!(reason.contains("takes so long"), "{reason}"),
    }
}

#[test]
fn the_draws_of_a_pass_are_reported_and_stale_wishes_for_them_are_dropped() {
    let (worker, frame, news) = started();
    ask(&worker, frame + 1, 1, DrawsOf { step: 0 });
    // The earlier order is carried out or replaced first: of both only one is answered.
    ask(&worker, frame, 2, DrawsOf { step: 1 });
    let draws = wait(&news, |news| match news {
        News::Answered { ticket: 1, .. } => panic!("of no frame that is there"),
        News::Answered { ticket: 2, result: Ok(Answer::DrawsOf(draws)) } => Some(draws),
        _ => None,
    });
    assert!(draws.step == 1 && !draws.states.is_empty() && draws.states.iter().all(Option::is_some));
    ask(&worker, frame, 3, DrawsOf { step: 99 });
    assert!(answer::<DrawsOf>(&news, 3).expect_err("no such step").contains("choose one"));
}

#[test]
fn a_frame_that_is_shown_no_more_and_a_cancelled_truth_are_passed_over() {
    let (worker, frame, news) = started();
    ask(&worker, frame + 1, 1, TruthOf {});
    ask(&worker, frame, 2, TruthOf {}).cancel();
    assert!(worker.order(Order::Open("no such scene".to_owned())));
    let is_answered = wait(&news, |news| match news {
        News::Answered { .. } => Some(true),
        News::Failed(_) | News::NotOpened { .. } => Some(false),
        _ => None,
    });
    assert!(!is_answered);
    ask(&worker, frame, 3, TruthOf {});
    assert!(answer::<TruthOf>(&news, 3).is_ok());
}

#[test]
fn a_pixel_of_the_last_frame_reports_its_history_and_one_outside_why_not() {
    let (worker, frame, news) = started();
    ask(&worker, frame, 1, history(32, 20));
    let found = answer::<HistoryOf>(&news, 1).expect("a history");
    assert_eq!(found.pixel, [32, 20]);
    assert!(found.agrees() && !found.events.is_empty());
    ask(&worker, frame, 2, history(64, 0));
    assert!(answer::<HistoryOf>(&news, 2).expect_err("no such pixel").contains("outside the picture"));
}

#[test]
fn the_open_scene_is_measured_in_the_size_that_is_shown_without_what_a_window_has_no_room_for() {
    let (worker, frame, news) = started();
    let mut large = Choice::new(Technique::ShadowMap);
    large.set("size", "8192").expect("a size");
    let choices = vec![Choice::new(Technique::ZFail), large, Choice::new(Technique::Planar)];
    ask(&worker, frame, 7, ReportOf { choices, runs: 1 });
    let MeasuredReport { report, left_out, is_whole: true } = &*answer::<ReportOf>(&news, 7).expect("a report") else {
        panic!("a part")
    };
    assert!(report.rows.iter().all(|row| row.size == [64, 36]));
    let rows: Vec<_> = report.rows.iter().map(|row| row.technique.as_str()).collect();
    // A map of 268 MB, where the GPU's memory is the window's own.
    match report.adapter.kind.as_str() {
        "cpu" => assert_eq!((rows, &left_out[..]), (vec!["z-fail", "planar"], &["shadow-map 8192".to_owned()][..])),
        _ => assert_eq!((rows, &left_out[..]), (vec!["z-fail", "shadow-map", "planar"], &[][..])),
    }
}

#[test]
fn a_frame_is_diagnosed_and_what_was_cancelled_is_not_reported() {
    // With the eye in a shadow, z-pass is wrong on every adapter.
    let inside = OpenSpec::new("inside");
    let scene = crate::scene::open(&inside).expect("a built-in scene");
    let request = Box::new(RunRequest::of(&scene, Choice::new(Technique::ZPass), [64, 36]));
    let diagnosis = || DiagnosisOf { request: request.clone() };
    let (worker, news) = over(scene, inside, Technique::ZPass);
    let frame = first_frame(&news);
    ask(&worker, frame, 1, diagnosis()).cancel();
    ask(&worker, frame, 2, history(1, 1));
    wait(&news, |news| match news {
        News::Answered { ticket: 1, .. } => panic!("what was cancelled is told"),
        News::Answered { ticket: 2, .. } => Some(()),
        _ => None,
    });
    ask(&worker, frame, 3, diagnosis());
    let found = answer::<DiagnosisOf>(&news, 3).expect("a diagnosis");
    assert_eq!((found.technique, found.size), (Technique::ZPass, [64, 36]));
    assert!(found.is_bad() && found.regions.iter().all(|region| !region.causes.is_empty()), "{found:?}");
    ask(&worker, frame + 7, 4, diagnosis());
    assert!(answer::<DiagnosisOf>(&news, 4).expect_err("of no frame that is there").contains("diagnose again"));
}

#[test]
fn objects_that_are_switched_off_are_neither_drawn_nor_do_they_cast() {
    let (worker, _, news) = started();
    let scene = table();
    let mut request = RunRequest::of(&scene, Choice::new(Technique::ZFail), [64, 36]);
    request.off = (1..scene.objects.len()).collect();
    assert!(worker.order(Order::Run { scene: 1, request: Arc::new(request), is_moving: false }));
    let (names, _) = casters_of_z_fail(&news);
    assert!(names.iter().all(|name| *name == scene.objects[0].name), "{names:?}");
}

#[test]
fn walls_are_those_of_the_scene_as_it_would_be_run() {
    let (worker, frame, news) = started();
    let mut scene = table();
    let walls =
        |off: std::ops::Range<usize>| WallsOf { off: off.collect(), objects: ObjectChanges::default(), time: 0.0 };
    // Nothing is reported about a scene that is no longer open.
    ask_of(&worker, [0, frame], 1, walls(0..0));
    ask(&worker, frame, 2, history(0, 0));
    wait(&news, |news| {
        assert!(!matches!(news, News::Answered { ticket: 1, .. }), "they come before what was asked after them");
        matches!(news, News::Answered { ticket: 2, .. }).then_some(())
    });
    ask(&worker, frame, 3, walls(0..0));
    assert_eq!(*answer::<WallsOf>(&news, 3).expect("walls"), WallCache::default().walls(&scene));
    ask(&worker, frame, 4, walls(1..scene.objects.len()));
    let one = answer::<WallsOf>(&news, 4).expect("walls");
    scene.objects.truncate(1);
    assert_eq!(*one, WallCache::default().walls(&scene));
}

#[test]
fn a_scene_is_saved_as_it_is_run_and_what_is_there_is_asked_about() {
    let (worker, _, news) = started();
    let scene = table();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml").display().to_string();
    let mut choice = Choice::new(Technique::ShadowMap);
    choice.set("size", "256").expect("a size");
    let mut request = RunRequest::of(&scene, choice.clone(), [64, 36]);
    request.camera.near = 0.25;
    request.off = BTreeSet::from([1]);
    let save = |replace| {
        let order = Order::SaveScene { scene: 1, request: Box::new(request.clone()), path: path.clone(), replace };
        assert!(worker.order(order));
        wait(&news, |news| if let News::Exported(exported) = news { Some(exported) } else { None })
    };
    assert!(matches!(save(false), Exported::Done(_)));
    assert!(matches!(save(false), Exported::Taken(_)));
    let again = crate::scene::open(&OpenSpec::new(path.clone())).expect("a scene file");
    assert_eq!(again.camera.near, 0.25);
    assert_eq!(again.objects.len() + 1, scene.objects.len());
    assert_eq!(again.technique.map(|wish| Choice::parse(&wish).expect("a choice")), Some(choice));
}

#[test]
fn a_changed_file_is_loaded_again_with_camera_and_lights_as_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    let text = |height: f64| {
        format!(
            "[camera]\neye = [0, 2, 6]\ntarget = [0, 0, 0]\n[[lights]]\nkind = \"point\"\nposition = [1, 4, 2]\n\
             [[objects]]\nname = \"box\"\nmesh = {{ shape = \"box\", size = [1, {height}, 1] }}\n"
        )
    };
    std::fs::write(&path, text(1.0)).expect("a file");
    let spec = OpenSpec::new(path.display().to_string());
    let scene = crate::scene::open(&spec).expect("a scene file");
    let (worker, news) = over(scene.clone(), spec, Technique::ZFail);
    let files = wait(&news, |news| if let News::Opened { files, .. } = news { Some(files) } else { None });
    assert_eq!(files, std::slice::from_ref(&path));
    std::fs::write(&path, text(2.0)).expect("a file");
    let mut request = RunRequest::of(&scene, Choice::new(Technique::ZPass), [64, 36]);
    request.camera.eye = glam::DVec3::new(3.0, 2.0, 6.0);
    request.lights.iter_mut().for_each(|light| light.intensity = 0.25);
    assert!(worker.order(Order::Reload { request: Box::new(request) }));
    let (scene, request) = wait(&news, |news| match news {
        News::Opened { scene, request, .. } => Some((scene, request)),
        _ => None,
    });
    let tall = scene.objects[0].mesh.positions().iter().map(|at| at.y).fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(tall, 1.0, "two high about its middle");
    assert_eq!(request.camera.eye.x, 3.0);
    assert_eq!(request.lights[0].intensity, 0.25, "as it was set, the file has it as before");
    assert_eq!(request.choice.technique(), Technique::ZPass);
}

/// Changes made in the window are in the next frame, in the walls, and in the scene file, which opens as it was left.
#[test]
fn objects_and_lights_that_are_added_and_moved_are_drawn_and_saved() {
    let (worker, _, news) = started();
    let scene = table();
    let mut request = RunRequest::of(&scene, Choice::new(Technique::ZFail), [64, 36]);
    let moved = crate::scene::Pose { translate: glam::DVec3::new(0.0, 3.0, 0.0), ..scene.objects[1].pose };
    request.objects.moved.insert(1, moved);
    let mesh = crate::scene::shapes::cuboid([1.0; 3]).expect("a box");
    request.objects.added.push(crate::scene::Object::of("new box", mesh).at([0.0, 2.0, 0.0]));
    request.lights.push(Light::directional([0.4, 1.0, 0.3]));
    request.off.insert(2);
    let count = scene.objects.len();
    assert!(worker.order(Order::Run { scene: 1, request: Arc::new(request.clone()), is_moving: false }));
    let (casters, plan) = casters_of_z_fail(&news);
    assert!(casters.contains("new box") && !casters.contains(scene.objects[2].name.as_str()), "{casters:?}");
    assert_eq!(plan.lights.len(), scene.lights.len() + 1);
    let changed = request.applied_to(&scene);
    let (off, objects) = (request.off.clone(), request.objects.clone());
    ask(&worker, 2, 7, WallsOf { off, objects, time: 0.0 });
    assert_eq!(*answer::<WallsOf>(&news, 7).expect("walls"), WallCache::default().walls(&changed));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("made.toml").display().to_string();
    let save = Order::SaveScene { scene: 1, request: Box::new(request), path: path.clone(), replace: false };
    assert!(worker.order(save));
    wait(&news, |news| matches!(news, News::Exported(Exported::Done(_))).then_some(()));
    let saved = crate::scene::open(&OpenSpec::new(path)).expect("a scene");
    assert_eq!(saved.objects.len(), count, "one more, and one is off");
    assert_eq!(
        saved.objects.iter().map(|object| object.pose).collect::<Vec<_>>(),
        changed.objects.iter().map(|object| object.pose).collect::<Vec<_>>()
    );
    assert_eq!(saved.objects.last().map(|object| object.name.as_str()), Some("new box"));
    assert_eq!(saved.lights, changed.lights);
}

#[test]
fn a_very_slow_frame_is_previewed_in_fewer_pixels_than_a_slow_one() {
    let of = |took| pixels_of_preview(Duration::from_millis(took), Duration::from_millis(40));
    assert_eq!([of(41), of(999), of(1001)], [2, 2, 4]);
}

/// While a light is dragged, a slow frame is shown as previews, each as large as the whole; once it rests, the whole one
/// follows by itself, of the last place. Of a preview's pixels nothing is asked, of what lies in space it may be.
#[test]
fn a_slow_frame_is_previewed_while_it_changes_and_whole_once_it_rests() {
    let (worker, news) = over_from(table(), OpenSpec::new("table"), Technique::ZFail, Duration::ZERO);
    first_frame(&news);
    let mut request = RunRequest::of(&table(), Choice::new(Technique::ZFail), [65, 36]);
    for x in [0.1, 0.2] {
        request.lights[0].position.x += x;
        let order = Order::Run { scene: 1, request: Arc::new(request.clone()), is_moving: true };
        assert!(worker.order(order));
    }
    let light = request.lights[0].position;
    let (frame, preview) = wait(&news, |news| match news {
        News::Previewed { frame, plan, capture } if capture.lights[0].position == light => {
            assert_eq!((plan.size, capture.size), ([17, 9], [65, 36]), "any time is very slow");
            Some((frame, capture))
        }
        News::Captured { .. } => panic!("the whole frame comes only after the last preview"),
        _ => None,
    });
    let last = preview.frame_at(preview.steps.len() - 1).expect("a frame");
    assert_eq!(last.color.image.size(), [65, 36]);
    assert_eq!(preview.lights[0].shadow.as_ref().expect("labels").size(), [65, 36]);
    ask(&worker, frame, 7, AnatomyOf {});
    assert!(answer::<AnatomyOf>(&news, 7).is_ok());
    let whole = wait(&news, |news| if let News::Captured { run, .. } = news { Some(run) } else { None });
    assert_eq!((whole.plan.size, whole.capture.lights[0].position), ([65, 36], light));
    // What is done once, as by a button, is whole at once.
    request.lights[0].position.x += 0.1;
    assert!(worker.order(Order::Run { scene: 1, request: Arc::new(request), is_moving: false }));
    wait(&news, |news| match news {
        News::Previewed { .. } => panic!("nothing moves"),
        News::Captured { run, .. } => (run.capture.lights[0].position != light).then_some(()),
        _ => None,
    });
}
