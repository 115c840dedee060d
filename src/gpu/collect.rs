//! Makes steps of the copies of a frame, part by part: what did not change is shared, and its copy given back.

use super::GpuError;
use super::budget::MemoryBudget;
use super::prepared::Prepared;
use super::readback::{StagingCopy, TargetChange, color_change, depth_change, stencil_change};
use crate::capture::{
    Aspect, DrawSummary, FrameSnapshot, FrameTarget, Image, LightTargets, PixelFormat, Snapshot, Step,
};
use crate::plan::{AttachmentRole, Draw, FramePlan, Pass};
use std::sync::Arc;

/// The snapshots and times that a captured frame left, pass by pass and light by light.
#[derive(Debug)]
pub struct ExecutorOutput {
    /// One step for each pass, in the order of execution.
    pub steps: Vec<Step>,
    /// For each pass, what it left in its own colour target; `None` where it draws into the picture or has none.
    pub targets: Vec<Option<Arc<Image>>>,
    /// For each light, what passes left in its own targets: labels, count and visibility.
    pub of_lights: Vec<LightTargets>,
    /// For each light, the depths of each face of its shadow map, left-out faces at their clear value; `None` where it
    /// has no map.
    pub maps: Vec<Option<Vec<Arc<Image>>>>,
    /// For each pass, whether it did not run because its shadow map was cached from an earlier frame.
    pub from_cache: Vec<bool>,
}

/// Turns the mapped copies of each pass into the steps and images of an [`ExecutorOutput`], pass after pass.
pub(super) struct Collector {
    color: Arc<Image>,
    depth: Arc<Image>,
    stencil: Arc<Image>,
    output: ExecutorOutput,
    storage: SnapshotStorage,
}

/// How snapshots are stored, and the memory budget for them.
pub(super) struct SnapshotStorage {
    pub memory: SnapshotMemory,
    pub budget: MemoryBudget,
}

/// The memory that captured images are stored in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SnapshotMemory {
    /// Images stay in the mapped GPU buffers that they were copied to, without another copy.
    Mapped,
    /// Images are copied to the heap, and rows equal to those of the image before are shared with it: saves memory
    /// where many images differ little.
    Shared,
}

impl Collector {
    /// Returns a collector that has collected no pass: all images are zero, as wgpu clears new textures. `from_cache`
    /// says for each pass whether it will not run, as its result is cached.
    pub fn new(plan: &FramePlan, from_cache: Vec<bool>, storage: SnapshotStorage) -> Collector {
        // wgpu clears new textures to zero.
        let zero = |format: PixelFormat| Arc::new(Image::uniform(format, plan.size, &vec![0; format.texel_bytes()]));
        let (of_lights, maps) = (vec![LightTargets::default(); plan.lights.len()], empty_maps(plan));
        let (steps, targets) = (Vec::new(), Vec::new());
        Collector {
            color: zero(PixelFormat::Rgba8Srgb),
            depth: zero(PixelFormat::Depth32F),
            stencil: zero(PixelFormat::U8),
            output: ExecutorOutput { steps, targets, of_lights, maps, from_cache },
            storage,
        }
    }

    /// Appends the step of pass `index` with its snapshot, read from the copies, which must be mapped. Passes must come
    /// in order; an image that a pass left as it was is shared with the step before.
    pub fn take_in(&mut self, prepared: &Prepared, index: usize) -> Result<(), GpuError> {
        let plan = prepared.plan;
        let pass = &plan.passes[index];
        let staged = prepared.staged(index)?;
        let (output, storage) = (&mut self.output, &mut self.storage);
        let role = |target| plan.attachment(target).role;
        let color_role = pass.color.as_ref().map(|target| (role(target.attachment), target.layer));
        let depth_role = pass.depth_stencil.as_ref().map(|target| (role(target.attachment), target.layer));
        let (snapshot, target) = match (color_role, depth_role) {
            (Some((AttachmentRole::Map(light), face)), _) | (_, Some((AttachmentRole::Map(light), face))) => {
                let face = face as usize;
                let known = output.maps[light.0].as_mut().and_then(|faces| faces.get_mut(face));
                let image = match (known, staged.color.as_ref().or(staged.depth.as_ref())) {
                    (Some(known), Some(staging)) => {
                        storage.move_on(known, staging.image()?)?;
                        Some(known.clone())
                    }
                    (known, _) => known.cloned(),
                };
                (Snapshot::Map { light: light.0, face }, image)
            }
            _ => {
                let change = color_change(plan, pass);
                let (mut color_after, mut own) = (None, None);
                let target = match color_role.and_then(|(role, _)| FrameTarget::of(role)) {
                    Some((target, light)) => {
                        let image = after(&change, &staged.color, target.format(), plan.size)?;
                        if let Some(known) = output.of_lights[light.0].get_mut(target) {
                            storage.keep(known, image)?;
                            own.clone_from(known);
                        }
                        target
                    }
                    None => {
                        color_after = after(&change, &staged.color, PixelFormat::Rgba8Srgb, plan.size)?;
                        FrameTarget::Picture
                    }
                };
                let depth_after = after(&depth_change(pass), &staged.depth, PixelFormat::Depth32F, plan.size)?;
                let stencil_after = after(&stencil_change(pass), &staged.stencil, PixelFormat::U8, plan.size)?;
                let frame = FrameSnapshot {
                    color: storage.step_aspect(&mut self.color, color_after)?,
                    depth: storage.step_aspect(&mut self.depth, depth_after)?,
                    stencil: prepared.passes[index]
                        .has_stencil
                        .then(|| storage.step_aspect(&mut self.stencil, stencil_after))
                        .transpose()?,
                    target,
                };
                (Snapshot::Frame(frame), own)
            }
        };
        output.steps.push(step(pass, snapshot));
        output.targets.push(target);
        Ok(())
    }

