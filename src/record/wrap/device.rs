use super::binding::{BindGroup, BindGroupLayout, PipelineLayout};
use super::bundle::RenderBundleEncoder;
use super::encoder::CommandEncoder;
use super::pipeline::{ComputePipeline, PipelineCache, RenderPipeline};
use super::shader::{ShaderModule, Source};
use super::{Real, buffer, query, ray_tracing, texture};
use crate::record::recorder::Recorder;
use std::cell::RefCell;
use std::collections::{HashMap, VecDeque};
use std::future::ready;
use std::mem::ManuallyDrop;
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use wgpu::custom::*;

/// What instance, devices and surfaces know together of frames.
#[derive(Debug, Default)]
pub struct Frames {
    is_presented: AtomicBool,
}

impl Frames {
    /// From now on a frame ends where it is shown, not where it is submitted.
    pub fn are_presented(&self) {
        self.is_presented.store(true, Ordering::Relaxed);
    }

    /// Does a frame end where it is shown?
    pub fn end_where_shown(&self) -> bool {
        self.is_presented.load(Ordering::Relaxed)
    }
}

/// What a device, its queue and its encoders have in common.
#[derive(Debug)]
pub struct Shared {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub adapter: wgpu::Adapter,
    pub frames: Arc<Frames>,
    pub recorder: Recorder,
    submissions: Mutex<Submissions>,
}

impl Shared {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, adapter: &wgpu::Adapter, frames: Arc<Frames>) -> Shared {
        Shared {
            device: device.clone(),
            queue: queue.clone(),
            adapter: adapter.clone(),
            frames,
            recorder: Recorder::new(),
            submissions: Mutex::default(),
        }
    }

    /// The program's number of a submission.
    pub fn submitted(&self, index: wgpu::SubmissionIndex) -> u64 {
        self.submissions().add(index)
    }

    fn submissions(&self) -> MutexGuard<'_, Submissions> {
        self.submissions.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Submissions that a program may wait for. What is older than all that are kept is waited for with the oldest: it ends no later.
#[derive(Debug, Default)]
struct Submissions {
    kept: VecDeque<wgpu::SubmissionIndex>,
    /// The number of the first that is kept.
    first: u64,
}

impl Submissions {
    const MOST: usize = 1024;

    fn add(&mut self, index: wgpu::SubmissionIndex) -> u64 {
        self.kept.push_back(index);
        if self.kept.len() > Self::MOST {
            self.kept.pop_front();
            self.first += 1;
        }
        self.first + self.kept.len() as u64 - 1
    }

    fn real(&self, number: u64) -> Option<wgpu::SubmissionIndex> {
        let at = number.saturating_sub(self.first) as usize;
        self.kept.get(at).cloned()
    }
}

thread_local! {
    /// Error scopes belong to the thread that opens them. A guard that is dropped closes its scope, so that those that
    /// a program leaves open are never dropped.
    static SCOPES: RefCell<HashMap<u32, ManuallyDrop<wgpu::ErrorScopeGuard>>> = RefCell::default();
}

static NEXT_SCOPE: AtomicU32 = AtomicU32::new(0);

#[derive(Debug)]
pub struct Device {
    pub inner: wgpu::Device,
    /// As the program asked for them.
    pub features: wgpu::Features,
    pub limits: wgpu::Limits,
    pub shared: Arc<Shared>,
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
        let source = Source::of(&descriptor.source);
        let inner = unsafe { self.inner.create_shader_module_trusted(descriptor, checks) };
        DispatchShaderModule::custom(ShaderModule { inner, source })
    }

    #[expect(unsafe_code, reason = "the program promises what wgpu asks for, and it is handed on")]
    unsafe fn create_shader_module_passthrough(
        &self,
        descriptor: &wgpu::ShaderModuleDescriptorPassthrough<'_>,
    ) -> DispatchShaderModule {
        let inner = unsafe { self.inner.create_shader_module_passthrough(descriptor.clone()) };
        DispatchShaderModule::custom(ShaderModule { inner, source: Source::Unread })
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
                let submission_index = submission_index.and_then(|number| self.shared.submissions().real(number));
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
