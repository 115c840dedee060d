//! The settings of a technique in groups, so that one finds them among two dozen.

named_enum! {
    /// A group of settings, in the order in which groups are shown.
    pub enum SettingGroup(
        /// What its settings are about.
        explanation
    ) {
        /// What casts, and how its volume is made.
        Casters = "Casters" ("Which triangles cast, and the shape of what they cast"),
        /// How shadows are counted or drawn, in the stencil or beside it.
        Counting = "In the stencil" ("What volumes or flattened casters do to the stencil, and where the count begins"),
        /// The map or texture that shadows are read from.
        Map = "Map" ("The map or texture that is drawn from the light, and how it is read"),
        /// What keeps a surface from shadowing itself in a map.
        Bias = "Bias" ("By how much a surface must lie behind what a map stores to be in shadow"),
        /// How light is computed.
        Light = "Light" ("How bright a lit surface is"),
        /// How distance is stored, and places.
        Depth = "Depth" ("How distance becomes depth, in how many bits, and how exactly places are known"),
        /// What is not done.
        LeftOut = "Left out" ("What a frame does without where that changes nothing"),
    }
}

/// The keys of each group.
const KEYS: [(SettingGroup, &[&str]); 7] = [
    (
        SettingGroup::Casters,
        &[
            "receivers",
            "casters",
            "silhouette",
            "mirrored",
            "caps",
            "light-caps",
            "extrusion",
            "extruded-by",
            "far-vertices",
            "reverse",
        ],
    ),
    (
        SettingGroup::Counting,
        &[
            "stencil",
            "blend",
            "clip",
            "z-fighting",
            "cache",
            "faces",
            "operations",
            "order",
            "stencil-bits",
            "start",
            "counter",
            "relight",
        ],
    ),
    (SettingGroup::Map, &["size", "light-frustum", "redraw", "cull", "filter", "passes", "fit", "border"]),
    (SettingGroup::Bias, &["bias-constant", "bias-slope", "bias-normal", "bias-receiver-plane"]),
    (SettingGroup::Light, &["diffuse", "ambient-diffuse", "shading"]),
    (SettingGroup::Depth, &["depth", "depth-bits", "depth-range", "epsilon", "world"]),
    (SettingGroup::LeftOut, &["leave-out", "occlusion"]),
];

impl SettingGroup {
    /// Returns the group of a setting; [`SettingGroup::LeftOut`] for one that is in none.
    pub fn of(key: &str) -> SettingGroup {
        let found = KEYS.iter().find(|(_, keys)| keys.contains(&key));
        found.map_or(SettingGroup::LeftOut, |(group, _)| *group)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Technique;
    use std::collections::BTreeSet;

    #[test]
    fn every_setting_is_in_one_group_and_no_group_has_another() {
        let known: BTreeSet<&str> = Technique::ALL.iter().flat_map(|one| one.settings()).map(|spec| spec.key).collect();
        let grouped: Vec<&str> = KEYS.iter().flat_map(|(_, keys)| keys.iter().copied()).collect();
        assert_eq!(grouped.len(), grouped.iter().collect::<BTreeSet<_>>().len(), "one is there twice");
        assert_eq!(grouped.into_iter().collect::<BTreeSet<_>>(), known);
    }
}
