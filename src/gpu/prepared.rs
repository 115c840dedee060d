//! A plan with everything the GPU needs to run it: textures, pipelines, buffers, bind groups, and,
//! once a run wants them, the buffers that snapshots are copied to. Made once, run as often as wanted.

use super::attachments::AttachmentPool;
use super::budget::MemoryBudget;
use super::buffers::{Buffers, check_bound};
use super::maps::{CachedMap, MapCache};
use super::pictures::Pictures;
use super::pipelines::{BindGroupLayouts, PipelineKey, Pipelines};
use super::readback::{StagedPass, StagingCopy, TargetChange, color_change, depth_change, stencil_change};
use super::shaders::{ShaderInputs, ShaderKey};
use super::specialization::Specialization;
use super::uniforms::{self, UniformArray};
use super::{GpuContext, GpuError, start};
use crate::plan::{
    Attachment, AttachmentId, AttachmentRole, Draw, FramePlan, LightId, Pass, PlanTexture, RasterState, SurfaceData,
    Visibility,
};
use std::cell::OnceCell;
use std::sync::Arc;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, Device, RenderPipeline, Texture,
    TextureAspect, TextureUsages, TextureView, TextureViewDescriptor, TextureViewDimension,
};

/// Buffers, textures and cached shadow maps that the next plan can use again, as long as the newest plan uses them.
#[derive(Debug, Default)]
pub(super) struct PlanResources {
    buffers: Buffers,
    pictures: Pictures,
    pub maps: MapCache,
    attachments: AttachmentPool,
}

impl PlanResources {
    /// Drops the attachment textures, so that the next plan's are new.
    pub fn forget_attachments(&mut self) {
        self.attachments = AttachmentPool::default();
    }

    /// Hands attachments out from another pool, which takes the place of the own one, and back.
    pub fn exchange_attachments(&mut self, other: &mut AttachmentPool) {
        std::mem::swap(&mut self.attachments, other);
    }

    fn next_plan(&mut self) {
        self.buffers.next_plan();
        self.pictures.next_plan();
        self.maps.next_plan();
    }
}

/// A plan with everything that the GPU needs to run it: pipelines, buffers, textures and bind groups.
#[derive(Debug)]
pub struct Prepared<'a> {
    pub(super) plan: &'a FramePlan,
    /// The GPU that it was prepared on: its device stays open as long as it is used, even where a later plan has opened
    /// another.
    pub(super) context: Arc<GpuContext>,
    pub(super) passes: Vec<PreparedPass>,
    textures: Vec<Arc<Texture>>,
    /// For each pass, the buffers that its snapshot is copied to, made when first needed.
    staged: Vec<OnceCell<StagedPass>>,
    pub(super) views: UniformArray,
    pub(super) view_group: BindGroup,
    pub(super) draws: UniformArray,
    pub(super) draw_group: BindGroup,
    pub(super) lights: UniformArray,
    /// For each attachment, the shadow map that is cached from frame to frame; `None` where it is not cached.
    pub(super) cached_maps: Vec<Option<Arc<CachedMap>>>,
    /// The memory left for copies after attachments and images.
    pub(super) budget: MemoryBudget,
}

#[derive(Debug)]
pub(super) struct PreparedPass {
    pub color: Option<TextureView>,
    pub depth_stencil: Option<TextureView>,
    pub has_stencil: bool,
    pub draws: Vec<PreparedDraw>,
    /// The pipeline that writes the depths a pass starts with; `None` where it starts with none.
    pub start: Option<RenderPipeline>,
    /// The texture that its image from the CPU is uploaded to; `None` where it has no image.
    pub image_target: Option<Arc<Texture>>,
}

#[derive(Debug)]
pub(super) struct PreparedDraw {
    pub shader: ShaderKey,
    /// Pipelines with the stencil reference of each: one, or two where front and back faces have masks of their own.
    pub pipelines: Vec<(RenderPipeline, u8)>,
    /// Its index among all draws of the plan.
    pub index: usize,
    pub vertices: Buffer,
    pub indices: Buffer,
    /// Bind groups 2 and 3: the first for programs that pull their vertices or read retained fragments, the second for
    /// those that light.
    pub shading: Option<(BindGroup, Option<BindGroup>)>,
}

