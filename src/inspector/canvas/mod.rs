//! The picture itself: zoom, pan and pick by mouse and keys, numbers on large texels, and the
//! crosshair of the pick.

pub mod corners;
pub mod divider;
pub mod handles;
pub mod magnifier;
pub mod map_handles;
pub mod overlay_lines;
pub mod placement;

use crate::capture::Image;
use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::palette;
use crate::inspector::look::texture::{PictureCache, TextureSize};
use crate::inspector::look::theme;
use crate::inspector::look::widgets::keep_arrows;
use crate::inspector::model::selection::moved;
use crate::reading::picture_view::{PictureView, ShownPicture, TexelZoom};
use egui::epaint::Mesh;
use egui::{
    Align2, Color32, CornerRadius, Id, Key, PointerButton, Pos2, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui,
};
use egui::{WidgetInfo, pos2, vec2};
use std::sync::Arc;

/// From so many screen pixels for each texel, each texel shows its number.
pub const NUMBERS_FROM: f32 = 24.0;
/// The share of a cell's width that its number takes at most.
const NUMBER_SHARE: f32 = 0.82;
/// How far the crosshair reaches beyond the middle of a small texel, points.
pub const CROSSHAIR: f32 = 24.0;
/// The least size of a mark, points.
const LEAST_MARK: f32 = 2.5;
/// The largest number of marks that are drawn.
const MOST_MARKS: usize = 12_000;
/// How much one point of wheel movement zooms, as a power of e; a notch is about 50 points.
const WHEEL_ZOOM: f32 = 0.004;

/// Name of the picture's own canvas.
pub const PICTURE: &str = "Picture canvas";

/// A picture that is drawn over the shown one, and is of the same size.
#[derive(Debug, Clone)]
pub struct PictureSheet {
    /// Its image.
    pub image: Arc<Image>,
    /// How its texels are coloured.
    pub coloring: Coloring,
    /// The part of the screen in which it is drawn.
    pub part: Rect,
    /// Do its texels show their numbers?
    pub has_numbers: bool,
}

/// What a canvas shows, and the view and pick that it changes.
#[derive(Debug)]
pub struct Canvas<'a> {
    /// The name of the widget.
    pub name: &'a str,
    /// Zoom and position.
    pub view: &'a mut PictureView,
    /// The picked texel.
    pub pick: &'a mut Option<[u32; 2]>,
    /// The cache of textures.
    pub textures: &'a mut PictureCache,
    /// Arrow keys move its pick while it has the focus.
    pub has_arrows: bool,
    /// A click picks; not while the user walks, whose mouse turns the head.
    pub picks_by_click: bool,
}

/// Returns the id of the picture's own canvas.
pub fn picture_id() -> Id {
    Id::unique(PICTURE)
}

