//! Faults of silhouettes that are projected with no regard to distance.

use super::texels::{TextureLayer, differing_texels, larger};
use crate::accuracy::Finding;
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::Fix;
use crate::numbers;
use crate::plan::{Decision, DrawPart, LeftOut};
use crate::technique::Technique;
use crate::truth::SeenSurface;
use glam::{DVec2, DVec3};

pub(crate) const RULES: &[CauseRule] = &[reverse_projection, between, edge_smear, self_shadow, aliasing, no_fit];

/// Why a silhouette's answer is wrong at a surface point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SilhouetteComparison {
    pub cause: Cause,
    /// The caster's index in the scene.
    pub caster: usize,
    /// The number that decides. Metres: from the caster to the light's position for [`Cause::ReverseProjection`], from
    /// the surface to the caster otherwise. For [`Cause::EdgeSmear`] the place across the caster's picture, 1 at its
    /// edge; for [`Cause::Aliasing`] how many of nine texels around the point are not as the truth at the pixel.
    far: f64,
}

/// Compares a silhouette's answer with the truth at a wrong surface point. `None` for other techniques, or where the
/// numbers show no cause.
pub(crate) fn look(
    facts: &FrameFacts,
    light: usize,
    kind: RegionKind,
    seen: &SeenSurface,
) -> Option<SilhouetteComparison> {
    if facts.technique() != Technique::Projective {
        return None;
    }
    let drawn = |object: usize| {
        let name = facts.scene.objects.get(object).map(|object| object.name.as_str());
        facts.draws(light, DrawPart::Map).any(|draw| draw.caster.as_deref() == name)
    };
    let distance = facts.tracer.light_distance(light, seen.point);
    match kind {
        RegionKind::Wrong(Finding::FalseShadow) => {
            let along = facts.tracer.along(light, seen.point);
            let mut others =
                along.iter().filter(|hit| hit.place.object != seen.place.object && drawn(hit.place.object));
            let reverses = facts.plan.lights.get(light)?.map.as_ref().is_some_and(|map| map.projects_backwards);
            let behind = others.clone().find(|hit| hit.towards_light > distance && reverses);
            let below = others.rfind(|hit| hit.towards_light < 0.0);
            let found = |cause, caster, far| Some(SilhouetteComparison { cause, caster, far });
            match (behind, below) {
                (Some(hit), _) => found(Cause::ReverseProjection, hit.place.object, hit.towards_light - distance),
                (None, Some(hit)) => found(Cause::Between, hit.place.object, -hit.towards_light),
                (None, None) => smearing(facts, light, seen)
                    .or_else(|| beside_outline(facts, light, seen))
                    .or_else(|| beside_reverse_outline(facts, light, seen).filter(|_| reverses)),
            }
        }
        RegionKind::Wrong(Finding::MissingShadow) => {
            let between = facts.tracer.between(light, seen);
            let other = between.iter().find(|hit| hit.place.object != seen.place.object);
            let Some(hit) = other else {
                let far = between.first()?.towards_light;
                return Some(SilhouetteComparison { cause: Cause::SelfShadow, caster: seen.place.object, far });
            };
            let caster = hit.place.object;
            let outside = SilhouetteComparison { cause: Cause::OutsideMap, caster, far: hit.towards_light };
            match place_in_picture(facts, light, caster, seen) {
                Some(place) if !is_outside(place) && drawn(caster) => {
                    let covered = covered_texels(facts, light, caster, seen, place)?;
                    let far = (covered.all - covered.covered) as f64;
                    (far > 0.0).then_some(SilhouetteComparison { cause: Cause::Aliasing, caster, far })
                }
                _ => Some(outside),
            }
        }
        _ => None,
    }
}

/// Returns where a surface point is in the picture of a caster's silhouette: normalized device coordinates, −1 to 1.
/// `None` behind the light, or where the caster has no picture.
fn place_in_picture(facts: &FrameFacts, light: usize, caster: usize, seen: &SeenSurface) -> Option<DVec2> {
    layer_of(facts, light, caster)?.place_of(seen.point)
}

/// Returns the layer that shows a caster (its index in the scene) in a light's silhouettes; `None` where it was not
/// drawn.
fn layer_of<'f>(facts: &FrameFacts<'f>, light: usize, caster: usize) -> Option<TextureLayer<'f>> {
    let map = facts.plan.lights.get(light)?.map.as_ref()?;
    let name = &facts.scene.objects.get(caster)?.name;
    let layer = map.layer_names.iter().position(|of| of == name).filter(|layer| map.faces[*layer].is_some())?;
    Some(TextureLayer { map, layer, texels: facts.texels() })
}

