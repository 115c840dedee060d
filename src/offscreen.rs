//! Panels drawn into a picture, without a window: for the README's pictures, and for tests of panels.

use crate::adapters::{first_that_opens, speed_rank};
use crate::picture::Picture;
use crate::repaint::RetainedTarget;
use egui_wgpu::{RenderState, RendererOptions, ScreenDescriptor, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::sync::Arc;
use std::sync::mpsc::channel;
use wgpu::{Adapter, DeviceDescriptor, DeviceType};

/// How a window is drawn. Without dithering: noise in what lies between two colours of eight bits would be in pictures that
/// are looked at pixel by pixel, and takes time where a CPU draws.
pub const OF_WINDOW: RendererOptions = RendererOptions {
    msaa_samples: 0,
    depth_stencil_format: None,
    dithering: false,
    predictable_texture_filtering: false,
};

/// Why there is no picture, in the driver's words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct OffscreenError(String);

/// Returns the first of these adapters that gives the described device, the fastest kind first; with `is_software_first`
/// the software ones before all. `None` where none does.
pub fn first_with_device<'a>(
    adapters: impl IntoIterator<Item = &'a Adapter>,
    descriptor: impl Fn(&Adapter) -> DeviceDescriptor<'static>,
    is_software_first: bool,
) -> Option<Adapter> {
    let mut adapters: Vec<&Adapter> = adapters.into_iter().collect();
    // Of two booleans, `false` comes first.
    let is_late = |adapter: &Adapter| is_software_first && adapter.get_info().device_type != DeviceType::Cpu;
    adapters.sort_by_key(|adapter| (is_late(adapter), speed_rank(adapter)));
    // The last one is not tried: where it fails, its error is what the user reads.
    let (last, others) = adapters.split_last()?;
    let open = async |adapter: &'a Adapter| adapter.request_device(&descriptor(adapter)).await.map(|_| adapter);
    let chosen = pollster::block_on(first_that_opens(others.iter().copied(), open));
    Some(chosen.map_or(*last, |(adapter, _)| adapter).clone())
}

/// Draws egui's triangles into a texture and reads it back.
pub struct OffscreenPainter {
    gpu: RenderState,
    target: RetainedTarget,
}

impl OffscreenPainter {
    /// Opens a GPU, a software one where there is one, so that pictures are the same everywhere.
    ///
    /// # Errors
    /// No GPU can be opened.
    pub fn new(options: RendererOptions) -> Result<OffscreenPainter, OffscreenError> {
        let mut setup = WgpuSetupCreateNew::without_display_handle();
        let descriptor = Arc::clone(&setup.device_descriptor);
        setup.native_adapter_selector = Some(Arc::new(move |adapters, _| {
            let found = first_with_device(adapters, |adapter| descriptor(adapter), true);
            found.ok_or_else(|| "no GPU gives a device".to_owned())
        }));
        let setup = WgpuSetup::CreateNew(setup);
        let instance = pollster::block_on(setup.new_instance());
        let configuration = WgpuConfiguration { wgpu_setup: setup, ..WgpuConfiguration::default() };
        let gpu = pollster::block_on(RenderState::create(&configuration, &instance, None, options));
        let painter = gpu.map(|gpu| OffscreenPainter { gpu, target: RetainedTarget::default() });
        painter.map_err(|error| OffscreenError(error.to_string()))
    }

    /// Returns the GPU, with the renderer that [`OffscreenPainter::draw`] uses.
    pub fn gpu(&self) -> &RenderState {
        &self.gpu
    }

    /// Forgets what was drawn, so that all is drawn anew.
    pub fn forget(&mut self) {
        self.target = RetainedTarget::default();
    }

    /// Applies changes of textures, draws what changed of the triangles over the ground's colour and returns the picture, `screen`
    /// pixels large.
    ///
    /// # Errors
    /// The GPU failed, or was lost.
    pub fn draw(
        &mut self,
        screen: &ScreenDescriptor,
        triangles: &[egui::ClippedPrimitive],
        ground: egui::Color32,
        mut textures: egui::TexturesDelta,
    ) -> Result<Picture, OffscreenError> {
        let [width, height] = screen.size_in_pixels;
        let texture = self.target.draw(&self.gpu, screen, triangles, ground, &mut textures);
        let stride = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("panels read back"),
            size: u64::from(stride) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
        let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
        self.gpu.queue.submit([encoder.finish()]);
        let (send, done) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(send.send(result)));
        let lost = |error: &dyn std::fmt::Display| OffscreenError(error.to_string());
        self.wait()?;
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

    /// Draws as [`OffscreenPainter::draw`] does and waits for the GPU, but reads nothing back: what a window takes.
    ///
    /// # Errors
    /// The GPU was lost.
    pub fn paint(
        &mut self,
        screen: &ScreenDescriptor,
        triangles: &[egui::ClippedPrimitive],
        ground: egui::Color32,
        mut textures: egui::TexturesDelta,
    ) -> Result<(), OffscreenError> {
        self.target.draw(&self.gpu, screen, triangles, ground, &mut textures);
        self.wait()
    }

    fn wait(&self) -> Result<(), OffscreenError> {
        let done = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
        done.map(drop).map_err(|error| OffscreenError(error.to_string()))
    }
}
