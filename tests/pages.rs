//! Pages in a real browser: a test program of its own, as it needs one. `.ci/pages` installs it and runs this.

#[path = "pages/access.rs"]
mod access;
#[path = "pages/browser.rs"]
mod browser;
#[path = "pages/live.rs"]
mod live;
#[path = "pages/made.rs"]
mod made;
#[path = "pages/site.rs"]
mod site;

use access::CONTRASTS;
use browser::Browser;
use made::{Made, pixels, scene, tori};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::path::Path;
use stencilscope::capture::disk;
use stencilscope::import::SHIPPED;
use stencilscope::link::ViewLink;
use stencilscope::page;
use stencilscope::reading::map_readers::{MapReaders, MapTexel};
use stencilscope::scene::{OpenSpec, open};

const WIDE: [u32; 2] = [1280, 900];
const PHONE: [u32; 2] = [390, 844];

/// The value that the picture shows at a texel, as it stands under it.
fn hovered(browser: &mut Browser, texel: [u32; 2], size: [u32; 2]) -> String {
    browser.point_at(texel, size);
    let text = browser.text("#hover");
    let place = format!("{}, {} · ", texel[0], texel[1]);
    text.strip_prefix(&place).unwrap_or_else(|| panic!("{text} at {texel:?}")).to_owned()
}

/// A `.npy` of a folder: its bytes and its width.
fn array(folder: &Path, name: &str) -> (Vec<u8>, usize) {
    let bytes = std::fs::read(folder.join(name)).expect("an array");
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let text = String::from_utf8_lossy(&bytes[..header]).into_owned();
    let shape = text.split("'shape': (").nth(1).and_then(|text| text.split(')').next()).expect("a shape");
    let sides: Vec<usize> = shape.split(',').filter_map(|side| side.trim().parse().ok()).collect();
    (bytes[header..].to_vec(), *sides.last().expect("a side"))
}

