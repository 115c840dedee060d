//! Overlays over the picture, several at once: silhouettes, wireframes of volumes, results of the tests on fragments,
//! receivers, names of casters. Chosen in a menu, listed in a card with their colours.

use super::vanishing_lines;
use crate::anatomy::Anatomy;
use crate::ask::AnatomyOf;
use crate::capture::TestCounts;
use crate::capture::{Capture, Image};
use crate::inspector::action::{Overlay, TourSubject};
use crate::inspector::canvas::PictureSheet;
use crate::inspector::canvas::overlay_lines::{OverlayLines, PlacedLines, middle, multiplicity};
use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::palette;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{menu_triangle, plate};
use crate::inspector::model::Model;
use crate::inspector::panels::tour_mark;
use crate::plan::DrawPart;
use crate::reading::format;
use crate::reading::object_ids::ObjectIds;
use crate::reading::outcomes::OUTCOMES;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::reading::vanishing;
use egui::{Align2, CornerRadius, FontId, Pos2, Rect, Sense, Shape, Ui, UiBuilder, Vec2, pos2, vec2};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What the lines of silhouettes mean where the faces of volumes are counted.
const COUNTED_EDGE: &str = "silhouette edge; thick, ±2: counted twice, as the triangles on both of its sides cast";

/// Width of the card, points.
const WIDTH: f32 = 196.0;
/// How near to an edge the pointer has to be to show its number, points.
const REACH: f32 = 5.0;
/// Side of the square that the mark of the pick takes, points.
const PICK_MARK: f32 = 34.0;
/// Least width of the menu's button, points.
const BUTTON_WIDTH: f32 = 87.0;

/// The cached geometry and pictures of a frame's overlays.
#[derive(Debug, Default)]
pub struct Overlays {
    made: Option<OverlayMeshes>,
}

/// Lines, and where they lie in the shown picture and in the one beside it.
type LinesOfSides = (OverlayLines, [PlacedLines; 2]);

/// Over which of two pictures side by side overlays are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OverlaidSide {
    /// The shown one.
    Shown,
    /// The one that it is compared with.
    Compared,
}

/// What is computed from an anatomy and a light.
#[derive(Debug)]
struct OverlayMeshes {
    anatomy: Arc<Anatomy>,
    capture: [u32; 2],
    light: usize,
    silhouettes: Option<LinesOfSides>,
    volumes: Option<LinesOfSides>,
    objects: Option<SeenObjects>,
}

/// Which object is seen at each pixel.
#[derive(Debug)]
struct SeenObjects {
    receivers: Arc<Image>,
    middles: Vec<Option<[u32; 2]>>,
}

impl Overlays {
    fn make(
        &mut self,
        on: &BTreeSet<Overlay>,
        anatomy: &Arc<Anatomy>,
        capture: &Capture,
        light: usize,
    ) -> &mut OverlayMeshes {
        let is_it = |made: &OverlayMeshes| {
            Arc::ptr_eq(&made.anatomy, anatomy) && made.light == light && made.capture == capture.size
        };
        let made = self.made.take().filter(is_it);
        let mut made = made.unwrap_or_else(|| OverlayMeshes {
            anatomy: anatomy.clone(),
            capture: capture.size,
            light,
            silhouettes: None,
            volumes: None,
            objects: None,
        });
        if on.contains(&Overlay::Silhouettes) && made.silhouettes.is_none() {
            made.silhouettes = Some((OverlayLines::silhouettes(anatomy, capture, light), Default::default()));
        }
        if on.contains(&Overlay::Volumes) && made.volumes.is_none() {
            made.volumes = Some((OverlayLines::volumes(anatomy, capture, light), Default::default()));
        }
        if (on.contains(&Overlay::Receivers) || on.contains(&Overlay::Names)) && made.objects.is_none() {
            let ids = ObjectIds::new(anatomy, capture);
            made.objects = Some(SeenObjects { receivers: Arc::new(ids.receivers), middles: ids.middles });
        }
        self.made.insert(made)
    }
}

