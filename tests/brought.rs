//! What people asked about in public, as small inputs of our own with their right values.

use crate::common::{choice, request, request_with, session};
use glam::{DVec2, DVec3};
use std::fs;
use std::path::Path;
use stencilscope::diagnosis::{Cause, Diagnosis, Proof, RegionKind};
use stencilscope::film::EyeMove;
use stencilscope::progress::Progress;
use stencilscope::scene::{OpenSpec, Scene, open};
use stencilscope::session::{CaptureRequest, InjectedFault};
use stencilscope::technique::{Choice, Technique};
use stencilscope::truth::SHADOW;

const SIZE: [u32; 2] = [240, 180];

/// A unit cube as an OBJ text, its lowest corner at a place.
fn cube([x, y, z]: [f64; 3]) -> String {
    let corner = |index: usize| [x + (index >> 2) as f64, y + (index >> 1 & 1) as f64, z + (index & 1) as f64];
    let vertices = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    vertices.collect::<String>() + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
}

fn opened_from(folder: &Path, name: &str, text: &str) -> Scene {
    let file = folder.join(name);
    fs::write(&file, text).expect("written");
    open(&OpenSpec::new(file.to_string_lossy())).unwrap_or_else(|error| panic!("{error}"))
}

fn diagnosed(scene: &Scene, choice: Choice, size: [u32; 2]) -> Diagnosis {
    let request = CaptureRequest::new(choice, size);
    session().diagnose(scene, &request, InjectedFault::None, &Progress::default()).expect("a diagnosis")
}

/// A scan or a place on a map lies far from the origin: floor, light and camera are there, too, and the shadow is right.
#[test]
fn a_model_far_from_the_origin_has_its_floor_and_its_shadow() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = session();
    let mut counts = |at: [f64; 3]| {
        let scene = opened_from(folder.path(), "cube.obj", &cube(at));
        let capture = session.capture(&scene, &request(Technique::Auto, SIZE)).expect("a frame");
        let judged = session.judged(&scene, &capture, &Progress::default()).expect("a truth");
        let error = judged.error().expect("counts");
        let labels = &judged.lights[0].truth.as_ref().expect("a truth").labels;
        let dark = labels.rows().flatten().filter(|label| **label == SHADOW).count() as u64;
        assert_eq!(error.wrong(), 0, "at {at:?}");
        (error.compared, dark)
    };
    let (compared, dark) = counts([-0.5, 0.0, -0.5]);
    assert!(dark > 1000 && compared > 10_000, "{dark} dark of {compared}");
    for far in [20.0, -3000.0, 1e6, 1e7] {
        assert_eq!(counts([far, 0.0, 0.0]), (compared, dark), "{far} m along x");
        assert_eq!(counts([0.5 * far, 2.0, -far]), (compared, dark), "{far} m away, and 2 m up");
    }
    // Where the model is around its own origin, its author means that.
    let scene = opened_from(folder.path(), "cube.obj", &cube([-0.25, 0.0, -0.75]));
    let (low, high) = scene.objects[1].mesh.bounds().expect("a floor");
    assert_eq!((low.x + high.x, low.z + high.z), (0.0, 0.0));
}

const ROOM: &str = "[camera]\neye = [2.4, 2.2, 2.4]\ntarget = [-1, 0.6, -1]\nfov_y_degrees = 70\n\
    [[lights]]\nkind = \"point\"\nposition = [0, 1.5, 0]\n\
    [[objects]]\nname = \"room\"\nmesh = { shape = \"box\", size = [6, 6, 6] }\ntranslate = [0, 3, 0]\n\
    [[objects]]\nname = \"post\"\nmesh = { shape = \"box\", size = [0.3, 2, 0.3] }\ntranslate = [-1.2, 1, -1.2]\n";

