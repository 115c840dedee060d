//! All layers of a light's map side by side: the six faces of a cube, or up to 64 textures.

use super::legend;
use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::texture::TextureSize;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::model::selection::Hover;
use crate::reading::depth::DepthMeasure;
use crate::reading::format;
use crate::reading::layers::MapLayer;
use crate::reading::picture_view::{FaceChoice, ShownPicture, TexelZoom};
use egui::{Color32, CornerRadius, Rect, Role, Sense, Stroke, StrokeKind, Ui, UiBuilder, WidgetInfo, pos2, vec2};

/// Height of the name above each picture, points.
const CAPTION: f32 = 24.0;
/// Gap between pictures, points.
const GAP: f32 = 8.0;
/// The least side of a picture, points; below it the grid scrolls.
const LEAST_SIDE: f32 = 88.0;
/// A picture up to this size on the screen is drawn with a thumbnail texture, which shows as much, screen pixels.
const SMALL: f32 = 112.0;

/// Draws all layers of `shown` in a grid, each with its name, and leaves space for the legend at the right; a click on
/// a layer shows it alone.
pub fn ui(ui: &mut Ui, model: &mut Model, rect: Rect, shown: &ShownPicture, coloring: Coloring) {
    let area = Rect::from_min_max(rect.min, rect.max - vec2(legend::space_beside(rect, shown), 0.0)).shrink(GAP);
    let (columns, side) = arrangement(area.size(), shown.images.len());
    let rows = shown.images.len().div_ceil(columns);
    ui.scope_builder(UiBuilder::new().max_rect(area), |ui| {
        egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            let height = rows as f32 * (side + CAPTION);
            let (all, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
            for index in 0..shown.images.len() {
                let (column, row) = (index % columns, index / columns);
                let corner = vec2(column as f32 * (side + GAP), row as f32 * (side + CAPTION) + CAPTION - 4.0);
                one(ui, model, shown, index, coloring, Rect::from_min_size(all.min + corner, vec2(side, side)));
            }
        });
    });
}

/// Returns the number of columns and the side, in points, of square pictures so that all `count` fit into the area as
/// large as possible; where they would be smaller than the least side, as many columns as fit at about that side, to be
/// scrolled.
fn arrangement(area: egui::Vec2, count: usize) -> (usize, f32) {
    let side_of = |columns: usize| {
        let rows = count.div_ceil(columns).max(1);
        (area.x / columns as f32 - GAP).min(area.y / rows as f32 - CAPTION).max(1.0)
    };
    let columns = (1..=count.max(1)).max_by(|a, b| side_of(*a).total_cmp(&side_of(*b))).unwrap_or(1);
    if side_of(columns) >= LEAST_SIDE {
        return (columns, side_of(columns));
    }
    // Leaves space for a scroll bar.
    let columns = ((area.x / (LEAST_SIDE + GAP)) as usize).clamp(1, count.max(1));
    (columns, (area.x / columns as f32 - GAP).clamp(1.0, LEAST_SIDE * 1.5))
}

fn one(ui: &mut Ui, model: &mut Model, shown: &ShownPicture, index: usize, coloring: Coloring, square: Rect) {
    let (image, layer) = (&shown.images[index], &shown.layers[index]);
    let response = ui.interact(square, ui.scope_id().with(("layer", index)), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format::capitalized(&layer.full_name)));
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    if ui.is_rect_visible(square.expand(CAPTION)) {
        let is_small = square.width() * ui.pixels_per_point() <= SMALL;
        let size = if is_small { TextureSize::Thumbnail } else { TextureSize::Full };
        let texture = model.textures.texture(ui.ctx(), image, coloring, size);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture.id(), square, uv, Color32::WHITE);
        let outline = if response.hovered() || response.has_focus() { theme::of(ui).focus } else { theme::of(ui).line };
        ui.painter().rect_stroke(square, CornerRadius::ZERO, Stroke::new(1.0, outline), StrokeKind::Outside);
        let (text, ink) = caption(ui, model, shown, index, coloring);
        let at = pos2(square.left(), square.top() - 18.0);
        theme::line(ui, at, square.width(), &text, egui::TextStyle::Small, ink);
    }
    if let Some(at) = response.hover_pos() {
        let scale = square.width() / image.size()[0].max(1) as f32;
        let placement = Placement { origin: square.min, scale, size: image.size() };
        model.selection.hover = placement.texel(at).map(|at| Hover { image: index, at });
    }
    let hint = match layer.note {
        Some(note) => format!("{}, {note}. Show it large", format::capitalized(&layer.full_name)),
        None => format!("Show {} large", layer.full_name),
    };
    if response.on_hover_text(hint).clicked() {
        model.view.face = FaceChoice::One(index);
        model.view.zoom = TexelZoom::Fit;
        model.selection.map_pick = None;
    }
}

fn caption(ui: &Ui, model: &mut Model, shown: &ShownPicture, index: usize, coloring: Coloring) -> (String, Color32) {
    let MapLayer { name, note, .. } = &shown.layers[index];
    if let Some(note) = note {
        return (format!("{name} {note}"), theme::of(ui).faint);
    }
    if matches!(coloring, Coloring::Depth(_)) {
        let clear = model.frame.capture.as_ref().map_or(0.0, |capture| capture.depth.mapping.clear_depth());
        let any_distance = DepthMeasure::Parallel { near: 0.0, length: 1.0, clear };
        if model.textures.depth_range(&shown.images[index], any_distance).is_none() {
            return (format!("{name} sees no caster"), theme::of(ui).faint);
        }
    }
    (name.clone(), theme::of(ui).text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_are_as_large_as_fit_and_many_are_scrolled() {
        assert_eq!(arrangement(vec2(800.0, 600.0), 6).0, 3);
        assert_eq!(arrangement(vec2(600.0, 600.0), 1), (1, 576.0));
        let (columns, side) = arrangement(vec2(500.0, 500.0), 64);
        assert!(side >= LEAST_SIDE && columns as f32 * (side + GAP) <= 500.0, "{columns} of {side}");
    }
}
