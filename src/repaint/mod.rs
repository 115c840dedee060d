//! A window's picture that is kept from one frame to the next, so that only what changed is drawn again.

mod damage;

use damage::WindowDamage;

use egui::{ClippedPrimitive, Color32, TexturesDelta};
use egui_wgpu::{RenderState, ScreenDescriptor};
use wgpu::{Extent3d, LoadOp, Operations, TextureUsages};

/// A texture that has what a window shows, on the window's GPU.
#[derive(Default)]
pub struct RetainedTarget {
    damage: WindowDamage,
    texture: Option<wgpu::Texture>,
}

impl RetainedTarget {
    /// Applies changes of textures, draws what changed since the call before, and returns the texture, which is as large as the
    /// screen; it is another one after a change of that size. Textures that are to be freed are freed. `screen` has an area.
    pub fn draw(
        &mut self,
        gpu: &RenderState,
        screen: &ScreenDescriptor,
        primitives: &[ClippedPrimitive],
        ground: Color32,
        textures: &mut TexturesDelta,
    ) -> wgpu::Texture {
        let (device, queue) = (&gpu.device, &gpu.queue);
        let [width, height] = screen.size_in_pixels;
        let size = Extent3d { width, height, depth_or_array_layers: 1 };
        let kept = self.texture.take().filter(|texture| texture.size() == size);
        if kept.is_none() {
            self.damage = WindowDamage::default();
        }
        let texture = kept.unwrap_or_else(|| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("window"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: gpu.target_format,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        });
        let rects = self.damage.update(screen, ground, primitives, textures);
        let damaged = damage::within(&rects, screen, ground, primitives);
        let mut renderer = gpu.renderer.write();
        for (id, deltas) in std::mem::take(&mut textures.set) {
            deltas.iter().for_each(|delta| renderer.update_texture(device, queue, id, delta));
        }
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let before = renderer.update_buffers(device, queue, &mut encoder, &damaged, screen);
        if !damaged.is_empty() {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("what changed of a window"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &texture.create_view(&wgpu::TextureViewDescriptor::default()),
                    depth_slice: None,
                    resolve_target: None,
                    ops: Operations { load: LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            renderer.render(&mut pass.forget_lifetime(), &damaged, screen);
        }
        queue.submit(before.into_iter().chain([encoder.finish()]));
        for id in std::mem::take(&mut textures.free) {
            renderer.free_texture(&id);
        }
        self.texture.insert(texture).clone()
    }
}
