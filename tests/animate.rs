//! `animate` from outside: its files are decoded again and compared with captures, pixel by pixel.

use crate::commands::{assert_fails, done, folder, run, text};
use crate::common::{names, opened, pixels, request, session};
use glam::DVec3;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;
use stencilscope::capture::{Capture, disk};
use stencilscope::film::{Film as FilmFile, FilmContent, FilmMotion, LightRound};
use stencilscope::glam;
use stencilscope::picture::{Picture, apng, colors};
use stencilscope::reading::both_sides::{self, SidePoint};
use stencilscope::reading::steps;
use stencilscope::session::Session;
use stencilscope::technique::Technique;

/// A file as a viewer shows it.
struct Film {
    pictures: Vec<Picture>,
    /// How long each is shown, milliseconds.
    delays: Vec<u32>,
    /// How often all are shown; 0: for ever.
    plays: u32,
}

impl Film {
    fn open(path: &Path) -> Film {
        let file = BufReader::new(File::open(path).expect("a file"));
        let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
        let control = *reader.info().animation_control().expect("an animation");
        let mut canvas = Picture::filled([reader.info().width, reader.info().height], [0; 3]);
        let (mut pictures, mut delays) = (Vec::new(), Vec::new());
        for _ in 0..control.num_frames {
            let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
            reader.next_frame(&mut bytes).expect("a picture");
            let place = *reader.info().frame_control().expect("its place");
            let pixels = bytes.as_chunks::<3>().0;
            let part = |[x, y]: [u32; 2]| pixels[(y * place.width + x) as usize];
            canvas.paste(&Picture::drawn([place.width, place.height], part), [place.x_offset, place.y_offset]);
            pictures.push(canvas.clone());
            delays.push(u32::from(place.delay_num) * 1000 / u32::from(place.delay_den));
        }
        Film { pictures, delays, plays: control.num_plays }
    }
}

/// The picture without the bar below it.
fn without_bar(picture: &Picture, size: [u32; 2]) -> Picture {
    Picture::drawn(size, |at| picture.at(at).expect("a pixel"))
}

/// What a capture has at a pixel of the picture after a step.
fn color_of(capture: &Capture, step: usize, at: [u32; 2]) -> colors::Rgb {
    let [red, green, blue, _] =
        capture.frame_at(step).and_then(|frame| frame.color.image.rgba_at(at)).expect("a colour");
    [red, green, blue]
}

/// The finished picture.
fn finished(capture: &Capture) -> Picture {
    Picture::drawn(capture.size, |at| color_of(capture, capture.steps.len() - 1, at))
}

#[test]
fn a_frame_is_shown_pass_by_pass_each_with_the_pixels_that_its_capture_has() {
    let folder = folder();
    let frame = ["-t", "z-fail", "--size", "96x64"];
    let said = done(folder.path(), &[&["animate", "tori", "--steps", "-o", "steps.png"], &frame[..]].concat());
    assert!(said.starts_with("steps.png: tori, z-fail, 96x84, 3 pictures of 1500 ms, "), "{said}");
    done(folder.path(), &[&["capture", "tori", "-o", "capture"], &frame[..]].concat());
    let capture = disk::read(&folder.path().join("capture")).expect("a capture");
    let film = Film::open(&folder.path().join("steps.png"));
    assert_eq!((film.pictures.len(), film.plays, film.delays), (3, 0, vec![1500; 3]));
    let names: Vec<&str> = capture.steps.iter().map(|step| step.name.as_str()).collect();
    assert_eq!(names, ["ambient", "volumes", "mask", "light"]);
    let counts = &capture.frame_at(1).and_then(|frame| frame.stencil.as_ref()).expect("a stencil").image;
    let expected = [
        Picture::drawn(capture.size, |at| color_of(&capture, 0, at)),
        Picture::drawn(capture.size, |at| colors::stencil(counts.byte_at(at).expect("a value"))),
        finished(&capture),
    ];
    // A mask is beside the frame.
    for ((found, expected), name) in film.pictures.iter().zip(expected).zip(["ambient", "volumes", "light"]) {
        assert_eq!(without_bar(found, capture.size), expected, "{name}");
    }
    // The bars have words, and not the same ones.
    let bar = |picture: &Picture| Picture::drawn([96, 20], |[x, y]| picture.at([x, y + 64]).expect("a pixel"));
    let bars: Vec<Picture> = film.pictures.iter().map(bar).collect();
    assert!((1..3).all(|index| bars[index] != bars[index - 1]));
    assert_eq!(bars[0].at([0, 0]), Some(colors::BACKGROUND));
}

