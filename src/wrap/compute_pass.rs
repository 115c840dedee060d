use super::WrappedObject;
use super::command::{CommandList, ComputeCommand, EncoderCommand, TimestampWrites};
use wgpu::custom::{
    ComputePassInterface, DispatchBindGroup, DispatchBuffer, DispatchComputePipeline, DispatchQuerySet,
    DispatchTextureView,
};

/// A wrapped compute pass: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct ComputePass {
    /// `None` where the encoder was finished before.
    inner: Option<wgpu::ComputePass<'static>>,
    commands: Option<ComputePassCommands>,
}

/// The list that is written beside the real pass.
#[derive(Debug)]
struct ComputePassCommands {
    list: CommandList,
    label: Option<String>,
    timestamps: Option<TimestampWrites>,
    commands: Vec<ComputeCommand>,
}

impl ComputePass {
    /// Begins a compute pass on the real encoder, if there is one, and begins to record its calls for `list`, if there
    /// is one.
    pub fn begin(
        encoder: &mut Option<wgpu::CommandEncoder>,
        list: Option<&CommandList>,
        descriptor: &wgpu::ComputePassDescriptor<'_>,
    ) -> ComputePass {
        let timestamps = descriptor.timestamp_writes.as_ref().map(|writes| TimestampWrites {
            queries: writes.query_set.real().clone(),
            begin: writes.beginning_of_pass_write_index,
            end: writes.end_of_pass_write_index,
        });
        let inner = encoder.as_mut().map(|encoder| {
            let timestamp_writes = timestamps.as_ref().map(TimestampWrites::of_compute);
            let descriptor = wgpu::ComputePassDescriptor { label: descriptor.label, timestamp_writes };
            encoder.begin_compute_pass(&descriptor).forget_lifetime()
        });
        let commands = list.map(|list| ComputePassCommands {
            list: list.clone(),
            label: descriptor.label.map(str::to_owned),
            timestamps,
            commands: Vec::new(),
        });
        ComputePass { inner, commands }
    }

    fn call(&mut self, command: impl Fn(&mut wgpu::ComputePass<'_>) + Send + Sync + 'static) {
        if let Some(pass) = &mut self.inner {
            command(pass);
        }
        if let Some(commands) = &mut self.commands {
            commands.commands.push(ComputeCommand(Box::new(command)));
        }
    }
}

impl Drop for ComputePass {
    fn drop(&mut self) {
        // Dropping the real pass ends it.
        self.inner = None;
        if let Some(ComputePassCommands { list, label, timestamps, commands }) = self.commands.take() {
            list.push(EncoderCommand::ComputePass { label, timestamps, commands });
        }
    }
}

impl ComputePassInterface for ComputePass {
    fn set_pipeline(&mut self, pipeline: &DispatchComputePipeline) {
        let pipeline = pipeline.real().clone();
        self.call(move |pass| pass.set_pipeline(&pipeline));
    }

    fn set_bind_group(&mut self, index: u32, group: Option<&DispatchBindGroup>, offsets: &[u32]) {
        let (group, offsets) = (group.map(|group| group.real().clone()), offsets.to_vec());
        self.call(move |pass| pass.set_bind_group(index, group.as_ref(), &offsets));
    }

    fn set_immediates(&mut self, offset: u32, data: &[u8]) {
        let data = data.to_vec();
        self.call(move |pass| pass.set_immediates(offset, &data));
    }

    fn insert_debug_marker(&mut self, label: &str) {
        let label = label.to_owned();
        self.call(move |pass| pass.insert_debug_marker(&label));
    }

    fn push_debug_group(&mut self, label: &str) {
        let label = label.to_owned();
        self.call(move |pass| pass.push_debug_group(&label));
    }

    fn pop_debug_group(&mut self) {
        self.call(|pass| pass.pop_debug_group());
    }

    fn write_timestamp(&mut self, queries: &DispatchQuerySet, index: u32) {
        let queries = queries.real().clone();
        self.call(move |pass| pass.write_timestamp(&queries, index));
    }

    fn begin_pipeline_statistics_query(&mut self, queries: &DispatchQuerySet, index: u32) {
        let queries = queries.real().clone();
        self.call(move |pass| pass.begin_pipeline_statistics_query(&queries, index));
    }

    fn end_pipeline_statistics_query(&mut self) {
        self.call(|pass| pass.end_pipeline_statistics_query());
    }

    fn dispatch_workgroups(&mut self, x: u32, y: u32, z: u32) {
        self.call(move |pass| pass.dispatch_workgroups(x, y, z));
    }

    fn dispatch_workgroups_indirect(&mut self, buffer: &DispatchBuffer, offset: u64) {
        let buffer = buffer.real().clone();
        self.call(move |pass| pass.dispatch_workgroups_indirect(&buffer, offset));
    }

    fn transition_resources<'a>(
        &mut self,
        buffers: &mut dyn Iterator<Item = wgpu::BufferTransition<&'a DispatchBuffer>>,
        textures: &mut dyn Iterator<Item = wgpu::TextureTransition<&'a DispatchTextureView>>,
    ) {
        let buffers: Vec<(wgpu::Buffer, wgpu::BufferUses)> =
            buffers.map(|one| (one.buffer.real().clone(), one.state)).collect();
        let textures: Vec<(wgpu::TextureView, Option<wgpu_types::TextureSelector>, wgpu::TextureUses)> =
            textures.map(|one| (one.texture.real().clone(), one.selector, one.state)).collect();
        self.call(move |pass| {
            pass.transition_resources(
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
