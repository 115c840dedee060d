//! Runs a recorded frame draw by draw, and reads back what each draw left.

use super::probe::{ProbeGpu, accepted};
use super::probes::{ProbeBudget, Probes};
use super::states::{self, PassState};
use super::vertices::ResolvedVertices;
use super::{readback, rewrite};
use crate::import::{
    RawContents, RawDraw, RawEvent, RawFragment, RawFrame, RawKind, RawTarget, RawTexture, RecordedApi, pictures,
};
use crate::plan::ShaderEffect;
use crate::wrap::command::{DrawCommand, EncoderCommand, FinishedCommands, PassCommand, PassTargets};
use crate::wrap::{PipelineSource, ViewSubresource};
use std::collections::{BTreeMap, HashMap};

/// The replay of a frame: runs its recorded commands again, draw by draw, and stores what each draw left in its targets.
#[derive(Debug, Default)]
pub struct FrameReplay {
    textures: HashMap<wgpu::Texture, usize>,
    raw: Vec<RawTexture>,
    of_target: BTreeMap<RawTarget, wgpu::Texture>,
    before: Vec<(RawTarget, RawContents)>,
    /// The last content of each target.
    contents: BTreeMap<RawTarget, RawContents>,
    events: Vec<RawEvent>,
    groups: Vec<String>,
    limits: Vec<String>,
    probes: Probes,
    budget: ProbeBudget,
    draws: usize,
}

/// The colour and depth targets of a replayed pass.
#[derive(Debug, Clone, Default)]
struct PassTarget {
    colors: Vec<RawTarget>,
    depth: Option<RawTarget>,
}

impl FrameReplay {
    /// Returns a replay that uses the probes of frames before, if there are any.
    pub fn with(probes: Probes) -> FrameReplay {
        FrameReplay { probes, ..FrameReplay::default() }
    }

    /// Returns how many draws have been replayed so far.
    pub fn draws(&self) -> usize {
        self.draws
    }

    /// Returns whether the frame has replayed any draw.
    pub fn has_drawn(&self) -> bool {
        self.draws > 0
    }

    /// Runs the recorded commands of encoders, in order, split so that each draw's result can be read. Commands that
    /// were not recorded, or that wgpu refuses so, are submitted whole; that is noted as a limit.
    pub fn submit(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        buffers: Vec<FinishedCommands>,
    ) -> wgpu::SubmissionIndex {
        for FinishedCommands { inner, list, .. } in buffers {
            let Some(list) = list else {
                self.limit("some commands were encoded before the frame began, and are not recorded");
                queue.submit([inner]);
                continue;
            };
            let commands = list.take();
            let played = accepted(device, || {
                // An encoder with an error does nothing.
                let mut encoder = new_encoder(device);
                commands.iter().for_each(|command| command.encode(&mut encoder));
                accepted(device, || drop(encoder.finish()))?;
                self.play(ProbeGpu { device, queue }, commands)
            });
            if played.flatten().is_none() {
                self.limit("wgpu refused some of its commands");
                // The program gets the error by submitting all of it as it was.
                queue.submit([inner]);
            }
        }
        queue.submit([])
    }

    fn limit(&mut self, limit: &str) {
        if !self.limits.iter().any(|known| known == limit) {
            self.limits.push(limit.to_owned());
        }
    }

    /// Runs the commands of one encoder and adds their events; a render pass is split. `None` where wgpu refuses a
    /// part: the commands after it are not run.
    fn play(&mut self, gpu: ProbeGpu<'_>, commands: Vec<EncoderCommand>) -> Option<()> {
        let mut pending = new_encoder(gpu.device);
        let depth = self.groups.len();
        for command in commands {
            match command {
                EncoderCommand::PushGroup(name) => self.groups.push(name),
                EncoderCommand::PopGroup => drop(self.groups.pop()),
                EncoderCommand::Encode(_) => command.encode(&mut pending),
                EncoderCommand::ComputePass { ref label, .. } => {
                    command.encode(&mut pending);
                    let name = label.clone().unwrap_or_else(|| "compute pass".into());
                    self.event(name, RawKind::Compute, &PassTarget::default());
                }
                EncoderCommand::RenderPass(..) => {
                    gpu.does(std::mem::replace(&mut pending, new_encoder(gpu.device)))?;
                    self.pass(gpu, &command)?;
                }
            }
        }
        self.groups.truncate(depth);
        gpu.does(pending)
    }

