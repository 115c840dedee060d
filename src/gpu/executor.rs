//! Runs a prepared plan: one command buffer, with copies between passes where snapshots are wanted.

use super::buffers::Buffers;
use super::fragment_log::LogKeeper;
use super::maps::Maps;
use super::pipelines::Pipelines;
use super::prepared::{Prepared, PreparedDraw};
use super::queries::{Notes, Samples, Timestamps};
use super::readback::{self, Change, StagedPass, color_change, depth_change, stencil_change};
use super::{Context, GpuError, features};
use crate::capture::{Aspect, DrawSummary, FrameSnapshot, FrameTarget, Image, PixelFormat, Snapshot, Step};
use crate::plan::{AttachmentRole, Draw, FramePlan, LightId, Pass, lint};
use std::sync::Arc;
use std::time::{Duration, Instant};
use wgpu::{CommandEncoder, LoadOp, Operations, RenderPass, StoreOp};

/// Runs plans; keeps pipelines and buffers between them.
#[derive(Debug)]
pub struct Executor {
    pub(super) context: Arc<Context>,
    pub(super) pipelines: Pipelines,
    buffers: Buffers,
    maps: Maps,
    pub(super) log: LogKeeper,
}

/// What a captured frame left behind.
#[derive(Debug)]
pub struct Output {
    /// One a pass.
    pub steps: Vec<Step>,
    /// One a pass: what it left in its own target, where that is not the picture.
    pub targets: Vec<Option<Arc<Image>>>,
    /// One a light: its labels.
    pub labels: Vec<Option<Arc<Image>>>,
    /// One a light: its volumes' count.
    pub counts: Vec<Option<Arc<Image>>>,
    /// One a light: the faces of its map, left-out ones at their clear value.
    pub maps: Vec<Option<Vec<Arc<Image>>>>,
    /// One a pass: it did not run, since what it draws was there from the frame before.
    pub kept: Vec<bool>,
}

/// Which passes run, and what is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    /// Timed passes, nothing kept.
    Frame,
    /// Timed passes, a snapshot after each.
    Snapshots,
    /// All passes, but only the labels of lights are kept.
    Labels,
    /// All passes, a snapshot after each.
    Everything,
}

impl Executor {
    /// On a context of its own.
    #[must_use]
    pub fn new(context: Context) -> Executor {
        Executor {
            pipelines: Pipelines::new(&context.device),
            buffers: Buffers::default(),
            maps: Maps::default(),
            log: LogKeeper::default(),
            context: Arc::new(context),
        }
    }

