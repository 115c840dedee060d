//! A technique with its settings, checked.

use super::named::Technique;
use super::settings::{self, CommonSettings, MapSettings, PlanarSettings, SettingMap, VolumeSettings};
use crate::geometry::light_frame::{self, LightFrustum};
use crate::scene::{Scene, TechniqueRequest, suggestion};
use std::collections::BTreeMap;

/// Why a technique or a setting is refused: an unknown name, an unknown key, or a value that is not allowed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    /// No such technique.
    #[error("no technique is called `{name}`: {hint}")]
    UnknownTechnique {
        /// What was asked for, as it was written.
        name: String,
        /// The nearest name, or all of them.
        hint: String,
    },
    /// The technique has no such setting.
    #[error("{technique} has no setting `{key}`: {hint}")]
    UnknownSetting {
        /// Name of the technique.
        technique: &'static str,
        /// What was asked for, as it was written.
        key: String,
        /// The nearest key, or all of them.
        hint: String,
    },
    /// The setting can't have this value.
    #[error("the setting `{key}` of {technique} can't be `{value}`: {hint}")]
    BadValue {
        /// Name of the technique.
        technique: &'static str,
        /// Key of the setting.
        key: &'static str,
        /// What was asked for, as it was written.
        value: String,
        /// The values that are allowed, in words.
        hint: String,
    },
}

/// The widest field of view that `light-frustum` can give a lamp's map, degrees.
pub const WIDEST_LIGHT_FRUSTUM: f64 = light_frame::WIDEST_GIVEN;

/// A technique with a valid value for each of its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    technique: Technique,
    settings: SettingMap,
}

impl Choice {
    /// Returns this choice as a scene file writes it: the technique's name, and the settings that differ from their
    /// defaults.
    pub fn to_request(&self) -> TechniqueRequest {
        let changed = self.technique().settings().iter().filter_map(|spec| {
            let value = self.settings().get(spec.key)?;
            (value != spec.default).then(|| (spec.key.to_owned(), value.clone()))
        });
        TechniqueRequest { name: self.technique().name().to_owned(), settings: changed.collect() }
    }

    /// Returns the technique with the default value of each setting.
    pub fn new(technique: Technique) -> Choice {
        let settings = technique.settings().iter().map(|spec| (spec.key.to_owned(), spec.default.to_owned()));
        Choice { technique, settings: settings.collect() }
    }

    /// Returns the choice that a request names, after checking the technique's name and each setting's name and value;
    /// settings that it does not name get their defaults.
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

    /// Returns the choice for a scene: the named technique, else the scene's own, else `auto`; with `settings` over those
    /// that the scene has for that technique.
    pub fn for_scene(
        scene: &Scene,
        technique: Option<&str>,
        settings: impl IntoIterator<Item = (String, String)>,
    ) -> Result<Choice, ChoiceError> {
        let of_scene = scene.technique.as_ref();
        let name = technique.or_else(|| of_scene.map(|request| request.name.as_str()));
        let name = name.unwrap_or(Technique::Auto.name()).to_owned();
        // A wrong name is said before wrong settings.
        Choice::parse(&TechniqueRequest { name: name.clone(), ..TechniqueRequest::default() })?;
        let mut all =
            of_scene.filter(|request| request.name == name).map_or_else(BTreeMap::new, |r| r.settings.clone());
        all.extend(settings);
        Choice::parse(&TechniqueRequest { name, settings: all })
    }

    /// Sets the setting `key` to `value`. Fails, and changes nothing, where the technique has no such setting or it
    /// does not accept the value.
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

    /// Returns the technique.
    pub fn technique(&self) -> Technique {
        self.technique
    }

    /// Returns the value of every setting of the technique by its key, defaults included.
    pub fn settings(&self) -> &SettingMap {
        &self.settings
    }

    /// Returns the settings that every technique has, parsed.
    pub fn common(&self) -> CommonSettings {
        CommonSettings::read(&self.settings)
    }

    /// Returns the settings of shadow volumes, parsed; `None` for a technique that counts none.
    pub fn volumes(&self) -> Option<VolumeSettings> {
        match self.technique {
            Technique::ZPass | Technique::ZFail | Technique::ZPassPlus => Some(VolumeSettings::read(&self.settings)),
            Technique::Auto => Some(VolumeSettings::of_auto(&self.common())),
            Technique::None
            | Technique::Planar
            | Technique::PlanarTexture
            | Technique::ShadowMap
            | Technique::Projective
            | Technique::RayTraced => None,
        }
    }

    /// Returns whether the technique has maps whose frustum can be set.
    pub fn has_light_frustum(&self) -> bool {
        self.technique == Technique::ShadowMap
    }

    /// Returns the numbers that `light-frustum` gives: a field of view in degrees (of a sun, a width in metres), near and far;
    /// `None` where it gives none, or the technique has no such setting.
    pub fn given_frustum(&self) -> Option<[f64; 3]> {
        match MapSettings::read(&self.settings).frustum {
            LightFrustum::Given { fov, near, far } if self.has_light_frustum() => Some([fov, near, far]),
            _ => None,
        }
    }

    /// Sets `light-frustum`; does nothing for a technique that has no such setting, or a value that can't be one.
    pub fn set_light_frustum(&mut self, value: &str) {
        if self.has_light_frustum() && settings::LIGHT_FRUSTUM.values.check(value).is_ok() {
            self.settings.insert(settings::LIGHT_FRUSTUM.key.to_owned(), value.to_owned());
        }
    }

