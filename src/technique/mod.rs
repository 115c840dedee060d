//! The techniques: each a pure function from a scene to a [`FramePlan`].
//!
//! A technique is one file with a function `(Job) → FramePlan`, its settings as constants, and a [`Description`] with
//! all else that is said of it; and a variant of [`Technique`] with its name. The compiler names the few places that
//! ask for more, such as its mark in plots. What techniques share is in `frame.rs`: the camera, surfaces, and the
//! ambient, light and mask passes.

mod auto;
mod casters;
mod description;
mod frame;
mod maps;
mod none;
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

pub use description::{Description, ReportRows, Standing};
pub use frame::{Job, MOST_LIGHTS};
pub use planar::PlanarSettings;
pub use settings::{Choice, ChoiceError, CommonSettings, SettingSpec, SettingValues, Values};
pub use shadow_map::MapSettings;
pub use volume::{VolumeSettings, WhoCasts, casting};

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

named_enum! {
    /// A way to make shadows, in teaching order.
    pub enum Technique {
        /// No shadows at all.
        None = "none",
        /// Casters flattened onto planes.
        Planar = "planar",
        /// Casters drawn into a texture of every flat receiver.
        PlanarTexture = "planar-texture",
        /// Shadow volumes counted in front of the surface.
        ZPass = "z-pass",
        /// Shadow volumes counted behind the surface.
        ZFail = "z-fail",
        /// Shadow volumes counted in front of the surface, from the near plane's own count on.
        ZPassPlus = "z-pass-plus",
        /// Shadow volumes, each counted as is cheapest while right, and only those that matter.
        Auto = "auto",
        /// Depth from the light, compared at every pixel.
        ShadowMap = "shadow-map",
        /// Casters' silhouettes projected over the scene.
        Projective = "projective",
        /// Rays from eye and light: the ground truth.
        RayTraced = "ray-traced",
    }
}
