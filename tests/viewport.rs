//! A viewport: the part of the picture that a frame is drawn into. Within it all is as in a picture of its own; outside of it
//! nothing is drawn, traced or counted.

use crate::commands::{assert_fails, folder, run, text};
use crate::common::adapter::assert_right;
use crate::common::{judged_by, last_frame, opened, pixels, request_with, session, wrong};
use glam::{DMat4, DVec3};
use stencilscope::capture::{Capture, FrameSnapshot};
use stencilscope::progress::Progress;
use stencilscope::reading::coordinates::PixelCoordinates;
use stencilscope::reading::pick_ray;
use stencilscope::scene::{Camera, Light, Projection, Scene};
use stencilscope::session::InjectedFault;
use stencilscope::technique::Technique;
use stencilscope::truth::BACKGROUND;

const SIZE: [u32; 2] = [101, 67];
/// Shares whose edges are no whole pixels: they go to the nearest.
const SHARES: [f64; 4] = [0.213, 0.118, 0.55, 0.703];

fn part(of: &Scene) -> Scene {
    Scene { camera: Camera { viewport: Some(SHARES), ..of.camera }, ..of.clone() }
}

fn area() -> [u32; 4] {
    let area = Camera { viewport: Some(SHARES), ..opened("tori").camera }.viewport_in(SIZE);
    assert_eq!(area, [22, 8, 55, 47], "0.213 · 101 = 21.5, 0.763 · 101 = 77.1; 0.118 · 67 = 7.9, 0.821 · 67 = 55.0");
    area
}

fn is_within([x, y]: [u32; 2]) -> bool {
    let [left, top, columns, rows] = area();
    (left..left + columns).contains(&x) && (top..top + rows).contains(&y)
}

fn judged(scene: &Scene, technique: Technique, settings: &[(&str, &str)], size: [u32; 2]) -> Capture {
    judged_by(&mut session(), scene, &request_with(technique, settings, size))
}

fn labels_at(capture: &Capture, [x, y]: [u32; 2]) -> Vec<u8> {
    let at = y as usize * capture.size[0] as usize + x as usize;
    crate::common::labels(capture).iter().map(|labels| labels[at]).collect()
}

/// With two lights, one of limited range so that its passes have a scissor, and with the eye in a shadow.
#[test]
fn a_part_is_as_a_picture_of_its_own_and_nothing_is_drawn_outside() {
    let [left, top, columns, rows] = area();
    for technique in Technique::ALL {
        for name in ["two-lights", "inside"] {
            let mut scene = opened(name);
            if name == "two-lights" {
                let light: &mut Light = &mut scene.lights[0];
                light.range = Some(light.position.truncate().length());
            }
            let what = format!("{technique:?} {name}");
            let whole = judged(&part(&scene), technique, &[], SIZE);
            let alone = judged(&scene, technique, &[], [columns, rows]);
            let clear = whole.depth.mapping.clear_depth();
            let [last, own] = [&whole, &alone].map(last_frame);
            let stencil_at = |frame: &FrameSnapshot, at: [u32; 2]| {
                frame.stencil.as_ref().map(|stencil| stencil.image.byte_at(at).expect("a stencil value"))
            };
            let (mut moved, mut seen) = (0, 0);
            for at in pixels(SIZE) {
                let depth = last.depth.image.depth_at(at).expect("a depth");
                if !is_within(at) {
                    assert_eq!(depth, clear, "{what} at {at:?}");
                    assert!(labels_at(&whole, at).iter().all(|label| *label == BACKGROUND), "{what} at {at:?}");
                    assert_eq!(stencil_at(last, at), stencil_at(last, [0, 0]), "{what} at {at:?}");
                    continue;
                }
                let inner = [at[0] - left, at[1] - top];
                let of_depth = own.depth.image.depth_at(inner).expect("a depth");
                let is_same = labels_at(&whole, at) == labels_at(&alone, inner)
                    && stencil_at(last, at) == stencil_at(own, inner)
                    && (depth - of_depth).abs() <= 1e-5 * of_depth.abs();
                moved += u32::from(!is_same);
                seen += u32::from(depth != clear);
            }
            // Edges are at other fractions of a pixel by rounding alone.
            assert!(moved <= 6, "{what}: {moved} pixels are others");
            assert!(seen > columns * rows / 2, "{what}: {seen}");
            assert!(wrong(&whole).abs_diff(wrong(&alone)) <= 6, "{what}: {} and {}", wrong(&whole), wrong(&alone));
            if matches!(technique, Technique::Auto | Technique::RayTraced) {
                assert_eq!(wrong(&whole), 0, "{what}");
            }
        }
    }
}

