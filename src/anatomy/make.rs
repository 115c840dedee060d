//! Computes the anatomy of a frame from its scene and plan.

use super::{Anatomy, PlacedLight, PlacedObject, PlacedSurface, Silhouette, frusta, volumes};
use crate::geometry::{Caster, Casters, Edge, EdgeList, Facings, GeometryCache, silhouette};
use crate::plan::{DrawMesh, DrawPart, FramePlan};
use crate::recorded::PassSpace;
use crate::scene::{MeshGroup, Object, Scene};
use crate::technique::{Choice, casting};
use glam::{DVec3, DVec4, Vec3};
use std::collections::BTreeSet;

/// An edge is drawn where the normals of its neighbours differ by more than 25°, whose cosine this is.
const CREASE: f64 = 0.906;

/// Returns the anatomy of the frame of `plan`: `scene` at its time, rendered with `choice`; without a choice another
/// program drew it, and `scene` is what is known of its scene from its draws.
pub fn anatomy(scene: &Scene, choice: Option<&Choice>, plan: &FramePlan, cache: &mut GeometryCache) -> Anatomy {
    let own_plan = choice.map(|_| plan);
    let objects: Vec<PlacedObject> = scene.objects.iter().map(|object| placed(object, own_plan, cache)).collect();
    let aspect = scene.camera.aspect_in(plan.size);
    Anatomy {
        technique: plan.technique.clone(),
        camera: scene.camera,
        aspect,
        lights: scene
            .lights
            .iter()
            .map(|light| PlacedLight { position: light.position, color: light.color, range: light.range })
            .collect(),
        volumes: match choice {
            Some(_) => volumes::of_plan(plan, &objects),
            None => volumes::recorded(plan, scene),
        },
        silhouettes: silhouettes(scene, choice, &objects, cache),
        frusta: match choice {
            Some(_) => frusta::all(scene, plan, &objects, aspect),
            // Where another program's maps lie in space is not known.
            None => vec![frusta::of_camera(&scene.camera, aspect, plan.depth.far)],
        },
        is_view_assumed: choice.is_none(),
        near_clips: scene.lights.iter().map(|light| frusta::near_clip(&scene.camera, aspect, light)).collect(),
        objects,
    }
}

fn placed(object: &Object, plan: Option<&FramePlan>, cache: &mut GeometryCache) -> PlacedObject {
    let positions = object.world_positions();
    let edges = worth_drawing(&cache.edges(&object.mesh), &positions, object.mesh.triangles());
    PlacedObject {
        name: object.name.clone(),
        casts: object.casts,
        receives: object.receives,
        visible: object.visible,
        color: color(object),
        mesh: object.mesh.clone(),
        positions,
        edges,
        surfaces: plan.map_or_else(Vec::new, |plan| surfaces(plan, &object.name)),
    }
}

/// Returns the surfaces of the object of this name that a plan shades, each mesh once.
fn surfaces(plan: &FramePlan, object: &str) -> Vec<PlacedSurface> {
    let draws = plan.passes.iter().flat_map(|pass| &pass.draws);
    let of_object = draws.filter(|draw| draw.part == DrawPart::Surface && draw.caster.as_deref() == Some(object));
    let meshes: BTreeSet<usize> = of_object.map(|draw| draw.mesh.0).collect();
    let found = meshes.into_iter().filter_map(|mesh| {
        let DrawMesh { vertices, indices, surface, .. } = plan.meshes.get(mesh)?;
        let normals = surface.as_ref()?.normals.clone();
        Some(PlacedSurface { vertices: vertices.clone(), indices: indices.clone(), normals })
    });
    found.collect()
}

/// Returns the linear RGB colour of an object: the materials of its parts times the mean of their textures, weighted by
/// numbers of triangles, not by area. Black for a mesh without triangles.
fn color(object: &Object) -> [f32; 3] {
    let groups = object.mesh.groups();
    let count = groups.iter().map(|group| group.triangles.len()).sum::<usize>().max(1) as f32;
    let part = |group: &MeshGroup| {
        let shown = object.texture_of(group).map_or([1.0; 3], |texture| texture.picture.mean());
        let own = group.material.unwrap_or(object.material).color;
        let share = group.triangles.len() as f32 / count;
        Vec3::from(own) * Vec3::from(shown.map(|channel| channel as f32)) * share
    };
    groups.iter().map(part).sum::<Vec3>().to_array()
}

