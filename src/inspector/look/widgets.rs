//! Small widgets that several panels use.

use super::theme;
use egui::containers::menu::{MenuButton, is_in_menu};
use egui::{
    Align2, Atom, AtomPaintArgs, CornerRadius, InnerResponse, Rect, RectAlign, Response, RichText, Shape, Stroke,
    StrokeKind, Tooltip, Ui, Vec2, pos2, vec2,
};

/// One of several buttons side by side.
#[derive(Debug, Clone, Copy)]
pub struct ButtonSegment<'a> {
    /// Its text.
    pub label: &'a str,
    /// What it does, or why it can't be pressed.
    pub explanation: &'a str,
    /// Whether it can be pressed.
    pub is_enabled: bool,
    /// It is not chosen, but its picture is the one that is shown.
    pub is_seen: bool,
    /// The settings that were changed, marked by a dot; empty where none was.
    pub changed: &'a str,
}

impl<'a> ButtonSegment<'a> {
    /// Returns a segment that can be pressed.
    pub fn new(label: &'a str, explanation: &'a str) -> ButtonSegment<'a> {
        ButtonSegment { label, explanation, is_enabled: true, is_seen: false, changed: "" }
    }
}

/// Width and height of the triangle on the button of a menu, points.
const MENU_TRIANGLE: [f32; 2] = [8.0, 5.0];
/// Padding between the words of joined buttons and their borders, points.
const SEGMENT_PADDING: f32 = 6.0;

/// Draws buttons side by side in one frame, given as label and hover text; `chosen` is the index of the one drawn as
/// chosen. Returns the index of the one that was clicked in this frame, which may be the chosen one.
pub fn segments(ui: &mut Ui, labels: &[(&str, &str)], chosen: Option<usize>) -> Option<usize> {
    let all: Vec<ButtonSegment> =
        labels.iter().map(|(label, explanation)| ButtonSegment::new(label, explanation)).collect();
    segments_of(ui, &all, chosen)
}

/// Draws buttons side by side in one frame, with dots at changed settings and a line under the one whose picture is
/// shown; those not enabled can't be pressed. Returns the index of the one that was clicked in this frame.
pub fn segments_of(ui: &mut Ui, segments: &[ButtonSegment], chosen: Option<usize>) -> Option<usize> {
    let mut clicked = None;
    let frame = egui::Frame::new()
        .fill(theme::of(ui).raised)
        .stroke(Stroke::new(1.0, theme::of(ui).line))
        .corner_radius(CornerRadius::same(4));
    frame.show(ui, |ui| {
        // Left to right in any surrounding layout.
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            // So that the buttons for all kinds of picture fit into a window of 1280 points.
            ui.spacing_mut().button_padding.x = SEGMENT_PADDING;
            for (index, segment) in segments.iter().enumerate() {
                let is_chosen = chosen == Some(index);
                // One that can't be pressed fades as every such widget does.
                let is_bright = !segment.is_enabled || is_chosen || segment.is_seen;
                let color = if is_bright { theme::of(ui).text } else { theme::of(ui).dim };
                let fill = if is_chosen { theme::of(ui).selected_row } else { theme::of(ui).raised };
                let text = RichText::new(segment.label).color(color);
                let button = egui::Button::selectable(is_chosen, text)
                    .fill(fill)
                    .stroke(Stroke::NONE)
                    .corner_radius(CornerRadius::same(3))
                    .min_size(vec2(0.0, theme::ROW_HEIGHT - 2.0));
                let button = ui.add_enabled(segment.is_enabled, button);
                let button = button.on_hover_text(segment.explanation).on_disabled_hover_text(segment.explanation);
                if !segment.changed.is_empty() {
                    let name = format!("{}, changed: {}", segment.label, segment.changed);
                    // Beside the last letter, not on it.
                    let at = button.rect.right_top() + vec2(-3.5, 4.0);
                    ui.painter().circle_filled(at, 2.5, theme::of(ui).lit);
                    let place = Rect::from_center_size(at, vec2(8.0, 8.0));
                    let mark = ui.interact(place, button.id.with("changed"), egui::Sense::hover());
                    mark.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
                    mark.on_hover_text(name.as_str());
                }
                if segment.is_seen {
                    let [from, to] = [button.rect.left() + 8.0, button.rect.right() - 8.0];
                    ui.painter().hline(from..=to, button.rect.bottom() - 2.0, Stroke::new(1.5, theme::of(ui).dim));
                }
                if button.has_focus() {
                    let outline = Stroke::new(1.0, theme::of(ui).focus);
                    ui.painter().rect_stroke(button.rect, CornerRadius::same(3), outline, StrokeKind::Inside);
                }
                if button.clicked() {
                    clicked = Some(index);
                }
            }
        });
    });
    clicked
}

