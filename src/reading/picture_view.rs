//! Which picture is shown and how: its kind, the meaning of a texel's value, zoom and position.
//!
//! A capture contains up to ten kinds of picture. [`PictureView::shown`] finds the chosen kind at a step, or what is
//! shown while there is none; where none is chosen, it follows the steps and shows what each writes ([`written`]).
//! Truth and error may be chosen before they are computed: until then those of the previous frame stay, or else the
//! picture before them.

use crate::capture::{
    Capture, CapturedLight, CapturedTruth, FrameTarget, FrameTruth, Image, PixelFormat, Snapshot, StepTests,
};
use crate::reading::capture_point::CapturePoint;
use crate::reading::depth::DepthMeasure;
use crate::reading::format;
use crate::reading::layers::{self, MapContent, MapLayer};
use std::sync::Arc;

named_enum! {
    /// A kind of picture that a capture may contain, in the order of their buttons: kinds that only some frames have
    /// come last.
    pub enum PictureKind(
        /// What the picture shows, whatever a light's map stores.
        meaning
    ) {
        /// The colour of the visible surfaces.
        Color = "Colour" ("The picture so far"),
        /// The stencil buffer: counts and marks.
        Stencil = "Stencil" ("The stencil count of every pixel"),
        /// The depth buffer: how far surfaces are from the camera.
        Depth = "Depth" ("How far the surface at every pixel is"),
        /// The technique's labels for one light: lit, in shadow, facing away.
        Mask = "Mask" ("Where the technique says that a light is blocked"),
        /// The ray-traced labels for one light.
        Truth = "Truth" ("Where rays say that a light is blocked"),
        /// Where the technique's labels differ from the ray-traced ones.
        Error = "Error" ("Where the technique and the truth differ"),
        /// How many fragments of the step reached each pixel.
        Overdraw = "Overdraw" ("How many fragments of the selected step reached every pixel"),
        /// Which share of a light arrives, where the technique knows shares.
        Visibility = "Visibility" ("Which share of a light arrives at every pixel"),
        /// A light's signed counts, where they are not in the stencil.
        Count = "Count" ("How many shadow volumes of a light contain the surface at every pixel"),
        /// A light's map: depth as the light sees it, or the light that casters let through.
        Map = "Map" ("What a light sees"),
    }
}

impl PictureKind {
    /// Returns whether this kind of picture has a state before and after each step: colour, stencil and depth do.
    pub fn has_phases(self) -> bool {
        matches!(self, PictureKind::Color | PictureKind::Stencil | PictureKind::Depth)
    }

    /// Returns the text on the kind's button, and the button's explanation; a map's depend on what the capture's maps
    /// store.
    pub fn label(self, capture: &Capture) -> [&'static str; 2] {
        match self {
            PictureKind::Map => {
                let content = MapContent::of_capture(capture).unwrap_or(MapContent::Depth);
                [content.name(), content.meaning()]
            }
            other => [other.name(), other.meaning()],
        }
    }

    /// Returns whether only some frames have this kind: those with float counts, with shares of a light, or
    /// with a light's map.
    pub fn is_of_some_frames(self) -> bool {
        matches!(self, PictureKind::Visibility | PictureKind::Count | PictureKind::Map)
    }

    /// Returns a sentence on why a step has no picture of this kind; call it only where that is so.
    pub fn why_missing(self, capture: &Capture) -> &'static str {
        match self {
            PictureKind::Stencil if !has_stencil(capture) => "This frame has no stencil buffer",
            PictureKind::Color | PictureKind::Stencil | PictureKind::Depth => {
                "Nothing is drawn into the picture yet at this step"
            }
            PictureKind::Overdraw => "This step draws nothing into the picture",
            _ => "This frame says of no light where it is blocked",
        }
    }

    /// Returns whether it can be shown only once the ray-traced truth is known.
    pub fn needs_truth(self) -> bool {
        matches!(self, PictureKind::Truth | PictureKind::Error)
    }
}

/// Which layers of a light's map are shown: all side by side, or one. One whose index is too large shows all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FaceChoice {
    /// All layers, side by side.
    #[default]
    Grid,
    /// The layer with this index.
    One(usize),
}

