//! The Scene tab's picture against rays: is the nearest surface the one that is seen?

use super::scene_view::{anatomy_of, ball_scene, over, show};
use super::*;
use crate::common::adapter;
use crate::common::random::Random;
use egui::epaint::Primitive;
use egui_wgpu::RenderState;
use glam::{DMat4, DVec4};
use std::sync::mpsc::channel;
use std::time::Instant;
use stencilscope::anatomy::Anatomy;
use stencilscope::scene::Light;
use stencilscope::scene::builtin::ALL;
use stencilscope::viewport::{DrawnPicture, Viewports};
use stencilscope::wgpu;

const FREE: &str = "Free view of the scene";
/// Index of the free view's picture among those that are cached.
const SLOT: usize = 1;
/// Relative error of depths that are rounded to single precision, and of places on the screen that are rounded to 1/256
/// pixel.
const ROUNDING: f64 = 1e-5;
/// The same where the rasteriser makes depth of corners behind the eye, and moves them to a coarse grid.
const COARSE: f64 = 0.3;

/// What of the harness's last frame the viewport draws, and nothing else: egui's own triangles take long.
fn drawn<T>(harness: &Harness<Seen>, gpu: &RenderState, read: impl FnOnce(&DrawnPicture) -> T) -> T {
    let scale = harness.ctx.pixels_per_point();
    let triangles = harness.ctx.tessellate(harness.output().shapes.clone(), scale);
    let is_callback = |one: &egui::ClippedPrimitive| matches!(one.primitive, Primitive::Callback(_));
    let callbacks: Vec<_> = triangles.into_iter().filter(is_callback).collect();
    let size = harness.ctx.content_rect().size() * scale;
    let screen = ScreenDescriptor { size_in_pixels: [size.x as u32, size.y as u32], pixels_per_point: scale };
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut renderer = gpu.renderer.write();
    renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &callbacks, &screen);
    gpu.queue.submit([encoder.finish()]);
    let viewports = renderer.callback_resources.get::<Viewports>().expect("a picture is drawn");
    read(viewports.picture(SLOT).expect("the free view"))
}

/// A picture's depths, row by row.
fn depths(picture: &DrawnPicture, gpu: &RenderState) -> Vec<f32> {
    assert_eq!(picture.samples, 1, "while the hand moves, a CPU draws a sample a pixel");
    let size = picture.depth.size();
    let stride = (size.width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(stride * size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(picture.depth.as_image_copy(), target, size);
    gpu.queue.submit([encoder.finish()]);
    let (send, done) = channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(send.send(result)));
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a GPU");
    done.recv().expect("an answer").expect("a mapped buffer");
    let bytes = buffer.get_mapped_range(..).expect("bytes");
    let rows = bytes.chunks_exact(stride as usize).map(|row| &row[..size.width as usize * 4]);
    rows.flat_map(|row| row.chunks_exact(4)).map(|texel| f32::from_le_bytes(texel.try_into().expect("4"))).collect()
}

/// Some triangles of an object and the box about them.
struct Chunk {
    object: usize,
    /// Seen only from where the picture's eye is.
    holds: bool,
    triangles: Vec<[DVec3; 3]>,
    ends: [DVec3; 2],
}

/// All that hides what is behind it, relative to an origin.
fn chunks(anatomy: &Anatomy, origin: DVec3) -> Vec<Chunk> {
    let ends = |points: &mut dyn Iterator<Item = DVec3>| {
        points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], point| [low.min(point), high.max(point)])
    };
    let size = |[low, high]: [DVec3; 2]| (high - low).length();
    let whole = size(ends(&mut anatomy.objects.iter().flat_map(|object| object.positions.iter().copied())));
    let large =
        |object: &stencilscope::anatomy::PlacedObject| size(ends(&mut object.positions.iter().copied())) >= whole / 2.0;
    let has_contained = !anatomy.objects.iter().all(large);
    let mut found = Vec::new();
    for (index, object) in anatomy.objects.iter().enumerate().filter(|(_, object)| object.visible) {
        let holds = has_contained && large(object);
        for part in object.mesh.triangles().chunks(32) {
            let places = |corners: &[u32; 3]| corners.map(|corner| object.positions[corner as usize] - origin);
            let triangles: Vec<_> = part.iter().map(places).collect();
            let ends = ends(&mut triangles.iter().flatten().copied());
            found.push(Chunk { object: index, holds, triangles, ends });
        }
    }
    found
}