/// Draws the button and menu of overlays, with a box and a swatch for each; the button shows how many are on, and the
/// menu opens where another panel asked for it.
pub fn menu(ui: &mut Ui, model: &mut Model) {
    let count = model.modes.overlays.len();
    let text = if count == 0 { "Overlay".to_owned() } else { format!("Overlay {count}") };
    // Of the same width with and without a number, so that nothing beside it moves.
    let button = ui.add(egui::Button::new((text, menu_triangle())).gap(4.0).min_size(vec2(BUTTON_WIDTH, 0.0)));
    let button = button.on_hover_text("What is drawn over the picture (O)");
    let button = button.on_disabled_hover_text("Several pictures at once: choose one of them to draw over it");
    let id = egui::Popup::default_response_id(&button);
    if std::mem::take(&mut model.requests.overlay_menu) && button.enabled() {
        egui::Popup::open_id(ui.ctx(), id);
    }
    let popup = egui::Popup::menu(&button).close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
    popup.show(|ui| {
        ui.set_min_width(190.0);
        theme::outline_boxes(ui);
        for overlay in Overlay::ALL {
            ui.horizontal(|ui| {
                let color = swatch_of(ui, overlay);
                theme::swatch(ui, color);
                let mut is_on = model.modes.overlays.contains(&overlay);
                let line = ui.checkbox(&mut is_on, overlay.name()).on_hover_text(overlay.meaning());
                if line.changed() && is_on {
                    model.modes.overlays.insert(overlay);
                } else if line.changed() {
                    model.modes.overlays.remove(&overlay);
                }
            });
        }
    });
}

fn swatch_of(ui: &Ui, overlay: Overlay) -> egui::Color32 {
    let theme = theme::of(ui);
    match overlay {
        Overlay::Silhouettes => theme.lit,
        Overlay::Volumes => theme.side,
        Overlay::Tests => theme.failed,
        Overlay::Receivers => palette::receiver(2),
        Overlay::Names | Overlay::Vanishing => theme.text,
    }
}

/// Returns the overlays that are pictures, receivers and test results, and asks for the answers that overlays need;
/// those not known yet are left out. None over a map.
pub fn sheets(
    own: &mut Overlays,
    model: &Model,
    capture: &Capture,
    shown: &ShownPicture,
    rect: Rect,
) -> Vec<PictureSheet> {
    let mut sheets = Vec::new();
    if shown.kind == PictureKind::Map {
        return sheets;
    }
    if model.modes.overlays.iter().any(|overlay| overlay.needs_anatomy()) && model.can_ask() {
        let light = model.view.light;
        if let Some(anatomy) = model.answers.want(AnatomyOf {}).ready {
            let made = own.make(&model.modes.overlays, &anatomy, capture, light);
            let receivers = made.objects.as_ref().map(|objects| objects.receivers.clone());
            if let Some(image) = receivers.filter(|_| model.modes.overlays.contains(&Overlay::Receivers)) {
                sheets.push(PictureSheet { image, coloring: Coloring::Receivers, part: rect, has_numbers: false });
            }
        }
    }
    if model.modes.overlays.contains(&Overlay::Tests)
        && model.can_ask()
        && let Some(known) = model.want_tests().ready
    {
        let image = known.outcomes.clone();
        sheets.push(PictureSheet { image, coloring: Coloring::Outcomes, part: rect, has_numbers: false });
    }
    sheets
}

/// Draws the overlays that are lines and names, and the number of the edge under the pointer. Draws nothing over a map, or
/// where no overlay is on.
pub fn ui(ui: &mut Ui, own: &mut Overlays, model: &mut Model, rect: Rect, shown: &ShownPicture, placement: Placement) {
    if model.modes.overlays.is_empty() || shown.kind == PictureKind::Map {
        return;
    }
    let seen = placement.rect().intersect(rect);
    paint(ui, own, &model.modes.overlays, seen, placement, model.selection.pick, OverlaidSide::Shown);
    if let Some(capture) = model.frame.capture.as_ref().filter(|_| model.modes.overlays.contains(&Overlay::Vanishing)) {
        vanishing_lines::paint(&ui.painter_at(seen), theme::of(ui), &vanishing::axes(capture), placement);
    }
    if let Some(pointer) = ui.input(|input| input.pointer.hover_pos()).filter(|_| model.selection.hover.is_some()) {
        number_under(ui, own, &model.modes.overlays, seen, placement, pointer);
    }
}

/// Draws the card that lists all overlays, which lies over the pick's mark. Draws nothing over a map, or where no overlay
/// is on.
pub fn legend(ui: &mut Ui, own: &Overlays, model: &mut Model, rect: Rect, shown: &ShownPicture) {
    if !model.modes.overlays.is_empty() && shown.kind != PictureKind::Map {
        card(ui, own, model, rect);
    }
}

