//! `manifest.json`: the capture folder's table of contents, as written and read.
//!
//! Field names are a contract with scripts (`commands.md`, "The capture folder"): fields may be
//! added, none renamed. A key that does not apply is absent; a value that can't be known is null.

use super::{AdapterInfo, Timing};
use crate::plan::LeftOut;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The number that changes when old readers would misread the folder.
pub const SCHEMA: u32 = 1;

/// The whole file.
#[derive(Debug, Serialize, Deserialize)]
pub struct Manifest {
    pub schema: u32,
    pub program: String,
    pub scene: String,
    pub technique: String,
    pub settings: BTreeMap<String, String>,
    pub size: [u32; 2],
    pub adapter: AdapterInfo,
    pub camera: CameraEntry,
    pub passes: Vec<PassEntry>,
    pub lights: Vec<LightEntry>,
    pub left_out: Vec<LeftOut>,
    pub timing: Timing,
    /// File of the plan's text form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<String>,
}

/// The camera.
#[derive(Debug, Serialize, Deserialize)]
pub struct CameraEntry {
    pub eye: [f64; 3],
    pub target: [f64; 3],
    pub up: [f64; 3],
    pub fov_y_degrees: f64,
    pub near: f64,
    pub far: Option<f64>,
}

/// One pass: of the picture (`color`, `depth`, `stencil`) or of a shadow map (`map`, `map_face`).
#[derive(Debug, Serialize, Deserialize)]
pub struct PassEntry {
    pub index: usize,
    pub name: String,
    pub purpose: String,
    pub light: Option<usize>,
    pub caster: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stencil: Option<String>,
    /// The light's labels, for the pass that writes them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// Index of the face of `map` that the pass draws.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map_face: Option<usize>,
    /// Aspects whose file is an earlier pass's.
    #[serde(default)]
    pub unchanged: Vec<String>,
    pub draws: usize,
    pub triangles: u64,
    pub gpu_ms: Option<f64>,
    /// What was drawn, in order.
    #[serde(default)]
    pub draw_list: Vec<DrawEntry>,
}

/// One draw of a pass.
#[derive(Debug, Serialize, Deserialize)]
pub struct DrawEntry {
    pub name: String,
    pub caster: Option<String>,
    pub part: String,
    pub triangles: u64,
}

/// One light: `position` for a point light, `towards` for a directional one.
#[derive(Debug, Serialize, Deserialize)]
pub struct LightEntry {
    pub index: usize,
    pub kind: LightKind,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub towards: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shadow: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrices: Option<Matrices>,
}

/// What a light is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    Point,
    Directional,
}

/// The transforms of a shadow map, row by row.
#[derive(Debug, Serialize, Deserialize)]
pub struct Matrices {
    pub light_from_world: Rows,
    /// One a face.
    pub clip_from_light: Vec<Rows>,
}

/// A 4×4 matrix, rows first.
pub type Rows = [[f64; 4]; 4];
