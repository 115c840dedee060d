//! A row of the list of wrong regions, and where a click on it goes.

use crate::capture::{Capture, FrameTarget, Snapshot};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::format;
use crate::reading::picture_view::PictureKind;
use egui::{Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

/// Where the words of a region's row begin, and its height without its title, points.
const INDENT: f32 = 28.0;
const BELOW_TITLE: f32 = 26.0;

/// A row of the list of wrong regions.
pub struct RegionRow {
    /// Its number and what is wrong.
    pub title: String,
    /// How many pixels it has.
    pub pixels: u64,
    /// Its most likely cause, or why it has none.
    pub because: String,
    /// The colour that it has in the error picture.
    pub color: egui::Color32,
}

impl RegionRow {
    /// Draws the row; returns whether it was clicked.
    pub fn ui(self, ui: &mut Ui, is_selected: bool) -> bool {
        let RegionRow { title: numbered, pixels, because, color } = self;
        let pixels = format::counted(pixels, "pixel");
        // The last words of a title distinguish rows: they go on in a second line.
        let font = TextStyle::Body.resolve(ui.style());
        let width = (ui.available_width() - INDENT - 8.0).max(1.0);
        let lines = ui.painter().layout(numbered.clone(), font, theme::of(ui).text, width);
        let height = lines.size().y + BELOW_TITLE;
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
        let name = format!("{numbered}: {pixels}, {because}");
        response.widget_info(|| WidgetInfo::selected(Role::Row, true, is_selected, &name));
        theme::row_background(ui, rect, is_selected, &response);
        let left = rect.left() + INDENT;
        let swatch = egui::Rect::from_min_size(rect.min + vec2(12.0, 8.0), vec2(10.0, 10.0));
        ui.painter().rect_filled(swatch, 2.0, color);
        let below = pos2(left, rect.top() + 6.0 + lines.size().y);
        ui.painter().galley(pos2(left, rect.top() + 5.0), lines, theme::of(ui).text);
        let second = format!("{pixels} · {because}");
        theme::line(ui, below, rect.right() - left - 8.0, &second, TextStyle::Small, theme::of(ui).dim);
        let hover = "Click to go to a pixel of it and to what happened there.";
        response.on_hover_text(hover).clicked()
    }
}

/// Picks a pixel of a region in the error picture, enlarged so that the region takes a good part of the panel, and
/// selects the step that decided the region's light, if there is one and an earlier step is selected.
pub fn go_to(model: &mut Model, light: usize, at: [u32; 2], [left, top, right, bottom]: [u32; 4]) {
    let decided = model.frame.capture.as_ref().and_then(|capture| deciding_step(capture, light));
    // Where the light was drawn already its wrong pixels are seen in colour, too: the step stays.
    if let Some(step) = decided.filter(|step| *step > model.selection.step) {
        model.select_step(step);
    }
    model.view.light = light;
    model.choose_picture(PictureKind::Error);
    model.go_to(at, (right - left).max(bottom - top) + 1);
}

/// Returns the index of the last pass of a light that draws into the picture or its float counts before its labels are
/// written; where there is none, of the pass that writes the labels, or else of the light's last pass. `None` where the
/// light has no pass.
fn deciding_step(capture: &Capture, light: usize) -> Option<usize> {
    let target = |index: usize| match &capture.steps.get(index)?.snapshot {
        Snapshot::Frame(frame) => Some(frame.target),
        Snapshot::Map { .. } => None,
    };
    let of_light: Vec<usize> =
        (0..capture.steps.len()).filter(|index| capture.steps[*index].light == Some(light)).collect();
    let mask = of_light.iter().copied().find(|index| target(*index) == Some(FrameTarget::Labels));
    let counts = |index: &usize| matches!(target(*index), Some(FrameTarget::Picture | FrameTarget::Count));
    let before = of_light.iter().copied().rfind(|index| mask.is_some_and(|mask| *index < mask) && counts(index));
    before.or(mask).or(of_light.last().copied())
}
