//! The history of a pixel: every event by name in scenes whose answers are known, agreement with
//! the GPU on many pixels of many frames, and what becomes of a history that was tampered with.

use crate::common::random::Random;
use crate::common::session;
use stencilscope::capture::Capture;
use stencilscope::history::{Disagreement, PixelHistory};
use stencilscope::plan::FramePlan;
use stencilscope::scene::{OpenSpec, Scene, open};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};

const SIZE: [u32; 2] = [320, 240];

fn frame(
    session: &mut Session,
    scene: &Scene,
    technique: Technique,
    settings: &[(&str, &str)],
) -> (Capture, FramePlan) {
    let mut choice = Choice::new(technique);
    settings.iter().for_each(|(key, value)| choice.set(key, value).expect("a setting"));
    session.capture_with_plan(scene, &CaptureRequest::new(choice, SIZE)).expect("a capture")
}

/// Events of shadow volumes that changed the count.
fn volume_events(history: &PixelHistory) -> usize {
    history.events.iter().filter(|event| event.is_of_volume()).count()
}

/// Histories of random pixels, every one of which must agree with the GPU; how many have two or
/// more events of volumes or flattened casters.
fn agreeing(
    session: &mut Session,
    scene: &Scene,
    technique: Technique,
    settings: &[(&str, &str)],
    pixels: usize,
) -> usize {
    let (capture, plan) = frame(session, scene, technique, settings);
    let mut random = Random::new(7);
    let mut with_volumes = 0;
    for _ in 0..pixels {
        let at = [0, 1].map(|axis| (random.unit() * f64::from(SIZE[axis])) as u32);
        let history = session.history(&plan, &capture, at).expect("a history");
        let disagreements = history.disagreements();
        assert!(
            disagreements.is_empty(),
            "{} {technique:?} {settings:?}: {disagreements:?}\n{}",
            scene.name,
            history.story(&capture.depth)
        );
        with_volumes += usize::from(volume_events(&history) >= 2);
    }
    with_volumes
}

fn builtin(name: &str) -> Scene {
    open(&OpenSpec::new(name)).expect("a built-in scene")
}

#[test]
fn every_pixel_agrees_with_the_gpu() {
    let mut session = session();
    for name in ["tori", "inside", "gate"] {
        let scene = builtin(name);
        for technique in [Technique::ZPass, Technique::ZFail, Technique::ZPassPlus, Technique::Planar] {
            let with_volumes = agreeing(&mut session, &scene, technique, &[], 200);
            println!("{name} {technique:?}: {with_volumes}");
            assert!(technique == Technique::Planar || with_volumes >= 50, "{name} {technique:?}: {with_volumes}");
        }
    }
}
