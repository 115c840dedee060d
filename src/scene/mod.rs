//! What is to be rendered: objects, lights, a camera. Plain data in world space (`f64`), no GPU.
//!
//! A scene comes from a scene file ([`mod@file`]), a glTF file, a model ([`obj`] or PLY, completed by [`model_scene`])
//! or code ([`SceneBuilder`] and [`shapes`], as for [`builtin`]); [`open`] takes the name of any of them. Everything
//! that moves is placed for a time by [`Scene::at`], so nothing downstream knows about time.

mod builder;
pub mod builtin;
mod camera;
mod error;
pub mod files;
mod light;
mod material;
mod mesh;
mod names;
mod not_taken;
mod object;
mod picture;
mod refine;
pub mod shapes;
mod suggestion;
mod vary;
pub mod walking;

pub use builder::SceneBuilder;
pub use camera::placement::SceneBounds;
pub use camera::{Camera, CameraChange, CameraRays, Projection, Ray, Spherical};
use error::FileProblem;
pub use error::SceneError;
pub use files::{OpenSpec, UpAxis, file, files_of, is_model, is_scene_file, model_scene, obj, open};
pub use light::{Light, MOST_LIGHTS};
pub use material::{Material, Shading};
pub use mesh::{Mesh, MeshBuilder, MeshError, MeshGroup};
pub use not_taken::Unsupported;
pub use object::{Motion, Object, Orbit, Pose, PoseBits, Swing};
pub use picture::{ImageError, MaterialTexture, MipLevel, TextureImage};
pub use suggestion::{nearest, suggestion};
pub use vary::VaryError;
pub use walking::{Footing, WalkerBody, WallCache, Walls};

use std::collections::BTreeMap;

/// A scene at one time: the input of every technique and of the ground truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Name that is shown and written to manifests: a built-in's name, or the file's.
    pub name: String,
    /// Linear RGB light that reaches every surface.
    pub ambient: [f32; 3],
    /// The eye.
    pub camera: Camera,
    /// Lights in the order of the scene file; a light's index names its passes and files.
    pub lights: Vec<Light>,
    /// Objects in drawing order.
    pub objects: Vec<Object>,
    /// The technique that the scene file asks for, if any.
    pub technique: Option<TechniqueRequest>,
    /// Content of its file that is not shown; what a mesh's file has of that, the mesh lists.
    pub not_taken: Vec<Unsupported>,
}

/// A technique and its settings by name, as written in a scene file or on the command line.
/// `technique::Choice::parse` checks it: a scene knows no technique.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TechniqueRequest {
    /// Name of the technique, for example `z-fail`.
    pub name: String,
    /// Key and value of each setting, as in `--set KEY=VALUE`.
    pub settings: BTreeMap<String, String>,
}

impl Scene {
    /// Returns the scene `seconds` after its start: objects spun, and lights and objects moved along their orbits and
    /// on their pendulums. The motions remain, so `scene.at(a)` is not the start of `at(b)`: always call it on the
    /// scene as loaded.
    pub fn at(&self, seconds: f64) -> Scene {
        self.clone().advanced(seconds)
    }

    /// Returns the scene `seconds` after its start, as [`Scene::at`] does, without a copy.
    pub fn advanced(mut self, seconds: f64) -> Scene {
        for object in &mut self.objects {
            object.pose = object.motion.apply(&object.pose, seconds);
        }
        for light in &mut self.lights {
            light.position = light.motion.apply_to_light(light.position, seconds);
        }
        self
    }

    /// Returns whether any object or light of the scene moves; the camera never does.
    pub fn is_animated(&self) -> bool {
        let objects = self.objects.iter().map(|object| &object.motion);
        let lights = self.lights.iter().map(|light| &light.motion);
        objects.chain(lights).any(|motion| !motion.is_still())
    }
}
