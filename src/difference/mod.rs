//! What differs between two frames, pass by pass: from two [`Capture`]s, without a GPU.
//!
//! Passes are matched by name and light, in order. Of each pair every aspect is compared bit by bit: colour, depth,
//! stencil, what the pass draws into elsewhere (labels, a count, a face of a map), and the states after its draws where
//! both captures have them. After the passes come the lights: final labels, and what no pass shows. What was asked for
//! (technique, settings, plan, adapter) is reported, but makes no difference of its own.
//!
//! A count or a face of a map is stored as the frame left it, so a difference in it is reported at the first pass that
//! draws into it, even if a later one caused it.

mod align;
mod images;
mod json;
mod notes;
mod picture;
mod text;

pub use images::{DifferingRegion, PixelDifference, Texel, TexelDifference};
pub use notes::DifferenceNote;
pub use picture::ShownDifference;

use crate::capture::{Capture, CapturedLight, DrawState, FrameTarget, Image, PixelFormat, Snapshot, Step};
use align::{AlignedPair, align};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Why two captures can't be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DifferenceError {
    /// The pictures have different sizes, so that pixels have no partners.
    #[error(
        "the pictures are {}x{} and {}x{} pixels: capture both with one --size", sizes[0][0], sizes[0][1], sizes[1][0], sizes[1][1]
    )]
    Sizes {
        /// Width and height of each, pixels.
        sizes: [[u32; 2]; 2],
    },
}

named_enum! {
    /// Which of the two captures.
    pub enum ComparedSide {
        /// The first.
        A = "A",
        /// The second.
        B = "B",
    }
}

/// The result of comparing two captures, A and B: what was asked for differently, and every pass and light with what
/// differs in it (also those that are the same).
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Scene, technique and settings of each frame.
    pub sides: [ComparedFrame; 2],
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// What was asked for differently; this makes no difference by itself.
    pub asked: Vec<DifferenceNote>,
    /// Differences that change the meaning of pixels: camera, lights, how depth is stored.
    pub conditions: Vec<DifferenceNote>,
    /// Passes in their common order.
    pub passes: Vec<PassDifference>,
    /// Differences of lights, parallel to the lights that both have.
    pub lights: Vec<LightDifference>,
}

/// Scene, technique and settings of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ComparedFrame {
    /// Name of the scene.
    pub scene: String,
    /// Name of the technique.
    pub technique: String,
    /// Its settings.
    pub settings: BTreeMap<String, String>,
}

/// A pass of both frames, or of one.
#[derive(Debug, Clone, PartialEq)]
pub struct PassDifference {
    /// Short: `volumes`.
    pub name: String,
    /// Index of the light that it belongs to.
    pub light: Option<usize>,
    /// Its index in each frame; at least one has it.
    pub index: [Option<usize>; 2],
    /// Aspects that differ after it; empty where only one frame has it.
    pub aspects: Vec<AspectDifference>,
    /// Draws after which something differs, where both captures have the states after draws.
    pub draws: Vec<DrawDifference>,
}

/// A draw of both frames.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawDifference {
    /// Short: `sides of bunny`.
    pub name: String,
    /// Its index within the pass, in each.
    pub index: [usize; 2],
    /// Aspects that differ after it.
    pub aspects: Vec<AspectDifference>,
}

/// An aspect (colour, depth, stencil, labels, a map…) that differs after a pass, a draw or the whole frame.
#[derive(Debug, Clone, PartialEq)]
pub struct AspectDifference {
    /// The aspect.
    pub aspect: AspectKind,
    /// How it differs.
    pub found: AspectChange,
    /// True where neither pass wrote to it: the difference is an earlier one's.
    pub carried: bool,
}

/// How an aspect differs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AspectChange {
    /// Texels differ.
    Pixels(PixelDifference),
    /// Only one frame has it.
    OnlyIn(ComparedSide),
    /// Maps of different sizes, whose texels have no partners.
    Sizes([[u32; 2]; 2]),
}

/// A kind of picture that can differ after a pass, or for a light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AspectKind {
    /// The picture, sRGB.
    Color,
    /// Depth as stored.
    Depth,
    /// The stencil buffer.
    Stencil,
    /// A light's labels.
    Labels,
    /// A light's count, in floats.
    Count,
    /// Which share of a light arrives.
    Visibility,
    /// Face of a light's shadow map, by its index.
    Map(usize),
    /// Layer of the textures of light that passes, by its index.
    Textures(usize),
    /// Ground truth of a light's labels.
    Truth,
    /// Ground truth of which share of a light arrives.
    TruthVisibility,
    /// Findings of labels compared with the truth.
    Findings,
}