/// The size of a texel on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TexelZoom {
    /// So large that the whole picture fills its panel.
    #[default]
    Fit,
    /// Screen pixels for each texel.
    Pixels(f32),
}

/// The unit in which depth is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthMode {
    /// As a distance in metres.
    #[default]
    Linear,
    /// The stored value.
    Raw,
}

/// What the user chose to see in a picture panel, and how: kind, light, layer, zoom and range.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureView {
    /// The chosen kind; `None` follows what each step writes.
    pub kind: Option<PictureKind>,
    /// Index of the light whose mask or map is shown.
    pub light: usize,
    /// The shown layer of a map.
    pub face: FaceChoice,
    /// Size of a texel.
    pub zoom: TexelZoom,
    /// The position in texels at the panel's middle, where the picture does not fit.
    pub center: [f64; 2],
    /// Whether depth is shown as a distance or as the stored value.
    pub depth_mode: DepthMode,
    /// The ends of the grey ramp as the user set them, in the unit of the depth mode; `None` uses the picture's own
    /// range.
    pub depth_range: Option<[f64; 2]>,
    /// The counts of a step's tested fragments, for the overdraw picture.
    pub tests: Option<Arc<StepTests>>,
    /// The kind that was chosen before the truth; it is shown until the truth is known.
    kind_before_truth: Option<PictureKind>,
    /// The truth of the previous frame, shown until this frame's is known.
    pub older_truth: Option<Arc<FrameTruth>>,
}

impl Default for PictureView {
    fn default() -> PictureView {
        PictureView {
            kind: None,
            light: 0,
            face: FaceChoice::Grid,
            zoom: TexelZoom::Fit,
            center: [0.0; 2],
            depth_mode: DepthMode::Linear,
            depth_range: None,
            tests: None,
            kind_before_truth: None,
            older_truth: None,
        }
    }
}

/// A picture of the capture that is ready to be drawn, with its title and unit.
#[derive(Debug, Clone)]
pub struct ShownPicture {
    /// Its kind: the chosen one, or the one that is shown instead.
    pub kind: PictureKind,
    /// One picture, or all layers of a light's map.
    pub images: Vec<Arc<Image>>,
    /// The layer that each image is, for a light's map; else empty.
    pub layers: Vec<MapLayer>,
    /// How its depths are converted; [`DepthMeasure::Raw`] for other kinds.
    pub measure: DepthMeasure,
    /// The text for the status bar: `stencil after step 4`.
    pub title: String,
    /// The texture format on the GPU; of depths that are floored, to how many bits.
    pub format: String,
    /// Whether it belongs to the previous frame, as this frame's truth is not known yet.
    pub is_older: bool,
}

impl PictureView {
    /// Chooses the kind of picture to show. A kind that needs the truth remembers the one before, which is shown
    /// meanwhile; another kind resets the range of depths, and one without truth drops an older truth.
    pub fn choose(&mut self, kind: PictureKind) {
        if kind.needs_truth() && !self.wants_truth() {
            self.kind_before_truth = self.kind;
        }
        self.wish(Some(kind));
    }

    /// Makes the view follow what each step writes.
    pub fn follow_steps(&mut self) {
        self.wish(None);
    }

    fn wish(&mut self, kind: Option<PictureKind>) {
        if !kind.is_some_and(PictureKind::needs_truth) {
            self.older_truth = None;
        }
        if kind != self.kind {
            self.depth_range = None;
        }
        self.kind = kind;
    }

    /// Returns whether the chosen kind can be shown only once the ray-traced truth is known.
    pub fn wants_truth(&self) -> bool {
        self.kind.is_some_and(PictureKind::needs_truth)
    }

