//! What the GPU notes while it runs: when a pass began and ended, and how many samples of a draw passed.

use super::readback;
use super::{GpuContext, GpuError};
use crate::plan::{FramePlan, Pass};
use wgpu::{BufferUsages, CommandEncoder, Device, QuerySet, QueryType};

/// A set of queries of one kind, with the buffers that bring the results to the CPU.
struct QueryReadback {
    set: QuerySet,
    count: u32,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
}

impl QueryReadback {
    /// Makes a set of `count` queries; `None` for none, and for more than a query set holds (4096).
    fn new(device: &Device, ty: QueryType, count: u32) -> Option<QueryReadback> {
        if count == 0 || count > wgpu::QUERY_SET_MAX_QUERIES {
            return None;
        }
        let set = device.create_query_set(&wgpu::QuerySetDescriptor { label: None, ty, count });
        let buffer = |usage| {
            let size = u64::from(count) * 8;
            device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        };
        let resolved = buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC);
        let readable = buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ);
        Some(QueryReadback { set, count, resolved, readable })
    }

    fn resolve(&self, encoder: &mut CommandEncoder) {
        encoder.resolve_query_set(&self.set, 0..self.count, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.resolved.size());
    }

    fn request_map(&self) {
        // A failure shows when the mapped range is asked for.
        self.readable.map_async(wgpu::MapMode::Read, .., |_| {});
    }

    fn read(&self) -> Result<Vec<u64>, GpuError> {
        let bytes = readback::mapped_bytes(&self.readable)?;
        Ok(bytes.chunks_exact(8).map(bytemuck::pod_read_unaligned).collect())
    }
}

/// The queries that a frame writes: timestamps and sample counts.
#[derive(Default)]
pub(super) struct FrameQueries {
    pub timestamps: Option<PassTimestamps>,
    pub samples: Option<DrawSamples>,
}

impl FrameQueries {
    fn queries(&self) -> impl Iterator<Item = &QueryReadback> {
        let timestamps = self.timestamps.as_ref().map(|timestamps| &timestamps.queries);
        timestamps.into_iter().chain(self.samples.as_ref().map(|samples| &samples.queries))
    }

    /// Records the copy of all results to buffers, after the last pass.
    pub fn resolve(&self, encoder: &mut CommandEncoder) {
        self.queries().for_each(|queries| queries.resolve(encoder));
    }

    /// Asks for the result buffers to be mapped, after the frame was submitted.
    pub fn request_map(&self) {
        self.queries().for_each(QueryReadback::request_map);
    }
}

/// Timestamp queries at the begin and end of each pass, on adapters that have them.
pub(super) struct PassTimestamps {
    /// For each pass, the index of its pair of queries; `None` where it is not timed.
    slots: Vec<Option<u32>>,
    queries: QueryReadback,
}

impl PassTimestamps {
    /// Makes two timestamp queries for each pass for which `runs` is true; `None` where the adapter has none, no pass
    /// runs, or there are too many passes.
    pub fn new(context: &GpuContext, plan: &FramePlan, runs: impl Fn(&Pass) -> bool) -> Option<PassTimestamps> {
        context.timestamp_period?;
        let mut next_slot = 0..;
        let slots: Vec<Option<u32>> =
            plan.passes.iter().map(|pass| runs(pass).then(|| next_slot.next()).flatten()).collect();
        let count = slots.iter().flatten().count() as u32 * 2;
        let queries = QueryReadback::new(&context.device, QueryType::Timestamp, count)?;
        Some(PassTimestamps { slots, queries })
    }

    /// Returns where a pass writes the timestamps of its beginning and end; `None` for a pass that does not run.
    pub fn of_pass(&self, index: usize) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.slots[index].map(|slot| wgpu::RenderPassTimestampWrites {
            query_set: &self.queries.set,
            beginning_of_pass_write_index: Some(slot * 2),
            end_of_pass_write_index: Some(slot * 2 + 1),
        })
    }

    /// Returns the GPU time of each pass in milliseconds; `None` for passes that were not timed.
    pub fn read(&self, context: &GpuContext) -> Result<Vec<Option<f64>>, GpuError> {
        let times = readback::milliseconds(context, &self.queries.read()?);
        Ok(self.slots.iter().map(|slot| slot.and_then(|slot| times.get(slot as usize).copied()).flatten()).collect())
    }
}

/// Occlusion queries that count the samples that pass each draw's tests, for draws that have no effect where they fail
/// them.
pub(super) struct DrawSamples {
    /// For each draw of each pass, the index of its query; `None` where it has none.
    slots: Vec<Vec<Option<u32>>>,
    queries: QueryReadback,
}

impl DrawSamples {
    /// Makes queries for the draws of those timed passes that `asks` accepts; `None` where there is nothing to ask.
    /// Draws beyond the size of a query set are not counted.
    pub fn new(device: &Device, plan: &FramePlan, asks: impl Fn(&Pass) -> bool) -> Option<DrawSamples> {
        let mut next_slot = 0..wgpu::QUERY_SET_MAX_QUERIES;
        let of_pass = |pass: &Pass| -> Vec<Option<u32>> {
            let slots = pass.draws.iter().map(|draw| {
                let is_asked = pass.timed && asks(pass) && draw.raster.acts_only_where_it_passes();
                if is_asked { next_slot.next() } else { None }
            });
            slots.collect()
        };
        let slots: Vec<Vec<Option<u32>>> = plan.passes.iter().map(of_pass).collect();
        let count = slots.iter().flatten().flatten().count() as u32;
        let queries = QueryReadback::new(device, QueryType::Occlusion, count)?;
        Some(DrawSamples { slots, queries })
    }

    /// Returns the query set that a pass writes its sample counts to.
    pub fn set(&self) -> &QuerySet {
        &self.queries.set
    }

    /// Returns the index of the query of a draw (of the pass `pass`, both by index); `None` where its samples are not
    /// counted.
    pub fn slot(&self, pass: usize, draw: usize) -> Option<u32> {
        self.slots[pass][draw]
    }

    /// Returns the samples of each draw of each pass; `None` where they were not counted.
    pub fn read(&self) -> Result<Vec<Vec<Option<u64>>>, GpuError> {
        let counts = self.queries.read()?;
        let of_draw = |slot: &Option<u32>| slot.and_then(|slot| counts.get(slot as usize).copied());
        Ok(self.slots.iter().map(|pass| pass.iter().map(of_draw).collect()).collect())
    }
}
