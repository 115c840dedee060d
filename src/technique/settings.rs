//! Settings as data: keys, values and defaults of every technique, and the check of a request.
//!
//! The command line, scene files and the inspector all read the same table, so a new setting is
//! one line here and its use in the technique. Only what works is listed: a value that is not
//! there yet is refused, not ignored.

use super::{Technique, auto, none, planar, planar_texture, projective, ray_traced, shadow_map, volume};
use crate::math::depth::DepthMapping;
use crate::plan::Decision;
use crate::scene::{TechniqueRequest, suggestion};
use std::collections::BTreeMap;

/// One setting of a technique.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingSpec {
    /// As in `--set KEY=VALUE`.
    pub key: &'static str,
    /// What it may be.
    pub values: SettingValues,
    /// What it is unless set.
    pub default: &'static str,
    /// What it does, in a few words.
    pub meaning: &'static str,
}

/// What a setting may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingValues {
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A whole number in this range, ends included.
    Integer(i64, i64),
    /// A finite number in this range, ends included.
    Number(f64, f64),
    /// `all`, `none`, or some of these words between commas.
    SomeOf(&'static [&'static str]),
    /// One of these words, or a number in this range behind a prefix, as in `pcf:3`.
    WordOr {
        /// The words.
        words: &'static [&'static str],
        /// What the number follows, its colon included.
        prefix: &'static str,
        /// The smallest number.
        low: f64,
        /// The largest.
        high: f64,
        /// Without a fraction.
        whole: bool,
    },
}

/// Why a request for a technique can't be met.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    /// No such technique.
    #[error("no technique is called `{name}`: {hint}")]
    UnknownTechnique {
        /// What was asked for.
        name: String,
        /// The nearest name, or all of them.
        hint: String,
    },
    /// The technique has no such setting.
    #[error("{technique} has no setting `{key}`: {hint}")]
    UnknownSetting {
        /// The technique.
        technique: &'static str,
        /// What was asked for.
        key: String,
        /// The nearest key, or all of them.
        hint: String,
    },
    /// The setting can't be that.
    #[error("the setting `{key}` of {technique} can't be `{value}`: {hint}")]
    BadValue {
        /// The technique.
        technique: &'static str,
        /// The setting.
        key: &'static str,
        /// What was asked for.
        value: String,
        /// What it may be.
        hint: String,
    },
}

/// A technique with a value for each of its settings, all checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    technique: Technique,
    settings: BTreeMap<String, String>,
}

const DEPTH: SettingSpec = SettingSpec {
    key: "depth",
    values: SettingValues::OneOf(&DEPTH_NAMES),
    default: DEPTH_NAMES[0],
    meaning: "how distance becomes depth",
};
const DEPTH_NAMES: [&str; 5] = {
    let [a, b, c, d, e] = DepthMapping::ALL;
    [a.name(), b.name(), c.name(), d.name(), e.name()]
};
const EPSILON: SettingSpec = SettingSpec {
    key: "epsilon",
    values: SettingValues::Number(0.0, 0.1),
    // Two to the power of −22.
    default: "2.4e-7",
    meaning: "by how much standard-infinite-epsilon pulls infinity in",
};
const DIFFUSE: SettingSpec =
    word("diffuse", &["lambert", "wrapped"], "how brightness falls off with the angle of light");

