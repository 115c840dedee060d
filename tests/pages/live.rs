//! The live window in a browser, driven by mouse and keys: `.ci/web` makes it and runs these.

use crate::browser::Browser;
use crate::made::scene;
use crate::site::Site;
use serde::Deserialize;
use serde_json::json;
use std::path::Path;
use std::time::{Duration, Instant};
use stencilscope::capture::{Capture, Image, Snapshot, disk};
use stencilscope::link::ViewLink;
use stencilscope::scene::builtin;
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};

const WIDE: [u32; 2] = [1280, 800];
const PHONE: [u32; 2] = [390, 844];
/// How many buffers of the size of its colours a picture of tori by z-fail is read back in: two of colour, one of depth.
const BUFFERS_OF_A_PICTURE: f64 = 3.0;
/// How long anything may take that the tests wait for.
const PATIENCE: Duration = Duration::from_secs(60);

/// A widget of the panels, as the page's accessibility tree describes it.
#[derive(Debug, Clone, Deserialize)]
struct Widget {
    role: String,
    label: Option<String>,
    value: Option<String>,
    bounds: Option<[f64; 4]>,
}

impl Widget {
    /// Returns whether it is the widget of that role and label.
    fn is(&self, role: &str, label: &str) -> bool {
        self.role == role && self.label.as_deref() == Some(label)
    }

    /// Its text, which is the value of a label.
    fn text(&self) -> &str {
        self.label.as_deref().filter(|label| !label.is_empty()).or(self.value.as_deref()).unwrap_or_default()
    }

    fn says(&self, text: &str) -> bool {
        self.text().contains(text)
    }

    fn middle(&self) -> [f64; 2] {
        let [left, top, right, bottom] = self.bounds.expect("a place");
        [left + (right - left) / 2.0, top + (bottom - top) / 2.0]
    }
}

/// The page of the live window in a browser.
struct LiveWindow {
    browser: Browser,
    site: Site,
}

impl LiveWindow {
    /// A browser with WebGPU, and nothing open.
    fn new(size: [u32; 2], theme: &str) -> LiveWindow {
        LiveWindow::of(Browser::with_webgpu(size, theme))
    }

    fn of(browser: Browser) -> LiveWindow {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/web");
        LiveWindow { browser, site: Site::of(&folder) }
    }

    /// Opens the page with a query, and waits for the first picture; returns how long that took.
    fn open(&mut self, query: &str) -> Duration {
        let address = self.site.address(query);
        self.browser.visit(&address, "document.getElementById('window') !== null && document.title !== 'stencilscope'")
    }

    /// The widgets of a frame that is drawn now.
    fn tree(&mut self) -> Vec<Widget> {
        let began = Instant::now();
        loop {
            let text = self.browser.evaluate(
                "new Promise((done) => { stencilscope.tree(); requestAnimationFrame(() => \
                 requestAnimationFrame(() => done(stencilscope.tree()))); })",
            );
            let tree: Vec<Widget> = serde_json::from_str(text.as_str().expect("text")).expect("widgets");
            if !tree.is_empty() {
                return tree;
            }
            assert!(began.elapsed() < PATIENCE, "no tree: {:?}", self.browser.complaints());
        }
    }

    /// Waits for a widget.
    fn wait_for(&mut self, what: &str, is_it: impl Fn(&Widget) -> bool) -> Widget {
        let began = Instant::now();
        loop {
            let tree = self.tree();
            if let Some(widget) = tree.iter().find(|widget| is_it(widget)) {
                return widget.clone();
            }
            if began.elapsed() > PATIENCE {
                let texts: Vec<_> = tree.iter().map(Widget::text).collect();
                panic!("no {what} among {texts:?}; {:?}", self.browser.complaints());
            }
        }
    }

    fn wait_for_text(&mut self, text: &str) -> Widget {
        self.wait_for(text, |widget| widget.says(text))
    }

    /// Clicks a widget, once it is there.
    fn click(&mut self, role: &str, label: &str) {
        let place = self.wait_for(label, |widget| widget.is(role, label)).middle();
        self.browser.move_to(place, "none");
        self.browser.click(place, "left");
    }

