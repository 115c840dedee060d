//! Which planar shadows a plan draws on a flat piece of a surface.

use super::{Draw, DrawPart, FramePlan, LightId, Pass};
use crate::math::Plane;
use glam::DVec3;

/// Planes count as parallel if the cosine between their normals is larger.
const SAME_NORMAL: f64 = 1.0 - 1e-6;
/// How far a surface may be off its own plane, relative to its distance from the eye.
const OFF_PLANE: f64 = 1e-3;

impl FramePlan {
    /// Returns the shadows of a light that are flattened onto the flat piece of an object which holds a surface point, whose
    /// normal is of unit length: all in world space, metres. The piece is known by its stencil mark; without marks, by the
    /// planes of the shadows drawn on the object. `None` where it is no receiver of that light.
    pub fn planar_shadows_on(&self, light: LightId, object: &str, point: DVec3, normal: DVec3) -> Option<Vec<&Draw>> {
        let eye = self.views.first()?.origin;
        let is_here = |draw: &&Draw| {
            self.plane_of(draw, eye).is_some_and(|plane| {
                let off = plane.at(point.extend(1.0)).abs();
                plane.normal.dot(normal).abs() > SAME_NORMAL && off <= OFF_PLANE * (point - eye).length()
            })
        };
        let is_of_light = |pass: &&Pass| pass.timed && pass.light == Some(light) && pass.view.0 == 0;
        let draws = || self.passes.iter().filter(is_of_light).flat_map(|pass| &pass.draws);
        let shadows = || draws().filter(|draw| draw.part == DrawPart::PlanarShadow);
        let is_mark = |draw: &&Draw| draw.part == DrawPart::Receiver && draw.caster.as_deref() == Some(object);
        if draws().any(|draw| is_mark(&draw)) {
            let mark = draws().filter(is_mark).find(is_here)?.raster.stencil_reference;
            return Some(shadows().filter(|draw| draw.raster.stencil_reference == mark).collect());
        }
        let suffix = format!(" on {object},");
        let found: Vec<&Draw> = shadows().filter(|draw| draw.name.contains(&suffix)).filter(is_here).collect();
        (!found.is_empty()).then_some(found)
    }

    /// Returns the plane of a draw's largest triangle: that of a small one is mostly rounding.
    fn plane_of(&self, draw: &Draw, eye: DVec3) -> Option<Plane> {
        let mesh = self.meshes.get(draw.mesh.0)?;
        let corners = draw.triangles.clone().filter_map(|triangle| {
            let corners = mesh.places(mesh.corners(triangle, draw.base_vertex)?)?;
            let size = Plane::normal_of_homogeneous(corners).length_squared();
            size.is_finite().then_some((size, corners))
        });
        let (_, largest) = corners.max_by(|(one, _), (other, _)| one.total_cmp(other))?;
        Plane::through_homogeneous(largest, eye)
    }
}
