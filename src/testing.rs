//! Readback tests of shadows: render a scene, then assert on stencil, depth, label and history of a
//! pixel. A failed assertion panics with the pixel's history, so that the log of a CI run says what
//! happened to it.
//!
//! Runs without a window on whatever adapter there is; Debian's `mesa-vulkan-drivers` brings a
//! software one whose results are the same on every machine.
//!
//! ```
//! use stencilscope::scene::{OpenSpec, open};
//! use stencilscope::technique::{Choice, Technique};
//! use stencilscope::testing::{Label, Rendered};
//!
//! let scene = open(&OpenSpec::new("tetrahedron"))?;
//! let mut frame = Rendered::new(&scene, Choice::new(Technique::ZFail), [320, 240])?;
//!
//! // The middle of the picture shows the tetrahedron, 3.4 m away; volumes cancel out there.
//! frame.at([160, 120]).stencil_after("volumes", 0).distance(3.395, 0.01);
//!
//! // Inside its shadow: the side it is entered through, then the far end.
//! let shadowed = frame.first_labelled(0, Label::Shadow).expect("a shadow");
//! frame.at(shadowed).label(0, Label::Shadow).agrees();
//! assert!(frame.at(shadowed).history().events.iter().any(|event| event.is_of_volume()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::capture::{Capture, FrameTarget, Snapshot};
use crate::history::PixelHistory;
use crate::numbers;
use crate::plan::FramePlan;
use crate::scene::Scene;
use crate::session::{CaptureRequest, Session, SessionError};
use crate::technique::Choice;
use crate::truth;

/// What a technique says of a light at a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Label {
    /// The light reaches the surface.
    Lit,
    /// Something lies between.
    Shadow,
    /// No surface is here.
    Background,
    /// The light is on the surface's other side, or its range ends before it.
    FacesAway,
}

impl Label {
    /// As stored in masks.
    #[must_use]
    pub fn byte(self) -> u8 {
        match self {
            Label::Lit => truth::LIT,
            Label::Shadow => truth::SHADOW,
            Label::Background => truth::BACKGROUND,
            Label::FacesAway => truth::FACES_AWAY,
        }
    }

    /// The label that is stored so.
    #[must_use]
    pub fn from_byte(byte: u8) -> Option<Label> {
        [Label::Lit, Label::Shadow, Label::Background, Label::FacesAway].into_iter().find(|label| label.byte() == byte)
    }
}

/// A rendered scene, to be asked about its pixels.
#[derive(Debug)]
pub struct Rendered {
    session: Session,
    plan: FramePlan,
    capture: Capture,
}

impl Rendered {
    /// Renders `scene` on the best adapter there is, with a picture of `size` pixels.
    ///
    /// # Errors
    /// No adapter, with what to install; a scene or setting that can't be drawn.
    pub fn new(scene: &Scene, choice: Choice, size: [u32; 2]) -> Result<Rendered, SessionError> {
        Rendered::on(Session::new(None)?, scene, &CaptureRequest::new(choice, size))
    }

    /// The same on a session of your own, which [`Rendered::into_session`] gives back.
    ///
    /// # Errors
    /// A scene or setting that can't be drawn; a lost GPU.
    pub fn on(mut session: Session, scene: &Scene, request: &CaptureRequest) -> Result<Rendered, SessionError> {
        let (capture, plan) = session.capture_with_plan(scene, request)?;
        Ok(Rendered { session, plan, capture })
    }

    /// The session, for the next scene.
    #[must_use]
    pub fn into_session(self) -> Session {
        self.session
    }

    /// Everything that the frame left.
    #[must_use]
    pub fn capture(&self) -> &Capture {
        &self.capture
    }

    /// The frame as data.
    #[must_use]
    pub fn plan(&self) -> &FramePlan {
        &self.plan
    }

    /// A pixel to assert on: column and row from the top left.
    ///
    /// # Panics
    /// If it is outside the picture, or the GPU is lost.
    #[track_caller]
    pub fn at(&mut self, pixel: [u32; 2]) -> Pixel<'_> {
        match self.session.history(&self.plan, &self.capture, pixel) {
            Ok(history) => Pixel { capture: &self.capture, history },
            Err(error) => panic!("{error}"),
        }
    }

    /// The first pixel, row by row, that has a label under a light.
    #[must_use]
    pub fn first_labelled(&self, light: usize, label: Label) -> Option<[u32; 2]> {
        let labels = self.capture.lights.get(light)?.shadow.as_ref()?;
        let find = |(y, row): (u32, &[u8])| {
            let x = row.iter().position(|byte| *byte == label.byte())?;
            Some([x as u32, y])
        };
        (0..).zip(labels.rows()).find_map(find)
    }
}

/// A pixel of a rendered scene. Assertions give it back, so that they can be chained.
#[derive(Debug)]
pub struct Pixel<'a> {
    capture: &'a Capture,
    history: PixelHistory,
}

