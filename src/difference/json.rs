//! A difference as JSON: passes, lights and pixels count from 0.
//!
//! ```json
//! { "schema": 1, "size": [640, 480], "equal": false, "a": { "scene": "tori", "technique": "z-fail", "settings": {} }, "b": {},
//!   "asked": [ { "what": "technique", "a": "z-fail", "b": "z-pass" } ], "conditions": [],
//!   "first": { "name": "volumes", "light": 0, "index": [1, 1] },
//!   "passes": [ { "name": "volumes", "light": 0, "index": [1, 1], "only_in": null,
//!       "aspects": [ { "aspect": "stencil", "layer": null, "carried": false, "only_in": null, "sizes": null, "pixels": 1,
//!           "largest": { "at": [160, 120], "a": 1, "b": 3, "bits": null, "by": 2 },
//!           "region": { "pixels": 1, "box": [160, 120, 160, 120], "largest": {} } } ],
//!       "draws": [ { "name": "sides of bunny", "index": [0, 0], "aspects": [] } ] } ],
//!   "lights": [ { "light": 0, "labels": [ { "a": 0, "b": 1, "pixels": 1 } ], "aspects": [] } ] }
//! ```
//!
//! Floats have their bits beside them; a value that is no number is null, and so is a distance to it and between labels.

use super::{
    AspectChange, AspectDifference, AspectKind, ComparedFrame, ComparedSide, Difference, DifferenceNote,
    DifferingRegion, LightDifference, PassDifference, Texel, TexelDifference,
};
use serde::Serialize;
use serde_json::{Value, json};

#[derive(Serialize)]
struct DifferenceDocument<'a> {
    schema: u32,
    size: [u32; 2],
    equal: bool,
    a: Value,
    b: Value,
    asked: &'a [DifferenceNote],
    conditions: &'a [DifferenceNote],
    first: Option<Value>,
    passes: Vec<Value>,
    lights: Vec<Value>,
}

impl Difference {
    /// Returns the difference as JSON, in the format that the module's documentation shows.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let [a, b] = self.sides.each_ref().map(frame);
        let place = |pass: &PassDifference| json!({"name": pass.name, "light": pass.light, "index": pass.index});
        let document = DifferenceDocument {
            schema: 1,
            size: self.size,
            equal: self.is_none(),
            a,
            b,
            asked: &self.asked,
            conditions: &self.conditions,
            first: self.first().map(place),
            passes: self.passes.iter().map(pass).collect(),
            lights: self.lights.iter().map(light).collect(),
        };
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}

fn frame(ComparedFrame { scene, technique, settings }: &ComparedFrame) -> Value {
    json!({"scene": scene, "technique": technique, "settings": settings})
}

fn pass(pass: &PassDifference) -> Value {
    let draws = pass.draws.iter();
    let draws = draws.map(|draw| json!({"name": draw.name, "index": draw.index, "aspects": aspects(&draw.aspects)}));
    json!({
        "name": pass.name,
        "light": pass.light,
        "index": pass.index,
        "only_in": pass.only_in().map(ComparedSide::name),
        "aspects": aspects(&pass.aspects),
        "draws": draws.collect::<Vec<_>>(),
    })
}

fn light(light: &LightDifference) -> Value {
    let labels = light.labels.iter().map(|([a, b], pixels)| json!({"a": a, "b": b, "pixels": pixels}));
    json!({"light": light.light, "labels": labels.collect::<Vec<_>>(), "aspects": aspects(&light.aspects)})
}

fn aspects(differences: &[AspectDifference]) -> Vec<Value> {
    differences.iter().map(aspect).collect()
}

fn aspect(AspectDifference { aspect, found, carried }: &AspectDifference) -> Value {
    let (mut only_in, mut sizes, mut pixels) = (None, None, None);
    match found {
        AspectChange::OnlyIn(side) => only_in = Some(side.name()),
        AspectChange::Sizes(both) => sizes = Some(both),
        AspectChange::Pixels(difference) => pixels = Some(difference),
    }
    json!({
        "aspect": aspect.name(),
        "layer": aspect.layer(),
        "carried": carried,
        "only_in": only_in,
        "sizes": sizes,
        "pixels": pixels.map(|difference| difference.pixels),
        "largest": pixels.map(|difference| texel(*aspect, &difference.largest)),
        "region": pixels.map(|difference| region(*aspect, &difference.region)),
    })
}

fn region(aspect: AspectKind, DifferingRegion { pixels, bounds, largest }: &DifferingRegion) -> Value {
    json!({"pixels": pixels, "box": bounds, "largest": texel(aspect, largest)})
}

fn texel(aspect: AspectKind, TexelDifference { at, values, by }: &TexelDifference) -> Value {
    let value = |value: &Texel| match value {
        Texel::Byte(byte) => json!(byte),
        Texel::Color(channels) => json!(channels),
        // NaN is null.
        Texel::Float(number) => json!(number),
    };
    let bits = |value: &Texel| match value {
        Texel::Float(number) => Some(format!("0x{:08x}", number.to_bits())),
        Texel::Byte(_) | Texel::Color(_) => None,
    };
    let by = aspect.has_distances().then_some(by);
    let [a, b] = values;
    let bits = bits(a).zip(bits(b)).map(|(a, b)| [a, b]);
    json!({"at": at, "a": value(a), "b": value(b), "bits": bits, "by": by})
}
