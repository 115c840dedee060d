//! The worker by its orders and news.

use super::*;
use crate::app::orders::{Measure, StressRun};
use crate::progress::Progress;
use crate::stress::Case;
use crate::technique::Technique;

const PATIENCE: Duration = Duration::from_secs(60);

/// A worker over a small built-in scene, its first frame, and the news after it.
fn started() -> (Worker, u64, Receiver<News>) {
    let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
    let start = Start {
        source: ViewSource::Scene(Box::new(scene)),
        name: OpenSpec::new("table"),
        capture: CaptureRequest::new(Choice::new(Technique::Planar), [64, 36]),
        time: 0.0,
        adapter: None,
    };
    let (tell, news) = channel();
    let worker = Worker::start(start, move |news| drop(tell.send(news))).expect("a thread");
    let frame = wait(&news, |news| if let News::Captured { frame, .. } = news { Some(frame) } else { None });
    (worker, frame, news)
}

fn wait<T>(news: &Receiver<News>, mut is_it: impl FnMut(News) -> Option<T>) -> T {
    loop {
        if let Some(found) = is_it(news.recv_timeout(PATIENCE).expect("news")) {
            return found;
        }
    }
}

fn judge(worker: &Worker, frame: u64, progress: &Progress) {
    assert!(worker.order(Order::Judge { frame, progress: progress.clone() }));
}

fn case(name: &str) -> &'static Case {
    Case::named(name).expect("a case")
}

fn stress(worker: &Worker, job: u64, cases: &[&str]) -> Progress {
    let progress = Progress::default();
    let cases: Vec<&Case> = cases.iter().map(|name| case(name)).collect();
    assert!(worker.order(Order::Stress(Box::new(StressRun::new(job, &cases, progress.clone())))));
    progress
}

fn wait_until_busy(news: &Receiver<News>, with: &str) {
    wait(news, |news| matches!(news, News::Busy(what) if what == with).then_some(()));
}

/// Technique, settings and size of the next frame.
fn captured(news: &Receiver<News>) -> (String, std::collections::BTreeMap<String, String>, [u32; 2]) {
    let capture = wait(news, |news| if let News::Captured { capture, .. } = news { Some(capture) } else { None });
    (capture.technique.clone(), capture.settings.clone(), capture.size)
}

#[test]
fn stress_cases_run_one_by_one_and_a_cancelled_run_is_dropped() {
    let (worker, frame, news) = started();
    let progress = stress(&worker, 5, &["one-pixel", "no-receiver"]);
    let mut heard = Vec::new();
    let error = wait(&news, |news| {
        match news {
            News::Stressed { job: 5, rows } => heard.push((rows[0].case, rows.len())),
            News::StressEnded { job: 5, error } => return Some(error),
            _ => {}
        }
        None
    });
    let rows = ["one-pixel", "no-receiver"].map(|name| (name, case(name).entrants().len() * case(name).values.len()));
    assert_eq!((&heard[..], error), (&rows[..], None));
    let all = rows.iter().map(|(_, count)| count).sum();
    assert_eq!(progress.steps(), (all, all));
    wait(&news, |news| matches!(news, News::Idle).then_some(()));
    stress(&worker, 6, &["tall-picture"]).cancel();
    judge(&worker, frame, &Progress::default());
    wait(&news, |news| {
        assert!(!matches!(news, News::Stressed { .. } | News::StressEnded { .. }), "it was cancelled");
        matches!(news, News::Judged { .. }).then_some(())
    });
}

#[test]
fn within_a_case_of_a_thousand_rows_pictures_and_pixels_are_answered_and_it_goes_on() {
    let (worker, frame, news) = started();
    let progress = stress(&worker, 1, &["random"]);
    wait_until_busy(&news, "stress: random");
    // As a dragged pick asks: many at once, of which the last is to be answered.
    (0..60).for_each(|x| assert!(worker.order(Order::History { frame, at: [x, 5] })));
    wait(&news, |news| {
        assert!(!matches!(news, News::Stressed { .. }), "the answer comes first");
        matches!(news, News::History { at: [59, 5], history: Ok(_), .. }).then_some(())
    });
    assert!(worker.order(Order::Open("tori".to_owned())));
    wait(&news, |news| {
        assert!(!matches!(news, News::Stressed { .. }), "the picture comes first");
        matches!(news, News::Captured { .. }).then_some(())
    });
    let (done, all) = progress.steps();
    assert!(done < all, "{done} of {all}");
    wait_until_busy(&news, "stress: random");
    progress.cancel();
    wait(&news, |news| matches!(news, News::Idle).then_some(()));
}

