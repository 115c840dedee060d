//! Faults injected into scenes, plans and settings: each is found where `stress` judges it.

use super::*;
use crate::common::faults::turn_caps;

/// Runs a case as `stress` does, without the fault and with it: nothing is unexpected without it, and
/// with it something is, judged by what is expected of that very case, value and technique.
fn assert_found(
    session: &mut Session,
    (name, values): (&str, &[f64]),
    entrant: Entrant,
    fault: InjectedFault,
    what: &str,
) {
    let adapter = session.adapter().clone();
    let mut run = |fault| {
        let rows = session.stress_faulty(case(name), &[entrant], values, SMALL, fault, &Progress::default());
        let rows = rows.expect("rows");
        assert!(
            !rows.is_empty()
                && rows.iter().all(|row| row.expected == case(name).expected_on(row.step, &entrant, row.parameter.1))
        );
        StressResults { adapter: adapter.clone(), size: SMALL, rows, part: None }
    };
    let good = run(InjectedFault::None);
    assert!(!good.is_unexpected(), "{what}: {name} without it:\n{}", good.to_table());
    let bad = run(fault);
    if !adapter::draws_as_given() && !bad.is_unexpected() {
        // As few pixels may be wrong by the adapter's precision; but more are than without the fault.
        let wrong = |results: &StressResults| results.rows.iter().map(|row| row.error.wrong()).sum::<u64>();
        assert!(wrong(&bad) > wrong(&good), "{what}: {name} with it:\n{}", bad.to_table());
        return;
    }
    assert!(bad.is_unexpected(), "{what}: {name} with it:\n{}", bad.to_table());
    let (table, json) = (bad.to_table(), bad.to_json().expect("JSON"));
    assert!(table.contains("!!") && json.contains("\"verdict\": \"unexpected\""), "{what}: {table}");
}

const Z_FAIL: Entrant = Entrant::of(Technique::ZFail);
const LIGHT_FACING: Entrant = Entrant::with(Technique::ZFail, &[("casters", "light-facing")]);

/// A technique that casts nothing does not pass for one with a known failure, but where that is what
/// the failure does: it loses all the shadow there is.
#[test]
fn casting_nothing_is_no_known_failure() {
    apart("stress::faults::casting_nothing_is_no_known_failure", &["all"], |_| cast_nothing_in_every_case());
}

fn cast_nothing_in_every_case() {
    let lose_all = [
        // Only the lit face of the closed body casts, and it is extruded by next to nothing.
        "light-close finite-extrusion",
        "light-far depth-bits",
        "sliver aliasing",
        "nested wrap-256",
        "nested few-bits",
        "nested parity",
        "light-at-sheet f32-limit",
        "turned-sheet f32-limit",
        "light-at-sheet map-near-plane",
        "light-inside-mesh near-plane",
        "light-inside-mesh light-facing-inside",
        "caster-around-light light-facing-open",
        // At 1e7 m, where a step is a metre, as much as the whole shadow may be gone.
        "world-offset f32-world",
        // All three are mirrored, and their counts stop at 0.
        "instances mirrored",
        // The box is all that casts, and the map leaves it out.
        "map-planes map-near-plane",
        "map-planes map-far-plane",
    ];
    let mut session = session();
    let mut passed = BTreeSet::new();
    let is_slow = |case: &StressCase| case.values.len() > 100 || case.timed;
    let cast_nothing = |scene: &mut Scene| scene.objects.iter_mut().for_each(|object| object.casts = false);
    for case in cases::all().filter(|case| !is_slow(case)) {
        for entrant in case.entrants() {
            let must_fail = |value: &&f64| matches!(case.expected_at(&entrant, **value), ExpectedResult::Fails(_));
            let values: Vec<f64> = case.values.iter().filter(must_fail).copied().collect();
            let fault = InjectedFault::Scene(&cast_nothing);
            let rows = session.stress_faulty(case, &[entrant], &values, SMALL, fault, &Progress::default());
            let rows = rows.expect("rows").into_iter().filter(|row| row.expected.name() != "no-fit");
            let rows = rows.filter(|row| row.surprise().is_none());
            passed.extend(rows.map(|row| format!("{} {}", row.case, row.expected.name())));
        }
    }
    let lose_all: BTreeSet<String> = lose_all.map(str::to_owned).into();
    if !adapter::draws_as_given() {
        // The coarser the step, the more pixels rounding may lose, up to a small shadow.
        let is_by_rounding =
            |one: &str| ["f32-limit", "depth-bits", "rounding", "crack"].iter().any(|by| one.ends_with(by));
        passed.retain(|one| lose_all.contains(one) || !is_by_rounding(one));
    }
    assert_eq!(passed, lose_all);
}

