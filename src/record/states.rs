//! wgpu's states as a raw frame has them.

use crate::import::{RawBlend, RawCull, RawDepth, RawShape, RawStencilFace, RawTopology, RawView};
use crate::plan::FaceMasks;
use crate::wrap::PipelineSource;
use crate::wrap::command::PassCommand;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The states that a pass has set so far.
#[derive(Debug, Clone, Default)]
pub struct PassState {
    commands: BTreeMap<StateSlot, PassCommand>,
}

/// What a state sets: its kind, and the index within its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum StateSlot {
    Pipeline,
    BindGroup(u32),
    IndexBuffer,
    VertexBuffer(u32),
    /// Four bytes of immediates, at this offset.
    Immediates(u32),
    BlendConstant,
    Scissor,
    Viewport,
    StencilReference,
}

impl StateSlot {
    /// Returns whether wgpu keeps this state after a render bundle is executed.
    fn outlasts_bundles(self) -> bool {
        matches!(
            self,
            StateSlot::BlendConstant | StateSlot::Scissor | StateSlot::Viewport | StateSlot::StencilReference
        )
    }
}

fn slot(command: &PassCommand) -> Option<StateSlot> {
    Some(match command {
        PassCommand::Pipeline { .. } => StateSlot::Pipeline,
        PassCommand::BindGroup { index, .. } => StateSlot::BindGroup(*index),
        PassCommand::IndexBuffer { .. } => StateSlot::IndexBuffer,
        PassCommand::VertexBuffer { slot, .. } => StateSlot::VertexBuffer(*slot),
        PassCommand::BlendConstant(_) => StateSlot::BlendConstant,
        PassCommand::Scissor(_) => StateSlot::Scissor,
        PassCommand::Viewport { .. } => StateSlot::Viewport,
        PassCommand::StencilReference(_) => StateSlot::StencilReference,
        _ => return None,
    })
}

impl PassState {
    /// Stores the state that a command sets, in place of the one that it replaces; returns false for a command that
    /// sets none. After a render bundle, forgets the states that don't outlast it.
    pub fn note(&mut self, command: &PassCommand) -> bool {
        match command {
            PassCommand::Unbound => self.commands.retain(|slot, _| slot.outlasts_bundles()),
            PassCommand::Immediates { offset, data } => {
                for (offset, word) in (*offset..).step_by(4).zip(data.chunks(4)) {
                    let word = PassCommand::Immediates { offset, data: word.to_vec() };
                    self.commands.insert(StateSlot::Immediates(offset), word);
                }
            }
            command => {
                let Some(slot) = slot(command) else { return false };
                if let PassCommand::Pipeline { described, .. } = command {
                    self.clear_immediates(described);
                }
                self.commands.insert(slot, command.clone());
            }
        }
        true
    }

    /// Zeroes the stored immediates where the next pipeline has another layout, and forgets those beyond its immediate
    /// size; does nothing where the layout is the same.
    fn clear_immediates(&mut self, next: &Arc<PipelineSource>) {
        let is_same = self.pipeline().is_some_and(|current| match (&current.layout, &next.layout) {
            (Some(current), Some(next)) => current.real == next.real,
            _ => Arc::ptr_eq(current, next),
        });
        if is_same {
            return;
        }
        // The immediate size of a layout that wgpu derives is not known.
        let bytes = next.layout.as_ref().map_or(0, |layout| layout.immediate_size);
        self.commands.retain(|slot, _| !matches!(slot, StateSlot::Immediates(offset) if *offset >= bytes));
        for command in self.commands.values_mut() {
            if let PassCommand::Immediates { data, .. } = command {
                data.fill(0);
            }
        }
    }

    /// Returns the commands that set all states again, the pipeline first.
    pub fn commands(&self) -> impl Iterator<Item = &PassCommand> {
        self.commands.values()
    }

    /// Returns the description of the pipeline that was set last; `None` where none is set.
    pub fn pipeline(&self) -> Option<&Arc<PipelineSource>> {
        match self.commands.get(&StateSlot::Pipeline) {
            Some(PassCommand::Pipeline { described, .. }) => Some(described),
            _ => None,
        }
    }

    /// Returns the index buffer, its format, and the byte offset where it begins; `None` where none is set.
    pub fn index_buffer(&self) -> Option<(&wgpu::Buffer, wgpu::IndexFormat, u64)> {
        match self.commands.get(&StateSlot::IndexBuffer) {
            Some(PassCommand::IndexBuffer { buffer, format, offset, .. }) => Some((buffer, *format, *offset)),
            _ => None,
        }
    }

