//! Splits the input of mouse and keys into frames.
//!
//! egui asks once a frame what lies under the pointer, at the pointer's position at its end. Where frames are slow, a
//! press and the drag that follows come in one frame: the widget at the drag's end would be grabbed, the handle that
//! was pressed would stay behind, and a drag that ends in its first frame would have no effect. So a frame ends before
//! the pointer moves on from where a button went down or up, before the button of a movement goes up, and before a key
//! that follows a movement, which means the widget under the pointer. Where more than a few such frames wait, all input
//! is taken at once, as without this: what the window shows is then long out of date anyway.

use egui::Event;

/// How many frames may wait. Where frames are slower than that, it is more important that the window keeps up than what
/// is under the pointer.
const MOST_WAITING: usize = 8;

/// A mouse button pressed for longer is not a click, seconds. Times are those of frames, and where the CPU draws the window
/// and traces a truth meanwhile, a frame may take longer than egui's 0.8 s.
const LONGEST_CLICK: f64 = 2.0;
/// A finger that rests for longer means a right click, seconds: as on phones.
const LONGEST_TAP: f64 = 0.6;

/// Takes the events of the next frame out of `events`; the rest is for later frames. Lets a press of up to 2 seconds be a
/// click, and a finger that rests for more than 0.6 seconds a right click.
pub fn events_of_frame(ctx: &egui::Context, events: &mut Vec<Event>) -> Vec<Event> {
    let frame = of_next_frame(events);
    let is_released = frame.iter().any(|event| matches!(event, Event::PointerButton { pressed: false, .. }));
    let is_touched = frame
        .iter()
        .any(|event| matches!(event, Event::Touch { phase: egui::TouchPhase::Start | egui::TouchPhase::Move, .. }));
    // A tap whose end comes late, since a frame took long, is a tap all the same.
    if is_touched && !is_released {
        set_longest_click(ctx, LONGEST_TAP);
    } else if frame.iter().any(|event| matches!(event, Event::PointerButton { .. })) {
        set_longest_click(ctx, LONGEST_CLICK);
    }
    frame
}

fn set_longest_click(ctx: &egui::Context, seconds: f64) {
    ctx.options_mut(|options| options.input_options.max_click_duration = seconds);
}

/// Takes the events of the next frame out of `events`; the rest is for later frames. Takes all events where more than a
/// few frames would wait.
fn of_next_frame(events: &mut Vec<Event>) -> Vec<Event> {
    let Some(end) = end_of_frame(events) else { return std::mem::take(events) };
    let mut later = &events[end..];
    for _ in 0..MOST_WAITING {
        let Some(end) = end_of_frame(later) else {
            let later = events.split_off(end);
            return std::mem::replace(events, later);
        };
        later = &later[end..];
    }
    std::mem::take(events)
}