/// The lit side of a post is grey, and labels call it lit: the shares of light that arrive say by how much, and the
/// texels that darken it are its own.
#[test]
fn a_filter_that_darkens_a_lit_post_is_counted_and_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = opened_from(folder.path(), "room.toml", ROOM);
    let settings = [("filter", "pcf:9"), ("size", "64")];
    let mut session = session();
    let request = request_with(Technique::ShadowMap, &settings, [320, 240]);
    let capture = session.capture(&scene, &request).expect("a frame");
    let judged = session.judged(&scene, &capture, &Progress::default()).expect("a truth");
    let error = judged.visibility_error().expect("shares of light");
    assert!(error.partly_dark > 1000 && error.darkened > 0.001, "{error:?}");
    let diagnosis = diagnosed(&scene, request.choice, [320, 240]);
    let on_post = diagnosis.regions.iter().find(|region| {
        region.kind == RegionKind::PartlyDark && region.receivers.iter().any(|receiver| receiver == "post")
    });
    let cause = on_post.expect("a region on the post").causes.first().expect("a cause");
    assert_eq!(cause.cause, Cause::Acne, "{}", cause.evidence.sentence);
    assert!(cause.evidence.holds() && cause.evidence.sentence.contains("the filter compares"), "{cause:?}");
    assert!(matches!(cause.proof, Proof::Proven | Proof::Part), "{cause:?}");
}

/// A cube of which no two sides share a corner by number, and one whose top has a corner in the middle of an edge.
#[test]
fn silhouettes_from_shared_corners_miss_what_files_split() {
    let folder = tempfile::tempdir().expect("a folder");
    let split = "v 0 0 0\nv 0 0 1\nv 0 1 1\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 1 1 1\nv 1 0 1\nv 0 0 0\nv 1 0 0\nv 1 0 1\n\
        v 0 0 1\nv 0 1 0\nv 0 1 1\nv 1 1 1\nv 1 1 0\nv 0 0 0\nv 0 1 0\nv 1 1 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\n\
        v 0 1 1\nf 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\nf 13 14 15 16\nf 17 18 19 20\nf 21 22 23 24\n";
    let junction = cube([0.0; 3]).replace("f 3 4 8 7\n", "v 0.5 1 0\nv 0.5 1 1\nf 3 4 10 9\nf 9 10 8 7\n");
    for (text, expected) in [(split, Cause::SplitVertices), (&junction, Cause::TJunction)] {
        let scene = opened_from(folder.path(), "cube.obj", text);
        let by_default = diagnosed(&scene, choice(Technique::ZFail, &[]), SIZE);
        assert!(!by_default.is_bad(), "joined, {expected} shows nowhere");
        let open = diagnosed(&scene, choice(Technique::ZFail, &[("silhouette", "shared-corners")]), SIZE);
        let first = open.regions.first().and_then(|region| region.causes.first()).expect("a cause");
        assert_eq!((first.cause, first.proof, first.pixels_left), (expected, Proof::Proven, Some(0)), "{first:?}");
    }
}

/// Where a point of the world lies between the texels of a sun's map, while the eye moves by millimetres: always at the
/// same place where the map is snapped, and somewhere else each time where it is not, so that edges crawl.
#[test]
fn a_snapped_map_moves_by_whole_texels_and_another_swims() {
    let mut scene = crate::common::opened("table");
    scene.lights = vec![stencilscope::scene::Light::directional([0.4, 1.0, 0.3])];
    let mut session = session();
    let mut places = |frustum: &str| -> Vec<DVec2> {
        let request = request_with(Technique::ShadowMap, &[("light-frustum", frustum), ("size", "256")], [64, 48]);
        let place = |step: u32| {
            let moved = EyeMove::new(scene.clone(), 6).scene(step);
            let capture = session.capture(&moved, &request).expect("a frame");
            let map = capture.lights[0].map.as_ref().expect("a map");
            let clip = map.clip_from_light[0] * map.light_from_world * DVec3::ZERO.extend(1.0);
            (clip.truncate().truncate() / clip.w * 128.0).map(|texels| texels - texels.round())
        };
        (0..6).map(place).collect()
    };
    let apart = |places: &[DVec2]| places.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max);
    let [snapped, swimming] = ["view-snapped", "view"].map(&mut places);
    assert!(apart(&snapped) < 1e-6, "{snapped:?}");
    assert!(apart(&swimming) > 1e-3, "{swimming:?}");
    let all = places("casters");
    assert!(apart(&all) < 1e-9, "a map that is fitted to what casts stands still: {all:?}");
}

/// A scene like one that somebody asked about, with what was set there, and the answer.
struct Report {
    /// Where it was asked.
    from: &'static str,
    scene: &'static str,
    technique: Technique,
    settings: &'static [(&'static str, &'static str)],
    cause: Cause,
    /// The fix as options.
    fix: &'static [&'static str],
}

