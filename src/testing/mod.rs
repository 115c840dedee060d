//! Readback tests of shadows: render a scene or a plan, then assert on stencil, count, depth, colour, label
//! and history of a pixel, and on what a shadow map stores there. A failed assertion panics with the
//! pixel's history, so that the log of a CI run says what happened to it.
//!
//! Runs without a window on whatever adapter there is; Debian's `mesa-vulkan-drivers` brings a
//! software one whose results are the same on every machine.
//!
//! ```
//! use stencilscope::scene::builtin::Builtin;
//! use stencilscope::technique::{Choice, Technique};
//! use stencilscope::testing::{PixelLabel, Rendered};
//!
//! let scene = Builtin::named("tetrahedron").expect("a name").scene()?;
//! let mut frame = Rendered::new(&scene, Choice::new(Technique::ZFail), [320, 240])?;
//!
//! // The middle of the picture shows the tetrahedron, 3.4 m away; volumes cancel out there.
//! frame.at([160, 120]).stencil_after("volumes", 0).distance(3.395, 0.01);
//!
//! // Inside its shadow: the side it is entered through, then the far end.
//! let shadowed = frame.first_labelled(0, PixelLabel::Shadow).expect("a shadow");
//! frame.at(shadowed).label(0, PixelLabel::Shadow).agrees();
//! assert!(frame.at(shadowed).history().events.iter().any(|event| event.is_of_volume()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A point of the scene is found in the picture with [`Rendered::at_point`], and in a light's map with
//! [`Rendered::map_texel_of`]. With several lights, say which one is meant: [`Pixel::stencil_of`],
//! [`Pixel::events_of_light`].
//!
//! Scenes of your own are quickly made with [`SceneBuilder`](crate::scene::SceneBuilder), and a plan with one thing
//! changed is rendered by [`Rendered::of_plan`].

mod pixel;
mod places;

pub use crate::truth::PixelLabel;
pub use pixel::Pixel;
pub use places::ShadowMapTexel;

use crate::capture::Capture;
use crate::plan::FramePlan;
use crate::scene::Scene;
use crate::session::{CaptureRequest, Session, SessionError};
use crate::technique::Choice;
use glam::{DVec2, DVec3};
use places::CameraProjection;

/// A scene that was rendered, with its capture, whose pixels can be asserted on.
#[derive(Debug)]
pub struct Rendered {
    session: Session,
    plan: FramePlan,
    capture: Capture,
}

impl Rendered {
    /// Renders `scene` on the best adapter there is, with a picture of `size` pixels.
    pub fn new(scene: &Scene, choice: Choice, size: [u32; 2]) -> Result<Rendered, SessionError> {
        Rendered::on(Session::new(None)?, scene, &CaptureRequest::new(choice, size))
    }

    /// Renders `scene` on a session of your own, which [`Rendered::into_session`] returns.
    pub fn on(mut session: Session, scene: &Scene, request: &CaptureRequest) -> Result<Rendered, SessionError> {
        let (capture, plan) = session.capture_with_plan(scene, request)?;
        Ok(Rendered { session, plan, capture })
    }

    /// Runs a plan as it is, such as a good one with one thing changed, or that of a technique of your own.
    ///
    /// ```
    /// use stencilscope::plan::DrawPart;
    /// use stencilscope::scene::builtin::Builtin;
    /// use stencilscope::session::{CaptureRequest, Session};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::{PixelLabel, Rendered};
    ///
    /// let scene = Builtin::named("tetrahedron").expect("a name").scene()?;
    /// let request = CaptureRequest::new(Choice::new(Technique::ZFail), [320, 240]);
    /// let mut session = Session::new(None)?;
    /// let mut plan = session.plan(&scene, &request)?;
    ///
    /// // Without light caps the volume is open, and the tetrahedron itself is in shadow.
    /// plan.passes.iter_mut().for_each(|pass| pass.draws.retain(|draw| draw.part != DrawPart::LightCap));
    /// let mut broken = Rendered::of_plan(session, &scene, plan)?;
    /// broken.at([160, 120]).label(0, PixelLabel::Shadow).agrees();
    ///
    /// let mut whole = Rendered::on(broken.into_session(), &scene, &request)?;
    /// whole.at([160, 120]).label(0, PixelLabel::Lit).agrees();
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_plan(mut session: Session, scene: &Scene, plan: FramePlan) -> Result<Rendered, SessionError> {
        let capture = session.capture_plan(scene, &plan)?;
        Ok(Rendered { session, plan, capture })
    }

