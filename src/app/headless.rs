//! The window without a window: the same panels and the same worker, for benchmarks and for pictures.
//!
//! Nothing is shown: a frame is egui's output for the panels, and becomes a picture where one is asked for
//! ([`Headless::picture`]). Time is simulated, a sixtieth of a second for each frame.

use super::controller::{Controller, Surroundings};
use super::news::WindowNews;
use super::{AppError, ViewRequest};
use crate::ask::RunRequest;
use crate::inspector::Inspector;
use crate::offscreen::{self, OffscreenError, OffscreenPainter};
use crate::picture::Picture;
use egui::{Event, Key, Modifiers, Pos2, RawInput, Rect, ViewportId, pos2, vec2};
use egui_wgpu::ScreenDescriptor;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Duration of a frame, seconds.
const FRAME: f64 = 1.0 / 60.0;
/// How long the worker may be silent while it works.
const PATIENCE: Duration = Duration::from_secs(120);
/// After so long without news the worker has no more: it times a frame after a while.
const SILENCE: Duration = Duration::from_millis(700);

/// Nothing is around the panels: nothing is stored, watched or asked for.
struct NoSurroundings;

impl Surroundings for NoSurroundings {}

/// Panels and worker without a window: frames are run by hand, and drawn only when a picture is asked for.
pub struct Headless {
    ctx: egui::Context,
    controller: Controller,
    news: Receiver<WindowNews>,
    size: [f32; 2],
    scale: f32,
    time: f64,
    painter: Option<OffscreenPainter>,
    /// Texture changes that were not drawn yet.
    textures: egui::TexturesDelta,
    /// What the last frame draws.
    triangles: Vec<egui::ClippedPrimitive>,
}

/// The time that a frame of the panels takes on the CPU, and when the next one is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameCost {
    /// The panels' own code.
    pub panels: Duration,
    /// The conversion of their shapes to triangles.
    pub triangles: Duration,
    /// When egui wants the next frame; `None`: not before an event.
    pub next: Option<Duration>,
}

impl FrameCost {
    /// Returns both together.
    pub fn total(&self) -> Duration {
        self.panels + self.triangles
    }
}

impl Headless {
    /// Opens what `request` asks for in a window of `size` points that would have `scale` pixels a point. Runs no frame
    /// yet, watches no files and stores no settings.
    pub fn new(request: ViewRequest, size: [f32; 2], scale: f32) -> Result<Headless, AppError> {
        let (send, news) = channel();
        let controller =
            Controller::new(request, Arc::new(move |news| drop(send.send(news))), Box::new(NoSurroundings))?;
        Ok(Headless {
            ctx: egui::Context::default(),
            controller,
            news,
            size,
            scale,
            time: 0.0,
            painter: None,
            textures: egui::TexturesDelta::default(),
            triangles: Vec::new(),
        })
    }

    /// Returns the panels.
    pub fn inspector(&mut self) -> &mut Inspector {
        &mut self.controller.inspector
    }

