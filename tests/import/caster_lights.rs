//! A light of its own for each caster, as game engines give each model: OGRE's frame, its volumes made anew one silhouette
//! edge a draw, of finite length, each caster's away from a light of its own.

use super::convert::frame_of;
use crate::common::session;
use glam::{DVec3, DVec4};
use std::collections::BTreeMap;
use std::sync::Arc;
use stencilscope::capture::Capture;
use stencilscope::capture::disk::{FolderContents, read_whole, write};
use stencilscope::diagnosis::{Cause, Proof};
use stencilscope::plan::{Blob, Draw, DrawMesh, DrawPart, FramePlan, LightId, MeshId};
use stencilscope::progress::Progress;
use stencilscope::recorded::{self, FoundLight, LightEvidence, PassSpace, SeenSurfaces};
use stencilscope::scene::Object;
use stencilscope::session::{FrameSource, RunFrame, Session};

/// Where a light is from a place, both in view space, as a direction of unit length.
fn towards(light: DVec4, place: DVec3) -> DVec3 {
    (light.truncate() - place * light.w).normalize()
}

/// The triangles of an object that face a light, in view space.
fn lit_triangles(object: &Object, light: DVec4) -> Vec<[DVec3; 3]> {
    let places = object.world_positions();
    let triangles = object.mesh.triangles().iter().map(|triangle| triangle.map(|corner| places[corner as usize]));
    let is_lit = |[a, b, c]: &[DVec3; 3]| (b - a).cross(c - a).dot(towards(light, *a)) > 0.0;
    triangles.filter(is_lit).collect()
}

/// The edges of a mesh that are of one more triangle that faces a light one way round than the other, with their ends in
/// view space.
fn silhouette(object: &Object, light: DVec4) -> Vec<[DVec3; 2]> {
    let mut edges: BTreeMap<[[u64; 3]; 2], i32> = BTreeMap::new();
    for corners in lit_triangles(object, light) {
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

/// How volumes are drawn.
#[derive(Clone, Copy)]
struct VolumeShape<'a> {
    /// How far they reach, by how far the farthest corner of a caster is from the eye.
    length: f64,
    /// The names of the casters whose volumes have caps at both ends.
    capped: &'a [&'a str],
}

impl VolumeShape<'_> {
    /// Sides alone.
    fn open(length: f64) -> Self {
        VolumeShape { length, capped: &[] }
    }
}