    /// Where it runs.
    #[must_use]
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// What few plans need, and one so far has asked for, in plain words.
    #[must_use]
    pub fn features(&self) -> Vec<&'static str> {
        features::names(self.context.device.features())
    }

    /// Forgets pipelines and buffers, so that the next plan is set up from nothing.
    pub fn forget(&mut self) {
        self.pipelines = Pipelines::new(&self.context.device);
        self.buffers = Buffers::default();
        self.maps = Maps::default();
        self.log = LogKeeper::default();
    }

    /// Uploads what a plan needs and makes its pipelines.
    ///
    /// # Errors
    /// A plan that breaks a rule, pictures or meshes that are too large, a driver that refuses.
    pub fn prepare<'a>(&mut self, plan: &'a FramePlan) -> Result<Prepared<'a>, GpuError> {
        if let Some(error) = lint::check(plan).into_iter().next() {
            return Err(GpuError::Plan(error));
        }
        self.provide(plan)?;
        let Executor { context, pipelines, buffers, maps, .. } = self;
        context.guarded(|| Prepared::new(context, pipelines, buffers, maps, plan))
    }

    /// Opens another device where this one can't do what the plan needs. What has been prepared keeps
    /// its own.
    pub(super) fn provide(&mut self, plan: &FramePlan) -> Result<(), GpuError> {
        let needed = features::needed(plan);
        if !self.context.device.features().contains(needed) {
            self.context = Arc::new(self.context.with(needed)?);
            self.forget();
        }
        Ok(())
    }

    /// Runs the timed passes and waits for the GPU: recording, submitting, executing and, with
    /// `snapshots`, having every snapshot in memory.
    ///
    /// # Errors
    /// A driver that fails.
    pub fn time(&self, prepared: &Prepared, snapshots: bool) -> Result<Duration, GpuError> {
        let mode = if snapshots { Mode::Snapshots } else { Mode::Frame };
        let start = Instant::now();
        run(prepared, mode, &Notes::default())?;
        let took = start.elapsed();
        if snapshots {
            staged(prepared, mode)?.flat_map(StagedPass::iter).for_each(readback::Staging::unmap);
        }
        Ok(took)
    }

    /// Runs the timed passes and adds up how long the GPU took for them, in milliseconds; `None`
    /// where it can't tell.
    ///
    /// # Errors
    /// A driver that fails.
    pub fn gpu_ms(&self, prepared: &Prepared) -> Result<Option<f64>, GpuError> {
        let context = &prepared.context;
        let notes = context.guarded(|| Ok(Notes::of_times(prepared, Mode::Frame)))?;
        let Some(timestamps) = &notes.timestamps else { return Ok(None) };
        run(prepared, Mode::Frame, &notes)?;
        let times = timestamps.read(context)?;
        // What the CPU makes takes the GPU no time.
        let passes = prepared.plan.passes.iter().zip(times).filter(|(pass, _)| pass.timed && pass.image.is_none());
        Ok(passes.map(|(_, ms)| ms).sum())
    }

    /// Runs the timed passes and counts, for each draw of each pass, the samples that passed its tests;
    /// `None` for draws that do something where they fail them, for those of maps that are kept, and where
    /// there are too many to ask.
    ///
    /// # Errors
    /// A driver that fails.
    pub fn samples(&self, prepared: &Prepared) -> Result<Vec<Vec<Option<u64>>>, GpuError> {
        let context = &prepared.context;
        // A map that stays is drawn once: a pass that does not run shows no sample of what it holds.
        let asks = |pass: &Pass| !prepared.may_keep(pass);
        let samples = context.guarded(|| Ok(Samples::new(&context.device, prepared.plan, asks)))?;
        let notes = Notes { samples, ..Notes::default() };
        run(prepared, Mode::Frame, &notes)?;
        match &notes.samples {
            Some(samples) => samples.read(),
            None => Ok(prepared.plan.passes.iter().map(|pass| vec![None; pass.draws.len()]).collect()),
        }
    }

    /// Runs all passes and keeps every attachment after each. With `bracket`, an attached
    /// graphics debugger records the frame.
    ///
    /// # Errors
    /// A driver that fails.
    pub fn capture(&self, prepared: Prepared, bracket: bool) -> Result<Output, GpuError> {
        let context = &prepared.context;
        let kept: Vec<bool> = prepared.plan.passes.iter().map(|pass| prepared.is_kept(pass)).collect();
        let notes = context.guarded(|| Ok(Notes::of_times(&prepared, Mode::Everything)))?;
        let run = || run(&prepared, Mode::Everything, &notes);
        if bracket {
            context.bracketed(run)?
        } else {
            run()?
        }
        let times = match &notes.timestamps {
            Some(timestamps) => timestamps.read(context)?,
            None => vec![None; prepared.plan.passes.len()],
        };
        collect(&prepared, &times, kept)
    }

    /// Runs all passes and keeps the labels of each light: what is lit, and what is in shadow. Nothing
    /// else is copied, so that the largest maps cost no memory twice.
    ///
    /// # Errors
    /// A driver that fails.
    pub fn labels(&self, prepared: Prepared) -> Result<Vec<Option<Arc<Image>>>, GpuError> {
        run(&prepared, Mode::Labels, &Notes::default())?;
        let plan = prepared.plan;
        let mut labels = vec![None; plan.lights.len()];
        for (index, pass) in plan.passes.iter().enumerate() {
            if let Some(light) = labelled(plan, pass) {
                let staged = prepared.staged(index)?;
                let left = after(&color_change(plan, pass), &staged.color, PixelFormat::U8, plan.size)?;
                keep(&mut labels[light.0], left);
            }
        }
        Ok(labels)
    }
}

impl Notes {
    /// When the passes of a mode begin and end.
    fn of_times(prepared: &Prepared, mode: Mode) -> Notes {
        let runs = |pass: &Pass| mode.runs(pass) && !prepared.is_kept(pass);
        Notes { timestamps: Timestamps::new(&prepared.context, prepared.plan, runs), ..Notes::default() }
    }
}

impl Mode {
    fn runs(self, pass: &Pass) -> bool {
        pass.timed || matches!(self, Mode::Labels | Mode::Everything)
    }

    fn copies(self, plan: &FramePlan, pass: &Pass) -> bool {
        match self {
            Mode::Frame => false,
            Mode::Labels => labelled(plan, pass).is_some(),
            Mode::Snapshots | Mode::Everything => self.runs(pass),
        }
    }
}

