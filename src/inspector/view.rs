//! Which picture is shown and how: its kind, what a texel's value means, zoom and place.
//!
//! A capture holds up to five kinds of picture. [`PictureView::shown`] finds the one wished for
//! at a step, or the nearest that exists there, and says what its texels mean ([`Coloring`]).

use super::depth::{DepthMeasure, DepthScale};
use super::format;
use super::palette;
use crate::capture::{Capture, Image, Snapshot};
use egui::{Color32, Pos2, Rect, Vec2, pos2, vec2};
use std::sync::Arc;

/// A kind of picture that a capture may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PictureKind {
    /// What is seen.
    Color,
    /// Counts and marks.
    Stencil,
    /// How far the surfaces are.
    Depth,
    /// A technique's answer for one light.
    Mask,
    /// Depth as a light sees it.
    Map,
}

impl PictureKind {
    /// All, in the order of their buttons.
    pub const ALL: [PictureKind; 5] =
        [PictureKind::Color, PictureKind::Stencil, PictureKind::Depth, PictureKind::Mask, PictureKind::Map];

    /// On its button.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            PictureKind::Color => "Colour",
            PictureKind::Stencil => "Stencil",
            PictureKind::Depth => "Depth",
            PictureKind::Mask => "Mask",
            PictureKind::Map => "Shadow map",
        }
    }

    /// What one sees in it.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            PictureKind::Color => "The picture so far",
            PictureKind::Stencil => "The stencil count of every pixel",
            PictureKind::Depth => "How far the surface at every pixel is",
            PictureKind::Mask => "Where the technique says that a light is blocked",
            PictureKind::Map => "Depth as the light sees it",
        }
    }
}

/// What the texels of a picture mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coloring {
    /// sRGB bytes.
    Srgb,
    /// Stencil counts.
    Stencil,
    /// Labels of a light.
    Labels,
    /// Stored depths.
    Depth(DepthScale),
}

impl Coloring {
    /// The colour that a texel is drawn in; `None` outside the picture.
    #[must_use]
    pub fn color_at(self, image: &Image, at: [u32; 2]) -> Option<Color32> {
        match self {
            Coloring::Srgb => image.rgba_at(at).map(|[r, g, b, _]| Color32::from_rgb(r, g, b)),
            Coloring::Stencil => image.byte_at(at).map(palette::stencil),
            Coloring::Labels => image.byte_at(at).map(palette::label),
            Coloring::Depth(scale) => image.depth_at(at).map(|depth| scale.color(depth)),
        }
    }

    /// The texel's number for a cell that holds `columns` characters a line; `None` outside the
    /// picture. Colours have a line a channel.
    #[must_use]
    pub fn number_at(self, image: &Image, at: [u32; 2], columns: usize) -> Option<String> {
        match self {
            Coloring::Srgb => image.rgba_at(at).map(|[r, g, b, _]| format!("{r}\n{g}\n{b}")),
            Coloring::Stencil | Coloring::Labels => image.byte_at(at).map(|value| value.to_string()),
            Coloring::Depth(scale) => image.depth_at(at).map(|depth| match scale.measure.value(depth) {
                Some(value) => fitted(value, columns),
                None => "∞".to_owned(),
            }),
        }
    }
}

/// As many digits of `value` as fit into `columns` characters.
fn fitted(value: f64, columns: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let whole = format!("{value:.0}").len();
    let decimals = columns.saturating_sub(whole + 1).min(6);
    let text = format!("{value:.decimals$}");
    // Every digit shown would be a zero: a power of ten says more.
    if text.chars().all(|c| matches!(c, '0' | '.' | '-')) {
        return format!("{value:.0e}");
    }
    text.strip_prefix('0').filter(|rest| rest.starts_with('.')).map_or(text.clone(), str::to_owned)
}

/// Which face of a cube map is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FaceChoice {
    /// All six, small.
    #[default]
    Grid,
    /// One.
    One(usize),
}

/// Names of a cube map's faces in wgpu's order.
pub const CUBE_FACES: [&str; 6] = ["+x", "−x", "+y", "−y", "+z", "−z"];

/// How large a texel is on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Zoom {
    /// The whole picture fills its panel.
    #[default]
    Fit,
    /// Screen pixels a texel.
    Pixels(f32),
}

/// How depth is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthMode {
    /// As a distance in metres.
    #[default]
    Linear,
    /// As stored.
    Raw,
}

