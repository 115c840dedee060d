//! The application that eframe runs in the page.

use super::page;
use super::surroundings::Page;
use super::tree::TreeKeeper;
use crate::app::controller::Controller;
use crate::app::input::events_of_frame;
use crate::app::news::{Exported, News, Notify, WindowNews};
use crate::app::quiet::{JOB_SHOWN_AFTER, QuietTime};
use crate::app::{ViewRequest, ViewSource, task, title};
use crate::files::{archive, brought};
use crate::import::ShippedFrame;
use crate::inspector::WindowPlace;
use crate::link::ViewLink;
use crate::scene::{OpenSpec, open as open_scene};
use crate::session::CaptureRequest;
use crate::technique::{Choice, Technique};
use crate::viewport;
use eframe::{CreationContext, WebOptions, WebRunner};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast, JsValue};
use web_time::Instant;

/// The name of the canvas in the page.
const CANVAS: &str = "window";
/// What is open where the address names nothing.
const FIRST_SCENE: &str = "tori";
/// Sizes of the picture, pixels: on a CPU or a small screen, and otherwise.
const SMALL: [u32; 2] = [640, 360];
const LARGE: [u32; 2] = [1280, 720];
/// What the page says when nothing can be drawn any longer.
const LOST: &str = "The browser has lost the GPU, as when its driver is restarted: load the page again.";
/// How often progress is checked.
const WATCH: Duration = Duration::from_millis(100);

/// Opens the window in the page that has loaded the module, with what its address asks for; where that fails, the page
/// says why.
pub fn start() {
    let runner = WebRunner::new();
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        before(panic);
        page::show_failure("The window has stopped, by a bug of its own: load the page again. The console says where.");
    }));
    wasm_bindgen_futures::spawn_local(async move {
        if let Err(reason) = open(&runner).await {
            page::show_failure(&reason);
        }
    });
}

async fn open(runner: &WebRunner) -> Result<(), String> {
    let canvas = web_sys::window().and_then(|page| page.document()?.get_element_by_id(CANVAS));
    let canvas = canvas.and_then(|canvas| canvas.dyn_into().ok()).ok_or("this page has no canvas for the window")?;
    let options = WebOptions { dithering: false, ..WebOptions::default() };
    let started = runner.start(canvas, options, Box::new(|context| Ok(Box::new(WebWindow::new(context)?)))).await;
    started.map_err(|error| {
        let reason = error.as_string().unwrap_or_else(|| format!("{error:?}"));
        format!("The window can't be drawn here: {reason}.")
    })
}

/// Returns what the page's address asks for, and what of it can't be read or opened, each in a sentence: then something
/// else is opened in its place.
fn asked_for(query: &str) -> Result<(ViewRequest, Vec<String>), String> {
    let (link, problems) = ViewLink::parse(query);
    let mut problems: Vec<String> = problems.iter().map(ToString::to_string).collect();
    let size = link.size.unwrap_or(if page::is_cpu() || page::is_small() { SMALL } else { LARGE });
    let name = link.scene.as_deref().unwrap_or(FIRST_SCENE);
    let request = first_view(name, size).or_else(|problem| {
        problems.push(problem);
        first_view(FIRST_SCENE, size)
    });
    let mut request = ViewRequest {
        step: link.step,
        pick: link.pixel,
        truth: link.truth,
        time: link.time.unwrap_or(0.0),
        ..request?
    };
    if let ViewSource::Scene(scene) = &mut request.source {
        let mut linked = scene.clone();
        match link.apply_to(&mut linked) {
            Ok(()) => *scene = linked,
            Err(problem) => problems.push(problem.to_string()),
        }
        let choice = Choice::for_scene(scene, link.technique.as_deref(), link.settings);
        match choice.or_else(|problem| {
            problems.push(problem.to_string());
            Choice::for_scene(scene, None, [])
        }) {
            Ok(choice) => request.capture = CaptureRequest::new(choice, size),
            Err(problem) => problems.push(problem.to_string()),
        }
    }
    Ok((request, problems))
}

