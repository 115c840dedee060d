//! Where parallel lines meet in a picture: at the picture of what is very far along them, in each kind of perspective.

use crate::commands::{done, folder, printed_json};
use crate::common::{from_above, request, session};
use glam::{DVec3, DVec4};
use stencilscope::capture::Capture;
use stencilscope::reading::pick_ray;
use stencilscope::reading::vanishing::{AxisLines, PictureLines, axes, words};
use stencilscope::scene::{Camera, Projection};
use stencilscope::session::Session;
use stencilscope::technique::Technique;

fn capture(session: &mut Session, camera: Camera) -> Capture {
    let mut scene = from_above(Vec::new());
    scene.camera = Camera { fov_y_degrees: 90.0, near: 0.1, ..camera };
    session.capture(&scene, &request(Technique::None, [200, 100])).expect("a capture")
}

/// The command line says how many points there are and where, in words and as JSON.
#[test]
fn pixel_says_where_lines_meet() {
    let folder = folder();
    let asked = ["pixel", "table", "-t", "none", "--size", "160x120", "--at", "80,60", "--coordinates"];
    let printed = done(folder.path(), &asked);
    let document = printed_json(folder.path(), &[&asked[..], &["--json"]].concat());
    let vanishing = document["coordinates"]["vanishing"].as_array().expect("three axes");
    let meet: Vec<&serde_json::Value> = vanishing.iter().filter(|one| one["lines"]["meet"].is_array()).collect();
    assert!(printed.contains(&format!("{}-point perspective: lines along", meet.len())), "{printed}");
    assert!(!meet.is_empty() && vanishing.len() == 3, "{vanishing:?}");
    for one in meet {
        let axis = one["axis"].as_str().expect("a name");
        assert!(printed.contains(&format!("  those along {axis} at ")), "{axis}: {printed}");
    }
    let flat = ["pixel", "table", "-t", "none", "--vertex", "slab:0"];
    assert!(done(folder.path(), &flat).contains("-point perspective"));
}

#[test]
fn lines_meet_where_what_is_far_along_them_is_seen() {
    let mut session = session();
    for (eye, target, sentence) in [
        (
            [0.0, 3.0, 8.0],
            [0.0, 3.0, 0.0],
            "1-point perspective: lines along z meet in a point, those along x and y stay",
        ),
        (
            [6.0, 3.0, 6.0],
            [0.0, 3.0, 0.0],
            "2-point perspective: lines along x and z meet in a point, those along y stay",
        ),
        ([6.0, 5.0, 4.0], [0.0, 0.0, 0.0], "3-point perspective"),
    ] {
        let capture = capture(&mut session, Camera::looking(eye, target));
        let found = axes(&capture);
        assert!(words(&found).starts_with(sentence), "{}", words(&found));
        for AxisLines { axis, lines } in found {
            let along = DVec3::AXES[["x", "y", "z"].iter().position(|name| *name == axis).expect("an axis")];
            // From several places, along the way that leads away from the eye.
            for start in [DVec3::ZERO, DVec3::new(1.0, 2.0, -1.0), DVec3::new(-2.0, 0.5, 0.0)] {
                let ahead = along * along.dot(capture.camera.target - capture.camera.eye).signum();
                let seen = |far: f64| pick_ray::texel_of(&capture, (start + ahead * far).extend(1.0));
                match lines {
                    PictureLines::Meet(at) => {
                        let [x, y] = seen(1e9).expect("it is ahead");
                        assert!((x - at[0]).abs() < 1e-3 && (y - at[1]).abs() < 1e-3, "{axis}: {x}, {y} is not {at:?}");
                    }
                    PictureLines::Parallel([right, down]) => {
                        let [[x, y], [to_x, to_y]] = [0.0, 1.0].map(|far| {
                            let at: DVec4 = (start + along * far).extend(1.0);
                            pick_ray::texel_of(&capture, at).expect("it is ahead")
                        });
                        let across = (to_x - x) * down - (to_y - y) * right;
                        assert!(across.abs() < 1e-9, "{axis}: along {right}, {down}");
                    }
                    PictureLines::Points => panic!("{axis}: not of a perspective"),
                }
            }
        }
    }
    // A quarter of a turn aside, with a field of view of 90°: as far aside as half the picture is high.
    let turned = capture(&mut session, Camera::looking([5.0, 1.0, 5.0], [0.0, 1.0, 0.0]));
    let [x, _, z] = axes(&turned).map(|one| one.lines);
    let (PictureLines::Meet([left, at]), PictureLines::Meet([right, same])) = (x, z) else { panic!("{x:?}, {z:?}") };
    assert!((at - 50.0).abs() < 1e-9 && (same - 50.0).abs() < 1e-9, "the horizon");
    assert!((left.min(right) - 50.0).abs() < 1e-9 && (left.max(right) - 150.0).abs() < 1e-9, "{left}, {right}");
}

#[test]
fn a_parallel_projection_has_no_vanishing_points() {
    let mut session = session();
    for projection in [
        Projection::Orthographic { half_height: 3.0 },
        Projection::Oblique { half_height: 3.0, factor: 0.5, angle_degrees: 45.0 },
    ] {
        let camera = Camera { projection, ..Camera::looking([0.0, 3.0, 8.0], [0.0, 3.0, 0.0]) };
        let found = axes(&capture(&mut session, camera));
        assert_eq!(words(&found), "Parallel projection: lines that are parallel stay so.");
        let [x, y, z] = found.map(|one| one.lines);
        assert!(matches!(x, PictureLines::Parallel([right, _]) if (right.abs() - 1.0).abs() < 1e-9), "{x:?}");
        assert!(matches!(y, PictureLines::Parallel([_, down]) if (down.abs() - 1.0).abs() < 1e-9), "{y:?}");
        // Straight ahead: points, or as the projection leans.
        let is_oblique = matches!(projection, Projection::Oblique { .. });
        assert_eq!(z == PictureLines::Points, !is_oblique, "{z:?}");
    }
}
