//! Casters of which only some triangles cast, although their mesh does not allow that.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause, amount};
use crate::diagnosis::fix::{Fix, ObjectChange};
use crate::diagnosis::mesh_facts::{MeshFacts, WoundPart};
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
    /// For each sample that shows it, the part of the mesh that is at fault: what lies between light and surface, or all
    /// of it where its volume does not close.
    parts: Vec<WoundPart>,
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
        let mut at_fault: Vec<(String, String, Option<usize>)> = Vec::new();
        if case.is_missing() {
            for name in facts.names(&sample.between) {
                let of_it: Vec<_> = sample.between.iter().filter(|hit| facts.tracer.name(hit.place) == name).collect();
                if !of_it.iter().any(|hit| facts.casts(light, hit)) {
                    let what = format!(
                        "{} {way} the light",
                        if of_it.len() == 1 {
                            "1 triangle lies between light and surface, and does not look".to_owned()
                        } else {
                            format!("{} triangles lie between light and surface, and none of them looks", of_it.len())
                        }
                    );
                    let nearest = of_it.first().map(|hit| hit.place.triangle);
                    at_fault.push((name, what, nearest));
                }
            }
        }
        for (name, counted, expected) in sample.miscounted(facts, light) {
            if !at_fault.iter().any(|(other, ..)| *other == name) {
                let what = format!("its volume counts {counted} here instead of {expected}, as it does not close");
                at_fault.push((name, what, None));
            }
        }
        for (name, what, triangle) in at_fault {
            let Some((index, _)) = facts.object(&name) else { continue };
            let mesh = &facts.meshes[index];
            let part = triangle.map_or(Some(mesh.whole()), |triangle| mesh.part_around(triangle));
            let Some(part) = part else { continue };
            match found.iter_mut().find(|suspect| suspect.index == index) {
                Some(suspect) => suspect.parts.push(part),
                None => found.push(Suspect { index, mesh, what, parts: vec![part] }),
            }
        }
    }
    found
}

/// A defect of a caster's mesh, as one rule measures it.
struct MeasuredDefect {
    /// What the mesh has, as the end of a sentence that begins with its name.
    words: String,
    /// How specific it is, for the order of causes: how often the mesh has it.
    weight: usize,
    /// The number that must hold, of the part of the mesh that is at fault.
    quantity: Quantity,
}

impl MeasuredDefect {
    /// Returns a defect of edges: `count` in the whole mesh, `here` at the border of the part that is at fault.
    fn of_edges(words: String, count: usize, here: usize) -> MeasuredDefect {
        let quantity = Quantity::at_least("such edges at the border of the part that casts here", here as f64, 1.0);
        MeasuredDefect { words, weight: count, quantity }
    }
}

/// Looks for a mesh defect as the cause: `measure` returns it for the part of a mesh that is at fault at one sample,
/// `None` where it does not apply. Takes the first suspect caster that has it. The fix is `casters = by-topology`, which is
/// right for the mesh and costs closed ones nothing; else `all` (for split vertices, welding first).
fn rule<'f>(
    facts: &'f FrameFacts,
    case: &RegionSamples,
    cause: Cause,
    measure: impl Fn(&MeshFacts, &WoundPart) -> Option<MeasuredDefect>,
) -> Option<SuspectedCause> {
    let measured = |suspect: Suspect<'f>| -> Option<(usize, &'f MeshFacts, SuspectedCause)> {
        let Suspect { index, mesh, what, parts } = suspect;
        let defects = parts.iter().filter_map(|part| measure(mesh, part)).filter(|defect| defect.quantity.holds());
        let defects: Vec<MeasuredDefect> = defects.collect();
        let shown_by = defects.len();
        let MeasuredDefect { words, weight, quantity } = defects.into_iter().next()?;
        let evidence = case.evidence(format!("{} {words}; {what}", mesh.name), shown_by, [quantity]);
        Some((index, mesh, SuspectedCause { weight, ..SuspectedCause::new(cause, evidence, Vec::new()) }))
    };
    let (index, mesh, suspicion) = suspects(facts, case).into_iter().find_map(measured)?;
    let welded = (cause == Cause::SplitVertices).then(|| Fix::scene(index, &mesh.name, ObjectChange::Weld));
    let casting = ["by-topology", "all"].map(|casters| Fix::setting("casters", casters));
    let fixes = welded.into_iter().chain(casting).collect();
    Some(SuspectedCause { fixes, ..suspicion })
}

fn edges(count: usize) -> String {
    amount(count as u64, "edge")
}

fn light_inside(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = facts.tracer.light_position(case.light());
    rule(facts, case, Cause::LightInside, |mesh, _| {
        let winding = mesh.winding_around(light)?;
        Some(MeasuredDefect {
            words: format!("winds around {} {winding} times", numbers::light(case.light())),
            weight: usize::MAX,
            quantity: Quantity::at_least("times that the mesh winds around the light", winding.abs().into(), 1.0),
        })
    })
}

fn split_vertices(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::SplitVertices, |mesh, part| {
        let count = mesh.split.len();
        let words = format!("has {} along which equal positions have different indices", edges(count));
        Some(MeasuredDefect::of_edges(words, count, part.split))
    })
}

fn near_vertices(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::NearVertices, |mesh, part| {
        let count = mesh.near.len();
        let words = format!("has {} within a millionth of its size of another that they do not share", edges(count));
        Some(MeasuredDefect::of_edges(words, count, part.near))
    })
}

fn inconsistent_winding(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::InconsistentWinding, |mesh, part| {
        if part.is_inside_out {
            return Some(MeasuredDefect {
                words: "has its inside out".to_owned(),
                weight: usize::MAX / 2,
                quantity: Quantity::at_least("closed parts that face inwards", 1.0, 1.0),
            });
        }
        let count = mesh.inconsistent.0;
        let words = format!("has {} whose two triangles disagree on which side is out", edges(count));
        Some(MeasuredDefect::of_edges(words, count, part.inconsistent))
    })
}

fn non_manifold(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::NonManifold, |mesh, part| {
        let count = mesh.non_manifold.0;
        let words = format!("has {} of more than two triangles", edges(count));
        Some(MeasuredDefect::of_edges(words, count, part.non_manifold))
    })
}

fn open_mesh(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    rule(facts, case, Cause::OpenMesh, |mesh, part| {
        let count = mesh.open.len();
        Some(MeasuredDefect::of_edges(format!("is open along {}", edges(count)), count, part.open))
    })
}
