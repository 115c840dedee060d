//! The shadow map tab: a face of a light's map with the values of its texels, beside a small picture. A
//! texel and the pixels that read it are marked in both, and so is what each covers of the other: a pixel of
//! the map, a texel of the surface.

use super::canvas;
use super::depth::DepthMeasure;
use super::format;
use super::layers::{self, MapContent};
use super::map_readers::{MapReaders, MapReadersFound, MapReadersJob, MapTexel};
use super::pick_ray;
use super::picture::{coloring_of, shown_range};
use super::placement::Placement;
use super::state::State;
use super::texture::TextureSize;
use super::theme;
use super::top_bar::segments;
use super::view::{FaceChoice, PictureKind, PictureView, Zoom};
use crate::capture::{Capture, CapturedMap};
use crate::plan::FramePlan;
use crate::technique::MapSettings;
use egui::epaint::Mesh;
use egui::{
    Color32, CornerRadius, Margin, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, pos2, vec2,
};
use glam::DVec2;
use std::sync::Arc;

/// Width of the column beside the map, points.
const COLUMN: f32 = 232.0;
/// Marks are at least so large, points.
const LEAST_MARK: f32 = 2.5;
/// Marks that are drawn at most.
const MOST_MARKS: usize = 12_000;

/// What the tab remembers.
#[derive(Debug, Default)]
pub struct MapTab {
    view: PictureView,
    /// The picked texel of the shown face.
    pick: Option<[u32; 2]>,
    /// Whose map.
    light: usize,
    readers: Readers,
    marked: Option<(MapTexel, Arc<Vec<[u32; 2]>>)>,
    /// What the pointer is over in the small picture.
    over_pixel: Option<[u32; 2]>,
    /// It was drawn in this frame; taken by the picture.
    is_shown: bool,
    /// Nobody has chosen the face that is shown.
    is_any_face: bool,
}

/// Which texel each pixel reads: asked for once for a frame and light, while the tab is shown.
#[derive(Debug, Default)]
struct Readers {
    /// Of the frame and light that are shown now.
    ticket: u64,
    /// Whose map it is of.
    light: usize,
    stage: Stage,
}

#[derive(Debug, Default)]
enum Stage {
    #[default]
    NotWanted,
    Wanted,
    Asked,
    Found(Option<Arc<MapReaders>>),
}

impl Readers {
    /// What was asked for is of no use any longer.
    fn forget(&mut self) {
        self.ticket += 1;
        self.stage = Stage::NotWanted;
    }

    fn is_waited_for(&self) -> bool {
        matches!(self.stage, Stage::Wanted | Stage::Asked)
    }

    fn found(&self) -> Option<&Arc<MapReaders>> {
        match &self.stage {
            Stage::Found(readers) => readers.as_ref(),
            Stage::NotWanted | Stage::Wanted | Stage::Asked => None,
        }
    }
}

impl MapTab {
    /// Another frame is shown.
    pub fn forget_frame(&mut self) {
        self.readers.forget();
        self.marked = None;
        self.over_pixel = None;
    }

    /// Which texel each pixel reads; `None` while that is not known.
    fn readers(&mut self) -> Option<Arc<MapReaders>> {
        if self.readers.light != self.light {
            self.readers.forget();
            self.readers.light = self.light;
            self.marked = None;
        }
        if matches!(self.readers.stage, Stage::NotWanted) {
            self.readers.stage = Stage::Wanted;
        }
        self.readers.found().cloned()
    }

    /// True once for a frame and light, if the tab was shown.
    pub fn ask_for_readers(&mut self) -> bool {
        let asks = matches!(self.readers.stage, Stage::Wanted);
        if asks {
            self.readers.stage = Stage::Asked;
        }
        asks
    }

    /// What is asked for.
    #[must_use]
    pub fn readers_job(&self, capture: Arc<Capture>, plan: Option<Arc<FramePlan>>) -> MapReadersJob {
        MapReadersJob { ticket: self.readers.ticket, capture, plan, light: self.readers.light }
    }

    /// The answer; one to what was asked for before is dropped.
    pub fn set_readers(&mut self, found: MapReadersFound) {
        if found.ticket == self.readers.ticket {
            self.readers.stage = Stage::Found(found.readers);
        }
    }

    /// The texel that a pixel reads, where the tab was shown.
    #[must_use]
    pub fn texel_of(&self, pixel: [u32; 2]) -> Option<MapTexel> {
        self.readers.found()?.texel_of(pixel)
    }

