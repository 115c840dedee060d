//! The picture panel: which picture, its tools, and the picture itself.

use super::action::Action;
use super::canvas::{self, Sheet};
use super::change::Change;
use super::coloring::Coloring;
use super::compare::{Compare, With};
use super::depth::DepthScale;
use super::divider;
use super::face_grid;
use super::format;
use super::layers::{self, MapContent};
use super::legend;
use super::magnifier;
use super::modes::{NoBefore, Phase, has_phases};
use super::modes_bar;
use super::outline;
use super::overlays;
use super::picture_gizmos;
use super::shadow_map;
use super::state::State;
use super::theme;
use super::top_bar::segments;
use super::truth_note;
use super::view::{DepthMode, FaceChoice, PictureKind, Shown, Zoom, available};
use super::walk;
use crate::capture::{Capture, Image};
use egui::{CornerRadius, Margin, Rect, Ui, pos2, vec2};
use std::sync::Arc;

/// What is compared with has its place at the right end of the second row where so much is left there, points.
const COMPARE_WIDTH: f32 = 232.0;

/// Draws the panel.
pub fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    state.hover = None;
    let Some(capture) = state.capture.clone() else { return empty(ui, state) };
    toolbar(ui, state, &capture);
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::of(ui).background);
    let Some(shown) = state.shown(&capture) else { return nothing(ui, state, &capture, rect) };
    let (coloring, range) = shown_coloring(state, &shown);
    let corners = walk::under_banner(state, rect);
    if shown.images.len() == 1 {
        single(ui, state, &capture, rect, &shown, (coloring, range), actions);
    } else {
        face_grid::ui(ui, state, rect, &shown, coloring);
        legend::ui(ui, state, corners, &shown, range);
    }
    truth_note::ui(ui, state, corners, &shown, actions);
    if state.view.kind == PictureKind::Overdraw && shown.kind != PictureKind::Overdraw {
        overlays::counting_note(ui, state, corners);
    }
    walk::banner(ui, state, rect);
}

/// One picture with what is over it: what changed, or what is compared.
fn single(
    ui: &mut Ui,
    state: &mut State,
    capture: &Capture,
    rect: Rect,
    shown: &Shown,
    (coloring, range): (Coloring, [f64; 2]),
    actions: &mut Vec<Action>,
) {
    let Layers { change, sheets, compared } =
        layers(state, capture, rect, shown, (coloring, range), state.modes.compare);
    let placement = canvas::ui(ui, state, rect, shown, coloring, &sheets, canvas::PICTURE);
    overlays::ui(ui, state, rect, shown, placement);
    if shown.kind != PictureKind::Map {
        let mesh = shadow_map::marks(placement, state.map_tab.marked(), theme::of(ui).selected);
        ui.painter_at(placement.rect().intersect(rect)).add(egui::Shape::mesh(mesh));
        // Lines and marks must not hide it.
        if let Some(at) = state.pick {
            canvas::crosshair(&ui.painter_at(rect), placement.rect_of(at));
        }
    }
    outline::ui(ui, state, rect, shown, placement);
    picture_gizmos::ui(ui, state, rect, shown, placement, actions);
    let corners = walk::under_banner(state, rect);
    match &change {
        Some(change) => legend::of_change(ui, corners, change),
        None => {
            magnifier::ui(ui, state, rect, shown, coloring, placement);
            legend::ui(ui, state, corners, shown, range);
        }
    }
    modes_bar::compare_note(ui, state, capture, shown, corners);
    state.modes.seam = compared.map(|compare| {
        let x = rect.left() + rect.width() * compare.at;
        placement.texel_position(pos2(x, rect.top())).x / shown.images[0].size()[0].max(1) as f32
    });
    if let Some(mut compare) = compared {
        let [beside, now] = compared_names(state, capture, &compare);
        divider::ui(ui, rect, &mut compare, [&beside, &now]);
        state.modes.compare = Some(compare);
    }
}

/// What lies over a picture.
pub struct Layers {
    /// What the step changed.
    pub change: Option<Change>,
    /// The pictures, in the order in which they lie.
    pub sheets: Vec<Sheet>,
    /// The comparison, where there is something to compare with.
    pub compared: Option<Compare>,
}

