//! Plans as data: their text, their checks, and shaders, all without a GPU.

use crate::common::{choice, cuboid, from_above, opened, square};
use glam::Vec3;
use std::sync::Arc;
use stencilscope::geometry::GeometryCache;
use stencilscope::plan::{Decision, Draw, DrawPart, FramePlan, MeshId, lint};
use stencilscope::scene::{Light, Material, MeshBuilder, MeshGroup, Scene, Shading};
use stencilscope::technique::{self, Choice, PlanError, PlanRequest, Technique};
use wgpu::StencilOperation;

fn plan_of(scene: &Scene, technique: Technique) -> Result<FramePlan, PlanError> {
    plan_with(scene, technique, &mut GeometryCache::default())
}

fn plan_with(scene: &Scene, technique: Technique, cache: &mut GeometryCache) -> Result<FramePlan, PlanError> {
    technique::plan(PlanRequest { scene, size: [64, 48], choice: &Choice::new(technique), cache, map_camera: None })
}

fn scene() -> Scene {
    from_above(vec![square("caster", 2.0, 1.0)])
}

#[test]
fn every_technique_makes_a_plan_without_a_broken_rule() {
    for technique in Technique::ALL {
        let plan = plan_of(&scene(), technique).expect("a plan");
        assert_eq!(lint::check(&plan), [], "{technique:?}");
        assert!(plan.passes.len() >= 3, "ambient, light and mask: {technique:?}");
        assert!(plan.passes.iter().all(|pass| pass.purpose.len() > 20), "every pass explains itself");
    }
}

/// A bias of nothing is 0 whichever way depth runs.
#[test]
fn no_plan_prints_a_zero_with_a_sign() {
    for settings in [&[("bias-slope", "0"), ("bias-constant", "0")][..], &[("depth", "standard-infinite")]] {
        let choice = choice(Technique::ShadowMap, settings);
        let (scene, cache) = (scene(), &mut GeometryCache::default());
        let request = PlanRequest { scene: &scene, size: [64, 48], choice: &choice, cache, map_camera: None };
        let text = technique::plan(request).expect("a plan").to_string();
        let signed = text.split([' ', ',', '(', ')', '\n']).find(|word| ["-0", "-0.0"].contains(word));
        assert_eq!(signed, None, "{settings:?}\n{text}");
        assert!(text.contains(if settings.len() > 1 { "technique" } else { "slopes" }), "{text}");
    }
}

#[test]
fn a_plan_is_a_pure_function_and_so_is_its_text() {
    for technique in Technique::ALL {
        let [a, b] = [0, 1].map(|_| plan_of(&scene(), technique).expect("a plan"));
        assert_eq!(a, b);
        assert_eq!(a.to_string(), b.to_string());
    }
}