    /// Runs one frame of the panels, 1/60 s after the last, with these events: handles all news that has come, then
    /// carries out the actions of the panels. Draws nothing (see [`Headless::picture`]), and the cost counts neither
    /// news nor actions.
    pub fn frame(&mut self, events: Vec<Event>) -> FrameCost {
        while let Ok(news) = self.news.try_recv() {
            self.controller.wake(news);
        }
        self.time += FRAME;
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(self.size[0], self.size[1]))),
            time: Some(self.time),
            predicted_dt: FRAME as f32,
            events,
            focused: true,
            ..RawInput::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(self.scale);
        }
        let mut actions = Vec::new();
        let start = Instant::now();
        let inspector = &mut self.controller.inspector;
        let output = self.ctx.run_ui(input, |ui| actions.extend(inspector.ui(ui)));
        let panels = start.elapsed();
        let start = Instant::now();
        self.triangles = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        let cost = FrameCost {
            panels,
            triangles: start.elapsed(),
            next: output.viewport_output.get(&ViewportId::ROOT).map(|view| view.repaint_delay).filter(is_soon),
        };
        self.textures.append(output.textures_delta);
        actions.into_iter().for_each(|action| self.controller.act(action));
        cost
    }

    /// Runs frames until the worker has nothing to do, no question waits and no news has come for 0.7 s, then three
    /// more for sizes that egui learns while it draws. Fails with `AppError::Silent` where a busy worker reports
    /// nothing for two minutes.
    pub fn settle(&mut self) -> Result<(), AppError> {
        self.frame(Vec::new());
        loop {
            let is_busy = self.controller.inspector.model.activity.job.is_some()
                || self.controller.inspector.model.answers.is_waiting();
            match self.news.recv_timeout(if is_busy { PATIENCE } else { SILENCE }) {
                Ok(news) => {
                    self.controller.wake(news);
                    self.frame(Vec::new());
                }
                Err(_) if is_busy => return Err(AppError::Silent),
                Err(_) => break,
            }
        }
        // Sizes that egui determines while it draws.
        for _ in 0..3 {
            self.frame(Vec::new());
        }
        Ok(())
    }

    /// Carries out actions of the panels.
    pub fn act(&mut self, actions: Vec<crate::inspector::Action>) {
        actions.into_iter().for_each(|action| self.controller.act(action));
    }

    /// Runs the open scene with a draft, handles news until the first capture comes, and runs one frame that shows it;
    /// returns the time after that frame. Fails with `AppError::Silent` where no news comes for two minutes.
    pub fn run_and_show(&mut self, draft: RunRequest) -> Result<Instant, AppError> {
        let actions = self.controller.inspector.rerun(draft);
        self.act(actions);
        loop {
            let news = self.news.recv_timeout(PATIENCE).map_err(|_| AppError::Silent)?;
            let is_captured = matches!(&news, WindowNews::Worker(super::news::News::Captured { .. }));
            self.controller.wake(news);
            if is_captured {
                self.frame(Vec::new());
                return Ok(Instant::now());
            }
        }
    }

    /// Presses a key in one frame and releases it in the next; returns the cost of the first.
    pub fn key(&mut self, modifiers: Modifiers, key: Key) -> FrameCost {
        let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        let cost = self.frame(vec![event(true)]);
        self.frame(vec![event(false)]);
        cost
    }

    /// Returns the position in the window at shares of its width and height from the top left corner, points.
    pub fn place(&self, [x, y]: [f32; 2]) -> Pos2 {
        pos2(x * self.size[0], y * self.size[1])
    }

    /// Moves the pointer to a position in the window, as shares of its width and height from the top left corner, in
    /// one frame.
    pub fn point(&mut self, at: [f32; 2]) -> FrameCost {
        self.frame(vec![Event::PointerMoved(self.place(at))])
    }

    /// Returns what the window would show after the last frame, in pixels (the size times the scale, rounded). Opens a
    /// GPU on first use.
    pub fn picture(&mut self) -> Result<Picture, AppError> {
        self.drawn(|painter, screen, triangles, ground, textures| painter.draw(screen, triangles, ground, textures))
    }

    /// Draws the last frame as the window would, without returning it: what it takes until the GPU has done so is what it
    /// takes there. Opens a GPU on first use.
    pub fn paint(&mut self) -> Result<(), AppError> {
        self.drawn(|painter, screen, triangles, ground, textures| painter.paint(screen, triangles, ground, textures))
    }

    fn drawn<T>(
        &mut self,
        draw: impl FnOnce(
            &mut OffscreenPainter,
            &ScreenDescriptor,
            &[egui::ClippedPrimitive],
            egui::Color32,
            egui::TexturesDelta,
        ) -> Result<T, OffscreenError>,
    ) -> Result<T, AppError> {
        let painter = match &mut self.painter {
            Some(painter) => painter,
            none => none.insert(OffscreenPainter::new(offscreen::OF_WINDOW).map_err(no_picture)?),
        };
        let pixels = self.size.map(|side| (side * self.scale).round() as u32);
        let screen = ScreenDescriptor { size_in_pixels: pixels, pixels_per_point: self.scale };
        let ground = self.ctx.global_style().visuals.panel_fill;
        draw(painter, &screen, &self.triangles, ground, std::mem::take(&mut self.textures)).map_err(no_picture)
    }
}

impl Drop for Headless {
    fn drop(&mut self) {
        // Changes that were not drawn never will be; if they were dropped, egui would report a bug.
        self.textures.clear();
    }
}

fn is_soon(delay: &Duration) -> bool {
    *delay < Duration::from_secs(3600)
}