/// Whether a ray hits a box.
fn meets(from: DVec3, ahead: DVec3, [low, high]: [DVec3; 2]) -> bool {
    let (one, other) = ((low - from) / ahead, (high - from) / ahead);
    one.min(other).max_element() <= one.max(other).min_element() * (1.0 + 1e-9) + 1e-9
}

/// Distance along a ray, in lengths of `ahead`, at which it hits a triangle (Möller and Trumbore 1997).
fn hit(from: DVec3, ahead: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let across = ahead.cross(v);
    let determinant = u.dot(across);
    let relative = from - a;
    let s = relative.dot(across) / determinant;
    let other = relative.cross(u);
    let t = ahead.dot(other) / determinant;
    let is_inside = s >= 0.0 && t >= 0.0 && s + t <= 1.0;
    Some(v.dot(other) / determinant).filter(|at| is_inside && *at > 0.0)
}

/// What the ray through a point of the picture hits first: object and reversed depth.
fn seen(chunks: &[Chunk], eye: DVec3, clip_from_stage: DMat4, ndc: [f64; 2]) -> Option<(usize, f64)> {
    let back = clip_from_stage.inverse();
    let place = |depth: f64| {
        let at = back * DVec4::new(ndc[0], ndc[1], depth, 1.0);
        at.truncate() / at.w
    };
    let (from, ahead) = (place(1.0), place(0.5) - place(1.0));
    let mut nearest: Option<(usize, f64)> = None;
    for chunk in chunks.iter().filter(|chunk| meets(from, ahead, chunk.ends)) {
        for corners in &chunk.triangles {
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            // An object that contains others is glass when seen from behind.
            if chunk.holds && normal.dot(eye - corners[0]) * normal.dot(ahead) > 0.0 {
                continue;
            }
            if let Some(at) = hit(from, ahead, *corners)
                && nearest.is_none_or(|(_, other)| at < other)
            {
                nearest = Some((chunk.object, at));
            }
        }
    }
    nearest.map(|(object, at)| {
        let clip = clip_from_stage * (from + ahead * at).extend(1.0);
        (object, clip.z / clip.w)
    })
}

fn place_in(rect: Rect, random: &mut Random) -> Pos2 {
    let mut along = |low: f32, high: f32| low + (high - low) * (0.1 + 0.8 * random.unit() as f32);
    pos2(along(rect.left(), rect.right()), along(rect.top(), rect.bottom()))
}

/// All of a model's triangles go to the GPU. What a frame takes while the view is rotated is printed: the times of a
/// machine that others use too are no ground to fail.
#[test]
fn a_large_model_is_drawn_whole_while_it_is_rotated() {
    let painter = painter();
    let gpu = painter.gpu();
    let scene = ball_scene(264, 133);
    let start = Instant::now();
    let anatomy = anatomy_of(&scene, Technique::ZFail);
    println!("anatomy {:?}", start.elapsed());
    let mut harness = harness_in(over(&scene), [1562.0, 820.0]);
    show(&mut harness);
    let middle = harness.get_by_label(FREE).rect().center();
    let still = drawn(&harness, gpu, |picture| (picture.geometry.clone(), picture.samples));
    let triangles: usize = anatomy.objects.iter().map(|object| object.mesh.triangles().len()).sum();
    assert_eq!(still.0.solids.len() + still.0.holders.len(), triangles);
    press_left(&mut harness, middle);
    let mut times = Vec::new();
    for frame in 0..20 {
        harness.hover_at(middle + vec2(4.0 * frame as f32, 1.0));
        let start = Instant::now();
        harness.step();
        let panels = start.elapsed();
        let moved = drawn(&harness, gpu, |picture| (picture.geometry.clone(), picture.view));
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a GPU");
        times.push((start.elapsed(), panels, moved.1.size));
        assert!(Arc::ptr_eq(&moved.0, &still.0), "geometry stays as it is while the view turns");
    }
    times.sort_by_key(|(all, ..)| *all);
    println!("a frame of {triangles} triangles while it is turned: {:?}", times[times.len() / 2]);
    let start = Instant::now();
    harness.state_mut().inspector.take_in(AnatomyOf {}, Ok(anatomy_of(&scene, Technique::ZFail)));
    println!("another anatomy is there after {:?}", start.elapsed());
    let start = Instant::now();
    harness.step();
    println!("a frame with it: {:?}", start.elapsed());
    drawn(&harness, gpu, |picture| assert!(!Arc::ptr_eq(&picture.geometry, &still.0), "its geometry is another"));
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a GPU");
    println!("drawn after {:?}", start.elapsed());
    let start = Instant::now();
    drawn(&harness, gpu, |_| ());
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a GPU");
    println!("and while nothing changes: {:?}", start.elapsed());
}

