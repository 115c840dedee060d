//! The shadow map tab: a face of a light's map with the values of its texels, beside a small picture. A
//! texel and the pixels that read it are marked in both, and so is what each covers of the other: a pixel of
//! the map, a texel of the surface.

use crate::ask::ReadersOf;
use crate::capture::{Capture, CapturedMap};
use crate::inspector::action::Action;
use crate::inspector::canvas::placement::Placement;
use crate::inspector::canvas::{self, Canvas, marks};
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::texture::{PictureCache, TextureSize};
use crate::inspector::look::theme;
use crate::inspector::look::widgets::segments;
use crate::inspector::model::Model;
use crate::inspector::model::looking::full_range;
use crate::reading::depth::DepthMeasure;
use crate::reading::format;
use crate::reading::layers::{self, MapContent};
use crate::reading::map_readers::{MapReaders, MapTexel};
use crate::reading::pick_ray;
use crate::reading::picture_view::{FaceChoice, PictureKind, PictureView, TexelZoom};
use crate::technique::{MapSettings, Technique};
use egui::{
    Color32, CornerRadius, Margin, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, pos2, vec2,
};
use glam::{DVec2, DVec4};
use std::sync::{Arc, Weak};

/// Width of the column beside the map, points.
const COLUMN: f32 = 232.0;

/// The state of the tab Shadow map: light, face, pick and what is under the pointer.
#[derive(Debug, Default)]
pub struct ShadowMapPanel {
    view: PictureView,
    /// The picked texel of the shown face.
    pick: Option<[u32; 2]>,
    /// Index of the light whose map is shown.
    light: usize,
    marked: Option<MarkedTexel>,
    /// The pixel under the pointer in the small picture.
    over_pixel: Option<[u32; 2]>,
    /// The texel of the picked pixel that the tab followed last.
    followed: Option<MapTexel>,
    /// Number of the frame in which the pointer was over it.
    frame: u64,
}

/// The marked texel, with the pixels that read it.
#[derive(Debug)]
struct MarkedTexel {
    texel: MapTexel,
    /// The readers from which the pixels were found.
    of: Weak<MapReaders>,
    /// The pixels that read the texel.
    pixels: Arc<Vec<[u32; 2]>>,
}

impl ShadowMapPanel {
    /// Returns which texel each pixel reads, for the shown frame and this tab's light, without asking for it; `None`
    /// where that is not known.
    pub fn readers(&self, model: &Model) -> Option<Arc<MapReaders>> {
        model.answers.of(ReadersOf { light: self.light }).ready
    }

    /// Returns the pixels that read a texel, in reading order; cached for the last texel and answer.
    fn pixels(&mut self, readers: &Arc<MapReaders>, texel: MapTexel) -> Arc<Vec<[u32; 2]>> {
        let is_it =
            |marked: &&MarkedTexel| marked.texel == texel && std::ptr::eq(marked.of.as_ptr(), Arc::as_ptr(readers));
        if let Some(marked) = self.marked.as_ref().filter(is_it) {
            return Arc::clone(&marked.pixels);
        }
        let pixels = Arc::new(readers.of_texel(texel));
        self.marked = Some(MarkedTexel { texel, of: Arc::downgrade(readers), pixels: Arc::clone(&pixels) });
        pixels
    }

    fn face(&self) -> usize {
        match self.view.face {
            FaceChoice::One(face) => face,
            FaceChoice::Grid => 0,
        }
    }
}

impl ShadowMapPanel {
    /// Adapts to the tab being hidden: pixels stay marked only where a texel is picked.
    pub fn hide(&self, model: &mut Model) {
        model.selection.map_light = None;
        if self.pick.is_none() {
            model.selection.readers = Arc::default();
        }
    }
}