/// Draws the first image of `shown` with `sheets` over it into `rect`, with numbers where texels are large, and zooms,
/// pans and picks by mouse and arrow keys. Returns where the picture lies, and the texel under the pointer, `None`
/// outside the picture.
pub fn ui(
    ui: &mut Ui,
    canvas: Canvas<'_>,
    rect: Rect,
    shown: &ShownPicture,
    coloring: Coloring,
    sheets: &[PictureSheet],
) -> (Placement, Option<[u32; 2]>) {
    let image = &shown.images[0];
    let Canvas { name, view, pick, textures, has_arrows, picks_by_click } = canvas;
    let response = ui.interact(rect, Id::unique(name), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, name));
    let pixels_per_point = ui.pixels_per_point();
    let place = |view: &PictureView| Placement::new(view, image.size(), rect, pixels_per_point);
    move_view(ui, view, &response, place(view), pixels_per_point);
    let placement = place(view);
    let is_for_menu = closes_menu(ui, &response);
    let is_clicked = (response.clicked() || response.secondary_clicked()) && picks_by_click && !is_for_menu;
    picked(ui, pick, &response, placement, is_clicked, has_arrows);
    let hover = response.hover_pos().and_then(|at| placement.texel(at));

    let painter = ui.painter_at(rect);
    let visible = placement.rect().intersect(rect);
    background(ui, rect, coloring.is_opaque().then_some(visible));
    if visible.is_positive() {
        let block = if coloring == Coloring::Findings { block_of(placement.pixels(pixels_per_point)) } else { 1 };
        let size = if block > 1 { TextureSize::Blocks(block) } else { TextureSize::Full };
        let texture = textures.texture(ui.ctx(), image, coloring, size);
        // The last block of a row may reach over the picture's border.
        let whole = placement.rect();
        let covered = [0, 1].map(|axis| image.size()[axis].next_multiple_of(block) as f32 * placement.scale);
        let whole = if block > 1 { Rect::from_min_size(whole.min, covered.into()) } else { whole };
        painter.image(texture.id(), visible, uv_of(whole, visible), Color32::WHITE);
        for sheet in sheets {
            let part = visible.intersect(sheet.part);
            if part.is_positive() {
                let texture = textures.texture(ui.ctx(), &sheet.image, sheet.coloring, TextureSize::Full);
                painter.image(texture.id(), part, uv_of(placement.rect(), part), Color32::WHITE);
            }
        }
    }
    painter.rect_stroke(
        placement.rect(),
        CornerRadius::ZERO,
        Stroke::new(1.0, theme::of(ui).line),
        StrokeKind::Outside,
    );
    if placement.pixels(pixels_per_point) >= NUMBERS_FROM {
        let numbered = || sheets.iter().filter(|sheet| sheet.has_numbers);
        let whole = numbered().rfind(|sheet| sheet.part.contains_rect(visible));
        let (image, coloring) = whole.map_or((image, coloring), |sheet| (&sheet.image, sheet.coloring));
        match numbered().find(|sheet| !sheet.part.contains_rect(visible)) {
            Some(part) => {
                numbers(ui, beside(rect, part.part), image, coloring, placement);
                numbers(ui, rect.intersect(part.part), &part.image, part.coloring, placement);
            }
            None => numbers(ui, rect, image, coloring, placement),
        }
    }
    if let Some(at) = *pick {
        crosshair(&painter, placement.rect_of(at));
    }
    if response.has_focus() {
        painter.rect_stroke(
            rect.shrink(1.0),
            CornerRadius::ZERO,
            Stroke::new(1.0, theme::of(ui).focus),
            StrokeKind::Inside,
        );
    }
    (placement, hover)
}

/// Fills `rect` with the colour that lies behind pictures, but for what `covered` hides of it: on a CPU that would take
/// as long as the picture itself.
pub fn background(ui: &Ui, rect: Rect, covered: Option<Rect>) {
    // The border of what covers it may lie between pixels.
    let hole = covered.map_or(Rect::NOTHING, |covered| covered.shrink(1.0));
    for part in around(rect, hole) {
        ui.painter().rect_filled(part, CornerRadius::ZERO, theme::of(ui).background);
    }
}

/// Returns the parts of `rect` outside `hole`, which lies in it: above, below, left and right; all of it where there is no
/// hole.
fn around(rect: Rect, hole: Rect) -> Vec<Rect> {
    if !hole.is_positive() {
        return vec![rect];
    }
    let beside = rect.with_min_y(hole.top()).with_max_y(hole.bottom());
    let parts = [
        rect.with_max_y(hole.top()),
        rect.with_min_y(hole.bottom()),
        beside.with_max_x(hole.left()),
        beside.with_min_x(hole.right()),
    ];
    parts.into_iter().filter(|part| part.is_positive()).collect()
}

/// Returns how many texels, each way, have to become one so that every one covers at least a screen pixel.
fn block_of(pixels: f32) -> u32 {
    (1.0 / pixels).ceil().clamp(1.0, 64.0) as u32
}

fn uv_of(whole: Rect, part: Rect) -> Rect {
    let at = |p: Pos2| pos2((p.x - whole.min.x) / whole.width(), (p.y - whole.min.y) / whole.height());
    Rect::from_min_max(at(part.min), at(part.max))
}

