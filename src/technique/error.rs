//! Why a scene can't be planned.

pub use crate::scene::MOST_LIGHTS;

/// Why no frame can be planned for a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// A camera, light or object that no technique can draw.
    #[error("{problem}")]
    Unusable {
        /// What is wrong and how to fix it, in a sentence.
        problem: String,
    },
    /// The scene has more lights than a word has bits.
    #[error("{count} lights are too many: leave out {}, at most {MOST_LIGHTS} fit", count - MOST_LIGHTS)]
    TooManyLights {
        /// How many the scene has.
        count: usize,
    },
}