/// Colours of a PNG of a folder, three bytes a pixel.
fn colors(folder: &Path, name: &str) -> (Vec<u8>, usize) {
    let file = std::io::BufReader::new(std::fs::File::open(folder.join(name)).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("pixels");
    let channels = info.color_type.samples();
    (bytes.chunks_exact(channels).flat_map(|pixel| pixel[..3].to_vec()).collect(), info.width as usize)
}

/// What the text under the picture must say of an aspect's value.
fn says(aspect: &str, (bytes, width): &(Vec<u8>, usize), [x, y]: [u32; 2], text: &str) -> bool {
    const LABELS: [&str; 4] = ["lit", "shadow", "background", "faces away"];
    const FINDINGS: [&str; 6] =
        ["agrees", "false shadow", "missing shadow", "wrong surface", "edge, excused", "not compared"];
    let at = y as usize * width + x as usize;
    let float = |text: &str| text.split(" · ").next().and_then(|text| text.parse::<f32>().ok());
    match aspect {
        "color" => text == format!("{} {} {}", bytes[3 * at], bytes[3 * at + 1], bytes[3 * at + 2]),
        "stencil" => text == stencilscope_signed(bytes[at]),
        "mask" => text == LABELS[usize::from(bytes[at])],
        "error" => text == FINDINGS[usize::from(bytes[at])],
        _ => float(text) == Some(bytemuck::pod_read_unaligned(&bytes[4 * at..4 * at + 4])),
    }
}

/// 255 is `−1 (255)`.
fn stencilscope_signed(value: u8) -> String {
    if value < 128 { value.to_string() } else { format!("−{} ({value})", 256 - u32::from(value)) }
}

#[test]
fn what_is_said_of_a_pixel_is_what_the_capture_folder_holds() {
    let size = [640, 480];
    let shadow_map = Made::of_scene(scene("tori"), "shadow-map", &[("size", "256")], size);
    for made in [tori().judged(), shadow_map] {
        let folder = made.folder.path().join("capture");
        disk::write(made.frame.contents(), &folder, false).expect("a folder");
        let text = std::fs::read_to_string(folder.join("manifest.json")).expect("a manifest");
        let manifest: Value = serde_json::from_str(&text).expect("JSON");
        let mut browser = Browser::new(WIDE, "dark");
        browser.open(&made.page(), "");
        let mut look = |aspect: &str, step: usize, file: &Value, size: [u32; 2], count: u32| {
            let name = file.as_str().expect("a name");
            let values = if name.ends_with(".png") { colors(&folder, name) } else { array(&folder, name) };
            browser.evaluate(&format!("location.hash = '#view={aspect}&step={}'", step + 1));
            browser.evaluate("new Promise((done) => setTimeout(done, 50))");
            for texel in pixels(count, size) {
                let text = hovered(&mut browser, texel, size);
                assert!(says(aspect, &values, texel, &text), "{aspect} after step {step} at {texel:?}: {text}");
            }
        };
        let passes = manifest["passes"].as_array().expect("passes");
        let frames = || passes.iter().enumerate().filter(|(_, pass)| pass["color"].is_string());
        for (step, pass) in frames() {
            look("color", step, &pass["color"], size, 100);
            look("depth", step, &pass["depth"], size, 100);
            if pass["stencil"].is_string() {
                look("stencil", step, &pass["stencil"], size, 100);
            }
        }
        let light = &manifest["lights"][0];
        look("mask", 0, &light["shadow"], size, 100);
        if light["error_picture"].is_string() {
            look("error", 0, &light["error_picture"], size, 100);
        }
        if light["map"].is_string() {
            look("map", 0, &light["map"], [256, 256], 100);
        }
        assert_eq!(browser.complaints(), Vec::<String>::new());
    }
}

/// A pixel's history in a page, as `pixel --json` prints it.
const DOCUMENT: &str = include_str!("pages/document.js");

/// Events in which two documents differ; depths may differ in their last bits, as a browser does not round as a GPU.
fn differences(page: &Value, program: &Value, rounding: f64) -> Vec<String> {
    let mut found = Vec::new();
    let near = |a: &Value, b: &Value| match (a.as_f64(), b.as_f64()) {
        // A float is in the shortest digits that stand for it, of which one has more than the other.
        (Some(a), Some(b)) => a as f32 == b as f32 || (a - b).abs() <= rounding * b.abs().max(1.0),
        _ => a == b,
    };
    let [of_page, of_program] = [page, program].map(|document| document["events"].as_array().expect("events"));
    if of_page.len() != of_program.len() {
        found.push(format!("{} events and not {}", of_page.len(), of_program.len()));
    }
    for (a, b) in of_page.iter().zip(of_program) {
        let names: BTreeSet<&String> =
            [a, b].into_iter().flat_map(|event| event.as_object().expect("fields").keys()).collect();
        for name in names {
            let same = if (name.starts_with("depth") || name.starts_with("count")) && a[name].is_number() {
                near(&a[name], &b[name])
            } else {
                a[name] == b[name]
            };
            if !same {
                found.push(format!("{name}: {} and not {}", a[name], b[name]));
            }
        }
    }
    for name in ["final", "captured"] {
        let is_same =
            page[name]["stencil"] == program[name]["stencil"] && near(&page[name]["depth"], &program[name]["depth"]);
        if !is_same {
            found.push(format!("{name}: {} and not {}", page[name], program[name]));
        }
    }
    if [&page["why"], &page["agrees"]] != [&program["why"], &program["agrees"]] {
        found.push(format!("{} and not {}", page["why"], program["why"]));
    }
    found
}

/// Compares the histories of 100 random pixels with those of the program, and says how long the slowest took, in
/// milliseconds.
fn assert_same_histories(made: &mut Made, name: &str) -> f64 {
    let (rounding, plan) = (16.0 / f64::from(0xff_ffff), made.frame.plan.clone());
    let places = pixels(100, plan.size);
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "");
    let documents = browser.evaluate(&format!("{}.map({DOCUMENT})", json!(places)));
    let mut slowest: f64 = 0.0;
    for (pixel, document) in places.iter().zip(documents.as_array().expect("documents")) {
        let program = made.document(*pixel);
        assert_eq!(differences(document, &program, rounding), Vec::<String>::new(), "{name} at {pixel:?}");
        slowest = slowest.max(document["milliseconds"].as_f64().expect("a time"));
    }
    assert_eq!(browser.complaints(), Vec::<String>::new(), "{name}");
    slowest
}