const FLOOR: &str = "[[objects]]\nname = \"floor\"\nmesh = { shape = \"quad\", size = [10, 10] }\n";
const BOX_AND_BALL: &str = "[camera]\neye = [2, 3, 5]\ntarget = [0, 0, 0]\n\
    [[lights]]\nkind = \"point\"\nposition = [1.5, 3, 1.5]\n\
    [[objects]]\nname = \"box\"\nmesh = { shape = \"box\", size = [1, 1, 1] }\ntranslate = [0, 0.5, 0]\n\
    [[objects]]\nname = \"ball\"\nmesh = { shape = \"sphere\", radius = 0.4, segments = [24, 12] }\ntranslate = [1.2, 0.4, 0.6]\n";
const SUNK_BOX: &str = "[camera]\neye = [2.5, 2, 4]\ntarget = [0, 0.3, 0]\n\
    [[lights]]\nkind = \"directional\"\ntowards = [1, 1.2, 0.6]\n\
    [[objects]]\nname = \"ground\"\nmesh = { shape = \"box\", size = [8, 0.5, 8] }\ntranslate = [0, -0.25, 0]\n\
    [[objects]]\nname = \"box\"\nmesh = { shape = \"box\", size = [0.8, 1.2, 0.8] }\nrotate_degrees = [0, 30, 0]\ntranslate = [0, 0.2, 0]\n\
    [[objects]]\nname = \"wall\"\nmesh = { shape = \"box\", size = [3, 1.5, 0.1] }\ntranslate = [-0.5, 0.75, -1.2]\n";
const HILL_BEHIND_LAMP: &str = "[camera]\neye = [1.2, 3, 5]\ntarget = [0, 0.5, -1]\n\
    [[lights]]\nkind = \"point\"\nposition = [0, 1.2, 0.5]\n\
    [[objects]]\nname = \"hill\"\nmesh = { shape = \"quad\", size = [6, 3] }\nrotate_degrees = [60, 0, 0]\ntranslate = [0, 1.5, -2]\n\
    [[objects]]\nname = \"soldier\"\nmesh = { shape = \"box\", size = [0.3, 0.6, 0.3] }\ntranslate = [0.1, 0.6, 1.6]\n";
const HUGE_GROUND: &str = "[camera]\neye = [3, 3, 5]\ntarget = [0, 0.5, 0]\n\
    [[lights]]\nkind = \"directional\"\ntowards = [1, 1.5, 0.6]\n\
    [[objects]]\nname = \"ground\"\nmesh = { shape = \"box\", size = [400, 1, 400] }\ntranslate = [0, -0.5, 0]\n\
    [[objects]]\nname = \"cube\"\nmesh = { shape = \"box\", size = [1, 1, 1] }\nrotate_degrees = [0, 25, 0]\ntranslate = [0, 0.5, 0]\n";

const REPORTS: &[Report] = &[
    Report {
        from: "godotengine/godot #16787: a default bias that is too small for a lamp",
        scene: BOX_AND_BALL,
        technique: Technique::ShadowMap,
        settings: &[("bias-constant", "0"), ("bias-slope", "0")],
        cause: Cause::Acne,
        fix: &["--set bias-constant=16", "--set bias-slope=2"],
    },
    Report {
        from: "enjiushi/VulkanLearn #15: light where two bodies meet, of whose front faces the map has none",
        scene: SUNK_BOX,
        technique: Technique::ShadowMap,
        settings: &[("cull", "front"), ("bias-slope", "0")],
        cause: Cause::Aliasing,
        fix: &["--set size=2048"],
    },
    Report {
        from: "xfacter/battlegrounds3 #1: shadows that are projected backwards, too",
        scene: HILL_BEHIND_LAMP,
        technique: Technique::Projective,
        settings: &[("reverse", "on")],
        cause: Cause::ReverseProjection,
        fix: &["--set reverse=off"],
    },
    Report {
        from: "asny/three-d #373: bands of shadow in a map that a huge ground fills",
        scene: HUGE_GROUND,
        technique: Technique::ShadowMap,
        settings: &[("leave-out", "none")],
        cause: Cause::PeterPanning,
        fix: &["-t z-fail"],
    },
    Report {
        from: "emanchado/3d-die-roller #2: a shadow camera whose far plane is too near",
        scene: BOX_AND_BALL,
        technique: Technique::ShadowMap,
        settings: &[("light-frustum", "100:0.1:2")],
        cause: Cause::MapFarPlane,
        fix: &["--set light-frustum=casters"],
    },
    Report {
        from: "orbitersim/orbiter #322: a caster that the map's near plane clips",
        scene: BOX_AND_BALL,
        technique: Technique::ShadowMap,
        settings: &[("light-frustum", "100:3:9")],
        cause: Cause::MapNearPlane,
        fix: &["--set light-frustum=casters"],
    },
    Report {
        from: "colobot/colobot #1154 and JoeyDeVries/LearnOpenGL #385: outlines that are not stable while the camera moves",
        scene: SUNK_BOX,
        technique: Technique::ShadowMap,
        settings: &[("light-frustum", "view")],
        cause: Cause::MapSwims,
        fix: &["--set light-frustum=view-snapped"],
    },
];