/// The light whose labels the pass writes.
fn labelled(plan: &FramePlan, pass: &Pass) -> Option<LightId> {
    match plan.attachment(pass.color.as_ref()?.attachment).role {
        AttachmentRole::Labels(light) => Some(light),
        _ => None,
    }
}

/// The copies that a mode makes.
fn staged<'a>(prepared: &'a Prepared, mode: Mode) -> Result<impl Iterator<Item = &'a StagedPass>, GpuError> {
    let plan = prepared.plan;
    let copied = plan.passes.iter().enumerate().filter(|(_, pass)| mode.copies(plan, pass));
    Ok(copied.map(|(index, _)| prepared.staged(index)).collect::<Result<Vec<_>, _>>()?.into_iter())
}

/// Makes the pictures that come from the CPU and hands them to the GPU, before the frame.
fn upload_images(prepared: &Prepared, mode: Mode) {
    for (pass, targets) in prepared.plan.passes.iter().zip(&prepared.passes) {
        if let (Some(image), Some(texture), true) = (&pass.image, &targets.image_target, mode.runs(pass)) {
            let texels = image.source.make();
            let bytes_per_row = texels.len() as u32 / texture.height().max(1);
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row), rows_per_image: None };
            prepared.context.queue.write_texture(texture.as_image_copy(), &texels, layout, texture.size());
        }
    }
}

/// Submits and waits. What is kept is kept only of frames that nothing went wrong in.
fn run(prepared: &Prepared, mode: Mode, notes: &Notes) -> Result<(), GpuError> {
    prepared.context.guarded(|| submit(prepared, mode, notes))?;
    prepared.set_drawn();
    Ok(())
}

fn submit(prepared: &Prepared, mode: Mode, notes: &Notes) -> Result<(), GpuError> {
    upload_images(prepared, mode);
    let mut encoder = prepared.context.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for (index, pass) in prepared.plan.passes.iter().enumerate() {
        if !mode.runs(pass) {
            continue;
        }
        if !prepared.is_kept(pass) {
            record_pass(&mut encoder, prepared, index, notes);
        }
        if mode.copies(prepared.plan, pass) {
            prepared.staged(index)?.iter().for_each(|staging| staging.record(&mut encoder));
        }
    }
    notes.resolve(&mut encoder);
    prepared.context.queue.submit([encoder.finish()]);
    staged(prepared, mode)?.flat_map(StagedPass::iter).for_each(readback::Staging::request_map);
    notes.request_map();
    prepared.context.wait()
}

fn record_pass(encoder: &mut CommandEncoder, prepared: &Prepared, index: usize, notes: &Notes) {
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
        occlusion_query_set: notes.samples.as_ref().map(Samples::set),
        ..wgpu::RenderPassDescriptor::default()
    });
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
    pass.set_pipeline(&ready.pipeline);
    pass.set_stencil_reference(u32::from(draw.raster.stencil_reference));
    if draw.program.group_count() > 1 {
        pass.set_bind_group(1, &prepared.draw_group, &[prepared.draws.offset(ready.index)]);
    }
    let corners = draw.triangles.start * 3..draw.triangles.end * 3;
    if let Some((surface, light)) = &ready.shading {
        pass.set_bind_group(2, surface, &[]);
        pass.set_bind_group(3, light, &[light_offset]);
        pass.draw(corners, 0..1);
    } else {
        pass.set_vertex_buffer(0, ready.vertices.slice(..));
        pass.set_index_buffer(ready.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(corners, draw.base_vertex as i32, 0..1);
    }
}

