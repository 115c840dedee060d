//! Pages of frames, as files: what stands in them, how large they are, and the command that makes them. What they do in a
//! browser is in `pages.rs`.

use crate::commands::{assert_fails, done, folder, run, text};
use crate::common::{adapter, frame, names, opened, request, request_with, session};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::read::ZlibDecoder;
use serde_json::{Value, json};
use std::fs;
use std::io::Read;
use std::path::Path;
use stencilscope::capture::disk::{self, FolderContents, MemoryFiles};
use stencilscope::history::{PixelDocument, PixelHistory, Verdict};
use stencilscope::import::SHIPPED;
use stencilscope::link::ViewLink;
use stencilscope::page::{self, PageFrame};
use stencilscope::plan::DecidedBy;
use stencilscope::reading::capture_point::CapturePoint;
use stencilscope::reading::history_row::{EventOutcome, HistoryCells};
use stencilscope::reading::{moment, notable_pixel, shadow_casters};
use stencilscope::session::{CaptureRequest, RunFrame, Session, SnapshotInterval};
use stencilscope::technique::{Choice, Technique};

const SIZE: [u32; 2] = [96, 64];

fn html(frame: &RunFrame) -> String {
    page::html(&frame.capture, &frame.plan, None).expect("a page")
}

/// The bytes of a file that the program made.
fn made(folder: &Path, arguments: &[&str], file: &str) -> Vec<u8> {
    let printed = done(folder, arguments);
    assert!(printed.contains(file), "{arguments:?}: {printed}");
    fs::read(folder.join(file)).expect("a file")
}

#[test]
fn a_frame_makes_the_same_bytes_again_whatever_it_took_and_wherever_it_lay() {
    let mut session = session();
    let mut once = || frame(&mut session, "tori", request(Technique::ZFail, SIZE));
    let (first, second) = (once(), once());
    let page = html(&first);
    assert_eq!(page, html(&second));
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("capture");
    disk::write(first.contents(), &folder, false).expect("written");
    let opened = RunFrame::from_folder(disk::read_whole(&folder).expect("read")).expect("a whole frame");
    assert!(page == html(&opened), "of the folder");
}

/// The figures of the README's page.
#[test]
fn tori_are_a_megabyte_and_five_with_every_draw() {
    let mut session = session();
    let mut bytes = |every| {
        let request = CaptureRequest { every, ..request(Technique::ZFail, [640, 480]) };
        html(&frame(&mut session, "tori", request)).len()
    };
    let [passes, draws] = [bytes(SnapshotInterval::Pass), bytes(SnapshotInterval::Draw)];
    println!("every pass {passes} bytes, every draw {draws}");
    // On a coarse grid every surface is in pieces, and depths are no planes.
    let most = if adapter::draws_as_given() { 1_000_000 } else { 1_700_000 };
    assert!(passes <= most && draws <= 5_000_000, "{passes} and {draws} bytes");
    assert!(draws > passes, "draws are in it");
}

/// The README's page is made of today's modules and style.
#[test]
fn the_committed_page_holds_what_pages_are_made_of_now() {
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/pages/tori.html");
    let committed = fs::read_to_string(committed).expect("a page");
    for (what, text) in [("script", page::script()), ("style", page::STYLE.to_owned()), ("module", page::module())] {
        assert!(committed.contains(&text), "an older {what}: assets/pages/README.md has the command");
    }
}

/// The document in a page.
fn document(page: &[u8]) -> Value {
    let page = text(page);
    let document = page.split_once("type=\"application/json\">").expect("a document").1;
    serde_json::from_str(document.split_once("</script>").expect("an end").0).expect("JSON")
}

/// The manifest in a page.
fn manifest(page: &[u8]) -> Value {
    let document = document(page);
    let file = &document["files"]["manifest.json"];
    let deflated = BASE64_STANDARD.decode(file["data"].as_str().expect("data")).expect("base64");
    let mut bytes = Vec::new();
    ZlibDecoder::new(&deflated[..]).read_to_end(&mut bytes).expect("zlib");
    assert_eq!(file["predicted"], json!(false), "a text has no planes");
    serde_json::from_slice(&bytes).expect("JSON")
}

