//! Shadow volumes: every setting right where it is right, and its famous wrong alternative counted.

use crate::common::ray_cast::difference;
use crate::common::{
    adapter, cuboid, from_above, label_counts, remeshed, request, request_with, session, square, stencil_before_mask,
    under,
};
use glam::DVec3;
use std::sync::Arc;
use stencilscope::capture::Capture;
use stencilscope::plan::{CountOf, DrawPart, FramePlan, StencilFace};
use stencilscope::scene::shapes;
use stencilscope::scene::{Light, Material, Mesh, Object, Scene};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::Technique;
use wgpu::{CompareFunction, StencilOperation};

const VOLUMES: [Technique; 3] = [Technique::ZPass, Technique::ZFail, Technique::ZPassPlus];
/// Ten pixels a unit of the floor.
const SIZE: [u32; 2] = [200, 200];
const ALL_PIXELS: u64 = 200 * 200;

fn with(technique: Technique, settings: &[(&str, &str)]) -> CaptureRequest {
    request_with(technique, settings, SIZE)
}

fn capture(session: &mut Session, scene: &Scene, technique: Technique, settings: &[(&str, &str)]) -> Capture {
    session.capture(scene, &with(technique, settings)).expect("a capture")
}

fn counts(session: &mut Session, scene: &Scene, technique: Technique, settings: &[(&str, &str)]) -> [u64; 4] {
    label_counts(&capture(session, scene, technique, settings))
}

fn object(name: &str, mesh: Mesh) -> Object {
    Object::new(name, Arc::new(mesh), Material::default())
}

fn torus(height: f64) -> Object {
    let mut torus = object("torus", shapes::torus(1.0, 0.3, 24, 12).expect("a torus"));
    torus.pose.translate.y = height;
    torus
}

/// Level squares under each other: the highest throws a shadow of half-width 2 and hides the others, the
/// lowest's is the smallest.
fn nested(count: u32) -> Vec<Object> {
    (0..count).map(|i| square(&format!("square {i}"), 2.0 - f64::from(i) / 1000.0, 1.0)).collect()
}

fn of_mesh(object: &Object, change: impl Fn(usize, [u32; 3]) -> Vec<[u32; 3]>) -> Object {
    let triangles = object.mesh.triangles().iter().enumerate();
    let triangles: Vec<[u32; 3]> = triangles.flat_map(|(index, corners)| change(index, *corners)).collect();
    remeshed(object, &triangles)
}

/// Flipped, doubled and missing triangles, and fins: three faces on an edge.
fn torn(object: &Object) -> Object {
    of_mesh(object, |index, [a, b, c]| match index % 11 {
        0 => vec![],
        3 => vec![[a, c, b]],
        5 => vec![[a, b, c], [a, b, c]],
        7 => vec![[a, b, c], [a, b, (c + 5) % 200]],
        _ => vec![[a, b, c]],
    })
}

/// A square's shadow is 40 × 40 pixels, of which the caster hides 25 × 25; the same by any of
/// these ways.
#[test]
fn settings_that_are_right_for_a_box_throw_its_exact_shadow() {
    let mut session = session();
    let scene = from_above(vec![cuboid("caster", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0])]);
    let right = [ALL_PIXELS - 975, 975, 0, 0];
    for technique in VOLUMES {
        for settings in [
            &[][..],
            &[("casters", "all")],
            &[("casters", "light-facing")],
            &[("casters", "light-back-facing")],
            &[("faces", "two-pass")],
            &[("faces", "two-pass"), ("operations", "clamp")],
            &[("silhouette", "edge-list")],
            &[("extrusion", "finite:100")],
            &[("light-caps", "never")],
        ] {
            let found = counts(&mut session, &scene, technique, settings);
            assert_eq!(found, right, "{technique:?} {settings:?}");
        }
    }
}

#[test]
fn a_suns_volume_may_be_finite_too() {
    let mut session = session();
    let scene = under(Light::directional(DVec3::new(-1.0, 1.0, 0.0)), vec![square("caster", 5.0, 1.0)]);
    for technique in VOLUMES {
        let shadow = |session: &mut Session, k: &str| counts(session, &scene, technique, &[("extrusion", k)])[1];
        assert_eq!(shadow(&mut session, "finite:10"), 400, "{technique:?}");
        // The diagonal is 2√2 and the floor 5√2 away.
        assert_eq!(shadow(&mut session, "finite:2.4"), 0, "{technique:?}");
        assert_eq!(shadow(&mut session, "finite:2.6"), 400, "{technique:?}");
    }
}

