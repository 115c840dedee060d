//! The picture panel: which picture, its tools, and the picture itself.

pub mod as_shown;
pub mod compared;
pub mod error_legend;
pub mod face_grid;
pub mod gizmos;
pub mod legend;
pub mod legend_entry;
pub mod modes_bar;
pub mod modes_legend;
pub mod outline;
pub mod overlays;
pub mod truth_note;
pub mod vanishing_lines;
pub mod walking;

use crate::capture::{Capture, Image};
use crate::inspector::action::Action;
use crate::inspector::canvas::divider;
use crate::inspector::canvas::magnifier::{self, Occupied};
use crate::inspector::canvas::{self, Canvas, PictureSheet, marks};
use crate::inspector::look::coloring::{ColorMapping, Coloring};
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{ButtonSegment, choice, explained, in_rows, segments, width_in_rows};
use crate::inspector::model::Model;
use crate::inspector::model::comparing::Comparison;
use crate::inspector::model::differing::DifferenceCache;
use crate::inspector::model::looking::{NoStepBefore, StepPhase};
use crate::inspector::model::selection::Hover;
use crate::plan::LightChannel;
use crate::reading::change::{ChangeCache, StepChange};
use crate::reading::format;
use crate::reading::layers::{self, MapContent};
use crate::reading::picture_view::{DepthMode, FaceChoice, PictureKind, ShownPicture, TexelZoom, available, has_truth};
use egui::{Align2, Margin, Rect, Ui, pos2, vec2};
use modes_bar::ToolGroup;
use overlays::Overlays;
use std::sync::Arc;

/// Tools that stay together where a row wraps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum HeadGroup {
    /// The choice of a kind of picture.
    Kinds,
    /// A group of the second row, where a panel is so narrow that both are one.
    Tools(ToolGroup),
    /// Walking, handles and zoom, at the right end.
    Zoom,
}

/// In a panel narrower than this kinds are a list anyway, and its tools follow in the same row, points.
const ONE_ROW: f32 = 640.0;

/// Space around a light's handle that legends and the magnifier leave free, points.
const BESIDE_HANDLE: f32 = 8.0;

/// The state of the panel Picture: cached overlays and changes, and which handles and counts are shown.
#[derive(Debug, Default)]
pub struct PicturePanel {
    /// The geometry of the overlays.
    overlays: Overlays,
    /// The cached changes.
    changes: ChangeCache,
    /// Where compared pictures differ.
    differing: DifferenceCache,
    /// The handles of lights are hidden.
    hides_gizmos: bool,
    /// Where the divider was last: 0 at the picture's left border, 1 at its right one.
    seam: Option<f32>,
    /// The legend of the error picture shows counts, besides the meaning of colours.
    counts_findings: bool,
    /// Number of the frame to which the caches belong.
    frame: u64,
}

impl PicturePanel {
    /// Drops the cached overlays and changes where `frame`, the number of the shown frame, is another than before.
    pub fn follow(&mut self, frame: u64) {
        if std::mem::replace(&mut self.frame, frame) != frame {
            self.changes.forget();
            self.differing.forget();
            self.overlays = Overlays::default();
        }
    }
}

/// Draws the panel Picture: the shown picture with its toolbar, overlays and legend.
pub fn ui(ui: &mut Ui, own: &mut PicturePanel, model: &mut Model, actions: &mut Vec<Action>) {
    own.follow(model.frame.number);
    model.selection.hover = None;
    let Some(capture) = model.frame.capture.clone() else { return empty(ui, model) };
    toolbar(ui, own, model, &capture);
    let rect = ui.available_rect_before_wrap();
    let Some(shown) = model.shown(&capture) else {
        canvas::background(ui, rect, None);
        return nothing(ui, model, &capture, rect);
    };
    let corners = walking::under_banner(model, rect);
    if shown.images.len() == 1 {
        single(ui, own, model, &capture, rect, &shown, actions);
    } else {
        let ColorMapping { coloring, range } = model.shown_coloring(&shown);
        canvas::background(ui, rect, None);
        face_grid::ui(ui, model, rect, &shown, coloring);
        legend::ui(ui, &mut own.counts_findings, model, corners, &shown, range, &taken(model));
    }
    truth_note::ui(ui, model, corners, &shown);
    if model.view.kind == Some(PictureKind::Overdraw) && shown.kind != PictureKind::Overdraw {
        overlays::counting_note(ui, model, corners);
    }
    walking::banner(ui, model, rect);
}

