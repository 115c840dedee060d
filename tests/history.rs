//! The history of a pixel: every event by name in scenes whose answers are known, agreement with
//! the GPU on many pixels of many frames, and what becomes of a history that was tampered with.

mod agreement;
mod closed_form;
mod near;

use crate::common::{cuboid, from_above, request_with};
use stencilscope::capture::Capture;
use stencilscope::plan::FramePlan;
use stencilscope::scene::Scene;
use stencilscope::session::Session;
use stencilscope::technique::Technique;

/// Ten pixels a unit of the floor from 10 above.
const SIZE: [u32; 2] = [200, 200];

fn frame(
    session: &mut Session,
    scene: &Scene,
    technique: Technique,
    settings: &[(&str, &str)],
    size: [u32; 2],
) -> (Capture, FramePlan) {
    session.capture_with_plan(scene, &request_with(technique, settings, size)).expect("a capture")
}

/// Three boxes in each other that are not drawn, above a floor that casts nothing: seen from above,
/// between eye and floor.
fn nested_boxes() -> Scene {
    let boxes = [("outer", 1.0, 1.0, 2.0), ("middle", 0.75, 1.1, 1.9), ("inner", 0.5, 1.2, 1.8)];
    let boxes = boxes.map(|(name, half, low, high)| {
        let mut object = cuboid(name, [-half, low, -half], [half, high, half]);
        object.visible = false;
        object
    });
    let mut scene = from_above(boxes.into());
    scene.objects[0].casts = false;
    scene
}
