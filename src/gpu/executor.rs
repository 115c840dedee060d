//! Runs a prepared plan: one command buffer, with copies between passes where snapshots are wanted; more than one
//! where those copies are many.

use super::answer::{self, FrameAnswer};
use super::attachments::AttachmentPool;
use super::budget::MemoryBudget;
use super::collect::{Collector, ExecutorOutput, SnapshotMemory, SnapshotStorage};
use super::log_pipelines::LogCache;
use super::maps::MapCache;
use super::pipelines::Pipelines;
use super::prepared::{PlanResources, Prepared, PreparedDraw};
use super::queries::{DrawSamples, FrameQueries, PassTimestamps};
use super::readback::{StagedPass, StagingCopy};
use super::small_triangles::SmallTriangles;
use super::{GpuContext, GpuError, features, probe, start};
use crate::capture::{AdapterProfile, FrameTarget, Image};
use crate::plan::{Draw, FramePlan, Pass, RasterisedTriangles, Viewport, lint};
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;
use web_time::Instant;
use wgpu::{CommandEncoder, LoadOp, Operations, RenderPass, StoreOp};

/// Bytes of copies after which a captured frame is submitted and read back before it goes on; most frames stay below
/// it.
const PART_BYTES: u64 = 1 << 26;

/// The most memory, bytes, that attachments, pictures and snapshots may take together. A browser's module has 4 GiB for
/// everything.
const MOST_BYTES: u64 = if cfg!(target_family = "wasm") { 1 << 30 } else { 8 << 30 };

/// Runs frame plans on a GPU, and caches pipelines, buffers and shadow maps between them.
#[derive(Debug)]
pub struct Executor {
    pub(super) context: Arc<GpuContext>,
    pub(super) pipelines: Pipelines,
    resources: PlanResources,
    /// The maps of a frame's trials.
    maps_of_trials: MapCache,
    pub(super) log: LogCache,
    small: SmallTriangles,
    most_bytes: u64,
    profile: Option<AdapterProfile>,
}

/// Which passes run, and what is stored of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RunMode {
    /// Only timed passes run, and nothing is copied back.
    Frame,
    /// Only timed passes run, and a snapshot is copied after each.
    Snapshots,
    /// All passes run, and only the lights' label masks are copied.
    Labels,
    /// All passes run, and only the lights' labels, their visibility and the finished picture are copied.
    Answer,
    /// All passes run, and a snapshot is copied after each.
    Everything,
}

impl Executor {
    /// Returns an executor that runs plans on this GPU, with empty caches and the default budget of memory.
    pub fn new(context: GpuContext) -> Executor {
        Executor {
            pipelines: Pipelines::new(&context.device),
            resources: PlanResources::default(),
            maps_of_trials: MapCache::default(),
            log: LogCache::default(),
            small: SmallTriangles::default(),
            context: Arc::new(context),
            most_bytes: MOST_BYTES,
            profile: None,
        }
    }

    /// Returns how exactly the adapter draws, measured when it is first asked for.
    ///
    /// # Errors
    /// A lost GPU.
    pub async fn profile(&mut self) -> Result<AdapterProfile, GpuError> {
        let profile = match self.profile {
            Some(profile) => profile,
            None => probe::measure(&self.context).await?,
        };
        self.profile = Some(profile);
        Ok(profile)
    }

    /// Returns the profile where it was asked for before.
    pub fn measured_profile(&self) -> Option<AdapterProfile> {
        self.profile
    }

    /// Returns the plan with what the adapter does not draw exactly clipped away ([`FramePlan::clipped`]).
    ///
    /// # Errors
    /// A lost GPU.
    pub async fn clipped(&mut self, plan: FramePlan) -> Result<FramePlan, GpuError> {
        let profile = self.profile().await?;
        // Between planning and clipping, which may both take milliseconds.
        self.yield_now().await;
        Ok(plan.clipped(&profile.exact_range()))
    }

    /// Returns the plan without the triangles of its large draws that cover no pixel's middle: it leaves the same content,
    /// but its passes take less time than the frame does. `None` where it has few.
    ///
    /// # Errors
    /// A lost GPU.
    pub async fn without_small_triangles(&mut self, plan: &FramePlan) -> Result<Option<FramePlan>, GpuError> {
        let step = self.profile().await?.subpixel();
        Ok(self.small.left_out_of(plan, step))
    }