/// Parallel cameras too, whose part is off the view's axis, and a frustum that is off it already.
#[test]
fn every_projection_has_no_wrong_pixel_in_a_part() {
    let mut session = session();
    for name in ["tori", "inside", "gate"] {
        let scene = opened(name);
        let half_height = scene.camera.half_height_at_target();
        let Projection::Frustum { left, right, bottom, top } = scene.camera.to_frustum(1.2) else {
            panic!("a frustum")
        };
        for projection in [
            Projection::Perspective,
            Projection::Frustum { left: left * 0.3, right: right * 1.4, bottom, top: top * 0.7 },
            Projection::Orthographic { half_height },
            Projection::Oblique { half_height, angle_degrees: 40.0, factor: 0.5 },
        ] {
            let scene = part(&Scene { camera: Camera { projection, ..scene.camera }, ..scene.clone() });
            for (technique, settings) in [(Technique::ZFail, &[("counter", "float")][..]), (Technique::Auto, &[])] {
                let request = request_with(technique, settings, SIZE);
                let capture = judged_by(&mut session, &scene, &request);
                assert_right(&mut session, &scene, &request, &capture, &format_args!("{technique:?} {projection}"));
            }
        }
    }
}

/// What is replayed by the numbers is what the GPU stored, and outside of the part no face is met.
#[test]
fn histories_agree_with_the_gpu_in_a_part() {
    let mut session = session();
    for (name, technique, settings) in [
        ("tori", Technique::ZFail, &[("depth-range", "0.1,0.6")][..]),
        ("tori", Technique::Planar, &[]),
        ("inside", Technique::ZPassPlus, &[("depth", "standard-finite-clamp")]),
        ("gate", Technique::ZPass, &[("depth-bits", "16"), ("depth", "standard-finite")]),
        ("two-lights", Technique::Auto, &[]),
        // Depths are floored below the range's end, and the GPU clamps them to it.
        ("tori", Technique::ZFail, &[("depth-bits", "16"), ("depth-range", "0.1,0.6")]),
        (
            "inside",
            Technique::ZFail,
            &[("depth-bits", "16"), ("depth-range", "0.3,0.9"), ("depth", "standard-infinite")],
        ),
        ("tori", Technique::ShadowMap, &[]),
    ] {
        let (capture, plan) = session
            .capture_with_plan(&part(&opened(name)), &request_with(technique, settings, SIZE))
            .expect("a capture");
        for pixel in pixels(SIZE).step_by(83) {
            let history = session.history(&plan, &capture, pixel).expect("a history");
            assert!(history.agrees(), "{name} {technique:?} {pixel:?}: {:?}", history.disagreements());
            let meets = history.events.iter().any(|event| event.triangle().is_some());
            assert!(is_within(pixel) || !meets, "{name} {technique:?} {pixel:?}");
        }
    }
}