#[test]
fn a_folder_is_shown_as_it_is_and_a_map_as_large_as_fits_in() {
    let folder = folder();
    let frame = ["-t", "shadow-map", "--set", "size=32", "--size", "96x64"];
    done(folder.path(), &[&["capture", "table", "-o", "capture"], &frame[..]].concat());
    done(folder.path(), &["animate", "capture", "-o", "steps.png", "--delay", "40"]);
    let film = Film::open(&folder.path().join("steps.png"));
    let capture = disk::read(&folder.path().join("capture")).expect("a capture");
    let steps = steps::count(&capture);
    assert_eq!((film.pictures.len(), film.delays), (steps, vec![40; steps]));
    // A texel is two pixels wide and high, in the middle of the picture: 32 columns are free on each side of it.
    let map = without_bar(&film.pictures[0], [96, 64]);
    let in_texel = |texel: [u32; 2], [x, y]: [u32; 2]| map.at([16 + texel[0] * 2 + x, texel[1] * 2 + y]);
    for texel in pixels([32, 32]) {
        assert_eq!(in_texel(texel, [0, 0]), in_texel(texel, [1, 1]), "{texel:?}");
    }
    assert_eq!([map.at([15, 30]), map.at([80, 30])], [Some(colors::BACKGROUND); 2]);
    assert_eq!(without_bar(film.pictures.last().expect("a picture"), [96, 64]), finished(&capture));
    // The folder has its scene, which can be lit anew.
    done(folder.path(), &["animate", "capture", "--light-round", "3", "-o", "round.png", "--exact"]);
    assert_eq!(Film::open(&folder.path().join("round.png")).pictures[0], finished(&capture));
}

#[test]
fn a_light_goes_once_round_and_every_picture_is_the_frame_of_its_place() {
    let folder = folder();
    let frame = ["animate", "table", "-t", "z-fail", "--size", "96x64", "--light-round", "5"];
    done(folder.path(), &[&frame[..], &["-o", "exact.png", "--exact"]].concat());
    let said = done(folder.path(), &[&frame[..], &["-o", "round.png"]].concat());
    assert!(said.starts_with("round.png: table, z-fail, 96x64, 5 pictures of 100 ms, "), "{said}");
    let [exact, rounded] = ["exact.png", "round.png"].map(|name| Film::open(&folder.path().join(name)));
    assert_eq!((exact.plays, exact.delays), (0, vec![100; 5]));
    let round = LightRound::new(opened("table"), 0, 5).expect("a way round");
    let mut session = session();
    for (place, (exact, rounded)) in (0..5).zip(exact.pictures.iter().zip(&rounded.pictures)) {
        let capture = session.capture(&round.scene(place), &request(Technique::ZFail, [96, 64])).expect("a frame");
        assert_eq!(*exact, finished(&capture), "place {place}");
        let expected = Picture::drawn([96, 64], |at| apng::ColorDepth::Rounded.reduced(exact.at(at).expect("a pixel")));
        assert_eq!(*rounded, expected, "place {place}");
    }
    assert!((1..5).all(|place| exact.pictures[place] != exact.pictures[place - 1]), "it moves");
}

/// Writes a film and reads it again.
fn filmed(shows: FilmContent, session: &mut Session) -> Film {
    filmed_with(shows, None, session)
}

fn filmed_with(shows: FilmContent, pick: Option<[u32; 2]>, session: &mut Session) -> Film {
    let folder = folder();
    let path = folder.path().join("film.png");
    let mut film = FilmFile::begin(shows, &path, 100).expect("begun").marking(pick);
    while pollster::block_on(film.shoot(async |scene, request| session.capture(scene, request))).expect("a picture") {}
    film.finish().expect("finished");
    Film::open(&path)
}

