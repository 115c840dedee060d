//! Points go through the matrices that are shown, in both conventions, to the places that the GPU uses.

use super::{matrix, wedge};
use crate::common::{opened, request_with, session};
use glam::{DMat4, DVec3, DVec4};
use stencilscope::capture::Capture;
use stencilscope::math::depth::DepthMapping;
use stencilscope::plan::{DrawPart, FramePlan};
use stencilscope::reading::coordinates::{PixelCoordinates, TransformStep, VertexPlaces};
use stencilscope::reading::light_coordinates::LightCoordinates;
use stencilscope::reading::shadow_matrix::ShadowMatrix;
use stencilscope::reading::texels_read::TexelReaders;
use stencilscope::scene::Projection;
use stencilscope::technique::Technique;

/// Cameras of all kinds with depth from 0 to 1 and from −1 to 1. OpenGL's rows are those of its reference: glFrustum and glOrtho,
/// −(f + n) / (f − n) and −2 f n / (f − n), or −2 / (f − n); with the far plane at infinity −1 and −2 n; reversed, 1 and 2 n.
#[test]
fn a_point_goes_through_both_conventions_of_depth_to_one_place() {
    let mut session = session();
    let (near, far) = (0.5, 8.0);
    let mut compared = 0;
    for (projection, kind) in [
        (Projection::Perspective, "perspective"),
        (Projection::Orthographic { half_height: 2.0 }, "orthographic"),
        (Projection::Oblique { half_height: 2.0, angle_degrees: 45.0, factor: 0.5 }, "oblique"),
    ] {
        for mapping in DepthMapping::ALL {
            let mut scene = wedge(projection);
            scene.camera.far = Some(far);
            let frame = request_with(Technique::None, &[("depth", mapping.name())], [64, 48]);
            let capture = session.capture(&scene, &frame).expect("a capture");
            let asked = ["wedge: sharp:0".to_owned()];
            let places = VertexPlaces::of(&capture, &scene, &asked).expect("a vertex");
            let what = format!("{kind} {}: {}", mapping.name(), places.projection);
            assert!(places.projection.starts_with(kind), "{what}");
            assert_eq!(places.projection.contains("reversed"), mapping.is_reversed(), "{what}");
            assert_eq!(places.projection.contains("far plane at 8 m"), mapping.is_finite(), "{what}");
            let [clip, window] = [0, 1].map(|step| matrix(places.opengl[step].matrix));
            let z_row = [clip.row(2).z, clip.row(2).w];
            let is_parallel = kind != "perspective";
            let expected = match (is_parallel, mapping) {
                (false, DepthMapping::ReversedInfinite) => Some([1.0, 2.0 * near]),
                (false, DepthMapping::StandardInfinite) => Some([-1.0, -2.0 * near]),
                (false, DepthMapping::StandardFinite) => {
                    Some([-(far + near) / (far - near), -2.0 * far * near / (far - near)])
                }
                (true, DepthMapping::StandardFinite) => Some([-2.0 / (far - near), -(far + near) / (far - near)]),
                _ => None,
            };
            if let Some(expected) = expected {
                let is_near = (0..2).all(|at| (z_row[at] - expected[at]).abs() < 1e-6);
                assert!(is_near, "{what}: {z_row:?} is not {expected:?}");
                compared += 1;
            }
            for vertex in [[0.0, 0.0, -4.0], [0.7, -0.4, -2.0], [-0.2, 0.9, -7.5]] {
                let eye = DVec3::from_array(vertex).extend(1.0);
                let [ours, theirs] = [matrix(places.chain[1].matrix) * eye, clip * eye];
                let window_of = |window: DMat4, clip: DVec4| (window * (clip / clip.w)).truncate();
                let ours = window_of(matrix(places.chain[2].matrix), ours);
                let theirs = window_of(window, theirs);
                let turned = DVec3::new(theirs.x, 48.0 - theirs.y, theirs.z);
                assert!(ours.abs_diff_eq(turned, 1e-9), "{what}: {vertex:?} goes to {ours} and {theirs}");
                for step in &places.opengl {
                    let back = matrix(step.inverse.expect("an inverse")) * matrix(step.matrix);
                    assert!(back.abs_diff_eq(DMat4::IDENTITY, 1e-9), "{what}: {back}");
                }
            }
        }
    }
    assert_eq!(compared, 5);
}