impl<'a> Prepared<'a> {
    pub(super) fn new(
        context: &Arc<GpuContext>,
        pipelines: &mut Pipelines,
        resources: &mut PlanResources,
        plan: &'a FramePlan,
        mut budget: MemoryBudget,
    ) -> Result<Prepared<'a>, GpuError> {
        let device = &context.device;
        check_size(device, plan, &mut budget)?;
        resources.next_plan();
        let PlanResources { buffers, pictures, maps, attachments } = resources;
        let describe = |id| described(plan, id);
        let map = |id| maps.get(plan, id, || Arc::new(device.create_texture(&describe(id))));
        let cached_maps: Vec<Option<Arc<CachedMap>>> = (0..plan.attachments.len()).map(AttachmentId).map(map).collect();
        let given: Vec<_> = cached_maps.iter().map(|map| map.as_ref().map(|map| map.texture.clone())).collect();
        let textures = attachments.hand_out(device, plan, &given, describe);
        let views = uniforms::views(device, plan);
        let draws = uniforms::draws(device, plan);
        let lights = uniforms::lights(device, plan);
        let mut preparer =
            PassPreparer { context, plan, pipelines, buffers, pictures, lights: &lights, textures: &textures };
        let mut first_draw = 0;
        let mut passes = Vec::with_capacity(plan.passes.len());
        for pass in &plan.passes {
            passes.push(preparer.pass(pass, first_draw)?);
            first_draw += pass.draws.len();
        }
        let staged = plan.passes.iter().map(|_| OnceCell::new()).collect();
        let view_group = views.bind_group(device, &pipelines.layouts.view);
        let draw_group = draws.bind_group(device, &pipelines.layouts.draw);
        let context = context.clone();
        Ok(Prepared {
            plan,
            context,
            passes,
            textures,
            staged,
            views,
            view_group,
            draws,
            draw_group,
            lights,
            cached_maps,
            budget,
        })
    }

    /// Returns whether one of the pass's targets is a texture that is cached between frames (a shadow map or texture).
    pub(super) fn may_cache(&self, pass: &Pass) -> bool {
        pass.targets().any(|id| self.cached_maps[id.0].is_some())
    }

    /// Returns whether a target of this pass is cached and was drawn by an earlier frame, so that the pass need not
    /// run.
    pub(super) fn is_cached(&self, pass: &Pass) -> bool {
        let is_drawn = |id: AttachmentId| self.cached_maps[id.0].as_ref().is_some_and(|map| map.is_drawn());
        pass.targets().any(is_drawn)
    }

    /// Marks all cached maps as drawn, once all passes have run.
    pub(super) fn set_drawn(&self) {
        self.cached_maps.iter().flatten().for_each(|map| map.set_drawn());
    }

    /// Returns the depth-stencil layer that a pass draws into, for writing recorded content to it before the pass;
    /// `None` where it has none.
    pub(super) fn start_target(&self, index: usize) -> Option<start::StartTarget<'_>> {
        let target = self.plan.passes[index].depth_stencil.as_ref()?;
        Some(start::StartTarget {
            device: &self.context.device,
            texture: &self.textures[target.attachment.0],
            layer: stored_layer(self.plan, target.attachment, target.layer),
            view: self.passes[index].depth_stencil.as_ref()?,
            pipeline: self.passes[index].start.as_ref(),
        })
    }

    /// Returns the buffers that a pass's snapshot is copied to; made by the first call, and the same ones after it.
    pub(super) fn staged(&self, index: usize) -> Result<&StagedPass, GpuError> {
        let cell = &self.staged[index];
        if let Some(staged) = cell.get() {
            return Ok(staged);
        }
        let staged = stage(&self.context.device, self.plan, &self.plan.passes[index], &self.textures)?;
        Ok(cell.get_or_init(|| staged))
    }

    /// Drops the snapshot buffers of a pass; images made from them keep the memory alive.
    pub(super) fn forget_staged(&mut self, index: usize) {
        self.staged[index].take();
    }

    /// Returns how many bytes the snapshots of all timed passes copy, rows' padding included; aspects that a pass does
    /// not draw to are not copied.
    pub fn snapshot_bytes(&self) -> u64 {
        let bytes = |[color, depth, stencil]: [Option<AspectCopy>; 3]| {
            let copied = color.into_iter().chain(depth).chain(stencil);
            copied.map(|copied| copied.bytes(&self.textures)).sum::<u64>()
        };
        self.plan.passes.iter().filter(|pass| pass.timed).map(|pass| bytes(copied(self.plan, pass))).sum()
    }

    /// Returns whether the memory budget has enough left for the snapshots of all timed passes at once; takes nothing
    /// from it.
    pub fn holds_all_snapshots(&self) -> bool {
        let mut budget = self.budget;
        budget.take(self.snapshot_bytes()).is_ok()
    }
}