    /// Runs a render pass in as many parts as it has draws, and adds an event with the content after each; a pass with
    /// queries or transient targets runs whole, which is noted as a limit. `None` where wgpu refuses it.
    fn pass(&mut self, gpu: ProbeGpu<'_>, whole: &EncoderCommand) -> Option<()> {
        let EncoderCommand::RenderPass(targets, commands) = whole else { return Some(()) };
        let into = self.targets(gpu, targets);
        let name = targets.label.clone().unwrap_or_else(|| "render pass".to_owned());
        let depth = self.groups.len();
        self.groups.push(name.clone());
        let why_whole = if targets.occlusion.is_some() || commands.iter().any(PassCommand::spans) {
            Some("passes with queries are not taken apart: what their draws leave one by one is not known")
        } else if targets.are_transient() {
            Some("passes into transient targets are not taken apart: what their draws leave one by one is not known")
        } else {
            None
        };
        why_whole.into_iter().for_each(|why| self.limit(why));
        let is_whole = why_whole.is_some();
        let mut encoder = new_encoder(gpu.device);
        if !is_whole {
            drop(targets.begin(&mut encoder, true, false));
            gpu.does(std::mem::replace(&mut encoder, new_encoder(gpu.device)))?;
            self.after(gpu, name.clone(), RawKind::BeginPass, &into);
        }
        let mut state = PassState::default();
        let mut between: Vec<&PassCommand> = Vec::new();
        for command in commands.iter().flat_map(PassCommand::one_by_one) {
            match command {
                PassCommand::PushGroup(name) => self.groups.push(name.clone()),
                PassCommand::PopGroup => drop(self.groups.pop()),
                PassCommand::Draw(draw) => {
                    let raw = RawKind::Draw(Box::new(self.draw(gpu, targets, &state, draw)));
                    let label = state.pipeline().map_or("", |pipeline| &pipeline.label);
                    let name =
                        if label.is_empty() { draw.name().to_owned() } else { format!("{}({label})", draw.name()) };
                    self.draws += 1;
                    if is_whole {
                        self.event(name, raw, &into);
                        continue;
                    }
                    let mut pass = targets.begin(&mut encoder, false, false);
                    state.commands().chain(between.drain(..)).for_each(|command| command.encode(&mut pass));
                    draw.encode(&mut pass);
                    drop(pass);
                    gpu.does(std::mem::replace(&mut encoder, new_encoder(gpu.device)))?;
                    self.after(gpu, name, raw, &into);
                }
                command => {
                    if !state.note(command) {
                        between.push(command);
                    }
                }
            }
        }
        if is_whole {
            whole.encode(&mut encoder);
        } else {
            let mut pass = targets.begin(&mut encoder, false, true);
            between.into_iter().for_each(|command| command.encode(&mut pass));
        }
        gpu.does(encoder)?;
        self.after(gpu, name, RawKind::EndPass, &into);
        self.groups.truncate(depth);
        Some(())
    }

    /// Returns the targets of a pass; content is read where a target occurs for the first time.
    fn targets(&mut self, gpu: ProbeGpu<'_>, targets: &PassTargets) -> PassTarget {
        let colors = targets.colors.iter().flatten();
        let colors: Vec<RawTarget> = colors.map(|color| self.target(gpu, color.view.texture(), color.part)).collect();
        let depth = targets.depth_stencil.as_ref();
        PassTarget { colors, depth: depth.map(|depth| self.target(gpu, depth.view.texture(), depth.part)) }
    }