    /// Limits the memory that attachments, pictures and snapshots may take to this many bytes.
    pub fn hold_at_most(&mut self, bytes: u64) {
        self.most_bytes = bytes;
    }

    /// Gives way to the browser, if this is one and has waited for some milliseconds: to be called often in long work.
    pub async fn yield_now(&self) {
        self.context.yield_now().await;
    }

    /// Returns the GPU that plans run on.
    pub fn context(&self) -> &GpuContext {
        &self.context
    }

    /// Returns the names, in plain words, of the optional GPU features that a plan so far has needed.
    pub fn features(&self) -> Vec<&'static str> {
        features::names(self.context.device.features())
    }

    /// Drops all cached pipelines, buffers and textures, so that the next plan is set up from nothing.
    pub fn forget(&mut self) {
        self.pipelines = Pipelines::new(&self.context.device);
        self.resources = PlanResources::default();
        self.forget_trials();
        self.log = LogCache::default();
        self.small = SmallTriangles::default();
    }

    /// Checks a plan, uploads its buffers and makes its pipelines, so that it can be run, also several times. May open
    /// another device for features that it needs; what earlier plans uploaded is used again.
    pub async fn prepare<'a>(&mut self, plan: &'a FramePlan) -> Result<Prepared<'a>, GpuError> {
        self.check(plan).await?;
        self.prepare_with(plan, |_| ()).await
    }

    /// Prepares a plan that is run once: what it uploads is cached as usual, but its shadow maps are not, and those
    /// cached before stay cached.
    pub async fn prepare_once<'a>(&mut self, plan: &'a FramePlan) -> Result<Prepared<'a>, GpuError> {
        // First, as it may open another device, which has no maps.
        self.check(plan).await?;
        let mut maps = MapCache::default();
        self.prepare_with(plan, |executor| std::mem::swap(&mut executor.resources.maps, &mut maps)).await
    }

    /// Prepares a plan that is one of several trials of a frame: the maps that it may cache are cached for the next
    /// trial, until [`forget_trials`](Executor::forget_trials), and those of other frames stay cached.
    pub async fn prepare_trial<'a>(&mut self, plan: &'a FramePlan) -> Result<Prepared<'a>, GpuError> {
        // First, as it may open another device, which has no maps.
        self.check(plan).await?;
        let swap = |executor: &mut Executor| std::mem::swap(&mut executor.resources.maps, &mut executor.maps_of_trials);
        self.prepare_with(plan, swap).await
    }

    /// Prepares a plan that is one of several whose frames run in turn, never at once: they may share the textures in
    /// `targets`, where none reads what another has left there.
    pub async fn prepare_in_turn<'a>(
        &mut self,
        plan: &'a FramePlan,
        targets: &mut AttachmentPool,
    ) -> Result<Prepared<'a>, GpuError> {
        self.check(plan).await?;
        self.prepare_with(plan, |executor| executor.resources.exchange_attachments(targets)).await
    }

    /// Prepares a checked plan with the caches as `exchange` leaves them, and exchanges them back, all before anything is
    /// waited for: a future that is dropped half-way leaves them as they were.
    async fn prepare_with<'a>(
        &mut self,
        plan: &'a FramePlan,
        mut exchange: impl FnMut(&mut Executor),
    ) -> Result<Prepared<'a>, GpuError> {
        let budget = MemoryBudget::of(self.most_bytes);
        let context = Arc::clone(&self.context);
        let mut prepare = || {
            exchange(self);
            let Executor { context, pipelines, resources, .. } = &mut *self;
            let prepared = Prepared::new(context, pipelines, resources, plan, budget);
            exchange(self);
            prepared
        };
        let prepared = context.guarded(async || prepare()).await;
        if prepared.is_err() {
            // Whatever could not be made is not handed on.
            self.resources.forget_attachments();
        }
        prepared
    }

    /// Drops the maps that trials have cached.
    pub fn forget_trials(&mut self) {
        self.maps_of_trials = MapCache::default();
    }

    /// Prepares a plan between frames that are timed: it uses nothing that is cached but pipelines, and nothing that it
    /// uploads is cached.
    pub async fn prepare_apart<'a>(&mut self, plan: &'a FramePlan) -> Result<Prepared<'a>, GpuError> {
        self.check(plan).await?;
        let budget = MemoryBudget::of(self.most_bytes);
        let Executor { context, pipelines, .. } = self;
        context.guarded(async || Prepared::new(context, pipelines, &mut PlanResources::default(), plan, budget)).await
    }

    /// Fails where the plan breaks a rule of the lint or the GPU can't run it; opens another device where this one
    /// lacks a feature that it needs.
    async fn check(&mut self, plan: &FramePlan) -> Result<(), GpuError> {
        match lint::check(plan).into_iter().next() {
            Some(error) => Err(GpuError::Plan(error)),
            None => self.provide(plan).await,
        }
    }

    /// Opens another device, and empties the caches, where this one lacks a feature that the plan needs; else does
    /// nothing. Plans already prepared stay on their own device.
    pub(super) async fn provide(&mut self, plan: &FramePlan) -> Result<(), GpuError> {
        let needed = features::needed(plan);
        if !self.context.device.features().contains(needed) {
            self.context = Arc::new(self.context.with(needed).await?);
            self.forget();
        }
        Ok(())
    }

    /// Returns the wall time of recording, submitting and executing the timed passes; with `snapshots`, of copying a
    /// snapshot after each pass to mapped memory, too. All passes are submitted at once, unlike those of
    /// [`Executor::capture`].
    pub async fn time(&self, prepared: &Prepared<'_>, snapshots: bool) -> Result<Duration, GpuError> {
        let mode = if snapshots { RunMode::Snapshots } else { RunMode::Frame };
        if snapshots {
            let mut budget = prepared.budget;
            budget.take(prepared.snapshot_bytes())?;
        }
        let start = Instant::now();
        run(prepared, mode, &FrameQueries::default()).await?;
        let took = start.elapsed();
        if snapshots {
            staged(prepared, mode, all_passes(prepared))?.flat_map(StagedPass::iter).for_each(StagingCopy::unmap);
        }
        Ok(took)
    }

    /// Runs the timed passes and returns the sum of their GPU times in milliseconds, without passes whose image the CPU
    /// makes; `None` where passes can't be timed, and where later frames use a map that this one may have drawn.
    pub async fn gpu_ms(&self, prepared: &Prepared<'_>) -> Result<Option<f64>, GpuError> {
        let context = &prepared.context;
        let notes = context.guarded(async || Ok(FrameQueries::of_times(prepared, RunMode::Frame))).await?;
        run(prepared, RunMode::Frame, &notes).await?;
        let Some(timestamps) = &notes.timestamps else { return Ok(None) };
        let times = timestamps.read(context)?;
        // What the CPU makes takes the GPU no time.
        let passes = prepared.plan.passes.iter().zip(times).filter(|(pass, _)| pass.timed && pass.image.is_none());
        Ok(passes.map(|(pass, ms)| ms.filter(|_| !prepared.may_cache(pass))).sum())
    }

    /// Runs the timed passes and returns, for each draw of each pass, the number of samples that passed its tests;
    /// `None` for draws that have an effect where they fail them, for those of cached maps, and where there are too
    /// many queries.
    pub async fn samples(&self, prepared: &Prepared<'_>) -> Result<Vec<Vec<Option<u64>>>, GpuError> {
        let context = &prepared.context;
        // A cached map is drawn once: a pass that does not run counts no samples.
        let asks = |pass: &Pass| !prepared.may_cache(pass);
        let samples = context.guarded(async || Ok(DrawSamples::new(&context.device, prepared.plan, asks))).await?;
        let notes = FrameQueries { samples, ..FrameQueries::default() };
        run(prepared, RunMode::Frame, &notes).await?;
        match &notes.samples {
            Some(samples) => samples.read(),
            None => Ok(prepared.plan.passes.iter().map(|pass| vec![None; pass.draws.len()]).collect()),
        }
    }

    /// Runs all passes and stores every attachment's content after each, in `memory`. With `bracket`, an attached
    /// graphics debugger records the frame.
    pub async fn capture(
        &self,
        mut prepared: Prepared<'_>,
        memory: SnapshotMemory,
        bracket: bool,
    ) -> Result<ExecutorOutput, GpuError> {
        let (plan, context) = (prepared.plan, prepared.context.clone());
        // All under one guard: in a browser each is waited for.
        let captured = context.guarded(async || {
            let notes = FrameQueries::of_times(&prepared, RunMode::Everything);
            let mut run = async || run_in_parts(&mut prepared, &notes, memory).await;
            let collector = if bracket { context.bracketed(run).await? } else { run().await? };
            let times = match &notes.timestamps {
                Some(timestamps) => timestamps.read(&context)?,
                None => vec![None; plan.passes.len()],
            };
            Ok(collector.finish(plan, times))
        });
        let output = captured.await?;
        prepared.set_drawn();
        Ok(output)
    }

    /// Runs all passes up to the last that writes labels, and returns the label mask of each light, `None` where none is
    /// written. Nothing else is copied, so that the largest maps cost no memory twice.
    pub async fn labels(&self, prepared: Prepared<'_>) -> Result<Vec<Option<Arc<Image>>>, GpuError> {
        run(&prepared, RunMode::Labels, &FrameQueries::default()).await?;
        let of_lights = answer::of_lights(&prepared, RunMode::Labels.targets())?;
        Ok(of_lights.into_iter().map(|light| light.labels).collect())
    }

    /// Runs all passes, waits, and returns labels and visibility of each light, in their order and `None` where no pass
    /// writes them, and the finished picture. Nothing else is copied.
    pub async fn answer(&self, prepared: Prepared<'_>) -> Result<FrameAnswer, GpuError> {
        run(&prepared, RunMode::Answer, &FrameQueries::default()).await?;
        let of_lights = answer::of_lights(&prepared, RunMode::Answer.targets())?;
        Ok(FrameAnswer { of_lights, picture: answer::picture(&prepared)? })
    }
}

