//! The Scene tab: a free second camera that sees the first one, with all that shadows are made of.
//!
//! ```text
//! Anatomy ──► stage.rs (faces, lines; once a frame) ──► paint.rs (sorted; once a view) ──► egui mesh
//! lens.rs     projections, world to screen        pane.rs     one view: mouse, keys, what is on top
//! bar.rs      the toolbar and the legend          rays.rs     the pick's rays, the selected triangle
//! gizmos.rs   lights and camera as handles    walls.rs    what all else is behind or before
//! far_end.rs  where volumes that have no end are ended   coarse.rs  large meshes as fewer triangles
//! ```
//!
//! No GPU code: everything is sorted and projected on the CPU, and only when something changed.

mod bar;
mod coarse;
mod far_end;
mod gizmos;
mod lens;
mod paint;
mod pane;
mod rays;
mod stage;
mod walls;

use coarse::Coarsened;
pub use gizmos::{Anchor, Grip, arrows, grabbed, moved_light, place_of_light};
use lens::{PaneView, Projection};
pub use pane::plate;

use super::action::Action;
use super::state::State;
use super::theme;
use crate::anatomy::Anatomy;
use crate::scene::Camera;
use egui::{CornerRadius, Mesh, Rect, Ui, vec2};
use glam::DVec3;
use stage::{Choice, Stage, Toggles};
use std::sync::Arc;

/// Width of the legend beside the views, points.
const LEGEND_WIDTH: f32 = 164.0;
/// Narrower than this the legend is left out.
const LEAST_WIDTH: f32 = 420.0;

/// One of the views.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pane {
    /// Turned by hand.
    Free,
    /// From above.
    Top,
    /// Along −z.
    Front,
    /// Along −x.
    Right,
}

impl Pane {
    /// As laid out in rows.
    pub const ALL: [Pane; 4] = [Pane::Top, Pane::Free, Pane::Front, Pane::Right];

    /// On buttons and in names of widgets.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Pane::Free => "Free",
            Pane::Top => "Top",
            Pane::Front => "Front",
            Pane::Right => "Right",
        }
    }

    fn first_view(self) -> PaneView {
        let (yaw, pitch, projection) = match self {
            Pane::Free => (0.0, 0.0, Projection::Perspective),
            Pane::Top => (0.0, 90.0, Projection::Orthographic),
            Pane::Front => (0.0, 0.0, Projection::Orthographic),
            Pane::Right => (90.0, 0.0, Projection::Orthographic),
        };
        PaneView { center: DVec3::ZERO, height: 10.0, yaw, pitch, fov_y: 40.0, projection, oblique: 45.0 }
    }
}

/// Which views are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One.
    One(Pane),
    /// All four.
    Four,
}

/// What the Scene tab remembers.
#[derive(Debug)]
pub struct SceneView {
    layout: Layout,
    views: [PaneView; 4],
    /// The views show the whole scene of this name already.
    fitted: bool,
    shown: Toggles,
    choice: Choice,
    /// Lights and camera have handles.
    gizmos: bool,
    /// The handle whose axes are shown.
    grip: Option<Grip>,
    /// The history's selected triangle is to be in the middle.
    wants_triangle: bool,
    built: Option<Built>,
    coarsened: Coarsened,
    painted: [Option<Painted>; 4],
}

impl Default for SceneView {
    fn default() -> SceneView {
        SceneView {
            layout: Layout::One(Pane::Free),
            views: Pane::ALL.map(Pane::first_view),
            fitted: false,
            shown: Toggles::default(),
            choice: Choice::default(),
            gizmos: true,
            grip: None,
            wants_triangle: false,
            built: None,
            coarsened: Coarsened::default(),
            painted: [const { None }; 4],
        }
    }
}

/// A stage and what it is of.
#[derive(Debug)]
struct Built {
    anatomy: Arc<Anatomy>,
    shown: Toggles,
    choice: Choice,
    is_dark: bool,
    stage: Arc<Stage>,
}

/// A painted view and what it is of.
#[derive(Debug)]
struct Painted {
    stage: Arc<Stage>,
    view: PaneView,
    rect: Rect,
    mesh: Arc<Mesh>,
}

impl SceneView {
    /// Another scene is open: it is looked at as a whole.
    pub fn forget(&mut self) {
        self.fitted = false;
        self.choice = Choice::default();
        self.grip = None;
        self.built = None;
        self.painted = [const { None }; 4];
    }

    /// Brings the history's selected triangle to the middle when the tab is drawn next.
    pub fn go_to_triangle(&mut self) {
        self.wants_triangle = true;
        self.shown.rays = true;
    }

    fn view_mut(&mut self, pane: Pane) -> &mut PaneView {
        &mut self.views[index_of(pane)]
    }

    /// Every view as first shown: all of the scene.
    fn reset(&mut self, anatomy: &Anatomy) {
        let (middle, radius) = stage::sphere(anatomy, &stage::holders(anatomy));
        for pane in Pane::ALL {
            let kept = *self.view_mut(pane);
            let mut view = PaneView { projection: kept.projection, oblique: kept.oblique, ..pane.first_view() };
            view.center = middle;
            view.height = 2.1 * radius;
            if pane == Pane::Free {
                // Over the camera's shoulder, so that one sees what it sees.
                (view.yaw, view.pitch) = angles(&anatomy.camera);
                view.orbit(-38.0, 0.0);
                view.pitch = 24.0;
                view.height = 2.0 * radius;
            }
            *self.view_mut(pane) = view;
        }
        self.fitted = true;
    }