    /// Returns the setting `size`: texels along each side of the technique's shadow maps, receiver textures or
    /// silhouettes; `None` where it has none.
    pub fn texels(&self) -> Option<u32> {
        let spec = self.technique.settings().iter().find(|spec| spec.key == settings::SIZE)?;
        spec.of(&self.settings).parse().ok()
    }

    /// Returns the technique's name, followed by its texels a side if it has maps or textures: `shadow-map 1024`. Other
    /// settings are not named.
    pub fn short_name(&self) -> String {
        let technique = self.technique().name();
        self.texels().map_or_else(|| technique.to_owned(), |texels| format!("{technique} {texels}"))
    }

    /// Returns this choice with shadow volumes counted in a float target instead of the stencil; `None` where they are
    /// counted in floats already, or the technique has no such setting.
    pub fn counting_in_floats(&self) -> Option<Choice> {
        let mut in_floats = self.clone();
        let [key, value] = VolumeSettings::in_floats();
        let is_in_eight_bits = self.volumes().is_some_and(|settings| !settings.counts_in_float);
        (is_in_eight_bits && in_floats.set(key, value).is_ok()).then_some(in_floats)
    }

    /// Returns the ray-traced ground truth with this choice's shading settings: its picture is what this choice's
    /// should be. The `depth` setting stays at its default, as it changes no colour and other values may clip geometry.
    pub fn truth_in_same_shading(&self) -> Choice {
        let mut truth = Choice::new(Technique::RayTraced);
        let same = settings::SHADING_KEYS.into_iter().filter_map(|key| self.settings.get_key_value(key));
        truth.settings.extend(same.map(|(key, value)| (key.clone(), value.clone())));
        truth
    }

    /// Returns why the setting `key` does nothing with the other settings as they are, in a sentence; `None` where it
    /// has an effect or that is not known, as for a key that the technique lacks.
    pub fn without_effect(&self, key: &str) -> Option<&'static str> {
        let of_planar = || (self.technique == Technique::Planar).then(|| PlanarSettings::read(&self.settings));
        CommonSettings::without_effect(&self.settings, key)
            .or_else(|| of_planar()?.without_effect(key))
            .or_else(|| self.volumes()?.without_effect(key))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Casters, Extrusion};
    use crate::plan::Decision;
    use crate::technique::{CasterRule, MapSettings};

    fn with(technique: Technique, changes: &[(&str, &str)]) -> Choice {
        let mut choice = Choice::new(technique);
        changes.iter().for_each(|(key, value)| choice.set(key, value).expect("a setting"));
        choice
    }

    #[test]
    fn words_become_what_they_stand_for() {
        let volumes = |changes: &[(&str, &str)]| with(Technique::ZFail, changes).volumes().expect("volumes");
        assert_eq!(volumes(&[]), VolumeSettings::read(&SettingMap::new()));
        let changed = volumes(&[("casters", "light-facing"), ("extrusion", "finite:2.5"), ("counter", "float")]);
        assert_eq!(changed.casters, CasterRule::Always(Casters::LightFacing));
        assert_eq!((changed.extrusion, changed.counts_in_float), (Extrusion::Finite(2.5), true));
        let some = with(Technique::Auto, &[("leave-out", "caps, umbra")]).common();
        let allowed = [Decision::Caps, Decision::Umbra, Decision::View, Decision::Light].map(|one| some.allows(one));
        assert_eq!(allowed, [true, true, false, false]);
        assert_eq!(with(Technique::ShadowMap, &[]).volumes(), None);
    }

    #[test]
    fn what_a_folder_reports_is_read_as_far_as_it_is_offered() {
        let settings = [("filter", "pcf:9999"), ("bias-normal", "NaN"), ("bias-slope", "3"), ("cull", "sideways")];
        let settings = settings.map(|(key, value)| (key.to_owned(), value.to_owned())).into();
        let expected = MapSettings { bias_slope: 3.0, ..MapSettings::read(&SettingMap::new()) };
        assert_eq!(MapSettings::read(&settings), expected);
    }

    #[test]
    fn what_has_no_effect_is_reported() {
        let off = |technique: Technique, changes: &[(&str, &str)]| {
            let choice = with(technique, changes);
            let keys = technique.settings().iter().map(|spec| spec.key);
            keys.filter(|key| choice.without_effect(key).is_some()).collect::<Vec<_>>()
        };
        assert_eq!(off(Technique::Planar, &[]), ["epsilon"]);
        assert_eq!(off(Technique::Planar, &[("stencil", "off")]), ["epsilon", "blend"]);
        // Volumes that extend to infinity, and one pass for both faces.
        let infinite = ["far-vertices", "order"];
        assert_eq!(off(Technique::ZFail, &[("depth", "standard-infinite-epsilon")]), infinite);
        let finite_in_turn = [("depth", "standard-infinite-epsilon"), ("extrusion", "finite:2"), ("faces", "two-pass")];
        assert!(off(Technique::ZFail, &finite_in_turn).is_empty());
        let in_float = ["epsilon", "far-vertices", "faces", "order", "operations", "stencil-bits", "relight"];
        assert_eq!(off(Technique::ZPass, &[("counter", "float")]), in_float);
        let parity = ["epsilon", "far-vertices", "order", "stencil-bits"];
        assert_eq!(off(Technique::ZPass, &[("operations", "invert")]), parity);
    }

    #[test]
    fn a_choice_counts_in_floats_where_a_setting_says_so() {
        let in_floats = Choice::new(Technique::ZPass).counting_in_floats().expect("a setting");
        assert!(in_floats.volumes().is_some_and(|settings| settings.counts_in_float));
        let others = [in_floats, Choice::new(Technique::Auto), Choice::new(Technique::Planar)];
        assert!(others.iter().all(|choice| choice.counting_in_floats().is_none()));
    }
}