    /// Selects the light of a step (the one so far stays where it has none), and the layer of the map that the step
    /// draws, if the map has several; for other steps, all layers, unless the map is the chosen kind.
    pub fn follow(&mut self, capture: &Capture, step: usize) {
        match capture.steps.get(step).map(|step| &step.snapshot) {
            Some(Snapshot::Map { light, face }) => {
                self.light = *light;
                let map = capture.lights.get(*light).and_then(|light| light.map.as_ref());
                if map.is_some_and(|map| map.faces.len() > 1) {
                    self.face = FaceChoice::One(*face);
                }
            }
            _ => {
                if self.kind != Some(PictureKind::Map) {
                    self.face = FaceChoice::Grid;
                }
                if let Some(light) = capture.steps.get(step).and_then(|step| step.light) {
                    self.light = light;
                }
            }
        }
    }

    /// Returns the picture to show at a point of the frame: of the chosen kind, or of the one that stands in for it
    /// ([`PictureView::kind_at`]); `None` where there is no picture.
    pub fn shown(&self, capture: &Capture, at: impl Into<CapturePoint>) -> Option<ShownPicture> {
        let at = at.into();
        self.shown_as(capture, at, self.kind_at(capture, at)?)
    }

    /// Returns the kind of picture that is shown at a point of the frame: the chosen one (while the truth is not known,
    /// the one before it); else stencil for count and the reverse; else what the step writes; else the first that
    /// exists and needs no truth. `None` where none exists.
    pub fn kind_at(&self, capture: &Capture, at: CapturePoint) -> Option<PictureKind> {
        let kinds = available(capture, at);
        let lacks_truth = self.wants_truth() && self.truth_to_show(capture).is_none();
        let wished = if lacks_truth { self.kind_before_truth } else { self.kind };
        let twin = match wished {
            Some(PictureKind::Stencil) => Some(PictureKind::Count),
            Some(PictureKind::Count) => Some(PictureKind::Stencil),
            _ => None,
        };
        let can_show = |kind: &PictureKind| {
            kinds.contains(kind) && (*kind != PictureKind::Overdraw || self.tests_of(at).is_some())
        };
        let mut wishes = [wished, twin, written(capture, at.step)].into_iter().flatten();
        wishes.find(can_show).or_else(|| kinds.iter().copied().find(|kind| !kind.needs_truth()))
    }

    /// Returns the picture of this kind at a point of the frame, for the chosen light and layer, or the first light
    /// that has one; `None` where it does not exist.
    pub fn shown_as(&self, capture: &Capture, at: CapturePoint, kind: PictureKind) -> Option<ShownPicture> {
        let frame = at.frame(capture);
        let after = |what: &str| format!("{what} after {}", at.words(capture));
        let depth_format = if has_stencil(capture) { "Depth32FloatStencil8" } else { "Depth32Float" };
        let floored = floored(depth_format, capture);
        let raw = DepthMeasure::Raw;
        let camera = || self.measure_or_raw(Some(DepthMeasure::of_camera(capture)));
        let (image, measure, title, format) = match kind {
            PictureKind::Color => (frame?.color.image.clone(), raw, after("colour"), "Rgba8UnormSrgb"),
            PictureKind::Stencil => (frame?.stencil.as_ref()?.image.clone(), raw, after("stencil"), depth_format),
            PictureKind::Depth => (frame?.depth.image.clone(), camera(), after("depth"), &*floored),
            PictureKind::Count => {
                let light = self.light_with(capture, |light| light.count.is_some())?;
                let title = format!("count of {}", format::light(light));
                match at.count(capture).filter(|(of, _)| *of == light) {
                    Some((_, image)) => (image.clone(), raw, after(&title), "R32Float"),
                    None => (capture.lights.get(light)?.count.clone()?, raw, title, "R32Float"),
                }
            }
            PictureKind::Mask => {
                let light = self.light_with(capture, |light| light.shadow.is_some())?;
                let title = format!("mask of {}", format::light(light));
                match at.labels(capture).filter(|(of, _)| *of == light) {
                    Some((_, image)) => (image.clone(), raw, after(&title), "R8Uint"),
                    None => (capture.lights.get(light)?.shadow.clone()?, raw, title, "R8Uint"),
                }
            }
            PictureKind::Visibility => {
                let light = self.light_with(capture, |light| light.visibility.is_some())?;
                let title = format!("visibility of {}", format::light(light));
                match at.visibility(capture).filter(|(of, _)| *of == light) {
                    Some((_, image)) => (image.clone(), raw, after(&title), "R32Float"),
                    None => (capture.lights.get(light)?.visibility.clone()?, raw, title, "R32Float"),
                }
            }
            PictureKind::Overdraw => (self.tests_of(at)?.fragments.clone(), raw, after("overdraw"), "R8Uint"),
            PictureKind::Truth | PictureKind::Error => return self.shown_truth(capture, kind),
            PictureKind::Map => return self.shown_map(capture, at),
        };
        let format = format.to_owned();
        Some(ShownPicture { kind, images: vec![image], layers: Vec::new(), measure, title, format, is_older: false })
    }

