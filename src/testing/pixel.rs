//! Assertions on a pixel.

use super::PixelLabel;
use super::places::{CameraProjection, ShadowMapTexel, texel_of};
use crate::capture::{Capture, FrameTarget, Snapshot, Step};
use crate::history::{PixelEvent, PixelHistory};
use crate::numbers;
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// A pixel of a rendered scene. Assertions return it, so that they can be chained.
#[derive(Debug)]
pub struct Pixel<'a> {
    pub(super) capture: &'a Capture,
    pub(super) history: PixelHistory,
}

impl Pixel<'_> {
    /// Returns the pixel's history: every event that tested or changed it, and those that were culled or clipped there.
    pub fn history(&self) -> &PixelHistory {
        &self.history
    }

    /// Asserts that its history ends in what the GPU stored, after every pass and bit for bit.
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

    /// Asserts on the stencil at the end of the frame.
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
    /// If it is another, there is no such pass, or several lights have one: see [`Pixel::stencil_of`].
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
    /// use stencilscope::testing::{PixelLabel, Rendered};
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
    /// frame.at([32, 32]).count(0, 256.0).label(0, PixelLabel::Shadow);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// If it is another, or the light's volumes are counted in the stencil or not at all.
    #[track_caller]
    pub fn count(&self, light: usize, expected: f32) -> &Self {
        let count = self.capture.lights.get(light).and_then(|light| light.count.as_ref());
        let name = numbers::light(light);
        match count.and_then(|count| count.value_at(self.history.pixel)) {
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

    /// Returns the texel of a light's shadow map that the visible surface falls in; `None` where there is no such map,
    /// no surface, or the surface is outside of what the map shows.
    ///
    /// ```
    /// use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::{PixelLabel, Rendered};
    ///
    /// let scene = SceneBuilder::new("a board over a floor")
    ///     .object(Object::of("floor", shapes::quad([8.0; 2])?))
    ///     .object(Object::of("board", shapes::quad([1.0; 2])?).at([0.0, 1.0, 0.0]).unseen())
    ///     .light(Light::directional([0.0, 1.0, 0.0]))
    ///     .seen_from([0.0, 5.0, 0.0], [0.0; 3])
    ///     .build();
    /// let mut frame = Rendered::new(&scene, Choice::new(Technique::ShadowMap), [65, 65])?;
    /// let below = frame.at([32, 32]);
    /// let texel = below.label(0, PixelLabel::Shadow).map_texel(0).expect("the map shows it");
    /// // Depth is reversed: the board is nearer to the light than the floor below it.
    /// assert!(f64::from(texel.stored) > texel.surface);
    /// below.map_depth(0, texel.stored);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map_texel(&self, light: usize) -> Option<ShadowMapTexel> {
        texel_of(self.capture, light, self.surface()?)
    }

    /// Asserts on the depth that a light's shadow map stores where the visible surface falls into it, bit for bit; see
    /// [`Pixel::map_texel`], which has an example.
    ///
    /// # Panics
    /// If it is another, or the map does not show the surface.
    #[track_caller]
    pub fn map_depth(&self, light: usize, expected: f32) -> &Self {
        let name = numbers::light(light);
        match self.map_texel(light) {
            Some(found) if found.stored.to_bits() == expected.to_bits() => self,
            Some(ShadowMapTexel { face, texel: [x, y], stored, .. }) => {
                self.fail(&format!("the map of {name} holds {stored:?} at {x},{y} of face {face}, not {expected:?}"))
            }
            None => self.fail(&format!("no shadow map of {name} shows the surface")),
        }
    }

    /// Asserts on how much nearer to a light its shadow map's depth is than the visible surface, in metres along the
    /// map's axis: 0 where that is the surface itself, more where something is before it. See [`ShadowMapTexel::gap`].
    /// A map is no larger than its casters: beside them it is empty, and shows no surface.
    ///
    /// ```
    /// use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::Rendered;
    ///
    /// let scene = SceneBuilder::new("a board over a floor")
    ///     .object(Object::of("floor", shapes::quad([8.0; 2])?))
    ///     .object(Object::of("board", shapes::quad([1.0; 2])?).at([0.0, 1.0, 0.0]))
    ///     .light(Light::directional([0.0, 1.0, 0.0]))
    ///     .seen_from([0.0, 4.0, 4.0], [0.0; 3])
    ///     .build();
    /// let mut frame = Rendered::new(&scene, Choice::new(Technique::ShadowMap), [65, 65])?;
    /// // Under the board, and on it.
    /// frame.at_point([0.1, 0.0, 0.4]).map_gap(0, 1.0, 0.01);
    /// frame.at_point([0.1, 1.0, 0.1]).map_gap(0, 0.0, 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// If it is farther than `tolerance` from `expected`, the map is empty there, or does not show the surface.
    #[track_caller]
    pub fn map_gap(&self, light: usize, expected: f64, tolerance: f64) -> &Self {
        let name = numbers::light(light);
        match self.map_texel(light) {
            Some(ShadowMapTexel { gap: Some(gap), .. }) if (gap - expected).abs() <= tolerance => self,
            Some(ShadowMapTexel { gap: Some(gap), face, texel: [x, y], .. }) => self.fail(&format!(
                "at {x},{y} of face {face} the map of {name} holds what is {gap} m nearer to the light than the surface, \
                 not {expected} m (give or take {tolerance})"
            )),
            Some(ShadowMapTexel { face, texel: [x, y], .. }) => {
                self.fail(&format!("the map of {name} holds nothing at {x},{y} of face {face}"))
            }
            None => self.fail(&format!("no shadow map of {name} shows the surface")),
        }
    }

    /// Asserts on the stored depth at the end of the frame, bit for bit.
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

    /// Asserts on the technique's label of a light.
    ///
    /// # Panics
    /// If it is another, or the scene has no such light.
    #[track_caller]
    pub fn label(&self, light: usize, expected: PixelLabel) -> &Self {
        let mask = self.capture.lights.get(light).and_then(|light| light.shadow.as_ref());
        let found = mask.and_then(|mask| mask.byte_at(self.history.pixel)).and_then(PixelLabel::from_byte);
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
    /// As [`Pixel::events`]; if there is no such pass, or several lights have one: see [`Pixel::events_of_light`].
    #[track_caller]
    pub fn events_of(&self, pass: &str, expected: &[&str]) -> &Self {
        self.pass_of(pass, None);
        self.compare_events(expected, |event| event.pass_name == pass)
    }

    /// Asserts on the events of a light's passes of one name.
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
    /// let middle = frame.at([32, 32]);
    /// // The first light is blocked, the second adds to the floor.
    /// middle.events_of_light(0, "light", &["light: floor, front, fails stencil"]);
    /// middle.events_of_light(1, "light", &["light: floor, front, passes, stencil 0 to 1"]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// As [`Pixel::events`]; if the light has no such pass.
    #[track_caller]
    pub fn events_of_light(&self, light: usize, pass: &str, expected: &[&str]) -> &Self {
        self.pass_of(pass, Some(light));
        let of_light = |index: usize| self.capture.steps.get(index).and_then(|step| step.light) == Some(light);
        self.compare_events(expected, |event| event.pass_name == pass && of_light(event.pass))
    }

    #[track_caller]
    fn compare_events(&self, expected: &[&str], is_asked: impl Fn(&PixelEvent) -> bool) -> &Self {
        let events = self.history.events.iter().filter(|event| is_asked(event));
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

    /// Asserts that no visible surface hides a world-space point that falls into the pixel, with a margin for a slanted
    /// surface. Passes where the pixel shows no surface.
    #[track_caller]
    pub(super) fn reveals(&self, point: DVec3) {
        let view = CameraProjection::of(self.capture);
        let (_, distance) = view.pixel_and_distance(point);
        let [x, y] = self.history.pixel;
        let Some(found) = self.surface_distance([x, y]) else { return };
        // Over a flat surface one over the distance changes evenly: by this much from here to the next pixel.
        let next = |neighbours: [[u32; 2]; 2]| {
            let steps =
                neighbours.into_iter().filter_map(|at| Some((1.0 / self.surface_distance(at)? - 1.0 / found).abs()));
            steps.reduce(f64::min).unwrap_or(0.0)
        };
        let [left, above] = [x, y].map(|at| at.wrapping_sub(1));
        let slope = next([[left, y], [x + 1, y]]) + next([[x, above], [x, y + 1]]);
        let farthest_within = 1.0 / (1.0 / found - slope).max(f64::MIN_POSITIVE);
        if farthest_within + view.pixel_width(distance) < distance {
            self.fail(&format!("the point {point} is {distance} m away, behind a surface {found} m away"));
        }
    }

    /// Returns the distance along the view axis of the visible surface at a pixel's centre, metres, from the depth at
    /// the end of the frame; `None` where there is none.
    fn surface_distance(&self, pixel: [u32; 2]) -> Option<f64> {
        let last = self.capture.frame_at(self.capture.steps.len().saturating_sub(1))?;
        self.capture.depth.distance(last.depth.image.depth_at(pixel)?)
    }

    /// Returns the world position of the visible surface at the pixel's centre; `None` where there is none.
    fn surface(&self) -> Option<DVec3> {
        let distance = self.surface_distance(self.history.pixel)?;
        let [x, y] = self.history.pixel.map(|at| f64::from(at) + 0.5);
        Some(CameraProjection::of(self.capture).point(DVec2::new(x, y), distance))
    }

    /// Returns the index of the first pass of the picture that has this name, and belongs to this light where one is
    /// given. Panics where there is none, or without a light where several lights have one.
    #[track_caller]
    fn pass_of(&self, name: &str, light: Option<usize>) -> usize {
        let is_meant = |step: &&Step| light.is_none() || step.light == light;
        let is_of_picture = |step: &Step| matches!(step.snapshot, Snapshot::Frame(_));
        let steps = &self.capture.steps;
        let lights: BTreeSet<Option<usize>> = steps
            .iter()
            .filter(|step| step.name == name && is_of_picture(step) && is_meant(step))
            .map(|step| step.light)
            .collect();
        if lights.len() > 1 {
            self.fail(&format!(
                "several lights have a pass `{name}`: name the light (`stencil_of`, `events_of_light`)"
            ));
        }
        match steps.iter().position(|step| step.name == name && is_of_picture(step) && is_meant(&step)) {
            Some(index) => index,
            None => {
                let is_shown = |step: &&Step| match &step.snapshot {
                    Snapshot::Frame(frame) => frame.target != FrameTarget::Labels && is_meant(step),
                    Snapshot::Map { .. } => false,
                };
                let called = |step: &Step| match step.light.filter(|_| self.capture.lights.len() > 1) {
                    Some(of) if light.is_none() => format!("{} of {}", step.name, numbers::light(of)),
                    _ => step.name.clone(),
                };
                let names: Vec<String> = steps.iter().filter(is_shown).map(called).collect();
                let of = light.map_or_else(String::new, |light| format!(" of {}", numbers::light(light)));
                let there = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
                self.fail(&format!("no pass{of} is called `{name}`: there are {there}"))
            }
        }
    }

    /// Panics with `what`, preceded by scene, technique and pixel and followed by the pixel's history as text.
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