/// From 20 cameras a scene, at 200 points each. Where within a pixel another object begins, or what a ray hits is not
/// certain, the point is excused; elsewhere the picture's depth is between those around the point.
#[test]
fn the_nearest_surface_is_the_one_a_ray_finds() {
    let rounding = if adapter::draws_as_given() { ROUNDING } else { COARSE };
    let painter = painter();
    let gpu = painter.gpu();
    // Depths of many samples can't be read back, and only the software driver draws with one.
    let kind = gpu.adapter.get_info().device_type;
    assert_eq!(kind, wgpu::DeviceType::Cpu, "the reference adapter (Debian: mesa-vulkan-drivers)");
    let mut random = Random::new(7);
    for builtin in ALL {
        let scene = builtin.scene().expect("a scene");
        let anatomy = anatomy_of(&scene, Technique::ZFail);
        let mut harness = harness_of(over(&scene));
        show(&mut harness);
        click(&mut harness, "Gizmos");
        let (mut compared, mut excused, mut hits) = (0, 0, 0);
        for projection in ["perspective", "orthographic", "cavalier", "cabinet"] {
            choose(&mut harness, "Projection of the Free view", projection);
            let rect = harness.get_by_label(FREE).rect();
            let from = place_in(rect, &mut random);
            press_left(&mut harness, from);
            for _ in 0..5 {
                harness.hover_at(place_in(rect, &mut random));
                harness.run_steps(1);
                wheel(&mut harness, (random.unit() as f32 - 0.5) * 120.0);
                let (view, origin, depths) =
                    drawn(&harness, gpu, |picture| (picture.view, picture.geometry.origin, depths(picture, gpu)));
                let chunks = chunks(&anatomy, origin);
                let clip = view.clip_from_stage.as_dmat4();
                let [width, height] = view.size.as_dvec2().to_array();
                let at = |x: f64, y: f64| {
                    let ndc = [2.0 * x / width - 1.0, 1.0 - 2.0 * y / height];
                    seen(&chunks, anatomy.camera.eye - origin, clip, ndc)
                };
                for _ in 0..200 {
                    let [x, y] = [width, height].map(|side| (random.unit() * side).floor().min(side - 1.0));
                    let found = f64::from(depths[(y * width + x) as usize]);
                    let here = at(x + 0.5, y + 0.5);
                    compared += 1;
                    hits += u64::from(here.is_some());
                    let depth = here.map_or(0.0, |(_, depth)| depth);
                    if (found - depth).abs() <= rounding * depth {
                        continue;
                    }
                    let offsets = [-1.0, -0.5, 0.0, 0.5, 1.0];
                    let around: Vec<_> =
                        offsets.iter().flat_map(|dy| offsets.map(|dx| at(x + 0.5 + dx, y + 0.5 + dy))).collect();
                    let low = around.iter().flatten().fold(depth, |low, (_, depth)| low.min(*depth));
                    let high = around.iter().flatten().fold(depth, |high, (_, depth)| high.max(*depth));
                    let is_edge = around.iter().any(|one| one.map(|one| one.0) != here.map(|one| one.0));
                    excused += u64::from(is_edge);
                    let is_near = (low * (1.0 - rounding)..=high * (1.0 + rounding)).contains(&found);
                    assert!(is_edge || is_near, "{}, {projection}, {x} {y}: {found}, a ray finds {here:?}", scene.name);
                }
            }
            harness.event(button_event(from, PointerButton::Primary, false));
            harness.run_steps(1);
        }
        println!("{}: {compared} points, {hits} on something, {excused} at an edge", scene.name);
        assert!(hits > compared / 10 && excused < compared / 20, "{}: {hits} and {excused} of {compared}", scene.name);
    }
}