    fn tests_of(&self, at: CapturePoint) -> Option<&Arc<StepTests>> {
        self.tests.as_ref().filter(|tests| CapturePoint { step: tests.step, draw: tests.draw } == at)
    }

    fn shown_truth(&self, capture: &Capture, kind: PictureKind) -> Option<ShownPicture> {
        let (light, truth) = self.truth_to_show(capture)?;
        let (image, word) =
            if kind == PictureKind::Truth { (&truth.labels, "truth") } else { (&truth.findings, "error") };
        Some(ShownPicture {
            kind,
            images: vec![image.clone()],
            layers: Vec::new(),
            measure: DepthMeasure::Raw,
            title: format!("{word} of {}", format::light(light)),
            format: "R8Uint".to_owned(),
            is_older: !has_truth(capture),
        })
    }

    /// Returns the index of the light whose truth is shown, and that truth: the chosen light's, else the first that is
    /// known; of this frame, else of the previous one. `None` where none is known.
    pub fn truth_to_show<'a>(&'a self, capture: &'a Capture) -> Option<(usize, &'a CapturedTruth)> {
        if has_truth(capture) {
            let light = self.light_with(capture, |light| light.truth.is_some())?;
            return Some((light, capture.lights.get(light)?.truth.as_ref()?));
        }
        let lights = &self.older_truth.as_ref()?.lights;
        let older = |index: usize| Some((index, lights.get(index)?.as_ref()?));
        older(self.light).or_else(|| (0..lights.len()).find_map(older))
    }

    fn measure_or_raw(&self, linear: Option<DepthMeasure>) -> DepthMeasure {
        linear.filter(|_| self.depth_mode == DepthMode::Linear).unwrap_or(DepthMeasure::Raw)
    }

    /// Returns the index of the chosen light if `has` is true for it, else of the first light for which it is; `None`
    /// where it is true for none.
    pub fn light_with(&self, capture: &Capture, has: impl Fn(&CapturedLight) -> bool) -> Option<usize> {
        let chosen = capture.lights.get(self.light).filter(|light| has(light));
        chosen.map_or_else(|| capture.lights.iter().position(&has), |_| Some(self.light))
    }
}

impl PictureView {
    /// Returns the picture of the chosen layer of a light's map, or of all layers, with a layer as it was after the
    /// draw where that is known; `None` where no light has a map.
    fn shown_map(&self, capture: &Capture, at: CapturePoint) -> Option<ShownPicture> {
        let light = self.light_with(capture, |light| light.map.is_some())?;
        let map = capture.lights.get(light)?.map.as_ref()?;
        let content = MapContent::of(capture, light)?;
        let mut layers = layers::layers(capture, light);
        let mut images = map.faces.clone();
        let drawn = at.layer(capture).filter(|(of, layer, _)| *of == light && *layer < images.len());
        if let Some((_, layer, image)) = drawn {
            images[layer] = image.clone();
        }
        let mut title = format!("{} of {}", content.whole(), format::light(light));
        let has_many = images.len() > 1;
        let chosen = match self.face {
            FaceChoice::One(layer) if layer < images.len() => Some(layer),
            _ => None,
        };
        if let Some(chosen) = chosen.filter(|_| has_many) {
            images = vec![images[chosen].clone()];
            layers = vec![layers[chosen].clone()];
        }
        if let ([one], true) = (&layers[..], has_many || content != MapContent::Depth) {
            title += &match content {
                MapContent::Depth => format!(", {}", one.full_name),
                _ => format!(": {}", one.name),
            };
        }
        if drawn.is_some_and(|(_, layer, _)| chosen.is_none_or(|chosen| chosen == layer)) {
            title += &format!(" after {}", at.words(capture));
        }
        let (measure, format) = match content {
            MapContent::Depth => {
                let linear = DepthMeasure::of_map(capture, light, chosen.unwrap_or(0));
                (self.measure_or_raw(linear), floored("Depth32Float", capture))
            }
            _ => (DepthMeasure::Raw, "Rgba8Unorm".to_owned()),
        };
        Some(ShownPicture { kind: PictureKind::Map, images, layers, measure, title, format, is_older: false })
    }
}

