//! The adapter and its device.

use super::{GpuError, features, waiting};
use crate::adapters::{first_that_opens, speed_rank};
use crate::capture::AdapterInfo;
use wgpu::{Adapter, Backends, Device, DeviceType, Features, Limits, Queue};

/// Backends on which depth and stencil aspects can be copied to buffers.
const BACKENDS: Backends =
    Backends::VULKAN.union(Backends::METAL).union(Backends::DX12).union(Backends::BROWSER_WEBGPU);
/// Features that every device must have: the depth-stencil format, with a depth aspect that can be copied.
const REQUIRED: Features = Features::DEPTH32FLOAT_STENCIL8;
/// Features for measuring, used where the adapter has them.
const MEASURED: Features = Features::TIMESTAMP_QUERY;

/// Memory is allocated in pieces of 4 to 8 MiB: pictures come and go, and one small allocation would keep a large piece
/// for as long as it lives. What is larger gets a piece of its own, and gives it back.
pub const MEMORY_HINTS: wgpu::MemoryHints =
    wgpu::MemoryHints::Manual { suballocated_device_memory_block_size: 4 << 20..8 << 20 };

/// An open GPU: an adapter, a device on it and the device's queue.
#[derive(Debug)]
pub struct GpuContext {
    /// The adapter that runs the plans.
    pub info: AdapterInfo,
    adapter: Adapter,
    pub(super) device: Device,
    pub(super) queue: Queue,
    /// Nanoseconds for each tick of a timestamp query; `None` where passes can't be timed.
    pub(super) timestamp_period: Option<f32>,
    /// The adapters before this one that gave no device, each with its reason.
    pub passed_over: Vec<GpuError>,
}

impl GpuContext {
    /// Opens the first adapter of the fastest kind, of those with the required features whose name contains `wanted`
    /// (in any case) where that is given. One that gives no device is passed over for the next.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] where none has the name and the features; [`GpuError::NoDevice`] of the first where none
    /// gives a device.
    pub async fn new(wanted: Option<&str>) -> Result<GpuContext, GpuError> {
        let (context, passed_over) = first_that_opens(candidates(wanted).await?, async |adapter: Adapter| {
            let features = REQUIRED | (adapter.features() & MEASURED);
            GpuContext::open(adapter, features).await
        })
        .await
        .map_err(|first| first.unwrap_or(GpuError::NoAdapter { found: String::new() }))?;
        Ok(GpuContext { passed_over, ..context })
    }

    /// Opens another device on the same adapter, with all features of this one and those `needed`.
    pub(super) async fn with(&self, needed: Features) -> Result<GpuContext, GpuError> {
        features::check(needed, self.adapter.features())?;
        // A browser's adapter gives one device, so it is asked for the adapter anew: it has one.
        let adapter = match cfg!(target_family = "wasm") {
            true => candidates(None).await?.swap_remove(0),
            false => self.adapter.clone(),
        };
        GpuContext::open(adapter, self.device.features() | needed).await
    }

