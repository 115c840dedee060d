//! Acceleration structures. Calls that build them can't be forwarded (wgpu makes an instance's parts private), so that
//! adapters hide the features that need it.

use wgpu::custom::{BlasCompactCallback, BlasInterface, TlasInterface};

/// The wgpu features that are hidden from programs, as their calls are not wrapped.
pub const NOT_WRAPPED: wgpu::Features =
    wgpu::Features::EXPERIMENTAL_RAY_QUERY.union(wgpu::Features::EXPERIMENTAL_MESH_SHADER);

/// A wrapped bottom-level acceleration structure: hands each call to the real one.
#[derive(Debug)]
pub struct Blas {
    pub inner: wgpu::Blas,
}

impl BlasInterface for Blas {
    fn prepare_compact_async(&self, callback: BlasCompactCallback) {
        self.inner.prepare_compaction_async(callback);
    }

    fn ready_for_compaction(&self) -> bool {
        self.inner.ready_for_compaction()
    }
}

/// A wrapped top-level acceleration structure: hands each call to the real one.
#[derive(Debug)]
pub struct Tlas {
    pub inner: wgpu::Tlas,
}

impl TlasInterface for Tlas {}
