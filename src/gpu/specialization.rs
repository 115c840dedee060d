//! What a draw's shader does not have to do: its pipeline is made without (specialization constants, `override` in
//! WGSL).
//!
//! A software driver runs both sides of a condition for every pixel, and a possible `discard` prevents it from testing
//! depth and stencil before it shades. So what a material, a light or a depth mapping never asks for is not in the
//! pipeline.

use crate::plan::{Draw, Pass, PlanLight, Program};
use crate::scene::Shading;

/// The pipeline constants of a shader: which optional effects the draws of a pipeline have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(super) struct Specialization {
    /// Whether the material has a pattern of checks.
    has_checks: bool,
    /// Whether the material has a specular highlight.
    has_gloss: bool,
    /// Whether light is computed at the vertices (Gouraud shading) and not at each pixel.
    is_gouraud: bool,
    /// Whether the light has a range at which it fades to nothing.
    fades: bool,
    /// Whether diffuse light wraps round past the terminator.
    wraps: bool,
    /// Whether depth is clamped, so that fragments beyond the far plane are drawn, too.
    is_depth_clamped: bool,
    /// Bits of the stored depths of the near and the far end of clip space, where those are not 0 and 1 and depth is clamped:
    /// beyond them lies what clamping lets through.
    depth_range: Option<[u32; 2]>,
}

impl Specialization {
    /// Returns the specialization of a draw in its pass, under that pass's light: only what the draw's program can use is
    /// set, the rest is the default.
    pub fn of(draw: &Draw, pass: &Pass, light: Option<&PlanLight>, wraps_diffuse: bool) -> Specialization {
        let material = &draw.constants.material;
        let has_checks = material.checks != 0.0;
        let viewport = pass.own_viewport().filter(|_| draw.raster.unclipped_depth);
        let depth_range = viewport.map(|viewport| viewport.depth.map(f32::to_bits));
        let of_surface = Specialization {
            fades: light.is_some_and(|light| light.range.is_some() && light.relative_position[3] != 0.0),
            is_depth_clamped: draw.raster.unclipped_depth,
            depth_range,
            ..Specialization::default()
        };
        match draw.program {
            Program::Light(_) | Program::AmbientDiffuse => Specialization {
                has_checks,
                has_gloss: material.specular != 0.0,
                is_gouraud: material.shading == Shading::Gouraud,
                wraps: wraps_diffuse,
                ..of_surface
            },
            Program::Label(_) | Program::Arriving(_) => of_surface,
            Program::Through => Specialization { wraps: wraps_diffuse, fades: false, ..of_surface },
            Program::Ambient { .. } => Specialization { has_checks, depth_range, ..Specialization::default() },
            Program::Position | Program::Flat | Program::FlatLabel | Program::Count | Program::Recorded { .. } => {
                Specialization::default()
            }
        }
    }

    /// Returns the pipeline-overridable constants that a program's shader has, by their names in WGSL, each 0 or 1, and an
    /// end of the depth range where it is not the usual one; empty for a program that has none.
    pub fn constants(self, program: Program) -> Vec<(&'static str, f64)> {
        let Specialization { has_checks, has_gloss, is_gouraud, fades, wraps, is_depth_clamped, depth_range } = self;
        let of_surface = [
            ("has_checks", has_checks),
            ("has_gloss", has_gloss),
            ("is_gouraud", is_gouraud),
            ("fades", fades),
            ("wraps", wraps),
            ("is_depth_clamped", is_depth_clamped),
        ];
        let of_ambient = |is_cut| [("has_checks", has_checks), ("from_near", is_cut)];
        let constants = match program {
            Program::Light(_)
            | Program::AmbientDiffuse
            | Program::Label(_)
            | Program::Arriving(_)
            | Program::Through => &of_surface[..],
            Program::Ambient { from_near } => &of_ambient(from_near)[..],
            Program::Position | Program::Flat | Program::FlatLabel | Program::Count | Program::Recorded { .. } => &[],
        };
        let range = depth_range.zip(match program {
            Program::Ambient { .. } => Some(("nearest_depth", 0)),
            _ if constants.is_empty() => None,
            _ => Some(("farthest_depth", 1)),
        });
        let range = range.map(|(depths, (name, end))| (name, f64::from(f32::from_bits(depths[end]))));
        constants.iter().map(|(name, value)| (*name, f64::from(u8::from(*value)))).chain(range).collect()
    }
}
