//! Maps and textures of lights that are cached from frame to frame while nothing that makes them changes.

use crate::last_used::LastUsed;
use crate::plan::{AttachmentId, FramePlan};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wgpu::Texture;

/// Shadow maps by [`FramePlan::cache_key`], cached as long as the newest plan that caches maps uses them.
#[derive(Debug, Default)]
pub(super) struct MapCache {
    cached: LastUsed<u64, Arc<CachedMap>>,
}

/// The texture of a cached shadow map, and whether the passes that draw it have run.
#[derive(Debug)]
pub(super) struct CachedMap {
    pub texture: Arc<Texture>,
    is_drawn: AtomicBool,
}

impl CachedMap {
    /// Returns whether the passes that draw the map have run, and need not run again.
    pub fn is_drawn(&self) -> bool {
        self.is_drawn.load(Ordering::Relaxed)
    }

    /// Notes that the passes that draw the map have run.
    pub fn set_drawn(&self) {
        self.is_drawn.store(true, Ordering::Relaxed);
    }
}

impl MapCache {
    /// Drops the maps that [`get`](Self::get) has not returned since the last call.
    pub fn next_plan(&mut self) {
        self.cached.next_plan();
    }

    /// Returns the cached texture of an attachment, made by `create` if it is new; `None` where the attachment is drawn
    /// in every frame.
    pub fn get(
        &mut self,
        plan: &FramePlan,
        id: AttachmentId,
        create: impl FnOnce() -> Arc<Texture>,
    ) -> Option<Arc<CachedMap>> {
        let new = || Arc::new(CachedMap { texture: create(), is_drawn: AtomicBool::new(false) });
        Some(self.cached.get_or_make(plan.cache_key(id)?, new))
    }
}
