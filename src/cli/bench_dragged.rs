//! `stencilscope bench dragged`: how soon a picture follows a light that is dragged over a large mesh.

use super::options::{FrameOptions, open_session};
use super::{CliError, output};
use crate::scene::Scene;
use crate::session::{CaptureRequest, Session, median_ms};
use crate::technique::{Choice, Technique};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// How many pixels of the whole picture one of a preview stands for, along each side, where a frame takes a window over a
/// second, as that of a large mesh does on a software driver.
const PREVIEW_PIXELS: u32 = 4;
/// How many places of the light are timed.
const PLACES: u32 = 9;
/// From a move to its picture, milliseconds.
const GOAL_MS: f64 = 300.0;

/// Runs the benchmark `dragged`: moves the first light of each scene a little, again and again, renders the preview that a
/// window shows meanwhile, and prints the median time by technique, with what its set-up and its passes take. Scenes
/// without a light are left out.
pub fn run(scenes: &[Scene], frame: &FrameOptions) -> Result<(), CliError> {
    let size = frame.picture_size().map(|side| side.div_ceil(PREVIEW_PIXELS));
    for scene in scenes.iter().filter(|scene| !scene.lights.is_empty()) {
        let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles().len()).sum();
        output::print(&format!("{}, {triangles} triangles, {}x{}\n", scene.name, size[0], size[1]))?;
        for technique in [Technique::Auto, Technique::ZFail, Technique::ShadowMap] {
            let mut session = open_session(frame.adapter.as_deref())?;
            output::print(&line(&mut session, scene, &CaptureRequest::new(Choice::new(technique), size))?)?;
        }
    }
    Ok(())
}

fn line(session: &mut Session, scene: &Scene, request: &CaptureRequest) -> Result<String, CliError> {
    // As in the window, where the mesh is known before a light is dragged.
    session.preview(scene.clone(), request.clone())?;
    let (mut times, mut setups, mut passes) = (Vec::new(), Vec::new(), BTreeMap::<String, Vec<Duration>>::new());
    for place in 1..=PLACES {
        let moved = with_light_moved(scene, f64::from(place));
        let start = Instant::now();
        let frame = session.preview(moved, request.clone())?;
        times.push(start.elapsed());
        setups.extend(frame.capture.timing.setup_ms.map(from_ms));
        for step in &frame.capture.steps {
            if let Some(ms) = step.gpu_ms {
                passes.entry(step.name.clone()).or_default().push(from_ms(ms));
            }
        }
    }
    let ms = |times: &[Duration]| median_ms(times).unwrap_or(f64::NAN);
    let each = passes.iter().map(|(name, times)| format!(", {name} {:.0}", ms(times)));
    Ok(format!(
        "  {}: dragged_ms {:.0}, {:.2} of the limit {GOAL_MS} ms; set-up {:.0}{}\n",
        request.choice.technique().name(),
        ms(&times),
        ms(&times) / GOAL_MS,
        ms(&setups),
        each.collect::<String>(),
    ))
}

fn from_ms(ms: f64) -> Duration {
    Duration::from_secs_f64(ms.max(0.0) / 1e3)
}

/// Returns the scene with its first light moved along x by hundredths of the eye's distance from what it looks at, a
/// directional one by hundredths of its own length.
fn with_light_moved(scene: &Scene, hundredths: f64) -> Scene {
    let mut moved = scene.clone();
    let position = &mut moved.lights[0].position;
    let reach = if position.w == 0.0 { position.length() } else { scene.camera.eye.distance(scene.camera.target) };
    position.x += reach * hundredths * 0.01;
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use std::collections::BTreeSet;

    #[test]
    fn a_lamp_and_a_sun_are_moved_a_little_each_time() {
        let kinds = builtin::ALL.iter().map(|of| of.scene().expect("a scene").lights[0].position.w == 0.0);
        assert_eq!(kinds.collect::<BTreeSet<bool>>().len(), 2, "there are lamps and suns");
        for scene in builtin::ALL.iter().map(|of| of.scene().expect("a scene")) {
            let first = scene.lights[0].position;
            let eye = scene.camera.eye.distance(scene.camera.target);
            let reach = if first.w == 0.0 { first.length() } else { eye };
            for place in 1..=PLACES {
                let moved = with_light_moved(&scene, f64::from(place)).lights[0].position;
                assert_eq!(moved.w, first.w, "{}", scene.name);
                let by = (moved - first).length() / reach;
                assert!((by - 0.01 * f64::from(place)).abs() < 1e-9, "{}: {by}", scene.name);
            }
        }
    }
}
