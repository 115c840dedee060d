//! A light of its own for each caster, as game engines give each model: OGRE's frame, its volumes made anew one silhouette
//! edge a draw, of finite length, each caster's along a direction of its own.

use super::convert::frame_of;
use crate::common::session;
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;
use stencilscope::capture::Capture;
use stencilscope::capture::disk::{FolderContents, read_whole, write};
use stencilscope::plan::{Blob, Draw, DrawMesh, DrawPart, FramePlan, LightId, MeshId};
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

/// What is found in a frame run by us as if its program had drawn it.
struct FoundFrame {
    frame: RunFrame,
    light: FoundLight,
}

impl FoundFrame {
    fn object(&self, name: &str) -> &Object {
        let scene = self.frame.scene().expect("a scene");
        scene.objects.iter().find(|object| object.name == name).expect("the caster")
    }

    /// The frame as a folder on disk has it.
    fn reopened(&self) -> FoundFrame {
        let parent = tempfile::tempdir().expect("a folder");
        let folder = parent.path().join("frame");
        let RunFrame { capture, plan, .. } = &self.frame;
        let contents = FolderContents { capture, plan: Some(plan), scene: Some(self.frame.scene().expect("a scene")) };
        write(contents, &folder, false).expect("written");
        let frame = RunFrame::from_folder(read_whole(&folder).expect("read")).expect("a whole frame");
        let own = |frame: &RunFrame| {
            let objects = frame.scene().expect("a scene").objects.iter();
            objects.map(|object| (object.name.clone(), object.light_positions.clone())).collect::<Vec<_>>()
        };
        assert_eq!(own(&frame), own(&self.frame));
        FoundFrame { frame, light: self.light }
    }

    fn assert_no_pixel_is_wrong(&self, session: &mut Session) {
        let diagnosis = session.diagnose_recorded(&self.frame, &Progress::default()).expect("a diagnosis");
        assert_eq!(diagnosis.wrong(), 0, "{}", diagnosis.to_text());
        assert!(diagnosis.lights[0].error.compared > 20_000, "{}", diagnosis.to_text());
    }
}

/// OGRE's frame without volumes, its casters that have a silhouette in a direction, and the directions: the first is its own
/// light's, the others are round it, so that shadows fall where they are seen.
struct Stage {
    frame: RunFrame,
    directions: [DVec3; 3],
}

impl Stage {
    fn new() -> Stage {
        let frame = frame_of("ogre");
        let light = frame.capture.lights[0].position;
        let middle = DVec3::new(0.0, 0.0, -10.0);
        let towards = (light.truncate() - middle * light.w).normalize();
        let beside = towards.any_orthonormal_vector();
        let others = [towards + 0.3 * beside, towards - 0.4 * towards.cross(beside)].map(DVec3::normalize);
        Stage { frame, directions: [towards, others[0], others[1]] }
    }

    /// The casters, the one with the most edges first. A sheet that faces away from its light has no edge to begin at.
    fn casters(&self) -> Vec<&Object> {
        let scene = self.frame.scene().expect("a scene");
        let edges = |object: &Object| self.directions.map(|towards| silhouette(object, towards).len());
        let mut casters: Vec<&Object> = scene.objects.iter().filter(|object| object.casts && object.visible).collect();
        casters.retain(|object| edges(object).iter().all(|edges| *edges > 0));
        casters.sort_by_key(|object| std::cmp::Reverse(edges(object)));
        casters
    }

    /// The frame with volumes of these casters, each away from a direction, that reach `length` times as far as casters are
    /// from the eye.
    fn plan(&self, length: f64, casters: &[(&Object, DVec3)]) -> FramePlan {
        let mut plan = (*self.frame.plan).clone();
        let places = casters.iter().flat_map(|(object, _)| object.world_positions());
        with_directions(&mut plan, casters, length * places.map(DVec3::length).fold(0.0, f64::max));
        plan
    }

    /// Runs the frame of [`Stage::plan`].
    fn run(&self, session: &mut Session, length: f64, casters: &[(&Object, DVec3)]) -> FoundFrame {
        let plan = self.plan(length, casters);
        let light = recorded::light(&plan, LightId(0)).expect("a light");
        let scene = self.frame.scene().expect("a scene");
        let steps = session.capture_plan(scene, &plan).expect("a capture").steps;
        let mut capture = Capture { steps, ..(*self.frame.capture).clone() };
        capture.lights[0].position = light.position;
        capture.lights[0].shadow = recorded::labels(&plan, &capture, LightId(0), &SeenSurfaces::of(&plan, &capture));
        let scene = recorded::scene(&plan, capture.camera, "directions", &[light]);
        capture.lights[0].of_casters = recorded::lights_of_casters(&scene, 0);
        let source = Some(Arc::new(FrameSource { scene, request: None }));
        FoundFrame { frame: RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source }, light }
    }
}

/// Each caster with one of the directions, in turn.
fn in_turn<'a>(casters: &[&'a Object], directions: &[DVec3]) -> Vec<(&'a Object, DVec3)> {
    casters.iter().copied().zip(directions.iter().copied().cycle()).collect()
}

