//! The Scene tab: a free second camera that sees the first one, with all geometry of its shadows.
//!
//! ```text
//! Anatomy ──► stage.rs (faces, lines; once a frame) ──► viewport.rs (on the window's GPU; once a view) ──► picture
//! lens.rs     projections, world to screen        pane.rs     one view: mouse, keys, what is on top
//! bar.rs      the toolbar and the legend          rays.rs     the pick's rays, the selected triangle
//! gizmos.rs   lights and camera as handles        label_places.rs  labels that lie over no other
//! ```
//!
//! Without a renderer only labels, rays and handles are drawn, and all widgets are there.

mod bar;
mod gizmos;
mod label_places;
mod lens;
mod pane;
mod rays;
mod stage;
mod toggles;
mod view;

pub use view::SceneView;
use view::{Pane, PaneLayout};

use crate::ask::AnatomyOf;
use crate::inspector::action::Action;
use crate::inspector::canvas;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::shadow_casters;
use egui::{Rect, Ui, vec2};

/// Width of the legend beside the views, points.
const LEGEND_WIDTH: f32 = 164.0;
/// In a narrower panel the legend is left out, points.
const LEAST_WIDTH: f32 = 380.0;

/// Draws the panel Scene: views of the scene in space with its lights, frusta and shadow volumes. While the geometry of
/// a frame is not known, that of the frame before; where there is none, the reason.
pub fn ui(ui: &mut Ui, view: &mut SceneView, model: &mut Model, actions: &mut Vec<Action>) {
    view.follow(model.scenes_opened);
    if let Some(words) = missing(model) {
        return empty(ui, words);
    }
    let reply = model.answers.want(AnatomyOf {});
    let Some(anatomy) = reply.latest().filter(|_| reply.failed.is_none()) else {
        let words = reply.failed.map_or_else(
            || ["Looking at the scene's geometry…".to_owned(), String::new()],
            |reason| ["The scene's geometry can't be shown.".to_owned(), reason],
        );
        return empty(ui, words);
    };
    if !view.fitted {
        view.reset(anatomy);
    }
    view.show_volume_of(volume_of(model).as_deref(), anatomy);
    bar::toolbar(ui, view, anatomy);
    let rect = ui.available_rect_before_wrap();
    canvas::background(ui, rect, None);
    if std::mem::take(&mut model.requests.triangle_in_scene) {
        view.go_to_triangle();
    }
    let built = view.stage(anatomy, theme::of(ui));
    if std::mem::take(&mut view.wants_triangle)
        && let Some(middle) = rays::middle_of_selected(model, &built.stage, anatomy)
    {
        view.views.iter_mut().for_each(|one| one.center = middle);
    }
    let views = if rect.width() < LEAST_WIDTH {
        rect
    } else {
        let (legend, views) = rect.split_left_right_at_x(rect.left() + LEGEND_WIDTH);
        bar::legend(ui, view, model, anatomy, reply.ready.is_some(), &built.stage, legend);
        views
    };
    match view.layout {
        PaneLayout::One(pane) => pane::ui(ui, model, view, &built, pane, views, actions),
        PaneLayout::Four => {
            for (index, pane) in Pane::ALL.into_iter().enumerate() {
                let size = views.size() / 2.0;
                let corner = vec2((index % 2) as f32 * size.x, (index / 2) as f32 * size.y);
                let rect = Rect::from_min_size(views.min + corner, size);
                pane::ui(ui, model, view, &built, pane, rect, actions);
            }
        }
    }
}

/// Returns whose volume alone the stop of a tour shows: that in which the picked pixel lies, so that its ray, which is drawn
/// too, meets it; where that is not known, the one that the stop names. `None` where no stop shows one.
fn volume_of(model: &Model) -> Option<String> {
    let named = model.tour_focus.and_then(|focus| focus.volume_of)?;
    let capture = model.frame.capture.as_ref();
    let at = model.selection.pick;
    let history = model.history_of_frame().filter(|history| Some(history.pixel) == at);
    let of_pick = history.zip(capture).zip(at).and_then(|((history, capture), at)| {
        let light = model.light_in_question(capture, at);
        shadow_casters::casters(&history, light, &capture.depth).into_iter().next()
    });
    Some(of_pick.unwrap_or_else(|| named.to_owned()))
}

/// Returns, as heading and remedy, why there is no geometry to show; `None` where a capture is shown whose geometry can
/// be asked for.
fn missing(model: &Model) -> Option<[String; 2]> {
    let own = |words: [&str; 2]| Some(words.map(ToOwned::to_owned));
    match (&model.frame.capture, &model.scene, &model.activity.job) {
        (None, _, Some(job)) => own([job, ""]),
        (None, _, None) => own(["Nothing is open yet.", "Press Open…, or drop a scene or a model here."]),
        (Some(_), None, _) if !model.can_ask() => own([
            "Opened from a folder: its geometry is not known.",
            "Open the scene instead, with Open… or by dropping its file here.",
        ]),
        _ => None,
    }
}

fn empty(ui: &mut Ui, [heading, note]: [String; 2]) {
    let rect = ui.available_rect_before_wrap();
    canvas::background(ui, rect, None);
    let middle = Rect::from_center_size(rect.center(), vec2(rect.width().min(420.0), 60.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(middle), |ui| {
        ui.vertical_centered(|ui| {
            theme::heading(ui, &heading);
            ui.label(theme::note(note));
        });
    });
}
