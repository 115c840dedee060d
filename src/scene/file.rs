//! To come.
use super::{Scene, SceneError};
pub fn load(path: &std::path::Path) -> Result<Scene, SceneError> {
    Err(SceneError::Read { file: path.to_owned(), reason: "to come".to_owned() })
}