/// The files of a frame as its page has them.
fn files(frame: &RunFrame) -> MemoryFiles {
    let plan = frame.plan.without_shading();
    let plan = if frame.capture.decided_by(0) == DecidedBy::Map { &*frame.plan } else { &plan };
    let mut files = MemoryFiles::new();
    let contents = FolderContents { capture: &frame.capture, plan: Some(plan), scene: None };
    disk::write_each(contents, &mut |name, bytes| drop(files.insert(name, bytes.into()))).expect("files");
    files
}

/// A pixel's document without depths, of which each rasteriser has last bits of its own.
fn without_depths(mut document: Value) -> Value {
    for part in ["final", "captured"] {
        document[part]["depth"] = Value::Null;
    }
    for event in document["events"].as_array_mut().expect("events") {
        event
            .as_object_mut()
            .expect("fields")
            .retain(|name, _| !matches!(name.as_str(), "depth" | "depth_before" | "depth_after"));
    }
    document
}

/// What is answered from a frame's files in memory is what the program says of the frame.
fn assert_answers(session: &mut Session, frame: &RunFrame, name: &str) {
    let size = frame.plan.size;
    let files = files(frame);
    let (capture, plan) = disk::read_memory(&files).expect("a frame");
    assert!(capture == *frame.capture && plan.is_some(), "{name}");
    let page = PageFrame::read(&files).expect("a frame");
    for pixel in (0..12).map(|index| [index * 31 % size[0], index * 17 % size[1]]) {
        let place = format!("{name} at {pixel:?}");
        let answer = page.answer(&json!({ "pixel": pixel }).to_string()).expect("an answer");
        let answer: Value = serde_json::from_str(&answer).expect("JSON");
        // Another program's frame was drawn by another GPU, whose last bits the one here need not have.
        let history = match frame.capture.origin.is_some() {
            true => PixelHistory::without_gpu(&frame.plan, &frame.capture, pixel),
            false => session.history(&frame.plan, &frame.capture, pixel).expect("a history"),
        };
        let document = serde_json::to_value(PixelDocument::new(&history, 0.0)).expect("JSON");
        assert_eq!(without_depths(answer["history"].clone()), without_depths(document), "{place}");
        let rows = answer["rows"].as_array().expect("rows");
        assert_eq!(rows.len(), history.events.len(), "{place}");
        for (row, event) in rows.iter().zip(&history.events) {
            let cells = HistoryCells::of(&history, event, &frame.capture);
            assert_eq!(
                [&row["side"], &row["is_idle"]],
                [&json!(cells.side), &json!(!event.does_something())],
                "{place}"
            );
            let is_tested = matches!(cells.outcome, EventOutcome::Tested { .. });
            assert_eq!(row["outcome"] == json!("tested"), is_tested, "{place}");
            // Its triangle is over the pixel: so is its outline.
            let outline: Vec<[f64; 2]> = serde_json::from_value(row["outline"].clone()).expect("corners");
            let within = |axis: usize| {
                let places = || outline.iter().map(|at| at[axis]);
                let [least, most] = [places().fold(f64::MAX, f64::min), places().fold(f64::MIN, f64::max)];
                least <= f64::from(pixel[axis]) + 1.0 && most >= f64::from(pixel[axis])
            };
            assert!(!is_tested || within(0) && within(1), "{place}: {outline:?} of {}", row["what"]);
        }
        for (light, said) in answer["lights"].as_array().expect("lights").iter().enumerate() {
            let verdict = Verdict::of(&frame.capture, light, pixel).with_history(&history);
            for (index, step) in frame.capture.steps.iter().enumerate() {
                let at = |draw| moment::title(&verdict, &frame.capture, CapturePoint { step: index, draw }, pixel);
                let titles: Vec<String> = (0..step.draws.len()).map(Some).chain([None]).map(at).collect();
                assert_eq!(said["titles"][index], json!(titles), "{place}");
            }
            let names = shadow_casters::casters(&history, light, &frame.capture.depth);
            let words = shadow_casters::sentence(&names, frame.capture.finding_at(light, pixel));
            let is_told = verdict.is_in_shadow() && history.agrees();
            assert_eq!(said["whose"], json!(words.filter(|_| is_told)), "{place}");
            let ladder = history.ladder(light, &frame.capture.depth);
            let runs = ladder.as_ref().map(|ladder| ladder.rungs.iter().map(|rung| rung.running).collect::<Vec<i32>>());
            let said_runs = said["ladder"]["rungs"].as_array();
            let said_runs = said_runs
                .map(|rungs| rungs.iter().filter_map(|rung| rung["running"].as_i64()).map(|run| run as i32).collect());
            assert_eq!(said_runs, runs, "{place}");
            let Some(compared) = said["compared"].as_object() else {
                assert_eq!(said["reason"], json!(verdict.reason()), "{place}");
                continue;
            };
            assert_eq!(frame.capture.decided_by(light), DecidedBy::Map);
            let texel = json!({"light": light, "face": compared["face"], "at": compared["texels"][0]["at"]});
            let readers = page.answer(&json!({ "readers": texel }).to_string()).expect("an answer");
            let readers: Vec<[u32; 2]> = serde_json::from_str(&readers).expect("pixels");
            assert!(readers.contains(&pixel), "{place}: {readers:?}");
        }
    }
    let outside = json!({ "pixel": size }).to_string();
    for nonsense in ["", "{}", "{\"pixel\":[1]}", "{\"pixel\":[-1,2]}", &outside, "{\"text\":1}"] {
        page.answer(nonsense).expect_err(nonsense);
    }
    let unknown = json!({"readers": {"light": 9, "face": 7, "at": [1, 2]}}).to_string();
    assert_eq!(page.answer(&unknown).expect("an answer"), "null");
}

