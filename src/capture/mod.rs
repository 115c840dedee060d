//! The result of a frame as data: every attachment after every pass.
//!
//! A capture stands alone: it can be written to a folder and read back ([`disk`]) without a plan, a scene or a GPU, and
//! everything that examines frames (inspector, tests, history and reports) reads it. An aspect that a pass did not
//! change is shared with the step before. Where it was asked for, the draws of a pass have the state after each too
//! ([`DrawState`]).

mod adapter_profile;
pub mod disk;
mod enlarged;
mod error;
mod files;
mod image;
mod manifest;
mod map_projection;
mod npy;
mod profile_words;
mod step_tests;
mod store;
mod stored_quantity;
mod unprojection;

pub use adapter_profile::AdapterProfile;
pub use error::CaptureError;
pub use image::{Image, PixelFormat};
pub use map_projection::MapProjection;
pub use step_tests::{MOST_FRAGMENTS, StencilVerdict, StepTests, TestCounts};
pub use stored_quantity::StoredQuantity;
pub use unprojection::PixelUnprojection;

use crate::accuracy::{ErrorCounts, Finding, VisibilityError, WrongRegion};
use crate::plan::{AttachmentRole, CountOf, DecidedBy, DrawPart, LeftOut, LightId, RecordedPass};
use crate::truth::{LIT, SHADOW};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A frame with a snapshot after every pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Capture {
    /// Name of the scene.
    pub scene: String,
    /// Name of the technique.
    pub technique: String,
    /// Every setting of the technique.
    pub settings: BTreeMap<String, String>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The adapter that it ran on.
    pub adapter: AdapterInfo,
    /// What that adapter's rasteriser does; `None` where it was not measured.
    pub profile: Option<AdapterProfile>,
    /// The camera of the frame.
    pub camera: crate::scene::Camera,
    /// How the camera's distance became stored depth.
    pub depth: crate::math::depth::DepthCurve,
    /// A step for each pass, in order.
    pub steps: Vec<Step>,
    /// Parallel to the scene's lights.
    pub lights: Vec<CapturedLight>,
    /// Work that the scene did not need.
    pub left_out: Vec<LeftOut>,
    /// Times of the frame and of its capture.
    pub timing: Timing,
    /// The plan's stable text form; empty where it is not known.
    pub plan_text: String,
    /// The program and recorder that the frame comes from, if another program drew it.
    pub origin: Option<Origin>,
}

/// The program that drew a frame, and the recorder that recorded it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Origin {
    /// The program, where that is known.
    pub program: Option<String>,
    /// The graphics API that the program called: `OpenGL`.
    pub api: String,
    /// Format of its depth buffer: `D24S8`.
    pub depth_format: String,
    /// The program that recorded it: `RenderDoc 1.24`.
    pub recorder: String,
    /// What could not be read, in words.
    pub limits: Vec<String>,
}

/// The adapter that ran a frame.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct AdapterInfo {
    /// Name of the adapter, for example `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub name: String,
    /// Driver and version.
    pub driver: String,
    /// `cpu`, `integrated`, `discrete`, `virtual` or `other`.
    pub kind: String,
}

impl AdapterInfo {
    /// Returns the adapter in words: `llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe 22.3.6 (cpu)`.
    pub fn in_words(&self) -> String {
        let AdapterInfo { name, driver, kind } = self;
        format!("{name}, {driver} ({kind})")
    }
}

/// One pass and the state after it.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Short: `ambient`, `volumes`.
    pub name: String,
    /// One sentence that explains the pass to a learner.
    pub purpose: String,
    /// Index of the light that it belongs to; `None` for the scene's own passes.
    pub light: Option<usize>,
    /// Its draws, in order.
    pub draws: Vec<DrawSummary>,
    /// GPU time in milliseconds; `None` where the hardware can't measure it.
    pub gpu_ms: Option<f64>,
    /// The attachments after it.
    pub snapshot: Snapshot,
}