fn no_picture(error: OffscreenError) -> AppError {
    AppError::NoPicture(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::ViewSource;
    use crate::scene::{Light, OpenSpec, Scene, open};
    use crate::session::CaptureRequest;
    use crate::technique::{Choice, Technique};

    /// The label of pixels in shadow.
    const SHADOW: u8 = 1;

    fn opened(scene: Scene, technique: Technique, pick: Option<[u32; 2]>) -> Headless {
        let request = ViewRequest {
            source: ViewSource::Scene(Box::new(scene)),
            name: OpenSpec::new("tori"),
            capture: CaptureRequest::new(Choice::new(technique), [160, 120]),
            time: 0.0,
            adapter: None,
            step: None,
            pick,
            truth: false,
        };
        let mut window = Headless::new(request, [1280.0, 800.0], 1.0).expect("panels");
        window.settle().expect("a frame");
        window
    }

    #[test]
    fn the_window_opens_with_a_pixel_in_shadow_picked_where_there_is_one() {
        for name in ["tori", "table", "gate"] {
            let scene = open(&OpenSpec::new(name)).expect("a scene");
            let mut window = opened(scene, Technique::Auto, None);
            let model = &window.inspector().model;
            let at = model.selection.pick.expect("a pixel");
            let capture = model.frame.capture.as_ref().expect("a frame");
            let label = |at| capture.lights.iter().find_map(|light| light.shadow.as_ref())?.byte_at(at);
            // Not at an edge either.
            let around = [[0, 0], [2, 0], [0, 2], [2, 2]].map(|[x, y]| [at[0] + x - 1, at[1] + y - 1]);
            assert!(around.into_iter().chain([at]).all(|at| label(at) == Some(SHADOW)), "{name}: {at:?}");
            assert!(model.history_of_frame().is_some(), "{name}: its history is known");
        }
        let asked = opened(open(&OpenSpec::new("tori")).expect("a scene"), Technique::Auto, Some([3, 4]));
        assert_eq!({ asked }.inspector().model.selection.pick, Some([3, 4]), "what is asked for comes first");
        let mut lit = open(&OpenSpec::new("tori")).expect("a scene");
        lit.objects.iter_mut().for_each(|object| object.casts = false);
        lit.lights = vec![Light::directional([0.0, 1.0, 0.0])];
        assert_eq!(opened(lit, Technique::Auto, None).inspector().model.selection.pick, None);
    }

    /// What is drawn of a frame alone, where it differs from the frame before, is what all of it drawn anew would be.
    #[test]
    fn what_changed_drawn_alone_is_the_whole_window_to_the_byte() {
        let mut window = opened(open(&OpenSpec::new("tori")).expect("a scene"), Technique::ZFail, None);
        let wheel = |by: f32| Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, by),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        };
        for round in 0..60_u32 {
            // Places all over the window, the same in every run.
            let along = |step: u32| (round * step % 97) as f32 / 97.0;
            match round % 6 {
                0 => drop(window.key(Modifiers::NONE, if round < 30 { Key::ArrowRight } else { Key::ArrowLeft })),
                1 => drop(window.point([along(31), along(57)])),
                2 => drop(window.frame(vec![wheel(if round < 40 { 30.0 } else { -20.0 })])),
                3 => {
                    let at = window.place([along(13), along(71)]);
                    let button = |pressed| {
                        let modifiers = Modifiers::NONE;
                        Event::PointerButton { pos: at, button: egui::PointerButton::Primary, pressed, modifiers }
                    };
                    window.frame(vec![Event::PointerMoved(at), button(true)]);
                    window.frame(vec![button(false)]);
                }
                4 => drop(window.point([0.5 + along(7) / 10.0, 0.3])),
                _ => drop(window.frame(Vec::new())),
            }
            let kept = window.picture().expect("a picture");
            window.painter.as_mut().expect("a painter").forget();
            let whole = window.picture().expect("a picture");
            assert_eq!(kept.pixels(), whole.pixels(), "round {round}");
        }
    }

    #[test]
    fn another_run_of_the_scene_leaves_the_pick_alone() {
        let mut window = opened(open(&OpenSpec::new("tori")).expect("a scene"), Technique::Auto, None);
        window.inspector().model.selection.pick = None;
        let draft = window.inspector().draft().expect("a scene");
        let choice = Choice::new(Technique::ShadowMap);
        window.run_and_show(RunRequest { choice, ..*draft }).expect("a frame");
        assert_eq!(window.inspector().model.selection.pick, None);
    }
}