/// Returns a built-in scene, or a recorded frame, as the first thing that is shown.
fn first_view(name: &str, size: [u32; 2]) -> Result<ViewRequest, String> {
    let source = match ShippedFrame::named(name) {
        Some(shipped) => ViewSource::Folder(Box::new(shipped.open().map_err(|error| error.to_string())?)),
        None => ViewSource::Scene(Box::new(open_scene(&OpenSpec::new(name)).map_err(|error| error.to_string())?)),
    };
    Ok(ViewRequest {
        source,
        name: OpenSpec::new(name),
        capture: CaptureRequest::new(Choice::new(Technique::Auto), size),
        time: 0.0,
        adapter: None,
        step: None,
        pick: None,
        truth: false,
    })
}

/// The panels in the page.
struct WebWindow {
    controller: Controller,
    /// News, each with when it was sent.
    news: Receiver<(Instant, WindowNews)>,
    /// Events of mouse and keys that no frame has handled yet.
    events: Vec<egui::Event>,
    title: String,
    /// While a CPU draws: when nothing is drawn.
    quiet: QuietTime,
    /// Nothing was drawn yet.
    is_first: bool,
}

impl WebWindow {
    fn new(context: &CreationContext) -> Result<WebWindow, String> {
        if let Some(gpu) = &context.wgpu_render_state {
            viewport::install(gpu);
            gpu.device.set_device_lost_callback(|reason, _| {
                // One that was given back is not missed.
                if reason != wgpu::DeviceLostReason::Destroyed {
                    page::show_failure(LOST);
                }
            });
        }
        let (send, news) = channel();
        let notify = notify(send, context.egui_ctx.clone());
        offer_functions(&context.egui_ctx, &notify);
        let (request, problems) = asked_for(&page::query())?;
        let mut controller = Controller::new(request, notify, Box::new(Page)).map_err(|error| error.to_string())?;
        controller.inspector.model.place = WindowPlace::Page;
        controller.inspector.model.is_drawn_slowly = page::is_cpu();
        problems.into_iter().for_each(|problem| controller.inspector.model.push_error(problem));
        Ok(WebWindow {
            controller,
            news,
            events: Vec::new(),
            title: String::new(),
            quiet: QuietTime::default(),
            is_first: true,
        })
    }

    /// Handles the news that have come.
    fn hear(&mut self) {
        let news: Vec<(Instant, WindowNews)> = self.news.try_iter().collect();
        if page::is_cpu() && !self.is_first {
            self.quiet.hear(news.iter().map(|(sent, news)| (*sent, news)));
        }
        news.into_iter().for_each(|(_, news)| self.controller.wake(news));
    }
}

/// Returns what sends news to the window and wakes it. What was exported before is downloaded first: news of an export come
/// at once when it is written.
fn notify(send: Sender<(Instant, WindowNews)>, ctx: egui::Context) -> Notify {
    Arc::new(move |news| {
        if let Err(reason) = download_written() {
            drop(send.send((Instant::now(), WindowNews::Exported(Exported::Failed(reason)))));
        }
        // What is done for a moment is not shown.
        let delay = match &news {
            WindowNews::Worker(News::Busy(_) | News::Idle) => JOB_SHOWN_AFTER,
            _ => Duration::ZERO,
        };
        // A window that is gone receives no news, and needs none.
        drop(send.send((Instant::now(), news)));
        ctx.request_repaint_after(delay);
    })
}

/// Puts dropped files where they can be opened, and returns the path to open; the reason where there is none.
fn opened(files: Vec<(String, Vec<u8>)>) -> Result<String, String> {
    let files = brought::unpacked(files).map_err(|error| error.to_string())?;
    let names: Vec<String> = files.iter().map(|(name, _)| name.clone()).collect();
    brought::bring(files).map_err(|error| error.to_string())?;
    brought::main_file(names.iter().map(String::as_str)).map_err(|error| error.to_string())
}

