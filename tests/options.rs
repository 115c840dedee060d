//! Every option is a lesson: the right setting beside the famous wrong one, each counted on scenes whose answers are
//! known in closed form.

mod counts;
mod depth;
mod exact;
mod maps;
mod planar;
mod shading;
mod textures;

use crate::common::shade::linear;
use crate::common::{adapter, from_above, judged_by, last_frame, request_with, square};
use glam::DVec3;
use stencilscope::capture::Capture;
use stencilscope::scene::{Object, Scene};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::Technique;

/// The eye 10 above the floor sees 20 × 20 units: ten pixels a unit.
const SIZE: [u32; 2] = [200, 200];

fn request(technique: Technique, settings: &[(&str, &str)]) -> CaptureRequest {
    request_with(technique, settings, SIZE)
}

fn capture(session: &mut Session, scene: &Scene, technique: Technique, settings: &[(&str, &str)]) -> Capture {
    session.capture(scene, &request(technique, settings)).expect("a capture")
}

/// Wrong pixels: false shadow and missing shadow.
fn wrong(session: &mut Session, scene: &Scene, technique: Technique, settings: &[(&str, &str)]) -> [u64; 2] {
    let capture = judged_by(session, scene, &request(technique, settings));
    let error = capture.error().expect("an error");
    let most_surfaces = if adapter::draws_as_given() { 0 } else { 4 };
    assert!(error.compared > 500 && error.wrong_surface <= most_surfaces, "{error:?}");
    [error.false_shadow, error.missing_shadow]
}

/// Pixels of light 0 with the label "in shadow".
fn shadow_pixels(capture: &Capture) -> u64 {
    crate::common::label_counts(capture)[1]
}

/// Moved, and casting without being drawn, so that its whole shadow shows.
fn unseen(object: Object, [x, y, z]: [f64; 3]) -> Object {
    let mut object = object;
    object.pose.translate = DVec3::new(x, y, z);
    object.visible = false;
    object
}

/// From above, with a floor of this half-width.
fn over_floor(half: f64, objects: Vec<Object>) -> Scene {
    let mut scene = from_above(objects);
    scene.objects[0] = square("floor", 0.0, half);
    scene
}

/// Linear brightness of the red channel of the final picture, pixel by pixel.
fn brightness(capture: &Capture) -> Vec<f64> {
    let rows = last_frame(capture).color.image.rows();
    rows.flat_map(|row| row.chunks_exact(4).map(|texel| linear(texel[0])).collect::<Vec<_>>()).collect()
}

/// How many pixels are as bright as that, within one step of an eight-bit picture.
fn as_bright_as(brightness: &[f64], value: f64) -> usize {
    brightness.iter().filter(|found| (**found - value).abs() < 0.006).count()
}
