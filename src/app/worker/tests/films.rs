//! Films that the worker writes while it answers.

use super::*;
use crate::files::brought::{InMemory, take_written};
use crate::film::{Film, FilmContent};

fn round(worker: &Worker, frame: u64, ticket: u64, path: &Path) -> Progress {
    let scene = table();
    let sides = vec![RunRequest::of(&scene, Choice::new(Technique::ZFail), [64, 36])];
    let subject = FilmSubject::LightRound { sides, light: 0 };
    ask(worker, frame, ticket, FilmOf { subject, path: path.display().to_string(), pick: None })
}

#[test]
fn a_film_lets_pictures_and_pixels_come_between_and_is_whole_in_the_end() {
    let (worker, frame, news) = started();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("round.png");
    let progress = round(&worker, frame, 1, &path);
    while progress.steps().0 == 0 {
        std::thread::yield_now();
    }
    ask(&worker, frame, 2, history(30, 20));
    wait(&news, |news| match news {
        News::Answered { ticket: 2, result: Ok(_) } => Some(()),
        News::Answered { ticket: 1, .. } => panic!("the pixel comes first"),
        _ => None,
    });
    // Another scene is opened meanwhile: the film shows the one that was open when it was asked for.
    assert!(worker.order(Order::Open("tori".to_owned())));
    wait(&news, |news| match news {
        News::Captured { .. } => Some(()),
        News::Answered { ticket: 1, .. } => panic!("the picture comes first"),
        _ => None,
    });
    assert!(!path.exists(), "it is not whole");
    let filmed = answer::<FilmOf>(&news, 1).expect("a film");
    assert_eq!((filmed.pictures, progress.steps()), (24, (24, 24)));
    let file = std::fs::read(&path).expect("a file");
    assert_eq!(file.len() as u64, filmed.bytes);
    let reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG");
    assert_eq!(reader.info().animation_control().map(|all| (all.num_frames, all.num_plays)), Some((24, 0)));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing is left beside it");
}

#[test]
fn a_film_that_is_cancelled_leaves_nothing() {
    let (worker, frame, news) = started();
    let folder = tempfile::tempdir().expect("a folder");
    let progress = round(&worker, frame, 1, &folder.path().join("round.png"));
    while progress.steps().0 == 0 {
        std::thread::yield_now();
    }
    progress.cancel();
    ask(&worker, frame, 2, TruthOf {});
    answer::<TruthOf>(&news, 2).expect("a truth");
    ask(&worker, frame, 3, StressOf { cases: vec!["one-pixel"] });
    // Stress cases come after films.
    wait(&news, |news| matches!(news, News::AnswerEnded { ticket: 3 }).then_some(()));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[test]
fn a_film_that_can_not_be_made_says_why_with_the_fix() {
    let (worker, frame, news) = started();
    round(&worker, frame, 1, Path::new("/no such folder/round.png"));
    let reason = answer::<FilmOf>(&news, 1).expect_err("no such folder");
    assert!(
        reason.contains("/no such folder/round.png: can't be written") && reason.contains("choose another"),
        "{reason}"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png").display().to_string();
    let scene = table();
    let mut request = RunRequest::of(&scene, Choice::new(Technique::ZFail), [64, 36]);
    request.lights[0] = Light::directional([0.0, 1.0, 0.0]);
    let subject = FilmSubject::LightRound { sides: vec![request], light: 0 };
    ask(&worker, frame, 2, FilmOf { subject: subject.clone(), path: path.clone(), pick: None });
    let reason = answer::<FilmOf>(&news, 2).expect_err("on the axis");
    assert!(reason.contains("move it to a side"), "{reason}");
    // The question is about a scene that is no longer open.
    ask_of(&worker, [0, frame], 3, FilmOf { subject, path, pick: None });
    let reason = answer::<FilmOf>(&news, 3).expect_err("another scene");
    assert!(reason.contains("export it again"), "{reason}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[test]
fn a_film_that_is_under_way_when_the_window_closes_leaves_nothing() {
    let (worker, frame, _news) = started();
    let folder = tempfile::tempdir().expect("a folder");
    let progress = round(&worker, frame, 1, &folder.path().join("round.png"));
    while progress.steps().0 == 0 {
        std::thread::yield_now();
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "it is being written");
    drop(worker);
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

/// As in a browser, where no thread is needed for it.
#[test]
fn a_film_in_memory_is_the_one_on_disk() {
    let request = CaptureRequest::new(Choice::new(Technique::ZFail), [64, 36]);
    let capture = crate::session::Session::new(None).expect("a GPU").capture(&table(), &request).expect("a frame");
    let shows = FilmContent::Steps(vec![Arc::new(capture)]);
    let filmed = |path: &Path| {
        let mut film = Film::begin(shows.clone(), path, 100).expect("begun");
        while pollster::block_on(film.shoot(async |_, _| Err(SessionError::NoFrame))).expect("a picture") {}
        film.finish().expect("finished")
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("steps.png");
    let length = filmed(&path);
    let _files = InMemory::with(&[]);
    assert_eq!(filmed(Path::new("steps.png")), length);
    let written = take_written();
    let [(name, bytes)] = &written[..] else { panic!("one file") };
    assert!(name == "steps.png" && *bytes == std::fs::read(&path).expect("a file"));
    drop(Film::begin(shows, Path::new("steps.png"), 100).expect("begun"));
    assert!(take_written().is_empty(), "it is not finished");
}
