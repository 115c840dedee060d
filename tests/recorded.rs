//! Plans as another program's frame needs them: clip-space vertices, viewports, either front face, masks of each face,
//! depths in 16 and 24 bits, targets that hold something before. Against closed forms, and history against the GPU.

use crate::common::plans::{self, OPERATIONS};
use crate::common::random::Random;
use crate::common::{from_above, pixels, session};
use stencilscope::capture::Capture;
use stencilscope::math::depth::DepthMapping;
use stencilscope::plan::{
    Blob, ColorWrite, Draw, DrawMesh, DrawPart, FaceMasks, FramePlan, Pass, Program, RasterState, RecordedPass,
    ShaderEffect, StartContent, StencilFace, Viewport, lint,
};
use wgpu::{CompareFunction as Compare, StencilOperation as Operation, TextureFormat};

const SIZE: [u32; 2] = [40, 30];

fn of_program(raster: RasterState, mesh: usize, triangles: u32) -> Draw {
    let program = Program::Recorded { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::No };
    let mesh = stencilscope::plan::MeshId(mesh);
    Draw { program, ..Draw::of_positions("draw", DrawPart::Surface, mesh, triangles, raster) }
}

fn pass(viewport: Viewport, start: Option<StartContent>, draws: Vec<Draw>) -> Pass {
    let recorded = Some(Box::new(RecordedPass { viewport, groups: vec!["frame".to_owned()], darkens: false, start }));
    Pass { recorded, ..plans::pass("recorded", None, draws) }
}

fn plan(format: TextureFormat, meshes: Vec<DrawMesh>, passes: Vec<Pass>) -> FramePlan {
    let depth = DepthMapping::StandardFinite.curve(1.0, 100.0, 0.0);
    plans::plan("recorded", depth, (format, SIZE), meshes, passes)
}

fn run(plan: &FramePlan) -> Capture {
    assert_eq!(lint::check(plan), []);
    session().capture_plan(&from_above(Vec::new()), plan).expect("a capture")
}

fn stored(capture: &Capture, at: [u32; 2]) -> (f32, u8) {
    let frame = capture.frame_at(capture.steps.len() - 1).expect("a frame");
    let stencil = &frame.stencil.as_ref().expect("a stencil").image;
    (frame.depth.image.depth_at(at).expect("a depth"), stencil.byte_at(at).expect("a stencil"))
}

/// Everything that passes is stored, and adds one to the stencil: 1 for a front, 16 for a back.
fn counting() -> RasterState {
    let replace = StencilFace { compare: Compare::Always, pass_op: Operation::Replace, ..StencilFace::IGNORE };
    let state = RasterState { depth_compare: Compare::Always, color: ColorWrite::None, ..RasterState::surface() };
    let mut state = state.with_stencil(replace, 1);
    state.back = Some(FaceMasks { reference: 0x10, read: 0xff, write: 0xff });
    state
}

/// A triangle that covers all of clip space at a depth, counter-clockwise or clockwise.
fn sheet(depth: f32, is_ccw: bool) -> DrawMesh {
    let corners = vec![[-1.0, -1.0, depth, 1.0], [3.0, -1.0, depth, 1.0], [-1.0, 3.0, depth, 1.0]];
    DrawMesh::of_positions("sheet", corners, if is_ccw { vec![0, 1, 2] } else { vec![0, 2, 1] })
}

fn content(depth: f32, stencil: u8) -> Option<StartContent> {
    let texels = (SIZE[0] * SIZE[1]) as usize;
    Some(StartContent { depth: Some(Blob::new(vec![depth; texels])), stencil: Some(Blob::new(vec![stencil; texels])) })
}

const FORMAT: TextureFormat = TextureFormat::Depth32FloatStencil8;

#[test]
fn a_viewport_moves_scales_and_maps_depth_and_the_rest_keeps_what_was_there() {
    let viewport = Viewport { area: [10.0, 5.0, 20.0, 10.0], depth: [0.25, 0.75] };
    let draws = vec![of_program(counting(), 0, 1)];
    let capture = run(&plan(FORMAT, vec![sheet(0.5, true)], vec![pass(viewport, content(0.125, 7), draws)]));
    for [x, y] in pixels(SIZE) {
        let is_in = (10..30).contains(&x) && (5..15).contains(&y);
        assert_eq!(stored(&capture, [x, y]), if is_in { (0.5, 1) } else { (0.125, 7) }, "{x},{y}");
    }
}