/// Replaces the frame's volumes by ones of a draw for each silhouette edge and cap, of each caster away from its own light.
fn with_lights(plan: &mut FramePlan, casters: &[(&Object, DVec4)], shape: VolumeShape) {
    let index = plan.passes.iter().position(|pass| pass.name == "volumes").expect("volumes");
    let space = PassSpace::new(plan, &plan.passes[index]);
    let like = plan.passes[index].draws.iter().find(|draw| draw.part.is_of_volume()).expect("a volume").clone();
    let places = casters.iter().flat_map(|(object, _)| object.world_positions());
    let length = shape.length * places.map(DVec3::length).fold(0.0, f64::max);
    let mut draws = Vec::new();
    let mut draw = |corners: Vec<DVec3>, indices: Vec<u32>| {
        let vertices = corners.into_iter().map(|place| space.clip(place.extend(1.0))).collect();
        let mesh = MeshId(plan.meshes.len());
        let triangles = 0..indices.len() as u32 / 3;
        plan.meshes.push(DrawMesh::of_positions("part", vertices, indices));
        let name = format!("part {}", draws.len());
        draws.push(Draw { part: DrawPart::Side, mesh, triangles, base_vertex: 0, pieces: None, name, ..like.clone() });
    };
    for (object, light) in casters {
        let far = |at: DVec3| at - towards(*light, at) * length;
        for [from, to] in silhouette(object, *light) {
            draw(vec![from, to, far(from), far(to)], vec![1, 0, 2, 1, 2, 3]);
        }
        let lit = lit_triangles(object, *light).concat();
        let all = 0..lit.len() as u32;
        if shape.capped.contains(&object.name.as_str()) {
            draw(lit.clone(), all.clone().collect());
            draw(lit.into_iter().map(far).collect(), all.rev().collect());
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

/// OGRE's frame without volumes, and places of lights for its casters: the first is where its own light is, the others are round
/// it, so that shadows fall where they are seen.
struct Stage {
    frame: RunFrame,
    lights: [DVec4; 3],
}

impl Stage {
    /// With lights that are directions.
    fn new() -> Stage {
        let frame = frame_of("ogre");
        let light = frame.capture.lights[0].position;
        let first = towards(light, Stage::MIDDLE);
        let beside = first.any_orthonormal_vector();
        let others = [first + 0.3 * beside, first - 0.4 * first.cross(beside)];
        Stage { frame, lights: [first, others[0], others[1]].map(|towards| towards.normalize().extend(0.0)) }
    }

    /// With lights that are a few metres from the casters.
    fn near() -> Stage {
        let stage = Stage::new();
        let place = |light: DVec4| (Stage::MIDDLE + 12.0 * light.truncate()).extend(1.0);
        Stage { lights: stage.lights.map(place), ..stage }
    }

    /// Amid the casters.
    const MIDDLE: DVec3 = DVec3::new(0.0, 0.0, -10.0);

    /// The casters, the one with the most edges first. A sheet that faces away from its light has no edge to begin at.
    fn casters(&self) -> Vec<&Object> {
        let scene = self.frame.scene().expect("a scene");
        let edges = |object: &Object| self.lights.map(|light| silhouette(object, light).len());
        let mut casters: Vec<&Object> = scene.objects.iter().filter(|object| object.casts && object.visible).collect();
        casters.retain(|object| edges(object).iter().all(|edges| *edges > 0));
        casters.sort_by_key(|object| std::cmp::Reverse(edges(object)));
        casters
    }

    /// The frame with volumes of these casters, each away from a light.
    fn plan(&self, shape: VolumeShape, casters: &[(&Object, DVec4)]) -> FramePlan {
        let mut plan = (*self.frame.plan).clone();
        with_lights(&mut plan, casters, shape);
        plan
    }

    /// Runs the frame of [`Stage::plan`].
    fn run(&self, session: &mut Session, shape: VolumeShape, casters: &[(&Object, DVec4)]) -> FoundFrame {
        self.run_plan(session, self.plan(shape, casters))
    }

    fn run_plan(&self, session: &mut Session, plan: FramePlan) -> FoundFrame {
        let light = recorded::light(&plan, LightId(0)).expect("a light");
        let scene = self.frame.scene().expect("a scene");
        let steps = session.capture_plan(scene, &plan).expect("a capture").steps;
        let mut capture = Capture { steps, ..(*self.frame.capture).clone() };
        capture.lights[0].position = light.position;
        capture.lights[0].shadow = recorded::labels(&plan, &capture, LightId(0), &SeenSurfaces::of(&plan, &capture));
        let scene = recorded::scene(&plan, capture.camera, "lights", &[light]);
        capture.lights[0].of_casters = recorded::lights_of_casters(&scene, 0);
        let source = Some(Arc::new(FrameSource { scene, request: None }));
        FoundFrame { frame: RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source }, light }
    }
}

/// How far a light is from where it should be: the sine of the angle between directions, or metres for each metre of distance.
fn apart(found: DVec4, light: DVec4) -> f64 {
    match [found.w, light.w] {
        [0.0, 0.0] if found.dot(light) > 0.0 => found.truncate().normalize().cross(light.truncate()).length(),
        [1.0, 1.0] => (found - light).length() / light.truncate().distance(Stage::MIDDLE),
        _ => f64::INFINITY,
    }
}

/// Each caster with one of the lights, in turn.
fn in_turn<'a>(casters: &[&'a Object], lights: &[DVec4]) -> Vec<(&'a Object, DVec4)> {
    casters.iter().copied().zip(lights.iter().copied().cycle()).collect()
}

/// How many silhouette edges all of these casters have, and the last.
fn edges_of(casters: &[(&Object, DVec4)]) -> (usize, usize) {
    let edges: Vec<usize> = casters.iter().map(|(object, light)| silhouette(object, *light).len()).collect();
    (edges.iter().sum(), *edges.last().expect("a caster"))
}

