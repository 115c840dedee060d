//! To come.
use super::{Scene, SceneError};
pub fn open(spec: &str) -> Result<Scene, SceneError> {
    unimplemented!("{spec}")
}