/// Returns the edges that are worth drawing: those of one triangle or of more than two, and those of two whose normals,
/// turned to agree, differ by more than about 25 degrees (or one of which has no area).
fn worth_drawing(edges: &EdgeList, positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Edge> {
    let normal = |triangle: usize| {
        let [a, b, c] = triangles[triangle].map(|corner| positions[corner as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let is_worth = |index: &usize| {
        let incident: Vec<(usize, i32)> = edges.incident(*index).collect();
        match incident[..] {
            [(one, way), (other, back)] => normal(one).dot(normal(other)) * -f64::from(way * back) < CREASE,
            _ => true,
        }
    };
    (0..edges.edges().len()).filter(is_worth).map(|index| edges.edges()[index]).collect()
}

/// Returns the corners of a triangle (clip space) of pass number `pass` as homogeneous points of the frame's anatomy.
/// `None` where there is no such pass, it is not of another program's frame, or a corner is not finite.
pub fn recorded_places(plan: &FramePlan, pass: usize, corners: [[f32; 4]; 3]) -> Option<[DVec4; 3]> {
    let pass = plan.passes.get(pass).filter(|pass| pass.recorded.is_some())?;
    let space = PassSpace::new(plan, pass);
    let [a, b, c] = corners.map(|corner| space.place(corner));
    Some([a?, b?, c?])
}

fn silhouettes(
    scene: &Scene,
    choice: Option<&Choice>,
    placed: &[PlacedObject],
    cache: &mut GeometryCache,
) -> Vec<Silhouette> {
    let mut found = Vec::new();
    let mut facings = Facings::default();
    for (light, position) in scene.lights.iter().map(crate::scene::Light::homogeneous).enumerate() {
        for (index, object) in scene.objects.iter().enumerate().filter(|(_, object)| object.casts) {
            let caster = Caster { mesh: &object.mesh, pose: &object.pose, world: &placed[index].positions };
            let casting = match choice {
                Some(choice) => casting(choice, scene, cache, caster, position),
                // Which casting triangles another program uses is not known: no more than are needed.
                None if cache.light_facing_suffices(caster, position).is_ok() => Casters::LightFacing.into(),
                None => Casters::All.into(),
            };
            cache.planes(caster).facings(caster.world, object.mesh.triangles(), position, &mut facings);
            facings.keep_casting(casting.casters);
            facings.leave_out(&casting.hidden);
            let mut edges = Vec::new();
            silhouette(&cache.edges(&object.mesh), &facings, &mut edges);
            found.push(Silhouette { light, caster: index, edges });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy::ViewOf;
    use crate::plan::DrawPart;
    use crate::scene::{OpenSpec, open};
    use crate::technique::{PlanRequest, Technique, plan};

    #[test]
    fn an_object_with_a_picture_has_its_average_colour() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/scenes/pattern.toml");
        let scene = open(&OpenSpec::new(file)).expect("a scene");
        let anatomy = of(file, Technique::None, &[]);
        let [floor, wood, .., ring] = &anatomy.objects[..] else { panic!("four objects") };
        assert_eq!(ring.color, scene.objects[3].material.color, "as it is");
        for (object, base, texture) in [
            (floor, 0.75, scene.objects[0].texture.as_ref()),
            (wood, 0.9, scene.objects[1].mesh.groups()[0].texture.as_ref()),
        ] {
            let mean = texture.expect("a picture").picture.mean();
            let near =
                object.color.iter().zip(mean).all(|(color, mean)| (f64::from(*color) - base * mean).abs() < 1e-6);
            assert!(near && object.color[0] > object.color[2], "{}: {:?}", object.name, object.color);
        }
    }

    fn of(name: &str, technique: Technique, settings: &[(&str, &str)]) -> Anatomy {
        let scene = open(&OpenSpec::new(name)).expect("a scene");
        let mut choice = Choice::new(technique);
        settings.iter().for_each(|(key, value)| choice.set(key, value).expect("a setting"));
        let mut cache = GeometryCache::default();
        let plan =
            plan(PlanRequest { scene: &scene, size: [320, 180], choice: &choice, cache: &mut cache, map_camera: None })
                .expect("a plan");
        anatomy(&scene, Some(&choice), &plan, &mut cache)
    }

    /// Each side of a triangle is matched by a reversed one: by vertex index near the light, by position at the far
    /// end, where vertices are new.
    fn is_closed(anatomy: &Anatomy, volume: usize) -> bool {
        let volume = &anatomy.volumes[volume];
        let mut edges = std::collections::BTreeMap::new();
        let bits = |index: u32| volume.vertices[index as usize].to_array().map(|v| (v + 0.0).to_bits());
        for [a, b, c] in volume.parts.iter().flat_map(|part| &part.triangles) {
            for (from, to) in [(a, b), (b, c), (c, a)].map(|(from, to)| (bits(*from), bits(*to))) {
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        !edges.is_empty() && edges.values().all(|sum| *sum == 0)
    }

    #[test]
    fn the_volumes_of_z_fail_close_and_stand_on_the_silhouette() {
        for settings in [
            &[][..],
            &[("extrusion", "finite:3")],
            &[("casters", "light-facing")],
            &[("extruded-by", "vertex-shader")],
            &[("extruded-by", "vertex-shader"), ("extrusion", "finite:3")],
        ] {
            let anatomy = of("tori", Technique::ZFail, settings);
            assert!(!anatomy.volumes.is_empty());
            for (index, volume) in anatomy.volumes.iter().enumerate() {
                assert!(is_closed(&anatomy, index), "{settings:?}: {}", anatomy.objects[volume.caster].name);
                let is_of = |one: &&Silhouette| one.light == volume.light && one.caster == volume.caster;
                let silhouette = anatomy.silhouettes.iter().find(is_of).expect("a silhouette");
                let quads: i32 = silhouette.edges.iter().map(|edge| edge.multiplicity.abs()).sum();
                let sides = volume.parts.iter().find(|part| part.part == DrawPart::Side).expect("sides");
                assert_eq!(sides.triangles.len(), 2 * quads as usize, "{settings:?}");
            }
        }
    }

    #[test]
    fn two_passes_over_both_faces_are_one_volume() {
        let once = of("tori", Technique::ZFail, &[]);
        let twice = of("tori", Technique::ZFail, &[("faces", "two-pass")]);
        assert_eq!(once.volumes, twice.volumes);
    }

    #[test]
    fn without_volumes_there_are_silhouettes_still_and_a_map_has_its_frustum() {
        let anatomy = of("tori", Technique::ShadowMap, &[]);
        assert!(anatomy.volumes.is_empty());
        assert!(anatomy.silhouettes.iter().any(|silhouette| !silhouette.edges.is_empty()));
        let maps: Vec<_> = anatomy.frusta.iter().filter(|frustum| frustum.of != ViewOf::Camera).collect();
        assert!(!maps.is_empty());
        for frustum in maps {
            let corners = frustum.near.iter().chain(&frustum.far);
            assert!(corners.clone().all(|corner| corner.is_finite() && corner.w >= 0.0), "{frustum:?}");
        }
    }

    /// Corner, sides and unit normal of a frustum's near rectangle.
    fn rectangle(frustum: &crate::anatomy::Frustum) -> [DVec3; 4] {
        let [_, left_top, left_bottom, right_bottom] = frustum.near.map(|corner| corner.truncate() / corner.w);
        let (u, v) = (right_bottom - left_bottom, left_top - left_bottom);
        [left_bottom, u, v, u.cross(v).normalize()]
    }

    #[test]
    fn a_receivers_texture_is_seen_from_the_receiver_to_the_light() {
        let anatomy = of("tori", Technique::PlanarTexture, &[]);
        let maps: Vec<_> = anatomy.frusta.iter().filter(|frustum| frustum.of != ViewOf::Camera).collect();
        assert!(!maps.is_empty());
        for frustum in maps {
            let ViewOf::Map { light, caster: None, .. } = frustum.of else { panic!("{frustum:?}") };
            assert_eq!(frustum.far, [anatomy.lights[light].position; 4]);
            let [corner, u, v, normal] = rectangle(frustum);
            let is_on = |place: &&DVec3| {
                let offset = **place - corner;
                let shares = [offset.dot(u) / u.length_squared(), offset.dot(v) / v.length_squared()];
                offset.dot(normal).abs() < 1e-6 && shares.iter().all(|share| (-1e-6..1.0 + 1e-6).contains(share))
            };
            let has = |object: &PlacedObject| object.receives && object.positions.iter().filter(is_on).count() >= 3;
            assert!(anatomy.objects.iter().any(has), "no receiver lies in the rectangle of {frustum:?}");
        }
    }

    #[test]
    fn a_projected_silhouette_fits_the_rectangle_that_it_is_projected_from() {
        let mut suns = [0, 0];
        for name in ["tori", "two-lights"] {
            let anatomy = of(name, Technique::Projective, &[]);
            let maps: Vec<_> = anatomy.frusta.iter().filter(|frustum| frustum.of != ViewOf::Camera).collect();
            assert!(!maps.is_empty() && maps.len() % 2 == 0, "{name}: to the light, and onwards");
            for pair in maps.chunks(2) {
                let ViewOf::Map { light, caster: Some(caster), .. } = pair[0].of else { panic!("{:?}", pair[0]) };
                let position = anatomy.lights[light].position;
                let is_sun = position.w == 0.0;
                suns[usize::from(is_sun)] += 1;
                assert_eq!(pair[0].far, [position; 4]);
                assert!(pair[1].near == pair[0].near && pair[1].far.iter().all(|far| far.w == 0.0));
                let [corner, u, v, normal] = rectangle(pair[0]);
                for place in &anatomy.objects[caster].positions {
                    let ray = *place * position.w - position.truncate();
                    let from = if is_sun { *place } else { position.truncate() };
                    let hit = from + ray * (normal.dot(corner - from) / normal.dot(ray)) - corner;
                    let shares = [hit.dot(u) / u.length_squared(), hit.dot(v) / v.length_squared()];
                    assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)), "{name}: {place} at {shares:?}");
                }
                for (near, far) in pair[1].near.into_iter().zip(pair[1].far) {
                    let from_light = (near * position.w - position).truncate();
                    assert!(from_light.normalize().dot(far.truncate().normalize()) > 1.0 - 1e-12);
                }
            }
        }
        assert!(suns.iter().all(|count| *count > 0), "of a lamp and of a sun: {suns:?}");
    }

    /// The camera's frustum begins at the near rectangle and has no end.
    #[test]
    fn the_cameras_frustum_is_what_it_sees() {
        let anatomy = of("tori", Technique::ZFail, &[]);
        let frustum = anatomy.frusta[0];
        let camera = anatomy.camera;
        let forward = (camera.target - camera.eye).normalize();
        let tangent = (camera.fov_y_degrees.to_radians() / 2.0).tan();
        for (near, far) in frustum.near.into_iter().zip(frustum.far) {
            let offset = near.truncate() / near.w - camera.eye;
            assert!((offset.dot(forward) / camera.near - 1.0).abs() < 1e-9);
            assert_eq!(far.w, 0.0);
            assert!(far.truncate().normalize().dot(offset.normalize()) > 1.0 - 1e-12);
        }
        let height = (frustum.near[0] - frustum.near[3]).length();
        assert!((height / (2.0 * tangent * camera.near) - 1.0).abs() < 1e-9, "{height}");
        let near_clip = anatomy.near_clips[0].expect("a near-clip volume");
        assert_eq!(near_clip.apex, anatomy.lights[0].position);
        assert!((near_clip.rectangle[0] - frustum.near[0].truncate()).length() < 1e-9);
    }

    #[test]
    fn a_box_shows_its_twelve_edges_and_a_torus_none() {
        let anatomy = of("table", Technique::None, &[]);
        let cuboid = anatomy.objects.iter().find(|object| object.mesh.triangles().len() == 12).expect("a box");
        assert_eq!(cuboid.edges.len(), 12);
        let torus = of("tori", Technique::None, &[]);
        let torus = torus.objects.iter().max_by_key(|object| object.mesh.triangles().len()).expect("a torus");
        assert!(torus.edges.is_empty());
    }
}
