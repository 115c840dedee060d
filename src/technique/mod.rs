//! The techniques: each a pure function from a scene to a [`FramePlan`].
//!
//! A technique is one file with one function `(Job) → FramePlan`, a line in [`Technique::ALL`] and
//! its settings as data ([`settings`]). What they share is in [`frame`]: surfaces, the ambient
//! pass, the light pass and the mask pass.

mod settings;

pub use settings::{Choice, ChoiceError, SettingSpec, SettingValues};

/// A way to make shadows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Technique {
    /// No shadows at all.
    None,
    /// Casters flattened onto planes.
    Planar,
    /// Shadow volumes counted in front of the surface.
    ZPass,
    /// Shadow volumes counted behind the surface.
    ZFail,
    /// Depth from the light, compared at every pixel.
    ShadowMap,
}

impl Technique {
    /// All that exist, in teaching order.
    pub const ALL: [Technique; 5] =
        [Technique::None, Technique::Planar, Technique::ZPass, Technique::ZFail, Technique::ShadowMap];

    /// The name on the command line, in scene files and manifests.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Technique::None => "none",
            Technique::Planar => "planar",
            Technique::ZPass => "z-pass",
            Technique::ZFail => "z-fail",
            Technique::ShadowMap => "shadow-map",
        }
    }

    /// What it does, in one sentence.
    #[must_use]
    pub fn summary(self) -> &'static str {
        match self {
            Technique::None => "Every light reaches every surface that faces it: the picture to compare others with.",
            Technique::Planar => {
                "Casters are flattened onto every flat receiver, and the stencil keeps their shadow on it."
            }
            Technique::ZPass => {
                "Counts the shadow volumes that the view ray is inside of when it reaches the surface, from the eye on."
            }
            Technique::ZFail => {
                "Counts the same volumes from infinity back to the surface, so the eye may be inside one."
            }
            Technique::ShadowMap => "Stores the depth of what the light sees, and darkens what lies behind it.",
        }
    }

    /// The technique of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Technique> {
        Technique::ALL.into_iter().find(|technique| technique.name() == name)
    }
}
