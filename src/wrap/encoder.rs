use super::command::{CommandList, EncoderCommand, FinishedCommands, PassTargets};
use super::compute_pass::ComputePass;
use super::render_pass::RenderPass;
use super::shared::SharedDevice;
use super::{WrappedObject, copy_end};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use wgpu::custom::{
    CommandBufferInterface, CommandEncoderInterface, DispatchBuffer, DispatchCommandBuffer, DispatchComputePass,
    DispatchQuerySet, DispatchRenderPass, DispatchTexture,
};

/// Encodes at once; while a frame is recorded, writes a list beside that.
#[derive(Debug)]
pub struct CommandEncoder {
    inner: Mutex<Option<wgpu::CommandEncoder>>,
    list: Option<CommandList>,
    has_passes: AtomicBool,
}

impl CommandEncoder {
    /// Creates the real encoder, and a list for its calls if a frame is being recorded at this time.
    pub fn new(
        device: &wgpu::Device,
        descriptor: &wgpu::CommandEncoderDescriptor<'_>,
        shared: &SharedDevice,
    ) -> CommandEncoder {
        let list = shared.recorder.is_recording().then(CommandList::default);
        let inner = Mutex::new(Some(device.create_command_encoder(descriptor)));
        CommandEncoder { inner, list, has_passes: AtomicBool::new(false) }
    }

    fn lock(&self) -> MutexGuard<'_, Option<wgpu::CommandEncoder>> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Encodes a command on the real encoder, if it is not finished, and appends it to the list where calls are
    /// recorded.
    fn call(&self, command: impl Fn(&mut wgpu::CommandEncoder) + Send + Sync + 'static) {
        if let Some(encoder) = self.lock().as_mut() {
            command(encoder);
        }
        if let Some(list) = &self.list {
            list.push(EncoderCommand::Encode(Box::new(command)));
        }
    }
}

/// A stored end of a copy: the texture, and where in it.
#[derive(Debug, Clone)]
struct TextureEnd {
    texture: wgpu::Texture,
    mip_level: u32,
    origin: wgpu::Origin3d,
    aspect: wgpu::TextureAspect,
}

impl TextureEnd {
    fn of(end: wgpu::TexelCopyTextureInfo<'_>) -> TextureEnd {
        let wgpu::TexelCopyTextureInfo { texture, mip_level, origin, aspect } = copy_end(end);
        TextureEnd { texture: texture.clone(), mip_level, origin, aspect }
    }

    fn info(&self) -> wgpu::TexelCopyTextureInfo<'_> {
        let TextureEnd { texture, mip_level, origin, aspect } = self;
        wgpu::TexelCopyTextureInfo { texture, mip_level: *mip_level, origin: *origin, aspect: *aspect }
    }
}

/// A stored end of a copy: the buffer, and the layout of texels in it.
#[derive(Debug, Clone)]
struct BufferEnd {
    buffer: wgpu::Buffer,
    layout: wgpu::TexelCopyBufferLayout,
}

impl BufferEnd {
    fn of(end: wgpu::TexelCopyBufferInfo<'_>) -> BufferEnd {
        BufferEnd { buffer: end.buffer.real().clone(), layout: end.layout }
    }

    fn info(&self) -> wgpu::TexelCopyBufferInfo<'_> {
        wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout: self.layout }
    }
}

impl CommandEncoderInterface for CommandEncoder {
    fn copy_buffer_to_buffer(
        &self,
        source: &DispatchBuffer,
        from: u64,
        target: &DispatchBuffer,
        to: u64,
        size: Option<u64>,
    ) {
        let (source, target) = (source.real().clone(), target.real().clone());
        self.call(move |encoder| encoder.copy_buffer_to_buffer(&source, from, &target, to, size));
    }

    fn copy_buffer_to_texture(
        &self,
        source: wgpu::TexelCopyBufferInfo<'_>,
        target: wgpu::TexelCopyTextureInfo<'_>,
        size: wgpu::Extent3d,
    ) {
        let (source, target) = (BufferEnd::of(source), TextureEnd::of(target));
        self.call(move |encoder| encoder.copy_buffer_to_texture(source.info(), target.info(), size));
    }

    fn copy_texture_to_buffer(
        &self,
        source: wgpu::TexelCopyTextureInfo<'_>,
        target: wgpu::TexelCopyBufferInfo<'_>,
        size: wgpu::Extent3d,
    ) {
        let (source, target) = (TextureEnd::of(source), BufferEnd::of(target));
        self.call(move |encoder| encoder.copy_texture_to_buffer(source.info(), target.info(), size));
    }

    fn copy_texture_to_texture(
        &self,
        source: wgpu::TexelCopyTextureInfo<'_>,
        target: wgpu::TexelCopyTextureInfo<'_>,
        size: wgpu::Extent3d,
    ) {
        let (source, target) = (TextureEnd::of(source), TextureEnd::of(target));
        self.call(move |encoder| encoder.copy_texture_to_texture(source.info(), target.info(), size));
    }

