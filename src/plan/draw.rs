//! A draw call: the geometry it draws, its shader, its raster state and its constants.

use super::ids::{LightId, MeshId, TextureId};
use super::program::{Program, ShaderEffect};
use super::{DrawMesh, RasterState};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// One draw call: mesh, shader, raster state and constants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Draw {
    /// A short name for people: `sides of bunny`.
    pub name: String,
    /// Name of the object that it shows, or whose shadow it draws.
    pub caster: Option<String>,
    /// Which part of the object or of its shadow it draws.
    pub part: DrawPart,
    /// The shader.
    pub program: Program,
    /// Depth, stencil, culling and colour state.
    pub raster: RasterState,
    /// Vertices and indices.
    pub mesh: MeshId,
    /// Range of triangles in the mesh's index list.
    pub triangles: Range<u32>,
    /// Added to every index: a dark cap is its light cap drawn with the far vertices.
    pub base_vertex: u32,
    /// The pieces of these triangles that the rasteriser is given in place of them, where it would not draw them exactly
    /// ([`FramePlan::clipped`](super::FramePlan::clipped)).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pieces: Option<DrawPieces>,
    /// For a part of a shadow volume: true where its triangles' fronts face into the volume, and their backs outwards.
    /// Caps are runs of the caster's own triangles, so either is possible.
    pub faces_inwards: bool,
    /// Values for the shader.
    pub constants: DrawConstants,
    /// For a draw of another program's frame, the lights whose shadow maps its shader samples, as far as that was recorded;
    /// of our own shaders [`Program::visibility`] says it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub samples_maps_of: Vec<LightId>,
}

/// Pieces of a draw's triangles, in a mesh whose [`DrawMesh::pieces_of`] says which triangle each is of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DrawPieces {
    /// Vertices and indices.
    pub mesh: MeshId,
    /// Range of pieces in the mesh's index list; empty where the whole draw lies outside of the picture.
    pub triangles: Range<u32>,
    /// Whether some of the triangles are cut at the nearest or the farthest depth.
    pub is_cut_in_depth: bool,
}

/// Triangles of a mesh that a draw gives to the rasteriser: its own, or pieces of them.
#[derive(Debug, Clone, PartialEq)]
pub struct RasterisedTriangles {
    /// Vertices and indices.
    pub mesh: MeshId,
    /// Range of triangles in the mesh's index list.
    pub triangles: Range<u32>,
    /// Added to every index.
    pub base_vertex: u32,
}

impl Draw {
    /// Returns the triangles that the rasteriser is given: the draw's pieces where it has some, else its own.
    pub fn rasterised(&self) -> RasterisedTriangles {
        match &self.pieces {
            Some(DrawPieces { mesh, triangles, .. }) => {
                RasterisedTriangles { mesh: *mesh, triangles: triangles.clone(), base_vertex: 0 }
            }
            None => self.own_triangles(),
        }
    }

    /// Returns the draw's own triangles, whether or not the rasteriser is given pieces of them.
    pub fn own_triangles(&self) -> RasterisedTriangles {
        RasterisedTriangles { mesh: self.mesh, triangles: self.triangles.clone(), base_vertex: self.base_vertex }
    }

    /// Returns which part of the caster or its volume a triangle is, by its index in the draw's mesh, `mesh`: the draw's
    /// part; for `Caps` that a vertex shader extrudes, dark cap where the first corner is carried, else light cap.
    pub fn part_of(&self, mesh: &DrawMesh, triangle: u32) -> DrawPart {
        let carried = || {
            let corners = mesh.corners(triangle, self.base_vertex)?;
            mesh.extruded.as_ref().map(|extruded| extruded.carried(corners))
        };
        if self.part != DrawPart::Caps {
            return self.part;
        }
        match carried() {
            Some([true, ..]) => DrawPart::DarkCap,
            Some([false, ..]) => DrawPart::LightCap,
            None => self.part,
        }
    }

    /// Returns a draw of a mesh's first `triangles` triangles by position only, as into the stencil: without caster and
    /// base vertex, fronts facing outwards.
    pub fn of_positions(
        name: impl Into<String>,
        part: DrawPart,
        mesh: MeshId,
        triangles: u32,
        raster: RasterState,
    ) -> Draw {
        Draw {
            name: name.into(),
            caster: None,
            part,
            program: Program::Position,
            raster,
            mesh,
            triangles: 0..triangles,
            base_vertex: 0,
            pieces: None,
            faces_inwards: false,
            constants: DrawConstants::default(),
            samples_maps_of: Vec::new(),
        }
    }

    /// Returns this draw of another mesh's first `triangles` triangles, under another name and raster state.
    #[must_use]
    pub fn of_other_mesh(&self, name: impl Into<String>, mesh: MeshId, triangles: u32, raster: RasterState) -> Draw {
        let Draw { caster, part, program, faces_inwards, constants, samples_maps_of, .. } = self.clone();
        let like = Draw::of_positions(name, part, mesh, triangles, raster);
        Draw { caster, program, faces_inwards, constants, samples_maps_of, ..like }
    }

    /// Returns whether the draw's shader may discard fragments without a record of which. `mesh` is the draw's mesh.
    pub fn discards_unknown(&self, mesh: &DrawMesh) -> bool {
        matches!(self.program, Program::Recorded { may_discard: ShaderEffect::Yes | ShaderEffect::Unknown, .. })
            && mesh.retained.is_none()
    }
}

named_enum! {
    /// Which part of a frame's geometry a draw shows: a surface, or a part of a shadow.
    pub enum DrawPart {
        /// Visible surface.
        Surface = "surface",
        /// Side of a shadow volume.
        Side = "side",
        /// The casting triangles themselves.
        LightCap = "light-cap",
        /// The casting triangles carried to infinity.
        DarkCap = "dark-cap",
        /// Light cap and dark cap in one: the vertex shader decides which triangle is which.
        Caps = "caps",
        /// A plane that planar shadows fall on.
        Receiver = "receiver",
        /// A caster flattened onto a receiver.
        PlanarShadow = "planar-shadow",
        /// A caster drawn into a light's map.
        Map = "map",
    }
}

impl DrawPart {
    /// Returns whether the part belongs to a shadow volume: a side or a cap.
    pub fn is_of_volume(self) -> bool {
        matches!(self, DrawPart::Side | DrawPart::LightCap | DrawPart::DarkCap | DrawPart::Caps)
    }

    /// Returns whether this part is `part`, or is `Caps` and `part` is one of the two caps. Not the other way round.
    pub fn includes(self, part: DrawPart) -> bool {
        self == part || (self == DrawPart::Caps && matches!(part, DrawPart::LightCap | DrawPart::DarkCap))
    }
}

/// Values that one draw passes to its shader (uniforms).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DrawConstants {
    /// Material of the surface.
    pub material: crate::scene::Material,
    /// What [`Program::Label`] and [`Program::FlatLabel`] write: 0 lit or 1 shadow.
    pub label: u32,
    /// Linear RGBA that [`Program::Flat`] writes.
    pub flat: [f32; 4],
    /// What [`Program::Count`] adds for a front face: 1 or −1.
    pub count: f32,
    /// Index of the draw's own layer in the light's texture array; `None` where it has none.
    pub layer: Option<u32>,
    /// The eye's world x and z modulo the period of the material's checks, metres: where their pattern begins.
    #[serde(default)]
    pub checks_from: [f32; 2],
    /// The texture that the material's colour is multiplied by; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<TextureId>,
}