    fn target(
        &mut self,
        gpu: ProbeGpu<'_>,
        texture: &wgpu::Texture,
        ViewSubresource { mip, layer }: ViewSubresource,
    ) -> RawTarget {
        let index = *self.textures.entry(texture.clone()).or_insert_with(|| {
            self.raw.push(RawTexture {
                name: format!("texture {}", self.raw.len() + 1),
                format: readback::format(texture.format()),
                size: [texture.width(), texture.height()],
                layers: texture.depth_or_array_layers(),
                samples: texture.sample_count(),
            });
            self.raw.len() - 1
        });
        let target = RawTarget { texture: index, mip, layer };
        if self.of_target.insert(target, texture.clone()).is_none() {
            let contents = self.read(gpu, &[target]);
            self.before.extend(contents.into_iter().map(|contents| (target, contents)));
        }
        target
    }

    /// Reads the content of those of the targets that have occurred before, in order, and stores it as their last
    /// known; unchanged rows share memory with the content before. Depths that can't be copied are noted as a limit.
    fn read(&mut self, gpu: ProbeGpu<'_>, targets: &[RawTarget]) -> Vec<RawContents> {
        let part =
            |RawTarget { mip, layer, .. }: RawTarget, texture| readback::TextureSubresource { texture, mip, layer };
        let known: Vec<_> =
            targets.iter().filter_map(|target| Some((*target, self.of_target.get(target)?.clone()))).collect();
        let parts: Vec<_> = known.iter().map(|(target, texture)| part(*target, texture)).collect();
        let mut all = readback::contents(gpu.device, gpu.queue, &parts);
        for ((target, texture), contents) in known.iter().zip(&mut all) {
            let format = texture.format();
            if format.has_depth_aspect() && contents.depth.is_none() {
                self.limit(&format!("what {format:?} holds can't be copied, so that its depths are not known"));
            }
            let last = self.contents.entry(*target).or_default();
            pictures::share(contents, last);
            last.clone_from(contents);
        }
        all
    }

    fn event(&mut self, name: String, kind: RawKind, into: &PassTarget) {
        let id = self.events.len() as u32 + 1;
        let (groups, after) = (self.groups.clone(), RawContents::default());
        let (color_targets, depth_target) = (into.colors.clone(), into.depth);
        self.events.push(RawEvent { id, name, groups, kind, color_targets, depth_target, after });
    }

    /// Adds an event with the content that its depth target and its first colour target have now.
    fn after(&mut self, gpu: ProbeGpu<'_>, name: String, kind: RawKind, into: &PassTarget) {
        self.event(name, kind, into);
        let targets: Vec<RawTarget> = into.depth.into_iter().chain(into.colors.first().copied()).collect();
        let after = self.read(gpu, &targets).into_iter().fold(RawContents::default(), RawContents::or);
        if let Some(event) = self.events.last_mut() {
            event.after = after;
        }
    }

    fn draw(&mut self, gpu: ProbeGpu<'_>, targets: &PassTargets, state: &PassState, draw: &DrawCommand) -> RawDraw {
        let landed = self.probes.landed(gpu, state, draw, &mut self.budget).unwrap_or_else(|why| {
            self.limit(&format!("a draw has states alone: {why}"));
            ResolvedVertices::default()
        });
        let size = |view: &wgpu::TextureView, part: ViewSubresource| {
            [view.texture().width(), view.texture().height()].map(|side| (side >> part.mip).max(1))
        };
        let of_color = targets.colors.iter().flatten().next().map(|color| size(&color.view, color.part));
        let of_depth = targets.depth_stencil.as_ref().map(|depth| size(&depth.view, depth.part));
        let size = of_depth.or(of_color).unwrap_or([1, 1]);
        let view = state.view(size);
        let described = state.pipeline().cloned();
        let described = described.as_deref();
        let clips = described.is_some_and(clips);
        let unlike = described.map(unlike).unwrap_or_default().into_iter().chain(clips.then_some(CLIPS));
        unlike.for_each(|what| self.limit(what));
        let fragment = described.map_or(UNKNOWN, fragment);
        // Draws that are not followed have no fragments to distinguish.
        let is_followed =
            !landed.triangles.is_empty() && described.is_some_and(|described| described.multisample.count == 1);
        let is_asked = is_followed && fragment.may_discard == ShaderEffect::Yes;
        let retained = is_asked
            .then(|| self.probes.retained(gpu, state, draw, &landed, size, &mut self.budget))
            .and_then(|retained| {
                retained.map_err(|why| self.limit(&format!("which fragments a draw discards is not known: {why}"))).ok()
            });
        let ResolvedVertices { positions, triangles, instances } = landed;
        RawDraw {
            topology: described.map_or(crate::import::RawTopology::Other, states::topology),
            positions,
            triangles,
            instances,
            view,
            shape: described.map_or_else(no_shape, |described| states::shape(described, clips)),
            depth: described.and_then(states::depth),
            stencil: described.and_then(|described| state.stencil(described)),
            blend: described.and_then(states::blend),
            fragment,
            retained,
            samples: described.map_or(1, |described| described.multisample.count),
            sampled: None,
        }
    }

