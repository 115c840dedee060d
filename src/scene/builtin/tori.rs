//! `tori`: four tori orbit a point light inside a room; each shadows the others and the walls.
//!
//! Two tori circle near the light and two further out, so that the inner ones' shadows cross the
//! outer ones. The eye is in a corner of the room, where at the start no shadow reaches.

use crate::math::angle;
use crate::scene::{
    Camera, Light, Material, Mesh, MeshError, Motion, Object, Orbit, Scene, SceneBuilder, Shading, shapes,
};
use glam::DVec3;
use std::sync::Arc;

const ROOM: [f64; 3] = [10.0, 6.0, 10.0];
const LIGHT: DVec3 = DVec3::new(0.0, 0.4, 0.0);

const PLASTER: [f32; 3] = [0.30, 0.33, 0.40];

/// One torus on its orbit around the light.
struct Orbiting {
    name: &'static str,
    color: [f32; 3],
    /// Distance from the light's axis, and where on the circle it starts.
    radius: f64,
    azimuth_degrees: f64,
    /// Height above the light.
    height: f64,
    rotate_degrees: DVec3,
    spin_degrees_per_second: DVec3,
    degrees_per_second: f64,
}

const TORI: [Orbiting; 4] = [
    Orbiting {
        name: "blue torus",
        color: [0.09, 0.40, 0.78],
        radius: 1.7,
        azimuth_degrees: 203.0,
        height: 0.1,
        rotate_degrees: DVec3::new(62.0, 20.0, 0.0),
        spin_degrees_per_second: DVec3::new(0.0, 25.0, 0.0),
        degrees_per_second: 24.0,
    },
    Orbiting {
        name: "orange torus",
        color: [0.78, 0.35, 0.02],
        radius: 1.9,
        azimuth_degrees: 278.0,
        height: -0.1,
        rotate_degrees: DVec3::new(30.0, 0.0, 55.0),
        spin_degrees_per_second: DVec3::new(0.0, -20.0, 0.0),
        degrees_per_second: -11.0,
    },
    Orbiting {
        name: "green torus",
        color: [0.02, 0.36, 0.20],
        radius: 3.1,
        azimuth_degrees: 226.0,
        height: -0.25,
        rotate_degrees: DVec3::new(70.0, 40.0, 0.0),
        spin_degrees_per_second: DVec3::new(0.0, 15.0, 0.0),
        degrees_per_second: -11.0,
    },
    Orbiting {
        name: "red torus",
        color: [0.66, 0.10, 0.03],
        radius: 1.45,
        azimuth_degrees: 128.0,
        height: -1.15,
        rotate_degrees: DVec3::new(18.0, 0.0, 25.0),
        spin_degrees_per_second: DVec3::new(0.0, 30.0, 0.0),
        degrees_per_second: 24.0,
    },
];

/// Builds the scene `tori`: four tori that orbit a point light inside a room whose centre is the origin; the room
/// itself casts nothing.
pub fn build() -> Result<Scene, MeshError> {
    let torus = Arc::new(shapes::torus(0.66, 0.22, 64, 28)?);
    let plaster = Material { color: PLASTER, ..Material::default() };
    let room = Object::new("room", Arc::new(shapes::room(ROOM)?), plaster);
    // Nothing is behind its walls: as a caster it could only shadow itself.
    let mut objects = vec![Object { casts: false, ..room }];
    objects.extend(TORI.iter().map(|orbiting| orbiting.object(&torus)));
    Ok(SceneBuilder::new("tori")
        .ambient([0.10, 0.10, 0.115])
        .camera(Camera {
            eye: DVec3::new(4.0, 1.9, 4.4),
            target: DVec3::new(-0.3, -0.45, -0.3),
            up: DVec3::Y,
            projection: crate::scene::Projection::Perspective,
            fov_y_degrees: 52.0,
            near: 0.05,
            far: None,
            viewport: None,
        })
        .light(Light { color: [1.0, 0.94, 0.84], intensity: 1.15, ..Light::point(LIGHT) })
        .objects(objects)
        .build())
}

impl Orbiting {
    fn object(&self, mesh: &Arc<Mesh>) -> Object {
        let (sin, cos) = angle::sin_cos(self.azimuth_degrees.to_radians());
        let start = LIGHT + DVec3::new(self.radius * sin, self.height, self.radius * cos);
        let material = Material {
            color: self.color,
            specular: 0.3,
            shininess: 32.0,
            shading: Shading::Phong,
            ..Material::default()
        };
        let mut object = Object::new(self.name, mesh.clone(), material).at(start);
        object.pose.rotate_degrees = self.rotate_degrees;
        let orbit = Orbit { center: LIGHT, axis: DVec3::Y, degrees_per_second: self.degrees_per_second };
        object.motion =
            Motion { spin_degrees_per_second: self.spin_degrees_per_second, orbit: Some(orbit), ..Motion::default() };
        object
    }
}
