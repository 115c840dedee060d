use std::borrow::Cow;
use std::future::ready;
use std::pin::Pin;
use std::sync::{Arc, OnceLock};
use wgpu::custom::{ShaderCompilationInfoFuture, ShaderModuleInterface};

#[derive(Debug)]
pub struct ShaderModule {
    pub inner: wgpu::ShaderModule,
    pub source: Source,
}

/// What a module was made from; it is read once a frame is recorded that draws with it.
#[derive(Debug, Clone)]
pub enum Source {
    Wgsl(Arc<str>, Arc<OnceLock<Option<Arc<naga::Module>>>>),
    Naga(Arc<naga::Module>),
    /// The backend's own language, or one that is not read here.
    Unread,
}

/// The same module, not one that says the same.
impl PartialEq for Source {
    fn eq(&self, other: &Source) -> bool {
        match (self, other) {
            (Source::Wgsl(_, one), Source::Wgsl(_, other)) => Arc::ptr_eq(one, other),
            (Source::Naga(one), Source::Naga(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }
}

impl Source {
    pub fn of(source: &wgpu::ShaderSource<'_>) -> Source {
        match source {
            wgpu::ShaderSource::Wgsl(text) => Source::Wgsl(Arc::from(&**text), Arc::default()),
            wgpu::ShaderSource::Naga(Cow::Borrowed(module)) => Source::Naga(Arc::new((*module).clone())),
            wgpu::ShaderSource::Naga(Cow::Owned(module)) => Source::Naga(Arc::new(module.clone())),
            _ => Source::Unread,
        }
    }

    /// The module, if it can be read.
    pub fn module(&self) -> Option<Arc<naga::Module>> {
        match self {
            Source::Wgsl(text, read) => {
                let parse = || naga::front::wgsl::parse_str(text).ok().map(Arc::new);
                read.get_or_init(parse).clone()
            }
            Source::Naga(module) => Some(module.clone()),
            Source::Unread => None,
        }
    }
}

impl ShaderModuleInterface for ShaderModule {
    fn get_compilation_info(&self) -> Pin<Box<dyn ShaderCompilationInfoFuture>> {
        Box::pin(ready(pollster::block_on(self.inner.get_compilation_info())))
    }
}