#[test]
fn a_pixel_is_answered_while_a_report_is_measured() {
    let (worker, frame, news) = started();
    let progress = Progress::default();
    let choices = [Technique::ZFail, Technique::Planar].map(Choice::new).to_vec();
    let what = Measure { generation: 1, job: 1, choices, runs: 1_000, progress: progress.clone() };
    assert!(worker.order(Order::Measure(what)));
    wait_until_busy(&news, "measuring every technique");
    for y in 0..20 {
        assert!(worker.order(Order::Draws { frame, step: 1 }));
        (0..20).for_each(|x| assert!(worker.order(Order::History { frame, at: [x, y] })));
    }
    let mut has_draws = false;
    wait(&news, |news| {
        assert!(!matches!(news, News::Measured { .. }), "the answer comes first");
        has_draws |= matches!(&news, News::Draws { capture, .. } if capture.holds_draws(1));
        matches!(news, News::History { at: [19, 19], history: Ok(_), .. }).then_some(())
    });
    assert!(has_draws);
    progress.cancel();
    judge(&worker, frame, &Progress::default());
    let judged = wait(&news, |news| if let News::Judged { capture, .. } = news { Some(capture) } else { None });
    assert!(judged.holds_draws(1), "what was filled in stays");
}

#[test]
fn a_report_of_a_scene_that_is_open_no_more_says_so() {
    let (worker, _frame, news) = started();
    let choices = vec![Choice::new(Technique::Planar)];
    let what = Measure { generation: 0, job: 3, choices, runs: 1, progress: Progress::default() };
    assert!(worker.order(Order::Measure(what)));
    let result = wait(&news, |news| if let News::Measured { job: 3, result, .. } = news { Some(result) } else { None });
    assert!(result.expect_err("another scene").contains("measure again"));
}

#[test]
fn a_stress_case_is_opened_as_a_scene_with_the_technique_that_breaks() {
    let (worker, _frame, news) = started();
    let entrant = case("nested").entrants().into_iter().find(|entrant| !entrant.settings.is_empty());
    assert!(worker.order(Order::OpenCase { case: case("nested"), value: 2.0, entrant }));
    let scene = wait(&news, |news| if let News::Opened { scene, .. } = news { Some(scene) } else { None });
    assert_eq!(scene.name, "nested 2");
    let (technique, settings, size) = captured(&news);
    assert_eq!((technique.as_str(), size), ("z-fail", [64, 36]));
    assert_eq!(settings.get("counter").map(String::as_str), Some("float"));
    // What it brought along does not stay.
    assert!(worker.order(Order::OpenCase { case: case("nested"), value: 1.0, entrant: None }));
    assert_eq!(captured(&news).0, "planar");
}

#[test]
fn a_setting_that_a_case_drives_is_set_on_the_chosen_technique_or_on_one_that_has_it() {
    let (worker, _frame, news) = started();
    let open = |value| assert!(worker.order(Order::OpenCase { case: case("map-size"), value, entrant: None }));
    let size = |settings: std::collections::BTreeMap<String, String>| settings.get("size").cloned();
    for (value, text) in [(64.0, "64"), (256.0, "256")] {
        open(value);
        let (technique, settings, _) = captured(&news);
        assert_eq!((technique.as_str(), size(settings).as_deref()), ("shadow-map", Some(text)));
    }
    let request = wait_for_request(&worker, &news);
    let texture = RunRequest { choice: Choice::new(Technique::PlanarTexture), ..request.1 };
    assert!(worker.order(Order::Run { generation: request.0, request: Box::new(texture) }));
    assert_eq!(captured(&news).0, "planar-texture");
    open(128.0);
    let (technique, settings, _) = captured(&news);
    assert_eq!((technique.as_str(), size(settings).as_deref()), ("planar-texture", Some("128")));
}

