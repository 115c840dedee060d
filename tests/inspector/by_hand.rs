//! Captures made by hand: no GPU, and every value known.

use super::*;
use glam::{DMat4, DVec4};
use stencilscope::accuracy::{ErrorCounts, Finding, WrongRegion};
use stencilscope::capture::{
    AdapterInfo, Aspect, CapturedLight, CapturedMap, CapturedTruth, DrawState, DrawSummary, FrameSnapshot, FrameTarget,
    Snapshot, Step, StoredQuantity, Timing,
};
use stencilscope::math::depth::DepthMapping;
use stencilscope::math::projection::perspective;
use stencilscope::plan::{CountedSide, DecidedBy, Decision, LeftOut};
use stencilscope::scene::Camera;

fn camera() -> Camera {
    Camera { near: 0.1, ..Camera::looking([0.0, 0.0, 1.0], [0.0; 3]) }
}

fn image_of<const N: usize>(format: PixelFormat, size: [u32; 2], texel: impl Fn(u32, u32) -> [u8; N]) -> Arc<Image> {
    let bytes: Vec<u8> = common::pixels(size).flat_map(|[x, y]| texel(x, y)).collect();
    Arc::new(Image::packed(format, size, bytes))
}

fn draw(name: &str, part: DrawPart, triangles: u64) -> DrawSummary {
    DrawSummary { name: name.to_owned(), caster: Some("box".to_owned()), part, triangles, after: None, differs: None }
}

fn step(name: &str, light: Option<usize>, draws: Vec<DrawSummary>, snapshot: Snapshot) -> Step {
    let purpose = format!("Why {name} is there.");
    Step { name: name.to_owned(), purpose, light, draws, gpu_ms: Some(1.25), snapshot }
}

/// Z-fail by hand: the left half of the picture is inside one volume, a corner of it inside 255
/// (−1), the last column is background.
pub fn z_fail(size: [u32; 2]) -> Capture {
    let count = move |x: u32, y: u32| match (x, y) {
        (0, 0) => 255,
        (x, _) if x < size[0] / 2 => 1,
        _ => 0,
    };
    let is_background = move |x: u32| x + 1 == size[0] && size[0] > 1;
    let dark = image_of(PixelFormat::Rgba8Srgb, size, |_, _| [20, 20, 24, 255]);
    let lit =
        image_of(
            PixelFormat::Rgba8Srgb,
            size,
            |x, y| if count(x, y) == 0 { [200, 180, 90, 255] } else { [20, 20, 24, 255] },
        );
    let depth = image_of(PixelFormat::Depth32F, size, |x, _| {
        let depth = if is_background(x) { 0.0 } else { 0.1 / (1.0 + x as f32) };
        depth.to_le_bytes()
    });
    let zero = Arc::new(Image::uniform(PixelFormat::U8, size, &[0]));
    let counts = image_of(PixelFormat::U8, size, |x, y| [count(x, y)]);
    let after_light = image_of(PixelFormat::U8, size, |x, y| [if count(x, y) == 0 { 1 } else { count(x, y) }]);
    let labels = image_of(PixelFormat::U8, size, |x, y| match count(x, y) {
        _ if is_background(x) => [2],
        0 => [0],
        _ => [1],
    });
    let new = |image: &Arc<Image>| Aspect { image: image.clone(), unchanged: false };
    let old = |image: &Arc<Image>| Aspect { image: image.clone(), unchanged: true };
    let frame = |color, depth, stencil, writes_labels: bool| {
        let target = if writes_labels { FrameTarget::Labels } else { FrameTarget::Picture };
        Snapshot::Frame(FrameSnapshot { color, depth, stencil: Some(stencil), target })
    };
    let volumes = vec![draw("sides of box", DrawPart::Side, 24), draw("dark cap of box", DrawPart::DarkCap, 1212)];
    Capture {
        profile: None,
        scene: "by hand".to_owned(),
        technique: "z-fail".to_owned(),
        settings: BTreeMap::from([("depth".to_owned(), "reversed-infinite".to_owned())]),
        size,
        adapter: AdapterInfo { name: "none (made by hand)".to_owned(), driver: "1".to_owned(), kind: "cpu".to_owned() },
        camera: camera(),
        depth: DepthMapping::ReversedInfinite.curve(camera().near, 0.0, 0.0),
        steps: vec![
            step(
                "ambient",
                None,
                vec![draw("floor", DrawPart::Surface, 2)],
                frame(new(&dark), new(&depth), new(&zero), false),
            ),
            step("volumes", Some(0), volumes, frame(old(&dark), old(&depth), new(&counts), false)),
            step("mask", Some(0), Vec::new(), frame(old(&dark), old(&depth), old(&counts), true)),
            step(
                "light",
                Some(0),
                vec![draw("floor", DrawPart::Surface, 2)],
                frame(new(&lit), old(&depth), new(&after_light), false),
            ),
        ],
        lights: vec![CapturedLight {
            position: DVec4::new(0.0, 4.0, 0.0, 1.0),
            of_casters: Default::default(),
            count_of: None,
            decided_by: DecidedBy::StencilCount { side: CountedSide::Behind },
            shadow: Some(labels),
            count: None,
            visibility: None,
            map: None,
            truth: None,
        }],
        left_out: vec![LeftOut::new(Decision::Clear, "light 1", "nothing has written the stencil before")],
        timing: Timing { frame_ms: Some(6.25), ..Timing::default() },
        plan_text: String::new(),
        origin: None,
    }
}

