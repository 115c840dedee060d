//! How a surface reflects light.

use serde::{Deserialize, Serialize};

/// With which normals, and where, lighting is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum Shading {
    /// One normal for each triangle.
    #[default]
    Flat,
    /// Lit at the vertices with averaged normals, interpolated across the triangle.
    Gouraud,
    /// Normals interpolated, lit at every pixel.
    Phong,
}

impl Shading {
    /// All three kinds of shading, in order.
    pub const ALL: [Shading; 3] = [Shading::Flat, Shading::Gouraud, Shading::Phong];

    /// Returns the shading's name in scene files and settings.
    pub const fn name(self) -> &'static str {
        match self {
            Shading::Flat => "flat",
            Shading::Gouraud => "gouraud",
            Shading::Phong => "phong",
        }
    }
}

/// Colour and gloss of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Linear RGB reflectance, each in [0, 1].
    pub color: [f32; 3],
    /// Strength of the highlight, in [0, 1].
    pub specular: f32,
    /// Blinn-Phong exponent, > 0.
    pub shininess: f32,
    /// Where lighting is computed.
    pub shading: Shading,
    /// 1 is opaque. Only projective textures use it: labels count translucent casters as opaque.
    pub opacity: f32,
    /// Linear RGB that it emits, whatever light falls on it; it lights nothing else.
    #[serde(default)]
    pub emission: [f32; 3],
    /// The side of the squares of a checkerboard, along world X and Z in world units: every other one has a third of
    /// the colour. 0 for none.
    #[serde(default)]
    pub checks: f32,
}

impl Material {
    /// Returns the default material, dull and flat-shaded, in linear RGB `color`.
    pub fn matte(color: [f32; 3]) -> Material {
        Material { color, ..Material::default() }
    }

    /// Returns a smooth surface with a highlight.
    pub fn glossy(color: [f32; 3]) -> Material {
        Material { color, specular: 0.25, shininess: 40.0, shading: Shading::Phong, ..Material::default() }
    }
}

impl Default for Material {
    fn default() -> Material {
        Material {
            color: [0.75; 3],
            specular: 0.0,
            shininess: 16.0,
            shading: Shading::Flat,
            opacity: 1.0,
            emission: [0.0; 3],
            checks: 0.0,
        }
    }
}
