//! Stress cases: run, and opened as scenes.

use super::*;

#[test]
fn stress_cases_run_one_by_one_and_a_cancelled_run_is_dropped() {
    let (worker, frame, news) = started();
    let progress = ask(&worker, frame, 5, StressOf { cases: vec!["one-pixel", "no-receiver"] });
    let mut heard = Vec::new();
    wait(&news, |news| match news {
        News::AnsweredPart { ticket: 5, answer: Answer::StressOf(part) } => {
            heard.push((part.rows[0].case, part.rows.len()));
            None
        }
        News::AnswerEnded { ticket: 5 } => Some(()),
        _ => None,
    });
    let rows = ["one-pixel", "no-receiver"].map(|name| (name, case(name).entrants().len() * case(name).values.len()));
    assert_eq!(heard, rows);
    let all = rows.iter().map(|(_, count)| count).sum();
    assert_eq!(progress.steps(), (all, all));
    wait(&news, |news| matches!(news, News::Idle).then_some(()));
    ask(&worker, frame, 6, StressOf { cases: vec!["tall-picture"] }).cancel();
    ask(&worker, frame, 7, TruthOf {});
    wait(&news, |news| {
        assert!(!matches!(news, News::AnsweredPart { .. } | News::AnswerEnded { .. }), "it was cancelled");
        matches!(news, News::Answered { ticket: 7, .. }).then_some(())
    });
}

#[test]
fn within_a_case_of_a_thousand_rows_pictures_and_pixels_are_answered_and_it_goes_on() {
    let (worker, frame, news) = started();
    let progress = ask(&worker, frame, 1, StressOf { cases: vec!["random"] });
    wait_until_busy(&news, "stress: random");
    // As a dragged pick asks: many at once, of which the last is to be answered.
    (0..60).for_each(|x| drop(ask(&worker, frame, 100 + u64::from(x), history(x, 5))));
    wait(&news, |news| {
        assert!(!matches!(news, News::AnsweredPart { .. }), "the answer comes first");
        matches!(news, News::Answered { ticket: 159, result: Ok(_) }).then_some(())
    });
    assert!(worker.order(Order::Open("tori".to_owned())));
    wait(&news, |news| {
        assert!(!matches!(news, News::AnsweredPart { .. }), "the picture comes first");
        matches!(news, News::Captured { .. }).then_some(())
    });
    let (done, all) = progress.steps();
    assert!(done < all, "{done} of {all}");
    wait_until_busy(&news, "stress: random");
    progress.cancel();
    wait(&news, |news| matches!(news, News::Idle).then_some(()));
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
    // Its overrides do not stay.
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
    assert!(worker.order(Order::Run { scene: request.0, request: Arc::new(texture), is_moving: false }));
    assert_eq!(captured(&news).0, "planar-texture");
    open(128.0);
    let (technique, settings, _) = captured(&news);
    assert_eq!((technique.as_str(), size(settings).as_deref()), ("planar-texture", Some("128")));
}

#[test]
fn the_size_of_a_case_goes_with_it_but_what_is_changed_meanwhile_stays() {
    let (worker, _frame, news) = started();
    let z_fail = case("one-pixel").entrants().into_iter().find(|entrant| entrant.technique == Technique::ZFail);
    let open = || {
        assert!(worker.order(Order::OpenCase { case: case("one-pixel"), value: 0.0, entrant: z_fail }));
        let opened = wait(&news, |news| match news {
            News::Opened { scene_number, request, .. } => Some((scene_number, *request)),
            _ => None,
        });
        assert_eq!(captured(&news).2, [1, 1]);
        opened
    };
    let run = |generation, request: &RunRequest| {
        assert!(worker.order(Order::Run { scene: generation, request: Arc::new(request.clone()), is_moving: false }));
        captured(&news)
    };
    let (generation, mut request) = open();
    request.camera.eye.x += 0.1;
    assert_eq!(run(generation, &request).2, [1, 1], "only the eye moved");
    let (_, table) = wait_for_request(&worker, &news);
    assert_eq!((table.choice.technique(), table.size), (Technique::Planar, [64, 36]));
    let (generation, request) = open();
    run(generation, &RunRequest { size: [80, 60], ..request });
    let (_, table) = wait_for_request(&worker, &news);
    assert_eq!((table.choice.technique(), table.size), (Technique::Planar, [80, 60]));
}