/// What lies over `shown` in `rect`: what changed, tints, and on one side of `compare`'s divider what is compared.
pub fn layers(
    state: &mut State,
    capture: &Capture,
    rect: Rect,
    shown: &Shown,
    (coloring, range): (Coloring, [f64; 2]),
    compare: Option<Compare>,
) -> Layers {
    let mut sheets = Vec::new();
    let change = change_of(state, capture, shown);
    if let Some((ground, change)) = &change {
        let sheet = |image: &Arc<Image>, coloring, has_numbers| Sheet {
            image: image.clone(),
            coloring,
            part: rect,
            has_numbers,
        };
        sheets.push(sheet(ground, Coloring::Srgb, false));
        sheets.push(sheet(&change.image, change.coloring(), true));
    }
    sheets.extend(overlays::sheets(state, capture, shown, rect));
    let compared = compare.and_then(|compare| Some((compare, state.shown_compared(capture, shown).ok()?)));
    if let Some((compare, other)) = &compared {
        let mut beside = coloring_of(other, range);
        if let Coloring::Bit(_) = coloring {
            beside = coloring;
        }
        let part = divider::part(rect, compare);
        sheets.push(Sheet { image: other.images[0].clone(), coloring: beside, part, has_numbers: true });
    }
    Layers { change: change.map(|(_, change)| change), sheets, compared: compared.map(|(compare, _)| compare) }
}

/// What the sides of a comparison are called: the compared one, and the one that is shown.
pub fn compared_names(state: &State, capture: &Capture, compare: &Compare) -> [String; 2] {
    let now = match compare.with {
        With::Step(_) => state.moment().words(),
        With::Technique(_) => capture.technique.clone(),
    };
    [compare.with.words(capture), now]
}

/// What the selected step or draw changed, over the frame's colours in grey; `None` where that is not shown.
pub fn change_of(state: &mut State, capture: &Capture, shown: &Shown) -> Option<(Arc<Image>, Change)> {
    if state.modes.phase != Phase::Diff || !has_phases(shown.kind) {
        return None;
    }
    let before = state.shown_before(capture).ok().filter(|before| before.kind == shown.kind)?;
    let change = state.modes.changes.change([&before.images[0], &shown.images[0]], shown.measure)?;
    // Of counts and depths it is the finished frame that shows where one is.
    let at = if shown.kind == PictureKind::Color { state.moment() } else { capture.steps.len().checked_sub(1)?.into() };
    let colors = at.frame(capture)?.color.image.clone();
    Some((state.modes.changes.ground(&colors), change))
}

/// There is no picture, and why.
fn nothing(ui: &mut Ui, state: &State, capture: &Capture, rect: Rect) {
    let text = match state.modes.phase {
        Phase::Before => state.shown_before(capture).err().map(NoBefore::sentence),
        Phase::After | Phase::Diff => None,
    };
    let text = text.unwrap_or("Nothing is drawn into the picture yet at this step.");
    let place = Rect::from_center_size(rect.center(), vec2((rect.width() - 32.0).min(420.0), 48.0));
    ui.put(place, egui::Label::new(theme::note(text)).wrap());
}

fn empty(ui: &mut Ui, state: &State) {
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::of(ui).background);
    let lines = match &state.job {
        Some(job) => [job.as_str(), ""],
        None => ["Nothing is open yet.", "Press Open…, or drop a scene, a model or a capture folder here."],
    };
    let middle = Rect::from_center_size(rect.center(), vec2(rect.width().min(420.0), 60.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(middle), |ui| {
        ui.vertical_centered(|ui| {
            theme::heading(ui, lines[0]);
            ui.label(theme::note(lines[1]));
        });
    });
}

/// What the texels of `shown` mean as it is looked at, and the ends of the grey ramp.
pub fn shown_coloring(state: &mut State, shown: &Shown) -> (Coloring, [f64; 2]) {
    let range = shown_range(state, shown);
    match (coloring_of(shown, range), state.modes.bit) {
        (Coloring::Stencil, Some(bit)) => (Coloring::Bit(bit), range),
        (coloring, _) => (coloring, range),
    }
}

