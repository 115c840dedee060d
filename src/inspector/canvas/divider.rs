//! The divider between two compared pictures: dragged by its handle, moved by keys, named for
//! assistive technology as the slider that it is.

use crate::inspector::look::theme;
use crate::inspector::look::widgets::keep_arrows;
use crate::inspector::model::comparing::{Comparison, NUDGE};
use egui::accesskit::Action as Access;
use egui::{
    Align2, Color32, CornerRadius, CursorIcon, Key, PointerButton, Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo,
    pos2, vec2,
};

/// Size of the handle, points, and the width in which the line is taken hold of, too.
const HANDLE: [f32; 2] = [14.0, 36.0];
const LINE_WIDTH: f32 = 7.0;

/// Returns the part of `rect` in which the compared picture is drawn: left of the divider, or right of it where the
/// comparison is flipped.
pub fn part(rect: Rect, compare: &Comparison) -> Rect {
    let x = rect.left() + rect.width() * compare.at;
    if compare.flipped { rect.with_min_x(x) } else { rect.with_max_x(x) }
}

/// Moves the divider by drags of its line, which is under all that is drawn after this; the handle is drawn apart.
pub fn line(ui: &Ui, rect: Rect, compare: &mut Comparison) {
    let x = rect.left() + rect.width() * compare.at;
    let place = Rect::from_x_y_ranges(x - LINE_WIDTH / 2.0..=x + LINE_WIDTH / 2.0, rect.y_range());
    // Keys and assistive technology have the handle.
    let response = ui.interact(place, ui.scope_id().with("divider's line"), Sense::DRAG);
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged_by(PointerButton::Primary)) {
        compare.at = ((pointer.x - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0);
    }
}

/// Draws the divider with its handle and the names of both sides, first that of the compared picture, and moves it by
/// drags of the handle and, while the handle has the focus, by the left and right arrow keys; it stays within `rect`.
pub fn ui(ui: &mut Ui, rect: Rect, compare: &mut Comparison, names: [&str; 2]) {
    let x = rect.left() + rect.width() * compare.at;
    let handle = Rect::from_center_size(pos2(x, rect.center().y), HANDLE.into());
    let response = ui.interact(handle, ui.scope_id().with("divider"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(true, f64::from(compare.at) * 100.0, "Compare divider"));
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        compare.at = (pointer.x - rect.left()) / rect.width().max(1.0);
    }
    keep_arrows(ui, &response);
    compare.at += NUDGE * steps(ui, response.id, response.has_focus()) as f32;
    compare.at = compare.at.clamp(0.0, 1.0);

    paint(ui, rect, compare, x, names);
    let theme = theme::of(ui);
    let painter = ui.painter_at(rect);
    let outline =
        if response.has_focus() || response.hovered() || response.dragged() { theme.selected } else { theme.line };
    painter.rect(handle, CornerRadius::same(4), theme.raised, Stroke::new(1.0, outline), StrokeKind::Inside);
    for aside in [-2.5, 2.5] {
        painter.vline(x + aside, handle.center().y - 7.0..=handle.center().y + 7.0, Stroke::new(1.5, theme.dim));
    }
}

/// Draws the divider's line at `x` and the names of both sides at the bottom, first that of the compared picture, which
/// is on the left unless the comparison is flipped; an empty name is not drawn.
pub fn paint(ui: &Ui, rect: Rect, compare: &Comparison, x: f32, names: [&str; 2]) {
    let painter = ui.painter_at(rect);
    for (width, color) in [(4.0, Color32::from_black_alpha(150)), (1.5, Color32::WHITE)] {
        painter.vline(x, rect.y_range(), Stroke::new(width, color));
    }
    let [compared, current] = names;
    let [left, right] = if compare.flipped { [current, compared] } else { [compared, current] };
    let places = [(left, Align2::RIGHT_BOTTOM, -12.0), (right, Align2::LEFT_BOTTOM, 12.0)];
    for (name, align, aside) in places.into_iter().filter(|(name, ..)| !name.is_empty()) {
        label(ui, rect, pos2(x + aside, rect.bottom() - 12.0), align, name);
    }
}

/// Returns how many steps to the right keys and assistive technology ask for.
fn steps(ui: &Ui, id: egui::Id, has_focus: bool) -> i32 {
    ui.input(|input| {
        let asked = |action| input.num_accesskit_action_requests(id, action) as i32;
        let keys = |key| if has_focus { input.num_presses(key) as i32 } else { 0 };
        keys(Key::ArrowRight) - keys(Key::ArrowLeft) + asked(Access::Increment) - asked(Access::Decrement)
    })
}

/// Draws a name on a dark plate, so that it can be read on any picture.
fn label(ui: &Ui, rect: Rect, at: egui::Pos2, align: Align2, name: &str) {
    let painter = ui.painter_at(rect);
    let galley =
        painter.layout_no_wrap(name.to_owned(), egui::FontId::proportional(theme::SMALL_SIZE), theme::of(ui).text);
    let text = align.align_size_within_rect(galley.size(), Rect::from_min_max(at, at));
    let ground = text.expand2(vec2(6.0, 3.0));
    painter.rect_filled(ground, CornerRadius::same(4), theme::of(ui).panel.gamma_multiply(0.94));
    painter.galley(text.min, galley, theme::of(ui).text);
}
