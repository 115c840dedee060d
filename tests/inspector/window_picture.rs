//! The window drawn into a picture.

use super::Seen;
use egui_kittest::{Harness, TestRenderer};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use std::cell::RefCell;
use std::rc::Rc;
use stencilscope::offscreen::OffscreenPainter;
use stencilscope::picture::Picture;

/// If changes that were never drawn were dropped, egui would report a bug.
#[derive(Default)]
pub struct UndrawnTextures(egui::TexturesDelta);

impl Drop for UndrawnTextures {
    fn drop(&mut self) {
        self.0.clear();
    }
}

/// Gathers changes of textures from the harness, as [`window_picture`] may draw them later.
pub struct TextureCollector(pub Rc<RefCell<UndrawnTextures>>);

impl TestRenderer for TextureCollector {
    fn handle_delta(&mut self, delta: &mut egui::TexturesDelta) {
        self.0.borrow_mut().0.append(std::mem::take(delta));
    }
}

/// A painter that draws the same everywhere.
pub fn painter() -> OffscreenPainter {
    OffscreenPainter::new(RendererOptions::PREDICTABLE).expect("a GPU")
}

/// The window as of the harness's last frame.
pub fn window_picture(harness: &mut Harness<Seen>) -> Picture {
    let scale = harness.ctx.pixels_per_point();
    let size = harness.ctx.content_rect().size() * scale;
    let screen =
        ScreenDescriptor { size_in_pixels: [size.x.round() as u32, size.y.round() as u32], pixels_per_point: scale };
    let triangles = harness.ctx.tessellate(harness.output().shapes.clone(), scale);
    let seen = harness.state_mut();
    let textures = std::mem::take(&mut seen.textures.borrow_mut().0);
    seen.painter
        .get_or_insert_with(painter)
        .draw(&screen, &triangles, egui::Color32::BLACK, textures)
        .expect("a picture")
}