/// Draws one picture with what lies over it: change, comparison, overlays, pick, the selected triangle's outline,
/// handles of lights and legend; acts on mouse and keys.
fn single(
    ui: &mut Ui,
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    rect: Rect,
    shown: &ShownPicture,
    actions: &mut Vec<Action>,
) {
    let beside = model.modes.compare.filter(|one| one.has_two_places() && !model.subtracts(capture, shown));
    let rect = match &beside {
        Some(compare) => compared::beside(ui, own, model, capture, rect, shown, compare),
        None => rect,
    };
    let mapping = model.shown_coloring(shown);
    let ColorMapping { coloring, range } = mapping;
    let PictureLayers { change, sheets, compared } =
        layers(own, model, capture, rect, shown, mapping, model.modes.compare.filter(|_| beside.is_none()));
    let canvas = Canvas {
        name: canvas::PICTURE,
        view: &mut model.view,
        pick: model.selection.pick_of(shown.kind),
        textures: &mut model.textures,
        has_arrows: false,
        picks_by_click: !model.walk.is_on(),
    };
    let (placement, hover) = canvas::ui(ui, canvas, rect, shown, coloring, &sheets);
    // The pointer may be over the picture beside it.
    model.selection.hover = hover.map(|at| Hover { image: 0, at }).or(model.selection.hover);
    if change.is_none() {
        compared::mark_specks(ui, own, model, capture, shown, rect, placement);
    }
    // Lines of the shown scene are not true of what it was before a change.
    let of_scene = match compared.filter(|_| !model.compares_one_scene()) {
        Some(compare) => divider::part(rect, &Comparison { flipped: !compare.flipped, ..compare }),
        None => rect,
    };
    overlays::ui(ui, &mut own.overlays, model, of_scene, shown, placement);
    if shown.kind != PictureKind::Map {
        let mesh = marks(placement, &model.selection.readers, theme::of(ui).selected);
        ui.painter_at(placement.rect().intersect(rect)).add(egui::Shape::mesh(mesh));
        // Lines and marks must not hide the crosshair.
        if let Some(at) = model.selection.pick {
            canvas::crosshair(&ui.painter_at(rect), placement.rect_of(at));
        }
    }
    // Under legends and handles, which are taken hold of first.
    if compared.is_some()
        && let Some(compare) = &mut model.modes.compare
    {
        divider::line(ui, rect, compare);
    }
    overlays::legend(ui, &own.overlays, model, rect, shown);
    outline::ui(ui, model, rect, shown, placement);
    let handles = if own.hides_gizmos { Vec::new() } else { gizmos::ui(ui, model, rect, shown, placement, actions) };
    let corners = walking::under_banner(model, rect);
    // The pick is looked at as much as a handle.
    let picked = model.selection.pick.filter(|_| shown.kind != PictureKind::Map).map(|at| placement.rect_of(at));
    let kept = handles.into_iter().chain(picked).map(|place| place.expand(BESIDE_HANDLE));
    let mut occupied = Occupied { kept: kept.collect(), ..taken(model) };
    match &change {
        Some(change) => {
            let sides = model.modes.compare.map(|compare| compared::names(model, capture, &compare));
            legend::of_change(ui, model, corners, change, sides.as_ref(), &occupied);
        }
        None => {
            let legend = match compared::same_colors(own, model, capture, shown) {
                Some(same) => Some(legend::of_colors(ui, model, corners, same, &occupied)),
                None => legend::ui(ui, &mut own.counts_findings, model, corners, shown, range, &occupied),
            };
            occupied.kept.extend(legend);
            if let Some(pick) = *model.selection.pick_of(shown.kind) {
                magnifier::ui(ui, pick, rect, shown, coloring, placement, &occupied);
            }
        }
    }
    let channel = model.want_channel();
    if let (Some(name), None) = (model.channel().map(LightChannel::name), &channel.ready) {
        let words = channel.failed.unwrap_or_else(|| format!("Capturing {name} light …"));
        compared::card(ui, corners, &words, |_| ());
    }
    if beside.is_none() {
        compared::note(ui, own, model, capture, shown, corners);
    }
    // Last, so that keys and the button of this frame are not kept for a later one.
    if compared::go_to_difference(own, model, capture, shown) {
        ui.ctx().request_repaint();
    }
    own.seam = compared.map(|compare| {
        let x = rect.left() + rect.width() * compare.at;
        placement.texel_position(pos2(x, rect.top())).x / shown.images[0].size()[0].max(1) as f32
    });
    if let Some(mut compare) = model.modes.compare.filter(|_| compared.is_some()) {
        let [other, now] = compared::names_in_place(model, capture, &compare, shown);
        divider::ui(ui, rect, &mut compare, [&other, &now]);
        model.modes.compare = Some(compare);
    }
}