impl FoundFrame {
    /// Holds that each caster has found the light that its volume was made for; returns how many triangles of volumes do not tell
    /// it.
    fn assert_lights_are(&self, casters: &[(&Object, DVec4)]) -> usize {
        let LightEvidence::EdgesOfCasters { agree, of, places, casters: lit, unseen, without } = self.light.evidence
        else {
            panic!("one light: {:?}", self.light);
        };
        assert!(agree > 100 && agree <= of, "{:?}", self.light);
        assert_eq!((places, lit, unseen, without), (3, casters.len(), 0, 0), "{:?}", self.light);
        for (caster, light) in casters {
            let object = self.object(&caster.name);
            let own = object.light_positions[&0];
            let apart = apart(own, *light);
            assert!(apart < 1e-3 && object.casts, "{}: {apart}, {own} of {light}", caster.name);
        }
        of - agree
    }
}

#[test]
fn a_light_of_its_own_is_found_for_each_caster_and_no_pixel_is_wrong() {
    let mut session = session();
    for stage in [Stage::new(), Stage::near()] {
        for length in [0.5, 1.0, 20.0] {
            let casters = in_turn(&stage.casters(), &stage.lights);
            assert!(casters.len() >= 3, "{}", casters.len());
            let found = stage.run(&mut session, VolumeShape::open(length), &casters);
            assert_eq!(found.assert_lights_are(&casters), 0);
            // Volumes that end before the floor darken less than their light does.
            if length >= 1.0 {
                found.assert_no_pixel_is_wrong(&mut session);
                found.reopened().assert_no_pixel_is_wrong(&mut session);
            }
        }
    }
}

#[test]
fn volumes_with_caps_tell_the_light_of_each_caster_too() {
    let mut session = session();
    for stage in [Stage::new(), Stage::near()] {
        let casters = in_turn(&stage.casters(), &stage.lights);
        // A near cap lies in its caster's own surface, which is drawn with other rounding: which is nearer is chance.
        let names: Vec<&str> = casters.iter().map(|(caster, _)| caster.name.as_str()).collect();
        let shape = VolumeShape { length: 1.0, capped: &names };
        assert!(stage.run(&mut session, shape, &casters).assert_lights_are(&casters) > 0);
    }
}

#[test]
fn a_caster_that_the_picture_does_not_show_has_a_light_of_its_own_too() {
    let mut session = session();
    for stage in [Stage::new(), Stage::near()] {
        let casters = in_turn(&stage.casters(), &stage.lights);
        let (hidden, light) = casters[0];
        // Where it is not drawn, nothing but its cap closes its volume.
        let mut plan = stage.plan(VolumeShape { length: 1.0, capped: &[&hidden.name] }, &casters);
        // Each pass draws it again, under a name of its own.
        let mut draws = plan.passes.iter().flat_map(|pass| &pass.draws);
        let mesh = plan.meshes[draws.find(|draw| draw.name == hidden.name).expect("its draw").mesh.0].vertices.clone();
        let meshes = &plan.meshes;
        for pass in &mut plan.passes {
            pass.draws.retain(|draw| meshes[draw.mesh.0].vertices.data() != mesh.data());
        }
        let found = stage.run_plan(&mut session, plan);
        let LightEvidence::EdgesOfCasters { places: 3, casters: lit, unseen: 1, without: 0, .. } = found.light.evidence
        else {
            panic!("{:?}", found.light);
        };
        assert_eq!(lit, casters.len() - 1);
        let limits = found.light.limits(LightId(0));
        let told = format!("{lit} casters and 1 that begins at no surface of the picture");
        assert!(limits[0].contains(&told), "{limits:?}");
        let scene = found.frame.scene().expect("a scene");
        let unseen = scene.objects.iter().find(|object| object.casts && !object.visible).expect("the hidden caster");
        let apart = apart(unseen.light_positions[&0], light);
        assert!(apart < 1e-3, "{apart}");
        found.assert_no_pixel_is_wrong(&mut session);
    }
}