impl FrameQueries {
    /// Returns timestamp queries for the passes that a mode runs and whose result is not cached, and no other queries.
    fn of_times(prepared: &Prepared, mode: RunMode) -> FrameQueries {
        let runs = |pass: &Pass| mode.runs(pass) && !prepared.is_cached(pass);
        FrameQueries {
            timestamps: PassTimestamps::new(&prepared.context, prepared.plan, runs),
            ..FrameQueries::default()
        }
    }
}

impl RunMode {
    fn runs(self, pass: &Pass) -> bool {
        pass.timed || matches!(self, RunMode::Labels | RunMode::Answer | RunMode::Everything)
    }

    /// Returns which of the lights' targets the mode copies, where it does not copy all that its passes write.
    fn targets(self) -> &'static [FrameTarget] {
        match self {
            RunMode::Labels => &[FrameTarget::Labels],
            RunMode::Answer => &[FrameTarget::Labels, FrameTarget::Visibility],
            RunMode::Frame | RunMode::Snapshots | RunMode::Everything => &[],
        }
    }

    fn copies(self, plan: &FramePlan, index: usize) -> bool {
        let pass = &plan.passes[index];
        match self {
            RunMode::Frame => false,
            RunMode::Labels | RunMode::Answer => {
                let target = answer::target_of_light(plan, pass).map(|(target, _)| target);
                let is_picture = self == RunMode::Answer && answer::last_of_picture(plan) == Some(index);
                is_picture || target.is_some_and(|target| self.targets().contains(&target))
            }
            RunMode::Snapshots | RunMode::Everything => self.runs(pass),
        }
    }
}

