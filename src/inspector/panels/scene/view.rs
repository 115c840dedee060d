//! The state of the Scene tab: its views, what they show, and their geometry.

use super::lens::{LensProjection, PaneView};
use super::stage::{self, SceneStage};
use super::toggles::{SceneToggles, VolumeFilter};
use crate::anatomy::Anatomy;
use crate::inspector::canvas::handles::HandleKind;
use crate::inspector::look::theme;
use crate::scene::{self, Camera};
use crate::viewport::ViewportShape;
use glam::DVec3;
use std::sync::Arc;

/// Height of a view of the whole scene, as a multiple of its radius.
const MARGIN: f64 = 2.1;

named_enum! {
    /// One of the four views of the scene, in the order of their rows.
    pub enum Pane {
        /// Seen from above.
        Top = "Top",
        /// Rotated by the user.
        Free = "Free",
        /// Seen along −z.
        Front = "Front",
        /// Seen along −x.
        Right = "Right",
    }
}

impl Pane {
    fn first_view(self) -> PaneView {
        let (yaw, pitch, projection) = match self {
            Pane::Free => (0.0, 0.0, LensProjection::Perspective),
            Pane::Top => (0.0, 90.0, LensProjection::Orthographic),
            Pane::Front => (0.0, 0.0, LensProjection::Orthographic),
            Pane::Right => (90.0, 0.0, LensProjection::Orthographic),
        };
        PaneView { center: DVec3::ZERO, height: 10.0, yaw, pitch, fov_y: 40.0, projection, oblique: 45.0 }
    }
}

/// Whether one view of the scene is shown, or all four.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PaneLayout {
    /// One view.
    One(Pane),
    /// All four views.
    Four,
}

/// The state of the Scene tab.
#[derive(Debug)]
pub struct SceneView {
    pub layout: PaneLayout,
    pub views: [PaneView; 4],
    /// What was drawn of each last.
    pub drawn: [ViewportShape; 4],
    /// The views already show the whole scene of this name.
    pub fitted: bool,
    pub shown: SceneToggles,
    pub choice: VolumeFilter,
    /// While the stop of a tour shows one volume: whose, and what the user chose before.
    choice_before: Option<(String, VolumeFilter)>,
    /// Lights and camera have handles.
    pub gizmos: bool,
    /// Objects have handles too.
    pub moves_objects: bool,
    /// The handle whose axes are shown.
    pub grip: Option<HandleKind>,
    /// The history's selected triangle is to be brought to the middle.
    pub wants_triangle: bool,
    /// The scene of this state, as the number of scenes opened.
    scenes_opened: u64,
    built: Option<Arc<BuiltStage>>,
}

impl Default for SceneView {
    fn default() -> SceneView {
        SceneView {
            layout: PaneLayout::One(Pane::Free),
            views: Pane::ALL.map(Pane::first_view),
            drawn: Default::default(),
            fitted: false,
            shown: SceneToggles::default(),
            choice: VolumeFilter::default(),
            choice_before: None,
            gizmos: true,
            moves_objects: false,
            grip: None,
            wants_triangle: false,
            scenes_opened: 0,
            built: None,
        }
    }
}

/// The built geometry of the views, with the inputs that it was built from.
#[derive(Debug)]
pub struct BuiltStage {
    /// What is shown.
    pub anatomy: Arc<Anatomy>,
    shown: SceneToggles,
    choice: VolumeFilter,
    is_dark: bool,
    /// Its geometry.
    pub stage: SceneStage,
}

impl SceneView {
    /// Resets what belongs to a scene, when another one is open: the choice of light and caster, the chosen handle and
    /// the geometry; the views are fitted again. Layout and switches stay.
    fn forget(&mut self) {
        self.fitted = false;
        self.choice = VolumeFilter::default();
        self.choice_before = None;
        self.grip = None;
        self.built = None;
    }

    /// Resets what belongs to another scene than the one that was opened last, given as the number of scenes opened;
    /// does nothing where that is the same.
    pub fn follow(&mut self, scenes_opened: u64) {
        if std::mem::replace(&mut self.scenes_opened, scenes_opened) != scenes_opened {
            self.forget();
        }
    }

    /// Shows the volume of the caster of this name alone, from all lights, until a call with another name or without one,
    /// which gives back what was chosen before; what is chosen meanwhile stays until then. A name that no caster has shows all.
    pub fn show_volume_of(&mut self, caster: Option<&str>, anatomy: &Anatomy) {
        let before = self.choice_before.take();
        match (caster, before) {
            (None, None) => {}
            (None, Some((_, before))) => self.choice = before,
            (Some(name), Some((shown, before))) if shown == name => self.choice_before = Some((shown, before)),
            (Some(name), before) => {
                let caster = anatomy.objects.iter().position(|object| object.casts && object.name == name);
                let before = before.map_or(self.choice, |(_, before)| before);
                self.choice = VolumeFilter { light: None, caster };
                self.choice_before = Some((name.to_owned(), before));
            }
        }
    }