    fn begin_compute_pass(&self, descriptor: &wgpu::ComputePassDescriptor<'_>) -> DispatchComputePass {
        DispatchComputePass::custom(ComputePass::begin(&mut self.lock(), self.list.as_ref(), descriptor))
    }

    fn begin_render_pass(&self, descriptor: &wgpu::RenderPassDescriptor<'_>) -> DispatchRenderPass {
        self.has_passes.store(true, Ordering::Relaxed);
        let targets = PassTargets::of(descriptor);
        DispatchRenderPass::custom(RenderPass::begin(&mut self.lock(), self.list.as_ref(), targets))
    }

    fn finish(&mut self) -> DispatchCommandBuffer {
        let inner = self.lock().take().map(wgpu::CommandEncoder::finish);
        let has_passes = *self.has_passes.get_mut();
        let finished = inner.map(|inner| FinishedCommands { inner, list: self.list.take(), has_passes });
        DispatchCommandBuffer::custom(CommandBuffer { finished: Mutex::new(finished) })
    }

    fn clear_texture(&self, texture: &DispatchTexture, range: &wgpu::ImageSubresourceRange) {
        let (texture, range) = (texture.real().clone(), *range);
        self.call(move |encoder| encoder.clear_texture(&texture, &range));
    }

    fn clear_buffer(&self, buffer: &DispatchBuffer, offset: u64, size: Option<u64>) {
        let buffer = buffer.real().clone();
        self.call(move |encoder| encoder.clear_buffer(&buffer, offset, size));
    }

    fn insert_debug_marker(&self, label: &str) {
        let label = label.to_owned();
        self.call(move |encoder| encoder.insert_debug_marker(&label));
    }

    fn push_debug_group(&self, label: &str) {
        if let Some(encoder) = self.lock().as_mut() {
            encoder.push_debug_group(label);
        }
        if let Some(list) = &self.list {
            list.push(EncoderCommand::PushGroup(label.to_owned()));
        }
    }

    fn pop_debug_group(&self) {
        if let Some(encoder) = self.lock().as_mut() {
            encoder.pop_debug_group();
        }
        if let Some(list) = &self.list {
            list.push(EncoderCommand::PopGroup);
        }
    }

    fn write_timestamp(&self, queries: &DispatchQuerySet, index: u32) {
        let queries = queries.real().clone();
        self.call(move |encoder| encoder.write_timestamp(&queries, index));
    }

    fn resolve_query_set(
        &self,
        queries: &DispatchQuerySet,
        first: u32,
        count: u32,
        target: &DispatchBuffer,
        offset: u64,
    ) {
        let (queries, target) = (queries.real().clone(), target.real().clone());
        // A sum that is too large is refused by wgpu.
        let range = first..first.saturating_add(count);
        self.call(move |encoder| encoder.resolve_query_set(&queries, range.clone(), &target, offset));
    }

    // No device has the feature that these need.
    fn mark_acceleration_structures_built<'a>(
        &self,
        _: &mut dyn Iterator<Item = &'a wgpu::Blas>,
        _: &mut dyn Iterator<Item = &'a wgpu::Tlas>,
    ) {
    }

    fn build_acceleration_structures<'a>(
        &self,
        _: &mut dyn Iterator<Item = &'a wgpu::BlasBuildEntry<'a>>,
        _: &mut dyn Iterator<Item = &'a wgpu::Tlas>,
    ) {
    }

    fn transition_resources<'a>(
        &mut self,
        buffers: &mut dyn Iterator<Item = wgpu::BufferTransition<&'a DispatchBuffer>>,
        textures: &mut dyn Iterator<Item = wgpu::TextureTransition<&'a DispatchTexture>>,
    ) {
        let buffers: Vec<(wgpu::Buffer, wgpu::BufferUses)> =
            buffers.map(|one| (one.buffer.real().clone(), one.state)).collect();
        let textures: Vec<(wgpu::Texture, Option<wgpu_types::TextureSelector>, wgpu::TextureUses)> =
            textures.map(|one| (one.texture.real().clone(), one.selector, one.state)).collect();
        self.call(move |encoder| {
            encoder.transition_resources(
                buffers.iter().map(|(buffer, state)| wgpu::BufferTransition { buffer, state: *state }),
                textures.iter().map(|(texture, selector, state)| wgpu::TextureTransition {
                    texture,
                    selector: selector.clone(),
                    state: *state,
                }),
            );
        });
    }
}

/// A wrapped command buffer: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct CommandBuffer {
    finished: Mutex<Option<FinishedCommands>>,
}

impl CommandBuffer {
    /// Takes the encoder's finished commands for submission; `None` where they were taken before.
    pub fn take(&self) -> Option<FinishedCommands> {
        self.finished.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl CommandBufferInterface for CommandBuffer {}