/// Returns the buffers of the copies that a mode makes after each of these passes, in order; passes that it does not
/// copy are left out.
fn staged<'a>(
    prepared: &'a Prepared,
    mode: RunMode,
    passes: Range<usize>,
) -> Result<impl Iterator<Item = &'a StagedPass>, GpuError> {
    let plan = prepared.plan;
    let copied = passes.filter(|index| mode.copies(plan, *index));
    Ok(copied.map(|index| prepared.staged(index)).collect::<Result<Vec<_>, _>>()?.into_iter())
}

/// Uploads, before they run, the images of those of these passes that the mode runs and whose image the CPU makes. Each
/// is computed anew.
fn upload_images(prepared: &Prepared, mode: RunMode, passes: Range<usize>) {
    for (pass, targets) in prepared.plan.passes[passes.clone()].iter().zip(&prepared.passes[passes]) {
        if let (Some(image), Some(texture), true) = (&pass.image, &targets.image_target, mode.runs(pass)) {
            let texels = image.source.make();
            let bytes_per_row = texels.len() as u32 / texture.height().max(1);
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row), rows_per_image: None };
            prepared.context.queue.write_texture(texture.as_image_copy(), &texels, layout, texture.size());
        }
    }
}

fn all_passes(prepared: &Prepared) -> Range<usize> {
    0..prepared.plan.passes.len()
}