/// Vertices K times as far from the light again: the light a tenth above the caster, the volume ends
/// before the floor.
#[test]
fn a_finite_volume_ends_early_under_a_close_light() {
    let mut session = session();
    let scene = under(Light::point(DVec3::new(0.0, 2.1, 0.0)), vec![square("caster", 2.0, 0.1)]);
    for technique in VOLUMES {
        let right = counts(&mut session, &scene, technique, &[]);
        assert!(right[1] > 1000, "{right:?}");
        assert_eq!(counts(&mut session, &scene, technique, &[("extrusion", "finite:100")]), right);
        let ended = counts(&mut session, &scene, technique, &[("extrusion", "finite:19")]);
        assert_eq!(ended[1], 0, "{technique:?}: 0.1 · 20 is less than 2.1");
    }
}

#[test]
fn light_facing_is_wrong_on_an_open_mesh_and_with_the_light_inside() {
    let mut session = session();
    // Without its top, which faces the light: only the bottom's and sides' backs do.
    let whole = cuboid("caster", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0]);
    let open = of_mesh(&whole, |index, corners| if index == 6 || index == 7 { vec![] } else { vec![corners] });
    let scene = from_above(vec![open]);
    let right = counts(&mut session, &scene, Technique::ZFail, &[]);
    let lost = counts(&mut session, &scene, Technique::ZFail, &[("casters", "light-facing")]);
    assert!(right[1] > 500 && lost[1] < right[1] / 2, "{right:?} {lost:?}");
    let back = counts(&mut session, &scene, Technique::ZFail, &[("casters", "light-back-facing")]);
    assert_eq!(back, right, "what faces away closes the shadow here");
    // A room around the light: every surface outside it is in shadow.
    let room = of_mesh(&cuboid("room", [-1.0, 3.0, -1.0], [1.0, 5.0, 1.0]), |_, corners| vec![corners]);
    let scene = from_above(vec![room]);
    let right = counts(&mut session, &scene, Technique::ZFail, &[]);
    let lit = counts(&mut session, &scene, Technique::ZFail, &[("casters", "light-facing")]);
    assert!(right[1] > 30_000 && lit[1] == 0, "{right:?} {lit:?}");
    let proven = counts(&mut session, &scene, Technique::ZFail, &[("casters", "by-topology")]);
    assert_eq!(proven, right, "by-topology sees that the light is inside");
}

/// A proven body counts one, whatever else counts; the plan and the capture say what a count is of.
#[test]
fn a_body_counts_one_where_it_is_proven_closed() {
    let mut session = session();
    let whole = || cuboid("whole", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0]);
    let open = || {
        of_mesh(&cuboid("open", [-1.0, 2.5, -1.0], [1.0, 3.0, 1.0]), |index, corners| match index {
            6 | 7 => vec![],
            _ => vec![corners],
        })
    };
    type Case<'a> = (Vec<Object>, &'a [(&'a str, &'a str)], CountOf, f32);
    let cases: [Case; 5] = [
        (vec![whole()], &[], CountOf::Bodies, 1.0),
        (vec![whole()], &[("casters", "all")], CountOf::Surfaces, 2.0),
        // By hand nothing is proven.
        (vec![whole()], &[("casters", "light-facing")], CountOf::Surfaces, 1.0),
        (vec![open()], &[], CountOf::Surfaces, 1.0),
        (vec![whole(), open()], &[], CountOf::Mixed, 2.0),
    ];
    for technique in [Technique::ZFail, Technique::ZPass, Technique::ZPassPlus] {
        for (casters, settings, of, deepest) in &cases {
            let mut scene = from_above(casters.clone());
            scene.objects[0].casts = false;
            let settings = [&[("counter", "float")], *settings].concat();
            let found = capture(&mut session, &scene, technique, &settings);
            assert_eq!(found.lights[0].count_of, Some(*of), "{technique:?} {settings:?}");
            let count = found.lights[0].count.as_ref().expect("a count");
            let texels = count.rows().flat_map(bytemuck::pod_collect_to_vec::<u8, f32>);
            assert_eq!(texels.fold(0.0, f32::max), *deepest, "{technique:?} {settings:?}");
        }
    }
    let mut nothing = from_above(vec![]);
    nothing.objects[0].casts = false;
    assert_eq!(capture(&mut session, &nothing, Technique::ZFail, &[]).lights[0].count_of, None);
}

