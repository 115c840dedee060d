//! Scenes whose every event is known.

use super::{SIZE, frame, nested_boxes};
use crate::common::{adapter, cuboid, from_above, opened, request_with, session, square};
use glam::DVec3;
use stencilscope::history::{Rung, VolumeCount};
use stencilscope::plan::{Coverage, DrawPart};
use stencilscope::scene::{Light, Scene};
use stencilscope::session::SessionError;
use stencilscope::technique::Technique;
use stencilscope::testing::{PixelLabel, Rendered};

/// A little off the axis: no edge of a box or of the floor is there.
const INSIDE: [u32; 2] = [103, 95];
const OUTSIDE: [u32; 2] = [160, 95];

fn rendered(technique: Technique, settings: &[(&str, &str)]) -> Rendered {
    let request = request_with(technique, settings, SIZE);
    Rendered::on(session(), &nested_boxes(), &request).expect("a frame")
}

/// The top of each box casts, as it is proven closed: a volume that the ray enters before the floor, and leaves at
/// infinity behind it. A box counts one.
#[test]
fn three_nested_boxes_count_three() {
    for technique in [Technique::ZFail, Technique::ZPass, Technique::ZPassPlus] {
        let mut frame = rendered(technique, &[]);
        frame.at(INSIDE).label(0, PixelLabel::Shadow).agrees().stencil_after("volumes", 3);
    }
    rendered(Technique::ZFail, &[]).at(INSIDE).events_of(
        "volumes",
        &[
            "volumes: light cap of outer, front, passes",
            "volumes: dark cap of outer, back, fails depth, stencil 0 to 1",
            "volumes: light cap of middle, front, passes",
            "volumes: dark cap of middle, back, fails depth, stencil 1 to 2",
            "volumes: light cap of inner, front, passes",
            "volumes: dark cap of inner, back, fails depth, stencil 2 to 3",
        ],
    );
}

/// Every triangle casts: each of top and bottom.
const ALL: (&str, &str) = ("casters", "all");

/// Top and bottom of each box cast, each a volume that the ray enters before the floor, and leaves at
/// infinity behind it.
#[test]
fn three_nested_boxes_by_z_fail() {
    let mut frame = rendered(Technique::ZFail, &[ALL]);
    let pixel = frame.at(INSIDE);
    pixel.label(0, PixelLabel::Shadow).agrees().distance(10.0, 1e-6).events(&[
        "ambient: clear depth",
        "ambient: clear stencil",
        "ambient: floor, front, passes, stores depth",
        "volumes: light cap of outer, front, passes",
        "volumes: light cap of outer, front, passes",
        "volumes: dark cap of outer, back, fails depth, stencil 0 to 1",
        "volumes: dark cap of outer, back, fails depth, stencil 1 to 2",
        "volumes: light cap of middle, front, passes",
        "volumes: light cap of middle, front, passes",
        "volumes: dark cap of middle, back, fails depth, stencil 2 to 3",
        "volumes: dark cap of middle, back, fails depth, stencil 3 to 4",
        "volumes: light cap of inner, front, passes",
        "volumes: light cap of inner, front, passes",
        "volumes: dark cap of inner, back, fails depth, stencil 4 to 5",
        "volumes: dark cap of inner, back, fails depth, stencil 5 to 6",
        "mask: floor, front, passes",
        "mask: floor, front, fails stencil",
        "light: floor, front, fails stencil",
    ]);
    pixel.stencil_after("ambient", 0).stencil_after("volumes", 6).stencil(6);
    let why = pixel.history().why(0).expect("volumes").to_string();
    let expected =
        "6 volume faces behind the surface fail the depth test: 6 back, 0 front; count 6, so the light pass skips it";
    assert_eq!(why, expected);
    frame.at(OUTSIDE).label(0, PixelLabel::Lit).agrees().events(&[
        "ambient: clear depth",
        "ambient: clear stencil",
        "ambient: floor, front, passes, stores depth",
        "mask: floor, front, passes",
        "mask: floor, front, passes",
        "light: floor, front, passes, stencil 0 to 1",
    ]);
}