/// Returns the corners of the picture in which a note or the legend of the overlays lies.
fn taken(model: &Model) -> Occupied {
    let is_compared = model.modes.compare.is_some_and(|compare| !compare.has_two_places());
    let has_truth_note =
        model.view.wants_truth() && !model.frame.capture.as_ref().is_some_and(|capture| has_truth(capture));
    let is_counting = model.view.kind == Some(PictureKind::Overdraw);
    let has_note = is_compared || has_truth_note || is_counting || model.channel().is_some();
    let has_overlays = !model.modes.overlays.is_empty();
    let corners = [(Align2::LEFT_TOP, has_note), (Align2::RIGHT_BOTTOM, has_overlays)];
    let taken = corners.into_iter().filter(|(_, is_taken)| *is_taken).map(|(corner, _)| corner).collect();
    Occupied { taken, kept: Vec::new() }
}

/// The layers over a picture: change, tints and compared picture.
pub struct PictureLayers {
    /// The change that the step made.
    pub change: Option<StepChange>,
    /// The pictures, from bottom to top.
    pub sheets: Vec<PictureSheet>,
    /// The comparison, where there is something to compare with.
    pub compared: Option<Comparison>,
}

/// Returns the layers over `shown` in `rect`, from bottom to top: the change, tints, and on one side of `compare`'s
/// divider the compared picture, in the same bit or range. What is not known yet is asked for and left out.
pub fn layers(
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    rect: Rect,
    shown: &ShownPicture,
    mapping: ColorMapping,
    compare: Option<Comparison>,
) -> PictureLayers {
    let mut sheets = Vec::new();
    let change = change_of(own, model, capture, shown);
    let sheet = |image: &Arc<Image>, coloring, part, has_numbers| PictureSheet {
        image: image.clone(),
        coloring,
        part,
        has_numbers,
    };
    if let Some((ground, change)) = &change {
        sheets.push(sheet(ground, Coloring::Srgb, rect, false));
        sheets.push(sheet(&change.image, Coloring::of_change(change.kind), rect, true));
    }
    // Where by how much the sides differ is shown, there are no two pictures to divide.
    let is_difference = change.is_some() && model.modes.compare.is_some();
    let veils = if is_difference { None } else { compared::veils(own, model, capture, shown) };
    sheets.extend(veils.as_ref().map(|[_, veil]| compared::veil_sheet(veil.clone(), rect)));
    sheets.extend(overlays::sheets(&mut own.overlays, model, capture, shown, rect));
    let compare = compare.filter(|_| !is_difference);
    let compared = compare.and_then(|compare| Some((compare, model.shown_compared(capture, shown).ok()?)));
    if let Some((compare, other)) = &compared {
        let beside = compared::coloring_beside(other, mapping);
        let part = divider::part(rect, compare);
        sheets.push(sheet(&other.images[0], beside, part, true));
        sheets.extend(veils.map(|[veil, _]| compared::veil_sheet(veil, part)));
    }
    PictureLayers { change: change.map(|(_, change)| change), sheets, compared: compared.map(|(compare, _)| compare) }
}

