//! The legend of the error picture: how much is wrong and what the hatching means in two rows, so that little
//! of the picture is hidden; a switch adds the sentence and the counts.

use super::legend_entry;
use crate::accuracy::{ErrorCounts, Finding};
use crate::inspector::look::findings::{self, FindingPattern, FindingStyle};
use crate::inspector::look::theme;
use crate::inspector::look::widgets::in_rows;
use crate::inspector::model::Model;
use crate::numbers::percent;
use crate::reading::format;
use crate::reading::picture_view::ShownPicture;
use egui::{Align, Button, Color32, CornerRadius, FontId, Label, Layout, Rect, Sense, Stroke, Ui};
use egui::{Role, StrokeKind, WidgetInfo, pos2, vec2};

/// The legend's width where there is space, points: three findings side by side.
pub const WIDTH: f32 = 326.0;
/// Height of a line, points.
const LINE: f32 = 18.0;
/// Width and height of a swatch, points: a square one of a dark colour looks like a box to tick.
const SWATCH: [f32; 2] = [14.0, 9.0];
/// The order of the findings: the wrong ones are in the first row.
const ORDER: [Finding; 6] = [
    Finding::FalseShadow,
    Finding::MissingShadow,
    Finding::WrongSurface,
    Finding::EdgeBand,
    Finding::Agrees,
    Finding::NotCompared,
];

/// What stands in the legend's first row, and wraps where it has no space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum HeadGroup {
    /// What it is the legend of, and how much is wrong.
    Words,
    /// The way to the largest region, and the switch.
    Buttons,
}

impl HeadGroup {
    const ALL: [HeadGroup; 2] = [HeadGroup::Words, HeadGroup::Buttons];
}

/// Draws the legend of an error picture: the findings with their colours, the share of wrong pixels, a switch `counts`
/// between numbers and names, and a button that goes to the largest region, if there is one.
pub fn ui(ui: &mut Ui, counts: &mut bool, model: &mut Model, shown: &ShownPicture) {
    ui.spacing_mut().interact_size.y = LINE;
    let truth = model.frame.capture.as_ref().and_then(|capture| model.view.truth_to_show(capture));
    let found = truth.map(|(_, truth)| (truth.error, truth.worst));
    in_rows(ui, "error legend", LINE, &HeadGroup::ALL, |ui, group| match group {
        HeadGroup::Words => {
            theme::heading(ui, &legend_entry::title(shown));
            if let Some((error, _)) = &found {
                // Two pictures that are compared have a share of all pixels.
                ui.label(theme::note(share(error))).on_hover_text("Of the compared pixels, and not of all");
            }
        }
        HeadGroup::Buttons => {
            if let Some(region) = found.and_then(|(_, worst)| worst) {
                let button = ui.add(Button::new(theme::note("Largest")).small()).accessible_name("Go to the largest");
                let hover = "Pick a pixel of the largest wrong patch, and show it large";
                if button.on_hover_text(hover).clicked() {
                    let [left, top, right, bottom] = region.bounds;
                    model.go_to(region.at, (right - left).max(bottom - top) + 1);
                }
            }
            let word = theme::switch_word(ui, "Counts", *counts).size(theme::SMALL_SIZE);
            let switch = ui.add(Button::selectable(*counts, word).small());
            if switch.on_hover_text("How many pixels there are of each kind, or only what the colours mean").clicked() {
                *counts = !*counts;
            }
        }
    });
    let histogram = model.textures.histogram(&shown.images[0]);
    let pixels = |finding: Finding| histogram[finding as usize];
    if *counts {
        if let Some((error, worst)) = &found {
            ui.add(Label::new(theme::note(findings::sentence(error, worst.as_ref()))).wrap());
        }
        Finding::ALL.into_iter().for_each(|finding| counted(ui, finding, pixels(finding)));
    } else {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(12.0, 0.0);
            ORDER.into_iter().for_each(|finding| named(ui, finding, pixels(finding)));
        });
    }
}

/// Returns, in a few words, the share of compared pixels that is wrong: `none wrong`, or `nothing compared` where no
/// pixel is.
fn share(error: &ErrorCounts) -> String {
    match (error.compared, error.wrong()) {
        (0, _) => "nothing compared".to_owned(),
        (_, 0) => "none wrong".to_owned(),
        (compared, wrong) => format!("{} wrong", percent(wrong as f64 / compared as f64)),
    }
}

/// Draws a finding's swatch and name as one widget, so that lines break between findings; dim where no pixel has it,
/// and with the number of pixels as hover text.
fn named(ui: &mut Ui, finding: Finding, pixels: u64) {
    let style = findings::style(finding);
    let ink = if pixels > 0 { theme::of(ui).text } else { theme::of(ui).dim };
    let name = style.name.to_owned();
    let galley = ui.painter().layout_no_wrap(name, FontId::proportional(theme::SMALL_SIZE), ink);
    let (rect, response) = ui.allocate_exact_size(vec2(SWATCH[0] + 4.0 + galley.size().x, LINE), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, style.name));
    let swatch = Rect::from_center_size(pos2(rect.left() + SWATCH[0] / 2.0, rect.center().y), SWATCH.into());
    paint(ui, swatch, style);
    ui.painter().galley(pos2(swatch.right() + 4.0, rect.center().y - galley.size().y / 2.0), galley, ink);
    response.on_hover_text(format!("{}. {}", format::counted(pixels, "pixel"), style.meaning));
}

/// Draws a line of the legend: a finding's swatch, its byte and name, and at the right how many pixels have it.
fn counted(ui: &mut Ui, finding: Finding, pixels: u64) {
    let style = findings::style(finding);
    let line = ui.horizontal(|ui| {
        hatched(ui, style);
        ui.label(theme::number(format!("{} {}", finding as u8, style.name)).color(theme::of(ui).text));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(theme::number(format::count(pixels)).color(theme::of(ui).dim));
        });
    });
    line.response.on_hover_text(style.meaning);
}

/// Draws a swatch in a finding's colour and hatching at the next free place.
pub fn hatched(ui: &mut Ui, style: FindingStyle) {
    let (rect, _) = ui.allocate_exact_size(SWATCH.into(), Sense::hover());
    paint(ui, rect, style);
}

fn paint(ui: &Ui, rect: Rect, style: FindingStyle) {
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, CornerRadius::same(2), style.color);
    let stroke = Stroke::new(1.5, style.color.lerp_to_gamma(Color32::BLACK, 0.6));
    let (rising, falling) = match style.pattern {
        FindingPattern::Rising => (true, false),
        FindingPattern::Falling => (false, true),
        FindingPattern::Crossed => (true, true),
        FindingPattern::Plain => (false, false),
        FindingPattern::Dotted => {
            for (x, y) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                painter.circle_filled(rect.lerp_inside(vec2(x, y)), 1.4, stroke.color);
            }
            (false, false)
        }
    };
    // As steep as in the picture.
    let (middle, slope) = (rect.center(), vec2(SWATCH[1], -SWATCH[1]) / 2.0);
    for shift in [-12.0, -6.0, 0.0, 6.0, 12.0] {
        let aside = vec2(shift, 0.0);
        if rising {
            painter.line_segment([middle + aside - slope, middle + aside + slope], stroke);
        }
        if falling {
            painter.line_segment([middle + aside - slope.rot90(), middle + aside + slope.rot90()], stroke);
        }
    }
    painter.rect_stroke(rect, CornerRadius::same(2), Stroke::new(1.0, theme::of(ui).faint), StrokeKind::Inside);
}
