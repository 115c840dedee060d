//! Lines along the axes of the world over the picture, and the points in which they meet.
//!
//! Every line of the picture through an axis's vanishing point is the picture of a line along that axis: so four of them
//! are drawn, through points of the picture that are the same for all axes.

use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::theme::{self, Theme};
use crate::inspector::look::widgets::plate;
use crate::reading::vanishing::{self, AxisLines, PictureLines};
use egui::{Align2, Color32, Label, Painter, Pos2, Shape, Stroke, Ui, Vec2, pos2, vec2};

/// Where the lines of an axis go through the picture, as shares of its width and height.
const THROUGH: [[f32; 2]; 4] = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
/// Space between a mark and its name, points.
const ASIDE: f32 = 10.0;

/// How the lines of an axis are drawn, which tells them apart without a colour: lengths of strokes and gaps, points; no gap
/// where they are whole.
fn dashes(axis: &str) -> [f32; 2] {
    match axis {
        "x" => [1.0, 0.0],
        "y" => [10.0, 5.0],
        _ => [2.0, 4.0],
    }
}

/// Draws four lines along each axis that is not seen as points, and a ring at each point where they meet, with the axis's
/// name. The painter's clip rectangle is where they end.
pub fn paint(painter: &Painter, colors: &Theme, axes: &[AxisLines; 3], placement: Placement) {
    let whole = placement.rect();
    for AxisLines { axis, lines } in axes {
        for [x, y] in THROUGH {
            let through = pos2(whole.left() + x * whole.width(), whole.top() + y * whole.height());
            let (from, to) = match lines {
                PictureLines::Meet(at) => (through, on_screen(placement, *at)),
                PictureLines::Parallel([right, down]) => (through, through + vec2(*right as f32, *down as f32)),
                PictureLines::Points => continue,
            };
            // A vanishing point may lie so far away that only its direction is left in single precision.
            let way = (to - from).normalized();
            if way == Vec2::ZERO || !way.is_finite() {
                continue;
            }
            if let Some(ends) = across(painter, from, way) {
                line(painter, ends, dashes(axis));
                if matches!(lines, PictureLines::Parallel(_)) {
                    plate(painter, ends[0].lerp(ends[1], 0.03), Align2::CENTER_CENTER, axis, false, colors);
                }
            }
        }
        if let PictureLines::Meet(at) = lines {
            let at = on_screen(placement, *at);
            if painter.clip_rect().contains(at) {
                painter.circle_stroke(at, 5.0, Stroke::new(4.0, Color32::from_black_alpha(150)));
                painter.circle_stroke(at, 5.0, Stroke::new(1.5, Color32::WHITE));
                plate(painter, at + vec2(ASIDE, 0.0), Align2::LEFT_CENTER, axis, false, colors);
            }
        }
    }
}

/// Draws a sentence on how many points there are, and how the lines of each axis are drawn.
pub fn entries(ui: &mut Ui, axes: &[AxisLines; 3]) {
    ui.add(Label::new(theme::note(vanishing::words(axes))).wrap());
    for AxisLines { axis, lines } in axes.iter().filter(|one| one.lines != PictureLines::Points) {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(28.0, 10.0), egui::Sense::hover());
            let [stroke, gap] = dashes(axis);
            let ends = [rect.left_center(), rect.right_center()];
            let ink = Stroke::new(1.5, theme::of(ui).text);
            if gap == 0.0 {
                ui.painter().line_segment(ends, ink);
            } else {
                ui.painter().extend(Shape::dashed_line(&ends, ink, stroke, gap));
            }
            let does = if matches!(lines, PictureLines::Meet(_)) { "meet" } else { "stay parallel" };
            ui.label(theme::note(format!("along {axis}: {does}")));
        });
    }
}

fn on_screen(placement: Placement, [x, y]: [f64; 2]) -> Pos2 {
    placement.origin + vec2(x as f32, y as f32) * placement.scale
}

/// Returns the part of a line through a point, along a unit direction, that lies in the painter's clip rectangle; `None`
/// where none does.
fn across(painter: &Painter, through: Pos2, way: Vec2) -> Option<[Pos2; 2]> {
    let clip = painter.clip_rect();
    let (mut from, mut to) = (f32::NEG_INFINITY, f32::INFINITY);
    for axis in 0..2 {
        let [low, high] = [clip.min[axis] - through[axis], clip.max[axis] - through[axis]];
        if way[axis].abs() < 1e-6 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let [a, b] = [low / way[axis], high / way[axis]];
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from < to && from.is_finite() && to.is_finite()).then(|| [through + way * from, through + way * to])
}

/// Draws a line, light on dark so that it shows on any picture.
fn line(painter: &Painter, ends: [Pos2; 2], [stroke, gap]: [f32; 2]) {
    for (width, color) in [(2.5, Color32::from_black_alpha(110)), (1.0, Color32::from_white_alpha(220))] {
        let ink = Stroke::new(width, color);
        if gap == 0.0 {
            painter.line_segment(ends, ink);
        } else {
            painter.extend(Shape::dashed_line(&ends, ink, stroke, gap));
        }
    }
}
