//! A light of its own for each caster, as game engines give each model: OGRE's frame, its volumes made anew one silhouette
//! edge a draw, of finite length, each caster's along a direction of its own.

use super::convert::frame_of;
use crate::common::session;
use glam::{DVec3, DVec4};
use std::collections::BTreeMap;
use std::sync::Arc;
use stencilscope::capture::Capture;
use stencilscope::plan::{Draw, DrawMesh, DrawPart, FramePlan, LightId, MeshId};
use stencilscope::progress::Progress;
use stencilscope::recorded::{self, FoundLight, LightEvidence, PassSpace, SeenSurfaces};
use stencilscope::scene::Object;
use stencilscope::session::{FrameSource, RunFrame, Session};

/// The edges of a mesh that are of one more triangle that faces a direction one way round than the other, with their ends in
/// view space.
fn silhouette(object: &Object, towards: DVec3) -> Vec<[DVec3; 2]> {
    let places = object.world_positions();
    let mut edges: BTreeMap<[[u64; 3]; 2], i32> = BTreeMap::new();
    for triangle in object.mesh.triangles() {
        let corners = triangle.map(|corner| places[corner as usize]);
        if (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(towards) <= 0.0 {
            continue;
        }
        for index in 0..3 {
            let [from, to] = [corners[index], corners[(index + 1) % 3]].map(|at| at.to_array().map(f64::to_bits));
            *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    let place = |bits: [u64; 3]| DVec3::from_array(bits.map(f64::from_bits));
    let ends = |([low, high], count): ([[u64; 3]; 2], i32)| {
        let [from, to] = if count > 0 { [low, high] } else { [high, low] }.map(place);
        std::iter::repeat_n([from, to], count.unsigned_abs() as usize)
    };
    edges.into_iter().flat_map(ends).collect()
}

/// Replaces the frame's volumes by ones of a draw for each silhouette edge, of each caster away from its own direction.
fn with_directions(plan: &mut FramePlan, casters: &[(&Object, DVec3)], length: f64) {
    let index = plan.passes.iter().position(|pass| pass.name == "volumes").expect("volumes");
    let space = PassSpace::new(plan, &plan.passes[index]);
    let like = plan.passes[index].draws.iter().find(|draw| draw.part.is_of_volume()).expect("a volume").clone();
    let mut draws = Vec::new();
    for (object, towards) in casters {
        for [from, to] in silhouette(object, *towards) {
            let corners = [from, to, from - *towards * length, to - *towards * length];
            let vertices = corners.map(|place| space.clip(place.extend(1.0))).to_vec();
            let mesh = MeshId(plan.meshes.len());
            plan.meshes.push(DrawMesh::of_positions("edge", vertices, vec![1, 0, 2, 1, 2, 3]));
            let name = format!("edge {}", draws.len());
            draws.push(Draw {
                part: DrawPart::Side,
                mesh,
                triangles: 0..2,
                base_vertex: 0,
                pieces: None,
                name,
                ..like.clone()
            });
        }
    }
    plan.passes[index].draws = draws;
}

/// The frame with volumes that reach `length` times as far as its casters are from the eye, run by us as if its program had
/// drawn them, what is found of its light, and the direction towards each caster's.
fn run(session: &mut Session, length: f64, directions: &[DVec3]) -> (RunFrame, FoundLight, Vec<(String, DVec3)>) {
    let frame = frame_of("ogre");
    let scene = frame.scene().expect("a scene");
    let mut plan = (*frame.plan).clone();
    let casters: Vec<&Object> = scene.objects.iter().filter(|object| object.casts && object.visible).collect();
    let of_caster = |index: usize| directions[index % directions.len()];
    let with_direction = casters.iter().enumerate().map(|(index, object)| (*object, of_caster(index)));
    // A sheet that faces away from its light has no edge to begin at.
    let with_direction = with_direction.filter(|(object, towards)| !silhouette(object, *towards).is_empty());
    let with_direction: Vec<(&Object, DVec3)> = with_direction.collect();
    assert!(with_direction.len() >= 2, "{}", with_direction.len());
    let far = casters.iter().flat_map(|object| object.world_positions()).map(DVec3::length).fold(0.0, f64::max);
    with_directions(&mut plan, &with_direction, length * far);
    let expected = with_direction.iter().map(|(object, towards)| (object.name.clone(), *towards)).collect();
    let found = recorded::light(&plan, LightId(0)).expect("a light");
    let steps = session.capture_plan(scene, &plan).expect("a capture").steps;
    let mut capture = Capture { steps, ..(*frame.capture).clone() };
    capture.lights[0].position = found.position;
    capture.lights[0].shadow = recorded::labels(&plan, &capture, LightId(0), &SeenSurfaces::of(&plan, &capture));
    let scene = recorded::scene(&plan, capture.camera, "directions", &[found]);
    let source = Some(Arc::new(FrameSource { scene, request: None }));
    (RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source }, found, expected)
}

fn directions(frame: &RunFrame) -> [DVec3; 3] {
    // Round the light that the frame has, so that shadows fall where they are seen.
    let light = frame.capture.lights[0].position;
    let middle = DVec3::new(0.0, 0.0, -10.0);
    let towards = (light.truncate() - middle * light.w).normalize();
    let beside = towards.any_orthonormal_vector();
    [towards, (towards + 0.3 * beside).normalize(), (towards - 0.4 * towards.cross(beside)).normalize()]
}

#[test]
fn a_light_of_its_own_is_found_for_each_caster_and_no_pixel_is_wrong() {
    let mut session = session();
    let directions = directions(&frame_of("ogre"));
    let (frame, found, expected) = run(&mut session, 1.0, &directions);
    let LightEvidence::EdgesOfCasters { agree, of, casters } = found.evidence else {
        panic!("one light: {found:?}");
    };
    let scene = frame.scene().expect("a scene");
    let own: Vec<_> = scene.objects.iter().map(|object| (&object.name, object.casts, object.light_position)).collect();
    assert!(agree * 3 > of && casters == expected.len(), "{found:?}, {own:?}, not {expected:?}");
    for (name, towards) in expected {
        let object = scene.objects.iter().find(|object| object.name == name).expect("the caster");
        let DVec4 { w, .. } = object.light_position.expect("a light of its own");
        let apart = object.light_position.expect("a light").truncate().normalize().cross(towards).length();
        assert!(w == 0.0 && apart < 1e-4 && object.casts, "{name}: {apart}");
    }
    let diagnosis = session.diagnose_recorded(&frame, &Progress::default()).expect("a diagnosis");
    println!("{}", diagnosis.to_text());
    assert_eq!(diagnosis.wrong(), 0, "{}", diagnosis.to_text());
    assert!(diagnosis.lights[0].error.compared > 20_000, "{}", diagnosis.to_text());
}
