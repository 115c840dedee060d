//! The matrix that flattens casters onto the plane that a pixel shows, with a vertex carried through.
//!
//! Blinn (1988), "Me and My (Fake) Shadow": M = (P·L) I − L Pᵀ, with the plane P turned towards the light L.

use super::matrices::{TransformStep, vector};
use super::shading::seen;
use crate::capture::Capture;
use crate::geometry::planar::{FlattenClip, Flattener};
use crate::history::PixelHistory;
use crate::math::Plane;
use crate::numbers;
use crate::plan::{DrawPart, FramePlan};
use glam::{DMat4, DVec3};
use serde::Serialize;

/// How casters are flattened onto the plane of the surface at a pixel, away from one light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShadowMatrix {
    /// Index of the light.
    pub light: usize,
    /// The plane: its normal towards the light, and its offset.
    pub plane: [f64; 4],
    /// The matrix, from world space to homogeneous world space; it has no inverse, so none is shown.
    pub matrix: [[f64; 4]; 4],
    /// The caster's vertex whose shadow is nearest to the pixel's point; `None` without casters.
    pub vertex: Option<FlattenedVertex>,
}

/// A vertex carried through a shadow matrix.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlattenedVertex {
    /// Name of the caster.
    pub object: String,
    /// Index of the vertex in its mesh.
    pub index: u32,
    /// World space, metres.
    pub world: [f64; 3],
    /// Homogeneous, as the matrix carries it.
    pub flattened: [f64; 4],
    /// What the sign of w says.
    pub because: String,
}

impl ShadowMatrix {
    /// Returns the matrices of all lights that planar shadows are drawn for, for the plane of the triangle that a pixel shows
    /// at the surface point `world`; none for other techniques, or where the pixel shows none.
    pub fn of(capture: &Capture, plan: &FramePlan, history: &PixelHistory, world: DVec3) -> Vec<ShadowMatrix> {
        let is_planar = plan.passes.iter().flat_map(|pass| &pass.draws).any(|draw| draw.part == DrawPart::PlanarShadow);
        let Some((_, shown, one)) = seen(plan, history).filter(|_| is_planar) else { return Vec::new() };
        let eye = capture.camera.eye;
        let [a, b, c] = one.corners.map(|[x, y, z, _]| eye + DVec3::new(x.into(), y.into(), z.into()));
        let normal = (b - a).cross(c - a);
        if normal.try_normalize().is_none() {
            return Vec::new();
        }
        let of_light = |(light, of): (usize, &crate::capture::CapturedLight)| {
            let plane = Plane::through(a, normal);
            let plane = if plane.at(of.position) < 0.0 { plane.flipped() } else { plane };
            let matrix = Flattener::new(plane, of.position, FlattenClip::Undivided)?.matrix();
            let vertex = nearest(plan, eye, matrix, world, shown.caster.as_deref().unwrap_or(&shown.name));
            let is_point = of.position.w != 0.0;
            Some(ShadowMatrix {
                light,
                plane: plane.normal.extend(plane.offset).to_array(),
                matrix: TransformStep::new("", matrix).matrix,
                vertex: vertex.map(|(object, index, world)| {
                    let flattened = matrix * world.extend(1.0);
                    let because = because(flattened.w, plane.at(world.extend(1.0)), plane.at(of.position), is_point);
                    FlattenedVertex { object, index, world: world.to_array(), flattened: flattened.to_array(), because }
                }),
            })
        };
        capture.lights.iter().enumerate().filter_map(of_light).collect()
    }

    /// Returns the name, the vertex and its shadow in words, with so many significant digits; the matrix is not in them.
    pub fn lines(&self, digits: u32) -> Vec<String> {
        let mut lines = vec![format!(
            "{}, shadow matrix (P·L) I − L Pᵀ with P = {}:",
            numbers::light(self.light),
            vector(&self.plane, digits)
        )];
        if let Some(FlattenedVertex { object, index, world, flattened, because }) = &self.vertex {
            let [x, y, z, w] = *flattened;
            let mut line = format!(
                "vertex {index} of {object} at {} goes to {}",
                vector(world, digits),
                vector(flattened, digits)
            );
            if w != 0.0 {
                line += &format!(", over w {}", vector(&[x / w, y / w, z / w], digits));
            }
            lines.push(format!("{line}: {because}"));
        }
        lines
    }
}

/// Returns what the w of a flattened vertex says, by its height over the plane and the light's (of a directional light, its
/// direction's).
fn because(w: f64, height: f64, light_height: f64, is_point: bool) -> String {
    let signed = |metres: f64| format!("{}{}", if metres < 0.0 { "−" } else { "" }, numbers::metres(metres.abs()));
    let [height, light_height] = [height, light_height].map(signed);
    if !is_point {
        return format!("w is the same for all vertices of a directional light, and the height is {height}");
    }
    match w {
        w if w > 0.0 => format!("w > 0, as its height {height} is less than the light's {light_height}"),
        0.0 => format!("w = 0, as it is level with the light at {light_height}: its shadow is at infinity"),
        _ => format!(
            "w < 0, as its height {height} is more than the light's {light_height}: dividing carries it back through the light, \
             the anti-shadow; a GPU that gets w as it is clips it (clip = gpu)"
        ),
    }
}

/// Returns the vertex of a drawn caster whose shadow is nearest to a point, with its caster's name: none of the object that
/// is shown itself.
fn nearest(plan: &FramePlan, eye: DVec3, matrix: DMat4, point: DVec3, shown: &str) -> Option<(String, u32, DVec3)> {
    let casters: Vec<&str> = plan
        .passes
        .iter()
        .flat_map(|pass| &pass.draws)
        .filter(|draw| draw.part == DrawPart::PlanarShadow)
        .filter_map(|draw| draw.caster.as_deref())
        .collect();
    let surfaces = plan.passes.first()?.draws.iter().filter(|draw| draw.part == DrawPart::Surface);
    let of_casters = surfaces.filter_map(|draw| {
        let name = draw.caster.as_deref().unwrap_or(&draw.name);
        (name != shown && casters.contains(&name)).then_some((name, plan.meshes.get(draw.mesh.0)?))
    });
    let vertices = of_casters.flat_map(|(name, mesh)| {
        (0..).zip(mesh.vertices.data()).map(move |(index, [x, y, z, _])| {
            (name, index, eye + DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)))
        })
    });
    let away = |world: DVec3| {
        let shadow = matrix * world.extend(1.0);
        (shadow.truncate() / shadow.w).distance(point)
    };
    let best = vertices.min_by(|a, b| away(a.2).total_cmp(&away(b.2)))?;
    Some((best.0.to_owned(), best.1, best.2))
}
