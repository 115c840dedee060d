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
