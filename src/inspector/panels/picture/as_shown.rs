//! The shown picture with overlays and the compared half, or both compared pictures side by side over their names, for a
//! file, one pixel for each texel.
//!
//! Pictures are laid over one another texel by texel. Lines, numbers and names are drawn by the code that draws them in
//! the window, into an invisible window of the picture's size; `look/triangles.rs` fills its triangles, which may take
//! a while and needs nothing of the window: [`PictureDrawing::finish`].

use super::compared;
use super::overlays::{self, OverlaidSide};
use super::{PictureLayers, PicturePanel, layers, legend, vanishing_lines};
use crate::capture::Capture;
use crate::inspector::action::Overlay;
use crate::inspector::canvas::magnifier::Occupied;
use crate::inspector::canvas::placement::Placement;
use crate::inspector::canvas::{self, divider};
use crate::inspector::look::coloring::{ColorMapping, Coloring};
use crate::inspector::look::texture;
use crate::inspector::look::theme;
use crate::inspector::look::triangles;
use crate::inspector::model::Model;
use crate::inspector::model::comparing::Comparison;
use crate::picture::Picture;
use crate::picture::caption;
use crate::picture::svg::SvgError;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::reading::vanishing;
use egui::epaint::{ClippedPrimitive, Primitive};
use egui::{ColorImage, Context, Pos2, RawInput, Rect, Ui, vec2};
use std::sync::Arc;

/// The least width of a picture in which the sides of a comparison have their names, pixels.
const NAMED_FROM: u32 = 480;
/// The least width and height of a picture that has its legend in a file, pixels.
const LEGEND_FROM: [u32; 2] = [560, 420];

/// A picture with one pixel for each texel, and the triangles of overlays that are yet to be drawn over it.
#[derive(Debug, Clone)]
pub struct PictureDrawing {
    picture: Picture,
    triangles: Vec<ClippedPrimitive>,
    letters: ColorImage,
}

/// Both pictures of a comparison, whole, from left to right, each over what it is of.
#[derive(Debug, Clone)]
pub struct BothSides([(PictureDrawing, String); 2]);

impl BothSides {
    /// Returns both pictures with their captions side by side.
    pub fn finish(&self) -> Result<Picture, SvgError> {
        let captioned = self.0.iter().map(|(drawing, words)| caption::captioned(&drawing.finish(), [words, ""]));
        Ok(caption::in_a_row(&captioned.collect::<Result<Vec<_>, _>>()?))
    }
}

impl PictureDrawing {
    /// Wraps a picture over which nothing is drawn.
    pub fn plain(picture: Picture) -> PictureDrawing {
        PictureDrawing { picture, triangles: Vec::new(), letters: ColorImage::default() }
    }

    /// Returns the picture with the triangles drawn over it; takes some tenths of a second where there are wireframes.
    pub fn finish(&self) -> Picture {
        let mut picture = self.picture.clone();
        for primitive in &self.triangles {
            if let Primitive::Mesh(mesh) = &primitive.primitive {
                triangles::fill(&mut picture, mesh, primitive.clip_rect, &self.letters);
            }
        }
        picture
    }
}

/// Whether an exported picture has the mark around the picked pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PickMark {
    /// It has.
    Drawn,
    /// It has none: every pixel has its own value.
    LeftOut,
}

/// Returns `shown`, which is one image, as the panel draws it: with changes, overlays, pick and comparison, one pixel for
/// each texel, and the legend where that is wished and fits, but without handles and cards. The divider is at the
/// texel at which it is in the window; small pictures leave out its names. Without `compare` the compared half is left out.
pub fn drawing(
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
    mapping: ColorMapping,
    compare: Option<Comparison>,
) -> PictureDrawing {
    let size = shown.images[0].size();
    let rect = Rect::from_min_size(Pos2::ZERO, vec2(size[0] as f32, size[1] as f32));
    let seam = own.seam;
    let compare = compare.map(|compare| Comparison { at: seam.unwrap_or(compare.at).clamp(0.0, 1.0), ..compare });
    let mut picture = texture::picture(&shown.images[0], mapping.coloring);
    let PictureLayers { change, sheets, compared } = layers(own, model, capture, rect, shown, mapping, compare);
    for sheet in &sheets {
        let columns = sheet.part.left().round() as u32..sheet.part.right().round() as u32;
        texture::lay_over(&mut picture, &sheet.image, sheet.coloring, columns);
    }
    let sides = compared.map(|compare| {
        // In a small picture names would hide what they name.
        let is_named = size[0] >= NAMED_FROM;
        (compare, if is_named { compared::names_in_place(model, capture, &compare, shown) } else { Default::default() })
    });
    let placement = Placement { origin: Pos2::ZERO, scale: 1.0, size };
    let (triangles, letters) = painted(rect, model.theme.in_egui(), |ui| {
        if change.is_none() {
            compared::mark_specks(ui, own, model, capture, shown, rect, placement);
        }
        if shown.kind != PictureKind::Map {
            let (on, pick) = (&model.modes.overlays, model.selection.pick);
            overlays::paint(ui, &mut own.overlays, on, rect, placement, pick, OverlaidSide::Shown);
            if model.modes.overlays.contains(&Overlay::Vanishing) {
                let axes = vanishing::axes(capture);
                vanishing_lines::paint(&ui.painter_at(rect), theme::of(ui), &axes, placement);
            }
        }
        // Lines and marks must not hide the crosshair.
        if let Some(pick) = *model.selection.pick_of(shown.kind) {
            canvas::crosshair(&ui.painter_at(rect), placement.rect_of(pick));
        }
        if let Some((compare, [beside, now])) = &sides {
            divider::paint(ui, rect, compare, rect.width() * compare.at, [beside, now]);
        }
        if !model.modes.exports_no_legend && may_have_legend(shown) {
            let nothing = Occupied::default();
            match &change {
                Some(change) => {
                    let sides = model.modes.compare.map(|compare| compared::names(model, capture, &compare));
                    legend::of_change(ui, model, rect, change, sides.as_ref(), &nothing);
                }
                None => {
                    let _ = legend::ui(ui, &mut own.counts_findings, model, rect, shown, mapping.range, &nothing);
                }
            }
        }
    });
    PictureDrawing { picture, triangles, letters }
}