/// A floor that casts is open; nothing that shows is below its own volume, so counts at surfaces are of bodies still.
#[test]
fn a_floor_with_nothing_below_it_makes_no_count_one_of_surfaces() {
    let mut session = session();
    let whole = || cuboid("whole", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0]);
    let cellar = cuboid("cellar", [-1.0, -3.0, -1.0], [1.0, -2.0, 1.0]);
    for technique in [Technique::ZFail, Technique::ZPass, Technique::ZPassPlus] {
        let above = capture(&mut session, &from_above(vec![whole()]), technique, &[]);
        assert_eq!(above.lights[0].count_of, Some(CountOf::Bodies), "{technique:?}");
        assert_eq!(counts(&mut session, &from_above(vec![whole()]), technique, &[])[2..].iter().sum::<u64>(), 0);
        let below = capture(&mut session, &from_above(vec![whole(), cellar.clone()]), technique, &[]);
        assert_eq!(below.lights[0].count_of, Some(CountOf::Mixed), "{technique:?}");
    }
    for (leave_out, counted) in [("all", None), ("none", Some(CountOf::Surfaces))] {
        let floor = capture(&mut session, &from_above(vec![]), Technique::ZFail, &[("leave-out", leave_out)]);
        assert_eq!(floor.lights[0].count_of, counted, "it alone casts");
    }
}

/// What by-topology took and why is in the plan.
#[test]
fn by_topology_says_what_it_proved_and_what_it_could_not() {
    let mut session = session();
    let whole = cuboid("whole", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0]);
    let open = of_mesh(&whole, |index, corners| if index == 4 { vec![] } else { vec![corners] });
    let flipped = of_mesh(&whole, |_, [a, b, c]| vec![[a, c, b]]);
    let mirrored = |object: &Object| {
        let mut object = object.clone();
        object.pose.scale.x = -1.0;
        object
    };
    let cases = [
        (whole.clone(), None),
        (open, Some("not closed: 3 open edges")),
        (flipped.clone(), Some("inside out")),
        (mirrored(&whole), Some("inside out")),
        (mirrored(&flipped), None),
    ];
    for (caster, doubt) in cases {
        let scene = from_above(vec![caster]);
        let plan = session.plan(&scene, &with(Technique::ZFail, &[("casters", "by-topology")])).expect("a plan");
        let decisions: Vec<&str> =
            plan.left_out.iter().filter(|left| left.of == "whole").map(|left| left.because.as_str()).collect();
        let expected = doubt.unwrap_or("proven: ");
        assert!(decisions.iter().any(|because| because.contains(expected)), "{expected}: {decisions:?}");
    }
}

#[test]
fn two_sided_and_two_pass_leave_the_same_counts() {
    let mut session = session();
    let scene = from_above(vec![torn(&torus(2.0)), cuboid("box", [-3.0, 1.0, -1.0], [-1.5, 2.0, 0.5])]);
    for technique in VOLUMES {
        let one = stencil_before_mask(&capture(&mut session, &scene, technique, &[]));
        let two = stencil_before_mask(&capture(&mut session, &scene, technique, &[("faces", "two-pass")]));
        let differing: Vec<_> = one.iter().zip(&two).enumerate().filter(|(_, (one, two))| one != two).collect();
        assert!(differing.is_empty(), "{technique:?}: {} pixels, {:?}", differing.len(), differing.first());
        assert!(one.iter().any(|count| *count > 1), "{technique:?}");
    }
}

