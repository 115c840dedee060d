//! Settings as data: keys, values and defaults of every technique, and what each value becomes.
//!
//! The command line, scene files and the inspector read and write words, which [`Choice`](super::Choice) checks; here
//! they become a typed struct for each family of techniques: no word is compared anywhere else. A value that is not
//! implemented is refused, not ignored.

mod common;
mod face;
mod maps;
mod planar;
mod volume;

pub use common::CommonSettings;
pub(super) use common::SHADING_KEYS;
pub use face::{ReceiverChoice, SettingMap, SettingSpec, SettingValues};
pub(super) use maps::{LIGHT_FRUSTUM, SIZE};
pub use maps::{MapSettings, TextureSettings};
pub use planar::{PlanarSettings, ShadowBlend};
pub use volume::{CasterRule, CountOperations, VolumeSettings};

use super::named::Technique;

/// The settings of techniques that only have the common ones.
const COMMON: [SettingSpec; 10] = common::with_own([]);

impl Technique {
    /// Returns the technique's settings in the order in which they are shown.
    pub fn settings(self) -> &'static [SettingSpec] {
        match self {
            Technique::None | Technique::RayTraced | Technique::Auto => &COMMON,
            Technique::Planar => &planar::SETTINGS,
            Technique::PlanarTexture => &maps::PLANAR_TEXTURE,
            Technique::ZPass => &volume::Z_PASS,
            Technique::ZFail => &volume::Z_FAIL,
            Technique::ZPassPlus => &volume::Z_PASS_PLUS,
            Technique::ShadowMap => &maps::SHADOW_MAP,
            Technique::Projective => &maps::PROJECTIVE,
        }
    }
}