    /// Picks a pixel of the picture, which lies in the middle of its canvas as large as fits.
    fn pick(&mut self, pixel: [u32; 2], size: [u32; 2]) {
        let canvas = self.wait_for("picture", |widget| widget.says("Picture canvas")).bounds.expect("a place");
        let sides = [canvas[2] - canvas[0], canvas[3] - canvas[1]];
        let size = size.map(f64::from);
        let scale = (sides[0] / size[0]).min(sides[1] / size[1]);
        // A mouse's places are whole points, and the picture begins at a whole pixel: of the two or more points of a pixel, one
        // that is within both ways.
        let place = [0, 1].map(|axis| {
            (canvas[axis] + sides[axis] / 2.0 + (f64::from(pixel[axis]) - size[axis] / 2.0) * scale + 1.6).floor()
        });
        self.browser.move_to(place, "none");
        // As a person does, it rests there for a frame.
        self.tree();
        self.browser.click(place, "right");
    }

    /// Exports by the menu, and returns the download: its name and bytes.
    fn export(&mut self, kind: &str) -> (String, Vec<u8>) {
        self.browser.evaluate(
            "stencilscope.download = (name, bytes) => { let text = ''; for (let at = 0; at < bytes.length; at += 32768) \
             text += String.fromCharCode(...bytes.subarray(at, at + 32768)); globalThis.saved = [name, btoa(text)]; }; \
             globalThis.saved = null",
        );
        self.click("Button", "Export");
        self.click("Button", kind);
        self.click("Button", "Save");
        self.browser.wait_until("globalThis.saved !== null");
        let saved = self.browser.evaluate("globalThis.saved");
        let text = saved[1].as_str().expect("bytes");
        let bytes = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, text).expect("base64");
        (saved[0].as_str().expect("a name").to_owned(), bytes)
    }

    /// Drops files or folders onto the page.
    fn drop_files(&mut self, paths: &[&Path]) {
        let files: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        for kind in ["dragEnter", "dragOver", "drop"] {
            let data = json!({"items": [], "files": files, "dragOperationsMask": 1});
            self.browser.call("Input.dispatchDragEvent", json!({"type": kind, "x": 640, "y": 400, "data": data}));
        }
    }

    /// Stores what the page looks like, in target/web-pictures.
    fn picture_of(&mut self, name: &str) {
        let picture = self.browser.screenshot();
        let bytes = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, picture).expect("base64");
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/web-pictures");
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join(format!("{name}.png")), bytes).expect("written");
    }
}

/// A capture natively, on the rasteriser that the browser brings.
fn captured(session: &mut Session, name: &str, technique: Technique, size: [u32; 2]) -> Capture {
    session.capture(&scene(name), &CaptureRequest::new(Choice::new(technique), size)).expect("a capture")
}

fn native() -> Session {
    Session::new(Some("SwiftShader")).expect("SwiftShader: .ci/web names it in VK_DRIVER_FILES")
}

/// How many bytes of two images differ: none where they are equal.
fn different(own: &Image, other: &Image) -> usize {
    assert_eq!((own.size(), own.format()), (other.size(), other.format()));
    own.rows().zip(other.rows()).flat_map(|(a, b)| a.iter().zip(b)).filter(|(a, b)| a != b).count()
}

/// Names of the pictures in which two captures differ, each with the number of bytes.
fn differences(browser: &Capture, native: &Capture) -> Vec<String> {
    assert_eq!(browser.steps.len(), native.steps.len());
    let mut pairs: Vec<(String, &Image, &Image)> = Vec::new();
    for (own, other) in browser.steps.iter().zip(&native.steps) {
        assert_eq!(own.name, other.name);
        match (&own.snapshot, &other.snapshot) {
            (Snapshot::Frame(a), Snapshot::Frame(b)) => {
                pairs.push((format!("{} colour", own.name), &a.color.image, &b.color.image));
                pairs.push((format!("{} depth", own.name), &a.depth.image, &b.depth.image));
                assert_eq!(a.stencil.is_some(), b.stencil.is_some());
                let stencils = a.stencil.iter().zip(&b.stencil);
                pairs.extend(stencils.map(|(a, b)| (format!("{} stencil", own.name), &*a.image, &*b.image)));
            }
            (Snapshot::Map { light, face }, Snapshot::Map { .. }) => {
                let [a, b] =
                    [browser, native].map(|capture| &capture.lights[*light].map.as_ref().expect("a map").faces);
                pairs.push((format!("{} map", own.name), &a[*face], &b[*face]));
            }
            _ => panic!("{}: another kind of picture", own.name),
        }
    }
    let counted = pairs.into_iter().map(|(name, a, b)| (name, different(a, b)));
    counted.filter(|(_, bytes)| *bytes > 0).map(|(name, bytes)| format!("{name}: {bytes} bytes")).collect()
}