const fn word(key: &'static str, values: &'static [&'static str], meaning: &'static str) -> SettingSpec {
    SettingSpec { key, values: SettingValues::OneOf(values), default: values[0], meaning }
}

const fn size(default: &'static str, most: i64, meaning: &'static str) -> SettingSpec {
    SettingSpec { key: "size", values: SettingValues::Integer(1, most), default, meaning }
}

const LEAVE_OUT: SettingSpec = SettingSpec {
    key: "leave-out",
    values: SettingValues::SomeOf(&Decision::NAMES),
    default: "all",
    meaning: "what the frame may do without where that is proven to change nothing",
};
const OCCLUSION: SettingSpec = word(
    "occlusion",
    &["off", "queries"],
    "a frame before the frame asks what shows; draws that show nothing are left out of the next",
);
const NONE: &[SettingSpec] = &[DEPTH, EPSILON, DIFFUSE, LEAVE_OUT, OCCLUSION];
const PLANAR: &[SettingSpec] = &[
    DEPTH,
    EPSILON,
    DIFFUSE,
    LEAVE_OUT,
    OCCLUSION,
    word("stencil", &["on", "off"], "keeps shadows on their receiver"),
    word("blend", &["once", "twice"], "how often overlapping triangles darken a pixel"),
    word("clip", &["on", "off"], "drops what is beyond the light or below the receiver"),
    word("z-fighting", &["depth-off", "polygon-offset", "none"], "how a shadow wins over the surface it lies on"),
    word("cache", &["on", "off"], "keeps flattened casters until plane, caster or light change"),
];
const VOLUME: &[SettingSpec] = &[
    DEPTH,
    EPSILON,
    DIFFUSE,
    LEAVE_OUT,
    OCCLUSION,
    word("casters", &["all", "by-topology", "light-facing", "light-back-facing"], "which triangles cast"),
    SettingSpec {
        key: "extrusion",
        // Farther, single precision loses the silhouette; nearer than not at all makes no sense.
        values: SettingValues::WordOr { words: &["infinite"], prefix: "finite:", low: 0.0, high: 1e6, whole: false },
        default: "infinite",
        meaning: "how far volumes reach: without end, or K times a vertex's distance from the light",
    },
    word("faces", &["two-sided", "two-pass"], "front and back faces in one draw, or in passes of their own"),
    word("operations", &["wrap", "clamp"], "what counts do beyond 0 and 255"),
    word("counter", &["stencil", "float"], "where counts are kept: in eight bits, or signed in a float a pixel"),
    word("light-caps", &["tested", "never"], "caps nearest the light pass the depth test, or never do"),
    word("silhouette", &["adjacency", "edge-list"], "how shared edges are found: built once, or searched each time"),
];
const REDRAW: SettingSpec = word(
    "redraw",
    &["always", "changed"],
    "maps and textures are drawn in every frame, or only where what makes them has changed",
);
const PLANAR_TEXTURE: &[SettingSpec] = &[
    DEPTH,
    EPSILON,
    DIFFUSE,
    LEAVE_OUT,
    OCCLUSION,
    size("256", 4096, "texels along each side of a receiver's texture"),
    REDRAW,
];
const PROJECTIVE: &[SettingSpec] = &[
    DEPTH,
    EPSILON,
    DIFFUSE,
    LEAVE_OUT,
    OCCLUSION,
    size("512", 4096, "texels along each side of a silhouette's picture"),
    word("passes", &["single", "multi"], "silhouettes are read while lighting, or darken the lit picture one by one"),
    word("reverse", &["off", "on"], "silhouettes also fall on what is behind the light"),
    REDRAW,
];
const SHADOW_MAP: &[SettingSpec] = &[
    DEPTH,
    EPSILON,
    DIFFUSE,
    LEAVE_OUT,
    OCCLUSION,
    size("1024", 8192, "texels along each side of the map"),
    SettingSpec {
        key: "bias-constant",
        values: SettingValues::Integer(-1_000_000, 1_000_000),
        // Rounding of positions to f32 differs by a few steps between the camera's and the light's view.
        default: "16",
        meaning: "steps of depth by which the map is pushed away from the light",
    },
    SettingSpec {
        key: "bias-slope",
        values: SettingValues::Number(-1000.0, 1000.0),
        default: "2.0",
        meaning: "depth slopes of a triangle across one texel by which the map is pushed away as well",
    },
    SettingSpec {
        key: "bias-normal",
        values: SettingValues::Number(-100.0, 100.0),
        default: "0",
        meaning: "texels by which a lookup is moved along the surface's normal",
    },
    word("bias-receiver-plane", &["off", "on"], "compares each texel with the surface's own plane there"),
    word("cull", &["none", "back", "front"], "which faces the map leaves out"),
    SettingSpec {
        key: "filter",
        values: SettingValues::WordOr { words: &["none"], prefix: "pcf:", low: 1.0, high: 15.0, whole: true },
        default: "none",
        meaning: "how many texels along each side are compared and averaged",
    },
    REDRAW,
];

impl Technique {
    /// Its settings, in the order in which they are shown.
    #[must_use]
    pub fn settings(self) -> &'static [SettingSpec] {
        match self {
            Technique::None | Technique::RayTraced | Technique::Auto => NONE,
            Technique::Planar => PLANAR,
            Technique::PlanarTexture => PLANAR_TEXTURE,
            Technique::ZPass | Technique::ZFail | Technique::ZPassPlus => VOLUME,
            Technique::ShadowMap => SHADOW_MAP,
            Technique::Projective => PROJECTIVE,
        }
    }
}

