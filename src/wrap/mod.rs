//! A backend of wgpu that wraps the real objects and forwards every call: one file for each interface of
//! `wgpu::custom`.
//!
//! What is not a plain forward:
//! - targets, index and indirect buffers can be copied from (`texture.rs`, `buffer.rs`);
//! - a device has one more bind group and two more storage buffers than were asked for, where the adapter has them
//!   (`adapter.rs`);
//! - pipelines, bind groups and bundles store their descriptors;
//! - while a frame is recorded, an encoder writes a list beside what it encodes (`encoder.rs`), and the recorder runs
//!   that list instead.

mod adapter;
mod binding;
mod buffer;
mod bundle;
pub(crate) mod command;
mod compute_pass;
mod device;
mod encoder;
mod instance;
mod pipeline;
mod query;
mod queue;
mod ray_tracing;
mod render_pass;
mod shader;
mod shared;
mod surface;
mod texture;

pub(crate) use binding::{BindGroup, real_group};
pub(crate) use device::Device;
pub(crate) use instance::Instance;
pub(crate) use pipeline::{
    PipelineLayoutSource, PipelineSource, ProgrammableStage, RenderPipeline, VertexBufferSource,
};
use shader::ShaderModule;
pub(crate) use shared::{CallRecorder, SharedDevice};
pub(crate) use texture::ViewSubresource;

use wgpu::custom::{
    DispatchAdapter, DispatchBindGroup, DispatchBlas, DispatchBuffer, DispatchComputePipeline, DispatchDevice,
    DispatchQuerySet, DispatchRenderBundle, DispatchRenderPipeline, DispatchSurface, DispatchTexture,
    DispatchTextureView,
};

/// An object that wraps a real one for the program.
pub(crate) trait WrappedObject {
    type Object;

    /// Returns the real object.
    ///
    /// # Panics
    /// The object is of an instance that is not recorded: wgpu's own backends can't mix those either.
    fn real(&self) -> &Self::Object;
}

const FOREIGN: &str = "an object of another instance than the one that is recorded";

macro_rules! real {
    ($($program:ty: $wrap:ty => $real:ty;)*) => { $(
        impl WrappedObject for $program {
            type Object = $real;

            fn real(&self) -> &$real {
                &self.as_custom::<$wrap>().expect(FOREIGN).inner
            }
        }
    )* };
}

real! {
    wgpu::BindGroup: BindGroup => wgpu::BindGroup;
    wgpu::BindGroupLayout: binding::BindGroupLayout => wgpu::BindGroupLayout;
    wgpu::Buffer: buffer::Buffer => wgpu::Buffer;
    wgpu::ExternalTexture: texture::ExternalTexture => wgpu::ExternalTexture;
    wgpu::PipelineCache: pipeline::PipelineCache => wgpu::PipelineCache;
    wgpu::PipelineLayout: binding::PipelineLayout => wgpu::PipelineLayout;
    wgpu::QuerySet: query::QuerySet => wgpu::QuerySet;
    wgpu::Sampler: texture::Sampler => wgpu::Sampler;
    wgpu::ShaderModule: ShaderModule => wgpu::ShaderModule;
    wgpu::Surface<'_>: surface::Surface => wgpu::Surface<'static>;
    wgpu::Texture: texture::Texture => wgpu::Texture;
    wgpu::TextureView: texture::TextureView => wgpu::TextureView;
    wgpu::Tlas: ray_tracing::Tlas => wgpu::Tlas;
    DispatchAdapter: adapter::Adapter => wgpu::Adapter;
    DispatchBindGroup: BindGroup => wgpu::BindGroup;
    DispatchBlas: ray_tracing::Blas => wgpu::Blas;
    DispatchBuffer: buffer::Buffer => wgpu::Buffer;
    DispatchComputePipeline: pipeline::ComputePipeline => wgpu::ComputePipeline;
    DispatchDevice: Device => wgpu::Device;
    DispatchQuerySet: query::QuerySet => wgpu::QuerySet;
    DispatchRenderPipeline: RenderPipeline => wgpu::RenderPipeline;
    DispatchSurface: surface::Surface => wgpu::Surface<'static>;
    DispatchTexture: texture::Texture => wgpu::Texture;
    DispatchTextureView: texture::TextureView => wgpu::TextureView;
}

/// Returns the wrapper behind the pipeline that the program created.
pub(crate) fn pipeline_of(pipeline: &DispatchRenderPipeline) -> &RenderPipeline {
    pipeline.as_custom().expect(FOREIGN)
}

pub(crate) fn bind_group_of(group: &DispatchBindGroup) -> &BindGroup {
    group.as_custom().expect(FOREIGN)
}

fn bundle_of(bundle: &DispatchRenderBundle) -> &bundle::RenderBundle {
    bundle.as_custom().expect(FOREIGN)
}

fn module_of(module: &wgpu::ShaderModule) -> &ShaderModule {
    module.as_custom().expect(FOREIGN)
}

/// Returns one end of a texture copy with the real texture in place of the wrapped one.
fn copy_end<'a>(end: wgpu::TexelCopyTextureInfo<'a>) -> wgpu::TexelCopyTextureInfo<'a> {
    let wgpu::TexelCopyTextureInfo { texture, mip_level, origin, aspect } = end;
    wgpu::TexelCopyTextureInfo { texture: texture.real(), mip_level, origin, aspect }
}

/// Returns the real view of a wrapped one, and the mip level and layer where it begins. Panics for a view of another
/// instance.
pub(crate) fn view_of(view: &wgpu::TextureView) -> (wgpu::TextureView, ViewSubresource) {
    let texture::TextureView { inner, part } = view.as_custom().expect(FOREIGN);
    (inner.clone(), *part)
}

/// Returns the bytes of a buffer from an offset on, of a size or to its end.
pub(crate) fn slice(buffer: &wgpu::Buffer, offset: u64, size: Option<wgpu::BufferSize>) -> wgpu::BufferSlice<'_> {
    match size {
        Some(size) => buffer.slice(offset..offset + size.get()),
        None => buffer.slice(offset..),
    }
}

/// Returns an instance that forwards every call, and records nothing.
pub(crate) fn instance(descriptor: wgpu::InstanceDescriptor) -> wgpu::Instance {
    wgpu::Instance::from_custom(<Instance as wgpu::custom::InstanceInterface>::new(descriptor))
}
