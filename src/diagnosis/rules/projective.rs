//! Silhouettes that are projected with no regard to distance.

use super::planar::larger;
use crate::accuracy::Finding;
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{Case, Facts, Rule, Suspicion};
use crate::diagnosis::mend::Mend;
use crate::numbers;
use crate::plan::{Decision, LeftOut, Part};
use crate::technique::Technique;
use crate::truth::SeenSurface;

pub(crate) const RULES: &[Rule] = &[reverse_projection, between, self_shadow, aliasing, no_fit];

/// Why a silhouette's answer is wrong at a surface point, with the caster and a distance that tells.
pub(crate) fn look(
    facts: &Facts,
    light: usize,
    kind: RegionKind,
    seen: &SeenSurface,
) -> Option<(Cause, Option<usize>, f64)> {
    if facts.technique() != Technique::Projective {
        return None;
    }
    let drawn = |object: usize| {
        let name = facts.scene.objects.get(object).map(|object| object.name.as_str());
        facts.draws(light, Part::Map).any(|draw| draw.caster.as_deref() == name)
    };
    let distance = facts.tracer.light_distance(light, seen.point);
    match kind {
        RegionKind::Wrong(Finding::FalseShadow) => {
            let along = facts.tracer.along(light, seen.point);
            let mut others =
                along.iter().filter(|met| met.place.object != seen.place.object && drawn(met.place.object));
            let reverses = facts.plan.lights.get(light)?.map.as_ref().is_some_and(|map| map.projects_backwards);
            let behind = others.clone().find(|met| met.towards_light > distance && reverses);
            let below = others.rfind(|met| met.towards_light < 0.0);
            Some(match (behind, below) {
                (Some(met), _) => (Cause::ReverseProjection, Some(met.place.object), met.towards_light - distance),
                (None, Some(met)) => (Cause::Between, Some(met.place.object), -met.towards_light),
                (None, None) => (Cause::Aliasing, None, 0.0),
            })
        }
        RegionKind::Wrong(Finding::MissingShadow) => {
            let between = facts.tracer.between(light, seen);
            let other = between.iter().find(|met| met.place.object != seen.place.object);
            Some(match other {
                None => (Cause::SelfShadow, Some(seen.place.object), between.first()?.towards_light),
                Some(met) if drawn(met.place.object) => (Cause::Aliasing, Some(met.place.object), met.towards_light),
                Some(met) => (Cause::OutsideMap, Some(met.place.object), met.towards_light),
            })
        }
        _ => None,
    }
}

/// The caster's name and the distance of the first sample that shows a cause, and how many do.
fn shown(facts: &Facts, case: &Case, cause: Cause) -> Option<((String, f64), usize)> {
    case.shown(|sample| {
        let (found, caster, far) = look(facts, case.light(), case.region.key.kind, &sample.seen?)?;
        let name = caster.and_then(|object| facts.scene.objects.get(object)).map_or("nothing", |object| &object.name);
        (found == cause).then(|| (name.to_owned(), far))
    })
}

fn reverse_projection(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let ((caster, far), shown_by) = shown(facts, case, Cause::ReverseProjection)?;
    let evidence = format!(
        "the surface is behind the light as {caster} sees it (q ≤ 0): {caster} lies on their line, {} beyond the light",
        numbers::metres(far)
    );
    Suspicion::new(Cause::ReverseProjection, evidence, vec![Mend::setting("reverse", "off")], shown_by)
}

fn between(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let ((caster, far), shown_by) = shown(facts, case, Cause::Between)?;
    let evidence = format!(
        "the surface lies {} nearer to the light than {caster}, whose silhouette falls on it",
        numbers::metres(far)
    );
    Suspicion::new(Cause::Between, evidence, vec![Mend::technique(Technique::ZFail)], shown_by)
}

fn self_shadow(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let ((caster, far), shown_by) = shown(facts, case, Cause::SelfShadow)?;
    let evidence = format!(
        "{caster} itself lies between light and surface, {} before it, and its silhouette spares it",
        numbers::metres(far)
    );
    Suspicion::new(Cause::SelfShadow, evidence, vec![Mend::technique(Technique::ZFail)], shown_by)
}

fn aliasing(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let (_, shown_by) = shown(facts, case, Cause::Aliasing)?;
    let size = facts.texels();
    let evidence = format!("the silhouette has {size} texels a side, and its outline runs between two of them");
    Suspicion::new(Cause::Aliasing, evidence, larger(size, 4096.0), shown_by)
}

fn no_fit(facts: &Facts, case: &Case) -> Option<Suspicion> {
    let ((caster, _), shown_by) = shown(facts, case, Cause::OutsideMap)?;
    let is_its = |left: &&LeftOut| left.names(Decision::Silhouette, &caster);
    let because = facts.plan.left_out.iter().find(is_its).map(|left| left.because.clone());
    let evidence =
        format!("there is no silhouette of {caster}: {}", because.unwrap_or_else(|| "none was drawn".to_owned()));
    Suspicion::new(Cause::OutsideMap, evidence, vec![Mend::technique(Technique::ZFail)], shown_by)
}