/// Rows of a technique in a report: the settings that each changes.
pub type ReportRows = &'static [&'static [(&'static str, &'static str)]];

/// One row with the defaults.
pub(super) const ONE_ROW: ReportRows = &[&[]];

impl Technique {
    /// The settings that a report compares by default; each technique declares its own beside
    /// its plan.
    #[must_use]
    pub fn report_rows(self) -> ReportRows {
        match self {
            Technique::None => none::REPORT_ROWS,
            Technique::Planar => planar::REPORT_ROWS,
            Technique::PlanarTexture => planar_texture::REPORT_ROWS,
            Technique::ZPass | Technique::ZPassPlus => volume::REPORT_ROWS,
            Technique::ZFail => volume::Z_FAIL_REPORT_ROWS,
            Technique::Auto => auto::REPORT_ROWS,
            Technique::ShadowMap => shadow_map::REPORT_ROWS,
            Technique::Projective => projective::REPORT_ROWS,
            Technique::RayTraced => ray_traced::REPORT_ROWS,
        }
    }
}

impl Choice {
    /// As a scene file names it: the technique, and the settings that are not as they are by default.
    #[must_use]
    pub fn to_request(&self) -> TechniqueRequest {
        let changed = self.technique().settings().iter().filter_map(|spec| {
            let value = self.settings().get(spec.key)?;
            (value != spec.default).then(|| (spec.key.to_owned(), value.clone()))
        });
        TechniqueRequest { name: self.technique().name().to_owned(), settings: changed.collect() }
    }

    /// Technique and size: `shadow-map 1024`.
    #[must_use]
    pub fn short_name(&self) -> String {
        let technique = self.technique().name();
        self.settings().get("size").map_or_else(|| technique.to_owned(), |size| format!("{technique} {size}"))
    }

    /// What a report compares by default: every row of every technique.
    ///
    /// # Errors
    /// A row that a technique's settings refuse: a bug, which a test finds.
    pub fn report_grid() -> Result<Vec<Choice>, ChoiceError> {
        let mut grid = Vec::new();
        for technique in Technique::ALL {
            for row in technique.report_rows() {
                let mut choice = Choice::new(technique);
                row.iter().try_for_each(|(key, value)| choice.set(key, value))?;
                grid.push(choice);
            }
        }
        Ok(grid)
    }

    /// `technique` with its defaults.
    #[must_use]
    pub fn new(technique: Technique) -> Choice {
        let settings = technique.settings().iter().map(|spec| (spec.key.to_owned(), spec.default.to_owned()));
        Choice { technique, settings: settings.collect() }
    }

    /// Checks names and values of a request.
    ///
    /// # Errors
    /// An unknown technique or key, with the nearest name; a value that is not offered.
    pub fn parse(request: &TechniqueRequest) -> Result<Choice, ChoiceError> {
        let technique = Technique::from_name(&request.name).ok_or_else(|| {
            let names: Vec<&str> = Technique::ALL.iter().map(|technique| technique.name()).collect();
            ChoiceError::UnknownTechnique { name: request.name.clone(), hint: suggestion(&request.name, &names) }
        })?;
        let mut choice = Choice::new(technique);
        for (key, value) in &request.settings {
            choice.set(key, value)?;
        }
        Ok(choice)
    }