/// What is in front counts: the same six faces of the light caps.
#[test]
fn three_nested_boxes_by_z_pass() {
    let mut frame = rendered(Technique::ZPass, &[ALL]);
    frame.at(INSIDE).agrees().label(0, PixelLabel::Shadow).events_of(
        "volumes",
        &[
            "volumes: light cap of outer, front, passes, stencil 0 to 1",
            "volumes: light cap of outer, front, passes, stencil 1 to 2",
            "volumes: light cap of middle, front, passes, stencil 2 to 3",
            "volumes: light cap of middle, front, passes, stencil 3 to 4",
            "volumes: light cap of inner, front, passes, stencil 4 to 5",
            "volumes: light cap of inner, front, passes, stencil 5 to 6",
        ],
    );
}

/// The same six in a float, which a test the other way round lets through.
#[test]
fn three_nested_boxes_in_a_float() {
    let mut frame = rendered(Technique::ZFail, &[("counter", "float"), ALL]);
    let pixel = frame.at(INSIDE);
    pixel.agrees().label(0, PixelLabel::Shadow);
    let events: Vec<String> = pixel.history().events.iter().map(|event| pixel.history().brief(event)).collect();
    assert!(events.contains(&"volumes: clear count".to_owned()), "{events:?}");
    assert!(events.contains(&"volumes: dark cap of inner, back, passes, count 5 to 6".to_owned()), "{events:?}");
    let why = pixel.history().why(0).expect("volumes").to_string();
    let expected =
        "6 volume faces behind the surface are counted: 6 back, 0 front; count 6, so the light pass skips it";
    assert!(why.starts_with(expected), "{why}");
}

/// Tops at 8, 8.1 and 8.2, bottoms at 9, 8.9 and 8.8; at infinity all six that count.
#[test]
fn the_ladder_runs_from_infinity_to_the_surface() {
    let mut frame = rendered(Technique::ZFail, &[ALL]);
    let curve = frame.capture().depth;
    let history = frame.at(INSIDE).history().clone();
    let ladder = history.ladder(0, &curve).expect("volumes");
    assert!(ladder.is_from_infinity() && ladder.start == 0 && ladder.count == 6);
    assert!((ladder.surface.expect("a floor") - 10.0).abs() < 1e-5);
    let near: Vec<f64> = ladder.rungs[..6].iter().map(|rung| (rung.distance * 1000.0).round() / 1000.0).collect();
    assert_eq!(near, [8.0, 8.1, 8.2, 8.8, 8.9, 9.0]);
    assert!(ladder.rungs[..6].iter().all(|rung| rung.added == 0 && rung.running == 6));
    assert!(ladder.rungs[6..].iter().all(|rung: &Rung| rung.distance.is_infinite() && rung.added == 1));
    let running: Vec<i32> = ladder.rungs[6..].iter().map(|rung| rung.running).collect();
    assert_eq!(running, [6, 5, 4, 3, 2, 1], "it runs inwards");
    let by_z_pass = rendered(Technique::ZPass, &[ALL]).at(INSIDE).history().ladder(0, &curve).expect("volumes");
    assert!(!by_z_pass.is_from_infinity() && by_z_pass.rungs.iter().map(|rung| rung.running).eq(1..=6));
}

/// The near plane inside the boxes: what it begins with stands in for the faces that it clips.
#[test]
fn z_pass_plus_begins_with_the_count_of_the_near_plane() {
    let mut scene = nested_boxes();
    scene.camera.near = 8.5;
    let request = request_with(Technique::ZPassPlus, &[ALL], SIZE);
    let mut frame = Rendered::on(session(), &scene, &request).expect("a frame");
    let curve = frame.capture().depth;
    let pixel = frame.at(INSIDE);
    pixel.agrees().label(0, PixelLabel::Shadow).stencil_after("near plane", 3).stencil_after("volumes", 6);
    let ladder = pixel.history().ladder(0, &curve).expect("volumes");
    assert_eq!((ladder.start, ladder.count), (3, 6));
    let why = pixel.history().why(0).expect("volumes").to_string();
    assert!(
        why.starts_with("the near plane is in 3 volumes; 3 volume faces in front of the surface pass the depth test"),
        "{why}"
    );
    let clipped = pixel.history().triangles().filter(|(_, one)| one.outcome.note().is_some());
    let notes: Vec<_> = clipped.map(|(event, one)| (event.pass_name.as_str(), one.outcome.note())).collect();
    assert_eq!(notes, [("volumes", Some("clipped: it is nearer than the near plane")); 3]);
}

