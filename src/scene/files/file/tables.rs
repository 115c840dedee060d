//! The tables of a scene file, which are read and written in this format and order: no value is checked yet.
//!
//! `Spanned` values have their position in the text, for error lines; those that are to be written have none yet.

use serde::de::{
    Deserializer, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer, value::SeqAccessDeserializer,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use toml::Spanned;

/// A number with its position in the text.
pub type SpannedNumber = Spanned<f64>;
/// Three numbers with their position in the text.
pub type SpannedTriple = Spanned<[f64; 3]>;
/// A text with its position in the file.
pub type SpannedText = Spanned<String>;

/// Returns a value that is to be written, without a position.
pub fn unplaced<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}

/// A scene file as it is written: its tables before they are checked.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneTable {
    pub name: Option<String>,
    pub ambient: Option<SpannedTriple>,
    pub camera: Option<Spanned<CameraTable>>,
    #[serde(default)]
    pub lights: Vec<LightTable>,
    #[serde(default)]
    pub objects: Vec<ObjectTable>,
    pub technique: Option<TechniqueTable>,
}

/// The table of the camera in a scene file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    pub eye: Option<SpannedTriple>,
    pub eye_spherical: Option<SpannedTriple>,
    pub target: SpannedTriple,
    pub up: Option<SpannedTriple>,
    pub projection: Option<SpannedText>,
    pub frustum: Option<Spanned<[f64; 4]>>,
    pub viewport: Option<Spanned<[f64; 4]>>,
    pub half_height: Option<SpannedNumber>,
    pub oblique_angle_degrees: Option<SpannedNumber>,
    pub oblique_factor: Option<SpannedNumber>,
    pub fov_y_degrees: Option<SpannedNumber>,
    pub near: Option<SpannedNumber>,
    pub far: Option<SpannedNumber>,
}

/// The table of a light in a scene file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightTable {
    pub kind: SpannedText,
    pub position: Option<SpannedTriple>,
    pub towards: Option<SpannedTriple>,
    pub color: Option<SpannedTriple>,
    pub intensity: Option<SpannedNumber>,
    pub on: Option<bool>,
    pub range: Option<SpannedNumber>,
    pub orbit: Option<OrbitTable>,
    pub swing: Option<SwingTable>,
}

/// The motion of a light or object on a circle, in a scene file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrbitTable {
    pub center: SpannedTriple,
    pub axis: SpannedTriple,
    pub degrees_per_second: SpannedNumber,
}

/// The motion of a light or object to and fro, in a scene file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SwingTable {
    pub pivot: SpannedTriple,
    pub axis: SpannedTriple,
    pub degrees: SpannedNumber,
    pub period_seconds: SpannedNumber,
}

/// The table of an object in a scene file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectTable {
    pub name: Option<SpannedText>,
    pub translate: Option<SpannedTriple>,
    pub rotate_degrees: Option<SpannedTriple>,
    pub scale: Option<SpannedTriple>,
    pub spin_degrees_per_second: Option<SpannedTriple>,
    pub casts: Option<bool>,
    pub receives: Option<bool>,
    pub visible: Option<bool>,
    pub mesh: Spanned<MeshSource>,
    pub orbit: Option<OrbitTable>,
    pub swing: Option<SwingTable>,
    pub material: Option<MaterialTable>,
}

/// The material of an object in a scene file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    pub color: Option<SpannedTriple>,
    pub specular: Option<SpannedNumber>,
    pub shininess: Option<SpannedNumber>,
    pub shading: Option<SpannedText>,
    pub opacity: Option<SpannedNumber>,
    pub emission: Option<SpannedTriple>,
    pub checks: Option<SpannedNumber>,
    pub texture: Option<SpannedText>,
    pub texture_side: Option<SpannedNumber>,
    pub texture_clamps: Option<Spanned<bool>>,
}

/// The table of the technique in a scene file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TechniqueTable {
    pub name: String,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, Spanned<toml::Value>>,
}

/// The source of an object's mesh: a model's path, or a shape.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum MeshSource {
    File(String),
    Shape(Box<ShapeTable>),
}

/// A shape with the parameters of all shapes; which belong to it is checked later.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShapeTable {
    pub shape: SpannedText,
    pub size: Option<Spanned<Vec<f64>>>,
    pub radius: Option<SpannedNumber>,
    pub height: Option<SpannedNumber>,
    pub major: Option<SpannedNumber>,
    pub minor: Option<SpannedNumber>,
    pub segments: Option<Spanned<Segments>>,
    pub profile: Option<Spanned<Vec<[f64; 2]>>>,
    pub closed: Option<Spanned<bool>>,
    pub points: Option<Spanned<Vec<[f64; 3]>>>,
    pub indices: Option<Spanned<Vec<[u32; 3]>>>,
}

/// How finely a shape is divided: one number, `32`, or several, `[48, 24]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Segments(pub Vec<u32>);

// Implemented here, and not by `#[serde(untagged)]`, which would lose the positions of inner values.
impl<'de> Deserialize<'de> for MeshSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<MeshSource, D::Error> {
        deserializer.deserialize_any(MeshSourceVisitor)
    }
}

struct MeshSourceVisitor;

impl<'de> Visitor<'de> for MeshSourceVisitor {
    type Value = MeshSource;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the path of a model or a table with a shape")
    }

    fn visit_str<E>(self, path: &str) -> Result<MeshSource, E> {
        Ok(MeshSource::File(path.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MeshSource, A::Error> {
        ShapeTable::deserialize(MapAccessDeserializer::new(map)).map(|shape| MeshSource::Shape(Box::new(shape)))
    }
}

impl<'de> Deserialize<'de> for Segments {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Segments, D::Error> {
        deserializer.deserialize_any(SegmentsVisitor)
    }
}

struct SegmentsVisitor;

impl<'de> Visitor<'de> for SegmentsVisitor {
    type Value = Segments;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a whole number or two in brackets")
    }

    fn visit_i64<E: serde::de::Error>(self, count: i64) -> Result<Segments, E> {
        let count = u32::try_from(count).map_err(|_| E::custom(format!("{count} segments can't be made")))?;
        Ok(Segments(vec![count]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, counts: A) -> Result<Segments, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(counts)).map(Segments)
    }
}