/// A lamp's frustum has the numbers that it is given; a sun's planes are where its depths are 0 and 1.
#[test]
fn a_light_s_frustum_has_its_axes_and_its_planes() {
    let mut session = session();
    let mut compared = 0;
    for (name, settings) in [
        ("table", &[("light-frustum", "60:0.5:20")][..]),
        ("table", &[("light-frustum", "60:0.5:20"), ("depth", "standard-finite")]),
        ("table", &[]),
        ("tori", &[]),
        ("glass", &[]),
    ] {
        let scene = opened(name);
        let frame = request_with(Technique::ShadowMap, settings, [80, 60]);
        let capture = session.capture(&scene, &frame).expect("a capture");
        let places = (0..48).map(|index| [5 + 10 * (index % 8), 5 + 10 * (index / 8)]);
        for place in places.flat_map(|pixel| PixelCoordinates::of(&capture, pixel).lights) {
            let Some(frustum) = &place.frustum else { continue };
            let what = format!("{name} {settings:?}: {frustum:?}");
            let [right, up, ahead] = [frustum.right, frustum.up, frustum.ahead].map(DVec3::from_array);
            assert!(right.dot(up).abs() < 1e-9 && right.cross(up).cross(ahead).length() < 1e-9, "{what}");
            let position = capture.lights[place.light].position;
            if let (Some(far), true) = (frustum.far, !settings.is_empty() && position.w != 0.0) {
                assert!((frustum.near - 0.5).abs() < 1e-6 && (far - 20.0).abs() < 1e-5, "{what}");
                assert!((frustum.ratio.expect("a lamp") - 40.0).abs() < 1e-4, "{what}");
            }
            assert!(position.w != 0.0 || (frustum.ratio.is_none() && ahead.dot(position.truncate()) < 0.0), "{what}");
            // From the origin of the light's eye space along its axis to both planes.
            let light_from_world = matrix(place.chain[0].matrix);
            let origin = light_from_world.inverse().transform_point3(DVec3::ZERO);
            let depth = |distance: f64| {
                let clip = matrix(place.chain[1].matrix) * light_from_world * (origin + ahead * distance).extend(1.0);
                clip.z / clip.w
            };
            let clear = f64::from(capture.map_clear_depth(place.light));
            assert!((depth(frustum.near) - (1.0 - clear)).abs() < 1e-6, "{what}: {}", depth(frustum.near));
            assert!(frustum.far.is_none_or(|far| (depth(far) - clear).abs() < 1e-6), "{what}");
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}

/// A scene, a technique and its settings.
type CarriedForm = (&'static str, Technique, &'static [(&'static str, &'static str)]);

/// The matrices that are shown are those that are used: a hundred points go through them to the places where the GPU's own
/// matrices put them, to texels that their pixels read, and to corners of flattened triangles.
#[test]
fn a_hundred_points_go_through_the_matrices_to_pixel_texel_and_flattened_corner() {
    let mut session = session();
    let (mut pixels, mut texels, mut corners) = (0, 0, 0);
    let forms: [CarriedForm; 6] = [
        ("tori", Technique::ShadowMap, &[]),
        ("table", Technique::ShadowMap, &[("filter", "pcf:3")]),
        ("table", Technique::Projective, &[]),
        ("table", Technique::PlanarTexture, &[]),
        ("rings", Technique::Planar, &[("clip", "off"), ("leave-out", "none")]),
        ("table", Technique::Planar, &[("clip", "off"), ("leave-out", "none")]),
    ];
    for (name, technique, settings) in forms {
        let scene = opened(name);
        let request = request_with(technique, settings, [160, 120]);
        let (capture, plan) = (
            session.capture(&scene, &request).expect("a capture"),
            std::sync::Arc::new(session.plan(&scene, &request).expect("a plan")),
        );
        let readers = TexelReaders::new(&capture, &plan);
        let eye = capture.camera.eye;
        let what = &format!("{name} {technique:?}");
        for pixel in (0..140).map(|index| [11 * (index % 14) + 5, 12 * (index / 14) + 5]) {
            let history = session.history(&plan, &capture, pixel).expect("a history");
            let place = PixelCoordinates::of(&capture, pixel).with_vertices(&capture, &plan, &history);
            let Some(point) = place.point else { continue };
            let world = DVec3::from_array(point.world);
            let gpu = plan.views[0].clip_from_relative * (world - eye).as_vec3().extend(1.0);
            let shown = through(&place.chain[..2], world);
            assert!(gpu.as_dvec4().abs_diff_eq(shown, 1e-5 * shown.w), "{name} {pixel:?}: {gpu}, {shown}");
            let window = through(&place.chain[2..], shown.truncate() / shown.w);
            let off =
                (window.truncate().truncate() - glam::DVec2::from_array(pixel.map(|at| f64::from(at) + 0.5))).length();
            assert!(off < 1e-3, "{name} {pixel:?}: {off} pixels off");
            pixels += 1;
            let read = serde_json::to_value(readers.at(&capture, pixel)).expect("values");
            for light in &place.lights {
                let map = plan.lights[light.light].map.as_ref().expect("a map");
                let gpu = map.clip_from_relative[light.layer] * (world - eye).as_vec3().extend(1.0);
                let shown = through(&light.chain[..light.chain.len() - 1], world);
                let size = shown.abs().max_element();
                assert!(
                    gpu.as_dvec4().abs_diff_eq(shown, 1e-5 * size),
                    "{name} {technique:?} {pixel:?}: {gpu}, {shown}"
                );
                let strq = through(&light.chain, world);
                assert!(strq.abs_diff_eq(DVec4::from_array(light.strq), 1e-9 * size));
                assert_is_the_same_in_opengl(&capture, light, world, what);
                let Some(is_near) = is_read_near(&capture, light, strq, &read[light.light]) else { continue };
                assert!(is_near, "{what} {pixel:?}: {strq} in {}", read[light.light]);
                texels += 1;
            }
            corners += place.flattened.iter().filter(|shadow| is_a_drawn_corner(&plan, eye, shadow)).count();
        }
    }
    assert!(pixels >= 100 && texels >= 100 && corners >= 100, "{pixels} pixels, {texels} texels, {corners} corners");
}

fn through(chain: &[TransformStep], point: DVec3) -> DVec4 {
    chain.iter().fold(point.extend(1.0), |point, step| matrix(step.matrix) * point)
}

/// Holds that a place in a light's map is the same one as OpenGL has it: counted from below, and of one depth.
fn assert_is_the_same_in_opengl(capture: &Capture, light: &LightCoordinates, world: DVec3, what: &str) {
    let size = through(&light.chain[..light.chain.len() - 1], world).abs().max_element();
    let gl = light.clone().in_opengl();
    let gl_clip = through(&gl.chain[..gl.chain.len() - 1], world);
    assert!(gl_clip.abs_diff_eq(DVec4::from_array(gl.clip), 1e-9 * size), "{what}");
    assert!((gl.clip[2] - (2.0 * light.clip[2] - light.clip[3])).abs() < 1e-9 * size, "{what}");
    let gl_strq = through(&gl.chain, world);
    assert!(gl_strq.abs_diff_eq(DVec4::from_array(gl.strq), 1e-9 * size), "{what}");
    if let (Some([s, t, r]), Some([gl_s, gl_t, gl_r])) = (light.texture, gl.texture) {
        let off = (s - gl_s).abs().max((t + gl_t - 1.0).abs()).max((r - gl_r).abs());
        assert!(off < 1e-9 && (gl_r - gl_strq.z / gl_strq.w).abs() < 1e-9, "{what}: {off}");
        let rows = light.texel.expect("a texel")[1] + gl.texel.expect("a texel")[1];
        let side = capture.lights[light.light].map.as_ref().expect("a map").faces[0].size()[1];
        assert!((rows - f64::from(side)).abs() < 1e-6, "{what}: {rows}");
    }
}

/// Returns whether the texels that a pixel read of a layer lie round (s, t, r, q); `None` where it read none of it.
fn is_read_near(
    capture: &Capture,
    light: &LightCoordinates,
    strq: DVec4,
    of_light: &serde_json::Value,
) -> Option<bool> {
    let layers = of_light["layers"].as_array().cloned().unwrap_or_else(|| vec![of_light.clone()]);
    let is_here = |of: &&serde_json::Value| of["layer"].as_u64().or(of["face"].as_u64()) == Some(light.layer as u64);
    let of_layer = layers.iter().find(is_here)?;
    let sides = capture.lights[light.light].map.as_ref().expect("a map").faces[light.layer].size().map(f64::from);
    let [s, t] = [strq.x / strq.w * sides[0], strq.y / strq.w * sides[1]];
    Some(of_layer["texels"].as_array().expect("texels").iter().any(|texel| {
        let at = |side: usize| texel["at"][side].as_f64().expect("a texel");
        (s - at(0) - 0.5).abs() < 1.01 && (t - at(1) - 0.5).abs() < 1.01
    }))
}

/// Returns whether a caster's corner that a shadow matrix flattens is one that is drawn; holds that it lies on the plane, and that
/// it is the anti-shadow's where w < 0.
fn is_a_drawn_corner(plan: &FramePlan, eye: DVec3, shadow: &ShadowMatrix) -> bool {
    let carry = matrix(shadow.matrix);
    let vertex = shadow.vertex.as_ref().expect("a caster");
    let flattened = carry * DVec3::from_array(vertex.world).extend(1.0);
    assert!(flattened.abs_diff_eq(DVec4::from_array(vertex.flattened), 1e-9 * flattened.abs().max_element()));
    let over_w = flattened.truncate() / flattened.w;
    let plane = DVec4::from_array(shadow.plane);
    assert!(plane.dot(over_w.extend(1.0)).abs() < 1e-9 * over_w.length().max(1.0), "on the plane");
    assert_eq!(flattened.w < 0.0, vertex.because.contains("anti-shadow"), "{vertex:?}");
    let meshes = plan.passes.iter().flat_map(|pass| &pass.draws).filter(|draw| {
        let is_shadow = draw.part == DrawPart::PlanarShadow;
        is_shadow && draw.caster.as_deref() == Some(&vertex.object)
    });
    let mut places = meshes.flat_map(|draw| plan.meshes[draw.mesh.0].vertices.data());
    let relative = (over_w - eye).as_vec3();
    places.any(|[x, y, z, w]| {
        *w != 0.0 && (glam::Vec3::new(*x, *y, *z) / *w).abs_diff_eq(relative, 1e-4 * relative.length())
    })
}