/// Draws an object in two, in each pass that draws it: what is right of its middle in the picture by a draw with another name.
fn draw_in_two(plan: &mut FramePlan, object: &str, right: &str) {
    let mut drawn = plan.passes.iter().flat_map(|pass| &pass.draws);
    let of_name = drawn.find(|draw| draw.name == object).expect("its draw").mesh;
    let vertices = plan.meshes[of_name.0].vertices.clone();
    let across = |corner: u32| vertices.data()[corner as usize][0] / vertices.data()[corner as usize][3];
    let middle = |triangle: &[u32; 3]| triangle.iter().map(|corner| across(*corner)).sum::<f32>();
    for index in 0..plan.passes.len() {
        // Each pass draws it under a name of its own.
        let is_it = |draw: &Draw| plan.meshes[draw.mesh.0].vertices.data() == vertices.data();
        let Some(at) = plan.passes[index].draws.iter().position(is_it) else { continue };
        let whole = plan.passes[index].draws[at].clone();
        let mut triangles = plan.meshes[whole.mesh.0].indices.data().as_chunks::<3>().0.to_vec();
        triangles.sort_by(|one, other| middle(one).total_cmp(&middle(other)));
        let halves = triangles.split_at(triangles.len() / 2);
        let names = [whole.name.clone(), right.to_owned()];
        let draws = [halves.0, halves.1].into_iter().zip(names).map(|(triangles, name)| {
            let mesh = MeshId(plan.meshes.len());
            let indices = Blob::new(triangles.as_flattened().to_vec());
            plan.meshes.push(DrawMesh { indices, ..plan.meshes[whole.mesh.0].clone() });
            Draw { mesh, triangles: 0..triangles.len() as u32, name, ..whole.clone() }
        });
        let draws: Vec<Draw> = draws.collect();
        plan.passes[index].draws.splice(at..=at, draws);
    }
}

/// Game engines draw each material of a model by itself, and a volume goes round all of them.
#[test]
fn objects_that_share_corners_cast_one_volume_together() {
    let mut session = session();
    for stage in [Stage::new(), Stage::near()] {
        for lights in [&stage.lights[..], &stage.lights[..1]] {
            let casters = in_turn(&stage.casters(), lights);
            let (whole, light) = casters[0];
            let mut plan = stage.plan(VolumeShape::open(1.0), &casters);
            draw_in_two(&mut plan, &whole.name, "right");
            let found = stage.run_plan(&mut session, plan);
            for half in [&whole.name, "right"] {
                let half = found.object(half);
                assert!(half.casts, "{}", half.name);
                match half.light_positions.get(&0) {
                    Some(own) => assert!(apart(*own, light) < 1e-3, "{own} of {light}"),
                    None => assert_eq!(lights.len(), 1),
                }
            }
            found.assert_no_pixel_is_wrong(&mut session);
        }
    }
}

/// Leaves out the triangles of an object that face a light and are right of its middle, in each pass that draws it.
fn cut_hole(plan: &mut FramePlan, object: &Object, light: DVec4) {
    let mut drawn = plan.passes.iter().flat_map(|pass| &pass.draws);
    let of_name = drawn.find(|draw| draw.name == object.name).expect("its draw").mesh;
    let vertices = plan.meshes[of_name.0].vertices.clone();
    let corners = object.world_positions();
    let right_of = corners.iter().map(|place| place.x).sum::<f64>() / corners.len() as f64;
    for pass in 0..plan.passes.len() {
        let space = PassSpace::new(plan, &plan.passes[pass]);
        for draw in 0..plan.passes[pass].draws.len() {
            let drawn = plan.passes[pass].draws[draw].clone();
            if plan.meshes[drawn.mesh.0].vertices.data() != vertices.data() {
                continue;
            }
            let places: Vec<DVec3> =
                space.places(plan, &drawn).into_iter().map(|place| place.expect("a place").truncate()).collect();
            let is_left = |triangle: &&[u32; 3]| {
                let [a, b, c] = triangle.map(|corner| places[corner as usize]);
                let is_lit = (b - a).cross(c - a).dot(towards(light, a)) > 0.0;
                !is_lit || (a + b + c).x / 3.0 < right_of
            };
            let whole = plan.meshes[drawn.mesh.0].clone();
            let left = whole.indices.data().as_chunks::<3>().0.iter().filter(is_left);
            let indices: Vec<u32> = left.flatten().copied().collect();
            plan.passes[pass].draws[draw].triangles = 0..indices.len() as u32 / 3;
            plan.passes[pass].draws[draw].mesh = MeshId(plan.meshes.len());
            plan.meshes.push(DrawMesh { indices: Blob::new(indices), ..whole });
        }
    }
}