#[test]
fn histories_are_those_of_the_program_whatever_the_technique() {
    let settings: [(&str, &[(&str, &str)]); 16] = [
        ("z-fail", &[]),
        ("z-fail", &[("counter", "float")]),
        ("z-fail", &[("extruded-by", "vertex-shader")]),
        ("z-pass", &[("extruded-by", "vertex-shader")]),
        ("z-fail", &[("faces", "two-pass")]),
        ("z-fail", &[("depth", "standard-finite-clamp")]),
        ("z-fail", &[("depth", "standard-infinite")]),
        ("z-fail", &[("stencil-bits", "1")]),
        ("z-pass", &[]),
        ("z-pass-plus", &[]),
        ("auto", &[]),
        ("planar", &[]),
        ("shadow-map", &[]),
        ("projective", &[]),
        ("ray-traced", &[]),
        ("none", &[]),
    ];
    for (technique, settings) in settings {
        let mut made = Made::of_scene(scene("tori"), technique, settings, [320, 240]);
        assert_same_histories(&mut made, &format!("{technique} {settings:?}"));
    }
    for name in ["inside", "two-lights", "steps", "tiger-cage"] {
        assert_same_histories(&mut Made::of_scene(scene(name), "auto", &[], [320, 240]), name);
    }
}

#[test]
fn histories_of_another_programs_frames_are_those_of_the_program() {
    for shipped in SHIPPED {
        assert_same_histories(&mut Made::of_folder(shipped.open().expect("a frame")), shipped.name);
    }
}

/// Shadow and receiver in one plane: which is nearer is up to the last bit, and the page has it too.
#[test]
fn depths_are_those_of_the_gpu_to_the_last_bit() {
    let mut made = Made::of_scene(scene("tori"), "planar", &[("z-fighting", "none")], [160, 120]);
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "");
    for pixel in pixels(100, [160, 120]) {
        let document = browser.evaluate(&format!("({DOCUMENT})({})", json!(pixel)));
        assert_eq!(differences(&document, &made.document(pixel), 0.0), Vec::<String>::new(), "{pixel:?}");
    }
}

/// A bit of the stored stencil is inverted: the page says at which pixel.
#[test]
fn where_the_page_computes_something_else_it_says_so() {
    let mut made = tori();
    let changed = [322, 92];
    made.change_stencil(changed);
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "#pixel=322,92&step=2");
    let said = browser.text(".differs");
    assert!(said.contains("not as the GPU stored it") && said.contains("after pass 2 the events make"), "{said}");
    assert!(said.contains("and stencil 2") && said.ends_with("and 3"), "{said}");
    browser.open(&made.page(), "#pixel=323,92&step=2");
    assert!(browser.text(".agrees").contains("as the GPU stored it"));
}

#[test]
fn it_is_there_in_less_than_a_second_and_a_history_in_milliseconds() {
    let mut made = tori();
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "");
    let shown = browser.evaluate("performance.getEntriesByName('shown')[0].startTime").as_f64().expect("a time");
    let slowest = assert_same_histories(&mut made, "tori");
    println!("tori: its first step after {shown:.0} ms, the slowest of 100 histories {slowest:.1} ms");
    assert!(shown < 1000.0 && slowest < 50.0, "{shown} ms, {slowest} ms");
    // 188 times 188 squares round a ring: 70 688 triangles.
    let sides = 188;
    let folder = tempfile::tempdir().expect("a folder");
    let mut text = String::new();
    for index in 0..sides * sides {
        let [round, about] = [index / sides, index % sides].map(|step| f64::from(step) * TAU / f64::from(sides));
        let out = 1.0 + 0.4 * about.cos();
        text += &format!("v {} {} {}\n", out * round.cos(), 0.4 * about.sin(), out * round.sin());
    }
    for index in 0..sides * sides {
        let (round, about) = (index / sides, index % sides);
        let at = |round: u32, about: u32| (round % sides) * sides + about % sides + 1;
        let corners = [at(round, about), at(round, about + 1), at(round + 1, about + 1), at(round + 1, about)];
        text += &format!("f {} {} {} {}\n", corners[0], corners[1], corners[2], corners[3]);
    }
    let file = folder.path().join("ring.obj");
    std::fs::write(&file, text).expect("written");
    let ring = open(&OpenSpec::new(file.to_str().expect("a path"))).expect("a scene");
    let mut made = Made::of_scene(ring, "z-fail", &[], [640, 480]);
    let slowest = assert_same_histories(&mut made, "70 688 triangles");
    println!("70 688 triangles: the slowest of 100 histories {slowest:.1} ms");
    assert!(slowest < 300.0, "{slowest} ms");
}