/// A scene, a technique and its settings.
type Form = (&'static str, Technique, &'static [(&'static str, &'static str)]);

#[test]
fn files_in_memory_are_the_frame_and_answer_as_the_program_does() {
    let mut session = session();
    let forms: &[Form] = &[
        ("tori", Technique::ZFail, &[]),
        ("tori", Technique::ZFail, &[("counter", "float")]),
        ("inside", Technique::ZPassPlus, &[]),
        ("tori", Technique::ShadowMap, &[("filter", "pcf:3")]),
        ("two-lights", Technique::Auto, &[]),
        ("table", Technique::Planar, &[]),
        ("table", Technique::PlanarTexture, &[]),
    ];
    for (name, technique, settings) in forms {
        let frame = frame(&mut session, name, request_with(*technique, settings, SIZE));
        assert_answers(&mut session, &frame, &format!("{name} {technique:?} {settings:?}"));
    }
    for shipped in SHIPPED {
        let frame = RunFrame::from_folder(shipped.open().expect("a frame")).expect("a whole frame");
        assert_answers(&mut session, &frame, shipped.name);
    }
}

/// Above what a step left stands who casts the shadow, and of a lit pixel when its count was 0.
#[test]
fn a_page_says_whose_shadow_it_is_and_of_which_moment_it_speaks() {
    let frame = frame(&mut session(), "tori", request(Technique::ZFail, SIZE));
    let page = PageFrame::read(&files(&frame)).expect("a frame");
    let said = |pixel: Option<[u32; 2]>| {
        let answer = page.answer(&json!({ "pixel": pixel.expect("a pixel") }).to_string()).expect("an answer");
        let answer: Value = serde_json::from_str(&answer).expect("JSON");
        answer["lights"][0].clone()
    };
    let dark = said(notable_pixel::well_in_shadow(&frame.capture));
    assert!(dark["whose"].as_str().is_some_and(|whose| whose.starts_with("In the shadow of ")), "{dark}");
    let lit = said(notable_pixel::lit(&frame.capture));
    assert_eq!(lit["whose"], Value::Null);
    let last = |of: &Value| of.as_array().and_then(|all| all.last()).expect("titles").clone();
    let last = last(&last(&lit["titles"]));
    let last = last.as_str().expect("a title");
    assert!(last.ends_with("was 0 when the light pass tested it; the pass then made it 1."), "{last}");
}