/// Draws over the picture that the shown one is compared with, beside it, the overlays that are true of both: where both
/// are of one frame all lines, else those of the scene alone, not the volumes, which each technique draws otherwise. Both are
/// to be of one scene.
pub fn over_compared(
    ui: &Ui,
    own: &mut Overlays,
    model: &Model,
    rect: Rect,
    placement: Placement,
    is_of_one_frame: bool,
) {
    let is_of_both = |overlay: &&Overlay| is_of_one_frame || **overlay != Overlay::Volumes;
    let on: BTreeSet<Overlay> = model.modes.overlays.iter().filter(is_of_both).copied().collect();
    let seen = placement.rect().intersect(rect);
    paint(ui, own, &on, seen, placement, model.selection.pick, OverlaidSide::Compared);
    if let Some(capture) = model.frame.capture.as_ref().filter(|_| on.contains(&Overlay::Vanishing)) {
        vanishing_lines::paint(&ui.painter_at(seen), theme::of(ui), &vanishing::axes(capture), placement);
    }
}

/// Draws the lines of volumes and silhouettes, multiplicities, and casters' names, of the overlays in `on`, over one side,
/// clipped to `seen`, and to the camera's viewport where that is not the whole picture; names keep off the mark of the
/// `pick`. Draws nothing that is not cached yet.
pub fn paint(
    ui: &Ui,
    own: &mut Overlays,
    on: &BTreeSet<Overlay>,
    seen: Rect,
    placement: Placement,
    pick: Option<[u32; 2]>,
    side: OverlaidSide,
) {
    let Some(made) = &mut own.made else { return };
    let camera = &made.anatomy.camera;
    let seen = match camera.viewport {
        Some(_) => {
            let [left, top, columns, rows] = camera.viewport_in(made.capture);
            let ends = [[left, top], [left + columns - 1, top + rows - 1]].map(|texel| placement.rect_of(texel));
            seen.intersect(ends[0].union(ends[1]))
        }
        None => seen,
    };
    let painter = ui.painter_at(seen);
    let (theme, is_dark, pixels) = (theme::of(ui), ui.visuals().dark_mode, ui.pixels_per_point());
    let kinds = [(Overlay::Volumes, &mut made.volumes), (Overlay::Silhouettes, &mut made.silhouettes)];
    for (_, lines) in kinds.into_iter().filter(|(overlay, _)| on.contains(overlay)) {
        if let Some((lines, placed)) = lines {
            let placed = &mut placed[side as usize];
            painter.add(Shape::mesh(placed.of(lines, placement, theme, is_dark, pixels)));
            for (at, times) in placed.numbers(lines, placement, seen).iter() {
                plate(&painter, *at, Align2::CENTER_CENTER, &multiplicity(*times), true, theme);
            }
        }
    }
    if let Some(SeenObjects { middles, .. }) = made.objects.as_ref().filter(|_| on.contains(&Overlay::Names)) {
        let casters = made.anatomy.objects.iter().zip(middles).filter(|(object, _)| object.casts);
        let mark = pick.map(|pick| Rect::from_center_size(placement.rect_of(pick).center(), Vec2::splat(PICK_MARK)));
        let mut taken: Vec<Rect> = mark.into_iter().collect();
        for (object, at) in casters.filter_map(|(object, at)| Some((object, (*at)?))) {
            name(ui, &painter, middle(placement, at), &object.name, &mut taken);
        }
    }
}

/// Draws beside the pointer the multiplicity of the silhouette edge nearest to it, within a few points and where it is
/// not ±1, also for short edges, which have no number of their own.
fn number_under(ui: &Ui, own: &Overlays, on: &BTreeSet<Overlay>, seen: Rect, placement: Placement, pointer: Pos2) {
    let made = own.made.as_ref().filter(|_| on.contains(&Overlay::Silhouettes));
    let Some((lines, _)) = made.and_then(|made| made.silhouettes.as_ref()) else { return };
    if let Some(times) = lines.number_near(placement, pointer, REACH) {
        let words = format!("{}: counts {} times", multiplicity(times), times.unsigned_abs());
        plate(&ui.painter_at(seen), pointer + vec2(14.0, -4.0), Align2::LEFT_BOTTOM, &words, false, theme::of(ui));
    }
}

/// Draws a name with its middle at `at`, or beside it where it would leave the picture or lie over one of those `taken`,
/// to which it is added.
fn name(ui: &Ui, painter: &egui::Painter, at: Pos2, text: &str, taken: &mut Vec<Rect>) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(theme::SMALL_SIZE), theme::of(ui).text);
    let around = vec2(6.0, 3.0);
    let place = within(Rect::from_center_size(at, galley.size() + 2.0 * around), painter.clip_rect());
    let place = beside_others(place, painter.clip_rect(), taken);
    taken.push(place);
    painter.rect_filled(place, CornerRadius::same(4), theme::of(ui).panel.gamma_multiply(0.9));
    painter.galley(place.min + around, galley, theme::of(ui).text);
}