    /// Changes one setting.
    ///
    /// # Errors
    /// An unknown key, or a value that is not offered; nothing is changed then.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), ChoiceError> {
        let technique = self.technique.name();
        let specs = self.technique.settings();
        let Some(spec) = specs.iter().find(|spec| spec.key == key) else {
            let keys: Vec<&str> = specs.iter().map(|spec| spec.key).collect();
            return Err(ChoiceError::UnknownSetting { technique, key: key.to_owned(), hint: suggestion(key, &keys) });
        };
        spec.values.check(value).map_err(|hint| ChoiceError::BadValue {
            technique,
            key: spec.key,
            value: value.to_owned(),
            hint,
        })?;
        self.settings.insert(key.to_owned(), value.to_owned());
        Ok(())
    }

    /// Which technique.
    #[must_use]
    pub fn technique(&self) -> Technique {
        self.technique
    }

    /// Key and value of every setting.
    #[must_use]
    pub fn settings(&self) -> &BTreeMap<String, String> {
        &self.settings
    }

    /// The value of a setting; empty where the technique has none of that name.
    #[must_use]
    pub(super) fn word(&self, key: &str) -> &str {
        self.settings.get(key).map_or("", String::as_str)
    }

    /// Maps and textures stay from frame to frame while nothing that makes them changes.
    pub(super) fn keeps_maps(&self) -> bool {
        self.word("redraw") == "changed"
    }

    /// The number behind a setting's prefix, as in `pcf:3`; `None` where a word is set.
    #[must_use]
    pub(super) fn number_after(&self, key: &str, prefix: &str) -> Option<f64> {
        self.word(key).strip_prefix(prefix)?.parse().ok()
    }

    /// The value of a setting as a number; 0 where the technique has no such number.
    #[must_use]
    pub(super) fn number(&self, key: &str) -> f64 {
        self.settings.get(key).and_then(|value| value.parse().ok()).unwrap_or(0.0)
    }
}

impl SettingValues {
    fn check(self, value: &str) -> Result<(), String> {
        let in_range = match self {
            SettingValues::OneOf(words) => words.contains(&value),
            SettingValues::SomeOf(words) => {
                let mut some = value.split(',').map(str::trim);
                ["all", "none"].contains(&value) || some.all(|one| words.contains(&one))
            }
            SettingValues::Integer(low, high) => value.parse().is_ok_and(|n: i64| (low..=high).contains(&n)),
            SettingValues::Number(low, high) => value.parse().is_ok_and(|n: f64| (low..=high).contains(&n)),
            SettingValues::WordOr { words, prefix, low, high, whole } => {
                let number = value.strip_prefix(prefix).and_then(|number| number.parse::<f64>().ok());
                let fits = |n: f64| (low..=high).contains(&n) && (!whole || n.fract() == 0.0);
                words.contains(&value) || number.is_some_and(fits)
            }
        };
        if in_range { Ok(()) } else { Err(self.to_string()) }
    }
}

impl std::fmt::Display for SettingValues {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SettingValues::OneOf([only]) => write!(f, "only `{only}` is there yet"),
            SettingValues::OneOf(words) => write!(f, "choose one of {}", words.join(", ")),
            SettingValues::SomeOf(words) => {
                write!(f, "choose all, none, or some of {}, between commas", words.join(", "))
            }
            SettingValues::Integer(low, high) => write!(f, "choose a whole number from {low} to {high}"),
            SettingValues::Number(low, high) => write!(f, "choose a number from {low} to {high}"),
            SettingValues::WordOr { words, prefix, low, high, whole } => {
                let number = if *whole { "a whole number" } else { "a number" };
                write!(f, "choose {}, or {prefix} and {number} from {low} to {high}", words.join(", "))
            }
        }
    }
}
