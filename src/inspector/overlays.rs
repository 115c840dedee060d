//! What is drawn over the picture, several at once: silhouettes, wireframes of volumes, how fragments
//! fared in the tests, receivers, names of casters. Chosen in a menu, listed in a card with their colours.

use super::canvas::Sheet;
use super::coloring::Coloring;
use super::format;
use super::object_ids::ObjectIds;
use super::overlay_lines::{Lines, PlacedLines, middle, multiplicity};
use super::palette;
use super::placement::Placement;
use super::scene_view::plate;
use super::state::State;
use super::tests_state::OUTCOMES;
use super::theme;
use super::view::{PictureKind, Shown};
use crate::anatomy::Anatomy;
use crate::capture::{Capture, Image};
use crate::plan::Part;
use egui::{Align2, CornerRadius, FontId, Pos2, Rect, Sense, Shape, Ui, UiBuilder, pos2, vec2};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Width of the card, points.
const WIDTH: f32 = 176.0;
/// How near to an edge the pointer has to be, points.
const REACH: f32 = 5.0;
/// Least width of the menu's button, points.
const BUTTON_WIDTH: f32 = 84.0;

/// Something drawn over the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Overlay {
    /// The edges that bound the shadows of the shown light.
    Silhouettes,
    /// The edges of its shadow volumes.
    Volumes,
    /// How the step's fragments fared in depth and stencil test.
    Tests,
    /// Where objects receive shadows.
    Receivers,
    /// What throws shadows is called.
    Names,
}

impl Overlay {
    /// In the order of the menu.
    pub const ALL: [Overlay; 5] =
        [Overlay::Silhouettes, Overlay::Volumes, Overlay::Tests, Overlay::Receivers, Overlay::Names];

    /// In the menu.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Overlay::Silhouettes => "Silhouettes",
            Overlay::Volumes => "Wireframe of volumes",
            Overlay::Tests => "Depth and stencil tests",
            Overlay::Receivers => "Receivers",
            Overlay::Names => "Casters' names",
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Overlay::Silhouettes => "The edges of casters that bound their shadow, of the shown light",
            Overlay::Volumes => "Sides and caps of the shadow volumes that the frame draws, of the shown light",
            Overlay::Tests => "Where fragments of the selected step pass or fail; hits of z-fail stay visible",
            Overlay::Receivers => "Where objects are darkened by shadows",
            Overlay::Names => "The name of each caster at the middle of what is seen of it",
        }
    }

    fn needs_anatomy(self) -> bool {
        self != Overlay::Tests
    }
}

/// Which overlays are on, and what was made for them.
#[derive(Debug, Default)]
pub struct Overlays {
    /// Those that are on.
    pub on: BTreeSet<Overlay>,
    /// The menu is to be opened.
    pub open_menu: bool,
    made: Option<Made>,
}

/// What follows from an anatomy and a light.
#[derive(Debug)]
struct Made {
    anatomy: Arc<Anatomy>,
    capture: [u32; 2],
    light: usize,
    silhouettes: Option<(Lines, PlacedLines)>,
    volumes: Option<(Lines, PlacedLines)>,
    objects: Option<SeenObjects>,
}

/// Which objects are seen where.
#[derive(Debug)]
struct SeenObjects {
    receivers: Arc<Image>,
    middles: Vec<Option<[u32; 2]>>,
}

impl Overlays {
    /// Another frame is shown.
    pub fn forget_frame(&mut self) {
        self.made = None;
    }

    fn make(&mut self, anatomy: &Arc<Anatomy>, capture: &Capture, light: usize) -> &mut Made {
        let is_it =
            |made: &Made| Arc::ptr_eq(&made.anatomy, anatomy) && made.light == light && made.capture == capture.size;
        let made = self.made.take().filter(is_it);
        let mut made = made.unwrap_or_else(|| Made {
            anatomy: anatomy.clone(),
            capture: capture.size,
            light,
            silhouettes: None,
            volumes: None,
            objects: None,
        });
        if self.on.contains(&Overlay::Silhouettes) && made.silhouettes.is_none() {
            made.silhouettes = Some((Lines::silhouettes(anatomy, capture, light), PlacedLines::default()));
        }
        if self.on.contains(&Overlay::Volumes) && made.volumes.is_none() {
            made.volumes = Some((Lines::volumes(anatomy, capture, light), PlacedLines::default()));
        }
        if (self.on.contains(&Overlay::Receivers) || self.on.contains(&Overlay::Names)) && made.objects.is_none() {
            let ids = ObjectIds::new(anatomy, capture);
            made.objects = Some(SeenObjects { receivers: Arc::new(ids.receivers), middles: ids.middles });
        }
        self.made.insert(made)
    }
}

