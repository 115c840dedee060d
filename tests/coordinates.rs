//! A pixel's point in every space: the chain leads back to the pixel, and the depth is the one that was stored.

use crate::common::{request, session};
use glam::{DMat4, DVec4};
use stencilscope::math::depth::DepthMapping;
use stencilscope::reading::coordinates::{Place, Step};
use stencilscope::scene::builtin::Builtin;
use stencilscope::technique::Technique;

fn matrix(rows: [[f64; 4]; 4]) -> DMat4 {
    DMat4::from_cols_array_2d(&rows).transpose()
}

#[test]
fn the_chain_leads_from_the_world_to_the_pixel_and_back() {
    let mut session = session();
    let mut points = 0;
    for (name, mapping) in [("tori", 0), ("table", 1), ("steps", 2), ("inside", 3)] {
        let scene = Builtin::named(name).expect(name).scene().expect("a scene");
        let mapping = DepthMapping::ALL[mapping];
        let mut frame = request(Technique::None, [200, 150]);
        frame.choice.set("depth", mapping.name()).expect("a setting");
        let capture = session.capture(&scene, &frame).expect("a capture");
        let [width, height] = capture.size;
        for pixel in [[0, 0], [width / 2, height / 2], [width / 3, height - 1], [width - 1, height / 4]] {
            let place = Place::of(&capture, pixel);
            for Step { name, matrix: rows, inverse } in &place.chain {
                let product = matrix(*rows) * matrix(*inverse);
                assert!(product.abs_diff_eq(DMat4::IDENTITY, 1e-9), "{name}: {product}");
            }
            let Some(point) = place.point else { continue };
            points += 1;
            let middle = pixel.map(|at| f64::from(at) + 0.5);
            let [x, y, depth] = point.window;
            assert!((x - middle[0]).abs() < 1e-6 && (y - middle[1]).abs() < 1e-6, "{name}, {pixel:?}: {x}, {y}");
            let stored = capture.frame_at(capture.steps.len() - 1).and_then(|frame| frame.depth.image.depth_at(pixel));
            assert!((depth - f64::from(stored.expect("a depth"))).abs() < 1e-6, "{name}, {pixel:?}");
            // Back through all three inverses.
            let [eye, clip, window] = [0, 1, 2].map(|step| matrix(place.chain[step].inverse));
            let ndc = window * DVec4::new(x, y, depth, 1.0);
            let world = eye * clip * (ndc * point.clip[3]);
            let error = (world.truncate() / world.w - glam::DVec3::from_array(point.world)).length();
            assert!(error < 1e-6, "{name}, {pixel:?}: {error} m");
            let steps: Vec<f64> = place.depth_steps.iter().filter_map(|step| step.metres).collect();
            assert!(steps.windows(2).take(2).all(|pair| pair[0] > pair[1]), "more bits, finer steps: {steps:?}");
        }
    }
    assert!(points >= 10, "{points}");
}

/// At 2 metres before a near plane of 0.1, reversed: depth is 0.05, and a step of it `z² / near` times as many metres.
#[test]
fn steps_of_depth_are_those_of_the_formula() {
    let mut scene = crate::common::from_above(Vec::new());
    scene.camera.near = 0.1;
    let mut session = session();
    let capture = session.capture(&scene, &request(Technique::None, [200, 200])).expect("a capture");
    let place = Place::of(&capture, [100, 100]);
    let distance = -place.point.expect("the floor").eye[2];
    for (step, bits) in place.depth_steps.iter().zip([8, 16, 24]) {
        let expected = distance * distance / 0.1 / f64::from((1_u32 << bits) - 1);
        let share = step.metres.map(|metres| metres / expected);
        // The next step of eight bits is far away, where steps are larger.
        let within = if bits == 8 { 0.3..6.0 } else { 0.9..1.2 };
        assert!(share.is_none_or(|share| within.contains(&share)), "{bits} bits: {share:?}");
        assert!(share.is_some() || bits == 8, "{bits} bits");
    }
}
