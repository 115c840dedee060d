//! Legends of changes and of one bit, and the bars beside the others.

use super::legend_entry::{bar, entry};
use crate::inspector::look::texture::DEPTH_BARS;
use crate::inspector::look::theme;
use crate::inspector::look::{coloring, palette};
use crate::inspector::model::Model;
use crate::reading::change::{self, ChangedTexels, StepChange};
use crate::reading::format;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use egui::{Color32, CornerRadius, Rect, Sense, Ui, pos2, vec2};

/// How many changes of counts are listed one by one.
const MOST_LISTED: usize = 10;
/// The grey of what is the same.
const SAME: Color32 = Color32::from_gray(70);
/// Height of a histogram of depths, points.
const BARS_HEIGHT: f32 = 32.0;

/// Draws how many pixels changed, or in how many the two `sides` of a comparison differ, and how many have each kind of
/// change, from the first side to the second: of counts the ten largest increases first, of depths those that occur, of
/// colours no kinds.
pub fn change(ui: &mut Ui, found: &StepChange, sides: Option<&[String; 2]>) {
    let pixels = format::counted(found.texels, "pixel");
    match sides {
        None => drop(theme::heading(ui, &format!("{pixels} changed"))),
        Some([other, now]) => {
            theme::heading(ui, "Difference");
            ui.add(egui::Label::new(theme::note(format!("{now} minus {other}"))).wrap());
            ui.label(theme::note(format!("{pixels} differ")));
        }
    }
    let hovers = match sides {
        None => [
            "By how much the value went up or down",
            "The surface is nearer than before",
            "The surface is farther than before",
            "Nothing was drawn here before",
            "The surface is gone",
        ],
        Some(_) => [
            "By how much the value is more or less",
            "The surface is nearer",
            "The surface is farther",
            "Only here is a surface",
            "Only there is a surface",
        ],
    };
    let [count_hover, nearer_hover, farther_hover, appeared_hover, went_hover] = hovers;
    let [width, height] = found.image.size().map(u64::from);
    let entries: Vec<(Color32, String, u64, &str)> = match &found.sorts {
        ChangedTexels::Counts(counts) => {
            let listed = counts.iter().rev().take(MOST_LISTED);
            listed
                .map(|(by, texels)| {
                    let name = change::signed(*by).unwrap_or_default();
                    (coloring::count_color(*by), name, *texels, count_hover)
                })
                .collect()
        }
        ChangedTexels::Depths([nearer, farther, appeared, went]) => [
            (palette::UP, "nearer", *nearer, nearer_hover),
            (palette::DOWN, "farther", *farther, farther_hover),
            (palette::APPEARED, "new surface", *appeared, appeared_hover),
            (palette::WENT, if sides.is_some() { "no surface" } else { "cleared" }, *went, went_hover),
        ]
        .into_iter()
        .filter(|(_, _, texels, _)| *texels > 0)
        .map(|(color, name, texels, hover)| (color, name.to_owned(), texels, hover))
        .collect(),
        ChangedTexels::Colors => Vec::new(),
    };
    for (color, name, texels, hover) in entries {
        entry(ui, color, &name, texels).on_hover_text(hover);
    }
    if found.sorts == ChangedTexels::Colors && found.texels > 0 {
        ui.label(theme::note("in their new colour"));
    }
    if let ChangedTexels::Counts(counts) = &found.sorts
        && counts.len() > MOST_LISTED
    {
        ui.label(theme::note(format::counted((counts.len() - MOST_LISTED) as u64, "more sort")));
    }
    let same = if sides.is_some() { "the same" } else { "unchanged" };
    entry(ui, SAME, same, width * height - found.texels).on_hover_text("In grey: the picture's colours, dimmed");
}

/// Draws, of two colour pictures of which only that is shown in which they differ, how many pixels are the same, which are
/// grey; how many differ is said beside.
pub fn differing_colors(ui: &mut Ui, same: u64) {
    theme::heading(ui, "Difference");
    let words = "each side in its own colours where they differ, outlined, or marked orange where that is small";
    ui.add(egui::Label::new(theme::note(words)).wrap());
    entry(ui, SAME, "the same", same).on_hover_text("In grey: the picture's colours, dimmed");
}

