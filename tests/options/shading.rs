//! Diffuse light, and where it is computed.

use super::{as_bright_as, brightness, capture};
use crate::common::{from_above, session};
use glam::DVec3;
use std::collections::BTreeSet;
use stencilscope::scene::shapes;
use stencilscope::scene::{Light, Material, Object, Scene, Shading};
use stencilscope::technique::Technique;

/// A sun 60° from overhead: half of the light by Lambert, three quarters wrapped.
#[test]
fn wrapped_light_falls_off_with_half_the_cosine() {
    let mut session = session();
    let mut scene = from_above(Vec::new());
    scene.ambient = [0.0; 3];
    scene.lights = vec![Light::directional(DVec3::new(3f64.sqrt(), 1.0, 0.0))];
    for (diffuse, part) in [("lambert", 0.5), ("wrapped", 0.75)] {
        let found = capture(&mut session, &scene, Technique::None, &[("diffuse", diffuse)]);
        assert_eq!(as_bright_as(&brightness(&found), 0.75 * part), 40_000, "{diffuse}");
    }
}

/// Wrapped light reaches round the edge; a surface seen from behind the light is darkest, not black.
#[test]
fn wrapped_light_reaches_what_faces_away() {
    let mut session = session();
    let mut scene = from_above(Vec::new());
    scene.ambient = [0.0; 3];
    // 60° below the floor's horizon: the cosine is −1/2, wrapped 1/4.
    scene.lights = vec![Light::directional(DVec3::new(3f64.sqrt(), -1.0, 0.0))];
    for (diffuse, part) in [("lambert", 0.0), ("wrapped", 0.25)] {
        let found = capture(&mut session, &scene, Technique::None, &[("diffuse", diffuse)]);
        assert_eq!(as_bright_as(&brightness(&found), 0.75 * part), 40_000, "{diffuse}");
    }
}

fn ball(shading: Shading) -> Scene {
    let mesh = shapes::sphere(2.0, 12, 6).expect("a sphere");
    let material = Material { specular: 0.8, shininess: 60.0, shading, color: [0.4; 3], ..Material::default() };
    let mut scene = from_above(vec![Object::new("ball", std::sync::Arc::new(mesh), material)]);
    scene.objects.remove(0);
    scene.ambient = [0.0; 3];
    scene.lights = vec![Light::directional(DVec3::new(0.4, 1.0, 0.3))];
    scene
}

/// Flat: a shade a triangle, but for highlights. Gouraud misses the highlight that no vertex is at;
/// Phong finds it.
#[test]
fn phong_finds_the_highlight_that_gouraud_misses() {
    let mut session = session();
    let mut peak = |shading| {
        let shades = brightness(&capture(&mut session, &ball(shading), Technique::None, &[]));
        let distinct: BTreeSet<u64> = shades.iter().map(|value| (value * 1000.0) as u64).collect();
        (shades.into_iter().fold(0.0, f64::max), distinct.len())
    };
    let [(_, _), (gouraud, _), (phong, _)] = [peak(Shading::Flat), peak(Shading::Gouraud), peak(Shading::Phong)];
    assert!(phong > 0.95 && gouraud < 0.8 * phong, "{gouraud} {phong}");
}

/// Without a highlight, a flat ball has one shade a facet, and a smooth one many.
#[test]
fn a_flat_ball_has_facets() {
    let mut session = session();
    let mut shades = |shading| {
        let mut scene = ball(shading);
        scene.objects[0].material.specular = 0.0;
        let found = brightness(&capture(&mut session, &scene, Technique::None, &[]));
        found.iter().map(|value| (value * 1e6) as u64).collect::<BTreeSet<_>>().len()
    };
    let [flat, gouraud, phong] = [shades(Shading::Flat), shades(Shading::Gouraud), shades(Shading::Phong)];
    // Twelve segments in three rings face the eye, two triangles of one quad share a shade.
    assert!(flat <= 12 * 3 * 2 + 1 && gouraud > 100 && phong > 100, "{flat} {gouraud} {phong}");
}

/// One setting for all surfaces is what each material would say.
#[test]
fn the_setting_shades_all_objects_as_their_materials_would() {
    let mut session = session();
    for (name, shading) in [("flat", Shading::Flat), ("gouraud", Shading::Gouraud), ("phong", Shading::Phong)] {
        let by_material = capture(&mut session, &ball(shading), Technique::None, &[]);
        for other in Shading::ALL {
            let by_setting = capture(&mut session, &ball(other), Technique::None, &[("shading", name)]);
            assert_eq!(brightness(&by_setting), brightness(&by_material), "{other:?} told to be {name}");
        }
    }
}

/// Sent out whether lit or not, and darkened by no shadow.
#[test]
fn what_glows_is_as_bright_in_the_dark() {
    let mut session = session();
    let mut scene = from_above(Vec::new());
    scene.ambient = [0.0; 3];
    scene.lights[0].color = [0.0; 3];
    scene.objects[0].material.emission = [0.25, 0.5, 1.0];
    let found = capture(&mut session, &scene, Technique::ZFail, &[]);
    assert_eq!(as_bright_as(&brightness(&found), 0.25), 40_000);
}

/// Of a black floor that shines, highlights are all there is to see.
#[test]
fn a_checkerboard_darkens_no_highlight() {
    let mut session = session();
    for shading in ["flat", "gouraud", "phong"] {
        let [plain, checked] = [0.0, 1.0].map(|checks| {
            let mut scene = from_above(Vec::new());
            let floor = &mut scene.objects[0].material;
            (floor.color, floor.specular, floor.shininess, floor.checks) = ([0.0; 3], 0.8, 1.0, checks);
            brightness(&capture(&mut session, &scene, Technique::None, &[("shading", shading)]))
        });
        assert!(plain.iter().any(|shade| *shade > 0.02), "{shading}");
        assert_eq!(plain, checked, "{shading}");
    }
}

/// Twenty by twenty metres seen as 200 × 200 pixels: squares of one metre are ten pixels, half of them a third as bright,
/// wherever in the world the floor lies.
#[test]
fn a_checkerboard_has_as_many_dark_squares_as_light_ones_near_and_far_from_the_origin() {
    let mut session = session();
    for (offset, name) in [(0.0, "flat"), (0.0, "gouraud"), (1e6, "phong"), (1e6 + 1.0, "flat")] {
        let mut scene = from_above(Vec::new());
        scene.ambient = [1.0; 3];
        scene.lights[0].color = [0.0; 3];
        scene.objects[0].material.checks = 1.0;
        for place in [&mut scene.camera.eye, &mut scene.camera.target, &mut scene.objects[0].pose.translate] {
            place.x += offset;
        }
        let shades = brightness(&capture(&mut session, &scene, Technique::None, &[("shading", name)]));
        assert_eq!([as_bright_as(&shades, 0.75), as_bright_as(&shades, 0.25)], [20_000, 20_000], "{offset}");
        let edges = shades[..200].windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!((19..=20).contains(&edges), "squares of ten pixels: {edges} edges");
    }
}
