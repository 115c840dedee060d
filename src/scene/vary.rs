//! Scenes with more or fewer lights, casters and triangles, for measuring what that costs.

use super::{Mesh, MeshError, Object, Scene, SceneBounds};
use crate::math::angle;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Part of a full rotation from one copy to the next, so that none coincide: the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_8;
/// Distance of the first copy of a caster from the centre, in extents of all casters; the fourth is twice as far.
const SPREAD: f64 = 0.35;

/// Why a scene can't have another number of lights, casters or triangles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VaryError {
    /// It has none of the things that should be more, named in words.
    #[error("it has no {0}")]
    None(&'static str),
    /// Meshes can't be made coarser.
    #[error("its casters have {has} triangles already: begin there, or choose a scene of fewer")]
    TooFine {
        /// Number of triangles that it has.
        has: usize,
    },
    /// The meshes would have too many vertices.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl Scene {
    fn casters(&self) -> impl Iterator<Item = &Object> {
        self.objects.iter().filter(|object| object.casts)
    }

    fn middle_of_casters(&self) -> SceneBounds {
        let points: Vec<DVec3> = self.casters().flat_map(Object::world_positions).collect();
        SceneBounds::of(&points).unwrap_or_default()
    }

    /// Returns the scene with exactly `count` lights: the first ones; further ones are copies of these in turn, rotated
    /// about the vertical axis through the casters' middle.
    pub fn with_lights(&self, count: usize) -> Result<Scene, VaryError> {
        if self.lights.is_empty() {
            return Err(VaryError::None("light"));
        }
        let middle = self.middle_of_casters().middle();
        let light = |index: usize| {
            let mut light = self.lights[index % self.lights.len()].clone();
            let turns = (index / self.lights.len()) as f64 * GOLDEN;
            let around = if light.is_directional() { DVec3::ZERO } else { middle };
            let rotated = angle::rotation(DVec3::Y, turns * TAU) * (light.position.truncate() - around) + around;
            if turns > 0.0 {
                light.position = rotated.extend(light.position.w);
            }
            light
        };
        Ok(Scene { lights: (0..count).map(light).collect(), ..self.clone() })
    }

    /// Returns the scene with exactly `count` casters: the first ones; further ones are copies of these in turn, with a
    /// number in their names, on a spiral around them. Objects that cast no shadow stay.
    pub fn with_casters(&self, count: usize) -> Result<Scene, VaryError> {
        let casters: Vec<&Object> = self.casters().collect();
        if casters.is_empty() {
            return Err(VaryError::None("caster"));
        }
        let spread = self.middle_of_casters().extent() * SPREAD;
        let mut left = count;
        let mut objects = self.objects.clone();
        objects.retain(|object| {
            let stays = !object.casts || left > 0;
            left = left.saturating_sub(usize::from(object.casts && stays));
            stays
        });
        let copies = (0..count.saturating_sub(casters.len())).map(|copy| {
            let mut object = casters[copy % casters.len()].clone();
            let ([sine, cosine], away) = (sine_cosine(copy as f64 * GOLDEN), spread * ((copy + 1) as f64).sqrt());
            object.pose.translate += DVec3::new(cosine, 0.0, sine) * away;
            object.name = format!("{} {}", object.name, copy / casters.len() + 2);
            object
        });
        objects.extend(copies);
        Ok(Scene { objects, ..self.clone() })
    }

    /// Returns the scene with casters of at least `count` triangles together, of the same shapes, each mesh refined in
    /// proportion. An error where they have more already.
    pub fn with_triangles(&self, count: usize) -> Result<Scene, VaryError> {
        let has: usize = self.casters().map(|object| object.mesh.triangles().len()).sum();
        match has {
            0 => return Err(VaryError::None("caster")),
            has if has > count => return Err(VaryError::TooFine { has }),
            _ => {}
        }
        let mut finer: HashMap<*const Mesh, Arc<Mesh>> = HashMap::new();
        let mut scene = self.clone();
        for object in scene.objects.iter_mut().filter(|object| object.casts) {
            let known = finer.get(&Arc::as_ptr(&object.mesh)).cloned();
            let mesh = match known {
                Some(mesh) => mesh,
                None => {
                    let share = (object.mesh.triangles().len() as u128 * count as u128).div_ceil(has as u128);
                    let mesh = Arc::new(object.mesh.refined(usize::try_from(share).unwrap_or(usize::MAX))?);
                    finer.insert(Arc::as_ptr(&object.mesh), mesh.clone());
                    mesh
                }
            };
            object.mesh = mesh;
        }
        Ok(scene)
    }
}

fn sine_cosine(turns: f64) -> [f64; 2] {
    let (sine, cosine) = angle::sin_cos(turns * TAU);
    [sine, cosine]
}

#[cfg(test)]
mod tests {
    use super::super::builtin::Builtin;
    use super::*;

    fn scene(name: &str) -> Scene {
        Builtin::named(name).expect("a scene").scene().expect("a scene")
    }

    #[test]
    fn lights_are_the_scenes_own_first_and_then_turned() {
        let table = scene("two-lights");
        let five = table.with_lights(5).expect("lights");
        assert_eq!(five.lights[..2], table.lights[..]);
        for (index, light) in five.lights.iter().enumerate() {
            let own = &table.lights[index % 2];
            assert_eq!((light.position.w, light.color), (own.position.w, own.color));
            assert!((light.position.y - own.position.y).abs() < 1e-9);
            assert_eq!(five.lights.iter().filter(|other| other.position == light.position).count(), 1);
        }
        assert_eq!(table.with_lights(1).expect("a light").lights, table.lights[..1]);
        let dark = Scene { lights: Vec::new(), ..table };
        assert_eq!(dark.with_lights(1).map(drop), Err(VaryError::None("light")));
    }

    #[test]
    fn casters_are_the_scenes_own_first_and_then_copies() {
        let table = scene("table");
        let own = table.casters().count();
        for count in [1, own, own + 3, 4 * own] {
            let varied = table.with_casters(count).expect("casters");
            assert_eq!(varied.casters().count(), count);
            let others = |scene: &Scene| scene.objects.iter().filter(|object| !object.casts).count();
            assert_eq!(others(&varied), others(&table));
            let mut names: Vec<&String> = varied.objects.iter().map(|object| &object.name).collect();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), varied.objects.len(), "names are unique");
        }
    }

    #[test]
    fn triangles_are_at_least_as_many_as_asked_for() {
        let scene = scene("tetrahedron");
        let count = |scene: &Scene| scene.casters().map(|object| object.mesh.triangles().len()).sum::<usize>();
        let has = count(&scene);
        let finer = scene.with_triangles(1000).expect("triangles");
        assert!((1000..1010).contains(&count(&finer)), "{}", count(&finer));
        assert_eq!(scene.with_triangles(has - 1).map(drop), Err(VaryError::TooFine { has }));
    }
}
