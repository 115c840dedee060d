//! The window without a window: the same panels and the same worker, for benchmarks and for pictures.
//!
//! Nothing is shown: a frame is egui's output for the panels, and becomes a picture where one is asked for
//! ([`Headless::picture`]). Time is simulated, a sixtieth of a second for each frame.

use super::controller::Controller;
use super::news::WindowNews;
use super::{AppError, ViewRequest};
use crate::ask::RunRequest;
use crate::inspector::Inspector;
use crate::picture::Picture;
use egui::{Event, Key, Modifiers, Pos2, RawInput, Rect, ViewportId, pos2, vec2};
use egui_wgpu::{RenderState, RendererOptions, ScreenDescriptor, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Duration of a frame, seconds.
const FRAME: f64 = 1.0 / 60.0;
/// How long the worker may be silent while it works.
const PATIENCE: Duration = Duration::from_secs(120);
/// After so long without news the worker has no more: it times a frame after a while.
const SILENCE: Duration = Duration::from_millis(700);

/// Panels and worker without a window: frames are run by hand, and drawn only when a picture is asked for.
pub struct Headless {
    ctx: egui::Context,
    controller: Controller,
    news: Receiver<WindowNews>,
    size: [f32; 2],
    scale: f32,
    time: f64,
    painter: Option<Painter>,
    /// Texture changes that were not drawn yet.
    textures: egui::TexturesDelta,
    shapes: Vec<egui::epaint::ClippedShape>,
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
        let controller = Controller::new(request, Arc::new(move |news| drop(send.send(news))), false)?;
        Ok(Headless {
            ctx: egui::Context::default(),
            controller,
            news,
            size,
            scale,
            time: 0.0,
            painter: None,
            textures: egui::TexturesDelta::default(),
            shapes: Vec::new(),
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
        let triangles = self.ctx.tessellate(output.shapes.clone(), output.pixels_per_point);
        let cost = FrameCost {
            panels,
            triangles: start.elapsed(),
            next: output.viewport_output.get(&ViewportId::ROOT).map(|view| view.repaint_delay).filter(is_soon),
        };
        drop(triangles);
        self.textures.append(output.textures_delta);
        self.shapes = output.shapes;
        actions.into_iter().for_each(|action| self.controller.act(action));
        cost
    }

    /// Runs frames until the worker has nothing to do, no question waits and no news has come for 0.7 s, then three
    /// more for sizes that egui learns while it draws. Fails with `AppError::Silent` where a busy worker reports
    /// nothing for two minutes.
    pub fn settle(&mut self) -> Result<(), AppError> {
        self.frame(Vec::new());
        loop {
            let is_busy = self.controller.inspector.model.activity.job.is_some() || self.controller.is_answering();
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

    /// Moves the pointer to a position in the window, as shares of its width and height from the top left corner, in
    /// one frame.
    pub fn point(&mut self, [x, y]: [f32; 2]) -> FrameCost {
        self.frame(vec![Event::PointerMoved(pos2(x * self.size[0], y * self.size[1]))])
    }

    /// Returns what the window would show after the last frame, in pixels (the size times the scale, rounded). Opens a
    /// GPU on first use.
    pub fn picture(&mut self) -> Result<Picture, AppError> {
        let painter = match &mut self.painter {
            Some(painter) => painter,
            none => none.insert(Painter::new()?),
        };
        let pixels = self.size.map(|side| (side * self.scale).round() as u32);
        let screen = ScreenDescriptor { size_in_pixels: pixels, pixels_per_point: self.scale };
        let triangles = self.ctx.tessellate(self.shapes.clone(), self.scale);
        painter.draw(&screen, &triangles, std::mem::take(&mut self.textures))
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

/// Draws egui's triangles into a texture and reads it back.
struct Painter {
    gpu: RenderState,
}

impl Painter {
    fn new() -> Result<Painter, AppError> {
        let setup = WgpuSetup::CreateNew(WgpuSetupCreateNew::without_display_handle());
        let instance = pollster::block_on(setup.new_instance());
        let configuration = WgpuConfiguration { wgpu_setup: setup, ..WgpuConfiguration::default() };
        let gpu = pollster::block_on(RenderState::create(&configuration, &instance, None, RendererOptions::default()));
        gpu.map(|gpu| Painter { gpu }).map_err(|error| AppError::NoPicture(error.to_string()))
    }

    fn draw(
        &self,
        screen: &ScreenDescriptor,
        triangles: &[egui::ClippedPrimitive],
        mut textures: egui::TexturesDelta,
    ) -> Result<Picture, AppError> {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut renderer = self.gpu.renderer.write();
        for (id, deltas) in std::mem::take(&mut textures.set) {
            deltas.iter().for_each(|delta| renderer.update_texture(device, queue, id, delta));
        }
        let [width, height] = screen.size_in_pixels;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("panels"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.gpu.target_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let stride = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("panels read back"),
            size: u64::from(stride) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let before = renderer.update_buffers(device, queue, &mut encoder, triangles, screen);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("panels"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            renderer.render(&mut pass.forget_lifetime(), triangles, screen);
        }
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
        let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), target, size);
        queue.submit(before.into_iter().chain([encoder.finish()]));
        for id in std::mem::take(&mut textures.free) {
            renderer.free_texture(&id);
        }
        let (send, done) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(send.send(result)));
        let lost = |error: &dyn std::fmt::Display| AppError::NoPicture(error.to_string());
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(&error))?;
        done.recv().map_err(|error| lost(&error))?.map_err(|error| lost(&error))?;
        let bytes = buffer.get_mapped_range(..).map_err(|error| lost(&error))?;
        let is_bgra = matches!(self.gpu.target_format, wgpu::TextureFormat::Bgra8Unorm);
        let mut picture = Picture::filled([width, height], [0; 3]);
        for (y, row) in (0..height).zip(bytes.chunks_exact(stride as usize)) {
            for (x, texel) in (0..width).zip(row.chunks_exact(4)) {
                let [a, b, c] = [texel[0], texel[1], texel[2]];
                picture.set([x, y], if is_bgra { [c, b, a] } else { [a, b, c] });
            }
        }
        Ok(picture)
    }
}