#[test]
fn either_way_round_is_the_front_and_each_face_has_its_own_reference() {
    for front_face in [wgpu::FrontFace::Ccw, wgpu::FrontFace::Cw] {
        for is_ccw in [true, false] {
            let state = RasterState { front_face, ..counting() };
            let draws = vec![of_program(state, 0, 1)];
            let passes = vec![pass(Viewport::whole(SIZE), content(0.0, 0), draws)];
            let capture = run(&plan(FORMAT, vec![sheet(0.5, is_ccw)], passes));
            let is_front = is_ccw == (front_face == wgpu::FrontFace::Ccw);
            assert_eq!(stored(&capture, [20, 15]).1, if is_front { 1 } else { 0x10 });
        }
    }
}

#[test]
fn masks_of_each_face_hold_for_that_face_alone() {
    let count = StencilFace { compare: Compare::Always, pass_op: Operation::Invert, ..StencilFace::IGNORE };
    let mut state = counting().with_stencil(count, 0);
    state.stencil.write_mask = 0x0f;
    state.back = Some(FaceMasks { reference: 0, read: 0xff, write: 0xf0 });
    for (is_ccw, expected) in [(true, 0b1010_0101), (false, 0b0101_1010)] {
        let draws = vec![of_program(state.clone(), 0, 1)];
        let passes = vec![pass(Viewport::whole(SIZE), content(0.0, 0b1010_1010), draws)];
        let capture = run(&plan(FORMAT, vec![sheet(0.5, is_ccw)], passes));
        assert_eq!(stored(&capture, [20, 15]).1, expected);
    }
}

#[test]
fn integer_depths_are_stored_as_the_nearest_of_their_format() {
    for (format, steps) in [(TextureFormat::Depth24PlusStencil8, 16_777_215.0_f64), (FORMAT, 0.0)] {
        for depth in [0.0_f32, 0.1, 0.3, 0.333_333_3, 0.5, 0.700_000_05, 0.999_999_94, 1.0] {
            let draws = vec![of_program(counting(), 0, 1)];
            let passes = vec![pass(Viewport::whole(SIZE), content(0.0, 0), draws)];
            let capture = run(&plan(format, vec![sheet(depth, true)], passes));
            let (stored, _) = stored(&capture, [20, 15]);
            // A rasterizer may round the sum of the corners' depths in the last bit.
            let difference = f64::from(stored) - f64::from(depth);
            assert!(difference.abs() < 1.2e-7, "{format:?} {depth} {stored}");
            // A shader divides by the number of steps, for which WGSL allows 2.5 units in the last place.
            let nearest = (f64::from(stored) * steps).round() / steps.max(1.0);
            let last_places = 2.5 * f64::from(f32::EPSILON) * nearest;
            assert!((f64::from(stored) - nearest).abs() <= last_places || steps == 0.0, "{format:?} {depth} {stored}");
        }
    }
}

