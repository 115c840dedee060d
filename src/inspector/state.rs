//! What the inspector shows, as plain data.

use crate::capture::{Capture, FrameSnapshot, Image, Step};
use crate::scene::{Camera, Light};
use crate::technique::Choice;
use std::sync::Arc;
use std::time::Duration;

/// How long each step shows while playing.
const STEP_SECONDS: f64 = 0.8;

/// A built-in scene that can be opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneEntry {
    /// What to open.
    pub name: String,
    /// What it teaches.
    pub lesson: String,
}

/// What may be changed of a scene from the panels: its technique, camera, lights and moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Technique and settings.
    pub choice: Choice,
    /// The eye.
    pub camera: Camera,
    /// In order; none are added or removed here.
    pub lights: Vec<Light>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Seconds after the scene's start.
    pub time: f64,
    /// Whether anything moves.
    pub is_animated: bool,
}

/// A message with its mend, shown until dismissed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// What went wrong and how to mend it.
    pub text: String,
}

/// Which picture of a step is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum PictureKind {
    /// What the frame looks like.
    #[default]
    Color,
    /// Counts and marks.
    Stencil,
    /// Distance from the eye.
    Depth,
    /// The labels of a light.
    Mask,
    /// Depth from a light.
    Map,
}

impl PictureKind {
    /// In the order of the buttons.
    pub const ALL: [PictureKind; 5] =
        [PictureKind::Color, PictureKind::Stencil, PictureKind::Depth, PictureKind::Mask, PictureKind::Map];

    /// For buttons and the status bar.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            PictureKind::Color => "Colour",
            PictureKind::Stencil => "Stencil",
            PictureKind::Depth => "Depth",
            PictureKind::Mask => "Mask",
            PictureKind::Map => "Shadow map",
        }
    }
}

/// How depth becomes grey.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DepthRange {
    /// Show the stored value instead of the distance.
    pub raw: bool,
    /// Black and white ends, in metres or as stored; `None` fits the picture.
    pub ends: Option<[f32; 2]>,
}

/// How the picture lies in its panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    /// Keep the whole picture in view.
    pub fit: bool,
    /// Points a texel.
    pub zoom: f32,
    /// Texel in the middle of the panel.
    pub center: [f32; 2],
}

impl Default for Placement {
    fn default() -> Placement {
        Placement { fit: true, zoom: 1.0, center: [0.0; 2] }
    }
}

/// Everything the panels show.
#[derive(Debug, Clone, Default)]
pub struct State {
    /// The frame that is looked at; the last one stays while a new one is made.
    pub capture: Option<Arc<Capture>>,
    /// What can be changed of it; `None` for a capture folder, which has no scene.
    pub setup: Option<Setup>,
    /// Scenes that the open dialog lists.
    pub scenes: Vec<SceneEntry>,
    /// What the app is doing, while it is.
    pub job: Option<String>,
    /// A message.
    pub notice: Option<Notice>,
    /// Index of the step looked at.
    pub step: usize,
    /// Which picture of it.
    pub picture: PictureKind,
    /// The light whose mask and map are shown.
    pub light: usize,
    /// The face of a cube map; `None` shows all.
    pub face: Option<usize>,
    /// The picked pixel.
    pub pick: Option<[u32; 2]>,
    /// How depth is shown.
    pub depth: DepthRange,
    /// Steps follow each other by themselves.
    pub playing: bool,
    pub(super) hover: Option<[u32; 2]>,
    pub(super) placement: Placement,
    /// The text of the open dialog, while it is shown.
    pub(super) open: Option<String>,
    /// The text of the find field, while it is shown.
    pub(super) find: Option<String>,
    /// The text of the go-to field, while it is shown.
    pub(super) go_to: Option<String>,
    next_step_at: Option<f64>,
}