/// Whatever is other than in the plan before.
#[test]
fn a_full_cache_gives_the_plan_of_an_empty_one() {
    let cuboid = cuboid("caster", [-1.0, 2.0, -1.0], [1.0, 2.5, 1.0]);
    let count = cuboid.mesh.triangles().len();
    let builder = || MeshBuilder {
        positions: cuboid.mesh.positions().to_vec(),
        triangles: cuboid.mesh.triangles().to_vec(),
        ..MeshBuilder::default()
    };
    let with_mesh = |builder: MeshBuilder| {
        let mut scene = scene();
        let mesh = Arc::new(builder.build().expect("a mesh"));
        scene.objects.iter_mut().filter(|object| object.name == "caster").for_each(|object| object.mesh = mesh.clone());
        scene
    };
    let normals = |tilt: f32| {
        let mut builder = builder();
        builder.corner_normals = vec![[Vec3::new(tilt, 1.0, 0.0); 3]; count];
        let mut scene = with_mesh(builder);
        scene.objects.iter_mut().for_each(|object| object.material.shading = Shading::Phong);
        scene
    };
    let groups = |first: usize| {
        let group = |triangles: std::ops::Range<usize>, shading| MeshGroup {
            name: String::new(),
            triangles,
            material: Some(Material { shading, ..Material::default() }),
            texture: None,
        };
        let mut builder = builder();
        builder.corner_normals = vec![[Vec3::X; 3]; count];
        builder.groups = match first {
            0 => vec![group(0..count, Shading::Phong)],
            first => vec![group(0..first, Shading::Flat), group(first..count, Shading::Phong)],
        };
        with_mesh(builder)
    };
    let changed = |change: fn(&mut Scene)| {
        let mut scene = scene();
        change(&mut scene);
        scene
    };
    let scenes = [
        scene(),
        changed(|scene| scene.lights[0].position.x += 1.0),
        changed(|scene| scene.camera.eye.x += 1.0),
        changed(|scene| scene.objects[0].pose.translate.y += 0.5),
        changed(|scene| scene.objects[1].material.color = [0.5; 3]),
        with_mesh(builder()),
        normals(0.0),
        normals(0.5),
        groups(0),
        groups(1),
        groups(2),
        changed(|scene| scene.objects[1].pose.rotate_degrees.y += 30.0),
        changed(|scene| scene.objects[1].pose.scale.x *= 2.0),
    ];
    let sides = |plan: &FramePlan| plan.meshes.iter().filter_map(|mesh| mesh.surface.clone()).collect::<Vec<_>>();
    for technique in Technique::ALL {
        let mut cache = GeometryCache::default();
        let mut seen = Vec::new();
        for scene in scenes.iter().chain(scenes.iter().rev()) {
            let [full, empty] = [plan_with(scene, technique, &mut cache), plan_of(scene, technique)];
            let (full, empty) = (full.expect("a plan"), empty.expect("a plan"));
            assert!(full == empty, "{technique:?}: {:?}", scene.objects[1]);
            if !seen.contains(&sides(&full)) {
                seen.push(sides(&full));
            }
        }
        // Several plans differ by their sides: the cache has to distinguish them.
        assert!(seen.len() >= 4, "{technique:?}: {} kinds of surfaces", seen.len());
    }
}

/// The text names every part of the frame, one line each, so that a change shows as a line.
#[test]
fn the_text_of_z_fail_shows_its_two_sided_stencil() {
    let text = plan_of(&scene(), Technique::ZFail).expect("a plan").to_string();
    let draw = text.find("draw sides of caster [side]").expect("the sides");
    let state = "    depth Greater, kept\n    stencil reference 0, read 0xff, write 0xff\n      front: Always; fail Keep, \
                 depth fail DecrementWrap, pass Keep\n      back: Always; fail Keep, depth fail IncrementWrap, pass Keep\n";
    assert!(text[draw..].lines().skip(1).collect::<Vec<_>>().join("\n").starts_with(state.trim_end()), "{text}");
    assert!(text.contains("mesh 2: volume of caster, 9 vertices (5 at infinity), 14 triangles"), "{text}");
}

#[test]
fn what_a_scene_does_not_need_is_left_out_and_said() {
    let mut scene = scene();
    scene.lights = vec![Light::directional(glam::DVec3::Y)];
    let plan = plan_of(&scene, Technique::ZFail).expect("a plan");
    let parts = |part| plan.passes.iter().flat_map(|pass| &pass.draws).filter(|draw| draw.part == part).count();
    // The caster's sides and light cap: under a sun its volume ends in one point, and the floor darkens nothing.
    assert_eq!([DrawPart::Side, DrawPart::LightCap, DrawPart::DarkCap].map(parts), [1, 1, 0]);
    assert!(plan.left_out.iter().any(|left| left.is(Decision::Caster, "floor")));
    assert!(plan.left_out.iter().any(|left| left.is(Decision::DarkCap, "caster")));
    let plan = plan_of(&scene, Technique::ShadowMap).expect("a plan");
    assert!(plan.attachments.iter().all(|attachment| !attachment.format.has_stencil_aspect()));
    let floor = plan.left_out.iter().find(|left| left.what.contains("floor")).expect("the floor darkens nothing");
    assert!(floor.because.contains("light's side"));
}

#[test]
fn a_light_cap_is_drawn_in_the_surfaces_own_vertex_order() {
    let plan = plan_of(&scene(), Technique::ZFail).expect("a plan");
    let draws: Vec<_> = plan.passes.iter().flat_map(|pass| &pass.draws).collect();
    let is_cap = |draw: &&&Draw| draw.part == DrawPart::LightCap && draw.caster.as_deref() == Some("caster");
    let of_caps = draws.iter().filter(is_cap).flat_map(|cap| {
        let corners = cap.triangles.start as usize * 3..cap.triangles.end as usize * 3;
        plan.meshes[cap.mesh.0].indices.data()[corners].chunks(3)
    });
    let (caps, surface) = (of_caps.collect::<Vec<_>>(), plan.meshes[1].indices.data());
    assert_eq!(caps.len(), 2, "both triangles of the square cast");
    assert!(caps.iter().all(|cap| surface.chunks(3).any(|own| own == *cap)), "{caps:?}");
}

