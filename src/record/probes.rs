//! Positions of the vertices of draws, and which fragments their shaders do not discard: draws are run once more, by
//! pipelines that are created once for all of the program's that do not differ in what matters here.

use super::probe::{Probe, ProbeGpu, accepted};
use super::states::PassState;
use super::vertices::{MOST_CORNERS, ResolvedVertices, corners, direct, instances};
use super::{fragments, vertices};
use crate::wrap::PipelineSource;
use crate::wrap::command::DrawCommand;
use std::sync::Arc;

/// Draws of more instances than this are not followed fragment by fragment, since each instance is a draw.
const MOST_INSTANCES: usize = 1 << 14;

/// How many corners and retained fragments of a frame there is still memory for.
#[derive(Debug)]
pub struct ProbeBudget {
    pub corners: u64,
    pub fragments: u64,
}

impl Default for ProbeBudget {
    /// Returns the default limits: half a gigabyte for each kind of log.
    fn default() -> ProbeBudget {
        ProbeBudget { corners: 1 << 25, fragments: 1 << 26 }
    }
}

/// The pipelines that write logs.
#[derive(Debug, Default)]
pub struct Probes {
    of_vertices: ProbePipelines,
    of_fragments: ProbePipelines,
}

/// Pipelines of one kind: those of the program that do not differ in what matters here share one.
#[derive(Debug, Default)]
struct ProbePipelines(Vec<(Arc<PipelineSource>, ProbeResult)>);

/// The probe, or why there is none, in words.
type ProbeResult = Result<Arc<Probe>, &'static str>;

impl ProbePipelines {
    fn get(
        &mut self,
        described: &Arc<PipelineSource>,
        is_alike: impl Fn(&PipelineSource, &PipelineSource) -> bool,
        make: impl FnOnce() -> Result<Probe, &'static str>,
    ) -> ProbeResult {
        if let Some((_, made)) = self.0.iter().find(|(of, _)| Arc::ptr_eq(of, described) || is_alike(of, described)) {
            return made.clone();
        }
        let made = make().map(Arc::new);
        self.0.push((described.clone(), made.clone()));
        made
    }
}

/// Returns whether a probe of vertices for one pipeline serves the other: same vertex shader, buffers, topology and
/// layout.
fn have_same_vertices(one: &PipelineSource, other: &PipelineSource) -> bool {
    let of = |of: &PipelineSource| (of.primitive.topology, of.primitive.strip_index_format, of.multiview_mask);
    let layout = |of: &PipelineSource| of.layout.as_ref().map(|layout| (layout.groups.clone(), layout.immediate_size));
    of(one) == of(other) && one.vertex == other.vertex && one.buffers == other.buffers && layout(one) == layout(other)
}

/// Returns whether a probe of fragments for one pipeline serves the other: same vertices, fragment shader, primitive
/// state, samples and depth bias. Depth and stencil tests may differ.
fn have_same_fragments(one: &PipelineSource, other: &PipelineSource) -> bool {
    let bias = |of: &PipelineSource| of.depth_stencil.as_ref().map(|state| state.bias);
    let of = |of: &PipelineSource| (of.primitive, of.multisample, bias(of));
    have_same_vertices(one, other) && of(one) == of(other) && one.fragment == other.fragment
}

/// Runs work of our own on the program's device: an error that wgpu reports becomes the result, and does not reach the
/// program.
fn guarded<T>(device: &wgpu::Device, work: impl FnOnce() -> Result<T, &'static str>) -> Result<T, &'static str> {
    accepted(device, work).unwrap_or(Err("wgpu refuses to draw it once more"))
}

impl Probes {
    /// Runs a draw's vertex shader once more and returns the clip-space positions of its vertices with the triangles,
    /// one instance after the other. Takes its corners from the budget.
    ///
    /// # Errors
    /// Why that can't be found, in words.
    pub fn landed(
        &mut self,
        gpu: ProbeGpu<'_>,
        state: &PassState,
        draw: &DrawCommand,
        budget: &mut ProbeBudget,
    ) -> Result<ResolvedVertices, &'static str> {
        let described = state.pipeline().ok_or("it has no pipeline")?;
        let make = || guarded(gpu.device, || vertices::probe(gpu.device, described));
        let probe = self.of_vertices.get(described, have_same_vertices, make)?;
        let parts = direct(gpu, draw)?;
        let mut all = ResolvedVertices::default();
        for part in &parts {
            let corners = corners(gpu, state, described, part)?;
            let all_corners = corners.len() as u64 * instances(part).len() as u64;
            if all_corners > MOST_CORNERS || all_corners > budget.corners {
                return Err("it has more corners than are followed");
            }
            budget.corners -= all_corners;
            let log = guarded(gpu.device, || vertices::log(&probe, gpu, state, part, corners.len() as u64))?;
            all.add(described, part, &corners, &log)?;
        }
        Ok(all)
    }

    /// Returns which fragments of a draw, whose triangles `landed`, its shader does not discard, in a target of that
    /// size.
    ///
    /// # Errors
    /// Why that can't be found, in words.
    pub fn retained(
        &mut self,
        gpu: ProbeGpu<'_>,
        state: &PassState,
        draw: &DrawCommand,
        landed: &ResolvedVertices,
        size: [u32; 2],
        budget: &mut ProbeBudget,
    ) -> Result<Vec<([u16; 2], u32)>, &'static str> {
        let described = state.pipeline().ok_or("it has no pipeline")?;
        let make = || guarded(gpu.device, || fragments::probe(gpu.device, described));
        let probe = self.of_fragments.get(described, have_same_fragments, make)?;
        let one_by_one = direct(gpu, draw)?.iter().flat_map(single).collect::<Vec<_>>();
        let first: Vec<u32> = landed.instances.iter().map(|triangles| triangles.start as u32).collect();
        let draws: Vec<_> = one_by_one.into_iter().zip(first).collect();
        if draws.len() > MOST_INSTANCES {
            return Err("it has more instances than are followed fragment by fragment");
        }
        let retained = guarded(gpu.device, || fragments::retained(&probe, gpu, state, &draws, size, budget.fragments))?;
        budget.fragments -= retained.len() as u64;
        Ok(retained)
    }
}

/// Splits a direct draw into one for each of its instances; an indirect one gives none.
fn single(draw: &DrawCommand) -> Vec<DrawCommand> {
    let one = |instance: u32| match draw.clone() {
        DrawCommand::Vertices { vertices, .. } => DrawCommand::Vertices { vertices, instances: instance..instance + 1 },
        DrawCommand::Indexed { indices, base_vertex, .. } => {
            DrawCommand::Indexed { indices, base_vertex, instances: instance..instance + 1 }
        }
        other => other,
    };
    instances(draw).map(one).collect()
}