/// Zooms by the wheel or a pinch so that the texel under the pointer stays there, within [`Placement::ZOOM_LIMITS`],
/// and pans with a left drag.
fn move_view(ui: &Ui, view: &mut PictureView, response: &Response, placement: Placement, pixels_per_point: f32) {
    if response.dragged_by(PointerButton::Primary) && response.drag_delta() != egui::Vec2::ZERO {
        let moved = placement.texel_position(response.rect.center() - response.drag_delta());
        set_view(view, placement.pixels(pixels_per_point), moved);
    }
    let Some(pointer) = response.hover_pos() else { return };
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let factor = (scroll * WHEEL_ZOOM).exp() * pinch;
    if factor != 1.0 {
        let [least, most] = Placement::ZOOM_LIMITS;
        let pixels = (placement.pixels(pixels_per_point) * factor).clamp(least, most);
        // The texel under the pointer stays there.
        let under_pointer = placement.texel_position(pointer);
        let center = under_pointer + (response.rect.center() - pointer) / (pixels / pixels_per_point);
        set_view(view, pixels, center);
    }
}

fn set_view(view: &mut PictureView, pixels: f32, center: egui::Vec2) {
    view.zoom = TexelZoom::Pixels(pixels);
    view.center = [f64::from(center.x), f64::from(center.y)];
}

/// Returns whether the click of this frame closes a menu, which it is meant for: one was open when the button went down.
fn closes_menu(ui: &Ui, response: &Response) -> bool {
    let id = response.id.with("menus");
    let is_open = egui::Popup::is_any_open(ui.ctx());
    // Menus that are drawn before the canvas are closed already in the frame of the click.
    let [was_open, mut was_open_at_press] = ui.data(|data| data.get_temp(id)).unwrap_or([false; 2]);
    if ui.input(|input| input.pointer.any_pressed()) {
        was_open_at_press = was_open || is_open;
    }
    ui.data_mut(|data| data.insert_temp(id, [is_open, was_open_at_press]));
    was_open_at_press
}

/// Picks the texel under the pointer where `is_clicked`, or during a right drag; outside the picture nothing changes. Where
/// it `has_arrows`, arrow keys move the pick while the canvas has the focus, which any click or drag gives it.
fn picked(
    ui: &Ui,
    pick: &mut Option<[u32; 2]>,
    response: &Response,
    placement: Placement,
    is_clicked: bool,
    has_arrows: bool,
) {
    if response.clicked() || response.secondary_clicked() || response.drag_started() {
        response.request_focus();
    }
    let by_mouse = is_clicked || response.dragged_by(PointerButton::Secondary);
    if let Some(texel) = response.interact_pointer_pos().filter(|_| by_mouse).and_then(|at| placement.texel(at)) {
        *pick = Some(texel);
    }
    if has_arrows && response.has_focus() {
        keep_arrows(ui, response);
        let by = nudge(ui);
        if by != [0, 0] {
            *pick = Some(moved(*pick, by, placement.size));
        }
    }
}

/// Returns by how many texels the arrow keys of this frame move, right and down: one for each key press, ten with
/// Shift.
fn nudge(ui: &Ui) -> [i32; 2] {
    ui.input(|input| {
        let far = if input.modifiers.shift { 10 } else { 1 };
        let presses = |key| input.num_presses(key) as i32 * far;
        [presses(Key::ArrowRight) - presses(Key::ArrowLeft), presses(Key::ArrowDown) - presses(Key::ArrowUp)]
    })
}

/// Returns the part of `rect` that lies left or right of `part`.
fn beside(rect: Rect, part: Rect) -> Rect {
    if part.left() <= rect.left() { rect.with_min_x(part.right()) } else { rect.with_max_x(part.left()) }
}

/// Draws the number of every texel that is visible in `rect`.
fn numbers(ui: &Ui, rect: Rect, image: &Image, coloring: Coloring, placement: Placement) {
    let painter = ui.painter_at(rect);
    let first = placement.texel_position(rect.min).max(egui::Vec2::ZERO);
    let last = placement.texel_position(rect.max);
    let end = |position: f32, side: u32| (position.max(0.0).ceil() as u32).min(side);
    for y in first.y as u32..end(last.y, placement.size[1]) {
        for x in first.x as u32..end(last.x, placement.size[0]) {
            texel_number(&painter, image, coloring, [x, y], placement.rect_of([x, y]));
        }
    }
}

