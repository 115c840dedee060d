//! To come.
use super::Scene;
pub fn model_scene() -> Option<Scene> {
    None
}
