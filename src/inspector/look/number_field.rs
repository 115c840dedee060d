//! A field for a number, which says why it refuses what was typed.

use super::theme;
use egui::emath::Numeric;
use egui::{CornerRadius, DragValue, Event, Key, Response, RichText, Stroke, StrokeKind, Ui, Widget};
use std::cell::{Cell, RefCell};
use std::ops::RangeInclusive;
use std::rc::Rc;
use std::time::Duration;

/// Farthest from the origin that a place may be typed or dragged to, metres: single precision still tells one from the
/// next there, and the number fits into its field.
const MOST_PLACE: f64 = 1e7;
/// How long a field says why it refused something, seconds.
const SAID_FOR: f64 = 8.0;
/// How many letters of what was refused are repeated.
const MOST_LETTERS: usize = 12;

/// A field for a number that is taken when editing ends. What is no number, or one outside of the range such as 1e400, is
/// refused: the last good value stays, and the field says so until it is used again. A field that is left without typing
/// keeps all digits of its value, of which it shows only some.
pub struct NumberField<'a> {
    widget: DragValue<'a>,
    /// Something was typed since the field got the focus.
    is_typed: Rc<Cell<bool>>,
    /// What was refused in this frame, as words.
    refused: Rc<RefCell<Option<String>>>,
    /// Why its range ends where it does.
    limit: Option<&'static str>,
}

impl NumberField<'_> {
    /// Returns the field with the reason why its range ends where it does, which it says where a number beyond is typed or
    /// dragged to.
    pub fn because(self, limit: &'static str) -> Self {
        NumberField { limit: Some(limit), ..self }
    }
}

/// Why a field refused what was typed, and from when until when it says so, at most.
#[derive(Debug, Clone)]
struct Refusal {
    words: String,
    since: f64,
    until: f64,
}

/// Returns a field for a number within `range`, which is widened to the present value; `looks` sets speed, unit and
/// decimals.
pub fn number_field<'a, Number: Numeric>(
    number: &'a mut Number,
    range: RangeInclusive<f64>,
    looks: impl FnOnce(DragValue<'a>) -> DragValue<'a>,
) -> NumberField<'a> {
    let now = number.to_f64();
    let (low, high) = match now.is_finite() {
        true => (range.start().min(now), range.end().max(now)),
        false => range.into_inner(),
    };
    let refused = Rc::<RefCell<Option<String>>>::default();
    let refuses = Rc::clone(&refused);
    let is_typed = Rc::<Cell<bool>>::default();
    let was_typed = Rc::clone(&is_typed);
    let parser = move |text: &str| {
        if !was_typed.get() {
            return None;
        }
        let taken = within(text, low, high);
        refuses.replace(taken.as_ref().err().map(|why| format!("{why}: {} stays", in_words(now))));
        taken.ok()
    };
    let widget = DragValue::new(number).range(low..=high).update_while_editing(false).custom_parser(parser);
    NumberField { widget: looks(widget), is_typed, refused, limit: None }
}

/// Returns about how many letters [`place_field`] shows of a coordinate.
pub fn place_letters(coordinate: f64) -> usize {
    let decimals = place_decimals(coordinate);
    egui::emath::format_with_decimals_in_range(coordinate, decimals.min(2)..=decimals).chars().count()
}

fn place_decimals(coordinate: f64) -> usize {
    let digits = coordinate.abs().max(1.0).log10().min(7.0) as usize;
    5_usize.saturating_sub(digits).min(4)
}

/// Returns a field for a coordinate in metres, which shows the fewer decimals the larger it is, within 10 000 km from the
/// origin.
pub fn place_field<'a>(coordinate: &'a mut f64, looks: impl FnOnce(DragValue<'a>) -> DragValue<'a>) -> NumberField<'a> {
    let decimals = place_decimals(*coordinate);
    number_field(coordinate, -MOST_PLACE..=MOST_PLACE, |widget| looks(widget.max_decimals(decimals)))
}