/// The capture in a downloaded archive.
fn unzipped(bytes: &[u8]) -> Capture {
    let folder = tempfile::tempdir().expect("a folder");
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
    archive.extract(folder.path()).expect("files");
    let inner = std::fs::read_dir(folder.path()).expect("a folder").next().expect("the capture").expect("an entry");
    disk::read(&inner.path()).expect("a capture")
}

#[test]
fn the_first_picture_comes_within_five_seconds() {
    let took = LiveWindow::new(WIDE, "dark").open("");
    println!("the first picture came after {} ms", took.as_millis());
    assert!(took < Duration::from_secs(5), "{took:?}");
}

/// What is stored after every pass is what the native program stores on the same rasteriser.
#[test]
fn captures_are_the_native_ones_to_the_last_byte() {
    let mut session = native();
    // Low, as a CPU draws it.
    let mut window = LiveWindow::new([1280, 480], "dark");
    let mut wrong = Vec::new();
    let mut count = 0;
    for builtin in builtin::ALL {
        window.open(&format!("?scene={}&technique=none&size=320x240", builtin.name));
        for technique in Technique::ALL.into_iter().filter(|technique| *technique != Technique::RayTraced) {
            let title = format!("{} · {} — stencilscope", builtin.name, technique.name());
            if technique != Technique::None {
                window.click("Button", technique.name());
            }
            window.browser.wait_until(&format!("document.title === {}", json!(title)));
            let (name, bytes) = window.export("Capture folder…");
            assert!(name.ends_with(".zip"), "{name}");
            let native = captured(&mut session, builtin.name, technique, [320, 240]);
            let found = differences(&unzipped(&bytes), &native);
            wrong.extend(found.into_iter().map(|what| format!("{} {}: {what}", builtin.name, technique.name())));
            println!("{} {}: {} bytes", builtin.name, technique.name(), bytes.len());
            count += 1;
        }
    }
    println!("{count} captures were compared");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_link_opens_a_pixel_of_a_step_and_is_shared_again() {
    let mut window = LiveWindow::new(WIDE, "dark");
    window.open("?scene=inside&technique=z-pass&step=1&pixel=330,300&size=640x480&eye=0,1.5,6");
    window.wait_for_text("330, 300");
    window.wait_for_text("step 2 of 3");
    window.browser.evaluate(
        "globalThis.copied = ''; navigator.clipboard.writeText = async (text) => { globalThis.copied = text; }",
    );
    window.click("Button", "Share");
    window.browser.wait_until("globalThis.copied !== ''");
    let copied = window.browser.evaluate("globalThis.copied");
    let query = copied.as_str().and_then(|link| link.split_once('?')).expect("a query").1.to_owned();
    let (link, problems) = ViewLink::parse(&query);
    assert_eq!((problems, link.camera.eye.map(|eye| eye.to_array())), (Vec::new(), Some([0.0, 1.5, 6.0])));
    assert_eq!((link.scene.as_deref(), link.technique.as_deref()), (Some("inside"), Some("z-pass")));
    assert_eq!((link.step, link.pixel, link.size), (Some(1), Some([330, 300]), Some([640, 480])));
    window.wait_for_text("copied a link");
}

#[test]
fn a_link_that_can_not_be_read_says_so_and_opens_something() {
    let mut window = LiveWindow::new(WIDE, "dark");
    window.open("?scene=tory");
    window.wait_for_text("did you mean `tori`?");
    // The rest of it is opened.
    window.open("?scene=inside&technique=z-pass&colour=blue&pixel=many");
    window.wait_for_text("`colour` means nothing here");
    window.wait_for_text("`pixel=many` can't be used");
    assert_eq!(window.browser.evaluate("document.title"), json!("inside · z-pass — stencilscope"));
}

/// A hundred pixels of several techniques: their histories are the native ones, and agree with what was stored.
#[test]
fn histories_agree_with_what_was_stored() {
    let mut session = native();
    let mut window = LiveWindow::new(WIDE, "dark");
    let size = [320, 240];
    let mut count_of_pixels = 0;
    for (name, technique) in [("tori", "z-fail"), ("inside", "z-pass"), ("two-lights", "auto"), ("table", "shadow-map")]
    {
        window.open(&format!("?scene={name}&technique={technique}&size=320x240"));
        let technique = Technique::from_name(technique).expect("a technique");
        let request = CaptureRequest::new(Choice::new(technique), size);
        let (capture, plan) = session.capture_with_plan(&scene(name), &request).expect("a frame");
        // At its sides the picture lies under the handles by which panels are resized.
        let pixels = crate::made::pixels(40, size).into_iter();
        for [x, y] in pixels.filter(|[x, y]| (10..310).contains(x) && (10..230).contains(y)).take(25) {
            count_of_pixels += 1;
            // What is said of the pixel before is gone then.
            window.browser.press("Escape", false);
            window.wait_for_text("No pixel is picked.");
            window.pick([x, y], size);
            window.wait_for(&format!("pixel {x}, {y}"), |widget| widget.text() == format!("{x}, {y}"));
            let count = session.history(&plan, &capture, [x, y]).expect("a history").events.len();
            let [all, some] = [format!("{count} event"), format!(" of {count} event")];
            window.wait_for("its events", |widget| {
                let label = widget.text().trim_end_matches('s');
                label == all || label.ends_with(&some)
            });
            let said =
                window.wait_for("a check", |widget| widget.says("as the GPU stored it") || widget.says("is wrong"));
            assert!(!said.says("is wrong"), "{name} at {x}, {y}");
        }
    }
    assert_eq!(count_of_pixels, 100);
}

/// A light that is dragged is followed: by pictures of 640×360 pixels.
#[test]
fn a_dragged_light_is_followed() {
    const SECONDS: f64 = 6.0;
    let mut window = LiveWindow::new(WIDE, "dark");
    window.open("?scene=tori&technique=z-fail&size=640x360");
    // Where egui's shader asks otherwise, nothing is found in it to take out.
    assert_eq!(window.browser.evaluate("globalThis.stencilscope.hasSimplified"), json!(true));
    // Colours and depths of passes are read back.
    window.browser.evaluate(
        "globalThis.buffers = 0; const map = GPUBuffer.prototype.mapAsync; GPUBuffer.prototype.mapAsync = function (...a) { \
         if (this.size === 640 * 360 * 4) globalThis.buffers += 1; return map.apply(this, a); };",
    );
    let light = window.wait_for("the handle", |widget| widget.says("Light 1 in the picture")).middle();
    let before = window.browser.evaluate("globalThis.buffers").as_f64().expect("a number");
    window.browser.move_to(light, "none");
    window.browser.button("mousePressed", light, "left");
    let began = Instant::now();
    let mut moves = 0;
    while began.elapsed().as_secs_f64() < SECONDS {
        moves += 1;
        let along = f64::from(moves % 40) - 20.0;
        window.browser.move_to([light[0] + along, light[1] + along / 2.0], "left");
        std::thread::sleep(Duration::from_millis(16));
    }
    window.browser.button("mouseReleased", light, "left");
    let after = window.browser.evaluate("globalThis.buffers").as_f64().expect("a number");
    let rate = (after - before) / BUFFERS_OF_A_PICTURE / SECONDS;
    println!("{rate:.1} pictures a second while a light is dragged");
    assert!(rate >= 5.0, "{rate}");
}

#[test]
fn dropped_files_open() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut window = LiveWindow::new(WIDE, "dark");
    window.open("");
    let model = root.join("assets/models/knot.obj");
    window.drop_files(&[&model]);
    window.browser.wait_until("document.title.startsWith('knot ')");
    // A capture folder, as it is and packed.
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("mine");
    let mut session = native();
    let frame = session
        .render(scene("glass"), CaptureRequest::new(Choice::new(Technique::ZFail), [320, 240]))
        .expect("a frame");
    disk::write(frame.contents(), &capture, false).expect("written");
    window.drop_files(&[&capture]);
    window.browser.wait_until("document.title.startsWith('glass ')");
    // What can't be opened is refused in a sentence, and what is open stays.
    let text = folder.path().join("notes.txt");
    std::fs::write(&text, "nothing").expect("written");
    window.drop_files(&[&text]);
    window.wait_for_text("none of these files can be opened");
    let large = folder.path().join("large.obj");
    std::fs::File::create(&large).and_then(|file| file.set_len(600 << 20)).expect("a sparse file");
    window.drop_files(&[&large]);
    window.wait_for_text("a page holds at most 512 MiB");
    assert!(window.browser.evaluate("document.title").as_str().expect("a title").starts_with("glass "));
}

