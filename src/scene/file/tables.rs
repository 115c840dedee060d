//! The tables of a scene file, which are read and written in this form and order: no value is checked yet.
//!
//! `Spanned` values know where they stand, for error lines; those that are to be written stand nowhere yet.

use serde::de::{
    Deserializer, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer, value::SeqAccessDeserializer,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use toml::Spanned;

pub type Number = Spanned<f64>;
pub type Triple = Spanned<[f64; 3]>;
pub type Text = Spanned<String>;

/// A value that is to be written.
pub fn unplaced<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneTable {
    pub name: Option<String>,
    pub ambient: Option<Triple>,
    pub camera: Option<CameraTable>,
    #[serde(default)]
    pub lights: Vec<LightTable>,
    #[serde(default)]
    pub objects: Vec<ObjectTable>,
    pub technique: Option<TechniqueTable>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    pub eye: Triple,
    pub target: Triple,
    pub up: Option<Triple>,
    pub projection: Option<Text>,
    pub half_height: Option<Number>,
    pub oblique_angle_degrees: Option<Number>,
    pub oblique_factor: Option<Number>,
    pub fov_y_degrees: Option<Number>,
    pub near: Option<Number>,
    pub far: Option<Number>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightTable {
    pub kind: Text,
    pub position: Option<Triple>,
    pub towards: Option<Triple>,
    pub color: Option<Triple>,
    pub intensity: Option<Number>,
    pub on: Option<bool>,
    pub range: Option<Number>,
    pub orbit: Option<OrbitTable>,
    pub swing: Option<SwingTable>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrbitTable {
    pub center: Triple,
    pub axis: Triple,
    pub degrees_per_second: Number,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SwingTable {
    pub pivot: Triple,
    pub axis: Triple,
    pub degrees: Number,
    pub period_seconds: Number,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectTable {
    pub name: Option<Text>,
    pub translate: Option<Triple>,
    pub rotate_degrees: Option<Triple>,
    pub scale: Option<Triple>,
    pub spin_degrees_per_second: Option<Triple>,
    pub casts: Option<bool>,
    pub receives: Option<bool>,
    pub visible: Option<bool>,
    pub mesh: Spanned<MeshSource>,
    pub orbit: Option<OrbitTable>,
    pub swing: Option<SwingTable>,
    pub material: Option<MaterialTable>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    pub color: Option<Triple>,
    pub specular: Option<Number>,
    pub shininess: Option<Number>,
    pub shading: Option<Text>,
    pub opacity: Option<Number>,
    pub emission: Option<Triple>,
    pub checks: Option<Number>,
    pub texture: Option<Text>,
    pub texture_side: Option<Number>,
    pub texture_clamps: Option<Spanned<bool>>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TechniqueTable {
    pub name: String,
    #[serde(default)]
    pub settings: BTreeMap<String, Spanned<toml::Value>>,
}

/// A model's path, or a shape.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum MeshSource {
    File(String),
    Shape(Box<ShapeTable>),
}

/// A shape with the parameters of any; which belong to it is checked later.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShapeTable {
    pub shape: Text,
    pub size: Option<Spanned<Vec<f64>>>,
    pub radius: Option<Number>,
    pub height: Option<Number>,
    pub major: Option<Number>,
    pub minor: Option<Number>,
    pub segments: Option<Spanned<Segments>>,
    pub profile: Option<Spanned<Vec<[f64; 2]>>>,
    pub closed: Option<Spanned<bool>>,
    pub points: Option<Spanned<Vec<[f64; 3]>>>,
    pub indices: Option<Spanned<Vec<[u32; 3]>>>,
}

/// `32`, or `[48, 24]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Segments(pub Vec<u32>);

// Written out, and not `#[serde(untagged)]`, which would lose the places of what is inside.
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