impl Widget for NumberField<'_> {
    fn ui(self, ui: &mut Ui) -> Response {
        let typed = ui.next_auto_id().with("typed");
        let types = ui.memory(|memory| memory.has_focus(ui.next_auto_id())) && ui.input(types_something);
        let is_typed = types || ui.data(|data| data.get_temp(typed)).unwrap_or(false);
        self.is_typed.set(is_typed);
        let response = ui.add(self.widget);
        // A field that gets the focus has its value as text.
        let goes_on = response.has_focus() && !response.gained_focus();
        ui.data_mut(|data| data.insert_temp(typed, is_typed && goes_on));
        let (id, now) = (response.id.with("refusal"), ui.input(|input| input.time));
        let is_stopped = response.drag_delta().x - response.drag_delta().y != 0.0 && !response.changed();
        let refused = match (self.refused.take(), self.limit) {
            (Some(words), Some(limit)) => Some(format!("{words}; {limit}")),
            (None, Some(limit)) if response.dragged() && is_stopped => Some(limit.to_owned()),
            (refused, _) => refused,
        };
        if let Some(words) = refused {
            ui.data_mut(|data| data.insert_temp(id, Refusal { words, since: now, until: now + SAID_FOR }));
        } else if response.changed() || response.gained_focus() || response.dragged() {
            ui.data_mut(|data| data.remove::<Refusal>(id));
        }
        let Some(Refusal { words, since, until }) = ui.data(|data| data.get_temp(id)) else { return response };
        // The press that left the field is at its beginning; with the next the user is elsewhere.
        let is_elsewhere = now > since && ui.input(|input| input.pointer.any_pressed());
        if now >= until || is_elsewhere {
            ui.data_mut(|data| data.remove::<Refusal>(id));
        } else if ui.is_rect_visible(response.rect) {
            let ink = theme::of(ui).error;
            ui.painter().rect_stroke(response.rect, CornerRadius::same(3), Stroke::new(1.5, ink), StrokeKind::Outside);
            response.show_tooltip_ui(|ui| drop(ui.label(RichText::new(words).color(ink))));
            ui.ctx().request_repaint_after(Duration::from_secs_f64(until - now));
        }
        response
    }
}

/// Returns whether the input of this frame changes the text of the field that has the focus.
fn types_something(input: &egui::InputState) -> bool {
    input.events.iter().any(|event| match event {
        Event::Text(_) | Event::Paste(_) | Event::Cut | Event::Ime(_) => true,
        Event::Key { key, pressed, .. } => *pressed && matches!(key, Key::Backspace | Key::Delete | Key::Z),
        _ => false,
    })
}

/// Returns the number that a text is, in egui's way of writing it.
///
/// # Errors
/// It is none, or not from `low` to `high`; a sentence without its end.
fn within(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let plain: String = text.chars().filter(|letter| !letter.is_whitespace()).collect();
    let number = plain.replace('−', "-").parse::<f64>().ok().filter(|number| !number.is_nan());
    match number {
        None => Err(format!("\"{}\" is no number", shortened(text))),
        Some(number) if (low..=high).contains(&number) => Ok(number),
        Some(_) => {
            let text = shortened(&plain);
            Err(format!("{text} is not from {} to {}", in_words(low), in_words(high)))
        }
    }
}

fn shortened(text: &str) -> String {
    let end = text.char_indices().nth(MOST_LETTERS).map(|(at, _)| at);
    end.map_or_else(|| text.to_owned(), |end| format!("{}…", &text[..end]))
}

/// Returns a number as a user would type it: as a power of ten where it has many digits.
fn in_words(number: f64) -> String {
    let is_plain = number == 0.0 || (1e-3..1e5).contains(&number.abs());
    // A number of single precision has no more digits than that.
    let single = Some(number as f32).filter(|single| f64::from(*single) == number);
    let text = match (single, is_plain) {
        (Some(single), true) => format!("{single}"),
        (None, true) => format!("{number}"),
        _ => format!("{number:e}"),
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_or_too_large_is_refused_in_words() {
        let place = |text| within(text, -MOST_PLACE, MOST_PLACE);
        assert_eq!(place("1e400"), Err("1e400 is not from −1e7 to 1e7".to_owned()));
        assert_eq!(place("1e38"), Err("1e38 is not from −1e7 to 1e7".to_owned()));
        assert_eq!(within("-3", 1e-6, 179.0), Err("-3 is not from 1e−6 to 179".to_owned()));
        for text in ["nan", "one", ""] {
            assert_eq!(place(text), Err(format!("\"{text}\" is no number")));
        }
        assert_eq!([place(" −2.5 "), place("1 000")], [Ok(-2.5), Ok(1000.0)]);
    }
}
