//! Faults of the rasteriser: it moves corners to parts of a pixel, and a face that is seen nearly edge-on then has
//! another depth at the pixel's middle.

use super::number::larger_pictures;
use crate::accuracy::Finding;
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, PixelSample, RegionSamples, SuspectedCause};
use crate::numbers;
use crate::plan::{DrawPart, depth_plane};
use glam::{DVec3, DVec4};

pub(crate) const RULES: &[CauseRule] = &[rasteriser_precision];

/// Faces nearer than this to a pixel's middle, pixels, meet it by rounding: another cause.
const ROUNDED: f64 = 1e-4;
/// Surfaces whose planes are turned less than this from each other, degrees, are one.
const SAME_SURFACE: f64 = 1.0;

/// A face beside the visible surface at a pixel.
struct NearFace {
    name: String,
    /// Distance between the two along the view's axis, metres.
    gap: f64,
    /// How far the face and the surface have to be moved against each other to have the same depth at the pixel's
    /// middle, pixels.
    pixels: f64,
    /// How far the planes of the two are turned from each other, degrees.
    turned: f64,
}

/// The depth of a triangle's plane at a pixel's middle, and how much of it a pixel's width makes.
struct PlaneDepth {
    depth: f64,
    each_pixel: f64,
}

impl PlaneDepth {
    /// Returns the depth of the plane through three corners in clip space; `None` where it is seen edge-on.
    fn at(facts: &FrameFacts, sample: &PixelSample, corners: [DVec4; 3]) -> Option<PlaneDepth> {
        let size = facts.plan.size.map(f64::from);
        let [x, y] = sample.center();
        let plane = depth_plane(corners)?;
        Some(PlaneDepth {
            depth: plane.dot(DVec3::new(x / size[0] * 2.0 - 1.0, 1.0 - y / size[1] * 2.0, 1.0)),
            each_pixel: (plane.x * 2.0 / size[0]).hypot(plane.y * 2.0 / size[1]),
        })
    }
}

/// Returns whether another surface is drawn than in truth.
fn shows_another(case: &RegionSamples) -> bool {
    case.region.key.kind == RegionKind::Wrong(Finding::WrongSurface)
}

/// Returns the face that a step of the rasteriser's may bring to the other side of the surface that a sample shows in
/// truth: the nearest side of a light's volumes (caps are the surface itself, or at infinity), or where another surface
/// is drawn, that one. `None` where none lies there, or no surface.
fn nearest_face(facts: &FrameFacts, case: &RegionSamples, sample: &PixelSample) -> Option<NearFace> {
    let seen = sample.seen?;
    let clip_from_relative = facts.plan.views.first()?.clip_from_relative.as_dmat4();
    let clip = |place: DVec3| clip_from_relative * (place - facts.eye()).extend(1.0);
    let surface = PlaneDepth::at(facts, sample, seen.corners.map(clip))?;
    let point = clip(seen.point);
    let (depth_here, distance_here) = (point.z / point.w, facts.tracer.depth_of(seen.point));
    let shows_another = shows_another(case);
    let history = sample.history.iter().flat_map(|history| history.triangles());
    let faces = history.filter(|(event, one)| match shows_another {
        true => event.is_from_camera && one.part == DrawPart::Surface && one.outcome.passed(),
        false => event.light == Some(case.light()) && one.part == DrawPart::Side,
    });
    let near = |(_, one): (&crate::history::PixelEvent, &crate::history::TriangleEvent)| {
        let corners = one.corners.map(|corner| clip_from_relative * DVec4::from_array(corner.map(f64::from)));
        let face = PlaneDepth::at(facts, sample, corners)?;
        let distance = facts.plan.depth.distance(face.depth as f32)?;
        let caster = one.caster.as_deref().unwrap_or("an object");
        let name =
            if shows_another { format!("a triangle of {caster}") } else { format!("a side of {caster}'s volume") };
        let pixels = (face.depth - depth_here).abs() / (face.each_pixel + surface.each_pixel);
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        let places = one.corners.map(|corner| DVec4::from_array(corner.map(f64::from)));
        let turned =
            normal(places.map(DVec4::truncate)).cross(normal(seen.corners)).length().min(1.0).asin().to_degrees();
        let near = NearFace { name, gap: (distance - distance_here).abs(), pixels, turned };
        pixels.is_finite().then_some(near)
    };
    if shows_another {
        // The last that passes is what is seen.
        return faces.last().and_then(near).filter(|face| face.turned > SAME_SURFACE);
    }
    faces.filter_map(near).min_by(|a, b| a.pixels.total_cmp(&b.pixels)).filter(|face| face.pixels >= ROUNDED)
}

/// Looks for faces that would be on the surface's other side if their corners lay a part of a pixel beside their place.
/// `None` unless every sample shows it: a whole region has another cause.
fn rasteriser_precision(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (NearFace { name, gap, pixels, turned }, shown_by) =
        case.shown(|sample| nearest_face(facts, case, sample).filter(|face| face.pixels <= facts.step))?;
    let sentence = format!(
        "{name} is {} from the surface here; as steeply as the two are seen, {} pixels beside each other they have the \
         same depth, and both ends of an edge are moved by up to half of {} pixels, the rasteriser's step",
        numbers::metres(gap),
        numbers::digits(pixels),
        numbers::digits(facts.step)
    );
    let near = Quantity::at_most(
        "how far the face and the surface are to be moved to meet at the pixel's middle, in pixels",
        pixels,
        facts.step,
    );
    let other = if shows_another(case) {
        Quantity::more_than("how far the two surfaces are turned from each other, in degrees", turned, SAME_SURFACE)
    } else {
        Quantity::more_than("the same, which rounding does not explain", pixels, ROUNDED)
    };
    let is_everywhere = shown_by == case.samples.len();
    let evidence = case.evidence(sentence, shown_by, [near, other]);
    is_everywhere.then(|| SuspectedCause::new(Cause::RasteriserPrecision, evidence, larger_pictures(facts)))
}