    /// Returns a frame that another program drew: from `record`, an import, or a capture folder. Its world is that of
    /// its clip space, so that assertions are about pixels, not about points.
    pub fn recorded(plan: FramePlan, capture: Capture) -> Result<Rendered, SessionError> {
        Ok(Rendered { session: Session::new(None)?, plan, capture })
    }

    /// Returns the session, for the next scene.
    pub fn into_session(self) -> Session {
        self.session
    }

    /// Returns the capture: everything that the frame left.
    pub fn capture(&self) -> &Capture {
        &self.capture
    }

    /// Returns the frame as data.
    pub fn plan(&self) -> &FramePlan {
        &self.plan
    }

    /// Returns a pixel to assert on, with its history computed: column and row from the top left.
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

    /// Returns the pixel that shows a point of the world, or what hides it: column and row from the top left; `None`
    /// where the point is outside of the picture, or nearer than the near plane.
    pub fn pixel_of(&self, point: impl Into<DVec3>) -> Option<[u32; 2]> {
        let (view, camera) = (CameraProjection::of(&self.capture), &self.capture.camera);
        let (at, distance) = view.pixel_and_distance(point.into());
        let is_inside = at.cmpge(DVec2::ZERO).all() && at.cmplt(view.size).all();
        let is_in_reach = distance >= camera.near && camera.far.is_none_or(|far| distance <= far);
        (is_inside && is_in_reach).then_some([at.x as u32, at.y as u32])
    }

    /// Returns the pixel that shows a point of the world, to assert on.
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
    /// let mut frame = Rendered::new(&scene, Choice::new(Technique::ZFail), [65, 65])?;
    /// // Under the board, and beside it.
    /// frame.at_point([0.3, 0.0, 0.3]).label(0, PixelLabel::Shadow);
    /// frame.at_point([0.7, 0.0, 0.3]).label(0, PixelLabel::Lit);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// If it is outside of the picture, or hidden by what is before it.
    #[track_caller]
    pub fn at_point(&mut self, point: impl Into<DVec3>) -> Pixel<'_> {
        let point = point.into();
        let Some(pixel) = self.pixel_of(point) else {
            panic!("{}: the point {point} is outside of the picture", self.capture.scene)
        };
        let shown = self.at(pixel);
        shown.reveals(point);
        shown
    }

    /// Returns where a point of the world falls into a light's shadow map; `None` where there is no such map, or it
    /// does not show the point.
    ///
    /// ```
    /// use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
    /// use stencilscope::technique::{Choice, Technique};
    /// use stencilscope::testing::Rendered;
    ///
    /// let scene = SceneBuilder::new("a board over a floor")
    ///     .object(Object::of("floor", shapes::quad([8.0; 2])?))
    ///     .object(Object::of("board", shapes::quad([1.0; 2])?).at([0.0, 1.0, 0.0]).unseen())
    ///     .light(Light::point([0.0, 4.0, 0.0]))
    ///     .seen_from([0.0, 5.0, 0.0], [0.0; 3])
    ///     .build();
    /// let frame = Rendered::new(&scene, Choice::new(Technique::ShadowMap), [65, 65])?;
    /// // The map shows the board, a metre nearer to the light than this point of the floor.
    /// let texel = frame.map_texel_of(0, [0.1, 0.0, 0.1]).expect("the map shows it");
    /// assert!((texel.gap.expect("metres") - 1.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map_texel_of(&self, light: usize, point: impl Into<DVec3>) -> Option<ShadowMapTexel> {
        places::texel_of(&self.capture, light, point.into())
    }

    /// Returns the first pixel (column, row), row by row from the top, that has this label under a light (index from
    /// 0); `None` where there is none, or no such light or mask.
    pub fn first_labelled(&self, light: usize, label: PixelLabel) -> Option<[u32; 2]> {
        let labels = self.capture.lights.get(light)?.shadow.as_ref()?;
        let find = |(y, row): (u32, &[u8])| {
            let x = row.iter().position(|byte| *byte == label as u8)?;
            Some([x as u32, y])
        };
        (0..).zip(labels.rows()).find_map(find)
    }
}
