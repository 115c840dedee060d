//! The projection of a recorded frame's eye, as far as its vertices determine it.
//!
//! In a perspective w is the distance along the view axis, and z = a·w + b for all that is not at infinity: two
//! numbers, fitted over the vertices of the surfaces. The field of view can't be known, as clip space is view space
//! stretched: it is taken as 90 degrees with square pixels, which preserves every straight line, every "between" and
//! every silhouette.

use crate::math::depth::{DepthCurve, DepthMapping, LengthUnit};
use crate::plan::{Draw, DrawPart, FramePlan, Pass};
use crate::scene::Camera;
use glam::{DMat4, DVec3};

/// Field of view in degrees; the tangent of its half is 1.
const FIELD_OF_VIEW: f64 = 90.0;
/// How far a vertex may be off the fit, in parts of its w.
const RESIDUAL: f64 = 1e-3;

/// Returns the depth curve that most vertices of the picture's depth-writing surfaces agree on: how stored depth
/// follows from distance. `None` where no surface determines it, as without a perspective.
pub(super) fn curve(plan: &FramePlan) -> Option<DepthCurve> {
    let picture = || plan.passes.iter().filter(|pass| plan.is_of_picture(pass));
    let is_reversed = is_reversed(picture().flat_map(|pass| &pass.draws));
    let surfaces = picture().flat_map(|pass| pass.draws.iter().map(move |draw| (pass, draw)));
    let surfaces = surfaces.filter(|(_, draw)| draw.part == DrawPart::Surface && draw.raster.depth_write);
    // A sky, a user interface or a weapon in hand may have a projection of its own: most vertices decide.
    let fits: Vec<(usize, [f64; 2])> = surfaces
        .filter_map(|(pass, draw)| {
            let points = points(plan, pass, draw);
            Some((points.len(), fitted(&points)?))
        })
        .collect();
    let is_like = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        (a - c).abs() <= RESIDUAL * (1.0 - a).abs().max(RESIDUAL) && (b - d).abs() <= RESIDUAL * b.abs()
    };
    let votes =
        |fit: [f64; 2]| fits.iter().filter(|(_, other)| is_like(fit, *other)).map(|(count, _)| count).sum::<usize>();
    let best = fits.iter().max_by_key(|(count, fit)| (votes(*fit), *count)).map(|(_, fit)| *fit);
    let mapping = |has_far: bool| match (is_reversed, has_far) {
        (true, _) => DepthMapping::ReversedInfinite,
        (false, true) => DepthMapping::StandardFinite,
        (false, false) => DepthMapping::StandardInfinite,
    };
    match best {
        Some([a, b]) => {
            // Distance at which depth is 1, or 0 where it is reversed.
            let far = if is_reversed { -b / a } else { b / (1.0 - a) };
            // Clamped depth also shows what lies beyond the far plane.
            let is_clipped = picture().flat_map(|pass| &pass.draws).filter(|draw| draw.part == DrawPart::Surface);
            let is_clipped = is_clipped.filter(|draw| draw.raster.depth_write).all(|draw| !draw.raster.unclipped_depth);
            let far = Some(far).filter(|far| far.is_finite() && *far > 0.0 && is_clipped);
            Some(DepthCurve { far, unit: LengthUnit::Unknown, ..DepthCurve::new(mapping(far.is_some()), a, b) })
        }
        None => None,
    }
}

/// Returns the curve that is assumed where nothing is known: depth from 0 to 1, as if there were no far plane.
pub(super) fn unknown(plan: &FramePlan) -> DepthCurve {
    let is_reversed = is_reversed(plan.passes.iter().flat_map(|pass| &pass.draws));
    let mapping = if is_reversed { DepthMapping::ReversedInfinite } else { DepthMapping::StandardInfinite };
    DepthCurve { unit: LengthUnit::Unknown, ..mapping.curve(1.0, 0.0, 0.0) }
}

/// Returns whether greater depth is nearer: more draws test with greater (or equal) than with less (or equal). False
/// where they are equally many.
fn is_reversed<'a>(draws: impl Iterator<Item = &'a Draw>) -> bool {
    use wgpu_types::CompareFunction::{Greater, GreaterEqual, Less, LessEqual};
    let votes = draws.map(|draw| match draw.raster.depth_compare {
        Greater | GreaterEqual => 1,
        Less | LessEqual => -1,
        _ => 0,
    });
    votes.sum::<i64>() > 0
}

/// Returns clip-space z and w of a draw's vertices, with z mapped to the viewport's depth range; vertices that are not
/// finite are left out.
fn points(plan: &FramePlan, pass: &Pass, draw: &Draw) -> Vec<[f64; 2]> {
    let [near, far] = pass.viewport(plan.size).depth.map(f64::from);
    let place = |[_, _, z, w]: &[f32; 4]| {
        let [z, w] = [f64::from(*z), f64::from(*w)];
        [near * w + (far - near) * z, w]
    };
    let vertices = plan.meshes[draw.mesh.0].vertices.data();
    vertices.iter().map(place).filter(|[z, w]| z.is_finite() && w.is_finite()).collect()
}

/// Returns a and b of z = a·w + b by least squares; `None` with fewer than three points, where w is the same
/// everywhere, a point lies off the line, or b is 0.
fn fitted(points: &[[f64; 2]]) -> Option<[f64; 2]> {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let [z, w] = [mean(0), mean(1)];
    let spread: f64 = points.iter().map(|point| (point[1] - w).powi(2)).sum();
    let joint: f64 = points.iter().map(|point| (point[1] - w) * (point[0] - z)).sum();
    let largest = points.iter().map(|point| point[1].abs()).fold(0.0, f64::max);
    if points.len() < 3 || spread <= (1e-6 * largest).powi(2) * count {
        return None;
    }
    let a = joint / spread;
    let b = z - a * w;
    let is_near = |point: &[f64; 2]| (a * point[1] + b - point[0]).abs() <= RESIDUAL * point[1].abs().max(b.abs());
    (b != 0.0 && points.iter().all(is_near)).then_some([a, b])
}

/// Returns the camera assumed for a recorded frame: at the origin, looking along −z, y up, with a field of view of 90
/// degrees, and near and far planes from the depth curve. [`clip_from_view`] has its projection.
pub(super) fn camera(curve: &DepthCurve) -> Camera {
    let plane = |depth: f64| Some(curve.scale / (depth - curve.offset)).filter(|at| at.is_finite() && *at > 0.0);
    let near = plane(if curve.mapping.is_reversed() { 1.0 } else { 0.0 }).unwrap_or(1.0).clamp(1e-30, 1e30);
    Camera {
        eye: DVec3::ZERO,
        target: DVec3::NEG_Z,
        up: DVec3::Y,
        projection: crate::scene::Projection::Perspective,
        fov_y_degrees: FIELD_OF_VIEW,
        near,
        far: curve.far.filter(|far| *far > near),
        viewport: None,
    }
}

/// Returns the matrix from the assumed camera's view space (field of view 90 degrees) to clip space, for a picture of
/// this size.
pub(super) fn clip_from_view(curve: &DepthCurve, size: [u32; 2]) -> DMat4 {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let row = curve.z_row();
    DMat4::from_cols_array_2d(&[
        [1.0 / aspect, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, row.x, -1.0],
        [0.0, 0.0, row.y, 0.0],
    ])
}