fn is_outside(place: DVec2) -> bool {
    place.abs().max_element() > 1.0
}

/// Returns the caster whose picture's edge texels, repeated beyond the picture, darken the surface point, with the
/// point's place across that picture (1 at its edge). Of several the nearest to its edge; `None` where there is none, or
/// the map does not repeat its edge.
fn smearing(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> Option<SilhouetteComparison> {
    facts.plan.lights.get(light)?.map.as_ref().filter(|map| map.repeats_edge)?;
    let last_texel = 1.0 - 2.0 / facts.texels();
    let others = (0..facts.scene.objects.len()).filter(|object| *object != seen.place.object);
    let places = others.filter_map(|object| {
        let place = place_in_picture(facts, light, object, seen)?;
        let far = place.abs().max_element();
        let is_covered = far >= last_texel && covered_texels(facts, light, object, seen, place)?.covered > 0;
        is_covered.then_some(SilhouetteComparison { cause: Cause::EdgeSmear, caster: object, far })
    });
    places.min_by(|a, b| a.far.total_cmp(&b.far))
}

/// Returns the caster beside whose outline the surface point lies in its picture, with how many of the texels around the
/// point it covers; `None` where none covers any.
fn beside_outline(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> Option<SilhouetteComparison> {
    let others = (0..facts.scene.objects.len()).filter(|object| *object != seen.place.object);
    let mut covering = others.filter_map(|caster| {
        let place = place_in_picture(facts, light, caster, seen).filter(|place| !is_outside(*place))?;
        let far = covered_texels(facts, light, caster, seen, place)?.covered as f64;
        (far > 0.0).then_some(SilhouetteComparison { cause: Cause::Aliasing, caster, far })
    });
    covering.next()
}

/// Returns the caster whose outline, projected behind the light, the surface point lies beside, with how far it lies
/// beyond the light there; `None` where there is none.
fn beside_reverse_outline(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> Option<SilhouetteComparison> {
    let towards = facts.tracer.towards(light, seen.point);
    (0..facts.scene.objects.len()).filter(|object| *object != seen.place.object).find_map(|caster| {
        let layer = layer_of(facts, light, caster)?;
        let place = layer.reverse_place_of(seen.point).filter(|place| !is_outside(*place))?;
        let far = |point: &DVec3| {
            let distance = facts.tracer.light_distance(light, *point);
            let along = facts.tracer.along(light, *point);
            let beyond = along.iter().filter(|hit| hit.place.object == caster).map(|hit| hit.towards_light - distance);
            beyond.filter(|far| *far > 0.0).min_by(f64::total_cmp)
        };
        let far = layer.points_around(place, seen.point, towards).iter().find_map(far)?;
        Some(SilhouetteComparison { cause: Cause::ReverseProjection, caster, far })
    })
}

/// The texels around a point in a caster's picture.
struct CoveredTexels {
    /// Their number.
    all: usize,
    /// The number of those that the caster covers.
    covered: usize,
}

/// Returns how many of nine texels of a caster's picture it covers by the light's lines through their middles: the texel
/// at `place` (from −1 to 1 across) and its neighbours, kept inside the picture. `None` where the caster has no layer.
fn covered_texels(
    facts: &FrameFacts,
    light: usize,
    object: usize,
    seen: &SeenSurface,
    place: DVec2,
) -> Option<CoveredTexels> {
    let towards = facts.tracer.towards(light, seen.point);
    let points = layer_of(facts, light, object)?.points_around(place, seen.point, towards);
    let is_covered = |point: &&DVec3| facts.tracer.along(light, **point).iter().any(|hit| hit.place.object == object);
    Some(CoveredTexels { all: points.len(), covered: points.iter().filter(is_covered).count() })
}

/// Returns the comparison at the first sample that shows `cause`, the name of its caster, and how many samples show it;
/// `None` where none does.
fn shown<'f>(facts: &FrameFacts<'f>, case: &RegionSamples, cause: Cause) -> Option<ShownCause<'f>> {
    let (look, shown_by) = case.shown(|sample| {
        let found = look(facts, case.light(), case.region.key.kind, &sample.seen?)?;
        (found.cause == cause).then_some(found)
    })?;
    let caster = facts.scene.objects.get(look.caster)?.name.as_str();
    Some(ShownCause { caster, far: look.far, shown_by })
}

/// What samples show of one cause.
struct ShownCause<'f> {
    caster: &'f str,
    far: f64,
    shown_by: usize,
}

