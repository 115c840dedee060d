//! A light that moves once round a scene: about the vertical axis through the middle of the casters.

use super::FilmError;
use crate::math::angle;
use crate::numbers;
use crate::scene::{Object, Scene};
use glam::DVec3;
use std::f64::consts::TAU;

/// A light nearer to the axis than this share of its distance does not move visibly.
const ON_AXIS: f64 = 1e-6;

/// A light of a scene that goes once round the scene's vertical axis, in steps of the same angle.
#[derive(Debug, Clone, PartialEq)]
pub struct LightRound {
    scene: Scene,
    light: usize,
    middle: DVec3,
    places: u32,
}

impl LightRound {
    /// Prepares the light of index `light` to go round the scene's middle in `places` steps of the same angle; the
    /// first is where the light is, and a directional light's direction turns instead. An error where there is no such
    /// light, or it is straight above or below the middle.
    pub fn new(scene: Scene, light: usize, places: u32) -> Result<LightRound, FilmError> {
        let lights = scene.lights.len();
        let Some(rotated) = scene.lights.get(light) else { return Err(FilmError::NoLight { light, lights }) };
        let middle = middle(&scene.objects);
        // For a directional light only the direction counts.
        let way = rotated.position.truncate() - if rotated.is_directional() { DVec3::ZERO } else { middle };
        if way.with_y(0.0).length() <= ON_AXIS * way.length() {
            return Err(FilmError::OnAxis { light: numbers::light(light) });
        }
        Ok(LightRound { scene, light, middle, places })
    }

    /// Returns the number of positions of the light, one for each picture of the film.
    pub fn places(&self) -> u32 {
        self.places
    }

    /// Returns in a few words where the light is at a place: `light 1, 45° round`.
    pub fn words(&self, place: u32) -> String {
        let degrees = 360.0 * f64::from(place) / f64::from(self.places.max(1));
        format!("{}, {degrees:.0}° round", numbers::light(self.light))
    }

    /// Returns the scene with the light rotated by `place` of the `places` steps about the vertical axis,
    /// counter-clockwise seen from above; height and distance stay. Position 0 is the scene unchanged.
    pub fn scene(&self, place: u32) -> Scene {
        let mut scene = self.scene.clone();
        let Some(light) = scene.lights.get_mut(self.light).filter(|_| place > 0) else { return scene };
        let turn = angle::rotation(DVec3::Y, TAU * f64::from(place) / f64::from(self.places.max(1)));
        let middle = if light.is_directional() { DVec3::ZERO } else { self.middle };
        let rotated = middle + turn * (light.position.truncate() - middle);
        light.position = rotated.extend(light.position.w);
        scene
    }
}

/// Returns the middle of the world box around the casters that are not flat ground, or around all objects where there
/// are none; the origin for a scene without vertices.
fn middle(objects: &[Object]) -> DVec3 {
    let boxes: Vec<(&Object, DVec3, DVec3)> = objects
        .iter()
        .filter_map(|object| {
            let positions = object.world_positions();
            let low = positions.iter().copied().reduce(DVec3::min)?;
            Some((object, low, positions.iter().copied().fold(low, DVec3::max)))
        })
        .collect();
    let around = |is_meant: &dyn Fn(&Object, DVec3) -> bool| {
        let meant = boxes.iter().filter(|(object, low, high)| is_meant(object, *high - *low));
        meant.map(|(_, low, high)| (*low, *high)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    };
    let stands = |object: &Object, extents: DVec3| object.casts && extents.y > ON_AXIS * extents.max_element();
    around(&stands).or_else(|| around(&|_, _| true)).map_or(DVec3::ZERO, |(low, high)| low / 2.0 + high / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, SceneBuilder, shapes};

    /// A floor far to one side, and a box whose middle is above (1, 0, 2).
    fn scene(lights: impl IntoIterator<Item = Light>) -> Scene {
        SceneBuilder::new("a box")
            .object(Object::of("floor", shapes::quad([40.0; 2]).expect("a quad")).at([15.0, 0.0, 0.0]))
            .object(Object::of("box", shapes::cuboid([1.0; 3]).expect("a box")).at([1.0, 3.0, 2.0]))
            .lights(lights)
            .seen_from([0.0, 5.0, 9.0], [0.0; 3])
            .build()
    }

    #[test]
    fn a_point_light_goes_once_round_the_box_level_and_as_far_from_it() {
        let scene = scene([Light::point([4.0, 5.0, 2.0])]);
        let round = LightRound::new(scene.clone(), 0, 4).expect("a way round");
        let places: Vec<DVec3> = (0..4).map(|place| round.scene(place).lights[0].position.truncate()).collect();
        let expected = [[4.0, 5.0, 2.0], [1.0, 5.0, -1.0], [-2.0, 5.0, 2.0], [1.0, 5.0, 5.0]].map(DVec3::from_array);
        for (place, expected) in places.iter().zip(expected) {
            assert!(place.distance(expected) < 1e-12, "{place} is not {expected}");
        }
        assert_eq!(round.scene(0), scene, "to the bit");
    }

    #[test]
    fn a_direction_turns_and_other_lights_stay() {
        let scene = scene([Light::point([4.0, 5.0, 2.0]), Light::directional([1.0, 2.0, 0.0])]);
        let round = LightRound::new(scene.clone(), 1, 4).expect("a way round");
        let rotated = round.scene(1);
        assert_eq!(rotated.lights[0], scene.lights[0]);
        let away = rotated.lights[1].position - DVec3::new(0.0, 2.0, -1.0).extend(0.0);
        assert!(away.length() < 1e-12 && rotated.lights[1].is_directional(), "{:?}", rotated.lights[1]);
    }

    #[test]
    fn a_light_on_the_axis_and_one_that_is_not_there_are_refused_with_the_fix() {
        let refused =
            |light: Light, index: usize| LightRound::new(scene([light]), index, 4).expect_err("refused").to_string();
        let above = refused(Light::point([1.0, 9.0, 2.0]), 0);
        assert!(above.contains("light 1 is above the middle") && above.contains("move it"), "{above}");
        assert!(refused(Light::directional([0.0, 1.0, 0.0]), 0).contains("move it"));
        let missing = refused(Light::point([4.0, 5.0, 2.0]), 1);
        assert!(missing.contains("no light 2") && missing.contains("choose light 1"), "{missing}");
    }
}
