//! The techniques: each a pure function from a scene to a [`FramePlan`].
//!
//! A technique is one file with a function `(Job) → FramePlan`, its settings as constants, and a [`Description`] with
//! all else that is said of it; and a variant of [`Technique`] with its name. The compiler names the few places that
//! ask for more, such as its mark in plots. What techniques share is in `frame.rs`: the camera, surfaces, and the
//! ambient, light and mask passes.

mod auto;
mod casters;
mod choice;
mod description;
mod frame;
mod named;
mod none;
mod outside;
mod planar;
mod planar_texture;
mod projective;
mod ray_traced;
mod receivers;
mod settings;
mod shadow_map;
mod shown;
mod silhouettes;
mod surfaces;
mod volume;

pub use choice::{Choice, ChoiceError};
pub use description::{Description, ReportRows, Standing};
pub use frame::{Job, MOST_LIGHTS};
pub use named::Technique;
pub use settings::{
    CommonSettings, MapSettings, PlanarSettings, SettingSpec, SettingValues, Values, VolumeSettings, WhoCasts,
};
pub use volume::casting;

use crate::plan::FramePlan;

/// Plans one frame.
///
/// # Errors
/// A camera or light that can't be used, or too many lights.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    (job.choice.technique().description().plan)(job)
}

/// Why a scene can't be planned.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// A camera, light or object that no technique can draw.
    #[error("{problem}")]
    Unusable {
        /// What is wrong, and the mend.
        problem: String,
    },
    /// More lights than bits in a word.
    #[error("{count} lights are too many: leave out {}, at most {MOST_LIGHTS} fit", count - MOST_LIGHTS)]
    TooManyLights {
        /// How many the scene has.
        count: usize,
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

impl Choice {
    /// What a report compares by default: every row of every technique.
    ///
    /// # Errors
    /// A row that a technique's settings refuse: a bug, which a test finds.
    pub fn report_grid() -> Result<Vec<Choice>, ChoiceError> {
        let mut grid = Vec::new();
        for technique in Technique::ALL {
            for row in technique.description().report_rows {
                let mut choice = Choice::new(technique);
                row.iter().try_for_each(|(key, value)| choice.set(key, value))?;
                grid.push(choice);
            }
        }
        Ok(grid)
    }
}