#[test]
fn nothing_is_loaded_and_nothing_could_be() {
    let made = tori();
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "#pixel=322,92&step=2");
    let own = format!("file://{}", made.page().display());
    let asked: Vec<String> = browser
        .requests()
        .into_iter()
        .filter(|address| !address.starts_with(&own) && address != "about:blank")
        .collect();
    assert_eq!(asked, Vec::<String>::new());
    assert_eq!(browser.complaints(), Vec::<String>::new());
    // The policy blocks what an extension, or a mistake, could add.
    for attempt in [
        "fetch('http://127.0.0.1:9/').then(() => 'loaded', () => 'refused')",
        "new Promise((done) => { const one = new Image(); one.onload = () => done('loaded'); one.onerror = () => done('refused'); one.src = 'http://127.0.0.1:9/'; })",
        "new Promise((done) => { const one = document.createElement('script'); one.textContent = 'window.ran = true'; document.body.append(one); setTimeout(() => done(window.ran ? 'loaded' : 'refused'), 50); })",
    ] {
        assert_eq!(browser.evaluate(attempt), json!("refused"), "{attempt}");
    }
    let refusals = browser.complaints();
    assert!(refusals.iter().filter(|text| text.contains("Content Security Policy")).count() >= 3, "{refusals:?}");
}

#[test]
fn keys_step_and_the_address_goes_to_the_pixel() {
    let made = tori();
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "");
    let steps = &made.frame.capture.steps;
    let place = |browser: &mut Browser| browser.text("#place");
    assert!(place(&mut browser).starts_with("Step 1: ambient"));
    for step in &steps[1..] {
        browser.press("ArrowRight", false);
        assert!(place(&mut browser).to_lowercase().contains(&step.name), "{}", step.name);
    }
    browser.press("ArrowRight", false);
    assert!(place(&mut browser).starts_with("Step 3: light"), "there is none after the last");
    for _ in 0..2 {
        browser.press("ArrowLeft", false);
    }
    assert!(place(&mut browser).starts_with("Step 2: volumes · after its 15 draws"));
    // Down into the draws, the last one from below, and out of them again.
    browser.press("ArrowDown", false);
    assert!(place(&mut browser).contains(&format!("after draw 1, {}", steps[1].draws[0].name)));
    browser.press("ArrowUp", false);
    assert!(place(&mut browser).contains("draw 1,"), "there is none before the first");
    browser.press("ArrowDown", false);
    assert!(place(&mut browser).contains(&format!("after draw 2, {}", steps[1].draws[1].name)));
    // A click picks, Shift and arrows move the pick, keys choose view and phase.
    browser.click_at([322, 92], [640, 480]);
    browser.press("ArrowDown", true);
    browser.press("ArrowRight", true);
    browser.press("3", false);
    browser.press("d", false);
    assert_eq!(browser.evaluate("location.hash"), json!("#pixel=323,93&step=2&draw=2&view=stencil&phase=diff"));
    let looked = "[document.querySelector('#told').textContent, document.querySelector('#hover').textContent, document.querySelector('#place').textContent]";
    browser.call("Input.dispatchMouseEvent", json!({"type": "mouseMoved", "x": 2, "y": 2}));
    let seen = browser.evaluate(looked);
    let mut other = Browser::new(WIDE, "light");
    other.open(&made.page(), "#pixel=323,93&step=2&draw=2&view=stencil&phase=diff");
    assert_eq!(other.evaluate(looked), seen, "a link goes to this pixel of this draw");
    browser.press("Escape", false);
    assert_eq!(browser.evaluate("location.hash"), json!("#step=2&draw=2&view=stencil&phase=diff"));
    for nonsense in ["#pixel=9999,3&step=77&view=x&draw=y", "#%", "#pixel=-1,1e3&light=9"] {
        other.open(&made.page(), nonsense);
        assert!(place(&mut other).starts_with("Step 1: ambient"), "{nonsense}");
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
    assert_eq!(other.complaints(), Vec::<String>::new());
}