/// Returns what the selected step or draw changed, or, of a comparison, by how much counts or depths of the shown side are
/// others than those of the compared one; and the frame's colours in grey to lie under it. `None` unless the mode is the
/// difference, the kind is colour, stencil or depth, and both pictures are known.
pub fn change_of(
    own: &mut PicturePanel,
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
) -> Option<(Arc<Image>, StepChange)> {
    if model.modes.phase != StepPhase::Diff || !shown.kind.has_phases() {
        return None;
    }
    let pair = match model.modes.compare {
        None => {
            let before = model.shown_before(capture).ok().filter(|before| before.kind == shown.kind)?;
            [before.images[0].clone(), shown.images[0].clone()]
        }
        // Of colours both are to be seen.
        Some(_) if shown.kind == PictureKind::Color => return None,
        Some(_) => model.pair_to_compare(capture, shown).ok()?,
    };
    let change = own.changes.change([&pair[0], &pair[1]], shown.measure)?;
    // Counts and depths are shown over the finished frame, in which the place is recognised.
    let at =
        if shown.kind == PictureKind::Color { model.shown_point() } else { capture.steps.len().checked_sub(1)?.into() };
    let colors = at.frame(capture)?.color.image.clone();
    Some((own.changes.ground(&colors), change))
}

/// Draws in the middle of `rect` why there is no picture: there is no known state before, or nothing is drawn yet at
/// this step.
fn nothing(ui: &mut Ui, model: &Model, capture: &Capture, rect: Rect) {
    let text = match model.modes.phase {
        StepPhase::Before => model.shown_before(capture).err().map(NoStepBefore::sentence),
        StepPhase::After | StepPhase::Diff => None,
    };
    let text = text.unwrap_or("Nothing is drawn into the picture yet at this step.");
    let place = Rect::from_center_size(rect.center(), vec2((rect.width() - 32.0).min(420.0), 48.0));
    ui.put(place, egui::Label::new(theme::note(text)).wrap());
}

fn empty(ui: &mut Ui, model: &Model) {
    let rect = ui.available_rect_before_wrap();
    canvas::background(ui, rect, None);
    let lines = match &model.activity.job {
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

/// Draws two rows, in a narrow panel one that wraps, with the permanent tools first: where there are two, nothing moves when
/// tools for one kind of picture come and go, and the picture stays in its place.
fn toolbar(ui: &mut Ui, own: &mut PicturePanel, model: &mut Model, capture: &Arc<Capture>) {
    egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        let shown = model.shown(capture);
        let has_one_row = ui.available_width() < ONE_ROW;
        let tool = |ui: &mut Ui, model: &mut Model, group: ToolGroup| match group {
            ToolGroup::Options => options(ui, model, capture, shown.as_ref(), has_one_row),
            _ => modes_bar::ui(ui, group, model, capture, shown.as_ref()),
        };
        if has_one_row {
            let tools = ToolGroup::ALL.into_iter().map(HeadGroup::Tools);
            let all: Vec<HeadGroup> = [HeadGroup::Kinds].into_iter().chain(tools).chain([HeadGroup::Zoom]).collect();
            in_rows(ui, "narrow tools", theme::ROW_HEIGHT + 2.0, &all, |ui, group| match group {
                HeadGroup::Kinds => kinds(ui, model, capture, f32::INFINITY),
                HeadGroup::Tools(group) => tool(ui, model, group),
                HeadGroup::Zoom => zoom(ui, own, model, capture),
            });
            return;
        }
        let head = [HeadGroup::Kinds, HeadGroup::Zoom];
        let beside = width_in_rows(ui, "head", HeadGroup::Zoom) + ui.spacing().item_spacing.x;
        in_rows(ui, "head", theme::ROW_HEIGHT + 2.0, &head, |ui, group| match group {
            HeadGroup::Kinds => kinds(ui, model, capture, beside),
            HeadGroup::Tools(group) => tool(ui, model, group),
            HeadGroup::Zoom => zoom(ui, own, model, capture),
        });
        // As high as segments are, whether there are any or not.
        in_rows(ui, "tools", theme::ROW_HEIGHT + 2.0, &ToolGroup::ALL, |ui, group| tool(ui, model, group));
    });
}