/// The device, caches and textures that passes are prepared with.
struct PassPreparer<'a> {
    context: &'a GpuContext,
    plan: &'a FramePlan,
    pipelines: &'a mut Pipelines,
    buffers: &'a mut Buffers,
    pictures: &'a mut Pictures,
    lights: &'a UniformArray,
    /// The texture of each attachment.
    textures: &'a [Arc<Texture>],
}

impl PassPreparer<'_> {
    /// Makes views, pipelines and bind groups of a pass whose first draw has the index `first_draw` among all draws of
    /// the plan. A pass without a target gets no draws.
    fn pass(&mut self, pass: &Pass, first_draw: usize) -> Result<PreparedPass, GpuError> {
        let plan = self.plan;
        let target = pass.depth_stencil.as_ref();
        let view = |id: AttachmentId, layer| layer_view(&self.textures[id.0], stored_layer(plan, id, layer));
        let start = pass.recorded.as_ref().and_then(|recorded| recorded.start.as_ref()?.depth.as_ref());
        let start = target.filter(|_| start.is_some()).map(|target| plan.attachment(target.attachment).stored_format());
        let image_target = pass.image.as_ref().and(pass.color.as_ref());
        // Another program's colours are not known: a draw that leaves nothing else is not run.
        let draws = if pass.targets().next().is_some() { &pass.draws[..] } else { &[] };
        Ok(PreparedPass {
            color: pass.color.as_ref().map(|target| view(target.attachment, target.layer)),
            depth_stencil: target.map(|target| view(target.attachment, target.layer)),
            has_stencil: target.is_some_and(|target| plan.attachment(target.attachment).format.has_stencil_aspect()),
            start: start.map(|format| self.pipelines.start(&self.context.device, format)),
            image_target: image_target.map(|target| self.textures[target.attachment.0].clone()),
            draws: (first_draw..)
                .zip(draws)
                .map(|(index, draw)| self.draw(pass, draw, index))
                .collect::<Result<_, _>>()?,
        })
    }

    fn draw(&mut self, pass: &Pass, draw: &Draw, index: usize) -> Result<PreparedDraw, GpuError> {
        let (device, plan) = (&self.context.device, self.plan);
        let mesh = &plan.meshes[draw.rasterised().mesh.0];
        let shader = ShaderKey::of(draw, mesh);
        let light = pass.light.map(|light| &plan.lights[light.0]);
        let specialization = Specialization::of(draw, pass, light, plan.wraps_diffuse);
        let of_state = |raster: &RasterState| {
            let key = PipelineKey { specialization, ..key_of(plan, pass, shader, raster) };
            (self.pipelines.get(device, &key), raster.stencil_reference)
        };
        let pipelines = draw.raster.by_face().iter().map(of_state).collect();
        let vertices = match &mesh.extruded {
            Some(extruded) => self.buffers.get(self.context, &extruded.corners)?,
            None => self.buffers.get(self.context, &mesh.vertices)?,
        };
        let indices = self.buffers.get(self.context, &mesh.indices)?;
        let shading = match (&mesh.surface, &mesh.retained) {
            (Some(surface), _) if shader.pulls_vertices() => {
                let group = self.surface_group(draw, surface, [&vertices, &indices])?;
                let light = pass.light.filter(|_| draw.program.visibility().is_some());
                Some((group, light.map(|light| self.light_group(draw, light))))
            }
            (_, Some(retained)) if shader.form == ShaderInputs::Retained => {
                Some((retained_group(device, self.pipelines, &self.buffers.get(self.context, retained)?)?, None))
            }
            _ => None,
        };
        Ok(PreparedDraw { shader, pipelines, index, vertices, indices, shading })
    }

    /// Makes the bind group of the surface that a vertex-pulling program reads; with UVs, picture and sampler where the
    /// draw has a texture and the surface has UVs.
    fn surface_group(
        &mut self,
        draw: &Draw,
        surface: &SurfaceData,
        [vertices, indices]: [&Buffer; 2],
    ) -> Result<BindGroup, GpuError> {
        let device = &self.context.device;
        let normals = self.buffers.get(self.context, &surface.normals.values)?;
        let sides = self.buffers.get(self.context, &surface.sides)?;
        let texture = draw.constants.texture.and_then(|id| self.plan.textures.get(id.0));
        let shown = match (&surface.uvs, texture) {
            (Some(uvs), Some(texture)) => Some((self.buffers.get(self.context, uvs)?, texture)),
            _ => None,
        };
        let storage = [vertices, indices, &normals, &sides];
        let uvs = shown.as_ref().map(|(uvs, _)| uvs);
        storage.into_iter().chain(uvs).try_for_each(|buffer| check_bound(device, buffer))?;
        let view = shown.as_ref().map(|(_, texture)| self.pictures.get(self.context, &texture.picture));
        let BindGroupLayouts { surface, textured_surface, .. } = &self.pipelines.layouts;
        let layout = if shown.is_some() { textured_surface } else { surface };
        let mut resources: Vec<BindingResource> = storage.map(Buffer::as_entire_binding).into();
        if let (Some((uvs, texture)), Some(view)) = (&shown, &view) {
            resources.push(uvs.as_entire_binding());
            resources.push(BindingResource::TextureView(view));
            resources.push(BindingResource::Sampler(&self.pipelines.picture_samplers[usize::from(texture.clamps)]));
        }
        let entry = |(binding, resource)| BindGroupEntry { binding, resource };
        let entries: Vec<BindGroupEntry> = (0..).zip(resources).map(entry).collect();
        Ok(device.create_bind_group(&BindGroupDescriptor { label: Some("surface"), layout, entries: &entries }))
    }

    /// Makes the bind group of a light for a lighting or labelling draw: its constants, and the map, textures, count or
    /// labels that the draw's program reads; without a texture where it reads none.
    fn light_group(&self, draw: &Draw, light: LightId) -> BindGroup {
        let (device, layouts) = (&self.context.device, &self.pipelines.layouts);
        let light = &self.plan.lights[light.0];
        let array = TextureViewDimension::D2Array;
        let map = light.map.as_ref().map(|map| map.attachment);
        let (attachment, dimension, layout) = match (draw.program.visibility(), map, light.count) {
            (Some(Visibility::Map), Some(map), _) => (map, array, &layouts.light_with_map),
            (Some(Visibility::ReceiverTexture | Visibility::Projected), Some(map), _) => {
                (map, array, &layouts.light_with_textures)
            }
            (Some(Visibility::Count), _, Some(count)) => (count, TextureViewDimension::D2, &layouts.light_with_count),
            (Some(Visibility::Labels), ..) => (light.labels, TextureViewDimension::D2, &layouts.light_with_labels),
            _ => return self.lights.bind_group(device, &layouts.light),
        };
        let view = self.textures[attachment.0]
            .create_view(&TextureViewDescriptor { dimension: Some(dimension), ..TextureViewDescriptor::default() });
        let entries = [
            BindGroupEntry { binding: 0, resource: self.lights.binding() },
            BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&view) },
            BindGroupEntry { binding: 2, resource: BindingResource::Sampler(&self.pipelines.smooth_sampler) },
        ];
        let is_smooth = std::ptr::eq(layout, &layouts.light_with_textures);
        let entries = if is_smooth { &entries[..] } else { &entries[..2] };
        device.create_bind_group(&BindGroupDescriptor { label: Some("light with texture"), layout, entries })
    }
}