/// Draws the two colours of a bit of the stencil, with how many texels of the shown image have it set and not set.
pub fn bit(ui: &mut Ui, model: &mut Model, shown: &ShownPicture, bit: u8) {
    let histogram = model.textures.histogram(&shown.images[0]);
    theme::heading(ui, &format!("Bit {bit} of the stencil"));
    ui.label(theme::note(format!("worth {}", 1_u32 << bit)));
    let set: u64 =
        (0..=255_u8).zip(histogram).filter(|(value, _)| value >> bit & 1 == 1).map(|(_, texels)| texels).sum();
    let all: u64 = histogram.iter().sum();
    entry(ui, palette::BITS[1], "1 set", set);
    entry(ui, palette::BITS[0], "0 not set", all - set);
}

/// Draws how many fragments there are in all, and how many pixels have how many: 0 to 8 one by one, then in ranges up
/// to 255 or more; lines without pixels are left out.
pub fn overdraw(ui: &mut Ui, model: &mut Model, shown: &ShownPicture) {
    let histogram = model.textures.histogram(&shown.images[0]);
    theme::heading(ui, "Fragments a pixel");
    let all: u64 = (0..=255_u64).zip(histogram).map(|(count, pixels)| count * pixels).sum();
    ui.label(theme::note(format!("{} in all", format::count(all))));
    let most = histogram[1..].iter().copied().max().unwrap_or(0);
    let single = (0..=8_u8).map(|count| (count, count.to_string(), histogram[usize::from(count)]));
    let ranges = [(9_u8, 16_u8), (17, 32), (33, 64), (65, 128), (129, 254), (255, 255)].map(|(from, to)| {
        let pixels = histogram[usize::from(from)..=usize::from(to)].iter().sum();
        (to, if from == to { "255 or more".to_owned() } else { format!("{from} to {to}") }, pixels)
    });
    for (count, name, pixels) in single.chain(ranges).filter(|(_, _, pixels)| *pixels > 0) {
        entry(ui, palette::overdraw(count), &name, pixels);
        bar(ui, pixels.min(most), most);
    }
}

/// Draws a histogram of the depths of all shown images over `full`; the bars within `range`, which the grey ramp
/// covers, are lighter. The highest bar fills the height.
pub fn depth_bars(ui: &mut Ui, model: &mut Model, shown: &ShownPicture, range: [f64; 2], full: [f64; 2]) {
    let mut bars = [0_u64; DEPTH_BARS];
    for image in &shown.images {
        let of_image = model.textures.depth_histogram(image, shown.measure, full);
        bars.iter_mut().zip(of_image).for_each(|(bar, texels)| *bar += texels);
    }
    let most = bars.iter().copied().max().unwrap_or(0).max(1);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), BARS_HEIGHT), Sense::hover());
    let unit = if shown.kind == PictureKind::Map { "texel" } else { "pixel" };
    let name = format!("Histogram of depths, {} at most", format::counted(most, unit));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    let width = rect.width() / DEPTH_BARS as f32;
    let value = |bar: usize| full[0] + (full[1] - full[0]) * (bar as f64 + 0.5) / DEPTH_BARS as f64;
    for (index, texels) in bars.into_iter().enumerate().filter(|(_, texels)| *texels > 0) {
        let height = (texels as f32 / most as f32 * rect.height()).max(1.0);
        let left = rect.left() + index as f32 * width;
        let bar = Rect::from_min_max(pos2(left, rect.bottom() - height), pos2(left + width - 0.5, rect.bottom()));
        let is_covered = (range[0]..=range[1]).contains(&value(index));
        let ink = if is_covered { theme::of(ui).dim } else { theme::of(ui).faint };
        ui.painter().rect_filled(bar, CornerRadius::ZERO, ink);
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), egui::Stroke::new(1.0, theme::of(ui).line));
    if let Some(pointer) = response.hover_pos() {
        let index = (((pointer.x - rect.left()) / width) as usize).min(DEPTH_BARS - 1);
        response.on_hover_text(format!("{}: {}", format::digits(value(index)), format::counted(bars[index], unit)));
    }
}