    /// Returns the whole frame, as an import has it, and the probes that frames after it may use again.
    pub fn frame(self, adapter: &wgpu::AdapterInfo) -> (RawFrame, Probes) {
        let program = std::env::current_exe().ok();
        let program = program.and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
        let frame = RawFrame {
            api: RecordedApi::Wgpu,
            adapter: adapter.name.clone(),
            recorder: format!("stencilscope {}", env!("CARGO_PKG_VERSION")),
            program,
            textures: self.raw,
            before: self.before,
            events: self.events,
            limits: self.limits,
        };
        (frame, self.probes)
    }
}

fn new_encoder(device: &wgpu::Device) -> wgpu::CommandEncoder {
    device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

const CLIPS: &str = "a draw is cut by planes of its shader's, which are not followed";

fn clips(described: &PipelineSource) -> bool {
    let stage = &described.vertex;
    stage.source.module().is_some_and(|module| rewrite::clips(&module, stage.entry_point.as_deref()))
}

/// Returns sentences about what a pipeline does that is not followed: a sample mask that leaves samples out,
/// conservative rasterisation. Empty where it does neither.
fn unlike(described: &PipelineSource) -> Vec<&'static str> {
    let all = if described.multisample.count >= 64 { u64::MAX } else { (1 << described.multisample.count) - 1 };
    let masks = described.multisample.mask & all != all;
    let masks = masks.then_some("a draw leaves out samples by a mask, which is not followed");
    let conservative = described.primitive.conservative;
    masks
        .into_iter()
        .chain(conservative.then_some("a draw is rasterised conservatively, which is not followed"))
        .collect()
}

const UNKNOWN: RawFragment = RawFragment { may_discard: ShaderEffect::Unknown, writes_depth: ShaderEffect::Unknown };

/// Returns the state of a draw without a pipeline, which wgpu refuses: both faces culled, so that it draws nothing.
fn no_shape() -> crate::import::RawShape {
    crate::import::RawShape {
        cull: crate::import::RawCull::Both,
        front_is_counter_clockwise: true,
        fill: wgpu::PolygonMode::Fill,
        bias: [0.0; 3],
        depth_clamp: false,
        depth_clip: true,
        clip_planes: false,
    }
}

/// Returns whether a pipeline's fragment shader may discard (alpha to coverage counts) or write depth: neither without
/// one; both unknown where it can't be read; discarding unknown where it writes a sample mask.
fn fragment(described: &PipelineSource) -> RawFragment {
    let Some(stage) = &described.fragment else {
        return RawFragment { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::No };
    };
    let module = stage.source.module();
    let Some(found) = module.and_then(|module| rewrite::fragment(&module, stage.entry_point.as_deref())) else {
        return UNKNOWN;
    };
    let may = |does: bool| if does { ShaderEffect::Yes } else { ShaderEffect::No };
    let may_discard = match found.masks {
        true => ShaderEffect::Unknown,
        false => may(found.discards || described.multisample.alpha_to_coverage_enabled),
    };
    RawFragment { may_discard, writes_depth: may(found.writes_depth) }
}