/// A page without all its files says which one it lacks.
#[test]
fn files_in_memory_that_lack_one_are_refused_by_its_name() {
    let mut session = session();
    let frame = frame(&mut session, "tori", request(Technique::ZFail, SIZE));
    let files = files(&frame);
    // Without the plan as text nothing is missing.
    for lacks in files.keys().filter(|name| *name != disk::PLAN) {
        let mut files = files.clone();
        files.remove(lacks);
        let error = PageFrame::read(&files).expect_err(lacks).to_string();
        assert!(error.contains(lacks.as_str()), "{lacks}: {error}");
    }
}

/// Nothing is named that a browser would load; the beginning of XML's names is no address.
#[test]
fn no_address_is_in_it() {
    let mut session = session();
    let page = html(&frame(&mut session, "two-lights", request(Technique::ShadowMap, SIZE)));
    let addresses: Vec<&str> = page.match_indices("://").map(|(at, _)| &page[at.saturating_sub(8)..at + 30]).collect();
    assert!(addresses.iter().all(|text| text.contains("http://www.w3.org/")), "{addresses:?}");
    for loads in
        ["src=", "href=\"h", "@import", "url(", "fetch(", "import(", "eval(", "innerHTML", "XMLHttp", "WebSocket"]
    {
        assert!(!page.contains(loads), "{loads}");
    }
    // WebAssembly needs a word of its own, which lets no text run.
    assert!(page.contains("default-src 'none'") && !page.replace("'wasm-unsafe-eval'", "").contains("unsafe-"));
}

#[test]
fn text_of_a_scene_ends_no_element() {
    let mut session = session();
    let mut scene = opened("tori");
    scene.name = "</script></title>{{script}}<b>".to_owned();
    let frame = session.render(scene, request(Technique::ZFail, SIZE)).expect("a frame");
    let page = html(&frame);
    assert_eq!(page.matches("</script>").count(), 3, "the ends of document, module and script");
    assert_eq!(page.matches("</title>").count(), 1);
    assert!(!page.contains("<b>"));
}

#[test]
fn the_command_makes_one_of_a_scene_a_folder_and_another_programs_frame() {
    let folder = folder();
    let of_scene = ["-t", "z-fail", "--size", "64x48"];
    let page = made(folder.path(), &[&["page", "tori", "-o", "a.html"], &of_scene[..]].concat(), "a.html");
    made(folder.path(), &[&["capture", "tori", "-o", "c", "--page", "b.html"], &of_scene[..]].concat(), "b.html");
    assert!(fs::read(folder.path().join("b.html")).expect("a file") == page, "beside a folder");
    assert!(made(folder.path(), &["page", "c", "-o", "c.html"], "c.html") == page, "of the folder");
    let foreign = made(folder.path(), &["page", "ogre-short", "-o", "ogre.html"], "ogre.html");
    assert_eq!(manifest(&foreign)["origin"]["api"], json!("OpenGL"));
    let judged = made(folder.path(), &[&["page", "tori", "--truth", "-o", "t.html"], &of_scene[..]].concat(), "t.html");
    let has_findings = |page: &[u8]| text(page).contains("\"light0.error.npy\"");
    assert!(has_findings(&judged) && !has_findings(&page));
}

/// The address of a live window.
const LIVE: &str = "https://live.example/window/";

