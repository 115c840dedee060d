//! Readback tests of shadows: render a scene or a plan, then assert on stencil, count, depth, colour, label
//! and history of a pixel, and on what a shadow map holds there. A failed assertion panics with the
//! pixel's history, so that the log of a CI run says what happened to it.
//!
//! Runs without a window on whatever adapter there is; Debian's `mesa-vulkan-drivers` brings a
//! software one whose results are the same on every machine.
//!
//! ```
//! use stencilscope::scene::builtin::Builtin;
//! use stencilscope::technique::{Choice, Technique};
//! use stencilscope::testing::{Label, Rendered};
//!
//! let scene = Builtin::named("tetrahedron").expect("a name").scene()?;
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
//!
//! Scenes of your own are quickly made with [`SceneBuilder`](crate::scene::SceneBuilder), and a plan with one thing
//! changed is rendered by [`Rendered::of_plan`].

use crate::capture::{Capture, FrameTarget, Snapshot, Step};
use crate::history::PixelHistory;
use crate::math::projection;
use crate::numbers;
use crate::plan::FramePlan;
use crate::scene::Scene;
use crate::session::{CaptureRequest, Session, SessionError};
use crate::technique::Choice;
use crate::truth;
use glam::{DVec2, DVec3, DVec4};

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

    /// Runs a plan as it is, such as a good one with one thing changed, or that of a technique of your own.
    ///
    /// ```
    /// use stencilscope::plan::Part;
    /// use stencilscope::scene::builtin::Builtin;
    /// use stencilscope::session::{CaptureRequest, Session};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::{Label, Rendered};
    ///
    /// let scene = Builtin::named("tetrahedron").expect("a name").scene()?;
    /// let request = CaptureRequest::new(Choice::new(Technique::ZFail), [320, 240]);
    /// let mut session = Session::new(None)?;
    /// let mut plan = session.plan(&scene, &request)?;
    ///
    /// // Without light caps the volume is open, and the tetrahedron itself is in shadow.
    /// plan.passes.iter_mut().for_each(|pass| pass.draws.retain(|draw| draw.part != Part::LightCap));
    /// let mut broken = Rendered::of_plan(session, &scene, plan)?;
    /// broken.at([160, 120]).label(0, Label::Shadow).agrees();
    ///
    /// let mut whole = Rendered::on(broken.into_session(), &scene, &request)?;
    /// whole.at([160, 120]).label(0, Label::Lit).agrees();
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A plan that can't run, a lost GPU.
    pub fn of_plan(mut session: Session, scene: &Scene, plan: FramePlan) -> Result<Rendered, SessionError> {
        let capture = session.capture_plan(scene, &plan)?;
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

/// The texel of a light's shadow map that a pixel's surface falls in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapTexel {
    /// Which face of the map.
    pub face: usize,
    /// Column and row from the top left.
    pub texel: [u32; 2],
    /// The depth that it holds, as stored.
    pub stored: f32,
    /// The depth that the surface has there, before any bias.
    pub surface: f64,
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
        self.stencil_at(self.pass_of(pass, None), expected)
    }

    /// Asserts on the stencil after the first pass of a name that belongs to a light: with several lights each has
    /// a pass of that name.
    ///
    /// ```
    /// use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::Rendered;
    ///
    /// // A board over a floor, under two suns of which the second shines past it.
    /// let scene = SceneBuilder::new("two suns")
    ///     .object(Object::of("floor", shapes::quad([8.0; 2])?))
    ///     .object(Object::of("board", shapes::quad([1.0; 2])?).at([0.0, 1.0, 0.0]).unseen())
    ///     .lights([Light::directional([0.0, 1.0, 0.0]), Light::directional([3.0, 1.0, 0.0])])
    ///     .seen_from([0.0, 5.0, 0.0], [0.0; 3])
    ///     .build();
    /// let mut frame = Rendered::new(&scene, Choice::new(Technique::ZFail), [65, 65])?;
    /// frame.at([32, 32]).stencil_of(0, "volumes", 1).stencil_of(1, "volumes", 0).agrees();
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// If it is another, or the light has no such pass.
    #[track_caller]
    pub fn stencil_of(&self, light: usize, pass: &str, expected: u8) -> &Self {
        self.stencil_at(self.pass_of(pass, Some(light)), expected)
    }

    /// Asserts on how many volumes of a light contain the surface, where they are counted in floats.
    ///
    /// ```
    /// use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::{Label, Rendered};
    ///
    /// // 256 boards in a pile: eight bits would read their count as none.
    /// let board = shapes::quad([1.0; 2])?;
    /// let pile = (0..256).map(|step| {
    ///     Object::of("board", board.clone()).at([0.0, 1.0 + 0.001 * f64::from(step), 0.0]).unseen()
    /// });
    /// let scene = SceneBuilder::new("a pile")
    ///     .object(Object::of("floor", shapes::quad([8.0; 2])?))
    ///     .objects(pile)
    ///     .light(Light::directional([0.0, 1.0, 0.0]))
    ///     .seen_from([0.0, 5.0, 0.0], [0.0; 3])
    ///     .build();
    /// let mut choice = Choice::new(Technique::ZFail);
    /// choice.set("counter", "float")?;
    /// let mut frame = Rendered::new(&scene, choice, [65, 65])?;
    /// frame.at([32, 32]).count(0, 256.0).label(0, Label::Shadow);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// If it is another, or the light's volumes are counted in the stencil or not at all.
    #[track_caller]
    pub fn count(&self, light: usize, expected: f32) -> &Self {
        let count = self.capture.lights.get(light).and_then(|light| light.count.as_ref());
        let name = numbers::light(light);
        match count.and_then(|count| count.count_at(self.history.pixel)) {
            Some(found) if found == expected => self,
            Some(found) => {
                let [found, expected] = [found, expected].map(numbers::count_in_float);
                self.fail(&format!("{found} volumes of {name} contain the surface, not {expected}"))
            }
            None => self.fail(&format!("{name} has no count in floats")),
        }
    }

    /// Asserts on the picture's colour: red, green, blue and opacity as stored in sRGB, each to within `tolerance`.
    ///
    /// ```
    /// use stencilscope::scene::{Light, Material, Object, SceneBuilder, shapes};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::Rendered;
    ///
    /// // Only ambient light, half of it, on a surface that reflects red alone.
    /// let red = Object { material: Material::matte([1.0, 0.0, 0.0]), ..Object::of("floor", shapes::quad([8.0; 2])?) };
    /// let scene = SceneBuilder::new("red")
    ///     .ambient([0.5; 3])
    ///     .object(red)
    ///     .lights([])
    ///     .seen_from([0.0, 5.0, 0.0], [0.0; 3])
    ///     .build();
    /// let mut frame = Rendered::new(&scene, Choice::new(Technique::None), [64, 64])?;
    /// // A linear 0.5 is 188 in sRGB; rounding may differ by one between drivers.
    /// frame.at([32, 32]).color([188, 0, 0, 255], 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// If a channel is farther away.
    #[track_caller]
    pub fn color(&self, expected: [u8; 4], tolerance: u8) -> &Self {
        let last = self.capture.frame_at(self.capture.steps.len().saturating_sub(1));
        match last.and_then(|frame| frame.color.image.rgba_at(self.history.pixel)) {
            Some(found) if found.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= tolerance) => self,
            Some(found) => self.fail(&format!("the colour is {found:?}, not {expected:?} (give or take {tolerance})")),
            None => self.fail("the frame has no picture"),
        }
    }

    /// The texel of a light's shadow map that the visible surface falls in; `None` where there is no such map, no
    /// surface, or the surface is outside of what the map shows.
    ///
    /// ```
    /// use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::{Label, Rendered};
    ///
    /// let scene = SceneBuilder::new("a board over a floor")
    ///     .object(Object::of("floor", shapes::quad([8.0; 2])?))
    ///     .object(Object::of("board", shapes::quad([1.0; 2])?).at([0.0, 1.0, 0.0]).unseen())
    ///     .light(Light::directional([0.0, 1.0, 0.0]))
    ///     .seen_from([0.0, 5.0, 0.0], [0.0; 3])
    ///     .build();
    /// let mut frame = Rendered::new(&scene, Choice::new(Technique::ShadowMap), [65, 65])?;
    /// let below = frame.at([32, 32]);
    /// let texel = below.label(0, Label::Shadow).map_texel(0).expect("the map shows it");
    /// // Depth is reversed: the board is nearer to the light than the floor below it.
    /// assert!(f64::from(texel.stored) > texel.surface);
    /// below.map_depth(0, texel.stored);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn map_texel(&self, light: usize) -> Option<MapTexel> {
        let map = self.capture.lights.get(light)?.map.as_ref().filter(|map| !map.holds_colors())?;
        let in_light = map.light_from_world * self.surface()?.extend(1.0);
        let on_face = |(face, clip_from_light): (usize, &glam::DMat4)| {
            let clip: DVec4 = *clip_from_light * in_light;
            let image = map.faces.get(face)?;
            let [width, height] = image.size().map(f64::from);
            // Row 0 is at the top.
            let at = (clip.truncate().truncate() / clip.w * DVec2::new(0.5, -0.5) + 0.5) * DVec2::new(width, height);
            let is_inside = clip.w > 0.0 && at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::new(width, height)).all();
            let texel = is_inside.then_some([at.x as u32, at.y as u32])?;
            Some(MapTexel { face, texel, stored: image.depth_at(texel)?, surface: clip.z / clip.w })
        };
        map.clip_from_light.iter().enumerate().find_map(on_face)
    }

    /// Asserts on the depth that a light's shadow map holds where the visible surface falls into it, bit for bit; see
    /// [`Pixel::map_texel`], which has an example.
    ///
    /// # Panics
    /// If it is another, or the map does not show the surface.
    #[track_caller]
    pub fn map_depth(&self, light: usize, expected: f32) -> &Self {
        let name = numbers::light(light);
        match self.map_texel(light) {
            Some(found) if found.stored.to_bits() == expected.to_bits() => self,
            Some(MapTexel { face, texel: [x, y], stored, .. }) => {
                self.fail(&format!("the map of {name} holds {stored:?} at {x},{y} of face {face}, not {expected:?}"))
            }
            None => self.fail(&format!("no shadow map of {name} shows the surface")),
        }
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
        self.pass_of(pass, None);
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

    /// The world position of the visible surface at the pixel's centre; `None` where there is none.
    fn surface(&self) -> Option<DVec3> {
        let (camera, curve) = (&self.capture.camera, &self.capture.depth);
        let last = self.capture.frame_at(self.capture.steps.len().saturating_sub(1))?;
        let distance = curve.distance(last.depth.image.depth_at(self.history.pixel)?)?;
        let [width, height] = self.capture.size.map(f64::from);
        let [x, y] = self.history.pixel.map(|at| f64::from(at) + 0.5);
        let up = (camera.fov_y_degrees / 2.0).to_radians().tan();
        let in_view = DVec3::new((2.0 * x / width - 1.0) * up * width / height, (1.0 - 2.0 * y / height) * up, -1.0);
        let world_from_view = projection::view_from_world_rotation(camera.target - camera.eye, camera.up).transpose();
        Some(camera.eye + world_from_view * (in_view * distance))
    }

    /// Index of the first pass of the picture that has this name, and is of this light where one is given.
    #[track_caller]
    fn pass_of(&self, name: &str, light: Option<usize>) -> usize {
        let is_of_light = |step: &Step| light.is_none() || step.light == light;
        let is_it = |step: &Step| step.name == name && is_of_light(step) && matches!(step.snapshot, Snapshot::Frame(_));
        self.capture.steps.iter().position(is_it).unwrap_or_else(|| {
            let is_shown = |step: &&Step| match &step.snapshot {
                Snapshot::Frame(frame) => frame.target != FrameTarget::Labels && is_of_light(step),
                Snapshot::Map { .. } => false,
            };
            let names: Vec<&str> = self.capture.steps.iter().filter(is_shown).map(|step| step.name.as_str()).collect();
            let of = light.map_or_else(String::new, |light| format!(" of {}", numbers::light(light)));
            self.fail(&format!("no pass{of} is called `{name}`: there are {}", names.join(", ")))
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