/// Faults in how caps and sides are drawn. In `nested` a count of 256 is known to fail: that must not
/// hide them at other counts.
#[test]
fn wrong_caps_and_operations_are_found() {
    let mut session = session();
    let drop = |plan: &mut FramePlan| {
        plan.passes.iter_mut().for_each(|pass| pass.draws.retain(|draw| draw.part != DrawPart::DarkCap));
    };
    let seeds: Vec<f64> = (0..20).map(f64::from).collect();
    for place in [("light-in-torus-hole", &[0.0][..]), ("random", &seeds)] {
        assert_found(&mut session, place, Z_FAIL, InjectedFault::Plan(&drop), "dropped dark caps");
    }
    for part in [DrawPart::LightCap, DrawPart::DarkCap, DrawPart::Side] {
        let swap = |plan: &mut FramePlan| draws(plan, part).for_each(swap_operations);
        let what = format!("swapped operations of {part:?}");
        for place in [("light-in-torus-hole", &[0.0][..]), ("random", &seeds)] {
            assert_found(&mut session, place, Z_FAIL, InjectedFault::Plan(&swap), &what);
        }
    }
    // The sides alone are behind the floor there, and at 256 the count is known to be read as none.
    let drop = |plan: &mut FramePlan| {
        plan.passes.iter_mut().for_each(|pass| pass.draws.retain(|draw| draw.part != DrawPart::Side));
    };
    for place in [("nested", &[100.0, 256.0][..]), ("nested", &[255.0]), ("nested", &[257.0, 512.0])] {
        assert_found(&mut session, place, Z_FAIL, InjectedFault::Plan(&drop), "dropped sides");
    }
    // Swapped everywhere, counts that wrap only change their sign; those that are clamped stop at 0.
    let in_turn = Entrant::with(Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass")]);
    let swap = |plan: &mut FramePlan| {
        for part in [DrawPart::LightCap, DrawPart::DarkCap, DrawPart::Side] {
            draws(plan, part).for_each(swap_operations);
        }
    };
    assert_found(
        &mut session,
        ("nested", &[2.0, 100.0]),
        in_turn,
        InjectedFault::Plan(&swap),
        "all operations swapped",
    );
}

fn swap_operations(draw: &mut Draw) {
    let stencil = &mut draw.raster.stencil;
    std::mem::swap(&mut stencil.front, &mut stencil.back);
}

/// The same mesh with other triangles.
fn with_triangles(mesh: &Mesh, triangles: Vec<[u32; 3]>) -> Arc<Mesh> {
    let positions = mesh.positions().to_vec();
    Arc::new(MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().expect("a mesh"))
}

/// One triangle of a closed mesh is wound the other way, before edges and caps are made from it: under
/// `light-facing` it then casts where it must not, or does not where it must.
#[test]
fn a_flipped_facing_is_found_under_light_facing() {
    let mut session = session();
    for name in ["split-vertices", "shared-edge", "instances"] {
        let flip = |scene: &mut Scene| {
            let light = scene.lights[0].homogeneous();
            let object = scene.objects.last_mut().expect("a caster");
            let (world, mut triangles) = (object.world_positions(), object.mesh.triangles().to_vec());
            let faces = |[a, b, c]: &[u32; 3]| {
                let [a, b, c] = [a, b, c].map(|corner| world[*corner as usize]);
                (b - a).cross(c - a).dot(towards(light, a))
            };
            // The one that shows the light most of itself.
            let widest = triangles.iter_mut().max_by(|a, b| faces(a).total_cmp(&faces(b))).expect("a triangle");
            widest.swap(0, 1);
            object.mesh = with_triangles(&object.mesh, triangles);
        };
        assert_found(&mut session, (name, &[0.0]), LIGHT_FACING, InjectedFault::Scene(&flip), "a facing flipped");
    }
}

fn towards(light: DVec4, from: glam::DVec3) -> glam::DVec3 {
    light.truncate() - from * light.w
}

/// What a threshold of shape or a tolerant welding would do to the casters made to catch them.
#[test]
fn dropped_slivers_and_closed_slits_are_found() {
    let mut session = session();
    let drop = |scene: &mut Scene| scene.objects.truncate(1);
    assert_found(&mut session, ("sliver", &[1e4, 1e8]), Z_FAIL, InjectedFault::Scene(&drop), "the sliver dropped");
    let weld = |scene: &mut Scene| {
        let object = scene.objects.last_mut().expect("a caster");
        let mut positions = object.mesh.positions().to_vec();
        positions.iter_mut().filter(|point| point.x.abs() < 1e-3).for_each(|point| point.x = 0.0);
        let triangles = object.mesh.triangles().to_vec();
        object.mesh = Arc::new(MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().expect("a mesh"));
    };
    assert_found(&mut session, ("thin-gap", &[1e-3, 1e-5]), Z_FAIL, InjectedFault::Scene(&weld), "the slit welded");
}

/// The same triangles, counted the same way, but with corners in another order: depths are no
/// longer those of the surface, bit for bit.
#[test]
fn caps_in_flipped_vertex_order_are_found() {
    let seeds: Vec<f64> = (0..60).map(f64::from).collect();
    assert_found(&mut session(), ("random", &seeds), Z_FAIL, InjectedFault::Plan(&turn_caps), "turned caps");
}

/// Faults of numbers: where counts stop, where positions are rounded, where depth ends.
#[test]
fn wrong_numbers_are_found() {
    let mut session = session();
    let clamp = |choice: &mut Choice| choice.set("operations", "clamp").expect("a setting");
    for place in [("open-mesh", &[0.0][..]), ("nested", &[1.0, 100.0, 255.0])] {
        assert_found(&mut session, place, Z_FAIL, InjectedFault::Choice(&clamp), "clamp for wrap");
    }
    let far = |choice: &mut Choice| choice.set("depth", "standard-finite").expect("a setting");
    for place in [("near-far", &[10.0, 100.0][..]), ("world-scale", &[1.0, 1e6])] {
        assert_found(&mut session, place, Z_FAIL, InjectedFault::Choice(&far), "a far plane");
    }
    let round = |plan: &mut FramePlan| {
        let eye = plan.views[0].origin.to_array();
        for mesh in &mut plan.meshes {
            let rounded = mesh.vertices.data().iter().map(|&[x, y, z, w]| {
                let far_away = |relative: f32, eye: f64| {
                    ((f64::from(relative) + eye) as f32 - eye as f32) * w + relative * (1.0 - w)
                };
                [far_away(x, eye[0]), far_away(y, eye[1]), far_away(z, eye[2]), w]
            });
            mesh.vertices = Blob::new(rounded.collect());
        }
    };
    let place = ("world-offset", &[1e6, 1e7][..]);
    assert_found(&mut session, place, Z_FAIL, InjectedFault::Plan(&round), "f32 before the eye is subtracted");
}