fn reverse_projection(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ShownCause { caster, far, shown_by } = shown(facts, case, Cause::ReverseProjection)?;
    let sentence = format!(
        "the surface is behind the light as {caster} sees it (q ≤ 0): {caster} lies on their line, {} beyond the light",
        numbers::metres(far)
    );
    let beyond = Quantity::more_than("how far the caster lies beyond the light, in metres", far, 0.0);
    let evidence = case.evidence(sentence, shown_by, [beyond]);
    Some(SuspectedCause::new(Cause::ReverseProjection, evidence, vec![Fix::setting("reverse", "off")]))
}

fn between(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ShownCause { caster, far, shown_by } = shown(facts, case, Cause::Between)?;
    let sentence = format!(
        "the surface lies {} nearer to the light than {caster}, whose silhouette falls on it",
        numbers::metres(far)
    );
    let nearer = Quantity::more_than("how far the caster lies behind the surface, in metres", far, 0.0);
    let evidence = case.evidence(sentence, shown_by, [nearer]);
    Some(SuspectedCause::new(Cause::Between, evidence, vec![Fix::technique(Technique::ZFail)]))
}

fn edge_smear(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ShownCause { caster, far, shown_by } = shown(facts, case, Cause::EdgeSmear)?;
    let sentence = format!(
        "the surface is at {} of half the width of {caster}'s picture, whose last texels go on from 1 outwards",
        numbers::digits(far)
    );
    let last_texel = 1.0 - 2.0 / facts.texels();
    let outside = Quantity::at_least("the place across the picture, where its edge is at 1", far, last_texel);
    let evidence = case.evidence(sentence, shown_by, [outside]);
    Some(SuspectedCause::new(Cause::EdgeSmear, evidence, vec![Fix::setting("border", "on")]))
}

fn self_shadow(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ShownCause { caster, far, shown_by } = shown(facts, case, Cause::SelfShadow)?;
    let sentence = format!(
        "{caster} itself lies between light and surface, {} before it, and its silhouette spares it",
        numbers::metres(far)
    );
    let before = Quantity::more_than("how far the object lies before its own surface, in metres", far, 0.0);
    let evidence = case.evidence(sentence, shown_by, [before]);
    Some(SuspectedCause::new(Cause::SelfShadow, evidence, vec![Fix::technique(Technique::ZFail)]))
}

fn aliasing(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ShownCause { far, shown_by, .. } = shown(facts, case, Cause::Aliasing)?;
    let size = facts.texels();
    let sentence = format!("the silhouette has {size} texels a side, and its outline runs between two of them");
    let evidence = case.evidence(sentence, shown_by, [differing_texels(far as usize)]);
    Some(SuspectedCause::new(Cause::Aliasing, evidence, larger(size, 4096.0)))
}

fn no_fit(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ShownCause { caster, far, shown_by } = shown(facts, case, Cause::OutsideMap)?;
    let size_of_it = case.shown(|sample| {
        let object = facts.object(caster)?.0;
        Some(place_in_picture(facts, case.light(), object, &sample.seen?)?.abs().max_element()).filter(|far| *far > 1.0)
    });
    if let Some((place, shown_by)) = size_of_it {
        let sentence = format!(
            "the surface is at {} of half the width of {caster}'s picture, which ends at 1",
            numbers::digits(place)
        );
        // Fitted pictures end beyond their casters, except for rounding.
        let is_fitted = facts.plan.settings.get("fit").is_none_or(|fit| fit == "on");
        let fix = if is_fitted { Fix::technique(Technique::ZFail) } else { Fix::setting("fit", "on") };
        let outside = Quantity::more_than("the place across the picture, where its edge is at 1", place, 1.0);
        return Some(SuspectedCause::new(Cause::OutsideMap, case.evidence(sentence, shown_by, [outside]), vec![fix]));
    }
    let is_its = |left: &&LeftOut| left.names(Decision::Silhouette, caster);
    let because = facts.plan.left_out.iter().find(is_its).map(|left| left.because.clone());
    let sentence =
        format!("there is no silhouette of {caster}: {}", because.unwrap_or_else(|| "none was drawn".to_owned()));
    let before = Quantity::more_than("how far the caster lies before the surface, in metres", far, 0.0);
    let evidence = case.evidence(sentence, shown_by, [before]);
    Some(SuspectedCause::new(Cause::OutsideMap, evidence, vec![Fix::technique(Technique::ZFail)]))
}
