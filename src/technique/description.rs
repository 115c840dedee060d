//! What is said of a technique beside its plan: one constant each, in the technique's own file.

use super::settings::SettingSpec;
use super::{
    Job, PlanError, Technique, auto, none, planar, planar_texture, projective, ray_traced, shadow_map, volume,
};
use crate::plan::FramePlan;

/// Rows of a technique in a report: the settings that each changes.
pub type ReportRows = &'static [&'static [(&'static str, &'static str)]];

/// One row with the defaults.
pub(super) const ONE_ROW: ReportRows = &[&[]];

/// A technique, as commands, tables and the inspector know it.
#[derive(Debug, Clone, Copy)]
pub struct Description {
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// Makes a frame's plan.
    pub(super) plan: fn(Job) -> Result<FramePlan, PlanError>,
    /// Its settings, in the order in which they are shown.
    pub settings: &'static [SettingSpec],
    /// The settings that a report compares by default.
    pub report_rows: ReportRows,
    /// How it stands to the others where they are compared.
    pub standing: Standing,
}

/// How a technique stands to the others where they are compared.
#[derive(Debug, Clone, Copy)]
pub enum Standing {
    /// It makes shadows on the GPU, and runs in every stress case that does not say otherwise.
    Rival {
        /// Its place in tables of stress cases, from 0.
        place: usize,
        /// Why it is expected to be right where no failure of it is known.
        right_because: &'static str,
        /// The share of pixels that texels may make wrong along a shadow's edge, and why: of one that is never
        /// promised to be right.
        texels: Option<(f64, &'static str)>,
    },
    /// It is compared with nothing.
    Apart {
        /// Why.
        because: &'static str,
    },
}

impl Technique {
    /// All that is said of it.
    #[must_use]
    pub const fn description(self) -> &'static Description {
        match self {
            Technique::None => &none::DESCRIPTION,
            Technique::Planar => &planar::DESCRIPTION,
            Technique::PlanarTexture => &planar_texture::DESCRIPTION,
            Technique::ZPass => &volume::Z_PASS,
            Technique::ZFail => &volume::Z_FAIL,
            Technique::ZPassPlus => &volume::Z_PASS_PLUS,
            Technique::Auto => &auto::DESCRIPTION,
            Technique::ShadowMap => &shadow_map::DESCRIPTION,
            Technique::Projective => &projective::DESCRIPTION,
            Technique::RayTraced => &ray_traced::DESCRIPTION,
        }
    }

    /// What it does, in one sentence.
    #[must_use]
    pub fn summary(self) -> &'static str {
        self.description().summary
    }

    /// Its settings, in the order in which they are shown.
    #[must_use]
    pub fn settings(self) -> &'static [SettingSpec] {
        self.description().settings
    }

    /// Those that make shadows on the GPU, in the order of stress tables.
    #[must_use]
    pub fn rivals() -> Vec<Technique> {
        let place = |technique: Technique| match technique.description().standing {
            Standing::Rival { place, .. } => Some((place, technique)),
            Standing::Apart { .. } => None,
        };
        let mut rivals: Vec<_> = Technique::ALL.into_iter().filter_map(place).collect();
        rivals.sort_unstable();
        rivals.into_iter().map(|(_, technique)| technique).collect()
    }
}
