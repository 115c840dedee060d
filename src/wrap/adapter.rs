use super::device::Device;
use super::queue::Queue;
use super::shared::{MakeRecorder, SharedDevice};
use super::{WrappedObject, ray_tracing};
use std::future::ready;
use std::pin::Pin;
use std::sync::Arc;
use wgpu::custom::{AdapterInterface, DispatchDevice, DispatchQueue, DispatchSurface, RequestDeviceFuture};

/// Features that recording needs, where the adapter has them: vertex shaders that log positions, fragment shaders that
/// log their triangle.
const WANTED: wgpu::Features = wgpu::Features::VERTEX_WRITABLE_STORAGE.union(wgpu::Features::PRIMITIVE_INDEX);

/// A wrapped adapter: hands each call to the real one.
#[derive(Debug)]
pub struct Adapter {
    pub inner: wgpu::Adapter,
    pub recorder: MakeRecorder,
}

impl Adapter {
    /// Returns the limits asked for, with one bind group and two storage buffers a stage more for our own use, as far
    /// as the adapter has them; never less than asked for.
    fn with_margin(&self, asked: &wgpu::Limits) -> wgpu::Limits {
        let most = self.inner.limits();
        let more = |by: u32, asked: u32, most: u32| asked.max(most.min(asked.saturating_add(by)));
        wgpu::Limits {
            max_bind_groups: more(1, asked.max_bind_groups, most.max_bind_groups),
            max_storage_buffers_per_shader_stage: more(
                2,
                asked.max_storage_buffers_per_shader_stage,
                most.max_storage_buffers_per_shader_stage,
            ),
            ..asked.clone()
        }
    }
}

impl AdapterInterface for Adapter {
    fn request_device(&self, asked: &wgpu::DeviceDescriptor<'_>) -> Pin<Box<dyn RequestDeviceFuture>> {
        let mut wanted = asked.clone();
        wanted.required_features |= WANTED & self.inner.features();
        wanted.required_limits = self.with_margin(&asked.required_limits);
        if asked.required_features.intersects(ray_tracing::NOT_WRAPPED) {
            // The adapter hides them: it must not give them either.
            wanted.required_features = wgpu::Features::all();
        }
        let made = pollster::block_on(self.inner.request_device(&wanted)).map(|(device, queue)| {
            let shared = Arc::new(SharedDevice::new(&device, &queue, &self.inner, self.recorder));
            let (features, limits) = (asked.required_features, asked.required_limits.clone());
            let device = Device { inner: device, features, limits, shared: shared.clone() };
            (DispatchDevice::custom(device), DispatchQueue::custom(Queue { inner: queue, shared }))
        });
        Box::pin(ready(made))
    }

    fn is_surface_supported(&self, surface: &DispatchSurface) -> bool {
        self.inner.is_surface_supported(surface.real())
    }

    fn features(&self) -> wgpu::Features {
        self.inner.features() - ray_tracing::NOT_WRAPPED
    }

    fn limits(&self) -> wgpu::Limits {
        self.inner.limits()
    }

    fn downlevel_capabilities(&self) -> wgpu::DownlevelCapabilities {
        self.inner.get_downlevel_capabilities()
    }

    fn get_info(&self) -> wgpu::AdapterInfo {
        self.inner.get_info()
    }

    fn get_texture_format_features(&self, format: wgpu::TextureFormat) -> wgpu::TextureFormatFeatures {
        self.inner.get_texture_format_features(format)
    }

    fn get_presentation_timestamp(&self) -> wgpu::PresentationTimestamp {
        self.inner.get_presentation_timestamp()
    }

    fn cooperative_matrix_properties(&self) -> Vec<wgpu::CooperativeMatrixProperties> {
        self.inner.cooperative_matrix_properties()
    }
}