/// Two volumes behind the floor, or in front: faces that take away before others add lose counts.
#[test]
fn clamped_counts_depend_on_order_and_end_at_255() {
    let mut session = session();
    let scene = from_above(vec![torus(2.0)]);
    let right = counts(&mut session, &scene, Technique::ZFail, &[]);
    let clamped = counts(&mut session, &scene, Technique::ZFail, &[("operations", "clamp")]);
    assert_ne!(clamped, right, "some face that takes away is drawn before one that adds");
    let ordered = [("operations", "clamp"), ("faces", "two-pass")];
    assert_eq!(counts(&mut session, &scene, Technique::ZFail, &ordered), right);
    // 300 squares: behind the last, a ray has entered 300 volumes and is inside them all. Wrapped,
    // the count is 300 − 256; clamped, it stops at 255. 256 wrap to 0.
    let most = |session: &mut Session, count: u32, settings: &[(&str, &str)]| {
        stencil_before_mask(&capture(session, &from_above(nested(count)), Technique::ZFail, settings)).into_iter().max()
    };
    // The floor's own volume, below it, adds one more and takes it away again, after the limit.
    assert_eq!(most(&mut session, 300, &ordered), Some(254));
    let shadow_of = |session: &mut Session, count: u32, settings: &[(&str, &str)]| {
        counts(session, &from_above(nested(count)), Technique::ZFail, settings)[1]
    };
    assert_eq!(shadow_of(&mut session, 255, &[]), 975);
    assert!(shadow_of(&mut session, 256, &[]) < 975, "256 reads as 0");
    assert_eq!(shadow_of(&mut session, 257, &[]), 975);
}

/// Seen through a caster that is not drawn, the floor is behind its light cap.
#[test]
fn light_caps_that_never_pass_are_wrong_for_an_undrawn_caster() {
    let mut session = session();
    let hidden = Object { visible: false, ..square("caster", 2.0, 1.0) };
    let scene = from_above(vec![hidden]);
    for technique in VOLUMES {
        assert_eq!(counts(&mut session, &scene, technique, &[])[1], 1600, "{technique:?}");
        let never = counts(&mut session, &scene, technique, &[("light-caps", "never")]);
        assert_eq!(never[1], 1600 - 625, "{technique:?}: lost behind the caster");
    }
}

#[test]
fn searching_for_edges_draws_the_same_volumes_and_is_refused_when_it_would_take_minutes() {
    let mut session = session();
    let scene = from_above(vec![torn(&torus(2.0))]);
    let stencils = ["adjacency", "edge-list"].map(|way| {
        let plan = session.plan(&scene, &with(Technique::ZFail, &[("silhouette", way)])).expect("a plan");
        plan.meshes.iter().map(|mesh| mesh.indices.data().to_vec()).collect::<Vec<_>>()
    });
    assert!(stencils[0] == stencils[1]);
    let large = object("large", shapes::sphere(1.0, 160, 80).expect("a sphere"));
    let request = with(Technique::ZFail, &[("silhouette", "edge-list")]);
    let refused = session.plan(&from_above(vec![large]), &request).expect_err("too large").to_string();
    assert!(refused.contains("silhouette = adjacency"), "{refused}");
}

/// Where no volume reaches the near plane, counts in front, behind and from the near plane on agree.
#[test]
fn all_three_counts_agree_where_the_eye_is_outside() {
    let mut session = session();
    let scene = from_above(vec![torn(&torus(2.0)), cuboid("box", [-3.0, 1.0, -1.0], [-1.5, 2.0, 0.5])]);
    for light in [Light::point(DVec3::new(0.5, 5.0, 0.2)), Light::directional(DVec3::new(0.3, 1.0, 0.2))] {
        let scene = Scene { lights: vec![light], ..scene.clone() };
        let [z_pass, z_fail, plus] =
            VOLUMES.map(|technique| stencil_before_mask(&capture(&mut session, &scene, technique, &[])));
        assert!(z_pass == z_fail && plus == z_fail);
    }
}