/// Turns mapped copies into steps, sharing what did not change.
fn collect(prepared: &Prepared, times: &[Option<f64>], kept: Vec<bool>) -> Result<Output, GpuError> {
    let plan = prepared.plan;
    let zero = |format: PixelFormat| Arc::new(Image::uniform(format, plan.size, &vec![0; format.texel_bytes()]));
    // wgpu clears new textures to zero.
    let mut color = zero(PixelFormat::Rgba8Srgb);
    let mut depth = zero(PixelFormat::Depth32F);
    let mut stencil = zero(PixelFormat::U8);
    let none = vec![None; plan.lights.len()];
    let maps = empty_maps(plan);
    let mut output = Output { steps: Vec::new(), targets: Vec::new(), labels: none.clone(), counts: none, maps, kept };
    for (index, pass) in plan.passes.iter().enumerate() {
        let staged = prepared.staged(index)?;
        let role = |target| plan.attachment(target).role;
        let color_role = pass.color.as_ref().map(|target| (role(target.attachment), target.layer));
        let depth_role = pass.depth_stencil.as_ref().map(|target| (role(target.attachment), target.layer));
        let (snapshot, target) = match (color_role, depth_role) {
            (Some((AttachmentRole::Map(light), face)), _) | (_, Some((AttachmentRole::Map(light), face))) => {
                let face = face as usize;
                let faces = &mut output.maps[light.0];
                if let (Some(faces), Some(staging)) = (faces.as_mut(), staged.color.as_ref().or(staged.depth.as_ref()))
                {
                    faces[face] = staging.image()?;
                }
                let image = faces.as_ref().map(|faces| faces[face].clone());
                (Snapshot::Map { light: light.0, face }, image)
            }
            _ => {
                let change = color_change(plan, pass);
                let (mut color_after, mut own) = (None, None);
                let target = match color_role.map(|(role, _)| role) {
                    Some(AttachmentRole::Labels(light)) => {
                        keep(&mut output.labels[light.0], after(&change, &staged.color, PixelFormat::U8, plan.size)?);
                        own.clone_from(&output.labels[light.0]);
                        FrameTarget::Labels
                    }
                    Some(AttachmentRole::Count(light)) => {
                        let count = after(&change, &staged.color, PixelFormat::Count32F, plan.size)?;
                        keep(&mut output.counts[light.0], count);
                        own.clone_from(&output.counts[light.0]);
                        FrameTarget::Count
                    }
                    _ => {
                        color_after = after(&change, &staged.color, PixelFormat::Rgba8Srgb, plan.size)?;
                        FrameTarget::Picture
                    }
                };
                let depth_after = after(&depth_change(pass), &staged.depth, PixelFormat::Depth32F, plan.size)?;
                let stencil_after = after(&stencil_change(pass), &staged.stencil, PixelFormat::U8, plan.size)?;
                let frame = FrameSnapshot {
                    color: step_aspect(&mut color, color_after),
                    depth: step_aspect(&mut depth, depth_after),
                    stencil: prepared.passes[index].has_stencil.then(|| step_aspect(&mut stencil, stencil_after)),
                    target,
                };
                (Snapshot::Frame(frame), own)
            }
        };
        // What the CPU makes takes the GPU no time.
        let gpu_ms = times[index].filter(|_| pass.image.is_none());
        output.steps.push(step(pass, gpu_ms, snapshot));
        output.targets.push(target);
    }
    Ok(output)
}

fn empty_maps(plan: &FramePlan) -> Vec<Option<Vec<Arc<Image>>>> {
    let faces = |map: &crate::plan::PlanMap| {
        let size = plan.attachment(map.attachment).size;
        let clear = match map.lookup {
            Some(lookup) => Image::uniform(PixelFormat::Depth32F, size, &lookup.clear_depth.to_le_bytes()),
            None => Image::uniform(PixelFormat::Rgba8, size, &[255; 4]),
        };
        std::iter::repeat_n(Arc::new(clear), map.faces.len()).collect()
    };
    plan.lights.iter().map(|light| light.map.as_ref().map(faces)).collect()
}

/// The picture that a change leaves; `None` where nothing changes.
fn after(
    change: &Change,
    staged: &Option<readback::Staging>,
    format: PixelFormat,
    size: [u32; 2],
) -> Result<Option<Arc<Image>>, GpuError> {
    match (change, staged) {
        (Change::Uniform(texel), _) => Ok(Some(Arc::new(Image::uniform(format, size, texel)))),
        (Change::Drawn, Some(staging)) => staging.image().map(Some),
        _ => Ok(None),
    }
}

/// A pass that changes nothing leaves what was there.
fn keep(known: &mut Option<Arc<Image>>, after: Option<Arc<Image>>) {
    if after.is_some() {
        *known = after;
    }
}

/// Moves an aspect on by one step. A clear to what was there already changes nothing.
fn step_aspect(current: &mut Arc<Image>, next: Option<Arc<Image>>) -> Aspect {
    let changed = next.filter(|next| next != current);
    let unchanged = changed.is_none();
    if let Some(next) = changed {
        *current = next;
    }
    Aspect { image: current.clone(), unchanged }
}

fn step(pass: &Pass, gpu_ms: Option<f64>, snapshot: Snapshot) -> Step {
    let summary = |draw: &Draw| DrawSummary {
        name: draw.name.clone(),
        caster: draw.caster.clone(),
        part: draw.part,
        triangles: u64::from(draw.triangles.end - draw.triangles.start),
        after: None,
    };
    Step {
        name: pass.name.clone(),
        purpose: pass.purpose.clone(),
        light: pass.light.map(|light| light.0),
        draws: pass.draws.iter().map(summary).collect(),
        gpu_ms,
        snapshot,
    }
}