    /// The depth that the map is compared with at a pixel, where the tab was shown.
    #[must_use]
    pub fn depth_of(&self, pixel: [u32; 2]) -> Option<f64> {
        self.readers.found()?.depth_of(pixel)
    }

    /// The pixels that read a texel, found once.
    fn pixels(&mut self, readers: &MapReaders, texel: MapTexel) -> Arc<Vec<[u32; 2]>> {
        if let Some((_, pixels)) = self.marked.as_ref().filter(|(of, _)| *of == texel) {
            return pixels.clone();
        }
        let pixels = Arc::new(readers.of_texel(texel));
        self.marked = Some((texel, pixels.clone()));
        pixels
    }

    /// The pixels that the marked texel gave its value; none where none is marked.
    #[must_use]
    pub fn marked(&mut self) -> &[[u32; 2]] {
        if !std::mem::take(&mut self.is_shown) && self.pick.is_none() {
            return &[];
        }
        self.marked.as_ref().map_or(&[], |(_, pixels)| pixels)
    }

    fn face(&self) -> usize {
        match self.view.face {
            FaceChoice::One(face) => face,
            FaceChoice::Grid => 0,
        }
    }
}

/// Draws the tab.
pub fn ui(ui: &mut Ui, state: &mut State) {
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::of(ui).background);
    let lights = |capture: &Capture| -> Vec<usize> {
        (0..capture.lights.len()).filter(|light| MapContent::of(capture, *light) == Some(MapContent::Depth)).collect()
    };
    let Some((capture, lights)) = state.capture.clone().map(|capture| (capture.clone(), lights(&capture))) else {
        return empty(ui, rect, "Nothing is open yet. Press Open…, and choose the technique shadow-map.");
    };
    let Some(first) = lights.first() else {
        return empty(ui, rect, "This frame has no shadow map. Choose the technique shadow-map above.");
    };
    if !lights.contains(&state.map_tab.light) {
        state.map_tab.light = *first;
    }
    state.map_tab.is_shown = true;
    state.map_tab.view.kind = PictureKind::Map;
    state.map_tab.view.light = state.map_tab.light;
    let readers = state.map_tab.readers();
    let read = |pixel: Option<[u32; 2]>| pixel.and_then(|pixel| readers.as_ref()?.texel_of(pixel));
    let of_pick = read(state.pick);
    let map_faces = layers::layers(&capture, state.map_tab.light).len();
    let is_chosen = matches!(state.map_tab.view.face, FaceChoice::One(face) if face < map_faces);
    if !is_chosen || state.map_tab.is_any_face {
        state.map_tab.view.face = FaceChoice::One(of_pick.map_or(0, |texel| texel.face));
        // The first, until it is known which one the picked pixel reads.
        state.map_tab.is_any_face = state.map_tab.readers.is_waited_for();
    }
    tools(ui, state, &capture, &lights);
    let rect = ui.available_rect_before_wrap();
    let [map, column] = split(rect);
    let pixel = state.map_tab.over_pixel.filter(|over| read(Some(*over)).is_some()).or(state.pick);
    let linked = read(pixel);
    let footprint = pixel.and_then(|pixel| readers.as_ref()?.footprint(pixel));
    let over = face(ui, state, &capture, map, linked, footprint);
    let face = state.map_tab.face();
    let chosen = over.or(state.map_tab.pick).map(|at| MapTexel { face, at }).or(linked);
    let pixels = match (&readers, chosen) {
        (Some(readers), Some(texel)) => state.map_tab.pixels(readers, texel),
        _ => {
            state.map_tab.marked = None;
            Arc::default()
        }
    };
    let links = Links {
        readers: readers.as_deref(),
        of_pick,
        texel: chosen,
        pixel: pixel.filter(|_| chosen.is_some() && chosen == linked),
        footprint: footprint.map(|(_, corners)| corners),
        pixels: &pixels,
    };
    ui.scope_builder(UiBuilder::new().max_rect(column.shrink(8.0)), |ui| {
        small_picture(ui, state, &capture, &links);
        facts(ui, state, &capture, &links);
    });
}

