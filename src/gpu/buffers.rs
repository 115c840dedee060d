//! Vertex and index data on the GPU, by the hash of its content.
//!
//! Equal data is uploaded once, and stays as long as the newest plan uses it.

use super::{GpuContext, GpuError};
use crate::last_used::LastUsed;
use crate::plan::Blob;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device, PollType};

/// What is larger than this, in bytes, is copied to the GPU in parts of so much, each before the next.
const LARGE: usize = 16 << 20;

/// The hash of a buffer's content, and its length in bytes.
type Key = (u64, usize);

#[derive(Debug, Default)]
pub(super) struct Buffers {
    cached: LastUsed<Key, Buffer>,
}

impl Buffers {
    /// Drops the buffers that [`get`](Self::get) has not returned since the last call.
    pub fn next_plan(&mut self) {
        self.cached.next_plan();
    }

    /// Returns the buffer with a blob's content, uploaded on first use and cached by content; an empty blob gets a
    /// placeholder. It can be bound as vertex, index or storage buffer; call `check_bound` before the last. Fails where
    /// it exceeds the device's largest buffer.
    pub fn get<T: bytemuck::Pod>(&mut self, context: &GpuContext, blob: &Blob<T>) -> Result<Buffer, GpuError> {
        let GpuContext { device, queue, .. } = context;
        let contents = blob.bytes();
        check(contents.len() as u64, device.limits().max_buffer_size)?;
        let usage = BufferUsages::VERTEX | BufferUsages::INDEX | BufferUsages::STORAGE;
        // Nothing can't be bound: it is one entry that nothing is like.
        let nothing = [u8::MAX; 16];
        let contents = if contents.is_empty() { &nothing[..] } else { contents };
        let key = (blob.hash(), contents.len());
        if contents.len() <= LARGE {
            let upload = || device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage });
            return Ok(self.cached.get_or_make(key, upload));
        }
        let mut is_new = false;
        let buffer = self.cached.get_or_make(key, || {
            is_new = true;
            let (size, usage) = (contents.len() as u64, usage | BufferUsages::COPY_DST);
            device.create_buffer(&BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        });
        // What is not copied yet is in memory twice.
        for (offset, part) in (0..).step_by(LARGE).zip(contents.chunks(LARGE)).filter(|_| is_new) {
            queue.write_buffer(&buffer, offset, part);
            queue.submit([]);
            device.poll(PollType::wait_indefinitely()).map_err(|error| GpuError::Driver(error.to_string()))?;
        }
        Ok(buffer)
    }
}

/// Fails where a buffer is too large for the device to bind as a storage buffer.
pub(super) fn check_bound(device: &Device, storage: &Buffer) -> Result<(), GpuError> {
    check(storage.size(), device.limits().max_storage_buffer_binding_size)
}

fn check(bytes: u64, most: u64) -> Result<(), GpuError> {
    if bytes <= most { Ok(()) } else { Err(GpuError::MeshTooLarge { needed: bytes, most }) }
}
