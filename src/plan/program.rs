//! The shaders, by name: what each writes, and what it reads to find how much of a light arrives.

use serde::{Deserialize, Serialize};

/// The shader of a draw. All of them transform vertices in the same way, so that depths are bit-equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Program {
    /// Writes depth and stencil only: volumes, caps, planar shadows, shadow maps, receiver marks.
    Position,
    /// Writes the draw's flat colour ([`DrawConstants::flat`](super::DrawConstants::flat)).
    Flat,
    /// Writes the draw's label, whichever way the surface faces.
    FlatLabel,
    /// Adds the draw's count where the front of a triangle is seen, and subtracts it where its back is.
    Count,
    /// Writes the material's colour times the ambient light.
    Ambient {
        /// Discards fragments nearer than the near plane, where nothing else clips them.
        from_near: bool,
    },
    /// Adds the pass's light, as far as it arrives.
    Light(Visibility),
    /// Adds the pass's light whatever stands between: the share of diffuse light that belongs to the ambient light.
    AmbientDiffuse,
    /// Writes what the draw's layer of the light's texture lets through; the blend state multiplies the picture by it.
    Through,
    /// Writes a label: 3 where the triangle faces away from the light or is beyond its range, 1 where less than half of
    /// the light arrives, else the draw's `label`. Triangles run in reverse order, so that of
    /// surfaces at one depth the first drawn decides, as it did for the picture.
    Label(Visibility),
    /// Writes which share of the light arrives, 0 to 1: 0 where the triangle faces away from the light or is beyond its
    /// range. Triangles run as those of a label do.
    Arriving(Visibility),
    /// Another program's shader: vertices are clip-space positions, and go through unchanged. Its colours are not
    /// known.
    Recorded {
        /// Whether it may discard fragments.
        may_discard: ShaderEffect,
        /// Whether it may write a depth of its own.
        writes_depth: ShaderEffect,
    },
}

/// What a shader reads to find which share of a light arrives at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Visibility {
    /// Nothing: all that passes the depth and stencil tests is lit.
    Everywhere,
    /// The light's shadow map.
    Map,
    /// The light's labels, computed on the CPU.
    Labels,
    /// The light's count: zero is lit.
    Count,
    /// The receiver's texture: the draw's layer of the light's map.
    ReceiverTexture,
    /// The silhouettes of all casters, projected, except the one in the draw's own layer.
    Projected,
}

impl Visibility {
    /// All values, in order.
    pub const ALL: [Visibility; 6] = [
        Visibility::Everywhere,
        Visibility::Map,
        Visibility::Labels,
        Visibility::Count,
        Visibility::ReceiverTexture,
        Visibility::Projected,
    ];

    /// Returns whether the shader reads the light's map: depths, receivers' textures or silhouettes.
    pub fn reads_map(self) -> bool {
        matches!(self, Visibility::Map | Visibility::ReceiverTexture | Visibility::Projected)
    }
}

impl Program {
    /// Returns each program once, in every form of its visibility, for compiling all shaders. Of the recorded programs,
    /// which share a shader, only one.
    pub fn all() -> Vec<Program> {
        let unlit = [false, true].map(|from_near| Program::Ambient { from_near });
        let alone = [
            Program::Position,
            Program::Flat,
            Program::FlatLabel,
            Program::Count,
            Program::AmbientDiffuse,
            Program::Through,
        ];
        let lit = Visibility::ALL
            .into_iter()
            .flat_map(|how| [Program::Light(how), Program::Label(how), Program::Arriving(how)]);
        let recorded = Program::Recorded { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::No };
        alone.into_iter().chain(unlit).chain(lit).chain([recorded]).collect()
    }

    /// Returns the clip plane beyond which the shader discards a fragment of this depth; `None` where it keeps it.
    /// Where depth is clamped, only this clips at the near and far plane (`discard` in the shaders' files).
    pub fn discards(self, depth: f32) -> Option<ClipPlane> {
        match self {
            Program::Ambient { from_near: true } if depth < 0.0 => Some(ClipPlane::Near),
            Program::Light(_)
            | Program::AmbientDiffuse
            | Program::Label(_)
            | Program::Arriving(_)
            | Program::Through
                if depth > 1.0 =>
            {
                Some(ClipPlane::Far)
            }
            _ => None,
        }
    }

    /// Returns whether the shader multiplies colour by the surface's texture.
    pub fn shows_texture(self) -> bool {
        matches!(self, Program::Ambient { .. } | Program::Light(_) | Program::AmbientDiffuse)
    }

    /// Returns whether the shader reads nothing but positions and the draw's flat colour.
    pub fn is_flat(self) -> bool {
        matches!(self, Program::Position | Program::Flat)
    }

    /// Returns what the shader reads to find how much light arrives, for programs that light, label or show light
    /// passing through; `None` for the others.
    pub fn visibility(self) -> Option<Visibility> {
        match self {
            Program::Light(visibility) | Program::Label(visibility) | Program::Arriving(visibility) => Some(visibility),
            Program::AmbientDiffuse => Some(Visibility::Everywhere),
            Program::Through => Some(Visibility::Projected),
            Program::Position
            | Program::Flat
            | Program::FlatLabel
            | Program::Count
            | Program::Ambient { .. }
            | Program::Recorded { .. } => None,
        }
    }

    /// Returns whether triangles run in reverse, so that of surfaces at one depth the first drawn is the last to write.
    pub fn runs_in_reverse(self) -> bool {
        matches!(self, Program::Label(_) | Program::Arriving(_))
    }

    /// Returns whether it is another program's shader, whose vertices are in clip space already.
    pub fn is_recorded(self) -> bool {
        matches!(self, Program::Recorded { .. })
    }
}

named_enum! {
    /// Whether a shader has an effect, such as discarding fragments.
    pub enum ShaderEffect {
        /// It never has it.
        No = "no",
        /// It may have it, for some fragments.
        Yes = "yes",
        /// The shader could not be read.
        Unknown = "unknown",
    }
}

/// The plane that clips a triangle away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClipPlane {
    /// The near plane: the triangle is nearer.
    Near,
    /// The far plane: the triangle is beyond.
    Far,
}