/// Draws the tools for the shown kind of picture: the choice of light, map layer and depth measure; nothing for other
/// kinds.
fn options(ui: &mut Ui, model: &mut Model, capture: &Capture, shown: Option<&ShownPicture>, has_one_row: bool) {
    match shown.map(|shown| shown.kind) {
        Some(PictureKind::Color) => channels(ui, model, has_one_row),
        Some(PictureKind::Count) => lights(ui, model, capture, |light| light.count.is_some()),
        Some(PictureKind::Visibility) => lights(ui, model, capture, |light| light.visibility.is_some()),
        Some(PictureKind::Mask) => lights(ui, model, capture, |light| light.shadow.is_some()),
        Some(PictureKind::Truth | PictureKind::Error) => {
            lights(ui, model, capture, |light| light.shadow.is_some() || light.truth.is_some());
        }
        Some(PictureKind::Map) => {
            lights(ui, model, capture, |light| light.map.is_some());
            map_layers(ui, model, capture);
            if MapContent::of_capture(capture) == Some(MapContent::Depth) {
                depth_mode(ui, model);
            }
        }
        Some(PictureKind::Depth) => depth_mode(ui, model),
        _ => {}
    }
}

/// Draws the choice of a channel of the light; off where the picture shows a change or a comparison, where all tools have one
/// row left out, and none where no scene is open.
fn channels(ui: &mut Ui, model: &mut Model, has_one_row: bool) {
    if model.scene.is_none() {
        return;
    }
    let is_alone = model.modes.phase == StepPhase::After && model.modes.compare.is_none();
    if has_one_row && !is_alone {
        return;
    }
    let name = |channel: Option<LightChannel>| channel.map_or("all light", LightChannel::name);
    ui.add_enabled_ui(is_alone, |ui| {
        let combo = egui::ComboBox::new("light channel", "").width(76.0).selected_text(name(model.modes.channel));
        let combo = combo.show_ui(ui, |ui| {
            let whole = ui.selectable_value(&mut model.modes.channel, None, name(None));
            explained(ui, whole, "All four together");
            for channel in LightChannel::ALL {
                let line = ui.selectable_value(&mut model.modes.channel, Some(channel), channel.name());
                explained(ui, line, channel.meaning());
            }
        });
        let hover = "The light by what it is: added in linear light, the four pictures are the whole";
        let off = "Of the picture after a step, when nothing is compared";
        combo.response.on_hover_text(hover).on_disabled_hover_text(off).accessible_name("Light in the picture");
    });
}

/// Draws a button for what each step writes, and one for each kind of picture. A kind that this step does not have has
/// its button too, so that nothing moves from step to step.
/// `beside`: the width, points, that is to be left free beside the buttons; where there is not so much, they are a list.
fn kinds(ui: &mut Ui, model: &mut Model, capture: &Capture, beside: f32) {
    let available = available(capture, model.shown_point());
    let kinds: Vec<PictureKind> =
        PictureKind::ALL.into_iter().filter(|kind| !kind.is_of_some_frames() || available.contains(kind)).collect();
    let shown = model.kind();
    let auto = ButtonSegment::new("Auto", "What each step writes: colour, stencil, depth, or a light's map");
    let of_kind = |kind: &PictureKind| {
        let is_enabled = available.contains(kind);
        let [name, meaning] = kind.label(capture);
        let explanation = if is_enabled { meaning } else { kind.why_missing(capture) };
        let is_seen = shown == Some(*kind) && model.view.kind != Some(*kind);
        ButtonSegment { is_enabled, is_seen, ..ButtonSegment::new(name, explanation) }
    };
    let segments: Vec<ButtonSegment> = std::iter::once(auto).chain(kinds.iter().map(of_kind)).collect();
    let chosen =
        model.view.kind.map_or(Some(0), |chosen| kinds.iter().position(|kind| *kind == chosen).map(|at| at + 1));
    // The gap between may reach into the bar's margin.
    match choice(ui, "Kind of picture", &segments, chosen, beside) {
        Some(0) => model.view.follow_steps(),
        Some(index) => model.choose_picture(kinds[index - 1]),
        None => {}
    }
}