/// Draws the tab Shadow map: a depth map of the selected light, with the texel that the picked pixel reads and the
/// pixels that read the marked texel. Where the frame has no such map, only that, and a button that draws one where a scene is
/// open.
pub fn ui(ui: &mut Ui, own: &mut ShadowMapPanel, model: &mut Model, actions: &mut Vec<Action>) {
    let rect = ui.available_rect_before_wrap();
    if std::mem::replace(&mut own.frame, model.frame.number) != model.frame.number {
        own.over_pixel = None;
    }
    let lights = |capture: &Capture| -> Vec<usize> {
        (0..capture.lights.len()).filter(|light| MapContent::of(capture, *light) == Some(MapContent::Depth)).collect()
    };
    let Some(capture) = model.frame.capture.clone() else {
        empty(ui, rect, "Nothing is open yet. Press Open…, and choose the technique shadow-map.", false);
        return;
    };
    let lights = lights(&capture);
    let Some(first) = lights.first() else {
        model.selection.readers = Arc::default();
        let can_have_one = model.scene.is_some();
        if empty(ui, rect, "This frame has no shadow map.", can_have_one) {
            model.choose_technique(Technique::ShadowMap, actions);
        }
        return;
    };
    if let Some(light) = model.requests.texel_under {
        own.light = light;
    }
    if !lights.contains(&own.light) {
        own.light = *first;
    }
    own.view.kind = Some(PictureKind::Map);
    own.view.light = own.light;
    model.selection.map_light = Some(own.light);
    let reply = model.answers.want(ReadersOf { light: own.light });
    let is_waited_for = reply.ready.is_none() && reply.failed.is_none();
    let readers = reply.ready;
    let read = |pixel: Option<[u32; 2]>| pixel.and_then(|pixel| readers.as_ref()?.texel_of(pixel));
    let of_pick = read(model.selection.pick);
    let map_faces = layers::layers(&capture, own.light).len();
    if !matches!(own.view.face, FaceChoice::One(face) if face < map_faces) {
        own.view.face = FaceChoice::One(0);
    }
    // A face that the user chooses stays until the picked pixel reads another texel.
    if let Some(texel) = of_pick.filter(|texel| own.followed != Some(*texel)) {
        own.followed = Some(texel);
        follow(own, texel);
    }
    // Once it is known which texel that is, or nothing is picked any more.
    if (!is_waited_for || model.selection.pick.is_none()) && model.requests.texel_under.take().is_some() {
        of_pick.into_iter().for_each(|texel| show_texel(own, texel));
    }
    tools(ui, own, &capture, &lights);
    let rect = ui.available_rect_before_wrap();
    let [map, column] = split(rect);
    canvas::background(ui, column, None);
    let pixel = own.over_pixel.filter(|over| read(Some(*over)).is_some()).or(model.selection.pick);
    let linked = read(pixel);
    let footprint = pixel.and_then(|pixel| readers.as_ref()?.footprint(pixel));
    let over = face(ui, own, &mut model.textures, &capture, map, linked, footprint);
    let face = own.face();
    let chosen = over.or(own.pick).map(|at| MapTexel { face, at }).or(linked);
    let pixels = match (&readers, chosen) {
        (Some(readers), Some(texel)) => own.pixels(readers, texel),
        _ => {
            own.marked = None;
            Arc::default()
        }
    };
    let links = TexelLinks {
        readers: readers.as_deref(),
        is_waited_for,
        of_pick,
        texel: chosen,
        pixel: pixel.filter(|_| chosen.is_some() && chosen == linked),
        footprint: footprint.map(|(_, corners)| corners),
        pixels: &pixels,
    };
    ui.scope_builder(UiBuilder::new().max_rect(column.shrink(8.0)), |ui| {
        egui::ScrollArea::vertical().id_salt("facts of the map").auto_shrink([false, false]).show(ui, |ui| {
            small_picture(ui, own, model, &capture, &links);
            facts(ui, own, &capture, &links);
        });
    });
    model.selection.readers = pixels;
}

/// The links between map and picture in this frame.
struct TexelLinks<'a> {
    readers: Option<&'a MapReaders>,
    /// The readers are being computed.
    is_waited_for: bool,
    /// The texel that the picked pixel reads.
    of_pick: Option<MapTexel>,
    /// The texel whose values are shown.
    texel: Option<MapTexel>,
    /// The pixel under the pointer, or else the picked one, if it is the one that reads that texel.
    pixel: Option<[u32; 2]>,
    /// The pixel's footprint in the map, texels.
    footprint: Option<[DVec2; 4]>,
    /// The pixels that read the texel.
    pixels: &'a [[u32; 2]],
}