impl Pixel<'_> {
    /// Everything that happened to it.
    #[must_use]
    pub fn history(&self) -> &PixelHistory {
        &self.history
    }

    /// Asserts that its history makes what the GPU stored, after every pass and bit for bit.
    ///
    /// # Panics
    /// If it does not: a bug of this program or of the driver.
    #[track_caller]
    pub fn agrees(&self) -> &Self {
        if !self.history.agrees() {
            self.fail("the events do not make what the GPU stored");
        }
        self
    }

    /// Asserts on the stencil by the end of the frame.
    ///
    /// # Panics
    /// If it is another.
    #[track_caller]
    pub fn stencil(&self, expected: u8) -> &Self {
        self.stencil_at(self.capture.steps.len().saturating_sub(1), expected)
    }

    /// Asserts on the stencil after the first pass of a name, such as `volumes`.
    ///
    /// # Panics
    /// If it is another, or there is no such pass.
    #[track_caller]
    pub fn stencil_after(&self, pass: &str, expected: u8) -> &Self {
        self.stencil_at(self.pass_named(pass), expected)
    }

    /// Asserts on the stored depth by the end of the frame, bit for bit.
    ///
    /// # Panics
    /// If it is another.
    #[track_caller]
    pub fn depth(&self, expected: f32) -> &Self {
        let found = self.stored_depth();
        if found.to_bits() != expected.to_bits() {
            self.fail(&format!("depth is {found:?}, not {expected:?}"));
        }
        self
    }

    /// Asserts on the distance of the visible surface along the view axis, in metres.
    ///
    /// # Panics
    /// If it is farther than `tolerance` from `expected`, or no surface is there.
    #[track_caller]
    pub fn distance(&self, expected: f64, tolerance: f64) -> &Self {
        match self.capture.depth.distance(self.stored_depth()) {
            Some(found) if (found - expected).abs() <= tolerance => self,
            Some(found) => {
                self.fail(&format!("the surface is {found} m away, not {expected} m (give or take {tolerance})"))
            }
            None => self.fail(&format!("no surface is here, and none {expected} m away")),
        }
    }

    /// Asserts on what the technique says of a light.
    ///
    /// # Panics
    /// If it says something else, or the scene has no such light.
    #[track_caller]
    pub fn label(&self, light: usize, expected: Label) -> &Self {
        let mask = self.capture.lights.get(light).and_then(|light| light.shadow.as_ref());
        let found = mask.and_then(|mask| mask.byte_at(self.history.pixel)).and_then(Label::from_byte);
        if found != Some(expected) {
            let found = found.map_or_else(|| "unknown".to_owned(), |label| format!("{label:?}"));
            self.fail(&format!("{} is labelled {found}, not {expected:?}", numbers::light(light)));
        }
        self
    }

    /// Asserts on the whole list of events, each as [`PixelHistory::brief`] has it.
    ///
    /// # Panics
    /// If an event is missing, is one too many, or is another.
    #[track_caller]
    pub fn events(&self, expected: &[&str]) -> &Self {
        self.compare_events(expected, |_| true)
    }

    /// Asserts on the events of passes of one name, such as `volumes`.
    ///
    /// # Panics
    /// As [`Pixel::events`]; if there is no such pass.
    #[track_caller]
    pub fn events_of(&self, pass: &str, expected: &[&str]) -> &Self {
        self.pass_named(pass);
        self.compare_events(expected, |name| name == pass)
    }

    #[track_caller]
    fn compare_events(&self, expected: &[&str], is_asked: impl Fn(&str) -> bool) -> &Self {
        let events = self.history.events.iter().filter(|event| is_asked(&event.pass_name));
        let found: Vec<String> = events.map(|event| self.history.brief(event)).collect();
        if found != expected {
            self.fail(&format!("events are\n  {}\nnot\n  {}", found.join("\n  "), expected.join("\n  ")));
        }
        self
    }

    #[track_caller]
    fn stencil_at(&self, step: usize, expected: u8) -> &Self {
        let stencil = self.capture.frame_at(step).and_then(|frame| frame.stencil.as_ref());
        match stencil.and_then(|stencil| stencil.image.byte_at(self.history.pixel)) {
            Some(found) if found == expected => self,
            Some(found) => {
                let [found, expected] = [found, expected].map(numbers::signed);
                self.fail(&format!("stencil is {found}, not {expected}, after pass {}", step + 1))
            }
            None => self.fail("the technique uses no stencil buffer"),
        }
    }

    #[track_caller]
    fn stored_depth(&self) -> f32 {
        let last = self.capture.frame_at(self.capture.steps.len().saturating_sub(1));
        match last.and_then(|frame| frame.depth.image.depth_at(self.history.pixel)) {
            Some(depth) => depth,
            None => self.fail("the frame has no depth"),
        }
    }

    /// Index of the first pass of the picture that has this name.
    #[track_caller]
    fn pass_named(&self, name: &str) -> usize {
        let has_name = |step: &crate::capture::Step| step.name == name && matches!(step.snapshot, Snapshot::Frame(_));
        self.capture.steps.iter().position(has_name).unwrap_or_else(|| {
            let is_shown = |step: &&crate::capture::Step| match &step.snapshot {
                Snapshot::Frame(frame) => frame.target != FrameTarget::Labels,
                Snapshot::Map { .. } => false,
            };
            let names: Vec<&str> = self.capture.steps.iter().filter(is_shown).map(|step| step.name.as_str()).collect();
            self.fail(&format!("no pass is called `{name}`: there are {}", names.join(", ")))
        })
    }

    /// Panics, and tells what happened to the pixel.
    #[track_caller]
    fn fail(&self, what: &str) -> ! {
        panic!(
            "{}, {}, pixel {},{}: {what}\n\n{}",
            self.capture.scene,
            self.capture.technique,
            self.history.pixel[0],
            self.history.pixel[1],
            self.history.story(&self.capture.depth)
        )
    }
}
