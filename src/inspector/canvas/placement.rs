//! Where the picture lies on the screen, and which texel lies at which screen position.

use crate::reading::picture_view::{PictureView, TexelZoom};
use egui::{Pos2, Rect, Vec2, pos2, vec2};

/// Where a picture lies on the screen, and how large its texels are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Screen position of the picture's upper left corner, points.
    pub origin: Pos2,
    /// Points for each texel.
    pub scale: f32,
    /// Width and height, texels.
    pub size: [u32; 2],
}

impl Placement {
    /// The smallest and largest number of screen pixels for each texel.
    pub const ZOOM_LIMITS: [f32; 2] = [1.0 / 64.0, 256.0];

    /// Places a picture of `size` texels in `panel`, which may be smaller: fitted and centred, or with the view's size
    /// of texels and its centre in the middle. The corner is rounded to whole screen pixels.
    pub fn new(view: &PictureView, size: [u32; 2], panel: Rect, pixels_per_point: f32) -> Placement {
        let texels = vec2(size[0] as f32, size[1] as f32);
        let (scale, middle) = match view.zoom {
            TexelZoom::Fit => {
                let scale = (panel.width() / texels.x).min(panel.height() / texels.y).max(1e-4);
                (scale, texels / 2.0)
            }
            TexelZoom::Pixels(pixels) => (pixels / pixels_per_point, view.center.map(|c| c as f32).into()),
        };
        let origin = panel.center() - middle * scale;
        // Texels are sharp only where their edges are on the screen's grid.
        let on_grid = |v: f32| (v * pixels_per_point).round() / pixels_per_point;
        Placement { origin: pos2(on_grid(origin.x), on_grid(origin.y)), scale, size }
    }

    /// Screen pixels for each texel.
    pub fn pixels(&self, pixels_per_point: f32) -> f32 {
        self.scale * pixels_per_point
    }

    /// Returns the texel position under a screen position; may lie outside the picture.
    pub fn texel_position(&self, at: Pos2) -> Vec2 {
        (at - self.origin) / self.scale
    }

    /// Returns the texel under a screen position; `None` outside the picture.
    pub fn texel(&self, at: Pos2) -> Option<[u32; 2]> {
        let position = self.texel_position(at);
        let inside = position.x >= 0.0 && position.y >= 0.0;
        let texel = [position.x as u32, position.y as u32];
        (inside && texel[0] < self.size[0] && texel[1] < self.size[1]).then_some(texel)
    }

    /// Returns the screen rectangle of the texel of a column and row, also outside the picture.
    pub fn rect_of(&self, [x, y]: [u32; 2]) -> Rect {
        let min = self.origin + vec2(x as f32, y as f32) * self.scale;
        Rect::from_min_size(min, Vec2::splat(self.scale))
    }

    /// Returns the screen rectangle of the whole picture.
    pub fn rect(&self) -> Rect {
        Rect::from_min_size(self.origin, vec2(self.size[0] as f32, self.size[1] as f32) * self.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fitted_picture_is_centred_and_whole() {
        let panel = Rect::from_min_size(pos2(10.0, 20.0), vec2(200.0, 100.0));
        let placement = Placement::new(&PictureView::default(), [100, 100], panel, 1.0);
        assert_eq!(placement.rect(), Rect::from_min_size(pos2(60.0, 20.0), vec2(100.0, 100.0)));
        assert_eq!(placement.texel(pos2(60.5, 20.5)), Some([0, 0]));
        assert_eq!(placement.texel(pos2(59.5, 20.5)), None);
        assert_eq!(placement.texel(pos2(159.9, 119.9)), Some([99, 99]));
    }
}