impl TexelLinks<'_> {
    /// Returns the pixel on whose surface the texel is measured: the linked one if there is one, otherwise the middle
    /// one of all readers in reading order; `None` where no pixel reads the texel.
    fn on_surface(&self) -> Option<[u32; 2]> {
        self.pixel.or_else(|| self.pixels.get(self.pixels.len() / 2).copied())
    }
}

/// Says in the middle that there is no map, with a button below where it `can_have_one`; returns true when that was
/// pressed.
fn empty(ui: &mut Ui, rect: Rect, text: &str, can_have_one: bool) -> bool {
    canvas::background(ui, rect, None);
    let place = Rect::from_center_size(rect.center(), vec2((rect.width() - 32.0).min(420.0), 64.0));
    let drawn = ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        ui.vertical_centered(|ui| {
            ui.add(egui::Label::new(theme::note(text)).wrap());
            ui.add_space(4.0);
            let button = can_have_one.then(|| ui.button("Draw it with shadow-map"));
            button.is_some_and(|button| button.on_hover_text("Chooses the technique shadow-map").clicked())
        })
    });
    drawn.inner.inner
}

/// Splits a rectangle into the map and a column at the right; where it is too narrow for both, into the map and what is
/// below it.
fn split(rect: Rect) -> [Rect; 2] {
    if rect.width() < 2.2 * COLUMN {
        let y = rect.center().y;
        return [rect.with_max_y(y), rect.with_min_y(y)];
    }
    let x = rect.right() - COLUMN;
    [rect.with_max_x(x), rect.with_min_x(x)]
}

fn tools(ui: &mut Ui, own: &mut ShadowMapPanel, capture: &Capture, lights: &[usize]) {
    let frame = egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 6));
    frame.show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            if lights.len() > 1 {
                let combo = egui::ComboBox::new("map light", "").width(72.0);
                let combo = combo.selected_text(format::light(own.light)).show_ui(ui, |ui| {
                    for light in lights {
                        ui.selectable_value(&mut own.light, *light, format::light(*light));
                    }
                });
                combo.response.accessible_name("Light of the shadow map");
            }
            let layers = layers::layers(capture, own.light);
            if layers.len() > 1 {
                let labels: Vec<(&str, &str)> =
                    layers.iter().map(|layer| (layer.name.as_str(), "One face of the cube")).collect();
                if let Some(face) = segments(ui, &labels, Some(own.face())) {
                    show_face(own, face);
                }
            }
            if ui.button("Fit map").on_hover_text("The whole face").clicked() {
                own.view.zoom = TexelZoom::Fit;
            }
            if own.pick.is_some()
                && ui.button("Clear").on_hover_text("No texel is picked, and none of its pixels marked").clicked()
            {
                own.pick = None;
            }
            let hint = "Wheel zooms, drag pans, a click picks a texel";
            ui.add(egui::Label::new(theme::note(hint)).truncate());
        });
    });
}

fn show_face(own: &mut ShadowMapPanel, face: usize) {
    own.view.face = FaceChoice::One(face);
    own.view.zoom = TexelZoom::Fit;
    own.pick = None;
}

/// Shows the face of the texel that the picked pixel reads, and, where the map is enlarged, that texel in the middle.
fn follow(own: &mut ShadowMapPanel, texel: MapTexel) {
    if own.view.face != FaceChoice::One(texel.face) {
        own.view.face = FaceChoice::One(texel.face);
        own.pick = None;
    }
    own.view.center = texel.at.map(|place| f64::from(place) + 0.5);
}

/// Shows a texel's face, centres the texel and zooms in until its number is legible, also where the zoom was larger.
/// Clears the picked texel.
fn show_texel(own: &mut ShadowMapPanel, texel: MapTexel) {
    show_face(own, texel.face);
    own.view.zoom = TexelZoom::Pixels(canvas::NUMBERS_FROM + 4.0);
    own.view.center = texel.at.map(|place| f64::from(place) + 0.5);
}