/// Texel and reader point at each other as in the window, also where each texel has a depth of its own.
#[test]
fn a_clicked_texel_reports_the_pixels_that_read_it_and_a_pixel_what_it_is_compared_with() {
    let size = [160, 120];
    for (filter, by_plane) in [("pcf:3", "off"), ("pcf:3", "on"), ("pcf:2", "on")] {
        let settings = [("size", "64"), ("filter", filter), ("bias-receiver-plane", by_plane)];
        let made = Made::of_scene(scene("tori"), "shadow-map", &settings, size);
        let readers = MapReaders::new(&made.frame.capture, Some(&made.frame.plan), 0).expect("a map");
        let mut browser = Browser::new(WIDE, "dark");
        let places = pixels(40, size);
        let read = places.iter().filter_map(|pixel| Some((*pixel, readers.texel_of(*pixel)?)));
        let read: Vec<([u32; 2], MapTexel)> = read.take(8).collect();
        assert_eq!(read.len(), 8, "pixels that read a texel");
        for (pixel, texel) in read {
            browser.open(&made.page(), &format!("#pixel={},{}", pixel[0], pixel[1]));
            let rows = "[...document.querySelectorAll('.reads tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))";
            let rows: Vec<[String; 4]> = serde_json::from_value(browser.evaluate(rows)).expect("rows of four");
            let compared = readers.compared(pixel);
            assert_eq!(rows.len(), compared.len(), "{pixel:?}");
            for ([place, _, depth, _], (texel, expected)) in rows.iter().zip(compared) {
                assert_eq!(*place, format!("{}, {}", texel.at[0], texel.at[1]), "{pixel:?}");
                let depth: f64 = depth.parse().expect("a depth");
                assert!((depth - expected).abs() < 1e-6, "{pixel:?}, {place}: {depth} and not {expected}");
            }
            browser.evaluate("document.querySelector('.reads button').click()");
            browser.click_at(texel.at, [64, 64]);
            let of_texel = readers.of_texel(texel);
            assert!(of_texel.contains(&pixel));
            let digits: String = browser.text(".texel p").chars().filter(char::is_ascii_digit).collect();
            assert_eq!(digits, of_texel.len().to_string(), "{texel:?}");
            browser.evaluate("document.querySelector('.texel button').click()");
            let marks = browser.evaluate("document.querySelector('#marks .linked').getAttribute('d')");
            let expected: String = of_texel.iter().map(|[x, y]| format!("M{x} {y}h1v1h-1z")).collect();
            assert_eq!(marks, json!(expected), "{texel:?}");
        }
        assert_eq!(browser.complaints(), Vec::<String>::new());
    }
}

/// The link to a live window, where a page has one.
const LIVE_LINK: &str = "document.querySelector('header a')?.href ?? null";

