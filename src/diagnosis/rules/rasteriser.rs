//! Faults of the rasteriser: it moves corners to parts of a pixel, and a face that is seen nearly edge-on then has
//! another depth at the pixel's middle.

use super::number::larger_pictures;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, PixelSample, RegionSamples, SuspectedCause};
use crate::numbers;
use crate::plan::DrawPart;
use glam::{DMat3, DVec3, DVec4};

pub(crate) const RULES: &[CauseRule] = &[rasteriser_precision];

/// Faces nearer than this to a pixel's middle, pixels, meet it by rounding: another cause.
const ROUNDED: f64 = 1e-4;

/// A face of a shadow volume beside the visible surface at a pixel.
struct NearFace {
    name: String,
    /// Distance between the two along the view's axis, metres.
    gap: f64,
    /// How far beside the pixel's middle the face has the surface's depth, pixels.
    pixels: f64,
}

/// Returns the side of a light's volumes whose depth is the surface's nearest to a sample's middle; `None` where none
/// lies there, or no surface. (Caps are the surface itself, or at infinity.)
fn nearest_face(facts: &FrameFacts, light: usize, sample: &PixelSample) -> Option<NearFace> {
    let seen = sample.seen?.point;
    let clip_from_relative = facts.plan.views.first()?.clip_from_relative.as_dmat4();
    let surface = clip_from_relative * (seen - facts.eye()).extend(1.0);
    let size = facts.plan.size.map(f64::from);
    let middle = sample.center();
    let device = DVec3::new(middle[0] / size[0] * 2.0 - 1.0, 1.0 - middle[1] / size[1] * 2.0, 1.0);
    let here = facts.tracer.depth_of(seen);
    let face = |(_, one): (&crate::history::PixelEvent, &crate::history::TriangleEvent)| {
        let corners = one.corners.map(|corner| clip_from_relative * DVec4::from_array(corner.map(f64::from)));
        // Depth over w is linear in the picture: three corners determine how it grows along x and y.
        let places = DMat3::from_cols_array_2d(&corners.map(|corner| [corner.x, corner.y, corner.w])).transpose();
        let growth = places.inverse() * DVec3::from_array(corners.map(|corner| corner.z));
        let apart = growth.dot(device) - surface.z / surface.w;
        let each_pixel = (growth.x * 2.0 / size[0]).hypot(growth.y * 2.0 / size[1]);
        let gap = (facts.plan.depth.scale / (growth.dot(device) - facts.plan.depth.offset) - here).abs();
        let pixels = apart.abs() / each_pixel;
        let caster = one.caster.as_deref().unwrap_or("a caster");
        pixels.is_finite().then(|| NearFace { name: format!("a side of {caster}'s volume"), gap, pixels })
    };
    let sides = sample.volume_events(light).filter(|(_, one)| one.part == DrawPart::Side);
    sides.filter_map(face).min_by(|a, b| a.pixels.total_cmp(&b.pixels))
}

/// Looks for faces that would be on the surface's other side if their corners lay a part of a pixel beside their place.
/// `None` unless every sample shows it: a whole region has another cause.
fn rasteriser_precision(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    if !facts.counts_volumes(light) || facts.plan.depth.is_linear {
        return None;
    }
    let (NearFace { name, gap, pixels }, shown_by) = case.shown(|sample| {
        nearest_face(facts, light, sample).filter(|face| (ROUNDED..=facts.step).contains(&face.pixels))
    })?;
    let sentence = format!(
        "{name} is {} from the surface here, and is seen so nearly edge-on that it meets it {} pixels beside the pixel's \
         middle; both ends of an edge are moved by up to half of {} pixels, the rasteriser's step",
        numbers::metres(gap),
        numbers::digits(pixels),
        numbers::digits(facts.step)
    );
    let near = Quantity::at_most(
        "how far beside the pixel's middle the face meets the surface, in pixels",
        pixels,
        facts.step,
    );
    let not_rounding = Quantity::more_than("the same, which rounding does not explain", pixels, ROUNDED);
    let is_everywhere = shown_by == case.samples.len();
    let evidence = case.evidence(sentence, shown_by, [near, not_rounding]);
    is_everywhere.then(|| SuspectedCause::new(Cause::RasteriserPrecision, evidence, larger_pictures(facts)))
}