/// Every pass of both frames is shown once, in order, and passes alike at once, whatever the techniques.
#[test]
fn passes_of_two_frames_are_shown_side_by_side() {
    let mut session = session();
    let size = [96, 64];
    let frames: Vec<Arc<Capture>> = Technique::rivals()
        .into_iter()
        .map(|technique| Arc::new(session.capture(&opened("two-lights"), &request(technique, size)).expect("a frame")))
        .collect();
    let at = |point: &SidePoint| if let SidePoint::At(step) = point { Some(*step) } else { None };
    let mut together = 0;
    for first in &frames {
        for second in &frames {
            let sides = [first, second].map(Arc::clone);
            let rows = both_sides::aligned(&sides);
            for (side, frame) in sides.iter().enumerate() {
                let shown: Vec<usize> = rows.iter().filter_map(|row| at(&row[side])).collect();
                assert_eq!(shown, steps::numbered(frame).collect::<Vec<_>>(), "{}", frame.technique);
            }
            for row in &rows {
                if let [Some(a), Some(b)] = [at(&row[0]), at(&row[1])] {
                    let [a, b] = [&first.steps[a], &second.steps[b]];
                    assert_eq!((&a.name, a.light), (&b.name, b.light));
                    together += usize::from(first.technique != second.technique);
                }
            }
            assert!(first.technique != second.technique || rows.len() == steps::count(first));
        }
    }
    assert!(together > 50, "{together}");
    let named = |technique: Technique| frames.iter().find(|frame| frame.technique == technique.name());
    let sides = [Technique::ZFail, Technique::ShadowMap].map(|technique| named(technique).cloned().expect("a frame"));
    let rows = both_sides::aligned(&sides);
    let [zero, one] = [0, 1].map(|side| rows.iter().position(|row| at(&row[side]).is_none()).expect("a pass alone"));
    let film = filmed(FilmContent::Steps(sides.to_vec()), &mut session);
    assert_eq!((film.pictures.len(), film.pictures[0].size()), (rows.len(), [2 * 96 + 8, 64 + 20]));
    let part = |index: usize, left: u32| {
        Picture::drawn(size, |[x, y]| film.pictures[index].at([left + x, y]).expect("a pixel"))
    };
    let last = rows.len() - 1;
    assert_eq!([part(last, 0), part(last, 104)], sides.each_ref().map(|frame| finished(frame)));
    // A side without such a pass stays as it was.
    for (index, left) in [(zero, 0), (one, 104)] {
        let before = if index == 0 { Picture::filled(size, colors::BACKGROUND) } else { part(index - 1, left) };
        assert_eq!(part(index, left), before, "{index}");
    }
}

/// A mark lies around the picked pixel of every picture, and hides neither it nor its neighbours.
#[test]
fn the_pick_is_marked_in_each_picture_of_a_frame() {
    let mut session = session();
    let size = [96, 64];
    let frame = Arc::new(session.capture(&opened("table"), &request(Technique::ZFail, size)).expect("a frame"));
    let shows = FilmContent::Steps(vec![frame]);
    let [plain, marked] = [None, Some([40, 30])].map(|pick| filmed_with(shows.clone(), pick, &mut session));
    assert_eq!(plain.pictures.len(), 3);
    for (before, after) in plain.pictures.iter().zip(&marked.pictures) {
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        let changed: Vec<[u32; 2]> = places.filter(|at| before.at(*at) != after.at(*at)).collect();
        let away = |[x, y]: [u32; 2]| x.abs_diff(40).max(y.abs_diff(30));
        assert!(!changed.is_empty() && changed.iter().all(|at| (4..=5).contains(&away(*at))), "{changed:?}");
    }
}

/// The window's films name the technique and the place below each picture.
#[test]
fn a_light_goes_round_in_two_techniques_side_by_side() {
    let mut session = session();
    let size = [96, 64];
    let round = LightRound::new(opened("table"), 0, 3).expect("a way round");
    let sides = [Technique::ZFail, Technique::Planar].map(|technique| request(technique, size));
    let content = |sides: &[_]| FilmContent::Moving {
        motion: Box::new(FilmMotion::LightRound(round.clone())),
        sides: sides.to_vec(),
        has_captions: true,
        colors: apng::ColorDepth::Exact,
    };
    let film = filmed(content(&sides), &mut session);
    assert_eq!((film.pictures.len(), film.pictures[0].size()), (3, [2 * 96 + 8, 64 + 20]));
    for (place, picture) in (0..3).zip(&film.pictures) {
        for (left, side) in [0, 104].into_iter().zip(&sides) {
            let capture = session.capture(&round.scene(place), side).expect("a frame");
            let part = Picture::drawn(size, |[x, y]| picture.at([left + x, y]).expect("a pixel"));
            assert_eq!(part, finished(&capture), "place {place}");
        }
    }
    let one = filmed(content(&sides[..1]), &mut session);
    assert_eq!(one.pictures[0].size(), [96, 64 + 20]);
    let bar = |picture: &Picture| Picture::drawn([96, 20], |[x, y]| picture.at([x, y + 64]).expect("a pixel"));
    assert_eq!(bar(&one.pictures[0]), bar(&film.pictures[0]), "the same name and place");
    assert_ne!(bar(&one.pictures[0]), Picture::filled([96, 20], colors::BACKGROUND));
}

