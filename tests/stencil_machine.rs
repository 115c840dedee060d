//! The stencil machine against the GPU: one pixel a combination, read back and compared.

use crate::common::plans::{self, OPERATIONS};
use crate::common::{from_above, session};
use stencilscope::capture::{Capture, Snapshot};
use stencilscope::math::depth::DepthMapping;
use stencilscope::plan::{ColorWrite, Draw, DrawMesh, DrawPart, FramePlan, MeshId, Pass, RasterState, StencilFace};
use stencilscope::stencil_machine::{DepthStencil, IncomingFragment, test};
use wgpu::{CompareFunction as Compare, StencilOperation as Operation};

const COMPARES: [Compare; 8] = [
    Compare::Never,
    Compare::Less,
    Compare::Equal,
    Compare::LessEqual,
    Compare::Greater,
    Compare::NotEqual,
    Compare::GreaterEqual,
    Compare::Always,
];
const VALUES: [u8; 5] = [0, 1, 127, 254, 255];
const MASKS: [u32; 4] = [0, 1, 0x0f, 0xff];
const STORED_DEPTH: f32 = 0.5;
/// Fails and passes `Greater` against the stored depth.
const DEPTHS: [f32; 2] = [0.25, 0.75];

/// Every compare function is combined with every operation in each place, on each face, with each pair of masks: the
/// three places take operations that are shifted against each other.
fn states() -> Vec<RasterState> {
    let mut states = Vec::new();
    for compare in COMPARES {
        for shift in 0..8 {
            for read_mask in MASKS {
                for write_mask in MASKS {
                    let operation = |offset: usize| OPERATIONS[(shift + offset) % 8];
                    let face = |offset: usize| StencilFace {
                        compare,
                        fail_op: operation(offset),
                        depth_fail_op: operation(offset + 1),
                        pass_op: operation(offset + 2),
                    };
                    let mut state =
                        RasterState { color: ColorWrite::None, depth_write: false, ..RasterState::surface() }
                            .with_faces(face(0), face(4), 0);
                    state.stencil.read_mask = read_mask;
                    state.stencil.write_mask = write_mask;
                    states.push(state);
                }
            }
        }
    }
    states
}

/// One draw: a state with its reference, and a face. Its pixels are every stored value × depth.
struct Case {
    state: RasterState,
    front_facing: bool,
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for state in states() {
        for stencil_reference in VALUES {
            for front_facing in [true, false] {
                cases.push(Case { state: RasterState { stencil_reference, ..state.clone() }, front_facing });
            }
        }
    }
    cases
}

const PIXELS_A_CASE: usize = VALUES.len() * DEPTHS.len();
const WIDTH: usize = 512;

/// Two triangles that cover one pixel, counter-clockwise or clockwise.
fn push_pixel(
    vertices: &mut Vec<[f32; 4]>,
    indices: &mut Vec<u32>,
    size: [u32; 2],
    pixel: usize,
    depth: f32,
    front: bool,
) {
    let clip = |value: usize, length: u32| value as f32 / length as f32 * 2.0 - 1.0;
    let [x, y] = [pixel % WIDTH, pixel / WIDTH];
    let [left, right] = [clip(x, size[0]), clip(x + 1, size[0])];
    let [top, bottom] = [-clip(y, size[1]), -clip(y + 1, size[1])];
    let first = vertices.len() as u32;
    let corners = [[left, top], [left, bottom], [right, bottom], [right, top]];
    vertices.extend(corners.map(|[x, y]| [x, y, depth, 1.0]));
    let order = if front { [0, 1, 2, 0, 2, 3] } else { [0, 2, 1, 0, 3, 2] };
    indices.extend(order.map(|corner| first + corner));
}

fn draw(raster: RasterState, mesh: usize, triangles: std::ops::Range<u32>) -> Draw {
    Draw { triangles, ..Draw::of_positions("quads", DrawPart::Surface, MeshId(mesh), 0, raster) }
}

fn pass(name: &str, clear: bool, draws: Vec<Draw>) -> Pass {
    plans::pass(name, clear.then_some((STORED_DEPTH, 0)), draws)
}

fn mesh(name: &str, vertices: Vec<[f32; 4]>, indices: Vec<u32>) -> DrawMesh {
    DrawMesh::of_positions(name, vertices, indices)
}