/// One draw of a step.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DrawSummary {
    /// Short: `sides of bunny`.
    pub name: String,
    /// The object that it shows, or whose shadow it draws.
    pub caster: Option<String>,
    /// Which part of the object or of its shadow it draws.
    #[serde(deserialize_with = "known_part")]
    pub part: DrawPart,
    /// Number of triangles submitted.
    pub triangles: u64,
    /// The state after it; `None` where only the state after its pass was captured.
    #[serde(skip)]
    pub after: Option<DrawState>,
    /// For a draw of another program that was recomputed from the state before it: how the result differs from what was
    /// stored; `None` where it was not recomputed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub differs: Option<RecomputeDifference>,
}

fn known_part<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<DrawPart, D::Error> {
    let unknown = |_| serde::de::Error::custom("it names a part of a draw that is not known");
    <DrawPart as serde::Deserialize>::deserialize(deserializer).map_err(unknown)
}

/// Numbers of pixels where a recomputed draw leaves something else than was stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub struct RecomputeDifference {
    /// Pixels whose depths differ by more than rounding explains: sixteen steps of their format, or of 24 bits.
    pub depth: u64,
    /// Pixels whose stencil values differ.
    pub stencil: u64,
    /// Pixels whose depths differ, by no more than rounding explains.
    pub rounded: u64,
}

/// What the attachments hold after one draw of a pass.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawState {
    /// The attachments, as after a step. An aspect that the draw did not change is shared with the draw before it, or
    /// with the step before for the first draw.
    pub snapshot: Snapshot,
    /// The pass's target where that is not the picture: labels, a count, or the layer of a map. The capture's light
    /// stores the last of them.
    pub target: Option<Aspect>,
}

/// The state after a step: three aspects of the picture, or a shadow map.
#[derive(Debug, Clone, PartialEq)]
pub enum Snapshot {
    /// After a pass that draws into the picture, or tests against its depth and stencil (a mask pass).
    Frame(FrameSnapshot),
    /// After a pass that draws one face of a light's shadow map.
    Map {
        /// Index of the light.
        light: usize,
        /// Index of the face that was drawn.
        face: usize,
    },
}

/// The picture's aspects after a step.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSnapshot {
    /// Colour in sRGB, 8 bits a channel.
    pub color: Aspect,
    /// Depth as stored in the buffer.
    pub depth: Aspect,
    /// Stencil, one byte a pixel; `None` where the technique uses no stencil buffer.
    pub stencil: Option<Aspect>,
    /// What the pass draws into.
    pub target: FrameTarget,
}

named_enum! {
    /// What a pass that tests against the picture's depth and stencil draws into.
    #[derive(Default)]
    pub enum FrameTarget {
        /// The picture itself.
        #[default]
        Picture = "picture",
        /// The light's labels ([`CapturedLight::shadow`]).
        Labels = "labels",
        /// The light's count ([`CapturedLight::count`]).
        Count = "count",
        /// Which share of the light arrives ([`CapturedLight::visibility`]).
        Visibility = "visibility",
    }
}

impl FrameTarget {
    /// Returns whether what is drawn into it only says what the technique finds, for comparing it: labels and
    /// visibility. (Labels that a light pass reads are part of the frame all the same.)
    pub fn is_beside(self) -> bool {
        matches!(self, FrameTarget::Labels | FrameTarget::Visibility)
    }

    /// Returns the target that an attachment of this role is, and its light; `None` for the picture and for maps.
    pub(crate) fn of(role: AttachmentRole) -> Option<(FrameTarget, LightId)> {
        match role {
            AttachmentRole::Labels(light) => Some((FrameTarget::Labels, light)),
            AttachmentRole::Count(light) => Some((FrameTarget::Count, light)),
            AttachmentRole::Visibility(light) => Some((FrameTarget::Visibility, light)),
            AttachmentRole::Color | AttachmentRole::DepthStencil | AttachmentRole::Map(_) => None,
        }
    }

    /// Returns the format of its images.
    pub fn format(self) -> PixelFormat {
        match self {
            FrameTarget::Picture => PixelFormat::Rgba8Srgb,
            FrameTarget::Labels => PixelFormat::U8,
            FrameTarget::Count | FrameTarget::Visibility => PixelFormat::Value32F,
        }
    }
}