/// Returns the index of the first event to leave for a later frame; `None` where one frame may take them all. Splits
/// where pointer movement and a button or key in one frame would be confused: at a movement after a button event, or at
/// a release or key press after a movement.
fn end_of_frame(events: &[Event]) -> Option<usize> {
    let (mut has_button, mut has_moved) = (false, false);
    events.iter().position(|event| match event {
        Event::PointerMoved(_) => {
            has_moved = true;
            has_button
        }
        Event::PointerButton { pressed, .. } => {
            has_button = true;
            std::mem::take(&mut has_moved) && !pressed
        }
        Event::Key { pressed, repeat, .. } => has_moved && *pressed && !repeat,
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Context, Id, Key, Modifiers, PointerButton, Pos2, RawInput, Rect, Sense, pos2, vec2};

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
    }

    fn key(repeat: bool) -> Event {
        Event::Key { key: Key::Tab, physical_key: None, pressed: true, repeat, modifiers: Modifiers::NONE }
    }

    /// Returns how far a handle at 20,20 on a larger background was dragged, and how far the background, by all these
    /// at once.
    fn dragged(mut events: Vec<Event>) -> [egui::Vec2; 2] {
        let ctx = Context::default();
        let mut by = [egui::Vec2::ZERO; 2];
        let mut frame = |events: Vec<Event>| {
            let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(200.0, 200.0)));
            let input = RawInput { screen_rect, events, ..RawInput::default() };
            ctx.run_ui(input, |ui| {
                let rects = [Rect::from_center_size(pos2(20.0, 20.0), vec2(18.0, 18.0)), ui.max_rect()];
                for index in [1, 0] {
                    let response = ui.interact(rects[index], Id::unique(index), Sense::click_and_drag());
                    by[index] += response.drag_delta();
                }
            })
            .textures_delta
            .clear();
        };
        frame(vec![Event::PointerMoved(pos2(20.0, 20.0))]);
        while !events.is_empty() {
            frame(of_next_frame(&mut events));
        }
        by
    }

    #[test]
    fn a_drag_that_comes_at_once_moves_what_was_pressed() {
        let [handle, ground] = dragged(vec![
            button(pos2(20.0, 20.0), true),
            Event::PointerMoved(pos2(60.0, 70.0)),
            Event::PointerMoved(pos2(100.0, 120.0)),
            button(pos2(100.0, 120.0), false),
            Event::PointerMoved(pos2(180.0, 180.0)),
        ]);
        assert_eq!((handle, ground), (vec2(80.0, 100.0), vec2(0.0, 0.0)));
    }

    #[test]
    fn nothing_is_lost_and_what_belongs_together_stays() {
        let (here, there) = (pos2(1.0, 1.0), pos2(2.0, 2.0));
        let key = key(false);
        let moved = Event::PointerMoved;
        let all = vec![
            moved(here),
            moved(there),
            button(there, true),
            button(there, false),
            moved(here),
            moved(there),
            key.clone(),
            key.clone(),
            moved(here),
        ];
        let mut left = all.clone();
        let frames: Vec<Vec<Event>> =
            std::iter::from_fn(|| (!left.is_empty()).then(|| of_next_frame(&mut left))).collect();
        assert_eq!(frames.iter().map(Vec::len).collect::<Vec<_>>(), [4, 2, 3]);
        assert_eq!(frames.concat(), all);
    }

    /// Returns whether a widget got a click, and a right click, where these events come in frames at these seconds.
    fn pressed(frames: Vec<(f64, Vec<Event>)>) -> [bool; 2] {
        let ctx = Context::default();
        let mut clicks = [false; 2];
        for (time, mut waiting) in std::iter::once((0.0, vec![Event::PointerMoved(pos2(20.0, 20.0))])).chain(frames) {
            let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(200.0, 200.0)));
            let events = events_of_frame(&ctx, &mut waiting);
            let input = RawInput { screen_rect, time: Some(time), events, ..RawInput::default() };
            ctx.run_ui(input, |ui| {
                let response = ui.interact(ui.max_rect(), Id::unique("widget"), Sense::click_and_drag());
                clicks = [clicks[0] | response.clicked(), clicks[1] | response.secondary_clicked()];
            })
            .textures_delta
            .clear();
        }
        clicks
    }

    #[test]
    fn a_finger_that_rests_is_a_right_click_and_a_long_press_of_the_mouse_a_click() {
        let at = pos2(20.0, 20.0);
        let touch = |phase| Event::Touch {
            device_id: egui::TouchDeviceId(0),
            id: egui::TouchId(0),
            phase,
            pos: at,
            force: None,
        };
        let (down, up) = (touch(egui::TouchPhase::Start), touch(egui::TouchPhase::End));
        let mouse = |is_down| vec![button(at, is_down)];
        assert_eq!(pressed(vec![(1.0, mouse(true)), (1.7, vec![]), (2.4, mouse(false))]), [true, false]);
        // winit tells of the touch first, a browser of the button.
        let orders = |is_down| {
            let touch = if is_down { down.clone() } else { up.clone() };
            [vec![touch.clone(), button(at, is_down)], vec![button(at, is_down), touch]]
        };
        for (down, up) in orders(true).into_iter().zip(orders(false)) {
            let held = vec![(1.0, down.clone()), (1.7, vec![]), (2.4, up.clone())];
            assert_eq!(pressed(held), [false, true]);
            // A frame that takes long makes nothing else of a tap.
            assert_eq!(pressed(vec![(1.0, down), (1.9, up)]), [true, false]);
        }
    }

    #[test]
    fn a_key_held_while_the_pointer_moves_takes_no_frame_of_its_own() {
        let mut events: Vec<Event> = (0..40).flat_map(|_| [Event::PointerMoved(pos2(1.0, 1.0)), key(true)]).collect();
        assert_eq!(of_next_frame(&mut events).len(), 80);
    }

    #[test]
    fn a_window_that_falls_behind_catches_up() {
        let mut events: Vec<Event> = (0..40).flat_map(|_| [Event::PointerMoved(pos2(1.0, 1.0)), key(false)]).collect();
        assert_eq!((of_next_frame(&mut events).len(), events.len()), (80, 0));
        let mut few = vec![Event::PointerMoved(pos2(1.0, 1.0)), key(false)];
        assert_eq!((of_next_frame(&mut few).len(), few.len()), (1, 1));
    }
}