/// First every pixel is given its stored value, then every case is drawn once over its pixels.
fn plan(cases: &[Case]) -> FramePlan {
    let rows = (cases.len() * PIXELS_A_CASE).div_ceil(WIDTH);
    let size = [WIDTH as u32, rows as u32];
    let replace = StencilFace { compare: Compare::Always, pass_op: Operation::Replace, ..StencilFace::IGNORE };
    let store = RasterState {
        depth_compare: Compare::Always,
        depth_write: false,
        color: ColorWrite::None,
        ..RasterState::surface()
    };
    let (mut vertices, mut indices, mut prepare) = (Vec::new(), Vec::new(), Vec::new());
    for (slot, value) in VALUES.into_iter().enumerate() {
        let start = indices.len() as u32 / 3;
        for case in 0..cases.len() {
            for depth in 0..DEPTHS.len() {
                let pixel = case * PIXELS_A_CASE + slot * DEPTHS.len() + depth;
                push_pixel(&mut vertices, &mut indices, size, pixel, 0.5, true);
            }
        }
        prepare.push(draw(store.clone().with_stencil(replace, value), 0, start..indices.len() as u32 / 3));
    }
    let stored = mesh("stored", vertices, indices);
    let (mut vertices, mut indices, mut tests) = (Vec::new(), Vec::new(), Vec::new());
    for (index, case) in cases.iter().enumerate() {
        let start = indices.len() as u32 / 3;
        for pixel in 0..PIXELS_A_CASE {
            let depth = DEPTHS[pixel % DEPTHS.len()];
            push_pixel(&mut vertices, &mut indices, size, index * PIXELS_A_CASE + pixel, depth, case.front_facing);
        }
        tests.push(draw(case.state.clone(), 1, start..indices.len() as u32 / 3));
    }
    let meshes = vec![stored, mesh("tested", vertices, indices)];
    let passes = vec![pass("store", true, prepare), pass("test", false, tests)];
    let depth = DepthMapping::ReversedInfinite.curve(1.0, 0.0, 0.0);
    let format = wgpu::TextureFormat::Depth32FloatStencil8;
    plans::plan("stencil test", depth, (format, size), meshes, passes)
}

fn stencil_after(capture: &Capture, step: usize, pixel: usize) -> u8 {
    let Snapshot::Frame(frame) = &capture.steps[step].snapshot else { panic!("no frame") };
    let image = &frame.stencil.as_ref().expect("a stencil").image;
    image.byte_at([(pixel % WIDTH) as u32, (pixel / WIDTH) as u32]).expect("a pixel")
}

#[test]
fn the_machine_agrees_with_the_gpu_on_every_function_operation_place_face_reference_and_mask() {
    let cases = cases();
    let capture = session().capture_plan(&from_above(Vec::new()), &plan(&cases)).expect("a capture");
    for (index, case) in cases.iter().enumerate() {
        for pixel in 0..PIXELS_A_CASE {
            let (value, depth) = (VALUES[pixel / DEPTHS.len()], DEPTHS[pixel % DEPTHS.len()]);
            let at = index * PIXELS_A_CASE + pixel;
            assert_eq!(stencil_after(&capture, 0, at), value, "the stored value of pixel {at}");
            let stored = DepthStencil { depth: STORED_DEPTH, stencil: value };
            let outcome = test(&case.state, IncomingFragment { depth, front_facing: case.front_facing }, stored);
            let on_gpu = stencil_after(&capture, 1, at);
            let front = case.front_facing;
            assert_eq!(outcome.after.stencil, on_gpu, "{value} stored, depth {depth}, front {front}\n{}", case.state);
        }
    }
}

/// Fragments below, at and above the stored depth.
const COMPARED_DEPTHS: [f32; 3] = [0.25, STORED_DEPTH, 0.75];

/// Every depth compare function is tried with a smaller, an equal and a larger depth, with and without writing: the
/// count shows whether the test passed, the depth what was stored.
#[test]
fn the_machine_agrees_with_the_gpu_on_every_depth_test() {
    let count = StencilFace {
        compare: Compare::Always,
        fail_op: Operation::Keep,
        depth_fail_op: Operation::Invert,
        pass_op: Operation::IncrementWrap,
    };
    let mut states = Vec::new();
    for depth_compare in COMPARES {
        for depth_write in [false, true] {
            let base = RasterState { depth_compare, depth_write, color: ColorWrite::None, ..RasterState::surface() };
            states.push(base.with_stencil(count, 0));
        }
    }
    let size = [WIDTH as u32, 1];
    let (mut vertices, mut indices, mut draws) = (Vec::new(), Vec::new(), Vec::new());
    for (index, state) in states.iter().enumerate() {
        let start = indices.len() as u32 / 3;
        for (slot, depth) in COMPARED_DEPTHS.into_iter().enumerate() {
            push_pixel(&mut vertices, &mut indices, size, index * COMPARED_DEPTHS.len() + slot, depth, true);
        }
        draws.push(draw(state.clone(), 0, start..indices.len() as u32 / 3));
    }
    let mut plan = plan(&[]);
    plan.size = size;
    plan.attachments[0].size = size;
    plan.meshes = vec![mesh("tested", vertices, indices)];
    plan.passes = vec![pass("test", true, draws)];
    let capture = session().capture_plan(&from_above(Vec::new()), &plan).expect("a capture");
    let Snapshot::Frame(frame) = &capture.steps[0].snapshot else { panic!("no frame") };
    for (index, state) in states.iter().enumerate() {
        for (slot, depth) in COMPARED_DEPTHS.into_iter().enumerate() {
            let stored = DepthStencil { depth: STORED_DEPTH, stencil: 0 };
            let outcome = test(state, IncomingFragment { depth, front_facing: true }, stored);
            let at = (index * COMPARED_DEPTHS.len() + slot) as u32;
            assert_eq!(stencil_after(&capture, 0, at as usize), outcome.after.stencil, "{depth}\n{state}");
            assert_eq!(frame.depth.image.depth_at([at, 0]), Some(outcome.after.depth), "{depth}\n{state}");
        }
    }
}