#[test]
fn a_broken_plan_is_named() {
    let good = plan_of(&scene(), Technique::ZFail).expect("a plan");
    let broken = |change: fn(&mut FramePlan)| {
        let mut plan = good.clone();
        change(&mut plan);
        lint::check(&plan).first().map(ToString::to_string).unwrap_or_default()
    };
    assert!(broken(|plan| plan.passes[1].draws[0].mesh = MeshId(99)).contains("mesh does not exist"));
    assert!(broken(|plan| plan.passes[1].draws[0].triangles.end += 99).contains("past the end"));
    assert!(broken(|plan| plan.passes[3].draws[0].mesh = MeshId(2)).contains("without normals"));
    assert!(broken(|plan| plan.passes[3].light = None).contains("without a light"));
    assert!(broken(|plan| plan.passes[1].depth_stencil = None).contains("stencil that its pass does not have"));
    assert!(broken(|plan| plan.attachments[1].format = wgpu::TextureFormat::Depth32Float).contains("stencil"));
}

#[test]
fn a_frame_with_a_broken_camera_or_too_many_lights_is_refused() {
    let mut blind = scene();
    blind.camera.target = blind.camera.eye;
    assert!(plan_of(&blind, Technique::ZFail).is_err());
    let mut bright = scene();
    bright.lights = vec![bright.lights[0].clone(); 32];
    assert_eq!(plan_of(&bright, Technique::ZFail), Err(PlanError::TooManyLights { count: 32 }));
    bright.lights.truncate(16);
    assert_eq!(lint::check(&plan_of(&bright, Technique::ZFail).expect("a plan")), []);
}

#[test]
fn only_raster_states_that_can_change_the_stencil_say_so() {
    let plan = plan_of(&scene(), Technique::ZFail).expect("a plan");
    let mut volume = plan.passes[1].draws[0].raster.clone();
    assert!(volume.writes_stencil());
    volume.stencil.front.depth_fail_op = StencilOperation::Keep;
    assert!(volume.writes_stencil());
    volume.stencil.back.depth_fail_op = StencilOperation::Keep;
    assert!(!volume.writes_stencil());
    assert!(!plan.passes[0].draws[0].raster.writes_stencil());
}

#[test]
fn of_one_pass_only_that_one_is_split_and_nothing_runs_after_it() {
    let plan = plan_of(&scene(), Technique::ZFail).expect("a plan");
    for (index, pass) in plan.passes.iter().enumerate() {
        let split = plan.split_pass_at_draws(index);
        assert_eq!(split.passes[..index], plan.passes[..index]);
        let parts = &split.passes[index..];
        assert_eq!(parts.len(), pass.draws.len().max(1));
        assert!(parts.iter().flat_map(|part| &part.draws).eq(&pass.draws));
        assert_eq!(lint::check(&split), []);
        let clears = |pass: &stencilscope::plan::Pass| pass.depth_stencil.as_ref().and_then(|to| to.clear_depth);
        assert_eq!(clears(&parts[0]), clears(pass));
        assert!(parts[1..].iter().all(|part| clears(part).is_none()), "what is there is kept");
    }
    assert_eq!(plan.split_pass_at_draws(99), plan);
}

/// Files count from 0, sentences from 1: a light has its one name wherever a plan is printed.
#[test]
fn a_light_has_one_name_in_the_plans_text() {
    let scene = opened("two-lights");
    let request = crate::common::request(Technique::ZFail, [64, 48]);
    let text = crate::common::session().plan(&scene, &request).expect("a plan").to_string();
    assert!(!text.contains("light 0"), "{text}");
    for line in ["light 1: point", "light 2: directional", ": volumes of light 1, seen", ": light of light 2, seen"] {
        assert!(text.contains(line), "{line}: {text}");
    }
}
