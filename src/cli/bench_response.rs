//! How soon the window answers a hand, as `stencilscope bench panels` measures it: a key, a still picture that is moved, a
//! dragged light. Each picture is drawn by the GPU as a window is, without a display; on a software driver the CPU draws it.

use crate::app::AppError;
use crate::app::headless::Headless;
use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, TouchPhase, pos2, vec2};
use std::time::{Duration, Instant};

/// How many pictures of a key or of a moved picture are timed.
const PICTURES: usize = 40;
/// How long the light is dragged.
const DRAG: Duration = Duration::from_secs(4);
/// How long the whole frame may take after a drag before it is given up.
const LONGEST_REST: Duration = Duration::from_secs(20);
/// A key's picture, milliseconds.
const GOAL_KEY_MS: f64 = 100.0;
/// Pictures a second while a still picture is moved or zoomed.
const GOAL_MOVED: f64 = 20.0;
/// Pictures a second while a light is dragged.
const GOAL_DRAGGED: f64 = 10.0;
/// From a drag's end to the whole frame, milliseconds.
const GOAL_REST_MS: f64 = 300.0;

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Runs one frame with these events and draws it; returns how long both took, milliseconds.
fn drawn(panels: &mut Headless, events: Vec<Event>) -> Result<f64, AppError> {
    let start = Instant::now();
    panels.frame(events);
    panels.paint()?;
    Ok(ms(start.elapsed()))
}

/// Returns lines with the times of all three, and how they compare with their goals.
pub fn lines(panels: &mut Headless) -> Result<String, AppError> {
    Ok(key(panels)? + &moved(panels)? + &zoomed(panels)? + &dragged(panels)?)
}

/// Presses right and left arrow in turn, which show another step each.
fn key(panels: &mut Headless) -> Result<String, AppError> {
    panels.key(Modifiers::NONE, Key::Home);
    let mut times = Vec::new();
    for round in 0..PICTURES {
        let key = if round % 2 == 0 { Key::ArrowRight } else { Key::ArrowLeft };
        let event =
            |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE };
        times.push(drawn(panels, vec![event(true)])?);
        panels.frame(vec![event(false)]);
    }
    let time = median(times);
    Ok(format!(
        "  key: its picture is there after {time:.0} ms: {:.2} of the limit {GOAL_KEY_MS} ms\n",
        time / GOAL_KEY_MS
    ))
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

fn rate(name: &str, times: Vec<f64>) -> String {
    let rate = 1e3 / median(times);
    format!("  {name}: {rate:.0} pictures a second: {:.2} times the goal of {GOAL_MOVED}\n", rate / GOAL_MOVED)
}

/// Drags the picture by its middle.
fn moved(panels: &mut Headless) -> Result<String, AppError> {
    let from = panels.place([0.5, 0.35]);
    panels.frame(vec![Event::PointerMoved(from)]);
    panels.frame(vec![button(from, true)]);
    let mut at = from;
    let mut times = Vec::new();
    for _ in 0..PICTURES {
        at += vec2(2.0, 1.0);
        times.push(drawn(panels, vec![Event::PointerMoved(at)])?);
    }
    panels.frame(vec![button(at, false)]);
    Ok(rate("moving a still picture", times))
}

/// Turns the wheel over the picture, in and out again.
fn zoomed(panels: &mut Headless) -> Result<String, AppError> {
    let at = panels.place([0.5, 0.35]);
    panels.frame(vec![Event::PointerMoved(at)]);
    let mut times = Vec::new();
    for round in 0..PICTURES {
        let by = if round < PICTURES / 2 { 20.0 } else { -20.0 };
        let wheel = Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: vec2(0.0, by),
            phase: TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        };
        times.push(drawn(panels, vec![wheel])?);
    }
    panels.inspector().model.view.zoom = crate::reading::picture_view::TexelZoom::Fit;
    Ok(rate("zooming a still picture", times))
}

/// Moves the first light to and fro while a mouse button is down, as fast as the window is drawn, and lets go. Nothing
/// where the scene has no light.
fn dragged(panels: &mut Headless) -> Result<String, AppError> {
    panels.settle()?;
    let Some(first) = panels.inspector().draft().filter(|draft| !draft.lights.is_empty()) else {
        return Ok(String::new());
    };
    // On the status bar, which nothing drags.
    let mut at = panels.place([0.4, 0.99]);
    panels.frame(vec![Event::PointerMoved(at)]);
    panels.frame(vec![button(at, true)]);
    let (start, mut number, mut pictures) = (Instant::now(), panels.inspector().model.frame.number, 0);
    let mut light = first.lights[0].position;
    while start.elapsed() < DRAG {
        let mut draft = (*first).clone();
        light.x = first.lights[0].position.x + 0.3 * (start.elapsed().as_secs_f64() * 3.0).sin();
        draft.lights[0].position = light;
        let actions = panels.inspector().rerun(draft);
        panels.act(actions);
        at = pos2(at.x + 0.1, at.y);
        drawn(panels, vec![Event::PointerMoved(at)])?;
        let now = panels.inspector().model.frame.number;
        pictures += usize::from(std::mem::replace(&mut number, now) != now);
    }
    let rate = pictures as f64 / start.elapsed().as_secs_f64();
    let release = Instant::now();
    drawn(panels, vec![button(at, false)])?;
    let is_whole = |panels: &mut Headless| {
        let frame = &panels.inspector().model.frame;
        let of_light = frame.capture.as_ref().and_then(|capture| capture.lights.first().map(|light| light.position));
        !frame.is_preview && of_light == Some(light)
    };
    while !is_whole(panels) {
        if release.elapsed() > LONGEST_REST {
            return Err(AppError::Silent);
        }
        drawn(panels, Vec::new())?;
        std::thread::sleep(Duration::from_millis(2));
    }
    let rest = ms(release.elapsed());
    Ok(format!(
        "  dragging a light: {rate:.1} pictures a second: {:.2} times the goal of {GOAL_DRAGGED}; whole {rest:.0} ms after it rests: \
         {:.2} of the limit {GOAL_REST_MS} ms\n",
        rate / GOAL_DRAGGED,
        rest / GOAL_REST_MS
    ))
}