/// The menu, with a box and a swatch an overlay.
pub fn menu(ui: &mut Ui, state: &mut State) {
    let count = state.modes.overlays.on.len();
    let text = if count == 0 { "Overlay".to_owned() } else { format!("Overlay · {count}") };
    // Of the same width with and without a number, so that nothing beside it moves.
    let button = ui.add(egui::Button::new(text).min_size(vec2(BUTTON_WIDTH, 0.0)));
    let button = button.on_hover_text("What is drawn over the picture (O)");
    let button = button.on_disabled_hover_text("Several pictures at once: choose one of them to draw over it");
    let id = egui::Popup::default_response_id(&button);
    if std::mem::take(&mut state.modes.overlays.open_menu) && button.enabled() {
        egui::Popup::open_id(ui.ctx(), id);
    }
    let popup = egui::Popup::menu(&button).close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
    popup.show(|ui| {
        ui.set_min_width(190.0);
        for overlay in Overlay::ALL {
            ui.horizontal(|ui| {
                let color = swatch_of(ui, overlay);
                theme::swatch(ui, color);
                let mut is_on = state.modes.overlays.on.contains(&overlay);
                let line = ui.checkbox(&mut is_on, overlay.name()).on_hover_text(overlay.meaning());
                if line.changed() && is_on {
                    state.modes.overlays.on.insert(overlay);
                } else if line.changed() {
                    state.modes.overlays.on.remove(&overlay);
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
        Overlay::Names => theme.text,
    }
}

/// Pictures over the shown one; asks for what they need.
pub fn sheets(state: &mut State, capture: &Capture, shown: &Shown, rect: Rect) -> Vec<Sheet> {
    let mut sheets = Vec::new();
    if shown.kind == PictureKind::Map {
        return sheets;
    }
    if state.modes.overlays.on.iter().any(|overlay| overlay.needs_anatomy()) && state.scene.is_some() {
        let light = state.view.light;
        let is_current = state.anatomy.is_of_frame();
        if let Some(anatomy) = state.anatomy.want().filter(|_| is_current) {
            let made = state.modes.overlays.make(&anatomy, capture, light);
            let receivers = made.objects.as_ref().map(|objects| objects.receivers.clone());
            if let Some(image) = receivers.filter(|_| state.modes.overlays.on.contains(&Overlay::Receivers)) {
                sheets.push(Sheet { image, coloring: Coloring::Receivers, part: rect, has_numbers: false });
            }
        }
    }
    if state.modes.overlays.on.contains(&Overlay::Tests) && state.scene.is_some() {
        let at = state.selected();
        if let Some(known) = state.modes.tests.want(at) {
            let image = known.outcomes.clone();
            sheets.push(Sheet { image, coloring: Coloring::Outcomes, part: rect, has_numbers: false });
        }
    }
    sheets
}

/// Lines and names over the picture, and the card that lists what is on.
pub fn ui(ui: &mut Ui, state: &mut State, rect: Rect, shown: &Shown, placement: Placement) {
    if state.modes.overlays.on.is_empty() || shown.kind == PictureKind::Map {
        return;
    }
    let seen = placement.rect().intersect(rect);
    paint(ui, &mut state.modes.overlays, seen, placement);
    if let Some(pointer) = ui.input(|input| input.pointer.hover_pos()).filter(|_| state.hover.is_some()) {
        number_under(ui, &state.modes.overlays, seen, placement, pointer);
    }
    card(ui, state, rect);
}

/// Lines, their numbers and names, clipped to `seen`.
pub fn paint(ui: &Ui, overlays: &mut Overlays, seen: Rect, placement: Placement) {
    let painter = ui.painter_at(seen);
    let (theme, is_dark, pixels) = (theme::of(ui), ui.visuals().dark_mode, ui.pixels_per_point());
    let Overlays { on, made, .. } = overlays;
    let Some(made) = made else { return };
    let kinds = [(Overlay::Volumes, &mut made.volumes), (Overlay::Silhouettes, &mut made.silhouettes)];
    for (_, lines) in kinds.into_iter().filter(|(overlay, _)| on.contains(overlay)) {
        if let Some((lines, placed)) = lines {
            painter.add(Shape::mesh(placed.of(lines, placement, theme, is_dark, pixels)));
            for (at, times) in placed.numbers(lines, placement, seen).iter() {
                plate(&painter, *at, Align2::CENTER_CENTER, &multiplicity(*times), true, theme);
            }
        }
    }
    if let Some(SeenObjects { middles, .. }) = made.objects.as_ref().filter(|_| on.contains(&Overlay::Names)) {
        let casters = made.anatomy.objects.iter().zip(middles).filter(|(object, _)| object.casts);
        for (object, at) in casters.filter_map(|(object, at)| Some((object, (*at)?))) {
            name(ui, &painter, middle(placement, at), &object.name);
        }
    }
}

/// Beside the pointer: how often the edge under it counts, where that is not once. Short edges have no number.
fn number_under(ui: &Ui, overlays: &Overlays, seen: Rect, placement: Placement, pointer: Pos2) {
    let made = overlays.made.as_ref().filter(|_| overlays.on.contains(&Overlay::Silhouettes));
    let Some((lines, _)) = made.and_then(|made| made.silhouettes.as_ref()) else { return };
    if let Some(times) = lines.number_near(placement, pointer, REACH) {
        let words = format!("{}: counts {} times", multiplicity(times), times.unsigned_abs());
        plate(&ui.painter_at(seen), pointer + vec2(14.0, -4.0), Align2::LEFT_BOTTOM, &words, false, theme::of(ui));
    }
}

fn name(ui: &Ui, painter: &egui::Painter, at: Pos2, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(theme::SMALL_SIZE), theme::of(ui).text);
    let place = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), Rect::from_center_size(at, vec2(0.0, 0.0)));
    painter.rect_filled(place.expand2(vec2(6.0, 3.0)), CornerRadius::same(4), theme::of(ui).panel.gamma_multiply(0.9));
    painter.galley(place.min, galley, theme::of(ui).text);
}

/// In the lower right corner: what is on, in its colours. Its height is that of the frame before.
fn card(ui: &mut Ui, state: &mut State, rect: Rect) {
    let id = ui.scope_id().with("overlay card height");
    let height: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(96.0);
    let corner = pos2(rect.right() - WIDTH - 12.0, rect.bottom() - height - 12.0);
    let place = Rect::from_min_size(corner, vec2(WIDTH, rect.height()));
    let builder = UiBuilder::new().max_rect(place).id_salt("overlay card").sense(Sense::CLICK | Sense::DRAG);
    let card = ui.scope_builder(builder, |ui| {
        let frame = theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94));
        frame.show(ui, |ui| {
            ui.set_width(WIDTH - 16.0);
            ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
            contents(ui, state);
        })
    });
    let needed = card.inner.response.rect.height();
    if needed != height {
        ui.data_mut(|data| data.insert_temp(id, needed));
        ui.ctx().request_repaint();
    }
}