/// Returns a depth format, and to how many bits of it the capture's passes floor depths, where they do.
fn floored(format: &str, capture: &Capture) -> String {
    match capture.depth.bits {
        Some(bits) => format!("{format}, floored to {bits} bits"),
        None => format.to_owned(),
    }
}

impl ShownPicture {
    /// Returns whether it shows a texture of the colours that casters let through.
    pub fn is_let_through(&self) -> bool {
        self.kind == PictureKind::Map && self.images.first().is_some_and(|image| image.format() == PixelFormat::Rgba8)
    }
}

/// Returns whether the ray-traced truth of this frame is known for any light.
pub fn has_truth(capture: &Capture) -> bool {
    capture.lights.iter().any(|light| light.truth.is_some())
}

/// Returns the kind of picture that a step writes; where it changes several, colour before stencil before depth, and
/// colour where it changes none. `None` where there is no such step.
pub fn written(capture: &Capture, step: usize) -> Option<PictureKind> {
    let frame = match &capture.steps.get(step)?.snapshot {
        Snapshot::Map { .. } => return Some(PictureKind::Map),
        Snapshot::Frame(frame) => frame,
    };
    Some(match frame.target {
        FrameTarget::Labels => PictureKind::Mask,
        FrameTarget::Visibility => PictureKind::Visibility,
        FrameTarget::Count => PictureKind::Count,
        FrameTarget::Picture if !frame.color.unchanged => PictureKind::Color,
        FrameTarget::Picture if frame.stencil.as_ref().is_some_and(|stencil| !stencil.unchanged) => {
            PictureKind::Stencil
        }
        FrameTarget::Picture if !frame.depth.unchanged => PictureKind::Depth,
        FrameTarget::Picture => PictureKind::Color,
    })
}

/// Returns the kinds of picture that exist at a point of the frame, or can be asked for (truth, errors and overdraw),
/// in the order of their buttons.
pub fn available(capture: &Capture, at: impl Into<CapturePoint>) -> Vec<PictureKind> {
    let at = at.into();
    let frame = at.frame(capture);
    let exists = |kind: &PictureKind| match kind {
        PictureKind::Color | PictureKind::Depth => frame.is_some(),
        PictureKind::Stencil => frame.is_some_and(|frame| frame.stencil.is_some()),
        PictureKind::Count => capture.lights.iter().any(|light| light.count.is_some()),
        PictureKind::Mask => capture.lights.iter().any(|light| light.shadow.is_some()),
        PictureKind::Visibility => capture.lights.iter().any(|light| light.visibility.is_some()),
        PictureKind::Truth | PictureKind::Error => {
            capture.lights.iter().any(|light| light.shadow.is_some() || light.truth.is_some())
        }
        PictureKind::Overdraw => draws_into_picture(capture, at.step),
        PictureKind::Map => capture.lights.iter().any(|light| light.map.is_some()),
    };
    PictureKind::ALL.into_iter().filter(exists).collect()
}

/// Returns whether a step has draws into the picture, and not into a light's map.
fn draws_into_picture(capture: &Capture, step: usize) -> bool {
    let draws = |step: &crate::capture::Step| !step.draws.is_empty() && matches!(step.snapshot, Snapshot::Frame(_));
    capture.steps.get(step).is_some_and(draws)
}

fn has_stencil(capture: &Capture) -> bool {
    let last = capture.steps.len().checked_sub(1).and_then(|last| capture.frame_at(last));
    last.is_some_and(|frame| frame.stencil.is_some())
}