/// Game engines' volumes are of the triangles on one side alone: through a hole light meets the backs of others.
#[test]
fn light_that_goes_through_a_mesh_with_a_hole_is_explained() {
    let mut session = session();
    let stage = Stage::new();
    let light = stage.lights[0];
    let whole = stage.casters()[0].clone();
    let mut plan = (*stage.frame.plan).clone();
    cut_hole(&mut plan, &whole, light);
    let surfaces = recorded::scene(&plan, stage.frame.capture.camera, "surfaces", &[]);
    let open = surfaces.objects.iter().find(|object| object.name == whole.name).expect("the caster");
    assert!(open.mesh.triangles().len() < whole.mesh.triangles().len());
    let casters: Vec<(&Object, DVec4)> =
        stage.casters()[1..].iter().copied().chain([open]).map(|caster| (caster, light)).collect();
    with_lights(&mut plan, &casters, VolumeShape::open(1.0));
    let found = stage.run_plan(&mut session, plan);
    let diagnosis = session.diagnose_recorded(&found.frame, &Progress::default()).expect("a diagnosis");
    let text = diagnosis.to_text();
    let error = diagnosis.lights[0].error;
    assert!(error.missing_shadow > 1000 && error.wrong() == error.missing_shadow, "{text}");
    let first = diagnosis.causes.first().expect("a cause");
    assert!(first.cause == Cause::OpenMesh && first.proof != Proof::NotIt, "{text}");
    // Between the frame's volumes, which end, and those of the plan a pixel may be in neither, but for rounding.
    assert!(first.pixels_left * 1000 < error.missing_shadow, "{text}");
    assert!(first.evidence.sentence.starts_with("of meshes with holes no volume begins at "), "{text}");
}

#[test]
fn casters_of_one_light_have_it_in_one_place() {
    let mut session = session();
    for stage in [Stage::new(), Stage::near()] {
        let casters = stage.casters();
        for count in [1, casters.len()] {
            let one_light = in_turn(&casters[..count], &stage.lights[..1]);
            let found = stage.run(&mut session, VolumeShape::open(1.0), &one_light);
            let apart = apart(found.light.position, stage.lights[0]);
            assert!(matches!(found.light.evidence, LightEvidence::Edges { .. }), "{count}: {:?}", found.light);
            assert!(apart < 1e-3, "{count}: {apart}, {:?}", found.light);
            let scene = found.frame.scene().expect("a scene");
            assert!(scene.objects.iter().all(|object| object.light_positions.is_empty()), "{count}");
            let casting = scene.objects.iter().filter(|one| one.casts);
            let casting: Vec<&str> = casting.map(|one| one.name.as_str()).collect();
            assert_eq!(casting.len(), count, "{casting:?}");
            found.assert_no_pixel_is_wrong(&mut session);
        }
    }
}

/// A small caster's light of its own is known, and told: whether it is meant, only the program's author knows.
#[test]
fn a_small_caster_whose_volume_alone_runs_elsewhere_has_a_light_of_its_own() {
    let mut session = session();
    let stage = Stage::new();
    let mut casters = in_turn(&stage.casters(), &stage.lights[..1]);
    casters.last_mut().expect("a caster").1 = stage.lights[1];
    let (all, of_last) = edges_of(&casters);
    assert!(of_last * 10 < all, "{of_last} of {all}");
    let found = stage.run(&mut session, VolumeShape::open(1.0), &casters);
    let LightEvidence::EdgesOfCasters { places: 2, .. } = found.light.evidence else { panic!("{:?}", found.light) };
    assert!(found.light.limits(LightId(0))[0].starts_with("light 1 is in 2 places"));
    for (caster, light) in casters {
        let own = found.object(&caster.name).light_positions[&0];
        assert!(apart(own, light) < 1e-4, "{}: {own}", caster.name);
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
    let casters = in_turn(&stage.casters(), &stage.lights);
    let (all, of_last) = edges_of(&casters);
    assert!(of_last * 10 < all, "{of_last} of {all}");
    let mut bent = stage.plan(VolumeShape::open(1.0), &casters);
    bend(&mut bent, of_last);
    let light = recorded::light(&bent, LightId(0)).expect("a light");
    let LightEvidence::EdgesOfCasters { casters: lit, without, .. } = light.evidence else { panic!("{light:?}") };
    assert_eq!((lit, without), (casters.len() - 1, 1));
    let limits = light.limits(LightId(0));
    assert_eq!(limits[1], "1 caster has no light that is known: what it darkens counts as wrong", "{limits:?}");
    assert!(limits[0].starts_with("light 1 is in 2 places"), "{limits:?}");
}