/// Draws the shown face of the map, the `linked` texel and the outline of a pixel's `footprint` where they lie on that
/// face; returns the texel under the pointer. Draws nothing, and returns `None`, where there is no such map.
fn face(
    ui: &mut Ui,
    own: &mut ShadowMapPanel,
    textures: &mut PictureCache,
    capture: &Capture,
    rect: Rect,
    linked: Option<MapTexel>,
    footprint: Option<(usize, [DVec2; 4])>,
) -> Option<[u32; 2]> {
    let shown = capture.steps.len().checked_sub(1).and_then(|last| own.view.shown(capture, last));
    let Some(shown) = shown.filter(|shown| shown.kind == PictureKind::Map && shown.images.len() == 1) else {
        canvas::background(ui, rect, None);
        return None;
    };
    let range = own.view.depth_range.unwrap_or_else(|| full_range(textures, &shown));
    let coloring = Coloring::of_shown(&shown, range);
    let canvas = Canvas {
        name: "Shadow map canvas",
        view: &mut own.view,
        pick: &mut own.pick,
        textures,
        has_arrows: true,
        picks_by_click: true,
    };
    let (placement, over) = canvas::ui(ui, canvas, rect, &shown, coloring, &[]);
    if let Some(texel) = linked.filter(|texel| texel.face == own.face()) {
        mark_texel(ui, rect, placement, texel.at);
    }
    if let Some((_, corners)) = footprint.filter(|(face, _)| *face == own.face()) {
        quadrilateral(&ui.painter_at(rect), placement, corners, theme::of(ui).text);
    }
    over
}

/// Draws the outline of a quadrilateral over a picture, light on dark; `corners` are in its texels. Draws nothing where
/// one is not finite on the screen.
fn quadrilateral(painter: &Painter, placement: Placement, corners: [DVec2; 4], color: Color32) {
    let place = |at: DVec2| placement.origin + vec2(at.x as f32, at.y as f32) * placement.scale;
    let points: Vec<Pos2> = corners.into_iter().map(place).filter(|at| at.is_finite()).collect();
    if points.len() == corners.len() {
        painter.add(Shape::closed_line(points.clone(), Stroke::new(3.5, Color32::from_black_alpha(170))));
        painter.add(Shape::closed_line(points, Stroke::new(1.5, color)));
    }
}

/// Draws a box of at least 9 points, light on dark, around the texel that a pixel reads.
fn mark_texel(ui: &Ui, rect: Rect, placement: Placement, at: [u32; 2]) {
    let texel = placement.rect_of(at);
    let texel = Rect::from_center_size(texel.center(), texel.size().max(vec2(9.0, 9.0)));
    let painter = ui.painter_at(rect);
    for (width, color) in [(4.0, Color32::from_black_alpha(170)), (2.0, theme::of(ui).selected)] {
        painter.rect_stroke(texel, CornerRadius::ZERO, Stroke::new(width, color), StrokeKind::Middle);
    }
}

/// Draws the frame's final colours, small, with the marked pixels, the picked one and what the texel covers; pointing
/// at a pixel marks the texel that it reads, and a click picks it.
fn small_picture(ui: &mut Ui, own: &mut ShadowMapPanel, model: &mut Model, capture: &Capture, links: &TexelLinks) {
    let [width, height] = capture.size.map(|side| side as f32);
    let scale = (ui.available_width() / width.max(1.0)).min(240.0 / height.max(1.0));
    let (rect, response) = ui.allocate_exact_size(vec2(width, height) * scale, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Small picture"));
    let Some(frame) = capture.steps.len().checked_sub(1).and_then(|last| capture.frame_at(last)) else { return };
    let colors = Coloring::Srgb;
    let texture = model.textures.texture(ui.ctx(), &frame.color.image, colors, TextureSize::Full);
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), rect, uv, Color32::WHITE);
    let placement = Placement { origin: rect.min, scale, size: capture.size };
    ui.painter_at(rect).add(Shape::mesh(marks(placement, links.pixels, theme::of(ui).selected)));
    if let Some(corners) = texel_in_picture(capture, links) {
        quadrilateral(&ui.painter_at(rect), placement, corners, theme::of(ui).selected);
    }
    if let Some(pick) = model.selection.pick {
        let pixel = Rect::from_center_size(placement.rect_of(pick).center(), vec2(7.0, 7.0));
        ui.painter_at(rect).rect_stroke(
            pixel,
            CornerRadius::ZERO,
            Stroke::new(1.0, Color32::WHITE),
            StrokeKind::Outside,
        );
    }
    let over = response.hover_pos().and_then(|at| placement.texel(at));
    if over != own.over_pixel {
        own.over_pixel = over;
        // The map was drawn before this was known.
        ui.ctx().request_repaint();
    }
    if let Some(at) = over.filter(|_| response.clicked()) {
        model.selection.pick = Some(at);
        own.pick = None;
    }
}