/// The truth beside z-fail by hand: the shadow ends two columns earlier, ten rows of which lie at
/// an edge, and one pixel on the lit side is in shadow.
pub fn with_truth(mut capture: Capture) -> Capture {
    let size = capture.size;
    let middle = size[0] / 2;
    let mask = capture.lights[0].shadow.clone().expect("a mask");
    let finding = move |x: u32, y: u32| match (x, y) {
        (30, 10) => Finding::MissingShadow,
        (x, y) if (middle - 2..middle).contains(&x) && y < 20 => Finding::FalseShadow,
        (x, _) if (middle - 2..middle).contains(&x) => Finding::EdgeBand,
        (x, _) if x + 1 == size[0] => Finding::NotCompared,
        _ => Finding::Agrees,
    };
    let labels = image_of(PixelFormat::U8, size, |x, y| match finding(x, y) {
        Finding::MissingShadow => [1],
        Finding::FalseShadow | Finding::EdgeBand => [0],
        _ => [mask.byte_at([x, y]).expect("a label")],
    });
    let findings = image_of(PixelFormat::U8, size, |x, y| [finding(x, y) as u8]);
    let error =
        ErrorCounts { compared: 1170, false_shadow: 40, missing_shadow: 1, edge_band: 20, ..ErrorCounts::default() };
    let worst = WrongRegion { pixels: 40, kind: Finding::FalseShadow, bounds: [18, 0, 19, 19], at: [18, 0] };
    capture.lights[0].truth = Some(CapturedTruth { labels, findings, error, worst: Some(worst), visibility: None });
    capture
}

/// The states after draws beside a capture by hand. The first draw of the volumes, the sides, has
/// counted in the upper half only. The first map pass has two draws; after the first its face is at
/// half the depth.
pub fn with_draws(mut capture: Capture) -> Capture {
    let height = capture.size[1];
    for step in &mut capture.steps {
        let last = DrawState { snapshot: step.snapshot.clone(), target: None };
        step.draws.iter_mut().for_each(|draw| draw.after = Some(last.clone()));
        let Snapshot::Frame(frame) = &step.snapshot else { continue };
        let Some(counts) = frame.stencil.as_ref().filter(|_| step.name == "volumes") else { continue };
        let after_sides = image_of(PixelFormat::U8, capture.size, |x, y| {
            let count = counts.image.byte_at([x, y]).expect("a count");
            [if y < height / 2 { count } else { 0 }]
        });
        let stencil = Some(Aspect { image: after_sides, unchanged: false });
        let snapshot = Snapshot::Frame(FrameSnapshot { stencil, ..frame.clone() });
        step.draws[0].after = Some(DrawState { snapshot, target: None });
    }
    let first = &mut capture.steps[0];
    if let Snapshot::Map { face, .. } = first.snapshot {
        let map = capture.lights[0].map.as_ref().expect("a map");
        let halfway = Arc::new(Image::uniform(PixelFormat::Depth32F, [16, 16], &0.125_f32.to_le_bytes()));
        let state = |image: &Arc<Image>| {
            let target = Some(Aspect { image: image.clone(), unchanged: false });
            Some(DrawState { snapshot: first.snapshot.clone(), target })
        };
        let states = [state(&halfway), state(&map.faces[face])];
        first.draws = ["near box", "far box"]
            .into_iter()
            .zip(states)
            .map(|(name, after)| DrawSummary { after, ..draw(name, DrawPart::Map, 12) })
            .collect();
    }
    capture
}