#[test]
fn a_button_opens_the_selected_step_and_pixel_in_a_live_window_that_is_configured() {
    let made = tori();
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "#pixel=322,92&step=2");
    assert_eq!(browser.evaluate(LIVE_LINK), Value::Null);
    // Nothing listens there: it is enough that the browser goes to it.
    let address = "http://127.0.0.1:9/?scene=tori&technique=z-fail&size=640x480";
    page::write(&made.frame.capture, &made.frame.plan, Some(address), &made.page()).expect("a page");
    browser.open(&made.page(), "");
    assert_eq!(browser.evaluate(LIVE_LINK), json!(format!("{address}&step=0")));
    browser.press("ArrowRight", false);
    browser.click_at([322, 92], [640, 480]);
    let href = browser.evaluate(LIVE_LINK).as_str().expect("an address").to_owned();
    assert_eq!(href, format!("{address}&step=1&pixel=322,92"));
    let link = ViewLink::parse(href.split_once('?').expect("a query").1).0;
    assert_eq!((link.step, link.pixel, link.size), (Some(1), Some([322, 92]), Some([640, 480])));
    let place = "(() => { const { left, top, width, height } = document.querySelector('header a').getBoundingClientRect(); return [left + width / 2, top + height / 2]; })()";
    let place: [f64; 2] = serde_json::from_value(browser.evaluate(place)).expect("a place");
    for kind in ["mousePressed", "mouseReleased"] {
        browser.button(kind, place, "left");
    }
    browser.evaluate("new Promise((done) => setTimeout(done, 200))");
    let opened = |event: &Value| event["method"] == json!("Page.windowOpen") && event["params"]["url"] == json!(href);
    assert!(browser.events.iter().any(opened), "a click opens a window beside the page");
    browser.press("Escape", false);
    assert_eq!(browser.evaluate(LIVE_LINK), json!(format!("{address}&step=1")));
    assert_eq!(browser.complaints(), Vec::<String>::new());
    for theme in ["dark", "light"] {
        let mut phone = Browser::new(PHONE, theme);
        phone.open(&made.page(), "");
        assert_eq!(phone.evaluate(CONTRASTS), json!([]), "{theme}");
        assert_eq!(phone.evaluate("document.documentElement.scrollWidth <= innerWidth"), json!(true), "{theme}");
    }
}

#[test]
fn text_of_a_scene_is_text() {
    let mut named = scene("tori");
    named.name = "</script><script>window.ran = true</script><!-- {{script}} & \"it\" \u{2028}".to_owned();
    named.objects[0].name = "<img src=x onerror='window.ran = true'>".to_owned();
    let name = named.name.clone();
    let made = Made::of_scene(named, "z-fail", &[], [64, 48]);
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "#pixel=30,30");
    assert_eq!(browser.text("#title"), format!("{name}, z-fail"));
    assert_eq!(browser.evaluate("[window.ran ?? null, document.querySelectorAll('img').length]"), json!([null, 0]));
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

/// What a page lacks it says, and shows what it has.
#[test]
fn a_page_that_is_broken_says_what_it_lacks() {
    let made = tori();
    let whole = std::fs::read_to_string(made.page()).expect("the page");
    let module = page::module();
    let pixels = "Nothing is known of pixels here";
    let cases = [
        // Zlib's form of nothing.
        (module.as_str(), "eJwDAAAAAAE=", pixels),
        (" 'wasm-unsafe-eval'", "", pixels),
        ("\"mesh001.indices.npy\":", "\"mesh001.npy\":", "mesh001.indices.npy"),
        ("\"frame.json\":", "\"no.json\":", "This frame can't be shown"),
    ];
    for (part, broken, said) in cases {
        assert!(whole.contains(part), "{said}");
        std::fs::write(made.page(), whole.replacen(part, broken, 1)).expect("written");
        let mut browser = Browser::new(WIDE, "dark");
        browser.open_until(
            &made.page(),
            "#pixel=322,92&step=2",
            &format!("document.querySelector('#told')?.textContent.includes({})", json!(said)),
        );
        let has_picture = browser.evaluate("document.querySelector('#picture').width === 640");
        assert_eq!(has_picture, json!(!said.starts_with("This frame")), "{said}");
    }
}

/// The one that the README links to.
#[test]
fn the_committed_page_is_what_the_program_makes() {
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/pages/tori.html");
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&committed, "#pixel=322,92&step=2");
    assert!(browser.text("#told").contains("Dark under light 1: its stencil count is 2."));
    assert!(browser.text(".agrees").contains("as the GPU stored it"));
    assert_eq!(browser.complaints(), Vec::<String>::new());
    let script = page::script();
    let text = std::fs::read_to_string(committed).expect("the page");
    assert!(text.contains(&script), "made by an older program: see its command in assets/pages/README.md");
}
