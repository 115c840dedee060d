//! An eye that moves a little to its side from picture to picture, by which one sees what does not stand still in a
//! scene that does: edges of shadows that crawl from texel to texel.

use crate::scene::Scene;

/// How far the eye moves from picture to picture, in distances to its target.
const STEP: f64 = 1.0 / 400.0;

/// The eye of a scene, moved to its right in equal steps; where it looks moves with it.
#[derive(Debug, Clone, PartialEq)]
pub struct EyeMove {
    scene: Scene,
    places: u32,
}

impl EyeMove {
    /// Prepares the scene's eye to move in `places` steps; the first is where it is.
    pub fn new(scene: Scene, places: u32) -> EyeMove {
        EyeMove { scene, places }
    }

    /// Returns the number of positions of the eye, one for each picture of the film.
    pub fn places(&self) -> u32 {
        self.places
    }

    /// Returns the scene seen from a position of the eye, counted from 0.
    pub fn scene(&self, place: u32) -> Scene {
        Scene { camera: self.scene.camera.moved_aside(STEP * f64::from(place)), ..self.scene.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, SceneBuilder};
    use glam::DVec3;

    #[test]
    fn the_eye_moves_to_its_right_and_looks_the_same_way() {
        let scene = SceneBuilder::new("empty").light(Light::point([0.0, 3.0, 0.0]));
        let moves = EyeMove::new(scene.seen_from([0.0, 0.0, 4.0], [0.0; 3]).build(), 9);
        let [first, last] = [0, 8].map(|place| moves.scene(place).camera);
        assert_eq!(first.eye, DVec3::new(0.0, 0.0, 4.0));
        assert!((last.eye - DVec3::new(0.08, 0.0, 4.0)).length() < 1e-12 && (last.target.x - 0.08).abs() < 1e-12);
    }
}