/// Saves what was written since the last call as a download: several files as an archive.
///
/// # Errors
/// They can't be packed.
fn download_written() -> Result<(), String> {
    let mut files = brought::take_written();
    match files.len() {
        0 => {}
        1 => files.drain(..).for_each(|(path, bytes)| page::download(name_of(&path), &bytes)),
        _ => {
            // A capture is a folder; a scene file lies beside its models.
            let folder = files[0].0.split_once('/').map(|(folder, _)| folder);
            let scene = files.iter().find_map(|(path, _)| path.strip_suffix(".toml"));
            let name = folder.or(scene).unwrap_or("files").to_owned();
            let bytes = archive::pack(files).map_err(|error| error.to_string())?;
            page::download(&format!("{name}.zip"), &bytes);
        }
    }
    Ok(())
}

/// Returns a path's last part.
fn name_of(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// Offers the page's script what the window does for it: to open files, and to describe its widgets.
fn offer_functions(ctx: &egui::Context, notify: &Notify) {
    let to_window = Arc::clone(notify);
    let refused = move |reason: String| to_window(WindowNews::Worker(News::Failed(reason)));
    let (to_window, refuse) = (Arc::clone(notify), refused.clone());
    let open = move |list: JsValue| {
        match opened(page::files_of(&list)) {
            Ok(path) => to_window(WindowNews::Chosen(path)),
            Err(reason) => refuse(reason),
        }
        JsValue::UNDEFINED
    };
    page::offer("open", Closure::new(open));
    let refuse = refused.clone();
    let is_too_large = move |bytes: JsValue| {
        let checked = brought::check_size(bytes.as_f64().unwrap_or(f64::INFINITY) as u64);
        let is_too_large = checked.is_err();
        checked.unwrap_or_else(|error| refuse(error.to_string()));
        is_too_large.into()
    };
    page::offer("isTooLarge", Closure::new(is_too_large));
    let to_window = Arc::clone(notify);
    let did = move |what: JsValue| {
        to_window(WindowNews::Exported(Exported::Done(what.as_string().unwrap_or_default())));
        JsValue::UNDEFINED
    };
    page::offer("did", Closure::new(did));
    let refuse = move |reason: JsValue| {
        refused(reason.as_string().unwrap_or_default());
        JsValue::UNDEFINED
    };
    page::offer("refused", Closure::new(refuse));
    let ctx = ctx.clone();
    ctx.add_plugin(TreeKeeper::default());
    let tree = move |_: JsValue| {
        ctx.enable_accesskit();
        ctx.request_repaint();
        let scale = ctx.pixels_per_point();
        ctx.with_plugin(|tree: &mut TreeKeeper| tree.to_json(scale)).unwrap_or_default().into()
    };
    page::offer("tree", Closure::new(tree));
}

impl eframe::App for WebWindow {
    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        self.events.append(&mut input.events);
        // The page's script hands files over, with the folders that they lie in.
        input.dropped_files.clear();
        input.hovered_files.clear();
        self.hear();
        let window = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        if self.quiet.left(Instant::now()).is_some() {
            // egui draws nothing in a window that can't be seen.
            window.occluded = Some(true);
        }
        if window.visible() == Some(false) {
            return;
        }
        self.quiet.end(Instant::now());
        input.events = events_of_frame(ctx, &mut self.events);
        if !self.events.is_empty() {
            ctx.request_repaint();
        }
    }

    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        if self.quiet.is_on() {
            ctx.request_repaint_after(self.quiet.left(Instant::now()).unwrap_or_default());
        }
        if let Some(capture) = &self.controller.inspector.model.frame.capture {
            let title = title(capture);
            if title != self.title {
                page::set_title(&title);
                self.title = title;
            }
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let actions = self.controller.inspector.ui(ui);
        if self.controller.inspector.model.answers.has_progress() {
            ui.ctx().request_repaint_after(if page::is_cpu() { 10 * WATCH } else { WATCH });
        }
        if !actions.is_empty() {
            actions.into_iter().for_each(|action| self.controller.act(action));
            // What they ask of the GPU does not wait for it to draw the window.
            task::go_on();
            ui.ctx().request_repaint();
        }
        if std::mem::take(&mut self.is_first) {
            page::show_window();
        }
    }

    fn save(&mut self, _: &mut dyn eframe::Storage) {
        self.controller.remember();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}