/// Opens the built-in table: its generation and first run.
fn wait_for_request(worker: &Worker, news: &Receiver<News>) -> (u64, RunRequest) {
    assert!(worker.order(Order::Open("table".to_owned())));
    let opened = wait(news, |news| match news {
        News::Opened { generation, request, .. } => Some((generation, *request)),
        _ => None,
    });
    captured(news);
    opened
}

#[test]
fn the_size_of_a_case_goes_with_it_but_what_is_changed_meanwhile_stays() {
    let (worker, _frame, news) = started();
    let z_fail = case("wide-picture").entrants().into_iter().find(|entrant| entrant.technique == Technique::ZFail);
    let open = || {
        assert!(worker.order(Order::OpenCase { case: case("wide-picture"), value: 0.0, entrant: z_fail }));
        let opened = wait(&news, |news| match news {
            News::Opened { generation, request, .. } => Some((generation, *request)),
            _ => None,
        });
        assert_eq!(captured(&news).2, [16_384, 1]);
        opened
    };
    let run = |generation, request: &RunRequest| {
        assert!(worker.order(Order::Run { generation, request: Box::new(request.clone()) }));
        captured(&news)
    };
    let (generation, mut request) = open();
    request.camera.eye.x += 0.1;
    assert_eq!(run(generation, &request).2, [16_384, 1], "only the eye moved");
    let (_, table) = wait_for_request(&worker, &news);
    assert_eq!((table.choice.technique(), table.size), (Technique::Planar, [64, 36]));
    let (generation, request) = open();
    run(generation, &RunRequest { size: [80, 60], ..request });
    let (_, table) = wait_for_request(&worker, &news);
    assert_eq!((table.choice.technique(), table.size), (Technique::Planar, [80, 60]));
}

#[test]
fn after_the_first_frame_the_meshes_are_told() {
    let (_worker, _frame, news) = started();
    let meshes = wait(&news, |news| if let News::Meshes { meshes, .. } = news { Some(meshes) } else { None });
    let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
    let names = |of: &[ObjectMesh]| of.iter().map(|mesh| mesh.object.clone()).collect::<Vec<_>>();
    assert_eq!(names(&meshes), scene.objects.iter().map(|object| object.name.clone()).collect::<Vec<_>>());
}

#[test]
fn the_last_frame_is_judged_and_keeps_its_truth_when_it_is_timed() {
    let (tell, news) = channel();
    let request = CaptureRequest::new(Choice::new(Technique::Planar), [64, 36]);
    let mut bench = Bench::new(None, &request, Box::new(move |news| drop(tell.send(news))));
    let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
    bench.begin(ViewSource::Scene(Box::new(scene)), OpenSpec::new("table"), 0.0);
    bench.judge(1, &Progress::default());
    bench.time();
    let heard: Vec<News> = news.try_iter().collect();
    let judged =
        heard.iter().find_map(|news| if let News::Judged { capture, .. } = news { Some(capture) } else { None });
    let judged = judged.expect("a truth");
    assert!(judged.lights.iter().all(|light| light.truth.is_some()));
    let Some(News::Timed { frame: 1, capture }) = heard.last() else { panic!("a time") };
    assert!(capture.timing.frame_ms.is_some() && capture.error() == judged.error());
}

#[test]
fn the_draws_of_a_pass_are_filled_in_and_stale_wishes_for_them_are_dropped() {
    let (worker, frame, news) = started();
    assert!(worker.order(Order::Draws { frame: frame + 1, step: 0 }));
    // The order before is obeyed or replaced first: of both only one is answered.
    assert!(worker.order(Order::Draws { frame, step: 1 }));
    let filled = wait(&news, |news| if let News::Draws { capture, .. } = news { Some(capture) } else { None });
    assert!(filled.holds_draws(1) && !filled.holds_draws(0));
    judge(&worker, frame, &Progress::default());
    let judged = wait(&news, |news| if let News::Judged { capture, .. } = news { Some(capture) } else { None });
    assert!(judged.holds_draws(1), "what was filled in stays");
}

