use super::WrappedObject;
use super::adapter::Adapter;
use super::shared::{MakeRecorder, NoRecorder};
use super::surface::Surface;
use std::future::ready;
use std::pin::Pin;
use wgpu::custom::{DispatchAdapter, DispatchSurface, EnumerateAdapterFuture, InstanceInterface, RequestAdapterFuture};

/// A wrapped instance: hands each call to the real one.
#[derive(Debug)]
pub struct Instance {
    inner: wgpu::Instance,
    recorder: MakeRecorder,
}

impl Instance {
    /// Returns an instance whose devices have recorders from `recorder`.
    pub fn recorded_by(descriptor: wgpu::InstanceDescriptor, recorder: MakeRecorder) -> Instance {
        Instance { inner: wgpu::Instance::new(descriptor), recorder }
    }

    fn wrap(&self, inner: wgpu::Adapter) -> DispatchAdapter {
        DispatchAdapter::custom(Adapter { inner, recorder: self.recorder })
    }
}

impl InstanceInterface for Instance {
    fn new(descriptor: wgpu::InstanceDescriptor) -> Self {
        Instance::recorded_by(descriptor, || Box::new(NoRecorder))
    }

    #[expect(unsafe_code, reason = "the program promises what wgpu asks for, and it is handed on")]
    unsafe fn create_surface(
        &self,
        target: wgpu::SurfaceTargetUnsafe,
    ) -> Result<DispatchSurface, wgpu::CreateSurfaceError> {
        let inner = unsafe { self.inner.create_surface_unsafe(target) }?;
        Ok(DispatchSurface::custom(Surface { inner }))
    }

    fn request_adapter(&self, options: &wgpu::RequestAdapterOptions<'_, '_>) -> Pin<Box<dyn RequestAdapterFuture>> {
        let compatible_surface = options.compatible_surface.map(|surface| surface.real() as &wgpu::Surface<'_>);
        let options = wgpu::RequestAdapterOptions { compatible_surface, ..options.clone() };
        // Native backends answer at once.
        let found = pollster::block_on(self.inner.request_adapter(&options));
        Box::pin(ready(found.map(|adapter| self.wrap(adapter))))
    }

    fn poll_all_devices(&self, force_wait: bool) -> bool {
        self.inner.poll_all(force_wait)
    }

    fn wgsl_language_features(&self) -> wgpu::WgslLanguageFeatures {
        self.inner.wgsl_language_features()
    }

    fn enumerate_adapters(&self, backends: wgpu::Backends) -> Pin<Box<dyn EnumerateAdapterFuture>> {
        let found = pollster::block_on(self.inner.enumerate_adapters(backends));
        let wrapped: Vec<DispatchAdapter> = found.into_iter().map(|adapter| self.wrap(adapter)).collect();
        Box::pin(ready(wrapped))
    }
}