/// What is linked with what in this frame.
struct Links<'a> {
    readers: Option<&'a MapReaders>,
    /// The texel that the picked pixel reads.
    of_pick: Option<MapTexel>,
    /// The texel that is told about.
    texel: Option<MapTexel>,
    /// The pixel under the pointer, or else the picked one, where it is what led to that texel.
    pixel: Option<[u32; 2]>,
    /// What it covers of the map, texels.
    footprint: Option<[DVec2; 4]>,
    /// The pixels that read the texel.
    pixels: &'a [[u32; 2]],
}

impl Links<'_> {
    /// A pixel on whose surface the texel is measured: of many the middle one in reading order.
    fn on_surface(&self) -> Option<[u32; 2]> {
        self.pixel.or_else(|| self.pixels.get(self.pixels.len() / 2).copied())
    }
}

fn empty(ui: &mut Ui, rect: Rect, text: &str) {
    let place = Rect::from_center_size(rect.center(), vec2((rect.width() - 32.0).min(420.0), 48.0));
    ui.put(place, egui::Label::new(theme::note(text)).wrap());
}

/// The map, and the column beside it where there is room.
fn split(rect: Rect) -> [Rect; 2] {
    let column = COLUMN.min(rect.width() * 0.4);
    let x = rect.right() - column;
    [rect.with_max_x(x), rect.with_min_x(x)]
}

fn tools(ui: &mut Ui, state: &mut State, capture: &Capture, lights: &[usize]) {
    let frame = egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 6));
    frame.show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        ui.horizontal(|ui| {
            if lights.len() > 1 {
                let combo = egui::ComboBox::new("map light", "").width(72.0);
                let combo = combo.selected_text(format::light(state.map_tab.light)).show_ui(ui, |ui| {
                    for light in lights {
                        ui.selectable_value(&mut state.map_tab.light, *light, format::light(*light));
                    }
                });
                combo.response.accessible_name("Light of the shadow map");
            }
            let layers = layers::layers(capture, state.map_tab.light);
            if layers.len() > 1 {
                let labels: Vec<(&str, &str)> =
                    layers.iter().map(|layer| (layer.name.as_str(), "One face of the cube")).collect();
                if let Some(face) = segments(ui, &labels, Some(state.map_tab.face())) {
                    show_face(state, face);
                }
            }
            if ui.button("Fit map").on_hover_text("The whole face").clicked() {
                state.map_tab.view.zoom = Zoom::Fit;
            }
            if state.map_tab.pick.is_some()
                && ui.button("Clear").on_hover_text("No texel is picked, and none of its pixels marked").clicked()
            {
                state.map_tab.pick = None;
            }
            let hint = "Wheel zooms, drag pans, right-click picks a texel";
            ui.add(egui::Label::new(theme::note(hint)).truncate());
        });
    });
}

fn show_face(state: &mut State, face: usize) {
    state.map_tab.view.face = FaceChoice::One(face);
    state.map_tab.is_any_face = false;
    state.map_tab.view.zoom = Zoom::Fit;
    state.map_tab.pick = None;
}

/// Draws the shown face; the texel under the pointer.
fn face(
    ui: &mut Ui,
    state: &mut State,
    capture: &Capture,
    rect: Rect,
    linked: Option<MapTexel>,
    footprint: Option<(usize, [DVec2; 4])>,
) -> Option<[u32; 2]> {
    let hover = state.hover;
    // The canvas works on the view, pick and hover of the picture: for now, those of this tab.
    swap(state);
    let placed = draw_face(ui, state, capture, rect);
    let over = state.hover.map(|hover| hover.at);
    swap(state);
    state.hover = hover;
    let placement = placed?;
    let of_face = linked.filter(|texel| texel.face == state.map_tab.face());
    if let Some(texel) = of_face {
        mark_texel(ui, rect, placement, texel.at);
    }
    if let Some((_, corners)) = footprint.filter(|(face, _)| *face == state.map_tab.face()) {
        quadrilateral(&ui.painter_at(rect), placement, corners, theme::of(ui).text);
    }
    over
}

/// A quadrilateral over a picture, light on dark; `corners` are in its texels.
fn quadrilateral(painter: &Painter, placement: Placement, corners: [DVec2; 4], color: Color32) {
    let place = |at: DVec2| placement.origin + vec2(at.x as f32, at.y as f32) * placement.scale;
    let points: Vec<Pos2> = corners.into_iter().map(place).filter(|at| at.is_finite()).collect();
    if points.len() == corners.len() {
        painter.add(Shape::closed_line(points.clone(), Stroke::new(3.5, Color32::from_black_alpha(170))));
        painter.add(Shape::closed_line(points, Stroke::new(1.5, color)));
    }
}

