//! `manifest.json` of a capture folder; `assets/help/capture-folder.md` says what each field means.
//!
//! Names are a contract with scripts: add fields, rename none.

use super::{AdapterInfo, AdapterProfile, Capture, DrawSummary, FrameTarget, Origin, StoredQuantity, Timing};
use crate::accuracy::{ErrorCounts, VisibilityError, WrongRegion};
use crate::math::depth::DepthCurve;
use crate::plan::{CountOf, CountedSide, DecidedBy, DrawPart, LeftOut};
use crate::scene::Camera;
use glam::{DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of the folder's layout: from 2 on it has the frame and the scene.
const SCHEMA: u32 = 2;
/// The versions that can be read.
pub(super) const SCHEMAS: std::ops::RangeInclusive<u32> = 1..=SCHEMA;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Manifest {
    pub schema: u32,
    pub program: String,
    pub scene: String,
    pub technique: String,
    pub settings: BTreeMap<String, String>,
    pub size: [u32; 2],
    pub adapter: AdapterInfo,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<AdapterProfile>,
    pub camera: Camera,
    /// `depth = offset + scale / distance`; folders without it were stored with reversed, infinite depth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<DepthCurve>,
    pub passes: Vec<PassEntry>,
    pub lights: Vec<LightEntry>,
    pub left_out: Vec<LeftOut>,
    pub timing: Timing,
    /// The program and recorder that the frame comes from, if another program drew it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<Origin>,
}

/// A pass with the files of what it left, or with the map it drew into.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct PassEntry {
    pub index: usize,
    pub name: String,
    pub purpose: String,
    pub light: Option<usize>,
    pub caster: Option<String>,
    #[serde(flatten)]
    pub files: StateFiles,
    pub draws: usize,
    pub triangles: u64,
    pub gpu_ms: Option<f64>,
    pub draw_list: Vec<DrawSummary>,
    /// The state after each draw, in order, where it was captured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub draws_captured: Option<Vec<DrawStateEntry>>,
}

/// A draw with the files of what it left.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct DrawStateEntry {
    pub name: String,
    pub caster: Option<String>,
    pub part: DrawPart,
    #[serde(flatten)]
    pub files: StateFiles,
}

/// The files of what a pass or a draw left.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct StateFiles {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stencil: Option<String>,
    /// Aspects that were not changed: they name an earlier file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unchanged: Option<Vec<String>>,
    /// File of the labels that a mask pass writes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<String>,
    /// File of the counts that a volume pass adds up, where they are not in the stencil.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<String>,
    /// File of which share of the light arrives, that a visibility pass writes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visibility: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// The face of the map that it drew; without one, the file is that face alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map_face: Option<usize>,
    /// File of the textures of the light that passes, in place of a map of depths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub textures: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture_layer: Option<usize>,
}

#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct LightEntry {
    pub index: usize,
    pub kind: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub towards: Option<[f64; 3]>,
    /// Where it is for objects that have it elsewhere, by their names, homogeneous.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub of_casters: BTreeMap<String, [f64; 4]>,
    /// What decided where its shadow is; missing in folders of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decided_by: Option<DecidedBy>,
    /// What its count of shadow volumes counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count_of: Option<CountOf>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shadow: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<String>,
    /// Pixels whose count is not 0 but reads as 0 in eight bits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrapped_pixels: Option<u64>,
    /// File of which share of it arrives at each pixel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visibility: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// File of the light that passes each receiver's texture or caster's silhouette: (layers, size, size, 4).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub textures: Option<String>,
    /// Name of the receiver or caster of each layer of the textures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layer_names: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrices: Option<MatricesEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorCounts>,
    /// File of the truth's visibility, where the technique knows shares.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth_visibility: Option<String>,
    /// How far the technique's visibility is from the truth's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visibility_error: Option<VisibilityError>,
    /// File of findings, one byte a pixel, as numbered in `findings`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_picture: Option<String>,
    /// Meaning of the error picture's numbers, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_region: Option<WrongRegion>,
}

/// Matrices, row by row.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct MatricesEntry {
    pub light_from_world: [[f64; 4]; 4],
    /// Clip space of each face from light space.
    pub clip_from_light: Vec<[[f64; 4]; 4]>,
    /// What the map's texels hold, where it is not depth.
    #[serde(default, skip_serializing_if = "is_depth")]
    pub quantity: StoredQuantity,
}

fn is_depth(quantity: &StoredQuantity) -> bool {
    *quantity == StoredQuantity::Depth
}

