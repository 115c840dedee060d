//! Bodies with holes: what lies behind none of them is left out as of a closed body, and what shows through one is not.

use super::{SIZE, all_but, auto, ball, left_out, looking};
use crate::common::{adapter, from_above, request, session};
use glam::{DVec3, DVec4};
use std::sync::Arc;
use stencilscope::plan::Decision;
use stencilscope::progress::Progress;
use stencilscope::scene::{Light, Mesh, MeshBuilder, Object, Scene, shapes};
use stencilscope::session::Session;
use stencilscope::technique::Technique;

/// The object without the triangles that `is_removed` says, by index.
fn without(object: Object, is_removed: impl Fn(usize) -> bool) -> Object {
    let mesh = &object.mesh;
    let kept = mesh.triangles().iter().enumerate().filter(|(index, _)| !is_removed(*index));
    let triangles = kept.map(|(_, corners)| *corners).collect();
    let builder = MeshBuilder { positions: mesh.positions().to_vec(), triangles, ..MeshBuilder::default() };
    let mesh: Arc<Mesh> = Arc::new(builder.build().expect("a mesh"));
    Object { mesh, ..object }
}

/// How many triangles the draws of volumes have by z-fail.
fn counted(session: &mut Session, scene: &Scene) -> usize {
    let plan = session.plan(scene, &request(Technique::ZFail, SIZE)).expect("a plan");
    let draws = plan.passes.iter().flat_map(|pass| &pass.draws).filter(|draw| draw.part.is_of_volume());
    draws.map(|draw| draw.triangles.len()).sum()
}

#[test]
fn a_body_with_holes_leaves_out_what_lies_behind_none_of_them() {
    let mut session = session();
    let whole = || ball(24, 0.8, [0.0, 1.2, 0.0]);
    let count = whole().mesh.triangles().len();
    // One triangle, some that touch, and all of one end: a bowl that is open below, or above.
    let holed: [&dyn Fn(usize) -> bool; 4] = [
        &|index| index == count / 2,
        &|index| [3, 4, 5, 200, 201, 250].contains(&index),
        &|index| index > count * 3 / 4,
        &|index| index < count / 3,
    ];
    for (at, is_removed) in holed.into_iter().enumerate() {
        let mut scene = looking(from_above(vec![without(whole(), is_removed)]), [2.5, 2.6, 3.0], [0.0, 0.9, 0.0]);
        for light in [DVec4::new(1.0, 5.0, 0.5, 1.0), DVec4::new(-2.0, 0.4, 1.0, 1.0), DVec4::new(0.3, 1.0, -0.2, 0.0)]
        {
            scene.lights[0] = Light { position: light, ..scene.lights[0].clone() };
            let found = left_out(&mut session, &scene);
            let has = |what: &str| found.iter().any(|left| left.ends_with(what));
            // Of a bowl, all may lie behind the hole.
            let is_bowl = at > 1;
            assert!(is_bowl || has("triangles of ball that face away behind no hole"), "{at}, {light}: {found:?}");
            assert!(is_bowl || has("triangles of ball that face away from the eye"), "{at}, {light}: {found:?}");
            let judged = session.capture(&scene, &request(Technique::ZFail, SIZE)).expect("a capture");
            let judged = session.judged(&scene, &judged, &Progress::default()).expect("a truth");
            adapter::assert_right(&mut session, &scene, &request(Technique::ZFail, SIZE), &judged, &at);
        }
    }
    // A hole of one triangle costs little.
    let scene = |object: Object| from_above(vec![object]);
    let [closed, open] = [whole(), without(whole(), |index| index == count / 2)].map(scene);
    let [closed, open] = [closed, open].map(|scene| counted(&mut session, &scene));
    assert!(open * 10 < closed * 12, "{open} triangles of volumes, {closed} without the hole");
}

/// A sheet is no body, and two bodies that run into each other, or one inside out, are not closed by caps.
#[test]
fn what_caps_do_not_make_a_body_keeps_all_triangles() {
    let mut session = session();
    let two = shapes::joined([
        (&*ball(12, 0.5, [0.0; 3]).mesh, DVec3::new(0.0, 1.0, 0.0)),
        (&*ball(12, 0.5, [0.0; 3]).mesh, DVec3::new(0.3, 1.0, 0.0)),
    ]);
    let two = without(Object::of("ball", two.expect("two balls")), |index| index == 40);
    let mut mirrored = without(ball(12, 0.5, [0.0, 1.0, 0.0]), |index| index == 40);
    mirrored.pose.scale.x = -1.0;
    let sheet = Object::of("ball", shapes::quad([1.0, 1.0]).expect("a quad")).at([0.0, 1.0, 0.0]);
    for object in [two, mirrored, sheet] {
        let found = left_out(&mut session, &from_above(vec![object]));
        let has = |what: &str| found.iter().any(|left| left.ends_with(what));
        assert!(!has("triangles that face away behind no hole of ball"), "{found:?}");
        assert!(!has("triangles that face away from the eye of ball"), "{found:?}");
    }
    // Nor where it is forbidden.
    let scene = from_above(vec![without(ball(12, 0.5, [0.0, 1.0, 0.0]), |index| index == 40)]);
    let leaves_out = |leave_out: &str| {
        let capture = session.capture(&scene, &auto(leave_out)).expect("a capture");
        capture.left_out.iter().any(|left| left.is(Decision::AwayTriangles, "ball"))
    };
    assert_eq!(["all", &all_but(Decision::AwayTriangles)].map(leaves_out), [true, false]);
}