/// Draws the same choice as [`segments_of`] where there is space for it and for `beside` points more, and otherwise as a
/// list named `name`, which also names the picture that is shown. Returns the index of what was chosen in this frame.
pub fn choice(
    ui: &mut Ui,
    name: &str,
    segments: &[ButtonSegment],
    chosen: Option<usize>,
    beside: f32,
) -> Option<usize> {
    if width_of(ui, segments) + beside <= ui.available_width() {
        return segments_of(ui, segments, chosen);
    }
    let mut clicked = None;
    let mut current: Vec<&str> = chosen.iter().map(|index| segments[*index].label).collect();
    current.extend(segments.iter().find(|segment| segment.is_seen).map(|segment| segment.label));
    let combo = egui::ComboBox::from_id_salt(name).selected_text(current.join(": ")).height(420.0);
    let combo = combo.show_ui(ui, |ui| {
        for (index, segment) in segments.iter().enumerate() {
            let label = match segment.changed {
                "" => segment.label.to_owned(),
                changed => format!("{} ({changed})", segment.label),
            };
            let line = egui::Button::selectable(chosen == Some(index), label);
            let line = ui.add_enabled(segment.is_enabled, line);
            if explained(ui, line, segment.explanation).clicked() {
                clicked = Some(index);
            }
        }
    });
    combo.response.accessible_name(name);
    clicked
}

/// Draws the button of a menu: its word, and a triangle as lists have it, so that it is not taken for one that acts at once. In
/// another menu it is an entry with egui's own arrow.
pub fn menu_button<R>(ui: &mut Ui, word: &str, contents: impl FnOnce(&mut Ui) -> R) -> InnerResponse<Option<R>> {
    if is_in_menu(ui) {
        return ui.menu_button(word, contents);
    }
    let (response, inner) =
        MenuButton::from_button(egui::Button::new((word, menu_triangle())).gap(6.0)).ui(ui, contents);
    InnerResponse::new(inner.map(|shown| shown.inner), response)
}

/// Returns the triangle on the button of a menu.
pub fn menu_triangle() -> Atom<'static> {
    let size = Vec2::from(MENU_TRIANGLE);
    Atom::paint(size, move |ui, args: AtomPaintArgs| {
        let triangle = Rect::from_center_size(args.rect.center(), size);
        ui.painter().add(Shape::rotated_triangle(triangle, 0.0, args.fallback_text_color));
    })
}

/// Explains an entry of the list that `ui` draws while the pointer is on it, beside the list: under the entry, the words would
/// hide the next ones.
pub fn explained(ui: &Ui, entry: Response, words: &str) -> Response {
    let list = Rect::from_x_y_ranges(ui.max_rect().x_range(), entry.rect.y_range());
    for mut tooltip in [Tooltip::for_enabled(&entry), Tooltip::for_disabled(&entry)] {
        let popup = tooltip.popup.anchor(list).align(RectAlign::RIGHT_START);
        tooltip.popup = popup.align_alternatives(&[RectAlign::LEFT_START, RectAlign::BOTTOM_START]);
        tooltip.show(|ui| ui.label(words));
    }
    entry
}

/// Returns the width that [`segments_of`] needs, points.
fn width_of(ui: &Ui, segments: &[ButtonSegment]) -> f32 {
    let font = egui::TextStyle::Button.resolve(ui.style());
    // egui takes the stroke of a button off its padding, also where it is drawn without one.
    let padding = SEGMENT_PADDING - ui.visuals().widgets.inactive.bg_stroke.width;
    let word = |segment: &ButtonSegment| {
        ui.painter().layout_no_wrap(segment.label.to_owned(), font.clone(), egui::Color32::PLACEHOLDER).size().x
    };
    segments.iter().map(|segment| word(segment) + 2.0 * padding).sum::<f32>() + 2.0
}

/// Draws the name of a setting, bright where the setting was changed and dim otherwise.
pub fn setting_name(ui: &mut Ui, name: &str, is_changed: bool) -> Response {
    let ink = if is_changed { theme::of(ui).text } else { theme::of(ui).dim };
    ui.label(theme::note(name).color(ink))
}

/// Width of a button that resets one setting, points.
const RESET_WIDTH: f32 = 14.0;

/// Draws the start of a setting's row: where it was changed a mark that resets it when pressed. The space is there also
/// without a mark, so that nothing moves. Returns whether it was pressed.
pub fn reset(ui: &mut Ui, name: &str, is_changed: bool, before: &str) -> bool {
    let size = vec2(RESET_WIDTH, ui.spacing().interact_size.y);
    if !is_changed {
        ui.allocate_exact_size(size, egui::Sense::hover());
        return false;
    }
    let button = egui::Button::new(theme::number("↺").size(15.0)).frame_when_inactive(false);
    let place = ui.scope(|ui| {
        ui.spacing_mut().button_padding = Vec2::ZERO;
        ui.add_sized(size, button)
    });
    let button = place.inner.accessible_name(format!("Reset {name}"));
    button.on_hover_text(format!("Changed. Back to {before}")).clicked()
}