    async fn open(adapter: Adapter, features: Features) -> Result<GpuContext, GpuError> {
        let info = info_of(&adapter);
        let available = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("stencilscope"),
            required_features: features,
            // Defaults, but for how large pictures and meshes may be.
            required_limits: Limits {
                max_texture_dimension_2d: available.max_texture_dimension_2d,
                max_buffer_size: available.max_buffer_size,
                max_storage_buffer_binding_size: available.max_storage_buffer_binding_size,
                ..Limits::default()
            },
            memory_hints: MEMORY_HINTS,
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: one_line(&error.to_string()) })?;
        let can_time = features.contains(Features::TIMESTAMP_QUERY);
        let timestamp_period = can_time.then(|| queue.get_timestamp_period());
        Ok(GpuContext { info, adapter, device, queue, timestamp_period, passed_over: Vec::new() })
    }

    /// Runs `work` and returns the first error that the driver reported meanwhile, in place of its result; otherwise
    /// that result.
    pub(super) async fn guarded<T>(&self, work: impl AsyncFnOnce() -> Result<T, GpuError>) -> Result<T, GpuError> {
        // The last scope pushed is the first popped, also where the future is dropped: not an array, which drops its
        // first element first.
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let out_of_memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work().await;
        // All scopes end here, before any error is waited for.
        let complaints = [validation.pop(), out_of_memory.pop(), internal.pop()];
        let mut first = None;
        for complaint in complaints {
            first = first.or(complaint.await);
        }
        match first {
            Some(complaint) => Err(GpuError::Driver(one_line(&complaint.to_string()))),
            None => result,
        }
    }

    /// Waits until all submitted work is done and the mappings that were asked for are there.
    pub(super) async fn wait(&self) -> Result<(), GpuError> {
        waiting::submitted_work(&self.device, &self.queue).await
    }

    /// As [`Executor::yield_now`](super::Executor::yield_now).
    pub(super) async fn yield_now(&self) {
        waiting::yield_now(&self.queue).await;
    }

    /// Runs `work` between a start and an end of capture for an attached graphics debugger, such as RenderDoc, and
    /// returns its result; without one it just runs. `work` must wait for all that it submits.
    pub(super) async fn bracketed<T>(&self, work: impl AsyncFnOnce() -> T) -> T {
        self.start_debugger_capture();
        let result = work().await;
        self.stop_debugger_capture();
        result
    }

    #[expect(unsafe_code, reason = "wgpu's capture hook; the device is alive, and no other thread uses it")]
    fn start_debugger_capture(&self) {
        unsafe { self.device.start_graphics_debugger_capture() }
    }

    #[expect(unsafe_code, reason = "wgpu's capture hook; every submission has been waited for")]
    fn stop_debugger_capture(&self) {
        unsafe { self.device.stop_graphics_debugger_capture() }
    }
}

/// Returns wgpu's own instance; in builds with `record`, and with the environment variable of its tests set, one that
/// hands every call on to it.
fn instance(descriptor: wgpu::InstanceDescriptor) -> wgpu::Instance {
    #[cfg(feature = "record")]
    if std::env::var_os("STENCILSCOPE_TEST_WRAPPED").is_some() {
        return crate::wrap::instance(descriptor);
    }
    wgpu::Instance::new(descriptor)
}

/// Returns the adapters that have the name and the features, the fastest kind first.
async fn candidates(wanted: Option<&str>) -> Result<Vec<Adapter>, GpuError> {
    let mut descriptor =
        wgpu::InstanceDescriptor { backends: BACKENDS, ..wgpu::InstanceDescriptor::new_without_display_handle() };
    // RenderDoc sets this for its layer in what it starts. It shows names of passes, which optimised builds leave out.
    if std::env::var_os("ENABLE_VULKAN_RENDERDOC_CAPTURE").is_some() {
        descriptor.flags |= wgpu::InstanceFlags::DEBUG;
    }
    let instance = instance(descriptor);
    let adapters = instance.enumerate_adapters(BACKENDS).await;
    let names: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    let is_wanted = |adapter: &Adapter| {
        let name = adapter.get_info().name.to_lowercase();
        wanted.is_none_or(|wanted| name.contains(&wanted.to_lowercase()))
    };
    let (mut able, unable): (Vec<Adapter>, Vec<Adapter>) =
        adapters.into_iter().filter(is_wanted).partition(|adapter| adapter.features().contains(REQUIRED));
    if able.is_empty() {
        let found = match (unable.first(), wanted) {
            (Some(adapter), _) => format!(" ({} has no Depth32FloatStencil8)", adapter.get_info().name),
            (None, Some(wanted)) if !names.is_empty() => {
                format!(" is called `{wanted}` (there are: {})", names.join(", "))
            }
            _ => String::new(),
        };
        return Err(GpuError::NoAdapter { found });
    }
    // A stable sort: of one kind, the first stays first.
    able.sort_by_key(speed_rank);
    Ok(able)
}

fn info_of(adapter: &Adapter) -> AdapterInfo {
    let info = adapter.get_info();
    let kind = match info.device_type {
        DeviceType::Cpu => "cpu",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Other => "other",
    };
    let driver = if info.driver_info.is_empty() { info.driver } else { info.driver_info };
    AdapterInfo { name: info.name, driver, kind: kind.to_owned() }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