/// A shadow that a student follows: flattened onto the floor, it raises the floor's mark.
#[test]
fn a_flattened_box_raises_its_receivers_mark_once() {
    let mut scene = nested_boxes();
    scene.objects.truncate(2);
    // The side that faces the light throws the whole shadow of what is closed; with the other one overlaps it.
    for (settings, expected) in [(&[][..], &[1][..]), (&[("leave-out", "none")], &[1, 0])] {
        let request = request_with(Technique::Planar, settings, SIZE);
        let mut frame = Rendered::on(session(), &scene, &request).expect("a frame");
        let pixel = frame.at(INSIDE);
        pixel.agrees().label(0, PixelLabel::Shadow).stencil_after("receivers", 2).stencil_after("shadows", 3);
        let shadows = pixel.history().triangles().filter(|(_, one)| one.part == DrawPart::PlanarShadow);
        let raised: Vec<i32> = shadows.map(|(event, _)| event.counted()).collect();
        assert_eq!(raised, expected, "the second triangle fails the stencil test");
        let why = pixel.history().why(0).expect("a shadow").to_string();
        assert_eq!(why, "the flattened shadow of outer falls on the surface here, so the light pass skips it");
    }
}

#[test]
fn a_triangle_that_is_culled_or_clipped_says_why() {
    let mut session = session();
    let mut scene = from_above(vec![cuboid("box", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0])]);
    let (_, mut plan) = frame(&mut session, &scene, Technique::ZFail, &[("leave-out", "none")], SIZE);
    plan.passes[0].draws.iter_mut().for_each(|draw| draw.raster.cull = Some(wgpu::Face::Back));
    let capture = session.capture_plan(&scene, &plan).expect("a capture");
    let history = session.history(&plan, &capture, INSIDE).expect("a history");
    assert!(history.agrees(), "{:?}", history.disagreements());
    let ambient = |history: &stencilscope::history::PixelHistory| {
        let events = history.events.iter().filter(|event| event.pass == 0 && event.triangle().is_some());
        events.map(|event| history.brief(event)).collect::<Vec<_>>()
    };
    let expected = [
        "ambient: floor, front, passes, stores depth",
        "ambient: box, back, culled",
        "ambient: box, front, passes, stores depth",
    ];
    assert_eq!(ambient(&history), expected);

    // The top is 8 away, the bottom 9, the floor 10.
    scene.camera.near = 8.5;
    scene.camera.far = Some(9.5);
    for (depth, outcomes) in [
        ("standard-finite", ["floor, front, clipped", "box, back, passes, stores depth", "box, front, clipped"]),
        (
            "standard-finite-clamp",
            ["floor, front, fails depth", "box, back, passes, stores depth", "box, front, discarded"],
        ),
    ] {
        let (capture, plan) = frame(&mut session, &scene, Technique::ZFail, &[("depth", depth)], SIZE);
        let history = session.history(&plan, &capture, INSIDE).expect("a history");
        assert!(history.agrees(), "{depth}: {:?}", history.disagreements());
        assert_eq!(ambient(&history), outcomes.map(|outcome| format!("ambient: {outcome}")), "{depth}");
    }
}

/// What geometry alone says, with no GPU: sure inside, doubtful at an edge, nothing beside it.
#[test]
fn geometry_finds_the_triangles_over_a_pixel() {
    let scene = from_above(vec![cuboid("box", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0])]);
    let (_, plan) = frame(&mut session(), &scene, Technique::None, &[], SIZE);
    let over = |pixel| {
        let covering = plan.covering(pixel).into_iter().filter(|one| one.pass == 0);
        covering.map(|one| (plan.passes[0].draws[one.draw].name.clone(), one.coverage)).collect::<Vec<_>>()
    };
    let names = |pixel| over(pixel).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    assert_eq!(names(INSIDE), ["floor", "box", "box"]);
    assert!(over(INSIDE).iter().all(|(_, coverage)| *coverage == Coverage::Sure));
    assert_eq!(names(OUTSIDE), ["floor"]);
    // The floor's diagonal runs through these pixels' centres.
    let mut there = names([50, 50]);
    // Cut to the picture, each half is two triangles.
    if !adapter::draws_as_given() {
        there.truncate(2);
    }
    assert_eq!(there, ["floor", "floor"]);
    assert!(over([50, 50]).iter().all(|(_, coverage)| *coverage == Coverage::Doubtful));
}

