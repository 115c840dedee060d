//! kiss3d: two lights with shadow maps over a floor.

mod check;

use kiss3d::context::Context;
use kiss3d::prelude::*;

fn scene() -> SceneNode3d {
    let mut scene = SceneNode3d::empty();
    let [grey, red] = [0.7, 0.3].map(|level| Color::new(0.75, level, level, 1.0));
    scene.add_cube(14.0, 0.4, 14.0).set_position(Vec3::new(0.0, -1.2, 0.0)).set_color(grey);
    scene.add_cube(1.5, 1.5, 1.5).set_position(Vec3::new(-2.0, 0.0, 0.0)).set_color(red);
    scene.add_sphere(1.0).set_position(Vec3::new(2.0, 0.2, 1.0)).set_color(grey);
    scene.add_cone(0.8, 1.8).set_position(Vec3::new(0.5, 0.0, -2.5)).set_color(red);
    let sun = Light::directional(Vec3::new(-0.6, -1.0, -0.3)).with_intensity(2.5);
    scene.add_light(sun).set_position(Vec3::new(0.0, 6.0, 0.0));
    scene.add_light(Light::spot(0.35, 0.55, 30.0).with_intensity(12.0)).reorient(
        Vec3::new(4.0, 6.0, 4.0),
        Vec3::ZERO,
        Vec3::Y,
    );
    scene
}

fn main() {
    let (instance, adapter, device, queue) = check::device(stencilscope::record::instance, wgpu::Adapter::limits);
    Context::init(instance, device.clone(), queue, adapter, wgpu::TextureFormat::Rgba8Unorm);
    let mut surface = pollster::block_on(OffscreenSurface::new(640, 480));
    surface.set_shadows_enabled(true);
    let mut scene = scene();
    let eye = Vec3::new(6.0, 6.0, 8.0);
    let mut camera = OrbitCamera3d::new_with_frustum(0.9, 0.1, 100.0, eye, Vec3::ZERO);
    let mut draw = || drop(pollster::block_on(surface.render_image_3d(&mut scene, &mut camera)));
    draw();
    let expected = check::Expected { draws: 24, of_picture: 4, discarding: 4, limits: &[] };
    check::record("kiss3d", &device, draw, &expected);
}
