//! Labels by brute force: every pixel's ray and shadow ray against every triangle, in `f64`.
//!
//! Slow and plain, so that it shares no idea with shadow volumes. A pixel whose answer changes
//! within an eighth of a pixel, or whose visible triangle changes within 1/256 (what rasterisers
//! snap to), has no certain answer.

use super::pixels;
use glam::{DVec3, DVec4};
use stencilscope::capture::Capture;
use stencilscope::math::projection::view_from_world_rotation;
use stencilscope::scene::Scene;

type Triangle = [DVec3; 3];

/// What the ray through a point of the picture sees: label and triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Seen {
    label: u8,
    triangle: usize,
}

/// Counts of pixels on which a technique and the rays differ for a light.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Difference {
    /// Pixels with a certain answer, lit or in shadow.
    pub compared: u64,
    /// Those of the compared pixels where the technique's label differs from that of the rays.
    pub wrong: u64,
    /// Pixels of each label, by the rays.
    pub labels: [u64; 4],
}

/// Compares a capture's labels of one light with ray casting. All objects are drawn and cast.
pub fn difference(scene: &Scene, capture: &Capture, light: usize) -> Difference {
    let triangles: Vec<Triangle> = scene
        .objects
        .iter()
        .flat_map(|object| {
            let world = object.world_positions();
            object.mesh.triangles().iter().map(move |corners| corners.map(|v| world[v as usize])).collect::<Vec<_>>()
        })
        .collect();
    let labels = capture.lights[light].shadow.as_ref().expect("labels");
    let light = scene.lights[light].position;
    let mut difference = Difference::default();
    for [x, y] in pixels(capture.size) {
        let at = |dx: f64, dy: f64| {
            seen(scene, &triangles, light, capture.size, f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy)
        };
        let truth = at(0.0, 0.0);
        difference.labels[usize::from(truth.label)] += 1;
        if truth.label > 1 {
            continue;
        }
        difference.compared += 1;
        if labels.byte_at([x, y]) == Some(truth.label) {
            continue;
        }
        let around = |step: f64| {
            let offsets = [-step, 0.0, step];
            offsets.into_iter().flat_map(move |dx| offsets.into_iter().map(move |dy| (dx, dy)))
        };
        let excused = around(0.125).any(|(dx, dy)| at(dx, dy).label != truth.label)
            || around(1.0 / 256.0).any(|(dx, dy)| at(dx, dy).triangle != truth.triangle);
        difference.wrong += u64::from(!excused);
    }
    difference
}

fn seen(scene: &Scene, triangles: &[Triangle], light: DVec4, size: [u32; 2], x: f64, y: f64) -> Seen {
    let camera = &scene.camera;
    let [width, height] = size.map(f64::from);
    let focal = 1.0 / (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let in_view = DVec3::new((x / width * 2.0 - 1.0) * width / height / focal, (1.0 - y / height * 2.0) / focal, -1.0);
    let direction = view_from_world_rotation(camera.target - camera.eye, camera.up).transpose() * in_view;
    // `direction` has length 1 along the view axis, so t is the distance that the near plane cuts.
    let hits = triangles.iter().enumerate().filter_map(|(index, triangle)| {
        let t = hit(camera.eye, direction, triangle)?;
        (t >= camera.near).then_some((t, index))
    });
    let Some((t, index)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Seen { label: 2, triangle: usize::MAX };
    };
    let [a, b, c] = triangles[index];
    let normal = (b - a).cross(c - a);
    let light_side = normal.dot(light.truncate() - a * light.w);
    if light_side * normal.dot(camera.eye - a) <= 0.0 {
        return Seen { label: 3, triangle: index };
    }
    let point = camera.eye + direction * t;
    let to_light = light.truncate() - point * light.w;
    let farthest = if light.w == 0.0 { f64::INFINITY } else { 1.0 };
    let scale = point.length() + to_light.length();
    let in_plane = |triangle: &Triangle| {
        triangle.iter().all(|corner| (*corner - a).dot(normal).abs() <= 1e-12 * normal.length() * scale)
    };
    let is_shadowed = triangles.iter().enumerate().any(|(other, triangle)| {
        other != index && !in_plane(triangle) && hit(point, to_light, triangle).is_some_and(|t| t > 0.0 && t < farthest)
    });
    Seen { label: u8::from(is_shadowed), triangle: index }
}

/// Möller and Trumbore (1997), either side.
fn hit(origin: DVec3, direction: DVec3, [a, b, c]: &Triangle) -> Option<f64> {
    let (e, f) = (*b - *a, *c - *a);
    let p = direction.cross(f);
    let determinant = e.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let from = origin - *a;
    let u = from.dot(p) / determinant;
    let q = from.cross(e);
    let v = direction.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| f.dot(q) / determinant)
}