    /// Returns the output after the last pass, with the GPU time of each pass in milliseconds as in `times`; `None` for
    /// a pass whose image the CPU makes.
    pub fn finish(self, plan: &FramePlan, times: Vec<Option<f64>>) -> ExecutorOutput {
        let mut output = self.output;
        for ((step, pass), ms) in output.steps.iter_mut().zip(&plan.passes).zip(times) {
            // What the CPU makes takes the GPU no time.
            step.gpu_ms = ms.filter(|_| pass.image.is_none());
        }
        output
    }
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

/// Returns the image that a pass leaves in an aspect: uniform after a mere clear, else its copy from the GPU. `None`
/// where the pass does not change the aspect, or no copy was made.
pub(super) fn after(
    change: &TargetChange,
    staged: &Option<StagingCopy>,
    format: PixelFormat,
    size: [u32; 2],
) -> Result<Option<Arc<Image>>, GpuError> {
    match (change, staged) {
        (TargetChange::Uniform(texel), _) => Ok(Some(Arc::new(Image::uniform(format, size, texel)))),
        (TargetChange::Drawn, Some(staging)) => staging.image().map(Some),
        _ => Ok(None),
    }
}

impl SnapshotStorage {
    /// Replaces the `known` image by the image after a pass, and takes the bytes of new memory from the budget; an
    /// equal image is not replaced. Where `after` is `None`, the image before stays.
    pub fn keep(&mut self, known: &mut Option<Arc<Image>>, after: Option<Arc<Image>>) -> Result<(), GpuError> {
        match (known, after) {
            (_, None) => {}
            (Some(known), Some(after)) => _ = self.move_on(known, after)?,
            (known, Some(after)) => {
                self.budget.take(after.bytes_beside(None))?;
                *known = Some(after);
            }
        }
        Ok(())
    }

    /// Replaces an aspect's `current` image by the `next` one where a texel differs, and returns the aspect of this
    /// step. Else, and where `next` is `None`, the image stays and the aspect is unchanged, even if a pass cleared or
    /// drew it. Fails where the memory budget is exceeded.
    fn step_aspect(&mut self, current: &mut Arc<Image>, next: Option<Arc<Image>>) -> Result<Aspect, GpuError> {
        let changed = match next {
            Some(next) => self.move_on(current, next)?,
            None => false,
        };
        Ok(Aspect { image: current.clone(), unchanged: !changed })
    }

    /// Replaces the `current` image by the next one where any texel differs, and returns whether it did. Takes the
    /// bytes of new memory from the budget, and shares equal rows where images are stored so.
    fn move_on(&mut self, current: &mut Arc<Image>, next: Arc<Image>) -> Result<bool, GpuError> {
        let is_another = next != *current;
        if is_another {
            let sharing = if self.memory == SnapshotMemory::Shared { next.sharing(current) } else { None };
            let next = sharing.map_or(next, Arc::new);
            self.budget.take(next.bytes_beside(Some(current)))?;
            *current = next;
        }
        Ok(is_another)
    }
}

/// Returns the step of a pass with its snapshot and draws, without GPU time and without states after draws.
fn step(pass: &Pass, snapshot: Snapshot) -> Step {
    let summary = |draw: &Draw| DrawSummary {
        name: draw.name.clone(),
        caster: draw.caster.clone(),
        part: draw.part,
        triangles: u64::from(draw.triangles.end - draw.triangles.start),
        after: None,
        differs: None,
    };
    Step {
        name: pass.name.clone(),
        purpose: pass.purpose.clone(),
        light: pass.light.map(|light| light.0),
        draws: pass.draws.iter().map(summary).collect(),
        gpu_ms: None,
        snapshot,
    }
}