/// What the texels of `shown` mean, depths over `range`.
#[must_use]
pub fn coloring_of(shown: &Shown, range: [f64; 2]) -> Coloring {
    match shown.kind {
        PictureKind::Color => Coloring::Srgb,
        PictureKind::Stencil => Coloring::Stencil,
        PictureKind::Count => Coloring::Count,
        PictureKind::Mask | PictureKind::Truth => Coloring::Labels,
        PictureKind::Error => Coloring::Findings,
        PictureKind::Overdraw => Coloring::Overdraw,
        PictureKind::Map if shown.is_let_through() => Coloring::Linear,
        PictureKind::Depth | PictureKind::Map => Coloring::Depth(DepthScale { measure: shown.measure, range }),
    }
}

/// The grey ramp's ends: as set by hand, or those of all shown pictures.
pub fn shown_range(state: &mut State, shown: &Shown) -> [f64; 2] {
    state.view.depth_range.unwrap_or_else(|| full_range(state, shown))
}

/// The smallest and largest depth of all shown pictures; `[0, 1]` where there is none.
pub fn full_range(state: &mut State, shown: &Shown) -> [f64; 2] {
    if !matches!(coloring_of(shown, [0.0, 1.0]), Coloring::Depth(_)) {
        return [0.0, 1.0];
    }
    let ranges = shown.images.iter().filter_map(|image| state.cache.depth_range(image, shown.measure));
    ranges.reduce(|[low, high], [l, h]| [low.min(l), high.max(h)]).unwrap_or([0.0, 1.0])
}

/// Two rows in every window, and what is always there first: nothing moves when tools of one kind of picture
/// come and go, and the picture keeps its place.
fn toolbar(ui: &mut Ui, state: &mut State, capture: &Capture) {
    egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        let shown = state.shown(capture);
        ui.horizontal(|ui| {
            kinds(ui, state, capture);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| zoom(ui, state, capture));
        });
        let mut has_place = true;
        // As high as segments are, whether there are any or not.
        let row = vec2(ui.available_width(), theme::ROW_HEIGHT + 2.0);
        ui.allocate_ui_with_layout(row, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            modes_bar::ui(ui, state, shown.as_ref());
            options(ui, state, capture, shown.as_ref());
            has_place = ui.available_width() >= COMPARE_WIDTH;
            if has_place {
                modes_bar::compare_row(ui, state, capture);
            }
        });
        if !has_place && state.modes.compare.is_some() {
            ui.horizontal(|ui| modes_bar::compare_row(ui, state, capture));
        }
    });
}

/// What goes with one kind of picture only.
fn options(ui: &mut Ui, state: &mut State, capture: &Capture, shown: Option<&Shown>) {
    match shown.map(|shown| shown.kind) {
        Some(PictureKind::Count) => lights(ui, state, capture, |light| light.count.is_some()),
        Some(PictureKind::Mask) => lights(ui, state, capture, |light| light.shadow.is_some()),
        Some(PictureKind::Truth | PictureKind::Error) => {
            lights(ui, state, capture, |light| light.shadow.is_some() || light.truth.is_some());
        }
        Some(PictureKind::Map) => {
            lights(ui, state, capture, |light| light.map.is_some());
            map_layers(ui, state, capture);
            if MapContent::of_capture(capture) == Some(MapContent::Depth) {
                depth_mode(ui, state);
            }
        }
        Some(PictureKind::Depth) => depth_mode(ui, state),
        _ => {}
    }
}

/// A button for each kind of picture that exists at this step.
fn kinds(ui: &mut Ui, state: &mut State, capture: &Capture) {
    let kinds = available(capture, state.moment());
    let labels: Vec<(&str, &str)> = kinds.iter().map(|kind| (kind.name(capture), kind.meaning(capture))).collect();
    // What was chosen, even while its truth is not known yet.
    let is_made_later = state.view.kind.needs_truth() || state.view.kind == PictureKind::Overdraw;
    let is_asked_for = is_made_later && kinds.contains(&state.view.kind);
    let shown = || state.shown(capture).map(|shown| shown.kind);
    let current = if is_asked_for { Some(state.view.kind) } else { shown() };
    let chosen = kinds.iter().position(|kind| Some(*kind) == current);
    if let Some(index) = segments(ui, &labels, chosen) {
        state.choose_picture(kinds[index]);
    }
}