fn swap(state: &mut State) {
    std::mem::swap(&mut state.view, &mut state.map_tab.view);
    std::mem::swap(&mut state.map_pick, &mut state.map_tab.pick);
}

fn draw_face(ui: &mut Ui, state: &mut State, capture: &Capture, rect: Rect) -> Option<Placement> {
    let shown = state.view.shown(capture, capture.steps.len().checked_sub(1)?)?;
    let shown = Some(shown).filter(|shown| shown.kind == PictureKind::Map && shown.images.len() == 1)?;
    let range = shown_range(state, &shown);
    let coloring = coloring_of(&shown, range);
    let placement = canvas::ui(ui, state, rect, &shown, coloring, &[], "Shadow map canvas");
    Some(placement)
}

/// The texel that a pixel reads: a box, light on dark.
fn mark_texel(ui: &Ui, rect: Rect, placement: Placement, at: [u32; 2]) {
    let texel = placement.rect_of(at);
    let texel = Rect::from_center_size(texel.center(), texel.size().max(vec2(9.0, 9.0)));
    let painter = ui.painter_at(rect);
    for (width, color) in [(4.0, Color32::from_black_alpha(170)), (2.0, theme::of(ui).selected)] {
        painter.rect_stroke(texel, CornerRadius::ZERO, Stroke::new(width, color), StrokeKind::Middle);
    }
}

/// The frame's colours with the marked pixels; pointing at a pixel marks its texel, a click picks it.
fn small_picture(ui: &mut Ui, state: &mut State, capture: &Capture, links: &Links) {
    let [width, height] = capture.size.map(|side| side as f32);
    let scale = (ui.available_width() / width.max(1.0)).min(240.0 / height.max(1.0));
    let (rect, response) = ui.allocate_exact_size(vec2(width, height) * scale, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Small picture"));
    let Some(frame) = capture.steps.len().checked_sub(1).and_then(|last| capture.frame_at(last)) else { return };
    let colors = super::coloring::Coloring::Srgb;
    let texture = state.cache.texture(ui.ctx(), &frame.color.image, colors, TextureSize::Full);
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), rect, uv, Color32::WHITE);
    let placement = Placement { origin: rect.min, scale, size: capture.size };
    ui.painter_at(rect).add(Shape::mesh(marks(placement, links.pixels, theme::of(ui).selected)));
    if let Some(corners) = texel_in_picture(capture, links) {
        quadrilateral(&ui.painter_at(rect), placement, corners, theme::of(ui).selected);
    }
    if let Some(pick) = state.pick {
        let pixel = Rect::from_center_size(placement.rect_of(pick).center(), vec2(7.0, 7.0));
        ui.painter_at(rect).rect_stroke(
            pixel,
            CornerRadius::ZERO,
            Stroke::new(1.0, Color32::WHITE),
            StrokeKind::Outside,
        );
    }
    let over = response.hover_pos().and_then(|at| placement.texel(at));
    if over != state.map_tab.over_pixel {
        state.map_tab.over_pixel = over;
        // The map was drawn before it was known.
        ui.ctx().request_repaint();
    }
    if let Some(at) = over.filter(|_| response.clicked()) {
        state.pick = Some(at);
        state.map_tab.pick = None;
    }
}

/// What the texel covers of the surface, in texels of the picture.
fn texel_in_picture(capture: &Capture, links: &Links) -> Option<[DVec2; 4]> {
    let corners = links.readers?.texel_on_surface(links.texel?, links.on_surface()?)?;
    let [a, b, c, d] = corners.map(|corner| pick_ray::texel_of(capture, corner.extend(1.0)).map(DVec2::from_array));
    Some([a?, b?, c?, d?])
}

/// A square a pixel, as one mesh.
#[must_use]
pub fn marks(placement: Placement, pixels: &[[u32; 2]], color: Color32) -> Mesh {
    let mut mesh = Mesh::default();
    for at in pixels.iter().step_by(pixels.len().div_ceil(MOST_MARKS).max(1)) {
        let pixel = placement.rect_of(*at);
        let size = pixel.size().max(vec2(LEAST_MARK, LEAST_MARK));
        mesh.add_colored_rect(Rect::from_center_size(pixel.center(), size), color.gamma_multiply(0.8));
    }
    mesh
}