/// Returns a rectangle moved into another one; where it is larger than that, to its upper left corner.
fn within(place: Rect, whole: Rect) -> Rect {
    let corner = place.min.min(whole.max - place.size()).max(whole.min);
    Rect::from_min_size(corner, place.size())
}

/// Returns a rectangle moved up or down by as little as takes it off those `taken` within `whole`; unmoved where there is no
/// such place.
fn beside_others(place: Rect, whole: Rect, taken: &[Rect]) -> Rect {
    let beside = taken.iter().flat_map(|other| [other.bottom(), other.top() - place.height()]);
    let places = beside.chain([place.top()]).map(|top| place.translate(vec2(0.0, top - place.top())));
    let is_free = |place: &Rect| {
        let is_in = place.top() >= whole.top() && place.bottom() <= whole.bottom();
        // Those that touch do not lie over one another.
        is_in && !taken.iter().any(|other| other.shrink(0.5).intersects(*place))
    };
    let moved = |to: &Rect| (to.top() - place.top()).abs();
    places.filter(is_free).min_by(|one, other| moved(one).total_cmp(&moved(other))).unwrap_or(place)
}

/// Draws, in the lower right corner of `rect`, a card that lists the overlays in their colours. It is placed by its
/// height in the last frame, and drawn again where that changed.
fn card(ui: &mut Ui, own: &Overlays, model: &mut Model, rect: Rect) {
    let id = ui.scope_id().with("overlay card height");
    let height: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(96.0);
    let width = WIDTH.min(rect.width() - 24.0).max(1.0);
    let corner = pos2(rect.right() - width - 12.0, rect.bottom() - height - 12.0);
    let place = Rect::from_min_size(corner, vec2(width, rect.height()));
    let builder = UiBuilder::new().max_rect(place).id_salt("overlay card").sense(Sense::CLICK | Sense::DRAG);
    let card = ui.scope_builder(builder, |ui| {
        let frame = theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94));
        frame.show(ui, |ui| {
            ui.set_width((width - 16.0).max(1.0));
            ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
            contents(ui, own, model);
        })
    });
    tour_mark::frame(ui, model, TourSubject::Legend, &card.inner.response);
    let needed = card.inner.response.rect.height();
    if needed != height {
        ui.data_mut(|data| data.insert_temp(id, needed));
        ui.ctx().request_repaint();
    }
}

fn contents(ui: &mut Ui, own: &Overlays, model: &Model) {
    if let Some(capture) = model.frame.capture.as_ref().filter(|_| model.modes.overlays.contains(&Overlay::Vanishing)) {
        vanishing_lines::entries(ui, &vanishing::axes(capture));
        if model.modes.overlays.len() == 1 {
            return;
        }
    }
    if !model.can_ask() {
        ui.add(
            egui::Label::new(theme::note("Opened from a folder: its geometry is not known. Open the scene instead."))
                .wrap(),
        );
        return;
    }
    let on = model.modes.overlays.clone();
    if on.iter().any(|overlay| overlay.needs_anatomy()) {
        let anatomy = model.answers.of(AnatomyOf {});
        if let Some(reason) = anatomy.failed {
            ui.add(egui::Label::new(theme::note(reason)).wrap());
        } else if anatomy.ready.is_none() {
            ui.label(theme::note("Looking at the geometry …"));
        }
    }
    let line = |ui: &mut Ui, color, text: &str| {
        ui.horizontal_top(|ui| {
            theme::swatch(ui, color);
            ui.add(egui::Label::new(theme::note(text)).wrap());
        });
    };
    let theme = theme::of(ui);
    let made = own.made.as_ref();
    let left_out = |lines: Option<&LinesOfSides>| lines.map_or(0, |(lines, _)| lines.left_out);
    if on.contains(&Overlay::Silhouettes) {
        // Where no volume is drawn, as in a frame of rays or maps, nothing is counted.
        let counts = model.frame.capture.as_ref().is_some_and(|capture| capture.counts_volumes());
        line(ui, theme.lit, if counts { COUNTED_EDGE } else { "silhouette edge, as the light sees it" });
    }
    if on.contains(&Overlay::Volumes) {
        let has_any = made.and_then(|made| made.volumes.as_ref()).is_none_or(|(lines, _)| !lines.lines.is_empty());
        if has_any {
            for (part, name) in
                [(DrawPart::Side, "side"), (DrawPart::LightCap, "light cap"), (DrawPart::DarkCap, "dark cap")]
            {
                line(ui, theme.part(part).unwrap_or(theme.dim), name);
            }
            let is_of_two =
                model.modes.compare.is_some_and(|one| one.has_two_places() && one.with.is_of_another_frame());
            if let Some(capture) = model.frame.capture.as_ref().filter(|_| is_of_two) {
                ui.add(egui::Label::new(theme::note(format!("volumes: of {} alone", capture.technique))).wrap());
            }
        } else {
            ui.label(theme::note("this frame draws no volumes here"));
        }
    }
    let left = made.map_or(0, |made| left_out(made.silhouettes.as_ref()) + left_out(made.volumes.as_ref()));
    if left > 0 {
        ui.label(theme::note(format!("{} left out", format::counted(left as u64, "line"))));
    }
    if on.contains(&Overlay::Receivers) {
        line(ui, palette::receiver(2), "receives shadows");
    }
    if on.contains(&Overlay::Tests) {
        tests(ui, model);
    }
}

