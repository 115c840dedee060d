//! The light by what it is, as pictures: the four together are the whole, and each pixel has what Pixel says of it.

use crate::commands::{done, folder};
use crate::common::{opened, pixels, request, session};
use stencilscope::capture::Capture;
use stencilscope::plan::LightChannel;
use stencilscope::reading::shading::SurfaceShading;
use stencilscope::scene::Scene;
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [96, 72];
/// Half a step of eight bits near white, in linear light: what one rounding may change.
const ROUNDING: f64 = 0.0045;

/// A scene with something of every channel.
fn scene(name: &str) -> Scene {
    let mut scene = opened(name);
    for object in &mut scene.objects {
        object.material.emission = [0.1, 0.0, 0.05];
        object.material.specular = 0.3;
    }
    scene
}

/// The linear RGB of a pixel at the end of a frame.
fn linear(capture: &Capture, at: [u32; 2]) -> [f64; 3] {
    let frame = capture.frame_at(capture.steps.len() - 1).expect("a frame");
    let [r, g, b, _] = frame.color.image.rgba_at(at).expect("inside");
    [r, g, b].map(|byte| {
        let share = f64::from(byte) / 255.0;
        if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
    })
}

#[test]
fn the_channels_add_up_to_the_picture_under_every_technique() {
    let mut session = session();
    for (name, technique) in [
        ("tori", Technique::ZFail),
        ("tori", Technique::ShadowMap),
        ("tori", Technique::RayTraced),
        ("two-lights", Technique::Auto),
        ("rings", Technique::Planar),
        ("panels", Technique::PlanarTexture),
        ("glass", Technique::Projective),
    ] {
        let frame = session.render(scene(name), request(technique, SIZE)).expect("a frame");
        let parts = LightChannel::ALL.map(|channel| session.capture_channel(&frame, channel).expect("a channel"));
        // The ambient pass, and each light's, rounds the whole and each part.
        let roundings = 1 + frame.plan.lights.len();
        let (mut sum_of_errors, mut compared) = (0.0, 0);
        for at in pixels(SIZE) {
            let (whole, parts) = (linear(&frame.capture, at), parts.each_ref().map(|part| linear(part, at)));
            for color in (0..3).filter(|color| whole[*color] < 0.97) {
                let error = (parts.iter().map(|part| part[color]).sum::<f64>() - whole[color]).abs();
                assert!(error <= ROUNDING * (3 * roundings) as f64, "{name}, {}: {at:?}, {error}", technique.name());
                sum_of_errors += error;
                compared += 1;
            }
        }
        let mean = sum_of_errors / f64::from(compared);
        // Rounding may lean to one side, each time that a pass adds to a picture.
        assert!(
            mean < ROUNDING * roundings as f64 && compared > 5000,
            "{name}, {}: {mean} of {compared}",
            technique.name()
        );
        for (channel, part) in LightChannel::ALL.iter().zip(&parts) {
            let is_seen = pixels(SIZE).any(|at| linear(part, at).iter().any(|value| *value > 0.02));
            assert!(is_seen, "{name}, {}: nothing {}", technique.name(), channel.name());
        }
    }
}

#[test]
fn a_channel_s_picture_has_what_is_said_of_the_pixel() {
    let mut session = session();
    let frame = session.render(scene("tori"), request(Technique::ZFail, SIZE)).expect("a frame");
    let parts = LightChannel::ALL.map(|channel| session.capture_channel(&frame, channel).expect("a channel"));
    let mut compared = 0;
    for at in pixels(SIZE).step_by(97) {
        let history = session.history(&frame.plan, &frame.capture, at).expect("a history");
        let Some(shaded) = SurfaceShading::of(&frame.capture, &frame.plan, &history) else { continue };
        let Some(channels) = shaded.channels else { continue };
        let said = [channels.ambient, channels.emissive, channels.diffuse, channels.specular];
        for ((channel, said), part) in LightChannel::ALL.iter().zip(said).zip(&parts) {
            let seen = linear(part, at);
            for color in 0..3 {
                let error = (seen[color] - said[color].min(1.0)).abs();
                assert!(error < 2.0 * ROUNDING, "{at:?}, {}: {} is not {}", channel.name(), seen[color], said[color]);
            }
        }
        compared += 1;
    }
    assert!(compared > 30, "{compared}");
}

#[test]
fn the_command_writes_a_picture_of_each_channel_and_may_do_so_again() {
    let work = folder();
    for more in [&[][..], &["--overwrite"]] {
        done(work.path(), &[&["capture", "tori", "-o", "c", "--size", "64x48", "--channels"], more].concat());
        for channel in LightChannel::ALL {
            let png = std::fs::read(work.path().join(format!("c/channel-{}.png", channel.name()))).expect("a picture");
            assert!(png.starts_with(b"\x89PNG"), "{}", channel.name());
        }
    }
}