/// Two map passes before anything is drawn into the picture.
pub fn cube_map() -> Capture {
    let mut capture = z_fail(SIZE);
    capture.technique = "shadow-map".to_owned();
    capture.lights[0].decided_by = DecidedBy::Map;
    capture.steps.drain(1..3);
    for face in [3, 1] {
        let name = format!("map face {face}");
        capture.steps.insert(0, step(&name, Some(0), Vec::new(), Snapshot::Map { light: 0, face }));
    }
    let face = |index: usize| {
        let depth = if index == 1 || index == 3 { 0.25_f32 } else { 0.0 };
        Arc::new(Image::uniform(PixelFormat::Depth32F, [16, 16], &depth.to_le_bytes()))
    };
    capture.lights[0].map = Some(CapturedMap {
        faces: (0..6).map(face).collect(),
        layer_names: Vec::new(),
        light_from_world: DMat4::IDENTITY,
        clip_from_light: vec![perspective(90.0, 1.0, &DepthMapping::ReversedInfinite.curve(0.05, 0.0, 0.0)); 6],
        quantity: StoredQuantity::Depth,
    });
    capture
}

/// Textures of three flat pieces, of which the first two are drawn, or silhouettes of as many
/// casters. The first layer has a black half, a tinted row in it, and is white elsewhere.
pub fn layered(technique: &str, what: &str) -> Capture {
    let mut capture = z_fail(SIZE);
    technique.clone_into(&mut capture.technique);
    let is_texture = technique == "planar-texture";
    capture.lights[0].decided_by = if is_texture { DecidedBy::ReceiverTextures } else { DecidedBy::Silhouettes };
    capture.steps.drain(1..3);
    for step in &mut capture.steps {
        if let Snapshot::Frame(frame) = &mut step.snapshot {
            frame.stencil = None;
        }
    }
    for (face, of) in [(1, "wall, flat piece 2"), (0, "floor, flat piece 1")] {
        let draws = vec![draw("box", DrawPart::Map, 12)];
        let map = Snapshot::Map { light: 0, face };
        capture.steps.insert(0, step(&format!("{what} of {of}"), Some(0), draws, map));
    }
    let first = image_of(PixelFormat::Rgba8, [16, 16], |x, y| match (x, y) {
        (8.., _) => [255; 4],
        (_, 3) => [51, 0, 0, 0],
        _ => [0; 4],
    });
    let second = Arc::new(Image::uniform(PixelFormat::Rgba8, [16, 16], &[0; 4]));
    let third = Arc::new(Image::uniform(PixelFormat::Rgba8, [16, 16], &[255; 4]));
    capture.lights[0].map = Some(CapturedMap {
        faces: vec![first, second, third],
        layer_names: ["floor, flat piece 1", "wall, flat piece 2"].map(ToOwned::to_owned).to_vec(),
        light_from_world: DMat4::IDENTITY,
        clip_from_light: vec![DMat4::IDENTITY; 3],
        quantity: StoredQuantity::Depth,
    });
    capture
}

/// Z-fail by hand with its counts in floats: 1 in the left half, but −1, 256 and 300 in the first three
/// pixels.
pub fn counted_in_floats() -> Capture {
    let mut capture = z_fail(SIZE);
    capture.settings.insert("counter".to_owned(), "float".to_owned());
    capture.lights[0].decided_by = DecidedBy::FloatCount { side: CountedSide::Behind };
    let count = image_of(PixelFormat::Value32F, SIZE, |x, y| {
        let count = match (x, y) {
            (0, 0) => -1.0,
            (1, 0) => 256.0,
            (2, 0) => 300.0,
            (x, _) if x < SIZE[0] / 2 => 1.0,
            _ => 0.0_f32,
        };
        count.to_le_bytes()
    });
    for step in &mut capture.steps {
        if let Snapshot::Frame(frame) = &mut step.snapshot {
            frame.stencil = None;
            if step.name == "volumes" {
                frame.target = FrameTarget::Count;
            }
        }
    }
    capture.lights[0].count = Some(count);
    capture
}
