//! Faults of silhouettes that are projected with no regard to distance.

use super::planar::larger;
use crate::accuracy::Finding;
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::Fix;
use crate::numbers;
use crate::plan::{Decision, DrawPart, LeftOut};
use crate::technique::Technique;
use crate::truth::SeenSurface;
use glam::{DMat3, DVec2, DVec3};

pub(crate) const RULES: &[CauseRule] = &[reverse_projection, between, edge_smear, self_shadow, aliasing, no_fit];

/// Says why a silhouette's answer is wrong at a surface point: the cause, the caster's index, and a number as evidence.
/// The number is in metres, from the caster to the light's position for [`Cause::ReverseProjection`], from the surface
/// to the caster otherwise; for [`Cause::EdgeSmear`] it is the place across the caster's picture, 1 at its edge; 0 for
/// [`Cause::Aliasing`] without a caster.
pub(crate) fn look(
    facts: &FrameFacts,
    light: usize,
    kind: RegionKind,
    seen: &SeenSurface,
) -> Option<(Cause, Option<usize>, f64)> {
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
            Some(match (behind, below) {
                (Some(hit), _) => (Cause::ReverseProjection, Some(hit.place.object), hit.towards_light - distance),
                (None, Some(hit)) => (Cause::Between, Some(hit.place.object), -hit.towards_light),
                (None, None) => smearing(facts, light, seen)
                    .map_or((Cause::Aliasing, None, 0.0), |(object, far)| (Cause::EdgeSmear, Some(object), far)),
            })
        }
        RegionKind::Wrong(Finding::MissingShadow) => {
            let between = facts.tracer.between(light, seen);
            let other = between.iter().find(|hit| hit.place.object != seen.place.object);
            Some(match other {
                None => (Cause::SelfShadow, Some(seen.place.object), between.first()?.towards_light),
                Some(hit) if place_in_picture(facts, light, hit.place.object, seen).is_some_and(is_outside) => {
                    (Cause::OutsideMap, Some(hit.place.object), hit.towards_light)
                }
                Some(hit) if drawn(hit.place.object) => (Cause::Aliasing, Some(hit.place.object), hit.towards_light),
                Some(hit) => (Cause::OutsideMap, Some(hit.place.object), hit.towards_light),
            })
        }
        _ => None,
    }
}

/// Returns where a surface point is in the picture of a caster's silhouette: normalized device coordinates, −1 to 1.
/// `None` behind the light, or where the caster has no picture.
fn place_in_picture(facts: &FrameFacts, light: usize, caster: usize, seen: &SeenSurface) -> Option<DVec2> {
    let map = facts.plan.lights.get(light)?.map.as_ref()?;
    let clip = *map.clip_from_light.get(layer_of(facts, light, caster)?)? * seen.point.extend(1.0);
    (clip.w > 0.0).then(|| clip.truncate().truncate() / clip.w)
}

/// Returns the index of the layer that shows a caster (its index in the scene) in a light's silhouettes; `None` where
/// it was not drawn.
fn layer_of(facts: &FrameFacts, light: usize, caster: usize) -> Option<usize> {
    let map = facts.plan.lights.get(light)?.map.as_ref()?;
    let name = &facts.scene.objects.get(caster)?.name;
    map.layer_names.iter().position(|of| of == name).filter(|layer| map.faces[*layer].is_some())
}

fn is_outside(place: DVec2) -> bool {
    place.abs().max_element() > 1.0
}