/// What passes left in the targets of one light.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct LightTargets {
    /// As [`CapturedLight::shadow`].
    pub labels: Option<Arc<Image>>,
    /// As [`CapturedLight::count`].
    pub count: Option<Arc<Image>>,
    /// As [`CapturedLight::visibility`].
    pub visibility: Option<Arc<Image>>,
}

impl LightTargets {
    /// Returns where the image of a target is stored; `None` for the picture, which is of no light.
    pub fn get_mut(&mut self, target: FrameTarget) -> Option<&mut Option<Arc<Image>>> {
        match target {
            FrameTarget::Picture => None,
            FrameTarget::Labels => Some(&mut self.labels),
            FrameTarget::Count => Some(&mut self.count),
            FrameTarget::Visibility => Some(&mut self.visibility),
        }
    }
}

/// One aspect (colour, depth, stencil, labels or count) after a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Aspect {
    /// Its texels; shared with the step before where unchanged.
    pub image: Arc<Image>,
    /// True where the pass wrote nothing to it.
    pub unchanged: bool,
}

/// The results of a frame for one light.
#[derive(Debug, Clone, PartialEq)]
pub struct CapturedLight {
    /// Homogeneous world position: `w = 1` a point, `w = 0` the direction towards it. Zero where it is not known, in
    /// another program's frame.
    pub position: glam::DVec4,
    /// Where it is for the shadows of objects that have it elsewhere, by their names, in the frames of programs that give
    /// each model a light of its own.
    pub of_casters: BTreeMap<String, glam::DVec4>,
    /// What decided where its shadow is.
    pub decided_by: DecidedBy,
    /// What a count of its shadow volumes counts, where that is known.
    pub count_of: Option<CountOf>,
    /// The technique's labels, one byte a pixel: 0 lit, 1 in shadow, 2 background, 3 faces away from the light or
    /// beyond its range.
    pub shadow: Option<Arc<Image>>,
    /// How many shadow volumes contain the surface at each pixel, where they are counted in floats.
    pub count: Option<Arc<Image>>,
    /// Which share of it arrives at each pixel, from 0 (dark) to 1 (lit), where the technique knows shares: 0 where a
    /// surface faces away and where there is none.
    pub visibility: Option<Arc<Image>>,
    /// Its shadow map, or textures of the light that passes.
    pub map: Option<CapturedMap>,
    /// The ground truth, where it was asked for.
    pub truth: Option<CapturedTruth>,
}

impl Step {
    /// Returns whether it takes a light away where its stencil test passes, in another program's frame.
    pub fn darkens(&self) -> bool {
        self.light.is_some() && self.name == RecordedPass::DARKENING
    }
}

impl CapturedMap {
    /// Returns whether the map stores colours of light that passes, in place of depths.
    pub fn holds_colors(&self) -> bool {
        self.faces.first().is_some_and(|face| face.format() == PixelFormat::Rgba8)
    }
}

impl CapturedLight {
    /// Limit on the places that a light has for casters: rays are followed from each by themselves.
    pub const MOST_PLACES: usize = 1024;

    /// Returns the image of one of the light's targets; `None` where no pass writes it, and for the picture.
    pub fn target(&self, target: FrameTarget) -> Option<&Arc<Image>> {
        match target {
            FrameTarget::Picture => None,
            FrameTarget::Labels => self.shadow.as_ref(),
            FrameTarget::Count => self.count.as_ref(),
            FrameTarget::Visibility => self.visibility.as_ref(),
        }
    }

    /// Returns where the image of one of the light's targets is stored; `None` as for [`CapturedLight::target`].
    fn target_mut(&mut self, target: FrameTarget) -> Option<&mut Arc<Image>> {
        match target {
            FrameTarget::Picture => None,
            FrameTarget::Labels => self.shadow.as_mut(),
            FrameTarget::Count => self.count.as_mut(),
            FrameTarget::Visibility => self.visibility.as_mut(),
        }
    }