/// From the last place to the first it is as far as between any others.
#[test]
fn the_way_round_is_closed() {
    let round = LightRound::new(opened("table"), 0, 24).expect("a way round");
    let at = |place: u32| -> DVec3 { round.scene(place).lights[0].position.truncate() };
    let steps: Vec<f64> = (0..24).map(|place| at(place).distance(at((place + 1) % 24))).collect();
    assert!(steps[0] > 0.1 && steps.iter().all(|step| (step - steps[0]).abs() < 1e-9), "{steps:?}");
}

#[test]
fn another_programs_frame_is_shown_pass_by_pass_and_its_light_can_not_be_moved() {
    let folder = folder();
    done(folder.path(), &["animate", "ogre", "--steps", "-o", "ogre.png"]);
    let film = Film::open(&folder.path().join("ogre.png"));
    assert_eq!((film.pictures.len(), film.pictures[0].size()), (3, [320, 260]));
    assert_fails(
        &["animate", "ogre", "--light-round", "-o", "ogre.png"],
        2,
        &["`ogre`", "another program drew this frame", "--steps shows it pass by pass"],
    );
}

#[test]
fn a_file_that_is_there_is_replaced_only_where_that_is_wished() {
    let folder = folder();
    let arguments = ["animate", "ogre", "-o", "a.png"];
    std::fs::write(folder.path().join("a.png"), "mine").expect("written");
    let output = run(folder.path(), &arguments);
    let line = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{line}");
    assert!(line.contains("`a.png` is there already") && line.contains("--overwrite"), "{line}");
    assert_eq!(std::fs::read(folder.path().join("a.png")).expect("a file"), b"mine");
    let before = names(folder.path());
    done(folder.path(), &[&arguments[..], &["--overwrite"]].concat());
    assert_eq!(Film::open(&folder.path().join("a.png")).pictures.len(), 3);
    assert_eq!(names(folder.path()), before, "nothing is left beside it");
}

#[test]
fn what_makes_no_animation_is_refused_in_one_line_with_the_fix() {
    let round = ["--light-round"];
    let cases: &[(&[&str], &[&str])] = &[
        (&["-o", "a.gif"], &["`a.gif`", "ends in .png"]),
        (&["-o", "models"], &["`models`", "ends in .png"]),
        (&["-o", "nowhere/a.png"], &["nowhere/a.png", "can't be written", "choose another"]),
        (&["-o", "a.png", "--delay", "nan"], &["nan", "whole number of milliseconds from 20 to 60000"]),
        (&["-o", "a.png", "--delay", "-5"], &["-5", "from 20 to 60000"]),
        (&["-o", "a.png", "--light-round", "0"], &["0", "pictures from 2 to 3600"]),
        (&["-o", "a.png", "--light-round", "2.5"], &["2.5", "whole number of pictures"]),
        (&["-o", "a.png", "--steps", "--light-round"], &["--steps", "--light-round"]),
        (&["-o", "a.png", "--which-light", "0"], &["--which-light"]),
        (&["-o", "a.png", "--exact"], &["--light-round"]),
        (&["-o", "a.png", "--every", "draw"], &["--every draw", "leave it out"]),
        (&["-o", "a.png", "--external-capture"], &["--external-capture", "leave it out"]),
        (&["-o", "a.png", "--which-light", "2", round[0]], &["no light 2", "choose light 1"]),
        (&["-o", "a.png", "--sun", "0,1,0", round[0]], &["light 1 is above the middle", "move it to a side"]),
    ];
    for (options, words) in cases {
        assert_fails(&[&["animate", "table"], *options].concat(), 2, words);
    }
    assert_fails(&["animate", "table"], 2, &["--output"]);
    assert_fails(&["animat", "table"], 2, &["did you mean `animate`?"]);
}