/// A frame of nothing but chance: triangles that cross the eye, states, faces, masks, viewports, formats, content.
fn chance(random: &mut Random) -> FramePlan {
    const COMPARES: [Compare; 5] =
        [Compare::Less, Compare::LessEqual, Compare::Greater, Compare::Always, Compare::NotEqual];
    let formats = [FORMAT, TextureFormat::Depth24PlusStencil8];
    let mut byte = {
        let mut bytes = Random::new(random.below(1 << 30).into());
        move || bytes.below(256) as u8
    };
    let mut meshes = Vec::new();
    let mut passes = Vec::new();
    for index in 0..4_usize {
        let has_masks_of_its_own = random.below(3) == 0;
        // Faces with masks of their own are two draws for wgpu: of several triangles they would come in another order.
        let count = if has_masks_of_its_own { 1 } else { 1 + random.below(12) };
        let mut corner = || {
            let [x, y] = [random.unit() * 4.0 - 2.0, random.unit() * 4.0 - 2.0];
            let w = random.unit() * 2.5 - 0.5;
            [x as f32, y as f32, (random.unit() * 1.2 * w) as f32, w as f32]
        };
        let vertices = (0..count * 3).map(|_| corner()).collect();
        meshes.push(DrawMesh::of_positions("soup", vertices, (0..count * 3).collect()));
        let compare = COMPARES[random.below(5) as usize];
        let mut operation = || OPERATIONS[random.below(8) as usize];
        let mut face =
            || StencilFace { compare, fail_op: operation(), depth_fail_op: operation(), pass_op: operation() };
        let state = RasterState { color: ColorWrite::None, ..RasterState::surface() };
        let mut state = state.with_faces(face(), face(), byte());
        state.stencil.read_mask = byte().into();
        state.stencil.write_mask = byte().into();
        state.depth_compare = COMPARES[random.below(5) as usize];
        state.depth_write = random.below(2) == 0;
        state.front_face = if random.below(2) == 0 { wgpu::FrontFace::Ccw } else { wgpu::FrontFace::Cw };
        state.cull = [None, None, Some(wgpu::Face::Front), Some(wgpu::Face::Back)][random.below(4) as usize];
        state.unclipped_depth = random.below(3) == 0;
        state.back = has_masks_of_its_own.then(|| FaceMasks { reference: byte(), read: byte(), write: byte() });
        let near = random.unit() as f32 * 0.5;
        let viewport = Viewport {
            area: [random.below(10) as f32, random.below(8) as f32, 20.0, 18.0],
            depth: [near, near + random.unit() as f32 * 0.5],
        };
        let viewport = if random.below(2) == 0 { viewport } else { Viewport::whole(SIZE) };
        let start = (index == 0 || random.below(3) == 0).then(|| {
            let texels = SIZE[0] * SIZE[1];
            let steps = 16_777_215.0;
            let mut depth = || ((random.unit() * steps).round() as f32) / steps as f32;
            let depth = (0..texels).map(|_| depth()).collect();
            StartContent {
                depth: Some(Blob::new(depth)),
                stencil: Some(Blob::new((0..texels).map(|_| byte()).collect())),
            }
        });
        let mut pass = pass(viewport, start, vec![of_program(state, index, count)]);
        pass.scissor = (random.below(3) == 0).then_some([4, 3, 25, 20]);
        passes.push(pass);
    }
    plan(formats[random.below(2) as usize], meshes, passes)
}

#[test]
fn histories_of_frames_of_chance_agree_with_the_gpu() {
    let (mut random, mut session) = (Random::new(3), session());
    let mut events = 0;
    for _ in 0..40 {
        let plan = chance(&mut random);
        assert_eq!(lint::check(&plan), []);
        let capture = session.capture_plan(&from_above(Vec::new()), &plan).expect("a capture");
        for _ in 0..20 {
            let pixel = SIZE.map(|side| random.below(side));
            let history = session.history(&plan, &capture, pixel).expect("a history");
            assert!(history.agrees(), "{pixel:?} {:?}\n{plan}", history.disagreements());
            events += history.events.len();
        }
    }
    assert!(events > 800, "{events}");
}

#[test]
fn a_recorded_frame_is_written_and_read_back_the_same() {
    let plan = chance(&mut Random::new(8));
    let capture = session().capture_plan(&from_above(Vec::new()), &plan).expect("a capture");
    let capture = Capture { lights: Vec::new(), ..capture };
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("out");
    let contents = stencilscope::capture::disk::FolderContents { capture: &capture, plan: Some(&plan), scene: None };
    stencilscope::capture::disk::write(contents, &folder, false).expect("written");
    let whole = stencilscope::capture::disk::read_whole(&folder).expect("read");
    assert!(whole.plan.expect("a plan") == plan);
}

#[test]
fn what_can_not_be_is_named() {
    let whole = Viewport::whole(SIZE);
    let draws = || vec![of_program(counting(), 0, 1)];
    let named = |pass: Pass, words: &str| {
        let problems = lint::check(&plan(FORMAT, vec![sheet(0.5, true)], vec![pass]));
        assert!(problems.iter().any(|problem| problem.to_string().contains(words)), "{problems:?}");
    };
    named(pass(Viewport { depth: [0.5, 0.25], ..whole }, None, draws()), "its viewport can't be");
    named(pass(Viewport { area: [0.0, 0.0, f32::NAN, 1.0], ..whole }, None, draws()), "its viewport can't be");
    let short = StartContent { depth: Some(Blob::new(vec![0.0; 3])), stencil: None };
    named(pass(whole, Some(short), draws()), "has not its size");
    named(Pass { recorded: None, ..pass(whole, None, draws()) }, "another program's draw in a pass of ours");
}