    /// Returns the number of pixels of surfaces that face the light whose count is a multiple of 256 other than 0,
    /// which eight bits read as 0; `None` where the count is not known.
    pub fn wrapped_pixels(&self) -> Option<u64> {
        let (count, labels) = (self.count.as_ref()?, self.shadow.as_ref()?);
        let counts = count.rows().flat_map(|row| row.chunks_exact(4)).map(bytemuck::pod_read_unaligned::<f32>);
        let faces_light = labels.rows().flatten().map(|label| [LIT, SHADOW].contains(label));
        let wraps = |(count, faces_light): &(f32, bool)| *faces_light && *count != 0.0 && count % 256.0 == 0.0;
        Some(counts.zip(faces_light).filter(wraps).count() as u64)
    }
}

/// The ground truth of a light, and the technique's errors.
#[derive(Debug, Clone, PartialEq)]
pub struct CapturedTruth {
    /// The truth's labels, one byte a pixel.
    pub labels: Arc<Image>,
    /// A [`Finding`] for each pixel.
    pub findings: Arc<Image>,
    /// Numbers of pixels by finding.
    pub error: ErrorCounts,
    /// The largest connected wrong region.
    pub worst: Option<WrongRegion>,
    /// The truth's visibility, and how far the technique's is from it, where the technique knows shares of the light.
    pub visibility: Option<VisibilityTruth>,
}

/// The true visibility of a light, and the technique's error.
#[derive(Debug, Clone, PartialEq)]
pub struct VisibilityTruth {
    /// 1 where the light arrives, 0 elsewhere, also where there is no surface.
    pub image: Arc<Image>,
    /// How far the technique's visibility is from it.
    pub error: VisibilityError,
}

/// The ground truth of a frame: computed for a capture, and added to it by [`Capture::with_truth`].
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTruth {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Parallel to the capture's lights; `None` where the technique has no labels.
    pub lights: Vec<Option<CapturedTruth>>,
    /// The signed count of each light's volumes, where the technique counts them in the stencil: eight bits read a
    /// count of 256 as none, which the truth alone would not explain.
    pub counts: Vec<Option<Arc<Image>>>,
}

/// The states after the draws of a step: captured later, and added to a capture by [`Capture::with_draws`].
#[derive(Debug, Clone, PartialEq)]
pub struct StepDraws {
    /// Index of the step.
    pub step: usize,
    /// The state after each of its draws; `None` where it is not known.
    pub states: Vec<Option<DrawState>>,
}

/// Bytes that a capture may take with the draws of several steps; beyond, those of other steps are dropped.
const MOST_DRAWS_BYTES: u64 = 1 << 27;

/// A light's shadow map, receiver textures or silhouettes as they are after the whole frame, with the matrices by which
/// they are read.
#[derive(Debug, Clone, PartialEq)]
pub struct CapturedMap {
    /// Depth as stored: one face, or six in wgpu's order (+x −x +y −y +z −z). Or the colour that each texture lets
    /// through.
    pub faces: Vec<Arc<Image>>,
    /// Name of the receiver or caster of each texture, as far as that is known; empty for a map of depths.
    pub layer_names: Vec<String>,
    /// Light space from world space.
    pub light_from_world: glam::DMat4,
    /// Clip space of each face from light space.
    pub clip_from_light: Vec<glam::DMat4>,
    /// What its texels hold: depth, but where another program's shader writes something else.
    pub quantity: StoredQuantity,
}

/// Times in milliseconds; medians. `None` where a time was not measured.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Timing {
    /// A frame without snapshots and mask passes: recording, submitting, waiting for the GPU.
    pub frame_ms: Option<f64>,
    /// The same frame with a snapshot after every pass, read back to memory; `None` too where the snapshots don't all
    /// fit in memory at once.
    pub captured_ms: Option<f64>,
    /// Writing the folder.
    pub write_ms: Option<f64>,
    /// Everything before the first frame: planning, geometry, pipelines, uploads.
    pub setup_ms: Option<f64>,
}