/// Which light's mask or map, where there are several.
fn lights(
    ui: &mut Ui,
    state: &mut State,
    capture: &Capture,
    has: impl Fn(&crate::capture::CapturedLight) -> bool + Copy,
) {
    let lights: Vec<usize> = (0..capture.lights.len()).filter(|index| has(&capture.lights[*index])).collect();
    if lights.len() < 2 {
        return;
    }
    let Some(current) = state.view.light_with(capture, has) else { return };
    let combo = egui::ComboBox::new("picture light", "").width(72.0).selected_text(format::light(current));
    let combo = combo.show_ui(ui, |ui| {
        for index in lights {
            ui.selectable_value(&mut state.view.light, index, format::light(index));
        }
    });
    combo.response.accessible_name("Light of the picture");
}

/// Which layer of a map, or all.
fn map_layers(ui: &mut Ui, state: &mut State, capture: &Capture) {
    let Some(light) = state.view.light_with(capture, |light| light.map.is_some()) else { return };
    let layers = layers::layers(capture, light);
    if layers.len() < 2 {
        return;
    }
    let chosen = match state.view.face {
        FaceChoice::One(layer) if layer < layers.len() => layer + 1,
        _ => 0,
    };
    let choice = if MapContent::of(capture, light) == Some(MapContent::Depth) {
        let mut labels = vec![("All", "All faces of the cube")];
        labels.extend(layers.iter().map(|layer| (layer.name.as_str(), "One face of the cube")));
        segments(ui, &labels, Some(chosen))
    } else {
        layer_list(ui, &layers, chosen)
    };
    if let Some(index) = choice {
        state.view.face = index.checked_sub(1).map_or(FaceChoice::Grid, FaceChoice::One);
        state.map_pick = None;
    }
}

/// Names too long and too many for buttons.
fn layer_list(ui: &mut Ui, layers: &[layers::Layer], mut chosen: usize) -> Option<usize> {
    let before = chosen;
    let all = format!("All {}", layers.len());
    let current = chosen.checked_sub(1).map_or(all.as_str(), |layer| &layers[layer].name);
    let combo = egui::ComboBox::new("picture layer", "").width(112.0).selected_text(current).truncate();
    let combo = combo.show_ui(ui, |ui| {
        ui.selectable_value(&mut chosen, 0, all.as_str());
        for (index, layer) in layers.iter().enumerate() {
            let ink = if layer.note.is_some() { theme::of(ui).dim } else { theme::of(ui).text };
            let text = egui::RichText::new(&layer.full_name).color(ink);
            let response = ui.selectable_value(&mut chosen, index + 1, text);
            if let Some(note) = layer.note {
                response.on_hover_text(note);
            }
        }
    });
    combo.response.accessible_name("Layer of the picture");
    (chosen != before).then_some(chosen)
}

fn depth_mode(ui: &mut Ui, state: &mut State) {
    let labels = [("Linear", "The distance in metres"), ("Raw", "As stored: 1 at the near plane, 0 at infinity")];
    let chosen = usize::from(state.view.depth_mode == DepthMode::Raw);
    if let Some(index) = segments(ui, &labels, Some(chosen)) {
        state.view.depth_mode = if index == 0 { DepthMode::Linear } else { DepthMode::Raw };
        state.view.depth_range = None;
    }
}

/// Right to left: Fit, 1:1, the other buttons, and the zoom in per cent where it moves none of them.
fn zoom(ui: &mut Ui, state: &mut State, capture: &Capture) {
    let size = state.shown(capture).and_then(|shown| Some(shown.images.first()?.size()));
    let Some(size) = size else { return };
    let fits = state.view.zoom == Zoom::Fit;
    let word = theme::switch_word(ui, "Fit", fits);
    if ui.add(egui::Button::selectable(fits, word)).on_hover_text("The whole picture").clicked() {
        state.view.zoom = Zoom::Fit;
    }
    let is_exact = state.view.zoom == Zoom::Pixels(1.0);
    let word = theme::switch_word(ui, "1:1", is_exact);
    if ui.add(egui::Button::selectable(is_exact, word)).on_hover_text("One screen pixel a texel").clicked() {
        if fits {
            state.view.center = size.map(|side| f64::from(side) / 2.0);
        }
        state.view.zoom = Zoom::Pixels(1.0);
    }
    picture_gizmos::button(ui, state);
    walk::button(ui, state);
    if let Zoom::Pixels(pixels) = state.view.zoom {
        ui.label(theme::number(format!("{:.0} %", pixels * 100.0)).color(theme::of(ui).dim));
    }
}