/// Draws, where overdraw is chosen and not shown, that fragments are being counted, why they can't be, or, where no
/// scene is open, that the scene has to be opened.
pub fn counting_note(ui: &mut Ui, model: &Model, rect: Rect) {
    let text = match (&model.scene, model.want_tests().failed) {
        (None, _) => "Opened from a folder: its fragments can't be counted. Open the scene instead.".to_owned(),
        (_, Some(reason)) => reason,
        (_, None) => "Counting fragments …".to_owned(),
    };
    let place = Rect::from_min_size(
        rect.min + vec2(12.0, 12.0),
        vec2((WIDTH * 1.5).min(rect.width() - 24.0).max(1.0), rect.height()),
    );
    ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("counting note"), |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.add(egui::Label::new(text).wrap());
        });
    });
}

fn tests(ui: &mut Ui, model: &Model) {
    let reply = model.want_tests();
    let Some(known) = reply.ready else {
        let text = reply.failed.unwrap_or_else(|| "Counting fragments …".to_owned());
        ui.add(egui::Label::new(theme::note(text)).wrap());
        return;
    };
    if let Some(capture) = &model.frame.capture {
        theme::heading(ui, &format!("Tests of {}", model.selected().words(capture)));
    }
    for (outcome, name, hover) in OUTCOMES {
        let pixels = known.pixels[usize::from(outcome)];
        if pixels > 0 {
            super::legend_entry::entry(ui, palette::outcome(outcome), name, pixels).on_hover_text(hover);
            if outcome == TestCounts::UNKNOWN {
                ui.add(egui::Label::new(theme::note(hover)).wrap());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_at_the_picture_s_border_is_moved_into_it() {
        let whole = Rect::from_min_max(pos2(10.0, 20.0), pos2(110.0, 80.0));
        let at = |x, y, width| within(Rect::from_center_size(pos2(x, y), vec2(width, 10.0)), whole);
        assert_eq!(at(60.0, 50.0, 40.0).center(), pos2(60.0, 50.0), "inside it stays");
        assert_eq!(at(12.0, 79.0, 40.0), Rect::from_min_max(pos2(10.0, 70.0), pos2(50.0, 80.0)));
        assert_eq!(at(109.0, 21.0, 40.0), Rect::from_min_max(pos2(70.0, 20.0), pos2(110.0, 30.0)));
        assert_eq!(at(60.0, 50.0, 400.0).left(), 10.0, "its beginning is read");
    }

    #[test]
    fn names_at_one_place_do_not_lie_over_one_another() {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(200.0, 120.0));
        let mut taken: Vec<Rect> = Vec::new();
        for (x, y) in [(60.0, 50.0), (62.0, 52.0), (70.0, 48.0), (60.0, 50.0), (60.0, 119.0), (64.0, 117.0)] {
            let wished = within(Rect::from_center_size(pos2(x, y), vec2(60.0, 18.0)), whole);
            let place = beside_others(wished, whole, &taken);
            assert!(whole.contains_rect(place) && taken.iter().all(|other| !other.shrink(0.5).intersects(place)));
            taken.push(place);
        }
        let alone = Rect::from_min_size(pos2(10.0, 10.0), vec2(60.0, 18.0));
        assert_eq!(beside_others(alone, whole, &[]), alone);
    }
}
