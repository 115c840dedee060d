//! The ground truth as a technique: a picture made on the CPU by following rays.
//!
//! The GPU draws surfaces as for every other technique; each light's labels come from
//! [`Tracer`], and the light pass adds light where they say so. Sorting the scene for
//! the rays is set-up, as edge lists are; following them is part of the frame.

use super::PlanError;
use super::description::{ComparisonRole, ONE_ROW, TechniqueDescription};
use super::frame::{FrameBuilder, PlanRequest, StencilUse};
use super::lesson::{Lesson, cited};
use crate::plan::{ColorTarget, CpuImage, DecidedBy, FramePlan, LightId, MakeImage, Pass, ViewId, Visibility};
use crate::progress::Progress;
use crate::scene::Scene;
use crate::truth::Tracer;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// A CPU image of one light's labels, ray-traced anew each time the frame runs.
#[derive(Debug)]
struct LightLabels {
    tracer: Arc<Tracer>,
    light: LightId,
}

impl MakeImage for LightLabels {
    fn make(&self) -> Vec<u8> {
        let traced = self.tracer.trace_lights(&[self.light.0], &Progress::default());
        traced.and_then(|truth| truth.labels.into_iter().next()).unwrap_or_default()
    }
}

/// A CPU image of labels that were traced before; it traces no ray.
#[derive(Debug)]
struct KnownLabels(Vec<u8>);

impl MakeImage for KnownLabels {
    fn make(&self) -> Vec<u8> {
        self.0.clone()
    }
}

/// Describes `ray-traced` for commands, tables and the inspector.
pub(super) const DESCRIPTION: TechniqueDescription = TechniqueDescription {
    summary: "Follows rays from the eye and the light on the CPU: what the other techniques are measured against.",
    lesson: Lesson {
        text: "Rays are followed in double precision, every hit is decided by exact signs, and so no ray slips \
             through an edge. It knows the scene alone: no volume, plan or shader. The other techniques are \
             measured against it. A pixel counts as wrong where a technique differs from it, unless the truth \
             itself changes within an eighth of a pixel, or another triangle is visible within the step that \
             the rasteriser snaps corners to (1/256 on most).\n\
             \n\
             The naive test of shadow volumes asks the same of a pixel at a time: is its point in the volume of any \
             caster? For p pixels and t casting triangles that is p t tests; here a tree of the triangles leaves about p \
             log t, and a stencil that counts volumes asks for all pixels at once, as it draws.\n\
             \n\
             Where a light is wholly hidden is its umbra, where it is hidden in part its penumbra. All lights here are \
             points or suns, which are seen or not, so that every shadow is umbra alone and has a sharp edge.",
        formula: "light is added where no casting triangle meets the segment from the light to the surface; naively p t \
             tests, with a tree about p log t",
        sources: &[cited::APPEL, cited::WHITTED, cited::SHEWCHUK],
    },
    plan,
    report_rows: ONE_ROW,
    standing: ComparisonRole::Apart { because: "it is the truth" },
};

/// How the stencil is used: always, to light each pixel once. Other techniques are measured against these colours, so
/// no receiver may be lit twice, not even where two surfaces overlap in one plane.
const LIT_ONCE: StencilUse = StencilUse::Always;

/// Plans a frame whose shadows are ray-traced on the CPU. Fails too where the scene can't be traced.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let (scene, size) = (job.scene, job.size);
    let frame = FrameBuilder::new(job, LIT_ONCE)?;
    let tracer = Tracer::new(scene, size).map_err(|error| PlanError::Unusable { problem: error.to_string() })?;
    let tracer = Arc::new(tracer);
    Ok(lit_by(frame, |light| Arc::new(LightLabels { tracer: tracer.clone(), light })))
}

/// Plans the ray-traced frame of labels that are known: `labels` has a list for each light, with a byte for each pixel,
/// row by row. Traces no ray.
pub fn plan_of_labels(job: PlanRequest, labels: &[Vec<u8>]) -> Result<FramePlan, PlanError> {
    let frame = FrameBuilder::new(job, LIT_ONCE)?;
    let known = |light: LightId| labels.get(light.0).cloned().unwrap_or_default();
    Ok(lit_by(frame, |light| Arc::new(KnownLabels(known(light)))))
}

/// Returns a plan that draws the surfaces in ambient light and adds each light at the pixels that its image of labels
/// calls lit.
fn lit_by(mut frame: FrameBuilder, labels: impl Fn(LightId) -> Arc<dyn MakeImage>) -> FramePlan {
    frame.ambient_pass();
    for light in frame.light_ids() {
        frame.plan.lights[light.0].decided_by = DecidedBy::Labels;
        ray_pass(&mut frame, light, labels(light));
        let purpose = "Adds the light where its rays arrived, nothing elsewhere, and raises the stencil at all of \
                       these pixels, so that none is lit twice.";
        frame.light_pass(light, purpose, &frame.light_by(Visibility::Labels));
    }
    frame.finish()
}

fn ray_pass(frame: &mut FrameBuilder, light: LightId, source: Arc<dyn MakeImage>) {
    let attachment = frame.plan.lights[light.0].labels;
    let content = content_hash(frame.job.scene, light);
    frame.plan.passes.push(Pass {
        scissor: None,
        name: "rays".to_owned(),
        purpose: "Follows a ray from the eye through every pixel to the surface it meets, and one from the light to \
                  that point: whatever lies between keeps the light away. This is done on the CPU."
            .to_owned(),
        light: Some(light),
        timed: true,
        view: ViewId(0),
        color: Some(ColorTarget { attachment, layer: 0, clear: None }),
        depth_stencil: None,
        draws: Vec::new(),
        image: Some(CpuImage { name: format!("rays of {}", light.name()), content, source }),
        viewport: None,
        recorded: None,
    });
}

/// Returns a hash of what a light's labels depend on: the camera, the light's position and every object's mesh, pose
/// and flags.
fn content_hash(scene: &Scene, light: LightId) -> u64 {
    let mut hasher = DefaultHasher::new();
    format!("{:?} {:?}", scene.camera, scene.lights[light.0].position).hash(&mut hasher);
    for object in &scene.objects {
        let flags = [object.casts, object.receives, object.visible];
        (object.mesh.content_hash(), format!("{:?}", object.pose), flags).hash(&mut hasher);
    }
    hasher.finish()
}
