//! Which parts of a scene are shown.

/// Which parts of the views of the scene in space are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SceneToggles {
    /// The objects.
    pub objects: bool,
    /// All edges of objects' triangles.
    pub wireframe: bool,
    /// The normals that surfaces are shaded by.
    pub normals: bool,
    /// The sides of volumes.
    pub sides: bool,
    /// The volumes' caps near the light.
    pub light_caps: bool,
    /// The volumes' caps away from the light.
    pub dark_caps: bool,
    /// Silhouettes with multiplicities.
    pub silhouettes: bool,
    /// Frusta of camera and maps.
    pub frusta: bool,
    /// The near-clip volume.
    pub near_clip: bool,
    /// The pick's view ray and shadow rays.
    pub rays: bool,
    /// Names of objects, lights and camera.
    pub names: bool,
}

impl Default for SceneToggles {
    fn default() -> SceneToggles {
        SceneToggles {
            objects: true,
            wireframe: false,
            normals: false,
            sides: true,
            light_caps: true,
            dark_caps: true,
            silhouettes: true,
            frusta: true,
            near_clip: false,
            rays: true,
            names: false,
        }
    }
}

/// The light and the caster of which volumes and silhouettes are shown; `None`: of all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct VolumeFilter {
    /// Index of the light.
    pub light: Option<usize>,
    /// Index of the object.
    pub caster: Option<usize>,
}

impl VolumeFilter {
    /// Returns whether the volume and silhouette of a light and a caster are shown: those of the chosen light and
    /// caster, or of all where none is chosen; but a caster that encloses everything, in `holders`, only where it is
    /// chosen.
    pub fn has(self, light: usize, caster: usize, holders: &[bool]) -> bool {
        let holds = holders.get(caster).is_some_and(|holds| *holds);
        self.light.is_none_or(|one| one == light) && self.caster.map_or(!holds, |one| one == caster)
    }

    /// Returns whether the frustum of a light's map is shown: where that light, or none, is chosen, and, for a map that
    /// belongs to one `caster`, no other caster is.
    pub fn has_frustum(self, light: usize, caster: Option<usize>) -> bool {
        let is_other = caster.is_some_and(|caster| self.caster.is_some_and(|one| one != caster));
        self.light.is_none_or(|one| one == light) && !is_other
    }
}