#[test]
fn exports_are_downloads() {
    let mut window = LiveWindow::new(WIDE, "dark");
    window.open("?scene=tori&technique=z-fail&size=320x240");
    let (name, bytes) = window.export("Scene file (TOML)…");
    assert_eq!(name, "tori.zip");
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
    assert!(archive.file_names().any(|name| name == "tori.toml"));
    assert!(archive.by_index(0).is_ok());
    let (name, bytes) = window.export("Shown picture (PNG)…");
    assert!(name.ends_with(".png") && bytes.starts_with(b"\x89PNG"), "{name}");
    // As the browser saves it.
    let folder = tempfile::tempdir().expect("a folder");
    window.open("?scene=tori&technique=z-fail&size=320x240");
    let behavior = json!({"behavior": "allow", "downloadPath": folder.path().display().to_string()});
    window.browser.call("Page.setDownloadBehavior", behavior);
    for label in ["Export", "Page (HTML)…", "Save"] {
        window.click("Button", label);
    }
    window.wait_for_text("open it in a browser");
    let began = Instant::now();
    let page = folder.path().join("tori-z-fail.html");
    while !page.is_file() {
        assert!(began.elapsed() < PATIENCE, "{:?}", std::fs::read_dir(folder.path()).map(Iterator::count));
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(std::fs::read_to_string(page).expect("a page").starts_with("<!doctype html>"));
}

/// The page answers events while the truth of a large picture is traced.
#[test]
fn the_page_stays_alive_while_truth_is_traced() {
    let mut window = LiveWindow::new(WIDE, "dark");
    window.open("?scene=tori&technique=z-fail&size=1280x720");
    window.browser.evaluate(
        "globalThis.longest = 0; globalThis.turns = 0; { let last = performance.now(); const channel = new MessageChannel(); \
         channel.port1.onmessage = () => { const now = performance.now(); globalThis.turns += 1; globalThis.longest = \
         Math.max(globalThis.longest, now - last); last = now; channel.port2.postMessage(0); }; channel.port2.postMessage(0); }",
    );
    window.click("Button", "Error");
    // The status bar says what is shown, once it is known.
    window.wait_for_text("error of light 1");
    assert!(window.browser.evaluate("globalThis.turns").as_f64() > Some(100.0));
    let longest = window.browser.evaluate("globalThis.longest").as_f64().expect("a number");
    println!("the page was held for {longest} ms at most");
    assert!(longest < 200.0, "{longest} ms");
}

#[test]
fn a_browser_without_webgpu_says_what_it_lacks() {
    let mut window = LiveWindow::of(Browser::new(WIDE, "light"));
    let address = window.site.address("");
    window.browser.visit(&address, "document.getElementById('state')?.className === 'failed'");
    assert!(window.browser.text("#state").contains("no WebGPU"));
    assert!(
        window.browser.evaluate("document.querySelector('a').href").as_str().expect("a link").ends_with("tori.html")
    );
    window.picture_of("no-webgpu");
}

#[test]
fn a_lost_gpu_is_said() {
    let mut window = LiveWindow::new(WIDE, "dark");
    window.open("?scene=tori&technique=z-fail&size=320x240");
    window.browser.crash_gpu();
    window.browser.wait_until("document.getElementById('state')?.className === 'failed'");
    assert!(window.browser.text("#state").contains("lost the GPU"));
}

/// Pictures to look at, in target/web-pictures: wide and of a phone, dark and light.
#[test]
fn it_fits_a_screen_and_a_phone() {
    for (size, name) in [(WIDE, "wide"), (PHONE, "phone")] {
        for theme in ["dark", "light"] {
            let mut window = LiveWindow::new(size, theme);
            window.open("?scene=tori&technique=z-fail&pixel=300,200&size=640x360");
            window.wait_for_text("as the GPU stored it");
            window.picture_of(&format!("{name}-{theme}"));
        }
    }
}
