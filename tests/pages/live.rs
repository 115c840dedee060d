//! The live window in a browser, driven by mouse and keys: `.ci/web` makes it and runs these.

use crate::browser::Browser;
use crate::made::scene;
use crate::site::Site;
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::Path;
use std::time::{Duration, Instant};
use stencilscope::capture::{Capture, Image, Snapshot};
use stencilscope::scene::builtin;
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};

const WIDE: [u32; 2] = [1280, 800];
const PHONE: [u32; 2] = [390, 844];
/// How long anything may take that the tests wait for.
const PATIENCE: Duration = Duration::from_secs(60);

/// A widget of the panels, as the page's accessibility tree describes it.
#[derive(Debug, Clone, Deserialize)]
struct Widget {
    role: String,
    label: Option<String>,
    value: Option<String>,
    bounds: Option<[f64; 4]>,
    is_selected: Option<bool>,
}

impl Widget {
    fn is(&self, role: &str, label: &str) -> bool {
        self.role == role && self.label.as_deref() == Some(label)
    }

    fn says(&self, text: &str) -> bool {
        [&self.label, &self.value].into_iter().flatten().any(|own| own.contains(text))
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
        self.browser.visit(&address, "document.title !== 'stencilscope'")
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
                let texts: Vec<_> = tree.iter().filter_map(|widget| widget.label.as_ref().or(widget.value.as_ref())).collect();
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
        ["mousePressed", "mouseReleased"].map(|kind| self.browser.button(kind, place, "left"));
    }

    /// The pixel's place in the page: the picture is the widget of that role.
    fn click_pixel(&mut self, [x, y]: [u32; 2], [width, height]: [u32; 2]) {
        let [left, top, right, bottom] = self.picture(width, height);
        let at = |from: f64, to: f64, index: u32, count: u32| from + (f64::from(index) + 0.5) * (to - from) / f64::from(count);
        let place = [at(left, right, x, width), at(top, bottom, y, height)];
        self.browser.move_to(place, "none");
        ["mousePressed", "mouseReleased"].map(|kind| self.browser.button(kind, place, "right"));
    }

    /// Bounds of the picture in the page, which fills its panel in its own proportions.
    fn picture(&mut self, width: u32, height: u32) -> [f64; 4] {
        let [left, top, right, bottom] = self.wait_for("picture", |widget| widget.role == "Image").bounds.expect("a place");
        let _ = (width, height);
        [left, top, right, bottom]
    }

    /// Exports by the menu, and returns the bytes of the download.
    fn export(&mut self, kind: &str) -> (String, Vec<u8>) {
        self.browser.evaluate(
            "stencilscope.download = (name, bytes) => { let text = ''; for (let i = 0; i < bytes.length; i += 32768) \
             text += String.fromCharCode(...bytes.subarray(i, i + 32768)); globalThis.saved = [name, btoa(text)]; }; \
             globalThis.saved = null",
        );
        self.click("Button", "Export");
        self.click("Button", kind);
        self.click("Button", "Save");
        self.browser.wait_until("globalThis.saved !== null");
        let saved = self.browser.evaluate("globalThis.saved");
        let bytes = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, saved[1].as_str().expect("bytes"));
        (saved[0].as_str().expect("a name").to_owned(), bytes.expect("base64"))
    }
}