/// Returns the caster (index in the scene) whose picture's edge texels, repeated beyond the picture, darken the surface
/// point, and the point's place across that picture (1 at its edge). Of several the nearest to its edge; `None` where
/// there is none, or the map does not repeat its edge.
fn smearing(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> Option<(usize, f64)> {
    facts.plan.lights.get(light)?.map.as_ref().filter(|map| map.repeats_edge)?;
    let last_texel = 1.0 - 2.0 / facts.texels();
    let others = (0..facts.scene.objects.len()).filter(|object| *object != seen.place.object);
    let places = others.filter_map(|object| {
        let place = place_in_picture(facts, light, object, seen)?;
        let far = place.abs().max_element();
        (far >= last_texel && is_covered(facts, light, object, seen, place)).then_some((object, far))
    });
    places.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns whether the caster lies on the light's line through one of nine texels of its picture: the one at `place`
/// (from −1 to 1 across) and its neighbours, kept inside the picture. False where the caster has no layer.
fn is_covered(facts: &FrameFacts, light: usize, caster: usize, seen: &SeenSurface, place: DVec2) -> bool {
    let layer = layer_of(facts, light, caster);
    let Some((map, layer)) = facts.plan.lights.get(light).and_then(|light| light.map.as_ref()).zip(layer) else {
        return false;
    };
    // Where the line of a place in the picture intersects the plane across the light's ray through the visible point:
    // two planes of that line, as clip coordinates have it, and this one.
    let rows = map.clip_from_light[layer].transpose();
    let towards = facts.tracer.towards(light, seen.point);
    let line_at = |place: DVec2| {
        let [across, up] = [rows.x_axis - rows.w_axis * place.x, rows.y_axis - rows.w_axis * place.y];
        let planes = DMat3::from_cols(across.truncate(), up.truncate(), towards).transpose();
        planes.inverse() * DVec3::new(-across.w, -up.w, towards.dot(seen.point))
    };
    let texels = facts.texels();
    let nearest = ((place + 1.0) / 2.0 * texels).floor();
    let center = |dx: f64, dy: f64| {
        let texel = (nearest + DVec2::new(dx, dy)).clamp(DVec2::ZERO, DVec2::splat(texels - 1.0));
        (texel + 0.5) / texels * 2.0 - 1.0
    };
    let near = [-1.0, 0.0, 1.0].into_iter().flat_map(|x| [-1.0, 0.0, 1.0].map(|y| center(x, y)));
    let mut points = near.map(line_at).filter(|point| point.is_finite());
    points.any(|point| facts.tracer.along(light, point).iter().any(|hit| hit.place.object == caster))
}

/// Returns, for the samples that show `cause`, the first one's caster name and measured number ([`look`]), and how many
/// such samples there are. The name is "nothing" where there is no caster. `None` where no sample shows the cause.
fn shown(facts: &FrameFacts, case: &RegionSamples, cause: Cause) -> Option<((String, f64), usize)> {
    case.shown(|sample| {
        let (found, caster, far) = look(facts, case.light(), case.region.key.kind, &sample.seen?)?;
        let name = caster.and_then(|object| facts.scene.objects.get(object)).map_or("nothing", |object| &object.name);
        (found == cause).then(|| (name.to_owned(), far))
    })
}

fn reverse_projection(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ((caster, far), shown_by) = shown(facts, case, Cause::ReverseProjection)?;
    let evidence = format!(
        "the surface is behind the light as {caster} sees it (q ≤ 0): {caster} lies on their line, {} beyond the light",
        numbers::metres(far)
    );
    SuspectedCause::new(Cause::ReverseProjection, evidence, vec![Fix::setting("reverse", "off")], shown_by)
}

fn between(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ((caster, far), shown_by) = shown(facts, case, Cause::Between)?;
    let evidence = format!(
        "the surface lies {} nearer to the light than {caster}, whose silhouette falls on it",
        numbers::metres(far)
    );
    SuspectedCause::new(Cause::Between, evidence, vec![Fix::technique(Technique::ZFail)], shown_by)
}

fn edge_smear(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ((caster, place), shown_by) = shown(facts, case, Cause::EdgeSmear)?;
    let evidence = format!(
        "the surface is at {} of half the width of {caster}'s picture, whose last texels go on from 1 outwards",
        numbers::digits(place)
    );
    SuspectedCause::new(Cause::EdgeSmear, evidence, vec![Fix::setting("border", "on")], shown_by)
}

fn self_shadow(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ((caster, far), shown_by) = shown(facts, case, Cause::SelfShadow)?;
    let evidence = format!(
        "{caster} itself lies between light and surface, {} before it, and its silhouette spares it",
        numbers::metres(far)
    );
    SuspectedCause::new(Cause::SelfShadow, evidence, vec![Fix::technique(Technique::ZFail)], shown_by)
}

fn aliasing(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let (_, shown_by) = shown(facts, case, Cause::Aliasing)?;
    let size = facts.texels();
    let evidence = format!("the silhouette has {size} texels a side, and its outline runs between two of them");
    SuspectedCause::new(Cause::Aliasing, evidence, larger(size, 4096.0), shown_by)
}

fn no_fit(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let ((caster, _), shown_by) = shown(facts, case, Cause::OutsideMap)?;
    let size_of_it = case.shown(|sample| {
        let object = facts.object(&caster)?.0;
        Some(place_in_picture(facts, case.light(), object, &sample.seen?)?.abs().max_element()).filter(|far| *far > 1.0)
    });
    if let Some((place, shown_by)) = size_of_it {
        let evidence = format!(
            "the surface is at {} of half the width of {caster}'s picture, which ends at 1",
            numbers::digits(place)
        );
        // Fitted pictures end beyond their casters, except for rounding.
        let is_fitted = facts.plan.settings.get("fit").is_none_or(|fit| fit == "on");
        let fix = if is_fitted { Fix::technique(Technique::ZFail) } else { Fix::setting("fit", "on") };
        return SuspectedCause::new(Cause::OutsideMap, evidence, vec![fix], shown_by);
    }
    let is_its = |left: &&LeftOut| left.names(Decision::Silhouette, &caster);
    let because = facts.plan.left_out.iter().find(is_its).map(|left| left.because.clone());
    let evidence =
        format!("there is no silhouette of {caster}: {}", because.unwrap_or_else(|| "none was drawn".to_owned()));
    SuspectedCause::new(Cause::OutsideMap, evidence, vec![Fix::technique(Technique::ZFail)], shown_by)
}
