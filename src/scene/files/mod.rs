//! Scenes and models from files: scene files, glTF, OBJ and PLY, and the name of any of them.
//!
//! ```text
//! open.rs ─► file.rs         scene files (TOML), read and saved
//!         ├► model.rs ─► obj.rs, ply.rs, gltf.rs   models by their files' endings
//!         │              └► model_scene.rs         a bare model gets a floor, a light and a camera
//!         └► builtin
//! ```
//!
//! Files are read without trust: sizes are bounded before memory is allocated, and every error names the file, the
//! place and how to fix it. What a shadow does not need keeps no model from being read: it is left out, and listed
//! (`repairs`, [`Unsupported`](crate::scene::Unsupported)).

pub mod file;
#[cfg(feature = "formats")]
mod gltf;
mod model;
mod model_scene;
pub mod obj;
mod open;
#[cfg(feature = "formats")]
mod ply;
mod polygon;
pub(super) mod read_text;
mod repairs;

pub use model_scene::{UpAxis, model_scene};
pub use open::{OpenSpec, files_of, is_model, is_scene_file, open};

#[cfg(test)]
mod tests;
