use std::borrow::Cow;
use std::future::ready;
use std::pin::Pin;
use std::sync::{Arc, OnceLock};
use wgpu::custom::{ShaderCompilationInfoFuture, ShaderModuleInterface};

/// A wrapped shader module: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct ShaderModule {
    pub inner: wgpu::ShaderModule,
    pub source: ShaderSource,
}

/// The source of a module; it is parsed once a frame is recorded that draws with it.
#[derive(Debug, Clone)]
pub enum ShaderSource {
    Wgsl(Arc<str>, Arc<OnceLock<Option<Arc<naga::Module>>>>),
    Naga(Arc<naga::Module>),
    /// The backend's own language, or one that is not read here.
    Unread,
}

/// Equal is only the same module, not another of the same source.
impl PartialEq for ShaderSource {
    fn eq(&self, other: &ShaderSource) -> bool {
        match (self, other) {
            (ShaderSource::Wgsl(_, one), ShaderSource::Wgsl(_, other)) => Arc::ptr_eq(one, other),
            (ShaderSource::Naga(one), ShaderSource::Naga(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }
}

impl ShaderSource {
    /// Returns a copy of a shader's source if it is WGSL or a naga module; of any other language that it is unread.
    pub fn of(source: &wgpu::ShaderSource<'_>) -> ShaderSource {
        match source {
            wgpu::ShaderSource::Wgsl(text) => ShaderSource::Wgsl(Arc::from(&**text), Arc::default()),
            wgpu::ShaderSource::Naga(Cow::Borrowed(module)) => ShaderSource::Naga(Arc::new((*module).clone())),
            wgpu::ShaderSource::Naga(Cow::Owned(module)) => ShaderSource::Naga(Arc::new(module.clone())),
            _ => ShaderSource::Unread,
        }
    }

    /// Returns the parsed module, parsing WGSL once; `None` where that fails or the source is in another language.
    pub fn module(&self) -> Option<Arc<naga::Module>> {
        match self {
            ShaderSource::Wgsl(text, read) => {
                let parse = || naga::front::wgsl::parse_str(text).ok().map(Arc::new);
                read.get_or_init(parse).clone()
            }
            ShaderSource::Naga(module) => Some(module.clone()),
            ShaderSource::Unread => None,
        }
    }
}

impl ShaderModuleInterface for ShaderModule {
    fn get_compilation_info(&self) -> Pin<Box<dyn ShaderCompilationInfoFuture>> {
        Box::pin(ready(pollster::block_on(self.inner.get_compilation_info())))
    }
}