/// Returns the passes of a mode. What comes after the last labels, usually the light that they darken, changes none of
/// them; a map that is cached is drawn at once, though.
fn passes_of(prepared: &Prepared, mode: RunMode) -> Range<usize> {
    let plan = prepared.plan;
    let is_needed = |index: &usize| mode.copies(plan, *index) || prepared.may_cache(&plan.passes[*index]);
    match mode {
        RunMode::Labels => 0..all_passes(prepared).rev().find(is_needed).map_or(0, |last| last + 1),
        RunMode::Frame | RunMode::Snapshots | RunMode::Answer | RunMode::Everything => all_passes(prepared),
    }
}

/// Submits all passes of a mode and waits for them; on success marks the cached shadow maps as drawn, so that later
/// frames use them.
async fn run(prepared: &Prepared<'_>, mode: RunMode, notes: &FrameQueries) -> Result<(), GpuError> {
    prepared.context.guarded(async || submit(prepared, mode, notes, passes_of(prepared, mode)).await).await?;
    prepared.set_drawn();
    Ok(())
}

/// Runs all passes of a capture in parts of about [`PART_BYTES`] copied bytes, and returns their snapshots: copies that
/// show no change are dropped before the next part's are made.
async fn run_in_parts(
    prepared: &mut Prepared<'_>,
    notes: &FrameQueries,
    memory: SnapshotMemory,
) -> Result<Collector, GpuError> {
    let plan = prepared.plan;
    let context = prepared.context.clone();
    let resources = plan.passes.iter().map(|pass| prepared.is_cached(pass)).collect();
    let mut collector = Collector::new(plan, resources, SnapshotStorage { memory, budget: prepared.budget });
    let mut start = 0;
    while start < plan.passes.len() {
        let part = start..end_of_part(prepared, start)?;
        submit(prepared, RunMode::Everything, notes, part.clone()).await?;
        for index in part.clone() {
            context.yield_now().await;
            collector.take_in(prepared, index)?;
            prepared.forget_staged(index);
        }
        start = part.end;
    }
    Ok(collector)
}

/// Returns the index of the first pass after the part that begins with pass `start`: the part ends with the pass whose
/// copies bring it to [`PART_BYTES`], else with the last.
fn end_of_part(prepared: &Prepared, start: usize) -> Result<usize, GpuError> {
    let passes = all_passes(prepared).end;
    let mut bytes = 0;
    for index in start..passes {
        bytes += prepared.staged(index)?.iter().map(StagingCopy::byte_len).sum::<u64>();
        if bytes >= PART_BYTES {
            return Ok(index + 1);
        }
    }
    Ok(passes)
}

/// Uploads images, records those of these passes that the mode runs in one command buffer with the copies after them,
/// submits it and waits. Queries are resolved only with the last pass of the plan.
async fn submit(
    prepared: &Prepared<'_>,
    mode: RunMode,
    notes: &FrameQueries,
    passes: Range<usize>,
) -> Result<(), GpuError> {
    upload_images(prepared, mode, passes.clone());
    let is_last = passes.end == prepared.plan.passes.len();
    let mut encoder = prepared.context.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for index in passes.clone() {
        let pass = &prepared.plan.passes[index];
        if !mode.runs(pass) {
            continue;
        }
        if !prepared.is_cached(pass) && pass.targets().next().is_some() {
            let content = pass.recorded.as_ref().and_then(|recorded| recorded.start.as_ref());
            if let (Some(content), Some(target)) = (content, prepared.start_target(index)) {
                start::record(&mut encoder, &target, content);
            }
            record_pass(&mut encoder, prepared, index, notes);
        }
        if mode.copies(prepared.plan, index) {
            prepared.staged(index)?.iter().for_each(|staging| staging.record(&mut encoder));
        }
    }
    if is_last {
        notes.resolve(&mut encoder);
    }
    prepared.context.queue.submit([encoder.finish()]);
    staged(prepared, mode, passes)?.flat_map(StagedPass::iter).for_each(StagingCopy::request_map);
    if is_last {
        notes.request_map();
    }
    prepared.context.wait().await
}