/// The matrices that are shown are those that are used: a point goes through them to the middle of its pixel, also in
/// OpenGL's convention, and the ray through that pixel meets it.
#[test]
fn points_go_through_the_viewport_to_their_pixel_and_back() {
    let mut session = session();
    let half_height = opened("tori").camera.half_height_at_target();
    for projection in [Projection::Perspective, Projection::Orthographic { half_height }] {
        let scene = opened("tori");
        let scene = part(&Scene { camera: Camera { projection, ..scene.camera }, ..scene });
        let capture = session.capture(&scene, &request_with(Technique::None, &[], SIZE)).expect("a capture");
        let mut points = 0;
        for pixel in pixels(SIZE).step_by(61) {
            let place = PixelCoordinates::of(&capture, pixel);
            assert!(place.point.is_none() || is_within(pixel), "{pixel:?}");
            let Some(point) = place.point else { continue };
            points += 1;
            let [x, y, depth] = point.window;
            let middle = pixel.map(|at| f64::from(at) + 0.5);
            assert!((x - middle[0]).abs() < 1e-6 && (y - middle[1]).abs() < 1e-6, "{pixel:?}: {point:?}");
            let stored = last_frame(&capture).depth.image.depth_at(pixel).expect("a depth");
            assert!((depth - f64::from(stored)).abs() < 1e-6, "{pixel:?}: {point:?}");
            let within = |ndc: f64| (-1.0..=1.0).contains(&ndc);
            assert!(within(point.ndc[0]) && within(point.ndc[1]), "{point:?}");
            let matrix = |rows: [[f64; 4]; 4]| DMat4::from_cols_array_2d(&rows).transpose();
            let clip = matrix(place.opengl[0].matrix) * DVec3::from_array(point.eye).extend(1.0);
            let window = matrix(place.opengl[1].matrix) * (clip / clip.w);
            let height = f64::from(SIZE[1]);
            assert!((window.truncate() - DVec3::new(x, height - y, depth)).length() < 1e-6, "{window}");
            let seen = pick_ray::surface(&capture, pixel).expect("a surface");
            let back = pick_ray::texel_of(&capture, seen.extend(1.0)).expect("in front");
            assert!((back[0] - middle[0]).abs() < 1e-6 && (back[1] - middle[1]).abs() < 1e-6, "{back:?}");
        }
        assert!(points > 15, "{points}");
    }
}

/// Why z-pass is wrong where the eye is in a shadow is found and proven in a part, too.
#[test]
fn a_diagnosis_explains_and_proves_in_a_part() {
    let scene = part(&opened("inside"));
    let request = request_with(Technique::ZPass, &[], SIZE);
    let found = session().diagnose(&scene, &request, InjectedFault::None, &Progress::default()).expect("a diagnosis");
    let page = found.to_text(&[]);
    assert!(page.contains("eye-in-volume") && page.contains("proven"), "{page}");
    assert!(found.regions.iter().all(|region| is_within([region.bounds[0], region.bounds[1]])), "{page}");
}

#[test]
fn the_command_line_takes_it_and_refuses_what_is_outside() {
    let work = folder();
    let out = work.path().join("part");
    let out = out.to_str().expect("a path");
    let arguments =
        ["capture", "tori", "-t", "z-fail", "--size", "101x67", "--viewport", "0.213,0.118,0.55,0.703", "-o", out];
    let output = run(work.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let plan = std::fs::read_to_string(work.path().join("part/plan.txt")).expect("a plan");
    assert!(plan.contains("viewport 55x47 from 22,8, depths 0 to 1"), "{plan}");
    // The folder knows it: a pixel outside shows nothing, one within a surface.
    let pixel = |at: &str| text(&run(work.path(), &["pixel", out, "--at", at, "--coordinates"]).stdout);
    assert!(pixel("50,30").contains("window "), "{}", pixel("50,30"));
    let start = ["pixel", "tori", "--at", "4,4"];
    for (viewport, words) in [
        ("0.5,0,0.6,1", "within it"),
        ("0,0,0,1", "wider and higher than 0"),
        ("-0.1,0,1,1", "from 0 to 1"),
        ("0,0,1", "LEFT,TOP,WIDTH,HEIGHT"),
        ("0,0,nan,1", "LEFT,TOP,WIDTH,HEIGHT"),
    ] {
        assert_fails(&[&start[..], &["--viewport", viewport]].concat(), 2, &[words]);
    }
    let help = text(&run(work.path(), &["help", "viewport-offset"]).stdout);
    assert!(help.contains("glViewport(x0, H - y0 - h, w, h)"), "{help}");
}