impl StateFiles {
    /// Returns what the pass or draw drew into, by the file that is named.
    pub fn target(&self) -> FrameTarget {
        let named = |target: &FrameTarget| self.of_target(*target).is_some();
        FrameTarget::ALL.into_iter().find(named).unwrap_or_default()
    }

    /// Returns the file of a light's target; `None` where none is named, and for the picture, which has three.
    pub fn of_target(&self, target: FrameTarget) -> Option<&String> {
        match target {
            FrameTarget::Picture => None,
            FrameTarget::Labels => self.labels.as_ref(),
            FrameTarget::Count => self.count.as_ref(),
            FrameTarget::Visibility => self.visibility.as_ref(),
        }
    }

    /// Returns these files, with that of a light's target; unchanged for the picture.
    pub fn with_target(self, target: FrameTarget, file: String) -> StateFiles {
        match target {
            FrameTarget::Picture => self,
            FrameTarget::Labels => StateFiles { labels: Some(file), ..self },
            FrameTarget::Count => StateFiles { count: Some(file), ..self },
            FrameTarget::Visibility => StateFiles { visibility: Some(file), ..self },
        }
    }
}

impl Manifest {
    /// Returns the manifest of a capture with empty lists of passes and lights: the writer adds them with their files'
    /// names.
    pub fn new(capture: &Capture) -> Manifest {
        Manifest {
            schema: SCHEMA,
            program: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")).to_owned(),
            scene: capture.scene.clone(),
            technique: capture.technique.clone(),
            settings: capture.settings.clone(),
            size: capture.size,
            adapter: capture.adapter.clone(),
            profile: capture.profile,
            camera: capture.camera,
            depth: Some(capture.depth),
            passes: Vec::new(),
            lights: Vec::new(),
            left_out: capture.left_out.clone(),
            timing: capture.timing,
            origin: capture.origin.clone(),
        }
    }
}

impl LightEntry {
    /// Returns the entry of light number `index` with its kind and its position or direction, and no files. A zero
    /// `position` is a light whose place is unknown, and w 0 a directional one.
    pub fn new(index: usize, position: DVec4) -> LightEntry {
        let at = position.truncate().to_array();
        let (kind, position, towards) = if position == DVec4::ZERO {
            ("unknown", None, None)
        } else if position.w == 0.0 {
            ("directional", None, Some(at))
        } else {
            ("point", Some(at), None)
        };
        LightEntry { index, kind: kind.to_owned(), position, towards, ..LightEntry::default() }
    }

    /// Returns what decided where the light's shadow is: as the folder states it; where it does not (an older folder),
    /// as the technique's name and the light's files suggest, [`DecidedBy::Nothing`] if they suggest nothing.
    pub fn decided_by(&self, technique: &str) -> DecidedBy {
        let side = match technique {
            "z-pass" | "z-pass-plus" => Some(CountedSide::InFront),
            "z-fail" => Some(CountedSide::Behind),
            "auto" => Some(CountedSide::AsNeeded),
            _ => None,
        };
        self.decided_by.unwrap_or(match (side, technique) {
            (Some(side), _) if self.count.is_some() => DecidedBy::FloatCount { side },
            (Some(side), _) => DecidedBy::StencilCount { side },
            (None, "planar") => DecidedBy::Flattened,
            (None, "ray-traced") => DecidedBy::Labels,
            (None, "projective") if self.textures.is_some() => DecidedBy::Silhouettes,
            (None, _) if self.textures.is_some() => DecidedBy::ReceiverTextures,
            (None, _) if self.map.is_some() => DecidedBy::Map,
            (None, _) => DecidedBy::Nothing,
        })
    }

    /// Returns the homogeneous position: w 1 for a point, w 0 for a direction towards the light, zero for kind
    /// `unknown`. `None` where another kind has neither position nor direction.
    pub fn homogeneous(&self) -> Option<DVec4> {
        if self.kind == "unknown" {
            return Some(DVec4::ZERO);
        }
        let point = self.position.map(|at| DVec3::from_array(at).extend(1.0));
        point.or_else(|| self.towards.map(|at| DVec3::from_array(at).extend(0.0)))
    }
}

pub(super) fn rows(matrix: DMat4) -> [[f64; 4]; 4] {
    matrix.transpose().to_cols_array_2d()
}

pub(super) fn from_rows(rows: &[[f64; 4]; 4]) -> DMat4 {
    DMat4::from_cols_array_2d(rows).transpose()
}