/// An eye under a roof: z-pass-plus is right where z-pass is not, for lights of either kind and on
/// either side of the near plane.
#[test]
fn z_pass_plus_is_right_with_the_eye_inside_a_volume() {
    let mut session = session();
    let lights = [
        Light::point(DVec3::new(0.0, 14.0, 0.0)),
        Light::point(DVec3::new(1.5, 13.0, -2.0)),
        Light::directional(DVec3::new(0.1, 1.0, 0.05)),
        Light::directional(DVec3::new(0.0, 1.0, 0.0)),
    ];
    for light in lights {
        let scene = under(light, vec![square("roof", 12.0, 3.0), torn(&torus(2.0))]);
        let [z_pass, z_fail, plus] =
            VOLUMES.map(|technique| stencil_before_mask(&capture(&mut session, &scene, technique, &[])));
        assert!(plus == z_fail, "{} pixels differ", plus.iter().zip(&z_fail).filter(|(a, b)| a != b).count());
        assert!(z_pass != z_fail);
    }
    // Looking up from under a table at a lamp: the light is on the scene's side of the near plane.
    let mut scene = from_above(vec![square("table", 4.0, 2.0), square("ceiling", 9.0, 9.0)]);
    scene.camera.eye = DVec3::new(0.2, 1.0, 0.1);
    scene.camera.target = DVec3::new(0.2, 9.0, 0.1);
    scene.camera.up = DVec3::Z;
    scene.lights = vec![Light::point(DVec3::new(0.0, 6.0, 0.0))];
    let [z_pass, z_fail, plus] = VOLUMES.map(|technique| counts(&mut session, &scene, technique, &[]));
    assert_eq!(plus, z_fail);
    assert_ne!(z_pass, z_fail);
}

/// The same with every face counted, whatever the depth: 0 wherever the near plane is outside.
#[test]
fn a_closed_volume_counts_to_zero_when_nothing_hides_it() {
    let mut session = session();
    let mut scene = from_above(vec![torn(&torus(2.0)), cuboid("box", [-3.0, 1.0, -1.0], [-1.5, 2.0, 0.5])]);
    for light in [Light::point(DVec3::new(0.5, 5.0, 0.2)), Light::directional(DVec3::new(0.3, 1.0, 0.2))] {
        scene.lights = vec![light];
        let plan = session.plan(&scene, &request(Technique::ZFail, SIZE)).expect("a plan");
        let counted = |session: &mut Session, plan: &FramePlan| {
            stencil_before_mask(&session.capture_plan(&scene, plan).expect("a capture"))
        };
        let mut all = always(plan);
        assert!(counted(&mut session, &all).iter().all(|count| *count == 0));
        // Every part was drawn: without one, what it closes is open.
        let parts = |plan: &mut FramePlan, part| {
            plan.passes.iter_mut().for_each(|pass| pass.draws.retain(|draw| draw.part != part))
        };
        parts(&mut all, DrawPart::LightCap);
        assert!(counted(&mut session, &all).iter().any(|count| *count != 0));
    }
}

fn always(mut plan: FramePlan) -> FramePlan {
    let draws = plan.passes.iter_mut().filter(|pass| pass.name == "volumes").flat_map(|pass| &mut pass.draws);
    for draw in draws.filter(|draw| draw.part.is_of_volume()) {
        draw.raster.depth_compare = CompareFunction::Always;
        let pass = |face: &StencilFace| StencilFace {
            pass_op: face.depth_fail_op,
            depth_fail_op: StencilOperation::Keep,
            ..*face
        };
        draw.raster.stencil.front = pass(&draw.raster.stencil.front);
        draw.raster.stencil.back = pass(&draw.raster.stencil.back);
    }
    plan
}

/// Flipped, doubled and missing triangles, and fins, compared with rays: from near, and from so far that a leak would
/// be a streak across the whole picture.
#[test]
fn all_casters_leave_no_leak_on_any_mesh() {
    let mut session = session();
    for caster in [torus(2.0), torn(&torus(2.0))] {
        let mut scene = under(Light::point(DVec3::new(1.3, 4.1, 0.4)), vec![caster]);
        for eye in [DVec3::new(3.0, 5.0, 4.0), DVec3::new(0.4, 1.1, 0.3), DVec3::new(90.0, 60.0, 70.0)] {
            scene.camera.eye = eye;
            scene.camera.target = DVec3::new(0.1, 0.7, 0.0);
            scene.camera.up = DVec3::Y;
            scene.camera.fov_y_degrees = if eye.x > 50.0 { 8.0 } else { 70.0 };
            let mut request = request(Technique::ZFail, [64, 48]);
            for casters in ["all", "by-topology"] {
                request.choice.set("casters", casters).expect("a setting");
                let capture = session.capture(&scene, &request).expect("a capture");
                let difference = difference(&scene, &capture, 0);
                let most = if adapter::draws_as_given() { 0 } else { 1 };
                assert!(difference.wrong <= most, "{casters} {eye} {difference:?}");
                assert!(difference.compared > 500 && difference.labels[1] > 0, "{eye} {difference:?}");
            }
        }
    }
}