/// What differs for a light at the end of the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct LightDifference {
    /// Index of the light.
    pub light: usize,
    /// Numbers of pixels by their label in the first and in the second frame, where these differ.
    pub labels: BTreeMap<[u8; 2], u64>,
    /// Its pictures that differ.
    pub aspects: Vec<AspectDifference>,
}

/// Compares two captures of one size, pass by pass and light by light. Passes are matched by name and light, lights by
/// index; lights that only one has are not compared, only their number is.
pub fn compare(a: &Capture, b: &Capture) -> Result<Difference, DifferenceError> {
    if a.size != b.size {
        return Err(DifferenceError::Sizes { sizes: [a.size, b.size] });
    }
    let mut pictures = ImageComparisons::default();
    let key = |step: &Step| (step.name.clone(), step.light);
    let keys = [a, b].map(|capture| capture.steps.iter().map(key).collect::<Vec<_>>());
    let pairs = align(&keys[0], &keys[1]);
    let lights = a.lights.iter().zip(&b.lights).enumerate();
    Ok(Difference {
        sides: [a, b].map(ComparedFrame::of),
        size: a.size,
        asked: notes::asked(a, b),
        conditions: notes::conditions(a, b),
        passes: pairs.into_iter().map(|pair| pass(&mut pictures, [a, b], pair)).collect(),
        lights: lights.map(|(light, (a, b))| of_light(&mut pictures, light, a, b)).collect(),
    })
}

/// Returns how many texels of two pictures differ, bit by bit; `None` where they are of other formats or sizes.
pub fn differing_texels(a: &Image, b: &Image) -> Option<u64> {
    if (a.format(), a.size()) != (b.format(), b.size()) {
        return None;
    }
    let texel = a.format().texel_bytes();
    let differing = |(a, b): (&[u8], &[u8])| {
        let pairs = a.chunks_exact(texel).zip(b.chunks_exact(texel));
        if a == b { 0 } else { pairs.filter(|(a, b)| a != b).count() as u64 }
    };
    Some(a.rows().zip(b.rows()).map(differing).sum())
}

impl Difference {
    /// Returns whether every pass and every pixel of both is the same, and camera and lights too.
    pub fn is_none(&self) -> bool {
        self.conditions.is_empty() && self.first().is_none() && self.lights.iter().all(|light| light.aspects.is_empty())
    }

    /// Returns the first pass, in the common order, after which anything differs or that only one frame has; `None`
    /// where there is none (lights may differ all the same).
    pub fn first(&self) -> Option<&PassDifference> {
        self.passes.iter().find(|pass| pass.differs())
    }

    /// Returns the first pass after which, or after one of whose draws, texels differ; passes and aspects that only one
    /// frame has don't count. `None` where there is none.
    pub fn first_in_pixels(&self) -> Option<&PassDifference> {
        self.passes.iter().find(|pass| pass.states().flatten().any(|aspect| aspect.pixels().is_some()))
    }
}

impl ComparedFrame {
    fn of(capture: &Capture) -> ComparedFrame {
        let (scene, technique) = (capture.scene.clone(), capture.technique.clone());
        ComparedFrame { scene, technique, settings: capture.settings.clone() }
    }
}

impl PassDifference {
    /// Returns whether an aspect differs after the pass or one of its draws, or only one frame has the pass.
    pub fn differs(&self) -> bool {
        self.only_in().is_some() || self.states().any(|aspects| !aspects.is_empty())
    }

    /// Returns the only frame that has the pass; `None` where both do.
    pub fn only_in(&self) -> Option<ComparedSide> {
        match self.index {
            [Some(_), None] => Some(ComparedSide::A),
            [None, Some(_)] => Some(ComparedSide::B),
            _ => None,
        }
    }

    /// Returns what differs after the pass, then after each draw.
    fn states(&self) -> impl Iterator<Item = &Vec<AspectDifference>> {
        std::iter::once(&self.aspects).chain(self.draws.iter().map(|draw| &draw.aspects))
    }
}

impl AspectDifference {
    /// Returns which texels differ; `None` where only one frame has the aspect, or the sizes differ.
    pub fn pixels(&self) -> Option<&PixelDifference> {
        match &self.found {
            AspectChange::Pixels(pixels) => Some(pixels),
            AspectChange::OnlyIn(_) | AspectChange::Sizes(_) => None,
        }
    }
}

impl AspectKind {
    /// Returns the kind of a light's target; `None` for the picture, which has three.
    fn of_target(target: FrameTarget) -> Option<AspectKind> {
        match target {
            FrameTarget::Picture => None,
            FrameTarget::Labels => Some(AspectKind::Labels),
            FrameTarget::Count => Some(AspectKind::Count),
            FrameTarget::Visibility => Some(AspectKind::Visibility),
        }
    }