/// What was asked in public is answered by its cause, with its numbers and the fix that helped there, and no region of
/// wrong pixels stays without a cause.
#[test]
fn reports_are_answered_by_their_cause() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut missed = Vec::new();
    for Report { from, scene, technique, settings, cause, fix } in REPORTS {
        let has_ground = scene.contains("ground");
        let text = if has_ground { (*scene).to_owned() } else { format!("{scene}{FLOOR}") };
        let scene = opened_from(folder.path(), "report.toml", &text);
        let found = diagnosed(&scene, choice(*technique, settings), [480, 360]);
        let causes = || found.regions.iter().filter_map(|region| region.causes.first());
        let answers = causes().any(|one| {
            let options = one.fix.as_ref().map_or_else(Vec::new, |fix| fix.options());
            one.cause == *cause && one.proof == Proof::Proven && one.evidence.holds() && options == *fix
        });
        if !answers || causes().count() < found.regions.len() {
            missed.push(format!("{from}:\n{}", found.to_text(&[])));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

/// A box over a ground that is one, or with a sheet in place of the box, under a sun.
const OVER_GROUND: &str = "[camera]\neye = [2.5, 2, 4]\ntarget = [0, 0.3, 0]\n\
    [[lights]]\nkind = \"directional\"\ntowards = [1, 1.2, 0.6]\n\
    [[objects]]\nname = \"ground\"\nmesh = { shape = \"box\", size = [8, 0.5, 8] }\ntranslate = [0, -0.25, 0]\n\
    [[objects]]\nname = \"caster\"\nmesh = { shape = \"box\", size = [0.8, 1.2, 0.8] }\ntranslate = [0, 0.9, 0]\n";

/// Back faces stand behind the surface that the light sees, so that a map of them has no acne; a sheet has no back to stand
/// for it, and would lose its shadow: there a greater bias is what is proposed and proven.
#[test]
fn acne_is_mended_by_drawing_back_faces_where_all_casters_are_closed() {
    let folder = tempfile::tempdir().expect("a folder");
    let sheet = OVER_GROUND.replace("shape = \"box\", size = [0.8, 1.2, 0.8]", "shape = \"quad\", size = [1.2, 1.2]");
    for (text, is_closed) in [(OVER_GROUND, true), (&sheet, false)] {
        let scene = opened_from(folder.path(), "ground.toml", text);
        let found =
            diagnosed(&scene, choice(Technique::ShadowMap, &[("filter", "pcf:9"), ("size", "256")]), [160, 120]);
        let page = found.to_text(&[]);
        let causes = found.regions.iter().flat_map(|region| &region.causes);
        let acne: Vec<_> = causes.filter(|one| one.cause == Cause::Acne && one.proof == Proof::Proven).collect();
        assert!(!acne.is_empty(), "{page}");
        let by_back_faces = acne.iter().filter(|one| {
            let options = one.fix.as_ref().map_or_else(Vec::new, |fix| fix.options());
            options == ["--set cull=front"] && one.pixels_left == Some(0)
        });
        assert_eq!(by_back_faces.count() > 0, is_closed, "{page}");
        assert_eq!(page.contains("cull=front"), is_closed, "{page}");
    }
}
