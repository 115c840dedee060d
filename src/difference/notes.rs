//! Notes on how two frames were requested, and on their cameras and lights, where these differ.

use crate::capture::{Capture, CapturedLight};
use crate::numbers;
use glam::{DVec3, DVec4};
use std::collections::BTreeSet;

/// Something besides pixels that differs between two frames.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct DifferenceNote {
    /// What differs: `technique`, `setting casters`, `camera's eye`.
    pub what: String,
    /// Its value in the first frame.
    pub a: String,
    /// Its value in the second frame.
    pub b: String,
}

/// Text for a missing value.
const NONE: &str = "none";

/// Returns what was asked for differently: scene, technique, settings, adapter and driver; of different techniques only
/// settings that both have. Only where none of these differs, also the first line in which the plans differ.
pub(super) fn asked(a: &Capture, b: &Capture) -> Vec<DifferenceNote> {
    let mut notes = NoteList::default();
    notes.add("scene", &a.scene, &b.scene);
    notes.add("technique", &a.technique, &b.technique);
    let keys: BTreeSet<&String> = a.settings.keys().chain(b.settings.keys()).collect();
    // Another technique has other settings; only those that both have are reported then.
    let is_of_both = |key: &&String| a.settings.contains_key(*key) && b.settings.contains_key(*key);
    for key in keys.into_iter().filter(|key| a.technique == b.technique || is_of_both(key)) {
        let [in_a, in_b] = [a, b].map(|capture| capture.settings.get(key).map_or(NONE, String::as_str));
        notes.add(&format!("setting {key}"), in_a, in_b);
    }
    notes.add("adapter", &a.adapter.name, &b.adapter.name);
    notes.add("driver", &a.adapter.driver, &b.adapter.driver);
    if notes.0.is_empty() {
        // Where nothing else was asked differently: two versions of the program, or of a scene.
        notes.plans(&a.plan_text, &b.plan_text);
    }
    notes.0
}

/// Returns differences of camera, depth mapping, number of lights, and the positions and map matrices of lights that
/// both have.
pub(super) fn conditions(a: &Capture, b: &Capture) -> Vec<DifferenceNote> {
    let mut notes = NoteList::default();
    let far = |capture: &Capture| capture.camera.far.map_or_else(|| NONE.to_owned(), |far| far.to_string());
    notes.add("camera's eye", &point(a.camera.eye), &point(b.camera.eye));
    notes.add("camera's target", &point(a.camera.target), &point(b.camera.target));
    notes.add("camera's up", &point(a.camera.up), &point(b.camera.up));
    notes.add("projection", &a.camera.projection.to_string(), &b.camera.projection.to_string());
    notes.add("field of view", &a.camera.fov_y_degrees.to_string(), &b.camera.fov_y_degrees.to_string());
    notes.add("near plane", &a.camera.near.to_string(), &b.camera.near.to_string());
    notes.add("far plane", &far(a), &far(b));
    let depth = |capture: &Capture| format!("{}: {}", capture.depth.mapping.name(), capture.depth.formula());
    notes.add("depth", &depth(a), &depth(b));
    notes.add("lights", &a.lights.len().to_string(), &b.lights.len().to_string());
    for (index, (in_a, in_b)) in a.lights.iter().zip(&b.lights).enumerate() {
        let name = numbers::light(index);
        notes.add(&name, &light(in_a.position), &light(in_b.position));
        if let [Some(in_a), Some(in_b)] = [in_a, in_b].map(matrices) {
            notes.add(&format!("matrices of {name}"), &in_a, &in_b);
        }
    }
    notes.0
}

#[derive(Default)]
struct NoteList(Vec<DifferenceNote>);

impl NoteList {
    fn add(&mut self, what: &str, a: &str, b: &str) {
        if a != b {
            self.0.push(DifferenceNote { what: what.to_owned(), a: a.to_owned(), b: b.to_owned() });
        }
    }

    /// Adds a note with the first line in which two plans differ; nothing where they are equal or one is empty, as it
    /// is not known.
    fn plans(&mut self, a: &str, b: &str) {
        if a.is_empty() || b.is_empty() {
            return;
        }
        let lines = a.lines().count().max(b.lines().count());
        let line = |text: &str, index: usize| text.lines().nth(index).map_or(NONE, str::trim).to_owned();
        let mut in_a = a.lines();
        let mut in_b = b.lines();
        if let Some(index) = (0..lines).find(|_| in_a.next() != in_b.next()) {
            self.add(&format!("plan, from line {} on", index + 1), &line(a, index), &line(b, index));
        }
    }
}

fn point(at: DVec3) -> String {
    format!("{}, {}, {}", at.x, at.y, at.z)
}

fn light(position: DVec4) -> String {
    let kind = if position.w == 0.0 { "towards" } else { "at" };
    format!("{kind} {}", point(position.truncate()))
}

/// Returns the matrices of a light's map as text, row by row, in the fewest digits that read back as the same bits;
/// `None` where it has no map.
fn matrices(light: &CapturedLight) -> Option<String> {
    let map = light.map.as_ref()?;
    let all = std::iter::once(&map.light_from_world).chain(&map.clip_from_light);
    let numbers = all.flat_map(|matrix| matrix.transpose().to_cols_array());
    Some(numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(" "))
}