    /// Brings the history's selected triangle to the middle when the tab is drawn next.
    pub fn go_to_triangle(&mut self) {
        self.wants_triangle = true;
        self.shown.rays = true;
    }

    pub fn view_mut(&mut self, pane: Pane) -> &mut PaneView {
        &mut self.views[index_of(pane)]
    }

    /// Sets every view to its initial direction and size, which shows the whole scene; the free view looks over the
    /// camera's shoulder. Each view's projection stays.
    pub fn reset(&mut self, anatomy: &Anatomy) {
        let (middle, radius) = stage::framed(anatomy, &stage::holders(anatomy));
        for pane in Pane::ALL {
            let previous = *self.view_mut(pane);
            let mut view = PaneView { projection: previous.projection, oblique: previous.oblique, ..pane.first_view() };
            view.center = middle;
            view.height = MARGIN * radius;
            if pane == Pane::Free {
                // Over the camera's shoulder, so that the user sees what it sees.
                (view.yaw, view.pitch) = angles(&anatomy.camera);
                view.orbit(-38.0, 0.0);
                view.pitch = 24.0;
            }
            *self.view_mut(pane) = view;
        }
        self.fitted = true;
    }

    /// Shows the free view alone, from the camera's eye and with its projection; a camera that is rolled is shown
    /// upright, an oblique one as cavalier or cabinet, whichever is nearer, and an off-centre one by a view as high as holds
    /// its picture.
    pub fn see_from(&mut self, camera: &Camera) {
        let view = self.view_mut(Pane::Free);
        (view.yaw, view.pitch) = angles(camera);
        view.projection = match camera.projection {
            scene::Projection::Perspective | scene::Projection::Frustum { .. } => LensProjection::Perspective,
            scene::Projection::Orthographic { .. } => LensProjection::Orthographic,
            // The nearer of the two oblique projections of a view.
            scene::Projection::Oblique { factor, .. } if factor > 0.75 => LensProjection::Cavalier,
            scene::Projection::Oblique { .. } => LensProjection::Cabinet,
        };
        if let scene::Projection::Oblique { angle_degrees, .. } = camera.projection {
            view.oblique = angle_degrees;
        }
        view.center = camera.target;
        view.fov_y = camera.fov_y_degrees;
        view.height = 2.0 * camera.half_height_at_target();
        if let scene::Projection::Frustum { .. } = camera.projection {
            // A view's middle is on its axis: as high as it must be to hold all of an off-centre picture.
            let half = camera.half_height() + camera.center().y.abs();
            view.fov_y = (2.0 * half.atan()).to_degrees();
            view.height = 2.0 * half * camera.eye.distance(camera.target);
        }
        self.layout = PaneLayout::One(Pane::Free);
    }

    /// Returns the geometry of the views, built anew only where anatomy, switches, choice or theme have changed since
    /// the last call.
    pub fn stage(&mut self, anatomy: &Arc<Anatomy>, theme: &theme::Theme) -> Arc<BuiltStage> {
        let is_dark = *theme == theme::DARK;
        if let Some(built) = &self.built
            && Arc::ptr_eq(&built.anatomy, anatomy)
            && (built.shown, built.choice, built.is_dark) == (self.shown, self.choice, is_dark)
        {
            return built.clone();
        }
        let stage = SceneStage::new(anatomy, &self.shown, self.choice, theme);
        let anatomy = anatomy.clone();
        let built = Arc::new(BuiltStage { anatomy, shown: self.shown, choice: self.choice, is_dark, stage });
        self.built = Some(built.clone());
        built
    }
}

/// Returns a view's index in [`Pane::ALL`].
pub fn index_of(pane: Pane) -> usize {
    Pane::ALL.iter().position(|one| *one == pane).unwrap_or_default()
}

/// Returns the yaw and pitch of a camera, in degrees, as in [`PaneView`]: yaw 0 looks along −z, and a positive pitch
/// looks down.
fn angles(camera: &Camera) -> (f64, f64) {
    let ahead = (camera.target - camera.eye).normalize_or_zero();
    ((-ahead.x).atan2(-ahead.z).to_degrees(), (-ahead.y).clamp(-1.0, 1.0).asin().to_degrees())
}
