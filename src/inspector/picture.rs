//! The picture panel: which picture, its tools, and the picture itself.

use super::action::Action;
use super::canvas;
use super::coloring::Coloring;
use super::depth::{DepthMeasure, DepthScale};
use super::format;
use super::legend;
use super::magnifier;
use super::placement::Placement;
use super::state::{Hover, State};
use super::texture::TextureSize;
use super::theme;
use super::top_bar::segments;
use super::truth_note;
use super::view::{CUBE_FACES, DepthMode, FaceChoice, PictureKind, Shown, Zoom, available};
use crate::capture::{Capture, Image};
use egui::{Align2, CornerRadius, Margin, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use std::sync::Arc;

/// Draws the panel.
pub fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    state.hover = None;
    let Some(capture) = state.capture.clone() else { return empty(ui, state) };
    toolbar(ui, state, &capture);
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::BACKGROUND);
    let Some(shown) = state.view.shown(&capture, state.step) else {
        ui.painter().text(
            rect.center(),
            Align2::CENTER_CENTER,
            "Nothing is drawn into the picture yet at this step.",
            egui::TextStyle::Body.resolve(ui.style()),
            theme::DIM,
        );
        return;
    };
    let range = shown_range(state, &shown);
    let coloring = coloring_of(&shown, range);
    if shown.images.len() == 1 {
        let placement = canvas::ui(ui, state, rect, &shown, coloring);
        magnifier::ui(ui, state, rect, &shown, coloring, placement);
    } else {
        faces(ui, state, rect, &shown, coloring);
    }
    legend::ui(ui, state, rect, &shown, range);
    truth_note::ui(ui, state, rect, &shown, actions);
}

fn empty(ui: &mut Ui, state: &State) {
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::BACKGROUND);
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

/// What the texels of `shown` mean, depths over `range`.
#[must_use]
pub fn coloring_of(shown: &Shown, range: [f64; 2]) -> Coloring {
    match shown.kind {
        PictureKind::Color => Coloring::Srgb,
        PictureKind::Stencil => Coloring::Stencil,
        PictureKind::Mask | PictureKind::Truth => Coloring::Labels,
        PictureKind::Error => Coloring::Findings,
        PictureKind::Depth | PictureKind::Map => Coloring::Depth(DepthScale { measure: shown.measure, range }),
    }
}

/// The grey ramp's ends: as set by hand, or those of all shown pictures.
fn shown_range(state: &mut State, shown: &Shown) -> [f64; 2] {
    state.view.depth_range.unwrap_or_else(|| full_range(state, shown))
}

/// The smallest and largest depth of all shown pictures; `[0, 1]` where there is none.
pub fn full_range(state: &mut State, shown: &Shown) -> [f64; 2] {
    if !matches!(shown.kind, PictureKind::Depth | PictureKind::Map) {
        return [0.0, 1.0];
    }
    let ranges = shown.images.iter().filter_map(|image| state.cache.depth_range(image, shown.measure));
    ranges.reduce(|[low, high], [l, h]| [low.min(l), high.max(h)]).unwrap_or([0.0, 1.0])
}

fn toolbar(ui: &mut Ui, state: &mut State, capture: &Capture) {
    egui::Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        ui.horizontal(|ui| {
            kinds(ui, state, capture);
            let kind = state.view.shown(capture, state.step).map(|shown| shown.kind);
            match kind {
                Some(PictureKind::Mask) => lights(ui, state, capture, |light| light.shadow.is_some()),
                Some(PictureKind::Truth | PictureKind::Error) => {
                    lights(ui, state, capture, |light| light.shadow.is_some() || light.truth.is_some());
                }
                Some(PictureKind::Map) => {
                    lights(ui, state, capture, |light| light.map.is_some());
                    cube_faces(ui, state, capture);
                    depth_mode(ui, state);
                }
                Some(PictureKind::Depth) => depth_mode(ui, state),
                _ => {}
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| zoom(ui, state, capture));
        });
    });
}