impl RecomputeDifference {
    /// Returns whether the draw leaves what was stored, except for rounding.
    pub fn is_nowhere(self) -> bool {
        self.depth == 0 && self.stencil == 0
    }
}

impl Capture {
    /// Returns what decides where a light's shadow is.
    pub fn decided_by(&self, light: usize) -> DecidedBy {
        self.lights.get(light).map_or(DecidedBy::Nothing, |light| light.decided_by)
    }

    /// Returns what the truth says of a light's label at pixel `at` (column, row); `None` where it is not known, or there is
    /// no such light or pixel.
    pub fn finding_at(&self, light: usize, at: [u32; 2]) -> Option<Finding> {
        Finding::from_byte(self.lights.get(light)?.truth.as_ref()?.findings.byte_at(at)?)
    }

    /// Returns whether shadow volumes are counted for any light.
    pub fn counts_volumes(&self) -> bool {
        self.lights.iter().any(|light| light.decided_by.counts_volumes())
    }

    /// Returns the picture's colour, depth and stencil after step `index`; for a pass into a map, those after the
    /// nearest earlier step that has them. `None` where there is no such step, or only map passes up to it.
    pub fn frame_at(&self, index: usize) -> Option<&FrameSnapshot> {
        let upto = self.steps.get(..=index)?;
        upto.iter().rev().find_map(|step| match &step.snapshot {
            Snapshot::Frame(frame) => Some(frame),
            Snapshot::Map { .. } => None,
        })
    }

    /// Returns the depth that the map of the light with this index stores where nothing was drawn: 0 where depth is
    /// reversed. Another program's map may have another direction than its picture: there the light's place and the map's
    /// view tell.
    pub fn map_clear_depth(&self, light: usize) -> f32 {
        let own = self.depth.mapping.clear_depth();
        let Some(CapturedLight { position, map: Some(map), .. }) = self.lights.get(light) else { return own };
        let views = || map.clip_from_light.iter().map(|clip| *clip * map.light_from_world);
        // Away from the light depth grows, or it falls where it is reversed.
        match views().map(|view| view.row(2).dot(*position)).find(|slope| *slope != 0.0) {
            Some(slope) if self.origin.is_some() => f32::from(u8::from(slope < 0.0)),
            None if self.origin.is_some() => 1.0,
            _ => own,
        }
    }

    /// Returns what counts of shadow volumes count, of all lights together; `None` where that is not known.
    pub fn count_of(&self) -> Option<CountOf> {
        let mut all = self.lights.iter().filter_map(|light| light.count_of);
        let first = all.next()?;
        Some(if all.all(|of| of == first) { first } else { CountOf::Mixed })
    }

    /// Returns whether the state after every draw of a step is known. It is for a step without draws.
    pub fn holds_draws(&self, step: usize) -> bool {
        self.steps.get(step).is_some_and(|step| step.draws.iter().all(|draw| draw.after.is_some()))
    }

    /// Returns the bytes of memory of all its images, padding included; shared memory counts once. It visits every
    /// image: call it once for each capture.
    pub fn bytes(&self) -> u64 {
        let mut seen = std::collections::BTreeSet::new();
        let mut places = Vec::new();
        self.for_each_image(|image| {
            if seen.insert(Arc::as_ptr(image)) {
                places.extend(image.memory());
            }
        });
        image::covered(places)
    }

    /// Returns the errors of all lights together; `None` where no truth was asked for.
    pub fn error(&self) -> Option<ErrorCounts> {
        let of_lights = self.lights.iter().map(|light| light.truth.as_ref().map(|truth| truth.error));
        (!self.lights.is_empty()).then(|| of_lights.sum()).flatten()
    }

    /// Returns how far the visibilities of all lights together are from the truth's; `None` where no truth was asked
    /// for, or the technique knows no shares of any light.
    pub fn visibility_error(&self) -> Option<VisibilityError> {
        let of_light = |light: &CapturedLight| Some(light.truth.as_ref()?.visibility.as_ref()?.error);
        VisibilityError::of_all(self.lights.iter().filter_map(of_light).collect())
    }

