use super::encoder::CommandBuffer;
use super::shared::SharedDevice;
use super::surface::SurfaceOutput;
use super::{WrappedObject, copy_end};
use std::sync::Arc;
use wgpu::custom::{
    BoxSubmittedWorkDoneCallback, DispatchBlas, DispatchBuffer, DispatchCommandBuffer, DispatchQueueWriteBuffer,
    DispatchSurfaceOutputDetail, QueueInterface, QueueWriteBufferInterface,
};

/// A wrapped queue: forwards writes to the real queue, hands submitted command buffers to the recorder, and reports to
/// it when a picture is presented.
#[derive(Debug)]
pub struct Queue {
    pub inner: wgpu::Queue,
    pub shared: Arc<SharedDevice>,
}

impl QueueInterface for Queue {
    fn write_buffer(&self, buffer: &DispatchBuffer, offset: u64, data: &[u8]) {
        self.inner.write_buffer(buffer.real(), offset, data);
    }

    fn create_staging_buffer(&self, size: wgpu::BufferSize) -> Option<DispatchQueueWriteBuffer> {
        let bytes = vec![0; usize::try_from(size.get()).ok()?];
        Some(DispatchQueueWriteBuffer::custom(StagingBytes(bytes)))
    }

    fn validate_write_buffer(&self, buffer: &DispatchBuffer, offset: u64, size: wgpu::BufferSize) -> Option<()> {
        // As wgpu validates it: a view that is dropped at once would write zeros, so that only an empty one is tried.
        let buffer = buffer.real();
        let is_aligned = [offset, size.get()].iter().all(|bytes| bytes.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT));
        let fits = is_aligned && offset.checked_add(size.get()).is_some_and(|end| end <= buffer.size());
        if !fits || !buffer.usage().contains(wgpu::BufferUsages::COPY_DST) {
            // The same call on the real queue reports the error, and gives no view.
            return self.inner.write_buffer_with(buffer, offset, size).map(drop);
        }
        Some(())
    }

    fn write_staging_buffer(&self, buffer: &DispatchBuffer, offset: u64, staging: &DispatchQueueWriteBuffer) {
        if let Some(StagingBytes(bytes)) = staging.as_custom() {
            self.inner.write_buffer(buffer.real(), offset, bytes);
        }
    }

    fn write_texture(
        &self,
        end: wgpu::TexelCopyTextureInfo<'_>,
        data: &[u8],
        layout: wgpu::TexelCopyBufferLayout,
        size: wgpu::Extent3d,
    ) {
        self.inner.write_texture(copy_end(end), data, layout, size);
    }

    fn submit(&self, buffers: &mut dyn Iterator<Item = DispatchCommandBuffer>) -> u64 {
        let buffers: Vec<_> = buffers.filter_map(|buffer| buffer.as_custom::<CommandBuffer>()?.take()).collect();
        let index = self.shared.recorder.submit(&self.shared, buffers);
        self.shared.submitted(index)
    }

    fn get_timestamp_period(&self) -> f32 {
        self.inner.get_timestamp_period()
    }

    fn on_submitted_work_done(&self, callback: BoxSubmittedWorkDoneCallback) {
        self.inner.on_submitted_work_done(callback);
    }

    fn compact_blas(&self, blas: &DispatchBlas) -> (Option<u64>, DispatchBlas) {
        let inner = self.inner.compact_blas(blas.real());
        (inner.handle(), DispatchBlas::custom(super::ray_tracing::Blas { inner }))
    }

    fn present(&self, detail: &DispatchSurfaceOutputDetail) {
        if let Some(picture) = detail.as_custom::<SurfaceOutput>().and_then(SurfaceOutput::take) {
            self.inner.present(picture);
            self.shared.recorder.presented(&self.shared);
        }
    }
}

/// Bytes that are written into a buffer later.
#[derive(Debug)]
struct StagingBytes(Vec<u8>);

#[expect(unsafe_code, reason = "wgpu's interface; nothing unsafe is done")]
impl QueueWriteBufferInterface for StagingBytes {
    fn len(&self) -> usize {
        self.0.len()
    }

    unsafe fn write_slice(&mut self) -> wgpu::WriteOnly<'_, [u8]> {
        wgpu::WriteOnly::from_mut(&mut self.0[..])
    }
}
