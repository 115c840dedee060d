//! Textures of attachments, handed on from plan to plan.
//!
//! A frame that is set up anew, as a light moves, draws into textures like those of the frame before. New ones cost a page
//! fault for every page that is drawn to; those of a plan that is gone are there already. What they hold is as it is where
//! a frame runs twice: each plan clears what it reads.

use crate::plan::FramePlan;
use std::sync::Arc;
use wgpu::{Device, Texture, TextureFormat};

/// What a texture was made as.
type Made = wgpu_types::TextureDescriptor<Option<String>, Vec<TextureFormat>>;

/// They stay as long as the newest plan uses them.
#[derive(Debug, Default)]
pub(super) struct Attachments {
    kept: Vec<Kept>,
}

#[derive(Debug)]
struct Kept {
    texture: Arc<Texture>,
    made: Made,
    used: bool,
}

impl Attachments {
    /// Forgets what has not been asked for since the last call.
    pub fn next_plan(&mut self) {
        self.kept.retain_mut(|kept| std::mem::take(&mut kept.used));
    }

    /// A texture that no other plan uses. Of a frame that another program drew, which may read what it has not cleared,
    /// always a new one.
    pub fn get(&mut self, device: &Device, plan: &FramePlan, wanted: &wgpu::TextureDescriptor) -> Arc<Texture> {
        let create = || Arc::new(device.create_texture(wanted));
        if plan.passes.iter().any(|pass| pass.recorded.is_some()) {
            return create();
        }
        let made = wanted.map_label_and_view_formats(|label| label.map(str::to_owned), |formats| formats.to_vec());
        let is_free = |kept: &Kept| !kept.used && Arc::strong_count(&kept.texture) == 1 && kept.made == made;
        if let Some(kept) = self.kept.iter_mut().find(|kept| is_free(kept)) {
            kept.used = true;
            return kept.texture.clone();
        }
        let texture = create();
        self.kept.push(Kept { texture: texture.clone(), made, used: true });
        texture
    }
}
