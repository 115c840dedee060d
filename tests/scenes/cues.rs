//! What shadows tell of height and shape: three equal rods over a floor and a hill, where each shadow lies and where it bends.

use crate::common::{judged, request, session};
use glam::DVec3;
use std::path::Path;
use stencilscope::capture::Capture;
use stencilscope::reading::pick_ray;
use stencilscope::scene::{OpenSpec, Scene, open};
use stencilscope::technique::Technique;
use stencilscope::truth::{LIT, SHADOW};

const SIZE: [u32; 2] = [640, 480];
/// How far a shadow is moved towards −X for a metre between rod and ground: the sun slants by 3 in 4.
const SLANT: f64 = 0.75;
/// Half of a shadow's width: of a square rod, seen along the sun.
const HALF: f64 = 0.08 * (1.0 + SLANT);
/// The hill's axis, z and y, and its radius.
const HILL: [f64; 3] = [-1.4, -0.7, 1.5];
const RODS: [(&str, f64, f64); 3] = [("low", -1.6, 1.1), ("middle", 0.6, 1.7), ("high", 2.8, 2.6)];

fn scene() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/cues.toml");
    open(&OpenSpec::new(file.to_string_lossy())).expect("a scene")
}

/// The height of the ground along a line across the rods.
fn ground(z: f64) -> f64 {
    let [axis, below, radius] = HILL;
    ((radius.powi(2) - (z - axis).powi(2)).max(0.0).sqrt() + below).max(0.0)
}

/// The label of a point of the ground, where the picture shows that point.
fn label(capture: &Capture, point: DVec3) -> Option<u8> {
    let [x, y] = pick_ray::texel_of(capture, point.extend(1.0))?;
    let at = [x, y].map(|side| side as u32);
    pick_ray::surface(capture, at).filter(|seen| seen.distance(point) < 0.04)?;
    capture.lights[0].shadow.as_ref()?.byte_at(at)
}

/// Where the middle of a rod's shadow lies tells how high the rod is above the ground there, and how high the ground is.
#[test]
fn where_a_shadow_lies_tells_the_height_of_its_rod_and_of_the_ground() {
    let mut session = session();
    let capture = judged(&mut session, &scene(), Technique::ZFail, SIZE);
    let error = capture.error().expect("an error");
    assert_eq!([error.false_shadow, error.missing_shadow], [0, 0], "{error:?}");
    let planar = session.capture(&scene(), &request(Technique::Planar, SIZE)).expect("a capture");
    let (mut flat, mut curved) = ([0; 3], [0; 3]);
    for (rod, (name, x, height)) in RODS.into_iter().enumerate() {
        for step in 0..50 {
            let z = -2.6 + 0.1 * f64::from(step);
            let up = ground(z);
            let at = |aside: f64| DVec3::new(x - SLANT * (height - up) + aside, up, z);
            let Some(middle) = label(&capture, at(0.0)) else { continue };
            assert_eq!(middle, SHADOW, "{name} at {z}");
            for beside in [-1.0, 1.0].map(|side| at(side * (HALF + 0.06))) {
                assert!(label(&capture, beside).is_none_or(|label| label == LIT), "{name} at {z}");
            }
            // Nothing flat is there to flatten the rods onto.
            let is_hill = up > 0.15;
            if up > 0.0 && !is_hill {
                // At the foot a pixel may show either.
                continue;
            }
            let by_planar = label(&planar, at(0.0)).expect("the same surface");
            assert_eq!(by_planar, if is_hill { LIT } else { SHADOW }, "{name} at {z}, by planar");
            (if is_hill { &mut curved } else { &mut flat })[rod] += 1;
        }
    }
    assert!(flat.iter().chain(&curved).all(|count| *count > 5), "{flat:?} on the floor, {curved:?} on the hill");
}
