//! Drawn over the picture: numbers on texels, the pick, a magnifier, a legend.

use super::super::palette::{label_color, label_name, readable_on, signed_stencil, stencil_color};
use super::super::{PictureKind, State, theme};
use super::canvas::View;
use super::near_of;
use crate::capture::Image;
use egui::{Align2, Color32, FontId, Painter, Rect, Stroke, StrokeKind, Ui, UiBuilder, Vec2, vec2};

/// Values listed in a legend before the rest is summed up.
const LEGEND_ROWS: usize = 9;

/// Text and fill of one texel.
fn cell(state: &State, image: &Image, at: [u32; 2]) -> Option<(String, Option<Color32>)> {
    Some(match state.picture {
        PictureKind::Color => {
            let [r, g, b, _] = image.rgba_at(at)?;
            (format!("{r}\n{g}\n{b}"), Some(Color32::from_rgb(r, g, b)))
        }
        PictureKind::Stencil => {
            let value = image.byte_at(at)?;
            let text = if value < 128 { value.to_string() } else { (value as i8).to_string() };
            (text, Some(stencil_color(value)))
        }
        PictureKind::Mask => {
            let label = image.byte_at(at)?;
            (label.to_string(), Some(label_color(label)))
        }
        PictureKind::Depth | PictureKind::Map => {
            let stored = image.depth_at(at)?;
            let value = near_of(state).map_or(stored, |near| near / stored);
            (if value.is_finite() { theme::short(f64::from(value)) } else { "∞".to_owned() }, None)
        }
    })
}

/// Every visible texel's number.
pub(super) fn numbers(painter: &Painter, state: &State, image: &Image, view: &View) {
    let [width, height] = image.size();
    let [left, top] = view.place(view.canvas.min).map(|place| place.max(0.0) as u32);
    let [right, bottom] = view.place(view.canvas.max).map(|place| place.ceil().max(0.0) as u32);
    for y in top..bottom.min(height) {
        for x in left..right.min(width) {
            let Some((text, fill)) = cell(state, image, [x, y]) else { continue };
            // Grey of depth is not known here: a shadow makes the text readable on any.
            let color = fill.map_or(theme::SELECTED, readable_on);
            number_in(painter, view.rect_of_texel([x, y]), &text, color);
        }
    }
}

fn number_in(painter: &Painter, rect: Rect, text: &str, color: Color32) {
    let longest = text.lines().map(|line| line.chars().count()).max().unwrap_or(1);
    let by_width = rect.width() / (longest as f32 * 0.62 + 0.6);
    let by_height = rect.height() / (text.lines().count() as f32 * 1.3);
    let size = by_width.min(by_height).min(13.0);
    if size >= 5.0 {
        painter.text(rect.center(), Align2::CENTER_CENTER, text, FontId::monospace(size), color);
    }
}

/// A square round the picked texel, with hairs that lead the eye to it.
pub(super) fn crosshair(painter: &Painter, view: &View, pick: [u32; 2]) {
    let texel = view.rect_of_texel(pick);
    let square = Rect::from_center_size(texel.center(), texel.size().max(Vec2::splat(9.0)));
    for (width, color) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
        let stroke = Stroke::new(width, color);
        painter.rect_stroke(square, 0.0, stroke, StrokeKind::Middle);
        for direction in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            let start = square.center() + direction * (square.size() / 2.0 + Vec2::splat(4.0));
            painter.line_segment([start, start + direction * 10.0], stroke);
        }
    }
}

/// The texels around the pick with their numbers, in the lower left corner.
pub(super) fn magnifier(painter: &Painter, state: &State, image: &Image, canvas: Rect, pick: [u32; 2]) {
    const COLUMNS: i64 = 7;
    const ROWS: i64 = 5;
    let cell_size = match state.picture {
        PictureKind::Stencil | PictureKind::Mask => vec2(24.0, 22.0),
        _ => vec2(38.0, 34.0),
    };
    let size = cell_size * vec2(COLUMNS as f32, ROWS as f32);
    if size.x * 2.0 > canvas.width() || size.y * 2.0 > canvas.height() {
        return;
    }
    let frame = Rect::from_min_size(canvas.left_bottom() + vec2(8.0, -8.0 - size.y), size);
    painter.rect_filled(frame.expand(1.0), 2.0, theme::LINE);
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let at = [i64::from(pick[0]) + column - COLUMNS / 2, i64::from(pick[1]) + row - ROWS / 2];
            let place = Rect::from_min_size(frame.min + cell_size * vec2(column as f32, row as f32), cell_size);
            let inner = place.shrink(0.5);
            let texel = u32::try_from(at[0]).ok().zip(u32::try_from(at[1]).ok()).map(|(x, y)| [x, y]);
            let Some((text, fill)) = texel.and_then(|texel| cell(state, image, texel)) else {
                painter.rect_filled(inner, 0.0, theme::BACKGROUND);
                continue;
            };
            let fill = fill.unwrap_or(theme::RAISED);
            painter.rect_filled(inner, 0.0, fill);
            number_in(painter, inner, &text, readable_on(fill));
        }
    }
    let middle = frame.min + cell_size * vec2((COLUMNS / 2) as f32, (ROWS / 2) as f32);
    let stroke = Stroke::new(2.0, Color32::WHITE);
    painter.rect_stroke(Rect::from_min_size(middle, cell_size), 0.0, stroke, StrokeKind::Inside);
}

/// How many pixels have each value, in the upper right corner.
pub(super) fn legend(ui: &mut Ui, state: &State, image: &Image, canvas: Rect) {
    let is_stencil = state.picture == PictureKind::Stencil;
    let histogram = image.histogram();
    let counts: Vec<(u8, u64)> = (0..=255).zip(histogram).filter(|(_, count)| *count > 0).collect();
    let rows = counts.len().min(LEGEND_ROWS) + usize::from(counts.len() > LEGEND_ROWS) + 1;
    let size = vec2(if is_stencil { 136.0 } else { 164.0 }, rows as f32 * 19.0 + 14.0);
    let place = Rect::from_min_size(canvas.right_top() + vec2(-size.x - 8.0, 8.0), size);
    if !canvas.contains_rect(place) {
        return;
    }
    ui.painter().rect(place, 4.0, theme::RAISED, Stroke::new(1.0, theme::LINE), StrokeKind::Inside);
    ui.scope_builder(UiBuilder::new().max_rect(place.shrink(8.0)), |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.spacing_mut().interact_size.y = 18.0;
        ui.label(theme::dim(if is_stencil { "Stencil count" } else { "Label" }));
        for (value, count) in counts.iter().take(LEGEND_ROWS) {
            let (color, name) = if is_stencil {
                (stencil_color(*value), signed_stencil(*value))
            } else {
                (label_color(*value), format!("{value} {}", label_name(*value)))
            };
            row(ui, Some(color), &name, *count);
        }
        if counts.len() > LEGEND_ROWS {
            let rest = counts[LEGEND_ROWS..].iter().map(|(_, count)| count).sum();
            row(ui, None, "others", rest);
        }
    });
}

fn row(ui: &mut Ui, color: Option<Color32>, name: &str, count: u64) {
    ui.horizontal(|ui| {
        match color {
            Some(color) => theme::swatch(ui, color),
            None => ui.add_space(theme::SPACE * 2.5),
        }
        ui.label(theme::number(name));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(theme::number(theme::thousands(count)));
        });
    });
}