#[test]
fn a_frame_that_is_shown_no_more_and_a_cancelled_truth_are_passed_over() {
    let (worker, frame, news) = started();
    let cancelled = Progress::default();
    cancelled.cancel();
    judge(&worker, frame + 1, &Progress::default());
    judge(&worker, frame, &cancelled);
    assert!(worker.order(Order::Open("no such scene".to_owned())));
    let is_judged = wait(&news, |news| match news {
        News::Judged { .. } => Some(true),
        News::Failed(_) => Some(false),
        _ => None,
    });
    assert!(!is_judged);
    judge(&worker, frame, &Progress::default());
    wait(&news, |news| if let News::Judged { .. } = news { Some(()) } else { None });
}

#[test]
fn a_pixel_of_the_last_frame_tells_its_history_and_of_another_frame_why_not() {
    let (worker, frame, news) = started();
    let ask = |frame, at| {
        assert!(worker.order(Order::History { frame, at }));
        wait(&news, |news| match news {
            News::History { frame, at, history } => Some((frame, at, history)),
            _ => None,
        })
    };
    let (of, at, history) = ask(frame, [32, 20]);
    let history = history.expect("a history");
    assert_eq!((of, at, history.pixel), (frame, [32, 20], [32, 20]));
    assert!(history.agrees() && !history.events.is_empty());
    let (.., outside) = ask(frame, [64, 0]);
    assert!(outside.expect_err("no such pixel").contains("outside the picture"));
    assert!(ask(frame + 1, [0, 0]).2.is_err());
}

#[test]
fn the_open_scene_is_measured_in_the_size_that_is_shown_without_what_a_window_has_no_room_for() {
    let (worker, _, news) = started();
    let measure = |generation, job| {
        let mut large = Choice::new(Technique::ShadowMap);
        large.set("size", "8192").expect("a size");
        let choices = vec![Choice::new(Technique::ZFail), large, Choice::new(Technique::Planar)];
        Order::Measure(Measure { generation, job, choices, runs: 1, progress: Progress::default() })
    };
    assert!(worker.order(measure(1, 7)));
    let (result, left_out) = wait(&news, |news| match news {
        News::Measured { job: 7, result, left_out } => Some((result, left_out)),
        _ => None,
    });
    let report = result.expect("a report");
    assert!(report.rows.iter().all(|row| row.size == [64, 36]));
    let rows: Vec<_> = report.rows.iter().map(|row| row.technique.as_str()).collect();
    let left_out: Vec<_> = left_out.iter().map(|choice| choice.technique().name()).collect();
    // A map of 268 MB, where the GPU's memory is the window's own.
    match report.adapter.kind.as_str() {
        "cpu" => assert_eq!((rows, left_out), (vec!["z-fail", "planar"], vec!["shadow-map"])),
        _ => assert_eq!((rows, left_out), (vec!["z-fail", "shadow-map", "planar"], vec![])),
    }
}

#[test]
fn a_frame_is_diagnosed_and_what_was_cancelled_is_not_told() {
    let (worker, frame, news) = started();
    let diagnose = |frame, job, progress: &Progress| {
        assert!(worker.order(Order::Diagnose { frame, job, progress: progress.clone() }));
    };
    let result =
        || wait(&news, |news| if let News::Diagnosed { job, result } = news { Some((job, result)) } else { None });
    let cancelled = Progress::default();
    cancelled.cancel();
    diagnose(frame, 1, &cancelled);
    wait_for_history(&worker, frame, &news);
    diagnose(frame, 2, &Progress::default());
    let (job, found) = result();
    let found = found.expect("a diagnosis");
    assert_eq!((job, found.technique, found.size), (2, Technique::Planar, [64, 36]));
    assert!(found.is_bad() && found.regions.iter().all(|region| !region.causes.is_empty()), "{found:?}");
    diagnose(frame + 7, 3, &Progress::default());
    let (job, none) = result();
    assert_eq!(job, 3);
    assert!(none.expect_err("of no frame that is there").contains("diagnose again"));
}

/// An answer that comes after all that was ordered before it.
fn wait_for_history(worker: &Worker, frame: u64, news: &Receiver<News>) {
    assert!(worker.order(Order::History { frame, at: [1, 1] }));
    wait(news, |news| match news {
        News::Diagnosed { .. } => panic!("what was cancelled is told"),
        News::History { .. } => Some(()),
        _ => None,
    });
}

