//! What engines leave undone: volumes of mirrored objects that are wound as if nothing were mirrored, silhouettes from
//! shared corners alone, and worlds in single precision.

use crate::accuracy::LABEL_REACH;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause, amount};
use crate::diagnosis::fix::Fix;
use crate::diagnosis::mesh_facts::{split_edges, t_junctions};
use crate::geometry::SilhouetteBy;
use crate::numbers;
use glam::DVec3;

pub(crate) const RULES: &[CauseRule] = &[mirrored, split_corners, t_junction, f32_world];

fn mirrored(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if !facts.volumes()?.keeps_mirrored_winding {
        return None;
    }
    let ((name, determinant, counted, expected), shown_by) = case.shown(|sample| {
        let backwards = |(name, counted, expected): (String, i32, i32)| {
            let (_, object) = facts.object(&name)?;
            let determinant = object.pose.scale.element_product();
            (object.pose.is_mirrored() && counted < 0).then_some((name, determinant, counted, expected))
        };
        sample.miscounted(facts, case.light()).into_iter().find_map(backwards)
    })?;
    let sentence = format!(
        "{name} is mirrored, the determinant of its matrix is {}, and its volume is wound as if it were not: it counts \
         {counted} here instead of {expected}",
        numbers::digits(determinant)
    );
    let quantities = [
        Quantity::less_than("the determinant of the caster's matrix", determinant, 0.0),
        Quantity::less_than("what the caster's volume counts here", counted.into(), 0.0),
    ];
    let fixes = vec![Fix::setting("mirrored", "flipped")];
    Some(SuspectedCause::new(Cause::Mirrored, case.evidence(sentence, shown_by, quantities), fixes))
}

/// A caster whose silhouette is found from shared corners alone, and what its volume counts at a sample.
struct OpenCaster {
    index: usize,
    name: String,
    counted: i32,
    expected: i32,
}

/// Returns the first caster that is miscounted at a sample while silhouettes are found from shared corners alone, and
/// at how many samples one is; `None` where they are found otherwise.
fn open_caster(facts: &FrameFacts, case: &RegionSamples) -> Option<(OpenCaster, usize)> {
    // A vertex shader has a quad at every edge, whatever corners are shared.
    let settings = facts.volumes()?;
    if settings.silhouette != SilhouetteBy::SharedCorners || settings.by_vertex_shader {
        return None;
    }
    case.shown(|sample| {
        let (name, counted, expected) = sample.miscounted(facts, case.light()).into_iter().next()?;
        let (index, _) = facts.object(&name)?;
        Some(OpenCaster { index, name, counted, expected })
    })
}

fn split_corners(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (OpenCaster { index, name, counted, expected }, shown_by) = open_caster(facts, case)?;
    let split = split_edges(&facts.scene.objects[index].mesh);
    let sentence = format!(
        "{} of {name} in which triangles meet have corners of different numbers on either side, and no side of the \
         volume: it counts {counted} here instead of {expected}, as it does not close",
        amount(split as u64, "edge")
    );
    let edges = Quantity::at_least("edges whose corners the file splits", split as f64, 1.0);
    let found = SuspectedCause::new(Cause::SplitVertices, case.evidence(sentence, shown_by, [edges]), vec![joined()]);
    (split > 0).then_some(SuspectedCause { weight: split, ..found })
}

fn t_junction(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (OpenCaster { index, name, counted, expected }, shown_by) = open_caster(facts, case)?;
    let object = &facts.scene.objects[index];
    let junctions = t_junctions(&object.mesh);
    let first = junctions.first()?;
    let DVec3 { x, y, z } = object.pose.world_from_object().transform_point3(*first);
    let sentence = format!(
        "{} of {name} lie on another triangle's edge, the first at {} {} {}: neither part of that edge is shared, and has \
         a side; its volume counts {counted} here instead of {expected}, as it does not close",
        amount(junctions.len() as u64, "corner"),
        numbers::digits(x),
        numbers::digits(y),
        numbers::digits(z)
    );
    let corners = Quantity::at_least("corners on another triangle's edge", junctions.len() as f64, 1.0);
    let found = SuspectedCause::new(Cause::TJunction, case.evidence(sentence, shown_by, [corners]), vec![joined()]);
    Some(SuspectedCause { weight: junctions.len(), ..found })
}

/// Returns the fix that finds silhouettes by positions.
fn joined() -> Fix {
    Fix::setting("silhouette", "adjacency")
}

fn f32_world(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if !facts.choice.common().rounds_world {
        return None;
    }
    let ((step, at, pixels), shown_by) = case.shown(|sample| {
        let point = sample.seen?.point;
        let at = point.abs().max_element();
        let step = f64::from((at as f32).next_up()) - f64::from(at as f32);
        Some((step, at, step / facts.pixel_width(facts.tracer.depth_of(point))))
    })?;
    let sentence = format!(
        "positions are rounded to single precision in world space, whose steps are {} at {} from the origin: {} pixels",
        numbers::metres(step),
        numbers::metres(at),
        numbers::digits(pixels)
    );
    let coarse = Quantity::more_than("a step of single precision here, in pixels", pixels, LABEL_REACH);
    let fixes = vec![Fix::setting("world", "f64")];
    Some(SuspectedCause::new(Cause::F32World, case.evidence(sentence, shown_by, [coarse]), fixes))
}
