//! One view: mouse and keys rotate, move and scale it; labels, rays and handles are drawn over the stage.

use super::gizmos::GizmoView;
use super::lens::{Lens, LensProjection};
use super::stage::SceneStage;
use super::view::{BuiltStage, Pane, SceneView, index_of};
use super::{gizmos, rays};
use crate::inspector::action::Action;
use crate::inspector::canvas::map_handles::MapHandles;
use crate::inspector::look::number_field::number_field;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{keep_arrows, plate};
use crate::inspector::model::Model;
use crate::viewport::ViewportDrawing;
use egui::{
    Align2, CornerRadius, Key, PointerButton, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, vec2,
};

/// Degrees of rotation for each point of dragging.
const TURN: f64 = 0.4;
/// Degrees that an arrow key rotates, and how far it moves, as a share of the view's height.
const KEY_TURN: f64 = 5.0;
const KEY_MOVE: f32 = 0.05;
/// How much one point of wheel movement scales, as a power of e.
const WHEEL_ZOOM: f32 = 0.004;
const KEY_ZOOM: f64 = 1.15;
/// An edge's multiplicity is written where the edge is at least so long on the screen, points.
const LEAST_EDGE: f32 = 44.0;

/// Draws one view of the scene into `rect`: geometry, rays, labels, handles, name and choice of projection; and
/// navigates it by mouse and keys.
pub fn ui(
    ui: &mut Ui,
    model: &mut Model,
    view: &mut SceneView,
    built: &BuiltStage,
    pane: Pane,
    rect: Rect,
    actions: &mut Vec<Action>,
) {
    let BuiltStage { anatomy, stage, .. } = built;
    let response = ui.interact(rect, ui.scope_id().with(("scene view", pane.name())), Sense::click_and_drag());
    let name = format!("{} view of the scene", pane.name());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, &name));
    navigate(ui, view, pane, &response);
    let lens = view.view_mut(pane).lens(rect);
    let painter = ui.painter_at(rect);
    let drawing = ViewportDrawing {
        geometry: stage.geometry.clone(),
        view: lens.on_gpu(stage.middle, stage.reach),
        rect,
        slot: index_of(pane),
        moves: ui.input(|input| input.pointer.any_down()),
    };
    painter.add(view.drawn[index_of(pane)].of(drawing));
    if view.shown.rays {
        rays::ui(ui, model, view.choice, stage, anatomy, &lens, rect);
    }
    labels(ui, stage, &lens, rect);
    let shows_maps = view.gizmos && view.shown.frusta && !anatomy.is_view_assumed;
    let draft = model.scene.as_ref().filter(|_| shows_maps).map(|scene| &scene.draft.choice);
    let maps = draft.map_or_else(Vec::new, |choice| MapHandles::all(anatomy, choice, stage.radius));
    // A handle under the name or the choice of projection could not be had.
    title(ui, view, pane, rect);
    gizmos::ui(ui, model, view, anatomy, &GizmoView::new(pane, &lens, rect, stage, maps), actions);
    let outline = if response.has_focus() { theme::of(ui).focus } else { theme::of(ui).line };
    painter.rect_stroke(rect, CornerRadius::ZERO, Stroke::new(1.0, outline), StrokeKind::Inside);
}

/// Draws a view's name and the choice of its projection, with the angle where that is oblique, along the top of `rect`.
fn title(ui: &mut Ui, view: &mut SceneView, pane: Pane, rect: Rect) {
    let strip = Rect::from_min_size(rect.min + vec2(6.0, 4.0), vec2((rect.width() - 12.0).max(1.0), theme::ROW_HEIGHT));
    ui.scope_builder(UiBuilder::new().max_rect(strip).id_salt(("view title", pane.name())), |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            // It has to be readable over whatever is drawn below it.
            let ground = egui::Frame::new().fill(theme::of(ui).background.gamma_multiply(0.8)).corner_radius(2);
            ground.inner_margin(egui::Margin::symmetric(4, 2)).show(ui, |ui| {
                ui.label(egui::RichText::new(pane.name()).color(theme::of(ui).text));
            });
            let shown = view.view_mut(pane);
            let combo = egui::ComboBox::from_id_salt(("projection", pane.name())).width(96.0);
            let combo = combo.selected_text(shown.projection.name()).show_ui(ui, |ui| {
                for projection in LensProjection::ALL {
                    let choice = ui.selectable_value(&mut shown.projection, projection, projection.name());
                    choice.on_hover_text(projection.meaning());
                }
            });
            combo.response.accessible_name(format!("Projection of the {} view", pane.name()));
            if shown.projection.is_oblique() {
                let angle = number_field(&mut shown.oblique, 30.0..=45.0, |widget| {
                    widget.speed(0.2).max_decimals(1).suffix("°")
                });
                let response = ui.add(angle).accessible_name(format!("Angle of the {} view", pane.name()));
                response.on_hover_text("At which angle depth is drawn");
            }
        });
    });
}

fn navigate(ui: &Ui, view: &mut SceneView, pane: Pane, response: &Response) {
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let rect = response.rect;
    let shown = view.view_mut(pane);
    let turns = pane == Pane::Free;
    let shift = ui.input(|input| input.modifiers.shift);
    let by = response.drag_delta();
    let lens = shown.lens(rect);
    let is_left = response.dragged_by(PointerButton::Primary);
    if by != egui::Vec2::ZERO && is_left && turns && !shift {
        shown.orbit(-f64::from(by.x) * TURN, f64::from(by.y) * TURN);
    } else if by != egui::Vec2::ZERO && response.dragged() {
        shown.center -= lens.moved(shown.center, by);
    }
    if response.contains_pointer() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = (-scroll * WHEEL_ZOOM).exp() / pinch;
        if factor != 1.0 {
            shown.zoom(f64::from(factor));
        }
    }
    if !response.has_focus() {
        return;
    }
    keep_arrows(ui, response);
    let (right, up, scale) = ui.input(|input| {
        let presses = |key| input.num_presses(key) as i32;
        let closer = presses(Key::Plus) + presses(Key::Equals) - presses(Key::Minus);
        (presses(Key::ArrowRight) - presses(Key::ArrowLeft), presses(Key::ArrowUp) - presses(Key::ArrowDown), closer)
    });
    if scale != 0 {
        shown.zoom(KEY_ZOOM.powi(-scale));
    }
    if (right, up) == (0, 0) {
        return;
    }
    if turns && !shift {
        shown.orbit(-f64::from(right) * KEY_TURN, f64::from(up) * KEY_TURN);
    } else {
        let step = rect.height() * KEY_MOVE;
        shown.center += lens.moved(shown.center, vec2(right as f32, -up as f32) * step);
    }
}

fn labels(ui: &Ui, stage: &SceneStage, lens: &Lens, rect: Rect) {
    let painter = ui.painter_at(rect);
    let colors = theme::of(ui);
    // Labels that would overlap others are left out.
    let mut taken: Vec<Rect> = Vec::new();
    for label in &stage.labels {
        if let Some(ends) = label.of {
            let is_long = |[from, to]: [egui::Pos2; 2]| (to - from).length() >= LEAST_EDGE;
            if !lens.line(ends).is_some_and(is_long) {
                continue;
            }
        }
        let Some(at) = lens.place(label.at).filter(|at| rect.contains(*at)) else { continue };
        let area = Rect::from_center_size(at, vec2(7.0 * label.text.chars().count() as f32 + 10.0, 18.0));
        if taken.iter().all(|other| !other.intersects(area)) {
            taken.push(area);
            plate(&painter, at, Align2::CENTER_CENTER, &label.text, label.of.is_some(), colors);
        }
    }
}