/// The frame that a live window shows for a link's query (`app/browser/shell.rs`).
fn opened_live(session: &mut Session, query: &str) -> RunFrame {
    let link = ViewLink::parse(query).0;
    let mut scene = opened(link.scene.as_deref().expect("a scene"));
    link.apply_to(&mut scene).expect("the scene's own camera and lights");
    let choice = Choice::for_scene(&scene, link.technique.as_deref(), link.settings).expect("a choice");
    let request = CaptureRequest::new(choice, link.size.expect("a size"));
    session.render(scene.at(link.time.unwrap_or(0.0)), request).expect("a frame")
}

/// What the link opens makes the very page that has the link.
#[test]
fn a_page_links_to_its_own_view_in_a_live_window() {
    let folder = folder();
    let mut session = session();
    // The light of `rings` is white, as are those of the command line: it is only moved.
    let cases: [&[&str]; 4] = [
        &["inside", "-t", "z-pass", "--set", "casters=light-facing"],
        &["inside", "-t", "z-pass", "--eye", "0.1,1.2,3.5", "--fov", "50", "--far", "90"],
        &["two-lights", "-t", "z-fail", "--off", "1", "--time", "1.5"],
        &["rings", "-t", "z-fail", "--light", "0.3,2.5,-1"],
    ];
    for case in cases {
        let arguments = [&["page"], case, &["--size", "64x48", "--overwrite", "-o", "a.html"]].concat();
        let without = made(folder.path(), &arguments, "a.html");
        assert_eq!(document(&without)["live"], Value::Null, "{case:?}");
        let with = made(folder.path(), &[&arguments[..], &["--live", LIVE]].concat(), "a.html");
        let address = document(&with)["live"].as_str().expect("an address").to_owned();
        let written = format!("\"live\":\"{address}\",");
        assert!(text(&with).replacen(&written, "", 1) == text(&without), "{case:?}: nothing else differs");
        let query = address.strip_prefix(LIVE).and_then(|rest| rest.strip_prefix('?')).expect("a query");
        let frame = opened_live(&mut session, query);
        assert!(html(&frame) == text(&without), "{case:?}: {query}");
        let eye = frame.capture.camera.eye.to_array();
        assert_eq!(eye == [0.1, 1.2, 3.5], case.contains(&"--eye"), "{case:?}: {eye:?}");
    }
    let recorded = made(folder.path(), &["page", "ogre-short", "-o", "ogre.html", "--live", LIVE], "ogre.html");
    assert_eq!(document(&recorded)["live"], json!("https://live.example/window/?scene=ogre-short"));
}

#[test]
fn a_page_of_a_folder_has_no_link_to_a_live_window() {
    let folder = folder();
    // Its name is a recorded frame's, which it is not.
    done(folder.path(), &["capture", "tori", "--size", "32x24", "-o", "ogre"]);
    let output = run(folder.path(), &["page", "ogre", "-o", "a.html", "--live", LIVE]);
    let line = text(&output.stderr);
    assert!(output.status.code() == Some(2) && line.contains("`ogre` is one: name the built-in scene"), "{line}");
    assert!(!folder.path().join("a.html").exists());
}

#[test]
fn a_page_that_is_there_is_replaced_only_where_that_is_wished() {
    let folder = folder();
    fs::write(folder.path().join("a.html"), "mine").expect("written");
    for arguments in [&["page", "ogre", "-o", "a.html"][..], &["capture", "tori", "-o", "c", "--page", "a.html"]] {
        let output = run(folder.path(), arguments);
        let line = text(&output.stderr);
        assert!(output.status.code() == Some(2) && line.contains("`a.html` is there already"), "{line}");
        assert_eq!(fs::read(folder.path().join("a.html")).expect("a file"), b"mine");
    }
    let before = names(folder.path());
    made(folder.path(), &["page", "ogre", "-o", "a.html", "--overwrite"], "a.html");
    assert_eq!(names(folder.path()), before, "nothing is left beside it");
}