/// Draws the choice among the lights for which `has` is true; nothing where there are fewer than two.
fn lights(
    ui: &mut Ui,
    model: &mut Model,
    capture: &Capture,
    has: impl Fn(&crate::capture::CapturedLight) -> bool + Copy,
) {
    let lights: Vec<usize> = (0..capture.lights.len()).filter(|index| has(&capture.lights[*index])).collect();
    if lights.len() < 2 {
        return;
    }
    let Some(current) = model.view.light_with(capture, has) else { return };
    let combo = egui::ComboBox::new("picture light", "").width(72.0).selected_text(format::light(current));
    let combo = combo.show_ui(ui, |ui| {
        for index in lights {
            ui.selectable_value(&mut model.view.light, index, format::light(index));
        }
    });
    combo.response.accessible_name("Light of the picture");
}

/// Draws the choice between one layer of a light's map and all; nothing where it has fewer than two. Another choice
/// drops the picked texel.
fn map_layers(ui: &mut Ui, model: &mut Model, capture: &Capture) {
    let Some(light) = model.view.light_with(capture, |light| light.map.is_some()) else { return };
    let layers = layers::layers(capture, light);
    if layers.len() < 2 {
        return;
    }
    let chosen = match model.view.face {
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
        model.view.face = index.checked_sub(1).map_or(FaceChoice::Grid, FaceChoice::One);
        model.selection.map_pick = None;
    }
}

/// Draws a list to choose a layer from, for names that are too long and too many for buttons. `chosen` is 0 for all and
/// otherwise the layer's index plus 1; returns the new choice, `None` where it did not change.
fn layer_list(ui: &mut Ui, layers: &[layers::MapLayer], mut chosen: usize) -> Option<usize> {
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

fn depth_mode(ui: &mut Ui, model: &mut Model) {
    let labels = [("Linear", "The distance along the view"), ("Raw", "As stored: 1 at the near plane, 0 at infinity")];
    let chosen = usize::from(model.view.depth_mode == DepthMode::Raw);
    if let Some(index) = segments(ui, &labels, Some(chosen)) {
        model.view.depth_mode = if index == 0 { DepthMode::Linear } else { DepthMode::Raw };
        model.view.depth_range = None;
    }
}

/// Draws the buttons for walking, handles, one screen pixel a texel, and
/// fitting. Draws nothing where no picture is shown.
fn zoom(ui: &mut Ui, own: &mut PicturePanel, model: &mut Model, capture: &Capture) {
    let size = model.shown(capture).and_then(|shown| Some(shown.images.first()?.size()));
    let Some(size) = size else { return };
    // So that the buttons for all kinds of picture stand beside them in a window of 1280 points.
    ui.spacing_mut().item_spacing.x = 4.0;
    walking::button(ui, model);
    gizmos::button(ui, &mut own.hides_gizmos, model);
    let fits = model.view.zoom == TexelZoom::Fit;
    let is_exact = model.view.zoom == TexelZoom::Pixels(1.0);
    let word = theme::switch_word(ui, "1:1", is_exact);
    if ui
        .add(egui::Button::selectable(is_exact, word))
        .on_hover_text("One pixel of the screen for each of the picture")
        .clicked()
    {
        if fits {
            model.view.center = size.map(|side| f64::from(side) / 2.0);
        }
        model.view.zoom = TexelZoom::Pixels(1.0);
    }
    let word = theme::switch_word(ui, "Fit", fits);
    if ui.add(egui::Button::selectable(fits, word)).on_hover_text("The whole picture").clicked() {
        model.view.zoom = TexelZoom::Fit;
    }
}