    fn reference(&self) -> u8 {
        match self.commands.get(&StateSlot::StencilReference) {
            Some(PassCommand::StencilReference(reference)) => *reference as u8,
            _ => 0,
        }
    }

    /// Returns viewport and scissor as set so far in a target of this size; the whole target, and no scissor, where
    /// none is set.
    pub fn view(&self, [width, height]: [u32; 2]) -> RawView {
        let (viewport, depth_range) = match self.commands.get(&StateSlot::Viewport) {
            Some(PassCommand::Viewport { area, depth }) => (*area, *depth),
            _ => ([0.0, 0.0, width as f32, height as f32], [0.0, 1.0]),
        };
        let scissor = match self.commands.get(&StateSlot::Scissor) {
            Some(PassCommand::Scissor(area)) => Some(area.map(|value| value.min(i32::MAX as u32) as i32)),
            _ => None,
        };
        RawView { viewport, depth_range, scissor, y_up: true, z_from_minus_w: false }
    }

    /// Returns the stencil tests of front and back faces with the reference set so far; `None` without a depth-stencil
    /// state, or where the test is off.
    pub fn stencil(&self, pipeline: &PipelineSource) -> Option<[RawStencilFace; 2]> {
        let state = &pipeline.depth_stencil.as_ref()?.stencil;
        let masks =
            FaceMasks { reference: self.reference(), read: state.read_mask as u8, write: state.write_mask as u8 };
        state.is_enabled().then(|| [state.front, state.back].map(|face| RawStencilFace { face, masks }))
    }
}

/// Returns a pipeline's culling, winding, filling, bias and depth clipping in the form of imported frames.
/// `clip_planes` says whether its shader clips by planes of its own.
pub fn shape(pipeline: &PipelineSource, clip_planes: bool) -> RawShape {
    let primitive = &pipeline.primitive;
    let bias = pipeline.depth_stencil.as_ref().map(|state| state.bias).unwrap_or_default();
    RawShape {
        cull: match primitive.cull_mode {
            None => RawCull::None,
            Some(wgpu::Face::Front) => RawCull::Front,
            Some(wgpu::Face::Back) => RawCull::Back,
        },
        front_is_counter_clockwise: primitive.front_face == wgpu::FrontFace::Ccw,
        fill: primitive.polygon_mode,
        bias: [bias.constant as f32, bias.slope_scale, bias.clamp],
        depth_clamp: primitive.unclipped_depth,
        depth_clip: !primitive.unclipped_depth,
        clip_planes,
    }
}

/// Returns how the pipeline's vertices form primitives, in the form of imported frames.
pub fn topology(pipeline: &PipelineSource) -> RawTopology {
    match pipeline.primitive.topology {
        wgpu::PrimitiveTopology::PointList => RawTopology::Points,
        wgpu::PrimitiveTopology::LineList | wgpu::PrimitiveTopology::LineStrip => RawTopology::Lines,
        wgpu::PrimitiveTopology::TriangleList => RawTopology::TriangleList,
        wgpu::PrimitiveTopology::TriangleStrip => RawTopology::TriangleStrip,
    }
}

/// Returns a pipeline's depth test in the form of imported frames; `None` where it has no depth aspect or no compare
/// function.
pub fn depth(pipeline: &PipelineSource) -> Option<RawDepth> {
    let state = pipeline.depth_stencil.as_ref().filter(|state| state.format.has_depth_aspect())?;
    let write = state.depth_write_enabled.unwrap_or(false);
    Some(RawDepth { compare: state.depth_compare?, write, bounds: false })
}

/// Returns how a pipeline writes its first colour target, in the form of imported frames; `None` where it has none.
pub fn blend(pipeline: &PipelineSource) -> Option<RawBlend> {
    let target = pipeline.targets.first()?.as_ref()?;
    let write = [wgpu::ColorWrites::RED, wgpu::ColorWrites::GREEN, wgpu::ColorWrites::BLUE, wgpu::ColorWrites::ALPHA];
    Some(RawBlend {
        equations: target.blend.map(|blend| [Some(blend.color), Some(blend.alpha)]),
        write: write.map(|part| target.write_mask.contains(part)),
    })
}
