//! A pixel's point and vertices in every space: the chain leads back to the pixel, and the depth is the one that was stored.

mod carried;

use crate::commands::{assert_fails, folder, run, text};
use crate::common::{from_above, mesh, opened, request, request_with, session};
use glam::{DMat4, DVec3, DVec4};
use stencilscope::capture::Capture;
use stencilscope::math::depth::DepthMapping;
use stencilscope::reading::coordinates::{
    NoVertex, PixelCoordinates, TransformStep, VertexCoordinates, VertexPlaces, matrix_row,
};
use stencilscope::scene::{Object, Projection, Scene, SceneBuilder};
use stencilscope::technique::Technique;

fn matrix(rows: [[f64; 4]; 4]) -> DMat4 {
    DMat4::from_cols_array_2d(&rows).transpose()
}

#[test]
fn the_chain_leads_from_the_world_to_the_pixel_and_back() {
    let mut session = session();
    let mut points = 0;
    for (name, mapping) in [("tori", 0), ("table", 1), ("steps", 2), ("inside", 3)] {
        let scene = opened(name);
        let mapping = DepthMapping::ALL[mapping];
        let frame = request_with(Technique::None, &[("depth", mapping.name())], [200, 150]);
        let capture = session.capture(&scene, &frame).expect("a capture");
        let [width, height] = capture.size;
        for pixel in [[0, 0], [width / 2, height / 2], [width / 3, height - 1], [width - 1, height / 4]] {
            let place = PixelCoordinates::of(&capture, pixel);
            for TransformStep { name, matrix: rows, inverse } in &place.chain {
                let product = matrix(*rows) * matrix(inverse.expect("an inverse"));
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
            let [eye, clip, window] = [0, 1, 2].map(|step| matrix(place.chain[step].inverse.expect("an inverse")));
            let ndc = window * DVec4::new(x, y, depth, 1.0);
            let world = eye * clip * (ndc * point.clip[3]);
            let error = (world.truncate() / world.w - DVec3::from_array(point.world)).length();
            assert!(error < 1e-6, "{name}, {pixel:?}: {error} m");
            let steps: Vec<f64> = place.depth_steps.iter().filter_map(|step| step.metres).collect();
            assert!(steps.windows(2).take(2).all(|pair| pair[0] > pair[1]), "more bits, finer steps: {steps:?}");
        }
    }
    assert!(points >= 10, "{points}");
}

/// A lamp at height 4 over a floor; a quad stands from height 2 to the lamp's, so that two of its corners have no shadow.
fn standing_quad() -> Scene {
    let points = [[-1.0, 2.0, 0.5], [1.0, 2.0, 0.5], [1.0, 4.0, 0.5], [-1.0, 4.0, 0.5]];
    let mut scene = from_above(vec![Object::of("quad", mesh(&points, &[[0, 1, 2], [0, 2, 3]]))]);
    scene.lights[0].position = DVec4::new(0.0, 4.0, 0.0, 1.0);
    scene
}

/// A matrix is shown for planes that casters are flattened onto, and for no others; a vertex level with the light, whose shadow
/// is at infinity, is not the nearest one.
#[test]
fn shadow_matrices_are_of_planes_that_casters_are_flattened_onto() {
    let mut session = session();
    let scene = standing_quad();
    let mut found = |settings: &[(&str, &str)], technique: Technique| {
        let request = request_with(technique, settings, [64, 64]);
        let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
        let history = session.history(&plan, &capture, [40, 20]).expect("a history");
        PixelCoordinates::of(&capture, [40, 20]).with_vertices(&capture, &plan, &history).flattened
    };
    for clip in ["on", "off", "gpu"] {
        let shown = found(&[("clip", clip)], Technique::Planar);
        assert_eq!(shown.len(), 1, "clip = {clip}");
        let vertex = shown[0].vertex.as_ref().expect("a vertex");
        assert!(vertex.index < 2 && vertex.flattened.iter().all(|value| value.is_finite()), "{vertex:?}");
        // w = the light's height less the vertex's, times the length of the normal, which is 1.
        assert!((vertex.flattened[3] - 2.0).abs() < 1e-5 && vertex.because.contains("w > 0"), "{vertex:?}");
    }
    assert_eq!(found(&[("receivers", "named:floor"), ("stencil", "off")], Technique::Planar).len(), 1);
    for (settings, technique) in [
        (&[("receivers", "named:quad")][..], Technique::Planar),
        (&[][..], Technique::ZFail),
        (&[][..], Technique::None),
    ] {
        assert!(found(settings, technique).is_empty(), "{technique:?} {settings:?}");
    }
}

/// Numbers of a row have a space between them, the longest included.
#[test]
fn columns_of_a_matrix_do_not_run_together() {
    for digits in 1..=9 {
        for row in
            [[-1.0 / 180.0, -0.000_123_456_789, -123_456.789, -1.0 / 3.0], [-1.0 / 3.0 * 1e300, -1e15, -4e9, -9e99]]
        {
            let row = matrix_row(&row, digits);
            assert_eq!(row.split_whitespace().count(), 4, "{row}");
            assert!(row.starts_with(' ') && !row.contains("0−"), "{row}");
        }
    }
}

/// At 2 metres before a near plane of 0.1, reversed: depth is 0.05, and a step of it `z² / near` times as many metres.
#[test]
fn steps_of_depth_are_those_of_the_formula() {
    let mut scene = from_above(Vec::new());
    scene.camera.near = 0.1;
    let mut session = session();
    let capture = session.capture(&scene, &request(Technique::None, [200, 200])).expect("a capture");
    let place = PixelCoordinates::of(&capture, [100, 100]);
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

/// The corners of the triangle that a pixel shows are a triangle of the object's mesh, and the pixel is between them;
/// their products with the chain's matrices are what is reported.
#[test]
fn the_corners_of_a_pixel_s_triangle_go_the_same_way() {
    let mut session = session();
    let mut found = 0;
    for (name, projection) in [
        ("tori", Projection::Perspective),
        ("steps", Projection::Orthographic { half_height: 3.0 }),
        ("table", Projection::Oblique { half_height: 2.0, angle_degrees: 45.0, factor: 0.5 }),
    ] {
        let mut scene = opened(name);
        scene.camera.projection = projection;
        let (capture, plan) =
            session.capture_with_plan(&scene, &request(Technique::ZFail, [80, 60])).expect("a capture");
        for pixel in [[40, 30], [20, 45], [63, 21], [33, 52]] {
            let history = session.history(&plan, &capture, pixel).expect("a history");
            let place = PixelCoordinates::of(&capture, pixel).with_vertices(&capture, &plan, &history);
            assert_eq!(place.point.is_some(), place.vertices.len() == 3, "{name} {pixel:?}");
            let Some(point) = place.point else { continue };
            found += 1;
            let [a, b, c] = [0, 1, 2].map(|at: usize| DVec3::from_array(place.vertices[at].world));
            let object =
                scene.objects.iter().find(|object| object.name == place.vertices[0].object).expect("an object");
            let indices = [0, 1, 2].map(|at: usize| place.vertices[at].index);
            assert!(object.mesh.triangles().contains(&indices), "{name} {pixel:?}: {indices:?}");
            for vertex in &place.vertices {
                let given = object.world_positions()[vertex.index as usize];
                assert!(given.distance(vertex.world.into()) < 1e-5, "{vertex:?} is not {given}");
                let [eye, clip, window] = [0, 1, 2].map(|step| matrix(place.chain[step].matrix));
                let expected = clip * eye * DVec3::from_array(vertex.world).extend(1.0);
                assert!(expected.abs_diff_eq(DVec4::from_array(vertex.clip), 1e-9), "{vertex:?}");
                if let (Some(ndc), Some(at)) = (vertex.ndc, vertex.window) {
                    assert!((expected.truncate() / expected.w).abs_diff_eq(ndc.into(), 1e-9), "{vertex:?}");
                    assert!((window * DVec3::from_array(ndc).extend(1.0)).truncate().abs_diff_eq(at.into(), 1e-6));
                }
            }
            let across = (b - a).cross(c - a);
            let [x, y, z] = point.world;
            let share = |from: DVec3, to: DVec3| {
                across.dot((to - from).cross(DVec3::new(x, y, z) - from)) / across.length_squared()
            };
            let shares = [share(b, c), share(c, a), share(a, b)];
            assert!(shares.iter().all(|share| (-0.01..1.01).contains(share)), "{name} {pixel:?}: {shares:?}");
        }
    }
    assert!(found > 8, "{found}");
}

/// A wedge that runs from before the eye to behind it; the eye looks along −Z from the origin, near plane at 0.5.
fn wedge(projection: Projection) -> Scene {
    let points = [[0.0, 0.0, -4.0], [1.0, 0.0, 0.0], [-1.0, 0.5, 3.0], [9.0, 0.0, -4.0], [0.0, 0.0, -0.25]];
    let mut scene = SceneBuilder::new("wedge")
        .object(Object::of("wedge: sharp", mesh(&points, &[[0, 1, 2], [0, 3, 1], [0, 4, 1]])))
        .seen_from([0.0; 3], [0.0, 0.0, -1.0])
        .build();
    scene.camera.near = 0.5;
    scene.camera.fov_y_degrees = 90.0;
    scene.camera.projection = projection;
    scene
}

fn vertices(capture: &Capture, scene: &Scene) -> Vec<VertexCoordinates> {
    let asked: Vec<String> = (0..5).map(|index| format!("wedge: sharp:{index}")).collect();
    VertexPlaces::of(capture, scene, &asked).expect("five vertices").vertices
}

#[test]
fn what_is_not_before_the_eye_is_not_divided_and_says_so() {
    let scene = wedge(Projection::Perspective);
    let mut session = session();
    for mapping in DepthMapping::ALL {
        let frame = request_with(Technique::None, &[("depth", mapping.name())], [64, 64]);
        let capture = session.capture(&scene, &frame).expect("a capture");
        let [before, beside, behind, right, too_near] =
            <[VertexCoordinates; 5]>::try_from(vertices(&capture, &scene)).expect("five");
        assert!(before.beyond.is_empty(), "{before:?}");
        // Straight ahead is the middle of the picture.
        let [x, y, _] = before.window.expect("divided");
        assert!((x - 32.0).abs() < 1e-9 && (y - 32.0).abs() < 1e-9, "{before:?}");
        assert_eq!((before.clip[3], beside.clip[3], behind.clip[3]), (4.0, 0.0, -3.0));
        for vertex in [&beside, &behind] {
            assert_eq!((vertex.ndc, vertex.window), (None, None), "{vertex:?}");
            assert!(vertex.beyond.contains(&"near"), "{}: {vertex:?}", mapping.name());
            let rows = vertex.rows(6);
            assert!(rows.iter().any(|(name, value)| *name == "NDC" && value.starts_with("not divided: w is not")));
        }
        assert_eq!(right.beyond, ["right"]);
        assert!((right.ndc.expect("divided")[0] - 2.25).abs() < 1e-9);
        assert_eq!(too_near.beyond, ["near"], "{}", mapping.name());
    }
}

/// Parallel view rays divide by 1, before the eye and behind it.
#[test]
fn parallel_cameras_divide_by_one() {
    let mut session = session();
    for projection in [
        Projection::Orthographic { half_height: 2.0 },
        Projection::Oblique { half_height: 2.0, angle_degrees: 0.0, factor: 0.5 },
    ] {
        let scene = wedge(projection);
        let capture = session.capture(&scene, &request(Technique::None, [64, 64])).expect("a capture");
        let found = vertices(&capture, &scene);
        assert!(found.iter().all(|vertex| vertex.clip[3] == 1.0 && vertex.ndc.is_some()), "{found:?}");
        let near: Vec<bool> = found.iter().map(|vertex| vertex.beyond.contains(&"near")).collect();
        assert_eq!(near, [false, true, true, false, true], "{found:?}");
        if matches!(projection, Projection::Orthographic { .. }) {
            // Half of the half-height to the right: three quarters of the picture.
            let at = found[1].window.expect("divided");
            assert!((at[0] - 48.0).abs() < 1e-9 && (at[1] - 32.0).abs() < 1e-9, "{at:?}");
        }
    }
}

#[test]
fn a_vertex_that_is_not_there_is_named() {
    let scene = wedge(Projection::Perspective);
    let capture = session().capture(&scene, &request(Technique::None, [16, 16])).expect("a capture");
    let asked = |vertex: &str| VertexPlaces::of(&capture, &scene, &[vertex.to_owned()]).expect_err(vertex);
    assert!(matches!(asked("wedge"), NoVertex::Form(_)) && matches!(asked("wedge: sharp:-1"), NoVertex::Form(_)));
    assert!(asked("wedge sharp:0").to_string().contains("wedge: sharp"), "the nearest name");
    assert_eq!(asked("wedge: sharp:5").to_string(), "wedge: sharp has no vertex 5: it has 5, counted from 0");
}

#[test]
fn pixel_reports_vertices_and_explains_each_key() {
    let work = folder();
    let of = |arguments: &[&str]| {
        let size = ["pixel", "tetrahedron", "--size", "80x60"];
        text(&run(work.path(), &[&size[..], arguments].concat()).stdout)
    };
    let printed = of(&["--vertex", "tetrahedron:3", "--vertex", "shaft:0"]);
    assert!(
        printed.contains("vertex 3 of tetrahedron\nworld ") && printed.contains("vertex 0 of shaft\n"),
        "{printed}"
    );
    assert!(printed.contains("clip from eye, and its inverse:") && printed.contains("\nview "), "{printed}");
    let json = |arguments: &[&str]| -> serde_json::Value { serde_json::from_str(&of(arguments)).expect("JSON") };
    let document = json(&["--vertex", "tetrahedron:3", "--json"]);
    assert_eq!((&document["vertices"][0]["index"], document["chain"].as_array().map(Vec::len)), (&3.into(), Some(3)));
    crate::help::assert_json_is_explained("pixel", &document);
    let document = json(&["--at", "40,30", "--coordinates", "--json"]);
    assert_eq!(document["coordinates"]["vertices"].as_array().map(Vec::len), Some(3));
    crate::help::assert_json_is_explained("pixel", &document);
    let printed = of(&["--at", "40,30", "--coordinates"]);
    assert_eq!(printed.matches("\nview ").count(), 3, "{printed}");
    // The folder has the scene, and says the same.
    let made = run(work.path(), &["capture", "tetrahedron", "--size", "80x60", "-o", "out"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let of_folder = text(&run(work.path(), &["pixel", "out", "--vertex", "tetrahedron:3"]).stdout);
    assert_eq!(of_folder, of(&["--vertex", "tetrahedron:3"]));
    assert_fails(&["pixel", "tetrahedron", "--vertex", "tetrahedon:3"], 2, &["tetrahedon", "`tetrahedron`"]);
    assert_fails(&["pixel", "tetrahedron", "--vertex", "tetrahedron:99"], 2, &["has no vertex 99: it has 4"]);
    assert_fails(&["pixel", "tetrahedron", "--vertex", "a:0", "--at", "1,1"], 2, &["--at"]);
    assert_fails(&["pixel", "tetrahedron"], 2, &["--at"]);
    assert_fails(&["pixel", "ogre", "--vertex", "a:0"], 2, &["another program's is a guess", "leave it out"]);
}