/// Everything about the picture panel that the user can change.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureView {
    /// The kind wished for.
    pub kind: PictureKind,
    /// Whose mask or map.
    pub light: usize,
    /// Which face of a cube map.
    pub face: FaceChoice,
    /// Size of a texel.
    pub zoom: Zoom,
    /// The texel position in the middle of the panel, unless it fits.
    pub center: [f64; 2],
    /// Distance or stored value.
    pub depth_mode: DepthMode,
    /// The grey ramp's ends as set by hand; `None`: those of the picture.
    pub depth_range: Option<[f64; 2]>,
    /// The kind to go back to when a map pass is left.
    kind_before_map: Option<PictureKind>,
}

impl Default for PictureView {
    fn default() -> PictureView {
        PictureView {
            kind: PictureKind::Color,
            light: 0,
            face: FaceChoice::Grid,
            zoom: Zoom::Fit,
            center: [0.0; 2],
            depth_mode: DepthMode::Linear,
            depth_range: None,
            kind_before_map: None,
        }
    }
}

/// A picture of the capture, ready to be drawn.
#[derive(Debug, Clone)]
pub struct Shown {
    /// Its kind: the one wished for, or what exists instead.
    pub kind: PictureKind,
    /// One, or the six faces of a cube.
    pub images: Vec<Arc<Image>>,
    /// How depths are measured; [`DepthMeasure::Raw`] for other kinds.
    pub measure: DepthMeasure,
    /// For the status bar: `stencil after step 4`.
    pub title: String,
    /// The GPU's format.
    pub format: &'static str,
}

impl PictureView {
    /// The user wishes to see `kind`.
    pub fn choose(&mut self, kind: PictureKind) {
        if (kind == PictureKind::Depth) != (self.kind == PictureKind::Depth) {
            self.depth_range = None;
        }
        self.kind = kind;
        self.kind_before_map = None;
    }

    /// Follows to a step: a map pass shows its map, and the step after it what was shown before.
    pub fn follow(&mut self, capture: &Capture, step: usize) {
        match capture.steps.get(step).map(|step| &step.snapshot) {
            Some(Snapshot::Map { light, face }) => {
                if self.kind != PictureKind::Map {
                    let before = self.kind;
                    self.choose(PictureKind::Map);
                    self.kind_before_map = Some(before);
                }
                self.light = *light;
                let is_cube = capture.lights.get(*light).and_then(|light| light.map.as_ref());
                if is_cube.is_some_and(|map| map.faces.len() > 1) {
                    self.face = FaceChoice::One(*face);
                }
            }
            _ => {
                if let Some(before) = self.kind_before_map.take() {
                    self.choose(before);
                    self.face = FaceChoice::Grid;
                }
                if let Some(light) = capture.steps.get(step).and_then(|step| step.light) {
                    self.light = light;
                }
            }
        }
    }

    /// The picture to show at a step: the kind wished for, or the first that exists.
    #[must_use]
    pub fn shown(&self, capture: &Capture, step: usize) -> Option<Shown> {
        let kinds = available(capture, step);
        let kind = if kinds.contains(&self.kind) { self.kind } else { *kinds.first()? };
        let frame = capture.frame_at(step);
        let after = |what: &str| format!("{what} after step {}", step + 1);
        let depth_format = if has_stencil(capture) { "Depth32FloatStencil8" } else { "Depth32Float" };
        let raw = DepthMeasure::Raw;
        let camera = || self.measure_or_raw(DepthMeasure::of_camera(capture));
        let (image, measure, title, format) = match kind {
            PictureKind::Color => (frame?.color.image.clone(), raw, after("colour"), "Rgba8UnormSrgb"),
            PictureKind::Stencil => (frame?.stencil.as_ref()?.image.clone(), raw, after("stencil"), depth_format),
            PictureKind::Depth => (frame?.depth.image.clone(), camera(), after("depth"), depth_format),
            PictureKind::Mask => {
                let light = self.light_with(capture, |light| light.shadow.is_some())?;
                let title = format!("mask of {}", format::light(light));
                (capture.lights.get(light)?.shadow.clone()?, raw, title, "R8Uint")
            }
            PictureKind::Map => return self.shown_map(capture),
        };
        Some(Shown { kind, images: vec![image], measure, title, format })
    }

    fn shown_map(&self, capture: &Capture) -> Option<Shown> {
        let light = self.light_with(capture, |light| light.map.is_some())?;
        let map = capture.lights.get(light)?.map.as_ref()?;
        let title = format!("shadow map of {}", format::light(light));
        let (images, measure, title) = match self.face {
            FaceChoice::One(face) if map.faces.len() > 1 && face < map.faces.len() => {
                let name = CUBE_FACES.get(face).copied().unwrap_or("?");
                (vec![map.faces[face].clone()], DepthMeasure::of_map(map, face), format!("{title}, face {name}"))
            }
            _ => (map.faces.clone(), DepthMeasure::of_map(map, 0), title),
        };
        let measure = self.measure_or_raw(measure);
        Some(Shown { kind: PictureKind::Map, images, measure, title, format: "Depth32Float" })
    }

