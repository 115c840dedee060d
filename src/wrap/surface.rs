use super::WrappedObject;
use super::texture::Texture;
use std::sync::{Mutex, PoisonError};
use wgpu::custom::{
    DispatchAdapter, DispatchDevice, DispatchSurfaceOutputDetail, DispatchTexture, SurfaceInterface,
    SurfaceOutputDetailInterface,
};
use wgpu::{CurrentSurfaceTexture, SurfaceStatus};

/// A wrapped surface: hands each call to the real one.
#[derive(Debug)]
pub struct Surface {
    pub inner: wgpu::Surface<'static>,
}

impl SurfaceInterface for Surface {
    fn get_capabilities(&self, adapter: &DispatchAdapter) -> wgpu::SurfaceCapabilities {
        self.inner.get_capabilities(adapter.real())
    }

    fn display_hdr_info(&self, adapter: &DispatchAdapter) -> wgpu::DisplayHdrInfo {
        self.inner.display_hdr_info(adapter.real())
    }

    fn configure(&self, device: &DispatchDevice, asked: &wgpu::SurfaceConfiguration) {
        let device = device.as_custom::<super::Device>().expect(super::FOREIGN);
        device.shared.has_surface();
        let can = self.inner.get_capabilities(&device.shared.adapter).usages;
        let usage = asked.usage | (can & wgpu::TextureUsages::COPY_SRC);
        self.inner.configure(&device.inner, &wgpu::SurfaceConfiguration { usage, ..asked.clone() });
    }

    fn get_current_texture(&self) -> (Option<DispatchTexture>, SurfaceStatus, DispatchSurfaceOutputDetail) {
        let (texture, status) = match self.inner.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) => (Some(texture), SurfaceStatus::Good),
            CurrentSurfaceTexture::Suboptimal(texture) => (Some(texture), SurfaceStatus::Suboptimal),
            CurrentSurfaceTexture::Timeout => (None, SurfaceStatus::Timeout),
            CurrentSurfaceTexture::Occluded => (None, SurfaceStatus::Occluded),
            CurrentSurfaceTexture::Outdated => (None, SurfaceStatus::Outdated),
            CurrentSurfaceTexture::Lost => (None, SurfaceStatus::Lost),
            CurrentSurfaceTexture::Validation => (None, SurfaceStatus::Validation),
        };
        let shown = texture.as_ref().map(|texture| Texture { inner: texture.texture.clone() });
        let detail = SurfaceOutput { inner: Mutex::new(texture) };
        (shown.map(DispatchTexture::custom), status, DispatchSurfaceOutputDetail::custom(detail))
    }
}

/// A surface's real picture, until the program presents or drops it.
#[derive(Debug)]
pub struct SurfaceOutput {
    inner: Mutex<Option<wgpu::SurfaceTexture>>,
}

impl SurfaceOutput {
    /// Takes the real picture, to be presented or dropped; `None` where it was taken before.
    pub fn take(&self) -> Option<wgpu::SurfaceTexture> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl SurfaceOutputDetailInterface for SurfaceOutput {
    fn texture_discard(&self) {
        drop(self.take());
    }

    fn texture_release(&self) {
        drop(self.take());
    }
}