fn contents(ui: &mut Ui, state: &mut State) {
    if state.scene.is_none() {
        ui.add(
            egui::Label::new(theme::note("Opened from a folder: its geometry is not known. Open the scene instead."))
                .wrap(),
        );
        return;
    }
    let on = state.modes.overlays.on.clone();
    if on.iter().any(|overlay| overlay.needs_anatomy()) {
        if let Some(reason) = state.anatomy.failed() {
            ui.add(egui::Label::new(theme::note(reason)).wrap());
        } else if !state.anatomy.is_of_frame() {
            ui.label(theme::note("Looking at the geometry …"));
        }
    }
    let line = |ui: &mut Ui, color, text: &str| {
        ui.horizontal(|ui| {
            theme::swatch(ui, color);
            ui.label(theme::note(text));
        });
    };
    let theme = theme::of(ui);
    let made = state.modes.overlays.made.as_ref();
    let left_out = |lines: Option<&(Lines, PlacedLines)>| lines.map_or(0, |(lines, _)| lines.left_out);
    if on.contains(&Overlay::Silhouettes) {
        line(ui, theme.lit, "silhouette; thick, ±2: twice");
    }
    if on.contains(&Overlay::Volumes) {
        let has_any = made.and_then(|made| made.volumes.as_ref()).is_none_or(|(lines, _)| !lines.lines.is_empty());
        if has_any {
            for (part, name) in [(Part::Side, "side"), (Part::LightCap, "light cap"), (Part::DarkCap, "dark cap")] {
                line(ui, theme.part(part).unwrap_or(theme.dim), name);
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
        tests(ui, state);
    }
}

/// While the overdraw is wished for and not there: that it is counted, or why it can't be.
pub fn counting_note(ui: &mut Ui, state: &State, rect: Rect) {
    let at = state.selected();
    let text = match (&state.scene, state.modes.tests.failed(at)) {
        (None, _) => "Opened from a folder: its fragments can't be counted. Open the scene instead.",
        (_, Some(reason)) => reason,
        (_, None) => "Counting fragments …",
    };
    let place = Rect::from_min_size(rect.min + vec2(12.0, 12.0), vec2(WIDTH * 1.5, rect.height()));
    ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("counting note"), |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.add(egui::Label::new(text).wrap());
        });
    });
}

fn tests(ui: &mut Ui, state: &State) {
    let at = state.selected();
    let Some(known) = state.modes.tests.of(at) else {
        let text = state.modes.tests.failed(at).unwrap_or("Counting fragments …").to_owned();
        ui.add(egui::Label::new(theme::note(text)).wrap());
        return;
    };
    theme::heading(ui, &format!("Tests of {}", at.words()));
    for (outcome, name, hover) in OUTCOMES {
        let pixels = known.pixels[usize::from(outcome)];
        if pixels > 0 {
            super::legend::entry(ui, palette::outcome(outcome), name, pixels).on_hover_text(hover);
        }
    }
}