    fn measure_or_raw(&self, linear: Option<DepthMeasure>) -> DepthMeasure {
        linear.filter(|_| self.depth_mode == DepthMode::Linear).unwrap_or(DepthMeasure::Raw)
    }

    /// The chosen light if `has` holds for it, else the first for which it does.
    pub fn light_with(&self, capture: &Capture, has: impl Fn(&crate::capture::CapturedLight) -> bool) -> Option<usize> {
        let chosen = capture.lights.get(self.light).filter(|light| has(light));
        chosen.map_or_else(|| capture.lights.iter().position(&has), |_| Some(self.light))
    }
}

/// The kinds of picture that exist at a step, in the order of their buttons.
#[must_use]
pub fn available(capture: &Capture, step: usize) -> Vec<PictureKind> {
    let frame = capture.frame_at(step);
    let exists = |kind: &PictureKind| match kind {
        PictureKind::Color | PictureKind::Depth => frame.is_some(),
        PictureKind::Stencil => frame.is_some_and(|frame| frame.stencil.is_some()),
        PictureKind::Mask => capture.lights.iter().any(|light| light.shadow.is_some()),
        PictureKind::Map => capture.lights.iter().any(|light| light.map.is_some()),
    };
    PictureKind::ALL.into_iter().filter(exists).collect()
}

fn has_stencil(capture: &Capture) -> bool {
    let last = capture.steps.len().checked_sub(1).and_then(|last| capture.frame_at(last));
    last.is_some_and(|frame| frame.stencil.is_some())
}

/// Where a picture lies on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Screen position of the picture's upper left corner, points.
    pub origin: Pos2,
    /// Points a texel.
    pub scale: f32,
    /// Texels.
    pub size: [u32; 2],
}

impl Placement {
    /// The smallest and largest number of screen pixels a texel.
    pub const ZOOM_LIMITS: [f32; 2] = [1.0 / 64.0, 256.0];

    /// Places a picture of `size` in `panel`.
    #[must_use]
    pub fn new(view: &PictureView, size: [u32; 2], panel: Rect, pixels_per_point: f32) -> Placement {
        let texels = vec2(size[0] as f32, size[1] as f32);
        let (scale, middle) = match view.zoom {
            Zoom::Fit => {
                let scale = (panel.width() / texels.x).min(panel.height() / texels.y).max(1e-4);
                (scale, texels / 2.0)
            }
            Zoom::Pixels(pixels) => (pixels / pixels_per_point, view.center.map(|c| c as f32).into()),
        };
        let origin = panel.center() - middle * scale;
        // Texels are sharp only where their edges are on the screen's grid.
        let on_grid = |v: f32| (v * pixels_per_point).round() / pixels_per_point;
        Placement { origin: pos2(on_grid(origin.x), on_grid(origin.y)), scale, size }
    }

    /// Screen pixels a texel.
    #[must_use]
    pub fn pixels(&self, pixels_per_point: f32) -> f32 {
        self.scale * pixels_per_point
    }

    /// The texel position under a screen position; may lie outside the picture.
    #[must_use]
    pub fn texel_position(&self, at: Pos2) -> Vec2 {
        (at - self.origin) / self.scale
    }

    /// The texel under a screen position.
    #[must_use]
    pub fn texel(&self, at: Pos2) -> Option<[u32; 2]> {
        let position = self.texel_position(at);
        let inside = position.x >= 0.0 && position.y >= 0.0;
        let texel = [position.x as u32, position.y as u32];
        (inside && texel[0] < self.size[0] && texel[1] < self.size[1]).then_some(texel)
    }

    /// The screen rectangle of a texel.
    #[must_use]
    pub fn rect_of(&self, [x, y]: [u32; 2]) -> Rect {
        let min = self.origin + vec2(x as f32, y as f32) * self.scale;
        Rect::from_min_size(min, Vec2::splat(self.scale))
    }

    /// The screen rectangle of the whole picture.
    #[must_use]
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

    #[test]
    fn numbers_fit_their_cell() {
        assert_eq!(fitted(13.4823, 4), "13.5");
        assert_eq!(fitted(0.0, 4), "0");
        assert_eq!(fitted(0.3712, 4), ".37");
        assert_eq!(fitted(1234.5, 4), "1234");
        assert_eq!(fitted(0.000_001, 4), "1e-6");
    }
}