/// Fails where an attachment or a texture's picture is larger on a side than the device allows; takes the bytes of all
/// of them from the budget, and fails where that is spent.
fn check_size(device: &Device, plan: &FramePlan, budget: &mut MemoryBudget) -> Result<(), GpuError> {
    let limit = device.limits().max_texture_dimension_2d;
    let mut bytes = 0;
    for (index, attachment) in plan.attachments.iter().enumerate() {
        let [width, height] = attachment.size;
        if width > limit || height > limit {
            return Err(GpuError::TooLarge {
                what: attachment.name.clone(),
                needed: format!("{width}x{height}"),
                most: format!("{limit}x{limit}"),
            });
        }
        bytes += plan.attachment_bytes(AttachmentId(index));
    }
    bytes += plan.textures.iter().map(PlanTexture::bytes).sum::<u64>();
    for texture in &plan.textures {
        let [width, height] = texture.picture.size();
        if width > limit || height > limit {
            return Err(GpuError::TooLarge {
                what: texture.picture.name().to_owned(),
                needed: format!("{width}x{height}"),
                most: format!("{limit}x{limit}"),
            });
        }
    }
    budget.take(bytes)
}

/// Returns the descriptor of an attachment's texture, with the usages that its role needs; it can be copied into only
/// for labels and where a recorded pass has content to begin with.
fn described(plan: &FramePlan, id: AttachmentId) -> wgpu::TextureDescriptor<'_> {
    let attachment = plan.attachment(id);
    let other = match attachment.role {
        AttachmentRole::Map(_) | AttachmentRole::Count(_) => TextureUsages::TEXTURE_BINDING,
        AttachmentRole::Labels(_) => TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        AttachmentRole::Color | AttachmentRole::DepthStencil | AttachmentRole::Visibility(_) => TextureUsages::empty(),
    };
    let is_started = |pass: &Pass| {
        let has_start = pass.recorded.as_ref().is_some_and(|recorded| recorded.start.is_some());
        has_start && pass.targets().any(|target| target == id)
    };
    let started = if plan.passes.iter().any(is_started) { TextureUsages::COPY_DST } else { TextureUsages::empty() };
    wgpu::TextureDescriptor {
        label: Some(&attachment.name),
        size: wgpu::Extent3d {
            width: attachment.size[0],
            height: attachment.size[1],
            depth_or_array_layers: plan.stored_layers(id),
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: attachment.stored_format(),
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC | other | started,
        view_formats: &[],
    }
}

