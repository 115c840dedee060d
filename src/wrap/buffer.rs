use std::ops::Range;
use wgpu::custom::{BufferInterface, BufferMapCallback, BufferMappedRangeInterface, DispatchBufferMappedRange};

/// A wrapped buffer: hands each call to the real one.
#[derive(Debug)]
pub struct Buffer {
    pub inner: wgpu::Buffer,
}

/// Returns the usage that a buffer is created with, so that a recorded draw's indices and counts can be read.
pub fn usage(asked: wgpu::BufferUsages) -> wgpu::BufferUsages {
    let is_read = asked.intersects(wgpu::BufferUsages::INDEX | wgpu::BufferUsages::INDIRECT);
    // Mappable buffers can be copied from or to only in their own direction.
    let can_be_copied = !asked.contains(wgpu::BufferUsages::MAP_READ);
    if is_read && can_be_copied { asked | wgpu::BufferUsages::COPY_SRC } else { asked }
}

impl BufferInterface for Buffer {
    fn map_async(&self, mode: wgpu::MapMode, range: Range<u64>, callback: BufferMapCallback) {
        self.inner.map_async(mode, range, callback);
    }

    fn get_mapped_range(&self, range: Range<u64>) -> Result<DispatchBufferMappedRange, wgpu::MapRangeError> {
        // Whether it is for reading or writing is not known yet: errors must show now.
        let view = self.inner.get_mapped_range(range.clone())?;
        Ok(DispatchBufferMappedRange::custom(MappedRange {
            buffer: self.inner.clone(),
            range,
            view: MappedView::Read(view),
        }))
    }

    fn unmap(&self) {
        self.inner.unmap();
    }

    fn destroy(&self) {
        self.inner.destroy();
    }
}

#[derive(Debug)]
struct MappedRange {
    buffer: wgpu::Buffer,
    range: Range<u64>,
    view: MappedView,
}

#[derive(Debug)]
enum MappedView {
    Read(wgpu::BufferView),
    Write(wgpu::BufferViewMut),
    /// The buffer was unmapped in between: what is written is discarded.
    Gone(Vec<u8>),
}

impl MappedRange {
    fn length(&self) -> usize {
        (self.range.end - self.range.start) as usize
    }
}

#[expect(unsafe_code, reason = "wgpu's interface: it reads only read mappings, and writes only write mappings")]
impl BufferMappedRangeInterface for MappedRange {
    fn len(&self) -> usize {
        self.length()
    }

    unsafe fn read_slice(&self) -> &[u8] {
        match &self.view {
            MappedView::Read(view) => view,
            MappedView::Write(_) => &[],
            MappedView::Gone(bytes) => bytes,
        }
    }

    unsafe fn write_slice(&mut self) -> wgpu::WriteOnly<'_, [u8]> {
        if matches!(self.view, MappedView::Read(_)) {
            // Only one view of these bytes may exist at a time: the first is dropped before the second is created.
            self.view = MappedView::Gone(Vec::new());
            let view = self.buffer.get_mapped_range_mut(self.range.clone());
            self.view = view.map_or_else(|_| MappedView::Gone(vec![0; self.length()]), MappedView::Write);
        }
        match &mut self.view {
            MappedView::Write(view) => view.slice(..),
            MappedView::Gone(bytes) => wgpu::WriteOnly::from_mut(&mut bytes[..]),
            MappedView::Read(_) => wgpu::WriteOnly::from_mut(&mut []),
        }
    }
}