/// Where what stands on the floor is on the screen, in parts of the view; all of it is before the eye.
fn share_of_view(anatomy: &Anatomy, clip_from_stage: DMat4, origin: DVec3) -> [f64; 4] {
    let objects: Vec<_> = anatomy.objects.iter().collect();
    let size = |points: &[DVec3]| {
        let low = points.iter().copied().reduce(DVec3::min).expect("vertices");
        (points.iter().copied().reduce(DVec3::max).expect("vertices") - low).length()
    };
    let all: Vec<DVec3> = objects.iter().flat_map(|object| object.positions.clone()).collect();
    let is_large = |points: &[DVec3]| size(points) >= size(&all) / 2.0;
    let has_contained = !objects.iter().all(|object| is_large(&object.positions));
    let contained = objects.iter().filter(|object| !(has_contained && is_large(&object.positions)));
    let ends = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    contained.flat_map(|object| &object.positions).fold(ends, |[left, low, right, high], place| {
        let clip = clip_from_stage * (*place - origin).extend(1.0);
        assert!(clip.w > 0.0, "before the eye");
        let [x, y] = [clip.x / clip.w, clip.y / clip.w];
        [left.min(x), low.min(y), right.max(x), high.max(y)]
    })
}

/// The Scene tab's first view of a scene: the camera that it is drawn with, the origin, and what is shown.
fn first_view(scene: &Scene, gpu: &RenderState) -> (DMat4, DVec3, Arc<Anatomy>) {
    let mut harness = harness_of(over(scene));
    show(&mut harness);
    let (view, origin) = drawn(&harness, gpu, |picture| (picture.view, picture.geometry.origin));
    (view.clip_from_stage.as_dmat4(), origin, anatomy_of(scene, Technique::ZFail))
}

fn scenes() -> Vec<Scene> {
    let mut scenes: Vec<_> = ALL.iter().map(|builtin| builtin.scene().expect("a scene")).collect();
    scenes.push(open(&OpenSpec::new("assets/models/knot.obj")).expect("a model on a floor"));
    scenes
}

/// All of the model is in the view, and takes a third of it at least, however large the floor is: where no lamp and no
/// camera is near that the view shows too.
#[test]
fn the_view_is_framed_on_what_stands_on_the_floor() {
    let painter = painter();
    for mut scene in scenes() {
        for light in &mut scene.lights {
            let towards = light.position.truncate() - scene.camera.target * light.position.w;
            *light = Light::directional(towards);
        }
        scene.camera.eye = scene.camera.target + (scene.camera.eye - scene.camera.target) * 1e3;
        let (clip_from_stage, origin, anatomy) = first_view(&scene, painter.gpu());
        let [left, low, right, high] = share_of_view(&anatomy, clip_from_stage, origin);
        println!("{}: {left:.2} to {right:.2}, {low:.2} to {high:.2}", scene.name);
        assert!(left > -1.0 && right < 1.0 && low > -1.0 && high < 1.0, "{}: {left} {right} {low} {high}", scene.name);
        assert!((right - left).max(high - low) > 2.0 / 3.0, "{}: {left} {right} {low} {high}", scene.name);
    }
}

/// A view that shows lamps and camera too is no larger than these need: together they take half of it.
#[test]
fn a_view_with_lamps_and_camera_in_it_is_filled_by_them_and_the_model() {
    let painter = painter();
    let mut with_both = 0;
    for scene in scenes() {
        let (clip_from_stage, origin, anatomy) = first_view(&scene, painter.gpu());
        let model = share_of_view(&anatomy, clip_from_stage, origin);
        let lamps = anatomy.lights.iter().filter(|light| light.position.w != 0.0);
        let lamps = lamps.map(|light| light.position.truncate() / light.position.w);
        let on_screen = |place: DVec3| {
            let clip = clip_from_stage * (place - origin).extend(1.0);
            (clip.w > 0.0).then(|| [clip.x / clip.w, clip.y / clip.w])
        };
        let seen: Vec<_> = lamps.chain([anatomy.camera.eye]).filter_map(on_screen).collect();
        let seen = seen.iter().filter(|[x, y]| x.abs() < 1.0 && y.abs() < 1.0);
        with_both += usize::from(seen.clone().count() > 1);
        let [left, low, right, high] = seen
            .fold(model, |[left, low, right, high], [x, y]| [left.min(*x), low.min(*y), right.max(*x), high.max(*y)]);
        println!("{}: {left:.2} to {right:.2}, {low:.2} to {high:.2}", scene.name);
        assert!(left > -1.0 && right < 1.0 && low > -1.0 && high < 1.0, "{}: {left} {right} {low} {high}", scene.name);
        assert!((right - left).max(high - low) > 1.0, "{}: {left} {right} {low} {high}", scene.name);
    }
    assert!(with_both > 5, "lamps and camera are in the view of {with_both} scenes");
}