    /// Returns a copy with each light's truth replaced by that of `truth`, in order (also by `None`). A count of
    /// `truth` replaces the light's count; where it has none, the light's own stays.
    pub fn with_truth(&self, truth: &FrameTruth) -> Capture {
        let mut capture = self.clone();
        for (light, truth) in capture.lights.iter_mut().zip(&truth.lights) {
            light.truth.clone_from(truth);
        }
        for (light, count) in capture.lights.iter_mut().zip(&truth.counts) {
            light.count = count.clone().or(light.count.take());
        }
        capture
    }

    /// Returns the capture with the states after the draws of a step added. They may take much memory: where the
    /// capture would take more than 128 MiB, those of other steps are dropped, and have to be captured again.
    pub fn with_draws(&self, draws: &StepDraws) -> Capture {
        self.with_draws_in(draws, MOST_DRAWS_BYTES)
    }

    pub(crate) fn with_draws_in(&self, draws: &StepDraws, most: u64) -> Capture {
        let mut capture = self.clone();
        let is_recorded = capture.origin.is_some();
        let of_step = capture.steps.get_mut(draws.step).into_iter().flat_map(|step| &mut step.draws);
        for (draw, state) in of_step.zip(&draws.states) {
            // What another program's draw left stays what was stored, and is not what it comes to here.
            if draw.after.is_none() || !is_recorded {
                draw.after.clone_from(state);
            }
        }
        if capture.bytes() > most {
            let others = capture.steps.iter_mut().enumerate().filter(|(index, _)| *index != draws.step);
            others.flat_map(|(_, step)| &mut step.draws).for_each(|draw| draw.after = None);
        }
        capture
    }

    fn for_each_image(&self, mut visit: impl FnMut(&Arc<Image>)) {
        for step in &self.steps {
            step.snapshot.aspects().for_each(|aspect| visit(&aspect.image));
            let states = step.draws.iter().filter_map(|draw| draw.after.as_ref());
            states.flat_map(DrawState::aspects).for_each(|aspect| visit(&aspect.image));
        }
        for light in &self.lights {
            FrameTarget::ALL.into_iter().filter_map(|target| light.target(target)).for_each(&mut visit);
            light.map.iter().flat_map(|map| &map.faces).for_each(&mut visit);
            let truth = light.truth.iter();
            truth.clone().flat_map(|truth| [&truth.labels, &truth.findings]).for_each(&mut visit);
            truth.filter_map(|truth| truth.visibility.as_ref()).for_each(|visibility| visit(&visibility.image));
        }
    }
}

impl Snapshot {
    /// Returns colour, depth and, where there is one, stencil after the pass; nothing for a pass that draws into a
    /// light's map.
    pub fn aspects(&self) -> impl Iterator<Item = &Aspect> {
        let frame = match self {
            Snapshot::Frame(frame) => Some(frame),
            Snapshot::Map { .. } => None,
        };
        frame.into_iter().flat_map(|frame| [&frame.color, &frame.depth].into_iter().chain(&frame.stencil))
    }
}

impl DrawState {
    /// Returns the picture's aspects, and the pass's own target.
    pub fn aspects(&self) -> impl Iterator<Item = &Aspect> {
        self.snapshot.aspects().chain(&self.target)
    }

    /// Returns whether the draw changed nothing.
    pub fn changes_nothing(&self) -> bool {
        self.aspects().all(|aspect| aspect.unchanged)
    }
}

impl Step {
    /// Returns the number of triangles submitted.
    pub fn triangles(&self) -> u64 {
        self.draws.iter().map(|draw| draw.triangles).sum()
    }

    /// Returns the caster that all of the step's draws have in common; `None` where they differ, one has none, or there
    /// are no draws.
    pub fn caster(&self) -> Option<&str> {
        let first = self.draws.first()?.caster.as_deref()?;
        self.draws.iter().all(|draw| draw.caster.as_deref() == Some(first)).then_some(first)
    }
}
