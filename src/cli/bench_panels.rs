//! `stencilscope bench panels`: what the inspector's own frames cost, and how soon a change is seen.

use super::CliError;
use super::options::{FrameOptions, SceneOptions};
#[cfg(feature = "inspector")]
use super::output;

/// How many frames of each tab are timed.
#[cfg(feature = "inspector")]
const FRAMES: usize = 60;
/// How many positions of the light are tried.
#[cfg(feature = "inspector")]
const LIGHTS: usize = 15;
/// The window's size, points.
#[cfg(feature = "inspector")]
const WINDOW: [f32; 2] = [1280.0, 800.0];
/// The limit for a frame of the panels on two cores of a server, milliseconds.
#[cfg(feature = "inspector")]
const LIMIT_PANELS_MS: f64 = 8.0;
/// The limit for the time from moving a light until its capture is shown, milliseconds.
#[cfg(feature = "inspector")]
const LIMIT_LIGHT_MS: f64 = 150.0;

/// Returns an error, always: a build without a window has no panels to measure.
#[cfg(not(feature = "inspector"))]
pub fn run(_: &[String], _: &SceneOptions, _: &FrameOptions) -> Result<(), CliError> {
    Err(CliError::Window("this build has no panels to measure".to_owned()))
}

/// Runs the benchmark `panels`: draws the inspector without a window over each scene (`tori` where none is named) and
/// prints the times of its tabs, of dragging, stepping and a moved light, whether it idles, and how soon it answers a hand.
#[cfg(feature = "inspector")]
pub fn run(scenes: &[String], scene_options: &SceneOptions, frame: &FrameOptions) -> Result<(), CliError> {
    use crate::app::headless::Headless;
    let usual = ["tori".to_owned()];
    for name in if scenes.is_empty() { &usual[..] } else { scenes } {
        let request = super::view::window::scene_request(name, scene_options, frame)?;
        let [width, height] = request.capture.size;
        let mut panels = Headless::new(request, WINDOW, 1.0)?;
        panels.settle()?;
        output::print(&format!("{name}, {width}x{height}, panels at {}x{}\n", WINDOW[0], WINDOW[1]))?;
        output::print(&measured::tabs(&mut panels))?;
        output::print(&measured::orbit(&mut panels))?;
        output::print(&measured::idle(&mut panels))?;
        output::print(&measured::stepping(&mut panels))?;
        output::print(&measured::light(&mut panels)?)?;
        output::print(&super::bench_response::lines(&mut panels)?)?;
    }
    Ok(())
}

#[cfg(feature = "inspector")]
mod measured {
    use super::{FRAMES, LIGHTS, LIMIT_LIGHT_MS, LIMIT_PANELS_MS, WINDOW};
    use crate::app::AppError;
    use crate::app::headless::{FrameCost, Headless};
    use crate::inspector::PanelKind;
    use egui::{Event, Key, Modifiers, PointerButton, pos2};
    use std::time::{Duration, Instant};

    fn ms(duration: Duration) -> f64 {
        duration.as_secs_f64() * 1e3
    }

    fn median(mut times: Vec<f64>) -> f64 {
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
    }

    fn verdict(value: f64, limit: f64) -> String {
        format!("{:.2} of the limit {limit} ms", value / limit)
    }

    /// Times each tab in front while the pointer moves over the whole window, and returns a line of text for each.
    /// Picks a pixel first, so that tabs have something to show, and ends with the Picture tab.
    pub fn tabs(panels: &mut Headless) -> String {
        let middle = width_of(panels) / 2;
        panels.inspector().model.selection.pick = Some([middle, 200]);
        let mut text = String::new();
        for panel in PanelKind::ALL {
            panels.inspector().model.requests.panels.push(panel);
            for _ in 0..4 {
                panels.point([0.5, 0.5]);
            }
            let costs: Vec<FrameCost> = (0..FRAMES)
                .map(|frame| {
                    let share = frame as f32 / FRAMES as f32;
                    panels.point([share, 0.1 + 0.8 * ((share * 7.0) % 1.0)])
                })
                .collect();
            let all = |of: fn(&FrameCost) -> Duration| median(costs.iter().map(|cost| ms(of(cost))).collect());
            let total = all(FrameCost::total);
            let worst = costs.iter().map(|cost| ms(cost.total())).fold(0.0, f64::max);
            text += &format!(
                "  {:<14} frame_ms {total:.2} (panels {:.2}, triangles {:.2}, worst {worst:.2}): {}\n",
                panel.title().to_lowercase(),
                all(|cost| cost.panels),
                all(|cost| cost.triangles),
                verdict(total, LIMIT_PANELS_MS)
            );
        }
        panels.inspector().model.requests.panels.push(PanelKind::Picture);
        panels.inspector().model.requests.panels.push(PanelKind::Pixel);
        text
    }

