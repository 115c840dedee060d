//! Boxes round a mesh's triangles, by which those over a pixel are found, find just what a look at each finds.

use super::frame;
use crate::common::random::Random;
use crate::common::{opened, session};
use stencilscope::plan::{Covering, Draw, FramePlan};
use stencilscope::scene::{Light, MeshBuilder, Object, Projection, Scene, SceneBuilder, shapes};
use stencilscope::technique::Technique;

/// So few triangles of a draw are looked at one by one.
const FEW: u32 = 200;
const PICTURE: [u32; 2] = [160, 120];

/// The plan with each draw in parts of few triangles, and for each pass which draw every part is of.
fn in_parts(plan: &FramePlan) -> (FramePlan, Vec<Vec<usize>>) {
    let mut parted = plan.clone();
    let mut draws_of = Vec::new();
    for pass in &mut parted.passes {
        let mut of_pass = Vec::new();
        for (index, draw) in std::mem::take(&mut pass.draws).into_iter().enumerate() {
            // Where the adapter draws pieces of a mesh, its triangles are not numbered as these are.
            let step = if draw.pieces.is_some() { u32::MAX } else { FEW };
            let mut start = draw.triangles.start;
            while start < draw.triangles.end {
                let end = draw.triangles.end.min(start.saturating_add(step));
                pass.draws.push(Draw { triangles: start..end, ..draw.clone() });
                of_pass.push(index);
                start = end;
            }
        }
        draws_of.push(of_pass);
    }
    (parted, draws_of)
}

/// Compares what covers random pixels of a scene's frames with what covers them where each triangle is looked at; returns
/// how many triangles that are.
fn compared(scene: &Scene, techniques: &[Technique]) -> usize {
    let mut random = Random::new(11);
    let mut found = 0;
    let mut session = session();
    for technique in techniques {
        let (_, plan) = frame(&mut session, scene, *technique, &[], PICTURE);
        let (parted, draws_of) = in_parts(&plan);
        for _ in 0..60 {
            let pixel = PICTURE.map(|pixels| (random.unit() * f64::from(pixels)) as u32);
            // In which order a draw's triangles are drawn is compared apart: in parts, some go through each part backwards.
            let unordered = |all: Vec<Covering>, draw_of: &dyn Fn(&Covering) -> usize| {
                let place = |one: Covering| Covering { draw: draw_of(&one), primitive: 0, ..one };
                let mut all: Vec<Covering> = all.into_iter().map(place).collect();
                all.sort_by_key(|one| (one.pass, one.draw, one.triangle, one.piece));
                all
            };
            let covering = plan.covering(pixel);
            let what = format!("{} by {} at {pixel:?}", scene.name, technique.name());
            assert!(covering.is_sorted_by_key(|one| (one.pass, one.draw, one.primitive)), "{what}");
            let expected = unordered(parted.covering(pixel), &|one| draws_of[one.pass][one.draw]);
            assert!(unordered(covering, &|one| one.draw) == expected, "{what}");
            found += expected.len();
        }
    }
    found
}

const ALL: [Technique; 4] = [Technique::Auto, Technique::ZFail, Technique::ZPass, Technique::Planar];

#[test]
fn boxes_find_the_triangles_over_a_pixel_of_built_in_scenes() {
    for (name, least) in [("tori", 2000), ("inside", 500), ("tiger-cage", 2000)] {
        let found = compared(&opened(name), &ALL);
        assert!(found > least, "{name}: {found}");
    }
}

/// A mesh whose triangles are in no order, from far, from a place inside it that the near plane cuts, off centre, in a part
/// of the picture, and by parallel view rays.
#[test]
fn boxes_find_the_triangles_over_a_pixel_of_a_large_mesh_in_no_order() {
    let torus = shapes::torus(0.9, 0.35, 180, 120).expect("a torus");
    let mut random = Random::new(3);
    let mut triangles = torus.triangles().to_vec();
    for index in (1..triangles.len()).rev() {
        triangles.swap(index, (random.unit() * (index + 1) as f64) as usize);
    }
    let positions = torus.positions().to_vec();
    let mesh = MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().expect("a mesh");
    let scene = SceneBuilder::new("in no order")
        .object(Object::of("floor", shapes::quad([8.0; 2]).expect("a floor")).at([0.0, -1.0, 0.0]))
        .object(Object::of("torus", mesh).rotated([20.0, 0.0, 10.0]))
        .light(Light::point([0.6, 2.5, 0.4]))
        .seen_from([1.5, 1.2, 2.5], [0.0; 3])
        .build();
    let mut views = vec![scene.clone(); 5];
    views[1].camera.eye = [0.9, 0.0, 0.1].into();
    views[1].camera.target = [-0.9, -0.2, 0.0].into();
    views[1].camera.near = 0.3;
    views[2].camera.projection = Projection::Frustum { left: -0.07, right: 0.02, bottom: -0.05, top: 0.01 };
    views[3].camera.viewport = Some([0.2, 0.1, 0.5, 0.8]);
    views[4].camera.projection = Projection::Orthographic { half_height: 1.5 };
    for (view, scene) in views.iter().enumerate() {
        let found = compared(scene, &ALL[..3]);
        assert!(found > 300, "{view}: {found}");
    }
}
