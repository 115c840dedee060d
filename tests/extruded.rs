//! Volumes that a vertex shader carries: counted as the CPU's, reported as they were drawn.

use crate::common::random::Random;
use crate::common::{adapter, cuboid, from_above, labels, opened, request_with, session, square};
use stencilscope::accuracy;
use stencilscope::capture::disk::{read_whole, write};
use stencilscope::capture::{Capture, Snapshot};
use stencilscope::plan::{Decision, DrawPart, FramePlan};
use stencilscope::progress::Progress;
use stencilscope::scene::{Camera, Projection, Scene, builtin};
use stencilscope::session::{CaptureRequest, RunFrame, Session};
use stencilscope::technique::Technique;
use stencilscope::truth::Tracer;

const SIZE: [u32; 2] = [96, 72];
const BY_SHADER: (&str, &str) = ("extruded-by", "vertex-shader");

fn with(technique: Technique, settings: &[(&str, &str)]) -> CaptureRequest {
    request_with(technique, settings, SIZE)
}

/// Captures of a scene whose volumes are extruded by the CPU and by the vertex shader.
fn both(session: &mut Session, scene: &Scene, technique: Technique, settings: &[(&str, &str)]) -> [Capture; 2] {
    [settings.to_vec(), [settings, &[BY_SHADER]].concat()]
        .map(|settings| session.capture(scene, &with(technique, &settings)).expect("a capture"))
}

/// Pixels at which the stencil differs after any pass of volumes, and how many have a count there.
fn other_counts([one, other]: &[Capture; 2]) -> [usize; 2] {
    let stencils = |capture: &Capture| -> Vec<u8> {
        let steps = capture.steps.iter().filter(|step| step.name.starts_with("volumes"));
        let frames = steps.filter_map(|step| match &step.snapshot {
            Snapshot::Frame(frame) => frame.stencil.as_ref(),
            _ => None,
        });
        frames.flat_map(|stencil| stencil.image.rows().flatten().copied().collect::<Vec<_>>()).collect()
    };
    let (one, other) = (stencils(one), stencils(other));
    assert_eq!(one.len(), other.len());
    [one.iter().zip(&other).filter(|(a, b)| a != b).count(), one.iter().filter(|count| **count != 0).count()]
}

#[test]
fn from_any_place_counts_are_those_of_the_cpu_and_no_pixel_is_wrong() {
    let mut session = session();
    let step = session.profile().expect("a profile").subpixel();
    let mut counted = 0;
    for built in builtin::ALL.iter().filter(|built| !["tiger-cage", "gate"].contains(&built.name)) {
        let scene = built.scene().expect("a scene");
        for place in 0..6 {
            let scene = Scene { camera: scene.camera.anywhere(place), ..scene.clone() };
            let tracer = Tracer::new(&scene, SIZE).expect("rays");
            let truth = tracer.trace(&Progress::default()).expect("a truth");
            let captures = both(&mut session, &scene, Technique::ZFail, &[]);
            let [other, all] = other_counts(&captures);
            counted += all;
            // An edge may run by a pixel's middle on the other side.
            // On a coarse grid it may at every edge, and here every edge has a side.
            let most = if adapter::draws_as_given() { 2 } else { 2 + all / 300 };
            assert!(other <= most, "{} from {place}: {other} of {all}", built.name);
            for (light, labels) in labels(&captures[1]).into_iter().enumerate() {
                let rows: Vec<&[u8]> = labels.chunks_exact(SIZE[0] as usize).collect();
                let wrong = accuracy::compare(&tracer, &truth, light, &rows, step).counts.wrong();
                assert_eq!(wrong, 0, "{} from {place}, light {light}", built.name);
            }
        }
    }
    assert!(counted > 10_000, "{counted}");
}

