//! femtovg: stars whose overlaps are counted in a stencil, without any depth. Its one shader may discard.

mod check;
mod timing;

use femtovg::renderer::WGPURenderer;
use femtovg::{Canvas, Color, FillRule, Paint, Path, Solidity};

const EXPECTED: check::Expected = check::Expected {
    draws: 14,
    of_picture: 14,
    discarding: 14,
    limits: &["how depth comes from distance can't be found from the vertices, so that no light is looked for"],
};
const SIZE: [u32; 2] = [640, 480];

fn star([x, y]: [f32; 2], radius: f32, points: usize, step: usize) -> Path {
    let mut path = Path::new();
    for point in 0..points {
        let angle = (point * step) as f32 / points as f32 * std::f32::consts::TAU;
        let at = [x + radius * angle.sin(), y - radius * angle.cos()];
        if point == 0 { path.move_to(at[0], at[1]) } else { path.line_to(at[0], at[1]) }
    }
    path.close();
    path
}

fn paint(canvas: &mut Canvas<WGPURenderer>, target: &wgpu::Texture) -> Option<wgpu::CommandBuffer> {
    canvas.set_size(SIZE[0], SIZE[1], 1.0);
    canvas.clear_rect(0, 0, SIZE[0], SIZE[1], Color::rgb(250, 250, 245));
    canvas.fill_path(&star([160.0, 160.0], 120.0, 5, 2), &Paint::color(Color::rgb(200, 60, 40)));
    let even_odd = Paint::color(Color::rgba(40, 90, 200, 160)).with_fill_rule(FillRule::EvenOdd);
    canvas.fill_path(&star([420.0, 180.0], 150.0, 7, 3), &even_odd);
    let mut stroke = Paint::color(Color::rgba(20, 120, 60, 140));
    stroke.set_line_width(18.0);
    stroke.set_stencil_strokes(true);
    canvas.stroke_path(&star([300.0, 330.0], 130.0, 9, 4), &stroke);
    let mut path = Path::new();
    path.rounded_rect(40.0, 380.0, 200.0, 80.0, 20.0);
    path.circle(140.0, 420.0, 30.0);
    path.solidity(Solidity::Hole);
    canvas.fill_path(&path, &Paint::color(Color::rgb(90, 20, 120)));
    canvas.flush_to_output(target)
}

/// A device, and what draws a frame with it.
fn renderer(make: fn(wgpu::InstanceDescriptor) -> wgpu::Instance) -> (wgpu::Device, impl FnMut()) {
    let (_, _, device, queue) = check::device(make, |_| wgpu::Limits::default());
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let mut canvas = Canvas::new(WGPURenderer::new(device.clone(), queue.clone())).expect("a canvas");
    let draw = {
        let device = device.clone();
        move || {
            queue.submit(paint(&mut canvas, &target));
            device.poll(wgpu::PollType::wait_indefinitely()).expect("a device that answers");
        }
    };
    (device, draw)
}

/// With a number as argument: prints how long so many frames take that are not recorded.
fn main() {
    let turns = std::env::args().nth(1).and_then(|turns| turns.parse().ok());
    let (device, mut draw) = renderer(stencilscope::record::instance);
    draw();
    match turns {
        Some(turns) => timing::compare(turns, [renderer(wgpu::Instance::new).1, draw]),
        None => check::record("femtovg", &device, draw, &EXPECTED),
    }
}