#[test]
fn what_makes_no_page_is_refused_in_one_line_with_the_fix() {
    let cases: &[(&[&str], &[&str])] = &[
        (&["page", "tori", "-o", "a.png"], &["`a.png`", "ends in .html"]),
        (&["page", "tori", "-o", "nowhere/a.html"], &["nowhere/a.html", "can't be written", "choose another"]),
        (&["page", "tori"], &["--output"]),
        (&["page", "nothing.toml", "-o", "a.html"], &["nothing.toml", "no such file"]),
        (&["page", "ogre", "-o", "a.html", "-t", "z-pass"], &["`ogre`", "captured already"]),
        (&["page", "ogre", "-o", "a.html", "--every", "draw"], &["--every draw", "leave it out"]),
        (&["page", "tori", "-o", "a.html", "--external-capture"], &["--external-capture", "leave it out"]),
        (&["capture", "tori", "-o", "c", "--page", "a.txt"], &["`a.txt`", "ends in .html"]),
        (&["page", "tori", "-o", "a.html", "--live", "ftp://live.example/"], &["--live", "give", "https://HOST/PATH/"]),
        (&["page", "tori", "-o", "a.html", "--live", "https:///live"], &["--live", "give", "https://HOST/PATH/"]),
        (&["page", "tori", "-o", "a.html", "--live", "https://live.example/?scene=a"], &["--live", "without `?`"]),
        (
            &["page", "triangle.obj", "-o", "a.html", "--live", LIVE],
            &["`triangle.obj` is a file", "leave `--live` out"],
        ),
        (&["page", "good.toml", "-o", "a.html", "--live", LIVE], &["built-in scenes alone", "leave `--live` out"]),
        (&["page", "tori", "-o", "a.html", "--live", LIVE, "--light", "0,1,0"], &["`--light`", "leave these out"]),
        (&["page", "rings", "-o", "a.html", "--live", LIVE, "--sun", "0,1,0"], &["`--sun`", "leave these out"]),
    ];
    for (arguments, words) in cases {
        assert_fails(arguments, 2, words);
    }
}

/// Its modules are read: no line is longer than these, and each says what it is for.
#[test]
fn the_modules_are_small_and_say_what_they_are() {
    for module in page::modules() {
        assert!(module.text.starts_with("// "), "{}", module.name);
        assert!(module.text.lines().count() <= 250, "{}", module.name);
        let longest = module.text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        assert!(longest <= 140, "{}: a line of {longest}", module.name);
    }
}

/// What was found wrong stands in the page, with a way to the pixel, and is not read as a tag.
#[test]
fn a_page_has_the_findings_that_it_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = ["inside", "-t", "z-pass", "--size", "96x64"];
    let json = folder.path().join("found.json").display().to_string();
    let output = run(folder.path(), &[&["diagnose"], &scene[..], &["--no-techniques", "--json", &json]].concat());
    assert_eq!(output.status.code(), Some(1), "wrong pixels: {}", text(&output.stderr));
    let found = fs::read_to_string(&json).expect("a file");
    let frame = frame(&mut session(), "inside", request(Technique::ZPass, SIZE));
    let path = folder.path().join("page.html");
    page::write_at(&frame.capture, &frame.plan, "step=1", Some(&found), &path).expect("written");
    let page = fs::read_to_string(&path).expect("a page");
    let section = page.split_once("<details id=\"diagnosis\"").expect("a section").1;
    let section = section.split_once("</details>").expect("an end").0;
    let document: Value = serde_json::from_str(&found).expect("JSON");
    let [x, y] = [0, 1].map(|axis| document["regions"][0]["at"][axis].as_u64().expect("a pixel"));
    for words in [&*format!("pixel={x},{y}\">{x}, {y}</a>"), "eye-in-volume", "(proven)", "To fix it: ", "wrong, why"] {
        assert!(section.contains(words), "{words}: {section}");
    }
    let plain = html(&frame);
    assert!(!plain.contains("id=\"diagnosis\"") && !plain.contains("{{"));
}
