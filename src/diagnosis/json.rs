//! A diagnosis as JSON: pixels, lights and regions count from 0. `assets/help/json.md` says what each field means.

use super::{CauseFound, Diagnosis, Fix, FlagFound, MeshFinding, Proof, Quantity, RegionFound, TechniqueFit};
use crate::scene::Unsupported;
use crate::technique::Technique;
use serde_json::{Map, Value, json};

/// The version of the document's layout.
const SCHEMA: u32 = 1;

impl Diagnosis {
    /// Returns the diagnosis as JSON. `suited` has the measured result of each candidate technique; empty where none
    /// was measured.
    pub fn to_json(&self, suited: &[TechniqueFit]) -> Result<String, serde_json::Error> {
        let suited = suited.iter().map(|one| {
            json!({
                "technique": one.choice.technique().name(),
                "settings": one.choice.settings(),
                "wrong": one.wrong,
                "frame_ms": one.frame_ms,
            })
        });
        let advice = self.advice.as_ref().map(
            |advice| json!({"mend": fix(&advice.fix), "wrong_left": advice.wrong_left, "swimming_left": advice.swimming_left, "sentence": advice.sentence}),
        );
        let document = json!({
            "schema": SCHEMA,
            "scene": self.scene,
            "technique": self.technique.name(),
            "settings": self.settings,
            "size": self.size,
            "error": self.error,
            "mesh_findings": self.mesh_findings.iter().map(mesh).collect::<Vec<_>>(),
            "flags": self.flags.iter().map(flag).collect::<Vec<_>>(),
            "regions": self.regions.iter().map(region).collect::<Vec<_>>(),
            "rest": {"regions": self.rest.regions, "pixels": self.rest.pixels},
            "advice": advice,
            "left_out_of_files": self.left_out_of_files.iter().map(unsupported).collect::<Vec<_>>(),
            "suited": suited.collect::<Vec<_>>(),
        });
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}

fn unsupported(Unsupported { what, because }: &Unsupported) -> Value {
    json!({"what": what, "because": because})
}

fn mesh(MeshFinding { object, kind, count, at, effect }: &MeshFinding) -> Value {
    let at: Vec<[f64; 3]> = at.iter().map(|place| place.to_array()).collect();
    json!({"object": object, "cause": kind.name(), "count": count, "at": at, "effect": effect})
}

fn flag(FlagFound { object, cause, pixels, at, fix: of }: &FlagFound) -> Value {
    json!({"object": object, "cause": cause.name(), "pixels": pixels, "at": at, "mend": fix(of)})
}

fn region(region: &RegionFound) -> Value {
    json!({
        "pixels": region.pixels,
        "kind": region.kind.name(),
        "light": region.light,
        "box": region.bounds,
        "at": region.at,
        "casters": region.casters,
        "receivers": region.receivers,
        "causes": region.causes.iter().map(cause).collect::<Vec<_>>(),
    })
}

fn cause(found: &CauseFound) -> Value {
    json!({
        "cause": found.cause.name(),
        "meaning": found.cause.meaning(),
        "evidence": found.evidence.sentence,
        "evidence_holds": found.evidence.holds(),
        "measured": found.evidence.quantities.iter().map(quantity).collect::<Vec<_>>(),
        "shown_by": found.evidence.shown_by,
        "examined": found.evidence.examined,
        "mend": found.fix.as_ref().map(fix),
        "proof": Proof::name(found.proof),
        "pixels_left": found.pixels_left,
        "whole_frame": found.whole_frame.map(|effect| json!({"before": effect.before, "after": effect.after})),
        "together_with": found.together_with.iter().map(|cause| cause.name()).collect::<Vec<_>>(),
    })
}

/// Returns a measured number as a JSON object: what it is of, the number, and what it is held against.
pub(super) fn quantity(Quantity { what, value, threshold }: &Quantity) -> Value {
    json!({"what": what, "value": value, "must_be": threshold.words(), "bound": threshold.number()})
}

/// Returns a fix as a JSON object: only what it changes, and always the same in words (`words`). Edits of objects are
/// by name.
fn fix(fix: &Fix) -> Value {
    let mut table = Map::new();
    if let Some(technique) = fix.technique.map(Technique::name) {
        table.insert("technique".to_owned(), technique.into());
    }
    if !fix.settings.is_empty() {
        table.insert("settings".to_owned(), json!(fix.settings));
    }
    if !fix.scene.is_empty() {
        let edits = fix.scene.iter().map(|edit| json!({"object": edit.name, "change": edit.change.name()}));
        table.insert("objects".to_owned(), edits.collect::<Vec<_>>().into());
    }
    if !fix.plan.is_empty() {
        table.insert("plan".to_owned(), fix.plan.iter().map(|edit| edit.name()).collect::<Vec<_>>().into());
    }
    if let Some(times) = fix.larger {
        table.insert("times_as_large".to_owned(), times.into());
    }
    table.insert("words".to_owned(), fix.describe().into());
    Value::Object(table)
}