/// Returns the corners of what the shown texel covers of the plane of its reader's surface, in texels of the picture;
/// `None` where no texel is shown, no pixel reads it, or a corner is behind the eye.
fn texel_in_picture(capture: &Capture, links: &TexelLinks) -> Option<[DVec2; 4]> {
    let corners = links.readers?.texel_on_surface(links.texel?, links.on_surface()?)?;
    let [a, b, c, d] = corners.map(|corner| pick_ray::texel_of(capture, corner.extend(1.0)).map(DVec2::from_array));
    Some([a?, b?, c?, d?])
}

fn facts(ui: &mut Ui, own: &mut ShadowMapPanel, capture: &Capture, links: &TexelLinks) {
    ui.add_space(4.0);
    let light = own.light;
    let Some(map) = capture.lights.get(light).and_then(|light| light.map.as_ref()) else { return };
    if links.is_waited_for {
        ui.label(theme::note("Finding which texel each pixel reads…"));
    }
    let is_recorded = capture.origin.is_some();
    if let Some(origin) = &capture.origin {
        for limit in &origin.limits {
            ui.add(egui::Label::new(theme::note(format!("Limit: {limit}"))).wrap());
        }
        let words = match capture.lights[light].position {
            DVec4::ZERO => {
                "Another program drew this map, and how its light sees is not known: no pixel is linked with the texel \
                 that it reads."
            }
            _ => {
                "Another program drew this map, and how its shader compares is not known: a pixel is linked with the one \
                 texel that its surface lies in."
            }
        };
        ui.add(egui::Label::new(theme::note(words)).wrap());
    }
    let Some(texel) = links.texel else {
        let words = if is_recorded && links.readers.is_none() {
            "Point at a texel."
        } else {
            "Point at a texel, or at a pixel of the small picture."
        };
        ui.add(egui::Label::new(theme::note(words)).wrap());
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
            show_texel(own, texel);
        }
    }
}

/// Returns names and values of a texel: its map, stored depth, what the linked pixel and the texel cover, and how far
/// each bias moves the surface there; values that are not known are left out.
fn values(
    capture: &Capture,
    light: usize,
    map: &CapturedMap,
    texel: MapTexel,
    links: &TexelLinks,
    name: String,
) -> Vec<(&'static str, String)> {
    let [width, height] = map.faces.get(texel.face).map_or([0, 0], |face| face.size());
    let mut values = vec![("map", format!("{name}, {width}×{height}"))];
    let stored = map.faces.get(texel.face).and_then(|face| face.depth_at(texel.at));
    let measure = DepthMeasure::of_map(capture, light, texel.face);
    if let Some(stored) = stored {
        values.push(("stored depth", format::depth(stored)));
        if let Some(measure) = measure {
            let distance = measure.value(stored);
            values.push(("caster at", distance.map_or_else(|| "no caster".to_owned(), format::metres)));
        }
    }
    let readers = links.readers;
    if let Some(depth) = links.pixel.and_then(|pixel| readers?.depth_of(pixel)) {
        values.push(("pixel's depth", format::depth(depth as f32)));
    }
    // The widths of another program's picture are not known, nor what its shader adds.
    let is_own = capture.origin.is_none();
    let width = links.on_surface().filter(|_| is_own).and_then(|pixel| readers?.texel_width(texel.face, pixel));
    if let Some(width) = width {
        values.push(("texel covers", format::metres(width)));
    }
    if let (Some(_), Some([a, b, c, d])) = (links.pixel, links.footprint) {
        let across = (a.distance(b) + d.distance(c)) / 2.0;
        let down = (a.distance(d) + b.distance(c)) / 2.0;
        values.push(("pixel covers", format!("{across:.2} × {down:.2} texels")));
    }
    let MapSettings { bias_constant, bias_slope, bias_normal, .. } = MapSettings::read(&capture.settings);
    if let (Some(measure), Some(stored), true) = (measure, stored, is_own) {
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