/// What decides is reported, and not what usually would.
#[test]
fn why_names_the_test_that_failed_and_what_nobody_asked() {
    let mut session = session();
    let mut why = |scene: &Scene, technique, settings: &[(&str, &str)], pixel| {
        let (capture, plan) = frame(&mut session, scene, technique, settings, SIZE);
        let history = session.history(&plan, &capture, pixel).expect("a history");
        history.why(0).map(|why| why.to_string()).unwrap_or_default()
    };
    let scene = nested_boxes();
    let outside = why(&scene, Technique::ZFail, &[], OUTSIDE);
    assert_eq!(outside, "no volume face on the view ray counts; count 0, so the light pass adds the light");
    assert_eq!(why(&scene, Technique::ShadowMap, &[], INSIDE), "");
    let mut deaf = nested_boxes();
    deaf.objects[0].receives = false;
    let text = why(&deaf, Technique::ZFail, &[ALL], INSIDE);
    assert!(text.contains("count 6") && text.contains("the object receives no shadows"), "{text}");
    let mut from_below = nested_boxes();
    from_below.lights = vec![Light::point(DVec3::new(0.0, -4.0, 0.0))];
    // Whether or not the light's pass draws what it adds nothing to.
    for leave_out in ["all", "none"] {
        let text = why(&from_below, Technique::ZFail, &[("leave-out", leave_out)], INSIDE);
        let expected = "count 0, so nothing keeps the light out; but it faces away from the light or is beyond its \
                        range, and stays dark";
        assert!(text.ends_with(expected), "{text}");
    }
    // A second light, which is added here, is none of its business.
    from_below.lights.push(Light::point(DVec3::new(0.0, 9.0, 0.0)));
    for counter in ["stencil", "float"] {
        let text = why(&from_below, Technique::ZFail, &[("counter", counter)], OUTSIDE);
        assert!(text.contains("count 0, so nothing keeps the light out; but it faces away"), "{counter}: {text}");
    }
    let mut to_the_sky = nested_boxes();
    to_the_sky.objects[0].visible = false;
    let text = why(&to_the_sky, Technique::ZFail, &[ALL], OUTSIDE);
    assert_eq!(text, "no surface is here that a shadow could fall on");
    // What takes away comes last in one draw with what adds, and finds nothing to take from.
    let text = why(&opened("inside"), Technique::ZFail, &[("operations", "clamp")], [100, 150]);
    assert!(text.contains("6 back, 6 front, of which 2 found the count at its limit; count 2"), "{text}");
}

/// 300 volumes: the ladder's count, and what eight bits hold of it.
#[test]
fn beyond_eight_bits_both_counts_are_reported() {
    let pane = |index: u32| {
        let mut pane = square(&format!("pane {index}"), 1.0 + f64::from(index) * 1e-3, 1.0);
        pane.visible = false;
        pane
    };
    let mut scene = from_above((0..256).map(pane).collect());
    scene.objects[0].casts = false;
    let (capture, plan) = frame(&mut session(), &scene, Technique::ZFail, &[], SIZE);
    let history = session().history(&plan, &capture, INSIDE).expect("a history");
    assert!(history.agrees());
    let text = history.why(0).expect("volumes").to_string();
    assert!(text.ends_with("together 256, which eight bits hold as 0, so the light pass adds the light"), "{text}");
    let ladder = history.ladder(0, &capture.depth).expect("volumes");
    assert_eq!((ladder.count, ladder.tested), (256, VolumeCount::Stencil(0)));
}

#[test]
fn a_pixel_outside_the_picture_is_an_error() {
    let mut session = session();
    let (capture, plan) = frame(&mut session, &nested_boxes(), Technique::None, &[], [4, 3]);
    let error = session.history(&plan, &capture, [4, 0]).expect_err("outside");
    assert!(matches!(error, SessionError::NoSuchPixel { .. }));
    assert_eq!(error.to_string(), "pixel 4,0 is outside the picture of 4x3: choose one from 0,0 to 3,2");
}

#[test]
#[should_panic(expected = "stencil is 6, not 5, after pass 2")]
fn a_failed_assertion_reports_what_was_found() {
    rendered(Technique::ZFail, &[ALL]).at(INSIDE).stencil_after("volumes", 5);
}

#[test]
#[should_panic(expected = "dark cap of inner, triangle")]
fn a_failed_assertion_reports_the_history() {
    rendered(Technique::ZFail, &[]).at(INSIDE).label(0, PixelLabel::Lit);
}