/// Whatever else is set, it is as right or as wrong as without.
#[test]
fn every_other_setting_does_what_it_does() {
    let mut session = session();
    let forms: [&[(&str, &str)]; 13] = [
        &[],
        &[("casters", "all")],
        &[("casters", "light-facing")],
        &[("casters", "light-back-facing")],
        &[("extrusion", "finite:3")],
        &[("extrusion", "finite:3"), ("far-vertices", "from-origin")],
        &[("faces", "two-pass")],
        &[("counter", "float")],
        &[("operations", "invert")],
        &[("stencil-bits", "2")],
        &[("caps", "none")],
        &[("depth", "standard-infinite")],
        &[("depth", "standard-finite")],
    ];
    let mut seen = 0;
    for name in ["inside", "two-lights", "teapot-like"] {
        let scene = opened(name);
        for (technique, settings) in forms
            .iter()
            .flat_map(|settings| [Technique::ZPass, Technique::ZFail].map(|technique| (technique, settings)))
        {
            let captures = both(&mut session, &scene, technique, settings);
            let [one, other] = [0, 1].map(|index| labels(&captures[index]).concat());
            let differ = one.iter().zip(&other).filter(|(one, other)| one != other).count();
            let most = if adapter::draws_as_given() { 2 } else { 12 };
            assert!(differ <= most, "{name} {technique:?} {settings:?}: {differ}");
            // A quad at every edge, not at those of the silhouette alone.
            let draws =
                |capture: &Capture| capture.steps.iter().flat_map(|step| step.draws.clone()).collect::<Vec<_>>();
            let sides = |capture: &Capture| -> u64 {
                draws(capture).iter().filter(|draw| draw.part == DrawPart::Side).map(|draw| draw.triangles).sum()
            };
            assert!(sides(&captures[0]) < sides(&captures[1]), "{name} {technique:?} {settings:?}");
            seen += one.iter().filter(|label| **label == 1).count();
        }
    }
    assert!(seen > 10_000, "{seen} in shadow");
}

#[test]
fn histories_in_a_folder_are_those_of_the_run_and_name_each_cap() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    // A closed box, and an open sheet: a body, and prisms.
    let scene = from_above(vec![cuboid("box", [1.0, 0.2, 0.0], [2.0, 1.1, 1.0]), square("sheet", 2.0, 1.0)]);
    let frame = session.render(scene, with(Technique::ZFail, &[BY_SHADER])).expect("a frame");
    let folder = parent.path().join("frame");
    write(frame.contents(), &folder, true).expect("written");
    let whole = read_whole(&folder).expect("read");
    assert!(whole.plan.as_ref().is_some_and(|plan| plan.meshes == frame.plan.meshes));
    let opened = RunFrame::from_folder(whole).expect("a whole frame");
    let mut random = Random::new(3);
    let mut parts = std::collections::BTreeSet::new();
    for _ in 0..200 {
        let pixel = SIZE.map(|side| random.below(side));
        let [of_run, of_folder] =
            [&frame, &opened].map(|frame| session.history(&frame.plan, &frame.capture, pixel).expect("a history"));
        assert!(of_run.agrees(), "{pixel:?}: {:?}", of_run.disagreements());
        assert_eq!(of_run, of_folder);
        parts.extend(of_run.triangles().filter(|(event, _)| event.is_of_volume()).map(|(_, one)| one.part.name()));
    }
    assert_eq!(parts.into_iter().collect::<Vec<_>>(), ["dark-cap", "light-cap", "side"]);
}

/// A folder that lies of such a volume, or of pictures, is refused in a line, or asked about without a panic.
#[test]
fn a_folder_that_lies_about_corners_is_no_panic() {
    let (parent, mut session) = (tempfile::tempdir().expect("a folder"), session());
    let scene = from_above(vec![square("sheet", 2.0, 1.0)]);
    let frame = session.render(scene, with(Technique::ZFail, &[BY_SHADER])).expect("a frame");
    let folder = parent.path().join("frame");
    write(frame.contents(), &folder, true).expect("written");
    let mut files = std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let corners = files.find(|file| file.to_string_lossy().ends_with("corners.npy")).expect("corners");
    let bytes = std::fs::read(&corners).expect("read");
    // NumPy's own: a mark of eight bytes, and how long the rest of its head is.
    let (head, values) = bytes.split_at(10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]])));
    let read_with = |values: Vec<u8>| {
        std::fs::write(&corners, [head, &values].concat()).expect("written");
        let opened = read_whole(&folder).map(RunFrame::from_folder);
        opened.map_err(|error| error.to_string())
    };
    let cut = read_with(values[..values.len() / 2].to_vec()).expect_err("half of them");
    assert!(!cut.contains('\n') && cut.contains("corners"), "{cut}");
    let odd = read_with(values.chunks(4).flat_map(|_| f32::NAN.to_le_bytes()).collect()).expect("numbers or not");
    let odd = odd.expect("a whole frame");
    for pixel in [[10, 10], [48, 36], [90, 70]] {
        session.history(&odd.plan, &odd.capture, pixel).expect("a history");
    }
}