/// A button for each kind of picture that exists at this step.
fn kinds(ui: &mut Ui, state: &mut State, capture: &Capture) {
    let kinds = available(capture, state.step);
    let labels: Vec<(&str, &str)> = kinds.iter().map(|kind| (kind.name(), kind.meaning())).collect();
    // What was chosen, even while its truth is not known yet.
    let is_asked_for = state.view.kind.needs_truth() && kinds.contains(&state.view.kind);
    let shown = || state.view.shown(capture, state.step).map(|shown| shown.kind);
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

/// Which face of a cube map, or all.
fn cube_faces(ui: &mut Ui, state: &mut State, capture: &Capture) {
    let light = state.view.light_with(capture, |light| light.map.is_some());
    let faces = light.and_then(|light| Some(capture.lights.get(light)?.map.as_ref()?.faces.len())).unwrap_or(0);
    if faces < 2 {
        return;
    }
    let mut labels = vec![("All", "All faces of the cube")];
    labels.extend(CUBE_FACES.iter().take(faces).map(|name| (*name, "One face of the cube")));
    let chosen = match state.view.face {
        FaceChoice::Grid => 0,
        FaceChoice::One(face) => face + 1,
    };
    if let Some(index) = segments(ui, &labels, Some(chosen)) {
        state.view.face = index.checked_sub(1).map_or(FaceChoice::Grid, FaceChoice::One);
        state.map_pick = None;
    }
}

fn depth_mode(ui: &mut Ui, state: &mut State) {
    let labels = [("Linear", "The distance in metres"), ("Raw", "As stored: 1 at the near plane, 0 at infinity")];
    let chosen = usize::from(state.view.depth_mode == DepthMode::Raw);
    if let Some(index) = segments(ui, &labels, Some(chosen)) {
        state.view.depth_mode = if index == 0 { DepthMode::Linear } else { DepthMode::Raw };
        state.view.depth_range = None;
    }
}

/// Right to left: the zoom in per cent, Fit, 1:1.
fn zoom(ui: &mut Ui, state: &mut State, capture: &Capture) {
    let size = state.view.shown(capture, state.step).and_then(|shown| Some(shown.images.first()?.size()));
    let Some(size) = size else { return };
    if let Zoom::Pixels(pixels) = state.view.zoom {
        ui.label(theme::number(format!("{:.0} %", pixels * 100.0)).color(theme::DIM));
    }
    let fits = state.view.zoom == Zoom::Fit;
    let word =
        |text: &str, chosen: bool| egui::RichText::new(text).color(if chosen { theme::TEXT } else { theme::DIM });
    if ui.add(egui::Button::selectable(fits, word("Fit", fits))).on_hover_text("The whole picture").clicked() {
        state.view.zoom = Zoom::Fit;
    }
    let is_exact = state.view.zoom == Zoom::Pixels(1.0);
    if ui
        .add(egui::Button::selectable(is_exact, word("1:1", is_exact)))
        .on_hover_text("One screen pixel a texel")
        .clicked()
    {
        if fits {
            state.view.center = size.map(|side| f64::from(side) / 2.0);
        }
        state.view.zoom = Zoom::Pixels(1.0);
    }
}

/// The six faces of a cube map, named; a click shows one of them large. They leave room for the
/// legend.
fn faces(ui: &mut Ui, state: &mut State, rect: Rect, shown: &Shown, coloring: Coloring) {
    let area = Rect::from_min_max(rect.min, rect.max - vec2(legend::room(rect, shown.kind), 0.0)).shrink(8.0);
    let caption = 24.0;
    let side_of = |columns: usize| {
        let rows = shown.images.len().div_ceil(columns).max(1);
        (area.width() / columns as f32 - 8.0).min(area.height() / rows as f32 - caption).max(1.0)
    };
    // As large as they get.
    let columns = [2, 3, 6].into_iter().max_by(|a, b| side_of(*a).total_cmp(&side_of(*b))).unwrap_or(3);
    let side = side_of(columns);
    for (index, image) in shown.images.iter().enumerate() {
        let cell = vec2((index % columns) as f32 * (side + 8.0), (index / columns) as f32 * (side + caption));
        let square = Rect::from_min_size(area.min + cell + vec2(0.0, caption - 4.0), vec2(side, side));
        face(ui, state, index, image, coloring, square);
    }
}

fn face(ui: &mut Ui, state: &mut State, index: usize, image: &Arc<Image>, coloring: Coloring, square: Rect) {
    let name = CUBE_FACES.get(index).copied().unwrap_or("?");
    let response = ui.interact(square, ui.scope_id().with(("face", index)), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Face {name}")));
    let texture = state.cache.texture(ui.ctx(), image, coloring, TextureSize::Full);
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), square, uv, egui::Color32::WHITE);
    let outline = if response.hovered() || response.has_focus() { theme::FOCUS } else { theme::LINE };
    ui.painter().rect_stroke(square, CornerRadius::ZERO, Stroke::new(1.0, outline), StrokeKind::Outside);
    let clear = state.capture.as_ref().map_or(0.0, |capture| capture.depth.mapping.clear_depth());
    let any_distance = DepthMeasure::Parallel { near: 0.0, length: 1.0, clear };
    let sees_nothing = state.cache.depth_range(image, any_distance).is_none();
    let (caption, ink) =
        if sees_nothing { (format!("{name} sees no caster"), theme::FAINT) } else { (name.to_owned(), theme::TEXT) };
    let font = theme::number_font(theme::SMALL_SIZE);
    ui.painter().text(square.left_top() - vec2(0.0, 3.0), Align2::LEFT_BOTTOM, caption, font, ink);
    if let Some(at) = response.hover_pos() {
        let scale = square.width() / image.size()[0].max(1) as f32;
        let placement = Placement { origin: square.min, scale, size: image.size() };
        state.hover = placement.texel(at).map(|at| Hover { image: index, at });
    }
    if response.on_hover_text(format!("Show face {name} large")).clicked() {
        state.view.face = FaceChoice::One(index);
        state.view.zoom = Zoom::Fit;
    }
}