    /// Returns its name in JSON, without the face or layer.
    pub fn name(self) -> &'static str {
        match self {
            AspectKind::Color => "color",
            AspectKind::Depth => "depth",
            AspectKind::Stencil => "stencil",
            AspectKind::Labels => "labels",
            AspectKind::Count => "count",
            AspectKind::Visibility => "visibility",
            AspectKind::Map(_) => "map",
            AspectKind::Textures(_) => "textures",
            AspectKind::Truth => "truth",
            AspectKind::TruthVisibility => "truth-visibility",
            AspectKind::Findings => "findings",
        }
    }

    /// Returns whether values have distances from each other. Labels and findings don't.
    pub fn has_distances(self) -> bool {
        !matches!(self, AspectKind::Labels | AspectKind::Truth | AspectKind::Findings)
    }

    /// Returns the index of the map's face, or of the textures' layer; `None` for other aspects.
    pub fn layer(self) -> Option<usize> {
        match self {
            AspectKind::Map(layer) | AspectKind::Textures(layer) => Some(layer),
            _ => None,
        }
    }
}

/// The pictures of one state, each with whether it is an earlier one's.
type ComparedState<'a> = BTreeMap<AspectKind, (&'a Arc<Image>, bool)>;

/// Comparisons by the pictures' addresses: pictures that passes share are compared once.
#[derive(Default)]
struct ImageComparisons(BTreeMap<[*const Image; 2], Option<AspectChange>>);

impl ImageComparisons {
    fn compare(&mut self, a: &Arc<Image>, b: &Arc<Image>) -> Option<AspectChange> {
        let compared = || {
            let sizes = [a.size(), b.size()];
            if sizes[0] == sizes[1] {
                images::compare(a, b).map(AspectChange::Pixels)
            } else {
                Some(AspectChange::Sizes(sizes))
            }
        };
        *self.0.entry([Arc::as_ptr(a), Arc::as_ptr(b)]).or_insert_with(compared)
    }

    /// Returns the aspects that differ between two states, in the order of [`AspectKind`]: differing texels or sizes,
    /// and those that only one state has. Empty where all are the same.
    fn states(&mut self, a: &ComparedState, b: &ComparedState) -> Vec<AspectDifference> {
        let mut kinds: Vec<AspectKind> = a.keys().chain(b.keys()).copied().collect();
        kinds.sort_unstable();
        kinds.dedup();
        let one = |aspect: AspectKind| {
            let (found, carried) = match (a.get(&aspect), b.get(&aspect)) {
                (Some((in_a, carried_a)), Some((in_b, carried_b))) => {
                    (self.compare(in_a, in_b)?, *carried_a && *carried_b)
                }
                (Some((_, carried)), None) => (AspectChange::OnlyIn(ComparedSide::A), *carried),
                (None, Some((_, carried))) => (AspectChange::OnlyIn(ComparedSide::B), *carried),
                (None, None) => return None,
            };
            Some(AspectDifference { aspect, found, carried })
        };
        kinds.into_iter().filter_map(one).collect()
    }
}

fn pass(pictures: &mut ImageComparisons, [a, b]: [&Capture; 2], pair: AlignedPair) -> PassDifference {
    let alone = |step: &Step, index| PassDifference {
        name: step.name.clone(),
        light: step.light,
        index,
        aspects: Vec::new(),
        draws: Vec::new(),
    };
    match pair {
        AlignedPair::First(in_a) => alone(&a.steps[in_a], [Some(in_a), None]),
        AlignedPair::Second(in_b) => alone(&b.steps[in_b], [None, Some(in_b)]),
        AlignedPair::Both(in_a, in_b) => {
            let (step_a, step_b) = (&a.steps[in_a], &b.steps[in_b]);
            PassDifference {
                aspects: pictures.states(&after_step(a, step_a), &after_step(b, step_b)),
                draws: if a.holds_draws(in_a) && b.holds_draws(in_b) {
                    draws(pictures, step_a, step_b)
                } else {
                    Vec::new()
                },
                ..alone(step_a, [Some(in_a), Some(in_b)])
            }
        }
    }
}