/// Draws a texel's number into the middle of its cell, as large as it fits (at most 13 points), in black or white.
/// Draws nothing outside the picture, and where the colouring has no number.
pub fn texel_number(painter: &egui::Painter, image: &Image, coloring: Coloring, at: [u32; 2], cell: Rect) {
    let Some(color) = coloring.color_at(image, at) else { return };
    let lines = coloring.lines() as f32;
    let size = (cell.height() * 0.38).min(cell.height() * 0.86 / (lines * 1.2)).clamp(6.0, 13.0);
    // A character of the monospaced face is 0.6 of its size wide.
    let columns = (cell.width() * 0.94 / (size * 0.6)) as usize;
    let Some(text) = coloring.number_at(image, at, columns) else { return };
    let longest = text.lines().map(|line| line.chars().count()).max().unwrap_or(1);
    // Numbers of cells side by side must not be read as one.
    let size = size.min(cell.width() * NUMBER_SHARE / (longest as f32 * 0.6));
    let ink = palette::ink_on(color);
    let galley = painter.layout_no_wrap(text, theme::number_font(size), ink);
    let at = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), cell).min;
    painter.galley(at, galley, ink);
}

/// Draws a box of at least 11 points around the picked texel, with four ticks, light on dark so that it shows on any
/// picture.
pub fn crosshair(painter: &egui::Painter, texel: Rect) {
    let middle = texel.center();
    let half = vec2(texel.width().max(11.0), texel.height().max(11.0)) / 2.0;
    let frame = Rect::from_center_size(middle, half * 2.0).expand(1.0);
    let (inner, outer) = (half.x + 5.0, half.x + 17.0);
    for (width, color) in [(4.0, Color32::from_black_alpha(170)), (1.5, Color32::WHITE)] {
        let stroke = Stroke::new(width, color);
        painter.rect_stroke(frame, CornerRadius::ZERO, stroke, StrokeKind::Middle);
        for direction in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            painter.line_segment([middle + direction * inner, middle + direction * outer], stroke);
        }
    }
}

/// Returns a mesh with a square of at least 2.5 points at each pixel, in `color` made a little see-through; of more
/// than 12 000 pixels, only every n-th is marked.
pub fn marks(placement: Placement, pixels: &[[u32; 2]], color: Color32) -> Mesh {
    let mut mesh = Mesh::default();
    for at in pixels.iter().step_by(pixels.len().div_ceil(MOST_MARKS).max(1)) {
        let pixel = placement.rect_of(*at);
        let size = pixel.size().max(vec2(LEAST_MARK, LEAST_MARK));
        mesh.add_colored_rect(Rect::from_center_size(pixel.center(), size), color.gamma_multiply(0.8));
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Pos2, vec2};

    #[test]
    fn the_background_and_what_covers_it_share_no_point_and_leave_none_out() {
        let rect = Rect::from_min_size(pos2(3.0, 5.0), vec2(40.0, 30.0));
        let holes = [
            Rect::from_min_max(pos2(10.0, 9.0), pos2(20.0, 30.0)),
            Rect::from_min_max(pos2(3.0, 9.0), pos2(43.0, 30.0)),
            Rect::from_min_max(pos2(3.0, 5.0), pos2(20.0, 35.0)),
            rect,
            Rect::NOTHING,
        ];
        for hole in holes {
            let parts = around(rect, hole);
            for (y, x) in (0..30).flat_map(|y| (0..40).map(move |x| (y, x))) {
                let at: Pos2 = rect.min + vec2(x as f32 + 0.5, y as f32 + 0.5);
                let count = parts.iter().chain([&hole]).filter(|part| part.contains(at)).count();
                assert_eq!(count, 1, "{at:?} of {hole:?}");
            }
        }
    }
}