    /// The free view becomes the camera's; a camera that is rolled is seen upright.
    fn see_from(&mut self, camera: &Camera) {
        let view = self.view_mut(Pane::Free);
        (view.yaw, view.pitch) = angles(camera);
        view.projection = Projection::Perspective;
        view.center = camera.target;
        view.fov_y = camera.fov_y_degrees;
        let distance = (camera.target - camera.eye).length();
        view.height = 2.0 * distance * (camera.fov_y_degrees.to_radians() / 2.0).tan();
        self.layout = Layout::One(Pane::Free);
    }

    fn stage(&mut self, anatomy: &Arc<Anatomy>, theme: &theme::Theme) -> Arc<Stage> {
        let is_dark = *theme == theme::DARK;
        if let Some(built) = &self.built
            && Arc::ptr_eq(&built.anatomy, anatomy)
            && (built.shown, built.choice, built.is_dark) == (self.shown, self.choice, is_dark)
        {
            return built.stage.clone();
        }
        let stage = Arc::new(Stage::new(anatomy, &self.shown, self.choice, theme, &mut self.coarsened));
        let (anatomy, stage_too) = (anatomy.clone(), stage.clone());
        self.built = Some(Built { anatomy, shown: self.shown, choice: self.choice, is_dark, stage: stage_too });
        stage
    }

    fn painted(&mut self, stage: &Arc<Stage>, pane: Pane, rect: Rect) -> Arc<Mesh> {
        let view = *self.view_mut(pane);
        let slot = &mut self.painted[index_of(pane)];
        if let Some(painted) = slot
            && Arc::ptr_eq(&painted.stage, stage)
            && painted.view == view
            && painted.rect == rect
        {
            return painted.mesh.clone();
        }
        let mesh = paint::paint(stage, &view.lens(rect), rect);
        *slot = Some(Painted { stage: stage.clone(), view, rect, mesh: mesh.clone() });
        mesh
    }
}

fn index_of(pane: Pane) -> usize {
    Pane::ALL.iter().position(|one| *one == pane).unwrap_or_default()
}

/// Yaw and pitch of a camera, degrees.
fn angles(camera: &Camera) -> (f64, f64) {
    let ahead = (camera.target - camera.eye).normalize_or_zero();
    ((-ahead.x).atan2(-ahead.z).to_degrees(), (-ahead.y).clamp(-1.0, 1.0).asin().to_degrees())
}

/// Draws the panel.
pub fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    if let Some(words) = missing(state) {
        return empty(ui, words);
    }
    let Some(anatomy) = state.anatomy.want() else {
        let failed = state.anatomy.failed().map(ToOwned::to_owned);
        let words = failed.map_or_else(
            || ["Looking at the scene's geometry…".to_owned(), String::new()],
            |reason| ["The scene's geometry can't be shown.".to_owned(), reason],
        );
        return empty(ui, words);
    };
    let is_of_frame = state.anatomy.is_of_frame();
    // Taken out, as the views need the rest of the state too.
    let mut view = std::mem::take(&mut state.scene_view);
    if !view.fitted {
        view.reset(&anatomy);
    }
    bar::toolbar(ui, &mut view, &anatomy);
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::of(ui).background);
    let stage = view.stage(&anatomy, theme::of(ui));
    if std::mem::take(&mut view.wants_triangle)
        && let Some(middle) = rays::middle_of_selected(state, &stage, &anatomy)
    {
        view.views.iter_mut().for_each(|one| one.center = middle);
    }
    let views = if rect.width() < LEAST_WIDTH {
        rect
    } else {
        let (legend, views) = rect.split_left_right_at_x(rect.left() + LEGEND_WIDTH);
        bar::legend(ui, &mut view, (&anatomy, is_of_frame), &stage, legend);
        views
    };
    match view.layout {
        Layout::One(pane) => pane::ui(ui, state, &mut view, &anatomy, &stage, (pane, views), actions),
        Layout::Four => {
            for (index, pane) in Pane::ALL.into_iter().enumerate() {
                let size = views.size() / 2.0;
                let corner = vec2((index % 2) as f32 * size.x, (index / 2) as f32 * size.y);
                let rect = Rect::from_min_size(views.min + corner, size);
                pane::ui(ui, state, &mut view, &anatomy, &stage, (pane, rect), actions);
            }
        }
    }
    state.scene_view = view;
}

/// Why there is nothing to see, and what to do.
fn missing(state: &State) -> Option<[String; 2]> {
    let own = |words: [&str; 2]| Some(words.map(ToOwned::to_owned));
    match (&state.capture, &state.scene, &state.job) {
        (None, _, Some(job)) => own([job, ""]),
        (None, _, None) => own(["Nothing is open yet.", "Press Open…, or drop a scene or a model here."]),
        (Some(_), None, _) => own([
            "Opened from a folder: its geometry is not known.",
            "Open the scene instead, with Open… or by dropping its file here.",
        ]),
        _ => None,
    }
}

fn empty(ui: &mut Ui, [heading, note]: [String; 2]) {
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::of(ui).background);
    let middle = Rect::from_center_size(rect.center(), vec2(rect.width().min(420.0), 60.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(middle), |ui| {
        ui.vertical_centered(|ui| {
            theme::heading(ui, &heading);
            ui.label(theme::note(note));
        });
    });
}