/// Reserves the arrow keys for a widget while it has the focus, so that they do not step through the frame or move the
/// focus. Call it in each frame.
pub fn keep_arrows(ui: &Ui, response: &Response) {
    if response.has_focus() {
        let arrows =
            egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..egui::EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        ui.data_mut(|data| data.insert_temp(own_arrows(), response.id));
    }
}

/// Returns whether the widget with the focus is one that arrow keys move.
pub fn has_own_arrows(ctx: &egui::Context, focus: Option<egui::Id>) -> bool {
    focus.is_some() && focus == ctx.data(|data| data.get_temp(own_arrows()))
}

/// Returns the id under which the focused widget that arrow keys move is stored.
fn own_arrows() -> egui::Id {
    egui::Id::unique("moved by arrows itself")
}

/// Draws the contents at the right end of a row, laid out from left to right, the order in which they are read and Tab
/// goes. `name` identifies their width, which is known from the last frame; where it changed, the frame is laid out
/// again.
pub fn at_right(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    let known = known_width(ui, name);
    ui.add_space((ui.available_width() - known).max(0.0));
    measured(ui, ui.scope_id().with(name), contents);
}

/// Returns the width of what [`at_right`] drew last under this name in this part of the window, points; 0 where nothing was
/// drawn.
pub fn known_width(ui: &Ui, name: &str) -> f32 {
    ui.data(|data| data.get_temp(ui.scope_id().with(name))).unwrap_or(0.0)
}

/// Draws groups of tools from left to right in rows of this height: a group that does not fit beside those before it
/// begins a row, and the last one stands at the right end of its row, so that it moves no others and no others move it.
/// Their widths are known from the last frame, as for [`at_right`]; `name` distinguishes them from other rows here.
pub fn in_rows<G: Copy + egui::AsIdSalt>(
    ui: &mut Ui,
    name: &str,
    height: f32,
    groups: &[G],
    mut draw: impl FnMut(&mut Ui, G),
) {
    let (of, gap, width) = (ui.scope_id().with(name), ui.spacing().item_spacing.x, ui.available_width());
    let known: Vec<f32> =
        groups.iter().map(|group| ui.data(|data| data.get_temp(of.with(group))).unwrap_or(0.0)).collect();
    let mut first = 0;
    while first < groups.len() {
        // A group of which nothing is drawn takes no space.
        let rights = known[first..].iter().scan(-gap, |right, known| {
            *right += if *known > 0.0 { gap + known } else { 0.0 };
            Some(*right)
        });
        let end = first + rights.take_while(|right| *right <= width).count().max(1);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(vec2(width, height), layout, |ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            let mut is_begun = false;
            for index in first..end {
                if known[index] > 0.0 {
                    ui.add_space(if std::mem::replace(&mut is_begun, true) { gap } else { 0.0 });
                }
                if index + 1 == groups.len() {
                    ui.add_space((ui.available_width() - known[index]).max(0.0));
                }
                measured(ui, of.with(groups[index]), |ui| {
                    ui.spacing_mut().item_spacing.x = gap;
                    draw(ui, groups[index]);
                });
            }
        });
        first = end;
    }
}

/// Returns the width of what [`in_rows`] drew last for a group in this part of the window, points; 0 where nothing was
/// drawn.
pub fn width_in_rows<G: egui::AsIdSalt>(ui: &Ui, name: &str, group: G) -> f32 {
    ui.data(|data| data.get_temp(ui.scope_id().with(name).with(group))).unwrap_or(0.0)
}

/// Draws the contents from left to right, and stores their width; where it changed, the frame is laid out again.
fn measured(ui: &mut Ui, id: egui::Id, contents: impl FnOnce(&mut Ui)) {
    let known: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(0.0);
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    let width = ui.scope_builder(egui::UiBuilder::new().layout(layout), contents).response.rect.width();
    if (width - known).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(id, width));
        ui.ctx().request_discard("what belongs together has another width");
    }
}

/// Draws text on a plate in the theme's background colour, so that it can be read over anything; `align` says which
/// point of the text is at `at`, and numbers are monospaced. Returns the plate's rectangle.
pub fn plate(
    painter: &egui::Painter,
    at: egui::Pos2,
    align: Align2,
    text: &str,
    is_number: bool,
    colors: &theme::Theme,
) -> Rect {
    let font =
        if is_number { theme::number_font(theme::SMALL_SIZE) } else { egui::FontId::proportional(theme::SMALL_SIZE) };
    let galley = painter.layout_no_wrap(text.to_owned(), font, colors.text);
    let place = align.anchor_size(pos2(at.x.round(), at.y.round()), galley.size());
    let plate = place.expand2(vec2(3.0, 0.0));
    painter.rect_filled(plate, CornerRadius::same(2), colors.background.gamma_multiply(0.8));
    painter.galley(place.min, galley, colors.text);
    plate
}
