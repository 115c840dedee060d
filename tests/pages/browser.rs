//! A headless browser, spoken to in its own protocol (Chrome DevTools) over a pipe: JSON, each message ended by a zero.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// No answer takes longer than that.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub struct Browser {
    process: Child,
    orders: ChildStdin,
    messages: Receiver<Value>,
    /// Events that the browser sent without being asked.
    pub events: Vec<Value>,
    session: Option<String>,
    number: u64,
    _profile: TempDir,
}

/// What lets a browser draw by WebGPU, and show what is drawn, on the rasteriser that it brings.
const BY_SOFTWARE: [&str; 5] = [
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--use-angle=swiftshader",
];

impl Browser {
    /// Starts a browser without a GPU, with an empty page of that many CSS pixels, and the system's theme `dark` or
    /// `light`.
    pub fn new(size: [u32; 2], theme: &str) -> Browser {
        Browser::start(size, theme, &["--disable-gpu"])
    }

    /// Starts one that has WebGPU, by software.
    pub fn with_webgpu(size: [u32; 2], theme: &str) -> Browser {
        Browser::start(size, theme, &BY_SOFTWARE)
    }

    fn start([width, height]: [u32; 2], theme: &str, flags: &[&str]) -> Browser {
        let profile = tempfile::tempdir().expect("a folder");
        let mut command = Command::new("sh");
        // It reads orders from 3 and answers on 4. As root it has no sandbox to go into.
        command.args(["-c", r#"exec chromium "$@" 3<&0 4>&1 >/dev/null 2>&1 </dev/null"#, "chromium"]);
        command.args(["--headless", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run"]).args(flags);
        command.arg(format!("--user-data-dir={}", profile.path().display()));
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("chromium (.ci/pages)");
        let orders = process.stdin.take().expect("a pipe");
        let mut answers = BufReader::new(process.stdout.take().expect("a pipe"));
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            while answers.read_until(0, &mut bytes).is_ok_and(|count| count > 0) {
                let message = serde_json::from_slice(bytes.strip_suffix(&[0]).unwrap_or(&bytes)).expect("JSON");
                if sender.send(message).is_err() {
                    break;
                }
                bytes.clear();
            }
        });
        let (events, session) = (Vec::new(), None);
        let mut browser = Browser { process, orders, messages, events, session, number: 0, _profile: profile };
        let page = browser.call("Target.createTarget", json!({"url": "about:blank"}))["targetId"].clone();
        let session = browser.call("Target.attachToTarget", json!({"targetId": page, "flatten": true}));
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network", "Accessibility"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        let screen = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600});
        browser.call("Emulation.setDeviceMetricsOverride", screen);
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": theme}]});
        browser.call("Emulation.setEmulatedMedia", features);
        browser
    }

    /// Asks, and waits for the answer.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.number += 1;
        let mut order = json!({"id": self.number, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            order["sessionId"] = json!(session);
        }
        self.orders.write_all(format!("{order}\0").as_bytes()).expect("the browser listens");
        loop {
            let message = self.messages.recv_timeout(PATIENCE).expect("the browser answers");
            if message["id"] != json!(self.number) {
                self.events.push(message);
                continue;
            }
            assert!(message["error"].is_null(), "{method}: {}", message["error"]);
            return message["result"].clone();
        }
    }

    /// Ends the process that speaks to the GPU, as a driver does that fails.
    pub fn crash_gpu(&mut self) {
        // It is asked of the browser and not of the page. Nothing is answered where it has happened.
        let page = self.session.take();
        self.number += 1;
        let order = json!({"id": self.number, "method": "Browser.crashGpuProcess", "params": {}});
        self.orders.write_all(format!("{order}\0").as_bytes()).expect("the browser listens");
        self.session = page;
    }

    /// The value of an expression of JavaScript.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let order = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", order);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Opens a file at a fragment of its address, and waits until all of it is there.
    pub fn open(&mut self, file: &Path, fragment: &str) {
        self.open_until(file, fragment, "performance.getEntriesByName('whole').length === 1");
    }

    /// Opens a file at a fragment of its address, and waits until an expression of JavaScript holds.
    pub fn open_until(&mut self, file: &Path, fragment: &str, holds: &str) {
        self.visit(&format!("file://{}{fragment}", file.display()), holds);
    }

    /// Loads an address, and waits until an expression of JavaScript holds; returns how long that took.
    pub fn visit(&mut self, address: &str, holds: &str) -> Duration {
        // A fragment alone would not load it anew.
        self.call("Page.navigate", json!({"url": "about:blank"}));
        let began = Instant::now();
        self.call("Page.navigate", json!({"url": address}));
        self.wait_until(holds);
        began.elapsed()
    }

    /// Waits until an expression of JavaScript holds.
    pub fn wait_until(&mut self, holds: &str) {
        let began = Instant::now();
        while self.evaluate(holds) != json!(true) {
            assert!(began.elapsed() < PATIENCE, "never {holds}: {:?}", self.complaints());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Moves the mouse, with a button down or with `none`.
    pub fn move_to(&mut self, [x, y]: [f64; 2], button: &str) {
        self.call("Input.dispatchMouseEvent", json!({"type": "mouseMoved", "x": x, "y": y, "button": button}));
    }

    /// Presses (`mousePressed`) or releases (`mouseReleased`) a button of the mouse.
    pub fn button(&mut self, kind: &str, [x, y]: [f64; 2], button: &str) {
        let order = json!({"type": kind, "x": x, "y": y, "button": button, "clickCount": 1});
        self.call("Input.dispatchMouseEvent", order);
    }

    /// Presses and releases a button of the mouse at a place.
    pub fn click(&mut self, place: [f64; 2], button: &str) {
        for kind in ["mousePressed", "mouseReleased"] {
            self.button(kind, place, button);
        }
    }

    /// Returns what the page looks like, as PNG in base64.
    pub fn screenshot(&mut self) -> String {
        self.call("Page.captureScreenshot", json!({}))["data"].as_str().expect("a picture").to_owned()
    }

    /// Text of the first element that a selector finds.
    pub fn text(&mut self, selector: &str) -> String {
        let text = self.evaluate(&format!("document.querySelector({}).textContent", json!(selector)));
        text.as_str().expect("text").to_owned()
    }

    /// Presses and releases a key.
    pub fn press(&mut self, key: &str, has_shift: bool) {
        let code = match key {
            "Tab" => 9,
            "Enter" => 13,
            "Escape" => 27,
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            key => u32::from(key.to_ascii_uppercase().as_bytes()[0]),
        };
        let modifiers = if has_shift { 8 } else { 0 };
        // Enter presses a button by the character that it types.
        let text = if key == "Enter" { "\r" } else { "" };
        for kind in ["keyDown", "keyUp"] {
            let order =
                json!({"type": kind, "key": key, "windowsVirtualKeyCode": code, "modifiers": modifiers, "text": text});
            self.call("Input.dispatchKeyEvent", order);
        }
    }

    /// Moves the mouse over the middle of a texel of the picture, which has so many.
    pub fn point_at(&mut self, texel: [u32; 2], size: [u32; 2]) {
        let place = self.place_of(texel, size);
        self.move_to(place, "none");
    }

    /// Clicks a texel.
    pub fn click_at(&mut self, texel: [u32; 2], size: [u32; 2]) {
        let place = self.place_of(texel, size);
        self.click(place, "left");
    }

    fn place_of(&mut self, texel: [u32; 2], size: [u32; 2]) -> [f64; 2] {
        let bounds = "(() => { const { left, top, width, height } = document.querySelector('#picture').getBoundingClientRect(); return [left, top, width, height]; })()";
        let bounds: [f64; 4] = serde_json::from_value(self.evaluate(bounds)).expect("four numbers");
        [0, 1].map(|axis| bounds[axis] + (f64::from(texel[axis]) + 0.5) * bounds[axis + 2] / f64::from(size[axis]))
    }

    /// Everything that the console says, and every exception.
    pub fn complaints(&mut self) -> Vec<String> {
        // What was said before this was asked has arrived with the answer.
        self.evaluate("0");
        let is_complaint = |event: &&Value| {
            ["Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"]
                .contains(&event["method"].as_str().unwrap_or(""))
        };
        self.events.iter().filter(is_complaint).map(|event| event["params"].to_string()).collect()
    }

    /// Addresses that were asked for, but for those within the page.
    pub fn requests(&mut self) -> Vec<String> {
        self.evaluate("0");
        let requests = self.events.iter().filter(|event| event["method"] == json!("Network.requestWillBeSent"));
        let addresses = requests.filter_map(|event| event["params"]["request"]["url"].as_str());
        addresses.filter(|address| !address.starts_with("data:")).map(str::to_owned).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It is ended with its pipe; what it leaves of its own processes goes with it.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
