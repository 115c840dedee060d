use super::binding::{BindGroup, BindGroupLayout, PipelineLayout};
use super::bundle::RenderBundleEncoder;
use super::encoder::CommandEncoder;
use super::pipeline::{ComputePipeline, PipelineCache, RenderPipeline};
use super::shader::{ShaderModule, ShaderSource};
use super::shared::SharedDevice;
use super::{WrappedObject, buffer, query, ray_tracing, texture};
use std::cell::RefCell;
use std::collections::HashMap;
use std::future::ready;
use std::mem::ManuallyDrop;
use std::pin::Pin;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::custom::*;

thread_local! {
    /// Error scopes belong to the thread that opens them. A guard that is dropped closes its scope, so that those that
    /// a program leaves open are never dropped.
    static SCOPES: RefCell<HashMap<u32, ManuallyDrop<wgpu::ErrorScopeGuard>>> = RefCell::default();
}

static NEXT_SCOPE: AtomicU32 = AtomicU32::new(0);

/// A wrapped device: makes wrapped objects, and has the recorder that encoders and the queue report to.
#[derive(Debug)]
pub struct Device {
    pub inner: wgpu::Device,
    /// The features that the program asked for.
    pub features: wgpu::Features,
    pub limits: wgpu::Limits,
    pub shared: Arc<SharedDevice>,
}

impl DeviceInterface for Device {
    fn features(&self) -> wgpu::Features {
        self.features
    }

    fn limits(&self) -> wgpu::Limits {
        let wgpu::Limits { max_bind_groups, max_storage_buffers_per_shader_stage, .. } = self.limits;
        wgpu::Limits { max_bind_groups, max_storage_buffers_per_shader_stage, ..self.inner.limits() }
    }

    fn adapter_info(&self) -> wgpu::AdapterInfo {
        self.inner.adapter_info()
    }

    #[expect(unsafe_code, reason = "the checks are those that the program chose")]
    fn create_shader_module(
        &self,
        descriptor: wgpu::ShaderModuleDescriptor<'_>,
        checks: wgpu::ShaderRuntimeChecks,
    ) -> DispatchShaderModule {
        let source = ShaderSource::of(&descriptor.source);
        let inner = unsafe { self.inner.create_shader_module_trusted(descriptor, checks) };
        DispatchShaderModule::custom(ShaderModule { inner, source })
    }

    #[expect(unsafe_code, reason = "the program promises what wgpu asks for, and it is handed on")]
    unsafe fn create_shader_module_passthrough(
        &self,
        descriptor: &wgpu::ShaderModuleDescriptorPassthrough<'_>,
    ) -> DispatchShaderModule {
        let inner = unsafe { self.inner.create_shader_module_passthrough(descriptor.clone()) };
        DispatchShaderModule::custom(ShaderModule { inner, source: ShaderSource::Unread })
    }

    fn create_bind_group_layout(&self, descriptor: &wgpu::BindGroupLayoutDescriptor<'_>) -> DispatchBindGroupLayout {
        let inner = self.inner.create_bind_group_layout(descriptor);
        DispatchBindGroupLayout::custom(BindGroupLayout { inner })
    }

    fn create_bind_group(&self, descriptor: &wgpu::BindGroupDescriptor<'_>) -> DispatchBindGroup {
        DispatchBindGroup::custom(BindGroup::new(&self.inner, descriptor))
    }

    fn create_pipeline_layout(&self, descriptor: &wgpu::PipelineLayoutDescriptor<'_>) -> DispatchPipelineLayout {
        DispatchPipelineLayout::custom(PipelineLayout::new(&self.inner, descriptor))
    }

    fn create_render_pipeline(&self, descriptor: &wgpu::RenderPipelineDescriptor<'_>) -> DispatchRenderPipeline {
        DispatchRenderPipeline::custom(RenderPipeline::new(&self.inner, descriptor))
    }

    fn create_mesh_pipeline(&self, descriptor: &wgpu::MeshPipelineDescriptor<'_>) -> DispatchRenderPipeline {
        DispatchRenderPipeline::custom(RenderPipeline::of_meshlets(&self.inner, descriptor))
    }

    fn create_compute_pipeline(&self, descriptor: &wgpu::ComputePipelineDescriptor<'_>) -> DispatchComputePipeline {
        DispatchComputePipeline::custom(ComputePipeline::new(&self.inner, descriptor))
    }

    #[expect(unsafe_code, reason = "the program promises what wgpu asks for, and it is handed on")]
    unsafe fn create_pipeline_cache(&self, descriptor: &wgpu::PipelineCacheDescriptor<'_>) -> DispatchPipelineCache {
        let inner = unsafe { self.inner.create_pipeline_cache(descriptor) };
        DispatchPipelineCache::custom(PipelineCache { inner })
    }

    fn create_buffer(&self, asked: &wgpu::BufferDescriptor<'_>) -> DispatchBuffer {
        let usage = buffer::usage(asked.usage);
        let inner = self.inner.create_buffer(&wgpu::BufferDescriptor { usage, ..asked.clone() });
        DispatchBuffer::custom(buffer::Buffer { inner })
    }