impl State {
    /// Shows a new capture. Step, picture and pick stay where they still exist.
    pub fn show_capture(&mut self, capture: Arc<Capture>) {
        let before = self.capture.as_ref().map(|old| (old.steps.len(), old.size, old.technique.clone()));
        let is_like_before = before == Some((capture.steps.len(), capture.size, capture.technique.clone()));
        let last = capture.steps.len().saturating_sub(1);
        self.step = if is_like_before { self.step.min(last) } else { last };
        self.pick = self.pick.filter(|[x, y]| *x < capture.size[0] && *y < capture.size[1]);
        self.light = self.light.min(capture.lights.len().saturating_sub(1));
        self.hover = None;
        if before.is_none_or(|(_, size, _)| size != capture.size) {
            self.placement = Placement::default();
        }
        self.capture = Some(capture);
        self.face = None;
        if !self.available().contains(&self.picture) {
            self.picture = PictureKind::Color;
        }
    }

    /// Looks at step `index`, or the last one.
    pub fn go_to_step(&mut self, index: usize) {
        let count = self.capture.as_ref().map_or(0, |capture| capture.steps.len());
        self.step = index.min(count.saturating_sub(1));
    }

    /// The step looked at.
    #[must_use]
    pub fn current(&self) -> Option<&Step> {
        self.capture.as_ref()?.steps.get(self.step)
    }

    /// The picture's aspects after the step looked at.
    #[must_use]
    pub fn frame(&self) -> Option<&FrameSnapshot> {
        self.capture.as_ref()?.frame_at(self.step)
    }

    /// The pictures that this capture has.
    #[must_use]
    pub fn available(&self) -> Vec<PictureKind> {
        let Some(capture) = &self.capture else { return Vec::new() };
        let light = capture.lights.get(self.light);
        let exists = |kind: &PictureKind| match kind {
            PictureKind::Color | PictureKind::Depth => true,
            PictureKind::Stencil => self.frame().is_some_and(|frame| frame.stencil.is_some()),
            PictureKind::Mask => light.is_some_and(|light| light.shadow.is_some()),
            PictureKind::Map => light.is_some_and(|light| light.map.is_some()),
        };
        PictureKind::ALL.into_iter().filter(exists).collect()
    }

    /// The picture that is shown now; before the first frame step of a map technique there is
    /// only the map.
    #[must_use]
    pub fn image(&self) -> Option<&Arc<Image>> {
        let capture = self.capture.as_ref()?;
        let light = capture.lights.get(self.light);
        match self.picture {
            PictureKind::Color => Some(&self.frame()?.color.image),
            PictureKind::Stencil => Some(&self.frame()?.stencil.as_ref()?.image),
            PictureKind::Depth => Some(&self.frame()?.depth.image),
            PictureKind::Mask => light?.shadow.as_ref(),
            PictureKind::Map => light?.map.as_ref()?.faces.get(self.face.unwrap_or(0)),
        }
    }

    /// Zooms to 1 texel a point, or fits the whole picture.
    pub(super) fn place(&mut self, fit: bool) {
        let size = self.image().map_or([1, 1], |image| image.size());
        self.placement = Placement { fit, zoom: 1.0, center: size.map(|n| n as f32 / 2.0) };
    }

    /// Moves on by a step when it is time, and asks for the next repaint.
    pub(super) fn advance_playing(&mut self, context: &egui::Context) {
        if !self.playing {
            self.next_step_at = None;
            return;
        }
        let count = self.capture.as_ref().map_or(0, |capture| capture.steps.len());
        let now = context.input(|input| input.time);
        let due = *self.next_step_at.get_or_insert(now + STEP_SECONDS);
        if now >= due {
            self.step += 1;
            self.next_step_at = Some(now + STEP_SECONDS);
        }
        if self.step + 1 >= count {
            self.step = count.saturating_sub(1);
            self.playing = false;
        } else {
            let wait = (self.next_step_at.unwrap_or(now) - now).max(0.0);
            context.request_repaint_after(Duration::from_secs_f64(wait));
        }
    }

    /// Starts or stops playing; from the last step it starts over.
    pub(super) fn toggle_playing(&mut self) {
        let count = self.capture.as_ref().map_or(0, |capture| capture.steps.len());
        self.playing = !self.playing && count > 1;
        if self.playing && self.step + 1 >= count {
            self.step = 0;
        }
    }
}