    /// Times the Scene tab while its view is dragged, and returns a line of text with CPU times of a frame and the
    /// GPU's time of the view. An error becomes text too.
    pub fn orbit(panels: &mut Headless) -> String {
        panels.inspector().model.requests.panels.push(PanelKind::Scene);
        let middle = [0.55, 0.4];
        // The worker may have to analyse the geometry first.
        if let Err(error) = panels.settle() {
            return format!("  orbit: {error}\n");
        }
        panels.point(middle);
        let button = |pressed| Event::PointerButton {
            pos: pos2(middle[0] * WINDOW[0], middle[1] * WINDOW[1]),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        panels.frame(vec![button(true)]);
        let drag = |frame: usize| {
            let angle = frame as f32 / 10.0;
            [middle[0] + 0.1 * angle.sin(), middle[1] + 0.1 * angle.cos()]
        };
        for frame in 0..4 {
            panels.point(drag(frame));
        }
        let costs: Vec<FrameCost> = (4..4 + FRAMES).map(|frame| panels.point(drag(frame))).collect();
        let mut picture = |at| {
            panels.point(at);
            let start = Instant::now();
            panels.picture().map(|_| ms(start.elapsed()))
        };
        // The window is drawn twice, with the view rotated and as it was: the difference is the time of the view.
        let drawn = (0..10).map(|frame| Ok(picture(drag(frame))? - picture(drag(frame))?));
        let drawn: Result<Vec<f64>, AppError> = drawn.collect();
        let drawn = drawn.map_or_else(|error| error.to_string(), |times| format!("{:.2}", median(times)));
        panels.frame(vec![button(false)]);
        panels.inspector().model.requests.panels.push(PanelKind::Picture);
        let all = |of: fn(&FrameCost) -> Duration| median(costs.iter().map(|cost| ms(of(cost))).collect());
        let total = all(FrameCost::total);
        format!(
            "  orbit          frame_ms {total:.2} (panels {:.2}, triangles {:.2}) while the Scene tab is dragged: {}; drawn_ms \
             {drawn} on the GPU\n",
            all(|cost| cost.panels),
            all(|cost| cost.triangles),
            verdict(total, LIMIT_PANELS_MS)
        )
    }

    fn width_of(panels: &mut Headless) -> u32 {
        panels.inspector().model.frame.capture.as_ref().map_or(2, |capture| capture.size[0])
    }

    /// Lets the panels settle with the pointer still, and returns a line that says how many of the next frames ask for
    /// yet another frame; 0 is right.
    pub fn idle(panels: &mut Headless) -> String {
        panels.point([0.5, 0.02]);
        // Hints and focus need a second to settle.
        for _ in 0..90 {
            panels.frame(Vec::new());
        }
        let wishes = (0..FRAMES).filter(|_| panels.frame(Vec::new()).next.is_some()).count();
        format!("  idle: {wishes} of {FRAMES} frames wish for another one while nothing changes\n")
    }

    /// Presses right and left arrow in turn from the first step, and returns a line that says how often the very frame
    /// that took the key shows the new step, and its median time.
    pub fn stepping(panels: &mut Headless) -> String {
        let mut costs = Vec::new();
        let mut in_next = 0;
        panels.key(Modifiers::NONE, Key::Home);
        for round in 0..FRAMES {
            let before = panels.inspector().model.selection.step;
            let key = if round % 2 == 0 { Key::ArrowRight } else { Key::ArrowLeft };
            let cost = panels.key(Modifiers::NONE, key);
            in_next += usize::from(panels.inspector().model.selection.step != before);
            costs.push(ms(cost.total()));
        }
        format!(
            "  stepping: {in_next} of {FRAMES} steps are shown by the frame that took the key, frame_ms {:.2}\n",
            median(costs)
        )
    }

    /// Moves the first light back and forth, and returns a line with the median time until the new capture is shown;
    /// the first move is not counted. Stops early where the scene has no light.
    pub fn light(panels: &mut Headless) -> Result<String, AppError> {
        let mut times = Vec::new();
        for index in 0..=LIGHTS {
            let Some(mut draft) = panels.inspector().draft() else { break };
            let Some(light) = draft.lights.first_mut() else { break };
            light.position.x += if index % 2 == 0 { 0.05 } else { -0.05 };
            let start = Instant::now();
            let shown = panels.run_and_show(*draft)?;
            if index > 0 {
                times.push(ms(shown - start));
            }
        }
        let time = median(times);
        let [width, height] = WINDOW;
        Ok(format!(
            "  light moved: its capture is shown after {time:.0} ms in a window of {width}x{height}: {}\n",
            verdict(time, LIMIT_LIGHT_MS)
        ))
    }
}