fn facts(ui: &mut Ui, state: &mut State, capture: &Capture, links: &Links) {
    ui.add_space(4.0);
    let light = state.map_tab.light;
    let Some(map) = capture.lights.get(light).and_then(|light| light.map.as_ref()) else { return };
    if state.map_tab.readers.is_waited_for() {
        ui.label(theme::note("Finding which texel each pixel reads…"));
    }
    let Some(texel) = links.texel else {
        ui.add(egui::Label::new(theme::note("Point at a texel, or at a pixel of the small picture.")).wrap());
        return;
    };
    let [x, y] = texel.at;
    let name = layers::layers(capture, light).get(texel.face).map_or_else(String::new, |layer| layer.full_name.clone());
    theme::heading(ui, &format!("Texel {x}, {y}"));
    if links.readers.is_some() {
        ui.label(match links.pixels.len() {
            0 => "No pixel reads it.".to_owned(),
            1 => "1 pixel reads it.".to_owned(),
            count => format!("{} pixels read it.", format::count(count as u64)),
        });
    }
    egui::Grid::new("texel facts").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        for (what, value) in values(capture, light, map, texel, links, name) {
            ui.label(theme::note(what));
            ui.label(theme::number(value));
            ui.end_row();
        }
    });
    let is_moved = MapSettings::read(&capture.settings).bias_normal != 0.0;
    if is_moved && links.readers.is_some_and(|readers| !readers.knows_normals()) {
        let note = "A folder holds no normals: surfaces are moved along those of the planes through neighbouring \
                    pixels.";
        ui.add(egui::Label::new(theme::note(note)).wrap());
    }
    if let Some(texel) = links.of_pick {
        let text = "Show the picked pixel's texel";
        if ui.button(text).on_hover_text("Brings the texel that the picked pixel reads to the middle").clicked() {
            show_face(state, texel.face);
            state.map_tab.view.zoom = Zoom::Pixels(canvas::NUMBERS_FROM + 4.0);
            state.map_tab.view.center = texel.at.map(|place| f64::from(place) + 0.5);
        }
    }
}

/// What is known of a texel, and how far each bias moves the surface there.
fn values(
    capture: &Capture,
    light: usize,
    map: &CapturedMap,
    texel: MapTexel,
    links: &Links,
    name: String,
) -> Vec<(&'static str, String)> {
    let [width, height] = map.faces.get(texel.face).map_or([0, 0], |face| face.size());
    let mut values = vec![("map", format!("{name}, {width}×{height}"))];
    let stored = map.faces.get(texel.face).and_then(|face| face.depth_at(texel.at));
    let measure = DepthMeasure::of_map(capture, light, texel.face);
    if let Some(stored) = stored {
        values.push(("stored depth", format::depth(stored)));
        let distance = measure.and_then(|measure| measure.value(stored));
        values.push(("caster at", distance.map_or_else(|| "no caster".to_owned(), format::metres)));
    }
    let readers = links.readers;
    if let Some(depth) = links.pixel.and_then(|pixel| readers?.depth_of(pixel)) {
        values.push(("pixel's depth", format::depth(depth as f32)));
    }
    let width = links.on_surface().and_then(|pixel| readers?.texel_width(texel.face, pixel));
    if let Some(width) = width {
        values.push(("texel covers", format::metres(width)));
    }
    if let (Some(_), Some([a, b, c, d])) = (links.pixel, links.footprint) {
        let across = (a.distance(b) + d.distance(c)) / 2.0;
        let down = (a.distance(d) + b.distance(c)) / 2.0;
        values.push(("pixel covers", format!("{across:.2} × {down:.2} texels")));
    }
    let MapSettings { bias_constant, bias_slope, bias_normal, .. } = MapSettings::read(&capture.settings);
    if let (Some(measure), Some(stored)) = (measure, stored) {
        let moved = format::metres(f64::from(bias_constant) * measure.step_at(stored).unwrap_or(0.0));
        values.push(("constant bias", format!("{moved} ({bias_constant} steps)")));
    }
    if let Some(width) = width {
        values.push(("slope bias", format!("{} at 45°", format::metres(bias_slope * width))));
    }
    if let Some(width) = width.filter(|_| bias_normal != 0.0) {
        values.push(("normal bias", format!("{} at most", format::metres(bias_normal * width))));
    }
    values
}