/// Returns the texture layer in which a face of an attachment that is drawn is stored. A plan that draws another has
/// not passed the lint.
fn stored_layer(plan: &FramePlan, id: AttachmentId, layer: u32) -> u32 {
    plan.stored_layer(id, layer).unwrap_or_default()
}

pub(super) fn layer_view(texture: &Texture, layer: u32) -> TextureView {
    texture.create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..TextureViewDescriptor::default()
    })
}

fn key_of(plan: &FramePlan, pass: &Pass, shader: ShaderKey, raster: &RasterState) -> PipelineKey {
    let depth_stencil = pass.depth_stencil.as_ref().map(|target| plan.attachment(target.attachment));
    PipelineKey {
        shader,
        specialization: Specialization::default(),
        raster: RasterState {
            stencil_reference: 0,
            depth_bias: depth_stencil.map_or(raster.depth_bias, |target| target.rasteriser_bias(raster.depth_bias)),
            ..raster.clone()
        },
        color_format: pass.color.as_ref().map(|target| plan.attachment(target.attachment).format),
        depth_format: depth_stencil.map(Attachment::stored_format),
        depth_steps: depth_stencil.and_then(Attachment::depth_steps),
        shader_bias: depth_stencil.map_or(0, |target| target.shader_bias(raster.depth_bias).to_bits()),
    }
}

fn retained_group(device: &Device, pipelines: &Pipelines, retained: &Buffer) -> Result<BindGroup, GpuError> {
    check_bound(device, retained)?;
    let entries = [BindGroupEntry { binding: 0, resource: retained.as_entire_binding() }];
    let layout = &pipelines.layouts.retained;
    Ok(device.create_bind_group(&BindGroupDescriptor { label: Some("kept fragments"), layout, entries: &entries }))
}

/// One aspect of one layer of an attachment, which is copied after a pass.
#[derive(Debug, Clone, Copy)]
struct AspectCopy {
    attachment: AttachmentId,
    layer: u32,
    aspect: TextureAspect,
}

impl AspectCopy {
    fn bytes(self, textures: &[Arc<Texture>]) -> u64 {
        StagingCopy::bytes_of(&textures[self.attachment.0], self.aspect)
    }

    fn staging(self, device: &Device, textures: &[Arc<Texture>]) -> Result<StagingCopy, GpuError> {
        StagingCopy::new(device, &textures[self.attachment.0], self.layer, self.aspect)
    }
}

/// Returns what is copied after a pass for colour, depth and stencil; `None` for an aspect that it does not draw to (a
/// mere clear is not copied).
fn copied(plan: &FramePlan, pass: &Pass) -> [Option<AspectCopy>; 3] {
    let copied = |target: Option<(AttachmentId, u32)>, change: TargetChange, aspect| {
        let (attachment, layer) = target.filter(|_| change == TargetChange::Drawn)?;
        Some(AspectCopy { attachment, layer: stored_layer(plan, attachment, layer), aspect })
    };
    let color = pass.color.as_ref().map(|target| (target.attachment, target.layer));
    let depth_stencil = pass.depth_stencil.as_ref().map(|target| (target.attachment, target.layer));
    [
        copied(color, color_change(plan, pass), TextureAspect::All),
        copied(depth_stencil, depth_change(pass), TextureAspect::DepthOnly),
        copied(depth_stencil, stencil_change(pass), TextureAspect::StencilOnly),
    ]
}

fn stage(device: &Device, plan: &FramePlan, pass: &Pass, textures: &[Arc<Texture>]) -> Result<StagedPass, GpuError> {
    let staging = |copied: Option<AspectCopy>| copied.map(|copied| copied.staging(device, textures)).transpose();
    let [color, depth, stencil] = copied(plan, pass);
    Ok(StagedPass { color: staging(color)?, depth: staging(depth)?, stencil: staging(stencil)? })
}
