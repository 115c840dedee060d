//! The frame around what the stop of a running tour speaks of.

use crate::inspector::action::TourSubject;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use egui::{Align, CornerRadius, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, vec2};

/// Width of the frame, points.
const WIDTH: f32 = 2.0;
/// Space between the frame and what it is about, points.
const SPACE: egui::Vec2 = vec2(4.0, 3.0);

/// Draws `contents`, with a frame where the stop of the running tour speaks of them; the stop's first frame scrolls them
/// into view.
pub fn about<R>(
    ui: &mut Ui,
    model: &mut Model,
    subject: TourSubject,
    contents: impl FnOnce(&mut Ui, &mut Model) -> R,
) -> R {
    // A scope also where there is no frame: what is inside keeps its identity.
    let drawn = ui.scope(|ui| contents(ui, model));
    frame(ui, model, subject, &drawn.response);
    drawn.inner
}

/// Draws the frame around what was `drawn`, where the stop of the running tour speaks of it and something was drawn.
pub fn frame(ui: &Ui, model: &mut Model, subject: TourSubject, drawn: &Response) {
    let Some(focus) = model.tour_focus.as_mut().filter(|focus| focus.subject == Some(subject)) else { return };
    if drawn.rect.height() < 1.0 {
        return;
    }
    // It only says what it is: hover and clicks stay with what is inside.
    let mark = ui.interact(drawn.rect, drawn.id.with("tour mark"), Sense::hover());
    mark.widget_info(|| WidgetInfo::labeled(Role::Group, true, format!("The stop speaks of {}", subject.name())));
    let clip = ui.clip_rect();
    if focus.scrolls > 0 {
        // What is higher than its panel is seen from its top on.
        let is_high = drawn.rect.height() > clip.height();
        let begins = (drawn.rect.top() - clip.top()).abs() <= 2.0 * SPACE.y;
        let is_whole = clip.top() <= drawn.rect.top() && drawn.rect.bottom() <= clip.bottom();
        let is_seen = is_whole || (is_high && begins);
        let scrolls = ui.input(|input| input.smooth_scroll_delta != egui::Vec2::ZERO);
        focus.scrolls = if is_seen || scrolls { 0 } else { focus.scrolls - 1 };
        if focus.scrolls > 0 {
            ui.scroll_to_rect(drawn.rect.expand2(SPACE), is_high.then_some(Align::Min));
            ui.ctx().request_repaint();
        }
    }
    paint(ui, drawn.rect.expand2(SPACE).intersect(clip.shrink(WIDTH / 2.0)));
}

fn paint(ui: &Ui, rect: Rect) {
    let stroke = Stroke::new(WIDTH, theme::of(ui).tour);
    ui.painter().rect_stroke(rect, CornerRadius::same(5), stroke, StrokeKind::Middle);
}