/// How many silhouette edges all of these casters have, and the last.
fn edges_of(casters: &[(&Object, DVec3)]) -> (usize, usize) {
    let edges: Vec<usize> = casters.iter().map(|(object, towards)| silhouette(object, *towards).len()).collect();
    (edges.iter().sum(), *edges.last().expect("a caster"))
}

#[test]
fn a_light_of_its_own_is_found_for_each_caster_and_no_pixel_is_wrong() {
    let mut session = session();
    let stage = Stage::new();
    for length in [0.5, 1.0, 20.0] {
        let casters = in_turn(&stage.casters(), &stage.directions);
        assert!(casters.len() >= 3, "{}", casters.len());
        let found = stage.run(&mut session, length, &casters);
        let LightEvidence::EdgesOfCasters { agree, of, places, casters: lit, without } = found.light.evidence else {
            panic!("one light: {:?}", found.light);
        };
        assert!(agree == of && of > 100, "{:?}", found.light);
        assert_eq!((places, lit, without), (3, casters.len(), 0), "{:?}", found.light);
        for (caster, towards) in casters {
            let object = found.object(&caster.name);
            let own = object.light_positions[&0];
            let apart = own.truncate().normalize().cross(towards).length();
            assert!(own.w == 0.0 && apart < 1e-4 && object.casts, "{}: {apart}", caster.name);
        }
        // Volumes that end before the floor darken less than their light does.
        if length >= 1.0 {
            found.assert_no_pixel_is_wrong(&mut session);
            found.reopened().assert_no_pixel_is_wrong(&mut session);
        }
    }
}

#[test]
fn casters_of_one_light_have_it_in_one_place() {
    let mut session = session();
    let stage = Stage::new();
    let casters = stage.casters();
    for count in [1, casters.len()] {
        let found = stage.run(&mut session, 1.0, &in_turn(&casters[..count], &stage.directions[..1]));
        let apart = found.light.position.truncate().normalize().cross(stage.directions[0]).length();
        assert!(matches!(found.light.evidence, LightEvidence::Edges { .. }), "{count}: {:?}", found.light);
        assert!(found.light.position.w == 0.0 && apart < 1e-4, "{count}: {apart}");
        let scene = found.frame.scene().expect("a scene");
        assert!(scene.objects.iter().all(|object| object.light_positions.is_empty()), "{count}");
        let casting: Vec<&str> = scene.objects.iter().filter(|one| one.casts).map(|one| one.name.as_str()).collect();
        assert_eq!(casting.len(), count, "{casting:?}");
        found.assert_no_pixel_is_wrong(&mut session);
    }
}

/// A small caster's light of its own is known, and told: whether it is meant, only the program's author knows.
#[test]
fn a_small_caster_whose_volume_alone_runs_elsewhere_has_a_light_of_its_own() {
    let mut session = session();
    let stage = Stage::new();
    let mut casters = in_turn(&stage.casters(), &stage.directions[..1]);
    casters.last_mut().expect("a caster").1 = stage.directions[1];
    let (all, of_last) = edges_of(&casters);
    assert!(of_last * 10 < all, "{of_last} of {all}");
    let found = stage.run(&mut session, 1.0, &casters);
    let LightEvidence::EdgesOfCasters { places: 2, .. } = found.light.evidence else { panic!("{:?}", found.light) };
    assert!(found.light.limits(LightId(0))[0].starts_with("light 1 is in 2 places"));
    for (caster, towards) in casters {
        let own = found.object(&caster.name).light_positions[&0];
        assert!(own.truncate().normalize().distance(towards) < 1e-4, "{}: {own}", caster.name);
    }
    found.assert_no_pixel_is_wrong(&mut session);
}

/// Moves the far corners of the last volumes, each elsewhere.
fn bend(plan: &mut FramePlan, volumes: usize) {
    let first = plan.meshes.len() - volumes;
    for (index, mesh) in plan.meshes.iter_mut().enumerate().skip(first) {
        let mut vertices = mesh.vertices.data().to_vec();
        for (corner, vertex) in vertices.iter_mut().enumerate().skip(2) {
            let turn = (index * 2 + corner) as f32;
            vertex[0] += (turn * 1.7).sin() * vertex[3];
            vertex[1] += (turn * 2.9).cos() * vertex[3];
        }
        mesh.vertices = Blob::new(vertices);
    }
}

#[test]
fn a_caster_whose_volume_runs_away_from_nowhere_is_told() {
    let stage = Stage::new();
    let casters = in_turn(&stage.casters(), &stage.directions);
    let (all, of_last) = edges_of(&casters);
    assert!(of_last * 10 < all, "{of_last} of {all}");
    let mut bent = stage.plan(1.0, &casters);
    bend(&mut bent, of_last);
    let light = recorded::light(&bent, LightId(0)).expect("a light");
    let LightEvidence::EdgesOfCasters { casters: lit, without, .. } = light.evidence else { panic!("{light:?}") };
    assert_eq!((lit, without), (casters.len() - 1, 1));
    let limits = light.limits(LightId(0));
    assert_eq!(limits[1], "1 caster has no light that is known: what it darkens counts as wrong", "{limits:?}");
    assert!(limits[0].starts_with("light 1 is in 2 places"), "{limits:?}");
}
