//! What tests share: a session on the reference adapter, and small scenes with known answers.

pub mod adapter;
mod apart;
pub mod faults;
pub mod plans;
pub mod random;
pub mod ray_cast;
#[cfg(feature = "inspector")]
pub mod report;
pub mod shade;

pub use apart::apart;
use glam::DMat3;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use stencilscope::capture::{Capture, CapturedLight, FrameSnapshot, Snapshot};
use stencilscope::progress::Progress;
use stencilscope::scene::{Camera, Light, Mesh, Object, OpenSpec, Scene, SceneBuilder, open, shapes};
use stencilscope::session::{CaptureRequest, RunFrame, Session};
use stencilscope::technique::{Choice, Technique};

/// A session on the reference adapter; without one the test fails.
pub fn session() -> Session {
    Session::new(None).expect("the reference adapter (Debian: mesa-vulkan-drivers)")
}

/// A technique with its defaults, untimed.
pub fn request(technique: Technique, size: [u32; 2]) -> CaptureRequest {
    CaptureRequest::new(Choice::new(technique), size)
}

/// A technique with settings, and the rest of them as they are by default.
pub fn choice(technique: Technique, settings: &[(&str, &str)]) -> Choice {
    let mut choice = Choice::new(technique);
    settings.iter().for_each(|(key, value)| choice.set(key, value).expect("a setting"));
    choice
}

/// A request for a technique with settings, untimed.
pub fn request_with(technique: Technique, settings: &[(&str, &str)], size: [u32; 2]) -> CaptureRequest {
    CaptureRequest::new(choice(technique, settings), size)
}

/// A scene by the name that it is opened by: a built-in scene's, or a file.
pub fn opened(name: &str) -> Scene {
    open(&OpenSpec::new(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A frame of a scene by its name, with its plan.
pub fn frame(session: &mut Session, name: &str, request: CaptureRequest) -> RunFrame {
    session.render(opened(name), request).expect("a frame")
}

/// All pixels of a picture, row by row.
pub fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
}

/// A mesh from points and triangles.
pub fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Arc<Mesh> {
    Arc::new(shapes::triangles(positions, triangles).expect("a mesh"))
}

/// A level square of half-width `half` at height `y`, seen from above in front.
pub fn square(name: &str, y: f64, half: f64) -> Object {
    let corners = [[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]];
    Object::of(name, mesh(&corners, &[[0, 1, 2], [0, 2, 3]]))
}

/// A closed box between two corners.
pub fn cuboid(name: &str, low: [f64; 3], high: [f64; 3]) -> Object {
    let at = |i: usize, axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
    let corners: Vec<[f64; 3]> = (0..8).map(|i| [at(i, 0), at(i, 1), at(i, 2)]).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Object::of(name, mesh(&corners, &triangles))
}

/// Objects over a large floor at y = 0, a point light 4 above the origin, and an eye that looks
/// straight down from 10 above: pixels are squares of the floor.
pub fn from_above(objects: Vec<Object>) -> Scene {
    SceneBuilder::new("test")
        .ambient([0.1; 3])
        .camera(Camera { fov_y_degrees: 90.0, near: 0.1, ..Camera::looking([0.0, 10.0, 0.0], [0.0; 3]) })
        .light(Light::point([0.0, 4.0, 0.0]))
        .object(square("floor", 0.0, 50.0))
        .objects(objects)
        .build()
}

/// The scene of `from_above` under another light.
pub fn under(light: Light, objects: Vec<Object>) -> Scene {
    Scene { lights: vec![light], ..from_above(objects) }
}

/// An object with other triangles of the same corners.
pub fn remeshed(object: &Object, triangles: &[[u32; 3]]) -> Object {
    let positions: Vec<[f64; 3]> = object.mesh.positions().iter().map(|at| at.to_array()).collect();
    Object { mesh: mesh(&positions, triangles), ..object.clone() }
}

/// Is each edge used as often one way as the other?
pub fn is_closed(mesh: &Mesh) -> bool {
    let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for [a, b, c] in mesh.triangles() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let step = if from < to { 1 } else { -1 };
            *edges.entry([*from.min(to), *from.max(to)]).or_default() += step;
        }
    }
    edges.values().all(|sum| *sum == 0)
}

/// Six times what an object encloses in world space, positive where its fronts face outwards.
pub fn volume(scene: &Scene, name: &str) -> f64 {
    let object = scene.objects.iter().find(|object| object.name == name).expect("an object");
    let world = object.world_positions();
    let six = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| world[corner as usize]);
        DMat3::from_cols(a, b, c).determinant()
    };
    object.mesh.triangles().iter().map(six).sum()
}

/// What a technique says of every pixel, light by light.
pub fn labels(capture: &Capture) -> Vec<Vec<u8>> {
    let of = |light: &CapturedLight| light.shadow.as_ref().expect("labels").rows().flatten().copied().collect();
    capture.lights.iter().map(of).collect()
}

/// The stencil of a frame, pixel by pixel.
pub fn stencil(frame: &FrameSnapshot) -> Vec<u8> {
    frame.stencil.as_ref().expect("a stencil").image.rows().flatten().copied().collect()
}

/// The stencil before the mask, which reads it.
pub fn stencil_before_mask(capture: &Capture) -> Vec<u8> {
    let mask = capture.steps.iter().position(|step| step.name == "mask").expect("a mask");
    let Snapshot::Frame(frame) = &capture.steps[mask - 1].snapshot else { panic!("a frame") };
    stencil(frame)
}

/// How many pixels of light 0 have each label.
pub fn label_counts(capture: &Capture) -> [u64; 4] {
    let histogram = capture.lights[0].shadow.as_ref().expect("labels").histogram();
    [histogram[0], histogram[1], histogram[2], histogram[3]]
}

/// Names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A capture compared with the ground truth.
pub fn judged(session: &mut Session, scene: &Scene, technique: Technique, size: [u32; 2]) -> Capture {
    judged_by(session, scene, &request(technique, size))
}

pub fn judged_by(session: &mut Session, scene: &Scene, request: &CaptureRequest) -> Capture {
    let capture = session.capture(scene, request).expect("a capture");
    session.judged(scene, &capture, &Progress::default()).expect("a truth")
}

/// Wrong pixels of all lights.
pub fn wrong(judged: &Capture) -> u64 {
    judged.lights.iter().filter_map(|light| light.truth.as_ref()).map(|truth| truth.error.wrong()).sum()
}

/// The finished picture.
pub fn last_frame(capture: &Capture) -> &FrameSnapshot {
    capture.frame_at(capture.steps.len() - 1).expect("a picture")
}
