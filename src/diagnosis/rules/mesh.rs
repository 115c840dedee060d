//! Casters of which only some triangles cast, although their mesh does not allow that.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause, amount};
use crate::diagnosis::fix::{Fix, ObjectChange};
use crate::diagnosis::mesh_facts::MeshFacts;
use crate::geometry::Casters;
use crate::numbers;
use crate::technique::CasterRule;

pub(crate) const RULES: &[CauseRule] =
    &[light_inside, split_vertices, near_vertices, inconsistent_winding, non_manifold, open_mesh];

/// A caster whose mesh may be at fault at some samples.
struct Suspect<'f> {
    index: usize,
    mesh: &'f MeshFacts,
    /// What is wrong with its shadow there.
    what: String,
    shown_by: usize,
}

/// Returns the casters whose light-facing triangles (or those facing away, as the setting says) do not give their
/// shadow at the samples, with how many samples show it. Empty where all triangles cast, or casters go by topology.
fn suspects<'f>(facts: &'f FrameFacts, case: &RegionSamples) -> Vec<Suspect<'f>> {
    let light = case.light();
    let way = match facts.volumes().map(|settings| settings.casters) {
        Some(CasterRule::Always(Casters::LightFacing)) => "towards",
        Some(CasterRule::Always(Casters::LightBackFacing)) => "away from",
        Some(CasterRule::Always(Casters::All) | CasterRule::ByTopology) | None => return Vec::new(),
    };
    let mut found: Vec<Suspect> = Vec::new();
    for sample in &case.samples {
        let mut at_fault: Vec<(String, String)> = Vec::new();
        if case.is_missing() {
            for name in facts.names(&sample.between) {
                let of_it: Vec<_> = sample.between.iter().filter(|hit| facts.tracer.name(hit.place) == name).collect();
                if !of_it.iter().any(|hit| facts.casts(light, hit)) {
                    let what = format!(
                        "{} between light and surface, and none of them looks {way} the light",
                        if of_it.len() == 1 {
                            "1 triangle lies".to_owned()
                        } else {
                            format!("{} triangles lie", of_it.len())
                        }
                    );
                    at_fault.push((name, what));
                }
            }
        }
        for (name, counted, expected) in sample.miscounted(facts, light) {
            if !at_fault.iter().any(|(other, _)| *other == name) {
                let what = format!("its volume counts {counted} here instead of {expected}, as it does not close");
                at_fault.push((name, what));
            }
        }
        for (name, what) in at_fault {
            let Some((index, _)) = facts.object(&name) else { continue };
            match found.iter_mut().find(|suspect| suspect.index == index) {
                Some(suspect) => suspect.shown_by += 1,
                None => found.push(Suspect { index, mesh: &facts.meshes[index], what, shown_by: 1 }),
            }
        }
    }
    found
}

/// Looks for a mesh defect as the cause: `measure` returns words for it and how often it occurs, `None` where a mesh
/// does not have it. Takes the first suspect caster that has it; the fix is `casters = all` (for split vertices,
/// welding first).
fn rule(
    facts: &FrameFacts,
    case: &RegionSamples,
    cause: Cause,
    measure: impl Fn(&MeshFacts) -> Option<(String, usize)>,
) -> Option<SuspectedCause> {
    let all = suspects(facts, case).into_iter();
    let (suspect, (measured, weight)) =
        all.filter_map(|suspect| Some((measure(suspect.mesh)?, suspect))).map(|(m, s)| (s, m)).next()?;
    let Suspect { index, mesh, what, shown_by } = suspect;
    let fixes = match cause {
        Cause::SplitVertices => {
            vec![Fix::scene(index, &mesh.name, ObjectChange::Weld), Fix::setting("casters", "all")]
        }
        _ => vec![Fix::setting("casters", "all")],
    };
    let evidence = format!("{} {measured}; {what}", mesh.name);
    SuspectedCause::new(cause, evidence, fixes, shown_by).map(|suspicion| SuspectedCause { weight, ..suspicion })
}

fn edges(count: usize) -> String {
    amount(count as u64, "edge")
}

fn light_inside(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = facts.tracer.light_position(case.light());
    rule(facts, case, Cause::LightInside, |mesh| {
        let winding = mesh.winding_around(light)?;
        Some((format!("winds around {} {winding} times", numbers::light(case.light())), usize::MAX))
    })
}

fn split_vertices(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::SplitVertices, |mesh| {
        let count = mesh.split.len();
        let text = format!("has {} along which equal positions have different indices", edges(count));
        (count > 0).then_some((text, count))
    })
}

fn near_vertices(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::NearVertices, |mesh| {
        let count = mesh.near.len();
        let text = format!("has {} within a millionth of its size of another that they do not share", edges(count));
        (count > 0).then_some((text, count))
    })
}

fn inconsistent_winding(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::InconsistentWinding, |mesh| match mesh.inconsistent.0 {
        0 => mesh.is_inside_out.then(|| ("has its inside out".to_owned(), usize::MAX / 2)),
        count => Some((format!("has {} whose two triangles disagree on which side is out", edges(count)), count)),
    })
}

fn non_manifold(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::NonManifold, |mesh| {
        let count = mesh.non_manifold.0;
        (count > 0).then(|| (format!("has {} of more than two triangles", edges(count)), count))
    })
}

fn open_mesh(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::OpenMesh, |mesh| {
        let count = mesh.open.len();
        (count > 0).then(|| (format!("is open along {}", edges(count)), count))
    })
}