    fn create_texture(&self, asked: &wgpu::TextureDescriptor<'_>) -> DispatchTexture {
        let usage = texture::usage(asked);
        let inner = self.inner.create_texture(&wgpu::TextureDescriptor { usage, ..asked.clone() });
        DispatchTexture::custom(texture::Texture { inner })
    }

    fn create_external_texture(
        &self,
        descriptor: &wgpu::ExternalTextureDescriptor<'_>,
        planes: &[&wgpu::TextureView],
    ) -> DispatchExternalTexture {
        let planes: Vec<&wgpu::TextureView> = planes.iter().map(|plane| plane.real()).collect();
        let inner = self.inner.create_external_texture(descriptor, &planes);
        DispatchExternalTexture::custom(texture::ExternalTexture { inner })
    }

    fn create_blas(
        &self,
        descriptor: &wgpu::CreateBlasDescriptor<'_>,
        sizes: wgpu::BlasGeometrySizeDescriptors,
    ) -> (Option<u64>, DispatchBlas) {
        let inner = self.inner.create_blas(descriptor, sizes);
        (inner.handle(), DispatchBlas::custom(ray_tracing::Blas { inner }))
    }

    fn create_tlas(&self, descriptor: &wgpu::CreateTlasDescriptor<'_>) -> DispatchTlas {
        DispatchTlas::custom(ray_tracing::Tlas { inner: self.inner.create_tlas(descriptor) })
    }

    fn create_sampler(&self, descriptor: &wgpu::SamplerDescriptor<'_>) -> DispatchSampler {
        DispatchSampler::custom(texture::Sampler { inner: self.inner.create_sampler(descriptor) })
    }

    fn create_query_set(&self, descriptor: &wgpu::QuerySetDescriptor<'_>) -> DispatchQuerySet {
        DispatchQuerySet::custom(query::QuerySet { inner: self.inner.create_query_set(descriptor) })
    }

    fn create_command_encoder(&self, descriptor: &wgpu::CommandEncoderDescriptor<'_>) -> DispatchCommandEncoder {
        DispatchCommandEncoder::custom(CommandEncoder::new(&self.inner, descriptor, &self.shared))
    }

    fn create_render_bundle_encoder(
        &self,
        descriptor: &wgpu::RenderBundleEncoderDescriptor<'_>,
    ) -> DispatchRenderBundleEncoder {
        DispatchRenderBundleEncoder::custom(RenderBundleEncoder::new(&self.inner, descriptor))
    }

    fn set_device_lost_callback(&self, callback: BoxDeviceLostCallback) {
        let callback = Mutex::new(Some(callback));
        self.inner.set_device_lost_callback(move |reason, message| {
            let once = callback.lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some(callback) = once {
                callback(reason, message);
            }
        });
    }

    fn on_uncaptured_error(&self, handler: Arc<dyn wgpu::UncapturedErrorHandler>) {
        self.inner.on_uncaptured_error(handler);
    }

    fn push_error_scope(&self, filter: wgpu::ErrorFilter) -> u32 {
        let index = NEXT_SCOPE.fetch_add(1, Ordering::Relaxed);
        let guard = ManuallyDrop::new(self.inner.push_error_scope(filter));
        SCOPES.with_borrow_mut(|scopes| scopes.insert(index, guard));
        index
    }

    fn pop_error_scope(&self, index: u32) -> Pin<Box<dyn PopErrorScopeFuture>> {
        let guard = SCOPES.with_borrow_mut(|scopes| scopes.remove(&index));
        let error = guard.and_then(|guard| pollster::block_on(ManuallyDrop::into_inner(guard).pop()));
        Box::pin(ready(error))
    }

    #[expect(unsafe_code, reason = "the program promises what wgpu asks for, and it is handed on")]
    unsafe fn start_graphics_debugger_capture(&self) {
        unsafe { self.inner.start_graphics_debugger_capture() }
    }

    #[expect(unsafe_code, reason = "the program promises what wgpu asks for, and it is handed on")]
    unsafe fn stop_graphics_debugger_capture(&self) {
        unsafe { self.inner.stop_graphics_debugger_capture() }
    }

    fn poll(&self, kind: wgpu_types::PollType<u64>) -> Result<wgpu::PollStatus, wgpu::PollError> {
        let kind = match kind {
            wgpu_types::PollType::Wait { submission_index, timeout } => {
                let submission_index = submission_index.and_then(|number| self.shared.submission(number));
                wgpu::PollType::Wait { submission_index, timeout }
            }
            wgpu_types::PollType::Poll => wgpu::PollType::Poll,
        };
        self.inner.poll(kind)
    }

    fn get_internal_counters(&self) -> wgpu::InternalCounters {
        self.inner.get_internal_counters()
    }

    fn generate_allocator_report(&self) -> Option<wgpu::AllocatorReport> {
        self.inner.generate_allocator_report()
    }

    fn destroy(&self) {
        self.inner.destroy();
    }
}