/// What the light decides is decided by the GPU: its vertices stay as they are while it moves.
#[test]
fn a_light_that_moves_changes_no_vertex_that_is_uploaded() {
    let mut session = session();
    let mut at = |x: f64, settings: &[(&str, &str)]| {
        let mut scene = opened("tori");
        scene.lights[0].position.x += x;
        let frame = session.render(scene, with(Technique::ZFail, settings)).expect("a frame");
        let volumes = frame.plan.meshes.iter().filter(|mesh| mesh.name.starts_with("volume of"));
        let text = |plan: &FramePlan| plan.to_string();
        let hashes: Vec<_> = volumes
            .clone()
            .map(|mesh| {
                let vertices = mesh.extruded.as_ref().map_or(mesh.vertices.hash(), |of| of.corners.hash());
                (vertices, mesh.indices.hash())
            })
            .collect();
        let made: Vec<_> = volumes.map(|mesh| mesh.vertices.hash()).collect();
        assert_eq!(text(&frame.plan).contains("by its vertex shader carried"), settings == [BY_SHADER]);
        (hashes, made)
    };
    let [(uploaded, made), (again, moved)] = [0.0, 0.3].map(|x| at(x, &[BY_SHADER]));
    assert!(!uploaded.is_empty() && made != moved);
    assert_eq!(uploaded, again);
    let [(uploaded, _), (again, _)] = [0.0, 0.3].map(|x| at(x, &[]));
    assert!(uploaded.iter().zip(&again).all(|(one, other)| one != other));
}

/// Where view rays are parallel the count begins at the far end, of triangles that the CPU knows.
#[test]
fn parallel_rays_are_left_to_the_cpu() {
    let mut session = session();
    let mut scene = opened("tori");
    let half_height = scene.camera.half_height_at_target();
    scene.camera = Camera { projection: Projection::Orthographic { half_height }, ..scene.camera };
    let left_to_cpu = |capture: &Capture| {
        capture.left_out.iter().filter(|left| left.decision == Some(Decision::VertexExtrusion)).count()
    };
    let captures = both(&mut session, &scene, Technique::ZFail, &[]);
    assert_eq!(captures.each_ref().map(left_to_cpu), [0, scene.lights.len()]);
    assert!(labels(&captures[0]) == labels(&captures[1]) && other_counts(&captures)[0] == 0);
    // Z-pass begins at nothing, and no sentence says that it does.
    let in_front = both(&mut session, &scene, Technique::ZPass, &[]);
    assert!(labels(&in_front[0]) == labels(&in_front[1]));
    let left = in_front[1].left_out.iter().find(|left| left.decision == Some(Decision::VertexExtrusion)).expect("told");
    assert!(left.because.contains("no side is seen edge-on") && !left.because.contains("begins"), "{}", left.because);
    // A volume that ends has nothing at infinity.
    let finite = both(&mut session, &scene, Technique::ZFail, &[("extrusion", "finite:4")]);
    assert_eq!(finite.each_ref().map(left_to_cpu), [0, 0]);
    assert!(finite[1].left_out.iter().all(|left| left.decision != Some(Decision::AwayTriangles)));
    assert!(finite[1].steps.iter().flat_map(|step| &step.draws).any(|draw| draw.part == DrawPart::Caps));
}