/// Compares the states after the draws of two steps, matched by name, caster and part, and returns those that differ.
/// Draws of only one step, or without a captured state, are left out.
fn draws(pictures: &mut ImageComparisons, a: &Step, b: &Step) -> Vec<DrawDifference> {
    let keys = |step: &Step| {
        step.draws.iter().map(|draw| (draw.name.clone(), draw.caster.clone(), draw.part)).collect::<Vec<_>>()
    };
    let mut differing = Vec::new();
    for pair in align(&keys(a), &keys(b)) {
        let AlignedPair::Both(in_a, in_b) = pair else { continue };
        let (draw_a, draw_b) = (&a.draws[in_a], &b.draws[in_b]);
        let (Some(after_a), Some(after_b)) = (&draw_a.after, &draw_b.after) else { continue };
        let aspects = pictures.states(&after_draw(a, after_a), &after_draw(b, after_b));
        if !aspects.is_empty() {
            differing.push(DrawDifference { name: draw_a.name.clone(), index: [in_a, in_b], aspects });
        }
    }
    differing
}

fn after_step<'a>(capture: &'a Capture, step: &'a Step) -> ComparedState<'a> {
    let mut state = of_snapshot(&step.snapshot);
    match &step.snapshot {
        Snapshot::Frame(frame) => {
            let light = step.light.and_then(|light| capture.lights.get(light));
            let kind = AspectKind::of_target(frame.target);
            let image = light.and_then(|light| light.target(frame.target));
            state.extend(kind.zip(image).map(|(kind, image)| (kind, (image, false))));
        }
        Snapshot::Map { light, face } => {
            let map = capture.lights.get(*light).and_then(|light| light.map.as_ref());
            let image = map.and_then(|map| map.faces.get(*face));
            state.extend(image.map(|image| (layer(image, *face), (image, false))));
        }
    }
    state
}

fn after_draw<'a>(step: &Step, after: &'a DrawState) -> ComparedState<'a> {
    let mut state = of_snapshot(&after.snapshot);
    let kind = |image: &Image| match &step.snapshot {
        Snapshot::Map { face, .. } => Some(layer(image, *face)),
        Snapshot::Frame(frame) => AspectKind::of_target(frame.target),
    };
    let target = after.target.iter().filter_map(|target| Some((kind(&target.image)?, target)));
    state.extend(target.map(|(kind, target)| (kind, (&target.image, target.unchanged))));
    state
}

/// Returns colour, depth and, where there is one, stencil of a pass's snapshot, each with whether the pass left it
/// unchanged; nothing for a pass into a map.
fn of_snapshot(snapshot: &Snapshot) -> ComparedState<'_> {
    let Snapshot::Frame(frame) = snapshot else { return ComparedState::new() };
    let stencil = frame.stencil.as_ref().map(|stencil| (AspectKind::Stencil, stencil));
    let aspects = [(AspectKind::Color, &frame.color), (AspectKind::Depth, &frame.depth)].into_iter().chain(stencil);
    aspects.map(|(kind, aspect)| (kind, (&aspect.image, aspect.unchanged))).collect()
}

/// Returns the kind of a layer of a map, which has depths or colours.
fn layer(image: &Image, index: usize) -> AspectKind {
    if image.format() == PixelFormat::Rgba8 { AspectKind::Textures(index) } else { AspectKind::Map(index) }
}

/// Compares what a light has at the end of the frame: labels, count, map, truth and findings. Label changes are counted
/// only where both have labels.
fn of_light(pictures: &mut ImageComparisons, light: usize, a: &CapturedLight, b: &CapturedLight) -> LightDifference {
    let labels = match (&a.shadow, &b.shadow) {
        (Some(in_a), Some(in_b)) => changes(in_a, in_b),
        _ => BTreeMap::new(),
    };
    LightDifference { light, labels, aspects: pictures.states(&at_the_end(a), &at_the_end(b)) }
}

fn at_the_end(light: &CapturedLight) -> ComparedState<'_> {
    let mut state = ComparedState::new();
    let targets =
        FrameTarget::ALL.into_iter().filter_map(|target| AspectKind::of_target(target).zip(light.target(target)));
    state.extend(targets.map(|(kind, image)| (kind, (image, false))));
    let faces = light.map.iter().flat_map(|map| map.faces.iter().enumerate());
    state.extend(faces.map(|(index, image)| (layer(image, index), (image, false))));
    if let Some(truth) = &light.truth {
        state.insert(AspectKind::Truth, (&truth.labels, false));
        let visibility = truth.visibility.iter().map(|visibility| (&visibility.image, false));
        state.extend(visibility.map(|image| (AspectKind::TruthVisibility, image)));
        state.insert(AspectKind::Findings, (&truth.findings, false));
    }
    state
}

/// Counts pixels by their pair of labels in both pictures of one size; pixels with equal labels are not counted.
fn changes(a: &Image, b: &Image) -> BTreeMap<[u8; 2], u64> {
    let mut counts = BTreeMap::new();
    let pairs = a.rows().flatten().zip(b.rows().flatten());
    pairs.filter(|(a, b)| a != b).for_each(|(a, b)| *counts.entry([*a, *b]).or_default() += 1);
    counts
}