/// Returns whether an exported picture may have a legend: one that is so large that the legend hides little of it, and whose
/// colours mean something else than themselves.
pub fn may_have_legend(shown: &ShownPicture) -> bool {
    let is_large = shown.images.first().is_some_and(|image| {
        let [width, height] = image.size();
        width >= LEGEND_FROM[0] && height >= LEGEND_FROM[1]
    });
    is_large && shown.kind != PictureKind::Color
}

/// Returns both pictures of the comparison, `now` that of the shown side, and the compared one under the veil where only that is
/// shown in which they differ; `None` where nothing is compared, or the compared picture is not known for this moment
/// ([`Model::both_compared`]).
pub fn both(
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
    mapping: ColorMapping,
    now: PictureDrawing,
    pick_mark: PickMark,
) -> Option<BothSides> {
    let (compare, other, beside) = model.both_compared(capture, shown)?;
    let coloring = compared::coloring_beside(&beside, mapping);
    let [of_other, of_now] = compared::captions(model, capture, shown, &other, &beside);
    let mut other = texture::picture(&beside.images[0], coloring);
    if let Some([veil, _]) = compared::veils(own, model, capture, shown) {
        texture::lay_over(&mut other, &veil, Coloring::ColorChange, 0..veil.size()[0]);
    }
    let mut other = PictureDrawing::plain(other);
    let size = beside.images[0].size();
    let rect = Rect::from_min_size(Pos2::ZERO, vec2(size[0] as f32, size[1] as f32));
    let placement = Placement { origin: Pos2::ZERO, scale: 1.0, size };
    let pick = (*model.selection.pick_of(shown.kind)).filter(|_| pick_mark == PickMark::Drawn);
    // Pictures for values alone have neither mark nor legend.
    let has_legend = pick_mark == PickMark::Drawn && !model.modes.exports_no_legend && may_have_legend(&beside);
    // Its counts are those of its own picture.
    let range = model.shown_coloring(&beside).range;
    // The plain picture has values alone.
    let has_marks = pick_mark == PickMark::Drawn && model.modes.shows_difference();
    if pick.is_some() || has_legend || has_marks {
        (other.triangles, other.letters) = painted(rect, model.theme.in_egui(), |ui| {
            if has_marks {
                compared::mark_specks(ui, own, model, capture, shown, rect, placement);
            }
            if let Some(pick) = pick {
                canvas::crosshair(&ui.painter_at(rect), placement.rect_of(pick));
            }
            if has_legend {
                let nothing = Occupied::default();
                let _ = legend::ui(ui, &mut own.counts_findings, model, rect, &beside, range, &nothing);
            }
        });
    }
    let (other, now) = ((other, of_other), (now, of_now));
    Some(BothSides(if compare.flipped { [now, other] } else { [other, now] }))
}

/// Returns, as triangles, what `paint` draws into a window of this size, one point for each pixel, in a context of its
/// own; and the font texture that they use.
fn painted(rect: Rect, theme: egui::Theme, mut paint: impl FnMut(&mut Ui)) -> (Vec<ClippedPrimitive>, ColorImage) {
    let ctx = Context::default();
    theme::apply(&ctx);
    ctx.set_theme(theme);
    let input = RawInput { screen_rect: Some(rect), ..RawInput::default() };
    let mut output = ctx.run_ui(input, |ui| paint(ui));
    let letters = triangles::letters(&output.textures_delta);
    // They are drawn from this copy; if they were dropped, egui would report a bug.
    output.textures_delta.clear();
    (ctx.tessellate(output.shapes, output.pixels_per_point), letters)
}
