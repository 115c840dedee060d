//! A scene in code, piece by piece. Parts that are not given are placed as for a scene file: without a camera all
//! objects are in view from the front and a little above, and without lights a lamp stands above and in front.

use super::camera::placement::SceneBounds;
use super::names::ObjectNames;
use super::{Camera, Light, Object, Scene};
use glam::DVec3;

/// Ambient light unless set: shadows are dark and not black.
const AMBIENT: [f32; 3] = [0.15; 3];

/// Builds a [`Scene`].
///
/// ```
/// use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
///
/// let scene = SceneBuilder::new("a box over a floor")
///     .object(Object::of("floor", shapes::quad([6.0, 6.0])?))
///     .object(Object::of("box", shapes::cuboid([0.8, 0.6, 0.8])?).rotated([0.0, 30.0, 0.0]).at([0.0, 0.8, 0.0]))
///     .light(Light::point([1.0, 4.0, 1.5]))
///     .seen_from([1.5, 3.0, 5.0], [0.0, 0.3, 0.0])
///     .build();
/// assert_eq!((scene.objects.len(), scene.lights.len()), (2, 1));
///
/// // Without a camera and lights.
/// let alone = SceneBuilder::new("alone").object(Object::of("ball", shapes::sphere(2.0, 24, 12)?)).build();
/// assert!(alone.camera.eye.length() > 2.0 && alone.lights[0].position.y > 2.0);
/// # Ok::<(), stencilscope::scene::MeshError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SceneBuilder {
    name: String,
    ambient: [f32; 3],
    camera: Option<Camera>,
    lights: Option<Vec<Light>>,
    objects: Vec<Object>,
    names: ObjectNames,
}

impl SceneBuilder {
    /// Returns a builder of a scene of that name, without objects, with the default ambient light. Unless set, camera
    /// and light are placed to fit the objects.
    pub fn new(name: impl Into<String>) -> SceneBuilder {
        SceneBuilder {
            name: name.into(),
            ambient: AMBIENT,
            camera: None,
            lights: None,
            objects: Vec::new(),
            names: ObjectNames::default(),
        }
    }

    /// Sets the linear RGB light that reaches every surface.
    #[must_use]
    pub fn ambient(self, ambient: [f32; 3]) -> SceneBuilder {
        SceneBuilder { ambient, ..self }
    }

    /// Sets the camera.
    #[must_use]
    pub fn camera(self, camera: Camera) -> SceneBuilder {
        SceneBuilder { camera: Some(camera), ..self }
    }

    /// Sets a camera at `eye` that looks at `target` (world space, metres), with the defaults of [`Camera::looking`].
    #[must_use]
    pub fn seen_from(self, eye: impl Into<DVec3>, target: impl Into<DVec3>) -> SceneBuilder {
        self.camera(Camera::looking(eye, target))
    }

    /// Adds a light.
    #[must_use]
    pub fn light(self, light: Light) -> SceneBuilder {
        self.lights([light])
    }

    /// Adds lights; with an empty iterator the scene is dark, and no lamp is placed.
    #[must_use]
    pub fn lights(mut self, lights: impl IntoIterator<Item = Light>) -> SceneBuilder {
        self.lights.get_or_insert_default().extend(lights);
        self
    }

    /// Adds an object at the end. Where another has its name already, it gets that name with a number.
    #[must_use]
    pub fn object(mut self, mut object: Object) -> SceneBuilder {
        object.name = self.names.take_like(&object.name);
        self.objects.push(object);
        self
    }

    /// Adds objects.
    #[must_use]
    pub fn objects(self, objects: impl IntoIterator<Item = Object>) -> SceneBuilder {
        objects.into_iter().fold(self, SceneBuilder::object)
    }

    /// Returns the scene, at time 0. Without a camera or lights of its own, it gets a camera that sees all objects, and
    /// one point light above in front.
    pub fn build(self) -> Scene {
        let SceneBuilder { name, ambient, camera, lights, objects, .. } = self;
        let points: Vec<DVec3> = match (&camera, &lights) {
            (Some(_), Some(_)) => Vec::new(),
            _ => objects.iter().flat_map(Object::world_positions).collect(),
        };
        let surroundings = SceneBounds::of(&points).unwrap_or_default();
        Scene {
            name,
            ambient,
            camera: camera.unwrap_or_else(|| surroundings.camera(&points)),
            lights: lights.unwrap_or_else(|| vec![surroundings.light()]),
            objects,
            technique: None,
            not_taken: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes;
    use super::*;

    #[test]
    fn names_are_distinguished_and_darkness_is_kept() {
        let ball = || Object::of("ball", shapes::sphere(1.0, 8, 4).expect("a ball"));
        let scene = SceneBuilder::new("three").objects([ball(), ball(), ball()]).lights([]).build();
        let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
        assert_eq!((names, scene.lights.len()), (vec!["ball", "ball 2", "ball 3"], 0));
        assert_eq!(scene.camera.check(), Ok(()));
    }

    #[test]
    fn what_can_not_be_measured_is_looked_at_all_the_same() {
        let scene = SceneBuilder::new("nothing").build();
        assert_eq!((scene.camera.check(), scene.lights[0].check()), (Ok(()), Ok(())));
    }
}