#[test]
fn objects_that_are_switched_off_are_neither_drawn_nor_do_they_cast() {
    let (worker, _, news) = started();
    let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
    let off = (1..scene.objects.len()).collect();
    let request = RunRequest {
        choice: Choice::new(Technique::ZFail),
        size: [64, 36],
        camera: scene.camera,
        lights: scene.lights.clone(),
        time: 0.0,
        off,
    };
    assert!(worker.order(Order::Run { generation: 1, request: Box::new(request) }));
    let plan = wait(&news, |news| match news {
        News::Captured { plan, .. } if plan.technique == "z-fail" => Some(plan),
        _ => None,
    });
    let names: std::collections::BTreeSet<&str> =
        plan.passes.iter().flat_map(|pass| &pass.draws).filter_map(|draw| draw.caster.as_deref()).collect();
    assert!(names.iter().all(|name| *name == scene.objects[0].name), "{names:?}");
}

#[test]
fn walls_are_those_of_the_scene_as_it_would_be_run() {
    let (worker, frame, news) = started();
    let mut scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
    let walls = |generation: u64, off: std::ops::Range<usize>| {
        let request = RunRequest {
            choice: Choice::new(Technique::ZFail),
            size: [64, 36],
            camera: scene.camera,
            lights: scene.lights.clone(),
            time: 0.0,
            off: off.collect(),
        };
        assert!(worker.order(Order::Walls { generation, request: Box::new(request) }));
    };
    let told = || wait(&news, |news| if let News::Walls { walls, .. } = news { Some(walls) } else { None });
    // Of a scene that is open no more nothing is told.
    walls(0, 0..0);
    assert!(worker.order(Order::History { frame, at: [0, 0] }));
    wait(&news, |news| {
        assert!(!matches!(news, News::Walls { .. }), "they come before what was asked after them");
        matches!(news, News::History { .. }).then_some(())
    });
    walls(1, 0..0);
    assert_eq!(*told(), WallCache::default().walls(&scene));
    walls(1, 1..scene.objects.len());
    let one = told();
    scene.objects.truncate(1);
    assert_eq!(*one, WallCache::default().walls(&scene));
}

#[test]
fn a_scene_is_saved_as_it_is_run_and_what_is_there_is_asked_about() {
    let (worker, _, news) = started();
    let scene = crate::scene::open(&OpenSpec::new("table")).expect("a built-in scene");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml").display().to_string();
    let mut choice = Choice::new(Technique::ShadowMap);
    choice.set("size", "256").expect("a size");
    let request = RunRequest {
        choice: choice.clone(),
        size: [64, 36],
        camera: crate::scene::Camera { near: 0.25, ..scene.camera },
        lights: scene.lights.clone(),
        time: 0.0,
        off: std::collections::BTreeSet::from([1]),
    };
    let save = |replace| {
        let order = Order::SaveScene { generation: 1, request: Box::new(request.clone()), path: path.clone(), replace };
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
fn a_changed_file_is_loaded_again_with_the_camera_as_it_is() {
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
    let start = Start {
        source: ViewSource::Scene(Box::new(scene.clone())),
        name: spec,
        capture: CaptureRequest::new(Choice::new(Technique::ZFail), [64, 36]),
        time: 0.0,
        adapter: None,
    };
    let (tell, news) = channel();
    let worker = Worker::start(start, move |news| drop(tell.send(news))).expect("a thread");
    let files = wait(&news, |news| if let News::Opened { files, .. } = news { Some(files) } else { None });
    assert_eq!(files, std::slice::from_ref(&path));
    std::fs::write(&path, text(2.0)).expect("a file");
    let camera = crate::scene::Camera { eye: glam::DVec3::new(3.0, 2.0, 6.0), ..scene.camera };
    let request = RunRequest {
        choice: Choice::new(Technique::ZPass),
        size: [64, 36],
        camera,
        lights: scene.lights.clone(),
        time: 0.0,
        off: std::collections::BTreeSet::new(),
    };
    assert!(worker.order(Order::Reload { request: Box::new(request) }));
    let (scene, request) = wait(&news, |news| match news {
        News::Opened { scene, request, .. } => Some((scene, request)),
        _ => None,
    });
    let tall = scene.objects[0].mesh.positions().iter().map(|at| at.y).fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(tall, 1.0, "two high about its middle");
    assert_eq!(request.camera.eye.x, 3.0);
    assert_eq!(request.choice.technique(), Technique::ZPass);
}
