//! Scenes that code builds, each small and for one lesson.

mod gate;
mod glass;
mod inside;
mod panels;
mod rings;
mod spheres;
mod steps;
mod table;
mod teapot_like;
mod tetrahedron;
mod tiger_cage;
mod tori;
mod two_lights;

use super::{MeshError, Scene, SceneError};

/// A scene that code builds: its name, its lesson, and how it is built.
#[derive(Debug, Clone, Copy)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it shows, in one line.
    pub lesson: &'static str,
    build: fn() -> Result<Scene, MeshError>,
}

/// All built-in scenes; the first is the default.
pub const ALL: &[Builtin] = &[
    Builtin {
        name: "tori",
        lesson: "four tori orbit a point light in a room: shadow volumes, and a light that needs a cube shadow map",
        build: tori::build,
    },
    Builtin {
        name: "rings",
        lesson: "three tori and a plane: planar shadows, and the anti-shadow and false shadow that clipping prevents",
        build: rings::build,
    },
    Builtin {
        name: "panels",
        lesson: "four slanted panels in a box room: nine parallelograms, each a receiver with a texture of its own",
        build: panels::build,
    },
    Builtin {
        name: "tetrahedron",
        lesson: "a turning regular tetrahedron in a shaft: the smallest closed caster, and every side of its shadow volume",
        build: tetrahedron::build,
    },
    Builtin {
        name: "table",
        lesson: "a torus and four spheres over a slab: shadow maps with their acne, peter-panning and aliasing",
        build: table::build,
    },
    Builtin {
        name: "glass",
        lesson: "coloured panes and a solid ball: projective shadow textures, which carry colour and compare no depth",
        build: glass::build,
    },
    Builtin {
        name: "steps",
        lesson: "stairs, balls and a wall that shadow each other: receivers that are not flat, where planar is not enough",
        build: steps::build,
    },
    Builtin {
        name: "inside",
        lesson: "the eye in a pergola's shadow, whose volumes the near plane cuts: z-pass fails, z-fail holds",
        build: inside::build,
    },
    Builtin {
        name: "teapot-like",
        lesson: "an open pot whose spout and handle run through its wall: casters that are not closed, and multiplicity",
        build: teapot_like::build,
    },
    Builtin {
        name: "gate",
        lesson: "300 boxes in each other: 300 volumes deep, so that a count of 256 reads 0 and light shines where it can't",
        build: gate::build,
    },
    Builtin {
        name: "two-lights",
        lesson: "a lamp and the sun, with shadows that cross: the steps repeat for each light",
        build: two_lights::build,
    },
    Builtin {
        name: "spheres",
        lesson: "a ball in 200, 450 and 16 200 triangles on a checkerboard: flat, Gouraud and Phong shading under a lamp that glows",
        build: spheres::build,
    },
    Builtin {
        name: "tiger-cage",
        lesson: "a prison block with barred cells under a swinging lamp: an interior to walk through with every technique",
        build: tiger_cage::build,
    },
];

impl Builtin {
    /// Returns the built-in scene of exactly that name; `None` where there is none.
    pub fn named(name: &str) -> Option<&'static Builtin> {
        ALL.iter().find(|builtin| builtin.name == name)
    }

    /// Builds the scene.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        (self.build)().map_err(|source| SceneError::Mesh { name: self.name.to_owned(), source })
    }
}
