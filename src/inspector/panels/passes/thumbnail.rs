//! Rows of the tree: their background, and the small picture of what a step or draw changed.

use crate::capture::Image;
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::texture::TextureSize;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::depth::DepthScale;
use crate::reading::written::{TexelContent, WrittenAspects};
use egui::{Color32, CornerRadius, Rect, Stroke, StrokeKind, Ui, pos2, vec2};
use std::sync::Arc;

/// Draws a row's background: the accent with a bar where it is selected, a lighter one where it is only under the
/// pointer, otherwise nothing; and an outline while it has the focus.
pub fn paint_row_background(ui: &Ui, rect: Rect, is_selected: bool, is_hovered: bool, has_focus: bool) {
    let painter = ui.painter();
    if is_selected {
        painter.rect_filled(rect, CornerRadius::ZERO, theme::of(ui).selected_row);
        let bar = Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
        painter.rect_filled(bar, CornerRadius::ZERO, theme::of(ui).selected);
    } else if is_hovered {
        painter.rect_filled(rect, CornerRadius::ZERO, theme::of(ui).raised);
    }
    if has_focus {
        painter.rect_stroke(rect, CornerRadius::same(2), Stroke::new(1.0, theme::of(ui).focus), StrokeKind::Inside);
    }
}

/// Returns the image that a step or a draw wrote, with its colouring; depths over the range of the image, or [0, 1]
/// where it has none. `None` where nothing was written.
pub fn colored(model: &mut Model, written: Option<WrittenAspects>) -> Option<(Arc<Image>, Coloring)> {
    let WrittenAspects { image, content, .. } = written?;
    let coloring = match content {
        TexelContent::Color => Coloring::Srgb,
        TexelContent::LetThrough => Coloring::Linear,
        TexelContent::Stencil => Coloring::Stencil,
        TexelContent::Count => Coloring::Count,
        TexelContent::Labels => Coloring::Labels,
        TexelContent::Visibility => Coloring::Visibility,
        TexelContent::Depth(measure) => {
            let range = model.textures.depth_range(&image, measure).unwrap_or([0.0, 1.0]);
            Coloring::Depth(DepthScale { measure, range })
        }
    };
    Some((image, coloring))
}

/// Draws a small picture, fitted into `rect` and centred, with an outline; only background and outline where there is
/// none.
pub fn paint_thumbnail(ui: &Ui, model: &mut Model, picture: Option<(Arc<Image>, Coloring)>, rect: Rect) {
    let painter = ui.painter();
    painter.rect_filled(rect, CornerRadius::ZERO, theme::of(ui).background);
    if let Some((image, coloring)) = picture {
        let texture = model.textures.texture(ui.ctx(), &image, coloring, TextureSize::Thumbnail);
        let size = texture.size_vec2();
        let fitted = size * (rect.width() / size.x).min(rect.height() / size.y);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture.id(), Rect::from_center_size(rect.center(), fitted), uv, Color32::WHITE);
    }
    painter.rect_stroke(rect, CornerRadius::ZERO, Stroke::new(1.0, theme::of(ui).line), StrokeKind::Outside);
}
