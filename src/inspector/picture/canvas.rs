//! Where the picture lies on the screen, and what the pointer does to it.

use super::super::State;
use super::super::state::Placement;
use super::focus_id;
use egui::{EventFilter, PointerButton, Pos2, Rect, Sense, Ui, Vec2, vec2};

const LEAST_ZOOM: f32 = 1.0 / 64.0;
const MOST_ZOOM: f32 = 256.0;

/// A placement on a canvas: turns texels into points and back.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Points a texel.
    pub zoom: f32,
    /// The visible part of the screen.
    pub canvas: Rect,
    center: [f32; 2],
}

impl View {
    /// The point of a place in the picture, in texels from its top left corner.
    pub fn point(&self, [x, y]: [f32; 2]) -> Pos2 {
        self.canvas.center() + vec2(x - self.center[0], y - self.center[1]) * self.zoom
    }

    /// The place in the picture of a point.
    pub fn place(&self, point: Pos2) -> [f32; 2] {
        let offset = (point - self.canvas.center()) / self.zoom;
        [self.center[0] + offset.x, self.center[1] + offset.y]
    }

    /// The texel under a point, where there is one.
    pub fn texel(&self, point: Pos2, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        let [x, y] = self.place(point).map(f32::floor);
        let inside = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32;
        inside.then_some([x as u32, y as u32])
    }

    /// The screen rectangle of one texel.
    pub fn rect_of_texel(&self, [x, y]: [u32; 2]) -> Rect {
        Rect::from_min_size(self.point([x as f32, y as f32]), Vec2::splat(self.zoom))
    }

    /// The screen rectangle of the whole picture.
    pub fn rect_of_picture(&self, [width, height]: [u32; 2]) -> Rect {
        Rect::from_min_size(self.point([0.0; 2]), vec2(width as f32, height as f32) * self.zoom)
    }
}

/// Zooms, pans, picks and hovers; returns the view to draw with.
pub(super) fn interact(ui: &mut Ui, state: &mut State, canvas: Rect, size: [u32; 2]) -> View {
    let response = ui.interact(canvas, focus_id(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
    if response.clicked() || response.dragged() || response.secondary_clicked() {
        response.request_focus();
    }
    if response.has_focus() {
        // Arrows nudge the pick here, instead of moving the focus.
        let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(focus_id(), filter));
    }
    let mut view = view_of(state.placement, canvas, size);
    if response.dragged_by(PointerButton::Primary) {
        let moved = response.drag_delta() / view.zoom;
        state.placement =
            Placement { fit: false, zoom: view.zoom, center: [view.center[0] - moved.x, view.center[1] - moved.y] };
        view = view_of(state.placement, canvas, size);
    }
    let pointer = response.hover_pos();
    let wheel = ui.input(|input| input.smooth_scroll_delta().y);
    if let (Some(pointer), true) = (pointer, wheel != 0.0) {
        state.placement = zoomed(&view, pointer, (wheel / 120.0).exp2());
        view = view_of(state.placement, canvas, size);
    }
    state.placement.zoom = view.zoom;
    state.hover = pointer.and_then(|pointer| view.texel(pointer, size));
    let picks = response.secondary_clicked() || response.dragged_by(PointerButton::Secondary);
    let is_of_frame = state.capture.as_ref().is_some_and(|capture| capture.size == size);
    if let (true, true, Some(at)) = (picks, is_of_frame, state.hover) {
        state.pick = Some(at);
    }
    view
}

/// The same place stays under the pointer.
fn zoomed(view: &View, pointer: Pos2, factor: f32) -> Placement {
    let zoom = (view.zoom * factor).clamp(LEAST_ZOOM, MOST_ZOOM);
    let place = view.place(pointer);
    let offset = (pointer - view.canvas.center()) / zoom;
    Placement { fit: false, zoom, center: [place[0] - offset.x, place[1] - offset.y] }
}

fn view_of(placement: Placement, canvas: Rect, [width, height]: [u32; 2]) -> View {
    if !placement.fit {
        return View { zoom: placement.zoom, canvas, center: placement.center };
    }
    let (width, height) = (width as f32, height as f32);
    let zoom = (canvas.width() / width).min(canvas.height() / height).min(MOST_ZOOM);
    View { zoom, canvas, center: [width / 2.0, height / 2.0] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn zooming_keeps_the_place_under_the_pointer() {
        let canvas = Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 300.0));
        let view = view_of(Placement::default(), canvas, [200, 100]);
        assert_eq!(view.zoom, 2.0);
        let pointer = pos2(77.0, 191.0);
        let place = view.place(pointer);
        let closer = view_of(zoomed(&view, pointer, 8.0), canvas, [200, 100]);
        assert_eq!(closer.zoom, 16.0);
        let after = closer.place(pointer);
        assert!((place[0] - after[0]).abs() < 1e-3 && (place[1] - after[1]).abs() < 1e-3);
        assert_eq!(closer.texel(pointer, [200, 100]), view.texel(pointer, [200, 100]));
    }

    #[test]
    fn points_outside_the_picture_have_no_texel() {
        let canvas = Rect::from_min_size(pos2(0.0, 0.0), vec2(100.0, 100.0));
        let view = view_of(Placement::default(), canvas, [10, 5]);
        assert_eq!(view.texel(pos2(50.0, 2.0), [10, 5]), None);
        assert_eq!(view.texel(pos2(99.0, 50.0), [10, 5]), Some([9, 2]));
    }
}
