//! `teapot-like`: a pot that is an open sheet, with a spout and a handle that run through its wall.
//!
//! The pot is a surface of revolution without thickness and without a bottom; lid, spout and handle are open, too, and
//! cut the body. A silhouette of the faces towards the light is wrong here. Multiplicities of all triangles, oriented
//! towards the light, are not: an edge of the sheet's border counts once, one inside the sheet twice or not at all.

use crate::scene::{Camera, Light, Material, Mesh, MeshError, Motion, Object, Scene, SceneBuilder, Shading, shapes};
use glam::{DVec2, DVec3};
use std::sync::Arc;

const TABLE: [f32; 3] = [0.36, 0.22, 0.13];
const GLAZE: [f32; 3] = [0.05, 0.38, 0.42];
const CUP: [f32; 3] = [0.72, 0.66, 0.52];

/// Segments around the axis.
const AROUND: u32 = 56;

/// Builds the scene `teapot-like`: a pot that spins and a cup on a round table, whose top is at height 0.
pub fn build() -> Result<Scene, MeshError> {
    let table = Arc::new(shapes::cylinder(3.4, 0.16, 96)?);
    let glazed =
        |color| Material { color, specular: 0.35, shininess: 50.0, shading: Shading::Phong, ..Material::default() };
    let mut pot = Object::new("pot", Arc::new(pot()?), glazed(GLAZE)).at(DVec3::new(0.0, 0.02, 0.0));
    pot.pose.rotate_degrees.y = 24.0;
    pot.motion = Motion { spin_degrees_per_second: DVec3::new(0.0, 20.0, 0.0), ..Motion::default() };
    let cup = shapes::revolve(&curve([[0.34, 0.0], [0.62, 0.18], [0.55, 0.42], [0.62, 0.62]], 10), false, AROUND)?;
    Ok(SceneBuilder::new("teapot-like")
        .ambient([0.14, 0.14, 0.15])
        .camera(Camera { fov_y_degrees: 40.0, ..Camera::looking([0.9, 3.0, 4.9], [0.1, 0.55, 0.0]) })
        .light(Light { color: [1.0, 0.95, 0.86], ..Light::point(DVec3::new(-2.9, 4.2, 1.6)) })
        .objects([
            Object::new("table", table.clone(), Material::matte(TABLE)).at(DVec3::new(0.0, -0.08, 0.0)),
            pot,
            Object::new("cup", Arc::new(cup), glazed(CUP)).at(DVec3::new(1.75, 0.02, 1.25)),
        ])
        .build())
}

/// Returns body, lid, spout and handle of the pot in one mesh: one caster.
fn pot() -> Result<Mesh, MeshError> {
    let mut outline = curve([[0.62, 0.0], [1.15, 0.12], [1.25, 0.85], [0.66, 1.2]], 18);
    outline.push(DVec2::new(0.62, 1.26));
    let body = shapes::revolve(&outline, false, AROUND)?;
    // It hangs into the opening: its border is inside the body.
    let mut lid_outline = curve([[0.72, -0.08], [0.6, 0.24], [0.14, 0.1], [0.09, 0.26]], 12);
    lid_outline.extend(curve([[0.09, 0.26], [0.22, 0.34], [0.14, 0.5], [0.0, 0.5]], 8).into_iter().skip(1));
    let lid = shapes::revolve(&lid_outline, false, AROUND)?;
    let spout = tube([[0.75, 0.35], [1.5, 0.35], [1.35, 0.95], [1.85, 1.2]], |along| 0.3 - 0.19 * along)?;
    let handle = tube([[-0.85, 1.02], [-2.0, 1.25], [-1.9, 0.1], [-0.95, 0.3]], |_| 0.09)?;
    let raised = DVec3::new(0.0, 1.24, 0.0);
    shapes::joined([(&body, DVec3::ZERO), (&lid, raised), (&spout, DVec3::ZERO), (&handle, DVec3::ZERO)])
}

/// Returns a cubic Bézier curve as `pieces` + 1 points, both ends included.
fn curve(control: [[f64; 2]; 4], pieces: u32) -> Vec<DVec2> {
    let [a, b, c, d] = control.map(DVec2::from_array);
    let at = |step: u32| {
        let t = f64::from(step) / f64::from(pieces);
        let [ab, bc, cd] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
        ab.lerp(bc, t).lerp(bc.lerp(cd, t), t)
    };
    // The last point exactly, so that a pole stays on the axis.
    (0..pieces).map(at).chain([d]).collect()
}

/// Returns a tube around a Bézier curve in the plane z = 0; `radius` returns its radius by the curve's parameter, 0 to
/// 1.
fn tube(control: [[f64; 2]; 4], radius: impl Fn(f64) -> f64) -> Result<Mesh, MeshError> {
    const PIECES: u32 = 16;
    let points = curve(control, PIECES).into_iter().zip(0..);
    let path: Vec<(DVec3, f64)> =
        points.map(|(point, step)| (point.extend(0.0), radius(f64::from(step) / f64::from(PIECES)))).collect();
    shapes::tube(&path, 24)
}