fn record_pass(encoder: &mut CommandEncoder, prepared: &Prepared, index: usize, notes: &FrameQueries) {
    let pass = &prepared.plan.passes[index];
    let targets = &prepared.passes[index];
    let color = pass.color.as_ref().zip(targets.color.as_ref()).map(|(target, view)| {
        let clear = |[r, g, b, a]: [f64; 4]| LoadOp::Clear(wgpu::Color { r, g, b, a });
        let load = target.clear.map_or(LoadOp::Load, clear);
        let ops = Operations { load, store: StoreOp::Store };
        wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
    });
    let depth_stencil = pass.depth_stencil.as_ref().zip(targets.depth_stencil.as_ref()).map(|(target, view)| {
        let store = StoreOp::Store;
        let depth = Operations { load: target.clear_depth.map_or(LoadOp::Load, LoadOp::Clear), store };
        let clear_stencil = |value| LoadOp::Clear(u32::from(value));
        let stencil = Operations { load: target.clear_stencil.map_or(LoadOp::Load, clear_stencil), store };
        let stencil_ops = targets.has_stencil.then_some(stencil);
        wgpu::RenderPassDepthStencilAttachment { view, depth_ops: Some(depth), stencil_ops }
    });
    let mut render_pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(&pass.name),
        color_attachments: if color.is_some() { std::slice::from_ref(&color) } else { &[] },
        depth_stencil_attachment: depth_stencil,
        timestamp_writes: notes.timestamps.as_ref().and_then(|timestamps| timestamps.of_pass(index)),
        occlusion_query_set: notes.samples.as_ref().map(DrawSamples::set),
        ..wgpu::RenderPassDescriptor::default()
    });
    if let Some(Viewport { area: [left, top, width, height], depth: [near, far] }) = pass.own_viewport() {
        render_pass.set_viewport(left, top, width, height, near, far);
    }
    if let Some([left, top, columns, rows]) = pass.scissor {
        render_pass.set_scissor_rect(left, top, columns, rows);
    }
    render_pass.set_bind_group(0, &prepared.view_group, &[prepared.views.offset(pass.view.0)]);
    for (at, (draw, ready)) in pass.draws.iter().zip(&targets.draws).enumerate() {
        let light_offset = pass.light.map_or(0, |light| prepared.lights.offset(light.0));
        let query = notes.samples.as_ref().and_then(|samples| samples.slot(index, at));
        query.inspect(|query| render_pass.begin_occlusion_query(*query));
        record_draw(&mut render_pass, prepared, draw, ready, light_offset);
        query.inspect(|_| render_pass.end_occlusion_query());
    }
}

fn record_draw(pass: &mut RenderPass, prepared: &Prepared, draw: &Draw, ready: &PreparedDraw, light_offset: u32) {
    if ready.shader.group_count() > 1 {
        pass.set_bind_group(1, &prepared.draw_group, &[prepared.draws.offset(ready.index)]);
    }
    let RasterisedTriangles { triangles, base_vertex, .. } = draw.rasterised();
    let corners = triangles.start * 3..triangles.end * 3;
    if let Some((surface, light)) = &ready.shading {
        pass.set_bind_group(2, surface, &[]);
        if light.is_some() {
            pass.set_bind_group(3, light, &[light_offset]);
        }
    }
    let pulls_vertices = ready.shader.pulls_vertices();
    if !pulls_vertices {
        pass.set_vertex_buffer(0, ready.vertices.slice(..));
        pass.set_index_buffer(ready.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
    for (pipeline, reference) in &ready.pipelines {
        pass.set_pipeline(pipeline);
        pass.set_stencil_reference(u32::from(*reference));
        match pulls_vertices {
            true => pass.draw(corners.clone(), 0..1),
            false => pass.draw_indexed(corners.clone(), base_vertex as i32, 0..1),
        }
    }
}
