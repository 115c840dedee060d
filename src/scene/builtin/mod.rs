//! Scenes made by code, each small and for one lesson.

pub mod shapes;
mod table;
mod tori;

use super::{Material, Mesh, MeshError, Motion, Object, Pose, Scene, SceneError};
use glam::DVec3;
use std::sync::Arc;

/// A scene made by code.
#[derive(Debug, Clone, Copy)]
pub struct Builtin {
    /// On the command line.
    pub name: &'static str,
    /// What it shows, in one line.
    pub lesson: &'static str,
    build: fn() -> Result<Scene, MeshError>,
}

/// All of them; the first is the default.
pub const ALL: &[Builtin] = &[
    Builtin {
        name: "tori",
        lesson: "four tori orbit a point light in a room: shadow volumes, and a light that needs a cube shadow map",
        build: tori::build,
    },
    Builtin {
        name: "table",
        lesson: "a torus and four spheres over a slab: shadow maps with their acne, peter-panning and aliasing",
        build: table::build,
    },
];

impl Builtin {
    /// The one of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Builtin> {
        ALL.iter().find(|builtin| builtin.name == name)
    }

    /// Makes the scene.
    ///
    /// # Errors
    /// A broken mesh: a bug of the scene.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        (self.build)().map_err(|source| SceneError::Mesh { name: self.name.to_owned(), source })
    }
}

/// An object at `translate`.
fn placed(name: &str, mesh: &Arc<Mesh>, material: Material, translate: DVec3) -> Object {
    let pose = Pose { translate, ..Pose::default() };
    Object { pose, motion: Motion::default(), ..Object::new(name, Arc::clone(mesh), material) }
}
